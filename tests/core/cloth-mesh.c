/* Topology and mesh: values, bytes, caps, and bytes that lie.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/cloth/cloth.h>
#include <math.h>
#include <string.h>

#include "tests/core/farmemory.h"
#include "tests/core/refused.h"

/* The layout as docs/streams.md has it, written out by hand: two triangles and a quad
 * would do, here one of each over four vertices, no grid. */
static const guint8 topology_bytes[] = {
  'G', 'C', 'T', 'P', 1, 0, 32, 0,      /* magic, version, header */
  4, 0, 0, 0, 0, 0, 0, 0,       /* vertices, columns */
  0, 0, 0, 0, 2, 0, 0, 0,       /* rows, faces */
  0, 0, 0, 0, 0, 0, 0, 0,       /* reserved */
  0, 0, 0, 0, 0, 0, 0, 0,       /* uv (0, 0) */
  0, 0, 0x80, 0x3f, 0, 0, 0, 0, /* (1, 0) */
  0, 0, 0x80, 0x3f, 0, 0, 0, 0x40,      /* (1, 2) */
  0, 0, 0, 0, 0, 0, 0, 0x40,    /* (0, 2) */
  0, 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0,       /* quad */
  0, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff    /* triangle */
};

/* Two vertices, the second unseen, no covariances. */
static const guint8 mesh_bytes[] = {
  'G', 'C', 'M', 'B', 1, 0, 32, 0,      /* magic, version, header */
  0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,       /* sequence */
  2, 0, 0, 0, 0, 0, 0, 0,       /* vertices, flags */
  0, 0, 0, 0, 0, 0, 0, 0,       /* reserved */
  0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0, 0x3f,       /* 1, -2, 0.5 */
  0, 0, 0xc0, 0x7f, 0, 0, 0xc0, 0x7f, 0, 0, 0xc0, 0x7f, /* NaN */
  1, 0                          /* measured, unseen */
};

static GstBuffer *
buffer_of (const guint8 * bytes, gsize size)
{
  return size ? gst_buffer_new_memdup (bytes, size) : gst_buffer_new ();
}

static void
assert_bytes (GstBuffer * buffer, const guint8 * bytes, gsize size)
{
  GstMapInfo map;

  g_assert_true (gst_buffer_map (buffer, &map, GST_MAP_READ));
  g_assert_cmpmem (map.data, map.size, bytes, size);
  gst_buffer_unmap (buffer, &map);
}

static void
test_grid (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) grid = gst_cloth_topology_new_grid (4, 3, 0.6f,
      0.5f, &error);
  guint n;
  const gfloat *uv;
  const guint32 *faces;

  g_assert_no_error (error);
  g_assert_cmpuint (gst_cloth_topology_get_n_vertices (grid), ==, 12);
  g_assert_cmpuint (gst_cloth_topology_get_n_faces (grid), ==, 6);
  uv = gst_cloth_topology_get_uv (grid, &n);
  g_assert_cmpuint (n, ==, 24);
  for (guint i = 0; i < 12; i++) {
    g_assert_cmpfloat_with_epsilon (uv[2 * i], 0.2 * (i % 4), 1e-7);
    g_assert_cmpfloat_with_epsilon (uv[2 * i + 1], 0.25 * (i / 4), 1e-7);
  }
  faces = gst_cloth_topology_get_faces (grid, &n);
  g_assert_cmpuint (n, ==, 24);
  for (guint f = 0; f < 6; f++) {
    gdouble area = 0;

    /* v runs down, so counter-clockwise from the printed side is a negative area by
     * the shoelace formula taken with v up. */
    for (guint k = 0; k < 4; k++) {
      guint a = faces[4 * f + k], b = faces[4 * f + (k + 1) % 4];

      area += 0.5 * (uv[2 * a] * -uv[2 * b + 1] - uv[2 * b] * -uv[2 * a + 1]);
    }
    g_assert_cmpfloat_with_epsilon (area, 0.2 * 0.25, 1e-6);
  }
}

