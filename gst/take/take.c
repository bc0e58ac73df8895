/* A take: reading and writing the folder that holds one recording of a cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/take.h"

#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/file/hash.h"
#include "gst/file/npy.h"
#include "gst/mesh/formats/formats.h"

#define JSON "take.json"
#define OBSERVATIONS "observations"
/* Times between frames that differ by less than this share count as even. */
#define EVEN 0.01
#define MAX_FRAMES (CLOTH_MAX_BUFFER / sizeof (gdouble))

struct _ClothTake
{
  gchar *folder;
  GPtrArray *files;             /* names of those that are read, below the folder */
  ClothTakeInfo *info;
  ClothTopology *topology;
  guint n_frames, n_positions;
  gdouble *times;               /* NULL: info->fps says */
  ClothNpyReader *positions;    /* NULL: cameras saw it, and that is all that is known */
  ClothNpyReader *covariances;  /* these may be NULL */
  ClothNpyReader *clamps;
  ClothNpyReader *states;
};

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
  ClothParts *parts;
  guint n_vertices, n_held;
  guint64 n_frames;
  gdouble last_time;
  ClothNpyWriter *arrays[N_ARRAYS];
  gfloat *unknown;              /* one frame of NaN covariances */
};

static void
note_file (ClothTake * take, const gchar * name)
{
  g_ptr_array_add (take->files, g_strdup (name));
}

static gboolean
load_info (ClothTake * take, GError ** error)
{
  g_autofree gchar *path = cloth_path_inside (take->folder, JSON, error);
  g_autoptr (ClothInput) input = path ? cloth_input_open (path, error) : NULL;
  g_autoptr (GByteArray) bytes = g_byte_array_new ();

  if (!input || !cloth_input_load (input, CLOTH_MAX_BUFFER, bytes, error))
    return FALSE;
  note_file (take, JSON);
  take->info = cloth_take_info_parse ((const gchar *) bytes->data,
      bytes->len - 1, error);
  return take->info != NULL;
}

static gboolean
check_seams (const ClothTake * take, GError ** error)
{
  for (guint i = 0; i < take->info->seams->len; i++) {
    const ClothSeamLine *line =
        &g_array_index (take->info->seams, ClothSeamLine, i);

    for (guint k = 0; k < 2 * line->n_vertices; k++) {
      guint vertex = line->lines[k % 2][k / 2];

      if (vertex < take->topology->n_vertices)
        continue;
      return cloth_file_invalid (error,
          "take.json: vertex %u of seam %u is not in the mesh", vertex, i);
    }
  }
  return TRUE;
}

static gboolean
load_topology (ClothTake * take, GError ** error)
{
  const ClothTakeInfo *info = take->info;
  g_autofree gchar *path = NULL;
  g_autoptr (ClothObj) obj = NULL;

  if (!info->mesh) {
    take->topology = cloth_topology_new_grid (info->columns, info->rows,
        (gfloat) info->width_m, (gfloat) info->height_m);
    return TRUE;
  }
  path = cloth_path_inside (take->folder, info->mesh, error);
  obj = path ? cloth_obj_read (path, error) : NULL;
  if (!obj)
    return FALSE;
  note_file (take, info->mesh);
  if (!obj->has_uv)
    return cloth_file_invalid (error,
        "%s: the mesh of a take needs uv (vt), in metres", info->mesh);
  take->topology = g_steal_pointer (&obj->topology);
  for (guint i = 0; i < info->held->len; i++) {
    if (g_array_index (info->held, ClothHeld,
            i).vertex >= take->topology->n_vertices)
      return cloth_file_invalid (error,
          "take.json: held vertex %u is not in the mesh",
          g_array_index (info->held, ClothHeld, i).vertex);
  }
  return check_seams (take, error);
}

static gboolean
load_obstacles (ClothTake * take, GError ** error)
{
  for (guint i = 0; i < take->info->obstacles->len; i++) {
    ClothObstacle *obstacle =
        &g_array_index (take->info->obstacles, ClothObstacle, i);

    if (obstacle->kind != CLOTH_OBSTACLE_MESH)
      continue;
    if (!cloth_obstacle_load_mesh (obstacle, take->folder, error))
      return FALSE;
    note_file (take, obstacle->mesh);
  }
  return TRUE;
}

