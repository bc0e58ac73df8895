/* Elements for the fuzz targets that feed them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>

#include "fuzz.h"

G_BEGIN_DECLS

#define FUZZ_COLUMNS 4
#define FUZZ_ROWS 3

/* The elements of this build, whatever plugins are installed. */
void fuzz_elements_init (void);

/* triangulate with @n_pads sink pads of cameras that look at a board of FUZZ_COLUMNS by
 * FUZZ_ROWS squares; @in has room for a harness a pad. Returns the source pad's. */
GstHarness *fuzz_triangulate_new (guint n_pads, GstHarness ** in);
void fuzz_triangulate_free (GstHarness * src, guint n_pads, GstHarness ** in);

G_END_DECLS
