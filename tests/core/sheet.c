/* Sheets of random shapes: equal for equal seeds, at true size, unlike themselves elsewhere, with
 * something to see at every size.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/print.h"

#include <cairo.h>
#include <math.h>
#include <string.h>

static const gdouble size_m[2] = { 0.3, 0.2 };

static ClothSheet *
made (guint64 seed)
{
  g_autoptr (GError) error = NULL;
  ClothSheet *sheet = cloth_sheet_new (size_m, seed, &error);

  g_assert_no_error (error);
  return sheet;
}

static ClothTexture *
drawn (const ClothSheet * sheet)
{
  g_autoptr (GError) error = NULL;
  ClothTexture *texture = cloth_sheet_texture (sheet, &error);

  g_assert_no_error (error);
  return texture;
}

static void
test_deterministic (void)
{
  g_autoptr (ClothSheet) a = made (7);
  g_autoptr (ClothSheet) b = made (7);
  g_autoptr (ClothSheet) c = made (8);
  const gsize size = a->n_shapes * sizeof *a->shapes;

  g_assert_cmpuint (a->n_shapes, ==, b->n_shapes);
  g_assert_cmpmem (a->shapes, size, b->shapes, size);
  g_assert_cmpint (memcmp (a->shapes, c->shapes, size), !=, 0);
}

/* The large ones lie under the small ones; each layer's circles would cover as much as every
 * other's, to a shape. */
static void
test_layers (void)
{
  g_autoptr (ClothSheet) sheet = made (1);
  const gdouble area = 300 * 200;
  guint first = 0, layers = 0;

  for (guint i = 1; i <= sheet->n_shapes; i++) {
    const gdouble radius = sheet->shapes[first].radius;

    if (i < sheet->n_shapes && sheet->shapes[i].radius == radius)
      continue;
    g_assert_cmpfloat_with_epsilon ((i - first) * G_PI * radius * radius / area,
        0.3, G_PI * radius * radius / area);
    if (i < sheet->n_shapes)
      g_assert_cmpfloat (sheet->shapes[i].radius, <, radius);
    first = i;
    layers++;
  }
  g_assert_cmpfloat_with_epsilon (sheet->shapes[0].radius, 40, 1e-6);
  g_assert_cmpfloat_with_epsilon (sheet->shapes[sheet->n_shapes - 1].radius,
      1.25, 1e-4);
  g_assert_cmpuint (layers, ==, 11);
  for (guint i = 0; i < sheet->n_shapes; i++) {
    const ClothSheetShape *shape = &sheet->shapes[i];

    g_assert_true (shape->n >= 3 && shape->n <= CLOTH_SHEET_CORNERS);
    for (guint k = 0; k < shape->n; k++)
      g_assert_cmpfloat (hypot (shape->corners[2 * k],
              shape->corners[2 * k + 1]), <=, 1.0001 * shape->radius);
  }
}

/* A square drawn by hand: its edges are on pixels' edges, 1.5 px a mm. */
static void
test_true_size (void)
{
  ClothSheetShape square = { 4, 85, 15, {20, 30}, {-10, -10, 10, -10, 10, 10,
      -10, 10}
  };
  const ClothSheet sheet = { {0.06, 0.05}, 1, 1, &square };
  g_autoptr (ClothTexture) texture = drawn (&sheet);

  g_assert_cmpint (texture->width, ==, 90);
  g_assert_cmpint (texture->height, ==, 75);
  g_assert_cmpfloat_with_epsilon (texture->px_per_m, 1500, 1e-9);
  for (gint y = 0; y < 75; y++)
    for (gint x = 0; x < 90; x++)
      g_assert_cmpint (texture->data[y * 90 + x], ==,
          x >= 15 && x < 45 && y >= 30 && y < 60 ? 85 : 255);
}

/* Correlation of the sheet with itself moved by so many pixels. */
static gdouble
correlation (const ClothTexture * t, gint dx, gint dy)
{
  gdouble sum[2] = { 0 }, square[2] = { 0 }, product = 0, n = 0;

  for (gint y = 0; y + dy < t->height; y++)
    for (gint x = 0; x + dx < t->width; x++, n++) {
      const gdouble a = t->data[y * t->width + x];
      const gdouble b = t->data[(y + dy) * t->width + x + dx];

      sum[0] += a;
      sum[1] += b;
      square[0] += a * a;
      square[1] += b * b;
      product += a * b;
    }
  return (product - sum[0] * sum[1] / n) / sqrt ((square[0] - sum[0] * sum[0]
          / n) * (square[1] - sum[1] * sum[1] / n));
}

static void
test_unlike_itself (void)
{
  g_autoptr (ClothSheet) sheet = made (3);
  g_autoptr (ClothTexture) texture = drawn (sheet);

  g_assert_cmpfloat_with_epsilon (correlation (texture, 0, 0), 1, 1e-9);
  /* farther than the largest shapes reach, 80 mm */
  for (gint dx = 125; dx < 300; dx += 7)
    g_assert_cmpfloat (fabs (correlation (texture, dx, 0)), <, 0.2);
  for (gint dy = 125; dy < 200; dy += 7)
    g_assert_cmpfloat (fabs (correlation (texture, 60, dy)), <, 0.2);
}

