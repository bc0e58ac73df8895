/* Which capture parts which effects: truths of physics, on a small sheet that hangs from
 * two corners.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/gap/diagnose.h"
#include "gst/gap/design/experiment.h"
#include "gst/effect/effect.h"
#include "tests/common/gaprecord.h"

static const TestGapSheet sheet = { 9, 9, 40, 0.16, 0.16, 50., 3e-4 };

/* Of the prior of the number that may be fitted, and what multiples of the variance
 * features of one cause are taken to scatter by. */
#define FREE_PRECISION 1.
#define OVERDISPERSION 5.

static gchar *parent;
static ClothTake *take;

/* Two corners nearer to each other than on the flat cloth. */
static void
hold_at (guint held, gdouble t, gfloat p[3])
{
  p[0] = held ? 0.15f : 0.01f;
  p[1] = p[2] = 0.f;
}

static ClothModel *
model_new (void)
{
  ClothModel *model = cloth_model_new ();

  model->areal_density = 0.15;
  model->stretch_warp = model->stretch_weft = 40.;
  model->shear = 12.;
  model->bending_warp = model->bending_weft = 3e-5;
  model->damping_mass = 0.3;
  model->damping_stiffness = 5e-4;
  return model;
}

static ClothModelEffect
effect (const gchar * id, gdouble a, gdouble b)
{
  ClothModelEffect e = { cloth_effect_find (id) };

  for (guint k = 0; k < e.effect->n_parameters; k++)
    e.values[k] = e.effect->parameters[k].null_value;
  e.values[0] = a;
  if (e.effect->n_parameters > 1)
    e.values[1] = b;
  return e;
}

/* How it is tried: all but the model and the take have defaults. */
typedef struct
{
  guint threads;
  gboolean free;                /* whether damping.mass may be fitted */
  gdouble discrepancy_variance; /* in all features */
  ClothRolloutProgress progress;
  guint64 simulations;          /* out */
  gdouble seconds;              /* out */
} How;

static GArray *
try_on (const ClothRecording * recording, const ClothModelEffect * members,
    guint n, How * how, GError ** error)
{
  static const gchar *const none[] = { NULL };
  const gdouble precisions[] = { FREE_PRECISION };
  g_autoptr (ClothModel) model = model_new ();
  g_autoptr (ClothCandidates) candidates = NULL;
  gdouble discrepancy_variance[1000];
  const ClothPowerSpectrum power =
      { G_N_ELEMENTS (discrepancy_variance), discrepancy_variance };
  ClothExperiment e = { recording, model, NULL, precisions, &power };
  ClothEstimateOptions options;
  GArray *trials;
  gint64 start = g_get_monotonic_time ();

  for (guint i = 0; i < G_N_ELEMENTS (discrepancy_variance); i++)
    discrepancy_variance[i] = how->discrepancy_variance;
  if (how->free) {
    ClothModelFree f = { g_strdup ("damping.mass"), {0., 20.}
    };

    g_array_append_val (model->free, f);
  }
  candidates = cloth_candidates_new (model, recording, none, TRUE, NULL,
      NULL, NULL);
  e.candidates = candidates;
  cloth_estimate_options_init (&options);
  options.overdispersion = OVERDISPERSION;
  options.rollout.threads = how->threads;
  options.rollout.progress = how->progress;
  trials = cloth_experiment_try (&e, members, n, &options, error);
  how->simulations = options.simulations;
  how->seconds = (g_get_monotonic_time () - start) * 1e-6;
  return trials;
}

static GArray *
try_members (const ClothModelEffect * members, guint n, How * how)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) recording = cloth_recording_new (take, &error);
  GArray *trials;

  g_assert_no_error (error);
  trials = try_on (recording, members, n, how, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < trials->len; i++) {
    const ClothTrial *t = &g_array_index (trials, ClothTrial, i);

    g_test_message ("%s %s: motion %u at %g Hz: %g", members[0].effect->id,
        members[n - 1].effect->id, t->motion, t->fps, t->log_bayes_factor);
  }
  g_test_message ("%.2f s", how->seconds);
  return trials;
}

static gdouble
find (const GArray * trials, ClothStageMotion motion)
{
  for (guint i = 0; i < trials->len; i++)
    if (g_array_index (trials, ClothTrial, i).motion == motion)
      return g_array_index (trials, ClothTrial, i).log_bayes_factor;
  g_assert_not_reached ();
}

