/* A mesh drawn into a camera's picture as lines.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/wireframe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The depth test works on a picture this many times smaller: it has to tell one layer
 * of cloth from the next, not to follow an outline. */
#define DEPTH_SCALE 4

typedef struct
{
  gfloat x, y, z;               /* px, px, metres in front of the camera */
  gboolean visible;
} Projected;

struct _ClothWireframe
{
  guint n_vertices;
  guint n_edges, n_triangles, n_faces;
  guint32 *edges;               /* 2 an edge, each edge once */
  guint32 *triangles;           /* 3 a triangle */
  guint32 *faces;               /* 4 a face */
  Projected *points;
  gfloat *depth;
  gsize depth_allocated;
};

static int
compare_edges (const void *a, const void *b)
{
  guint64 x = *(const guint64 *) a, y = *(const guint64 *) b;

  return x < y ? -1 : x > y;
}

static guint64
edge_key (guint32 a, guint32 b)
{
  return (guint64) MIN (a, b) << 32 | MAX (a, b);
}

/* @n_vertices: vertices
 * @columns: of the grid of vertices; 0 without one
 * @rows: of the grid of vertices; 0 without one
 * @faces: (nullable): 4 vertex indices a face, the last one 0xffffffff for a triangle
 * @n_faces: faces; 0: take the cells of the grid
 *
 * Faces that name a vertex out of range are left out.
 *
 * Returns: (transfer full): the wireframe
 */
ClothWireframe *
cloth_wireframe_new (guint n_vertices, guint columns, guint rows,
    const guint32 * faces, guint n_faces)
{
  ClothWireframe *wire = g_new0 (ClothWireframe, 1);
  g_autofree guint32 *cells = NULL;
  g_autofree guint64 *keys = NULL;
  guint i, n_keys = 0;

  wire->n_vertices = n_vertices;
  wire->points = g_new (Projected, MAX (n_vertices, 1));
  if (n_faces == 0 && columns > 1 && rows > 1
      && (guint64) columns * rows == n_vertices) {
    n_faces = (columns - 1) * (rows - 1);
    cells = g_new (guint32, 4 * (gsize) n_faces);
    for (i = 0; i < n_faces; i++) {
      guint32 v = i / (columns - 1) * columns + i % (columns - 1);

      cells[4 * i] = v;
      cells[4 * i + 1] = v + 1;
      cells[4 * i + 2] = v + columns + 1;
      cells[4 * i + 3] = v + columns;
    }
    faces = cells;
  }

  keys = g_new (guint64, 4 * (gsize) n_faces + 1);
  wire->triangles = g_new (guint32, 6 * (gsize) n_faces + 1);
  wire->faces = g_new (guint32, 4 * (gsize) n_faces + 1);
  for (i = 0; i < n_faces; i++) {
    const guint32 *f = &faces[4 * (gsize) i];
    guint k, n = f[3] == G_MAXUINT32 ? 3 : 4;
    gboolean in_range = TRUE;

    for (k = 0; k < n; k++) {
      in_range &= f[k] < n_vertices;
    }
    if (!in_range) {
      continue;
    }
    memcpy (wire->faces + 4 * (gsize) wire->n_faces++, f, 4 * sizeof *f);
    for (k = 0; k < n; k++) {
      keys[n_keys++] = edge_key (f[k], f[(k + 1) % n]);
    }
    for (k = 0; k + 2 < n; k++) {
      guint32 *t = &wire->triangles[3 * (gsize) wire->n_triangles++];

      t[0] = f[0];
      t[1] = f[k + 1];
      t[2] = f[k + 2];
    }
  }
  qsort (keys, n_keys, sizeof (guint64), compare_edges);
  wire->edges = g_new (guint32, 2 * (gsize) n_keys + 1);
  for (i = 0; i < n_keys; i++) {
    if (i > 0 && keys[i] == keys[i - 1]) {
      continue;
    }
    wire->edges[2 * (gsize) wire->n_edges] = (guint32) (keys[i] >> 32);
    wire->edges[2 * (gsize) wire->n_edges + 1] = (guint32) keys[i];
    wire->n_edges++;
  }
  return wire;
}

/* @wire: (nullable) (transfer full): the wireframe
 */
void
cloth_wireframe_free (ClothWireframe * wire)
{
  if (!wire) {
    return;
  }
  g_free (wire->edges);
  g_free (wire->triangles);
  g_free (wire->faces);
  g_free (wire->points);
  g_free (wire->depth);
  g_free (wire);
}

/* @wire: the wireframe
 *
 * Returns: edges, each counted once
 */
guint
cloth_wireframe_get_n_edges (const ClothWireframe * wire)
{
  return wire->n_edges;
}

