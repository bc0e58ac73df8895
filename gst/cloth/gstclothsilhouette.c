/* The silhouette of the cloth in one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cloth/gstclothsilhouette.h"
#include "gst/cloth/gstclothpayload.h"

struct _GstClothSilhouette
{
  GstClothPayload payload;
  guint width, height, n_runs;
  GstClothRun runs[];
};

G_STATIC_ASSERT (sizeof (GstClothSilhouetteMeta) ==
    sizeof (GstClothPayloadMeta));

G_DEFINE_BOXED_TYPE (GstClothRun, gst_cloth_run, gst_cloth_run_copy,
    gst_cloth_run_free);
G_DEFINE_BOXED_TYPE (GstClothSilhouette, gst_cloth_silhouette,
    gst_cloth_silhouette_ref, gst_cloth_silhouette_unref);

/**
 * gst_cloth_run_copy:
 * @run: a run
 *
 * Returns: (transfer full): a copy
 *
 * Since: 0.1
 */
GstClothRun *
gst_cloth_run_copy (const GstClothRun * run)
{
  return g_memdup2 (run, sizeof *run);
}

/**
 * gst_cloth_run_free:
 * @run: (transfer full): a run
 *
 * Frees a copy.
 *
 * Since: 0.1
 */
void
gst_cloth_run_free (GstClothRun * run)
{
  g_free (run);
}

/**
 * gst_cloth_silhouette_runs_are_valid:
 * @width: columns
 * @height: rows
 * @runs: (array length=n_runs) (nullable): runs
 * @n_runs: how many
 *
 * Returns: whether a silhouette of 1 to #GST_CLOTH_MAX_SILHOUETTE_SIZE pixels each way may
 *   consist of @runs: at most #GST_CLOTH_MAX_RUNS of them, none empty or beyond its size, by
 *   row and column, no two with a pixel in common
 *
 * Since: 0.1
 */
gboolean
gst_cloth_silhouette_runs_are_valid (guint width, guint height,
    const GstClothRun * runs, guint n_runs)
{
  if (width < 1 || height < 1 || width > GST_CLOTH_MAX_SILHOUETTE_SIZE
      || height > GST_CLOTH_MAX_SILHOUETTE_SIZE || n_runs > GST_CLOTH_MAX_RUNS
      || (n_runs > 0 && runs == NULL))
    return FALSE;
  for (guint i = 0; i < n_runs; i++)
    if (runs[i].row >= height || runs[i].begin >= runs[i].end
        || runs[i].end > width || (i > 0 && (runs[i].row < runs[i - 1].row
                || (runs[i].row == runs[i - 1].row
                    && runs[i].begin < runs[i - 1].end))))
      return FALSE;
  return TRUE;
}

/**
 * gst_cloth_silhouette_new:
 * @camera: (nullable): name of the camera in the rig, UTF-8 of at most
 *   #GST_CLOTH_MAX_CAMERA_NAME bytes; %NULL or "" when it isn't known
 * @sequence: number of the frame, counted by the camera
 * @width: columns of the picture that was looked at
 * @height: its rows
 * @runs: (array length=n_runs) (nullable): what of it is cloth, copied;
 *   gst_cloth_silhouette_runs_are_valid() says what they must be like
 * @n_runs: how many
 *
 * Where the cloth is in one picture. Immutable; no runs mean that no cloth was seen.
 *
 * Returns: (transfer full): a new silhouette
 *
 * Since: 0.1
 */
