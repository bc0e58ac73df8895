/* Films made at random from the rendered cloth: cuts, still pictures, changes of light,
 * shadows, and occluders of any shape and look, other checkerboards and striped cloths
 * among them. The truth is that of the film, where it is not covered.
 *
 *   pipelines-film-random FIRST COUNT [FOLDER]
 *
 * plays that many films from that seed on and prints a line for each that has a fault and
 * one for all; into the folder go the pictures with faults.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/gst.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/common/play.h"

#define PICTURES 60
#define MOST_OCCLUDERS 3

typedef enum
{ BAR, DISC, BOX, FENCE, N_SHAPES } Shape;
typedef enum
{ FLAT, NOISE, RAMP, STRIPES, CHECKER, N_LOOKS } Look;

/* What something looks like, in coordinates of its own. */
typedef struct
{
  Look look;
  gfloat dark, bright;          /* grey levels */
  gfloat pitch;                 /* of stripes and squares, px */
  gfloat cosine, sine;
} Paint;

/* A thing before the cloth that moves there and back. Places are relative to the board's
 * box: 0 its middle, 1 half its size away. */
typedef struct
{
  Shape shape;
  Paint paint;
  gfloat from[2], to[2];
  gfloat period, phase;         /* pictures of a way there and back; 0: it stands */
  gfloat cosine, sine;
  gfloat half[2];               /* px */
  guint first, last;            /* pictures in which it is there */
} Occluder;

typedef struct
{
  gboolean there;
  gfloat strength;              /* what is left of the light */
  gfloat soft;                  /* width of its edge, px */
  gfloat cosine, sine;
  gfloat from, to, period;
} Shadow;

typedef struct
{
  guint camera;
  guint frames[PICTURES];
  gfloat gain[PICTURES];
  gint8 full[PICTURES];         /* covered altogether, by a paint of its own */
  Paint full_paint[2];
  Occluder occluders[MOST_OCCLUDERS];
  guint n_occluders;
  Shadow shadow;
  gfloat noise;                 /* half its range, grey levels */
} Film;

static TestFilm *film;
static guint8 *plain[TEST_FILM_CAMERAS];

static gfloat
between (GRand * rand, gdouble a, gdouble b)
{
  return (gfloat) g_rand_double_range (rand, a, b);
}

static gboolean
chance (GRand * rand, gdouble p)
{
  return g_rand_double (rand) < p;
}

static Paint
invent_paint (GRand * rand)
{
  const gfloat angle = between (rand, 0, G_PI);
  Paint paint = { (Look) g_rand_int_range (rand, 0, N_LOOKS) };

  /* A plain thing is the commonest, and another checkerboard the hardest. */
  if (paint.look == NOISE)
    paint.look = chance (rand, 0.5) ? FLAT : CHECKER;
  paint.dark = between (rand, 10, 160);
  paint.bright = paint.dark + between (rand, 25, 235 - (gdouble) paint.dark);
  if (paint.look == FLAT)
    paint.dark = between (rand, 5, 250);
  paint.pitch = between (rand, 9, 40);
  paint.cosine = cosf (angle);
  paint.sine = sinf (angle);
  return paint;
}

static void
invent_occluder (Occluder * own, const gfloat box[4], GRand * rand)
{
  const gfloat size = hypotf (box[2] - box[0], box[3] - box[1]);
  const gfloat angle = chance (rand, 0.3) ? (chance (rand, 0.5) ? 0
      : (gfloat) G_PI_2) : between (rand, 0, G_PI);

  *own = (Occluder) {
  (Shape) g_rand_int_range (rand, 0, N_SHAPES), invent_paint (rand)};
  for (gint k = 0; k < 2; k++) {
    own->from[k] = between (rand, -1.6, 1.6);
    own->to[k] = between (rand, -1.6, 1.6);
    own->half[k] = size * between (rand, 0.06, 0.35);
  }
  if (own->shape == FENCE)
    own->half[0] = size * between (rand, 0.02, 0.08);
  own->period = chance (rand, 0.2) ? 0 : between (rand, 15, 90);
  own->phase = between (rand, 0, 1);
  own->cosine = cosf (angle);
  own->sine = sinf (angle);
  own->first = chance (rand, 0.7) ? 0
      : (guint) g_rand_int_range (rand, 0, PICTURES / 2);
  own->last = chance (rand, 0.7) ? PICTURES
      : own->first + (guint) g_rand_int_range (rand, 4, PICTURES / 2);
}

