/* A small sheet with the board to its very edges that swings before one camera, as in the
 * documents: every tracked corner against the vertex that it is said to be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <gst/app/gstappsink.h>
#include <gst/cloth/cloth.h>
#include <gst/gst.h>
#include <math.h>

#include "gst/take/take.h"

#define FOLDER TEST_DATA "/take_drag"
#define SIDE 9
#define N (SIDE * SIDE)
/* No corner is a pixel more off than the worst that a fold bends, and few are off at all. */
#define MOST_PX 2.
#define MOST_RMS_PX 0.13

/* A pinhole of 900 px, with world z up, at 1.3 m: s and c turn it about the sheet. */
typedef struct
{
  const gchar *name;
  gdouble c, s, t[3];
  guint least;                  /* squares tracked in all */
} View;

static const View views[] = {
  {"left", 0.6, 0.8, {-0.114, 1.3, 1.352}, 1100},
  {"front", 1, 0, {-0.19, 1.3, 1.2}, 1100},
};

static gchar *
write_file (const gchar * folder, const gchar * name, const gchar * text)
{
  gchar *path = g_build_filename (folder, name, NULL);
  GError *error = NULL;

  g_assert_true (g_file_set_contents (path, text, -1, &error));
  return path;
}

static GstElement *
launch (const View * view, const gchar * folder)
{
  g_autofree gchar *text = g_strdup_printf ("{\"version\": 1, \"cameras\": "
      "[{\"name\": \"it\", \"size\": [640, 480], \"K\": [[900, 0, 319.5], "
      "[0, 900, 239.5], [0, 0, 1]], \"distortion\": {\"model\": \"none\", "
      "\"coefficients\": []}, \"R\": [[%g, %g, 0], [0, 0, -1], [%g, %g, 0]], "
      "\"t\": [%g, %g, %g]}]}", view->c, view->s, -view->s, view->c,
      view->t[0], view->t[1], view->t[2]);
  g_autofree gchar *rig = write_file (folder, "rig.json", text);
  g_autofree gchar *pattern = write_file (folder, "pattern.json",
      "{\"version\": 1, \"pattern\": \"checker\", \"columns\": 8, \"rows\": 8, "
      "\"square_m\": 0.05, \"origin_uv_m\": [0, 0], \"cloth_m\": [0.4, 0.4], "
      "\"first_square\": \"black\"}");
  g_autofree gchar *pipeline = g_strdup_printf ("meshsrc location=" FOLDER
      " ! clothcamera rig=%s pattern=%s ! saddledetect ! quadtrack pattern=%s ! "
      "appsink name=out sync=false", rig, pattern, pattern);
  GError *error = NULL;
  GstElement *element = gst_parse_launch (pipeline, &error);

  g_assert_no_error (error);
  return element;
}

static void
project (const View * view, const gfloat X[3], gdouble px[2])
{
  gdouble x = view->c * X[0] + view->s * X[1] + view->t[0];
  gdouble y = -X[2] + view->t[1];
  gdouble z = -view->s * X[0] + view->c * X[1] + view->t[2];

  px[0] = 319.5 + 900 * x / z;
  px[1] = 239.5 + 900 * y / z;
}

static void
check_frame (const View * view, GstBuffer * buffer, const gfloat * places,
    guint * n_tracked, gdouble * sum)
{
  static const guint offsets[4] = { 0, 1, SIDE + 1, SIDE };
  guint n;
  const GstClothQuad *quads =
      gst_cloth_quads_get_quads (gst_buffer_get_cloth_quads (buffer), &n);

  for (guint i = 0; i < n; i++) {
    const guint first = (guint) (quads[i].row * SIDE + quads[i].column);

    if (quads[i].state != GST_CLOTH_QUAD_TRACKED)
      continue;
    (*n_tracked)++;
    for (guint k = 0; k < 4; k++) {
      gdouble px[2], square;

      project (view, places + 3 * (first + offsets[k]), px);
      square = pow (quads[i].x[k] - px[0], 2) + pow (quads[i].y[k] - px[1], 2);
      *sum += square / 2;
      if (square > MOST_PX * MOST_PX)
        g_error ("corner %u of square (%d, %d) is %.2f px off", k,
            quads[i].column, quads[i].row, sqrt (square));
    }
  }
}

static void
test_view (gconstpointer data)
{
  const View *view = data;
  GError *error = NULL;
  g_autofree gchar *folder = g_dir_make_tmp ("film-XXXXXX", &error);
  g_autofree gchar *rig = g_build_filename (folder, "rig.json", NULL);
  g_autofree gchar *pattern = g_build_filename (folder, "pattern.json", NULL);
  g_autoptr (ClothTake) take = cloth_take_open (FOLDER, &error);
  GstElement *pipeline = launch (view, folder);
  g_autoptr (GstElement) sink = gst_bin_get_by_name (GST_BIN (pipeline), "out");
  GstSample *sample;
  guint frame = 0, n = 0;
  gdouble sum = 0;

  g_assert_no_error (error);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  while ((sample = gst_app_sink_pull_sample (GST_APP_SINK (sink)))) {
    gfloat places[3 * N];

    g_assert_true (cloth_take_read_positions (take, frame++, places, &error));
    check_frame (view, gst_sample_get_buffer (sample), places, &n, &sum);
    gst_sample_unref (sample);
  }
  g_assert_cmpuint (frame, ==, cloth_take_get_n_frames (take));
  g_test_message ("%s: %u squares tracked, %.3f px RMS an axis", view->name,
      n, sqrt (sum / (4 * n)));
  g_assert_cmpuint (n, >=, view->least);
  g_assert_cmpfloat (sqrt (sum / (4 * n)), <=, MOST_RMS_PX);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
  g_remove (rig);
  g_remove (pattern);
  g_rmdir (folder);
}

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  for (guint i = 0; i < G_N_ELEMENTS (views); i++) {
    g_autofree gchar *path = g_strconcat ("/film/take/", views[i].name, NULL);

    g_test_add_data_func (path, &views[i], test_view);
  }
  return g_test_run ();
}
