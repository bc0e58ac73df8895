/* Fuzz target: what a user's simulator prints of itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <math.h>
#include <string.h>

#include "gst/gap/simulator/simulator.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autofree gchar *text = g_malloc (size + 1);
  g_autoptr (ClothSimulatorCapabilities) capabilities = NULL;
  g_autofree gdouble *values = NULL;
  g_autofree gchar *words = NULL;

  if (size > 0)
    memcpy (text, data, size);
  text[size] = 0;
  capabilities = cloth_simulator_capabilities_parse (text, size, NULL);
  if (!capabilities)
    return 0;
  values = cloth_gap_simulator_defaults (capabilities);
  for (guint i = 0; i < capabilities->parameters->len; i++) {
    const ClothSimulatorParameter *p =
        cloth_simulator_capabilities_get (capabilities, i);

    if (cloth_simulator_parameter_is_fixed (p))
      continue;
    values[i] = cloth_gap_simulator_move (p, p->value);
    g_assert_true (values[i] >= p->range[0] && values[i] <= p->range[1]);
  }
  words = cloth_gap_simulator_describe (capabilities, values);
  g_assert_true (g_utf8_validate (words, -1, NULL));
  return 0;
}
