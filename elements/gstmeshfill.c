/* meshfill: a mesh stream with holes becomes a whole one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
/**
 * SECTION:element-meshfill
 * @title: meshfill
 * @short_description: fills the holes of meshes
 *
 * Vertices that no two cameras saw are filled by a thin plate through those around them.
 * The plate has the measures of the flat cloth and is free at the cloth's border; what
 * was seen of a place before is kept in the measure in which the cloth around it keeps
 * its shape. Vertices that disagree with their neighbours and their past are removed and
 * filled. Each vertex says whether it was measured, filled or predicted, and how sure
 * that is; one that is less sure than `max-sigma` stays unseen.
 *
 * Where nothing around holds a vertex, as when no camera sees anything, its motion is
 * carried on for `prediction` seconds; then it is unseen.
 *
 * `smooth-space` and `smooth-time` are the paper's smoothing. At the noise of good cameras it
 * takes more of the shape than of the noise, so it is off. `smooth-time` waits for the next
 * frame, which the element reports as latency.
 *
 * With `garment` the grid of an M-array's dots becomes the mesh of the garment that was cut
 * from the print. Its outlines have no dots and are filled, over seams from both sides.
 *
 * ## A take without holes
 * |[
 * gst-launch-1.0 meshsrc location=take ! meshfill ! meshsink location=cloth.obj
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstmeshfill.h"

#include <gst/cloth/cloth.h>
#include <math.h>

#include "elements/gstclothdamage.h"
#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"
#include "gst/mesh/fill/fill.h"
#include "gst/mesh/garment/garment.h"

GST_DEBUG_CATEGORY_STATIC (mesh_fill_debug);
#define GST_CAT_DEFAULT mesh_fill_debug

/* Two frame periods that differ by less than this part of them are the same. */
#define PERIOD_TOLERANCE 0.1

/* A frame that was filled. */
typedef struct
{
  GstBuffer *buffer;            /* as it came; NULL: no frame */
  guint64 sequence;
  gdouble time;
  gfloat *positions, *covariances;
  guint8 *states;
} Frame;

typedef struct
{
  ClothFillParameters parameters;
  gdouble smooth_space, smooth_time;
  gchar *garment;
  GstClothDamage damage;
} Settings;

struct _GstMeshFill
{
  GstElement parent;
  GstPad *sinkpad, *srcpad;

  /* object lock */
  Settings settings;
  gint fps_n, fps_d;

  /* from READY to PAUSED on */
  ClothGarment *garment;

  /* streaming thread */
  GstSegment segment;
  ClothTopology *topology;
  ClothFill *fill;
  guint64 n_frames;
  /* Smoothing in time: the last frame sent, as filled, the one that waits, and room. */
  Frame frame[3];
  gfloat *smoothed;
  guint n_input;                /* vertices that come */
  /* with a garment, what comes in the order of its vertices */
  gfloat *chosen, *chosen_covariances;
  guint8 *chosen_states;
};

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

G_DEFINE_TYPE (GstMeshFill, gst_mesh_fill, GST_TYPE_ELEMENT);
GST_ELEMENT_REGISTER_DEFINE (meshfill, "meshfill", GST_RANK_NONE,
    GST_TYPE_MESH_FILL);

static const GEnumValue methods[] = {
  {CLOTH_FILL_PLATE,
        "A thin plate with the flat cloth's measures and the shape seen before",
      "plate"},
  {CLOTH_FILL_BILAPLACIAN,
      "The paper's uniform bi-Laplacian, each frame alone", "bilaplacian"},
  {0, NULL, NULL}
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"method", "Method", "What fills a hole",
    G_TYPE_ENUM, SETTING (parameters.method), GST_PARAM_MUTABLE_PLAYING, 0, 0,
    "GstMeshFillMethod", methods},
  {"garment", "Garment",
    "File garment.json of the garment that the dots are on: a grid of "
    "dots comes in, the garment's mesh goes out, sewn at its seams",
    G_TYPE_STRING, SETTING (garment), GST_PARAM_MUTABLE_READY},
  {"noise", "Noise",
    "Standard deviation of a coordinate that comes without covariance, metres",
    G_TYPE_DOUBLE, SETTING (parameters.noise_m), GST_PARAM_MUTABLE_PLAYING, 0, 1},
  {"max-sigma", "Largest sigma",
    "A vertex with a standard deviation above this (RMS of its axes) stays "
    "unseen, metres",
    G_TYPE_DOUBLE, SETTING (parameters.max_sigma_m), GST_PARAM_MUTABLE_PLAYING, 0, 1000},
  {"prediction", "Prediction",
    "How long a vertex is carried on that nothing around it holds, seconds",
    G_TYPE_DOUBLE, SETTING (parameters.prediction_s), GST_PARAM_MUTABLE_PLAYING, 0, 3600},
  {"outlier-threshold", "Outlier threshold",
    "A vertex is removed that differs from its neighbours and its past by more "
    "than this many times what is usual around it; 0: none",
    G_TYPE_DOUBLE, SETTING (parameters.outlier), GST_PARAM_MUTABLE_PLAYING, 0, 1000},
  {"smooth-space", "Smoothing in space",
    "Part of the way to the mean of its neighbours that a vertex goes",
    G_TYPE_DOUBLE, SETTING (smooth_space), GST_PARAM_MUTABLE_PLAYING, 0, 1},
  {"smooth-time", "Smoothing in time",
    "Part of the way to the mean of the frames before and after that a vertex "
    "goes; above 0 the element is a frame late",
    G_TYPE_DOUBLE, SETTING (smooth_time), GST_PARAM_MUTABLE_READY, 0, 1},
  GST_CLOTH_DAMAGE_PROPERTIES (Settings, damage),
};
/* *INDENT-ON* */

