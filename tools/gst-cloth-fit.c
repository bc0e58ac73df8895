/* gst-cloth-fit-1.0: fits a simulated cloth to what cameras saw.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "config.h"

#include <gio/gio.h>
#include <math.h>
#include <glib/gstdio.h>
#include <string.h>

#include "gst/cloth-io/observations.h"
#include "gst/file/jsonwriter.h"
#include "gst/file/output.h"
#include "gst/fit/error.h"
#include "gst/fit/search/evaluate.h"
#include "gst/fit/synthesis/silhouette.h"
#include "gst/fit/synthesis/synthesis.h"
#include "gst/gap/report/view.h"
#include "tools/fit-track.h"
#include "tools/tool.h"

#define PROGRAM "gst-cloth-fit-1.0"

typedef struct
{
  gchar *model, *rig, *output, *spool, *replay;
  gint seed, threads, evaluations;
  gboolean worker, resume, as_they_come;
  FitTrack track;
  gchar **rest;
} Arguments;

/* How long a worker waits for the manager to begin. */
#define JOIN_S 60.
/* Most evaluations, unless told otherwise. */
#define USUAL 1000
/* First steps of a search, as a share of a number's range. */
#define FIRST_STEP 0.25

/* All that is read for a fit. @observations: of each take, NULL where it has none */
typedef struct
{
  GPtrArray *takes, *observations;
  GArray *inputs;
} Inputs;

static void
clear_observations (gpointer item)
{
  if (item)
    cloth_observations_free (item);
}

static void
inputs_clear (Inputs * i)
{
  g_clear_pointer (&i->takes, g_ptr_array_unref);
  g_clear_pointer (&i->observations, g_ptr_array_unref);
  g_clear_pointer (&i->inputs, g_array_unref);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Inputs, inputs_clear);

/* Whether a take is where a fitted one is to be; then says so. */
static gboolean
is_fitted (const Arguments * a, const gchar * folder, GError ** error)
{
  for (guint i = 0; i < g_strv_length (a->rest + 1); i++) {
    g_autofree gchar *name = g_strdup_printf ("take%u", i);
    g_autofree gchar *made = g_build_filename (a->output, name, NULL);
    g_autofree gchar *path = g_canonicalize_filename (made, NULL);

    if (g_str_equal (path, folder)) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "“%s” "
          "would be overwritten by what is made of it: give another --output",
          folder);
      return TRUE;
    }
  }
  return FALSE;
}

static gboolean
load (const Arguments * a, Inputs * i, GError ** error)
{
  gboolean seen = FALSE;

  i->takes = g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_take_free);
  i->observations = g_ptr_array_new_with_free_func (clear_observations);
  i->inputs = g_array_new (FALSE, FALSE, sizeof (ClothSynthesisInput));
  for (gchar ** folder = a->rest + 1; *folder; folder++) {
    g_autofree gchar *own = g_canonicalize_filename (*folder, NULL);
    ClothTake *take = cloth_take_open (*folder, error);
    ClothObservations *observations = NULL;
    ClothSynthesisInput input;

    if (!take)
      return FALSE;
    g_ptr_array_add (i->takes, take);
    if (a->output && is_fitted (a, own, error))
      return FALSE;
    if (!gst_cloth_io_observations_load_take (take, a->rig, &observations,
            error))
      return FALSE;
    g_ptr_array_add (i->observations, observations);
    seen |= observations != NULL;
    /* a mesh says more than what it was made of */
    input = (ClothSynthesisInput) {
    take, cloth_take_get_n_positions (take) ==
          cloth_take_get_n_frames (take) ? NULL : observations};
    g_array_append_val (i->inputs, input);
  }
  if (!a->rig || seen)
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "--rig is of "
      "no use: no take has a folder observations");
  return FALSE;
}

