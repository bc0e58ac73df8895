/* Base of the elements that hold a stream against a simulation of the cloth.
 *
 * The simulation is drawn to the stream by weak springs, frame by frame; a frame leaves once the
 * three frames behind it are known, and events in between wait for their turn.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothfollow.h"

#include <math.h>

#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"

GST_DEBUG_CATEGORY_STATIC (cloth_follow_debug);
#define GST_CAT_DEFAULT cloth_follow_debug

/* What waits for its turn: a frame that has a gap to come, or what came between. */
typedef struct
{
  GstMiniObject *object;        /* buffer or event */
  gboolean is_frame;
  /* of a frame */
  gdouble time;
  guint64 sequence;
} Waiting;

typedef struct
{
  GstElement *element;
  GstClothFollowClass *klass;
  GstPad *sinkpad, *srcpad;

  /* with the object lock */
  GstFollowSettings settings;

  gint cancelled;               /* atomic */

  /* from start to stop */
  GstFollowInputs inputs;       /* setting them also with the object lock */
  ClothObserver *observer;

  /* with the stream lock; fps also with the object lock */
  GstSegment segment;
  gint fps_n, fps_d;            /* 0/1: not known */
  guint n_vertices;             /* 0: no caps yet */
  GstFollowView *view;          /* of observations; NULL: meshes */
  GstFollowCameras *cameras;    /* that meshes were made of; NULL: not known */
  GQueue waiting;
  guint64 n_frames;             /* that came in since the beginning */
  guint64 n_at_rate;            /* they and damaged packets, since the rate is this one */
  gdouble before;               /* how long those before that took, seconds */
  gdouble last_time;
  gboolean new_segment, warned;
  gboolean has_views;           /* whether a mesh of this recording had */
  gboolean warned_views;
  GstCaps *refused;             /* NULL: none */
  gfloat *residuals, *sigmas;
  gfloat *positions;            /* as recorded by one camera */
  guint8 *states;
} Follow;

typedef Follow GstClothFollowPrivate;

#define CAPS GST_CLOTH_MESH_CAPS "; " GST_CLOTH_OBSERVATIONS_CAPS

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (CAPS));

G_DEFINE_ABSTRACT_TYPE_WITH_PRIVATE (GstClothFollow, gst_cloth_follow,
    GST_TYPE_ELEMENT);

static Follow *
follow_of (gpointer element)
{
  return gst_cloth_follow_get_instance_private (GST_CLOTH_FOLLOW (element));
}

#define SETTING(member) GST_CLOTH_SETTING (GstFollowSettings, member)

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
    "Calibration file (rig.json) that has the camera of the observations, or the "
    "cameras that the meshes were made of; by default the one in the folder of "
    "location",
    G_TYPE_STRING, SETTING (rig), GST_PARAM_MUTABLE_READY},
  {"camera", "Camera",
    "Name in the rig of the camera of the observations; by default the one that "
    "the metadata names, else the only one of the rig",
    G_TYPE_STRING, SETTING (camera), GST_PARAM_MUTABLE_READY},
  {"seed", "Seed", "Seed of all random numbers",
    G_TYPE_UINT64, SETTING (seed), GST_PARAM_MUTABLE_READY},
  {"threads", "Threads",
    "Threads that simulate; 0: one a processor. The result is the same",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_READY, 0, 1024},
  {"window", "Window", "Length of a scored window, seconds",
    G_TYPE_DOUBLE, SETTING (window), GST_PARAM_MUTABLE_READY, 0.01, 60},
  GST_CLOTH_DAMAGE_PROPERTIES (GstFollowSettings, damage),
};
/* *INDENT-ON* */

static const GstFollowSettings defaults = {.window = 0.3 };

/* ---- what waits ---- */

static GstFlowReturn
send (Follow * self, GstMiniObject * object)
{
  if (GST_IS_BUFFER (object))
    return gst_pad_push (self->srcpad, GST_BUFFER_CAST (object));
  gst_pad_push_event (self->srcpad, GST_EVENT_CAST (object));
  return GST_FLOW_OK;
}

