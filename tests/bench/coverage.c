/* The silhouette of a cloth in a camera's picture, on one core: how long it takes to draw, with what
 * each pixel sees, beside OpenCV's polygons, which tell the silhouette alone, and beside rays that
 * are held against every triangle.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/coverage.h"

#include <math.h>

#include "tests/bench/clock.h"
#include "tests/reference/reference.h"

#define COLUMNS 33
#define ROWS 35
#define N (COLUMNS * ROWS)
#define N_FACES ((COLUMNS - 1) * (ROWS - 1))
#define REPEATS 200

static gdouble positions[3 * N];
static guint32 faces[4 * N_FACES];

/* 0.63 × 0.67 m in folds, 1.5 m before the camera. */
static void
make_mesh (void)
{
  guint32 *f = faces;

  for (guint i = 0; i < N; i++) {
    const gdouble u = 0.63 * (i % COLUMNS) / (COLUMNS - 1);
    const gdouble v = 0.67 * (i / COLUMNS) / (ROWS - 1);

    positions[3 * i] = u - 0.31 + 0.03 * sin (40 * u + 9 * v);
    positions[3 * i + 1] = v - 0.33;
    positions[3 * i + 2] = 1.5 + 0.05 * cos (40 * u + 9 * v);
  }
  for (guint32 v = 0; v < N - COLUMNS; v++)
    if (v % COLUMNS + 1 < COLUMNS) {
      *f++ = v;
      *f++ = v + COLUMNS;
      *f++ = v + COLUMNS + 1;
      *f++ = v + 1;
    }
}

static gdouble
time_coverage (ClothCoverage * coverage, const ClothCamera * camera)
{
  gdouble best = G_MAXDOUBLE;

  for (guint i = 0; i < REPEATS; i++) {
    const gdouble start = cpu_ms ();

    cloth_coverage_draw (coverage, camera, positions, NULL);
    best = MIN (best, cpu_ms () - start);
  }
  return best;
}

/* Projects each vertex once, as ours does. */
static gdouble
time_opencv (const ClothCamera * camera, guint8 * mask)
{
  static gdouble px[2 * N], corners[8 * N_FACES];
  gdouble best = G_MAXDOUBLE;

  for (guint i = 0; i < REPEATS; i++) {
    const gdouble start = cpu_ms ();

    for (guint v = 0; v < N; v++)
      cloth_camera_project (camera, positions + 3 * v, px + 2 * v, NULL, NULL);
    for (guint k = 0; k < 4 * N_FACES; k++) {
      corners[2 * k] = px[2 * faces[k]];
      corners[2 * k + 1] = px[2 * faces[k] + 1];
    }
    if (!cloth_cv_fill (mask, camera->width, camera->height, corners, 4,
            N_FACES))
      g_error ("OpenCV threw");
    best = MIN (best, cpu_ms () - start);
  }
  return best;
}

/* Every ray against every triangle; of one row in 40, for all. */
static gdouble
time_rays (const ClothCoverage * c, const ClothCamera * camera)
{
  const gdouble start = cpu_ms ();
  guint n = 0;

  for (gint y = 0; y < camera->height; y += 40)
    for (gint x = 0; x < camera->width; x++) {
      const gdouble ray[2] = { (x - camera->K[2]) / camera->K[0],
        (y - camera->K[5]) / camera->K[4]
      };
      gdouble nearest = G_MAXDOUBLE;

      for (guint i = 0; i < c->n_triangles; i++) {
        const guint32 *t = c->triangles[i];
        const gdouble *a = positions + 3 * t[0], *b = positions + 3 * t[1];
        const gdouble *d = positions + 3 * t[2];
        gdouble e[3], f[3], p[3], q[3], det, u, v, depth;

        for (guint k = 0; k < 3; k++) {
          e[k] = b[k] - a[k];
          f[k] = d[k] - a[k];
        }
        p[0] = ray[1] * f[2] - f[1];
        p[1] = f[0] - ray[0] * f[2];
        p[2] = ray[0] * f[1] - ray[1] * f[0];
        det = e[0] * p[0] + e[1] * p[1] + e[2] * p[2];
        u = -(a[0] * p[0] + a[1] * p[1] + a[2] * p[2]) / det;
        if (!(u >= 0 && u <= 1))
          continue;
        q[0] = a[2] * e[1] - a[1] * e[2];
        q[1] = a[0] * e[2] - a[2] * e[0];
        q[2] = a[1] * e[0] - a[0] * e[1];
        v = (ray[0] * q[0] + ray[1] * q[1] + q[2]) / det;
        depth = (f[0] * q[0] + f[1] * q[1] + f[2] * q[2]) / det;
        if (v >= 0 && u + v <= 1 && depth > 0 && depth < nearest)
          nearest = depth;
      }
      n += nearest < G_MAXDOUBLE;
    }
  if (n == 0)
    g_error ("no ray meets the cloth");
  return 40 * (cpu_ms () - start);
}

int
main (void)
{
  static const gint sizes[][2] = { {640, 480}, {1920, 1080} };
  g_autoptr (ClothCoverage) coverage = NULL;

  make_mesh ();
  coverage = cloth_coverage_new (N, faces, N_FACES);
  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    const gdouble f = sizes[i][0];
    ClothCamera camera = { NULL, sizes[i][0], sizes[i][1],
      {f, 0, f / 2, 0, f, sizes[i][1] / 2., 0, 0, 1}, CLOTH_LENS_NONE, {0},
      {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}
    };
    g_autofree guint8 *mask = g_malloc ((gsize) camera.width * camera.height);
    const gdouble ours = time_coverage (coverage, &camera);
    guint n = 0;
    gdouble opencv, rays, bent;

    for (gint k = 0; k < camera.width * camera.height; k++)
      n += coverage->seen[k] != CLOTH_COVERAGE_NONE;
    opencv = time_opencv (&camera, mask);
    rays = time_rays (coverage, &camera);
    camera.lens = CLOTH_LENS_BROWN5;
    camera.k[0] = -0.2;
    bent = time_coverage (coverage, &camera);
    g_print ("%dx%d, %u vertices over %.0f%% of it: ours %.2f ms (bent lens "
        "%.2f), OpenCV's polygons %.2f ms (%.1f times), rays %.0f ms (%.0f "
        "times)\n", camera.width, camera.height, N, 100. * n / camera.width /
        camera.height, ours, bent, opencv, opencv / ours, rays, rays / ours);
  }
  return 0;
}
