/* The state of a diagnosis under way, which the stages of diagnose.c hand on.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/sensitivities.h"
#include "gst/fit/nudge/windows.h"
#include "gst/gap/camera/solve.h"
#include "gst/gap/inputs.h"
#include "gst/gap/report/result.h"

G_BEGIN_DECLS

/* An effect is accepted when its evidence is this at least, when it makes blocks better
 * that it was not estimated on, and when it removes this share of the gap's variance. Of the
 * first where a discrepancy is taken off it is enough that the gap, in which the simulator's
 * own error is too, is hardly larger. */
#define CLOTH_DIAGNOSIS_LEAST_EVIDENCE 10.
#define CLOTH_DIAGNOSIS_LEAST_SHRINK 0.1
/* What remains is no more than noise when it is below this many floors (variance). */
#define CLOTH_DIAGNOSIS_BAND 2.25
/* Deviations of parameters are told so many times as wide as the fit takes them for, which
 * knows nothing of the simulator's own error: then about nine of ten of the blind benchmark's
 * intervals of 95% hold the truth. */
#define CLOTH_DIAGNOSIS_SIGMA_WIDTH 3.6
/* Length of the windows that the gap is measured in, s, and gain of the observer that leads up
 * to them, 1/s². */
#define CLOTH_DIAGNOSIS_WINDOW_S 0.3
#define CLOTH_DIAGNOSIS_WINDOW_GAIN 1600.
/* Most effects that are accepted. */
#define CLOTH_DIAGNOSIS_MAX_ACCEPTED 3

/* What was wrong with a camera, or, one past the last, with all alike. */
typedef struct
{
  guint candidate, camera;
  const ClothEffect *effect;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble sigmas[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble probability, p_value, constancy_p_value;
  gboolean small;               /* it hardly moves points, but it is there */
} ClothCameraFault;

typedef struct
{
  ClothTake **takes;
  guint n_takes;
  const ClothGapOptions *options;
  ClothEstimateOptions study;
  ClothGapResult *result;
  GPtrArray *recordings;        /* of the takes, the baselines, the hold-outs */
  GPtrArray *studies;           /* of the takes and the baselines */
  /* what was wrong with the cameras; the recordings are without it, their positions with
   * it stand in @filmed, where there is any; mean square of what it moved the points by, m² */
  ClothCameraFault faults[CLOTH_DIAGNOSIS_MAX_ACCEPTED];
  guint n_faults;
  gdouble **filmed;
  gdouble camera_square, shrink_of_faults;
  gboolean has_camera_errors;
  ClothCameraErrors camera_errors;
  GArray *camera_effects;       /* ClothGapEffect: those found first */
  ClothModel *model;            /* with its free numbers fitted */
  ClothCandidates *candidates;
  gdouble *precisions;          /* of the free numbers */
  guint *all;                   /* every direction */
  ClothNormalEquations *normal;
  guint n_variability;                /* of its columns, behind those of the directions */
  gdouble *variability_precisions;
  guint *nuisances;             /* of the test: what is fitted along, and its precisions */
  gdouble *nuisance_precisions;
  gboolean *sound;
  gboolean *blocks;             /* that estimates come from */
  guint n_blocks;
  /* Effects taken in, one by one: candidates, the models with them, deviations of the
   * directions in them */
  guint chosen[CLOTH_DIAGNOSIS_MAX_ACCEPTED];
  gdouble probabilities[CLOTH_DIAGNOSIS_MAX_ACCEPTED];  /* when they were taken in */
  ClothModel *with[CLOTH_DIAGNOSIS_MAX_ACCEPTED];
  gdouble sigmas[CLOTH_DIAGNOSIS_MAX_ACCEPTED][CLOTH_DIAGNOSIS_MAX_ACCEPTED][CLOTH_EFFECT_MAX_PARAMETERS];
  guint n_chosen;
  /* those that others made needless */
  guint dropped[CLOTH_DIAGNOSIS_MAX_ACCEPTED];
  guint n_dropped;
  gchar *unknown;               /* what speaks of something, whatever it is, or NULL */
  gdouble clamps_off;           /* square that clamps are further off their paths than usual,
                                   m²; 0: they are not */
  gboolean asked;               /* whether an effect was asked for */
  /* of the first take before and after, of the first baseline; NULL where there is none */
  ClothEnergySpectrum *before, *after, *floor;
  gfloat *nudged;                  /* residual of the first take, as an extent has it, or NULL */
  /* of simulations that lack nothing, and what they are of: of a baseline, of the other
   * force model */
  ClothWindowedGap *nulls[2];
  guint null_recordings[2];
  guint n_nulls;
  guint floor_null;             /* which of them is the floor */
  gboolean null_alike;          /* whether the first is of a baseline that moves as the
                                   first take does */
  gdouble least_evidence;
  gdouble *null_evidence;       /* of each candidate, on the baselines */
  /* of the running part of the work: its share of all, what of it each simulation gets */
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

static inline const ClothCandidate *
cloth_diagnosis_chosen (const ClothDiagnosis * d, guint i)
{
  return &g_array_index (d->candidates->list, ClothCandidate, d->chosen[i]);
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
guint cloth_diagnosis_count_faults (const ClothDiagnosis * d);
ClothModel *cloth_diagnosis_other_model (const ClothDiagnosis * d);
gboolean cloth_diagnosis_is_decided (const ClothDiagnosis * d,
    const ClothEffect * effect);
gboolean cloth_diagnosis_has_discrepancies (const ClothDiagnosis * d);
ClothWindowedGap **cloth_diagnosis_measure_windows (ClothDiagnosis * d,
    const ClothRecording * recording, const ClothModel * const *models,
    guint n, GError ** error);

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (ClothDiagnosis, cloth_diagnosis_clear)
G_END_DECLS
