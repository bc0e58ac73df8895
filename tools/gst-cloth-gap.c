/* gst-cloth-gap-1.0: diagnoses takes, one or many, compares them with simulations, simulates takes, lists the effects that
 * may part a simulation from what was filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-tool.h"

#include <string.h>

#include "tools/gap-simulator.h"

static gint
run (gconstpointer data)
{
  const Arguments *arguments = data;
  const gchar *command = arguments->rest ? arguments->rest[0] : NULL;
  gboolean is_compare = !g_strcmp0 (command, "compare");
  gboolean is_diagnose = is_compare || !g_strcmp0 (command, "diagnose");
  gboolean is_survey = !g_strcmp0 (command, "survey");

  if (!command)
    return complain (BAD_USAGE,
        "name a command: diagnose, compare, survey, simulate, check-simulator or "
        "effects");
  if (is_survey)
    return survey (arguments);
  if (arguments->spool || arguments->worker || arguments->resume ||
      arguments->workers >= 0)
    return complain (BAD_USAGE, "%s takes no --spool, --workers, --worker or "
        "--resume; they are survey's", command);
  if (!is_diagnose && (arguments->model || arguments->effects ||
          arguments->baselines || arguments->hold_outs || arguments->simulated
          || arguments->after || arguments->simulator))
    return complain (BAD_USAGE, "%s takes no --model, --effects, --baseline, "
        "--hold-out, --simulated, --after or --simulator; they are diagnose's",
        command);
  if (is_compare)
    return compare_takes (arguments);
  if (is_diagnose)
    return diagnose (arguments);
  if (!strcmp (command, "effects")) {
    if (arguments->rest[1])
      return complain (BAD_USAGE, "effects takes no names");
    return list_effects (arguments);
  }
  if (!strcmp (command, "simulate"))
    return simulate (arguments);
  if (!strcmp (command, "check-simulator"))
    return check_simulator (arguments);
  return complain (BAD_USAGE, "no command \"%s\": there are diagnose, "
      "compare, survey, simulate, check-simulator and effects", command);
}

/* "--baseline a b" becomes "--baseline a --baseline b": these lists end where the next
 * option begins. */
static gchar **
spread_lists (char **argv)
{
  static const gchar *const lists[] = {
    "--baseline", "--hold-out", "--simulated", "--after", NULL
  };
  g_autoptr (GPtrArray) words = g_ptr_array_new ();
  const gchar *list = NULL;
  guint n = 0;

  for (; *argv; argv++) {
    if (!strcmp (*argv, "--"))
      break;
    if (**argv == '-') {
      list = g_strv_contains (lists, *argv) ? *argv : NULL;
      n = 0;
    } else if (list && n++ > 0) {
      g_ptr_array_add (words, g_strdup (list));
    }
    g_ptr_array_add (words, g_strdup (*argv));
  }
  for (; *argv; argv++)
    g_ptr_array_add (words, g_strdup (*argv));
  g_ptr_array_add (words, NULL);
  return (gchar **) g_ptr_array_free (g_steal_pointer (&words), FALSE);
}

static const ToolCommand commands[] = {
  {"diagnose", "TAKE… --model MODEL --output DIR",
        "Says how large the gap between recordings and a simulation is, where, and "
        "which effect\nthe simulation lacks. The report is DIR/report.html, the "
        "numbers are in DIR/gap.json.",
      "gst-cloth-gap-1.0 diagnose film.take --model model.json --effects "
        "wind,gravity_tilt \\\n    --output gap"},
  {"compare", "RECORDED SIMULATED --model MODEL --output DIR",
        "Says how far a simulation of your own is from a recording, and which "
        "effect it lacks.\nMODEL is fitted to it, and simulates the cloth with "
        "effects and without.",
      "gst-cloth-gap-1.0 compare film.take simulated.take --model model.json "
        "\\\n    --output gap"},
  {"survey", "LIST --model MODEL --output DIR",
        "Diagnoses many takes, a line of LIST each, by several processes on one "
        "host or on many,\nand makes one table of the effects over them: "
        "DIR/survey.json.",
      "gst-cloth-gap-1.0 survey takes.txt --model model.json --output survey"
        "\ngst-cloth-gap-1.0 survey --worker --spool survey/spool"},
  {"simulate", "MODEL --scene TAKE --output TAKE",
        "Simulates a cloth in the scene of a take: its mesh, clamps, obstacles "
        "and times.",
      "gst-cloth-gap-1.0 simulate model.json --scene film.take --output "
        "simulated.take"},
  {"check-simulator", "COMMAND --scene TAKE",
        "Runs your own simulator as a diagnosis would, and says whether it keeps "
        "to what is\nagreed.",
      "gst-cloth-gap-1.0 check-simulator ./my-simulator --scene film.take"},
  {"effects", "",
        "Lists the effects that a simulation may lack, with their parameters.",
      "gst-cloth-gap-1.0 effects --format markdown"},
  {NULL}
};

