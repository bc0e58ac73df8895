/* Measures the gap of every take and hold-out, without and with the accepted effects.
 *
 * Model: the squared gap V of a recording y is the mean over what was seen of |y − x|². x is
 *   - without a twin: ours, let go from the observer in windows, or once from the start (free run);
 *   - with a twin s: before, in the free run, s itself; after, s + (ours with − ours without), both
 *     from the start of s. In windows (y − ours on y) − (s − ours on s), ours let go from the
 *     observer on each: what ours can't do is in both and cancels;
 *   - with a twin a that the effect was added to: a in place of s.
 * Floor: what V would be if the simulation lacked nothing. With a twin it is V of s plus noise in
 *   place of the recording: noise, and what simulations from starts that differ by it differ by.
 *   Without, of a baseline that moves alike, else what the two force models differ by, with noise.
 * Formulas:
 *   shrink = (V_before − V_after)/(V_before − V_floor)
 *   p-value of the rest = share of pairs of draws in which V_after is no larger than V_floor
 * Intervals are the middle 95% of a bootstrap over windows and tiles of the cloth, with the same
 * draws for all models (Davison and Hinkley 1997). Of several recordings sums are weighted by what
 * was seen.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/measure.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/recording.h"
#include "gst/gap/localise/where.h"
#include "gst/gap/verdict/subset.h"
#include "gst/math/random.h"
#include "gst/math/statistics.h"

/* Of the bootstrap. */
#define N_DRAWS 1000
/* Most models that are compared: without effects, without faults of cameras, with each subset of the
 * accepted effects. */
#define MAX_MODELS (1 + CLOTH_DIAGNOSIS_N_SUBSETS)

/* In windows, and in the free run. */
typedef enum
{
  WINDOWS,
  FREE,
  N_KINDS
} Kind;

/* A mean square, m², NaN when nothing was seen or a free run diverged, and its draws; NULL where
 * there are none. */
typedef struct
{
  gdouble square;
  gdouble *draws;
} Square;

/* What is measured of a recording, or of all that judge. */
typedef struct
{
  Square models[N_KINDS][MAX_MODELS];
  Square floor[N_KINDS];
  Square after[N_KINDS];        /* in the user's simulator */
  gdouble seen;                 /* vertices in frames that count */
} Measured;

/* The work: the recordings that are measured and the models that are compared. */
typedef struct
{
  ClothDiagnosis *d;
  const ClothModel *models[MAX_MODELS];
  guint n;                      /* models */
  Measured *all;                /* of each recording; of baselines nothing */
  Measured *judges;             /* behind them */
  Square baseline[N_KINDS];     /* what a baseline shows of the model; none: NaN */
  ClothWindowedGap **first;     /* of the first take */
} Work;

static void
square_clear (Square * s)
{
  g_free (s->draws);
}

static void
measured_clear (gpointer item)
{
  Measured *m = item;

  for (guint kind = 0; kind < N_KINDS; kind++) {
    for (guint k = 0; k < MAX_MODELS; k++)
      square_clear (&m->models[kind][k]);
    square_clear (&m->floor[kind]);
    square_clear (&m->after[kind]);
  }
}

static void
find_measured (Work * w)
{
  w->all = &g_array_index (w->d->measured, Measured, 0);
  w->judges = w->all + w->d->recordings->len;
}

static void
work_clear (Work * w)
{
  for (guint kind = 0; kind < N_KINDS; kind++)
    square_clear (&w->baseline[kind]);
  cloth_windowed_gaps_free (w->first, w->n);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Work, work_clear);

/* The windows that judge: those that end in a held-out block, or all. */
static gboolean *
list_judging (const ClothDiagnosis * d, guint recording,
    const ClothWindowedGap * gap)
{
  gboolean *windows = g_new0 (gboolean, gap->n_windows);
  gboolean any = FALSE;

  if (recording < d->n_takes) {
    const ClothFeatures *f = cloth_diagnosis_study (d, recording)->features;

    for (guint frame = 1, block = 0; frame < gap->n_frames; frame++) {
      while (block + 1 < f->n_blocks && frame >= f->first[block + 1])
        block++;
      windows[gap->window[frame]] = cloth_diagnosis_is_held_out (d, block);
    }
  }
  for (guint w = 0; w < gap->n_windows; w++)
    any |= windows[w];
  for (guint w = 0; w < gap->n_windows && !any; w++)
    windows[w] = TRUE;
  return windows;
}

