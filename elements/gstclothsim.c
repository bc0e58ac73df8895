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
 * frame i after its first one. As fast as it goes, or live at the pace of the clock: no
 * frame before its time. A computer that can't keep pace sends frames late, none left out
 * and each with its own time; what becomes of late ones the sink decides (max-lateness).
 * Seekable forwards and backwards by time; a seek back starts again. A simulation that
 * blows up is an error.
 *
 * ## Example
 * |[
 * gst-launch-1.0 clothsim model=model.json location=take ! meshsink location=cloth.ply
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsim.h"

#include <string.h>

#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"
#include "gst/sim/sim.h"

GST_DEBUG_CATEGORY_STATIC (cloth_sim_debug);
#define GST_CAT_DEFAULT cloth_sim_debug

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
  GstClothSource parent;

  /* with the object lock */
  gchar *model_location;
  gchar *location;
  guint64 seed;
  guint threads;

  /* from start to stop */
  ClothScene *scene;
  ClothModel *model;
  ClothSim *sim;
  guint sim_frame;              /* the frame that the simulation stands at */
  gdouble *positions;
  gfloat *places;
  guint8 *states;
};

G_DEFINE_TYPE (GstClothSim, gst_cloth_sim, GST_TYPE_CLOTH_SOURCE);
GST_ELEMENT_REGISTER_DEFINE (clothsim, "clothsim", GST_RANK_NONE,
    GST_TYPE_CLOTH_SIM);

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
  if (self->scene)
    return TRUE;
  gst_mesh_post_error (GST_ELEMENT (self), "read the scene", self->location,
      FALSE, error);
  return FALSE;
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

static void
gst_cloth_sim_close (GstClothSource * source)
{
  GstClothSim *self = GST_CLOTH_SIM (source);

  g_clear_pointer (&self->sim, cloth_sim_free);
  g_clear_pointer (&self->model, cloth_model_free);
  g_clear_pointer (&self->scene, cloth_scene_free);
  g_clear_pointer (&self->positions, g_free);
  g_clear_pointer (&self->places, g_free);
  g_clear_pointer (&self->states, g_free);
}

static gboolean
gst_cloth_sim_open (GstClothSource * source)
{
  GstClothSim *self = GST_CLOTH_SIM (source);
  GstClothSourceStream stream = { self->location, "", NULL, 0, NULL, 0, 0, 1 };
  gsize n;

  if (!self->model_location || !*self->model_location ||
      !self->location || !*self->location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("Set the property “model” "
            "to a model.json and “location” to the take that gives the scene"),
        (NULL));
    return FALSE;
  }
  if (!load_model (self) || !load_scene (self) || !make_sim (self))
    return FALSE;
  n = self->scene->topology->n_vertices;
  self->positions = g_new (gdouble, 3 * n);
  self->places = g_new (gfloat, 3 * n);
  self->states = g_malloc (n);
  memset (self->states, GST_CLOTH_VERTEX_PREDICTED, n);
  stream.topology = self->scene->topology;
  stream.n_frames = self->scene->n_frames;
  stream.times = self->scene->times;
  stream.origin = self->scene->times[0];
  gst_util_double_to_fraction (self->scene->fps, &stream.fps_n, &stream.fps_d);
  return gst_cloth_source_publish (source, &stream);
}

static GstClothMesh *
gst_cloth_sim_make_mesh (GstClothSource * source, guint frame)
{
  GstClothSim *self = GST_CLOTH_SIM (source);
  const ClothScene *scene = self->scene;
  gdouble since_s;

  /* What is past is not kept: begin again. */
  if ((!self->sim || frame < self->sim_frame) && !make_sim (self))
    return NULL;
  /* Frame by frame, also those that are not sent, so that a seek changes no bit. */
  while (self->sim_frame < frame && !gst_cloth_source_is_flushing (source)) {
    cloth_sim_advance (self->sim, scene->times[++self->sim_frame]);
    GST_LOG_OBJECT (self, "simulated frame %u", self->sim_frame);
  }
  if (self->sim_frame < frame)
    return NULL;
  if (cloth_sim_get_state (self->sim, 0, &since_s) != CLOTH_SIM_OK) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED,
        ("The simulation of “%s” blew up "
            "at %.3f s: set its “time_step” below %g s or to 0, or lower its "
            "stiffnesses and damping.stiffness", self->model_location, since_s,
            cloth_sim_get_time_step (self->sim)), (NULL));
    return NULL;
  }
  cloth_sim_get_positions (self->sim, 0, self->positions);
  for (gsize i = 0; i < 3 * (gsize) scene->topology->n_vertices; i++)
    self->places[i] = (gfloat) self->positions[i];
  return gst_cloth_mesh_new (frame, scene->topology->n_vertices, self->places,
      self->states, NULL);
}

static void
gst_cloth_sim_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * spec)
{
  GstClothSim *self = GST_CLOTH_SIM (object);

  GST_OBJECT_LOCK (self);
  if (!gst_cloth_may_change (GST_ELEMENT (self), spec)) {
    GST_OBJECT_UNLOCK (self);
    return;
  }
  switch (id) {
    case PROP_LIVE:            /* the base takes the lock itself */
      break;
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
  if (id == PROP_LIVE)
    gst_base_src_set_live (GST_BASE_SRC (self), g_value_get_boolean (value));
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
  GstClothSourceClass *source_class = GST_CLOTH_SOURCE_CLASS (klass);

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
          "Seed of what is random in effects, such as gusts", 0, G_MAXUINT64, 0,
          flags));
  g_object_class_install_property (object_class, PROP_THREADS,
      g_param_spec_uint ("threads", "Threads",
          "Threads that simulate; 0: one a processor. The result is the same",
          0, 1024, 0, flags));
  gst_element_class_set_static_metadata (element_class, "Cloth simulator",
      "Source", "Simulates a cloth as a mesh stream",
      "The gst-cloth developers");
  source_class->open = gst_cloth_sim_open;
  source_class->close = gst_cloth_sim_close;
  source_class->make_mesh = gst_cloth_sim_make_mesh;
}

static void
gst_cloth_sim_init (GstClothSim * self)
{
}
