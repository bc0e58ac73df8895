/* The silhouettes of a synthesised cloth, and those that were filmed.
 *
 * Formula: of the pixels S that the drawn cloth covers and those F that were filmed as cloth,
 *   difference = |S ∪ F| − |S ∩ F|, the paper's error of a picture, and overlap = |S ∩ F| / |S ∪ F|.
 *   The cloth at the time of a picture lies on straight lines between the frames.
 * Assumption: nothing stands between camera and cloth.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 4; Jaccard 1912 (overlap).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/synthesis/silhouette.h"

#include <math.h>
#include <string.h>

#include "gst/render/coverage.h"

/* Of a picture at @time of the frames' clock: the frame before it, and how far it is on the way to the
 * next one. Returns the nearest frame, or -1 where the recording is not. */
static gint
find_frame (const ClothRecording * r, gdouble time, guint * before,
    gdouble * share)
{
  const gdouble half = (r->times[r->n_frames - 1] - r->times[0]) /
      (r->n_frames - 1) / 2.;
  guint f = 0;

  if (!(time >= r->times[0] - half && time <= r->times[r->n_frames - 1] + half))
    return -1;
  while (f + 2 < r->n_frames && r->times[f + 1] <= time)
    f++;
  *before = f;
  *share = CLAMP ((time - r->times[f]) / (r->times[f + 1] - r->times[f]), 0.,
      1.);
  return (gint) (f + (*share >= 0.5));
}

/* How many pixels both have, and how many either has. */
static void
count (const ClothCoverage * coverage, const ClothObservation * picture,
    guint64 * both, guint64 * either)
{
  const gsize all = (gsize) coverage->width * (gsize) coverage->height;

  *both = *either = 0;
  for (gsize i = 0; i < all; i++)
    *either += coverage->seen[i] != CLOTH_COVERAGE_NONE;
  for (guint k = 0; k < picture->n_runs; k++) {
    const ClothRun *run = &picture->runs[k];
    const guint32 *row = coverage->seen +
        (gsize) run->row * (gsize) coverage->width;

    for (guint x = run->begin; x < run->end; x++) {
      *both += row[x] != CLOTH_COVERAGE_NONE;
      *either += row[x] == CLOTH_COVERAGE_NONE;
    }
  }
}

/* @recording: mesh and times
 * @positions: (array): where the cloth is, [n_frames][n][3], m
 * @observations: what cameras filmed
 * @camera: which of them is looked through
 * @overlaps: (out) (array): share of the pixels that are cloth in either picture that are so in both,
 *   [n_frames]; of the picture nearest to each frame, NaN where none has a silhouette or no pixel is cloth
 * @differences: (out) (array): pixels that are cloth in only one of them, [n_frames]; NaN the same
 *
 * How well the cloth covers what was filmed of it.
 */
void
cloth_synthesis_compare_silhouettes (const ClothRecording * recording,
    const gfloat * positions, const ClothObservations * observations,
    guint camera, gdouble * overlaps, gdouble * differences)
{
  const ClothRecording *r = recording;
  const ClothCamera *c = &observations->rig->cameras[camera];
  const ClothTopology *t = r->scene->topology;
  const gsize row = 3 * (gsize) r->n;
  g_autoptr (ClothPool) pool = cloth_pool_new (0);
  g_autoptr (ClothCoverage) coverage = cloth_coverage_new (t->n_vertices,
      t->faces, t->n_faces);
  g_autofree gdouble *places = g_new (gdouble, row);
  g_autofree gdouble *off = g_new (gdouble, r->n_frames);

  for (guint f = 0; f < r->n_frames; f++) {
    overlaps[f] = differences[f] = NAN;
    off[f] = INFINITY;
  }
  for (guint i = 0; i < observations->list->len; i++) {
    const ClothObservation *o = &g_array_index (observations->list,
        ClothObservation, i);
    const gdouble time = o->time_s - c->offset_s;
    guint before;
    guint64 both, either;
    gdouble share;
    const gint frame = o->camera == camera && o->has_silhouette ?
        find_frame (r, time, &before, &share) : -1;

    if (frame < 0 || fabs (time - r->times[frame]) >= off[frame])
      continue;
    off[frame] = fabs (time - r->times[frame]);
    for (gsize k = 0; k < row; k++)
      places[k] = (1. - share) * positions[before * row + k] +
          share * positions[(before + 1) * row + k];
    cloth_coverage_draw (coverage, c, places, pool);
    count (coverage, o, &both, &either);
    overlaps[frame] = either ? (gdouble) both / (gdouble) either : NAN;
    differences[frame] = either ? (gdouble) (either - both) : NAN;
  }
}
