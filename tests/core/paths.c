/* Paths of clamps that nobody logged. The truth is the path that the corners were moved along.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/nudge/nudge.h"
#include "gst/fit/recording/recording.h"
#include "tests/common/gapfilm.h"
#include "tests/common/gaprecord.h"

#define COLUMNS 10
#define ROWS 11
#define N (COLUMNS * ROWS)
#define N_FRAMES 60
#define FPS 50.
#define NOISE 0.0005

/* Two hands that swing a towel: not in step, not along one line. */
static void
swing (guint held, gdouble t, gfloat p[3])
{
  const gdouble w = 2. * G_PI * (held ? 1.1 : 0.9);

  p[0] = (gfloat) (0.3 * held + (held ? -0.03 : 0.02) * (1. - cos (w * t)));
  p[1] = (gfloat) (0.06 * (1. - cos (w * t)));
  p[2] = (gfloat) (0.03 * sin (2. * w * t) * t);
}

/* NaN from @open_from on, in both clamps or, of a @half, the first one. */
typedef struct
{
  guint open_from;
  gboolean half;
  guint hidden;                 /* rows and columns about each corner that nobody sees */
} Case;

static ClothModel *
model_new (void)
{
  ClothModel *model = cloth_model_new ();

  model->stretch_warp = model->stretch_weft = 60.;
  model->shear = 20.;
  return model;
}

/* The take as somebody records it who has no log of the clamps. */
static ClothTake *
record (const gchar * parent, const Case * c)
{
  const TestGapSheet sheet = { COLUMNS, ROWS, N_FRAMES, 0.3, 0.33, FPS, NOISE };
  g_autoptr (ClothModel) model = model_new ();
  g_autoptr (ClothTake) from = test_gap_record (&sheet, model, swing, parent,
      "whole", 7);
  g_autofree gchar *folder = g_build_filename (parent, "open", NULL);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeWriter) writer = cloth_take_writer_new (folder,
      cloth_take_get_info (from), cloth_take_get_topology (from), &error);
  ClothTake *take;

  g_assert_no_error (error);
  for (guint f = 0; f < N_FRAMES; f++) {
    gfloat positions[3 * N], clamps[6];
    guint8 states[N];

    cloth_take_read_positions (from, f, positions, NULL);
    cloth_take_read_clamps (from, f, clamps, NULL);
    for (guint v = 0; v < N; v++) {
      const guint column = MIN (v % COLUMNS, COLUMNS - 1 - v % COLUMNS);
      const gboolean hidden = column < c->hidden && v / COLUMNS < c->hidden;

      states[v] = hidden ? CLOTH_VERTEX_UNSEEN : CLOTH_VERTEX_MEASURED;
      for (guint k = 0; hidden && k < 3; k++)
        positions[3 * v + k] = NAN;
    }
    for (guint k = 0; f >= c->open_from && k < (c->half ? 3 : 6); k++)
      clamps[k] = NAN;
    g_assert_true (cloth_take_writer_append (writer, f / FPS, positions, states,
            NULL, clamps, &error));
  }
  g_assert_true (cloth_take_writer_close (writer, &error));
  take = cloth_take_open (folder, &error);
  g_assert_no_error (error);
  return take;
}

/* How far the paths are off the truth, RMS, m. */
static gdouble
find_error (const ClothRecording * r)
{
  gdouble sum = 0.;

  for (guint f = 0; f < N_FRAMES; f++)
    for (guint i = 0; i < 2; i++) {
      gfloat truth[3];

      swing (i, f / FPS, truth);
      for (guint k = 0; k < 3; k++)
        sum += pow (r->scene->clamps[3 * (2 * f + i) + k] - truth[k], 2.);
    }
  return sqrt (sum / (2 * N_FRAMES));
}

