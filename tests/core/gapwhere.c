/* Where the gap lies, against closed forms: single waves at single frequencies, and a
 * sheet that gravity pulls along its warp, its weft or its normal alone.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <math.h>

#include "gst/fit/features/features.h"
#include "gst/fit/nudge/nudge.h"
#include "gst/gap/localise/where.h"
#include "gst/math/random.h"
#include "gst/effect/effect.h"

#define COLUMNS 9
#define ROWS 8
#define N (COLUMNS * ROWS)
#define SPACING 0.02
#define FPS 50.
#define FRAMES 60
#define SIGMA 5e-4

/* A sheet that lies still at @height, warp along x, weft along −y. */
static ClothRecording *
record (const gdouble gravity[3], guint n_frames, ClothTake ** take)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("still");
  g_autoptr (ClothTopology) topology = cloth_topology_new_grid (COLUMNS, ROWS,
      (gfloat) (SPACING * (COLUMNS - 1)), (gfloat) (SPACING * (ROWS - 1)));
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-gap-XXXXXX", &error);
  g_autofree gchar *folder = g_build_filename (parent, "take", NULL);
  ClothRecording *r;
  GDir *dir;
  const gchar *name;

  info->fps = FPS;
  info->columns = COLUMNS;
  info->rows = ROWS;
  info->width_m = SPACING * (COLUMNS - 1);
  info->height_m = SPACING * (ROWS - 1);
  info->noise_sigma_m = SIGMA;
  for (guint k = 0; k < 3; k++)
    info->gravity[k] = gravity[k];
  writer = cloth_take_writer_new (folder, info, topology, &error);
  g_assert_no_error (error);
  for (guint f = 0; f < n_frames; f++) {
    gfloat positions[3 * N];
    guint8 states[N];

    for (guint v = 0; v < N; v++) {
      states[v] = CLOTH_VERTEX_MEASURED;
      positions[3 * v] = (gfloat) (SPACING * (v % COLUMNS));
      positions[3 * v + 1] = (gfloat) (-SPACING * (v / COLUMNS));
      positions[3 * v + 2] = 0.f;
    }
    cloth_take_writer_append (writer, f / FPS, positions, states, NULL, NULL,
        &error);
    g_assert_no_error (error);
  }
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
  *take = cloth_take_open (folder, &error);
  g_assert_no_error (error);
  r = cloth_recording_new (*take, &error);
  g_assert_no_error (error);
  dir = g_dir_open (folder, 0, NULL);
  while ((name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    g_remove (path);
  }
  g_dir_close (dir);
  g_rmdir (folder);
  g_rmdir (parent);
  return r;
}

typedef struct
{
  guint ku, kv, kt;
} Wave;

static gdouble
cosine (guint k, guint i, guint n)
{
  return cos (G_PI * k * (i + 0.5) / n);
}

/* Each wave's energy is in its own cell, all of it; that of kt = 0 stands still. */
static void
test_one_wave (void)
{
  static const Wave waves[] = {
    {0, 0, 0}, {0, 0, 7}, {3, 0, 0}, {0, 5, 1}, {2, 4, 11}, {8, 7, 59}
  };
  const gdouble gravity[3] = { 0., 0., -9.81 }, size = 0.003;
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (ClothRecording) r = record (gravity, FRAMES, &take);
  gdouble hz[FRAMES], per_m[40];

  for (guint c = 0; c < FRAMES; c++)
    hz[c] = (c - 0.5) * FPS / 2. / FRAMES;
  for (guint k = 0; k < 40; k++)
    per_m[k] = k * 2.;
  for (guint i = 0; i < G_N_ELEMENTS (waves); i++) {
    const Wave *w = &waves[i];
    g_autoptr (ClothEnergySpectrum) e = cloth_energy_spectrum_new (r);
    g_autofree gdouble *cells = g_new (gdouble, 40 * FRAMES);
    gdouble expected = size * size / ((w->ku ? 2. : 1.) * (w->kv ? 2. : 1.) *
        (w->kt ? 2. : 1.));
    /* half waves a metre, of a sheet half a spacing longer at either end */
    gdouble number = hypot (w->ku / (2. * SPACING * COLUMNS), w->kv /
        (2. * SPACING * ROWS));
    guint cell = (guint) (number / 2.) * FRAMES + w->kt;

    for (guint f = 0; f < FRAMES; f++) {
      gdouble x[3 * N];

      for (guint v = 0; v < N; v++)
        for (guint k = 0; k < 3; k++)
          x[3 * v + k] = r->y[3 * ((gsize) f * N + v) + k] + (k == i % 3 ?
              size * cosine (w->ku, v % COLUMNS, COLUMNS) *
              cosine (w->kv, v / COLUMNS, ROWS) * cosine (w->kt, f,
                  FRAMES) : 0.);
      cloth_energy_spectrum_add (e, f, x);
    }
    g_assert_cmpfloat_with_epsilon (e->highest_hz, FPS / 2., 1e-9);
    g_assert_cmpfloat_with_epsilon (cloth_energy_spectrum_total (e), expected,
        1e-9 * expected);
    g_assert_cmpfloat_with_epsilon (cloth_energy_spectrum_static (e),
        w->kt ? 0. : expected, 1e-9 * expected);
    cloth_energy_spectrum_bin (e, hz, FRAMES, per_m, 40, cells, NULL);
    for (guint k = 0; k < 40 * FRAMES; k++)
      if (!isnan (cells[k]))
        g_assert_cmpfloat_with_epsilon (cells[k], k == cell ? expected : 0.,
            1e-9 * expected);
    g_assert_false (isnan (cells[cell]));
  }
}

