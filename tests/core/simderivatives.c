/* Derivatives by every effect of physics and clamps: a diagnosis rests on them, so finite
 * differences of two sizes must agree.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#include "gst/effect/effect.h"

#define COLUMNS 17
#define ROWS 18
#define N (COLUMNS * ROWS)
/* Where no wrinkle is about to fall one way or the other: there are no derivatives then. */
#define START 0.96
#define WINDOW 0.4
#define MAX_RUNS 256

/* Where the derivative is taken when not at the null, or a prior's distance from it when
 * one-sided: there a parameter of these effects does nothing to this cloth in this window,
 * as the direction of no wind, or stands at a kink. */
static const struct
{
  const gchar *id;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
} places[] = {
  {"wind", {1., 0.5, 0.1, 1.5, 0.5}},
  {"biphasic_stretch", {3., 0.01}},
  {"hysteresis", {1., 0.01}},
  {"plasticity", {0.3, 5.}},
  {"mass_distribution", {3., 0.05}},
  {"clamp_slip", {0.01, 0.01, 0.01, START + 0.1, -1.}},
};

/* What has no derivative here, and why. */
static const struct
{
  const gchar *id;
  const gchar *parameter;       /* NULL: all */
  const gchar *reason;
} excused[] = {
  {"self_contact", NULL,
      "nothing touches in this scene: simcontact has one where it does"},
  {"friction", NULL, "there is no obstacle in this scene: see test_friction"},
  {"clamp_slip", "held", "a whole number that chooses a clamp"},
};

typedef struct
{
  const ClothEffect *effect;
  guint parameter;
  guint base, coarse, fine;     /* runs */
} Derivative;

typedef struct
{
  ClothModel *models[MAX_RUNS];
  guint n_models;
  Derivative derivatives[MAX_RUNS];
  guint n;
} Plan;

static const gchar *
excuse (const ClothEffect * effect, const gchar * parameter)
{
  for (guint i = 0; i < G_N_ELEMENTS (excused); i++)
    if (strcmp (excused[i].id, effect->id) == 0
        && (!excused[i].parameter
            || strcmp (excused[i].parameter, parameter) == 0))
      return excused[i].reason;
  return NULL;
}

static void
place_of (const ClothEffect * effect, gdouble * values)
{
  for (guint k = 0; k < effect->n_parameters; k++) {
    const ClothEffectParameter *p = &effect->parameters[k];

    values[k] = p->null_value + (p->one_sided ? p->prior : 0.);
  }
  for (guint i = 0; i < G_N_ELEMENTS (places); i++)
    if (strcmp (places[i].id, effect->id) == 0)
      memcpy (values, places[i].values, effect->n_parameters * sizeof *values);
}

static guint
add_run (Plan * plan, const ClothEffect * effect, const gdouble * values)
{
  ClothModel *model = cloth_model_new ();

  g_assert_cmpuint (plan->n_models, <, MAX_RUNS);
  cloth_model_set_effect (model, effect, values);
  plan->models[plan->n_models] = model;
  return plan->n_models++;
}

static void
plan_effect (Plan * plan, const ClothEffect * effect)
{
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS], at;
  guint base;

  place_of (effect, values);
  base = add_run (plan, effect, values);
  for (guint k = 0; k < effect->n_parameters; k++) {
    const ClothEffectParameter *p = &effect->parameters[k];
    Derivative *derivative = &plan->derivatives[plan->n];

    if (excuse (effect, p->name)) {
      g_test_message ("%s.%s: %s", effect->id, p->name, excuse (effect,
              p->name));
      continue;
    }
    *derivative = (Derivative) {
    effect, k, base, 0, 0};
    at = values[k];
    values[k] = at + 1e-3 * p->prior;
    derivative->coarse = add_run (plan, effect, values);
    values[k] = at + 1e-5 * p->prior;
    derivative->fine = add_run (plan, effect, values);
    values[k] = at;
    plan->n++;
  }
}

