/* gst-cloth-fit-1.0 track: follows points of a printed cloth through films of several cameras.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/fit-track.h"

#include <gio/gio.h>
#include <gst/cloth/cloth.h>
#include <gst/gst.h>
#include <math.h>
#include <string.h>

#include "gst/file/jsonwriter.h"
#include "gst/file/output.h"
#include "gst/rig/rigfile.h"
#include "gst/vision/mask/mask.h"
#include "gst/vision/track/anneal.h"
#include "gst/vision/track/tracker.h"
#include "tools/fit-track-take.h"
#include "tools/frames.h"
#include "tools/tool.h"

/* Most columns and rows of a take's grid. */
#define MOST_LINES 1000

/* One camera's film. */
typedef struct
{
  const gchar *path;
  const ClothCamera *camera;
  ClothFrameReader *reader;
  gdouble first_s;              /* when its first picture was taken, by its own time */
  ClothCvSift *sift;
  ClothMask *mask;
  GArray *runs;                 /* its silhouette, of ClothRun */
  guint8 *silhouette;           /* of the first picture */
  GError *error;                /* of the features */
} Film;

typedef struct
{
  const FitTrack *arguments;
  ClothTrackerKind kind;
  ClothFlatParams flat;
  gdouble near[2];
  guint grid[2];
  GArray *held;                 /* of guint */
  ClothRig *rig;
  guint n;
  Film *films;
  ClothTrackerView *views;
  ClothPool *pool;
  ClothFlatPose pose;
  ClothTracker *tracker;
  FitTrackTake *take;           /* NULL: none is asked for */
  ClothJsonWriter *json;
  GString *csv;
  guint frame;
} Job;

static void
job_clear (Job * job)
{
  for (guint c = 0; c < job->n && job->films; c++) {
    cloth_frame_reader_free (job->films[c].reader);
    cloth_cv_sift_free (job->films[c].sift);
    cloth_mask_free (job->films[c].mask);
    g_free (job->films[c].silhouette);
    g_clear_pointer (&job->films[c].runs, g_array_unref);
    g_clear_error (&job->films[c].error);
  }
  g_free (job->films);
  g_free (job->views);
  cloth_tracker_free (job->tracker);
  fit_track_take_free (job->take);
  g_clear_pointer (&job->held, g_array_unref);
  g_clear_pointer (&job->rig, cloth_rig_free);
  cloth_pool_free (job->pool);
  g_clear_pointer (&job->json, cloth_json_writer_free);
  if (job->csv)
    g_string_free (job->csv, TRUE);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Job, job_clear);

/* ---- the command line ---- */

static gboolean
parse_sides (const gchar * text, gdouble size[2], GError ** error)
{
  g_auto (GStrv) parts = g_strsplit (text, ",", -1);

  if (g_strv_length (parts) != 2) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--pattern-size %s: give width and height of the cloth, for instance "
        "63cm,67cm", text);
    return FALSE;
  }
  return parse_length ("pattern-size", parts[0], &size[0], error)
      && parse_length ("pattern-size", parts[1], &size[1], error);
}

static gboolean
parse_place (const gchar * text, gdouble place[2], GError ** error)
{
  gchar *end;

  place[0] = g_ascii_strtod (text, &end);
  if (end != text && *end == ',') {
    text = end + 1;
    place[1] = g_ascii_strtod (text, &end);
    if (end != text && *end == 0 && isfinite (place[0] + place[1]))
      return TRUE;
  }
  g_set_error_literal (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
      "--near: give x and y of a place near to the print's top left corner, in "
      "metres, for instance -0.3,0.35");
  return FALSE;
}

/* Whole numbers with commas between them, below @limit. */
static gboolean
parse_list (const gchar * text, guint limit, GArray * list)
{
  gchar *end;

  do {
    const guint64 number = g_ascii_strtoull (text, &end, 10);
    const guint value = (guint) number;

    if (!g_ascii_isdigit (*text) || number >= limit)
      return FALSE;
    g_array_append_val (list, value);
    text = end + 1;
  } while (*end == ',');
  return *end == 0;
}

