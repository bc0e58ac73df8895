/* What may be wrong with cameras, as directions: one for each parameter of each effect that
 * moves points in a picture, of each camera, and of all cameras alike.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/candidates.h"

#include "gst/effect/effect.h"

/* The effects that move points in a picture, in the order of the columns: those with a
 * derivative, then that of lost pictures. NULL behind the last one. */
static const ClothEffect *
mover (guint index)
{
  static const ClothEffectTest tests[] =
      { CLOTH_EFFECT_TEST_SCORE, CLOTH_EFFECT_TEST_REPEAT };
  guint n;
  const ClothEffect *const *table = cloth_effect_table (&n);

  for (guint t = 0; t < G_N_ELEMENTS (tests); t++)
    for (guint i = 0; i < n; i++)
      if ((table[i]->side == CLOTH_EFFECT_CAMERA
              || table[i]->side == CLOTH_EFFECT_IMAGE)
          && table[i]->test == tests[t] && index-- == 0)
        return table[i];
  return NULL;
}

/* Returns: how many columns each camera has, one for each parameter; the last is that of
 *   repeated pictures, the only one by which points are not moved
 */
guint
cloth_camera_n_columns (void)
{
  const ClothEffect *effect;
  guint n = 0, n_repeating = 0;

  for (guint i = 0; (effect = mover (i)); i++) {
    n += effect->n_parameters;
    if (effect->test == CLOTH_EFFECT_TEST_REPEAT)
      n_repeating += effect->n_parameters;
  }
  g_assert (n_repeating == 1);
  return n;
}

static void
add_direction (ClothCandidates * c, const ClothEffect * effect, guint k)
{
  const ClothEffectParameter *p = &effect->parameters[k];
  ClothDirection d = { NULL };

  d.name = g_strdup_printf ("%s.%s", effect->id, p->name);
  d.centre = p->null_value;
  d.prior = p->prior;
  d.step = CLOTH_CAMERA_STEP * p->prior;
  d.one_sided = p->one_sided;
  d.low = p->min;
  d.high = p->max;
  g_array_append_val (c->directions, d);
}

/* @rig: the cameras
 * @effects: (nullable) (array zero-terminated=1): ids of the effects to consider
 *
 * Every effect that moves points, of each camera and, where that makes sense, of all
 * alike. The directions are those of the first camera, of the second …, of all.
 *
 * Returns: (transfer full): the candidates
 */
ClothCandidates *
cloth_camera_candidates_new (const ClothRig * rig, const gchar * const *effects)
{
  ClothCandidates *c = cloth_candidates_new_empty ();
  const guint n_columns = cloth_camera_n_columns ();
  const ClothEffect *effect;
  guint first = 0;

  for (guint camera = 0; camera <= rig->n_cameras; camera++)
    for (guint i = 0; (effect = mover (i)); i++)
      for (guint k = 0; k < effect->n_parameters; k++)
        add_direction (c, effect, k);
  for (guint i = 0; (effect = mover (i)); i++) {
    guint n = effect->shared && rig->n_cameras > 1 ? rig->n_cameras + 1 :
        rig->n_cameras;

    for (guint camera = 0;
        camera < n && cloth_effect_is_among (effects, effect->id); camera++) {
      ClothCandidate candidate = { effect };

      for (guint k = 0; k < effect->n_parameters; k++) {
        candidate.values[k] = effect->parameters[k].null_value;
        candidate.parameters[k] = k;
      }
      candidate.first = camera * n_columns + first;
      candidate.n = effect->n_parameters;
      g_array_append_val (c->list, candidate);
    }
    first += effect->n_parameters;
  }
  return c;
}

/* @candidate: one of cloth_camera_candidates_new ()
 *
 * Returns: which camera it is of; the number of cameras: of all alike
 */
guint
cloth_camera_of_candidate (const ClothCandidate * candidate)
{
  return candidate->first / cloth_camera_n_columns ();
}

/* The effect and parameter of a column of one camera. */
const ClothEffect *
cloth_camera_column (guint column, guint * parameter)
{
  const ClothEffect *effect;

  for (guint i = 0; (effect = mover (i)); i++) {
    if (column < effect->n_parameters) {
      *parameter = column;
      return effect;
    }
    column -= effect->n_parameters;
  }
  g_assert_not_reached ();
}
