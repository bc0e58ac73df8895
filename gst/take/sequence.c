/* Mesh sequences on disk, whatever their format: read and written frame by frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/sequence.h"

#include <gio/gio.h>
#include <math.h>
#include <string.h>

#include "gst/file/npy.h"
#include "gst/mesh/formats/formats.h"
#include "gst/mesh/hold.h"
#include "gst/take/take.h"

struct _ClothMeshReader
{
  ClothMeshFormat format;
  ClothTopology *topology;      /* owned, but for a take */
  guint n_frames;
  gdouble fps;
  gfloat *positions;            /* one frame */
  guint8 *states;
  gfloat *covariances;          /* NULL without */
  /* OBJ and PC2 */
  ClothObj *obj;
  ClothPc2Reader *cache;        /* NULL: the OBJ file is the only frame */
  ClothNpyReader *state_rows;   /* may be NULL */
  guint n_seam_vertices;
  /* PLY */
  ClothPly *ply;
  ClothPlaced placed;           /* its first file */
  gchar *stem;
  gboolean single;              /* one file without a number */
  guint first;                  /* number of the first file */
  /* take */
  ClothTake *take;
};

struct _ClothMeshWriter
{
  const ClothExporter *exporter;
  ClothExportInfo info;
  gpointer export;
  ClothHold *hold;              /* NULL for formats that keep NaN */
  guint64 n_frames;
};

static gboolean
has_ending (const gchar * location, const gchar * ending)
{
  gsize n = strlen (location), m = strlen (ending);

  return n >= m && g_ascii_strcasecmp (location + n - m, ending) == 0;
}

/* Formats told by one ending, which the location may lack when the format is set. */
static const struct
{
  const gchar *ending;
  ClothMeshFormat format;
} endings[] = {
  {".ply", CLOTH_MESH_FORMAT_PLY}, {".glb", CLOTH_MESH_FORMAT_GLTF},
  {".usda", CLOTH_MESH_FORMAT_USD}, {".pvd", CLOTH_MESH_FORMAT_VTP},
  {".vtp", CLOTH_MESH_FORMAT_VTP}, {".c3d", CLOTH_MESH_FORMAT_C3D},
  {".csv", CLOTH_MESH_FORMAT_CSV}
};

/* @location: file or folder, there or not yet
 *
 * `.ply`, `.glb`, `.usda`, `.pvd` or `.vtp`, `.c3d` and `.csv` say their formats;
 * `.take`, `take.json`, a closing slash or a folder that is there is a take; anything
 * else is OBJ + PC2.
 *
 * Returns: the format
 */
ClothMeshFormat
cloth_mesh_format_guess (const gchar * location)
{
  g_autofree gchar *base = g_path_get_basename (location);

  for (guint i = 0; i < G_N_ELEMENTS (endings); i++)
    if (has_ending (location, endings[i].ending))
      return endings[i].format;
  if (has_ending (location, ".take") || has_ending (location, "/") ||
      g_str_equal (base, "take.json") ||
      g_file_test (location, G_FILE_TEST_IS_DIR))
    return CLOTH_MESH_FORMAT_TAKE;
  return CLOTH_MESH_FORMAT_OBJ_PC2;
}

/* A name's ending, dot included: a short word that begins with a letter, unlike the number of
 * a trial. NULL when it has none. */
static const gchar *
find_ending (const gchar * location)
{
  const gchar *slash = strrchr (location, G_DIR_SEPARATOR);
  const gchar *base = slash ? slash + 1 : location;
  const gchar *dot = strrchr (base, '.');

  if (!dot || dot == base || !g_ascii_isalpha (dot[1]) || strlen (dot) > 6)
    return NULL;
  for (guint i = 1; dot[i]; i++)
    if (!g_ascii_isalnum (dot[i]))
      return NULL;
  return dot;
}

/* @location: file or folder to write, as the user gave it
 * @format: its format
 * @error: #ClothFileError
 *
 * A name that ends as another format's files do would get files of another name than was
 * asked for, and one with an unknown ending OBJ + PC2.
 *
 * Returns: whether the location's ending, if it has one, is of the format
 */
