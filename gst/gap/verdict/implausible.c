/* What makes a diagnosis undecidable: too little time, too few frames, too little seen, or
 * a world that is not the recording's.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/gap/diagnosis.h"

/* Fewest windows of the gap: one to fit on, one to judge. */
#define LEAST_WINDOWS 2.
/* Frames further apart than this share of a window don't show what happens in it. */
#define LONGEST_INTERVAL (1. / 3.)
/* Of all places this share must have been seen. */
#define LEAST_SEEN 0.2
/* What nothing holds falls; a cloth that falls by less than this share of its longest side
 * while it should fall by all of it is held. */
#define HARDLY_FALLEN 0.1
/* Another world must make the gap's square this much less, on a cloth of so many lines. */
#define MUCH_LESS 0.25
#define TRIAL_LINES 9
/* Positions that jump by so many times the noise that is told, and this share of the longest
 * side, are not what they are told to be. */
#define MOST_JUMPS 10.
#define LEAST_JUMP 0.02
/* A floor beyond this share of the cloth's longest side hides whether there is a gap. */
#define MOST_FLOOR 0.1
/* Edges that are so many times as long as on the flat cloth, all over it: its size is amiss. */
#define MOST_STRETCH 1.2
/* Gravity on earth, m/s², and by how much one that is told may differ from it anywhere there. */
#define EARTH 9.81
#define EARTH_SHARE 0.05
/* Gain of the observer that leads up to its windows, 1/s². */
#define TRIAL_GAIN 1600.
/* Frame rates are mistaken by factors like these. Where the first or the last does best,
 * something else is amiss. */
static const gdouble faster[] = { 0.25, 0.5, 2., 4. };

/* A recording to be tried in other worlds: its scene and times are its own. */
typedef struct
{
  ClothRecording *thin;
  ClothRecording r;
  ClothScene scene;
  gdouble *times, *velocity;
} Trial;

static void
trial_clear (Trial * t)
{
  cloth_recording_free (t->thin);
  g_free (t->times);
  g_free (t->velocity);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Trial, trial_clear)
     static void trial_init (Trial * t, const ClothRecording * recording)
{
  t->thin = cloth_recording_resample (recording, TRIAL_LINES);
  if (t->thin) {
    gsize all = (gsize) t->thin->n * t->thin->n_frames;

    t->thin->seen = g_new (gdouble, all);
    for (gsize i = 0; i < all; i++)
      t->thin->seen[i] = 1.;
  }
  t->r = t->thin ? *t->thin : *recording;
  t->scene = *t->r.scene;
  t->velocity = g_new (gdouble, 3 * (gsize) t->r.n * t->r.n_frames);
  t->times = g_memdup2 (t->r.times, t->r.n_frames * sizeof *t->times);
  t->r.scene = &t->scene;
  t->r.times = t->scene.times = t->times;
  t->r.velocity = t->velocity;
  cloth_recording_differentiate (&t->r);
}

/* A trial tells nothing of how far it is, but may be stopped. */
static gboolean
may_go_on (gpointer data, gdouble share)
{
  const ClothDiagnosis *d = data;

  return !d->options->progress
      || d->options->progress (d->options->progress_data, d->from, d->what);
}

/* The simulator's mean squared gap to a recording whose time runs so many times as fast:
 * NaN when it diverges or is stopped. */
static gdouble
try_world (ClothDiagnosis * d, const Trial * t, const ClothModel * model,
    gdouble faster)
{
  ClothRolloutOptions options = d->study.rollout;
  ClothWindowedGap **extents;
  gdouble square = NAN;

  options.progress = may_go_on;
  cloth_diagnosis_begin_part (d, d->from, d->to, d->each, "another world");
  extents = cloth_windowed_gaps_new (&t->r, &model, 1,
      TRIAL_GAIN * faster * faster, CLOTH_DIAGNOSIS_WINDOW_S / faster, &options,
      NULL);
  d->study.simulations += 2;
  if (extents && extents[0]->sound)
    square = cloth_windowed_gap_square (extents[0], NULL);
  cloth_windowed_gaps_free (extents, 1);
  return square;
}

/* Whether other gravity makes much less of a gap: along another axis, or the earth's. */
static gchar *
doubt_gravity (ClothDiagnosis * d, const ClothRecording * recording,
    const ClothModel * model)
{
  static const gchar *const names[] =
      { "+x", "−x", "+y", "−y", "+z", "−z" };
  const gdouble *gravity = recording->scene->gravity;
  const gdouble g = sqrt (gravity[0] * gravity[0] + gravity[1] * gravity[1] +
      gravity[2] * gravity[2]);
  const gdouble strengths[] = { g > 0. ? g : EARTH, EARTH };
  const guint n = g > 0. && fabs (g - EARTH) > EARTH_SHARE * EARTH ? 2 : 1;
  g_auto (Trial) t = { NULL };
  gdouble told, least = INFINITY, strength = 0.;
  guint best = 0;

  trial_init (&t, recording);
  told = try_world (d, &t, model, 1.);
  for (guint s = 0; s < n; s++)
    for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
      gdouble square;

      for (guint k = 0; k < 3; k++)
        t.scene.gravity[k] =
            k == i / 2 ? (i % 2 ? -strengths[s] : strengths[s]) : 0.;
      square = try_world (d, &t, model, 1.);
      if (square < least) {
        least = square;
        strength = strengths[s];
        best = i;
      }
    }
  if (!(least < MUCH_LESS * told))
    return NULL;
  return g_strdup_printf ("The cloth of %s moves as if gravity were along %s "
      "with %.3g m/s² and not as “gravity” of take.json says; mind the axes of "
      "positions.npy: world z is up.", recording->name, names[best], strength);
}

