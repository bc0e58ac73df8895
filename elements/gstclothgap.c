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

#include "elements/gstclothgap-inputs.h"
#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"
#include "gst/fit/nudge/nudge.h"
#include "gst/gap/diagnose.h"
#include "gst/gap/report/report.h"

GST_DEBUG_CATEGORY_STATIC (cloth_gap_debug);
#define GST_CAT_DEFAULT cloth_gap_debug

/* Of the springs: 1/s², and as a share of critical. */
#define GAIN 100.0
#define DAMPING_RATIO 0.5

/* What waits for its turn: a frame that has a gap to come, or what came between. */
typedef struct
{
  GstMiniObject *object;        /* buffer or event */
  gboolean is_frame;
  /* of a frame */
  gdouble time;
  guint64 sequence;
} Waiting;

struct _GstGapDiagnose
{
  GstElement parent;
  GstPad *sinkpad, *srcpad;

  /* with the object lock */
  GstGapSettings settings;

  gint cancelled;               /* atomic */

  /* from start to stop */
  GstGapInputs inputs;          /* setting them also with the object lock */
  ClothObserver *observer;

  /* with the stream lock; fps also with the object lock */
  GstSegment segment;
  gint fps_n, fps_d;            /* 0/1: not known */
  guint n_vertices;             /* 0: no caps yet */
  GstGapView *view;             /* of observations; NULL: meshes */
  GQueue waiting;
  guint64 n_frames;             /* that came in since the beginning */
  guint64 n_damaged;            /* that came between these */
  gdouble last_time;
  gboolean new_segment, warned;
  GstGapRecord *record;
  gfloat *residuals, *sigmas;
  gfloat *positions;            /* as recorded by one camera */
  guint8 *states;
};

#define CAPS GST_CLOTH_MESH_CAPS "; " GST_CLOTH_OBSERVATIONS_CAPS

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (CAPS));

GST_ELEMENT_REGISTER_DEFINE_WITH_CODE (clothgap, "clothgap", GST_RANK_NONE,
    GST_TYPE_GAP_DIAGNOSE, GST_DEBUG_CATEGORY_INIT (cloth_gap_debug,
        "clothgap", 0, "recorded against simulated cloth"));

static gpointer gst_gap_diagnose_parent_class;

#define SETTING(member) GST_CLOTH_SETTING (GstGapSettings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"model", "Model",
    "What the simulator knows of the cloth (model.json)",
    G_TYPE_STRING, SETTING (model), GST_PARAM_MUTABLE_READY},
  {"location", "Location",
    "Folder of the take that gives the scene: mesh, paths of the "
    "clamps, obstacles, gravity; for a stream from a take, that take",
    G_TYPE_STRING, SETTING (location), GST_PARAM_MUTABLE_READY},
  {"rig", "Rig",
    "Calibration file (rig.json) that has the camera of the observations; by "
    "default the one in the folder of location",
    G_TYPE_STRING, SETTING (rig), GST_PARAM_MUTABLE_READY},
  {"camera", "Camera",
    "Name in the rig of the camera of the observations; by default the one that "
    "the metadata names, else the only one of the rig",
    G_TYPE_STRING, SETTING (camera), GST_PARAM_MUTABLE_READY},
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
  {"seed", "Seed", "Seed of all random numbers",
    G_TYPE_UINT64, SETTING (seed), GST_PARAM_MUTABLE_READY},
  {"threads", "Threads",
    "Threads that simulate; 0: one a processor. The result is the same",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_READY, 0, 1024},
  {"window", "Window", "Length of a scored window, seconds",
    G_TYPE_DOUBLE, SETTING (window), GST_PARAM_MUTABLE_READY, 0.01, 60},
  GST_CLOTH_DAMAGE_PROPERTIES (GstGapSettings, damage),
};
/* *INDENT-ON* */

static const GstGapSettings defaults = {.window = 0.3 };

/* ---- what waits ---- */

