/* clothsim: a simulated cloth as a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
/**
 * SECTION:element-clothsim
 * @title: clothsim
 * @short_description: simulates a cloth as a mesh stream
 *
 * Simulates the cloth of a model in the scene of a take: its mesh, seams, clamps,
 * obstacles, gravity and times. One buffer a frame; frame i has the time of the take's
 * frame i after its first one. As fast as it goes, or live at the pace of the clock.
 * Seekable forwards and backwards by time; a seek back starts again. A simulation that
 * blows up is an error.
 *
 * ## Example
 * |[
 * gst-launch-1.0 clothsim model=model.json location=take ! meshsink location=cloth.ply
 * ]|
 *
 * Since: 0.1
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsim.h"

#include <gst/cloth/cloth.h>
#include <string.h>

#include "elements/gstmeshformat.h"
#include "gst/sim/sim.h"

GST_DEBUG_CATEGORY_STATIC (cloth_sim_debug);
#define GST_CAT_DEFAULT cloth_sim_debug

#define MAX_TIME_S 4e6

enum
{
  PROP_0,
  PROP_MODEL,
  PROP_LOCATION,
  PROP_LIVE,
  PROP_SEED,
  PROP_THREADS
};

struct _GstClothSim
{
  GstPushSrc parent;

  /* with the object lock */
  gchar *model_location;
  gchar *location;
  guint64 seed;
  guint threads;

  /* from start to stop */
  ClothScene *scene;
  ClothModel *model;
  ClothSim *sim;
  GstCaps *caps;
  guint sim_frame;              /* the frame that the simulation stands at */
  guint next;                   /* the next to send */
  gdouble *positions;
  gfloat *places;
  guint8 *states;
};

static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

G_DEFINE_TYPE (GstClothSim, gst_cloth_sim, GST_TYPE_PUSH_SRC);
GST_ELEMENT_REGISTER_DEFINE (clothsim, "clothsim", GST_RANK_NONE,
    GST_TYPE_CLOTH_SIM);

/* Time of a frame after the first; of n_frames, the end: the last frame lasts as long as
 * the one before. */
static GstClockTime
frame_time (GstClothSim * self, guint frame)
{
  const ClothScene *scene = self->scene;
  guint n = scene->n_frames;
  gdouble last = scene->times[n - 1] - scene->times[0];
  gdouble seconds;

  if (frame < n)
    seconds = scene->times[frame] - scene->times[0];
  else
    seconds = last + (n > 1 ? scene->times[n - 1] - scene->times[n - 2] :
        1 / scene->fps);
  return (GstClockTime) (seconds * GST_SECOND + 0.5);
}

static gboolean
make_sim (GstClothSim * self)
{
  const ClothSimOptions options = { FALSE, self->threads, CLOTH_SIMD_BEST,
    self->seed
  };
  const ClothModel *models[1] = { self->model };
  g_autoptr (GError) error = NULL;

  g_clear_pointer (&self->sim, cloth_sim_free);
  self->sim = cloth_sim_new (self->scene, models, 1, &options, &error);
  self->sim_frame = 0;
  if (self->sim)
    return TRUE;
  GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("Cannot simulate “%s” in the "
          "scene “%s”: %s", self->model_location, self->location,
          error->message), (NULL));
  return FALSE;
}

static gboolean
load_scene (GstClothSim * self)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTake) take = cloth_take_open (self->location, &error);

  if (take)
    self->scene = cloth_scene_new_from_take (take, &error);
  if (!self->scene) {
    gst_mesh_post_error (GST_ELEMENT (self), "read the scene", self->location,
        FALSE, error);
    return FALSE;
  }
  if (self->scene->times[self->scene->n_frames - 1] -
      self->scene->times[0] > MAX_TIME_S) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("The take “%s” lasts longer "
            "than the %g s that are played", self->location, MAX_TIME_S),
        (NULL));
    return FALSE;
  }
  return TRUE;
}

