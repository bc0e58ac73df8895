/* gst-cloth-gap-1.0: what its commands share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

#define TOOL "gst-cloth-gap-1.0"

enum
{ DONE = 0, FAILED = 1, BAD_USAGE = 2 };

typedef struct
{
  gboolean version;
  gchar *format, *scene, *output, *model, *effects;
  gchar **baselines, **hold_outs;
  gint64 seed;
  gint threads;
  gchar **rest;                 /* the command and what belongs to it */
} Arguments;

gint complain (gint code, const gchar * format, ...) G_GNUC_PRINTF (2, 3);
void tell_progress (gdouble share, const gchar * what);

gint list_effects (const Arguments * arguments);
gint simulate (const Arguments * arguments);
gint diagnose (const Arguments * arguments);