/* Opens an array and compares its shape; an absent @optional one is NULL. */
static gboolean
open_array (ClothTake * take, const gchar * name, gboolean optional,
    guint rank, const guint64 * shape, ClothNpyReader ** reader,
    GError ** error)
{
  g_autoptr (GError) fault = NULL;
  g_autofree gchar *path = cloth_path_inside (take->folder, name, &fault);
  const ClothNpyInfo *info;
  gboolean match;

  if (!path) {
    if (optional && g_error_matches (fault, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
      return TRUE;
    g_propagate_error (error, g_steal_pointer (&fault));
    return FALSE;
  }
  *reader = cloth_npy_reader_open (path, error);
  if (!*reader)
    return FALSE;
  note_file (take, name);
  info = cloth_npy_reader_get_info (*reader);
  match = info->rank == rank;
  /* A length of 0 stands for any. */
  for (guint i = 0; match && i < rank; i++)
    match = shape[i] == 0 || info->shape[i] == shape[i];
  if (!match) {
    GString *want = g_string_new (NULL), *have = g_string_new (NULL);

    for (guint i = 0; i < rank; i++) {
      if (shape[i] == 0)
        g_string_append (want, "[frames]");
      else
        g_string_append_printf (want, "[%" G_GUINT64_FORMAT "]", shape[i]);
    }
    for (guint i = 0; i < info->rank; i++)
      g_string_append_printf (have, "[%" G_GUINT64_FORMAT "]", info->shape[i]);
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "%s has the shape %s; the take needs %s", name, have->str, want->str);
    g_string_free (want, TRUE);
    g_string_free (have, TRUE);
    return FALSE;
  }
  return TRUE;
}

static gboolean
check_type (ClothNpyReader * reader, const gchar * name, gboolean bytes,
    GError ** error)
{
  ClothNpyType type;

  if (!reader)
    return TRUE;
  type = cloth_npy_reader_get_info (reader)->type;
  if (bytes ? type == CLOTH_NPY_UINT8 :
      type == CLOTH_NPY_FLOAT32 || type == CLOTH_NPY_FLOAT64)
    return TRUE;
  return cloth_file_invalid (error, "%s must hold items of type %s: save "
      "array.astype ('%s')", name, bytes ? "uint8" : "float32 or float64",
      bytes ? "uint8" : "float64");
}

static gboolean
load_times (ClothTake * take, GError ** error)
{
  const guint64 shape[] = { take->n_frames };
  g_autoptr (ClothNpyReader) reader = NULL;

  if (!open_array (take, "times.npy", TRUE, 1, shape, &reader, error) ||
      !check_type (reader, "times.npy", FALSE, error))
    return FALSE;
  if (!reader) {
    if (take->info->fps > 0)
      return TRUE;
    return cloth_file_invalid (error,
        "the take has neither “fps” in take.json nor times.npy");
  }
  take->times = g_new (gdouble, take->n_frames);
  if (!cloth_npy_reader_read_double (reader, 0, take->n_frames, take->times,
          error))
    return FALSE;
  for (guint i = 0; i < take->n_frames; i++) {
    if (!isfinite (take->times[i]) ||
        (i > 0 && take->times[i] <= take->times[i - 1]))
      return cloth_file_invalid (error,
          "times.npy: the time of frame %u is not finite or does not rise", i);
  }
  return TRUE;
}

/* Whether what cameras saw is in the folder, too. */
static gboolean
is_observed (const ClothTake * take)
{
  g_autofree gchar *path = g_build_filename (take->folder, OBSERVATIONS, NULL);

  return g_file_test (path, G_FILE_TEST_IS_DIR);
}

/* Of a take whose positions are where it starts, or none: times or clamps say how many frames it
 * has. */
static gboolean
count_frames (ClothTake * take, guint64 * n_frames, GError ** error)
{
  static const Array arrays[] = { TIMES, CLAMPS };

  for (guint i = 0; i < G_N_ELEMENTS (arrays); i++) {
    const gchar *name = array_names[arrays[i]];
    g_autofree gchar *path = g_build_filename (take->folder, name, NULL);
    g_autoptr (ClothNpyReader) reader = NULL;

    if (!g_file_test (path, G_FILE_TEST_EXISTS))
      continue;
    if (!(reader = cloth_npy_reader_open (path, error)))
      return FALSE;
    *n_frames = MAX (*n_frames, cloth_npy_reader_get_info (reader)->n_rows);
    if (*n_frames > 1)
      return TRUE;
  }
  return *n_frames == 1 || cloth_file_invalid (error, "without positions.npy "
      "the take needs times.npy, with the time of each frame in seconds");
}

static gboolean
load_arrays (ClothTake * take, GError ** error)
{
  guint64 n_vertices = take->topology->n_vertices;
  guint64 n_held = take->info->held->len;
  const guint64 positions[] = { 0, n_vertices, 3 };
  guint64 n_frames;

  const gboolean observed = is_observed (take);

  if (!open_array (take, "positions.npy", observed, 3, positions,
          &take->positions, error) ||
      !check_type (take->positions, "positions.npy", FALSE, error))
    return FALSE;
  n_frames = take->positions ?
      cloth_npy_reader_get_info (take->positions)->n_rows : 0;
  take->n_positions = (guint) MIN (n_frames, MAX_FRAMES + 1);
  if (observed && n_frames <= 1 && !count_frames (take, &n_frames, error))
    return FALSE;
  if (n_frames == 0 || n_frames > MAX_FRAMES) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "positions.npy: %" G_GUINT64_FORMAT " frames; between 1 and %"
        G_GSIZE_FORMAT " are accepted", n_frames, (gsize) MAX_FRAMES);
    return FALSE;
  }
  take->n_frames = (guint) n_frames;
  {
    const guint64 covariances[] = { n_frames, n_vertices, 6 };
    const guint64 clamps[] = { 0, n_held, 3 };
    const guint64 states[] = { n_frames, n_vertices };

    if (!open_array (take, "covariance.npy", TRUE, 3, covariances,
            &take->covariances, error) ||
        !check_type (take->covariances, "covariance.npy", FALSE, error) ||
        !open_array (take, "clamps.npy", TRUE, 3, clamps, &take->clamps,
            error) || !check_type (take->clamps, "clamps.npy", FALSE, error) ||
        !open_array (take, "states.npy", TRUE, 2, states, &take->states,
            error) || !check_type (take->states, "states.npy", TRUE, error))
      return FALSE;
  }
  if (take->clamps && n_held == 0)
    return cloth_file_invalid (error,
        "clamps.npy is there but take.json says of no vertex that it is held");
  if (take->clamps) {
    const guint64 n_rows = cloth_npy_reader_get_info (take->clamps)->n_rows;

    if (n_rows != 1 && n_rows != n_frames)
      return cloth_file_invalid (error, "clamps.npy has %" G_GUINT64_FORMAT
          " rows; the take needs %" G_GUINT64_FORMAT
          ", one a frame, or one for " "clamps that stand still", n_rows,
          n_frames);
  }
  return load_times (take, error);
}

