/* A mesh drawn into a camera's picture as lines.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>
#include "gst/rig/camera.h"
#include "gst/render/draw.h"

G_BEGIN_DECLS

/* The edges and faces of one mesh, with the buffers that drawing it needs.
 */
typedef struct _ClothWireframe ClothWireframe;

/* @n_colours: colours, at least 1
 * @colours: one for every vertex state; a state beyond them takes the last
 * @width: of a line, px
 * @opacity: of the lines, 0 … 1
 * @hidden_opacity: of those behind another part of the mesh; times @opacity
 * @fill_opacity: of the faces, each in the mean colour of its corners; those behind
 *   another part of the mesh or with a corner that is not known are not filled
 */
typedef struct {
  guint n_colours;
  const ClothColour *colours;
  gfloat width;
  gfloat opacity;
  gfloat hidden_opacity;
  gfloat fill_opacity;
} ClothWireStyle;

ClothWireframe *cloth_wireframe_new (guint n_vertices, guint columns,
    guint rows, const guint32 * faces, guint n_faces);
void cloth_wireframe_free (ClothWireframe * wire);
guint cloth_wireframe_get_n_edges (const ClothWireframe * wire);
void cloth_wireframe_draw (ClothWireframe * wire, const ClothCanvas * canvas,
    gint width, gint height, const ClothCamera * camera,
    const gfloat * positions, const guint8 * states,
    const ClothWireStyle * style);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothWireframe, cloth_wireframe_free)
G_END_DECLS
