/* What cameras saw of a take, from its files: numbers by hand, and what can't be used.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <gst/cloth/cloth.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "gst/cloth-io/observations.h"
#include "gst/take/take.h"

#define CAMERA(name) "{\"name\":\"" name "\",\"size\":[100,80]," \
    "\"K\":[[90,0,50],[0,90,40],[0,0,1]],\"distortion\":{\"model\":\"none\"," \
    "\"coefficients\":[]},\"R\":[[1,0,0],[0,1,0],[0,0,1]],\"t\":[0,0,1]}"
#define RIG "{\"version\":1,\"cameras\":[" CAMERA ("left") "," CAMERA ("right") "]}"
/* The take's grid. */
#define COLUMNS 3
#define ROWS 2
#define FRAME (40 * GST_MSECOND)

typedef struct
{
  gchar *folder;
  GByteArray *bytes;            /* of the file to come */
} Fixture;

static gchar *
in_folder (const Fixture * f, const gchar * name)
{
  return g_build_filename (f->folder, name, NULL);
}

static void
write_file (const Fixture * f, const gchar * name, gconstpointer data,
    gssize size)
{
  g_autofree gchar *path = in_folder (f, name);
  g_autofree gchar *parent = g_path_get_dirname (path);
  GError *error = NULL;

  g_assert_cmpint (g_mkdir_with_parents (parent, 0777), ==, 0);
  g_file_set_contents (path, data, size, &error);
  g_assert_no_error (error);
}

static void
set_up (Fixture * f, gconstpointer data)
{
  GError *error = NULL;

  f->folder = g_dir_make_tmp ("clothtakeobservations-XXXXXX", &error);
  g_assert_no_error (error);
  f->bytes = g_byte_array_new ();
  write_file (f, "rig.json", RIG, -1);
}

static void
remove_tree (const gchar * path)
{
  GDir *dir = g_file_test (path, G_FILE_TEST_IS_SYMLINK) ? NULL :
      g_dir_open (path, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *inside = g_build_filename (path, name, NULL);

    remove_tree (inside);
  }
  if (dir)
    g_dir_close (dir);
  g_remove (path);
}

static void
tear_down (Fixture * f, gconstpointer data)
{
  remove_tree (f->folder);
  g_free (f->folder);
  g_byte_array_unref (f->bytes);
}

static GstBuffer *
new_picture (guint number)
{
  GstBuffer *picture = gst_buffer_new ();

  GST_BUFFER_PTS (picture) = number * FRAME;
  return picture;
}

/* Appends what clothmetapay would write of it. */
static void
append (Fixture * f, GstBuffer * picture)
{
  g_autoptr (GstBuffer) packed = gst_cloth_observations_pack (picture);
  GstMapInfo map;

  g_assert_true (gst_buffer_map (packed, &map, GST_MAP_READ));
  g_byte_array_append (f->bytes, map.data, (guint) map.size);
  gst_buffer_unmap (packed, &map);
  gst_buffer_unref (picture);
}

static void
end_file (Fixture * f, const gchar * camera)
{
  g_autofree gchar *name = g_strconcat ("observations/", camera, ".obs", NULL);

  write_file (f, name, f->bytes->data, f->bytes->len);
  g_byte_array_set_size (f->bytes, 0);
}

/* A square of 10 px with its top left corner at @x, @y. */
static GstClothQuad
new_quad (gint column, gint row, gfloat x, gfloat y, gfloat variance)
{
  GstClothQuad quad = {.column = column,.row = row,.confidence = 1,
    .x = {x, x + 10, x + 10, x},.y = {y, y, y + 10, y + 10}
  };

  for (guint c = 0; c < 4; c++)
    quad.cov_xx[c] = quad.cov_yy[c] = variance;
  return quad;
}

static GstBuffer *
see_quads (guint number, const gchar * camera, guint columns, guint rows,
    const GstClothQuad * quads, guint n)
{
  GstBuffer *picture = new_picture (number);

  gst_buffer_add_cloth_quads_meta (picture, gst_cloth_quads_new (camera, number,
          columns, rows, quads, n));
  return picture;
}

