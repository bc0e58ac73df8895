/* What a diagnosis found: the contents of gap.json, and what the report shows besides.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"
#include "gst/effect/effect.h"
#include "gst/rig/rig.h"
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

/* @windows: of the squared gap over windows of 0.3 s
 * @free: of that of the run from the start that nothing restarts
 *
 * A shrink, (V_before − V_after) ÷ (V_before − V_floor), both ways that it is measured.
 */
typedef struct {
  ClothGapEstimate windows;
  ClothGapEstimate free;
} ClothGapShrink;

/* @effect: which one: its names, units and side are taken from here
 * @camera: (nullable): name of the camera it is of, interned; %NULL: of no camera, or
 *   of all alike
 * @probability: that it acts, whatever else does: posterior over all subsets, 0 to 1
 * @log_bayes_factor: what these data say for it, whatever it was thought before: log of
 *   its posterior odds over its prior odds
 * @values: its fitted parameters, in the order of @effect; NaN: not fitted
 * @sigmas: their standard deviations
 * @p_value: of its score test
 * @constancy_p_value: that it is the same all the time and everywhere; NaN: not tested
 * @shrink: by how much the held-out gap shrinks when all accepted effects are added, of variance
 * @group: index into `groups`, or -1 when nothing is confused with it
 * @accepted: whether it is part of the model that `gap_after` is measured with
 *
 * What was found of one effect.
 */
