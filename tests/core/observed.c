/* Recordings made of what cameras saw alone: a simulated sheet of another force model, filmed by
 * one camera to eight.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/nudge/nudge.h"
#include "gst/gap/diagnose.h"
#include "tests/common/gapfilm.h"
#include "tests/common/gaprecord.h"

#define LANES(name) extern const ClothEffect cloth_effect_##name;
#include "gst/effect/list.h"

#define COLUMNS 9
#define ROWS 10
#define N (COLUMNS * ROWS)
#define N_FRAMES 60
#define FPS 50.
#define NOISE_PX 0.3
#define GAIN 100.
/* Of springs that hold the cloth to what was seen, where it is filmed well. */
#define FIRM 25600.

static const gdouble middle[3] = { 0.15, 0., -0.2 };

static void
sway (guint held, gdouble t, gfloat p[3])
{
  p[0] = (gfloat) (held ? 0.3 : 0.);
  p[1] = (gfloat) (0.06 * (1. - cos (7. * t)));
  p[2] = (gfloat) (held ? 0.02 * sin (9. * t) : 0.);
}

static ClothModel *
model_new (gboolean other)
{
  ClothModel *model = cloth_model_new ();

  model->areal_density = 0.2;
  model->stretch_warp = model->stretch_weft = 120.;
  model->shear = 30.;
  model->bending_warp = model->bending_weft = 2e-5;
  model->damping_stiffness = 1e-3;
  if (other)
    model->force_model = CLOTH_FORCE_MASS_SPRING;
  return model;
}

/* Each camera sees another tenth of the cloth not, for ten frames. */
static gboolean
hide_some (guint camera, guint vertex, guint frame)
{
  return (vertex / 9 + 3 * camera + frame / 10) % 5 < 2;
}

/* The first camera sees one half, the second the other. */
static gboolean
hide_halves (guint camera, guint vertex, guint frame)
{
  return (vertex % COLUMNS < COLUMNS / 2) != (camera == 0);
}

/* Nobody sees the lower two thirds, as if only the upper part were printed. */
static gboolean
hide_below (guint camera, guint vertex, guint frame)
{
  return vertex / COLUMNS >= ROWS / 3;
}

static gboolean
hide_all (guint camera, guint vertex, guint frame)
{
  return TRUE;
}

typedef struct
{
  gchar *parent;
  ClothTake *take;
  gdouble *truth;
  gdouble times[N_FRAMES];
} Scene;

static void
scene_init (Scene * s, const ClothModel * model, gboolean keep_start)
{
  const TestGapSheet sheet = { COLUMNS, ROWS, N_FRAMES, 0.3, 0.34, FPS };
  ClothTake *whole;

  s->parent = g_dir_make_tmp ("cloth-observed-XXXXXX", NULL);
  whole = test_gap_record (&sheet, model, sway, s->parent, "take", 1);
  s->truth = test_gap_positions (whole);
  s->take = test_gap_forget_positions (whole, keep_start);
  cloth_take_free (whole);
  for (guint f = 0; f < N_FRAMES; f++)
    s->times[f] = f / FPS;
}

static void
scene_clear (Scene * s)
{
  cloth_take_free (s->take);
  g_free (s->truth);
  test_gap_remove (s->parent);
  g_free (s->parent);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Scene, scene_clear);

static ClothObservations *
film (const Scene * s, const TestGapFilming * filming)
{
  g_autoptr (ClothRig) rig = test_gap_ring (filming->n_cameras, middle);

  return test_gap_film (rig, rig, s->truth, s->times, N_FRAMES, N, filming, 5);
}

static ClothRecording *
observe_by (gdouble gain, const Scene * s,
    const ClothObservations * observations, ClothObservedCounts * counts,
    GError ** error)
{
  g_autoptr (ClothModel) model = model_new (FALSE);
  const ClothRolloutOptions options = {.threads = 1 };

  return cloth_recording_new_observed (s->take, observations, model, gain,
      &options, counts, error);
}

static ClothRecording *
observe (const Scene * s, const ClothObservations * observations,
    ClothObservedCounts * counts, GError ** error)
{
  return observe_by (GAIN, s, observations, counts, error);
}

/* Mean square of the errors over their deviations, of what is known; RMS of the errors along lone
 * rays. */
