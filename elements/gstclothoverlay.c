/* clothoverlay: draws what the other elements have found.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-clothoverlay
 * @title: clothoverlay
 *
 * Draws the silhouette, saddles, squares, dots and matches that a picture carries as metadata,
 * and, when its `mesh` pad is linked, a mesh as the camera `camera` of `rig` sees it; where the
 * mesh has a map of which place of the cloth each pixel of that camera shows, checks are drawn
 * there. The picture is drawn on in place; one with nothing to draw passes untouched. The mesh is drawn as lines or
 * as a surface with any picture on it (`mesh-style`, `texture`). A mesh that `clothgap`
 * has been over is drawn as a heat map of its distance from the simulation. `strain-warp`,
 * `strain-weft` and `strain-shear` colour the cloth by how far its threads are longer (red) or
 * shorter (blue) than on the flat cloth, and how far the angle between them has closed (red) or
 * opened.
 *
 * `draw-legend` writes the camera, the picture's number and time, how many squares, dots or
 * vertices there are and what their colours mean; `draw-speed`, for live cameras, how many
 * pictures a second come by and how many are missing by their time stamps.
 *
 * What a stranger's packets say is drawn as far as it covers the picture at most 64 times
 * (at least 300 million pixels); what comes after that is left out, with one warning.
 *
 * A picture whose mesh is damaged goes on without it. The mesh is counted in `dropped`; the
 * first gives a warning, the end of the stream an info message with their number. With
 * `strict`, for files, the first is an error.
 *
 * ## Squares over a film
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! saddledetect ! quadtrack ! \
 *     clothoverlay draw-indices=true ! videoconvert ! autovideosink
 * ]|
 *
 * ## A mesh over the picture of one of its cameras
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! clothoverlay name=o \
 *     rig=rig.json camera=cam0 ! videoconvert ! autovideosink \
 *     meshsrc location=take ! o.mesh
 * ]|
 *
 * ## The cloth in another fabric
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! clothoverlay name=o \
 *     rig=rig.json camera=cam0 mesh-style=shaded texture=fabric.jpg ! videoconvert ! \
 *     autovideosink  meshsrc location=take ! o.mesh
 * ]|
 *
 * ## Where the cloth is stretched along its warp
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! clothoverlay name=o \
 *     rig=rig.json camera=cam0 mesh-style=strain-warp strain-scale=5 ! videoconvert ! \
 *     autovideosink  meshsrc location=take ! o.mesh
 * ]|
 *
 * ## Where a simulation departs from the film
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! clothoverlay name=o \
 *     rig=rig.json camera=cam0 gap-scale=20 ! videoconvert ! autovideosink \
 *     meshsrc location=take ! clothgap model=model.json location=take ! o.mesh
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothoverlay.h"

#include <math.h>

#include "elements/gstclothdamage.h"
#include "elements/gstclothoverlay-draw.h"
#include "elements/gstclothpaint.h"
#include "elements/gstclothpicture.h"
#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"
#include "gst/mesh/strain.h"
#include "gst/render/surface.h"
#include "gst/render/wireframe.h"

GST_DEBUG_CATEGORY_STATIC (cloth_overlay_debug);
#define GST_CAT_DEFAULT cloth_overlay_debug

/* indices of the pads */
#define VIDEO 0
#define MESH 1

/* So many times the picture's area is drawn over it, what is transparent or hidden included,
 * and in small pictures at least so many samples, which take some tenths of a second.
 * 65,536 squares with outlines and numbers need less than half of it. */
#define MOST_LAYERS 64
#define LEAST_SAMPLES 3e8

/* Of the lines of a mesh that lie behind another part of it. */
#define HIDDEN_OPACITY 0.25f
/* Of the heat map: the film shows through. */
#define HEAT_OPACITY 0.6f

/* A calibration fits a picture of other size when the shapes agree this well. */
#define ASPECT_SLACK 0.01

#define FORMATS "{ GRAY8, I420, YV12, NV12, NV21, Y42B, NV16, NV61, Y444, NV24, " \
    "Y41B, YUV9, YVU9, A420, YUY2, UYVY, YVYU, AYUV, BGRx, RGBx, xBGR, xRGB, " \
    "BGRA, RGBA, ABGR, ARGB, RGB, BGR }"

typedef struct
{
  GstClothOverlayStyle style;
  gchar *rig, *camera, *texture;
  GstClothDamage damage;
} Settings;

/* The mesh of one topology. */
typedef struct
{
  GstClothTopology *topology;
  ClothWireframe *wire;
  ClothSurface *surface;        /* NULL until something is printed on it */
  ClothStrains *strains;        /* NULL when uv is not known */
  guint8 *heats;                /* one a vertex */
} Mesh;

struct _GstClothOverlay
{
  GstClothSync parent;

  /* with the object lock */
  Settings settings;
  gboolean rig_changed, texture_changed;

  gint stopped;                 /* atomic: nobody waits for the picture any more */

  /* streaming thread */
  GstVideoInfo info;
  GQueue tags;                  /* TAG events that wait for the first picture */
  GstCaps *video_caps;
  gboolean knows_strides;       /* downstream, of GstVideoMeta */
  GArray *places;               /* of dots, of vertices */
  GArray *cells;                /* gfloat: of the heat map of matches */
  Mesh *mesh;
  ClothRig *rig;
  const ClothCamera *camera;    /* of @rig */
  gboolean warned;              /* that not all was drawn */
  gboolean told_no_uv;          /* that strain is not known */
  guint64 n_pictures, n_lost;
  GstClockTime last_pts;
  GstClockTime counted_from;    /* by the element's clock */
  guint n_counted;              /* pictures since then */
  gdouble speed;                /* pictures a second; 0: not known yet */
  GstClothOverlayFacts facts;   /* of the picture that is drawn on */
};

