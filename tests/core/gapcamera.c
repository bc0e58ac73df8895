/* Faults of cameras against pictures that are made here, with formulas of their own: a
 * waving sheet seen by three cameras, one of which is not as the rig says.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/gap/camera/residuals.h"
#include "gst/gap/camera/solve.h"
#include "gst/gap/diagnose.h"
#include "gst/gap/report/report.h"
#include "gst/math/random.h"

#define COLUMNS 9
#define ROWS 8
#define N (COLUMNS * ROWS)
#define N_FRAMES 60
#define FPS 50.
#define N_CAMERAS 3
#define WIDTH 800
#define HEIGHT 600
#define FOCAL 900.
#define NOISE_PX 0.05

static const gdouble spacing = 0.05;

/* What is wrong with a camera. */
typedef struct
{
  guint camera;
  gdouble late_s, focal, k1, turn[3], rolling_s, exposure_s;
  gboolean repeats;             /* every seventh picture is the one before */
} Fault;

static void
wave (guint vertex, gdouble t, gdouble X[3])
{
  gdouble u = spacing * (vertex % COLUMNS), v = spacing * (vertex / COLUMNS);

  X[0] = u - 0.2 + 0.03 * sin (5. * t + 4. * v);
  X[1] = 0.06 * sin (7. * u + 6. * t) * (0.3 + v) + 0.04 * cos (9. * t);
  X[2] = 0.2 - v + 0.02 * sin (8. * t + 3. * u);
}

