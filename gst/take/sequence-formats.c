/* Writing the formats that can be read back: OBJ + PC2, PLY, takes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/export.h"
#include "gst/file/npy.h"
#include "gst/mesh/formats/obj.h"
#include "gst/mesh/formats/pc2.h"
#include "gst/mesh/formats/ply.h"
#include "gst/take/take.h"

/* ---- OBJ + PC2 ---- */

typedef struct
{
  const ClothExportInfo *info;
  ClothOutput *obj;
  ClothPc2Writer *cache;
  ClothNpyWriter *states;
} ObjPc2;

static void
free_obj_pc2 (gpointer export)
{
  ObjPc2 *self = export;

  cloth_output_free (self->obj);
  cloth_pc2_writer_free (self->cache);
  cloth_npy_writer_free (self->states);
  g_free (self);
}

static gpointer
start_obj_pc2 (const ClothExportInfo * info, GError ** error)
{
  const guint64 row_shape[] = { info->topology->n_vertices };
  g_autofree gchar *pc2 = g_strconcat (info->stem, ".pc2", NULL);
  g_autofree gchar *states = g_strconcat (info->stem, ".states.npy", NULL);
  ObjPc2 *self = g_new0 (ObjPc2, 1);

  self->info = info;
  self->obj = cloth_export_open (info, ".obj", error);
  if (self->obj)
    self->cache = cloth_pc2_writer_new (pc2, info->topology->n_vertices, 0, 1,
        error);
  if (self->cache)
    self->states = cloth_npy_writer_new (states, CLOTH_NPY_UINT8, 2, row_shape,
        error);
  if (self->states)
    return self;
  free_obj_pc2 (self);
  return NULL;
}

static gboolean
append_obj_pc2 (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  ObjPc2 *self = export;
  const ClothExportInfo *info = self->info;

  /* The OBJ file shows the first frame. */
  if (number == 0 && !cloth_obj_write (self->obj, info->name, info->topology,
          frame->positions, info->fps_n, info->fps_d, error))
    return FALSE;
  return cloth_pc2_writer_append (self->cache, frame->positions, error) &&
      cloth_npy_writer_append (self->states, frame->states, 1, error);
}

static gboolean
finish_obj_pc2 (gpointer export, GError ** error)
{
  ObjPc2 *self = export;
  g_autoptr (ClothOutput) cache = cloth_pc2_writer_finish (self->cache, error);
  g_autoptr (ClothOutput) states = cache ?
      cloth_npy_writer_finish (self->states, error) : NULL;
  ClothOutput *outputs[] = { states, cache, self->obj };

  return states && cloth_output_commit (outputs, G_N_ELEMENTS (outputs), error);
}

const ClothExporter cloth_obj_pc2_exporter = {
  FALSE, start_obj_pc2, append_obj_pc2, finish_obj_pc2, free_obj_pc2
};

/* ---- PLY ---- */

typedef struct
{
  const ClothExportInfo *info;
  ClothFileSet *files;
  GByteArray *scratch;
} Ply;

static gpointer
start_ply (const ClothExportInfo * info, GError ** error)
{
  ClothFileSet *files = cloth_file_set_new (info->stem, ".ply", error);
  Ply *self;

  if (!files)
    return NULL;
  self = g_new (Ply, 1);
  self->info = info;
  self->files = files;
  self->scratch = g_byte_array_new ();
  return self;
}

static gboolean
append_ply (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  Ply *self = export;
  const ClothExportInfo *info = self->info;
  g_autoptr (ClothOutput) output = cloth_file_set_begin (self->files, error);

  return output && cloth_ply_write (output, info->topology, frame->positions,
      frame->states, frame->covariances, info->fps_n, info->fps_d,
      self->scratch, error) && cloth_file_set_end (self->files, output, error);
}

static gboolean
finish_ply (gpointer export, GError ** error)
{
  Ply *self = export;

  return cloth_file_set_commit (self->files, error);
}

static void
free_ply (gpointer export)
{
  Ply *self = export;

  cloth_file_set_free (self->files);
  g_byte_array_unref (self->scratch);
  g_free (self);
}

const ClothExporter cloth_ply_exporter = {
  FALSE, start_ply, append_ply, finish_ply, free_ply
};

/* ---- take ---- */

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

static gpointer
start_take (const ClothExportInfo * export, GError ** error)
{
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (export->name);
  const ClothTopology *topology = export->topology;

  info->fps = export->fps_n > 0 ? (gdouble) export->fps_n / export->fps_d : 0;
  if (is_grid (topology)) {
    const gfloat *last = topology->uv + 2 * (gsize) (topology->n_vertices - 1);

    info->columns = topology->columns;
    info->rows = topology->rows;
    info->width_m = shortest (last[0]);
    info->height_m = shortest (last[1]);
  } else {
    info->mesh = g_strdup ("mesh.obj");
  }
  return cloth_take_writer_new (export->stem, info, topology, error);
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

const ClothExporter cloth_take_exporter = {
  TRUE, start_take, append_take, finish_take, free_take
};
