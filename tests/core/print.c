/* Print files: rasterised by poppler and librsvg at a known resolution, then measured.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/code.h"
#include "gst/pattern/print.h"

#include <cairo.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* 254 dots per inch are 10 px per mm. */
#define DPI "254"
#define PX 10

#define BOARD(pattern) (&(const ClothArtwork) { pattern, NULL })

typedef struct
{
  gint width, height;
  guint8 *grey;                 /* their green */
  guint8 *rgb;
} Raster;

static void
raster_clear (Raster * raster)
{
  g_free (raster->grey);
  g_free (raster->rgb);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Raster, raster_clear);

static gchar *folder;

static gchar *
in_folder (const gchar * name)
{
  return g_build_filename (folder, name, NULL);
}

static void
run (const gchar * const *argv)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *says = NULL;
  gint status;

  g_spawn_sync (NULL, (gchar **) argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL,
      NULL, &says, &status, &error);
  g_assert_no_error (error);
  if (!g_spawn_check_wait_status (status, &error))
    g_test_message ("%s: %s", argv[0], says);
  g_assert_no_error (error);
}

/* Over white, as the last pixels of a page may lie half outside it. */
static Raster
read_png (const gchar * path)
{
  cairo_surface_t *surface = cairo_image_surface_create_from_png (path);
  gboolean opaque;
  Raster raster;

  g_assert_cmpint (cairo_surface_status (surface), ==, CAIRO_STATUS_SUCCESS);
  raster.width = cairo_image_surface_get_width (surface);
  raster.height = cairo_image_surface_get_height (surface);
  raster.grey = g_malloc ((gsize) raster.width * (gsize) raster.height);
  raster.rgb = g_malloc (3 * (gsize) raster.width * (gsize) raster.height);
  opaque = cairo_image_surface_get_format (surface) == CAIRO_FORMAT_RGB24;
  for (gint y = 0; y < raster.height; y++) {
    const guint8 *row = cairo_image_surface_get_data (surface)
        + (gsize) y * (gsize) cairo_image_surface_get_stride (surface);

    for (gint x = 0; x < raster.width; x++) {
      const gsize at = (gsize) y * (gsize) raster.width + (gsize) x;
      const guint8 white = opaque ? 0 : 255 - row[4 * x + 3];

      for (gint i = 0; i < 3; i++)
        raster.rgb[3 * at + i] = (guint8) (row[4 * x + 2 - i] + white);
      raster.grey[at] = raster.rgb[3 * at + 1];
    }
  }
  cairo_surface_destroy (surface);
  return raster;
}

static Raster
raster_pdf (const gchar * pdf, gint page)
{
  g_autofree gchar *number = g_strdup_printf ("%d", page);
  g_autofree gchar *stem = in_folder ("page");
  g_autofree gchar *png = in_folder ("page.png");
  const gchar *argv[] = { "pdftoppm", "-r", DPI, "-png", "-singlefile", "-f",
    number, "-l", number, pdf, stem, NULL
  };
  Raster raster;

  run (argv);
  raster = read_png (png);
  g_unlink (png);
  return raster;
}

static Raster
raster_svg (const gchar * svg)
{
  g_autofree gchar *png = in_folder ("sheet.png");
  const gchar *argv[] = { "rsvg-convert", "--dpi-x", DPI, "--dpi-y", DPI, svg,
    "--output", png, NULL
  };
  Raster raster;

  run (argv);
  raster = read_png (png);
  g_unlink (png);
  return raster;
}

/* Where the grey crosses the middle between pixels, along a row or a column. */
static guint
crossings (const Raster * raster, gboolean along_row, gint line, gint from,
    gint to, gdouble * at, guint most)
{
  const gint step = along_row ? 1 : raster->width;
  const guint8 *p =
      raster->grey + (along_row ? (gsize) line * (gsize) raster->width
      : (gsize) line);
  guint n = 0;

  for (gint i = from; i + 1 < to; i++) {
    const gdouble a = p[(gsize) i * (gsize) step] - 127.5;
    const gdouble b = p[(gsize) (i + 1) * (gsize) step] - 127.5;

    if ((a < 0) != (b < 0) && n < most)
      at[n++] = i + 0.5 + a / (a - b);
  }
  return n;
}

