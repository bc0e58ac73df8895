/* gst-cloth-calibrate-1.0: calibrates a rig from pictures or films of a board.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gio/gio.h>
#include <gst/gst.h>
#include <string.h>
#include <unistd.h>

#include "calibrate-page.h"
#include "calibrate-refine.h"
#include "calibrate-report.h"
#include "calibrate-shots.h"
#include "gst/cv/markers.h"
#include "gst/file/file.h"
#include "gst/math/vec3.h"
#include "gst/pattern/pattern.h"
#include "gst/rig/calibrate.h"
#include "gst/rig/cameramodel.h"
#include "gst/rig/rigfile.h"
#include "gst/rig/rigyaml.h"
#include "gst/rig/rotation.h"
#include "gst/rig/world.h"
#include "tools/tool.h"

/* Pictures that tell how squares were counted. */
#define N_PROBED 5

typedef struct
{
  gboolean share_lens, intrinsics_only, warp;
  gint columns, rows, every, max_views, leave_out;
  gchar *pattern, *charuco, *marker, *square, *first, *lens, *world, *size,
      *output, *report;
  gchar **opencv, *kalibr, **mrcal, *export_mrcal, *points;
  gchar **cameras;
} Arguments;

/* How large the markers are, and whether the dictionary has enough of them. */
static gboolean
add_markers (const Arguments * a, ClothShotBoard * board, GError ** error)
{
  g_autoptr (ClothCvMarkers) markers = cloth_cv_markers_new (a->charuco, error);
  guint needed = 0;
  gdouble edge;

  if (!markers)
    return FALSE;
  if (!a->marker) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--charuco: say how large the markers are, without the white around "
        "them: --marker, for instance 15mm");
    return FALSE;
  }
  if (!parse_length ("marker", a->marker, &edge, error))
    return FALSE;
  board->marker = edge / board->pattern->square_m;
  if (!(board->marker > 0 && board->marker < 1)) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--marker %s: markers lie inside of squares of %s", a->marker,
        a->square);
    return FALSE;
  }
  for (gint i = 0; i < a->columns * a->rows; i++)
    needed += !cloth_pattern_is_black (board->pattern, i % a->columns,
        i / a->columns);
  if (needed > cloth_cv_markers_get_size (markers)) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--charuco %s: it has %u markers, and %d × %d squares want %u",
        a->charuco, cloth_cv_markers_get_size (markers), a->columns, a->rows,
        needed);
    return FALSE;
  }
  board->dictionary = g_strdup (a->charuco);
  return TRUE;
}

static ClothShotBoard *
make_board (const Arguments * a, gint * code, GError ** error)
{
  g_autoptr (ClothShotBoard) board = g_new0 (ClothShotBoard, 1);
  gdouble square;
  gboolean described = a->columns || a->rows || a->square || a->charuco
      || a->marker;

  *code = BAD_USAGE;
  if (a->pattern && described) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "give --pattern, or --columns, --rows and --square, not both; a board with "
        "markers (--charuco) has no pattern.json");
    return NULL;
  }
  if (a->marker && !a->charuco && !a->pattern) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--marker: say of which dictionary: --charuco, for instance 5X5_100");
    return NULL;
  }
  if (a->pattern) {
    *code = FAILED;
    board->pattern = cloth_pattern_load (a->pattern, error);
    return board->pattern ? g_steal_pointer (&board) : NULL;
  }
  if (!a->columns || !a->rows || !a->square) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "say what board it is: --pattern pattern.json, or --columns, --rows and "
        "--square");
    return NULL;
  }
  if (!parse_length ("square", a->square, &square, error))
    return NULL;
  if (strcmp (a->first, "black") && strcmp (a->first, "white")) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "--first %s: give black or white", a->first);
    return NULL;
  }
  board->pattern = cloth_pattern_new_checker (a->columns, a->rows, square,
      square / 2, !strcmp (a->first, "black"), error);
  if (!board->pattern || (a->charuco && !add_markers (a, board, error)))
    return NULL;
  return g_steal_pointer (&board);
}

