/* gst-cloth-take-1.0: makes takes of other programs' recordings, says what is in them, looks
 * after recordings on disk.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/take-tool.h"

#include <string.h>

static gint
run (gconstpointer data)
{
  const Arguments *arguments = data;
  const gchar *command = arguments->rest ? arguments->rest[0] : NULL;
  gboolean imports = !g_strcmp0 (command, "import");

  if (!command)
    return complain (BAD_USAGE, "name a command: import, info or recover");
  if (!imports && (arguments->output || arguments->units || arguments->axes
          || arguments->width || arguments->height || arguments->mesh
          || arguments->clamp_file || arguments->clamps || arguments->columns
          || arguments->rows || arguments->rate || arguments->zero_is_missing))
    return complain (BAD_USAGE, "%s takes no options of import", command);
  if (imports)
    return import_take (arguments);
  if (!strcmp (command, "info"))
    return inform_of_takes (arguments);
  if (!strcmp (command, "recover"))
    return recover_takes (arguments);
  return complain (BAD_USAGE,
      "no command \"%s\": there are import, info and recover", command);
}

static const ToolCommand commands[] = {
  {"import", "SOURCE --output TAKE",
        "Makes a take of a recording of another program: a table (CSV) with a line "
        "for each marker\nof each frame or a line for each frame, C3D, NumPy, a PC2 "
        "cache, OBJ or PLY files with\nnumbers (name the first). It prints what it "
        "understood, and refuses what is surely wrong.",
      "gst-cloth-take-1.0 import robot.csv --columns 9 --rows 9 --width 0.4m "
        "--height 0.4m \\\n    --units mm --axes y-up --clamp 0=gripper_left "
        "--clamp 8=gripper_right --output robot.take"},
  {"info", "TAKE…",
        "Says what takes hold: frames, rate, vertices, extent, how much was seen, "
        "clamps.",
      "gst-cloth-take-1.0 info robot.take"},
  {"recover", "FOLDER|RECORDING…",
        "Finishes recordings whose program was killed.",
      "gst-cloth-take-1.0 recover cloth.take"},
  {NULL}
};

int
main (int argc, char **argv)
{
  Arguments arguments = { 0 };
  const GOptionEntry entries[] = {
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &arguments.output,
        "import: take to write", "TAKE"},
    {"units", 'u', 0, G_OPTION_ARG_STRING, &arguments.units,
        "import: unit of the coordinates, m, cm, mm or in (what the file says, "
          "else m)", "UNIT"},
    {"axes", 'a', 0, G_OPTION_ARG_STRING, &arguments.axes,
        "import: z-up, y-up, x-up, or which of the source's axes become x, y and "
          "z, such as x,-z,y (z-up)", "AXES"},
    {"rate", 'r', 0, G_OPTION_ARG_STRING, &arguments.rate,
          "import: frames a second, such as 50 or 30000/1001, where the file has "
          "no times or wrong ones",
        "FPS"},
    {"columns", 0, 0, G_OPTION_ARG_INT, &arguments.columns,
        "import: vertices in a row of the grid", "N"},
    {"rows", 0, 0, G_OPTION_ARG_INT, &arguments.rows,
        "import: rows of the grid; vertex = row × columns + column", "N"},
    {"width", 0, 0, G_OPTION_ARG_STRING, &arguments.width,
          "import: of the grid on the flat cloth, with its unit, such as 0.4m",
        "LENGTH"},
    {"height", 0, 0, G_OPTION_ARG_STRING, &arguments.height,
        "import: the same, from the first row to the last", "LENGTH"},
    {"mesh", 0, 0, G_OPTION_ARG_FILENAME, &arguments.mesh,
        "import: instead of a grid, OBJ file with uv in metres; its vertices are "
          "the markers in their order", "OBJ"},
    {"clamp", 'c', 0, G_OPTION_ARG_STRING_ARRAY, &arguments.clamps,
        "import: vertex that is held, by number or marker; with =NAME it follows "
          "that marker's path, else its own. Again for each", "VERTEX[=NAME]"},
    {"clamp-file", 0, 0, G_OPTION_ARG_FILENAME, &arguments.clamp_file,
          "import: table in which these names are looked up, on the same clock",
        "CSV"},
    {"zero-is-missing", 0, 0, G_OPTION_ARG_NONE, &arguments.zero_is_missing,
        "import: places at 0, 0, 0 were not seen", NULL},
    {"overwrite", 0, 0, G_OPTION_ARG_NONE, &arguments.overwrite,
          "import, recover: replace a recording that has the name by now",
        NULL},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.rest,
        NULL, "import SOURCE | info TAKE… | recover FOLDER|FILE…"},
    {NULL}
  };
  gint code = tool_main_commands (PROGRAM,
      "- make takes of recordings of cloth, and look after them", commands,
      entries, g_strdupv (argv), run, &arguments);

  g_free (arguments.output);
  g_free (arguments.units);
  g_free (arguments.axes);
  g_free (arguments.width);
  g_free (arguments.height);
  g_free (arguments.mesh);
  g_free (arguments.clamp_file);
  g_free (arguments.rate);
  g_strfreev (arguments.clamps);
  g_strfreev (arguments.rest);
  return code;
}