gboolean
cloth_mesh_format_check (const gchar * location, ClothMeshFormat format,
    GError ** error)
{
  const gchar *ending = find_ending (location);
  const ClothMeshFormat guess = cloth_mesh_format_guess (location);
  gboolean known = guess != CLOTH_MESH_FORMAT_OBJ_PC2
      || has_ending (location, ".obj") || has_ending (location, ".pc2");

  if (!ending || (known && format == CLOTH_MESH_FORMAT_AUTO) || (known
          && format == guess) || (format == CLOTH_MESH_FORMAT_TAKE && !known))
    return TRUE;
  return cloth_file_invalid (error,
      "“%s”: the ending %s is not %s; give .obj (with .pc2 beside it), .ply, "
      ".glb (glTF), .usda (USD), .pvd (VTK), .c3d, .csv, or .take for a folder of "
      "NumPy arrays", location, ending,
      known ? "of the format that is set" : "known");
}

/* @location: file or folder as the user gave it
 * @format: a format, not %CLOTH_MESH_FORMAT_AUTO
 *
 * Returns: (transfer full): what the names of the files begin with; the folder of a
 *   take
 */
gchar *
cloth_mesh_format_stem (const gchar * location, ClothMeshFormat format)
{
  gsize n = strlen (location);

  switch (format) {
    case CLOTH_MESH_FORMAT_PLY:
      if (has_ending (location, "_%05d.ply"))
        return g_strndup (location, n - strlen ("_%05d.ply"));
      break;
    case CLOTH_MESH_FORMAT_TAKE:
      if (g_str_equal (location, "take.json"))
        return g_strdup (".");
      if (has_ending (location, "/take.json"))
        n -= strlen ("/take.json");
      while (n > 1 && location[n - 1] == '/')
        n--;
      return g_strndup (location, n);
    case CLOTH_MESH_FORMAT_OBJ_PC2:
      if (has_ending (location, ".obj") || has_ending (location, ".pc2"))
        return g_strndup (location, n - strlen (".obj"));
      break;
    default:
      break;
  }
  for (guint i = 0; i < G_N_ELEMENTS (endings); i++)
    if (format == endings[i].format && has_ending (location, endings[i].ending))
      return g_strndup (location, n - strlen (endings[i].ending));
  return g_strdup (location);
}

static gboolean
open_states (ClothMeshReader * reader, const gchar * stem, GError ** error)
{
  g_autofree gchar *path = g_strconcat (stem, ".states.npy", NULL);
  const ClothNpyInfo *info;

  if (!g_file_test (path, G_FILE_TEST_EXISTS))
    return TRUE;
  reader->state_rows = cloth_npy_reader_open (path, error);
  if (!reader->state_rows)
    return FALSE;
  info = cloth_npy_reader_get_info (reader->state_rows);
  if (info->type == CLOTH_NPY_UINT8 && info->rank == 2 &&
      info->shape[0] == reader->n_frames &&
      info->shape[1] == reader->topology->n_vertices)
    return TRUE;
  return cloth_file_invalid (error,
      "%s does not belong to the point cache beside it: remove it or write both "
      "again", path);
}

static gboolean
load_obj_pc2 (ClothMeshReader * reader, const gchar * stem,
    const gchar * obj_path, GError ** error)
{
  g_autofree gchar *pc2_path = g_strconcat (stem, ".pc2", NULL);
  const ClothPc2Info *info;

  reader->obj = cloth_obj_read (obj_path, error);
  if (!reader->obj)
    return FALSE;
  reader->topology = g_steal_pointer (&reader->obj->topology);
  reader->n_seam_vertices = reader->obj->n_seam_vertices;
  reader->fps = reader->obj->fps;
  reader->n_frames = 1;
  if (!g_file_test (pc2_path, G_FILE_TEST_EXISTS))
    return TRUE;
  reader->cache = cloth_pc2_reader_open (pc2_path, error);
  if (!reader->cache)
    return FALSE;
  info = cloth_pc2_reader_get_info (reader->cache);
  if (info->n_points != reader->topology->n_vertices)
    return cloth_file_invalid (error,
        "%s has %u points, the OBJ file %u vertices", pc2_path, info->n_points,
        reader->topology->n_vertices);
  if (info->n_samples == 0)
    return cloth_file_invalid (error, "the point cache has no samples");
  reader->n_frames = info->n_samples;
  return open_states (reader, stem, error);
}

