/* Green–Lagrange strain of a mesh against the flat cloth.
 *
 * A triangle with flat edges D = (d1 d2), 2×2, and edges X = (x1 x2), 3×2, in space is
 * deformed by F = X D⁻¹, and its strain is
 *
 *   E = ½ (FᵀF − 1),  warp E_uu, weft E_vv, shear E_uv.
 *
 * E is 0 however the triangle is moved and turned. Threads that became λ times as long have
 * ½ (λ² − 1), which is λ − 1 while that is small; warp and weft at the angle ½π − γ have
 * the shear ½ sin γ when neither is stretched. Holzapfel, Nonlinear Solid Mechanics (2000),
 * section 2.5.
 *
 * Each corner of a quad makes a triangle with its two neighbours; the quad's strain is the
 * mean of the four by their flat areas, so that no diagonal is preferred. A vertex has the
 * mean of its faces by their flat areas.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/strain.h"

#include <math.h>
#include <string.h>

/* A flat triangle thinner than that, as area over its longest edge's square, has no strain
 * that means anything. */
#define LEAST_SHAPE 1e-6

/* @vertex: the corner and the ends of its two edges
 * @inverse: D⁻¹, row by row, 1/m
 * @area: on the flat cloth, m²; 0: it does not count
 */
typedef struct
{
  guint32 vertex[3];
  gdouble inverse[4];
  gdouble area;
} Corner;

struct _ClothStrains
{
  guint n_vertices, n_faces;
  guint32 *corners_of;          /* faces: 4 vertices each, as in the topology */
  guint *start;                 /* of a face's corners; n_faces + 1 */
  Corner *corners;
  gfloat *faces, *vertices;     /* 3 numbers each */
  gdouble *sums;                /* 4 a vertex: strain times area, area */
};

static Corner
measure_flat (const gfloat * uv, guint32 a, guint32 b, guint32 c)
{
  const gdouble d1[2] = { (gdouble) uv[2 * b] - uv[2 * a],
    (gdouble) uv[2 * b + 1] - uv[2 * a + 1]
  };
  const gdouble d2[2] = { (gdouble) uv[2 * c] - uv[2 * a],
    (gdouble) uv[2 * c + 1] - uv[2 * a + 1]
  };
  const gdouble det = d1[0] * d2[1] - d2[0] * d1[1];
  const gdouble longest = MAX (d1[0] * d1[0] + d1[1] * d1[1],
      d2[0] * d2[0] + d2[1] * d2[1]);
  Corner corner = {.vertex = {a, b, c} };

  if (!(fabs (det) > LEAST_SHAPE * longest))
    return corner;
  corner.inverse[0] = d2[1] / det;
  corner.inverse[1] = -d2[0] / det;
  corner.inverse[2] = -d1[1] / det;
  corner.inverse[3] = d1[0] / det;
  corner.area = fabs (det) / 2;
  return corner;
}

/* @topology: a mesh
 *
 * Returns: (transfer full) (nullable): what its strain is measured with; %NULL when it has
 *   no face whose place on the flat cloth is known
 */
ClothStrains *
cloth_strains_new (const ClothTopology * topology)
{
  ClothStrains *self = g_new0 (ClothStrains, 1);
  const gsize n_faces = topology->n_faces;
  gboolean known = FALSE;
  guint n = 0;

  self->n_vertices = topology->n_vertices;
  self->n_faces = topology->n_faces;
  self->corners_of = g_new (guint32, 4 * n_faces + 1);
  memcpy (self->corners_of, topology->faces,
      4 * n_faces * sizeof *topology->faces);
  self->start = g_new (guint, n_faces + 1);
  self->corners = g_new (Corner, 4 * n_faces + 1);
  self->faces = g_new (gfloat, CLOTH_STRAIN_SIZE * n_faces + 1);
  self->vertices = g_new (gfloat,
      CLOTH_STRAIN_SIZE * (gsize) topology->n_vertices + 1);
  self->sums = g_new (gdouble, 4 * (gsize) topology->n_vertices + 1);
  for (gsize f = 0; f < n_faces; f++) {
    const guint32 *face = topology->faces + 4 * f;
    const guint size = cloth_face_corners (face);

    self->start[f] = n;
    for (guint k = 0; k < (size == 3 ? 1 : size); k++) {
      Corner *corner = &self->corners[n++];

      *corner = measure_flat (topology->uv, face[k], face[(k + 1) % size],
          face[(k + size - 1) % size]);
      known |= corner->area > 0;
      /* the four cover the quad twice */
      if (size == 4)
        corner->area /= 2;
    }
  }
  self->start[n_faces] = n;
  if (!known)
    g_clear_pointer (&self, cloth_strains_free);
  return self;
}

