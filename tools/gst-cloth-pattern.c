/* gst-cloth-pattern-1.0: writes print files of patterns and their pattern.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/file.h"
#include "gst/mesh/garment/garment.h"
#include "gst/pattern/code.h"
#include "gst/pattern/marray.h"
#include "gst/pattern/pattern.h"
#include "gst/pattern/print.h"
#include "tools/pattern-picture.h"
#include "tools/tool.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <gst/gst.h>
#include <math.h>
#include <string.h>

/* The paper's cloth and its dots (Scholz et al. 2005, 3.1). */
#define DOTS_COLUMNS 76
#define DOTS_ROWS 251
#define DOTS_COLOURS 5
#define DOTS_DIAMETER_RATIO (13.0 / 20.0)
#define DOTS_DISTANCE 1
#define SEED 1

/* Kinds of pattern. */
enum
{ CHECKER = 1, CODED = 2, DOTS = 4, GARMENT = 8, SHEET = 16, SCAN = 32 };
#define PICTURE (SHEET | SCAN)

/* A number that was not given: its default depends on the kind of pattern. */
#define NOT_GIVEN G_MININT

typedef struct
{
  gboolean two_sided;
  gint columns, rows, colours, distance, sides;
  gchar *square, *margin, *first, *paper, *page_margin, *overlap, *output;
  gchar *pitch, *diameter, *pattern, *width, *height;
  gdouble dot_ratio;
  gint64 seed;
  gchar **kinds;
} Arguments;

static gint
fail (gint value_code, GError * error)
{
  gboolean usage = g_error_matches (error, CLOTH_PATTERN_ERROR,
      CLOTH_PATTERN_ERROR_VALUE);

  return complain (usage ? value_code : FAILED, "%s", error->message);
}

/* Fills @options and checks the layout; %DONE or an exit code. */
static gint
lay_out (const Arguments * arguments, const ClothArtwork * artwork,
    ClothPrintOptions * options)
{
  const gchar *paper = arguments->paper ? arguments->paper : "cloth";
  const gchar *margin =
      arguments->page_margin ? arguments->page_margin : "10mm";
  const gchar *overlap = arguments->overlap ? arguments->overlap : "10mm";
  ClothPrintLayout layout;
  g_autoptr (GError) error = NULL;
  gdouble metres;

  if (!cloth_print_paper (paper, options->paper_mm)) {
    return complain (BAD_USAGE, "--paper %s: give A0 to A5, letter, legal, "
        "tabloid, cloth or a size as 600x900mm", paper);
  }
  if (!parse_length ("page-margin", margin, &metres, &error))
    return complain (BAD_USAGE, "%s", error->message);
  options->margin_mm = metres * 1000;
  if (!parse_length ("overlap", overlap, &metres, &error))
    return complain (BAD_USAGE, "%s", error->message);
  options->overlap_mm = metres * 1000;
  if (!cloth_print_layout (artwork, options, &layout, &error))
    return fail (BAD_USAGE, error);
  return DONE;
}

/* Whether the print, or the first of its sheets, is there: then it is made anew, and
 * pattern.json with it. */
static gboolean
is_printed (const gchar * output)
{
  g_autofree gchar *stem = g_strndup (output, strlen (output) - 4);
  g_autofree gchar *sheet = g_strconcat (stem, "-1-1.svg", NULL);

  return g_file_test (output, G_FILE_TEST_EXISTS)
      || (g_str_has_suffix (output, ".svg")
      && g_file_test (sheet, G_FILE_TEST_EXISTS));
}

/* The file that goes with a print already made is worth as much as the print.
 *
 * @text: (nullable): what is to be written; %NULL: more than the file tells it apart */