/* A tone between two cosines leaks little; of noise each cell has its part, and all of
 * it is there (Parseval); a patch that is not seen has none. */
static void
test_tone_and_noise (void)
{
  const gdouble gravity[3] = { 0., 0., -9.81 }, hz[] = { 0., 2.5, 5., 12. };
  const gdouble per_m[] = { 0., 8. };
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (ClothRecording) r = record (gravity, 2 * 650, &take);
  g_autoptr (ClothEnergySpectrum) tone = cloth_energy_spectrum_new (r);
  g_autoptr (ClothEnergySpectrum) noise = cloth_energy_spectrum_new (r);
  gdouble cells[8], expected[8], all = 0.;
  ClothRandom random;

  /* in blocks, because the take is long */
  g_assert_cmpuint (tone->features->n_blocks, ==, 3);
  cloth_random_init (&random, 3);
  for (guint f = 0; f < r->n_frames; f++) {
    gdouble x[3 * N], y[3 * N];

    for (guint k = 0; k < 3 * N; k++) {
      gdouble at = r->y[3 * (gsize) f * N + k];

      x[k] = at + (k % 3 == 2 ? 0.001 * sin (2. * G_PI * 3.3 * f / FPS) : 0.);
      y[k] = at + SIGMA * cloth_random_gaussian (&random);
    }
    cloth_energy_spectrum_add (tone, f, x);
    cloth_energy_spectrum_add (noise, f, y);
  }
  cloth_energy_spectrum_bin (tone, hz, 4, per_m, 2, cells, expected);
  g_test_message ("3.3 Hz: %.4f of it from 2.5 to 5 Hz", cells[1] / 5e-7);
  g_assert_cmpfloat (cells[1], >, 0.98 * 5e-7);
  g_assert_cmpfloat (cells[1], <, 1.001 * 5e-7);
  g_assert_cmpfloat (cloth_energy_spectrum_static (tone), <, 1e-4 * 5e-7);
  cloth_energy_spectrum_bin (noise, hz, 4, per_m, 2, cells, expected);
  for (guint k = 0; k < 8; k++) {
    all += expected[k];
    g_assert_cmpfloat_with_epsilon (cells[k], expected[k], 0.05 * expected[k]);
  }
  g_assert_cmpfloat_with_epsilon (all, 3. * SIGMA * SIGMA, 1e-12);
  all = 0.;
  for (guint k = 0; k < 8; k++)
    all += cells[k];
  g_assert_cmpfloat_with_epsilon (cloth_energy_spectrum_total (noise), all,
      1e-9 * all);
}

