/* Decides whether something is in a take that its baseline has not and that the size of the gap need
 * not show.
 *
 * Model: if nothing is missing, a take less its baseline is noise, with the variances of both.
 * Three statistics, each against a fixed bound: the mean square of held vertices off their clamps'
 * paths; the mean square of the features with the free numbers fitted anew, against noise and
 * against the discrepancy; the mean square of slow long waves, against noise and against that of
 * shorter waves, which run-to-run variability has as well.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/unexplained.h"

#include <math.h>

/* A rest this many times the noise speaks of something unknown … */
#define UNKNOWN 1.9
/* … if it is also this share of the simulator's own error: where that is large, variability of
 * the real cloth is too. */
#define UNKNOWN_SHARE 0.45
/* Cloth that begins elsewhere than the baseline's has other variability. It does if its first
 * frames differ by so many times the square of noise. */
#define BEGIN_FRAMES 5
#define BEGINS_ALIKE 2.
#define UNKNOWN_SHARE_ELSEWHERE 0.75
/* Cloth is nudged away when waves of at most half a length over the sheet, that change in at
 * most half a wave a block, have so many times the power of noise, and so many times that of
 * waves of one to one and a half lengths. */
#define LONG_BAND 1
#define SLOW_COSINES 2
#define WRINKLE_BAND 3
#define SLOW 5.
#define SLOW_OVER_WRINKLES 4.
/* Clamps are off their paths with so many times the square that the baseline has there, or
 * noise, and by so much at least, which nobody logs more exactly; told of so many places. */
#define CLAMPS_OFF 2.
#define LEAST_OFF_M 2e-4
#define LEAST_HELD 30

/* Sums over takes of squares: of what is left, over the noise of the take and of its
 * discrepancy; of the discrepancy itself; the number of features. */
typedef struct
{
  gdouble rest, discrepancy, n;
} Rest;

/* With the free numbers fitted once more. */
static void
add_rest (const ClothDiagnosis * d, const ClothSensitivities * study,
    Rest * rest)
{
  guint n = d->candidates->n_free;
  gdouble scale = cloth_sensitivities_discrepancy_scale (study);
  g_autofree gdouble *z = cloth_sensitivities_residual (study);
  g_autofree gdouble *precisions = g_new (gdouble, n + 1);
  g_autoptr (ClothPowerSpectrum) noise =
      cloth_power_spectrum_new (study->features, z);
  g_autoptr (ClothNormalEquations) normal = NULL;
  ClothReducedEquations reduced;

  for (guint k = 0; k < noise->n; k++)
    noise->values[k] = scale * scale;
  for (guint k = 0; k < n; k++)
    precisions[k] = d->precisions[k] * d->study.overdispersion;
  normal = cloth_normal_equations_new (study->features, noise, z,
      study->columns, n);
  if (!cloth_normal_equations_reduce (normal, NULL, d->all, precisions, n,
          NULL, 0, &reduced))
    return;
  rest->rest += reduced.r;
  rest->n += normal->per_block * normal->n_blocks;
  for (gsize k = 0; k < study->features->size; k++)
    rest->discrepancy += scale * scale / (1. + scale * scale) *
        study->discrepancy->z[k] * study->discrepancy->z[k];
}

/* Whether a take begins as the baseline does whose discrepancy it has. */
static gboolean
begins_alike (const ClothSensitivities * study)
{
  const ClothRecording *a = study->recording;
  const ClothRecording *b = study->discrepancy->recording;
  const gdouble noise = a->sigma * a->sigma + b->sigma * b->sigma;
  gdouble sum = 0.;
  gsize n = 0;

  for (gsize k = 0; k < (gsize) MIN (BEGIN_FRAMES, a->n_frames) * a->n; k++) {
    if (a->seen[k] == 0. || b->seen[k] == 0.)
      continue;
    for (guint c = 0; c < 3; c++) {
      const gdouble apart = a->y[3 * k + c] - b->y[3 * k + c];

      sum += apart * apart;
    }
    n += 3;
  }
  return sum <= BEGINS_ALIKE * noise * n;
}

/* Whether much more than noise is in the takes that is not in the baselines. With an effect
 * there is, even with the right one: another motion has other wrinkles. */
static gboolean
is_much (const ClothDiagnosis * d)
{
  gdouble share = UNKNOWN_SHARE;
  Rest rest = { 0. };

  for (guint i = 0; i < d->n_takes; i++) {
    add_rest (d, cloth_diagnosis_study (d, i), &rest);
    if (!begins_alike (cloth_diagnosis_study (d, i)))
      share = UNKNOWN_SHARE_ELSEWHERE;
  }
  return rest.rest > UNKNOWN * UNKNOWN * rest.n
      && rest.rest > share * share * rest.discrepancy;
}

