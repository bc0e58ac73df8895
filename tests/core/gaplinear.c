/* The parts of the diagnosis against closed forms: velocities of polynomials, estimated
 * noise, orthonormal waves, nuisances projected out against brute least squares.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/gap/diagnose.h"
#include "gst/fit/estimate/estimate.h"
#include "gst/math/linalg.h"
#include "gst/math/random.h"

#define COLUMNS 7
#define ROWS 6
#define N (COLUMNS * ROWS)
#define FPS 50.

typedef void (*Motion) (guint vertex, gdouble t, gfloat p[3]);

static const gdouble spacing = 0.02;

static void
quartic (guint vertex, gdouble t, gfloat p[3])
{
  p[0] = (gfloat) (spacing * (vertex % COLUMNS) + 0.02 * t * t * t * t);
  p[1] = (gfloat) (0.03 * t * t);
  p[2] = (gfloat) (-spacing * (vertex / COLUMNS) - 0.05 * t);
}

static void
millimetres (guint vertex, gdouble t, gfloat p[3])
{
  quartic (vertex, t, p);
  for (guint k = 0; k < 3; k++)
    p[k] *= 1000.f;
}

#define N_TURNING 30
/* A sheet that turns over. */
static void
turn_over (guint vertex, gdouble t, gfloat p[3])
{
  guint column = vertex % COLUMNS, row = vertex / COLUMNS;

  p[0] = (gfloat) (spacing * column + 0.4 * t);
  p[1] = (gfloat) (t * spacing * (2. * column - 1.5 * row));
  p[2] = (gfloat) (-spacing * row - 0.3 * t);
}

/* A patch comes in sight late, one goes out of sight, and one vertex is never seen. */
static void
turning (guint vertex, gdouble t, gfloat p[3])
{
  guint column = vertex % COLUMNS, row = vertex / COLUMNS;
  guint frame = (guint) round (t * FPS);

  turn_over (vertex, t, p);
  if ((column >= 2 && column <= 4 && row >= 2 && row <= 3 && frame < 8)
      || (column >= 1 && column <= 3 && row >= 1 && row <= 3
          && frame >= N_TURNING - 6) || vertex == 3 * COLUMNS + 4)
    p[0] = p[1] = p[2] = NAN;
}

/* A patch goes out of sight before the one beside it comes in sight. */
static void
relay (guint vertex, gdouble t, gfloat p[3])
{
  guint column = vertex % COLUMNS, row = vertex / COLUMNS;
  guint frame = (guint) round (t * FPS);

  turn_over (vertex, t, p);
  if (row >= 2 && row <= 3 && column >= 1 && column <= 5
      && (column <= 3 ? frame >= 8 : frame < N_TURNING - 8))
    p[0] = p[1] = p[2] = NAN;
}

#define LATE (3 * COLUMNS + 4)
#define SEEN_LATE 21
/* One vertex alone is seen late, where it can't have come from, one in a frame in which
 * others deny it, and a square is four squares aside. */
static gboolean
is_in_hole (guint vertex)
{
  guint column = vertex % COLUMNS, row = vertex / COLUMNS;

  return column >= 3 && column <= 5 && row >= 2 && row <= 4;
}

static void
torn (guint vertex, gdouble t, gfloat p[3])
{
  guint column = vertex % COLUMNS, row = vertex / COLUMNS;
  guint frame = (guint) round (t * FPS);

  turn_over (vertex, t, p);
  if (vertex == LATE && frame >= SEEN_LATE)
    p[2] += 0.2f;
  else if (is_in_hole (vertex))
    p[0] = p[1] = p[2] = NAN;
  else if (vertex == 4 * COLUMNS + 1 && frame % 10 == 0)
    p[1] -= 0.5f;
  else if (column >= 1 && column <= 2 && row <= 1 && frame % 10 == 5)
    p[0] -= (gfloat) (4. * spacing);
}

/* A corner is held, and never seen. */
static void
hung (guint vertex, gdouble t, gfloat p[3])
{
  turn_over (vertex, t, p);
  if (vertex == 0)
    p[0] = p[1] = p[2] = NAN;
}

/* A take of a motion with noise; every seventh vertex is hidden in every ninth frame. Where
 * @clamp says vertex 0 is held there. */