/* Sends what need not wait for a frame. */
static GstFlowReturn
send_others (Follow * self)
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
enqueue_frame (Follow * self, GstBuffer * buffer, gdouble time,
    guint64 sequence)
{
  const Waiting waiting =
      { GST_MINI_OBJECT_CAST (buffer), TRUE, time, sequence };

  g_queue_push_tail (&self->waiting, g_memdup2 (&waiting, sizeof waiting));
}

static GstFlowReturn
enqueue_other (Follow * self, gpointer object)
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
restart (Follow * self)
{
  if (self->observer)
    cloth_observer_restart (self->observer);
  if (self->view)
    gst_follow_view_restart (self->view);
  if (self->cameras)
    gst_follow_cameras_restart (self->cameras);
  self->has_views = FALSE;
  if (self->klass->restart)
    self->klass->restart (GST_CLOTH_FOLLOW (self->element));
  self->n_frames = self->n_at_rate = 0;
  self->before = 0;
}

/* ---- frames ---- */

static void
post_score (Follow * self, gboolean last)
{
  ClothObserverScore score;

  if (!cloth_observer_take_score (self->observer, last, &score))
    return;
  GST_DEBUG_OBJECT (self->element, "%.3f s … %.3f s: %.2f mm, %.0f%% seen",
      score.from_s, score.to_s, 1000 * score.rms, 100 * score.coverage);
  gst_element_post_message (self->element,
      gst_message_new_element (GST_OBJECT (self->element),
          gst_structure_new (self->klass->score,
              "time", G_TYPE_UINT64,
              (guint64) (MAX (score.from_s, 0.) * 1e9 + 0.5),
              "duration", G_TYPE_UINT64,
              (guint64) ((score.to_s - score.from_s) * 1e9 + 0.5),
              "rms", G_TYPE_DOUBLE, score.rms,
              "coverage", G_TYPE_DOUBLE, score.coverage, NULL)));
}

/* Of a mesh's coordinates: its covariances, else what the scene's take says. */
static void
find_sigmas (Follow * self, const gfloat * c)
{
  gfloat noise =
      (gfloat) cloth_take_get_info (self->inputs.take)->noise_sigma_m;

  for (gsize i = 0; i < self->n_vertices; i++)
    self->sigmas[i] = c ? sqrtf ((c[6 * i] + c[6 * i + 3] + c[6 * i + 5]) / 3) :
        noise;
}

/* The usual one of a mesh's coordinates. */
static gdouble
find_sigma (Follow * self, const GstClothMesh * mesh)
{
  gdouble sum = 0;
  guint n = 0;

  find_sigmas (self, gst_cloth_mesh_get_covariances (mesh, NULL));
  for (gsize i = 0; i < self->n_vertices; i++) {
    if (!isfinite (self->sigmas[i]))
      continue;
    sum += (gdouble) self->sigmas[i] * self->sigmas[i];
    n++;
  }
  return n ? sqrt (sum / n) :
      cloth_take_get_info (self->inputs.take)->noise_sigma_m;
}

/* Places on the rays, as far away as the simulation is. */
static void
find_lifted (Follow * self)
{
  cloth_observer_get_lifted (self->observer, self->positions, self->sigmas);
  for (gsize i = 0; i < self->n_vertices; i++)
    self->states[i] = isnan (self->positions[3 * i]) ? CLOTH_VERTEX_UNSEEN :
        CLOTH_VERTEX_MEASURED;
}

