/* gst-cloth-gap-1.0: simulates takes, and lists the effects that may part a simulation
 * from what was filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "config.h"

#include <locale.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "gst/file/jsonwriter.h"
#include "gst/sim/effect-table.h"
#include "gst/sim/sim.h"

#define TOOL "gst-cloth-gap-1.0"

enum
{ DONE = 0, FAILED = 1, BAD_USAGE = 2 };

typedef struct
{
  gboolean version;
  gchar *format, *scene, *output;
  gint64 seed;
  gint threads;
  gchar **rest;
} Arguments;

static gint
complain (gint code, const gchar * message)
{
  g_printerr (TOOL ": %s\n", message);
  if (code == BAD_USAGE)
    g_printerr ("Try \"" TOOL " --help\".\n");
  return code;
}

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

static gint
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
    g_autofree gchar *message = g_strdup_printf ("--format %s: give text, json "
        "or markdown", format);

    return complain (BAD_USAGE, message);
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

/* The description of the take that is written: the scene's, but for what was measured. */
static ClothTakeInfo *
describe (const ClothTakeInfo * scene)
{
  g_autofree gchar *json = cloth_take_info_to_json (scene);
  ClothTakeInfo *info = cloth_take_info_parse (json, strlen (json), NULL);

  info->noise_sigma_m = 0;
  g_free (info->notes);
  info->notes = g_strdup ("simulated by " TOOL);
  /* Flat names: the folders of the scene need not be there. */
  if (info->mesh) {
    g_free (info->mesh);
    info->mesh = g_strdup ("mesh.obj");
  }
  g_array_unref (info->obstacles);
  info->obstacles = cloth_obstacles_copy (scene->obstacles);
  for (guint i = 0; i < info->obstacles->len; i++) {
    ClothObstacle *item = &g_array_index (info->obstacles, ClothObstacle, i);

    if (item->kind != CLOTH_OBSTACLE_MESH)
      continue;
    g_free (item->mesh);
    item->mesh = g_strdup_printf ("obstacle-%u.obj", i);
  }
  return info;
}

/* On a terminal a line that changes, else a line each tenth. */
static void
tell_progress (guint frame, guint n_frames)
{
  guint percent = (guint) (100. * (frame + 1) / n_frames);

  if (isatty (STDERR_FILENO))
    g_printerr ("\r%3u%%%s", percent, percent == 100 ? "\n" : "");
  else if (percent / 10 != (guint) (100. * frame / n_frames) / 10)
    g_printerr ("%u%%\n", percent);
}

static gboolean
write_frames (ClothSim * sim, const ClothScene * scene,
    ClothTakeWriter * writer, GError ** error)
{
  gsize n = scene->topology->n_vertices, n_held = scene->held->len;
  g_autofree gdouble *positions = g_new (gdouble, 3 * n);
  g_autofree gfloat *places = g_new (gfloat, 3 * n);
  g_autofree gfloat *clamps = g_new (gfloat, 3 * n_held + 1);
  g_autofree guint8 *states = g_malloc (n);

  memset (states, CLOTH_VERTEX_PREDICTED, n);
  for (guint frame = 0; frame < scene->n_frames; frame++) {
    gdouble since_s;

    cloth_sim_advance (sim, scene->times[frame]);
    if (cloth_sim_get_state (sim, 0, &since_s) != CLOTH_SIM_OK) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "the simulation blew up at %.3f s: set “time_step” below %g s or to "
          "0, or lower the stiffnesses and damping.stiffness", since_s,
          cloth_sim_get_time_step (sim));
      return FALSE;
    }
    cloth_sim_get_positions (sim, 0, positions);
    for (gsize i = 0; i < 3 * n; i++)
      places[i] = (gfloat) positions[i];
    for (gsize i = 0; i < 3 * n_held; i++)
      clamps[i] = (gfloat) scene->clamps[3 * n_held * frame + i];
    if (!cloth_take_writer_append (writer, scene->times[frame], places, states,
            NULL, n_held > 0 ? clamps : NULL, error))
      return FALSE;
    tell_progress (frame, scene->n_frames);
  }
  return TRUE;
}

