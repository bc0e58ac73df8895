/* From the pictures of a stereo head to disparities on the pixels of its first camera.
 *
 * Each partner makes a pair with the first camera; its two pictures are rectified and matched
 * both ways. The disparities of all pairs are merged in the first pair's left picture, holes
 * filled, the surface smoothed (D. Pritchard and W. Heidrich, “Cloth Motion Capture”, 2003,
 * section 3), refined by all pictures, and looked up for each pixel as filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/stereo/stereo.h"

#include <math.h>
#include <string.h>

#include "gst/cv/cv.h"
#include "gst/math/statistics.h"
#include "gst/rig/rectify.h"

#define MAX_PAIRS (CLOTH_STEREO_MAX_CAMERAS - 1)
/* Pictures that are rectified for one set: two a pair, and those of the second pair's partner
 * and of the masks. */
#define MAX_WARPS (4 * CLOTH_STEREO_MAX_CAMERAS)
/* Pixels around a pixel that cubic interpolation needs. */
#define AROUND 2
/* Differences from left to right and back that are counted, sixteenths. */
#define MOST_DIFFERENCE 64
/* Of what is thought of a mask that was resampled. */
#define HALF 128

/* A picture that is rectified again for each set.
 * @from: camera; @is_mask: its mask instead
 * @x, @y: the map
 * @shown: bytes: whether the place lies in the picture */
typedef struct
{
  guint from;
  gboolean is_mask;
  gint width, height;
  gfloat *x, *y;
  guint8 *picture, *shown;
} Warp;

/* @head, @partner, @mask: warps
 * @refined: the partner's picture, turned as the first pair's are
 * @inside: what that shows, without its rim
 * @whole: where a block of the partner's matched picture is shown whole */
typedef struct
{
  ClothRectification frame;
  guint head, partner, mask;
  ClothRefineView refined;
  gdouble place[9], unit[3];
  gdouble least, most;          /* disparities of far and near */
  ClothCvStereo *matcher[2];
  guint8 *mirrored[2];
  gint16 *found[2];
  guint8 *inside, *whole;
} Pair;

struct _ClothStereo
{
  ClothStereoParams params;
  guint n_cameras, n_pairs, n_warps;
  gint widths[CLOTH_STEREO_MAX_CAMERAS], heights[CLOTH_STEREO_MAX_CAMERAS];
  Pair pairs[MAX_PAIRS];
  Warp warps[MAX_WARPS];
  ClothDisparity *surface;
  ClothRefine *refine;
  ClothDisparityMap base;       /* on the first pair's left picture */
  ClothDisparityMap filmed;
  gfloat *rays, *x, *y;         /* of each filmed pixel */

  /* of the run at hand */
  const ClothImage *images, *mask;
  GError *errors[MAX (MAX_WARPS, 2 * MAX_PAIRS)];
};

/* Returns: 1 to 3 m; blocks of 11 × 11 pixels, penalties 8 and 32 a pixel of them, 10%
 *   uniqueness, pieces of 100 px, 1 px from left to right and back, 0.7 px between baselines;
 *   sixteenths smoothed within 0.3 px, which narrow to 0.7, and refined ones within 0.02 px
 */
ClothStereoParams
cloth_stereo_default_params (void)
{
  ClothStereoParams params = { 1, 3, 11, 8, 32, 10, 100, 1, 0.7,
    cloth_disparity_default_params (), cloth_refine_default_params (), 0.02
  };

  params.surface.half_width = 0.3;
  params.surface.narrowing = 0.7;
  return params;
}

/* ---- what stays ---- */

static guint
add_warp (ClothStereo * self, guint from, gboolean is_mask,
    const ClothRectification * frame, const ClothCamera * camera,
    const gdouble rotation[9])
{
  const gsize n = (gsize) frame->width * (gsize) frame->height;
  Warp *warp = &self->warps[self->n_warps];

  warp->from = from;
  warp->is_mask = is_mask;
  warp->width = frame->width;
  warp->height = frame->height;
  warp->x = g_new (gfloat, n);
  warp->y = g_new (gfloat, n);
  warp->picture = g_malloc (n);
  warp->shown = g_malloc (n);
  cloth_rectify_map (frame, camera, rotation, warp->x, warp->y);
  for (gsize i = 0; i < n; i++)
    warp->shown[i] = !isnan (warp->x[i]);
  return self->n_warps++;
}

