/* clothfit: a simulated cloth that follows a stream, whole where the stream has holes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
/**
 * SECTION:element-clothfit
 * @title: clothfit
 * @short_description: fits a simulated cloth to a stream of meshes or observations
 *
 * Analysis by synthesis as it is filmed: simulates the cloth of `model` in the scene of the take
 * `location`, draws it by weak springs to what was seen, and sends the simulated cloth. So a mesh
 * with holes, or what a single `camera` of `rig` saw, becomes a whole mesh: where nothing was seen the
 * cloth is where its weight, its stiffness and the rest of it let it be. Vertices that were seen are
 * marked as measured, the others as predicted.
 *
 * The take says where the cloth starts, by one frame of positions at least, else flat below its clamps, and has the
 * whole path of each clamp.
 *
 * The stream time is the scene's: what comes before its first or after its last frame is left
 * out. A frame needs the three frames behind it, so buffers leave that much later. What one camera saw
 * draws the cloth across its rays only; along them the simulation is believed. Join two or more cameras
 * by `triangulate`. Its meshes carry what each camera saw (#GstClothView), and when `rig` has these cameras,
 * what one of them alone saw of a vertex that the mesh has not draws it likewise.
 *
 * ## Messages
 * `clothfit/score`, for each window: `time` and `duration` (nanoseconds of stream time), `rms`
 * (double, metres: how far the cloth is from what was seen at the window's end when it starts where the
 * springs have brought it and runs free, RMS over the window), `coverage` (double: the share of the
 * vertices that were seen). Springs can pull any model anywhere; this tells whether it moves as the
 * filmed cloth does.
 *
 * `clothfit/fitted`, with `fitted`, at the end and before EOS goes on: `numbers` (array of structures with
 * `name` (string), `before`, `value`, `sigma` (double, the standard deviation), `finer` and `finer-sigma` (double:
 * what it is on a mesh twice as fine, and the standard deviation of that as a number of the cloth; NaN: not known)
 * and `at-end` (boolean: it came to an end of its range)), and how far the cloth let go in windows was off before and after
 * (double, metres): `windows-before`, `windows-after`. The whole stream is fitted then, which takes its
 * time: its meshes, or, when `rig` has their cameras, what these saw. `gst-cloth-fit-1.0` does the same for
 * takes, and tells more.
 *
 * After a flush, or when a new segment goes back in time, it starts anew.
 *
 * ## Example
 * |[
 * gst-launch-1.0 -m meshsrc location=take ! clothfit model=model.json location=take \
 *     ! meshsink location=whole.take
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothfit.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <math.h>
#include <unistd.h>

#include "elements/gstclothproperties.h"
#include "gst/cloth-io/points.h"
#include "gst/file/file.h"
#include "gst/fit/error.h"
#include "gst/fit/synthesis/synthesis.h"

GST_DEBUG_CATEGORY_STATIC (cloth_fit_debug);
#define GST_CAT_DEFAULT cloth_fit_debug

typedef struct
{
  gdouble gain;
  gchar *fitted;
} Settings;

struct _GstClothFit
{
  GstClothFollow parent;

  /* with the object lock */
  Settings settings;

  /* streaming thread */
  GstFollowRecord *record;      /* of meshes that are to be fitted */
  ClothObservations *observations;      /* of pictures that are */
  guint32 *vertices;            /* of a picture: what it showed, as lists */
  gdouble *px, *covariances;
  gfloat *positions;            /* of the mesh that leaves */
  guint8 *states;
};

static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

GST_ELEMENT_REGISTER_DEFINE_WITH_CODE (clothfit, "clothfit", GST_RANK_NONE,
    GST_TYPE_CLOTH_FIT, GST_DEBUG_CATEGORY_INIT (cloth_fit_debug,
        "clothfit", 0, "simulated cloth fitted to a stream"));