/* Where the fitted cloth was, vertex by vertex measured or, where nobody saw it, predicted. */
static gboolean
write_take (const ClothSynthesisTake * t, ClothTake * from,
    const gchar * folder, GError ** error)
{
  const ClothRecording *r = t->recording;
  const ClothTakeInfo *like = cloth_take_get_info (from);
  g_autoptr (ClothTakeInfo) info = cloth_take_info_copy (like);
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree guint8 *states = g_malloc (r->n);
  g_autofree gfloat *clamps = g_new (gfloat, 3 * like->held->len + 1);

  /* that of cameras is not this cloth's */
  info->noise_sigma_m = NAN;
  writer = cloth_take_writer_new (folder, info, r->scene->topology, error);
  if (!writer)
    return FALSE;
  for (guint f = 0; f < r->n_frames; f++) {
    for (guint v = 0; v < r->n; v++)
      /* an outline says where a vertex may be */
      states[v] = r->seen[(gsize) f * r->n + v] == 1. ? CLOTH_VERTEX_MEASURED :
          CLOTH_VERTEX_PREDICTED;
    for (guint i = 0; i < 3 * like->held->len; i++)
      clamps[i] =
          (gfloat) r->scene->clamps[3 * (gsize) f * like->held->len + i];
    if (!cloth_take_writer_append (writer, r->times[f],
            t->positions + 3 * (gsize) f * r->n, states, NULL,
            like->held->len ? clamps : NULL, error))
      return FALSE;
  }
  return cloth_take_writer_close (writer, error);
}

static void
add_gap (ClothJsonWriter * w, const gchar * name, const ClothSynthesisGap * gap)
{
  cloth_json_writer_begin_object (w, name);
  cloth_json_writer_set_one_line (w, TRUE);
  cloth_json_writer_number (w, "drawn_m", gap->drawn);
  cloth_json_writer_number (w, "windows_m", gap->windows);
  cloth_json_writer_number (w, "free_m", gap->free);
  cloth_json_writer_end_object (w);
  cloth_json_writer_set_one_line (w, FALSE);
}

/* Of each camera how far the cloth is off in each picture, RMS, and how well it covers what was filmed of it:
 * drawn, and let go in windows. */
static void
add_cameras (ClothJsonWriter * w, const Arguments * a,
    const ClothSynthesisTake * t, const ClothObservations * o)
{
  static const gchar *const names[2][3] = {
    {"drawn_px", "drawn_overlap", "drawn_differ_px"},
    {"let_go_px", "let_go_overlap", "let_go_differ_px"}
  };
  const gfloat *positions[2] = { t->positions, t->let_go };
  const guint n = o->rig->n_cameras, n_frames = t->recording->n_frames;
  const gsize all = (gsize) n * n_frames;
  g_autofree gdouble *values = g_new (gdouble, 6 * all);

  for (guint k = 0; k < 2; k++) {
    gdouble *to = values + 3 * k * all;

    cloth_synthesis_reproject (t, positions[k], o, to);
    cloth_synthesis_compare_silhouettes (t->recording, positions[k], o,
        (guint) a->threads, to + all, to + 2 * all);
  }
  cloth_json_writer_begin_array (w, "cameras");
  for (guint c = 0; c < n; c++) {
    const guint n_kinds = cloth_observations_has_silhouettes (o, c) ? 3 : 1;

    cloth_json_writer_begin_object (w, NULL);
    cloth_json_writer_string (w, "name", o->rig->cameras[c].name);
    for (guint kind = 0; kind < n_kinds; kind++)
      for (guint k = 0; k < 2; k++)
        cloth_json_writer_numbers (w, names[k][kind], values +
            (3 * k + kind) * all + (gsize) c * n_frames, n_frames);
    cloth_json_writer_end_object (w);
  }
  cloth_json_writer_end_array (w);
}

