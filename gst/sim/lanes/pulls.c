/* The forces of pulls at points of the cloth, and their part of an implicit step.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/state.h"

/* Where the point is among its @n corners, of a vector of each. */
CLOTH_LANE_INLINE void
gather (const ClothLanePull * pull, guint n, const ClothLane3 * of,
    ClothLane at[3])
{
  for (guint k = 0; k < 3; k++) {
    at[k] = of[pull->particle[0]][k];
    if (n == 3)
      at[k] = at[k] * cloth_lane_set (pull->at[0]) +
          of[pull->particle[1]][k] * cloth_lane_set (pull->at[1]) +
          of[pull->particle[2]][k] * cloth_lane_set (pull->at[2]);
  }
}

CLOTH_LANE_INLINE void
scatter (const ClothLanePull * pull, guint n, const ClothLane force[3],
    ClothLane3 * f)
{
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < 3; k++)
      f[pull->particle[i]][k] += n == 3 ?
          force[k] * cloth_lane_set (pull->share[i]) : force[k];
}

/* gain x + damping v of a particle. */
CLOTH_LANE_INLINE void
find_drawn (const ClothLaneState * state, guint particle, ClothLane drawn[3])
{
  const ClothLanePulls *pulls = &state->pulls;

  for (guint k = 0; k < 3; k++)
    drawn[k] = pulls->gain * state->x[particle][k] +
        pulls->damping * cloth_lane_velocity (state, state->v[particle][k],
        state->before_v[particle][k]);
}

/* Of @n numbers that lie on straight lines, which all lanes share. */
CLOTH_LANE_INLINE void
interpolate (guint n, const ClothReal * now, const ClothReal * change,
    ClothReal share, ClothLane * to)
{
  for (guint k = 0; k < n; k++)
    to[k] = cloth_lane_set (now[k] + share * change[k]);
}

/* ψ at a distance y − p. */
CLOTH_LANE_INLINE ClothLane
fall_off (const ClothLanePulls * pulls, ClothPullLaw law,
    const ClothLane information[6], const ClothLane away[3])
{
  ClothLane one = cloth_lane_set (1.), drawn[3], square;

  cloth_lane_symmetric (information, away, drawn);
  square = cloth_lane_dot (away, drawn) * cloth_lane_set (pulls->per_square) +
      cloth_lane_set (pulls->softening * pulls->softening);
  if (law == CLOTH_PULL_RECIPROCAL)
    return one / square;
  return one / (square * cloth_lane_sqrt (square));
}

static ClothReal
share_of (const ClothLanePulls * pulls, gdouble time_s)
{
  return (ClothReal) ((time_s - pulls->now) * pulls->per_span);
}

/* Those from @begin to @end, of @n corners each. */
CLOTH_LANE_INLINE void
draw (const ClothLaneState * state, guint begin, guint end, guint n,
    ClothPullLaw law, ClothReal share, ClothLane3 * f)
{
  const ClothLanePulls *pulls = &state->pulls;

  for (guint i = begin; i < end; i++) {
    const ClothLanePull *pull = &pulls->list[i];
    ClothLane target[3], velocity[3], at[3], information[6], force[3];
    ClothLane scale = pulls->mass[i];

    interpolate (3, pull->target[0], pull->target[1], share, target);
    interpolate (3, pull->velocity[0], pull->velocity[1], share, velocity);
    interpolate (6, pull->information[0], pull->information[1], share,
        information);
    if (law != CLOTH_PULL_LINEAR) {
      gather (pull, n, (const ClothLane3 *) state->x, at);
      for (guint k = 0; k < 3; k++)
        at[k] = target[k] - at[k];
      scale *= fall_off (pulls, law, information, at);
    }
    if (n == 3)
      gather (pull, n, (const ClothLane3 *) pulls->drawn, at);
    else
      find_drawn (state, pull->particle[0], at);
    for (guint k = 0; k < 3; k++)
      at[k] = pulls->gain * target[k] + pulls->damping * velocity[k] - at[k];
    cloth_lane_symmetric (information, at, force);
    for (guint k = 0; k < 3; k++)
      force[k] *= scale;
    scatter (pull, n, force, f);
  }
}

/* Adds the forces of pulls at a time to f. */
void
CLOTH_LANE_NAME (cloth_lane_pulls) (const ClothLaneState * state,
    gdouble time_s, ClothLane3 * f)
{
  const ClothLanePulls * pulls = &state->pulls;
  ClothReal share = share_of (pulls, time_s);

  /* once a particle, not once for each triangle about it */
  for (guint i = 0; pulls->n > pulls->n_single && i < state->n; i++)
    find_drawn (state, i, pulls->drawn[i]);
  if (pulls->law == CLOTH_PULL_LINEAR) {
    draw (state, 0, pulls->n_single, 1, CLOTH_PULL_LINEAR, share, f);
    draw (state, pulls->n_single, pulls->n, 3, CLOTH_PULL_LINEAR, share, f);
  } else {
    draw (state, 0, pulls->n_single, 1, pulls->law, share, f);
    draw (state, pulls->n_single, pulls->n, 3, pulls->law, share, f);
  }
}

