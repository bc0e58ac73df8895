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

#include "elements/gstclothproperties.h"
#include "elements/gstmeshformat.h"
#include "gst/sim/sim.h"

GST_DEBUG_CATEGORY_STATIC (cloth_sim_debug);
#define GST_CAT_DEFAULT cloth_sim_debug

typedef struct
{
  gchar *model, *location;
  gboolean live;
  guint64 seed;
  guint threads;
} Settings;

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"model", "Model", "What the cloth is like: a model.json",
    G_TYPE_STRING, SETTING (model), GST_PARAM_MUTABLE_READY},
  {"location", "Location",
    "Folder of the take that gives the scene: mesh, clamps, obstacles and "
    "times",
    G_TYPE_STRING, SETTING (location), GST_PARAM_MUTABLE_READY},
  {"live", "Live",
    "Send frames at the pace of the clock, not as fast as they come",
    G_TYPE_BOOLEAN, SETTING (live), GST_PARAM_MUTABLE_READY},
  {"seed", "Seed", "Seed of what is random in effects, such as gusts",
    G_TYPE_UINT64, SETTING (seed), GST_PARAM_MUTABLE_READY},
  {"threads", "Threads",
    "Threads that simulate; 0: one a processor. The result is the same",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_READY, 0, 1024},
};
/* *INDENT-ON* */

static const Settings default_settings = { NULL, NULL, FALSE, 0, 0 };

struct _GstClothSim
{
  GstClothSource parent;

  /* with the object lock */
  Settings settings;

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
  const ClothSimOptions options =
      { FALSE, self->settings.threads, CLOTH_SIMD_BEST,
    self->settings.seed
  };
  const ClothModel *models[1] = { self->model };
  g_autoptr (GError) error = NULL;

  g_clear_pointer (&self->sim, cloth_sim_free);
  self->sim = cloth_sim_new (self->scene, models, 1, &options, &error);
  self->sim_frame = 0;
  if (self->sim)
    return TRUE;
  GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("Cannot simulate “%s” in the "
          "scene “%s”: %s", self->settings.model, self->settings.location,
          error->message), (NULL));
  return FALSE;
}

static gboolean
load_scene (GstClothSim * self)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTake) take =
      cloth_take_open (self->settings.location, &error);

  if (take)
    self->scene = cloth_scene_new_from_take (take, &error);
  if (self->scene && cloth_scene_check_paths (self->scene, &error))
    return TRUE;
  gst_mesh_post_error (GST_ELEMENT (self), "read the scene",
      self->settings.location, FALSE, error);
  return FALSE;
}

static gboolean
load_model (GstClothSim * self)
{
  g_autoptr (GError) error = NULL;

  self->model = cloth_model_load (self->settings.model, &error);
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
  GstClothSourceStream stream =
      { self->settings.location, "", NULL, 0, NULL, 0, 0, 1 };
  gsize n;

  if (!self->settings.model || !*self->settings.model ||
      !self->settings.location || !*self->settings.location) {
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
            "stiffnesses and damping.stiffness", self->settings.model, since_s,
            cloth_sim_get_time_step (self->sim)), (NULL));
    return NULL;
  }
  cloth_sim_get_positions (self->sim, 0, self->positions);
  for (gsize i = 0; i < 3 * (gsize) scene->topology->n_vertices; i++)
    self->places[i] = (gfloat) self->positions[i];
  return gst_cloth_mesh_new (frame, scene->topology->n_vertices, self->places,
      self->states, NULL);
}

/* What "live" says is the base's to act on. */
static void
gst_cloth_sim_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * spec)
{
  GstClothSim *self = GST_CLOTH_SIM (object);
  gboolean live;

  gst_cloth_set_property (object, id, value, spec);
  GST_OBJECT_LOCK (self);
  live = self->settings.live;
  GST_OBJECT_UNLOCK (self);
  gst_base_src_set_live (GST_BASE_SRC (self), live);
}

static void
gst_cloth_sim_finalize (GObject * object)
{
  GstClothSim *self = GST_CLOTH_SIM (object);

  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  G_OBJECT_CLASS (gst_cloth_sim_parent_class)->finalize (object);
}

static void
gst_cloth_sim_class_init (GstClothSimClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothSourceClass *source_class = GST_CLOTH_SOURCE_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (cloth_sim_debug, "clothsim", 0, "simulated cloth");
  object_class->finalize = gst_cloth_sim_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &default_settings,
      G_STRUCT_OFFSET (GstClothSim, settings));
  object_class->set_property = gst_cloth_sim_set_property;
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
  self->settings = default_settings;
}
