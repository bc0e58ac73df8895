/* Simulations drawn to recordings of their own or let go, against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/error.h"
#include "gst/fit/nudge/nudge.h"

#include "simscene.h"

#define COLUMNS 5
#define ROWS 4
#define N (COLUMNS * ROWS)
#define FRAMES 26
#define FPS 100.
#define GAIN 400.

/* A flat sheet that nothing holds, each vertex where it would be after moving at @speed and
 * with @acceleration along x. */
static ClothRecording *
moving_sheet (gdouble speed, gdouble acceleration, gdouble seen)
{
  ClothRecording *r = g_new0 (ClothRecording, 1);

  r->name = g_strdup ("sheet");
  r->scene = cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.4f,
          0.3f), FPS, FRAMES);
  memset (r->scene->gravity, 0, sizeof r->scene->gravity);
  r->n = N;
  r->n_frames = FRAMES;
  r->times = g_memdup2 (r->scene->times, FRAMES * sizeof (gdouble));
  r->sigma = 1e-3;
  r->y = g_new (gdouble, 3 * N * FRAMES);
  r->velocity = g_new0 (gdouble, 3 * N * FRAMES);
  r->seen = g_new (gdouble, N * FRAMES);
  for (guint i = 0; i < N * FRAMES; i++) {
    gdouble t = r->times[i / N];

    memcpy (r->y + 3 * i, r->scene->positions + 3 * (i % N),
        3 * sizeof (gdouble));
    r->y[3 * i] += speed * t + 0.5 * acceleration * t * t;
    r->velocity[3 * i] = speed + acceleration * t;
    r->seen[i] = seen;
  }
  return r;
}

#define MODELS 4

typedef struct
{
  gdouble x[MODELS][FRAMES][3 * N];
} Kept;

static void
keep (gpointer data, guint model, guint frame, const gdouble * positions)
{
  memcpy (((Kept *) data)->x[model][frame], positions,
      3 * N * sizeof (gdouble));
}

static void
assert_no_failure (gpointer data, const ClothRecording * recording,
    const ClothModel * model, gdouble sound_s)
{
  g_assert_not_reached ();
}

/* e = y − x follows e″ + 2ζω e′ + ω² e = a from rest, ω² = g, ζ = ½: each model lags behind
 * the recording of its own. One whose recording shows nothing flies on. */
static void
test_own_targets (void)
{
  const gdouble accelerations[3] = { 0., 2., -5. }, omega = sqrt (GAIN);
  g_autoptr (ClothModel) model = model_new (0.2, 50.);
  const ClothModel *models[4] = { model, model, model, model };
  const gdouble gains[4] = { GAIN, GAIN, GAIN, GAIN };
  const ClothRolloutOptions options = {.failed = assert_no_failure };
  g_autoptr (ClothRecording) a = moving_sheet (1., accelerations[0], 1.);
  g_autoptr (ClothRecording) b = moving_sheet (0.5, accelerations[1], 1.);
  g_autoptr (ClothRecording) c = moving_sheet (-1., accelerations[2], 1.);
  g_autoptr (ClothRecording) d = moving_sheet (3., 7., 0.);
  const ClothRecording *targets[4] = { a, b, c, d };
  g_autofree Kept *kept = g_new (Kept, 1);
  g_autoptr (GError) error = NULL;
  gboolean sound[4];

  model->time_step = 1e-4;
  cloth_rollout_nudged (targets, models, gains, 4, &options, keep, kept, sound,
      &error);
  g_assert_no_error (error);
  for (guint m = 0; m < 4; m++)
    g_assert_true (sound[m]);
  for (guint frame = 0; frame < FRAMES; frame++) {
    gdouble t = a->times[frame], wd = omega * sqrt (0.75);
    gdouble lag = (1. - exp (-0.5 * omega * t) * (cos (wd * t) +
            0.5 * omega / wd * sin (wd * t))) / GAIN;

    for (guint i = 0; i < N; i++) {
      for (guint m = 0; m < 3; m++)
        assert_within (targets[m]->y[3 * (frame * N + i)] -
            kept->x[m][frame][3 * i], accelerations[m] * lag, 2e-4);
      assert_within (kept->x[3][frame][3 * i],
          d->scene->positions[3 * i] + 3. * t, 1e-4);
    }
  }
}