/* Of each clamp whose path was not logged, in how many frames it was found, and how well it is known there. */
static void
add_clamps (ClothJsonWriter * w, const ClothRecording * r)
{
  const ClothScene *scene = r->scene;
  const guint n_held = scene->held->len;

  if (!scene->clamps_sd)
    return;
  cloth_json_writer_begin_array (w, "found_clamps");
  for (guint i = 0; i < n_held; i++) {
    gdouble sum = 0;
    guint n = 0;

    for (guint f = 0; f < r->n_frames; f++) {
      const gdouble sd = scene->clamps_sd[(gsize) f * n_held + i];

      sum += sd * sd;
      n += sd > 0;
    }
    if (n == 0)
      continue;
    cloth_json_writer_begin_object (w, NULL);
    cloth_json_writer_set_one_line (w, TRUE);
    cloth_json_writer_count (w, "vertex",
        g_array_index (scene->held, ClothHeld, i).vertex);
    cloth_json_writer_count (w, "frames", n);
    cloth_json_writer_number (w, "sigma_m", sqrt (sum / n));
    cloth_json_writer_end_object (w);
    cloth_json_writer_set_one_line (w, FALSE);
  }
  cloth_json_writer_end_array (w);
}

static void
add_search (ClothJsonWriter * w, const ClothSearch * search)
{
  const ClothSearchCounts counts = cloth_search_get_counts (search);

  cloth_json_writer_begin_object (w, "search");
  cloth_json_writer_set_one_line (w, TRUE);
  cloth_json_writer_string (w, "ended", cloth_search_get_state (search) ==
      CLOTH_SEARCH_CONVERGED ? "converged" : "limit");
  cloth_json_writer_count (w, "evaluations", counts.n_decided);
  cloth_json_writer_count (w, "diverged", counts.n_failed);
  cloth_json_writer_count (w, "moves", counts.n_moves);
  cloth_json_writer_end_object (w);
  cloth_json_writer_set_one_line (w, FALSE);
}

static gboolean
write_numbers (const Arguments * a, const ClothSynthesis * s,
    const Inputs * inputs,
    const ClothSearch * search, const gchar * path, GError ** error)
{
  ClothJsonWriter *w = cloth_json_writer_new ();
  g_autofree gchar *text = NULL;

  cloth_json_writer_begin_object (w, NULL);
  cloth_json_writer_count (w, "version", 1);
  cloth_json_writer_begin_array (w, "numbers");
  for (guint i = 0; i < s->numbers->len; i++) {
    const ClothSynthesisNumber *n =
        &g_array_index (s->numbers, ClothSynthesisNumber, i);

    cloth_json_writer_begin_object (w, NULL);
    cloth_json_writer_set_one_line (w, TRUE);
    cloth_json_writer_string (w, "name", n->name);
    cloth_json_writer_number (w, "before", n->before);
    cloth_json_writer_number (w, "value", n->value);
    cloth_json_writer_number (w, "sigma", n->sigma);
    cloth_json_writer_number (w, "finer", n->finer);
    cloth_json_writer_number (w, "finer_sigma", n->finer_sigma);
    cloth_json_writer_end_object (w);
    cloth_json_writer_set_one_line (w, FALSE);
  }
  cloth_json_writer_end_array (w);
  if (search)
    add_search (w, search);
  cloth_json_writer_begin_array (w, "takes");
  for (guint i = 0; i < s->n_takes; i++) {
    const ClothSynthesisTake *t = &s->takes[i];
    const ClothObservations *seen = g_ptr_array_index (inputs->observations, i);

    cloth_json_writer_begin_object (w, NULL);
    cloth_json_writer_string (w, "name", t->recording->name);
    cloth_json_writer_number (w, "gain", t->gain);
    add_clamps (w, t->recording);
    add_gap (w, "before", &t->before);
    add_gap (w, "after", &t->after);
    if (seen)
      add_cameras (w, a, t, seen);
    cloth_json_writer_end_object (w);
  }
  cloth_json_writer_end_array (w);
  cloth_json_writer_end_object (w);
  text = cloth_json_writer_finish (w);
  cloth_json_writer_free (w);
  return cloth_file_write_text (path, text, error);
}

