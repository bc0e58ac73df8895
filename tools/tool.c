/* What the programs have in common: the command line and what they print of themselves.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "config.h"

#include "tools/tool.h"

#include <locale.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

static const gchar *program;
/* Whether a line of progress waits for its end. */
static gboolean in_line;
static volatile sig_atomic_t interrupted;

/* Descriptions of options begin with the commands that take them: "diagnose, compare: …". Those
 * of no command's are everyone's.
 *
 * Returns: the rest; NULL when @command doesn't take the option */
static const gchar *
description_for (const gchar * text, const gchar * command,
    const ToolCommand * commands)
{
  const gchar *rest = text;
  gboolean its = FALSE;

  for (;;) {
    const gsize n = strcspn (rest, ":, ");
    const ToolCommand *item = commands;

    while (item->name && (strlen (item->name) != n ||
            strncmp (item->name, rest, n) != 0))
      item++;
    if (!item->name || !rest[n] || rest[n] == ' ')
      return text;
    its |= g_str_equal (item->name, command);
    rest += n + strspn (rest + n, ":, ");
    if (rest[-2] == ':')
      return its ? rest : NULL;
  }
}

static void
print_command_help (const gchar * name, const ToolCommand * command,
    const ToolCommand * commands, const GOptionEntry * entries)
{
  g_autofree gchar *usage =
      g_strconcat (command->name, " ", command->arguments, NULL);
  g_autoptr (GOptionContext) context = g_option_context_new (usage);
  g_autoptr (GArray) its = g_array_new (TRUE, TRUE, sizeof (GOptionEntry));
  g_autofree gchar *examples = NULL, *help = NULL;
  g_auto (GStrv) lines = g_strsplit (command->example, "\n", -1);

  for (; entries->long_name; entries++) {
    GOptionEntry entry = *entries;

    entry.description = entry.description ?
        description_for (entry.description, command->name, commands) : NULL;
    if (*entry.long_name && entry.description)
      g_array_append_val (its, entry);
  }
  examples = g_strjoinv ("\n  ", lines);
  g_option_context_set_summary (context, command->what);
  help = g_strconcat ("Example:\n  ", examples, NULL);
  g_option_context_set_description (context, help);
  g_option_context_add_main_entries (context,
      (const GOptionEntry *) (gpointer) its->data, NULL);
  g_set_prgname (name);
  g_free (help);
  help = g_option_context_get_help (context, TRUE, NULL);
  g_print ("%s", help);
}

/* Whether the words ask for the help of a command, which is printed then. */
static gboolean
help_of_command (const gchar * name, const ToolCommand * commands,
    const GOptionEntry * entries, gchar ** words)
{
  const gchar *first = NULL;
  gboolean asked = FALSE;

  if (!commands)
    return FALSE;
  for (guint i = 1; words[i] && !g_str_equal (words[i], "--"); i++) {
    asked |= g_str_equal (words[i], "--help") || g_str_equal (words[i], "-h");
    if (!first && *words[i] != '-')
      first = words[i];
  }
  for (const ToolCommand * item = commands; asked && first && item->name;
      item++)
    if (g_str_equal (item->name, first)) {
      print_command_help (name, item, commands, entries);
      return TRUE;
    }
  return FALSE;
}

static void
describe_commands (GOptionContext * context, const gchar * name,
    const ToolCommand * commands)
{
  g_autoptr (GString) text = g_string_new ("Commands:\n");

  for (const ToolCommand * item = commands; item->name; item++)
    g_string_append_printf (text, "  %s %s\n", item->name, item->arguments);
  g_string_append_printf (text, "\n\"%s COMMAND --help\" tells what one does, "
      "with an example.", name);
  g_option_context_set_description (context, text->str);
}

/* @name: of the program
 * @summary: what it does, for --help
 * @commands: (nullable): what it can do
 * @entries: its options, but for --version
 * @words: (transfer full): the command line
 * @run: what it does with @arguments, which the options have filled
 *
 * Returns: the exit code
 */
