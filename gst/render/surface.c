/* A mesh drawn into a camera's picture as a shaded, printed surface.
 *
 * Triangles are filled row by row at the centres of the pixels, the nearest wins; places
 * of the print are in perspective at every 16th pixel of a row and linear between. Then
 * the rows that were touched are laid over the picture, once for each component.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/surface.h"

#include <math.h>
#include <string.h>

#include "gst/render/scan.h"
#include "gst/render/surface-private.h"

/* Film is encoded by about this power. */
#define GAMMA 2.2f
/* 1/m: nothing is farther off than this, and nothing is divided by less. */
#define LEAST_W 1e-9f
/* Pixels of a row along which the print is linear. */
#define CHUNK 16

#define PLACE CLOTH_SURFACE_PLACE_BITS

typedef struct
{
  gdouble x, y;                 /* px */
  gfloat w;                     /* 1/depth; 0 when not seen */
  gfloat normal[3];
  gfloat light;                 /* factor on encoded values, 0 to 1 */
} Vertex;

struct _ClothSurface
{
  guint n_vertices, n_triangles;
  guint32 *triangles;           /* 3 a triangle */
  gfloat *uv;                   /* 2 a vertex, pixels of the finest level */
  guint n_levels;
  ClothSurfaceLevel levels[CLOTH_PAINT_MAX_LEVELS];
  Vertex *vertices;
  const ClothSurfaceRows *rows;

  /* of the picture that is drawn; clear between pictures */
  gint width, height;
  guint32 *colours;             /* as of a level; 0: nothing there */
  gfloat *depths;               /* 1/depth, greatest nearest */
  gint *first, *last;           /* pixels touched in each row; first > last: none */
};

/* What is linear in the picture, as value at the left end of a row and slopes. */
typedef struct
{
  gdouble at_x, at_y;
  gfloat w[3], u[3], v[3], light[3];    /* value at (at_x, at_y), slopes */
  const ClothSurfaceLevel *level;
  gfloat scale;                 /* of u and v, to pixels of the level */
} Plane;

/* ---- the print ---- */

static guint8
encode (gfloat light)
{
  const gfloat v = light <= 0.0031308f ? 12.92f * light :
      1.055f * powf (light, 1 / 2.4f) - 0.055f;

  return (guint8) CLAMP (255 * v + 0.5f, 0.0f, 255.0f);
}

static void
set_level (ClothSurfaceLevel * level, const ClothPaintLevel * from,
    guint n_channels)
{
  guint32 *to;

  level->width = from->width;
  level->height = from->height;
  to = level->pixels = g_new (guint32, ((gsize) from->width + 1) *
      ((gsize) from->height + 1));
  for (gint y = 0; y <= from->height; y++)
    for (gint x = 0; x <= from->width; x++) {
      const gfloat *light = from->data + n_channels *
          ((gsize) MIN (y, from->height - 1) * (gsize) from->width +
          (gsize) MIN (x, from->width - 1));
      guint32 pixel = 0xff;

      for (guint c = 3; c-- > 0;)
        pixel = pixel << 8 | encode (light[n_channels == 3 ? c : 0]);
      *to++ = pixel;
    }
}

/* @n_vertices: vertices of the mesh
 * @uv: (array): 2 numbers a vertex, metres on the flat cloth
 * @faces: (array): 4 indices a face, the last 0xffffffff for a triangle; all others
 *   below @n_vertices
 * @n_faces: faces
 * @paint: what is printed on both sides of the cloth; copied
 * @simd: instruction set, %CLOTH_SIMD_BEST but in tests; all give the same bytes
 *
 * Returns: (transfer full): the surface
 */
ClothSurface *
cloth_surface_new (guint n_vertices, const gfloat * uv, const guint32 * faces,
    guint n_faces, const ClothPaint * paint, ClothSimd simd)
{
  ClothSurface *self = g_new0 (ClothSurface, 1);

  self->n_vertices = n_vertices;
  self->vertices = g_new (Vertex, MAX (n_vertices, 1));
  self->uv = g_new (gfloat, 2 * (gsize) n_vertices + 1);
  for (gsize i = 0; i < 2 * (gsize) n_vertices; i++)
    self->uv[i] = (gfloat) ((uv[i] - paint->origin_uv_m[i % 2])
        * paint->px_per_m[i % 2]);
  self->triangles = g_new (guint32, 6 * (gsize) n_faces + 1);
  self->n_triangles = cloth_scan_list_triangles (faces, n_faces,
      self->triangles);
  self->rows = CLOTH_SIMD_TABLE (cloth_surface_rows, simd);
  self->n_levels = paint->n_levels;
  for (guint i = 0; i < paint->n_levels; i++)
    set_level (&self->levels[i], &paint->levels[i], paint->n_channels);
  return self;
}

