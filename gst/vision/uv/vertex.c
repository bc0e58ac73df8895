/* The vertices of a cloth's grid in space.
 *
 * Each pixel with a uv is of the nearest vertex. A parabola over (u, v) through the columns
 * and rows of a vertex's pixels tells its place in the picture; one over the picture through
 * their inverse depths and rays tells its point in space. So neither rests on one noisy
 * pixel, and both reach a little beyond the cloth's last pixel, where the outer vertices are.
 *
 * The covariance is the place's, laid on the surface, and the depth's along the ray.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/uv/vertex.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"

#define NONE G_MAXUINT32
/* Terms of a plane and of a parabola. */
#define PLANE 3
#define PARABOLA 6
/* Fewest pixels of a plane, and of a parabola. */
#define PLANE_PIXELS 6
#define PARABOLA_PIXELS 20
/* A parabola's middle lies within its pixels when their mean is not farther from it than
 * this share of their extent: else it would turn away, and a plane is fitted. */
#define WITHIN 0.5
/* Pixels of a surface are at most this many times as far apart as on the flat cloth; and a
 * place known otherwise is at most so many radii from where uv has the vertex. */
#define APART 1.5

struct _ClothUVVertices
{
  GArray *starts;               /* guint: first pixel of each vertex, and the end */
  GArray *pixels;               /* guint32 */
  GArray *depths;               /* gdouble: of one vertex */
  GArray *spots;                /* guint32 of each vertex: its spot */
};

/* One pixel of a vertex, from the middle of what is fitted. */
typedef struct
{
  gdouble a, b, weight;
  gdouble values[3];
} Sample;

/* Value and slopes of a fit in its middle. */
typedef struct
{
  gdouble value[3], slope_a[3], slope_b[3];
} Fit;

typedef struct
{
  gdouble ata[PARABOLA * PARABOLA], atb[3][PARABOLA];
  gdouble weights, mean[2], extent;
  guint n;
} Sums;

typedef struct
{
  ClothUVVertices *self;
  ClothUVVertexParams params;
  const ClothGridShape *shape;
  const ClothMatchSurface *surface;
  const gfloat *uv;
  const ClothUVDepth *depth;
  const ClothUV *dense;
} Run;

/* Returns: as measured on rendered cloth, 1.1 mm a pixel
 */
ClothUVVertexParams
cloth_uv_vertex_default_params (void)
{
  return (ClothUVVertexParams) {
  0.008, 0.004, 0.3, 0.0002, 0.5, 0.08};
}

/* Returns: (transfer full): room for the vertices of one picture at a time
 */
ClothUVVertices *
cloth_uv_vertices_new (void)
{
  ClothUVVertices *self = g_new (ClothUVVertices, 1);

  self->starts = g_array_new (FALSE, FALSE, sizeof (guint));
  self->pixels = g_array_new (FALSE, FALSE, sizeof (guint32));
  self->depths = g_array_new (FALSE, FALSE, sizeof (gdouble));
  self->spots = g_array_new (FALSE, FALSE, sizeof (guint32));
  return self;
}

/* @self: (nullable) (transfer full): what to free
 */
void
cloth_uv_vertices_free (ClothUVVertices * self)
{
  if (!self)
    return;
  g_array_unref (self->starts);
  g_array_unref (self->pixels);
  g_array_unref (self->depths);
  g_array_unref (self->spots);
  g_free (self);
}

/* ---- pixels of each vertex ---- */

static const gfloat *
get_point (const Run * run, guint32 pixel)
{
  return run->surface->points + 3 * ((gsize) (pixel / run->surface->width)
      * run->surface->stride + pixel % run->surface->width);
}

static void
get_vertex_uv (const ClothGridShape * shape, guint vertex, gdouble uv[2])
{
  uv[0] = shape->cloth_m[0] * (vertex % shape->columns) / (shape->columns - 1);
  uv[1] = shape->cloth_m[1] * (vertex / shape->columns) / (shape->rows - 1);
}

/* The vertex that a uv is near enough to. */
static guint32
find_vertex (const Run * run, gfloat u, gfloat v)
{
  const ClothGridShape *s = run->shape;
  const gdouble column = rint (u / s->cloth_m[0] * (s->columns - 1));
  const gdouble row = rint (v / s->cloth_m[1] * (s->rows - 1));
  gdouble at[2];
  guint32 vertex;

  if (!(column >= 0 && row >= 0 && column < s->columns && row < s->rows))
    return NONE;
  vertex = (guint32) row *s->columns + (guint32) column;
  get_vertex_uv (s, vertex, at);
  at[0] -= u;
  at[1] -= v;
  return at[0] * at[0] + at[1] * at[1] < run->params.radius
      * run->params.radius ? vertex : NONE;
}