/* Cameras on an arc of 1.1 m about the sheet, looking at it: x right, y down, z ahead. */
static void
place_camera (guint camera, gdouble R[9], gdouble t[3])
{
  gdouble angle = 0.6 * ((gdouble) camera - 1.), height = 0.15 * camera;
  gdouble C[3] = { 1.1 * sin (angle), -1.1 * cos (angle), height };
  gdouble z[3] = { -C[0], -C[1], -C[2] }, x[3], y[3], l;

  l = sqrt (z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
  for (guint k = 0; k < 3; k++)
    z[k] /= l;
  l = hypot (z[0], z[1]);
  x[0] = z[1] / l;
  x[1] = -z[0] / l;
  x[2] = 0.;
  y[0] = z[1] * x[2] - z[2] * x[1];
  y[1] = z[2] * x[0] - z[0] * x[2];
  y[2] = z[0] * x[1] - z[1] * x[0];
  memcpy (R, x, sizeof x);
  memcpy (R + 3, y, sizeof y);
  memcpy (R + 6, z, sizeof z);
  for (guint k = 0; k < 3; k++)
    t[k] = -(R[3 * k] * C[0] + R[3 * k + 1] * C[1] + R[3 * k + 2] * C[2]);
}

static ClothRig *
rig_new (void)
{
  ClothRig *rig = cloth_rig_new (N_CAMERAS);

  for (guint c = 0; c < N_CAMERAS; c++) {
    ClothCamera *camera = &rig->cameras[c];

    camera->name = g_strdup_printf ("cam%u", c);
    camera->width = WIDTH;
    camera->height = HEIGHT;
    memset (camera->K, 0, sizeof camera->K);
    camera->K[0] = camera->K[4] = FOCAL;
    camera->K[2] = 0.5 * (WIDTH - 1);
    camera->K[5] = 0.5 * (HEIGHT - 1);
    camera->K[8] = 1.;
    place_camera (c, camera->R, camera->t);
  }
  return rig;
}

/* One vertex at one instant in a camera with a fault. */
static void
see (guint camera, const Fault * f, guint vertex, gdouble t, gdouble px[2])
{
  const gboolean amiss = f && f->camera == camera;
  gdouble R[9], T[3], X[3], x[3], a, b, r2, focal = FOCAL;

  place_camera (camera, R, T);
  wave (vertex, t, X);
  for (guint k = 0; k < 3; k++)
    x[k] = R[3 * k] * X[0] + R[3 * k + 1] * X[1] + R[3 * k + 2] * X[2] + T[k];
  if (amiss) {
    /* the camera has turned by small angles: points turn the other way */
    gdouble y[3] = { x[0], x[1], x[2] };
    const gdouble *w = f->turn;

    x[0] = y[0] - (w[1] * y[2] - w[2] * y[1]);
    x[1] = y[1] - (w[2] * y[0] - w[0] * y[2]);
    x[2] = y[2] - (w[0] * y[1] - w[1] * y[0]);
    focal *= 1. + f->focal;
  }
  a = x[0] / x[2];
  b = x[1] / x[2];
  r2 = a * a + b * b;
  if (amiss) {
    a *= 1. + f->k1 * r2;
    b *= 1. + f->k1 * r2;
  }
  px[0] = focal * a + 0.5 * (WIDTH - 1);
  px[1] = focal * b + 0.5 * (HEIGHT - 1);
}

static void
picture (guint camera, const Fault * f, guint vertex, gdouble t, gdouble px[2])
{
  if (!f || f->camera != camera) {
    see (camera, f, vertex, t, px);
    return;
  }
  t -= f->late_s;
  see (camera, f, vertex, t, px);
  for (guint i = 0; i < 5 && f->rolling_s > 0.; i++)
    see (camera, f, vertex, t + f->rolling_s * px[1] / (HEIGHT - 1), px);
  if (f->exposure_s > 0.) {
    const guint n = 32;
    gdouble sum[2] = { 0. }, one[2];

    for (guint i = 0; i < n; i++) {
      see (camera, f, vertex, t + f->exposure_s * (i + 0.5) / n, one);
      sum[0] += one[0] / n;
      sum[1] += one[1] / n;
    }
    memcpy (px, sum, sizeof sum);
  }
}

/* All that the cameras see; only @n_seeing of them see anything. */
static ClothObservations *
observations_new (const Fault * faults, guint n_faults, guint n_seeing)
{
  ClothObservations *observations = cloth_observations_new (rig_new (), N);
  ClothRandom random;

  cloth_random_init (&random, 11);
  for (guint c = 0; c < n_seeing; c++) {
    const Fault *f = NULL;
    gdouble px[2 * N], covariances[3 * N];
    guint32 vertices[N];

    for (guint k = 0; k < n_faults; k++)
      if (faults[k].camera == c)
        f = &faults[k];
    for (guint frame = 0; frame < N_FRAMES; frame++) {
      const gboolean again = f && f->repeats && frame % 7 == 3;
      g_autoptr (GError) error = NULL;

      for (guint v = 0; v < N; v++) {
        vertices[v] = v;
        if (!again)
          picture (c, f, v, frame / FPS, px + 2 * v);
        for (guint k = 0; k < 2 && !again; k++)
          px[2 * v + k] += NOISE_PX * cloth_random_gaussian (&random);
        covariances[3 * v] = covariances[3 * v + 2] = NOISE_PX * NOISE_PX;
        covariances[3 * v + 1] = 0.;
      }
      cloth_observations_add (observations, c, frame / FPS, N, vertices, px,
          covariances, &error);
      g_assert_no_error (error);
    }
  }
  return observations;
}

/* The sheet as it was, @off metres away along y; it has the noise of the pictures. Columns
 * from @n_columns on are hidden but in every tenth frame. */
static ClothTake *
take_new (gdouble off, guint n_columns, gchar ** folder)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("waves");
  g_autoptr (ClothTopology) topology = cloth_topology_new_grid (COLUMNS, ROWS,
      (gfloat) (spacing * (COLUMNS - 1)), (gfloat) (spacing * (ROWS - 1)));
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-camera-XXXXXX", &error);
  ClothRandom random;
  ClothTake *take;

  *folder = g_build_filename (parent, "take", NULL);
  info->fps = FPS;
  info->columns = COLUMNS;
  info->rows = ROWS;
  info->width_m = spacing * (COLUMNS - 1);
  info->height_m = spacing * (ROWS - 1);
  writer = cloth_take_writer_new (*folder, info, topology, &error);
  g_assert_no_error (error);
  cloth_random_init (&random, 3);
  for (guint f = 0; f < N_FRAMES; f++) {
    gfloat positions[3 * N];
    guint8 states[N];

    memset (states, 1, sizeof states);
    for (guint v = 0; v < N; v++) {
      gdouble X[3];

      wave (v, f / FPS, X);
      X[1] += off;
      states[v] = v % COLUMNS < n_columns || f % 10 == 0;
      for (guint k = 0; k < 3; k++)
        positions[3 * v + k] =
            states[v] ? (gfloat) (X[k] +
            5e-5 * cloth_random_gaussian (&random)) : NAN;
    }
    cloth_take_writer_append (writer, f / FPS, positions, states, NULL, NULL,
        &error);
    g_assert_no_error (error);
  }
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
  take = cloth_take_open (*folder, &error);
  g_assert_no_error (error);
  return take;
}

