/* gst-cloth-take-1.0: what its commands share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "tools/tool.h"

#define PROGRAM "gst-cloth-take-1.0"

typedef struct
{
  gboolean overwrite;
  gchar **rest;                 /* the command and what belongs to it */
} Arguments;

gint recover_takes (const Arguments * arguments);