int
main (int argc, char **argv)
{
  Arguments arguments = {.run_seconds = GAP_SIMULATOR_SECONDS,
    .simulator_runs = CLOTH_GAP_SIMULATOR_RUNS,
    .workers = -1
  };
  const GOptionEntry entries[] = {
    {"model", 'm', 0, G_OPTION_ARG_FILENAME, &arguments.model,
          "diagnose, compare, survey: model.json that the takes are held against",
        "MODEL"},
    {"baseline", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.baselines,
        "diagnose: takes the model is accepted on", "TAKE…"},
    {"hold-out", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.hold_outs,
        "diagnose: takes that judge, on which nothing is fitted", "TAKE…"},
    {"simulated", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.simulated,
        "diagnose: what your simulator made of each take, then of each "
          "hold-out", "TAKE…"},
    {"after", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.after,
          "diagnose, compare: the same with the effect added, of what judges",
        "TAKE…"},
    {"simulator", 0, 0, G_OPTION_ARG_STRING, &arguments.simulator,
        "diagnose: command that runs your simulator, instead of --simulated "
          "and --after", "COMMAND"},
    {"simulator-runs", 0, 0, G_OPTION_ARG_INT, &arguments.simulator_runs,
          "diagnose: most runs of it for each take, to find its numbers (20)",
        "N"},
    {"effects", 0, 0, G_OPTION_ARG_STRING, &arguments.effects,
          "diagnose, compare, survey: effects to consider, with commas between "
          "them (all)",
        "LIST"},
    {"format", 0, 0, G_OPTION_ARG_STRING, &arguments.format,
        "effects: text, json or markdown (text)", "FORMAT"},
    {"scene", 0, 0, G_OPTION_ARG_FILENAME, &arguments.scene,
        "simulate, check-simulator: take that gives mesh, clamps, obstacles "
          "and times", "TAKE"},
    {"run-seconds", 0, 0, G_OPTION_ARG_INT, &arguments.run_seconds,
        "diagnose, check-simulator: seconds that one run of your simulator may "
          "take (600)", "N"},
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &arguments.output,
          "diagnose, compare, survey, simulate: folder of the report, or take "
          "to write",
        "DIR"},
    {"spool", 0, 0, G_OPTION_ARG_FILENAME, &arguments.spool,
        "survey: folder of the jobs, which all hosts can write "
          "(DIR/spool)", "DIR"},
    {"workers", 0, 0, G_OPTION_ARG_INT, &arguments.workers,
          "survey: processes to start here, 0 for none (all processors)",
        "N"},
    {"worker", 0, 0, G_OPTION_ARG_NONE, &arguments.worker,
        "survey: do jobs of a spool that is there or will be", NULL},
    {"resume", 0, 0, G_OPTION_ARG_NONE, &arguments.resume,
        "survey: go on with a spool; what failed is tried again", NULL},
    {"seed", 0, 0, G_OPTION_ARG_INT64, &arguments.seed,
        "Of all random numbers (0)", "N"},
    {"threads", 0, 0, G_OPTION_ARG_INT, &arguments.threads,
          "Threads, 0 for all processors (0); of a survey those of each take, 0 for one",
        "N"},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.rest,
          NULL,
        "diagnose TAKE… | compare RECORDED SIMULATED | survey LIST | "
          "simulate MODEL | " "check-simulator COMMAND | effects"},
    {NULL}
  };
  gint code = tool_main_commands (PROGRAM,
      "- say where a simulation of cloth departs from recordings", commands,
      entries, spread_lists (argv), run, &arguments);

  g_free (arguments.model);
  g_free (arguments.effects);
  g_free (arguments.simulator);
  g_free (arguments.format);
  g_free (arguments.scene);
  g_free (arguments.output);
  g_free (arguments.spool);
  g_strfreev (arguments.baselines);
  g_strfreev (arguments.hold_outs);
  g_strfreev (arguments.simulated);
  g_strfreev (arguments.after);
  g_strfreev (arguments.rest);
  return code;
}
