/* Recordings without what was wrong with all of them, and what they would be with it.
 *
 * Model: what is at x (t) is recorded at time t as
 *     y (t) = A ∫ b (ξ) x (τ (t) + sξ) dξ + b,  τ (t) = t₀ + (t − t₀ − delay) / factor,
 *   with b the normal bell, s its width, t₀ the first frame's time; and under another label.
 * Assumption: between two frames positions are cubics with the frames' velocities (Hermite).
 *   Before the first and after the last one nothing is known: a correction counts it as not
 *   seen, and a residual there is what it is in that one.
 * Formulas: integrals over the bell are sums over seven nodes (Gauss and Hermite). What was
 *   smoothed, G x, is sharpened by x ≈ (1 + (1 − G) + (1 − G)²) G x, which makes no wave more
 *   than three times as high, so noise neither.
 * Reference: van Cittert, Zeitschrift für Physik 69, 1931.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/correction.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/interpolation.h"
#include "gst/fit/recording/noise.h"
#include "gst/fit/recording/signal.h"

#define N_NODES 7
#define N_SHARPEN 2
/* Of a frame's length: times this near are the same. */
#define ROUNDING 1e-6

/* Gauss–Hermite nodes in standard deviations, and their weights. */
static const gdouble nodes[N_NODES] = {
  -3.750439717725742, -2.366759410734541, -1.154405394739968, 0.,
  1.154405394739968, 2.366759410734541, 3.750439717725742
};

static const gdouble node_weights[N_NODES] = {
  5.48268855972218e-4, 3.07571239675865e-2, 2.40123178605013e-1,
  4.57142857142857e-1, 2.40123178605013e-1, 3.07571239675865e-2,
  5.48268855972218e-4
};

/* A time of a recording: the frame before it, and how far it is to the next one. */
typedef struct
{
  guint frame;
  gdouble share;
  gboolean outside;
} Moment;

static Moment
find_moment (const ClothRecording * r, gdouble t)
{
  const guint last = r->n_frames - 1;
  Moment m = { 0 };
  guint low = 0, high = last;
  gdouble span;

  while (high - low > 1) {
    guint middle = (low + high) / 2;

    *(r->times[middle] <= t ? &low : &high) = middle;
  }
  span = r->times[high] - r->times[low];
  m.frame = low;
  m.share = (t - r->times[low]) / span;
  m.outside = m.share < -ROUNDING || m.share > 1. + ROUNDING;
  if (fabs (m.share - 1.) < ROUNDING || m.share > 1.) {
    m.frame = high;
    m.share = 0.;
  } else if (m.share < ROUNDING) {
    m.share = 0.;
  }
  return m;
}

/* Adds @weight times the positions at a moment, and their derivative if it is asked for. */
static void
add_moment (const ClothRecording * r, const Moment * m, gdouble weight,
    gdouble * positions, gdouble * velocities)
{
  const gsize row = 3 * (gsize) r->n;
  const gdouble *y = r->y + m->frame * row, *v = r->velocity + m->frame * row;
  const gdouble a = m->share, c = 1. - a;
  gdouble h;

  if (a == 0.) {
    for (gsize i = 0; i < row; i++) {
      positions[i] += weight * y[i];
      if (velocities)
        velocities[i] += weight * v[i];
    }
    return;
  }
  h = r->times[m->frame + 1] - r->times[m->frame];
  for (gsize i = 0; i < row; i++) {
    positions[i] += weight * ((1. + 2. * a) * c * c * y[i] +
        a * a * (3. - 2. * a) * y[row + i] + h * a * c * (c * v[i] -
            a * v[row + i]));
    if (velocities)
      velocities[i] += weight * (6. * a * c * (y[row + i] - y[i]) / h +
          c * (1. - 3. * a) * v[i] + a * (1. - 3. * c) * v[row + i]);
  }
}

/* The mean over a bell about @t. */
static void
find_mean (const ClothRecording * r, gdouble t, gdouble width,
    gdouble * positions)
{
  memset (positions, 0, 3 * (gsize) r->n * sizeof *positions);
  for (guint k = 0; k < N_NODES; k++) {
    Moment m = find_moment (r, t + width * nodes[k]);

    if (width > 0. || nodes[k] == 0.)
      add_moment (r, &m, width > 0. ? node_weights[k] : 1., positions, NULL);
  }
}

/* @recording: a recording
 * @model: a model
 * @measurement: (out): what the model says was done to the recording
 * @error: #ClothFitError when it can't have been
 *
 * Returns: whether it can
 */
gboolean
cloth_recording_find_measurement (const ClothRecording * recording,
    const ClothModel * model, ClothMeasurement * measurement, GError ** error)
{
  g_autofree gchar *fault = NULL;

  cloth_measurement_init (measurement);
  for (guint i = 0; i < model->effects->len; i++) {
    const ClothModelEffect *e =
        &g_array_index (model->effects, ClothModelEffect, i);

    cloth_measurement_add_effect (measurement, e->effect, e->values);
  }
  fault = cloth_measurement_find_fault (measurement,
      recording->scene->topology);
  if (!fault)
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "%s: the model's "
      "fault of the recording is impossible: %s", recording->name, fault);
  return FALSE;
}