/* CAMERA=FILE arguments by camera, in the order of their first appearance. */
static GPtrArray *
sort_arguments (gchar ** arguments, gint * code, GError ** error)
{
  g_autoptr (GPtrArray) cameras =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_shot_camera_free);

  *code = BAD_USAGE;
  for (gchar ** argument = arguments; argument && *argument; argument++) {
    const gchar *equals = strchr (*argument, '=');
    g_autofree gchar *name = NULL;
    ClothShotCamera *camera = NULL;

    if (!equals || equals == *argument || !equals[1]) {
      g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
          "%s: give CAMERA=FILE, for instance left=left.mp4 or "
          "\"left=left*.jpg\"", *argument);
      return NULL;
    }
    name = g_strndup (*argument, (gsize) (equals - *argument));
    for (guint c = 0; c < cameras->len && !camera; c++) {
      ClothShotCamera *known = g_ptr_array_index (cameras, c);

      if (!strcmp (known->name, name))
        camera = known;
    }
    if (!camera) {
      camera = cloth_shot_camera_new (name);
      g_ptr_array_add (cameras, camera);
    }
    if (!cloth_shot_camera_add (camera, equals + 1, error)) {
      *code = FAILED;
      return NULL;
    }
  }
  if (cameras->len < 1 || cameras->len > CLOTH_RIG_MAX_CAMERAS) {
    g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
        "name 1 to %d cameras with their pictures: CAMERA=FILE",
        CLOTH_RIG_MAX_CAMERAS);
    return NULL;
  }
  return g_steal_pointer (&cameras);
}

static void
show_reading (const ClothShotCamera * camera, guint n_files, gpointer user_data)
{
  gboolean terminal = isatty (2);

  /* A line that rewrites itself, or now and then a line. */
  if (terminal || camera->n_pictures % 10 == 0
      || (!camera->film && n_files == camera->files->len))
    g_printerr ("%s%s: %u pictures, the board in %u%s", terminal ? "\r" : "",
        camera->name, camera->n_pictures, camera->shots->len,
        terminal && (camera->film || n_files < camera->files->len) ? "" : "\n");
}

static void
show_fit (const gchar * stage, gdouble fraction, gpointer user_data)
{
  if (isatty (2))
    g_printerr ("\r\033[Kcalibrating: %s %.0f%%", stage, 100 * fraction);
}

/* Turns after which a plain board looks the same: half a turn, or any quarter. */
static void
add_symmetries (const ClothShotBoard * board, GArray * symmetries)
{
  const ClothPattern *pattern = board->pattern;
  gboolean plain = !pattern->code && !board->dictionary;
  gint columns = pattern->columns, rows = pattern->rows;

  for (gint quarters = 1; quarters < 4 && plain; quarters++) {
    gboolean odd = quarters & 1;
    /* Onto which square the first one comes. */
    gint c = quarters == 3 ? 0 : columns - 1, r = quarters == 1 ? 0 : rows - 1;

    if ((odd && columns != rows)
        || cloth_pattern_is_black (pattern, c, r) != !!pattern->first_black)
      continue;
    for (gint i = 0; i < (columns + 1) * (rows + 1); i++) {
      gint x = i % (columns + 1), y = i / (columns + 1);
      gint u = quarters == 1 ? rows - y : quarters == 2 ? columns - x : y;
      gint v = quarters == 1 ? x : quarters == 2 ? rows - y : columns - x;
      guint to = (guint) (v * (columns + 1) + u);

      g_array_append_val (symmetries, to);
    }
  }
}

static void
add_board (const ClothPattern * pattern, GArray * board)
{
  for (gint i = 0; i < (pattern->columns + 1) * (pattern->rows + 1); i++) {
    gdouble X[3] = { i % (pattern->columns + 1) * pattern->square_m,
      i / (pattern->columns + 1) * pattern->square_m, 0
    };

    g_array_append_vals (board, X, 3);
  }
}