static gboolean
load_model (GstClothSim * self)
{
  g_autoptr (GError) error = NULL;

  self->model = cloth_model_load (self->model_location, &error);
  if (self->model)
    return TRUE;
  if (error->domain == CLOTH_MODEL_ERROR)
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS, ("%s", error->message),
        (NULL));
  else
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND, ("Cannot read the model: %s",
            error->message), (NULL));
  return FALSE;
}

static gboolean
make_caps (GstClothSim * self)
{
  const ClothTopology *topology = self->scene->topology;
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) sent =
      gst_cloth_topology_new (topology->n_vertices, topology->columns,
      topology->rows, topology->uv, topology->faces, topology->n_faces, &error);
  gint fps_n, fps_d;

  if (!sent) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("The mesh of “%s” is not "
            "valid: %s", self->location, error->message), (NULL));
    return FALSE;
  }
  gst_util_double_to_fraction (self->scene->fps, &fps_n, &fps_d);
  self->caps = gst_cloth_topology_to_caps (sent, fps_n, fps_d);
  return TRUE;
}

static gboolean
gst_cloth_sim_stop (GstBaseSrc * src)
{
  GstClothSim *self = GST_CLOTH_SIM (src);

  g_clear_pointer (&self->sim, cloth_sim_free);
  g_clear_pointer (&self->model, cloth_model_free);
  g_clear_pointer (&self->scene, cloth_scene_free);
  g_clear_pointer (&self->positions, g_free);
  g_clear_pointer (&self->places, g_free);
  g_clear_pointer (&self->states, g_free);
  GST_OBJECT_LOCK (self);
  gst_clear_caps (&self->caps);
  GST_OBJECT_UNLOCK (self);
  return TRUE;
}

static gboolean
gst_cloth_sim_start (GstBaseSrc * src)
{
  GstClothSim *self = GST_CLOTH_SIM (src);
  gsize n;

  if (!self->model_location || !*self->model_location ||
      !self->location || !*self->location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("Set the property “model” "
            "to a model.json and “location” to the take that gives the scene"),
        (NULL));
    return FALSE;
  }
  if (!load_model (self) || !load_scene (self) || !make_sim (self) ||
      !make_caps (self)) {
    gst_cloth_sim_stop (src);
    return FALSE;
  }
  n = self->scene->topology->n_vertices;
  self->positions = g_new (gdouble, 3 * n);
  self->places = g_new (gfloat, 3 * n);
  self->states = g_malloc (n);
  memset (self->states, GST_CLOTH_VERTEX_PREDICTED, n);
  self->next = 0;
  GST_OBJECT_LOCK (self);
  src->segment.duration = frame_time (self, self->scene->n_frames);
  GST_OBJECT_UNLOCK (self);
  return TRUE;
}

