/* What becomes of damaged packets, the same in all elements that take streams without
 * pictures: dropped, counted, told once; with `strict` an error.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

#include "elements/gstclothproperties.h"

G_BEGIN_DECLS

/* A member of an element's settings, with the object lock. */
typedef struct {
  gboolean strict;
  guint64 n_dropped;            /* since the element started */
  guint64 n_summed_up;          /* of these, those a summary has told of */
} GstClothDamage;

/* Two lines of an element's table of properties; @member is the settings' GstClothDamage. */
#define GST_CLOTH_DAMAGE_PROPERTIES(struct_type, member) \
  {"strict", "Strict", \
    "End with an error at the first damaged packet, as is right for files; else damaged " \
    "packets are dropped, with one warning and at the end of the stream their number", \
    G_TYPE_BOOLEAN, GST_CLOTH_SETTING (struct_type, member.strict), \
    GST_PARAM_MUTABLE_PLAYING}, \
  {"dropped", "Dropped", "Damaged packets dropped since the element started; can only be read", \
    G_TYPE_UINT64, GST_CLOTH_SETTING (struct_type, member.n_dropped), \
    G_PARAM_READABLE}

/* In init: at the end of the stream, seen on @srcpad, says how many were dropped.
 * @damage: of @element, lives as long */
void gst_cloth_damage_watch (GstClothDamage * damage, GstElement * element,
    GstPad * srcpad);

/* At the start: nothing has been dropped. */
void gst_cloth_damage_reset (GstClothDamage * damage, GstElement * element);

/* One more, for the reason @problem. Returns: what the element goes on with,
 * %GST_FLOW_ERROR when that was an error, which is posted */
GstFlowReturn gst_cloth_damage_add (GstClothDamage * damage,
    GstElement * element, const GError * problem);

G_END_DECLS