static gboolean
write_all (const Arguments * a, const ClothSynthesis * s,
    const Inputs * inputs, const ClothSearch * search, GError ** error)
{
  g_autofree gchar *model = cloth_model_to_json (s->model);
  g_autofree gchar *fitted = g_build_filename (a->output, "fitted.json", NULL);
  g_autofree gchar *numbers = g_build_filename (a->output, "fit.json", NULL);
  g_autofree gchar *page = g_build_filename (a->output, "fit.html", NULL);
  g_autoptr (GPtrArray) shown = g_ptr_array_new_with_free_func (g_free);

  for (guint i = 0; i < s->n_takes; i++) {
    ClothTake *take = g_ptr_array_index (inputs->takes, i);
    g_autofree gchar *name = g_strdup_printf ("take%u", i);
    gchar *folder = g_build_filename (a->output, name, NULL);

    if (cloth_take_get_n_positions (take) == cloth_take_get_n_frames (take))
      g_ptr_array_add (shown, g_strdup (cloth_take_get_folder (take)));
    g_ptr_array_add (shown, folder);
    if (!write_take (&s->takes[i], take, folder, error))
      return FALSE;
  }
  if (search) {
    g_autofree gchar *log = g_build_filename (a->output, "search.log", NULL);

    if (!cloth_file_write_text (log, cloth_search_get_log (search), error))
      return FALSE;
  }
  return cloth_file_write_text (fitted, model, error)
      && write_numbers (a, s, inputs, search, numbers, error)
      && cloth_view_write ((const gchar * const *) shown->pdata,
      MIN (shown->len, CLOTH_VIEW_MAX_TAKES), page, error);
}

/* What isn't known is a dash. */
static gchar *
format_number (const gchar * format, gdouble value)
{
  gchar text[32];

  if (isnan (value))
    return g_strdup ("–");
  return g_strdup (g_ascii_formatd (text, sizeof text, format, value));
}

static void
show (const Arguments * a, const ClothSynthesis * s)
{
  g_print ("%-24s %10s %10s %8s %10s %8s\n", "number", "before", "fitted", "±",
      "finer", "±");
  for (guint i = 0; i < s->numbers->len; i++) {
    const ClothSynthesisNumber *n =
        &g_array_index (s->numbers, ClothSynthesisNumber, i);

    g_autofree gchar *sigma = format_number ("%.2g", n->sigma);
    g_autofree gchar *finer = format_number ("%.4g", n->finer);
    g_autofree gchar *finer_sigma = format_number ("%.2g", n->finer_sigma);

    g_print ("%-24s %10.4g %10.4g %8s %10s %8s%s\n", n->name, n->before,
        n->value, sigma, finer, finer_sigma,
        n->at_end ? "  at the end of its range, which may be too " "narrow" :
        "");
  }
  g_print ("finer: what they are on a mesh twice as fine, and how far the "
      "cloth's own may be from that\n");
  g_print ("\n%-24s %30s %30s\n%-24s %10s%10s%10s %10s%10s%10s\n", "gap, mm",
      "before", "fitted", "", "drawn", "windows", "free", "drawn", "windows",
      "free");
  for (guint i = 0; i < s->n_takes; i++) {
    const ClothSynthesisTake *t = &s->takes[i];
    const ClothSynthesisGap *gaps[2] = { &t->before, &t->after };

    g_print ("%-24s", t->recording->name);
    for (guint k = 0; k < 2; k++)
      g_print (" %10.2f%10.2f%10.2f", 1e3 * gaps[k]->drawn,
          1e3 * gaps[k]->windows, 1e3 * gaps[k]->free);
    g_print ("\n");
    if (t->counts.places)
      g_print ("  %.0f%% of its places are where rays meet, %.0f%% on one "
          "camera's ray, along which %.0f%% of their motion is the model's "
          "own, %.0f%% on an outline; of %.1f%% the cameras contradict each other, %.1f%% are where no "
          "cloth can be\n",
          100. * t->counts.triangulated / t->counts.places,
          100. * t->counts.single / t->counts.places, 100. * t->counts.along,
          100. * t->counts.outlined / t->counts.places,
          100. * t->counts.contradicted / t->counts.places,
          100. * t->counts.torn / t->counts.places);
  }
  g_print ("drawn: with springs to what was seen, which always lower it; "
      "windows: let go for 0.3 s; free: from the start\n%s/fit.html\n",
      a->output);
}

