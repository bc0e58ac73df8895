/* The table that gst-cloth-calibrate-1.0 prints.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "calibrate-report.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"
#include "gst/rig/rotation.h"

/* @lens: a lens model
 * @i: one of its coefficients
 *
 * Returns: its name.
 */
const gchar *
cloth_calibrate_coefficient_name (ClothLens lens, guint i)
{
  static const gchar *const brown[] = { "k1", "k2", "p1", "p2", "k3", "k4",
    "k5", "k6"
  };
  static const gchar *const fisheye[] = { "k1", "k2", "k3", "k4" };

  return lens == CLOTH_LENS_FISHEYE ? fisheye[i] : brown[i];
}

static void
add_rms (GString * s, const gchar * text, gdouble rms)
{
  if (isnan (rms))
    g_string_append_printf (s, "%s –", text);
  else
    g_string_append_printf (s, "%s %.3f px", text, rms);
}

/* Where a camera is, seen from the first one. */
static void
add_place (GString * s, const ClothCamera * first, const ClothCamera * camera)
{
  gdouble R[9], r[3], Rt[3], t[3], angle;

  cloth_mat3_mul_nt (camera->R, first->R, R);
  cloth_mat3_vec (R, first->t, Rt);
  cloth_rotation_to_vector (R, r);
  cloth_vec3_subtract (camera->t, Rt, t);
  angle = cloth_vec3_length (r);
  g_string_append_printf (s, "  from %s: %.1f mm away, turned by %.3f°\n",
      first->name, 1e3 * cloth_vec3_length (t), angle * 180 / G_PI);
  for (guint i = 0; i < 3; i++)
    g_string_append_printf (s, "    r%c  %12.6f ± %-10.2g rad    "
        "t%c  %12.4f ± %-8.2g mm\n", "xyz"[i], r[i], camera->r_sd[i],
        "xyz"[i], 1e3 * t[i], 1e3 * camera->t_sd[i]);
}

/* A distortion fitted where the board was may fold back elsewhere. */
static void
add_reach (GString * s, const ClothCamera * camera)
{
  enum
  { COLUMNS = 41, ROWS = 31 };
  gdouble x[COLUMNS * ROWS], y[COLUMNS * ROWS];
  guint n;

  for (guint i = 0; i < COLUMNS * ROWS; i++) {
    x[i] = (camera->width - 1.) * (i % COLUMNS) / (COLUMNS - 1);
    y[i] = (camera->height - 1.) * (i / COLUMNS) / (ROWS - 1);
  }
  n = cloth_camera_undistort_points (camera, COLUMNS * ROWS, x, y, x, y, NULL);
  if (n < COLUMNS * ROWS)
    g_string_append_printf (s, "  the lens is known over %.0f%% of the picture "
        "only: bring the board to its corners, or take a lens model of fewer "
        "coefficients\n", floor (100. * n / (COLUMNS * ROWS)));
}

static void
add_uncertainty (GString * s, const ClothUncertaintyMap * map)
{
  static const guint nodes[] = { CLOTH_UNCERTAINTY_NODES / 2, 0,
    CLOTH_UNCERTAINTY_COLUMNS - 1,
    CLOTH_UNCERTAINTY_NODES - CLOTH_UNCERTAINTY_COLUMNS,
    CLOTH_UNCERTAINTY_NODES - 1
  };

  g_string_append (s, "  projection ± px, 1σ  centre   top left  top right "
      "bottom left  bottom right\n");
  for (guint far = 0; far < 2; far++) {
    g_autofree gchar *where = far ? g_strdup ("at infinity")
        : g_strdup_printf ("at %.2f m", map->distance);

    g_string_append_printf (s, "    %-16s", where);
    for (guint i = 0; i < G_N_ELEMENTS (nodes); i++) {
      gdouble sigma = (far ? map->far : map->near)[nodes[i]];

      if (isnan (sigma))
        g_string_append_printf (s, "%11s", "unknown");
      else
        g_string_append_printf (s, "%11.*f", sigma < 1 ? 3 : 2, sigma);
    }
    g_string_append_c (s, '\n');
  }
}