static const Settings defaults = {
  .parameters = {CLOTH_FILL_PLATE, CLOTH_FILL_NOISE, CLOTH_FILL_MAX_SIGMA,
      CLOTH_FILL_PREDICTION, CLOTH_FILL_OUTLIER}
};

/* ---- frames ---- */

/* Forgets the frames, not the topology. */
static void
clear_frames (GstMeshFill * self)
{
  for (guint i = 0; i < G_N_ELEMENTS (self->frame); i++)
    gst_clear_buffer (&self->frame[i].buffer);
  if (self->fill)
    cloth_fill_reset (self->fill);
  self->n_frames = 0;
}

static void
clear_topology (GstMeshFill * self)
{
  clear_frames (self);
  g_clear_pointer (&self->fill, cloth_fill_free);
  g_clear_pointer (&self->topology, cloth_topology_free);
  for (guint i = 0; i < G_N_ELEMENTS (self->frame); i++) {
    g_clear_pointer (&self->frame[i].positions, g_free);
    g_clear_pointer (&self->frame[i].covariances, g_free);
    g_clear_pointer (&self->frame[i].states, g_free);
  }
  g_clear_pointer (&self->smoothed, g_free);
  g_clear_pointer (&self->chosen, g_free);
  g_clear_pointer (&self->chosen_covariances, g_free);
  g_clear_pointer (&self->chosen_states, g_free);
}

/* Sends a frame with other @positions. */
static GstFlowReturn
send (GstMeshFill * self, const Frame * frame, const gfloat * positions)
{
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (frame->sequence,
      self->topology->n_vertices, positions, frame->states, frame->covariances);
  GstBuffer *buffer = gst_cloth_mesh_to_buffer (mesh);

  gst_buffer_copy_into (buffer, frame->buffer, GST_BUFFER_COPY_METADATA, 0, -1);
  return gst_pad_push (self->srcpad, buffer);
}

/* Sends the frame that waits, smoothed in time when both its neighbours are there. */
static GstFlowReturn
send_waiting (GstMeshFill * self, const Frame * next, gdouble weight)
{
  Frame *before = &self->frame[0], *frame = &self->frame[1], swap;
  gsize size = 3 * (gsize) self->topology->n_vertices * sizeof (gfloat);
  GstFlowReturn flow;

  memcpy (self->smoothed, frame->positions, size);
  if (before->buffer && next) {
    gdouble step[2] = { frame->time - before->time, next->time - frame->time };

    if (fabs (step[1] - step[0]) <= PERIOD_TOLERANCE * step[0])
      cloth_smooth_time (self->topology->n_vertices, weight, before->positions,
          next->positions, self->smoothed);
  }
  flow = send (self, frame, self->smoothed);
  gst_clear_buffer (&before->buffer);
  swap = *before;
  *before = *frame;
  *frame = swap;
  return flow;
}

static GstFlowReturn
drain (GstMeshFill * self)
{
  GstFlowReturn flow = GST_FLOW_OK;

  if (self->frame[1].buffer)
    flow = send_waiting (self, NULL, 0);
  gst_clear_buffer (&self->frame[0].buffer);
  return flow;
}

