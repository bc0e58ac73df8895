/* What of a mesh each pixel sees: against closed forms, and against rays that are held against every
 * triangle.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/coverage.h"

#include <math.h>
#include <string.h>

#define WIDTH 201
#define HEIGHT 151

static ClothCamera
make_camera (ClothLens lens)
{
  ClothCamera camera = { NULL, WIDTH, HEIGHT,
    {150, 0, 100, 0, 150, 75, 0, 0, 1}, lens, {0},
    {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}
  };

  if (lens == CLOTH_LENS_BROWN5) {
    camera.k[0] = -0.3;
    camera.k[1] = 0.1;
    camera.k[2] = 0.002;
    camera.k[3] = -0.001;
  } else if (lens == CLOTH_LENS_FISHEYE) {
    camera.k[0] = 0.05;
    camera.k[1] = -0.02;
  }
  return camera;
}

static guint
count (const ClothCoverage * c)
{
  guint n = 0;

  for (gint i = 0; i < c->width * c->height; i++)
    n += c->seen[i] != CLOTH_COVERAGE_NONE;
  return n;
}

/* Squares whose borders lie on centres of pixels: the upper and left ones count, so that tiles have
 * each pixel once. */
static void
test_square (void)
{
  /* at 1.5 m a pixel is a centimetre */
  const ClothCamera camera = make_camera (CLOTH_LENS_NONE);
  const gdouble positions[] = {
    -0.2, -0.1, 1.5, 0, -0.1, 1.5, 0.3, -0.1, 1.5,
    -0.2, 0.15, 1.5, 0, 0.15, 1.5, 0.3, 0.15, 1.5
  };
  const guint32 faces[] = { 0, 1, 4, 3, 1, 2, 5, 4 };
  g_autoptr (ClothCoverage) both = cloth_coverage_new (6, faces, 2);
  g_autoptr (ClothCoverage) left = cloth_coverage_new (6, faces, 1);
  g_autoptr (ClothCoverage) right = cloth_coverage_new (6, faces + 4, 1);

  cloth_coverage_draw (both, &camera, positions, NULL);
  cloth_coverage_draw (left, &camera, positions, NULL);
  cloth_coverage_draw (right, &camera, positions, NULL);
  g_assert_cmpuint (both->n_triangles, ==, 4);
  g_assert_cmpuint (count (left), ==, 20 * 25);
  g_assert_cmpuint (count (right), ==, 30 * 25);
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      const gint at = y * WIDTH + x;
      const gboolean in = y >= 65 && y < 90;
      const gboolean in_left = in && x >= 80 && x < 100;
      const gboolean in_right = in && x >= 100 && x < 130;
      const guint32 *t;
      gdouble place[2] = { 0 };

      g_assert_cmpint (left->seen[at] != CLOTH_COVERAGE_NONE, ==, in_left);
      g_assert_cmpint (right->seen[at] != CLOTH_COVERAGE_NONE, ==, in_right);
      g_assert_cmpint (both->seen[at] != CLOTH_COVERAGE_NONE, ==, in_left
          || in_right);
      if (!in_left && !in_right)
        continue;
      g_assert_cmpint (both->seen[at] / 2, ==, in_right);
      /* the place is where the pixel is */
      t = both->triangles[both->seen[at]];
      for (guint k = 0; k < 2; k++)
        place[k] = positions[3 * t[0] + k] + both->places[2 * at] *
            (positions[3 * t[1] + k] - positions[3 * t[0] + k]) +
            both->places[2 * at + 1] * (positions[3 * t[2] + k] -
            positions[3 * t[0] + k]);
      g_assert_cmpfloat_with_epsilon (place[0], (x - 100) / 100., 1e-7);
      g_assert_cmpfloat_with_epsilon (place[1], (y - 75) / 100., 1e-7);
    }
}

