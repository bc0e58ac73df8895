/* Errors of scenes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/scene.h"

G_BEGIN_DECLS

gboolean cloth_scene_invalid (GError ** error, const gchar * format, ...)
    G_GNUC_PRINTF (2, 3);

G_END_DECLS
