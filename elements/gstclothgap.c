/* clothgap: where a stream of meshes or observations departs from a simulation of the
 * cloth, and why.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
/**
 * SECTION:element-clothgap
 * @title: clothgap
 * @short_description: holds a stream of meshes or observations against a simulation
 *
 * Simulates the cloth of `model` in the scene of the take `location` beside the stream,
 * drawn to the meshes by weak springs, and puts what remains, recorded minus simulated
 * position of every vertex, on each mesh as #GstClothGap. `clothoverlay` draws it.
 *
 * The stream time is the scene's: what comes before its first or after its last frame
 * passes without a gap. A frame's gap needs the three frames behind it, so buffers leave
 * that much later.
 *
 * ## Observations
 * What one `camera` of `rig` saw lies on rays. All that is measured is across them: so
 * are the springs, the residuals and the scores. Along them the simulation is believed,
 * from the scene's start on, and the recording that is diagnosed at the end has the
 * simulation's distances from the camera. What moves the cloth along the line of sight stays
 * unseen; join two or more cameras by `triangulate` to see it. A recording from one camera
 * says nothing about the camera itself.
 *
 * ## Several cameras
 * Meshes of `triangulate` carry what each camera saw (#GstClothView). When `rig` has these cameras, what
 * one of them alone saw, and the mesh therefore has not, counts across its ray. What several saw and the mesh
 * has not, they contradict each other about: it counts as not seen. At the end the whole recording is
 * diagnosed as what all cameras saw of it, as `gst-cloth-gap-1.0` does it with a take that has observations
 * and no positions.
 *
 * ## Messages
 * `clothgap/score`, for each window: `time` and `duration` (nanoseconds of stream time),
 * `rms` (double, metres: the simulation starts where the springs have brought it and runs
 * free), `coverage` (double: the share of the vertices that were seen).
 *
 * `clothgap/verdict`, at the end and before EOS goes on: `verdict`, `summary`, `json` (all
 * of gap.json; strings), `detection-limits` (array of structures with `effect`, `parameter`,
 * `unit`, `text` (strings) and `value` (double: how far from where the effect is not there it
 * would have shown with a probability of 95%; lacking where it would not at all)) and, with
 * `output`, `report` (string: path of report.html). The whole recording is diagnosed then, which takes its time. Where the folders of `location`
 * and `baseline` say what the cameras saw (rig.json, observations), it is read at the start.
 * With `simulated` the verdict is on what your simulator made of the scene; scores and
 * residuals are still those of ours.
 *
 * After a flush, or when a new segment goes back in time, it starts anew.
 *
 * ## Example
 * |[
 * gst-launch-1.0 -m meshsrc location=take ! clothgap model=model.json location=take \
 *     output=gap ! fakesink
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothgap.h"

#include <math.h>

#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"
#include "gst/cloth-io/observations.h"
#include "gst/gap/inputs.h"
#include "gst/gap/diagnose.h"
#include "gst/gap/report/report.h"

GST_DEBUG_CATEGORY_STATIC (cloth_gap_debug);
#define GST_CAT_DEFAULT cloth_gap_debug

/* Of the springs: 1/s², and as a share of critical. */
#define GAIN 100.0
#define DAMPING_RATIO 0.5

typedef struct
{
  gchar *baseline, *simulated, *effects, *output;
} Settings;

struct _GstGapDiagnose
{
  GstClothFollow parent;

  /* with the object lock */
  Settings settings;

  /* from open to close */
  ClothTake *baseline, *simulated;
  ClothObservations *observations, *baseline_observations;      /* NULL: the take doesn't say */
  gchar **effects;

  /* streaming thread */
  GstFollowRecord *record;
};

#define CAPS GST_CLOTH_MESH_CAPS "; " GST_CLOTH_OBSERVATIONS_CAPS

static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (CAPS));

GST_ELEMENT_REGISTER_DEFINE_WITH_CODE (clothgap, "clothgap", GST_RANK_NONE,
    GST_TYPE_GAP_DIAGNOSE, GST_DEBUG_CATEGORY_INIT (cloth_gap_debug,
        "clothgap", 0, "recorded against simulated cloth"));

static gpointer gst_gap_diagnose_parent_class;

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"baseline", "Baseline",
    "Folder of a take the model is accepted on: its free "
    "parameters are fitted there",
    G_TYPE_STRING, SETTING (baseline), GST_PARAM_MUTABLE_READY},
  {"simulated", "Simulated",
    "Folder of a take with what your simulator made of the same scene: the gap "
    "is recorded minus simulated, and the model's free parameters are fitted to "
    "it",
    G_TYPE_STRING, SETTING (simulated), GST_PARAM_MUTABLE_READY},
  {"effects", "Effects",
    "Effects to consider, with commas between them; by default all",
    G_TYPE_STRING, SETTING (effects), GST_PARAM_MUTABLE_READY},
  {"output", "Output",
    "Folder for gap.json, report.html and fitted.json; by default none is written",
    G_TYPE_STRING, SETTING (output), GST_PARAM_MUTABLE_READY},
};
/* *INDENT-ON* */