static gboolean
go_on (gpointer data, gdouble share)
{
  return !was_interrupted ();
}

static void
add_part (GChecksum * sum, const gchar * text, gsize size)
{
  g_autofree gchar *head = g_strdup_printf ("%" G_GSIZE_FORMAT " ", size);

  g_checksum_update (sum, (const guchar *) head, -1);
  g_checksum_update (sum, (const guchar *) text, (gssize) size);
}

/* What all that evaluate the same trials must agree in: model, takes, rig and seed. */
static gchar *
describe (const Arguments * a, const Inputs * inputs, const ClothModel * model,
    GError ** error)
{
  g_autofree gchar *json = cloth_model_to_json (model);
  g_autofree gchar *rig = NULL;
  g_autofree gchar *seed = g_strdup_printf ("%d", a->seed);
  g_autoptr (GChecksum) sum = g_checksum_new (G_CHECKSUM_SHA256);
  gsize size = 0;

  if (a->rig && !g_file_get_contents (a->rig, &rig, &size, error))
    return NULL;
  add_part (sum, json, strlen (json));
  add_part (sum, rig ? rig : "", size);
  add_part (sum, seed, strlen (seed));
  for (guint i = 0; i < inputs->takes->len; i++) {
    g_autofree gchar *take = cloth_take_sha256 (g_ptr_array_index
        (inputs->takes, i), error);

    if (!take)
      return NULL;
    add_part (sum, take, strlen (take));
  }
  return g_strdup_printf ("fit-search %.12s", g_checksum_get_string (sum));
}

/* Evaluates the trials: by threads, by the workers of a spool, or, of a worker, those of others. */
static gboolean
evaluate (const Arguments * a, const gchar * what, ClothSearch * search,
    ClothSynthesisProblem * problem, GError ** error)
{
  const ClothSpoolOptions options = { what, PACKAGE_VERSION, 0. };
  /* the order of decisions says which number a point has */
  g_autofree gchar *made_of = g_strconcat (what, a->as_they_come ?
      " as-they-come" : " in-order", NULL);
  g_autoptr (ClothSpool) spool = NULL;

  if (!a->spool) {
    cloth_search_run (search, cloth_synthesis_problem_evaluate, problem,
        a->threads ? (guint) a->threads : g_get_num_processors ());
    return TRUE;
  }
  spool = a->worker ? cloth_spool_join (a->spool, &options, JOIN_S, error) :
      cloth_spool_manage (a->spool, &options, made_of, a->resume, error);
  if (spool && !a->worker)
    g_printerr
        ("the points wait for workers: takes, --model, --rig, --seed and "
        "--spool as here, with --worker in place of the rest\n");
  return spool
      && (a->worker ? cloth_search_work_spool (spool,
          cloth_synthesis_problem_get_n (problem),
          cloth_synthesis_problem_evaluate, problem,
          error) : cloth_search_run_spool (search, spool, error));
}

/* Values that came in an order of their own are taken in it again. */
static gboolean
replay (const Arguments * a, ClothSearch * search, GError ** error)
{
  g_autofree gchar *log = NULL;

  if (!a->replay)
    return TRUE;
  if (g_file_get_contents (a->replay, &log, NULL, error)
      && cloth_search_replay (search, log, error))
    return TRUE;
  g_prefix_error (error, "--replay: ");
  return FALSE;
}

static ClothSearch *
search_new (const Arguments * a, const ClothSynthesisProblem * problem,
    const gchar * what, GError ** error)
{
  const guint n = cloth_synthesis_problem_get_n (problem);
  g_autofree gdouble *start = g_new (gdouble, n);
  g_autofree gdouble *low = g_new (gdouble, n);
  g_autofree gdouble *high = g_new (gdouble, n);
  g_autofree gdouble *scale = g_new (gdouble, n);
  ClothSearchOptions options;

  cloth_synthesis_problem_get_room (problem, start, low, high);
  for (guint i = 0; i < n; i++)
    scale[i] = FIRST_STEP * (high[i] - low[i]);
  cloth_search_options_init (&options);
  options.n = n;
  options.start = start;
  options.low = low;
  options.high = high;
  options.scale = scale;
  options.most_evaluations = (guint) a->evaluations;
  options.what = what;
  options.as_they_come = a->as_they_come;
  return cloth_search_new (&options, error);
}

