/* What the programs have in common: the command line and what they print of themselves.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Exit codes. */
enum
{ DONE = 0, FAILED = 1, BAD_USAGE = 2 };

/* @name: of the command; a table ends with %NULL
 * @arguments: what follows it, for people
 * @what: what it does, some sentences
 * @example: command lines, each on a line of its own
 */
typedef struct
{
  const gchar *name, *arguments, *what, *example;
} ToolCommand;

gint tool_main_commands (const gchar * name, const gchar * summary,
    const ToolCommand * commands, const GOptionEntry * entries,
    gchar ** words, gint (*run) (gconstpointer arguments),
    gconstpointer arguments);
gint tool_main (const gchar * name, const gchar * summary,
    const GOptionEntry * entries, gchar ** words,
    gint (*run) (gconstpointer arguments), gconstpointer arguments);
gint complain (gint code, const gchar * format, ...) G_GNUC_PRINTF (2, 3);
void tell_progress (gdouble share, const gchar * what);
void catch_interrupts (void);
gboolean was_interrupted (void);
gboolean parse_length (const gchar * option, const gchar * text,
    gdouble * metres, GError ** error);
gboolean parse_size (const gchar * text, gint * width, gint * height);

G_END_DECLS
