/* .npy files against NumPy itself, and hostile ones.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/npy.h"
#include "tests/core/meshpeer.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static const struct
{
  ClothNpyType type;
  const gchar *name;
} all_types[] = {
  {CLOTH_NPY_FLOAT32, "float32"}, {CLOTH_NPY_FLOAT64, "float64"},
  {CLOTH_NPY_INT8, "int8"}, {CLOTH_NPY_INT16, "int16"},
  {CLOTH_NPY_INT32, "int32"}, {CLOTH_NPY_INT64, "int64"},
  {CLOTH_NPY_UINT8, "uint8"}, {CLOTH_NPY_UINT16, "uint16"},
  {CLOTH_NPY_UINT32, "uint32"}, {CLOTH_NPY_UINT64, "uint64"},
};

static ClothNpyWriter *
start_writer (const gchar * path, ClothNpyType type, guint rank,
    const guint64 * row_shape, GError ** error)
{
  ClothOutput *output = cloth_output_new (path, error);

  return output ?
      cloth_npy_writer_new (output, type, rank, row_shape, error) : NULL;
}

/* A whole array of @rank dimensions. */
static gboolean
write_array (const gchar * path, ClothNpyType type, guint rank,
    const guint64 * shape, gconstpointer items, GError ** error)
{
  g_autoptr (ClothNpyWriter) writer = start_writer (path, type, rank,
      rank > 1 ? shape + 1 : NULL, error);

  return writer && cloth_npy_writer_append (writer, items,
      rank > 0 ? shape[0] : 1, error)
      && cloth_npy_writer_finish (writer, error);
}

/* NumPy writes every type, rank and version; the values are a ramp. */
static void
test_reads_numpy (void)
{
  guint n_read = 0;

  scratch_begin ();
  peer_run ("import numpy.lib.format as F\n"
      "for t in 'float32 float64 int8 int16 int32 int64 uint8 uint16 uint32 "
      "uint64'.split():\n"
      "  for r in range(5):\n"
      "    for v in (1,2,3):\n"
      "      s=(5,3,2,1)[:r]\n"
      "      a=np.arange(int(np.prod(s)),dtype=t).reshape(s)\n"
      "      with open(f'{t}_{r}_{v}.npy','wb') as f:\n"
      "        F.write_array(f,a,version=(v,0))\n");
  for (guint t = 0; t < G_N_ELEMENTS (all_types); t++) {
    for (guint rank = 0; rank <= 4; rank++) {
      for (guint version = 1; version <= 3; version++) {
        static const guint64 lengths[] = { 5, 3, 2, 1 };
        g_autofree gchar *name = g_strdup_printf ("%s_%u_%u.npy",
            all_types[t].name, rank, version);
        g_autofree gchar *path = scratch_path (name);
        g_autoptr (GError) error = NULL;
        g_autoptr (ClothNpyReader) reader =
            cloth_npy_reader_open (path, &error);
        const ClothNpyInfo *info;
        gdouble doubles[30];
        gfloat floats[30];

        g_assert_no_error (error);
        info = cloth_npy_reader_get_info (reader);
        g_assert_cmpint (info->type, ==, all_types[t].type);
        g_assert_cmpuint (info->rank, ==, rank);
        for (guint i = 0; i < rank; i++)
          g_assert_cmpuint (info->shape[i], ==, lengths[i]);
        g_assert_true (cloth_npy_reader_read_double (reader, 0, info->n_rows,
                doubles, &error));
        g_assert_true (cloth_npy_reader_read_float (reader, 0, info->n_rows,
                floats, &error));
        for (guint i = 0; i < info->n_rows * info->row_items; i++) {
          g_assert_cmpfloat (doubles[i], ==, i);
          g_assert_cmpfloat (floats[i], ==, (gfloat) i);
        }
        if (rank > 0) {
          g_assert_true (cloth_npy_reader_read_double (reader, 4, 1, doubles,
                  &error));
          g_assert_cmpfloat (doubles[0], ==, (gdouble) (4 * info->row_items));
        }
        n_read++;
      }
    }
  }
  g_test_message ("%u files of NumPy read", n_read);
  scratch_end ();
}

