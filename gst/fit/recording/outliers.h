/* Seen vertices that would have to be torn off the cloth to be where they are.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

typedef struct _ClothOutliers ClothOutliers;

ClothOutliers *cloth_outliers_new (const ClothTopology * topology);
guint cloth_outliers_remove (ClothOutliers * outliers, gdouble slack_m,
    gdouble * positions);
void cloth_outliers_free (ClothOutliers * outliers);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothOutliers, cloth_outliers_free)
G_END_DECLS
