/* OpenCV's features, block matching and resampling as plain C functions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cv/cv.h"
#include "gst/cv/guard-private.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

/* OpenCV doubles the picture by interpolation between the centres of pixels, but takes
 * column x of the large one for x / 2 of the small one, which is (x - 1/2) / 2. */
#define SIFT_SHIFT 0.25f

static gboolean
check_picture (const guint8 * data, gint width, gint height, gint stride,
    GError ** error)
{
  if (data == NULL || width < 1 || height < 1 || width > CLOTH_CV_MAX_SIZE
      || height > CLOTH_CV_MAX_SIZE) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "No picture has %d × %d pixels: 1 to %d each way are possible", width,
        height, CLOTH_CV_MAX_SIZE);
    return FALSE;
  }
  if (stride < width) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "Rows of %d pixels can't be %d bytes apart", width, stride);
    return FALSE;
  }
  return TRUE;
}

static gboolean
check_view (const ClothCvPicture * picture, GError ** error)
{
  return check_picture (picture->data, picture->width, picture->height,
      picture->stride, error);
}

/* NaN is in no range. */
static gboolean
check_range (const gchar * name, gdouble value, gdouble least, gdouble most,
    GError ** error)
{
  if (value >= least && value <= most)
    return TRUE;
  g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
      "%s is %g: it may be %g to %g", name, value, least, most);
  return FALSE;
}

static cv::Mat
as_mat (const guint8 * data, gint width, gint height, gint stride)
{
  return cv::Mat (height, width, CV_8UC1, const_cast < guint8 * >(data),
      (size_t) stride);
}

static cv::Mat
view (const ClothCvPicture * picture)
{
  return as_mat (picture->data, picture->width, picture->height,
      picture->stride);
}

/* ---- features ---- */

struct _ClothCvSift
{
  cv::Ptr < cv::SIFT > sift;
  std::vector < cv::KeyPoint > points;
  cv::Mat found;
  std::vector < int >order;
  std::vector < gfloat > x, y, scale, angle;
  std::vector < guint8 > descriptors;
  guint most = 0, n_dropped = 0;
};

/* Returns: OpenCV's parameters: 3 layers, contrast 0.04, edge 10, sigma 1.6
 */
ClothCvSiftParams
cloth_cv_sift_default_params (void)
{
  return ClothCvSiftParams { 3, 0.04, 10, 1.6 };
}

/* @params: (nullable): parameters; %NULL: the defaults
 * @error: (out): set to %CLOTH_CV_ERROR_PARAMETER
 *
 * Returns: (transfer full): a detector, for one thread at a time; %NULL on error
 */
ClothCvSift *
cloth_cv_sift_new (const ClothCvSiftParams * params, GError ** error)
{
  const ClothCvSiftParams p =
      params ? *params : cloth_cv_sift_default_params ();
  ClothCvSift *self = NULL;

  if (!check_range ("n_layers", p.n_layers, 1, 8, error)
      || !check_range ("contrast", p.contrast, 0, 1, error)
      || !check_range ("edge", p.edge, 1, 1000, error)
      || !check_range ("sigma", p.sigma, 0.6, 10, error))
    return NULL;
  guard (error,[&]{
        std::unique_ptr < ClothCvSift > made (new ClothCvSift ());

        made->sift = cv::SIFT::create (0, p.n_layers, p.contrast, p.edge,
            p.sigma, CV_8U);
        self = made.release ();
      });
  return self;
}

/* @sift: (nullable) (transfer full): a detector
 */
void
cloth_cv_sift_free (ClothCvSift * sift)
{
  delete sift;
}

static bool
comes_before (const cv::KeyPoint & a, const cv::KeyPoint & b)
{
  if (a.pt.y != b.pt.y)
    return a.pt.y < b.pt.y;
  if (a.pt.x != b.pt.x)
    return a.pt.x < b.pt.x;
  return a.size != b.size ? a.size < b.size : a.angle < b.angle;
}

/* Leaves the most features that may be in order, the strongest. */
static void
drop_weak (ClothCvSift * self)
{
  const size_t n = self->points.size ();

  self->order.resize (n);
  for (size_t i = 0; i < n; i++)
    self->order[i] = (int) i;
  self->n_dropped = 0;
  if (self->most == 0 || n <= self->most)
    return;
  self->n_dropped = (guint) (n - self->most);
  std::sort (self->order.begin (), self->order.end (),[&](int a, int b) {
        const cv::KeyPoint & p = self->points[a], &q = self->points[b];

        if (p.response != q.response)
          return p.response > q.response;
        return comes_before (p, q) || (!comes_before (q, p) && a < b);
      });
  self->order.resize (self->most);
}

