/* Speed of dot detection, on a set of eight pictures of 1004 by 1004.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/reference/reference.h"
#include "gst/vision/dot/dot.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

#define SIZE 1004
#define CAMERAS 8
#define ROUNDS 20
#define COLUMNS 31
#define ROWS 33

/* Dots of 31 by 33 on a cloth that takes two thirds of the picture before a grey wall,
 * with noise; a little turned and nearer for each camera. */
static guint8 *
picture (gint camera)
{
  guint8 *data = g_malloc (SIZE * SIZE);
  g_autoptr (GRand) rand = g_rand_new_with_seed ((guint32) camera);
  const gdouble angle = 0.1 * camera, pitch = 18 + 0.5 * camera;

  for (gint y = 0; y < SIZE; y++) {
    for (gint x = 0; x < SIZE; x++) {
      const gdouble dx = x - SIZE / 2, dy = y - SIZE / 2;
      const gdouble u = (cos (angle) * dx + sin (angle) * dy) / pitch;
      const gdouble v = (cos (angle) * dy - sin (angle) * dx) / pitch;
      const gint i = (gint) floor (u + COLUMNS / 2.0);
      const gint j = (gint) floor (v + ROWS / 2.0);
      gdouble grey = 120;

      if (i >= 0 && j >= 0 && i < COLUMNS && j < ROWS) {
        const gdouble r = pitch * hypot (u + COLUMNS / 2.0 - i - 0.5,
            v + ROWS / 2.0 - j - 0.5);

        grey = 18 + (60 + (i * 7 + j * 3) % 5 * 25)
            * CLAMP (pitch * 0.325 - r + 0.5, 0, 1);
      }
      for (gint k = 0; k < 4; k++)
        grey += 5 * (g_rand_double (rand) - 0.5);
      data[y * SIZE + x] = (guint8) CLAMP (grey + 0.5, 0, 255);
    }
  }
  return data;
}

/* Of all our threads, for OpenCV starts its own, in µs: others may be at work on the
 * machine. */
static gint64
now (void)
{
  struct timespec time;

  clock_gettime (CLOCK_PROCESS_CPUTIME_ID, &time);
  return (gint64) time.tv_sec * 1000000 + time.tv_nsec / 1000;
}

int
main (void)
{
  static const gchar *const names[] = { "scalar", "vectors" };
  static const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_BEST };
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();
  guint8 *pictures[CAMERAS];
  g_autofree guint8 *bgr = g_malloc (3 * SIZE * SIZE);
  gint64 peer = 0;
  guint n_peer = 0;

  for (gint k = 0; k < CAMERAS; k++)
    pictures[k] = picture (k);
  g_print ("dots of %d pictures of %d×%d, one core:\n", CAMERAS, SIZE, SIZE);
  for (gint k = 0; k < CAMERAS; k++) {
    gint64 least = G_MAXINT64;
    guint n = 0;

    for (gint i = 0; i < 3 * SIZE * SIZE; i++)
      bgr[i] = pictures[k][i / 3];
    for (gint round = 0; round < ROUNDS / 4; round++) {
      const gint64 start = now ();

      if (!cloth_cv_dots (bgr, SIZE, SIZE, 3 * SIZE, 10, 1600, &n))
        return 1;
      least = MIN (least, now () - start);
    }
    peer += least;
    n_peer += n;
  }
  g_print ("  OpenCV's HSV, Canny, contours and moments: %.2f ms a set, %u "
      "contours\n", (gdouble) peer * 1e-3, n_peer);
  for (gint level = 0; level < 2; level++) {
    gint64 least = G_MAXINT64;
    guint total = 0;

    for (gint round = 0; round < ROUNDS; round++) {
      const gint64 start = now ();

      total = 0;
      for (gint k = 0; k < CAMERAS; k++) {
        const ClothPlanarImage image = { {pictures[k], SIZE, SIZE, SIZE} };
        guint n;

        cloth_dot_detector_run (detector, &params, &image, levels[level]);
        cloth_dot_detector_get_dots (detector, &n);
        total += n;
      }
      least = MIN (least, now () - start);
    }
    g_print ("  %s: %.2f ms a set, %u dots, %.1f times as fast\n", names[level],
        (gdouble) least * 1e-3, total, (gdouble) peer / (gdouble) least);
  }
  for (gint k = 0; k < CAMERAS; k++)
    g_free (pictures[k]);
  return 0;
}