/* Seconds of the stream; frames without a time follow the frame rate, or each other. */
static gdouble
find_time (GstMeshFill * self, GstBuffer * buffer)
{
  GstClockTime time = gst_cloth_stream_time (&self->segment, buffer);

  if (GST_CLOCK_TIME_IS_VALID (time))
    return (gdouble) time / GST_SECOND;
  return self->fps_n > 0 ? (gdouble) self->n_frames * self->fps_d / self->fps_n
      : (gdouble) self->n_frames;
}

/* What of the print's dots is in the garment; its outlines have none. */
static void
choose (GstMeshFill * self, ClothMeshFrame * frame)
{
  for (guint v = 0; v < self->topology->n_vertices; v++) {
    gint dot = self->garment->dots[v];

    self->chosen_states[v] = dot == CLOTH_NO_DOT ? CLOTH_VERTEX_UNSEEN
        : frame->states[dot];
    for (guint c = 0; c < 3; c++)
      self->chosen[3 * v + c] = dot == CLOTH_NO_DOT ? NAN
          : frame->positions[3 * dot + c];
    for (guint c = 0; c < 6; c++)
      self->chosen_covariances[6 * v + c] = dot == CLOTH_NO_DOT
          || !frame->covariances ? NAN : frame->covariances[6 * dot + c];
  }
  frame->positions = self->chosen;
  frame->states = self->chosen_states;
  frame->covariances = self->chosen_covariances;
}

/* Fills a frame into the room for one; its buffer is given. */
static void
fill_frame (GstMeshFill * self, Frame * frame, GstClothMesh * mesh,
    gdouble smooth_space)
{
  ClothMeshFrame in = { gst_cloth_mesh_get_positions (mesh, NULL),
    gst_cloth_mesh_get_states (mesh, NULL),
    gst_cloth_mesh_get_covariances (mesh, NULL)
  }, out;
  gsize n = self->topology->n_vertices;
  ClothFillCounts counts;

  if (self->garment)
    choose (self, &in);
  cloth_fill_run (self->fill, frame->time, &in, &out, &counts);
  GST_LOG_OBJECT (self, "frame %" G_GUINT64_FORMAT ": %u outliers, %u holes "
      "(%u new), %u filled, %u predicted, %u unseen", frame->sequence,
      counts.outliers, counts.holes, counts.factored, counts.filled,
      counts.predicted, counts.unseen);
  if (smooth_space > 0)
    cloth_smooth_space (cloth_fill_get_stencils (self->fill), smooth_space,
        out.positions, frame->positions);
  else
    memcpy (frame->positions, out.positions, 3 * n * sizeof (gfloat));
  memcpy (frame->covariances, out.covariances, 6 * n * sizeof (gfloat));
  memcpy (frame->states, out.states, n);
}

static GstFlowReturn
gst_mesh_fill_chain (GstPad * pad, GstObject * parent, GstBuffer * buffer)
{
  GstMeshFill *self = GST_MESH_FILL (parent);
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GError) error = NULL;
  gdouble smooth_space, smooth_time;
  GstFlowReturn flow = GST_FLOW_OK;
  Frame *frame = &self->frame[2], *waiting = &self->frame[1], swap;

  if (!self->topology) {
    gst_buffer_unref (buffer);
    return GST_FLOW_NOT_NEGOTIATED;
  }
  mesh = gst_cloth_parse_mesh (buffer, self->n_input, &error);
  if (!mesh) {
    /* those without a time that come after it keep their own */
    self->n_frames++;
    gst_buffer_unref (buffer);
    return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
        error);
  }
  GST_OBJECT_LOCK (self);
  cloth_fill_set_parameters (self->fill, &self->settings.parameters);
  smooth_space = self->settings.smooth_space;
  smooth_time = self->settings.smooth_time;
  GST_OBJECT_UNLOCK (self);

  frame->buffer = buffer;
  frame->sequence = gst_cloth_mesh_get_sequence (mesh);
  frame->time = find_time (self, buffer);
  self->n_frames++;
  fill_frame (self, frame, mesh, smooth_space);
  if (smooth_time > 0) {
    if (waiting->buffer)
      flow = send_waiting (self, frame, smooth_time);
    swap = *waiting;
    *waiting = *frame;
    *frame = swap;
    return flow;
  }
  flow = send (self, frame, frame->positions);
  gst_clear_buffer (&frame->buffer);
  return flow;
}

/* ---- events and queries ---- */