static GstFlowReturn
send (GstGapDiagnose * self, GstMiniObject * object)
{
  if (GST_IS_BUFFER (object))
    return gst_pad_push (self->srcpad, GST_BUFFER_CAST (object));
  gst_pad_push_event (self->srcpad, GST_EVENT_CAST (object));
  return GST_FLOW_OK;
}

/* Sends what need not wait for a frame. */
static GstFlowReturn
send_others (GstGapDiagnose * self)
{
  GstFlowReturn flow = GST_FLOW_OK;
  Waiting *first;

  while (flow == GST_FLOW_OK && (first = g_queue_peek_head (&self->waiting)) &&
      !first->is_frame) {
    g_queue_pop_head (&self->waiting);
    flow = send (self, first->object);
    g_free (first);
  }
  return flow;
}

static void
enqueue_frame (GstGapDiagnose * self, GstBuffer * buffer, gdouble time,
    guint64 sequence)
{
  const Waiting waiting =
      { GST_MINI_OBJECT_CAST (buffer), TRUE, time, sequence };

  g_queue_push_tail (&self->waiting, g_memdup2 (&waiting, sizeof waiting));
}

static GstFlowReturn
enqueue_other (GstGapDiagnose * self, gpointer object)
{
  const Waiting waiting = { object };

  g_queue_push_tail (&self->waiting, g_memdup2 (&waiting, sizeof waiting));
  return send_others (self);
}

static void
free_waiting (gpointer data)
{
  Waiting *waiting = data;

  gst_mini_object_unref (waiting->object);
  g_free (waiting);
}

/* A new recording; frames of the old one that still wait lose their turn. */
static void
restart (GstGapDiagnose * self)
{
  if (self->observer)
    cloth_observer_restart (self->observer);
  g_clear_pointer (&self->record, gst_gap_record_free);
  self->n_frames = self->n_damaged = 0;
}

/* ---- frames ---- */

static void
post_score (GstGapDiagnose * self, gboolean last)
{
  ClothObserverScore score;

  if (!cloth_observer_take_score (self->observer, last, &score))
    return;
  GST_DEBUG_OBJECT (self, "%.3f s … %.3f s: %.2f mm, %.0f%% seen",
      score.from_s, score.to_s, 1000 * score.rms, 100 * score.coverage);
  gst_element_post_message (GST_ELEMENT (self),
      gst_message_new_element (GST_OBJECT (self),
          gst_structure_new ("clothgap/score",
              "time", G_TYPE_UINT64, (guint64) (score.from_s * 1e9 + 0.5),
              "duration", G_TYPE_UINT64,
              (guint64) ((score.to_s - score.from_s) * 1e9 + 0.5),
              "rms", G_TYPE_DOUBLE, score.rms,
              "coverage", G_TYPE_DOUBLE, score.coverage, NULL)));
}

/* Of a mesh's coordinates: its covariances, else what the scene's take says. */
static void
find_sigmas (GstGapDiagnose * self, const gfloat * c)
{
  gfloat noise =
      (gfloat) cloth_take_get_info (self->inputs.take)->noise_sigma_m;

  for (gsize i = 0; i < self->n_vertices; i++)
    self->sigmas[i] = c ? sqrtf ((c[6 * i] + c[6 * i + 3] + c[6 * i + 5]) / 3) :
        noise;
}

static gboolean
record_frame (GstGapDiagnose * self, gdouble time, const gfloat * positions,
    const guint8 * states, const gfloat * covariances)
{
  g_autoptr (GError) error = NULL;

  if (!self->record)
    self->record =
        gst_gap_record_new (cloth_take_get_info (self->inputs.take),
        self->inputs.scene, &error);
  if (self->record
      && gst_gap_record_append (self->record, time, positions, states,
          covariances, &error))
    return TRUE;
  GST_ELEMENT_ERROR (self, RESOURCE, WRITE,
      ("Can't keep the recording for its diagnosis: %s", error->message),
      ("Make room in %s, or set TMPDIR to a folder that has.",
          g_get_tmp_dir ()));
  return FALSE;
}