/* One square of the take's board: the four corners of it. */
static GstBuffer *
see_square (guint number)
{
  const GstClothQuad quad = new_quad (0, 0, 20, 30, 0.25f);

  return see_quads (number, "left", COLUMNS - 1, ROWS - 1, &quad, 1);
}

static GstBuffer *
see_dots (guint number, guint columns, guint rows, const GstClothDot * dots,
    guint n)
{
  GstBuffer *picture = new_picture (number);

  gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new ("left", number,
          columns, rows, 4, dots, n));
  return picture;
}

static GstBuffer *
see_silhouette (guint number, const gchar * camera, guint width, guint height)
{
  static const GstClothRun runs[] = { {3, 10, 20}, {3, 40, 41}, {79, 0, 100} };
  GstBuffer *picture = new_picture (number);
  GstClothSilhouette *silhouette = gst_cloth_silhouette_new (camera, number,
      width, height, runs, G_N_ELEMENTS (runs));

  g_assert_nonnull (silhouette);
  gst_buffer_add_cloth_silhouette_meta (picture, silhouette);
  return picture;
}

static gboolean
load (const Fixture * f, ClothObservations ** observations, GError ** error)
{
  g_autoptr (ClothTopology) grid = cloth_topology_new_grid (COLUMNS, ROWS, 0.2f,
      0.1f);

  return gst_cloth_io_observations_load (f->folder, NULL, grid, observations,
      error);
}

static ClothObservations *
load_well (const Fixture * f)
{
  GError *error = NULL;
  ClothObservations *observations;

  load (f, &observations, &error);
  g_assert_no_error (error);
  return observations;
}

/* ---- what is there ---- */

static void
test_none (Fixture * f, gconstpointer data)
{
  g_autofree gchar *rig = in_folder (f, "rig.json");

  g_assert_null (load_well (f));        /* rig.json alone */
  g_remove (rig);
  g_assert_null (load_well (f));
}

/* Two squares share two corners. Of the upper one they say 30 ± 1 and 31 ± √3, in both
 * directions: weighed alike as covariance intersection does, ½·1 + ½·⅓ = ⅔ of information,
 * variance 1.5 at 1.5·(½·30 + ⅙·31) = 30.25. Of the lower one they contradict each other. */
static void
test_squares (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothObservations) observations = NULL;
  GstClothQuad quads[2] = { new_quad (0, 0, 20, 30, 1), new_quad (1, 0, 31, 30,
        3)
  };
  static const guint32 vertices[] = { 0, 1, 2, 3, 5 };
  static const gdouble px[] = { 20, 30, 30.25, 30, 41, 30, 20, 40, 41, 40 };
  static const gdouble variances[] = { 1, 1.5, 3, 1, 3 };
  const ClothObservation *observation;

  quads[1].x[3] = 45;
  append (f, see_quads (1, "left", 2, 1, quads, 2));
  quads[0].state = GST_CLOTH_QUAD_LOST;
  quads[1].state = GST_CLOTH_QUAD_PREDICTED;
  append (f, see_quads (2, "", 2, 1, quads, 2));
  append (f, new_picture (3));
  end_file (f, "left");
  observations = load_well (f);
  g_assert_cmpuint (observations->n_vertices, ==, COLUMNS * ROWS);
  g_assert_cmpuint (observations->rig->n_cameras, ==, 2);
  g_assert_cmpuint (observations->list->len, ==, 3);
  observation = &g_array_index (observations->list, ClothObservation, 0);
  g_assert_cmpuint (observation->camera, ==, 0);
  g_assert_cmpfloat (observation->time_s, ==, 0.04);
  g_assert_cmpmem (observation->vertices, observation->n * sizeof *vertices,
      vertices, sizeof vertices);
  for (guint i = 0; i < observation->n; i++) {
    g_assert_cmpfloat_with_epsilon (observation->px[2 * i], px[2 * i], 1e-12);
    g_assert_cmpfloat_with_epsilon (observation->px[2 * i + 1], px[2 * i + 1],
        1e-12);
    g_assert_cmpfloat_with_epsilon (observation->covariances[3 * i],
        variances[i], 1e-12);
    g_assert_cmpfloat (observation->covariances[3 * i + 1], ==, 0);
    g_assert_cmpfloat_with_epsilon (observation->covariances[3 * i + 2],
        variances[i], 1e-12);
  }
  /* what is only guessed was not seen; nor was anything in a picture without metas */
  g_assert_cmpuint (g_array_index (observations->list, ClothObservation, 1).n,
      ==, 0);
  g_assert_cmpuint (g_array_index (observations->list, ClothObservation, 2).n,
      ==, 0);
}

