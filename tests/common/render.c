/* Draws a printed cloth, bent over a smooth surface, as a pinhole camera sees it.
 *
 * The cloth is cut into cells of a few pixels; a depth buffer over the pixels' centres
 * finds which part of the cloth each one sees, and a Newton step on the surface itself
 * makes that point of the cloth exact. Within the pixel the map to the cloth is taken as
 * affine, and its square is sampled by a Fibonacci lattice of 233 points, whose
 * projections on both axes are evenly spaced: an edge is placed to about 0.002 px.
 * Where one fold hides another the edge between them is not smoothed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/render.h"

#include "gst/math/random.h"

#include <math.h>
#include <string.h>

#define CELL_PX 3.0
#define MAX_CELLS 3000
#define LATTICE 233
#define LATTICE_STEP 144
/* Cells beyond the cloth's edge, so that its outline is smoothed too. */
#define BEYOND 1

typedef struct
{
  gdouble x, y, z;
} Seen;

typedef struct
{
  const TestScene *scene;
  gint width, height;
  /* Per pixel: depth, 0 where there is no cloth, and the point of the cloth. */
  gfloat *depth;
  gdouble *u, *v;
  gfloat *light;
} Canvas;

void
test_surface_wave (gdouble u, gdouble v, gdouble point[3], gpointer data)
{
  const TestWave *wave = data;
  const gdouble a = u - wave->pattern->cloth_m[0] / 2;
  const gdouble b = wave->pattern->cloth_m[1] / 2 - v;
  const gdouble cy = cos (wave->yaw), sy = sin (wave->yaw);
  const gdouble cp = cos (wave->pitch), sp = sin (wave->pitch);
  const gdouble cr = cos (wave->roll), sr = sin (wave->roll);
  gdouble x = cr * a + sr * b, z = cr * b - sr * a, y = 0, t;

  if (wave->amplitude_m != 0)
    y = wave->amplitude_m * sin (2 * G_PI * (a * cos (wave->direction) +
            b * sin (wave->direction)) / wave->wavelength_m + wave->phase);
  t = cp * y - sp * z;
  z = sp * y + cp * z;
  point[0] = wave->centre[0] + cy * x - sy * t;
  point[1] = wave->centre[1] + sy * x + cy * t;
  point[2] = wave->centre[2] + z;
}

ClothCamera
test_camera (gint width, gint height, gdouble focal_px, gdouble distance_m)
{
  ClothCamera camera = { NULL, width, height,
    {focal_px, 0, (width - 1) / 2.0, 0, focal_px, (height - 1) / 2.0, 0, 0, 1},
    CLOTH_LENS_NONE, {0}, {1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0, distance_m}
  };

  return camera;
}

static Seen
look (const TestScene * scene, gdouble u, gdouble v)
{
  const ClothCamera *camera = scene->camera;
  const gdouble *R = camera->R, *K = camera->K;
  gdouble p[3], c[3];
  Seen seen;

  scene->surface (u, v, p, scene->surface_data);
  for (gint i = 0; i < 3; i++)
    c[i] = R[3 * i] * p[0] + R[3 * i + 1] * p[1] + R[3 * i + 2] * p[2]
        + camera->t[i];
  seen.z = c[2];
  seen.x = (K[0] * c[0] + K[1] * c[1]) / c[2] + K[2];
  seen.y = K[4] * c[1] / c[2] + K[5];
  return seen;
}

/* J = d(x, y)/d(u, v), central differences over a hundredth of a square. */
static void
look_slope (const TestScene * scene, gdouble u, gdouble v, gdouble J[4])
{
  const gdouble h = scene->pattern->square_m / 100;
  const Seen right = look (scene, u + h, v), left = look (scene, u - h, v);
  const Seen below = look (scene, u, v + h), above = look (scene, u, v - h);

  J[0] = (right.x - left.x) / (2 * h);
  J[1] = (below.x - above.x) / (2 * h);
  J[2] = (right.y - left.y) / (2 * h);
  J[3] = (below.y - above.y) / (2 * h);
}

typedef struct
{
  Seen seen;
  gdouble u, v;
} Corner;