static gboolean
record_mesh (GstGapDiagnose * self, gdouble time, GstBuffer * buffer)
{
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, NULL);
  const gfloat *covariances = gst_cloth_mesh_get_covariances (mesh, NULL);

  find_sigmas (self, covariances);
  return record_frame (self, time, gst_cloth_mesh_get_positions (mesh, NULL),
      gst_cloth_mesh_get_states (mesh, NULL), covariances);
}

/* As far away as the simulation is. */
static gboolean
record_rays (GstGapDiagnose * self, gdouble time)
{
  cloth_observer_get_lifted (self->observer, self->positions, self->sigmas);
  for (gsize i = 0; i < self->n_vertices; i++)
    self->states[i] = isnan (self->positions[3 * i]) ? CLOTH_VERTEX_UNSEEN :
        CLOTH_VERTEX_MEASURED;
  return record_frame (self, time, self->positions, self->states, NULL);
}

static GstFlowReturn
send_frame (GstGapDiagnose * self)
{
  g_autoptr (GError) error = NULL;
  g_autofree Waiting *waiting = NULL;
  g_autoptr (GstBuffer) buffer = NULL;
  GstFlowReturn flow = send_others (self);

  if (flow != GST_FLOW_OK)
    return flow;
  if (!cloth_observer_pop (self->observer, self->residuals, &error)) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED, ("%s", error->message),
        ("model=%s", self->settings.model));
    return GST_FLOW_ERROR;
  }
  waiting = g_queue_pop_head (&self->waiting);
  buffer = GST_BUFFER_CAST (waiting->object);
  if (!(self->view ? record_rays (self, waiting->time) :
          record_mesh (self, waiting->time, buffer)))
    return GST_FLOW_ERROR;
  buffer = gst_buffer_make_writable (buffer);
  gst_buffer_add_cloth_gap_meta (buffer,
      gst_cloth_gap_new (waiting->sequence, self->n_vertices, self->residuals,
          self->sigmas));
  post_score (self, FALSE);
  flow = gst_pad_push (self->srcpad, g_steal_pointer (&buffer));
  return flow == GST_FLOW_OK ? send_others (self) : flow;
}

static GstFlowReturn
send_ready (GstGapDiagnose * self, guint latency)
{
  GstFlowReturn flow = GST_FLOW_OK;

  while (flow == GST_FLOW_OK && self->observer &&
      cloth_observer_get_n_waiting (self->observer) > latency)
    flow = send_frame (self);
  return flow;
}

/* Everything leaves: the last frames make do with those before them. */
static GstFlowReturn
drain (GstGapDiagnose * self)
{
  GstFlowReturn flow = send_ready (self, 0);

  return flow == GST_FLOW_OK ? send_others (self) : flow;
}

/* Seconds of the scene; NaN when the buffer has no time and the caps no rate. */
static gdouble
find_time (GstGapDiagnose * self, GstBuffer * buffer)
{
  GstClockTime time = gst_cloth_stream_time (&self->segment, buffer);

  if (GST_CLOCK_TIME_IS_VALID (time))
    return (gdouble) time / GST_SECOND;
  if (self->fps_n <= 0)
    return NAN;
  return self->inputs.scene->times[0] +
      (gdouble) (self->n_frames + self->n_damaged) * self->fps_d / self->fps_n;
}

/* Without clamps a scene has no end. */
static gboolean
is_in_scene (const GstGapDiagnose * self, gdouble time)
{
  const ClothScene *scene = self->inputs.scene;
  gdouble slack = 0.5 / scene->fps;

  return scene->held->len == 0 || scene->n_frames < 2 ||
      (time > scene->times[0] - slack &&
      time < scene->times[scene->n_frames - 1] + slack);
}

static const gchar *
get_noun (const GstGapDiagnose * self)
{
  return self->view ? "picture" : "mesh";
}

