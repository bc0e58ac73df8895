/* gst-cloth-take-1.0: looks after recordings on disk.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/take-tool.h"

#include <string.h>

static gint
run (gconstpointer data)
{
  const Arguments *arguments = data;
  const gchar *command = arguments->rest ? arguments->rest[0] : NULL;

  if (!command)
    return complain (BAD_USAGE, "name a command: recover");
  if (!strcmp (command, "recover"))
    return recover_takes (arguments);
  return complain (BAD_USAGE, "no command \"%s\": there is recover", command);
}

int
main (int argc, char **argv)
{
  Arguments arguments = { 0 };
  const GOptionEntry entries[] = {
    {"overwrite", 0, 0, G_OPTION_ARG_NONE, &arguments.overwrite,
          "recover: replace a recording that has the name by now",
        NULL},
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &arguments.rest,
        NULL, "recover FOLDER|FILE…"},
    {NULL}
  };
  gint code = tool_main (PROGRAM, "- look after recordings of cloth", entries,
      g_strdupv (argv), run, &arguments);

  g_strfreev (arguments.rest);
  return code;
}
