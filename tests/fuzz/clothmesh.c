/* Fuzz target: a frame of a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <gst/cloth/cloth.h>

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstBuffer) buffer = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;

  if (!gst_is_initialized ())
    gst_init (NULL, NULL);
  buffer = size ? gst_buffer_new_memdup (data, size) : gst_buffer_new ();
  mesh = gst_cloth_mesh_from_buffer (buffer, &error);
  g_assert_true ((mesh == NULL) == (error != NULL));
  if (mesh) {
    g_autoptr (GstClothMesh) again =
        gst_cloth_mesh_new (gst_cloth_mesh_get_sequence (mesh),
        gst_cloth_mesh_get_n_vertices (mesh),
        gst_cloth_mesh_get_positions (mesh, NULL),
        gst_cloth_mesh_get_states (mesh, NULL),
        gst_cloth_mesh_get_covariances (mesh, NULL));
    g_autoptr (GstBuffer) written = gst_cloth_mesh_to_buffer (again);

    g_assert_cmpuint (gst_buffer_get_size (written), ==, size);
  }
  return 0;
}
