/* Features of a rendered film matched with those of its print, held against the truth: the
 * paper's tables 1 and 2.
 *
 *   bench-match FOLDER [--NAME=VALUE…]
 *
 * The folder is one of matchfilm.h; without it there is nothing to do. Times of matching and
 * verification are the best of three rounds; those of frames are of all threads together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/match.h"

#include <cairo.h>
#include <gst/gst.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "gst/rig/rigfile.h"
#include "gst/vision/mask/mask.h"
#include "gst/vision/stereo/stereo.h"
#include "tests/bench/matchfilm.h"

/* What counts as right, m in uv. */
#define RIGHT 0.003
/* What shows the right part, but is seen a little beside its place. */
#define BESIDE 0.006
#define ROUNDS 3
/* Motion in the picture, px from frame to frame: up to here. */
#define N_SPEEDS 6
static const gdouble speeds[N_SPEEDS] = { 2, 5, 10, 20, 40, INFINITY };

/* From pictures to their surface. */
#define N_STEPS 2
static const gchar *const steps[N_STEPS] = { "silhouette", "disparities" };

/* Of all threads on all processors, which other programs that run meanwhile change little; and
 * by the wall's clock. */
typedef struct
{
  gdouble processors, wall;
} Times;

typedef struct
{
  guint initial, matched, verified, right, beside, right_matched;
  guint oblique, quarter, back, n_frames;
  guint moving[N_SPEEDS], moving_verified[N_SPEEDS], moving_right[N_SPEEDS];
  Times sift, match, verify, depth[N_STEPS];
  guint64 depth_sum, match_sum; /* of all bytes found */
} Sums;

static gboolean no_surface, by_pictures;
static gchar *still, *pictures;

/* What is known of a frame without the truth. */
typedef struct
{
  ClothMask *mask;
  ClothRig *rig;
  ClothStereo *head;
  ClothDisparityMap map;        /* of the head */
  guint8 *inside;
  gfloat *points;
} Look;

static Times
now (void)
{
  struct timespec t;

  clock_gettime (CLOCK_PROCESS_CPUTIME_ID, &t);
  return (Times) {
  1e3 *(gdouble) t.tv_sec + 1e-6 * (gdouble) t.tv_nsec,
        1e-3 * (gdouble) g_get_monotonic_time ()};
}

static Times
since (Times start)
{
  const Times end = now ();

  return (Times) {
  end.processors - start.processors, end.wall - start.wall};
}

static void
add_times (Times * sum, Times times)
{
  sum->processors += times.processors;
  sum->wall += times.wall;
}

static void
keep_best (Times * best, Times times)
{
  best->processors = MIN (best->processors, times.processors);
  best->wall = MIN (best->wall, times.wall);
}

static void
print_times (const gchar * name, Times sum, gdouble n)
{
  g_print ("%s: %.1f ms of processors, %.1f ms of the wall\n", name,
      sum.processors / n, sum.wall / n);
}

/* A sum that tells whether another build gives the same bytes (G. Fowler, L. Noll, K. Vo). */
static void
add_bytes (guint64 * sum, gconstpointer data, gsize n)
{
  const guint8 *bytes = data;

  for (gsize i = 0; i < n; i++)
    *sum = (*sum ^ bytes[i]) * G_GUINT64_CONSTANT (0x100000001b3);
}

/* Runs of the mask as bytes. */
static void
take_mask (Look * look, const MatchFilm * film, guint frame, ClothPool * pool)
{
  const gint w = film->film.width, h = film->film.height;
  const ClothMaskParams params = cloth_mask_default_params ();
  const gsize n = (gsize) w * (gsize) h;
  const ClothPlanarImage image = { {film->film.pixels->data + frame * n, w, h,
      w}, {NULL, NULL}, 0, 0, {0, 0}
  };
  const ClothRun *runs;
  guint n_runs;

  cloth_mask_run (look->mask, &params, &image, pool, CLOTH_SIMD_BEST);
  runs = cloth_mask_get_runs (look->mask, &n_runs);
  memset (look->inside, 0, n);
  for (guint k = 0; k < n_runs; k++)
    memset (look->inside + runs[k].row * w + runs[k].begin, 255,
        runs[k].end - runs[k].begin);
}