/* A dot that runs into another and one without a label say nothing; those beside a fold,
 * which two neighbours are hidden by, neither. */
static void
test_dots (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothObservations) observations = NULL;
  GstClothDot dots[7] = { {0} };
  const ClothObservation *observation;

  for (guint i = 0; i < 6; i++) {
    dots[i].column = (gint) i % COLUMNS;
    dots[i].row = (gint) i / COLUMNS;
    dots[i].x = 10.f * i;
    dots[i].y = 5.5f;
    dots[i].cov_xx = 0.5f;
    dots[i].cov_xy = 0.125f;
    dots[i].cov_yy = 0.25f;
  }
  dots[6] = dots[0];
  dots[6].column = dots[6].row = -1;
  append (f, see_dots (0, COLUMNS, ROWS, dots, 7));
  dots[2].touches = TRUE;       /* 1 and 5 each miss one neighbour */
  append (f, see_dots (1, COLUMNS, ROWS, dots, 7));
  dots[4].touches = TRUE;       /* now they miss two; 0 and 3 one at most */
  append (f, see_dots (2, COLUMNS, ROWS, dots, 7));
  end_file (f, "left");
  observations = load_well (f);
  g_assert_cmpuint (observations->list->len, ==, 3);
  observation = &g_array_index (observations->list, ClothObservation, 0);
  g_assert_cmpuint (observation->n, ==, 6);
  g_assert_cmpfloat (observation->px[2 * 4], ==, 40);
  g_assert_cmpfloat (observation->px[2 * 4 + 1], ==, 5.5);
  g_assert_cmpfloat (observation->covariances[3 * 4], ==, 0.5);
  g_assert_cmpfloat (observation->covariances[3 * 4 + 1], ==, 0.125);
  g_assert_cmpfloat (observation->covariances[3 * 4 + 2], ==, 0.25);
  g_assert_cmpuint (g_array_index (observations->list, ClothObservation, 1).n,
      ==, 5);
  observation = &g_array_index (observations->list, ClothObservation, 2);
  g_assert_cmpuint (observation->n, ==, 2);
  g_assert_cmpuint (observation->vertices[0], ==, 0);
  g_assert_cmpuint (observation->vertices[1], ==, 3);
}

/* Points of a print's grid, whichever side of the cloth they are seen from; what is of no
 * vertex says nothing, and matches alone neither. */
static void
test_matches (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothObservations) observations = NULL;
  const GstClothMatch match = {.x = 50,.y = 40,.u = 0.1f,.v = 0.05f };
  const GstClothGridPoint points[] = {
    {2, 1, TRUE, 30, 5.5f, 0.5f, 0.125f, 0.25f},
    {0, 0, FALSE, 10, 8, 1, 0, 2}, {3, 0, FALSE, 1, 1, 1, 0, 1},
    {0, -1, FALSE, 1, 1, 1, 0, 1}
  };
  const ClothObservation *observation;

  for (guint k = 0; k < 2; k++) {
    GstBuffer *picture = new_picture (k);

    gst_buffer_add_cloth_matches_meta (picture, gst_cloth_matches_new ("left",
            k, COLUMNS, ROWS, 12, FALSE, &match, 1, points, k ? 0 : 4));
    append (f, picture);
  }
  end_file (f, "left");
  observations = load_well (f);
  g_assert_cmpuint (observations->list->len, ==, 2);
  observation = &g_array_index (observations->list, ClothObservation, 0);
  g_assert_cmpuint (observation->n, ==, 2);
  g_assert_cmpuint (observation->vertices[0], ==, 0);
  g_assert_cmpfloat (observation->px[0], ==, 10);
  g_assert_cmpfloat (observation->px[1], ==, 8);
  g_assert_cmpfloat (observation->covariances[2], ==, 2);
  g_assert_cmpuint (observation->vertices[1], ==, COLUMNS + 2);
  g_assert_cmpfloat (observation->px[2], ==, 30);
  g_assert_cmpfloat (observation->px[3], ==, 5.5);
  g_assert_cmpfloat (observation->covariances[3], ==, 0.5);
  g_assert_cmpfloat (observation->covariances[4], ==, 0.125);
  g_assert_cmpfloat (observation->covariances[5], ==, 0.25);
  g_assert_cmpuint (g_array_index (observations->list, ClothObservation, 1).n,
      ==, 0);
}