G_DEFINE_TYPE (GstClothFit, gst_cloth_fit, GST_TYPE_CLOTH_FOLLOW);

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"gain", "Gain",
    "Strength of the springs that draw the cloth to what was seen, 1/s²: it follows what changes "
    "more slowly than its square root",
    G_TYPE_DOUBLE, SETTING (gain), GST_PARAM_MUTABLE_READY, 1, 1e5},
  {"fitted", "Fitted",
    "File (model.json) to write the model to with its free numbers fitted to the stream, at its "
    "end; by default they are not fitted",
    G_TYPE_STRING, SETTING (fitted), GST_PARAM_MUTABLE_READY},
};
/* *INDENT-ON* */

static const Settings defaults = {.gain = 1600. };

/* ---- the stream ---- */

/* Better now than after the film. */
static gboolean
gst_cloth_fit_open (GstClothFollow * follow)
{
  const gchar *fitted = GST_CLOTH_FIT (follow)->settings.fitted;
  g_autofree gchar *parent = NULL;

  if (!fitted)
    return TRUE;
  parent = g_path_get_dirname (fitted);
  if (g_file_test (fitted, G_FILE_TEST_IS_DIR)) {
    GST_ELEMENT_ERROR (follow, RESOURCE, OPEN_WRITE,
        ("Can't write the fitted model: %s is a folder", fitted),
        ("Set fitted= to a file."));
    return FALSE;
  }
  if (g_access (parent, W_OK) != 0) {
    GST_ELEMENT_ERROR (follow, RESOURCE, OPEN_WRITE,
        ("Can't write the fitted model: %s: %s", parent, g_strerror (errno)),
        ("Set fitted= to a file in a folder that can be written."));
    return FALSE;
  }
  if (gst_cloth_follow_get_inputs (follow)->model->free->len > 0)
    return TRUE;
  GST_ELEMENT_ERROR (follow, RESOURCE, SETTINGS,
      ("The model has no free numbers, and fitted= wants them fitted."),
      ("List what to fit under “free” in %s, for instance {\"name\": "
          "\"stretch.warp\", \"range\": [10, 1000]}.",
          gst_cloth_follow_get_settings (follow)->model));
  return FALSE;
}

static void
gst_cloth_fit_restart (GstClothFollow * follow)
{
  GstClothFit *self = GST_CLOTH_FIT (follow);

  g_clear_pointer (&self->record, gst_follow_record_free);
  g_clear_pointer (&self->observations, cloth_observations_free);
}

static void
gst_cloth_fit_close (GstClothFollow * follow)
{
  GstClothFit *self = GST_CLOTH_FIT (follow);

  gst_cloth_fit_restart (follow);
  g_clear_pointer (&self->vertices, g_free);
  g_clear_pointer (&self->px, g_free);
  g_clear_pointer (&self->covariances, g_free);
  g_clear_pointer (&self->positions, g_free);
  g_clear_pointer (&self->states, g_free);
}

static GstCaps *
gst_cloth_fit_make_caps (GstClothFollow * follow, const GstCaps * caps)
{
  const ClothTopology *t =
      gst_cloth_follow_get_inputs (follow)->scene->topology;
  const GstStructure *s = gst_caps_get_structure (caps, 0);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) topology = gst_cloth_topology_new (t->n_vertices,
      t->columns, t->rows, t->uv, t->faces, t->n_faces, &error);
  gint fps_n = 0, fps_d = 1;

  if (!topology) {
    GST_ELEMENT_ERROR (follow, STREAM, FORMAT,
        ("The mesh of the scene can't be sent: %s", error->message),
        ("location=%s", gst_cloth_follow_get_settings (follow)->location));
    return NULL;
  }
  gst_structure_get_fraction (s, "framerate", &fps_n, &fps_d);
  return gst_cloth_topology_to_caps (topology, fps_n, fps_d);
}

/* ---- frames ---- */

