/* A film made from the rendered one, shown to the tracker picture by picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/play.h"

#include <string.h>

/* Squares seen, of which a picture's share says something. */
#define ENOUGH 5

static gint
n_squares (const TestFilm * film)
{
  return film->pattern->columns * film->pattern->rows;
}

static void
mark (const TestFilm * film, const ClothQuad * quads, guint n, guint8 * tracked)
{
  memset (tracked, 0, (gsize) n_squares (film));
  for (guint k = 0; k < n; k++)
    if (quads[k].state == CLOTH_QUAD_TRACKED)
      tracked[quads[k].row * film->pattern->columns + quads[k].column] = 1;
}

guint8 *
test_play_plain (const TestFilm * film, guint camera)
{
  g_auto (TestTracking) tracking = { 0 };
  guint8 *plain = g_malloc ((gsize) n_squares (film) * film->n_frames);

  test_tracking_init (&tracking, film);
  for (guint frame = 0; frame < film->n_frames; frame++) {
    guint n;
    const ClothQuad *quads = test_tracking_run (&tracking, film,
        test_film_picture (film, camera, frame), &n);

    mark (film, quads, n, plain + n_squares (film) * (gint) frame);
  }
  return plain;
}

void
test_play_init (TestPlay * play, const TestFilm * film, guint camera,
    const guint8 * plain, const gchar * what)
{
  *play = (TestPlay) {
  .film = film,.camera = camera,.plain = plain,.what = what,.worst = 1};
  test_tracking_init (&play->tracking, film);
  play->stories = g_new0 (TestStory, n_squares (film));
}

void
test_play_clear (TestPlay * play)
{
  test_tracking_clear (&play->tracking);
  g_clear_pointer (&play->stories, g_free);
}

void
test_play_show (TestPlay * play, guint frame, gboolean cut,
    const guint8 * luma, const guint8 * cover)
{
  const TestFilm *film = play->film;
  const gint columns = film->pattern->columns, n_all = n_squares (film);
  const guint8 *undisturbed = play->plain + n_all * (gint) frame;
  g_autofree guint8 *tracked = g_malloc ((gsize) n_all);
  guint n, hit = 0, plain_hit = 0;
  TestFilmScore score;
  const ClothQuad *quads;

  quads = test_tracking_run (&play->tracking, film, luma, &n);
  test_film_score (film, play->camera, frame, cover, quads, n, play->what,
      &score);
  test_film_add (&play->sum, &score);
  mark (film, quads, n, tracked);
  cut |= play->shown == 0 || ABS ((gint) frame - (gint) play->last) > 1;
  play->since_cut = cut ? 1 : play->since_cut + 1;
  for (gint s = 0; s < n_all; s++) {
    TestStory *story = &play->stories[s];

    if (!cloth_pattern_is_black (film->pattern, s % columns, s / columns)
        || !test_film_is_visible (film, play->camera, frame, s % columns,
            s / columns, cover)) {
      story->since = 0;
      continue;
    }
    hit += tracked[s] && undisturbed[s];
    plain_hit += undisturbed[s];
    if (cut || story->since == 0)
      *story = (TestStory) {
      0};
    story->found |= tracked[s];
    story->plain_found |= undisturbed[s];
    if (++story->since == TEST_PLAY_SOON && story->plain_found) {
      play->reappeared++;
      play->found += story->found;
      if (!story->found && play->what)
        g_test_message ("%s: picture %u (frame %u) square (%d, %d) not found "
            "again", play->what, play->shown, frame, s % columns, s / columns);
    }
  }
  if (play->since_cut >= TEST_PLAY_SOON && plain_hit >= ENOUGH
      && (gdouble) hit / plain_hit < play->worst) {
    play->worst = (gdouble) hit / plain_hit;
    play->worst_at = play->shown;
    play->worst_frame = frame;
  }
  play->last = frame;
  play->shown++;
}

void
test_film_box (const TestFilm * film, guint camera, guint frame, gfloat box[4])
{
  box[0] = box[1] = G_MAXFLOAT;
  box[2] = box[3] = 0;
  for (gint s = 0; s < n_squares (film); s++) {
    const TestFilmSquare *square = test_film_square (film, camera, frame,
        s % film->pattern->columns, s / film->pattern->columns);

    if (square->seen == 0)
      continue;
    for (gint k = 0; k < 4; k++) {
      box[0] = MIN (box[0], square->x[k]);
      box[1] = MIN (box[1], square->y[k]);
      box[2] = MAX (box[2], square->x[k]);
      box[3] = MAX (box[3], square->y[k]);
    }
  }
}