static void
check_size (const Raster * raster, const ClothPattern * pattern,
    const gchar * what)
{
  const gdouble square = pattern->square_m * 1000 * PX;
  const gint left = PX * 10 + (gint) (pattern->origin_uv_m[0] * 1000 * PX);
  const gint top = PX * 10 + (gint) (pattern->origin_uv_m[1] * 1000 * PX);
  const gint below = PX * 10 + (gint) (pattern->cloth_m[1] * 1000 * PX + 0.5);
  gdouble at[300], most = 0, across, down, ruler;
  guint n;

  /* Through the first row of squares, above the dots; then the first column. */
  n = crossings (raster, TRUE, top + (gint) (square / 8), 0, raster->width, at,
      300);
  g_assert_cmpuint (n, ==,
      (guint) (pattern->columns + !!pattern->first_black) / 2 * 2);
  for (guint i = 0; i + 1 < n; i++)
    most = MAX (most, fabs (at[i + 1] - at[i] - square));
  across = (at[n - 1] - at[0]) / (square * (n - 1)) - 1;
  g_assert_cmpfloat (fabs (at[0] - left - (pattern->first_black ? 0 :
              square)), <, 1);
  n = crossings (raster, FALSE, left + (gint) (square / 8), 0, below, at, 300);
  for (guint i = 0; i + 1 < n; i++)
    most = MAX (most, fabs (at[i + 1] - at[i] - square));
  down = (at[n - 1] - at[0]) / (square * (n - 1)) - 1;
  /* The middles of the ruler's first and last tick: the longest ones, 10 mm apart. */
  n = crossings (raster, TRUE, below + (gint) (10.7 * PX), PX * 10, PX * 112,
      at, 300);
  g_assert_cmpuint (n, ==, 22);
  ruler = ((at[21] + at[20]) - (at[1] + at[0])) / 2 / (100 * PX) - 1;
  g_test_message ("%s: width %+.4f%%, height %+.4f%%, ruler %+.4f%%, edges "
      "within %.2f px", what, 100 * across, 100 * down, 100 * ruler, most);
  g_assert_cmpfloat (fabs (across), <=, 0.001);
  g_assert_cmpfloat (fabs (down), <=, 0.001);
  g_assert_cmpfloat (fabs (ruler), <=, 0.001);
  g_assert_cmpfloat (most, <=, 1);
}

static ClothPattern *
board (gint columns, gint rows, gdouble square, gboolean first_black,
    gboolean coded)
{
  ClothPattern *pattern = cloth_pattern_new_checker (columns, rows, square,
      0.01, first_black, NULL);

  if (coded)
    g_assert_true (cloth_code_generate (pattern, CLOTH_CODE_DOT_RATIO, 1, NULL,
            NULL));
  return pattern;
}