static void
arrange (ClothCvSift * self)
{
  drop_weak (self);
  const size_t n = self->order.size ();

  std::sort (self->order.begin (), self->order.end (),[&](int a, int b) {
        const cv::KeyPoint & p = self->points[a], &q = self->points[b];

        return comes_before (p, q) || (!comes_before (q, p) && a < b);
      });
  self->x.resize (n);
  self->y.resize (n);
  self->scale.resize (n);
  self->angle.resize (n);
  self->descriptors.resize (n * CLOTH_CV_SIFT_BYTES);
  for (size_t i = 0; i < n; i++) {
    const cv::KeyPoint & point = self->points[self->order[i]];
    const guint8 *bytes = self->found.ptr < guint8 > (self->order[i]);

    self->x[i] = point.pt.x - SIFT_SHIFT;
    self->y[i] = point.pt.y - SIFT_SHIFT;
    self->scale[i] = point.size / 2;
    self->angle[i] = point.angle < 360 ? (gfloat) (point.angle * G_PI / 180) : 0;
    std::copy (bytes, bytes + CLOTH_CV_SIFT_BYTES,
        &self->descriptors[i * CLOTH_CV_SIFT_BYTES]);
  }
}

/* @sift: a detector
 * @most: how many features of a picture are kept, the strongest: those of most contrast; 0:
 *   all
 */
void
cloth_cv_sift_keep (ClothCvSift * sift, guint most)
{
  sift->most = most;
}

/* @sift: a detector
 *
 * Returns: how many features of the last picture were too many
 */
guint
cloth_cv_sift_get_n_dropped (const ClothCvSift * sift)
{
  return sift->n_dropped;
}

/* @sift: detector, whose memory is used again for each picture
 * @picture: picture, at most %CLOTH_CV_SIFT_MAX_AREA pixels
 * @mask: (nullable): of the same size: features whose pixel is 0 in it are left out, before
 *   they are described
 * @features: (out caller-allocates): what was found; valid until the next run
 * @error: (out): set on failure
 *
 * SIFT (Lowe 2004). The detector's places are shifted to the centres of pixels.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_cv_sift_run (ClothCvSift * sift, const ClothCvPicture * picture,
    const ClothCvPicture * mask, ClothCvFeatures * features, GError ** error)
{
  *features = ClothCvFeatures {};
  if (!check_view (picture, error) || (mask && !check_view (mask, error)))
    return FALSE;
  if ((gint64) picture->width * picture->height > CLOTH_CV_SIFT_MAX_AREA) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "Features of %d × %d pixels would take too much memory: scale the "
        "picture to at most %d pixels", picture->width, picture->height,
        CLOTH_CV_SIFT_MAX_AREA);
    return FALSE;
  }
  if (mask && (mask->width != picture->width
          || mask->height != picture->height)) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "The mask has %d × %d pixels, its picture %d × %d", mask->width,
        mask->height, picture->width, picture->height);
    return FALSE;
  }
  if (!guard (error,[&]{
            sift->sift->detectAndCompute (view (picture),
                mask ? view (mask) : cv::Mat (), sift->points, sift->found);
            arrange (sift);
          }))
    return FALSE;
  features->n = (guint) sift->order.size ();
  features->x = sift->x.data ();
  features->y = sift->y.data ();
  features->scale = sift->scale.data ();
  features->angle = sift->angle.data ();
  features->descriptors = sift->descriptors.data ();
  return TRUE;
}

/* ---- block matching ---- */

/* Room in 16 bits for the greater penalty: less for larger blocks, by so much a pixel. */
#define MOST_STEP 28000
#define BLOCK_COST 16

struct _ClothCvStereo
{
  ClothCvStereoParams params;
  cv::Ptr < cv::StereoSGBM > matcher;
  cv::Mat found;
};

/* Returns: parameters for a cloth 1 to 3 m from cameras 0.1 m apart: 128 disparities from
 *   0 on, blocks of 7 × 7 pixels, penalties 8 and 32 a pixel of the block, disparities
 *   checked to 1 px, 10% uniqueness, pieces of 100 px
 */
ClothCvStereoParams
cloth_cv_stereo_default_params (void)
{
  return ClothCvStereoParams { 0, 128, 7, 8 * 7 * 7, 32 * 7 * 7, 1, 10, 100, 2 };
}

/* OpenCV adds a path's costs in 16 bits and lets them overflow, which gives wrong disparities
 * or none. To the greater penalty come the costs of a block that nothing matches: where both
 * pictures are noise of black and white 10 to 17 a pixel, of small blocks sometimes more. */