/* Squares of another board in the same pictures do no harm, nor what a later version
 * writes, nor files of the system. */
static void
test_others (Fixture * f, gconstpointer data)
{
  static const guint8 later[] = { 'G', 'C', 'O', 'B', 1, 0, 32, 0, 44, 0, 0,
    0, 1, 0, 0, 0, 0, 0xe1, 0xf5, 0x05, 0, 0, 0, 0, 255, 255, 255, 255, 255,
    255, 255, 255, 'L', 'A', 'T', 'E', 4, 0, 0, 0, 1, 2, 3, 4
  };
  g_autoptr (ClothObservations) observations = NULL;
  const GstClothQuad quad = new_quad (4, 4, 20, 30, 1);
  const GstClothDot dot = {.column = 2,.row = 1,.x = 7,.y = 8 };
  GstBuffer *picture = see_quads (0, "left", 8, 8, &quad, 1);

  gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new ("left", 0,
          COLUMNS, ROWS, 4, &dot, 1));
  append (f, picture);
  g_byte_array_append (f->bytes, later, sizeof later);
  end_file (f, "left");
  append (f, see_quads (5, "right", COLUMNS - 1, ROWS - 1, NULL, 0));
  end_file (f, "right");
  write_file (f, "observations/.hidden", "x", 1);
  observations = load_well (f);
  g_assert_cmpuint (observations->list->len, ==, 3);
  /* a dot alone has its neighbours hidden */
  g_assert_cmpuint (g_array_index (observations->list, ClothObservation, 0).n,
      ==, 0);
  g_assert_cmpfloat (g_array_index (observations->list, ClothObservation,
          1).time_s, ==, 0.1);
  g_assert_cmpuint (g_array_index (observations->list, ClothObservation,
          2).camera, ==, 1);
  g_assert_cmpfloat (g_array_index (observations->list, ClothObservation,
          2).time_s, ==, 0.2);
}

/* A camera that tells nothing but where the cloth ends, and one that does so now and then. */
static void
test_silhouettes (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothObservations) observations = NULL;
  const ClothObservation *o;

  append (f, see_silhouette (0, "left", 100, 80));
  end_file (f, "left");
  append (f, see_quads (0, "right", COLUMNS - 1, ROWS - 1, NULL, 0));
  append (f, see_silhouette (1, "right", 100, 80));
  end_file (f, "right");
  observations = load_well (f);
  g_assert_cmpuint (observations->list->len, ==, 3);
  o = (const ClothObservation *) (gpointer) observations->list->data;
  g_assert_true (o[0].has_silhouette);
  g_assert_cmpuint (o[0].n, ==, 0);
  g_assert_cmpuint (o[0].n_runs, ==, 3);
  g_assert_cmpuint (o[0].runs[1].row, ==, 3);
  g_assert_cmpuint (o[0].runs[1].begin, ==, 40);
  g_assert_cmpuint (o[0].runs[1].end, ==, 41);
  g_assert_cmpuint (o[0].runs[2].end, ==, 100);
  g_assert_false (o[1].has_silhouette);
  g_assert_true (o[2].has_silhouette);
  g_assert_true (cloth_observations_has_silhouettes (observations, 0));
  g_assert_true (cloth_observations_has_silhouettes (observations, 1));
}

