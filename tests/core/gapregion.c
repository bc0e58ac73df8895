/* Which vertices a residual is at and from when on, against residuals made by hand: noise
 * alone, and the answer of the observer's springs to a step of force in a patch.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/gap/localise/localisation.h"
#include "gst/gap/localise/null-distribution.h"
#include "gst/math/random.h"

#define COLUMNS 12
#define ROWS 10
#define N (COLUMNS * ROWS)
#define FPS 50.
#define FRAMES 100
#define SIGMA 4e-4
#define GAIN 1600.

/* A flat sheet at rest; what the residual is of is told apart from it. */
static ClothRecording *
record (guint n_frames, gdouble sigma)
{
  ClothRecording *r = g_new0 (ClothRecording, 1);

  r->scene = g_new0 (ClothScene, 1);
  r->scene->topology = cloth_topology_new_grid (COLUMNS, ROWS, 0.22f, 0.18f);
  r->n = N;
  r->n_frames = n_frames;
  r->sigma = sigma;
  r->times = g_new (gdouble, n_frames);
  r->y = g_new0 (gdouble, 3 * (gsize) N * n_frames);
  r->seen = g_new (gdouble, (gsize) N * n_frames);
  for (guint f = 0; f < n_frames; f++) {
    r->times[f] = 3. + f / FPS;
    for (guint v = 0; v < N; v++) {
      gsize at = (gsize) f * N + v;

      r->y[3 * at] = r->scene->topology->uv[2 * v];
      r->y[3 * at + 1] = -r->scene->topology->uv[2 * v + 1];
      r->seen[at] = 1.;
    }
  }
  return r;
}

static void
forget (ClothRecording * r)
{
  cloth_topology_free (r->scene->topology);
  g_free (r->scene);
  g_free (r->times);
  g_free (r->y);
  g_free (r->seen);
  g_free (r);
}

/* Noise that is alike to itself over some frames. */
static gfloat *
make_noise (guint n_frames, gdouble sigma, gdouble alike, guint64 seed)
{
  gsize row = 3 * N;
  gfloat *off = g_new0 (gfloat, row * n_frames);
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gsize i = 0; i < row * n_frames; i++)
    off[i] = (gfloat) (sigma * sqrt (i < row ? 1. : 1. - alike * alike) *
        cloth_random_gaussian (&random) + (i < row ? 0. : alike * off[i -
                row]));
  return off;
}

static gboolean
in_patch (guint v)
{
  return v % COLUMNS >= 7 && v % COLUMNS < 10 && v / COLUMNS >= 4
      && v / COLUMNS < 8;
}

/* What lacks a step of force from frame @begin on lies behind as a damped spring does:
 * x″ = a − gain·x − √gain·x′ (damping ratio 1/2), its neighbours by @drag of that. */
static void
add_step (gfloat * off, guint n_frames, guint begin, gdouble acceleration,
    gdouble drag)
{
  gdouble omega = sqrt (GAIN), damped = omega * sqrt (0.75);

  for (guint f = begin; f < n_frames; f++) {
    gdouble t = (f - begin) / FPS;
    gdouble x = acceleration / GAIN * (1. - exp (-omega * t / 2.) * (cos (damped
                * t) + omega / 2. / damped * sin (damped * t)));

    for (guint v = 0; v < N; v++) {
      gboolean beside = (v % COLUMNS && in_patch (v - 1))
          || (v % COLUMNS + 1 < COLUMNS && in_patch (v + 1))
          || (v >= COLUMNS && in_patch (v - COLUMNS))
          || (v + COLUMNS < N && in_patch (v + COLUMNS));

      off[3 * ((gsize) f * N + v) + 2] -= (gfloat) (x * (in_patch (v) ? 1. :
              beside ? drag : 0.));
    }
  }
}

static ClothLocalisation *
find (ClothRecording * take, const gfloat * off, ClothRecording * null,
    const gfloat * null_off, gboolean alike)
{
  const ClothNudgedResidual nudged = { take, off }, null_nudged =
      { null, null_off };
  ClothLocalisationOptions options;

  cloth_localisation_options_init (&options);
  options.seed = 7;
  return cloth_localisation_new (&nudged, &null_nudged, 1, alike, &options);
}

