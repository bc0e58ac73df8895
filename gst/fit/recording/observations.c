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
  ClothSight *sight = item;

  g_free (sight->vertices);
  g_free (sight->px);
  g_free (sight->covariances);
}

/**
 * cloth_sights_new:
 * @rig: (transfer full): the cameras as calibrated
 * @n_vertices: number of the cloth's vertices
 *
 * Returns: (transfer full): no picture yet
 * Since: 0.1
 */
ClothSights *
cloth_sights_new (ClothRig * rig, guint n_vertices)
{
  ClothSights *sights = g_new0 (ClothSights, 1);

  sights->rig = rig;
  sights->n_vertices = n_vertices;
  sights->list = g_array_new (FALSE, FALSE, sizeof (ClothSight));
  g_array_set_clear_func (sights->list, clear_sight);
  return sights;
}

/* The last picture of a camera, or NULL. */
static const ClothSight *
find_last (const ClothSights * sights, guint camera)
{
  for (guint i = sights->list->len; i-- > 0;) {
    const ClothSight *sight = &g_array_index (sights->list, ClothSight, i);

    if (sight->camera == camera)
      return sight;
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

/**
 * cloth_sights_add:
 * @sights: the pictures so far
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
 * Since: 0.1
 */
gboolean
cloth_sights_add (ClothSights * sights, guint camera, gdouble time_s, guint n,
    const guint32 * vertices, const gdouble * px, const gdouble * covariances,
    GError ** error)
{
  const ClothSight *last;
  ClothSight sight = { camera, time_s, n };

  if (camera >= sights->rig->n_cameras) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "a picture is of camera %u, but the rig has %u", camera,
        sights->rig->n_cameras);
    return FALSE;
  }
  last = find_last (sights, camera);
  if (!isfinite (time_s) || (last && !(time_s > last->time_s))) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "camera “%s”: a picture of %g s is not later than the one before it",
        sights->rig->cameras[camera].name, time_s);
    return FALSE;
  }
  for (guint i = 0; i < n; i++) {
    if (vertices[i] >= sights->n_vertices || (i
            && vertices[i] <= vertices[i - 1])) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "camera “%s”, %g s: vertex %u is not in order, or not one of the "
          "cloth's %u", sights->rig->cameras[camera].name, time_s, vertices[i],
          sights->n_vertices);
      return FALSE;
    }
    if (!is_point (px + 2 * (gsize) i, covariances + 3 * (gsize) i)) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "camera “%s”, %g s: vertex %u is not at a finite place with a "
          "covariance", sights->rig->cameras[camera].name, time_s, vertices[i]);
      return FALSE;
    }
  }
  sight.vertices = g_memdup2 (vertices, n * sizeof *vertices);
  sight.px = g_memdup2 (px, 2 * (gsize) n * sizeof *px);
  sight.covariances = g_memdup2 (covariances, 3 * (gsize) n *
      sizeof *covariances);
  g_array_append_val (sights->list, sight);
  return TRUE;
}

/**
 * cloth_sights_free:
 * @sights: (nullable) (transfer full): pictures
 *
 * Since: 0.1
 */
void
cloth_sights_free (ClothSights * sights)
{
  if (!sights)
    return;
  cloth_rig_free (sights->rig);
  g_array_unref (sights->list);
  g_free (sights);
}
