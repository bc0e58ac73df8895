/* Every effect in the lanes: nothing at its null, to the last bit; something beside it;
 * and the same on every instruction set.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#include "gst/effect/effect.h"

#define COLUMNS 6
#define ROWS 7

/* What no kernel of the lanes does: these change the scene, or need something to touch,
 * or act on pictures. */
static const gchar *const elsewhere[] = {
  "self_contact", "friction", NULL
};

static ClothScene *
swing (void)
{
  ClothScene *scene = cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS,
          0.3f, 0.35f), 50., 16);

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, COLUMNS - 1);
  for (guint frame = 0; frame < scene->n_frames; frame++)
    for (guint held = 0; held < 2; held++)
      scene->clamps[6 * frame + 3 * held + 1] +=
          0.05 * sin (9. * scene->times[frame]);
  for (guint i = 0; i < COLUMNS * ROWS; i++) {
    scene->positions[3 * i + 1] = 0.5 * scene->positions[3 * i + 2];
    scene->positions[3 * i + 2] *= sqrt (0.75);
  }
  return scene;
}

/* Parameters of an effect at work: the prior's size away from null. */
static void
set_at_work (ClothModel * model, const ClothEffect * effect, gboolean null)
{
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];

  for (guint k = 0; k < effect->n_parameters; k++) {
    const ClothEffectParameter *p = &effect->parameters[k];

    values[k] = p->null_value;
    if (!null && !strstr (p->name, "time") && strcmp (p->name, "held"))
      values[k] = MIN (p->null_value + p->prior, p->max);
  }
  if (!null && effect->n_parameters == 1)
    values[0] = MIN (effect->parameters[0].null_value +
        effect->parameters[0].prior, effect->parameters[0].max);
  if (!null && strcmp (effect->id, "plasticity") == 0)
    values[1] = 1.;
  if (!null && strcmp (effect->id, "biphasic_stretch") == 0)
    values[1] = 0.;
  cloth_model_set_effect (model, effect, values);
}

static gboolean
is_in_lanes (const ClothEffect * effect)
{
  return (effect->side == CLOTH_EFFECT_PHYSICS
      || effect->side == CLOTH_EFFECT_CLAMP)
      && !g_strv_contains (elsewhere, effect->id);
}

static void
run (const ClothScene * scene, ClothModel * const *models, guint n_models,
    ClothSimOptions options, gdouble * result)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = cloth_sim_new (scene,
      (const ClothModel * const *) models, n_models, &options, &error);

  g_assert_no_error (error);
  run_for (sim, 0.3);
  for (guint i = 0; i < n_models; i++) {
    g_assert_cmpint (cloth_sim_get_state (sim, i, NULL), ==, CLOTH_SIM_OK);
    cloth_sim_get_positions (sim, i, result + 3 * COLUMNS * ROWS * (gsize) i);
  }
}

/* Models without, with it at null, with it at work. */
static void
test_effect (gconstpointer data)
{
  const ClothEffect *effect = data;
  g_autoptr (ClothScene) scene = swing ();
  ClothModel *models[3];
  gsize n = 3 * COLUMNS * ROWS;
  g_autofree gdouble *first = g_new (gdouble, 3 * n);
  g_autofree gdouble *other = g_new (gdouble, 3 * n);
  gdouble most = 0.;

  for (guint i = 0; i < 3; i++) {
    models[i] = model_new (0.2, 40.);
    models[i]->bending_warp = models[i]->bending_weft = 2e-5;
    models[i]->damping_mass = 0.2;
    models[i]->damping_stiffness = 1e-4;
    models[i]->time_step = 1e-4;
    if (i)
      set_at_work (models[i], effect, i == 1);
  }
  run (scene, models, 3, (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_BEST, 1}
      , first);
  g_assert_cmpmem (first, n * sizeof *first, first + n, n * sizeof *first);
  for (gsize i = 0; i < n; i++)
    most = MAX (most, fabs (first[i] - first[2 * n + i]));
  g_test_message ("%s at work moves up to %g m", effect->id, most);
  g_assert_cmpfloat (most, >, 1e-7);
  g_assert_cmpfloat (most, <, 0.3);
  run (scene, models, 3, (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_SCALAR, 1}
      , other);
  g_assert_cmpmem (first, 3 * n * sizeof *first, other, 3 * n * sizeof *first);
  run (scene, models, 3, (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_AVX2, 1}
      , other);
  g_assert_cmpmem (first, 3 * n * sizeof *first, other, 3 * n * sizeof *first);
  run (scene, models + 2, 1, (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_BEST, 1}
      , other);
  g_assert_cmpmem (first + 2 * n, n * sizeof *first, other, n * sizeof *first);
  for (guint i = 0; i < 3; i++)
    cloth_model_free (models[i]);
}

int
main (int argc, char **argv)
{
  guint n_effects;
  const ClothEffect *const *effects = cloth_effect_table (&n_effects);

  g_test_init (&argc, &argv, NULL);
  for (guint i = 0; i < n_effects; i++)
    if (is_in_lanes (effects[i])) {
      g_autofree gchar *path =
          g_strdup_printf ("/sim/effects/%s", effects[i]->id);

      g_test_add_data_func (path, effects[i], test_effect);
    }
  return g_test_run ();
}