static void
test_true_size (void)
{
  for (gint n = 0; n < 4; n++) {
    g_autoptr (GError) error = NULL;
    /* 12.7 mm: an edge that is no whole number of pixels. */
    g_autoptr (ClothPattern) pattern =
        board (9, 6, n & 1 ? 0.0127 : 0.02, !(n & 2), n & 1);
    ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
    g_autofree gchar *pdf = in_folder ("board.pdf");
    g_autofree gchar *svg = in_folder ("board.svg");
    g_auto (GStrv) pdf_names = NULL;
    g_auto (GStrv) svg_names = NULL;
    g_auto (Raster) pdf_raster = { 0 };
    g_auto (Raster) svg_raster = { 0 };

    if (n == 3)
      g_assert_true (cloth_print_paper ("A4", options.paper_mm));
    pdf_names = cloth_print_save (BOARD (pattern), &options, pdf, &error);
    g_assert_no_error (error);
    svg_names = cloth_print_save (BOARD (pattern), &options, svg, &error);
    g_assert_no_error (error);
    g_assert_cmpstr (svg_names[0], ==, svg);
    g_assert_null (svg_names[1]);
    pdf_raster = raster_pdf (pdf, 1);
    svg_raster = raster_svg (svg);
    if (n == 3) {
      g_assert_cmpint (ABS (pdf_raster.width - 2100), <=, 1);
      g_assert_cmpint (ABS (pdf_raster.height - 2970), <=, 1);
      g_assert_cmpint (ABS (svg_raster.width - 2100), <=, 1);
    }
    check_size (&pdf_raster, pattern, "PDF");
    check_size (&svg_raster, pattern, "SVG");
    g_unlink (pdf);
    g_unlink (svg);
  }
}

/* The sheets, cut at their tiles and laid at their places, give the picture of the
 * single page, and where they overlap they agree. */
