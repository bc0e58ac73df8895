/* Recordings with faults that are known: corrected against closed forms, linearised against
 * chains of simulations made here, and recovered by fits.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/error.h"
#include "gst/fit/estimate/estimate.h"
#include "gst/math/random.h"
#include "gst/math/vec3.h"

#include "simscene.h"

#define COLUMNS 7
#define ROWS 6
#define N (COLUMNS * ROWS)
#define FRAMES 121
#define FPS 50.
#define OMEGA 7.
#define NOISE 5e-4

static ClothRecording *
recording_new (guint frames)
{
  ClothRecording *r = g_new0 (ClothRecording, 1);

  r->name = g_strdup ("swing");
  r->scene = cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.36f,
          0.3f), FPS, frames);
  r->n = N;
  r->n_frames = frames;
  r->times = g_memdup2 (r->scene->times, frames * sizeof (gdouble));
  r->sigma = NOISE;
  r->y = g_new0 (gdouble, 3 * N * frames);
  r->velocity = g_new0 (gdouble, 3 * N * frames);
  r->seen = g_new (gdouble, N * frames);
  for (guint i = 0; i < N * frames; i++)
    r->seen[i] = 1.;
  return r;
}

/* Where a vertex of no cloth in particular is: k-th coordinate. */
static gdouble
wave (guint vertex, guint k, gdouble t)
{
  return 0.3 * k + 0.01 * vertex + 0.1 * sin (OMEGA * t + vertex + 2. * k);
}

static gdouble
wave_speed (guint vertex, guint k, gdouble t)
{
  return 0.1 * OMEGA * cos (OMEGA * t + vertex + 2. * k);
}

static ClothRecording *
waves_new (void)
{
  ClothRecording *r = recording_new (FRAMES);

  for (guint i = 0; i < 3 * N * FRAMES; i++) {
    r->y[i] = wave (i / 3 % N, i % 3, r->times[i / 3 / N]);
    r->velocity[i] = wave_speed (i / 3 % N, i % 3, r->times[i / 3 / N]);
  }
  return r;
}

static ClothMeasurement
fault (const gchar * id, const gdouble * values)
{
  ClothMeasurement m;

  cloth_measurement_init (&m);
  cloth_measurement_add_effect (&m, cloth_effect_find (id), values);
  g_assert_false (cloth_measurement_is_null (&m));
  return m;
}

/* What was recorded late, by a clock that runs fast, is found at its time; what was recorded
 * before the first frame or after the last one is not seen. */
static void
test_late (void)
{
  static const gdouble factors[] = { 1., 1., 1.06, 0.93, 1.1, 1. };
  static const gdouble delays[] = { 0.02, 0.033, 0., 0., -0.05, -0.01 };
  const gdouble two = 2.;
  g_autoptr (ClothRecording) r = waves_new ();

  for (guint c = 0; c < G_N_ELEMENTS (factors); c++) {
    ClothMeasurement m = fault ("time_scale", &two);
    g_autoptr (ClothRecording) corrected = NULL;

    m.time_factor = factors[c];
    m.delay_s = delays[c];
    corrected = cloth_recording_correct (r, &m);
    g_assert_cmpfloat (corrected->sigma, ==, r->sigma);
    for (guint f = 0; f < FRAMES; f++) {
      const gdouble t = factors[c] * r->times[f] + delays[c];
      const gboolean inside = t >= -1e-9 && t <= r->times[FRAMES - 1] + 1e-9;

      for (guint i = 3 * N * f; i < 3 * N * (f + 1); i++) {
        g_assert_cmpfloat (corrected->seen[i / 3], ==, inside ? 1. : 0.);
        if (!inside)
          continue;
        /* cubics of 20 ms: h⁴ ω⁴ 0.1 / 384, and its derivative */
        assert_within (corrected->y[i], wave (i / 3 % N, i % 3, t), 2e-7);
        assert_within (corrected->velocity[i],
            factors[c] * wave_speed (i / 3 % N, i % 3, t), 5e-5);
      }
    }
  }
}

/* A vertex that was hidden in a frame is hidden in those that lie about it. */
static void
test_hidden (void)
{
  const gdouble half = 0.01, whole = 0.02;
  ClothMeasurement m = fault ("recording_delay", &half);
  g_autoptr (ClothRecording) r = waves_new (), late = NULL, exact = NULL;

  r->seen[20 * N + 5] = 0.;
  late = cloth_recording_correct (r, &m);
  m = fault ("recording_delay", &whole);
  exact = cloth_recording_correct (r, &m);
  for (guint f = 0; f + 1 < FRAMES; f++)
    for (guint v = 0; v < N; v++) {
      g_assert_cmpfloat (late->seen[f * N + v], ==,
          v == 5 && (f == 19 || f == 20) ? 0. : 1.);
      g_assert_cmpfloat (exact->seen[f * N + v], ==,
          v == 5 && f == 19 ? 0. : 1.);
    }
}

/* Places are mapped back, and noise with them; what the correction undoes is what the effect
 * does to each frame. */