static void
share_out (const Run * run)
{
  const guint n_pixels = (guint) run->surface->width * run->surface->height;
  const guint n = (guint) run->shape->columns * run->shape->rows;
  guint *starts = (guint *) g_array_set_size (run->self->starts,
      n + 2)->data;
  guint32 *pixels;

  memset (starts, 0, (n + 2) * sizeof *starts);
  for (guint i = 0; i < n_pixels; i++)
    if (!isnan (run->uv[2 * (gsize) i])) {
      const guint32 vertex = find_vertex (run, run->uv[2 * (gsize) i],
          run->uv[2 * (gsize) i + 1]);

      if (vertex != NONE)
        starts[vertex + 2]++;
    }
  for (guint k = 2; k < n + 2; k++)
    starts[k] += starts[k - 1];
  pixels = (guint32 *) g_array_set_size (run->self->pixels,
      starts[n + 1])->data;
  for (guint i = 0; i < n_pixels; i++)
    if (!isnan (run->uv[2 * (gsize) i])) {
      const guint32 vertex = find_vertex (run, run->uv[2 * (gsize) i],
          run->uv[2 * (gsize) i + 1]);

      if (vertex != NONE)
        pixels[starts[vertex + 1]++] = i;
    }
}

/* Keeps the pixels of one part of the surface; returns how many, 0 where too many are of
 * another. */
static guint
keep_one_part (const Run * run, guint32 * pixels, guint n)
{
  gdouble *values = (gdouble *) g_array_set_size (run->self->depths, n)->data;
  const gdouble reach = APART * run->params.radius;
  gdouble middle[3];
  guint kept = 0;

  for (gint c = 0; c < 3; c++) {
    for (guint k = 0; k < n; k++)
      values[k] = get_point (run, pixels[k])[c];
    middle[c] = cloth_median (values, n);
  }
  for (guint k = 0; k < n; k++) {
    const gfloat *p = get_point (run, pixels[k]);
    gdouble square = 0;

    for (gint c = 0; c < 3; c++)
      square += (p[c] - middle[c]) * (p[c] - middle[c]);
    if (square <= reach * reach)
      pixels[kept++] = pixels[k];
  }
  return n - kept <= run->params.rival * n ? kept : 0;
}

/* ---- fits ---- */

static void
sums_add (Sums * sums, const Sample * s)
{
  const gdouble terms[PARABOLA] = { 1, s->a, s->b, s->a * s->a, s->a * s->b,
    s->b * s->b
  };

  for (gint i = 0; i < PARABOLA; i++) {
    for (gint j = 0; j <= i; j++)
      sums->ata[PARABOLA * i + j] += s->weight * terms[i] * terms[j];
    for (gint c = 0; c < 3; c++)
      sums->atb[c][i] += s->weight * terms[i] * s->values[c];
  }
  sums->weights += s->weight;
  sums->mean[0] += s->weight * s->a;
  sums->mean[1] += s->weight * s->b;
  sums->extent += s->weight * (s->a * s->a + s->b * s->b);
  sums->n++;
}

static gboolean
sums_solve (const Sums * sums, guint n_terms, Fit * fit)
{
  gdouble a[PARABOLA * PARABOLA], b[PARABOLA];

  for (guint i = 0; i < n_terms; i++)
    for (guint j = 0; j < n_terms; j++)
      a[n_terms * i + j] = sums->ata[PARABOLA * MAX (i, j) + MIN (i, j)];
  if (!cloth_cholesky_factor (n_terms, a))
    return FALSE;
  for (gint c = 0; c < 3; c++) {
    memcpy (b, sums->atb[c], sizeof b);
    cloth_cholesky_solve (n_terms, a, b);
    fit->value[c] = b[0];
    fit->slope_a[c] = b[1];
    fit->slope_b[c] = b[2];
  }
  return TRUE;
}