static gboolean
set_caps (GstMeshFill * self, const GstCaps * caps)
{
  g_autoptr (GstClothTopology) parsed =
      gst_cloth_read_topology (GST_ELEMENT (self), caps);
  g_autoptr (ClothTopology) topology = NULL;
  gint fps_n = 0, fps_d = 1;
  gsize n;

  if (!parsed)
    return FALSE;
  gst_structure_get_fraction (gst_caps_get_structure (caps, 0), "framerate",
      &fps_n, &fps_d);
  GST_OBJECT_LOCK (self);
  self->fps_n = fps_n;
  self->fps_d = fps_d;
  GST_OBJECT_UNLOCK (self);
  gst_element_post_message (GST_ELEMENT (self),
      gst_message_new_latency (GST_OBJECT (self)));
  self->n_input = gst_cloth_topology_get_n_vertices (parsed);
  if (self->garment) {
    if (gst_cloth_topology_get_columns (parsed) != self->garment->columns
        || gst_cloth_topology_get_rows (parsed) != self->garment->rows) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("The garment is cut from %u × %u dots, but the mesh is a grid of "
              "%u × %u; set garment= to the one that was filmed",
              self->garment->columns, self->garment->rows,
              gst_cloth_topology_get_columns (parsed),
              gst_cloth_topology_get_rows (parsed)), (NULL));
      return FALSE;
    }
    topology = cloth_topology_copy (self->garment->topology);
  } else {
    topology = gst_mesh_copy_topology (parsed);
  }
  if (self->topology && cloth_topology_equal (self->topology, topology))
    return TRUE;
  clear_topology (self);
  GST_OBJECT_LOCK (self);
  self->fill = cloth_fill_new (topology,
      self->garment ? self->garment->seams : NULL, &self->settings.parameters);
  GST_OBJECT_UNLOCK (self);
  n = topology->n_vertices;
  for (guint i = 0; i < G_N_ELEMENTS (self->frame); i++) {
    self->frame[i].positions = g_new (gfloat, 3 * n);
    self->frame[i].covariances = g_new (gfloat, 6 * n);
    self->frame[i].states = g_new (guint8, n);
  }
  self->smoothed = g_new (gfloat, 3 * n);
  if (self->garment) {
    self->chosen = g_new (gfloat, 3 * n);
    self->chosen_covariances = g_new (gfloat, 6 * n);
    self->chosen_states = g_new (guint8, n);
  }
  self->topology = g_steal_pointer (&topology);
  return TRUE;
}

/* The caps that go on: of a garment its own. */
static GstEvent *
outgoing_caps (GstMeshFill * self, GstEvent * event)
{
  g_autoptr (GstClothTopology) topology = NULL;
  g_autoptr (GstCaps) caps = NULL;
  g_autoptr (GError) error = NULL;
  GstEvent *other;

  if (!self->garment)
    return event;
  topology = gst_cloth_topology_new (self->topology->n_vertices, 0, 0,
      self->topology->uv, self->topology->faces, self->topology->n_faces,
      &error);
  if (!topology) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("%s", error->message), (NULL));
    return event;
  }
  caps = gst_cloth_topology_to_caps (topology, self->fps_n, self->fps_d);
  other = gst_event_new_caps (caps);
  gst_event_set_seqnum (other, gst_event_get_seqnum (event));
  gst_event_unref (event);
  return other;
}

static gboolean
gst_mesh_fill_sink_event (GstPad * pad, GstObject * parent, GstEvent * event)
{
  GstMeshFill *self = GST_MESH_FILL (parent);
  gboolean good = TRUE;
  GstCaps *caps;

  /* What comes after a frame leaves after it. */
  if (GST_EVENT_IS_SERIALIZED (event)
      && GST_EVENT_TYPE (event) != GST_EVENT_FLUSH_STOP)
    drain (self);
  switch (GST_EVENT_TYPE (event)) {
    case GST_EVENT_FLUSH_STOP:
      clear_frames (self);
      gst_segment_init (&self->segment, GST_FORMAT_TIME);
      break;
    case GST_EVENT_CAPS:
      gst_event_parse_caps (event, &caps);
      good = set_caps (self, caps);
      if (good)
        event = outgoing_caps (self, event);
      break;
    case GST_EVENT_SEGMENT:
      gst_event_copy_segment (event, &self->segment);
      clear_frames (self);
      break;
    default:
      break;
  }
  if (good)
    return gst_pad_push_event (self->srcpad, event);
  gst_event_unref (event);
  return FALSE;
}

/* A garment has another mesh than what comes; else both sides have the same caps. */
static gboolean
answer_caps (GstMeshFill * self, GstPad * pad, GstQuery * query)
{
  GstCaps *filter;

  if (!self->garment)
    return gst_pad_proxy_query_caps (pad, query);
  gst_query_parse_caps (query, &filter);
  {
    g_autoptr (GstCaps) caps =
        gst_cloth_filter_caps (gst_pad_get_pad_template_caps (pad), filter);

    gst_query_set_caps_result (query, caps);
  }
  return TRUE;
}

