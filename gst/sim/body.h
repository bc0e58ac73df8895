/* The body of a simulation: what the lanes share of a scene, worked out once.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/bvh.h"

G_BEGIN_DECLS

/* A triangle of the membrane: corners 0, 1, 2, where (u, v) = gradient · barycentric:
 * ∂x/∂u = g[0] e1 + g[2] e2, ∂x/∂v = g[1] e1 + g[3] e2 with e1, e2 from corner 0. Of a
 * right-angled one corner 0 is the right angle, 1 lies along u and 2 along v, so
 * g[1] = g[2] = 0. */
typedef struct
{
  guint32 particle[3];
  guint32 vertex[3];
  gdouble g[4];
  gdouble area;
} ClothBodyTriangle;

#define CLOTH_HINGE_CORNERS 13

/* A linear measure y = Σ c x of a fold; its energy is
 * ½ (B_warp·warp + B_weft·weft) |y|². On a grid: three particles in a row (the middle one
 * first, the last c is 0), or the four of a cell, which measure its twist. On other
 * meshes: a curvature of a triangle; its corners are particles 0, 1, 2 and once more
 * 0 (with c = 0), then come those of the triangles about. */
typedef struct
{
  guint n;
  guint32 particle[CLOTH_HINGE_CORNERS];
  gdouble c[CLOTH_HINGE_CORNERS];
  gdouble warp, weft;
  /* Σ c x along the cloth's normal of a sheet of curvature (κ_uu, κ_vv, √2 κ_uv), 1/m */
  gdouble form[3];
  /* 1 where (x3 − x2) × (x1 − x0) is along the normal x_u × x_v, −1 where it is against */
  gdouble side;
} ClothBodyHinge;

/* What bending does to one particle when another one moves from it: an element of the
 * stiffness matrix, B_warp·warp + B_weft·weft. The rows' sums are 0. */
typedef struct
{
  guint32 particle;
  gdouble warp, weft;
} ClothBodyBend;

/* A spring between two particles, its rest (u, v) and its stiffness,
 * stretch_warp·warp + stretch_weft·weft + shear·shear. */
typedef struct
{
  guint32 particle[2];
  gdouble u, v;
  gdouble warp, weft, shear;
} ClothBodySpring;

/* Row sums of the stiffness matrix over one particle, for the bound of the time step. */
typedef struct
{
  gdouble warp, weft;           /* of the stretch moduli, for moves along u and v */
  gdouble shear_u, shear_v;
  gdouble bend_warp, bend_weft;
  gdouble springs[2][3];        /* along u and v: of warp, weft and shear */
} ClothBodyBound;

typedef struct
{
  guint32 particle;
  gdouble from_s, until_s;
  /* frames whose place on the path means something: [first, last] */
  guint first, last;
} ClothBodyHeld;

typedef struct
{
  guint n_vertices, n_particles;
  guint32 *particle;            /* of each vertex: sewn vertices share one */
  guint columns, rows;          /* of a grid, else 0 */
  gboolean even;                /* a grid whose cells are nearly alike */
  gdouble *uv;                  /* of each vertex, m */
  gdouble *area;                /* of each particle, m² */
  guint n_right, n_triangles;   /* the right-angled ones come first */
  ClothBodyTriangle *triangles;
  guint n_straight, n_hinges;   /* of a grid those whose last c is 0 come first */
  ClothBodyHinge *hinges;
  guint n_bends;
  guint32 *first_bend;          /* of each particle and behind the last one */
  ClothBodyBend *bends;         /* the hinges' matrix; NULL on a grid */
  guint n_springs;
  ClothBodySpring *springs;     /* of the mass–spring model */
  ClothBodyBound *bounds;
  guint n_held;
  ClothBodyHeld *held;
  guint n_frames;
  gdouble epoch;                /* of the first frame on the scene's clock, s: all times here count from it */
  const gint *stop;             /* nullable: atomic, no step begins while it isn't 0 */
  gdouble *times;
  gdouble *clamps;              /* [frame][held][3] */
  gdouble frame_s;              /* usual distance of frames */
  gdouble *positions;           /* of each vertex at the start */
  gdouble *velocities;
  gdouble gravity[3];
  GArray *obstacles;
  ClothBvh **bvhs;              /* of each obstacle; NULL but for meshes */
} ClothBody;

void cloth_body_free (ClothBody * body);
void cloth_body_path (const ClothBody * body, const gdouble * paths,
    guint held, gdouble time_s, gdouble position[3]);

static inline gboolean
cloth_body_is_stopped (const ClothBody * body)
{
  return body->stop && g_atomic_int_get (body->stop);
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothBody, cloth_body_free)
G_END_DECLS