static void
remove_take (const gchar * folder)
{
  static const gchar *const files[] = {
    "take.json", "positions.npy", "times.npy", "covariance.npy", "clamps.npy",
    "states.npy"
  };
  g_autofree gchar *parent = g_path_get_dirname (folder);

  for (guint i = 0; i < G_N_ELEMENTS (files); i++) {
    g_autofree gchar *path = g_build_filename (folder, files[i], NULL);

    g_unlink (path);
  }
  g_rmdir (folder);
  g_rmdir (parent);
}

static const gchar *const all_effects[] = {
  "lens_distortion", "focal_length", "extrinsic_drift", "sync_offset",
  "rolling_shutter", "motion_blur", "frame_drop", "defocus", "shading_shift",
  NULL
};

static ClothGapResult *
diagnose_seen (ClothObservations * observations,
    ClothObservations * baseline_observations, guint n_columns, guint threads)
{
  g_autofree gchar *folder = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTake) take = take_new (0., n_columns, &folder);
  g_autoptr (ClothTake) baseline = baseline_observations ?
      cloth_take_open (folder, &error) : NULL;
  g_autoptr (ClothModel) model = cloth_model_new ();
  const ClothGapOptions options = {.observations = &observations,.baselines =
        &baseline,.n_baselines = baseline ? 1 : 0,.baseline_observations =
        &baseline_observations,.effects = all_effects,.threads = threads
  };
  ClothGapResult *result = cloth_gap_diagnose (&take, 1, model, &options,
      &error);

  g_assert_no_error (error);
  for (guint i = 0; i < result->effects->len && i < 3; i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);

    g_test_message ("%s of %s: p %.3g, %g ± %g %s", e->effect->id, e->camera,
        e->probability, e->values[0], e->sigmas[0],
        e->accepted ? "accepted" : "");
  }
  remove_take (folder);
  return result;
}

static ClothGapResult *
diagnose (ClothObservations * observations,
    ClothObservations * baseline_observations, guint threads)
{
  return diagnose_seen (observations, baseline_observations, COLUMNS, threads);
}

static guint
count_accepted (const ClothGapResult * result)
{
  guint n = 0;

  for (guint i = 0; i < result->effects->len; i++)
    n += g_array_index (result->effects, ClothGapEffect, i).accepted;
  return n;
}

typedef struct
{
  const gchar *path, *effect;
  guint parameter;
  gdouble value, tolerance;
  Fault fault;
} Case;

/* Tolerances are three of the deviations that the noise of 4,320 points leaves. */
static const Case cases[] = {
  {"sync", "sync_offset", 0, 0.012, 1e-4, {1, 0.012}},
  {"early", "sync_offset", 0, -0.012, 1e-4, {2, -0.012}},
  {"focal", "focal_length", 0, 0.01, 5e-4, {0, 0., 0.01}},
  {"lens", "lens_distortion", 0, 0.1, 0.01, {1, 0., 0., 0.1}},
  {"tilt", "extrinsic_drift", 0, 0.002, 2e-5, {2, 0., 0., 0., {0.002, -0.003,
              0.001}}},
  {"pan", "extrinsic_drift", 1, -0.003, 2e-5, {2, 0., 0., 0., {0.002, -0.003,
              0.001}}},
  {"rolling", "rolling_shutter", 0, 0.02, 1e-3, {2, 0., 0., 0., {0.}, 0.02}},
  {"drop", "frame_drop", 0, 9. / 60., 1e-9, {0, 0., 0., 0., {0.}, 0., 0.,
          TRUE}},
};

static void
test_named (gconstpointer data)
{
  const Case *c = data;
  g_autoptr (ClothObservations) observations =
      observations_new (&c->fault, 1, N_CAMERAS);
  g_autoptr (ClothGapResult) result = diagnose (observations, NULL, 2);
  const ClothGapEffect *first = &g_array_index (result->effects,
      ClothGapEffect, 0);
  g_autofree gchar *camera = g_strdup_printf ("cam%u", c->fault.camera);

  g_assert_cmpstr (first->effect->id, ==, c->effect);
  g_assert_cmpstr (first->camera, ==, camera);
  g_assert_true (first->accepted);
  g_assert_cmpuint (count_accepted (result), ==, 1);
  g_assert_cmpfloat_with_epsilon (first->values[c->parameter], c->value,
      c->tolerance);
  g_assert_cmpfloat (fabs (first->values[c->parameter] - c->value), <=,
      MAX (2. * first->sigmas[c->parameter], 1e-9));
}