/* @folder: a take
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Opens a take and compares the shapes of all its arrays. Frames are read one by
 * one; a take larger than the memory is fine. Nothing outside @folder is read.
 *
 * Returns: (transfer full): the take, or %NULL
 */
ClothTake *
cloth_take_open (const gchar * folder, GError ** error)
{
  g_autoptr (ClothTake) take = g_new0 (ClothTake, 1);
  g_autofree gchar *head = g_build_filename (folder, JSON, NULL);
  ClothPlaced placed;

  take->folder = g_strdup (folder);
  take->files = g_ptr_array_new_with_free_func (g_free);
  if (!cloth_parts_begin_reading (head, &placed, error) ||
      !load_info (take, error) || !load_topology (take, error) ||
      !load_obstacles (take, error) || !load_arrays (take, error) ||
      !cloth_parts_end_reading (head, &placed, error)) {
    g_prefix_error (error, "%s: ", folder);
    return NULL;
  }
  return g_steal_pointer (&take);
}

/* @take: a take
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads all files that reading the take reads: take.json, its arrays, its meshes.
 *
 * Returns: (transfer full) (nullable): the hash of what `sha256sum` prints of them, sorted
 *   by their names, 64 hexadecimal digits
 */
gchar *
cloth_take_sha256 (const ClothTake * take, GError ** error)
{
  return cloth_files_sha256 (take->folder, take->files, error);
}

