/* mrcal's .cameramodel files, one a camera.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/cameramodel.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/file/file.h"
#include "gst/file/output.h"
#include "gst/rig/rotation.h"
#include "gst/rig/yamltree.h"

/* fx fy cx cy and OpenCV's twelve. */
#define MAX_INTRINSICS 16

static const struct
{
  const gchar *name;
  ClothLens lens;
  guint n;                      /* coefficients in the file */
} models[] = {
  {"LENSMODEL_PINHOLE", CLOTH_LENS_NONE, 0},
  {"LENSMODEL_OPENCV4", CLOTH_LENS_BROWN5, 4},
  {"LENSMODEL_OPENCV5", CLOTH_LENS_BROWN5, 5},
  {"LENSMODEL_OPENCV8", CLOTH_LENS_BROWN8, 8},
};

/* The file is a literal of Python, which YAML understands but for the bytes b'…' in which
 * mrcal keeps what a camera was calibrated from: they become blanks. */
static gchar *
without_bytes (const gchar * data, gsize length)
{
  gchar *text = g_strndup (length ? data : "", length);
  gchar quote = 0;
  gboolean comment = FALSE;

  for (gchar * p = text; *p; p++) {
    if (comment) {
      comment = *p != '\n';
    } else if (quote) {
      if (*p == quote)
        quote = 0;
    } else if (*p == '#') {
      comment = TRUE;
    } else if (*p == 'b' && (p[1] == '\'' || p[1] == '"')) {
      gchar *end = strchr (p + 2, p[1]);

      if (!end)
        break;
      *p++ = '0';
      memset (p, ' ', (gsize) (end - p) + 1);
      p = end;
    } else if (*p == '\'' || *p == '"') {
      quote = *p;
    }
  }
  return text;
}

static gboolean
read_list (const ClothYamlNode * root, const gchar * key, guint max,
    gdouble * values, guint * n, GError ** error)
{
  const ClothYamlNode *node = cloth_yaml_get (root, key);

  if (!node || node->kind != CLOTH_YAML_SEQUENCE)
    return cloth_rig_invalid (error, "", key, "is missing or no list");
  if (node->items->len > max)
    return cloth_rig_invalid (error, "", key, "holds more than %u numbers",
        max);
  *n = node->items->len;
  for (guint i = 0; i < *n; i++) {
    if (!cloth_yaml_number (g_ptr_array_index (node->items, i), &values[i]))
      return cloth_rig_invalid (error, "", key,
          "its number %u is not a finite one", i + 1);
  }
  return TRUE;
}

static gboolean
read_exactly (const ClothYamlNode * root, const gchar * key, guint n,
    gdouble * values, GError ** error)
{
  guint found = 0;

  if (!read_list (root, key, n, values, &found, error))
    return FALSE;
  return found == n || cloth_rig_invalid (error, "", key,
      "holds %u numbers, not %u", found, n);
}

static gboolean
read_lens (const ClothYamlNode * root, ClothCamera * c, GError ** error)
{
  const ClothYamlNode *node = cloth_yaml_get (root, "lensmodel");
  gdouble values[MAX_INTRINSICS];

  if (!node || node->kind != CLOTH_YAML_SCALAR)
    return cloth_rig_invalid (error, "", "lensmodel",
        "is missing: this is no .cameramodel, which has a LENSMODEL_…");
  for (guint i = 0; i < G_N_ELEMENTS (models); i++) {
    if (!g_str_equal (node->text, models[i].name))
      continue;
    if (!read_exactly (root, "intrinsics", 4 + models[i].n, values, error))
      return FALSE;
    c->lens = models[i].lens;
    c->K[0] = values[0];
    c->K[4] = values[1];
    c->K[2] = values[2];
    c->K[5] = values[3];
    memcpy (c->k, values + 4, models[i].n * sizeof (gdouble));
    return TRUE;
  }
  return cloth_rig_invalid (error, "", "lensmodel",
      "\"%.40s\"; known are LENSMODEL_PINHOLE, _OPENCV4, _OPENCV5 and _OPENCV8: "
      "mrcal-convert-lensmodel makes one of them", node->text);
}

static gboolean
read_camera (const ClothYamlNode * root, ClothCamera * c, GError ** error)
{
  gdouble size[2], rt[6];

  if (!read_lens (root, c, error)
      || !read_exactly (root, "imagersize", 2, size, error)
      || !read_exactly (root, "extrinsics", 6, rt, error))
    return FALSE;
  for (gint i = 0; i < 2; i++) {
    if (!(size[i] >= 1) || size[i] > CLOTH_RIG_MAX_SIZE
        || size[i] != floor (size[i]))
      return cloth_rig_invalid (error, "", "imagersize",
          "%g must be a whole number between 1 and %d", size[i],
          CLOTH_RIG_MAX_SIZE);
  }
  for (gint i = 0; i < 3; i++) {
    if (fabs (rt[i]) > 1e3)
      return cloth_rig_invalid (error, "", "extrinsics",
          "%g is no angle in radians", rt[i]);
  }
  c->width = (gint) size[0];
  c->height = (gint) size[1];
  cloth_rotation_from_vector (rt, c->R);
  memcpy (c->t, rt + 3, sizeof c->t);
  return TRUE;
}

static gboolean
read_into (const gchar * data, gsize length, ClothCamera * c, GError ** error)
{
  g_autofree gchar *text = without_bytes (data, length);
  g_autoptr (ClothYamlNode) root = cloth_yaml_parse (text, strlen (text),
      error);

  return root && read_camera (root, c, error);
}

