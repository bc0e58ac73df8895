/* The diagnosis: a sheet of 33×35 vertices over 250 frames, swayed by two corners, made by
 * the mass–spring model with air drag and noise; diagnosed by the membrane model with all
 * effects, without and with a baseline; and the search for the capture that would part the
 * drag from two others. Wall time on all processors.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>

#include "gst/gap/diagnose.h"
#include "gst/gap/report/report.h"
#include "gst/gap/design/experiment.h"
#include "gst/effect/effect.h"
#include "tests/common/gaprecord.h"

static const TestGapSheet sheet = { 33, 35, 250, 0.63, 0.67, 50., 4e-4 };

static ClothModel *
model_new (ClothForceModel force_model)
{
  ClothModel *model = cloth_model_new ();

  model->force_model = force_model;
  model->damping_mass = 0.3;
  test_gap_free_parameters (model);
  return model;
}

static void
clamp_at (guint held, gdouble t, gfloat p[3])
{
  gdouble close = 0.065 * MIN (1., t / 0.6);

  p[0] = (gfloat) (held ? 0.63 - close : close);
  p[1] = (gfloat) (0.06 * sin (2. * G_PI * 0.6 * t));
  p[2] = 0.f;
}

static ClothTake *
record (const gchar * folder, const gchar * name, gdouble drag, guint64 seed)
{
  const gdouble values[CLOTH_EFFECT_MAX_PARAMETERS] = { drag };
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MASS_SPRING);

  cloth_model_set_effect (model, cloth_effect_find ("air_drag"), values);
  return test_gap_record (&sheet, model, clamp_at, folder, name, seed);
}

static void
measure (const gchar * what, ClothTake * take, ClothTake * baseline)
{
  const ClothGapOptions options = {
    .baselines = &baseline,.n_baselines = baseline ? 1 : 0
  };
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGapResult) result = cloth_gap_diagnose (&take, 1, model,
      &options, &error);
  g_autofree gchar *summary = NULL;

  if (!result) {
    printf ("%s: %s\n", what, error->message);
    return;
  }
  summary = cloth_gap_result_summary (result);
  printf ("%s, %u effects: %.1f s (asked: 60), %" G_GUINT64_FORMAT
      " simulations of 5 s, %.1f × real time in sum\n  %s\n", what,
      result->effects->len, result->seconds, result->simulations,
      result->simulations * (sheet.n_frames / sheet.fps) / result->seconds,
      summary);
  for (guint i = 0; i < MIN (3, result->effects->len); i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);

    printf ("  %s %.3f, p = %.1g: %.3g ± %.2g\n", e->effect->id,
        e->probability, e->p_value, e->values[0], e->sigmas[0]);
  }
}

static void
measure_experiment (ClothTake * take)
{
  static const gchar *const ids[] = { "air_drag", "air_drag_linear", "wind" };
  static const gchar *const none[] = { NULL };
  const gdouble precisions[] = { 1., 1., 1., 1., 1., 1., 1. };
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothRecording) recording = cloth_recording_new (take, NULL);
  g_autoptr (ClothCandidates) candidates = cloth_candidates_new (model,
      recording, none, TRUE, NULL, NULL, NULL);
  const ClothExperiment experiment = {
    recording, model, candidates, precisions, NULL
  };
  ClothModelEffect members[G_N_ELEMENTS (ids)];
  gdouble best = INFINITY;
  ClothEstimateOptions options;

  for (guint i = 0; i < G_N_ELEMENTS (ids); i++) {
    members[i] = (ClothModelEffect) {
    cloth_effect_find (ids[i])};
    for (guint k = 0; k < members[i].effect->n_parameters; k++)
      members[i].values[k] = members[i].effect->parameters[k].null_value;
    members[i].values[0] = 0.5;
  }
  cloth_estimate_options_init (&options);
  for (guint i = 0; i < 3; i++) {
    gint64 start = g_get_monotonic_time ();
    g_autoptr (GArray) trials = cloth_experiment_try (&experiment, members,
        G_N_ELEMENTS (ids), &options, NULL);

    best = MIN (best, (g_get_monotonic_time () - start) * 1e-6);
    if (i)
      continue;
    for (guint k = 0; k < trials->len; k++)
      printf ("  motion %u at %g Hz: evidence %.3g\n", g_array_index (trials,
              ClothTrial, k).motion, g_array_index (trials, ClothTrial, k).fps,
          g_array_index (trials, ClothTrial, k).log_bayes_factor);
  }
  printf ("what to film next: %.1f s (asked: 5), %" G_GUINT64_FORMAT
      " simulations of %g s\n", best, options.simulations / 3,
      CLOTH_MOTION_SECONDS);
}

int
main (void)
{
  g_autofree gchar *folder = g_dir_make_tmp ("cloth-bench-XXXXXX", NULL);
  g_autoptr (ClothTake) plain = record (folder, "plain", 0., 1);
  g_autoptr (ClothTake) drag = record (folder, "drag", 2., 2);

  printf ("33×35 vertices, 250 frames, %u processors\n",
      g_get_num_processors ());
  measure_experiment (drag);
  measure ("without a baseline", drag, NULL);
  measure ("with a baseline of the same size", drag, plain);
  test_gap_remove (folder);
  return 0;
}