/* The surface out of the pictures, as clothdisparity finds it. */
static void
look_at_depth (Look * look, const MatchFilm * film, guint frame,
    ClothPool * pool, Sums * sums)
{
  const gint w = film->film.width, h = film->film.height;
  const gsize n = (gsize) w * (gsize) h;
  const ClothStereoGeometry g = cloth_stereo_get_geometry (look->head);
  const ClothImage images[3] = { {film->film.pixels->data + frame * n, w, h,
      w}, {film->sides[0].pixels->data + frame * n, w, h, w},
  {film->sides[1].pixels->data + frame * n, w, h, w}
  };
  const ClothImage mask = { look->inside, w, h, w };
  ClothStereoResult result;
  Times start = now ();

  take_mask (look, film, frame, pool);
  add_times (&sums->depth[0], since (start));
  start = now ();
  if (!cloth_stereo_run (look->head, images, &mask, pool, &result, NULL))
    g_error ("no disparities");
  add_times (&sums->depth[1], since (start));
  look->map = result.map;
  add_bytes (&sums->depth_sum, look->map.disparities,
      n * sizeof *look->map.disparities);
  for (gsize i = 0; i < n; i++) {
    const gfloat *ray = g.rays + 2 * i;
    gfloat *to = look->points + 3 * i;
    gdouble scale;

    to[0] = to[1] = to[2] = NAN;
    if (look->map.states[i] < CLOTH_DISPARITY_MEASURED)
      continue;
    scale = g.focal_baseline / ((gdouble) look->map.disparities[i]
        * (g.normal[0] * ray[0] + g.normal[1] * ray[1] + g.normal[2]));
    to[0] = (gfloat) (scale * ray[0]);
    to[1] = (gfloat) (scale * ray[1]);
    to[2] = (gfloat) scale;
  }
}

static gboolean
is_right (const ClothReferenceFeatures * r, const MatchFilm * film,
    const MatchTruth * truth, gfloat x, gfloat y, guint32 match, gdouble far)
{
  gdouble uv[2];
  const gdouble u = (r->x[match] + 0.5) / r->width * film->cloth_m[0];
  const gdouble v = (r->y[match] + 0.5) / r->height * film->cloth_m[1];

  return match_truth_get_uv (truth, x, y, uv)
      && hypot (u - uv[0], v - uv[1]) <= far;
}

/* By how fast what a feature shows moves in the picture. */
static void
count_speed (const MatchFilm * film, guint frame, const MatchTruth * truth,
    gfloat x, gfloat y, gboolean verified, gboolean right, Sums * sums)
{
  const guint last = frame > 0 ? frame - 1 : 0;
  const guint next = MIN (frame + 1, film->n_frames - 1);
  gdouble uv[2], from[2], to[2], speed;
  gint bin = 0;

  if (next == last || !match_truth_get_uv (truth, x, y, uv))
    return;
  match_film_place (film, last, uv, from);
  match_film_place (film, next, uv, to);
  speed = hypot (to[0] - from[0], to[1] - from[1]) / (next - last);
  while (speed > speeds[bin])
    bin++;
  sums->moving[bin]++;
  sums->moving_verified[bin] += verified;
  sums->moving_right[bin] += right;
}

static void
dot (cairo_t * cr, gdouble x, gdouble y, guint colour)
{
  cairo_set_source_rgb (cr, (colour >> 16) / 255., (colour >> 8 & 255) / 255.,
      (colour & 255) / 255.);
  cairo_arc (cr, x + 0.5, y + 0.5, 1.8, 0, 2 * G_PI);
  cairo_fill (cr);
}

/* Features over the picture: verified and right in green, wrong in red; refused ones that
 * were right in blue, wrong in orange; those without a match in grey. What has no depth is
 * dark. */
