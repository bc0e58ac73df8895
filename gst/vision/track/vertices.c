/* The vertices of a grid in a picture, between features whose places on the cloth are known.
 *
 * Model: the picture of the cloth is linear in (u, v) on each Delaunay triangle of the features, whose
 *   places have noise N(0, s² I). What bends between them shows where the neighbouring triangles' planes
 *   would put the same vertex.
 * Formula: with barycentric weights ω of a vertex in its triangle, p = Σ ω_i p_i, and with p_k where the
 *   plane of the k-th neighbour has it, the covariance is s² Σ ω_i² I + mean of (p − p_k)(p − p_k)ᵀ.
 * Assumption: a sheet that is seen doesn't turn over: a triangle whose sides run the other way round than
 *   most is part of a fold, or has a feature that is wrong, and places nothing.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/vertices.h"

#include <math.h>
#include <string.h>

#include "gst/math/delaunay.h"

#define NONE G_MAXUINT

typedef struct
{
  guint corner[3];              /* counterclockwise on the cloth */
  guint across[3];              /* the triangle beyond the side opposite of each corner, or NONE */
  gboolean good;
} Triangle;

/* A side of a triangle: its two ends, and 3 · triangle + the corner opposite of it. */
typedef struct
{
  guint low, high, of;
} Side;

typedef struct
{
  gdouble uv[2];
  guint number;
} Feature;

struct _ClothVertices
{
  guint columns, rows;
  gdouble width, height;
  ClothDelaunay *delaunay;
  GArray *features, *places;    /* in the order of (u, v), each once: (u, v), then px */
  GArray *triangles;
  GArray *sides;                /* of the triangles */
};

/* Returns: the usual ones
 */
ClothVerticesParams
cloth_vertices_default_params (void)
{
  return (ClothVerticesParams) {
  0.3, 2.};
}

/* @columns: of the grid, at least 2
 * @rows: of it, at least 2
 * @width: of the cloth, m
 * @height: of it
 *
 * Returns: (transfer full): what places the grid's vertices, whose (u, v) are even over the cloth
 */
ClothVertices *
cloth_vertices_new (guint columns, guint rows, gdouble width, gdouble height)
{
  ClothVertices *self = g_new0 (ClothVertices, 1);

  self->columns = columns;
  self->rows = rows;
  self->width = width;
  self->height = height;
  self->delaunay = cloth_delaunay_new ();
  self->features = g_array_new (FALSE, FALSE, sizeof (Feature));
  self->places = g_array_new (FALSE, FALSE, sizeof (gdouble));
  self->triangles = g_array_new (FALSE, FALSE, sizeof (Triangle));
  self->sides = g_array_new (FALSE, FALSE, sizeof (Side));
  return self;
}

/* @vertices: (nullable) (transfer full): what places vertices
 */
void
cloth_vertices_free (ClothVertices * vertices)
{
  if (!vertices)
    return;
  cloth_delaunay_free (vertices->delaunay);
  g_array_unref (vertices->features);
  g_array_unref (vertices->places);
  g_array_unref (vertices->triangles);
  g_array_unref (vertices->sides);
  g_free (vertices);
}