/* The mask of a head's picture needs no map of its own. */
static guint
add_mask (ClothStereo * self, guint head)
{
  Warp *warp = &self->warps[self->n_warps];

  *warp = self->warps[head];
  warp->is_mask = TRUE;
  warp->picture = g_malloc ((gsize) warp->width * (gsize) warp->height);
  return self->n_warps++;
}

/* Returns: (transfer full): @shown without what is near to what isn't shown */
static guint8 *
shrink (const guint8 * shown, gint width, gint height, gint by)
{
  g_autofree guint8 *across = g_malloc ((gsize) width * (gsize) height);
  guint8 *inside = g_malloc ((gsize) width * (gsize) height);

  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      guint8 all = x >= by && x + by < width;

      for (gint i = -by; i <= by && all; i++)
        all = shown[y * width + x + i];
      across[y * width + x] = all;
    }
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      guint8 all = y >= by && y + by < height;

      for (gint i = -by; i <= by && all; i++)
        all = across[(y + i) * width + x];
      inside[y * width + x] = all;
    }
  return inside;
}

static gboolean
add_matchers (Pair * pair, const ClothStereoParams * params, GError ** error)
{
  const ClothRectification *frame = &pair->frame;
  const gsize n = (gsize) frame->width * (gsize) frame->height;
  ClothCvStereoParams matching = cloth_cv_stereo_default_params ();

  matching.least = frame->least;
  matching.range = frame->range;
  matching.window = params->window;
  matching.small_step = params->small_step * params->window * params->window;
  matching.large_step = params->large_step * params->window * params->window;
  matching.left_right = (gint) ceil (params->left_right);
  matching.uniqueness = params->uniqueness;
  matching.speckle_area = params->speckle;
  for (guint i = 0; i < 2; i++) {
    pair->matcher[i] = cloth_cv_stereo_new (&matching, error);
    if (!pair->matcher[i])
      return FALSE;
    pair->mirrored[i] = g_malloc (n);
    pair->found[i] = g_new (gint16, n);
  }
  return TRUE;
}

static gboolean
add_pair (ClothStereo * self, const ClothCamera * const *cameras, guint k,
    GError ** error)
{
  const ClothStereoParams *params = &self->params;
  Pair *pair = &self->pairs[k];
  const ClothRectification *base = &self->pairs[0].frame;
  const ClothCamera *partner = cameras[k + 1];
  ClothRectification *frame = &pair->frame;
  gdouble rotation[9];
  Warp *warp;

  if (!cloth_rectify_pair (cameras[0], partner, params->near, params->far,
          frame, error))
    return FALSE;
  if ((gint64) frame->width * frame->height > CLOTH_DISPARITY_MAX_AREA) {
    g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP,
        "Rectified pictures would have %d × %d pixels: film with fewer, or "
        "raise near", frame->width, frame->height);
    return FALSE;
  }
  self->n_pairs++;
  pair->least = frame->focal * frame->baseline / params->far;
  pair->most = frame->focal * frame->baseline / params->near;
  pair->head = add_warp (self, 0, FALSE, frame, cameras[0], frame->head);
  pair->partner = add_warp (self, k + 1, FALSE, frame, partner, frame->partner);
  pair->mask = add_mask (self, pair->head);
  warp = &self->warps[pair->partner];
  pair->whole = shrink (warp->shown, warp->width, warp->height,
      params->window / 2);
  cloth_rectify_relate (base, frame, pair->place, pair->unit);
  cloth_rectify_view (base, cameras[0], partner, rotation,
      pair->refined.shift, &pair->refined.forward);
  /* the first pair's is that of matching already */
  warp = &self->warps[k == 0 ? pair->partner :
      add_warp (self, k + 1, FALSE, base, partner, rotation)];
  pair->inside = shrink (warp->shown, warp->width, warp->height, AROUND);
  pair->refined.image = (ClothImage) {
  warp->picture, warp->width, warp->height, warp->width};
  pair->refined.shown = pair->inside;
  memcpy (pair->refined.centre, base->centre, sizeof (base->centre));
  return add_matchers (pair, params, error);
}

