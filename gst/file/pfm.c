/* PFM: pictures of floats, as Middlebury's benchmark of stereo has them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/pfm.h"

#include <math.h>
#include <string.h>

#include "gst/file/output.h"

/* Floats of a row that are turned into bytes together. */
#define CHUNK 256

/* A chunk of a row, least significant byte first, whatever the processor's order. */
static gboolean
write_floats (ClothOutput * output, const gfloat * floats, gint n,
    GError ** error)
{
  guint32 words[CHUNK];

  for (gint i = 0; i < n; i++) {
    const gfloat value = isnan (floats[i]) ? INFINITY : floats[i];

    memcpy (&words[i], &value, sizeof (value));
    words[i] = GUINT32_TO_LE (words[i]);
  }
  return cloth_output_write (output, words, (gsize) n * sizeof (*words), error);
}

/* @path: where the file shall be
 * @floats: width·height, top row first; NaN where nothing is known
 * @width: columns
 * @height: rows
 * @error: #GIOErrorEnum
 *
 * One float a pixel, the lowest row first, as the format wants; infinity where nothing is
 * known, as Middlebury's files have it. The file appears whole or not at all.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_pfm_write (const gchar * path, const gfloat * floats, gint width,
    gint height, GError ** error)
{
  g_autoptr (ClothOutput) output = cloth_output_new (path, error);

  /* a scale below 0: least significant byte first */
  if (!output || !cloth_output_printf (output, error, "Pf\n%d %d\n-1.0\n",
          width, height))
    return FALSE;
  for (gint y = height - 1; y >= 0; y--)
    for (gint x = 0; x < width; x += CHUNK)
      if (!write_floats (output, floats + (gsize) y * (gsize) width + x,
              MIN (CHUNK, width - x), error))
        return FALSE;
  return cloth_output_commit (output, error);
}
