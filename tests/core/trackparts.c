/* Parts of the trackers, each by itself: features combined, found again, dropped in crests, cast on a
 * cloth. All truth is by construction.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/vision/track/cast.h"
#include "gst/vision/track/combine.h"
#include "gst/vision/track/crest.h"
#include "gst/vision/track/seek.h"

#define BYTES CLOTH_CV_SIFT_BYTES

/* ---- combine ---- */

static void
look_like (guint8 * descriptor, guint8 what)
{
  memset (descriptor, 0, BYTES);
  descriptor[what % BYTES] = 200;
}

/* Three cameras see one place; a fourth feature near by looks different and goes with its like. */
static void
test_combine (void)
{
  guint8 looks[3][BYTES];
  const ClothCombineItem items[] = {
    {0, {0.1, 0.1}, looks[0]},
    {0, {0.102, 0.1}, looks[1]},
    {1, {0.101, 0.1}, looks[0]},
    {1, {0.103, 0.101}, looks[1]},
    {2, {0.1, 0.101}, looks[0]},
    {2, {0.3, 0.3}, looks[2]},
  };
  guint32 groups[6];

  for (guint8 k = 0; k < 3; k++)
    look_like (looks[k], (guint8) (10 * k));
  g_assert_cmpuint (cloth_combine_run (6, items, 0.005, groups), ==, 2);
  g_assert_cmpuint (groups[0], ==, 0);
  g_assert_cmpuint (groups[1], ==, 1);
  g_assert_cmpuint (groups[2], ==, 0);
  g_assert_cmpuint (groups[3], ==, 1);
  g_assert_cmpuint (groups[4], ==, 0);
  g_assert_cmpuint (groups[5], ==, CLOTH_COMBINE_NONE);
}

/* Out of the radius, of the same camera, or of no other: no group. A chain of near ones is no group
 * either when its ends are too far. */
static void
test_apart (void)
{
  guint8 look[BYTES];
  const ClothCombineItem far[] = { {0, {0.1, 0.1}, look}, {1, {0.1, 0.106},
      look}
  };
  const ClothCombineItem same[] = { {3, {0.1, 0.1}, look}, {3, {0.1, 0.101},
      look}
  };
  const ClothCombineItem chain[] = { {0, {0.1, 0.1}, look}, {1, {0.1, 0.104},
      look}, {2, {0.1, 0.108}, look}
  };
  guint32 groups[3];

  look_like (look, 1);
  g_assert_cmpuint (cloth_combine_run (0, NULL, 0.005, groups), ==, 0);
  g_assert_cmpuint (cloth_combine_run (2, far, 0.005, groups), ==, 0);
  g_assert_cmpuint (cloth_combine_run (2, same, 0.005, groups), ==, 0);
  g_assert_cmpuint (groups[0], ==, CLOTH_COMBINE_NONE);
  g_assert_cmpuint (cloth_combine_run (3, chain, 0.005, groups), ==, 1);
  g_assert_cmpuint (groups[0], ==, 0);
  g_assert_cmpuint (groups[1], ==, 0);
  g_assert_cmpuint (groups[2], ==, CLOTH_COMBINE_NONE);
}

/* ---- seek ---- */

static void
test_seek (void)
{
  /* rows are sorted; the second and third are one place */
  const gfloat x[] = { 10, 20, 20.5, 60 }, y[] = { 5, 8, 8, 9 };
  guint8 looks[4][BYTES], sought[BYTES], other[BYTES];
  const guint8 *references[2] = { other, sought };
  const ClothCvFeatures f = { 4, x, y, NULL, NULL, looks[0] };
  guint32 distance;

  for (guint8 k = 0; k < 4; k++)
    look_like (looks[k], (guint8) (10 * k));
  look_like (looks[3], 10);
  look_like (sought, 10);
  look_like (other, 100);
  looks[2][10] = 199;
  looks[2][20] = 0;
  g_assert_cmpuint (cloth_seek_distance (looks[1], looks[0]), ==, 80000);
  /* its double at the same place does not compete */
  g_assert_cmpuint (cloth_seek_run (&f, (const gdouble[2]) {
            18, 8
          }, 12., 0.8, 1, references + 1, &distance), ==, 1);
  g_assert_cmpuint (distance, ==, 0);
  /* any of several descriptors will do */
  g_assert_cmpuint (cloth_seek_run (&f, (const gdouble[2]) {
            18, 8
          }, 12., 0.8, 2, references, &distance), ==, 1);
  /* the double far away does when it is in reach */
  g_assert_cmpuint (cloth_seek_run (&f, (const gdouble[2]) {
            18, 8
          }, 50., 0.8, 1, references + 1, &distance), ==, CLOTH_SEEK_NONE);
  /* nothing is there */
  g_assert_cmpuint (cloth_seek_run (&f, (const gdouble[2]) {
            18, 80
          }, 12., 0.8, 1, references + 1, &distance), ==,
      CLOTH_SEEK_NONE);
  /* both are as unlike */
  g_assert_cmpuint (cloth_seek_run (&f, (const gdouble[2]) {
            15, 8
          }, 12., 0.8, 1, references, &distance), ==, CLOTH_SEEK_NONE);
}