static void
compare (const Scene * s, const ClothRecording * r, gdouble * chi_square,
    gdouble * along)
{
  gdouble sum = 0., blind = 0., n = 0., n_blind = 0.;

  for (gsize at = 0; at < N * N_FRAMES; at++) {
    const gdouble *draw = r->noise->draw + 6 * at;
    const gboolean lone = draw[0] + draw[1] + draw[2] < 2.5;
    gdouble off[3], across[3], white[3], part = 0.;

    if (r->seen[at] == 0.)
      continue;
    for (guint k = 0; k < 3; k++)
      across[k] = off[k] = s->truth[3 * at + k] - r->y[3 * at + k];
    cloth_recording_cut_blind (r, at, across);
    for (guint k = 0; k < 3; k++)
      part += (off[k] - across[k]) * (off[k] - across[k]);
    cloth_recording_whiten (r, at, off, white);
    sum += white[0] * white[0] + white[1] * white[1] + white[2] * white[2];
    n += lone ? 2. : 3.;
    blind += part;
    n_blind += lone;
  }
  *chi_square = sum / n;
  *along = sqrt (blind / fmax (n_blind, 1.));
}

/* The errors are what the covariances say, across rays and where they meet, by however many
 * cameras. Along lone rays they are the simulation's. */
static void
test_places (void)
{
  g_autoptr (ClothModel) reality = model_new (TRUE);
  const guint numbers[] = { 1, 2, 3, 8 };
  g_auto (Scene) s = { NULL };

  scene_init (&s, reality, TRUE);
  for (guint i = 0; i < G_N_ELEMENTS (numbers); i++) {
    const TestGapFilming filming = { numbers[i], NOISE_PX, hide_some };
    g_autoptr (ClothObservations) observations = film (&s, &filming);
    g_autoptr (GError) error = NULL;
    ClothObservedCounts counts;
    g_autoptr (ClothRecording) r = observe (&s, observations, &counts, &error);
    gdouble chi_square, along;

    g_assert_no_error (error);
    compare (&s, r, &chi_square, &along);
    g_test_message ("%u cameras: %.0f%% triangulated, %.0f%% on lone rays, "
        "chi² %.3f, along rays %.2f mm RMS, sigma %.2f mm", numbers[i],
        100. * counts.triangulated / counts.places,
        100. * counts.single / counts.places, chi_square, 1e3 * along,
        1e3 * r->sigma);
    g_assert_cmpuint (counts.places, ==, N * N_FRAMES);
    /* where it starts the take says better */
    for (guint k = 0; k < 3 * N; k++)
      g_assert_cmpfloat_with_epsilon (r->y[k], s.truth[k], 1e-9);
    g_assert_cmpfloat_with_epsilon (chi_square, 1., 0.06);
    if (numbers[i] == 1) {
      g_assert_cmpuint (counts.triangulated, ==, 0);
      g_assert_cmpfloat_with_epsilon ((gdouble) counts.single / counts.places,
          0.6, 0.01);
      g_assert_cmpfloat (counts.along, >, 0.02);
      g_assert_cmpfloat (counts.along, <, 0.98);
      /* with no ray at all it is off as much as a free run of another force model */
      g_assert_cmpfloat (along, <, 0.02);
    } else if (counts.single) {
      g_assert_cmpfloat (along, <, 0.006);
    }
  }
}

/* Cameras that do not run in step: between their pictures places move on lines. */
static void
test_out_of_step (void)
{
  const gdouble late[] = { 0., 0.007, 0.013 };
  const TestGapFilming filming = { 3, 0.05, NULL, late };
  g_autoptr (ClothModel) reality = model_new (TRUE);
  g_auto (Scene) s = { NULL };
  g_autoptr (ClothObservations) observations = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = NULL;
  ClothObservedCounts counts;
  gdouble square = 0.;

  scene_init (&s, reality, FALSE);
  observations = film (&s, &filming);
  r = observe (&s, observations, &counts, &error);
  g_assert_no_error (error);
  for (gsize i = 3 * N * 5; i < 3 * N * (N_FRAMES - 5); i++)
    square += pow (s.truth[i] - r->y[i], 2.);
  square /= N * (N_FRAMES - 10);
  g_test_message ("%.3f mm RMS", 1e3 * sqrt (square));
  /* it moves by up to 1 m/s: 7 mm in 7 ms */
  g_assert_cmpfloat (sqrt (square), <, 4e-4);
  g_assert_cmpfloat ((gdouble) counts.triangulated / counts.places, >, 0.95);
}

/* No two cameras see the same vertex: without a start nothing says how far away the cloth is, with
 * one the rays do. */