static gint
keep_other_prints (const gchar * output, const gchar * json, const gchar * text)
{
  g_autofree gchar *present = NULL;

  if (!g_file_test (json, G_FILE_TEST_IS_REGULAR) || is_printed (output)
      || (text && g_file_get_contents (json, &present, NULL, NULL)
          && !strcmp (present, text)))
    return DONE;
  return complain (FAILED, "%s is of another print and would be overwritten: "
      "name a file in another folder, as --output NEW/%s, or move it away",
      json, output + (strrchr (output, '/') ?
          strrchr (output, '/') + 1 - output : 0));
}

/* @picture: (nullable): what a sheet is to its users */
static gint
print (const Arguments * arguments, const ClothArtwork * artwork,
    const ClothPrintOptions * options, ClothPicturePattern * picture)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = g_path_get_dirname (arguments->output);
  g_autofree gchar *json = strcmp (folder, ".")
      ? g_build_filename (folder, "pattern.json", NULL)
      : g_strdup ("pattern.json");
  g_autofree gchar *text =
      artwork->checker ? cloth_pattern_to_json (artwork->checker) :
      artwork->dots ? cloth_m_array_to_json (artwork->dots) : NULL;
  g_auto (GStrv) names = NULL;

  if (keep_other_prints (arguments->output, json, text) != DONE)
    return FAILED;
  names = cloth_print_save (artwork, options, arguments->output, &error);
  if (!names)
    return fail (FAILED, error);
  if (artwork->checker && !cloth_pattern_save (artwork->checker, json, &error))
    return fail (FAILED, error);
  if (artwork->dots && !cloth_m_array_save (artwork->dots, json, &error))
    return fail (FAILED, error);
  for (gchar ** name = names; *name; name++)
    g_print ("%s\n", *name);
  if (artwork->sheet)
    return pattern_from_sheet (picture, artwork->sheet, json);
  g_print ("%s\n", json);
  return DONE;
}

/* An option of other kinds of pattern is a mistake, not something to pass over. */
static gint
check_options (const Arguments * a, guint kind)
{
  const struct
  {
    const gchar *name;
    gboolean given;
    guint kinds;
  } options[] = {
    {"columns", a->columns != NOT_GIVEN, CHECKER | CODED | DOTS | PICTURE},
    {"rows", a->rows != NOT_GIVEN, CHECKER | CODED | DOTS | PICTURE},
    {"width", a->width != NULL, PICTURE},
    {"height", a->height != NULL, PICTURE},
    {"sides", a->sides != 1, PICTURE},
    {"square", a->square != NULL, CHECKER | CODED},
    {"margin", a->margin != NULL, CHECKER | CODED | DOTS},
    {"first", a->first != NULL, CHECKER | CODED},
    {"dot-ratio", a->dot_ratio != CLOTH_CODE_DOT_RATIO, CODED},
    {"pitch", a->pitch != NULL, DOTS},
    {"diameter", a->diameter != NULL, DOTS},
    {"colours", a->colours != NOT_GIVEN, DOTS},
    {"distance", a->distance != DOTS_DISTANCE, DOTS},
    {"two-sided", a->two_sided, DOTS},
    {"seed", a->seed != SEED, CODED | DOTS | SHEET},
    {"paper", a->paper != NULL, CHECKER | CODED | DOTS | SHEET},
    {"page-margin", a->page_margin != NULL, CHECKER | CODED | DOTS | SHEET},
    {"overlap", a->overlap != NULL, CHECKER | CODED | DOTS | SHEET},
    {"pattern", a->pattern != NULL, GARMENT},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (options); i++) {

    if (!options[i].given || options[i].kinds & kind)
      continue;
    return complain (BAD_USAGE, "--%s is not for a pattern of kind %s%s",
        options[i].name, a->kinds[0], kind == SCAN ? " from a scan" : "");
  }
  return DONE;
}

static gint
given (gint value, gint otherwise)
{
  return value == NOT_GIVEN ? otherwise : value;
}