/* What leaves of a frame's buffer, which it takes. */
static GstBuffer *
leave (Follow * self, const Waiting * waiting, GstBuffer * buffer)
{
  GstClothMesh *mesh = NULL;
  GstClothFollowFrame frame = { waiting->time, waiting->sequence,
    0, self->n_vertices, self->residuals, self->sigmas, self->positions,
    self->states, NULL
  };
  const ClothCamera *camera;
  gboolean good;

  if (self->view) {
    gst_follow_view_get_points (self->view, &camera);
    frame.offset_s = camera ? camera->offset_s : 0;
    find_lifted (self);
  } else {
    mesh = gst_cloth_mesh_from_buffer (buffer, NULL);
    frame.positions = gst_cloth_mesh_get_positions (mesh, NULL);
    frame.states = gst_cloth_mesh_get_states (mesh, NULL);
    frame.covariances = gst_cloth_mesh_get_covariances (mesh, NULL);
    find_sigmas (self, frame.covariances);
    /* where one camera alone saw a vertex, across its ray */
    if (self->cameras)
      cloth_observer_get_lifted (self->observer, self->positions, self->sigmas);
  }
  frame.buffer = buffer;
  good = !self->klass->record
      || self->klass->record (GST_CLOTH_FOLLOW (self->element), &frame);
  /* that it can be written to */
  g_clear_pointer (&mesh, gst_cloth_mesh_unref);
  if (good) {
    frame.positions = frame.covariances = NULL;
    frame.states = NULL;
    frame.buffer = NULL;
    return self->klass->leave (GST_CLOTH_FOLLOW (self->element), buffer,
        &frame);
  }
  gst_buffer_unref (buffer);
  return NULL;
}

static GstFlowReturn
send_frame (Follow * self)
{
  g_autoptr (GError) error = NULL;
  g_autofree Waiting *waiting = NULL;
  GstBuffer *buffer;
  GstFlowReturn flow = send_others (self);

  if (flow != GST_FLOW_OK)
    return flow;
  if (!cloth_observer_pop (self->observer, self->residuals, &error)) {
    if (g_atomic_int_get (&self->cancelled))
      return GST_FLOW_FLUSHING;
    GST_ELEMENT_ERROR (self->element, STREAM, FAILED, ("%s", error->message),
        ("model=%s", self->settings.model));
    return GST_FLOW_ERROR;
  }
  waiting = g_queue_pop_head (&self->waiting);
  buffer = leave (self, waiting, GST_BUFFER_CAST (waiting->object));
  if (!buffer)
    return GST_FLOW_ERROR;
  post_score (self, FALSE);
  flow = gst_pad_push (self->srcpad, buffer);
  return flow == GST_FLOW_OK ? send_others (self) : flow;
}

static GstFlowReturn
send_ready (Follow * self, guint latency)
{
  GstFlowReturn flow = GST_FLOW_OK;

  while (flow == GST_FLOW_OK && self->observer &&
      cloth_observer_get_n_waiting (self->observer) > latency)
    flow = send_frame (self);
  return flow;
}

/* Everything leaves: the last frames make do with those before them. */
static GstFlowReturn
drain (Follow * self)
{
  GstFlowReturn flow = send_ready (self, 0);

  return flow == GST_FLOW_OK ? send_others (self) : flow;
}

/* Seconds of the scene; NaN when the buffer has no time and the caps no rate. */
static gdouble
find_time (Follow * self, GstBuffer * buffer)
{
  GstClockTime time = gst_cloth_stream_time (&self->segment, buffer);

  if (GST_CLOCK_TIME_IS_VALID (time))
    return (gdouble) time / GST_SECOND;
  if (self->fps_n <= 0)
    return NAN;
  return self->inputs.scene->times[0] + self->before +
      (gdouble) self->n_at_rate * self->fps_d / self->fps_n;
}

/* Without clamps a scene has no end. */
static gboolean
is_in_scene (const Follow * self, gdouble time)
{
  const ClothScene *scene = self->inputs.scene;
  gdouble slack = 0.5 / scene->fps;

  return scene->held->len == 0 || scene->n_frames < 2 ||
      (time > scene->times[0] - slack &&
      time < scene->times[scene->n_frames - 1] + slack);
}

static const gchar *
get_noun (const Follow * self)
{
  return self->view ? "picture" : "mesh";
}

static const gchar *
get_fate (const Follow * self)
{
  return self->klass->lets_pass ? "passes without a gap" : "is left out";
}

