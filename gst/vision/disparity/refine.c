/* Disparities from the pictures themselves.
 *
 * Block matching draws disparities towards whole pixels. Here each pixel of the map is looked
 * up where its disparity says that another camera sees it, and the differences e of the two
 * pictures, less their mean over the window, are explained by an error of the disparity: with
 * g, the gradient along the shift,
 *
 *   Δd = Σ w·g·e / (damping + Σ w·g²) ,  w = 1 / (1 + (e / outlier)²)
 *
 * over a window about the pixel and all cameras (B. Lucas and T. Kanade, “An Iterative Image
 * Registration Technique”, 1981). The window is one of windows, so that weights fall off
 * towards its rim: of equal weights some waves would grow from round to round. Each pixel of the window is looked up with the disparity of
 * its own, so that slanted and bent windows fit as well as flat ones (A. Stein et al.,
 * “Attenuating Stereo Pixel-Locking via Affine Window Adaptation”, 2006).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/refine.h"

#include <math.h>
#include <string.h>

#include "gst/vision/disparity/refine-private.h"

/* Columns that one thread sums down together. */
#define COLUMNS 64
/* Rows that one thread sums across together. */
#define ROWS 4

struct _ClothRefine
{
  gint width, height;           /* that there is room for, exactly */
  gfloat *planes;
  gfloat *difference, *gradient;        /* of the view at hand; NaN: none */
  gfloat *mean, *count;
  gfloat *square, *product;     /* Σ w·g², Σ w·g·e */
  gdouble *sums;                /* of each row's windows */

  /* of the run at hand */
  const ClothRefineParams *params;
  const ClothImage *image;
  const ClothRefineView *view;
  ClothDisparityMap *map;
  gint top, bottom;             /* rows that have disparities */
  gint left, right;             /* columns, and those whose windows reach them */
  gfloat *summed;
  const ClothRefineKernel *kernel;
};

/* Returns: windows of 15 × 15 windows of 15 × 15 px, 4 rounds, 20 grey levels, 50 grey levels², half a pixel */
ClothRefineParams
cloth_refine_default_params (void)
{
  return (ClothRefineParams) {
  7, 4, 20, 50, 0.5};
}

/* Returns: (transfer full): memory that is used again for each map of one size */
ClothRefine *
cloth_refine_new (void)
{
  return g_new0 (ClothRefine, 1);
}

/* @self: (nullable) (transfer full): memory
 */
void
cloth_refine_free (ClothRefine * self)
{
  if (!self)
    return;
  g_free (self->planes);
  g_free (self->sums);
  g_free (self);
}

static void
make_room (ClothRefine * self, gint width, gint height)
{
  const gsize n = (gsize) width * (gsize) height;

  if (self->width == width && self->height == height)
    return;
  g_free (self->planes);
  g_free (self->sums);
  self->width = width;
  self->height = height;
  self->planes = g_new0 (gfloat, 6 * n);
  self->difference = self->planes;
  self->gradient = self->planes + n;
  self->mean = self->planes + 2 * n;
  self->count = self->planes + 3 * n;
  self->square = self->planes + 4 * n;
  self->product = self->planes + 5 * n;
  self->sums = g_new (gdouble, n);
}

/* ---- pictures between their pixels ---- */

/* Where a camera sees pixel @p of the map with disparity @d.
 * @at: (out): there
 * @along: (out): by how much that moves for each pixel of disparity */
static inline void
see (const ClothRefineView * view, const gdouble p[2], gdouble d, gdouble at[2],
    gdouble along[2])
{
  const gdouble below = 1 + d * view->forward;
  /* what lies behind it is nowhere */
  const gdouble scale = below > 0 ? 1 / below : NAN;

  for (gint i = 0; i < 2; i++) {
    if (view->forward == 0) {
      at[i] = p[i] + d * view->shift[i];
      along[i] = view->shift[i];
      continue;
    }
    at[i] = view->centre[i]
        + (p[i] - view->centre[i] + d * view->shift[i]) * scale;
    along[i] = (view->shift[i] - (at[i] - view->centre[i]) * view->forward)
        * scale;
  }
}

/* @value: (out): of the picture at (@x, @y)
 * @slope: (out): there, along the shift
 *
 * Returns: whether it is in the picture
 */
