/* The rendered film of a cloth before three rectified cameras on a line, with the truth of
 * its disparities.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

#define TEST_STEREO_CAMERAS 3

/* @luma: of each camera: frame by frame, rows without padding. The first one is in the
 *   middle, the second to its right, the third to its left
 * @focal: focal length, px
 * @centre: principal point, px
 * @baseline: to either side, m
 * @rotation: of the middle camera, by rows: R of K[R|t]
 * @translation: t, m
 * @vertices: of the cloth, m: [frame][row][column][x y z]
 */
typedef struct {
  gint width, height;
  guint n_frames;
  guint8 *luma[TEST_STEREO_CAMERAS];
  gdouble focal, centre[2], baseline;
  gdouble rotation[9], translation[3];
  gfloat *vertices;
} TestStereo;

TestStereo *test_stereo_load (const gchar * folder);
void test_stereo_free (TestStereo * film);
const guint8 *test_stereo_picture (const TestStereo * film, guint camera,
    guint frame);
void test_stereo_truth (const TestStereo * film, guint frame,
    gfloat * disparities);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (TestStereo, test_stereo_free)
G_END_DECLS
