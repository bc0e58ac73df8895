/* Merging estimates of the same corner: closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/rig/merge.h"

#define NEAR(a, b) g_assert_cmpfloat_with_epsilon (a, b, 1e-12)

static void
test_merge (void)
{
  g_autoptr (ClothMerge) merge = cloth_merge_new (9);
  ClothTriangulateView view;
  const gdouble small[3] = { 1., 0., 1. }, large[3] = { 3., 0., 3. };
  const gdouble tilted[3] = { 2., 1., 2. }, none[3] = { 0., 0., 0. };
  const gdouble wide[3] = { 1., 0., 4. }, high[3] = { 4., 0., 1. };
  const gdouble bad[3] = { 1., 2., 1. }, nan[3] = { NAN, 0., 1. };
  const gdouble flat[3] = { 0., 0., 1. };

  for (guint round = 0; round < 2; round++) {
    cloth_merge_clear (merge);
    /* 0: one; 1: the same four times; 2: two apart, weights 1 and 1/3 */
    cloth_merge_add (merge, 0, 10., 20., tilted);
    for (guint i = 0; i < 6; i++)
      cloth_merge_add (merge, 1, 5., 6., tilted);
    cloth_merge_add (merge, 2, 0., 0., small);
    cloth_merge_add (merge, 2, 2., 4., large);
    /* 3: each good in one direction */
    cloth_merge_add (merge, 3, 0., 1., wide);
    cloth_merge_add (merge, 3, 1., 0., high);
    /* 4: contradictory; 5: nothing usable; 6: not stated; 7: nothing */
    cloth_merge_add (merge, 4, 0., 0., small);
    cloth_merge_add (merge, 4, 10., 0., small);
    cloth_merge_add (merge, 5, NAN, 0., small);
    cloth_merge_add (merge, 5, 0., INFINITY, small);
    cloth_merge_add (merge, 5, 0., 0., bad);
    cloth_merge_add (merge, 5, 0., 0., nan);
    cloth_merge_add (merge, 5, 0., 0., flat);
    cloth_merge_add (merge, 6, 1., 2., none);
    /* 8: the same place, of other covariance */
    cloth_merge_add (merge, 8, 1., 2., small);
    cloth_merge_add (merge, 8, 1., 2., large);
    cloth_merge_finish (merge, 4., 0., &view);

    NEAR (view.x[0], 10.);
    NEAR (view.y[0], 20.);
    NEAR (view.xx[0], 2.);
    NEAR (view.xy[0], 1.);
    NEAR (view.yy[0], 2.);
    /* the same measurement four times is no better than once */
    NEAR (view.x[1], 5.);
    NEAR (view.y[1], 6.);
    NEAR (view.xx[1], 2.);
    NEAR (view.xy[1], 1.);
    NEAR (view.yy[1], 2.);
    /* (0·1 + 2·1/3) / (1 + 1/3), variance 2 / (1 + 1/3) */
    NEAR (view.x[2], 0.5);
    NEAR (view.y[2], 1.);
    NEAR (view.xx[2], 1.5);
    NEAR (view.xy[2], 0.);
    NEAR (view.yy[2], 1.5);
    /* x: (0·1 + 1·1/4) / 1.25, y: likewise the other way round */
    NEAR (view.x[3], 0.2);
    NEAR (view.y[3], 0.2);
    NEAR (view.xx[3], 1.6);
    NEAR (view.yy[3], 1.6);
    g_assert_true (isnan (view.x[4]) && isnan (view.x[5])
        && isnan (view.x[7]));
    NEAR (view.x[6], 1.);
    NEAR (view.xx[6], 1.);
    NEAR (view.xy[6], 0.);
    NEAR (view.yy[6], 1.);
    NEAR (view.x[8], 1.);
    NEAR (view.xx[8], 1.5);
    /* 5 px from the middle: with a variance of 1 + 1 they agree within 4 σ */
    cloth_merge_finish (merge, 4., 1., &view);
    NEAR (view.x[4], 5.);
    NEAR (view.xx[4], 1.);
  }
  cloth_merge_free (NULL);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/merge", test_merge);
  return g_test_run ();
}