static gint
run_m_array (const Arguments * arguments)
{
  const gint columns = given (arguments->columns, DOTS_COLUMNS);
  const gint rows = given (arguments->rows, DOTS_ROWS);
  const gint colours = given (arguments->colours, DOTS_COLOURS);
  const ClothMArrayCode code = {
    arguments->distance, arguments->two_sided, (guint64) arguments->seed
  };
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  g_autoptr (ClothMArray) array = NULL;
  ClothArtwork artwork = { NULL };
  g_autoptr (GError) error = NULL;
  g_autofree gchar *notes = NULL;
  gdouble pitch, diameter, margin;
  gint exit_code;

  if (!parse_length ("pitch", arguments->pitch ? arguments->pitch : "20mm",
          &pitch, &error))
    return complain (BAD_USAGE, "%s", error->message);
  /* Whole micrometres, so that 0.65 · 20 mm is the 0.013 that is written in files. */
  diameter = round (DOTS_DIAMETER_RATIO * pitch * 1e6) / 1e6;
  if (arguments->diameter
      && !parse_length ("diameter", arguments->diameter, &diameter, &error))
    return complain (BAD_USAGE, "%s", error->message);
  margin = pitch / 2;
  if (arguments->margin
      && !parse_length ("margin", arguments->margin, &margin, &error))
    return complain (BAD_USAGE, "%s", error->message);
  array = cloth_m_array_new (columns, rows, colours, pitch, diameter, margin,
      &code, &error);
  if (!array)
    return fail (BAD_USAGE, error);
  artwork.dots = array;
  exit_code = lay_out (arguments, &artwork, &options);
  if (exit_code != DONE)
    return exit_code;
  options.notes = notes = g_strdup_printf ("seed %" G_GINT64_FORMAT ", any "
      "3 × 3 tell their place%s", arguments->seed,
      code.two_sided ? " from both sides" : "");
  return print (arguments, &artwork, &options, NULL);
}

static gint
run_checker (const Arguments * arguments, gboolean coded)
{
  const gchar *first = arguments->first ? arguments->first : "black";
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  g_autoptr (ClothPattern) pattern = NULL;
  ClothArtwork artwork = { NULL };
  g_autoptr (GError) error = NULL;
  g_autofree gchar *notes = NULL;
  gdouble square, margin;
  gint window, exit_code;

  if (strcmp (first, "black") && strcmp (first, "white")) {
    return complain (BAD_USAGE, "--first %s: give black or white", first);
  }
  if (!parse_length ("square", arguments->square ? arguments->square : "50mm",
          &square, &error))
    return complain (BAD_USAGE, "%s", error->message);
  /* White around the board, so that its outer corners can be seen. */
  margin = square / 2;
  if (arguments->margin
      && !parse_length ("margin", arguments->margin, &margin, &error))
    return complain (BAD_USAGE, "%s", error->message);
  pattern = cloth_pattern_new_checker (given (arguments->columns, 8),
      given (arguments->rows, 8), square, margin,
      !strcmp (first, "black"), &error);
  if (!pattern)
    return fail (BAD_USAGE, error);
  artwork.checker = pattern;
  exit_code = lay_out (arguments, &artwork, &options);
  if (exit_code != DONE)
    return exit_code;
  if (coded) {
    if (!cloth_code_generate (pattern, arguments->dot_ratio,
            (guint64) arguments->seed, &window, &error))
      return fail (BAD_USAGE, error);
    options.notes = notes =
        g_strdup_printf ("seed %" G_GINT64_FORMAT ", any %d × %d tell their "
        "place", arguments->seed, window, window);
  }
  return print (arguments, &artwork, &options, NULL);
}