/* Half an exposure later is what a clock shows that is as much ahead: both are named. */
static void
test_blur (void)
{
  const Fault fault = { 1, 0., 0., 0., {0.}, 0., 0.02 };
  g_autoptr (ClothObservations) observations =
      observations_new (&fault, 1, N_CAMERAS);
  g_autoptr (ClothGapResult) result = diagnose (observations, NULL, 2);
  gboolean found = FALSE;

  g_assert_cmpuint (result->groups->len, ==, 1);
  g_assert_nonnull (g_array_index (result->groups, ClothGapGroup,
          0).experiment);
  for (guint i = 0; i < result->effects->len; i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);
    const gboolean blur = strcmp (e->effect->id, "motion_blur") == 0;
    const gboolean clock = strcmp (e->effect->id, "sync_offset") == 0;

    g_assert_cmpint (e->group, ==, blur || clock ? 0 : -1);
    if (!blur && !clock)
      continue;
    g_assert_cmpstr (e->camera, ==, "cam1");
    if (e->accepted)
      g_assert_cmpfloat_with_epsilon (e->values[0], blur ? 0.02 : -0.01, 1e-3);
    found |= e->accepted;
  }
  g_assert_true (found);
}

static void
test_two (void)
{
  const Fault faults[2] = { {0, 0.01}, {2, 0., -0.01} };
  g_autoptr (ClothObservations) observations =
      observations_new (faults, 2, N_CAMERAS);
  g_autoptr (ClothGapResult) result = diagnose (observations, NULL, 2);
  gboolean found[2] = { FALSE, FALSE };

  g_assert_cmpuint (count_accepted (result), ==, 2);
  for (guint i = 0; i < 2; i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);

    found[0] |= !strcmp (e->effect->id, "sync_offset")
        && !strcmp (e->camera, "cam0") && fabs (e->values[0] - 0.01) < 1e-4;
    found[1] |= !strcmp (e->effect->id, "focal_length")
        && !strcmp (e->camera, "cam2") && fabs (e->values[0] + 0.01) < 5e-4;
  }
  g_assert_true (found[0]);
  g_assert_true (found[1]);
}

static void
test_nothing (void)
{
  g_autoptr (ClothObservations) observations =
      observations_new (NULL, 0, N_CAMERAS);
  g_autoptr (ClothGapResult) result = diagnose (observations, NULL, 2);
  const ClothGapStage *stage;

  g_assert_cmpuint (count_accepted (result), ==, 0);
  stage = &g_array_index (result->stages, ClothGapStage, 0);
  g_assert_cmpstr (stage->name, ==, "camera");
  g_assert_cmpfloat (stage->share, ==, 0.);
}

/* Two cameras that contradict each other leave holes in the recording: where they would have
 * points is found from the pictures. */
static void
test_holes (void)
{
  const Fault fault = { 1, 0.03 };
  g_autoptr (ClothObservations) observations = observations_new (&fault, 1, 2);
  g_autoptr (ClothGapResult) result = diagnose_seen (observations, NULL, 1, 2);
  const ClothGapEffect *first = &g_array_index (result->effects,
      ClothGapEffect, 0);

  g_assert_cmpstr (first->effect->id, ==, "sync_offset");
  g_assert_true (first->accepted);
  /* either clock may be off: it is the difference that shows */
  g_assert_cmpfloat_with_epsilon (first->values[0],
      strcmp (first->camera, "cam1") ? -0.03 : 0.03, 1.5e-3);
}

/* What is wrong on the baseline, too, is no news. */
static void
test_baseline (void)
{
  const Fault fault = { 1, 0.012 };
  g_autoptr (ClothObservations) observations =
      observations_new (&fault, 1, N_CAMERAS);
  g_autoptr (ClothObservations) same = observations_new (&fault, 1, N_CAMERAS);
  g_autoptr (ClothObservations) sound = observations_new (NULL, 0, N_CAMERAS);
  g_autoptr (ClothGapResult) known = diagnose (observations, same, 2);
  g_autoptr (ClothGapResult) news = diagnose (observations, sound, 2);

  g_assert_cmpuint (count_accepted (known), ==, 0);
  g_assert_cmpuint (count_accepted (news), ==, 1);
}