static void
draw_frame (const MatchFilm * film, guint frame, const ClothCvFeatures * f,
    const ClothMatch * matches, const ClothReferenceFeatures * r,
    const MatchTruth * truth, const Look * look)
{
  static const guint colours[2][2] = { {0xff9000, 0x3060ff},
  {0xff0000, 0x00c000}
  };
  const gint w = film->film.width, h = film->film.height;
  g_autofree gchar *path = g_strdup_printf ("%s/match-%02u.png", pictures,
      frame);
  cairo_surface_t *surface = cairo_image_surface_create (CAIRO_FORMAT_RGB24, w,
      h);
  guint8 *data = cairo_image_surface_get_data (surface);
  cairo_t *cr;

  for (gint y = 0; y < h; y++)
    for (gint x = 0; x < w; x++) {
      const gsize at = (gsize) y * (gsize) w + (gsize) x;
      const guint grey = film->film.pixels->data[frame * (gsize) w * h + at];
      const guint tone = by_pictures && look->inside[at]
          && look->map.states[at] < CLOTH_DISPARITY_MEASURED ?
          grey / 4 : 128 + grey / 2;
      guint32 *to = (guint32 *) (data + y * cairo_image_surface_get_stride
          (surface)) + x;

      *to = tone << 16 | tone << 8 | tone;
      if (by_pictures && !look->inside[at])
        *to = grey << 15 & 0x7f0000;
    }
  cairo_surface_mark_dirty (surface);
  cr = cairo_create (surface);
  for (gint pass = 0; pass < 3; pass++)
    for (guint i = 0; i < f->n; i++) {
      const ClothMatch *m = &matches[i];
      const gboolean verified = m->state == CLOTH_MATCH_MATCHED;
      const gboolean known = verified || m->state == CLOTH_MATCH_REFUSED;
      const gboolean right = known && is_right (r, film, truth, f->x[i],
          f->y[i], m->reference, RIGHT);

      if (pass != (known ? right || !verified ? 1 : 2 : 0))
        continue;
      dot (cr, f->x[i], f->y[i], known ? colours[verified][right] : 0x909090);
    }
  cairo_destroy (cr);
  if (cairo_surface_write_to_png (surface, path) != CAIRO_STATUS_SUCCESS)
    g_error ("%s: can't be written", path);
  cairo_surface_destroy (surface);
}

/* Two pictures beside each other, for documents. */
#define PART_WIDTH 300
#define PART_HEIGHT 226

static cairo_surface_t *
grey_surface (const guint8 * grey, gint width, gint height)
{
  cairo_surface_t *surface = cairo_image_surface_create (CAIRO_FORMAT_RGB24,
      width, height);
  guint8 *data = cairo_image_surface_get_data (surface);

  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++)
      ((guint32 *) (data + y * cairo_image_surface_get_stride (surface)))[x] =
          grey[y * width + x] * 0x10101u;
  cairo_surface_mark_dirty (surface);
  return surface;
}

/* One of two, with features as circles of their scale, and only every @every-th of them. */
static void
draw_part (cairo_t * cr, gint part, const guint8 * grey, gint width,
    gint height, guint n, const gfloat * x, const gfloat * y,
    const gfloat * scale, guint every)
{
  const gdouble zoom = MIN ((gdouble) PART_WIDTH / width,
      (gdouble) PART_HEIGHT / height);
  cairo_surface_t *surface = grey_surface (grey, width, height);

  cairo_save (cr);
  cairo_translate (cr, part * PART_WIDTH + 0.5 * (PART_WIDTH - zoom * width),
      0);
  cairo_scale (cr, zoom, zoom);
  cairo_set_source_surface (cr, surface, 0, 0);
  cairo_paint (cr);
  cairo_set_source_rgb (cr, 0.9, 0.1, 0.1);
  cairo_set_line_width (cr, 2);
  for (guint i = 0; i < n; i += every) {
    cairo_new_sub_path (cr);
    cairo_arc (cr, x[i] + 0.5, y[i] + 0.5, scale[i], 0, 2 * G_PI);
  }
  cairo_stroke (cr);
  cairo_restore (cr);
  cairo_surface_destroy (surface);
}