/* @n mean squares with draws that belong together. */
static void
find_squares (const ClothDiagnosis * d, Kind kind, guint recording,
    ClothWindowedGap ** gaps, guint n, const gboolean * windows,
    Square * squares)
{
  g_autofree gdouble *draws = g_new0 (gdouble, N_DRAWS * n);

  cloth_windowed_gaps_interval (gaps, n, windows, d->options->seed + recording,
      N_DRAWS, draws);
  for (guint k = 0; k < n; k++) {
    /* in its window a simulation that diverges stands where it was last sound */
    squares[k].square = gaps[k]->sound || kind == WINDOWS ?
        cloth_windowed_gap_square (gaps[k], windows) : NAN;
    squares[k].draws = g_new (gdouble, N_DRAWS);
    for (guint i = 0; i < N_DRAWS; i++)
      squares[k].draws[i] = draws[i * n + k];
  }
}

/* A free run begins as @r does, or, if that has noise, where an observer has come in a window. */
static ClothWindowedGap **
simulate (ClothDiagnosis * d, Kind kind, const ClothRecording * r,
    gboolean noisy, const ClothModel * const *models, guint n, GError ** error)
{
  ClothWindowedGap **gaps;

  if (kind == WINDOWS)
    return cloth_diagnosis_measure_windows (d, r, models, n, error);
  d->study.simulations += n;
  gaps = cloth_windowed_gaps_new_free (r, models, n,
      CLOTH_DIAGNOSIS_WINDOW_GAIN, noisy ? CLOTH_DIAGNOSIS_WINDOW_S : 0.,
      CLOTH_DIAGNOSIS_WINDOW_S, &d->study.rollout, error);
  /* a model that says what was wrong with the recording is held against it without that */
  for (guint k = 0; gaps && k < n; k++) {
    g_autoptr (ClothRecording) corrected =
        cloth_diagnosis_correct (r, models[k]);
    ClothWindowedGap **one = !corrected ? NULL :
        cloth_windowed_gaps_new_free (corrected, models + k, 1,
        CLOTH_DIAGNOSIS_WINDOW_GAIN, noisy ? CLOTH_DIAGNOSIS_WINDOW_S : 0.,
        CLOTH_DIAGNOSIS_WINDOW_S, &d->study.rollout, error);

    if (corrected && !one) {
      cloth_windowed_gaps_free (gaps, n);
      return NULL;
    }
    if (corrected) {
      cloth_windowed_gap_free (gaps[k]);
      gaps[k] = one[0];
      g_free (one);
    }
  }
  return gaps;
}

/* What a simulator wrote has noise only if its take says so. */
static gboolean
has_noise (const ClothRecording * r, const ClothRecording * twin)
{
  return twin->sigma > r->sigma;
}

/* Distances of models from a recording: with a twin those of the twin with what each model has
 * more than ours on the twin, @own. */
static ClothWindowedGap **
compare (ClothDiagnosis * d, Kind kind, const ClothRecording * r,
    const ClothRecording * twin, ClothWindowedGap * own,
    const ClothModel * const *models, guint n, GError ** error)
{
  /* with a twin free runs begin as it does */
  ClothWindowedGap **gaps = simulate (d, kind, twin && kind == FREE ? twin : r,
      !twin || has_noise (r, twin), models, n, error);

  /* in a free run the first one is ours on the twin: the last to be replaced */
  for (guint k = n; gaps && twin && k-- > 0;) {
    g_autoptr (ClothRecording) corrected =
        cloth_diagnosis_correct (r, models[k]);

    cloth_windowed_gap_replace (gaps[k], corrected ? corrected : r,
        kind == FREE ? gaps[0] : own, twin);
  }
  return gaps;
}

/* Puts the positions that the cameras gave with their faults into a recording, or takes
 * them out again. */
static void
swap_uncorrected (ClothDiagnosis * d, guint i)
{
  ClothRecording *r = cloth_diagnosis_recording (d, i);
  gdouble *y = r->y;

  r->y = d->uncorrected[i];
  d->uncorrected[i] = y;
  cloth_recording_interpolate (r);
  cloth_recording_differentiate (r);
}