static gboolean
check_params (const ClothStereoParams * p, guint n_cameras, GError ** error)
{
  if (n_cameras < 2 || n_cameras > CLOTH_STEREO_MAX_CAMERAS) {
    g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_PARAMETER,
        "%u cameras: a stereo head has 2 to %d", n_cameras,
        CLOTH_STEREO_MAX_CAMERAS);
    return FALSE;
  }
  if (!(p->left_right >= 0 && p->left_right <= 16) || !(p->agree > 0)
      || p->small_step < 0 || p->large_step <= p->small_step
      || p->large_step > 100 || !(p->settle >= 0 && p->settle <= 64)) {
    g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_PARAMETER,
        "left-right %g, agree %g, small-step %d, large-step %d, settle %g: make "
        "them 0 to 16, above 0, 0 or more, above small-step and up to 100, 0 to "
        "64", p->left_right, p->agree, p->small_step, p->large_step, p->settle);
    return FALSE;
  }
  return TRUE;
}

static ClothDisparityMap
make_map (gint width, gint height)
{
  const gsize n = (gsize) width * (gsize) height;

  return (ClothDisparityMap) {
  g_new (gfloat, n), g_malloc (n), width, height, width};
}

/* @cameras: (array length=n_cameras): the one whose pixels shall have disparities, and its
 *   partners
 * @n_cameras: 2 or 3
 * @params: how
 * @error: (out): set on failure
 *
 * Returns: (transfer full): a head, with all memory that it needs, for one thread at a time;
 *   %NULL when the cameras can't be one
 */
ClothStereo *
cloth_stereo_new (const ClothCamera * const *cameras, guint n_cameras,
    const ClothStereoParams * params, GError ** error)
{
  g_autoptr (ClothStereo) self = g_new0 (ClothStereo, 1);
  gsize n;

  if (!check_params (params, n_cameras, error))
    return NULL;
  self->params = *params;
  self->n_cameras = n_cameras;
  for (guint i = 0; i < n_cameras; i++) {
    self->widths[i] = cameras[i]->width;
    self->heights[i] = cameras[i]->height;
  }
  for (guint k = 0; k + 1 < n_cameras; k++)
    if (!add_pair (self, cameras, k, error))
      return NULL;
  self->surface = cloth_disparity_new ();
  self->refine = cloth_refine_new ();
  self->base = make_map (self->pairs[0].frame.width,
      self->pairs[0].frame.height);
  self->filmed = make_map (cameras[0]->width, cameras[0]->height);
  n = (gsize) cameras[0]->width * (gsize) cameras[0]->height;
  self->rays = g_new (gfloat, 2 * n);
  self->x = g_new (gfloat, n);
  self->y = g_new (gfloat, n);
  cloth_rectify_rays (cameras[0], self->rays);
  cloth_rectify_places (&self->pairs[0].frame, self->rays, n, self->x, self->y);
  return g_steal_pointer (&self);
}

/* @self: (nullable) (transfer full): a head
 */
void
cloth_stereo_free (ClothStereo * self)
{
  if (!self)
    return;
  for (guint i = 0; i < self->n_warps; i++) {
    g_free (self->warps[i].picture);
    if (self->warps[i].is_mask)
      continue;
    g_free (self->warps[i].x);
    g_free (self->warps[i].y);
    g_free (self->warps[i].shown);
  }
  for (guint k = 0; k < self->n_pairs; k++) {
    g_free (self->pairs[k].inside);
    g_free (self->pairs[k].whole);
    for (guint i = 0; i < 2; i++) {
      cloth_cv_stereo_free (self->pairs[k].matcher[i]);
      g_free (self->pairs[k].mirrored[i]);
      g_free (self->pairs[k].found[i]);
    }
  }
  cloth_disparity_free (self->surface);
  cloth_refine_free (self->refine);
  g_free (self->base.disparities);
  g_free (self->base.states);
  g_free (self->filmed.disparities);
  g_free (self->filmed.states);
  g_free (self->rays);
  g_free (self->x);
  g_free (self->y);
  g_free (self);
}

/* Returns: what turns disparities into points; valid as long as the head is */
ClothStereoGeometry
cloth_stereo_get_geometry (const ClothStereo * self)
{
  const ClothRectification *base = &self->pairs[0].frame;
  ClothStereoGeometry geometry = { self->filmed.width, self->filmed.height,
    self->rays, {base->head[6], base->head[7], base->head[8]},
    base->focal * base->baseline
  };

  return geometry;
}

/* ---- one set of pictures ---- */

static void
do_warps (gpointer data, guint begin, guint end, guint worker)
{
  ClothStereo *self = data;

  for (guint i = begin; i < end; i++) {
    Warp *warp = &self->warps[i];
    const ClothImage *image = warp->is_mask ? self->mask :
        &self->images[warp->from];
    ClothCvPicture from;

    if (!image)
      continue;
    from = (ClothCvPicture) {
    image->data, image->width, image->height, image->stride};
    cloth_cv_remap (&from, warp->x, warp->y, warp->width, warp->height,
        warp->picture, warp->width, &self->errors[i]);
  }
}