static void
test_topology_bytes (void)
{
  const gfloat uv[8] = { 0, 0, 1, 0, 1, 2, 0, 2 };
  const guint32 faces[8] = { 0, 3, 2, 1, 0, 2, 1, GST_CLOTH_NO_VERTEX };
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) topology = gst_cloth_topology_new (4, 0, 0, uv,
      faces, 2, &error);
  g_autoptr (GstBuffer) written = NULL;
  g_autoptr (GstBuffer) buffer = buffer_of (topology_bytes,
      sizeof topology_bytes);
  g_autoptr (GstClothTopology) read = NULL;
  guint n;

  g_assert_no_error (error);
  written = gst_cloth_topology_to_buffer (topology);
  assert_bytes (written, topology_bytes, sizeof topology_bytes);
  read = gst_cloth_topology_from_buffer (buffer, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (gst_cloth_topology_get_n_vertices (read), ==, 4);
  g_assert_cmpuint (gst_cloth_topology_get_columns (read), ==, 0);
  g_assert_cmpmem (gst_cloth_topology_get_uv (read, NULL), sizeof uv, uv,
      sizeof uv);
  g_assert_cmpmem (gst_cloth_topology_get_faces (read, &n), sizeof faces, faces,
      sizeof faces);
  g_assert_cmpuint (n, ==, 8);
  g_assert_true (gst_cloth_topology_get_faces (read, NULL) ==
      gst_cloth_topology_get_faces (read, &n));
  g_assert_true (gst_cloth_topology_ref (read) == read);
  gst_cloth_topology_unref (read);
}

static void
test_caps (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) grid = gst_cloth_topology_new_grid (9, 9, 0.4f,
      0.4f, &error);
  g_autoptr (GstCaps) caps = gst_cloth_topology_to_caps (grid, 30000, 1001);
  g_autoptr (GstCaps) template = gst_caps_from_string (GST_CLOTH_MESH_CAPS);
  g_autofree gchar *text = gst_caps_to_string (caps);
  g_autoptr (GstCaps) parsed = gst_caps_from_string (text);
  g_autoptr (GstClothTopology) read = gst_cloth_topology_from_caps (parsed,
      &error);
  const GstStructure *structure = gst_caps_get_structure (caps, 0);
  const GValue *headers = gst_structure_get_value (structure, "streamheader");
  gint fps_n, fps_d;

  g_assert_no_error (error);
  g_assert_true (gst_caps_is_subset (caps, template));
  g_assert_true (gst_caps_is_fixed (caps));
  g_assert_true (gst_structure_get_fraction (structure, "framerate", &fps_n,
          &fps_d));
  g_assert_cmpint (fps_n, ==, 30000);
  g_assert_cmpint (fps_d, ==, 1001);
  g_assert_true (GST_BUFFER_FLAG_IS_SET (gst_value_get_buffer
          (gst_value_array_get_value (headers, 0)), GST_BUFFER_FLAG_HEADER));
  g_assert_cmpuint (gst_cloth_topology_get_columns (read), ==, 9);
  g_assert_cmpuint (gst_cloth_topology_get_rows (read), ==, 9);
  g_assert_cmpmem (gst_cloth_topology_get_uv (read, NULL), 162 * 4,
      gst_cloth_topology_get_uv (grid, NULL), 162 * 4);
}