/* A parabola where the middle lies within many pixels, else a plane. */
static gboolean
sums_fit (const Sums * sums, Fit * fit)
{
  const gdouble off = (sums->mean[0] * sums->mean[0]
      + sums->mean[1] * sums->mean[1]) / MAX (sums->weights, 1e-300);

  return (sums->n >= PARABOLA_PIXELS && off <= WITHIN * WITHIN * sums->extent
      && sums_solve (sums, PARABOLA, fit))
      || (sums->n >= PLANE_PIXELS && sums_solve (sums, PLANE, fit));
}

/* Falls from 1 to 0 at @square 1. */
static gdouble
weigh (gdouble square)
{
  return square < 1 ? (1 - square) * (1 - square) : 0;
}

/* Where the picture shows a vertex, by uv. @step: (out): xx, xy and yy of what the place's
 * covariance would be if uv's standard deviation were a radius */
static gboolean
find_place (const Run * run, guint vertex, const guint32 * pixels, guint n,
    ClothUVSpot * spot, gdouble step[3])
{
  const gdouble radius = run->params.radius;
  gdouble at[2], nearest = INFINITY, sigma;
  guint32 middle = 0;
  Sums sums = { {0} };
  Fit fit;

  get_vertex_uv (run->shape, vertex, at);
  for (guint k = 0; k < n; k++) {
    const gfloat *uv = run->uv + 2 * (gsize) pixels[k];
    Sample s = { (uv[0] - at[0]) / radius, (uv[1] - at[1]) / radius };

    if (s.a * s.a + s.b * s.b < nearest) {
      nearest = s.a * s.a + s.b * s.b;
      middle = pixels[k];
    }
    s.weight = weigh (s.a * s.a + s.b * s.b);
    s.values[0] = pixels[k] % run->surface->width;
    s.values[1] = pixels[k] / run->surface->width;
    sums_add (&sums, &s);
  }
  if (!(sqrt (nearest) * radius <= run->params.edge) || !sums_fit (&sums, &fit))
    return FALSE;
  sigma = run->params.noise;
  if (run->dense)
    sigma = MAX (sigma, cloth_uv_get_sigma (run->dense, middle));
  sigma *= sigma / (radius * radius);
  step[0] = fit.slope_a[0] * fit.slope_a[0] + fit.slope_b[0] * fit.slope_b[0];
  step[1] = fit.slope_a[0] * fit.slope_a[1] + fit.slope_b[0] * fit.slope_b[1];
  step[2] = fit.slope_a[1] * fit.slope_a[1] + fit.slope_b[1] * fit.slope_b[1];
  *spot = (ClothUVSpot) {
  vertex, fit.value[0], fit.value[1], sigma * step[0], sigma * step[1],
        sigma * step[2]};
  return TRUE;
}

/* Whether a place that is known otherwise lies where uv has the vertex, as far as the fits
 * reach. @step: covariance of the place for a radius on the flat cloth */
static gboolean
is_near (const ClothUVSpot * spot, const gdouble step[3],
    const ClothUVSpot * known)
{
  const gdouble dx = known->x - spot->x, dy = known->y - spot->y;
  const gdouble det = step[0] * step[2] - step[1] * step[1];

  return det > 0 && step[2] * dx * dx - 2 * step[1] * dx * dy
      + step[0] * dy * dy <= APART * APART * det;
}