/* ---- crests ---- */

#define SIDE 21
#define STEP 0.02
#define SCALE 500.

typedef struct
{
  gdouble uv[2 * SIDE * SIDE], px[2 * SIDE * SIDE];
  guint8 lost[SIDE * SIDE];
} Sheet;

/* A sheet whose columns are at places of the picture, tilted about the y axis. */
static void
lay_out (Sheet * sheet, gdouble (*where) (gdouble u))
{
  for (guint i = 0; i < SIDE * SIDE; i++) {
    sheet->uv[2 * i] = STEP * (i % SIDE);
    sheet->uv[2 * i + 1] = STEP * (i / SIDE);
    sheet->px[2 * i] = 100. + SCALE * where (sheet->uv[2 * i]);
    sheet->px[2 * i + 1] = 50. + SCALE * sheet->uv[2 * i + 1];
  }
}

static gdouble
plain (gdouble u)
{
  return u;
}

static gdouble
tilted (gdouble u)
{
  return 0.5 * u;
}

/* What lies between u = 0.15 and 0.25 is hidden behind a crest, where the flow leaves it: the sheet
 * goes on behind it, half of that below it. */
static gdouble
folded (gdouble u)
{
  return u < 0.15 ? u : u < 0.25 ? 0.15 + 0.02 * (u - 0.15) : u - 0.1;
}

/* Behind it the cloth moved on. */
static gdouble
stepped (gdouble u)
{
  return u < 0.19 ? u : u < 0.21 ? 0.08 : u;
}

static gdouble
turned (gdouble u)
{
  return -u;
}

static guint
judge (Sheet * sheet, gdouble (*where) (gdouble u))
{
  const ClothCrestParams params = cloth_crest_default_params ();
  g_autoptr (ClothCrest) crest = cloth_crest_new ();

  lay_out (sheet, where);
  return cloth_crest_run (crest, &params, SIDE * SIDE, sheet->uv, sheet->px,
      sheet->lost);
}

static void
test_whole (void)
{
  g_autofree Sheet *sheet = g_new (Sheet, 1);

  g_assert_cmpuint (judge (sheet, plain), ==, 0);
  g_assert_cmpuint (judge (sheet, tilted), ==, 0);
}

static void
test_crest (void)
{
  g_autofree Sheet *sheet = g_new (Sheet, 1);
  guint n_wrong = 0;

  g_assert_cmpuint (judge (sheet, folded), >, 0);
  for (guint i = 0; i < SIDE * SIDE; i++) {
    const gdouble u = sheet->uv[2 * i];

    if (u > 0.15 && u < 0.25)
      g_assert_true (sheet->lost[i]);
    /* those next to the crest may go along */
    else if (u < 0.13 || u > 0.27)
      n_wrong += sheet->lost[i];
  }
  g_assert_cmpuint (n_wrong, ==, 0);
}

static void
test_step (void)
{
  g_autofree Sheet *sheet = g_new (Sheet, 1);

  g_assert_cmpuint (judge (sheet, stepped), >=, SIDE);
  for (guint i = 0; i < SIDE * SIDE; i++) {
    const gdouble u = sheet->uv[2 * i];

    if (u > 0.19 && u < 0.21)
      g_assert_true (sheet->lost[i]);
    else if (u < 0.05 || u > 0.25)
      g_assert_false (sheet->lost[i]);
  }
}

