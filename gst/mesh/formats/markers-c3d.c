/* C3D: recordings of labelled points of motion-capture systems.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/mesh/formats/markers.h"

/* The C3D file format (https://www.c3d.org), Intel byte order: blocks of 512 bytes, counted
 * from 1: the header, the parameters, the data. */
#define BLOCK 512u
#define INTEL 84

/* @labels: (element-type utf8): POINT:LABELS, LABELS2 and so on
 * @point: number of the group POINT, 0 until it is met
 */
typedef struct
{
  const guint8 *bytes;
  gsize size;
  gint point;
  guint n_used, n_frames, data_start;
  gdouble scale, rate, unit_m;
  GPtrArray *labels;
} File;

static guint
word_at (const guint8 * bytes)
{
  return bytes[0] | (guint) bytes[1] << 8;
}

static gfloat
float_at (const guint8 * bytes)
{
  gfloat value;

  memcpy (&value, bytes, sizeof value);
  cloth_swap_little_endian (&value, sizeof value, 1);
  return value;
}

static gboolean
cut_short (GError ** error)
{
  g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED,
      "the C3D file is cut short");
  return FALSE;
}

/* Labels of one length, filled up by spaces. */
static gboolean
read_labels (File * file, const guint8 * text, guint length, guint n,
    GError ** error)
{
  for (guint i = 0; i < n; i++) {
    g_autofree gchar *label =
        g_strstrip (g_strndup ((const gchar *) text + i * length, length));

    if (!g_utf8_validate (label, -1, NULL))
      return cloth_file_invalid (error, "label %u of the C3D file is no text",
          file->labels->len);
    g_ptr_array_add (file->labels, g_steal_pointer (&label));
  }
  return TRUE;
}

static gboolean
set_unit (File * file, const guint8 * text, guint n)
{
  static const struct
  {
    const gchar *name;
    gdouble unit_m;
  } units[] = { {"mm", 0.001}, {"cm", 0.01}, {"m", 1}, {"in", 0.0254} };
  g_autofree gchar *name = g_strstrip (g_strndup ((const gchar *) text, n));

  for (guint i = 0; i < G_N_ELEMENTS (units); i++)
    if (g_ascii_strcasecmp (name, units[i].name) == 0)
      file->unit_m = units[i].unit_m;
  return TRUE;
}

/* @data: type, number of dimensions, these, the items; @size bytes at most */
static gboolean
read_point (File * file, const gchar * name, const guint8 * data, gsize size,
    GError ** error)
{
  guint n_items = 1, item_size, n_dimensions;
  const guint8 *items;

  if (size < 2)
    return cut_short (error);
  item_size = (guint) ABS ((gint8) data[0]);
  n_dimensions = data[1];
  if (n_dimensions > 7 || size < 2 + n_dimensions)
    return cut_short (error);
  for (guint i = 0; i < n_dimensions; i++) {
    n_items *= data[2 + i];
    if (n_items > G_MAXUINT16 * 4)
      return cut_short (error);
  }
  items = data + 2 + n_dimensions;
  if (item_size * (gsize) n_items > size - 2 - n_dimensions)
    return cut_short (error);
  if (n_items == 0)
    return TRUE;
  if (g_str_has_prefix (name, "LABELS") && (gint8) data[0] == -1 &&
      n_dimensions == 2)
    return read_labels (file, items, data[2], data[3], error);
  if (g_str_equal (name, "UNITS") && (gint8) data[0] == -1)
    return set_unit (file, items, n_items);
  if (item_size == 2 && g_str_equal (name, "USED"))
    file->n_used = word_at (items);
  else if (item_size == 2 && g_str_equal (name, "FRAMES"))
    file->n_frames = word_at (items);
  else if (item_size == 2 && g_str_equal (name, "DATA_START"))
    file->data_start = word_at (items);
  else if (item_size == 4 && g_str_equal (name, "SCALE"))
    file->scale = float_at (items);
  else if (item_size == 4 && g_str_equal (name, "RATE"))
    file->rate = float_at (items);
  return TRUE;
}

/* Groups and parameters follow each other in any order; a parameter names its group by number.
 * @groups: only groups are looked at, else only the parameters of POINT */