static void
test_places (void)
{
  const gdouble factor = 1.25, axes[3] = { 2., -3., 1. };
  const gdouble way[6] = { 3., -5., 8., 0.1, -0.2, 0.05 };
  const gdouble labels[4] = { 1., 2., 0., 0. };
  g_autoptr (ClothRecording) r = waves_new (), distorted = waves_new ();
  g_autoptr (ClothRecording) back = NULL;
  ClothMeasurement m = fault ("position_scale", &factor);

  cloth_measurement_add_effect (&m, cloth_effect_find ("misalignment"), way);
  cloth_measurement_add_effect (&m, cloth_effect_find ("axes_exchange"), axes);
  cloth_measurement_add_effect (&m, cloth_effect_find ("label_exchange"),
      labels);
  for (guint f = 0; f < FRAMES; f++) {
    cloth_measurement_apply (&m, r->scene->topology, r->y + 3 * N * f,
        distorted->y + 3 * N * f);
    distorted->seen[f * N + 1] = f % 2;
  }
  cloth_recording_differentiate (distorted);
  cloth_recording_differentiate (r);
  back = cloth_recording_correct (distorted, &m);
  for (guint i = 0; i < 3 * N * FRAMES; i++) {
    assert_within (back->y[i], r->y[i], 1e-13);
    assert_within (back->velocity[i], r->velocity[i], 1e-10);
    /* mirrored and turned about, label 1 is that of the second vertex of the last row */
    g_assert_cmpfloat (back->seen[i / 3], ==,
        i / 3 % N == N - COLUMNS + 1 ? i / 3 / N % 2 : 1.);
  }
  assert_within (back->sigma, NOISE / factor, 1e-15);
}

/* An error of a place that was mapped is as unlikely as that of the place before, x and A x being the same
 * number of deviations off; along a ray of which nothing is known nothing is known either, wherever it points
 * now. */
static void
test_mapped_noise (void)
{
  const gdouble factor = 1.25, axes[3] = { 2., -3., 1. };
  const gdouble way[6] = { 3., -5., 8., 0.1, -0.2, 0.05 };
  /* of three sizes along no axis in particular; the second knows nothing along (1, 2, 2)/3 */
  const gdouble known[6] = { 4e6, 9e6, 1e6, 1e6, -5e5, 2e6 };
  const gdouble ray[6] = { 1e6 * 8. / 9., 1e6 * 5. / 9., 1e6 * 5. / 9.,
    -1e6 * 4. / 9., -1e6 * 2. / 9., -1e6 * 2. / 9.
  };
  const gdouble off[3] = { 3e-4, -7e-4, 5e-4 };
  g_autoptr (ClothRecording) r = waves_new (), back = NULL;
  ClothMeasurement m = fault ("position_scale", &factor);
  gdouble square, blind[3];

  cloth_measurement_add_effect (&m, cloth_effect_find ("misalignment"), way);
  cloth_measurement_add_effect (&m, cloth_effect_find ("axes_exchange"), axes);
  r->noise = cloth_recording_noise_new (N * FRAMES);
  for (gsize i = 0; i < N * FRAMES; i++)
    g_assert_true (cloth_recording_noise_set (r->noise, i, i % 2 ? ray : known,
            0.));
  r->sigma = cloth_recording_noise_finish (r->noise, r->seen);
  square = r->noise->square;
  back = cloth_recording_correct (r, &m);
  /* what others hold stays as it is */
  g_assert_cmpfloat (r->noise->square, ==, square);
  for (gsize i = 0; i < N * FRAMES; i++) {
    gdouble mapped[3] = { 0. }, a[3], b[3];

    for (guint k = 0; k < 3; k++)
      for (guint c = 0; c < 3; c++)
        mapped[k] += m.matrix[3 * k + c] * off[c];
    cloth_recording_whiten (r, i, mapped, a);
    cloth_recording_whiten (back, i, off, b);
    assert_within (cloth_vec3_length (b), cloth_vec3_length (a), 1e-9);
    /* what is cut off is what the map takes to the ray */
    memcpy (a, mapped, sizeof a);
    memcpy (b, off, sizeof b);
    cloth_recording_cut_blind (r, i, a);
    cloth_recording_cut_blind (back, i, b);
    memset (blind, 0, sizeof blind);
    for (guint k = 0; k < 3; k++)
      for (guint c = 0; c < 3; c++)
        blind[k] += m.matrix[3 * k + c] * b[c];
    for (guint k = 0; k < 3; k++)
      assert_within (blind[k], a[k], 1e-12);
  }
  assert_within (back->noise->square, square / (factor * factor), 1e-15);
  assert_within (cloth_recording_noise_finish (back->noise, back->seen),
      back->sigma, 1e-12);
}

/* What labels that were shifted don't show is not seen, but lies with the rest. */
static void
test_shifted (void)
{
  const gdouble labels[4] = { 0., 0., 1., 0. };
  const ClothMeasurement m = fault ("label_exchange", labels);
  g_autoptr (ClothRecording) r = recording_new (FRAMES), back = NULL;

  for (guint i = 0; i < N * FRAMES; i++) {
    r->y[3 * i] = 0.06 * (i % COLUMNS);
    r->y[3 * i + 2] = -0.06 * (i % N / COLUMNS) + 0.3 * r->times[i / N];
  }
  back = cloth_recording_correct (r, &m);
  for (guint i = 0; i < N * FRAMES; i++) {
    g_assert_cmpfloat (back->seen[i], ==, i % COLUMNS == COLUMNS - 1 ? 0. : 1.);
    assert_within (back->y[3 * i + 2], r->y[3 * i + 2], 0.05);
    if (back->seen[i] > 0.)
      assert_within (back->y[3 * i], 0.06 * (i % COLUMNS + 1), 1e-12);
  }
}

/* Places that nobody saw stay where a simulation has them, whatever is made of the recording: only those that it
 * has none of are filled in, here between two frames. */
