/* What trackers saw, as a take that a cloth is fitted to.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/fit-track-take.h"

#include <gst/cloth/cloth.h>
#include <math.h>
#include <string.h>

#include "gst/file/npy.h"
#include "gst/file/output.h"
#include "gst/rig/rigfile.h"
#include "gst/take/take.h"
#include "gst/vision/track/vertices.h"

struct _FitTrackTake
{
  FitTrackTakeOptions options;
  const ClothRig *rig;
  ClothFlatPose pose;
  ClothVertices *vertices;
  ClothGridVertex *grid;
  GByteArray **observations;    /* of each camera */
  GArray *times;                /* of each frame, s */
  GArray *uv, *px;              /* of one camera's features */
  GArray *points;               /* its GstClothGridPoint */
};

/* @folder: of a take to be
 * @error: #GFileError
 *
 * Returns: whether it can be made there: what an older take leaves in a folder would become part of it
 */
gboolean
fit_track_take_check (const gchar * folder, GError ** error)
{
  g_autofree gchar *info = g_build_filename (folder, "take.json", NULL);

  if (g_file_test (info, G_FILE_TEST_EXISTS)) {
    g_set_error (error, G_FILE_ERROR, G_FILE_ERROR_EXIST,
        "“%s” is a take already: give another folder, or remove it",
        folder);
    return FALSE;
  }
  return cloth_folder_make (folder, error);
}

/* @options: copied but for what it points at, which has to outlive the take; so has @rig
 *
 * Returns: (transfer full): a take without frames
 */
FitTrackTake *
fit_track_take_new (const FitTrackTakeOptions * options, const ClothRig * rig,
    const ClothFlatPose * pose)
{
  FitTrackTake *take = g_new0 (FitTrackTake, 1);

  take->options = *options;
  take->rig = rig;
  take->pose = *pose;
  take->vertices = cloth_vertices_new (options->columns, options->rows,
      pose->size[0], pose->size[1]);
  take->grid = g_new (ClothGridVertex, options->columns * options->rows);
  take->observations = g_new (GByteArray *, rig->n_cameras);
  for (guint c = 0; c < rig->n_cameras; c++)
    take->observations[c] = g_byte_array_new ();
  take->times = g_array_new (FALSE, FALSE, sizeof (gdouble));
  take->uv = g_array_new (FALSE, FALSE, 2 * sizeof (gdouble));
  take->px = g_array_new (FALSE, FALSE, 2 * sizeof (gdouble));
  take->points = g_array_new (FALSE, FALSE, sizeof (GstClothGridPoint));
  return take;
}

/* @take: (nullable) (transfer full): a take
 */
void
fit_track_take_free (FitTrackTake * take)
{
  if (!take)
    return;
  cloth_vertices_free (take->vertices);
  g_free (take->grid);
  for (guint c = 0; c < take->rig->n_cameras; c++)
    g_byte_array_unref (take->observations[c]);
  g_free (take->observations);
  g_array_unref (take->times);
  g_array_unref (take->uv);
  g_array_unref (take->px);
  g_array_unref (take->points);
  g_free (take);
}

/* The grid's vertices between a camera's features. */
static void
find_points (FitTrackTake * take, guint camera,
    const ClothTrackedFeature * features, guint n_features)
{
  const ClothVerticesParams params = cloth_vertices_default_params ();
  const guint columns = take->options.columns;

  g_array_set_size (take->uv, 0);
  g_array_set_size (take->px, 0);
  g_array_set_size (take->points, 0);
  for (guint i = 0; i < n_features
      && take->uv->len < GST_CLOTH_MAX_FEATURES; i++) {
    if (features[i].camera != camera || isnan (features[i].uv[0]))
      continue;
    g_array_append_val (take->uv, features[i].uv);
    g_array_append_val (take->px, features[i].px);
  }
  cloth_vertices_run (take->vertices, &params, take->uv->len,
      (gdouble *) (gpointer) take->uv->data,
      (gdouble *) (gpointer) take->px->data, take->grid);
  for (guint v = 0; v < columns * take->options.rows; v++) {
    const ClothGridVertex *from = &take->grid[v];
    const GstClothGridPoint point = { (gint) (v % columns),
      (gint) (v / columns), from->mirrored, (gfloat) from->x,
      (gfloat) from->y, (gfloat) from->xx, (gfloat) from->xy,
      (gfloat) from->yy
    };

    if (from->state != CLOTH_GRID_UNSEEN)
      g_array_append_val (take->points, point);
  }
}