static void
assert_patch (const ClothLocalisation * region)
{
  guint both = 0;

  for (guint i = 0; i < region->vertices->len; i++)
    both += in_patch (g_array_index (region->vertices, guint, i));
  g_test_message ("%u vertices, %u of the patch's 12, from frame %u",
      region->vertices->len, both, region->onset);
  g_assert_cmpuint (both, ==, 12);
  g_assert_cmpuint (region->vertices->len, ==, 12);
}

/* Where there is nothing a place is found in no more than 5% of takes; of 100 that is 5, and
 * 11 in 1 of 100. The take's sigma is given as none: all of the null is in the null. */
static void
test_noise (void)
{
  /* white, and as long as the observer's springs remember: exp −½·√gain·frame */
  static const gdouble alike[] = { 0., 0.67 };

  for (guint i = 0; i < 2; i++) {
    ClothRecording *r = record (FRAMES, 1e-9);
    guint found = 0;

    for (guint k = 0; k < 100; k++) {
      g_autofree gfloat *off = make_noise (FRAMES, SIGMA, alike[i], 2 * k + 1);
      g_autofree gfloat *null = make_noise (FRAMES, SIGMA, alike[i], 2 * k + 2);
      g_autoptr (ClothLocalisation) region = find (r, off, r, null, FALSE);

      found += region->vertices->len > 0;
      g_assert_true (region->vertices->len || region->onset == 0);
    }
    g_test_message ("correlated by %g: %u of 100 have a place", alike[i],
        found);
    g_assert_cmpuint (found, <, 11);
    forget (r);
  }
}

/* A force of 3 m/s² in a patch from frame 50 on, 2 mm from the observer's targets. */
static void
test_step (void)
{
  ClothRecording *r = record (FRAMES, SIGMA);

  for (guint k = 0; k < 10; k++)
    for (guint same = 0; same < 2; same++) {
      g_autofree gfloat *off = make_noise (FRAMES, SIGMA, 0., 2 * k + 1);
      g_autofree gfloat *null = make_noise (FRAMES, SIGMA, 0., 2 * k + 2);
      g_autoptr (ClothLocalisation) region = NULL;

      /* what a baseline of the same motion shows, too, is no gap */
      for (gsize i = 0; i < 3 * N * FRAMES && same; i++) {
        gfloat discrepancy = (gfloat) (0.002 * sin (0.01 * i));

        off[i] += discrepancy;
        null[i] += discrepancy;
      }
      add_step (off, FRAMES, 50, same ? 6. : 3., 0.3);
      region = find (r, off, r, null, same);
      assert_patch (region);
      g_assert_cmpuint (region->onset, >=, 48);
      g_assert_cmpuint (region->onset, <=, 53);
    }
  forget (r);
}

/* It was there before the recording was. */
static void
test_from_the_beginning (void)
{
  ClothRecording *r = record (FRAMES, SIGMA);
  g_autofree gfloat *off = make_noise (FRAMES, SIGMA, 0., 1);
  g_autofree gfloat *null = make_noise (FRAMES, SIGMA, 0., 2);
  g_autoptr (ClothLocalisation) region = NULL;

  add_step (off, FRAMES, 0, 3., 0.);
  region = find (r, off, r, null, FALSE);
  assert_patch (region);
  g_assert_cmpuint (region->onset, ==, 0);
  forget (r);
}

/* What acts everywhere has no place of its own. */
static void
test_everywhere (void)
{
  ClothRecording *r = record (FRAMES, SIGMA);
  g_autofree gfloat *off = make_noise (FRAMES, SIGMA, 0., 1);
  g_autofree gfloat *null = make_noise (FRAMES, SIGMA, 0., 2);
  g_autoptr (ClothLocalisation) region = NULL;

  for (gsize i = 60 * N * 3 + 2; i < 3 * N * FRAMES; i += 3)
    off[i] += 0.002f;
  region = find (r, off, r, null, FALSE);
  g_assert_cmpuint (region->vertices->len, ==, N);
  g_assert_cmpuint (region->onset, ==, 60);
  forget (r);
}

