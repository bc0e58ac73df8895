/* The mesh stream, application/x-cloth-mesh: caps, topology, one buffer a frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GST_CLOTH_MESH_MEDIA_TYPE:
 *
 * Media type of a mesh stream, in its caps.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MESH_MEDIA_TYPE "application/x-cloth-mesh"

/**
 * GST_CLOTH_MESH_CAPS:
 *
 * Template caps of a mesh stream. Caps on a pad also carry the topology as streamheader.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MESH_CAPS GST_CLOTH_MESH_MEDIA_TYPE ", version=(int)1, " \
    "vertices=(int)[ 1, 1000000 ], framerate=(fraction)[ 0/1, max ]"

/**
 * GST_CLOTH_NO_VERTEX:
 *
 * Stands for the absent fourth vertex of a triangle.
 *
 * Since: 0.1
 */
#define GST_CLOTH_NO_VERTEX ((guint32) 0xffffffff)

/**
 * GstClothTopology:
 *
 * What stays the same over a mesh stream: faces, and where each vertex lies on the flat cloth.
 * Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothTopology GstClothTopology;

/**
 * GstClothMesh:
 *
 * One frame of a mesh stream: a position, a state and perhaps a covariance of each vertex of a
 * #GstClothTopology. Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothMesh GstClothMesh;

/**
 * GstClothVertexState:
 * @GST_CLOTH_VERTEX_UNSEEN: not known; its position is NaN
 * @GST_CLOTH_VERTEX_MEASURED: three or more views agree
 * @GST_CLOTH_VERTEX_TWO_VIEWS: two views: no view left to check it
 * @GST_CLOTH_VERTEX_FILLED: interpolated from its neighbourhood
 * @GST_CLOTH_VERTEX_PREDICTED: carried on in time or simulated
 *
 * What a vertex's position rests on.
 *
 * Since: 0.1
 */
typedef enum {
  GST_CLOTH_VERTEX_UNSEEN,
  GST_CLOTH_VERTEX_MEASURED,
  GST_CLOTH_VERTEX_TWO_VIEWS,
  GST_CLOTH_VERTEX_FILLED,
  GST_CLOTH_VERTEX_PREDICTED
} GstClothVertexState;

#define GST_TYPE_CLOTH_TOPOLOGY (gst_cloth_topology_get_type ())
#define GST_TYPE_CLOTH_MESH (gst_cloth_mesh_get_type ())

GST_CLOTH_API GType gst_cloth_topology_get_type (void);
GST_CLOTH_API GstClothTopology *gst_cloth_topology_new (guint n_vertices,
    guint columns, guint rows, const gfloat * uv, const guint32 * faces,
    guint n_faces, GError ** error);
GST_CLOTH_API GstClothTopology *gst_cloth_topology_new_from_arrays (guint columns,
    guint rows, const gfloat * uv, guint n_floats, const guint32 * faces,
    guint n_indices, GError ** error);
GST_CLOTH_API GstClothTopology *gst_cloth_topology_new_grid (guint columns,
    guint rows, gfloat width_m, gfloat height_m, GError ** error);
GST_CLOTH_API GstClothTopology *gst_cloth_topology_ref (GstClothTopology * topology);
GST_CLOTH_API void gst_cloth_topology_unref (GstClothTopology * topology);
GST_CLOTH_API guint gst_cloth_topology_get_n_vertices (const GstClothTopology * topology);
GST_CLOTH_API guint gst_cloth_topology_get_columns (const GstClothTopology * topology);
GST_CLOTH_API guint gst_cloth_topology_get_rows (const GstClothTopology * topology);
GST_CLOTH_API guint gst_cloth_topology_get_n_faces (const GstClothTopology * topology);
GST_CLOTH_API const gfloat *gst_cloth_topology_get_uv (const GstClothTopology * topology, guint * n_floats);
GST_CLOTH_API const guint32 *gst_cloth_topology_get_faces (const GstClothTopology * topology, guint * n_indices);
GST_CLOTH_API GstBuffer *gst_cloth_topology_to_buffer (const GstClothTopology * topology);
GST_CLOTH_API GstClothTopology *gst_cloth_topology_from_buffer (GstBuffer * buffer, GError ** error);
GST_CLOTH_API GstCaps *gst_cloth_topology_to_caps (const GstClothTopology * topology, gint fps_n, gint fps_d);
GST_CLOTH_API GstClothTopology *gst_cloth_topology_from_caps (const GstCaps * caps, GError ** error);

GST_CLOTH_API GType gst_cloth_mesh_get_type (void);
GST_CLOTH_API GstClothMesh *gst_cloth_mesh_new (guint64 sequence,
    guint n_vertices, const gfloat * positions, const guint8 * states,
    const gfloat * covariances);
GST_CLOTH_API GstClothMesh *gst_cloth_mesh_new_from_arrays (guint64 sequence,
    const gfloat * positions, guint n_positions, const guint8 * states,
    guint n_states, const gfloat * covariances, guint n_covariances,
    GError ** error);
GST_CLOTH_API GstClothMesh *gst_cloth_mesh_ref (GstClothMesh * mesh);
GST_CLOTH_API void gst_cloth_mesh_unref (GstClothMesh * mesh);
GST_CLOTH_API guint64 gst_cloth_mesh_get_sequence (const GstClothMesh * mesh);
GST_CLOTH_API guint gst_cloth_mesh_get_n_vertices (const GstClothMesh * mesh);
GST_CLOTH_API const gfloat *gst_cloth_mesh_get_positions (const GstClothMesh * mesh, guint * n_floats);
GST_CLOTH_API GBytes *gst_cloth_mesh_get_points (GstClothMesh * mesh);
GST_CLOTH_API const guint8 *gst_cloth_mesh_get_states (const GstClothMesh * mesh, guint * n_states);
GST_CLOTH_API const gfloat *gst_cloth_mesh_get_covariances (const GstClothMesh * mesh, guint * n_floats);
GST_CLOTH_API GstBuffer *gst_cloth_mesh_to_buffer (const GstClothMesh * mesh);
GST_CLOTH_API GstClothMesh *gst_cloth_mesh_from_buffer (GstBuffer * buffer, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothTopology, gst_cloth_topology_unref)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothMesh, gst_cloth_mesh_unref)
G_END_DECLS