static void
mirror (const guint8 * from, gint width, gint height, guint8 * to)
{
  for (gint y = 0; y < height; y++, from += width, to += width)
    for (gint x = 0; x < width; x++)
      to[x] = from[width - 1 - x];
}

/* From left to right, and from right to left: of the pictures mirrored and swapped. */
static void
do_matches (gpointer data, guint begin, guint end, guint worker)
{
  ClothStereo *self = data;

  for (guint i = begin; i < end; i++) {
    Pair *pair = &self->pairs[i / 2];
    const gint w = pair->frame.width, h = pair->frame.height;
    const guint8 *left = self->warps[pair->head].picture;
    const guint8 *right = self->warps[pair->partner].picture;
    ClothCvPicture pictures[2] = { {left, w, h, w}, {right, w, h, w} };

    if (i % 2) {
      mirror (right, w, h, pair->mirrored[0]);
      mirror (left, w, h, pair->mirrored[1]);
      pictures[0].data = pair->mirrored[0];
      pictures[1].data = pair->mirrored[1];
    }
    cloth_cv_stereo_run (pair->matcher[i % 2], &pictures[0], &pictures[1],
        pair->found[i % 2], &self->errors[i]);
  }
}

/* Hands on the first error of the jobs that were done side by side. */
static gboolean
succeeded (ClothStereo * self, GError ** error)
{
  gboolean good = TRUE;

  for (guint i = 0; i < G_N_ELEMENTS (self->errors); i++) {
    if (self->errors[i] && good) {
      g_propagate_error (error, g_steal_pointer (&self->errors[i]));
      good = FALSE;
    }
    g_clear_error (&self->errors[i]);
  }
  return good;
}

/* Drops what lies beside the cloth's mask or its picture, and what was compared with more than
 * the partner's picture shows. */
static void
confine (ClothStereo * self, Pair * pair)
{
  const Warp *head = &self->warps[pair->head];
  const guint8 *mask = self->mask ? self->warps[pair->mask].picture : NULL;
  const gint width = pair->frame.width;

  for (gint y = 0; y < pair->frame.height; y++)
    for (gint x = 0; x < width; x++) {
      const gsize row = (gsize) y * (gsize) width, at = row + (gsize) x;
      gint16 *d = &pair->found[0][at];
      const gint to = x - ((*d + CLOTH_CV_STEPS / 2) >> 4);

      if (*d == CLOTH_CV_NO_DISPARITY)
        continue;
      if (!head->shown[at] || (mask && mask[at] < HALF) || to < 0
          || to >= width || !pair->whole[row + (gsize) to])
        *d = CLOTH_CV_NO_DISPARITY;
    }
}

/* Returns: the standard deviation of a disparity, px, by those from left to right and back:
 * the difference of two that are equally good is √2 times as wide. NaN: there are none */
static gdouble
find_sigma (const Pair * pair)
{
  const gint width = pair->frame.width;
  guint counts[MOST_DIFFERENCE + 1] = { 0 };
  guint n = 0, below = 0, bin = 0;

  for (gint y = 0; y < pair->frame.height; y++)
    for (gint x = 0; x < width; x++) {
      const gsize row = (gsize) y * (gsize) width;
      const gint16 d = pair->found[0][row + (gsize) x];
      gint16 back;
      gint difference;

      if (d == CLOTH_CV_NO_DISPARITY)
        continue;
      /* inside of the picture, since confine () was there */
      back = pair->found[1][row + (gsize) (width - 1 - x
              + ((d + CLOTH_CV_STEPS / 2) >> 4))];
      difference = ABS (d - back);
      if (back == CLOTH_CV_NO_DISPARITY || difference > MOST_DIFFERENCE)
        continue;
      counts[difference]++;
      n++;
    }
  if (n == 0)
    return NAN;
  while (2 * (below + counts[bin]) < n)
    below += counts[bin++];
  /* the bin of 0 is half as wide as the others */
  return CLOTH_MEDIAN_TO_SIGMA / G_SQRT2 / CLOTH_CV_STEPS * fmax (0,
      (bin == 0 ? 0 : bin - 0.5) + (bin ==
          0 ? 0.5 : 1) * (0.5 * n - below) / counts[bin]);
}

