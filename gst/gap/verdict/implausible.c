/* What makes a diagnosis undecidable: a recording that is too short, has too few frames or saw
 * too little, or whose gravity, frame rate, size or noise are not what take.json says.
 *
 * Gravity and frame rate are tested by simulation: of each alternative the gap in windows is
 * measured, on a coarse mesh, and an alternative whose squared gap is less than a quarter of
 * the given one's is named. All else follows from the recording alone. Each check returns a
 * sentence that says what to mend, or NULL.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/implausible.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"

/* Fewest windows that the gap is measured in: one to fit on, one to judge. */
#define LEAST_WINDOWS 2.
/* Frames further apart than this share of a window don't show what happens in it. */
#define LONGEST_INTERVAL (1. / 3.)
/* Of all vertices in all frames this share must have been seen. */
#define LEAST_SEEN 0.2
/* A cloth that nothing holds falls. One that falls by less than this share of its longest side
 * in a time in which free fall takes it further than that side is held by something. */
#define HARDLY_FALLEN 0.1
/* An alternative gravity or frame rate is named when its squared gap is less than this share of
 * the given one's. Grids are simulated with at most so many lines each way. */
#define MUCH_LESS 0.25
#define ALTERNATIVE_LINES 9
/* Positions are noisier than given when the noise that is estimated from frame to frame is this
 * many times the given one and this share of the longest side. */
#define MOST_JUMPS 10.
#define LEAST_JUMP 0.02
/* A floor beyond this share of the cloth's longest side hides whether there is a gap. */
#define MOST_FLOOR 0.1
/* The size of the cloth is wrong when edges everywhere are so many times as long as on the flat
 * cloth. */
#define MOST_STRETCH 1.2
/* Gravity on earth, m/s², and the share by which it differs from place to place. */
#define EARTH 9.81
#define EARTH_SHARE 0.05
/* Factors by which frame rates are mistaken. Where the first or the last does best, something
 * else is wrong. */
static const gdouble rates[] = { 0.25, 0.5, 2., 4. };

/* A copy of a recording, resampled to few vertices, whose gravity and times, those of clamps too, may be changed. */
typedef struct
{
  ClothRecording *thin;
  ClothRecording r;
  ClothScene scene;
  gdouble *times, *velocity;
} Alternative;

static void
alternative_clear (Alternative * t)
{
  cloth_recording_free (t->thin);
  g_free (t->times);
  g_free (t->velocity);
  g_clear_pointer (&t->scene.held, g_array_unref);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Alternative, alternative_clear);

static void
alternative_init (Alternative * t, const ClothRecording * recording)
{
  t->thin = cloth_recording_resample (recording, ALTERNATIVE_LINES);
  if (t->thin) {
    gsize all = (gsize) t->thin->n * t->thin->n_frames;

    t->thin->seen = g_new (gdouble, all);
    for (gsize i = 0; i < all; i++)
      t->thin->seen[i] = 1.;
  }
  t->r = t->thin ? *t->thin : *recording;
  t->scene = *t->r.scene;
  t->scene.held = g_array_copy (t->scene.held);
  t->velocity = g_new (gdouble, 3 * (gsize) t->r.n * t->r.n_frames);
  t->times = g_memdup2 (t->r.times, t->r.n_frames * sizeof *t->times);
  t->r.scene = &t->scene;
  t->r.times = t->scene.times = t->times;
  t->r.velocity = t->velocity;
  cloth_recording_differentiate (&t->r);
}

/* These simulations do not count as progress, but may be stopped. */
static gboolean
may_continue (gpointer data, gdouble share)
{
  const ClothDiagnosis *d = data;

  return !d->options->progress
      || d->options->progress (d->options->progress_data, d->from, d->what);
}

/* Mean squared gap to a recording whose time runs @faster times as fast, m²; NaN when the
 * simulation diverges or is stopped. */