static const Settings defaults = { NULL };

/* ---- files ---- */

static gboolean
load_baseline (GstGapDiagnose * self, const ClothTake * take, GError ** error)
{
  const gchar *folder = self->settings.baseline;

  if (!folder)
    return TRUE;
  self->baseline = cloth_take_open (folder, error);
  return self->baseline && cloth_gap_check_same_cloth ("the baseline",
      cloth_take_get_topology (self->baseline), "the take of location",
      cloth_take_get_topology (take), error)
      && gst_cloth_io_observations_load (folder, NULL,
      cloth_take_get_topology (self->baseline), &self->baseline_observations,
      error);
}

static gboolean
gst_gap_diagnose_open (GstClothFollow * follow)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (follow);
  GstElement *element = GST_ELEMENT (follow);
  const Settings *settings = &self->settings;
  const ClothTake *take = gst_cloth_follow_get_inputs (follow)->take;
  const gchar *location = gst_cloth_follow_get_settings (follow)->location;
  g_autoptr (GError) error = NULL;

  if (!gst_cloth_io_observations_load (location, NULL,
          cloth_take_get_topology (take), &self->observations, &error))
    return gst_follow_fail (element, "location", location, error);
  if (!load_baseline (self, take, &error))
    return gst_follow_fail (element, "baseline", settings->baseline, error);
  /* what it is of can be checked once there is a recording */
  if (settings->simulated
      && !(self->simulated = cloth_take_open (settings->simulated, &error)))
    return gst_follow_fail (element, "simulated", settings->simulated, error);
  self->effects = cloth_gap_effects_parse (settings->effects, &error);
  return !error || gst_follow_fail (element, "effects", settings->effects,
      error);
}

static void
gst_gap_diagnose_restart (GstClothFollow * follow)
{
  g_clear_pointer (&GST_GAP_DIAGNOSE (follow)->record, gst_follow_record_free);
}

static void
gst_gap_diagnose_close (GstClothFollow * follow)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (follow);

  g_clear_pointer (&self->record, gst_follow_record_free);
  g_clear_pointer (&self->baseline, cloth_take_free);
  g_clear_pointer (&self->simulated, cloth_take_free);
  g_clear_pointer (&self->observations, cloth_observations_free);
  g_clear_pointer (&self->baseline_observations, cloth_observations_free);
  g_clear_pointer (&self->effects, g_strfreev);
}

/* ---- frames ---- */

static gboolean
gst_gap_diagnose_record (GstClothFollow * follow,
    const GstClothFollowFrame * frame)
{
  return gst_cloth_follow_keep (follow, &GST_GAP_DIAGNOSE (follow)->record,
      frame, "diagnosis");
}

static GstBuffer *
gst_gap_diagnose_leave (GstClothFollow * follow, GstBuffer * buffer,
    const GstClothFollowFrame * frame)
{
  buffer = gst_buffer_make_writable (buffer);
  gst_buffer_add_cloth_gap_meta (buffer,
      gst_cloth_gap_new (frame->sequence, frame->n_vertices, frame->residuals,
          frame->sigmas));
  return buffer;
}

/* ---- the end ---- */

static gboolean
go_on (gpointer data, gdouble share, const gchar * what)
{
  GST_LOG_OBJECT (data, "%.0f%% %s", 100 * share, what);
  return !gst_cloth_follow_is_cancelled (data);
}

/* An array of structures, as GStreamer's own statistics have it. Without a value where no
 * size would have shown. */
static void
set_limits (GstStructure * verdict, const ClothGapResult * result)
{
  GValue limits = G_VALUE_INIT;

  g_value_init (&limits, GST_TYPE_ARRAY);
  for (guint i = 0; i < result->detection_limits->len; i++) {
    const ClothGapLimit *limit = &g_array_index (result->detection_limits,
        ClothGapLimit, i);
    const ClothEffectParameter *parameter =
        &limit->effect->parameters[limit->parameter];
    g_autofree gchar *text = cloth_gap_limit_text (limit);
    GValue value = G_VALUE_INIT;
    GstStructure *s = gst_structure_new ("limit", "effect", G_TYPE_STRING,
        limit->effect->id, "parameter", G_TYPE_STRING, parameter->name, "unit",
        G_TYPE_STRING, parameter->unit, "text", G_TYPE_STRING, text, NULL);

    if (isfinite (limit->value))
      gst_structure_set (s, "value", G_TYPE_DOUBLE, limit->value, NULL);
    g_value_init (&value, GST_TYPE_STRUCTURE);
    g_value_take_boxed (&value, s);
    gst_value_array_append_and_take_value (&limits, &value);
  }
  gst_structure_take_value (verdict, "detection-limits", &limits);
}