/* Searches, or works for one that does: then there is nothing to show. */
static ClothSynthesis *
find (const Arguments * a, const Inputs * inputs, const ClothModel * model,
    const ClothSynthesisOptions * options, ClothSearch ** search,
    GError ** error)
{
  g_autoptr (ClothSynthesisProblem) problem =
      cloth_synthesis_problem_new ((const ClothSynthesisInput *)
      inputs->inputs->data, inputs->inputs->len, model, options, error);
  g_autofree gchar *what = problem ? describe (a, inputs, model, error) : NULL;
  g_autofree gdouble *point = NULL;

  if (!what)
    return NULL;
  *search = search_new (a, problem, what, error);
  if (!*search || !replay (a, *search, error)
      || !evaluate (a, what, *search, problem, error) || a->worker)
    return NULL;
  if (was_interrupted ()) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED, "stopped");
    return NULL;
  }
  point = g_new (gdouble, cloth_synthesis_problem_get_n (problem));
  cloth_search_get_best (*search, point);
  if (cloth_search_get_state (*search) == CLOTH_SEARCH_NOWHERE) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "the cloth "
        "diverges with all numbers that were tried; start with softer cloth or "
        "more damping, or narrow the ranges");
    return NULL;
  }
  return cloth_synthesis_problem_finish (problem, point, error);
}

/* Points of films instead of a fit. */
static gint
run_track (const Arguments * a)
{
  FitTrack track = a->track;

  if (a->model || a->spool || a->worker || a->resume || a->as_they_come
      || a->replay)
    return complain (BAD_USAGE, "--model, --spool, --worker, --resume, "
        "--as-they-come and --replay are not of the command track");
  if (!a->rig || !a->track.tracker || !a->track.size || !a->output
      || !a->rest[1]
      || !track.backgrounds)
    return complain (BAD_USAGE, "name the films and --rig, --tracker, "
        "--pattern-size, --background for each film, and --output");
  if (a->threads < 0)
    return complain (BAD_USAGE, "--threads: give 0 for all, or a number");
  track.rig = a->rig;
  track.output = a->output;
  track.films = a->rest + 1;
  track.seed = a->seed;
  track.threads = a->threads;
  return fit_track (&track);
}

static gint
check (const Arguments * a)
{
  const gboolean searches = a->rest && !strcmp (a->rest[0], "search");

  if (a->track.tracker || a->track.size || a->track.near || a->track.grid
      || a->track.held || a->track.backgrounds || a->track.anneal
      || a->track.ground != 0)
    return complain (BAD_USAGE,
        "--tracker, --pattern-size, --background, "
        "--ground, --near, --grid, --held and --anneal are of the command track");
  if (!a->rest || (strcmp (a->rest[0], "fit") && !searches))
    return complain (BAD_USAGE, "name the command: fit TAKE… --model MODEL "
        "--output DIR, search, or track");
  if (!a->rest[1])
    return complain (BAD_USAGE, "name the takes to fit");
  if (!a->model || (!a->output && !a->worker))
    return complain (BAD_USAGE, "name the model, --model model.json, and the "
        "folder of what is made, --output DIR");
  if (a->threads < 0)
    return complain (BAD_USAGE, "--threads: give 0 for all, or a number");
  if (!searches && (a->spool || a->worker || a->resume || a->as_they_come
          || a->replay || a->evaluations != USUAL))
    return complain (BAD_USAGE,
        "--evaluations, --spool, --worker, --resume, --as-they-come and "
        "--replay are of the command search");
  if (a->evaluations < 1
      || (guint) a->evaluations > CLOTH_SEARCH_MAX_EVALUATIONS)
    return complain (BAD_USAGE, "--evaluations: give a number from 1 to %u",
        CLOTH_SEARCH_MAX_EVALUATIONS);
  if ((a->worker || a->resume) && !a->spool)
    return complain (BAD_USAGE, "name the spool: --spool DIR");
  if (a->worker && (a->output || a->resume || a->replay
          || a->evaluations != USUAL))
    return complain (BAD_USAGE,
        "--worker takes the takes, --model, --rig, --seed "
        "and --spool: all else is the manager's");
  return DONE;
}

