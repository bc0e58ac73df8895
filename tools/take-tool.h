/* gst-cloth-take-1.0: what its commands share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "tools/tool.h"

#define PROGRAM "gst-cloth-take-1.0"

typedef struct
{
  gboolean overwrite, zero_is_missing;
  gchar *output, *units, *axes, *width, *height, *mesh, *clamp_file, *rate;
  gchar **clamps;
  gint columns, rows;
  gchar **rest;                 /* the command and what belongs to it */
} Arguments;

gint recover_takes (const Arguments * arguments);
gint import_take (const Arguments * arguments);
gint inform_of_takes (const Arguments * arguments);
