/* NumPy's .npy files: little-endian numbers in C order, row by row.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/npy.h"

#include <string.h>

/* The format: NumPy, "A simple file format for NumPy arrays" (NEP 1): the magic
 * bytes, two bytes of version, the length of the header (16 bits in version 1, 32
 * bits in 2 and 3), then a Python dictionary as text. */
#define MAGIC "\x93NUMPY"
#define MAGIC_SIZE 6
#define MAX_HEADER (64u << 10)
#define ALIGNMENT 64
#define SCRATCH (1u << 16)
/* The longest 64-bit count. */
#define COUNT_DIGITS 20

static const struct
{
  const gchar *descr;
  gsize size;
} types[] = {
  [CLOTH_NPY_FLOAT32] = {"<f4", 4},
  [CLOTH_NPY_FLOAT64] = {"<f8", 8},
  [CLOTH_NPY_INT8] = {"|i1", 1},
  [CLOTH_NPY_INT16] = {"<i2", 2},
  [CLOTH_NPY_INT32] = {"<i4", 4},
  [CLOTH_NPY_INT64] = {"<i8", 8},
  [CLOTH_NPY_UINT8] = {"|u1", 1},
  [CLOTH_NPY_UINT16] = {"<u2", 2},
  [CLOTH_NPY_UINT32] = {"<u4", 4},
  [CLOTH_NPY_UINT64] = {"<u8", 8},
};

struct _ClothNpyReader
{
  ClothInput *input;
  ClothNpyInfo info;
  guint8 *scratch;
};

struct _ClothNpyWriter
{
  ClothOutput *output;
  ClothNpyType type;
  guint rank;
  guint64 shape[CLOTH_NPY_MAX_RANK];
  gsize row_bytes;
  gsize header_size;
};

/* The text of the header, eaten from the left. */
typedef struct
{
  const gchar *at, *end;
} Text;

static gboolean
invalid (GError ** error, const gchar * what)
{
  g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
      "not a valid .npy file: %s", what);
  return FALSE;
}

static void
skip_blanks (Text * text)
{
  while (text->at < text->end && g_ascii_isspace (*text->at))
    text->at++;
}

static gboolean
take_char (Text * text, gchar c)
{
  skip_blanks (text);
  if (text->at >= text->end || *text->at != c)
    return FALSE;
  text->at++;
  return TRUE;
}

static gboolean
take_string (Text * text, gchar * value, gsize size)
{
  gsize n = 0;
  gchar quote;

  skip_blanks (text);
  if (text->at >= text->end || (*text->at != '\'' && *text->at != '"'))
    return FALSE;
  quote = *text->at++;
  while (text->at < text->end && *text->at != quote) {
    if (n + 1 >= size || *text->at == '\\' || *text->at == 0)
      return FALSE;
    value[n++] = *text->at++;
  }
  value[n] = 0;
  return take_char (text, quote);
}

static gboolean
take_word (Text * text, const gchar * word)
{
  gsize n = strlen (word);

  skip_blanks (text);
  if ((gsize) (text->end - text->at) < n || memcmp (text->at, word, n) != 0)
    return FALSE;
  text->at += n;
  return TRUE;
}

static gboolean
take_count (Text * text, guint64 * value)
{
  guint64 n = 0;
  gboolean any = FALSE;

  skip_blanks (text);
  while (text->at < text->end && g_ascii_isdigit (*text->at)) {
    guint64 digit = (guint64) (*text->at++ - '0');

    if (!g_uint64_checked_mul (&n, n, 10) ||
        !g_uint64_checked_add (&n, n, digit))
      return FALSE;
    any = TRUE;
  }
  /* Python 2 wrote long integers with an L. */
  if (any && text->at < text->end && *text->at == 'L')
    text->at++;
  *value = n;
  return any;
}