static void
test_numpy_reads (void)
{
  scratch_begin ();
  for (guint t = 0; t < G_N_ELEMENTS (all_types); t++) {
    for (guint rank = 0; rank <= 4; rank++) {
      static const guint64 shape[] = { 5, 3, 2, 1 };
      static const gsize sizes[] = { 4, 8, 1, 2, 4, 8, 1, 2, 4, 8 };
      g_autofree gchar *name = g_strdup_printf ("%s_%u.npy",
          all_types[t].name, rank);
      g_autofree gchar *path = scratch_path (name);
      g_autoptr (GError) error = NULL;
      guint8 bytes[30 * 8] = { 0 };

      for (guint i = 0; i < 30; i++) {
        gfloat f = (gfloat) i;
        gdouble d = i;
        guint64 u = i;

        memcpy (bytes + i * sizes[t], all_types[t].type == CLOTH_NPY_FLOAT32 ?
            (void *) &f : all_types[t].type == CLOTH_NPY_FLOAT64 ?
            (void *) &d : (void *) &u, sizes[t]);
      }
      g_assert_true (write_array (path, all_types[t].type, rank, shape,
              bytes, &error));
      g_assert_no_error (error);
    }
  }
  peer_run ("n=0\n"
      "for t in 'float32 float64 int8 int16 int32 int64 uint8 uint16 uint32 "
      "uint64'.split():\n"
      "  for r in range(5):\n"
      "    a=np.load(f'{t}_{r}.npy',allow_pickle=False)\n"
      "    s=(5,3,2,1)[:r]\n"
      "    assert a.shape==s and a.dtype==t, (a.shape,a.dtype,t)\n"
      "    assert (a.ravel()==np.arange(int(np.prod(s)))).all()\n"
      "    n+=1\n" "assert n==50\n");
  scratch_end ();
}

/* Rows come one by one; the name and the shape come at the close. */
static void
test_streams (void)
{
  static const guint64 row_shape[] = { 7, 3 };
  g_autofree gchar *path = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothNpyWriter) writer = NULL;

  scratch_begin ();
  path = scratch_path ("long.npy");
  writer = start_writer (path, CLOTH_NPY_FLOAT32, 3, row_shape, &error);
  g_assert_no_error (error);
  for (guint row = 0; row < 1234; row++) {
    gfloat items[21];

    for (guint i = 0; i < 21; i++)
      items[i] = (gfloat) (row * 21 + i);
    items[0] = NAN;
    g_assert_true (cloth_npy_writer_append (writer, items, 1, &error));
  }
  g_assert_false (g_file_test (path, G_FILE_TEST_EXISTS));
  g_assert_true (cloth_npy_writer_finish (writer, &error));
  g_assert_no_error (error);
  peer_run ("a=np.load('long.npy')\n"
      "assert a.shape==(1234,7,3) and a.dtype==np.float32\n"
      "b=np.arange(1234*21,dtype=np.float32).reshape(a.shape)\n"
      "b[:,0,0]=np.nan\n"
      "assert np.array_equal(a,b,equal_nan=True)\n"
      "assert os.path.getsize('long.npy')%64==(a.nbytes%64)\n"
      "assert os.listdir('.')==['long.npy']\n");
  scratch_end ();
}

static void
test_abort_leaves_nothing (void)
{
  g_autofree gchar *path = NULL, *kept = NULL;
  g_autoptr (GError) error = NULL;
  gfloat items[4] = { 1, 2, 3, 4 };
  ClothNpyWriter *writer;

  scratch_begin ();
  path = scratch_path ("a.npy");
  scratch_write ("a.npy", "before", -1);
  writer = start_writer (path, CLOTH_NPY_FLOAT32, 1, NULL, &error);
  g_assert_true (cloth_npy_writer_append (writer, items, 4, &error));
  g_assert_cmpuint (scratch_count (), ==, 2);
  cloth_npy_writer_free (writer);
  g_assert_cmpuint (scratch_count (), ==, 1);
  g_assert_true (g_file_get_contents (path, &kept, NULL, NULL));
  g_assert_cmpstr (kept, ==, "before");
  scratch_end ();
}