static void
test_start (void)
{
  g_autoptr (ClothModel) reality = model_new (TRUE);
  const TestGapFilming filming = { 2, NOISE_PX, hide_halves };

  for (guint keep = 0; keep < 2; keep++) {
    g_auto (Scene) s = { NULL };
    g_autoptr (ClothObservations) observations = NULL;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRecording) r = NULL;
    ClothObservedCounts counts;

    scene_init (&s, reality, keep);
    observations = film (&s, &filming);
    r = observe (&s, observations, &counts, &error);
    g_assert_cmpuint (counts.triangulated, ==, 0);
    if (keep) {
      g_assert_no_error (error);
      g_assert_cmpuint (counts.single, ==, N * N_FRAMES);
      continue;
    }
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
    g_assert_nonnull (strstr (error->message, "give its places in the first"));
  }
}

/* Two cameras in one place: their rays never meet, and one of them counts. */
static void
test_parallel (void)
{
  const TestGapFilming filming = { 2, NOISE_PX };
  g_autoptr (ClothModel) reality = model_new (TRUE);
  g_autoptr (ClothRig) rig = test_gap_ring (2, middle);
  g_auto (Scene) s = { NULL };
  g_autoptr (ClothObservations) observations = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = NULL;
  ClothObservedCounts counts;
  gdouble chi_square, along;

  scene_init (&s, reality, TRUE);
  memcpy (rig->cameras[1].R, rig->cameras[0].R, sizeof rig->cameras[0].R);
  memcpy (rig->cameras[1].t, rig->cameras[0].t, sizeof rig->cameras[0].t);
  observations = test_gap_film (rig, rig, s.truth, s.times, N_FRAMES, N,
      &filming, 5);
  r = observe (&s, observations, &counts, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (counts.triangulated, ==, 0);
  g_assert_cmpuint (counts.single, ==, N * N_FRAMES);
  compare (&s, r, &chi_square, &along);
  g_assert_cmpfloat_with_epsilon (chi_square, 1., 0.06);
}

/* Fills the pixels whose centres lie in a triangle. */
static void
fill (gdouble corners[3][2], const ClothCamera * camera, guint8 * mask)
{
  const gdouble *a = corners[0], *b = corners[1], *c = corners[2];
  const gdouble area = (b[0] - a[0]) * (c[1] - a[1]) -
      (b[1] - a[1]) * (c[0] - a[0]);
  const gint left = (gint) floor (fmin (fmin (a[0], b[0]), c[0]));
  const gint right = (gint) ceil (fmax (fmax (a[0], b[0]), c[0]));
  const gint top = (gint) floor (fmin (fmin (a[1], b[1]), c[1]));
  const gint bottom = (gint) ceil (fmax (fmax (a[1], b[1]), c[1]));

  for (gint y = MAX (top, 0); y <= MIN (bottom, camera->height - 1); y++)
    for (gint x = MAX (left, 0); x <= MIN (right, camera->width - 1); x++) {
      gdouble u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) /
          area;
      gdouble v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) /
          area;

      if (u >= 0. && v >= 0. && u + v <= 1.)
        mask[y * camera->width + x] = 1;
    }
}

static void
set_silhouette (ClothObservation * o, const ClothCamera * camera,
    const gdouble * cloth)
{
  g_autofree guint8 *mask = g_malloc0 ((gsize) (camera->width *
          camera->height));
  g_autoptr (GArray) runs = g_array_new (FALSE, FALSE, sizeof (ClothRun));

  for (guint i = 0; i < (COLUMNS - 1) * (ROWS - 1) * 2; i++) {
    const guint at = i / 2 / (COLUMNS - 1) * COLUMNS + i / 2 % (COLUMNS - 1);
    const guint list[2][3] = { {at, at + 1, at + COLUMNS + 1},
    {at, at + COLUMNS + 1, at + COLUMNS}
    };
    gdouble corners[3][2];

    for (guint k = 0; k < 3; k++)
      g_assert_true (cloth_camera_project (camera, cloth + 3 * list[i % 2][k],
              corners[k], NULL, NULL));
    fill (corners, camera, mask);
  }
  for (gint y = 0; y < camera->height; y++)
    for (gint x = 0; x < camera->width; x++) {
      ClothRun run = { (guint16) y, (guint16) x, 0 };

      if (!mask[y * camera->width + x])
        continue;
      while (x < camera->width && mask[y * camera->width + x])
        x++;
      run.end = (guint16) x;
      g_array_append_val (runs, run);
    }
  o->has_silhouette = TRUE;
  o->n_runs = runs->len;
  o->runs = (ClothRun *) (gpointer) g_array_free (g_steal_pointer (&runs),
      FALSE);
}

