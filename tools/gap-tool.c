/* gst-cloth-gap-1.0: what its commands tell on the terminal.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-tool.h"

#include <stdarg.h>
#include <unistd.h>

/* Whether a line of progress waits for its end. */
static gboolean in_line;

gint
complain (gint code, const gchar * format, ...)
{
  g_autofree gchar *message = NULL;
  va_list arguments;

  va_start (arguments, format);
  message = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_printerr ("%s" TOOL ": %s\n", in_line ? "\n" : "", message);
  if (code == BAD_USAGE)
    g_printerr ("Try \"" TOOL " --help\".\n");
  return code;
}

/* On a terminal a line that changes, else a line at the beginning and each tenth. */
void
tell_progress (gdouble share, const gchar * what)
{
  static gint last = -1, tenth = -1;
  gint percent = (gint) (100 * CLAMP (share, 0, 1) + 1e-9);
  const gchar *gap = what ? " " : "";

  if (!what)
    what = "";
  if (isatty (STDERR_FILENO) && last < 100) {
    in_line = percent < 100;
    g_printerr ("\r\033[K%3d%%%s%s%s", percent, gap, what, in_line ? "" : "\n");
  } else if (percent / 10 > tenth) {
    g_printerr ("%d%%%s%s\n", percent, gap, what);
  }
  last = MAX (last, percent);
  tenth = last / 10;
}
