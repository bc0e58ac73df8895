/* PLY: writing one frame of a mesh with what is known of each vertex.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/export.h"
#include "gst/mesh/formats/ply.h"

#include <math.h>
#include <string.h>

static guint8 *
put_float (guint8 * to, gfloat value)
{
  cloth_swap_little_endian (&value, sizeof value, 1);
  memcpy (to, &value, sizeof value);
  return to + sizeof value;
}

static guint8 *
put_index (guint8 * to, guint32 value)
{
  cloth_swap_little_endian (&value, sizeof value, 1);
  memcpy (to, &value, sizeof value);
  return to + sizeof value;
}

/* @output: where to
 * @topology: faces and uv
 * @positions: 3 finite numbers a vertex
 * @states: a #ClothVertexState a vertex
 * @covariances: (nullable): 6 numbers a vertex, m²
 * @fps_n: numerator of the frame rate, 0 when it varies
 * @fps_d: its denominator
 * @scratch: reused from frame to frame
 * @error: #GIOErrorEnum
 *
 * Writes binary little-endian. Properties of a vertex: x y z, s t (uv), state; with
 * covariances also `quality` = standard deviation in metres (RMS of the axes; the
 * scalar that viewers colour by; 0 where not known) and cov_xx to cov_zz.
 *
 * Returns: %TRUE when all was taken
 */
gboolean
cloth_ply_write (ClothOutput * output, const ClothTopology * topology,
    const gfloat * positions, const guint8 * states,
    const gfloat * covariances, gint fps_n, gint fps_d, GByteArray * scratch,
    GError ** error)
{
  g_autofree gchar *note = cloth_mesh_note_format (topology, fps_n, fps_d);
  gsize n_vertices = topology->n_vertices, n_faces = topology->n_faces;
  gsize vertex_size = covariances ? 49 : 21;
  guint8 *to;

  if (!cloth_output_printf (output, error, "ply\n"
          "format binary_little_endian 1.0\ncomment %s\n"
          "comment metres, z up; uv (s, t) in metres; state 0 unseen "
          "(position held), 1 measured, 2 two views, 3 filled, 4 predicted\n"
          "element vertex %u\nproperty float x\nproperty float y\n"
          "property float z\nproperty float s\nproperty float t\n"
          "property uchar state\n%selement face %u\n"
          "property list uchar uint vertex_indices\nend_header\n",
          note, topology->n_vertices, covariances ?
          "property float quality\nproperty float cov_xx\n"
          "property float cov_xy\nproperty float cov_xz\n"
          "property float cov_yy\nproperty float cov_yz\n"
          "property float cov_zz\n" : "", topology->n_faces))
    return FALSE;
  g_byte_array_set_size (scratch, (guint) (n_vertices * vertex_size +
          n_faces * 17));
  to = scratch->data;
  for (gsize i = 0; i < n_vertices; i++) {
    for (guint k = 0; k < 3; k++)
      to = put_float (to, positions[3 * i + k]);
    for (guint k = 0; k < 2; k++)
      to = put_float (to, topology->uv[2 * i + k]);
    *to++ = states[i];
    if (covariances) {
      gfloat sigma = cloth_export_sigma (covariances + 6 * i);

      to = put_float (to, isnan (sigma) ? 0 : sigma);
      for (guint k = 0; k < 6; k++)
        to = put_float (to, covariances[6 * i + k]);
    }
  }
  for (gsize i = 0; i < n_faces; i++) {
    const guint32 *face = topology->faces + 4 * i;
    guint n = cloth_face_corners (face);

    *to++ = (guint8) n;
    for (guint k = 0; k < n; k++)
      to = put_index (to, face[k]);
  }
  return cloth_output_write (output, scratch->data,
      (gsize) (to - scratch->data), error);
}