/* @take: a take
 * @name: a file below its folder that is read beside it
 *
 * From now on cloth_take_sha256 () reads it, too.
 */
void
cloth_take_add_file (ClothTake * take, const gchar * name)
{
  note_file (take, name);
}

/* @take: a take
 *
 * Returns: (transfer none) (type filename): where it lies
 */
const gchar *
cloth_take_get_folder (const ClothTake * take)
{
  return take->folder;
}

/* @take: a take
 *
 * Returns: (transfer none): its take.json
 */
const ClothTakeInfo *
cloth_take_get_info (const ClothTake * take)
{
  return take->info;
}

/* @take: a take
 *
 * Returns: (transfer none): its grid or mesh
 */
const ClothTopology *
cloth_take_get_topology (const ClothTake * take)
{
  return take->topology;
}

/* @take: a take
 *
 * Returns: number of frames, at least 1
 */
guint
cloth_take_get_n_frames (const ClothTake * take)
{
  return take->n_frames;
}

/* @take: a take
 *
 * Returns: how many of its frames, the first ones, have positions: all, or of a take that cameras
 *   saw and nothing else the one where it starts, or none
 */
guint
cloth_take_get_n_positions (const ClothTake * take)
{
  return take->n_positions;
}

/* @take: a take
 *
 * Returns: (transfer none) (nullable): times.npy, seconds, rising; %NULL when frames
 *   follow each other at the take's fps
 */
const gdouble *
cloth_take_get_times (const ClothTake * take)
{
  return take->times;
}

/* @take: a take
 * @frame: a frame
 *
 * Returns: its time in seconds
 */
gdouble
cloth_take_get_time (const ClothTake * take, guint frame)
{
  return take->times ? take->times[frame] : frame / take->info->fps;
}

/* @take: a take
 *
 * Returns: frames a second by its times, a whole number where these were rounded; 0 where
 *   they are not even, or there is one only
 */
gdouble
cloth_take_get_rate (const ClothTake * take)
{
  const guint last = take->n_frames - 1;
  gdouble least = INFINITY, most = 0., step, rate;

  if (!take->times)
    return take->info->fps;
  if (last == 0)
    return 0.;
  for (guint i = 0; i < last; i++) {
    least = fmin (least, take->times[i + 1] - take->times[i]);
    most = fmax (most, take->times[i + 1] - take->times[i]);
  }
  step = (take->times[last] - take->times[0]) / last;
  if (!(most - least < EVEN * step))
    return 0.;
  rate = rint (1. / step);
  return fabs (last / rate - last * step) < EVEN * step ? rate : 1. / step;
}

/* @take: a take
 *
 * Returns: whether there is a covariance.npy
 */
gboolean
cloth_take_has_covariances (const ClothTake * take)
{
  return take->covariances != NULL;
}

/* @take: a take
 *
 * Returns: whether there is a clamps.npy
 */
gboolean
cloth_take_has_clamps (const ClothTake * take)
{
  return take->clamps != NULL;
}

/* @take: a take
 * @frame: which frame
 * @positions: (out caller-allocates): room for 3 numbers a vertex, metres; NaN when
 *   not seen
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when they were read and are valid
 */
gboolean
cloth_take_read_positions (ClothTake * take, guint frame, gfloat * positions,
    GError ** error)
{
  if (frame >= take->n_positions)
    return cloth_file_invalid (error, "“%s” has no positions, only what "
        "cameras saw (folder " OBSERVATIONS "): a diagnosis reads that; for a "
        "mesh play it through triangulate", take->folder);
  if (cloth_npy_reader_read_float (take->positions, frame, 1, positions, error)
      && cloth_positions_check (positions, take->topology->n_vertices, error))
    return TRUE;
  g_prefix_error (error, "positions.npy, frame %u: ", frame);
  return FALSE;
}

/* @take: a take
 * @frame: which frame
 * @positions: that frame's positions
 * @states: (out caller-allocates): room for a #ClothVertexState a vertex
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Without states.npy a vertex is measured, or unseen when NaN.
 *
 * Returns: %TRUE when they were read and are valid
 */
