/* Signs of life of processes that share a folder, on one host or on many.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

/* Most bytes of a name. */
#define CLOTH_LIFE_MAX_NAME 100

/* @CLOTH_LIFE_LOST: it is gone, or has been silent for long
 * @CLOTH_LIFE_SILENT: it has not been silent for long, or this is the first look
 * @CLOTH_LIFE_CHANGED: it surely lives: its number has changed since the last look
 */
typedef enum {
  CLOTH_LIFE_LOST,
  CLOTH_LIFE_SILENT,
  CLOTH_LIFE_CHANGED
} ClothLifeSign;

/* One that gives signs of life as long as it is there, and looks for those of others. */
typedef struct _ClothLife ClothLife;

ClothLife *cloth_life_new (const gchar * folder, GError ** error);
const gchar *cloth_life_get_name (const ClothLife * life);
ClothLifeSign cloth_life_look (ClothLife * life, const gchar * name,
    gdouble after_s);
void cloth_life_free (ClothLife * life);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothLife, cloth_life_free)
G_END_DECLS
