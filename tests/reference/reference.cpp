/* OpenCV's functions for the tasks of this project, as plain C functions: the peer that the
 * benchmarks and some tests are held against. Pictures may have any stride; what OpenCV
 * throws becomes FALSE. What the product has of OpenCV is in gst/cv.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/reference/reference.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <memory>
#include <vector>

struct _ClothCvSaddle {
  cv::Mat smooth, xx, yy, xy, det, mask;
};

ClothCvSaddle *
cloth_cv_saddle_new (void)
{
  cv::setNumThreads (1);
  return new ClothCvSaddle ();
}

void
cloth_cv_saddle_free (ClothCvSaddle * self)
{
  delete self;
}

/* @self: its buffers, kept from picture to picture
 * @data: grey picture
 * @width: columns
 * @height: rows
 * @stride: bytes from row to row
 * @sigma: width of the Gaussian, px
 * @epsilon: bound of −Det, grey levels² / px⁴
 * @n_below: (out): how many pixels pass
 *
 * The chain a user of OpenCV would write: GaussianBlur, three Sobel second derivatives,
 * the determinant, a comparison.
 *
 * Returns: FALSE when OpenCV threw.
 */
gboolean
cloth_cv_saddle_mask (ClothCvSaddle * self, const guint8 * data, gint width,
    gint height, gint stride, gdouble sigma, gdouble epsilon, guint * n_below)
{
  try {
    const cv::Mat image (height, width, CV_8UC1,
        const_cast < guint8 * >(data), (size_t) stride);

    cv::GaussianBlur (image, self->smooth, cv::Size (0, 0), sigma, sigma,
        cv::BORDER_REPLICATE);
    /* Sobel's 3×3 kernels: [1 -2 1] by [1 2 1], and [-1 0 1] twice. */
    cv::Sobel (self->smooth, self->xx, CV_32F, 2, 0, 3, 0.25);
    cv::Sobel (self->smooth, self->yy, CV_32F, 0, 2, 3, 0.25);
    cv::Sobel (self->smooth, self->xy, CV_32F, 1, 1, 3, 0.25);
    cv::multiply (self->xx, self->yy, self->det);
    cv::multiply (self->xy, self->xy, self->xy);
    cv::subtract (self->det, self->xy, self->det);
    cv::compare (self->det, -epsilon, self->mask, cv::CMP_LT);
    *n_below = (guint) cv::countNonZero (self->mask);
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}

/* @data: grey picture
 * @width: columns
 * @height: rows
 * @stride: bytes from row to row
 * @half_window: of the search window, px
 * @xy: (inout): @n places
 * @n: how many
 *
 * Returns: FALSE when OpenCV threw.
 */
gboolean
cloth_cv_corner_sub_pix (const guint8 * data, gint width, gint height,
    gint stride, gint half_window, gfloat * xy, guint n)
{
  try {
    const cv::Mat image (height, width, CV_8UC1,
        const_cast < guint8 * >(data), (size_t) stride);
    cv::Mat corners ((int) n, 1, CV_32FC2, xy);

    cv::cornerSubPix (image, corners, cv::Size (half_window, half_window),
        cv::Size (-1, -1), cv::TermCriteria (cv::TermCriteria::COUNT +
            cv::TermCriteria::EPS, 40, 1e-3));
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}

/* @bgr: colour picture, three bytes a pixel
 * @width: columns
 * @height: rows
 * @stride: bytes from row to row
 * @min_area: least area of a contour, px
 * @max_area: greatest area
 * @n_dots: (out): contours between both
 *
 * Dots as Scholz et al. 2005, 4.1, find them: hue, Canny's edges of the luminance, outer
 * contours, the centre of gravity of each.
 *
 * Returns: %FALSE when OpenCV failed
 */
gboolean
cloth_cv_dots (const guint8 * bgr, gint width, gint height, gint stride,
    gdouble min_area, gdouble max_area, guint * n_dots)
{
  try {
    const cv::Mat image (height, width, CV_8UC3,
        const_cast < guint8 * >(bgr), (size_t) stride);
    std::vector < std::vector < cv::Point > >contours;
    std::vector < cv::Vec4i > levels;
    cv::Mat hsv, grey, edges;

    cv::cvtColor (image, hsv, cv::COLOR_BGR2HSV);
    cv::cvtColor (image, grey, cv::COLOR_BGR2GRAY);
    cv::Canny (grey, edges, 40, 100);
    /* Outer contours wherever they lie: the cloth's own encloses the dots. */
    cv::findContours (edges, contours, levels, cv::RETR_CCOMP,
        cv::CHAIN_APPROX_NONE);
    *n_dots = 0;
    for (size_t i = 0; i < contours.size (); i++) {
      const cv::Moments moments = cv::moments (contours[i]);

      *n_dots += levels[i][3] < 0 && moments.m00 >= min_area
          && moments.m00 <= max_area;
    }
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}

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

#define BYTES 128

/* @K: camera matrix, by rows
 * @k: (array length=n_k): coefficients of the lens
 * @fisheye: whether they are those of a fisheye
 * @R: rotation to the rectified frame, by rows
 * @focal: of the rectified picture
 * @centre: of it
 * @x: (out caller-allocates): width·height
 * @y: (out caller-allocates): width·height
 *
 * initUndistortRectifyMap of either lens.
 *
 * Returns: FALSE when OpenCV threw.
 */
gboolean
cloth_cv_undistort_rectify_map (const gdouble K[9], const gdouble * k,
    guint n_k, gboolean fisheye, const gdouble R[9], gdouble focal,
    const gdouble centre[2], gint width, gint height, gfloat * x, gfloat * y)
{
  try {
    const cv::Matx33d from (K), turn (R);
    const cv::Matx33d to (focal, 0, centre[0], 0, focal, centre[1], 0, 0, 1);
    const cv::Mat lens = n_k ? cv::Mat (1, (int) n_k, CV_64F,
        const_cast < gdouble * >(k)) : cv::Mat ();
    cv::Mat across, down;

    if (fisheye)
      cv::fisheye::initUndistortRectifyMap (from, lens, turn, to,
          cv::Size (width, height), CV_32FC1, across, down);
    else
      cv::initUndistortRectifyMap (from, lens, turn, to,
          cv::Size (width, height), CV_32FC1, across, down);
    across.copyTo (cv::Mat (height, width, CV_32FC1, x));
    down.copyTo (cv::Mat (height, width, CV_32FC1, y));
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}

/* @K: camera matrix of both cameras, by rows
 * @R: rotation from the first camera's frame to the second's, by rows
 * @t: translation
 * @R1: (out): rotation of the first camera, by rows
 * @R2: (out): of the second
 *
 * stereoRectify of two cameras without lens distortion.
 *
 * Returns: FALSE when OpenCV threw.
 */
gboolean
cloth_cv_stereo_rectify (const gdouble K[9], gint width, gint height,
    const gdouble R[9], const gdouble t[3], gdouble R1[9], gdouble R2[9])
{
  try {
    const cv::Matx33d matrix (K), turn (R);
    const cv::Vec3d move (t[0], t[1], t[2]);
    cv::Mat one, two, p1, p2, q;

    cv::stereoRectify (matrix, cv::noArray (), matrix, cv::noArray (),
        cv::Size (width, height), turn, move, one, two, p1, p2, q);
    one.copyTo (cv::Mat (3, 3, CV_64F, R1));
    two.copyTo (cv::Mat (3, 3, CV_64F, R2));
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}

/* @path: a picture of one float a pixel
 * @width: columns that it must have
 * @height: rows
 * @floats: (out caller-allocates): width·height, top row first
 *
 * Returns: FALSE when OpenCV can't read it or it is of another size or kind.
 */
gboolean
cloth_cv_read_floats (const gchar * path, gint width, gint height,
    gfloat * floats)
{
  try {
    const cv::Mat read = cv::imread (path, cv::IMREAD_UNCHANGED);

    if (read.type () != CV_32FC1 || read.cols != width || read.rows != height)
      return FALSE;
    read.copyTo (cv::Mat (height, width, CV_32FC1, floats));
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}

struct _ClothCvMatcher {
  cv::Ptr < cv::DescriptorMatcher > matcher;
  int type;
};

/* @descriptors: @n times 128 bytes
 * @n: how many
 * @flann: whether to build randomised k-d trees, as OpenCV does by default: four of them,
 *   32 leaves looked at; else all descriptors are compared
 *
 * Returns: %NULL when OpenCV threw
 */
ClothCvMatcher *
cloth_cv_matcher_new (const guint8 * descriptors, guint n, gboolean flann)
{
  try {
    std::unique_ptr < ClothCvMatcher > self (new ClothCvMatcher ());
    const cv::Mat bytes ((int) n, BYTES, CV_8UC1,
        const_cast < guint8 * >(descriptors));
    cv::Mat reference;

    cv::setNumThreads (1);
    self->type = flann ? CV_32F : CV_8U;
    if (flann)
      self->matcher = cv::makePtr < cv::FlannBasedMatcher > ();
    else
      self->matcher = cv::makePtr < cv::BFMatcher > (cv::NORM_L2);
    bytes.convertTo (reference, self->type);
    self->matcher->add (std::vector < cv::Mat > (1, reference));
    self->matcher->train ();
    return self.release ();
  } catch (...) {
    return NULL;
  }
}

void
cloth_cv_matcher_free (ClothCvMatcher * self)
{
  delete self;
}

/* @queries: @n times 128 bytes
 * @n: how many
 * @nearest: (out caller-allocates) (array length=n): the nearest of each, or what is taken
 *   for it
 *
 * Returns: FALSE when OpenCV threw.
 */
gboolean
cloth_cv_matcher_run (ClothCvMatcher * self, const guint8 * queries, guint n,
    guint32 * nearest)
{
  try {
    const cv::Mat bytes ((int) n, BYTES, CV_8UC1,
        const_cast < guint8 * >(queries));
    std::vector < std::vector < cv::DMatch > >found;
    cv::Mat query;

    bytes.convertTo (query, self->type);
    /* two of each, as ours gives */
    self->matcher->knnMatch (query, found, 2);
    for (guint i = 0; i < n; i++)
      nearest[i] = found[i].empty ()? G_MAXUINT32 :
          (guint32) found[i][0].trainIdx;
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}

/* @mask: (out caller-allocates): 255 where a polygon is, else 0; rows of @width without gaps
 * @corners: x and y of each polygon's, px
 * @n_corners: of each polygon
 * @n: how many
 *
 * A silhouette as a user of OpenCV would draw it: one call of fillConvexPoly a polygon, with four
 * bits of a pixel's fraction. It fills the pixels that a border crosses, too.
 *
 * Returns: FALSE when OpenCV threw.
 */
gboolean
cloth_cv_fill (guint8 * mask, gint width, gint height, const gdouble * corners,
    guint n_corners, guint n)
{
  try {
    cv::Mat image (height, width, CV_8UC1, mask);
    std::vector < cv::Point > polygon (n_corners);

    image.setTo (0);
    for (guint i = 0; i < n; i++) {
      for (guint k = 0; k < n_corners; k++, corners += 2)
        polygon[k] = cv::Point (cvRound (16 * corners[0]),
            cvRound (16 * corners[1]));
      cv::fillConvexPoly (image, polygon, cv::Scalar (255), cv::LINE_8, 4);
    }
    return TRUE;
  } catch (...) {
    return FALSE;
  }
}