/* The models' distances from a recording: the first one's from what the cameras gave, and
 * where they had faults once more and all others' from what they would have given. */
static ClothWindowedGap **
measure_models (const Work * w, Kind kind, guint i, ClothWindowedGap * own,
    GError ** error)
{
  ClothDiagnosis *d = w->d;
  const ClothRecording *r = cloth_diagnosis_recording (d, i);
  const ClothRecording *twin = cloth_diagnosis_twin (d, i);
  ClothWindowedGap **all = NULL, **others;

  if (!d->uncorrected[i])
    return compare (d, kind, r, twin, own, w->models, w->n, error);
  swap_uncorrected (d, i);
  all = compare (d, kind, r, twin, own, w->models, 1, error);
  swap_uncorrected (d, i);
  if (!all)
    return NULL;
  others = compare (d, kind, r, twin, own, w->models + 1, w->n - 1, error);
  if (!others) {
    cloth_windowed_gaps_free (all, 1);
    return NULL;
  }
  all = g_renew (ClothWindowedGap *, all, w->n);
  memcpy (all + 1, others, (w->n - 1) * sizeof *all);
  g_free (others);
  return all;
}

/* Keeps the gap of a simulation that lacks nothing. */
static void
keep_null (ClothDiagnosis * d, ClothWindowedGap * null, guint recording)
{
  d->nulls[d->n_nulls] = null;
  d->null_recordings[d->n_nulls++] = recording;
}

/* Positions with noise as they would be recorded; scene, name and times are those of @like, and so is
 * what was seen. */
static ClothRecording
record (const ClothDiagnosis * d, const ClothRecording * like,
    const gdouble * y, gdouble sigma)
{
  ClothRecording r = *like;
  const gsize all = (gsize) r.n * r.n_frames;
  ClothRandom random;

  cloth_random_init (&random, d->options->seed);
  r.y = g_new (gdouble, 3 * all);
  r.velocity = g_new (gdouble, 3 * all);
  memcpy (r.y, y, 3 * all * sizeof *y);
  for (gsize i = 0; i < all; i++)
    cloth_recording_add_noise (like, i, sigma / like->sigma, &random,
        r.y + 3 * i);
  cloth_recording_interpolate (&r);
  cloth_recording_differentiate (&r);
  return r;
}

static void
erase (ClothRecording * r)
{
  g_free (r->y);
  g_free (r->velocity);
}

/* The floor with a twin: of the twin as it would be recorded. */
static gboolean
measure_twin_floor (const Work * w, Kind kind, guint i,
    const gboolean * windows, GError ** error)
{
  ClothDiagnosis *d = w->d;
  const ClothModel *models[1] = { d->model };
  const ClothRecording *twin = cloth_diagnosis_twin (d, i);
  ClothRecording noisy = record (d, twin, twin->y, twin->sigma);
  ClothWindowedGap **own = simulate (d, kind, twin, TRUE, models, 1, error);
  ClothWindowedGap **floor = own ? compare (d, kind, &noisy, NULL, NULL, models,
      1, error) : NULL;

  if (floor) {
    cloth_windowed_gap_replace (floor[0], &noisy, own[0], twin);
    find_squares (d, kind, i, floor, 1, windows, &w->all[i].floor[kind]);
    if (i == 0 && kind == WINDOWS && floor[0]->sound) {
      d->floor = g_steal_pointer (&floor[0]->energy);
      keep_null (d, g_steal_pointer (&floor[0]), i);
      d->null_alike = TRUE;
    }
  }
  cloth_windowed_gaps_free (own, 1);
  cloth_windowed_gaps_free (floor, 1);
  erase (&noisy);
  return floor != NULL;
}

/* The first recording that judges. */
static guint
first_judge (const ClothDiagnosis * d)
{
  return d->options->n_hold_outs ? d->n_takes + d->options->n_baselines : 0;
}

/* Whether a recording judges, whether it is a baseline: nothing is measured on these. */
static gboolean
is_judge (const ClothDiagnosis * d, guint recording)
{
  return recording >= first_judge (d) && (d->options->n_hold_outs
      || recording < d->n_takes);
}

static gboolean
is_baseline (const ClothDiagnosis * d, guint recording)
{
  return recording >= d->n_takes
      && recording < d->n_takes + d->options->n_baselines;
}

