/* gst-cloth-gap-1.0 diagnose: says where a simulation departs from takes, and why.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-tool.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <stdlib.h>
#include <unistd.h>

#include "gst/cloth-io/observations.h"
#include "gst/gap/diagnose.h"
#include "gst/gap/report/report.h"
#include "gst/rig/rigfile.h"
#include "gst/rig/world.h"
#include "tools/gap-simulator.h"

static gboolean
go_on (gpointer data, gdouble share, const gchar * what)
{
  tell_progress (share, what);
  return !was_interrupted ();
}

static GPtrArray *
open_takes (gchar ** folders, GError ** error)
{
  g_autoptr (GPtrArray) takes =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_take_free);

  for (guint i = 0; folders && folders[i]; i++) {
    g_autofree gchar *json = g_build_filename (folders[i], "take.json", NULL);
    ClothTake *take;

    if (!g_file_test (json, G_FILE_TEST_EXISTS)) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "“%s” is no take: there is no take.json in it; give the folder that "
          "holds take.json and positions.npy", folders[i]);
      return NULL;
    }
    take = cloth_take_open (folders[i], error);
    if (!take)
      return NULL;
    g_ptr_array_add (takes, take);
  }
  return g_steal_pointer (&takes);
}

static gboolean
check_cloths (gchar ** folders, const GPtrArray * takes, const gchar * first,
    ClothTake * take, GError ** error)
{
  for (guint i = 0; i < takes->len; i++)
    if (!cloth_gap_check_same_cloth (folders[i],
            cloth_take_get_topology (g_ptr_array_index (takes, i)), first,
            cloth_take_get_topology (take), error))
      return FALSE;
  return TRUE;
}

/* What the cameras saw of each take, NULL where it doesn't say. */
static GPtrArray *
load_observations (gchar ** folders, const GPtrArray * takes, GError ** error)
{
  g_autoptr (GPtrArray) list =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_observations_free);

  for (guint i = 0; i < takes->len; i++) {
    ClothObservations *observations;

    if (!gst_cloth_io_observations_load_take (g_ptr_array_index (takes, i),
            NULL, &observations, error)) {
      g_prefix_error (error, "“%s”: ", folders[i]);
      return NULL;
    }
    g_ptr_array_add (list, observations);
  }
  return g_steal_pointer (&list);
}

/* A world that is a camera's has its z along the picture, not against gravity. */
static void
note_worlds (gchar ** folders, ClothGapResult * result)
{
  for (guint i = 0; folders[i]; i++) {
    g_autofree gchar *path = g_build_filename (folders[i], "rig.json", NULL);
    g_autoptr (ClothRig) rig = g_file_test (path, G_FILE_TEST_EXISTS)
        ? cloth_rig_load (path, NULL) : NULL;
    const ClothCamera *camera = rig ? cloth_world_camera (rig) : NULL;

    if (camera) {
      g_autofree gchar *note =
          g_strdup_printf ("The world of “%s” is that of "
          "its camera %s, whose z is up in the picture: if that was not level, "
          "gravity is off by as much, and a perfect simulation differs. Turn "
          "the rig with “gst-cloth-calibrate-1.0 upright”, and record with "
          "that.", folders[i], camera->name);

      cloth_gap_result_add_note (result, note);
    }
  }
}

