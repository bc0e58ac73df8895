/* Shared inside libgstcloth-1.0: the reference clocks that observations may name.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

GstCaps *gst_cloth_clock_from_text (const gchar * text, gsize length);

G_END_DECLS