/* Passes a frame that can't be scored, and says why, once. */
static GstFlowReturn
let_pass (GstGapDiagnose * self, GstBuffer * buffer, gdouble time)
{
  GstFlowReturn flow = GST_FLOW_OK;

  if (!self->warned) {
    const ClothScene *scene = self->inputs.scene;

    self->warned = TRUE;
    if (is_in_scene (self, time))
      GST_ELEMENT_WARNING (self, STREAM, FORMAT,
          ("The %s at %.3f s is not later than the one before, and passes "
              "without a gap; times must rise", get_noun (self), time), (NULL));
    else
      GST_ELEMENT_WARNING (self, STREAM, FORMAT,
          ("The %s at %.3f s lies outside the scene, which knows its clamps "
              "from %.3f s to %.3f s, and passes without a gap; set location= "
              "to the take of this recording", get_noun (self), time,
              scene->times[0], scene->times[scene->n_frames - 1]), (NULL));
  }
  /* Behind the scene's end none comes that those waiting could wait for. */
  if (!is_in_scene (self, time) && time > self->inputs.scene->times[0])
    flow = send_ready (self, 0);
  if (flow == GST_FLOW_OK)
    return enqueue_other (self, buffer);
  gst_buffer_unref (buffer);
  return flow;
}

/* TRUE when it may be scored; else @flow says what became of the buffer. */
static gboolean
is_next (GstGapDiagnose * self, GstBuffer * buffer, gdouble time,
    GstFlowReturn * flow)
{
  if (isnan (time)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("A %s has neither a time nor its stream a frame rate",
            get_noun (self)),
        ("Stamp the buffers, or give the caps a framerate."));
    gst_buffer_unref (buffer);
    *flow = GST_FLOW_ERROR;
    return FALSE;
  }
  if (self->n_frames > 0 && time <= self->last_time && self->new_segment) {
    GST_INFO_OBJECT (self, "back to %.3f s: a new recording", time);
    restart (self);
  }
  self->new_segment = FALSE;
  if (is_in_scene (self, time) &&
      (self->n_frames == 0 || time > self->last_time))
    return TRUE;
  *flow = let_pass (self, buffer, time);
  return FALSE;
}

static GstFlowReturn
gst_gap_diagnose_chain (GstPad * pad, GstObject * parent, GstBuffer * buffer)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (parent);
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GstBuffer) picture = NULL;
  g_autoptr (GError) error = NULL;
  const ClothRays *rays = NULL;
  gdouble time, offset_s = 0;
  guint64 sequence = 0;
  GstFlowReturn flow;

  if (self->n_vertices == 0) {
    gst_buffer_unref (buffer);
    return GST_FLOW_NOT_NEGOTIATED;
  }
  if (self->view) {
    picture = gst_buffer_new ();
    gst_cloth_observations_unpack (buffer, picture, &error);
  } else {
    mesh = gst_cloth_parse_mesh (buffer, self->n_vertices, &error);
  }
  if (error) {
    self->n_damaged++;
    gst_buffer_unref (buffer);
    return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
        error);
  }
  if (self->view) {
    rays = gst_gap_view_read (self->view, GST_ELEMENT (self), picture,
        &sequence, &offset_s, &error);
    if (!rays) {
      gst_buffer_unref (buffer);
      if (!error)
        return GST_FLOW_ERROR;
      self->n_damaged++;
      return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
          error);
    }
  } else {
    sequence = gst_cloth_mesh_get_sequence (mesh);
  }
  time = find_time (self, buffer) - offset_s;
  if (!is_next (self, buffer, time, &flow))
    return flow;
  if (rays)
    cloth_observer_push_rays (self->observer, time, rays);
  else
    cloth_observer_push (self->observer, time,
        gst_cloth_mesh_get_positions (mesh, NULL));
  g_clear_pointer (&mesh, gst_cloth_mesh_unref);
  self->last_time = time;
  self->n_frames++;
  enqueue_frame (self, buffer, time, sequence);
  return send_ready (self, CLOTH_OBSERVER_LATENCY);
}

/* ---- the end ---- */

