/* A rig: up to 64 cameras in one world.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/rig.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"

/* How far R R' may be from the identity: a matrix typed with five digits passes. */
#define ROTATION_TOLERANCE 1e-4
/* Focal lengths as parts of the picture's longer side: wider than any fisheye, longer than any
 * telescope. */
#define MIN_FOCAL 0.01
#define MAX_FOCAL 1e4

GQuark
cloth_rig_error_quark (void)
{
  return g_quark_from_static_string ("cloth-rig-error-quark");
}

static const gchar *const lens_names[] = { "none", "brown5", "brown8",
  "fisheye"
};

/* @lens: a lens model
 *
 * Returns: its name in rig.json.
 */
const gchar *
cloth_lens_to_string (ClothLens lens)
{
  return lens_names[lens];
}

/* @name: a name as in rig.json
 * @lens: (out): the model
 *
 * Returns: %FALSE when there is no such model.
 */
gboolean
cloth_lens_from_string (const gchar * name, ClothLens * lens)
{
  for (guint i = 0; i < G_N_ELEMENTS (lens_names); i++) {
    if (g_str_equal (name, lens_names[i])) {
      *lens = (ClothLens) i;
      return TRUE;
    }
  }
  return FALSE;
}

/* @n_cameras: how many cameras
 *
 * Returns: (transfer full): a rig of pinhole cameras at the world's origin, their
 *   sizes and camera matrices not set.
 */
ClothRig *
cloth_rig_new (guint n_cameras)
{
  ClothRig *rig = g_new0 (ClothRig, 1);

  rig->n_cameras = n_cameras;
  rig->cameras = g_new0 (ClothCamera, n_cameras);
  for (guint i = 0; i < n_cameras; i++) {
    ClothCamera *c = &rig->cameras[i];

    c->K[8] = 1;
    c->R[0] = c->R[4] = c->R[8] = 1;
  }
  return rig;
}

/* @rig: (transfer full) (nullable): a rig
 */
void
cloth_rig_free (ClothRig * rig)
{
  if (!rig)
    return;
  for (guint i = 0; i < rig->n_cameras; i++)
    cloth_camera_clear (&rig->cameras[i]);
  g_free (rig->cameras);
  g_free (rig);
}

/* @rig: a rig
 * @name: a camera's name
 *
 * Returns: (nullable) (transfer none): the camera of that name.
 */
const ClothCamera *
cloth_rig_find (const ClothRig * rig, const gchar * name)
{
  for (guint i = 0; i < rig->n_cameras; i++) {
    if (g_strcmp0 (rig->cameras[i].name, name) == 0)
      return &rig->cameras[i];
  }
  return NULL;
}

/* @error: (out): set to %CLOTH_RIG_ERROR_VALUE
 * @where: what @key belongs to, "cameras[0]" for instance; "" for the whole file
 * @key: the key that is wrong; "" for all of @where
 * @format: what is wrong and how to mend it
 *
 * Returns: %FALSE, so that a check may end with it
 */
gboolean
cloth_rig_invalid (GError ** error, const gchar * where, const gchar * key,
    const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE, "%s%s%s: %s",
      where, *where && *key ? "." : "", key, text);
  return FALSE;
}

static gboolean
all_finite (const gdouble * values, guint n)
{
  for (guint i = 0; i < n; i++) {
    if (!isfinite (values[i]))
      return FALSE;
  }
  return TRUE;
}

/* A camera's name is also the name of files of a take. */
static gboolean
check_name (const gchar * name, const gchar * where, GError ** error)
{
  if (!name || !*name)
    return cloth_rig_invalid (error, where, "name", "is empty");
  if (!g_utf8_validate (name, -1, NULL))
    return cloth_rig_invalid (error, where, "name", "is not valid UTF-8");
  if (strlen (name) > 200)
    return cloth_rig_invalid (error, where, "name", "is longer than 200 bytes");
  for (const gchar * p = name; *p; p++) {
    if (*p == '/' || *p == '\\' || (guchar) * p < 32 || *p == 127)
      return cloth_rig_invalid (error, where, "name",
          "\"%s\" holds a slash or a control character; it must do as the "
          "name of a file", name);
  }
  if (g_str_equal (name, ".") || g_str_equal (name, ".."))
    return cloth_rig_invalid (error, where, "name",
        "\"%s\" can't be the name of a file", name);
  return TRUE;
}

/* Largest element of R R' − I. */
static gdouble
rotation_error (const gdouble R[9])
{
  gdouble worst = 0;

  for (gint i = 0; i < 9; i++) {
    const gdouble *a = R + i / 3 * 3, *b = R + i % 3 * 3;

    worst = fmax (worst, fabs (cloth_vec3_dot (a, b) - (i % 4 == 0)));
  }
  return worst;
}