G_DEFINE_TYPE (GstClothOverlay, gst_cloth_overlay, GST_TYPE_CLOTH_SYNC);
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE (clothoverlay, "clothoverlay",
    GST_RANK_NONE, GST_TYPE_CLOTH_OVERLAY,
    GST_DEBUG_CATEGORY_INIT (cloth_overlay_debug, "clothoverlay", 0,
        "drawing of cloth metadata and meshes"));

static const GEnumValue matches_styles[] = {
  {GST_CLOTH_OVERLAY_MATCHES_NONE, "Not at all", "none"},
  {GST_CLOTH_OVERLAY_MATCHES_GROUPS, "Each match, coloured by the seed that it "
        "grew from, and the vertices of the grid", "groups"},
  {GST_CLOTH_OVERLAY_MATCHES_DENSITY, "Heat map of how many verified matches "
        "there are", "density"},
  {0, NULL, NULL}
};

static const GEnumValue mesh_styles[] = {
  {GST_CLOTH_OVERLAY_MESH_WIREFRAME, "Lines, coloured by what is known of "
        "each vertex", "wireframe"},
  {GST_CLOTH_OVERLAY_MESH_SHADED, "Surface in light and shade, with texture "
        "if there is one", "shaded"},
  {GST_CLOTH_OVERLAY_MESH_STRAIN_WARP, "Faces coloured by the strain along u",
      "strain-warp"},
  {GST_CLOTH_OVERLAY_MESH_STRAIN_WEFT, "Faces coloured by the strain along v",
      "strain-weft"},
  {GST_CLOTH_OVERLAY_MESH_STRAIN_SHEAR, "Faces coloured by the shear strain",
      "strain-shear"},
  {0, NULL, NULL}
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)
#define MUTABLE GST_PARAM_MUTABLE_PLAYING
#define ANIMATED (GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"draw-silhouette", "draw-silhouette",
    "Tint what is cloth by the silhouette, and draw its border",
    G_TYPE_BOOLEAN, SETTING (style.draw_silhouette), ANIMATED},
  {"draw-saddles", "draw-saddles",
    "Draw the saddle points as crosses; the raw candidates as dots when none "
    "was refined",
    G_TYPE_BOOLEAN, SETTING (style.draw_saddles), ANIMATED},
  {"draw-quads", "draw-quads",
    "Draw the squares, coloured by confidence: yellow for 1, purple for c-low; "
    "dashed when only predicted",
    G_TYPE_BOOLEAN, SETTING (style.draw_quads), ANIMATED},
  {"draw-dots", "draw-dots",
    "Draw the labelled dots and the links between neighbours of the pattern, yellow "
    "for sure labels to purple, blue where seen from behind; a red cross on dots "
    "without a label",
    G_TYPE_BOOLEAN, SETTING (style.draw_dots), ANIMATED},
  {"draw-matches", "draw-matches",
    "How matches with a print are drawn: none, groups (crosses, a colour for each seed "
    "that they grew from; faint dashes where not verified; rings on the grid's vertices, "
    "linked with their neighbours, blue where seen from behind) or density (heat map of "
    "the verified ones, pale to dark red for one in 8 by 8 px; each counts up to 16 px away)",
    G_TYPE_ENUM, SETTING (style.draw_matches), ANIMATED, 0, 0,
    "GstClothOverlayMatches", matches_styles},
  {"draw-uv", "draw-uv",
    "Where the mesh carries a map of the places that this camera's pixels show, draw "
    "black and white checks on the cloth by it",
    G_TYPE_BOOLEAN, SETTING (style.draw_uv), ANIMATED},
  {"check", "check", "Edge of these checks on the cloth, mm",
    G_TYPE_UINT, SETTING (style.check), ANIMATED, 1, 99999},
  {"draw-indices", "draw-indices",
    "Write column (above) and row (below) into the squares and onto the dots",
    G_TYPE_BOOLEAN, SETTING (style.draw_indices), ANIMATED},
  {"draw-mesh", "draw-mesh",
    "Draw the mesh of the mesh pad",
    G_TYPE_BOOLEAN, SETTING (style.draw_mesh), ANIMATED},
  {"draw-legend", "draw-legend",
    "Write camera, number and time of the picture, how many of what was found, and what "
    "the colours mean",
    G_TYPE_BOOLEAN, SETTING (style.draw_legend), ANIMATED},
  {"draw-speed", "draw-speed",
    "Write how many pictures a second come by, by the clock of the pipeline, and how many "
    "are missing by their time stamps",
    G_TYPE_BOOLEAN, SETTING (style.draw_speed), ANIMATED},
  {"mesh-style", "mesh-style",
    "How the mesh is drawn: wireframe (green measured, amber from two views, "
    "blue filled, violet predicted; faint where hidden), shaded (a surface, "
    "its hidden parts hidden) or strain-warp, strain-weft, strain-shear (Green–Lagrange "
    "strain against the flat cloth: blue shorter, pale none, red longer, grey where not known)",
    G_TYPE_ENUM, SETTING (style.mesh_style), ANIMATED, 0, 0,
    "GstClothOverlayMeshStyle", mesh_styles},
  {"texture", "texture",
    "Picture file that is printed over the whole cloth, on both its sides, when it "
    "is drawn shaded; without one it is white",
    G_TYPE_STRING, SETTING (texture), MUTABLE},
  {"draw-gap", "draw-gap",
    "Where the mesh carries its distance from a simulation, draw it as a heat map, "
    "pale for none to dark red for gap-scale, grey where not seen",
    G_TYPE_BOOLEAN, SETTING (style.draw_gap), ANIMATED},
  {"gap-scale", "gap-scale",
    "Distance from the simulation that has the last colour, mm",
    G_TYPE_UINT, SETTING (style.gap_scale), ANIMATED, 1, 99999},
  {"strain-scale", "strain-scale",
    "Strain that has the last colour, %: 1 is a thread that is 1% longer",
    G_TYPE_UINT, SETTING (style.strain_scale), ANIMATED, 1, 1000},
  {"line-width", "line-width",
    "Width of all lines, px",
    G_TYPE_DOUBLE, SETTING (style.line_width), ANIMATED, 0.25, 100},
  {"opacity", "opacity",
    "Opacity of everything drawn",
    G_TYPE_DOUBLE, SETTING (style.opacity), ANIMATED, 0, 1},
  {"fill-opacity", "fill-opacity",
    "Opacity of the inside of tracked squares; times opacity",
    G_TYPE_DOUBLE, SETTING (style.fill_opacity), ANIMATED, 0, 1},
  {"c-low", "c-low",
    "Confidence drawn in purple: the one below which the tracker gives a square "
    "up",
    G_TYPE_DOUBLE, SETTING (style.c_low), ANIMATED, -1, 1},
  {"ellipse-scale", "ellipse-scale",
    "Draw the one-sigma covariance ellipses of the saddles enlarged this many "
    "times; 0: don't",
    G_TYPE_DOUBLE, SETTING (style.ellipse_scale), ANIMATED, 0, 100000},
  {"rig", "rig",
    "Calibration file (rig.json) by which the mesh is projected",
    G_TYPE_STRING, SETTING (rig), MUTABLE},
  {"camera", "camera",
    "Name in the rig of the camera that took the picture; may be left out when "
    "the rig has one camera",
    G_TYPE_STRING, SETTING (camera), MUTABLE},
  GST_CLOTH_DAMAGE_PROPERTIES (Settings, damage),
};