static gboolean
read_parameters (File * file, gboolean groups, GError ** error)
{
  const gsize begin = (gsize) (file->bytes[0] - 1) * BLOCK;
  gsize at = begin + 4, end;

  if (file->bytes[0] < 2 || begin + 4 > file->size)
    return cut_short (error);
  if (file->bytes[begin + 3] != INTEL) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
        "the C3D file is of a DEC or MIPS processor; save it again as Intel");
    return FALSE;
  }
  end = MIN (file->size, begin + MAX (file->bytes[begin + 2], 1) * BLOCK);
  while (at + 2 <= end && file->bytes[at] != 0) {
    const gsize length = (gsize) ABS ((gint8) file->bytes[at]);
    const gint id = (gint8) file->bytes[at + 1];
    const gsize offset_at = at + 2 + length;
    g_autofree gchar *name = NULL;
    guint offset;

    if (offset_at + 2 > end)
      return cut_short (error);
    name = g_ascii_strup ((const gchar *) file->bytes + at + 2,
        (gssize) length);
    offset = word_at (file->bytes + offset_at);
    if (groups && id < 0 && g_str_equal (name, "POINT"))
      file->point = -id;
    if (!groups && id > 0 && id == file->point &&
        !read_point (file, name, file->bytes + offset_at + 2,
            end - offset_at - 2, error))
      return FALSE;
    if (offset == 0)
      return TRUE;
    at = offset_at + offset;
  }
  return TRUE;
}

static void
name_markers (const File * file, ClothMarkers * markers)
{
  g_autoptr (GHashTable) seen = g_hash_table_new (g_str_hash, g_str_equal);

  if (file->labels->len < markers->n_markers)
    return;
  /* Labels that are empty or twice tell nobody apart. */
  for (guint i = 0; i < markers->n_markers; i++) {
    const gchar *label = file->labels->pdata[i];

    if (!*label || !g_hash_table_add (seen, (gpointer) label))
      return;
  }
  g_ptr_array_set_size (file->labels, (gint) markers->n_markers);
  markers->names = g_ptr_array_ref (file->labels);
}

/* A point is three coordinates and a word: negative, or −1, where it is not seen. */
static void
read_point_at (const File * file, const guint8 * from, gfloat * to)
{
  gdouble point[4];

  for (guint k = 0; k < 4; k++)
    point[k] = file->scale < 0 ? (gdouble) float_at (from + 4 * k) :
        (gdouble) (gint16) word_at (from + 2 * k) * (k < 3 ? file->scale : 1);
  for (guint k = 0; k < 3; k++)
    if (!isfinite (point[k]) || fabs (point[k]) > 1e9)
      return;
  for (guint k = 0; k < 3 && point[3] >= 0; k++)
    to[k] = (gfloat) point[k];
}

static ClothMarkers *
read_data (File * file, GError ** error)
{
  const gsize item = file->scale < 0 ? 4 : 2;
  const gsize begin = (gsize) (file->data_start - 1) * BLOCK;
  /* Analog samples stand behind the points of each frame. */
  const gsize stride = item * (4 * (gsize) file->n_used +
      word_at (file->bytes + 4));
  guint64 n_frames = file->n_frames;
  ClothMarkers *markers;

  if (file->data_start < 2 || begin >= file->size || stride == 0) {
    cut_short (error);
    return NULL;
  }
  /* The count is a word; what is longer says so elsewhere. The file's own length knows. */
  if (n_frames == 0 || n_frames == G_MAXUINT16)
    n_frames = (file->size - begin) / stride;
  if (n_frames > (file->size - begin) / stride) {
    cut_short (error);
    return NULL;
  }
  markers = cloth_markers_new (n_frames, file->n_used, error);
  if (!markers)
    return NULL;
  for (gsize i = 0; i < n_frames; i++)
    for (gsize k = 0; k < file->n_used; k++)
      read_point_at (file, file->bytes + begin + i * stride + 4 * item * k,
          markers->positions + 3 * (i * file->n_used + k));
  name_markers (file, markers);
  markers->fps = file->rate;
  markers->unit_m = file->unit_m;
  markers->layout = "C3D";
  return markers;
}

/* @bytes: a C3D file
 * @size: its bytes
 * @error: #ClothFileError
 *
 * Returns: (transfer full): the recording, or %NULL
 */
ClothMarkers *
cloth_markers_parse_c3d (const guint8 * bytes, gsize size, GError ** error)
{
  g_autoptr (GPtrArray) labels = g_ptr_array_new_with_free_func (g_free);
  File file = { bytes, size,.labels = labels };

  if (size < BLOCK || bytes[1] != 0x50) {
    cloth_file_invalid (error, "this is no C3D file");
    return NULL;
  }
  /* What the parameters don't say stands in the header. */
  file.n_used = word_at (bytes + 2);
  file.scale = float_at (bytes + 12);
  file.data_start = word_at (bytes + 16);
  file.rate = float_at (bytes + 20);
  if (word_at (bytes + 8) >= word_at (bytes + 6))
    file.n_frames = word_at (bytes + 8) - word_at (bytes + 6) + 1;
  if (!read_parameters (&file, TRUE, error) ||
      !read_parameters (&file, FALSE, error))
    return NULL;
  if (!isfinite (file.scale) || file.scale == 0 || !isfinite (file.rate) ||
      file.rate < 0 || file.rate > 1e6) {
    cloth_file_invalid (error,
        "the C3D file has a scale or a frame rate that makes no sense");
    return NULL;
  }
  return read_data (&file, error);
}
