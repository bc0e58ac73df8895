/* The state of a group of lanes and what effects may do with it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/body.h"
#include "gst/sim/lanes/lane.h"
#include "gst/sim/model.h"
#include "gst/sim/pull.h"

typedef struct _ClothLaneHooks ClothLaneHooks;
typedef struct _ClothLaneObstacles ClothLaneObstacles;
typedef struct _ClothLaneImplicit ClothLaneImplicit;
typedef struct _ClothLaneGrid ClothLaneGrid;
typedef ClothLane ClothLane3[3];

/* An effect in a group. */
typedef struct
{
  const ClothLaneHooks *hooks;
  /* its parameters; the null values in lanes whose model has it not */
  ClothLane p[CLOTH_EFFECT_MAX_PARAMETERS];
  /* hooks->state_size bytes for each particle, then triangle_size for each triangle,
   * hinge_size for each hinge and fixed_size; zeroed, aligned as a lane is */
  gpointer state;
} ClothLaneEffect;

/* Springs that draw the cloth to what was observed: an acceleration of
 * pull + share·change − weight (gain x + damping v), @share of the way from now to next. Where
 * directions are known unequally well the weight is a symmetric matrix: xx, yy, zz, yz, xz, xy. */
typedef struct
{
  ClothLane3 *pull, *change;
  ClothLane *weight;
  ClothLane (*matrix)[6];       /* NULL: none has one */
  ClothLane gain, damping;
  gdouble now[CLOTH_N_LANES], next[CLOTH_N_LANES];      /* s */
} ClothLaneTargets;

/* A pull, whose numbers all lanes share: where it is on the cloth, what its corners feel of a
 * force, and at the start of the interval and their change over it target, its velocity and
 * σ²Λ; the most that Λ draws with in any direction. */
typedef struct
{
  guint n;                      /* corners: 1 or 3 */
  guint32 particle[3];
  ClothReal at[3], share[3];
  ClothReal target[2][3], velocity[2][3], information[2][6];
  gdouble strongest;
} ClothLanePull;

typedef struct
{
  guint n, size;
  guint n_single;               /* the first ones are at one particle */
  ClothLanePull *list;
  ClothLane *mass;              /* of the point of each */
  ClothLane (*stiffness)[6];    /* of each in an implicit step */
  ClothLane *rows;              /* of each particle, for the bound */
  ClothLane3 *drawn;            /* of each particle: gain x + damping v */
  ClothPullLaw law;
  gdouble softening, per_square;        /* 1/σ² */
  gdouble now, per_span;        /* s, 1/s */
  ClothLane gain, damping;
  ClothLane bound;              /* of stiffness over mass for a gain of 1 */
} ClothLanePulls;

/* Rest geometry in the lanes' precision. */
typedef struct
{
  guint32 particle[3];
  ClothReal area;
  /* |∂x/∂u|², |∂x/∂v|², ∂x/∂u·∂x/∂v = t · (e1·e1, e2·e2, e1·e2); diagonal when
   * right-angled */
  ClothReal t[9];
} ClothLaneTriangle;

typedef struct
{
  guint32 particle[2];
  ClothReal u, v, length;
  ClothReal warp, weft, shear;
} ClothLaneSpring;

/* A spring's part of the matrix of an implicit step: direction, stiffness along it, tension
 * over length where it pulls. */
typedef struct
{
  ClothLane along[3];
  ClothLane k, damped, g;
} ClothLaneLink;

typedef struct
{
  guint32 particle[4];
  ClothReal c[4];
  ClothReal warp, weft;
} ClothLaneHinge;

typedef struct
{
  guint32 particle;
  ClothReal warp, weft;
} ClothLaneBend;

/* Shares of a bound that are used: of the cloth at rest, so that what is stretched less than 1.2 times, where damping
 * binds a single stage 1.13 times, needs no other step ((3 λ² − 1)/2 is the stiffness at stretch λ in St. Venant and
 * Kirchhoff's law); and of what is looked at as it is stretched, so that it may be stretched further before it is looked
 * at again. */
#define CLOTH_LANE_MARGIN 0.7
#define CLOTH_LANE_MARGIN_STRAINED 0.9

/* What bounds a step: of the cloth itself stiffness over mass, which is damped by β times as much, and that of
 * tensions, which nothing damps, 1/s²; the share that is used. */
typedef struct
{
  ClothLane own, pulled;
  gdouble margin;
} ClothLaneBounds;

