/* From the disparities of two baselines to those of a surface: times of each step, and how
 * far depths are from the truth, on the film of a rendered cloth at 18 mm a pixel. Beside
 * them what D. Pritchard and W. Heidrich say of theirs (“Cloth Motion Capture”, 2003, table
 * 2): 2 min 46 s a picture of this size on one Pentium IV of 1.8 GHz, holes and fractions
 * together.
 *
 * The mask is that of the truth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/gst.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "tests/bench/filmdepth.h"
#include "tests/common/picture.h"
#include "tests/common/stereo.h"

#define PAPER_MS 166e3
#define ROUNDS 5
/* From this picture on the cloth shows its back, too, and is folded onto itself. */
#define BACK 12
#define STEPS 6
/* Depths that are further off are of another surface, mm. */
#define WILD 20

typedef enum
{
  INTEGER, INTEGER_FILLED, INTEGER_SMOOTH, MERGED, MERGED_FILLED,
  MERGED_SMOOTH, REFINED, N_STAGES
} Stage;

static const gchar *const names[] = { "whole px of one baseline",
  "the same, holes filled", "the same, fractions", "two baselines, 1/16 px",
  "the same, holes filled", "the same, smoothed",
  "refined by the pictures"
};

/* Of the pixels of the mask: how many there are, have a depth, have a wild one; and the sum
 * of the others' squared errors, mm². */
typedef struct
{
  gdouble n, n_known, n_wild, sum;
} Score;

typedef struct
{
  TestStereo *film;
  FilmDepth depth;
  gfloat *truth;
  gsize n;
  Score scores[2][N_STAGES];    /* of the front's pictures, of the back's */
} Bench;

static gdouble
wall_ms (void)
{
  return 1e-3 * (gdouble) g_get_monotonic_time ();
}

/* Of all threads. */
static gdouble
processor_ms (void)
{
  return 1e3 * (gdouble) clock () / CLOCKS_PER_SEC;
}

static void
get_pictures (const Bench * bench, guint frame, const guint8 * pictures[3])
{
  for (guint k = 0; k < 3; k++)
    pictures[k] = test_stereo_picture (bench->film, k, frame);
}

static void
set_mask (Bench * bench)
{
  for (gsize i = 0; i < bench->n; i++)
    bench->depth.map.states[i] =
        isnan (bench->truth[i]) ? CLOTH_DISPARITY_OUTSIDE :
        CLOTH_DISPARITY_MEASURED;
}

static void
merge (Bench * bench, guint n_pairs)
{
  set_mask (bench);
  film_depth_merge (&bench->depth, n_pairs);
}

static void
score (Bench * bench, guint frame, Stage stage)
{
  const gdouble scale = 1e3 * bench->film->focal * bench->film->baseline;
  Score *to = &bench->scores[frame >= BACK][stage];

  for (gsize i = 0; i < bench->n; i++)
    if (!isnan (bench->truth[i])) {
      const gdouble off = scale / (gdouble) bench->depth.map.disparities[i]
          - scale / (gdouble) bench->truth[i];

      to->n++;
      if (bench->depth.map.states[i] < CLOTH_DISPARITY_MEASURED)
        continue;
      to->n_known++;
      if (fabs (off) > WILD)
        to->n_wild++;
      else
        to->sum += off * off;
    }
}

/* A picture for the eye: the depth's slopes in light from the left. */
static void
keep (const Bench * bench, const gchar * name, guint frame)
{
  const gint w = bench->film->width;
  g_autofree guint8 *shade = g_malloc0 (bench->n);
  g_autofree gchar *file = g_strdup_printf ("disparity-%s-%02u.pgm", name,
      frame);

  for (gsize i = (gsize) w; i + 1 < bench->n; i++) {
    const gfloat *d = bench->depth.map.disparities + i;
    const gfloat tone = 128 + 120 * (d[0] - d[-1]) + 120 * (d[0] - *(d - w));

    if (bench->depth.map.states[i] >= CLOTH_DISPARITY_MEASURED
        && isfinite (tone))
      shade[i] = (guint8) CLAMP (tone, 1, 255);
  }
  test_picture_keep (file, shade, w, bench->film->height);
}

/* What the paper has: whole numbers, within half a pixel. */
static void
do_integers (Bench * bench, guint frame)
{
  const ClothDisparityParams params = cloth_disparity_default_params ();

  merge (bench, 1);
  for (gsize i = 0; i < bench->n; i++)
    bench->depth.map.disparities[i] = rintf (bench->depth.map.disparities[i]);
  score (bench, frame, INTEGER);
  film_depth_fill (&bench->depth, &params);
  score (bench, frame, INTEGER_FILLED);
  film_depth_smooth (&bench->depth, &params);
  score (bench, frame, INTEGER_SMOOTH);
  keep (bench, "integer", frame);
}