static void
keep (cairo_surface_t * surface, const gchar * name, guint frame)
{
  g_autofree gchar *path = g_strdup_printf ("%s/%s-%02u.png", pictures, name,
      frame);

  if (cairo_surface_write_to_png (surface, path) != CAIRO_STATUS_SUCCESS)
    g_error ("%s: can't be written", path);
}

/* Features of the print's flat view and of the film. */
static void
draw_parts (const MatchFilm * film, guint frame, const ClothCvFeatures * f,
    const ClothReferenceFeatures * r)
{
  const gint w = film->film.width, h = film->film.height;
  const guint8 *luma = film->film.pixels->data + frame * (gsize) w * h;
  g_autofree gfloat *x = g_new (gfloat, r->n), *y = g_new (gfloat, r->n);
  g_autofree gfloat *scale = g_new (gfloat, r->n);
  cairo_surface_t *surface = cairo_image_surface_create (CAIRO_FORMAT_RGB24,
      2 * PART_WIDTH, PART_HEIGHT);
  cairo_t *cr = cairo_create (surface);
  guint n = 0;

  for (guint i = 0; i < r->n; i++)
    if (r->view[i] == 0 && r->side[i] == 0) {
      x[n] = r->x[i];
      y[n] = r->y[i];
      scale[n++] = r->scale[i];
    }
  draw_part (cr, 0, film->reference.pixels->data, film->reference.width,
      film->reference.height, n, x, y, scale, 16);
  draw_part (cr, 1, luma, w, h, f->n, f->x, f->y, f->scale, 4);
  keep (surface, "features", frame);
  cairo_destroy (cr);
  cairo_surface_destroy (surface);
}

static void
run_frame (const MatchFilm * film, guint frame,
    const ClothReference * reference, ClothCvSift * sift,
    const ClothGrowParams * grow_params,
    const ClothVerifyParams * verify_params, ClothGrower * grower,
    ClothVerifier * verifier, ClothPool * pool, MatchTruth * truth,
    Look * look, Sums * sums)
{
  const ClothReferenceFeatures *r = cloth_reference_get_features (reference);
  const gint width = film->film.width, height = film->film.height;
  const ClothCvPicture picture = { film->film.pixels->data
        + (gsize) frame * width * height, width, height, width
  };
  const ClothCvPicture mask = { by_pictures ? look->inside : truth->mask,
    width, height, width
  };
  const ClothMatchSurface surface = { by_pictures ? look->points :
        truth->points, width, height, width
  };
  const ClothMatchSurface *under = no_surface ? NULL : &surface;
  g_autofree ClothMatch *matches = NULL;
  Times match = { G_MAXDOUBLE, G_MAXDOUBLE }, verify = match, start;
  guint right = 0, beside = 0, right_matched = 0, oblique = 0, back =
      0, quarter = 0;
  ClothCvFeatures f;
  ClothGrowth growth;
  ClothVerification verification;

  match_film_look (film, frame, truth);
  if (by_pictures)
    look_at_depth (look, film, frame, pool, sums);
  start = now ();
  if (!cloth_cv_sift_run (sift, &picture, &mask, &f, NULL))
    g_error ("no features");
  add_times (&sums->sift, since (start));
  matches = g_new (ClothMatch, f.n);
  for (gint round = 0; round < ROUNDS; round++) {
    start = now ();
    cloth_grower_run (grower, grow_params, reference, &f, under, matches,
        &growth, pool, CLOTH_SIMD_BEST);
    keep_best (&match, since (start));
    if (round == 0)
      for (guint i = 0; i < f.n; i++)
        right_matched += matches[i].state == CLOTH_MATCH_MATCHED
            && is_right (r, film, truth, f.x[i], f.y[i], matches[i].reference,
            RIGHT);
    start = now ();
    cloth_verifier_run (verifier, verify_params, reference, &f, under, matches,
        &verification, pool);
    keep_best (&verify, since (start));
  }
  for (guint i = 0; i < f.n; i++) {
    const ClothMatch *m = &matches[i];
    const gboolean verified = m->state == CLOTH_MATCH_MATCHED;

    count_speed (film, frame, truth, f.x[i], f.y[i], verified, verified
        && is_right (r, film, truth, f.x[i], f.y[i], m->reference, RIGHT),
        sums);
    if (!verified)
      continue;
    right += is_right (r, film, truth, f.x[i], f.y[i], m->reference, RIGHT);
    beside += is_right (r, film, truth, f.x[i], f.y[i], m->reference, BESIDE);
    oblique += r->view[m->reference] > 0;
    quarter += r->view[m->reference] > 4;
    back += r->side[m->reference];
  }
  if (pictures) {
    draw_frame (film, frame, &f, matches, r, truth, look);
    draw_parts (film, frame, &f, r);
  }
  g_print ("%5u  %7u  %7u (%4.1f%%)  %8u (%4.1f%%)  %6.2f%%  %4u %4u %5u  "
      "%4.0f%%  %5.0f%%  %5.1f  %5.1f\n", frame, f.n, growth.n_matched,
      100. * right_matched / MAX (growth.n_matched, 1),
      verification.n_verified, 100. * verification.n_verified / MAX (f.n, 1),
      100. * right / MAX (verification.n_verified, 1), growth.seeds_half,
      growth.seeds_most, growth.n_seeds,
      100. * oblique / MAX (verification.n_verified, 1),
      100. * back / MAX (verification.n_verified, 1), match.processors,
      verify.processors);
  sums->initial += f.n;
  sums->matched += growth.n_matched;
  sums->verified += verification.n_verified;
  sums->right += right;
  sums->beside += beside;
  sums->right_matched += right_matched;
  sums->oblique += oblique;
  sums->quarter += quarter;
  sums->back += back;
  add_times (&sums->match, match);
  add_times (&sums->verify, verify);
  add_bytes (&sums->match_sum, matches, f.n * sizeof *matches);
  sums->n_frames++;
}