static gboolean
has_twice (const GArray * list)
{
  for (guint i = 0; i < list->len; i++)
    for (guint k = 0; k < i; k++)
      if (g_array_index (list, guint, i) == g_array_index (list, guint, k))
        return TRUE;
  return FALSE;
}

/* The grid of a take, and what is held in it. */
static gboolean
parse_grid (Job * job, GError ** error)
{
  const FitTrack *a = job->arguments;
  g_autoptr (GArray) grid = g_array_new (FALSE, FALSE, sizeof (guint));

  job->held = g_array_new (FALSE, FALSE, sizeof (guint));
  if (!a->grid && !a->held)
    return TRUE;
  if (!a->grid || !parse_list (a->grid, MOST_LINES + 1, grid)
      || grid->len != 2 || g_array_index (grid, guint, 0) < 2
      || g_array_index (grid, guint, 1) < 2) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--grid: give columns and rows of vertices, 2 to %u each, for instance "
        "33,35", MOST_LINES);
    return FALSE;
  }
  memcpy (job->grid, grid->data, sizeof job->grid);
  if (job->grid[0] * job->grid[1] > GST_CLOTH_MAX_FEATURES) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--grid %s: %u vertices are more than the %u that a picture may show",
        a->grid, job->grid[0] * job->grid[1], GST_CLOTH_MAX_FEATURES);
    return FALSE;
  }
  if (a->held && (!parse_list (a->held, job->grid[0] * job->grid[1],
              job->held) || has_twice (job->held))) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--held %s: give vertices, each once, row · %u + column, of the %u × %u, "
        "for instance 0,%u", a->held, job->grid[0], job->grid[0], job->grid[1],
        job->grid[0] - 1);
    return FALSE;
  }
  if (!cloth_tracker_kind_is_3d (job->kind)
      && job->kind != CLOTH_TRACKER_UVLESS)
    return TRUE;
  g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
      "--grid: the tracker “%s” does not say where on the cloth a feature is "
      "that a camera sees; lucas-kanade does", a->tracker);
  return FALSE;
}

static gboolean
parse (Job * job, GError ** error)
{
  const FitTrack *a = job->arguments;
  gdouble size[2];

  if (!cloth_tracker_kind_from_string (a->tracker, &job->kind)) {
    g_autoptr (GString) names = g_string_new (NULL);

    for (guint k = 0; k < CLOTH_TRACKER_N_KINDS; k++)
      g_string_append_printf (names, "%s%s", k ? ", " : "",
          cloth_tracker_kind_to_string ((ClothTrackerKind) k));
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--tracker %s: there is none of that name; give one of %s", a->tracker,
        names->str);
    return FALSE;
  }
  if (!parse_sides (a->size, size, error)
      || (a->near && !parse_place (a->near, job->near, error)))
    return FALSE;
  job->flat = cloth_flat_default_params (size[0], size[1]);
  job->flat.ground = a->ground;
  return parse_grid (job, error);
}

/* ---- pictures ---- */

static gboolean
check_size (const gchar * path, const ClothCamera * camera,
    const ClothImage * image, GError ** error)
{
  if (image->width == camera->width && image->height == camera->height)
    return TRUE;
  g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
      "%s has %d × %d pixels, camera “%s” of the rig %d × %d: films and "
      "backgrounds are given in the rig's order", path, image->width,
      image->height, camera->name, camera->width, camera->height);
  return FALSE;
}