/* One camera of its own, with all that it saw. */
static gboolean
gst_cloth_fit_came (GstClothFollow * follow, gdouble time,
    const ClothCamera * camera, const ClothTriangulateView * points)
{
  GstClothFit *self = GST_CLOTH_FIT (follow);
  const guint n =
      gst_cloth_follow_get_inputs (follow)->scene->topology->n_vertices;
  g_autoptr (GError) error = NULL;
  guint seen;

  if (!self->settings.fitted)
    return TRUE;
  if (!self->observations) {
    ClothRig *rig = cloth_rig_new (1);

    cloth_camera_copy (&rig->cameras[0], camera);
    self->observations = cloth_observations_new (rig, n);
  }
  if (!self->vertices) {
    self->vertices = g_new (guint32, n);
    self->px = g_new (gdouble, 2 * (gsize) n);
    self->covariances = g_new (gdouble, 3 * (gsize) n);
  }
  seen = gst_cloth_io_points_list (points, n, self->vertices, self->px,
      self->covariances);
  if (cloth_observations_add (self->observations, 0, time + camera->offset_s,
          seen, self->vertices, self->px, self->covariances, &error))
    return TRUE;
  GST_ELEMENT_ERROR (self, STREAM, FORMAT,
      ("A picture can't be fitted: %s", error->message), (NULL));
  return FALSE;
}

static gboolean
gst_cloth_fit_record (GstClothFollow * follow,
    const GstClothFollowFrame * frame)
{
  GstClothFit *self = GST_CLOTH_FIT (follow);

  return !self->settings.fitted || gst_cloth_follow_has_rays (follow)
      || gst_cloth_follow_keep (follow, &self->record, frame, "fit");
}

/* The simulated cloth in place of what was seen. */
static GstBuffer *
gst_cloth_fit_leave (GstClothFollow * follow, GstBuffer * buffer,
    const GstClothFollowFrame * frame)
{
  GstClothFit *self = GST_CLOTH_FIT (follow);
  const guint n = frame->n_vertices;
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *out;

  if (!self->positions) {
    self->positions = g_new (gfloat, 3 * (gsize) n);
    self->states = g_malloc (n);
  }
  cloth_observer_get_drawn (gst_cloth_follow_get_observer (follow),
      self->positions);
  for (guint i = 0; i < n; i++)
    self->states[i] = isnan (frame->residuals[3 * i]) ?
        GST_CLOTH_VERTEX_PREDICTED : GST_CLOTH_VERTEX_MEASURED;
  mesh = gst_cloth_mesh_new (frame->sequence, n, self->positions, self->states,
      NULL);
  out = gst_cloth_mesh_to_buffer (mesh);
  gst_buffer_copy_into (out, buffer, GST_BUFFER_COPY_TIMESTAMPS |
      GST_BUFFER_COPY_FLAGS, 0, -1);
  gst_buffer_unref (buffer);
  /* the mesh is of the rig's time */
  if (GST_BUFFER_PTS_IS_VALID (out) && frame->offset_s != 0)
    GST_BUFFER_PTS (out) = (GstClockTime) MAX (0, GST_CLOCK_DIFF ((gint64)
            (frame->offset_s * 1e9), (gint64) GST_BUFFER_PTS (out)));
  return out;
}

/* ---- the end ---- */

static gboolean
go_on (gpointer data, gdouble share)
{
  return !gst_cloth_follow_is_cancelled (data);
}

static void
post_fitted (GstClothFit * self, const ClothSynthesis * s)
{
  GstStructure *message = gst_structure_new ("clothfit/fitted",
      "windows-before", G_TYPE_DOUBLE, s->takes[0].before.windows,
      "windows-after", G_TYPE_DOUBLE, s->takes[0].after.windows, NULL);
  GValue numbers = G_VALUE_INIT;

  g_value_init (&numbers, GST_TYPE_ARRAY);
  for (guint i = 0; i < s->numbers->len; i++) {
    const ClothSynthesisNumber *number =
        &g_array_index (s->numbers, ClothSynthesisNumber, i);
    GValue value = G_VALUE_INIT;

    g_value_init (&value, GST_TYPE_STRUCTURE);
    g_value_take_boxed (&value, gst_structure_new ("number",
            "name", G_TYPE_STRING, number->name,
            "before", G_TYPE_DOUBLE, number->before,
            "value", G_TYPE_DOUBLE, number->value,
            "sigma", G_TYPE_DOUBLE, number->sigma,
            "finer", G_TYPE_DOUBLE, number->finer,
            "finer-sigma", G_TYPE_DOUBLE, number->finer_sigma,
            "at-end", G_TYPE_BOOLEAN, number->at_end, NULL));
    gst_value_array_append_and_take_value (&numbers, &value);
  }
  gst_structure_take_value (message, "numbers", &numbers);
  gst_element_post_message (GST_ELEMENT (self),
      gst_message_new_element (GST_OBJECT (self), message));
}