static void
test_simulated (void)
{
  const gdouble labels[4] = { 0., 0., 1., 0. };
  const ClothMeasurement m = fault ("label_exchange", labels);
  const gboolean sound = TRUE;
  g_autoptr (ClothRecording) r = waves_new (), back = NULL;
  g_autofree gdouble *y = NULL;
  ClothImitations *imitations;

  r->simulated = TRUE;
  for (guint i = 0; i < N * FRAMES; i++)
    r->seen[i] = i % N < 3 || i % 7 == 0 ? 0. : 1.;
  y = g_memdup2 (r->y, 3 * N * FRAMES * sizeof *y);
  cloth_recording_interpolate (r);
  g_assert_cmpmem (r->y, 3 * N * FRAMES * sizeof *y, y,
      3 * N * FRAMES * sizeof *y);
  /* one that a simulation has at 0 beside the others is there in an imitation, without noise */
  imitations = cloth_imitations_new (r, 1);
  for (guint f = 0; f < FRAMES; f++)
    cloth_imitations_keep (imitations, 0, f, y + 3 * N * f);
  cloth_imitations_spoil (imitations, &sound, 1., 1);
  for (guint i = N; i < N * FRAMES; i++)
    for (guint k = 0; k < 3; k++)
      if (r->seen[i] == 0.)
        g_assert_cmpfloat (imitations->list[0]->y[3 * i + k], ==, y[3 * i + k]);
      else
        g_assert_cmpfloat (imitations->list[0]->y[3 * i + k], !=, y[3 * i + k]);
  cloth_imitations_free (imitations);
  back = cloth_recording_correct (r, &m);
  for (guint i = 0; i < N * FRAMES; i++)
    for (guint k = 0; k < 3; k++) {
      g_assert_true (isfinite (back->y[3 * i + k] + back->velocity[3 * i + k]));
      if (i % COLUMNS < COLUMNS - 1)
        g_assert_cmpfloat (back->y[3 * i + k], ==, y[3 * (i + 1) + k]);
      else if (k == 2)          /* what no label shows lies with the rest */
        g_assert_cmpfloat (back->y[3 * i + k], >, 0.5);
    }
  for (guint k = 0; k < 3; k++)
    r->y[3 * (10 * N + 1) + k] = NAN;
  cloth_recording_interpolate (r);
  for (guint k = 0; k < 3; k++)
    assert_within (r->y[3 * (10 * N + 1) + k], 0.5 * (y[3 * (9 * N + 1) + k] +
            y[3 * (11 * N + 1) + k]), 1e-12);
  /* without a simulation all are filled in */
  r->simulated = FALSE;
  cloth_recording_interpolate (r);
  g_assert_cmpfloat (r->y[3 * (20 * N + 1)], !=, y[3 * (20 * N + 1)]);
}

/* A bell of width s takes the share 1 − exp (−ω²s²/2) of a sine; sharpening gives back all but
 * its third power. */
static void
test_smooth (void)
{
  static const gdouble widths[] = { 0.004, 0.02, 0.06, 0.1 };
  g_autoptr (ClothRecording) r = waves_new ();

  for (guint c = 0; c < G_N_ELEMENTS (widths); c++) {
    const ClothMeasurement m = fault ("smoothing", &widths[c]);
    const gdouble gain = exp (-0.5 * OMEGA * OMEGA * widths[c] * widths[c]);
    const guint edge = 10 + (guint) (12. * widths[c] * FPS);
    g_autofree gdouble *x = g_memdup2 (r->y, 3 * N * FRAMES * sizeof *r->y);
    g_autoptr (ClothRecording) sharp = cloth_recording_correct (r, &m);

    cloth_recording_measure (r, x, &m);
    for (guint i = 3 * N * edge; i < 3 * N * (FRAMES - edge); i++) {
      const guint v = i / 3 % N, k = i % 3;
      const gdouble middle = 0.3 * k + 0.01 * v;
      const gdouble sine = wave (v, k, r->times[i / 3 / N]) - middle;

      assert_within (x[i] - middle, gain * sine, 1e-5);
      assert_within (sharp->y[i] - middle,
          (1. + (1. - gain) * (2. - gain)) * sine, 1e-4);
      /* (1 + (1 − g) + (1 − g)²) g */
      assert_within (1. - (1. + (1. - gain) * (2. - gain)) * gain,
          pow (1. - gain, 3.), 1e-12);
    }
  }
}

/* Simulated positions as they would be recorded late; where they aren't known, as far off as the
 * first or the last one is when it was recorded. */
static void
test_measured (void)
{
  static const gdouble delays[] = { 0.033, -0.093 }, factor = 1.03;
  g_autoptr (ClothRecording) r = waves_new ();
  const gdouble end = r->times[FRAMES - 1];

  for (guint c = 0; c < 2; c++) {
    ClothMeasurement m = fault ("time_scale", &factor);
    g_autofree gdouble *x = g_new (gdouble, 3 * N * FRAMES);
    guint n_outside = 0;

    m.delay_s = delays[c];
    /* what is simulated is 0.2 m to the side */
    for (guint i = 0; i < 3 * N * FRAMES; i++)
      x[i] = r->y[i] + 0.2;
    cloth_recording_measure (r, x, &m);
    for (guint i = 0; i < 3 * N * FRAMES; i++) {
      const guint v = i / 3 % N, k = i % 3;
      const gdouble stamp = r->times[i / 3 / N];
      const gdouble t = (stamp - delays[c]) / factor;
      const gdouble known = CLAMP (t, 0., end);
      const gdouble recorded = t == known ? stamp : factor * known + delays[c];

      n_outside += t != known;
      assert_within (x[i] - r->y[i], wave (v, k, known) + 0.2 - wave (v, k,
              recorded), 2e-5);
    }
    g_assert_cmpuint (n_outside, ==, 3 * N * 2);
  }
}

