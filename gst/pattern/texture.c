/* The printed cloth as an anti-aliased picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/texture.h"

#include <cairo.h>
#include <math.h>
#include <string.h>

/* Points a side that a pixel under the edge of a dot is sampled with. */
#define DOT_SAMPLES 16

/* Over [a, b] in squares: @share becomes the part of it on the board, the value is the
 * mean of +1 on even squares, −1 on odd ones, 0 off the board. */
static gdouble
mean_wave (gdouble a, gdouble b, gint squares, gdouble * share)
{
  const gdouble lo = CLAMP (a, 0, squares), hi = CLAMP (b, 0, squares);
  gdouble sum = 0;

  *share = (hi - lo) / (b - a);
  for (gint n = (gint) lo; n < squares && n < hi; n++) {
    gdouble length = MIN (hi, n + 1) - MAX (lo, n);

    sum += n & 1 ? -length : length;
  }
  return sum / (b - a);
}

/* Part of the pixel [x, x + w] × [y, y + w], in squares, under the dot's disc. */
static gdouble
dot_share (gdouble x, gdouble y, gdouble w, gdouble cx, gdouble cy,
    gdouble radius)
{
  const gdouble far_x = MAX (fabs (x - cx), fabs (x + w - cx));
  const gdouble far_y = MAX (fabs (y - cy), fabs (y + w - cy));
  const gdouble near_x = MAX (0, MAX (x - cx, cx - x - w));
  const gdouble near_y = MAX (0, MAX (y - cy, cy - y - w));
  gint hits = 0;

  if (near_x * near_x + near_y * near_y >= radius * radius)
    return 0;
  if (far_x * far_x + far_y * far_y <= radius * radius)
    return 1;
  for (gint j = 0; j < DOT_SAMPLES; j++) {
    for (gint i = 0; i < DOT_SAMPLES; i++) {
      gdouble dx = x + w * (i + 0.5) / DOT_SAMPLES - cx;
      gdouble dy = y + w * (j + 0.5) / DOT_SAMPLES - cy;

      hits += dx * dx + dy * dy < radius * radius;
    }
  }
  return (gdouble) hits / (DOT_SAMPLES * DOT_SAMPLES);
}

/* What the dots add to the whiteness of the pixel whose top-left is (x, y), squares. */
static gdouble
dots_white (const ClothPattern * pattern, gdouble x, gdouble y, gdouble w)
{
  gdouble white = 0;

  if (!pattern->code)
    return 0;
  for (gint row = MAX (0, (gint) floor (y)); row < pattern->rows && row < y + w;
      row++) {
    for (gint column = MAX (0, (gint) floor (x));
        column < pattern->columns && column < x + w; column++) {
      gdouble share;

      if (!cloth_pattern_has_dot (pattern, column, row))
        continue;
      share = dot_share (x, y, w, column + 0.5, row + 0.5,
          pattern->dot_ratio / 2);
      white += cloth_pattern_is_black (pattern, column, row) ? share : -share;
    }
  }
  return white;
}

static ClothTexture *
texture_new (const gdouble cloth_m[2], gdouble px_per_m, gint n_channels,
    GError ** error)
{
  ClothTexture *texture;
  gdouble size[2];

  for (gint i = 0; i < 2; i++) {
    size[i] = MAX (1, floor (cloth_m[i] * px_per_m + 0.5));
    if (!(px_per_m > 0 && size[i] <= CLOTH_TEXTURE_MAX_PX)) {
      g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
          "a texture of %g pixels per metre for %g m of cloth: use more than 0, "
          "and at most %d pixels a side", px_per_m, cloth_m[i],
          CLOTH_TEXTURE_MAX_PX);
      return NULL;
    }
  }
  texture = g_new0 (ClothTexture, 1);
  texture->width = (gint) size[0];
  texture->height = (gint) size[1];
  texture->n_channels = n_channels;
  texture->px_per_m = px_per_m;
  texture->data = g_malloc ((gsize) n_channels * (gsize) texture->width
      * (gsize) texture->height);
  return texture;
}

/* @pattern: a pattern
 * @px_per_m: scale, pixels per metre
 * @black: grey value of black
 * @white: grey value of white, and of the cloth outside the board
 * @error: return location
 *
 * Draws the flat cloth. Each pixel is the mean over its area: exact for squares (the
 * mean of a product of two square waves is the product of their means), within 1/256
 * for dots.
 *
 * Returns: (transfer full): a texture of round(cloth_m·px_per_m) pixels, at least 1
 *   each way; free with cloth_texture_free(). %NULL with %CLOTH_PATTERN_ERROR_VALUE
 *   when a side would exceed %CLOTH_TEXTURE_MAX_PX
 */
