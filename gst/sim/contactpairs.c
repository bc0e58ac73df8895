/* Which parts of a cloth may come near each other: the broad phase of its contact. A
 * hierarchy of boxes whose halves are fixed and whose boxes follow the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/contactpairs.h"

#include <string.h>

/* Cloth crumpled to a point would have more pairs than memory: the rest is left out. */
#define MAX_PAIRS ((gsize) 1 << 20)
/* Depth of the search: a node leaves two pairs of halves on the stack, each of these one
 * more, so twice the logarithm of 2³² faces is enough. */
#define MAX_STACK 256

void
cloth_contact_pairs_init (ClothContactPairs * pairs,
    const ClothContactMesh * mesh)
{
  memset (pairs, 0, sizeof *pairs);
  pairs->mesh = mesh;
  pairs->reach = g_new (gdouble, 6 * (gsize) mesh->n_particles);
  pairs->boxes = g_new (gdouble, 6 * (gsize) mesh->n_nodes);
}

void
cloth_contact_pairs_clear (ClothContactPairs * pairs)
{
  g_free (pairs->reach);
  g_free (pairs->boxes);
  g_free (pairs->pairs);
  g_free (pairs->limits);
}

static void
join (const gdouble * a, const gdouble * b, gdouble * both)
{
  for (guint k = 0; k < 3; k++) {
    both[k] = MIN (a[k], b[k]);
    both[3 + k] = MAX (a[3 + k], b[3 + k]);
  }
}

static gboolean
meet (const gdouble * a, const gdouble * b)
{
  return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4]
      && a[2] <= b[5] && b[2] <= a[5];
}

static void
follow (ClothContactPairs * pairs, const gdouble * from, const gdouble * to,
    gdouble reach)
{
  const ClothContactMesh *mesh = pairs->mesh;

  for (gsize i = 0; i < mesh->n_particles; i++) {
    for (gsize k = 0; k < 3; k++) {
      gdouble a = from[3 * i + k], b = to[3 * i + k];

      pairs->reach[6 * i + k] = MIN (a, b) - reach;
      pairs->reach[6 * i + 3 + k] = MAX (a, b) + reach;
    }
  }
  for (gsize i = mesh->n_nodes; i-- > 0;) {
    const ClothContactNode *node = &mesh->nodes[i];
    gdouble *box = pairs->boxes + 6 * i;

    if (node->n > 1) {
      join (pairs->boxes + 6 * (gsize) node->half[0],
          pairs->boxes + 6 * (gsize) node->half[1], box);
    } else {
      const guint32 *corner = mesh->faces[node->face].corner;

      join (pairs->reach + 6 * (gsize) corner[0],
          pairs->reach + 6 * (gsize) corner[1], box);
      join (box, pairs->reach + 6 * (gsize) corner[2], box);
    }
  }
}

/* Adds a pair. It keeps the thickness, or less where the triangles about are so small that
 * neighbours would touch. */
static void
add_pair (ClothContactPairs * pairs, const guint32 particle[4], guint n_first,
    guint owns, gdouble thickness)
{
  ClothContactPair *pair;

  if (pairs->n_pairs == MAX_PAIRS)
    return;
  if (pairs->n_pairs == pairs->n_allocated) {
    pairs->n_allocated = MAX (1024, 2 * pairs->n_allocated);
    pairs->pairs = g_renew (ClothContactPair, pairs->pairs, pairs->n_allocated);
    pairs->limits = g_renew (gdouble, pairs->limits, pairs->n_allocated);
  }
  pairs->limits[pairs->n_pairs] = 0.;
  pair = &pairs->pairs[pairs->n_pairs++];
  for (guint k = 0; k < 4; k++)
    thickness = MIN (thickness, pairs->mesh->room[particle[k]]);
  memcpy (pair->particle, particle, sizeof pair->particle);
  pair->n_first = (guint16) n_first;
  pair->owns = (guint16) owns;
  pair->thickness = thickness;
}