static void
test_threads (void)
{
  const Fault fault = { 1, 0.012 };
  g_autoptr (ClothObservations) observations =
      observations_new (&fault, 1, N_CAMERAS);
  g_autoptr (ClothGapResult) one = diagnose (observations, NULL, 1);
  g_autoptr (ClothGapResult) two = diagnose (observations, NULL, 2);
  g_autofree gchar *a = NULL, *b = NULL;

  two->seconds = one->seconds;
  a = cloth_gap_result_to_json (one);
  b = cloth_gap_result_to_json (two);
  g_assert_cmpstr (a, ==, b);
}

/* Two cameras are needed to contradict each other. */
static void
test_one_camera (void)
{
  g_autoptr (ClothObservations) observations = observations_new (NULL, 0, 1);
  g_autoptr (ClothGapResult) result = diagnose (observations, NULL, 1);
  guint n = 0;

  for (guint i = 0; i < result->untested->len; i++) {
    const ClothGapUntested *u = &g_array_index (result->untested,
        ClothGapUntested, i);

    n += strstr (u->reason, "two cameras") != NULL;
  }
  g_assert_cmpuint (n, ==, 7);
  /* the stages say the same, and not that there are no observations */
  for (guint i = 0; i < 4; i++)
    g_assert_nonnull (strstr (g_array_index (result->stages, ClothGapStage,
                i).reason, "two cameras"));
}

/* Points that were recorded at a wrong place go to where the pictures have them. */
static void
test_solved_again (void)
{
  g_autoptr (ClothObservations) observations =
      observations_new (NULL, 0, N_CAMERAS);
  g_autofree gchar *folder = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTake) take = take_new (0.003, COLUMNS, &folder);
  ClothRecording *r = cloth_recording_new (take, &error);
  g_autoptr (ClothCameraView) view = cloth_camera_view_new (r, observations, 2);
  gdouble square, off = 0.;

  g_assert_no_error (error);
  square = cloth_camera_view_correct (view, 2, r);
  g_assert_cmpfloat_with_epsilon (sqrt (square), 0.003, 1e-4);
  for (guint f = 0; f < N_FRAMES; f++)
    for (guint v = 0; v < N; v++) {
      gdouble X[3];

      wave (v, f / FPS, X);
      for (guint k = 0; k < 3; k++)
        off += pow (r->y[3 * (f * N + v) + k] - X[k], 2.);
    }
  /* 0.05 px at 1.1 m and 900 px are 0.06 mm across, some 0.1 mm along the observation */
  g_assert_cmpfloat (sqrt (off / (N * N_FRAMES)), <, 2e-4);
  cloth_recording_free (r);
  remove_take (folder);
}

/* Of several pictures of a frame the nearest in time counts, whichever comes last; what was filmed before and
 * after the recording is of no frame. */
static void
test_nearest_picture (void)
{
  static const gdouble late[] = { -0.4, 0.1, 0.45, -0.2, 0.05 };
  const gdouble offset_s = 3.;
  g_autoptr (ClothObservations) observations =
      cloth_observations_new (rig_new (), N);
  const guint32 vertex = 0;
  const gdouble px[2] = { 1., 2. }, covariance[3] = { 1., 0., 1. };
  g_autofree gchar *folder = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTake) take = take_new (0., COLUMNS, &folder);
  g_autoptr (ClothRecording) r = cloth_recording_new (take, &error);
  g_autoptr (ClothCameraView) view = NULL;

  g_assert_no_error (error);
  observations->rig->cameras[1].offset_s = offset_s;
  for (gint f = -3; f < N_FRAMES + 3; f++)
    for (guint i = 0; i < G_N_ELEMENTS (late); i++) {
      /* a camera's pictures come in the order of time */
      static const guint order[] = { 0, 3, 4, 1, 2 };

      if (f == 7)
        continue;
      cloth_observations_add (observations, 1, offset_s + (f +
              late[order[i]]) / FPS, 1, &vertex, px, covariance, &error);
      g_assert_no_error (error);
    }
  view = cloth_camera_view_match (r, observations);
  for (guint f = 0; f < N_FRAMES; f++) {
    const ClothObservation *o = *cloth_camera_picture (view, f, 1);

    g_assert_null (*cloth_camera_picture (view, f, 0));
    if (f == 7)
      g_assert_null (o);
    else
      g_assert_cmpfloat_with_epsilon (o->time_s, offset_s + (f + 0.05) / FPS,
          1e-12);
  }
  remove_take (folder);
}