/* Standard deviation of the means of neighbouring boxes, grey levels: what is left to see
 * when a box is a pixel. */
static gdouble
contrast (const ClothTexture * t, gint box)
{
  gdouble sum = 0, square = 0, n = 0;

  for (gint y = 0; y + box <= t->height; y += box)
    for (gint x = 0; x + box <= t->width; x += box, n++) {
      gdouble mean = 0;

      for (gint j = 0; j < box; j++)
        for (gint i = 0; i < box; i++)
          mean += t->data[(y + j) * t->width + x + i];
      mean /= box * box;
      sum += mean;
      square += mean * mean;
    }
  return sqrt (square / n - sum * sum / (n * n));
}

/* Boxes of 0.7, 1.3, 2.7, 5.3, 11 and 21 mm: independent pixels would have half as much left
 * from one to the next. */
static void
test_all_sizes (void)
{
  g_autoptr (ClothSheet) sheet = made (5);
  g_autoptr (ClothTexture) texture = drawn (sheet);
  gdouble last = 256;

  for (gint box = 1; box <= 32; box *= 2) {
    const gdouble left = contrast (texture, box);

    g_test_message ("%d px: %.1f grey levels", box, left);
    g_assert_cmpfloat (left, >, 10);
    g_assert_cmpfloat (left, <, last);
    last = left;
  }
}

static cairo_status_t
read_bytes (void *closure, unsigned char *data, unsigned int length)
{
  GByteArray *bytes = closure;

  if (length > bytes->len)
    return CAIRO_STATUS_READ_ERROR;
  memcpy (data, bytes->data, length);
  g_byte_array_remove_range (bytes, 0, length);
  return CAIRO_STATUS_SUCCESS;
}

/* The file has the same pixels, grey and coloured ones. */
static void
test_png (void)
{
  guint8 data[3 * 7 * 5];

  for (guint i = 0; i < sizeof data; i++)
    data[i] = (guint8) (i * 37);
  for (gint channels = 1; channels <= 3; channels += 2) {
    const ClothTexture texture = { 7, 5, channels, data, 1000 };
    g_autoptr (GError) error = NULL;
    g_autoptr (GBytes) png = cloth_texture_to_png (&texture, &error);
    g_autoptr (GByteArray) bytes = NULL;
    cairo_surface_t *surface;

    g_assert_no_error (error);
    bytes = g_bytes_unref_to_array (g_bytes_ref (png));
    surface = cairo_image_surface_create_from_png_stream (read_bytes, bytes);
    g_assert_cmpint (cairo_surface_status (surface), ==, CAIRO_STATUS_SUCCESS);
    g_assert_cmpint (cairo_image_surface_get_width (surface), ==, 7);
    g_assert_cmpint (cairo_image_surface_get_height (surface), ==, 5);
    for (gint y = 0; y < 5; y++) {
      const guint32 *row = (const guint32 *) (gconstpointer)
          (cairo_image_surface_get_data (surface)
          + y * cairo_image_surface_get_stride (surface));

      for (gint x = 0; x < 7; x++)
        for (gint c = 0; c < 3; c++)
          g_assert_cmpuint (row[x] >> (16 - 8 * c) & 255, ==,
              data[(y * 7 + x) * channels + (channels == 3 ? c : 0)]);
    }
    cairo_surface_destroy (surface);
  }
}

/* A texture without pixels can't be a file. */
static void
test_png_refused (void)
{
  guint8 data = 0;
  const ClothTexture textures[] = { {-1, 5, 1, &data, 1000}, {1, 40000, 1,
      &data, 1000}
  };

  for (guint i = 0; i < G_N_ELEMENTS (textures); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_texture_to_png (&textures[i], &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_PRINT);
  }
}

/* The largest sheet is a picture that can still be matched with. */
static void
test_largest (void)
{
  static const gdouble largest[2] = { 3, 0.1 };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSheet) sheet = cloth_sheet_new (largest, 1, &error);
  g_autoptr (ClothTexture) texture = NULL;

  g_assert_no_error (error);
  texture = drawn (sheet);
  g_assert_cmpint (texture->width, ==, 4096);
  g_assert_cmpint (texture->height, ==, 137);
}

static void
test_refused (void)
{
  static const gdouble sizes[][2] = { {0, 1}, {1, 0}, {0.049, 1}, {1, -1},
  {3.01, 1}, {1, 630}, {NAN, 1}, {1, NAN}, {INFINITY, 1}
  };

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_sheet_new (sizes[i], 1, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
    g_test_message ("→ %s", error->message);
    g_assert_nonnull (strstr (error->message, "0.05 to 3 m"));
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sheet/deterministic", test_deterministic);
  g_test_add_func ("/sheet/layers", test_layers);
  g_test_add_func ("/sheet/true-size", test_true_size);
  g_test_add_func ("/sheet/unlike-itself", test_unlike_itself);
  g_test_add_func ("/sheet/all-sizes", test_all_sizes);
  g_test_add_func ("/sheet/png", test_png);
  g_test_add_func ("/sheet/png-refused", test_png_refused);
  g_test_add_func ("/sheet/largest", test_largest);
  g_test_add_func ("/sheet/refused", test_refused);
  return g_test_run ();
}