static gchar *
doubt_times (const ClothRecording * r)
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
  /* one hole may be as long as all the rest */
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
doubt_seen (const ClothRecording * r)
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

/* Mean height of what a frame holds, against gravity, m. */
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
doubt_held (const ClothRecording * r)
{
  const gdouble *gravity = r->scene->gravity;
  gdouble g = sqrt (gravity[0] * gravity[0] + gravity[1] * gravity[1] +
      gravity[2] * gravity[2]);
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

/* Whether the world that the takes tell of is not the recordings'. */
static gchar *
doubt_world (ClothDiagnosis * d, const ClothModel * model)
{
  gchar *doubt = NULL;

  for (guint i = 0; i < d->recordings->len && !doubt; i++)
    doubt = doubt_held (cloth_diagnosis_recording (d, i));
  for (guint i = 0; i < d->recordings->len && !doubt; i++)
    doubt = doubt_gravity (d, cloth_diagnosis_recording (d, i), model);
  return doubt;
}

/* Why the recordings can't be diagnosed, a sentence, or NULL. What is cheap to find out comes
 * first: of hours between two frames nothing is simulated. What cameras saw can be diagnosed
 * in any world. */
gchar *
cloth_diagnosis_find_doubt (ClothDiagnosis * d, const ClothModel * model)
{
  gchar *doubt = NULL;

  for (guint i = 0; i < d->recordings->len && !doubt; i++) {
    const ClothRecording *r = cloth_diagnosis_recording (d, i);

    if (!(doubt = doubt_times (r)))
      doubt = doubt_seen (r);
  }
  return doubt || cloth_diagnosis_has_observations (d) ? doubt :
      doubt_world (d, model);
}

static gchar *
doubt_noise (const ClothRecording * r)
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

/* Agreement says nothing where all agrees. */
static gchar *
doubt_floor (ClothDiagnosis * d, const ClothRecording * r)
{
  gdouble floor = d->result->noise_floor.value;

  if (!(floor > MOST_FLOOR * cloth_recording_longest_side (r)))
    return NULL;
  return g_strdup_printf ("A simulation that lacks nothing would be %.3g m off "
      "%s, too, so nothing can be told; film with less noise, mind the order of "
      "frames, or give a --baseline.", floor, r->name);
}

static gchar *
doubt_size (const ClothRecording * r)
{
  for (guint corner = 0; corner < 2; corner++) {
    gdouble scale = cloth_recording_find_scale (r, corner);

    if (scale > MOST_STRETCH)
      return
          g_strdup_printf ("Edges of %s are %.3g times as long as on the flat "
          "cloth; mind the size of the cloth in take.json.", r->name, scale);
  }
  return NULL;
}

/* Whether another frame rate makes much less of a gap. */
static gchar *
doubt_rate (ClothDiagnosis * d, const ClothRecording * r,
    const ClothModel * model)
{
  const guint n = G_N_ELEMENTS (faster);
  g_auto (Trial) t = { NULL };
  gdouble told, least = INFINITY, best = 1.;

  trial_init (&t, r);
  told = try_world (d, &t, model, 1.);
  for (guint i = 0; i < n; i++) {
    gdouble square;

    for (guint f = 0; f < t.r.n_frames; f++)
      t.times[f] = (t.thin ? t.thin : r)->times[f] / faster[i];
    cloth_recording_differentiate (&t.r);
    square = try_world (d, &t, model, faster[i]);
    if (square < least) {
      least = square;
      best = faster[i];
    }
  }
  if (!(least < MUCH_LESS * told) || best == faster[0] || best == faster[n - 1])
    return NULL;
  return g_strdup_printf ("The cloth of %s moves as if it were filmed at about "
      "%.3g frames a second; mind “fps” of take.json or times.npy.",
      r->name,
      best * (r->n_frames - 1) / (r->times[r->n_frames - 1] - r->times[0]));
}

/* The same of what was found: nothing to judge by, agreement in noise, or what no effect
 * explains looks like noise, another size or another frame rate. */
gchar *
cloth_diagnosis_doubt_result (ClothDiagnosis * d, const ClothModel * model)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, 0);
  const ClothGapVerdict verdict = d->result->verdict;
  gchar *doubt;

  if (!isfinite (d->result->gap_before.value))
    return g_strdup ("Nothing was seen in the parts that judge; give a take of "
        "its own as --hold-out.");
  if (verdict != CLOTH_GAP_NO_GAP && (verdict != CLOTH_GAP_UNEXPLAINED
          || cloth_diagnosis_count_faults (d)))
    return NULL;
  if ((doubt = doubt_noise (r)))
    return doubt;
  if (verdict == CLOTH_GAP_NO_GAP)
    return doubt_floor (d, r);
  if ((doubt = doubt_size (r)))
    return doubt;
  if (cloth_diagnosis_has_observations (d) && (doubt = doubt_world (d, model)))
    return doubt;
  return doubt_rate (d, r, model);
}
