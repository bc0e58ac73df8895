/* gst-cloth-view-1.0: a page on which recordings move beside each other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/tool.h"

#include "gst/gap/report/view.h"

#define PROGRAM "gst-cloth-view-1.0"

typedef struct
{
  gchar *output;
  gchar **takes;
} Arguments;

static gint
run (gconstpointer data)
{
  const Arguments *arguments = data;
  const guint n = arguments->takes ? g_strv_length (arguments->takes) : 0;
  g_autoptr (GError) error = NULL;

  if (n == 0)
    return complain (BAD_USAGE, "name the takes to be shown");
  if (n > CLOTH_VIEW_MAX_TAKES)
    return complain (BAD_USAGE, "%u takes are too many to look at: name at "
        "most %d", n, CLOTH_VIEW_MAX_TAKES);
  if (!arguments->output || !*arguments->output)
    return complain (BAD_USAGE, "--output: name the page to write, for "
        "instance view.html");
  if (!cloth_view_write ((const gchar * const *) arguments->takes, n,
          arguments->output, &error))
    return complain (FAILED, "%s", error->message);
  g_print ("%s: open it in a browser\n", arguments->output);
  return DONE;
}

int
main (int argc, char **argv)
{
  Arguments arguments = { 0 };
  const GOptionEntry entries[] = {
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, &arguments.output,
        "The page to write", "FILE.html"},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.takes,
        NULL, "TAKE…"},
    {NULL}
  };
  gint code = tool_main (PROGRAM, "- show takes of cloth on a page", entries,
      g_strdupv (argv), run, &arguments);

  g_strfreev (arguments.takes);
  g_free (arguments.output);
  return code;
}