static gboolean
look_up (const ClothRefineView * view, gdouble x, gdouble y,
    const gdouble along[2], gdouble * value, gdouble * slope)
{
  const ClothImage *image = &view->image;
  const gdouble left = floor (x), top = floor (y);
  const gboolean is_row = y == top && along[1] == 0;
  gdouble rows[4], slopes[4], down, unused;

  /* also false for what is no number */
  if (!(left >= 1 && left + 2 < image->width && top >= 0
          && y <= image->height - 1))
    return FALSE;
  if (view->shown && !view->shown[(gssize) (y + 0.5) * image->stride
          + (gssize) (x + 0.5)])
    return FALSE;
  for (gint i = 0; i < 4; i++) {
    const gint row = is_row ? (gint) top :
        CLAMP ((gint) top + i - 1, 0, image->height - 1);
    const guint8 *from = image->data + (gssize) row * image->stride
        + (gint) left - 1;
    const gdouble samples[4] = { from[0], from[1], from[2], from[3] };

    rows[i] = cloth_refine_cubic (samples, x - left, &slopes[i]);
    if (is_row) {
      *value = rows[0];
      *slope = along[0] * slopes[0];
      return TRUE;
    }
  }
  *value = cloth_refine_cubic (rows, y - top, &down);
  *slope =
      along[0] * cloth_refine_cubic (slopes, y - top,
      &unused) + along[1] * down;
  return TRUE;
}

/* ---- windows ---- */

/* Four rows at a time: a sum waits for the one before it, those of other rows don't. */
static void
sum_across (gpointer data, guint begin, guint end, guint worker)
{
  ClothRefine *self = data;
  const gint radius = self->params->radius, width = self->width;
  const gint left = self->left, right = self->right;

  for (guint i = begin; i < end; i++) {
    const gint first = self->top + (gint) i * ROWS;
    const gfloat *from[ROWS];
    gdouble *to[ROWS], sum[ROWS] = { 0 };

    for (gint k = 0; k < ROWS; k++) {
      const gsize at = (gsize) MIN (first + k, self->bottom - 1)
          * (gsize) width;

      from[k] = self->summed + at;
      to[k] = self->sums + at;
    }
    for (gint x = left - radius; x < right; x++) {
      if (x + radius < right)
        for (gint k = 0; k < ROWS; k++)
          sum[k] += (gdouble) from[k][x + radius];
      if (x - radius > left)
        for (gint k = 0; k < ROWS; k++)
          sum[k] -= (gdouble) from[k][x - radius - 1];
      if (x >= left)
        for (gint k = 0; k < ROWS; k++)
          to[k][x] = sum[k];
    }
  }
}

static void
sum_down (gpointer data, guint begin, guint end, guint worker)
{
  ClothRefine *self = data;
  const gint radius = self->params->radius, width = self->width;

  for (guint i = begin; i < end; i++) {
    const gint left = self->left + (gint) i * COLUMNS;
    const gint n = MIN (COLUMNS, self->right - left);
    gdouble sum[COLUMNS] = { 0 };

    for (gint y = self->top - radius; y < self->bottom; y++) {
      const gssize at = (gssize) y * width + left, reach = radius * width;

      if (y + radius < self->bottom)
        for (gint x = 0; x < n; x++)
          sum[x] += self->sums[at + reach + x];
      if (y - radius > self->top)
        for (gint x = 0; x < n; x++)
          sum[x] -= self->sums[at - reach - width + x];
      if (y >= self->top)
        for (gint x = 0; x < n; x++)
          self->summed[at + x] = (gfloat) sum[x];
    }
  }
}

/* Each pixel of the plane becomes the sum of its window. */
static void
sum_windows (ClothRefine * self, gfloat * plane, ClothPool * pool)
{
  self->summed = plane;
  cloth_pool_run (pool, sum_across, self,
      (guint) ((self->bottom - self->top + ROWS - 1) / ROWS));
  cloth_pool_run (pool, sum_down, self,
      (guint) ((self->right - self->left + COLUMNS - 1) / COLUMNS));
}

/* ---- a round ---- */

