/* Gusts: winds that change from one moment to the next.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/test.h"

G_BEGIN_DECLS

/* Directions of wind along the ground, and parts of a block of time. */
#define CLOTH_GAP_GUST_WAYS 2
#define CLOTH_GAP_GUST_PARTS 3
#define CLOTH_GAP_GUST_COLUMNS (CLOTH_GAP_GUST_WAYS * CLOTH_GAP_GUST_PARTS)

/* @log_bayes_factor: logarithm of the Bayes factor against no wind at all
 * @intensity: root mean square of the winds' speed along the ground, m/s
 * @azimuth: which way most of it blows, ° from x to y, −90 to 90
 *
 * What is known of gusts.
 */
typedef struct {
  gdouble log_bayes_factor;
  gdouble intensity;
  gdouble azimuth;
} ClothGapGusts;

gboolean cloth_gap_test_gusts (const ClothGapTest * test,
    gdouble intensity, gdouble share, ClothGapGusts * gusts);

G_END_DECLS