static void
tell (const Sums * s, guint n_references)
{
  const gdouble n = MAX (s->n_frames, 1), v = MAX (s->verified, 1);

  g_print ("mean: %.0f features, %.0f matched (%.2f%% right), %.0f verified: "
      "%.1f%% (the paper 37%%), %.2f%% right within %.0f mm, %.2f%% within %.0f mm\n",
      s->initial / n,
      s->matched / n, 100. * s->right_matched / MAX (s->matched, 1),
      s->verified / n, 100. * s->verified / MAX (s->initial, 1),
      100 * s->right / v, 1e3 * RIGHT, 100 * s->beside / v, 1e3 * BESIDE);
  g_print ("verified from oblique views %.0f%% (the paper over half), from "
      "quarter views %.1f%%, from the back %.0f%%\n", 100 * s->oblique / v,
      100 * s->quarter / v, 100 * s->back / v);
  g_print ("among %u reference features\n", n_references);
  print_times ("features", s->sift, n);
  print_times ("matching (the paper 145 s)", s->match, n);
  print_times ("verification (the paper 26 s with the parameters)", s->verify,
      n);
  for (gint i = 0; i < N_SPEEDS; i++)
    g_print ("up to %.0f px a frame: %u features, %.1f%% verified, of these "
        "%.2f%% right\n", speeds[i], s->moving[i],
        100. * s->moving_verified[i] / MAX (s->moving[i], 1),
        100. * s->moving_right[i] / MAX (s->moving_verified[i], 1));
  for (gint i = 0; i < N_STEPS && by_pictures; i++)
    print_times (steps[i], s->depth[i], n);
  g_print ("bytes: disparities %016" G_GINT64_MODIFIER "x, matches %016"
      G_GINT64_MODIFIER "x\n", s->depth_sum, s->match_sum);
}

