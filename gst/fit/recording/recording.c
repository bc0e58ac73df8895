/* A recording made ready for a fit, and as one of a coarser grid.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/recording.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/math/linalg.h"

/* Noise puts two vertices no further apart than this many standard deviations of one
 * coordinate. */
#define FAR_APART 6.

static gdouble *
place (const ClothRecording * r, gdouble * of, guint frame, guint vertex)
{
  return of + 3 * ((gsize) frame * r->n + vertex);
}

/* What a take's covariances say of a frame. Where a place was seen and its covariance is not told,
 * it is left out. */
static gboolean
load_covariances (ClothRecording * r, ClothTake * take, guint frame,
    gfloat * covariances, GError ** error)
{
  if (!cloth_take_read_covariances (take, frame, covariances, error))
    return FALSE;
  for (guint v = 0; v < r->n; v++) {
    const gfloat *c = covariances + 6 * (gsize) v;
    const gsize at = (gsize) frame * r->n + v;
    const gdouble full[9] =
        { c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5] };
    gdouble i[9];

    if (r->seen[at] == 0.)
      continue;
    if (isnan (c[0])) {
      r->seen[at] = 0.;
      continue;
    }
    if (c[0] > 0. && cloth_mat3_inverse (full, i)
        && cloth_recording_noise_set (r->noise, at,
            (const gdouble[6]) { i[0], i[4], i[8], i[5], i[2], i[1] }, 0.))
      continue;
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: the "
        "covariance of vertex %u in frame %u is not positive; give NaN where "
        "it is not known, or a take without covariance.npy", r->name, v, frame);
    return FALSE;
  }
  return TRUE;
}

static gboolean
load (ClothRecording * r, ClothTake * take, GError ** error)
{
  gsize row = 3 * (gsize) r->n;
  g_autofree gfloat *positions = g_new (gfloat, row);
  g_autofree gfloat *covariances = NULL;

  if (cloth_take_has_covariances (take)) {
    covariances = g_new (gfloat, 2 * row);
    r->noise = cloth_recording_noise_new ((gsize) r->n * r->n_frames);
  }
  for (guint frame = 0; frame < r->n_frames; frame++) {
    if (!cloth_take_read_positions (take, frame, positions, error))
      return FALSE;
    r->times[frame] = cloth_take_get_time (take, frame);
    for (guint v = 0; v < r->n; v++) {
      const gfloat *p = positions + 3 * (gsize) v;
      gboolean seen = isfinite (p[0]) && isfinite (p[1]) && isfinite (p[2]);

      r->seen[(gsize) frame * r->n + v] = seen ? 1. : 0.;
      for (guint k = 0; k < 3; k++)
        place (r, r->y, frame, v)[k] = seen ? p[k] : 0.;
    }
    if (covariances && !load_covariances (r, take, frame, covariances, error))
      return FALSE;
  }
  return TRUE;
}

/* Into @row the places of a frame, and NaN where nothing was seen. */
static void
read_seen (ClothRecording * r, guint frame, gdouble * row)
{
  const gdouble *seen = r->seen + (gsize) frame * r->n;
  const gdouble *y = place (r, r->y, frame, 0);

  for (gsize i = 0; i < 3 * (gsize) r->n; i++)
    row[i] = seen[i / 3] > 0. ? y[i] : NAN;
}

/* @recording: a recording
 *
 * What no cloth can be at was not seen there. Where there is more noise than was told, noise
 * is no tear: it is estimated when there seem to be any.
 *
 * Returns: how many places that were
 */
gsize
cloth_recording_remove_torn (ClothRecording * recording)
{
  ClothRecording *r = recording;
  gsize n = 0;

  g_autoptr (ClothOutliers) outliers = cloth_outliers_new (r->scene->topology);
  g_autofree gdouble *row = g_new (gdouble, 3 * (gsize) r->n);
  gdouble sigma = r->sigma > 0. ? r->sigma : 0.;
  gboolean estimated = FALSE;

  for (guint frame = 0; frame < r->n_frames; frame++) {
    read_seen (r, frame, row);
    if (!cloth_outliers_remove (outliers, FAR_APART * sigma, row))
      continue;
    if (!estimated) {
      sigma = fmax (sigma, cloth_recording_estimate_sigma (r));
      estimated = TRUE;
      read_seen (r, frame, row);
      cloth_outliers_remove (outliers, FAR_APART * sigma, row);
    }
    for (guint v = 0; v < r->n; v++) {
      const gsize at = (gsize) frame * r->n + v;

      n += r->seen[at] > 0. && isnan (row[3 * (gsize) v]);
      r->seen[at] = isnan (row[3 * (gsize) v]) ? 0. : 1.;
    }
  }
  return n;
}