/* The back of a sheet shows its print in a mirror: none of its points is where it was. */
static void
test_turned (void)
{
  g_autofree Sheet *sheet = g_new (Sheet, 1);

  g_assert_cmpuint (judge (sheet, turned), ==, SIDE * SIDE);
}

/* Fewer points than a triangle has tell nothing; those on one line neither. */
static void
test_few (void)
{
  const ClothCrestParams params = cloth_crest_default_params ();
  const gdouble uv[] = { 0, 0, 0.1, 0, 0.2, 0 }, px[] = { 0, 0, 1, 0, 200, 0
  };
  g_autoptr (ClothCrest) crest = cloth_crest_new ();
  guint8 lost[3] = { 7, 7, 7 };

  g_assert_cmpuint (cloth_crest_run (crest, &params, 0, uv, px, lost), ==, 0);
  g_assert_cmpuint (cloth_crest_run (crest, &params, 2, uv, px, lost), ==, 0);
  g_assert_cmpuint (lost[0] + lost[1], ==, 0);
  g_assert_cmpuint (lost[2], ==, 7);
}

/* ---- cast ---- */

/* A square of 1 m, 2 m before a camera that looks along z, in two triangles. */
static void
test_cast (void)
{
  const ClothCamera camera = {.width = 200,.height = 200,
    .K = {200, 0, 100, 0, 200, 100, 0, 0, 1},
    .R = {1, 0, 0, 0, 1, 0, 0, 0, 1}
  };
  const gdouble positions[] = { -0.5, -0.5, 2, 0.5, -0.5, 2, 0.5, 0.5, 2,
    -0.5, 0.5, 2
  };
  const guint32 face[] = { 0, 1, 2, 3 };
  const gdouble before[2] = { 100 + 13.3, 100 - 21.7 }, px[2] = { 120, 90 };
  const gdouble beside[2] = { 30, 30 }, outside[2] = { -3, 100 };
  const gdouble rim[2] = { 150.4, 100 };
  g_autoptr (ClothCoverage) coverage = cloth_coverage_new (4, face, 1);
  g_autoptr (ClothPool) pool = cloth_pool_new (1);
  gdouble X[3] = { 0 };
  ClothCast cast;

  cloth_coverage_draw (coverage, &camera, positions, pool);
  g_assert_true (cloth_cast_feature (coverage, &camera, positions, before, px,
          &cast));
  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 3; k++)
      X[k] += cast.weight[i] * positions[3 * cast.corner[i] + k];
  g_assert_cmpfloat_with_epsilon (X[0], 0.133, 1e-9);
  g_assert_cmpfloat_with_epsilon (X[1], -0.217, 1e-9);
  g_assert_cmpfloat_with_epsilon (X[2], 2., 1e-9);
  g_assert_cmpfloat_with_epsilon (cast.ray.direction[0] /
      cast.ray.direction[2], 0.1, 1e-9);
  g_assert_cmpfloat_with_epsilon (cast.ray.direction[1] /
      cast.ray.direction[2], -0.05, 1e-9);
  /* a hit beyond the edge, but in its pixel, is brought to the edge */
  if (cloth_cast_feature (coverage, &camera, positions, rim, px, &cast))
    for (guint i = 0; i < 3; i++)
      g_assert_cmpfloat (cast.weight[i], >=, 0.);
  g_assert_false (cloth_cast_feature (coverage, &camera, positions, beside, px,
          &cast));
  g_assert_false (cloth_cast_feature (coverage, &camera, positions, outside,
          px, &cast));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/trackparts/combine", test_combine);
  g_test_add_func ("/trackparts/apart", test_apart);
  g_test_add_func ("/trackparts/seek", test_seek);
  g_test_add_func ("/trackparts/whole", test_whole);
  g_test_add_func ("/trackparts/crest", test_crest);
  g_test_add_func ("/trackparts/step", test_step);
  g_test_add_func ("/trackparts/turned", test_turned);
  g_test_add_func ("/trackparts/few", test_few);
  g_test_add_func ("/trackparts/cast", test_cast);
  return g_test_run ();
}
