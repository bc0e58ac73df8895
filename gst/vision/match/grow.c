/* Seeds in groups of falling scale, and growth from each.
 *
 * D. Pritchard and W. Heidrich (2003), sections 4.2.1 and 4.2.2. What is added: neighbours
 * show the same side, and are turned and scaled alike unless the surface is broken between
 * them, which leaves fewer candidates to compare.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/grow.h"

#include <math.h>
#include <string.h>

#include "gst/vision/match/match-private.h"
#include "gst/vision/match/reference-private.h"

#define BYTES CLOTH_CV_SIFT_BYTES
#define MAX_RADIUS 1000.0

typedef struct
{
  gdouble key;
  guint feature;
} Entry;

typedef struct
{
  guint32 distance, reference;
  guint feature;
} Seed;

typedef struct
{
  guint seed, n;
} Tries;

struct _ClothGrower
{
  /* by bins of the radius */
  GArray *starts, *sorted;
  gint columns, rows;
  gdouble low[2];

  GArray *heap;                 /* Entry */
  GArray *grown;                /* guint: features of the group */
  GArray *order;                /* guint: by falling scale */
  GArray *tries;                /* Tries: of each feature */
  GArray *seeds;                /* Seed: by distance */
  GArray *queries, *found;
};

/* What one run reads and writes. */
typedef struct
{
  ClothGrower *self;
  ClothGrowParams params;
  guint32 most;                 /* squared distance */
  const ClothMatchKernel *kernel;
  const ClothReference *reference;
  const ClothCvFeatures *features;
  const ClothMatchSurface *surface;
  ClothMatch *matches;
} Run;

/* Returns: radius and stretch of the paper; the rest as measured on rendered cloth
 */
ClothGrowParams
cloth_grow_default_params (void)
{
  return (ClothGrowParams) {
  .radius = 20,.distance = 320,.seed_distance = 280,.first = 32,.least_scale =
        2,.least = 4,.tries = 4,.turn = G_PI / 4,.zoom = 2,.stretch =
        cloth_stretch_default_params ()};
}

/* Returns: (transfer full): room to match in, for one thread at a time
 */
ClothGrower *
cloth_grower_new (void)
{
  ClothGrower *self = g_new0 (ClothGrower, 1);

  self->starts = g_array_new (FALSE, FALSE, sizeof (guint));
  self->sorted = g_array_new (FALSE, FALSE, sizeof (guint));
  self->heap = g_array_new (FALSE, FALSE, sizeof (Entry));
  self->grown = g_array_new (FALSE, FALSE, sizeof (guint));
  self->order = g_array_new (FALSE, FALSE, sizeof (guint));
  self->tries = g_array_new (FALSE, FALSE, sizeof (Tries));
  self->seeds = g_array_new (FALSE, FALSE, sizeof (Seed));
  self->queries = g_array_new (FALSE, FALSE, BYTES);
  self->found = g_array_new (FALSE, FALSE, sizeof (ClothNeighbours));
  return self;
}

/* @grower: (nullable) (transfer full): what to free
 */
void
cloth_grower_free (ClothGrower * grower)
{
  if (!grower)
    return;
  g_array_unref (grower->starts);
  g_array_unref (grower->sorted);
  g_array_unref (grower->heap);
  g_array_unref (grower->grown);
  g_array_unref (grower->order);
  g_array_unref (grower->tries);
  g_array_unref (grower->seeds);
  g_array_unref (grower->queries);
  g_array_unref (grower->found);
  g_free (grower);
}

/* ---- the queue ---- */

static gboolean
comes_before (const Entry * a, const Entry * b)
{
  return a->key != b->key ? a->key < b->key : a->feature < b->feature;
}

static void
push (GArray * heap, gdouble key, guint feature)
{
  Entry entry = { key, feature }, *e;
  guint i = heap->len;

  g_array_append_val (heap, entry);
  e = (Entry *) heap->data;
  for (; i && comes_before (&entry, &e[(i - 1) / 2]); i = (i - 1) / 2)
    e[i] = e[(i - 1) / 2];
  e[i] = entry;
}

static guint
pop (GArray * heap)
{
  Entry *e = (Entry *) heap->data;
  const guint feature = e[0].feature, n = heap->len - 1;
  const Entry last = e[n];
  guint i = 0;

  for (guint child; (child = 2 * i + 1) < n; i = child) {
    child += child + 1 < n && comes_before (&e[child + 1], &e[child]);
    if (!comes_before (&e[child], &last))
      break;
    e[i] = e[child];
  }
  e[i] = last;
  g_array_set_size (heap, n);
  return feature;
}

