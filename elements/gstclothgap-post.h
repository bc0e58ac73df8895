/* clothgap: what it posts on the bus.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

#include "gst/gap/diagnose.h"
#include "gst/fit/nudge/nudge.h"

G_BEGIN_DECLS

void gst_cloth_gap_post_score (GstElement * element,
    const ClothObserverScore * score);
/* Writes the report first when there is an @output. */
gboolean gst_cloth_gap_post_verdict (GstElement * element,
    const ClothGapResult * result, const gchar * output, GError ** error);

G_END_DECLS
