/* Camera and image effects on moving points, against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

#include <math.h>
#include <string.h>

#include "gst/rig/rig.h"
#include "tests/common/captureeffects.h"

#define POINTS 5
#define FRAMES 6
#define FPS 50.0
#define FOCAL 1000.0
#define DEPTH 2.0

/* Looks along +y from the origin, z up: (x, y, z) is seen at f·(x, −z)/y. */
static const ClothCamera camera = { NULL, 1281, 961,
  {FOCAL, 0, 640, 0, FOCAL, 480, 0, 0, 1}, CLOTH_LENS_NONE, {0},
  {1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0, 0}
};

typedef struct
{
  gdouble times[FRAMES], positions[FRAMES][3 * POINTS];
  const gdouble *frames[FRAMES];
  ClothMotion motion;
} Scene;

static const gdouble start[POINTS][2] = { {0, 0}, {0.5, 0.3}, {-0.4, 0.2},
{0.1, -0.6}, {-0.7, -0.5}
};

/* Points in the plane y = DEPTH that all move with the velocity (vx, 0, vz). */
static void
scene_init (Scene * scene, gdouble vx, gdouble vz)
{
  for (gint f = 0; f < FRAMES; f++) {
    scene->times[f] = f / FPS;
    scene->frames[f] = scene->positions[f];
    for (gint i = 0; i < POINTS; i++) {
      scene->positions[f][3 * i] = start[i][0] + vx * f / FPS;
      scene->positions[f][3 * i + 1] = DEPTH;
      scene->positions[f][3 * i + 2] = start[i][1] + vz * f / FPS;
    }
  }
  scene->motion = (ClothMotion) {
  POINTS, FRAMES, scene->times, scene->frames};
}