static void
test_bad_caps (void)
{
  static const struct
  {
    const gchar *caps;
    gint code;
  } cases[] = {
    {"video/x-raw", GST_CLOTH_ERROR_CAPS},
    {"application/x-cloth-mesh", GST_CLOTH_ERROR_CAPS},
    {"application/x-cloth-mesh, vertices=4", GST_CLOTH_ERROR_CAPS},
    {"application/x-cloth-mesh, vertices=4, version=2",
        GST_CLOTH_ERROR_VERSION},
    {"application/x-cloth-mesh, vertices=4, streamheader=7",
        GST_CLOTH_ERROR_CAPS},
    {"application/x-cloth-mesh, vertices=4, streamheader=<>",
        GST_CLOTH_ERROR_CAPS},
    {"application/x-cloth-mesh, vertices=4, streamheader=<1>",
        GST_CLOTH_ERROR_CAPS},
    {"application/x-cloth-mesh, vertices=4, streamheader=<00112233>",
        GST_CLOTH_ERROR_CAPS},
    {"application/x-cloth-mesh, vertices=4, streamheader=<(buffer)00112233>",
        GST_CLOTH_ERROR_MAGIC},
    {"EMPTY", GST_CLOTH_ERROR_CAPS},
    {"ANY", GST_CLOTH_ERROR_CAPS},
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) grid = gst_cloth_topology_new_grid (2, 2, 1, 1,
      NULL);
  g_autoptr (GstCaps) differ = gst_cloth_topology_to_caps (grid, 0, 1);

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) why = NULL;
    g_autoptr (GstCaps) caps = gst_caps_from_string (cases[i].caps);

    g_assert_null (gst_cloth_topology_from_caps (caps, &why));
    g_assert_error (why, GST_CLOTH_ERROR, cases[i].code);
    g_test_message ("%s: %s", cases[i].caps, why->message);
  }
  for (gint vertices = -1; vertices <= 5; vertices += 6) {
    g_clear_error (&error);
    gst_caps_set_simple (differ, "vertices", G_TYPE_INT, vertices, NULL);
    g_assert_null (gst_cloth_topology_from_caps (differ, &error));
    g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_CAPS);
    g_assert_true (g_str_has_suffix (error->message,
            " vertices, their streamheader 4"));
  }
}

static void
test_unreadable (void)
{
  g_autoptr (GstBuffer) buffer = far_buffer (sizeof topology_bytes);
  g_autoptr (GError) error = NULL;

  g_assert_null (gst_cloth_topology_from_buffer (buffer, &error));
  g_assert_nonnull (error);
  g_assert_cmpint (error->domain, ==, GST_CLOTH_ERROR);
  g_clear_error (&error);
  g_assert_null (gst_cloth_mesh_from_buffer (buffer, &error));
  g_assert_nonnull (error);
  g_assert_cmpint (error->domain, ==, GST_CLOTH_ERROR);
}

typedef struct
{
  const gchar *name;
  guint at;
  guint32 word;
  gint code;
} Bend;

typedef gpointer (*Reader) (GstBuffer * buffer, GError ** error);

/* Each case has one 32 bit word of good bytes changed; also every truncation and a byte
 * too many must be refused. */
static void
check_hostile (Reader reader, const guint8 * bytes, gsize size,
    const Bend * bends, guint n)
{
  g_autofree guint8 *longer = g_malloc0 (size + 1);

  for (guint i = 0; i < n; i++) {
    g_autofree guint8 *bent = g_memdup2 (bytes, size);
    g_autoptr (GstBuffer) buffer = NULL;
    g_autoptr (GError) error = NULL;

    guint32 word = GUINT32_TO_LE (bends[i].word);

    memcpy (bent + bends[i].at, &word, 4);
    buffer = buffer_of (bent, size);
    g_assert_null (reader (buffer, &error));
    g_test_message ("%s: %s", bends[i].name, error->message);
    g_assert_error (error, GST_CLOTH_ERROR, bends[i].code);
  }
  for (gsize cut = 0; cut < size; cut++) {
    g_autoptr (GstBuffer) buffer = buffer_of (bytes, cut);
    g_autoptr (GError) error = NULL;

    g_assert_null (reader (buffer, &error));
    g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_TRUNCATED);
  }
  memcpy (longer, bytes, size);
  {
    g_autoptr (GstBuffer) buffer = buffer_of (longer, size + 1);
    g_autoptr (GError) error = NULL;

    g_assert_null (reader (buffer, &error));
    g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  }
}

#define NOT_A_NUMBER 0x7fc00000u
#define INFINITE 0x7f800000u

