/* What of a mesh each pixel of a camera sees, in one pass over the triangles.
 *
 * Vertices are projected through the lens. Triangles are cut into n² where it bends their edges, n
 * one number for the whole picture, so that neighbours stay together: a curve is off its chord by a
 * quarter as much when it is halved. What lies between is linear over depth (Heckbert and Moreton,
 * “Interpolation for polygon texture mapping and shading”, 1991). The nearest is seen, of equally
 * near ones the first of the mesh. Threads have rows of the picture each, and no number depends on
 * which.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/coverage.h"

#include <math.h>
#include <string.h>

#include "gst/render/scan.h"

/* Rows that a thread has at a time. */
#define BAND 32

typedef struct
{
  gdouble x, y;                 /* px */
  gdouble w;                    /* 1/depth; 0 when not seen */
} Point;

typedef struct
{
  ClothCoverage public;
  guint n_vertices;
  Point *vertices;
  gint n_cuts;                  /* of each edge */
  gsize n_points;               /* of a triangle */
  Point *points;                /* of all triangles */
  gsize points_size, pixels_size;
  gfloat *depths;               /* 1/depth, greatest nearest; 0 where none is seen */

  /* of the picture that is drawn */
  const ClothCamera *camera;
  const gdouble *positions;
} Coverage;

/* @n_vertices: vertices of the mesh
 * @faces: (array): 4 indices a face, the last 0xffffffff for a triangle; all others below
 *   @n_vertices
 * @n_faces: faces
 *
 * Returns: (transfer full): of which nothing was drawn yet
 */
ClothCoverage *
cloth_coverage_new (guint n_vertices, const guint32 * faces, guint n_faces)
{
  Coverage *self = g_new0 (Coverage, 1);

  self->n_vertices = n_vertices;
  self->vertices = g_new (Point, MAX (n_vertices, 1));
  self->public.triangles = g_malloc (2 * (gsize) n_faces *
      sizeof *self->public.triangles + 1);
  self->public.n_triangles = cloth_scan_list_triangles (faces, n_faces,
      self->public.triangles[0]);
  return &self->public;
}

/* @coverage: (nullable) (transfer full): a coverage
 */
void
cloth_coverage_free (ClothCoverage * coverage)
{
  Coverage *self = (Coverage *) coverage;

  if (!coverage)
    return;
  g_free (self->vertices);
  g_free (self->points);
  g_free (self->depths);
  g_free (coverage->triangles);
  g_free (coverage->seen);
  g_free (coverage->places);
  g_free (self);
}

/* ---- points ---- */

static void
see (const ClothCamera * camera, const gdouble X[3], Point * point)
{
  const gdouble *R = camera->R;
  gdouble px[2];

  point->w = 0.;
  if (!isfinite (X[0] + X[1] + X[2])
      || !cloth_camera_project (camera, X, px, NULL, NULL))
    return;
  point->x = px[0];
  point->y = px[1];
  if (fabs (px[0]) < CLOTH_SCAN_FAR_PX && fabs (px[1]) < CLOTH_SCAN_FAR_PX)
    point->w = 1. / (R[6] * X[0] + R[7] * X[1] + R[8] * X[2] + camera->t[2]);
}

static void
see_vertices (gpointer data, guint begin, guint end, guint worker)
{
  Coverage *self = data;

  for (gsize i = begin; i < end; i++)
    see (self->camera, self->positions + 3 * i, &self->vertices[i]);
}

/* i·a + j·b + k·c over their sum: on an edge the same for both of its triangles, as one term is 0. */
static void
mix (const Coverage * self, const guint32 t[3], const gint ijk[3], gdouble X[3])
{
  const gdouble sum = ijk[0] + ijk[1] + ijk[2];

  for (guint k = 0; k < 3; k++) {
    const gdouble a = ijk[0] * self->positions[3 * (gsize) t[0] + k];
    const gdouble b = ijk[1] * self->positions[3 * (gsize) t[1] + k];

    X[k] = ((a + b) + ijk[2] * self->positions[3 * (gsize) t[2] + k]) / sum;
  }
}

/* Whether both lie beyond the same border of the picture: then nothing between them is in it. */
static gboolean
are_outside (const Coverage * self, const Point * a, const Point * b)
{
  const gdouble right = self->camera->width - 0.5;
  const gdouble bottom = self->camera->height - 0.5;

  return MAX (a->x, b->x) < -0.5 || MAX (a->y, b->y) < -0.5
      || MIN (a->x, b->x) > right || MIN (a->y, b->y) > bottom;
}