static void
do_sixteenths (Bench * bench, guint frame)
{
  const ClothDisparityParams params = film_depth_sixteenths ();
  const ClothDisparityParams polish = film_depth_polish ();
  const guint8 *pictures[3];

  merge (bench, 2);
  score (bench, frame, MERGED);
  keep (bench, "merged", frame);
  film_depth_fill (&bench->depth, &params);
  score (bench, frame, MERGED_FILLED);
  film_depth_smooth (&bench->depth, &params);
  score (bench, frame, MERGED_SMOOTH);
  keep (bench, "smooth", frame);
  get_pictures (bench, frame, pictures);
  film_depth_refine (&bench->depth, pictures);
  film_depth_smooth (&bench->depth, &polish);
  score (bench, frame, REFINED);
  keep (bench, "refined", frame);
}

static void
time_steps (Bench * bench, guint frame)
{
  static const gchar *const steps[] = { "OpenCV's block matching, twice",
    "merging", "filling", "fractions", "refining", "smoothing again"
  };
  const ClothDisparityParams params = film_depth_sixteenths ();
  const ClothDisparityParams polish = film_depth_polish ();
  gdouble wall[STEPS], processor[STEPS], both = 0;
  const guint8 *pictures[3];

  get_pictures (bench, frame, pictures);
  for (gint i = 0; i < STEPS; i++)
    wall[i] = processor[i] = G_MAXDOUBLE;
  for (gint round = 0; round < ROUNDS; round++)
    for (gint i = 0; i < STEPS; i++) {
      const gdouble start = wall_ms (), began = processor_ms ();

      if (i == 0)
        film_depth_match (&bench->depth, pictures);
      else if (i == 1)
        merge (bench, 2);
      else if (i == 2)
        film_depth_fill (&bench->depth, &params);
      else if (i == 3)
        film_depth_smooth (&bench->depth, &params);
      else if (i == 4)
        film_depth_refine (&bench->depth, pictures);
      else
        film_depth_smooth (&bench->depth, &polish);
      wall[i] = MIN (wall[i], wall_ms () - start);
      processor[i] = MIN (processor[i], processor_ms () - began);
    }
  for (gint i = 0; i < STEPS; i++)
    g_print ("%s: %.1f ms by the wall's clock with %u threads, %.1f ms of "
        "processors\n", steps[i], wall[i],
        i > 1 ? cloth_pool_get_n_threads (bench->depth.pool) : 1, processor[i]);
  both = wall[2] + wall[3];
  g_print ("filling and fractions: %.1f ms; the paper's %.0f s, ratio %.0f\n",
      both, 1e-3 * PAPER_MS, PAPER_MS / both);
}

static void
print_scores (const Score * scores)
{
  for (guint i = 0; i < N_STAGES; i++) {
    const Score *s = &scores[i];

    g_print ("%-26s %5.1f%% of the mask, RMS %.2f mm; more than %d mm off: "
        "%.2f%%\n", names[i], 100 * s->n_known / s->n,
        sqrt (s->sum / (s->n_known - s->n_wild)), WILD,
        100 * s->n_wild / s->n_known);
  }
}

int
main (int argc, char **argv)
{
  Bench bench = { 0 };

  gst_init (&argc, &argv);
  bench.film = test_stereo_load (TEST_DATA "/lineart_stereo3");
  film_depth_init (&bench.depth, bench.film->width, bench.film->height);
  bench.n = (gsize) bench.film->width * (gsize) bench.film->height;
  bench.truth = g_new (gfloat, bench.n);
  for (guint frame = 0; frame < bench.film->n_frames; frame++) {
    const guint8 *pictures[3];

    test_stereo_truth (bench.film, frame, bench.truth);
    get_pictures (&bench, frame, pictures);
    film_depth_match (&bench.depth, pictures);
    do_integers (&bench, frame);
    do_sixteenths (&bench, frame);
    if (frame == 5)
      time_steps (&bench, frame);
  }
  for (guint part = 0; part < 2; part++) {
    g_print ("pictures %s of %d x %d\n", part ? "that show the back, too," :
        "that show the front,", bench.film->width, bench.film->height);
    print_scores (bench.scores[part]);
  }
  film_depth_clear (&bench.depth);
  test_stereo_free (bench.film);
  g_free (bench.truth);
  return 0;
}
