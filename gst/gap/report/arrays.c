/* The arrays of the report, packed: positions in 16 bits, base64.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/arrays.h"

#include <math.h>
#include <string.h>

#include "gst/file/jsonwriter.h"

/* Numbers of all positions together; base64 makes 2.7 bytes of each. */
#define MAX_NUMBERS 2750000u
#define UNSEEN 0xffffu
#define MAX_STEP 0xfffeu
/* A cloth of more vertices is thinned before its frames are. */
#define MANY_VERTICES 5000u
/* Expected distances in 8 bits, from 1 µm up, each 6% more than the one before. */
#define SIGMA_FIRST 1e-6
#define SIGMA_RATIO 0.06

/* What is kept of a playback. */
typedef struct
{
  const ClothGapPlayback *from;
  guint frame_step;
  guint vertex_step;
  guint n_frames;
  guint n_vertices;
  guint32 *vertices;            /* those that are kept */
  ClothTopology *topology;
  gfloat origin[3];
  gfloat step;
} Thinned;

static guint
kept (guint n, guint step)
{
  return (n - 1) / step + 1;
}

/* How many numbers remain; those of a mesh that is no grid keep all vertices. */
static guint64
count_numbers (const ClothGapPlayback * play, guint frame_step,
    guint vertex_step)
{
  const ClothTopology *topology = play->topology;
  guint64 n_arrays = 1u + (play->before ? 1 : 0) + (play->after ? 1 : 0);
  guint64 n_vertices = topology->columns ?
      (guint64) kept (topology->columns, vertex_step) *
      kept (topology->rows, vertex_step) : topology->n_vertices;

  return kept (play->n_frames, frame_step) * n_vertices * 3 * n_arrays;
}

/* The kept vertices of a grid make a smaller grid. */
static void
thin_vertices (Thinned * thinned)
{
  const ClothTopology *all = thinned->from->topology;
  guint step = thinned->vertex_step, columns, rows;

  if (step == 1) {
    thinned->topology = cloth_topology_copy (all);
    thinned->n_vertices = all->n_vertices;
    thinned->vertices = g_new (guint32, thinned->n_vertices);
    for (guint i = 0; i < thinned->n_vertices; i++)
      thinned->vertices[i] = i;
    return;
  }
  columns = kept (all->columns, step);
  rows = kept (all->rows, step);
  thinned->topology = cloth_topology_new_grid (columns, rows, 1, 1);
  thinned->n_vertices = columns * rows;
  thinned->vertices = g_new (guint32, thinned->n_vertices);
  for (guint i = 0; i < thinned->n_vertices; i++) {
    guint vertex = i / columns * step * all->columns + i % columns * step;

    thinned->vertices[i] = vertex;
    memcpy (thinned->topology->uv + 2 * i, all->uv + 2 * vertex,
        2 * sizeof *all->uv);
  }
}

/* The box of the recording, and half of it around: simulations that fly off are cut
 * there, so that they don't cost all others their precision. */
static void
find_box (Thinned * thinned)
{
  const ClothGapPlayback *play = thinned->from;
  gsize n = (gsize) play->n_frames * play->topology->n_vertices * 3;
  gfloat low[3], high[3], widest = 0;

  for (guint k = 0; k < 3; k++) {
    low[k] = INFINITY;
    high[k] = -INFINITY;
  }
  for (gsize i = 0; i < n; i++) {
    if (isfinite (play->recorded[i])) {
      low[i % 3] = MIN (low[i % 3], play->recorded[i]);
      high[i % 3] = MAX (high[i % 3], play->recorded[i]);
    }
  }
  for (guint k = 0; k < 3; k++) {
    if (!(low[k] <= high[k]))
      low[k] = high[k] = 0;
    widest = MAX (widest, high[k] - low[k]);
  }
  widest = MAX (widest, 1e-3f);
  for (guint k = 0; k < 3; k++)
    thinned->origin[k] = low[k] - widest / 2;
  thinned->step = 2 * widest / MAX_STEP;
}