static gchar *
write_take (Motion motion, Motion clamp, guint n_frames, gdouble noise,
    gdouble told)
{
  const ClothHeld held = { 0, 0., INFINITY };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("motion");
  g_autoptr (ClothTopology) topology = cloth_topology_new_grid (COLUMNS, ROWS,
      (gfloat) (spacing * (COLUMNS - 1)), (gfloat) (spacing * (ROWS - 1)));
  g_autoptr (ClothTakeWriter) writer = NULL;
  gchar *parent = g_dir_make_tmp ("cloth-gap-XXXXXX", &error);
  gchar *folder = g_build_filename (parent, "take", NULL);
  ClothRandom random;

  g_free (parent);
  info->fps = FPS;
  info->columns = COLUMNS;
  info->rows = ROWS;
  info->width_m = spacing * (COLUMNS - 1);
  info->height_m = spacing * (ROWS - 1);
  info->noise_sigma_m = told;
  if (clamp)
    g_array_append_val (info->held, held);
  writer = cloth_take_writer_new (folder, info, topology, &error);
  g_assert_no_error (error);
  cloth_random_init (&random, 5);
  for (guint f = 0; f < n_frames; f++) {
    gfloat positions[3 * N], held_at[3];
    guint8 states[N];

    if (clamp)
      clamp (0, f / FPS, held_at);
    for (guint v = 0; v < N; v++) {
      states[v] = CLOTH_VERTEX_MEASURED;
      motion (v, f / FPS, positions + 3 * v);
      for (guint k = 0; k < 3; k++)
        positions[3 * v + k] += (gfloat) (noise *
            cloth_random_gaussian (&random));
      if (!isnan (positions[3 * v]) && (v % 7 != 3 || f % 9 != 4))
        continue;
      states[v] = CLOTH_VERTEX_UNSEEN;
      positions[3 * v] = positions[3 * v + 1] = positions[3 * v + 2] = NAN;
    }
    cloth_take_writer_append (writer, f / FPS, positions, states, NULL,
        clamp ? held_at : NULL, &error);
    g_assert_no_error (error);
  }
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
  return folder;
}