/* Any print: a scan of it, or a sheet that is drawn. */
static gint
run_picture (const Arguments * arguments, const gchar * scan)
{
  PrintedPicture printed = { {0, 0}, given (arguments->columns, 0),
  given (arguments->rows, 0), arguments->sides, arguments->output
  };
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  g_autoptr (ClothPicturePattern) pattern = NULL;
  g_autoptr (ClothSheet) sheet = NULL;
  ClothArtwork artwork = { NULL };
  g_autoptr (GError) error = NULL;
  gint exit_code;

  if (!arguments->width)
    return complain (BAD_USAGE, "give the width of the cloth that the picture "
        "shows, from edge to edge: --width 630mm");
  if (!parse_length ("width", arguments->width, &printed.cloth_m[0], &error)
      || (arguments->height && !parse_length ("height", arguments->height,
              &printed.cloth_m[1], &error)))
    return complain (BAD_USAGE, "%s", error->message);
  if (arguments->height && printed.cloth_m[1] == 0)
    return complain (BAD_USAGE, "--height %s: leave it out, or give the height "
        "of the cloth", arguments->height);
  if (scan)
    return pattern_from_scan (&printed, scan);
  if (!arguments->height)
    printed.cloth_m[1] = printed.cloth_m[0];
  sheet = cloth_sheet_new (printed.cloth_m, (guint64) arguments->seed, &error);
  if (sheet)
    pattern = cloth_picture_pattern_new ("reference.png", printed.cloth_m,
        printed.columns, printed.rows, printed.sides, &error);
  if (!pattern)
    return fail (BAD_USAGE, error);
  artwork.sheet = sheet;
  exit_code = lay_out (arguments, &artwork, &options);
  if (exit_code != DONE)
    return exit_code;
  return print (arguments, &artwork, &options, pattern);
}

/* The panels of a drawing, cut from a print of dots. */
static gint
run_garment (const Arguments * arguments)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMArray) array = NULL;
  g_autoptr (ClothGarment) garment = NULL;
  g_autofree gchar *svg = NULL;
  ClothDotGrid grid;
  gsize size;
  guint dots = 0;

  if (!arguments->pattern)
    return complain (BAD_USAGE, "name the print that the panels are cut from: "
        "--pattern pattern.json");
  if (!arguments->output)
    return complain (BAD_USAGE, "name the folder to write: --output garment");
  array = cloth_m_array_load (arguments->pattern, &error);
  if (!array)
    return complain (FAILED, "%s", error->message);
  grid = (ClothDotGrid) {
    (guint) array->columns, (guint) array->rows, array->pitch_m, {
    array->origin_uv_m[0], array->origin_uv_m[1]}
    , {
    array->cloth_m[0], array->cloth_m[1]}
  };
  svg = cloth_text_file_load (arguments->kinds[1], &size, &error);
  if (!svg)
    return complain (FAILED, "%s", error->message);
  garment = cloth_garment_new_from_svg (svg, size, &grid, &error);
  if (!garment) {
    return complain (FAILED, "%s: %s", arguments->kinds[1], error->message);
  }
  if (g_mkdir_with_parents (arguments->output, 0777) != 0) {
    return complain (FAILED, "%s: can't make the folder: %s", arguments->output,
        g_strerror (errno));
  }
  if (!cloth_garment_save (garment, arguments->output, &error))
    return complain (FAILED, "%s", error->message);
  for (guint v = 0; v < garment->topology->n_vertices; v++)
    dots += garment->dots[v] != CLOTH_NO_DOT;
  g_print ("%s/garment.json\n%s/garment.obj\n", arguments->output,
      arguments->output);
  g_printerr ("%u panels, %u seams, %u vertices, %u of them dots\n",
      garment->panels->len, garment->seams->len,
      garment->topology->n_vertices, dots);
  return DONE;
}

