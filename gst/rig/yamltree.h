/* A small YAML document as a tree, read within limits.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @CLOTH_YAML_SCALAR: text
 * @CLOTH_YAML_SEQUENCE: list of nodes
 * @CLOTH_YAML_MAPPING: unique keys with a node each
 */
typedef enum {
  CLOTH_YAML_SCALAR,
  CLOTH_YAML_SEQUENCE,
  CLOTH_YAML_MAPPING
} ClothYamlKind;

typedef struct _ClothYamlNode ClothYamlNode;

/* @kind: which of the members below are used
 * @text: the scalar
 * @items: (element-type ClothYamlNode): of a sequence or a mapping
 * @keys: (element-type utf8): of a mapping, in step with @items
 */
struct _ClothYamlNode {
  ClothYamlKind kind;
  gchar *text;
  GPtrArray *items;
  GPtrArray *keys;
};

ClothYamlNode *cloth_yaml_parse (const gchar * data, gsize length,
    GError ** error);
void cloth_yaml_node_free (ClothYamlNode * node);
const ClothYamlNode *cloth_yaml_get (const ClothYamlNode * mapping,
    const gchar * key);
gboolean cloth_yaml_number (const ClothYamlNode * node, gdouble * value);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothYamlNode, cloth_yaml_node_free)
G_END_DECLS