static void
test_unwritable (void)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = NULL;

  g_assert_null (start_writer ("/nonexistent/a.npy",
          CLOTH_NPY_FLOAT32, 1, NULL, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);
  scratch_begin ();
  folder = scratch_path ("");
  g_assert_null (start_writer (folder, CLOTH_NPY_FLOAT32, 1, NULL, &error));
  g_assert_nonnull (error);
  scratch_end ();
}

static void
test_row_too_large (void)
{
  g_autoptr (GError) error = NULL;
  static const guint64 row_shape[] = { CLOTH_MAX_BUFFER };
  /* Over 2^64 bytes. */
  static const guint64 overflow[] = { G_MAXUINT64 };

  g_assert_null (start_writer ("a.npy", CLOTH_NPY_FLOAT64, 2, row_shape,
          &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
  g_clear_error (&error);
  g_assert_null (start_writer ("a.npy", CLOTH_NPY_FLOAT64, 2, overflow,
          &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
}

static void
test_not_regular (void)
{
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_npy_reader_open ("/dev/zero", &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
  g_clear_error (&error);
  g_assert_null (cloth_npy_reader_open ("/", &error));
  g_assert_nonnull (error);
  g_clear_error (&error);
  g_assert_null (cloth_npy_reader_open ("/nonexistent.npy", &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);
  /* A file that is no array is named. */
  scratch_begin ();
  scratch_write ("a.npy", "no magic bytes here", -1);
  {
    g_autofree gchar *path = scratch_path ("a.npy");

    g_assert_null (cloth_npy_reader_open (path, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_true (g_str_has_prefix (error->message, path));
  }
  scratch_end ();
}

static const struct
{
  const gchar *what, *dictionary;
  gint code;
} hostile[] = {
  {"Fortran order",
        "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2), }",
      CLOTH_FILE_ERROR_UNSUPPORTED},
  {"big-endian", "{'descr': '>f4', 'fortran_order': False, 'shape': (2, 2), }",
      CLOTH_FILE_ERROR_UNSUPPORTED},
  {"objects", "{'descr': '|O', 'fortran_order': False, 'shape': (2,), }",
      CLOTH_FILE_ERROR_UNSUPPORTED},
  {"records",
        "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (2,)}",
      CLOTH_FILE_ERROR_UNSUPPORTED},
  {"five dimensions",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1,1,1,1,1)}",
      CLOTH_FILE_ERROR_UNSUPPORTED},
  {"too short", "{'descr': '<f4', 'fortran_order': False, 'shape': (17,)}",
      CLOTH_FILE_ERROR_TRUNCATED},
  {"overflow of the product",
      "{'descr': '<f4', 'fortran_order': False, 'shape': "
        "(4294967296, 4294967296)}", CLOTH_FILE_ERROR_INVALID},
  {"overflow of a length",
      "{'descr': '<f4', 'fortran_order': False, 'shape': "
        "(18446744073709551616,)}", CLOTH_FILE_ERROR_INVALID},
  {"huge rows of an empty array",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 999999999999)}",
      CLOTH_FILE_ERROR_LIMIT},
  {"negative length",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (-1,)}",
      CLOTH_FILE_ERROR_INVALID},
  {"no tuple", "{'descr': '<f4', 'fortran_order': False, 'shape': (3)}",
      CLOTH_FILE_ERROR_INVALID},
  {"lacks a key", "{'descr': '<f4', 'shape': (3,)}", CLOTH_FILE_ERROR_INVALID},
  {"key twice", "{'shape': (1,), 'descr': '<f4', 'fortran_order': False, "
        "'shape': (3,)}", CLOTH_FILE_ERROR_INVALID},
  {"unknown key", "{'descr': '<f4', 'fortran_order': False, 'shape': (3,), "
        "'x': 1}", CLOTH_FILE_ERROR_INVALID},
  {"no end", "{'descr': '<f4', 'fortran_order': False, 'shape': (3,",
      CLOTH_FILE_ERROR_INVALID},
  {"something behind", "{'descr': '<f4', 'fortran_order': False, "
        "'shape': (3,)} + evil ()", CLOTH_FILE_ERROR_INVALID},
  {"empty", "", CLOTH_FILE_ERROR_INVALID},
  {"ends before a text", "{'descr': ", CLOTH_FILE_ERROR_UNSUPPORTED},
  {"ends before a key", "{", CLOTH_FILE_ERROR_INVALID},
  {"ends in a text", "{'descr': '<f4", CLOTH_FILE_ERROR_UNSUPPORTED},
  {"ends in a key", "{'descr", CLOTH_FILE_ERROR_INVALID},
  {"key without a colon", "{'descr' '<f4'}", CLOTH_FILE_ERROR_INVALID},
  {"escape in a type", "{'descr': '\\x3cf4'}", CLOTH_FILE_ERROR_UNSUPPORTED},
  {"key too long", "{'descrdescrdescrdescrdescrdescrdescr': 1}",
      CLOTH_FILE_ERROR_INVALID},
  {"type that is no text", "{'descr': '\xff\xfe'}", CLOTH_FILE_ERROR_INVALID},
  {"byte of unknown type",
        "{'descr': '<i3', 'fortran_order': False, 'shape': (2,)}",
      CLOTH_FILE_ERROR_UNSUPPORTED},
  {"order cut short", "{'descr': '<f4', 'fortran_order': Fals",
      CLOTH_FILE_ERROR_INVALID},
  {"order a number", "{'descr': '<f4', 'fortran_order': 0, 'shape': (2,)}",
      CLOTH_FILE_ERROR_INVALID},
  {"type twice", "{'descr': '<f4', 'descr': '<f4'}", CLOTH_FILE_ERROR_INVALID},
  {"order twice", "{'fortran_order': False, 'fortran_order': False}",
      CLOTH_FILE_ERROR_INVALID},
  {"no type", "{'fortran_order': False, 'shape': (2,)}",
      CLOTH_FILE_ERROR_INVALID},
  {"no shape", "{'descr': '<f4', 'fortran_order': False}",
      CLOTH_FILE_ERROR_INVALID},
  {"two numbers without a comma",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (2 2)}",
      CLOTH_FILE_ERROR_INVALID},
  {"number over 64 bits by a digit", "{'shape': (184467440737095516150,)}",
      CLOTH_FILE_ERROR_INVALID},
  {"no tuple at all", "{'descr': '<f4', 'fortran_order': False, 'shape': 3}",
      CLOTH_FILE_ERROR_INVALID},
  {"two lengths and no end",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2;",
      CLOTH_FILE_ERROR_INVALID},
  {"two keys without a comma", "{'descr': '<f4' 'fortran_order': False}",
      CLOTH_FILE_ERROR_INVALID},
  {"ends in a length", "{'shape': (2", CLOTH_FILE_ERROR_INVALID},
  {"overflow within a row",
      "{'descr': '<f4', 'fortran_order': False, 'shape': "
        "(0, 4294967296, 4294967296)}", CLOTH_FILE_ERROR_INVALID},
  {"overflow in bytes",
      "{'descr': '<f8', 'fortran_order': False, 'shape': "
        "(4294967296, 4294967295)}", CLOTH_FILE_ERROR_INVALID},
};

/* Headers of other writers, for an array of two items or two rows of one. */
static void
test_tolerance (void)
{
  static const struct
  {
    const gchar *dictionary;
    ClothNpyType type;
    guint rank;
  } good[] = {
    /* Python 2 wrote long integers so. */
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (2L, 1L)}",
        CLOTH_NPY_FLOAT32, 2},
    {"{\"descr\":\"<u1\",\"fortran_order\":False,\"shape\":(2,)}",
        CLOTH_NPY_UINT8, 1},
    {"{'descr': '<i1', 'fortran_order': False, 'shape': (2,), } \n",
        CLOTH_NPY_INT8, 1},
    {" { 'shape' : ( 2 , ) , 'descr' : '<u8' , 'fortran_order' : False , } ",
        CLOTH_NPY_UINT64, 1},
  };

  for (guint i = 0; i < G_N_ELEMENTS (good); i++) {
    guint8 bytes[256] = "\x93NUMPY\x01";
    gsize length = strlen (good[i].dictionary);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothNpyReader) reader = NULL;
    const ClothNpyInfo *info;

    bytes[8] = (guint8) length;
    memcpy (bytes + 10, good[i].dictionary, length);
    reader = cloth_npy_reader_new (cloth_input_new_memory (bytes,
            10 + length + 16), &error);
    g_assert_no_error (error);
    info = cloth_npy_reader_get_info (reader);
    g_assert_cmpint (info->type, ==, good[i].type);
    g_assert_cmpuint (info->rank, ==, good[i].rank);
    g_assert_cmpuint (info->n_rows, ==, 2);
  }
}

