/* Analysis by synthesis: a simulated cloth fitted to what cameras saw.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/estimate.h"
#include "gst/fit/nudge/nudge.h"

G_BEGIN_DECLS

/* @gain: of the springs that draw the cloth while it is fitted, 1/s² (1600)
 * @window_s: length of the windows in which it is let go to be measured, s (0.3)
 * @n_passes: most linearisations of a fit (18)
 * @turns: how often what was seen is looked at anew with the fitted numbers (2)
 * @rollout: how to simulate
 */
typedef struct {
  gdouble gain;
  gdouble window_s;
  guint n_passes;
  guint turns;
  ClothRolloutOptions rollout;
} ClothSynthesisOptions;

/* @take: mesh, clamps and times
 * @observations: (nullable): what cameras saw of it, which counts in place of the take's positions but for
 *   those of the first frame, where the cloth starts; %NULL: the positions count
 */
typedef struct {
  ClothTake *take;
  const ClothObservations *observations;
} ClothSynthesisInput;

/* @name: of the model's number
 * @before: where it started
 * @value: where it is
 * @sigma: its standard deviation, in its unit, as a number of the model's mesh; NaN after a search, which finds
 *   none
 * @finer: what it is on a mesh twice as fine; NaN where that is not known
 * @finer_sigma: standard deviation of that, as a number of the cloth, whatever the mesh
 * @at_end: it came to an end of its range, where the cloth may be beyond
 */
typedef struct {
  gchar *name;
  gdouble before, value, sigma;
  gdouble finer, finer_sigma;
  gboolean at_end;
} ClothSynthesisNumber;

/* @drawn: distance of what was seen to the cloth that the springs draw to it, RMS, m
 * @windows: to the cloth let go in windows, drawn by nothing
 * @free: to the cloth let go from the start
 */
typedef struct {
  gdouble drawn, windows, free;
} ClothSynthesisGap;

/* @recording: what was seen
 * @counts: how, of a film without a mesh
 * @before: with the model as it was
 * @after: with the fitted one
 * @gain: of the springs that foretell what they are not shown best, 1/s²
 * @positions: (array): the fitted cloth, drawn to what was seen by these, [n_frames][n][3], m
 * @let_go: (array): the same let go in windows
 */
typedef struct {
  ClothRecording *recording;
  ClothObservedCounts counts;
  ClothSynthesisGap before, after;
  gdouble gain;
  gfloat *positions;
  gfloat *let_go;
} ClothSynthesisTake;

/* @model: with the fitted numbers
 * @numbers: (element-type ClothSynthesisNumber): they
 * @takes: (array length=n_takes): of each input
 * @n_takes: how many
 */
typedef struct {
  ClothModel *model;
  GArray *numbers;
  ClothSynthesisTake *takes;
  guint n_takes;
} ClothSynthesis;

/* What is fitted, made once: what was seen, and the numbers that may be moved. */
typedef struct _ClothSynthesisProblem ClothSynthesisProblem;

void cloth_synthesis_options_init (ClothSynthesisOptions * options);
ClothSynthesis *cloth_synthesis_fit (const ClothSynthesisInput * inputs,
    guint n_inputs, const ClothModel * model,
    const ClothSynthesisOptions * options, GError ** error);
ClothSynthesisProblem *cloth_synthesis_problem_new (const ClothSynthesisInput *
    inputs, guint n_inputs, const ClothModel * model,
    const ClothSynthesisOptions * options, GError ** error);
guint cloth_synthesis_problem_get_n (const ClothSynthesisProblem * problem);
void cloth_synthesis_problem_get_room (const ClothSynthesisProblem * problem,
    gdouble * start, gdouble * low, gdouble * high);
gdouble cloth_synthesis_problem_evaluate (gpointer problem,
    const gdouble * point, guint worker);
ClothSynthesis *cloth_synthesis_problem_finish (ClothSynthesisProblem * problem,
    const gdouble * point, GError ** error);
void cloth_synthesis_problem_free (ClothSynthesisProblem * problem);
void cloth_synthesis_reproject (const ClothSynthesisTake * take,
    const gfloat * positions, const ClothObservations * observations,
    gdouble * errors);
void cloth_synthesis_free (ClothSynthesis * synthesis);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSynthesis, cloth_synthesis_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSynthesisProblem,
    cloth_synthesis_problem_free)
G_END_DECLS
