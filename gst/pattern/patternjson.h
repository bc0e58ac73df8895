/* Shared inside gst/pattern: what reading a pattern.json begins with.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/json.h"

G_BEGIN_DECLS

/* How errors of a pattern.json are told. */
extern const ClothJsonFile cloth_pattern_json;

/* @kind: what the file calls it
 * @are: its content and a verb: "dots are"
 * @name: "an M-array"
 * @keys: (array zero-terminated=1): those that it may have
 */
typedef struct {
  const gchar *kind, *are, *name;
  const gchar *const *keys;
} ClothPatternKind;

JsonParser *cloth_pattern_json_open (const ClothPatternKind * kind,
    const gchar * data, gsize size, JsonObject ** object, GError ** error);

G_END_DECLS