/* What becomes of a frame that can't be scored; says why, once. */
static GstFlowReturn
let_pass (Follow * self, GstBuffer * buffer, gdouble time)
{
  GstFlowReturn flow = GST_FLOW_OK;

  if (!self->warned) {
    const ClothScene *scene = self->inputs.scene;

    self->warned = TRUE;
    if (is_in_scene (self, time))
      GST_ELEMENT_WARNING (self->element, STREAM, FORMAT,
          ("The %s at %.3f s is not later than the one before, and %s; times must "
              "rise", get_noun (self), time, get_fate (self)), (NULL));
    else
      GST_ELEMENT_WARNING (self->element, STREAM, FORMAT,
          ("The %s at %.3f s lies outside the scene, which knows its clamps "
              "from %.3f s to %.3f s, and %s; set location= to the take of this "
              "recording", get_noun (self), time, scene->times[0],
              scene->times[scene->n_frames - 1], get_fate (self)), (NULL));
  }
  /* Behind the scene's end none comes that those waiting could wait for. */
  if (!is_in_scene (self, time) && time > self->inputs.scene->times[0])
    flow = send_ready (self, 0);
  if (flow == GST_FLOW_OK && self->klass->lets_pass)
    return enqueue_other (self, buffer);
  /* who joins streams downstream would wait for it */
  if (flow == GST_FLOW_OK && GST_BUFFER_PTS_IS_VALID (buffer))
    flow = enqueue_other (self, gst_event_new_gap (GST_BUFFER_PTS (buffer),
            GST_BUFFER_DURATION (buffer)));
  gst_buffer_unref (buffer);
  return flow;
}

/* Of the camera's clock to that of its rig, s; of meshes none. */
static gdouble
get_offset (const Follow * self)
{
  return self->view ? gst_follow_view_get_offset (self->view) : 0.;
}

/* A segment that goes back begins a new recording. */
static void
check_segment (Follow * self, gdouble time)
{
  if (self->n_frames > 0 && time <= self->last_time && self->new_segment) {
    GST_INFO_OBJECT (self->element, "back to %.3f s: a new recording", time);
    restart (self);
  }
  self->new_segment = FALSE;
}

/* TRUE when it may be scored; else @flow says what became of the buffer. */
static gboolean
is_next (Follow * self, GstBuffer * buffer, gdouble time, GstFlowReturn * flow)
{
  if (isnan (time)) {
    GST_ELEMENT_ERROR (self->element, STREAM, FORMAT,
        ("A %s has neither a time nor its stream a frame rate",
            get_noun (self)),
        ("Stamp the buffers, or give the caps a framerate."));
    gst_buffer_unref (buffer);
    *flow = GST_FLOW_ERROR;
    return FALSE;
  }
  if (is_in_scene (self, time) &&
      (self->n_frames == 0 || time > self->last_time))
    return TRUE;
  *flow = let_pass (self, buffer, time);
  return FALSE;
}

static gboolean
tell_picture (Follow * self, gdouble time)
{
  const ClothCamera *camera;
  const ClothTriangulateView *points = gst_follow_view_get_points (self->view,
      &camera);

  return !self->klass->came || !points
      || self->klass->came (GST_CLOTH_FOLLOW (self->element), time, camera,
      points);
}

/* Opens the cameras that a mesh was made of; FALSE when an error was posted. Without a rig its places are all
 * that is known, and so they are when the scene's vertices are not numbered as those of a grid. */
static gboolean
open_cameras (Follow * self)
{
  const ClothTopology *topology = self->inputs.scene->topology;
  g_autofree gchar *rig_file = gst_follow_find_rig (&self->settings);

  if (self->cameras)
    return TRUE;
  if (!rig_file || topology->columns < 2 || topology->rows < 2) {
    GST_INFO_OBJECT (self->element, "no %s: what one camera alone saw is not "
        "used", rig_file ? "grid" : "rig");
    return TRUE;
  }
  self->cameras = gst_follow_cameras_new (self->element, rig_file, topology);
  return self->cameras != NULL;
}

/* @rays: (out): what single cameras saw of a mesh's vertices; NULL: nothing is known of it. FALSE when an error
 * was posted, or there is @damage. */