static void
look_init (Look * look, const MatchFilm * film)
{
  const ClothStereoParams params = cloth_stereo_default_params ();
  const ClothCamera *cameras[3];
  const gint w = film->film.width, h = film->film.height;
  const gsize n = (gsize) w * (gsize) h;
  const ClothPlanarImage background = { {film->background.pixels->data, w, h,
      w}, {NULL, NULL}, 0, 0, {0, 0}
  };

  look->mask = cloth_mask_new ();
  cloth_mask_set_background (look->mask, &background);
  look->rig = cloth_rig_load (TEST_DATA "/lineart_stereo3/rig.json", NULL);
  for (guint i = 0; i < 3; i++)
    cameras[i] = &look->rig->cameras[i];
  look->head = cloth_stereo_new (cameras, 3, &params, NULL);
  look->inside = g_malloc (n);
  look->points = g_new (gfloat, 3 * n);
}

static void
look_clear (Look * look)
{
  cloth_mask_free (look->mask);
  cloth_stereo_free (look->head);
  cloth_rig_free (look->rig);
  g_free (look->inside);
  g_free (look->points);
}

static void
run_film (const gchar * folder, const ClothReferenceParams * params,
    const ClothCvSiftParams * film_sift, const ClothGrowParams * grow_params,
    const ClothVerifyParams * verify_params, gint from, gint step)
{
  ClothReferenceParams with_size = *params;
  MatchFilm film;
  ClothCvPicture picture;
  g_autoptr (ClothReference) reference = NULL;
  g_autoptr (ClothPool) pool = cloth_pool_new (2);
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (film_sift, NULL);
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autoptr (GError) error = NULL;
  MatchTruth truth;
  Look look = { 0 };
  Sums sums = { 0 };
  const Times start = now ();

  match_film_load (&film, folder, still, by_pictures);
  with_size.cloth_m[0] = film.cloth_m[0];
  with_size.cloth_m[1] = film.cloth_m[1];
  picture = (ClothCvPicture) {
  film.reference.pixels->data, film.reference.width, film.reference.height,
        film.reference.width};
  reference = cloth_reference_new (&with_size, &picture, pool, &error);
  if (!reference)
    g_error ("%s", error->message);
  g_print ("%u reference features in %.1f s, %.2f%% repeated\n",
      cloth_reference_get_features (reference)->n,
      1e-3 * since (start).processors,
      100 * cloth_reference_get_repeated (reference));
  g_print ("frame  initial  matched (right)   verified           right  "
      "  50%%  80%%  seeds  oblique  back  match ms  verify ms\n");
  match_truth_init (&truth, film.film.width, film.film.height);
  if (by_pictures)
    look_init (&look, &film);
  for (guint frame = from; frame < film.n_frames; frame += step)
    run_frame (&film, frame, reference, sift, grow_params, verify_params,
        grower, verifier, pool, &truth, &look, &sums);
  tell (&sums, cloth_reference_get_features (reference)->n);
  match_truth_clear (&truth);
  if (by_pictures)
    look_clear (&look);
  match_film_clear (&film);
}