/* What was not seen may be anything; and where a vertex comes back the simulation, which
 * nothing drew there, is off for a while: that is no gap. */
static void
test_unseen (void)
{
  ClothRecording *r = record (FRAMES, SIGMA);
  g_autofree gfloat *off = make_noise (FRAMES, SIGMA, 0., 1);
  g_autofree gfloat *null = make_noise (FRAMES, SIGMA, 0., 2);
  g_autoptr (ClothLocalisation) nothing = NULL, region = NULL, blind = NULL;

  for (guint f = 20; f < 40; f++)
    for (guint v = 0; v < 40; v++) {
      gsize at = (gsize) f * N + v;

      r->seen[at] = f < 33 ? 0. : 1.;
      for (guint k = 0; k < 3; k++)
        off[3 * at + k] = f < 33 ? (v % 2 ? NAN : 1e6f) : 0.02f;
    }
  nothing = find (r, off, r, null, FALSE);
  g_assert_cmpuint (nothing->vertices->len, ==, 0);
  /* also one whose patch is seen in part, and a number that is none */
  add_step (off, FRAMES, 50, 3., 0.3);
  for (guint f = 60; f < 80; f++)
    r->seen[(gsize) f * N + 4 * COLUMNS + 8] = 0.;
  off[3 * (70 * N + 5 * COLUMNS + 8) + 2] = INFINITY;
  region = find (r, off, r, null, FALSE);
  assert_patch (region);
  g_assert_cmpuint (region->onset, >=, 48);
  g_assert_cmpuint (region->onset, <=, 53);
  memset (r->seen, 0, N * FRAMES * sizeof *r->seen);
  blind = find (r, off, r, null, FALSE);
  g_assert_cmpuint (blind->vertices->len, ==, 0);
  g_assert_cmpuint (blind->onset, ==, 0);
  forget (r);
}

/* The shortest take, another length of the null, noise that is not known, no flat cloth. */
static void
test_odd (void)
{
  ClothRecording *seven = record (7, NAN), *r = record (FRAMES, NAN);
  g_autofree gfloat *off = make_noise (FRAMES, SIGMA, 0., 1);
  g_autofree gfloat *null = make_noise (FRAMES, SIGMA, 0., 2);
  g_autofree gfloat *nothing = g_new0 (gfloat, 3 * N * FRAMES);
  g_autoptr (ClothLocalisation) little = NULL, more = NULL, none = NULL;
  g_autoptr (ClothLocalisation) flat = NULL;

  little = find (seven, off, seven, null, FALSE);
  g_assert_cmpuint (little->vertices->len, ==, 0);
  add_step (off, FRAMES, 50, 3., 0.3);
  more = find (r, off, seven, null, FALSE);
  g_assert_cmpuint (more->vertices->len, >=, 2);
  none = find (r, nothing, r, nothing, TRUE);
  g_assert_cmpuint (none->vertices->len, ==, 0);
  memset (r->scene->topology->uv, 0, 2 * N * sizeof (gfloat));
  flat = find (r, off, r, null, FALSE);
  g_assert_true (flat->vertices->len == N || flat->vertices->len == 0);
  forget (seven);
  forget (r);
}

/* A baseline that ends sooner than the take tells nothing of what comes after: here its memory goes on
 * with what would be a gap. */
