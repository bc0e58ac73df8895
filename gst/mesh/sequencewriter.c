/* Mesh sequences on disk, whatever their format: writing frame by frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/sequence.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <unistd.h>

#include "gst/mesh/hold.h"
#include "gst/mesh/npy.h"
#include "gst/mesh/obj.h"
#include "gst/mesh/pc2.h"
#include "gst/mesh/ply.h"
#include "gst/mesh/take.h"

struct _ClothMeshWriter
{
  ClothMeshFormat format;
  gchar *stem, *name;
  ClothTopology *topology;
  gint fps_n, fps_d;
  guint64 n_frames;
  ClothHold *hold;              /* NULL for a take, which keeps NaN */
  /* OBJ and PC2 */
  ClothOutput *obj;
  ClothPc2Writer *cache;
  ClothNpyWriter *states;
  /* PLY: the frames wait in a hidden folder */
  gchar *hidden;
  GByteArray *scratch;
  /* take */
  ClothTakeWriter *take;
};

static gboolean
fail_errno (GError ** error, const gchar * path)
{
  gint code = errno;

  g_set_error (error, G_IO_ERROR, g_io_error_from_errno (code),
      "cannot write “%s”: %s", path, g_strerror (code));
  return FALSE;
}

static gboolean
start_obj_pc2 (ClothMeshWriter * writer, GError ** error)
{
  const guint64 row_shape[] = { writer->topology->n_vertices };
  g_autofree gchar *obj = g_strconcat (writer->stem, ".obj", NULL);
  g_autofree gchar *pc2 = g_strconcat (writer->stem, ".pc2", NULL);
  g_autofree gchar *states = g_strconcat (writer->stem, ".states.npy", NULL);

  writer->obj = cloth_output_new (obj, error);
  if (!writer->obj)
    return FALSE;
  writer->cache = cloth_pc2_writer_new (pc2, writer->topology->n_vertices, 0,
      1, error);
  if (!writer->cache)
    return FALSE;
  writer->states = cloth_npy_writer_new (states, CLOTH_NPY_UINT8, 2, row_shape,
      error);
  return writer->states != NULL;
}

static gboolean
start_ply (ClothMeshWriter * writer, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (writer->stem);
  g_autofree gchar *base = g_path_get_basename (writer->stem);
  g_autofree gchar *name = g_strdup_printf (".%s.XXXXXX", base);
  g_autofree gchar *hidden = g_build_filename (folder, name, NULL);

  if (!g_mkdtemp_full (hidden, 0777))
    return fail_errno (error, folder);
  writer->hidden = g_steal_pointer (&hidden);
  writer->scratch = g_byte_array_new ();
  return TRUE;
}

/* A grid is told by its sizes, if these give the very same uv and faces. */
static gboolean
is_grid (const ClothTopology * topology)
{
  g_autoptr (ClothTopology) grid = NULL;
  const gfloat *last = topology->uv + 2 * (gsize) (topology->n_vertices - 1);

  if (topology->columns < 2 || topology->rows < 2 || last[0] < 1e-6f ||
      last[1] < 1e-6f)
    return FALSE;
  grid = cloth_topology_new_grid (topology->columns, topology->rows, last[0],
      last[1]);
  return cloth_topology_equal (grid, topology);
}

/* The shortest number that is this float32: 0.63, not 0.629999995. */
static gdouble
shortest (gfloat value)
{
  gdouble number = value;

  for (gint digits = 1; digits <= 9; digits++) {
    gchar format[8], text[G_ASCII_DTOSTR_BUF_SIZE];
    volatile gfloat narrowed;

    g_snprintf (format, sizeof format, "%%.%dg", digits);
    number = g_ascii_strtod (g_ascii_formatd (text, sizeof text, format, value),
        NULL);
    narrowed = (gfloat) number;
    if (narrowed == value)
      break;
  }
  return number;
}

static gboolean
start_take (ClothMeshWriter * writer, GError ** error)
{
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (writer->name);
  const ClothTopology *topology = writer->topology;

  info->fps = writer->fps_n > 0 ? (gdouble) writer->fps_n / writer->fps_d : 0;
  if (is_grid (topology)) {
    const gfloat *last = topology->uv + 2 * (gsize) (topology->n_vertices - 1);

    info->columns = topology->columns;
    info->rows = topology->rows;
    info->width_m = shortest (last[0]);
    info->height_m = shortest (last[1]);
  } else {
    info->mesh = g_strdup ("mesh.obj");
  }
  writer->take = cloth_take_writer_new (writer->stem, info, topology, error);
  return writer->take != NULL;
}