static ClothRecording *
find (const Case * c, guint threads, gdouble * before)
{
  const ClothRolloutOptions options = {.threads = threads };
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-paths-XXXXXX", NULL);
  g_autoptr (ClothTake) take = record (parent, c);
  g_autoptr (ClothModel) model = model_new ();
  g_autoptr (GError) error = NULL;
  ClothRecording *r = cloth_recording_new (take, &error);

  test_gap_remove (parent);
  g_assert_no_error (error);
  *before = find_error (r);
  g_assert_true (cloth_recording_refine_paths (r, model, 1600., &options,
          &error));
  return r;
}

/* A path whose vertex is seen is smoother than what is seen; the simulation does not spoil it. */
static void
test_seen (void)
{
  const Case c = { 0 };
  gdouble before, after;
  g_autoptr (ClothRecording) r = find (&c, 2, &before);

  after = find_error (r);
  g_test_message ("%.2f mm, then %.2f mm, of noise of %.2f mm", 1e3 * before,
      1e3 * after, 1e3 * NOISE * sqrt (3.));
  g_assert_cmpfloat (before, <, 0.6 * NOISE * sqrt (3.));
  g_assert_cmpfloat (after, <, 0.6 * NOISE * sqrt (3.));
}

/* Where nobody sees the corner, the cloth that hangs from it tells where the hand is. What is said of how
 * well it is known holds. */
static void
test_hidden (void)
{
  const Case c = {.hidden = 3 };
  gdouble before, after, sd = 0.;
  g_autoptr (ClothRecording) r = find (&c, 2, &before);

  after = find_error (r);
  for (guint k = 0; k < 2 * N_FRAMES; k++)
    sd += 3. * pow (r->scene->clamps_sd[k], 2.) / (2 * N_FRAMES);
  g_test_message ("%.1f mm, then %.1f mm, said %.1f mm", 1e3 * before,
      1e3 * after, 1e3 * sqrt (sd));
  g_assert_cmpfloat (before, >, 0.01);
  g_assert_cmpfloat (after, <, 0.1 * before);
  g_assert_cmpfloat (after, <, 3. * sqrt (sd));
  g_assert_cmpfloat (sqrt (sd), <, 0.5 * before);
}

/* What was logged stays, and the path goes on from there. */
static void
test_half_logged (void)
{
  const Case c = { N_FRAMES / 2, TRUE };
  gdouble before;
  g_autoptr (ClothRecording) r = find (&c, 2, &before);

  for (guint f = 0; f < N_FRAMES; f++)
    for (guint i = 0; i < 2; i++) {
      const gdouble *at = r->scene->clamps + 3 * (2 * f + i);
      gfloat truth[3];

      swing (i, f / FPS, truth);
      if (i == 1 || f < N_FRAMES / 2) {
        g_assert_cmpfloat (r->scene->clamps_sd[2 * f + i], ==, 0.);
        for (guint k = 0; k < 3; k++)
          g_assert_cmpfloat (at[k], ==, truth[k]);
      } else {
        g_assert_cmpfloat (r->scene->clamps_sd[2 * f + i], >, 0.);
        for (guint k = 0; k < 3; k++)
          g_assert_cmpfloat_with_epsilon (at[k], truth[k], 3. * NOISE);
      }
    }
}

static void
test_threads (void)
{
  const Case c = {.hidden = 2 };
  gdouble before;
  g_autoptr (ClothRecording) one = find (&c, 1, &before);
  g_autoptr (ClothRecording) three = find (&c, 3, &before);

  g_assert_cmpmem (one->scene->clamps, 6 * N_FRAMES * sizeof (gdouble),
      three->scene->clamps, 6 * N_FRAMES * sizeof (gdouble));
  g_assert_cmpmem (one->scene->clamps_sd, 2 * N_FRAMES * sizeof (gdouble),
      three->scene->clamps_sd, 2 * N_FRAMES * sizeof (gdouble));
}

/* The second camera doesn't see the corners. */
static gboolean
hide_corners (guint camera, guint vertex, guint frame)
{
  const guint column = MIN (vertex % COLUMNS, COLUMNS - 1 - vertex % COLUMNS);

  return camera == 1 && column < 3 && vertex / COLUMNS < 3;
}

