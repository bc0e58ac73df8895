/* From films of coloured dots to a mesh, against the mesh that the films were rendered
 * from: path-traced, H.264, both sides of the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/dotringscene.h"

#include <gst/cloth/cloth.h>

#define MOST_RMS_MM 0.5
/* Of normalised squared errors; three axes a point. */
#define LEAST_CHI2 0.8
#define MOST_CHI2 1.2
#define N_CAMERAS 8

/* eᵀ C⁻¹ e, by Cramer's rule. */
static gdouble
normalised (const gfloat c[6], const gdouble e[3])
{
  const gdouble m[3][3] = { {c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4],
      c[5]}
  };
  gdouble inverse[3][3], det = 0, sum = 0;

  for (gint i = 0; i < 3; i++)
    for (gint j = 0; j < 3; j++) {
      const gint a = (j + 1) % 3, b = (j + 2) % 3;
      const gint p = (i + 1) % 3, q = (i + 2) % 3;

      inverse[i][j] = m[a][p] * m[b][q] - m[a][q] * m[b][p];
    }
  for (gint j = 0; j < 3; j++)
    det += m[0][j] * inverse[j][0];
  for (gint i = 0; i < 3; i++)
    for (gint j = 0; j < 3; j++)
      sum += e[i] * inverse[i][j] * e[j] / det;
  return sum;
}

static GstBuffer *
play (const gchar * packed)
{
  g_autoptr (GString) line = g_string_new ("triangulate name=join rig=\"" RING
      "rig8.json\" pattern=\"" RING "pattern.json\" ! appsink name=sink "
      "sync=false ");
  g_autoptr (GstElement) pipeline = NULL;
  g_autoptr (GstElement) sink = NULL;
  g_autoptr (GstSample) sample = NULL;
  g_autoptr (GError) error = NULL;
  GstBuffer *mesh;

  for (guint i = 0; i < N_CAMERAS; i++)
    g_string_append_printf (line, "filesrc location=\"" RING "cam%u.mp4\" ! "
        "qtdemux ! h264parse ! avdec_h264 ! dotlabel camera=cam%u pattern=\""
        RING "pattern.json\" ! %s queue ! join.sink_%u ", i, i, packed, i);
  pipeline = gst_parse_launch (line->str, &error);
  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  g_signal_emit_by_name (sink, "try-pull-sample", 60 * GST_SECOND, &sample);
  fail_unless (sample != NULL);
  mesh = gst_buffer_ref (gst_sample_get_buffer (sample));
  gst_element_set_state (pipeline, GST_STATE_NULL);
  return mesh;
}

GST_START_TEST (test_films)
{
  g_autoptr (GstBuffer) buffer = play ("");
  g_autoptr (GstBuffer) again = play ("clothmetapay !");
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, NULL);
  const gfloat *at = gst_cloth_mesh_get_positions (mesh, NULL);
  const gfloat *cov = gst_cloth_mesh_get_covariances (mesh, NULL);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);
  gdouble sum = 0, chi2 = 0, variance = 0;
  guint n = 0, n_three = 0;
  Ring ring;

  ring_open (&ring);
  fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh), 31 * 33);
  for (gint i = 0; i < 31 * 33; i++) {
    gdouble X[3], e[3], squared = 0;

    if (states[i] == GST_CLOTH_VERTEX_UNSEEN)
      continue;
    ring_place (&ring, 0, i % 31, i / 31, X);
    for (gint k = 0; k < 3; k++) {
      e[k] = at[3 * i + k] - X[k];
      squared += e[k] * e[k];
    }
    sum += squared;
    variance += cov[6 * i] + cov[6 * i + 3] + cov[6 * i + 5];
    chi2 += normalised (cov + 6 * i, e) / 3;
    n++;
    n_three += states[i] == GST_CLOTH_VERTEX_MEASURED;
  }
  g_test_message
      ("%u of 1023 dots in space, %u of them seen by three or more: %.3f "
      "mm RMS, predicted %.3f; reduced chi2 %.2f", n, n_three,
      1000 * sqrt (sum / n), 1000 * sqrt (variance / n), chi2 / n);
  fail_unless (n > 900, "%u", n);
  fail_unless (1000 * sqrt (sum / n) <= MOST_RMS_MM);
  fail_unless (chi2 / n >= LEAST_CHI2 && chi2 / n <= MOST_CHI2);
  ring_close (&ring);

  /* Without pixels between detector and mesh it is the same to the bit. */
  {
    GstMapInfo a, b;

    fail_unless (gst_buffer_map (buffer, &a, GST_MAP_READ));
    fail_unless (gst_buffer_map (again, &b, GST_MAP_READ));
    fail_unless_equals_int (a.size, b.size);
    fail_unless (memcmp (a.data, b.data, a.size) == 0);
    gst_buffer_unmap (buffer, &a);
    gst_buffer_unmap (again, &b);
  }
}

GST_END_TEST;

static Suite *
dotring_mesh_suite (void)
{
  Suite *s = suite_create ("dotring-mesh");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_films);
  return s;
}

GST_CHECK_MAIN (dotring_mesh);