static void
fill_triangle (Canvas * canvas, const Corner * a, const Corner * b,
    const Corner * c)
{
  const gdouble ux = b->seen.x - a->seen.x, uy = b->seen.y - a->seen.y;
  const gdouble vx = c->seen.x - a->seen.x, vy = c->seen.y - a->seen.y;
  const gdouble area = ux * vy - uy * vx;
  const gdouble left = MIN (a->seen.x, MIN (b->seen.x, c->seen.x));
  const gdouble right = MAX (a->seen.x, MAX (b->seen.x, c->seen.x));
  const gdouble top = MIN (a->seen.y, MIN (b->seen.y, c->seen.y));
  const gdouble bottom = MAX (a->seen.y, MAX (b->seen.y, c->seen.y));

  if (a->seen.z <= 0 || b->seen.z <= 0 || c->seen.z <= 0 || area == 0
      || right < 0 || bottom < 0 || left > canvas->width
      || top > canvas->height)
    return;
  for (gint y = (gint) MAX (0, ceil (top)); y < canvas->height && y <= bottom;
      y++) {
    for (gint x = (gint) MAX (0, ceil (left)); x < canvas->width && x <= right;
        x++) {
      const gdouble px = x - a->seen.x, py = y - a->seen.y;
      const gdouble s = (px * vy - py * vx) / area;
      const gdouble t = (ux * py - uy * px) / area;
      const gsize at = (gsize) y * (gsize) canvas->width + (gsize) x;
      gdouble z;

      /* A hair more than the triangle, so that none falls between two. */
      if (s < -1e-6 || t < -1e-6 || s + t > 1 + 1e-6)
        continue;
      z = a->seen.z + s * (b->seen.z - a->seen.z) + t * (c->seen.z - a->seen.z);
      if (canvas->depth[at] > 0 && z >= canvas->depth[at])
        continue;
      canvas->depth[at] = (gfloat) z;
      canvas->u[at] = a->u + s * (b->u - a->u) + t * (c->u - a->u);
      canvas->v[at] = a->v + s * (b->v - a->v) + t * (c->v - a->v);
    }
  }
}

/* Cells across the cloth for cells of CELL_PX, from the slopes over a coarse grid. */
static void
choose_cells (const TestScene * scene, gint cells[2])
{
  const gdouble *size = scene->pattern->cloth_m;
  gdouble longest[2] = { 0, 0 };

  for (gint n = 0; n < 17 * 17; n++) {
    gdouble J[4];

    look_slope (scene, size[0] * (n % 17) / 16, size[1] * (n / 17) / 16, J);
    longest[0] = MAX (longest[0], hypot (J[0], J[2]));
    longest[1] = MAX (longest[1], hypot (J[1], J[3]));
  }
  for (gint i = 0; i < 2; i++)
    cells[i] = (gint) CLAMP (size[i] * longest[i] / CELL_PX, 8, MAX_CELLS);
}

static void
fill_depth (Canvas * canvas)
{
  const gdouble *size = canvas->scene->pattern->cloth_m;
  gint cells[2], across;
  g_autofree Corner *corners = NULL;

  choose_cells (canvas->scene, cells);
  across = cells[0] + 2 * BEYOND + 1;
  corners = g_new (Corner, 2 * across);
  for (gint j = -BEYOND; j <= cells[1] + BEYOND; j++) {
    Corner *above = corners + ((j + BEYOND + 1) & 1) * across;
    Corner *now = corners + ((j + BEYOND) & 1) * across;

    for (gint i = 0; i < across; i++) {
      now[i].u = size[0] * (i - BEYOND) / cells[0];
      now[i].v = size[1] * j / cells[1];
      now[i].seen = look (canvas->scene, now[i].u, now[i].v);
    }
    for (gint i = 0; i + 1 < across && j > -BEYOND; i++) {
      fill_triangle (canvas, &above[i], &above[i + 1], &now[i]);
      fill_triangle (canvas, &now[i + 1], &now[i], &above[i + 1]);
    }
  }
}

/* Grey of the cloth's point (u, v). Own code: a test of the texture compares them. */
static gdouble
paint (const TestScene * scene, gdouble u, gdouble v)
{
  const ClothPattern *p = scene->pattern;
  const gdouble x = (u - p->origin_uv_m[0]) / p->square_m;
  const gdouble y = (v - p->origin_uv_m[1]) / p->square_m;
  const gint column = (gint) floor (x), row = (gint) floor (y);
  gboolean black;

  if (u < 0 || v < 0 || u > p->cloth_m[0] || v > p->cloth_m[1])
    return scene->background;
  if (column < 0 || row < 0 || column >= p->columns || row >= p->rows)
    return scene->white;
  black = (column + row) % 2 == 0 ? p->first_black : !p->first_black;
  if (p->code && p->code[row * p->columns + column]
      && hypot (x - column - 0.5, y - row - 0.5) < p->dot_ratio / 2)
    black = !black;
  return black ? scene->black : scene->white;
}

