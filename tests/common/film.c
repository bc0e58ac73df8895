/* The rendered film of a cloth with a checkerboard, and what is true of it.
 *
 * The truth is the mesh the film was rendered from, between whose vertices the cloth is
 * bilinear. What hides what is found by rays through the mesh, not through the picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/film.h"

#include <math.h>
#include <string.h>

#include "gst/rig/rigfile.h"
#include "tests/common/luma.h"
#include "tests/common/npyfloats.h"

/* The mesh the film was rendered from. */
#define COLUMNS 33
#define ROWS 35
/* Least edge and height of a square that counts, px. */
#define LEAST 8.0f
/* Samples across a square. */
#define SAMPLES 7
/* A corner's neighbourhood, in squares. */
#define AROUND 0.08
/* Nearer to the camera than this much and it hides what is behind, metres. */
#define HIDES 0.004
/* How far from a square's outline something put before it must stay, in squares. */
#define COVER_MARGIN 0.15f
/* A corner is off when it is farther away, in squares. */
#define STRAY 0.4f

static const gint corner_column[4] = { 0, 1, 1, 0 };
static const gint corner_row[4] = { 0, 0, 1, 1 };

typedef struct
{
  gdouble x, y, z;
} Seen;

typedef struct
{
  Seen a, b, c;
  gdouble area;
} Triangle;

/* The triangles of one picture by the tiles they touch. */
#define TILE 16
typedef struct
{
  Triangle triangles[4 * (COLUMNS - 1) * (ROWS - 1)];
  guint n_triangles;
  gint columns, rows;
  GArray **tiles;
} Scene;

static Seen
look (const ClothCamera * camera, const gdouble X[3])
{
  Seen seen = { 0, 0, -1 };
  gdouble px[2];

  if (cloth_camera_project (camera, X, px, NULL, NULL))
    seen = (Seen) {
    px[0], px[1], camera->R[6] * X[0] + camera->R[7] * X[1]
    + camera->R[8] * X[2] + camera->t[2]};
  return seen;
}

/* The cloth's point at (@u, @v), metres. */
static void
surface (const gfloat * mesh, const ClothPattern * pattern, gdouble u,
    gdouble v, gdouble X[3])
{
  const gdouble x = u / pattern->cloth_m[0] * (COLUMNS - 1);
  const gdouble y = v / pattern->cloth_m[1] * (ROWS - 1);
  const gint i = CLAMP ((gint) x, 0, COLUMNS - 2);
  const gint j = CLAMP ((gint) y, 0, ROWS - 2);
  const gdouble a = x - i, b = y - j;
  const gfloat *at = mesh + 3 * (j * COLUMNS + i), *below = at + 3 * COLUMNS;

  for (gint k = 0; k < 3; k++)
    X[k] = (1 - b) * ((1 - a) * at[k] + a * at[3 + k])
        + b * ((1 - a) * below[k] + a * below[3 + k]);
}

static void
board_point (const gfloat * mesh, const ClothPattern * pattern, gdouble column,
    gdouble row, gdouble X[3])
{
  surface (mesh, pattern, pattern->origin_uv_m[0] + column * pattern->square_m,
      pattern->origin_uv_m[1] + row * pattern->square_m, X);
}

static void
add_triangle (Scene * scene, Seen a, Seen b, Seen c)
{
  const Triangle t = { a, b, c,
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
  };
  const guint k = scene->n_triangles++;
  const gint left = (gint) floor (MIN (a.x, MIN (b.x, c.x)) / TILE);
  const gint right = (gint) floor (MAX (a.x, MAX (b.x, c.x)) / TILE);
  const gint top = (gint) floor (MIN (a.y, MIN (b.y, c.y)) / TILE);
  const gint bottom = (gint) floor (MAX (a.y, MAX (b.y, c.y)) / TILE);

  scene->triangles[k] = t;
  for (gint j = MAX (top, 0); j <= MIN (bottom, scene->rows - 1); j++)
    for (gint i = MAX (left, 0); i <= MIN (right, scene->columns - 1); i++)
      g_array_append_val (scene->tiles[j * scene->columns + i], k);
}

/* Whether the point of the cloth that is seen here faces the camera and nothing lies
 * before it. Without a tile it is outside the picture. */
