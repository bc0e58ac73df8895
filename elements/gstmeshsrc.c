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
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstmeshsrc.h"

#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"

GST_DEBUG_CATEGORY_STATIC (mesh_src_debug);
#define GST_CAT_DEFAULT mesh_src_debug

#define FALLBACK_FPS 30

enum
{
  PROP_0,
  PROP_LOCATION,
  PROP_FORMAT,
  PROP_FPS
};

struct _GstMeshSrc
{
  GstClothSource parent;

  /* with the object lock */
  gchar *location;
  ClothMeshFormat format;
  gint wanted_n, wanted_d;      /* 0/1: what the files say */

  /* from start to stop */
  ClothMeshReader *reader;
};

G_DEFINE_TYPE (GstMeshSrc, gst_mesh_src, GST_TYPE_CLOTH_SOURCE);
GST_ELEMENT_REGISTER_DEFINE (meshsrc, "meshsrc", GST_RANK_NONE,
    GST_TYPE_MESH_SRC);

static void
choose_rate (GstMeshSrc * self, GstClothSourceStream * stream)
{
  gdouble fps = cloth_mesh_reader_get_fps (self->reader);

  if (self->wanted_n > 0) {
    stream->fps_n = self->wanted_n;
    stream->fps_d = self->wanted_d;
    return;
  }
  stream->times = cloth_mesh_reader_get_times (self->reader);
  if (fps > 0)
    gst_util_double_to_fraction (fps, &stream->fps_n, &stream->fps_d);
  if (stream->fps_n <= 0 && !stream->times) {
    GST_INFO_OBJECT (self, "the files give no frame rate, %d/1 is taken",
        FALLBACK_FPS);
    stream->fps_n = FALLBACK_FPS;
    stream->fps_d = 1;
  }
}

static gboolean
gst_mesh_src_open (GstClothSource * source)
{
  GstMeshSrc *self = GST_MESH_SRC (source);
  GstClothSourceStream stream = { self->location,
    "; or set “fps” to play at a rate of your own", NULL, 0, NULL, 0, 0, 1
  };
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
  stream.topology = cloth_mesh_reader_get_topology (self->reader);
  stream.n_frames = cloth_mesh_reader_get_n_frames (self->reader);
  choose_rate (self, &stream);
  return gst_cloth_source_publish (source, &stream);
}

static void
gst_mesh_src_close (GstClothSource * source)
{
  g_clear_pointer (&GST_MESH_SRC (source)->reader, cloth_mesh_reader_free);
}

static GstClothMesh *
gst_mesh_src_make_mesh (GstClothSource * source, guint number)
{
  GstMeshSrc *self = GST_MESH_SRC (source);
  g_autoptr (GError) error = NULL;
  ClothMeshFrame frame;

  if (!cloth_mesh_reader_read (self->reader, number, &frame, &error)) {
    gst_mesh_post_error (GST_ELEMENT (self), "read", self->location, FALSE,
        error);
    return NULL;
  }
  return gst_cloth_mesh_new (number,
      cloth_mesh_reader_get_topology (self->reader)->n_vertices,
      frame.positions, frame.states, frame.covariances);
}

static void
gst_mesh_src_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * spec)
{
  GstMeshSrc *self = GST_MESH_SRC (object);

  GST_OBJECT_LOCK (self);
  if (!gst_cloth_may_change (GST_ELEMENT (self), spec)) {
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

  g_free (self->location);
  G_OBJECT_CLASS (gst_mesh_src_parent_class)->finalize (object);
}

static void
gst_mesh_src_class_init (GstMeshSrcClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothSourceClass *source_class = GST_CLOTH_SOURCE_CLASS (klass);

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
  gst_element_class_set_static_metadata (element_class, "Mesh file source",
      "Source/File", "Reads a mesh stream from OBJ + PC2, PLY or a take",
      "The gst-cloth developers");
  source_class->backwards = TRUE;
  source_class->open = gst_mesh_src_open;
  source_class->close = gst_mesh_src_close;
  source_class->make_mesh = gst_mesh_src_make_mesh;
  gst_type_mark_as_plugin_api (GST_TYPE_MESH_FORMAT, 0);
}

static void
gst_mesh_src_init (GstMeshSrc * self)
{
  self->wanted_d = 1;
}
