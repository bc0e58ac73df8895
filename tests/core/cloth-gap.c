/* The gap of a mesh: payload, meta, copies, misuse.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/cloth/cloth.h>
#include <math.h>

#include "tests/core/refused.h"

static const gfloat residuals[9] = {
  0.001f, -0.002f, 0.003f, NAN, 1, 2, 0, INFINITY, 0
};

static const gfloat sigmas[3] = { 0.0004f, -1, INFINITY };

static GstClothGap *
some_gap (void)
{
  return gst_cloth_gap_new (42, 3, residuals, sigmas);
}

static void
test_payload (void)
{
  gfloat given[9], given_sigmas[3];
  g_autoptr (GstClothGap) gap = NULL;
  const gfloat *r, *s;
  guint n;

  memcpy (given, residuals, sizeof given);
  memcpy (given_sigmas, sigmas, sizeof given_sigmas);
  gap = gst_cloth_gap_new (G_MAXUINT64, 3, given, given_sigmas);
  memset (given, 0, sizeof given);
  memset (given_sigmas, 0, sizeof given_sigmas);
  g_assert_cmpuint (gst_cloth_gap_get_sequence (gap), ==, G_MAXUINT64);
  g_assert_cmpuint (gst_cloth_gap_get_n_vertices (gap), ==, 3);
  r = gst_cloth_gap_get_residuals (gap, &n);
  g_assert_cmpuint (n, ==, 9);
  g_assert_cmpmem (r, 12, residuals, 12);
  for (guint i = 3; i < 9; i++)
    g_assert_true (isnan (r[i]));
  s = gst_cloth_gap_get_sigmas (gap, &n);
  g_assert_cmpuint (n, ==, 3);
  g_assert_cmpfloat (s[0], ==, 0.0004f);
  g_assert_true (isnan (s[1]) && isnan (s[2]));
}

static void
test_without_sigmas (void)
{
  g_autoptr (GstClothGap) gap = gst_cloth_gap_new (0, 1, residuals, NULL);

  g_assert_true (isnan (gst_cloth_gap_get_sigmas (gap, NULL)[0]));
  g_assert_cmpfloat (gst_cloth_gap_get_residuals (gap, NULL)[2], ==, 0.003f);
}

/* A copied buffer shares the payload, which outlives the first buffer; a piece of a
 * buffer is no mesh and has none. */
static void
test_copies (void)
{
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, 64, NULL);
  GstClothGap *gap = some_gap ();
  GstBuffer *copy, *piece;

  g_assert_null (gst_buffer_get_cloth_gap (buffer));
  gst_buffer_add_cloth_gap_meta (buffer, gap);
  copy = gst_buffer_copy (buffer);
  piece = gst_buffer_copy_region (buffer, GST_BUFFER_COPY_ALL, 8, 16);
  g_assert_true (gst_buffer_get_cloth_gap (copy) == gap);
  g_assert_null (gst_buffer_get_cloth_gap (piece));
  gst_buffer_unref (buffer);
  g_assert_cmpuint (gst_cloth_gap_get_sequence (gap), ==, 42);
  gst_buffer_unref (copy);
  gst_buffer_unref (piece);
}

/* A meta put on by GStreamer's own function has no payload yet. */
static void
test_bare (void)
{
  GstBuffer *buffer = gst_buffer_new ();
  GstBuffer *copy;

  gst_buffer_add_meta (buffer, gst_cloth_gap_meta_get_info (), NULL);
  g_assert_null (gst_buffer_get_cloth_gap (buffer));
  copy = gst_buffer_copy (buffer);
  g_assert_null (gst_buffer_get_cloth_gap (copy));
  gst_buffer_unref (buffer);
  gst_buffer_unref (copy);
}

static void
test_adding_replaces (void)
{
  GstBuffer *buffer = gst_buffer_new ();
  GstClothGap *second = gst_cloth_gap_new (2, 1, residuals, NULL);

  gst_buffer_add_cloth_gap_meta (buffer, some_gap ());
  gst_buffer_add_cloth_gap_meta (buffer, second);
  g_assert_true (gst_buffer_get_cloth_gap (buffer) == second);
  g_assert_cmpuint (gst_buffer_get_n_meta (buffer,
          gst_cloth_gap_meta_api_get_type ()), ==, 1);
  gst_buffer_unref (buffer);
}

/* It lies in the world: no tag ties it to a picture. */
static void
test_no_tags (void)
{
  const gchar *const *tags =
      gst_meta_api_type_get_tags (gst_cloth_gap_meta_api_get_type ());

  g_assert_true (tags == NULL || tags[0] == NULL);
}

static void
test_arrays (void)
{
  static const struct
  {
    guint n_residuals, n_sigmas;
    gboolean sigmas, good;
  } cases[] = {
    {9, 3, TRUE, TRUE}, {9, 0, FALSE, TRUE}, {3, 1, TRUE, TRUE},
    {0, 0, FALSE, FALSE}, {8, 0, FALSE, FALSE}, {9, 2, TRUE, FALSE},
    {6, 3, TRUE, FALSE}, {2, 0, TRUE, FALSE}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (GstClothGap) gap = gst_cloth_gap_new_from_arrays (1, residuals,
        cases[i].n_residuals, cases[i].sigmas ? sigmas : NULL,
        cases[i].n_sigmas, &error);

    if (cases[i].good) {
      g_assert_no_error (error);
      g_assert_cmpuint (gst_cloth_gap_get_n_vertices (gap), ==,
          cases[i].n_residuals / 3);
    } else {
      g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE);
      g_assert_null (gap);
    }
  }
}

static void
test_misuse (void)
{
  GstBuffer *shared = gst_buffer_new ();
  GstBuffer *also = gst_buffer_ref (shared);
  g_autoptr (GstClothGap) gap = some_gap ();

  ASSERT_MISUSE (gst_cloth_gap_new (0, 0, residuals, NULL));
  ASSERT_MISUSE (gst_cloth_gap_new (0, 1, NULL, NULL));
  ASSERT_MISUSE (gst_cloth_gap_new (0, GST_CLOTH_MAX_VERTICES + 1, residuals,
          NULL));
  ASSERT_MISUSE (gst_buffer_add_cloth_gap_meta (shared, gap));
  ASSERT_MISUSE (gst_buffer_get_cloth_gap (NULL));
  gst_buffer_unref (also);
  ASSERT_MISUSE (gst_buffer_add_cloth_gap_meta (shared, NULL));
  gst_buffer_unref (shared);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  gst_init (&argc, &argv);
  g_test_add_func ("/gap/payload", test_payload);
  g_test_add_func ("/gap/without-sigmas", test_without_sigmas);
  g_test_add_func ("/gap/copies", test_copies);
  g_test_add_func ("/gap/bare", test_bare);
  g_test_add_func ("/gap/adding-replaces", test_adding_replaces);
  g_test_add_func ("/gap/no-tags", test_no_tags);
  g_test_add_func ("/gap/arrays", test_arrays);
  g_test_add_func ("/gap/misuse", test_misuse);
  return g_test_run ();
}
