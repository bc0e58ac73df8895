/* What an element that joins several streams answers downstream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsyncqueries.h"

#include "elements/gstclothsyncpad.h"

/* Narrows the range from @start to @stop, -1 where it is open, to what @pad can seek in. */
static gboolean
narrow (GstPad * pad, GstFormat format, gint64 * start, gint64 * stop)
{
  g_autoptr (GstQuery) query = gst_query_new_seeking (format);
  gboolean seekable = FALSE;
  gint64 from = -1, to = -1;

  if (gst_pad_peer_query (pad, query)) {
    gst_query_parse_seeking (query, NULL, &seekable, &from, &to);
  }
  *start = MAX (*start, from);
  if (to >= 0) {
    *stop = *stop < 0 ? to : MIN (*stop, to);
  }
  return seekable;
}

/* The base class seeks on all pads, and says that it can't. */
static void
answer_seeking (GstElement * element, GstQuery * query)
{
  g_autoptr (GList) pads = gst_cloth_sync_pad_list (element);
  gboolean seekable = pads != NULL;
  gint64 start = 0, stop = -1;
  GstFormat format;

  gst_query_parse_seeking (query, &format, NULL, NULL, NULL);
  for (GList * l = pads; l; l = l->next) {
    g_autoptr (GstPad) pad = l->data;

    seekable = seekable && narrow (pad, format, &start, &stop);
  }
  gst_query_set_seeking (query, format, seekable, seekable ? start : 0,
      seekable ? stop : -1);
}

/* The property is for frames that others wait for. */
static void
spare_latency (GstElement * element, GstQuery * query)
{
  GstClockTime own, least, most;
  gboolean is_live;

  g_object_get (element, "latency", &own, NULL);
  gst_query_parse_latency (query, &is_live, &least, &most);
  gst_query_set_latency (query, is_live, least - MIN (own, least),
      GST_CLOCK_TIME_IS_VALID (most) ? most - MIN (own, most) : most);
}

gboolean
gst_cloth_sync_src_query (GstAggregator * agg, GstQuery * query)
{
  GstAggregatorClass *base = g_type_class_peek (GST_TYPE_AGGREGATOR);
  GstElement *element = GST_ELEMENT (agg);
  gboolean is_alone;

  if (GST_QUERY_TYPE (query) == GST_QUERY_SEEKING) {
    answer_seeking (element, query);
    return TRUE;
  }
  if (!base->src_query (agg, query)) {
    return FALSE;
  }
  GST_OBJECT_LOCK (element);
  is_alone = element->numsinkpads == 1;
  GST_OBJECT_UNLOCK (element);
  if (GST_QUERY_TYPE (query) == GST_QUERY_LATENCY && is_alone) {
    spare_latency (element, query);
  }
  return TRUE;
}