static void
test_hostile (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (hostile); i++) {
    guint8 bytes[512] = "\x93NUMPY\x01";
    gsize length = strlen (hostile[i].dictionary);
    g_autoptr (GError) error = NULL;

    bytes[8] = (guint8) length;
    memcpy (bytes + 10, hostile[i].dictionary, length);
    g_assert_null (cloth_npy_reader_new (cloth_input_new_memory (bytes,
                10 + length + 64), &error));
    g_test_message ("%s: %s", hostile[i].what, error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, hostile[i].code);
    if (hostile[i].code == CLOTH_FILE_ERROR_INVALID)
      g_assert_true (g_str_has_prefix (error->message,
              "not a valid .npy file: "));
  }
}

static void
test_hostile_preface (void)
{
  static const struct
  {
    const gchar *bytes;
    gsize size;
    gint code;
  } cases[] = {
    {"", 0, CLOTH_FILE_ERROR_TRUNCATED},
    {"\x93NUMPY\x01\x00\x76", 9, CLOTH_FILE_ERROR_TRUNCATED},
    {"\x93NUMPX\x01\x00\x00\x00", 10, CLOTH_FILE_ERROR_INVALID},
    {"\x93NUMPY\x04\x00\x00\x00", 10, CLOTH_FILE_ERROR_UNSUPPORTED},
    {"\x93NUMPY\x01\x00\x10\x00{", 11, CLOTH_FILE_ERROR_TRUNCATED},
    {"\x93NUMPY\x02\x00\xff\xff\xff\xff", 12, CLOTH_FILE_ERROR_LIMIT},
    {"\x93NUMPY\x03\x00\x10", 9, CLOTH_FILE_ERROR_TRUNCATED},
    {"\x93NUMPY\x03\x00\x10\x00", 10, CLOTH_FILE_ERROR_TRUNCATED},
    /* A type that ends in a 0. */
    {"\x93NUMPY\x01\x00\x0d\x00{'descr': '\0'", 23,
        CLOTH_FILE_ERROR_UNSUPPORTED},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_npy_reader_new (cloth_input_new_memory (
                (const guint8 *) cases[i].bytes, cases[i].size), &error));
    g_assert_error (error, CLOTH_FILE_ERROR, cases[i].code);
  }
}

