/* meshsink: a mesh stream into files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
/**
 * SECTION:element-meshsink
 * @title: meshsink
 * @short_description: writes a mesh stream to files
 *
 * Writes OBJ + PC2 (what Blender and most others read), one PLY file a frame or the
 * folder of a take, which `meshsrc` reads again, and glTF, USD, VTP (ParaView), C3D and
 * CSV for other programs. Frames go to temporary names as they come; at EOS, or when
 * the element is stopped, the files get their names, all together. A flush starts the
 * recording anew, as in filesink.
 *
 * When the program is killed or an error ends the recording, a full disk for example, the
 * frames written so far wait in a hidden folder beside the files, and
 * `gst-cloth-take-1.0 recover` finishes the recording (not glTF, USD and C3D). The error
 * says so, and so does a warning of the next `meshsink` at the same location.
 *
 * Takes, C3D and CSV say which vertices are not seen. In the others such a vertex holds
 * its last place, one never seen so far the mean of its neighbours; `state`, where the
 * format has it, tells them apart.
 *
 * ## Example
 * |[
 * gst-launch-1.0 meshsrc location=take ! meshsink location=cloth.obj
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstmeshsink.h"

#include <gst/cloth/cloth.h>
#include <string.h>

#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"
#include "gst/take/recover.h"
#include "gst/take/take.h"

GST_DEBUG_CATEGORY_STATIC (mesh_sink_debug);
#define GST_CAT_DEFAULT mesh_sink_debug

typedef struct
{
  gchar *location, *mesh_name;
  ClothMeshFormat format;
} Settings;

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"location", "Location",
    "File or folder to write: name.obj (with name.pc2 beside it), name.ply "
    "(name_00000.ply and so on), name.glb, name.usda, name.pvd (with "
    "name_00000.vtp and so on), name.c3d, name.csv or the folder of a take",
    G_TYPE_STRING, SETTING (location), GST_PARAM_MUTABLE_READY},
  {"format", "Format", "Format of the files",
    G_TYPE_ENUM, SETTING (format), GST_PARAM_MUTABLE_READY, 0, 0,
    "GstMeshFormat", gst_mesh_format_values},
  {"mesh-name", "Mesh name",
    "Name of the object or take in the files; by default, that of the file",
    G_TYPE_STRING, SETTING (mesh_name), GST_PARAM_MUTABLE_READY},
};
/* *INDENT-ON* */

static const Settings default_settings = { NULL, NULL, CLOTH_MESH_FORMAT_AUTO };

struct _GstMeshSink
{
  GstBaseSink parent;

  /* with the object lock */
  Settings settings;

  /* streaming thread */
  ClothTopology *topology;
  gint fps_n, fps_d;
  ClothMeshWriter *writer;      /* NULL before the first frame and after EOS */
  gboolean failed;              /* until the next flush or start */
};

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

G_DEFINE_TYPE (GstMeshSink, gst_mesh_sink, GST_TYPE_BASE_SINK);
GST_ELEMENT_REGISTER_DEFINE (meshsink, "meshsink", GST_RANK_NONE,
    GST_TYPE_MESH_SINK);

/* Returns: (transfer full): the command that finishes what is left at the location */
static gchar *
recover_command (GstMeshSink * self)
{
  g_autofree gchar *name = cloth_recover_get_name (self->settings.location,
      self->settings.format);
  g_autofree gchar *path = *name == '-' ? g_strconcat ("./", name, NULL) :
      g_strdup (name);
  g_autofree gchar *quoted = g_shell_quote (path);

  return g_strdup_printf ("gst-cloth-take-1.0 recover %s",
      strpbrk (path, " \t\n\\\"'`$&|;<>()*?[]{}!#~") ? quoted : path);
}

/* What was recorded is not lost.
 *
 * Returns: (transfer full) (nullable): what is to be told of it */