GstClothSilhouette *
gst_cloth_silhouette_new (const gchar * camera, guint64 sequence, guint width,
    guint height, const GstClothRun * runs, guint n_runs)
{
  GstClothSilhouette *silhouette;

  g_return_val_if_fail (gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (gst_cloth_silhouette_runs_are_valid (width, height,
          runs, n_runs), NULL);

  silhouette = gst_cloth_payload_new (sizeof *silhouette
      + n_runs * sizeof *runs, camera, sequence, gst_cloth_payload_keep_size);
  if (!silhouette)
    return NULL;
  silhouette->width = width;
  silhouette->height = height;
  silhouette->n_runs = n_runs;
  if (n_runs)
    memcpy (silhouette->runs, runs, n_runs * sizeof *runs);
  return silhouette;
}

/**
 * gst_cloth_silhouette_ref:
 * @silhouette: a silhouette
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothSilhouette *
gst_cloth_silhouette_ref (GstClothSilhouette * silhouette)
{
  return g_atomic_rc_box_acquire (silhouette);
}

/**
 * gst_cloth_silhouette_unref:
 * @silhouette: (transfer full): a silhouette
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_silhouette_unref (GstClothSilhouette * silhouette)
{
  gst_cloth_payload_release (silhouette);
}

/**
 * gst_cloth_silhouette_get_camera:
 * @silhouette: a silhouette
 *
 * Returns: (transfer none): name of the camera, "" when it isn't known
 *
 * Since: 0.1
 */
const gchar *
gst_cloth_silhouette_get_camera (const GstClothSilhouette * silhouette)
{
  return silhouette->payload.camera;
}

/**
 * gst_cloth_silhouette_get_sequence:
 * @silhouette: a silhouette
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.1
 */
guint64
gst_cloth_silhouette_get_sequence (const GstClothSilhouette * silhouette)
{
  return silhouette->payload.sequence;
}

/**
 * gst_cloth_silhouette_get_width:
 * @silhouette: a silhouette
 *
 * Returns: columns of the picture that was looked at; the one that carries the silhouette
 *   may have been scaled since
 *
 * Since: 0.1
 */
guint
gst_cloth_silhouette_get_width (const GstClothSilhouette * silhouette)
{
  return silhouette->width;
}

/**
 * gst_cloth_silhouette_get_height:
 * @silhouette: a silhouette
 *
 * Returns: rows of the picture that was looked at
 *
 * Since: 0.1
 */
guint
gst_cloth_silhouette_get_height (const GstClothSilhouette * silhouette)
{
  return silhouette->height;
}

/**
 * gst_cloth_silhouette_get_n_runs:
 * @silhouette: a silhouette
 *
 * Returns: how many runs there are
 *
 * Since: 0.1
 */
guint
gst_cloth_silhouette_get_n_runs (const GstClothSilhouette * silhouette)
{
  return silhouette->n_runs;
}

/**
 * gst_cloth_silhouette_get_runs:
 * @silhouette: a silhouette
 * @n_runs: (out) (optional): how many
 *
 * Returns: (array length=n_runs) (transfer none): the runs, by row and column, valid as
 *   long as @silhouette is
 *
 * Since: 0.1
 */
const GstClothRun *
gst_cloth_silhouette_get_runs (const GstClothSilhouette * silhouette,
    guint * n_runs)
{
  if (n_runs)
    *n_runs = silhouette->n_runs;
  return silhouette->runs;
}

/**
 * gst_cloth_silhouette_get_run:
 * @silhouette: a silhouette
 * @index: which run
 * @run: (out caller-allocates): its copy
 *
 * Returns: %FALSE when @index is past the end
 *
 * Since: 0.1
 */
gboolean
gst_cloth_silhouette_get_run (const GstClothSilhouette * silhouette,
    guint index, GstClothRun * run)
{
  if (index >= silhouette->n_runs)
    return FALSE;
  *run = silhouette->runs[index];
  return TRUE;
}

/**
 * gst_cloth_silhouette_get_area:
 * @silhouette: a silhouette
 *
 * Returns: how many pixels are cloth
 *
 * Since: 0.1
 */
guint
gst_cloth_silhouette_get_area (const GstClothSilhouette * silhouette)
{
  guint area = 0;

  for (guint i = 0; i < silhouette->n_runs; i++)
    area += (guint) (silhouette->runs[i].end - silhouette->runs[i].begin);
  return area;
}

/**
 * gst_cloth_silhouette_get_mask:
 * @silhouette: a silhouette
 *
 * The silhouette as a picture of bytes, shape (height, width): 255 where there is cloth, else
 * 0. From Python: `numpy.frombuffer (silhouette.get_mask ().get_data (),
 * numpy.uint8).reshape (silhouette.get_height (), silhouette.get_width ())`.
 *
 * Returns: (transfer full): width times height bytes
 *
 * Since: 0.1
 */
GBytes *
gst_cloth_silhouette_get_mask (const GstClothSilhouette * silhouette)
{
  const gsize size = (gsize) silhouette->width * silhouette->height;
  guint8 *mask = g_malloc0 (size);

  for (guint i = 0; i < silhouette->n_runs; i++) {
    const GstClothRun run = silhouette->runs[i];

    memset (mask + (gsize) run.row * silhouette->width + run.begin, 255,
        (gsize) (run.end - run.begin));
  }
  return g_bytes_new_take (mask, size);
}

/**
 * gst_cloth_silhouette_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_silhouette_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothSilhouetteMetaAPI",
      TRUE);
}

/**
 * gst_cloth_silhouette_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_silhouette_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_silhouette_meta_api_get_type (), "GstClothSilhouetteMeta");
}

/**
 * gst_buffer_add_cloth_silhouette_meta:
 * @buffer: a writable buffer
 * @silhouette: (transfer full): where the cloth is in its picture
 *
 * Puts @silhouette on @buffer, in place of the one it may have had.
 *
 * Returns: (transfer none): the meta that now holds @silhouette
 *
 * Since: 0.1
 */
GstClothSilhouetteMeta *
gst_buffer_add_cloth_silhouette_meta (GstBuffer * buffer,
    GstClothSilhouette * silhouette)
{
  return gst_cloth_payload_attach (silhouette, buffer,
      gst_cloth_silhouette_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_silhouette:
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the silhouette on @buffer, owned by it; %NULL when
 *   it has none
 *
 * Since: 0.1
 */
GstClothSilhouette *
gst_buffer_get_cloth_silhouette (GstBuffer * buffer)
{
  return gst_cloth_payload_find (buffer,
      gst_cloth_silhouette_meta_api_get_type ());
}