static ClothGapResult *
run_diagnosis (const Arguments * arguments, gchar ** effects,
    GapSimulator * simulator, GError ** error)
{
  gchar **folders = arguments->rest + 1;
  g_autoptr (ClothModel) model = cloth_model_load (arguments->model, error);
  g_autoptr (GPtrArray) takes = NULL;
  g_autoptr (GPtrArray) baselines = NULL;
  g_autoptr (GPtrArray) hold_outs = NULL;
  g_autoptr (GPtrArray) simulated = NULL;
  g_autoptr (GPtrArray) after = NULL;
  g_autoptr (GPtrArray) observations = NULL;
  g_autoptr (GPtrArray) baseline_observations = NULL;
  g_autoptr (GPtrArray) hold_out_observations = NULL;
  ClothGapOptions options = { 0 };
  ClothTake *first;

  if (!model) {
    g_prefix_error (error, "--model: ");
    return NULL;
  }
  if (!(takes = open_takes (folders, error)) ||
      !(baselines = open_takes (arguments->baselines, error)) ||
      !(hold_outs = open_takes (arguments->hold_outs, error)) ||
      !(simulated = open_takes (arguments->simulated, error)) ||
      !(after = open_takes (arguments->after, error)))
    return NULL;
  first = g_ptr_array_index (takes, 0);
  if (!check_cloths (folders, takes, folders[0], first, error) ||
      !check_cloths (arguments->baselines, baselines, folders[0], first, error)
      || !check_cloths (arguments->hold_outs, hold_outs, folders[0], first,
          error))
    return NULL;
  if (!(observations = load_observations (folders, takes, error)) ||
      !(baseline_observations =
          load_observations (arguments->baselines, baselines, error))
      || !(hold_out_observations =
          load_observations (arguments->hold_outs, hold_outs, error)))
    return NULL;
  options.observations = (ClothObservations **) observations->pdata;
  options.baseline_observations =
      (ClothObservations **) baseline_observations->pdata;
  options.hold_out_observations =
      (ClothObservations **) hold_out_observations->pdata;
  options.baselines = (ClothTake **) baselines->pdata;
  options.n_baselines = baselines->len;
  options.hold_outs = (ClothTake **) hold_outs->pdata;
  options.n_hold_outs = hold_outs->len;
  options.simulated = (ClothTake **) simulated->pdata;
  options.n_simulated = simulated->len;
  options.after = (ClothTake **) after->pdata;
  options.n_after = after->len;
  options.simulator = simulator ? gap_simulator_get (simulator) : NULL;
  options.simulator_runs = (guint) arguments->simulator_runs;
  options.model_file = arguments->model;
  options.effects = (const gchar * const *) effects;
  options.seed = (guint64) arguments->seed;
  options.threads = (guint) arguments->threads;
  options.progress = go_on;
  return cloth_gap_diagnose ((ClothTake **) takes->pdata, takes->len, model,
      &options, error);
}

/* The folder that two of the lists share, or one has twice, or NULL: what judges must not be
 * judged. Only a simulation may serve several recordings of one motion. */
static gchar *
find_shared (const Arguments * arguments)
{
  gchar **lists[] = { arguments->rest + 1, arguments->baselines,
    arguments->hold_outs, arguments->simulated, arguments->after
  };
  g_autoptr (GHashTable) seen =
      g_hash_table_new_full (g_str_hash, g_str_equal, free, NULL);

  for (guint k = 0; k < G_N_ELEMENTS (lists); k++) {
    for (guint i = 0; lists[k] && lists[k][i]; i++) {
      gchar *path = realpath (lists[k][i], NULL);
      gpointer list = path ? g_hash_table_lookup (seen, path) : NULL;

      if (list && (k < 3 || list != lists[k])) {
        free (path);
        return g_strdup (lists[k][i]);
      }
      /* One that is not there is told of when it is opened. */
      if (path)
        g_hash_table_insert (seen, path, lists[k]);
    }
  }
  return NULL;
}

