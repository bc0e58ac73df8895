/* What is printed on a cloth: a pyramid of means in linear light.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/paint.h"

#include <math.h>
#include <string.h>

/* @level: a value of a picture, 0 to 255
 *
 * Returns: its share of the brightest light, by the transfer curve of sRGB
 *   (IEC 61966-2-1)
 */
gfloat
cloth_light_from_level (guint8 level)
{
  const gdouble v = level / 255.0;

  return (gfloat) (v <= 0.04045 ? v / 12.92 : pow ((v + 0.055) / 1.055, 2.4));
}

static void
level_init (ClothPaintLevel * level, gint width, gint height, guint n)
{
  const gsize size = (gsize) width * (gsize) height;

  level->width = width;
  level->height = height;
  level->data = g_new (gfloat, size * n);
  level->flat = g_malloc (size);
}

static void
halve (const ClothPaintLevel * fine, ClothPaintLevel * coarse, guint n)
{
  level_init (coarse, (fine->width + 1) / 2, (fine->height + 1) / 2, n);
  for (gint y = 0; y < coarse->height; y++) {
    for (gint x = 0; x < coarse->width; x++) {
      gfloat *to = coarse->data + ((gsize) y * (gsize) coarse->width
          + (gsize) x) * n;
      gsize from[4];
      gboolean flat = TRUE;

      for (gint k = 0; k < 4; k++) {
        const gint fx = MIN (2 * x + (k & 1), fine->width - 1);
        const gint fy = MIN (2 * y + (k >> 1), fine->height - 1);

        from[k] = (gsize) fy *(gsize) fine->width + (gsize) fx;
        flat = flat && fine->flat[from[k]];
      }
      for (guint c = 0; c < n; c++) {
        const gfloat *d = fine->data + c;
        const gfloat a = d[from[0] * n];

        to[c] = (a + d[from[1] * n] + d[from[2] * n] + d[from[3] * n]) / 4;
        flat = flat && d[from[1] * n] == a && d[from[2] * n] == a
            && d[from[3] * n] == a;
      }
      coarse->flat[(gsize) y * (gsize) coarse->width + (gsize) x] = flat;
    }
  }
}

/* A pixel stays flat when its neighbours are flat and of its value. */
static void
narrow (ClothPaintLevel * level, guint n)
{
  const gsize size = (gsize) level->width * (gsize) level->height;
  guint8 *wide = level->flat;

  level->flat = g_malloc (size);
  for (gint y = 0; y < level->height; y++) {
    for (gint x = 0; x < level->width; x++) {
      const gsize at = (gsize) y * (gsize) level->width + (gsize) x;
      gboolean flat = TRUE;

      for (gint k = 0; k < 9 && flat; k++) {
        const gint nx = CLAMP (x + k % 3 - 1, 0, level->width - 1);
        const gint ny = CLAMP (y + k / 3 - 1, 0, level->height - 1);
        const gsize other = (gsize) ny * (gsize) level->width + (gsize) nx;

        flat = wide[other] && memcmp (level->data + other * n,
            level->data + at * n, n * sizeof (gfloat)) == 0;
      }
      level->flat[at] = flat;
    }
  }
  g_free (wide);
}

/* @data: the picture
 * @width: pixels a row, 1 to %CLOTH_PAINT_MAX_PX
 * @height: rows, 1 to %CLOTH_PAINT_MAX_PX
 * @stride: bytes from one row to the next
 * @n_channels: 1 for grey; 3 for red, green, blue, one after the other
 * @light: (nullable) (array fixed-size=256): what each level of the picture reflects;
 *   %NULL: by the transfer curve of sRGB, 255 reflecting all light
 * @origin_uv_m: place of its top-left corner on the flat cloth, m
 * @size_m: its width and height on the flat cloth, m
 *
 * Returns: (transfer full): free with cloth_paint_free ()
 */
ClothPaint *
cloth_paint_new (const guint8 * data, gint width, gint height, gint stride,
    guint n_channels, const gfloat * light, const gdouble origin_uv_m[2],
    const gdouble size_m[2])
{
  ClothPaint *paint = g_new0 (ClothPaint, 1);
  ClothPaintLevel *level = paint->levels;
  gfloat usual[256];

  g_return_val_if_fail (n_channels == 1 || n_channels == 3, paint);
  if (!light) {
    for (gint i = 0; i < 256; i++)
      usual[i] = cloth_light_from_level ((guint8) i);
    light = usual;
  }
  paint->n_channels = n_channels;
  memcpy (paint->origin_uv_m, origin_uv_m, sizeof paint->origin_uv_m);
  paint->px_per_m[0] = width / size_m[0];
  paint->px_per_m[1] = height / size_m[1];
  level_init (level, width, height, n_channels);
  for (gint y = 0; y < height; y++) {
    const gsize count = (gsize) width * n_channels;
    const guint8 *row = data + (gssize) y * stride;
    gfloat *to = level->data + (gsize) y * count;

    for (gsize i = 0; i < count; i++)
      to[i] = light[row[i]];
  }
  memset (level->flat, 1, (gsize) width * (gsize) height);
  paint->n_levels = 1;
  while ((level->width > 1 || level->height > 1)
      && paint->n_levels < CLOTH_PAINT_MAX_LEVELS) {
    halve (level, level + 1, n_channels);
    level++;
    paint->n_levels++;
  }
  for (guint i = 0; i < paint->n_levels; i++)
    narrow (&paint->levels[i], n_channels);
  return paint;
}

/* @paint: (nullable) (transfer full): a paint
 */
void
cloth_paint_free (ClothPaint * paint)
{
  if (!paint)
    return;
  for (guint i = 0; i < paint->n_levels; i++) {
    g_free (paint->levels[i].data);
    g_free (paint->levels[i].flat);
  }
  g_free (paint);
}