/* The point of a place in the picture. */
static gboolean
find_point (const Run * run, const ClothUVSpot * spot, const guint32 * pixels,
    guint n, ClothUVVertex * vertex)
{
  const ClothUVDepth *depth = run->depth;
  gdouble square = 0, along, axis, z, step[2][3], ray[3];
  Sums sums = { {0} };
  Fit fit;

  for (guint k = 0; k < n; k++) {
    const gdouble x = pixels[k] % run->surface->width - spot->x;
    const gdouble y = pixels[k] / run->surface->width - spot->y;

    square = MAX (square, x * x + y * y);
  }
  for (guint k = 0; k < n; k++) {
    const gfloat *p = get_point (run, pixels[k]);
    Sample s = { pixels[k] % run->surface->width - spot->x,
      pixels[k] / run->surface->width - spot->y
    };

    s.weight = weigh ((s.a * s.a + s.b * s.b) / (square * 1.01 + 1));
    s.values[0] = p[0] / p[2];
    s.values[1] = p[1] / p[2];
    s.values[2] = 1 / p[2];
    sums_add (&sums, &s);
  }
  if (!sums_fit (&sums, &fit) || !(fit.value[2] > 0))
    return FALSE;
  z = 1 / fit.value[2];
  ray[0] = fit.value[0];
  ray[1] = fit.value[1];
  ray[2] = 1;
  axis = depth->normal[0] * ray[0] + depth->normal[1] * ray[1]
      + depth->normal[2];
  /* of the inverse depth */
  /* neighbouring disparities err alike: their mean is no better than one */
  along = MAX (isfinite (depth->sigma) ? depth->sigma : 0,
      run->params.depth_noise) * axis / depth->focal_baseline;
  along *= along;
  for (gint c = 0; c < 3; c++) {
    vertex->point[c] = z * ray[c];
    step[0][c] = z * ((c < 2 ? fit.slope_a[c] : 0)
        - z * ray[c] * fit.slope_a[2]);
    step[1][c] = z * ((c < 2 ? fit.slope_b[c] : 0)
        - z * ray[c] * fit.slope_b[2]);
  }
  for (gint i = 0, k = 0; i < 3; i++)
    for (gint j = i; j < 3; j++)
      vertex->covariance[k++] = z * z * z * z * along * ray[i] * ray[j]
          + step[0][i] * step[0][j] * spot->xx
          + (step[0][i] * step[1][j] + step[1][i] * step[0][j]) * spot->xy
          + step[1][i] * step[1][j] * spot->yy;
  vertex->seen = TRUE;
  return TRUE;
}

/* ---- all together ---- */

/* @self: room to work in
 * @params: what to do
 * @shape: the grid
 * @surface: point of each pixel, m, camera frame, z away from the camera
 * @uv: (array): u and v of each pixel of @surface, without padding, m
 * @dense: (nullable): what has made @uv last, which knows how sure it is
 * @depth: how sure @surface is
 * @spots: (array length=n_spots) (nullable): vertices whose place is known otherwise; those
 *   out of the grid or not finite don't count
 * @n_spots: how many
 * @vertices: (out): (array): columns·rows of @shape
 *
 * A vertex is unseen where no pixel is near it on the flat cloth, where its pixels contradict
 * each other, and where a spot lies elsewhere than they do.
 *
 * Returns: how many are seen
 */
guint
cloth_uv_vertices_run (ClothUVVertices * self,
    const ClothUVVertexParams * params, const ClothGridShape * shape,
    const ClothMatchSurface * surface, const gfloat * uv, const ClothUV * dense,
    const ClothUVDepth * depth, const ClothUVSpot * spots, guint n_spots,
    ClothUVVertex * vertices)
{
  const guint n = (guint) shape->columns * shape->rows;
  const Run run = { self, {
          MAX (params->radius, 1e-6), MAX (params->edge, 0),
          CLAMP (params->rival, 0, 1), MAX (params->noise, 0),
      MAX (params->doubt, 0), MAX (params->depth_noise, 0)}, shape, surface, uv,
  depth, dense
  };
  guint32 *of = (guint32 *) g_array_set_size (self->spots, n)->data;
  guint n_seen = 0;
  const guint *starts;

  share_out (&run);
  starts = (const guint *) self->starts->data;
  memset (of, 0xff, n * sizeof *of);
  for (guint k = 0; k < n_spots; k++)
    if (spots[k].vertex < n && isfinite (spots[k].x + spots[k].y + spots[k].xx
            + spots[k].xy + spots[k].yy))
      of[spots[k].vertex] = k;
  for (guint i = 0; i < n; i++) {
    guint32 *pixels = (guint32 *) self->pixels->data + starts[i];
    guint n_pixels = starts[i + 1] - starts[i];
    ClothUVSpot spot;
    gdouble step[3];

    vertices[i] = (ClothUVVertex) {
    FALSE};
    n_pixels = n_pixels ? keep_one_part (&run, pixels, n_pixels) : 0;
    if (!n_pixels || !find_place (&run, i, pixels, n_pixels, &spot, step))
      continue;
    if (of[i] != NONE) {
      const ClothUVSpot *known = &spots[of[i]];
      const gdouble share = run.params.doubt * run.params.doubt;

      if (!is_near (&spot, step, known))
        continue;
      spot = (ClothUVSpot) {
      i, known->x, known->y, known->xx + share * spot.xx,
            known->xy + share * spot.xy, known->yy + share * spot.yy};
    }
    n_seen += find_point (&run, &spot, pixels, n_pixels, &vertices[i]);
  }
  return n_seen;
}