/* Where the picture is known badly, in words. */
static const gchar *
side (const gdouble away[2])
{
  gboolean across = fabs (away[0]) >= fabs (away[1]);

  if (hypot (away[0], away[1]) < 0.1)
    return "all around";
  return across ? away[0] < 0 ? "mostly at the left" : "mostly at the right"
      : away[1] < 0 ? "mostly at the top" : "mostly at the bottom";
}

/* @result: a calibration
 * @camera: one of its cameras
 *
 * Returns: (transfer full) (element-type utf8): why its numbers are not to be trusted, and
 *   what to do about it; empty when there is no reason
 */
GPtrArray *
cloth_calibrate_warnings (const ClothCalibration * result, guint camera)
{
  GPtrArray *warnings = g_ptr_array_new_with_free_func (g_free);
  const ClothCalibrateCamera *c = &result->cameras[camera];
  guint least = cloth_uncertainty_least_views ();
  gdouble noise = c->rms / sqrt (2), away[2], share;

  if (c->n_views < least)
    g_ptr_array_add (warnings, g_strdup_printf ("%u views are too few to show "
            "whether errors are %d times the ± here; take %u at least, better "
            "ten or more", c->n_views, CLOTH_UNCERTAINTY_MISSED, least));
  if (cloth_uncertainty_disagrees (&c->map, c->n_views))
    g_ptr_array_add (warnings, g_strdup_printf ("the views disagree: leave one "
            "out, and the camera moves %.1f times as far as the ± here allow; "
            "take them times that, see that the board is flat%s and held still, "
            "or add views", c->map.disagreement,
            result->warp_sd[0] > 0 ? "" : " (else give --warp)"));
  share = cloth_uncertainty_thin (&c->map, noise, away);
  /* A single node is a corner pixel. */
  if (share * CLOTH_UNCERTAINTY_NODES >= 2)
    g_ptr_array_add (warnings, g_strdup_printf ("over %.*f%% of the picture, "
            "%s, a projection is less certain than a corner is seen (%.2f px): "
            "bring the board there", share < 0.01, 100 * share, side (away),
            noise));
  return warnings;
}

static void
add_camera (GString * s, const ClothCalibration * result, guint c,
    const ClothShotCamera * shots)
{
  static const gchar *const k_names[] = { "fx", "fy", "cx", "cy" };
  static const guint k_index[] = { 0, 4, 2, 5 };
  const ClothCamera *camera = &result->rig->cameras[c];
  const ClothCalibrateCamera *quality = &result->cameras[c];
  g_autoptr (GPtrArray) warnings = NULL;

  g_string_append_printf (s,
      "\ncamera %s: %d×%d, %s lens; board found in %u of "
      "%u pictures, %u views and %u corners used", camera->name,
      camera->width, camera->height, cloth_lens_to_string (camera->lens),
      shots->shots->len, shots->n_pictures, quality->n_views,
      quality->n_points);
  if (result->placed && result->rig->n_cameras > 1)
    g_string_append_printf (s, ", %u views shared with other cameras%s",
        quality->n_shared,
        quality->n_shared < 3 ? " – too few to check" : "");
  g_string_append_c (s, '\n');
  add_rms (s, "  RMS", quality->rms);
  add_rms (s, ", on views left out of the fit", quality->left_out_rms);
  g_string_append_printf (s, ", scatter beyond that of the corners %.3f px\n",
      quality->excess);
  if (quality->n_outliers)
    g_string_append_printf (s, "  outliers: %u corner%s, of little weight in "
        "the fit\n", quality->n_outliers, quality->n_outliers > 1 ? "s" : "");
  for (guint i = 0; i < 4; i++)
    g_string_append_printf (s, "    %s  %12.4f ± %-8.2g px\n", k_names[i],
        camera->K[k_index[i]], camera->K_sd[i]);
  for (guint i = 0; i < cloth_lens_n_coefficients (camera->lens); i++)
    g_string_append_printf (s, "    %s  %12.6f ± %.2g\n",
        cloth_calibrate_coefficient_name (camera->lens, i), camera->k[i],
        camera->k_sd[i]);
  add_uncertainty (s, &quality->map);
  add_reach (s, camera);
  warnings = cloth_calibrate_warnings (result, c);
  for (guint i = 0; i < warnings->len; i++)
    g_string_append_printf (s, "  warning: %s\n",
        (const gchar *) g_ptr_array_index (warnings, i));
  if (result->placed && c > 0)
    add_place (s, &result->rig->cameras[0], camera);
}