/* Of a view whose rows are those of the map. */
static void
compare_alike (gpointer data, guint begin, guint end, guint worker)
{
  ClothRefine *self = data;
  const ClothDisparityMap *map = self->map;
  const ClothRefineView *view = self->view;

  for (guint i = begin; i < end; i++) {
    const gsize y = (gsize) (self->top + (gint) i);
    const gsize to = y * (gsize) map->width;
    const gsize there = y * (gsize) view->image.stride;
    /* below the other picture nothing is seen */
    const ClothRefineRow row = {
      self->image->data + y * (gsize) self->image->stride,
      view->image.data + there, view->shown ? view->shown + there : NULL,
      (gint) y < view->image.height ? view->image.width : 0, view->shift[0],
      map->disparities + y * (gsize) map->stride,
      map->states + y * (gsize) map->stride, CLOTH_DISPARITY_MEASURED,
      self->count + to, self->gradient + to, self->difference + to
    };

    self->kernel->compare (&row, self->left, self->right);
    memcpy (self->mean + to + self->left, self->difference + to + self->left,
        (gsize) (self->right - self->left) * sizeof (gfloat));
  }
}

static void
compare_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothRefine *self = data;
  const ClothDisparityMap *map = self->map;

  for (guint i = begin; i < end; i++) {
    const gint y = self->top + (gint) i;
    const gsize row = (gsize) y * (gsize) map->stride;
    const gsize to = (gsize) y * (gsize) map->width;

    for (gint x = self->left; x < self->right; x++) {
      const gsize at = to + (gsize) x;
      const gdouble d = (gdouble) map->disparities[row + (gsize) x];
      const gdouble p[2] = { x, y };
      gdouble at_view[2], along[2], value, slope;
      gboolean seen = map->states[row + (gsize) x] >= CLOTH_DISPARITY_MEASURED;

      if (seen) {
        see (self->view, p, d, at_view, along);
        seen = look_up (self->view, at_view[0], at_view[1], along, &value,
            &slope);
      }
      self->count[at] = seen ? 1 : 0;
      self->gradient[at] = seen ? (gfloat) slope : NAN;
      self->mean[at] = self->difference[at] = seen ? (gfloat) (self->image->data
          [(gssize) y * self->image->stride + x] - value) : 0;
    }
  }
}

static void
weigh_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothRefine *self = data;
  const gfloat scale = (gfloat) (1 / (self->params->outlier
          * self->params->outlier));
  const gsize width = (gsize) self->width;

  for (guint i = begin; i < end; i++) {
    const gsize row = (gsize) (self->top + (gint) i) * width;

    for (gsize at = row + (gsize) self->left; at < row + (gsize) self->right;
        at++) {
      const gfloat g = self->gradient[at];
      const gfloat e = self->difference[at] - self->mean[at] / self->count[at];
      const gfloat weighted = g / (1 + e * e * scale);

      if (!isnan (g)) {
        self->square[at] += weighted * g;
        self->product[at] += weighted * e;
      }
    }
  }
}

static void
move_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothRefine *self = data;
  const ClothDisparityMap *map = self->map;
  const gfloat damping = (gfloat) self->params->damping;
  const gfloat most = (gfloat) self->params->most;

  for (guint i = begin; i < end; i++)
    for (gint x = self->left; x < self->right; x++) {
      const gsize y = (gsize) (self->top + (gint) i);
      const gsize at = y * (gsize) map->width + (gsize) x;
      const gsize to = y * (gsize) map->stride + (gsize) x;
      const gfloat below = self->square[at] + damping;
      gfloat by;

      if (map->states[to] < CLOTH_DISPARITY_MEASURED || !(below > 1e-6f))
        continue;
      by = self->product[at] / below;
      map->disparities[to] += CLAMP (by, -most, most);
    }
}

static void
do_round (ClothRefine * self, const ClothRefineView * views, guint n_views,
    ClothPool * pool)
{
  const gsize begin = (gsize) self->top * (gsize) self->width;
  const gsize size = (gsize) (self->bottom - self->top) * (gsize) self->width
      * sizeof (gfloat);
  const guint n = (guint) (self->bottom - self->top);

  memset (self->square + begin, 0, size);
  memset (self->product + begin, 0, size);
  for (guint k = 0; k < n_views; k++) {
    self->view = &views[k];
    cloth_pool_run (pool, views[k].forward == 0 && views[k].shift[1] == 0 ?
        compare_alike : compare_rows, self, n);
    sum_windows (self, self->mean, pool);
    sum_windows (self, self->count, pool);
    cloth_pool_run (pool, weigh_rows, self, n);
  }
  for (gint i = 0; i < 2; i++) {
    sum_windows (self, self->square, pool);
    sum_windows (self, self->product, pool);
  }
  cloth_pool_run (pool, move_rows, self, n);
}

/* ---- what can be ---- */

