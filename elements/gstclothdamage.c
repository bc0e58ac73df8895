/* What becomes of damaged packets, the same in all elements that take streams without
 * pictures.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothdamage.h"

static void
sum_up (GstClothDamage * damage, GstElement * element)
{
  guint64 n;

  GST_OBJECT_LOCK (element);
  n = damage->n_dropped - damage->n_summed_up;
  damage->n_summed_up = damage->n_dropped;
  GST_OBJECT_UNLOCK (element);
  if (n > 0)
    GST_ELEMENT_INFO_WITH_DETAILS (element, STREAM, DECODE,
        ("%" G_GUINT64_FORMAT " damaged packet%s dropped.", n,
            n == 1 ? " was" : "s were"),
        ("Look after the network, or write the file anew."),
        ("dropped", G_TYPE_UINT64, n, NULL));
}

typedef struct
{
  GstClothDamage *damage;
  GstElement *element;
} Watch;

static GstPadProbeReturn
look_at_event (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  const Watch *watch = data;

  if (GST_EVENT_TYPE (GST_PAD_PROBE_INFO_EVENT (info)) == GST_EVENT_EOS)
    sum_up (watch->damage, watch->element);
  return GST_PAD_PROBE_OK;
}

void
gst_cloth_damage_watch (GstClothDamage * damage, GstElement * element,
    GstPad * srcpad)
{
  const Watch watch = { damage, element };

  gst_pad_add_probe (srcpad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, look_at_event,
      g_memdup2 (&watch, sizeof watch), g_free);
}

void
gst_cloth_damage_reset (GstClothDamage * damage, GstElement * element)
{
  GST_OBJECT_LOCK (element);
  damage->n_dropped = damage->n_summed_up = 0;
  GST_OBJECT_UNLOCK (element);
}

GstFlowReturn
gst_cloth_damage_add (GstClothDamage * damage, GstElement * element,
    const GError * problem)
{
  gboolean strict, first;

  GST_OBJECT_LOCK (element);
  strict = damage->strict;
  first = damage->n_dropped == 0;
  if (!strict)
    damage->n_dropped++;
  GST_OBJECT_UNLOCK (element);

  if (strict) {
    GST_ELEMENT_ERROR (element, STREAM, DECODE,
        ("The stream is damaged: %s", problem->message),
        ("Write it anew, or set strict=false to go on without the damaged "
            "packets."));
    return GST_FLOW_ERROR;
  }
  GST_DEBUG_OBJECT (element, "dropped: %s", problem->message);
  if (first)
    GST_ELEMENT_WARNING (element, STREAM, DECODE,
        ("A damaged packet was dropped: %s", problem->message),
        ("Others like it are only counted, in the property dropped. Set "
            "strict=true to end at the first."));
  return GST_FLOW_OK;
}