ClothTexture *
cloth_pattern_texture (const ClothPattern * pattern, gdouble px_per_m,
    guint8 black, guint8 white, GError ** error)
{
  ClothTexture *texture;
  gdouble w;

  if (!cloth_pattern_check (pattern, error))
    return NULL;
  texture = texture_new (pattern->cloth_m, px_per_m, 1, error);
  if (!texture)
    return NULL;
  w = 1 / (px_per_m * pattern->square_m);
  for (gint j = 0; j < texture->height; j++) {
    gdouble y = j * w - pattern->origin_uv_m[1] / pattern->square_m;
    gdouble share_y, wave_y = mean_wave (y, y + w, pattern->rows, &share_y);

    for (gint i = 0; i < texture->width; i++) {
      gdouble x = i * w - pattern->origin_uv_m[0] / pattern->square_m;
      gdouble share_x, wave_x =
          mean_wave (x, x + w, pattern->columns, &share_x);
      gdouble wave = pattern->first_black ? -wave_x * wave_y : wave_x * wave_y;
      gdouble part = 1 - share_x * share_y / 2 + wave / 2
          + dots_white (pattern, x, y, w);

      texture->data[(gsize) j * (gsize) texture->width + (gsize) i] =
          (guint8) (black + part * (white - black) + 0.5);
    }
  }
  return texture;
}

/* @array: an array of dots
 * @px_per_m: scale, pixels per metre
 * @ground: value of the cloth between the dots, in all three channels
 * @inks: red, green and blue of each of the array's colours
 * @error: return location
 *
 * Draws the flat cloth in colour. Each pixel is the mean over its area, within 1/256: give
 * and take values that are proportional to light.
 *
 * Returns: (transfer full): a texture of three channels and round(cloth_m·px_per_m)
 *   pixels, at least 1 each way; free with cloth_texture_free(). %NULL with
 *   %CLOTH_PATTERN_ERROR_VALUE when a side would exceed %CLOTH_TEXTURE_MAX_PX
 */
ClothTexture *
cloth_m_array_texture (const ClothMArray * array, gdouble px_per_m,
    guint8 ground, const guint8 (*inks)[3], GError ** error)
{
  const gdouble radius = array->diameter_m / 2 * px_per_m;
  ClothTexture *texture;

  if (!cloth_m_array_check (array, error))
    return NULL;
  texture = texture_new (array->cloth_m, px_per_m, 3, error);
  if (!texture)
    return NULL;
  memset (texture->data, ground, 3 * (gsize) texture->width
      * (gsize) texture->height);
  for (gint dot = 0; dot < array->rows * array->columns; dot++) {
    const guint8 *ink = inks[array->matrix[dot]];
    const gdouble x = (array->origin_uv_m[0]
        + dot % array->columns * array->pitch_m) * px_per_m;
    const gdouble y = (array->origin_uv_m[1]
        + dot / array->columns * array->pitch_m) * px_per_m;
    const gint left = MAX (0, (gint) floor (x - radius));
    const gint top = MAX (0, (gint) floor (y - radius));

    for (gint j = top; j < texture->height && j < y + radius; j++) {
      for (gint i = left; i < texture->width && i < x + radius; i++) {
        guint8 *to = texture->data + 3 * ((gsize) j * (gsize) texture->width
            + (gsize) i);
        const gdouble share = dot_share (i, j, 1, x, y, radius);

        for (gint c = 0; c < 3; c++)
          to[c] = (guint8) (to[c] + share * (ink[c] - to[c]) + 0.5);
      }
    }
  }
  return texture;
}

/* @texture: (nullable) (transfer full): a texture
 */
void
cloth_texture_free (ClothTexture * texture)
{
  if (!texture)
    return;
  g_free (texture->data);
  g_free (texture);
}

static cairo_status_t
append_bytes (void *closure, const unsigned char *data, unsigned int length)
{
  g_byte_array_append (closure, data, length);
  return CAIRO_STATUS_SUCCESS;
}

/* @texture: a texture
 * @error: return location
 *
 * Returns: (transfer full): the texture as a PNG file, or %NULL with
 *   %CLOTH_PATTERN_ERROR_PRINT
 */
GBytes *
cloth_texture_to_png (const ClothTexture * texture, GError ** error)
{
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  cairo_surface_t *surface = cairo_image_surface_create (CAIRO_FORMAT_RGB24,
      texture->width, texture->height);
  cairo_status_t status = cairo_surface_status (surface);

  if (status == CAIRO_STATUS_SUCCESS) {
    const gint stride = cairo_image_surface_get_stride (surface);
    const guint8 *from = texture->data;
    guint8 *data;

    cairo_surface_flush (surface);
    data = cairo_image_surface_get_data (surface);
    for (gint y = 0; y < texture->height; y++) {
      guint32 *row = (guint32 *) (data + (gsize) y * stride);

      for (gint x = 0; x < texture->width; x++, from += texture->n_channels)
        row[x] = texture->n_channels == 1 ? from[0] * 0x010101u
            : (guint32) from[0] << 16 | (guint32) from[1] << 8 | from[2];
    }
    cairo_surface_mark_dirty (surface);
    status = cairo_surface_write_to_png_stream (surface, append_bytes, bytes);
  }
  cairo_surface_destroy (surface);
  if (status == CAIRO_STATUS_SUCCESS)
    return g_byte_array_free_to_bytes (g_steal_pointer (&bytes));
  g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_PRINT,
      "the picture could not be written as PNG: %s",
      cairo_status_to_string (status));
  return NULL;
}