/* FALSE: even one frame would be too much. */
static gboolean
thin (const ClothGapPlayback * play, Thinned * thinned)
{
  guint frame_step = 1, vertex_step = 1;

  while (count_numbers (play, frame_step, vertex_step) > MAX_NUMBERS) {
    if (play->topology->columns && play->topology->n_vertices /
        (vertex_step * vertex_step) > MANY_VERTICES)
      vertex_step++;
    else if (frame_step < play->n_frames)
      frame_step++;
    else
      return FALSE;
  }
  *thinned = (Thinned) {
  .from = play,.frame_step = frame_step,.vertex_step = vertex_step,.n_frames =
        kept (play->n_frames, frame_step)};
  thin_vertices (thinned);
  find_box (thinned);
  return TRUE;
}

static void
put_bytes (ClothJsonWriter * writer, const gchar * key, gconstpointer bytes,
    gsize size)
{
  g_autofree gchar *text = g_base64_encode (bytes, size);

  cloth_json_writer_string (writer, key, text);
}

static void
put_positions (ClothJsonWriter * writer, const gchar * key,
    const Thinned * thinned, const gfloat * positions)
{
  gsize n = (gsize) thinned->n_frames * thinned->n_vertices, at = 0;
  g_autofree guint16 *packed = NULL;

  if (!positions)
    return;
  packed = g_new (guint16, 3 * n);
  for (guint f = 0; f < thinned->n_frames; f++) {
    const gfloat *frame = positions + 3 * (gsize) f * thinned->frame_step *
        thinned->from->topology->n_vertices;

    for (guint v = 0; v < thinned->n_vertices; v++) {
      const gfloat *point = frame + 3 * (gsize) thinned->vertices[v];
      gboolean seen = isfinite (point[0]) && isfinite (point[1]) &&
          isfinite (point[2]);

      for (guint k = 0; k < 3; k++) {
        gfloat steps = roundf ((point[k] - thinned->origin[k]) / thinned->step);

        packed[at++] = GUINT16_TO_LE (seen ?
            (guint16) CLAMP (steps, 0, (gfloat) MAX_STEP) : UNSEEN);
      }
    }
  }
  put_bytes (writer, key, packed, 3 * n * sizeof *packed);
}

static void
put_sigma (ClothJsonWriter * writer, const Thinned * thinned)
{
  const gdouble scale[] = { SIGMA_FIRST, SIGMA_RATIO };
  gsize n = (gsize) thinned->n_frames * thinned->n_vertices, at = 0;
  g_autofree guint8 *packed = NULL;

  if (!thinned->from->sigma)
    return;
  packed = g_new (guint8, n);
  for (guint f = 0; f < thinned->n_frames; f++) {
    const gfloat *frame = thinned->from->sigma + (gsize) f *
        thinned->frame_step * thinned->from->topology->n_vertices;

    for (guint v = 0; v < thinned->n_vertices; v++) {
      gdouble sigma = frame[thinned->vertices[v]];

      packed[at++] = isfinite (sigma) && sigma > 0 ? (guint8)
          CLAMP (round (log (sigma / SIGMA_FIRST) / SIGMA_RATIO), 0, 254) : 255;
    }
  }
  put_bytes (writer, "sigma", packed, n);
  cloth_json_writer_numbers (writer, "sigma_scale", scale, 2);
}

static void
put_shares (ClothJsonWriter * writer, const gchar * key,
    const Thinned * thinned, const ClothGapResult * result,
    const gdouble * shares)
{
  g_autofree guint32 *packed = NULL;

  if (!shares || result->n_vertices != thinned->from->topology->n_vertices)
    return;
  packed = g_new (guint32, thinned->n_vertices);
  for (guint i = 0; i < thinned->n_vertices; i++) {
    gfloat share = (gfloat) shares[thinned->vertices[i]];
    guint32 bits;

    memcpy (&bits, &share, sizeof bits);
    packed[i] = GUINT32_TO_LE (bits);
  }
  put_bytes (writer, key, packed, thinned->n_vertices * sizeof *packed);
}

static void
put_topology (ClothJsonWriter * writer, const ClothTopology * topology)
{
  gsize n_uv = 2 * (gsize) topology->n_vertices;
  gsize n_corners = 4 * (gsize) topology->n_faces;
  g_autofree guint32 *packed = g_new (guint32, MAX (n_uv, n_corners) + 1);

  memcpy (packed, topology->uv, n_uv * sizeof *packed);
  for (gsize i = 0; i < n_uv; i++)
    packed[i] = GUINT32_TO_LE (packed[i]);
  put_bytes (writer, "uv", packed, n_uv * sizeof *packed);
  for (gsize i = 0; i < n_corners; i++)
    packed[i] = GUINT32_TO_LE (topology->faces[i]);
  put_bytes (writer, "faces", packed, n_corners * sizeof *packed);
}

