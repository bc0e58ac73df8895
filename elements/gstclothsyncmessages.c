/* What the joining of streams says: on the bus, and in the counts of each stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsyncmessages.h"

/* What a message calls the stream of a pad. The streaming thread alone changes the
 * camera's name. */
static gchar *
name_stream (GstClothSyncPad * pad)
{
  return pad->camera_name ? g_strdup_printf ("camera \"%s\" (pad %s)",
      pad->camera_name, GST_PAD_NAME (pad)) :
      g_strdup_printf ("pad %s", GST_PAD_NAME (pad));
}

static gdouble
seconds (GstClockTimeDiff time)
{
  return (gdouble) time / GST_SECOND;
}

static gdouble
milliseconds (GstClockTime time)
{
  return (gdouble) time / GST_MSECOND;
}

void
gst_cloth_sync_say_refused (GstElement * element, GstClothSyncPad * pad,
    gboolean is_last)
{
  g_autofree gchar *stream = name_stream (pad);

  if (pad->warned_ahead) {
    return;
  }
  pad->warned_ahead = TRUE;
  GST_ELEMENT_WARNING (element, STREAM, FORMAT,
      ("A frame of %s was dropped: its time stamp, %.3f s, is far ahead and "
          "%s.", stream, seconds (pad->held_time), is_last ?
          "none comes after it" : "the next frame's is not"),
      ("Later ones are only counted, as \"implausible\" in stats. If such "
          "jumps are real, raise max-jump."));
}

void
gst_cloth_sync_say_untimed (GstElement * element, GstClothSyncPad * pad)
{
  g_autofree gchar *stream = name_stream (pad);

  if (pad->warned_untimed) {
    return;
  }
  pad->warned_untimed = TRUE;
  GST_ELEMENT_WARNING (element, STREAM, FORMAT,
      ("A frame of %s was dropped: it has no time stamp.", stream),
      ("Streams are joined by running time. Later ones are only counted, as "
          "\"implausible\" in stats."));
}

void
gst_cloth_sync_say_jump (GstElement * element, GstClothSyncPad * pad)
{
  g_autofree gchar *stream = name_stream (pad);

  if (pad->warned_ahead) {
    return;
  }
  pad->warned_ahead = TRUE;
  GST_ELEMENT_WARNING (element, STREAM, FORMAT,
      ("The time stamps of %s jump to %.3f s; the others go on without it "
          "until they come there.", stream, seconds (pad->held_time)),
      ("See what stamps these frames."));
}

void
gst_cloth_sync_say_dropped (GstElement * element, GstClothSyncPad * pad,
    GstBuffer * buffer)
{
  const GstSegment *segment = &GST_AGGREGATOR_PAD (pad)->segment;
  const GstClockTime pts = GST_BUFFER_PTS (buffer);
  GstMessage *message = gst_message_new_qos (GST_OBJECT (element), TRUE,
      gst_segment_to_running_time (segment, GST_FORMAT_TIME, pts),
      gst_segment_to_stream_time (segment, GST_FORMAT_TIME, pts), pts,
      GST_BUFFER_DURATION (buffer));

  GST_DEBUG_OBJECT (pad, "late frame dropped: %" GST_PTR_FORMAT, buffer);
  gst_message_set_qos_stats (message, GST_FORMAT_BUFFERS, pad->used,
      pad->dropped);
  gst_element_post_message (element, message);
}

void
gst_cloth_sync_say_far_back (GstElement * element, GstClothSyncPad * pad,
    GstClockTimeDiff time, GstClockTimeDiff last_time)
{
  g_autofree gchar *stream = name_stream (pad);

  if (pad->warned_back) {
    return;
  }
  pad->warned_back = TRUE;
  if (time < pad->last) {
    GST_ELEMENT_WARNING (element, STREAM, FORMAT,
        ("Frames of %s are dropped: their time stamps went back to %.3f s, "
            "but %.3f s has gone by.", stream, seconds (time),
            seconds (last_time)),
        ("Streams are joined by running time, which never goes back. See "
            "what stamps these frames."));
  } else {
    GST_ELEMENT_WARNING (element, STREAM, FORMAT,
        ("Frames of %s are dropped: they come when the set of %.3f s has "
            "gone, and are of %.3f s.", stream, seconds (last_time),
            seconds (time)),
        ("Raise latency, or see whether another stream's time stamps run "
            "ahead."));
  }
}

