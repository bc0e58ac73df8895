/* Films made from the rendered cloth: cuts, full and moving occlusions, a hard shadow, and
 * all of them together. The truth is that of the film, where it is not covered.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/gst.h>
#include <math.h>
#include <string.h>

#include "tests/common/play.h"

/* Of the squares that reappear, where the undisturbed film's tracker sees them: of those
 * that were hidden or cut away, and of those in films that have a shadow's edge as well,
 * which may lie on them all the time. */
#define LEAST_FOUND 0.96
#define LEAST_FOUND_SHADED 0.8
/* The same of all films of one test together. */
#define LEAST_OF_ALL 0.98
#define LEAST_OF_SHADED 0.985
#define LEAST_OF_MIXED 0.93
/* Squares of which a corner strays, of those tracked: what hides the board's rim may cut one
 * off. And how far a corner may be off, squares. */
#define MOST_STRAYS 0.0015
#define FARTHEST 1.0f
#define SHADOW 0.35f

typedef enum
{ OPEN, FULL_GREY, FULL_NOISE, BAR, DISC } Cover;

/* One picture of a film made. */
typedef struct
{
  guint frame;
  Cover cover;
  guint8 level;                 /* of the bar or disc */
  gfloat share;                 /* of the board that they cover */
  gfloat at;                    /* where they are: 0 left of the board, 1 right of it */
  gfloat slope;                 /* how far a disc moves down as it moves across */
  gboolean shadow;
  gfloat shadow_at, shadow_angle;
} Shot;

static TestFilm *film;
/* Of the films of one test. */
static guint sum_found, sum_reappeared, sum_strays, sum_tracked;
static guint8 *plain[TEST_FILM_CAMERAS];

/* Draws one picture; @cover gets 1 where the cloth is hidden. */
static void
draw (guint camera, const Shot * shot, GRand * rand, guint8 * luma,
    guint8 * cover)
{
  const gint width = film->width, height = film->height;
  gfloat box[4], reach, x0, y0, radius;
  gfloat nx = cosf (shot->shadow_angle), ny = sinf (shot->shadow_angle);

  memcpy (luma, test_film_picture (film, camera, shot->frame),
      (gsize) width * (gsize) height);
  memset (cover, shot->cover == FULL_GREY || shot->cover == FULL_NOISE,
      (gsize) width * (gsize) height);
  test_film_box (film, camera, shot->frame, box);
  radius = shot->cover == BAR ? 0.5f * shot->share * (box[2] - box[0])
      : sqrtf (shot->share * (box[2] - box[0]) * (box[3] - box[1])
      / (gfloat) G_PI);
  x0 = box[0] - radius + shot->at * (box[2] - box[0] + 2 * radius);
  y0 = 0.5f * (box[1] + box[3])
      + shot->slope * (shot->at - 0.5f) * (box[3] - box[1]);
  reach = 0.5f * hypotf (box[2] - box[0], box[3] - box[1]);
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      guint8 *at = luma + y * width + x;
      const gfloat dx = (gfloat) x - x0, dy = (gfloat) y - y0;

      if (shot->shadow && ((gfloat) x - 0.5f * (box[0] + box[2])) * nx
          + ((gfloat) y - 0.5f * (box[1] + box[3])) * ny
          < (2 * shot->shadow_at - 1) * reach)
        *at = (guint8) lrintf (SHADOW * *at);
      if (shot->cover == FULL_GREY)
        *at = 120;
      else if (shot->cover == FULL_NOISE)
        *at = (guint8) g_rand_int_range (rand, 16, 236);
      else if ((shot->cover == BAR && fabsf (dx) < radius)
          || (shot->cover == DISC && hypotf (dx, dy) < radius)) {
        *at = shot->level;
        cover[y * width + x] = 1;
      }
    }
}

static gboolean
is_full (const Shot * shot)
{
  return shot->cover == FULL_GREY || shot->cover == FULL_NOISE;
}