static void
test_hostile_topology (void)
{
  static const Bend bends[] = {
    {"magic", 0, 0x41414141, GST_CLOTH_ERROR_MAGIC},
    {"version 2", 4, 0x00200002, GST_CLOTH_ERROR_VERSION},
    {"header of 4096 bytes", 4, 0x10000001, GST_CLOTH_ERROR_VALUE},
    {"no vertex", 8, 0, GST_CLOTH_ERROR_LIMIT},
    {"4 G vertices", 8, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"a million vertices", 8, 1000000, GST_CLOTH_ERROR_TRUNCATED},
    {"fewer vertices", 8, 3, GST_CLOTH_ERROR_VALUE},
    {"columns without rows", 12, 4, GST_CLOTH_ERROR_VALUE},
    {"a grid that overflows", 16, 0x40000001, GST_CLOTH_ERROR_VALUE},
    {"2 M faces", 20, 2000000, GST_CLOTH_ERROR_TRUNCATED},
    {"more faces than allowed", 20, 2000001, GST_CLOTH_ERROR_LIMIT},
    {"4 G faces", 20, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"uv NaN", 32, NOT_A_NUMBER, GST_CLOTH_ERROR_VALUE},
    {"uv infinite", 60, INFINITE, GST_CLOTH_ERROR_VALUE},
    {"face past the end", 64, 4, GST_CLOTH_ERROR_VALUE},
    {"face with no third vertex", 72, 0xffffffff, GST_CLOTH_ERROR_VALUE},
    {"face with fourth vertex past the end", 92, 0xfffffffe,
        GST_CLOTH_ERROR_VALUE},
  };

  check_hostile ((Reader) gst_cloth_topology_from_buffer, topology_bytes,
      sizeof topology_bytes, bends, G_N_ELEMENTS (bends));
}