static gchar *
stop_recording (GstMeshSink * self)
{
  g_autofree gchar *command = recover_command (self);
  guint64 n_frames;
  gchar *kept = NULL;

  self->failed = TRUE;
  if (!self->writer)
    return NULL;
  n_frames = cloth_mesh_writer_get_n_frames (self->writer);
  if (cloth_mesh_writer_leave (self->writer))
    kept =
        g_strdup_printf ("%" G_GUINT64_FORMAT
        " frame%s kept: “%s” finishes " "the recording", n_frames,
        n_frames == 1 ? " is" : "s are", command);
  g_clear_pointer (&self->writer, cloth_mesh_writer_free);
  return kept;
}

static void
fail (GstMeshSink * self, const gchar * doing, const GError * error)
{
  g_autofree gchar *kept = stop_recording (self);
  g_autoptr (GError) whole = g_error_copy (error);

  if (kept) {
    g_free (whole->message);
    whole->message = g_strdup_printf ("%s. %s", error->message, kept);
  }
  gst_mesh_post_error (GST_ELEMENT (self), doing, self->settings.location, TRUE,
      whole);
}

/* After an error that was posted already. */
static void
stop_and_tell (GstMeshSink * self)
{
  g_autofree gchar *kept = stop_recording (self);

  if (kept)
    GST_ELEMENT_WARNING (self, RESOURCE, FAILED, ("%s", kept),
        ("What ended the recording is in the error before this."));
}

static gboolean
gst_mesh_sink_set_caps (GstBaseSink * sink, GstCaps * caps)
{
  GstMeshSink *self = GST_MESH_SINK (sink);
  g_autoptr (GstClothTopology) parsed = NULL;
  g_autoptr (ClothTopology) topology = NULL;
  gint fps_n = 0, fps_d = 1;

  /* Caps that were refused come again with all that follows: one message is enough. */
  if (self->failed)
    return FALSE;
  parsed = gst_cloth_read_topology (GST_ELEMENT (self), caps);
  if (!parsed) {
    stop_and_tell (self);
    return FALSE;
  }
  topology = gst_mesh_copy_topology (parsed);
  gst_structure_get_fraction (gst_caps_get_structure (caps, 0), "framerate",
      &fps_n, &fps_d);
  if (self->writer && (!cloth_topology_equal (topology, self->topology) ||
          fps_n != self->fps_n || fps_d != self->fps_d)) {
    g_autofree gchar *kept = stop_recording (self);

    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The mesh or its frame rate changed in the middle of the recording; "
            "stop and record to another location. %s", kept ? kept : ""),
        ("%" GST_PTR_FORMAT, caps));
    return FALSE;
  }
  cloth_topology_free (self->topology);
  self->topology = g_steal_pointer (&topology);
  self->fps_n = fps_n;
  self->fps_d = fps_d;
  return TRUE;
}

static ClothMeshFormat
get_format (GstMeshSink * self)
{
  return self->settings.format == CLOTH_MESH_FORMAT_AUTO ?
      cloth_mesh_format_guess (self->settings.location) : self->settings.format;
}

/* A stream of meshes has no clamps, obstacles and seams; a take that had them loses them. */
static void
warn_of_scene (GstMeshSink * self)
{
  const gchar *location = self->settings.location;
  g_autoptr (ClothTake) take = get_format (self) == CLOTH_MESH_FORMAT_TAKE ?
      cloth_take_open (location, NULL) : NULL;
  const ClothTakeInfo *info = take ? cloth_take_get_info (take) : NULL;

  if (info && info->held->len + info->obstacles->len + info->seams->len > 0)
    GST_ELEMENT_WARNING (self, RESOURCE, FAILED,
        ("The take in “%s” has clamps, obstacles or seams; the recording that "
            "replaces it has none.", location),
        ("Copy it before the recording ends, or record to another location."));
}

/* What is read again without times moves at another speed. */
static void
warn_of_times (GstMeshSink * self)
{
  const ClothMeshFormat format = get_format (self);

  if (self->fps_n <= 0 && (format == CLOTH_MESH_FORMAT_OBJ_PC2
          || format == CLOTH_MESH_FORMAT_PLY))
    GST_ELEMENT_WARNING (self, RESOURCE, FAILED,
        ("“%s” counts frames, and those that come have no frame rate: when "
            "they came is not written.", self->settings.location),
        ("Takes, VTP, CSV, glTF and USD keep times."));
}

