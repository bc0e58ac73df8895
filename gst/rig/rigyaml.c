/* Import of calibrations made by OpenCV and Kalibr.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/rigyaml.h"

#include <math.h>
#include <string.h>

#include "gst/file/file.h"
#include "gst/math/linalg.h"
#include "gst/rig/rotation.h"
#include "gst/rig/yamltree.h"

/* OpenCV's longest: 8 rational, 4 thin prism, 2 tilt. */
#define MAX_COEFFICIENTS 14

/* A list of at most max numbers; nested lists are read row after row. */
static gboolean
read_numbers (const ClothYamlNode * node, const gchar * key, guint max,
    gdouble * values, guint * n, GError ** error)
{
  if (node->kind != CLOTH_YAML_SEQUENCE)
    return cloth_rig_invalid (error, "", key, "must be a list of numbers");
  for (guint i = 0; i < node->items->len; i++) {
    const ClothYamlNode *item = g_ptr_array_index (node->items, i);

    if (item->kind == CLOTH_YAML_SEQUENCE) {
      if (!read_numbers (item, key, max, values, n, error))
        return FALSE;
      continue;
    }
    if (*n == max)
      return cloth_rig_invalid (error, "", key, "holds more than %u numbers",
          max);
    if (!cloth_yaml_number (item, &values[*n]))
      return cloth_rig_invalid (error, "", key, "\"%s\" is not a finite number",
          item->kind == CLOTH_YAML_SCALAR ? item->text : "{…}");
    ++*n;
  }
  return TRUE;
}

/* An opencv-matrix: rows, cols, data. */
static gboolean
read_matrix (const ClothYamlNode * node, const gchar * key, guint max,
    gdouble * values, guint * n, GError ** error)
{
  gdouble rows, cols;
  const ClothYamlNode *data;

  if (node->kind == CLOTH_YAML_SEQUENCE)
    return read_numbers (node, key, max, values, n, error);
  data = cloth_yaml_get (node, "data");
  if (!data || !cloth_yaml_number (cloth_yaml_get (node, "rows"), &rows)
      || !cloth_yaml_number (cloth_yaml_get (node, "cols"), &cols))
    return cloth_rig_invalid (error, "", key,
        "must be a matrix with rows, cols and data");
  if (!read_numbers (data, key, max, values, n, error))
    return FALSE;
  if (rows * cols != *n)
    return cloth_rig_invalid (error, "", key,
        "says %g×%g but holds %u numbers", rows, cols, *n);
  return TRUE;
}

static gboolean
read_exactly (const ClothYamlNode * node, const gchar * key, guint n,
    gdouble * values, GError ** error)
{
  guint found = 0;

  if (!node)
    return cloth_rig_invalid (error, "", key, "is missing");
  if (!read_matrix (node, key, n, values, &found, error))
    return FALSE;
  if (found != n)
    return cloth_rig_invalid (error, "", key, "holds %u numbers, not %u", found,
        n);
  return TRUE;
}

/* A key in any of the files. */
static const ClothYamlNode *
look_up (GPtrArray * documents, const gchar * const *keys)
{
  for (guint i = 0; i < documents->len; i++) {
    for (guint j = 0; keys[j]; j++) {
      const ClothYamlNode *node =
          cloth_yaml_get (g_ptr_array_index (documents, i), keys[j]);

      if (node)
        return node;
    }
  }
  return NULL;
}