/* A sphere is seen as the disc of its tangents. */
static void
test_sphere (void)
{
  enum
  { AROUND = 400, DOWN = 200, N = AROUND * (DOWN + 1) };
  ClothCamera camera = make_camera (CLOTH_LENS_NONE);
  g_autofree gdouble *positions = g_new (gdouble, 3 * N);
  g_autofree guint32 *faces = g_new (guint32, 4 * AROUND * DOWN);
  g_autoptr (ClothCoverage) coverage = NULL;
  const gdouble radius = 0.4, distance = 1.2;
  /* tangent of the half angle, asin (r/d) */
  const gdouble reach = 800 * radius / sqrt (distance * distance - radius *
      radius);

  camera.width = camera.height = 801;
  camera.K[0] = camera.K[4] = 800;
  camera.K[2] = camera.K[5] = 400;
  for (gint j = 0; j <= DOWN; j++)
    for (gint i = 0; i < AROUND; i++) {
      const gdouble a = 2 * G_PI * i / AROUND, b = G_PI * j / DOWN;
      gdouble *p = positions + 3 * (j * AROUND + i);

      p[0] = radius * sin (b) * cos (a);
      p[1] = radius * cos (b);
      p[2] = distance + radius * sin (b) * sin (a);
    }
  for (guint32 f = 0; f < AROUND * DOWN; f++) {
    const guint32 j = f / AROUND, i = f % AROUND, next = (i + 1) % AROUND;
    const guint32 face[4] = { j * AROUND + i, j * AROUND + next,
      (j + 1) * AROUND + next, (j + 1) * AROUND + i
    };

    memcpy (faces + 4 * f, face, sizeof face);
  }
  coverage = cloth_coverage_new (N, faces, AROUND * DOWN);
  cloth_coverage_draw (coverage, &camera, positions, NULL);
  /* chords of a 400th of the circle are inside by 4e-5 of the area, the rim of pixels is as a coin */
  g_assert_cmpfloat_with_epsilon (count (coverage) / (G_PI * reach * reach), 1.,
      4e-4);
  /* and the near side is seen */
  for (gint i = 0; i < camera.width * camera.height; i++)
    if (coverage->seen[i] != CLOTH_COVERAGE_NONE) {
      const guint32 *t = coverage->triangles[coverage->seen[i]];

      g_assert_cmpfloat (positions[3 * t[0] + 2], <, distance);
    }
}

#define SIDE 15
#define N (SIDE * SIDE)

typedef struct
{
  gdouble positions[3 * N];
  guint32 faces[4 * (SIDE - 1) * (SIDE - 1)];
} Sheet;

/* A sheet in folds that hide much of it. Rows lie behind each other, so that no fold meets another. */
static void
crumple (Sheet * sheet, guint seed)
{
  g_autoptr (GRand) random = g_rand_new_with_seed (seed);

  for (guint i = 0; i < N; i++) {
    const gdouble u = (i % SIDE) * 1.2 / SIDE - 0.6;
    const gdouble v = (i / SIDE) * 1.2 / SIDE - 0.6;

    sheet->positions[3 * i] = u + g_rand_double_range (random, -0.02, 0.02);
    sheet->positions[3 * i + 1] = 0.7 * v + 0.2 * sin (9 * v + 3 * u);
    sheet->positions[3 * i + 2] = 1 + 0.4 * v;
  }
  for (guint f = 0; f < (SIDE - 1) * (SIDE - 1); f++) {
    const guint32 v = f / (SIDE - 1) * SIDE + f % (SIDE - 1);
    const guint32 face[4] = { v, v + SIDE, v + SIDE + 1, v + 1 };

    memcpy (sheet->faces + 4 * f, face, sizeof face);
  }
}

/* Möller and Trumbore. Returns the depth along the ray, and the weights. */
static gboolean
meet (const gdouble ray[3], const gdouble * a, const gdouble * b,
    const gdouble * c, gdouble * depth, gdouble uv[2])
{
  gdouble e[3], f[3], p[3], q[3], t[3], det;

  for (guint k = 0; k < 3; k++) {
    e[k] = b[k] - a[k];
    f[k] = c[k] - a[k];
    t[k] = -a[k];
  }
#define CROSS(to, x, y) to[0] = x[1] * y[2] - x[2] * y[1]; \
  to[1] = x[2] * y[0] - x[0] * y[2]; to[2] = x[0] * y[1] - x[1] * y[0]
#define DOT(x, y) (x[0] * y[0] + x[1] * y[1] + x[2] * y[2])
  CROSS (p, ray, f);
  det = DOT (e, p);
  uv[0] = DOT (t, p) / det;
  CROSS (q, t, e);
  uv[1] = DOT (ray, q) / det;
  *depth = DOT (f, q) / det;
  return uv[0] >= 0 && uv[1] >= 0 && uv[0] + uv[1] <= 1 && *depth > 0;
}