static void
set_silhouettes (const Scene * s, ClothObservations * observations)
{
  for (guint i = 0; i < observations->list->len; i++) {
    ClothObservation *o = &g_array_index (observations->list,
        ClothObservation, i);

    set_silhouette (o, &observations->rig->cameras[o->camera], s->truth +
        3 * N * (gsize) lrint (o->time_s * FPS));
  }
}

/* RMS of what nobody saw in its last two thirds. */
static gdouble
find_hidden_error (const Scene * s, const ClothRecording * r)
{
  g_autoptr (ClothModel) model = model_new (FALSE);
  const ClothRolloutOptions options = {.threads = 1 };
  g_autofree gdouble *x = g_new (gdouble, 3 * N * N_FRAMES);
  gdouble square = 0., n = 0.;
  gboolean sound;

  g_assert_true (cloth_rollout_follow (&r, 1, model, FIRM, &options, x, &sound,
          NULL));
  g_assert_true (sound);
  for (gsize at = N * N_FRAMES / 3; at < N * N_FRAMES; at++) {
    if (!hide_below (0, at % N, 0))
      continue;
    for (guint k = 0; k < 3; k++)
      square += pow (x[3 * at + k] - s->truth[3 * at + k], 2.);
    n++;
  }
  return sqrt (square / n);
}

/* A wind that the model lacks moves a cloth of which only the upper third is printed: silhouettes, filled
 * here triangle by triangle, tell where the rest is. */
static void
test_silhouettes (void)
{
  const TestGapFilming filming = { 3, NOISE_PX, hide_below };
  gdouble wind[CLOTH_EFFECT_MAX_PARAMETERS], errors[2];
  g_autoptr (ClothModel) reality = model_new (TRUE);
  g_auto (Scene) s = { NULL };

  for (guint k = 0; k < cloth_effect_wind.n_parameters; k++)
    wind[k] = cloth_effect_wind.parameters[k].null_value;
  wind[0] = 0.2;
  wind[1] = 0.4;
  cloth_model_set_effect (reality, &cloth_effect_wind, wind);
  scene_init (&s, reality, FALSE);
  for (guint with = 0; with < 2; with++) {
    g_autoptr (ClothObservations) observations = film (&s, &filming);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRecording) r = NULL;
    ClothObservedCounts counts;

    if (with)
      set_silhouettes (&s, observations);
    r = observe_by (FIRM, &s, observations, &counts, &error);
    g_assert_no_error (error);
    errors[with] = find_hidden_error (&s, r);
    g_test_message ("%s silhouettes: %.2f mm RMS of what nobody saw, %.0f%% of "
        "all places on outlines", with ? "with" : "without",
        1e3 * errors[with], 100. * counts.outlined / counts.places);
    g_assert_cmpuint (counts.outlined > 0, ==, with);
  }
  g_assert_cmpfloat (errors[1], <, 0.5 * errors[0]);
}