static gboolean
open_writer (GstMeshSink * self)
{
  g_autoptr (GError) error = NULL;

  warn_of_scene (self);
  self->writer =
      cloth_mesh_writer_new (self->settings.location, self->settings.format,
      self->settings.mesh_name, self->topology, self->fps_n, self->fps_d,
      &error);
  if (!self->writer)
    fail (self, "write", error);
  return self->writer != NULL;
}

/* Seconds of running time; frames without a time stamp follow the frame rate. */
static gboolean
frame_time (GstMeshSink * self, GstBuffer * buffer, gdouble * time_s)
{
  const GstSegment *segment = &GST_BASE_SINK (self)->segment;
  guint64 n_frames = cloth_mesh_writer_get_n_frames (self->writer);
  GstClockTime time = GST_CLOCK_TIME_NONE;

  if (segment->format == GST_FORMAT_TIME && GST_BUFFER_PTS_IS_VALID (buffer))
    time = gst_segment_to_running_time (segment, GST_FORMAT_TIME,
        GST_BUFFER_PTS (buffer));
  if (GST_CLOCK_TIME_IS_VALID (time))
    *time_s = (gdouble) time / GST_SECOND;
  else if (self->fps_n > 0)
    *time_s = (gdouble) n_frames *self->fps_d / self->fps_n;
  else
    return FALSE;
  return TRUE;
}

static GstFlowReturn
gst_mesh_sink_render (GstBaseSink * sink, GstBuffer * buffer)
{
  GstMeshSink *self = GST_MESH_SINK (sink);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  ClothMeshFrame frame;
  gdouble time_s;

  if (self->failed)
    return GST_FLOW_ERROR;
  if (!self->topology)
    return GST_FLOW_NOT_NEGOTIATED;
  mesh = gst_cloth_read_mesh (GST_ELEMENT (self), buffer,
      self->topology->n_vertices);
  if (!mesh) {
    stop_and_tell (self);
    return GST_FLOW_ERROR;
  }
  if (!self->writer && !open_writer (self))
    return GST_FLOW_ERROR;
  if (!frame_time (self, buffer, &time_s)) {
    g_set_error (&error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "a frame has neither a time stamp nor a frame rate");
    fail (self, "write", error);
    return GST_FLOW_ERROR;
  }
  frame.positions = gst_cloth_mesh_get_positions (mesh, NULL);
  frame.states = gst_cloth_mesh_get_states (mesh, NULL);
  frame.covariances = gst_cloth_mesh_get_covariances (mesh, NULL);
  if (cloth_mesh_writer_get_n_frames (self->writer) == 1)
    warn_of_times (self);
  if (!cloth_mesh_writer_append (self->writer, time_s, &frame, &error)) {
    fail (self, "write", error);
    return GST_FLOW_ERROR;
  }
  return GST_FLOW_OK;
}

static gboolean
finish (GstMeshSink * self)
{
  g_autoptr (GError) error = NULL;

  if (!self->writer)
    return TRUE;
  if (!cloth_mesh_writer_close (self->writer, &error)) {
    fail (self, "write", error);
    return FALSE;
  }
  GST_INFO_OBJECT (self, "%" G_GUINT64_FORMAT " frames written to %s",
      cloth_mesh_writer_get_n_frames (self->writer), self->settings.location);
  g_clear_pointer (&self->writer, cloth_mesh_writer_free);
  return TRUE;
}

static gboolean
gst_mesh_sink_event (GstBaseSink * sink, GstEvent * event)
{
  GstMeshSink *self = GST_MESH_SINK (sink);

  switch (GST_EVENT_TYPE (event)) {
    case GST_EVENT_EOS:
      if (!self->writer && !self->failed) {
        self->failed = TRUE;
        GST_ELEMENT_ERROR (self, STREAM, FAILED,
            ("The stream ended without a single mesh: nothing was written."),
            ("See the warnings before this one: what makes the meshes says there "
                "what it lacks."));
      }
      if (self->failed || !finish (self)) {
        gst_event_unref (event);
        return FALSE;
      }
      break;
    case GST_EVENT_FLUSH_STOP:
      g_clear_pointer (&self->writer, cloth_mesh_writer_free);
      self->failed = FALSE;
      break;
    default:
      break;
  }
  return GST_BASE_SINK_CLASS (gst_mesh_sink_parent_class)->event (sink, event);
}

