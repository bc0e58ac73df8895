/* NumPy's .npy files: little-endian numbers in C order, row by row.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/file.h"
#include "gst/file/parts.h"

G_BEGIN_DECLS

#define CLOTH_NPY_MAX_RANK 4

/* @CLOTH_NPY_FLOAT32: `<f4`
 * @CLOTH_NPY_FLOAT64: `<f8`
 * @CLOTH_NPY_INT8: `|i1`
 * @CLOTH_NPY_INT16: `<i2`
 * @CLOTH_NPY_INT32: `<i4`
 * @CLOTH_NPY_INT64: `<i8`
 * @CLOTH_NPY_UINT8: `|u1`
 * @CLOTH_NPY_UINT16: `<u2`
 * @CLOTH_NPY_UINT32: `<u4`
 * @CLOTH_NPY_UINT64: `<u8`
 *
 * The types of item that are read and written.
 */
typedef enum {
  CLOTH_NPY_FLOAT32,
  CLOTH_NPY_FLOAT64,
  CLOTH_NPY_INT8,
  CLOTH_NPY_INT16,
  CLOTH_NPY_INT32,
  CLOTH_NPY_INT64,
  CLOTH_NPY_UINT8,
  CLOTH_NPY_UINT16,
  CLOTH_NPY_UINT32,
  CLOTH_NPY_UINT64
} ClothNpyType;

/* @type: type of an item
 * @rank: number of dimensions, 0 for a lone number
 * @shape: @rank lengths
 * @item_size: bytes of an item
 * @row_items: items of one row: the product of every length but the first
 * @n_rows: the first length, 1 for a lone number
 * @data_offset: where the first item stands
 *
 * What the header of an .npy file says.
 */
typedef struct {
  ClothNpyType type;
  guint rank;
  guint64 shape[CLOTH_NPY_MAX_RANK];
  gsize item_size;
  guint64 row_items;
  guint64 n_rows;
  guint64 data_offset;
} ClothNpyInfo;

typedef struct _ClothNpyReader ClothNpyReader;
typedef struct _ClothNpyWriter ClothNpyWriter;

ClothNpyReader *cloth_npy_reader_open (const gchar * path, GError ** error);
ClothNpyReader *cloth_npy_reader_new (ClothInput * input, GError ** error);
const ClothNpyInfo *cloth_npy_reader_get_info (const ClothNpyReader * reader);
gboolean cloth_npy_reader_read_float (ClothNpyReader * reader,
    guint64 first_row, guint64 n_rows, gfloat * items, GError ** error);
gboolean cloth_npy_reader_read_double (ClothNpyReader * reader,
    guint64 first_row, guint64 n_rows, gdouble * items, GError ** error);
gboolean cloth_npy_reader_read_raw (ClothNpyReader * reader,
    guint64 first_row, guint64 n_rows, gpointer items, GError ** error);
void cloth_npy_reader_free (ClothNpyReader * reader);

ClothNpyWriter *cloth_npy_writer_new (ClothOutput * output, ClothNpyType type,
    guint rank, const guint64 * row_shape, GError ** error);
gboolean cloth_npy_part_count (const ClothParts * parts, const gchar * name,
    guint64 * n_rows, GError ** error);
ClothNpyReader *cloth_npy_part_open (const ClothParts * parts,
    const gchar * name, GError ** error);
gboolean cloth_npy_part_finish (ClothParts * parts, const gchar * name,
    guint64 n_rows, GError ** error);
gboolean cloth_npy_writer_append (ClothNpyWriter * writer,
    gconstpointer items, guint64 n_rows, GError ** error);
gboolean cloth_npy_writer_finish (ClothNpyWriter * writer, GError ** error);
void cloth_npy_writer_free (ClothNpyWriter * writer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothNpyReader, cloth_npy_reader_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothNpyWriter, cloth_npy_writer_free)
G_END_DECLS