static gdouble step_of_time = 4., halved = 2.;

/* Alone, together with models of other numerics, and with other threads: the same bytes. */
static void
test_batches (void)
{
  g_autoptr (ClothRecording) a = moving_sheet (1., 20., 1.);
  g_autoptr (ClothRecording) b = moving_sheet (0.5, -30., 1.);
  ClothModel *models[MODELS];
  const ClothRecording *targets[MODELS] = { a, b, a, b };
  const gdouble gains[MODELS] = { 100., 0., 900., 1600. };
  const guint threads[] = { 1, 2, 3, 7 };
  g_autofree Kept *all = g_new (Kept, 1), *alone = g_new (Kept, 1);
  ClothRolloutOptions options = {.failed = assert_no_failure };
  gboolean sound[MODELS];

  for (guint m = 0; m < MODELS; m++) {
    models[m] = model_new (0.2, 50.);
    cloth_model_set (models[m], "air_density", 1.2, NULL);
    cloth_model_set (models[m], "effects.air_drag.C", 1., NULL);
  }
  models[1]->force_model = CLOTH_FORCE_MASS_SPRING;
  models[2]->integrator = CLOTH_INTEGRATOR_IMPLICIT;
  cloth_model_set_effect (models[2], &cloth_effect_time_step, &step_of_time);
  cloth_model_set_effect (models[3], &cloth_effect_mesh_resolution, &halved);
  for (guint k = 0; k < G_N_ELEMENTS (threads); k++) {
    options.threads = threads[k];
    memset (all, 0, sizeof *all);
    g_assert_true (cloth_rollout_nudged (targets,
            (const ClothModel * const *) models, gains, MODELS, &options, keep,
            all, sound, NULL));
    for (guint m = 0; m < MODELS; m++) {
      const ClothModel *model = models[m];

      g_assert_true (sound[m]);
      g_assert_true (cloth_rollout_nudged (&targets[m], &model, &gains[m], 1,
              &options, keep, alone, sound + m, NULL));
      g_assert_cmpmem (all->x[m], sizeof all->x[m], alone->x[0],
          sizeof alone->x[0]);
    }
  }
  for (guint m = 0; m < MODELS; m++)
    cloth_model_free (models[m]);
}

/* What is let go falls, whatever the recording does: x = v t + ½ g t². */
static void
test_free (void)
{
  g_autoptr (ClothRecording) r = moving_sheet (0.7, 0., 1.);
  g_autoptr (ClothModel) model = model_new (0.2, 50.);
  const ClothModel *models[1] = { model };
  const ClothRolloutOptions options = {.failed = assert_no_failure };
  g_autofree Kept *kept = g_new (Kept, 1);
  gboolean sound;

  r->scene->gravity[2] = -9.81;
  for (guint i = 3 * N; i < 3 * N * FRAMES; i++)
    r->y[i] = 100.;
  g_assert_true (cloth_rollout_free (r, models, 1, &options, keep, kept, &sound,
          NULL));
  g_assert_true (sound);
  for (guint frame = 0; frame < FRAMES; frame++)
    for (guint i = 0; i < N; i++) {
      gdouble t = r->times[frame];

      assert_within (kept->x[0][frame][3 * i],
          r->scene->positions[3 * i] + 0.7 * t, 1e-5);
      /* steps of less than 2 ms: half of one is too late */
      assert_within (kept->x[0][frame][3 * i + 2],
          r->scene->positions[3 * i + 2] - 0.5 * 9.81 * t * t, 5e-3);
    }
}

typedef struct
{
  guint n;
  const ClothModel *model;
  const ClothRecording *recording;
  gdouble last;
} Told;

static void
note_failure (gpointer data, const ClothRecording * recording,
    const ClothModel * model, gdouble sound_s)
{
  Told *told = data;

  told->n++;
  told->model = model;
  told->recording = recording;
}