/* ---- what can't be used ---- */

static void
refuse (const Fixture * f, const gchar * first, const gchar * second)
{
  g_autoptr (GError) error = NULL;
  ClothObservations *observations = (ClothObservations *) f;

  g_assert_false (load (f, &observations, &error));
  g_assert_null (observations);
  g_assert_nonnull (error);
  g_test_message ("%s", error->message);
  if (!strstr (error->message, first) || !strstr (error->message, second))
    g_error ("“%s” misses “%s” or “%s”", error->message, first,
        second);
}

static void
test_no_rig (Fixture * f, gconstpointer data)
{
  g_autofree gchar *rig = in_folder (f, "rig.json");

  append (f, see_square (0));
  end_file (f, "left");
  write_file (f, "rig.json", "{\"version\":1}", -1);
  refuse (f, "rig.json", "cameras");
  g_remove (rig);
  refuse (f, "no rig.json", "triangulate");
  g_assert_cmpint (symlink ("/dev/zero", rig), ==, 0);
  refuse (f, "rig.json", "out of");
}

/* Another rig in place of the take's, which may be missing: its order of cameras counts, and its pictures are those that
 * were filmed. */
static void
test_other_rig (Fixture * f, gconstpointer data)
{
  static const gchar *const small =
      "{\"version\":1,\"cameras\":[{\"name\":\"left\",\"size\":[90,80],"
      "\"K\":[[90,0,50],[0,90,40],[0,0,1]],\"distortion\":{\"model\":\"none\","
      "\"coefficients\":[]},\"R\":[[1,0,0],[0,1,0],[0,0,1]],\"t\":[0,0,1]}]}";
  g_autoptr (ClothTopology) grid = cloth_topology_new_grid (COLUMNS, ROWS, 0.2f,
      0.1f);
  g_autofree gchar *own = in_folder (f, "rig.json");
  g_autofree gchar *other = in_folder (f, "other.json");
  static const struct
  {
    gboolean has_own;
    const gchar *rig, *says;
  } cases[] = {
    {TRUE, "{\"version\":1,\"cameras\":[" CAMERA ("right") "," CAMERA ("left")
        "]}", NULL},
    {TRUE, small, "100 × 80"},
    {TRUE, "{\"version\":1,\"cameras\":[" CAMERA ("right") "]}",
        "left.obs” is of no camera"},
    {TRUE, NULL, "other.json"},
    {FALSE, "{\"version\":1,\"cameras\":[" CAMERA ("right") "," CAMERA ("left")
        "]}", NULL},
    {FALSE, NULL, "other.json"}
  };

  append (f, see_square (0));
  end_file (f, "left");
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (ClothObservations) observations = NULL;
    g_autoptr (GError) error = NULL;
    gboolean good;

    if (cases[i].rig)
      write_file (f, "other.json", cases[i].rig, -1);
    else
      g_remove (other);
    if (!cases[i].has_own)
      g_remove (own);
    good = gst_cloth_io_observations_load (f->folder, other, grid,
        &observations, &error);
    g_assert_true (good == !cases[i].says);
    if (good) {
      const ClothObservation *seen =
          &g_array_index (observations->list, ClothObservation, 0);

      g_assert_cmpstr (observations->rig->cameras[seen->camera].name, ==,
          "left");
      g_assert_cmpuint (seen->camera, ==, 1);
    } else if (!strstr (error->message, cases[i].says)) {
      g_error ("“%s” misses “%s”", error->message, cases[i].says);
    }
  }
}

