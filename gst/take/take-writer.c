/* A take: writing the folder that holds one recording of a cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/take.h"

#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/file/npy.h"
#include "gst/mesh/formats/obj.h"

typedef enum
{
  POSITIONS,
  TIMES,
  STATES,
  COVARIANCES,
  CLAMPS,
  N_ARRAYS
} Array;

static const gchar *const array_names[N_ARRAYS] = {
  "positions.npy", "times.npy", "states.npy", "covariance.npy", "clamps.npy"
};

struct _ClothTakeWriter
{
  gchar *folder;
  gboolean made_folder;
  gchar *json;
  guint n_vertices, n_held;
  guint64 n_frames;
  gdouble last_time;
  GPtrArray *meshes;            /* ClothOutput: the cloth, obstacles */
  ClothNpyWriter *arrays[N_ARRAYS];
  gfloat *unknown;              /* one frame of NaN covariances */
};

static gboolean
open_array (ClothTakeWriter * writer, Array array, ClothNpyType type,
    guint rank, guint64 a, guint64 b, GError ** error)
{
  const guint64 row_shape[] = { a, b };
  g_autofree gchar *path = g_build_filename (writer->folder,
      array_names[array], NULL);

  writer->arrays[array] = cloth_npy_writer_new (path, type, rank, row_shape,
      error);
  return writer->arrays[array] != NULL;
}

static gboolean
make_folder (ClothTakeWriter * writer, GError ** error)
{
  if (g_mkdir (writer->folder, 0777) == 0) {
    writer->made_folder = TRUE;
    return TRUE;
  }
  if (errno == EEXIST && g_file_test (writer->folder, G_FILE_TEST_IS_DIR))
    return TRUE;
  g_set_error (error, G_IO_ERROR, g_io_error_from_errno (errno),
      "cannot make the folder “%s”: %s", writer->folder,
      g_strerror (errno));
  return FALSE;
}

static gboolean
write_obj (ClothTakeWriter * writer, const gchar * file, const gchar * name,
    const ClothTopology * topology, const gfloat * positions, GError ** error)
{
  g_autofree gchar *path = g_build_filename (writer->folder, file, NULL);
  ClothOutput *output = cloth_output_new (path, error);

  if (!output)
    return FALSE;
  g_ptr_array_add (writer->meshes, output);
  return cloth_obj_write (output, name, topology, positions, 0, 1, error) &&
      cloth_output_finish (output, error);
}

/* The mesh lies flat in its file: what a take has of it is faces and uv. */
static gboolean
write_mesh (ClothTakeWriter * writer, const ClothTakeInfo * info,
    const ClothTopology * topology, GError ** error)
{
  g_autofree gfloat *flat = g_new0 (gfloat, 3 * (gsize) topology->n_vertices);

  for (gsize i = 0; i < topology->n_vertices; i++)
    memcpy (flat + 3 * i, topology->uv + 2 * i, 2 * sizeof *flat);
  return write_obj (writer, info->mesh, info->name, topology, flat, error);
}

static gboolean
write_obstacles (ClothTakeWriter * writer, const ClothTakeInfo * info,
    GError ** error)
{
  for (guint i = 0; i < info->obstacles->len; i++) {
    const ClothObstacle *item =
        &g_array_index (info->obstacles, ClothObstacle, i);
    g_autoptr (ClothTopology) topology = NULL;
    g_autofree gfloat *points = NULL;

    if (item->kind != CLOTH_OBSTACLE_MESH)
      continue;
    topology = cloth_topology_new (item->n_points, item->n_triangles);
    points = g_new (gfloat, 3 * (gsize) item->n_points);
    for (gsize k = 0; k < 3 * (gsize) item->n_points; k++)
      points[k] = (gfloat) item->points[k];
    for (gsize k = 0; k < item->n_triangles; k++) {
      memcpy (topology->faces + 4 * k, item->triangles + 3 * k,
          3 * sizeof *topology->faces);
      topology->faces[4 * k + 3] = CLOTH_NO_VERTEX;
    }
    if (!write_obj (writer, item->mesh, "obstacle", topology, points, error))
      return FALSE;
  }
  return TRUE;
}

/* @folder: the take; made when it is not there, but not its parents
 * @info: what take.json shall say; when `mesh` is set, the name of the OBJ file that
 *   is written from @topology. Meshes of obstacles are written under their names
 * @topology: the mesh
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * Starts a take. Frames are written as they come, under temporary names. Other files
 * in an existing folder stay.
 *
 * Returns: (transfer full): a writer, or %NULL
 */
ClothTakeWriter *
cloth_take_writer_new (const gchar * folder, const ClothTakeInfo * info,
    const ClothTopology * topology, GError ** error)
{
  g_autoptr (ClothTakeWriter) writer = g_new0 (ClothTakeWriter, 1);

  writer->folder = g_strdup (folder);
  writer->json = cloth_take_info_to_json (info);
  writer->meshes =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_output_free);
  writer->n_vertices = topology->n_vertices;
  writer->n_held = info->held->len;
  if (!make_folder (writer, error) ||
      (info->mesh && !write_mesh (writer, info, topology, error)) ||
      !write_obstacles (writer, info, error) ||
      !open_array (writer, POSITIONS, CLOTH_NPY_FLOAT32, 3,
          writer->n_vertices, 3, error) ||
      !open_array (writer, TIMES, CLOTH_NPY_FLOAT64, 1, 0, 0, error) ||
      !open_array (writer, STATES, CLOTH_NPY_UINT8, 2, writer->n_vertices, 0,
          error))
    return NULL;
  return g_steal_pointer (&writer);
}

