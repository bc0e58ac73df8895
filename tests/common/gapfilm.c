/* What a ring of cameras sees of a recorded sheet: see gapfilm.h.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gapfilm.h"

#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/file/npy.h"
#include "gst/math/random.h"

#define RADIUS 1.5
#define WIDTH 1000
#define HEIGHT 800
#define FOCAL 1100.

ClothRig *
test_gap_ring (guint n_cameras, const gdouble middle[3])
{
  ClothRig *rig = cloth_rig_new (n_cameras);

  for (guint c = 0; c < n_cameras; c++) {
    ClothCamera *camera = &rig->cameras[c];
    gdouble angle = 2. * G_PI * (c + 0.3) / MAX (n_cameras, 5);
    gdouble C[3] = { middle[0] + RADIUS * sin (angle),
      middle[1] - RADIUS * cos (angle), middle[2] + (c % 2 ? 0.4 : -0.2)
    };
    gdouble z[3], x[3], y[3], length = 0.;

    camera->name = g_strdup_printf ("cam%u", c);
    camera->width = WIDTH;
    camera->height = HEIGHT;
    memset (camera->K, 0, sizeof camera->K);
    camera->K[0] = camera->K[4] = FOCAL;
    camera->K[2] = 0.5 * (WIDTH - 1);
    camera->K[5] = 0.5 * (HEIGHT - 1);
    camera->K[8] = 1.;
    for (guint k = 0; k < 3; k++) {
      z[k] = middle[k] - C[k];
      length += z[k] * z[k];
    }
    for (guint k = 0; k < 3; k++)
      z[k] /= sqrt (length);
    length = hypot (z[0], z[1]);
    x[0] = z[1] / length;
    x[1] = -z[0] / length;
    x[2] = 0.;
    for (guint k = 0; k < 3; k++)
      y[k] = z[(k + 1) % 3] * x[(k + 2) % 3] - z[(k + 2) % 3] * x[(k + 1) % 3];
    memcpy (camera->R, x, sizeof x);
    memcpy (camera->R + 3, y, sizeof y);
    memcpy (camera->R + 6, z, sizeof z);
    for (guint k = 0; k < 3; k++)
      camera->t[k] = -(camera->R[3 * k] * C[0] + camera->R[3 * k + 1] * C[1] +
          camera->R[3 * k + 2] * C[2]);
  }
  return rig;
}

/* Between two frames on a cubic through four (Catmull and Rom). */
static void
find_place (const gdouble * positions, const gdouble * times, guint n_frames,
    guint n, guint v, gdouble t, gdouble x[3])
{
  guint f = 0;
  gdouble s;

  while (f + 2 < n_frames && times[f + 1] <= t)
    f++;
  s = (t - times[f]) / (times[f + 1] - times[f]);
  for (guint k = 0; k < 3; k++) {
#define AT(frame) positions[3 * ((gsize) (frame) * n + v) + k]
    gdouble b = AT (f), c = AT (f + 1);
    gdouble a = f ? AT (f - 1) : 2. * b - c;
    gdouble d = f + 2 < n_frames ? AT (f + 2) : 2. * c - b;
#undef AT

    x[k] = b + 0.5 * s * (c - a + s * (2. * a - 5. * b + 4. * c - d +
            s * (3. * (b - c) + d - a)));
  }
}

static ClothRig *
copy_rig (const ClothRig * rig)
{
  ClothRig *copy = cloth_rig_new (rig->n_cameras);

  for (guint c = 0; c < rig->n_cameras; c++)
    cloth_camera_copy (&copy->cameras[c], &rig->cameras[c]);
  return copy;
}

ClothObservations *
test_gap_film (const ClothRig * rig, const ClothRig * truth,
    const gdouble * positions, const gdouble * times, guint n_frames, guint n,
    const TestGapFilming * filming, guint64 seed)
{
  ClothObservations *observations = cloth_observations_new (copy_rig (rig), n);
  const gdouble square = filming->noise_px * filming->noise_px;
  g_autofree gdouble *px = g_new (gdouble, 2 * n);
  g_autofree gdouble *covariances = g_new (gdouble, 3 * n);
  g_autofree guint32 *vertices = g_new (guint32, n);
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint c = 0; c < truth->n_cameras; c++)
    for (guint f = 0; f < n_frames; f++) {
      const gdouble late = filming->late_s ? filming->late_s[c] : 0.;
      g_autoptr (GError) error = NULL;
      guint seen = 0;

      for (guint v = 0; v < n; v++) {
        gdouble x[3], at[2];

        find_place (positions, times, n_frames, n, v, times[f] + late, x);
        if ((filming->hidden && filming->hidden (c, v, f))
            || !cloth_camera_project (&truth->cameras[c], x, at, NULL, NULL))
          continue;
        for (guint k = 0; k < 2; k++)
          px[2 * seen + k] = at[k] + filming->noise_px *
              cloth_random_gaussian (&random);
        covariances[3 * seen] = covariances[3 * seen + 2] = square;
        covariances[3 * seen + 1] = 0.;
        vertices[seen++] = v;
      }
      cloth_observations_add (observations, c, times[f] + late, seen, vertices,
          px, covariances, &error);
      g_assert_no_error (error);
    }
  return observations;
}

gdouble *
test_gap_positions (ClothTake * take)
{
  const guint n = cloth_take_get_topology (take)->n_vertices;
  const guint n_frames = cloth_take_get_n_frames (take);
  gdouble *all = g_new (gdouble, 3 * (gsize) n * n_frames);
  g_autofree gfloat *row = g_new (gfloat, 3 * n);
  g_autoptr (GError) error = NULL;

  for (guint f = 0; f < n_frames; f++) {
    cloth_take_read_positions (take, f, row, &error);
    g_assert_no_error (error);
    for (guint i = 0; i < 3 * n; i++)
      all[3 * (gsize) n * f + i] = row[i];
  }
  return all;
}

ClothTake *
test_gap_forget_positions (ClothTake * take, gboolean keep_start)
{
  const gchar *folder = cloth_take_get_folder (take);
  const guint n = cloth_take_get_topology (take)->n_vertices;
  g_autofree gchar *positions = g_build_filename (folder, "positions.npy",
      NULL);
  g_autofree gchar *states = g_build_filename (folder, "states.npy", NULL);
  g_autofree gchar *observations = g_build_filename (folder, "observations",
      NULL);
  g_autofree gfloat *start = g_new (gfloat, 3 * n);
  g_autoptr (GError) error = NULL;
  ClothTake *again;

  cloth_take_read_positions (take, 0, start, &error);
  g_assert_no_error (error);
  g_remove (positions);
  g_remove (states);
  g_mkdir (observations, 0755);
  if (keep_start) {
    const guint64 shape[] = { n, 3 };
    g_autoptr (ClothNpyWriter) writer =
        cloth_npy_writer_new (cloth_output_new (positions, &error),
        CLOTH_NPY_FLOAT32, 3, shape, &error);

    g_assert_no_error (error);
    g_assert_true (cloth_npy_writer_append (writer, start, 1, &error)
        && cloth_npy_writer_finish (writer, &error));
  }
  again = cloth_take_open (folder, &error);
  g_assert_no_error (error);
  return again;
}
