/* What the cameras of a calibration saw of the board.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "calibrate-shots.h"

#include <gio/gio.h>
#include <glob.h>
#include <math.h>
#include <string.h>

#include "calibrate-picture.h"
#include "frames.h"
#include "gst/cv/markers.h"
#include "gst/rig/planar.h"
#include "gst/vision/checker/checker.h"
#include "gst/vision/corner/saddle.h"

/* Fewer corners than this are not worth a pose. */
#define MIN_CORNERS 6

/* Views whose outlines differ by less than this share of the picture are the same. */
#define MIN_DIFFERENCE 0.01

static void
shot_free (gpointer data)
{
  ClothShot *shot = data;

  g_free (shot->label);
  g_free (shot->vertex);
  g_free (shot->x);
  g_free (shot->y);
  g_free (shot->cov);
  g_clear_pointer (&shot->picture, g_bytes_unref);
  g_free (shot);
}

/* @board: (transfer full): a board
 */
void
cloth_shot_board_free (ClothShotBoard * board)
{
  g_clear_pointer (&board->pattern, cloth_pattern_free);
  g_free (board->dictionary);
  g_free (board);
}

/* @name: the camera's name
 *
 * Returns: (transfer full): a camera without files.
 */
ClothShotCamera *
cloth_shot_camera_new (const gchar * name)
{
  ClothShotCamera *camera = g_new0 (ClothShotCamera, 1);

  camera->name = g_strdup (name);
  camera->files = g_ptr_array_new_with_free_func (g_free);
  camera->shots = g_ptr_array_new_with_free_func (shot_free);
  return camera;
}

/* @camera: (transfer full): a camera
 */
void
cloth_shot_camera_free (ClothShotCamera * camera)
{
  g_free (camera->name);
  g_ptr_array_unref (camera->files);
  g_ptr_array_unref (camera->shots);
  g_free (camera);
}

static gboolean
add_file (ClothShotCamera * camera, const gchar * path, GError ** error)
{
  if (g_ptr_array_find_with_equal_func (camera->files, path, g_str_equal, NULL)) {
    g_set_error (error, G_FILE_ERROR, G_FILE_ERROR_EXIST,
        "%s: it is given twice for camera %s; leave one out", path,
        camera->name);
    return FALSE;
  }
  g_ptr_array_add (camera->files, g_strdup (path));
  return TRUE;
}

/* @camera: a camera
 * @pattern: a file, or a pattern as of a shell
 * @error: #GFileError when there is no such file, or one that the camera has already
 *
 * Returns: whether all was well
 */
gboolean
cloth_shot_camera_add (ClothShotCamera * camera, const gchar * pattern,
    GError ** error)
{
  gboolean good = TRUE;
  glob_t found;

  if (g_file_test (pattern, G_FILE_TEST_EXISTS))
    return add_file (camera, pattern, error);
  if (glob (pattern, 0, NULL, &found) != 0) {
    g_set_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT,
        "%s: there is no such file", pattern);
    return FALSE;
  }
  for (gsize i = 0; i < found.gl_pathc && good; i++)
    good = add_file (camera, found.gl_pathv[i], error);
  globfree (&found);
  return good;
}

/* The last number in a file's name, or -1. */
static gint64
file_number (const gchar * path)
{
  g_autofree gchar *name = g_path_get_basename (path);
  gchar *dot = strrchr (name, '.'), *end;

  if (dot && dot != name)
    *dot = 0;
  end = name + strlen (name);
  while (end > name && !g_ascii_isdigit (end[-1]))
    end--;
  *end = 0;
  while (end > name && g_ascii_isdigit (end[-1]))
    end--;
  return *end && strlen (end) < 18 ? g_ascii_strtoll (end, NULL, 10) : -1;
}

static gint
compare_files (gconstpointer a, gconstpointer b)
{
  const gchar *x = *(const gchar * const *) a, *y = *(const gchar * const *) b;
  gint64 m = file_number (x), n = file_number (y);

  return m < n ? -1 : m > n ? 1 : strcmp (x, y);
}