/* Finds the mass of each pull's point. */
void CLOTH_LANE_NAME (cloth_lane_pulls_weigh) (ClothLaneState * state)
{
  const ClothLanePulls *pulls = &state->pulls;

  for (guint i = 0; i < pulls->n; i++) {
    const ClothLanePull *pull = &pulls->list[i];

    pulls->mass[i] = cloth_lane_set (0.);
    for (guint corner = 0; corner < pull->n; corner++)
      pulls->mass[i] += state->mass[pull->particle[corner]] *
          cloth_lane_set (pull->at[corner]);
  }
}

/* For an implicit step that ends at a time: σ²Λ of each pull times its mass and its ψ here. */
void
CLOTH_LANE_NAME (cloth_lane_pulls_update) (const ClothLaneState * state,
    gdouble time_s)
{
  const ClothLanePulls * pulls = &state->pulls;
  ClothReal share = share_of (pulls, time_s);

  for (guint i = 0; i < pulls->n; i++) {
    const ClothLanePull *pull = &pulls->list[i];
    ClothLane p[3], away[3], scale = pulls->mass[i];

    gather (pull, pull->n, (const ClothLane3 *) state->x, p);
    interpolate (3, pull->target[0], pull->target[1], share, away);
    for (guint k = 0; k < 3; k++)
      away[k] -= p[k];
    interpolate (6, pull->information[0], pull->information[1], share,
        pulls->stiffness[i]);
    if (pulls->law != CLOTH_PULL_LINEAR)
      scale *= fall_off (pulls, pulls->law, pulls->stiffness[i], away);
    for (guint k = 0; k < 6; k++)
      pulls->stiffness[i][k] *= scale;
  }
}

/* Adds their part of the matrix of a step, of length h and h² = @h2, times d to q. */
void
CLOTH_LANE_NAME (cloth_lane_pulls_apply) (const ClothLaneState * state,
    ClothLane h, ClothLane h2, const ClothLane3 * d, ClothLane3 * q)
{
  const ClothLanePulls * pulls = &state->pulls;
  ClothLane scale = h2 * pulls->gain + h * pulls->damping;

  for (guint i = 0; i < pulls->n; i++) {
    const ClothLanePull *pull = &pulls->list[i];
    ClothLane moved[3], force[3];

    gather (pull, pull->n, d, moved);
    for (guint k = 0; k < 3; k++)
      moved[k] *= scale;
    cloth_lane_symmetric (pulls->stiffness[i], moved, force);
    scatter (pull, pull->n, force, q);
  }
}

/* Adds it to the blocks of the particles: xx, yy, zz, yz, xz, xy. */
void
CLOTH_LANE_NAME (cloth_lane_pulls_diagonal) (const ClothLaneState * state,
    ClothLane h, ClothLane h2, ClothLane (*block)[6])
{
  const ClothLanePulls * pulls = &state->pulls;
  ClothLane scale = h2 * pulls->gain + h * pulls->damping;

  for (guint i = 0; i < pulls->n; i++) {
    const ClothLanePull *pull = &pulls->list[i];

    for (guint corner = 0; corner < pull->n; corner++) {
      ClothLane square = scale * cloth_lane_set (pull->at[corner] *
          pull->share[corner]);

      for (guint k = 0; k < 6; k++)
        block[pull->particle[corner]][k] += square * pulls->stiffness[i][k];
    }
  }
}

/* What the stiffest particle is drawn with: a bound of stiffness over mass for a gain of 1,
 * by Gershgorin's rows. */
ClothLane
CLOTH_LANE_NAME (cloth_lane_pulls_bound) (const ClothLaneState * state,
    ClothLane * rows)
{
  const ClothLanePulls * pulls = &state->pulls;
  ClothLane most = cloth_lane_set (0.);
  gdouble s = pulls->softening, steepest = 1.;

  if (pulls->law == CLOTH_PULL_RECIPROCAL)
    steepest = 1. / (s * s);
  else if (pulls->law == CLOTH_PULL_RECIPROCAL_SQUARE)
    steepest = 1. / (s * s * s);
  memset (rows, 0, state->n * sizeof *rows);
  for (guint i = 0; i < pulls->n; i++) {
    const ClothLanePull *pull = &pulls->list[i];
    ClothLane stiff =
        pulls->mass[i] * cloth_lane_set (pull->strongest * steepest);

    for (guint corner = 0; corner < pull->n; corner++)
      rows[pull->particle[corner]] += stiff *
          cloth_lane_set (pull->share[corner]);
  }
  for (guint i = 0; i < state->n; i++)
    most = cloth_lane_max (most, rows[i] * state->inverse_mass[i]);
  return most;
}
