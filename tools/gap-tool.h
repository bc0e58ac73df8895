/* gst-cloth-gap-1.0: what its commands share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "tools/tool.h"

#define PROGRAM "gst-cloth-gap-1.0"

typedef struct
{
  gchar *format, *scene, *output, *model, *effects, *simulator;
  gchar **baselines, **hold_outs, **simulated, **after;
  gint64 seed;
  gchar *spool;
  gint threads, run_seconds, simulator_runs, workers;
  gboolean worker, resume;
  gchar **rest;                 /* the command and what belongs to it */
} Arguments;

gint list_effects (const Arguments * arguments);
gint simulate (const Arguments * arguments);
gint diagnose (const Arguments * arguments);
gint compare_takes (const Arguments * arguments);
gint check_simulator (const Arguments * arguments);
gint survey (const Arguments * arguments);
