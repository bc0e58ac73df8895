/* The rendered film of a cloth with a checkerboard, decoded, with the truth of every
 * square: where it is, and whether each camera can see it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"
#include "gst/rig/rig.h"
#include "gst/vision/quad/quad.h"
#include "gst/vision/corner/saddle.h"

G_BEGIN_DECLS

#define TEST_FILM_CAMERAS 2

/* One square in one picture. A corner is clear when the cloth within 0.08 squares of it
 * faces the camera and nothing hides it. A square is visible when that holds for all its
 * corners and all over it, and it is at least 8 px long and high. */
typedef struct {
  gfloat x[4], y[4];            /* px; order as in ClothQuad */
  gfloat size;                  /* root of its area, px */
  gboolean clear[4];
  gboolean visible;
  gfloat seen;                  /* share of it that is not hidden and faces the camera */
} TestFilmSquare;

typedef struct {
  gint width, height;
  guint n_frames;
  ClothRig *rig;
  ClothPattern *pattern;
  guint8 *luma[TEST_FILM_CAMERAS];      /* frame by frame, rows without padding */
  gdouble *corners;             /* [frame][vertex][x y z], metres */
  TestFilmSquare *squares[TEST_FILM_CAMERAS];   /* [frame][row·columns + column] */
} TestFilm;

TestFilm *test_film_load (const gchar * folder);
void test_film_free (TestFilm * film);
const guint8 *test_film_picture (const TestFilm * film, guint camera,
    guint frame);
const TestFilmSquare *test_film_square (const TestFilm * film, guint camera,
    guint frame, gint column, gint row);
/* Whether it is visible, and clear of what @cover, if any, says was put before it. */
gboolean test_film_is_visible (const TestFilm * film, guint camera,
    guint frame, gint column, gint row, const guint8 * cover);

/* Saddles and squares of one picture after the other, as the elements find them. */
typedef struct {
  ClothSaddleDetector *detector;
  ClothQuadTracker *tracker;
  ClothSaddleParams saddle_params;
  ClothQuadParams quad_params;
} TestTracking;

void test_tracking_init (TestTracking * tracking, const TestFilm * film);
void test_tracking_clear (TestTracking * tracking);
const ClothQuad *test_tracking_run (TestTracking * tracking,
    const TestFilm * film, const guint8 * luma, guint * n_quads);

/* What a tracker got right. Black squares only. A tracked square is wrong when its middle
 * lies nearer to the true middle of another square, or more than half a square off its
 * own; it is a ghost when nothing of it can be seen; it strays when one of its corners
 * lies more than 0.4 squares off. */
typedef struct {
  guint visible, hit;
  guint tracked, wrong, ghosts, strays;
  guint faults;                 /* wrong, ghosts, or both */
  gfloat farthest;              /* corner from its place, squares */
  guint n_corners;
  gdouble sum2;                 /* px², both axes, of the corners that are clear */
} TestFilmScore;

/* @cover: (nullable): a byte for each pixel, not 0 where something was put before the
 * cloth. @what: (nullable): tells of every square that is wrong, for g_test_message. */
void test_film_score (const TestFilm * film, guint camera, guint frame,
    const guint8 * cover, const ClothQuad * quads, guint n_quads,
    const gchar * what, TestFilmScore * score);
void test_film_add (TestFilmScore * sum, const TestFilmScore * score);
gdouble test_film_rms (const TestFilmScore * score);
/* Tracks all pictures of a camera and adds up what was right, held against the truth of
 * the picture @late before. */
void test_film_track (const TestFilm * film, guint camera, guint late,
    const gchar * what, TestFilmScore * sum);
void test_film_tell (const gchar * what, const TestFilmScore * score);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (TestFilm, test_film_free)
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (TestTracking, test_tracking_clear)
G_END_DECLS