/* All models as lanes of one simulation, from one moving state. */
static void
test_derivatives (void)
{
  g_autofree Plan *plan = g_new0 (Plan, 1);
  guint n_effects, n_bad = 0;
  const ClothEffect *const *effects = cloth_effect_table (&n_effects);
  g_autoptr (ClothScene) scene = sway_scene (COLUMNS, ROWS);
  g_autoptr (ClothModel) usual = cloth_model_new ();
  g_autoptr (ClothSim) start = run_new (scene, usual), sim = NULL;
  g_autofree gdouble *x0 = NULL, *v0 = NULL;
  g_autoptr (GError) error = NULL;

  run_for (start, START);
  x0 = positions_of (start, 0);
  v0 = velocities_of (start, 0);
  for (guint i = 0; i < n_effects; i++) {
    if (effects[i]->side != CLOTH_EFFECT_PHYSICS
        && effects[i]->side != CLOTH_EFFECT_CLAMP)
      continue;
    if (excuse (effects[i], ""))
      g_test_message ("%s: %s", effects[i]->id, excuse (effects[i], ""));
    else
      plan_effect (plan, effects[i]);
  }
  sim = cloth_sim_new (scene, (const ClothModel * const *) plan->models,
      plan->n_models, NULL, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < plan->n_models; i++)
    cloth_sim_set_state (sim, i, x0, v0, START);
  run_for (sim, WINDOW);
  for (guint i = 0; i < plan->n; i++) {
    const Derivative *d = &plan->derivatives[i];
    g_autofree gdouble *base = positions_of (sim, d->base);
    g_autofree gdouble *coarse = positions_of (sim, d->coarse);
    g_autofree gdouble *fine = positions_of (sim, d->fine);
    gdouble square = 0., apart = 0., ratio;

    for (guint k = 0; k < 3 * N; k++) {
      gdouble a = (coarse[k] - base[k]) / 1e-3;
      gdouble b = (fine[k] - base[k]) / 1e-5;

      square += b * b;
      apart += (a - b) * (a - b);
    }
    ratio = sqrt (apart / square);
    g_test_message ("%s.%s: RMS %.3g mm a prior, steps disagree by %.4f",
        d->effect->id, d->effect->parameters[d->parameter].name,
        1e3 * sqrt (square / N), ratio);
    if (!(square > 0.) || !(ratio < 0.1)) {
      g_test_message ("that is no derivative");
      n_bad++;
    }
  }
  g_assert_cmpuint (plan->n, >=, 45);
  g_assert_cmpuint (n_bad, ==, 0);
  for (guint i = 0; i < plan->n_models; i++)
    cloth_model_free (plan->models[i]);
}

/* Down a slope: x = ½ g (sin θ − μ cos θ) t², so ∂x/∂μ = −½ g cos θ t². */
static void
test_friction (void)
{
  const gdouble angle = G_PI / 6., mu = 0.3, steps[] = { 0., 1e-3, 1e-5 };
  const ClothObstacle slope = {.kind = CLOTH_OBSTACLE_PLANE,.friction = NAN,
    .normal = {sin (angle), 0., cos (angle)}
  };
  g_autoptr (ClothScene) scene = sheet_new (5, 5, 0.2, 0.2);
  gdouble derivative[3] = { 0. };

  g_array_append_val (scene->obstacles, slope);
  for (guint i = 0; i < 25; i++) {
    gdouble *x = scene->positions + 3 * i, u = x[0];

    x[0] = u * cos (angle);
    x[1] = x[2];
    x[2] = -u * sin (angle);
  }
  for (guint i = 0; i < 3; i++) {
    g_autoptr (ClothModel) model = cloth_model_new ();
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *x = NULL;
    gdouble friction = mu + steps[i];

    model->damping_mass = 0.;
    model->time_step = 1e-4;
    cloth_model_set (model, "effects.friction.coefficient", friction, NULL);
    sim = run_new (scene, model);
    run_for (sim, WINDOW);
    x = positions_of (sim, 0);
    for (guint k = 0; k < 25; k++)
      derivative[i] += (x[3 * k] * cos (angle) - x[3 * k + 2] * sin (angle)) /
          25.;
  }
  for (guint i = 1; i < 3; i++)
    assert_within ((derivative[i] - derivative[0]) / steps[i] / (-0.5 * 9.81 *
            cos (angle) * WINDOW * WINDOW), 1., 1e-3);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/derivatives", test_derivatives);
  g_test_add_func ("/sim/derivative-by-friction", test_friction);
  return g_test_run ();
}