/* ---- neighbours in the picture ---- */

static gint
find_bin (const ClothGrower * self, gint axis, gfloat value, gdouble radius)
{
  const gdouble bin = (value - self->low[axis]) / radius;

  return (gint) CLAMP (bin, 0, (axis ? self->rows : self->columns) - 1);
}

static void
sort_into_bins (Run * run)
{
  ClothGrower *self = run->self;
  const ClothCvFeatures *f = run->features;
  const gdouble radius = run->params.radius;
  gdouble high[2] = { -INFINITY, -INFINITY };
  guint *starts, *sorted, n_bins;

  self->low[0] = self->low[1] = INFINITY;
  for (guint i = 0; i < f->n; i++) {
    self->low[0] = MIN (self->low[0], f->x[i]);
    self->low[1] = MIN (self->low[1], f->y[i]);
    high[0] = MAX (high[0], f->x[i]);
    high[1] = MAX (high[1], f->y[i]);
  }
  self->columns = (gint) ((high[0] - self->low[0]) / radius) + 1;
  self->rows = (gint) ((high[1] - self->low[1]) / radius) + 1;
  n_bins = (guint) (self->columns * self->rows);
  g_array_set_size (self->starts, n_bins + 1);
  g_array_set_size (self->sorted, f->n);
  starts = (guint *) self->starts->data;
  sorted = (guint *) self->sorted->data;
  memset (starts, 0, (n_bins + 1) * sizeof *starts);
  for (gint pass = 0; pass < 2; pass++) {
    for (guint i = 0; i < f->n; i++) {
      const gint bin = find_bin (self, 1, f->y[i], radius) * self->columns
          + find_bin (self, 0, f->x[i], radius);

      if (pass == 0)
        starts[bin + 1]++;
      else
        sorted[starts[bin]++] = i;
    }
    if (pass == 0)
      for (guint b = 0; b < n_bins; b++)
        starts[b + 1] += starts[b];
  }
  memmove (starts + 1, starts, n_bins * sizeof *starts);
  starts[0] = 0;
}

/* ---- candidates in the flat picture ---- */

/* By how much the picture is turned against the flat one at a match, as the side shows it. */
static gdouble
find_turn (const Run * run, guint feature, guint32 of)
{
  return run->features->angle[feature] - run->reference->seen[of];
}

/* A pixel of the flat picture, in those of the film. */
static gdouble
find_zoom (const Run * run, guint feature, guint32 of)
{
  return run->features->scale[feature] / run->reference->scale[of];
}

/* The match of @feature next to @source, whose match is known. */
static gboolean
find_match (const Run * run, guint source, guint feature)
{
  const ClothReference *r = run->reference;
  const ClothCvFeatures *f = run->features;
  const guint32 of = run->matches[source].reference;
  const gfloat from[2] = { f->x[source], f->y[source] };
  const gfloat to[2] = { f->x[feature], f->y[feature] };
  const gdouble zoom = find_zoom (run, source, of);
  ClothStretchRange range;
  ClothMatchRing ring = {
    .x = r->x,.y = r->y,.scale = r->scale,.seen = r->seen,.descriptors =
        r->descriptors,.centre = {
        r->x[of], r->y[of]},.high = INFINITY,.turn_range = INFINITY,.query =
        f->descriptors + (gsize) feature * BYTES
  };
  guint32 best = CLOTH_MATCH_NONE, distance = run->most;
  gdouble least, reach;
  gint left, right, top, bottom;

  if (!cloth_stretch_get_range (&run->params.stretch, run->surface, from, to,
          r->metres_per_pixel / zoom, &range))
    return FALSE;
  least = range.least / r->metres_per_pixel;
  reach = range.most / r->metres_per_pixel;
  ring.least = (gfloat) (least * least);
  ring.most = (gfloat) (reach * reach);
  if (!range.broken) {
    if (run->params.zoom >= 1) {
      ring.low = (gfloat) (f->scale[feature] / zoom / run->params.zoom);
      ring.high = (gfloat) (f->scale[feature] / zoom * run->params.zoom);
    }
    ring.turn = (gfloat) (f->angle[feature] - find_turn (run, source, of));
    if (run->params.turn < G_PI)
      ring.turn_range = (gfloat) MAX (run->params.turn, 0);
  }
  left = cloth_reference_bin (r->x[of] - reach, r->columns);
  right = cloth_reference_bin (r->x[of] + reach, r->columns);
  top = cloth_reference_bin (r->y[of] - reach, r->rows);
  bottom = cloth_reference_bin (r->y[of] + reach, r->rows);
  for (gint side = 0; side < 2; side++)
    if (range.broken || side == r->side[of])
      for (gint row = top; row <= bottom; row++) {
        const guint *starts = r->starts + (side * r->rows + row) * r->columns;

        run->kernel->search (&ring, starts[left], starts[right + 1], &best,
            &distance);
      }
  if (best == CLOTH_MATCH_NONE)
    return FALSE;
  run->matches[feature].reference = best;
  run->matches[feature].distance = distance;
  return TRUE;
}

