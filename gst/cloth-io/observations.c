/* What the cameras saw of a take: its rig and its files of observations.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "gst/cloth-io/observations.h"

#include <math.h>
#include <string.h>

#include "gst/cloth-io/points.h"
#include "gst/fit/error.h"
#include "gst/rig/rigfile.h"

#define FOLDER "observations"
#define ENDING ".obs"
/* Of a record; docs/streams.md has its fields. */
#define HEADER 32
#define SIZE_AT 8
#define TIME_AT 16
/* More than 65,536 features of each kind need. */
#define MAX_RECORD (16u << 20)
#define MAX_PICTURES 100000u
/* Of all pictures together: 3 GB of memory. */
#define MAX_POINTS (1u << 26)

typedef struct
{
  ClothObservations *observations;
  guint camera;
  gboolean labelled;            /* whether any picture had squares, dots, matches or a silhouette */
  GstClothIoPoints *points;
  guint32 *vertices;
  gdouble *px, *covariances;
  GArray *runs;                 /* of ClothRun */
} Reader;

static void
reader_init (Reader * self, ClothObservations * observations, guint camera,
    guint columns, guint rows)
{
  gsize n = (gsize) columns * rows;

  self->observations = observations;
  self->camera = camera;
  self->labelled = FALSE;
  self->points = gst_cloth_io_points_new (columns, rows);
  self->vertices = g_new (guint32, n);
  self->px = g_new (gdouble, 2 * n);
  self->covariances = g_new (gdouble, 3 * n);
  self->runs = g_array_new (FALSE, FALSE, sizeof (ClothRun));
}

static void
reader_clear (Reader * self)
{
  gst_cloth_io_points_free (self->points);
  g_free (self->vertices);
  g_free (self->px);
  g_free (self->covariances);
  g_array_unref (self->runs);
}

/* *INDENT-OFF* */
static gboolean fail (GError ** error, const gchar * format, ...)
    G_GNUC_PRINTF (2, 3);
/* *INDENT-ON* */

static gboolean
fail (GError ** error, const gchar * format, ...)
{
  va_list args;
  g_autofree gchar *text = NULL;

  va_start (args, format);
  text = g_strdup_vprintf (format, args);
  va_end (args);
  g_set_error_literal (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, text);
  return FALSE;
}

static gboolean
check_name (const Reader * self, const gchar * name, GError ** error)
{
  const gchar *own = self->observations->rig->cameras[self->camera].name;

  if (!*name || g_str_equal (name, own))
    return TRUE;
  return fail (error,
      "it is of camera “%s”, not of “%s”: name each file "
      "as the property camera of its detector", name, own);
}

/* Puts the points into the reader's arrays; returns how many, or -1. */
static gint
find_points (Reader * self, GstBuffer * buffer, GError ** error)
{
  if (!gst_cloth_io_points_has_any (buffer))
    return 0;                   /* of a picture that shows nothing */
  self->labelled = TRUE;
  if (!gst_cloth_io_points_find (self->points, buffer, error)
      || !check_name (self, self->points->camera, error)
      || !gst_cloth_io_points_check_places (self->points,
          &self->observations->rig->cameras[self->camera], error))
    return -1;
  return (gint) gst_cloth_io_points_list (&self->points->view,
      self->points->columns * self->points->rows, self->vertices, self->px,
      self->covariances);
}

/* Where the picture that was added last has the cloth. */
static gboolean
read_silhouette (Reader * self, GstBuffer * buffer, GError ** error)
{
  const GstClothSilhouette *silhouette =
      gst_buffer_get_cloth_silhouette (buffer);
  const ClothCamera *camera = &self->observations->rig->cameras[self->camera];
  const GstClothRun *runs;
  guint n, width, height;

  if (!silhouette)
    return TRUE;
  width = gst_cloth_silhouette_get_width (silhouette);
  height = gst_cloth_silhouette_get_height (silhouette);
  if (width != (guint) camera->width || height != (guint) camera->height)
    return fail (error,
        "its silhouette is of a picture of %u × %u pixels, but "
        "“%s” was calibrated with %d × %d: film with that size", width,
        height, camera->name, camera->width, camera->height);
  if (!check_name (self, gst_cloth_silhouette_get_camera (silhouette), error))
    return FALSE;
  runs = gst_cloth_silhouette_get_runs (silhouette, &n);
  g_array_set_size (self->runs, n);
  for (guint i = 0; i < n; i++)
    g_array_index (self->runs, ClothRun, i) = (ClothRun) {
    runs[i].row, runs[i].begin, runs[i].end};
  self->labelled = TRUE;
  return cloth_observations_set_silhouette (self->observations, n,
      (const ClothRun *) (gpointer) self->runs->data, error);
}