static gboolean
read_opencv_distortion (const ClothYamlNode * node, const gchar * key,
    gboolean fisheye, ClothCamera * c, GError ** error)
{
  gdouble k[MAX_COEFFICIENTS] = { 0, };
  guint n = 0;

  if (!node)
    return cloth_rig_invalid (error, "", key, "is missing");
  if (!read_matrix (node, key, MAX_COEFFICIENTS, k, &n, error))
    return FALSE;
  for (guint i = fisheye ? 4 : 8; i < n; i++) {
    if (k[i] != 0)
      return cloth_rig_invalid (error, "", key,
          "coefficient %u is %g; a %s lens of at most %d "
          "coefficients is known, without thin prism and tilt", i + 1, k[i],
          fisheye ? "fisheye" : "Brown", fisheye ? 4 : 8);
  }
  if (fisheye ? n != 4 : n != 0 && n != 4 && n != 5 && n != 8 && n != 12
      && n != 14)
    return cloth_rig_invalid (error, "", key, "holds %u coefficients; %s", n,
        fisheye ? "a fisheye has 4" : "OpenCV knows 4, 5, 8, 12 and 14");
  c->lens = fisheye ? CLOTH_LENS_FISHEYE : n == 0 ? CLOTH_LENS_NONE
      : n <= 5 ? CLOTH_LENS_BROWN5 : CLOTH_LENS_BROWN8;
  memcpy (c->k, k, sizeof c->k);
  return TRUE;
}

static gboolean
read_size (const ClothYamlNode * w, const ClothYamlNode * h, gint width,
    gint height, ClothCamera * c, GError ** error)
{
  gdouble size[2] = { width, height };

  if (w && h) {
    if (!cloth_yaml_number (w, &size[0]) || !cloth_yaml_number (h, &size[1]))
      return cloth_rig_invalid (error, "", "image_width, image_height",
          "must be numbers");
    if (width > 0 && (size[0] != width || size[1] != height))
      return cloth_rig_invalid (error, "", "image_width, image_height",
          "the file says %g×%g, not %d×%d", size[0], size[1], width, height);
  } else if (width <= 0 || height <= 0) {
    return cloth_rig_invalid (error, "", "image_width, image_height",
        "missing, and no picture size was given");
  }
  for (gint i = 0; i < 2; i++) {
    if (!(size[i] >= 1) || size[i] > CLOTH_RIG_MAX_SIZE
        || size[i] != floor (size[i]))
      return cloth_rig_invalid (error, "", "image_width, image_height",
          "%g must be a whole number between 1 and %d", size[i],
          CLOTH_RIG_MAX_SIZE);
  }
  c->width = (gint) size[0];
  c->height = (gint) size[1];
  return TRUE;
}

static gboolean
is_fisheye (GPtrArray * documents)
{
  static const gchar *const flag[] = { "fisheye_model", NULL };
  static const gchar *const model[] = { "distortion_model", NULL };
  const ClothYamlNode *node = look_up (documents, flag);
  gdouble value;

  if (node && cloth_yaml_number (node, &value) && value != 0)
    return TRUE;
  node = look_up (documents, model);
  return node && node->kind == CLOTH_YAML_SCALAR
      && (g_str_equal (node->text, "equidistant")
      || g_str_equal (node->text, "fisheye"));
}

static ClothRig *
finish (ClothRig * taken, GError ** error)
{
  g_autoptr (ClothRig) rig = taken;

  if (!cloth_rig_check (rig, error))
    return NULL;
  cloth_rig_mend_rotations (rig);
  return g_steal_pointer (&rig);
}

