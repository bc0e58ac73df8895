/* A print that is like no other part of itself.
 *
 * Features that look alike are what mismatches come from, and a camera sees those that are a
 * few of its pixels large. So there are shapes of all sizes: a layer for each half octave, the
 * small ones over the large ones, so that each place shows some of each size whatever the
 * distance. Each layer covers a part of what is below it; the rest of that is what is seen
 * from farther away.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/sheet.h"

#include <math.h>

#include "gst/math/random.h"

/* Radius of the smallest and of the largest shapes, mm: a film of 1.4 px/mm, as of a camera
 * with a lens of 60 degrees at 1 m, just resolves the smallest; at 3 m it sees more than ten
 * px of the largest. */
#define SMALLEST_MM 1.25
#define LARGEST_MM 40.0
/* From layer to layer. */
#define STEP G_SQRT2
/* Share of the sheet that a layer would cover if none of its shapes overlapped. */
#define COVER 0.3
#define LEAST_CORNERS 3
/* Corners lie this share of the radius away from the middle at least. */
#define NEAREST 0.5
/* What prints and what is told apart in any light. */
#define GREYS 4
/* Of the reference: twice what the smallest shapes need, and what a large sheet allows. */
#define PX_PER_MM 1.5
#define MOST_PX 4096

static ClothSheetShape
make_shape (ClothRandom * random, const gdouble size_mm[2], gdouble radius)
{
  ClothSheetShape shape = {.radius = (gfloat) radius };
  const gdouble turn = 2 * G_PI * cloth_random_uniform (random);

  shape.n = (guint8) (LEAST_CORNERS + cloth_random_below (random,
          CLOTH_SHEET_CORNERS - LEAST_CORNERS + 1));
  shape.grey = (guint8) (255 * cloth_random_below (random, GREYS)
      / (GREYS - 1));
  for (guint i = 0; i < 2; i++)
    shape.middle[i] = (gfloat) (size_mm[i] * cloth_random_uniform (random));
  for (guint k = 0; k < shape.n; k++) {
    const gdouble angle = turn + 2 * G_PI * (k
        + 0.7 * cloth_random_uniform (random)) / shape.n;
    const gdouble far = radius * (NEAREST
        + (1 - NEAREST) * cloth_random_uniform (random));

    shape.corners[2 * k] = (gfloat) (far * cos (angle));
    shape.corners[2 * k + 1] = (gfloat) (far * sin (angle));
  }
  return shape;
}

/* @cloth_m: width and height, metres, %CLOTH_SHEET_MIN to %CLOTH_SHEET_MAX
 * @seed: which sheet: equal seeds give equal sheets
 * @error: return location
 *
 * Returns: (transfer full): the sheet; free with cloth_sheet_free(). %NULL with
 *   %CLOTH_PATTERN_ERROR_VALUE when a size is outside its limits
 */
ClothSheet *
cloth_sheet_new (const gdouble cloth_m[2], guint64 seed, GError ** error)
{
  g_autoptr (GArray) shapes =
      g_array_new (FALSE, FALSE, sizeof (ClothSheetShape));
  const gdouble size_mm[2] = { 1000 * cloth_m[0], 1000 * cloth_m[1] };
  ClothSheet *sheet;
  ClothRandom random;

  for (guint i = 0; i < 2; i++) {
    if (!(cloth_m[i] >= CLOTH_SHEET_MIN && cloth_m[i] <= CLOTH_SHEET_MAX)) {
      g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
          "a sheet %g m %s: %g to %g m are drawn", cloth_m[i],
          i ? "high" : "wide", CLOTH_SHEET_MIN, CLOTH_SHEET_MAX);
      return NULL;
    }
  }
  cloth_random_init (&random, seed);
  for (gdouble radius = LARGEST_MM; radius > 0.99 * SMALLEST_MM; radius /= STEP) {
    const guint n = (guint) ceil (COVER * size_mm[0] * size_mm[1]
        / (G_PI * radius * radius));

    for (guint i = 0; i < n; i++) {
      const ClothSheetShape shape = make_shape (&random, size_mm, radius);

      g_array_append_val (shapes, shape);
    }
  }
  sheet = g_new0 (ClothSheet, 1);
  sheet->cloth_m[0] = cloth_m[0];
  sheet->cloth_m[1] = cloth_m[1];
  sheet->seed = seed;
  sheet->n_shapes = shapes->len;
  sheet->shapes = (ClothSheetShape *) g_array_free (g_steal_pointer (&shapes),
      FALSE);
  return sheet;
}