static const Settings defaults = {
  .style = {
    .draw_silhouette = TRUE, .draw_quads = TRUE, .draw_dots = TRUE,
    .draw_mesh = TRUE, .draw_gap = TRUE, .gap_scale = 10, .strain_scale = 10, .draw_uv = TRUE, .check = 20,
    .draw_matches = GST_CLOTH_OVERLAY_MATCHES_GROUPS,
    .line_width = 1.5f, .opacity = 1, .fill_opacity = 0.3f, .c_low = 0.62f,
    .mesh_style = GST_CLOTH_OVERLAY_MESH_WIREFRAME
  }
};
/* *INDENT-ON* */

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS,
    GST_STATIC_CAPS (GST_VIDEO_CAPS_MAKE (FORMATS)));
static GstStaticPadTemplate mesh_template = GST_STATIC_PAD_TEMPLATE ("mesh",
    GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS (GST_VIDEO_CAPS_MAKE (FORMATS)));

/* ---- the mesh ---- */

static Mesh *
mesh_new (GstClothTopology * topology)
{
  Mesh *self = g_new0 (Mesh, 1);
  guint n_indices;
  const guint32 *faces = gst_cloth_topology_get_faces (topology, &n_indices);
  const guint n_vertices = gst_cloth_topology_get_n_vertices (topology);
  g_autoptr (ClothTopology) copy = gst_mesh_copy_topology (topology);

  self->topology = gst_cloth_topology_ref (topology);
  self->strains = cloth_strains_new (copy);
  self->heats = g_malloc (n_vertices);
  self->wire = cloth_wireframe_new (n_vertices,
      gst_cloth_topology_get_columns (topology),
      gst_cloth_topology_get_rows (topology), faces, n_indices / 4);
  return self;
}

static void
mesh_free (Mesh * self)
{
  if (!self) {
    return;
  }
  gst_cloth_topology_unref (self->topology);
  cloth_wireframe_free (self->wire);
  cloth_surface_free (self->surface);
  cloth_strains_free (self->strains);
  g_free (self->heats);
  g_free (self);
}

/* Puts @texture on the surface, or plain white when it is NULL. */
static gboolean
mesh_print (Mesh * self, const gchar * texture, GError ** error)
{
  const guint n_vertices = gst_cloth_topology_get_n_vertices (self->topology);
  const gfloat *uv = gst_cloth_topology_get_uv (self->topology, NULL);
  guint n_indices;
  const guint32 *faces =
      gst_cloth_topology_get_faces (self->topology, &n_indices);
  g_autoptr (ClothPaint) paint = texture ? gst_cloth_paint_texture (texture,
      uv, n_vertices, error) : gst_cloth_paint_white ();

  if (!paint) {
    return FALSE;
  }
  g_clear_pointer (&self->surface, cloth_surface_free);
  self->surface = cloth_surface_new (n_vertices, uv, faces, n_indices / 4,
      paint, CLOTH_SIMD_BEST);
  return TRUE;
}

static gboolean
is_strain (GstClothOverlayMeshStyle style)
{
  return style >= GST_CLOTH_OVERLAY_MESH_STRAIN_WARP;
}