static void
expect_unobserved (const Scene * s, const ClothObservations * observations,
    const gchar * text)
{
  g_autoptr (GError) error = NULL;
  ClothObservedCounts counts;

  g_assert_null (observe (s, observations, &counts, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
  g_test_message ("%s", error->message);
  g_assert_nonnull (strstr (error->message, text));
}

/* A camera whose clock is another one is named, and not left out; so are cameras of another rig, and frames that
 * cameras are too slow for. */
static void
test_mistakes (void)
{
  g_autoptr (ClothModel) reality = model_new (TRUE);
  const TestGapFilming filming = { 2, NOISE_PX, NULL };
  g_auto (Scene) s = { NULL };
  g_autoptr (ClothRig) rig = test_gap_ring (2, middle);
  g_autoptr (ClothRig) turned = test_gap_ring (2, middle);
  gdouble half[3 * N * (N_FRAMES / 2)], times[N_FRAMES / 2];

  scene_init (&s, reality, FALSE);
  {
    g_autoptr (ClothObservations) observations = film (&s, &filming);

    for (guint i = 0; i < observations->list->len; i++) {
      ClothObservation *o = &g_array_index (observations->list,
          ClothObservation, i);

      o->time_s += o->camera == 1 ? 100. : 0.;
    }
    expect_unobserved (&s, observations, "“cam1” are from 100.000");
  }
  /* one that looks the other way */
  for (guint k = 0; k < 3; k++) {
    turned->cameras[1].R[k] *= -1.;
    turned->cameras[1].R[6 + k] *= -1.;
  }
  turned->cameras[1].t[0] *= -1.;
  turned->cameras[1].t[2] *= -1.;
  {
    g_autoptr (ClothObservations) observations = test_gap_film (turned, rig,
        s.truth, s.times, N_FRAMES, N, &filming, 5);

    expect_unobserved (&s, observations, "rays meet nowhere");
  }
  for (guint f = 0; f < N_FRAMES / 2; f++) {
    times[f] = s.times[2 * f];
    memcpy (half + 3 * N * f, s.truth + 6 * N * f, 3 * N * sizeof *half);
  }
  {
    g_autoptr (ClothObservations) observations = test_gap_film (rig, rig, half,
        times, N_FRAMES / 2, N, &filming, 5);

    expect_unobserved (&s, observations, "rate of its cameras");
  }
}

static void
test_nothing (void)
{
  g_autoptr (ClothModel) reality = model_new (TRUE);
  const TestGapFilming filming = { 2, NOISE_PX, hide_all };
  g_auto (Scene) s = { NULL };
  g_autoptr (ClothObservations) observations = NULL;
  g_autoptr (GError) error = NULL;
  ClothObservedCounts counts;
  gfloat row[3 * N];

  scene_init (&s, reality, TRUE);
  observations = film (&s, &filming);
  g_assert_null (observe (&s, observations, &counts, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
  g_assert_nonnull (strstr (error->message, "no camera saw"));
  g_clear_error (&error);

  /* a file of times that promises more than memory holds */
  {
    g_autofree gchar *path = g_build_filename (cloth_take_get_folder (s.take),
        "take.json", NULL);
    g_autofree gchar *start = g_build_filename (cloth_take_get_folder (s.take),
        "positions.npy", NULL);
    g_autoptr (ClothTake) large = NULL;
    g_autoptr (ClothModel) model = model_new (FALSE);
    const ClothRolloutOptions options = {.threads = 1 };

    g_assert_true (g_file_set_contents (path, "{\"version\": 1, \"name\": "
            "\"large\", \"fps\": 50, \"grid\": {\"columns\": 1000, \"rows\": "
            "900, \"width_m\": 1, \"height_m\": 1}, \"held\": [{\"vertex\": 0}, "
            "{\"vertex\": 8}]}", -1, NULL));
    g_remove (start);
    large = cloth_take_open (cloth_take_get_folder (s.take), &error);
    g_assert_no_error (error);
    g_assert_null (cloth_recording_new_observed (large, observations, model,
            GAIN, &options, &counts, &error));
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
    g_assert_nonnull (strstr (error->message, "shorter ones"));
    g_clear_error (&error);
  }

  /* who asks for positions is told where they went */
  g_assert_cmpuint (cloth_take_get_n_positions (s.take), ==, 1);
  g_assert_cmpuint (cloth_take_get_n_frames (s.take), ==, N_FRAMES);
  g_assert_true (cloth_take_read_positions (s.take, 0, row, &error));
  g_assert_false (cloth_take_read_positions (s.take, 1, row, &error));
  g_assert_nonnull (strstr (error->message, "only what cameras saw"));
}

/* A take's covariances: alike everywhere they are one deviation; where one is not known nothing was
 * seen; one that is none is an error that names the place. */
static void
test_covariances (void)
{
  const TestGapSheet sheet = { COLUMNS, ROWS, N_FRAMES, 0.3, 0.34, FPS };
  const gfloat square = 4e-6f;
  g_autoptr (ClothModel) reality = model_new (TRUE);

  for (guint fault = 0; fault < 3; fault++) {
    g_autofree gchar *parent = g_dir_make_tmp ("cloth-covariance-XXXXXX", NULL);
    g_autofree gchar *folder = g_build_filename (parent, "with", NULL);
    g_autoptr (ClothTake) from = test_gap_record (&sheet, reality, sway, parent,
        "take", 1);
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (ClothTakeWriter) writer = NULL;
    g_autoptr (ClothRecording) r = NULL;
    g_autoptr (GError) error = NULL;
    gfloat positions[3 * N], covariances[6 * N], clamps[6];
    guint8 states[N];

    writer = cloth_take_writer_new (folder, cloth_take_get_info (from),
        cloth_take_get_topology (from), &error);
    g_assert_no_error (error);
    memset (states, CLOTH_VERTEX_MEASURED, N);
    for (guint f = 0; f < N_FRAMES; f++) {
      cloth_take_read_positions (from, f, positions, NULL);
      cloth_take_read_clamps (from, f, clamps, NULL);
      for (guint i = 0; i < 6 * N; i++)
        covariances[i] = i % 6 == 0 || i % 6 == 3 || i % 6 == 5 ? square : 0;
      if (f == 7 && fault == 1)
        for (guint k = 0; k < 6; k++)
          covariances[6 * 20 + k] = NAN;
      if (f == 7 && fault == 2)
        covariances[6 * 20 + 1] = 2 * square;
      cloth_take_writer_append (writer, f / FPS, positions, states,
          covariances, clamps, &error);
      g_assert_no_error (error);
    }
    cloth_take_writer_close (writer, &error);
    g_assert_no_error (error);
    take = cloth_take_open (folder, &error);
    r = cloth_recording_new (take, &error);
    test_gap_remove (parent);
    if (fault == 2) {
      g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
      g_assert_nonnull (strstr (error->message, "vertex 20 in frame 7"));
      continue;
    }
    g_assert_no_error (error);
    g_assert_cmpfloat_with_epsilon (r->sigma, 0.002, 1e-8);
    g_assert_cmpfloat_with_epsilon (cloth_recording_noise_square (r), 1.2e-5,
        1e-10);
    g_assert_cmpfloat (r->seen[7 * N + 20], ==, fault == 0 ? 1. : 0.);
    g_assert_cmpfloat (r->seen[7 * N + 21], ==, 1.);
  }
}

/* Drag that the model lacks is named from rays alone, and from a third of the cloth and its outline. */
static void
test_diagnosis (void)
{
  static const gchar *const effects[] = { "air_drag", "wind", "gravity_tilt",
    "bending", "areal_mass", "damping_mass", NULL
  };
  const gdouble drag = 1.5;
  const guint numbers[] = { 1, 3, 3 };
  g_autoptr (ClothModel) model = model_new (FALSE);

  for (guint i = 0; i < G_N_ELEMENTS (numbers); i++) {
    const TestGapFilming filming = { numbers[i], NOISE_PX,
      i == 2 ? hide_below : hide_some
    };
    g_autoptr (ClothModel) reality = model_new (TRUE);
    g_auto (Scene) s = { NULL }, alone = { NULL };
    g_autoptr (ClothObservations) observations = NULL, baseline = NULL;
    g_autoptr (ClothGapResult) result = NULL;
    g_autoptr (GError) error = NULL;
    ClothGapOptions options = {.effects = effects,.threads = 2 };

    scene_init (&alone, reality, TRUE);
    baseline = film (&alone, &filming);
    cloth_model_set_effect (reality, &cloth_effect_air_drag, &drag);
    scene_init (&s, reality, TRUE);
    observations = film (&s, &filming);
    if (i == 2) {
      set_silhouettes (&alone, baseline);
      set_silhouettes (&s, observations);
    }
    options.observations = &observations;
    options.baselines = &alone.take;
    options.n_baselines = 1;
    options.baseline_observations = &baseline;
    result = cloth_gap_diagnose (&s.take, 1, model, &options, &error);
    g_assert_no_error (error);
    for (guint k = 0; k < 3; k++) {
      const ClothGapEffect *e = &g_array_index (result->effects,
          ClothGapEffect, k);

      g_test_message ("%u cameras: %s p %.3g, %.3g ± %.2g %s", numbers[i],
          e->effect->id, e->probability, e->values[0], e->sigmas[0],
          e->accepted ? "accepted" : "");
    }
    g_assert_cmpstr (g_array_index (result->effects, ClothGapEffect,
            0).effect->id, ==, "air_drag");
    g_assert_true (g_array_index (result->effects, ClothGapEffect, 0).accepted);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/observed/places", test_places);
  g_test_add_func ("/observed/out-of-step", test_out_of_step);
  g_test_add_func ("/observed/start", test_start);
  g_test_add_func ("/observed/parallel", test_parallel);
  g_test_add_func ("/observed/silhouettes", test_silhouettes);
  g_test_add_func ("/observed/mistakes", test_mistakes);
  g_test_add_func ("/observed/nothing", test_nothing);
  g_test_add_func ("/observed/covariances", test_covariances);
  g_test_add_func ("/observed/diagnosis", test_diagnosis);
  return g_test_run ();
}
