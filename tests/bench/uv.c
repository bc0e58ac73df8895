/* uv of each pixel of a rendered film, held against the truth: the paper's section 5.
 *
 *   bench-uv FOLDER [--NAME=VALUE…]
 *   bench-uv FOLDER --from=8 --to=9 --picture=docs/images/uvmap.png
 *
 * The folder is one of matchfilm.h; without it there is nothing to do. Features of the film
 * are matched with its print on the true surface; along the surface stands beside the
 * interpolation in the picture on the same triangles, without smoothing. Times are of all threads
 * together, the best of three rounds.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/uv/uv.h"

#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"
#include "gst/math/statistics.h"
#include "gst/vision/match/match.h"
#include "tests/bench/matchfilm.h"

#define ROUNDS 3
/* Of the checks laid over a picture, m, and what is white in a picture of errors, mm. */
#define CHECK 0.02
#define WHITE 4.0

typedef enum
{
  ALL,
  FOLDS,
  OBLIQUE,
  BEYOND,
  N_PARTS
} Part;

static const gchar *const part_names[N_PARTS] = { "all pixels", "folds",
  "beyond 60°", "outside"
};

typedef enum
{
  SURFACE,
  PICTURE,
  N_WAYS
} Way;

typedef struct
{
  GArray *errors[N_WAYS][N_PARTS];
  gdouble ms, share, between;
  guint n_frames;
  GArray *vertex_errors, *vertex_squares;
  guint n_visible;
} Sums;

static ClothUVVertexParams vertex_params;
static gboolean true_uv;
static gchar *picture_file;
static gdouble noise;