static void
mesh_draw_strain (Mesh * self, const ClothCanvas * canvas, gint width,
    gint height, const ClothCamera * camera, const gfloat * positions,
    const GstClothOverlayStyle * style)
{
  const guint n_vertices = gst_cloth_topology_get_n_vertices (self->topology);
  const guint component = style->mesh_style -
      GST_CLOTH_OVERLAY_MESH_STRAIN_WARP;
  const gint scale = (gint) style->strain_scale;
  ClothColour colours[CLOTH_DRAW_STRAINS];
  const ClothWireStyle wire_style = {
    CLOTH_DRAW_STRAINS, colours, style->line_width, style->opacity,
    HIDDEN_OPACITY, HEAT_OPACITY * style->opacity
  };

  cloth_draw_strain_colours (colours);
  if (self->strains) {
    cloth_strains_measure (self->strains, positions, NULL);
    cloth_draw_strains (cloth_strains_get_vertices (self->strains) + component,
        n_vertices, CLOTH_STRAIN_SIZE, style->strain_scale, self->heats);
  } else {
    memset (self->heats, CLOTH_DRAW_STRAINS - 1, n_vertices);
  }
  cloth_wireframe_draw (self->wire, canvas, width, height, camera, positions,
      self->heats, &wire_style);
  cloth_draw_scale (canvas, width, height, colours, CLOTH_DRAW_STRAINS - 1,
      -scale, scale, style->opacity);
}

static void
mesh_draw (Mesh * self,
    const ClothCanvas * canvas, gint width, gint height,
    const ClothCamera * camera, GstClothMesh * mesh, GstClothGap * gap,
    const GstClothOverlayStyle * style, GstClothOverlayFacts * facts)
{
  ClothWireStyle wire_style = {
    GST_CLOTH_OVERLAY_STATES, gst_cloth_overlay_vertex_colours,
    style->line_width,
    style->opacity, HIDDEN_OPACITY, 0
  };
  ClothColour heat_colours[CLOTH_DRAW_HEATS];
  const gfloat *positions = gst_cloth_mesh_get_positions (mesh, NULL);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);
  const gboolean hot = gap && gst_cloth_gap_get_n_vertices (gap) ==
      gst_cloth_topology_get_n_vertices (self->topology);

  for (guint i = 0; i < gst_cloth_topology_get_n_vertices (self->topology); i++) {
    facts->n_of_state[MIN (states[i], GST_CLOTH_OVERLAY_STATES - 1)]++;
  }
  if (is_strain (style->mesh_style)) {
    facts->mesh_colours = GST_CLOTH_OVERLAY_COLOURS_STRAIN;
    mesh_draw_strain (self, canvas, width, height, camera, positions, style);
    return;
  }
  facts->mesh_colours = GST_CLOTH_OVERLAY_COLOURS_STATE;
  if (hot) {
    facts->mesh_colours = GST_CLOTH_OVERLAY_COLOURS_GAP;
    cloth_draw_heats (gst_cloth_gap_get_residuals (gap, NULL),
        gst_cloth_gap_get_n_vertices (gap), style->gap_scale, self->heats);
    cloth_draw_heat_colours (heat_colours);
    states = self->heats;
    wire_style.n_colours = CLOTH_DRAW_HEATS;
    wire_style.colours = heat_colours;
    wire_style.fill_opacity = HEAT_OPACITY * style->opacity;
  } else if (style->mesh_style == GST_CLOTH_OVERLAY_MESH_SHADED) {
    ClothRenderStyle light;

    facts->mesh_colours = GST_CLOTH_OVERLAY_COLOURS_PLAIN;
    cloth_render_style_init (&light);
    cloth_surface_draw (self->surface, canvas, width, height, camera,
        positions, &light, style->opacity);
    return;
  }
  cloth_wireframe_draw (self->wire, canvas, width, height, camera, positions,
      states, &wire_style);
  if (hot) {
    cloth_draw_scale (canvas, width, height, heat_colours,
        CLOTH_DRAW_HEATS - 1, 0, (gint) style->gap_scale, style->opacity);
  }
}

static gboolean
gst_cloth_overlay_load_rig (GstClothOverlay * self)
{
  g_autofree gchar *path = NULL, *name = NULL;

  GST_OBJECT_LOCK (self);
  if (!self->rig_changed && self->camera) {
    GST_OBJECT_UNLOCK (self);
    return TRUE;
  }
  self->rig_changed = FALSE;
  path = g_strdup (self->settings.rig);
  name = g_strdup (self->settings.camera);
  GST_OBJECT_UNLOCK (self);

  self->camera = NULL;
  g_clear_pointer (&self->rig, cloth_rig_free);
  self->rig = gst_cloth_open_rig (GST_ELEMENT (self), path, name,
      &self->camera);
  if (!self->rig) {
    return FALSE;
  }
  /* meshes come in the rig's time, pictures in their camera's */
  gst_cloth_sync_set_pad_offset (GST_CLOTH_SYNC (self), MESH,
      -(GstClockTimeDiff) (self->camera->offset_s * GST_SECOND));
  return TRUE;
}

static gboolean
gst_cloth_overlay_check_size (GstClothOverlay * self)
{
  gint width = GST_VIDEO_INFO_WIDTH (&self->info);
  gint height = GST_VIDEO_INFO_HEIGHT (&self->info);
  const ClothCamera *camera = self->camera;
  gdouble ratio = (gdouble) width / height * camera->height / camera->width;

  if (fabs (ratio - 1) <= ASPECT_SLACK) {
    return TRUE;
  }
  GST_ELEMENT_ERROR (self, STREAM, FORMAT,
      ("The picture is %d×%d, camera \"%s\" was calibrated at %d×%d.", width,
          height, camera->name ? camera->name : "", camera->width,
          camera->height),
      ("Draw before the picture is cropped or rotated, or set camera= to the "
          "camera that took it."));
  return FALSE;
}

