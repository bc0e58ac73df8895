/* OpenCV's ArUco markers, as on ChArUco boards, as plain C functions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/cv.h"

G_BEGIN_DECLS

typedef struct _ClothCvMarkers ClothCvMarkers;

ClothCvMarkers *cloth_cv_markers_new (const gchar * dictionary,
    GError ** error);
guint cloth_cv_markers_get_size (const ClothCvMarkers * markers);
gboolean cloth_cv_markers_find (ClothCvMarkers * markers,
    const ClothCvPicture * picture, guint * n, const gint ** ids,
    const gfloat ** corners, GError ** error);
void cloth_cv_markers_free (ClothCvMarkers * markers);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCvMarkers, cloth_cv_markers_free)
G_END_DECLS
