/* The outline of one square, completed from some of its corners.
 *
 * Missing corners are found by following edges from those that are there; every edge must
 * then lead from one corner to the next. Squares may be bent and seen obliquely.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/outline.h"

#include <math.h>

#include "gst/vision/corner/corner.h"
#include "gst/vision/corner/edge.h"

/* Radius of the window a corner is fitted in, over the square's shortest edge. */
#define WINDOW 0.42f
/* Contrast of a corner over that of the one it was reached from. */
#define MIN_CONTRAST 0.4f
/* Sine of the angle between a corner's edges: blunter ones are no corners. */
#define MIN_SINE 0.5f
/* Residual of a saddle's fit over its contrast: where more is left, something else than four
 * squares meets there. */
#define MAX_RESIDUAL 0.12f
/* A fit moves the end of an edge by no more than this, px. */
#define MAX_SHIFT 2.5f
/* An edge arrives at a corner when it ends this near, px and share of its length. */
#define ARRIVES 1.5f
#define ARRIVES_SHARE 0.06f
/* Longest edge over what is guessed. */
#define LONGEST 2.0f
/* The shorter of two opposite edges over the longer. */
#define MIN_RATIO 0.4f

typedef struct
{
  gint state;                   /* 0: not looked at, 1: found, -1: none */
  gfloat rays[2];
  gfloat contrast;
} Wedge;

static gfloat
edge_length (const ClothOutline * outline, gint k)
{
  gint to = (k + 1) & 3;

  return hypotf (outline->x[to] - outline->x[k],
      outline->y[to] - outline->y[k]);
}

static gfloat
window_radius (const ClothOutline * outline)
{
  gfloat least = G_MAXFLOAT;

  for (gint k = 0; k < 4; k++)
    least = MIN (least, edge_length (outline, k));
  return CLAMP (WINDOW * least, 2.0f, 7.0f);
}

/* The way from (@x, @y) to the square's middle. */
static gfloat
inwards (const ClothOutline * outline, gfloat x, gfloat y)
{
  gfloat cx = 0, cy = 0;

  for (gint k = 0; k < 4; k++) {
    cx += outline->x[k] / 4;
    cy += outline->y[k] / 4;
  }
  return atan2f (cy - y, cx - x);
}

static gboolean
fit_within (ClothOutline * outline, const ClothImage * image, gint corner,
    gfloat x, gfloat y, gfloat radius, gfloat max_shift, gfloat contrast,
    gboolean black)
{
  ClothCornerParams params = cloth_corner_default_params ();
  ClothCornerFit found;
  gfloat unused;

  params.radius = radius;
  params.max_shift = max_shift;
  params.linear_light = TRUE;
  params.known_angles = cloth_edge_wedge (image, x, y, params.radius, black,
      inwards (outline, x, y), params.theta, &unused);
  if (!cloth_corner_refine (image, x, y, &params, CLOTH_SIMD_BEST, &found)
      || found.contrast < MIN_CONTRAST * contrast
      || fabsf (sinf (found.theta[1] - found.theta[0])) < MIN_SINE)
    return FALSE;
  outline->x[corner] = found.x;
  outline->y[corner] = found.y;
  for (gint m = 0; m < 3; m++)
    outline->cov[corner][m] = found.cov[m];
  outline->saddle[corner] = cloth_corner_is_saddle (&found);
  outline->sure[corner] = found.rms < MAX_RESIDUAL * found.contrast;
  outline->have[corner] = TRUE;
  return TRUE;
}

static gboolean
fit (ClothOutline * outline, const ClothImage * image, gint corner, gfloat x,
    gfloat y, gfloat max_shift, gfloat contrast, gboolean black)
{
  gfloat radius = window_radius (outline);

  /* A large window may reach beyond the cloth's edge; a small one is less exact. */
  return fit_within (outline, image, corner, x, y, radius, max_shift, contrast,
      black) || (outline->thorough && radius > 4
      && fit_within (outline, image, corner, x, y, 0.6f * radius, max_shift,
          contrast, black));
}

