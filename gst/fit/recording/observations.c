/* What cameras saw of a recorded cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/observations.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"

static void
clear_sight (gpointer item)
{
  ClothObservation *observation = item;

  g_free (observation->vertices);
  g_free (observation->px);
  g_free (observation->covariances);
  g_free (observation->runs);
}

/* @rig: (transfer full): the cameras as calibrated
 * @n_vertices: number of the cloth's vertices
 *
 * Returns: (transfer full): no picture yet
 */
ClothObservations *
cloth_observations_new (ClothRig * rig, guint n_vertices)
{
  ClothObservations *observations = g_new0 (ClothObservations, 1);

  observations->rig = rig;
  observations->n_vertices = n_vertices;
  observations->list = g_array_new (FALSE, FALSE, sizeof (ClothObservation));
  g_array_set_clear_func (observations->list, clear_sight);
  return observations;
}

/* The last picture of a camera, or NULL. */
static const ClothObservation *
find_last (const ClothObservations * observations, guint camera)
{
  for (guint i = observations->list->len; i-- > 0;) {
    const ClothObservation *observation =
        &g_array_index (observations->list, ClothObservation, i);

    if (observation->camera == camera)
      return observation;
  }
  return NULL;
}

static gboolean
is_point (const gdouble * px, const gdouble * covariance)
{
  return isfinite (px[0]) && isfinite (px[1]) && covariance[0] >= 0.
      && covariance[2] >= 0. && isfinite (covariance[0] + covariance[2])
      && covariance[1] * covariance[1] <= covariance[0] * covariance[2];
}

/* @observations: the pictures so far
 * @camera: index of a camera in the rig
 * @time_s: when, by the camera's clock; later than its last picture
 * @n: number of points
 * @vertices: (array length=n): which vertex each of them is, growing
 * @px: (array length=n): x, y of each, px as filmed
 * @covariances: (array length=n): xx, xy, yy of each, px²
 * @error: #ClothFitError
 *
 * Adds a picture; all is copied.
 *
 * Returns: %FALSE when it can't be one of this cloth and these cameras
 */
gboolean
cloth_observations_add (ClothObservations * observations, guint camera,
    gdouble time_s, guint n, const guint32 * vertices, const gdouble * px,
    const gdouble * covariances, GError ** error)
{
  const ClothObservation *last;
  ClothObservation observation = { camera, time_s, n };

  if (camera >= observations->rig->n_cameras) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "a picture is of camera %u, but the rig has %u", camera,
        observations->rig->n_cameras);
    return FALSE;
  }
  last = find_last (observations, camera);
  if (!isfinite (time_s) || (last && !(time_s > last->time_s))) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "camera “%s”: a picture of %g s is not later than the one before it",
        observations->rig->cameras[camera].name, time_s);
    return FALSE;
  }
  for (guint i = 0; i < n; i++) {
    if (vertices[i] >= observations->n_vertices || (i
            && vertices[i] <= vertices[i - 1])) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "camera “%s”, %g s: vertex %u is not in order, or not one of the "
          "cloth's %u", observations->rig->cameras[camera].name, time_s,
          vertices[i], observations->n_vertices);
      return FALSE;
    }
    if (!is_point (px + 2 * (gsize) i, covariances + 3 * (gsize) i)) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "camera “%s”, %g s: vertex %u is not at a finite place with a "
          "covariance", observations->rig->cameras[camera].name, time_s,
          vertices[i]);
      return FALSE;
    }
  }
  observation.vertices = g_memdup2 (vertices, n * sizeof *vertices);
  observation.px = g_memdup2 (px, 2 * (gsize) n * sizeof *px);
  observation.covariances = g_memdup2 (covariances, 3 * (gsize) n *
      sizeof *covariances);
  g_array_append_val (observations->list, observation);
  return TRUE;
}

static gboolean
are_runs (const ClothCamera * camera, guint n_runs, const ClothRun * runs)
{
  for (guint i = 0; i < n_runs; i++)
    if (runs[i].begin >= runs[i].end || runs[i].end > camera->width
        || runs[i].row >= camera->height || (i
            && (runs[i].row < runs[i - 1].row
                || (runs[i].row == runs[i - 1].row
                    && runs[i].begin < runs[i - 1].end))))
      return FALSE;
  return TRUE;
}

/* @observations: pictures, at least one
 * @n_runs: number of runs, 0 when the picture shows no cloth
 * @runs: (array length=n_runs): which pixels are cloth, row by row from the left
 * @error: #ClothFitError
 *
 * Says where in the picture that was added last the cloth is; all is copied.
 *
 * Returns: %FALSE when it can't be in a picture of that camera
 */
gboolean
cloth_observations_set_silhouette (ClothObservations * observations,
    guint n_runs, const ClothRun * runs, GError ** error)
{
  ClothObservation *last = &g_array_index (observations->list,
      ClothObservation, observations->list->len - 1);
  const ClothCamera *camera = &observations->rig->cameras[last->camera];

  if (!are_runs (camera, n_runs, runs)) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "camera “%s”, %g s: the silhouette's runs are not in order, or not in "
        "its picture of %d × %d pixels", camera->name, last->time_s,
        camera->width, camera->height);
    return FALSE;
  }
  g_free (last->runs);
  last->runs = g_memdup2 (runs, n_runs * sizeof *runs);
  last->n_runs = n_runs;
  last->has_silhouette = TRUE;
  return TRUE;
}

/* @observations: pictures
 * @camera: index of a camera in the rig
 *
 * Returns: whether any of its pictures has a silhouette
 */
gboolean
cloth_observations_has_silhouettes (const ClothObservations * observations,
    guint camera)
{
  for (guint i = 0; i < observations->list->len; i++) {
    const ClothObservation *o = &g_array_index (observations->list,
        ClothObservation, i);

    if (o->camera == camera && o->has_silhouette)
      return TRUE;
  }
  return FALSE;
}

/* @observations: (nullable) (transfer full): pictures
 */
void
cloth_observations_free (ClothObservations * observations)
{
  if (!observations)
    return;
  cloth_rig_free (observations->rig);
  g_array_unref (observations->list);
  g_free (observations);
}