static gint
run (gconstpointer data)
{
  const Arguments *a = data;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = NULL;
  g_autoptr (ClothSynthesis) synthesis = NULL;
  g_autoptr (ClothSearch) search = NULL;
  g_auto (Inputs) inputs = { NULL };
  ClothSynthesisOptions options;
  gboolean is_new;

  if (a->rest && !strcmp (a->rest[0], "track"))
    return run_track (a);
  if (check (a) != DONE)
    return BAD_USAGE;
  model = cloth_model_load (a->model, &error);
  if (!model)
    return complain (FAILED, "--model: %s", error->message);
  if (!load (a, &inputs, &error))
    return complain (FAILED, "%s", error->message);
  is_new = a->output && !g_file_test (a->output, G_FILE_TEST_EXISTS);
  if (!a->worker && !cloth_folder_make (a->output, &error))
    return complain (FAILED, "%s", error->message);
  /* a spool keeps what was done, so that its ends may be killed */
  if (!a->spool)
    catch_interrupts ();
  cloth_synthesis_options_init (&options);
  options.rollout.seed = (guint64) a->seed;
  options.rollout.threads = (guint) a->threads;
  options.rollout.progress = go_on;
  if (!strcmp (a->rest[0], "fit"))
    synthesis = cloth_synthesis_fit ((const ClothSynthesisInput *)
        inputs.inputs->data, inputs.inputs->len, model, &options, &error);
  else
    synthesis = find (a, &inputs, model, &options, &search, &error);
  if (a->worker && !error)
    return DONE;
  if (!synthesis || !write_all (a, synthesis, &inputs, search, &error)) {
    /* of a folder with anything in it nothing is taken */
    if (is_new)
      g_rmdir (a->output);
    return g_error_matches (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED) ?
        complain (FAILED, "stopped; nothing was written") : complain (FAILED,
        "%s", error->message);
  }
  show (a, synthesis);
  if (search)
    g_print ("%u points were tried, %u of them diverged; the search %s\n",
        cloth_search_get_counts (search).n_decided,
        cloth_search_get_counts (search).n_failed,
        cloth_search_get_state (search) == CLOTH_SEARCH_CONVERGED ?
        "converged" : "ended at --evaluations");
  return DONE;
}

static const ToolCommand commands[] = {
  {"fit", "TAKE… --model MODEL --output DIR",
        "Fits the free numbers of a model so that its simulation follows what was "
        "filmed.\nA take may have positions, or only what cameras saw. "
        "DIR/fitted.json is the model,\nDIR/fit.json has its numbers with their "
        "deviations and how far the cloth is off in\neach picture, DIR/take0 is "
        "the fitted cloth of the first take, DIR/fit.html shows it.",
      PROGRAM " fit film --model model.json --output fit"},
  {"search", "TAKE… --model MODEL --output DIR [--spool DIR]",
        "Finds the free numbers by a pattern search, without derivatives: for cloth "
        "that folds\nonto itself or touches things. What is made is as of fit, "
        "without deviations of the\nnumbers, and DIR/search.log has each value. "
        "With --spool the points are evaluated by\nworkers on this machine or "
        "others: the same command with --worker, without --output.",
      PROGRAM " search film --model model.json --output found"},
  {"track",
        "FILM… --rig RIG --tracker NAME --pattern-size W,H --background FILE… "
        "--output DIR",
        "Follows points of a printed cloth that lies flat on the ground in the first "
        "picture.\nGive a film and a picture of the empty scene for each camera, in the "
        "rig's order.\nNAME is reference, frames or multi: markers in space, or "
        "reference-2d, lucas-kanade,\nframes-2d or uvless: features in pictures. "
        "DIR/track.json has the points of each frame,\nDIR/markers.csv those in "
        "space.",
      PROGRAM " track cam0.mp4 cam1.mp4 --rig rig.json --tracker multi \\\n"
        "    --pattern-size 63cm,67cm --background empty0.png --background empty1.png \\\n"
        "    --near -0.3,0.3 --output tracks"},
  {NULL}
};