/* A later recording with a delay taken off twice is one with both taken off; nothing is wrong at
 * the null. */
static void
test_null (void)
{
  static const gdouble none[CLOTH_EFFECT_MAX_PARAMETERS] = { 0. };
  const gdouble steps[3] = { 0.02, 0.04, 0.06 };
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothRecording) r = waves_new (), same = NULL, once = NULL;
  g_autoptr (ClothRecording) twice = NULL, both = NULL;
  g_autofree gdouble *x = g_memdup2 (r->y, 3 * N * FRAMES * sizeof *r->y);
  ClothMeasurement m;

  cloth_model_set_effect (model, cloth_effect_find ("smoothing"), none);
  cloth_model_set_effect (model, cloth_effect_find ("misalignment"), none);
  cloth_model_set_effect (model, cloth_effect_find ("axes_exchange"), NULL);
  g_assert_true (cloth_recording_find_measurement (r, model, &m, NULL));
  g_assert_true (cloth_measurement_is_null (&m));
  same = cloth_recording_correct (r, &m);
  cloth_recording_measure (r, x, &m);
  g_assert_cmpmem (same->y, 3 * N * FRAMES * sizeof *x, r->y,
      3 * N * FRAMES * sizeof *x);
  g_assert_cmpmem (same->velocity, 3 * N * FRAMES * sizeof *x, r->velocity,
      3 * N * FRAMES * sizeof *x);
  g_assert_cmpmem (x, 3 * N * FRAMES * sizeof *x, r->y,
      3 * N * FRAMES * sizeof *x);
  m = fault ("recording_delay", &steps[0]);
  once = cloth_recording_correct (r, &m);
  m = fault ("recording_delay", &steps[1]);
  twice = cloth_recording_correct (once, &m);
  m = fault ("recording_delay", &steps[2]);
  both = cloth_recording_correct (r, &m);
  for (guint i = 0; i < 3 * N * (FRAMES - 4); i++)
    assert_within (twice->y[i], both->y[i], 1e-12);
}

static void
test_impossible (void)
{
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothRecording) r = waves_new ();
  g_autoptr (ClothSensitivities) s = NULL;
  g_autoptr (GError) error = NULL, same = NULL;
  ClothEstimateOptions options;
  ClothMeasurement m;
  gdouble *z;
  gboolean sound;

  g_assert_true (cloth_model_set (model, "effects.axes_exchange.x", 2., NULL));
  g_assert_false (cloth_recording_find_measurement (r, model, &m, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL);
  g_assert_nonnull (strstr (error->message, "swing"));
  g_assert_nonnull (strstr (error->message, "each axis once"));
  cloth_estimate_options_init (&options);
  s = cloth_sensitivities_new (r, &options);
  z = g_new0 (gdouble, s->features->size);
  g_assert_false (cloth_sensitivities_run (s, &model, 1, &options, &z, &sound,
          &same));
  g_assert_cmpstr (same->message, ==, error->message);
  g_free (z);
}

/* A cloth that two clamps swing, in the world of its recording: what happens, at any time. */
typedef struct
{
  ClothScene *scene;
  ClothModel *model;
  gdouble *fine;                /* every 2.5 ms */
  guint n_fine;
} Truth;

#define FINE 400.

static void
truth_clear (Truth * t)
{
  cloth_scene_free (t->scene);
  cloth_model_free (t->model);
  g_free (t->fine);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Truth, truth_clear);

static void
move_clamps (ClothScene * scene)
{
  for (guint f = 0; f < scene->n_frames; f++)
    for (guint h = 0; h < 2; h++) {
      gdouble *at = scene->clamps + 6 * f + 3 * h, t = scene->times[f];

      at[1] += 0.08 * (1. - cos (2. * G_PI * 0.9 * t)) * (h ? 1. : 0.7);
      at[0] += (h ? -1. : 1.) * 0.02;
    }
}

static void
truth_init (Truth * t)
{
  g_autoptr (ClothSim) sim = NULL;

  *t = (Truth) {
  .n_fine = (guint) (FINE / FPS * (FRAMES + 20))};
  t->scene = cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.36f,
          0.3f), FPS, FRAMES + 20);
  cloth_scene_hold (t->scene, 0);
  cloth_scene_hold (t->scene, COLUMNS - 1);
  move_clamps (t->scene);
  t->model = model_new (0.2, 50.);
  t->model->damping_mass = 1.;
  t->model->damping_stiffness = 1e-3;
  t->fine = g_new (gdouble, 3 * N * t->n_fine);
  sim = run_new (t->scene, t->model);
  for (guint i = 0; i < t->n_fine; i++) {
    cloth_sim_advance (sim, i / FINE);
    cloth_sim_get_positions (sim, 0, t->fine + 3 * N * i);
  }
}

/* Between two of the fine times. */
static gdouble
truth_at (const Truth * truth, guint i, gdouble t)
{
  const gdouble at = CLAMP (t * FINE, 0., truth->n_fine - 1.001);
  const guint k = (guint) at;

  return truth->fine[3 * N * k + i] + (at - k) * (truth->fine[3 * N * (k + 1) +
          i] - truth->fine[3 * N * k + i]);
}