/* @cameras: (element-type ClothShotCamera): all cameras, their files added
 *
 * Sorts the files of each camera by the last number in their names. Pictures of different
 * cameras were taken together when these numbers are equal; or, when some file has none or
 * shares it with another one of its camera, when their places in this order are equal. One
 * file alone is a film, its frames counted.
 */
void
cloth_shot_cameras_number (GPtrArray * cameras)
{
  gboolean by_name = TRUE;

  for (guint c = 0; c < cameras->len; c++) {
    ClothShotCamera *camera = g_ptr_array_index (cameras, c);
    gint64 last = -1;

    g_ptr_array_sort (camera->files, compare_files);
    camera->film = camera->files->len == 1;
    for (guint i = 0; i < camera->files->len; i++) {
      gint64 number = file_number (g_ptr_array_index (camera->files, i));

      by_name = by_name && number > last;
      last = number;
    }
  }
  for (guint c = 0; c < cameras->len; c++) {
    ClothShotCamera *camera = g_ptr_array_index (cameras, c);

    by_name = by_name && !camera->film;
  }
  for (guint c = 0; c < cameras->len; c++) {
    ClothShotCamera *camera = g_ptr_array_index (cameras, c);

    for (guint i = 0; i < camera->files->len && !camera->film; i++) {
      const gchar *path = g_ptr_array_index (camera->files, i);
      ClothShot *shot = g_new0 (ClothShot, 1);

      shot->number = by_name ? file_number (path) : (gint64) i;
      shot->label = g_path_get_basename (path);
      g_ptr_array_add (camera->shots, shot);
    }
  }
}

typedef struct
{
  ClothShotCamera *camera;
  ClothSaddleDetector *detector;
  ClothBoardFinder *finder;     /* of a board without markers */
  ClothCvMarkers *markers;      /* of one with markers */
  ClothMarkedBoard *marked;
  ClothPictureMaker *maker;
  ClothShot *shot;              /* of a picture; NULL in a film */
  const gchar *file;
  ClothShotProgress progress;
  gpointer user_data;
} Reader;

static gboolean
fill_shot (ClothShot * shot, const ClothBoardView * view,
    const ClothShotCamera * camera)
{
  guint total = (guint) (view->columns * view->rows);
  g_autofree gdouble *X = g_new (gdouble, 2 * total);
  gdouble H[9];

  shot->vertex = g_new (guint, total);
  shot->x = g_new (gdouble, total);
  shot->y = g_new (gdouble, total);
  shot->cov = g_new (gdouble, 3 * total);
  for (guint i = 0; i < total; i++) {
    gint column = (gint) i % view->columns, row = (gint) i / view->columns;

    if (!view->seen[i] || column == 0 || row == 0
        || column == view->columns - 1 || row == view->rows - 1)
      continue;
    shot->vertex[shot->n] = i;
    shot->x[shot->n] = view->x[i];
    shot->y[shot->n] = view->y[i];
    for (guint j = 0; j < 3; j++)
      shot->cov[3 * shot->n + j] = view->cov[3 * i + j];
    X[shot->n] = column;
    X[total + shot->n] = row;
    shot->n++;
  }
  if (shot->n < MIN_CORNERS
      || !cloth_planar_homography (shot->n, X, X + total, shot->x, shot->y, H))
    return FALSE;
  for (guint i = 0; i < 4; i++) {
    gdouble u = (i & 1) * (view->columns - 1), v = (i >> 1) * (view->rows - 1);
    gdouble w = H[6] * u + H[7] * v + H[8];

    shot->outline[2 * i] = (H[0] * u + H[1] * v + H[2]) / w / camera->width;
    shot->outline[2 * i + 1] =
        (H[3] * u + H[4] * v + H[5]) / w / camera->height;
  }
  return TRUE;
}

