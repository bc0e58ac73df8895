/* Panels as they are drawn: outlines of named edges in an SVG file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

/* @name: its id, or a number
 * @seam: (nullable): name of its seam
 * @points: (element-type gdouble): x and y of its points, metres, in the direction of the
 *   outline
 * @length_m: its length, metres
 */
typedef struct {
  gchar *name;
  gchar *seam;
  GArray *points;
  gdouble length_m;
} ClothDrawnEdge;

/* @name: its id
 * @edges: (element-type ClothDrawnEdge): its outline: each edge begins where the one
 *   before ends; counter-clockwise as seen on the page
 */
typedef struct {
  gchar *name;
  GArray *edges;
} ClothDrawnPanel;

GArray *cloth_panels_parse (const gchar * svg, gsize size, GError ** error);

G_END_DECLS