static void
test_names (Fixture * f, gconstpointer data)
{
  g_autofree gchar *folder = in_folder (f, "observations");
  g_autofree gchar *left = in_folder (f, "observations/left.obs");

  g_assert_cmpint (g_mkdir (folder, 0777), ==, 0);
  refuse (f, "empty", "left.obs, right.obs");
  append (f, see_square (0));
  end_file (f, "left");
  write_file (f, "observations/middle.obs", "x", 1);
  refuse (f, "middle.obs", "left.obs, right.obs");
  remove_tree (folder);
  write_file (f, "observations", "x", 1);
  refuse (f, "observations", "");
  g_remove (folder);
  g_assert_cmpint (g_mkdir (folder, 0777), ==, 0);
  g_assert_cmpint (symlink ("/dev/zero", left), ==, 0);
  refuse (f, "left.obs", "out of");
  g_remove (left);
  g_assert_cmpint (g_mkdir (left, 0777), ==, 0);
  refuse (f, "left.obs", "regular");
}

static void
test_no_grid (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothTopology) mesh = cloth_topology_new_grid (COLUMNS, ROWS, 0.2f,
      0.1f);
  g_autoptr (GError) error = NULL;
  ClothObservations *observations;

  append (f, see_square (0));
  end_file (f, "left");
  for (guint i = 0; i < 3; i++) {
    mesh->columns = i == 1 ? COLUMNS : 0;
    mesh->rows = i == 2 ? ROWS : 0;
    g_assert_false (gst_cloth_io_observations_load (f->folder, NULL, mesh,
            &observations, &error));
    g_assert_nonnull (strstr (error->message, "grid"));
    g_clear_error (&error);
  }
}

/* The files that were read are files of the take; a camera without one has none. */
static void
test_of_take (Fixture * f, gconstpointer data)
{
  static const gfloat positions[3 * COLUMNS * ROWS] = { 0 };
  static const guint8 states[COLUMNS * ROWS] = { 1, 1, 1, 1, 1, 1 };
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("t");
  g_autoptr (ClothTopology) grid = cloth_topology_new_grid (COLUMNS, ROWS, 0.2f,
      0.1f);
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree gchar *bare = NULL;
  g_autoptr (GError) error = NULL;

  info->columns = COLUMNS;
  info->rows = ROWS;
  info->width_m = 0.2;
  info->height_m = 0.1;
  writer = cloth_take_writer_new (f->folder, info, grid, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_take_writer_append (writer, 0, positions, states, NULL,
          NULL, &error));
  g_assert_true (cloth_take_writer_close (writer, &error));
  for (guint i = 0; i < 3; i++) {
    g_autoptr (ClothTake) take = cloth_take_open (f->folder, &error);
    g_autoptr (ClothObservations) observations = NULL;
    g_autofree gchar *sha256 = NULL;

    g_assert_no_error (error);
    if (i == 1) {
      append (f, see_square (1));
      end_file (f, "left");
    } else if (i == 2) {
      write_file (f, "observations/left.obs", "x", 1);
      g_assert_false (gst_cloth_io_observations_load_take (take, NULL,
              &observations, &error));
      g_assert_null (observations);
      g_assert_nonnull (error);
      break;
    }
    g_assert_true (gst_cloth_io_observations_load_take (take, NULL,
            &observations, &error));
    g_assert_true ((observations != NULL) == (i == 1));
    sha256 = cloth_take_sha256 (take, &error);
    g_assert_no_error (error);
    if (i == 0)
      bare = g_steal_pointer (&sha256);
    else
      g_assert_cmpstr (sha256, !=, bare);
  }
}