gint
tool_main_commands (const gchar * name, const gchar * summary,
    const ToolCommand * commands, const GOptionEntry * entries,
    gchar ** words, gint (*run) (gconstpointer arguments),
    gconstpointer arguments)
{
  gboolean version = FALSE;
  const GOptionEntry common[] = {
    {"version", 0, 0, G_OPTION_ARG_NONE, &version, "Show the version and exit",
        NULL},
    {NULL}
  };
  g_autoptr (GOptionContext) context = g_option_context_new (summary);
  g_auto (GStrv) owned = words;
  g_autoptr (GError) error = NULL;

  program = name;
  /* Only the characters: numbers stay with the decimal point. */
  setlocale (LC_CTYPE, "");
  if (help_of_command (name, commands, entries, words))
    return DONE;
  g_option_context_add_main_entries (context, entries, NULL);
  g_option_context_add_main_entries (context, common, NULL);
  if (commands)
    describe_commands (context, name, commands);
  if (!g_option_context_parse_strv (context, &owned, &error))
    return complain (BAD_USAGE, "%s", error->message);
  if (version) {
    g_print ("%s (%s) %s\n", program, PACKAGE, PACKAGE_VERSION);
    return DONE;
  }
  return run (arguments);
}

/* A program of one command: see tool_main_commands(). */
gint
tool_main (const gchar * name, const gchar * summary,
    const GOptionEntry * entries, gchar ** words,
    gint (*run) (gconstpointer arguments), gconstpointer arguments)
{
  return tool_main_commands (name, summary, NULL, entries, words, run,
      arguments);
}

/* Says on the error stream what is wrong. Returns @code. */
gint
complain (gint code, const gchar * format, ...)
{
  g_autofree gchar *message = NULL;
  va_list arguments;

  va_start (arguments, format);
  message = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_printerr ("%s%s: %s\n", in_line ? "\n" : "", program, message);
  if (code == BAD_USAGE)
    g_printerr ("Try \"%s --help\".\n", program);
  return code;
}

/* On a terminal a line that changes, else a line at the beginning and each tenth. */
void
tell_progress (gdouble share, const gchar * what)
{
  static gint last = -1, tenth = -1;
  gint percent = (gint) (100 * MIN (share, 1) + 1e-9);
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

static void
interrupt (int number)
{
  interrupted = 1;
}

/* Ctrl-C, SIGTERM and a closed terminal, unless a shell or nohup had them ignored, are only
 * noted, once: the next one ends the program at once. */
void
catch_interrupts (void)
{
  static const gint signals[] = { SIGINT, SIGTERM, SIGHUP };
  struct sigaction action, before;

  memset (&action, 0, sizeof action);
  action.sa_handler = interrupt;
  action.sa_flags = (int) (SA_RESETHAND | SA_RESTART);
  sigemptyset (&action.sa_mask);
  for (guint i = 0; i < G_N_ELEMENTS (signals); i++)
    if (sigaction (signals[i], NULL, &before) == 0
        && before.sa_handler != SIG_IGN)
      sigaction (signals[i], &action, NULL);
}

gboolean
was_interrupted (void)
{
  return interrupted;
}

/* "50mm", "5cm", "0.05m" or "2in", the value of --@option, in metres. */
gboolean
parse_length (const gchar * option, const gchar * text, gdouble * metres,
    GError ** error)
{
  static const struct
  {
    const gchar *name;
    gdouble per_metre;
  } units[] = { {"mm", 1000}, {"cm", 100}, {"m", 1}, {"in", 1000 / 25.4} };
  gchar *end;
  gdouble value = g_ascii_strtod (text, &end);

  for (gsize i = 0; i < G_N_ELEMENTS (units) && end != text; i++) {
    /* Divided, so that 50mm is the 0.05 that is written in files. */
    if (!strcmp (end, units[i].name) && isfinite (value) && value >= 0) {
      *metres = value / units[i].per_metre;
      return TRUE;
    }
  }
  g_set_error (error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
      "--%s %s: give a length with its unit, mm, cm, m or in, for instance "
      "50mm", option, text);
  return FALSE;
}

/* "640x480", the size of a picture. */
gboolean
parse_size (const gchar * text, gint * width, gint * height)
{
  gint64 size[2];

  for (guint i = 0; i < 2; i++) {
    gchar *end;

    /* No sign, no space. */
    if (!g_ascii_isdigit (*text))
      return FALSE;
    size[i] = g_ascii_strtoll (text, &end, 10);
    if (size[i] < 1 || size[i] > G_MAXINT || *end != (i == 0 ? 'x' : 0))
      return FALSE;
    text = end + 1;
  }
  *width = (gint) size[0];
  *height = (gint) size[1];
  return TRUE;
}
