/* What draws a simulation to a recording: straight lines whose means are those of the motion itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/recording/recording.h"
#include "gst/fit/recording/signal.h"

#define N_FRAMES 40
#define FPS 50.

typedef struct
{
  gdouble hz;
  gdouble jitter;               /* of frame times, of a frame */
  gdouble most_with, least_without;     /* of the largest speed */
} Case;

static const Case cases[] = {
  {4., 0., 0.002, 0.02},
  {9., 0., 0.06, 0.15},
  {4., 0.1, 0.0035, 0.02},
  {9., 0.1, 0.08, 0.15},
};

/* Largest error of the means of both lines, of the motion's largest speed and place. Ends, where polynomials
 * see one side only, are left out. */
static void
find_errors (const ClothRecording * r, gdouble w, gdouble * place,
    gdouble * speed)
{
  *place = *speed = 0.;
  for (guint f = 4; f + 5 < r->n_frames; f++) {
    const gdouble t0 = r->times[f], t1 = r->times[f + 1], dt = t1 - t0;

    for (guint k = 0; k < 3; k++) {
      const guint a = 3 * f + k, b = a + 3;
      /* ∫ sin (w t + k) and its derivative's, over the frame */
      const gdouble mean = (cos (w * t0 + k) - cos (w * t1 + k)) / (w * dt);
      const gdouble moved = (sin (w * t1 + k) - sin (w * t0 + k)) / dt;

      *place = MAX (*place, fabs (0.5 * (r->targets[a] + r->targets[b]) -
              mean));
      *speed = MAX (*speed, fabs (0.5 * (r->velocity[a] + r->velocity[b]) -
              moved) / w);
    }
  }
}

static void
test_swing (gconstpointer data)
{
  const Case *c = data;
  const gdouble w = 2. * G_PI * c->hz;
  gdouble times[N_FRAMES], y[3 * N_FRAMES], velocity[3 * N_FRAMES];
  ClothRecording r = {.n = 1,.n_frames = N_FRAMES,.times = times,.y = y,
    .velocity = velocity
  };
  gdouble place[2], speed[2];

  for (guint f = 0; f < N_FRAMES; f++) {
    times[f] = (f + c->jitter * sin (7. * f)) / FPS;
    for (guint k = 0; k < 3; k++)
      y[3 * f + k] = sin (w * times[f] + k);
  }
  cloth_recording_straighten (&r, NULL);
  find_errors (&r, w, &place[0], &speed[0]);
  cloth_recording_straighten (&r, y);
  find_errors (&r, w, &place[1], &speed[1]);
  g_test_message ("%g Hz: places off by %.2g, speeds %.2g; as it moves: %.2g, "
      "%.2g", c->hz, place[0], speed[0], place[1], speed[1]);
  g_assert_cmpfloat (speed[0], >, c->least_without);
  g_assert_cmpfloat (speed[1], <, c->most_with);
  g_assert_cmpfloat (place[1], <, c->most_with);
  g_free (r.targets);
}

/* A model that stands still tells nothing of what smoothing takes off: what was there stays. */
static void
test_still (void)
{
  gdouble times[N_FRAMES], y[3 * N_FRAMES], velocity[3 * N_FRAMES];
  gdouble still[3 * N_FRAMES], before[3 * N_FRAMES];
  ClothRecording r = {.n = 1,.n_frames = N_FRAMES,.times = times,.y = y,
    .velocity = velocity
  };

  for (guint f = 0; f < N_FRAMES; f++) {
    times[f] = f / FPS;
    for (guint k = 0; k < 3; k++) {
      y[3 * f + k] = sin (20. * times[f] + k);
      still[3 * f + k] = 0.25 * k;
    }
  }
  cloth_recording_straighten (&r, NULL);
  for (guint i = 0; i < 3 * N_FRAMES; i++)
    before[i] = velocity[i];
  cloth_recording_straighten (&r, still);
  for (guint i = 0; i < 3 * N_FRAMES; i++)
    g_assert_cmpfloat_with_epsilon (velocity[i], before[i], 1e-6);
  g_free (r.targets);
}

/* Cloth that mostly rests has no noise to be seen; places are rounded all the same. */
static void
test_rounding (void)
{
  gdouble y[20 * 6], seen[20 * 2];
  const ClothRecording r = {.n = 2,.n_frames = 20,.y = y,.seen = seen };
  gdouble sigma;

  for (guint f = 0; f < 20; f++)
    for (guint k = 0; k < 6; k++) {
      seen[2 * f + k / 3] = 1.;
      y[6 * f + k] = k == 4 ? sin (f) : 2.;
    }
  sigma = cloth_recording_estimate_sigma (&r);
  /* 2 m in float32: steps of 2⁻²², of even distribution */
  g_assert_cmpfloat_with_epsilon (sigma, ldexp (1., -22) / sqrt (12.), 1e-12);
  memset (seen, 0, sizeof seen);
  g_assert_true (isnan (cloth_recording_estimate_sigma (&r)));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = g_strdup_printf ("/straighten/%g-Hz%s",
        cases[i].hz, cases[i].jitter > 0. ? "-jittered" : "");

    g_test_add_data_func (path, &cases[i], test_swing);
  }
  g_test_add_func ("/straighten/rounding", test_rounding);
  g_test_add_func ("/straighten/still", test_still);
  return g_test_run ();
}
