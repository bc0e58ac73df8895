/* The state of a diagnosis under way, which the stages of diagnose.c hand on.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/estimate.h"
#include "gst/fit/nudge/nudge.h"
#include "gst/gap/camera/solve.h"
#include "gst/gap/inputs.h"
#include "gst/gap/report/result.h"

G_BEGIN_DECLS

/* A fault of a camera is accepted when its evidence is this at least. */
#define CLOTH_DIAGNOSIS_LEAST_LOG_BAYES_FACTOR 10.
/* Something unknown must be this share of the gap to be worth a word. */
#define CLOTH_DIAGNOSIS_LEAST_SHARE 0.2
/* Standard deviations of cameras' faults are given so many times as wide as the fit finds them, which
 * knows nothing of the simulator's own error: then about nine of ten of the blind benchmark's
 * intervals of 95% hold the truth. */
#define CLOTH_DIAGNOSIS_SIGMA_WIDTH 3.6
/* Length of the windows that the gap is measured in, s, and gain of the observer that leads up
 * to them, 1/s². */
#define CLOTH_DIAGNOSIS_WINDOW_S 0.3
#define CLOTH_DIAGNOSIS_WINDOW_GAIN 1600.
/* Most effects that are accepted. */
#define CLOTH_DIAGNOSIS_MAX_ACCEPTED 3
/* Subsets of them. */
#define CLOTH_DIAGNOSIS_N_SUBSETS (1 << CLOTH_DIAGNOSIS_MAX_ACCEPTED)