/* The input of a calibration, over the shots' own arrays. */
static void
fill_input (GPtrArray * cameras, const ClothShotBoard * seen, ClothLens lens,
    ClothCalibrateInput * in, GArray * views, GArray * numbers, ClothRig * rig,
    GArray * board, GArray * symmetries)
{
  add_board (seen->pattern, board);
  /* Numbers in order, each once, are the poses. */
  for (;;) {
    gint64 least = G_MAXINT64;

    for (guint c = 0; c < cameras->len; c++) {
      const ClothShotCamera *camera = g_ptr_array_index (cameras, c);

      for (guint i = 0; i < camera->shots->len; i++) {
        const ClothShot *shot = g_ptr_array_index (camera->shots, i);

        if (numbers->len == 0 || shot->number > g_array_index (numbers, gint64,
                numbers->len - 1))
          least = MIN (least, shot->number);
      }
    }
    if (least == G_MAXINT64)
      break;
    g_array_append_val (numbers, least);
  }
  for (guint c = 0; c < cameras->len; c++) {
    const ClothShotCamera *camera = g_ptr_array_index (cameras, c);
    guint pose = 0;

    rig->cameras[c].name = g_strdup (camera->name);
    rig->cameras[c].width = camera->width;
    rig->cameras[c].height = camera->height;
    rig->cameras[c].lens = lens;
    for (guint i = 0; i < camera->shots->len; i++) {
      const ClothShot *shot = g_ptr_array_index (camera->shots, i);
      ClothBundleView view = { c, 0, TRUE, shot->n, shot->vertex, shot->x,
        shot->y, shot->cov
      };

      while (g_array_index (numbers, gint64, pose) < shot->number)
        pose++;
      view.pose = pose;
      g_array_append_val (views, view);
    }
  }
  in->n_cameras = rig->n_cameras;
  in->cameras = rig->cameras;
  in->n_vertices = board->len / 3;
  in->board = (const gdouble *) board->data;
  in->n_poses = numbers->len;
  in->n_views = views->len;
  in->views = (const ClothBundleView *) views->data;
  add_symmetries (seen, symmetries);
  in->n_symmetries = symmetries->len / in->n_vertices;
  in->symmetries = (const guint *) symmetries->data;
}

static gboolean
write_models (const Arguments * a, const ClothRig * rig, GError ** error)
{
  return !a->export_mrcal
      || cloth_rig_export_mrcal (rig, a->export_mrcal, error);
}

/* Where --points say the world is; says how well they fit. */
static gboolean
world_of_points (const Arguments * a, const ClothRig * rig, ClothWorld * world,
    GError ** error)
{
  gsize length;
  g_autofree gchar *text = cloth_text_file_load (a->points, &length, error);
  g_autoptr (GArray) points = NULL;
  gdouble rms, scale;

  if (!text)
    return FALSE;
  points = cloth_world_points_parse (rig, text, length, error);
  if (!points || !cloth_world_of_points (rig, points->len,
          (const ClothWorldPoint *) points->data, world, &rms, &scale, error)) {
    g_prefix_error (error, "%s: ", a->points);
    return FALSE;
  }
  g_print ("points: %.1f mm from where they are said to be (RMS), %.4f times "
      "as large\n", 1e3 * rms, scale);
  return TRUE;
}

static gboolean
move_calibration (const Arguments * a, ClothCalibration * result,
    GError ** error)
{
  ClothWorld world;

  if (strcmp (a->world, "points"))
    return TRUE;
  if (!world_of_points (a, result->rig, &world, error))
    return FALSE;
  cloth_world_move_rig (&world, result->rig);
  for (guint p = 0; p < result->n_poses; p++)
    cloth_world_move_pose (&world, result->poses + 12 * (gsize) p);
  return TRUE;
}

/* A page for each rig of a folder: calibration.html for rig.json, NAME-calibration.html for others. */
static gchar *
page_beside (const gchar * rig)
{
  g_autofree gchar *folder = g_path_get_dirname (rig);
  g_autofree gchar *name = g_path_get_basename (rig);
  g_autofree gchar *page = NULL;

  if (g_str_has_suffix (name, ".json"))
    name[strlen (name) - strlen (".json")] = 0;
  page = g_str_equal (name, "rig") ? g_strdup ("calibration.html")
      : g_strconcat (name, "-calibration.html", NULL);
  return g_build_filename (folder, page, NULL);
}