/* Where vertices are left out, those that are used are of all columns and rows, however many there are. */
static void
test_stride (void)
{
  ClothScene scene = { 0 };
  ClothRecording r = {.scene = &scene,.n = N,.n_frames = 1 };
  g_autofree gdouble *y = g_new0 (gdouble, 3 * N);
  const ClothCameraView view = {.recording = &r,.y = y };

  scene.topology = cloth_topology_new_grid (COLUMNS, ROWS, 1.f, 1.f);
  for (guint v = 0; v < N; v++)
    y[3 * v] = v;
  for (guint stride = 1; stride <= 2 * ROWS; stride++) {
    ClothCameraPoints points;
    guint columns = 0, rows = 0;

    cloth_camera_points_init (&points, &view, stride);
    g_assert_cmpuint (points.stride, >=, stride);
    g_assert_cmpuint (points.stride, <, stride + 3);
    for (guint i = 0; i < points.n; i++) {
      const guint v = (guint) points.frames[0][3 * i];

      g_assert_cmpuint (v, ==, i * points.stride);
      columns |= 1u << v % COLUMNS;
      rows |= 1u << v / COLUMNS;
    }
    /* as many as there are points for, up to all */
    g_assert_cmpuint (__builtin_popcount (columns), ==, MIN (points.n,
            COLUMNS));
    g_assert_cmpuint (__builtin_popcount (rows), >=, MIN (points.n, ROWS) / 2);
    cloth_camera_points_clear (&points);
  }
  cloth_topology_free (scene.topology);
}

static void
test_refused (void)
{
  g_autoptr (ClothObservations) observations =
      cloth_observations_new (rig_new (), N);
  const guint32 twice[2] = { 3, 3 }, beyond[1] = { N }, fine[1] = { 5 };
  const gdouble px[4] = { 1., 2., 3., 4. }, nan_px[2] = { NAN, 1. };
  const gdouble cov[6] = { 1., 0., 1., 1., 0., 1. };
  const gdouble negative[3] = { -1., 0., 1. }, skew[3] = { 1., 2., 1. };
  const struct
  {
    guint camera;
    gdouble time_s;
    guint n;
    const guint32 *vertices;
    const gdouble *px, *covariances;
    const gchar *says;
  } bad[] = {
    {N_CAMERAS, 1., 1, fine, px, cov, "camera 3"},
    {0, NAN, 1, fine, px, cov, "not later"},
    {0, 0.5, 1, fine, px, cov, "not later"},
    {0, 0.4, 1, fine, px, cov, "not later"},
    {0, 1., 2, twice, px, cov, "vertex 3"},
    {0, 1., 1, beyond, px, cov, "vertex 72"},
    {0, 1., 1, fine, nan_px, cov, "finite"},
    {0, 1., 1, fine, px, negative, "covariance"},
    {0, 1., 1, fine, px, skew, "covariance"},
  };
  g_autoptr (GError) error = NULL;

  cloth_observations_add (observations, 0, 0.5, 1, fine, px, cov, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_assert_false (cloth_observations_add (observations, bad[i].camera,
            bad[i].time_s, bad[i].n, bad[i].vertices, bad[i].px,
            bad[i].covariances, &error));
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
    g_assert_nonnull (strstr (error->message, bad[i].says));
    g_clear_error (&error);
  }
  g_assert_cmpuint (observations->list->len, ==, 1);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = g_strdup_printf ("/gap/camera/%s", cases[i].path);

    g_test_add_data_func (path, &cases[i], test_named);
  }
  g_test_add_func ("/gap/camera/blur", test_blur);
  g_test_add_func ("/gap/camera/two", test_two);
  g_test_add_func ("/gap/camera/nothing", test_nothing);
  g_test_add_func ("/gap/camera/holes", test_holes);
  g_test_add_func ("/gap/camera/baseline", test_baseline);
  g_test_add_func ("/gap/camera/threads", test_threads);
  g_test_add_func ("/gap/camera/one-camera", test_one_camera);
  g_test_add_func ("/gap/camera/solved-again", test_solved_again);
  g_test_add_func ("/gap/camera/nearest-picture", test_nearest_picture);
  g_test_add_func ("/gap/camera/stride", test_stride);
  g_test_add_func ("/gap/camera/refused", test_refused);
  return g_test_run ();
}
