/* gst-cloth-pattern-1.0: writes print files of patterns and their pattern.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "config.h"

#include "gst/pattern/code.h"
#include "gst/pattern/pattern.h"
#include "gst/pattern/print.h"

#include <locale.h>
#include <math.h>
#include <string.h>

#define TOOL "gst-cloth-pattern-1.0"

enum
{ DONE = 0, FAILED = 1, BAD_USAGE = 2 };

typedef struct
{
  gboolean version;
  gint columns, rows;
  gchar *square, *margin, *first, *paper, *page_margin, *overlap, *output;
  gdouble dot_ratio;
  gint64 seed;
  gchar **kinds;
} Arguments;

static gint
complain (gint code, const gchar * message)
{
  g_printerr (TOOL ": %s\n", message);
  if (code == BAD_USAGE)
    g_printerr ("Try \"" TOOL " --help\".\n");
  return code;
}

/* "50mm", "5cm", "0.05m", "2in" in metres. */
static gboolean
parse_length (const gchar * name, const gchar * text, gdouble * metres,
    gchar ** message)
{
  static const struct
  {
    const gchar *name;
    gdouble metres;
  } units[] = { {"mm", 1000}, {"cm", 100}, {"m", 1}, {"in", 1000 / 25.4} };
  gchar *end;
  gdouble value = g_ascii_strtod (text, &end);

  for (gsize i = 0; i < G_N_ELEMENTS (units) && end != text; i++) {
    /* Divided, so that 50mm is the 0.05 that is written in files. */
    if (!strcmp (end, units[i].name) && isfinite (value) && value >= 0) {
      *metres = value / units[i].metres;
      return TRUE;
    }
  }
  *message = g_strdup_printf ("--%s %s: give a length with its unit, mm, cm, m "
      "or in, for instance 50mm", name, text);
  return FALSE;
}

static gint
fail (gint value_code, GError * error)
{
  gboolean usage = g_error_matches (error, CLOTH_PATTERN_ERROR,
      CLOTH_PATTERN_ERROR_VALUE);

  return complain (usage ? value_code : FAILED, error->message);
}

static gint
print (const Arguments * arguments, ClothPattern * pattern, gboolean coded)
{
  ClothPrintOptions options = CLOTH_PRINT_OPTIONS_INIT;
  ClothPrintLayout layout;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *message = NULL, *notes = NULL, *folder = NULL;
  g_autofree gchar *json = NULL;
  g_auto (GStrv) names = NULL;
  gdouble metres;
  gint window;

  if (!cloth_print_paper (arguments->paper, options.paper_mm)) {
    message = g_strdup_printf ("--paper %s: give A0 to A5, letter, legal, "
        "tabloid, cloth or a size as 600x900mm", arguments->paper);
    return complain (BAD_USAGE, message);
  }
  if (!parse_length ("page-margin", arguments->page_margin, &metres, &message))
    return complain (BAD_USAGE, message);
  options.margin_mm = metres * 1000;
  if (!parse_length ("overlap", arguments->overlap, &metres, &message))
    return complain (BAD_USAGE, message);
  options.overlap_mm = metres * 1000;
  if (!cloth_print_layout (pattern, &options, &layout, &error))
    return fail (BAD_USAGE, error);
  if (coded) {
    if (!cloth_code_generate (pattern, arguments->dot_ratio,
            (guint64) arguments->seed, &window, &error))
      return fail (BAD_USAGE, error);
    options.notes = notes =
        g_strdup_printf ("seed %" G_GINT64_FORMAT ", any %d × %d tell their "
        "place", arguments->seed, window, window);
  }
  names = cloth_print_save (pattern, &options, arguments->output, &error);
  if (!names)
    return fail (FAILED, error);
  folder = g_path_get_dirname (arguments->output);
  json = strcmp (folder, ".") ? g_build_filename (folder, "pattern.json", NULL)
      : g_strdup ("pattern.json");
  if (!cloth_pattern_save (pattern, json, &error))
    return fail (FAILED, error);
  for (gchar ** name = names; *name; name++)
    g_print ("%s\n", *name);
  g_print ("%s\n", json);
  return DONE;
}