/* ---- growth ---- */

static void
add (Run * run, guint feature, guint seed, guint group)
{
  const ClothCvFeatures *f = run->features;
  const gdouble dx = f->x[feature] - f->x[seed];
  const gdouble dy = f->y[feature] - f->y[seed];

  run->matches[feature].state = CLOTH_MATCH_MATCHED;
  run->matches[feature].group = group;
  push (run->self->heap, dx * dx + dy * dy, feature);
  g_array_append_val (run->self->grown, feature);
}

static void
grow_from (Run * run, guint source, guint seed, guint group)
{
  const ClothGrower *self = run->self;
  const ClothCvFeatures *f = run->features;
  const gdouble radius = run->params.radius;
  const gint column = find_bin (self, 0, f->x[source], radius);
  const gint row = find_bin (self, 1, f->y[source], radius);
  const guint *starts = (const guint *) self->starts->data;
  const guint *sorted = (const guint *) self->sorted->data;
  Tries *tries = (Tries *) self->tries->data;

  for (gint y = MAX (row - 1, 0); y <= MIN (row + 1, self->rows - 1); y++) {
    const gint left = y * self->columns + MAX (column - 1, 0);
    const gint right = y * self->columns + MIN (column + 1, self->columns - 1);

    for (guint k = starts[left]; k < starts[right + 1]; k++) {
      const guint i = sorted[k];
      const gdouble dx = f->x[i] - f->x[source], dy = f->y[i] - f->y[source];

      if (run->matches[i].state != CLOTH_MATCH_UNKNOWN
          || dx * dx + dy * dy > radius * radius)
        continue;
      if (tries[i].seed != seed)
        tries[i] = (Tries) {
        seed, 0};
      if (tries[i].n++ < run->params.tries && find_match (run, source, i))
        add (run, i, seed, group);
    }
  }
}

/* Whether at least as many grow as make a seed; otherwise all is as before. */
static gboolean
grow (Run * run, const Seed * seed, guint group)
{
  GArray *grown = g_array_set_size (run->self->grown, 0);

  run->matches[seed->feature].reference = seed->reference;
  run->matches[seed->feature].distance = seed->distance;
  add (run, seed->feature, seed->feature, group);
  while (run->self->heap->len)
    grow_from (run, pop (run->self->heap), seed->feature, group);
  if (grown->len > run->params.least)
    return TRUE;
  for (guint k = 0; k < grown->len; k++)
    run->matches[g_array_index (grown, guint, k)] = (ClothMatch) {
    CLOTH_MATCH_UNKNOWN, CLOTH_MATCH_NONE, 0, 0};
  run->matches[seed->feature].state = CLOTH_MATCH_UNSEEDED;
  return FALSE;
}

/* ---- seeds ---- */

static gint
compare_scales (gconstpointer pa, gconstpointer pb, gpointer scales)
{
  const guint a = *(const guint *) pa, b = *(const guint *) pb;
  const gfloat *scale = scales;

  if (scale[a] != scale[b])
    return scale[a] > scale[b] ? -1 : 1;
  return a < b ? -1 : a > b;
}

static gint
compare_seeds (gconstpointer pa, gconstpointer pb)
{
  const Seed *a = pa, *b = pb;

  if (a->distance != b->distance)
    return a->distance < b->distance ? -1 : 1;
  return a->feature < b->feature ? -1 : a->feature > b->feature;
}

/* Features that may be seeds, by falling scale. */
static void
sort_by_scale (Run * run)
{
  const ClothCvFeatures *f = run->features;
  GArray *order = g_array_set_size (run->self->order, 0);

  for (guint i = 0; i < f->n; i++)
    if (f->scale[i] >= run->params.least_scale)
      g_array_append_val (order, i);
  g_array_sort_with_data (order, compare_scales, (gpointer) f->scale);
}

