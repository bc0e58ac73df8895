/* A diagnosis of a waving sheet, made up: what the report and gap.json are tested with.
 *
 * The "recording" is a running wave with noise; the "simulation" has too large a wave
 * that comes too early and grows from 0.8 s on, as without air drag; with the effect it
 * is nearly right.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/gapsheet.h"

#include <math.h>

#include "gst/math/random.h"

#define WIDTH 0.63
#define HEIGHT 0.67
#define FPS 50.0
#define NOISE 0.0004
#define ONSET 0.8

static const ClothEffect effects[] = {
  {.id = "air_drag",.side = CLOTH_EFFECT_PHYSICS,
        .blurb = "Air resists with the square of the speed.",.n_parameters = 1,
      .parameters = {{.name = "coefficient",.unit = "1",.one_sided = TRUE}}},
  {.id = "air_drag_linear",.side = CLOTH_EFFECT_PHYSICS,
        .blurb = "Air resists in proportion to the speed.",.n_parameters = 1,
      .parameters = {{.name = "rate",.unit = "1/s",.one_sided = TRUE}}},
  {.id = "wind",.side = CLOTH_EFFECT_PHYSICS,
        .blurb = "The air itself moves, always the same way.",.n_parameters =
        3,.parameters = {{.name = "x",.unit = "m/s"},
          {.name = "y",.unit = "m/s"}, {.name = "z",.unit = "m/s"}}},
  {.id = "damping_mass",.side = CLOTH_EFFECT_PHYSICS,
        .blurb = "Speed is lost at a steady rate.",.n_parameters = 1,
      .parameters = {{.name = "rate",.unit = "1/s",.one_sided = TRUE}}},
  {.id = "clamp_delay",.side = CLOTH_EFFECT_CLAMP,
      .blurb = "The clamps moved later than their log says.",.n_parameters =
        1,.parameters = {{.name = "delay",.unit = "s"}}},
  {.id = "bending",.side = CLOTH_EFFECT_PHYSICS,
        .blurb = "The cloth bends harder or softer than the model says.",
      .n_parameters = 1,.parameters = {{.name = "factor",.unit =
                    "1",.null_value = 1}}},
  {.id = "time_step",.side = CLOTH_EFFECT_NUMERICS,
        .blurb = "The simulator's step is too long.",.n_parameters = 1,
      .parameters = {{.name = "step",.unit = "s"}}},
  {.id = "grain_angle",.side = CLOTH_EFFECT_PHYSICS,
        .blurb = "The threads run askew.",.n_parameters = 1,
      .parameters = {{.name = "angle",.unit = "rad"}}},
  {.id = "rolling_shutter",.side = CLOTH_EFFECT_CAMERA,
        .blurb = "Rows of the picture are exposed one after another.",
      .n_parameters = 1,.parameters = {{.name = "time",.unit = "s"}}},
  {.id = "motion_blur",.side = CLOTH_EFFECT_IMAGE,
        .blurb = "Motion during the exposure moves what is found.",
      .n_parameters = 1,.parameters = {{.name = "exposure",.unit = "s"}}},
};

/* One row of the table of ranks. */
typedef struct
{
  guint effect;
  gdouble probability, p_value;
  gint group;
  gdouble values[3], sigmas[3];
} Row;

/* Posterior odds over prior odds of one in ten, logarithm. */
#define PRIOR 0.1

static const Row rows_of_table[] = {
  {0, 0.93, 3e-12, -1, {1.14}, {0.06}},
  {1, 0.05, 2e-7, 0, {0.83}, {0.07}},
  {3, 0.013, 4e-6, 0, {0.41}, {0.05}},
  {2, 0.004, 0.002, -1, {0.03, -0.21, 0.02}, {0.05, 0.08,
          0.05}},
  {4, 0.002, 0.03, -1, {0.0042}, {0.0021}},
  {5, 0.0008, 0.22, -1, {1.09}, {0.08}},
  {7, 0.0004, 0.35, -1, {0.012}, {0.014}},
  {6, 0.0002, 0.61, -1, {0.0011}, {0.0009}},
};