/* @sheet: (nullable) (transfer full): a sheet
 */
void
cloth_sheet_free (ClothSheet * sheet)
{
  if (!sheet)
    return;
  g_free (sheet->shapes);
  g_free (sheet);
}

/* @sheet: a sheet
 * @cr: where to; its unit is the mm, from the sheet's top-left corner
 * @view: x, y, width and height of what is needed, mm
 *
 * Draws the sheet. What reaches out of it is drawn as well.
 */
void
cloth_sheet_draw (const ClothSheet * sheet, cairo_t * cr, const gdouble view[4])
{
  cairo_set_source_rgb (cr, 1, 1, 1);
  cairo_rectangle (cr, view[0], view[1], view[2], view[3]);
  cairo_fill (cr);
  for (guint i = 0; i < sheet->n_shapes; i++) {
    const ClothSheetShape *shape = &sheet->shapes[i];
    const gdouble x = shape->middle[0], y = shape->middle[1];
    const gdouble radius = shape->radius, grey = shape->grey / 255.0;

    if (x + radius < view[0] || x - radius > view[0] + view[2]
        || y + radius < view[1] || y - radius > view[1] + view[3])
      continue;
    for (guint k = 0; k < shape->n; k++)
      cairo_line_to (cr, x + shape->corners[2 * k],
          y + shape->corners[2 * k + 1]);
    cairo_close_path (cr);
    cairo_set_source_rgb (cr, grey, grey, grey);
    cairo_fill (cr);
  }
}

/* @sheet: a sheet
 * @error: return location
 *
 * Returns: (transfer full): the sheet in grey, its edges those of the picture; free with
 *   cloth_texture_free(). %NULL with %CLOTH_PATTERN_ERROR_PRINT
 */
ClothTexture *
cloth_sheet_texture (const ClothSheet * sheet, GError ** error)
{
  const gdouble view[4] = { 0, 0, 1000 * sheet->cloth_m[0],
    1000 * sheet->cloth_m[1]
  };
  const gdouble px_per_mm = MIN (PX_PER_MM, MOST_PX / MAX (view[2], view[3]));
  const gint width = (gint) lrint (view[2] * px_per_mm);
  const gint height = (gint) lrint (view[3] * px_per_mm);
  cairo_surface_t *surface =
      cairo_image_surface_create (CAIRO_FORMAT_RGB24, width, height);
  cairo_t *cr = cairo_create (surface);
  g_autoptr (ClothTexture) texture = g_new0 (ClothTexture, 1);
  cairo_status_t status;

  texture->width = width;
  texture->height = height;
  texture->n_channels = 1;
  texture->data = g_malloc ((gsize) width * height);
  texture->px_per_m = 1000 * px_per_mm;
  /* whole pixels, which the sheet's edges are the edges of */
  cairo_scale (cr, width / view[2], height / view[3]);
  cairo_set_antialias (cr, CAIRO_ANTIALIAS_BEST);
  cloth_sheet_draw (sheet, cr, view);
  status = cairo_status (cr);
  cairo_destroy (cr);
  cairo_surface_flush (surface);
  if (status == CAIRO_STATUS_SUCCESS) {
    const guint8 *data = cairo_image_surface_get_data (surface);
    const gint stride = cairo_image_surface_get_stride (surface);

    for (gint y = 0; y < height; y++)
      for (gint x = 0; x < width; x++)
        texture->data[(gsize) y * width + x] =
            (guint8) (((const guint32 *) (data + (gsize) y * stride))[x]);
  }
  cairo_surface_destroy (surface);
  if (status == CAIRO_STATUS_SUCCESS)
    return g_steal_pointer (&texture);
  g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_PRINT,
      "drawing the sheet failed: %s", cairo_status_to_string (status));
  return NULL;
}