/* What a ray through (x, y) meets first of all triangles. */
static guint32
cast (const ClothCamera * camera, const ClothCoverage * c,
    const gdouble * positions, gdouble x, gdouble y, gdouble place[2])
{
  gdouble ray[3] = { 0, 0, 1 }, nearest = G_MAXDOUBLE;
  guint32 seen = CLOTH_COVERAGE_NONE;

  cloth_camera_undistort_points (camera, 1, &x, &y, &ray[0], &ray[1], NULL);
  for (guint i = 0; i < c->n_triangles; i++) {
    const guint32 *t = c->triangles[i];
    gdouble depth, uv[2];

    if (meet (ray, positions + 3 * t[0], positions + 3 * t[1],
            positions + 3 * t[2], &depth, uv) && depth < nearest) {
      nearest = depth;
      seen = i;
      memcpy (place, uv, sizeof uv);
    }
  }
  return seen;
}

/* Every pixel, through every lens. Where a neighbour closer than the lens's bend sees the same
 * triangle, it is that. */
static void
test_rays (void)
{
  static const ClothLens lenses[] = { CLOTH_LENS_NONE, CLOTH_LENS_BROWN5,
    CLOTH_LENS_FISHEYE
  };
  g_autofree Sheet *sheet = g_new (Sheet, 1);

  crumple (sheet, 3);
  for (guint l = 0; l < G_N_ELEMENTS (lenses); l++) {
    const ClothCamera camera = make_camera (lenses[l]);
    g_autoptr (ClothCoverage) c = cloth_coverage_new (N, sheet->faces,
        (SIDE - 1) * (SIDE - 1));
    guint others = 0, covered = 0;

    cloth_coverage_draw (c, &camera, sheet->positions, NULL);
    g_assert_cmpfloat (c->bend_px, <=, CLOTH_COVERAGE_BEND_PX);
    g_assert_true ((c->bend_px > 0) == (lenses[l] != CLOTH_LENS_NONE));
    for (gint y = 0; y < HEIGHT; y++)
      for (gint x = 0; x < WIDTH; x++) {
        const gint at = y * WIDTH + x;
        const gdouble reach = c->bend_px + 1e-6;
        gdouble place[2];
        guint32 seen = cast (&camera, c, sheet->positions, x, y, place);
        gboolean near = FALSE;

        covered += seen != CLOTH_COVERAGE_NONE;
        if (c->seen[at] == seen) {
          /* a bend moves what lies between, too: by at most a fortieth of these triangles */
          if (seen != CLOTH_COVERAGE_NONE)
            for (guint k = 0; k < 2; k++)
              g_assert_cmpfloat_with_epsilon (c->places[2 * at + k], place[k],
                  lenses[l] == CLOTH_LENS_NONE ? 2e-5 : 0.025);
          continue;
        }
        others++;
        for (guint k = 0; k < 8 && !near; k++)
          near = cast (&camera, c, sheet->positions, x + reach *
              cos (k * G_PI / 4), y + reach * sin (k * G_PI / 4), place) ==
              c->seen[at];
        g_assert_true (near);
      }
    g_test_message ("lens %s: %u pixels covered, %u on borders, bend %.3f px",
        l == 0 ? "none" : l == 1 ? "brown5" : "fisheye", covered, others,
        c->bend_px);
    g_assert_cmpuint (covered, >, WIDTH * HEIGHT / 2);
    g_assert_cmpuint (others, <, l == 0 ? 2 : covered / 20);
  }
}