static const ClothGapBand bands[] = {
  {0, 0.5, 0.09, 0.03, 2.1}, {0.5, 2, 0.78, 0.05, 31}, {2, 8, 0.1, 0.03, 3.4},
  {8, 25, 0.03, 0.03, 1.1}
};

static const ClothGapBand waves[] = {
  {0, 0.4, 0.12, 0.02, 4.2}, {0.4, 1.1, 0.3, 0.03, 18}, {1.1, 2.3, 0.5, 0.05,
      24}, {2.3, INFINITY, 0.08, 0.04, 1.3}
};

typedef enum
{ RECORDED, BEFORE, AFTER } Sheet;

static void
place (Sheet sheet, gdouble u, gdouble v, gdouble t, gfloat * point)
{
  gdouble hang = pow (v / HEIGHT, 1.3);
  gdouble late = MAX (0, t - ONSET);
  gdouble extra = 1 - exp (-1.5 * late);
  gdouble size = 0.055, lead = 0;

  if (sheet == BEFORE) {
    size *= 1 + 0.13 * extra;
    lead = 0.14 * extra;
  } else if (sheet == AFTER) {
    size *= 1 + 0.03 * extra;
    lead = 0.035 * extra;
  }
  gdouble wave = sin (2 * G_PI * (1.1 * t - 1.3 * v) + 3.2 * u + lead);
  gdouble fold = 0.018 * cos (2 * G_PI * u / 0.21 + 0.6 * sin (2 * t)) *
      (0.25 + 0.75 * hang);
  point[0] = (gfloat) ((u - WIDTH / 2) * (1 - 0.05 * (1 - hang)));
  point[1] = (gfloat) (size * hang * wave + fold);
  point[2] = (gfloat) (1.6 - v * (1 - 0.04 * fabs (wave) * hang));
}

static gboolean
hidden (gdouble u, gdouble v, gdouble t)
{
  return t > 1.5 && t < 1.9 && hypot (u - 0.2, v - 0.35) < 0.07;
}

static void
fill_playback (ClothGapResult * result, guint columns, guint rows,
    guint n_frames)
{
  ClothGapPlayback *play = &result->playback;
  guint n = columns * rows;
  gsize total = (gsize) n_frames * n;
  ClothRandom random;

  cloth_random_init (&random, 1);
  play->take = g_strdup ("waving sheet");
  play->topology = cloth_topology_new_grid (columns, rows, (gfloat) WIDTH,
      (gfloat) HEIGHT);
  play->n_frames = n_frames;
  play->times = g_new (gdouble, n_frames);
  play->recorded = g_new (gfloat, 3 * total);
  play->before = g_new (gfloat, 3 * total);
  play->after = g_new (gfloat, 3 * total);
  play->sigma = g_new (gfloat, total);
  for (guint f = 0; f < n_frames; f++) {
    gdouble t = f / FPS;

    play->times[f] = t;
    for (guint i = 0; i < n; i++) {
      gsize at = (gsize) f * n + i;
      gdouble u = play->topology->uv[2 * i], v = play->topology->uv[2 * i + 1];

      place (RECORDED, u, v, t, play->recorded + 3 * at);
      place (BEFORE, u, v, t, play->before + 3 * at);
      place (AFTER, u, v, t, play->after + 3 * at);
      for (guint k = 0; k < 3; k++)
        play->recorded[3 * at + k] = hidden (u, v, t) ? NAN :
            play->recorded[3 * at + k] + (gfloat) (NOISE *
            cloth_random_gaussian (&random));
      play->sigma[at] = (gfloat) (NOISE * sqrt (3) + 0.002 * v / HEIGHT);
    }
  }
}

/* Squared distance of the two at one place, or NaN. */
static gdouble
squared (const ClothGapPlayback * play, const gfloat * simulated, gsize at)
{
  gdouble sum = 0;

  for (guint k = 0; k < 3; k++) {
    gdouble d = simulated[3 * at + k] - play->recorded[3 * at + k];

    sum += d * d;
  }
  return sum;
}

static gdouble
frame_rms (const ClothGapPlayback * play, const gfloat * simulated, guint frame)
{
  guint n = play->topology->n_vertices, seen = 0;
  gdouble sum = 0;

  for (guint i = 0; i < n; i++) {
    gdouble d = squared (play, simulated, (gsize) frame * n + i);

    if (isfinite (d)) {
      sum += d;
      seen++;
    }
  }
  return sqrt (sum / MAX (seen, 1));
}