static gboolean
go_on (gpointer data, gdouble share, const gchar * what)
{
  GstGapDiagnose *self = data;

  GST_LOG_OBJECT (self, "%.0f%% %s", 100 * share, what);
  return !g_atomic_int_get (&self->cancelled);
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
finish (GstGapDiagnose * self)
{
  const ClothGapOptions options = {
    .baselines = &self->inputs.baseline,
    .n_baselines = self->inputs.baseline ? 1 : 0,
    .simulated = &self->inputs.simulated,
    .n_simulated = self->inputs.simulated ? 1 : 0,
    .observations = self->view ? NULL : &self->inputs.observations,
    .baseline_observations =
        self->view ? NULL : &self->inputs.baseline_observations,
    .model_file = self->settings.model,
    .effects = (const gchar * const *) self->inputs.effects,
    .seed = self->settings.seed,
    .threads = self->settings.threads,
    .progress = go_on,
    .progress_data = self
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGapResult) result = NULL;

  if (drain (self) != GST_FLOW_OK)
    return;
  post_score (self, TRUE);
  if (!self->record) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED,
        ("The stream ended without a %s to diagnose", get_noun (self)),
        ("No %s came%s.", get_noun (self), self->warned ?
            " whose time is the scene's; set location= to its own take" : ""));
    return;
  }
  if (self->view && !gst_gap_view_check_seen (self->view, GST_ELEMENT (self)))
    return;
  result =
      gst_gap_record_diagnose (self->record, self->inputs.model, &options,
      &error);
  g_clear_pointer (&self->record, gst_gap_record_free);
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

/* ---- events and queries ---- */

/* One recording is of meshes or of observations: their distances mean different things. */
static gboolean
set_kind (GstGapDiagnose * self, gboolean observations)
{
  if (observations != (self->view != NULL) && self->n_frames > 0) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The stream changes from %s to %s within a recording.",
            observations ? "meshes" : "observations",
            observations ? "observations" : "meshes"),
        ("Flush before the change, or give each a clothgap of its own."));
    return FALSE;
  }
  if (!observations)
    g_clear_pointer (&self->view, gst_gap_view_free);
  else if (!self->view)
    self->view = gst_gap_view_new (GST_ELEMENT (self), &self->settings,
        self->inputs.scene->topology);
  return observations == (self->view != NULL);
}

static gboolean
set_caps (GstGapDiagnose * self, GstCaps * caps)
{
  GstStructure *s = gst_caps_get_structure (caps, 0);
  gboolean observations = gst_structure_has_name (s,
      GST_CLOTH_OBSERVATIONS_MEDIA_TYPE);
  gint fps_n = 0, fps_d = 1;

  if (!set_kind (self, observations) || !(observations ?
          gst_gap_view_set_caps (self->view, GST_ELEMENT (self), caps) :
          gst_gap_inputs_check_mesh (&self->inputs, GST_ELEMENT (self), caps)))
    return FALSE;
  gst_structure_get_fraction (s, "framerate", &fps_n, &fps_d);
  if (self->n_vertices == 0) {
    self->n_vertices = self->inputs.scene->topology->n_vertices;
    self->residuals = g_new (gfloat, 3 * (gsize) self->n_vertices);
    self->sigmas = g_new (gfloat, self->n_vertices);
    self->positions = g_new (gfloat, 3 * (gsize) self->n_vertices);
    self->states = g_malloc (self->n_vertices);
  }
  GST_OBJECT_LOCK (self);
  self->fps_n = fps_n;
  self->fps_d = fps_d;
  GST_OBJECT_UNLOCK (self);
  gst_element_post_message (GST_ELEMENT (self),
      gst_message_new_latency (GST_OBJECT (self)));
  return TRUE;
}

static gboolean
set_segment (GstGapDiagnose * self, GstEvent * event)
{
  gst_event_copy_segment (event, &self->segment);
  self->new_segment = TRUE;
  if (self->segment.rate > 0)
    return TRUE;
  GST_ELEMENT_ERROR (self, STREAM, FORMAT,
      ("A simulation can't run backwards"), ("Seek with a rate over 0."));
  return FALSE;
}