/* M1 D1 M2 D2 and R T, in one file or several. */
static ClothRig *
import_stereo (GPtrArray * documents, gint width, gint height, GError ** error)
{
  static const gchar *const m_keys[2][3] = { {"M1", "K1"}, {"M2", "K2"} };
  static const gchar *const d_keys[2][2] = { {"D1"}, {"D2"} };
  static const gchar *const w_keys[] = { "image_width", NULL };
  static const gchar *const h_keys[] = { "image_height", NULL };
  static const gchar *const r_keys[] = { "R", NULL };
  static const gchar *const t_keys[] = { "T", NULL };
  static const gchar *const names[] = { "left", "right" };
  g_autoptr (ClothRig) rig = cloth_rig_new (2);
  const ClothYamlNode *R = look_up (documents, r_keys);
  const ClothYamlNode *T = look_up (documents, t_keys);
  ClothCamera *second = &rig->cameras[1];

  for (guint i = 0; i < 2; i++) {
    ClothCamera *c = &rig->cameras[i];

    c->name = g_strdup (names[i]);
    if (!read_exactly (look_up (documents, m_keys[i]), m_keys[i][0], 9, c->K,
            error)
        || !read_opencv_distortion (look_up (documents, d_keys[i]),
            d_keys[i][0], is_fisheye (documents), c, error)
        || !read_size (look_up (documents, w_keys), look_up (documents,
                h_keys), width, height, c, error))
      return NULL;
  }
  if (!R || !T) {
    cloth_rig_invalid (error, "", R ? "T" : "R",
        "is missing; give the file with the extrinsics (R, T) too");
    return NULL;
  }
  /* R may be written as a rotation vector. */
  {
    guint n = 0;

    if (!read_matrix (R, "R", 9, second->R, &n, error))
      return NULL;
    if (n == 3) {
      gdouble r[3] = { second->R[0], second->R[1], second->R[2] };

      cloth_rotation_from_vector (r, second->R);
    } else if (n != 9) {
      cloth_rig_invalid (error, "", "R", "holds %u numbers, not 9 or 3", n);
      return NULL;
    }
  }
  if (!read_exactly (T, "T", 3, second->t, error))
    return NULL;
  return finish (g_steal_pointer (&rig), error);
}

static ClothRig *
import_opencv (GPtrArray * documents, const gchar * const *names, gint width,
    gint height, GError ** error)
{
  static const gchar *const m_keys[] = { "camera_matrix", "Camera_Matrix",
    "cameraMatrix", "K", NULL
  };
  static const gchar *const d_keys[] = { "distortion_coefficients",
    "Distortion_Coefficients", "distCoeffs", "D", NULL
  };
  static const gchar *const stereo[] = { "M1", "K1", NULL };
  static const gchar *const n_keys[] = { "camera_name", NULL };
  static const gchar *const w_keys[] = { "image_width", "image_Width", NULL };
  static const gchar *const h_keys[] = { "image_height", "image_Height", NULL };
  g_autoptr (ClothRig) rig = NULL;

  if (look_up (documents, stereo))
    return import_stereo (documents, width, height, error);
  rig = cloth_rig_new (documents->len);
  for (guint i = 0; i < documents->len; i++) {
    g_autoptr (GPtrArray) one = g_ptr_array_new ();
    ClothCamera *c = &rig->cameras[i];
    const ClothYamlNode *name;

    g_ptr_array_add (one, g_ptr_array_index (documents, i));
    name = look_up (one, n_keys);
    c->name = g_strdup (name && name->kind == CLOTH_YAML_SCALAR ? name->text
        : names[i]);
    if (!read_exactly (look_up (one, m_keys), m_keys[0], 9, c->K, error)
        || !read_opencv_distortion (look_up (one, d_keys), d_keys[0],
            is_fisheye (one), c, error)
        || !read_size (look_up (one, w_keys), look_up (one, h_keys), width,
            height, c, error))
      return NULL;
  }
  return finish (g_steal_pointer (&rig), error);
}

/* @paths: (array zero-terminated=1): files of one calibration
 * @width: picture width for files that don't say it, else 0
 * @height: picture height for files that don't say it, else 0
 * @error: #GFileError, #ClothFileError or #ClothRigError, naming key and value
 *
 * Reads what OpenCV's FileStorage writes as YAML. Either stereo files, whose keys M1, D1,
 * M2, D2, R and T may be spread over several files: cameras "left", at the world's origin,
 * and "right". Or files of one camera each (camera_matrix, distortion_coefficients,
 * image_width, image_height; ROS camera_info files too): cameras named camera_name or as
 * their files, all at the origin, since such files don't place them.
 *
 * Returns: (transfer full): the rig, or %NULL.
 */
