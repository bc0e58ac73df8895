/* Cuts every face of a mesh into n × n: bilinear quads, flat triangles.
 *
 * Points on an edge are shared by the faces on both sides of it, to the bit: no gap
 * opens between them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/render-private.h"

#include <string.h>

/* The absent fourth vertex of a triangle, as in mesh streams. */
#define NO_VERTEX 0xffffffffu

typedef struct
{
  ClothRenderMesh *mesh;
  guint n;
  guint n_vertices;
  GHashTable *edges;            /* low·2³² + high → its first point */
} Builder;

static guint
add_point (Builder * b, guint n_parents, const guint * parents,
    const gdouble * weights)
{
  ClothRenderMesh *mesh = b->mesh;
  const guint at = mesh->n_points++;

  mesh->n_parents[at] = (guint8) n_parents;
  memcpy (mesh->parents[at], parents, n_parents * sizeof *parents);
  memcpy (mesh->weights[at], weights, n_parents * sizeof *weights);
  return at;
}

/* Point i of n from vertex @from to vertex @to. */
static guint
edge_point (Builder * b, guint from, guint to, guint i)
{
  const guint low = MIN (from, to), high = MAX (from, to);
  const guint64 key = (guint64) low << 32 | high;
  gpointer known;
  guint first;

  if (i == 0 || i == b->n)
    return i == 0 ? from : to;
  if (g_hash_table_lookup_extended (b->edges, &key, NULL, &known)) {
    first = GPOINTER_TO_UINT (known);
  } else {
    guint64 *kept = g_new (guint64, 1);

    *kept = key;
    first = b->mesh->n_points;
    for (guint k = 1; k < b->n; k++) {
      const guint parents[2] = { low, high };
      const gdouble share = (gdouble) k / b->n;
      const gdouble weights[2] = { 1 - share, share };

      add_point (b, 2, parents, weights);
    }
    g_hash_table_insert (b->edges, kept, GUINT_TO_POINTER (first));
  }
  return first + (from == low ? i : b->n - i) - 1;
}

static void
add_triangle (Builder * b, guint p, guint q, guint r)
{
  guint *to = b->mesh->triangles[b->mesh->n_triangles++];

  to[0] = p;
  to[1] = q;
  to[2] = r;
}

static guint
quad_point (Builder * b, const guint32 * f, guint i, guint j)
{
  const gdouble s = (gdouble) i / b->n, t = (gdouble) j / b->n;
  const gdouble weights[4] =
      { (1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t };

  if (j == 0)
    return edge_point (b, f[0], f[1], i);
  if (j == b->n)
    return edge_point (b, f[3], f[2], i);
  if (i == 0)
    return edge_point (b, f[0], f[3], j);
  if (i == b->n)
    return edge_point (b, f[1], f[2], j);
  return add_point (b, 4, f, weights);
}

static guint
triangle_point (Builder * b, const guint32 * f, guint i, guint j)
{
  const gdouble s = (gdouble) i / b->n, t = (gdouble) j / b->n;
  const gdouble weights[3] = { 1 - s - t, s, t };

  if (j == 0)
    return edge_point (b, f[0], f[1], i);
  if (i == 0)
    return edge_point (b, f[0], f[2], j);
  if (i + j == b->n)
    return edge_point (b, f[1], f[2], j);
  return add_point (b, 3, f, weights);
}

static void
cut_face (Builder * b, const guint32 * f, guint * rows)
{
  const gboolean quad = f[3] != NO_VERTEX;
  guint *above = rows, *now = rows + b->n + 1;

  for (guint j = 0; j <= b->n; j++) {
    const guint across = quad ? b->n : b->n - j;

    for (guint i = 0; i <= across; i++)
      now[i] = quad ? quad_point (b, f, i, j) : triangle_point (b, f, i, j);
    for (guint i = 0; i < (quad ? across : across + 1) && j > 0; i++) {
      add_triangle (b, above[i], above[i + 1], now[i]);
      if (quad || i < across)
        add_triangle (b, above[i + 1], now[i + 1], now[i]);
    }
    memcpy (above, now, (b->n + 1) * sizeof *now);
  }
}

static void
fill_uv (ClothRenderMesh * mesh, const gfloat * uv)
{
  for (guint p = 0; p < mesh->n_points; p++) {
    for (gint k = 0; k < 2; k++) {
      gdouble sum = 0;

      for (guint i = 0; i < mesh->n_parents[p]; i++)
        sum += mesh->weights[p][i] * uv[2 * (gsize) mesh->parents[p][i]
            + (gsize) k];
      mesh->uv[p][k] = (gfloat) sum;
    }
  }
}

ClothRenderMesh *
cloth_render_mesh_new (guint n_vertices, const gfloat * uv,
    const guint32 * faces, guint n_faces, guint n)
{
  ClothRenderMesh *mesh = g_new0 (ClothRenderMesh, 1);
  Builder b = { mesh, n, n_vertices,
    g_hash_table_new_full (g_int64_hash, g_int64_equal, g_free, NULL)
  };
  /* No face has more than four edges of its own and (n − 1)² points inside. */
  const gsize most = n_vertices + (gsize) n_faces * (4 * (n - 1)
      + (n - 1) * (n - 1));
  g_autofree guint *rows = g_new (guint, 2 * (n + 1));
  const gdouble one = 1;

  mesh->n_parents = g_new (guint8, most);
  mesh->parents = g_malloc_n (most, sizeof *mesh->parents);
  mesh->weights = g_malloc_n (most, sizeof *mesh->weights);
  mesh->triangles = g_malloc_n ((gsize) n_faces * 2 * n * n,
      sizeof *mesh->triangles);
  for (guint i = 0; i < n_vertices; i++)
    add_point (&b, 1, &i, &one);
  for (guint i = 0; i < n_faces; i++)
    cut_face (&b, faces + 4 * (gsize) i, rows);
  mesh->uv = g_malloc_n (mesh->n_points, sizeof *mesh->uv);
  fill_uv (mesh, uv);
  g_hash_table_unref (b.edges);
  return mesh;
}

void
cloth_render_mesh_free (ClothRenderMesh * mesh)
{
  if (!mesh)
    return;
  g_free (mesh->n_parents);
  g_free (mesh->parents);
  g_free (mesh->weights);
  g_free (mesh->uv);
  g_free (mesh->triangles);
  g_free (mesh);
}