static void
flush (GstGapDiagnose * self)
{
  g_queue_clear_full (&self->waiting, free_waiting);
  restart (self);
  gst_segment_init (&self->segment, GST_FORMAT_TIME);
  self->warned = FALSE;
  g_atomic_int_set (&self->cancelled, FALSE);
}

/* What is known of the stream outlives a flush: our peer gets it with the next frame. */
static void
keep_sticky_events (GstGapDiagnose * self)
{
  for (GList * l = self->waiting.head; l; l = l->next) {
    Waiting *waiting = l->data;

    if (GST_IS_EVENT (waiting->object) && GST_EVENT_IS_STICKY (waiting->object))
      gst_pad_store_sticky_event (self->srcpad,
          GST_EVENT_CAST (waiting->object));
  }
}

static gboolean
gst_gap_diagnose_sink_event (GstPad * pad, GstObject * parent, GstEvent * event)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (parent);
  gboolean good = TRUE;

  switch (GST_EVENT_TYPE (event)) {
    case GST_EVENT_FLUSH_START:
      g_atomic_int_set (&self->cancelled, TRUE);
      break;
    case GST_EVENT_FLUSH_STOP:
      keep_sticky_events (self);
      flush (self);
      break;
    case GST_EVENT_CAPS:{
      GstCaps *caps;

      gst_event_parse_caps (event, &caps);
      drain (self);
      good = set_caps (self, caps);
      break;
    }
    case GST_EVENT_SEGMENT:
      drain (self);
      good = set_segment (self, event);
      break;
    case GST_EVENT_STREAM_START:
    case GST_EVENT_SEGMENT_DONE:
      drain (self);
      break;
    case GST_EVENT_EOS:
      finish (self);
      break;
    default:
      if (GST_EVENT_IS_SERIALIZED (event))
        return enqueue_other (self, event) == GST_FLOW_OK;
      break;
  }
  if (good)
    return gst_pad_push_event (self->srcpad, event);
  gst_event_unref (event);
  return FALSE;
}

static gboolean
gst_gap_diagnose_src_query (GstPad * pad, GstObject * parent, GstQuery * query)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (parent);
  GstClockTime own = 0;

  if (GST_QUERY_TYPE (query) != GST_QUERY_LATENCY)
    return gst_pad_query_default (pad, parent, query);
  if (!gst_pad_peer_query (self->sinkpad, query))
    return FALSE;
  GST_OBJECT_LOCK (self);
  if (self->fps_n > 0)
    own = gst_util_uint64_scale_int (CLOTH_OBSERVER_LATENCY * GST_SECOND,
        self->fps_d, self->fps_n);
  else if (self->inputs.scene)
    own =
        (GstClockTime) (CLOTH_OBSERVER_LATENCY / self->inputs.scene->fps * 1e9);
  GST_OBJECT_UNLOCK (self);
  gst_cloth_add_latency (query, own);
  return TRUE;
}

/* ---- start and stop ---- */

static gboolean
start (GstGapDiagnose * self)
{
  const GstGapSettings *settings = &self->settings;
  const ClothObserverOptions options =
      { GAIN, DAMPING_RATIO, settings->window, settings->seed,
    settings->threads
  };
  g_autoptr (GError) error = NULL;
  GstGapInputs inputs = { NULL };
  gboolean good = gst_gap_inputs_load (&inputs, GST_ELEMENT (self),
      settings);

  GST_OBJECT_LOCK (self);
  self->inputs = inputs;
  GST_OBJECT_UNLOCK (self);
  if (!good)
    return FALSE;
  self->observer = cloth_observer_new (inputs.scene, inputs.model, &options,
      &error);
  if (!self->observer) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("Can't use the model: %s", error->message),
        ("model=%s", settings->model));
    return FALSE;
  }
  flush (self);
  gst_cloth_damage_reset (&self->settings.damage, GST_ELEMENT (self));
  return TRUE;
}

