/* Recordings of other programs, as they are in their files: tables, C3D, NumPy, point caches,
 * numbered meshes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/import-source.h"

#include <math.h>
#include <string.h>

#include "gst/file/npy.h"
#include "gst/take/sequence.h"

/* Files of a numbered sequence. */
#define MAX_FILES 100000u

static gboolean
read_pc2 (ClothImportSource * source, const gchar * path, GError ** error)
{
  g_autoptr (ClothPc2Reader) reader = cloth_pc2_reader_open (path, error);
  const ClothPc2Info *info;

  if (!reader)
    return FALSE;
  info = cloth_pc2_reader_get_info (reader);
  source->markers = cloth_markers_new (info->n_samples, info->n_points, error);
  if (!source->markers)
    return FALSE;
  source->markers->layout = "a point cache";
  for (guint i = 0; i < info->n_samples; i++)
    if (!cloth_pc2_reader_read (reader, i, source->markers->positions +
            3 * (gsize) i * info->n_points, error))
      return FALSE;
  return TRUE;
}

/* A sequence as our own programs write it; what was not seen is NaN. */
static gboolean
read_sequence (ClothImportSource * source, const gchar * path,
    const gchar * layout, GError ** error)
{
  g_autoptr (ClothMeshReader) reader =
      cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, error);
  const gdouble *times;
  gsize n;

  if (!reader)
    return FALSE;
  source->topology = cloth_topology_copy (cloth_mesh_reader_get_topology
      (reader));
  n = source->topology->n_vertices;
  source->markers = cloth_markers_new (cloth_mesh_reader_get_n_frames (reader),
      n, error);
  if (!source->markers)
    return FALSE;
  source->markers->layout = layout;
  source->markers->fps = cloth_mesh_reader_get_fps (reader);
  times = cloth_mesh_reader_get_times (reader);
  if (times)
    source->markers->times = g_memdup2 (times, source->markers->n_frames *
        sizeof *times);
  for (guint i = 0; i < source->markers->n_frames; i++) {
    ClothMeshFrame frame;

    if (!cloth_mesh_reader_read (reader, i, &frame, error))
      return FALSE;
    memcpy (source->markers->positions + 3 * i * n, frame.positions,
        3 * n * sizeof (gfloat));
  }
  return TRUE;
}

/* ---- numbered files ---- */

typedef struct
{
  guint64 number;
  gchar *path;
} Numbered;

static void
numbered_clear (gpointer data)
{
  g_free (((Numbered *) data)->path);
}

static gint
compare_numbers (gconstpointer a, gconstpointer b)
{
  const guint64 x = ((const Numbered *) a)->number;
  const guint64 y = ((const Numbered *) b)->number;

  return (x > y) - (x < y);
}

/* Splits `frame_0012.obj` into what stands before its number, the number and the ending. FALSE
 * without a number. */
static gboolean
split_name (const gchar * name, gsize * first, gsize * last, guint64 * number)
{
  const gchar *dot = strrchr (name, '.');
  gsize end = dot ? (gsize) (dot - name) : strlen (name), begin = end;

  while (begin > 0 && g_ascii_isdigit (name[begin - 1]))
    begin--;
  *first = begin;
  *last = end;
  if (end - begin == 0 || end - begin > 15)
    return FALSE;
  *number = g_ascii_strtoull (name + begin, NULL, 10);
  return TRUE;
}

/* Returns: (element-type Numbered): the file and those that follow it; only itself when its
 * name has no number */
static GArray *
find_series (const gchar * path, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (path);
  g_autofree gchar *base = g_path_get_basename (path);
  g_autoptr (GArray) files = g_array_new (FALSE, FALSE, sizeof (Numbered));
  g_autoptr (GDir) dir = NULL;
  Numbered file = { 0 };
  guint64 start;
  gsize first, last, a, b;
  const gchar *name;

  g_array_set_clear_func (files, numbered_clear);
  if (!split_name (base, &first, &last, &start)) {
    file.path = g_strdup (path);
    g_array_append_val (files, file);
    return g_steal_pointer (&files);
  }
  dir = g_dir_open (folder, 0, error);
  if (!dir)
    return NULL;
  while ((name = g_dir_read_name (dir))) {
    if (!split_name (name, &a, &b, &file.number) || a != first ||
        strncmp (name, base, first) != 0 || strcmp (name + b, base + last) != 0
        || file.number < start)
      continue;
    if (files->len == MAX_FILES) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
          "%s: more than %u files of this name: import them in parts", path,
          MAX_FILES);
      return NULL;
    }
    file.path = g_build_filename (folder, name, NULL);
    g_array_append_val (files, file);
  }
  g_array_sort (files, compare_numbers);
  for (guint i = 1; i < files->len; i++)
    if (g_array_index (files, Numbered, i).number !=
        g_array_index (files, Numbered, i - 1).number + 1) {
      cloth_file_invalid (error, "%s and %s are not neighbours: a file between "
          "them is missing, or a number is there twice",
          g_array_index (files, Numbered, i - 1).path,
          g_array_index (files, Numbered, i).path);
      return NULL;
    }
  if (files->len == 0) {
    cloth_file_invalid (error, "%s: there is no such file", path);
    return NULL;
  }
  return g_steal_pointer (&files);
}

