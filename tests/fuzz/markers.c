/* Fuzz target: recordings of labelled points, tables and C3D.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <math.h>
#include <string.h>

#include "gst/mesh/formats/formats.h"

static void
check (ClothMarkers * markers)
{
  if (!markers)
    return;
  g_assert_cmpuint (markers->n_frames, >, 0);
  g_assert_cmpuint (markers->n_markers, >, 0);
  g_assert_true (!markers->names || markers->names->len == markers->n_markers);
  for (gsize i = 0; i < 3 * (gsize) markers->n_frames * markers->n_markers; i++)
    g_assert_true (isnan (markers->positions[i]) ||
        fabs (markers->positions[i]) < 1.01e9);
  for (guint i = 1; markers->times && i < markers->n_frames; i++)
    g_assert_true (markers->times[i] > markers->times[i - 1]);
  cloth_markers_free (markers);
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autofree gchar *text = g_malloc (size + 1);

  memcpy (text, data, size);
  text[size] = 0;
  check (cloth_markers_parse_csv (text, size, NULL));
  check (cloth_markers_parse_c3d (data, size, NULL));
  return 0;
}