gboolean
cloth_take_read_states (ClothTake * take, guint frame,
    const gfloat * positions, guint8 * states, GError ** error)
{
  guint n = take->topology->n_vertices;

  if (!take->states) {
    for (gsize i = 0; i < n; i++)
      states[i] = isnan (positions[3 * i]) ? CLOTH_VERTEX_UNSEEN :
          CLOTH_VERTEX_MEASURED;
    return TRUE;
  }
  if (cloth_npy_reader_read_raw (take->states, frame, 1, states, error) &&
      cloth_states_check (states, n, error))
    return TRUE;
  g_prefix_error (error, "states.npy, frame %u: ", frame);
  return FALSE;
}

/* @take: a take that has covariances
 * @frame: which frame
 * @covariances: (out caller-allocates): room for 6 numbers a vertex: xx, xy, xz, yy,
 *   yz, zz, m²; NaN where not known
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when they were read, none is infinite and no variance negative
 */
gboolean
cloth_take_read_covariances (ClothTake * take, guint frame,
    gfloat * covariances, GError ** error)
{
  if (!cloth_npy_reader_read_float (take->covariances, frame, 1, covariances,
          error))
    return FALSE;
  for (gsize i = 0; i < 6 * (gsize) take->topology->n_vertices; i++) {
    gsize k = i % 6;

    if (isinf (covariances[i]) || ((k == 0 || k == 3 || k == 5) &&
            covariances[i] < 0))
      return cloth_file_invalid (error,
          "covariance.npy, frame %u: vertex %u has an infinite covariance or "
          "a negative variance", frame, (guint) (i / 6));
  }
  return TRUE;
}

/* @take: a take that has clamps
 * @frame: which frame
 * @clamps: (out caller-allocates): room for 3 numbers a held vertex, metres; of clamps that
 *   stand still the only row. NaN where nobody logged a clamp's place
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when they were read and are places, or NaN, for as long as they hold
 */
gboolean
cloth_take_read_clamps (ClothTake * take, guint frame, gfloat * clamps,
    GError ** error)
{
  gdouble time = cloth_take_get_time (take, frame);
  const gboolean is_still =
      cloth_npy_reader_get_info (take->clamps)->n_rows == 1;

  if (!cloth_npy_reader_read_float (take->clamps, is_still ? 0 : frame, 1,
          clamps, error))
    return FALSE;
  for (gsize i = 0; i < take->info->held->len; i++) {
    const ClothHeld *held = &g_array_index (take->info->held, ClothHeld, i);

    if (!cloth_held_holds (held, time))
      continue;
    if (isnan (clamps[3 * i]) && isnan (clamps[3 * i + 1])
        && isnan (clamps[3 * i + 2]))
      continue;
    for (guint k = 0; k < 3; k++) {
      if (!isfinite (clamps[3 * i + k]))
        return cloth_file_invalid (error,
            "clamps.npy, frame %u: the clamp of vertex %u is at %g along %c; "
            "where its place was not logged all three are NaN", frame,
            held->vertex, clamps[3 * i + k], "xyz"[k]);
    }
  }
  return TRUE;
}

/* @take: (transfer full) (nullable): a take
 */
void
cloth_take_free (ClothTake * take)
{
  if (!take)
    return;
  g_free (take->folder);
  g_ptr_array_unref (take->files);
  cloth_take_info_free (take->info);
  cloth_topology_free (take->topology);
  cloth_npy_reader_free (take->positions);
  cloth_npy_reader_free (take->covariances);
  cloth_npy_reader_free (take->clamps);
  cloth_npy_reader_free (take->states);
  g_free (take->times);
  g_free (take);
}

/* Writing */

