/* How much may be drawn for one picture, and whether anybody still wants it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* What the setting up of any shape costs, however small it is, in samples. */
#define CLOTH_WORK_SHAPE 16

/* @left: samples that may still be drawn; what is known of a shape before it is drawn counts,
 *   at most the box around it as far as that lies in the picture
 * @stop: (nullable): not 0 as soon as the picture isn't wanted any more; any thread may set it
 * @left_out: something was left out, and all that came after it, because @left was too little
 *
 * Meshes and marks of strangers may each cover all of the picture. What fits is drawn as if
 * there were no limit. Where %NULL is given for one, there is none.
 */
typedef struct {
  gdouble left;
  const gint *stop;
  gboolean left_out;
} ClothWork;

static inline gboolean
cloth_work_is_stopped (const ClothWork * work)
{
  return work && work->stop && g_atomic_int_get (work->stop);
}

static inline gboolean
cloth_work_is_over (const ClothWork * work)
{
  return work && (work->left_out || cloth_work_is_stopped (work));
}

/* Whether a shape of so many @samples may be drawn. */
static inline gboolean
cloth_work_take (ClothWork * work, gdouble samples)
{
  if (!work)
    return TRUE;
  if (cloth_work_is_over (work))
    return FALSE;
  work->left -= samples + CLOTH_WORK_SHAPE;
  work->left_out = work->left < 0;
  return !work->left_out;
}

G_END_DECLS
