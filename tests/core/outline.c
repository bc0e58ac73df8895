/* Outlines and silhouettes of a flat sheet before a camera, against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/nudge/outline.h"
#include "gst/fit/synthesis/silhouette.h"

#define COLUMNS 7
#define ROWS 6
#define N (COLUMNS * ROWS)
#define N_FRAMES 3
#define FPS 25.
/* The sheet, m, one metre before the camera: 240 × 200 pixels. */
#define WIDTH_M 0.3f
#define HEIGHT_M 0.25f
#define FOCAL 800.
#define LEFT 200
#define TOP 140

typedef struct
{
  ClothRecording recording;
  ClothObservations *observations;
  gdouble times[N_FRAMES];
  gdouble x[N_FRAMES * 3 * N];
} Scene;

/* A frame whose sheet has its corner at @left, @top, px. */
static void
place (gdouble left, gdouble top, gdouble * x)
{
  for (guint v = 0; v < N; v++) {
    x[3 * v] = (left - 0.5 - 320.) / FOCAL +
        (gdouble) WIDTH_M *(v % COLUMNS) / (COLUMNS - 1);
    x[3 * v + 1] = (top - 0.5 - 240.) / FOCAL +
        (gdouble) HEIGHT_M *(v / COLUMNS) / (ROWS - 1);
    x[3 * v + 2] = 1.;
  }
}

/* A picture of frame @frame whose cloth has the same size and its corner at @left, @top. */
static void
film (Scene * s, gdouble frame, guint left, guint top)
{
  ClothRun runs[200];
  GError *error = NULL;

  for (guint i = 0; i < 200; i++)
    runs[i] = (ClothRun) {
    (guint16) (top + i), (guint16) left, (guint16) (left + 240)};
  g_assert_true (cloth_observations_add (s->observations, 0, frame / FPS, 0,
          NULL, NULL, NULL, &error));
  g_assert_true (cloth_observations_set_silhouette (s->observations, 200, runs,
          &error));
}

static void
scene_init (Scene * s)
{
  ClothRig *rig = cloth_rig_new (1);
  ClothCamera *c = &rig->cameras[0];
  const gdouble K[9] = { FOCAL, 0., 320., 0., FOCAL, 240., 0., 0., 1. };

  c->name = g_strdup ("cam0");
  c->width = 640;
  c->height = 480;
  memcpy (c->K, K, sizeof K);
  for (guint k = 0; k < 3; k++)
    for (guint i = 0; i < 3; i++)
      c->R[3 * k + i] = k == i;
  memset (c->t, 0, sizeof c->t);
  s->observations = cloth_observations_new (rig, N);
  memset (&s->recording, 0, sizeof s->recording);
  s->recording.n = N;
  s->recording.n_frames = N_FRAMES;
  s->recording.times = s->times;
  s->recording.scene =
      cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, WIDTH_M,
          HEIGHT_M), FPS, 0);
  for (guint f = 0; f < N_FRAMES; f++) {
    s->times[f] = f / FPS;
    place (LEFT, TOP, s->x + 3 * N * f);
  }
}

static void
scene_clear (Scene * s)
{
  cloth_observations_free (s->observations);
  cloth_scene_free (s->recording.scene);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Scene, scene_clear);

/* A silhouette shifted by a quarter of its width: |∩| = ¾, |∪| = 5/4 of its pixels. */
static void
test_overlap (void)
{
  g_auto (Scene) s;
  gfloat positions[N_FRAMES * 3 * N];
  gdouble overlaps[N_FRAMES], differences[N_FRAMES];

  scene_init (&s);
  film (&s, 0, LEFT, TOP);
  film (&s, 2, LEFT + 60, TOP);
  for (guint i = 0; i < N_FRAMES * 3 * N; i++)
    positions[i] = (gfloat) s.x[i];
  cloth_synthesis_compare_silhouettes (&s.recording, positions, s.observations,
      1, overlaps, differences);
  g_assert_cmpfloat (overlaps[0], ==, 1.);
  g_assert_cmpfloat (differences[0], ==, 0.);
  g_assert_true (isnan (overlaps[1]) && isnan (differences[1]));
  g_assert_cmpfloat_with_epsilon (overlaps[2], 0.6, 1e-9);
  g_assert_cmpfloat (differences[2], ==, 2. * 60. * 200.);
}

/* A picture between two frames is of the cloth between them; one that is later than all is of none; an empty
 * silhouette has no overlap with a cloth. */