/* What the two force models differ by, and the noise; of one that diverges nobody knows. */
static gboolean
measure_other_model (const Work * w, Kind kind, guint i,
    const ClothWindowedGap * gap, Square * floor, GError ** error)
{
  ClothDiagnosis *d = w->d;
  const ClothRecording *r = cloth_diagnosis_recording (d, i);
  g_autoptr (ClothModel) other = cloth_diagnosis_other_model (d->model);
  const ClothModel *models[1] = { other };
  ClothWindowedGap **gaps = simulate (d, kind, r, TRUE, models, 1, error);
  gdouble sum = 0.;
  gsize all = (gsize) r->n * r->n_frames, seen = 0;

  if (!gaps)
    return FALSE;
  for (gsize k = 0; k < 3 * all; k++) {
    gdouble off = gaps[0]->positions[k] - gap->positions[k];

    if (isnan (gap->squares[k / 3]))
      continue;
    sum += off * off;
    seen += k % 3 == 0;
  }
  if (gaps[0]->sound)
    floor->square = cloth_recording_noise_square (r) + sum / MAX (seen, 1);
  if (gaps[0]->sound && kind == WINDOWS && i == first_judge (d)) {
    cloth_windowed_gap_subtract (gaps[0], gap, r);
    keep_null (d, g_steal_pointer (&gaps[0]), i);
  }
  cloth_windowed_gaps_free (gaps, 1);
  return TRUE;
}

/* The floor without a twin: what a baseline shows, and on takes that move otherwise what the two
 * force models differ by there, if that is more. */
static gboolean
measure_floor (const Work * w, Kind kind, guint i,
    const ClothWindowedGap * gap, GError ** error)
{
  ClothDiagnosis *d = w->d;
  const Square *baseline = &w->baseline[kind];
  Square *floor = &w->all[i].floor[kind];
  const guint own = d->n_nulls;
  Square other = { NAN };

  if (!d->options->n_baselines || !d->is_alike)
    if (!measure_other_model (w, kind, i, gap, &other, error))
      return FALSE;
  if (!(other.square <= baseline->square) && !isnan (other.square)) {
    *floor = other;
    if (kind == WINDOWS && i == first_judge (d))
      d->floor_null = own;
    return TRUE;
  }
  floor->square = baseline->square;
  floor->draws = g_memdup2 (baseline->draws, N_DRAWS * sizeof (gdouble));
  return TRUE;
}

/* What a baseline shows of the model: that of the first take's motion, if there is one. */
static gboolean
measure_baseline (Work * w, Kind kind, GError ** error)
{
  ClothDiagnosis *d = w->d;
  const ClothModel *models[1] = { d->model };
  const ClothSensitivities *discrepancy =
      cloth_diagnosis_study (d, 0)->discrepancy;
  guint baseline = d->n_takes;
  ClothWindowedGap **gaps;

  for (guint i = d->n_takes; discrepancy && i < d->studies->len; i++)
    if (cloth_diagnosis_study (d, i) == discrepancy)
      baseline = i;
  gaps =
      simulate (d, kind, cloth_diagnosis_recording (d, baseline), TRUE, models,
      1, error);
  if (!gaps)
    return FALSE;
  find_squares (d, kind, 0, gaps, 1, NULL, &w->baseline[kind]);
  if (gaps[0]->sound && kind == WINDOWS) {
    d->floor = g_steal_pointer (&gaps[0]->energy);
    keep_null (d, g_steal_pointer (&gaps[0]), baseline);
    d->null_alike = discrepancy != NULL;
  }
  cloth_windowed_gaps_free (gaps, 1);
  return TRUE;
}