static gdouble
milliseconds (void)
{
  struct timespec t;

  clock_gettime (CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * (gdouble) t.tv_sec + 1e-6 * (gdouble) t.tv_nsec;
}

/* Normal of the true surface by what lies @reach px away; FALSE at breaks. */
static gboolean
get_normal (const MatchTruth * truth, gint x, gint y, gint reach,
    gdouble normal[3])
{
  const gfloat *p = truth->points + 3 * ((gsize) y * truth->width + x);
  const gsize row = 3 * (gsize) reach * truth->width;
  gdouble a[3], b[3], length;

  if (x < reach || y < reach || x >= truth->width - reach
      || y >= truth->height - reach)
    return FALSE;
  for (gint c = 0; c < 3; c++) {
    a[c] = (p + 3 * reach)[c] - (p - 3 * reach)[c];
    b[c] = (p + row)[c] - (p - row)[c];
  }
  if (!(fabs (a[2]) < 0.01 * reach && fabs (b[2]) < 0.01 * reach))
    return FALSE;
  normal[0] = a[1] * b[2] - a[2] * b[1];
  normal[1] = a[2] * b[0] - a[0] * b[2];
  normal[2] = a[0] * b[1] - a[1] * b[0];
  length = sqrt (normal[0] * normal[0] + normal[1] * normal[1]
      + normal[2] * normal[2]);
  for (gint c = 0; c < 3; c++)
    normal[c] /= length;
  return length > 0;
}

/* By how much the true surface turns over 12 px across or down, rad; NaN at breaks. */
static gdouble
get_turn (const MatchTruth * truth, gint x, gint y)
{
  gdouble most = 0;

  for (gint k = 0; k < 2; k++) {
    const gint dx = k ? 0 : 6, dy = k ? 6 : 0;
    gdouble a[3], b[3];

    if (x < 8 || y < 8 || x >= truth->width - 8 || y >= truth->height - 8
        || !get_normal (truth, x - dx, y - dy, 2, a)
        || !get_normal (truth, x + dx, y + dy, 2, b))
      return NAN;
    most = MAX (most, acos (CLAMP (a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
                -1, 1)));
  }
  return most;
}

static void
judge (const MatchTruth * truth, gfloat * const uv[N_WAYS],
    const gfloat * within, Sums * sums)
{
  const gsize n = (gsize) truth->width * truth->height;
  g_autofree gdouble *turns = g_new (gdouble, n);
  g_autofree gdouble *sorted = g_new (gdouble, n);
  gsize n_turns = 0;
  gdouble bound;

  for (gsize i = 0; i < n; i++) {
    turns[i] = truth->mask[i] ? get_turn (truth, (gint) (i % truth->width),
        (gint) (i / truth->width)) : NAN;
    if (!isnan (turns[i]))
      sorted[n_turns++] = turns[i];
  }
  qsort (sorted, n_turns, sizeof *sorted, cloth_compare_doubles);
  bound = n_turns ? sorted[n_turns * 9 / 10] : 0;
  for (gsize i = 0; i < n; i++) {
    const gfloat *p = truth->points + 3 * i;
    gdouble normal[3], cosine = 1;
    gboolean is[N_PARTS] = { FALSE };

    if (!truth->mask[i])
      continue;
    if (get_normal (truth, (gint) (i % truth->width),
            (gint) (i / truth->width), 2, normal))
      cosine = fabs (normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2])
          / sqrt (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    is[BEYOND] = isnan (within[2 * i]);
    is[ALL] = !is[BEYOND];
    is[FOLDS] = turns[i] >= bound && !is[BEYOND];
    is[OBLIQUE] = cosine < 0.5 && !is[BEYOND];
    for (gint way = 0; way < N_WAYS; way++)
      for (gint part = 0; part < N_PARTS; part++)
        if (is[part] && !isnan (uv[way][2 * i])) {
          const gfloat error = 1e3f * hypotf (uv[way][2 * i]
              - truth->uv[2 * i], uv[way][2 * i + 1] - truth->uv[2 * i + 1]);

          g_array_append_val (sums->errors[way][part], error);
        }
  }
}

/* Vertices of the cloth's grid held against the film's. */
static void
judge_vertices (const MatchFilm * film, guint frame, const MatchTruth * truth,
    const ClothMatchSurface * surface, const gfloat * uv, const ClothUV * dense,
    Sums * sums)
{
  const ClothGridShape shape = { 33, 35, {film->cloth_m[0], film->cloth_m[1]}
  };
  const ClothUVDepth depth = { MAX (noise, 0.02), 142.2, {0, 0, 1}
  };
  g_autoptr (ClothUVVertices) self = cloth_uv_vertices_new ();
  g_autofree ClothUVVertex *vertices = g_new (ClothUVVertex, 33 * 35);
  const gfloat *p = film->vertices + 3 * (gsize) frame * 33 * 35;

  cloth_uv_vertices_run (self, &vertex_params, &shape, surface, uv, dense,
      &depth, NULL, 0, vertices);
  for (guint i = 0; i < 33 * 35; i++, p += 3) {
    const gint x = (gint) rint (film->centre[0] + film->focal * p[0] / p[2]);
    const gint y = (gint) rint (film->centre[1] + film->focal * p[1] / p[2]);
    gboolean visible = FALSE;

    /* in sight where the surface is, or beside it: the cloth's edge */
    for (gint k = 0; k < 25; k++) {
      const gint nx = x + k % 5 - 2, ny = y + k / 5 - 2;

      if (nx >= 0 && ny >= 0 && nx < truth->width && ny < truth->height)
        visible |= fabsf (truth->points[3 * ((gsize) ny * truth->width + nx)
                + 2] - p[2]) < 0.004f;
    }
    sums->n_visible += visible;
    if (vertices[i].seen) {
      const gdouble *c = vertices[i].covariance;
      const gdouble matrix[9] = { c[0], c[1], c[2], c[1], c[3], c[4], c[2],
        c[4], c[5]
      };
      gdouble d[3], inverse[9], id[3];
      gfloat error, square;

      for (gint k = 0; k < 3; k++)
        d[k] = vertices[i].point[k] - p[k];
      error = (gfloat) (1e3 * sqrt (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
      cloth_mat3_inverse (matrix, inverse);
      cloth_mat3_vec (inverse, d, id);
      square = (gfloat) (d[0] * id[0] + d[1] * id[1] + d[2] * id[2]);
      g_array_append_val (sums->vertex_errors, error);
      g_array_append_val (sums->vertex_squares, square);
    }
  }
}

/* Writes a grey picture without padding as PNG. */
static void
write_png (const gchar * path, const guint8 * pixels, gint width, gint height)
{
  g_autofree gchar *line = g_strdup_printf ("appsrc name=source caps="
      "video/x-raw,format=GRAY8,width=%d,height=%d,framerate=1/1 "
      "format=time ! pngenc compression-level=9 ! filesink location=\"%s\"",
      width, height, path);
  g_autoptr (GError) error = NULL;
  GstElement *pipeline = gst_parse_launch (line, &error), *source;
  const gsize stride = ((gsize) width + 3) / 4 * 4;
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, stride * (gsize) height,
      NULL);
  GstMessage *message;

  if (error)
    g_error ("%s", error->message);
  for (gint y = 0; y < height; y++)
    gst_buffer_fill (buffer, stride * (gsize) y, pixels + (gsize) y * width,
        (gsize) width);
  source = gst_bin_get_by_name (GST_BIN (pipeline), "source");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  gst_app_src_push_buffer (GST_APP_SRC (source), buffer);
  gst_app_src_end_of_stream (GST_APP_SRC (source));
  message = gst_bus_timed_pop_filtered (GST_ELEMENT_BUS (pipeline),
      GST_CLOCK_TIME_NONE, GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  if (GST_MESSAGE_TYPE (message) == GST_MESSAGE_ERROR)
    g_error ("%s can't be written", path);
  gst_message_unref (message);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (source);
  gst_object_unref (pipeline);
}

/* The paper's figure 9: the film; checks of uv along the surface; and its figure 8 as errors,
 * in the picture and along the surface. All four side by side, cut to the cloth and halved. */
static void
draw (const MatchFilm * film, guint frame, const MatchTruth * truth,
    gfloat * const uv[N_WAYS])
{
  const guint8 *grey = film->film.pixels->data
      + (gsize) frame * truth->width * truth->height;
  gint box[4] = { truth->width, truth->height, 0, 0 }, width, height;
  g_autofree guint8 *to = NULL;

  for (gint y = 0; y < truth->height; y++)
    for (gint x = 0; x < truth->width; x++)
      if (truth->mask[(gsize) y * truth->width + x]) {
        box[0] = MIN (box[0], x);
        box[1] = MIN (box[1], y);
        box[2] = MAX (box[2], x);
        box[3] = MAX (box[3], y);
      }
  width = box[2] - box[0] + 1;
  height = box[3] - box[1] + 1;
  to = g_malloc0 (4 * (gsize) width * height);
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      const gsize i = (gsize) (y + box[1]) * truth->width + x + box[0];
      guint8 *at = to + 4 * (gsize) width * y + x;
      const gfloat *p = uv[SURFACE] + 2 * i;

      at[0] = grey[i];
      if (!truth->mask[i])
        continue;
      at[width] = isnan (p[0]) ? 40 : (gint) (floor (p[0] / CHECK)
          + floor (p[1] / CHECK)) % 2 ? 110 : 235;
      for (gint k = 0; k < 2; k++) {
        const gfloat *q = uv[k ? SURFACE : PICTURE] + 2 * i;
        const gdouble e = 1e3 * hypot (q[0] - truth->uv[2 * i],
            q[1] - truth->uv[2 * i + 1]);

        at[(2 + k) * width] = isnan (e) ? 40 : (guint8) (80
            + 175 * MIN (e / WHITE, 1));
      }
    }
  for (gint y = 0; y < height / 2; y++)
    for (gint x = 0; x < 2 * width; x++) {
      const guint8 *from = to + 8 * (gsize) width * y + 2 * x;

      to[2 * (gsize) width * y + x] = (guint8) ((from[0] + from[1]
              + from[4 * width] + from[4 * width + 1] + 2) / 4);
    }
  write_png (picture_file, to, 2 * width, height / 2);
}

static void
run_frame (const MatchFilm * film, guint frame,
    const ClothReference * reference, ClothCvSift * sift,
    ClothGrower * grower, ClothVerifier * verifier, ClothPool * pool,
    const ClothUVParams * params, ClothUV * dense, MatchTruth * truth,
    Sums * sums)
{
  const ClothReferenceFeatures *r = cloth_reference_get_features (reference);
  const gint width = film->film.width, height = film->film.height;
  const gsize n = (gsize) width * height;
  const ClothCvPicture picture = { film->film.pixels->data
        + (gsize) frame * width * height, width, height, width
  };
  const ClothCvPicture mask = { truth->mask, width, height, width };
  const ClothMatchSurface surface = { truth->points, width, height, width };
  const ClothGrowParams grow = cloth_grow_default_params ();
  const ClothVerifyParams verify = cloth_verify_default_params ();
  g_autofree ClothMatch *matches = NULL;
  g_autofree gfloat *flat = g_new (gfloat, 3 * n);
  g_autofree gfloat *noisy = g_new (gfloat, 3 * n);
  gfloat *uv[N_WAYS];
  g_autofree gfloat *within = g_new (gfloat, 2 * n);
  g_autoptr (GArray) believed = g_array_new (FALSE, FALSE,
      sizeof (ClothUVMatch));
  const ClothMatchSurface paper = { flat, width, height, width };
  const ClothMatchSurface seen = { noisy, width, height, width };
  ClothUVParams without = *params;
  gdouble ms = G_MAXDOUBLE, worst = 0;
  ClothCvFeatures f;
  ClothGrowth growth;
  ClothVerification verification;
  ClothUVCounts counts, other;
  ClothRandom random;

  match_film_look (film, frame, truth);
  if (!cloth_cv_sift_run (sift, &picture, &mask, &f, NULL))
    g_error ("no features");
  matches = g_new (ClothMatch, f.n);
  cloth_grower_run (grower, &grow, reference, &f, &surface, matches, &growth,
      pool, CLOTH_SIMD_BEST);
  cloth_verifier_run (verifier, &verify, reference, &f, &surface, matches,
      &verification, NULL);
  for (guint i = 0; i < f.n; i++) {
    const guint32 at = matches[i].reference;
    ClothUVMatch m;
    gdouble is[2];

    if (matches[i].state != CLOTH_MATCH_MATCHED)
      continue;
    m = (ClothUVMatch) {
    f.x[i], f.y[i], (gfloat) ((r->x[at] + 0.5) / r->width
          * film->cloth_m[0]), (gfloat) ((r->y[at] + 0.5) / r->height
          * film->cloth_m[1])};
    if (true_uv) {
      if (!match_truth_get_uv (truth, f.x[i], f.y[i], is))
        continue;
      m.u = (gfloat) is[0];
      m.v = (gfloat) is[1];
    }
    g_array_append_val (believed, m);
  }
  cloth_random_init (&random, frame);
  for (gsize i = 0; i < n; i++) {
    const gfloat *p = truth->points + 3 * i;
    const gdouble s = noise > 0 ? 1 / (1 + cloth_random_gaussian (&random)
        * noise * p[2] / 142.2) : 1;

    for (gint c = 0; c < 3; c++)
      noisy[3 * i + c] = (gfloat) (p[c] * s);
    flat[3 * i] = truth->mask[i] ? (gfloat) (i % width) : NAN;
    flat[3 * i + 1] = truth->mask[i] ? (gfloat) (i / width) : NAN;
    flat[3 * i + 2] = truth->mask[i] ? 1 : NAN;
  }
  for (gint way = 0; way < N_WAYS; way++)
    uv[way] = g_new (gfloat, 2 * n);
  for (gint round = 0; round < ROUNDS; round++) {
    const gdouble start = milliseconds ();

    cloth_uv_run (dense, params, (const ClothUVMatch *) believed->data,
        believed->len, &seen, pool, uv[SURFACE], &counts);
    ms = MIN (ms, milliseconds () - start);
  }
  judge_vertices (film, frame, truth, &seen, uv[SURFACE], dense, sums);
  without.reach = 0;
  cloth_uv_run (dense, &without, (const ClothUVMatch *) believed->data,
      believed->len, &seen, pool, within, &other);
  /* the picture as a surface: the same triangles as far as the surface has them */
  without.stretch.stretch = 0.9;
  without.stretch.slack = 1e9;
  without.outlier = without.smooth = 0;
  cloth_uv_run (dense, &without, (const ClothUVMatch *) believed->data,
      believed->len, &paper, pool, uv[PICTURE], &other);
  for (gsize i = 0; i < 2 * n; i++)
    if (isnan (within[i]))
      uv[PICTURE][i] = NAN;
  judge (truth, uv, within, sums);
  if (picture_file)
    draw (film, frame, truth, uv);
  for (gsize i = 0; i < n; i++)
    if (!isnan (uv[SURFACE][2 * i]))
      worst = MAX (worst, hypot (uv[SURFACE][2 * i] - truth->uv[2 * i],
              uv[SURFACE][2 * i + 1] - truth->uv[2 * i + 1]));
  g_print ("%5u  %6u  %6u  %5u  %6u  %7u  %5.1f%%  %5.1f%%  %5.2f  %6.1f  "
      "%5.1f\n", frame, believed->len, counts.n_places, counts.n_outliers,
      counts.n_triangles, counts.n_surface, 100. * counts.n_between
      / MAX (counts.n_surface, 1), 100. * (counts.n_between
          + counts.n_beyond) / MAX (counts.n_surface, 1),
      1e3 * counts.sigma, 1e3 * worst, ms);
  sums->ms += ms;
  sums->between += (gdouble) counts.n_between / MAX (counts.n_surface, 1);
  sums->share += (gdouble) (counts.n_between + counts.n_beyond)
      / MAX (counts.n_surface, 1);
  sums->n_frames++;
  for (gint way = 0; way < N_WAYS; way++)
    g_free (uv[way]);
}

static gint
compare_floats (gconstpointer a, gconstpointer b)
{
  const gfloat x = *(const gfloat *) a, y = *(const gfloat *) b;

  return x < y ? -1 : x > y;
}

static void
tell_vertices (Sums * sums)
{
  GArray *e = sums->vertex_errors, *s = sums->vertex_squares;
  gdouble mean = 0;
  guint wrong = 0;

  if (!e->len)
    return;
  qsort (e->data, e->len, sizeof (gfloat), compare_floats);
  qsort (s->data, s->len, sizeof (gfloat), compare_floats);
  for (guint i = 0; i < e->len; i++) {
    mean += g_array_index (e, gfloat, i) / e->len;
    wrong += g_array_index (e, gfloat, i) > 10;
  }
  g_print ("vertices: %u of %u in sight, error mean %.3f, median %.3f, 95%% "
      "%.3f, 99%% %.3f mm, %u over 10 mm; chi² median %.2f (2.37 of 3), 95%% "
      "%.2f (7.81)\n", e->len, sums->n_visible, mean,
      g_array_index (e, gfloat, e->len / 2),
      g_array_index (e, gfloat, (gsize) e->len * 95 / 100),
      g_array_index (e, gfloat, (gsize) e->len * 99 / 100), wrong,
      g_array_index (s, gfloat, s->len / 2),
      g_array_index (s, gfloat, (gsize) s->len * 95 / 100));
}

static void
tell (Sums * sums)
{
  const gdouble n = MAX (sums->n_frames, 1);

  for (gint part = 0; part < N_PARTS; part++)
    for (gint way = 0; way < N_WAYS; way++) {
      GArray *e = sums->errors[way][part];
      gdouble mean = 0;

      if (!e->len)
        continue;
      qsort (e->data, e->len, sizeof (gfloat), compare_floats);
      for (guint i = 0; i < e->len; i++)
        mean += g_array_index (e, gfloat, i) / e->len;
      g_print ("%-10s %-15s %8u px  mean %6.3f  median %6.3f  95%% %6.3f  "
          "99%% %6.3f mm\n", part_names[part],
          way == SURFACE ? "along surface" : "in the picture", e->len, mean,
          g_array_index (e, gfloat, e->len / 2),
          g_array_index (e, gfloat, (gsize) e->len * 95 / 100),
          g_array_index (e, gfloat, (gsize) e->len * 99 / 100));
    }
  tell_vertices (sums);
  g_print ("mean share of the surface with uv: %.1f%%, in triangles %.1f%%; "
      "%.1f ms\n", 100 * sums->share / n, 100 * sums->between / n,
      sums->ms / n);
}

static void
run_film (const gchar * folder, const ClothUVParams * params, gint from,
    gint step, gint to)
{
  ClothReferenceParams reference_params = cloth_reference_default_params ();
  MatchFilm film;
  ClothCvPicture picture;
  g_autoptr (ClothReference) reference = NULL;
  g_autoptr (ClothPool) pool = cloth_pool_new (2);
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (&reference_params.sift,
      NULL);
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autoptr (ClothUV) dense = cloth_uv_new ();
  g_autoptr (GError) error = NULL;
  MatchTruth truth;
  Sums sums = { 0 };

  match_film_load (&film, folder, NULL, FALSE);
  reference_params.cloth_m[0] = film.cloth_m[0];
  reference_params.cloth_m[1] = film.cloth_m[1];
  picture = (ClothCvPicture) {
  film.reference.pixels->data, film.reference.width, film.reference.height,
        film.reference.width};
  reference = cloth_reference_new (&reference_params, &picture, pool, &error);
  if (!reference)
    g_error ("%s", error->message);
  for (gint way = 0; way < N_WAYS; way++)
    for (gint part = 0; part < N_PARTS; part++)
      sums.errors[way][part] = g_array_new (FALSE, FALSE, sizeof (gfloat));
  sums.vertex_errors = g_array_new (FALSE, FALSE, sizeof (gfloat));
  sums.vertex_squares = g_array_new (FALSE, FALSE, sizeof (gfloat));
  g_print ("frame  match   places  wrong  triang  surface  between   with   "
      "sigma   worst   ms\n");
  match_truth_init (&truth, film.film.width, film.film.height);
  for (guint frame = (guint) from; frame < MIN (film.n_frames, (guint) to);
      frame += (guint) step)
    run_frame (&film, frame, reference, sift, grower, verifier, pool, params,
        dense, &truth, &sums);
  tell (&sums);
  match_truth_clear (&truth);
  match_film_clear (&film);
}

int
main (int argc, char **argv)
{
  ClothUVParams params = cloth_uv_default_params ();
  gint step = 1, from = 0, to = 100000;
  const GOptionEntry entries[] = {
    {"from", 0, 0, G_OPTION_ARG_INT, &from, "first frame", "N"},
    {"to", 0, 0, G_OPTION_ARG_INT, &to, "frame after the last", "N"},
    {"step", 0, 0, G_OPTION_ARG_INT, &step, "every so many frames", "N"},
    {"true-uv", 0, 0, G_OPTION_ARG_NONE, &true_uv,
        "what the matched places truly show", NULL},
    {"noise", 0, 0, G_OPTION_ARG_DOUBLE, &noise,
        "white noise of disparities", "PX"},
    {"picture", 0, 0, G_OPTION_ARG_FILENAME, &picture_file,
          "film, checks, and errors in the picture and along the surface of the last frame",
        "FILE.png"},
    {"together", 0, 0, G_OPTION_ARG_DOUBLE, &params.together, NULL, NULL},
    {"outlier", 0, 0, G_OPTION_ARG_DOUBLE, &params.outlier, NULL, NULL},
    {"smooth", 0, 0, G_OPTION_ARG_DOUBLE, &params.smooth, NULL, NULL},
    {"longest", 0, 0, G_OPTION_ARG_DOUBLE, &params.longest, NULL, NULL},
    {"reach", 0, 0, G_OPTION_ARG_DOUBLE, &params.reach, NULL, NULL},
    {"stretch", 0, 0, G_OPTION_ARG_DOUBLE, &params.stretch.stretch, NULL,
        NULL},
    {"slack", 0, 0, G_OPTION_ARG_DOUBLE, &params.stretch.slack, NULL, NULL},
    {"depth-step", 0, 0, G_OPTION_ARG_DOUBLE, &params.stretch.depth_step, NULL,
        NULL},
    {"radius", 0, 0, G_OPTION_ARG_DOUBLE, &vertex_params.radius, NULL, NULL},
    {"edge", 0, 0, G_OPTION_ARG_DOUBLE, &vertex_params.edge, NULL, NULL},
    {"rival", 0, 0, G_OPTION_ARG_DOUBLE, &vertex_params.rival, NULL, NULL},
    {NULL}
  };
  g_autoptr (GOptionContext) context = g_option_context_new ("FOLDER");
  g_autoptr (GError) error = NULL;

  vertex_params = cloth_uv_vertex_default_params ();
  g_option_context_add_main_entries (context, entries, NULL);
  if (!g_option_context_parse (context, &argc, &argv, &error))
    g_error ("%s", error->message);
  gst_init (&argc, &argv);
  if (argc > 1)
    run_film (argv[1], &params, MAX (from, 0), MAX (step, 1), to);
  else
    g_print ("no film: see --help\n");
  return 0;
}
