/* A small YAML document as a tree, read within limits.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/yamltree.h"

#include <math.h>
#include <string.h>
#include <yaml.h>

#include "gst/rig/rig.h"

#define MAX_DEPTH 16
#define MAX_EVENTS 200000
#define MAX_KEYS 1000

static ClothYamlNode *
node_new (ClothYamlKind kind)
{
  ClothYamlNode *node = g_new0 (ClothYamlNode, 1);

  node->kind = kind;
  if (kind != CLOTH_YAML_SCALAR)
    node->items =
        g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_yaml_node_free);
  if (kind == CLOTH_YAML_MAPPING)
    node->keys = g_ptr_array_new_with_free_func (g_free);
  return node;
}

/* @node: (transfer full) (nullable): a node
 *
 * Frees it with all below it.
 */
void
cloth_yaml_node_free (ClothYamlNode * node)
{
  if (!node)
    return;
  g_free (node->text);
  g_clear_pointer (&node->items, g_ptr_array_unref);
  g_clear_pointer (&node->keys, g_ptr_array_unref);
  g_free (node);
}

/* @mapping: a node
 * @key: a key
 *
 * Returns: (nullable) (transfer none): what @mapping holds under @key; %NULL also when
 *   it is no mapping.
 */
const ClothYamlNode *
cloth_yaml_get (const ClothYamlNode * mapping, const gchar * key)
{
  if (mapping->kind != CLOTH_YAML_MAPPING)
    return NULL;
  for (guint i = 0; i < mapping->items->len; i++) {
    if (g_str_equal (g_ptr_array_index (mapping->keys, i), key))
      return g_ptr_array_index (mapping->items, i);
  }
  return NULL;
}

/* @node: (nullable): a node
 * @value: (out): its number
 *
 * Returns: whether @node is a scalar that holds one finite number and nothing else.
 */
gboolean
cloth_yaml_number (const ClothYamlNode * node, gdouble * value)
{
  gchar *end;

  if (!node || node->kind != CLOTH_YAML_SCALAR || !*node->text)
    return FALSE;
  *value = g_ascii_strtod (node->text, &end);
  return *end == 0 && isfinite (*value);
}

G_GNUC_PRINTF (4, 5)
     static gboolean
         fail (GError ** error, ClothRigError code, gsize line,
    const gchar * format, ...)
{
  va_list args;
  g_autofree gchar *what = NULL;

  va_start (args, format);
  what = g_strdup_vprintf (format, args);
  va_end (args);
  g_set_error (error, CLOTH_RIG_ERROR, (gint) code,
      "line %" G_GSIZE_FORMAT ": %s", line + 1, what);
  return FALSE;
}

typedef struct
{
  ClothYamlNode *root;
  ClothYamlNode *open[MAX_DEPTH + 1];   /* below the first, which is none */
  gint depth;
  gchar *key;                   /* read, its value is still to come */
  guint n_events;
} Build;

/* Puts @node (taken over) where the document stands. */
static gboolean
attach (Build * b, ClothYamlNode * node, gsize line, GError ** error)
{
  ClothYamlNode *parent = b->open[b->depth];

  if (!parent) {
    b->root = node;
  } else if (parent->kind == CLOTH_YAML_SEQUENCE) {
    g_ptr_array_add (parent->items, node);
  } else if (b->key) {
    g_ptr_array_add (parent->keys, g_steal_pointer (&b->key));
    g_ptr_array_add (parent->items, node);
  } else {
    if (parent->keys->len >= MAX_KEYS) {
      cloth_yaml_node_free (node);
      return fail (error, CLOTH_RIG_ERROR_LIMIT, line,
          "more than %d keys in one mapping", MAX_KEYS);
    }
    if (node->kind != CLOTH_YAML_SCALAR)
      fail (error, CLOTH_RIG_ERROR_SYNTAX, line, "a key must be plain text");
    else if (cloth_yaml_get (parent, node->text))
      fail (error, CLOTH_RIG_ERROR_VALUE, line, "key \"%s\" is there twice",
          node->text);
    else
      b->key = g_steal_pointer (&node->text);
    cloth_yaml_node_free (node);
    return b->key != NULL;
  }
  if (node->kind != CLOTH_YAML_SCALAR) {
    if (b->depth == MAX_DEPTH)
      return fail (error, CLOTH_RIG_ERROR_LIMIT, line,
          "nested deeper than %d levels", MAX_DEPTH);
    b->open[++b->depth] = node;
  }
  return TRUE;
}