int
main (int argc, char **argv)
{
  Arguments a = {.evaluations = USUAL };
  const GOptionEntry entries[] = {
    {"model", 'm', 0, G_OPTION_ARG_FILENAME, &a.model,
        "fit, search: What is known of the cloth, and what is free", "FILE"},
    {"rig", 0, 0, G_OPTION_ARG_FILENAME, &a.rig,
        "The rig, in place of rig.json in the takes' folders", "FILE"},
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &a.output,
        "The folder of what is made", "DIR"},
    {"spool", 0, 0, G_OPTION_ARG_FILENAME, &a.spool,
        "search: The folder through which workers evaluate", "DIR"},
    {"worker", 0, 0, G_OPTION_ARG_NONE, &a.worker,
        "search: Evaluate for the search of this spool", NULL},
    {"resume", 0, 0, G_OPTION_ARG_NONE, &a.resume,
        "search: Go on with a spool whose search was stopped", NULL},
    {"as-they-come", 0, 0, G_OPTION_ARG_NONE, &a.as_they_come,
        "search: Decide in the order in which values come: no worker waits, and the search "
          "may be another each time", NULL},
    {"replay", 0, 0, G_OPTION_ARG_FILENAME, &a.replay,
          "search: A search.log, whose values are taken again in its order",
        "FILE"},
    {"evaluations", 0, 0, G_OPTION_ARG_INT, &a.evaluations,
        "search: Most points that are tried (1000)", "N"},
    {"seed", 0, 0, G_OPTION_ARG_INT, &a.seed, "Of its random numbers (0)", "N"},
    {"threads", 0, 0, G_OPTION_ARG_INT, &a.threads,
        "Threads to use, 0 for all (0)", "N"},
    {"tracker", 0, 0, G_OPTION_ARG_STRING, &a.track.tracker,
        "track: Which points are followed, and how", "NAME"},
    {"pattern-size", 0, 0, G_OPTION_ARG_STRING, &a.track.size,
        "track: Width and height of the cloth, as 63cm,67cm", "W,H"},
    {"background", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &a.track.backgrounds,
          "track: What a camera sees without the cloth; one for each film",
        "FILE"},
    {"ground", 0, 0, G_OPTION_ARG_DOUBLE, &a.track.ground,
          "track: Height of the lying cloth's surface in the rig's world, m (0)",
        "Z"},
    {"near", 0, 0, G_OPTION_ARG_STRING, &a.track.near,
        "track: A place near to the print's top left corner, m", "X,Y"},
    {"grid", 0, 0, G_OPTION_ARG_STRING, &a.track.grid,
          "track: Make DIR a take to fit a cloth to, with so many columns and rows of "
          "vertices",
        "COLUMNS,ROWS"},
    {"held", 0, 0, G_OPTION_ARG_STRING, &a.track.held,
          "track: Vertices of it that hands hold, 0 the print's top left",
        "VERTEX,…"},
    {"anneal", 0, 0, G_OPTION_ARG_NONE, &a.track.anneal,
        "track: Find where the cloth lies by simulated annealing", NULL},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &a.rest, NULL,
        "fit|search TAKE… | track FILM…"},
    {NULL}
  };
  gint code = tool_main_commands (PROGRAM, "- fit a simulated cloth to what "
      "cameras saw", commands, entries, g_strdupv (argv), run, &a);

  g_free (a.model);
  g_free (a.rig);
  g_free (a.output);
  g_free (a.spool);
  g_free (a.replay);
  g_free (a.track.tracker);
  g_free (a.track.size);
  g_free (a.track.near);
  g_free (a.track.grid);
  g_free (a.track.held);
  g_strfreev (a.track.backgrounds);
  g_strfreev (a.rest);
  return code;
}
