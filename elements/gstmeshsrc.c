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

#include "elements/gstclothproperties.h"
#include "elements/gstmeshformat.h"

GST_DEBUG_CATEGORY_STATIC (mesh_src_debug);
#define GST_CAT_DEFAULT mesh_src_debug

#define FALLBACK_FPS 30

typedef struct
{
  gchar *location;
  ClothMeshFormat format;
  gint fps[2];                  /* 0/1: what the files say */
} Settings;

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"location", "Location",
    "File or folder to read: name.obj (with name.pc2 beside it), name.ply "
    "(or name_00000.ply and so on) or the folder of a take",
    G_TYPE_STRING, SETTING (location), GST_PARAM_MUTABLE_READY},
  {"format", "Format", "Format of the files",
    G_TYPE_ENUM, SETTING (format), GST_PARAM_MUTABLE_READY, 0, 0,
    "GstMeshFormat", gst_mesh_format_values},
  {"fps", "Frames a second",
    "Frame rate to play at; 0/1 takes that of the files, or 30/1 when they "
    "have none",
    GST_CLOTH_TYPE_FRACTION, SETTING (fps), GST_PARAM_MUTABLE_READY},
};
/* *INDENT-ON* */

static const Settings default_settings = { NULL, CLOTH_MESH_FORMAT_AUTO,
  {0, 1}
};

struct _GstMeshSrc
{
  GstClothSource parent;

  /* with the object lock */
  Settings settings;

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

  if (self->settings.fps[0] > 0) {
    stream->fps_n = self->settings.fps[0];
    stream->fps_d = self->settings.fps[1];
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
  GstClothSourceStream stream = { self->settings.location,
    "; or set “fps” to play at a rate of your own", NULL, 0, NULL, 0, 0, 1
  };
  g_autoptr (GError) error = NULL;
  guint n_seam_vertices;

  if (!self->settings.location || !*self->settings.location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("No location given: nothing can be read."),
        ("Set the property location to a file or folder, as cloth.obj."));
    return FALSE;
  }
  self->reader =
      cloth_mesh_reader_open (self->settings.location, self->settings.format,
      &error);
  if (!self->reader) {
    gst_mesh_post_error (GST_ELEMENT (self), "read", self->settings.location,
        FALSE, error);
    return FALSE;
  }
  n_seam_vertices = cloth_mesh_reader_get_n_seam_vertices (self->reader);
  if (n_seam_vertices > 0)
    GST_ELEMENT_WARNING (self, STREAM, FORMAT,
        ("%u vertices of “%s” have more than one uv, the first is kept.",
            n_seam_vertices, self->settings.location),
        ("Split the mesh at its uv seams to keep all."));
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
    gst_mesh_post_error (GST_ELEMENT (self), "read", self->settings.location,
        FALSE, error);
    return NULL;
  }
  return gst_cloth_mesh_new (number,
      cloth_mesh_reader_get_topology (self->reader)->n_vertices,
      frame.positions, frame.states, frame.covariances);
}

static void
gst_mesh_src_finalize (GObject * object)
{
  GstMeshSrc *self = GST_MESH_SRC (object);

  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
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
  object_class->finalize = gst_mesh_src_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &default_settings,
      G_STRUCT_OFFSET (GstMeshSrc, settings));
  gst_element_class_set_static_metadata (element_class, "Mesh file source",
      "Source/File", "Reads a mesh stream from OBJ + PC2, PLY or a take",
      "The gst-cloth developers");
  source_class->backwards = TRUE;
  source_class->open = gst_mesh_src_open;
  source_class->close = gst_mesh_src_close;
  source_class->make_mesh = gst_mesh_src_make_mesh;
}

static void
gst_mesh_src_init (GstMeshSrc * self)
{
  self->settings = default_settings;
}