static gboolean
start_array (ClothTakeWriter * writer, Array array, ClothNpyType type,
    guint rank, guint64 a, guint64 b, GError ** error)
{
  const guint64 row_shape[] = { a, b };
  ClothOutput *output = cloth_parts_open (writer->parts, array_names[array],
      error);

  if (output)
    writer->arrays[array] = cloth_npy_writer_new (output, type, rank, row_shape,
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
  if (errno == EEXIST)
    errno = ENOTDIR;
  return cloth_file_fail (error, errno, "make the folder", writer->folder);
}

static gboolean
write_obj (ClothTakeWriter * writer, const gchar * file, const gchar * name,
    const ClothTopology * topology, const gfloat * positions, GError ** error)
{
  g_autoptr (ClothOutput) output =
      cloth_parts_open (writer->parts, file, error);

  return output &&
      cloth_obj_write (output, name, topology, positions, 0, 1, error) &&
      cloth_output_commit (output, error);
}

/* In its file the mesh lies flat: a take needs only its faces and uv. */
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

static gboolean
write_json (ClothTakeWriter * writer, const ClothTakeInfo * info,
    GError ** error)
{
  g_autofree gchar *json = cloth_take_info_to_json (info);
  g_autoptr (ClothOutput) output =
      cloth_parts_open (writer->parts, JSON, error);

  return output && cloth_output_write (output, json, strlen (json), error) &&
      cloth_output_write (output, "\n", 1, error) &&
      cloth_output_commit (output, error);
}

/* @folder: the take; made when it is not there, but not its parents
 * @info: what take.json shall say; when `mesh` is set, the name of the OBJ file that
 *   is written from @topology. Meshes of obstacles are written under their names
 * @topology: the mesh
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * Starts a take. Frames are written as they come, into a hidden folder in @folder. Other
 * files in an existing folder stay.
 *
 * Returns: (transfer full): a writer, or %NULL
 */
ClothTakeWriter *
cloth_take_writer_new (const gchar * folder, const ClothTakeInfo * info,
    const ClothTopology * topology, GError ** error)
{
  g_autoptr (ClothTakeWriter) writer = g_new0 (ClothTakeWriter, 1);
  g_autofree gchar *head = g_build_filename (folder, JSON, NULL);

  writer->folder = g_strdup (folder);
  writer->n_vertices = topology->n_vertices;
  writer->n_held = info->held->len;
  if (!make_folder (writer, error) ||
      !(writer->parts = cloth_parts_new (head, "", error)) ||
      !write_json (writer, info, error) || (info->mesh
          && !write_mesh (writer, info, topology, error))
      || !write_obstacles (writer, info, error)
      || !start_array (writer, POSITIONS, CLOTH_NPY_FLOAT32, 3,
          writer->n_vertices, 3, error)
      || !start_array (writer, TIMES, CLOTH_NPY_FLOAT64, 1, 0, 0, error)
      || !start_array (writer, STATES, CLOTH_NPY_UINT8, 2, writer->n_vertices,
          0, error))
    return NULL;
  return g_steal_pointer (&writer);
}

/* Some frames may come without covariances: theirs are written as NaN. */
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
    if (!start_array (writer, COVARIANCES, CLOTH_NPY_FLOAT32, 3,
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
      !start_array (writer, CLAMPS, CLOTH_NPY_FLOAT32, 3, writer->n_held, 3,
          error))
    return FALSE;
  if (!writer->arrays[CLAMPS])
    return TRUE;
  if (!clamps)
    return cloth_file_invalid (error,
        "a frame lacks the clamps that the first one had");
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
          time_s <= writer->last_time))
    return cloth_file_invalid (error,
        "frame %" G_GUINT64_FORMAT " is not later than the one before",
        writer->n_frames);
  if (!cloth_npy_writer_append (writer->arrays[POSITIONS], positions, 1,
          error) ||
      !cloth_npy_writer_append (writer->arrays[TIMES], &time_s, 1, error) ||
      !cloth_npy_writer_append (writer->arrays[STATES], states, 1, error) ||
      !append_covariances (writer, covariances, error) ||
      !append_clamps (writer, clamps, error))
    return FALSE;
  writer->last_time = time_s;
  writer->n_frames++;
  return cloth_parts_note_frame (writer->parts, error);
}

/* @writer: a writer that has at least one frame
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * Gives every file its name, take.json last: without it the folder is no take. Arrays of
 * an earlier take in the same folder that this one does not have go; they would be read
 * with it. The writer can then only be freed.
 *
 * Returns: %TRUE when the take is there
 */
gboolean
cloth_take_writer_close (ClothTakeWriter * writer, GError ** error)
{
  if (writer->n_frames == 0)
    return cloth_file_invalid (error, "a take needs at least one frame");
  for (guint i = 0; i < N_ARRAYS; i++) {
    if (!writer->arrays[i])
      cloth_parts_replace (writer->parts, array_names[i]);
    else if (!cloth_npy_writer_finish (writer->arrays[i], error))
      return FALSE;
  }
  if (!cloth_parts_commit (writer->parts, error))
    return FALSE;
  writer->made_folder = FALSE;
  return TRUE;
}