/* @take: a take
 * @error: #ClothFitError, or what reading it says
 *
 * Returns: (transfer full) (nullable): the recording
 */
ClothRecording *
cloth_recording_new (ClothTake * take, GError ** error)
{
  const ClothTakeInfo *info = cloth_take_get_info (take);
  g_autoptr (ClothRecording) r = g_new0 (ClothRecording, 1);
  gboolean told;
  gsize all;

  r->name = g_strdup (info->name);
  r->n = cloth_take_get_topology (take)->n_vertices;
  r->n_frames = cloth_take_get_n_frames (take);
  if (r->n_frames < CLOTH_RECORDING_WINDOW) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s has %u "
        "frames; what it shows needs motion, at least %u", r->name, r->n_frames,
        CLOTH_RECORDING_WINDOW);
    return NULL;
  }
  r->scene = cloth_scene_new_with_open_paths (take, error);
  if (!r->scene)
    return NULL;
  all = (gsize) r->n_frames * r->n;
  r->times = g_new (gdouble, r->n_frames);
  r->y = g_new (gdouble, 3 * all);
  r->velocity = g_new (gdouble, 3 * all);
  r->seen = g_new (gdouble, all);
  if (!load (r, take, error))
    return NULL;
  r->sigma = r->noise ? cloth_recording_noise_finish (r->noise, r->seen) :
      info->noise_sigma_m;
  told = r->sigma > 0.;
  if (!told)
    r->sigma = cloth_recording_estimate_sigma (r);
  if (!cloth_recording_check (r, told, error))
    return NULL;
  cloth_recording_remove_torn (r);
  cloth_recording_interpolate (r);
  if (!cloth_recording_find_paths (r, error))
    return NULL;
  if (!cloth_recording_check_paths (r, error))
    return NULL;
  cloth_recording_differentiate (r);
  return g_steal_pointer (&r);
}

/* Where line @i of @n lies among @all: the line below and how far it is beyond. */
static guint
find_line (guint i, guint n, guint all, gdouble * beyond)
{
  gdouble at = (gdouble) i * (all - 1) / (n - 1);
  guint line = MIN ((guint) at, all - 2);

  *beyond = at - line;
  return line;
}

/* Between the four vertices about each, frame by frame. */
static void
interpolate (const ClothRecording * from, ClothRecording * to)
{
  const ClothTopology *a = from->scene->topology, *b = to->scene->topology;

  for (guint row = 0; row < b->rows; row++)
    for (guint column = 0; column < b->columns; column++) {
      gdouble u, v;
      guint i = find_line (column, b->columns, a->columns, &u);
      guint first = find_line (row, b->rows, a->rows, &v) * a->columns + i;

      for (guint frame = 0; frame < to->n_frames; frame++) {
        const gdouble *y = from->y + 3 * ((gsize) frame * from->n + first);
        gdouble *p = to->y + 3 * ((gsize) frame * to->n + row * b->columns +
            column);

        for (guint k = 0; k < 3; k++)
          p[k] = (1. - v) * ((1. - u) * y[k] + u * y[3 + k]) +
              v * ((1. - u) * y[3 * a->columns + k] +
              u * y[3 * a->columns + 3 + k]);
      }
    }
}

/* Clamps hold the nearest vertices, each but one at a time. */
static void
hold (const ClothScene * from, ClothScene * to)
{
  const ClothTopology *a = from->topology, *b = to->topology;
  g_autofree guint *of = g_new (guint, from->held->len + 1);

  for (guint i = 0; i < from->held->len; i++) {
    ClothHeld held = g_array_index (from->held, ClothHeld, i);
    guint column = (guint) round ((gdouble) (held.vertex % a->columns) *
        (b->columns - 1) / (a->columns - 1));
    guint row = (guint) round ((gdouble) (held.vertex / a->columns) *
        (b->rows - 1) / (a->rows - 1));
    gboolean taken = FALSE;

    held.vertex = row * b->columns + column;
    for (guint k = 0; k < to->held->len; k++) {
      const ClothHeld *other = &g_array_index (to->held, ClothHeld, k);

      taken = taken || (other->vertex == held.vertex
          && cloth_held_overlap (other, &held) > 0.);
    }
    if (taken)
      continue;
    of[to->held->len] = i;
    g_array_append_val (to->held, held);
  }
  to->clamps = g_new (gdouble, 3 * (gsize) from->n_frames * to->held->len + 1);
  for (guint frame = 0; frame < from->n_frames; frame++)
    for (guint i = 0; i < to->held->len; i++)
      memcpy (to->clamps + 3 * ((gsize) frame * to->held->len + i),
          from->clamps + 3 * ((gsize) frame * from->held->len + of[i]),
          3 * sizeof (gdouble));
}