/* What stands in clamps.npy while nothing is held is no path: neither NaN nor anything else. */
static void
test_let_go (void)
{
  const ClothRolloutOptions options = {.threads = 2 };
  const Case c = { 0 };
  g_autoptr (ClothModel) model = model_new ();
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-paths-XXXXXX", NULL);
  g_autoptr (ClothTake) take = record (parent, &c);
  g_autofree gdouble *positions = test_gap_positions (take);
  g_autoptr (GError) error = NULL;

  for (guint fault = 0; fault < 3; fault++) {
    g_autofree gchar *folder = g_strdup_printf ("%s/let-go%u", parent, fault);
    g_autoptr (ClothTakeInfo) info =
        cloth_take_info_copy (cloth_take_get_info (take));
    g_autoptr (ClothTakeWriter) writer = NULL;
    g_autoptr (ClothTake) let_go = NULL;
    g_autoptr (ClothRecording) r = NULL;

    g_array_set_size (info->held, 1);
    g_array_index (info->held, ClothHeld, 0).until_s = 0.6;
    writer =
        cloth_take_writer_new (folder, info, cloth_take_get_topology (take),
        &error);
    for (guint f = 0; f < N_FRAMES; f++) {
      gfloat row[3 * N], clamps[3];
      guint8 states[N];

      memset (states, CLOTH_VERTEX_MEASURED, N);

      for (guint i = 0; i < 3 * N; i++)
        row[i] = (gfloat) positions[3 * N * f + i];
      swing (0, f / FPS, clamps);
      for (guint k = 0; k < 3 && (f / FPS >= 0.6 || fault > 0); k++)
        clamps[k] = fault == 1 && f / FPS >= 0.6 ? 0.f : NAN;
      g_assert_true (cloth_take_writer_append (writer, f / FPS, row, states,
              NULL, clamps, &error));
    }
    g_assert_true (cloth_take_writer_close (writer, &error));
    let_go = cloth_take_open (folder, &error);
    r = cloth_recording_new (let_go, &error);
    g_assert_no_error (error);
    if (fault == 0) {
      g_assert_null (r->scene->clamps_sd);
      continue;
    }
    if (fault == 2)
      g_assert_true (cloth_recording_refine_paths (r, model, 1600., &options,
              &error));
    for (guint f = 0; f < N_FRAMES; f++) {
      gfloat truth[3];

      swing (0, f / FPS, truth);
      for (guint k = 0; f / FPS < 0.6 && k < 3; k++)
        g_assert_cmpfloat_with_epsilon (r->scene->clamps[3 * f + k], truth[k],
            4. * NOISE);
    }
  }
  test_gap_remove (parent);
}

/* A model that has nothing to do with the cloth moves no path to where it is worse; what is said of how well
 * it is known stays honest. */
static void
test_wrong_model (void)
{
  const ClothRolloutOptions options = {.threads = 1 };
  const Case c = {.hidden = 3 };
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-paths-XXXXXX", NULL);
  g_autoptr (ClothTake) take = record (parent, &c);
  g_autoptr (ClothModel) model = model_new ();
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = cloth_recording_new (take, &error);
  const gdouble before = find_error (r);
  gdouble sd = 0.;

  test_gap_remove (parent);
  model->stretch_warp = model->stretch_weft = 2.;
  model->damping_mass = 20.;
  g_assert_true (cloth_recording_refine_paths (r, model, 1600., &options,
          &error));
  for (guint k = 0; k < 2 * N_FRAMES; k++)
    sd += 3. * pow (r->scene->clamps_sd[k], 2.) / (2 * N_FRAMES);
  g_test_message ("%.1f mm, then %.1f mm, said %.1f mm", 1e3 * before,
      1e3 * find_error (r), 1e3 * sqrt (sd));
  g_assert_cmpfloat (find_error (r), <, 3. * sqrt (sd));
}

