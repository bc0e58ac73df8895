/* Fuzz target: mesh sequences, OBJ + PC2 with states and numbered PLY files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <math.h>

#include "gst/take/sequence.h"

#define MAX_READ 8

static const gchar *const names[] = {
  "s.obj", "s.pc2", "s.states.npy", "s_00000.ply", "s_00001.ply", NULL
};

static void
read_sequence (const gchar * folder, ClothMeshFormat format)
{
  g_autofree gchar *location = g_build_filename (folder,
      format == CLOTH_MESH_FORMAT_PLY ? "s.ply" : "s.obj", NULL);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshReader) reader =
      cloth_mesh_reader_open (location, format, &error);
  gsize n;

  g_assert_true ((reader == NULL) == (error != NULL));
  if (!reader)
    return;
  n = cloth_mesh_reader_get_topology (reader)->n_vertices;
  g_assert_cmpuint (cloth_mesh_reader_get_n_frames (reader), >, 0);
  g_assert_true (cloth_mesh_reader_get_fps (reader) >= 0);
  for (guint f = 0; f < MIN (cloth_mesh_reader_get_n_frames (reader), MAX_READ);
      f++) {
    ClothMeshFrame frame = { NULL };

    if (!cloth_mesh_reader_read (reader, f, &frame, NULL))
      continue;
    for (gsize i = 0; i < n; i++) {
      gboolean seen = frame.states[i] != CLOTH_VERTEX_UNSEEN;

      g_assert_cmpuint (frame.states[i], <=, CLOTH_VERTEX_PREDICTED);
      for (guint k = 0; k < 3; k++)
        g_assert_true (seen ? isfinite (frame.positions[3 * i + k])
            : isnan (frame.positions[3 * i + k]));
    }
  }
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  gchar *folder = fuzz_folder_new (names, &bytes);

  read_sequence (folder, CLOTH_MESH_FORMAT_OBJ_PC2);
  read_sequence (folder, CLOTH_MESH_FORMAT_PLY);
  fuzz_folder_free (names, folder);
  return 0;
}