/* Plays a film made and holds what is tracked against the truth. */
static void
play (const gchar * name, guint camera, const GArray * shots)
{
  const gsize size = (gsize) film->width * (gsize) film->height;
  g_autofree guint8 *luma = g_malloc (size), *cover = g_malloc (size);
  g_autofree gchar *what = g_strdup_printf ("%s, camera %u", name, camera);
  g_autoptr (GRand) rand = g_rand_new_with_seed (camera + 1);
  g_auto (TestPlay) play = { 0 };
  gboolean shaded = FALSE;

  test_play_init (&play, film, camera, plain[camera], what);
  for (guint k = 0; k < shots->len; k++) {
    const Shot *shot = &g_array_index (shots, Shot, k);

    draw (camera, shot, rand, luma, cover);
    shaded |= shot->shadow;
    test_play_show (&play, shot->frame, k > 0 && !is_full (shot)
        && is_full (&shot[-1]), luma, cover);
  }
  g_test_message ("%s: %u of %u squares that came into sight tracked within %d "
      "pictures; %u of %u visible tracked in all (%.1f%%), worst picture %u "
      "(frame %u) %.0f%% of what is tracked undisturbed; %u wrong, %u ghosts, %u "
      "with a corner astray of %u; %.3f px RMS an axis", what, play.found,
      play.reappeared, TEST_PLAY_SOON, play.sum.hit, play.sum.visible,
      100.0 * play.sum.hit / MAX (play.sum.visible, 1), play.worst_at,
      play.worst_frame, 100 * play.worst, play.sum.wrong, play.sum.ghosts,
      play.sum.strays, play.sum.tracked, test_film_rms (&play.sum));
  g_assert_cmpuint (play.sum.wrong, ==, 0);
  g_assert_cmpuint (play.sum.ghosts, ==, 0);
  g_assert_cmpfloat (play.sum.farthest, <, FARTHEST);
  sum_strays += play.sum.strays;
  sum_tracked += play.sum.tracked;
  sum_found += play.found;
  sum_reappeared += play.reappeared;
  g_assert_cmpuint (play.reappeared, >, 50);
  g_assert_cmpuint (play.found, >=, (guint) ceil ((shaded ? LEAST_FOUND_SHADED
              : LEAST_FOUND) * play.reappeared));
}

static void
check_sum (gdouble least)
{
  g_test_message
      ("together: %u of %u squares that came into sight (%.1f%%), %u "
      "with a corner astray of %u (%.2f%%)", sum_found, sum_reappeared,
      100.0 * sum_found / sum_reappeared, sum_strays, sum_tracked,
      100.0 * sum_strays / sum_tracked);
  g_assert_cmpuint (sum_found, >=, (guint) ceil (least * sum_reappeared));
  g_assert_cmpuint (sum_strays, <=, (guint) (MOST_STRAYS * sum_tracked));
  sum_found = sum_reappeared = sum_strays = sum_tracked = 0;
}

static void
play_both (const gchar * name, const GArray * shots)
{
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++)
    play (name, camera, shots);
}

/* Appends the film's frames from @from to @to, which may lie before it. */
static void
append (GArray * shots, guint from, guint to)
{
  const gint step = from < to ? 1 : -1;
  Shot shot = { from };

  for (;; shot.frame = (guint) ((gint) shot.frame + step)) {
    g_array_append_val (shots, shot);
    if (shot.frame == to)
      break;
  }
}

static GArray *
whole_film (void)
{
  GArray *shots = g_array_new (FALSE, FALSE, sizeof (Shot));

  append (shots, 0, film->n_frames - 1);
  return shots;
}

static void
check_cuts (void)
{
  static const guint cuts[][2] =
      { {0, 12}, {40, 52}, {5, 17}, {45, 33}, {60, 50},
  {20, 32}, {62, 55}, {15, 0}, {24, 39}, {57, 62}, {22, 28}, {3, 12}
  };
  g_autoptr (GArray) shots = g_array_new (FALSE, FALSE, sizeof (Shot));

  for (guint k = 0; k < G_N_ELEMENTS (cuts); k++)
    append (shots, cuts[k][0], cuts[k][1]);
  play_both ("cuts", shots);
  check_sum (LEAST_OF_ALL);
}

/* Ten pictures hidden altogether while the cloth moves on. */
static void
check_full (void)
{
  static const guint starts[] = { 6, 22, 38, 52 };

  for (Cover first = FULL_GREY; first <= FULL_NOISE; first++) {
    g_autoptr (GArray) shots = whole_film ();

    for (guint k = 0; k < G_N_ELEMENTS (starts); k++)
      for (guint n = 0; n < (k == 3 ? 6 : 10); n++)
        g_array_index (shots, Shot, starts[k] + n).cover = first;
    play_both (first == FULL_GREY ? "hidden by grey" : "hidden by noise",
        shots);
  }
  check_sum (LEAST_OF_ALL);
}