static gboolean
is_clear (const Scene * scene, Seen p)
{
  const gint i = (gint) floor (p.x / TILE), j = (gint) floor (p.y / TILE);
  gboolean faces = FALSE;
  const GArray *tile;

  if (i < 0 || j < 0 || i >= scene->columns || j >= scene->rows)
    return FALSE;
  tile = scene->tiles[j * scene->columns + i];
  for (guint n = 0; n < tile->len; n++) {
    const Triangle *t = &scene->triangles[g_array_index (tile, guint, n)];
    const gdouble wa = ((t->b.x - p.x) * (t->c.y - p.y)
        - (t->b.y - p.y) * (t->c.x - p.x)) / t->area;
    const gdouble wb = ((t->c.x - p.x) * (t->a.y - p.y)
        - (t->c.y - p.y) * (t->a.x - p.x)) / t->area;
    const gdouble wc = 1 - wa - wb;
    gdouble z;

    if (!(wa >= 0 && wb >= 0 && wc >= 0))
      continue;
    z = 1 / (wa / t->a.z + wb / t->b.z + wc / t->c.z);
    if (z < p.z - HIDES)
      return FALSE;
    faces |= fabs (z - p.z) <= HIDES && t->area > 0;
  }
  return faces;
}

static void
judge_square (const TestFilm * film, const Scene * scene,
    const gfloat * mesh, const ClothCamera * camera, gint column, gint row,
    TestFilmSquare * square)
{
  gfloat area = 0, shortest = G_MAXFLOAT, longest = 0;
  gdouble X[3];
  guint seen = 0;

  square->visible = TRUE;
  for (gint k = 0; k < 4; k++) {
    const gint c = column + corner_column[k], r = row + corner_row[k];
    Seen p;

    board_point (mesh, film->pattern, c, r, X);
    p = look (camera, X);
    square->x[k] = (gfloat) p.x;
    square->y[k] = (gfloat) p.y;
    square->clear[k] = TRUE;
    for (gint j = -1; j <= 1; j++)
      for (gint i = -1; i <= 1; i++) {
        board_point (mesh, film->pattern, c + i * AROUND, r + j * AROUND, X);
        square->clear[k] &= is_clear (scene, look (camera, X));
      }
    square->visible &= square->clear[k];
  }
  for (gint j = 0; j < SAMPLES; j++)
    for (gint i = 0; i < SAMPLES; i++) {
      board_point (mesh, film->pattern, column + i / (SAMPLES - 1.0),
          row + j / (SAMPLES - 1.0), X);
      seen += is_clear (scene, look (camera, X));
    }
  square->seen = (gfloat) seen / (SAMPLES * SAMPLES);
  for (gint k = 0; k < 4; k++) {
    const gint to = (k + 1) & 3;
    const gfloat length = hypotf (square->x[to] - square->x[k],
        square->y[to] - square->y[k]);

    area += 0.5f * (square->x[k] * square->y[to]
        - square->x[to] * square->y[k]);
    shortest = MIN (shortest, length);
    longest = MAX (longest, length);
  }
  square->size = sqrtf (fabsf (area));
  square->visible &= seen == SAMPLES * SAMPLES && shortest >= LEAST
      && area / longest >= LEAST;
}

static void
judge_frame (TestFilm * film, const gfloat * mesh, guint camera, guint frame,
    Scene * scene)
{
  const ClothCamera *seen_by = &film->rig->cameras[camera];
  const gint columns = film->pattern->columns, rows = film->pattern->rows;
  Seen at[ROWS * COLUMNS];

  scene->n_triangles = 0;
  for (gint k = 0; k < scene->columns * scene->rows; k++)
    g_array_set_size (scene->tiles[k], 0);
  for (gint k = 0; k < ROWS * COLUMNS; k++) {
    const gdouble X[3] = { mesh[3 * k], mesh[3 * k + 1], mesh[3 * k + 2] };

    at[k] = look (seen_by, X);
  }
  for (gint j = 0; j + 1 < ROWS; j++)
    for (gint i = 0; i + 1 < COLUMNS; i++) {
      const Seen *p = at + j * COLUMNS + i;

      add_triangle (scene, p[0], p[1], p[COLUMNS + 1]);
      add_triangle (scene, p[0], p[COLUMNS + 1], p[COLUMNS]);
    }
  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++)
      judge_square (film, scene, mesh, seen_by, column, row,
          &film->squares[camera][(frame * (guint) rows + (guint) row)
              * (guint) columns + (guint) column]);
}