static gdouble
measure_alternative (ClothDiagnosis * d, const Alternative * t,
    const ClothModel * model, gdouble faster)
{
  ClothRolloutOptions options = d->study.rollout;
  ClothWindowedGap **gaps;
  gdouble square = NAN;

  options.progress = may_continue;
  cloth_diagnosis_begin_part (d, d->from, d->to, d->each,
      "checking axes and units");
  gaps =
      cloth_windowed_gaps_new (&t->r, &model, 1,
      CLOTH_DIAGNOSIS_WINDOW_GAIN * faster * faster,
      CLOTH_DIAGNOSIS_WINDOW_S / faster, &options, NULL);
  d->study.simulations += 2;
  if (gaps && gaps[0]->sound)
    square = cloth_windowed_gap_square (gaps[0], NULL);
  cloth_windowed_gaps_free (gaps, 1);
  return square;
}

/* Whether gravity along another axis, or as strong as on earth, makes the gap much smaller. */
static gchar *
check_gravity (ClothDiagnosis * d, const ClothRecording * recording,
    const ClothModel * model)
{
  static const gchar *const names[] =
      { "+x", "−x", "+y", "−y", "+z", "−z" };
  const gdouble *gravity = recording->scene->gravity;
  const gdouble g = cloth_vec3_length (gravity);
  const gdouble strengths[] = { g > 0. ? g : EARTH, EARTH };
  const guint n = g > 0. && fabs (g - EARTH) > EARTH_SHARE * EARTH ? 2 : 1;
  g_auto (Alternative) t = { NULL };
  gdouble given, least = INFINITY, strength = 0.;
  guint best = 0;

  alternative_init (&t, recording);
  given = measure_alternative (d, &t, model, 1.);
  for (guint s = 0; s < n; s++)
    for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
      gdouble square;

      for (guint k = 0; k < 3; k++)
        t.scene.gravity[k] =
            k == i / 2 ? (i % 2 ? -strengths[s] : strengths[s]) : 0.;
      square = measure_alternative (d, &t, model, 1.);
      if (square < least) {
        least = square;
        strength = strengths[s];
        best = i;
      }
    }
  if (!(least < MUCH_LESS * given))
    return NULL;
  return g_strdup_printf ("The cloth of %s moves as if gravity were along %s "
      "with %.3g m/s² and not as “gravity” of take.json says; mind the axes of "
      "positions.npy: world z is up.", recording->name, names[best], strength);
}

static gchar *
check_times (const ClothRecording * r)
{
  const gdouble window = CLOTH_DIAGNOSIS_WINDOW_S;
  const gdouble duration = r->times[r->n_frames - 1] - r->times[0];
  const gdouble interval = duration / (r->n_frames - 1);
  gdouble most = 0.;
  guint after = 0;

  for (guint frame = 1; frame < r->n_frames; frame++)
    if (r->times[frame] - r->times[frame - 1] > most) {
      most = r->times[frame] - r->times[frame - 1];
      after = frame - 1;
    }
  /* the interval without the longest hole */
  if (duration - most > LONGEST_INTERVAL * window * (r->n_frames - 2))
    return
        g_strdup_printf
        ("The take %s has one frame in %.3g s, and the gap is measured "
        "in windows of %g s; film at least %g frames a second, and give times "
        "in seconds.", r->name, interval, window,
        ceil (1. / (LONGEST_INTERVAL * window)));
  if (most > window)
    return
        g_strdup_printf
        ("The take %s has no frame for %.3g s after frame %u, and what "
        "its cloth and clamps did meanwhile is not known; give what is before "
        "and what is after as two takes.", r->name, most, after);
  if (duration < LEAST_WINDOWS * window - 1e-6)
    return
        g_strdup_printf
        ("The take %s lasts %.3g s, and the gap is measured in windows "
        "of %g s; film at least %g s.", r->name, duration, window,
        LEAST_WINDOWS * window);
  return NULL;
}

static gchar *
check_seen (const ClothRecording * r)
{
  gsize all = (gsize) r->n * r->n_frames;
  gdouble seen = 0.;

  for (gsize i = 0; i < all; i++)
    seen += r->seen[i];
  if (seen >= LEAST_SEEN * all)
    return NULL;
  return
      g_strdup_printf ("Only %.3g%% of %s was seen, and at least %g%% must be; "
      "add cameras, or begin and end the take where the cloth is in sight.",
      100. * seen / all, r->name, 100. * LEAST_SEEN);
}

