/* What the cloth may touch, in JSON.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/json.h"
#include "gst/take/obstacle.h"

G_BEGIN_DECLS

gboolean cloth_obstacles_parse (const ClothJsonFile * file,
    JsonObject * root, GArray * obstacles, GError ** error);
void cloth_obstacles_build (const GArray * obstacles, JsonBuilder * builder);

G_END_DECLS