/* @film: what becomes of a vertex that is recorded in a frame stamped @t */
typedef void (*Film) (const Truth * truth, guint vertex, gdouble t,
    gdouble place[3]);

static void
film_well (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  for (guint k = 0; k < 3; k++)
    place[k] = truth_at (truth, 3 * vertex + k, t);
}

static void
film_large (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  film_well (truth, vertex, t, place);
  for (guint k = 0; k < 3; k++)
    place[k] *= 1.03;
}

static void
film_late (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  film_well (truth, vertex, t - 0.046, place);
}

static void
film_fast (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  film_well (truth, vertex, t / 1.04, place);
}

/* By the rotation vector (0, 0, 4°), then to the side. */
static void
film_turned (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  const gdouble angle = 4. * G_PI / 180.;
  gdouble x[3];

  film_well (truth, vertex, t, x);
  place[0] = cos (angle) * x[0] - sin (angle) * x[1] + 0.012;
  place[1] = sin (angle) * x[0] + cos (angle) * x[1];
  place[2] = x[2] - 0.02;
}

static void
film_smooth (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  const gdouble width = 0.05;
  gdouble weights = 0.;

  memset (place, 0, 3 * sizeof *place);
  for (gint i = -80; i <= 80; i++) {
    const gdouble off = i / FINE, weight = exp (-0.5 * off * off / width /
        width);

    for (guint k = 0; k < 3; k++)
      place[k] += weight * truth_at (truth, 3 * vertex + k, t + off);
    weights += weight;
  }
  for (guint k = 0; k < 3; k++)
    place[k] /= weights;
}

static void
film_y_up (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  gdouble x[3];

  film_well (truth, vertex, t, x);
  place[0] = x[0];
  place[1] = x[2];
  place[2] = -x[1];
}

static void
film_mirrored (const Truth * truth, guint vertex, gdouble t, gdouble place[3])
{
  film_well (truth, vertex / COLUMNS * COLUMNS + COLUMNS - 1 -
      vertex % COLUMNS, t, place);
}

static ClothRecording *
film (const Truth * truth, Film how)
{
  ClothRecording *r = recording_new (FRAMES);
  ClothRandom random;

  cloth_random_init (&random, 5);
  cloth_scene_hold (r->scene, 0);
  cloth_scene_hold (r->scene, COLUMNS - 1);
  move_clamps (r->scene);
  for (guint i = 0; i < N * FRAMES; i++)
    how (truth, i % N, r->times[i / N], r->y + 3 * i);
  for (guint i = 0; i < 3 * N * FRAMES; i++)
    r->y[i] += NOISE * cloth_random_gaussian (&random);
  cloth_recording_differentiate (r);
  return r;
}

static ClothCandidates *
list (const ClothRecording * r, const ClothModel * model, const gchar * id,
    ClothCandidatesFlags flags)
{
  const gchar *const ids[] = { id, NULL };
  g_autoptr (GError) error = NULL;
  ClothCandidates *candidates = cloth_candidates_new (model, r, ids, flags,
      NULL, NULL, &error);

  g_assert_no_error (error);
  return candidates;
}