/**
 * cloth_mesh_writer_new:
 * @location: file or folder; a take's folder is made, no other one
 * @format: its format
 * @name: (nullable): name of the object or take; by default, of the file
 * @topology: the mesh of every frame, copied
 * @fps_n: numerator of the frame rate, 0 when it varies
 * @fps_d: its denominator
 * @error: #ClothMeshError, #GIOErrorEnum
 *
 * Starts a sequence. Frames go to temporary names as they come; nothing but the
 * current one is held. The files get their names at the close.
 *
 * Returns: (transfer full): a writer, or %NULL
 * Since: 0.1
 */
ClothMeshWriter *
cloth_mesh_writer_new (const gchar * location, ClothMeshFormat format,
    const gchar * name, const ClothTopology * topology, gint fps_n, gint fps_d,
    GError ** error)
{
  g_autoptr (ClothMeshWriter) writer = g_new0 (ClothMeshWriter, 1);
  gboolean started = FALSE;

  if (format == CLOTH_MESH_FORMAT_AUTO)
    format = cloth_mesh_format_guess (location);
  writer->format = format;
  writer->stem = cloth_mesh_format_stem (location, format);
  writer->name = name ? g_strdup (name) : g_path_get_basename (writer->stem);
  writer->fps_n = fps_n;
  writer->fps_d = fps_d;
  if (!cloth_topology_check (topology, error))
    return NULL;
  writer->topology = cloth_topology_copy (topology);
  switch (format) {
    case CLOTH_MESH_FORMAT_PLY:
      started = start_ply (writer, error);
      break;
    case CLOTH_MESH_FORMAT_TAKE:
      started = start_take (writer, error);
      break;
    default:
      started = start_obj_pc2 (writer, error);
      break;
  }
  if (!started)
    return NULL;
  if (format != CLOTH_MESH_FORMAT_TAKE)
    writer->hold = cloth_hold_new (topology);
  return g_steal_pointer (&writer);
}

static gboolean
append_obj_pc2 (ClothMeshWriter * writer, const gfloat * positions,
    const ClothMeshFrame * frame, GError ** error)
{
  /* The OBJ file shows the first frame. */
  if (writer->n_frames == 0 && !cloth_obj_write (writer->obj, writer->name,
          writer->topology, positions, writer->fps_n, writer->fps_d, error))
    return FALSE;
  return cloth_pc2_writer_append (writer->cache, positions, error) &&
      cloth_npy_writer_append (writer->states, frame->states, 1, error);
}

static gchar *
hidden_path (const ClothMeshWriter * writer, guint64 frame)
{
  return g_strdup_printf ("%s/%05" G_GUINT64_FORMAT, writer->hidden, frame);
}

static gchar *
final_path (const ClothMeshWriter * writer, guint64 frame)
{
  return g_strdup_printf ("%s_%05" G_GUINT64_FORMAT ".ply", writer->stem,
      frame);
}

static gboolean
append_ply (ClothMeshWriter * writer, const gfloat * positions,
    const ClothMeshFrame * frame, GError ** error)
{
  g_autofree gchar *path = hidden_path (writer, writer->n_frames);
  g_autoptr (ClothOutput) output = cloth_output_new (path, error);

  if (!output)
    return FALSE;
  cloth_output_set_sync (output, FALSE);
  return cloth_ply_write (output, writer->topology, positions, frame->states,
      frame->covariances, writer->fps_n, writer->fps_d, writer->scratch, error)
      && cloth_output_commit (&output, 1, error);
}

/**
 * cloth_mesh_writer_append:
 * @writer: a writer
 * @time_s: time of the frame, seconds; only a take keeps it
 * @frame: the frame
 * @error: #ClothMeshError, #GIOErrorEnum
 *
 * Returns: %TRUE when the frame was taken
 * Since: 0.1
 */
gboolean
cloth_mesh_writer_append (ClothMeshWriter * writer, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  const gfloat *positions;
  gboolean taken;

  if (!cloth_positions_check (frame->positions, writer->topology->n_vertices,
          error) || !cloth_states_check (frame->states,
          writer->topology->n_vertices, error))
    return FALSE;
  positions = writer->hold ? cloth_hold_apply (writer->hold, frame->positions)
      : frame->positions;
  if (writer->take)
    taken = cloth_take_writer_append (writer->take, time_s, positions,
        frame->states, frame->covariances, NULL, error);
  else if (writer->hidden)
    taken = append_ply (writer, positions, frame, error);
  else
    taken = append_obj_pc2 (writer, positions, frame, error);
  if (taken)
    writer->n_frames++;
  return taken;
}