/* Twice the signed area of a triangle of places, [n][2]. */
static gdouble
area (const gdouble * places, const guint corner[3])
{
  const gdouble *a = places + 2 * (gsize) corner[0];
  const gdouble *b = places + 2 * (gsize) corner[1];
  const gdouble *c = places + 2 * (gsize) corner[2];

  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static gdouble
longest_side (const gdouble * places, const guint corner[3])
{
  gdouble longest = 0.;

  for (guint i = 0; i < 3; i++) {
    const gdouble *a = places + 2 * (gsize) corner[i];
    const gdouble *b = places + 2 * (gsize) corner[(i + 1) % 3];

    longest = fmax (longest, hypot (a[0] - b[0], a[1] - b[1]));
  }
  return longest;
}

static gint
compare_sides (gconstpointer a, gconstpointer b)
{
  const Side *x = a, *y = b;

  if (x->low != y->low)
    return x->low < y->low ? -1 : 1;
  if (x->high != y->high)
    return x->high < y->high ? -1 : 1;
  return (x->of > y->of) - (x->of < y->of);
}

/* Which triangle lies beyond each side: no side has more than two. */
static void
link_triangles (ClothVertices * self)
{
  Triangle *triangles = (Triangle *) (gpointer) self->triangles->data;
  const Side *sides;

  g_array_set_size (self->sides, 0);
  for (guint t = 0; t < self->triangles->len; t++)
    for (guint i = 0; i < 3; i++) {
      const guint a = triangles[t].corner[(i + 1) % 3];
      const guint b = triangles[t].corner[(i + 2) % 3];
      const Side side = { MIN (a, b), MAX (a, b), 3 * t + i };

      triangles[t].across[i] = NONE;
      g_array_append_val (self->sides, side);
    }
  g_array_sort (self->sides, compare_sides);
  sides = (const Side *) (gpointer) self->sides->data;
  for (guint s = 1; s < self->sides->len; s++) {
    const guint a = sides[s - 1].of, b = sides[s].of;

    if (sides[s - 1].low != sides[s].low || sides[s - 1].high != sides[s].high)
      continue;
    triangles[a / 3].across[a % 3] = b / 3;
    triangles[b / 3].across[b % 3] = a / 3;
  }
}

/* Triangles of features that are near to each other, and the way round that most of them run in the picture.
 * Returns whether that is the other one than on the cloth. */
static gboolean
find_triangles (ClothVertices * self, guint n, const gdouble * uv,
    const gdouble * px, gdouble reach)
{
  guint n_found, n_mirrored = 0;
  const guint *corners = cloth_delaunay_run (self->delaunay, n, uv,
      sqrt (self->width * self->height / n), &n_found);
  gboolean mirrored;

  g_array_set_size (self->triangles, 0);
  for (guint t = 0; t < n_found; t++) {
    Triangle triangle = { {corners[3 * t], corners[3 * t + 1],
        corners[3 * t + 2]}
    };

    if (!(area (uv, triangle.corner) > 0.)
        || longest_side (uv, triangle.corner) > reach)
      continue;
    n_mirrored += area (px, triangle.corner) < 0.;
    g_array_append_val (self->triangles, triangle);
  }
  mirrored = 2 * n_mirrored > self->triangles->len;
  for (guint t = 0; t < self->triangles->len; t++) {
    Triangle *triangle = &g_array_index (self->triangles, Triangle, t);
    const gdouble signed_area = area (px, triangle->corner);

    triangle->good = mirrored ? signed_area < 0. : signed_area > 0.;
  }
  link_triangles (self);
  return mirrored;
}

/* Barycentric weights of a place. */
static void
find_weights (const gdouble * uv, const guint corner[3], const gdouble at[2],
    gdouble weights[3])
{
  const gdouble all = area (uv, corner);

  for (guint i = 0; i < 3; i++) {
    const gdouble *a = uv + 2 * (gsize) corner[(i + 1) % 3];
    const gdouble *b = uv + 2 * (gsize) corner[(i + 2) % 3];

    weights[i] = ((b[0] - a[0]) * (at[1] - a[1]) -
        (b[1] - a[1]) * (at[0] - a[0])) / all;
  }
}

static void
mix (const gdouble * px, const guint corner[3], const gdouble weights[3],
    gdouble place[2])
{
  place[0] = place[1] = 0.;
  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 2; k++)
      place[k] += weights[i] * px[2 * (gsize) corner[i] + k];
}

/* Adds what neighbouring planes say. Returns whether there is a neighbour. */
static gboolean
add_bend (const ClothVertices * self, const Triangle * triangle,
    const gdouble * uv, const gdouble * px, const gdouble at[2],
    ClothGridVertex * vertex)
{
  gdouble xx = 0., xy = 0., yy = 0.;
  guint n = 0;

  for (guint i = 0; i < 3; i++) {
    const Triangle *other;
    gdouble weights[3], place[2], dx, dy;

    if (triangle->across[i] == NONE)
      continue;
    other = &g_array_index (self->triangles, Triangle, triangle->across[i]);
    if (!other->good)
      continue;
    find_weights (uv, other->corner, at, weights);
    mix (px, other->corner, weights, place);
    dx = place[0] - vertex->x;
    dy = place[1] - vertex->y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
    n++;
  }
  if (n == 0)
    return FALSE;
  vertex->xx += xx / n;
  vertex->xy += xy / n;
  vertex->yy += yy / n;
  return TRUE;
}

