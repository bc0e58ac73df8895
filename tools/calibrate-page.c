/* The page that shows a calibration.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "calibrate-page.h"

#include <math.h>

#include "calibrate-report.h"
#include "gst/file/jsonwriter.h"
#include "gst/gap/report/page.h"
#include "gst/math/statistics.h"

/* So many views are shown as pictures, the worst first; with that a page has about 2 MB. */
#define MOST_PICTURES 24

/* What is well below what can be seen is left out of the file. */
#define DIGITS(x, scale) (round ((x) * (scale)) / (scale))

static void
put_rounded (ClothJsonWriter * w, const gchar * key, const gdouble * values,
    gsize n, gdouble scale)
{
  g_autofree gdouble *rounded = g_new (gdouble, n + 1);

  for (gsize i = 0; i < n; i++)
    rounded[i] = DIGITS (values[i], scale);
  cloth_json_writer_begin_array (w, key);
  for (gsize i = 0; i < n; i++)
    cloth_json_writer_number (w, NULL, rounded[i]);
  cloth_json_writer_end_array (w);
}

static void
put_parameters (ClothJsonWriter * w, const ClothCamera * camera)
{
  static const gchar *const k_names[] = { "fx", "fy", "cx", "cy" };
  static const guint k_index[] = { 0, 4, 2, 5 };
  guint n = 4 + cloth_lens_n_coefficients (camera->lens);

  cloth_json_writer_begin_array (w, "parameters");
  for (guint i = 0; i < n; i++) {
    cloth_json_writer_begin_object (w, NULL);
    cloth_json_writer_string (w, "name", i < 4 ? k_names[i]
        : cloth_calibrate_coefficient_name (camera->lens, i - 4));
    cloth_json_writer_number (w, "value", i < 4 ? camera->K[k_index[i]]
        : camera->k[i - 4]);
    cloth_json_writer_number (w, "sd", i < 4 ? camera->K_sd[i]
        : camera->k_sd[i - 4]);
    cloth_json_writer_end_object (w);
  }
  cloth_json_writer_end_array (w);
}

static void
put_camera (ClothJsonWriter * w, const ClothCalibration * result, guint c,
    const ClothShotCamera * shots)
{
  const ClothCamera *camera = &result->rig->cameras[c];
  const ClothCalibrateCamera *quality = &result->cameras[c];
  g_autoptr (GPtrArray) warnings = cloth_calibrate_warnings (result, c);

  cloth_json_writer_begin_object (w, NULL);
  cloth_json_writer_string (w, "name", camera->name);
  cloth_json_writer_count (w, "width", (guint) camera->width);
  cloth_json_writer_count (w, "height", (guint) camera->height);
  cloth_json_writer_string (w, "lens", cloth_lens_to_string (camera->lens));
  put_parameters (w, camera);
  cloth_json_writer_numbers (w, "R", camera->R, 9);
  cloth_json_writer_numbers (w, "t", camera->t, 3);
  cloth_json_writer_count (w, "pictures", shots->n_pictures);
  cloth_json_writer_count (w, "views", quality->n_views);
  cloth_json_writer_count (w, "corners", quality->n_points);
  cloth_json_writer_count (w, "outliers", quality->n_outliers);
  cloth_json_writer_number (w, "rms", quality->rms);
  cloth_json_writer_number (w, "left_out_rms", quality->left_out_rms);
  cloth_json_writer_number (w, "excess", quality->excess);
  cloth_json_writer_number (w, "distance", quality->map.distance);
  cloth_json_writer_count (w, "columns", CLOTH_UNCERTAINTY_COLUMNS);
  put_rounded (w, "near", quality->map.near, CLOTH_UNCERTAINTY_NODES, 1e4);
  put_rounded (w, "far", quality->map.far, CLOTH_UNCERTAINTY_NODES, 1e4);
  cloth_json_writer_begin_array (w, "warnings");
  for (guint i = 0; i < warnings->len; i++)
    cloth_json_writer_string (w, NULL, g_ptr_array_index (warnings, i));
  cloth_json_writer_end_array (w);
  cloth_json_writer_end_object (w);
}