static ClothRecording *
copy (const ClothRecording * r)
{
  const gsize all = (gsize) r->n * r->n_frames;
  ClothRecording *c = g_memdup2 (r, sizeof *r);

  c->name = g_strdup (r->name);
  c->scene = cloth_scene_copy (r->scene);
  c->times = g_memdup2 (r->times, r->n_frames * sizeof *r->times);
  c->y = g_memdup2 (r->y, 3 * all * sizeof *r->y);
  c->velocity = g_memdup2 (r->velocity, 3 * all * sizeof *r->velocity);
  c->seen = g_memdup2 (r->seen, all * sizeof *r->seen);
  c->noise = cloth_recording_noise_ref (r->noise);
  c->targets = NULL;
  /* of what was recorded */
  c->start = NULL;
  return c;
}

static void
sharpen (ClothRecording * r, gdouble width)
{
  const gsize row = 3 * (gsize) r->n;
  g_autofree gdouble *smooth = g_memdup2 (r->y, r->n_frames * row *
      sizeof *r->y);
  g_autofree gdouble *means = g_new (gdouble, r->n_frames * row);

  for (guint k = 0; k < N_SHARPEN; k++) {
    for (guint f = 0; f < r->n_frames; f++)
      find_mean (r, r->times[f], width, means + f * row);
    for (gsize i = 0; i < r->n_frames * row; i++)
      r->y[i] += smooth[i] - means[i];
    cloth_recording_differentiate (r);
  }
}

/* What is known of a place, and along which directions, of another place of another noise. */
static void
take_noise (const ClothRecordingNoise * from, gsize of,
    ClothRecordingNoise * to, gsize at)
{
  memcpy (to->white + 6 * at, from->white + 6 * of, 6 * sizeof (gdouble));
  memcpy (to->draw + 6 * at, from->draw + 6 * of, 6 * sizeof (gdouble));
}

/* Noise whose places are still to be filled. */
static ClothRecordingNoise *
noise_like (const ClothRecordingNoise * noise)
{
  ClothRecordingNoise *made = cloth_recording_noise_new (noise->n);

  made->square = noise->square;
  return made;
}

/* Each frame gets what was recorded later, by a clock that ran faster. */
static void
retime (const ClothRecording * from, ClothRecording * to, gdouble factor,
    gdouble delay_s)
{
  const gsize row = 3 * (gsize) from->n;

  if (from->noise) {
    cloth_recording_noise_unref (to->noise);
    to->noise = noise_like (from->noise);
  }
  memset (to->y, 0, from->n_frames * row * sizeof *to->y);
  memset (to->velocity, 0, from->n_frames * row * sizeof *to->velocity);
  for (guint f = 0; f < from->n_frames; f++) {
    const Moment m = find_moment (from, from->times[0] +
        factor * (from->times[f] - from->times[0]) + delay_s);
    const gdouble *seen = from->seen + (gsize) m.frame * from->n;

    add_moment (from, &m, 1., to->y + f * row, to->velocity + f * row);
    for (gsize i = 0; i < row; i++)
      to->velocity[f * row + i] *= factor;
    for (guint v = 0; v < from->n; v++)
      to->seen[(gsize) f * from->n + v] = m.outside ? 0. :
          m.share > 0. ? seen[v] * seen[from->n + v] : seen[v];
    /* of a place between two frames that of the nearer one */
    for (guint v = 0; from->noise && v < from->n; v++)
      take_noise (from->noise, (gsize) (m.frame + (m.share > 0.5)) * from->n +
          v, to->noise, (gsize) f * from->n + v);
  }
}

static void
relabel (ClothRecording * r, const ClothMeasurement * m)
{
  g_autofree gint *labels = cloth_measurement_list_labels (m,
      r->scene->topology);
  g_autofree gdouble *y = g_new (gdouble, 3 * (gsize) r->n);
  g_autofree gdouble *velocity = g_new (gdouble, 3 * (gsize) r->n);
  g_autofree gdouble *seen = g_new (gdouble, r->n);
  ClothRecordingNoise *noise = r->noise ? noise_like (r->noise) : NULL;

  for (guint f = 0; f < r->n_frames; f++) {
    gdouble *to[2] = { r->y + 3 * (gsize) f * r->n,
      r->velocity + 3 * (gsize) f * r->n
    };
    gdouble *own = r->seen + (gsize) f * r->n;

    memcpy (y, to[0], 3 * (gsize) r->n * sizeof *y);
    memcpy (velocity, to[1], 3 * (gsize) r->n * sizeof *velocity);
    memcpy (seen, own, r->n * sizeof *seen);
    for (guint v = 0; v < r->n; v++) {
      own[v] = labels[v] < 0 ? 0. : seen[labels[v]];
      if (noise && labels[v] >= 0)
        take_noise (r->noise, (gsize) f * r->n + (guint) labels[v], noise,
            (gsize) f * r->n + v);
      for (guint k = 0; k < 3; k++) {
        to[0][3 * v + k] = labels[v] < 0 ? NAN : y[3 * labels[v] + (gint) k];
        to[1][3 * v + k] = labels[v] < 0 ? 0. :
            velocity[3 * labels[v] + (gint) k];
      }
    }
  }
  if (noise) {
    cloth_recording_noise_unref (r->noise);
    r->noise = noise;
  }
}

