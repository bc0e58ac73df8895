/* From the disparities of two baselines to those of a surface: times of each step, and how
 * far depths are from the truth, on the film of a rendered cloth at 18 mm a pixel. Beside
 * them what D. Pritchard and W. Heidrich say of theirs (“Cloth Motion Capture”, 2003, table
 * 2): 2 min 46 s a picture of this size on one Pentium IV of 1.8 GHz, holes and fractions
 * together.
 *
 * The mask is that of the truth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/disparity.h"

#include <gst/gst.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "gst/cv/cv.h"
#include "gst/rig/rigfile.h"
#include "gst/vision/stereo/stereo.h"
#include "tests/common/picture.h"
#include "tests/common/stereo.h"

#define PAPER_MS 166e3
#define ROUNDS 5
/* From this picture on the cloth shows its back, too, and is folded onto itself. */
#define BACK 12
#define LEAST 32
#define RANGE 128
/* Depths that are further off are of another surface, mm. */
#define WILD 20

typedef enum
{
  INTEGER, INTEGER_FILLED, INTEGER_SMOOTH, MERGED, MERGED_FILLED,
  MERGED_SMOOTH, REFINED, HEAD, N_STAGES
} Stage;

static const gchar *const names[] = { "whole px of one baseline",
  "the same, holes filled", "the same, fractions", "two baselines, 1/16 px",
  "the same, holes filled", "the same, smoothed",
  "refined by the pictures", "the head as a whole"
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
  ClothCvStereo *stereo;
  ClothDisparity *surface;
  ClothRefine *refine;
  ClothRig *rig;
  ClothStereo *head;
  guint8 *mask;
  ClothPool *pool;
  gint16 *found[2];
  guint8 *mirrored[2];
  gfloat *truth;
  ClothDisparityMap map;
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
mirror (const Bench * bench, const guint8 * from, guint8 * to)
{
  const gint width = bench->film->width;

  for (gint y = 0; y < bench->film->height; y++)
    for (gint x = 0; x < width; x++)
      to[y * width + x] = from[y * width + width - 1 - x];
}

static void
match (Bench * bench, guint frame)
{
  const TestStereo *film = bench->film;
  const gint w = film->width, h = film->height;
  const ClothCvPicture middle = { test_stereo_picture (film, 0, frame), w, h,
    w
  };
  const ClothCvPicture right = { test_stereo_picture (film, 1, frame), w, h,
    w
  };
  const ClothCvPicture one = { bench->mirrored[0], w, h, w };
  const ClothCvPicture other = { bench->mirrored[1], w, h, w };

  mirror (bench, middle.data, bench->mirrored[0]);
  mirror (bench, test_stereo_picture (film, 2, frame), bench->mirrored[1]);
  if (!cloth_cv_stereo_run (bench->stereo, &middle, &right, bench->found[0],
          NULL) || !cloth_cv_stereo_run (bench->stereo, &one, &other,
          bench->found[1], NULL))
    g_error ("no disparities");
}

static void
set_mask (Bench * bench)
{
  for (gsize i = 0; i < bench->n; i++)
    bench->map.states[i] = isnan (bench->truth[i]) ? CLOTH_DISPARITY_OUTSIDE :
        CLOTH_DISPARITY_MEASURED;
}

static void
merge (Bench * bench, guint n_pairs)
{
  const gint w = bench->film->width, h = bench->film->height;
  const gdouble place[9] = { -1, 0, w - 1, 0, 1, 0, 0, 0, 1 };
  ClothDisparityPair pairs[2];

  for (gint k = 0; k < 2; k++)
    pairs[k] = cloth_disparity_pair (bench->found[k], w, h);
  memcpy (pairs[1].place, place, sizeof (place));
  set_mask (bench);
  if (!cloth_disparity_merge (pairs, n_pairs, 0.7, &bench->map, bench->pool,
          NULL))
    g_error ("not merged");
}

static void
score (Bench * bench, guint frame, Stage stage)
{
  const gdouble scale = 1e3 * bench->film->focal * bench->film->baseline;
  Score *to = &bench->scores[frame >= BACK][stage];

  for (gsize i = 0; i < bench->n; i++)
    if (!isnan (bench->truth[i])) {
      const gdouble off = scale / (gdouble) bench->map.disparities[i]
          - scale / (gdouble) bench->truth[i];

      to->n++;
      if (bench->map.states[i] < CLOTH_DISPARITY_MEASURED)
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
    const gfloat *d = bench->map.disparities + i;
    const gfloat tone = 128 + 120 * (d[0] - d[-1]) + 120 * (d[0] - *(d - w));

    if (bench->map.states[i] >= CLOTH_DISPARITY_MEASURED && isfinite (tone))
      shade[i] = (guint8) CLAMP (tone, 1, 255);
  }
  test_picture_keep (file, shade, w, bench->film->height);
}

static void
fill (Bench * bench, const ClothDisparityParams * params)
{
  if (!cloth_disparity_fill (bench->surface, params, &bench->map, bench->pool,
          CLOTH_SIMD_BEST, NULL))
    g_error ("not filled");
}

static void
smooth (Bench * bench, const ClothDisparityParams * params)
{
  if (!cloth_disparity_smooth (bench->surface, params, &bench->map,
          bench->pool, CLOTH_SIMD_BEST, NULL))
    g_error ("not smoothed");
}

static ClothImage
view (const Bench * bench, guint camera, guint frame)
{
  const TestStereo *film = bench->film;

  return (ClothImage) {
  test_stereo_picture (film, camera, frame), film->width, film->height,
        film->width};
}

static void
refine (Bench * bench, guint frame)
{
  const ClothRefineParams params = cloth_refine_default_params ();
  const ClothImage image = view (bench, 0, frame);
  const ClothRefineView views[2] = { {view (bench, 1, frame), {-1, 0}},
  {view (bench, 2, frame), {1, 0}}
  };

  if (!cloth_refine_run (bench->refine, &params, &image, views, 2, &bench->map,
          bench->pool, NULL))
    g_error ("not refined");
}

/* What the paper has: whole numbers, within half a pixel. */
static void
do_integers (Bench * bench, guint frame)
{
  const ClothDisparityParams params = cloth_disparity_default_params ();

  merge (bench, 1);
  for (gsize i = 0; i < bench->n; i++)
    bench->map.disparities[i] = rintf (bench->map.disparities[i]);
  score (bench, frame, INTEGER);
  fill (bench, &params);
  score (bench, frame, INTEGER_FILLED);
  smooth (bench, &params);
  score (bench, frame, INTEGER_SMOOTH);
  keep (bench, "integer", frame);
}

static ClothDisparityParams
get_sixteenths (void)
{
  ClothDisparityParams params = cloth_disparity_default_params ();

  params.half_width = 0.3;
  params.narrowing = 0.7;
  return params;
}

/* Of what the pictures have refined. */
static ClothDisparityParams
get_settled (void)
{
  ClothDisparityParams params = cloth_disparity_default_params ();

  params.half_width = cloth_stereo_default_params ().settle;
  params.narrowing = 1;
  return params;
}

static void
do_sixteenths (Bench * bench, guint frame)
{
  const ClothDisparityParams params = get_sixteenths ();
  const ClothDisparityParams settled = get_settled ();

  merge (bench, 2);
  score (bench, frame, MERGED);
  keep (bench, "merged", frame);
  fill (bench, &params);
  score (bench, frame, MERGED_FILLED);
  smooth (bench, &params);
  score (bench, frame, MERGED_SMOOTH);
  keep (bench, "smooth", frame);
  refine (bench, frame);
  smooth (bench, &settled);
  score (bench, frame, REFINED);
  keep (bench, "refined", frame);
}

/* All of it, as clothdisparity does: with the check from left to right and back. */
static ClothStereoResult
run_head (Bench * bench, guint frame)
{
  const ClothImage images[3] = { view (bench, 0, frame), view (bench, 1, frame),
    view (bench, 2, frame)
  };
  const ClothImage mask = { bench->mask, bench->film->width,
    bench->film->height, bench->film->width
  };
  ClothStereoResult result;

  for (gsize i = 0; i < bench->n; i++)
    bench->mask[i] = isnan (bench->truth[i]) ? 0 : 255;
  if (!cloth_stereo_run (bench->head, images, &mask, bench->pool, &result,
          NULL))
    g_error ("no disparities of the head");
  return result;
}

static void
do_head (Bench * bench, guint frame)
{
  const ClothDisparityMap own = bench->map;

  bench->map = run_head (bench, frame).map;
  score (bench, frame, HEAD);
  keep (bench, "head", frame);
  bench->map = own;
}

static void
time_steps (Bench * bench, guint frame)
{
  static const gchar *const steps[] = { "merging", "filling", "fractions",
    "refining", "smoothing again", "all of a head"
  };
  const ClothDisparityParams params = get_sixteenths ();
  const ClothDisparityParams settled = get_settled ();
  gdouble wall[G_N_ELEMENTS (steps)], processor[G_N_ELEMENTS (steps)], both;

  for (guint i = 0; i < G_N_ELEMENTS (steps); i++)
    wall[i] = processor[i] = G_MAXDOUBLE;
  for (gint round = 0; round < ROUNDS; round++)
    for (guint i = 0; i < G_N_ELEMENTS (steps); i++) {
      const gdouble start = wall_ms (), began = processor_ms ();

      if (i == 0)
        merge (bench, 2);
      else if (i == 1)
        fill (bench, &params);
      else if (i == 2)
        smooth (bench, &params);
      else if (i == 3)
        refine (bench, frame);
      else if (i == 4)
        smooth (bench, &settled);
      else
        run_head (bench, frame);
      wall[i] = MIN (wall[i], wall_ms () - start);
      processor[i] = MIN (processor[i], processor_ms () - began);
    }
  for (guint i = 0; i < G_N_ELEMENTS (steps); i++)
    g_print ("%s: %.1f ms by the wall's clock with %u threads, %.1f ms of "
        "processors\n", steps[i], wall[i],
        cloth_pool_get_n_threads (bench->pool), processor[i]);
  both = wall[1] + wall[2];
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
  ClothCvStereoParams params = cloth_cv_stereo_default_params ();
  const ClothStereoParams of_head = cloth_stereo_default_params ();
  const ClothCamera *cameras[3];
  Bench bench = { 0 };

  gst_init (&argc, &argv);
  params.least = LEAST;
  params.range = RANGE;
  params.window = 11;
  params.small_step = 8 * 11 * 11;
  params.large_step = 32 * 11 * 11;
  bench.film = test_stereo_load (TEST_DATA "/lineart_stereo3");
  bench.stereo = cloth_cv_stereo_new (&params, NULL);
  bench.surface = cloth_disparity_new ();
  bench.refine = cloth_refine_new ();
  bench.rig = cloth_rig_load (TEST_DATA "/lineart_stereo3/rig.json", NULL);
  for (guint i = 0; i < 3; i++)
    cameras[i] = &bench.rig->cameras[i];
  bench.head = cloth_stereo_new (cameras, 3, &of_head, NULL);
  bench.pool = cloth_pool_new (2);
  bench.n = (gsize) bench.film->width * (gsize) bench.film->height;
  for (gint k = 0; k < 2; k++) {
    bench.found[k] = g_new (gint16, bench.n);
    bench.mirrored[k] = g_malloc (bench.n);
  }
  bench.truth = g_new (gfloat, bench.n);
  bench.mask = g_malloc (bench.n);
  bench.map = (ClothDisparityMap) {
  g_new (gfloat, bench.n), g_malloc (bench.n), bench.film->width,
        bench.film->height, bench.film->width};
  for (guint frame = 0; frame < bench.film->n_frames; frame++) {
    test_stereo_truth (bench.film, frame, bench.truth);
    match (&bench, frame);
    do_integers (&bench, frame);
    do_sixteenths (&bench, frame);
    do_head (&bench, frame);
    if (frame == 5)
      time_steps (&bench, frame);
  }
  for (guint part = 0; part < 2; part++) {
    g_print ("pictures %s of %d x %d\n", part ? "that show the back, too," :
        "that show the front,", bench.film->width, bench.film->height);
    print_scores (bench.scores[part]);
  }
  cloth_cv_stereo_free (bench.stereo);
  cloth_disparity_free (bench.surface);
  cloth_refine_free (bench.refine);
  cloth_stereo_free (bench.head);
  cloth_rig_free (bench.rig);
  g_free (bench.mask);
  cloth_pool_free (bench.pool);
  test_stereo_free (bench.film);
  for (gint k = 0; k < 2; k++) {
    g_free (bench.found[k]);
    g_free (bench.mirrored[k]);
  }
  g_free (bench.truth);
  g_free (bench.map.disparities);
  g_free (bench.map.states);
  return 0;
}