static gboolean
check_params (const ClothRefineParams * p, const ClothRefineView * views,
    guint n_views, GError ** error)
{
  if (n_views < 1 || n_views > CLOTH_REFINE_MAX_VIEWS || p->radius < 1
      || p->radius > 64 || p->rounds > 100 || !(p->outlier >= 1e-3
          && p->outlier <= 1e6) || !(p->damping >= 0 && p->damping <= 1e9)
      || !(p->most >= 0 && p->most <= 4)) {
    g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_PARAMETER,
        "%u views, radius %d, %u rounds, outlier %g, damping %g, most %g: make "
        "them 1 to %d, 1 to 64, 0 to 100, 0.001 to 1e6, 0 to 1e9, 0 to 4",
        n_views, p->radius, p->rounds, p->outlier, p->damping, p->most,
        CLOTH_REFINE_MAX_VIEWS);
    return FALSE;
  }
  for (guint k = 0; k < n_views; k++)
    if (!isfinite (views[k].shift[0]) || !isfinite (views[k].shift[1])
        || !isfinite (views[k].forward) || !isfinite (views[k].centre[0])
        || !isfinite (views[k].centre[1])) {
      g_set_error (error, CLOTH_DISPARITY_ERROR,
          CLOTH_DISPARITY_ERROR_PARAMETER, "The shift of view %u is no number",
          k);
      return FALSE;
    }
  return TRUE;
}

static gboolean
check_pictures (const ClothImage * image, const ClothRefineView * views,
    guint n_views, const ClothDisparityMap * map, GError ** error)
{
  if (!cloth_disparity_check_size (map->width, map->height, map->stride, error)
      || !cloth_disparity_check_size (image->width, image->height,
          image->stride, error))
    return FALSE;
  for (guint k = 0; k < n_views; k++)
    if (!cloth_disparity_check_size (views[k].image.width,
            views[k].image.height, views[k].image.stride, error))
      return FALSE;
  if (image->width == map->width && image->height == map->height)
    return TRUE;
  g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP,
      "A picture of %d × %d pixels and a map of %d × %d: make them alike",
      image->width, image->height, map->width, map->height);
  return FALSE;
}

/* The rows that have disparities, and the columns up to which their windows reach. */
static void
find_bounds (ClothRefine * self)
{
  const ClothDisparityMap *map = self->map;
  const gint radius = self->params->radius;

  self->top = map->height;
  self->left = map->width;
  self->bottom = self->right = 0;
  for (gint y = 0; y < map->height; y++) {
    const guint8 *row = map->states + (gsize) y * (gsize) map->stride;
    gint first = 0, last = map->width;

    while (first < last && row[first] < CLOTH_DISPARITY_MEASURED)
      first++;
    if (first == last)
      continue;
    while (row[last - 1] < CLOTH_DISPARITY_MEASURED)
      last--;
    self->top = MIN (self->top, y);
    self->bottom = y + 1;
    self->left = MIN (self->left, first);
    self->right = MAX (self->right, last);
  }
  self->left = MAX (self->left - radius, 0);
  self->right = MIN (self->right + radius, map->width);
}

/* @self: memory
 * @params: how
 * @image: the picture whose pixels the map has
 * @views: (array length=n_views): the other cameras
 * @n_views: 1 to %CLOTH_REFINE_MAX_VIEWS
 * @map: (inout): disparities, less than about a pixel off and without stairs, which windows
 *   average away; measured and filled ones are moved
 * @pool: (nullable): threads
 * @error: (out): set on failure
 *
 * In the film of a rendered cloth (18 mm a pixel) the RMS after cloth_disparity_smooth ()
 * falls from 3.4 to 2.1 mm. More rounds make it worse: where the print is weak noise grows.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_refine_run (ClothRefine * self, const ClothRefineParams * params,
    const ClothImage * image, const ClothRefineView * views, guint n_views,
    ClothDisparityMap * map, ClothPool * pool, GError ** error)
{
  if (!check_params (params, views, n_views, error)
      || !check_pictures (image, views, n_views, map, error))
    return FALSE;
  make_room (self, map->width, map->height);
  self->params = params;
  self->image = image;
  self->map = map;
  self->kernel = CLOTH_SIMD_TABLE (cloth_refine_kernel, CLOTH_SIMD_BEST);
  find_bounds (self);
  for (guint i = 0; i < params->rounds && self->top < self->bottom; i++)
    do_round (self, views, n_views, pool);
  return TRUE;
}
