/* Waiting on a test clock.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/check/gstharness.h>
#include <gst/check/gsttestclock.h>

/* Until then the element waits for silence, at another time. */
static inline void
wait_for_deadline (GstTestClock * clock, GstClockTime time)
{
  GstClockTime pending = GST_CLOCK_TIME_NONE;

  while (pending != time) {
    GstClockID id;

    gst_test_clock_wait_for_next_pending_id (clock, &id);
    pending = gst_clock_id_get_time (id);
    gst_clock_id_unref (id);
  }
}