static gboolean
look_at_views (Follow * self, GstBuffer * buffer, const GstClothMesh * mesh,
    const ClothRays ** rays, GError ** damage)
{
  *rays = NULL;
  if (!gst_buffer_get_nth_cloth_view (buffer, 0)) {
    if (self->has_views && !self->warned_views)
      GST_ELEMENT_WARNING (self->element, STREAM, FORMAT,
          ("A mesh comes without what its cameras saw, which those before it "
              "had."),
          ("Let nothing that drops metadata be between triangulate "
              "and this element, and join it with no other stream."));
    self->warned_views |= self->has_views;
    return TRUE;
  }
  if (!open_cameras (self))
    return FALSE;
  if (!self->cameras)
    return TRUE;
  self->has_views = TRUE;
  *rays = gst_follow_cameras_read (self->cameras, self->element, buffer, mesh,
      damage);
  return *rays != NULL;
}

/* A frame that can't be read; @error: it is damaged, else an error was posted. */
static GstFlowReturn
drop (Follow * self, GstBuffer * buffer, const GError * error)
{
  gst_buffer_unref (buffer);
  if (!error)
    return GST_FLOW_ERROR;
  self->n_at_rate++;
  return gst_cloth_damage_add (&self->settings.damage, self->element, error);
}

static GstFlowReturn
gst_cloth_follow_chain (GstPad * pad, GstObject * parent, GstBuffer * buffer)
{
  Follow *self = follow_of (parent);
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GstBuffer) picture = NULL;
  g_autoptr (GError) error = NULL;
  const ClothRays *rays = NULL;
  gdouble time, sigma = 0;
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
  if (error)
    return drop (self, buffer, error);
  time = find_time (self, buffer);
  check_segment (self, time - get_offset (self));
  if (self->view) {
    rays = gst_follow_view_read (self->view, self->element, picture,
        &sequence, &error);
    if (!rays)
      return drop (self, buffer, error);
  } else {
    if (!look_at_views (self, buffer, mesh, &rays, &error))
      return drop (self, buffer, error);
    sequence = gst_cloth_mesh_get_sequence (mesh);
  }
  time -= get_offset (self);
  if (!is_next (self, buffer, time, &flow)) {
    self->n_at_rate++;
    return flow;
  }
  if (self->view && !tell_picture (self, time)) {
    gst_buffer_unref (buffer);
    return GST_FLOW_ERROR;
  }
  /* only where a recording begins its noise matters */
  if (mesh && self->n_frames == 0)
    sigma = find_sigma (self, mesh);
  if (!mesh)
    cloth_observer_push_rays (self->observer, time, rays);
  else if (rays)
    cloth_observer_push_both (self->observer, time,
        gst_cloth_mesh_get_positions (mesh, NULL), sigma, rays);
  else
    cloth_observer_push (self->observer, time,
        gst_cloth_mesh_get_positions (mesh, NULL), sigma);
  g_clear_pointer (&mesh, gst_cloth_mesh_unref);
  self->last_time = time;
  self->n_frames++;
  self->n_at_rate++;
  enqueue_frame (self, buffer, time, sequence);
  return send_ready (self, CLOTH_OBSERVER_LATENCY);
}

/* ---- the end ---- */

static void
finish (Follow * self)
{
  if (drain (self) != GST_FLOW_OK)
    return;
  post_score (self, TRUE);
  if (self->refused)            /* that was told */
    return;
  if (self->n_frames == 0)
    GST_ELEMENT_ERROR (self->element, STREAM, FAILED,
        ("The stream ended without a %s of the scene", get_noun (self)),
        ("No %s came%s.", get_noun (self), self->warned ?
            " whose time is the scene's; set location= to its own take" : ""));
  else if ((!self->view || gst_follow_view_check_seen (self->view,
              self->element)) && self->klass->finish)
    self->klass->finish (GST_CLOTH_FOLLOW (self->element));
  restart (self);
}

/* ---- events and queries ---- */

/* One recording is of meshes or of observations: their distances mean different things. */
static gboolean
set_kind (Follow * self, gboolean observations)
{
  if (observations != (self->view != NULL) && self->n_frames > 0) {
    GST_ELEMENT_ERROR (self->element, STREAM, FORMAT,
        ("The stream changes from %s to %s within a recording.",
            observations ? "meshes" : "observations",
            observations ? "observations" : "meshes"),
        ("Flush before the change, or give each an element of its own."));
    return FALSE;
  }
  if (!observations)
    g_clear_pointer (&self->view, gst_follow_view_free);
  else if (!self->view)
    self->view = gst_follow_view_new (self->element, &self->settings,
        self->inputs.scene->topology);
  return observations == (self->view != NULL);
}