/* @input: what was calibrated
 * @result: what came of it
 * @view: which view
 *
 * Returns: how many of its corners are outliers.
 */
guint
cloth_calibrate_view_outliers (const ClothCalibrateInput * input,
    const ClothCalibration * result, guint view)
{
  guint first = 0, n = 0;

  for (guint v = 0; v < view; v++)
    first += input->views[v].n;
  for (guint i = 0; i < input->views[view].n; i++)
    n += result->outlier[first + i];
  return n;
}

static void
add_view (GString * s, const ClothCalibrateInput * in,
    const ClothCalibration * result, const ClothShotCamera * camera, guint v,
    guint shot)
{
  guint n_outliers = cloth_calibrate_view_outliers (in, result, v);
  const ClothShot *picture = g_ptr_array_index (camera->shots, shot);

  if (isnan (result->view_rms[v]))
    g_string_append_printf (s, "  %-12s %-24s unused, %u corners\n",
        camera->name, picture->label, in->views[v].n);
  else
    g_string_append_printf (s, "  %-12s %-24s %.3f of %u", camera->name,
        picture->label, result->view_rms[v], in->views[v].n);
  if (n_outliers)
    g_string_append_printf (s, ", %u outlier%s", n_outliers,
        n_outliers > 1 ? "s" : "");
  if (!isnan (result->view_rms[v]))
    g_string_append_c (s, '\n');
}

/* Together what was seen together. */
static void
add_views (GString * s, const ClothCalibrateInput * in,
    const ClothCalibration * result, GPtrArray * cameras)
{
  g_string_append (s, "\nviews: RMS, px, of the corners used\n");
  for (guint p = 0; p < (result->placed ? in->n_poses : 1); p++) {
    for (guint v = 0, shot = 0; v < in->n_views; v++) {
      const ClothBundleView *view = &in->views[v];

      shot = v > 0 && view->camera == view[-1].camera ? shot + 1 : 0;
      if (!result->placed || view->pose == p)
        add_view (s, in, result, g_ptr_array_index (cameras, view->camera), v,
            shot);
    }
  }
}

/* @input: what was calibrated; views camera by camera, in the order of the shots
 * @result: what came of it
 * @cameras: (element-type ClothShotCamera): where it came from
 *
 * Returns: (transfer full): RMS, parameters with standard deviations, and views, for people.
 */
gchar *
cloth_calibrate_report (const ClothCalibrateInput * input,
    const ClothCalibration * result, GPtrArray * cameras)
{
  GString *s = g_string_new (NULL);

  add_rms (s, "RMS", result->rms);
  add_rms (s, ", on views left out of the fit", result->left_out_rms);
  g_string_append_printf (s,
      "; variance of the residuals %.2f times the expected one\n",
      result->variance);
  if (result->variance > CLOTH_CALIBRATE_MAX_VARIANCE)
    g_string_append (s, "The views contradict each other: don't use this rig. "
        "Check that the board has these squares, first one included, and is "
        "flat; take out pictures of great RMS below.\n");
  if (result->warp_sd[0] > 0)
    g_string_append_printf (s, "the board's middle is %.3f ± %.2g mm off the "
        "plane of its rim by a bend along the rows, %.3f ± %.2g mm by one along "
        "the columns\n", 1e3 * result->warp[0], 1e3 * result->warp_sd[0],
        1e3 * result->warp[1], 1e3 * result->warp_sd[1]);
  if (!result->placed)
    g_string_append (s, "Intrinsics only: the cameras were not placed; all "
        "stand at the origin.\n");
  for (guint c = 0; c < input->n_cameras; c++)
    add_camera (s, result, c, g_ptr_array_index (cameras, c));
  add_views (s, input, result, cameras);
  return g_string_free (s, FALSE);
}
