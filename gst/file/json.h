/* JSON that nobody vouches for.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <json-glib/json-glib.h>

#include "gst/file/file.h"

G_BEGIN_DECLS

JsonParser *cloth_json_parse (const gchar * data, gsize length,
    GError ** error);

/* @name: what messages begin with, such as `take.json`
 * @domain: error domain of what is wrong with its values
 * @code: error code of the same
 *
 * Whose values are read.
 */
typedef struct {
  const gchar *name;
  GQuark (*domain) (void);
  gint code;
} ClothJsonFile;

gboolean cloth_json_invalid (const ClothJsonFile * file, GError ** error,
    const gchar * format, ...) G_GNUC_PRINTF (3, 4);
gboolean cloth_json_check_keys (const ClothJsonFile * file,
    JsonObject * object, const gchar * where, const gchar * const *allowed,
    GError ** error);
JsonNode *cloth_json_find (JsonObject * object, const gchar * key);
gboolean cloth_json_number (JsonNode * node, gdouble * value);
gboolean cloth_json_get_number (const ClothJsonFile * file,
    JsonObject * object, const gchar * key, gdouble least, gdouble most,
    gdouble * value, GError ** error);
gboolean cloth_json_get_count (const ClothJsonFile * file,
    JsonObject * object, const gchar * key, guint least, guint most,
    guint * value, GError ** error);
gboolean cloth_json_get_string (const ClothJsonFile * file,
    JsonObject * object, const gchar * key, gchar ** value, GError ** error);
gboolean cloth_json_get_vector (const ClothJsonFile * file,
    JsonObject * object, const gchar * key, gboolean needed, gdouble * value,
    GError ** error);
JsonArray *cloth_json_get_list (const ClothJsonFile * file,
    JsonObject * object, const gchar * key, guint most, gboolean * bad,
    GError ** error);
JsonObject *cloth_json_item_object (const ClothJsonFile * file,
    JsonArray * array, guint i, const gchar * key, GError ** error);

void cloth_json_add_number (JsonBuilder * builder, const gchar * key,
    gdouble value);
void cloth_json_add_vector (JsonBuilder * builder, const gchar * key,
    const gdouble * value);
void cloth_json_add_string (JsonBuilder * builder, const gchar * key,
    const gchar * value);

G_END_DECLS
