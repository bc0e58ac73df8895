/* meshsrc: files into a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
/**
 * SECTION:element-meshsrc
 * @title: meshsrc
 * @short_description: reads a mesh stream from files
 *
 * Reads OBJ + PC2, a PLY sequence or the folder of a take. Frame i has the time
 * i / fps, or what a take's times.npy says. The frame rate is that of the property,
 * else of the files, else 30/1. Seekable by time in both directions, so that segment
 * seeks loop.
 *
 * ## Example
 * |[
 * gst-launch-1.0 meshsrc location=take ! meshsink location=cloth.ply
 * ]|
 *
 * Since: 0.1
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstmeshsrc.h"

#include <gst/cloth/cloth.h>

#include "elements/gstmeshformat.h"

GST_DEBUG_CATEGORY_STATIC (mesh_src_debug);
#define GST_CAT_DEFAULT mesh_src_debug

#define FALLBACK_FPS 30
/* Whole nanoseconds that a double still counts. */
#define MAX_TIME_S 4e6

enum
{
  PROP_0,
  PROP_LOCATION,
  PROP_FORMAT,
  PROP_FPS
};

struct _GstMeshSrc
{
  GstPushSrc parent;

  /* with the object lock */
  gchar *location;
  ClothMeshFormat format;
  gint wanted_n, wanted_d;      /* 0/1: what the files say */

  /* from start to stop */
  ClothMeshReader *reader;
  GstCaps *caps;
  const gdouble *times;         /* NULL: fps says */
  gint fps_n, fps_d;
  gint64 n_frames;
  gint64 next;                  /* frame; n_frames or -1 behind the last one */
};

static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

G_DEFINE_TYPE (GstMeshSrc, gst_mesh_src, GST_TYPE_PUSH_SRC);
GST_ELEMENT_REGISTER_DEFINE (meshsrc, "meshsrc", GST_RANK_NONE,
    GST_TYPE_MESH_SRC);

/* Time of a frame; of n_frames, the end of the sequence. */
static GstClockTime
frame_time (GstMeshSrc * self, gint64 frame)
{
  GstClockTime last;

  if (!self->times)
    return gst_util_uint64_scale ((guint64) frame,
        (guint64) self->fps_d * GST_SECOND, (guint64) self->fps_n);
  if (frame < self->n_frames)
    return (GstClockTime) (self->times[frame] * GST_SECOND + 0.5);
  /* The last frame lasts as long as the one before. */
  last = frame_time (self, self->n_frames - 1);
  if (self->n_frames > 1)
    return 2 * last - frame_time (self, self->n_frames - 2);
  return last + (self->fps_n > 0 ? gst_util_uint64_scale_int (GST_SECOND,
          self->fps_d, self->fps_n) : GST_SECOND / FALLBACK_FPS);
}

/* The number of frames that begin before @time. */
static gint64
frames_before (GstMeshSrc * self, GstClockTime time)
{
  gint64 low = 0, high = self->n_frames;

  while (low < high) {
    gint64 middle = (low + high) / 2;

    if (frame_time (self, middle) < time)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The frame that is shown at @time; n_frames behind the end. */
static gint64
frame_at (GstMeshSrc * self, GstClockTime time)
{
  if (time >= frame_time (self, self->n_frames))
    return self->n_frames;
  return MAX (frames_before (self, time + 1) - 1, 0);
}

static gboolean
check_times (GstMeshSrc * self)
{
  for (gint64 i = 0; self->times && i < self->n_frames; i++) {
    if (self->times[i] < 0 || self->times[i] > MAX_TIME_S ||
        (i > 0 && frame_time (self, i) <= frame_time (self, i - 1))) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("The time of frame %" G_GINT64_FORMAT
              " in “%s” cannot be played: "
              "times must start at 0 or later, rise by a nanosecond at least and "
              "stay below %g s; or set “fps” to play at a rate of your own",
              i, self->location, MAX_TIME_S), (NULL));
      return FALSE;
    }
  }
  return TRUE;
}

static void
choose_rate (GstMeshSrc * self)
{
  gdouble fps = cloth_mesh_reader_get_fps (self->reader);

  self->times = cloth_mesh_reader_get_times (self->reader);
  self->fps_n = 0;
  self->fps_d = 1;
  if (self->wanted_n > 0) {
    self->fps_n = self->wanted_n;
    self->fps_d = self->wanted_d;
    self->times = NULL;
  } else if (fps > 0) {
    gst_util_double_to_fraction (fps, &self->fps_n, &self->fps_d);
  }
  if (self->fps_n <= 0 && !self->times) {
    GST_INFO_OBJECT (self, "the files give no frame rate, %d/1 is taken",
        FALLBACK_FPS);
    self->fps_n = FALLBACK_FPS;
    self->fps_d = 1;
  }
}