static gboolean
check_sums (const ClothCvStereoParams * p, GError ** error)
{
  const gint area = p->window * p->window;
  const gint most = MOST_STEP - BLOCK_COST * area;

  if (p->large_step <= most)
    return TRUE;
  g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
      "large_step is %d, which is %g for each pixel of a block of %d × %d: "
      "OpenCV's sums hold at most %d. Make the step or the window smaller",
      p->large_step, p->large_step / (gdouble) area, p->window, p->window,
      most / area);
  return FALSE;
}

static gboolean
check_stereo (const ClothCvStereoParams * p, GError ** error)
{
  if (!check_range ("least", p->least, 0, 4096, error)
      || !check_range ("range", p->range, 16, 1024, error)
      || !check_range ("window", p->window, 1, 31, error)
      || !check_range ("small_step", p->small_step, 0, MOST_STEP - 1, error)
      || !check_range ("large_step", p->large_step, p->small_step + 1.,
          MOST_STEP, error) || !check_sums (p, error)
      || !check_range ("left_right", p->left_right, -1, 255, error)
      || !check_range ("uniqueness", p->uniqueness, 0, 100, error)
      || !check_range ("speckle_area", p->speckle_area, 0, 100000, error)
      || !check_range ("speckle_step", p->speckle_step, 1, 255, error))
    return FALSE;
  if (p->range % 16 == 0 && p->window % 2 == 1)
    return TRUE;
  g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
      "range is %d and window %d: make the range a multiple of 16 and the "
      "window odd", p->range, p->window);
  return FALSE;
}

/* @params: (nullable): parameters; %NULL: the defaults
 * @error: (out): set to %CLOTH_CV_ERROR_PARAMETER
 *
 * Returns: (transfer full): a matcher, for one thread at a time; %NULL on error
 */
ClothCvStereo *
cloth_cv_stereo_new (const ClothCvStereoParams * params, GError ** error)
{
  const ClothCvStereoParams p =
      params ? *params : cloth_cv_stereo_default_params ();
  ClothCvStereo *self = NULL;

  if (!check_stereo (&p, error))
    return NULL;
  guard (error,[&]{
        std::unique_ptr < ClothCvStereo > made (new ClothCvStereo ());

        made->params = p;
        made->matcher = cv::StereoSGBM::create (p.least, p.range, p.window,
            p.small_step, p.large_step, p.left_right, 0, p.uniqueness,
            p.speckle_area, p.speckle_step, cv::StereoSGBM::MODE_SGBM_3WAY);
        self = made.release ();
      });
  return self;
}

/* @stereo: (nullable) (transfer full): a matcher
 */
void
cloth_cv_stereo_free (ClothCvStereo * stereo)
{
  delete stereo;
}

/* @stereo: matcher, whose memory is used again for each pair
 * @left: left picture of a rectified pair, wider than the greatest disparity and a block
 * @right: right picture, of the same size
 * @disparities: (out caller-allocates): width × height: by how many 1/%CLOTH_CV_STEPS px
 *   each pixel of @left lies further right than in @right; %CLOTH_CV_NO_DISPARITY where that
 *   isn't known
 * @error: (out): set on failure
 *
 * Semiglobal matching (Hirschmüller 2008) of blocks along three paths.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_cv_stereo_run (ClothCvStereo * stereo, const ClothCvPicture * left,
    const ClothCvPicture * right, gint16 * disparities, GError ** error)
{
  const ClothCvStereoParams *p = &stereo->params;
  const gint needed = p->least + p->range + p->window;

  if (!check_view (left, error) || !check_view (right, error))
    return FALSE;
  if (left->width != right->width || left->height != right->height) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "The left picture has %d × %d pixels, the right one %d × %d",
        left->width, left->height, right->width, right->height);
    return FALSE;
  }
  /* OpenCV's three paths look beyond pictures that have no room for a disparity. */
  if (left->width <= needed || left->height < p->window) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "Pictures of %d × %d pixels are too small for disparities up to %d "
        "px: more than %d × %d are needed", left->width, left->height,
        p->least + p->range, needed, p->window - 1);
    return FALSE;
  }
  return guard (error,[&]{
        const gint16 none = (gint16) ((p->least - 1) * CLOTH_CV_STEPS);

        stereo->matcher->compute (view (left), view (right), stereo->found);
        for (gint y = 0; y < left->height; y++) {
          const gint16 *from = stereo->found.ptr < gint16 > (y);
          gint16 *to = disparities + (gsize) y * (gsize) left->width;

          for (gint x = 0; x < left->width; x++)
            to[x] = from[x] > none ? from[x] : CLOTH_CV_NO_DISPARITY;
        }
      });
}