static gint
run (const Arguments * arguments)
{
  g_autoptr (ClothPattern) pattern = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *message = NULL;
  gdouble square, margin;
  gboolean coded;

  if (arguments->version) {
    g_print (TOOL " (%s) %s\n", PACKAGE, PACKAGE_VERSION);
    return DONE;
  }
  if (!arguments->kinds || g_strv_length (arguments->kinds) != 1)
    return complain (BAD_USAGE,
        "name one kind of pattern: checker or coded-checker");
  coded = !strcmp (arguments->kinds[0], "coded-checker");
  if (!coded && strcmp (arguments->kinds[0], "checker")) {
    message = g_strdup_printf ("no pattern \"%s\": there are checker and "
        "coded-checker", arguments->kinds[0]);
    return complain (BAD_USAGE, message);
  }
  if (!arguments->output)
    return complain (BAD_USAGE, "name the file to write: --output board.pdf");
  if (!g_str_has_suffix (arguments->output, ".pdf")
      && !g_str_has_suffix (arguments->output, ".svg")) {
    message = g_strdup_printf ("--output %s: the name must end with .pdf or "
        ".svg", arguments->output);
    return complain (BAD_USAGE, message);
  }
  if (strcmp (arguments->first, "black") && strcmp (arguments->first, "white")) {
    message = g_strdup_printf ("--first %s: give black or white",
        arguments->first);
    return complain (BAD_USAGE, message);
  }
  if (!parse_length ("square", arguments->square, &square, &message))
    return complain (BAD_USAGE, message);
  /* White around the board, so that its outer corners can be seen. */
  margin = square / 2;
  if (arguments->margin
      && !parse_length ("margin", arguments->margin, &margin, &message))
    return complain (BAD_USAGE, message);
  pattern = cloth_pattern_new_checker (arguments->columns, arguments->rows,
      square, margin, !strcmp (arguments->first, "black"), &error);
  if (!pattern)
    return fail (BAD_USAGE, error);
  return print (arguments, pattern, coded);
}

int
main (int argc, char **argv)
{
  Arguments arguments = {.columns = 8,.rows = 8,.dot_ratio =
        CLOTH_CODE_DOT_RATIO,.seed = 1
  };
  const GOptionEntry entries[] = {
    {"columns", 0, 0, G_OPTION_ARG_INT, &arguments.columns,
        "Squares in a row (8)", "N"},
    {"rows", 0, 0, G_OPTION_ARG_INT, &arguments.rows,
        "Squares in a column (8)", "N"},
    {"square", 0, 0, G_OPTION_ARG_STRING, &arguments.square,
        "Edge of a square (50mm)", "LENGTH"},
    {"margin", 0, 0, G_OPTION_ARG_STRING, &arguments.margin,
        "Plain cloth around the board (half a square)", "LENGTH"},
    {"first", 0, 0, G_OPTION_ARG_STRING, &arguments.first,
        "Colour of the top-left square (black)", "black|white"},
    {"dot-ratio", 0, 0, G_OPTION_ARG_DOUBLE, &arguments.dot_ratio,
        "Diameter of a code's dot over its square's edge (0.3)", "RATIO"},
    {"seed", 0, 0, G_OPTION_ARG_INT64, &arguments.seed,
        "Which code: equal seeds give equal boards (1)", "N"},
    {"paper", 0, 0, G_OPTION_ARG_STRING, &arguments.paper,
        "A0 to A5, letter, legal, tabloid, a size as 600x900mm, or one page "
          "as large as it takes (cloth)", "PAPER"},
    {"page-margin", 0, 0, G_OPTION_ARG_STRING, &arguments.page_margin,
        "Edge of the paper that stays blank (10mm)", "LENGTH"},
    {"overlap", 0, 0, G_OPTION_ARG_STRING, &arguments.overlap,
        "What neighbouring sheets share (10mm)", "LENGTH"},
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &arguments.output,
        "File to write, .pdf or .svg; pattern.json is put beside it", "FILE"},
    {"version", 0, 0, G_OPTION_ARG_NONE, &arguments.version,
        "Show the version and exit", NULL},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_STRING_ARRAY, &arguments.kinds,
        NULL, "checker|coded-checker"},
    {NULL}
  };
  g_autoptr (GOptionContext) context =
      g_option_context_new ("- print patterns at true size");
  g_autoptr (GError) error = NULL;
  gint code;

  /* Only the characters: numbers stay with the decimal point. */
  setlocale (LC_CTYPE, "");
  arguments.square = g_strdup ("50mm");
  arguments.first = g_strdup ("black");
  arguments.paper = g_strdup ("cloth");
  arguments.page_margin = g_strdup ("10mm");
  arguments.overlap = g_strdup ("10mm");
  g_option_context_add_main_entries (context, entries, NULL);
  if (g_option_context_parse (context, &argc, &argv, &error))
    code = run (&arguments);
  else
    code = complain (BAD_USAGE, error->message);
  g_free (arguments.square);
  g_free (arguments.margin);
  g_free (arguments.first);
  g_free (arguments.paper);
  g_free (arguments.page_margin);
  g_free (arguments.overlap);
  g_free (arguments.output);
  g_strfreev (arguments.kinds);
  return code;
}
