/* A film made from the rendered one, shown to the tracker picture by picture: what it
 * gets wrong, and how soon it finds again what reappears.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "tests/common/film.h"

G_BEGIN_DECLS

/* Pictures within which a square that reappears must be tracked. */
#define TEST_PLAY_SOON 5

/* A square's story since it was last hidden. */
typedef struct {
  guint since;                  /* pictures it is visible */
  gboolean found, plain_found;
} TestStory;

typedef struct {
  const TestFilm *film;
  guint camera;
  const guint8 *plain;
  const gchar *what;            /* tells of every square that is wrong if not NULL */
  TestTracking tracking;
  TestStory *stories;
  TestFilmScore sum;
  /* Of the squares that came into sight and that the undisturbed film's tracker sees. */
  guint reappeared, found;
  guint shown, last, since_cut;
  gdouble worst;                /* share of those that it tracks, in the worst picture */
  guint worst_at, worst_frame;
} TestPlay;

/* What the tracker tracks in the film as it is: 1 for each black square tracked, frame by
 * frame. */
guint8 *test_play_plain (const TestFilm * film, guint camera);
void test_play_init (TestPlay * play, const TestFilm * film, guint camera,
    const guint8 * plain, const gchar * what);
void test_play_clear (TestPlay * play);
/* @cut: whether everything is new in this picture; a jump to another frame is a cut in
 * any case. @cover: as in test_film_score (). */
void test_play_show (TestPlay * play, guint frame, gboolean cut,
    const guint8 * luma, const guint8 * cover);

/* The smallest upright box around what can be seen of the board: left, top, right,
 * bottom. */
void test_film_box (const TestFilm * film, guint camera, guint frame,
    gfloat box[4]);

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (TestPlay, test_play_clear)
G_END_DECLS