/* Does the pixel see one colour only, its reach in squares being (ex, ey)? */
static gboolean
is_plain (const ClothPattern * p, gdouble u, gdouble v, gdouble eu, gdouble ev)
{
  const gdouble x = (u - p->origin_uv_m[0]) / p->square_m;
  const gdouble y = (v - p->origin_uv_m[1]) / p->square_m;
  const gdouble ex = eu / p->square_m, ey = ev / p->square_m;
  gdouble off;

  if (u - eu < 0 || v - ev < 0 || u + eu > p->cloth_m[0]
      || v + ev > p->cloth_m[1])
    return FALSE;
  if (x + ex < 0 || y + ey < 0 || x - ex > p->columns || y - ey > p->rows)
    return TRUE;
  if (floor (x - ex) != floor (x + ex) || floor (y - ey) != floor (y + ey))
    return FALSE;
  off = hypot (x - floor (x) - 0.5, y - floor (y) - 0.5);
  return !p->code || fabs (off - p->dot_ratio / 2) > hypot (ex, ey);
}

static gdouble
shade_pixel (const Canvas * canvas, gint px, gint py, gsize at)
{
  const TestScene *scene = canvas->scene;
  const gdouble h = scene->pattern->square_m / 1000;
  gdouble u = canvas->u[at], v = canvas->v[at], J[4], det, I[4], sum = 0;
  const Seen seen = look (scene, u, v);
  const Seen right = look (scene, u + h, v), below = look (scene, u, v + h);

  J[0] = (right.x - seen.x) / h;
  J[1] = (below.x - seen.x) / h;
  J[2] = (right.y - seen.y) / h;
  J[3] = (below.y - seen.y) / h;
  det = J[0] * J[3] - J[1] * J[2];
  if (det == 0)
    return paint (scene, u, v);
  I[0] = J[3] / det;
  I[1] = -J[1] / det;
  I[2] = -J[2] / det;
  I[3] = J[0] / det;
  /* The cell was flat, the surface is not. Seen edge-on the step may go astray. */
  if (hypot (px - seen.x, py - seen.y) < CELL_PX) {
    u += I[0] * (px - seen.x) + I[1] * (py - seen.y);
    v += I[2] * (px - seen.x) + I[3] * (py - seen.y);
  }
  if (is_plain (scene->pattern, u, v, (fabs (I[0]) + fabs (I[1])) / 2,
          (fabs (I[2]) + fabs (I[3])) / 2))
    return paint (scene, u, v);
  for (gint n = 0; n < LATTICE; n++) {
    gdouble dx = (n + 0.5) / LATTICE - 0.5;
    gdouble dy = (n * LATTICE_STEP % LATTICE + 0.5) / LATTICE - 0.5;

    sum += paint (scene, u + I[0] * dx + I[1] * dy, v + I[2] * dx + I[3] * dy);
  }
  return sum / LATTICE;
}

/* How much of the pixel lies beyond an edge at a signed distance. */
static gdouble
edge_share (gdouble distance)
{
  return CLAMP (distance + 0.5, 0, 1);
}

static void
shade (Canvas * canvas)
{
  const TestScene *scene = canvas->scene;

  for (gint y = 0; y < canvas->height; y++) {
    for (gint x = 0; x < canvas->width; x++) {
      const gsize at = (gsize) y * (gsize) canvas->width + (gsize) x;
      gdouble light = scene->background;

      if (canvas->depth[at] > 0)
        light = shade_pixel (canvas, x, y, at);
      if (scene->shadow.factor > 0)
        light *= 1 + (scene->shadow.factor - 1)
            * edge_share (scene->shadow.nx * x + scene->shadow.ny * y
            - scene->shadow.d);
      for (guint i = 0; i < scene->n_discs; i++) {
        const TestDisc *disc = &scene->discs[i];
        gdouble share =
            edge_share (disc->radius - hypot (x - disc->x, y - disc->y));

        light += share * (disc->grey - light);
      }
      canvas->light[at] = (gfloat) light;
    }
  }
}

static void
blur (Canvas * canvas)
{
  const gint reach = (gint) ceil (4 * canvas->scene->blur);
  const gsize n = (gsize) canvas->width * (gsize) canvas->height;
  g_autofree gfloat *kernel = NULL, *copy = NULL;
  gdouble sum = 0;

  if (reach == 0)
    return;
  kernel = g_new (gfloat, 2 * reach + 1);
  copy = g_new (gfloat, n);
  for (gint i = -reach; i <= reach; i++)
    sum += exp (-0.5 * pow (i / canvas->scene->blur, 2));
  for (gint i = -reach; i <= reach; i++)
    kernel[i + reach] =
        (gfloat) (exp (-0.5 * pow (i / canvas->scene->blur, 2)) / sum);
  for (gint pass = 0; pass < 2; pass++) {
    const gint step_x = pass == 0, step_y = pass == 1;

    memcpy (copy, canvas->light, n * sizeof (gfloat));
    for (gint y = 0; y < canvas->height; y++) {
      for (gint x = 0; x < canvas->width; x++) {
        gfloat value = 0;

        for (gint i = -reach; i <= reach; i++) {
          gint sx = CLAMP (x + i * step_x, 0, canvas->width - 1);
          gint sy = CLAMP (y + i * step_y, 0, canvas->height - 1);

          value += kernel[i + reach] *
              copy[(gsize) sy * (gsize) canvas->width + (gsize) sx];
        }
        canvas->light[(gsize) y * (gsize) canvas->width + (gsize) x] = value;
      }
    }
  }
}

