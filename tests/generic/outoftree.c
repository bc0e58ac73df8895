/* A program of somebody else: built against the installed library by pkg-config alone.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/cloth/cloth.h>

int
main (int argc, char **argv)
{
  GstClothSaddle saddle = {.x = 12.25f,.y = 7.5f };
  GstClothSaddle got = { 0 };
  GError *error = NULL;
  GstClothTopology *topology;
  GstBuffer *buffer, *copy;
  GstCaps *caps;

  gst_init (&argc, &argv);
  buffer = gst_buffer_new ();
  gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new ("left", 3,
          &saddle, 1, NULL, 0));
  copy = gst_buffer_copy (buffer);
  gst_buffer_unref (buffer);
  gst_cloth_saddles_get_saddle (gst_buffer_get_cloth_saddles (copy), 0, &got);
  gst_buffer_unref (copy);

  topology = gst_cloth_topology_new_grid (9, 7, 0.4f, 0.3f, &error);
  caps = gst_cloth_topology_to_caps (topology, 25, 1);
  g_print ("%g %g %u\n", got.x, got.y,
      gst_cloth_topology_get_n_vertices (topology));
  gst_caps_unref (caps);
  gst_cloth_topology_unref (topology);
  return 0;
}
