/* clothgap: the meshes that went by as a take, and its diagnosis.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothgap-record.h"

#include <glib/gstdio.h>
#include <math.h>

struct _GstClothGapRecord
{
  gchar *folder;                /* temporary */
  ClothTakeWriter *writer;
  /* the scene's clamps, for a recording whose frames have times of their own */
  guint n_held, n_frames;
  gdouble *times, *clamps;
  gfloat *row;
};

/* The take starts with the first mesh that is appended. @info: of the scene's take. */
GstClothGapRecord *
gst_cloth_gap_record_new (const ClothTakeInfo * info, const ClothScene * scene,
    GError ** error)
{
  GstClothGapRecord *record = g_new0 (GstClothGapRecord, 1);
  g_autoptr (ClothTakeInfo) flat = cloth_take_info_copy (info);
  gsize n;

  record->folder = g_dir_make_tmp ("clothgap-XXXXXX", error);
  record->writer = record->folder ? cloth_take_writer_new (record->folder, flat,
      scene->topology, error) : NULL;
  if (!record->writer) {
    gst_cloth_gap_record_free (record);
    return NULL;
  }
  record->n_held = scene->held->len;
  record->n_frames = scene->n_frames;
  n = 3 * (gsize) record->n_held;
  record->times = g_memdup2 (scene->times,
      record->n_frames * sizeof *record->times);
  if (n > 0) {
    record->clamps = g_memdup2 (scene->clamps,
        n * record->n_frames * sizeof *record->clamps);
    record->row = g_new (gfloat, n);
  }
  return record;
}

/* Between two logged places a clamp moves evenly, as in the simulation. */
static void
find_clamps (GstClothGapRecord * record, gdouble time)
{
  gsize n = 3 * (gsize) record->n_held;
  guint after = 0;
  const gdouble *a, *b;
  gdouble share = 0;

  while (after < record->n_frames && record->times[after] < time)
    after++;
  b = record->clamps + n * MIN (after, record->n_frames - 1);
  a = record->clamps + n * (after > 0 ? after - 1 : 0);
  if (after > 0 && after < record->n_frames)
    share = (time - record->times[after - 1]) /
        (record->times[after] - record->times[after - 1]);
  for (gsize i = 0; i < n; i++)
    record->row[i] = (gfloat) (a[i] + share * (b[i] - a[i]));
}

gboolean
gst_cloth_gap_record_append (GstClothGapRecord * record, gdouble time_s,
    const gfloat * positions, const guint8 * states, const gfloat * covariances,
    GError ** error)
{
  if (record->n_held > 0)
    find_clamps (record, time_s);
  return cloth_take_writer_append (record->writer, time_s,
      positions, states, covariances, record->row, error);
}

/* Ends the take; the record can then only be freed. */
ClothGapResult *
gst_cloth_gap_record_diagnose (GstClothGapRecord * record,
    const ClothModel * model, const ClothGapOptions * options, GError ** error)
{
  g_autoptr (ClothTake) take = NULL;

  if (!cloth_take_writer_close (record->writer, error))
    return NULL;
  take = cloth_take_open (record->folder, error);
  return take ? cloth_gap_diagnose (&take, 1, model, options, error) : NULL;
}

static void
remove_folder (const gchar * folder)
{
  GDir *dir = g_dir_open (folder, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    g_unlink (path);
  }
  if (dir)
    g_dir_close (dir);
  g_rmdir (folder);
}

void
gst_cloth_gap_record_free (GstClothGapRecord * record)
{
  if (!record)
    return;
  cloth_take_writer_free (record->writer);
  if (record->folder)
    remove_folder (record->folder);
  g_free (record->folder);
  g_free (record->times);
  g_free (record->clamps);
  g_free (record->row);
  g_free (record);
}