/* A file that becomes shorter while it is read. */
static void
test_shrinking (Fixture * f, gconstpointer data)
{
  g_autofree gchar *path = in_folder (f, "observations/left.obs");
  g_autoptr (ClothObservations) observations = NULL;
  g_autoptr (ClothInput) input = NULL;
  g_autoptr (GError) error = NULL;

  append (f, see_square (1));
  append (f, see_square (2));
  end_file (f, "left");
  observations = load_well (f);
  input = cloth_input_open (path, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < 2; i++) {
    /* within the observation, then within its header */
    g_assert_cmpint (truncate (path, i ? 31 : 33), ==, 0);
    g_assert_false (gst_cloth_io_observations_read (observations, 1, COLUMNS,
            ROWS, input, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED);
    g_assert_true (g_str_has_prefix (error->message, "picture 0, at byte 0: "));
    g_clear_error (&error);
  }
}

/* A good picture, then one that is not. */
static void
refuse_second (Fixture * f, const gchar * what, const gchar * other)
{
  g_autofree gchar *where = NULL;
  g_autoptr (GByteArray) second = g_byte_array_new ();

  g_byte_array_append (second, f->bytes->data, f->bytes->len);
  g_byte_array_set_size (f->bytes, 0);
  append (f, see_square (1));
  where = g_strdup_printf ("observations/left.obs: picture 1, at byte %u: ",
      f->bytes->len);
  g_byte_array_append (f->bytes, second->data, second->len);
  end_file (f, "left");
  refuse (f, where, what);
  refuse (f, where, other);
}

static void
test_cut_off (Fixture * f, gconstpointer data)
{
  append (f, see_square (2));
  g_byte_array_set_size (f->bytes, f->bytes->len - 1);
  refuse_second (f, "cut off", "EOS");
  append (f, see_square (2));
  g_byte_array_set_size (f->bytes, 31);
  refuse_second (f, "cut off", "EOS");
  end_file (f, "left");
  refuse (f, "left.obs", "empty");
}

static void
put_size (Fixture * f, guint32 size)
{
  append (f, see_square (2));
  GST_WRITE_UINT32_LE (f->bytes->data + 8, size);
}

static void
test_sizes (Fixture * f, gconstpointer data)
{
  put_size (f, 0);
  refuse_second (f, "0 bytes is impossible", "32 to");
  put_size (f, 31);
  refuse_second (f, "31 bytes is impossible", "32 to");
  put_size (f, G_MAXUINT32);
  refuse_second (f, "4294967295 bytes is impossible", "32 to");
  put_size (f, 36);
  refuse_second (f, "section", "");
}

static void
test_garbage (Fixture * f, gconstpointer data)
{
  guint8 gdp[64] = { 1, 0, 0, 2 };

  g_byte_array_append (f->bytes, gdp, sizeof gdp);
  refuse_second (f, "no observation begins", "clothmetapay ! filesink");
  append (f, see_square (2));
  f->bytes->data[4] = 9;
  refuse_second (f, "version", "");
  append (f, see_square (2));
  f->bytes->data[f->bytes->len - 1] = 0xff;     /* a NaN */
  f->bytes->data[f->bytes->len - 2] = 0xff;
  refuse_second (f, "QUAD", "finite");
}

static void
test_times (Fixture * f, gconstpointer data)
{
  GstBuffer *picture = see_square (2);

  GST_BUFFER_PTS (picture) = GST_CLOCK_TIME_NONE;
  append (f, picture);
  refuse_second (f, "no time", "time stamps");
  append (f, see_square (1));
  refuse_second (f, "not later", "0.04 s");
  append (f, see_square (0));
  refuse_second (f, "not later", "0 s");
}

static void
test_other_pattern (Fixture * f, gconstpointer data)
{
  const GstClothQuad quad = new_quad (0, 0, 20, 30, 1);
  const GstClothDot dot = { 0 };
  GstBuffer *picture;

  append (f, see_quads (2, "left", 3, 2, &quad, 1));
  refuse_second (f, "4×3 vertices", "3×2");
  append (f, see_dots (2, 2, 1, &dot, 1));
  refuse_second (f, "2×1 vertices", "3×2");
  picture = new_picture (2);
  gst_buffer_add_cloth_matches_meta (picture, gst_cloth_matches_new ("left", 2,
          2, 3, 0, FALSE, NULL, 0, NULL, 0));
  append (f, picture);
  refuse_second (f, "2×3 vertices", "3×2");
}

static void
test_other_camera (Fixture * f, gconstpointer data)
{
  const GstClothQuad quad = new_quad (0, 0, 20, 30, 1);

  append (f, see_quads (2, "right", 2, 1, &quad, 1));
  refuse_second (f, "“right”, not of “left”", "camera");
}

static void
test_other_picture (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothObservations) observations = NULL;
  GstClothQuad quad = new_quad (0, 0, 99, 77, 1);

  append (f, see_quads (0, "left", 2, 1, &quad, 1));
  quad = new_quad (0, 0, -9, -7, 1);
  append (f, see_quads (1, "left", 2, 1, &quad, 1));
  end_file (f, "left");
  observations = load_well (f); /* less than a tenth outside */
  quad = new_quad (0, 0, 101, 30, 1);
  append (f, see_quads (2, "left", 2, 1, &quad, 1));
  refuse_second (f, "vertex 1 is at (111.0, 30.0)", "100×80");
  quad = new_quad (0, 0, 10, -8.5f, 1);
  append (f, see_quads (2, "left", 2, 1, &quad, 1));
  refuse_second (f, "vertex 0 is at (10.0, -8.5)", "calibrate");
}