/* Caps that were refused come again before whatever comes next: the error was posted then. */
static gboolean
is_refused (Follow * self, GstCaps * caps)
{
  if (self->refused && gst_caps_is_equal (self->refused, caps))
    return TRUE;
  gst_caps_replace (&self->refused, caps);
  return FALSE;
}

static gboolean
set_caps (Follow * self, GstCaps * caps)
{
  GstStructure *s = gst_caps_get_structure (caps, 0);
  gboolean observations = gst_structure_has_name (s,
      GST_CLOTH_OBSERVATIONS_MEDIA_TYPE);
  gint fps_n = 0, fps_d = 1;

  if (is_refused (self, caps))
    return FALSE;
  if (!set_kind (self, observations) || !(observations ?
          gst_follow_view_set_caps (self->view, self->element, caps) :
          gst_follow_inputs_check_mesh (&self->inputs, self->element, caps)))
    return FALSE;
  gst_caps_replace (&self->refused, NULL);
  gst_structure_get_fraction (s, "framerate", &fps_n, &fps_d);
  if (self->n_vertices == 0) {
    self->n_vertices = self->inputs.scene->topology->n_vertices;
    self->residuals = g_new (gfloat, 3 * (gsize) self->n_vertices);
    self->sigmas = g_new (gfloat, self->n_vertices);
    self->positions = g_new (gfloat, 3 * (gsize) self->n_vertices);
    self->states = g_malloc (self->n_vertices);
  }
  if (self->fps_n > 0) {
    self->before += (gdouble) self->n_at_rate * self->fps_d / self->fps_n;
    self->n_at_rate = 0;
  }
  GST_OBJECT_LOCK (self->element);
  self->fps_n = fps_n;
  self->fps_d = fps_d;
  GST_OBJECT_UNLOCK (self->element);
  gst_element_post_message (self->element,
      gst_message_new_latency (GST_OBJECT (self->element)));
  return TRUE;
}

static gboolean
set_segment (Follow * self, GstEvent * event)
{
  gst_event_copy_segment (event, &self->segment);
  self->new_segment = TRUE;
  if (self->segment.rate > 0)
    return TRUE;
  GST_ELEMENT_ERROR (self->element, STREAM, FORMAT,
      ("A simulation can't run backwards"), ("Seek with a rate over 0."));
  return FALSE;
}

static void
flush (Follow * self)
{
  g_queue_clear_full (&self->waiting, free_waiting);
  restart (self);
  gst_segment_init (&self->segment, GST_FORMAT_TIME);
  self->warned = self->warned_views = FALSE;
  gst_caps_replace (&self->refused, NULL);
  g_atomic_int_set (&self->cancelled, FALSE);
}

/* What is known of the stream outlives a flush: our peer gets it with the next frame. */
static void
keep_sticky_events (Follow * self)
{
  for (GList * l = self->waiting.head; l; l = l->next) {
    Waiting *waiting = l->data;

    if (GST_IS_EVENT (waiting->object) && GST_EVENT_IS_STICKY (waiting->object))
      gst_pad_store_sticky_event (self->srcpad,
          GST_EVENT_CAST (waiting->object));
  }
}

/* Takes the event; NULL when an error was posted. */
static GstEvent *
make_caps_event (Follow * self, GstEvent * event)
{
  GstCaps *caps, *made;
  GstEvent *result;

  gst_event_parse_caps (event, &caps);
  made = self->klass->make_caps (GST_CLOTH_FOLLOW (self->element), caps);
  if (!made) {
    gst_caps_replace (&self->refused, caps);
    gst_event_unref (event);
    return NULL;
  }
  result = gst_event_new_caps (made);
  gst_event_set_seqnum (result, gst_event_get_seqnum (event));
  gst_caps_unref (made);
  gst_event_unref (event);
  return result;
}