/* What was wrong with a camera, or, when @camera is the number of cameras, with all alike. */
typedef struct
{
  guint candidate, camera;
  const ClothEffect *effect;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble sigmas[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble probability, p_value, constancy_p_value;
  gboolean small;               /* it acts, but hardly moves points */
} ClothCameraFault;

typedef struct
{
  /* What was given, and the result that every stage adds to; made by cloth_diagnosis_init (),
   * read by all. */
  ClothTake **takes;
  guint n_takes;
  const ClothGapOptions *options;
  ClothEstimateOptions study;
  ClothGapResult *result;

  /* Made by load.c. The recordings are those of the takes, the baselines and the hold-outs,
   * in this order; faults.c corrects them. The twins are those of the takes and the hold-outs,
   * those after are of what judges; each list is empty where none were given. The studies are
   * those of the takes, and of what the model must agree with: the baselines, and the twins
   * of the takes; read and linearised by inference/, read by verdict/. */
  GPtrArray *recordings;
  GPtrArray *twins;
  GPtrArray *afters;
  GPtrArray *studies;

  /* Camera faults, made by faults.c, read by judge.c and where.c: those that were accepted; the
   * positions with them, as the cameras gave them, of each recording that was corrected; the
   * mean square of their displacement by the faults, m²; what else is wrong with the points in
   * the pictures; and the effects that were tested, for the result. The shrink by the faults is
   * made by measure.c. */
  ClothCameraFault faults[CLOTH_DIAGNOSIS_MAX_ACCEPTED];
  guint n_faults;
  gdouble **uncorrected;
  gdouble camera_mean_square, shrink_of_faults;
  gboolean has_camera_errors;
  ClothCameraErrors camera_errors;
  GArray *camera_effects;       /* ClothGapEffect */

  /* What is fitted and tested, made by candidates.c: the directions, and the numbers of all of
   * them. The model with its free numbers fitted and the precisions of these are made by
   * free-numbers.c. Read by all stages after it. */
  ClothCandidates *candidates;
  guint *all;
  ClothModel *model;
  gdouble *precisions;

  /* The posterior, made by infer.c, read by verdict/: that something acts which no effect of the
   * library is, and its share of the gap; a sentence on clamps that were elsewhere than logged,
   * or NULL; whether the takes' references tell most of what
   * the simulator itself is off by; the variance of the rest of that in the first take. */
  gdouble unknown_probability, unknown_share;
  gchar *clamps_off;
  gboolean is_alike;
  ClothPowerSpectrum *discrepancy_variance;

  /* Accepted effects, made by conclude.c, read by verdict/: candidates. The models with each subset of
   * them, fitted by infer.c on what doesn't judge: bit k of the index says that the k-th acts; NULL where
   * there is none, and but for all of them where the user's simulator judges. measure.c takes back what brings the simulation no nearer to the cloth, and keeps the
   * model with the others; NULL without any. And an effect of chance that is likelier than not, or NULL. */
  guint accepted[CLOTH_DIAGNOSIS_MAX_ACCEPTED];
  guint n_accepted;
  ClothModel *fitted[CLOTH_DIAGNOSIS_N_SUBSETS];
  ClothModel *with;
  const ClothEffect *chance;
  const ClothEffect *taken_back;        /* the likeliest of what was, or NULL */

  /* What was measured of each recording, and behind them of all that judge; made and read by
   * measure.c. */
  GArray *measured;

  /* Energies of the nudged residuals of the first take before and after, and of the first
   * baseline, NULL where there is none; made by measure.c, read by where.c. The nudged residual
   * of the first take, as ClothWindowedGap has it, or NULL; read by null-distribution.c. */
  ClothEnergySpectrum *before, *after, *floor;
  gfloat *nudged;

  /* Gaps of simulations that lack nothing, and the recordings that they are of: the model on a
   * baseline, the other force model on a take; which of them is the floor; whether the first
   * is of a twin or a baseline that moves as the first take does. Made by measure.c, read by
   * null-distribution.c. */
  ClothWindowedGap *nulls[2];
  guint null_recordings[2];
  guint n_nulls;
  guint floor_null;
  gboolean null_alike;

  /* The running part of the work, made by cloth_diagnosis_begin_part (): the shares of all the
   * work at its begin and end, the share of the rest of it that each simulation is, and what is
   * being done. */
  gdouble from, to, each;
  gchar *what;
} ClothDiagnosis;

static inline ClothRecording *
cloth_diagnosis_recording (const ClothDiagnosis * d, guint i)
{
  return g_ptr_array_index (d->recordings, i);
}

static inline ClothSensitivities *
cloth_diagnosis_study (const ClothDiagnosis * d, guint i)
{
  return g_ptr_array_index (d->studies, i);
}

/* How many studies there are of what the model must agree with, behind those of the takes. */
static inline guint
cloth_diagnosis_n_references (const ClothDiagnosis * d)
{
  return d->studies->len - d->n_takes;
}

static inline const ClothCandidate *
cloth_diagnosis_accepted (const ClothDiagnosis * d, guint i)
{
  return &g_array_index (d->candidates->list, ClothCandidate, d->accepted[i]);
}

/* Every other block of time judges what the others have fitted. */
static inline gboolean
cloth_diagnosis_is_held_out (const ClothDiagnosis * d, guint block)
{
  return !d->options->n_hold_outs && block % 2 == 1;
}

void cloth_diagnosis_init (ClothDiagnosis * d, ClothTake ** takes,
    guint n_takes, const ClothGapOptions * options);
void cloth_diagnosis_clear (ClothDiagnosis * d);

void cloth_diagnosis_begin_part (ClothDiagnosis * d, gdouble from, gdouble to,
    gdouble each, const gchar * what);
ClothObservations *cloth_diagnosis_observations (const ClothDiagnosis * d,
    guint recording);
gboolean cloth_diagnosis_has_observations (const ClothDiagnosis * d);
ClothRecording *cloth_diagnosis_twin (const ClothDiagnosis * d,
    guint recording);
ClothRecording *cloth_diagnosis_after (const ClothDiagnosis * d,
    guint recording);
guint cloth_diagnosis_count_faults (const ClothDiagnosis * d);
ClothModel *cloth_diagnosis_other_model (const ClothModel * model);
gboolean cloth_diagnosis_runs_theirs (const ClothDiagnosis * d);
guint cloth_diagnosis_list_accepted (const ClothDiagnosis * d,
    guint subset, guint * directions, gdouble * precisions);
ClothRecording *cloth_diagnosis_correct (const ClothRecording * recording,
    const ClothModel * model);
ClothWindowedGap **cloth_diagnosis_measure_windows (ClothDiagnosis * d,
    const ClothRecording * recording, const ClothModel * const *models,
    guint n, GError ** error);

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (ClothDiagnosis, cloth_diagnosis_clear)
G_END_DECLS