static void
test_shorter_null (void)
{
  const guint end = FRAMES - 5;
  ClothRecording *r = record (FRAMES, SIGMA), *null_recording =
      record (end, SIGMA);
  g_autofree gfloat *off = make_noise (FRAMES, SIGMA, 0., 1);
  g_autofree gfloat *null = make_noise (FRAMES, SIGMA, 0., 2);
  g_autofree gfloat *cut = NULL;
  const ClothNudgedResidual take = { r, off };
  ClothNudgedResidual nudged = { null_recording, null };
  ClothLocalisationOptions options;
  g_autoptr (ClothExcess) full = NULL, less = NULL;

  cloth_localisation_options_init (&options);
  add_step (off, FRAMES, 50, 6., 0.3);
  for (gsize i = 3 * (gsize) N * end; i < 3 * N * FRAMES; i++)
    null[i] = 0.5f;
  full = cloth_excess_new (&take, &nudged, 1, TRUE, FALSE, &options);
  /* the simulation is let in for 0.15 s */
  for (gsize i = 10 * N; i < (gsize) N * FRAMES; i++) {
    g_assert_cmpuint (full->known[i], ==, i < (gsize) N * end);
    g_assert_true (full->known[i] || full->values[i] == 0.f);
  }
  /* of another motion, it need not last */
  less = cloth_excess_new (&take, &nudged, 1, FALSE, FALSE, &options);
  for (gsize i = 10 * N; i < (gsize) N * FRAMES; i++)
    g_assert_true (less->known[i]);
  cut = g_memdup2 (null, 3 * (gsize) N * end * sizeof *null);
  nudged.off = cut;
  for (guint k = 0; k < 2; k++) {
    g_autoptr (ClothLocalisation) region = cloth_localisation_new (&take,
        &nudged, 1, !k, &options);

    assert_patch (region);
  }
  forget (null_recording);
  forget (r);
}

/* What a vertex is expected to be off by: from the null's own frame as long as there are any, then from its
 * mean at that time of a window. */
static void
test_shorter_floor (void)
{
  const guint end = FRAMES - 5;
  ClothRecording *r = record (FRAMES, 1e-9);
  g_autofree gdouble *squares = g_new (gdouble, N * FRAMES);
  g_autofree guint *windows = cloth_rollout_list_windows (r,
      CLOTH_DIAGNOSIS_WINDOW_S);
  g_autofree guint *tiles = g_new0 (guint, N);
  const guint length = 15;      /* frames of a window */
  ClothWindowedGap null = { N, end, windows[end - 1] + 1, windows, tiles,
    squares
  };
  const ClothGapOptions options = { 0 };
  ClothDiagnosis d = { 0 };
  gdouble sum = 0.;
  guint n = 0;

  /* the null grows from window to window; behind its end lies something else */
  for (guint f = 0; f < FRAMES; f++)
    for (guint v = 0; v < N; v++)
      squares[f * N + v] = f < end ? 1e-6 * (1 + windows[f]) : 1e6;
  d.recordings = g_ptr_array_new ();
  g_ptr_array_add (d.recordings, r);
  d.options = &options;
  d.result = cloth_gap_result_new ();
  d.result->series.n = windows[FRAMES - 1] + 1;
  d.nulls[0] = &null;
  d.n_nulls = 1;
  d.null_recordings[0] = 1;
  d.null_alike = TRUE;
  cloth_diagnosis_fill_null_distribution (&d);
  for (guint f = 1; f < FRAMES; f++) {
    gdouble expected = 1e-6 * (1 + windows[f]);

    if (f >= end) {
      sum = n = 0;
      for (guint i = 1; i < end; i++)
        if ((i - 1) % length == (f - 1) % length) {
          sum += 1e-6 * (1 + windows[i]);
          n++;
        }
      expected = sum / n;
    }
    for (guint v = 0; v < N; v++)
      g_assert_cmpfloat_with_epsilon (d.result->playback.sigma[f * N + v],
          sqrt (expected), 1e-6 * sqrt (expected));
  }
  cloth_gap_result_free (d.result);
  g_ptr_array_unref (d.recordings);
  forget (r);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gapregion/noise", test_noise);
  g_test_add_func ("/gapregion/step", test_step);
  g_test_add_func ("/gapregion/from-the-beginning", test_from_the_beginning);
  g_test_add_func ("/gapregion/everywhere", test_everywhere);
  g_test_add_func ("/gapregion/unseen", test_unseen);
  g_test_add_func ("/gapregion/odd", test_odd);
  g_test_add_func ("/gapregion/shorter-null", test_shorter_null);
  g_test_add_func ("/gapregion/shorter-floor", test_shorter_floor);
  return g_test_run ();
}