/* Adds the triangle's strain times its flat area to @sum, and the area. */
static void
add_corner (const Corner * corner, const gfloat * positions, gdouble sum[4])
{
  const gfloat *p = positions + 3 * (gsize) corner->vertex[0];
  const gfloat *q = positions + 3 * (gsize) corner->vertex[1];
  const gfloat *r = positions + 3 * (gsize) corner->vertex[2];
  const gdouble *inverse = corner->inverse;
  gdouble uu = 0, vv = 0, uv = 0;

  for (guint k = 0; k < 3; k++) {
    const gdouble x1 = (gdouble) q[k] - p[k], x2 = (gdouble) r[k] - p[k];
    const gdouble fu = x1 * inverse[0] + x2 * inverse[2];
    const gdouble fv = x1 * inverse[1] + x2 * inverse[3];

    uu += fu * fu;
    vv += fv * fv;
    uv += fu * fv;
  }
  sum[CLOTH_STRAIN_WARP] += corner->area * (uu - 1) / 2;
  sum[CLOTH_STRAIN_WEFT] += corner->area * (vv - 1) / 2;
  sum[CLOTH_STRAIN_SHEAR] += corner->area * uv / 2;
  sum[3] += corner->area;
}

static void
put_mean (const gdouble sum[4], gfloat * strain)
{
  for (guint k = 0; k < CLOTH_STRAIN_SIZE; k++)
    strain[k] = sum[3] > 0 ? (gfloat) (sum[k] / sum[3]) : NAN;
}

/* @strains: what was made for the mesh
 * @positions: 3 numbers a vertex, metres; NaN when not seen
 * @states: (nullable): a #ClothVertexState a vertex; one unseen counts as NaN
 *
 * Measures a frame. What it reads and returns is valid until the next one.
 */
void
cloth_strains_measure (ClothStrains * self, const gfloat * positions,
    const guint8 * states)
{
  memset (self->sums, 0, 4 * (gsize) self->n_vertices * sizeof *self->sums);
  for (gsize f = 0; f < self->n_faces; f++) {
    const guint32 *face = self->corners_of + 4 * f;
    const guint size = cloth_face_corners (face);
    gdouble sum[4] = { 0, 0, 0, 0 };
    gboolean seen = TRUE;

    for (guint k = 0; k < size; k++) {
      const gfloat *p = positions + 3 * (gsize) face[k];

      seen = seen && isfinite (p[0]) && isfinite (p[1]) && isfinite (p[2]) &&
          (!states || states[face[k]] != CLOTH_VERTEX_UNSEEN);
    }
    for (guint c = self->start[f]; seen && c < self->start[f + 1]; c++)
      if (self->corners[c].area > 0)
        add_corner (&self->corners[c], positions, sum);
    put_mean (sum, self->faces + CLOTH_STRAIN_SIZE * f);
    for (guint k = 0; k < size; k++)
      for (guint j = 0; j < 4; j++)
        self->sums[4 * (gsize) face[k] + j] += sum[j];
  }
  for (gsize i = 0; i < self->n_vertices; i++)
    put_mean (self->sums + 4 * i, self->vertices + CLOTH_STRAIN_SIZE * i);
}

/* Returns: (array): 3 numbers a face, by #ClothStrainComponent; NaN where a corner is not
 *   seen */
const gfloat *
cloth_strains_get_faces (const ClothStrains * self)
{
  return self->faces;
}

/* Returns: (array): 3 numbers a vertex, by #ClothStrainComponent; NaN where no face of it
 *   is seen whole */
const gfloat *
cloth_strains_get_vertices (const ClothStrains * self)
{
  return self->vertices;
}

void
cloth_strains_free (ClothStrains * self)
{
  if (!self)
    return;
  g_free (self->corners_of);
  g_free (self->start);
  g_free (self->corners);
  g_free (self->faces);
  g_free (self->vertices);
  g_free (self->sums);
  g_free (self);
}
