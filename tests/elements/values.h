/* Properties one after the other: what each is at first, and that it takes another value.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/check/gstcheck.h>

/* @values: (array length=n): name, another value, and the first one; NULL: a string that isn't
 *   set */
static inline void
check_values (const gchar * factory, const gchar * const (*values)[3], guint n)
{
  GstElement *element = gst_element_factory_make (factory, NULL);

  for (guint i = 0; i < n; i++) {
    GParamSpec *spec = g_object_class_find_property
        (G_OBJECT_GET_CLASS (element), values[i][0]);
    g_auto (GValue) value = G_VALUE_INIT, expected = G_VALUE_INIT;

    fail_unless (spec != NULL, "%s", values[i][0]);
    g_value_init (&value, spec->value_type);
    g_value_init (&expected, spec->value_type);
    g_object_get_property (G_OBJECT (element), values[i][0], &value);
    if (values[i][2]) {
      fail_unless (gst_value_deserialize (&expected, values[i][2]));
      fail_unless_equals_int (gst_value_compare (&value, &expected),
          GST_VALUE_EQUAL);
    } else {
      fail_unless (g_value_get_string (&value) == NULL);
    }
    gst_util_set_object_arg (G_OBJECT (element), values[i][0], values[i][1]);
    fail_unless (gst_value_deserialize (&expected, values[i][1]));
    g_object_get_property (G_OBJECT (element), values[i][0], &value);
    fail_unless_equals_int (gst_value_compare (&value, &expected),
        GST_VALUE_EQUAL);
  }
  gst_object_unref (element);
}
