/* The table of effects: complete, in order, each description sound.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#include <math.h>
#include <string.h>

#include "gst/sim/model.h"

/* The ids that results use; other programs rely on them. */
static const struct
{
  const gchar *id;
  ClothEffectSide side;
} wanted[] = {
  {"air_drag", CLOTH_EFFECT_PHYSICS},
  {"air_drag_linear", CLOTH_EFFECT_PHYSICS},
  {"air_drag_tangential", CLOTH_EFFECT_PHYSICS},
  {"wind", CLOTH_EFFECT_PHYSICS},
  {"gust", CLOTH_EFFECT_PHYSICS},
  {"added_mass", CLOTH_EFFECT_PHYSICS},
  {"bending", CLOTH_EFFECT_PHYSICS},
  {"bending_anisotropy", CLOTH_EFFECT_PHYSICS},
  {"bending_softening", CLOTH_EFFECT_PHYSICS},
  {"stretch", CLOTH_EFFECT_PHYSICS},
  {"stretch_anisotropy", CLOTH_EFFECT_PHYSICS},
  {"shear", CLOTH_EFFECT_PHYSICS},
  {"grain_angle", CLOTH_EFFECT_PHYSICS},
  {"biphasic_stretch", CLOTH_EFFECT_PHYSICS},
  {"hysteresis", CLOTH_EFFECT_PHYSICS},
  {"damping_mass", CLOTH_EFFECT_PHYSICS},
  {"damping_stiffness", CLOTH_EFFECT_PHYSICS},
  {"plasticity", CLOTH_EFFECT_PHYSICS},
  {"rest_curvature", CLOTH_EFFECT_PHYSICS},
  {"areal_mass", CLOTH_EFFECT_PHYSICS},
  {"mass_distribution", CLOTH_EFFECT_PHYSICS},
  {"gravity_tilt", CLOTH_EFFECT_PHYSICS},
  {"gravity_scale", CLOTH_EFFECT_PHYSICS},
  {"shrinkage", CLOTH_EFFECT_PHYSICS},
  {"self_contact", CLOTH_EFFECT_PHYSICS},
  {"friction", CLOTH_EFFECT_PHYSICS},
  {"clamp_slip", CLOTH_EFFECT_CLAMP},
  {"clamp_compliance", CLOTH_EFFECT_CLAMP},
  {"clamp_delay", CLOTH_EFFECT_CLAMP},
  {"time_step", CLOTH_EFFECT_NUMERICS},
  {"mesh_resolution", CLOTH_EFFECT_NUMERICS},
  {"mesh_diagonals", CLOTH_EFFECT_NUMERICS},
  {"lens_distortion", CLOTH_EFFECT_CAMERA},
  {"focal_length", CLOTH_EFFECT_CAMERA},
  {"extrinsic_drift", CLOTH_EFFECT_CAMERA},
  {"sync_offset", CLOTH_EFFECT_CAMERA},
  {"rolling_shutter", CLOTH_EFFECT_CAMERA},
  {"frame_drop", CLOTH_EFFECT_CAMERA},
  {"motion_blur", CLOTH_EFFECT_IMAGE},
  {"defocus", CLOTH_EFFECT_IMAGE},
  {"shading_shift", CLOTH_EFFECT_IMAGE},
  {"colour_crosstalk", CLOTH_EFFECT_IMAGE},
  {"noise", CLOTH_EFFECT_IMAGE},
  {"position_scale", CLOTH_EFFECT_MEASUREMENT},
  {"misalignment", CLOTH_EFFECT_MEASUREMENT},
  {"axes_exchange", CLOTH_EFFECT_MEASUREMENT},
  {"label_exchange", CLOTH_EFFECT_MEASUREMENT},
  {"time_scale", CLOTH_EFFECT_MEASUREMENT},
  {"recording_delay", CLOTH_EFFECT_MEASUREMENT},
  {"smoothing", CLOTH_EFFECT_MEASUREMENT},
};

static void
test_complete (void)
{
  guint n;
  const ClothEffect *const *table = cloth_effect_table (&n);

  g_assert_cmpuint (n, ==, G_N_ELEMENTS (wanted));
  for (guint i = 0; i < n; i++) {
    g_assert_cmpstr (table[i]->id, ==, wanted[i].id);
    g_assert_cmpint (table[i]->side, ==, wanted[i].side);
    g_assert_true (cloth_effect_find (wanted[i].id) == table[i]);
  }
}

static void
check_sentence (const gchar * text)
{
  g_assert_nonnull (text);
  g_assert_true (g_utf8_validate (text, -1, NULL));
  g_assert_true (g_str_has_suffix (text, "."));
  g_assert_null (strstr (text, "  "));
}