static gint
run (gconstpointer data)
{
  const Arguments *arguments = data;
  static const gchar *const names[] = {
    "checker", "coded-checker", "m-array", "garment", "picture"
  };
  const gchar *scan = NULL;
  guint kind = 0;
  gint exit_code;

  if (!arguments->kinds)
    return complain (BAD_USAGE,
        "name one kind of pattern: checker, coded-checker, m-array or "
        "picture; or garment and a drawing");
  for (guint i = 0; i < G_N_ELEMENTS (names) && !kind; i++)
    if (!strcmp (arguments->kinds[0], names[i]))
      kind = 1u << i;
  if (!kind) {
    return complain (BAD_USAGE, "no pattern \"%s\": there are checker, "
        "coded-checker, m-array, picture and garment", arguments->kinds[0]);
  }
  if (kind == SHEET && (scan = arguments->kinds[1]))
    kind = SCAN;
  if (g_strv_length (arguments->kinds) != (kind & (GARMENT | SCAN) ? 2 : 1))
    return complain (BAD_USAGE, kind == GARMENT ?
        "name the drawing: garment panels.svg" : kind == SCAN ?
        "name one scan of the whole cloth: picture scan.png" :
        "name one kind of pattern at a time");
  exit_code = check_options (arguments, kind);
  if (exit_code != DONE)
    return exit_code;
  if (kind == GARMENT)
    return run_garment (arguments);
  if (!arguments->output)
    return complain (BAD_USAGE, "name the file to write: --output %s",
        kind == SCAN ? "pattern.json" : "board.pdf");
  if (kind == SCAN) {
    if (!g_str_has_suffix (arguments->output, ".json"))
      return complain (BAD_USAGE, "--output %s: the name must end with .json",
          arguments->output);
    return run_picture (arguments, scan);
  }
  if (!g_str_has_suffix (arguments->output, ".pdf")
      && !g_str_has_suffix (arguments->output, ".svg")) {
    return complain (BAD_USAGE, "--output %s: the name must end with .pdf or "
        ".svg", arguments->output);
  }
  return kind == DOTS ? run_m_array (arguments)
      : kind == SHEET ? run_picture (arguments, NULL)
      : run_checker (arguments, kind == CODED);
}

static const ToolCommand commands[] = {
  {"checker", "",
        "A plain checkerboard: for cloth that is seen whole, and for calibration.",
      "gst-cloth-pattern-1.0 checker --columns 10 --rows 7 --square 25mm --paper A4 "
        "\\\n    --output board.pdf"},
  {"coded-checker", "",
        "A checkerboard with dots in some squares: any 4 × 4 of them tell their place.",
      "gst-cloth-pattern-1.0 coded-checker --columns 16 --rows 20 --square 40mm "
        "--output cloth.pdf"},
  {"m-array", "",
        "Dots of a few colours, of which any 3 × 3 tell their place: for garments.",
      "gst-cloth-pattern-1.0 m-array --columns 30 --rows 40 --pitch 20mm "
        "--two-sided \\\n    --output dots.pdf"},
  {"picture", "[SCAN]",
        "A print of shapes without repetition to write, or with a scan the "
        "pattern.json of cloth\nthat is printed already.",
      "gst-cloth-pattern-1.0 picture scan.png --width 0.8m --output pattern.json"},
  {"garment", "DRAWING",
        "Cuts a garment's panels, drawn as SVG, out of a print of dots.",
      "gst-cloth-pattern-1.0 garment skirt.svg --pattern dots/pattern.json "
        "--output skirt"},
  {NULL}
};

