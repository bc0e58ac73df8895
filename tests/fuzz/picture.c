/* Fuzz target: pattern.json of any print.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/pattern/picture.h"

#include <string.h>

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPicturePattern) pattern =
      cloth_picture_pattern_load_data ((const gchar *) data, size, &error);

  g_assert_true ((pattern != NULL) == (error == NULL));
  if (pattern) {
    /* What was read is written and reads back the same. */
    g_autofree gchar *text = cloth_picture_pattern_to_json (pattern);
    g_autoptr (ClothPicturePattern) again =
        cloth_picture_pattern_load_data (text, strlen (text), &error);
    g_autofree gchar *same = NULL;

    g_assert_no_error (error);
    same = cloth_picture_pattern_to_json (again);
    g_assert_cmpstr (same, ==, text);
  }
  return 0;
}