static gboolean
gst_cloth_follow_sink_event (GstPad * pad, GstObject * parent, GstEvent * event)
{
  Follow *self = follow_of (parent);
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
  if (good && GST_EVENT_TYPE (event) == GST_EVENT_CAPS
      && self->klass->make_caps)
    event = make_caps_event (self, event);
  if (good && event)
    return gst_pad_push_event (self->srcpad, event);
  if (event)
    gst_event_unref (event);
  return FALSE;
}

static gboolean
gst_cloth_follow_src_query (GstPad * pad, GstObject * parent, GstQuery * query)
{
  Follow *self = follow_of (parent);
  GstClockTime own = 0;

  if (GST_QUERY_TYPE (query) != GST_QUERY_LATENCY)
    return gst_pad_query_default (pad, parent, query);
  if (!gst_pad_peer_query (self->sinkpad, query))
    return FALSE;
  GST_OBJECT_LOCK (self->element);
  if (self->fps_n > 0)
    own = gst_util_uint64_scale_int (CLOTH_OBSERVER_LATENCY * GST_SECOND,
        self->fps_d, self->fps_n);
  else if (self->inputs.scene)
    own =
        (GstClockTime) (CLOTH_OBSERVER_LATENCY / self->inputs.scene->fps * 1e9);
  GST_OBJECT_UNLOCK (self->element);
  gst_cloth_add_latency (query, own);
  return TRUE;
}

/* ---- start and stop ---- */

static gboolean
start (Follow * self)
{
  const GstFollowSettings *settings = &self->settings;
  const ClothObserverOptions options =
      { self->klass->get_gain (GST_CLOTH_FOLLOW (self->element)),
    self->klass->damping_ratio, settings->window, settings->seed,
    settings->threads, &self->cancelled
  };
  g_autoptr (GError) error = NULL;
  GstFollowInputs inputs = { NULL };
  gboolean good = gst_follow_inputs_load (&inputs, self->element,
      settings);

  GST_OBJECT_LOCK (self->element);
  self->inputs = inputs;
  GST_OBJECT_UNLOCK (self->element);
  if (!good || (self->klass->open
          && !self->klass->open (GST_CLOTH_FOLLOW (self->element))))
    return FALSE;
  self->observer = cloth_observer_new (inputs.scene, inputs.model, &options,
      &error);
  if (!self->observer) {
    GST_ELEMENT_ERROR (self->element, RESOURCE, OPEN_READ,
        ("Can't use the model: %s", error->message),
        ("model=%s", settings->model));
    return FALSE;
  }
  flush (self);
  gst_cloth_damage_reset (&self->settings.damage, self->element);
  return TRUE;
}

static void
stop (Follow * self)
{
  GstFollowInputs inputs, none = { NULL };

  flush (self);
  GST_OBJECT_LOCK (self->element);
  inputs = self->inputs;
  self->inputs = none;
  self->fps_n = 0;
  GST_OBJECT_UNLOCK (self->element);
  if (self->klass->close)
    self->klass->close (GST_CLOTH_FOLLOW (self->element));
  gst_follow_inputs_clear (&inputs);
  g_clear_pointer (&self->observer, cloth_observer_free);
  g_clear_pointer (&self->view, gst_follow_view_free);
  g_clear_pointer (&self->cameras, gst_follow_cameras_free);
  g_clear_pointer (&self->residuals, g_free);
  g_clear_pointer (&self->sigmas, g_free);
  g_clear_pointer (&self->positions, g_free);
  g_clear_pointer (&self->states, g_free);
  self->n_vertices = 0;
}

static GstStateChangeReturn
gst_cloth_follow_change_state (GstElement * element, GstStateChange transition)
{
  Follow *self = follow_of (element);
  GstStateChangeReturn result;

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !start (self)) {
    stop (self);
    return GST_STATE_CHANGE_FAILURE;
  }
  /* A diagnosis holds the streaming thread, which has to end. */
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    g_atomic_int_set (&self->cancelled, TRUE);
  result = GST_ELEMENT_CLASS
      (gst_cloth_follow_parent_class)->change_state (element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY ||
      (transition == GST_STATE_CHANGE_READY_TO_PAUSED &&
          result == GST_STATE_CHANGE_FAILURE))
    stop (self);
  return result;
}

/* ---- what subclasses ask ---- */