static gboolean
read_picture (Reader * self, const GByteArray * record, GError ** error)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new_memdup (record->data,
      record->len);
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  guint64 time = GST_READ_UINT64_LE (record->data + TIME_AT);
  gint n;

  if (!gst_cloth_observations_unpack (buffer, target, error))
    return FALSE;
  if (!GST_CLOCK_TIME_IS_VALID (time))
    return fail (error, "it has no time: film with time stamps, as a source "
        "with do-timestamp=true or a file has them");
  n = find_points (self, target, error);
  return n >= 0 && cloth_observations_add (self->observations, self->camera,
      (gdouble) time / GST_SECOND, (guint) n, self->vertices, self->px,
      self->covariances, error)
      && read_silhouette (self, target, error);
}

/* Reads the record at @at: its header tells its size. */
static gboolean
read_record (ClothInput * input, guint64 at, GByteArray * record,
    GError ** error)
{
  guint64 left = cloth_input_get_size (input) - at;
  guint32 size;

  if (left < HEADER)
    return fail (error, "the file ends inside a header: it was cut off; stop "
        "a recording with EOS (gst-launch-1.0 -e)");
  g_byte_array_set_size (record, HEADER);
  if (!cloth_input_read_at (input, at, record->data, HEADER, error))
    return FALSE;
  if (memcmp (record->data, "GCOB", 4) != 0)
    return fail (error, "no observation begins here: write the file by "
        "clothmetapay ! filesink, with nothing between them");
  size = GST_READ_UINT32_LE (record->data + SIZE_AT);
  if (size < HEADER || size > MAX_RECORD)
    return fail (error, "its size of %u bytes is impossible: %u to %u are "
        "allowed", size, HEADER, MAX_RECORD);
  if (size > left)
    return fail (error, "the file ends inside it: it was cut off; stop a "
        "recording with EOS (gst-launch-1.0 -e)");
  g_byte_array_set_size (record, size);
  return cloth_input_read_at (input, at, record->data, size, error);
}

static guint64
count_points (const ClothObservations * observations)
{
  guint64 n = 0;

  for (guint i = 0; i < observations->list->len; i++)
    n += g_array_index (observations->list, ClothObservation, i).n +
        g_array_index (observations->list, ClothObservation, i).n_runs;
  return n;
}

static gboolean
read_all (Reader * self, ClothInput * input, GError ** error)
{
  g_autoptr (GByteArray) record = g_byte_array_new ();
  guint64 at = 0, n_points = count_points (self->observations);
  const GArray *list = self->observations->list;

  for (guint n = 0; at < cloth_input_get_size (input); n++) {
    if (n == MAX_PICTURES || n_points > MAX_POINTS)
      return fail (error, "picture %u: too many; at most %u pictures a camera "
          "and %u points and runs in all are read: cut the take into shorter ones",
          n, MAX_PICTURES, MAX_POINTS);
    if (!read_record (input, at, record, error)
        || !read_picture (self, record, error)) {
      g_prefix_error (error, "picture %u, at byte %" G_GUINT64_FORMAT ": ", n,
          at);
      return FALSE;
    }
    n_points += g_array_index (list, ClothObservation, list->len - 1).n +
        g_array_index (list, ClothObservation, list->len - 1).n_runs;
    at += record->len;
  }
  if (at == 0)
    return fail (error, "it is empty: nothing was recorded");
  if (!self->labelled)
    return fail (error,
        "no picture has squares, dots, matches or a silhouette: put “saddledetect "
        "! quadtrack”, “dotlabel”, “siftmatch” or “silhouette” before clothmetapay, "
        "or leave the file out");
  return TRUE;
}

/* @observations: where the pictures go
 * @camera: whose they are: its index in the rig
 * @columns: vertices in a row of the cloth's grid, at least 2
 * @rows: vertices in a column of it, at least 2
 * @input: a row of observations, as docs/streams.md has them
 * @error: #ClothFitError, #GST_CLOTH_ERROR; it says which picture is wrong, and why
 *
 * Reads the pictures of one camera. The squares, dots or matches of each become one point a
 * vertex just as triangulate makes them. GStreamer must have been initialised.
 *
 * Returns: %FALSE when a picture can't be one of this take; those before it are in @observations
 */