static gboolean
can_see (const Canvas * canvas, gdouble u, gdouble v, Seen * seen)
{
  const TestScene *scene = canvas->scene;
  gdouble J[4];
  gsize at;

  *seen = look (scene, u, v);
  if (seen->z <= 0 || !(seen->x >= 0 && seen->y >= 0
          && seen->x <= canvas->width - 1 && seen->y <= canvas->height - 1))
    return FALSE;
  look_slope (scene, u, v, J);
  if (J[0] * J[3] - J[1] * J[2] <= 0)
    return FALSE;
  for (guint i = 0; i < scene->n_discs; i++) {
    const TestDisc *disc = &scene->discs[i];

    if (hypot (seen->x - disc->x, seen->y - disc->y) < disc->radius + 1)
      return FALSE;
  }
  /* The nearest pixel sees this part of the cloth, not a fold before it. */
  at = (gsize) (seen->y + 0.5) * (gsize) canvas->width +
      (gsize) (seen->x + 0.5);
  return canvas->depth[at] > 0
      && fabs (canvas->u[at] - u) < scene->pattern->square_m / 2
      && fabs (canvas->v[at] - v) < scene->pattern->square_m / 2;
}

static void
tell_truth (const Canvas * canvas, TestRender * render)
{
  const ClothPattern *p = canvas->scene->pattern;

  for (gint row = 0; row <= p->rows; row++) {
    for (gint column = 0; column <= p->columns; column++) {
      const gint at = row * (p->columns + 1) + column;
      Seen seen;

      render->visible[at] = can_see (canvas,
          p->origin_uv_m[0] + column * p->square_m,
          p->origin_uv_m[1] + row * p->square_m, &seen);
      render->x[at] = seen.x;
      render->y[at] = seen.y;
    }
  }
  for (gint n = 0; n < p->rows * p->columns; n++) {
    render->square_visible[n] = TRUE;
    for (gint i = 0; i < 25 && render->square_visible[n]; i++) {
      Seen seen;

      render->square_visible[n] = can_see (canvas,
          p->origin_uv_m[0] + (n % p->columns + i % 5 / 4.0) * p->square_m,
          p->origin_uv_m[1] + (n / p->columns + i / 5 / 4.0) * p->square_m,
          &seen);
    }
  }
}

TestRender *
test_render (const TestScene * scene)
{
  const ClothPattern *p = scene->pattern;
  TestRender *render = g_new0 (TestRender, 1);
  const gsize n = (gsize) scene->camera->width * (gsize) scene->camera->height;
  g_autofree gfloat *depth = g_new0 (gfloat, n);
  g_autofree gdouble *u = g_new0 (gdouble, n), *v = g_new0 (gdouble, n);
  g_autofree gfloat *light = g_new0 (gfloat, n);
  Canvas canvas = { scene, scene->camera->width, scene->camera->height, depth,
    u, v, light
  };
  ClothRandom random;

  g_assert_cmpint (scene->camera->lens, ==, CLOTH_LENS_NONE);
  render->width = canvas.width;
  render->height = canvas.height;
  render->data = g_malloc (n);
  render->n_vertices = (guint) ((p->columns + 1) * (p->rows + 1));
  render->x = g_new0 (gdouble, render->n_vertices);
  render->y = g_new0 (gdouble, render->n_vertices);
  render->visible = g_new0 (guint8, render->n_vertices);
  render->n_squares = (guint) (p->columns * p->rows);
  render->square_visible = g_new0 (guint8, render->n_squares);
  fill_depth (&canvas);
  shade (&canvas);
  blur (&canvas);
  cloth_random_init (&random, scene->seed);
  for (gsize i = 0; i < n; i++) {
    gdouble value = light[i];

    if (scene->noise > 0)
      value += scene->noise * cloth_random_gaussian (&random);
    render->data[i] = (guint8) CLAMP (floor (value + 0.5), 0, 255);
  }
  tell_truth (&canvas, render);
  return render;
}

void
test_render_free (TestRender * render)
{
  if (!render)
    return;
  g_free (render->data);
  g_free (render->x);
  g_free (render->y);
  g_free (render->visible);
  g_free (render->square_visible);
  g_free (render);
}
