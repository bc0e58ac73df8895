/* What a diagnosis found: the contents of gap.json, and what the report shows besides.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"
#include "gst/effect/effect.h"
#include "gst/sim/model.h"

G_BEGIN_DECLS

/* @CLOTH_GAP_UNDECIDABLE: the data can't tell; `reason` says why
 * @CLOTH_GAP_NO_GAP: the simulation agrees with the recording
 * @CLOTH_GAP_EXPLAINED: the accepted effects explain the gap
 * @CLOTH_GAP_AMBIGUOUS: so they do, but others would do as well
 * @CLOTH_GAP_UNEXPLAINED: something remains that no effect of the library explains
 */
typedef enum {
  CLOTH_GAP_UNDECIDABLE,
  CLOTH_GAP_NO_GAP,
  CLOTH_GAP_EXPLAINED,
  CLOTH_GAP_AMBIGUOUS,
  CLOTH_GAP_UNEXPLAINED
} ClothGapVerdict;

/* @value: the best estimate
 * @low: lower end of its 95% interval
 * @high: upper end
 *
 * A number and how sure it is. NaN: not known (null in gap.json).
 */
typedef struct {
  gdouble value;
  gdouble low;
  gdouble high;
} ClothGapEstimate;

/* @effect: which one: its names, units and side are taken from here
 * @camera: (nullable): name of the camera it is of, interned; %NULL: of no camera, or
 *   of all alike
 * @probability: that it acts, calibrated, 0 to 1
 * @values: its fitted parameters, in the order of @effect; NaN: not fitted
 * @sigmas: their standard deviations
 * @p_value: of its score test
 * @constancy_p_value: that it is the same all the time and everywhere; NaN: not tested
 * @shrink: by how much the held-out gap shrinks when all accepted effects are added, of variance
 * @group: index into `groups`, or -1 when nothing is confused with it
 * @accepted: whether it is part of the model that `gap_after` is measured with
 * @refitted: always %FALSE: an effect that equals a free parameter of the model can't be
 *   told from it, so it is among the untested ones. Part of the file's format.
 *
 * What was found of one effect.
 */