/* Which frame is shown when: pieces of the film forth and back, some of them still. */
static void
invent_frames (Film * made, GRand * rand)
{
  const gboolean cuts = chance (rand, 0.7);
  guint k = 0;

  while (k < PICTURES) {
    const guint length = cuts ? (guint) g_rand_int_range (rand, 5, 30)
        : PICTURES;
    const gboolean still = chance (rand, cuts ? 0.15 : 0.05);
    gint step = still ? 0 : chance (rand, 0.5) ? 1 : -1;
    gint frame = g_rand_int_range (rand, 0, (gint32) film->n_frames);

    for (guint n = 0; n < length && k < PICTURES; n++, k++) {
      made->frames[k] = (guint) frame;
      if (frame + step < 0 || frame + step >= (gint) film->n_frames)
        step = -step;
      frame += step;
    }
  }
}

static void
invent_light (Film * made, GRand * rand)
{
  const gfloat first = chance (rand, 0.5) ? 1 : between (rand, 0.5, 1.25);
  const gfloat second = chance (rand, 0.6) ? first : between (rand, 0.5, 1.25);
  const gint from = g_rand_int_range (rand, 0, PICTURES);
  const gint over = chance (rand, 0.5) ? 1 : g_rand_int_range (rand, 2, 30);
  const gfloat flicker = chance (rand, 0.8) ? 0 : between (rand, 0, 0.15);

  for (gint k = 0; k < PICTURES; k++) {
    const gfloat share = CLAMP ((gfloat) (k - from) / (gfloat) over, 0.0f,
        1.0f);

    made->gain[k] = (first + share * (second - first))
        * (1 + flicker * between (rand, -1, 1));
  }
}

static void
invent (Film * made, guint seed)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (seed);
  gfloat box[4], angle;

  *made = (Film) {
  0};
  made->camera = (guint) g_rand_int_range (rand, 0, TEST_FILM_CAMERAS);
  invent_frames (made, rand);
  invent_light (made, rand);
  test_film_box (film, made->camera, made->frames[0], box);
  made->n_occluders = (guint) g_rand_int_range (rand, 0, MOST_OCCLUDERS + 1);
  for (guint k = 0; k < made->n_occluders; k++)
    invent_occluder (&made->occluders[k], box, rand);
  for (gint n = chance (rand, 0.3) ? g_rand_int_range (rand, 1, 3) : 0; n > 0;
      n--) {
    const guint from = (guint) g_rand_int_range (rand, 3, PICTURES - 5);
    const guint to = from + (guint) g_rand_int_range (rand, 2, 16);

    made->full_paint[n - 1] = invent_paint (rand);
    for (guint k = from; k < MIN (to, PICTURES); k++)
      made->full[k] = (gint8) n;
  }
  angle = between (rand, 0, 2 * G_PI);
  made->shadow = (Shadow) {
    chance (rand, 0.5), between (rand, 0.15, 0.85), chance (rand, 0.5) ? 0
        : between (rand, 0.5, 6), cosf (angle), sinf (angle)
  };
  made->shadow.from = between (rand, -1.2, 1.2);
  made->shadow.to = between (rand, -1.2, 1.2);
  made->shadow.period = chance (rand, 0.3) ? 0 : between (rand, 20, 100);
  made->noise = chance (rand, 0.5) ? 0 : between (rand, 0, 6);
}