void
gst_cloth_sync_say_late (GstElement * element, GstClothSyncPad * pad,
    GstClockTime late, GstClockTime latency)
{
  g_autofree gchar *stream = name_stream (pad);

  if (pad->warned_late) {
    return;
  }
  pad->warned_late = TRUE;
  GST_ELEMENT_WARNING_WITH_DETAILS (element, STREAM, FAILED,
      ("A frame of %s came %.0f ms too late, and was left out of its set.",
          stream, milliseconds (late)),
      ("Raise latency, now %.0f ms, by as much or more, or make what is before "
          "this element quicker. How many came too late is told at the end, and "
          "counted as \"dropped\" in stats.", milliseconds (latency)),
      ("camera", G_TYPE_STRING, pad->camera_name ? pad->camera_name : "",
          "pad", G_TYPE_STRING, GST_PAD_NAME (pad),
          "seconds", G_TYPE_DOUBLE, (gdouble) late / GST_SECOND, NULL));
}

void
gst_cloth_sync_pad_set_silent (GstClothSyncPad * pad, GstElement * element,
    const gchar * prefix, gboolean silent, GstClockTimeDiff now)
{
  const GstClockTimeDiff since = gst_cloth_sync_pad_silent_since (pad);
  g_autofree gchar *name =
      g_strconcat (prefix, silent ? "/silent" : "/back", NULL);

  GST_OBJECT_LOCK (element);
  pad->silent = silent;
  pad->was_silent |= silent;
  GST_OBJECT_UNLOCK (element);
  gst_element_post_message (element,
      gst_message_new_element (GST_OBJECT (element), gst_structure_new (name,
              "camera", G_TYPE_STRING, pad->camera_name ? pad->camera_name : "",
              "pad", G_TYPE_STRING, GST_PAD_NAME (pad),
              "seconds", G_TYPE_DOUBLE, seconds (MAX (now - since, 0)), NULL)));
}

void
gst_cloth_sync_say_unused (GstElement * element, GstClothSyncPad * pad)
{
  g_autofree gchar *stream = name_stream (pad);
  gboolean used;

  GST_OBJECT_LOCK (element);
  used = pad->used > 0;
  GST_OBJECT_UNLOCK (element);
  if (used) {
    return;
  }
  GST_ELEMENT_WARNING_WITH_DETAILS (element, STREAM, FAILED,
      ("No picture of %s was used, from the beginning to the end.", stream),
      ("Every set went without it: %" G_GUINT64_FORMAT " of its pictures came "
          "too late, %" G_GUINT64_FORMAT " had times that can't be. See that "
          "the camera gives pictures, and that its times are those of the "
          "others.", pad->dropped, pad->implausible),
      ("camera", G_TYPE_STRING, pad->camera_name ? pad->camera_name : "",
          "pad", G_TYPE_STRING, GST_PAD_NAME (pad), NULL));
}

void
gst_cloth_sync_say_lost (GstElement * element, GstClothSyncPad * const *pads,
    guint n_pads, guint64 n_sets, guint64 n_incomplete)
{
  g_autoptr (GString) lost = g_string_new (NULL);
  gboolean told = FALSE;

  GST_OBJECT_LOCK (element);
  for (guint i = 0; i < n_pads; i++) {
    GstClothSyncPad *pad = pads[i];
    g_autofree gchar *stream = NULL;

    if (!pad || pad->lacked == 0) {
      continue;
    }
    told |= pad->late > 0 || pad->was_silent;
    stream = name_stream (pad);
    g_string_append_printf (lost, "%s %s in %" G_GUINT64_FORMAT " (%"
        G_GUINT64_FORMAT " came too late)", lost->len ? ", that of" : "that of",
        stream, pad->lacked, pad->late);
  }
  GST_OBJECT_UNLOCK (element);
  if (!told) {
    return;
  }
  GST_ELEMENT_WARNING_WITH_DETAILS (element, STREAM, FAILED,
      ("%" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT " sets lacked a picture: "
          "%s.", n_incomplete, n_sets, lost->str),
      ("Where pictures came too late raise latency, or make what is before this "
          "element quicker; see that each camera gives pictures all the time."),
      ("incomplete", G_TYPE_UINT64, n_incomplete, "sets", G_TYPE_UINT64, n_sets,
          NULL));
}

GstStructure *
gst_cloth_sync_pad_get_stats (GstClothSyncPad * pad)
{
  return gst_structure_new (GST_PAD_NAME (pad),
      "camera", G_TYPE_STRING, pad->camera_name ? pad->camera_name : "",
      "used", G_TYPE_UINT64, pad->used,
      "missing", G_TYPE_UINT64, pad->missing,
      "dropped", G_TYPE_UINT64, pad->dropped,
      "implausible", G_TYPE_UINT64, pad->implausible,
      "silent", G_TYPE_BOOLEAN, pad->silent, NULL);
}