typedef struct {
  const ClothEffect *effect;
  const gchar *camera;
  gdouble probability;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble sigmas[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble p_value;
  gdouble constancy_p_value;
  ClothGapEstimate shrink;
  gint group;
  gboolean accepted;
  gboolean refitted;
} ClothGapEffect;

/* @experiment: (nullable): the capture that would tell them apart, a sentence; %NULL:
 *   none of those tried would
 * @log_bayes_factor: what it is expected to bring, log Bayes factor; NaN: not known
 *
 * Effects that these data can't tell apart: those whose `group` is its index.
 */
typedef struct {
  gchar *experiment;
  gdouble log_bayes_factor;
} ClothGapGroup;

/* @effect: an effect that could not be tested
 * @reason: why, and what would help, a sentence
 */
typedef struct {
  const ClothEffect *effect;
  gchar *reason;
} ClothGapUntested;

/* @name: of the stage: what happens between the cloth and the comparison
 * @share: of the gap's variance that arises there, 0 to 1; NaN: could not be measured
 * @reason: (nullable): why it could not, a sentence
 */
typedef struct {
  gchar *name;
  gdouble share;
  gchar *reason;
} ClothGapStage;

/* @from: where it begins: Hz, or cycles per metre over the flat cloth
 * @to: where it ends; infinite: nowhere
 * @share: of the residual's mean square, 0 to 1
 * @after: what the accepted effects leave of it, in the same unit: 1 is all of the
 *   residual before; NaN: without any
 * @over_floor: @share over that of a simulation that lacks nothing; NaN: not known
 *
 * Of the residual of a simulation that is nudged to the recording.
 */
typedef struct {
  gdouble from;
  gdouble to;
  gdouble share;
  gdouble after;
  gdouble over_floor;
} ClothGapBand;

/* @CLOTH_GAP_TAKE: it is diagnosed
 * @CLOTH_GAP_BASELINE: the model is accepted on it
 * @CLOTH_GAP_HOLD_OUT: it judges, and nothing was fitted on it
 * @CLOTH_GAP_MODEL: the model's file
 */
typedef enum {
  CLOTH_GAP_TAKE,
  CLOTH_GAP_BASELINE,
  CLOTH_GAP_HOLD_OUT,
  CLOTH_GAP_MODEL
} ClothGapRole;

/* @role: what it was used for
 * @name: its name
 * @sha256: (nullable): of a take what cloth_take_sha256 () says, of the model that of
 *   its file
 */
typedef struct {
  ClothGapRole role;
  gchar *name;
  gchar *sha256;
} ClothGapInput;

/* @name: which one
 * @value: its value
 * @unit: in the notation of the SI, "1" for a ratio
 */
typedef struct {
  gchar *name;
  gdouble value;
  gchar *unit;
} ClothGapThreshold;

/* @name: of what
 * @text: what there is to say of it
 */
typedef struct {
  gchar *name;
  gchar *text;
} ClothGapNote;

/* @n: number of windows
 * @times: centre of each, seconds, growing
 * @before: gap in it, RMS in metres; NaN: nothing was seen
 * @after: (nullable): with the accepted effects
 * @null_low: (nullable): lower end of the 95% band of a simulation that lacks nothing
 * @null_high: (nullable): upper end
 *
 * The gap over time.
 */
typedef struct {
  guint n;
  gdouble *times;
  gdouble *before;
  gdouble *after;
  gdouble *null_low;
  gdouble *null_high;
} ClothGapSeries;

/* @n_frequencies: number of frequencies
 * @n_waves: number of wave numbers
 * @frequencies: Hz, growing; 0: what stands still
 * @waves: wave numbers over the flat cloth, whichever way: cycles per metre, growing
 * @before: mean square of the residual, [n_waves][n_frequencies], m²; NaN: there is
 *   no such wave or frequency
 * @after: (nullable): with the accepted effects
 * @null: (nullable): of a simulation that lacks nothing
 *
 * Where in space and time the energy lies of the residual of a simulation that is nudged
 * to the recording.
 */
typedef struct {
  guint n_frequencies;
  guint n_waves;
  gdouble *frequencies;
  gdouble *waves;
  gdouble *before;
  gdouble *after;
  gdouble *null;
} ClothGapSpectrum;

/* @take: (nullable): name of the take that is shown
 * @topology: (nullable): its mesh; %NULL: there is nothing to show
 * @n_frames: number of frames
 * @times: their times, seconds, growing
 * @recorded: recorded positions, [n_frames][n_vertices][3], metres; NaN: not seen
 * @before: (nullable): simulated without the accepted effects
 * @after: (nullable): simulated with them
 * @sigma: (nullable): what the distance of recorded and simulated would be without a
 *   gap, RMS, [n_frames][n_vertices], metres
 *
 * The cloth as it moved.
 */
typedef struct {
  gchar *take;
  ClothTopology *topology;
  guint n_frames;
  gdouble *times;
  gfloat *recorded;
  gfloat *before;
  gfloat *after;
  gfloat *sigma;
} ClothGapPlayback;

/* @verdict: the outcome
 * @reason: (nullable): why it is undecidable, and what would help, or which sign there
 *   is of something unknown: a sentence
 * @notes: (element-type utf8): what else one should know of it, sentences
 * @gap_before: recorded minus simulated on held-out data, RMS in metres
 * @gap_after: the same with the accepted effects; NaN without any
 * @noise_floor: what it would be if the simulation lacked nothing
 * @shrink: (V_before − V_after) ÷ (V_before − V_floor), V = squared gap
 * @rest_p_value: that what remains is no more than the noise floor
 * @held_out_takes: whether "held-out" means takes of their own, else blocks of time
 * @effects: (element-type ClothGapEffect): the tested effects, the likeliest first
 * @groups: (element-type ClothGapGroup): what can't be told apart
 * @untested: (element-type ClothGapUntested): what could not be tested
 * @n_vertices: number of vertices of the cloth
 * @vertices: (nullable): share of the gap per vertex; NaN: never seen
 * @gained: (nullable): what of the gap the accepted effects take off at each vertex;
 *   below 0 where it grows; NaN: never seen
 * @n_frames: number of frames of the playback's take
 * @frames: (nullable): share of the gap per frame
 * @onset_s: when the gap begins, seconds; NaN: it is there from the beginning, or
 *   there is none
 * @region: (nullable) (element-type guint): vertices that the gap is at, growing; empty:
 *   nowhere more than chance; %NULL: not known
 * @directions: share along warp, weft and normal
 * @still: share of the residual that does not move; NaN: not known
 * @bands: (element-type ClothGapBand): per band of frequencies
 * @waves: (element-type ClothGapBand): per band of waves over the flat cloth
 * @stages: (element-type ClothGapStage): share per stage, from camera to physics
 * @seconds: wall time of the diagnosis
 * @simulations: number of simulations that it ran
 * @seed: of its random numbers
 * @versions: (element-type ClothGapNote): of the program, the library of effects, its
 *   priors …
 * @inputs: (element-type ClothGapInput): what it worked on
 * @thresholds: (element-type ClothGapThreshold): what it decided by
 * @failures: (element-type ClothGapNote): simulations that failed, and how
 * @series: the gap over time of the playback's take, for the report
 * @spectrum: its spectrum, for the report
 * @playback: the cloth, for the report
 * @model: (nullable): the model with its free numbers as they were fitted and the accepted
 *   effects but those of cameras; %NULL: nothing was fitted
 *
 * All that a diagnosis has to say. Everything is owned by the result, but the effects'
 * constant descriptions. A number that is not known is NaN, a list without entries is
 * empty.
 */
typedef struct {
  ClothGapVerdict verdict;
  gchar *reason;
  GPtrArray *notes;
  ClothGapEstimate gap_before;
  ClothGapEstimate gap_after;
  ClothGapEstimate noise_floor;
  ClothGapEstimate shrink;
  gdouble rest_p_value;
  gboolean held_out_takes;
  GArray *effects;
  GArray *groups;
  GArray *untested;
  guint n_vertices;
  gdouble *vertices;
  gdouble *gained;
  guint n_frames;
  gdouble *frames;
  gdouble onset_s;
  GArray *region;
  gdouble directions[3];
  gdouble still;
  GArray *bands;
  GArray *waves;
  GArray *stages;
  gdouble seconds;
  guint64 simulations;
  guint64 seed;
  GArray *versions;
  GArray *inputs;
  GArray *thresholds;
  GArray *failures;
  ClothGapSeries series;
  ClothGapSpectrum spectrum;
  ClothGapPlayback playback;
  ClothModel *model;
} ClothGapResult;

ClothGapResult *cloth_gap_result_new (void);
void cloth_gap_result_add_note (ClothGapResult * result, const gchar * note);
ClothGapEffect *cloth_gap_result_add_effect (ClothGapResult * result,
    const ClothEffect * effect);
void cloth_gap_result_add_group (ClothGapResult * result,
    const gchar * experiment, gdouble log_bayes_factor);
void cloth_gap_result_add_untested (ClothGapResult * result,
    const ClothEffect * effect, const gchar * reason);
void cloth_gap_result_add_stage (ClothGapResult * result, const gchar * name,
    gdouble share, const gchar * reason);
void cloth_gap_result_add_version (ClothGapResult * result,
    const gchar * name, const gchar * version);
void cloth_gap_result_add_input (ClothGapResult * result, ClothGapRole role,
    const gchar * name, const gchar * sha256);
void cloth_gap_result_add_threshold (ClothGapResult * result,
    const gchar * name, gdouble value, const gchar * unit);
void cloth_gap_result_add_failure (ClothGapResult * result,
    const gchar * run, const gchar * what);
const gchar *cloth_gap_verdict_name (ClothGapVerdict verdict);
void cloth_gap_result_free (ClothGapResult * result);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapResult, cloth_gap_result_free)
G_END_DECLS