/* Adds one picture to a camera's observations. */
static void
add_picture (FitTrackTake * take, guint camera, gdouble time_s,
    const GArray * runs)
{
  const ClothCamera *c = &take->rig->cameras[camera];
  const guint sequence = take->times->len;
  GstBuffer *picture = gst_buffer_new ();
  GstClothMatches *matches = gst_cloth_matches_new (c->name, sequence,
      take->options.columns, take->options.rows, take->uv->len, FALSE, NULL, 0,
      (const GstClothGridPoint *) (gpointer) take->points->data,
      take->points->len);
  GstClothSilhouette *silhouette = gst_cloth_silhouette_new (c->name, sequence,
      (guint) c->width, (guint) c->height,
      (const GstClothRun *) (gpointer) runs->data, runs->len);
  GstBuffer *packed;
  GstMapInfo map;

  G_STATIC_ASSERT (sizeof (ClothRun) == sizeof (GstClothRun));
  /* pictures of one number were taken at one time: the first camera's, by each camera's clock */
  time_s += c->offset_s - take->rig->cameras[0].offset_s;
  GST_BUFFER_PTS (picture) =
      (GstClockTime) (fmax (time_s, 0.) * GST_SECOND + 0.5);
  gst_buffer_add_cloth_matches_meta (picture, matches);
  gst_buffer_add_cloth_silhouette_meta (picture, silhouette);
  packed = gst_cloth_observations_pack (picture);
  if (gst_buffer_map (packed, &map, GST_MAP_READ)) {
    g_byte_array_append (take->observations[camera], map.data,
        (guint) map.size);
    gst_buffer_unmap (packed, &map);
  }
  gst_buffer_unref (packed);
  gst_buffer_unref (picture);
}

/* @take: a take
 * @time_s: of the frame, later than the last one's
 * @features: (array length=n_features): what all cameras saw
 * @n_features: how many
 * @silhouettes: (array) (element-type ClothRun): of each camera
 * @error: #GFileError
 *
 * Returns: %FALSE when the time is none, or the first frame shows no vertex
 */
gboolean
fit_track_take_add (FitTrackTake * take, gdouble time_s,
    const ClothTrackedFeature * features, guint n_features,
    const GArray * const *silhouettes, GError ** error)
{
  guint n_points = 0;

  if (!isfinite (time_s) || (take->times->len
          && time_s <= g_array_index (take->times, gdouble,
              take->times->len - 1))) {
    g_set_error_literal (error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
        "it has no time, or not a later one than the picture before, which a take "
        "needs");
    return FALSE;
  }
  for (guint c = 0; c < take->rig->n_cameras; c++) {
    find_points (take, c, features, n_features);
    n_points += take->points->len;
    add_picture (take, c, time_s, silhouettes[c]);
  }
  if (take->times->len == 0 && n_points == 0) {
    g_set_error_literal (error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
        "no vertex of the grid lies between features that are near enough to each "
        "other: give a coarser --grid");
    return FALSE;
  }
  g_array_append_val (take->times, time_s);
  return TRUE;
}

static gboolean
write_array (const gchar * folder, const gchar * name, ClothNpyType type,
    guint n_dimensions, const guint64 * shape, gconstpointer data,
    guint64 n_rows, GError ** error)
{
  g_autofree gchar *path = g_build_filename (folder, name, NULL);
  ClothOutput *output = cloth_output_new (path, error);
  g_autoptr (ClothNpyWriter) writer = output ? cloth_npy_writer_new (output,
      type, n_dimensions, shape, error) : NULL;

  return writer && cloth_npy_writer_append (writer, data, n_rows, error)
      && cloth_npy_writer_finish (writer, error);
}