static gboolean
open_films (Job * job, GError ** error)
{
  const FitTrack *a = job->arguments;
  const ClothCvSiftParams sift = cloth_cv_sift_default_params ();
  const guint n_films = g_strv_length (a->films);

  job->rig = cloth_rig_load (a->rig, error);
  if (!job->rig)
    return FALSE;
  if (n_films != job->rig->n_cameras
      || g_strv_length (a->backgrounds) != n_films) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
        "the rig has %u cameras, and %u films and %u backgrounds are given: each "
        "camera needs one of both, in the rig's order", job->rig->n_cameras,
        n_films, g_strv_length (a->backgrounds));
    return FALSE;
  }
  job->n = n_films;
  job->films = g_new0 (Film, n_films);
  job->views = g_new0 (ClothTrackerView, n_films);
  job->pool = cloth_pool_new ((guint) a->threads);
  for (guint c = 0; c < n_films; c++) {
    Film *film = &job->films[c];

    film->path = a->films[c];
    film->camera = &job->rig->cameras[c];
    film->mask = cloth_mask_new ();
    film->runs = g_array_new (FALSE, FALSE, sizeof (ClothRun));
    film->reader = cloth_frame_reader_open (film->path, error);
    if (!film->reader)
      return FALSE;
    film->sift = cloth_cv_sift_new (&sift, error);
    if (!film->sift)
      return FALSE;
  }
  return TRUE;
}

static void
describe (gpointer data, guint begin, guint end, guint worker)
{
  Job *job = data;

  for (guint c = begin; c < end; c++) {
    const ClothImage *image = &job->views[c].image;
    const ClothCvPicture picture =
        { image->data, image->width, image->height, image->stride };

    cloth_cv_sift_run (job->films[c].sift, &picture, NULL,
        &job->views[c].features, &job->films[c].error);
  }
}

/* Pictures of one number have to be of one time: films of another rate are not. */
static gboolean
check_times (Job * job, GError ** error)
{
  gdouble first = NAN;

  for (guint c = 0; c < job->n; c++) {
    Film *film = &job->films[c];
    const gdouble time = cloth_frame_reader_get_time (film->reader);

    if (job->frame == 0)
      film->first_s = time;
    if (c == 0)
      first = time - film->first_s;
    /* by more than half a frame; of films that say no times nothing is known */
    if (job->frame == 0 || !(fabs (time - film->first_s - first) > 0.5 * first /
            job->frame))
      continue;
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
        "picture %u of %s is %.3f s after its first, and of %s %.3f s: the films "
        "must run in step", job->frame, film->path, time - film->first_s,
        job->films[0].path, first);
    return FALSE;
  }
  return TRUE;
}

/* The next picture of each film, and its features. @more: whether there is one */
static gboolean
read_frame (Job * job, gboolean * more, GError ** error)
{
  guint ended = G_MAXUINT, goes_on = G_MAXUINT;

  for (guint c = 0; c < job->n; c++) {
    Film *film = &job->films[c];
    GError *wrong = NULL;

    if (cloth_frame_reader_next (film->reader, &job->views[c].image, &wrong)) {
      goes_on = c;
      if (!check_size (film->path, film->camera, &job->views[c].image, error))
        return FALSE;
    } else if (wrong) {
      g_propagate_error (error, wrong);
      return FALSE;
    } else
      ended = c;
  }
  *more = ended == G_MAXUINT;
  if (ended != G_MAXUINT && goes_on != G_MAXUINT)
    g_printerr ("%s ends after %u pictures and %s goes on: the rest of it is "
        "left out\n", job->films[ended].path, job->frame,
        job->films[goes_on].path);
  if (!*more)
    return TRUE;
  if (!check_times (job, error))
    return FALSE;
  cloth_pool_run_one_by_one (job->pool, describe, job, job->n);
  for (guint c = 0; c < job->n; c++)
    if (job->films[c].error) {
      g_propagate_error (error, g_steal_pointer (&job->films[c].error));
      return FALSE;
    }
  return TRUE;
}

/* ---- the start ---- */

static gboolean
take_background (const ClothImage * image, guint number, gpointer user_data,
    GError ** error)
{
  Film *film = user_data;
  const ClothPlanarImage view = {.luma = *image };

  if (check_size ("its background", film->camera, image, error))
    cloth_mask_set_background (film->mask, &view);
  return FALSE;
}