/* Writes the report first when there is an @output. */
static gboolean
post_verdict (GstElement * element, const ClothGapResult * result,
    const gchar * output, GError ** error)
{
  const gchar *verdict = cloth_gap_verdict_name (result->verdict);
  g_autofree gchar *summary = cloth_gap_result_summary (result);
  g_autofree gchar *json = cloth_gap_result_to_json (result);
  GstStructure *structure = gst_structure_new ("clothgap/verdict",
      "verdict", G_TYPE_STRING, verdict, "summary", G_TYPE_STRING, summary,
      "json", G_TYPE_STRING, json, NULL);

  set_limits (structure, result);
  GST_INFO_OBJECT (element, "%s: %s", verdict, summary);
  if (output) {
    g_autofree gchar *report = g_build_filename (output, "report.html", NULL);

    if (!cloth_gap_result_write (result, output, error)) {
      gst_structure_free (structure);
      return FALSE;
    }
    gst_structure_set (structure, "report", G_TYPE_STRING, report, NULL);
  }
  gst_element_post_message (element,
      gst_message_new_element (GST_OBJECT (element), structure));
  return TRUE;
}

/* Of a recording by one camera the other cameras' pictures say nothing: its distances
 * are not measured. */
static void
gst_gap_diagnose_finish (GstClothFollow * follow)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (follow);
  const GstFollowSettings *settings = gst_cloth_follow_get_settings (follow);
  const ClothModel *model = gst_cloth_follow_get_inputs (follow)->model;
  const gboolean rays = gst_cloth_follow_has_rays (follow);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstFollowRecord) record = g_steal_pointer (&self->record);
  g_autoptr (ClothObservations) seen = NULL;
  g_autoptr (ClothTake) take = gst_follow_record_finish (record, &seen, &error);
  const ClothGapOptions options = {
    .baselines = &self->baseline,
    .n_baselines = self->baseline ? 1 : 0,
    .simulated = &self->simulated,
    .n_simulated = self->simulated ? 1 : 0,
    .observations = rays ? NULL : seen ? &seen : &self->observations,
    .baseline_observations = rays ? NULL : &self->baseline_observations,
    .model_file = settings->model,
    .effects = (const gchar * const *) self->effects,
    .seed = settings->seed,
    .threads = settings->threads,
    .progress = go_on,
    .progress_data = self
  };
  g_autoptr (ClothGapResult) result = take ?
      cloth_gap_diagnose (&take, 1, model, &options, &error) : NULL;

  if (result && post_verdict (GST_ELEMENT (self), result,
          self->settings.output, &error))
    return;
  if (result)
    GST_ELEMENT_ERROR (self, RESOURCE, WRITE,
        ("Can't write the report: %s", error->message),
        ("Set output= to a folder that can be written."));
  else if (!g_error_matches (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED))
    GST_ELEMENT_ERROR (self, STREAM, FAILED,
        ("Can't diagnose the recording: %s", error->message), (NULL));
}

static gdouble
gst_gap_diagnose_get_gain (GstClothFollow * follow)
{
  return GAIN;
}

/* ---- GObject ---- */

static void
gst_gap_diagnose_finalize (GObject * object)
{
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &GST_GAP_DIAGNOSE (object)->settings);
  G_OBJECT_CLASS (gst_gap_diagnose_parent_class)->finalize (object);
}

static void
gst_gap_diagnose_class_init (gpointer klass, gpointer data)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothFollowClass *follow_class = GST_CLOTH_FOLLOW_CLASS (klass);

  gst_gap_diagnose_parent_class = g_type_class_peek_parent (klass);
  object_class->finalize = gst_gap_diagnose_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstGapDiagnose,
          settings));
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Cloth gap",
      "Filter/Analyzer",
      "Says where meshes or observations depart from a simulation, and why",
      "The gst-cloth developers");
  follow_class->open = gst_gap_diagnose_open;
  follow_class->close = gst_gap_diagnose_close;
  follow_class->restart = gst_gap_diagnose_restart;
  follow_class->record = gst_gap_diagnose_record;
  follow_class->leave = gst_gap_diagnose_leave;
  follow_class->finish = gst_gap_diagnose_finish;
  follow_class->get_gain = gst_gap_diagnose_get_gain;
  follow_class->damping_ratio = DAMPING_RATIO;
  follow_class->score = "clothgap/score";
  follow_class->lets_pass = TRUE;
}

static void
gst_gap_diagnose_init (GTypeInstance * instance, gpointer klass)
{
  GST_GAP_DIAGNOSE (instance)->settings = defaults;
}

/* In C the type has another name than GstClothGap, the payload that it puts on meshes. What
 * users see of it, also in the names of its instances, is the element's name. */
GType
gst_gap_diagnose_get_type (void)
{
  static gsize type;

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_type_register_static_simple (GST_TYPE_CLOTH_FOLLOW, "GstClothgap",
            sizeof (GstGapDiagnoseClass), gst_gap_diagnose_class_init,
            sizeof (GstGapDiagnose), gst_gap_diagnose_init, 0));
  return type;
}
