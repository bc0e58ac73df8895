/* cv::triangulatePoints as a plain C function.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/reference/cv.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

/* @projections: two row-major 3×4 matrices
 * @n: points
 * @x0: (array length=n): columns in the first view
 * @y0: (array length=n): rows in the first view
 * @x1: (array length=n): columns in the second view
 * @y1: (array length=n): rows in the second view
 * @points: (out caller-allocates): n times x, y, z
 *
 * Linear triangulation from two views by OpenCV, in its own threads' number of one.
 *
 * Returns: %FALSE when OpenCV threw
 */
gboolean
cloth_cv_triangulate_points (const gdouble projections[24], guint n,
    const gdouble * x0, const gdouble * y0, const gdouble * x1,
    const gdouble * y1, gdouble * points)
{
  try {
    cv::setNumThreads (1);
    cv::Mat p0 (3, 4, CV_64F, const_cast < gdouble * >(projections));
    cv::Mat p1 (3, 4, CV_64F, const_cast < gdouble * >(projections + 12));
    cv::Mat a (2, (int) n, CV_64F), b (2, (int) n, CV_64F), h;

    for (guint i = 0; i < n; i++) {
      a.at < double >(0, (int) i) = x0[i];
      a.at < double >(1, (int) i) = y0[i];
      b.at < double >(0, (int) i) = x1[i];
      b.at < double >(1, (int) i) = y1[i];
    }
    cv::triangulatePoints (p0, p1, a, b, h);
    for (guint i = 0; i < n; i++)
      for (int j = 0; j < 3; j++)
        points[3 * i + j] = h.at < double >(j, (int) i) /
            h.at < double >(3, (int) i);
    return TRUE;
  }
  catch (...) {
    return FALSE;
  }
}