/* Fits what an effect's parameters are, from none on. */
static void
assert_recovered (const Truth * truth, Film how, const gchar * id,
    const gdouble * expected, const gdouble * tolerance)
{
  g_autoptr (ClothRecording) r = film (truth, how);
  g_autoptr (ClothCandidates) candidates = list (r, truth->model, id,
      CLOTH_CANDIDATES_MEASUREMENT);
  g_autoptr (ClothSensitivities) s = NULL;
  g_autoptr (ClothModel) fitted = NULL;
  g_autoptr (GError) error = NULL;
  const guint m = candidates->directions->len;
  guint directions[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble precisions[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble sigmas[CLOTH_EFFECT_MAX_PARAMETERS];
  ClothEstimateOptions options;

  g_assert_cmpuint (m, ==, cloth_effect_find (id)->n_parameters);
  cloth_estimate_options_init (&options);
  s = cloth_sensitivities_new (r, &options);
  for (guint i = 0; i < m; i++) {
    const gdouble prior = cloth_candidates_direction (candidates, i)->prior;

    directions[i] = i;
    precisions[i] = 1. / (prior * prior);
  }
  fitted = cloth_gauss_newton_fit (&s, 1, candidates, truth->model, directions,
      precisions, m, NULL, CLOTH_FIT_DEFAULT, 8, &options, sigmas, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < m; i++) {
    const gchar *name = cloth_candidates_direction (candidates, i)->name;
    gdouble value;

    g_assert_true (cloth_model_get (fitted, name, &value, NULL));
    g_test_message ("%s = %.5g ± %.2g, is %g", name, value, sigmas[i],
        expected[i]);
  }
  for (guint i = 0; i < m; i++) {
    const gchar *name = cloth_candidates_direction (candidates, i)->name;
    gdouble value;

    cloth_model_get (fitted, name, &value, NULL);
    assert_within (value, expected[i], tolerance[i]);
  }
}

static void
test_recovered (void)
{
  const gdouble large = 1.03, late = 0.046, fast = 1.04, width = 0.05;
  const gdouble turned[6] = { 0., 0., 4., 0.012, 0., -0.02 };
  const gdouble near[6] = { 0.1, 0.1, 0.1, 1e-3, 1e-3, 1e-3 };
  const gdouble of_scale = 1e-3, of_delay = 1e-3, of_rate = 1e-3;
  const gdouble of_width = 5e-3;
  g_auto (Truth) truth = { NULL };

  truth_init (&truth);
  assert_recovered (&truth, film_large, "position_scale", &large, &of_scale);
  assert_recovered (&truth, film_late, "recording_delay", &late, &of_delay);
  assert_recovered (&truth, film_fast, "time_scale", &fast, &of_rate);
  assert_recovered (&truth, film_smooth, "smoothing", &width, &of_width);
  assert_recovered (&truth, film_turned, "misalignment", turned, near);
}

/* What was recorded well is found to be so. */
static void
test_nothing_wrong (void)
{
  const gdouble one = 1., zero[6] = { 0. };
  const gdouble near[6] = { 0.1, 0.1, 0.1, 1e-3, 1e-3, 1e-3 };
  const gdouble of_scale = 1e-3, of_delay = 1e-3, of_rate = 1e-3;
  const gdouble of_width = 0.012;
  g_auto (Truth) truth = { NULL };

  truth_init (&truth);
  assert_recovered (&truth, film_well, "position_scale", &one, &of_scale);
  assert_recovered (&truth, film_well, "recording_delay", zero, &of_delay);
  assert_recovered (&truth, film_well, "time_scale", &one, &of_rate);
  assert_recovered (&truth, film_well, "smoothing", zero, &of_width);
  assert_recovered (&truth, film_well, "misalignment", zero, near);
}

static gdouble
find_square (const gdouble * z, gsize n)
{
  gdouble sum = 0.;

  for (gsize i = 0; i < n; i++)
    sum += z[i] * z[i];
  return sum;
}

/* Of all trials the right one alone is as near as noise, and in no other are the clamps where they
 * are logged; with nothing wrong there is no trial at all. */
static void
assert_trial (const Truth * truth, Film how, const gchar * id, guint n,
    const gdouble * expected)
{
  const ClothEffect *effect = cloth_effect_find (id);
  g_autoptr (ClothRecording) r = film (truth, how);
  g_autoptr (ClothCandidates) candidates = list (r, truth->model, id,
      CLOTH_CANDIDATES_MEASUREMENT | CLOTH_CANDIDATES_TRIALS);
  g_autoptr (ClothSensitivities) s = NULL;
  g_autoptr (GError) error = NULL;
  ClothEstimateOptions options;
  guint directions[CLOTH_EFFECT_MAX_TRIED], found = 0;
  gsize size;

  g_test_message ("%s: %u trials", id, candidates->list->len);
  g_assert_cmpuint (candidates->list->len, ==, n);
  g_assert_cmpuint (candidates->directions->len, ==, n);
  if (!n)
    return;
  cloth_estimate_options_init (&options);
  s = cloth_sensitivities_new (r, &options);
  for (guint i = 0; i < n; i++)
    directions[i] = i;
  g_assert_true (cloth_sensitivities_linearise (s, candidates, truth->model,
          directions, n, &options, &error));
  g_assert_no_error (error);
  size = s->features->size;
  for (guint i = 0; i < n; i++) {
    const ClothCandidate *c = &g_array_index (candidates->list, ClothCandidate,
        i);
    g_autofree gdouble *z = g_memdup2 (s->z, size * sizeof *z);
    gboolean right = TRUE;

    for (guint k = 0; k < effect->n_parameters; k++)
      right = right && c->values[k] == expected[k];
    for (gsize k = 0; k < size; k++)
      z[k] += s->columns[i * size + k];
    g_test_message ("trial %u: %s %.3g of %.3g", i, right ? "right" : "wrong",
        find_square (z, size) / size, find_square (s->z, size) / size);
    found += right;
    if (right)
      g_assert_cmpfloat (find_square (z, size), <, 3. * size);
    else
      g_assert_true (!s->sound[i] || find_square (z, size) > 30. * size);
  }
  g_assert_cmpuint (found, ==, 1);
  g_assert_cmpfloat (find_square (s->z, size), >, 30. * size);
}

static void
test_trials (void)
{
  const gdouble y_up[3] = { 1., 3., -2. }, mirrored[4] = { 1. };
  g_auto (Truth) truth = { NULL };

  truth_init (&truth);
  assert_trial (&truth, film_y_up, "axes_exchange", 3, y_up);
  assert_trial (&truth, film_mirrored, "label_exchange", 5, mirrored);
  assert_trial (&truth, film_well, "label_exchange", 0, NULL);
}

typedef struct
{
  const ClothSensitivities *s;
  gdouble factor;
  gdouble *z;
} Scaled;

static void
add_scaled (gpointer data, guint model, guint frame, const gdouble * positions)
{
  Scaled *scaled = data;
  gdouble x[3 * N];

  for (guint i = 0; i < 3 * N; i++)
    x[i] = scaled->factor * positions[i];
  cloth_features_add (scaled->s->features, scaled->s->recording, frame, x,
      scaled->z);
}

/* The column of the scale is what a chain makes of a recording that is made smaller by hand, a
 * simulation drawn to it, and its positions made larger again. */
static void
test_column (void)
{
  const guint direction = 0;
  const gdouble gain = 1600.;
  g_auto (Truth) truth = { NULL };
  g_autoptr (ClothRecording) r = NULL;
  g_autoptr (ClothCandidates) candidates = NULL;
  g_autoptr (ClothSensitivities) s = NULL;
  g_autoptr (GError) error = NULL;
  ClothEstimateOptions options;
  const ClothModel *model;
  ClothRecording small;
  Scaled scaled[2];
  gboolean sound;
  gdouble step;
  gsize size;

  truth_init (&truth);
  model = truth.model;
  r = film (&truth, film_well);
  candidates = list (r, truth.model, "position_scale",
      CLOTH_CANDIDATES_MEASUREMENT);
  step = cloth_candidates_direction (candidates, 0)->step;
  cloth_estimate_options_init (&options);
  options.gain = gain;
  s = cloth_sensitivities_new (r, &options);
  size = s->features->size;
  g_assert_true (cloth_sensitivities_linearise (s, candidates, truth.model,
          &direction, 1, &options, &error));
  for (guint c = 0; c < 2; c++) {
    const ClothRecording *target = &small;

    scaled[c] = (Scaled) {
    s, 1. + c * step, g_new0 (gdouble, size)};
    small = *r;
    small.y = g_new (gdouble, 3 * N * FRAMES);
    small.velocity = g_new (gdouble, 3 * N * FRAMES);
    for (guint i = 0; i < 3 * N * FRAMES; i++) {
      small.y[i] = r->y[i] / scaled[c].factor;
      small.velocity[i] = r->velocity[i] / scaled[c].factor;
    }
    g_assert_true (cloth_rollout_nudged (&target, &model, &gain, 1,
            &options.rollout, add_scaled, &scaled[c], &sound, &error));
    g_free (small.y);
    g_free (small.velocity);
  }
  for (gsize i = 0; i < size; i++) {
    const gdouble column = (scaled[1].z[i] - scaled[0].z[i]) / step;

    /* single numbers: what is left is their rounding */
    assert_within (s->z[i], scaled[0].z[i], 1e-3);
    assert_within (s->columns[i], column, 1e-3 * fabs (column) + 0.3);
  }
  g_free (scaled[0].z);
  g_free (scaled[1].z);
}

static guint
count (const ClothCandidates * c, const gchar * id)
{
  guint n = 0;

  for (guint i = 0; i < c->list->len; i++)
    n += strcmp (g_array_index (c->list, ClothCandidate, i).effect->id,
        id) == 0;
  return n;
}

typedef struct
{
  const gchar *id;
  gchar *reason;
} Skipped;

static void
note_skip (gpointer data, const ClothEffect * effect, const gchar * reason)
{
  Skipped *skipped = data;

  if (strcmp (effect->id, skipped->id) != 0)
    return;
  g_assert_null (skipped->reason);
  skipped->reason = g_strdup (reason);
}

static void
assert_skipped (const ClothRecording * r, const ClothModel * model,
    const gchar * id, ClothCandidatesFlags flags, const gchar * why)
{
  const gchar *const ids[] = { id, NULL };
  Skipped skipped = { id, NULL };
  g_autoptr (ClothCandidates) c = cloth_candidates_new (model, r, ids, flags,
      note_skip, &skipped, NULL);

  g_assert_cmpuint (c->list->len, ==, 0);
  g_assert_nonnull (skipped.reason);
  g_test_message ("%s: %s", id, skipped.reason);
  g_assert_nonnull (strstr (skipped.reason, why));
  g_free (skipped.reason);
}

/* They are listed where they are asked for only, and never where they can't be. */
static void
test_listed (void)
{
  static const gchar *const trials[] = { "self_contact", "friction",
    "time_step", "mesh_resolution", "mesh_diagonals"
  };
  static const gchar *const faults[] = { "position_scale", "time_scale",
    "recording_delay", "smoothing", "misalignment"
  };
  const ClothCandidatesFlags all = CLOTH_CANDIDATES_MEASUREMENT |
      CLOTH_CANDIDATES_TRIALS;
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothRecording) r = waves_new ();
  g_autoptr (ClothCandidates) usual = cloth_candidates_new (model, r, NULL,
      CLOTH_CANDIDATES_DEFAULT, NULL, NULL, NULL);
  g_autoptr (ClothCandidates) more = cloth_candidates_new (model, r, NULL,
      all, NULL, NULL, NULL);

  for (guint i = 0; i < G_N_ELEMENTS (trials); i++) {
    g_assert_cmpuint (count (usual, trials[i]), ==, 0);
    g_assert_cmpuint (count (more, trials[i]), ==, 1);
    assert_skipped (r, model, trials[i], CLOTH_CANDIDATES_MEASUREMENT,
        i == 0 ? "no derivative" : i == 1 ? "obstacle" : "projected out");
  }
  for (guint i = 0; i < G_N_ELEMENTS (faults); i++) {
    const gchar *const named[] = { faults[i], NULL };
    g_autoptr (ClothCandidates) one = cloth_candidates_new (model, r, named,
        all, NULL, NULL, NULL);

    g_assert_cmpuint (count (usual, faults[i]), ==, 0);
    /* a clock is looked for by its name only */
    g_assert_cmpuint (count (more, faults[i]), ==, i == 1 || i == 2 ? 0 : 1);
    g_assert_cmpuint (count (one, faults[i]), ==, 1);
  }
  g_assert_cmpuint (count (usual, "label_exchange"), ==, 0);
  /* nothing is held: all that fit */
  g_assert_cmpuint (count (more, "label_exchange"), ==, 7);
  g_assert_cmpuint (count (more, "axes_exchange"), ==, 9);
  assert_skipped (r, model, "axes_exchange", CLOTH_CANDIDATES_MEASUREMENT,
      "not looked for");
  cloth_model_set (model, "effects.self_contact.thickness", 0.002, NULL);
  assert_skipped (r, model, "self_contact", all, "has it already");
  r->scene->topology->columns = r->scene->topology->rows = 0;
  assert_skipped (r, model, "label_exchange", all, "no grid");
  for (guint f = 0; f < r->scene->topology->n_faces; f++)
    r->scene->topology->faces[4 * f + 3] = CLOTH_NO_VERTEX;
  assert_skipped (r, model, "mesh_diagonals", all, "no squares");
  memset (r->seen, 0, N * FRAMES * sizeof *r->seen);
  assert_skipped (r, model, "friction", all, "Nobody saw");
}

/* It is there or it is not. */
static void
test_present (void)
{
  const gdouble up = 1., down = -1., little = 0.4, more = 0.6;
  const guint first = 0;
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothRecording) r = waves_new ();
  g_autoptr (ClothCandidates) c = list (r, model, "friction",
      CLOTH_CANDIDATES_TRIALS);
  g_autoptr (ClothModel) with = cloth_candidates_move (c, model, &first, &up,
      1);
  g_autoptr (ClothModel) without = cloth_candidates_move (c, with, &first,
      &down, 1);
  g_autoptr (ClothModel) half = cloth_candidates_move (c, model, &first,
      &little, 1);
  g_autoptr (ClothModel) most = cloth_candidates_move (c, model, &first, &more,
      1);
  const ClothDirection *d = cloth_candidates_direction (c, 0);
  gdouble value, lowest = INFINITY;

  g_assert_true (d->present && d->one_sided);
  g_assert_cmpfloat (d->step, ==, 1.);
  g_assert_cmpfloat (cloth_candidates_place (c, model, 0), ==, 0.);
  g_assert_cmpfloat (cloth_candidates_place (c, with, 0), ==, 1.);
  g_assert_cmpfloat (cloth_candidates_place (c, most, 0), ==, 1.);
  g_assert_cmpuint (without->effects->len, ==, 0);
  g_assert_cmpuint (half->effects->len, ==, 0);
  g_assert_false (cloth_candidates_has_room (c, model, 0, d->step));
  g_assert_true (cloth_model_get (with, "effects.friction.coefficient", &value,
          NULL));
  g_assert_cmpfloat (value, ==, 0.4);
  /* the mean of five frames, lowest of all */
  for (guint v = 0; v < N; v++)
    for (guint f = 0; f + 5 <= FRAMES; f++) {
      gdouble mean = 0.;

      for (guint i = 0; i < 5; i++)
        mean += wave (v, 2, (f + i) / FPS) / 5.;
      lowest = MIN (lowest, mean);
    }
  g_assert_true (cloth_model_get (with, "effects.friction.floor", &value,
          NULL));
  assert_within (value, lowest, 1e-12);
}