static gint
calibrate (const Arguments * a, GPtrArray * cameras,
    const ClothShotBoard * seen, ClothLens lens)
{
  const ClothPattern *pattern = seen->pattern;
  g_autoptr (GArray) views = g_array_new (FALSE, FALSE,
      sizeof (ClothBundleView));
  g_autoptr (GArray) numbers = g_array_new (FALSE, FALSE, sizeof (gint64));
  g_autoptr (GArray) board = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autoptr (GArray) symmetries = g_array_new (FALSE, FALSE, sizeof (guint));
  g_autoptr (ClothRig) rig = cloth_rig_new (cameras->len);
  g_autoptr (ClothCalibration) result = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *report = NULL, *page = NULL;
  ClothCalibrateInput in;
  ClothCalibrateParams params;

  fill_input (cameras, seen, lens, &in, views, numbers, rig, board, symmetries);
  cloth_calibrate_params_init (&params);
  params.share_lens = a->share_lens;
  params.warp = a->warp;
  params.intrinsics_only = a->intrinsics_only;
  params.leave_out = (guint) a->leave_out;
  params.world = !strcmp (a->world, "board") ? CLOTH_CALIBRATE_WORLD_BOARD
      : CLOTH_CALIBRATE_WORLD_CAMERA;
  result = cloth_calibrate (&in, &params, show_fit, NULL, NULL, &error);
  if (isatty (2))
    g_printerr ("\r\033[K");
  page = a->report ? g_strdup (a->report) : page_beside (a->output);
  if (!result || !move_calibration (a, result, &error)
      || !cloth_rig_check (result->rig, &error)
      || !write_models (a, result->rig, &error)
      || !cloth_calibrate_page_write (&in, result, pattern, cameras,
          page, &error) || !cloth_rig_save (result->rig, a->output, &error))
    return complain (FAILED, "%s", error->message);
  report = cloth_calibrate_report (&in, result, cameras);
  g_print ("board: %d × %d squares of %g mm\n%s\nwrote %s and %s\n",
      pattern->columns, pattern->rows, 1e3 * pattern->square_m, report,
      a->output, page);
  return DONE;
}

/* The share of a camera's first pictures that show this board. */
static gdouble
find_share (const ClothShotCamera * camera, const ClothShotBoard * board,
    guint every)
{
  g_autoptr (GPtrArray) one =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_shot_camera_free);
  ClothShotCamera *probe = cloth_shot_camera_new (camera->name);

  g_ptr_array_add (one, probe);
  probe->most_pictures = N_PROBED;
  for (guint i = 0; i < MIN (camera->files->len, N_PROBED); i++)
    cloth_shot_camera_add (probe, g_ptr_array_index (camera->files, i), NULL);
  cloth_shot_cameras_number (one);
  if (!cloth_shot_camera_read (probe, board, every, NULL, NULL, NULL))
    return 0;
  return (gdouble) probe->shots->len / MAX (1, probe->n_pictures);
}

/* What to give in place of what few of a camera's pictures show, or none: a board with so many corners
 * inside as it was said to have squares, as other programs count; or one with its markers in the
 * squares that were said to be black. */
static gchar *
find_remedy (const ClothShotCamera * camera, const ClothShotBoard * board,
    guint every)
{
  const ClothPattern *pattern = board->pattern;
  gboolean black = !!pattern->first_black;
  gint more = board->dictionary ? 0 : 1;
  gdouble share = (gdouble) camera->shots->len / MAX (1, camera->n_pictures);
  ClothShotBoard other = *board;
  gchar *remedy = NULL;

  if (share > 0.5 || (share > 0 && !board->dictionary))
    return NULL;
  other.pattern = cloth_pattern_new_checker (pattern->columns + more,
      pattern->rows + more, pattern->square_m, pattern->square_m / 2,
      board->dictionary ? !black : black, NULL);
  if (other.pattern && find_share (camera, &other, every) > share)
    remedy = board->dictionary ? g_strdup_printf ("its markers are in the "
        "squares said to be black: --first %s", black ? "white" : "black")
        : g_strdup_printf ("its board has %d × %d corners inside, and so "
        "%d × %d squares, which is what to give: --columns %d --rows %d",
        pattern->columns, pattern->rows, pattern->columns + 1,
        pattern->rows + 1, pattern->columns + 1, pattern->rows + 1);
  g_clear_pointer (&other.pattern, cloth_pattern_free);
  return remedy;
}

