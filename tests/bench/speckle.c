/* A speckled cylinder that was moved, filmed by two cameras: how rigid it looks.
 *
 *   bench-speckle FOLDER
 *
 * The folder is multidic_cylinder of MultiDIC's sample data; without it there is nothing to
 * do. Camera 201's picture of the first pose is the flat print; a grid of its places is looked
 * for in all pictures, triangulated by MultiDIC's own DLT parameters, and what a rotation and
 * a translation (W. Kabsch, 1976) leave of each pose against the first is printed. Features
 * alone gave 0.015 to 0.016 mm over 1,070 to 1,094 points.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/match.h"

#include <gst/gst.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/rig/camera.h"
#include "gst/rig/triangulate.h"
#include "tests/bench/matchfilm.h"

#define POSES 5
/* Between vertices, px of the first picture. */
#define STEP 20
/* Of a pixel on the cylinder, m. */
#define PIXEL 0.00011
/* What is farther off than so many RMS is left out, once. */
#define OUTLIER 5.0

/* As a least-squares fit of Brown's model to the distorted and undistorted corners in
 * cameraCBparameters_cam_20x.mat has them: centre, k1, k2, p1, p2, k3 for a focal length of
 * 3000 px; which focal length doesn't matter. */
static const gdouble lenses[2][7] = {
  {1226.8298, 1608.766, 0.20454091, -0.034495536, -0.0028825823, -0.002334947,
      -2.7115402},
  {1247.2665, 1655.3493, 0.23048781, -0.51447871, 7.7770124e-06, 0.00034015712,
      -0.47558455}
};

typedef struct
{
  gint columns, rows;
  guint n;
  ClothReference *reference;
  ClothGridder *gridder;
  ClothGridParams params;
  gdouble cloth_m[2];
  gint last;
} Bench;

static void
read_dlt (const gchar * folder, const gchar * camera, gdouble projection[12])
{
  g_autofree gchar *name = g_strdup_printf ("%s/reference_DLT_%s.csv", folder,
      camera);
  g_autofree gchar *text = NULL;
  gchar *at;

  if (!g_file_get_contents (name, &text, NULL, NULL))
    g_error ("%s: can't be read", name);
  at = text;
  for (gint k = 0; k < 12; k++, at += *at == ',')
    projection[k] = g_ascii_strtod (at, &at);
}

/* Where a picture shows the grid, undone of the lens, with MATLAB's pixels that begin at
 * 1. */
static void
look (const Bench * bench, const MatchPictures * film, guint camera,
    gdouble * x, gdouble * y, gdouble * variances, ClothPool * pool)
{
  const ClothCvPicture picture = { film->pixels->data, film->width,
    film->height, film->width
  };
  const ClothImage image = { picture.data, film->width, film->height,
    film->width
  };
  const ClothCvSiftParams sift_params = cloth_cv_sift_default_params ();
  const ClothGrowParams grow = cloth_grow_default_params ();
  const ClothVerifyParams verify = cloth_verify_default_params ();
  const gdouble *lens = lenses[camera];
  ClothCamera model = { NULL, film->width, film->height,
    {3000, 0, lens[0], 0, 3000, lens[1], 0, 0, 1}, CLOTH_LENS_BROWN5,
    {lens[2], lens[3], lens[4], lens[5], lens[6]}, {1, 0, 0, 0, 1, 0, 0, 0, 1}
  };
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (&sift_params, NULL);
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autofree ClothGridVertex *vertices = g_new (ClothGridVertex, bench->n);
  g_autofree ClothGridMatch *verified = NULL;
  g_autofree ClothMatch *matches = NULL;
  ClothCvFeatures features;
  ClothGrowth growth;
  ClothVerification verification;
  ClothGridding gridding;
  guint n;

  if (!cloth_cv_sift_run (sift, &picture, NULL, &features, NULL))
    g_error ("no features");
  matches = g_new (ClothMatch, features.n);
  verified = g_new (ClothGridMatch, features.n);
  cloth_grower_run (grower, &grow, bench->reference, &features, NULL, matches,
      &growth, pool, CLOTH_SIMD_BEST);
  cloth_verifier_run (verifier, &verify, bench->reference, &features, NULL,
      matches, &verification, NULL);
  n = cloth_grid_get_matches (bench->reference, bench->cloth_m, &features,
      matches, verified);
  cloth_gridder_run (bench->gridder, &bench->params, verified, n, &image,
      NULL, NULL, vertices, &gridding, pool, CLOTH_SIMD_BEST);
  g_print ("  %u features, %u verified, %u vertices aligned\n", features.n, n,
      gridding.n_aligned);
  for (guint v = 0; v < bench->n; v++) {
    const ClothGridVertex *r = &vertices[v];

    x[v] = y[v] = NAN;
    variances[v] = (r->xx + r->yy) / 2;
    if (r->state != CLOTH_GRID_ALIGNED)
      continue;
    cloth_camera_undistort_points (&model, 1, &r->x, &r->y, &x[v], &y[v], NULL);
    x[v] = 3000 * x[v] + lens[0] + 1;
    y[v] = 3000 * y[v] + lens[1] + 1;
  }
}