gboolean
gst_cloth_io_observations_read (ClothObservations * observations, guint camera,
    guint columns, guint rows, ClothInput * input, GError ** error)
{
  Reader reader;
  gboolean good;

  reader_init (&reader, observations, camera, columns, rows);
  good = read_all (&reader, input, error);
  reader_clear (&reader);
  return good;
}

/* @output: a file of observations
 * @observation: one picture of them
 * @time: when, by the camera's clock
 * @error: #ClothFitError, #GIOErrorEnum
 *
 * Writes a picture, with its time, as clothmetapay ! filesink would.
 *
 * Returns: whether it is written
 */
gboolean
gst_cloth_io_observations_write (ClothOutput * output, GstBuffer * observation,
    GstClockTime time, GError ** error)
{
  const gsize size = gst_buffer_get_size (observation);
  g_autofree guint8 *bytes = g_malloc (size);

  if (size < HEADER || gst_buffer_extract (observation, 0, bytes, size) < size)
    return fail (error, "a picture of %" G_GSIZE_FORMAT " bytes is none", size);
  GST_WRITE_UINT64_LE (bytes + TIME_AT, time);
  return cloth_output_write (output, bytes, size, error);
}

/* The names that files may have. */
static gchar *
list_names (const ClothRig * rig)
{
  GString *text = g_string_new (NULL);

  for (guint i = 0; i < rig->n_cameras; i++)
    g_string_append_printf (text, "%s%s" ENDING, i ? ", " : "",
        rig->cameras[i].name);
  return g_string_free (text, FALSE);
}

static gboolean
is_of_camera (const gchar * name, const ClothRig * rig)
{
  for (guint i = 0; i < rig->n_cameras; i++) {
    g_autofree gchar *own = g_strconcat (rig->cameras[i].name, ENDING, NULL);

    if (g_str_equal (name, own))
      return TRUE;
  }
  return FALSE;
}

/* Hidden files are of the system; all others must be a camera's. */
static gboolean
check_files (const gchar * path, const ClothRig * rig, GError ** error)
{
  g_autoptr (GDir) dir = g_dir_open (path, 0, error);
  g_autofree gchar *names = list_names (rig);
  const gchar *name;
  guint n = 0;

  if (!dir)
    return FALSE;
  while ((name = g_dir_read_name (dir))) {
    g_autofree gchar *shown = g_filename_display_name (name);

    if (*name == '.')
      continue;
    if (!is_of_camera (name, rig))
      return fail (error,
          "“" FOLDER "/%s” is of no camera of the rig, whose "
          "files would be %s: rename it, or take it away", shown, names);
    n++;
  }
  return n > 0 || fail (error, "the folder " FOLDER " is empty: record %s into "
      "it by clothmetapay ! filesink, or take it away", names);
}

/* Below the take's folder. */
static gchar *
name_file (const ClothRig * rig, guint camera)
{
  return g_strconcat (FOLDER "/", rig->cameras[camera].name, ENDING, NULL);
}

static gboolean
load_files (ClothObservations * observations, const gchar * folder,
    const ClothTopology * topology, GError ** error)
{
  const ClothRig *rig = observations->rig;

  for (guint i = 0; i < rig->n_cameras; i++) {
    g_autofree gchar *name = name_file (rig, i);
    g_autofree gchar *whole = g_build_filename (folder, name, NULL);
    g_autofree gchar *path = NULL;
    g_autoptr (ClothInput) input = NULL;

    if (!g_file_test (whole, G_FILE_TEST_EXISTS))
      continue;
    if (!(path = cloth_path_inside (folder, name, error))
        || !(input = cloth_input_open (path, error)))
      return FALSE;
    if (!gst_cloth_io_observations_read (observations, i, topology->columns,
            topology->rows, input, error)) {
      g_prefix_error (error, "%s: ", name);
      return FALSE;
    }
  }
  return TRUE;
}