static gint
check_usage (const Arguments * arguments, gchar *** effects)
{
  g_autofree gchar *shared = NULL;
  g_autoptr (GError) error = NULL;

  if (arguments->format || arguments->scene)
    return complain (BAD_USAGE, "diagnose takes neither --format nor --scene");
  if (!arguments->rest[1])
    return complain (BAD_USAGE,
        "name the takes to diagnose, before the options: "
        "diagnose TAKE --model MODEL --output DIR");
  if (!arguments->model)
    return complain (BAD_USAGE,
        "name the model that the takes are held against: --model model.json");
  if (!arguments->output)
    return complain (BAD_USAGE, "name the folder of the report: --output DIR");
  if (arguments->threads < 0)
    return complain (BAD_USAGE, "--threads: give 0 for all, or a number");
  if (arguments->simulator && (arguments->simulated || arguments->after))
    return complain (BAD_USAGE,
        "--simulator makes what --simulated and --after "
        "give; leave these out");
  if (arguments->simulator_runs < 0)
    return complain (BAD_USAGE, "--simulator-runs: give a number, 0 for none");
  if (arguments->run_seconds < 1)
    return complain (BAD_USAGE, "--run-seconds: give a number of 1 or more");
  shared = find_shared (arguments);
  if (shared)
    return complain (BAD_USAGE,
        "“%s” is given twice: a take can't be its own "
        "baseline, hold-out or simulation; leave one out", shared);
  *effects = cloth_gap_effects_parse (arguments->effects, &error);
  if (error)
    return complain (BAD_USAGE, "--effects: %s", error->message);
  if (arguments->effects && !*effects)
    return complain (BAD_USAGE, "--effects: name effects with commas between "
        "them, or leave it out for all");
  return DONE;
}

/* Makes the folder early: what can't be written is better known before the work. */
static gboolean
make_output (const gchar * folder, gboolean * made)
{
  *made = !g_file_test (folder, G_FILE_TEST_EXISTS);
  return g_mkdir_with_parents (folder, 0777) == 0 &&
      g_access (folder, W_OK | X_OK) == 0;
}

gint
diagnose (const Arguments * arguments)
{
  g_auto (GStrv) effects = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (GapSimulator) simulator = NULL;
  g_autoptr (ClothGapResult) result = NULL;
  gboolean made;
  gint code = check_usage (arguments, &effects);

  if (code != DONE)
    return code;
  if (!make_output (arguments->output, &made))
    return complain (FAILED,
        "cannot write into the folder “%s”: give another --output",
        arguments->output);
  catch_interrupts ();
  if (arguments->simulator)
    simulator = gap_simulator_new (arguments->simulator,
        (guint) arguments->run_seconds, &error);
  if (!error)
    result = run_diagnosis (arguments, effects, simulator, &error);
  if (result)
    note_worlds (arguments->rest + 1, result);
  if (result && cloth_gap_result_write (result, arguments->output, &error)) {
    const gchar *verdict = cloth_gap_verdict_name (result->verdict);
    g_autofree gchar *summary = cloth_gap_result_summary (result);
    const gsize n = strlen (verdict);

    /* a summary may begin with the verdict, which is said once */
    if (!g_ascii_strncasecmp (summary, verdict, n) && summary[n] == ':')
      g_print ("%s%s\n", verdict, summary + n);
    else
      g_print ("%s: %s\n", verdict, summary);
    for (guint i = 0; i < result->notes->len; i++)
      g_print ("%s\n", (const gchar *) result->notes->pdata[i]);
    g_print ("%s%sreport.html\n", arguments->output,
        g_str_has_suffix (arguments->output, "/") ? "" : "/");
    return DONE;
  }
  /* Only an empty folder goes. */
  if (made)
    g_rmdir (arguments->output);
  if (g_error_matches (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED)
      || g_error_matches (error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
    return complain (FAILED, "stopped; nothing was written");
  return complain (FAILED, "%s", error->message);
}

/* The short form of diagnose: one recording and what was simulated of it. */
gint
compare_takes (const Arguments * arguments)
{
  gchar **words = arguments->rest;
  gchar *rest[] = { words[0], words[1], NULL };
  gchar *simulated[] = { words[1] ? words[2] : NULL, NULL };
  Arguments one = *arguments;

  if (!words[1] || !words[2] || words[3])
    return complain (BAD_USAGE,
        "compare takes one recording and its simulation: compare RECORDED "
        "SIMULATED --model MODEL --output DIR; give several to diagnose "
        "TAKE… --simulated TAKE…");
  if (arguments->simulated || arguments->hold_outs || arguments->simulator)
    return complain (BAD_USAGE,
        "compare takes no --simulated, no --hold-out and "
        "no --simulator; give these to diagnose");
  one.rest = rest;
  one.simulated = simulated;
  return diagnose (&one);
}
