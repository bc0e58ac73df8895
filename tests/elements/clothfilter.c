/* GstClothFilter: what pictures take is told to the latency query, by a subclass that takes as
 * long as it is told to by the test's clock.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/check/gsttestclock.h>

#include "elements/gstclothfilter.h"

#define MS GST_MSECOND

#define TEST_TYPE_FILTER (test_filter_get_type ())
G_DECLARE_FINAL_TYPE (TestFilter, test_filter, TEST, FILTER, GstClothFilter)
     struct _TestFilter
     {
       GstClothFilter parent;

       GstTestClock *clock;
       GstClockTimeDiff span;
     };
G_DEFINE_TYPE (TestFilter, test_filter, GST_TYPE_CLOTH_FILTER);

     static GstFlowReturn
         test_filter_analyse (GstClothFilter * filter,
    const GstClothFilterFrame * frame)
{
  TestFilter *self = TEST_FILTER (filter);

  gst_test_clock_advance_time (self->clock, self->span);
  return GST_FLOW_OK;
}

static void
test_filter_class_init (TestFilterClass * klass)
{
  gst_element_class_set_static_metadata (GST_ELEMENT_CLASS (klass), "test",
      "Test", "test", "test");
  GST_CLOTH_FILTER_CLASS (klass)->analyse = test_filter_analyse;
}

static void
test_filter_init (TestFilter * self)
{
}

typedef struct
{
  TestFilter *filter;
  GstHarness *h;
  GstBus *bus;
} Bench;

static Bench
open_bench (gboolean live)
{
  Bench b;

  b.filter = gst_object_ref_sink (g_object_new (TEST_TYPE_FILTER, NULL));
  b.bus = gst_bus_new ();
  gst_element_set_bus (GST_ELEMENT (b.filter), b.bus);
  b.h = gst_harness_new_with_element (GST_ELEMENT (b.filter), "sink", "src");
  gst_harness_set_live (b.h, live);
  gst_harness_use_testclock (b.h);
  b.filter->clock = gst_harness_get_testclock (b.h);
  gst_harness_set_src_caps_str (b.h,
      "video/x-raw,format=GRAY8,width=8,height=8,framerate=25/1");
  return b;
}

static void
close_bench (Bench * b)
{
  gst_element_set_bus (GST_ELEMENT (b->filter), NULL);
  gst_harness_teardown (b->h);
  gst_object_unref (b->filter->clock);
  gst_object_unref (b->filter);
  gst_object_unref (b->bus);
}

/* One picture that takes @span; returns whether the pipeline was told to ask anew. */
static gboolean
push (Bench * b, GstClockTimeDiff span)
{
  g_autoptr (GstMessage) message = NULL;

  b->filter->span = span;
  fail_unless_equals_int (gst_harness_push (b->h,
          gst_buffer_new_allocate (NULL, 64, NULL)), GST_FLOW_OK);
  gst_buffer_unref (gst_harness_pull (b->h));
  message = gst_bus_pop_filtered (b->bus, GST_MESSAGE_LATENCY);
  return message != NULL;
}

GST_START_TEST (test_latency)
{
  Bench b = open_bench (TRUE);

  gst_harness_set_upstream_latency (b.h, 20 * MS);
  fail_unless_equals_uint64 (gst_harness_query_latency (b.h), 20 * MS);
  /* one slow picture is an accident, the second is not */
  fail_if (push (&b, 32 * MS));
  fail_unless_equals_uint64 (gst_harness_query_latency (b.h), 20 * MS);
  fail_unless (push (&b, 32 * MS));
  fail_unless_equals_uint64 (gst_harness_query_latency (b.h), 55 * MS);
  /* what is within is not told again, nor is what was quicker */
  fail_if (push (&b, 34 * MS));
  fail_if (push (&b, 300 * MS));
  fail_if (push (&b, 1 * MS));
  fail_unless_equals_uint64 (gst_harness_query_latency (b.h), 55 * MS);
  fail_if (push (&b, 61 * MS));
  fail_unless (push (&b, 48 * MS));
  fail_unless_equals_uint64 (gst_harness_query_latency (b.h), 70 * MS);
  close_bench (&b);
}

GST_END_TEST;

/* Films are not waited for by any clock. */
GST_START_TEST (test_film)
{
  Bench b = open_bench (FALSE);

  fail_unless_equals_uint64 (gst_harness_query_latency (b.h), 0);
  for (guint i = 0; i < 4; i++)
    fail_if (push (&b, 40 * MS));
  fail_unless_equals_uint64 (gst_harness_query_latency (b.h), 0);
  close_bench (&b);
}

GST_END_TEST;

static Suite *
clothfilter_suite (void)
{
  Suite *suite = suite_create ("clothfilter");
  TCase *tests = tcase_create ("general");

  suite_add_tcase (suite, tests);
  tcase_add_test (tests, test_latency);
  tcase_add_test (tests, test_film);
  return suite;
}

int
main (int argc, char **argv)
{
  /* the plugin has a GstClothFilter of its own: it must not come in by a scan */
  g_setenv ("GST_REGISTRY_DISABLE", "yes", TRUE);
  gst_check_init (&argc, &argv);
  return gst_check_run_suite (clothfilter_suite (), "clothfilter", __FILE__);
}