static void
stop (GstGapDiagnose * self)
{
  GstGapInputs inputs, none = { NULL };

  flush (self);
  GST_OBJECT_LOCK (self);
  inputs = self->inputs;
  self->inputs = none;
  self->fps_n = 0;
  GST_OBJECT_UNLOCK (self);
  gst_gap_inputs_clear (&inputs);
  g_clear_pointer (&self->observer, cloth_observer_free);
  g_clear_pointer (&self->view, gst_gap_view_free);
  g_clear_pointer (&self->residuals, g_free);
  g_clear_pointer (&self->sigmas, g_free);
  g_clear_pointer (&self->positions, g_free);
  g_clear_pointer (&self->states, g_free);
  self->n_vertices = 0;
}

static GstStateChangeReturn
gst_gap_diagnose_change_state (GstElement * element, GstStateChange transition)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (element);
  GstStateChangeReturn result;

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !start (self)) {
    stop (self);
    return GST_STATE_CHANGE_FAILURE;
  }
  /* A diagnosis holds the streaming thread, which has to end. */
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    g_atomic_int_set (&self->cancelled, TRUE);
  result = GST_ELEMENT_CLASS
      (gst_gap_diagnose_parent_class)->change_state (element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY ||
      (transition == GST_STATE_CHANGE_READY_TO_PAUSED &&
          result == GST_STATE_CHANGE_FAILURE))
    stop (self);
  return result;
}

/* ---- GObject ---- */

static void
gst_gap_diagnose_finalize (GObject * object)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (object);

  stop (self);
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  G_OBJECT_CLASS (gst_gap_diagnose_parent_class)->finalize (object);
}

static void
gst_gap_diagnose_class_init (gpointer klass, gpointer data)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);

  gst_gap_diagnose_parent_class = g_type_class_peek_parent (klass);
  object_class->finalize = gst_gap_diagnose_finalize;
  element_class->change_state = gst_gap_diagnose_change_state;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstGapDiagnose,
          settings));
  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Cloth gap",
      "Filter/Analyzer",
      "Says where meshes or observations depart from a simulation, and why",
      "The gst-cloth developers");
}

static void
gst_gap_diagnose_init (GTypeInstance * instance, gpointer klass)
{
  GstGapDiagnose *self = GST_GAP_DIAGNOSE (instance);

  self->sinkpad = gst_pad_new_from_static_template (&sink_template, "sink");
  gst_pad_set_chain_function (self->sinkpad, gst_gap_diagnose_chain);
  gst_pad_set_event_function (self->sinkpad, gst_gap_diagnose_sink_event);
  GST_PAD_SET_PROXY_CAPS (self->sinkpad);
  gst_element_add_pad (GST_ELEMENT (self), self->sinkpad);
  self->srcpad = gst_pad_new_from_static_template (&src_template, "src");
  gst_pad_set_query_function (self->srcpad, gst_gap_diagnose_src_query);
  gst_cloth_damage_watch (&self->settings.damage, GST_ELEMENT (self),
      self->srcpad);
  GST_PAD_SET_PROXY_CAPS (self->srcpad);
  gst_element_add_pad (GST_ELEMENT (self), self->srcpad);
  g_queue_init (&self->waiting);
  gst_segment_init (&self->segment, GST_FORMAT_TIME);
  self->settings = defaults;
  self->fps_d = 1;
}

/* In C the type has another name than GstClothGap, the payload that it puts on meshes. What
 * users see of it, also in the names of its instances, is the element's name. */
GType
gst_gap_diagnose_get_type (void)
{
  static gsize type;

  if (g_once_init_enter (&type))
    g_once_init_leave (&type, g_type_register_static_simple (GST_TYPE_ELEMENT,
            "GstClothgap", sizeof (GstGapDiagnoseClass),
            gst_gap_diagnose_class_init, sizeof (GstGapDiagnose),
            gst_gap_diagnose_init, 0));
  return type;
}
