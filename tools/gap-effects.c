/* gst-cloth-gap-1.0 effects: lists the effects that may part a simulation from what was
 * filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-tool.h"

#include <string.h>

#include "gst/file/jsonwriter.h"
#include "gst/effect/effect.h"

static gchar *
number (gdouble value)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE];

  return g_strdup (g_ascii_formatd (digits, sizeof digits, "%.6g", value));
}

/* "0 … 20", "−0.5 … 0.5" with the same minus as everywhere in the text. */
static gchar *
range (const ClothEffectParameter * parameter)
{
  g_autofree gchar *min = number (parameter->min);
  g_autofree gchar *max = number (parameter->max);

  return g_strdup_printf ("%s … %s", min, max);
}

static gchar *
prior (const ClothEffectParameter * parameter)
{
  g_autofree gchar *scale = number (parameter->prior);

  return g_strdup_printf ("%s%s", scale,
      parameter->one_sided ? ", one-sided" : "");
}

static gchar *
join_confusions (const ClothEffect * effect, const gchar * quote)
{
  g_autoptr (GString) text = g_string_new (NULL);

  for (guint i = 0; effect->confusions && effect->confusions[i]; i++)
    g_string_append_printf (text, "%s%s%s%s", i ? ", " : "", quote,
        effect->confusions[i], quote);
  return g_string_free (g_steal_pointer (&text), FALSE);
}

static void
print_text (const ClothEffect * effect)
{
  g_autofree gchar *confusions = join_confusions (effect, "");

  g_print ("%s (%s)\n  %s\n", effect->id, cloth_effect_side_name (effect->side),
      effect->blurb);
  for (guint i = 0; i < effect->n_parameters; i++) {
    const ClothEffectParameter *parameter = &effect->parameters[i];
    g_autofree gchar *null_value = number (parameter->null_value);
    g_autofree gchar *limits = range (parameter);
    g_autofree gchar *scale = prior (parameter);

    g_print ("  %s [%s]  null %s, range %s, prior %s\n      %s\n",
        parameter->name, parameter->unit, null_value, limits, scale,
        parameter->blurb);
  }
  g_print ("  shows as: %s\n  looks like: %s\n  source: %s\n\n",
      effect->regressor, *confusions ? confusions : "none", effect->source);
}

/* A bar would end the cell. */
static gchar *
cell (const gchar * text)
{
  g_auto (GStrv) parts = g_strsplit (text, "|", -1);

  return g_strjoinv ("\\|", parts);
}

static void
print_markdown (const ClothEffect * effect)
{
  g_autofree gchar *confusions = join_confusions (effect, "`");

  g_print ("### %s\n%s\n\n", effect->id, effect->blurb);
  g_print ("| parameter | unit | null | range | prior | meaning |\n"
      "|---|---|---|---|---|---|\n");
  for (guint i = 0; i < effect->n_parameters; i++) {
    const ClothEffectParameter *parameter = &effect->parameters[i];
    g_autofree gchar *null_value = number (parameter->null_value);
    g_autofree gchar *limits = range (parameter);
    g_autofree gchar *scale = prior (parameter);
    g_autofree gchar *blurb = cell (parameter->blurb);

    g_print ("| `%s` | %s | %s | %s | %s | %s |\n", parameter->name,
        parameter->unit, null_value, limits, scale, blurb);
  }
  g_print ("\n- Shows as: %s\n- Looks like: %s\n- Source: %s\n\n",
      effect->regressor, *confusions ? confusions : "none", effect->source);
}

static void
write_effect (ClothJsonWriter * writer, const ClothEffect * effect)
{
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "id", effect->id);
  cloth_json_writer_string (writer, "side",
      cloth_effect_side_name (effect->side));
  cloth_json_writer_string (writer, "blurb", effect->blurb);
  cloth_json_writer_begin_array (writer, "parameters");
  for (guint i = 0; i < effect->n_parameters; i++) {
    const ClothEffectParameter *parameter = &effect->parameters[i];
    const gdouble limits[2] = { parameter->min, parameter->max };

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", parameter->name);
    cloth_json_writer_string (writer, "unit", parameter->unit);
    cloth_json_writer_number (writer, "null", parameter->null_value);
    cloth_json_writer_numbers (writer, "range", limits, 2);
    cloth_json_writer_number (writer, "prior", parameter->prior);
    cloth_json_writer_boolean (writer, "one_sided", parameter->one_sided);
    cloth_json_writer_string (writer, "blurb", parameter->blurb);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_string (writer, "regressor", effect->regressor);
  cloth_json_writer_begin_array (writer, "confusions");
  for (guint i = 0; effect->confusions && effect->confusions[i]; i++)
    cloth_json_writer_string (writer, NULL, effect->confusions[i]);
  cloth_json_writer_end_array (writer);
  cloth_json_writer_string (writer, "source", effect->source);
  cloth_json_writer_end_object (writer);
}

gint
list_effects (const Arguments * arguments)
{
  const gchar *format = arguments->format ? arguments->format : "text";
  guint n;
  const ClothEffect *const *table = cloth_effect_table (&n);

  if (arguments->scene || arguments->output)
    return complain (BAD_USAGE, "effects takes neither --scene nor --output");
  if (!strcmp (format, "json")) {
    g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
    g_autofree gchar *text = NULL;

    cloth_json_writer_set_exact (writer);
    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_count (writer, "version", 1);
    cloth_json_writer_begin_array (writer, "effects");
    for (guint i = 0; i < n; i++)
      write_effect (writer, table[i]);
    cloth_json_writer_end_array (writer);
    cloth_json_writer_end_object (writer);
    text = cloth_json_writer_finish (writer);
    g_print ("%s", text);
    return DONE;
  }
  if (strcmp (format, "text") && strcmp (format, "markdown")) {
    return complain (BAD_USAGE, "--format %s: give text, json or markdown",
        format);
  }
  for (guint i = 0; i < n; i++) {
    if (!strcmp (format, "text")) {
      print_text (table[i]);
      continue;
    }
    if (i == 0 || table[i]->side != table[i - 1]->side)
      g_print ("## Side: %s\n", cloth_effect_side_name (table[i]->side));
    print_markdown (table[i]);
  }
  return DONE;
}