static gboolean
open_obj_pc2 (ClothMeshReader * reader, const gchar * stem, GError ** error)
{
  g_autofree gchar *path = g_strconcat (stem, ".obj", NULL);
  ClothPlaced placed;

  return cloth_parts_begin_reading (path, &placed, error) &&
      load_obj_pc2 (reader, stem, path, error) &&
      cloth_parts_end_reading (path, &placed, error);
}

static gchar *
ply_path (const ClothMeshReader * reader, guint frame)
{
  if (reader->single)
    return g_strconcat (reader->stem, ".ply", NULL);
  return g_strdup_printf ("%s_%05u.ply", reader->stem, reader->first + frame);
}

static gboolean
ply_exists (const ClothMeshReader * reader, guint frame)
{
  g_autofree gchar *path = ply_path (reader, frame);

  return g_file_test (path, G_FILE_TEST_EXISTS);
}

static gboolean
read_ply (ClothMeshReader * reader, guint frame, GError ** error)
{
  g_autofree gchar *path = ply_path (reader, frame);
  g_autofree gchar *first = ply_path (reader, 0);

  return cloth_ply_read (reader->ply, path, error) &&
      cloth_parts_check_same (first, &reader->placed, error);
}

static gboolean
open_ply (ClothMeshReader * reader, const gchar * stem, GError ** error)
{
  g_autofree gchar *head = g_strconcat (stem, ".ply", NULL);
  g_autofree gchar *first = NULL;
  ClothPlaced placed;
  ClothPly *ply;
  ClothTopology *topology;

  if (!cloth_parts_begin_reading (head, &placed, error))
    return FALSE;
  reader->ply = ply = cloth_ply_new ();
  reader->stem = g_strdup (stem);
  /* Sequences of other programs often begin with 1. */
  if (!ply_exists (reader, 0)) {
    reader->first = 1;
    if (!ply_exists (reader, 0))
      reader->single = TRUE;
  }
  first = ply_path (reader, 0);
  reader->placed = cloth_parts_look_at (first);
  reader->n_frames = 1;
  while (!reader->single && ply_exists (reader, reader->n_frames))
    reader->n_frames++;
  if (!read_ply (reader, 0, error) ||
      !cloth_parts_end_reading (head, &placed, error))
    return FALSE;
  topology = cloth_topology_new (ply->n_vertices, ply->n_faces);
  memcpy (topology->uv, ply->uv, 2 * (gsize) ply->n_vertices * sizeof (gfloat));
  if (!ply->has_uv)
    memset (topology->uv, 0, 2 * (gsize) ply->n_vertices * sizeof (gfloat));
  /* A cloud of points has none, and then no data. */
  if (ply->n_faces > 0)
    memcpy (topology->faces, ply->faces->data, ply->faces->len *
        sizeof (guint32));
  reader->topology = topology;
  reader->fps = ply->note.fps;
  cloth_mesh_note_apply (&ply->note, topology);
  return cloth_topology_check (topology, error);
}

static gboolean
open_take (ClothMeshReader * reader, const gchar * folder, GError ** error)
{
  gsize n;

  reader->take = cloth_take_open (folder, error);
  if (!reader->take)
    return FALSE;
  reader->topology = (ClothTopology *) cloth_take_get_topology (reader->take);
  reader->n_frames = cloth_take_get_n_frames (reader->take);
  reader->fps = cloth_take_get_info (reader->take)->fps;
  if (!(reader->fps > 0))
    reader->fps = cloth_take_get_rate (reader->take);
  n = reader->topology->n_vertices;
  if (cloth_take_has_covariances (reader->take))
    reader->covariances = g_new (gfloat, 6 * n);
  return TRUE;
}

/* @location: file or folder
 * @format: its format
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Opens a sequence. Only the topology and one frame are held in memory.
 *
 * Returns: (transfer full): a reader, or %NULL
 */
