/* All effects, whatever their side.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#include <string.h>

#define LANES(name) extern const ClothEffect cloth_effect_##name;
#define SCENE(name) LANES (name)
#define CAPTURE(name) LANES (name)
#define RECORDING(name) LANES (name)
#include "gst/effect/list.h"

static const ClothEffect *const table[] = {
#define LANES(name) &cloth_effect_##name,
#define SCENE(name) LANES (name)
#define CAPTURE(name) LANES (name)
#define RECORDING(name) LANES (name)
#include "gst/effect/list.h"
};

/* @n_effects: (out): how many there are
 *
 * Returns: (transfer none) (array length=n_effects): every effect once, by side:
 *   physics, clamp, numerics, camera, image, measurement
 */
const ClothEffect *const *
cloth_effect_table (guint * n_effects)
{
  *n_effects = G_N_ELEMENTS (table);
  return table;
}

/* @id: name of an effect
 *
 * Returns: (transfer none) (nullable): the effect of that name
 */
const ClothEffect *
cloth_effect_find (const gchar * id)
{
  for (guint i = 0; i < G_N_ELEMENTS (table); i++)
    if (strcmp (table[i]->id, id) == 0)
      return table[i];
  return NULL;
}

/* @ids: (nullable) (array zero-terminated=1): ids of effects; %NULL: of all
 * @id: id of an effect
 *
 * Returns: whether it is one of them
 */
gboolean
cloth_effect_is_among (const gchar * const *ids, const gchar * id)
{
  return !ids || g_strv_contains (ids, id);
}

/* @side: a side
 *
 * Returns: (transfer none): its name
 */
const gchar *
cloth_effect_side_name (ClothEffectSide side)
{
  static const gchar *const names[] =
      { "physics", "clamp", "numerics", "camera", "image",
    "measurement"
  };

  return names[side];
}