static void
fill_shares (ClothGapResult * result)
{
  const ClothGapPlayback *play = &result->playback;
  guint n = play->topology->n_vertices;
  gdouble sum = 0;

  result->n_vertices = n;
  result->vertices = g_new0 (gdouble, n);
  result->gained = g_new0 (gdouble, n);
  result->n_frames = play->n_frames;
  result->frames = g_new0 (gdouble, play->n_frames);
  for (guint f = 0; f < play->n_frames; f++) {
    for (guint i = 0; i < n; i++) {
      gdouble d = squared (play, play->before, (gsize) f * n + i);

      if (!isfinite (d))
        continue;
      result->vertices[i] += d;
      result->gained[i] += d - squared (play, play->after, (gsize) f * n + i);
      result->frames[f] += d;
      sum += d;
    }
  }
  for (guint i = 0; i < n; i++) {
    result->vertices[i] /= sum;
    result->gained[i] /= sum;
  }
  for (guint f = 0; f < play->n_frames; f++)
    result->frames[f] /= sum;
}

static ClothGapEstimate
around (gdouble value)
{
  return (ClothGapEstimate) {
  value, 0.93 * value, 1.08 * value};
}

/* The figures agree with what is shown, but for the floor. */
static void
fill_gap (ClothGapResult * result)
{
  const ClothGapPlayback *play = &result->playback;
  gdouble before = 0, after = 0, floor_v = 0.0008 * 0.0008, shrink;

  for (guint f = 0; f < play->n_frames; f++) {
    before += pow (frame_rms (play, play->before, f), 2) / play->n_frames;
    after += pow (frame_rms (play, play->after, f), 2) / play->n_frames;
  }
  shrink = (before - after) / (before - floor_v);
  result->gap_before = around (sqrt (before));
  result->gap_after = around (sqrt (after));
  result->noise_floor = around (sqrt (floor_v));
  result->shrink = (ClothGapEstimate) {
  shrink, shrink - 0.07, shrink + 0.05};
  g_array_index (result->effects, ClothGapEffect, 0).shrink = result->shrink;
}

/* The free run is worse than windows, and worse after the effect than they say. */
static void
fill_takes (ClothGapResult * result)
{
  static const struct
  {
    ClothGapRole role;
    const gchar *name;
    gdouble size;
  } takes[] = {
    {CLOTH_GAP_TAKE, "waving sheet", 1}, {CLOTH_GAP_HOLD_OUT,
        "waving sheet, fast", 1.4}, {CLOTH_GAP_BASELINE, "hanging sheet", 0.3}
  };

  for (guint i = 0; i < G_N_ELEMENTS (takes); i++) {
    ClothGapMeasuredTake *take = cloth_gap_result_add_take (result,
        takes[i].role, takes[i].name);

    take->gap_before = around (takes[i].size * result->gap_before.value);
    take->gap_after = around (takes[i].size * result->gap_after.value);
    take->noise_floor = result->noise_floor;
    take->shrink = result->shrink;
    take->free_before = around (6 * take->gap_before.value);
    take->free_after = around (9 * take->gap_after.value);
    take->free_floor = around (2 * result->noise_floor.value);
  }
  result->takes_agree_p_value = 0.42;
  result->has_simulated = TRUE;
  result->predicted_shrink = (ClothGapShrink) {
    {
    0.91, 0.84, 0.96}
    , {
    0.78, 0.6, 0.88}
  };
  result->measured_shrink = (ClothGapShrink) {
    {
    0.88, 0.8, 0.93}
    , {
    0.71, 0.58, 0.81}
  };
}

static void
fill_series (ClothGapResult * result)
{
  const ClothGapPlayback *play = &result->playback;
  ClothGapSeries *series = &result->series;
  guint step = MAX (play->n_frames / 60, 1);

  series->n = (play->n_frames - 1) / step + 1;
  series->times = g_new (gdouble, series->n);
  series->before = g_new (gdouble, series->n);
  series->after = g_new (gdouble, series->n);
  series->null_low = g_new (gdouble, series->n);
  series->null_high = g_new (gdouble, series->n);
  for (guint i = 0; i < series->n; i++) {
    series->times[i] = play->times[i * step];
    series->before[i] = frame_rms (play, play->before, i * step);
    series->after[i] = frame_rms (play, play->after, i * step);
    series->null_low[i] = 0.0006 + 0.00005 * sin (0.7 * i);
    series->null_high[i] = 0.0011 + 0.0001 * sin (0.4 * i);
  }
}