static GstCaps *
gst_cloth_sim_get_caps (GstBaseSrc * src, GstCaps * filter)
{
  GstClothSim *self = GST_CLOTH_SIM (src);
  GstCaps *caps, *filtered;

  GST_OBJECT_LOCK (self);
  caps = self->caps ? gst_caps_ref (self->caps) : NULL;
  GST_OBJECT_UNLOCK (self);
  if (!caps)
    caps = gst_pad_get_pad_template_caps (src->srcpad);
  if (!filter)
    return caps;
  filtered = gst_caps_intersect_full (filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref (caps);
  return filtered;
}

static gboolean
gst_cloth_sim_is_seekable (GstBaseSrc * src)
{
  return GST_CLOTH_SIM (src)->sim && !gst_base_src_is_live (src);
}

static gboolean
gst_cloth_sim_do_seek (GstBaseSrc * src, GstSegment * segment)
{
  GstClothSim *self = GST_CLOTH_SIM (src);

  if (segment->format != GST_FORMAT_TIME || segment->rate < 0)
    return FALSE;
  segment->time = segment->start;
  /* the frame that is shown then */
  self->next = 0;
  while (self->next < self->scene->n_frames &&
      frame_time (self, self->next + 1) <= segment->position)
    self->next++;
  /* What is past is not kept: begin again. */
  if (self->next < self->sim_frame)
    return make_sim (self);
  return TRUE;
}

static gboolean
gst_cloth_sim_query (GstBaseSrc * src, GstQuery * query)
{
  GstClothSim *self = GST_CLOTH_SIM (src);
  GstFormat format;
  GstClockTime duration;

  GST_OBJECT_LOCK (self);
  duration = self->caps ? src->segment.duration : GST_CLOCK_TIME_NONE;
  GST_OBJECT_UNLOCK (self);
  if (GST_QUERY_TYPE (query) == GST_QUERY_DURATION &&
      GST_CLOCK_TIME_IS_VALID (duration)) {
    gst_query_parse_duration (query, &format, NULL);
    if (format != GST_FORMAT_TIME)
      return FALSE;
    gst_query_set_duration (query, format, (gint64) duration);
    return TRUE;
  }
  return GST_BASE_SRC_CLASS (gst_cloth_sim_parent_class)->query (src, query);
}

/* A live frame is sent when its time has come. */
static void
gst_cloth_sim_get_times (GstBaseSrc * src, GstBuffer * buffer,
    GstClockTime * start, GstClockTime * end)
{
  if (!gst_base_src_is_live (src))
    return;
  *start = GST_BUFFER_PTS (buffer);
  *end = *start + GST_BUFFER_DURATION (buffer);
}

static GstFlowReturn
gst_cloth_sim_create (GstPushSrc * src, GstBuffer ** buffer)
{
  GstClothSim *self = GST_CLOTH_SIM (src);
  const GstSegment *segment = &GST_BASE_SRC (src)->segment;
  const ClothScene *scene = self->scene;
  g_autoptr (GstClothMesh) mesh = NULL;
  gdouble since_s;

  if (self->next >= scene->n_frames ||
      (GST_CLOCK_TIME_IS_VALID (segment->stop) &&
          frame_time (self, self->next) >= segment->stop))
    return GST_FLOW_EOS;
  /* Frame by frame, also those that are not sent, so that a seek changes no bit. */
  while (self->sim_frame < self->next)
    cloth_sim_advance (self->sim, scene->times[++self->sim_frame]);
  if (cloth_sim_get_state (self->sim, 0, &since_s) != CLOTH_SIM_OK) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED,
        ("The simulation of “%s” blew up "
            "at %.3f s: set its “time_step” below %g s or to 0, or lower its "
            "stiffnesses and damping.stiffness", self->model_location, since_s,
            cloth_sim_get_time_step (self->sim)), (NULL));
    return GST_FLOW_ERROR;
  }
  cloth_sim_get_positions (self->sim, 0, self->positions);
  for (gsize i = 0; i < 3 * (gsize) scene->topology->n_vertices; i++)
    self->places[i] = (gfloat) self->positions[i];
  mesh = gst_cloth_mesh_new (self->next, scene->topology->n_vertices,
      self->places, self->states, NULL);
  *buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (*buffer) = frame_time (self, self->next);
  GST_BUFFER_DURATION (*buffer) = frame_time (self, self->next + 1) -
      GST_BUFFER_PTS (*buffer);
  GST_BUFFER_OFFSET (*buffer) = self->next;
  GST_BUFFER_OFFSET_END (*buffer) = self->next + 1;
  self->next++;
  return GST_FLOW_OK;
}