/* Places the vertices in a triangle. Returns how many that were not placed yet. */
static guint
place_in (const ClothVertices * self, const Triangle * triangle,
    const gdouble * uv, const gdouble * px, gdouble spread, gboolean mirrored,
    ClothGridVertex * grid)
{
  const gdouble du = self->width / (self->columns - 1);
  const gdouble dv = self->height / (self->rows - 1);
  gdouble low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  guint n = 0;

  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 2; k++) {
      const gdouble x = uv[2 * (gsize) triangle->corner[i] + k];

      low[k] = fmin (low[k], x);
      high[k] = fmax (high[k], x);
    }
  for (gint row = MAX ((gint) ceil (low[1] / dv), 0);
      row <= MIN ((gint) floor (high[1] / dv), (gint) self->rows - 1); row++)
    for (gint column = MAX ((gint) ceil (low[0] / du), 0);
        column <= MIN ((gint) floor (high[0] / du), (gint) self->columns - 1);
        column++) {
      ClothGridVertex *vertex = &grid[row * (gint) self->columns + column];
      const gdouble at[2] = { column * du, row * dv };
      gdouble weights[3], place[2], noise;
      ClothGridVertex placed;

      find_weights (uv, triangle->corner, at, weights);
      if (vertex->state != CLOTH_GRID_UNSEEN || weights[0] < 0.
          || weights[1] < 0. || weights[2] < 0.)
        continue;
      mix (px, triangle->corner, weights, place);
      noise = spread * spread * (weights[0] * weights[0] +
          weights[1] * weights[1] + weights[2] * weights[2]);
      placed = (ClothGridVertex) {
      CLOTH_GRID_FOLLOWED, mirrored, place[0], place[1], noise, 0., noise};
      if (!add_bend (self, triangle, uv, px, at, &placed))
        continue;
      *vertex = placed;
      n++;
    }
  return n;
}

static gint
compare_features (gconstpointer a, gconstpointer b)
{
  const Feature *x = a, *y = b;

  for (guint k = 0; k < 2; k++)
    if (x->uv[k] != y->uv[k])
      return x->uv[k] < y->uv[k] ? -1 : 1;
  return x->number < y->number ? -1 : x->number > y->number;
}

/* One place has several features where its gradients have several strong directions: one of them is enough.
 * Returns how many are left. */
static guint
list_features (ClothVertices * self, guint n, const gdouble * uv,
    const gdouble * px)
{
  guint kept = 0;

  g_array_set_size (self->features, n);
  g_array_set_size (self->places, 4 * n);
  for (guint i = 0; i < n; i++)
    g_array_index (self->features, Feature, i) = (Feature) {
    {
    uv[2 * i], uv[2 * i + 1]}
    , i};
  g_array_sort (self->features, compare_features);
  for (guint i = 0; i < n; i++) {
    const Feature *f = &g_array_index (self->features, Feature, i);
    gdouble *to = &g_array_index (self->places, gdouble, 0);

    if (kept && to[2 * (kept - 1)] == f->uv[0]
        && to[2 * (kept - 1) + 1] == f->uv[1])
      continue;
    memcpy (to + 2 * (gsize) kept, f->uv, sizeof f->uv);
    memcpy (to + 2 * ((gsize) n + kept), px + 2 * (gsize) f->number,
        sizeof f->uv);
    kept++;
  }
  return kept;
}

/* @vertices: what places them
 * @params: how
 * @n: number of features
 * @uv: (array): where each is on the cloth, m, [n][2]
 * @px: (array): where each is in a picture, px, [n][2]
 * @grid: (out) (array): the vertices, row by row
 *
 * Returns: how many were placed
 */
guint
cloth_vertices_run (ClothVertices * vertices,
    const ClothVerticesParams * params, guint n, const gdouble * uv,
    const gdouble * px, ClothGridVertex * grid)
{
  const gdouble edge = hypot (vertices->width / (vertices->columns - 1),
      vertices->height / (vertices->rows - 1));
  guint n_placed = 0, kept;
  gboolean mirrored;

  for (guint v = 0; v < vertices->columns * vertices->rows; v++)
    grid[v] = (ClothGridVertex) {
    CLOTH_GRID_UNSEEN,.x = NAN,.y = NAN};
  kept = n ? list_features (vertices, n, uv, px) : 0;
  if (kept < 3)
    return 0;
  uv = &g_array_index (vertices->places, gdouble, 0);
  px = uv + 2 * (gsize) n;
  mirrored = find_triangles (vertices, kept, uv, px, params->reach * edge);
  for (guint t = 0; t < vertices->triangles->len; t++) {
    const Triangle *triangle = &g_array_index (vertices->triangles, Triangle,
        t);

    if (triangle->good)
      n_placed += place_in (vertices, triangle, uv, px, params->spread,
          mirrored, grid);
  }
  return n_placed;
}