/* Wind across a flat sheet pushes every piece alike, and so does gravity that is tilted
 * across: hanging still they are the same. Turned by 90°, the wind passes along the sheet
 * and pushes nothing, while tilted gravity still pulls; without the wind only one of them
 * is left. */
static void
test_wind_or_tilt (void)
{
  /* ½ρ C s(w) w = g sin(2°) · areal density, s(w) = √(w² + 0.5²) */
  const gdouble pressure = 0.15 * 9.81 * sin (2. * G_PI / 180.);
  const gdouble k = pressure / (0.5 * 1.2 * 1.5), h = 0.5 * 0.5 * 0.5;
  const gdouble wind = sqrt (sqrt (h * h + k * k) - h);
  const ClothModelEffect members[] = {
    effect ("wind", 0., wind), effect ("gravity_tilt", 0., 2.)
  };
  How how = { 0 };
  g_autoptr (GArray) trials = try_members (members, 2, &how);

  g_assert_cmpfloat (find (trials, CLOTH_MOTION_TURN), >,
      4. * find (trials, CLOTH_MOTION_HANG));
  g_assert_cmpfloat (find (trials, CLOTH_MOTION_FAN_OFF), >,
      4. * find (trials, CLOTH_MOTION_HANG));
}

/* What acts by speed shows nothing where nothing moves; a square and a line that meet at
 * one speed part at others. */
static void
test_square_or_linear (void)
{
  /* ½ρ C v² = c v at 0.5 m/s */
  const ClothModelEffect members[] = {
    effect ("air_drag", 1.5, 0.), effect ("air_drag_linear", 0.45, 0.)
  };
  How how = { 0 };
  g_autoptr (GArray) trials = try_members (members, 2, &how);
  gdouble still = find (trials, CLOTH_MOTION_HANG);

  g_assert_cmpfloat (still, <, 1e-3 * find (trials, CLOTH_MOTION_SHAKE));
  g_assert_cmpfloat (find (trials, CLOTH_MOTION_EDGE), <,
      1e-3 * find (trials, CLOTH_MOTION_SHAKE));
  g_assert_cmpfloat (find (trials, CLOTH_MOTION_SHAKE), >,
      find (trials, CLOTH_MOTION_SWAY));
  for (guint i = 0; i < trials->len; i++)
    g_assert_cmpint (g_array_index (trials, ClothTrial, i).motion, !=,
        CLOTH_MOTION_FAN_ON);
}

/* Cloth heavier by a share and gravity larger by it load the threads alike; but only the
 * heavier one resists when it is moved. */
static void
test_mass_or_gravity (void)
{
  const ClothModelEffect members[] = {
    effect ("areal_mass", log (1.2), 0.), effect ("gravity_scale", 1.2, 0.)
  };
  How how = { 0 };
  g_autoptr (GArray) trials = try_members (members, 2, &how);

  g_assert_cmpfloat (find (trials, CLOTH_MOTION_SHAKE), >,
      3. * find (trials, CLOTH_MOTION_HANG));
}

/* The same force by two names: no capture tells them apart. */
static void
test_gauge (void)
{
  const ClothModelEffect members[] = {
    effect ("damping_mass", 2., 0.), effect ("air_drag_linear", 2. * 0.15, 0.)
  };
  How how = { 0 };
  g_autoptr (GArray) trials = try_members (members, 2, &how);

  g_assert_cmpuint (trials->len, >, 5);
  for (guint i = 0; i < trials->len; i++)
    g_assert_cmpfloat (g_array_index (trials, ClothTrial, i).log_bayes_factor,
        <, 0.05);
  g_assert_null (cloth_experiment_choose (trials));
}

/* The nearest two of a group count. */
static void
test_nearest_pair (void)
{
  const ClothModelEffect members[] = {
    effect ("damping_mass", 2., 0.), effect ("gravity_tilt", 0., 4.),
    effect ("air_drag_linear", 2. * 0.15, 0.)
  };
  How how = { 0 };
  g_autoptr (GArray) two = try_members (members, 2, &how);
  g_autoptr (GArray) three = try_members (members, 3, &how);

  g_assert_nonnull (cloth_experiment_choose (two));
  g_assert_null (cloth_experiment_choose (three));
}