ClothMeshReader *
cloth_mesh_reader_open (const gchar * location, ClothMeshFormat format,
    GError ** error)
{
  g_autoptr (ClothMeshReader) reader = g_new0 (ClothMeshReader, 1);
  g_autofree gchar *stem = NULL;
  g_autofree gchar *obj = g_strconcat (location, ".obj", NULL);
  gboolean opened = FALSE;

  /* a name with a dot in it may be there */
  if (!g_file_test (obj, G_FILE_TEST_EXISTS)
      && !cloth_mesh_format_check (location, format, error))
    return NULL;
  if (format == CLOTH_MESH_FORMAT_AUTO)
    format = cloth_mesh_format_guess (location);
  reader->format = format;
  stem = cloth_mesh_format_stem (location, format);
  switch (format) {
    case CLOTH_MESH_FORMAT_PLY:
      opened = open_ply (reader, stem, error);
      break;
    case CLOTH_MESH_FORMAT_TAKE:
      opened = open_take (reader, stem, error);
      break;
    case CLOTH_MESH_FORMAT_OBJ_PC2:
      opened = open_obj_pc2 (reader, stem, error);
      break;
    default:
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
          "%s: this format is written, not read: keep a take, OBJ + PC2 or PLY to "
          "read the sequence again", location);
      break;
  }
  if (!opened)
    return NULL;
  reader->positions = g_new (gfloat, 3 * (gsize) reader->topology->n_vertices);
  reader->states = g_new (guint8, reader->topology->n_vertices);
  return g_steal_pointer (&reader);
}

/* @reader: a reader
 *
 * Returns: (transfer none): the mesh of every frame
 */
const ClothTopology *
cloth_mesh_reader_get_topology (const ClothMeshReader * reader)
{
  return reader->topology;
}

/* @reader: a reader
 *
 * Returns: number of frames, at least 1
 */
guint
cloth_mesh_reader_get_n_frames (const ClothMeshReader * reader)
{
  return reader->n_frames;
}

/* @reader: a reader
 *
 * Returns: frames a second, 0 when the files do not say
 */
gdouble
cloth_mesh_reader_get_fps (const ClothMeshReader * reader)
{
  return reader->fps;
}

/* @reader: a reader
 *
 * Returns: (transfer none) (nullable): the time of every frame, seconds, rising
 */
const gdouble *
cloth_mesh_reader_get_times (const ClothMeshReader * reader)
{
  return reader->take ? cloth_take_get_times (reader->take) : NULL;
}

/* @reader: a reader
 *
 * Returns: vertices that an OBJ file gives more than one uv, of which the first was
 *   kept
 */
guint
cloth_mesh_reader_get_n_seam_vertices (const ClothMeshReader * reader)
{
  return reader->n_seam_vertices;
}

static gboolean
read_obj_pc2 (ClothMeshReader * reader, guint frame, GError ** error)
{
  guint n = reader->topology->n_vertices;

  if (!reader->cache)
    memcpy (reader->positions, reader->obj->positions,
        3 * (gsize) n * sizeof (gfloat));
  else if (!cloth_pc2_reader_read (reader->cache, frame, reader->positions,
          error))
    return FALSE;
  if (!cloth_positions_check (reader->positions, n, error))
    return FALSE;
  if (reader->state_rows) {
    if (!cloth_npy_reader_read_raw (reader->state_rows, frame, 1,
            reader->states, error) ||
        !cloth_states_check (reader->states, n, error))
      return FALSE;
  } else {
    memset (reader->states, CLOTH_VERTEX_MEASURED, n);
  }
  return TRUE;
}

static gboolean
read_ply_frame (ClothMeshReader * reader, guint frame,
    ClothMeshFrame * contents, GError ** error)
{
  const ClothTopology *topology = reader->topology;
  const ClothPly *ply = reader->ply;

  if (!read_ply (reader, frame, error))
    return FALSE;
  if (ply->n_vertices != topology->n_vertices ||
      ply->n_faces != topology->n_faces || (ply->n_faces > 0 &&
          memcmp (ply->faces->data, topology->faces,
              ply->faces->len * sizeof (guint32)) != 0))
    return cloth_file_invalid (error,
        "file %u of the PLY sequence has another mesh than the first one",
        reader->first + frame);
  contents->positions = ply->positions;
  contents->states = ply->states;
  contents->covariances = ply->has_covariances ? ply->covariances : NULL;
  return TRUE;
}

static gboolean
read_take (ClothMeshReader * reader, guint frame, GError ** error)
{
  return cloth_take_read_positions (reader->take, frame, reader->positions,
      error) && cloth_take_read_states (reader->take, frame,
      reader->positions, reader->states, error) &&
      (!reader->covariances || cloth_take_read_covariances (reader->take,
          frame, reader->covariances, error));
}

