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

/* Where the cloth is at @time, to which @frame is nearest. */
static void
place (const ClothRecording * r, const gfloat * positions, gdouble time,
    guint frame, gdouble * places)
{
  const gsize row = 3 * (gsize) r->n;
  gdouble share;
  const gfloat *from = positions + row * cloth_recording_find_between (r, time,
      frame, &share);

  for (gsize i = 0; i < row; i++)
    places[i] = (1. - share) * from[i] + share * from[row + i];
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
 * @threads: that draw; 0 = one for each processor
 * @overlaps: (out) (array): share of the pixels that are cloth in either picture that are so in both,
 *   [n_cameras][n_frames]; of the picture nearest to each frame, NaN where none has a silhouette or no
 *   pixel is cloth
 * @differences: (out) (array): pixels that are cloth in only one of them, likewise
 *
 * How well the cloth covers what was filmed of it.
 */
void
cloth_synthesis_compare_silhouettes (const ClothRecording * recording,
    const gfloat * positions, const ClothObservations * observations,
    guint threads, gdouble * overlaps, gdouble * differences)
{
  const ClothRecording *r = recording;
  const ClothRig *rig = observations->rig;
  const ClothTopology *t = r->scene->topology;
  g_autoptr (ClothPool) pool = cloth_pool_new (threads);
  g_autoptr (ClothCoverage) coverage = cloth_coverage_new (t->n_vertices,
      t->faces, t->n_faces);
  g_autofree gdouble *places = g_new (gdouble, 3 * (gsize) r->n);
  g_autofree gint *pictures = g_new (gint, r->n_frames);

  for (guint c = 0; c < rig->n_cameras; c++) {
    cloth_recording_find_silhouettes (r, observations, c, pictures);
    for (guint f = 0; f < r->n_frames; f++) {
      const gsize at = (gsize) c * r->n_frames + f;
      const ClothObservation *o = pictures[f] < 0 ? NULL :
          &g_array_index (observations->list, ClothObservation, pictures[f]);
      guint64 both, either;

      overlaps[at] = differences[at] = NAN;
      if (!o)
        continue;
      place (r, positions, o->time_s - rig->cameras[c].offset_s, f, places);
      cloth_coverage_draw (coverage, &rig->cameras[c], places, pool);
      count (coverage, o, &both, &either);
      if (!either)
        continue;
      overlaps[at] = (gdouble) both / (gdouble) either;
      differences[at] = (gdouble) (either - both);
    }
  }
}
