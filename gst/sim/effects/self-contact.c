/* Cloth that touches itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "friction", "bending",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_self_contact = {
  .id = "self_contact",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Parts of the cloth that are not neighbours keep a distance and do "
      "not go through each other; the friction between them is that of "
      "the effect friction.",
  .source =
      "Thickness of cloth, 0.5 to 3 mm; Bridson, Fedkiw and Anderson, "
      "ACM Transactions on Graphics 21(3), 2002.",
  .regressor =
      "Pairs of equal and opposite forces along the normal where two "
      "parts of the cloth are as near as its thickness.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_TRIAL,
  .untested =
      "Contact switches on and off: it has no derivative to test by.",
  .n_parameters = 1,
  .parameters = {
    {.name = "thickness", .unit = "m", .null_value = 0, .min = 0, .max = 0.01,
        .prior = 0.001, .one_sided = TRUE, .n_tried = 1, .tried = {0.001},
        .blurb = "Distance that parts keep, at most half the height of the "
            "triangles about; 0 lets them pass through each other"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/contact.h"
#include "gst/sim/lanes/hooks.h"

/* How often it acts at least, s: not in each explicit step, but no implicit one is longer.
 * Between two acts a pile sinks into itself by some g times the square of this. */
#define INTERVAL 2e-3

typedef struct
{
  ClothContactMesh *mesh;
  ClothContact *lanes[CLOTH_N_LANES];   /* NULL where there is no contact */
  gdouble *x, *v, *inverse_mass;
  gdouble seconds[CLOTH_N_LANES];       /* since the last act */
  gboolean hit[CLOTH_N_LANES];  /* it acts after the next step */
} SelfContact;

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  SelfContact *self = effect->state;

  for (guint l = 0; l < state->n_models; l++) {
    if (!(CLOTH_LANE_AT (&effect->p[0], l) > 0))
      continue;
    if (!self->mesh)
      self->mesh = cloth_contact_mesh_new (state->body);
    self->lanes[l] = cloth_contact_new (self->mesh, CLOTH_SIM_LANES == 4);
  }
  self->x = g_new (gdouble, 3 * (gsize) state->n);
  self->v = g_new (gdouble, 3 * (gsize) state->n);
  self->inverse_mass = g_new (gdouble, state->n);
}

static void
clear (ClothLaneState * state, ClothLaneEffect * effect)
{
  SelfContact *self = effect->state;

  for (guint l = 0; l < CLOTH_N_LANES; l++)
    cloth_contact_free (self->lanes[l]);
  cloth_contact_mesh_free (self->mesh);
  g_free (self->x);
  g_free (self->v);
  g_free (self->inverse_mass);
}

/* Stable steps are 1.4 / ω, see explicit.c. */
static void
rate (const ClothLaneState * state, const ClothLaneEffect * effect,
    ClothLane * omega2, ClothLane * friction)
{
  ClothLane zero = cloth_lane_set (0.);

  *omega2 += cloth_lane_select (cloth_lane_less (zero, effect->p[0]),
      cloth_lane_set (1.4 * 1.4 / (INTERVAL * INTERVAL)), zero);
}

static void
gather (const ClothLaneState * state, SelfContact * self, guint lane)
{
  gboolean hard = CLOTH_LANE_AT (&state->compliance, lane) == 0;

  for (guint i = 0; i < state->n; i++) {
    self->inverse_mass[i] = CLOTH_LANE_AT (&state->inverse_mass[i], lane);
    for (guint k = 0; k < 3; k++) {
      self->x[3 * i + k] = CLOTH_LANE_AT (&state->x[i][k], lane);
      self->v[3 * i + k] = CLOTH_LANE_AT (&state->v[i][k], lane);
    }
  }
  for (guint i = 0; hard && i < state->body->n_held; i++)
    if (CLOTH_LANE_AT (&state->held[i], lane))
      self->inverse_mass[state->body->held[i].particle] = 0.;
}

static void
scatter (ClothLaneState * state, const SelfContact * self, guint lane)
{
  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      CLOTH_LANE_AT (&state->x[i][k], lane) = (ClothReal) self->x[3 * i + k];
      CLOTH_LANE_AT (&state->v[i][k], lane) = (ClothReal) self->v[3 * i + k];
    }
  }
}

static void
reset (ClothLaneState * state, ClothLaneEffect * effect, ClothMask lanes)
{
  SelfContact *self = effect->state;

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    if (!self->lanes[l] || !CLOTH_LANE_AT (&lanes, l))
      continue;
    gather (state, self, l);
    cloth_contact_reset (self->lanes[l], self->x);
    self->seconds[l] = 0.;
    self->hit[l] = FALSE;
  }
}

static void
collide (ClothLaneState * state, ClothLaneEffect * effect)
{
  SelfContact *self = effect->state;
  guint every = MAX (1, (guint) (INTERVAL / state->dt));
  gboolean act = state->steps_left % every == 0;

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    /* lanes beyond the models repeat the first */
    guint from = l < state->n_models ? l : 0;

    self->seconds[l] += state->dt;
    if (!self->lanes[from] || !(act || self->hit[l])
        || CLOTH_LANE_AT (&state->diverged, l))
      continue;
    gather (state, self, from);
    if (from == l)
      self->hit[l] = cloth_contact_act (self->lanes[l],
          CLOTH_LANE_AT (&effect->p[0], l),
          CLOTH_LANE_AT (&state->obstacle_friction, l), self->seconds[l],
          every * state->dt, self->inverse_mass, self->x, self->v);
    else
      self->hit[l] = self->hit[from];
    scatter (state, self, l);
    self->seconds[l] = 0.;
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_self_contact) = {
  .order = CLOTH_LANE_ORDER_CONTACT,
  .fixed_size = sizeof (SelfContact),
  .setup = setup,
  .rate = rate,
  .collide = collide,
  .reset = reset,
  .clear = clear,
};
#endif