/* ---- resampling ---- */

/* @from: picture
 * @x: (array): @width × @height columns of @from, px
 * @y: (array): @width × @height rows of @from
 * @width: columns of what is made
 * @height: rows
 * @to: (out caller-allocates): top-left pixel of what is made, outside of @from
 * @to_stride: bytes from one of its rows to the next
 * @error: (out): set on failure
 *
 * Each pixel becomes what lies at its place in @from, interpolated between the four pixels
 * there; black outside of it, and where the place isn't a number.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_cv_remap (const ClothCvPicture * from, const gfloat * x,
    const gfloat * y, gint width, gint height, guint8 * to, gint to_stride,
    GError ** error)
{
  if (!check_view (from, error)
      || !check_picture (to, width, height, to_stride, error))
    return FALSE;
  return guard (error,[&]{
        const cv::Mat across (height, width, CV_32FC1,
            const_cast < gfloat * >(x));
        const cv::Mat down (height, width, CV_32FC1,
            const_cast < gfloat * >(y));
        cv::Mat made = as_mat (to, width, height, to_stride);

        cv::remap (view (from), made, across, down, cv::INTER_LINEAR,
            cv::BORDER_CONSTANT, cv::Scalar ());
      });
}

/* @from: picture
 * @width: columns of what is made, not more than those of @from
 * @height: rows, not more than those of @from
 * @to: (out caller-allocates): top-left pixel of what is made, outside of @from
 * @to_stride: bytes from one of its rows to the next
 * @error: (out): set on failure
 *
 * Each pixel becomes the mean of the area that it covers in @from. Pixel (x, y) lies at
 * ((x + 1/2)·w - 1/2, (y + 1/2)·h - 1/2) of @from, w and h being the ratios of the sizes.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_cv_squeeze (const ClothCvPicture * from, gint width, gint height,
    guint8 * to, gint to_stride, GError ** error)
{
  if (!check_view (from, error)
      || !check_picture (to, width, height, to_stride, error))
    return FALSE;
  if (width > from->width || height > from->height) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "%d × %d pixels can't be squeezed to %d × %d", from->width,
        from->height, width, height);
    return FALSE;
  }
  return guard (error,[&]{
        cv::Mat made = as_mat (to, width, height, to_stride);

        cv::resize (view (from), made, made.size (), 0, 0, cv::INTER_AREA);
      });
}

/* @from: a picture
 * @to: the next one, of the same size
 * @params: how
 * @n: number of points
 * @points: (array): x, y of each in @from, px, centre of the top-left pixel at 0
 * @moved: (out) (array): where each is in @to
 * @found: (out) (array): whether it was found
 * @error: #ClothCvError
 *
 * Pyramidal flow of Lucas and Kanade (Bouguet 2001).
 *
 * Returns: %FALSE when the pictures or parameters can't be
 */
gboolean
cloth_cv_flow (const ClothCvPicture * from, const ClothCvPicture * to,
    const ClothCvFlowParams * params, guint n, const gfloat * points,
    gfloat * moved, guint8 * found, GError ** error)
{
  if (!check_picture (from->data, from->width, from->height, from->stride,
          error)
      || !check_picture (to->data, to->width, to->height, to->stride, error))
    return FALSE;
  if (from->width != to->width || from->height != to->height) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "pictures of %d × %d and %d × %d pixels are not of one film",
        from->width, from->height, to->width, to->height);
    return FALSE;
  }
  if (params->window < 3 || params->window > 255 || params->levels < 0
      || params->levels > 10) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
        "a window of %d px and %d levels: 3 to 255 and 0 to 10 are possible",
        params->window, params->levels);
    return FALSE;
  }
  if (n == 0)
    return TRUE;
  return guard (error, [&]() {
        cv::Mat a (from->height, from->width, CV_8UC1,
            const_cast < guint8 * >(from->data), from->stride);
        cv::Mat b (to->height, to->width, CV_8UC1,
            const_cast < guint8 * >(to->data), to->stride);
        cv::Mat begin (static_cast < int >(n), 1, CV_32FC2,
            const_cast < gfloat * >(points));
        cv::Mat end, status, unused;

        cv::calcOpticalFlowPyrLK (a, b, begin, end, status, unused,
            cv::Size (params->window, params->window), params->levels);
        memcpy (moved, end.ptr < gfloat > (), 2 * n * sizeof *moved);
        memcpy (found, status.ptr (), n);
      });
}