/* Covariances may begin late or pause: frames without them are NaN. */
static gboolean
append_covariances (ClothTakeWriter * writer, const gfloat * covariances,
    GError ** error)
{
  gsize n = 6 * (gsize) writer->n_vertices;

  if (!writer->arrays[COVARIANCES]) {
    if (!covariances)
      return TRUE;
    writer->unknown = g_new (gfloat, n);
    for (gsize i = 0; i < n; i++)
      writer->unknown[i] = NAN;
    if (!open_array (writer, COVARIANCES, CLOTH_NPY_FLOAT32, 3,
            writer->n_vertices, 6, error))
      return FALSE;
    for (guint64 i = 0; i < writer->n_frames; i++)
      if (!cloth_npy_writer_append (writer->arrays[COVARIANCES],
              writer->unknown, 1, error))
        return FALSE;
  }
  return cloth_npy_writer_append (writer->arrays[COVARIANCES],
      covariances ? covariances : writer->unknown, 1, error);
}

static gboolean
append_clamps (ClothTakeWriter * writer, const gfloat * clamps, GError ** error)
{
  if (writer->n_frames == 0 && clamps && writer->n_held > 0 &&
      !open_array (writer, CLAMPS, CLOTH_NPY_FLOAT32, 3, writer->n_held, 3,
          error))
    return FALSE;
  if (!writer->arrays[CLAMPS])
    return TRUE;
  if (!clamps) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "a frame lacks the clamps that the first one had");
    return FALSE;
  }
  return cloth_npy_writer_append (writer->arrays[CLAMPS], clamps, 1, error);
}

/* @writer: a writer
 * @time_s: time of the frame, seconds, later than the last one's
 * @positions: 3 numbers a vertex, NaN when not seen
 * @states: a #ClothVertexState a vertex
 * @covariances: (nullable): 6 numbers a vertex, m²
 * @clamps: (nullable): 3 numbers a held vertex; in every frame or in none
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * Returns: %TRUE when the frame was taken
 */
gboolean
cloth_take_writer_append (ClothTakeWriter * writer, gdouble time_s,
    const gfloat * positions, const guint8 * states,
    const gfloat * covariances, const gfloat * clamps, GError ** error)
{
  if (!isfinite (time_s) || (writer->n_frames > 0 &&
          time_s <= writer->last_time)) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "frame %" G_GUINT64_FORMAT " is not later than the one before",
        writer->n_frames);
    return FALSE;
  }
  if (!cloth_npy_writer_append (writer->arrays[POSITIONS], positions, 1,
          error) ||
      !cloth_npy_writer_append (writer->arrays[TIMES], &time_s, 1, error) ||
      !cloth_npy_writer_append (writer->arrays[STATES], states, 1, error) ||
      !append_covariances (writer, covariances, error) ||
      !append_clamps (writer, clamps, error))
    return FALSE;
  writer->last_time = time_s;
  writer->n_frames++;
  return TRUE;
}

/* What an earlier take in the same folder had and this one has not would be read
 * with it. Without take.json the folder is no take until all is in place. */
static void
remove_stale (ClothTakeWriter * writer)
{
  g_autofree gchar *json = g_build_filename (writer->folder, "take.json", NULL);

  g_unlink (json);
  for (guint i = 0; i < N_ARRAYS; i++) {
    g_autofree gchar *path = g_build_filename (writer->folder,
        array_names[i], NULL);

    if (!writer->arrays[i])
      g_unlink (path);
  }
}

/* @writer: a writer that has at least one frame
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * Gives every file its name, take.json last. The writer can then only be freed.
 *
 * Returns: %TRUE when the take is there
 */
gboolean
cloth_take_writer_close (ClothTakeWriter * writer, GError ** error)
{
  g_autofree gchar *path = g_build_filename (writer->folder, "take.json", NULL);
  g_autoptr (GPtrArray) outputs =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_output_free);
  ClothOutput *output;

  if (writer->n_frames == 0) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "a take needs at least one frame");
    return FALSE;
  }
  while (writer->meshes->len > 0)
    g_ptr_array_add (outputs, g_ptr_array_steal_index (writer->meshes, 0));
  for (guint i = 0; i < N_ARRAYS; i++) {
    if (!writer->arrays[i])
      continue;
    output = cloth_npy_writer_finish (writer->arrays[i], error);
    if (!output)
      return FALSE;
    g_ptr_array_add (outputs, output);
  }
  output = cloth_output_new (path, error);
  if (!output)
    return FALSE;
  g_ptr_array_add (outputs, output);
  if (!cloth_output_write (output, writer->json, strlen (writer->json), error)
      || !cloth_output_write (output, "\n", 1, error) ||
      !cloth_output_finish (output, error))
    return FALSE;
  remove_stale (writer);
  if (!cloth_output_commit ((ClothOutput **) outputs->pdata, outputs->len,
          error))
    return FALSE;
  writer->made_folder = FALSE;
  return TRUE;
}

/* @writer: (transfer full) (nullable): a writer
 *
 * Frees it; a take that was not closed leaves nothing behind.
 */
void
cloth_take_writer_free (ClothTakeWriter * writer)
{
  if (!writer)
    return;
  for (guint i = 0; i < N_ARRAYS; i++)
    cloth_npy_writer_free (writer->arrays[i]);
  g_ptr_array_unref (writer->meshes);
  /* Only an empty folder goes. */
  if (writer->made_folder)
    g_rmdir (writer->folder);
  g_free (writer->unknown);
  g_free (writer->json);
  g_free (writer->folder);
  g_free (writer);
}