static void
test_times (void)
{
  g_auto (Scene) s;
  gfloat positions[N_FRAMES * 3 * N];
  gdouble overlaps[N_FRAMES], differences[N_FRAMES];
  ClothObservation *o;

  scene_init (&s);
  place (LEFT + 40, TOP, s.x + 3 * N);
  place (LEFT + 40, TOP, s.x + 2 * 3 * N);
  for (guint i = 0; i < N_FRAMES * 3 * N; i++)
    positions[i] = (gfloat) s.x[i];
  film (&s, 0, LEFT + 10, TOP);
  film (&s, 1, LEFT, TOP);
  film (&s, 9, LEFT, TOP);
  o = (ClothObservation *) (gpointer) s.observations->list->data;
  o[0].time_s += 0.25 / FPS;
  o[1].n_runs = 0;
  cloth_synthesis_compare_silhouettes (&s.recording, positions, s.observations,
      1, overlaps, differences);
  g_assert_cmpfloat (overlaps[0], >, 0.999);
  g_assert_cmpfloat (overlaps[1], ==, 0.);
  g_assert_cmpfloat (differences[1], ==, 240. * 200.);
  g_assert_true (isnan (overlaps[2]));
  /* nearest frames, and times that are none of the recording's */
  g_assert_cmpint (cloth_recording_find_frame (&s.recording, -0.4 / FPS), ==,
      0);
  g_assert_cmpint (cloth_recording_find_frame (&s.recording, 0.6 / FPS), ==, 1);
  g_assert_cmpint (cloth_recording_find_frame (&s.recording, 2.5 / FPS), ==, 2);
  g_assert_cmpint (cloth_recording_find_frame (&s.recording, 2.6 / FPS), ==,
      -1);
  g_assert_cmpint (cloth_recording_find_frame (&s.recording, -0.6 / FPS), ==,
      -1);
  g_assert_cmpint (cloth_recording_find_frame (&s.recording, NAN), ==, -1);
}

/* The filmed sheet is moved by whole pixels: vertices of the sides are off by that along the normal, those
 * inside are on no outline. */
static void
test_offsets (void)
{
  const gint moves[][2] = { {0, 0}, {7, 0}, {-7, 0}, {0, 5}, {4, -6} };

  for (guint i = 0; i < G_N_ELEMENTS (moves); i++) {
    g_auto (Scene) s;
    g_autoptr (ClothOutline) o = NULL;

    scene_init (&s);
    film (&s, 1, (guint) (LEFT + moves[i][0]), (guint) (TOP + moves[i][1]));
    o = cloth_outline_new (&s.recording, s.observations, 1);
    g_assert_false (cloth_outline_find (o, 0, 0, s.x));
    g_assert_true (cloth_outline_find (o, 0, 1, s.x));
    for (guint v = 0; v < N; v++) {
      const guint column = v % COLUMNS, row = v / COLUMNS;
      const gint right = (column == COLUMNS - 1) - (column == 0);
      const gint down = (row == ROWS - 1) - (row == 0);
      const gdouble *g = o->gradients + 3 * v;

      if (!right && !down)
        g_assert_cmpuint (o->counts[v], ==, 0);
      /* at corners it is a matter of pixels */
      if (!right == !down)
        continue;
      g_assert_cmpuint (o->counts[v], >, 10);
      g_assert_cmpfloat_with_epsilon (o->offsets[v], right * moves[i][0] +
          down * moves[i][1], 0.3);
      g_assert_cmpfloat_with_epsilon (g[0], FOCAL * right, 0.05 * FOCAL);
      g_assert_cmpfloat_with_epsilon (g[1], FOCAL * down, 0.05 * FOCAL);
    }
  }
}

/* A picture between two frames of a sheet that moves by 10 px from frame to frame, taken by a camera whose clock is
 * late, shows it where it was then. */
static void
test_between (void)
{
  g_auto (Scene) s;
  g_autoptr (ClothOutline) o = NULL;

  scene_init (&s);
  for (guint f = 0; f < N_FRAMES; f++)
    place (LEFT + 10. * f, TOP, s.x + 3 * N * f);
  s.observations->rig->cameras[0].offset_s = 0.9 / FPS;
  film (&s, 2.3, LEFT + 14, TOP);
  o = cloth_outline_new (&s.recording, s.observations, 1);
  g_assert_true (cloth_outline_find (o, 0, 1, s.x));
  for (guint row = 1; row < ROWS - 1; row++)
    for (guint side = 0; side < 2; side++)
      g_assert_cmpfloat_with_epsilon (o->offsets[row * COLUMNS + side *
              (COLUMNS - 1)], 0., 0.3);
}

/* Outlines further apart than the reach are not each other's; nor is there one in an empty or a full picture, or
 * when the sheet is behind the camera. */
static void
test_nothing (void)
{
  for (guint i = 0; i < 4; i++) {
    g_auto (Scene) s;
    g_autoptr (ClothOutline) o = NULL;
    ClothRun all[480];

    scene_init (&s);
    film (&s, 1, LEFT + 60, TOP + 60);
    for (guint y = 0; y < 480; y++)
      all[y] = (ClothRun) {
      (guint16) y, 0, 640};
    if (i == 1 || i == 2)
      g_assert_true (cloth_observations_set_silhouette (s.observations,
              i == 1 ? 0 : 480, all, NULL));
    for (guint v = 0; i == 3 && v < N; v++)
      s.x[3 * v + 2] = -1.;
    o = cloth_outline_new (&s.recording, s.observations, 1);
    g_assert_true (cloth_outline_find (o, 0, 1, s.x));
    for (guint v = 0; v < N; v++)
      g_assert_cmpuint (o->counts[v], ==, 0);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/outline/overlap", test_overlap);
  g_test_add_func ("/outline/times", test_times);
  g_test_add_func ("/outline/offsets", test_offsets);
  g_test_add_func ("/outline/between", test_between);
  g_test_add_func ("/outline/nothing", test_nothing);
  return g_test_run ();
}