/* Gravity that is turned by 1° pulls all across with g sin 1°, against the observer's
 * 1600 1/s²; bending, the clamps and gravity's own pull back to the vertical take some of
 * that displacement, features that are cut off some more. Evidence is half of its square
 * over the variance: if everything is off by three times the variance of the noise on top
 * of it, a quarter is left. */
static void
test_units (void)
{
  const ClothModelEffect members[] = {
    effect ("gravity_tilt", 0., 1.), effect ("gravity_tilt", 0., 0.)
  };
  How sharp = { 0 }, blunt = {.discrepancy_variance = 3. };
  g_autoptr (GArray) a = try_members (members, 2, &sharp);
  g_autoptr (GArray) b = try_members (members, 2, &blunt);
  const gdouble off = 9.81 * sin (G_PI / 180.) / 1600. / sheet.noise_m;
  const gdouble most = 0.5 * 81. * 101. * off * off / OVERDISPERSION;

  g_assert_cmpfloat (find (a, CLOTH_MOTION_HANG), <, most);
  g_assert_cmpfloat (find (a, CLOTH_MOTION_HANG), >, 0.5 * most);
  g_assert_cmpfloat_with_epsilon (find (a, CLOTH_MOTION_HANG), 4. * find (b,
          CLOTH_MOTION_HANG), 1e-9 * find (a, CLOTH_MOTION_HANG));
}

/* What a free number can do as well tells nothing; what it can't is left. */
static void
test_free_number (void)
{
  const ClothModelEffect damped[] = {
    effect ("damping_mass", 0.5, 0.), effect ("damping_mass", 0., 0.)
  };
  const ClothModelEffect tilted[] = {
    effect ("gravity_tilt", 0., 1.), effect ("gravity_tilt", 0., 0.)
  };
  How frozen = { 0 }, open = {.free = TRUE };
  g_autoptr (GArray) a = try_members (damped, 2, &frozen);
  g_autoptr (GArray) b = try_members (damped, 2, &open);
  g_autoptr (GArray) c = try_members (tilted, 2, &frozen);
  g_autoptr (GArray) d = try_members (tilted, 2, &open);
  gdouble before = find (a, CLOTH_MOTION_SHAKE);
  gdouble after = find (b, CLOTH_MOTION_SHAKE);

  /* of the square e²b² along a direction of a prior of the precision p, e²b²/(1 + b²/op)
   * is left when o is the overdispersion, so less than e²op; the evidence is 1/2o of it,
   * and a little more as damping does not act quite in proportion */
  g_assert_cmpfloat (before, >, 10. * after);
  g_assert_cmpfloat (after, <=, 1.05 * 0.5 * FREE_PRECISION * 0.5 * 0.5);
  g_assert_cmpfloat (find (d, CLOTH_MOTION_HANG), >, 0.5 * find (c,
          CLOTH_MOTION_HANG));
}

/* The same numbers from one thread and from two. */
static void
test_threads (void)
{
  const ClothModelEffect members[] = {
    effect ("air_drag", 1.5, 0.), effect ("air_drag_linear", 0.45, 0.)
  };
  How one = {.threads = 1,.free = TRUE }, two = {.threads = 2,.free = TRUE };
  g_autoptr (GArray) a = try_members (members, 2, &one);
  g_autoptr (GArray) b = try_members (members, 2, &two);

  g_assert_cmpuint (a->len, ==, b->len);
  for (guint i = 0; i < a->len; i++)
    g_assert_true (g_array_index (a, ClothTrial, i).log_bayes_factor ==
        g_array_index (b, ClothTrial, i).log_bayes_factor);
}

/* With one effect, or none, there is nothing to part and nothing is simulated. */
static void
test_too_few (void)
{
  const ClothModelEffect member = effect ("air_drag", 1.5, 0.);
  How how = { 0 };

  for (guint n = 0; n < 2; n++) {
    g_autoptr (GArray) trials = try_members (&member, n, &how);

    g_assert_cmpuint (trials->len, ==, 0);
    g_assert_null (cloth_experiment_choose (trials));
    g_assert_cmpuint (how.simulations, ==, 0);
  }
}

