/* What a model might lack, as directions in which to change it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"
#include "gst/sim/model.h"

G_BEGIN_DECLS

/* @name: of the model's number, as cloth_model_set () takes it; of an effect that is @present, of
 *   the effect alone
 * @present: the effect is there at 1 and not at 0; nothing lies between
 * @shapes: it shapes an effect, and changes nothing where the effect is at its null
 * @logarithmic: the logarithm of the number is changed
 * @centre: where it starts: the null value, or the model's
 * @step: of the finite difference
 * @prior: standard deviation of its prior
 * @one_sided: it can only grow
 * @low: least value
 * @high: largest value
 * @fit_low: least value that a fit may come to
 * @fit_high: largest value that a fit may come to
 */
typedef struct {
  gchar *name;
  gboolean present;
  gboolean shapes;
  gboolean logarithmic;
  gdouble centre;
  gdouble step;
  gdouble prior;
  gboolean one_sided;
  gdouble low;
  gdouble high;
  gdouble fit_low;
  gdouble fit_high;
} ClothDirection;

/* @effect: the effect
 * @values: its parameters where the directions leave them; with a direction that is present,
 *   where the effect is there
 * @first: of its directions
 * @n: number of its directions
 * @parameters: which parameter each of them is
 *
 * One way in which an effect may act: some of its parameters are directions, the others
 * are fixed. An effect may have several candidates. Gusts have none of their own: @n is 0
 * and @first that of wind.
 */
typedef struct {
  const ClothEffect *effect;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
  guint first;
  guint n;
  guint parameters[CLOTH_EFFECT_MAX_PARAMETERS];
} ClothCandidate;

/* @directions: (element-type ClothDirection): the model's free numbers first, then
 *   those of the candidates
 * @n_free: how many of them are free numbers of the model
 * @list: (element-type ClothCandidate): the candidates
 */
typedef struct {
  GArray *directions;
  guint n_free;
  GArray *list;
} ClothCandidates;

/* Whether it is chance that the parameters of another effect change, as with gusts: no
 * single direction stands for it. */
static inline gboolean
cloth_candidate_is_stochastic (const ClothCandidate * candidate)
{
  return candidate->effect->test == CLOTH_EFFECT_TEST_STOCHASTIC;
}

/* The i-th direction. */
static inline const ClothDirection *
cloth_candidates_direction (const ClothCandidates * candidates, guint i)
{
  return &g_array_index (candidates->directions, ClothDirection, i);
}

/* CLOTH_CANDIDATES_FROZEN: the model's free numbers were fitted elsewhere
 * CLOTH_CANDIDATES_MEASUREMENT: what may be wrong with the whole recording is considered too
 * CLOTH_CANDIDATES_TRIALS: so is what is there or not, without derivative, that of numerics too
 */
typedef enum {
  CLOTH_CANDIDATES_DEFAULT = 0,
  CLOTH_CANDIDATES_FROZEN = 1 << 0,
  CLOTH_CANDIDATES_MEASUREMENT = 1 << 1,
  CLOTH_CANDIDATES_TRIALS = 1 << 2,
} ClothCandidatesFlags;

/* @data: the caller's
 * @effect: an effect that is no candidate
 * @reason: why
 */
typedef void (*ClothCandidateSkip) (gpointer data, const ClothEffect * effect,
    const gchar * reason);

ClothCandidates *cloth_candidates_new_empty (void);
ClothCandidates *cloth_candidates_new (const ClothModel * model,
    const ClothRecording * recording, const gchar * const *effects,
    ClothCandidatesFlags flags, ClothCandidateSkip skip, gpointer data,
    GError ** error);
ClothModel *cloth_candidates_move (const ClothCandidates * candidates,
    const ClothModel * model, const guint * directions,
    const gdouble * changes, guint n);
gdouble cloth_candidates_place (const ClothCandidates * candidates,
    const ClothModel * model, guint direction);
void cloth_candidates_bound (ClothCandidates * candidates,
    const ClothModel * model, guint direction, gdouble reach);
gboolean cloth_candidates_has_room (const ClothCandidates *
    candidates, const ClothModel * model, guint direction, gdouble step);
void cloth_candidates_free (ClothCandidates * candidates);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCandidates, cloth_candidates_free)
G_END_DECLS