/* Signed distance to the nearest edge of stripes, cut off one pixel away. */
static inline gfloat
stripe (gfloat u, gfloat pitch)
{
  const gfloat n = floorf (u / pitch), within = u - n * pitch;
  const gfloat distance = MIN (MIN (within, pitch - within), 1.0f);

  return ((gint) n & 1) ? -distance : distance;
}

static gfloat
look_of (const Paint * paint, gfloat x, gfloat y, GRand * rand)
{
  const gfloat u = paint->cosine * x + paint->sine * y;
  const gfloat v = paint->cosine * y - paint->sine * x;
  gfloat share = 0;

  switch (paint->look) {
    case NOISE:
      return between (rand, (gdouble) paint->dark, (gdouble) paint->bright);
    case RAMP:
      share = CLAMP (u / 200 + 0.5f, 0.0f, 1.0f);
      break;
    case STRIPES:
      share = 0.5f + 0.5f * stripe (u, paint->pitch);
      break;
    case CHECKER:
      share = 0.5f + 0.5f * stripe (u, paint->pitch) * stripe (v, paint->pitch);
      break;
    default:
      break;
  }
  return paint->dark + share * (paint->bright - paint->dark);
}

/* There and back, evenly. */
static gfloat
swing (gfloat at, gfloat period)
{
  const gfloat turns = period > 0 ? at / period : 0.0f;

  return fabsf (2 * (turns - floorf (turns)) - 1);
}

static gboolean
hides (const Occluder * own, gfloat x, gfloat y)
{
  const gfloat u = own->cosine * x + own->sine * y;
  const gfloat v = own->cosine * y - own->sine * x;

  switch (own->shape) {
    case BAR:
      return fabsf (u) < own->half[0];
    case DISC:
      return hypotf (u, v) < own->half[0];
    case BOX:
      return fabsf (u) < own->half[0] && fabsf (v) < own->half[1];
    default:
      return fabsf (u - 3 * own->half[0] * roundf (u / (3 * own->half[0])))
          < 0.5f * own->half[0];
  }
}

static void
draw (const Film * made, guint k, GRand * rand, guint8 * luma, guint8 * cover)
{
  const gint width = film->width, height = film->height;
  const guint8 *from = test_film_picture (film, made->camera, made->frames[k]);
  const Shadow *shadow = &made->shadow;
  gfloat box[4], middle[2], half[2], place[MOST_OCCLUDERS][2], edge, reach;

  test_film_box (film, made->camera, made->frames[k], box);
  for (gint way = 0; way < 2; way++) {
    middle[way] = 0.5f * (box[way] + box[way + 2]);
    half[way] = 0.5f * (box[way + 2] - box[way]);
  }
  reach = hypotf (half[0], half[1]);
  for (guint n = 0; n < made->n_occluders; n++) {
    const Occluder *own = &made->occluders[n];
    const gfloat share = swing ((gfloat) k + own->phase * own->period,
        own->period);

    for (gint way = 0; way < 2; way++)
      place[n][way] = middle[way] + half[way] * (own->from[way]
          + share * (own->to[way] - own->from[way]));
  }
  edge = reach * (shadow->from + swing ((gfloat) k, shadow->period)
      * (shadow->to - shadow->from));
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      const gint at = y * width + x;
      gfloat level = from[at];

      cover[at] = made->full[k] != 0;
      if (cover[at])
        level = look_of (&made->full_paint[made->full[k] - 1], (gfloat) x,
            (gfloat) y, rand);
      for (guint n = 0; n < made->n_occluders && !made->full[k]; n++) {
        const Occluder *own = &made->occluders[n];
        const gfloat dx = (gfloat) x - place[n][0];
        const gfloat dy = (gfloat) y - place[n][1];

        if (k < own->first || k >= own->last || !hides (own, dx, dy))
          continue;
        level = look_of (&own->paint, dx, dy, rand);
        cover[at] = 1;
      }
      if (shadow->there) {
        const gfloat beyond = ((gfloat) x - middle[0]) * shadow->cosine
            + ((gfloat) y - middle[1]) * shadow->sine - edge;
        const gfloat lit = shadow->soft > 0 ? CLAMP (beyond / shadow->soft,
            0.0f, 1.0f) : (gfloat) (beyond > 0);

        level *= shadow->strength + lit * (1 - shadow->strength);
      }
      level *= made->gain[k];
      if (made->noise > 0)
        level += made->noise * (gfloat) (g_rand_int (rand) & 0xff) / 127.5f
            - made->noise;
      luma[at] = (guint8) CLAMP (level + 0.5f, 0.0f, 255.0f);
    }
}