/* @recording: a recording
 * @most: lines that are enough along u and along v, at least 2
 *
 * The noise becomes less by the root of the vertices, so that the features' square over
 * the noise stays what it was. Everything counts as seen; velocities are not filled.
 *
 * Returns: (transfer full) (nullable): the same on a coarser grid; %NULL when it is no
 *   grid, or none that is finer, or has seams
 */
ClothRecording *
cloth_recording_resample (const ClothRecording * recording, guint most)
{
  const ClothScene *scene = recording->scene;
  const ClothTopology *t = scene->topology;
  gsize last = t->n_vertices - 1;
  guint columns = MIN (t->columns, most), rows = MIN (t->rows, most);
  ClothRecording *r;

  if (!t->columns || scene->seams->len
      || (columns == t->columns && rows == t->rows))
    return NULL;
  r = g_new0 (ClothRecording, 1);
  r->name = g_strdup (recording->name);
  r->n = columns * rows;
  r->n_frames = recording->n_frames;
  r->times = g_memdup2 (recording->times, r->n_frames * sizeof (gdouble));
  r->sigma = recording->sigma * sqrt ((gdouble) r->n / recording->n);
  r->scene = cloth_scene_new (cloth_topology_new_grid (columns, rows,
          t->uv[2 * last] - t->uv[0], t->uv[2 * last + 1] - t->uv[1]),
      scene->fps, scene->n_frames);
  memcpy (r->scene->times, scene->times, scene->n_frames * sizeof (gdouble));
  memcpy (r->scene->gravity, scene->gravity, sizeof scene->gravity);
  g_array_unref (r->scene->obstacles);
  r->scene->obstacles = cloth_obstacles_copy (scene->obstacles);
  hold (scene, r->scene);
  r->y = g_new (gdouble, 3 * (gsize) r->n * r->n_frames);
  interpolate (recording, r);
  return r;
}

/* @recording: a recording of two frames at least
 * @time: by its clock, s
 *
 * Returns: the nearest frame; -1 where the recording is over by more than half the usual distance of
 *   frames, or has not begun
 */
gint
cloth_recording_find_frame (const ClothRecording * recording, gdouble time)
{
  const gdouble *t = recording->times;
  const guint n = recording->n_frames;
  const gdouble half = (t[n - 1] - t[0]) / (n - 1) / 2. * (1. + 1e-9);
  guint low = 0, high = n - 1;

  if (!(time >= t[0] - half && time <= t[n - 1] + half))
    return -1;
  while (high - low > 1) {
    const guint middle = (low + high) / 2;

    if (t[middle] <= time)
      low = middle;
    else
      high = middle;
  }
  return (gint) (fabs (time - t[low]) <= fabs (time - t[high]) ? low : high);
}

/* @recording: a recording of two frames at least
 * @time: s
 * @frame: that it is nearest to
 * @share: (out): of the way to the next frame
 *
 * Where a time is between two frames, from the first to the last one.
 *
 * Returns: the first of them
 */
guint
cloth_recording_find_between (const ClothRecording * recording, gdouble time,
    guint frame, gdouble * share)
{
  const ClothRecording *r = recording;
  const guint before = MIN (frame - (frame > 0 && time < r->times[frame]),
      r->n_frames - 2);

  *share = CLAMP ((time - r->times[before]) /
      (r->times[before + 1] - r->times[before]), 0., 1.);
  return before;
}

/* @recording: a recording of two frames at least
 * @observations: pictures
 * @camera: whose of them
 * @pictures: (out) (array): of each frame which of the observations with a silhouette is nearest in time, or
 *   -1, [n_frames]
 */
void
cloth_recording_find_silhouettes (const ClothRecording * recording,
    const ClothObservations * observations, guint camera, gint * pictures)
{
  const ClothRecording *r = recording;
  const gdouble late = observations->rig->cameras[camera].offset_s;
  g_autofree gdouble *off = g_new (gdouble, r->n_frames);

  for (guint f = 0; f < r->n_frames; f++) {
    pictures[f] = -1;
    off[f] = INFINITY;
  }
  for (guint i = 0; i < observations->list->len; i++) {
    const ClothObservation *o = &g_array_index (observations->list,
        ClothObservation, i);
    const gdouble time = o->time_s - late;
    const gint f = o->camera == camera && o->has_silhouette ?
        cloth_recording_find_frame (r, time) : -1;

    if (f < 0 || fabs (time - r->times[f]) >= off[f])
      continue;
    off[f] = fabs (time - r->times[f]);
    pictures[f] = (gint) i;
  }
}