/* All that is measured of a recording in windows, or in the free run. */
static gboolean
measure_kind (Work * w, Kind kind, guint i, GError ** error)
{
  ClothDiagnosis *d = w->d;
  const ClothModel *models[1] = { d->model };
  const ClothRecording *twin = cloth_diagnosis_twin (d, i);
  ClothWindowedGap **own = NULL, **gaps;
  g_autofree gboolean *windows = NULL;
  gboolean done;

  if (twin && !(own = simulate (d, kind, twin,
              has_noise (cloth_diagnosis_recording (d, i), twin), models, 1,
              error)))
    return FALSE;
  gaps = measure_models (w, kind, i, own ? own[0] : NULL, error);
  if (!gaps) {
    cloth_windowed_gaps_free (own, 1);
    return FALSE;
  }
  cloth_windowed_gaps_align (gaps, w->n);
  if (kind == WINDOWS)
    windows = list_judging (d, i, gaps[0]);
  find_squares (d, kind, i, gaps, w->n, windows, w->all[i].models[kind]);
  for (gsize k = gaps[0]->n; k < (gsize) gaps[0]->n * gaps[0]->n_frames; k++)
    w->all[i].seen += kind == WINDOWS && !isnan (gaps[0]->squares[k])
        && windows[gaps[0]->window[k / gaps[0]->n]];
  done = twin ? measure_twin_floor (w, kind, i, windows, error) :
      measure_floor (w, kind, i, gaps[0], error);
  cloth_windowed_gaps_free (own, 1);
  if (i == 0 && kind == WINDOWS)
    w->first = gaps;
  else
    cloth_windowed_gaps_free (gaps, w->n);
  return done;
}

static gdouble
draw_of (const Square * s, guint i)
{
  return s->draws ? s->draws[i] : s->square;
}

/* The mean of all that judge. */
static void
add_judge (Square * sum, const Square * one, gdouble share)
{
  if (!sum->draws)
    sum->draws = g_new0 (gdouble, N_DRAWS);
  sum->square += share * one->square;
  for (guint i = 0; i < N_DRAWS; i++)
    sum->draws[i] += share * draw_of (one, i);
}

/* Where nothing judges there is no mean. */
static void
forget_judges (Work * w, Kind kind)
{
  for (guint k = 0; k < w->n; k++)
    w->judges->models[kind][k].square = NAN;
  w->judges->floor[kind].square = w->judges->after[kind].square = NAN;
}

static void
sum_judges (Work * w, Kind kind)
{
  ClothDiagnosis *d = w->d;
  gdouble seen = 0.;

  for (guint i = 0; i < d->recordings->len; i++)
    seen += is_judge (d, i) ? w->all[i].seen : 0.;
  if (!(seen > 0.))
    forget_judges (w, kind);
  for (guint i = 0; i < d->recordings->len; i++) {
    const Measured *one = &w->all[i];

    if (!is_judge (d, i) || !(one->seen > 0.))
      continue;
    for (guint k = 0; k < w->n; k++)
      add_judge (&w->judges->models[kind][k], &one->models[kind][k],
          one->seen / seen);
    add_judge (&w->judges->floor[kind], &one->floor[kind], one->seen / seen);
  }
  w->judges->seen = seen;
}

/* The middle 95% of draws. */
static ClothGapEstimate
find_interval (gdouble value, const gdouble * draws)
{
  ClothGapEstimate e = { value };
  g_autoptr (GArray) sorted = g_array_new (FALSE, FALSE, sizeof (gdouble));

  g_array_append_vals (sorted, draws, N_DRAWS);
  g_array_sort (sorted, cloth_compare_doubles);
  e.low = g_array_index (sorted, gdouble, N_DRAWS / 40);
  e.high = g_array_index (sorted, gdouble, N_DRAWS - 1 - N_DRAWS / 40);
  return e;
}

/* A length from its square. One that was not drawn has no interval. */
static ClothGapEstimate
estimate (const Square * s)
{
  ClothGapEstimate e = { sqrt (s->square), NAN, NAN };

  if (isnan (s->square) || !s->draws)
    return e;
  e = find_interval (e.value, s->draws);
  if (e.low == e.high)
    e.low = e.high = NAN;
  e.low = sqrt (MAX (0., e.low));
  e.high = sqrt (MAX (0., e.high));
  return e;
}

/* Of what is above the floor, the share that went. Of draws that are all floor no share can be
 * given: they count as if they were as little above it as one that can. */
static ClothGapEstimate
find_shrink (const Square * before, const Square * after, const Square * floor)
{
  const gdouble above = before->square - floor->square;
  g_autofree gdouble *shrinks = g_new (gdouble, N_DRAWS);

  if (!(above > CLOTH_GAP_LEAST_ABOVE_SHARE * before->square)
      || isnan (after->square))
    return (ClothGapEstimate) {
    NAN, NAN, NAN};
  for (guint i = 0; i < N_DRAWS; i++) {
    gdouble b = draw_of (before, i), a = draw_of (after, i);

    shrinks[i] = (b - a) / MAX (b - floor->square,
        CLOTH_GAP_LEAST_ABOVE_SHARE * before->square);
  }
  return find_interval ((before->square - after->square) / above, shrinks);
}