static gboolean
run_simulation (const Arguments * arguments, GError ** error)
{
  const ClothSimOptions options = { FALSE, (guint) arguments->threads,
    CLOTH_SIMD_BEST, (guint64) arguments->seed
  };
  g_autoptr (ClothModel) model = cloth_model_load (arguments->rest[1], error);
  g_autoptr (ClothTake) take = model ?
      cloth_take_open (arguments->scene, error) : NULL;
  g_autoptr (ClothScene) scene = NULL;
  g_autoptr (ClothSim) sim = NULL;
  g_autoptr (ClothTakeInfo) info = NULL;
  g_autoptr (ClothTakeWriter) writer = NULL;
  const ClothModel *models[1] = { model };

  if (!take)
    return FALSE;
  scene = cloth_scene_new_from_take (take, error);
  sim = scene ? cloth_sim_new (scene, models, 1, &options, error) : NULL;
  if (!sim) {
    g_prefix_error (error, "%s: ", arguments->scene);
    return FALSE;
  }
  info = describe (cloth_take_get_info (take));
  writer = cloth_take_writer_new (arguments->output, info, scene->topology,
      error);
  return writer && write_frames (sim, scene, writer, error) &&
      cloth_take_writer_close (writer, error);
}

static gint
simulate (const Arguments * arguments)
{
  g_autoptr (GError) error = NULL;

  if (arguments->format)
    return complain (BAD_USAGE, "simulate takes no --format");
  if (g_strv_length (arguments->rest) != 2)
    return complain (BAD_USAGE, "simulate needs one model.json");
  if (!arguments->scene)
    return complain (BAD_USAGE,
        "name the take that gives mesh, clamps and times: --scene TAKE");
  if (!arguments->output)
    return complain (BAD_USAGE, "name the take to write: --output TAKE");
  if (arguments->threads < 0)
    return complain (BAD_USAGE, "--threads: give 0 for all, or a number");
  if (!strcmp (arguments->scene, arguments->output))
    return complain (BAD_USAGE, "--output is the scene itself; name another");
  if (run_simulation (arguments, &error))
    return DONE;
  return complain (FAILED, error->message);
}

static gint
run (const Arguments * arguments)
{
  const gchar *command = arguments->rest ? arguments->rest[0] : NULL;
  g_autofree gchar *message = NULL;

  if (arguments->version) {
    g_print (TOOL " (%s) %s\n", PACKAGE, PACKAGE_VERSION);
    return DONE;
  }
  if (!command)
    return complain (BAD_USAGE, "name a command: effects or simulate");
  if (!strcmp (command, "effects")) {
    if (arguments->rest[1])
      return complain (BAD_USAGE, "effects takes no names");
    return list_effects (arguments);
  }
  if (!strcmp (command, "simulate"))
    return simulate (arguments);
  message =
      g_strdup_printf ("no command \"%s\": there are effects and simulate",
      command);
  return complain (BAD_USAGE, message);
}

int
main (int argc, char **argv)
{
  Arguments arguments = { 0 };
  const GOptionEntry entries[] = {
    {"format", 0, 0, G_OPTION_ARG_STRING, &arguments.format,
        "effects: text, json or markdown (text)", "FORMAT"},
    {"scene", 0, 0, G_OPTION_ARG_FILENAME, &arguments.scene,
        "simulate: take that gives mesh, clamps, obstacles and times", "TAKE"},
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &arguments.output,
        "simulate: take to write", "TAKE"},
    {"seed", 0, 0, G_OPTION_ARG_INT64, &arguments.seed,
        "simulate: of random effects, such as gusts (0)", "N"},
    {"threads", 0, 0, G_OPTION_ARG_INT, &arguments.threads,
        "simulate: threads, 0 for all (0)", "N"},
    {"version", 0, 0, G_OPTION_ARG_NONE, &arguments.version,
        "Show the version and exit", NULL},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.rest,
        NULL, "effects | simulate MODEL"},
    {NULL}
  };
  g_autoptr (GOptionContext) context =
      g_option_context_new ("- simulate cloth, list effects");
  g_autoptr (GError) error = NULL;
  gint code;

  /* Only the characters: numbers stay with the decimal point. */
  setlocale (LC_CTYPE, "");
  g_option_context_add_main_entries (context, entries, NULL);
  if (g_option_context_parse (context, &argc, &argv, &error))
    code = run (&arguments);
  else
    code = complain (BAD_USAGE, error->message);
  g_free (arguments.format);
  g_free (arguments.scene);
  g_free (arguments.output);
  g_strfreev (arguments.rest);
  return code;
}