/* What is printed on the mesh, when it is to be shaded. */
static gboolean
gst_cloth_overlay_print (GstClothOverlay * self)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *texture = NULL;

  GST_OBJECT_LOCK (self);
  if (!self->texture_changed && self->mesh->surface) {
    GST_OBJECT_UNLOCK (self);
    return TRUE;
  }
  self->texture_changed = FALSE;
  texture = g_strdup (self->settings.texture);
  GST_OBJECT_UNLOCK (self);
  if (mesh_print (self->mesh, texture, &error)) {
    return TRUE;
  }
  GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
      ("Can't put “%s” on the cloth: %s", texture, error->message), (NULL));
  return FALSE;
}

static void
gst_cloth_overlay_tell_no_uv (GstClothOverlay * self)
{
  if (self->told_no_uv) {
    return;
  }
  self->told_no_uv = TRUE;
  GST_ELEMENT_WARNING (self, STREAM, FAILED,
      ("The mesh doesn't say where its vertices lie on the flat cloth, so its "
          "strain is not known."),
      ("It is drawn grey. Give a mesh with uv in metres (vt of an OBJ file, "
          "s and t of a PLY file), or another mesh-style."));
}

/* A picture whose mesh is damaged goes on without it. */
static GstFlowReturn
gst_cloth_overlay_draw_mesh (GstClothOverlay * self, const ClothCanvas * canvas,
    GstBuffer * buffer, const GstClothOverlayStyle * style)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = gst_cloth_parse_mesh (buffer,
      gst_cloth_topology_get_n_vertices (self->mesh->topology), &error);
  GstClothGap *gap = style->draw_gap ? gst_buffer_get_cloth_gap (buffer) : NULL;

  if (!mesh) {
    return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
        error);
  }
  if (style->mesh_style == GST_CLOTH_OVERLAY_MESH_SHADED
      && !gst_cloth_overlay_print (self)) {
    return GST_FLOW_ERROR;
  }
  if (is_strain (style->mesh_style) && !self->mesh->strains) {
    gst_cloth_overlay_tell_no_uv (self);
  }
  mesh_draw (self->mesh, canvas,
      GST_VIDEO_INFO_WIDTH (&self->info), GST_VIDEO_INFO_HEIGHT (&self->info),
      self->camera, mesh, gap, style, &self->facts);
  return GST_FLOW_OK;
}

/* The map of this camera's pixels on @mesh, when it is of the size that they were filmed at. */
static GstClothUV *
gst_cloth_overlay_find_uv (GstClothOverlay * self, GstBuffer * mesh)
{
  const gchar *name = self->camera->name;
  GstClothUV *uv = gst_buffer_get_cloth_uv (mesh, name && *name ? name : NULL);

  return uv && gst_cloth_uv_get_width (uv) == (guint) self->camera->width
      && gst_cloth_uv_get_height (uv) == (guint) self->camera->height ? uv :
      NULL;
}

/* ---- GstClothSync ---- */

static gboolean
gst_cloth_overlay_set_pad_caps (GstClothSync * sync, guint index,
    GstCaps * caps)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (sync);
  g_autoptr (GstClothTopology) topology = NULL;

  if (index == VIDEO) {
    gst_caps_replace (&self->video_caps, caps);
    if (caps && !gst_video_info_from_caps (&self->info, caps)) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("Bad video caps."),
          ("%" GST_PTR_FORMAT, caps));
      return FALSE;
    }
    return TRUE;
  }

  g_clear_pointer (&self->mesh, mesh_free);
  if (!caps) {
    return TRUE;
  }
  topology = gst_cloth_read_topology (GST_ELEMENT (self), caps);
  if (!topology) {
    return FALSE;
  }
  self->mesh = mesh_new (topology);
  return gst_cloth_overlay_load_rig (self);
}

static GstFlowReturn
gst_cloth_overlay_negotiate_src (GstClothSync * sync, GstCaps * downstream,
    GstCaps ** caps)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (sync);

  if (!self->video_caps) {
    return GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  *caps = gst_caps_ref (self->video_caps);
  return GST_FLOW_OK;
}

/* Whatever layout the pictures come in they go on in: downstream is asked whether it can
 * read that. */
static gboolean
gst_cloth_overlay_decide_allocation (GstAggregator * agg, GstQuery * query)
{
  GST_CLOTH_OVERLAY (agg)->knows_strides =
      gst_query_find_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL);
  return TRUE;
}