typedef struct
{
  const ClothBody *body;
  guint n_models;
  guint64 seed;
  guint n;                      /* particles */
  ClothLane3 *x, *v, *f;        /* m, m/s, N */
  ClothLane3 *z;                /* for the forces of a step: x + βv */
  ClothLane *mass;              /* kg; setup hooks may change it */
  ClothLane *inverse_mass;
  ClothLaneTriangle *triangles;
  ClothLaneHinge *hinges;       /* of a grid */
  ClothLaneBend *bends;         /* of another mesh, else NULL */
  ClothLaneSpring *springs;
  ClothForceModel force_model;

  /* The models. Setup hooks may change these. */
  ClothLane density;            /* kg/m² */
  ClothLane stretch_warp, stretch_weft, shear;
  ClothLane bending_warp, bending_weft;
  ClothLane alpha, beta;        /* damping αM + βK */
  ClothLane compression_ratio;
  ClothLane air_density;
  ClothLane gravity[3];
  ClothLane compliance;         /* of the clamps, m/N */
  ClothLane obstacle_friction;  /* on top of each obstacle's own */
  ClothLane floor;              /* height of one that the scene doesn't have, m */
  gboolean has_floor;
  /* ∂x/∂(u, v) is multiplied by this from the right: [0] [1]; [2] [3]. It turns the grain
   * and changes the size of the cloth at rest. */
  ClothLane rest[4];

  /* What setup made of them. */
  gboolean rest_changed;        /* @rest is not the identity in every lane */
  ClothLane metric[9];          /* @rest's act on the three products of ∂x */
  ClothLane rest_area;          /* over the area in uv */
  ClothLane omega2, friction;   /* bounds: stiffness/mass and damping/mass */
  ClothLane own_omega2, own_friction;   /* without effects */
  ClothLaneBounds strained;     /* by cloth_lane_strained () */

  guint n_effects;
  ClothLaneEffect *effects;
  gboolean has_forces, has_inertia;     /* some effect has that hook */
  gboolean grid_alone;          /* the grid's pass has all that changes with velocities */
  ClothLaneTargets targets;
  gboolean has_targets;
  ClothLanePulls pulls;

  /* Clamps: whether each holds, since when, how far off its path its particle was then,
   * and where the particle is now. */
  ClothMask *held;
  gdouble *held_since;          /* [held][lane] */
  ClothLane3 *held_offset;
  ClothLane3 *held_x;
  guint8 *fixed;                /* of each particle, filled by cloth_lane_strained () */
  /* of each lane, [frame][held][3]: where the clamps go instead; NULL: where the scene says */
  gdouble *paths[CLOTH_N_LANES];

  /* Of explicit steps, by lane, s: how long before the places the velocities are, half a step
   * or nothing when they were set; how long forces act in the running one. */
  ClothLane lag, kick;
  ClothLane3 *before_v;         /* velocities before the last step */
  ClothLane ahead;              /* lag over how long forces acted in that */

  /* Of steps in stages: velocities a stage ago, forces that don't change meanwhile. */
  guint stages;
  gboolean has_others;
  ClothLane3 *last_v, *others;

  ClothLaneObstacles *obstacles;
  ClothLaneGrid *grid;          /* NULL: another mesh, or the mass–spring model */
  ClothLaneImplicit *implicit;  /* NULL: leapfrog */

  gdouble time;                 /* from the first frame on, s */
  gdouble dt;                   /* of the running step, s */
  guint steps_left;             /* after it, before anybody asks */
  /* what a change of the step's last velocity changes the places by, over it, s: dt but
   * in steps of second order */
  ClothLane reach;

  /* Lanes that diverged, and everybody's last sound state. */
  ClothMask diverged;
  gdouble diverged_since[CLOTH_N_LANES];
  ClothLane3 *sound_x, *sound_v;
} ClothLaneState;

/* When the effects of a model act within each of their hooks. Those of one order act as
 * the list of effects has them; those that name none are of the first. Sums in floating point depend on it in their last bits. */
typedef enum
{
  CLOTH_LANE_ORDER_SIZES,       /* of masses, stiffnesses, damping, gravity, clamps */
  CLOTH_LANE_ORDER_DIRECTIONS,  /* of threads and of gravity, which have their sizes then */
  CLOTH_LANE_ORDER_AIR,
  CLOTH_LANE_ORDER_THREADS,     /* forces along the threads */
  CLOTH_LANE_ORDER_FOLDS,       /* forces across them */
  CLOTH_LANE_ORDER_CREASES,     /* folds that change the rest of the others */
  CLOTH_LANE_ORDER_CONTACT,
  CLOTH_LANE_N_ORDERS
} ClothLaneOrder;

/* What an effect does; any of them may be NULL. At its null each must add exactly 0 or
 * multiply by exactly 1, lane by lane. */
