/* The arrays of the report, packed: positions in 16 bits, base64.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/arrays.h"

#include <math.h>
#include <string.h>

#include "gst/file/jsonwriter.h"
#include "gst/gap/report/pack.h"

/* Numbers of all positions together; base64 makes 2.7 bytes of each. */
#define MAX_NUMBERS 2750000u
/* A cloth of more vertices is thinned before its frames are. */
#define MANY_VERTICES 5000u

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
  ClothPackBox box;
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
  gfloat low[3], high[3];

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
  cloth_pack_box (&thinned->box, low, high, 0.5f);
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
      cloth_pack_place (&thinned->box,
          frame + 3 * (gsize) thinned->vertices[v], packed + at);
      at += 3;
    }
  }
  cloth_pack_put_bytes (writer, key, packed, 3 * n * sizeof *packed);
}

static void
put_sigma (ClothJsonWriter * writer, const Thinned * thinned)
{
  gsize n = (gsize) thinned->n_frames * thinned->n_vertices, at = 0;
  g_autofree guint8 *packed = NULL;

  if (!thinned->from->sigma)
    return;
  packed = g_new (guint8, n);
  for (guint f = 0; f < thinned->n_frames; f++) {
    const gfloat *frame = thinned->from->sigma + (gsize) f *
        thinned->frame_step * thinned->from->topology->n_vertices;

    for (guint v = 0; v < thinned->n_vertices; v++)
      packed[at++] = cloth_pack_sigma (frame[thinned->vertices[v]]);
  }
  cloth_pack_put_sigmas (writer, packed, n);
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
  cloth_pack_put_bytes (writer, key, packed,
      thinned->n_vertices * sizeof *packed);
}

static void
put_playback (ClothJsonWriter * writer, const ClothGapResult * result)
{
  const ClothGapPlayback *play = &result->playback;
  g_autofree gdouble *times = NULL;
  Thinned thinned;

  if (!play->topology || !play->recorded || play->n_frames == 0 ||
      play->topology->n_vertices == 0 || !thin (play, &thinned))
    return;
  times = g_new (gdouble, thinned.n_frames);
  for (guint f = 0; f < thinned.n_frames; f++)
    times[f] = play->times[(gsize) f * thinned.frame_step];
  cloth_json_writer_begin_object (writer, "playback");
  cloth_json_writer_string (writer, "take", play->take);
  cloth_json_writer_count (writer, "frame_step", thinned.frame_step);
  cloth_json_writer_count (writer, "vertex_step", thinned.vertex_step);
  cloth_json_writer_numbers (writer, "times", times, thinned.n_frames);
  cloth_pack_put_box (writer, &thinned.box);
  cloth_json_writer_boolean (writer, "free_run", play->free_run);
  cloth_pack_put_topology (writer, thinned.topology);
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