/* Whether something moves the cloth as a whole, slowly and in long waves. Run-to-run
 * variability has shorter waves, too. */
static gboolean
is_moved_slowly (const ClothDiagnosis * d)
{
  gdouble slow = 0., wrinkles = 0.;
  gsize n_slow = 0, n_wrinkles = 0;

  for (guint i = 0; i < d->n_takes; i++) {
    const ClothSensitivities *study = cloth_diagnosis_study (d, i);
    const ClothFeatures *f = study->features;
    const gdouble scale = cloth_sensitivities_discrepancy_scale (study);
    const gdouble noise = 1. + scale * scale;
    g_autofree gdouble *z = cloth_sensitivities_residual (study);

    for (gsize k = 0; k < f->size; k++) {
      const guint band = f->bands[k / 3 % f->n_waves];
      const guint cosine = k / (3 * (gsize) f->n_waves) % f->n_cosines;

      if (band <= LONG_BAND && cosine < SLOW_COSINES) {
        slow += z[k] * z[k] / noise;
        n_slow++;
      } else if (band > LONG_BAND && band <= WRINKLE_BAND) {
        wrinkles += z[k] * z[k] / noise;
        n_wrinkles++;
      }
    }
  }
  return slow > SLOW * n_slow
      && slow * n_wrinkles > SLOW_OVER_WRINKLES * wrinkles * n_slow;
}

/* Mean square of what a recording's held vertices are seen off their clamps' paths, m²; NaN:
 * they were hardly seen. */
static gdouble
find_off (const ClothRecording * r)
{
  const guint n_held = r->scene->held->len;
  /* simulators and people let go a little earlier or later than the log has it */
  const gdouble margin = 1.5 * (r->times[r->n_frames - 1] - r->times[0]) /
      (r->n_frames - 1);
  gdouble sum = 0.;
  gsize n = 0;

  for (gsize k = 0; k < (gsize) r->n_frames * n_held; k++) {
    const ClothHeld *held = &g_array_index (r->scene->held, ClothHeld,
        k % n_held);
    const gsize at = k / n_held * r->n + held->vertex;
    const gdouble time_s = r->times[k / n_held];

    if (r->seen[at] == 0. || time_s < held->from_s + margin
        || time_s > held->until_s - margin)
      continue;
    for (guint c = 0; c < 3; c++) {
      const gdouble off = r->y[3 * at + c] - r->scene->clamps[3 * k + c];

      sum += off * off;
    }
    n++;
  }
  return n < LEAST_HELD ? NAN : sum / n;
}

/* A clamp that is seen is an observation: off its logged path it leads the cloth elsewhere
 * than the simulation's. The baseline that is furthest off says what is usual. */
static gchar *
find_clamps_off (ClothDiagnosis * d)
{
  gdouble usual = 0.;

  for (guint i = d->n_takes; i < d->studies->len; i++)
    usual = fmax (usual, find_off (cloth_diagnosis_study (d, i)->recording));
  for (guint i = 0; i < d->n_takes && usual > 0.; i++) {
    const ClothRecording *r = cloth_diagnosis_recording (d, i);
    const gdouble off = find_off (r), noise = 3. * r->sigma * r->sigma;

    if (off > CLAMPS_OFF * MAX (usual, noise)
        && off > LEAST_OFF_M * LEAST_OFF_M) {
      d->clamps_off = off - MAX (usual, noise);
      return g_strdup_printf ("The clamps of %s are seen %.1f mm off their "
          "logged paths, %s %.1f mm.", r->name, 1e3 * sqrt (off),
          d->twins->len ? "in the simulation" : "on the baseline",
          1e3 * sqrt (usual));
    }
  }
  return NULL;
}

/* @d: a diagnosis whose takes are linearised at the model
 *
 * Looks for signs that something is there, whatever it is, which the size of the gap need
 * not show: the floor holds the simulator's own error, too. Where baselines move alike, the
 * residual without their discrepancy would be noise if the model lacked nothing.
 *
 * Returns: (transfer full) (nullable): what speaks of something that is not in the
 *   baselines, a sentence; %NULL: nothing does
 */
gchar *
cloth_diagnosis_find_unexplained (ClothDiagnosis * d)
{
  gchar *clamps = find_clamps_off (d);

  if (clamps)
    return clamps;
  if (cloth_diagnosis_has_discrepancies (d) && is_moved_slowly (d))
    return
        g_strdup
        ("Against the baseline or its simulation the cloth as a whole is slowly led "
        "elsewhere, which its wrinkles don't account for.");
  if (cloth_diagnosis_has_discrepancies (d) && is_much (d))
    return g_strdup ("What is left differs from what is left of the baseline "
        "or the simulation by far more than noise.");
  return NULL;
}