/* Of a take as short as may be most bands are empty: not known, not 0. */
static void
test_short (void)
{
  const gdouble gravity[3] = { 0., 0., -9.81 }, hz[] = { 0., 0.5, 1., 3. };
  const gdouble all_waves = 0.;
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (ClothRecording) r = record (gravity, 7, &take);
  g_autoptr (ClothEnergySpectrum) e = cloth_energy_spectrum_new (r);
  gdouble cells[4], noise[4];

  for (guint v = 0; v < N; v++)
    r->seen[2 * N + v] = 0.;
  for (guint f = 0; f < 7; f++) {
    gdouble x[3 * N];

    /* what is not seen may be anything */
    for (guint k = 0; k < 3 * N; k++)
      x[k] = f == 2 ? NAN : r->y[3 * (gsize) f * N + k];
    cloth_energy_spectrum_add (e, f, x);
  }
  cloth_energy_spectrum_bin (e, hz, 4, &all_waves, 1, cells, noise);
  g_assert_cmpfloat (cells[0], ==, 0.);
  g_assert_true (isnan (cells[1]) && isnan (cells[2]));
  g_assert_true (isnan (noise[1]));
  g_assert_cmpfloat (cells[3], ==, 0.);
  g_assert_cmpfloat (cloth_energy_spectrum_total (e), ==, 0.);
}

/* A loose sheet that lies still where gravity a would pull it along one axis: windows
 * begin a/gain off, where the observer's springs hold it, and fall by a·t²/2. The other
 * model feels half of it: a quarter of the variance is left everywhere. */
static void
test_directions (void)
{
  const gdouble a = 2., gain = 1600., half = 0.5;
  const ClothRolloutOptions options = {.threads = 1 };

  for (guint k = 0; k < 3; k++) {
    gdouble gravity[3] = { 0., 0., 0. }, expected = 0., gained = 0.;
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (ClothRecording) r = NULL;
    g_autoptr (ClothModel) model = cloth_model_new ();
    g_autoptr (ClothModel) lighter = cloth_model_new ();
    g_autoptr (ClothGapResult) result = cloth_gap_result_new ();
    g_autoptr (GError) error = NULL;
    const ClothModel *models[2] = { model, lighter };
    ClothWindowedGap **extents;

    gravity[k] = a;
    r = record (gravity, FRAMES, &take);
    model->damping_mass = lighter->damping_mass = 0.;
    cloth_model_set_effect (lighter, cloth_effect_find ("gravity_scale"),
        &half);
    extents =
        cloth_windowed_gaps_new (r, models, 2, gain, 0.3, &options, &error);
    g_assert_no_error (error);
    for (guint f = 1; f < FRAMES; f++) {
      guint begin = f, w = extents[0]->window[f];
      gdouble t, d;

      while (begin > 1 && extents[0]->window[begin - 1] == w)
        begin--;
      t = (f - begin + 1) / FPS;
      d = (w ? a / gain : 0.) + a * t * t / 2.;
      expected += d * d / (FRAMES - 1);
    }
    g_test_message ("axis %u: %g m, expected %g m", k, sqrt
        (cloth_windowed_gap_square (extents[0], NULL)), sqrt (expected));
    g_assert_cmpfloat_with_epsilon (cloth_windowed_gap_square (extents[0],
            NULL), expected, 0.03 * expected);
    cloth_windowed_gap_fill (extents[0], extents[1], r, take, result);
    for (guint i = 0; i < 3; i++)
      g_assert_cmpfloat_with_epsilon (result->directions[i], i == k, 1e-3);
    for (guint v = 0; v < N; v++) {
      g_assert_cmpfloat_with_epsilon (result->vertices[v], 1. / N, 1e-3 / N);
      gained += result->gained[v];
    }
    g_assert_cmpfloat_with_epsilon (gained, 0.75, 1e-3);
    cloth_windowed_gaps_free (extents, 2);
  }
}

/* Gaps of a sheet that lies still and of one that feels half the pull; not all of it was seen. */
static ClothWindowedGap **
measure (const ClothRecording * r, gboolean is_free)
{
  const ClothRolloutOptions options = {.threads = 1 };
  const gdouble half = 0.5;
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothModel) lighter = cloth_model_new ();
  g_autoptr (GError) error = NULL;
  const ClothModel *models[2] = { model, lighter };
  ClothWindowedGap **gaps;

  cloth_model_set_effect (lighter, cloth_effect_find ("gravity_scale"), &half);
  gaps = is_free ? cloth_windowed_gaps_new_free (r, models, 2, 1600., 0.3, 0.3,
      &options, &error) : cloth_windowed_gaps_new (r, models, 2, 1600., 0.3,
      &options, &error);
  g_assert_no_error (error);
  return gaps;
}

/* What does not count in one gap counts in none, so that means and their draws are of the same places: one
 * model's are 2 mm everywhere, the other's 1 mm where there are any. */