/* Across the board in thirty pictures, and back again. */
static void
sweep (GArray * shots, Cover cover, guint8 level, gfloat share)
{
  for (guint k = 0; k < shots->len; k++) {
    Shot *shot = &g_array_index (shots, Shot, k);
    const guint n = k % 60;

    shot->cover = cover;
    shot->level = level;
    shot->share = share;
    shot->at = (gfloat) (n < 30 ? n : 60 - n) / 30;
    shot->slope = n < 30 ? 1 : -1;
  }
}

static void
check_moving (void)
{
  static const guint8 levels[] = { 120, 235, 16 };
  static const gchar *const names[] = { "grey", "white", "black" };
  static const gfloat shares[] = { 0.25f, 0.4f, 0.6f };

  for (Cover cover = BAR; cover <= DISC; cover++)
    for (guint level = 0; level < G_N_ELEMENTS (levels); level++)
      for (guint share = 0; share < G_N_ELEMENTS (shares); share++) {
        g_autoptr (GArray) shots = whole_film ();
        g_autofree gchar *name = g_strdup_printf ("a %s %s over %.0f%% of the "
            "board", names[level], cover == BAR ? "bar" : "disc",
            100 * shares[share]);

        sweep (shots, cover, levels[level], shares[share]);
        play_both (name, shots);
      }
  check_sum (LEAST_OF_ALL);
}

static void
check_shadow (void)
{
  static const gfloat angles[] = { 0, 0.5f, 1.57f, 2.4f };

  for (guint angle = 0; angle < G_N_ELEMENTS (angles); angle++)
    for (gint moves = 0; moves < 2; moves++) {
      g_autoptr (GArray) shots = whole_film ();
      g_autofree gchar *name = g_strdup_printf ("a %s shadow at %.2f rad",
          moves ? "moving" : "standing", angles[angle]);

      for (guint k = 0; k < shots->len; k++) {
        Shot *shot = &g_array_index (shots, Shot, k);

        shot->shadow = TRUE;
        shot->shadow_angle = angles[angle];
        shot->shadow_at = moves ? (gfloat) (k % 30) / 30 : 0.5f;
      }
      play_both (name, shots);
    }
  check_sum (LEAST_OF_SHADED);
}

static void
check_all (void)
{
  static const guint cuts[][2] =
      { {0, 17}, {40, 62}, {10, 30}, {55, 35}, {4, 24} };

  for (guint variant = 0; variant < 4; variant++) {
    g_autoptr (GArray) shots = g_array_new (FALSE, FALSE, sizeof (Shot));
    g_autofree gchar *name = g_strdup_printf ("everything, film %u", variant);

    for (guint k = 0; k < G_N_ELEMENTS (cuts); k++)
      append (shots, cuts[k][0], cuts[k][1]);
    sweep (shots, variant & 1 ? BAR : DISC, variant & 2 ? 235 : 40, 0.3f);
    for (guint k = 0; k < shots->len; k++) {
      Shot *shot = &g_array_index (shots, Shot, k);

      shot->shadow = TRUE;
      shot->shadow_angle = 0.4f + (gfloat) variant;
      shot->shadow_at = (gfloat) ((k + 11) % 45) / 45;
      if (k % 37 >= 27)
        shot->cover = variant & 1 ? FULL_GREY : FULL_NOISE;
    }
    play_both (name, shots);
  }
  check_sum (LEAST_OF_MIXED);
}

int
main (int argc, char **argv)
{
  int result;

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  film = test_film_load (TEST_DATA "/checker_pair");
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++)
    plain[camera] = test_play_plain (film, camera);
  g_test_add_func ("/film/disturbed/cuts", check_cuts);
  g_test_add_func ("/film/disturbed/full", check_full);
  g_test_add_func ("/film/disturbed/moving", check_moving);
  g_test_add_func ("/film/disturbed/shadow", check_shadow);
  g_test_add_func ("/film/disturbed/all", check_all);
  result = g_test_run ();
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++)
    g_free (plain[camera]);
  test_film_free (film);
  return result;
}
