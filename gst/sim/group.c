/* Models into groups of lanes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/group.h"

#include <stdlib.h>

#include "gst/effect/effect.h"

/* Every variant of the lanes; those of other machines are not built. */
extern const ClothLaneBackend cloth_lane_backend_one;
extern const ClothLaneBackend cloth_lane_backend_single_generic;
extern const ClothLaneBackend cloth_lane_backend_double_generic;
#if CLOTH_SIM_X86
extern const ClothLaneBackend cloth_lane_backend_single_avx2;
extern const ClothLaneBackend cloth_lane_backend_double_avx2;
extern const ClothLaneBackend cloth_lane_backend_single_avx512;
extern const ClothLaneBackend cloth_lane_backend_single_avx512_narrow;
extern const ClothLaneBackend cloth_lane_backend_double_avx512;
#endif

/* What a step of half as many lanes costs: vectors half as wide, but not twice as fast. */
#define NARROW_COSTS 0.66

/* A model and which effects it has, as bits: those that cost most are the highest. */
typedef struct
{
  guint64 effects;
  guint model;
} Place;

static const ClothLaneBackend *
wide_backend (const ClothSimOptions * options)
{
#if CLOTH_SIM_X86
  switch (cloth_simd_resolve (options->simd)) {
    case CLOTH_SIMD_AVX512:
      return options->single ? &cloth_lane_backend_single_avx512 :
          &cloth_lane_backend_double_avx512;
    case CLOTH_SIMD_AVX2:
      return options->single ? &cloth_lane_backend_single_avx2 :
          &cloth_lane_backend_double_avx2;
    default:
      break;
  }
#endif
  return options->single ? &cloth_lane_backend_single_generic :
      &cloth_lane_backend_double_generic;
}

/* The effects that cost time. */
static guint64
list_effects (const ClothModel * model, const ClothLaneBackend * backend)
{
  guint n;
  const ClothEffect *const *table = cloth_effect_table (&n);
  guint64 effects = 0;

  for (guint i = 0; i < model->effects->len; i++) {
    const ClothEffect *effect =
        g_array_index (model->effects, ClothModelEffect, i).effect;
    ClothLaneCost cost = backend->cost (effect);

    for (guint k = 0; k < n && cost != CLOTH_LANE_COST_NONE; k++)
      if (table[k] == effect)
        effects |= (guint64) 1 << MIN (k, 31) <<
            (cost == CLOTH_LANE_COST_HIGH ? 32 : 0);
  }
  return effects;
}

static gint
compare_places (gconstpointer a, gconstpointer b)
{
  const Place *p = a, *q = b;

  if (p->effects != q->effects)
    return p->effects < q->effects ? 1 : -1;
  return p->model < q->model ? -1 : 1;
}

/* How many groups the busiest thread steps. */
static guint
count_rounds (guint n_models, guint n_lanes, guint threads)
{
  guint n = (n_models + n_lanes - 1) / n_lanes;

  return (n + threads - 1) / threads;
}

static const ClothLaneBackend *
narrow_backend (const ClothLaneBackend * wide)
{
#if CLOTH_SIM_X86
  if (wide == &cloth_lane_backend_single_avx512)
    return &cloth_lane_backend_single_avx512_narrow;
#endif
  return wide;
}

/* Models with effects of their own are computed in narrow lanes: most of the others in
 * wide ones would not have them. Each kind of them has groups of its own as long as there
 * are models without to fill these up. Returns how many models those groups have, which
 * are then first in @places. */
static guint
fill_up (Place * places, guint n_models, guint n_lanes)
{
  g_autofree Place *sorted = g_memdup2 (places, n_models * sizeof *places);
  guint64 least = places[n_models - 1].effects;
  guint n = 0, filled = 0, n_own = 0, n_slow = 0, fill;

  while (places[n_own].effects != least)
    n_slow += sorted[n_own++].effects >> 32 != least >> 32;
  fill = n_own;
  for (guint i = 0; i < n_own; filled += n_lanes) {
    guint end = i < n_slow && n_slow - i < n_lanes
        && n_lanes - (n_slow - i) <= n_models - fill ? n_slow : n_own;

    while (i < end && n < filled + n_lanes)
      places[n++] = sorted[i++];
    while (fill < n_models && n < filled + n_lanes)
      places[n++] = sorted[fill++];
  }
  return n;
}

/* Narrow lanes also where wide ones would leave threads without work. */
static const ClothLaneBackend *
choose_backend (guint n_models, gboolean others,
    const ClothLaneBackend * wide, guint threads)
{
  const ClothLaneBackend *narrow = narrow_backend (wide);

  if (others)
    return n_models > narrow->n_lanes ? wide : narrow;
  return NARROW_COSTS * count_rounds (n_models, narrow->n_lanes, threads) <
      count_rounds (n_models, wide->n_lanes, threads) ? narrow : wide;
}

/* @body: what is simulated; must outlive the groups
 * @models: (array length=n_models): with which models
 * @n_models: how many, at least 1
 * @options: how
 * @threads: how many threads share the groups
 * @group_of: (out) (array length=n_models): which group each model is in
 * @rank_of: (out) (array length=n_models): where it is among all models as the groups
 *   have them
 * @n_groups: (out): how many groups there are
 *
 * Models with the same effects share groups: a group has to compute all effects that any
 * of its models has. How models are grouped is a matter of speed alone.
 *
 * Returns: (transfer full) (array length=n_groups): the groups, those with the most to do
 *   first
 */
ClothSimGroup *
cloth_sim_groups_new (const ClothBody * body, const ClothModel * const *models,
    guint n_models, const ClothSimOptions * options, guint threads,
    guint * group_of, guint * rank_of, guint * n_groups)
{
  g_autofree Place *places = g_new (Place, n_models);
  g_autofree const ClothModel **sorted = g_new (const ClothModel *, n_models);
  const ClothLaneBackend *wide = wide_backend (options);
  ClothSimGroup *groups;
  guint n_own;

  for (guint i = 0; i < n_models; i++)
    places[i] = (Place) {
    list_effects (models[i], wide), i};
  qsort (places, n_models, sizeof *places, compare_places);
  n_own = fill_up (places, n_models, narrow_backend (wide)->n_lanes);
  groups = g_new0 (ClothSimGroup,
      n_models / narrow_backend (wide)->n_lanes + 1);
  *n_groups = 0;
  for (guint first = 0; first < n_models;) {
    ClothSimGroup *group = &groups[*n_groups];
    const ClothLaneBackend *backend = first < n_own ? narrow_backend (wide) :
        choose_backend (n_models - first, n_own > 0, wide, threads);

    group->first = first;
    group->n = MIN (n_models - first, backend->n_lanes);
    for (guint i = first; i < first + group->n; i++) {
      sorted[i] = models[places[i].model];
      group_of[places[i].model] = *n_groups;
      rank_of[places[i].model] = i;
    }
    /* same bits, less work */
    group->backend = group->n == 1 && !options->single ?
        &cloth_lane_backend_one : backend;
    group->lanes = group->backend->group_new (body, sorted + first, group->n,
        options->seed);
    first += group->n;
    (*n_groups)++;
  }
  return groups;
}

/* @groups: (nullable) (transfer full) (array length=n_groups): groups
 * @n_groups: how many
 */
void
cloth_sim_groups_free (ClothSimGroup * groups, guint n_groups)
{
  for (guint i = 0; i < n_groups; i++)
    groups[i].backend->group_free (groups[i].lanes);
  g_free (groups);
}
