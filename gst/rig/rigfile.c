/* rig.json: the cameras of a rig in a file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/rigfile.h"

#include <math.h>

#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"
#include "gst/file/output.h"

static gboolean
check_keys (JsonObject * object, const gchar * where,
    const gchar * const *known, GError ** error)
{
  g_autoptr (GList) keys = json_object_get_members (object);

  for (GList * l = keys; l; l = l->next) {
    if (!g_strv_contains (known, l->data)) {
      g_autofree gchar *all = g_strjoinv (", ", (gchar **) known);

      return cloth_rig_invalid (error, where, l->data,
          "unknown key; known are %s", all);
    }
  }
  return TRUE;
}

static gboolean
read_number (JsonNode * node, const gchar * where, const gchar * key,
    gdouble * value, GError ** error)
{
  GType type = JSON_NODE_HOLDS_VALUE (node) ? json_node_get_value_type (node)
      : G_TYPE_INVALID;

  if (type != G_TYPE_INT64 && type != G_TYPE_DOUBLE)
    return cloth_rig_invalid (error, where, key, "must hold numbers only");
  *value = json_node_get_double (node);
  if (!isfinite (*value))
    return cloth_rig_invalid (error, where, key,
        "holds a number that is not finite");
  return TRUE;
}

/* A list of n numbers. */
static gboolean
read_list (JsonNode * node, const gchar * where, const gchar * key, guint n,
    gdouble * values, GError ** error)
{
  JsonArray *array;

  if (!node)
    return cloth_rig_invalid (error, where, key, "is missing");
  if (!JSON_NODE_HOLDS_ARRAY (node))
    return cloth_rig_invalid (error, where, key, "must be a list of %u numbers",
        n);
  array = json_node_get_array (node);
  if (json_array_get_length (array) != n)
    return cloth_rig_invalid (error, where, key, "holds %u numbers, not %u",
        json_array_get_length (array), n);
  for (guint i = 0; i < n; i++) {
    if (!read_number (json_array_get_element (array, i), where, key,
            &values[i], error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
read_matrix (JsonNode * node, const gchar * where, const gchar * key,
    gdouble M[9], GError ** error)
{
  JsonArray *array;

  if (!node)
    return cloth_rig_invalid (error, where, key, "is missing");
  if (!JSON_NODE_HOLDS_ARRAY (node)
      || json_array_get_length (json_node_get_array (node)) != 3)
    return cloth_rig_invalid (error, where, key, "must be 3 rows of 3 numbers");
  array = json_node_get_array (node);
  for (guint i = 0; i < 3; i++) {
    g_autofree gchar *row = g_strdup_printf ("%s[%u]", key, i);

    if (!read_list (json_array_get_element (array, i), where, row, 3,
            M + 3 * i, error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
read_string (JsonNode * node, const gchar * where, const gchar * key,
    gchar ** string, GError ** error)
{
  if (!node)
    return cloth_rig_invalid (error, where, key, "is missing");
  if (!JSON_NODE_HOLDS_VALUE (node)
      || json_node_get_value_type (node) != G_TYPE_STRING)
    return cloth_rig_invalid (error, where, key, "must be a string");
  *string = json_node_dup_string (node);
  return TRUE;
}

static gboolean
read_distortion (JsonNode * node, const gchar * camera, ClothCamera * c,
    GError ** error)
{
  static const gchar *const known[] = { "model", "coefficients", NULL };
  g_autofree gchar *where = g_strdup_printf ("%s.distortion", camera);
  g_autofree gchar *model = NULL;
  JsonObject *object;
  guint n;

  if (!node)
    return cloth_rig_invalid (error, where, "", "is missing; without any write "
        "{\"model\": \"none\", \"coefficients\": []}");
  if (!JSON_NODE_HOLDS_OBJECT (node))
    return cloth_rig_invalid (error, where, "", "must be an object");
  object = json_node_get_object (node);
  if (!check_keys (object, where, known, error)
      || !read_string (json_object_get_member (object, "model"), where,
          "model", &model, error))
    return FALSE;
  if (!cloth_lens_from_string (model, &c->lens))
    return cloth_rig_invalid (error, where, "model",
        "\"%s\" is unknown; known are none, brown5, brown8, fisheye", model);
  n = cloth_lens_n_coefficients (c->lens);
  if (n == 0 && !json_object_has_member (object, "coefficients"))
    return TRUE;
  return read_list (json_object_get_member (object, "coefficients"), where,
      "coefficients", n, c->k, error);
}

static gboolean
read_deviations (JsonNode * node, const gchar * camera, ClothCamera * c,
    GError ** error)
{
  static const gchar *const known[] = { "K", "distortion", "rotation", "t",
    "offset_s", NULL
  };
  g_autofree gchar *where = g_strdup_printf ("%s.standard_deviations", camera);
  struct
  {
    const gchar *key;
    guint n;
    gdouble *values;
  } lists[] = {
    {"K", 4, c->K_sd},
    {"distortion", cloth_lens_n_coefficients (c->lens), c->k_sd},
    {"rotation", 3, c->r_sd}, {"t", 3, c->t_sd}
  };
  JsonObject *object;

  if (!node)
    return TRUE;
  if (!JSON_NODE_HOLDS_OBJECT (node))
    return cloth_rig_invalid (error, where, "", "must be an object");
  object = json_node_get_object (node);
  if (!check_keys (object, where, known, error))
    return FALSE;
  if (json_object_has_member (object, "offset_s")
      && !read_number (json_object_get_member (object, "offset_s"), where,
          "offset_s", &c->offset_sd, error))
    return FALSE;
  if (c->offset_sd < 0)
    return cloth_rig_invalid (error, where, "offset_s", "is negative: %g",
        c->offset_sd);
  for (guint i = 0; i < G_N_ELEMENTS (lists); i++) {
    if (json_object_has_member (object, lists[i].key)) {
      if (!read_list (json_object_get_member (object, lists[i].key), where,
              lists[i].key, lists[i].n, lists[i].values, error))
        return FALSE;
      for (guint j = 0; j < lists[i].n; j++) {
        if (lists[i].values[j] < 0)
          return cloth_rig_invalid (error, where, lists[i].key,
              "is negative: %g", lists[i].values[j]);
      }
    }
  }
  return TRUE;
}

static gboolean
read_camera (JsonNode * node, const gchar * where, ClothCamera * c,
    GError ** error)
{
  static const gchar *const known[] = { "name", "size", "K", "distortion",
    "R", "t", "device", "rolling_shutter_s", "offset_s",
    "standard_deviations", NULL
  };
  JsonObject *object;
  gdouble size[2];

  if (!JSON_NODE_HOLDS_OBJECT (node))
    return cloth_rig_invalid (error, where, "", "must be an object");
  object = json_node_get_object (node);
  if (!check_keys (object, where, known, error)
      || !read_string (json_object_get_member (object, "name"), where,
          "name", &c->name, error)
      || !read_list (json_object_get_member (object, "size"), where, "size",
          2, size, error))
    return FALSE;
  for (gint i = 0; i < 2; i++) {
    if (size[i] != floor (size[i]) || size[i] < 1
        || size[i] > CLOTH_RIG_MAX_SIZE)
      return cloth_rig_invalid (error, where, "size",
          "%g; each must be a whole number between 1 and %d", size[i],
          CLOTH_RIG_MAX_SIZE);
  }
  c->width = (gint) size[0];
  c->height = (gint) size[1];
  if (!read_matrix (json_object_get_member (object, "K"), where, "K", c->K,
          error)
      || !read_distortion (json_object_get_member (object, "distortion"),
          where, c, error)
      || !read_matrix (json_object_get_member (object, "R"), where, "R", c->R,
          error)
      || !read_list (json_object_get_member (object, "t"), where, "t", 3,
          c->t, error)
      || !read_deviations (json_object_get_member (object,
              "standard_deviations"), where, c, error))
    return FALSE;
  if (json_object_has_member (object, "device")
      && !read_string (json_object_get_member (object, "device"), where,
          "device", &c->device, error))
    return FALSE;
  if ((json_object_has_member (object, "rolling_shutter_s")
          && !read_number (json_object_get_member (object,
                  "rolling_shutter_s"), where, "rolling_shutter_s",
              &c->rolling_shutter_s, error))
      || (json_object_has_member (object, "offset_s")
          && !read_number (json_object_get_member (object, "offset_s"), where,
              "offset_s", &c->offset_s, error)))
    return FALSE;
  return TRUE;
}

/* @data: the text of a rig.json, at most 16 MiB
 * @length: its bytes
 * @error: #ClothFileError, or #ClothRigError naming key and value
 *
 * Returns: (transfer full): the rig, or %NULL.
 */
ClothRig *
cloth_rig_load_data (const gchar * data, gsize length, GError ** error)
{
  static const gchar *const known[] = { "version", "cameras", NULL };
  g_autoptr (JsonParser) parser = cloth_json_parse (data, length, error);
  g_autoptr (ClothRig) rig = NULL;
  JsonNode *node;
  JsonObject *object;
  JsonArray *cameras;
  gdouble version = 0;
  guint n;

  if (!parser)
    return NULL;
  object = json_node_get_object (json_parser_get_root (parser));
  if (!(node = json_object_get_member (object, "version"))) {
    cloth_rig_invalid (error, "", "version", "is missing; it must be 1");
    return NULL;
  }
  if (!read_number (node, "", "version", &version, error))
    return NULL;
  if (version != 1) {
    cloth_rig_invalid (error, "", "version", "%g; this program reads version 1",
        version);
    return NULL;
  }
  if (!check_keys (object, "", known, error))
    return NULL;
  node = json_object_get_member (object, "cameras");
  if (!node || !JSON_NODE_HOLDS_ARRAY (node)) {
    cloth_rig_invalid (error, "", "cameras", "must be a list of cameras");
    return NULL;
  }
  cameras = json_node_get_array (node);
  n = json_array_get_length (cameras);
  if (n < 1 || n > CLOTH_RIG_MAX_CAMERAS) {
    cloth_rig_invalid (error, "", "cameras", "%u of them; 1 to %d are allowed",
        n, CLOTH_RIG_MAX_CAMERAS);
    return NULL;
  }
  rig = cloth_rig_new (n);
  for (guint i = 0; i < n; i++) {
    g_autofree gchar *where = g_strdup_printf ("cameras[%u]", i);

    if (!read_camera (json_array_get_element (cameras, i), where,
            &rig->cameras[i], error))
      return NULL;
  }
  if (!cloth_rig_check (rig, error))
    return NULL;
  cloth_rig_mend_rotations (rig);
  return g_steal_pointer (&rig);
}

/* @path: a rig.json
 * @error: #GFileError, #ClothFileError or #ClothRigError, naming file, key and value
 *
 * Returns: (transfer full): the rig, or %NULL.
 */
ClothRig *
cloth_rig_load (const gchar * path, GError ** error)
{
  gsize length;
  g_autofree gchar *data = cloth_text_file_load (path, &length, error);
  ClothRig *rig;

  if (!data)
    return NULL;
  rig = cloth_rig_load_data (data, length, error);
  if (!rig)
    g_prefix_error (error, "%s: ", path);
  return rig;
}

/* On the line that has begun. */
static void
add_matrix (ClothJsonWriter * w, const gchar * key, const gdouble M[9])
{
  cloth_json_writer_begin_array (w, key);
  for (guint i = 0; i < 3; i++)
    cloth_json_writer_numbers (w, NULL, M + 3 * i, 3);
  cloth_json_writer_end_array (w);
}

static gboolean
any_set (const gdouble * values, guint n)
{
  for (guint i = 0; i < n; i++) {
    if (values[i] != 0)
      return TRUE;
  }
  return FALSE;
}

/* An object on a line of its own. */
static void
begin_line (ClothJsonWriter * w, const gchar * key)
{
  cloth_json_writer_begin_object (w, key);
  cloth_json_writer_set_one_line (w, TRUE);
}

static void
end_line (ClothJsonWriter * w)
{
  cloth_json_writer_end_object (w);
  cloth_json_writer_set_one_line (w, FALSE);
}

static void
add_camera (ClothJsonWriter * w, const ClothCamera * c)
{
  const guint n = cloth_lens_n_coefficients (c->lens);
  const gdouble size[2] = { c->width, c->height };

  /* A few lines a camera: what it is, its lens, where it stands. */
  cloth_json_writer_begin_object (w, NULL);
  cloth_json_writer_string (w, "name", c->name);
  cloth_json_writer_set_one_line (w, TRUE);
  cloth_json_writer_numbers (w, "size", size, 2);
  add_matrix (w, "K", c->K);
  if (c->device)
    cloth_json_writer_string (w, "device", c->device);
  if (c->rolling_shutter_s != 0)
    cloth_json_writer_number (w, "rolling_shutter_s", c->rolling_shutter_s);
  if (c->offset_s != 0)
    cloth_json_writer_number (w, "offset_s", c->offset_s);
  cloth_json_writer_set_one_line (w, FALSE);
  begin_line (w, "distortion");
  cloth_json_writer_string (w, "model", cloth_lens_to_string (c->lens));
  cloth_json_writer_numbers (w, "coefficients", c->k, n);
  end_line (w);
  cloth_json_writer_numbers (w, "t", c->t, 3);
  cloth_json_writer_set_one_line (w, TRUE);
  add_matrix (w, "R", c->R);
  cloth_json_writer_set_one_line (w, FALSE);
  if (any_set (c->K_sd, 4) || any_set (c->k_sd, n) || any_set (c->r_sd, 3)
      || any_set (c->t_sd, 3) || c->offset_sd != 0) {
    begin_line (w, "standard_deviations");
    cloth_json_writer_numbers (w, "K", c->K_sd, 4);
    cloth_json_writer_numbers (w, "distortion", c->k_sd, n);
    cloth_json_writer_numbers (w, "rotation", c->r_sd, 3);
    cloth_json_writer_numbers (w, "t", c->t_sd, 3);
    if (c->offset_sd != 0)
      cloth_json_writer_number (w, "offset_s", c->offset_sd);
    end_line (w);
  }
  cloth_json_writer_end_object (w);
}

/* @rig: a rig that passes cloth_rig_check()
 * @path: where to; replaced whole or not at all
 * @error: #GIOErrorEnum or #ClothRigError
 *
 * Writes version 1. Numbers are written so that they read back as the same doubles.
 *
 * Returns: whether it was written.
 */
gboolean
cloth_rig_save (const ClothRig * rig, const gchar * path, GError ** error)
{
  ClothJsonWriter *w;
  g_autofree gchar *text = NULL;

  if (!cloth_rig_check (rig, error)) {
    g_prefix_error (error, "%s: not written: ", path);
    return FALSE;
  }
  w = cloth_json_writer_new ();
  cloth_json_writer_set_exact (w);
  cloth_json_writer_begin_object (w, NULL);
  cloth_json_writer_count (w, "version", 1);
  cloth_json_writer_begin_array (w, "cameras");
  for (guint i = 0; i < rig->n_cameras; i++)
    add_camera (w, &rig->cameras[i]);
  cloth_json_writer_end_array (w);
  cloth_json_writer_end_object (w);
  text = cloth_json_writer_finish (w);
  cloth_json_writer_free (w);
  return cloth_file_write_text (path, text, error);
}