static gboolean
handle (Build * b, const yaml_event_t * event, GError ** error)
{
  gsize line = event->start_mark.line;
  ClothYamlNode *node;

  if (++b->n_events > MAX_EVENTS)
    return fail (error, CLOTH_RIG_ERROR_LIMIT, line,
        "more than %d values", MAX_EVENTS);
  switch (event->type) {
    case YAML_SCALAR_EVENT:
      if (memchr (event->data.scalar.value, 0, event->data.scalar.length))
        return fail (error, CLOTH_RIG_ERROR_SYNTAX, line, "text holds a 0");
      node = node_new (CLOTH_YAML_SCALAR);
      node->text = g_strndup ((const gchar *) event->data.scalar.value,
          event->data.scalar.length);
      return attach (b, node, line, error);
    case YAML_SEQUENCE_START_EVENT:
      return attach (b, node_new (CLOTH_YAML_SEQUENCE), line, error);
    case YAML_MAPPING_START_EVENT:
      return attach (b, node_new (CLOTH_YAML_MAPPING), line, error);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
      b->depth--;
      return TRUE;
    case YAML_ALIAS_EVENT:
      return fail (error, CLOTH_RIG_ERROR_SYNTAX, line,
          "aliases (*name) are not allowed");
    default:
      return TRUE;
  }
}

/* @data: the text of a YAML document
 * @length: its bytes, at most 16 MiB
 * @error: #ClothRigError, naming the line
 *
 * Reads the first document, by a walk over libyaml's events. Aliases, more than 16 levels,
 * 200000 values or 1000 keys in a mapping are refused. OpenCV's first line %YAML:1.0, which is not
 * YAML, is skipped.
 *
 * Returns: (transfer full): the root, or %NULL.
 */
ClothYamlNode *
cloth_yaml_parse (const gchar * data, gsize length, GError ** error)
{
  static const gchar opencv[] = "%YAML:1.0";
  yaml_parser_t parser;
  yaml_event_t event;
  Build b = { NULL, };
  gboolean done = FALSE, ok = TRUE;
  gsize skipped_lines = 0;

  if (length >= strlen (opencv) && !memcmp (data, opencv, strlen (opencv))) {
    const gchar *end = memchr (data, '\n', length);

    length = end ? length - (gsize) (end + 1 - data) : 0;
    data = end ? end + 1 : data;
    skipped_lines = 1;
  }
  if (!yaml_parser_initialize (&parser)) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_LIMIT,
        "no memory for a YAML parser");
    return NULL;
  }
  yaml_parser_set_input_string (&parser, (const guchar *) (length ? data : ""),
      length);
  while (ok && !done) {
    if (!yaml_parser_parse (&parser, &event)) {
      ok = fail (error, CLOTH_RIG_ERROR_SYNTAX,
          parser.problem_mark.line + skipped_lines, "not YAML: %s",
          parser.problem ? parser.problem : "unreadable");
      break;
    }
    event.start_mark.line += skipped_lines;
    ok = handle (&b, &event, error);
    done = event.type == YAML_DOCUMENT_END_EVENT
        || event.type == YAML_STREAM_END_EVENT;
    yaml_event_delete (&event);
  }
  yaml_parser_delete (&parser);
  g_free (b.key);
  if (ok && !b.root) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_SYNTAX,
        "holds no YAML document");
    ok = FALSE;
  }
  if (!ok)
    g_clear_pointer (&b.root, cloth_yaml_node_free);
  return b.root;
}