static void
test_tiles_reassemble (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern = board (10, 11, 0.02, FALSE, TRUE);
  ClothPrintOptions one = CLOTH_PRINT_OPTIONS_INIT;
  ClothPrintOptions many = CLOTH_PRINT_OPTIONS_INIT;
  ClothPrintLayout layout;
  g_autofree gchar *pdf = in_folder ("board.pdf");
  g_autofree gchar *svg = in_folder ("board.svg");
  g_autofree gchar *whole_svg = in_folder ("whole.svg");
  g_auto (GStrv) names = NULL;
  g_auto (GStrv) pdf_names = NULL;
  g_auto (GStrv) whole = NULL;
  g_auto (Raster) truth = { 0 };
  g_autofree guint8 *covered = NULL;
  gint sheets, differences[2] = { 0, 0 }, holes = 0;

  g_assert_true (cloth_print_paper ("A5", many.paper_mm));
  g_assert_true (cloth_print_layout (BOARD (pattern), &many, &layout, &error));
  sheets = layout.sheets[0] * layout.sheets[1];
  g_assert_cmpint (sheets, ==, 4);
  whole = cloth_print_save (BOARD (pattern), &one, whole_svg, &error);
  names = cloth_print_save (BOARD (pattern), &many, svg, &error);
  pdf_names = cloth_print_save (BOARD (pattern), &many, pdf, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (g_strv_length (names), ==, 4);
  g_assert_true (g_str_has_suffix (names[1], "board-1-2.svg"));
  truth = raster_svg (whole_svg);
  covered = g_malloc0 (2200 * 2400);
  for (gint n = 0; n < 4; n++) {
    g_auto (Raster) sheet = raster_svg (names[n]);
    g_auto (Raster) page = raster_pdf (pdf, n + 1);
    const gint x0 = n % 2 * (gint) round (layout.step_mm[0] * PX);
    const gint y0 = n / 2 * (gint) round (layout.step_mm[1] * PX);

    g_assert_cmpint (ABS (sheet.width - page.width), <=, 1);
    for (gint y = 0; y < (gint) round (layout.tile_mm[3] * PX); y++) {
      for (gint x = 0; x < (gint) round (layout.tile_mm[2] * PX); x++) {
        gint expected, at = (y + 100) * sheet.width + x + 100;

        if (x0 + x >= 2200 || y0 + y >= 2400)
          continue;
        covered[(y0 + y) * 2200 + x0 + x] = 1;
        expected = truth.grey[(y0 + y + 100) * truth.width + x0 + x + 100];
        /* 8 grey levels on a dot's rim are 0.03 px, 3 µm. */
        differences[0] += ABS (sheet.grey[at] - expected) > 8;
        /* Poppler draws edges its own way: only what is clearly not an edge. */
        if (expected == 0 || expected == 255)
          differences[1] +=
              ABS (page.grey[(y + 100) * page.width + x + 100] -
              expected) > 200;
      }
    }
    g_unlink (names[n]);
  }
  for (gint i = 0; i < 2200 * 2400; i++)
    holes += !covered[i];
  g_test_message ("%d sheets: %d differing pixels in SVG, %d in PDF, %d px of "
      "cloth on no sheet", sheets, differences[0], differences[1], holes);
  g_assert_cmpint (differences[0], ==, 0);
  g_assert_cmpint (differences[1], ==, 0);
  g_assert_cmpint (holes, ==, 0);
  g_unlink (pdf);
  g_unlink (whole_svg);
}

/* The dots are where the code says, of the right colour and size. */
static void
test_dots (void)
{
  g_autoptr (ClothPattern) pattern = board (8, 8, 0.02, TRUE, TRUE);
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  g_autofree gchar *svg = in_folder ("board.svg");
  g_auto (GStrv) names =
      cloth_print_save (BOARD (pattern), &options, svg, NULL);
  g_auto (Raster) raster = raster_svg (svg);

  g_assert_cmpuint (g_strv_length (names), ==, 1);
  for (gint row = 0; row < 8; row++) {
    for (gint column = 0; column < 8; column++) {
      const gboolean black = (row + column) % 2 == 0;
      gdouble light = 0, expected = black ? 0 : 1;

      for (gint y = 0; y < 200; y++)
        for (gint x = 0; x < 200; x++)
          light += raster.grey[(200 + 200 * row + y) * raster.width + 200 +
              200 * column + x] / 255.0 / 40000;
      if (pattern->code[row * 8 + column])
        expected += (black ? 1 : -1) * G_PI * 0.15 * 0.15;
      g_assert_cmpfloat_with_epsilon (light, expected, 2e-4);
    }
  }
  g_unlink (svg);
}

/* Each dot's colour at its centre; its area and its centre of gravity from its green,
 * against what the pattern says. */
static void
check_m_array (const Raster * raster, const ClothMArray * array,
    const gchar * what)
{
  const gint half = (gint) (array->pitch_m * 1000 * PX / 2);
  const gdouble area = G_PI / 4 * pow (array->diameter_m * 1000 * PX, 2);
  gdouble most_off = 0, most_area = 0;

  for (gint n = 0; n < array->columns * array->rows; n++) {
    const gdouble x = (10 + 1000 * (array->origin_uv_m[0]
            + n % array->columns * array->pitch_m)) * PX - 0.5;
    const gdouble y = (10 + 1000 * (array->origin_uv_m[1]
            + n / array->columns * array->pitch_m)) * PX - 0.5;
    const guint8 *rgb = array->colours[array->matrix[n]].rgb;
    gdouble sum = 0, sx = 0, sy = 0;

    for (gint j = (gint) y - half + 2; j <= (gint) y + half - 1; j++) {
      for (gint i = (gint) x - half + 2; i <= (gint) x + half - 1; i++) {
        const gdouble g = raster->grey[j * raster->width + i];

        sum += g;
        sx += g * (i - x);
        sy += g * (j - y);
      }
    }
    most_off = MAX (most_off, hypot (sx, sy) / sum);
    most_area = MAX (most_area, fabs (sum / rgb[1] / area - 1));
    for (gint i = 0; i < 3; i++)
      g_assert_cmpint (ABS (raster->rgb[3 * ((gint) y * raster->width +
                      (gint) x) + i] - rgb[i]), <=, 1);
    /* The ground between four dots. */
    g_assert_cmpint (raster->grey[((gint) y - half + 2) * raster->width +
            (gint) x - half + 2], ==, 0);
  }
  g_test_message ("%s: centres within %.3f px, areas within %.2f%%", what,
      most_off, 100 * most_area);
  g_assert_cmpfloat (most_off, <=, 0.05);
  g_assert_cmpfloat (most_area, <=, 0.01);
}

static void
test_m_array (void)
{
  const ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMArray) array =
      cloth_m_array_new (7, 5, 8, 0.02, 0.013, 0.012, &code, &error);
  const ClothArtwork artwork = { NULL, array };
  g_autofree gchar *pdf = in_folder ("dots.pdf");
  g_autofree gchar *svg = in_folder ("dots.svg");
  g_auto (GStrv) pdf_names = cloth_print_save (&artwork, &options, pdf, NULL);
  g_auto (GStrv) svg_names = cloth_print_save (&artwork, &options, svg, NULL);
  g_auto (Raster) pdf_raster = { 0 };
  g_auto (Raster) svg_raster = { 0 };
  gint patches;

  g_assert_no_error (error);
  g_assert_cmpuint (g_strv_length (pdf_names), ==, 1);
  g_assert_cmpuint (g_strv_length (svg_names), ==, 1);
  pdf_raster = raster_pdf (pdf, 1);
  svg_raster = raster_svg (svg);
  check_m_array (&pdf_raster, array, "PDF");
  check_m_array (&svg_raster, array, "SVG");
  /* The patches of its colours: 25 mm of them, from 112.5 mm on, 11 to 15 mm below the
   * cloth. */
  patches = (gint) round ((10 + array->cloth_m[1] * 1000 + 13) * PX);
  for (gint i = 0; i < array->n_colours; i++) {
    const gint x = (gint) ((112.5 + (i + 0.5) * 25 / array->n_colours) * PX);

    for (gint k = 0; k < 3; k++)
      g_assert_cmpint (ABS (svg_raster.rgb[3 * (patches * svg_raster.width +
                      x) + k] - array->colours[i].rgb[k]), <=, 1);
  }
  g_unlink (pdf);
  g_unlink (svg);
}