static void
test_bad_topology (void)
{
  const gfloat uv[8] = { 0, 0, 1, 0, 1, 2, 0, NAN };
  const guint32 faces[4] = { 0, 1, 2, 4 };
  static const guint sizes[][2] = { {0, 0}, {1, 5}, {5, 1}, {1001, 1000},
  {65536, 65536}, {G_MAXUINT, G_MAXUINT}
  };
  g_autoptr (GError) error = NULL;

  g_assert_null (gst_cloth_topology_new (4, 0, 0, uv, NULL, 0, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  g_assert_null (gst_cloth_topology_new (3, 0, 0, uv, faces, 1, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  g_assert_null (gst_cloth_topology_new (3, 2, 2, uv, NULL, 0, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  g_assert_null (gst_cloth_topology_new_from_arrays (0, 0, uv, 5, NULL, 0,
          &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  g_assert_null (gst_cloth_topology_new_from_arrays (0, 0, uv, 6, faces, 3,
          &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    g_assert_null (gst_cloth_topology_new_grid (sizes[i][0], sizes[i][1], 1, 1,
            &error));
    g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_LIMIT);
    g_clear_error (&error);
  }
  g_assert_null (gst_cloth_topology_new_grid (2, 2, 0, 1, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  {
    static const gfloat sizes_m[][2] = { {1, INFINITY}, {NAN, 1}, {1, -1} };

    for (guint i = 0; i < G_N_ELEMENTS (sizes_m); i++) {
      g_assert_null (gst_cloth_topology_new_grid (2, 2, sizes_m[i][0],
              sizes_m[i][1], &error));
      g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
      g_clear_error (&error);
    }
  }
}

static void
test_mesh_bytes (void)
{
  const gfloat positions[6] = { 1, -2, 0.5f, NAN, NAN, NAN };
  const guint8 states[2] = { GST_CLOTH_VERTEX_MEASURED,
    GST_CLOTH_VERTEX_UNSEEN
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (0x0102030405060708, 2,
      positions, states, NULL);
  g_autoptr (GstBuffer) written = gst_cloth_mesh_to_buffer (mesh);
  g_autoptr (GstBuffer) buffer = buffer_of (mesh_bytes, sizeof mesh_bytes);
  g_autoptr (GstClothMesh) read = gst_cloth_mesh_from_buffer (buffer, &error);
  guint n;

  g_assert_no_error (error);
  assert_bytes (written, mesh_bytes, sizeof mesh_bytes);
  g_assert_cmpuint (gst_cloth_mesh_get_sequence (read), ==, 0x0102030405060708);
  g_assert_cmpmem (gst_cloth_mesh_get_positions (read, &n), 12, positions, 12);
  g_assert_cmpuint (n, ==, 6);
  g_assert_true (isnan (gst_cloth_mesh_get_positions (read, NULL)[5]));
  g_assert_cmpmem (gst_cloth_mesh_get_states (read, &n), 2, states, 2);
  g_assert_cmpuint (n, ==, 2);
  g_assert_null (gst_cloth_mesh_get_covariances (read, &n));
  g_assert_cmpuint (n, ==, 0);
}

static GstClothMesh *
random_mesh (GRand * rand, guint n, gboolean with_covariances)
{
  g_autofree gfloat *positions = g_new (gfloat, 3 * n);
  g_autofree gfloat *covariances = g_new (gfloat, 6 * n);
  g_autofree guint8 *states = g_new (guint8, n);

  for (guint i = 0; i < 3 * n; i++)
    positions[i] = (gfloat) g_rand_double_range (rand, -2, 2);
  for (guint i = 0; i < 6 * n; i++)
    covariances[i] = (gfloat) g_rand_double_range (rand, 0, 1e-6);
  for (guint i = 0; i < n; i++)
    states[i] = (guint8) g_rand_int_range (rand, 0, 5);
  return gst_cloth_mesh_new (g_rand_int (rand), n, positions, states,
      with_covariances ? covariances : NULL);
}

static void
test_mesh_round_trips (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (5);

  for (guint i = 0; i < 64; i++) {
    guint n = i < 4 ? i + 1 : (guint) g_rand_int_range (rand, 1, 3000);
    g_autoptr (GError) error = NULL;
    g_autoptr (GstClothMesh) mesh = random_mesh (rand, n, i % 2);
    g_autoptr (GstBuffer) buffer = gst_cloth_mesh_to_buffer (mesh);
    g_autoptr (GstBuffer) pieces = gst_buffer_new ();
    g_autoptr (GstBuffer) odd = NULL;
    gsize size = gst_buffer_get_size (buffer), cut = size / 3;
    GstBuffer *forms[3] = { buffer, pieces };
    guint8 *shifted = g_malloc (size + 1);

    /* in one piece, in pieces, and at an address that no float may have */
    gst_buffer_append_memory (pieces, gst_memory_copy (gst_buffer_peek_memory
            (buffer, 0), 0, cut));
    gst_buffer_append_memory (pieces, gst_memory_copy (gst_buffer_peek_memory
            (buffer, 0), cut, -1));
    gst_buffer_extract (buffer, 0, shifted + 1, size);
    odd = gst_buffer_new_wrapped_full (0, shifted, size + 1, 1, size, shifted,
        g_free);
    forms[2] = odd;
    for (guint f = 0; f < 3; f++) {
      g_autoptr (GstClothMesh) read = gst_cloth_mesh_from_buffer (forms[f],
          &error);
      gsize floats = (i % 2 ? 6 : 0) * n * sizeof (gfloat);

      g_assert_no_error (error);
      g_assert_cmpuint (gst_cloth_mesh_get_n_vertices (read), ==, n);
      g_assert_cmpuint (gst_cloth_mesh_get_sequence (read), ==,
          gst_cloth_mesh_get_sequence (mesh));
      g_assert_cmpmem (gst_cloth_mesh_get_positions (read, NULL), 12 * n,
          gst_cloth_mesh_get_positions (mesh, NULL), 12 * n);
      g_assert_cmpmem (gst_cloth_mesh_get_states (read, NULL), n,
          gst_cloth_mesh_get_states (mesh, NULL), n);
      g_assert_cmpmem (gst_cloth_mesh_get_covariances (read, NULL), floats,
          gst_cloth_mesh_get_covariances (mesh, NULL), floats);
    }
  }
}

/* Neither writing nor reading copies, and either side may go first. */
static void
test_mesh_zero_copy (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (6);
  GstClothMesh *mesh = random_mesh (rand, 100, TRUE), *read;
  const gfloat *positions = gst_cloth_mesh_get_positions (mesh, NULL);
  gfloat first = positions[0];
  GstBuffer *buffer = gst_cloth_mesh_to_buffer (mesh);
  GstMapInfo map;

  /* Whoever writes gets a copy of his own. */
  g_assert_true (gst_buffer_map (buffer, &map, GST_MAP_READWRITE));
  memset (map.data, 0, map.size);
  gst_buffer_unmap (buffer, &map);
  g_assert_cmpmem (positions, 4, &first, 4);
  gst_cloth_mesh_unref (mesh);
  gst_buffer_unref (buffer);

  mesh = random_mesh (rand, 100, TRUE);
  positions = gst_cloth_mesh_get_positions (mesh, NULL);
  first = positions[0];
  buffer = gst_cloth_mesh_to_buffer (mesh);
  gst_cloth_mesh_unref (mesh);
  read = gst_cloth_mesh_from_buffer (buffer, NULL);
  gst_buffer_unref (buffer);
#if G_BYTE_ORDER == G_LITTLE_ENDIAN
  g_assert_true (gst_cloth_mesh_get_positions (read, NULL) == positions);
#endif
  g_assert_cmpmem (gst_cloth_mesh_get_positions (read, NULL), 4, &first, 4);
  gst_cloth_mesh_unref (read);
}

/* The bytes are those of the mesh, and keep it alive. */
static void
test_mesh_points (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (7);
  GstClothMesh *mesh = random_mesh (rand, 100, TRUE);
  const gfloat *positions = gst_cloth_mesh_get_positions (mesh, NULL);
  g_autofree gfloat *copy = g_memdup2 (positions, 1200);
  g_autoptr (GBytes) points = gst_cloth_mesh_get_points (mesh);
  gsize size;

  gst_cloth_mesh_unref (mesh);
  g_assert_true (g_bytes_get_data (points, &size) == (gconstpointer) positions);
  g_assert_cmpmem (g_bytes_get_data (points, NULL), size, copy, 1200);
}

/* A vertex is known in full or unseen. */
static void
test_mesh_settles_states (void)
{
  const gfloat positions[18] = { 1, 2, 3, 1, NAN, 3, 4, 5, 6, INFINITY, 0, 0,
    1, 1, 1, 1, 1, -INFINITY
  };
  const guint8 states[6] = { 1, 1, 0, 3, 99, 2 };
  const gfloat covariances[36] = { 1, 2, INFINITY, 4, 5, 6 };
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (0, 6, positions, states,
      covariances);
  g_autoptr (GstBuffer) buffer = gst_cloth_mesh_to_buffer (mesh);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) read = gst_cloth_mesh_from_buffer (buffer, &error);
  const gfloat *p = gst_cloth_mesh_get_positions (mesh, NULL);
  const gfloat *c = gst_cloth_mesh_get_covariances (mesh, NULL);
  const guint8 *s = gst_cloth_mesh_get_states (mesh, NULL);

  g_assert_no_error (error);
  g_assert_nonnull (read);
  g_assert_cmpuint (s[0], ==, GST_CLOTH_VERTEX_MEASURED);
  g_assert_cmpfloat (p[2], ==, 3);
  g_assert_cmpfloat (c[1], ==, 2);
  g_assert_true (isnan (c[2]));
  for (guint i = 1; i < 6; i++) {
    g_assert_cmpuint (s[i], ==, GST_CLOTH_VERTEX_UNSEEN);
    for (guint k = 0; k < 3; k++)
      g_assert_true (isnan (p[3 * i + k]));
    for (guint k = 0; k < 6; k++)
      g_assert_true (isnan (c[6 * i + k]));
  }
}

static void
test_hostile_mesh (void)
{
  static const Bend bends[] = {
    {"magic of a topology", 0, 0x50544347, GST_CLOTH_ERROR_MAGIC},
    {"version 0", 4, 0x00200000, GST_CLOTH_ERROR_VERSION},
    {"header of 0 bytes", 4, 0x00000001, GST_CLOTH_ERROR_VALUE},
    {"no vertex", 16, 0, GST_CLOTH_ERROR_LIMIT},
    {"a million vertices", 16, 1000000, GST_CLOTH_ERROR_TRUNCATED},
    {"a million and one", 16, 1000001, GST_CLOTH_ERROR_LIMIT},
    {"4 G vertices", 16, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"one vertex", 16, 1, GST_CLOTH_ERROR_VALUE},
    {"covariances that aren't there", 20, 1, GST_CLOTH_ERROR_TRUNCATED},
    {"an unknown flag", 20, 2, GST_CLOTH_ERROR_VALUE},
    {"seen at NaN", 32, NOT_A_NUMBER, GST_CLOTH_ERROR_VALUE},
    {"seen at infinity", 36, INFINITE, GST_CLOTH_ERROR_VALUE},
    {"seen at infinity, z", 40, INFINITE, GST_CLOTH_ERROR_VALUE},
    {"unseen somewhere", 44, 0, GST_CLOTH_ERROR_VALUE},
    {"unseen somewhere, y", 48, 0, GST_CLOTH_ERROR_VALUE},
    {"unseen at infinity", 52, INFINITE, GST_CLOTH_ERROR_VALUE},
    {"state 5", 54, 0x00057fc0, GST_CLOTH_ERROR_VALUE},
  };
  static guint8 with_covariance[32 + 12 + 24 + 1];
  static const Bend infinite[] = {
    {"covariance infinite", 64, INFINITE, GST_CLOTH_ERROR_VALUE}
  };

  check_hostile ((Reader) gst_cloth_mesh_from_buffer, mesh_bytes,
      sizeof mesh_bytes, bends, G_N_ELEMENTS (bends));
  memcpy (with_covariance, mesh_bytes, 44);
  with_covariance[16] = with_covariance[20] = 1;
  with_covariance[68] = GST_CLOTH_VERTEX_TWO_VIEWS;
  check_hostile ((Reader) gst_cloth_mesh_from_buffer, with_covariance,
      sizeof with_covariance, infinite, 1);
}

static void
test_mesh_lengths (void)
{
  const gfloat floats[6] = { 0 };
  const guint8 states[2] = { 1, 1 };
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;

  g_assert_null (gst_cloth_mesh_new_from_arrays (0, floats, 5, states, 2, NULL,
          0, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  g_assert_null (gst_cloth_mesh_new_from_arrays (0, floats, 3, states, 1,
          floats, 5, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  g_assert_null (gst_cloth_mesh_new_from_arrays (0, floats, 0, states, 0, NULL,
          0, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
  g_clear_error (&error);
  mesh = gst_cloth_mesh_new_from_arrays (0, floats, 6, states, 2, NULL, 0,
      &error);
  g_assert_no_error (error);
  g_assert_cmpuint (gst_cloth_mesh_get_n_vertices (mesh), ==, 2);
  ASSERT_MISUSE (gst_cloth_mesh_new (0, 0, floats, states, NULL));
  ASSERT_MISUSE (gst_cloth_mesh_new (0, 1000001, floats, states, NULL));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  gst_init (&argc, &argv);
  g_test_add_func ("/cloth/topology/grid", test_grid);
  g_test_add_func ("/cloth/topology/bytes", test_topology_bytes);
  g_test_add_func ("/cloth/topology/caps", test_caps);
  g_test_add_func ("/cloth/topology/bad-caps", test_bad_caps);
  g_test_add_func ("/cloth/unreadable", test_unreadable);
  g_test_add_func ("/cloth/mesh/points", test_mesh_points);
  g_test_add_func ("/cloth/topology/hostile", test_hostile_topology);
  g_test_add_func ("/cloth/topology/bad-values", test_bad_topology);
  g_test_add_func ("/cloth/mesh/bytes", test_mesh_bytes);
  g_test_add_func ("/cloth/mesh/round-trips", test_mesh_round_trips);
  g_test_add_func ("/cloth/mesh/zero-copy", test_mesh_zero_copy);
  g_test_add_func ("/cloth/mesh/states", test_mesh_settles_states);
  g_test_add_func ("/cloth/mesh/hostile", test_hostile_mesh);
  g_test_add_func ("/cloth/mesh/lengths", test_mesh_lengths);
  return g_test_run ();
}