/* Corners that belong to one face and the other face. */
static void
add_corners (ClothContactPairs * pairs, const ClothContactFace * a,
    const ClothContactFace * b, const gdouble * box, gdouble thickness)
{
  for (guint k = 0; k < 3; k++) {
    guint32 p = a->corner[k];
    guint32 particle[4] = { p, b->corner[0], b->corner[1], b->corner[2] };

    if (!(a->owns >> k & 1) || p == particle[1] || p == particle[2]
        || p == particle[3] || !meet (pairs->reach + 6 * (gsize) p, box))
      continue;
    if (!(cloth_contact_mesh_corner_rest (pairs->mesh, a, k, b) < thickness))
      add_pair (pairs, particle, 1, b->owns, thickness);
  }
}

static void
add_edges (ClothContactPairs * pairs, const ClothContactFace * a,
    const ClothContactFace * b, const gdouble * box, gdouble thickness)
{
  for (guint i = 0; i < 3; i++) {
    guint32 p = a->corner[i], q = a->corner[(i + 1) % 3];
    gdouble edge[6];

    if (!(a->owns >> (3 + i) & 1))
      continue;
    join (pairs->reach + 6 * (gsize) p, pairs->reach + 6 * (gsize) q, edge);
    if (!meet (edge, box))
      continue;
    for (guint j = 0; j < 3; j++) {
      guint32 r = b->corner[j], s = b->corner[(j + 1) % 3];
      guint32 particle[4] = { p, q, r, s };
      gdouble other[6];

      if (!(b->owns >> (3 + j) & 1) || p == r || p == s || q == r || q == s)
        continue;
      join (pairs->reach + 6 * (gsize) r, pairs->reach + 6 * (gsize) s, other);
      if (meet (edge, other)
          && !(cloth_contact_mesh_edge_rest (pairs->mesh, a, i, b, j) <
              thickness))
        add_pair (pairs, particle, 2, 0, thickness);
    }
  }
}

/* @from: where the particles start
 * @to: where they go, on straight lines
 * @thickness: to be kept, m
 * @margin: m
 *
 * Makes the list of all pairs that come nearer than @thickness and @margin, and a few
 * that don't. Pairs that share a particle are never among them, nor those nearer than
 * @thickness on the flat cloth.
 */
void
cloth_contact_pairs_find (ClothContactPairs * pairs, const gdouble * from,
    const gdouble * to, gdouble thickness, gdouble margin)
{
  const ClothContactMesh *mesh = pairs->mesh;
  guint32 stack[MAX_STACK][2];
  guint depth = 1;

  pairs->n_pairs = 0;
  follow (pairs, from, to, 0.5 * (thickness + margin));
  stack[0][0] = stack[0][1] = 0;
  while (depth > 0) {
    guint32 a = stack[--depth][0], b = stack[depth][1];
    const ClothContactNode *p = &mesh->nodes[a], *q = &mesh->nodes[b];

    if (a == b) {
      if (p->n == 1)
        continue;
      for (guint k = 0; k < 3; k++, depth++) {
        stack[depth][0] = p->half[k == 2];
        stack[depth][1] = p->half[k > 0];
      }
      continue;
    }
    if (!meet (pairs->boxes + 6 * (gsize) a, pairs->boxes + 6 * (gsize) b))
      continue;
    if (p->n > 1 || q->n > 1) {
      gboolean first = p->n >= q->n;

      for (guint k = 0; k < 2; k++, depth++) {
        stack[depth][0] = first ? p->half[k] : a;
        stack[depth][1] = first ? b : q->half[k];
      }
      continue;
    }
    add_corners (pairs, &mesh->faces[p->face], &mesh->faces[q->face],
        pairs->boxes + 6 * (gsize) b, thickness);
    add_corners (pairs, &mesh->faces[q->face], &mesh->faces[p->face],
        pairs->boxes + 6 * (gsize) a, thickness);
    add_edges (pairs, &mesh->faces[p->face], &mesh->faces[q->face],
        pairs->boxes + 6 * (gsize) b, thickness);
  }
}