/* The corners of the board in a picture; %FALSE with @error unset when it is not there. */
static gboolean
find_board (Reader * r, const ClothImage * image, const ClothBoardView ** view,
    GError ** error)
{
  const ClothCvPicture picture = { image->data, image->width, image->height,
    image->stride
  };
  ClothSaddleParams params = cloth_saddle_default_params ();
  const ClothSaddle *saddles;
  const gint *ids;
  const gfloat *corners;
  guint n, n_saddles;

  params.refine = CLOTH_SADDLE_REFINE_MODEL;
  if (r->markers) {
    if (!cloth_cv_markers_find (r->markers, &picture, &n, &ids, &corners,
            error))
      return FALSE;
    r->camera->n_marked += n > 0;
    if (cloth_marked_board_set_markers (r->marked, n, ids, corners) == 0)
      return FALSE;
    params.radius = (gfloat) fmin (params.radius,
        cloth_marked_board_get_margin (r->marked));
  }
  cloth_saddle_detector_run (r->detector, &params, image, CLOTH_SIMD_BEST);
  saddles = cloth_saddle_detector_get_saddles (r->detector, &n_saddles);
  if (!r->markers)
    return cloth_board_finder_find (r->finder, image, saddles, n_saddles, view);
  if (cloth_marked_board_find (r->marked, saddles, n_saddles, view))
    return TRUE;
  r->camera->n_contradicted += cloth_marked_board_is_contradicted (r->marked);
  return FALSE;
}

static gboolean
look (const ClothImage * image, guint number, gpointer user_data,
    GError ** error)
{
  Reader *r = user_data;
  ClothShotCamera *camera = r->camera;
  const ClothBoardView *view;
  GError *failure = NULL;

  if (camera->width == 0) {
    camera->width = image->width;
    camera->height = image->height;
  } else if (camera->width != image->width || camera->height != image->height) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
        "%s: %d×%d pixels, but other pictures of camera %s have %d×%d",
        r->file, image->width, image->height, camera->name, camera->width,
        camera->height);
    return FALSE;
  }
  camera->n_pictures++;
  if (find_board (r, image, &view, &failure)) {
    ClothShot *shot = g_new0 (ClothShot, 1);

    if (!fill_shot (shot, view, camera)) {
      shot_free (shot);
      shot = NULL;
    } else if (r->shot) {
      shot->number = r->shot->number;
      shot->label = g_strdup (r->shot->label);
      g_ptr_array_add (camera->shots, shot);
    } else {
      shot->number = number;
      shot->label = g_strdup_printf ("frame %u", number);
      g_ptr_array_add (camera->shots, shot);
    }
    if (shot && r->maker)
      shot->picture = cloth_picture_maker_make (r->maker, image);
  } else if (failure) {
    g_propagate_prefixed_error (error, failure, "%s: ", r->file);
    return FALSE;
  }
  if (camera->film && r->progress)
    r->progress (camera, 0, r->user_data);
  return camera->film
      && (camera->most_pictures == 0
      || camera->n_pictures < camera->most_pictures);
}

/* @camera: a camera, numbered
 * @board: the board
 * @every: of films each so many-th frame is looked at
 * @progress: (nullable) (scope call): called after each picture
 * @user_data: for @progress
 * @error: what is wrong with which file
 *
 * Looks for the board in all pictures.
 *
 * Returns: whether all could be read. That the board is in none of them is no error here.
 */
gboolean
cloth_shot_camera_read (ClothShotCamera * camera, const ClothShotBoard * board,
    guint every, ClothShotProgress progress, gpointer user_data,
    GError ** error)
{
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  g_autoptr (ClothBoardFinder) finder = cloth_board_finder_new (board->pattern);
  g_autoptr (ClothCvMarkers) markers = NULL;
  g_autoptr (ClothMarkedBoard) marked = NULL;
  g_autoptr (GPtrArray) planned = camera->shots;
  g_autoptr (ClothPictureMaker) maker = cloth_picture_maker_new ();
  Reader reader = { camera, detector, finder, NULL, NULL, maker, NULL, NULL,
    progress, user_data
  };

  if (board->dictionary) {
    reader.markers = markers = cloth_cv_markers_new (board->dictionary, error);
    if (!markers)
      return FALSE;
    reader.marked = marked =
        cloth_marked_board_new (board->pattern, board->marker);
  }
  camera->shots = g_ptr_array_new_with_free_func (shot_free);
  for (guint i = 0; i < camera->files->len; i++) {
    reader.file = g_ptr_array_index (camera->files, i);
    reader.shot = camera->film ? NULL : g_ptr_array_index (planned, i);
    if (!cloth_frames_read (reader.file, camera->film ? every : 1, look,
            &reader, error))
      return FALSE;
    if (progress)
      progress (camera, i + 1, user_data);
  }
  return TRUE;
}