static gboolean
take_shape (Text * text, ClothNpyInfo * info, GError ** error)
{
  if (!take_char (text, '('))
    return invalid (error, "the shape is no tuple");
  info->rank = 0;
  while (!take_char (text, ')')) {
    if (info->rank == CLOTH_NPY_MAX_RANK) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
          "the array has more than %d dimensions", CLOTH_NPY_MAX_RANK);
      return FALSE;
    }
    if (!take_count (text, &info->shape[info->rank++]))
      return invalid (error, "a length of the shape is no whole number");
    if (take_char (text, ','))
      continue;
    if (info->rank < 2 || !take_char (text, ')'))
      return invalid (error, "the shape is no tuple");
    break;
  }
  return TRUE;
}

static gboolean
find_type (const gchar * descr, ClothNpyInfo * info, GError ** error)
{
  for (guint i = 0; i < G_N_ELEMENTS (types); i++) {
    /* One byte has no order: NumPy writes '|', others '<'. */
    if (g_str_equal (descr, types[i].descr) ||
        (types[i].size == 1 && descr[0] == '<' &&
            g_str_equal (descr + 1, types[i].descr + 1))) {
      info->type = (ClothNpyType) i;
      info->item_size = types[i].size;
      return TRUE;
    }
  }
  g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
      "items of type “%s” are not read: save the array as float32 or float64, "
      "little-endian", descr);
  return FALSE;
}

static gboolean
parse_dictionary (Text text, ClothNpyInfo * info, GError ** error)
{
  gboolean have_descr = FALSE, have_order = FALSE, have_shape = FALSE;
  gchar key[32], descr[32];

  if (!take_char (&text, '{'))
    return invalid (error, "the header is no dictionary");
  while (!take_char (&text, '}')) {
    if (!take_string (&text, key, sizeof key) || !take_char (&text, ':'))
      return invalid (error, "a key of the header cannot be read");
    if (g_str_equal (key, "descr") && !have_descr) {
      if (!take_string (&text, descr, sizeof descr)) {
        g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
            "structured items are not read: save a plain array of numbers");
        return FALSE;
      }
      if (!g_utf8_validate (descr, -1, NULL))
        return invalid (error, "the type is no text");
      if (!find_type (descr, info, error))
        return FALSE;
      have_descr = TRUE;
    } else if (g_str_equal (key, "fortran_order") && !have_order) {
      if (take_word (&text, "True")) {
        g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
            "the array is in Fortran order: save numpy.ascontiguousarray of it");
        return FALSE;
      }
      if (!take_word (&text, "False"))
        return invalid (error, "fortran_order is neither True nor False");
      have_order = TRUE;
    } else if (g_str_equal (key, "shape") && !have_shape) {
      if (!take_shape (&text, info, error))
        return FALSE;
      have_shape = TRUE;
    } else {
      return invalid (error, "the header has an unknown or a repeated key");
    }
    if (!take_char (&text, ',')) {
      if (!take_char (&text, '}'))
        return invalid (error, "the dictionary of the header does not end");
      break;
    }
  }
  skip_blanks (&text);
  if (text.at != text.end)
    return invalid (error, "something stands behind the dictionary");
  if (!have_descr || !have_order || !have_shape)
    return invalid (error, "the header lacks descr, fortran_order or shape");
  return TRUE;
}

/* Counts against the bytes that remain, before anybody allocates. */
static gboolean
check_sizes (ClothNpyInfo * info, guint64 remaining, GError ** error)
{
  guint64 items, bytes;

  info->n_rows = info->rank > 0 ? info->shape[0] : 1;
  info->row_items = 1;
  for (guint i = 1; i < info->rank; i++)
    if (!g_uint64_checked_mul (&info->row_items, info->row_items,
            info->shape[i]))
      return invalid (error, "the shape overflows");
  if (!g_uint64_checked_mul (&items, info->row_items, info->n_rows) ||
      !g_uint64_checked_mul (&bytes, items, info->item_size))
    return invalid (error, "the shape overflows");
  if (bytes > remaining) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED,
        "the shape asks for %" G_GUINT64_FORMAT " bytes, %" G_GUINT64_FORMAT
        " are there: the file is cut short", bytes, remaining);
    return FALSE;
  }
  /* A row of a valid count fits the file, but an empty array may claim any. */
  if (info->row_items > CLOTH_MAX_BUFFER / sizeof (gdouble)) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "a row of %" G_GUINT64_FORMAT " items is more than is accepted",
        info->row_items);
    return FALSE;
  }
  return TRUE;
}