/* RMS of what a motion leaves of @to over @from, for the points @in. */
static gdouble
fit_motion (guint n, const gdouble (*from)[3], const gdouble (*to)[3],
    const gboolean * in, gdouble * residuals, gdouble shift[3])
{
  gdouble means[2][3] = { {0} }, cross[9] = { 0 }, r[9], sum = 0;
  guint count = 0;

  for (guint i = 0; i < n; i++)
    if (in[i]) {
      count++;
      for (gint c = 0; c < 3; c++) {
        means[0][c] += from[i][c];
        means[1][c] += to[i][c];
      }
    }
  for (gint c = 0; c < 3; c++) {
    means[0][c] /= count;
    means[1][c] /= count;
    shift[c] = means[1][c] - means[0][c];
  }
  for (guint i = 0; i < n; i++)
    for (gint c = 0; in[i] && c < 3; c++)
      for (gint d = 0; d < 3; d++)
        cross[3 * c + d] += (to[i][c] - means[1][c]) * (from[i][d]
            - means[0][d]);
  if (!cloth_mat3_nearest_rotation (cross, r))
    g_error ("no motion");
  for (guint i = 0; i < n; i++) {
    gdouble square = 0;

    for (gint c = 0; c < 3; c++) {
      gdouble e = to[i][c] - means[1][c];

      for (gint d = 0; d < 3; d++)
        e -= r[3 * c + d] * (from[i][d] - means[0][d]);
      square += e * e;
    }
    residuals[i] = sqrt (square);
    if (in[i])
      sum += square;
  }
  return sqrt (sum / count);
}

static void
compare (guint n, const gdouble (*points)[3], guint pose)
{
  const gdouble (*first)[3] = points, (*now)[3] = points + (gsize) pose *n;
  g_autofree gboolean *in = g_new (gboolean, n);
  g_autofree gdouble *residuals = g_new (gdouble, n);
  gdouble shift[3], all, rms;
  guint count = 0, left = 0;

  for (guint i = 0; i < n; i++)
    count += in[i] = isfinite (first[i][0] + now[i][0]);
  all = fit_motion (n, first, now, in, residuals, shift);
  for (guint i = 0; i < n; i++)
    left += in[i] = in[i] && residuals[i] <= OUTLIER * all;
  rms = fit_motion (n, first, now, in, residuals, shift);
  g_print ("pose %u: moved %.3f mm; %u points, RMS %.4f mm; without %u beyond "
      "%.0f RMS %.4f mm\n", pose + 1, sqrt (shift[0] * shift[0]
          + shift[1] * shift[1] + shift[2] * shift[2]), count, all,
      count - left, OUTLIER, rms);
}