/* How often a rest is no more than the floor, each drawn anew. The observed ones count as one draw
 * more (Davison and Hinkley 1997, 4.2). NaN when either is not known. */
static gdouble
find_rest_p_value (const Square * rest, const Square * floor)
{
  guint count = 0;

  if (isnan (rest->square) || isnan (floor->square))
    return NAN;
  for (guint i = 0; i < N_DRAWS; i++)
    for (guint j = 0; j < N_DRAWS; j++)
      count += draw_of (rest, i) <= draw_of (floor, j);
  return (1. + count) / (1. + (gdouble) N_DRAWS * N_DRAWS);
}

static void
fill_takes (const Work * w, guint best)
{
  ClothDiagnosis *d = w->d;

  for (guint i = 0; i < d->recordings->len; i++) {
    const Measured *m = &w->all[i];
    ClothGapMeasuredTake *take;

    if (is_baseline (d, i))
      continue;
    take = cloth_gap_result_add_take (d->result,
        i < d->n_takes ? CLOTH_GAP_TAKE : CLOTH_GAP_HOLD_OUT,
        cloth_diagnosis_recording (d, i)->name);
    take->gap_before = estimate (&m->models[WINDOWS][0]);
    take->noise_floor = estimate (&m->floor[WINDOWS]);
    take->free_before = estimate (&m->models[FREE][0]);
    take->free_floor = estimate (&m->floor[FREE]);
    if (!best)
      continue;
    take->gap_after = estimate (&m->models[WINDOWS][best]);
    take->free_after = estimate (&m->models[FREE][best]);
    take->shrink = find_shrink (&m->models[WINDOWS][0],
        &m->models[WINDOWS][best], &m->floor[WINDOWS]);
  }
}

static ClothGapShrink
find_shrinks (const Measured * m, const Square * windows, const Square * free)
{
  return (ClothGapShrink) {
  find_shrink (&m->models[WINDOWS][0], windows, &m->floor[WINDOWS]),
        find_shrink (&m->models[FREE][0], free, &m->floor[FREE])};
}

static void
fill_result (Work * w, guint faults, guint best)
{
  ClothDiagnosis *d = w->d;
  ClothGapResult *result = d->result;
  const Measured *m = w->judges;
  const Square *v = m->models[WINDOWS];

  result->held_out_takes = d->options->n_hold_outs > 0;
  result->gap_before = estimate (&v[0]);
  result->noise_floor = estimate (&m->floor[WINDOWS]);
  if (best) {
    result->gap_after = estimate (&v[best]);
    result->shrink = find_shrink (&v[0], &v[best], &m->floor[WINDOWS]);
  }
  if (best && d->twins->len)
    result->predicted_shrink =
        find_shrinks (m, &v[best], &m->models[FREE][best]);
  result->rest_p_value = find_rest_p_value (&v[best], &m->floor[WINDOWS]);
  if (faults)
    d->shrink_of_faults = find_shrink (&v[0], &v[1], &m->floor[WINDOWS]).value;
  fill_takes (w, best);
}

/* Where the gap of the first take lies, and what is needed to say more of it. */
static void
keep_first (ClothDiagnosis * d, ClothWindowedGap * before,
    ClothWindowedGap * after)
{
  cloth_windowed_gap_fill (before, after, cloth_diagnosis_recording (d, 0),
      d->takes[0], d->result);
  if (before->sound) {
    d->before = g_steal_pointer (&before->energy);
    d->nudged = g_steal_pointer (&before->nudged);
  }
  if (after && after->sound)
    d->after = g_steal_pointer (&after->energy);
}

/* Which of the accepted effects bring the simulation nearer to the cloth, by the gaps of all models from the one
 * without effects on. What clamps did is seen on them, and moves little of the cloth in a window that begins after it. */