static void
gst_cloth_sim_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * spec)
{
  GstClothSim *self = GST_CLOTH_SIM (object);

  if (id == PROP_LIVE) {
    gst_base_src_set_live (GST_BASE_SRC (self), g_value_get_boolean (value));
    return;
  }
  GST_OBJECT_LOCK (self);
  if (GST_STATE (self) > GST_STATE_READY) {
    GST_WARNING_OBJECT (self, "“%s” cannot change while running",
        spec->name);
    GST_OBJECT_UNLOCK (self);
    return;
  }
  switch (id) {
    case PROP_MODEL:
      g_free (self->model_location);
      self->model_location = g_value_dup_string (value);
      break;
    case PROP_LOCATION:
      g_free (self->location);
      self->location = g_value_dup_string (value);
      break;
    case PROP_SEED:
      self->seed = g_value_get_uint64 (value);
      break;
    case PROP_THREADS:
      self->threads = g_value_get_uint (value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, spec);
      break;
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_cloth_sim_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * spec)
{
  GstClothSim *self = GST_CLOTH_SIM (object);

  if (id == PROP_LIVE) {
    g_value_set_boolean (value, gst_base_src_is_live (GST_BASE_SRC (self)));
    return;
  }
  GST_OBJECT_LOCK (self);
  switch (id) {
    case PROP_MODEL:
      g_value_set_string (value, self->model_location);
      break;
    case PROP_LOCATION:
      g_value_set_string (value, self->location);
      break;
    case PROP_SEED:
      g_value_set_uint64 (value, self->seed);
      break;
    case PROP_THREADS:
      g_value_set_uint (value, self->threads);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, spec);
      break;
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_cloth_sim_finalize (GObject * object)
{
  GstClothSim *self = GST_CLOTH_SIM (object);

  gst_cloth_sim_stop (GST_BASE_SRC (self));
  g_free (self->model_location);
  g_free (self->location);
  G_OBJECT_CLASS (gst_cloth_sim_parent_class)->finalize (object);
}

static void
gst_cloth_sim_class_init (GstClothSimClass * klass)
{
  const GParamFlags flags = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
      GST_PARAM_MUTABLE_READY;
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseSrcClass *src_class = GST_BASE_SRC_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (cloth_sim_debug, "clothsim", 0, "simulated cloth");
  object_class->set_property = gst_cloth_sim_set_property;
  object_class->get_property = gst_cloth_sim_get_property;
  object_class->finalize = gst_cloth_sim_finalize;
  g_object_class_install_property (object_class, PROP_MODEL,
      g_param_spec_string ("model", "Model",
          "What the cloth is like: a model.json", NULL, flags));
  g_object_class_install_property (object_class, PROP_LOCATION,
      g_param_spec_string ("location", "Location",
          "Folder of the take that gives the scene: mesh, clamps, obstacles and "
          "times", NULL, flags));
  g_object_class_install_property (object_class, PROP_LIVE,
      g_param_spec_boolean ("live", "Live",
          "Send frames at the pace of the clock, not as fast as they come",
          FALSE, flags));
  g_object_class_install_property (object_class, PROP_SEED,
      g_param_spec_uint64 ("seed", "Seed",
          "Of what is random in effects, such as gusts", 0, G_MAXUINT64, 0,
          flags));
  g_object_class_install_property (object_class, PROP_THREADS,
      g_param_spec_uint ("threads", "Threads",
          "Threads of computation, 0 for one on each processor", 0, 256, 0,
          flags));
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Cloth simulator",
      "Source", "Simulates a cloth as a mesh stream", PACKAGE_NAME);
  src_class->start = gst_cloth_sim_start;
  src_class->stop = gst_cloth_sim_stop;
  src_class->get_caps = gst_cloth_sim_get_caps;
  src_class->get_times = gst_cloth_sim_get_times;
  src_class->is_seekable = gst_cloth_sim_is_seekable;
  src_class->do_seek = gst_cloth_sim_do_seek;
  src_class->query = gst_cloth_sim_query;
  GST_PUSH_SRC_CLASS (klass)->create = gst_cloth_sim_create;
}

static void
gst_cloth_sim_init (GstClothSim * self)
{
  gst_base_src_set_format (GST_BASE_SRC (self), GST_FORMAT_TIME);
}