static void
test_same_bytes (void)
{
  g_autoptr (ClothPattern) pattern = board (8, 8, 0.02, TRUE, TRUE);
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  g_autoptr (GBytes) pdf = NULL;
  g_autoptr (GBytes) pdf_again = NULL;
  g_autoptr (GBytes) pdf_dated = NULL;
  g_autoptr (GBytes) svg =
      cloth_print_svg (BOARD (pattern), &options, 0, 0, NULL);
  g_autoptr (GBytes) svg_again = NULL;
  gsize size;
  const gchar *text;

  g_unsetenv ("SOURCE_DATE_EPOCH");
  pdf = cloth_print_pdf (BOARD (pattern), &options, NULL);
  /* A second later the date would differ, if it were the clock's. */
  g_usleep (1100000);
  pdf_again = cloth_print_pdf (BOARD (pattern), &options, NULL);
  svg_again = cloth_print_svg (BOARD (pattern), &options, 0, 0, NULL);
  g_assert_true (g_bytes_equal (pdf, pdf_again));
  g_assert_true (g_bytes_equal (svg, svg_again));
  text = g_bytes_get_data (pdf, &size);
  g_assert_nonnull (memmem (text, size, "19700101000000Z", 15));
  g_setenv ("SOURCE_DATE_EPOCH", "1700000000", TRUE);
  pdf_dated = cloth_print_pdf (BOARD (pattern), &options, NULL);
  text = g_bytes_get_data (pdf_dated, &size);
  g_assert_nonnull (memmem (text, size, "20231114221320Z", 15));
  g_unsetenv ("SOURCE_DATE_EPOCH");
}