static gboolean
gst_mesh_fill_sink_query (GstPad * pad, GstObject * parent, GstQuery * query)
{
  if (GST_QUERY_TYPE (query) == GST_QUERY_CAPS)
    return answer_caps (GST_MESH_FILL (parent), pad, query);
  return gst_pad_query_default (pad, parent, query);
}

static gboolean
gst_mesh_fill_src_query (GstPad * pad, GstObject * parent, GstQuery * query)
{
  GstMeshFill *self = GST_MESH_FILL (parent);
  GstClockTime own = 0;

  if (GST_QUERY_TYPE (query) == GST_QUERY_CAPS)
    return answer_caps (self, pad, query);
  if (GST_QUERY_TYPE (query) != GST_QUERY_LATENCY)
    return gst_pad_query_default (pad, parent, query);
  if (!gst_pad_peer_query (self->sinkpad, query))
    return FALSE;
  GST_OBJECT_LOCK (self);
  if (self->settings.smooth_time > 0 && self->fps_n > 0)
    own = gst_util_uint64_scale_int (GST_SECOND, self->fps_d, self->fps_n);
  GST_OBJECT_UNLOCK (self);
  gst_cloth_add_latency (query, own);
  return TRUE;
}

static gboolean
open_garment (GstMeshFill * self)
{
  g_autofree gchar *location = NULL;
  g_autoptr (GError) error = NULL;

  GST_OBJECT_LOCK (self);
  location = g_strdup (self->settings.garment);
  GST_OBJECT_UNLOCK (self);
  g_clear_pointer (&self->garment, cloth_garment_free);
  if (!location)
    return TRUE;
  self->garment = cloth_garment_load (location, &error);
  if (!self->garment)
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("Can't read the garment: %s", error->message),
        ("garment=%s", location));
  return self->garment != NULL;
}

static GstStateChangeReturn
gst_mesh_fill_change_state (GstElement * element, GstStateChange transition)
{
  GstMeshFill *self = GST_MESH_FILL (element);
  GstStateChangeReturn result;

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED) {
    gst_segment_init (&self->segment, GST_FORMAT_TIME);
    gst_cloth_damage_reset (&self->settings.damage, element);
    if (!open_garment (self))
      return GST_STATE_CHANGE_FAILURE;
  }
  result = GST_ELEMENT_CLASS (gst_mesh_fill_parent_class)->change_state
      (element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
    clear_topology (self);
    g_clear_pointer (&self->garment, cloth_garment_free);
  }
  return result;
}

/* ---- GObject ---- */

static void
gst_mesh_fill_finalize (GObject * object)
{
  GstMeshFill *self = GST_MESH_FILL (object);

  clear_topology (self);
  cloth_garment_free (self->garment);
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  G_OBJECT_CLASS (gst_mesh_fill_parent_class)->finalize (object);
}

static void
gst_mesh_fill_class_init (GstMeshFillClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (mesh_fill_debug, "meshfill", 0, "holes of meshes");
  object_class->finalize = gst_mesh_fill_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstMeshFill,
          settings));
  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Mesh filler",
      "Filter/Analyzer",
      "Fills holes in a mesh stream, removes outliers, smooths",
      "The gst-cloth developers");
  element_class->change_state = gst_mesh_fill_change_state;
}

static void
gst_mesh_fill_init (GstMeshFill * self)
{
  self->settings = defaults;
  self->fps_d = 1;
  gst_segment_init (&self->segment, GST_FORMAT_TIME);
  self->sinkpad = gst_pad_new_from_static_template (&sink_template, "sink");
  gst_pad_set_chain_function (self->sinkpad, gst_mesh_fill_chain);
  gst_pad_set_event_function (self->sinkpad, gst_mesh_fill_sink_event);
  gst_pad_set_query_function (self->sinkpad, gst_mesh_fill_sink_query);
  gst_element_add_pad (GST_ELEMENT (self), self->sinkpad);
  self->srcpad = gst_pad_new_from_static_template (&src_template, "src");
  gst_pad_set_query_function (self->srcpad, gst_mesh_fill_src_query);
  gst_cloth_damage_watch (&self->settings.damage, GST_ELEMENT (self),
      self->srcpad);
  gst_element_add_pad (GST_ELEMENT (self), self->srcpad);
}