const GstFollowInputs *
gst_cloth_follow_get_inputs (GstClothFollow * self)
{
  return &follow_of (self)->inputs;
}

const GstFollowSettings *
gst_cloth_follow_get_settings (GstClothFollow * self)
{
  return &follow_of (self)->settings;
}

gboolean
gst_cloth_follow_has_rays (GstClothFollow * self)
{
  return follow_of (self)->view != NULL;
}

ClothObserver *
gst_cloth_follow_get_observer (GstClothFollow * self)
{
  return follow_of (self)->observer;
}

gboolean
gst_cloth_follow_is_cancelled (GstClothFollow * self)
{
  return g_atomic_int_get (&follow_of (self)->cancelled);
}

gboolean
gst_cloth_follow_keep (GstClothFollow * self, GstFollowRecord ** record,
    const GstClothFollowFrame * frame, const gchar * purpose)
{
  const GstFollowInputs *inputs = gst_cloth_follow_get_inputs (self);
  const Follow *follow = follow_of (self);
  g_autoptr (GError) error = NULL;

  if (!*record)
    *record = gst_follow_record_new (inputs->take, inputs->scene, &error);
  if (*record
      && gst_follow_record_append (*record, frame->time, frame->positions,
          frame->states, frame->covariances, &error)
      && (!follow->cameras || gst_follow_record_see (*record, follow->cameras,
              frame->buffer, &follow->segment, frame->time, &error)))
    return TRUE;
  GST_ELEMENT_ERROR (self, RESOURCE, WRITE,
      ("Can't keep the recording for its %s: %s", purpose, error->message),
      ("Make room in %s, or set TMPDIR to a folder that has.",
          g_get_tmp_dir ()));
  return FALSE;
}

/* ---- GObject ---- */

static void
gst_cloth_follow_finalize (GObject * object)
{
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &follow_of (object)->settings);
  G_OBJECT_CLASS (gst_cloth_follow_parent_class)->finalize (object);
}

/* The source pad's template is the subclass's. */
static void
gst_cloth_follow_constructed (GObject * object)
{
  Follow *self = follow_of (object);

  G_OBJECT_CLASS (gst_cloth_follow_parent_class)->constructed (object);
  self->element = GST_ELEMENT (object);
  self->klass = GST_CLOTH_FOLLOW_GET_CLASS (object);
  self->sinkpad = gst_pad_new_from_static_template (&sink_template, "sink");
  gst_pad_set_chain_function (self->sinkpad, gst_cloth_follow_chain);
  gst_pad_set_event_function (self->sinkpad, gst_cloth_follow_sink_event);
  gst_element_add_pad (self->element, self->sinkpad);
  self->srcpad =
      gst_pad_new_from_template (gst_element_class_get_pad_template
      (GST_ELEMENT_CLASS (self->klass), "src"), "src");
  gst_pad_set_query_function (self->srcpad, gst_cloth_follow_src_query);
  gst_cloth_damage_watch (&self->settings.damage, self->element, self->srcpad);
  if (self->klass->make_caps) {
    gst_pad_use_fixed_caps (self->srcpad);
  } else {
    GST_PAD_SET_PROXY_CAPS (self->sinkpad);
    GST_PAD_SET_PROXY_CAPS (self->srcpad);
  }
  gst_element_add_pad (self->element, self->srcpad);
}

static void
gst_cloth_follow_class_init (GstClothFollowClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (cloth_follow_debug, "clothfollow", 0,
      "streams held against a simulation");
  object_class->constructed = gst_cloth_follow_constructed;
  object_class->finalize = gst_cloth_follow_finalize;
  element_class->change_state = gst_cloth_follow_change_state;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      g_type_class_get_instance_private_offset (klass) +
      (gssize) G_STRUCT_OFFSET (Follow, settings));
  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_type_mark_as_plugin_api (GST_TYPE_CLOTH_FOLLOW, 0);
}

static void
gst_cloth_follow_init (GstClothFollow * instance)
{
  Follow *self = follow_of (instance);

  g_queue_init (&self->waiting);
  gst_segment_init (&self->segment, GST_FORMAT_TIME);
  self->settings = defaults;
  self->fps_d = 1;
}
