/* Garments: panels cut from printed cloth and sewn together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* Vertex of a garment that has no dot: it lies on an outline. */
#define CLOTH_NO_DOT (-1)

/* @columns: dots in a row
 * @rows: dots in a column
 * @pitch_m: from the centre of a dot to that of the next, metres
 * @origin_m: centre of the first dot from the top-left corner of the cloth, metres
 * @cloth_m: width and height of the printed cloth, metres
 *
 * The lattice of a printed M-array.
 */
typedef struct {
  guint columns;
  guint rows;
  gdouble pitch_m;
  gdouble origin_m[2];
  gdouble cloth_m[2];
} ClothDotGrid;

/* @name: its name
 * @first: its first vertex
 * @n_vertices: how many vertices it has, from @first on; those of the outline come first,
 *   in the order of the outline
 * @n_border: how many of them lie on the outline
 */
typedef struct {
  gchar *name;
  guint first;
  guint n_vertices;
  guint n_border;
} ClothPanel;

/* @topology: all panels in one mesh; uv in metres on the printed cloth from its top-left
 *   corner; dots make quads where four are neighbours, the rest up to the outline is
 *   triangles
 * @dots: for each vertex which dot it is, row · columns + column, or %CLOTH_NO_DOT
 * @columns: dots in a row of the print
 * @rows: dots in a column
 * @panels: (element-type ClothPanel): the panels
 * @seam_names: (element-type utf8): names of the seams
 * @seams: (element-type ClothSeamLine): the seams, in the form of take.json's
 *
 * Vertices at a seam are there once for each panel, as they have two places on the flat
 * cloth; the seams say which of them are one.
 */
typedef struct {
  ClothTopology *topology;
  gint *dots;
  guint columns;
  guint rows;
  GArray *panels;
  GPtrArray *seam_names;
  GArray *seams;
} ClothGarment;

ClothGarment *cloth_garment_new_from_svg (const gchar * svg, gsize size,
    const ClothDotGrid * grid, GError ** error);
ClothGarment *cloth_garment_new (void);
ClothGarment *cloth_garment_parse (const gchar * json, gsize size,
    ClothTopology * topology, GError ** error);
ClothGarment *cloth_garment_load (const gchar * path, GError ** error);
gchar *cloth_garment_to_json (const ClothGarment * garment);
gboolean cloth_garment_save (const ClothGarment * garment,
    const gchar * folder, GError ** error);
void cloth_garment_free (ClothGarment * garment);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGarment, cloth_garment_free)
G_END_DECLS
