/* Blind diagnoses of a small cloth: what is recorded comes from the mass–spring model
 * with an effect that the diagnosing model, a membrane, lacks; the baseline from the same
 * without.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/gap/diagnose.h"
#include "gst/gap/report/report.h"
#include "gst/effect/effect.h"
#include "tests/common/gaprecord.h"

static const TestGapSheet sheet = { 9, 9, 75, 0.16, 0.16, 50., 3e-4 };

/* Time step, s, that the sheet's simulation is stable with, but not if it is stiffer by the
 * step of a derivative. */
#define SHORT_STEP 1e-3

static gchar *parent;

/* The corners come closer; how far along they are is returned. */
static gdouble
close_at (guint held, gdouble t, gfloat p[3])
{
  gdouble ramp = MIN (1., t / 0.3), close = 0.03 * ramp * ramp *
      (3. - 2. * ramp);

  p[0] = (gfloat) (held ? 0.16 - close : close);
  return ramp;
}

/* Two corners that close and sway. */
static void
sway_at (guint held, gdouble t, gfloat p[3])
{
  gdouble ramp = close_at (held, t, p);

  p[1] = (gfloat) (0.05 * ramp * sin (8. * t));
  p[2] = 0.f;
}

/* The other motion is slower and across. */
static void
other_at (guint held, gdouble t, gfloat p[3])
{
  gdouble ramp = close_at (held, t, p);

  p[1] = (gfloat) (0.03 * ramp * sin (5. * t + held));
  p[2] = (gfloat) (0.02 * ramp * sin (6. * t));
}

static ClothModel *
model_new (ClothForceModel force_model)
{
  ClothModel *model = cloth_model_new ();

  model->force_model = force_model;
  model->areal_density = 0.15;
  model->stretch_warp = model->stretch_weft = 40.;
  model->shear = 12.;
  model->bending_warp = model->bending_weft = 3e-5;
  model->damping_mass = 0.3;
  model->damping_stiffness = 5e-4;
  test_gap_free_parameters (model);
  return model;
}

/* Records a take of the mass–spring cloth with an effect. */
static ClothTake *
record (const gchar * name, const gchar * effect, const gdouble * values,
    gboolean other, guint64 seed)
{
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MASS_SPRING);

  if (effect)
    cloth_model_set_effect (model, cloth_effect_find (effect), values);
  return test_gap_record (&sheet, model, other ? other_at : sway_at, parent,
      name, seed);
}

static ClothGapResult *
diagnose (ClothTake * take, ClothTake * baseline, guint threads)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  const ClothGapOptions options = {
    .baselines = &baseline,.n_baselines = baseline ? 1 : 0,.seed = 1,.threads =
        threads
  };
  ClothGapResult *result = cloth_gap_diagnose (&take, 1, model, &options,
      &error);
  g_autofree gchar *summary = NULL;

  g_assert_no_error (error);
  summary = cloth_gap_result_summary (result);
  g_test_message ("%s %s (%.1f s, %" G_GUINT64_FORMAT " simulations)",
      cloth_take_get_info (take)->name, summary, result->seconds,
      result->simulations);
  for (guint i = 0; i < MIN (3, result->effects->len); i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);

    g_test_message ("  %s %.3f: %g ± %g", e->effect->id, e->probability,
        e->values[0], e->sigmas[0]);
  }
  return result;
}

typedef struct
{
  const gchar *effect;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
} Case;

static const Case cases[] = {
  {"air_drag", {2.}},
  {"gravity_tilt", {4., 0.}},
  {"mass_distribution", {3., 0.03}},
  {"clamp_slip", {-0.015, 0., -0.015, 0.7, 1.}},
  /* far from where its derivative at the null holds */
  {"clamp_delay", {0.2}},
  {"clamp_slip", {0.04, 0., 0.03, 0.8, 1.}},
};

static const Case pairs[][2] = {
  {{"clamp_slip", {-0.015, 0., -0.015, 0.7, 1.}}, {"shear", {0.9}}},
  {{"shrinkage", {0.02, 0.02}}, {"air_drag", {2.}}},
  /* either alone is less likely than wind, which does both */
  {{"gravity_tilt", {2.2, 1.3}}, {"air_drag", {3.5}}},
};