/* That something waits is no error. */
static void
warn_of_remains (GstMeshSink * self)
{
  const gchar *location = self->settings.location;
  g_autofree gchar *command = recover_command (self);

  switch (cloth_recover_look (location, self->settings.format)) {
    case CLOTH_LEFT_FRAMES:
      GST_ELEMENT_WARNING (self, RESOURCE, FAILED,
          ("A recording to “%s” was interrupted: “%s” finishes it, when this "
              "one is moved away", location, command),
          ("Or record to another location, and finish that one first."));
      break;
    case CLOTH_LEFT_LOST:
      GST_ELEMENT_WARNING (self, RESOURCE, FAILED,
          ("A recording to “%s” was interrupted and can't be finished: its "
              "remains go when this one is whole", location),
          ("Takes, OBJ, PLY, VTP and CSV can be finished after a crash: record "
              "to one of these."));
      break;
    default:
      break;
  }
}

static gboolean
check_settings (GstMeshSink * self)
{
  g_autoptr (GError) error = NULL;

  if (!self->settings.location || !*self->settings.location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("No location given: nothing can be written."),
        ("Set the property location to a file or folder, as cloth.obj."));
    return FALSE;
  }
  if (cloth_mesh_format_check (self->settings.location, self->settings.format,
          &error))
    return TRUE;
  gst_mesh_post_error (GST_ELEMENT (self), "write", self->settings.location,
      TRUE, error);
  return FALSE;
}

/* What is wrong is said here: when the base starts, the location may still change. */
static GstStateChangeReturn
gst_mesh_sink_change_state (GstElement * element, GstStateChange transition)
{
  GstMeshSink *self = GST_MESH_SINK (element);

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED) {
    if (!check_settings (self))
      return GST_STATE_CHANGE_FAILURE;
    warn_of_remains (self);
    self->failed = FALSE;
  }
  return GST_ELEMENT_CLASS (gst_mesh_sink_parent_class)->change_state (element,
      transition);
}

static gboolean
gst_mesh_sink_stop (GstBaseSink * sink)
{
  GstMeshSink *self = GST_MESH_SINK (sink);
  gboolean done = finish (self);

  g_clear_pointer (&self->topology, cloth_topology_free);
  return done;
}

static void
gst_mesh_sink_finalize (GObject * object)
{
  GstMeshSink *self = GST_MESH_SINK (object);

  cloth_mesh_writer_free (self->writer);
  cloth_topology_free (self->topology);
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  G_OBJECT_CLASS (gst_mesh_sink_parent_class)->finalize (object);
}

static void
gst_mesh_sink_class_init (GstMeshSinkClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseSinkClass *sink_class = GST_BASE_SINK_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (mesh_sink_debug, "meshsink", 0,
      "mesh stream into files");
  object_class->finalize = gst_mesh_sink_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &default_settings,
      G_STRUCT_OFFSET (GstMeshSink, settings));
  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_set_static_metadata (element_class, "Mesh file sink",
      "Sink/File",
      "Writes a mesh stream to OBJ + PC2, PLY, glTF, USD, VTP, C3D, CSV or a take",
      "The gst-cloth developers");
  element_class->change_state = gst_mesh_sink_change_state;
  sink_class->set_caps = gst_mesh_sink_set_caps;
  sink_class->render = gst_mesh_sink_render;
  sink_class->event = gst_mesh_sink_event;
  sink_class->stop = gst_mesh_sink_stop;
}

static void
gst_mesh_sink_init (GstMeshSink * self)
{
  self->settings = default_settings;
  gst_base_sink_set_sync (GST_BASE_SINK (self), FALSE);
}