static void
free_picture (ClothSurface * self)
{
  g_clear_pointer (&self->colours, g_free);
  g_clear_pointer (&self->depths, g_free);
  g_clear_pointer (&self->first, g_free);
  g_clear_pointer (&self->last, g_free);
}

/* @surface: (nullable) (transfer full): a surface
 */
void
cloth_surface_free (ClothSurface * surface)
{
  if (!surface)
    return;
  free_picture (surface);
  for (guint i = 0; i < surface->n_levels; i++)
    g_free (surface->levels[i].pixels);
  g_free (surface->triangles);
  g_free (surface->uv);
  g_free (surface->vertices);
  g_free (surface);
}

static void
prepare_picture (ClothSurface * self, gint width, gint height)
{
  const gsize n = (gsize) width * (gsize) height;

  if (self->width == width && self->height == height && self->colours)
    return;
  free_picture (self);
  self->width = width;
  self->height = height;
  self->colours = g_new0 (guint32, n);
  self->depths = g_new0 (gfloat, n);
  self->first = g_new (gint, height);
  self->last = g_new (gint, height);
  for (gint y = 0; y < height; y++) {
    self->first[y] = width;
    self->last[y] = -1;
  }
}

/* ---- vertices ---- */

static void
see_vertices (ClothSurface * self, const ClothCamera * camera,
    const gfloat * positions)
{
  const gdouble sx = (gdouble) self->width / camera->width;
  const gdouble sy = (gdouble) self->height / camera->height;
  const gdouble *R = camera->R;

  for (gsize i = 0; i < self->n_vertices; i++) {
    const gfloat *p = positions + 3 * i;
    const gdouble X[3] = { p[0], p[1], p[2] };
    Vertex *v = &self->vertices[i];
    gdouble px[2], depth;

    memset (v, 0, sizeof *v);
    if (!isfinite (p[0]) || !isfinite (p[1]) || !isfinite (p[2]) ||
        !cloth_camera_project (camera, X, px, NULL, NULL))
      continue;
    /* pixel centres are whole numbers, so scaling is about (−½, −½) */
    v->x = (px[0] + 0.5) * sx - 0.5;
    v->y = (px[1] + 0.5) * sy - 0.5;
    depth = R[6] * X[0] + R[7] * X[1] + R[8] * X[2] + camera->t[2];
    if (depth > 0 && fabs (v->x) < CLOTH_SCAN_FAR_PX
        && fabs (v->y) < CLOTH_SCAN_FAR_PX)
      v->w = (gfloat) (1 / depth);
  }
}

static gboolean
is_seen (const ClothSurface * self, const guint32 * t)
{
  return self->vertices[t[0]].w > 0 && self->vertices[t[1]].w > 0 &&
      self->vertices[t[2]].w > 0;
}