static void
test_other_silhouette (Fixture * f, gconstpointer data)
{
  append (f, see_silhouette (2, "left", 200, 160));
  refuse_second (f, "200 × 160 pixels", "calibrated with 100 × 80");
  append (f, see_silhouette (2, "right", 100, 80));
  refuse_second (f, "“right”, not of “left”", "camera");
}

/* Runs that a program adds by itself. */
static void
test_runs (Fixture * f, gconstpointer data)
{
  static const ClothRun bad[][2] = {
    {{3, 5, 5}, {4, 0, 1}}, {{3, 9, 5}, {4, 0, 1}}, {{3, 0, 101}, {4, 0, 1}},
    {{3, 0, 1}, {80, 0, 1}}, {{3, 0, 5}, {3, 4, 9}}, {{3, 0, 5}, {2, 7, 9}}
  };
  g_autoptr (ClothObservations) observations = NULL;

  append (f, see_silhouette (0, "left", 100, 80));
  end_file (f, "left");
  observations = load_well (f);
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_false (cloth_observations_set_silhouette (observations, 2, bad[i],
            &error));
    g_assert_nonnull (strstr (error->message, "100 × 80 pixels"));
    /* what it was stays */
    g_assert_cmpuint (g_array_index (observations->list, ClothObservation,
            0).n_runs, ==, 3);
  }
}

static void
test_unlabelled (Fixture * f, gconstpointer data)
{
  const GstClothSaddle saddle = {.x = 4,.y = 5 };
  GstBuffer *picture = new_picture (0);

  gst_buffer_add_cloth_saddles_meta (picture, gst_cloth_saddles_new ("left", 0,
          &saddle, 1, NULL, 0));
  append (f, picture);
  append (f, new_picture (1));
  end_file (f, "left");
  refuse (f, "left.obs", "quadtrack");
}

/* More pictures than a camera may have, of which none shows anything. */
static void
test_too_many (Fixture * f, gconstpointer data)
{
  for (guint i = 0; i <= 100000; i++)
    append (f, new_picture (i));
  end_file (f, "left");
  refuse (f, "left.obs: picture 100000: too many", "into shorter ones");
}

int
main (int argc, char **argv)
{
  static const struct
  {
    const gchar *path;
    void (*test) (Fixture *, gconstpointer);
  } tests[] = {
    {"none", test_none}, {"squares", test_squares}, {"dots", test_dots},
    {"matches", test_matches}, {"silhouettes", test_silhouettes},
    {"other-silhouette", test_other_silhouette}, {"runs", test_runs},
    {"others", test_others}, {"no-rig", test_no_rig}, {"other-rig",
        test_other_rig},
    {"names", test_names}, {"no-grid", test_no_grid},
    {"of-take", test_of_take}, {"shrinking", test_shrinking},
    {"cut-off", test_cut_off}, {"sizes", test_sizes},
    {"garbage", test_garbage}, {"times", test_times},
    {"other-pattern", test_other_pattern},
    {"other-camera", test_other_camera},
    {"other-picture", test_other_picture}, {"unlabelled", test_unlabelled},
    {"too-many", test_too_many}
  };

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  for (guint i = 0; i < G_N_ELEMENTS (tests); i++) {
    g_autofree gchar *path =
        g_strconcat ("/clothtakeobservations/", tests[i].path, NULL);

    g_test_add (path, Fixture, NULL, set_up, tests[i].test, tear_down);
  }
  return g_test_run ();
}