/* Shares of a whole are a whole; what could not be measured has a reason. */
static void
check_where (const ClothGapResult * result)
{
  gdouble sums[3] = { 0. };

  g_assert_cmpuint (result->bands->len, >, 3);
  g_assert_cmpuint (result->waves->len, >, 3);
  for (guint i = 0; i < result->bands->len; i++)
    sums[0] += g_array_index (result->bands, ClothGapBand, i).share;
  for (guint i = 0; i < result->waves->len; i++)
    sums[1] += g_array_index (result->waves, ClothGapBand, i).share;
  for (guint i = 0; i < result->stages->len; i++) {
    const ClothGapStage *stage = &g_array_index (result->stages, ClothGapStage,
        i);

    g_assert_true (isnan (stage->share) == (stage->reason != NULL));
    sums[2] += isnan (stage->share) ? 0. : stage->share;
  }
  for (guint i = 0; i < 3; i++)
    g_assert_cmpfloat_with_epsilon (sums[i], 1., 1e-9);
  g_assert_cmpfloat (result->still, >, 0.);
  g_assert_cmpfloat (result->still, <, 1.);
  g_assert_cmpuint (result->spectrum.n_frequencies, >, 3);
  g_assert_nonnull (result->spectrum.null);
}

/* What a faultless simulation would have is known of all that is shown. */
static void
check_null (const ClothGapResult * result)
{
  g_assert_nonnull (result->region);
  for (gsize i = 0; i < (gsize) result->n_frames * result->n_vertices; i++)
    g_assert_true (isfinite (result->playback.sigma[i])
        && result->playback.sigma[i] > 0.f);
  for (guint w = 0; w < result->series.n; w++) {
    g_assert_cmpfloat (result->series.null_low[w], >, 0.);
    g_assert_cmpfloat (result->series.null_low[w], <,
        result->series.null_high[w]);
  }
}

/* The effect that acted comes first, the gap shrinks and its size is about right. */
static void
test_named (gconstpointer data)
{
  const Case *c = data;
  g_autoptr (ClothTake) baseline = record ("baseline", NULL, NULL, FALSE, 1);
  g_autoptr (ClothTake) take = record (c->effect, c->effect, c->values, FALSE,
      2);
  g_autoptr (ClothGapResult) result = diagnose (take, baseline, 0);
  const ClothGapEffect *first;

  g_assert_cmpuint (result->effects->len, >, 0);
  first = &g_array_index (result->effects, ClothGapEffect, 0);
  g_assert_cmpstr (first->effect->id, ==, c->effect);
  g_assert_true (first->accepted);
  /* so large a slip leaves the cloth where the baseline says little: what its law leaves may pass for
   * something unknown */
  g_assert_true (result->verdict == CLOTH_GAP_EXPLAINED
      || result->verdict == CLOTH_GAP_AMBIGUOUS
      || (result->verdict == CLOTH_GAP_UNEXPLAINED && c->values[0] > 0.03
          && strcmp (c->effect, "clamp_slip") == 0));
  g_assert_cmpfloat (result->gap_after.value, <, result->gap_before.value);
  check_where (result);
  check_null (result);
  if (strcmp (c->effect, "clamp_slip") == 0) {
    g_test_message ("it slips at %g s: from %g s on, at %u vertices",
        c->values[3], result->onset_s, result->region->len);
    g_assert_cmpfloat_with_epsilon (result->onset_s, c->values[3], 0.061);
    g_assert_cmpuint (result->region->len, >, 0);
  }
}

static void
record_pair (const Case * pair, ClothTake ** take, ClothTake ** baseline)
{
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MASS_SPRING);

  for (guint i = 0; i < 2; i++)
    cloth_model_set_effect (model, cloth_effect_find (pair[i].effect),
        pair[i].values);
  *take = test_gap_record (&sheet, model, sway_at, parent, "pair", 7);
  *baseline = record ("baseline", NULL, NULL, FALSE, 1);
}

static gboolean
is_accepted (const ClothGapResult * result, const gchar * effect)
{
  for (guint i = 0; i < result->effects->len; i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);

    if (strcmp (e->effect->id, effect) == 0)
      return e->accepted;
  }
  return FALSE;
}

/* The second one is not made up for by numbers that the baseline has fixed, nor lost as
 * neither alone makes the gap much smaller. */