static void
run (Bench * bench, const gchar * folder)
{
  static const gchar *const cameras[] = { "201", "202" };
  ClothReferenceParams reference_params = cloth_reference_default_params ();
  g_autoptr (ClothPool) pool = cloth_pool_new (2);
  g_autoptr (ClothTriangulator) triangulator = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gdouble (*points)[3] = NULL;
  g_autofree gdouble *planes = NULL;
  gdouble projections[24];
  ClothGridShape shape;
  MatchPictures flat;

  for (gint k = 0; k < 2; k++)
    read_dlt (folder, cameras[k], projections + 12 * k);
  triangulator = cloth_triangulator_new_projections (2, projections, &error);
  match_pictures_load (folder, "speckle_201/201_1.jpg", &flat);
  bench->cloth_m[0] = reference_params.cloth_m[0] = PIXEL * flat.width;
  bench->cloth_m[1] = reference_params.cloth_m[1] = PIXEL * flat.height;
  shape = (ClothGridShape) {
    flat.width / STEP + 1, flat.height / STEP + 1, {
    bench->cloth_m[0], bench->cloth_m[1]}
  };
  bench->n = (guint) (shape.columns * shape.rows);
  {
    const ClothCvPicture picture = { flat.pixels->data, flat.width,
      flat.height, flat.width
    };
    const ClothImage image = { picture.data, flat.width, flat.height,
      flat.width
    };

    reference_params.sides = 1;
    reference_params.oblique = 0;
    bench->reference = cloth_reference_new (&reference_params, &picture, pool,
        &error);
    bench->gridder = cloth_gridder_new (&shape, &image, &error);
  }
  if (error)
    g_error ("%s", error->message);
  points = (gdouble (*)[3]) g_new (gdouble, (gsize) 3 * POSES * bench->n);
  planes = g_new (gdouble, (gsize) 6 * bench->n);
  for (guint pose = 0; pose < (guint) CLAMP (bench->last, 2, POSES); pose++) {
    gdouble *planes_of[2] = { planes, planes + 3 * bench->n };
    ClothTriangulateView views[2];
    const ClothTriangulation *result;

    for (guint k = 0; k < 2; k++) {
      g_autofree gchar *name = g_strdup_printf ("speckle_%s/%s_%u.jpg",
          cameras[k], cameras[k], pose + 1);
      gdouble *p = planes_of[k];
      MatchPictures film;

      match_pictures_load (folder, name, &film);
      look (bench, &film, k, p, p + bench->n, p + 2 * bench->n, pool);
      views[k] = (ClothTriangulateView) {
      p, p + bench->n, p + 2 * bench->n, NULL, p + 2 * bench->n};
      g_byte_array_unref (film.pixels);
    }
    if (!cloth_triangulator_run (triangulator, 2, views, bench->n, &result,
            &error))
      g_error ("%s", error->message);
    for (guint v = 0; v < bench->n; v++)
      for (gint c = 0; c < 3; c++)
        points[(gsize) pose * bench->n + v][c] = result->position[c][v];
    if (pose > 0)
      compare (bench->n, (const gdouble (*)[3]) points, pose);
  }
  cloth_gridder_free (bench->gridder);
  cloth_reference_free (bench->reference);
  g_byte_array_unref (flat.pixels);
}

int
main (int argc, char **argv)
{
  Bench bench = {.params = cloth_grid_default_params (),.last = POSES };
  gint window = CLOTH_ALIGN_MAX_RADIUS, rounds = 20;
  const GOptionEntry entries[] = {
    {"window", 0, 0, G_OPTION_ARG_INT, &window, NULL, NULL},
    {"blur", 0, 0, G_OPTION_ARG_DOUBLE, &bench.params.align.blur, NULL, NULL},
    {"done", 0, 0, G_OPTION_ARG_DOUBLE, &bench.params.align.done, NULL, NULL},
    {"rounds", 0, 0, G_OPTION_ARG_INT, &rounds, NULL, NULL},
    {"last", 0, 0, G_OPTION_ARG_INT, &bench.last, "last pose", NULL},
    {"likeness", 0, 0, G_OPTION_ARG_DOUBLE, &bench.params.align.likeness, NULL,
        NULL},
    {"uncertain", 0, 0, G_OPTION_ARG_DOUBLE, &bench.params.uncertain, NULL,
        NULL},
    {NULL}
  };
  g_autoptr (GOptionContext) context = g_option_context_new ("FOLDER");
  g_autoptr (GError) error = NULL;

  bench.params.align.done = 0.002;
  bench.params.uncertain = 0.3;
  g_option_context_add_main_entries (context, entries, NULL);
  if (!g_option_context_parse (context, &argc, &argv, &error))
    g_error ("%s", error->message);
  gst_init (&argc, &argv);
  /* both pictures are of one kind of camera, and time doesn't matter */
  bench.params.align.reference_blur = bench.params.align.blur;
  bench.params.align.radius = window;
  bench.params.align.rounds = (guint) rounds;
  if (argc > 1)
    run (&bench, argv[1]);
  else
    g_print ("no pictures: see --help\n");
  return 0;
}
