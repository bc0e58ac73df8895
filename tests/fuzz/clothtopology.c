/* Fuzz target: the topology of a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <gst/cloth/cloth.h>

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstBuffer) buffer = NULL;
  g_autoptr (GstClothTopology) topology = NULL;

  if (!gst_is_initialized ())
    gst_init (NULL, NULL);
  buffer = size ? gst_buffer_new_memdup (data, size) : gst_buffer_new ();
  topology = gst_cloth_topology_from_buffer (buffer, &error);
  g_assert_true ((topology == NULL) == (error != NULL));
  if (topology) {
    g_autoptr (GstCaps) caps = gst_cloth_topology_to_caps (topology, 0, 1);
    g_autoptr (GstClothTopology) again = gst_cloth_topology_from_caps (caps,
        &error);

    g_assert_no_error (error);
    g_assert_nonnull (again);
  }
  return 0;
}