/* Mean height of the vertices in a frame, along the direction against gravity, m. */
static gdouble
height_of (const ClothRecording * r, guint frame, gdouble g)
{
  const gdouble *y = r->y + 3 * (gsize) frame * r->n;
  gdouble sum = 0.;

  for (gsize i = 0; i < 3 * (gsize) r->n; i++)
    sum -= y[i] * r->scene->gravity[i % 3] / g;
  return sum / r->n;
}

static gchar *
check_held (const ClothRecording * r)
{
  const gdouble *gravity = r->scene->gravity;
  gdouble g = cloth_vec3_length (gravity);
  gdouble duration = r->times[r->n_frames - 1] - r->times[0];
  gdouble side = cloth_recording_longest_side (r);

  if (!(g > 0.) || r->scene->held->len || r->scene->obstacles->len
      || 0.5 * g * duration * duration < side
      || height_of (r, 0, g) - height_of (r, r->n_frames - 1, g) >
      HARDLY_FALLEN * side)
    return NULL;
  return g_strdup_printf ("Nothing holds the cloth of %s, and yet it does not "
      "fall; name what holds it in “held” or “obstacles” of take.json.",
      r->name);
}

/* Whether all recordings have the gravity that is given, and name what holds the cloth. */
static gchar *
check_scene (ClothDiagnosis * d, const ClothModel * model)
{
  gchar *reason = NULL;

  for (guint i = 0; i < d->recordings->len && !reason; i++)
    reason = check_held (cloth_diagnosis_recording (d, i));
  for (guint i = 0; i < d->recordings->len && !reason; i++)
    reason = check_gravity (d, cloth_diagnosis_recording (d, i), model);
  return reason;
}

/* @d: a diagnosis whose recordings are loaded
 * @model: what the simulator knows
 *
 * Checks what follows from the recordings alone first: of hours between two frames nothing is
 * simulated. Recordings with observations go on whatever their gravity is, as camera faults
 * are found without a simulation.
 *
 * Returns: (transfer full) (nullable): why the recordings can't be diagnosed, a sentence
 */
gchar *
cloth_diagnosis_find_implausible_input (ClothDiagnosis * d,
    const ClothModel * model)
{
  gchar *reason = NULL;

  for (guint i = 0; i < d->recordings->len && !reason; i++) {
    const ClothRecording *r = cloth_diagnosis_recording (d, i);

    if (!(reason = check_times (r)))
      reason = check_seen (r);
  }
  return reason || cloth_diagnosis_has_observations (d) ? reason :
      check_scene (d, model);
}

static gchar *
check_noise (const ClothRecording * r)
{
  gdouble jumps = cloth_recording_estimate_sigma (r);

  if (!(jumps > MOST_JUMPS * r->sigma
          && jumps > LEAST_JUMP * cloth_recording_longest_side (r)))
    return NULL;
  return g_strdup_printf ("Positions of %s jump by %.2g m from frame to frame, "
      "and “noise_sigma_m” says %.2g m; mind the order of frames, film more "
      "frames a second, or let null estimate the noise.", r->name, jumps,
      r->sigma);
}

/* @d: a diagnosis whose recordings are loaded
 *
 * Returns: (transfer full) (nullable): that the first take is noisier than it is said to be, a sentence
 */
gchar *
cloth_diagnosis_find_noise (ClothDiagnosis * d)
{
  return check_noise (cloth_diagnosis_recording (d, 0));
}

/* Agreement says nothing where the floor is so high that everything agrees. */
static gchar *
check_floor (ClothDiagnosis * d, const ClothRecording * r)
{
  gdouble floor = d->result->noise_floor.value;

  if (!(floor > MOST_FLOOR * cloth_recording_longest_side (r)))
    return NULL;
  return g_strdup_printf ("A simulation that lacks nothing would be %.3g m off "
      "%s, too, so nothing can be told; film with less noise, mind the order of "
      "frames, or give a --baseline.", floor, r->name);
}