static ClothSynthesis *
fit (GstClothFit * self, GError ** error)
{
  GstClothFollow *follow = GST_CLOTH_FOLLOW (self);
  const GstFollowInputs *inputs = gst_cloth_follow_get_inputs (follow);
  const GstFollowSettings *settings = gst_cloth_follow_get_settings (follow);
  g_autoptr (GstFollowRecord) record = g_steal_pointer (&self->record);
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (ClothObservations) seen = NULL;
  ClothSynthesisInput input = { inputs->take, self->observations };
  ClothSynthesisOptions options;

  if (record) {
    take = gst_follow_record_finish (record, &seen, error);
    if (!take)
      return NULL;
    input = (ClothSynthesisInput) {
    take, seen};
  } else if (!self->observations) {
    /* the take of location is the scene; what it has of positions is another recording */
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "no picture of the scene's time showed the cloth");
    return NULL;
  }
  cloth_synthesis_options_init (&options);
  options.gain = self->settings.gain;
  options.window_s = settings->window;
  options.rollout.seed = settings->seed;
  options.rollout.threads = settings->threads;
  options.rollout.progress = go_on;
  options.rollout.data = self;
  return cloth_synthesis_fit (&input, 1, inputs->model, &options, error);
}

static void
gst_cloth_fit_finish (GstClothFollow * follow)
{
  GstClothFit *self = GST_CLOTH_FIT (follow);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSynthesis) s = NULL;
  g_autofree gchar *json = NULL;

  if (!self->settings.fitted)
    return;
  s = fit (self, &error);
  if (!s) {
    if (!gst_cloth_follow_is_cancelled (follow))
      GST_ELEMENT_ERROR (self, STREAM, FAILED, ("Can't fit the model: %s",
              error->message), (NULL));
    return;
  }
  json = cloth_model_to_json (s->model);
  if (cloth_file_write_text (self->settings.fitted, json, &error))
    post_fitted (self, s);
  else
    GST_ELEMENT_ERROR (self, RESOURCE, WRITE,
        ("Can't write the fitted model: %s", error->message),
        ("Set fitted= to a file in a folder that can be written."));
}

static gdouble
gst_cloth_fit_get_gain (GstClothFollow * follow)
{
  return GST_CLOTH_FIT (follow)->settings.gain;
}

/* ---- GObject ---- */

static void
gst_cloth_fit_finalize (GObject * object)
{
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &GST_CLOTH_FIT (object)->settings);
  G_OBJECT_CLASS (gst_cloth_fit_parent_class)->finalize (object);
}

static void
gst_cloth_fit_class_init (GstClothFitClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothFollowClass *follow_class = GST_CLOTH_FOLLOW_CLASS (klass);

  object_class->finalize = gst_cloth_fit_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstClothFit,
          settings));
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Cloth fit",
      "Filter/Analyzer",
      "Fits a simulated cloth to a stream of meshes or observations",
      "The gst-cloth developers");
  follow_class->open = gst_cloth_fit_open;
  follow_class->close = gst_cloth_fit_close;
  follow_class->restart = gst_cloth_fit_restart;
  follow_class->came = gst_cloth_fit_came;
  follow_class->make_caps = gst_cloth_fit_make_caps;
  follow_class->record = gst_cloth_fit_record;
  follow_class->leave = gst_cloth_fit_leave;
  follow_class->finish = gst_cloth_fit_finish;
  follow_class->get_gain = gst_cloth_fit_get_gain;
  follow_class->damping_ratio = CLOTH_ROLLOUT_ZETA;
  follow_class->score = "clothfit/score";
}

static void
gst_cloth_fit_init (GstClothFit * self)
{
  self->settings = defaults;
}
