/* Fuzz target: effects as people type them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/rig/capture.h"

#include <math.h>

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  const ClothCamera camera = { NULL, 640, 480,
    {500, 0, 319.5, 0, 500, 239.5, 0, 0, 1}, CLOTH_LENS_NONE, {0},
    {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 1}
  };
  g_autofree gchar *text = g_strndup ((const gchar *) data, size);
  g_autoptr (GError) error = NULL;
  ClothCapture capture;

  cloth_capture_init (&capture, &camera);
  g_assert_true (cloth_capture_add_effects (&capture, text, &error)
      == (error == NULL));
  /* Whatever was taken, points stay numbers. */
  {
    const gdouble times[] = { 0, 0.04, 0.08 };
    const gdouble positions[3][3] = { {0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0} };
    const gdouble *const frames[] =
        { positions[0], positions[1], positions[2] };
    const ClothMotion motion = { 1, 3, times, frames };
    gdouble px[2], covariance[3];

    if (cloth_capture_observe (&capture, &motion, 0.05, px, covariance))
      g_assert_true (isfinite (px[0] + px[1]));
  }
  return 0;
}