/* Counts the picture, and what is missing before it. */
static void
gst_cloth_overlay_count (GstClothOverlay * self, GstClockTime pts)
{
  g_autoptr (GstClock) clock = gst_element_get_clock (GST_ELEMENT (self));
  const gint fps_n = GST_VIDEO_INFO_FPS_N (&self->info);
  const gint fps_d = GST_VIDEO_INFO_FPS_D (&self->info);

  if (GST_CLOCK_TIME_IS_VALID (pts) && GST_CLOCK_TIME_IS_VALID (self->last_pts)
      && pts > self->last_pts && fps_n > 0) {
    const guint64 n_periods = gst_util_uint64_scale_round (pts - self->last_pts,
        (guint64) fps_n, (guint64) fps_d * GST_SECOND);

    self->n_lost += n_periods > 1 ? n_periods - 1 : 0;
  }
  self->last_pts = pts;
  if (clock) {
    const GstClockTime now = gst_clock_get_time (clock);

    if (!GST_CLOCK_TIME_IS_VALID (self->counted_from)
        || now < self->counted_from) {
      self->counted_from = now;
      self->n_counted = 0;
    } else if (now - self->counted_from >= GST_SECOND) {
      self->speed = (gdouble) (self->n_counted + 1) * GST_SECOND /
          (gdouble) (now - self->counted_from);
      self->counted_from = now;
      self->n_counted = 0;
    } else {
      self->n_counted++;
    }
  }
}

/* What is told of the picture; the mesh adds its own when it is drawn. */
static void
gst_cloth_overlay_start_facts (GstClothOverlay * self, GstClockTime pts)
{
  const GstClothOverlayFacts facts = {
    self->camera ? self->camera->name : NULL, self->n_pictures, pts,
    GST_CLOTH_OVERLAY_COLOURS_NONE, {0}, self->speed, self->n_lost
  };

  self->facts = facts;
  self->n_pictures++;
}

static void
gst_cloth_overlay_reset_count (GstClothOverlay * self)
{
  self->n_pictures = self->n_lost = 0;
  self->n_counted = 0;
  self->speed = 0;
  self->last_pts = self->counted_from = GST_CLOCK_TIME_NONE;
}

/* What a picture may cost. */
static ClothWork
gst_cloth_overlay_allow (GstClothOverlay * self)
{
  const gdouble area = (gdouble) GST_VIDEO_INFO_WIDTH (&self->info) *
      GST_VIDEO_INFO_HEIGHT (&self->info);
  const ClothWork work = { MAX (MOST_LAYERS * area, LEAST_SAMPLES),
    &self->stopped, FALSE
  };

  return work;
}

static void
gst_cloth_overlay_tell (GstClothOverlay * self, const ClothWork * work)
{
  if (!work->left_out || self->warned) {
    return;
  }
  self->warned = TRUE;
  GST_ELEMENT_WARNING (self, STREAM, FAILED,
      ("What is to be drawn is too much for a picture: the rest was left out."),
      ("Make line-width or ellipse-scale smaller; if they are small, what came "
          "is of no cloth. Of other pictures like it you are not told."));
}

static GstFlowReturn
gst_cloth_overlay_process_set (GstClothSync * sync, GstBuffer ** views, guint n,
    guint64 mask, GstClockTime pts, GstClockTime duration, GstBuffer ** out)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (sync);
  GstFlowReturn ret = GST_FLOW_OK;
  GstBuffer *mesh = n > MESH ? views[MESH] : NULL;
  GstBuffer *mapped = mesh;
  GstClothUV *uv = NULL;
  gboolean has_silhouette, has_quads, has_dots, has_matches, has_saddles;
  GstVideoFrame frame;
  ClothCanvas canvas;
  ClothWork work = gst_cloth_overlay_allow (self);
  GstClothOverlayStyle style;

  if (!views[VIDEO]) {
    g_autoptr (GstPad) video =
        gst_element_get_static_pad (GST_ELEMENT (self), "sink");

    /* a mesh for which there is no picture: not yet, or no more */
    return gst_aggregator_pad_is_eos (GST_AGGREGATOR_PAD (video)) ?
        GST_FLOW_EOS : GST_FLOW_OK;
  }
  if (GST_CLOCK_TIME_IS_VALID (pts)) {
    gst_object_sync_values (GST_OBJECT (self), pts);
  }
  GST_OBJECT_LOCK (self);
  style = self->settings.style;
  GST_OBJECT_UNLOCK (self);
  if (!style.draw_mesh || !self->mesh) {
    mesh = NULL;
  }
  if (!style.draw_uv || !self->mesh || !mapped
      || !gst_buffer_get_cloth_uv (mapped, NULL)) {
    mapped = NULL;
  }
  has_silhouette = style.draw_silhouette
      && gst_buffer_get_cloth_silhouette (views[VIDEO]);
  has_quads = (style.draw_quads || style.draw_indices)
      && gst_buffer_get_cloth_quads (views[VIDEO]);
  has_dots = (style.draw_dots || style.draw_indices)
      && gst_buffer_get_cloth_dots (views[VIDEO]);
  has_matches = style.draw_matches != GST_CLOTH_OVERLAY_MATCHES_NONE
      && gst_buffer_get_cloth_matches (views[VIDEO]);
  has_saddles = style.draw_saddles
      && gst_buffer_get_cloth_saddles (views[VIDEO]);

  if ((mesh || mapped) && (!gst_cloth_overlay_load_rig (self)
          || !gst_cloth_overlay_check_size (self))) {
    return GST_FLOW_ERROR;
  }
  if (mapped) {
    uv = gst_cloth_overlay_find_uv (self, mapped);
  }
  gst_cloth_overlay_count (self, pts);
  gst_cloth_overlay_start_facts (self, pts);
  *out = g_steal_pointer (&views[VIDEO]);
  if (!self->knows_strides
      && !gst_cloth_picture_make_plain (GST_ELEMENT (self), &self->info, out)) {
    return GST_FLOW_ERROR;
  }
  if (!mesh && !uv && !has_silhouette && !has_quads && !has_dots && !has_matches
      && !has_saddles && !style.draw_legend && !style.draw_speed) {
    return GST_FLOW_OK;
  }

  *out = gst_buffer_make_writable (*out);
  if (!gst_cloth_picture_map (GST_ELEMENT (self), &self->info, *out,
          GST_MAP_READWRITE, &frame)) {
    return GST_FLOW_ERROR;
  }
  gst_cloth_overlay_canvas (&frame, &canvas);
  canvas.work = &work;
  if (has_silhouette) {
    gst_cloth_overlay_draw_silhouette (&canvas, GST_VIDEO_FRAME_WIDTH (&frame),
        GST_VIDEO_FRAME_HEIGHT (&frame),
        gst_buffer_get_cloth_silhouette (*out), &style);
  }
  if (has_quads) {
    guint n_quads;
    const GstClothQuad *quads =
        gst_cloth_quads_get_quads (gst_buffer_get_cloth_quads (*out), &n_quads);

    gst_cloth_overlay_draw_quads (&canvas, quads, n_quads, &style);
  }
  if (has_dots) {
    gst_cloth_overlay_draw_dots (&canvas, gst_buffer_get_cloth_dots (*out),
        self->places, &style);
  }
  if (uv) {
    gst_cloth_overlay_draw_uv (&canvas, GST_VIDEO_FRAME_WIDTH (&frame),
        GST_VIDEO_FRAME_HEIGHT (&frame), uv, &style);
  }
  if (has_matches) {
    gst_cloth_overlay_draw_matches (&canvas, GST_VIDEO_FRAME_WIDTH (&frame),
        GST_VIDEO_FRAME_HEIGHT (&frame), gst_buffer_get_cloth_matches (*out),
        self->places, self->cells, &style);
  }
  if (mesh) {
    ret = gst_cloth_overlay_draw_mesh (self, &canvas, mesh, &style);
  }
  if (has_saddles) {
    gst_cloth_overlay_draw_saddles (&canvas,
        gst_buffer_get_cloth_saddles (*out), &style);
  }
  gst_cloth_overlay_draw_legend (&canvas, GST_VIDEO_FRAME_WIDTH (&frame),
      GST_VIDEO_FRAME_HEIGHT (&frame), *out, &self->facts, &style);
  gst_video_frame_unmap (&frame);
  gst_cloth_overlay_tell (self, &work);
  return ret;
}

