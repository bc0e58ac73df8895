/* Recordings that simulations made in place of the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

/* @of: what they imitate
 * @list: (array length=n): they
 * @n: how many
 */
typedef struct {
  const ClothRecording *of;
  ClothRecording **list;
  guint n;
} ClothImitations;

ClothImitations *cloth_imitations_new (const ClothRecording * recording,
    guint n);
void cloth_imitations_keep (gpointer imitations, guint model, guint frame,
    const gdouble * positions);
void cloth_imitations_spoil (ClothImitations * imitations,
    const gboolean * sound, gdouble noise, guint64 seed);
void cloth_imitations_free (ClothImitations * imitations);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothImitations, cloth_imitations_free)

G_END_DECLS
