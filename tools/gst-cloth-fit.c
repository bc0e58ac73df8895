/* gst-cloth-fit-1.0: fits a simulated cloth to what cameras saw.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/cloth-io/observations.h"
#include "gst/file/jsonwriter.h"
#include "gst/file/output.h"
#include "gst/fit/error.h"
#include "gst/fit/synthesis/silhouette.h"
#include "gst/fit/synthesis/synthesis.h"
#include "gst/gap/report/view.h"
#include "gst/rig/rigfile.h"
#include "tools/tool.h"

#define PROGRAM "gst-cloth-fit-1.0"

typedef struct
{
  gchar *model, *rig, *output;
  gint seed, threads;
  gchar **rest;
} Arguments;

/* All that is read for a fit. */
typedef struct
{
  GPtrArray *takes, *observations;
  GArray *inputs;
} Inputs;

static void
clear_observations (gpointer item)
{
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

/* Puts another rig of the same cameras in place of the take's. */
static gboolean
replace_rig (ClothObservations * observations, const gchar * path,
    GError ** error)
{
  g_autoptr (ClothRig) rig = cloth_rig_load (path, error);

  if (!rig)
    return FALSE;
  for (guint c = 0; c < MAX (rig->n_cameras, observations->rig->n_cameras); c++)
    if (rig->n_cameras != observations->rig->n_cameras
        || strcmp (rig->cameras[c].name,
            observations->rig->cameras[c].name) != 0) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "--rig: “%s” has not the cameras of the take's own rig.json, in its "
          "order", path);
      return FALSE;
    }
  cloth_rig_free (observations->rig);
  observations->rig = g_steal_pointer (&rig);
  return TRUE;
}

static gboolean
load (const Arguments * a, Inputs * i, GError ** error)
{
  i->takes = g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_take_free);
  i->observations = g_ptr_array_new_with_free_func (clear_observations);
  i->inputs = g_array_new (FALSE, FALSE, sizeof (ClothSynthesisInput));
  for (gchar ** folder = a->rest + 1; *folder; folder++) {
    ClothTake *take = cloth_take_open (*folder, error);
    ClothObservations *observations = NULL;
    ClothSynthesisInput input;

    if (!take)
      return FALSE;
    g_ptr_array_add (i->takes, take);
    if (!gst_cloth_io_observations_load_take (take, &observations, error))
      return FALSE;
    if (observations)
      g_ptr_array_add (i->observations, observations);
    if (observations && a->rig && !replace_rig (observations, a->rig, error))
      return FALSE;
    input = (ClothSynthesisInput) {
    take, observations};
    g_array_append_val (i->inputs, input);
  }
  return TRUE;
}

/* Whether a camera saw the vertex; an outline alone says where it may be. */
static gboolean
is_measured (const ClothRecording * r, gsize at)
{
  const gdouble *draw = r->noise ? r->noise->draw + 6 * at : NULL;

  return r->seen[at] > 0. && (!draw || draw[0] + draw[1] + draw[2] > 1.5);
}

/* Where the fitted cloth was, vertex by vertex measured or, where nobody saw it, predicted. */
static gboolean
write_take (const ClothSynthesisTake * t, ClothTake * from,
    const gchar * folder, GError ** error)
{
  const ClothRecording *r = t->recording;
  const ClothTakeInfo *like = cloth_take_get_info (from);
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (like->name);
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree guint8 *states = g_malloc (r->n);
  g_autofree gfloat *clamps = g_new (gfloat, 3 * like->held->len + 1);

  info->fps = like->fps;
  info->columns = like->columns;
  info->rows = like->rows;
  info->width_m = like->width_m;
  info->height_m = like->height_m;
  info->mesh = g_strdup (like->mesh);
  memcpy (info->gravity, like->gravity, sizeof info->gravity);
  g_array_append_vals (info->held, like->held->data, like->held->len);
  writer = cloth_take_writer_new (folder, info, r->scene->topology, error);
  if (!writer)
    return FALSE;
  for (guint f = 0; f < r->n_frames; f++) {
    for (guint v = 0; v < r->n; v++)
      states[v] = is_measured (r, (gsize) f * r->n + v) ?
          CLOTH_VERTEX_MEASURED : CLOTH_VERTEX_PREDICTED;
    if (like->held->len && !cloth_take_read_clamps (from, f, clamps, error))
      return FALSE;
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

/* How well the cloth covers what a camera filmed of it in each picture: drawn, and let go in windows. */
static void
add_silhouettes (ClothJsonWriter * w, const ClothSynthesisTake * t,
    const ClothObservations * o, guint camera)
{
  const guint n_frames = t->recording->n_frames;
  const gfloat *positions[2] = { t->positions, t->let_go };
  static const gchar *const names[2][2] = {
    {"drawn_overlap", "drawn_differ_px"}, {"let_go_overlap",
        "let_go_differ_px"}
  };
  g_autofree gdouble *overlaps = g_new (gdouble, n_frames);
  g_autofree gdouble *differences = g_new (gdouble, n_frames);

  for (guint k = 0; k < 2; k++) {
    cloth_synthesis_compare_silhouettes (t->recording, positions[k], o, camera,
        overlaps, differences);
    cloth_json_writer_numbers (w, names[k][0], overlaps, n_frames);
    cloth_json_writer_numbers (w, names[k][1], differences, n_frames);
  }
}

/* Of each camera RMS distances in each picture: drawn, and let go in windows. */
static void
add_cameras (ClothJsonWriter * w, const ClothSynthesisTake * t,
    const ClothObservations * o)
{
  const guint n = o->rig->n_cameras, n_frames = t->recording->n_frames;
  g_autofree gdouble *drawn = g_new (gdouble, (gsize) n * n_frames);
  g_autofree gdouble *let_go = g_new (gdouble, (gsize) n * n_frames);

  cloth_synthesis_reproject (t, t->positions, o, drawn);
  cloth_synthesis_reproject (t, t->let_go, o, let_go);
  cloth_json_writer_begin_array (w, "cameras");
  for (guint c = 0; c < n; c++) {
    cloth_json_writer_begin_object (w, NULL);
    cloth_json_writer_string (w, "name", o->rig->cameras[c].name);
    cloth_json_writer_numbers (w, "drawn_px", drawn + (gsize) c * n_frames,
        n_frames);
    cloth_json_writer_numbers (w, "let_go_px", let_go + (gsize) c * n_frames,
        n_frames);
    if (cloth_observations_has_silhouettes (o, c))
      add_silhouettes (w, t, o, c);
    cloth_json_writer_end_object (w);
  }
  cloth_json_writer_end_array (w);
}

static gboolean
write_numbers (const ClothSynthesis * s, const Inputs * inputs,
    const gchar * path, GError ** error)
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
    cloth_json_writer_end_object (w);
    cloth_json_writer_set_one_line (w, FALSE);
  }
  cloth_json_writer_end_array (w);
  cloth_json_writer_begin_array (w, "takes");
  for (guint i = 0; i < s->n_takes; i++) {
    const ClothSynthesisTake *t = &s->takes[i];
    const ClothSynthesisInput *input =
        &g_array_index (inputs->inputs, ClothSynthesisInput, i);

    cloth_json_writer_begin_object (w, NULL);
    cloth_json_writer_string (w, "name", t->recording->name);
    cloth_json_writer_number (w, "gain", t->gain);
    add_gap (w, "before", &t->before);
    add_gap (w, "after", &t->after);
    if (input->observations)
      add_cameras (w, t, input->observations);
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
    const Inputs * inputs, GError ** error)
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
  return cloth_file_write_text (fitted, model, error)
      && write_numbers (s, inputs, numbers, error)
      && cloth_view_write ((const gchar * const *) shown->pdata,
      MIN (shown->len, CLOTH_VIEW_MAX_TAKES), page, error);
}

