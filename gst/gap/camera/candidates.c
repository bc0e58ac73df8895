/* What may be wrong with cameras, as directions: one for each parameter of each effect that
 * moves points in a picture, of each camera, and of all cameras alike.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/candidates.h"

#include <string.h>

#include "gst/rig/capture.h"

/* The effects that move points in a picture, and whether one number may hold for all
 * cameras. In the order of the columns. */
static const struct
{
  const gchar *id;
  gboolean shared;
} movers[] = {
  {"lens_distortion", TRUE},
  {"focal_length", TRUE},
  {"extrinsic_drift", FALSE},
  {"sync_offset", FALSE},
  {"rolling_shutter", TRUE},
  {"motion_blur", FALSE},
  {"frame_drop", FALSE},
};

/* @effect: a camera or image effect
 *
 * Returns: (nullable): why points in pictures can't show it; %NULL when they can
 */
const gchar *
cloth_camera_why_not (const ClothEffect * effect)
{
  for (guint i = 0; i < G_N_ELEMENTS (movers); i++)
    if (strcmp (movers[i].id, effect->id) == 0)
      return NULL;
  if (strcmp (effect->id, "shading_shift") == 0)
    return "It moves the centres of dots by the square of their size, which "
        "observations don't hold.";
  return "It moves no point but makes all scatter more: see the share of the "
      "stage “detection”.";
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

static void
clear_direction (gpointer item)
{
  g_free (((ClothDirection *) item)->name);
}

static gboolean
is_wanted (const gchar * const *effects, const gchar * id)
{
  return !effects || g_strv_contains (effects, id);
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
  ClothCandidates *c = g_new0 (ClothCandidates, 1);
  guint first = 0;

  c->directions = g_array_new (FALSE, FALSE, sizeof (ClothDirection));
  g_array_set_clear_func (c->directions, clear_direction);
  c->list = g_array_new (FALSE, FALSE, sizeof (ClothCandidate));
  for (guint camera = 0; camera <= rig->n_cameras; camera++)
    for (guint i = 0; i < G_N_ELEMENTS (movers); i++) {
      const ClothEffect *effect = cloth_capture_find_effect (movers[i].id);

      for (guint k = 0; k < effect->n_parameters; k++)
        add_direction (c, effect, k);
    }
  for (guint i = 0; i < G_N_ELEMENTS (movers); i++) {
    const ClothEffect *effect = cloth_capture_find_effect (movers[i].id);
    guint n = movers[i].shared && rig->n_cameras > 1 ? rig->n_cameras + 1 :
        rig->n_cameras;

    for (guint camera = 0; camera < n && is_wanted (effects, effect->id);
        camera++) {
      ClothCandidate candidate = { effect };

      for (guint k = 0; k < effect->n_parameters; k++) {
        candidate.values[k] = effect->parameters[k].null_value;
        candidate.parameters[k] = k;
      }
      candidate.first = camera * CLOTH_CAMERA_N_COLUMNS + first;
      candidate.n = effect->n_parameters;
      g_array_append_val (c->list, candidate);
    }
    first += effect->n_parameters;
  }
  g_assert (first == CLOTH_CAMERA_N_COLUMNS);
  return c;
}

/* @candidate: one of cloth_camera_candidates_new ()
 *
 * Returns: which camera it is of; the number of cameras: of all alike
 */
guint
cloth_camera_of_candidate (const ClothCandidate * candidate)
{
  return candidate->first / CLOTH_CAMERA_N_COLUMNS;
}

/* The effect and parameter of a column of one camera. */
const ClothEffect *
cloth_camera_column (guint column, guint * parameter)
{
  for (guint i = 0; i < G_N_ELEMENTS (movers); i++) {
    const ClothEffect *effect = cloth_capture_find_effect (movers[i].id);

    if (column < effect->n_parameters) {
      *parameter = column;
      return effect;
    }
    column -= effect->n_parameters;
  }
  g_assert_not_reached ();
}