static gboolean
make_caps (GstMeshSrc * self)
{
  const ClothTopology *topology = cloth_mesh_reader_get_topology (self->reader);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) sent =
      gst_cloth_topology_new (topology->n_vertices, topology->columns,
      topology->rows, topology->uv, topology->faces, topology->n_faces, &error);

  if (!sent) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The mesh in “%s” is not valid: " "%s", self->location,
            error->message), (NULL));
    return FALSE;
  }
  self->caps = gst_cloth_topology_to_caps (sent, self->fps_n, self->fps_d);
  return TRUE;
}

static gboolean
gst_mesh_src_stop (GstBaseSrc * src)
{
  GstMeshSrc *self = GST_MESH_SRC (src);

  self->times = NULL;
  g_clear_pointer (&self->reader, cloth_mesh_reader_free);
  GST_OBJECT_LOCK (self);
  gst_clear_caps (&self->caps);
  GST_OBJECT_UNLOCK (self);
  return TRUE;
}

static gboolean
gst_mesh_src_start (GstBaseSrc * src)
{
  GstMeshSrc *self = GST_MESH_SRC (src);
  g_autoptr (GError) error = NULL;
  guint n_seam_vertices;

  if (!self->location || !*self->location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("No location given: set the property “location” to a file or folder"),
        (NULL));
    return FALSE;
  }
  self->reader = cloth_mesh_reader_open (self->location, self->format, &error);
  if (!self->reader) {
    gst_mesh_post_error (GST_ELEMENT (self), "read", self->location, FALSE,
        error);
    return FALSE;
  }
  n_seam_vertices = cloth_mesh_reader_get_n_seam_vertices (self->reader);
  if (n_seam_vertices > 0)
    GST_ELEMENT_WARNING (self, STREAM, FORMAT,
        ("%u vertices of “%s” have more than one uv, the first is kept; split "
            "the mesh at its uv seams to keep all", n_seam_vertices,
            self->location), (NULL));
  self->n_frames = cloth_mesh_reader_get_n_frames (self->reader);
  self->next = 0;
  choose_rate (self);
  if (!check_times (self) || !make_caps (self)) {
    gst_mesh_src_stop (src);
    return FALSE;
  }
  GST_OBJECT_LOCK (self);
  src->segment.duration = frame_time (self, self->n_frames);
  GST_OBJECT_UNLOCK (self);
  GST_INFO_OBJECT (self, "%" G_GINT64_FORMAT " frames, %" GST_TIME_FORMAT,
      self->n_frames, GST_TIME_ARGS (src->segment.duration));
  return TRUE;
}

