/* Features of a print that several elements share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>

#include "elements/gstclothprint.h"
#include "gst/math/random.h"

#define SIZE 96

static guint8 pixels[SIZE * SIZE];

static const ClothReference *
acquire (gdouble width_m, gint sides)
{
  const ClothCvPicture picture = { pixels, SIZE, SIZE, SIZE };
  ClothReferenceParams params = cloth_reference_default_params ();
  g_autoptr (ClothPool) pool = cloth_pool_new (1);
  const ClothReference *reference;
  GError *error = NULL;

  params.cloth_m[0] = params.cloth_m[1] = width_m;
  params.sides = sides;
  reference = gst_cloth_print_acquire (&params, &picture, pool, &error);
  g_assert_no_error (error);
  return reference;
}

static void
draw (guint64 seed)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint i = 0; i < G_N_ELEMENTS (pixels); i++)
    pixels[i] = cloth_random_uniform (&random) < 0.5 ? 30 : 220;
}

GST_START_TEST (test_shared)
{
  const ClothReference *first, *second, *other;

  draw (1);
  first = acquire (0.5, 1);
  second = acquire (0.5, 1);
  fail_unless (first == second);
  /* of another size, of two sides, of one pixel more or less: not the same */
  other = acquire (0.6, 1);
  fail_if (other == first);
  gst_cloth_print_release (other);
  other = acquire (0.5, 2);
  fail_if (other == first);
  gst_cloth_print_release (other);
  pixels[SIZE * SIZE - 1] ^= 64;
  other = acquire (0.5, 1);
  fail_if (other == first);
  gst_cloth_print_release (other);
  pixels[SIZE * SIZE - 1] ^= 64;
  /* it stays as long as anybody has it */
  gst_cloth_print_release (first);
  fail_unless (acquire (0.5, 1) == second);
  gst_cloth_print_release (second);
  gst_cloth_print_release (second);
}

GST_END_TEST;

/* A print that can't be looked at leaves nothing behind. */
GST_START_TEST (test_refused)
{
  const ClothCvPicture picture = { pixels, SIZE, SIZE, SIZE };
  ClothReferenceParams params = cloth_reference_default_params ();
  g_autoptr (ClothPool) pool = cloth_pool_new (1);

  draw (2);
  params.cloth_m[0] = params.cloth_m[1] = 0.5;
  params.sides = 3;
  for (guint i = 0; i < 2; i++) {
    g_autoptr (GError) error = NULL;

    fail_if (gst_cloth_print_acquire (&params, &picture, pool, &error));
    fail_unless (error != NULL);
  }
}

GST_END_TEST;

static gpointer
acquire_in_thread (gpointer data)
{
  return (gpointer) acquire (0.5, 1);
}

GST_START_TEST (test_threads)
{
  GThread *threads[8];
  const ClothReference *found[8];

  draw (3);
  for (guint i = 0; i < 8; i++)
    threads[i] = g_thread_new ("print", acquire_in_thread, NULL);
  for (guint i = 0; i < 8; i++)
    found[i] = g_thread_join (threads[i]);
  for (guint i = 0; i < 8; i++) {
    fail_unless (found[i] == found[0]);
    gst_cloth_print_release (found[i]);
  }
}

GST_END_TEST;

static Suite *
clothprint_suite (void)
{
  Suite *suite = suite_create ("clothprint");
  TCase *tests = tcase_create ("general");

  tcase_set_timeout (tests, 60);
  tcase_add_test (tests, test_shared);
  tcase_add_test (tests, test_refused);
  tcase_add_test (tests, test_threads);
  suite_add_tcase (suite, tests);
  return suite;
}

GST_CHECK_MAIN (clothprint);
