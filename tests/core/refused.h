/* What the library refuses: others' bytes with an error, misuse with a critical message.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

/* Observations that can't be: an error of that code, and nothing comes of them. */
static inline void
assert_refused (const guint8 * bytes, gsize size, gint code, const gchar * name)
{
  g_autoptr (GstBuffer) buffer = size ? gst_buffer_new_memdup (bytes, size) :
      gst_buffer_new ();
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GError) error = NULL;

  g_assert_false (gst_cloth_observations_unpack (buffer, target, &error));
  g_test_message ("%s: %s", name, error->message);
  g_assert_error (error, GST_CLOTH_ERROR, code);
  g_assert_null (gst_buffer_get_cloth_saddles (target));
  g_assert_null (gst_buffer_get_cloth_quads (target));
  g_assert_null (gst_buffer_get_cloth_dots (target));
  g_assert_null (gst_buffer_get_cloth_silhouette (target));
  g_assert_null (gst_buffer_get_cloth_matches (target));
  g_assert_null (gst_buffer_get_reference_timestamp_meta (target, NULL));
}

/* A call against the rules: it returns no pointer. */
#define ASSERT_MISUSE(call) G_STMT_START { \
  g_test_expect_message ("GstCloth", G_LOG_LEVEL_CRITICAL, "*assertion*"); \
  g_assert_null (call); \
  g_test_assert_expected_messages (); \
} G_STMT_END
