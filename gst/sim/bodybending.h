/* How a body bends.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/body.h"

G_BEGIN_DECLS

gboolean cloth_body_make_hinges (ClothBody * body, const guint32 * corners,
    GError ** error);

G_END_DECLS