static void
fill_spectrum (ClothGapResult * result)
{
  ClothGapSpectrum *spectrum = &result->spectrum;

  spectrum->n_frequencies = 24;
  spectrum->n_waves = 8;
  spectrum->frequencies = g_new (gdouble, 24);
  spectrum->waves = g_new (gdouble, 8);
  spectrum->before = g_new (gdouble, 24 * 8);
  spectrum->after = g_new (gdouble, 24 * 8);
  spectrum->null = g_new (gdouble, 24 * 8);
  for (guint f = 0; f < 24; f++)
    spectrum->frequencies[f] = f * 0.5;
  for (guint k = 0; k < 8; k++) {
    spectrum->waves[k] = k * 0.75;
    for (guint f = 0; f < 24; f++) {
      guint at = k * 24 + f;
      gdouble peak = exp (-pow ((f * 0.5 - 1.1) / 0.8, 2) -
          pow ((k * 0.75 - 1.4) / 1.1, 2));

      spectrum->null[at] = 2e-8 / (1 + 0.3 * f) / (1 + 0.2 * k);
      spectrum->before[at] = spectrum->null[at] * 0.6 + 1.6e-6 * peak;
      spectrum->after[at] = spectrum->null[at] * 0.62 + 3e-8 * peak;
    }
  }
}

/* Explanations whose sums are the probabilities of the table. */
static void
add_sets (ClothGapResult * result)
{
  g_ptr_array_add (cloth_gap_result_add_set (result, CLOTH_GAP_RIVAL_NONE,
          0.904)->effects, (gpointer) & effects[0]);
  g_ptr_array_add (cloth_gap_result_add_set (result, CLOTH_GAP_RIVAL_NONE,
          0.048)->effects, (gpointer) & effects[1]);
  result->rivals = (ClothGapRivals) {
  0.0001, 0.019, 0.002};
}

static void
add_patch (ClothGapResult * result)
{
  cloth_gap_result_add_patch (result, "effects.air_drag.coefficient",
      "air drag coefficient 1.14", NAN, 1.14, "1");
  cloth_gap_result_add_patch (result, "areal_density", "areal density × 0.61",
      0.2, 0.122, "kg/m²");
}

static void
add_free_number (ClothGapResult * result, const gchar * name,
    const gchar * unit, gdouble value, gdouble sigma, gdouble high)
{
  ClothGapFreeNumber *item = cloth_gap_result_add_free_number (result, name,
      unit);

  item->value = value;
  item->sigma = sigma;
  item->low = high / 10;
  item->high = high;
  item->at_end = value >= high;
}

static void
fill_free_numbers (ClothGapResult * result)
{
  static const gdouble correlation[] = {
    1, 0.31, -0.06, 0.31, 1, -0.94, -0.06, -0.94, 1
  };

  add_free_number (result, "areal_density", "kg/m²", 0.122, 0.004, 0.4);
  add_free_number (result, "bending.warp", "N·m", 2.1e-5, 3e-6, 1e-4);
  add_free_number (result, "damping.mass", "1/s", 0.8, 0.1, 0.8);
  result->free_correlation = g_memdup2 (correlation, sizeof correlation);
}

static void
fill_limits (ClothGapResult * result)
{
  cloth_gap_result_add_limit (result, &effects[0], 0, 0.09);
  cloth_gap_result_add_limit (result, &effects[2], 0, 0.14);
  cloth_gap_result_add_limit (result, &effects[2], 1, 0.16);
  cloth_gap_result_add_limit (result, &effects[2], 2, 0.35);
  cloth_gap_result_add_limit (result, &effects[4], 0, 0.0052);
  cloth_gap_result_add_limit (result, &effects[5], 0, 0.4);
  cloth_gap_result_add_limit (result, &effects[7], 0, NAN);
}

