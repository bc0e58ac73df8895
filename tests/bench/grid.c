/* The vertices of a printed cloth's grid in a rendered film, held against the truth.
 *
 *   bench-grid FOLDER [--NAME=VALUE…]
 *
 * The folder is one of matchfilm.h; without it there is nothing to do. Features are matched
 * on the true surface, or without any. χ²/2 is the mean of squared errors in units of their
 * covariance over two: 1 where covariances are honest. Times are those of all threads
 * together, the best of three rounds.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/match.h"

#include <gst/gst.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/bench/matchfilm.h"

#define COLUMNS 33
#define ROWS 35
#define N (COLUMNS * ROWS)
#define ROUNDS 3
/* A vertex is seen where a pixel so near shows the cloth so near to it: px, m in uv. */
#define NEAR 1.5
#define SAME 0.005
/* What is farther off than this is wrong, px. */
#define WRONG 3.0

/* Of vertices placed in one way. */
typedef struct
{
  guint n, n_wrong, n_hidden;
  gdouble square, chi, sigma;
  guint n_far;                  /* beyond 3 σ: of normal errors 1.1% */
  GArray *errors;
} Placed;

typedef struct
{
  Placed placed[3];             /* by state */
  guint visible, found, contradicted, n_frames;
  gdouble ms;
} Sums;

static gboolean no_surface, no_mask, list;