static void
test_pair (gconstpointer data)
{
  const Case *pair = data;
  g_autoptr (ClothTake) take = NULL, baseline = NULL;
  g_autoptr (ClothGapResult) result = NULL;

  record_pair (pair, &take, &baseline);
  result = diagnose (take, baseline, 0);
  g_assert_true (is_accepted (result, pair[0].effect));
  g_assert_true (is_accepted (result, pair[1].effect));
  /* likely once the first one is known, whatever it was before */
  for (guint i = 0; i < 2; i++)
    g_assert_cmpfloat (g_array_index (result->effects, ClothGapEffect,
            i).probability, >, 0.2);
}

/* A wind that changes is told from one that does not, and never taken in. */
static void
test_gust (void)
{
  const gdouble gust[] = { 0.5, 0.5, 70., 1.5, 0.5 };
  const gdouble storm[] = { 1., 0.3, 70., 1.5, 0.5 };
  const gdouble wind[] = { 0.3, 0.8, 0., 1.5, 0.5 };
  g_autoptr (ClothTake) baseline = record ("baseline", NULL, NULL, FALSE, 1);
  g_autoptr (ClothTake) gusty = record ("gust", "gust", gust, FALSE, 8);
  g_autoptr (ClothTake) stormy = record ("storm", "gust", storm, FALSE, 8);
  g_autoptr (ClothTake) steady = record ("wind", "wind", wind, FALSE, 9);
  g_autoptr (ClothGapResult) one = diagnose (gusty, baseline, 0);
  g_autoptr (ClothGapResult) two = diagnose (steady, baseline, 0);
  g_autoptr (ClothGapResult) three = diagnose (stormy, baseline, 0);
  const ClothGapEffect *first =
      &g_array_index (one->effects, ClothGapEffect, 0);

  g_assert_cmpstr (first->effect->id, ==, "gust");
  g_assert_false (first->accepted);
  g_assert_cmpint (one->verdict, ==, CLOTH_GAP_UNEXPLAINED);
  /* what is far from linear is at least not explained */
  g_assert_cmpint (three->verdict, ==, CLOTH_GAP_UNEXPLAINED);
  g_assert_false (is_accepted (three, "gust"));
  g_assert_cmpfloat (three->rest_p_value, <, 0.05);
  /* the root of the mean square of what blew in these 1.5 s, and the axis it blew along */
  g_test_message ("gusts of %g m/s along %g°", first->values[0],
      first->values[2]);
  g_assert_cmpstr (g_array_index (two->effects, ClothGapEffect, 0).effect->id,
      ==, "wind");
  g_assert_true (is_accepted (two, "wind"));
}

static void
test_no_gap (void)
{
  g_autoptr (ClothTake) baseline = record ("baseline", NULL, NULL, FALSE, 1);
  g_autoptr (ClothTake) again = record ("again", NULL, NULL, FALSE, 3);
  g_autoptr (ClothTake) other = record ("other", NULL, NULL, TRUE, 4);
  g_autoptr (ClothGapResult) one = diagnose (again, baseline, 0);
  g_autoptr (ClothGapResult) two = diagnose (other, baseline, 0);
  guint outside = 0;

  g_assert_cmpint (one->verdict, ==, CLOTH_GAP_NO_GAP);
  g_assert_cmpint (two->verdict, ==, CLOTH_GAP_NO_GAP);
  g_assert_cmpfloat (one->rest_p_value, >, 0.05);
  g_assert_cmpfloat (two->rest_p_value, >, 0.05);
  g_assert_null (one->reason);
  g_assert_null (two->reason);
  check_null (one);
  check_null (two);
  g_assert_cmpuint (one->region->len, ==, 0);
  g_assert_cmpuint (two->region->len, ==, 0);
  g_assert_true (isnan (one->onset_s) && isnan (two->onset_s));
  /* a faultless simulation is in its band most of the time */
  for (guint w = 0; w < one->series.n; w++)
    outside += one->series.before[w] < one->series.null_low[w]
        || one->series.before[w] > one->series.null_high[w];
  g_test_message ("%u of %u windows outside their band", outside,
      one->series.n);
  g_assert_cmpuint (4 * outside, <=, one->series.n);
}