static void
show (const Arguments * a, const ClothSynthesis * s)
{
  g_print ("%-24s %12s %12s %12s\n", "number", "before", "fitted", "±");
  for (guint i = 0; i < s->numbers->len; i++) {
    const ClothSynthesisNumber *n =
        &g_array_index (s->numbers, ClothSynthesisNumber, i);

    g_print ("%-24s %12.4g %12.4g %12.2g%s\n", n->name, n->before, n->value,
        n->sigma, n->at_end ? "  at the end of its range, which may be too "
        "narrow" : "");
  }
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

static gint
run (gconstpointer data)
{
  const Arguments *a = data;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = NULL;
  g_autoptr (ClothSynthesis) synthesis = NULL;
  g_auto (Inputs) inputs = { NULL };
  ClothSynthesisOptions options;

  if (!a->rest || strcmp (a->rest[0], "fit"))
    return complain (BAD_USAGE, "name the command: fit TAKE… --model MODEL "
        "--output DIR");
  if (!a->rest[1])
    return complain (BAD_USAGE, "name the takes to fit");
  if (!a->model || !a->output)
    return complain (BAD_USAGE, "name the model, --model model.json, and the "
        "folder of what is made, --output DIR");
  if (a->threads < 0)
    return complain (BAD_USAGE, "--threads: give 0 for all, or a number");
  model = cloth_model_load (a->model, &error);
  if (!model)
    return complain (FAILED, "--model: %s", error->message);
  if (!load (a, &inputs, &error))
    return complain (FAILED, "%s", error->message);
  if (g_mkdir_with_parents (a->output, 0777) != 0)
    return complain (FAILED, "cannot make the folder “%s”: %s", a->output,
        g_strerror (errno));
  catch_interrupts ();
  cloth_synthesis_options_init (&options);
  options.rollout.seed = (guint64) a->seed;
  options.rollout.threads = (guint) a->threads;
  options.rollout.progress = go_on;
  synthesis = cloth_synthesis_fit ((const ClothSynthesisInput *)
      inputs.inputs->data, inputs.inputs->len, model, &options, &error);
  if (!synthesis || !write_all (a, synthesis, &inputs, &error))
    return g_error_matches (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED) ?
        complain (FAILED, "stopped; nothing was written") : complain (FAILED,
        "%s", error->message);
  show (a, synthesis);
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
  {NULL}
};

int
main (int argc, char **argv)
{
  Arguments a = { 0 };
  const GOptionEntry entries[] = {
    {"model", 'm', 0, G_OPTION_ARG_FILENAME, &a.model,
        "What is known of the cloth, and what is free", "FILE"},
    {"rig", 0, 0, G_OPTION_ARG_FILENAME, &a.rig,
        "A rig in place of the one in the take's folder", "FILE"},
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &a.output,
        "The folder of what is made", "DIR"},
    {"seed", 0, 0, G_OPTION_ARG_INT, &a.seed, "Of its random numbers (0)", "N"},
    {"threads", 0, 0, G_OPTION_ARG_INT, &a.threads,
        "Threads to use, 0 for all (0)", "N"},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &a.rest, NULL,
        "fit TAKE…"},
    {NULL}
  };
  gint code = tool_main_commands (PROGRAM, "- fit a simulated cloth to what "
      "cameras saw", commands, entries, g_strdupv (argv), run, &a);

  g_free (a.model);
  g_free (a.rig);
  g_free (a.output);
  g_strfreev (a.rest);
  return code;
}