/* Trials of the simulator change what is simulated, and their columns are just this. */
static void
test_changes (void)
{
  static const gchar *const ids[] = { "self_contact", "time_step",
    "mesh_resolution", "mesh_diagonals", NULL
  };
  g_auto (Truth) truth = { NULL };
  g_autoptr (ClothRecording) r = NULL;
  g_autoptr (ClothCandidates) c = NULL;
  g_autoptr (ClothSensitivities) s = NULL;
  g_autoptr (GError) error = NULL;
  ClothEstimateOptions options;
  guint directions[4] = { 0, 1, 2, 3 };
  gsize size;

  truth_init (&truth);
  r = film (&truth, film_well);
  c = cloth_candidates_new (truth.model, r, ids, CLOTH_CANDIDATES_TRIALS, NULL,
      NULL, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (c->directions->len, ==, 4);
  cloth_estimate_options_init (&options);
  s = cloth_sensitivities_new (r, &options);
  size = s->features->size;
  g_assert_true (cloth_sensitivities_linearise (s, c, truth.model, directions,
          4, &options, &error));
  g_assert_no_error (error);
  for (guint i = 0; i < 4; i++) {
    const gdouble one = 1.;
    g_autofree gdouble *z = g_new0 (gdouble, size);
    ClothModel *with = cloth_candidates_move (c, truth.model, &i, &one, 1);
    gboolean sound;

    g_assert_true (s->sound[i]);
    g_assert_true (cloth_sensitivities_run (s, &with, 1, &options, &z, &sound,
            &error));
    for (gsize k = 0; k < size; k++)
      assert_within (z[k] - s->z[k], s->columns[i * size + k], 1e-2);
    g_test_message ("%s: %.3g", cloth_candidates_direction (c, i)->name,
        find_square (s->columns + i * size, size) / size);
    /* a sheet that hangs open touches itself nowhere */
    if (i)
      g_assert_cmpfloat (find_square (s->columns + i * size, size), >, 0.);
    cloth_model_free (with);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/correction/late", test_late);
  g_test_add_func ("/correction/hidden", test_hidden);
  g_test_add_func ("/correction/places", test_places);
  g_test_add_func ("/correction/shifted", test_shifted);
  g_test_add_func ("/correction/mapped-noise", test_mapped_noise);
  g_test_add_func ("/correction/simulated", test_simulated);
  g_test_add_func ("/correction/smooth", test_smooth);
  g_test_add_func ("/correction/measured", test_measured);
  g_test_add_func ("/correction/null", test_null);
  g_test_add_func ("/correction/impossible", test_impossible);
  g_test_add_func ("/correction/listed", test_listed);
  g_test_add_func ("/correction/present", test_present);
  g_test_add_func ("/correction/column", test_column);
  g_test_add_func ("/correction/changes", test_changes);
  g_test_add_func ("/correction/recovered", test_recovered);
  g_test_add_func ("/correction/nothing-wrong", test_nothing_wrong);
  g_test_add_func ("/correction/trials", test_trials);
  return g_test_run ();
}