static gint
compare_numbers (gconstpointer a, gconstpointer b)
{
  gint64 m = *(const gint64 *) a, n = *(const gint64 *) b;

  return m < n ? -1 : m > n;
}

/* How differently two poses look, each given by one shot a camera or NULL: as their
 * outlines, or as whether they are seen at all. */
static gdouble
difference (const ClothShot ** a, const ClothShot ** b, guint n_cameras)
{
  gdouble sum = 0;

  for (guint c = 0; c < n_cameras; c++) {
    gdouble most = 0;

    for (guint i = 0; a[c] && b[c] && i < 8; i++)
      most = fmax (most, fabs (a[c]->outline[i] - b[c]->outline[i]));
    sum += a[c] && b[c] ? fmin (most, 1) : a[c] || b[c] ? 1 : 0;
  }
  return sum / n_cameras;
}

/* @cameras: (element-type ClothShotCamera): all cameras, read
 * @max_views: most poses to keep
 *
 * Of films keeps poses that differ, each time the one that differs most from all kept, the
 * first being the one with most corners. Pictures are all kept: somebody chose them.
 */
void
cloth_shot_cameras_choose (GPtrArray * cameras, guint max_views)
{
  g_autoptr (GArray) numbers = g_array_new (FALSE, FALSE, sizeof (gint64));
  g_autofree const ClothShot **table = NULL;
  g_autofree gdouble *away = NULL;
  g_autofree gboolean *keep = NULL;
  guint n = cameras->len, best = 0, most = 0;

  for (guint c = 0; c < n; c++) {
    const ClothShotCamera *camera = g_ptr_array_index (cameras, c);

    if (!camera->film)
      return;
    for (guint i = 0; i < camera->shots->len; i++) {
      const ClothShot *shot = g_ptr_array_index (camera->shots, i);

      g_array_append_val (numbers, shot->number);
    }
  }
  g_array_sort (numbers, compare_numbers);
  table = g_new0 (const ClothShot *, (gsize) numbers->len * n + 1);
  for (guint c = 0; c < n; c++) {
    const ClothShotCamera *camera = g_ptr_array_index (cameras, c);

    /* Shots come in the order of their numbers; a number seen by several cameras is
     * in the list as often, its first place counts. */
    for (guint i = 0, at = 0; i < camera->shots->len; i++) {
      const ClothShot *shot = g_ptr_array_index (camera->shots, i);

      while (g_array_index (numbers, gint64, at) < shot->number)
        at++;
      table[at * n + c] = shot;
    }
  }
  away = g_new (gdouble, numbers->len + 1);
  keep = g_new0 (gboolean, numbers->len + 1);
  for (guint i = 0; i < numbers->len; i++) {
    guint corners = 0;

    for (guint c = 0; c < n; c++)
      corners += table[i * n + c] ? table[i * n + c]->n : 0;
    away[i] = corners ? HUGE_VAL : 0;
    if (corners > most) {
      most = corners;
      best = i;
    }
  }
  for (guint kept = 0; kept < max_views && best < numbers->len
      && away[best] >= MIN_DIFFERENCE; kept++) {
    guint taken = best;

    keep[taken] = TRUE;
    for (guint i = 0; i < numbers->len; i++)
      away[i] = fmin (away[i], away[i] > 0
          ? difference (table + taken * n, table + i * n, n) : 0);
    for (guint i = 0; i < numbers->len; i++) {
      if (away[i] > away[best])
        best = i;
    }
  }
  for (guint c = 0; c < n; c++) {
    ClothShotCamera *camera = g_ptr_array_index (cameras, c);

    for (guint i = numbers->len; i-- > 0;) {
      if (table[i * n + c] && !keep[i])
        g_ptr_array_remove (camera->shots, (gpointer) table[i * n + c]);
    }
  }
}