struct _ClothLaneHooks
{
  ClothLaneOrder order;
  gboolean changes_rest;        /* setup changes ClothLaneState.rest */
  gsize state_size;             /* bytes of state for each particle */
  gsize triangle_size;          /* for each triangle */
  gsize hinge_size;             /* for each hinge */
  gsize fixed_size;             /* of other state */
  /* once, when the models are known: may change the models' numbers and the masses */
  void (*setup) (ClothLaneState * state, ClothLaneEffect * effect);
  /* adds to the bounds of the time step: stiffness/mass in 1/s², damping/mass in 1/s */
  void (*rate) (const ClothLaneState * state, const ClothLaneEffect * effect,
      ClothLane * omega2, ClothLane * friction);
  /* every step, before the particles move: adds to f */
  void (*force) (ClothLaneState * state, ClothLaneEffect * effect);
  /* the same, when all forces are in f: changes them by what they do together */
  void (*inertia) (ClothLaneState * state, ClothLaneEffect * effect);
  /* moves where a clamp holds its particle at a time */
  void (*clamp) (const ClothLaneState * state, const ClothLaneEffect * effect,
      guint held, gdouble time_s, ClothLane position[3]);
  /* every step, when particles are where forces, obstacles and clamps put them: the
   * only one that may move them */
  void (*collide) (ClothLaneState * state, ClothLaneEffect * effect);
  /* at the start, and when a lane's state was set from outside: forget what came before
   * there */
  void (*reset) (ClothLaneState * state, ClothLaneEffect * effect,
      ClothMask lanes);
  /* at the end: frees what setup made */
  void (*clear) (ClothLaneState * state, ClothLaneEffect * effect);
};

typedef struct
{
  const ClothEffect *effect;
  const ClothLaneHooks *hooks;
} ClothLanePart;

/* Of each effect that has hooks, then one of NULL. */
extern const ClothLanePart CLOTH_LANE_NAME (cloth_lane_parts)[] G_GNUC_INTERNAL;

/* Terms of a step. */
void CLOTH_LANE_NAME (cloth_lane_membrane) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_membrane_rest) (ClothLaneState * state);
ClothLane CLOTH_LANE_NAME (cloth_lane_membrane_energy) (const ClothLaneState *
    state);
void CLOTH_LANE_NAME (cloth_lane_springs) (ClothLaneState * state);
ClothLane CLOTH_LANE_NAME (cloth_lane_springs_energy) (const ClothLaneState *
    state);
void CLOTH_LANE_NAME (cloth_lane_springs_links) (const ClothLaneState * state,
    ClothLaneLink * links);
void CLOTH_LANE_NAME (cloth_lane_bending) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_bends) (const ClothLaneState * state,
    ClothLane warp, ClothLane weft, const ClothLane3 * z, ClothLane3 * f);
ClothLane CLOTH_LANE_NAME (cloth_lane_bending_energy) (const ClothLaneState *
    state);
void CLOTH_LANE_NAME (cloth_lane_targets) (const ClothLaneState * state,
    gdouble time_s, ClothLane3 * f);
void CLOTH_LANE_NAME (cloth_lane_pulls) (const ClothLaneState * state,
    gdouble time_s, ClothLane3 * f);
void CLOTH_LANE_NAME (cloth_lane_pulls_weigh) (ClothLaneState * state);
ClothLane CLOTH_LANE_NAME (cloth_lane_pulls_bound) (const ClothLaneState *
    state, ClothLane * rows);
void CLOTH_LANE_NAME (cloth_lane_pulls_update) (const ClothLaneState * state,
    gdouble time_s);
void CLOTH_LANE_NAME (cloth_lane_pulls_apply) (const ClothLaneState * state,
    ClothLane h, ClothLane h2, const ClothLane3 * d, ClothLane3 * q);
void CLOTH_LANE_NAME (cloth_lane_pulls_diagonal) (const ClothLaneState * state,
    ClothLane h, ClothLane h2, ClothLane (*block)[6]);
void CLOTH_LANE_NAME (cloth_lane_clamps) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_clamps_reset) (ClothLaneState * state,
    ClothMask lanes);
gboolean CLOTH_LANE_NAME (cloth_lane_clamp_grips) (ClothLaneState * state,
    guint held, gdouble time_s, const ClothLane before[3], ClothLane place[3]);
ClothLaneObstacles *CLOTH_LANE_NAME (cloth_lane_obstacles_new) (const
    ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_obstacles_free) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_obstacles) (ClothLaneState * state);
ClothLaneGrid *CLOTH_LANE_NAME (cloth_lane_grid_new) (const ClothBody * body);
void CLOTH_LANE_NAME (cloth_lane_grid_free) (ClothLaneGrid * grid);
void CLOTH_LANE_NAME (cloth_lane_grid_forces) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_grid_step) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_grid_stage) (ClothLaneState * state,
    ClothLane h, gdouble mu, gdouble nu);
void CLOTH_LANE_NAME (cloth_lane_own_forces) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_effect_forces) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_inertia) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_forces) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_explicit) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_staged) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_strained) (ClothLaneState * state);
gdouble CLOTH_LANE_NAME (cloth_lane_staged_time_step) (const
    ClothLaneState * state, const ClothLaneBounds * bounds, guint stages,
    gdouble longest);