static gboolean
stop_at_half (gpointer data, gdouble share)
{
  Told *told = data;

  g_assert_cmpfloat (share, >, told->last);
  told->last = share;
  return share < 0.5;
}

/* One that diverges is named with the recording that drew it; the others go on. */
static void
test_diverging (void)
{
  g_autoptr (ClothRecording) a = moving_sheet (1., 0., 1.);
  g_autoptr (ClothRecording) b = moving_sheet (1., 0., 1.);
  g_autoptr (ClothModel) good = model_new (0.2, 50.);
  g_autoptr (ClothModel) bad = model_new (0.2, 5e4);
  const ClothModel *models[2] = { good, bad };
  const ClothRecording *targets[2] = { a, b };
  const gdouble gains[2] = { GAIN, GAIN };
  Told told = { 0 };
  const ClothRolloutOptions options = {.failed = note_failure,.data = &told };
  g_autofree Kept *kept = g_new (Kept, 1);
  gboolean sound[2];

  bad->time_step = 0.01;
  b->y[0] += 0.05;
  g_assert_true (cloth_rollout_nudged (targets, models, gains, 2, &options,
          keep, kept, sound, NULL));
  g_assert_true (sound[0]);
  g_assert_false (sound[1]);
  g_assert_cmpuint (told.n, ==, 1);
  g_assert_true (told.model == bad);
  g_assert_true (told.recording == b);
}

/* Progress goes over all models, stops all; what can't be simulated says so. */
static void
test_refused (void)
{
  g_autoptr (ClothRecording) r = moving_sheet (1., 0., 1.);
  g_autoptr (ClothModel) a = model_new (0.2, 50.);
  g_autoptr (ClothModel) b = model_new (0.2, 50.);
  const ClothModel *models[2] = { a, b };
  Told told = { 0 };
  ClothRolloutOptions options = {.progress = stop_at_half,.data = &told };
  g_autofree Kept *kept = g_new (Kept, 1);
  g_autoptr (GError) error = NULL;
  const gdouble pattern = 1.5;
  gboolean sound[2];

  b->integrator = CLOTH_INTEGRATOR_IMPLICIT;
  g_assert_false (cloth_rollout_free (r, models, 2, &options, keep, kept, sound,
          &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED);
  g_clear_error (&error);
  cloth_model_set_effect (b, &cloth_effect_mesh_diagonals, &pattern);
  g_assert_false (cloth_rollout_free (r, models, 2, &options, keep, kept, sound,
          &error));
  g_assert_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL);
  g_assert_nonnull (strstr (error->message, "mesh_diagonals"));
}

/* Windows have as many frames whether times are even, late by a rounding, or jitter by a millisecond. */
static void
test_windows (void)
{
  static const struct
  {
    gdouble fps, jitter_s;
    guint frames;               /* of a window of 0.3 s */
  } cases[] = {
    {50., 0., 15}, {50., 1e-7, 15}, {50., 1e-3, 15}, {30000. / 1001., 0., 9},
    {60., 1e-3, 18}
  };
  gdouble times[91];

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    ClothRecording r = {.n_frames = G_N_ELEMENTS (times),.times = times };
    g_autofree guint *windows = NULL;

    for (guint f = 0; f < r.n_frames; f++)
      times[f] = f / cases[i].fps + cases[i].jitter_s * (f * 7 % 5 / 2. - 1.);
    windows = cloth_rollout_list_windows (&r, 0.3);
    for (guint f = 1; f < r.n_frames; f++)
      g_assert_cmpuint (windows[f], ==, (f - 1) / cases[i].frames);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/rollout/own-targets", test_own_targets);
  g_test_add_func ("/rollout/batches", test_batches);
  g_test_add_func ("/rollout/free", test_free);
  g_test_add_func ("/rollout/diverging", test_diverging);
  g_test_add_func ("/rollout/windows", test_windows);
  g_test_add_func ("/rollout/refused", test_refused);
  return g_test_run ();
}