static GstCaps *
gst_mesh_src_get_caps (GstBaseSrc * src, GstCaps * filter)
{
  GstMeshSrc *self = GST_MESH_SRC (src);
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
gst_mesh_src_is_seekable (GstBaseSrc * src)
{
  return GST_MESH_SRC (src)->reader != NULL;
}

static gboolean
gst_mesh_src_do_seek (GstBaseSrc * src, GstSegment * segment)
{
  GstMeshSrc *self = GST_MESH_SRC (src);

  if (segment->format != GST_FORMAT_TIME)
    return FALSE;
  segment->time = segment->start;
  if (segment->rate >= 0)
    self->next = frame_at (self, segment->position);
  else if (GST_CLOCK_TIME_IS_VALID (segment->stop))
    self->next = frames_before (self, segment->stop) - 1;
  else
    self->next = self->n_frames - 1;
  return TRUE;
}

static gboolean
gst_mesh_src_query (GstBaseSrc * src, GstQuery * query)
{
  GstMeshSrc *self = GST_MESH_SRC (src);
  GstFormat format;
  GstClockTime duration;

  GST_OBJECT_LOCK (self);
  duration = self->caps ? src->segment.duration : GST_CLOCK_TIME_NONE;
  GST_OBJECT_UNLOCK (self);
  if (!GST_CLOCK_TIME_IS_VALID (duration))
    return GST_BASE_SRC_CLASS (gst_mesh_src_parent_class)->query (src, query);
  switch (GST_QUERY_TYPE (query)) {
    case GST_QUERY_DURATION:
      gst_query_parse_duration (query, &format, NULL);
      if (format != GST_FORMAT_TIME)
        return FALSE;
      gst_query_set_duration (query, format, (gint64) duration);
      return TRUE;
    case GST_QUERY_SEEKING:
      gst_query_parse_seeking (query, &format, NULL, NULL, NULL);
      if (format != GST_FORMAT_TIME)
        return FALSE;
      gst_query_set_seeking (query, format, TRUE, 0, (gint64) duration);
      return TRUE;
    default:
      return GST_BASE_SRC_CLASS (gst_mesh_src_parent_class)->query (src, query);
  }
}

static gboolean
is_at_end (GstMeshSrc * self, const GstSegment * segment)
{
  if (self->next < 0 || self->next >= self->n_frames)
    return TRUE;
  if (segment->rate >= 0)
    return GST_CLOCK_TIME_IS_VALID (segment->stop) &&
        frame_time (self, self->next) >= segment->stop;
  return frame_time (self, self->next + 1) <= segment->start;
}

static GstFlowReturn
gst_mesh_src_create (GstPushSrc * src, GstBuffer ** buffer)
{
  GstMeshSrc *self = GST_MESH_SRC (src);
  const GstSegment *segment = &GST_BASE_SRC (src)->segment;
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  ClothMeshFrame frame;
  guint n_vertices;

  if (is_at_end (self, segment))
    return GST_FLOW_EOS;
  if (!cloth_mesh_reader_read (self->reader, (guint) self->next, &frame,
          &error)) {
    gst_mesh_post_error (GST_ELEMENT (self), "read", self->location, FALSE,
        error);
    return GST_FLOW_ERROR;
  }
  n_vertices = cloth_mesh_reader_get_topology (self->reader)->n_vertices;
  mesh = gst_cloth_mesh_new ((guint64) self->next, n_vertices, frame.positions,
      frame.states, frame.covariances);
  *buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (*buffer) = frame_time (self, self->next);
  GST_BUFFER_DURATION (*buffer) = frame_time (self, self->next + 1) -
      GST_BUFFER_PTS (*buffer);
  GST_BUFFER_OFFSET (*buffer) = (guint64) self->next;
  GST_BUFFER_OFFSET_END (*buffer) = (guint64) self->next + 1;
  self->next += segment->rate >= 0 ? 1 : -1;
  return GST_FLOW_OK;
}

static void
gst_mesh_src_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * spec)
{
  GstMeshSrc *self = GST_MESH_SRC (object);

  GST_OBJECT_LOCK (self);
  if (GST_STATE (self) > GST_STATE_READY) {
    GST_WARNING_OBJECT (self, "“%s” cannot change while running",
        spec->name);
    GST_OBJECT_UNLOCK (self);
    return;
  }
  switch (id) {
    case PROP_LOCATION:
      g_free (self->location);
      self->location = g_value_dup_string (value);
      break;
    case PROP_FORMAT:
      self->format = g_value_get_enum (value);
      break;
    case PROP_FPS:
      self->wanted_n = gst_value_get_fraction_numerator (value);
      self->wanted_d = gst_value_get_fraction_denominator (value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, spec);
      break;
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_mesh_src_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * spec)
{
  GstMeshSrc *self = GST_MESH_SRC (object);

  GST_OBJECT_LOCK (self);
  switch (id) {
    case PROP_LOCATION:
      g_value_set_string (value, self->location);
      break;
    case PROP_FORMAT:
      g_value_set_enum (value, self->format);
      break;
    case PROP_FPS:
      gst_value_set_fraction (value, self->wanted_n, self->wanted_d);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, spec);
      break;
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_mesh_src_finalize (GObject * object)
{
  GstMeshSrc *self = GST_MESH_SRC (object);

  cloth_mesh_reader_free (self->reader);
  gst_clear_caps (&self->caps);
  g_free (self->location);
  G_OBJECT_CLASS (gst_mesh_src_parent_class)->finalize (object);
}

static void
gst_mesh_src_class_init (GstMeshSrcClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseSrcClass *src_class = GST_BASE_SRC_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (mesh_src_debug, "meshsrc", 0,
      "files into a mesh stream");
  object_class->set_property = gst_mesh_src_set_property;
  object_class->get_property = gst_mesh_src_get_property;
  object_class->finalize = gst_mesh_src_finalize;
  g_object_class_install_property (object_class, PROP_LOCATION,
      g_param_spec_string ("location", "Location",
          "File or folder to read: name.obj (with name.pc2 beside it), name.ply "
          "(or name_00000.ply and so on) or the folder of a take", NULL,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_READY));
  g_object_class_install_property (object_class, PROP_FORMAT,
      g_param_spec_enum ("format", "Format", "Format of the files",
          GST_TYPE_MESH_FORMAT, CLOTH_MESH_FORMAT_AUTO,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_READY));
  g_object_class_install_property (object_class, PROP_FPS,
      gst_param_spec_fraction ("fps", "Frames a second",
          "Frame rate to play at; 0/1 takes that of the files, or 30/1 when they "
          "have none", 0, 1, G_MAXINT, 1, 0, 1,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_READY));
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Mesh file source",
      "Source/File", "Reads a mesh stream from OBJ + PC2, PLY or a take",
      PACKAGE_NAME);
  src_class->start = gst_mesh_src_start;
  src_class->stop = gst_mesh_src_stop;
  src_class->get_caps = gst_mesh_src_get_caps;
  src_class->is_seekable = gst_mesh_src_is_seekable;
  src_class->do_seek = gst_mesh_src_do_seek;
  src_class->query = gst_mesh_src_query;
  GST_PUSH_SRC_CLASS (klass)->create = gst_mesh_src_create;
  gst_type_mark_as_plugin_api (GST_TYPE_MESH_FORMAT, 0);
}

static void
gst_mesh_src_init (GstMeshSrc * self)
{
  self->wanted_d = 1;
  gst_base_src_set_format (GST_BASE_SRC (self), GST_FORMAT_TIME);
}