/* A capture in which an effect's simulation bursts is never proposed. */
static void
test_divergent (void)
{
  const ClothModelEffect members[] = {
    effect ("gravity_tilt", 0., 4.), effect ("gravity_scale", 1e9, 0.)
  };
  How how = { 0 };
  g_autoptr (GArray) trials = try_members (members, 2, &how);

  g_assert_cmpuint (trials->len, >, 0);
  for (guint i = 0; i < trials->len; i++)
    g_assert_true (isnan (g_array_index (trials, ClothTrial,
                i).log_bayes_factor));
  g_assert_null (cloth_experiment_choose (trials));
}

/* Whatever is held will do, but something must be. */
static void
test_held (void)
{
  const ClothModelEffect members[] = {
    effect ("gravity_tilt", 0., 4.), effect ("gravity_scale", 1.2, 0.)
  };
  g_autoptr (ClothRecording) recording = cloth_recording_new (take, NULL);
  GArray *held = recording->scene->held;
  How how = { 0 };

  /* the second corner was let go before the take began */
  g_array_index (held, ClothHeld, 1).until_s = -1.;
  {
    g_autoptr (ClothStage) stage = cloth_stage_new (recording);
    g_autoptr (GArray) trials = try_on (recording, members, 2, &how, NULL);

    g_assert_cmpuint (stage->held->len, ==, 1);
    g_assert_false (cloth_stage_allows (stage, CLOTH_MOTION_DROP));
    g_assert_false (cloth_stage_allows (stage, CLOTH_MOTION_EDGE));
    g_assert_nonnull (cloth_experiment_choose (trials));
  }
  g_array_index (held, ClothHeld, 0).until_s = -1.;
  {
    g_autoptr (ClothStage) stage = cloth_stage_new (recording);
    g_autoptr (GArray) trials = NULL;

    how.simulations = 0;
    trials = try_on (recording, members, 2, &how, NULL);
    for (guint m = 0; m < CLOTH_N_MOTIONS; m++)
      g_assert_false (cloth_stage_allows (stage, m));
    g_assert_cmpuint (trials->len, ==, 0);
    g_assert_cmpuint (how.simulations, ==, 0);
  }
}

static gboolean
stop (gpointer data, gdouble share)
{
  return FALSE;
}

static void
test_cancelled (void)
{
  const ClothModelEffect members[] = {
    effect ("gravity_tilt", 0., 4.), effect ("gravity_scale", 1.2, 0.)
  };
  g_autoptr (ClothRecording) recording = cloth_recording_new (take, NULL);
  g_autoptr (GError) error = NULL;
  How how = {.progress = stop };

  g_assert_null (try_on (recording, members, 2, &how, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED);
}

/* Scenes as they are described: rigid turns, lengths of the flat cloth, clamps that hold
 * vertices where they are. */
static void
test_scenes (void)
{
  g_autoptr (ClothRecording) recording = cloth_recording_new (take, NULL);
  g_autoptr (ClothStage) stage = cloth_stage_new (recording);

  for (guint m = 0; m < CLOTH_N_MOTIONS; m++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothScene) scene = cloth_stage_make_scene (stage, m, 50., 2.,
        NULL);
    g_autofree gchar *text = cloth_stage_describe (stage, m);

    g_assert_true (cloth_stage_allows (stage, m));
    g_assert_true (cloth_scene_check (scene, &error));
    g_assert_no_error (error);
    g_assert_cmpuint (scene->n_frames, ==, 101);
    g_assert_true (g_utf8_validate (text, -1, NULL));
    g_assert_nonnull (strstr (text, "2 s"));
    for (guint i = 0; i < 2; i++) {
      guint v = g_array_index (scene->held, ClothHeld, i).vertex;

      for (guint k = 0; k < 3; k++)
        g_assert_cmpfloat_with_epsilon (scene->clamps[3 * i + k],
            scene->positions[3 * v + k], 2e-3);
    }
  }
  {
    g_autoptr (ClothScene) scene = cloth_stage_make_scene (stage,
        CLOTH_MOTION_TURN, 50., 2., NULL);

    /* both clamps were at y = 0, 0.14 m apart along x */
    for (guint i = 0; i < 2; i++) {
      g_assert_cmpfloat_with_epsilon (scene->clamps[3 * i], 0.08, 1e-6);
      g_assert_cmpfloat_with_epsilon (fabs (scene->clamps[3 * i + 1]), 0.07,
          1e-6);
      g_assert_cmpfloat_with_epsilon (scene->clamps[3 * i + 2], 0., 1e-6);
    }
  }
  {
    g_autoptr (ClothScene) scene = cloth_stage_make_scene (stage,
        CLOTH_MOTION_EDGE, 50., 2., NULL);

    g_assert_cmpuint (g_array_index (scene->held, ClothHeld, 0).vertex, ==, 8);
    g_assert_cmpuint (g_array_index (scene->held, ClothHeld, 1).vertex, ==, 80);
    /* neighbours in the upper edge are as far apart as on the flat cloth */
    for (guint row = 0; row < 8; row++) {
      gdouble square = 0.;

      for (guint k = 0; k < 3; k++)
        square += pow (scene->positions[3 * (9 * row + 8) + k] -
            scene->positions[3 * (9 * row + 17) + k], 2.);
      g_assert_cmpfloat_with_epsilon (sqrt (square), 0.02, 0.0025);
    }
  }
}

