/* What several heads know of a cloth's vertices becomes one mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"
#include "gst/vision/uv/vertex.h"

G_BEGIN_DECLS

/* Most heads. */
#define CLOTH_UV_MAX_HEADS 16

/* @vertices: (not nullable): of the head's own camera frame
 * @R: from the world into that frame: x = R·X + t
 * @t: m
 * @n_cameras: that its surface rests on
 */
typedef struct {
  const ClothUVVertex *vertices;
  gdouble R[9], t[3];
  guint n_cameras;
} ClothUVHead;

/* @n_seen: vertices that are known
 * @n_joined: of them those that two or more heads agree on
 * @n_contradicted: vertices of two heads that are unseen because these contradict each other
 * @n_left_out: views that were left out because two or more others contradict them
 */
typedef struct {
  guint n_seen, n_joined, n_contradicted, n_left_out;
} ClothUVJoined;

void cloth_uv_join (const ClothUVHead * heads, guint n_heads,
    guint n_vertices, gdouble significance, gfloat * positions,
    guint8 * states, gfloat * covariances, ClothUVJoined * joined);

G_END_DECLS