static gboolean
check_camera (const ClothCamera * c, const gchar * where, GError ** error)
{
  const gdouble side = MAX (c->width, c->height);
  gdouble off;
  guint n = cloth_lens_n_coefficients (c->lens);

  if (!check_name (c->name, where, error))
    return FALSE;
  if (c->width < 1 || c->height < 1 || c->width > CLOTH_RIG_MAX_SIZE
      || c->height > CLOTH_RIG_MAX_SIZE)
    return cloth_rig_invalid (error, where, "size",
        "%d×%d; each must be between 1 and %d", c->width, c->height,
        CLOTH_RIG_MAX_SIZE);
  if (!all_finite (c->K, 9) || !all_finite (c->k, 8) || !all_finite (c->R, 9)
      || !all_finite (c->t, 3) || !all_finite (c->K_sd, 4)
      || !all_finite (c->k_sd, 8) || !all_finite (c->r_sd, 3)
      || !all_finite (c->t_sd, 3) || !isfinite (c->offset_sd)
      || !isfinite (c->rolling_shutter_s)
      || !isfinite (c->offset_s))
    return cloth_rig_invalid (error, where, "",
        "holds a number that is not finite");
  if (fabs (c->offset_s) > CLOTH_RIG_MAX_SECONDS
      || fabs (c->rolling_shutter_s) > CLOTH_RIG_MAX_SECONDS)
    return cloth_rig_invalid (error, where, "",
        "has an offset_s of %g s and a rolling_shutter_s of %g s; both must be "
        "within ±%g s", c->offset_s, c->rolling_shutter_s,
        CLOTH_RIG_MAX_SECONDS);
  if (!(MIN (c->K[0], c->K[4]) >= MIN_FOCAL * side)
      || !(MAX (c->K[0], c->K[4]) <= MAX_FOCAL * side))
    return cloth_rig_invalid (error, where, "K",
        "focal lengths %g and %g px; a picture %d px wide or high has %g to %g px",
        c->K[0], c->K[4], (gint) side, MIN_FOCAL * side, MAX_FOCAL * side);
  if (c->K[3] != 0 || c->K[6] != 0 || c->K[7] != 0 || c->K[8] != 1)
    return cloth_rig_invalid (error, where, "K",
        "must be [[fx, skew, cx], [0, fy, cy], [0, 0, 1]]");
  for (guint i = n; i < 8; i++) {
    if (c->k[i] != 0)
      return cloth_rig_invalid (error, where, "distortion",
          "%s has %u coefficients, but number %u is %g",
          cloth_lens_to_string (c->lens), n, i + 1, c->k[i]);
  }
  off = rotation_error (c->R);
  if (off > ROTATION_TOLERANCE)
    return cloth_rig_invalid (error, where, "R",
        "is not a rotation: R R' differs from the identity by %g", off);
  if (cloth_mat3_det (c->R) < 0)
    return cloth_rig_invalid (error, where, "R",
        "is a reflection, its determinant is -1");
  return TRUE;
}

/* @rig: a rig that passes cloth_rig_check()
 *
 * Rotations typed with few digits become exact to rounding; what is one already keeps
 * its bytes.
 */
void
cloth_rig_mend_rotations (ClothRig * rig)
{
  for (guint i = 0; i < rig->n_cameras; i++) {
    gdouble *R = rig->cameras[i].R;

    if (rotation_error (R) > 1e-14)
      cloth_mat3_nearest_rotation (R, R);
  }
}

/* @rig: a rig
 * @error: #ClothRigError, naming camera, key and value
 *
 * Checks what every rig must hold: 1 to 64 cameras, unique names that do as file names,
 * sizes of 1 to 16384 px, finite numbers, focal lengths of a hundredth to 10,000 times the
 * picture's longer side, rotations.
 *
 * Returns: whether all of it holds.
 */
gboolean
cloth_rig_check (const ClothRig * rig, GError ** error)
{
  if (rig->n_cameras < 1 || rig->n_cameras > CLOTH_RIG_MAX_CAMERAS)
    return cloth_rig_invalid (error, "", "cameras",
        "%u of them; 1 to %d are allowed", rig->n_cameras,
        CLOTH_RIG_MAX_CAMERAS);
  for (guint i = 0; i < rig->n_cameras; i++) {
    g_autofree gchar *where = g_strdup_printf ("cameras[%u]", i);

    if (!check_camera (&rig->cameras[i], where, error))
      return FALSE;
    for (guint j = 0; j < i; j++) {
      if (g_str_equal (rig->cameras[i].name, rig->cameras[j].name))
        return cloth_rig_invalid (error, where, "name",
            "\"%s\" is also the name of cameras[%u]", rig->cameras[i].name, j);
    }
  }
  return TRUE;
}