static guint
choose_subset (const Work * w, const Square * models)
{
  const ClothDiagnosis *d = w->d;
  const guint n = 1 << d->n_accepted;
  const gdouble floor = w->judges->floor[WINDOWS].square;
  g_autofree gdouble *squares = g_new (gdouble, n);
  g_autofree gdouble *draws = g_new (gdouble, n * N_DRAWS);
  guint kept = 0;

  for (guint k = 0; k < n; k++) {
    squares[k] = models[k].square;
    for (guint i = 0; i < N_DRAWS; i++)
      draws[k * N_DRAWS + i] = draw_of (&models[k], i);
  }
  for (guint c = 0; c < d->n_accepted; c++)
    if (cloth_diagnosis_accepted (d, c)->effect->side == CLOTH_EFFECT_CLAMP)
      kept |= 1u << c;
  /* no floor is below the noise */
  return cloth_gap_choose_subset (squares, draws, N_DRAWS, d->n_accepted,
      kept,
      isnan (floor) ?
      cloth_recording_noise_square (cloth_diagnosis_recording (d,
              first_judge (d))) : floor);
}

/* Takes back what is not of a subset of the accepted effects; @models: the gaps with each subset. */
static void
keep_subset (ClothDiagnosis * d, const Square * models, guint subset)
{
  GArray *effects = d->result->effects;
  guint n = 0;

  for (guint i = 0; i < effects->len; i++) {
    ClothGapEffect *e = &g_array_index (effects, ClothGapEffect, i);

    for (guint c = 0; c < d->n_accepted; c++) {
      g_autofree gchar *note = NULL;

      if (cloth_diagnosis_accepted (d, c)->effect != e->effect
          || subset >> c & 1)
        continue;
      note = g_strdup_printf ("The residual speaks for %s, but the simulation "
          "with it is not surely nearer to the cloth (gap %.3g mm, without it "
          "%.3g mm), so it is not accepted.", e->effect->id,
          1e3 * sqrt (models[subset | 1u << c].square),
          1e3 * sqrt (models[subset].square));
      cloth_gap_result_add_note (d->result, note);
      e->accepted = FALSE;
      if (!d->taken_back)
        d->taken_back = e->effect;
    }
  }
  for (guint c = 0; c < d->n_accepted; c++)
    if (subset >> c & 1)
      d->accepted[n++] = d->accepted[c];
  d->n_accepted = n;
  cloth_model_free (d->with);
  d->with = g_steal_pointer (&d->fitted[subset]);
}

/* Of the models with some of the accepted effects only that with those that help is measured on; it stands behind those
 * without any. Returns: where */
static guint
choose_model (Work * w, guint faults)
{
  ClothDiagnosis *d = w->d;
  const Square *models = w->judges->models[WINDOWS] + faults;
  const guint subset = choose_subset (w, models);
  const guint best = faults + (subset != 0), from = faults + subset;

  keep_subset (d, models, subset);
  for (guint i = 0; i <= d->recordings->len; i++) {
    Square *squares = w->all[i].models[WINDOWS];
    const Square square = squares[best];

    squares[best] = squares[from];
    squares[from] = square;
  }
  if (from != best) {
    ClothWindowedGap *gap = w->first[best];

    w->first[best] = w->first[from];
    w->first[from] = gap;
  }
  while (w->n > best + 1)
    cloth_windowed_gap_free (w->first[--w->n]);
  if (subset)
    w->models[best] = d->with;
  return best;
}

/* @d: a diagnosis whose effects are known
 * @error: #ClothSimError or #ClothFitError
 *
 * Measures all takes and hold-outs, in windows and in the free run; the hold-outs judge, without any
 * the takes. Effects that don't bring the simulation nearer to the cloth are no longer accepted.
 *
 * Returns: whether they could be simulated
 */
