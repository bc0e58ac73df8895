/* Recordings whose program was killed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/formats/formats.h"
#include "gst/take/sequence.h"

G_BEGIN_DECLS

/* @CLOTH_LEFT_NOTHING: no program was killed here
 * @CLOTH_LEFT_LOST: one was, and its frames can't be read
 * @CLOTH_LEFT_FRAMES: one was, and its recording can be finished
 *
 * What is left at the location of a recording.
 */
typedef enum {
  CLOTH_LEFT_NOTHING,
  CLOTH_LEFT_LOST,
  CLOTH_LEFT_FRAMES
} ClothLeft;

ClothLeft cloth_recover_look (const gchar * location, ClothMeshFormat format);
GPtrArray *cloth_recover_find (const gchar * location, GError ** error);
gchar *cloth_recover_get_name (const gchar * location, ClothMeshFormat format);
gchar *cloth_recover_get_target (const gchar * path);
gboolean cloth_recover (const gchar * path, gboolean overwrite,
    ClothRecovered * recovered, GError ** error);

G_END_DECLS