/* How far the curve between two corners is off its chord, in its middle. */
static gdouble
find_bend (const Coverage * self, const guint32 t[3], guint from, guint to)
{
  const Point *a = &self->vertices[t[from]], *b = &self->vertices[t[to]];
  const gdouble dx = b->x - a->x, dy = b->y - a->y, length = hypot (dx, dy);
  gint ijk[3] = { 0 };
  gdouble X[3];
  Point middle;

  if (!(a->w > 0 && b->w > 0) || are_outside (self, a, b))
    return 0.;
  ijk[from] = ijk[to] = 1;
  mix (self, t, ijk, X);
  see (self->camera, X, &middle);
  if (!(middle.w > 0 && length > 0))
    return 0.;
  return fabs (dx * (middle.y - a->y) - dy * (middle.x - a->x)) / length;
}

static void
choose_cuts (Coverage * self)
{
  gdouble worst = 0.;

  self->n_cuts = 1;
  self->public.bend_px = 0.;
  if (self->camera->lens == CLOTH_LENS_NONE)
    return;
  for (guint i = 0; i < self->public.n_triangles; i++)
    for (guint k = 0; k < 3; k++)
      worst = fmax (worst, find_bend (self, self->public.triangles[i], k,
              (k + 1) % 3));
  self->n_cuts = (gint) CLAMP (ceil (sqrt (worst / CLOTH_COVERAGE_BEND_PX)), 1,
      CLOTH_COVERAGE_MOST_CUTS);
  self->public.bend_px = worst / (self->n_cuts * self->n_cuts);
}

/* Points of a triangle: row i from the first corner to the side opposite has i + 1. */
static inline gsize
index_of (gint i, gint j)
{
  return (gsize) (i * (i + 1) / 2 + j);
}

static void
see_points (gpointer data, guint begin, guint end, guint worker)
{
  Coverage *self = data;
  const gint n = self->n_cuts;

  for (gsize f = begin; f < end; f++) {
    const guint32 *t = self->public.triangles[f];
    Point *points = self->points + f * self->n_points;

    if (n == 1) {
      for (guint k = 0; k < 3; k++)
        points[k] = self->vertices[t[k]];
      continue;
    }
    for (gint i = 0; i <= n; i++)
      for (gint j = 0; j <= i; j++) {
        const gint ijk[3] = { n - i, i - j, j };
        gdouble X[3];

        mix (self, t, ijk, X);
        see (self->camera, X, &points[index_of (i, j)]);
      }
  }
}

/* ---- pixels ---- */

/* What is linear in the picture: 1/depth, and the weights of two corners over it. */
typedef struct
{
  gdouble x, y;
  gdouble w[3], a[3], b[3];     /* value at (x, y), slopes */
} Plane;

static void
fill_row (Coverage * self, const Plane * plane, guint32 triangle, gint y,
    gint from, gint to)
{
  const gsize row = (gsize) y * (gsize) self->public.width;
  const gdouble dy = y - plane->y;
  const gdouble w = plane->w[0] + plane->w[2] * dy;
  const gdouble a = plane->a[0] + plane->a[2] * dy;
  const gdouble b = plane->b[0] + plane->b[2] * dy;

  for (gint x = from; x < to; x++) {
    const gsize at = row + (gsize) x;
    const gdouble dx = x - plane->x;
    const gdouble here = w + plane->w[1] * dx;

    if ((gfloat) here <= self->depths[at])
      continue;
    self->depths[at] = (gfloat) here;
    self->public.seen[at] = triangle;
    self->public.places[2 * at] = (gfloat) ((a + plane->a[1] * dx) / here);
    self->public.places[2 * at + 1] = (gfloat) ((b + plane->b[1] * dx) / here);
  }
}

