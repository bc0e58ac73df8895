/* What elements do with damaged packets: looking for their counts and messages.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/check/gstcheck.h>
#include <string.h>

/* So many packets were dropped, of which one warning tells and no error. */
static inline void
assert_dropped (GstElement * element, GstBus * bus, guint64 n,
    const gchar * says)
{
  g_autoptr (GstMessage) warning = gst_bus_pop_filtered (bus,
      GST_MESSAGE_WARNING | GST_MESSAGE_ERROR);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;
  guint64 dropped;

  g_object_get (element, "dropped", &dropped, NULL);
  fail_unless_equals_uint64 (dropped, n);
  fail_unless (warning != NULL);
  fail_unless_equals_int (GST_MESSAGE_TYPE (warning), GST_MESSAGE_WARNING);
  gst_message_parse_warning (warning, &error, &debug);
  fail_unless (strstr (error->message, says) != NULL, "“%s” lacks “%s”",
      error->message, says);
  fail_unless (strstr (debug, "strict=true") != NULL);
  fail_unless (gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING
          | GST_MESSAGE_ERROR) == NULL);
}

/* The end of the stream has told of so many; of none when @n is 0. */
static inline void
assert_summed_up (GstBus * bus, guint64 n)
{
  g_autoptr (GstMessage) info = gst_bus_pop_filtered (bus, GST_MESSAGE_INFO);
  const GstStructure *details = NULL;
  guint64 dropped;

  if (n == 0) {
    fail_unless (info == NULL);
    return;
  }
  fail_unless (info != NULL);
  gst_message_parse_info_details (info, &details);
  fail_unless (gst_structure_get_uint64 (details, "dropped", &dropped));
  fail_unless_equals_uint64 (dropped, n);
  fail_unless (gst_bus_pop_filtered (bus, GST_MESSAGE_INFO) == NULL);
}

/* With strict=true: an error, and nothing counts as dropped. */
static inline void
assert_refused_damage (GstElement * element, GstBus * bus, const gchar * says)
{
  g_autoptr (GstMessage) message = gst_bus_pop_filtered (bus,
      GST_MESSAGE_WARNING | GST_MESSAGE_ERROR);
  g_autoptr (GError) error = NULL;
  guint64 dropped;

  fail_unless (message != NULL);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_ERROR);
  gst_message_parse_error (message, &error, NULL);
  fail_unless (g_error_matches (error, GST_STREAM_ERROR,
          GST_STREAM_ERROR_DECODE));
  fail_unless (strstr (error->message, says) != NULL, "“%s” lacks “%s”",
      error->message, says);
  g_object_get (element, "dropped", &dropped, NULL);
  fail_unless_equals_uint64 (dropped, 0);
}
