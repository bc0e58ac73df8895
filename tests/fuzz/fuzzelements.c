/* Elements for the fuzz targets that feed them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzzelements.h"

#include <glib/gstdio.h>
#include <string.h>

#include "gst/pattern/pattern.h"
#include "gst/rig/rigfile.h"

#define N_CAMERAS 2

/* By GST_PLUGIN_DEFINE in elements/plugin.c. */
void gst_plugin_cloth_register (void);

void
fuzz_elements_init (void)
{
  if (gst_is_initialized ())
    return;
  gst_init (NULL, NULL);
  gst_plugin_cloth_register ();
}

static void
save_rig (const gchar * path)
{
  ClothRig *rig = cloth_rig_new (N_CAMERAS);

  for (guint i = 0; i < N_CAMERAS; i++) {
    const ClothCamera camera = { NULL, 64, 48,
      {80, 0, 31.5, 0, 80, 23.5, 0, 0, 1}, CLOTH_LENS_NONE, {0},
      {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1 * i, 0, 1}
    };

    rig->cameras[i] = camera;
    rig->cameras[i].name = g_strdup_printf ("cam%u", i);
  }
  g_assert_true (cloth_rig_save (rig, path, NULL));
  cloth_rig_free (rig);
}

GstHarness *
fuzz_triangulate_new (guint n_pads, GstHarness ** in)
{
  g_autofree gchar *folder = g_dir_make_tmp ("cloth-fuzz-XXXXXX", NULL);
  g_autofree gchar *rig = g_build_filename (folder, "rig.json", NULL);
  g_autofree gchar *board = g_build_filename (folder, "pattern.json", NULL);
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (FUZZ_COLUMNS, FUZZ_ROWS, 0.04, 0, TRUE, NULL);
  GstElement *element = gst_element_factory_make ("triangulate", NULL);
  GstHarness *src;

  save_rig (rig);
  g_assert_true (cloth_pattern_save (pattern, board, NULL));
  gst_object_ref_sink (element);
  g_object_set (element, "rig", rig, "pattern", board, "threads", 1, NULL);
  src = gst_harness_new_with_element (element, NULL, "src");
  for (guint i = 0; i < n_pads; i++) {
    g_autofree gchar *name = g_strdup_printf ("sink_%u", i);

    in[i] = gst_harness_new_with_element (element, name, NULL);
  }
  for (guint i = 0; i < n_pads; i++)
    gst_harness_set_src_caps_str (in[i], GST_CLOTH_OBSERVATIONS_MEDIA_TYPE
        ",version=1,width=64,height=48,framerate=25/1");
  gst_object_unref (element);
  /* They were read when the element started. */
  g_remove (rig);
  g_remove (board);
  g_rmdir (folder);
  return src;
}

void
fuzz_triangulate_free (GstHarness * src, guint n_pads, GstHarness ** in)
{
  gst_element_set_state (src->element, GST_STATE_NULL);
  for (guint i = 0; i < n_pads; i++)
    gst_harness_teardown (in[i]);
  gst_harness_teardown (src);
}