static void
test_aligned (void)
{
  const gdouble gravity[3] = { 0., 0., 2. };
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (ClothRecording) r = record (gravity, FRAMES, &take);
  g_autoptr (ClothGapResult) result = cloth_gap_result_new ();
  ClothWindowedGap **gaps = measure (r, FALSE);
  gdouble draws[2 * 50];
  guint n = 0;

  for (gsize i = N; i < N * FRAMES; i++) {
    gaps[0]->squares[i] = i % 7 == 0 ? NAN : i % 5 == 0 ? 1. : 4e-6;
    gaps[1]->squares[i] = i % 5 == 0 ? NAN : 1e-6;
  }
  cloth_windowed_gaps_align (gaps, 2);
  for (gsize i = N; i < N * FRAMES; i++) {
    const gboolean counts = i % 5 && i % 7;

    g_assert_cmpint (isfinite (gaps[0]->squares[i]), ==, counts);
    g_assert_cmpint (isfinite (gaps[1]->squares[i]), ==, counts);
    n += counts;
  }
  g_assert_cmpuint (n, >, N * FRAMES / 2);
  cloth_windowed_gaps_interval (gaps, 2, NULL, 1, 50, draws);
  for (guint m = 0; m < 2; m++) {
    const gdouble square = m ? 1e-6 : 4e-6;

    g_assert_cmpfloat_with_epsilon (cloth_windowed_gap_square (gaps[m], NULL),
        square, 1e-12);
    for (guint d = 0; d < 50; d++)
      g_assert_cmpfloat_with_epsilon (draws[2 * d + m], square, 1e-12);
  }
  cloth_windowed_gap_fill (gaps[0], gaps[1], r, take, result);
  for (guint v = 0; v < N; v++)
    g_assert_cmpfloat_with_epsilon (result->gained[v], 0.75 *
        result->vertices[v], 1e-9);
  cloth_windowed_gaps_free (gaps, 2);
}

/* Frames that lead up to a free run, the first one and what was not seen count neither before nor after
 * a gap becomes that of another simulator or of two models; nor does what is not seen any more then. */
static void
test_replaced (void)
{
  const gdouble gravity[3] = { 0., 0., 2. };
  const guint led = 15;         /* 0.3 s */
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (ClothRecording) r = record (gravity, FRAMES, &take);
  ClothWindowedGap **gaps;
  ClothRecording twin = *r;
  g_autofree gdouble *y = NULL;
  g_autofree gfloat *x = NULL;

  for (gsize i = 0; i < N * FRAMES; i += 11)
    r->seen[i] = 0.;
  twin.y = y = g_memdup2 (r->y, 3 * N * FRAMES * sizeof *y);
  for (gsize i = 0; i < 3 * N * FRAMES; i++)
    y[i] += 1e-3;
  gaps = measure (r, TRUE);
  x = g_memdup2 (gaps[1]->positions, 3 * N * FRAMES * sizeof *x);
  for (gsize i = 0; i < N * FRAMES; i += 13)
    r->seen[i] = 0.;
  cloth_windowed_gap_replace (gaps[1], r, gaps[0], &twin);
  for (gsize i = 0; i < N * FRAMES; i++) {
    const gboolean counts = i >= led * N && i % 11 && i % 13;
    gdouble square = 0.;

    g_assert_cmpint (isfinite (gaps[1]->squares[i]), ==, counts);
    for (guint k = 0; k < 3; k++)
      square += pow (1e-3 + x[3 * i + k] - gaps[0]->positions[3 * i + k], 2.);
    if (counts)
      g_assert_cmpfloat_with_epsilon (gaps[1]->squares[i], square, 1e-6 *
          square);
  }
  cloth_windowed_gaps_free (gaps, 2);
  gaps = measure (r, FALSE);
  cloth_windowed_gap_subtract (gaps[1], gaps[0], r);
  for (gsize i = 0; i < N * FRAMES; i++)
    g_assert_cmpint (isfinite (gaps[1]->squares[i]), ==, i >= N && i % 11
        && i % 13);
  cloth_windowed_gaps_free (gaps, 2);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gapwhere/one-wave", test_one_wave);
  g_test_add_func ("/gapwhere/tone-and-noise", test_tone_and_noise);
  g_test_add_func ("/gapwhere/short", test_short);
  g_test_add_func ("/gapwhere/directions", test_directions);
  g_test_add_func ("/gapwhere/aligned", test_aligned);
  g_test_add_func ("/gapwhere/replaced", test_replaced);
  return g_test_run ();
}
