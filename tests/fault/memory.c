/* Memory that is not to be had, where its size comes from outside.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#include "gst/cv/cv.h"

#define OBSERVATIONS "application/x-cloth-observations, version=(int)1, " \
    "width=(int)%u, height=(int)%u, framerate=(fraction)25/1"

static void
limit_memory (gsize more)
{
  struct rlimit limit;
  unsigned long pages = 0;
  FILE *file = fopen ("/proc/self/statm", "r");

  fail_unless (file != NULL);
  fail_unless_equals_int (fscanf (file, "%lu", &pages), 1);
  fclose (file);
  fail_unless_equals_int (getrlimit (RLIMIT_AS, &limit), 0);
  limit.rlim_cur = more > 0 ? pages * (rlim_t) sysconf (_SC_PAGESIZE) + more :
      limit.rlim_max;
  fail_unless_equals_int (setrlimit (RLIMIT_AS, &limit), 0);
}

static void
push_caps (GstHarness * harness, guint size)
{
  g_autofree gchar *caps = g_strdup_printf (OBSERVATIONS, size, size);

  gst_harness_set_src_caps_str (harness, caps);
}

/* A picture that does not fit is no picture; the next one is. */
GST_START_TEST (test_depay)
{
  GstHarness *harness = gst_harness_new ("clothmetadepay");
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, 16, NULL);

  push_caps (harness, 64);
  fail_unless (gst_pad_has_current_caps (harness->sinkpad));
  limit_memory (64u << 20);
  push_caps (harness, 16384);
  fail_unless_equals_int (gst_harness_push (harness, buffer),
      GST_FLOW_NOT_NEGOTIATED);
  limit_memory (0);
  push_caps (harness, 64);
  {
    g_autoptr (GstCaps) caps = gst_pad_get_current_caps (harness->sinkpad);
    gint width;

    fail_unless (gst_structure_get_int (gst_caps_get_structure (caps, 0),
            "width", &width));
    fail_unless_equals_int (width, 64);
  }
  gst_harness_teardown (harness);
}

GST_END_TEST;

/* What OpenCV throws becomes an error; the next picture is searched again. */
GST_START_TEST (test_sift)
{
  enum
  { SIZE = 4096 };
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (NULL, NULL);
  g_autofree guint8 *data = g_malloc0 (SIZE * SIZE);
  const ClothCvPicture large = { data, SIZE, SIZE, SIZE };
  const ClothCvPicture small = { data, 64, 64, SIZE };
  ClothCvFeatures found;
  g_autoptr (GError) error = NULL;

  limit_memory (64u << 20);
  fail_if (cloth_cv_sift_run (sift, &large, NULL, &found, &error));
  limit_memory (0);
  fail_unless (g_error_matches (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_FAILED));
  GST_INFO ("%s", error->message);
  fail_unless (cloth_cv_sift_run (sift, &small, NULL, &found, NULL));
}

GST_END_TEST;

static Suite *
memory_suite (void)
{
  Suite *suite = suite_create ("memory");
  TCase *tests = tcase_create ("general");

  suite_add_tcase (suite, tests);
  tcase_add_test (tests, test_depay);
  tcase_add_test (tests, test_sift);
  return suite;
}

GST_CHECK_MAIN (memory);