/* @outline: the outline
 * @image: the picture
 * @corner: which corner
 * @x: where it lies, roughly, px
 * @y: likewise
 * @max_shift: how far the fit may move it, px
 * @black: colour of the square
 *
 * Fits one corner to sub-pixel accuracy and takes it into the outline.
 *
 * Returns: whether there is a corner
 */
gboolean
cloth_outline_fit (ClothOutline * outline, const ClothImage * image,
    gint corner, gfloat x, gfloat y, gfloat max_shift, gboolean black)
{
  return fit (outline, image, corner, x, y, max_shift, 0, black);
}

/* Follows the edge from corner @from to its neighbour @to. */
static gboolean
follow (const ClothOutline * outline, const ClothImage * image,
    gboolean black, Wedge wedges[4], gint from, gint to, gfloat * x, gfloat * y)
{
  Wedge *wedge = &wedges[from];
  gboolean forwards = to == ((from + 1) & 3);
  gfloat longest = 0, arrives;

  if (!wedge->state)
    wedge->state = cloth_edge_wedge (image, outline->x[from],
        outline->y[from], window_radius (outline), black,
        inwards (outline, outline->x[from], outline->y[from]), wedge->rays,
        &wedge->contrast) ? 1 : -1;
  if (wedge->state < 0)
    return FALSE;
  for (gint k = 0; k < 4; k++)
    longest = MAX (longest, edge_length (outline, k));
  /* Forwards, the square lies on the side of a turn from x towards y. */
  return cloth_edge_walk (image, outline->x[from], outline->y[from],
      wedge->rays[forwards ? 0 : 1], forwards == black, wedge->contrast,
      LONGEST * longest, x, y, &arrives);
}

/* Convex, turning from x towards y, with opposite edges of like length. */
static gboolean
is_plausible (const ClothOutline * outline)
{
  const gfloat *x = outline->x, *y = outline->y;
  gfloat length[4];

  for (gint k = 0; k < 4; k++) {
    gint b = (k + 1) & 3, c = (k + 2) & 3;

    length[k] = edge_length (outline, k);
    if (!((x[b] - x[k]) * (y[c] - y[b]) - (y[b] - y[k]) * (x[c] - x[b]) > 0))
      return FALSE;
  }
  for (gint k = 0; k < 2; k++)
    if (MIN (length[k], length[k + 2]) < MIN_RATIO * MAX (length[k],
            length[k + 2]))
      return FALSE;
  return TRUE;
}

/* @outline: (inout): corners that are there, guesses of the others, edges known
 * @image: the picture
 * @black: colour of the square
 *
 * Finds the corners that are missing and checks the edges not known to be edges.
 *
 * Returns: whether the outline is that of a square; if not, its contents are not to be
 *   used
 */
gboolean
cloth_outline_complete (ClothOutline * outline, const ClothImage * image,
    gboolean black)
{
  Wedge wedges[4] = { {0} };
  gfloat x, y;

  for (gint round = 0; round < 2; round++)
    for (gint k = 0; k < 4; k++)
      for (gint way = 1; way <= 3 && !outline->have[k]; way += 2) {
        gint from = (k + way) & 3;

        if (!outline->have[from]
            || !follow (outline, image, black, wedges, from, k, &x, &y)
            || !fit (outline, image, k, x, y, MAX_SHIFT,
                wedges[from].contrast, black))
          continue;
        outline->joined[way == 1 ? k : from] = TRUE;
      }
  for (gint k = 0; k < 4; k++)
    if (!outline->have[k])
      return FALSE;
  if (!is_plausible (outline))
    return FALSE;
  for (gint k = 0; k < 4; k++) {
    gint to = (k + 1) & 3;
    gfloat near = ARRIVES + ARRIVES_SHARE * edge_length (outline, k);

    if (outline->joined[k])
      continue;
    if (!(follow (outline, image, black, wedges, k, to, &x, &y)
            && hypotf (x - outline->x[to], y - outline->y[to]) < near)
        && !(follow (outline, image, black, wedges, to, k, &x, &y)
            && hypotf (x - outline->x[k], y - outline->y[k]) < near))
      return FALSE;
    outline->joined[k] = TRUE;
  }
  return TRUE;
}