/* What is held lies on lone rays: along them nothing says where the hand is but the cloth. */
static void
test_rays (void)
{
  const TestGapFilming filming = { 2, 0.3, hide_corners };
  const ClothRolloutOptions options = {.threads = 2 };
  const gdouble middle[3] = { 0.15, 0.03, -0.15 };
  const Case c = { 0 };
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-paths-XXXXXX", NULL);
  g_autoptr (ClothTake) take = record (parent, &c);
  g_autoptr (ClothModel) model = model_new ();
  g_autoptr (ClothRig) rig = test_gap_ring (2, middle);
  g_autofree gdouble *positions = test_gap_positions (take);
  g_autoptr (ClothObservations) observations = NULL;
  g_autoptr (ClothRecording) r = NULL;
  g_autoptr (GError) error = NULL;
  ClothObservedCounts counts;
  gdouble times[N_FRAMES];

  for (guint f = 0; f < N_FRAMES; f++)
    times[f] = f / FPS;
  observations = test_gap_film (rig, rig, positions, times, N_FRAMES, N,
      &filming, 3);
  take = test_gap_forget_positions (g_steal_pointer (&take), TRUE);
  r = cloth_recording_new_observed (take, observations, model, 1600.,
      &options, &counts, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_recording_refine_paths (r, model, 1600., &options,
          &error));
  test_gap_remove (parent);
  g_test_message ("%.1f mm", 1e3 * find_error (r));
  g_assert_cmpfloat (find_error (r), <, 0.004);
}

/* Who simulates without a recording is told what is missing. */
static void
test_refused (void)
{
  const Case c = { 5 };
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-paths-XXXXXX", NULL);
  g_autoptr (ClothTake) take = record (parent, &c);
  g_autoptr (ClothScene) scene = NULL;
  g_autoptr (GError) error = NULL;

  scene = cloth_scene_new_from_take (take, &error);
  test_gap_remove (parent);
  g_assert_null (scene);
  g_assert_nonnull (strstr (error->message, "no place in frame 5"));
  g_assert_nonnull (strstr (error->message, "find it from what was seen"));
}

/* A recording whose cloth nobody saw for long: a path of its own choice is no path. */
static void
test_nothing_seen (void)
{
  const Case c = {.hidden = ROWS };
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-paths-XXXXXX", NULL);
  g_autoptr (ClothTake) take = record (parent, &c);
  g_autoptr (ClothRecording) r = NULL;
  g_autoptr (GError) error = NULL;

  r = cloth_recording_new (take, &error);
  test_gap_remove (parent);
  g_assert_null (r);
  g_assert_nonnull (strstr (error->message, "0 frames that show the cloth"));
}

/* A simulation that is stopped says so. */
static gboolean
stop (gpointer data, gdouble share)
{
  return FALSE;
}

static void
test_stopped (void)
{
  const ClothRolloutOptions options = {.threads = 1,.progress = stop };
  const Case c = {.hidden = 2 };
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-paths-XXXXXX", NULL);
  g_autoptr (ClothTake) take = record (parent, &c);
  g_autoptr (ClothModel) model = model_new ();
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = cloth_recording_new (take, &error);

  test_gap_remove (parent);
  g_assert_no_error (error);
  g_assert_false (cloth_recording_refine_paths (r, model, 1600., &options,
          &error));
  g_assert_nonnull (error);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/paths/seen", test_seen);
  g_test_add_func ("/paths/hidden", test_hidden);
  g_test_add_func ("/paths/half-logged", test_half_logged);
  g_test_add_func ("/paths/threads", test_threads);
  g_test_add_func ("/paths/let-go", test_let_go);
  g_test_add_func ("/paths/wrong-model", test_wrong_model);
  g_test_add_func ("/paths/rays", test_rays);
  g_test_add_func ("/paths/refused", test_refused);
  g_test_add_func ("/paths/nothing-seen", test_nothing_seen);
  g_test_add_func ("/paths/stopped", test_stopped);
  return g_test_run ();
}