static void
project (ClothWireframe * wire, gint width, gint height,
    const ClothCamera * camera, const gfloat * positions)
{
  const gdouble *R = camera->R;
  gdouble sx = (gdouble) width / camera->width;
  gdouble sy = (gdouble) height / camera->height;
  guint i;

  for (i = 0; i < wire->n_vertices; i++) {
    const gfloat *p = &positions[3 * (gsize) i];
    gdouble X[3] = { p[0], p[1], p[2] }, px[2];
    Projected *out = &wire->points[i];

    out->visible = isfinite (p[0]) && isfinite (p[1]) && isfinite (p[2])
        && cloth_camera_project (camera, X, px, NULL, NULL);
    if (!out->visible) {
      continue;
    }
    /* pixel centres are whole numbers, so scaling is about (−½, −½) */
    out->x = (gfloat) ((px[0] + 0.5) * sx - 0.5);
    out->y = (gfloat) ((px[1] + 0.5) * sy - 0.5);
    out->z = (gfloat) (R[6] * X[0] + R[7] * X[1] + R[8] * X[2] + camera->t[2]);
    out->visible = isfinite (out->x) && isfinite (out->y);
  }
}

/* Nearest depth of the faces, one value for DEPTH_SCALE² pixels. */
static void
draw_depth (ClothWireframe * wire, gint columns, gint rows, ClothWork * work)
{
  gsize n = (gsize) columns * (gsize) rows, i;
  guint t;

  if (n > wire->depth_allocated) {
    g_free (wire->depth);
    wire->depth = g_new (gfloat, n);
    wire->depth_allocated = n;
  }
  for (i = 0; i < n; i++) {
    wire->depth[i] = INFINITY;
  }
  for (t = 0; t < wire->n_triangles; t++) {
    const guint32 *v = &wire->triangles[3 * (gsize) t];
    const Projected *a = &wire->points[v[0]], *b = &wire->points[v[1]];
    const Projected *c = &wire->points[v[2]];
    gfloat abx, aby, acx, acy, area;
    gint x, y, x0, x1, y0, y1;

    if (!a->visible || !b->visible || !c->visible) {
      continue;
    }
    abx = b->x - a->x;
    aby = b->y - a->y;
    acx = c->x - a->x;
    acy = c->y - a->y;
    area = abx * acy - aby * acx;
    if (!(fabsf (area) > 1e-6f)) {
      continue;
    }
    x0 = (gint) CLAMP (MIN (a->x, MIN (b->x, c->x)) / DEPTH_SCALE, 0, 32767);
    y0 = (gint) CLAMP (MIN (a->y, MIN (b->y, c->y)) / DEPTH_SCALE, 0, 32767);
    x1 = (gint) CLAMP (MAX (a->x, MAX (b->x, c->x)) / DEPTH_SCALE, -1, 32767);
    y1 = (gint) CLAMP (MAX (a->y, MAX (b->y, c->y)) / DEPTH_SCALE, -1, 32767);
    x1 = MIN (x1, columns - 1);
    y1 = MIN (y1, rows - 1);
    if (x0 > x1 || y0 > y1) {
      continue;
    }
    if (!cloth_work_take (work, (gdouble) (x1 - x0 + 1) * (y1 - y0 + 1))) {
      return;
    }
    for (y = y0; y <= y1; y++) {
      gfloat *row = wire->depth + (gsize) y * (gsize) columns;
      gfloat qy = ((gfloat) y + 0.5f) * DEPTH_SCALE - a->y;

      for (x = x0; x <= x1; x++) {
        gfloat qx = ((gfloat) x + 0.5f) * DEPTH_SCALE - a->x;
        gfloat u = (qx * acy - qy * acx) / area;
        gfloat w = (qy * abx - qx * aby) / area;

        if (u >= 0 && w >= 0 && u + w <= 1) {
          gfloat z = a->z + u * (b->z - a->z) + w * (c->z - a->z);

          row[x] = MIN (row[x], z);
        }
      }
    }
  }
}

/* Whether something is in front of the point by more than @slack metres. */
static gboolean
is_hidden (const ClothWireframe * wire, gint columns, gint rows, gfloat x,
    gfloat y, gfloat z, gfloat slack)
{
  gint i, j;

  /* also keeps the conversions in range */
  if (!(x >= 0 && y >= 0 && x < (gfloat) columns * DEPTH_SCALE
          && y < (gfloat) rows * DEPTH_SCALE)) {
    return FALSE;
  }
  i = (gint) (x / DEPTH_SCALE);
  j = (gint) (y / DEPTH_SCALE);
  return wire->depth[(gsize) j * (gsize) columns + (gsize) i] < z - slack;
}