static void
test_rows_out_of_range (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothNpyReader) reader = NULL;
  guint64 shape[] = { 3, 2 };
  gfloat items[6] = { 0 };
  gdouble doubles[6];

  scratch_begin ();
  path = scratch_path ("a.npy");
  g_assert_true (write_array (path, CLOTH_NPY_FLOAT32, 2, shape, items,
          &error));
  reader = cloth_npy_reader_open (path, &error);
  g_assert_no_error (error);
  g_assert_false (cloth_npy_reader_read_float (reader, 3, 1, items, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_clear_error (&error);
  g_assert_false (cloth_npy_reader_read_float (reader, 1, G_MAXUINT64, items,
          &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_clear_error (&error);
  g_assert_false (cloth_npy_reader_read_raw (reader, 2, 2, items, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_cmpstr (error->message, ==, "rows 2 to 4 of 3");
  g_clear_error (&error);
  g_assert_false (cloth_npy_reader_read_float (reader, 4, 0, items, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_clear_error (&error);
  /* It shrinks under the reader. */
  g_assert_cmpint (truncate (path, 100), ==, 0);
  g_assert_false (cloth_npy_reader_read_float (reader, 0, 3, items, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED);
  g_clear_error (&error);
  g_assert_false (cloth_npy_reader_read_double (reader, 0, 3, doubles, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED);
  g_clear_error (&error);
  g_assert_false (cloth_npy_reader_read_raw (reader, 0, 3, items, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED);
  scratch_end ();
}

/* What a killed program left, or what somebody put there. */
static void
test_parts (void)
{
  static const struct
  {
    const gchar *shape;
    guint data_bytes;
    gboolean counted;
    guint64 n_rows;
    const gchar *says;
  } cases[] = {
    {"()", 4, FALSE, 0, "it has no rows that can be counted"},
    {"(0, 0)", 0, FALSE, 0, "it has no rows that can be counted"},
    {"(9,)", 40, TRUE, 10, "the header has no room for the number of rows"},
  };
  g_autofree gchar *head = NULL;

  scratch_begin ();
  head = scratch_path ("take.json");
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothParts) parts = cloth_parts_new (head, "", &error);
    g_autofree gchar *path = NULL, *text = g_strdup_printf ("{'descr': '<f4', "
        "'fortran_order': False, 'shape': %s}\n", cases[i].shape);
    g_autoptr (GByteArray) bytes = g_byte_array_new ();
    guint8 length = (guint8) strlen (text);
    guint64 n_rows = 1;

    g_assert_no_error (error);
    path = cloth_parts_get_path (parts, "a.npy");
    /* Killed before it had begun the file. */
    g_assert_true (cloth_npy_part_count (parts, "a.npy", &n_rows, &error));
    g_assert_cmpuint (n_rows, ==, 0);
    g_assert_false (cloth_npy_part_finish (parts, "a.npy", 0, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
    g_clear_error (&error);

    g_byte_array_append (bytes, (const guint8 *) "\x93NUMPY\x01\x00", 8);
    g_byte_array_append (bytes, &length, 1);
    g_byte_array_append (bytes, (const guint8 *) "", 1);
    g_byte_array_append (bytes, (const guint8 *) text, length);
    g_byte_array_set_size (bytes, bytes->len + cases[i].data_bytes);
    g_assert_true (g_file_set_contents (path, (const gchar *) bytes->data,
            bytes->len, NULL));
    g_assert_true (cloth_npy_part_count (parts, "a.npy", &n_rows, &error) ==
        cases[i].counted);
    if (cases[i].counted) {
      g_assert_no_error (error);
      g_assert_cmpuint (n_rows, ==, cases[i].n_rows);
      g_assert_false (cloth_npy_part_finish (parts, "a.npy", n_rows, &error));
    }
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_nonnull (strstr (error->message, cases[i].says));
  }
  scratch_end ();
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/npy/reads-numpy", test_reads_numpy);
  g_test_add_func ("/npy/numpy-reads", test_numpy_reads);
  g_test_add_func ("/npy/streams", test_streams);
  g_test_add_func ("/npy/abort-leaves-nothing", test_abort_leaves_nothing);
  g_test_add_func ("/npy/unwritable", test_unwritable);
  g_test_add_func ("/npy/row-too-large", test_row_too_large);
  g_test_add_func ("/npy/not-regular", test_not_regular);
  g_test_add_func ("/npy/tolerance", test_tolerance);
  g_test_add_func ("/npy/hostile", test_hostile);
  g_test_add_func ("/npy/hostile-preface", test_hostile_preface);
  g_test_add_func ("/npy/rows-out-of-range", test_rows_out_of_range);
  g_test_add_func ("/npy/parts", test_parts);
  return g_test_run ();
}