typedef struct
{
  guint wrong, tracked, hit, visible, found, reappeared, films, faulty;
} Sum;

static void
save (const gchar * folder, guint seed, guint k, const guint8 * luma)
{
  g_autofree gchar *name = g_strdup_printf ("%s/%u-%02u.pgm", folder, seed, k);
  FILE *file = fopen (name, "wb");

  g_assert_nonnull (file);
  fprintf (file, "P5\n%d %d\n255\n", film->width, film->height);
  fwrite (luma, 1, (gsize) film->width * (gsize) film->height, file);
  fclose (file);
}

static void
play (guint seed, const gchar * folder, Sum * sum)
{
  const gsize size = (gsize) film->width * (gsize) film->height;
  g_autofree guint8 *luma = g_malloc (size), *cover = g_malloc (size);
  g_autofree gchar *what = g_strdup_printf ("film %u", seed);
  g_autoptr (GRand) rand = g_rand_new_with_seed (seed);
  g_auto (TestPlay) play = { 0 };
  guint wrong = 0;
  Film made;

  invent (&made, seed);
  test_play_init (&play, film, made.camera, plain[made.camera],
      folder ? what : NULL);
  for (guint k = 0; k < PICTURES; k++) {
    draw (&made, k, rand, luma, cover);
    test_play_show (&play, made.frames[k], k > 0 && !made.full[k]
        && made.full[k - 1], luma, cover);
    if (folder && play.sum.faults > wrong)
      save (folder, seed, k, luma);
    wrong = play.sum.faults;
  }
  if (wrong > 0)
    g_print ("# film %u: %u wrong of %u; %u of %u found again\n", seed, wrong,
        play.sum.tracked, play.found, play.reappeared);
  sum->wrong += wrong;
  sum->tracked += play.sum.tracked;
  sum->hit += play.sum.hit;
  sum->visible += play.sum.visible;
  sum->found += play.found;
  sum->reappeared += play.reappeared;
  sum->films++;
  sum->faulty += wrong > 0;
}

static void
play_all (guint first, guint count, const gchar * folder, Sum * sum)
{
  *sum = (Sum) {
  0};
  for (guint k = 0; k < count; k++)
    play (first + k, folder, sum);
  g_print
      ("# %u films from seed %u: %u wrong of %u tracked (%.2f per 1,000) in "
      "%u films; %u of %u squares that came into sight found again within %d "
      "pictures (%.1f%%); %.1f%% of all visible tracked\n", sum->films, first,
      sum->wrong, sum->tracked, 1000.0 * sum->wrong / MAX (sum->tracked, 1),
      sum->faulty, sum->found, sum->reappeared, TEST_PLAY_SOON,
      100.0 * sum->found / MAX (sum->reappeared, 1),
      100.0 * sum->hit / MAX (sum->visible, 1));
}

int
main (int argc, char **argv)
{
  Sum sum;

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  if (argc < 3) {
    g_printerr ("Usage: %s FIRST COUNT [FOLDER]\n", argv[0]);
    return 2;
  }
  film = test_film_load (TEST_DATA "/checker_pair");
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++)
    plain[camera] = test_play_plain (film, camera);
  play_all ((guint) atoi (argv[1]), (guint) atoi (argv[2]),
      argc > 3 ? argv[3] : NULL, &sum);
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++)
    g_free (plain[camera]);
  test_film_free (film);
  return sum.wrong > 0;
}