/* @faces: of the first file, with which all must agree */
static gboolean
check_same (const ClothTopology * first, guint n_vertices, guint n_faces,
    const guint32 * faces, const gchar * path, GError ** error)
{
  if (n_vertices == first->n_vertices && n_faces == first->n_faces &&
      (n_faces == 0 || memcmp (faces, first->faces,
              4 * (gsize) n_faces * sizeof *faces) == 0))
    return TRUE;
  return cloth_file_invalid (error, "%s: another mesh than that of the first "
      "file; all frames need the same vertices and faces", path);
}

static gboolean
take_frame (ClothImportSource * source, guint frame, guint n_frames,
    const gfloat * positions, GError ** error)
{
  const gsize n = source->topology->n_vertices;

  if (!source->markers) {
    source->markers = cloth_markers_new (n_frames, n, error);
    if (!source->markers)
      return FALSE;
  }
  memcpy (source->markers->positions + 3 * frame * n, positions,
      3 * n * sizeof *positions);
  return TRUE;
}

/* Where the uv of an OBJ file have seams, the mesh in parts. */
static gboolean
split_obj (ClothImportSource * source, const ClothObj * obj, GError ** error)
{
  if (!obj->corner_uv)
    return TRUE;
  source->split = cloth_split_new (obj->topology, obj->corner_uv, error);
  return source->split != NULL;
}

static gboolean
read_obj_files (ClothImportSource * source, const GArray * files,
    GError ** error)
{
  for (guint i = 0; i < files->len; i++) {
    const gchar *path = g_array_index (files, Numbered, i).path;
    g_autoptr (ClothObj) obj = cloth_obj_read (path, error);
    gdouble fps;

    if (!obj)
      return FALSE;
    fps = obj->fps;
    if (i == 0) {
      source->has_uv = obj->has_uv;
      source->topology = cloth_topology_copy (obj->topology);
      if (!split_obj (source, obj, error))
        return FALSE;
    }
    if (!check_same (source->topology, obj->topology->n_vertices,
            obj->topology->n_faces, obj->topology->faces, path, error) ||
        !take_frame (source, i, files->len, obj->positions, error))
      return FALSE;
    source->markers->fps = fps;
  }
  source->markers->layout = files->len > 1 ? "numbered OBJ files" : "OBJ";
  return TRUE;
}

static gboolean
read_ply_files (ClothImportSource * source, const GArray * files,
    GError ** error)
{
  ClothPly *ply = cloth_ply_new ();
  gboolean done = TRUE;

  for (guint i = 0; i < files->len && done; i++) {
    const gchar *path = g_array_index (files, Numbered, i).path;

    done = cloth_ply_read (ply, path, error);
    if (done && i == 0) {
      source->has_uv = ply->has_uv;
      source->topology = cloth_topology_new (ply->n_vertices, ply->n_faces);
      memset (source->topology->uv, 0,
          2 * (gsize) ply->n_vertices * sizeof (gfloat));
      if (ply->has_uv)
        memcpy (source->topology->uv, ply->uv,
            2 * (gsize) ply->n_vertices * sizeof (gfloat));
      /* A cloud of points has none, and then no data. */
      if (ply->n_faces > 0)
        memcpy (source->topology->faces, ply->faces->data,
            ply->faces->len * sizeof (guint32));
      cloth_mesh_note_apply (&ply->note, source->topology);
    }
    for (gsize k = 0; done && ply->has_states && k < ply->n_vertices; k++)
      if (ply->states[k] == CLOTH_VERTEX_UNSEEN)
        for (guint axis = 0; axis < 3; axis++)
          ply->positions[3 * k + axis] = NAN;
    done = done && check_same (source->topology, ply->n_vertices, ply->n_faces,
        ply->n_faces > 0 ? (const guint32 *) (gpointer) ply->faces->data : NULL,
        path, error) && take_frame (source, i, files->len, ply->positions,
        error);
    if (done)
      source->markers->fps = ply->note.fps;
  }
  if (done)
    source->markers->layout = files->len > 1 ? "numbered PLY files" : "PLY";
  cloth_ply_free (ply);
  return done;
}

static gboolean
is_of_floats (const ClothNpyInfo * info)
{
  return info->type == CLOTH_NPY_FLOAT32 || info->type == CLOTH_NPY_FLOAT64;
}