gboolean
cloth_diagnosis_measure (ClothDiagnosis * d, GError ** error)
{
  const guint faults = cloth_diagnosis_count_faults (d) > 0;
  const guint n_subsets = 1 << d->n_accepted;
  g_auto (Work) w = { d, {d->model, d->model}, faults + 1 };
  guint best = faults + (d->n_accepted > 0);

  for (guint i = 1; i < n_subsets; i++)
    if (d->fitted[i])
      w.models[w.n++] = d->fitted[i];
  d->measured = g_array_new (FALSE, TRUE, sizeof (Measured));
  g_array_set_clear_func (d->measured, measured_clear);
  g_array_set_size (d->measured, d->recordings->len + 1);
  find_measured (&w);
  cloth_diagnosis_begin_part (d, 0.85, 1., 0.2, "measuring the gap");
  for (guint kind = 0; kind < N_KINDS; kind++) {
    w.baseline[kind].square = NAN;
    if (d->options->n_baselines && !d->twins->len
        && !measure_baseline (&w, kind, error))
      return FALSE;
    for (guint i = 0; i < d->recordings->len; i++)
      if (!is_baseline (d, i) && !measure_kind (&w, kind, i, error))
        return FALSE;
    sum_judges (&w, kind);
    if (kind == WINDOWS && !cloth_diagnosis_runs_theirs (d))
      best = choose_model (&w, faults);
  }
  fill_result (&w, faults, best);
  keep_first (d, w.first[0], best ? w.first[best] : NULL);
  return TRUE;
}

/* What is left in the user's simulator with the effect added. */
static gboolean
measure_after (const Work * w, Kind kind, guint i, GError ** error)
{
  ClothDiagnosis *d = w->d;
  const ClothRecording *r = cloth_diagnosis_recording (d, i);
  const ClothRecording *after = cloth_diagnosis_after (d, i);
  ClothWindowedGap **own = simulate (d, kind, after, has_noise (r, after),
      w->models, 1, error);
  ClothWindowedGap **gaps = own ? compare (d, kind, r, after, own[0],
      w->models, 1, error) : NULL;
  g_autofree gboolean *windows = gaps && kind == WINDOWS ? list_judging (d, i,
      gaps[0]) : NULL;

  if (gaps)
    find_squares (d, kind, i, gaps, 1, windows, &w->all[i].after[kind]);
  cloth_windowed_gaps_free (own, 1);
  cloth_windowed_gaps_free (gaps, 1);
  return gaps != NULL;
}

/* What was measured takes the place of what was foretold. */
static void
fill_after (Work * w)
{
  ClothDiagnosis *d = w->d;
  ClothGapResult *result = d->result;
  const Measured *m = w->judges;
  guint row = 0;

  result->measured_shrink = find_shrinks (m, &m->after[WINDOWS],
      &m->after[FREE]);
  if (!d->n_accepted)
    return;
  result->gap_after = estimate (&m->after[WINDOWS]);
  result->shrink = result->measured_shrink.windows;
  result->rest_p_value = find_rest_p_value (&m->after[WINDOWS],
      &m->floor[WINDOWS]);
  for (guint i = 0; i < result->effects->len; i++) {
    ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect, i);

    if (e->accepted && e->effect->side != CLOTH_EFFECT_CAMERA
        && e->effect->side != CLOTH_EFFECT_IMAGE)
      e->shrink = result->shrink;
  }
  for (guint i = 0; i < d->recordings->len; i++) {
    ClothGapMeasuredTake *take;

    if (is_baseline (d, i))
      continue;
    take = &g_array_index (result->takes, ClothGapMeasuredTake, row++);
    if (!is_judge (d, i))
      continue;
    take->gap_after = estimate (&w->all[i].after[WINDOWS]);
    take->free_after = estimate (&w->all[i].after[FREE]);
    take->shrink = find_shrink (&w->all[i].models[WINDOWS][0],
        &w->all[i].after[WINDOWS], &w->all[i].floor[WINDOWS]);
  }
}

/* @d: a diagnosis that is measured
 * @error: #ClothSimError or #ClothFitError
 *
 * Measures what the effects took off the gap in the user's simulator, if it was run with them on
 * what judges; what ours foretold of it stays in the predicted shrink only.
 *
 * Returns: whether it could be compared
 */
gboolean
cloth_diagnosis_measure_after (ClothDiagnosis * d, GError ** error)
{
  g_auto (Work) w = { d, {d->model}
  };

  if (!d->afters->len)
    return TRUE;
  find_measured (&w);
  for (guint kind = 0; kind < N_KINDS; kind++)
    for (guint i = 0; i < d->recordings->len; i++) {
      if (!is_judge (d, i))
        continue;
      if (!measure_after (&w, kind, i, error))
        return FALSE;
      if (w.all[i].seen > 0.)
        add_judge (&w.judges->after[kind], &w.all[i].after[kind],
            w.all[i].seen / w.judges->seen);
    }
  fill_after (&w);
  return TRUE;
}