/* @reader: a reader
 * @frame: which frame
 * @contents: (out): set to the frame; valid until the next call
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Vertices that the files call unseen are NaN, whatever place they hold there.
 *
 * Returns: %TRUE when the frame was read and is valid
 */
gboolean
cloth_mesh_reader_read (ClothMeshReader * reader, guint frame,
    ClothMeshFrame * contents, GError ** error)
{
  if (frame >= reader->n_frames)
    return cloth_file_invalid (error,
        "frame %u of %u", frame, reader->n_frames);
  if (reader->format == CLOTH_MESH_FORMAT_PLY)
    return read_ply_frame (reader, frame, contents, error);
  if (reader->take ? !read_take (reader, frame, error) :
      !read_obj_pc2 (reader, frame, error))
    return FALSE;
  for (gsize i = 0; i < reader->topology->n_vertices; i++) {
    if (isnan (reader->positions[3 * i]))
      reader->states[i] = CLOTH_VERTEX_UNSEEN;
    else if (reader->states[i] == CLOTH_VERTEX_UNSEEN)
      for (guint k = 0; k < 3; k++)
        reader->positions[3 * i + k] = NAN;
  }
  contents->positions = reader->positions;
  contents->states = reader->states;
  contents->covariances = reader->covariances;
  return TRUE;
}

/* @reader: (transfer full) (nullable): a reader
 */
void
cloth_mesh_reader_free (ClothMeshReader * reader)
{
  if (!reader)
    return;
  if (!reader->take)
    cloth_topology_free (reader->topology);
  cloth_take_free (reader->take);
  cloth_obj_free (reader->obj);
  cloth_pc2_reader_free (reader->cache);
  cloth_npy_reader_free (reader->state_rows);
  cloth_ply_free (reader->ply);
  g_free (reader->stem);
  g_free (reader->positions);
  g_free (reader->states);
  g_free (reader->covariances);
  g_free (reader);
}

/* Writing */

static gpointer
start_take (const ClothExportInfo * export, GError ** error)
{
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (export->name);

  info->fps = export->fps_n > 0 ? (gdouble) export->fps_n / export->fps_d : 0;
  cloth_take_info_set_mesh (info, export->topology);
  return cloth_take_writer_new (export->stem, info, export->topology, error);
}

static gboolean
append_take (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  return cloth_take_writer_append (export, time_s, frame->positions,
      frame->states, frame->covariances, NULL, error);
}

static gboolean
finish_take (gpointer export, GError ** error)
{
  return cloth_take_writer_close (export, error);
}

static void
free_take (gpointer export)
{
  cloth_take_writer_free (export);
}

static const ClothExporter take_exporter = {
  TRUE, NULL, TRUE, start_take, append_take, finish_take, free_take
};

/* by ClothMeshFormat */
static const ClothExporter *const exporters[] = {
  NULL, &cloth_obj_pc2_exporter, &cloth_ply_exporter, &take_exporter,
  &cloth_gltf_exporter, &cloth_usd_exporter, &cloth_vtp_exporter,
  &cloth_c3d_exporter, &cloth_csv_exporter
};

/* @location: file or folder as the user gave it
 * @format: its format
 *
 * Returns: (transfer full): the file that readers open first; of numbered files, their
 *   stem with the ending
 */
gchar *
cloth_mesh_format_head (const gchar * location, ClothMeshFormat format)
{
  g_autofree gchar *stem = NULL;

  if (format == CLOTH_MESH_FORMAT_AUTO)
    format = cloth_mesh_format_guess (location);
  stem = cloth_mesh_format_stem (location, format);
  if (!exporters[format]->ending)
    return g_build_filename (stem, "take.json", NULL);
  return g_strconcat (stem, exporters[format]->ending, NULL);
}

/* @location: file or folder; a take's folder is made, no other one
 * @format: its format
 * @name: (nullable): name of the object or take; by default, of the file
 * @topology: the mesh of every frame, copied
 * @fps_n: numerator of the frame rate, 0 when it varies
 * @fps_d: its denominator
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Starts a sequence. Frames go to temporary names as they come; nothing but the
 * current one is held. The files get their names at the close.
 *
 * Returns: (transfer full): a writer, or %NULL
 */
