/* The gap of one mesh between recording and simulation, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothgap.h"
#include "gst/cloth/gstclothpayload.h"

/* The standard deviations follow the residuals. */
struct _GstClothGap
{
  GstClothPayload payload;
  guint n_vertices;
  gfloat residuals[];
};

G_STATIC_ASSERT (sizeof (GstClothGapMeta) == sizeof (GstClothPayloadMeta));

G_DEFINE_BOXED_TYPE (GstClothGap, gst_cloth_gap, gst_cloth_gap_ref,
    gst_cloth_gap_unref);

/**
 * gst_cloth_gap_new: (skip)
 * @sequence: number of the frame, that of its mesh, or of the picture of one camera
 * @n_vertices: vertices, 1 to #GST_CLOTH_MAX_VERTICES
 * @residuals: 3·@n_vertices floats: recorded minus simulated position of each vertex,
 *   metres, world frame; NaN where it was not seen; copied
 * @sigmas: (nullable): @n_vertices floats: standard deviation of a coordinate of the
 *   recorded position, metres; NaN where not known; copied
 *
 * How far a mesh is from what a simulation makes of it; of a picture of one camera, what
 * of that lies across the sight, where its deviation counts, too. A vertex is known in full or not
 * at all: where a coordinate isn't finite, the copy's three are NaN. A standard
 * deviation that isn't finite or is below 0 becomes NaN.
 *
 * Returns: (transfer full): a new gap, immutable
 *
 * Since: 0.1
 */
GstClothGap *
gst_cloth_gap_new (guint64 sequence, guint n_vertices,
    const gfloat * residuals, const gfloat * sigmas)
{
  GstClothGap *gap;
  gfloat *deviations;

  g_return_val_if_fail (residuals != NULL, NULL);
  g_return_val_if_fail (n_vertices >= 1
      && n_vertices <= GST_CLOTH_MAX_VERTICES, NULL);

  gap = gst_cloth_payload_new (sizeof *gap + 4 * sizeof (gfloat)
      * (gsize) n_vertices, NULL, sequence, NULL);
  gap->n_vertices = n_vertices;
  deviations = gap->residuals + 3 * (gsize) n_vertices;
  for (gsize i = 0; i < n_vertices; i++) {
    const gfloat *from = residuals + 3 * i;
    gfloat *to = gap->residuals + 3 * i;
    gboolean seen = isfinite (from[0]) && isfinite (from[1])
        && isfinite (from[2]);

    for (guint k = 0; k < 3; k++)
      to[k] = seen ? from[k] : NAN;
    deviations[i] = sigmas && isfinite (sigmas[i]) && sigmas[i] >= 0 ?
        sigmas[i] : NAN;
  }
  return gap;
}

/**
 * gst_cloth_gap_new_from_arrays: (rename-to gst_cloth_gap_new)
 * @sequence: number of the frame, that of its mesh
 * @residuals: (array length=n_residuals): recorded minus simulated position of each
 *   vertex, metres
 * @n_residuals: three times the vertices
 * @sigmas: (array length=n_sigmas) (nullable): standard deviation of a recorded
 *   coordinate of each vertex, metres
 * @n_sigmas: the vertices
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * gst_cloth_gap_new() for languages whose arrays know their length.
 *
 * Returns: (transfer full): a new gap; %NULL with @error set when the lengths don't
 *   agree
 *
 * Since: 0.1
 */
GstClothGap *
gst_cloth_gap_new_from_arrays (guint64 sequence, const gfloat * residuals,
    guint n_residuals, const gfloat * sigmas, guint n_sigmas, GError ** error)
{
  guint n = n_residuals / 3;

  if (n < 1 || n > GST_CLOTH_MAX_VERTICES || n_residuals != 3 * n
      || (sigmas && n_sigmas != n)) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "%u floats of residuals and %u standard deviations; give 3 and 1 (or "
        "none) a vertex, of 1 to %d vertices", n_residuals, n_sigmas,
        GST_CLOTH_MAX_VERTICES);
    return NULL;
  }
  return gst_cloth_gap_new (sequence, n, residuals, sigmas);
}

/**
 * gst_cloth_gap_ref:
 * @gap: a gap
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothGap *
gst_cloth_gap_ref (GstClothGap * gap)
{
  return g_atomic_rc_box_acquire (gap);
}

/**
 * gst_cloth_gap_unref:
 * @gap: (transfer full): a gap
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_gap_unref (GstClothGap * gap)
{
  gst_cloth_payload_release (gap);
}

/**
 * gst_cloth_gap_get_sequence:
 * @gap: a gap
 *
 * Returns: number of the frame
 *
 * Since: 0.1
 */
guint64
gst_cloth_gap_get_sequence (const GstClothGap * gap)
{
  return gap->payload.sequence;
}

/**
 * gst_cloth_gap_get_n_vertices:
 * @gap: a gap
 *
 * Returns: vertices
 *
 * Since: 0.1
 */
guint
gst_cloth_gap_get_n_vertices (const GstClothGap * gap)
{
  return gap->n_vertices;
}

/**
 * gst_cloth_gap_get_residuals:
 * @gap: a gap
 * @n_floats: (out) (optional): three times the vertices
 *
 * Returns: (array length=n_floats) (transfer none): recorded minus simulated position of
 *   each vertex, metres, world frame; all three NaN where it was not seen; valid as long
 *   as @gap is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_gap_get_residuals (const GstClothGap * gap, guint * n_floats)
{
  if (n_floats)
    *n_floats = 3 * gap->n_vertices;
  return gap->residuals;
}

/**
 * gst_cloth_gap_get_sigmas:
 * @gap: a gap
 * @n_floats: (out) (optional): the vertices
 *
 * Returns: (array length=n_floats) (transfer none): standard deviation of a coordinate
 *   of each recorded position, metres; NaN where not known; valid as long as @gap is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_gap_get_sigmas (const GstClothGap * gap, guint * n_floats)
{
  if (n_floats)
    *n_floats = gap->n_vertices;
  return gap->residuals + 3 * (gsize) gap->n_vertices;
}

/**
 * gst_cloth_gap_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_gap_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothGapMetaAPI", FALSE);
}

/**
 * gst_cloth_gap_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_gap_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_gap_meta_api_get_type (), "GstClothGapMeta");
}

/**
 * gst_buffer_add_cloth_gap_meta:
 * @buffer: a writable buffer
 * @gap: (transfer full): of its mesh
 *
 * Puts @gap on @buffer, in place of the one it may have had.
 *
 * Returns: (transfer none): the meta that now holds @gap
 *
 * Since: 0.1
 */
GstClothGapMeta *
gst_buffer_add_cloth_gap_meta (GstBuffer * buffer, GstClothGap * gap)
{
  return gst_cloth_payload_attach (gap, buffer, gst_cloth_gap_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_gap:
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the gap on @buffer, owned by it; %NULL when it
 *   has none
 *
 * Since: 0.1
 */
GstClothGap *
gst_buffer_get_cloth_gap (GstBuffer * buffer)
{
  return gst_cloth_payload_find (buffer, gst_cloth_gap_meta_api_get_type ());
}