static void
judge_film (TestFilm * film, const gfloat * vertices)
{
  Scene *scene = g_new0 (Scene, 1);
  const guint n_squares = (guint) (film->pattern->columns
      * film->pattern->rows);
  const gint across = film->pattern->columns + 1;
  const gint n_corners = across * (film->pattern->rows + 1);

  scene->columns = (film->width + TILE - 1) / TILE;
  scene->rows = (film->height + TILE - 1) / TILE;
  scene->tiles = g_new (GArray *, scene->columns * scene->rows);
  for (gint k = 0; k < scene->columns * scene->rows; k++)
    scene->tiles[k] = g_array_new (FALSE, FALSE, sizeof (guint));
  film->corners = g_new (gdouble, 3 * film->n_frames * (guint) n_corners);
  for (guint frame = 0; frame < film->n_frames; frame++)
    for (gint k = 0; k < n_corners; k++)
      board_point (vertices + 3 * frame * ROWS * COLUMNS, film->pattern,
          k % across, k / across,
          film->corners + 3 * (frame * (guint) n_corners + (guint) k));
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++) {
    film->squares[camera] = g_new0 (TestFilmSquare, film->n_frames * n_squares);
    for (guint frame = 0; frame < film->n_frames; frame++)
      judge_frame (film, vertices + 3 * frame * ROWS * COLUMNS, camera, frame,
          scene);
  }
  for (gint k = 0; k < scene->columns * scene->rows; k++)
    g_array_unref (scene->tiles[k]);
  g_free (scene->tiles);
  g_free (scene);
}

TestFilm *
test_film_load (const gchar * folder)
{
  TestFilm *film = g_new0 (TestFilm, 1);
  g_autofree gchar *rig = g_build_filename (folder, "rig.json", NULL);
  g_autofree gchar *pattern = g_build_filename (folder, "pattern.json", NULL);
  g_autofree gchar *truth = g_build_filename (folder, "vertices.npy", NULL);
  g_autofree gfloat *vertices = NULL;
  g_autoptr (GError) error = NULL;
  ClothNpyInfo info;

  film->rig = cloth_rig_load (rig, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (film->rig->n_cameras, ==, TEST_FILM_CAMERAS);
  film->pattern = cloth_pattern_load (pattern, &error);
  g_assert_no_error (error);
  vertices = load_npy_floats (truth, &info, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (info.row_items, ==, 3 * ROWS * COLUMNS);
  film->n_frames = (guint) info.n_rows;
  film->width = film->rig->cameras[0].width;
  film->height = film->rig->cameras[0].height;
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++) {
    g_autofree gchar *name = g_strdup_printf ("cam%u.mp4", camera);
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    film->luma[camera] = test_luma_decode (path, film->width, film->height,
        film->n_frames);
  }
  judge_film (film, vertices);
  return film;
}

void
test_film_free (TestFilm * film)
{
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++) {
    g_free (film->luma[camera]);
    g_free (film->squares[camera]);
  }
  g_free (film->corners);
  cloth_rig_free (film->rig);
  cloth_pattern_free (film->pattern);
  g_free (film);
}

const guint8 *
test_film_picture (const TestFilm * film, guint camera, guint frame)
{
  return film->luma[camera]
      + (gsize) film->width * (gsize) film->height * frame;
}

const TestFilmSquare *
test_film_square (const TestFilm * film, guint camera, guint frame,
    gint column, gint row)
{
  const gint n = film->pattern->columns * film->pattern->rows;

  return &film->squares[camera][(gint) frame * n
      + row * film->pattern->columns + column];
}

void
test_tracking_init (TestTracking * tracking, const TestFilm * film)
{
  tracking->detector = cloth_saddle_detector_new ();
  tracking->tracker = cloth_quad_tracker_new (film->pattern);
  tracking->saddle_params = cloth_saddle_default_params ();
  tracking->quad_params = cloth_quad_default_params ();
}

