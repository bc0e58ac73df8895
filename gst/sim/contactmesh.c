/* A cloth's faces, edges and corners as its contact with itself needs them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/contactmesh.h"

#include <math.h>
#include <stdlib.h>

#include "gst/mesh/side.h"
#include "gst/sim/nearest.h"

typedef struct
{
  const ClothContactFace *faces;
  guint axis;                   /* 0: u, 1: v, 2: panel */
} Order;

static void
find_owners (ClothContactMesh * mesh)
{
  guint n = 3 * mesh->n_faces;
  g_autofree ClothSide *sides = g_new (ClothSide, n + 1);
  g_autofree gboolean *owned = g_new0 (gboolean, mesh->n_particles + 1);

  for (guint i = 0; i < mesh->n_faces; i++) {
    ClothContactFace *face = &mesh->faces[i];

    for (guint k = 0; k < 3; k++) {
      guint32 a = face->corner[k], b = face->corner[(k + 1) % 3];

      sides[3 * i + k] = cloth_side (a, b, i, k);
      if (!owned[a])
        face->owns |= 1u << k;
      owned[a] = TRUE;
    }
  }
  qsort (sides, n, sizeof *sides, cloth_side_compare);
  for (guint i = 0; i < n; i++)
    if (i == 0 || !cloth_side_same_edge (&sides[i], &sides[i - 1]))
      mesh->faces[sides[i].face].owns |= 8u << sides[i].number;
}

static guint32
root (guint32 * parent, guint32 i)
{
  while (parent[i] != i)
    i = parent[i] = parent[parent[i]];
  return i;
}

static void
find_panels (ClothContactMesh * mesh, const ClothBody * body)
{
  g_autofree guint32 *parent = g_new (guint32, body->n_vertices + 1);

  for (guint32 i = 0; i < body->n_vertices; i++)
    parent[i] = i;
  for (guint i = 0; i < mesh->n_faces; i++) {
    const guint32 *vertex = body->triangles[i].vertex;

    for (guint k = 1; k < 3; k++) {
      guint32 a = root (parent, vertex[0]), b = root (parent, vertex[k]);

      parent[MAX (a, b)] = MIN (a, b);
    }
  }
  for (guint i = 0; i < mesh->n_faces; i++)
    mesh->faces[i].panel = root (parent, body->triangles[i].vertex[0]);
}

static void
measure (ClothContactMesh * mesh)
{
  gdouble sum = 0.;

  for (guint i = 0; i < mesh->n_particles; i++)
    mesh->room[i] = G_MAXDOUBLE;
  for (guint i = 0; i < mesh->n_faces; i++) {
    const ClothContactFace *face = &mesh->faces[i];
    gdouble longest = 0., area, e[2][2];

    for (guint k = 0; k < 3; k++) {
      const gdouble *a = face->uv[k], *b = face->uv[(k + 1) % 3];
      gdouble length = hypot (b[0] - a[0], b[1] - a[1]);

      longest = MAX (longest, length);
      sum += length;
    }
    for (guint k = 0; k < 2; k++)
      for (guint c = 0; c < 2; c++)
        e[k][c] = face->uv[k + 1][c] - face->uv[0][c];
    area = 0.5 * fabs (e[0][0] * e[1][1] - e[0][1] * e[1][0]);
    mesh->longest = MAX (mesh->longest, longest);
    for (guint k = 0; k < 3; k++) {
      gdouble *room = &mesh->room[face->corner[k]];

      *room = MIN (*room, area / longest);
    }
  }
  mesh->edge = sum / (3. * mesh->n_faces);
}

static gdouble
middle (const ClothContactFace * face, guint axis)
{
  if (axis == 2)
    return face->panel;
  return face->uv[0][axis] + face->uv[1][axis] + face->uv[2][axis];
}

static gint
compare_middles (gconstpointer a, gconstpointer b, gpointer data)
{
  const Order *order = data;
  guint32 i = *(const guint32 *) a, j = *(const guint32 *) b;
  gdouble x = middle (&order->faces[i], order->axis);
  gdouble y = middle (&order->faces[j], order->axis);

  if (x != y)
    return x < y ? -1 : 1;
  return i < j ? -1 : i > j;
}

/* Halves the faces by their places on the flat cloth, panels first. Neighbours there stay
 * neighbours, so the halves are compact however the cloth lies. */
static guint32
build (ClothContactMesh * mesh, guint32 * faces, guint n)
{
  guint32 index = mesh->n_nodes++;
  gdouble low[3], high[3];
  Order order = { mesh->faces, 0 };

  mesh->nodes[index].n = n;
  mesh->nodes[index].face = faces[0];
  if (n == 1)
    return index;
  for (guint k = 0; k < 3; k++) {
    low[k] = high[k] = middle (&mesh->faces[faces[0]], k);
    for (guint i = 1; i < n; i++) {
      gdouble x = middle (&mesh->faces[faces[i]], k);

      low[k] = MIN (low[k], x);
      high[k] = MAX (high[k], x);
    }
  }
  order.axis = high[2] > low[2] ? 2 : high[1] - low[1] > high[0] - low[0];
  g_qsort_with_data (faces, (gint) n, sizeof *faces, compare_middles, &order);
  for (guint k = 0; k < 2; k++) {
    guint32 half = build (mesh, k ? faces + n / 2 : faces, k ? n - n / 2 :
        n / 2);

    mesh->nodes[index].half[k] = half;
  }
  return index;
}