/* What is wrong with a board of markers that no picture shows. */
static gchar *
find_reason (const ClothShotCamera * camera, const ClothShotBoard * board)
{
  if (camera->n_marked == 0)
    return
        g_strdup_printf ("no picture has a marker of %s: see that this is the "
        "board's dictionary, and that the pictures are not mirrored",
        board->dictionary);
  if (camera->n_contradicted > 0)
    return
        g_strdup_printf
        ("its markers are not where a board of %d × %d squares "
        "has them, each %.3g of a square: see --columns and --rows, which count "
        "squares, --marker, --square and --first", board->pattern->columns,
        board->pattern->rows, board->marker);
  return
      g_strdup_printf ("markers are seen in %u pictures, but no corners where "
      "markers of %.3g of a square have theirs: see --marker and --square",
      camera->n_marked, board->marker);
}

static gint
import (const Arguments * a)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = NULL;
  gint width = 0, height = 0;

  if (!!a->opencv + !!a->kalibr + !!a->mrcal > 1 || a->cameras)
    return complain (BAD_USAGE, "--import-opencv, --import-kalibr and "
        "--import-mrcal stand alone, without each other and without pictures");
  if (a->size && !parse_size (a->size, &width, &height))
    return complain (BAD_USAGE, "--size: give WIDTHxHEIGHT, for instance "
        "640x480");
  rig = a->opencv ? cloth_rig_import_opencv ((const gchar * const *) a->opencv,
      width, height, &error)
      : a->mrcal ? cloth_rig_import_mrcal ((const gchar * const *) a->mrcal,
      &error) : cloth_rig_import_kalibr (a->kalibr, &error);
  if (!rig && width == 0 && strstr (error->message, "no picture size"))
    g_prefix_error (&error, "give --size: ");
  if (!rig || !write_models (a, rig, &error)
      || !cloth_rig_save (rig, a->output, &error))
    return complain (FAILED, "%s", error->message);
  for (guint c = 0; c < rig->n_cameras; c++)
    g_print ("camera %s: %d×%d, %s lens\n", rig->cameras[c].name,
        rig->cameras[c].width, rig->cameras[c].height,
        cloth_lens_to_string (rig->cameras[c].lens));
  g_print ("wrote %s\n", a->output);
  return DONE;
}

/* The board where the first picture shows it, or several cameras at the same moment. */
static gboolean
world_of_board (const Arguments * a, const ClothRig * rig, ClothWorld * world,
    gint * code, GError ** error)
{
  g_autoptr (ClothShotBoard) shown = make_board (a, code, error);
  g_autoptr (GPtrArray) cameras = NULL;
  g_autoptr (GArray) views =
      g_array_new (FALSE, TRUE, sizeof (ClothBundleView));
  g_autoptr (GArray) board = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autoptr (GArray) symmetries = g_array_new (FALSE, FALSE, sizeof (guint));
  gint64 number = 0;

  if (!shown || !(cameras = sort_arguments (a->cameras + 2, code, error)))
    return FALSE;
  *code = FAILED;
  add_symmetries (shown, symmetries);
  add_board (shown->pattern, board);
  cloth_shot_cameras_number (cameras);
  for (guint c = 0; c < cameras->len; c++) {
    ClothShotCamera *camera = g_ptr_array_index (cameras, c);
    const ClothCamera *known = cloth_rig_find (rig, camera->name);

    if (!known)
      return cloth_rig_invalid (error, a->cameras[1], "",
          "has no camera \"%s\"", camera->name);
    if (!cloth_shot_camera_read (camera, shown, (guint) a->every,
            show_reading, NULL, error))
      return FALSE;
    if (camera->width != known->width || camera->height != known->height)
      return cloth_rig_invalid (error, camera->name, "", "its pictures have "
          "%d×%d pixels, not %d×%d", camera->width, camera->height,
          known->width, known->height);
    for (guint i = 0; i < camera->shots->len; i++) {
      const ClothShot *shot = g_ptr_array_index (camera->shots, i);
      ClothBundleView view = { (guint) (known - rig->cameras), 0, TRUE, shot->n,
        shot->vertex, shot->x, shot->y, shot->cov
      };

      if (views->len == 0)
        number = shot->number;
      /* A board that looks the same turned may be numbered from another end. */
      if (shot->number != number || (views->len > 0 && symmetries->len > 0))
        continue;
      g_array_append_val (views, view);
      g_print ("board: seen in %s of camera %s\n", shot->label, camera->name);
      break;
    }
  }
  if (views->len == 0)
    return cloth_rig_invalid (error, "", "board",
        "it was found in none of the pictures");
  return cloth_world_of_board (rig, views->len,
      (const ClothBundleView *) views->data, (const gdouble *) board->data,
      world, error);
}