void
test_tracking_clear (TestTracking * tracking)
{
  g_clear_pointer (&tracking->detector, cloth_saddle_detector_free);
  g_clear_pointer (&tracking->tracker, cloth_quad_tracker_free);
}

const ClothQuad *
test_tracking_run (TestTracking * tracking, const TestFilm * film,
    const guint8 * luma, guint * n_quads)
{
  const ClothImage image = { luma, film->width, film->height, film->width };
  const ClothSaddleCandidate *candidates;
  const ClothSaddle *saddles;
  guint n_saddles, n_candidates;

  cloth_saddle_detector_run (tracking->detector, &tracking->saddle_params,
      &image, CLOTH_SIMD_BEST);
  saddles = cloth_saddle_detector_get_saddles (tracking->detector, &n_saddles);
  candidates = cloth_saddle_detector_get_candidates (tracking->detector,
      &n_candidates);
  return cloth_quad_tracker_run (tracking->tracker, &tracking->quad_params,
      &image, saddles, n_saddles, candidates, n_candidates, n_quads);
}

/* Share of a square, and a margin around it, that is covered. */
static gfloat
covered (const TestFilm * film, const guint8 * cover,
    const TestFilmSquare * square, gfloat from_column, gfloat to_column,
    gfloat from_row, gfloat to_row)
{
  guint n = 0;

  if (!cover)
    return 0;
  for (gint j = 0; j <= 10; j++)
    for (gint i = 0; i <= 10; i++) {
      const gfloat s =
          from_column + (to_column - from_column) * (gfloat) i / 10;
      const gfloat t = from_row + (to_row - from_row) * (gfloat) j / 10;
      const gfloat x = (1 - t) * ((1 - s) * square->x[0] + s * square->x[1])
          + t * ((1 - s) * square->x[3] + s * square->x[2]);
      const gfloat y = (1 - t) * ((1 - s) * square->y[0] + s * square->y[1])
          + t * ((1 - s) * square->y[3] + s * square->y[2]);
      const gint column = CLAMP ((gint) lrintf (x), 0, film->width - 1);
      const gint row = CLAMP ((gint) lrintf (y), 0, film->height - 1);

      n += cover[row * film->width + column] != 0;
    }
  return (gfloat) n / 121;
}

gboolean
test_film_is_visible (const TestFilm * film, guint camera, guint frame,
    gint column, gint row, const guint8 * cover)
{
  const TestFilmSquare *square = test_film_square (film, camera, frame, column,
      row);

  return square->visible && covered (film, cover, square, -COVER_MARGIN,
      1 + COVER_MARGIN, -COVER_MARGIN, 1 + COVER_MARGIN) == 0;
}

static void
middle (const gfloat x[4], const gfloat y[4], gfloat * cx, gfloat * cy)
{
  *cx = (x[0] + x[1] + x[2] + x[3]) / 4;
  *cy = (y[0] + y[1] + y[2] + y[3]) / 4;
}

static gboolean
is_wrong (const TestFilm * film, guint camera, guint frame,
    const ClothQuad * quad)
{
  const TestFilmSquare *own = test_film_square (film, camera, frame,
      quad->column, quad->row);
  gfloat x, y, tx, ty, away;

  middle (quad->x, quad->y, &x, &y);
  middle (own->x, own->y, &tx, &ty);
  away = hypotf (x - tx, y - ty);
  if (away > 0.5f * own->size)
    return TRUE;
  for (gint row = 0; row < film->pattern->rows; row++)
    for (gint column = 0; column < film->pattern->columns; column++) {
      const TestFilmSquare *other = test_film_square (film, camera, frame,
          column, row);

      middle (other->x, other->y, &tx, &ty);
      if (hypotf (x - tx, y - ty) < away)
        return TRUE;
    }
  return FALSE;
}