/* Whether places are not only shifted. */
static gboolean
has_map (const ClothMeasurement * m)
{
  for (guint k = 0; k < 9; k++)
    if (m->matrix[k] != (k % 4 == 0))
      return TRUE;
  return FALSE;
}

static void
map_back (ClothRecording * r, const ClothMeasurement * m)
{
  const gsize all = (gsize) r->n * r->n_frames;
  gdouble inverse[9], volume = 0.;

  cloth_measurement_invert (m, inverse);
  for (guint k = 0; k < 3; k++)
    volume += inverse[k] * (inverse[3 + (k + 1) % 3] * inverse[6 + (k + 2) % 3]
        - inverse[3 + (k + 2) % 3] * inverse[6 + (k + 1) % 3]);
  r->sigma *= cbrt (fabs (volume));
  if (r->noise && has_map (m)) {
    ClothRecordingNoise *noise = cloth_recording_noise_map (r->noise,
        m->matrix);

    cloth_recording_noise_unref (r->noise);
    r->noise = noise;
  }
  for (gsize i = 0; i < all; i++) {
    gdouble off[3], speed[3];

    for (guint k = 0; k < 3; k++) {
      off[k] = r->y[3 * i + k] - m->shift[k];
      speed[k] = r->velocity[3 * i + k];
    }
    for (guint k = 0; k < 3; k++) {
      const gdouble *a = inverse + 3 * k;

      r->y[3 * i + k] = a[0] * off[0] + a[1] * off[1] + a[2] * off[2];
      r->velocity[3 * i + k] =
          a[0] * speed[0] + a[1] * speed[1] + a[2] * speed[2];
    }
  }
}

/* @recording: a recording
 * @measurement: what was wrong with all of it
 *
 * Frames of times that were not recorded are not seen; positions there are those of the nearest
 * frame. What was smoothed is sharpened in part only.
 *
 * Returns: (transfer full): what would have been recorded if nothing had been wrong
 */
ClothRecording *
cloth_recording_correct (const ClothRecording * recording,
    const ClothMeasurement * measurement)
{
  const ClothMeasurement *m = measurement;
  ClothRecording *r = copy (recording);

  if (m->smoothing_s > 0.)
    sharpen (r, m->smoothing_s * m->time_factor);
  if (m->time_factor != 1. || m->delay_s != 0.) {
    ClothRecording *late = copy (r);

    retime (late, r, m->time_factor, m->delay_s);
    cloth_recording_free (late);
  }
  if (cloth_measurement_changes_labels (m))
    relabel (r, m);
  map_back (r, m);
  if (m->columns != 0. || m->rows != 0.) {
    cloth_recording_interpolate (r);
    cloth_recording_differentiate (r);
  }
  return r;
}

/* @recording: a recording
 * @positions: (inout) (array): where the vertices are in its frames as @measurement would have
 *   recorded them if it took no time, [n_frames][n][3]: all frames of something simulated
 * @measurement: what was wrong with all of the recording
 *
 * Lets the measurement take its time. Frames that show what was before the first one or after the
 * last one become as far off the recording as that one.
 */
void
cloth_recording_measure (const ClothRecording * recording,
    gdouble * positions, const ClothMeasurement * measurement)
{
  const ClothMeasurement *m = measurement;
  const guint n = recording->n_frames;
  const gsize row = 3 * (gsize) recording->n;
  const gdouble begin = recording->times[0], end = recording->times[n - 1];
  g_autofree gdouble *path = g_memdup2 (positions, n * row * sizeof *positions);
  g_autofree gdouble *velocity = g_new (gdouble, n * row);
  g_autofree gdouble *shown = g_new (gdouble, row);
  ClothRecording r = *recording;

  r.y = path;
  r.velocity = velocity;
  cloth_recording_differentiate (&r);
  for (guint f = 0; f < n; f++) {
    const gdouble t = begin + (r.times[f] - begin - m->delay_s) /
        m->time_factor;
    const gdouble known = CLAMP (t, begin, end);
    gdouble *to = positions + f * row;
    Moment moment;

    find_mean (&r, known, m->smoothing_s, to);
    if (!find_moment (&r, t).outside)
      continue;
    /* when the known one was recorded */
    moment = find_moment (recording, begin + m->time_factor * (known - begin) +
        m->delay_s);
    memset (shown, 0, row * sizeof *shown);
    add_moment (recording, &moment, 1., shown, NULL);
    for (gsize i = 0; i < row; i++)
      to[i] += recording->y[f * row + i] - shown[i];
  }
}