/* @body: a body, not needed afterwards
 *
 * Returns: (transfer full): what all models of @body share
 */
ClothContactMesh *
cloth_contact_mesh_new (const ClothBody * body)
{
  ClothContactMesh *mesh = g_new0 (ClothContactMesh, 1);
  g_autofree guint32 *faces = g_new (guint32, body->n_triangles + 1);

  mesh->n_particles = body->n_particles;
  mesh->n_faces = body->n_triangles;
  mesh->faces = g_new0 (ClothContactFace, mesh->n_faces + 1);
  mesh->nodes = g_new0 (ClothContactNode, 2 * (gsize) mesh->n_faces + 1);
  mesh->room = g_new (gdouble, mesh->n_particles + 1);
  for (guint i = 0; i < mesh->n_faces; i++) {
    faces[i] = i;
    for (guint k = 0; k < 3; k++) {
      const gdouble *uv = body->uv + 2 * (gsize) body->triangles[i].vertex[k];

      mesh->faces[i].corner[k] = body->triangles[i].particle[k];
      mesh->faces[i].uv[k][0] = uv[0];
      mesh->faces[i].uv[k][1] = uv[1];
    }
  }
  find_owners (mesh);
  find_panels (mesh, body);
  measure (mesh);
  build (mesh, faces, mesh->n_faces);
  return mesh;
}

/* @mesh: (nullable) (transfer full): a mesh
 */
void
cloth_contact_mesh_free (ClothContactMesh * mesh)
{
  if (!mesh)
    return;
  g_free (mesh->faces);
  g_free (mesh->nodes);
  g_free (mesh->room);
  g_free (mesh);
}

/* A bound that is quickly found: great when they are far from each other or on panels of
 * their own, whose uv mean nothing to each other. */
static gboolean
are_far (const ClothContactMesh * mesh, const ClothContactFace * a,
    const ClothContactFace * b)
{
  gdouble far = 3. * mesh->longest;

  return a->panel != b->panel || fabs (a->uv[0][0] - b->uv[0][0]) > far
      || fabs (a->uv[0][1] - b->uv[0][1]) > far;
}

static gdouble
distance (const gdouble a[3], const gdouble b[3])
{
  return hypot (a[0] - b[0], a[1] - b[1]);
}

/* @of: a face, and one of its corners
 * @to: another face
 *
 * Returns: the distance of the corner from @to on the flat cloth, m; any great number
 *   when it is more than the longest edge, or when nothing but seams joins them
 */
gdouble
cloth_contact_mesh_corner_rest (const ClothContactMesh * mesh,
    const ClothContactFace * of, guint corner, const ClothContactFace * to)
{
  gdouble weights[3], point[3] = { 0., 0., 0. };

  if (are_far (mesh, of, to))
    return G_MAXDOUBLE;
  cloth_nearest_on_triangle (to->uv[0], to->uv[1], to->uv[2], of->uv[corner],
      weights);
  for (guint k = 0; k < 3; k++)
    for (guint c = 0; c < 2; c++)
      point[c] += weights[k] * to->uv[k][c];
  return distance (point, of->uv[corner]);
}

static gdouble
end_to_edge (const gdouble point[3], const gdouble a[3], const gdouble b[3])
{
  gdouble along[2] = { b[0] - a[0], b[1] - a[1] };
  gdouble s = ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) /
      (along[0] * along[0] + along[1] * along[1]);

  s = CLAMP (s, 0., 1.);
  return hypot (a[0] + s * along[0] - point[0], a[1] + s * along[1] - point[1]);
}

/* @of: a face, and one of its edges
 * @to: another face, and one of its edges
 *
 * Returns: their distance, as cloth_contact_mesh_corner_rest ()
 */
gdouble
cloth_contact_mesh_edge_rest (const ClothContactMesh * mesh,
    const ClothContactFace * of, guint edge, const ClothContactFace * to,
    guint other)
{
  const gdouble *a[2] = { of->uv[edge], of->uv[(edge + 1) % 3] };
  const gdouble *b[2] = { to->uv[other], to->uv[(other + 1) % 3] };
  gdouble least = G_MAXDOUBLE;

  if (are_far (mesh, of, to))
    return G_MAXDOUBLE;
  /* edges of one panel do not cross on the flat cloth */
  for (guint k = 0; k < 2; k++) {
    least = MIN (least, end_to_edge (a[k], b[0], b[1]));
    least = MIN (least, end_to_edge (b[k], a[0], a[1]));
  }
  return least;
}