static void
fill_table (ClothGapResult * result)
{
  for (guint i = 0; i < G_N_ELEMENTS (rows_of_table); i++) {
    const Row *row = &rows_of_table[i];
    ClothGapEffect *item = cloth_gap_result_add_effect (result,
        &effects[row->effect]);

    item->probability = row->probability;
    item->log_bayes_factor = log (row->probability / (1 - row->probability) *
        (1 - PRIOR) / PRIOR);
    item->p_value = row->p_value;
    item->constancy_p_value = row->effect == 2 ? 0.012 : 0.5;
    item->group = row->group;
    item->accepted = i == 0;
    for (guint k = 0; k < effects[row->effect].n_parameters; k++) {
      item->values[k] = row->values[k];
      item->sigmas[k] = row->sigmas[k];
    }
  }
  add_sets (result);
  cloth_gap_result_add_group (result,
      "Shake the upper edge at 2 Hz for 3 s, then let the sheet hang still.",
      7.4);
  cloth_gap_result_add_untested (result, &effects[8],
      "The take has no rig.json and no observations of its cameras.");
  cloth_gap_result_add_untested (result, &effects[9], "The take has no films.");
}

static void
fill_provenance (ClothGapResult * result)
{
  cloth_gap_result_add_version (result, "gst-cloth", "0.1.0");
  cloth_gap_result_add_version (result, "effect library", "1");
  cloth_gap_result_add_version (result, "priors", "1");
  cloth_gap_result_add_input (result, CLOTH_GAP_TAKE, "waving sheet",
      "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08");
  cloth_gap_result_add_input (result, CLOTH_GAP_HOLD_OUT, "waving sheet, fast",
      "60303ae22b998861bce3b28f33eec1be758a213c86c93c076dbe9f558c11c752");
  cloth_gap_result_add_input (result, CLOTH_GAP_BASELINE, "hanging sheet",
      "fd61a03af4f77d870fc21e05e7e80678095c92d808cfb3b5c279ee04c74aca13");
  cloth_gap_result_add_input (result, CLOTH_GAP_MODEL, "model.json", NULL);
  cloth_gap_result_add_threshold (result, "evidence to accept", 3.4, "1",
      CLOTH_GAP_ORIGIN_SIMULATED,
      "19 of 20 simulations of this take that lack nothing stay below it.");
  cloth_gap_result_add_threshold (result, "least gap", 0.0011, "m",
      CLOTH_GAP_ORIGIN_SIMULATED,
      "19 of 20 simulations of this take that lack nothing stay below it.");
  cloth_gap_result_add_threshold (result, "window", 0.3, "s",
      CLOTH_GAP_ORIGIN_DEFINITION, "The gap is that over windows of 0.3 s.");
  cloth_gap_result_add_threshold (result, "posterior of the sets", 0.95, "1",
      CLOTH_GAP_ORIGIN_DEFINITION, "Sets are listed up to it.");
  cloth_gap_result_add_failure (result, "null 17, stretch × 1.31",
      "diverged at 1.34 s");
  result->seconds = 41.7;
  result->simulations = 352;
  result->seed = 1;
}

/* A grid of so many vertices and frames: air drag is missing. */
ClothGapResult *
gap_sheet_new (guint columns, guint rows, guint n_frames)
{
  ClothGapResult *result = cloth_gap_result_new ();

  result->verdict = CLOTH_GAP_EXPLAINED;
  result->rest_p_value = 0.31;
  result->held_out_takes = TRUE;
  result->onset_s = ONSET;
  result->region = g_array_new (FALSE, FALSE, sizeof (guint));
  for (guint v = columns * (rows - 1); v < columns * rows; v++)
    g_array_append_val (result->region, v);
  result->directions[0] = 0.06;
  result->directions[1] = 0.11;
  result->directions[2] = 0.83;
  result->still = 0.04;
  for (guint i = 0; i < G_N_ELEMENTS (bands); i++)
    g_array_append_val (result->bands, bands[i]);
  for (guint i = 0; i < G_N_ELEMENTS (waves); i++)
    g_array_append_val (result->waves, waves[i]);
  cloth_gap_result_add_stage (result, "camera", NAN,
      "The take has no rig.json.");
  cloth_gap_result_add_stage (result, "detection", 0.01, NULL);
  cloth_gap_result_add_stage (result, "labels", 0, NULL);
  cloth_gap_result_add_stage (result, "triangulation", 0.03, NULL);
  cloth_gap_result_add_stage (result, "physics", 0.96, NULL);
  fill_table (result);
  fill_provenance (result);
  fill_playback (result, columns, rows, n_frames);
  fill_shares (result);
  fill_gap (result);
  fill_takes (result);
  add_patch (result);
  fill_free_numbers (result);
  fill_limits (result);
  fill_series (result);
  fill_spectrum (result);
  return result;
}