/* @frame: of @n_frames, whose files hold an array of places each */
static gboolean
read_npy_frame (ClothImportSource * source, const gchar * path, guint frame,
    guint n_frames, GError ** error)
{
  g_autoptr (ClothNpyReader) reader = cloth_npy_reader_open (path, error);
  const ClothNpyInfo *info;

  if (!reader)
    return FALSE;
  info = cloth_npy_reader_get_info (reader);
  if (!source->markers) {
    source->markers = cloth_markers_new (n_frames, info->n_rows, error);
    if (!source->markers)
      return FALSE;
  }
  if (!is_of_floats (info) || info->rank != 2 || info->row_items != 3 ||
      info->n_rows != source->markers->n_markers)
    return cloth_file_invalid (error,
        "%s: another shape than that of the first "
        "file; all frames need the same vertices", path);
  return cloth_npy_reader_read_float (reader, 0, info->n_rows,
      source->markers->positions + 3 * (gsize) frame * info->n_rows, error);
}

/* One array of all frames, or numbered ones of a frame each. */
static gboolean
read_npy (ClothImportSource * source, const gchar * path, GError ** error)
{
  g_autoptr (ClothNpyReader) reader = cloth_npy_reader_open (path, error);
  g_autoptr (GArray) files = NULL;
  const ClothNpyInfo *info;

  if (!reader)
    return FALSE;
  info = cloth_npy_reader_get_info (reader);
  if (!is_of_floats (info) || info->rank < 2 || info->rank > 3 ||
      info->row_items % 3 != 0 || (info->rank == 3 && info->shape[2] != 3))
    return cloth_file_invalid (error, "%s: positions are expected as floats of "
        "the shape [frames][vertices][3], or [vertices][3] in numbered files",
        path);
  if (info->rank == 2 && info->row_items == 3) {
    files = find_series (path, error);
    for (guint i = 0; files && i < files->len; i++)
      if (!read_npy_frame (source, g_array_index (files, Numbered, i).path, i,
              files->len, error))
        return FALSE;
    if (files)
      source->markers->layout = "numbered NumPy files";
    return files != NULL;
  }
  source->markers = cloth_markers_new (info->n_rows, info->row_items / 3,
      error);
  if (!source->markers)
    return FALSE;
  source->markers->layout = "NumPy";
  return cloth_npy_reader_read_float (reader, 0, info->n_rows,
      source->markers->positions, error);
}

/* The name of the file beside @path with another ending. */
static gchar *
beside (const gchar * path, const gchar * ending)
{
  g_autofree gchar *stem = g_strndup (path, strlen (path) - 4);

  return g_strconcat (stem, ending, NULL);
}

static gboolean
read_meshes (ClothImportSource * source, const gchar * path,
    gboolean ply, GError ** error)
{
  g_autoptr (GArray) files = find_series (path, error);

  if (!files)
    return FALSE;
  return ply ? read_ply_files (source, files, error) :
      read_obj_files (source, files, error);
}

static gboolean
read_obj_pc2 (ClothImportSource * source, const gchar * path, GError ** error)
{
  g_autofree gchar *obj_path = beside (path, ".obj");
  g_autoptr (ClothObj) obj = cloth_obj_read (obj_path, error);

  if (!obj)
    return FALSE;
  source->has_uv = obj->has_uv;
  return split_obj (source, obj, error) &&
      read_sequence (source, obj_path, "OBJ with a point cache", error);
}

/* @source: empty; to be cleared even after an error
 * @path: a file; of numbered ones the first
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads a recording in any of the formats.
 *
 * Returns: %TRUE when it was read
 */
gboolean
cloth_import_source_read (ClothImportSource * source, const gchar * path,
    GError ** error)
{
  g_autofree gchar *lower = g_ascii_strdown (path, -1);

  if (g_str_has_suffix (lower, ".obj") || g_str_has_suffix (lower, ".pc2")) {
    g_autofree gchar *obj = beside (path, ".obj");
    g_autofree gchar *pc2 = beside (path, ".pc2");

    if (!g_file_test (pc2, G_FILE_TEST_EXISTS))
      return read_meshes (source, path, FALSE, error);
    return g_file_test (obj, G_FILE_TEST_EXISTS) ?
        read_obj_pc2 (source, path, error) : read_pc2 (source, pc2, error);
  }
  if (g_str_has_suffix (lower, ".ply"))
    return read_meshes (source, path, TRUE, error);
  if (g_str_has_suffix (lower, ".npy"))
    return read_npy (source, path, error);
  source->markers = cloth_markers_read (path, error);
  return source->markers != NULL;
}

/* @source: a source */
void
cloth_import_source_clear (ClothImportSource * source)
{
  g_clear_pointer (&source->markers, cloth_markers_free);
  g_clear_pointer (&source->topology, cloth_topology_free);
  g_clear_pointer (&source->split, cloth_split_free);
}