ClothRig *
cloth_rig_import_opencv (const gchar * const *paths, gint width, gint height,
    GError ** error)
{
  g_autoptr (GPtrArray) documents =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_yaml_node_free);
  g_autoptr (GPtrArray) names = g_ptr_array_new_with_free_func (g_free);
  ClothRig *rig;

  for (guint i = 0; paths[i]; i++) {
    gsize length;
    g_autofree gchar *data = cloth_text_file_load (paths[i], &length, error);
    ClothYamlNode *root;
    gchar *name, *dot;

    if (!data)
      return NULL;
    if (!(root = cloth_yaml_parse (data, length, error))) {
      g_prefix_error (error, "%s: ", paths[i]);
      return NULL;
    }
    g_ptr_array_add (documents, root);
    name = g_path_get_basename (paths[i]);
    if ((dot = strrchr (name, '.')) && dot != name)
      *dot = 0;
    g_ptr_array_add (names, name);
  }
  rig = import_opencv (documents, (const gchar * const *) names->pdata, width,
      height, error);
  if (!rig)
    g_prefix_error (error, "%s: ", paths[0] ? paths[0] : "no file");
  return rig;
}

/* @data: the text of one file
 * @length: its bytes, at most 16 MiB
 * @width: as in cloth_rig_import_opencv()
 * @height: as in cloth_rig_import_opencv()
 * @error: #ClothRigError
 *
 * As cloth_rig_import_opencv(), from memory. A single camera is named "camera" unless the
 * file names it.
 *
 * Returns: (transfer full): the rig, or %NULL.
 */
ClothRig *
cloth_rig_import_opencv_data (const gchar * data, gsize length, gint width,
    gint height, GError ** error)
{
  static const gchar *const names[] = { "camera" };
  g_autoptr (GPtrArray) documents =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_yaml_node_free);
  ClothYamlNode *root = cloth_yaml_parse (data, length, error);

  if (!root)
    return NULL;
  g_ptr_array_add (documents, root);
  return import_opencv (documents, names, width, height, error);
}

static gboolean
text_of (const ClothYamlNode * camera, const gchar * key, const gchar * where,
    const gchar ** text, GError ** error)
{
  const ClothYamlNode *node = cloth_yaml_get (camera, key);

  if (!node || node->kind != CLOTH_YAML_SCALAR)
    return cloth_rig_invalid (error, where, key, "is missing or no text");
  *text = node->text;
  return TRUE;
}

static gboolean
list_of (const ClothYamlNode * camera, const gchar * key, const gchar * where,
    guint n, gdouble * values, GError ** error)
{
  g_autofree gchar *path = g_strdup_printf ("%s.%s", where, key);

  return read_exactly (cloth_yaml_get (camera, key), path, n, values, error);
}