/* As little as a result may have: one frame of triangles without uv, no band, no floor,
 * no effect that helps, and a simulation that flew off. */
ClothGapResult *
gap_sheet_new_spare (void)
{
  ClothGapResult *result = gap_sheet_new (3, 2, 1);
  ClothGapPlayback *play = &result->playback;
  ClothTopology *triangles = cloth_topology_new (6, 2);
  static const guint32 faces[] = { 0, 1, 4, CLOTH_NO_VERTEX, 0, 4, 3,
    CLOTH_NO_VERTEX
  };

  for (guint i = 0; i < 8; i++)
    triangles->faces[i] = faces[i];
  cloth_topology_free (play->topology);
  play->topology = triangles;
  play->before[0] = NAN;
  play->before[4] = 1e30f;
  g_clear_pointer (&play->take, g_free);
  g_clear_pointer (&play->after, g_free);
  g_clear_pointer (&play->sigma, g_free);
  g_clear_pointer (&result->vertices, g_free);
  g_clear_pointer (&result->gained, g_free);
  g_clear_pointer (&result->series.after, g_free);
  g_clear_pointer (&result->series.null_low, g_free);
  g_clear_pointer (&result->series.null_high, g_free);
  g_clear_pointer (&result->spectrum.after, g_free);
  g_clear_pointer (&result->spectrum.null, g_free);
  g_array_set_size (result->effects, 0);
  g_array_set_size (result->sets, 0);
  g_array_set_size (result->groups, 0);
  g_array_set_size (result->takes, 0);
  g_array_set_size (result->detection_limits, 0);
  g_array_set_size (result->patch, 0);
  g_array_set_size (result->free_numbers, 0);
  g_clear_pointer (&result->free_correlation, g_free);
  g_array_set_size (result->stages, 0);
  g_array_set_size (result->inputs, 0);
  result->verdict = CLOTH_GAP_UNEXPLAINED;
  result->gap_after = result->noise_floor = result->shrink = (ClothGapEstimate) {
  NAN, NAN, NAN};
  result->onset_s = NAN;
  return result;
}

/* All is there, and no number of it is known. */
ClothGapResult *
gap_sheet_new_unknown (void)
{
  ClothGapResult *result = gap_sheet_new (4, 3, 5);
  const ClothGapEstimate unknown = { NAN, NAN, NAN };

  result->verdict = CLOTH_GAP_UNEXPLAINED;
  result->gap_before = result->gap_after = result->noise_floor = unknown;
  result->shrink = unknown;
  result->predicted_shrink = result->measured_shrink = (ClothGapShrink) {
  unknown, unknown};
  result->rest_p_value = result->takes_agree_p_value = NAN;
  result->rivals = (ClothGapRivals) {
  NAN, NAN, NAN};
  for (guint i = 0; i < result->takes->len; i++) {
    ClothGapMeasuredTake *take = &g_array_index (result->takes,
        ClothGapMeasuredTake, i);

    take->gap_before = take->gap_after = take->noise_floor = unknown;
    take->shrink = take->free_before = take->free_after = unknown;
    take->free_floor = unknown;
  }
  for (guint i = 0; i < result->effects->len; i++) {
    ClothGapEffect *item = &g_array_index (result->effects, ClothGapEffect, i);

    item->probability = item->log_bayes_factor = item->p_value = NAN;
    item->constancy_p_value = NAN;
    item->shrink = unknown;
    for (guint k = 0; k < CLOTH_EFFECT_MAX_PARAMETERS; k++)
      item->values[k] = item->sigmas[k] = NAN;
  }
  for (guint i = 0; i < result->sets->len; i++)
    g_array_index (result->sets, ClothGapSet, i).probability = NAN;
  g_array_index (result->groups, ClothGapGroup, 0).log_bayes_factor = NAN;
  for (guint i = 0; i < result->detection_limits->len; i++)
    g_array_index (result->detection_limits, ClothGapLimit, i).value = NAN;
  for (guint i = 0; i < result->patch->len; i++) {
    ClothGapPatch *item = &g_array_index (result->patch, ClothGapPatch, i);

    item->before = item->after = item->factor = NAN;
  }
  for (guint i = 0; i < result->free_numbers->len; i++) {
    ClothGapFreeNumber *item = &g_array_index (result->free_numbers,
        ClothGapFreeNumber, i);

    item->value = item->sigma = item->low = item->high = NAN;
    for (guint k = 0; k < result->free_numbers->len; k++)
      result->free_correlation[i * result->free_numbers->len + k] = NAN;
  }
  for (guint i = 0; i < result->thresholds->len; i++)
    g_array_index (result->thresholds, ClothGapThreshold, i).value = NAN;
  for (guint i = 0; i < result->n_vertices; i++)
    result->vertices[i] = result->gained[i] = NAN;
  for (gsize i = 0; i < 3 * (gsize) result->n_vertices * result->n_frames; i++)
    result->playback.recorded[i] = NAN;
  return result;
}