/* Where the cloth lies flat in the first frame. */
static gboolean
write_start (const FitTrackTake * take, GError ** error)
{
  const FitTrackTakeOptions *o = &take->options;
  const guint n = o->columns * o->rows;
  const guint64 shape[] = { n, 3 };
  g_autofree gfloat *start = g_new (gfloat, 3 * (gsize) n);

  for (guint v = 0; v < n; v++) {
    const gdouble uv[2] = {
      take->pose.size[0] * (v % o->columns) / (o->columns - 1),
      take->pose.size[1] * (v / o->columns) / (o->rows - 1)
    };
    gdouble place[3];

    cloth_flat_place (&take->pose, uv, place);
    for (guint k = 0; k < 3; k++)
      start[3 * v + k] = (gfloat) place[k];
  }
  return write_array (o->folder, "positions.npy", CLOTH_NPY_FLOAT32, 3, shape,
      start, 1, error);
}

/* The paths of what is held are not known. */
static gboolean
write_clamps (const FitTrackTake * take, GError ** error)
{
  const guint64 shape[] = { take->options.n_held, 3 };
  g_autofree gfloat *clamps = g_new (gfloat, 3 * take->options.n_held + 1);

  for (guint i = 0; i < 3 * take->options.n_held; i++)
    clamps[i] = NAN;
  return take->options.n_held == 0 || write_array (take->options.folder,
      "clamps.npy", CLOTH_NPY_FLOAT32, 3, shape, clamps, 1, error);
}

static gboolean
write_info (const FitTrackTake * take, GError ** error)
{
  const FitTrackTakeOptions *o = &take->options;
  const gdouble *times = (const gdouble *) (gpointer) take->times->data;
  const guint last = take->times->len - 1;
  g_autofree gchar *name = g_path_get_basename (o->folder);
  g_autofree gchar *path = g_build_filename (o->folder, "take.json", NULL);
  g_autofree gchar *json = NULL;
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (name);
  const ClothObstacle ground = {.kind = CLOTH_OBSTACLE_PLANE,
    .point = {0., 0., take->pose.ground},.normal = {0., 0., 1.},
    .friction = NAN
  };

  info->fps = last ? last / (times[last] - times[0]) : 0.;
  info->columns = o->columns;
  info->rows = o->rows;
  info->width_m = take->pose.size[0];
  info->height_m = take->pose.size[1];
  g_array_append_val (info->obstacles, ground);
  for (guint i = 0; i < o->n_held; i++) {
    const ClothHeld held = { o->held[i], -INFINITY, INFINITY };

    g_array_append_val (info->held, held);
  }
  json = cloth_take_info_to_json (info);
  return cloth_file_write_text (path, json, error);
}

static gboolean
write_observations (const FitTrackTake * take, GError ** error)
{
  g_autofree gchar *folder = g_build_filename (take->options.folder,
      "observations", NULL);

  if (!cloth_folder_make (folder, error))
    return FALSE;
  for (guint c = 0; c < take->rig->n_cameras; c++) {
    g_autofree gchar *name = g_strconcat (take->rig->cameras[c].name, ".obs",
        NULL);
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    if (!cloth_file_write (path, take->observations[c]->data,
            take->observations[c]->len, error))
      return FALSE;
  }
  return TRUE;
}

/* @take: a take of one frame at least
 * @error: #GIOErrorEnum, #GFileError
 *
 * Writes the take; take.json comes last, so that there is none that lacks something.
 *
 * Returns: whether it is there
 */
gboolean
fit_track_take_write (FitTrackTake * take, GError ** error)
{
  const gchar *folder = take->options.folder;
  g_autofree gchar *rig = g_build_filename (folder, "rig.json", NULL);

  return write_observations (take, error)
      && cloth_rig_save (take->rig, rig, error)
      && write_array (folder, "times.npy", CLOTH_NPY_FLOAT64, 1, NULL,
      take->times->data, take->times->len, error) && write_start (take, error)
      && write_clamps (take, error) && write_info (take, error);
}
