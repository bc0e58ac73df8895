/* Lengths of the command line.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/length.h"

#include <math.h>
#include <string.h>

gboolean
parse_length (const gchar * option, const gchar * text, gdouble * metres,
    GError ** error)
{
  static const struct
  {
    const gchar *name;
    gdouble per_metre;
  } units[] = { {"mm", 1000}, {"cm", 100}, {"m", 1}, {"in", 1000 / 25.4} };
  gchar *end;
  gdouble value = g_ascii_strtod (text, &end);

  for (gsize i = 0; i < G_N_ELEMENTS (units) && end != text; i++) {
    /* Divided, so that 50mm is the 0.05 that is written in files. */
    if (!strcmp (end, units[i].name) && isfinite (value) && value >= 0) {
      *metres = value / units[i].per_metre;
      return TRUE;
    }
  }
  g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
      "--%s %s: give a length with its unit, mm, cm, m or in, for instance "
      "50mm", option, text);
  return FALSE;
}