/* Pictures of another size than the take's own rig has them were not filmed with the rig that is given. */
static gboolean
check_sizes (const ClothRig * rig, const gchar * rig_file,
    const gchar * own_file, GError ** error)
{
  g_autoptr (ClothRig) own = cloth_rig_load (own_file, error);

  if (!own)
    return FALSE;
  for (guint i = 0; i < rig->n_cameras; i++) {
    const ClothCamera *now = &rig->cameras[i];
    const ClothCamera *before = cloth_rig_find (own, now->name);

    if (before && (now->width != before->width
            || now->height != before->height))
      return fail (error,
          "“%s” of “%s” has pictures of %d × %d pixels, the take's "
          "%d × %d: give the rig that the take was filmed with", now->name,
          rig_file, now->width, now->height, before->width, before->height);
  }
  return TRUE;
}

/* The rig of a take, or that in its place. */
static ClothRig *
load_rig (const gchar * folder, const gchar * rig_file, GError ** error)
{
  g_autofree gchar *own = g_build_filename (folder, "rig.json", NULL);
  g_autofree gchar *inside = NULL;
  g_autoptr (ClothRig) rig = NULL;

  if (g_file_test (own, G_FILE_TEST_EXISTS)) {
    if (!(inside = cloth_path_inside (folder, "rig.json", error)))
      return NULL;
  } else if (!rig_file) {
    fail (error, "there are " FOLDER " but no rig.json in “%s”: add the "
        "one that triangulate was given, or take them away", folder);
    return NULL;
  }
  rig = cloth_rig_load (rig_file ? rig_file : inside, error);
  if (!rig || (rig_file && inside
          && !check_sizes (rig, rig_file, inside, error)))
    return NULL;
  return g_steal_pointer (&rig);
}

/* @folder: of a take
 * @rig_file: (nullable): a rig in place of the take's rig.json
 * @topology: the take's mesh
 * @observations: (out) (transfer full) (nullable): what the cameras saw; %NULL when the take
 *   doesn't say
 * @error: #ClothFitError, #ClothRigError, #ClothFileError, #GST_CLOTH_ERROR, #GIOErrorEnum;
 *   it names the file, the picture and what to do
 *
 * Reads observations/<camera>.obs of the cameras of the rig, one picture after the other.
 * Not each camera must have a file. A rig without the folder observations says nothing; the
 * folder without a rig, without files or with files of other names is an error, and so is
 * the folder when the mesh is no grid, whose vertices are numbered row by row.
 *
 * Returns: %FALSE when something is there that can't be used
 */
gboolean
gst_cloth_io_observations_load (const gchar * folder, const gchar * rig_file,
    const ClothTopology * topology, ClothObservations ** observations,
    GError ** error)
{
  g_autofree gchar *path = g_build_filename (folder, FOLDER, NULL);
  g_autoptr (ClothObservations) made = NULL;
  ClothRig *rig;

  *observations = NULL;
  if (!g_file_test (path, G_FILE_TEST_EXISTS))
    return TRUE;
  if (topology->columns < 2 || topology->rows < 2)
    return fail (error,
        "observations name the vertices of a grid, but the mesh "
        "of “%s” is none: take the folder " FOLDER " away", folder);
  rig = load_rig (folder, rig_file, error);
  if (!rig)
    return FALSE;
  made = cloth_observations_new (rig, topology->n_vertices);
  if (!check_files (path, rig, error) || !gst_init_check (NULL, NULL, error)
      || !load_files (made, folder, topology, error))
    return FALSE;
  *observations = g_steal_pointer (&made);
  return TRUE;
}

/* @take: a take
 * @rig_file: (nullable): a rig in place of the take's rig.json
 * @observations: (out) (transfer full) (nullable): what the cameras saw
 * @error: as of gst_cloth_io_observations_load ()
 *
 * As gst_cloth_io_observations_load (); what was read of the take's folder counts as files of the take.
 *
 * Returns: %FALSE when something is there that can't be used
 */
gboolean
gst_cloth_io_observations_load_take (ClothTake * take, const gchar * rig_file,
    ClothObservations ** observations, GError ** error)
{
  const gchar *folder = cloth_take_get_folder (take);

  if (!gst_cloth_io_observations_load (folder, rig_file,
          cloth_take_get_topology (take), observations, error))
    return FALSE;
  if (!*observations)
    return TRUE;
  if (!rig_file)
    cloth_take_add_file (take, "rig.json");
  for (guint i = 0; i < (*observations)->rig->n_cameras; i++) {
    g_autofree gchar *name = name_file ((*observations)->rig, i);
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    if (g_file_test (path, G_FILE_TEST_EXISTS))
      cloth_take_add_file (take, name);
  }
  return TRUE;
}