/* @writer: a writer that can't go on, or whose close failed
 *
 * The frames taken so far stay when it is freed, to be finished by cloth_recover().
 *
 * Returns: whether there are such frames
 */
gboolean
cloth_take_writer_leave (ClothTakeWriter * writer)
{
  return cloth_parts_leave (writer->parts);
}

/* @writer: (transfer full) (nullable): a writer
 *
 * Frees it; a take that was not closed leaves nothing behind, unless
 * cloth_take_writer_leave() said so.
 */
void
cloth_take_writer_free (ClothTakeWriter * writer)
{
  if (!writer)
    return;
  for (guint i = 0; i < N_ARRAYS; i++)
    cloth_npy_writer_free (writer->arrays[i]);
  cloth_parts_free (writer->parts);
  /* Only an empty folder goes. */
  if (writer->made_folder)
    g_rmdir (writer->folder);
  g_free (writer->unknown);
  g_free (writer->folder);
  g_free (writer);
}

/* Where a computer loses its power, the end of a file may be zeros. */
static gboolean
count_rising_times (ClothParts * parts, guint64 * n_frames, GError ** error)
{
  g_autoptr (ClothNpyReader) reader = NULL;
  gdouble before = 0, time = 0;

  if (*n_frames == 0)
    return TRUE;
  reader = cloth_npy_part_open (parts, array_names[TIMES], error);
  if (!reader)
    return FALSE;
  for (guint64 i = 0; i < *n_frames; i++) {
    if (!cloth_npy_reader_read_double (reader, i, 1, &time, error))
      return FALSE;
    if (!isfinite (time) || (i > 0 && time <= before))
      *n_frames = i;
    before = time;
  }
  return TRUE;
}

/* Counts the rows of all arrays. One that begins later has too few when it was caught
 * being filled up: it is left out. */
static gboolean
count_rows (ClothParts * parts, guint64 n_rows[N_ARRAYS],
    ClothRecovered * recovered, GError ** error)
{
  guint64 most;

  for (guint i = 0; i < N_ARRAYS; i++) {
    g_autofree gchar *path = cloth_parts_get_path (parts, array_names[i]);

    n_rows[i] = G_MAXUINT64;
    if (i > STATES && !g_file_test (path, G_FILE_TEST_EXISTS))
      continue;
    if (!cloth_npy_part_count (parts, array_names[i], &n_rows[i], error))
      return FALSE;
  }
  most = MAX (n_rows[POSITIONS], MAX (n_rows[TIMES], n_rows[STATES]));
  recovered->n_frames = MIN (n_rows[POSITIONS], MIN (n_rows[TIMES],
          n_rows[STATES]));
  for (guint i = COVARIANCES; i < N_ARRAYS; i++) {
    if (n_rows[i] < recovered->n_frames - MIN (recovered->n_frames, 1)) {
      recovered->dropped = array_names[i];
      cloth_parts_drop (parts, array_names[i]);
      n_rows[i] = G_MAXUINT64;
    }
  }
  for (guint i = COVARIANCES; i < N_ARRAYS; i++)
    recovered->n_frames = MIN (recovered->n_frames, n_rows[i]);
  if (!count_rising_times (parts, &recovered->n_frames, error))
    return FALSE;
  recovered->n_left_out = most - recovered->n_frames;
  return TRUE;
}

/* @parts: what was left of a take
 * @base: not used: its files have names of their own
 * @recovered: (out): how much it is
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * A #ClothRecover.
 */
gboolean
cloth_take_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error)
{
  guint64 n_rows[N_ARRAYS];

  /* The arrays are begun after all that is written at once. */
  for (guint i = 0; i <= STATES; i++) {
    g_autofree gchar *path = cloth_parts_get_path (parts, array_names[i]);

    if (!g_file_test (path, G_FILE_TEST_EXISTS))
      return TRUE;
  }
  if (!count_rows (parts, n_rows, recovered, error))
    return FALSE;
  for (guint i = 0; recovered->n_frames > 0 && i < N_ARRAYS; i++) {
    if (n_rows[i] == G_MAXUINT64)
      cloth_parts_replace (parts, array_names[i]);
    else if (!cloth_npy_part_finish (parts, array_names[i],
            recovered->n_frames, error))
      return FALSE;
  }
  return TRUE;
}