static gboolean
read_background (Job * job, guint c, GError ** error)
{
  GError *wrong = NULL;

  if (cloth_frames_read (job->arguments->backgrounds[c], 1, take_background,
          &job->films[c], &wrong) && !wrong)
    return TRUE;
  g_propagate_prefixed_error (error, wrong, "--background %s: ",
      job->arguments->backgrounds[c]);
  return FALSE;
}

static void
find_silhouette (Job * job, guint c)
{
  const ClothMaskParams params = cloth_mask_default_params ();
  const ClothPlanarImage view = {.luma = job->views[c].image };
  Film *film = &job->films[c];
  const ClothRun *runs;
  guint n_runs;

  cloth_mask_run (film->mask, &params, &view, job->pool, CLOTH_SIMD_BEST);
  runs = cloth_mask_get_runs (film->mask, &n_runs);
  g_array_set_size (film->runs, 0);
  if (n_runs)
    g_array_append_vals (film->runs, runs, n_runs);
}

/* As pixels. */
static void
draw_silhouette (Job * job, guint c)
{
  Film *film = &job->films[c];
  const gsize width = (gsize) film->camera->width;

  film->silhouette = g_malloc0 (width * (gsize) film->camera->height);
  for (guint i = 0; i < film->runs->len; i++) {
    const ClothRun *run = &g_array_index (film->runs, ClothRun, i);

    memset (film->silhouette + run->row * width + run->begin, 1,
        run->end - run->begin);
  }
}

static gboolean
find_pose (Job * job, GError ** error)
{
  const FitTrack *a = job->arguments;
  g_autofree ClothFlatView *views = g_new0 (ClothFlatView, job->n);
  const gdouble *near = a->near ? job->near : NULL;
  ClothAnnealParams annealing = cloth_anneal_default_params ();
  ClothFlatPoses poses;

  for (guint c = 0; c < job->n; c++) {
    if (!read_background (job, c, error))
      return FALSE;
    find_silhouette (job, c);
    draw_silhouette (job, c);
    views[c].camera = job->films[c].camera;
    views[c].mask = (ClothImage) {
    job->films[c].silhouette, views[c].camera->width,
          views[c].camera->height, views[c].camera->width};
  }
  annealing.seed = (guint64) a->seed;
  if (a->anneal ? !cloth_anneal_find (&annealing, &job->flat, job->n, views,
          near, &poses, error) : !cloth_flat_find (&job->flat, job->n, views,
          near, &poses, error))
    return FALSE;
  job->pose = poses.poses[0];
  g_print ("the cloth lies with its top left corner at %.4f, %.4f m, turned by "
      "%.1f°\n", job->pose.x, job->pose.y, job->pose.angle * 180. / G_PI);
  if (!near)
    g_print ("%u poses fit alike: --near says which corner is the print's top "
        "left\n", poses.n);
  return TRUE;
}

/* ---- what is written ---- */

static void
begin_report (Job * job)
{
  ClothJsonWriter *w = cloth_json_writer_new ();

  job->json = w;
  cloth_json_writer_begin_object (w, NULL);
  cloth_json_writer_count (w, "version", 1);
  cloth_json_writer_string (w, "tracker", job->arguments->tracker);
  cloth_json_writer_begin_array (w, "cameras");
  for (guint c = 0; c < job->n; c++)
    cloth_json_writer_string (w, NULL, job->films[c].camera->name);
  cloth_json_writer_end_array (w);
  cloth_json_writer_begin_object (w, "start");
  cloth_json_writer_number (w, "width_m", job->pose.size[0]);
  cloth_json_writer_number (w, "height_m", job->pose.size[1]);
  cloth_json_writer_number (w, "x_m", job->pose.x);
  cloth_json_writer_number (w, "y_m", job->pose.y);
  cloth_json_writer_number (w, "z_m", job->pose.ground);
  cloth_json_writer_number (w, "angle_rad", job->pose.angle);
  cloth_json_writer_end_object (w);
  cloth_json_writer_begin_array (w, "frames");
  if (cloth_tracker_kind_is_3d (job->kind))
    job->csv = g_string_new ("frame,marker,x_m,y_m,z_m,u_m,v_m,rays\n");
}