/* The same bytes for any number of threads, and for a picture after others. */
static void
test_threads (void)
{
  ClothCamera camera = make_camera (CLOTH_LENS_BROWN5);
  ClothCamera small = camera;
  g_autofree Sheet *sheet = g_new (Sheet, 1);
  g_autofree Sheet *other = g_new (Sheet, 1);
  g_autoptr (ClothCoverage) one = NULL;

  crumple (sheet, 5);
  crumple (other, 6);
  small.width = 77;
  small.height = 101;
  one = cloth_coverage_new (N, sheet->faces, (SIDE - 1) * (SIDE - 1));
  cloth_coverage_draw (one, &camera, sheet->positions, NULL);
  for (guint threads = 1; threads < 9; threads++) {
    g_autoptr (ClothPool) pool = cloth_pool_new (threads);
    g_autoptr (ClothCoverage) many = cloth_coverage_new (N, sheet->faces,
        (SIDE - 1) * (SIDE - 1));

    cloth_coverage_draw (many, &small, other->positions, pool);
    g_assert_cmpint (many->width, ==, 77);
    cloth_coverage_draw (many, &camera, sheet->positions, pool);
    g_assert_cmpmem (one->seen, WIDTH * HEIGHT * sizeof *one->seen, many->seen,
        WIDTH * HEIGHT * sizeof *many->seen);
    for (gint i = 0; i < WIDTH * HEIGHT; i++)
      if (one->seen[i] != CLOTH_COVERAGE_NONE)
        g_assert_cmpmem (one->places + 2 * i, 2 * sizeof (gfloat),
            many->places + 2 * i, 2 * sizeof (gfloat));
  }
}

/* What can't be drawn is not, and all else is. */
static void
test_undrawn (void)
{
  const ClothCamera camera = make_camera (CLOTH_LENS_NONE);
  g_autofree Sheet *sheet = g_new (Sheet, 1);
  g_autoptr (ClothCoverage) c = NULL;
  g_autoptr (ClothCoverage) none = cloth_coverage_new (0, NULL, 0);
  const gdouble corners[9] = { 0 };
  const gdouble line[9] = { -0.5, 0, 1, 0, 0, 1, 0.5, 0, 1 };
  const guint32 triangle[4] = { 0, 1, 2, G_MAXUINT32 };
  g_autoptr (ClothCoverage) thin = cloth_coverage_new (3, triangle, 1);
  guint before;

  cloth_coverage_draw (none, &camera, NULL, NULL);
  g_assert_cmpuint (count (none), ==, 0);
  cloth_coverage_draw (thin, &camera, line, NULL);
  g_assert_cmpuint (count (thin), ==, 0);
  cloth_coverage_draw (thin, &camera, corners, NULL);
  g_assert_cmpuint (count (thin), ==, 0);

  crumple (sheet, 9);
  c = cloth_coverage_new (N, sheet->faces, (SIDE - 1) * (SIDE - 1));
  cloth_coverage_draw (c, &camera, sheet->positions, NULL);
  before = count (c);
  /* an unknown vertex takes its triangles away, one behind the camera too */
  for (guint fault = 0; fault < 2; fault++) {
    const guint v = fault * 40 + 100;
    const gdouble was = sheet->positions[3 * v + 2];

    sheet->positions[3 * v + 2] = fault ? -1 : NAN;
    cloth_coverage_draw (c, &camera, sheet->positions, NULL);
    g_assert_cmpuint (count (c), <=, before);
    g_assert_cmpuint (count (c), >, before / 2);
    for (gint i = 0; i < WIDTH * HEIGHT; i++)
      if (c->seen[i] != CLOTH_COVERAGE_NONE)
        for (guint k = 0; k < 3; k++)
          g_assert_cmpuint (c->triangles[c->seen[i]][k], !=, v);
    sheet->positions[3 * v + 2] = was;
  }
  /* all of it beside the picture, or behind */
  for (guint i = 0; i < N; i++)
    sheet->positions[3 * i] += 1000;
  cloth_coverage_draw (c, &camera, sheet->positions, NULL);
  g_assert_cmpuint (count (c), ==, 0);
  for (guint i = 0; i < N; i++) {
    sheet->positions[3 * i] -= 1000;
    sheet->positions[3 * i + 2] *= -1;
  }
  cloth_coverage_draw (c, &camera, sheet->positions, NULL);
  g_assert_cmpuint (count (c), ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/coverage/square", test_square);
  g_test_add_func ("/coverage/sphere", test_sphere);
  g_test_add_func ("/coverage/rays", test_rays);
  g_test_add_func ("/coverage/threads", test_threads);
  g_test_add_func ("/coverage/undrawn", test_undrawn);
  return g_test_run ();
}