int
main (int argc, char **argv)
{
  Arguments arguments = {.columns = NOT_GIVEN,.rows = NOT_GIVEN,.colours =
        NOT_GIVEN,.distance = DOTS_DISTANCE,.sides = 1,.dot_ratio =
        CLOTH_CODE_DOT_RATIO,.seed = SEED
  };
  const GOptionEntry entries[] = {
    {"columns", 0, 0, G_OPTION_ARG_INT, &arguments.columns,
        "checker, coded-checker, m-array, picture: Squares in a row (8); dots (76); of a picture vertices of the mesh (as "
          "make cells of about 20mm)", "N"},
    {"rows", 0, 0, G_OPTION_ARG_INT, &arguments.rows,
          "checker, coded-checker, m-array, picture: Squares in a column (8); dots (251); of a picture vertices",
        "N"},
    {"width", 0, 0, G_OPTION_ARG_STRING, &arguments.width,
        "picture: Width of the cloth that a picture shows", "LENGTH"},
    {"height", 0, 0, G_OPTION_ARG_STRING, &arguments.height,
          "picture: Height of it (by the shape of the scan; of a sheet as its width)",
        "LENGTH"},
    {"sides", 0, 0, G_OPTION_ARG_INT, &arguments.sides,
          "picture: 2 for a picture that is seen from both sides of the cloth (1)",
        "N"},
    {"square", 0, 0, G_OPTION_ARG_STRING, &arguments.square,
        "checker, coded-checker: Edge of a square (50mm)", "LENGTH"},
    {"margin", 0, 0, G_OPTION_ARG_STRING, &arguments.margin,
        "checker, coded-checker, m-array: Plain cloth around the board (half a square), or from the centres of "
          "the outer dots to the edge (half the pitch)", "LENGTH"},
    {"first", 0, 0, G_OPTION_ARG_STRING, &arguments.first,
          "checker, coded-checker: Colour of the top-left square (black)",
        "black|white"},
    {"dot-ratio", 0, 0, G_OPTION_ARG_DOUBLE, &arguments.dot_ratio,
          "coded-checker: Diameter of a code's dot over its square's edge (0.3)",
        "RATIO"},
    {"pitch", 0, 0, G_OPTION_ARG_STRING, &arguments.pitch,
          "m-array: From the centre of a dot to that of the next (20mm)",
        "LENGTH"},
    {"diameter", 0, 0, G_OPTION_ARG_STRING, &arguments.diameter,
        "m-array: Diameter of a dot (0.65 of the pitch)", "LENGTH"},
    {"colours", 0, 0, G_OPTION_ARG_INT, &arguments.colours,
        "m-array: Colours of dots, 2 to 8 (5)", "N"},
    {"distance", 0, 0, G_OPTION_ARG_INT, &arguments.distance,
          "m-array: Dots by which any two windows of 3 by 3 differ at least (1)",
        "N"},
    {"two-sided", 0, 0, G_OPTION_ARG_NONE, &arguments.two_sided,
          "m-array: Tell windows from mirror images: the print is seen from both sides",
        NULL},
    {"seed", 0, 0, G_OPTION_ARG_INT64, &arguments.seed,
          "coded-checker, m-array, picture: Which code: equal seeds give equal patterns (1)",
        "N"},
    {"paper", 0, 0, G_OPTION_ARG_STRING, &arguments.paper,
        "checker, coded-checker, m-array, picture: A0 to A5, letter, legal, tabloid, a size as 600x900mm, or one page "
          "as large as it takes (cloth)", "PAPER"},
    {"page-margin", 0, 0, G_OPTION_ARG_STRING, &arguments.page_margin,
          "checker, coded-checker, m-array, picture: Edge of the paper that stays blank (10mm)",
        "LENGTH"},
    {"overlap", 0, 0, G_OPTION_ARG_STRING, &arguments.overlap,
          "checker, coded-checker, m-array, picture: What neighbouring sheets share (10mm)",
        "LENGTH"},
    {"pattern", 0, 0, G_OPTION_ARG_FILENAME, &arguments.pattern,
        "garment: pattern.json of the dots that a garment is cut from", "FILE"},
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &arguments.output,
        "File to write, .pdf or .svg; pattern.json is put beside it. Of a "
          "scan the pattern.json, of a garment the folder", "FILE"},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.kinds,
        NULL, "checker|coded-checker|m-array|picture [SCAN]|garment DRAWING"},
    {NULL}
  };
  gint code;

  gst_init (NULL, NULL);
  code = tool_main_commands ("gst-cloth-pattern-1.0",
      "- print patterns at true size", commands, entries, g_strdupv (argv),
      run, &arguments);

  g_free (arguments.square);
  g_free (arguments.pattern);
  g_free (arguments.width);
  g_free (arguments.height);
  g_free (arguments.pitch);
  g_free (arguments.diameter);
  g_free (arguments.margin);
  g_free (arguments.first);
  g_free (arguments.paper);
  g_free (arguments.page_margin);
  g_free (arguments.overlap);
  g_free (arguments.output);
  g_strfreev (arguments.kinds);
  return code;
}