/* Of the first film: the clock of all. */
static gdouble
find_time (const Job * job)
{
  return cloth_frame_reader_get_time (job->films[0].reader);
}

static gboolean
begin_take (Job * job, GError ** error)
{
  const FitTrackTakeOptions options = { job->arguments->output, job->grid[0],
    job->grid[1], (const guint *) (gpointer) job->held->data, job->held->len
  };

  if (!fit_track_take_check (job->arguments->output, error))
    return FALSE;
  job->take = fit_track_take_new (&options, job->rig, &job->pose);
  return TRUE;
}

/* One number of each point: @at is where it is in the first. */
static void
add_list (ClothJsonWriter * w, const gchar * key, gconstpointer points,
    gsize size, gsize at, gboolean is_count, guint n)
{
  g_autofree gdouble *values = g_new (gdouble, MAX (n, 1));

  for (guint i = 0; i < n; i++) {
    const guint8 *from = (const guint8 *) points + i * size + at;

    values[i] = is_count ? (gdouble) * (const guint *) from :
        *(const gdouble *) from;
  }
  cloth_json_writer_numbers (w, key, values, n);
}

#define COUNT(type, key, field) \
  add_list (w, key, points, sizeof (type), G_STRUCT_OFFSET (type, field), TRUE, n)
#define NUMBER(type, key, field) \
  add_list (w, key, points, sizeof (type), G_STRUCT_OFFSET (type, field), FALSE, n)

static void
report_markers (Job * job)
{
  ClothJsonWriter *w = job->json;
  guint n;
  const ClothTrackedMarker *points =
      cloth_tracker_get_markers (job->tracker, &n);

  cloth_json_writer_count (w, "points", n);
  COUNT (ClothTrackedMarker, "id", id);
  NUMBER (ClothTrackedMarker, "u_m", uv[0]);
  NUMBER (ClothTrackedMarker, "v_m", uv[1]);
  NUMBER (ClothTrackedMarker, "x_m", position[0]);
  NUMBER (ClothTrackedMarker, "y_m", position[1]);
  NUMBER (ClothTrackedMarker, "z_m", position[2]);
  COUNT (ClothTrackedMarker, "rays", n_rays);
  for (guint i = 0; i < n; i++) {
    const gdouble values[5] = { points[i].position[0], points[i].position[1],
      points[i].position[2], points[i].uv[0], points[i].uv[1]
    };

    g_string_append_printf (job->csv, "%u,%u", job->frame, points[i].id);
    for (guint k = 0; k < 5; k++) {
      gchar text[G_ASCII_DTOSTR_BUF_SIZE];

      g_string_append_printf (job->csv, ",%s", g_ascii_formatd (text,
              sizeof text, "%.6f", values[k]));
    }
    g_string_append_printf (job->csv, ",%u\n", points[i].n_rays);
  }
}

static void
report_features (Job * job)
{
  ClothJsonWriter *w = job->json;
  guint n;
  const ClothTrackedFeature *points =
      cloth_tracker_get_features (job->tracker, &n);

  cloth_json_writer_count (w, "points", n);
  COUNT (ClothTrackedFeature, "camera", camera);
  COUNT (ClothTrackedFeature, "id", id);
  if (job->kind != CLOTH_TRACKER_UVLESS) {
    NUMBER (ClothTrackedFeature, "u_m", uv[0]);
    NUMBER (ClothTrackedFeature, "v_m", uv[1]);
  }
  NUMBER (ClothTrackedFeature, "x_px", px[0]);
  NUMBER (ClothTrackedFeature, "y_px", px[1]);
  NUMBER (ClothTrackedFeature, "before_x_px", before[0]);
  NUMBER (ClothTrackedFeature, "before_y_px", before[1]);
}