/* @weights: of the second and third corner of the triangle, at each corner of this piece of it */
static void
fill_piece (Coverage * self, guint32 triangle, const Point * const p[3],
    gdouble weights[3][2], gint top, gint bottom)
{
  const gdouble area = (p[1]->x - p[0]->x) * (p[2]->y - p[0]->y) -
      (p[1]->y - p[0]->y) * (p[2]->x - p[0]->x);
  const gdouble low = MIN (p[0]->y, MIN (p[1]->y, p[2]->y));
  const gdouble high = MAX (p[0]->y, MAX (p[1]->y, p[2]->y));
  gdouble x[3], y[3], w[3], a[3], b[3];
  ClothScanEdge edges[3];
  Plane plane;

  if (!(p[0]->w > 0 && p[1]->w > 0 && p[2]->w > 0) || area == 0.)
    return;
  top = MAX (cloth_scan_ceiling (low), top);
  bottom = MIN (cloth_scan_ceiling (high), bottom);
  if (top >= bottom)
    return;
  for (guint k = 0; k < 3; k++) {
    x[k] = p[k]->x;
    y[k] = p[k]->y;
    w[k] = p[k]->w;
    a[k] = weights[k][0] * w[k];
    b[k] = weights[k][1] * w[k];
    cloth_scan_edge_init (&edges[k], p[k]->x, p[k]->y, p[(k + 1) % 3]->x,
        p[(k + 1) % 3]->y);
  }
  plane.x = x[0];
  plane.y = y[0];
  cloth_scan_set_plane (plane.w, x, y, area, w);
  cloth_scan_set_plane (plane.a, x, y, area, a);
  cloth_scan_set_plane (plane.b, x, y, area, b);
  for (gint row = top; row < bottom; row++) {
    gint from, to;

    cloth_scan_row (edges, row, self->public.width, &from, &to);
    fill_row (self, &plane, triangle, row, from, to);
  }
}

static void
fill_triangle (Coverage * self, guint32 triangle, gint top, gint bottom)
{
  const Point *points = self->points + triangle * self->n_points;
  const gint n = self->n_cuts;

  for (gint i = 1; i <= n; i++)
    for (gint piece = 0; piece < 2 * i - 1; piece++) {
      /* each with its tip up, then, between two of them, down */
      const gint j = piece / 2, down = piece % 2;
      const gint places[3][2] = { {i - 1, j}, {i, j + down},
      {down ? i - 1 : i, j + 1}
      };
      const Point *p[3];
      gdouble weights[3][2];

      for (guint k = 0; k < 3; k++) {
        const gint a = places[k][0], b = places[k][1];

        p[k] = &points[index_of (a, b)];
        weights[k][0] = (gdouble) (a - b) / n;
        weights[k][1] = (gdouble) b / n;
      }
      fill_piece (self, triangle, p, weights, top, bottom);
    }
}

static void
fill_bands (gpointer data, guint begin, guint end, guint worker)
{
  Coverage *self = data;
  const gint top = (gint) begin * BAND;
  const gint bottom = MIN ((gint) end * BAND, self->public.height);
  const gsize at = (gsize) top * (gsize) self->public.width;
  const gsize n = (gsize) (bottom - top) * (gsize) self->public.width;

  memset (self->public.seen + at, 0xff, n * sizeof *self->public.seen);
  memset (self->depths + at, 0, n * sizeof *self->depths);
  for (guint i = 0; i < self->public.n_triangles; i++)
    fill_triangle (self, i, top, bottom);
}

static void
prepare (Coverage * self)
{
  const gsize pixels = (gsize) self->camera->width *
      (gsize) self->camera->height;

  self->public.width = self->camera->width;
  self->public.height = self->camera->height;
  if (self->pixels_size >= pixels)
    return;
  self->pixels_size = pixels;
  self->public.seen = g_renew (guint32, self->public.seen, pixels);
  self->public.places = g_renew (gfloat, self->public.places, 2 * pixels);
  self->depths = g_renew (gfloat, self->depths, pixels);
}

static void
prepare_points (Coverage * self)
{
  gsize n;

  self->n_points = index_of (self->n_cuts + 1, 0);
  n = self->n_points * self->public.n_triangles;
  if (self->points_size >= n)
    return;
  self->points_size = n;
  self->points = g_renew (Point, self->points, n);
}

/* @coverage: where to
 * @camera: whose picture
 * @positions: (array): 3 numbers a vertex, m, world; NaN where unknown
 * @pool: (nullable): threads that share it out
 *
 * Draws all triangles whose corners are known and before the camera. A pixel sees what its centre
 * sees; a centre on the border of two triangles belongs to the one to its right or below. Nothing
 * is allocated but for a larger picture or more cuts than before.
 */
void
cloth_coverage_draw (ClothCoverage * coverage, const ClothCamera * camera,
    const gdouble * positions, ClothPool * pool)
{
  Coverage *self = (Coverage *) coverage;

  self->camera = camera;
  self->positions = positions;
  prepare (self);
  cloth_pool_run (pool, see_vertices, self, self->n_vertices);
  choose_cuts (self);
  prepare_points (self);
  cloth_pool_run (pool, see_points, self, coverage->n_triangles);
  cloth_pool_run (pool, fill_bands, self,
      (guint) (coverage->height + BAND - 1) / BAND);
}