/* Lambert's law on both sides alike, by the normals of the triangles around. */
static void
light_vertices (ClothSurface * self, const gfloat * positions,
    const ClothRenderStyle * style)
{
  const gfloat lamp[3] = { (gfloat) style->lamp[0], (gfloat) style->lamp[1],
    (gfloat) style->lamp[2]
  };
  const gfloat length = sqrtf (lamp[0] * lamp[0] + lamp[1] * lamp[1] +
      lamp[2] * lamp[2]);

  for (gsize i = 0; i < self->n_triangles; i++) {
    const guint32 *t = self->triangles + 3 * i;
    const gfloat *a = positions + 3 * (gsize) t[0];
    const gfloat *b = positions + 3 * (gsize) t[1];
    const gfloat *c = positions + 3 * (gsize) t[2];
    gfloat p[3], q[3];

    if (!is_seen (self, t))
      continue;
    for (guint k = 0; k < 3; k++) {
      p[k] = b[k] - a[k];
      q[k] = c[k] - a[k];
    }
    for (guint k = 0; k < 3; k++) {
      gfloat *n = self->vertices[t[k]].normal;

      n[0] += p[1] * q[2] - p[2] * q[1];
      n[1] += p[2] * q[0] - p[0] * q[2];
      n[2] += p[0] * q[1] - p[1] * q[0];
    }
  }
  for (gsize i = 0; i < self->n_vertices; i++) {
    Vertex *v = &self->vertices[i];
    const gfloat *n = v->normal;
    const gfloat norm = sqrtf (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const gfloat facing = norm > 0 && length > 0 ? fabsf (n[0] * lamp[0] +
        n[1] * lamp[1] + n[2] * lamp[2]) / (norm * length) : 0;
    const gfloat light = (gfloat) style->ambient_light +
        (gfloat) style->lamp_light * facing;

    v->light = powf (CLAMP (light, 0.0f, 1.0f), 1 / GAMMA);
  }
}

/* ---- triangles ---- */

static void
set_slopes (gfloat plane[3], const gdouble x[3], const gdouble y[3],
    gdouble area, const gdouble values[3])
{
  gdouble exact[3];

  cloth_scan_set_plane (exact, x, y, area, values);
  for (guint k = 0; k < 3; k++)
    plane[k] = (gfloat) exact[k];
}

/* The scale of the print whose pixels are as large as those of the picture. */
static guint
choose_level (const ClothSurface * self, const guint32 * t, gdouble area)
{
  const gfloat *a = self->uv + 2 * (gsize) t[0];
  const gfloat *b = self->uv + 2 * (gsize) t[1];
  const gfloat *c = self->uv + 2 * (gsize) t[2];
  const gdouble print = fabs ((gdouble) (b[0] - a[0]) * (c[1] - a[1]) -
      (gdouble) (b[1] - a[1]) * (c[0] - a[0]));
  const gdouble level = 0.5 * log2 (print / fabs (area));

  return level > 0 ? (guint) MIN (level + 0.5, self->n_levels - 1) : 0;
}

static void
set_plane (const ClothSurface * self, const guint32 * t,
    const Vertex * const *p, gdouble area, Plane * plane)
{
  const guint level = choose_level (self, t, area);
  gdouble x[3], y[3], w[3], u[3], v[3], light[3];

  for (guint k = 0; k < 3; k++) {
    x[k] = p[k]->x;
    y[k] = p[k]->y;
    light[k] = p[k]->light;
    w[k] = p[k]->w;
    u[k] = self->uv[2 * (gsize) t[k]] * w[k];
    v[k] = self->uv[2 * (gsize) t[k] + 1] * w[k];
  }
  plane->at_x = x[0];
  plane->at_y = y[0];
  set_slopes (plane->w, x, y, area, w);
  set_slopes (plane->u, x, y, area, u);
  set_slopes (plane->v, x, y, area, v);
  set_slopes (plane->light, x, y, area, light);
  plane->level = &self->levels[level];
  plane->scale = ldexpf (1, -(gint) level);
}

/* Place along one axis at a pixel, within the level: beyond the edge of the print its
 * outermost pixels go on. */
static gint32
place_at (gfloat place, gint size)
{
  return (gint32) (CLAMP (place - 0.5f, 0, (gfloat) (size - 1)) * (1 << PLACE));
}

static gint32
light_at (gfloat light)
{
  return (gint32) (CLAMP (light, 0.0f, 1.0f) * (256 << PLACE));
}

/* From the first to the last of @n pixels; less by so little that no rounding leads
 * beyond either. */
static gint32
step_of (const gint32 ends[2], gint n)
{
#define SHARE(n) ((1 - 0x1p-20f) / (n))
  static const gfloat shares[CHUNK] = { 0, SHARE (1), SHARE (2), SHARE (3),
    SHARE (4), SHARE (5), SHARE (6), SHARE (7), SHARE (8), SHARE (9),
    SHARE (10), SHARE (11), SHARE (12), SHARE (13), SHARE (14), SHARE (15)
  };
#undef SHARE

  return (gint32) ((gfloat) (ends[1] - ends[0]) * shares[n - 1]);
}

static void
fill_row (ClothSurface * self, const Plane * plane, gint y, gint begin,
    gint end)
{
  const gfloat dy = (gfloat) (y - plane->at_y);
  const gsize row = (gsize) y * (gsize) self->width;
  const ClothSurfaceLevel *level = plane->level;
  ClothSurfaceSpan span = {.w_step = plane->w[1],.level = level };

  self->first[y] = MIN (self->first[y], begin);
  self->last[y] = MAX (self->last[y], end - 1);
  for (gint x = begin; x < end; x += CHUNK) {
    gint32 u[2], v[2], light[2];

    span.n = MIN (end - x, CHUNK);
    for (guint k = 0; k < 2; k++) {
      const gfloat dx = (gfloat) (x + (k ? span.n - 1 : 0) - plane->at_x);
      const gfloat w = plane->w[0] + plane->w[1] * dx + plane->w[2] * dy;

      const gfloat over = plane->scale / MAX (w, LEAST_W);

      u[k] = place_at ((plane->u[0] + plane->u[1] * dx + plane->u[2] * dy) *
          over, level->width);
      v[k] = place_at ((plane->v[0] + plane->v[1] * dx + plane->v[2] * dy) *
          over, level->height);
      light[k] = light_at (plane->light[0] + plane->light[1] * dx +
          plane->light[2] * dy);
      if (k == 0)
        span.w = w;
    }
    span.u = u[0];
    span.v = v[0];
    span.light = light[0];
    span.u_step = step_of (u, span.n);
    span.v_step = step_of (v, span.n);
    span.light_step = step_of (light, span.n);
    self->rows->fill (&span, self->colours + row + x, self->depths + row + x);
  }
}

/* Pixels of a triangle in so many rows of the picture: not more than lie around it there, and
 * in a narrow one a chunk in each row. */
static gdouble
count_pixels (const ClothSurface * self, const Vertex * const *p, gdouble area,
    gint rows)
{
  const gdouble left = MAX (MIN (p[0]->x, MIN (p[1]->x, p[2]->x)), 0);
  const gdouble right = MIN (MAX (p[0]->x, MAX (p[1]->x, p[2]->x)),
      self->width);

  return MIN (rows * MAX (right - left, CHUNK), fabs (area) / 2 + rows * CHUNK);
}

static void
fill_triangle (ClothSurface * self, const guint32 * t, ClothWork * work)
{
  const Vertex *p[3] = { &self->vertices[t[0]], &self->vertices[t[1]],
    &self->vertices[t[2]]
  };
  const gdouble area = (p[1]->x - p[0]->x) * (p[2]->y - p[0]->y) -
      (p[1]->y - p[0]->y) * (p[2]->x - p[0]->x);
  const gdouble low = MIN (p[0]->y, MIN (p[1]->y, p[2]->y));
  const gdouble high = MAX (p[0]->y, MAX (p[1]->y, p[2]->y));
  const gint top = MAX (cloth_scan_ceiling (low), 0);
  const gint end = MIN (cloth_scan_ceiling (high), self->height);
  Plane plane;
  ClothScanEdge edges[3];

  if (!(fabs (area) > 1e-9) || top >= end
      || MAX (p[0]->x, MAX (p[1]->x, p[2]->x)) < 0
      || MIN (p[0]->x, MIN (p[1]->x, p[2]->x)) > self->width
      || !cloth_work_take (work, count_pixels (self, p, area, end - top)))
    return;
  set_plane (self, t, p, area, &plane);
  for (guint k = 0; k < 3; k++)
    cloth_scan_edge_init (&edges[k], p[k]->x, p[k]->y, p[(k + 1) % 3]->x,
        p[(k + 1) % 3]->y);
  for (gint y = top; y < end; y++) {
    gint from, to;

    cloth_scan_row (edges, y, self->width, &from, &to);
    if (from < to)
      fill_row (self, &plane, y, from, to);
  }
}

/* ---- over the picture ---- */

static gint
value_of (const gint * weights, const gint * rgb)
{
  return CLAMP ((weights[0] * rgb[0] + weights[1] * rgb[1] +
          weights[2] * rgb[2] + weights[3]) >> CLOTH_SURFACE_WEIGHT_BITS, 0,
      255);
}

/* Of a component that is subsampled in some way: the mean over the pixels that are
 * covered, by their share. */
static void
lay_coarse (const ClothSurface * self, const ClothComponent * c,
    const gint * weights, gint opacity, gint row, gint begin, gint end)
{
  const gint y0 = row << c->shift_y;
  const gint y1 = MIN (y0 + (1 << c->shift_y), self->height);

  for (gint x = begin; x < end; x++) {
    const gint x0 = x << c->shift_x;
    const gint x1 = MIN (x0 + (1 << c->shift_x), self->width);
    guint8 *to = c->data + (gssize) row * c->stride + x * c->step;
    gint rgb[3] = { 0 }, n = 0, part;

    for (gint y = y0; y < y1; y++)
      for (gint i = x0; i < x1; i++) {
        const guint32 colour = self->colours[(gsize) y *
            (gsize) self->width + (gsize) i];

        for (guint k = 0; k < 3; k++)
          rgb[k] += colour >> 8 * k & 255;
        n += (gint) (colour >> 31);
      }
    if (n == 0)
      continue;
    for (guint k = 0; k < 3; k++)
      rgb[k] /= n;
    part = opacity * n / ((x1 - x0) * (y1 - y0));
    *to = (guint8) ((*to * (256 - part) + value_of (weights, rgb) * part
            + 128) >> 8);
  }
}

/* One row of a component. */
static void
lay_row (const ClothSurface * self, const ClothComponent * c,
    const gint * weights, gint opacity, gint row)
{
  const gint y0 = row << c->shift_y;
  const gint y1 = MIN (y0 + (1 << c->shift_y), self->height);
  const guint32 *colours = self->colours + (gsize) y0 * (gsize) self->width;
  guint8 *to = c->data + (gssize) row * c->stride;
  gint first = self->width, last = -1, done;

  for (gint y = y0; y < y1; y++) {
    first = MIN (first, self->first[y]);
    last = MAX (last, self->last[y]);
  }
  if (last < first)
    return;
  first >>= c->shift_x;
  last = MIN (last >> c->shift_x, c->width - 1);
  if (c->shift_x == 0 && c->shift_y == 0) {
    self->rows->lay (colours + first, last + 1 - first, weights, opacity,
        to + first * c->step, c->step);
    return;
  }
  done = first;
  if (c->shift_x == 1 && c->shift_y == 1 && y1 - y0 == 2) {
    /* but for a last column that is half there */
    done = MIN (last + 1, self->width / 2);
    self->rows->lay_half (colours + 2 * first, colours + self->width +
        2 * first, done - first, weights, opacity, to + first * c->step,
        c->step);
  }
  lay_coarse (self, c, weights, opacity, row, done, last + 1);
}

static void
lay_component (const ClothSurface * self, const ClothComponent * c,
    gint opacity)
{
  const gint rows = (self->height + (1 << c->shift_y) - 1) >> c->shift_y;
  gint weights[4];

  for (guint k = 0; k < 4; k++)
    weights[k] = (gint) lrintf (ldexpf (k < 3 ? c->weights[k] / 255 :
            c->weights[3] + 0.5f, CLOTH_SURFACE_WEIGHT_BITS));
  for (gint row = 0; row < MIN (rows, c->height); row++)
    lay_row (self, c, weights, opacity, row);
}

static void
clear_picture (ClothSurface * self)
{
  for (gint y = 0; y < self->height; y++) {
    const gsize at = (gsize) y * (gsize) self->width + (gsize) self->first[y];
    const gint n = self->last[y] - self->first[y] + 1;

    if (n <= 0)
      continue;
    memset (self->colours + at, 0, (gsize) n * sizeof *self->colours);
    memset (self->depths + at, 0, (gsize) n * sizeof *self->depths);
    self->first[y] = self->width;
    self->last[y] = -1;
  }
}

/* @surface: the surface
 * @canvas: where to
 * @width: of the picture, px; the projection is scaled when the camera's differs
 * @height: of the picture, px
 * @camera: calibrated camera
 * @positions: 3 floats a vertex, metres, world; NaN where unknown
 * @style: its lamp and light; both sides of the cloth are lit and printed alike
 * @opacity: 0 … 1
 *
 * Draws every triangle whose three corners are known and before the camera; of several,
 * the nearest.
 */
void
cloth_surface_draw (ClothSurface * surface, const ClothCanvas * canvas,
    gint width, gint height, const ClothCamera * camera,
    const gfloat * positions, const ClothRenderStyle * style, gfloat opacity)
{
  const gint part = (gint) CLAMP (256 * opacity + 0.5f, 0, 256);

  if (width <= 0 || height <= 0 || part == 0)
    return;
  prepare_picture (surface, width, height);
  see_vertices (surface, camera, positions);
  light_vertices (surface, positions, style);
  for (gsize i = 0; i < surface->n_triangles; i++)
    if (is_seen (surface, surface->triangles + 3 * i))
      fill_triangle (surface, surface->triangles + 3 * i, canvas->work);
  for (guint i = 0; i < canvas->n_components; i++)
    lay_component (surface, &canvas->components[i], part);
  clear_picture (surface);
}