/* upright RIG: a finished rig in another world. */
static gint
upright (const Arguments * a)
{
  guint n = g_strv_length (a->cameras);
  gboolean board = !strcmp (a->world, "board");
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = NULL;
  const ClothCamera *first;
  ClothWorld world;
  gdouble turn[3];
  gint code = FAILED;

  if (n < 2 || (board ? n < 3 : n > 2))
    return complain (BAD_USAGE, board ? "give the rig, and pictures of the "
        "board that lies level: upright RIG CAMERA=FILE…"
        : "give the rig to turn, alone: upright RIG; pictures are of "
        "--world board");
  rig = cloth_rig_load (a->cameras[1], &error);
  if (!rig)
    return complain (FAILED, "%s", error->message);
  first = &rig->cameras[0];
  if (board ? !world_of_board (a, rig, &world, &code, &error)
      : !strcmp (a->world, "points")
      && !world_of_points (a, rig, &world, &error))
    return complain (code, "%s", error->message);
  if (!strcmp (a->world, "camera"))
    cloth_world_of_camera (first, &world);
  cloth_world_move_rig (&world, rig);
  if (!write_models (a, rig, &error) || !cloth_rig_save (rig, a->output,
          &error))
    return complain (FAILED, "%s", error->message);
  cloth_rotation_to_vector (world.R, turn);
  g_print ("the world was turned by %.2f°; up is now %s\nwrote %s\n",
      cloth_vec3_length (turn) * 180 / G_PI, board ? "off the board"
      : !strcmp (a->world, "points") ? "where the points have it"
      : "up in the first camera's picture", a->output);
  return DONE;
}

/* What to do with the world, or why not. */
static gboolean
check_world (const Arguments * a, gboolean finished)
{
  gboolean points = !strcmp (a->world, "points");

  if (!points && strcmp (a->world, "camera") && strcmp (a->world, "board"))
    complain (BAD_USAGE, "--world: give camera, board or points");
  else if (points != (a->points != NULL))
    complain (BAD_USAGE, "--world points and --points FILE go together");
  else if (points && a->intrinsics_only)
    complain (BAD_USAGE, "--world points: cameras that are not placed, with "
        "--intrinsics-only, have no world");
  else if (finished && a->report)
    complain (BAD_USAGE, "--report: a finished rig has nothing to report");
  else
    return TRUE;
  return FALSE;
}

