/* Fuzz target: a frame of an observation stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <gst/cloth/cloth.h>

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstBuffer) buffer = NULL;
  g_autoptr (GstBuffer) target = NULL;

  if (!gst_is_initialized ())
    gst_init (NULL, NULL);
  buffer = size ? gst_buffer_new_memdup (data, size) : gst_buffer_new ();
  target = gst_buffer_new ();
  if (gst_cloth_observations_unpack (buffer, target, &error)) {
    g_autoptr (GstBuffer) packed = gst_cloth_observations_pack (target);
    g_autoptr (GstBuffer) again = gst_buffer_new ();

    /* What was read can be written and read. */
    gst_cloth_observations_unpack (packed, again, &error);
    g_assert_no_error (error);
  } else {
    g_assert_nonnull (error);
    g_assert_null (gst_buffer_get_cloth_saddles (target));
    g_assert_null (gst_buffer_get_cloth_dots (target));
    g_assert_null (gst_buffer_get_cloth_silhouette (target));
    g_assert_null (gst_buffer_get_cloth_matches (target));
  }
  return 0;
}