typedef struct {
  const ClothEffect *effect;
  const gchar *camera;
  gdouble probability;
  gdouble log_bayes_factor;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble sigmas[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble p_value;
  gdouble constancy_p_value;
  ClothGapEstimate shrink;
  gint group;
  gboolean accepted;
} ClothGapEffect;

/* @CLOTH_GAP_RIVAL_NONE: effects of the library are all that acts
 * @CLOTH_GAP_RIVAL_FORCE_FIELD: a force acts that no effect of the library makes
 * @CLOTH_GAP_RIVAL_DISPLACEMENT_FIELD: places were measured wrong in a way that no effect
 *   of the library makes
 *
 * What no effect of the library says, and yet may be the cause.
 */
typedef enum {
  CLOTH_GAP_RIVAL_NONE,
  CLOTH_GAP_RIVAL_FORCE_FIELD,
  CLOTH_GAP_RIVAL_DISPLACEMENT_FIELD
} ClothGapRival;

/* @effects: (element-type ClothEffect) (transfer none): effects that act together; none:
 *   nothing of the library acts
 * @rival: what acts besides them
 * @probability: that these act and nothing else
 *
 * One explanation.
 */
typedef struct {
  GPtrArray *effects;
  ClothGapRival rival;
  gdouble probability;
} ClothGapSet;

/* @none_acts: that nothing acts that the model lacks
 * @force_field: that an unknown force acts, alone or beside effects
 * @displacement_field: that places were measured wrong in an unknown way, alone or beside
 *   effects
 *
 * Posterior probabilities of what is no effect of the library; NaN: not known.
 */
typedef struct {
  gdouble none_acts;
  gdouble force_field;
  gdouble displacement_field;
} ClothGapRivals;

/* @effect: an effect
 * @parameter: which of its parameters
 * @value: how far it must be from the parameter's null to have shown with a probability
 *   of 95%, in its unit; NaN: no value that makes sense would have
 *
 * How much of an effect may be there unseen.
 */
typedef struct {
  const ClothEffect *effect;
  guint parameter;
  gdouble value;
} ClothGapLimit;

/* @name: of a free number of the model, as cloth_model_get () names it
 * @unit: its unit
 * @value: as it was fitted
 * @sigma: standard deviation of that
 * @low: least value that it was allowed
 * @high: greatest value that it was allowed
 * @at_end: whether the fit ended at one of them: the range or the model is wrong
 */
typedef struct {
  gchar *name;
  gchar *unit;
  gdouble value;
  gdouble sigma;
  gdouble low;
  gdouble high;
  gboolean at_end;
} ClothGapFreeNumber;

/* @name: what is changed, as whom the patch is for calls it: a key of model.json, a
 *   setting of the user's simulator
 * @text: the change in plain words: "areal density × 0.61"
 * @before: its value; NaN: it was not there
 * @after: its value to set; NaN: the simulator can't express it, and @text says what to
 *   add instead
 * @unit: of both
 * @factor: @after ÷ @before; NaN: there is none, as from 0
 *
 * One change that takes the gap away.
 */
typedef struct {
  gchar *name;
  gchar *text;
  gdouble before;
  gdouble after;
  gchar *unit;
  gdouble factor;
} ClothGapPatch;

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
 * @CLOTH_GAP_SIMULATED: what the user's simulator made of one of them
 * @CLOTH_GAP_SIMULATED_AFTER: the same once the accepted effects were added there
 * @CLOTH_GAP_MODEL: the model's file
 */
typedef enum {
  CLOTH_GAP_TAKE,
  CLOTH_GAP_BASELINE,
  CLOTH_GAP_HOLD_OUT,
  CLOTH_GAP_SIMULATED,
  CLOTH_GAP_SIMULATED_AFTER,
  CLOTH_GAP_MODEL
} ClothGapRole;

/* @role: take, baseline or hold-out
 * @name: its name
 * @gap_before: recorded minus simulated over windows of 0.3 s, RMS in metres
 * @gap_after: the same with the accepted effects
 * @noise_floor: what it would be if the simulation lacked nothing
 * @shrink: (V_before − V_after) ÷ (V_before − V_floor), V = squared gap
 * @free_before: recorded minus simulated from the start, not restarted, RMS in metres
 * @free_after: the same with the accepted effects
 * @free_floor: what it would be if the simulation lacked nothing
 *
 * What was measured on one take.
 */
typedef struct {
  ClothGapRole role;
  gchar *name;
  ClothGapEstimate gap_before;
  ClothGapEstimate gap_after;
  ClothGapEstimate noise_floor;
  ClothGapEstimate shrink;
  ClothGapEstimate free_before;
  ClothGapEstimate free_after;
  ClothGapEstimate free_floor;
} ClothGapMeasuredTake;

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

/* @CLOTH_GAP_ORIGIN_SIMULATED: a quantile of what was simulated for this take
 * @CLOTH_GAP_ORIGIN_PARAMETER: chosen, and the user may choose otherwise
 * @CLOTH_GAP_ORIGIN_PAPER: from the literature
 * @CLOTH_GAP_ORIGIN_DEFINITION: what the words mean
 *
 * Where a threshold comes from.
 */
typedef enum {
  CLOTH_GAP_ORIGIN_SIMULATED,
  CLOTH_GAP_ORIGIN_PARAMETER,
  CLOTH_GAP_ORIGIN_PAPER,
  CLOTH_GAP_ORIGIN_DEFINITION
} ClothGapOrigin;

/* @name: which one
 * @value: its value
 * @unit: in the notation of the SI, "1" for a ratio
 * @origin: where it comes from
 * @reason: why it is so, a sentence
 */
typedef struct {
  gchar *name;
  gdouble value;
  gchar *unit;
  ClothGapOrigin origin;
  gchar *reason;
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
 * @free_run: whether the simulations run from the start, else they start anew with each
 *   window of 0.3 s
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
  gboolean free_run;
} ClothGapPlayback;

/* @verdict: the outcome
 * @reason: (nullable): why it is undecidable, and what would help, or which sign there
 *   is of something unknown: a sentence
 * @notes: (element-type utf8): what else one should know of it, sentences
 * @gap_before: recorded minus simulated on held-out data, RMS in metres
 * @gap_after: the same with the accepted effects, of the user's simulator where it was run with
 *   them; NaN without any
 * @noise_floor: what it would be if the simulation lacked nothing
 * @shrink: (V_before − V_after) ÷ (V_before − V_floor), V = squared gap
 * @rest_p_value: that what remains is no more than the noise floor
 * @held_out_takes: whether "held-out" means takes of their own, else blocks of time
 * @takes: (element-type ClothGapMeasuredTake): what was measured on each take
 * @takes_agree_p_value: that all takes are explained by the same numbers; NaN: one take
 * @has_simulated: whether a twin was given: the gap is to what the user's simulator made
 * @predicted_shrink: what the accepted effects would take off the twin's gap: twin + (ours
 *   with them − ours without)
 * @measured_shrink: what they took off in the user's simulator
 * @effects: (element-type ClothGapEffect): the tested effects, the likeliest first
 * @sets: (element-type ClothGapSet): explanations, the likeliest first, up to 95% of the
 *   posterior
 * @rivals: how likely it is that no effect of the library is all of it
 * @groups: (element-type ClothGapGroup): what can't be told apart
 * @untested: (element-type ClothGapUntested): what could not be tested
 * @detection_limits: (element-type ClothGapLimit): what would have shown
 * @patch: (element-type ClothGapPatch): what to change
 * @patch_simulator: (nullable): the user's simulator that @patch is for; %NULL: model.json
 * @free_numbers: (element-type ClothGapFreeNumber): the model's fitted numbers
 * @free_correlation: (nullable): their correlations, [n][n] row by row
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
 * @rig: (nullable): where cameras had faults, the rig as the cloth has it
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
  GArray *takes;
  gdouble takes_agree_p_value;
  gboolean has_simulated;
  ClothGapShrink predicted_shrink;
  ClothGapShrink measured_shrink;
  GArray *effects;
  GArray *sets;
  ClothGapRivals rivals;
  GArray *groups;
  GArray *untested;
  GArray *detection_limits;
  GArray *patch;
  gchar *patch_simulator;
  GArray *free_numbers;
  gdouble *free_correlation;
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
  ClothRig *rig;
} ClothGapResult;

ClothGapResult *cloth_gap_result_new (void);
void cloth_gap_result_add_note (ClothGapResult * result, const gchar * note);
ClothGapMeasuredTake *cloth_gap_result_add_take (ClothGapResult * result,
    ClothGapRole role, const gchar * name);
ClothGapEffect *cloth_gap_result_add_effect (ClothGapResult * result,
    const ClothEffect * effect);
ClothGapSet *cloth_gap_result_add_set (ClothGapResult * result,
    ClothGapRival rival, gdouble probability);
void cloth_gap_result_add_group (ClothGapResult * result,
    const gchar * experiment, gdouble log_bayes_factor);
void cloth_gap_result_add_untested (ClothGapResult * result,
    const ClothEffect * effect, const gchar * reason);
void cloth_gap_result_add_limit (ClothGapResult * result,
    const ClothEffect * effect, guint parameter, gdouble value);
void cloth_gap_result_add_patch (ClothGapResult * result, const gchar * name,
    const gchar * text, gdouble before, gdouble after, const gchar * unit);
ClothGapFreeNumber *cloth_gap_result_add_free_number (ClothGapResult * result,
    const gchar * name, const gchar * unit);
void cloth_gap_result_add_stage (ClothGapResult * result, const gchar * name,
    gdouble share, const gchar * reason);
void cloth_gap_result_add_version (ClothGapResult * result,
    const gchar * name, const gchar * version);
void cloth_gap_result_add_input (ClothGapResult * result, ClothGapRole role,
    const gchar * name, const gchar * sha256);
void cloth_gap_result_add_threshold (ClothGapResult * result,
    const gchar * name, gdouble value, const gchar * unit,
    ClothGapOrigin origin, const gchar * reason);
void cloth_gap_result_add_failure (ClothGapResult * result,
    const gchar * run, const gchar * what);
const gchar *cloth_gap_verdict_name (ClothGapVerdict verdict);
void cloth_gap_result_free (ClothGapResult * result);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapResult, cloth_gap_result_free)
G_END_DECLS