static gboolean
gst_cloth_overlay_sink_query (GstAggregator * agg, GstAggregatorPad * pad,
    GstQuery * query)
{
  if (GST_QUERY_TYPE (query) == GST_QUERY_CAPS
      && !g_strcmp0 (GST_PAD_NAME (pad), "sink")) {
    gst_cloth_picture_proxy_caps (GST_PAD (pad), GST_AGGREGATOR_SRC_PAD (agg),
        query);
    return TRUE;
  }
  return GST_AGGREGATOR_CLASS (gst_cloth_overlay_parent_class)->sink_query (agg,
      pad, query);
}

static gboolean
gst_cloth_overlay_src_query (GstAggregator * agg, GstQuery * query)
{
  if (GST_QUERY_TYPE (query) == GST_QUERY_CAPS) {
    g_autoptr (GstPad) sink =
        gst_element_get_static_pad (GST_ELEMENT (agg), "sink");

    gst_cloth_picture_proxy_caps (GST_AGGREGATOR_SRC_PAD (agg), sink, query);
    return TRUE;
  }
  return GST_AGGREGATOR_CLASS (gst_cloth_overlay_parent_class)->src_query (agg,
      query);
}

static void
gst_cloth_overlay_send_tags (GstClothOverlay * self)
{
  while (!g_queue_is_empty (&self->tags)) {
    gst_pad_push_event (GST_AGGREGATOR_SRC_PAD (self),
        g_queue_pop_head (&self->tags));
  }
}

/* What was said of the pictures before the first one goes on with it, when the stream has begun. */
static GstPadProbeReturn
pass_tags (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  gst_cloth_overlay_send_tags (data);
  return GST_PAD_PROBE_OK;
}

/* The base class would drop it. */
static gboolean
gst_cloth_overlay_take_tags (GstClothOverlay * self, GstEvent * event)
{
  g_autoptr (GstEvent) segment =
      gst_pad_get_sticky_event (GST_AGGREGATOR_SRC_PAD (self),
      GST_EVENT_SEGMENT, 0);

  g_queue_push_tail (&self->tags, event);
  if (segment) {
    gst_cloth_overlay_send_tags (self);
  }
  return TRUE;
}

static void
gst_cloth_overlay_forget_tags (GstClothOverlay * self)
{
  g_queue_clear_full (&self->tags, (GDestroyNotify) gst_event_unref);
}

/* A picture with much to draw takes its time, and holds the streaming thread. */
static gboolean
gst_cloth_overlay_sink_event (GstAggregator * agg, GstAggregatorPad * pad,
    GstEvent * event)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (agg);

  if (!g_strcmp0 (GST_PAD_NAME (pad), "sink")) {
    if (GST_EVENT_TYPE (event) == GST_EVENT_FLUSH_START) {
      g_atomic_int_set (&self->stopped, TRUE);
    } else if (GST_EVENT_TYPE (event) == GST_EVENT_FLUSH_STOP) {
      g_atomic_int_set (&self->stopped, FALSE);
    } else if (GST_EVENT_TYPE (event) == GST_EVENT_TAG) {
      return gst_cloth_overlay_take_tags (self, event);
    }
  }
  return GST_AGGREGATOR_CLASS (gst_cloth_overlay_parent_class)->sink_event (agg,
      pad, event);
}