static void
test_paper (void)
{
  static const gchar *const unknown[] = { "", "A", "A9", "600", "600x",
    "600x900", "x900mm", "600x900cm", "-600x900mm", "0x900mm", "600x0mm",
    "nanxnanmm", "1e999x1mm", "600x900mmm", "600 x 900mm"
  };
  gdouble size[2];

  g_assert_true (cloth_print_paper ("a3", size));
  g_assert_cmpfloat (size[1], ==, 420);
  g_assert_true (cloth_print_paper ("600.5x900mm", size));
  g_assert_cmpfloat (size[0], ==, 600.5);
  g_assert_true (cloth_print_paper ("cloth", size));
  g_assert_cmpfloat (size[0], ==, 0);
  for (gsize i = 0; i < G_N_ELEMENTS (unknown); i++)
    g_assert_false (cloth_print_paper (unknown[i], size));
}

static void
test_layout (void)
{
  /* 500 × 250 mm on A4: 190 × 252 upright or 277 × 165 lying. Upright takes 3 by 1:
   * 190 + 180 + 130 mm; lying takes 2 by 2. */
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (10, 5, 0.05, 0, TRUE, NULL);
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  ClothPrintLayout layout;

  cloth_print_paper ("A4", options.paper_mm);
  g_assert_true (cloth_print_layout (BOARD (pattern), &options, &layout, NULL));
  g_assert_cmpint (layout.sheets[0], ==, 3);
  g_assert_cmpint (layout.sheets[1], ==, 1);
  g_assert_cmpfloat (layout.step_mm[0], ==, 180);
  g_assert_cmpfloat (layout.page_mm[0], ==, 210);
}

static void
test_refused (void)
{
  const struct
  {
    gdouble paper[2], margin, overlap, square;
  } cases[] = {
    {{100, 140}, 10, 10, 0.05}, {{210, 297}, -1, 10, 0.05},
    {{210, 297}, NAN, 10, 0.05}, {{210, 297}, 10, -1, 0.05},
    {{210, 297}, 10, NAN, 0.05}, {{210, 297}, 10, 99, 0.05},
    {{210, 297}, 85, 10, 0.05}, {{210, 297}, 10, 10, 5},
    {{0, 0}, 10, 10, 5}, {{9000, 9000}, 10, 10, 0.05},
    {{NAN, 297}, 10, 10, 0.05}
  };
  g_autofree gchar *path = in_folder ("never.pdf");

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothPattern) pattern =
        cloth_pattern_new_checker (8, 8, cases[i].square, 0, TRUE, NULL);
    const ClothPrintOptions options =
        { {cases[i].paper[0], cases[i].paper[1]}, cases[i].margin,
    cases[i].overlap
    };

    g_assert_null (cloth_print_save (BOARD (pattern), &options, path, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
    g_test_message ("%s", error->message);
    g_assert_false (g_file_test (path, G_FILE_TEST_EXISTS));
  }
}

static void
test_save_refused (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern = board (4, 4, 0.02, TRUE, FALSE);
  const ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;

  g_assert_null (cloth_print_save (BOARD (pattern), &options, "board.png",
          &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  g_clear_error (&error);
  g_assert_null (cloth_print_save (BOARD (pattern), &options,
          "/nowhere/board.pdf", &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);
  g_assert_null (cloth_print_svg (BOARD (pattern), &options, 1, 0, &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
}

int
main (int argc, char **argv)
{
  gint failed;

  g_test_init (&argc, &argv, NULL);
  folder = g_dir_make_tmp ("print-XXXXXX", NULL);
  g_test_add_func ("/print/true-size", test_true_size);
  g_test_add_func ("/print/tiles-reassemble", test_tiles_reassemble);
  g_test_add_func ("/print/dots", test_dots);
  g_test_add_func ("/print/m-array", test_m_array);
  g_test_add_func ("/print/same-bytes", test_same_bytes);
  g_test_add_func ("/print/paper", test_paper);
  g_test_add_func ("/print/layout", test_layout);
  g_test_add_func ("/print/refused", test_refused);
  g_test_add_func ("/print/save-refused", test_save_refused);
  failed = g_test_run ();
  g_rmdir (folder);
  g_free (folder);
  return failed;
}