static gchar *
check_size (const ClothRecording * r)
{
  for (guint corner = 0; corner < 2; corner++) {
    gdouble scale = cloth_recording_find_scale (r, corner, r->sigma);

    if (scale > MOST_STRETCH)
      return
          g_strdup_printf ("Edges of %s are %.3g times as long as on the flat "
          "cloth; mind the size of the cloth in take.json.", r->name, scale);
  }
  return NULL;
}

/* When something was if frames came so much faster. */
static gdouble
stretch_time (const ClothRecording * r, gdouble time, gdouble rate)
{
  return r->times[0] + (time - r->times[0]) / rate;
}

/* Whether another frame rate makes the gap much smaller. */
static gchar *
check_rate (ClothDiagnosis * d, const ClothRecording * r,
    const ClothModel * model)
{
  const guint n = G_N_ELEMENTS (rates);
  g_auto (Alternative) t = { NULL };
  const ClothRecording *from;
  gdouble given, least = INFINITY, best = 1.;

  alternative_init (&t, r);
  from = t.thin ? t.thin : r;
  given = measure_alternative (d, &t, model, 1.);
  for (guint i = 0; i < n; i++) {
    gdouble square;

    for (guint f = 0; f < t.r.n_frames; f++)
      t.times[f] = stretch_time (r, from->times[f], rates[i]);
    for (guint k = 0; k < t.scene.held->len; k++) {
      const ClothHeld *held = &g_array_index (from->scene->held, ClothHeld, k);
      ClothHeld *at = &g_array_index (t.scene.held, ClothHeld, k);

      at->from_s = stretch_time (r, held->from_s, rates[i]);
      at->until_s = stretch_time (r, held->until_s, rates[i]);
    }
    cloth_recording_differentiate (&t.r);
    square = measure_alternative (d, &t, model, rates[i]);
    if (square < least) {
      least = square;
      best = rates[i];
    }
  }
  if (!(least < MUCH_LESS * given) || best == rates[0] || best == rates[n - 1])
    return NULL;
  return g_strdup_printf ("The cloth of %s moves as if it were filmed at about "
      "%.3g frames a second; mind “fps” of take.json or times.npy.",
      r->name,
      best * (r->n_frames - 1) / (r->times[r->n_frames - 1] - r->times[0]));
}

/* @d: a diagnosis with a verdict
 * @model: what the simulator knows
 *
 * Checks that there was something to judge by, that agreement is not only in noise, and that
 * an unexplained gap does not look like noise, another size or another frame rate.
 *
 * Returns: (transfer full) (nullable): why the verdict says nothing, a sentence
 */
gchar *
cloth_diagnosis_find_implausible_result (ClothDiagnosis * d,
    const ClothModel * model)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, 0);
  const ClothGapVerdict verdict = d->result->verdict;
  gchar *reason;

  if (!isfinite (d->result->gap_before.value))
    return g_strdup ("Nothing was seen in the parts that judge; give a take of "
        "its own as --hold-out.");
  if (verdict == CLOTH_GAP_EXPLAINED || verdict == CLOTH_GAP_AMBIGUOUS
      || (verdict == CLOTH_GAP_UNEXPLAINED && cloth_diagnosis_count_faults (d)))
    return NULL;
  if ((reason = check_noise (r)))
    return reason;
  if (verdict != CLOTH_GAP_UNEXPLAINED && (reason = check_floor (d, r))) {
    /* a simulation of cloth of another size is off by much, too */
    gchar *size = check_size (r);

    if (!size)
      return reason;
    g_free (reason);
    return size;
  }
  /* agreement, or nothing that could be seen */
  if (!(d->unknown_probability > 0.5))
    return NULL;
  if ((reason = check_size (r)))
    return reason;
  if (cloth_diagnosis_has_observations (d) && (reason = check_scene (d, model)))
    return reason;
  return check_rate (d, r, model);
}