/* Of all threads on all processors: other programs that run meanwhile count less. */
static gdouble
milliseconds (void)
{
  struct timespec t;

  clock_gettime (CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * (gdouble) t.tv_sec + 1e-6 * (gdouble) t.tv_nsec;
}

/* Whether the truth shows a vertex at a place. */
static gboolean
is_seen (const MatchFilm * film, const MatchTruth * truth, guint vertex,
    const gdouble at[2])
{
  const gdouble u = film->cloth_m[0] * (vertex % COLUMNS) / (COLUMNS - 1);
  const gdouble v = film->cloth_m[1] * (vertex / COLUMNS) / (ROWS - 1);

  for (gint y = (gint) ceil (at[1] - NEAR); y <= (gint) (at[1] + NEAR); y++)
    for (gint x = (gint) ceil (at[0] - NEAR); x <= (gint) (at[0] + NEAR); x++) {
      const gsize i = (gsize) y * truth->width + x;

      if (x >= 0 && y >= 0 && x < truth->width && y < truth->height
          && truth->mask[i] && hypot (truth->uv[2 * i] - u,
              truth->uv[2 * i + 1] - v) < SAME)
        return TRUE;
    }
  return FALSE;
}

static void
compare (const MatchFilm * film, const MatchTruth * truth, guint frame,
    const ClothGridVertex * vertices, Sums * sums)
{
  for (guint v = 0; v < N; v++) {
    const gfloat *p = film->vertices + 3 * ((gsize) frame * N + v);
    const gdouble at[2] = {
      film->centre[0] + film->focal * p[0] / p[2],
      film->centre[1] + film->focal * p[1] / p[2]
    };
    const ClothGridVertex *r = &vertices[v];
    const gboolean seen = is_seen (film, truth, v, at);
    Placed *placed = &sums->placed[r->state];
    gdouble dx, dy, square, chi;

    sums->visible += seen;
    if (r->state == CLOTH_GRID_UNSEEN)
      continue;
    if (!seen) {
      placed->n_hidden++;
      continue;
    }
    sums->found++;
    placed->n++;
    dx = r->x - at[0];
    dy = r->y - at[1];
    if (list)
      g_print ("%u %u %d  %.3f %.3f  %.4f %.4f  %.5f %.5f %.5f\n", frame, v,
          r->state, at[0], at[1], dx, dy, r->xx, r->xy, r->yy);
    square = dx * dx + dy * dy;
    if (square > WRONG * WRONG) {
      placed->n_wrong++;
      continue;
    }
    chi = (r->yy * dx * dx - 2 * r->xy * dx * dy + r->xx * dy * dy)
        / (r->xx * r->yy - r->xy * r->xy);
    placed->square += square;
    placed->chi += chi;
    placed->n_far += chi > 9;
    placed->sigma += r->xx + r->yy;
    square = sqrt (square);
    g_array_append_val (placed->errors, square);
  }
}

static gint
compare_doubles (gconstpointer a, gconstpointer b)
{
  const gdouble x = *(const gdouble *) a, y = *(const gdouble *) b;

  return x < y ? -1 : x > y;
}

static void
tell (const Sums * sums)
{
  static const gchar *const names[] = { "", "by matches", "by the print" };

  g_print ("%u frames, %.0f vertices visible in each, %.1f%% of these found, "
      "%.1f contradicted, %.1f ms\n", sums->n_frames,
      (gdouble) sums->visible / MAX (sums->n_frames, 1),
      100. * sums->found / MAX (sums->visible, 1),
      (gdouble) sums->contradicted / MAX (sums->n_frames, 1),
      sums->ms / MAX (sums->n_frames, 1));
  for (gint k = 1; k < 3; k++) {
    const Placed *p = &sums->placed[k];
    const gdouble n = MAX (p->errors->len, 1);

    g_array_sort (p->errors, compare_doubles);
    g_print ("%-12s  %6u  RMS an axis %.4f px, told %.4f, median of errors "
        "%.4f, chi2/2 %.2f, beyond 3 sigma %.1f%%; wrong by over %.0f px %u, "
        "hidden in truth %u\n", names[k], p->n, sqrt (p->square / (2 * n)),
        sqrt (p->sigma / (2 * n)), p->errors->len ? g_array_index (p->errors,
            gdouble, p->errors->len / 2) : NAN, p->chi / (2 * n),
        100 * p->n_far / n, WRONG, p->n_wrong, p->n_hidden);
  }
}

static void
run_film (const gchar * folder, const ClothGridParams * params, guint from,
    guint step)
{
  const ClothGrowParams grow = cloth_grow_default_params ();
  const ClothVerifyParams verify = cloth_verify_default_params ();
  ClothReferenceParams reference_params = cloth_reference_default_params ();
  MatchFilm film;
  MatchTruth truth;
  Sums sums = { 0 };
  g_autoptr (ClothPool) pool = cloth_pool_new (2);
  g_autoptr (ClothCvSift) sift = NULL;
  g_autoptr (ClothReference) reference = NULL;
  g_autoptr (ClothGridder) gridder = NULL;
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autoptr (GError) error = NULL;

  match_film_load (&film, folder, NULL, FALSE);
  {
    const ClothGridShape shape = { COLUMNS, ROWS,
      {film.cloth_m[0], film.cloth_m[1]}
    };
    const ClothCvPicture flat = { film.reference.pixels->data,
      film.reference.width, film.reference.height, film.reference.width
    };
    const ClothImage picture = { flat.data, flat.width, flat.height,
      flat.stride
    };

    memcpy (reference_params.cloth_m, film.cloth_m, sizeof film.cloth_m);
    reference = cloth_reference_new (&reference_params, &flat, pool, &error);
    gridder = cloth_gridder_new (&shape, &picture, &error);
    sift = cloth_cv_sift_new (&reference_params.sift, &error);
    if (!reference || !gridder || !sift)
      g_error ("%s", error->message);
  }
  match_truth_init (&truth, film.film.width, film.film.height);
  for (gint k = 0; k < 3; k++)
    sums.placed[k].errors = g_array_new (FALSE, FALSE, sizeof (gdouble));
  for (guint frame = from; frame < film.n_frames; frame += step) {
    const gint width = film.film.width, height = film.film.height;
    const ClothCvPicture picture = { film.film.pixels->data
          + (gsize) frame * width * height, width, height, width
    };
    const ClothImage image = { picture.data, width, height, width };
    const ClothCvPicture cv_mask = { truth.mask, width, height, width };
    const ClothImage mask = { truth.mask, width, height, width };
    const ClothMatchSurface surface = { truth.points, width, height, width };
    const ClothMatchSurface *under = no_surface ? NULL : &surface;
    g_autofree ClothMatch *matches = NULL;
    g_autofree ClothGridMatch *verified = NULL;
    static ClothGridVertex vertices[N];
    gdouble best = G_MAXDOUBLE;
    ClothCvFeatures features;
    ClothGrowth growth;
    ClothVerification verification;
    ClothGridding gridding;
    guint n;

    match_film_look (&film, frame, &truth);
    if (!cloth_cv_sift_run (sift, &picture, &cv_mask, &features, NULL))
      g_error ("no features");
    matches = g_new (ClothMatch, features.n);
    verified = g_new (ClothGridMatch, features.n);
    cloth_grower_run (grower, &grow, reference, &features, under, matches,
        &growth, pool, CLOTH_SIMD_BEST);
    cloth_verifier_run (verifier, &verify, reference, &features, under,
        matches, &verification, pool);
    n = cloth_grid_get_matches (reference, film.cloth_m, &features, matches,
        verified);
    for (gint round = 0; round < ROUNDS; round++) {
      const gdouble start = milliseconds ();

      cloth_gridder_run (gridder, params, verified, n, &image,
          no_mask ? NULL : &mask, under, vertices, &gridding, pool,
          CLOTH_SIMD_BEST);
      best = MIN (best, milliseconds () - start);
    }
    sums.ms += best;
    sums.n_frames++;
    sums.contradicted += gridding.n_contradicted;
    compare (&film, &truth, frame, vertices, &sums);
  }
  tell (&sums);
  for (gint k = 0; k < 3; k++)
    g_array_unref (sums.placed[k].errors);
  match_truth_clear (&truth);
  match_film_clear (&film);
}

int
main (int argc, char **argv)
{
  ClothGridParams params = cloth_grid_default_params ();
  gint from = 0, step = 1, most = (gint) params.most, least =
      (gint) params.least, rounds = (gint) params.align.rounds;
  const GOptionEntry entries[] = {
    {"no-surface", 0, 0, G_OPTION_ARG_NONE, &no_surface,
        "distances in the picture bound those on the cloth", NULL},
    {"no-mask", 0, 0, G_OPTION_ARG_NONE, &no_mask,
        "vertices are looked for everywhere", NULL},
    {"list", 0, 0, G_OPTION_ARG_NONE, &list,
        "each vertex: frame, vertex, state, truth, error, covariance", NULL},
    {"from", 0, 0, G_OPTION_ARG_INT, &from, "first frame", "N"},
    {"step", 0, 0, G_OPTION_ARG_INT, &step, "every so many frames", "N"},
    {"beyond", 0, 0, G_OPTION_ARG_DOUBLE, &params.beyond, NULL, NULL},
    {"radius", 0, 0, G_OPTION_ARG_DOUBLE, &params.radius, NULL, NULL},
    {"most", 0, 0, G_OPTION_ARG_INT, &most, NULL, NULL},
    {"least", 0, 0, G_OPTION_ARG_INT, &least, NULL, NULL},
    {"noise", 0, 0, G_OPTION_ARG_DOUBLE, &params.noise, NULL, NULL},
    {"bend", 0, 0, G_OPTION_ARG_DOUBLE, &params.bend, NULL, NULL},
    {"outlier", 0, 0, G_OPTION_ARG_DOUBLE, &params.outlier, NULL, NULL},
    {"rival", 0, 0, G_OPTION_ARG_DOUBLE, &params.rival, NULL, NULL},
    {"uncertain", 0, 0, G_OPTION_ARG_DOUBLE, &params.uncertain, NULL, NULL},
    {"window", 0, 0, G_OPTION_ARG_INT, &params.align.radius, NULL, NULL},
    {"align-bend", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.bend, NULL, NULL},
    {"blur", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.blur, NULL, NULL},
    {"reference-blur", 0, 0, G_OPTION_ARG_DOUBLE,
        &params.align.reference_blur, NULL, NULL},
    {"align-outlier", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.outlier, NULL,
        NULL},
    {"done", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.done, NULL, NULL},
    {"rounds", 0, 0, G_OPTION_ARG_INT, &rounds, NULL, NULL},
    {"shift", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.shift, NULL, NULL},
    {"likeness", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.likeness, NULL,
        NULL},
    {"all", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.all, NULL, NULL},
    {"contrast", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.contrast, NULL,
        NULL},
    {"share", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.share, NULL, NULL},
    {"centre", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.centre, NULL, NULL},
    {"correlation", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.correlation, NULL,
        NULL},
    {"model", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.model, NULL, NULL},
    {"floor", 0, 0, G_OPTION_ARG_DOUBLE, &params.align.floor, NULL, NULL},
    {NULL}
  };
  g_autoptr (GOptionContext) context = g_option_context_new ("FOLDER");
  g_autoptr (GError) error = NULL;

  g_option_context_add_main_entries (context, entries, NULL);
  if (!g_option_context_parse (context, &argc, &argv, &error))
    g_error ("%s", error->message);
  params.most = (guint) most;
  params.least = (guint) least;
  params.align.rounds = (guint) rounds;
  gst_init (&argc, &argv);
  if (argc > 1)
    run_film (argv[1], &params, (guint) MAX (from, 0), (guint) MAX (step, 1));
  else
    g_print ("no film: see --help\n");
  return 0;
}