/* Nothing was found, and the patch has nothing to change. */
ClothGapResult *
gap_sheet_new_calm (void)
{
  ClothGapResult *result = gap_sheet_new (4, 3, 5);

  result->verdict = CLOTH_GAP_NO_GAP;
  result->gap_after = result->shrink = (ClothGapEstimate) {
  NAN, NAN, NAN};
  g_array_index (result->effects, ClothGapEffect, 0).accepted = FALSE;
  g_array_set_size (result->patch, 0);
  g_ptr_array_set_size (g_array_index (result->sets, ClothGapSet, 0).effects,
      0);
  g_array_index (result->sets, ClothGapSet, 1).rival =
      CLOTH_GAP_RIVAL_DISPLACEMENT_FIELD;
  result->rivals.none_acts = 0.904;
  result->has_simulated = FALSE;
  result->playback.free_run = TRUE;
  return result;
}

/* Every text that a stranger may choose is @text, which must stay alive. */
ClothGapResult *
gap_sheet_new_hostile (const gchar * text)
{
  ClothGapResult *result = gap_sheet_new (4, 3, 5);
  static ClothEffect strange;

  strange = effects[0];
  strange.id = strange.blurb = text;
  strange.parameters[0].name = strange.parameters[0].unit = text;
  result->verdict = CLOTH_GAP_UNDECIDABLE;
  result->reason = g_strdup (text);
  g_free (result->playback.take);
  result->playback.take = g_strdup (text);
  cloth_gap_result_add_effect (result, &strange)->values[0] = 1;
  cloth_gap_result_add_untested (result, &strange, text);
  cloth_gap_result_add_group (result, text, NAN);
  g_array_index (result->effects, ClothGapEffect, 0).group = 1;
  g_array_index (result->effects, ClothGapEffect, 1).group = 1;
  cloth_gap_result_add_stage (result, text, 0.5, text);
  cloth_gap_result_add_version (result, text, text);
  cloth_gap_result_add_input (result, CLOTH_GAP_TAKE, text, NULL);
  cloth_gap_result_add_threshold (result, text, 1, text,
      CLOTH_GAP_ORIGIN_PAPER, text);
  cloth_gap_result_add_take (result, CLOTH_GAP_TAKE, text);
  g_ptr_array_add (cloth_gap_result_add_set (result,
          CLOTH_GAP_RIVAL_FORCE_FIELD, 0.01)->effects, &strange);
  cloth_gap_result_add_limit (result, &strange, 0, 1);
  cloth_gap_result_add_patch (result, text, text, 1, 2, text);
  result->patch_simulator = g_strdup (text);
  g_clear_pointer (&result->free_correlation, g_free);
  cloth_gap_result_add_free_number (result, text, text);
  cloth_gap_result_add_failure (result, text, text);
  return result;
}