static void
score_quad (const TestFilm * film, guint camera, guint frame,
    const guint8 * cover, const ClothQuad * quad, const gchar * what,
    TestFilmScore * score)
{
  const TestFilmSquare *own = test_film_square (film, camera, frame,
      quad->column, quad->row);
  gboolean wrong = is_wrong (film, camera, frame, quad);
  gboolean ghost = own->seen == 0
      || covered (film, cover, own, 0, 1, 0, 1) == 1;
  gfloat worst = 0;

  score->tracked++;
  score->wrong += wrong;
  score->ghosts += ghost;
  score->faults += wrong || ghost;
  for (gint k = 0; k < 4; k++) {
    const gfloat dx = quad->x[k] - own->x[k], dy = quad->y[k] - own->y[k];
    const gfloat c = (gfloat) corner_column[k], r = (gfloat) corner_row[k];

    worst = MAX (worst, hypotf (dx, dy));
    if (!own->clear[k] || covered (film, cover, own, c - COVER_MARGIN,
            c + COVER_MARGIN, r - COVER_MARGIN, r + COVER_MARGIN) > 0)
      continue;
    score->n_corners++;
    score->sum2 += dx * dx + dy * dy;
  }
  score->farthest = MAX (score->farthest, worst / own->size);
  score->strays += worst > STRAY * own->size;
  if (what && (wrong || ghost || worst > STRAY * own->size))
    g_test_message
        ("%s: camera %u frame %u square (%d, %d) %s%s, a corner %.1f "
        "px off at a size of %.1f px, %.0f%% of it seen, confidence %.2f", what,
        camera, frame, quad->column, quad->row, wrong ? "WRONG" : "strays",
        ghost ? " GHOST" : "", worst, own->size, 100 * own->seen,
        quad->confidence);
}

void
test_film_score (const TestFilm * film, guint camera, guint frame,
    const guint8 * cover, const ClothQuad * quads, guint n_quads,
    const gchar * what, TestFilmScore * score)
{
  const gint columns = film->pattern->columns, rows = film->pattern->rows;
  g_autofree gboolean *tracked = g_new0 (gboolean, columns * rows);

  *score = (TestFilmScore) {
  0};
  for (guint k = 0; k < n_quads; k++) {
    if (quads[k].state != CLOTH_QUAD_TRACKED)
      continue;
    tracked[quads[k].row * columns + quads[k].column] = TRUE;
    score_quad (film, camera, frame, cover, &quads[k], what, score);
  }
  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++)
      if (cloth_pattern_is_black (film->pattern, column, row)
          && test_film_is_visible (film, camera, frame, column, row, cover)) {
        score->visible++;
        score->hit += tracked[row * columns + column];
      }
}

void
test_film_add (TestFilmScore * sum, const TestFilmScore * score)
{
  sum->visible += score->visible;
  sum->hit += score->hit;
  sum->tracked += score->tracked;
  sum->wrong += score->wrong;
  sum->ghosts += score->ghosts;
  sum->faults += score->faults;
  sum->strays += score->strays;
  sum->farthest = MAX (sum->farthest, score->farthest);
  sum->n_corners += score->n_corners;
  sum->sum2 += score->sum2;
}

/* Root mean square of the errors along one axis, px. */
gdouble
test_film_rms (const TestFilmScore * score)
{
  return score->n_corners ? sqrt (score->sum2 / (2.0 * score->n_corners)) : 0;
}

void
test_film_track (const TestFilm * film, guint camera, guint late,
    const gchar * what, TestFilmScore * sum)
{
  g_auto (TestTracking) tracking = { 0 };

  test_tracking_init (&tracking, film);
  for (guint frame = late; frame < film->n_frames; frame++) {
    TestFilmScore score;
    guint n;
    const ClothQuad *quads = test_tracking_run (&tracking, film,
        test_film_picture (film, camera, frame), &n);

    test_film_score (film, camera, frame - late, NULL, quads, n, what, &score);
    test_film_add (sum, &score);
  }
}

void
test_film_tell (const gchar * what, const TestFilmScore * score)
{
  g_test_message ("%s: %u of %u visible squares tracked (%.2f%%), %u wrong, "
      "%u ghosts, %u with a corner astray of %u; %u corners, %.4f px RMS an axis",
      what, score->hit, score->visible,
      100.0 * score->hit / MAX (score->visible, 1), score->wrong,
      score->ghosts, score->strays, score->tracked, score->n_corners,
      test_film_rms (score));
}