static void
put_view (ClothJsonWriter * w, const ClothCalibrateInput * in,
    const ClothCalibration * result, guint v, guint first,
    const ClothShot * shot, gboolean picture)
{
  const ClothBundleView *view = &in->views[v];

  cloth_json_writer_begin_object (w, NULL);
  cloth_json_writer_count (w, "camera", view->camera);
  cloth_json_writer_count (w, "pose", view->pose);
  cloth_json_writer_string (w, "label", shot->label);
  cloth_json_writer_number (w, "rms", result->view_rms[v]);
  put_rounded (w, "x", view->x, view->n, 1e2);
  put_rounded (w, "y", view->y, view->n, 1e2);
  put_rounded (w, "dx", result->dx + first, view->n, 1e4);
  put_rounded (w, "dy", result->dy + first, view->n, 1e4);
  cloth_json_writer_begin_array (w, "outliers");
  for (guint i = 0; i < view->n; i++) {
    if (result->outlier[first + i])
      cloth_json_writer_count (w, NULL, i);
  }
  cloth_json_writer_end_array (w);
  if (picture && shot->picture) {
    g_autofree gchar *text =
        g_base64_encode (g_bytes_get_data (shot->picture, NULL),
        g_bytes_get_size (shot->picture));

    cloth_json_writer_string (w, "picture", text);
  }
  cloth_json_writer_end_object (w);
}

/* Of the views in use the MOST_PICTURES-th greatest RMS. */
static gdouble
least_shown (const ClothCalibrateInput * in, const ClothCalibration * result)
{
  g_autoptr (GArray) all = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint v = 0; v < in->n_views; v++) {
    if (!isnan (result->view_rms[v]))
      g_array_append_val (all, result->view_rms[v]);
  }
  g_array_sort (all, cloth_compare_doubles);
  return all->len > MOST_PICTURES
      ? g_array_index (all, gdouble, all->len - MOST_PICTURES) : 0;
}

static gchar *
to_json (const ClothCalibrateInput * in, const ClothCalibration * result,
    const ClothPattern * pattern, GPtrArray * cameras)
{
  ClothJsonWriter *w = cloth_json_writer_new ();
  gdouble least = least_shown (in, result);

  cloth_json_writer_begin_object (w, NULL);
  cloth_json_writer_count (w, "columns", (guint) pattern->columns);
  cloth_json_writer_count (w, "rows", (guint) pattern->rows);
  cloth_json_writer_number (w, "square_m", pattern->square_m);
  cloth_json_writer_number (w, "rms", result->rms);
  cloth_json_writer_number (w, "left_out_rms", result->left_out_rms);
  cloth_json_writer_number (w, "variance", result->variance);
  if (result->warp_sd[0] > 0) {
    cloth_json_writer_numbers (w, "warp", result->warp, 2);
    cloth_json_writer_numbers (w, "warp_sd", result->warp_sd, 2);
  }
  cloth_json_writer_boolean (w, "contradict",
      result->variance > CLOTH_CALIBRATE_MAX_VARIANCE);
  cloth_json_writer_boolean (w, "placed", result->placed);
  cloth_json_writer_begin_array (w, "cameras");
  for (guint c = 0; c < in->n_cameras; c++)
    put_camera (w, result, c, g_ptr_array_index (cameras, c));
  cloth_json_writer_end_array (w);
  cloth_json_writer_begin_array (w, "poses");
  for (guint p = 0; p < in->n_poses; p++)
    put_rounded (w, NULL, result->poses + 12 * (gsize) p, 12, 1e6);
  cloth_json_writer_end_array (w);
  cloth_json_writer_begin_array (w, "views");
  for (guint v = 0, shot = 0, first = 0; v < in->n_views; v++) {
    const ClothBundleView *view = &in->views[v];
    const ClothShotCamera *camera = g_ptr_array_index (cameras, view->camera);

    shot = v > 0 && view->camera == view[-1].camera ? shot + 1 : 0;
    put_view (w, in, result, v, first, g_ptr_array_index (camera->shots, shot),
        result->view_rms[v] >= least);
    first += view->n;
  }
  cloth_json_writer_end_array (w);
  cloth_json_writer_end_object (w);
  return cloth_json_writer_finish (w);
}

/* @input: what was calibrated; views camera by camera, in the order of the shots
 * @result: what came of it
 * @pattern: the board
 * @cameras: (element-type ClothShotCamera): where it came from
 * @path: where the page shall be
 * @error: #GIOErrorEnum
 *
 * Writes a page that shows the calibration. It needs no other file and no network, and
 * appears whole or not at all.
 *
 * Returns: whether it is there
 */
gboolean
cloth_calibrate_page_write (const ClothCalibrateInput * input,
    const ClothCalibration * result, const ClothPattern * pattern,
    GPtrArray * cameras, const gchar * path, GError ** error)
{
  g_autofree gchar *json = to_json (input, result, pattern, cameras);
  g_autofree gchar *title = g_strdup_printf ("Calibration of %u camera%s: "
      "RMS %.3f px", input->n_cameras, input->n_cameras > 1 ? "s" : "",
      result->rms);
  const ClothPagePart part = { "calibration-data", json };

  return cloth_page_write (path, "calibration", title,
      "The program printed its numbers, and rig.json holds the cameras.", &part,
      1, error);
}