/* The next at most @n unknown features from @at on, by their distance in feature space. */
static void
find_seeds (Run * run, guint n, guint * at, ClothPool * pool, ClothSimd level)
{
  ClothGrower *self = run->self;
  const guint *order = (const guint *) self->order->data;
  const guint8 *bytes = run->features->descriptors;
  ClothNeighbours *found;

  g_array_set_size (self->seeds, 0);
  g_array_set_size (self->queries, 0);
  for (; *at < self->order->len && self->seeds->len < n; ++*at) {
    const Seed seed = { 0, CLOTH_MATCH_NONE, order[*at] };

    if (run->matches[seed.feature].state != CLOTH_MATCH_UNKNOWN)
      continue;
    g_array_append_val (self->seeds, seed);
    g_array_append_vals (self->queries, bytes + (gsize) seed.feature * BYTES,
        1);
  }
  g_array_set_size (self->found, self->seeds->len);
  found = (ClothNeighbours *) self->found->data;
  if (self->seeds->len)
    cloth_nearest_run (run->reference->nearest,
        (const guint8 *) self->queries->data, self->seeds->len, found, pool,
        level);
  for (guint k = 0; k < self->seeds->len; k++) {
    Seed *seed = &g_array_index (self->seeds, Seed, k);

    if (found[k].index != CLOTH_NEAREST_NONE)
      seed->reference = run->reference->of_nearest[found[k].index];
    seed->distance = found[k].distance;
  }
  if (self->seeds->len)
    g_array_sort (self->seeds, compare_seeds);
}

static void
note (const Run * run, guint n_settled, ClothGrowth * growth)
{
  if (!growth->seeds_half && 2 * n_settled >= run->features->n)
    growth->seeds_half = growth->n_seeds;
  if (!growth->seeds_most && 5 * (gsize) n_settled
      >= 4 * (gsize) run->features->n)
    growth->seeds_most = growth->n_seeds;
}

/* Tries all seeds of a group, the most alike first. */
static void
grow_seeds (Run * run, guint32 most, guint * n_settled, ClothGrowth * growth)
{
  const GArray *seeds = run->self->seeds;

  for (guint k = 0; k < seeds->len; k++) {
    const Seed *seed = &g_array_index (seeds, Seed, k);
    ClothMatch *match = &run->matches[seed->feature];

    if (match->state != CLOTH_MATCH_UNKNOWN)
      continue;
    growth->n_seeds++;
    if (seed->reference != CLOTH_MATCH_NONE && seed->distance < most
        && grow (run, seed, growth->n_groups)) {
      growth->n_groups++;
      growth->n_matched += run->self->grown->len;
      *n_settled += run->self->grown->len;
    } else {
      match->state = CLOTH_MATCH_UNSEEDED;
      ++*n_settled;
    }
    note (run, *n_settled, growth);
  }
}

/* @grower: room to work in
 * @params: what counts as a match
 * @reference: what is matched with
 * @features: of a picture
 * @surface: (nullable): the cloth's surface in that picture; without it the picture's
 *   distances bound those on the cloth
 * @matches: (out caller-allocates) (array): one a feature
 * @growth: (out): counts
 * @pool: (nullable): threads that share the comparisons of seeds
 * @level: vector instructions that may be used at most
 *
 * The result depends on neither @pool nor @level.
 */
void
cloth_grower_run (ClothGrower * grower, const ClothGrowParams * params,
    const ClothReference * reference, const ClothCvFeatures * features,
    const ClothMatchSurface * surface, ClothMatch * matches,
    ClothGrowth * growth, ClothPool * pool, ClothSimd level)
{
  Run run = { grower, *params, 0, CLOTH_SIMD_TABLE (cloth_match_kernel, level),
    reference, features, surface, matches
  };
  /* fmax () also takes what is no number to the least */
  const gdouble far = fmin (fmax (params->distance, 0), 2000);
  const gdouble seed_far = fmin (fmax (params->seed_distance, 0), 2000);
  guint at = 0, n_settled = 0;

  *growth = (ClothGrowth) {
  .by_scale = surface == NULL};
  for (guint i = 0; i < features->n; i++)
    matches[i] = (ClothMatch) {
    CLOTH_MATCH_UNKNOWN, CLOTH_MATCH_NONE, 0, 0};
  if (!features->n)
    return;
  run.params.radius = fmin (fmax (params->radius, 1), MAX_RADIUS);
  run.params.stretch = cloth_stretch_clamp_params (&params->stretch);
  run.most = (guint32) (far * far);
  g_array_set_size (grower->tries, features->n);
  for (guint i = 0; i < features->n; i++)
    g_array_index (grower->tries, Tries, i).seed = G_MAXUINT;
  sort_into_bins (&run);
  sort_by_scale (&run);
  for (guint n = MAX (params->first, 1); at < grower->order->len;
      n = MIN (2 * n, features->n)) {
    find_seeds (&run, n, &at, pool, level);
    grow_seeds (&run, (guint32) (seed_far * seed_far), &n_settled, growth);
  }
}