static gboolean
add_to_take (Job * job, GError ** error)
{
  g_autofree const GArray **silhouettes = g_new (const GArray *, job->n);
  guint n;
  const ClothTrackedFeature *features =
      cloth_tracker_get_features (job->tracker, &n);

  for (guint c = 0; c < job->n; c++) {
    if (job->frame)
      find_silhouette (job, c);
    silhouettes[c] = job->films[c].runs;
  }
  return fit_track_take_add (job->take, find_time (job), features, n,
      silhouettes, error);
}

static gboolean
report (Job * job, GError ** error)
{
  if (job->take && !add_to_take (job, error)) {
    g_prefix_error (error, "%s, picture %u: ", job->films[0].path, job->frame);
    return FALSE;
  }
  cloth_json_writer_begin_object (job->json, NULL);
  if (cloth_tracker_kind_is_3d (job->kind))
    report_markers (job);
  else
    report_features (job);
  cloth_json_writer_end_object (job->json);
  return TRUE;
}

static gboolean
write_all (Job * job, GError ** error)
{
  const gchar *folder = job->arguments->output;
  g_autofree gchar *path = g_build_filename (folder, "track.json", NULL);
  g_autofree gchar *table = g_build_filename (folder, "markers.csv", NULL);
  g_autofree gchar *text = NULL;

  cloth_json_writer_end_array (job->json);
  cloth_json_writer_end_object (job->json);
  text = cloth_json_writer_finish (job->json);
  return cloth_folder_make (folder, error)
      && (!job->csv || cloth_file_write_text (table, job->csv->str, error))
      && (!job->take || fit_track_take_write (job->take, error))
      && cloth_file_write_text (path, text, error);
}

/* Tracks to the end of the shortest film; says how many points there were. */
static gboolean
track (Job * job, GError ** error)
{
  const ClothTrackerParams params = cloth_tracker_default_params ();
  guint n[2], first;
  gboolean more;

  if (!read_frame (job, &more, error) || !find_pose (job, error))
    return FALSE;
  job->tracker = cloth_tracker_new (job->kind, &params, job->n,
      job->rig->cameras, error);
  if (!job->tracker || !cloth_tracker_start (job->tracker, &job->pose,
          job->views, error))
    return FALSE;
  begin_report (job);
  if (job->arguments->grid && !begin_take (job, error))
    return FALSE;
  if (!report (job, error))
    return FALSE;
  cloth_tracker_get_markers (job->tracker, &n[0]);
  cloth_tracker_get_features (job->tracker, &n[1]);
  first = n[0] + n[1];
  for (job->frame = 1;; job->frame++) {
    if (was_interrupted ()) {
      g_set_error_literal (error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
          "stopped; nothing was written");
      return FALSE;
    }
    if (!read_frame (job, &more, error))
      return FALSE;
    if (!more)
      break;
    if (!cloth_tracker_run (job->tracker, job->views, error))
      return FALSE;
    if (!report (job, error))
      return FALSE;
  }
  cloth_tracker_get_markers (job->tracker, &n[0]);
  cloth_tracker_get_features (job->tracker, &n[1]);
  g_print ("%u frames; %u points in the first, %u in the last\n", job->frame,
      first, n[0] + n[1]);
  return TRUE;
}

/* @arguments: the command line, with rig, tracker, size and output
 *
 * Returns: an exit code
 */
gint
fit_track (const FitTrack * arguments)
{
  g_auto (Job) job = {.arguments = arguments };
  g_autoptr (GError) error = NULL;

  if (!parse (&job, &error))
    return complain (BAD_USAGE, "%s", error->message);
  gst_init (NULL, NULL);
  catch_interrupts ();
  if (!open_films (&job, &error) || !track (&job, &error)
      || !write_all (&job, &error))
    return complain (FAILED, "%s", error->message);
  return DONE;
}
