/* What several elements do alike: caps, properties that hold from start to stop.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothutil.h"

/* What of @caps (taken) the asker of a caps query wants, in the asker's order. */
GstCaps *
gst_cloth_filter_caps (GstCaps * caps, GstCaps * filter)
{
  GstCaps *both;

  if (!filter)
    return caps;
  both = gst_caps_intersect_full (filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref (caps);
  return both;
}

/* Whether a property that is mutable in READY only may be set now; warns when not. With
 * the object lock. */
gboolean
gst_cloth_may_change (GstElement * element, const GParamSpec * spec)
{
  if (GST_STATE (element) <= GST_STATE_READY)
    return TRUE;
  GST_WARNING_OBJECT (element, "“%s” cannot change while running",
      spec->name);
  return FALSE;
}
