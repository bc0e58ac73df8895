/* Points carried from one picture of a film to the next by optical flow.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/cv.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* In place of how near a point has to come back: it need not come back at all. */
#define CLOTH_FLOW_ANYWHERE INFINITY

typedef struct _ClothFlow ClothFlow;

ClothFlow *cloth_flow_new (void);
void cloth_flow_free (ClothFlow * flow);
void cloth_flow_reset (ClothFlow * flow);
void cloth_flow_keep (ClothFlow * flow, const ClothImage * image);
gboolean cloth_flow_goes_on (const ClothFlow * flow, const ClothImage * image);
gboolean cloth_flow_run (ClothFlow * flow, const ClothCvFlowParams * params,
    gdouble back, const ClothImage * image, guint n, const gfloat * from,
    gfloat * to, guint8 * found, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothFlow, cloth_flow_free)
G_END_DECLS