int
main (int argc, char **argv)
{
  ClothReferenceParams params = cloth_reference_default_params ();
  ClothGrowParams grow = cloth_grow_default_params ();
  ClothVerifyParams verify = cloth_verify_default_params ();
  ClothCvSiftParams film = params.sift;
  gint first = (gint) grow.first, least = (gint) grow.least, step = 1, from = 0;
  gint tries = (gint) grow.tries, support = (gint) verify.support;
  const GOptionEntry entries[] = {
    {"disparity", 0, 0, G_OPTION_ARG_NONE, &by_pictures,
        "surface and silhouette out of the pictures of three cameras, not of "
          "the truth", NULL},
    {"still", 0, 0, G_OPTION_ARG_FILENAME, &still,
        "where reference.png and background0.png are, if elsewhere", "FOLDER"},
    {"pictures", 0, 0, G_OPTION_ARG_FILENAME, &pictures,
        "draws what is right and wrong in each frame", "FOLDER"},
    {"no-surface", 0, 0, G_OPTION_ARG_NONE, &no_surface,
        "distances in the picture bound those on the cloth", NULL},
    {"step", 0, 0, G_OPTION_ARG_INT, &step, "every so many frames", "N"},
    {"sides", 0, 0, G_OPTION_ARG_INT, &params.sides, NULL, NULL},
    {"oblique", 0, 0, G_OPTION_ARG_INT, &params.oblique, NULL, NULL},
    {"contrast", 0, 0, G_OPTION_ARG_DOUBLE, &params.sift.contrast, NULL, NULL},
    {"film-contrast", 0, 0, G_OPTION_ARG_DOUBLE, &film.contrast, NULL, NULL},
    {"reference-scale", 0, 0, G_OPTION_ARG_DOUBLE, &params.least_scale, NULL,
        NULL},
    {"seed-scale", 0, 0, G_OPTION_ARG_DOUBLE, &params.seed_scale, NULL, NULL},
    {"radius", 0, 0, G_OPTION_ARG_DOUBLE, &grow.radius, NULL, NULL},
    {"distance", 0, 0, G_OPTION_ARG_DOUBLE, &grow.distance, NULL, NULL},
    {"seed", 0, 0, G_OPTION_ARG_DOUBLE, &grow.seed_distance, NULL, NULL},
    {"first", 0, 0, G_OPTION_ARG_INT, &first, NULL, NULL},
    {"least", 0, 0, G_OPTION_ARG_INT, &least, NULL, NULL},
    {"tries", 0, 0, G_OPTION_ARG_INT, &tries, NULL, NULL},
    {"least-scale", 0, 0, G_OPTION_ARG_DOUBLE, &grow.least_scale, NULL, NULL},
    {"turn", 0, 0, G_OPTION_ARG_DOUBLE, &grow.turn, NULL, NULL},
    {"zoom", 0, 0, G_OPTION_ARG_DOUBLE, &grow.zoom, NULL, NULL},
    {"stretch", 0, 0, G_OPTION_ARG_DOUBLE, &grow.stretch.stretch, NULL, NULL},
    {"slack", 0, 0, G_OPTION_ARG_DOUBLE, &grow.stretch.slack, NULL, NULL},
    {"depth-step", 0, 0, G_OPTION_ARG_DOUBLE, &grow.stretch.depth_step, NULL,
        NULL},
    {"hidden", 0, 0, G_OPTION_ARG_DOUBLE, &grow.stretch.hidden, NULL, NULL},
    {"vote", 0, 0, G_OPTION_ARG_DOUBLE, &verify.vote, NULL, NULL},
    {"group-vote", 0, 0, G_OPTION_ARG_DOUBLE, &verify.group_vote, NULL, NULL},
    {"from", 0, 0, G_OPTION_ARG_INT, &from, "first frame", "N"},
    {"support", 0, 0, G_OPTION_ARG_INT, &support, NULL, NULL},
    {"reach", 0, 0, G_OPTION_ARG_DOUBLE, &verify.reach, NULL, NULL},
    {"verify-stretch", 0, 0, G_OPTION_ARG_DOUBLE, &verify.stretch.stretch,
        NULL, NULL},
    {"verify-slack", 0, 0, G_OPTION_ARG_DOUBLE, &verify.stretch.slack, NULL,
        NULL},
    {NULL}
  };
  g_autoptr (GOptionContext) context = g_option_context_new ("FOLDER");
  g_autoptr (GError) error = NULL;

  g_option_context_add_main_entries (context, entries, NULL);
  if (!g_option_context_parse (context, &argc, &argv, &error))
    g_error ("%s", error->message);
  grow.first = (guint) first;
  grow.least = (guint) least;
  grow.tries = (guint) tries;
  verify.support = (guint) support;
  verify.stretch.depth_step = grow.stretch.depth_step;
  gst_init (&argc, &argv);
  if (argc > 1)
    run_film (argv[1], &params, &film, &grow, &verify, MAX (from, 0), MAX (step,
            1));
  else
    g_print ("no film: see --help\n");
  return 0;
}