static GstStateChangeReturn
gst_cloth_overlay_change_state (GstElement * element, GstStateChange transition)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (element);

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED) {
    g_atomic_int_set (&self->stopped, FALSE);
  } else if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
    g_atomic_int_set (&self->stopped, TRUE);
  }
  return GST_ELEMENT_CLASS (gst_cloth_overlay_parent_class)->change_state
      (element, transition);
}

/* Clicks into a video sink are for the tracker upstream; the base class would drop
 * them. */
static gboolean
gst_cloth_overlay_src_event (GstAggregator * agg, GstEvent * event)
{
  if (GST_EVENT_TYPE (event) == GST_EVENT_NAVIGATION) {
    g_autoptr (GstPad) sink =
        gst_element_get_static_pad (GST_ELEMENT (agg), "sink");

    return gst_pad_push_event (sink, event);
  }
  return GST_AGGREGATOR_CLASS (gst_cloth_overlay_parent_class)->src_event (agg,
      event);
}

static gboolean
gst_cloth_overlay_start (GstAggregator * agg)
{
  GST_CLOTH_OVERLAY (agg)->warned = FALSE;
  GST_CLOTH_OVERLAY (agg)->told_no_uv = FALSE;
  gst_cloth_overlay_reset_count (GST_CLOTH_OVERLAY (agg));
  gst_cloth_damage_reset (&GST_CLOTH_OVERLAY (agg)->settings.damage,
      GST_ELEMENT (agg));
  return GST_AGGREGATOR_CLASS (gst_cloth_overlay_parent_class)->start (agg);
}

static gboolean
gst_cloth_overlay_stop (GstAggregator * agg)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (agg);

  gst_cloth_overlay_forget_tags (self);
  gst_caps_replace (&self->video_caps, NULL);
  g_clear_pointer (&self->mesh, mesh_free);
  self->camera = NULL;
  g_clear_pointer (&self->rig, cloth_rig_free);
  return GST_AGGREGATOR_CLASS (gst_cloth_overlay_parent_class)->stop (agg);
}

/* ---- GObject ---- */

static void
gst_cloth_overlay_set_property (GObject * object, guint id,
    const GValue * value, GParamSpec * pspec)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (object);

  gst_cloth_set_property (object, id, value, pspec);
  GST_OBJECT_LOCK (self);
  self->texture_changed |= g_str_equal (pspec->name, "texture");
  self->rig_changed |= g_str_equal (pspec->name, "rig")
      || g_str_equal (pspec->name, "camera");
  GST_OBJECT_UNLOCK (self);
}

static void
gst_cloth_overlay_finalize (GObject * object)
{
  GstClothOverlay *self = GST_CLOTH_OVERLAY (object);

  gst_cloth_overlay_forget_tags (self);
  gst_caps_replace (&self->video_caps, NULL);
  g_array_unref (self->places);
  g_array_unref (self->cells);
  g_clear_pointer (&self->mesh, mesh_free);
  g_clear_pointer (&self->rig, cloth_rig_free);
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  G_OBJECT_CLASS (gst_cloth_overlay_parent_class)->finalize (object);
}

static void
gst_cloth_overlay_class_init (GstClothOverlayClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstAggregatorClass *agg_class = GST_AGGREGATOR_CLASS (klass);
  GstClothSyncClass *sync_class = GST_CLOTH_SYNC_CLASS (klass);

  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstClothOverlay,
          settings));
  object_class->set_property = gst_cloth_overlay_set_property;
  object_class->finalize = gst_cloth_overlay_finalize;
  agg_class->decide_allocation = gst_cloth_overlay_decide_allocation;
  agg_class->sink_query = gst_cloth_overlay_sink_query;
  element_class->change_state = gst_cloth_overlay_change_state;
  agg_class->sink_event = gst_cloth_overlay_sink_event;
  agg_class->src_query = gst_cloth_overlay_src_query;
  agg_class->src_event = gst_cloth_overlay_src_event;
  agg_class->start = gst_cloth_overlay_start;
  agg_class->stop = gst_cloth_overlay_stop;
  sync_class->set_pad_caps = gst_cloth_overlay_set_pad_caps;
  sync_class->negotiate_src = gst_cloth_overlay_negotiate_src;
  sync_class->process_set = gst_cloth_overlay_process_set;

  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &sink_template, GST_TYPE_CLOTH_SYNC_PAD);
  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &mesh_template, GST_TYPE_CLOTH_SYNC_PAD);
  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &src_template, GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_set_static_metadata (element_class, "Cloth overlay",
      "Filter/Effect/Video",
      "Draws silhouettes, saddles, squares, labelled dots, matches, meshes and "
      "their distance from a simulation", "The gst-cloth developers");
}

static void
gst_cloth_overlay_init (GstClothOverlay * self)
{
  self->settings = defaults;
  self->places = g_array_new (FALSE, FALSE, sizeof (guint64));
  self->cells = g_array_new (FALSE, FALSE, sizeof (gfloat));
  gst_cloth_damage_watch (&self->settings.damage, GST_ELEMENT (self),
      GST_AGGREGATOR_SRC_PAD (self));
  g_queue_init (&self->tags);
  gst_pad_add_probe (GST_AGGREGATOR_SRC_PAD (self), GST_PAD_PROBE_TYPE_BUFFER,
      pass_tags, self, NULL);
  gst_cloth_sync_add_always_pad (GST_CLOTH_SYNC (self), "sink");
}