/* The right corner trembles, by less than the floor. */
static void
tremble_at (guint held, gdouble t, gfloat p[3])
{
  sway_at (held, t, p);
  p[2] += (gfloat) (held * 1.5e-3 * sin (25. * t));
}

/* Below the clamps places are told further and further off, by 4.5 mm in the end. */
static void
film_drifting (gdouble t, gfloat p[3])
{
  p[1] += (gfloat) (3e-3 * t * p[2] / sheet.height_m);
}

/* What no effect of the library does is told though it moves the cloth by less than what
 * the simulator is off by anyway. */
static void
test_hidden (void)
{
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MASS_SPRING);
  g_autoptr (ClothTake) baseline = record ("baseline", NULL, NULL, FALSE, 1);
  g_autoptr (ClothTake) other = record ("other", NULL, NULL, TRUE, 4);
  TestGapSheet logged = sheet, filmed = sheet;
  g_autoptr (ClothTake) trembles = NULL;
  g_autoptr (ClothTake) drifts = NULL;
  g_autoptr (ClothGapResult) one = NULL;
  g_autoptr (ClothGapResult) two = NULL;
  g_autoptr (ClothGapResult) three = NULL;
  g_autofree gchar *summary = NULL;

  logged.logged = sway_at;
  filmed.film = film_drifting;
  trembles = test_gap_record (&logged, model, tremble_at, parent, "trembles",
      11);
  drifts = test_gap_record (&filmed, model, sway_at, parent, "drifts", 12);
  one = diagnose (trembles, baseline, 0);
  two = diagnose (drifts, baseline, 0);
  three = diagnose (trembles, other, 0);
  g_test_message ("unknown: %g, %g", two->rivals.force_field,
      two->rivals.displacement_field);
  g_assert_cmpint (one->verdict, ==, CLOTH_GAP_UNEXPLAINED);
  g_assert_cmpint (two->verdict, ==, CLOTH_GAP_UNEXPLAINED);
  g_assert_cmpint (three->verdict, ==, CLOTH_GAP_UNEXPLAINED);
  /* the trembling and the noise: √(1.5² ÷ 4 + 3 · 0.3²) mm and √(3 · 0.3²) mm */
  g_assert_nonnull (strstr (one->reason, "0.9 mm off"));
  g_assert_nonnull (strstr (one->reason, "baseline 0.5 mm"));
  g_assert_nonnull (strstr (two->reason,
          "no effect of the library is like it"));
  g_assert_nonnull (strstr (three->reason, "0.9 mm off"));
  summary = cloth_gap_result_summary (one);
  g_assert_nonnull (strstr (summary, one->reason));
}

/* Without a baseline no effect is made responsible for what two simulators differ by; a
 * strong one is named all the same. */
static void
test_no_baseline (void)
{
  g_autoptr (ClothTake) plain = record ("plain", NULL, NULL, FALSE, 5);
  g_autoptr (ClothTake) drag = record ("heavy", cases[2].effect,
      cases[2].values, FALSE, 6);
  g_autoptr (ClothGapResult) one = diagnose (plain, NULL, 0);
  g_autoptr (ClothGapResult) two = diagnose (drag, NULL, 0);

  for (guint i = 0; i < one->effects->len; i++)
    g_assert_false (g_array_index (one->effects, ClothGapEffect, i).accepted);
  g_assert_cmpuint (two->effects->len, >, 0);
  g_assert_cmpstr (g_array_index (two->effects, ClothGapEffect, 0).effect->id,
      ==, cases[2].effect);
}

/* The same bytes from one thread and from two. */
static void
test_threads (void)
{
  g_autoptr (ClothTake) baseline = record ("baseline", NULL, NULL, FALSE, 1);
  g_autoptr (ClothTake) take = record ("air_drag", "air_drag",
      cases[0].values, FALSE, 2);
  g_autoptr (ClothGapResult) one = diagnose (take, baseline, 1);
  g_autoptr (ClothGapResult) two = diagnose (take, baseline, 2);
  g_autofree gchar *a = NULL, *b = NULL;

  one->seconds = two->seconds = 0.;
  a = cloth_gap_result_to_json (one);
  b = cloth_gap_result_to_json (two);
  g_assert_cmpstr (a, ==, b);
}

