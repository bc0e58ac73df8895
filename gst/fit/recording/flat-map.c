/* Where places of the flat cloth lie on a mesh of it.
 *
 * Model: the cloth is linear within each triangle of the mesh. A face of four corners is four
 *   triangles about its middle, so that no diagonal is preferred.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/flat-map.h"

#include <math.h>
#include <string.h>

/* Of a grid of cells over the flat cloth: faces in each, about. */
#define FACES_A_CELL 4

/* Faces of a mesh by the cells of the flat cloth that they touch. */
struct _ClothFlatMap
{
  const ClothTopology *topology;
  gdouble low[2], size[2];
  guint n_cells;                /* along u and along v */
  guint *begin, *faces;
};

/* @topology: a mesh with uv
 * @low: (out) (array fixed-size=2): least u and v, m
 * @high: (out) (array fixed-size=2): largest u and v, m
 */
void
cloth_flat_map_find_extent (const ClothTopology * t, gdouble low[2],
    gdouble high[2])
{
  for (guint k = 0; k < 2; k++) {
    low[k] = INFINITY;
    high[k] = -INFINITY;
    for (gsize v = 0; v < t->n_vertices; v++) {
      low[k] = fmin (low[k], t->uv[2 * v + k]);
      high[k] = fmax (high[k], t->uv[2 * v + k]);
    }
  }
}

static guint
cell_of (const ClothFlatMap * l, gdouble at, guint k)
{
  gdouble cell = (at - l->low[k]) / l->size[k] * l->n_cells;

  return (guint) CLAMP (cell, 0., l->n_cells - 1.);
}

/* The cells that a face touches, @slack m about it. */
static void
find_cells (const ClothFlatMap * l, guint face, gdouble slack,
    guint cells[2][2])
{
  const guint32 *corners = l->topology->faces + 4 * (gsize) face;

  for (guint k = 0; k < 2; k++) {
    gdouble low = INFINITY, high = -INFINITY;

    for (guint i = 0; i < cloth_face_corners (corners); i++) {
      low = fmin (low, l->topology->uv[2 * (gsize) corners[i] + k]);
      high = fmax (high, l->topology->uv[2 * (gsize) corners[i] + k]);
    }
    cells[k][0] = cell_of (l, low - slack, k);
    cells[k][1] = cell_of (l, high + slack, k);
  }
}

/* @topology: a mesh whose uv are places on the flat cloth, m; borrowed
 * @slack: places are found this far beside it, m
 *
 * Returns: (transfer full): where its faces lie on the flat cloth
 */
ClothFlatMap *
cloth_flat_map_new (const ClothTopology * topology, gdouble slack)
{
  ClothFlatMap *l = g_new0 (ClothFlatMap, 1);
  guint n;

  l->topology = topology;
  cloth_flat_map_find_extent (topology, l->low, l->size);
  for (guint k = 0; k < 2; k++)
    l->size[k] = fmax (l->size[k] - l->low[k], G_MINDOUBLE);
  l->n_cells = n =
      1 + (guint) sqrt ((gdouble) topology->n_faces / FACES_A_CELL);
  l->begin = g_new0 (guint, n * n + 2);
  for (guint pass = 0; pass < 2; pass++) {
    for (guint face = 0; face < topology->n_faces; face++) {
      guint cells[2][2];

      find_cells (l, face, slack, cells);
      for (guint v = cells[1][0]; v <= cells[1][1]; v++)
        for (guint u = cells[0][0]; u <= cells[0][1]; u++) {
          guint cell = v * n + u;

          if (pass)
            l->faces[l->begin[cell + 1]++] = face;
          else
            l->begin[cell + 2]++;
        }
    }
    for (guint cell = 0; cell < n * n && !pass; cell++)
      l->begin[cell + 2] += l->begin[cell + 1];
    if (!pass)
      l->faces = g_new (guint, l->begin[n * n + 1] + 1);
  }
  return l;
}

/* Barycentric weights of @at in a triangle; returns how far outside of it @at lies, m. */
static gdouble
find_barycentric (gdouble corners[3][2], const gdouble at[2],
    gdouble weights[3])
{
  gdouble outside = 0., area = 0., areas[3];

  for (guint i = 0; i < 3; i++) {
    const gdouble *a = corners[(i + 1) % 3], *b = corners[(i + 2) % 3];

    areas[i] = (a[0] - at[0]) * (b[1] - at[1]) -
        (a[1] - at[1]) * (b[0] - at[0]);
    area += areas[i];
  }
  for (guint i = 0; i < 3; i++) {
    const gdouble *a = corners[(i + 1) % 3], *b = corners[(i + 2) % 3];
    gdouble side = hypot (b[0] - a[0], b[1] - a[1]);

    weights[i] = areas[i] / area;
    /* twice the area over the side is the height above it */
    outside = fmax (outside, -weights[i] * fabs (area) / side);
  }
  return isnan (outside) ? INFINITY : outside;
}

/* Weights of a face's corners at a place. */
static void
find_weights (const ClothTopology * t, guint face, const gdouble at[2],
    ClothFlatPlace * best)
{
  const guint32 *corners = t->faces + 4 * (gsize) face;
  const guint n = cloth_face_corners (corners);
  gdouble flat[4][2], middle[2] = { 0. };

  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < 2; k++) {
      flat[i][k] = t->uv[2 * (gsize) corners[i] + k];
      middle[k] += flat[i][k] / n;
    }
  for (guint side = 0; side < (n == 4 ? 4u : 1u); side++) {
    guint next = (side + 1) % n;
    gdouble triangle[3][2], weights[3], outside, sum = 0.;
    ClothFlatPlace place = { {0}
    };

    memcpy (triangle[0], flat[side], sizeof triangle[0]);
    memcpy (triangle[1], flat[next], sizeof triangle[1]);
    memcpy (triangle[2], n == 4 ? middle : flat[2], sizeof triangle[2]);
    outside = find_barycentric (triangle, at, weights);
    if (!(outside < best->outside))
      continue;
    memcpy (place.corners, corners, n * sizeof *corners);
    for (guint i = 0; i < 3; i++)
      sum += weights[i] = fmax (weights[i], 0.);
    place.weights[side] += weights[0] / sum;
    place.weights[next] += weights[1] / sum;
    if (n == 4)
      for (guint i = 0; i < 4; i++)
        place.weights[i] += weights[2] / sum / 4.;
    else
      place.weights[2] += weights[2] / sum;
    place.outside = outside;
    *best = place;
  }
}

/* @map: a mesh on the flat cloth
 * @uv: a place there, m
 *
 * Returns: where it lies on the mesh, or the nearest there is
 */
ClothFlatPlace
cloth_flat_map_locate (const ClothFlatMap * map, const gfloat * uv)
{
  const gdouble at[2] = { uv[0], uv[1] };
  const guint cell =
      cell_of (map, at[1], 1) * map->n_cells + cell_of (map, at[0], 0);
  ClothFlatPlace best = { {0}, {0.}, INFINITY };

  for (guint i = map->begin[cell];
      i < map->begin[cell + 1] && best.outside > 0.; i++)
    find_weights (map->topology, map->faces[i], at, &best);
  return best;
}

/* @map: (nullable) (transfer full): a mesh on the flat cloth
 */
void
cloth_flat_map_free (ClothFlatMap * map)
{
  if (!map)
    return;
  g_free (map->begin);
  g_free (map->faces);
  g_free (map);
}