static void
observe (const gchar * effects, const Scene * scene, gdouble time_s,
    gdouble * px, gdouble * covariances)
{
  ClothCapture capture;
  GError *error = NULL;

  cloth_capture_init (&capture, &camera);
  capture.target.dot_radius_m = 0.006;
  cloth_capture_add_effects (&capture, effects, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (cloth_capture_observe (&capture, &scene->motion, time_s,
          px, covariances), ==, POINTS);
}

/* Every effect at its null is not there, whatever else acts. */
static void
test_null (void)
{
  static const gchar *const others[] = { NULL,
    "lens_distortion,k1=-0.1; focal_length,error=0.01; "
        "extrinsic_drift,tilt=0.01,roll=0.02; sync_offset,seconds=0.003; "
        "rolling_shutter,seconds=0.013; frame_drop,rate=0.3; "
        "motion_blur,exposure=0.007; defocus,sigma=1.3; "
        "shading_shift,x=0.003,y=0.001; colour_crosstalk,share=0.13; "
        "noise,sigma=3.1,shot=0.7"
  };
  const ClothEffect *effect;
  Scene scene;
  guint n = 0;

  scene_init (&scene, 1.1, -0.7);
  for (guint i = 0; (effect = capture_effects[i]); i++, n++) {
    for (guint o = 0; o < G_N_ELEMENTS (others); o++) {
      gdouble values[CLOTH_EFFECT_MAX_PARAMETERS], px[2][2 * POINTS];
      gdouble cov[2][3 * POINTS];
      ClothCapture capture[2];

      for (guint k = 0; k < effect->n_parameters; k++)
        values[k] = effect->parameters[k].null_value;
      for (guint k = 0; k < 2; k++) {
        memset (&capture[k], 0, sizeof capture[k]);
        cloth_capture_init (&capture[k], &camera);
        g_assert_true (cloth_capture_add_effects (&capture[k], others[o],
                NULL));
      }
      g_assert_true (cloth_capture_add_effect (&capture[1], effect->id,
              values, NULL));
      g_assert_cmpmem (&capture[0], sizeof capture[0], &capture[1],
          sizeof capture[1]);
      for (guint k = 0; k < 2; k++)
        cloth_capture_observe (&capture[k], &scene.motion, 0.031, px[k],
            cov[k]);
      g_assert_cmpmem (px[0], sizeof px[0], px[1], sizeof px[1]);
      g_assert_cmpmem (cov[0], sizeof cov[0], cov[1], sizeof cov[1]);
    }
  }
  g_assert_cmpuint (n, ==, 11);
}

/* Without effects: the plain projection to the bit, and nothing added. */
static void
test_nothing (void)
{
  gdouble px[2 * POINTS], cov[3 * POINTS];
  Scene scene;

  scene_init (&scene, 1.1, -0.7);
  observe (NULL, &scene, scene.times[2], px, cov);
  for (gint i = 0; i < POINTS; i++) {
    gdouble plain[2];

    g_assert_true (cloth_camera_project (&camera,
            scene.positions[2] + 3 * i, plain, NULL, NULL));
    g_assert_cmpmem (plain, sizeof plain, px + 2 * i, sizeof plain);
    for (gint k = 0; k < 3; k++)
      g_assert_cmpfloat (cov[3 * i + k], ==, 0);
  }
}

/* Every parameter at its prior moves a point or widens its scatter, and a third of it by
 * about a third: derivatives are worth something. Noise and blurs count by their square. */
static void
test_each_acts (void)
{
  const ClothEffect *effect;
  Scene scene;

  scene_init (&scene, 1.1, -0.7);
  for (guint i = 0; (effect = capture_effects[i]); i++) {
    g_assert_nonnull (effect->blurb);
    g_assert_nonnull (effect->source);
    g_assert_nonnull (effect->regressor);
    for (guint k = 0; k < effect->n_parameters; k++) {
      const ClothEffectParameter *p = &effect->parameters[k];
      gdouble moved[2] = { 0, 0 };

      g_assert_cmpfloat (p->min, <=, p->null_value);
      g_assert_cmpfloat (p->max, >, p->null_value);
      g_assert_cmpfloat (p->prior, >, 0);
      g_assert_cmpint (p->one_sided, ==, p->min == p->null_value);
      for (gint size = 0; size < 2; size++) {
        g_autofree gchar *text = g_strdup_printf ("%s,%s=%.17g", effect->id,
            p->name, p->null_value + p->prior / (size ? 1 : 3));
        gdouble px[2][2 * POINTS], cov[3 * POINTS];

        observe (NULL, &scene, 0.04, px[0], NULL);
        observe (text, &scene, 0.04, px[1], cov);
        for (gint j = 0; j < 2 * POINTS; j++)
          moved[size] += fabs (px[1][j] - px[0][j]);
        for (gint j = 0; j < 3 * POINTS; j++)
          moved[size] += fabs (cov[j]);
      }
      g_test_message ("%s %s: %g, a third %g", effect->id, p->name, moved[1],
          moved[0]);
      g_assert_cmpfloat (moved[0], >, 1e-5);
      g_assert_cmpfloat (moved[1] / moved[0], >, 2);
      g_assert_cmpfloat (moved[1] / moved[0], <, 10);
    }
  }
}

/* Where all points are, and their scatter, with an effect at its prior and @more of it. */
static void
at_work (const ClothEffect * effect, guint which, gdouble more, Scene * scene,
    gdouble all[5 * POINTS])
{
  GString *text = g_string_new (effect->id);

  for (guint k = 0; k < effect->n_parameters; k++) {
    const ClothEffectParameter *p = &effect->parameters[k];
    gdouble value = p->null_value + p->prior * (1 + (k == which ? more : 0));

    g_string_append_printf (text, ",%s=%.17g", p->name, value);
  }
  observe (text->str, scene, 0.04, all, all + 2 * POINTS);
  g_string_free (text, TRUE);
}

/* Finite differences of 1e-3 and 1e-5 of the prior agree. */
static void
test_derivatives (void)
{
  const ClothEffect *effect;
  Scene scene;

  scene_init (&scene, 1.1, -0.7);
  for (guint i = 0; (effect = capture_effects[i]); i++)
    for (guint k = 0; k < effect->n_parameters; k++) {
      gdouble at[3][5 * POINTS], apart = 0, size = 0;

      at_work (effect, k, 0, &scene, at[0]);
      at_work (effect, k, 1e-3, &scene, at[1]);
      at_work (effect, k, 1e-5, &scene, at[2]);
      for (gint j = 0; j < 5 * POINTS; j++) {
        gdouble coarse = (at[1][j] - at[0][j]) / 1e-3;
        gdouble fine = (at[2][j] - at[0][j]) / 1e-5;

        apart += (coarse - fine) * (coarse - fine);
        size += fine * fine;
      }
      g_test_message ("%s %s: steps disagree by %.5f", effect->id,
          effect->parameters[k].name, sqrt (apart / size));
      g_assert_cmpfloat (size, >, 0);
      g_assert_cmpfloat (sqrt (apart / size), <, 0.1);
    }
}

static void
test_time (void)
{
  const gdouble vx = 1.2, vz = -0.8, readout = 0.02, exposure = 0.012;
  const gdouble w[2] = { FOCAL * vx / DEPTH, -FOCAL * vz / DEPTH };
  gdouble plain[2 * POINTS], px[2 * POINTS], cov[3 * POINTS];
  Scene scene;

  scene_init (&scene, vx, vz);
  observe (NULL, &scene, 0.04, plain, NULL);

  observe ("sync_offset,seconds=0.013", &scene, 0.04, px, NULL);
  for (gint i = 0; i < 2 * POINTS; i++)
    g_assert_cmpfloat_with_epsilon (px[i], plain[i] - 0.013 * w[i % 2], 1e-9);

  /* The row y that is read at the time at which the point is there:
   * y = y0 + w·readout·y/(h − 1). */
  observe ("rolling_shutter,seconds=0.02", &scene, 0.04, px, NULL);
  for (gint i = 0; i < POINTS; i++) {
    const gdouble y = plain[2 * i + 1] / (1 - w[1] * readout / 960);

    g_assert_cmpfloat_with_epsilon (px[2 * i + 1], y, 1e-8);
    g_assert_cmpfloat_with_epsilon (px[2 * i],
        plain[2 * i] + w[0] * readout * y / 960, 1e-8);
  }

  observe ("motion_blur,exposure=0.012", &scene, 0.04, px, cov);
  for (gint i = 0; i < 2 * POINTS; i++)
    g_assert_cmpfloat_with_epsilon (px[i], plain[i] + exposure / 2 * w[i % 2],
        1e-9);
  for (gint i = 0; i < POINTS; i++) {
    /* Along the way b grows from 0.7 to √(0.7² + (e·|w|)²/12); across it stays. */
    const gdouble speed = hypot (w[0], w[1]);
    const gdouble scale = 4 * 2 * sqrt (G_PI) / (150 * 150 * 10);
    const gdouble more = scale * (sqrt (0.49 + pow (exposure * speed,
                2) / 12) - 0.7);

    g_assert_cmpfloat_with_epsilon (cov[3 * i],
        more * pow (w[0] / speed, 2), 1e-12);
    g_assert_cmpfloat_with_epsilon (cov[3 * i + 1],
        more * w[0] * w[1] / (speed * speed), 1e-12);
    g_assert_cmpfloat_with_epsilon (cov[3 * i + 2],
        more * pow (w[1] / speed, 2), 1e-12);
  }

  /* Lost in a row: a geometric distribution of mean r/(1 − r). */
  observe ("frame_drop,rate=0.2", &scene, 0.06, px, cov);
  observe (NULL, &scene, 0.06, plain, NULL);
  for (gint i = 0; i < POINTS; i++) {
    g_assert_cmpfloat_with_epsilon (px[2 * i], plain[2 * i] - w[0] * 0.25
        / FPS, 1e-9);
    g_assert_cmpfloat_with_epsilon (cov[3 * i], w[0] * w[0] * 0.2 / 0.64
        / (FPS * FPS), 1e-9);
  }
}

static void
test_geometry (void)
{
  gdouble plain[2 * POINTS], px[2 * POINTS];
  const gdouble r = 0.006 * FOCAL / DEPTH, angle = 0.03;
  Scene scene;

  scene_init (&scene, 0, 0);
  observe (NULL, &scene, 0, plain, NULL);

  observe ("focal_length,error=0.02", &scene, 0, px, NULL);
  for (gint i = 0; i < POINTS; i++) {
    g_assert_cmpfloat_with_epsilon (px[2 * i] - 640,
        1.02 * (plain[2 * i] - 640), 1e-9);
    g_assert_cmpfloat_with_epsilon (px[2 * i + 1] - 480,
        1.02 * (plain[2 * i + 1] - 480), 1e-9);
  }

  observe ("lens_distortion,k1=-0.1,k2=0.02", &scene, 0, px, NULL);
  for (gint i = 0; i < POINTS; i++) {
    const gdouble x = start[i][0] / DEPTH, y = -start[i][1] / DEPTH;
    const gdouble r2 = x * x + y * y;
    const gdouble bend = 1 - 0.1 * r2 + 0.02 * r2 * r2;

    g_assert_cmpfloat_with_epsilon (px[2 * i], 640 + FOCAL * x * bend, 1e-9);
    g_assert_cmpfloat_with_epsilon (px[2 * i + 1], 480 + FOCAL * y * bend,
        1e-9);
  }

  /* The first point is on the axis: looking right moves it left, looking up down. */
  observe ("extrinsic_drift,pan=0.03", &scene, 0, px, NULL);
  g_assert_cmpfloat_with_epsilon (px[0], 640 - FOCAL * tan (angle), 1e-9);
  g_assert_cmpfloat_with_epsilon (px[1], 480, 1e-9);
  observe ("extrinsic_drift,tilt=0.03", &scene, 0, px, NULL);
  g_assert_cmpfloat_with_epsilon (px[1], 480 + FOCAL * tan (angle), 1e-9);
  /* Counter-clockwise: what is on the right goes up. */
  observe ("extrinsic_drift,roll=0.03", &scene, 0, px, NULL);
  for (gint i = 0; i < POINTS; i++) {
    const gdouble x = plain[2 * i] - 640, y = plain[2 * i + 1] - 480;

    g_assert_cmpfloat_with_epsilon (px[2 * i], 640 + cos (angle) * x
        + sin (angle) * y, 1e-9);
    g_assert_cmpfloat_with_epsilon (px[2 * i + 1], 480 - sin (angle) * x
        + cos (angle) * y, 1e-9);
  }

  observe ("shading_shift,x=0.01,y=-0.004", &scene, 0, px, NULL);
  for (gint i = 0; i < POINTS; i++) {
    g_assert_cmpfloat_with_epsilon (px[2 * i] - plain[2 * i],
        0.01 * r * r / 4, 1e-9);
    g_assert_cmpfloat_with_epsilon (px[2 * i + 1] - plain[2 * i + 1],
        -0.004 * r * r / 4, 1e-9);
  }
}

static void
test_scatter (void)
{
  const gdouble unit = 2 * sqrt (G_PI) / (150 * 150 * 10);
  gdouble px[2 * POINTS], cov[3 * POINTS];
  Scene scene;

  scene_init (&scene, 0, 0);
  observe ("noise,sigma=3", &scene, 0, px, cov);
  g_assert_cmpfloat_with_epsilon (cov[0], unit * 0.7 * 9, 1e-12);
  g_assert_cmpfloat_with_epsilon (cov[1], 0, 1e-12);
  observe ("noise,shot=3", &scene, 0, px, cov);
  g_assert_cmpfloat_with_epsilon (cov[2], unit * 0.7 * 4.5, 1e-12);
  observe ("defocus,sigma=2.4", &scene, 0, px, cov);
  g_assert_cmpfloat_with_epsilon (cov[0], unit * 4 * (2.5 - 0.7), 1e-12);
  observe ("colour_crosstalk,share=0.3", &scene, 0, px, cov);
  g_assert_cmpfloat_with_epsilon (cov[0],
      unit * 0.7 * 4 * (1 / pow (1 - 0.45, 2) - 1), 1e-12);
}

static void
test_drops (void)
{
  ClothCapture capture;
  guint lost = 0, same = 0, pairs = 0;

  cloth_capture_init (&capture, &camera);
  for (guint64 f = 0; f < 100; f++)
    g_assert_false (cloth_capture_is_dropped (&capture, f, 1));
  g_assert_true (cloth_capture_add_effects (&capture, "frame_drop,rate=0.2",
          NULL));
  for (guint64 f = 1; f <= 100000; f++) {
    const gboolean now = cloth_capture_is_dropped (&capture, f, 7);

    lost += now;
    same += now == cloth_capture_is_dropped (&capture, f, 8);
    pairs += now && cloth_capture_is_dropped (&capture, f + 1, 7);
  }
  /* five standard deviations */
  g_assert_cmpint (ABS ((gint) lost - 20000), <, 5 * 127);
  g_assert_cmpint (ABS ((gint) same - 68000), <, 5 * 148);
  g_assert_cmpint (ABS ((gint) pairs - 4000), <, 5 * 75);
}

/* A parabola between frames at uneven times; straight lines beyond both ends. */
static void
test_motion (void)
{
  static const gdouble times[] = { 1, 1.1, 1.25, 1.3, 1.5 };
  gdouble positions[5][6], at[3], v[3];
  const gdouble *frames[5];
  ClothMotion motion = { 2, 5, times, frames };

  for (gint f = 0; f < 5; f++) {
    const gdouble t = times[f];

    frames[f] = positions[f];
    positions[f][0] = 3 * t * t - 2 * t + 1;
    positions[f][1] = -t * t;
    positions[f][2] = t;
    for (gint k = 3; k < 6; k++)
      positions[f][k] = f == 2 ? NAN : t;
  }
  for (gdouble t = 1.1; t < 1.3; t += 0.01) {
    cloth_motion_at (&motion, 0, t, at, v);
    g_assert_cmpfloat_with_epsilon (at[0], 3 * t * t - 2 * t + 1, 1e-12);
    g_assert_cmpfloat_with_epsilon (at[1], -t * t, 1e-12);
    g_assert_cmpfloat_with_epsilon (at[2], t, 1e-12);
    g_assert_cmpfloat_with_epsilon (v[0], 6 * t - 2, 1e-10);
    g_assert_cmpfloat_with_epsilon (v[1], -2 * t, 1e-10);
  }
  for (gint f = 0; f < 5; f++) {
    cloth_motion_at (&motion, 0, times[f], at, NULL);
    g_assert_cmpmem (at, sizeof at, positions[f], sizeof at);
  }
  cloth_motion_at (&motion, 0, 0.8, at, v);
  g_assert_cmpfloat_with_epsilon (at[1], -1 + 0.2 * 2.1, 1e-12);
  g_assert_cmpfloat_with_epsilon (v[1], -2.1, 1e-12);
  cloth_motion_at (&motion, 0, 2, at, NULL);
  g_assert_cmpfloat_with_epsilon (at[1], -2.25 - 0.5 * 2.8, 1e-12);
  /* What isn't known stays so, and spoils no neighbour. */
  cloth_motion_at (&motion, 1, 1.25, at, NULL);
  g_assert_true (isnan (at[0]));
  cloth_motion_at (&motion, 1, 1.2, at, NULL);
  g_assert_true (isnan (at[0]));
  cloth_motion_at (&motion, 1, 1.05, at, NULL);
  g_assert_cmpfloat_with_epsilon (at[0], 1.05, 1e-12);
}

static void
test_unseen (void)
{
  gdouble px[2 * POINTS], cov[3 * POINTS];
  ClothCapture capture;
  Scene scene;

  scene_init (&scene, 1, 1);
  for (gint f = 0; f < FRAMES; f++) {
    scene.positions[f][1] = -1;
    scene.positions[f][3] = NAN;
  }
  cloth_capture_init (&capture, &camera);
  g_assert_true (cloth_capture_add_effects (&capture,
          "rolling_shutter,seconds=0.1; noise,sigma=1", NULL));
  g_assert_cmpuint (cloth_capture_observe (&capture, &scene.motion, 0.03, px,
          cov), ==, POINTS - 2);
  for (gint i = 0; i < POINTS; i++) {
    g_assert_cmpint (isnan (px[2 * i]), ==, i < 2);
    g_assert_cmpint (isnan (cov[3 * i + 1]), ==, i < 2);
  }
}

static void
test_refused (void)
{
  static const struct
  {
    const gchar *text, *says;
  } cases[] = {
    {"wind,speed=2", "“wind” is no camera or image effect"},
    {"nois,sigma=2", "noise"},
    {"noise", "say how much"},
    {"noise,sigma", "“sigma” is not name=number"},
    {"noise,sigma=", "use a number"},
    {"noise,sigma=3x", "use a number"},
    {"noise,sigma=nan", "use 0 to 50"},
    {"noise,sigma=-1", "use 0 to 50"},
    {"noise,sigma=1e9", "use 0 to 50"},
    {"noise,sigma=1,sigma=2", "there twice"},
    {"noise,gain=1", "sigma, shot"},
    {"noise,sigma=1; motion_blur,exposure=3", "use 0 to 0.1 s"},
    {"noise,,sigma=1", "not name=number"},
    {",sigma=1", "“” is no camera"},
    {"noise,sigma=1\xff", "UTF-8"}
  };
  g_autofree gchar *long_text = g_strnfill (5000, ';');
  ClothCapture before, capture;
  g_autoptr (GError) error = NULL;

  memset (&before, 0, sizeof before);
  cloth_capture_init (&before, &camera);
  capture = before;
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) fault = NULL;

    g_assert_false (cloth_capture_add_effects (&capture, cases[i].text,
            &fault));
    g_assert_error (fault, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
    g_test_message ("%s", fault->message);
    g_assert_nonnull (strstr (fault->message, cases[i].says));
    g_assert_cmpmem (&capture, sizeof capture, &before, sizeof before);
  }
  g_assert_false (cloth_capture_add_effects (&capture, long_text, &error));
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
  /* What a hand types. */
  g_assert_true (cloth_capture_add_effects (&capture,
          " noise , sigma = 2 ;; sync_offset,seconds=-0.01; ", NULL));
  g_assert_cmpfloat (capture.read_noise, ==, 2);
  g_assert_cmpfloat (capture.camera.offset_s, ==, -0.01);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/capture/derivatives", test_derivatives);
  g_test_add_func ("/capture/null", test_null);
  g_test_add_func ("/capture/nothing", test_nothing);
  g_test_add_func ("/capture/each-acts", test_each_acts);
  g_test_add_func ("/capture/time", test_time);
  g_test_add_func ("/capture/geometry", test_geometry);
  g_test_add_func ("/capture/scatter", test_scatter);
  g_test_add_func ("/capture/drops", test_drops);
  g_test_add_func ("/capture/motion", test_motion);
  g_test_add_func ("/capture/unseen", test_unseen);
  g_test_add_func ("/capture/refused", test_refused);
  return g_test_run ();
}