static gint
run (gconstpointer data)
{
  const Arguments *a = data;
  g_autoptr (ClothShotBoard) board = NULL;
  g_autoptr (GPtrArray) cameras = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = NULL;
  gboolean finished = a->cameras && a->cameras[0]
      && !strcmp (a->cameras[0], "upright");
  gboolean named;
  ClothLens lens;
  gint code;

  gst_init (NULL, NULL);
  if (!a->output)
    return complain (BAD_USAGE, "name the file to write: --output rig.json");
  if (a->opencv || a->kalibr || a->mrcal)
    return import (a);
  if (!cloth_lens_from_string (a->lens, &lens))
    return complain (BAD_USAGE, "--lens: give none, brown5, brown8 or fisheye");
  if (!check_world (a, finished))
    return BAD_USAGE;
  if (finished)
    return upright (a);
  if (a->cameras && a->cameras[0] && !strcmp (a->cameras[0], "refine"))
    return g_strv_length (a->cameras) == 3 ?
        calibrate_refine (a->cameras[1], a->cameras[2], a->output) :
        complain (BAD_USAGE, "give the rig, and the folder of a take that has "
        "observations: refine RIG TAKE");
  if (a->every < 1 || a->max_views < 3 || a->leave_out < 0 || a->leave_out == 1)
    return complain (BAD_USAGE, "--every takes 1 or more, --max-views 3 or "
        "more, --leave-out 0 or 2 or more");
  board = make_board (a, &code, &error);
  if (!board)
    return complain (code, "%s", error->message);
  named = a->cameras && a->cameras[0] && !strcmp (a->cameras[0], "calibrate");
  cameras = sort_arguments (a->cameras + named, &code, &error);
  if (!cameras)
    return complain (code, "%s", error->message);
  /* Better now than after an hour of reading. */
  folder = g_path_get_dirname (a->output);
  if (access (folder, W_OK) != 0)
    return complain (FAILED, "--output: its folder does not exist or can't be "
        "written to");

  cloth_shot_cameras_number (cameras);
  for (guint c = 0; c < cameras->len; c++) {
    ClothShotCamera *camera = g_ptr_array_index (cameras, c);

    g_autofree gchar *remedy = NULL;

    if (!cloth_shot_camera_read (camera, board, (guint) a->every,
            show_reading, NULL, &error)) {
      if (isatty (2))
        g_printerr ("\n");
      return complain (FAILED, "%s", error->message);
    }
    if (isatty (2) && camera->film)
      g_printerr ("\n");
    if (a->columns)
      remedy = find_remedy (camera, board, (guint) a->every);
    if (!remedy && board->dictionary && camera->shots->len == 0)
      remedy = find_reason (camera, board);
    if (remedy)
      return complain (FAILED, "camera %s: %s", camera->name, remedy);
  }
  cloth_shot_cameras_choose (cameras, (guint) a->max_views);
  return calibrate (a, cameras, board, lens);
}

static const ToolCommand commands[] = {
  {"calibrate", "CAMERA=FILE…",
        "Calibrates cameras from pictures or films of a board. The word may be left "
        "out. Cameras of\nother programs are taken over by --import-opencv, "
        "--import-kalibr and --import-mrcal, without\npictures.",
      "gst-cloth-calibrate-1.0 calibrate --pattern board/pattern.json "
        "--output rig.json \\\n    left=left.mp4 right=right.mp4"},
  {"upright", "RIG [CAMERA=FILE…]",
        "Moves the world of a finished rig: z up in the first camera's picture, off "
        "a board that lies\nlevel (--world board, with pictures of it), or as points "
        "have it whose places are known.",
      "gst-cloth-calibrate-1.0 upright rig.json --world board "
        "--pattern board/pattern.json \\\n    --output upright.json left=floor.jpg"},
  {"refine", "RIG TAKE",
        "Corrects the cameras of a rig, their directions, places, focal lengths and "
        "clocks, by what they\nsaw of a cloth: a take with observations.",
      "gst-cloth-calibrate-1.0 refine rig.json cloth.take --output refined.json"},
  {NULL}
};