ClothLaneImplicit *CLOTH_LANE_NAME (cloth_lane_implicit_new) (const
    ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_implicit_free) (ClothLaneImplicit * implicit);
void CLOTH_LANE_NAME (cloth_lane_implicit_reset) (ClothLaneState * state,
    ClothMask lanes);
gdouble CLOTH_LANE_NAME (cloth_lane_implicit_solve) (ClothLaneState * state);
void CLOTH_LANE_NAME (cloth_lane_implicit_take) (ClothLaneState * state);
ClothLane CLOTH_LANE_NAME (cloth_lane_stiffness) (const ClothLaneState * state);
ClothLane CLOTH_LANE_NAME (cloth_lane_explicit_time_step) (const
    ClothLaneState * state, const ClothLaneBounds * bounds);

/* The part of bending in a particle's row of stiffness. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_bend_bound (const ClothLaneState * state, guint particle)
{
  const ClothBodyBound *b = &state->body->bounds[particle];

  return state->bending_warp * (ClothReal) b->bend_warp +
      state->bending_weft * (ClothReal) b->bend_weft;
}

/* One triangle in the air: its normal times its area, its area, the mean velocity. */
CLOTH_LANE_INLINE void
cloth_lane_face (const ClothLaneState * state, const ClothLaneTriangle * t,
    ClothLane normal[3], ClothLane * area, ClothLane velocity[3])
{
  const guint32 *p = t->particle;
  ClothLane e1[3], e2[3];

  cloth_lane_subtract (state->x[p[1]], state->x[p[0]], e1);
  cloth_lane_subtract (state->x[p[2]], state->x[p[0]], e2);
  cloth_lane_cross (e1, e2, normal);
  for (guint k = 0; k < 3; k++) {
    normal[k] *= cloth_lane_set (0.5);
    velocity[k] = (state->v[p[0]][k] + state->v[p[1]][k] + state->v[p[2]][k]) *
        cloth_lane_set (1. / 3.);
  }
  *area = cloth_lane_sqrt (cloth_lane_dot (normal, normal));
}

/* A third of a force on each corner. */
CLOTH_LANE_INLINE void
cloth_lane_push_face (ClothLaneState * state, const ClothLaneTriangle * t,
    const ClothLane force[3])
{
  for (guint k = 0; k < 3; k++) {
    ClothLane third = force[k] * cloth_lane_set (1. / 3.);

    for (guint corner = 0; corner < 3; corner++)
      state->f[t->particle[corner]][k] += third;
  }
}

/* Where the path of a clamp is in a lane. */
CLOTH_LANE_INLINE void
cloth_lane_path (const ClothLaneState * state, guint held, guint lane,
    gdouble time_s, gdouble place[3])
{
  cloth_body_path (state->body, state->paths[lane] ? state->paths[lane] :
      state->body->clamps, held, time_s, place);
}

/* Where a time is on the observer's way from now to next. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_targets_share (const ClothLaneState * state, gdouble time_s)
{
  const ClothLaneTargets *t = &state->targets;
  ClothLane share = cloth_lane_set (0.);

  for (guint l = 0; l < CLOTH_N_LANES; l++)
    if (t->next[l] > t->now[l])
      CLOTH_LANE_AT (&share, l) =
          (ClothReal) ((time_s - t->now[l]) / (t->next[l] - t->now[l]));
  return share;
}

/* A velocity at the time of the places, to second order, from what it is and was before the last
 * step. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_velocity (const ClothLaneState * state, ClothLane v,
    ClothLane before)
{
  return v + state->ahead * (v - before);
}

/* The observer's acceleration of a particle. */
CLOTH_LANE_INLINE void
cloth_lane_target (const ClothLaneState * state, guint particle,
    ClothLane share, ClothLane acceleration[3])
{
  const ClothLaneTargets *t = &state->targets;
  ClothLane gain = t->weight[particle] * t->gain;
  ClothLane damping = t->weight[particle] * t->damping;

  if (t->matrix) {
    ClothLane off[3], drawn[3];

    for (guint k = 0; k < 3; k++)
      off[k] = t->gain * state->x[particle][k] +
          t->damping * cloth_lane_velocity (state, state->v[particle][k],
          state->before_v[particle][k]);
    cloth_lane_symmetric (t->matrix[particle], off, drawn);
    for (guint k = 0; k < 3; k++)
      acceleration[k] = t->pull[particle][k] +
          share * t->change[particle][k] - drawn[k];
    return;
  }
  for (guint k = 0; k < 3; k++)
    acceleration[k] = t->pull[particle][k] + share * t->change[particle][k] -
        gain * state->x[particle][k] - damping * cloth_lane_velocity (state,
        state->v[particle][k], state->before_v[particle][k]);
}