static void
test_unknown_effect (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothTake) take = record ("plain", NULL, NULL, FALSE, 1);
  const gchar *const effects[] = { "air_drag", "magic", NULL };
  const ClothGapOptions options = {.effects = effects };
  ClothTake *takes[1] = { take };

  g_assert_null (cloth_gap_diagnose (takes, 1, model, &options, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_EFFECT);
  g_assert_nonnull (strstr (error->message, "magic"));
}

/* Shear may not be fitted to what the cloth has, and the diagnosis says so. As it is fitted
 * on the take itself, the effect that changes it can't be told from it. */
static void
test_narrow (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothTake) take = record ("plain", NULL, NULL, FALSE, 1);
  const gchar *const effects[] = { "air_drag", "shear", NULL };
  const ClothGapOptions options = {.effects = effects };
  ClothModelFree *shear = &g_array_index (model->free, ClothModelFree, 2);
  ClothTake *takes[1] = { take };
  g_autoptr (ClothGapResult) wide = NULL;
  g_autoptr (ClothGapResult) narrow = NULL;

  wide = cloth_gap_diagnose (takes, 1, model, &options, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (wide->notes->len, ==, 0);
  g_assert_cmpuint (wide->untested->len, ==, 1);
  g_assert_cmpstr (g_array_index (wide->untested, ClothGapUntested,
          0).effect->id, ==, "shear");
  g_assert_cmpuint (wide->effects->len, ==, 1);
  g_assert_cmpstr (g_array_index (wide->effects, ClothGapEffect,
          0).effect->id, ==, "air_drag");
  g_assert_cmpstr (shear->name, ==, "shear");
  shear->range[0] = 3. * model->shear;
  model->shear = 4. * model->shear;
  narrow = cloth_gap_diagnose (takes, 1, model, &options, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (narrow->notes->len, ==, 1);
  g_test_message ("%s", (const gchar *) narrow->notes->pdata[0]);
  g_assert_nonnull (strstr (narrow->notes->pdata[0], "shear (36)"));
  g_assert_nonnull (narrow->model);
  g_assert_cmpfloat_with_epsilon (narrow->model->shear, 36., 0.1);
}

/* A step that is just short enough for the model is too long for stiffer cloth: what diverged
 * is listed, and what could not be tested for it has a reason. */
static void
test_diverging (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothTake) take = record ("plain", NULL, NULL, FALSE, 1);
  const gchar *const effects[] = { "stretch", "air_drag", NULL };
  const ClothGapOptions options = {.effects = effects };
  ClothTake *takes[1] = { take };
  g_autoptr (ClothGapResult) result = NULL;
  const ClothGapUntested *untested;
  guint stiff = 0;

  g_array_set_size (model->free, 0);
  /* steps are whole fractions of a frame: the weight decides which are stable */
  model->time_step = SHORT_STEP;
  model->areal_density *= 1.05;
  result = cloth_gap_diagnose (takes, 1, model, &options, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < result->failures->len; i++) {
    const ClothGapNote *failure = &g_array_index (result->failures,
        ClothGapNote, i);

    g_test_message ("%s: %s", failure->name, failure->text);
    g_assert_true (g_str_has_prefix (failure->text, "It diverged at "));
    stiff += strstr (failure->name, "effects on plain, with "
        "effects.stretch.log_ratio 0.36") != NULL;
  }
  g_assert_cmpuint (stiff, ==, 1);
  g_assert_cmpuint (result->untested->len, ==, 1);
  untested = &g_array_index (result->untested, ClothGapUntested, 0);
  g_assert_cmpstr (untested->effect->id, ==, "stretch");
  g_assert_nonnull (strstr (untested->reason, "diverges"));
  g_assert_cmpuint (result->effects->len, ==, 1);
  g_assert_cmpstr (g_array_index (result->effects, ClothGapEffect,
          0).effect->id, ==, "air_drag");
}

/* The second of three blocks, which judges, and what its windows show of the one before. */
static void
film_without_judge (gdouble t, gfloat p[3])
{
  if (t > 0.29 && t < 0.93)
    p[0] = p[1] = p[2] = NAN;
}