static void
put_playback (ClothJsonWriter * writer, const ClothGapResult * result)
{
  const ClothGapPlayback *play = &result->playback;
  g_autofree gdouble *times = NULL;
  Thinned thinned;
  gdouble origin[3];

  if (!play->topology || !play->recorded || play->n_frames == 0 ||
      play->topology->n_vertices == 0 || !thin (play, &thinned))
    return;
  times = g_new (gdouble, thinned.n_frames);
  for (guint f = 0; f < thinned.n_frames; f++)
    times[f] = play->times[(gsize) f * thinned.frame_step];
  for (guint k = 0; k < 3; k++)
    origin[k] = thinned.origin[k];
  cloth_json_writer_begin_object (writer, "playback");
  cloth_json_writer_string (writer, "take", play->take);
  cloth_json_writer_count (writer, "frame_step", thinned.frame_step);
  cloth_json_writer_count (writer, "vertex_step", thinned.vertex_step);
  cloth_json_writer_numbers (writer, "times", times, thinned.n_frames);
  cloth_json_writer_numbers (writer, "origin", origin, 3);
  cloth_json_writer_number (writer, "step", thinned.step);
  cloth_json_writer_boolean (writer, "free_run", play->free_run);
  put_topology (writer, thinned.topology);
  put_positions (writer, "recorded", &thinned, play->recorded);
  put_positions (writer, "before", &thinned, play->before);
  put_positions (writer, "after", &thinned, play->after);
  put_sigma (writer, &thinned);
  put_shares (writer, "shares", &thinned, result, result->vertices);
  put_shares (writer, "gained", &thinned, result, result->gained);
  cloth_json_writer_end_object (writer);
  g_free (thinned.vertices);
  cloth_topology_free (thinned.topology);
}

static void
put_series (ClothJsonWriter * writer, const ClothGapSeries * series)
{
  if (series->n == 0)
    return;
  cloth_json_writer_begin_object (writer, "series");
  cloth_json_writer_numbers (writer, "times", series->times, series->n);
  cloth_json_writer_numbers (writer, "before", series->before, series->n);
  cloth_json_writer_numbers (writer, "after", series->after, series->n);
  cloth_json_writer_numbers (writer, "null_low", series->null_low, series->n);
  cloth_json_writer_numbers (writer, "null_high", series->null_high, series->n);
  cloth_json_writer_end_object (writer);
}

static void
put_spectrum (ClothJsonWriter * writer, const ClothGapSpectrum * spectrum)
{
  gsize n = (gsize) spectrum->n_waves * spectrum->n_frequencies;

  if (n == 0)
    return;
  cloth_json_writer_begin_object (writer, "spectrum");
  cloth_json_writer_numbers (writer, "frequencies", spectrum->frequencies,
      spectrum->n_frequencies);
  cloth_json_writer_numbers (writer, "waves", spectrum->waves,
      spectrum->n_waves);
  cloth_json_writer_numbers (writer, "before", spectrum->before, n);
  cloth_json_writer_numbers (writer, "after", spectrum->after, n);
  cloth_json_writer_numbers (writer, "null", spectrum->null, n);
  cloth_json_writer_end_object (writer);
}

/* @result: a result
 *
 * What the page shows besides gap.json, as JSON: the playback, thinned until it takes
 * at most some 7 MB, the series, the spectrum and a sentence about each effect.
 *
 * Returns: (transfer full): the text */
gchar *
cloth_gap_report_arrays (const ClothGapResult * result)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_begin_object (writer, "about");
  for (guint i = 0; i < result->effects->len; i++) {
    const ClothEffect *effect = g_array_index (result->effects,
        ClothGapEffect, i).effect;

    cloth_json_writer_string (writer, effect->id, effect->blurb);
  }
  cloth_json_writer_end_object (writer);
  put_playback (writer, result);
  put_series (writer, &result->series);
  put_spectrum (writer, &result->spectrum);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}
