/* clothoverlay: a mesh into a video frame, as lines, heat map or printed surface.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothoverlay-draw.h"
#include "elements/gstclothpaint.h"

#include "gst/render/surface.h"
#include "gst/render/wireframe.h"

/* Of the lines of a mesh that lie behind another part of it. */
#define HIDDEN_OPACITY 0.25f
/* Of the heat map: the film shows through. */
#define HEAT_OPACITY 0.6f

/* by GstClothVertexState */
static const ClothColour vertex_colours[] = {
  {0.55f, 0.55f, 0.55f, 1},     /* unseen */
  {0.20f, 0.85f, 0.45f, 1},     /* measured: green */
  {1.00f, 0.72f, 0.15f, 1},     /* two views: amber */
  {0.25f, 0.60f, 1.00f, 1},     /* filled: blue */
  {0.75f, 0.45f, 1.00f, 1}      /* predicted: violet */
};

struct _GstClothOverlayMesh
{
  GstClothTopology *topology;
  ClothWireframe *wire;
  ClothSurface *surface;        /* NULL until it is drawn */
  guint8 *heats;                /* one a vertex */
};

GType
gst_cloth_overlay_mesh_style_get_type (void)
{
  static gsize type = 0;
  static const GEnumValue values[] = {
    {GST_CLOTH_OVERLAY_MESH_WIREFRAME, "Lines, coloured by what is known of "
          "each vertex", "wireframe"},
    {GST_CLOTH_OVERLAY_MESH_SHADED, "Surface in light and shade, with texture "
          "if there is one", "shaded"},
    {0, NULL, NULL}
  };

  if (g_once_init_enter (&type))
    g_once_init_leave (&type,
        g_enum_register_static ("GstClothOverlayMeshStyle", values));
  return type;
}

GstClothOverlayMesh *
gst_cloth_overlay_mesh_new (GstClothTopology * topology)
{
  GstClothOverlayMesh *self = g_new0 (GstClothOverlayMesh, 1);
  guint n_indices;
  const guint32 *faces = gst_cloth_topology_get_faces (topology, &n_indices);
  const guint n_vertices = gst_cloth_topology_get_n_vertices (topology);

  self->topology = gst_cloth_topology_ref (topology);
  self->heats = g_malloc (n_vertices);
  self->wire = cloth_wireframe_new (n_vertices,
      gst_cloth_topology_get_columns (topology),
      gst_cloth_topology_get_rows (topology), faces, n_indices / 4);
  return self;
}

void
gst_cloth_overlay_mesh_free (GstClothOverlayMesh * self)
{
  if (!self) {
    return;
  }
  gst_cloth_topology_unref (self->topology);
  cloth_wireframe_free (self->wire);
  cloth_surface_free (self->surface);
  g_free (self->heats);
  g_free (self);
}

guint
gst_cloth_overlay_mesh_get_n_vertices (const GstClothOverlayMesh * self)
{
  return gst_cloth_topology_get_n_vertices (self->topology);
}

/* Puts @texture on the surface, or plain white when it is NULL. */
gboolean
gst_cloth_overlay_mesh_print (GstClothOverlayMesh * self,
    const gchar * texture, GError ** error)
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

gboolean
gst_cloth_overlay_mesh_is_printed (const GstClothOverlayMesh * self)
{
  return self->surface != NULL;
}

void
gst_cloth_overlay_mesh_draw (GstClothOverlayMesh * self,
    const ClothCanvas * canvas, gint width, gint height,
    const ClothCamera * camera, GstClothMesh * mesh, GstClothGap * gap,
    const GstClothOverlayStyle * style)
{
  ClothWireStyle wire_style = {
    G_N_ELEMENTS (vertex_colours), vertex_colours, style->line_width,
    style->opacity, HIDDEN_OPACITY, 0
  };
  const gfloat *positions = gst_cloth_mesh_get_positions (mesh, NULL);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);
  const gboolean hot = gap && gst_cloth_gap_get_n_vertices (gap) ==
      gst_cloth_overlay_mesh_get_n_vertices (self);

  if (hot) {
    gst_cloth_overlay_heat (gap, style->gap_scale, self->heats);
    states = self->heats;
    wire_style.n_colours = GST_CLOTH_OVERLAY_HEATS;
    wire_style.colours = gst_cloth_overlay_heat_colours ();
    wire_style.fill_opacity = HEAT_OPACITY * style->opacity;
  } else if (style->mesh_style == GST_CLOTH_OVERLAY_MESH_SHADED) {
    ClothRenderStyle light;

    cloth_render_style_init (&light);
    cloth_surface_draw (self->surface, canvas, width, height, camera,
        positions, &light, style->opacity);
    return;
  }
  cloth_wireframe_draw (self->wire, canvas, width, height, camera, positions,
      states, &wire_style);
  if (hot) {
    gst_cloth_overlay_draw_scale (canvas, width, height, style);
  }
}