static void
check_parameter (const ClothEffect * effect, const ClothEffectParameter * p)
{
  g_test_message ("%s.%s", effect->id, p->name);
  for (const gchar * c = p->name; *c; c++)
    g_assert_true (g_ascii_islower (*c) || *c == '_' || (c > p->name
            && g_ascii_isdigit (*c)));
  g_assert_nonnull (p->unit);
  g_assert_false (g_str_has_suffix (p->blurb, "."));
  g_assert_true (isfinite (p->min) && isfinite (p->max));
  g_assert_cmpfloat (p->min, <, p->max);
  g_assert_cmpfloat (p->min, <=, p->null_value);
  g_assert_cmpfloat (p->null_value, <=, p->max);
  /* On one side means: from the null on, and on no other. */
  if (p->one_sided)
    g_assert_true (p->min == p->null_value);
  g_assert_cmpfloat (p->prior, >, 0);
  g_assert_cmpfloat (p->prior, <=, p->max - p->min);
  g_assert_cmpuint (p->n_tried, <=, G_N_ELEMENTS (p->tried));
  g_assert_true (p->shapes || p->n_tried == 0
      || effect->test == CLOTH_EFFECT_TEST_TRIAL);
  for (guint i = 0; i < p->n_tried; i++) {
    g_assert_cmpfloat (p->min, <=, p->tried[i]);
    g_assert_cmpfloat (p->tried[i], <=, p->max);
  }
}

static const ClothEffectParameter *
find_parameter (const ClothEffect * effect, const gchar * name)
{
  for (guint k = 0; k < effect->n_parameters; k++)
    if (strcmp (effect->parameters[k].name, name) == 0)
      return &effect->parameters[k];
  return NULL;
}

/* What a diagnosis relies on. */
static void
check_test (const ClothEffect * effect)
{
  gdouble range[2];
  guint n_own = 0;

  for (guint k = 0; k < effect->n_parameters; k++)
    n_own += !effect->parameters[k].shapes;
  g_assert_cmpuint (n_own, >, 0);
  if (effect->test == CLOTH_EFFECT_TEST_NONE
      || effect->test == CLOTH_EFFECT_TEST_TRIAL
      || effect->test == CLOTH_EFFECT_TEST_STOCHASTIC)
    check_sentence (effect->untested);
  else if (effect->side == CLOTH_EFFECT_MEASUREMENT && effect->untested)
    check_sentence (effect->untested);
  else
    g_assert_null (effect->untested);
  for (guint k = 0; k < effect->n_parameters
      && effect->test == CLOTH_EFFECT_TEST_TRIAL; k++) {
    g_assert_cmpuint (effect->parameters[k].n_tried, >, 0);
    g_assert_cmpuint (effect->parameters[k].n_tried, ==,
        effect->parameters[0].n_tried);
  }
  if (effect->test == CLOTH_EFFECT_TEST_JUMP) {
    g_assert_cmpint (effect->side, ==, CLOTH_EFFECT_CLAMP);
    g_assert_true (find_parameter (effect, "held")->shapes);
    g_assert_true (find_parameter (effect, "time")->shapes);
  }
  if (effect->test == CLOTH_EFFECT_TEST_STOCHASTIC)
    g_assert_cmpint (cloth_effect_find (effect->varies)->test, ==,
        CLOTH_EFFECT_TEST_SCORE);
  else
    g_assert_null (effect->varies);
  if (effect->same_as)
    g_assert_true (cloth_model_get_range (effect->same_as, range, NULL));
}

static void
test_descriptions (void)
{
  guint n;
  const ClothEffect *const *table = cloth_effect_table (&n);

  for (guint i = 0; i < n; i++) {
    const ClothEffect *effect = table[i];

    check_sentence (effect->blurb);
    check_sentence (effect->regressor);
    check_sentence (effect->source);
    g_assert_cmpuint (effect->n_parameters, >=, 1);
    g_assert_cmpuint (effect->n_parameters, <=, CLOTH_EFFECT_MAX_PARAMETERS);
    for (guint k = 0; k < effect->n_parameters; k++) {
      check_parameter (effect, &effect->parameters[k]);
      for (guint j = 0; j < k; j++)
        g_assert_cmpstr (effect->parameters[k].name, !=,
            effect->parameters[j].name);
    }
    check_test (effect);
    for (guint k = 0; effect->confusions && effect->confusions[k]; k++) {
      const gchar *other = effect->confusions[k];

      g_test_message ("%s looks like %s", effect->id, other);
      g_assert_cmpstr (other, !=, effect->id);
      g_assert_nonnull (cloth_effect_find (other));
    }
  }
}

static void
test_unknown (void)
{
  static const gchar *const names[] =
      { "", "Air_drag", "air-drag", "air_drag ", "air_dra", "air_drags",
    "none"
  };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++)
    g_assert_null (cloth_effect_find (names[i]));
}

static void
test_sides (void)
{
  g_assert_cmpstr (cloth_effect_side_name (CLOTH_EFFECT_PHYSICS), ==,
      "physics");
  g_assert_cmpstr (cloth_effect_side_name (CLOTH_EFFECT_CLAMP), ==, "clamp");
  g_assert_cmpstr (cloth_effect_side_name (CLOTH_EFFECT_NUMERICS), ==,
      "numerics");
  g_assert_cmpstr (cloth_effect_side_name (CLOTH_EFFECT_CAMERA), ==, "camera");
  g_assert_cmpstr (cloth_effect_side_name (CLOTH_EFFECT_IMAGE), ==, "image");
  g_assert_cmpstr (cloth_effect_side_name (CLOTH_EFFECT_MEASUREMENT), ==,
      "measurement");
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/effects/complete", test_complete);
  g_test_add_func ("/effects/descriptions", test_descriptions);
  g_test_add_func ("/effects/unknown", test_unknown);
  g_test_add_func ("/effects/sides", test_sides);
  return g_test_run ();
}