static gboolean
read_kalibr_camera (const ClothYamlNode * node, const gchar * where,
    const ClothCamera * previous, ClothCamera * c, GError ** error)
{
  const gchar *model = "", *distortion = "";
  gdouble f[4], size[2], T[16];

  c->name = g_strdup (where);
  if (!text_of (node, "camera_model", where, &model, error)
      || !text_of (node, "distortion_model", where, &distortion, error))
    return FALSE;
  if (!g_str_equal (model, "pinhole"))
    return cloth_rig_invalid (error, where, "camera_model",
        "\"%s\"; only pinhole is known", model);
  if (g_str_equal (distortion, "radtan")) {
    c->lens = CLOTH_LENS_BROWN5;
  } else if (g_str_equal (distortion, "equidistant")) {
    c->lens = CLOTH_LENS_FISHEYE;
  } else if (g_str_equal (distortion, "none")) {
    c->lens = CLOTH_LENS_NONE;
  } else {
    return cloth_rig_invalid (error, where, "distortion_model",
        "\"%s\"; known are radtan, equidistant, none", distortion);
  }
  if (!list_of (node, "intrinsics", where, 4, f, error)
      || (c->lens != CLOTH_LENS_NONE
          && !list_of (node, "distortion_coeffs", where, 4, c->k, error))
      || !list_of (node, "resolution", where, 2, size, error))
    return FALSE;
  for (gint i = 0; i < 2; i++) {
    if (!(size[i] >= 1) || size[i] > CLOTH_RIG_MAX_SIZE
        || size[i] != floor (size[i])) {
      return cloth_rig_invalid (error, where, "resolution",
          "%g must be a whole number between 1 and %d", size[i],
          CLOTH_RIG_MAX_SIZE);
    }
  }
  c->width = (gint) size[0];
  c->height = (gint) size[1];
  c->K[0] = f[0];
  c->K[4] = f[1];
  c->K[2] = f[2];
  c->K[5] = f[3];
  if (!previous)
    return TRUE;
  if (!list_of (node, "T_cn_cnm1", where, 16, T, error))
    return FALSE;
  if (T[12] != 0 || T[13] != 0 || T[14] != 0 || T[15] != 1)
    return cloth_rig_invalid (error, where, "T_cn_cnm1",
        "its last row must be 0 0 0 1");
  /* From the previous camera's frame to the world's. */
  for (gint i = 0; i < 3; i++) {
    for (gint j = 0; j < 3; j++)
      c->R[3 * i + j] = T[4 * i] * previous->R[j]
          + T[4 * i + 1] * previous->R[3 + j]
          + T[4 * i + 2] * previous->R[6 + j];
    c->t[i] = T[4 * i] * previous->t[0] + T[4 * i + 1] * previous->t[1]
        + T[4 * i + 2] * previous->t[2] + T[4 * i + 3];
  }
  return TRUE;
}

/* @data: the text of a camchain file
 * @length: its bytes, at most 16 MiB
 * @error: #ClothRigError, naming key and value
 *
 * Reads Kalibr's camera chain: cam0, cam1 … with camera_model pinhole, distortion_model
 * radtan, equidistant or none, intrinsics, distortion_coeffs, resolution, and T_cn_cnm1
 * from the second on. The world is the frame of cam0.
 *
 * Returns: (transfer full): the rig, or %NULL.
 */
ClothRig *
cloth_rig_import_kalibr_data (const gchar * data, gsize length, GError ** error)
{
  g_autoptr (ClothYamlNode) root = cloth_yaml_parse (data, length, error);
  g_autoptr (ClothRig) rig = NULL;
  guint n = 0;

  if (!root)
    return NULL;
  for (;; n++) {
    g_autofree gchar *key = g_strdup_printf ("cam%u", n);

    if (!cloth_yaml_get (root, key))
      break;
    if (n == CLOTH_RIG_MAX_CAMERAS) {
      cloth_rig_invalid (error, "", key, "more than %d cameras",
          CLOTH_RIG_MAX_CAMERAS);
      return NULL;
    }
  }
  if (n == 0) {
    cloth_rig_invalid (error, "", "cam0",
        "is missing; this is no Kalibr camera chain");
    return NULL;
  }
  rig = cloth_rig_new (n);
  for (guint i = 0; i < n; i++) {
    g_autofree gchar *key = g_strdup_printf ("cam%u", i);

    if (!read_kalibr_camera (cloth_yaml_get (root, key), key,
            i ? &rig->cameras[i - 1] : NULL, &rig->cameras[i], error))
      return NULL;
  }
  return finish (g_steal_pointer (&rig), error);
}

/* @path: a camchain file
 * @error: #GFileError, #ClothFileError or #ClothRigError
 *
 * As cloth_rig_import_kalibr_data(), from a file.
 *
 * Returns: (transfer full): the rig, or %NULL.
 */
ClothRig *
cloth_rig_import_kalibr (const gchar * path, GError ** error)
{
  gsize length;
  g_autofree gchar *data = cloth_text_file_load (path, &length, error);
  ClothRig *rig;

  if (!data)
    return NULL;
  rig = cloth_rig_import_kalibr_data (data, length, error);
  if (!rig)
    g_prefix_error (error, "%s: ", path);
  return rig;
}