static gboolean
read_header (ClothInput * input, ClothNpyInfo * info, GError ** error)
{
  guint8 preface[12] = { 0 };
  gsize length, start;
  g_autofree gchar *header = NULL;
  Text text;

  if (!cloth_input_read_at (input, 0, preface, 10, error))
    return FALSE;
  if (memcmp (preface, MAGIC, MAGIC_SIZE) != 0)
    return invalid (error, "it does not begin with the magic bytes");
  switch (preface[6]) {
    case 1:
      start = 10;
      length = preface[8] | (gsize) preface[9] << 8;
      break;
    case 2:
    case 3:
      start = 12;
      if (!cloth_input_read_at (input, 0, preface, start, error))
        return FALSE;
      length = preface[8] | (gsize) preface[9] << 8 |
          (gsize) preface[10] << 16 | (gsize) preface[11] << 24;
      break;
    default:
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
          ".npy version %u is not read, only 1 to 3", preface[6]);
      return FALSE;
  }
  if (length > MAX_HEADER) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "a header of %" G_GSIZE_FORMAT " bytes is more than the %u accepted",
        length, MAX_HEADER);
    return FALSE;
  }
  header = g_malloc (length + 1);
  if (!cloth_input_read_at (input, start, header, length, error))
    return FALSE;
  text.at = header;
  text.end = header + length;
  if (!parse_dictionary (text, info, error))
    return FALSE;
  info->data_offset = start + length;
  return check_sizes (info, cloth_input_get_size (input) - info->data_offset,
      error);
}

/* @input: (transfer full): the bytes of an .npy file
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads and checks the header. Nothing of the data is held in memory.
 *
 * Returns: (transfer full): a reader, or %NULL
 */
ClothNpyReader *
cloth_npy_reader_new (ClothInput * input, GError ** error)
{
  g_autoptr (ClothNpyReader) reader = g_new0 (ClothNpyReader, 1);

  reader->input = input;
  if (!read_header (input, &reader->info, error))
    return NULL;
  return g_steal_pointer (&reader);
}

/* @path: an .npy file
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full): a reader, or %NULL
 */
ClothNpyReader *
cloth_npy_reader_open (const gchar * path, GError ** error)
{
  ClothInput *input = cloth_input_open (path, error);
  ClothNpyReader *reader;

  if (!input)
    return NULL;
  reader = cloth_npy_reader_new (input, error);
  if (!reader)
    g_prefix_error (error, "%s: ", path);
  return reader;
}

/* @reader: a reader
 *
 * Returns: (transfer none): what the header says
 */
const ClothNpyInfo *
cloth_npy_reader_get_info (const ClothNpyReader * reader)
{
  return &reader->info;
}

static gboolean
find_rows (const ClothNpyInfo * info, guint64 first, guint64 n_rows,
    guint64 * offset, guint64 * n_items, GError ** error)
{
  if (first > info->n_rows || n_rows > info->n_rows - first)
    return cloth_file_invalid (error,
        "rows %" G_GUINT64_FORMAT " to %" G_GUINT64_FORMAT
        " of %" G_GUINT64_FORMAT, first, first + n_rows, info->n_rows);
  *offset = info->data_offset + first * info->row_items * info->item_size;
  *n_items = n_rows * info->row_items;
  return TRUE;
}

#define CONVERT(from, to) do { \
    for (gsize i_ = 0; i_ < n; i_++) { \
      from value_; \
      memcpy (&value_, raw + i_ * sizeof value_, sizeof value_); \
      items[i_] = (to) value_; \
    } \
  } while (0)