/* @data: the text of a .cameramodel file
 * @length: its bytes, at most 16 MiB
 * @error: #ClothRigError, naming key and value
 *
 * Reads a camera of mrcal: lensmodel LENSMODEL_PINHOLE, _OPENCV4, _OPENCV5 or _OPENCV8,
 * intrinsics, imagersize, and extrinsics, a rotation vector and a translation from the
 * reference to the camera. The world is mrcal's reference.
 *
 * Returns: (transfer full): a rig of one camera, or %NULL.
 */
ClothRig *
cloth_rig_import_mrcal_data (const gchar * data, gsize length, GError ** error)
{
  g_autoptr (ClothRig) rig = cloth_rig_new (1);

  rig->cameras[0].name = g_strdup ("camera");
  if (!read_into (data, length, &rig->cameras[0], error)
      || !cloth_rig_check (rig, error))
    return NULL;
  return g_steal_pointer (&rig);
}

/* @paths: (array zero-terminated=1): .cameramodel files of one reference, one a camera,
 *   which is named as its file is
 * @error: #GFileError, #ClothFileError or #ClothRigError
 *
 * As cloth_rig_import_mrcal_data(), from files.
 *
 * Returns: (transfer full): the rig, or %NULL.
 */
ClothRig *
cloth_rig_import_mrcal (const gchar * const *paths, GError ** error)
{
  guint n = g_strv_length ((gchar **) paths);
  g_autoptr (ClothRig) rig = NULL;

  if (n < 1 || n > CLOTH_RIG_MAX_CAMERAS) {
    cloth_rig_invalid (error, "", "", "%u files; 1 to %d are allowed", n,
        CLOTH_RIG_MAX_CAMERAS);
    return NULL;
  }
  rig = cloth_rig_new (n);
  for (guint i = 0; i < n; i++) {
    gsize length;
    g_autofree gchar *data = cloth_text_file_load (paths[i], &length, error);
    gchar *dot;

    if (!data)
      return NULL;
    rig->cameras[i].name = g_path_get_basename (paths[i]);
    dot = strrchr (rig->cameras[i].name, '.');
    if (dot && dot != rig->cameras[i].name)
      *dot = 0;
    if (!read_into (data, length, &rig->cameras[i], error)) {
      g_prefix_error (error, "%s: ", paths[i]);
      return NULL;
    }
  }
  return cloth_rig_check (rig, error) ? g_steal_pointer (&rig) : NULL;
}

static void
add_numbers (GString * s, const gchar * key, const gdouble * values, guint n)
{
  g_string_append_printf (s, "    '%s': [", key);
  for (guint i = 0; i < n; i++) {
    gchar number[G_ASCII_DTOSTR_BUF_SIZE];

    g_string_append_printf (s, " %s,", g_ascii_dtostr (number, sizeof number,
            values[i]));
  }
  g_string_append (s, " ],\n");
}

/* @camera: a camera
 * @error: #ClothRigError when mrcal has no such lens
 *
 * Returns: (transfer full): the text of its .cameramodel, or %NULL.
 */
gchar *
cloth_cameramodel_to_text (const ClothCamera * camera, GError ** error)
{
  guint n = cloth_lens_n_coefficients (camera->lens);
  gdouble values[MAX_INTRINSICS] = { camera->K[0], camera->K[4], camera->K[2],
    camera->K[5]
  };
  const gdouble size[2] = { camera->width, camera->height };
  gdouble rt[6];
  GString *s;

  if (camera->lens == CLOTH_LENS_FISHEYE) {
    cloth_rig_invalid (error, camera->name, "distortion",
        "mrcal 2 has no equidistant fisheye lens");
    return NULL;
  }
  if (camera->K[1] != 0) {
    cloth_rig_invalid (error, camera->name, "K", "mrcal has no skew, but this "
        "camera has one of %g", camera->K[1]);
    return NULL;
  }
  memcpy (values + 4, camera->k, n * sizeof (gdouble));
  cloth_rotation_to_vector (camera->R, rt);
  memcpy (rt + 3, camera->t, sizeof camera->t);
  s = g_string_new
      ("# Written by gst-cloth. The reference is the rig's world.\n" "{\n");
  g_string_append_printf (s, "    'lensmodel': '%s',\n",
      n == 0 ? "LENSMODEL_PINHOLE" : n ==
      5 ? "LENSMODEL_OPENCV5" : "LENSMODEL_OPENCV8");
  add_numbers (s, "intrinsics", values, 4 + n);
  add_numbers (s, "extrinsics", rt, 6);
  add_numbers (s, "imagersize", size, 2);
  g_string_append (s, "}\n");
  return g_string_free (s, FALSE);
}

/* @rig: a rig that has been checked
 * @folder: where to; made when it is not there
 * @error: #GFileError, #GIOErrorEnum or #ClothRigError
 *
 * Writes each camera to NAME.cameramodel, whole or not at all. Lenses that mrcal lacks are
 * refused before any file is written.
 *
 * Returns: whether all are there
 */
gboolean
cloth_rig_export_mrcal (const ClothRig * rig, const gchar * folder,
    GError ** error)
{
  g_autoptr (GPtrArray) texts = g_ptr_array_new_with_free_func (g_free);

  for (guint c = 0; c < rig->n_cameras; c++) {
    gchar *text = cloth_cameramodel_to_text (&rig->cameras[c], error);

    if (!text)
      return FALSE;
    g_ptr_array_add (texts, text);
  }
  if (g_mkdir_with_parents (folder, 0777) != 0)
    return cloth_file_fail (error, errno, "make", folder);
  for (guint c = 0; c < rig->n_cameras; c++) {
    g_autofree gchar *name = g_strconcat (rig->cameras[c].name,
        ".cameramodel", NULL);
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    if (!cloth_file_write_text (path, g_ptr_array_index (texts, c), error))
      return FALSE;
  }
  return TRUE;
}