ClothMeshWriter *
cloth_mesh_writer_new (const gchar * location, ClothMeshFormat format,
    const gchar * name, const ClothTopology * topology, gint fps_n, gint fps_d,
    GError ** error)
{
  g_autoptr (ClothMeshWriter) writer = NULL;
  g_autofree gchar *note = NULL;
  g_autofree gchar *head = NULL;

  if (!cloth_mesh_format_check (location, format, error))
    return NULL;
  if (format == CLOTH_MESH_FORMAT_AUTO)
    format = cloth_mesh_format_guess (location);
  g_return_val_if_fail (format < G_N_ELEMENTS (exporters), NULL);
  if (!cloth_topology_check (topology, error))
    return NULL;
  writer = g_new0 (ClothMeshWriter, 1);
  writer->exporter = exporters[format];
  writer->info.stem = cloth_mesh_format_stem (location, format);
  writer->info.base = g_path_get_basename (writer->info.stem);
  writer->info.name = g_strdup (name ? name : writer->info.base);
  writer->info.fps_n = fps_n;
  writer->info.fps_d = fps_d;
  writer->info.topology = cloth_topology_copy (topology);
  if (writer->exporter->ending) {
    note = g_strdup_printf ("%u", topology->n_vertices);
    head = cloth_mesh_format_head (location, format);
    /* The location itself, which may lack the ending, is no name for a file either. */
    if (!cloth_file_check_target (location, error) ||
        !(writer->info.parts = cloth_parts_new (head, note, error)))
      return NULL;
  }
  writer->export = writer->exporter->start (&writer->info, error);
  if (!writer->export)
    return NULL;
  if (!writer->exporter->keeps_nan)
    writer->hold = cloth_hold_new (topology);
  return g_steal_pointer (&writer);
}

/* @writer: a writer
 * @time_s: time of the frame, seconds; OBJ + PC2, PLY and C3D don't keep it
 * @frame: the frame
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when the frame was taken
 */
gboolean
cloth_mesh_writer_append (ClothMeshWriter * writer, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  ClothMeshFrame shown = *frame;

  if (!cloth_positions_check (frame->positions,
          writer->info.topology->n_vertices, error) ||
      !cloth_states_check (frame->states, writer->info.topology->n_vertices,
          error))
    return FALSE;
  if (writer->hold)
    shown.positions = cloth_hold_apply (writer->hold, frame->positions);
  if (!writer->exporter->append (writer->export, writer->n_frames, time_s,
          &shown, error))
    return FALSE;
  writer->n_frames++;
  return !writer->info.parts || !writer->exporter->lasts ||
      cloth_parts_note_frame (writer->info.parts, error);
}

/* @writer: a writer
 *
 * Returns: frames taken so far
 */
guint64
cloth_mesh_writer_get_n_frames (const ClothMeshWriter * writer)
{
  return writer->n_frames;
}

/* @writer: a writer that has at least one frame
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Gives the files their names, replacing those of an earlier sequence. The writer
 * can then only be freed.
 *
 * Returns: %TRUE when the sequence is there
 */
gboolean
cloth_mesh_writer_close (ClothMeshWriter * writer, GError ** error)
{
  if (writer->n_frames == 0)
    return cloth_file_invalid (error, "there is no frame to write");
  return writer->exporter->finish (writer->export, error) &&
      (!writer->info.parts || cloth_parts_commit (writer->info.parts, error));
}

/* @writer: a writer that can't go on, or whose close failed
 *
 * The frames taken so far stay when it is freed, to be finished by cloth_recover(), where
 * the format allows that.
 *
 * Returns: whether there are such frames
 */
gboolean
cloth_mesh_writer_leave (ClothMeshWriter * writer)
{
  return writer->info.parts ? cloth_parts_leave (writer->info.parts) :
      cloth_take_writer_leave (writer->export);
}

/* @writer: (transfer full) (nullable): a writer
 *
 * Frees it; a sequence that was not closed leaves nothing behind, unless
 * cloth_mesh_writer_leave() said so.
 */
void
cloth_mesh_writer_free (ClothMeshWriter * writer)
{
  if (!writer)
    return;
  if (writer->export)
    writer->exporter->free (writer->export);
  cloth_parts_free (writer->info.parts);
  cloth_hold_free (writer->hold);
  cloth_topology_free (writer->info.topology);
  g_free (writer->info.stem);
  g_free (writer->info.base);
  g_free (writer->info.name);
  g_free (writer);
}
