/* What the numerics effects make of a scene: other diagonals, a finer mesh, other steps.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/numerics.h"

#include "gst/sim/types.h"

#define SCENE(name) extern const ClothEffect cloth_effect_##name;
#include "gst/effect/list.h"

/* A parameter of a numerics effect; its null where the model has it not. */
static gdouble
value_of (const ClothModel * model, const ClothEffect * effect)
{
  for (guint i = 0; i < model->effects->len; i++) {
    const ClothModelEffect *e =
        &g_array_index (model->effects, ClothModelEffect, i);

    if (e->effect == effect)
      return e->values[0];
  }
  return effect->parameters[0].null_value;
}

/* @a: a model
 * @b: another
 *
 * Returns: whether they have the same numerics effects
 */
gboolean
cloth_numerics_agree (const ClothModel * a, const ClothModel * b)
{
  static const ClothEffect *const effects[] = {
#define SCENE(name) &cloth_effect_##name,
#include "gst/effect/list.h"
  };

  for (guint i = 0; i < G_N_ELEMENTS (effects); i++)
    if (value_of (a, effects[i]) != value_of (b, effects[i]))
      return FALSE;
  return TRUE;
}

/* The value that all models share. */
static gboolean
shared_value (const ClothModel * const *models, guint n_models,
    const ClothEffect * effect, gdouble * value, GError ** error)
{
  const gchar *name = effect->parameters[0].name;

  *value = value_of (models[0], effect);
  for (guint i = 1; i < n_models; i++) {
    if (value_of (models[i], effect) != *value) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "models 0 and %u differ in effects.%s.%s (%g and %g): models "
          "simulated together share the mesh and the time step", i, effect->id,
          name, *value, value_of (models[i], effect));
      return FALSE;
    }
  }
  return TRUE;
}

static gboolean
turn_diagonals (ClothNumerics * numerics, gdouble pattern, GError ** error)
{
  const ClothTopology *topology = numerics->scene->topology;
  gboolean squares = FALSE;

  if (pattern == 0.)
    return TRUE;
  if (pattern != 1. && pattern != 2.) {
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
        "effects.mesh_diagonals.pattern is %g: give 0, 1 or 2", pattern);
    return FALSE;
  }
  for (guint i = 0; i < topology->n_faces && !squares; i++)
    squares = topology->faces[4 * (gsize) i + 3] != CLOTH_NO_VERTEX;
  if (!squares || (pattern == 2. && topology->columns == 0)) {
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
        "effects.mesh_diagonals.pattern is %g, but the mesh has no %s", pattern,
        squares ? "rows and columns, which 2 needs: give 0 or 1" :
        "faces of four vertices: give 0");
    return FALSE;
  }
  numerics->turned = cloth_scene_turn_diagonals (numerics->scene,
      pattern == 2.);
  numerics->scene = numerics->turned;
  return TRUE;
}

static gboolean
halve (ClothNumerics * numerics, gdouble factor, GError ** error)
{
  guint n = factor == 1. ? 0 : factor == 2. ? 1 : 2;
  guint n_vertices = numerics->scene->topology->n_vertices;

  if (n == 2 && factor != 4.) {
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
        "effects.mesh_resolution.factor is %g: edges can be halved once or "
        "twice, so give 1, 2 or 4", factor);
    return FALSE;
  }
  for (guint i = 0; i < n; i++) {
    const ClothTopology *topology = numerics->scene->topology;
    ClothHalving *halving;

    /* a face brings no more than five vertices */
    if (topology->n_vertices + 5 * (guint64) topology->n_faces >
        CLOTH_MAX_VERTICES) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "effects.mesh_resolution.factor is %g: too fine for a mesh of %u "
          "vertices and %u faces, give less", factor, topology->n_vertices,
          topology->n_faces);
      return FALSE;
    }
    halving = cloth_halving_new (numerics->scene);
    numerics->halvings[numerics->n_halvings] = halving;
    numerics->scene = halving->scene;
    numerics->values[numerics->n_halvings++] =
        g_new (gdouble, 3 * (gsize) halving->scene->topology->n_vertices);
    if (i == 0)
      numerics->kept = g_memdup2 (halving->kept,
          n_vertices * sizeof *halving->kept);
    else
      for (guint k = 0; k < n_vertices; k++)
        numerics->kept[k] = halving->kept[numerics->kept[k]];
  }
  return TRUE;
}

/* @scene: a scene, which must stay while this is used
 * @models: models that are to be simulated together
 * @n_models: how many, at least 1
 * @error: #ClothSimError when they differ in a numerics effect, or when one asks for what
 *   the scene's mesh has not
 *
 * Without numerics effects, or at their nulls, the scene is @scene itself.
 *
 * Returns: (transfer full) (nullable): what to simulate instead of @scene
 */
ClothNumerics *
cloth_numerics_new (const ClothScene * scene, const ClothModel * const *models,
    guint n_models, GError ** error)
{
  g_autoptr (ClothNumerics) numerics = g_new0 (ClothNumerics, 1);
  gdouble pattern, factor;

  numerics->scene = scene;
  if (!shared_value (models, n_models, &cloth_effect_time_step,
          &numerics->step_factor, error)
      || !shared_value (models, n_models, &cloth_effect_mesh_diagonals,
          &pattern, error)
      || !shared_value (models, n_models, &cloth_effect_mesh_resolution,
          &factor, error))
    return NULL;
  /* diagonals last: halving a grid lays them anew */
  if (!halve (numerics, factor, error)
      || !turn_diagonals (numerics, pattern, error))
    return NULL;
  return g_steal_pointer (&numerics);
}

/* @numerics: what is simulated instead of a scene
 * @stride: numbers of a vertex, at most 3
 * @values: numbers of the scene's own vertices
 *
 * Returns: (transfer none): numbers of the simulated vertices, linear between the own
 *   ones; valid until the next call
 */
const gdouble *
cloth_numerics_spread (ClothNumerics * numerics, guint stride,
    const gdouble * values)
{
  for (guint i = 0; i < numerics->n_halvings; i++) {
    cloth_halving_spread (numerics->halvings[i], stride, values,
        numerics->values[i]);
    values = numerics->values[i];
  }
  return values;
}

/* @numerics: (nullable) (transfer full): what is simulated instead of a scene
 */
void
cloth_numerics_free (ClothNumerics * numerics)
{
  if (!numerics)
    return;
  cloth_scene_free (numerics->turned);
  for (guint i = 0; i < numerics->n_halvings; i++) {
    cloth_halving_free (numerics->halvings[i]);
    g_free (numerics->values[i]);
  }
  g_free (numerics->kept);
  g_free (numerics);
}