#define CONVERT_ANY(to) do { \
    switch (type) { \
      case CLOTH_NPY_FLOAT32: CONVERT (gfloat, to); break; \
      case CLOTH_NPY_FLOAT64: CONVERT (gdouble, to); break; \
      case CLOTH_NPY_INT8: CONVERT (gint8, to); break; \
      case CLOTH_NPY_INT16: CONVERT (gint16, to); break; \
      case CLOTH_NPY_INT32: CONVERT (gint32, to); break; \
      case CLOTH_NPY_INT64: CONVERT (gint64, to); break; \
      case CLOTH_NPY_UINT8: CONVERT (guint8, to); break; \
      case CLOTH_NPY_UINT16: CONVERT (guint16, to); break; \
      case CLOTH_NPY_UINT32: CONVERT (guint32, to); break; \
      case CLOTH_NPY_UINT64: CONVERT (guint64, to); break; \
    } \
  } while (0)

static void
convert_float (ClothNpyType type, const guint8 * raw, gsize n, gfloat * items)
{
  CONVERT_ANY (gfloat);
}

static void
convert_double (ClothNpyType type, const guint8 * raw, gsize n, gdouble * items)
{
  CONVERT_ANY (gdouble);
}

/* Exactly one of @floats and @doubles is given. */
static gboolean
read_rows (ClothNpyReader * reader, guint64 first_row, guint64 n_rows,
    gfloat * floats, gdouble * doubles, GError ** error)
{
  const ClothNpyInfo *info = &reader->info;
  gsize size = info->item_size;
  guint64 offset = 0, n_items = 0, done = 0;

  if (!find_rows (info, first_row, n_rows, &offset, &n_items, error))
    return FALSE;
  if (floats ? info->type == CLOTH_NPY_FLOAT32 :
      info->type == CLOTH_NPY_FLOAT64) {
    gpointer items = floats ? (gpointer) floats : (gpointer) doubles;

    if (!cloth_input_read_at (reader->input, offset, items,
            (gsize) n_items * size, error))
      return FALSE;
    cloth_swap_little_endian (items, size, (gsize) n_items);
    return TRUE;
  }
  if (!reader->scratch)
    reader->scratch = g_malloc (SCRATCH);
  while (done < n_items) {
    gsize n = (gsize) MIN (n_items - done, SCRATCH / size);

    if (!cloth_input_read_at (reader->input, offset + done * size,
            reader->scratch, n * size, error))
      return FALSE;
    cloth_swap_little_endian (reader->scratch, size, n);
    if (floats)
      convert_float (info->type, reader->scratch, n, floats + done);
    else
      convert_double (info->type, reader->scratch, n, doubles + done);
    done += n;
  }
  return TRUE;
}

/* @reader: a reader
 * @first_row: the first row wanted
 * @n_rows: how many rows
 * @items: (out caller-allocates): room for `n_rows * row_items` numbers
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads rows, whatever the type in the file, as float32.
 *
 * Returns: %TRUE when all were read
 */
gboolean
cloth_npy_reader_read_float (ClothNpyReader * reader, guint64 first_row,
    guint64 n_rows, gfloat * items, GError ** error)
{
  return read_rows (reader, first_row, n_rows, items, NULL, error);
}

/* @reader: a reader
 * @first_row: the first row wanted
 * @n_rows: how many rows
 * @items: (out caller-allocates): room for `n_rows * row_items` numbers
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads rows, whatever the type in the file, as float64.
 *
 * Returns: %TRUE when all were read
 */
gboolean
cloth_npy_reader_read_double (ClothNpyReader * reader, guint64 first_row,
    guint64 n_rows, gdouble * items, GError ** error)
{
  return read_rows (reader, first_row, n_rows, NULL, items, error);
}

/* @reader: a reader
 * @first_row: the first row wanted
 * @n_rows: how many rows
 * @items: (out caller-allocates): room for `n_rows * row_items` items of the file's
 *   own type
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads rows as they are, in the processor's byte order.
 *
 * Returns: %TRUE when all were read
 */
gboolean
cloth_npy_reader_read_raw (ClothNpyReader * reader, guint64 first_row,
    guint64 n_rows, gpointer items, GError ** error)
{
  gsize size = reader->info.item_size;
  guint64 offset = 0, n_items = 0;

  if (!find_rows (&reader->info, first_row, n_rows, &offset, &n_items, error) ||
      !cloth_input_read_at (reader->input, offset, items,
          (gsize) n_items * size, error))
    return FALSE;
  cloth_swap_little_endian (items, size, (gsize) n_items);
  return TRUE;
}