static ClothRecording *
record_held (Motion motion, Motion clamp, guint n_frames, gdouble noise,
    gdouble told, GError ** error)
{
  g_autofree gchar *folder = write_take (motion, clamp, n_frames, noise, told);
  g_autofree gchar *parent = g_path_get_dirname (folder);
  g_autoptr (ClothTake) take = cloth_take_open (folder, error);
  ClothRecording *r = take ? cloth_recording_new (take, error) : NULL;
  g_autoptr (GDir) dir = g_dir_open (folder, 0, NULL);
  const gchar *name;

  while ((name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    g_remove (path);
  }
  g_rmdir (folder);
  g_rmdir (parent);
  return r;
}

static ClothRecording *
record (Motion motion, guint n_frames, gdouble noise, gdouble told,
    GError ** error)
{
  return record_held (motion, NULL, n_frames, noise, told, error);
}

/* A polynomial of order 4 has the derivative it has, at the ends too. */
static void
test_velocity (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record (quartic, 30, 0., 1e-4, &error);

  g_assert_no_error (error);
  for (guint f = 0; f < 30; f++)
    for (guint v = 0; v < N; v++) {
      const gdouble *got = r->velocity + 3 * ((gsize) f * N + v);
      gdouble t = f / FPS;

      if (v % 7 == 3)
        continue;
      /* positions are floats of a resolution of 1e-8 m */
      g_assert_cmpfloat (fabs (got[0] - 0.08 * t * t * t), <, 1e-5);
      g_assert_cmpfloat (fabs (got[1] - 0.06 * t), <, 1e-5);
      g_assert_cmpfloat (fabs (got[2] + 0.05), <, 1e-5);
    }
}

/* A vertex is where the sheet that turns over has it. */
static void
assert_turned (const ClothRecording * r, guint frame, guint vertex,
    gdouble most_off)
{
  const gdouble *got = r->y + 3 * ((gsize) frame * N + vertex);
  gfloat want[3];

  turn_over (vertex, frame / FPS, want);
  for (guint k = 0; k < 3; k++)
    g_assert_cmpfloat (fabs (got[k] - want[k]), <, most_off);
}

/* Where all move alike to first order in the cloth, what was not seen is known: to the
 * sweeps of the bridge, a thousandth of how far the sheet goes. */
static void
test_bridge (gconstpointer data)
{
  const Motion *motion = data;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record (*motion, N_TURNING, 0., 1e-4, &error);

  g_assert_no_error (error);
  for (guint f = 0; f < N_TURNING; f++)
    for (guint v = 0; v < N; v++)
      assert_turned (r, f, v, 2e-4);
}

/* A vertex that was not seen is where it was held. */
static void
test_held (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record_held (hung, turn_over, N_TURNING, 0.,
      1e-4, &error);

  g_assert_no_error (error);
  for (guint f = 0; f < N_TURNING; f++) {
    g_assert_cmpfloat (r->seen[(gsize) f * N], ==, 0.);
    assert_turned (r, f, 0, 1e-6);
  }
}

/* A vertex that would have to be torn off to be where it was seen is nowhere. */
static void
test_torn (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record (torn, N_TURNING, 0., 1e-4, &error);

  g_assert_no_error (error);
  for (guint f = 0; f < N_TURNING; f++)
    for (guint v = 0; v < N; v++)
      /* those around it are drawn along from the frame before */
      if (f < SEEN_LATE || !is_in_hole (v))
        assert_turned (r, f, v, 2e-4);
  g_assert_cmpfloat (r->seen[4 * COLUMNS + 1], ==, 0.);
  g_assert_cmpfloat (r->seen[4 * COLUMNS + 2], ==, 1.);
}

static void
test_noise (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record (quartic, 60, 3e-4, NAN, &error);

  g_assert_no_error (error);
  g_test_message ("sigma %g m of 3e-4", r->sigma);
  g_assert_cmpfloat (fabs (r->sigma - 3e-4), <, 0.05 * 3e-4);
}

static void
test_refused (void)
{
  g_autoptr (GError) error = NULL;

  g_assert_null (record (millimetres, 30, 0., 1e-4, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
  g_assert_nonnull (strstr (error->message, "millimetres"));
  g_clear_error (&error);
  g_assert_null (record (quartic, 1, 0., 1e-4, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
  g_assert_nonnull (strstr (error->message, "1 frames"));
}

/* Of a residual that all waves and cosines can make, the features have its square; what
 * is not seen counts as equal. */
static void
test_features (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record (quartic, 30, 0., 1e-3, &error);
  g_autoptr (ClothFeatures) f = NULL;
  g_autofree gdouble *z = NULL;
  gdouble positions[3 * N], square = 0., features = 0.;

  g_assert_no_error (error);
  f = cloth_features_new (r, 7, 0.2, 1000.);
  g_assert_cmpuint (f->n_waves, ==, N);
  g_assert_cmpuint (f->n_blocks, ==, 3);
  z = g_new0 (gdouble, f->size);
  for (guint frame = 0; frame < 30; frame++) {
    for (guint v = 0; v < N; v++)
      for (guint k = 0; k < 3; k++) {
        gdouble off = 1e-3 * sin (1. + 3. * v + 5. * k + 7. * frame);
        gsize at = (gsize) frame * N + v;

        positions[3 * v + k] = r->y[3 * at + k] + off;
        square += r->seen[at] * off * off * 1e6;
      }
    cloth_features_add (f, r, frame, positions, z);
  }
  for (gsize i = 0; i < f->size; i++)
    features += z[i] * z[i];
  g_assert_cmpfloat (fabs (features - square), <, 1e-9 * square);
}

/* With all cosines, what is outside a part of a block is 0 exactly. */
static void
test_window (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record (quartic, 30, 0., 1e-3, &error);
  g_autoptr (ClothFeatures) f = NULL;
  g_autofree gdouble *z = NULL, *part = NULL, *windowed = NULL, *sum = NULL;

  g_assert_no_error (error);
  f = cloth_features_new (r, 4, 0.2, 1000.);
  z = g_new0 (gdouble, f->size);
  windowed = g_new0 (gdouble, f->size);
  sum = g_new0 (gdouble, f->size);
  for (guint p = 0; p < 3; p++) {
    g_free (part);
    part = g_new0 (gdouble, f->size);
    for (guint frame = 0; frame < 30; frame++) {
      gdouble positions[3 * N];

      for (gsize i = 0; i < 3 * N; i++)
        positions[i] = r->y[(gsize) frame * 3 * N + i] +
            1e-3 * sin (1. + 3. * i + 7. * frame);
      /* blocks of ten frames, in parts of three, three and four */
      if (MIN (frame % 10 / 3, 2) == p)
        cloth_features_add (f, r, frame, positions, part);
      if (p == 0)
        cloth_features_add (f, r, frame, positions, z);
    }
    cloth_features_window (f, z, p, 3, windowed);
    for (gsize i = 0; i < f->size; i++) {
      sum[i] += windowed[i];
      g_assert_cmpfloat_with_epsilon (windowed[i], part[i], 1e-9);
    }
  }
  for (gsize i = 0; i < f->size; i++)
    g_assert_cmpfloat_with_epsilon (sum[i], z[i], 1e-9);
}

/* z = 2 a + 3 b − 5 c with a, b known and c as nuisance: what is left names −a, −b. */
static void
test_reduce (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) r = record (quartic, 30, 0., 1e-3, &error);
  g_autoptr (ClothFeatures) f = NULL;
  g_autoptr (ClothPowerSpectrum) none = NULL;
  g_autoptr (ClothNormalEquations) normal = NULL;
  g_autofree gdouble *columns = NULL, *z = NULL;
  const gdouble made_of[3] = { 2., 3., -5. }, precision = 0.;
  const guint directions[2] = { 0, 1 }, nuisance = 2;
  const gboolean blocks[3] = { TRUE, TRUE, FALSE };
  ClothReducedEquations reduced;
  gdouble changes[2], left = 0.;
  ClothRandom random;

  g_assert_no_error (error);
  f = cloth_features_new (r, 4, 0.2, 10.);
  columns = g_new (gdouble, 3 * f->size);
  z = g_new0 (gdouble, f->size);
  cloth_random_init (&random, 3);
  for (gsize i = 0; i < 3 * f->size; i++)
    columns[i] = cloth_random_gaussian (&random);
  for (gsize i = 0; i < f->size; i++)
    for (guint k = 0; k < 3; k++)
      z[i] += made_of[k] * columns[k * f->size + i];
  none = cloth_power_spectrum_new (f, z);
  memset (none->values, 0, none->n * sizeof (gdouble));
  normal = cloth_normal_equations_new (f, none, z, columns, 3);
  g_assert_true (cloth_normal_equations_reduce (normal, blocks, &nuisance,
          &precision, 1, directions, 2, &reduced));
  memcpy (changes, reduced.s, sizeof changes);
  {
    gdouble a[4];

    memcpy (a, reduced.g, sizeof a);
    g_assert_true (cloth_cholesky_factor (2, a));
    cloth_cholesky_solve (2, a, changes);
  }
  g_assert_cmpfloat (fabs (changes[0] - 2.), <, 1e-9);
  g_assert_cmpfloat (fabs (changes[1] - 3.), <, 1e-9);
  /* random columns are nearly at right angles: almost nothing is projected away */
  g_assert_cmpfloat (reduced.kept[0], >, 0.95);
  g_assert_cmpfloat (reduced.kept[0], <=, 1.);
  /* taking them off a block they were not estimated on leaves the nuisance's part */
  changes[0] = -changes[0];
  changes[1] = -changes[1];
  left = normal->r[2] + cloth_normal_equations_change (normal, 2, directions,
      changes, 2);
  g_assert_cmpfloat (fabs (left - 25. * normal->g[2 * 9 + 8]), <, 1e-6 * left);
}

int
main (int argc, char **argv)
{
  static const Motion motions[] = { turning, relay };

  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gap/velocity", test_velocity);
  g_test_add_data_func ("/gap/bridge/turning", &motions[0], test_bridge);
  g_test_add_data_func ("/gap/bridge/relay", &motions[1], test_bridge);
  g_test_add_func ("/gap/held", test_held);
  g_test_add_func ("/gap/torn", test_torn);
  g_test_add_func ("/gap/noise", test_noise);
  g_test_add_func ("/gap/refused", test_refused);
  g_test_add_func ("/gap/features", test_features);
  g_test_add_func ("/gap/window", test_window);
  g_test_add_func ("/gap/reduce", test_reduce);
  return g_test_run ();
}