int
main (int argc, char **argv)
{
  Arguments a = {.every = 10,.max_views = 60,.leave_out = 5 };
  const GOptionEntry entries[] = {
    {"pattern", 'p', 0, G_OPTION_ARG_FILENAME, &a.pattern,
        "calibrate, upright: The board's pattern.json", "FILE"},
    {"columns", 0, 0, G_OPTION_ARG_INT, &a.columns,
        "calibrate, upright: Without it: squares in a row", "N"},
    {"rows", 0, 0, G_OPTION_ARG_INT, &a.rows,
        "calibrate, upright: Squares in a column", "N"},
    {"square", 0, 0, G_OPTION_ARG_STRING, &a.square,
          "calibrate, upright: Edge of a square, measured, for instance 25mm",
        "LENGTH"},
    {"charuco", 0, 0, G_OPTION_ARG_STRING, &a.charuco,
        "calibrate, upright: The white squares have markers of this dictionary, for instance "
          "5X5_100", "DICTIONARY"},
    {"marker", 0, 0, G_OPTION_ARG_STRING, &a.marker,
        "calibrate, upright: Edge of such a marker, measured", "LENGTH"},
    {"first", 0, 0, G_OPTION_ARG_STRING, &a.first,
          "calibrate, upright: Colour of the top-left square (black)",
        "black|white"},
    {"lens", 0, 0, G_OPTION_ARG_STRING, &a.lens,
        "calibrate: none, brown5, brown8 or fisheye (brown5)", "MODEL"},
    {"share-lens", 0, 0, G_OPTION_ARG_NONE, &a.share_lens,
        "calibrate: All cameras have the same distortion", NULL},
    {"intrinsics-only", 0, 0, G_OPTION_ARG_NONE, &a.intrinsics_only,
          "calibrate: The cameras' pictures were not taken at the same moments",
        NULL},
    {"warp", 0, 0, G_OPTION_ARG_NONE, &a.warp,
        "calibrate: The board may be bent: find how", NULL},
    {"world", 0, 0, G_OPTION_ARG_STRING, &a.world,
          "calibrate, upright: World's origin: the first camera, z up in its picture; the board "
          "in the first picture, z off it; or as --points have it (camera)",
        "camera|board|points"},
    {"points", 0, 0, G_OPTION_ARG_FILENAME, &a.points,
        "calibrate, upright: Lines camera,x,y,X,Y,Z: pixels of points whose places in the world "
          "are known, in metres", "FILE"},
    {"every", 0, 0, G_OPTION_ARG_INT, &a.every,
          "calibrate, upright: Look at every so many-th frame of films (10)",
        "N"},
    {"max-views", 0, 0, G_OPTION_ARG_INT, &a.max_views,
          "calibrate: Keep so many frames of films, those that differ most (60)",
        "N"},
    {"leave-out", 0, 0, G_OPTION_ARG_INT, &a.leave_out,
          "calibrate: Check by fitting without every so many-th view; 0: no check (5)",
        "N"},
    {"import-opencv", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &a.opencv,
        "calibrate: Take over OpenCV's YAML; several times for intrinsics and extrinsics "
          "in files of their own, or for several cameras", "FILE"},
    {"import-kalibr", 0, 0, G_OPTION_ARG_FILENAME, &a.kalibr,
        "calibrate: Take over Kalibr's camera chain", "FILE"},
    {"import-mrcal", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &a.mrcal,
          "calibrate: Take over mrcal's .cameramodel; several times for several cameras",
        "FILE"},
    {"export-mrcal", 0, 0, G_OPTION_ARG_FILENAME, &a.export_mrcal,
        "calibrate, upright: Also write each camera as .cameramodel", "FOLDER"},
    {"size", 0, 0, G_OPTION_ARG_STRING, &a.size,
          "calibrate: Picture size of an OpenCV calibration that doesn't say it",
        "WIDTHxHEIGHT"},
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &a.output,
        "The rig.json to write", "FILE"},
    {"report", 0, 0, G_OPTION_ARG_FILENAME, &a.report,
          "calibrate: The page that shows it (calibration.html beside rig.json, NAME-calibration.html beside NAME.json)",
        "FILE"},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &a.cameras, NULL,
        "[calibrate] CAMERA=FILE… | upright RIG [CAMERA=FILE…] | refine RIG TAKE"},
    {NULL}
  };
  gint code;

  a.first = g_strdup ("black");
  a.lens = g_strdup ("brown5");
  a.world = g_strdup ("camera");
  code = tool_main_commands ("gst-cloth-calibrate-1.0",
      "- calibrate cameras from a board", commands, entries, g_strdupv (argv),
      run, &a);
  g_free (a.pattern);
  g_free (a.charuco);
  g_free (a.marker);
  g_free (a.square);
  g_free (a.first);
  g_free (a.lens);
  g_free (a.world);
  g_free (a.size);
  g_free (a.output);
  g_free (a.report);
  g_strfreev (a.opencv);
  g_free (a.kalibr);
  g_strfreev (a.mrcal);
  g_free (a.export_mrcal);
  g_free (a.points);
  g_strfreev (a.cameras);
  return code;
}