static void
fill_face (const ClothWireframe * wire, const ClothCanvas * canvas,
    gint columns, gint rows, const guint32 * face, const gfloat * positions,
    const guint8 * states, const ClothWireStyle * style)
{
  guint k, n = face[3] == G_MAXUINT32 ? 3 : 4;
  ClothColour colour = { 0, 0, 0, 0 };
  gfloat x[4], y[4], centre[3] = { 0 }, slack = 0, share = 1 / (gfloat) n;

  for (k = 0; k < n; k++) {
    const Projected *p = &wire->points[face[k]];
    const ClothColour *one =
        &style->colours[MIN (states[face[k]], style->n_colours - 1)];

    if (!p->visible) {
      return;
    }
    x[k] = p->x;
    y[k] = p->y;
    centre[0] += share * p->x;
    centre[1] += share * p->y;
    centre[2] += share * p->z;
    colour.r += share * one->r;
    colour.g += share * one->g;
    colour.b += share * one->b;
    colour.a += share * one->a;
  }
  for (k = 0; k < 3; k++) {
    gfloat d = positions[3 * (gsize) face[0] + k] -
        positions[3 * (gsize) face[2] + k];

    slack += d * d;
  }
  if (is_hidden (wire, columns, rows, centre[0], centre[1], centre[2],
          sqrtf (slack))) {
    return;
  }
  colour.a *= style->fill_opacity;
  if (n == 4) {
    cloth_draw_quad (canvas, x, y, &colour);
    return;
  }
  /* three quads about the centre make a triangle */
  for (k = 0; k < 3; k++) {
    guint l = (k + 1) % 3, m = (k + 2) % 3;
    const gfloat qx[4] = { x[k], 0.5f * (x[k] + x[l]), centre[0],
      0.5f * (x[k] + x[m])
    };
    const gfloat qy[4] = { y[k], 0.5f * (y[k] + y[l]), centre[1],
      0.5f * (y[k] + y[m])
    };

    cloth_draw_quad (canvas, qx, qy, &colour);
  }
}

/* @wire: the wireframe
 * @canvas: where to
 * @width: of the picture, px; the projection is scaled when the camera's differs
 * @height: of the picture, px
 * @camera: calibrated camera
 * @positions: 3 floats a vertex, metres, world; NaN where unknown
 * @states: one state a vertex
 * @style: how to draw
 *
 * Draws every edge whose two ends are known, each half in the colour of its end's
 * state. Halves that lie behind a face by more than the edge's own length are drawn
 * with the hidden opacity. Long edges stay straight: the lens bends their ends only.
 * Faces are filled first, when the style has an opacity for them.
 */
void
cloth_wireframe_draw (ClothWireframe * wire, const ClothCanvas * canvas,
    gint width, gint height, const ClothCamera * camera,
    const gfloat * positions, const guint8 * states,
    const ClothWireStyle * style)
{
  gint columns = (width + DEPTH_SCALE - 1) / DEPTH_SCALE;
  gint rows = (height + DEPTH_SCALE - 1) / DEPTH_SCALE;
  guint i;

  project (wire, width, height, camera, positions);
  draw_depth (wire, columns, rows, canvas->work);
  for (i = 0; style->fill_opacity > 0 && i < wire->n_faces; i++) {
    fill_face (wire, canvas, columns, rows, wire->faces + 4 * (gsize) i,
        positions, states, style);
  }
  for (i = 0; i < wire->n_edges; i++) {
    guint32 v[2] =
        { wire->edges[2 * (gsize) i], wire->edges[2 * (gsize) i + 1] };
    const Projected *a = &wire->points[v[0]], *b = &wire->points[v[1]];
    const gfloat *p = &positions[3 * (gsize) v[0]];
    const gfloat *q = &positions[3 * (gsize) v[1]];
    ClothColour colour[2];
    gfloat slack, mx, my;
    gint k;

    if (!a->visible || !b->visible) {
      continue;
    }
    slack = sqrtf ((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] -
            q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
    for (k = 0; k < 2; k++) {
      const Projected *end = k ? b : a, *other = k ? a : b;

      colour[k] = style->colours[MIN (states[v[k]], style->n_colours - 1)];
      colour[k].a *= style->opacity;
      if (is_hidden (wire, columns, rows, 0.75f * end->x + 0.25f * other->x,
              0.75f * end->y + 0.25f * other->y,
              0.75f * end->z + 0.25f * other->z, slack)) {
        colour[k].a *= style->hidden_opacity;
      }
    }
    if (memcmp (&colour[0], &colour[1], sizeof (ClothColour)) == 0) {
      cloth_draw_line (canvas, a->x, a->y, b->x, b->y, style->width, colour);
      continue;
    }
    mx = 0.5f * (a->x + b->x);
    my = 0.5f * (a->y + b->y);
    cloth_draw_line (canvas, a->x, a->y, mx, my, style->width, &colour[0]);
    cloth_draw_line (canvas, b->x, b->y, mx, my, style->width, &colour[1]);
  }
}