/* Where nothing was seen in what judges there is no gap of 0, but none that is known. */
static void
test_unseen_judge (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothModel) other = model_new (CLOTH_FORCE_MASS_SPRING);
  const gchar *const effects[] = { "air_drag", NULL };
  const ClothGapOptions options = {.effects = effects };
  g_autoptr (ClothGapResult) result = NULL;
  g_autoptr (ClothTake) take = NULL;
  TestGapSheet filmed = sheet;

  filmed.film = film_without_judge;
  take = test_gap_record (&filmed, other, sway_at, parent, "unseen", 1);
  result = cloth_gap_diagnose (&take, 1, model, &options, &error);
  g_assert_no_error (error);
  g_test_message ("%s", result->reason);
  g_assert_cmpint (result->verdict, ==, CLOTH_GAP_UNDECIDABLE);
  g_assert_nonnull (strstr (result->reason, "Nothing was seen in the parts "
          "that judge"));
  g_assert_true (isnan (result->gap_before.value));
  g_assert_true (isnan (result->noise_floor.value));
  g_assert_true (isnan (result->rest_p_value));
}

/* Where the other force model diverges nobody knows what the two differ by: the floor is not that of the noise,
 * which would make all that is more a gap. */
static void
test_no_floor (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MASS_SPRING);
  g_autoptr (ClothTake) take = record ("plain", NULL, NULL, FALSE, 1);
  const gchar *const effects[] = { "air_drag", NULL };
  const ClothGapOptions options = {.effects = effects };
  g_autoptr (ClothGapResult) result = NULL;
  g_autofree gchar *summary = NULL;
  gboolean other_diverged = FALSE;

  g_array_set_size (model->free, 0);
  /* short enough for the springs, too long for the membrane */
  model->time_step = 1.25e-3;
  result = cloth_gap_diagnose (&take, 1, model, &options, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < result->failures->len; i++)
    other_diverged |= strstr (g_array_index (result->failures, ClothGapNote,
            i).name,
        "measuring the gap on plain, with the other force") != NULL;
  g_assert_true (other_diverged);
  g_assert_true (isfinite (result->gap_before.value));
  g_assert_true (isnan (result->noise_floor.value));
  g_assert_true (isnan (result->shrink.value));
  g_assert_true (isnan (result->rest_p_value));
  g_assert_cmpint (result->verdict, ==, CLOTH_GAP_UNDECIDABLE);
  summary = cloth_gap_result_summary (result);
  g_assert_null (strstr (summary, "floor"));
}

static gboolean
stop (gpointer data, gdouble share, const gchar * what)
{
  return FALSE;
}

static void
test_cancelled (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothTake) take = record ("plain", NULL, NULL, FALSE, 1);
  const ClothGapOptions options = {.progress = stop };
  ClothTake *takes[1] = { take };

  g_assert_null (cloth_gap_diagnose (takes, 1, model, &options, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED);
}

int
main (int argc, char **argv)
{
  int status;

  g_test_init (&argc, &argv, NULL);
  parent = g_dir_make_tmp ("cloth-gap-XXXXXX", NULL);
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = g_strdup_printf ("/gap/named/%s/%u",
        cases[i].effect, i);

    g_test_add_data_func (path, &cases[i], test_named);
  }
  for (guint i = 0; i < G_N_ELEMENTS (pairs); i++) {
    g_autofree gchar *path =
        g_strdup_printf ("/gap/pair/%s/%u", pairs[i][1].effect, i);

    g_test_add_data_func (path, pairs[i], test_pair);
  }
  g_test_add_func ("/gap/gust", test_gust);
  g_test_add_func ("/gap/no-gap", test_no_gap);
  g_test_add_func ("/gap/hidden", test_hidden);
  g_test_add_func ("/gap/no-baseline", test_no_baseline);
  g_test_add_func ("/gap/threads", test_threads);
  g_test_add_func ("/gap/unknown-effect", test_unknown_effect);
  g_test_add_func ("/gap/narrow", test_narrow);
  g_test_add_func ("/gap/diverging", test_diverging);
  g_test_add_func ("/gap/unseen-judge", test_unseen_judge);
  g_test_add_func ("/gap/no-floor", test_no_floor);
  g_test_add_func ("/gap/cancelled", test_cancelled);
  status = g_test_run ();
  test_gap_remove (parent);
  g_free (parent);
  return status;
}