/* @reader: (transfer full) (nullable): a reader
 */
void
cloth_npy_reader_free (ClothNpyReader * reader)
{
  if (!reader)
    return;
  cloth_input_free (reader->input);
  g_free (reader->scratch);
  g_free (reader);
}

/* The whole header for @n_rows rows, padded with blanks to @size bytes (0: to the
 * next multiple of 64 that would hold any number of rows). */
static GString *
make_header (const ClothNpyWriter * writer, guint64 n_rows, gsize size)
{
  GString *text = g_string_new (NULL);
  gsize length;

  g_string_append_len (text, MAGIC "\x01\x00\x00\x00", MAGIC_SIZE + 4);
  g_string_append_printf (text, "{'descr': '%s', 'fortran_order': False, "
      "'shape': (", types[writer->type].descr);
  if (writer->rank > 0)
    g_string_append_printf (text, "%" G_GUINT64_FORMAT ",", n_rows);
  for (guint i = 1; i < writer->rank; i++)
    g_string_append_printf (text, " %" G_GUINT64_FORMAT "%s", writer->shape[i],
        i + 1 < writer->rank ? "," : "");
  g_string_append (text, "), }");
  if (size == 0)
    size = (text->len + COUNT_DIGITS + 1 + ALIGNMENT - 1) /
        ALIGNMENT * ALIGNMENT;
  while (text->len + 1 < size)
    g_string_append_c (text, ' ');
  g_string_append_c (text, '\n');
  length = text->len - (MAGIC_SIZE + 4);
  text->str[8] = (gchar) (length & 0xff);
  text->str[9] = (gchar) (length >> 8);
  return text;
}

/* @output: (transfer full): an empty file
 * @type: type of an item
 * @rank: number of dimensions, 0 to 4
 * @row_shape: (array) (nullable): the lengths of every dimension but the first
 * @error: #GIOErrorEnum
 *
 * Starts an array whose first length is known at the end only: rows are appended as
 * they come and nothing is held. An array of rank 0 takes one row of one item.
 *
 * Returns: (transfer full): a writer, or %NULL
 */
ClothNpyWriter *
cloth_npy_writer_new (ClothOutput * output, ClothNpyType type, guint rank,
    const guint64 * row_shape, GError ** error)
{
  g_autoptr (ClothNpyWriter) writer = g_new0 (ClothNpyWriter, 1);
  g_autoptr (GString) header = NULL;
  guint64 bytes = types[type].size;

  g_return_val_if_fail (rank <= CLOTH_NPY_MAX_RANK, NULL);

  writer->output = output;
  writer->type = type;
  writer->rank = rank;
  for (guint i = 1; i < rank; i++) {
    writer->shape[i] = row_shape[i - 1];
    if (!g_uint64_checked_mul (&bytes, bytes, row_shape[i - 1]) ||
        bytes > CLOTH_MAX_BUFFER) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
          "a row is larger than the %u bytes accepted", CLOTH_MAX_BUFFER);
      return NULL;
    }
  }
  writer->row_bytes = (gsize) bytes;
  header = make_header (writer, 0, 0);
  writer->header_size = header->len;
  if (!cloth_output_write (writer->output, header->str, header->len, error))
    return NULL;
  return g_steal_pointer (&writer);
}

/* @writer: a writer
 * @items: `n_rows` rows of the writer's type, in the processor's byte order
 * @n_rows: how many rows
 * @error: #GIOErrorEnum
 *
 * The rows outlive the program from then on.
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_npy_writer_append (ClothNpyWriter * writer, gconstpointer items,
    guint64 n_rows, GError ** error)
{
  gsize bytes = writer->row_bytes * (gsize) n_rows;
#if G_BYTE_ORDER == G_LITTLE_ENDIAN
  gconstpointer ordered = items;
#else
  gsize size = types[writer->type].size;
  g_autofree gpointer ordered = g_memdup2 (items, bytes);

  cloth_swap_little_endian (ordered, size, bytes / size);
#endif
  if (!cloth_output_write (writer->output, ordered, bytes, error) ||
      !cloth_output_flush (writer->output, error))
    return FALSE;
  writer->shape[0] += n_rows;
  return TRUE;
}

/* @writer: a writer
 * @error: #GIOErrorEnum
 *
 * Writes the final shape and commits the file. The writer can then only be freed.
 *
 * Returns: %TRUE when the file is whole
 */