/* How much lies at the ends of the range; what lies beyond them is dropped. Without a mask what
 * lies behind it need not be cloth. */
static gboolean
cut_at_border (ClothStereo * self, Pair * pair, ClothStereoBorder * border,
    GError ** error)
{
  const gsize size = (gsize) pair->frame.width * (gsize) pair->frame.height;
  const ClothDisparityPair all = cloth_disparity_pair (pair->found[0],
      pair->frame.width, pair->frame.height);
  ClothDisparityBorder ends;

  if (!cloth_disparity_border (&all, pair->least, pair->most, &ends, error))
    return FALSE;
  for (gsize i = 0; i < size; i++) {
    gint16 *d = &pair->found[0][i];

    if (*d < CLOTH_CV_STEPS * pair->least || *d > CLOTH_CV_STEPS * pair->most)
      *d = CLOTH_CV_NO_DISPARITY;
  }
  *border = (ClothStereoBorder) {
    ends.most, self->mask ? ends.least : 0, 1 / fmax (1,
        pair->most - pair->least)
  };
  return TRUE;
}

static gboolean
do_checks (ClothStereo * self, ClothStereoResult * result, GError ** error)
{
  const gint most = (gint) rint (self->params.left_right * CLOTH_CV_STEPS);

  for (guint k = 0; k < self->n_pairs; k++) {
    Pair *pair = &self->pairs[k];

    confine (self, pair);
    if (k == 0)
      result->sigma = find_sigma (pair);
    if (!cloth_disparity_check (pair->found[0], pair->found[1],
            pair->frame.width, pair->frame.height, CLOTH_CV_NO_DISPARITY, most,
            error)
        || !cut_at_border (self, pair, &result->border[k], error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
merge (ClothStereo * self, ClothPool * pool, GError ** error)
{
  const Warp *head = &self->warps[self->pairs[0].head];
  const guint8 *mask = self->mask ?
      self->warps[self->pairs[0].mask].picture : NULL;
  const gsize n = (gsize) self->base.width * (gsize) self->base.height;
  ClothDisparityPair pairs[MAX_PAIRS];

  for (gsize i = 0; i < n; i++)
    self->base.states[i] = head->shown[i] && (!mask || mask[i] >= HALF) ?
        CLOTH_DISPARITY_MEASURED : CLOTH_DISPARITY_OUTSIDE;
  for (guint k = 0; k < self->n_pairs; k++) {
    const Pair *pair = &self->pairs[k];

    pairs[k] = cloth_disparity_pair (pair->found[0], pair->frame.width,
        pair->frame.height);
    memcpy (pairs[k].place, pair->place, sizeof (pair->place));
    memcpy (pairs[k].unit, pair->unit, sizeof (pair->unit));
  }
  return cloth_disparity_merge (pairs, self->n_pairs, self->params.agree,
      &self->base, pool, error);
}

/* Holes, fractions, and what the pictures themselves say. */
static gboolean
better (ClothStereo * self, ClothPool * pool, GError ** error)
{
  const Warp *head = &self->warps[self->pairs[0].head];
  const ClothImage image = { head->picture, head->width, head->height,
    head->width
  };
  ClothDisparityParams settle = self->params.surface;
  ClothRefineView views[MAX_PAIRS];

  for (guint k = 0; k < self->n_pairs; k++)
    views[k] = self->pairs[k].refined;
  settle.half_width = self->params.settle;
  settle.narrowing = 1;
  return cloth_disparity_fill (self->surface, &self->params.surface,
      &self->base, pool, CLOTH_SIMD_BEST, error)
      && cloth_disparity_smooth (self->surface, &self->params.surface,
      &self->base, pool, CLOTH_SIMD_BEST, error)
      && cloth_refine_run (self->refine, &self->params.refine, &image, views,
      self->n_pairs, &self->base, pool, error)
      && cloth_disparity_smooth (self->surface, &settle, &self->base, pool,
      CLOTH_SIMD_BEST, error);
}

/* ---- the pixels as filmed ---- */

/* The disparity between four pixels of one surface; of the nearest pixel where they aren't.
 * Returns: that one's state */
static guint8
look_up (const ClothStereo * self, gfloat x, gfloat y, gfloat * disparity)
{
  const ClothDisparityMap *map = &self->base;
  const gfloat step = (gfloat) self->params.surface.step;
  gfloat here, sum = 0, u, v;
  gint left, top;
  gsize at;

  *disparity = NAN;
  /* also true for what is no number */
  if (!(x > -0.5f && y > -0.5f && x < (gfloat) map->width - 0.5f
          && y < (gfloat) map->height - 0.5f))
    return CLOTH_DISPARITY_OUTSIDE;
  at = (gsize) floorf (y + 0.5f) * (gsize) map->stride
      + (gsize) floorf (x + 0.5f);
  if (map->states[at] < CLOTH_DISPARITY_MEASURED)
    return map->states[at];
  here = *disparity = map->disparities[at];
  left = CLAMP ((gint) floorf (x), 0, map->width - 2);
  top = CLAMP ((gint) floorf (y), 0, map->height - 2);
  u = x - (gfloat) left;
  v = y - (gfloat) top;
  for (gint i = 0; i < 4; i++) {
    const gsize corner = (gsize) (top + (i >> 1)) * (gsize) map->stride
        + (gsize) (left + (i & 1));
    const gfloat d = map->disparities[corner];

    if (map->states[corner] < CLOTH_DISPARITY_MEASURED
        || !(fabsf (d - here) <= step))
      return map->states[at];
    sum += (i & 1 ? u : 1 - u) * (i >> 1 ? v : 1 - v) * d;
  }
  *disparity = sum;
  return map->states[at];
}

static void
do_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothStereo *self = data;
  const ClothImage *mask = self->mask;

  for (guint y = begin; y < end; y++)
    for (gint x = 0; x < self->filmed.width; x++) {
      const gsize at = (gsize) y * (gsize) self->filmed.width + (gsize) x;
      const gboolean cloth = !mask || mask->data[(gssize) y * mask->stride + x];
      gfloat d = NAN;
      guint8 state = CLOTH_DISPARITY_OUTSIDE;

      if (cloth) {
        state = look_up (self, self->x[at], self->y[at], &d);
        /* without a mask cloth is what has a disparity in range */
        if (state < CLOTH_DISPARITY_MEASURED)
          state = mask ? CLOTH_DISPARITY_HOLE : CLOTH_DISPARITY_OUTSIDE;
      }
      self->filmed.disparities[at] = d;
      self->filmed.states[at] = state;
    }
}

static gboolean
check_images (const ClothStereo * self, const ClothImage * images,
    const ClothImage * mask, GError ** error)
{
  for (guint i = 0; i < self->n_cameras + !!mask; i++) {
    const ClothImage *image = i < self->n_cameras ? &images[i] : mask;
    const guint of = i < self->n_cameras ? i : 0;

    if (image->width == self->widths[of] && image->height == self->heights[of]
        && image->stride >= image->width)
      continue;
    g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP,
        "A picture of %d × %d pixels with rows of %d bytes, of a camera that was "
        "calibrated at %d × %d: film at that size", image->width,
        image->height, image->stride, self->widths[of], self->heights[of]);
    return FALSE;
  }
  return TRUE;
}

/* @self: a head
 * @images: (array): the cameras' pictures of one instant, in the order and the sizes that
 *   they were given in
 * @mask: (nullable): of the first picture's size: 255 where the cloth is, else 0. Without one it
 *   is all that has a disparity in range
 * @pool: (nullable): threads
 * @result: (out caller-allocates): what was found
 * @error: (out): set on failure
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_stereo_run (ClothStereo * self, const ClothImage * images,
    const ClothImage * mask, ClothPool * pool, ClothStereoResult * result,
    GError ** error)
{
  const gsize n = (gsize) self->filmed.width * (gsize) self->filmed.height;

  memset (result, 0, sizeof (*result));
  result->map = self->filmed;
  result->sigma = NAN;
  if (!check_images (self, images, mask, error))
    return FALSE;
  self->images = images;
  self->mask = mask;
  cloth_pool_run_one_by_one (pool, do_warps, self, self->n_warps);
  if (!succeeded (self, error))
    return FALSE;
  cloth_pool_run_one_by_one (pool, do_matches, self, 2 * self->n_pairs);
  if (!succeeded (self, error) || !do_checks (self, result, error)
      || !merge (self, pool, error) || !better (self, pool, error))
    return FALSE;
  cloth_pool_run (pool, do_rows, self, (guint) self->filmed.height);
  for (gsize i = 0; i < n; i++) {
    result->n_mask += !mask
        || self->filmed.states[i] != CLOTH_DISPARITY_OUTSIDE;
    result->n_measured += self->filmed.states[i] == CLOTH_DISPARITY_MEASURED;
  }
  return TRUE;
}