/* A fine grid made coarse: the corners stay where they are and held, what lies between
 * lies between; a coarse one is left alone. */
static void
test_thin (void)
{
  const TestGapSheet fine = { 33, 20, 7, 0.16, 0.095, 50., 3e-4 };
  g_autoptr (ClothModel) model = model_new ();
  g_autoptr (ClothTake) big = test_gap_record (&fine, model, hold_at, parent,
      "fine", 2);
  g_autoptr (ClothRecording) from = cloth_recording_new (big, NULL);
  g_autoptr (ClothRecording) small = cloth_recording_new (take, NULL);
  g_autoptr (ClothRecording) to = cloth_recording_resample (from, 17);
  const guint corners[][2] = { {0, 0}, {32, 16}, {19 * 33, 16 * 17},
  {20 * 33 - 1, 17 * 17 - 1}
  };

  g_assert_null (cloth_recording_resample (small, 17));
  g_assert_cmpuint (to->n, ==, 17 * 17);
  g_assert_cmpuint (to->scene->held->len, ==, 2);
  g_assert_cmpuint (g_array_index (to->scene->held, ClothHeld, 1).vertex, ==,
      16);
  g_assert_cmpfloat_with_epsilon (to->sigma * to->sigma / to->n,
      from->sigma * from->sigma / from->n, 1e-15);
  for (guint i = 0; i < 4; i++)
    for (guint k = 0; k < 3; k++)
      g_assert_cmpfloat_with_epsilon (to->y[3 * (6 * to->n + corners[i][1]) +
              k], from->y[3 * (6 * from->n + corners[i][0]) + k], 1e-9);
  /* every other column of the first row */
  for (guint k = 0; k < 3; k++)
    g_assert_cmpfloat_with_epsilon (to->y[3 * 5 + k], from->y[3 * 10 + k],
        1e-9);
}

int
main (int argc, char **argv)
{
  g_autoptr (ClothModel) model = model_new ();
  int status;

  g_test_init (&argc, &argv, NULL);
  parent = g_dir_make_tmp ("cloth-experiment-XXXXXX", NULL);
  take = test_gap_record (&sheet, model, hold_at, parent, "plain", 1);
  g_test_add_func ("/gap/experiment/wind-or-tilt", test_wind_or_tilt);
  g_test_add_func ("/gap/experiment/square-or-linear", test_square_or_linear);
  g_test_add_func ("/gap/experiment/mass-or-gravity", test_mass_or_gravity);
  g_test_add_func ("/gap/experiment/gauge", test_gauge);
  g_test_add_func ("/gap/experiment/nearest-pair", test_nearest_pair);
  g_test_add_func ("/gap/experiment/units", test_units);
  g_test_add_func ("/gap/experiment/free-number", test_free_number);
  g_test_add_func ("/gap/experiment/threads", test_threads);
  g_test_add_func ("/gap/experiment/too-few", test_too_few);
  g_test_add_func ("/gap/experiment/divergent", test_divergent);
  g_test_add_func ("/gap/experiment/held", test_held);
  g_test_add_func ("/gap/experiment/cancelled", test_cancelled);
  g_test_add_func ("/gap/experiment/scenes", test_scenes);
  g_test_add_func ("/gap/experiment/thin", test_thin);
  status = g_test_run ();
  cloth_take_free (take);
  test_gap_remove (parent);
  g_free (parent);
  return status;
}