gboolean
cloth_npy_writer_finish (ClothNpyWriter * writer, GError ** error)
{
  g_autoptr (GString) header =
      make_header (writer, writer->shape[0], writer->header_size);

  /* One that another program made may be too narrow. */
  if (header->len != writer->header_size)
    return invalid (error, "the header has no room for the number of rows");
  return cloth_output_write_at (writer->output, 0, header->str, header->len,
      error) && cloth_output_commit (writer->output, error);
}

/* @parts: what a killed program left
 * @name: of an array, whole or not
 * @n_rows: (out): how many whole rows are there
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when its header can be read, or had not been written yet
 */
gboolean
cloth_npy_part_count (const ClothParts * parts, const gchar * name,
    guint64 * n_rows, GError ** error)
{
  g_autofree gchar *path = cloth_parts_get_path (parts, name);
  GError *fault = NULL;
  g_autoptr (ClothNpyReader) reader = cloth_npy_reader_open (path, &fault);
  const ClothNpyInfo *info = reader ? &reader->info : NULL;

  *n_rows = 0;
  if (!reader)
    return cloth_file_is_unwritten (fault, error);
  if (info->rank == 0 || info->row_items == 0)
    return invalid (error, "it has no rows that can be counted");
  *n_rows = (cloth_input_get_size (reader->input) - info->data_offset) /
      (info->row_items * info->item_size);
  return TRUE;
}

/* @parts: what a killed program left
 * @name: of an array that cloth_npy_part_count() could read
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full): a reader of its whole rows, whatever its header says of their
 *   number; or %NULL
 */
ClothNpyReader *
cloth_npy_part_open (const ClothParts * parts, const gchar * name,
    GError ** error)
{
  g_autofree gchar *path = cloth_parts_get_path (parts, name);
  ClothNpyReader *reader = cloth_npy_reader_open (path, error);
  guint64 n_rows;

  if (!reader)
    return NULL;
  n_rows = (cloth_input_get_size (reader->input) - reader->info.data_offset) /
      (reader->info.row_items * reader->info.item_size);
  reader->info.n_rows = reader->info.shape[0] = n_rows;
  return reader;
}

/* @parts: what a killed program left
 * @name: of an array that has at least @n_rows
 * @n_rows: how many are kept
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when the array is whole
 */
gboolean
cloth_npy_part_finish (ClothParts * parts, const gchar * name, guint64 n_rows,
    GError ** error)
{
  g_autofree gchar *path = cloth_parts_get_path (parts, name);
  g_autoptr (ClothNpyReader) reader = cloth_npy_reader_open (path, error);
  g_autoptr (ClothNpyWriter) writer = NULL;
  const ClothNpyInfo *info = reader ? &reader->info : NULL;

  if (!reader)
    return FALSE;
  writer = g_new0 (ClothNpyWriter, 1);
  writer->type = info->type;
  writer->rank = info->rank;
  memcpy (writer->shape, info->shape, sizeof writer->shape);
  writer->shape[0] = n_rows;
  writer->header_size = (gsize) info->data_offset;
  writer->output = cloth_parts_continue (parts, name, info->data_offset +
      n_rows * info->row_items * info->item_size, error);
  return writer->output && cloth_npy_writer_finish (writer, error);
}

/* @writer: (transfer full) (nullable): a writer
 *
 * Frees it; a file that was not finished is removed.
 */
void
cloth_npy_writer_free (ClothNpyWriter * writer)
{
  if (!writer)
    return;
  cloth_output_free (writer->output);
  g_free (writer);
}