/**
 * cloth_mesh_writer_get_n_frames:
 * @writer: a writer
 *
 * Returns: frames taken so far
 * Since: 0.1
 */
guint64
cloth_mesh_writer_get_n_frames (const ClothMeshWriter * writer)
{
  return writer->n_frames;
}

static gboolean
close_obj_pc2 (ClothMeshWriter * writer, GError ** error)
{
  g_autoptr (ClothOutput) cache =
      cloth_pc2_writer_finish (writer->cache, error);
  g_autoptr (ClothOutput) states = cache ?
      cloth_npy_writer_finish (writer->states, error) : NULL;
  ClothOutput *outputs[] = { states, cache, writer->obj };

  return states && cloth_output_commit (outputs, G_N_ELEMENTS (outputs), error);
}

/* All frames to the disk at once, where the system can. */
static gboolean
sync_ply (ClothMeshWriter * writer, GError ** error)
{
#ifdef __linux__
  gint fd = g_open (writer->hidden, O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0);
  gboolean done = fd >= 0 && syncfs (fd) == 0;

  if (!done)
    fail_errno (error, writer->stem);
  if (fd >= 0)
    close (fd);
  return done;
#else
  sync ();
  return TRUE;
#endif
}

static gboolean
close_ply (ClothMeshWriter * writer, GError ** error)
{
  if (!sync_ply (writer, error))
    return FALSE;
  for (guint64 frame = 0; frame < writer->n_frames; frame++) {
    g_autofree gchar *from = hidden_path (writer, frame);
    g_autofree gchar *to = final_path (writer, frame);

    if (g_rename (from, to) < 0) {
      fail_errno (error, to);
      for (guint64 done = 0; done < frame; done++) {
        g_autofree gchar *path = final_path (writer, done);

        g_unlink (path);
      }
      return FALSE;
    }
  }
  /* The rest of a longer sequence of this name would be read as part of it. */
  for (guint64 frame = writer->n_frames;; frame++) {
    g_autofree gchar *stale = final_path (writer, frame);

    if (g_unlink (stale) < 0)
      break;
  }
  return TRUE;
}

/**
 * cloth_mesh_writer_close:
 * @writer: a writer that has at least one frame
 * @error: #ClothMeshError, #GIOErrorEnum
 *
 * Gives the files their names, replacing those of an earlier sequence. The writer
 * can then only be freed.
 *
 * Returns: %TRUE when the sequence is there
 * Since: 0.1
 */
gboolean
cloth_mesh_writer_close (ClothMeshWriter * writer, GError ** error)
{
  if (writer->n_frames == 0) {
    g_set_error (error, CLOTH_MESH_ERROR, CLOTH_MESH_ERROR_INVALID,
        "there is no frame to write");
    return FALSE;
  }
  if (writer->take)
    return cloth_take_writer_close (writer->take, error);
  return writer->hidden ? close_ply (writer, error) :
      close_obj_pc2 (writer, error);
}

static void
remove_hidden (ClothMeshWriter * writer)
{
  for (guint64 frame = 0; frame < writer->n_frames; frame++) {
    g_autofree gchar *path = hidden_path (writer, frame);

    g_unlink (path);
  }
  g_rmdir (writer->hidden);
}

/**
 * cloth_mesh_writer_free:
 * @writer: (transfer full) (nullable): a writer
 *
 * Frees it; a sequence that was not closed leaves nothing behind.
 *
 * Since: 0.1
 */
void
cloth_mesh_writer_free (ClothMeshWriter * writer)
{
  if (!writer)
    return;
  if (writer->hidden)
    remove_hidden (writer);
  if (writer->scratch)
    g_byte_array_unref (writer->scratch);
  cloth_output_free (writer->obj);
  cloth_pc2_writer_free (writer->cache);
  cloth_npy_writer_free (writer->states);
  cloth_take_writer_free (writer->take);
  cloth_hold_free (writer->hold);
  cloth_topology_free (writer->topology);
  g_free (writer->hidden);
  g_free (writer->stem);
  g_free (writer->name);
  g_free (writer);
}
