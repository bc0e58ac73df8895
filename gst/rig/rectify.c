/* Rectification of a pair of cameras.
 *
 * A. Fusiello, E. Trucco and A. Verri, “A compact algorithm for rectification of stereo
 * pairs” (2000), with lenses, and for partners in any direction: the common frame's x axis is
 * the baseline, its z axis what is left of the cameras' mean optical axis when its part along
 * the baseline is taken away. Both pictures then have the same rotation, focal length and
 * principal point.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/rectify.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"
#include "gst/rig/rig.h"

/* Least cosine of the angle by which a camera is turned: 60°. More stretches its picture
 * beyond use. */
#define LEAST_COSINE 0.5
/* Least disparity at the near end, px. */
#define LEAST_NEAR 1
/* Disparities that are looked for beyond both ends, px: those at the very ends of a range
 * tell that it is too small. */
#define BEYOND 2
/* Least share of the first picture that the second shows, too. */
#define LEAST_OVERLAP 0.05
/* Lines of the grid of places by which that is found. */
#define GRID 24
/* What is less comes of rounding: of a shift, px a pixel; of the way forward, 1/px. */
#define LEAST_SHIFT 1e-9
#define LEAST_FORWARD 1e-11
/* Pixels of a row that go through the lens together. */
#define CHUNK 256

/* ---- lenses ---- */

/* The pixels at the border of what a camera films, one after the other. Returns: %FALSE behind
 * the last one. */
static gboolean
border (const ClothCamera * camera, gint i, gdouble * u, gdouble * v)
{
  const gint half = camera->width + camera->height;
  const gint at = i % half, far = i >= half;

  *u = at < camera->width ? at : far * (camera->width - 1);
  *v = at < camera->width ? far * (camera->height - 1) : at - camera->width;
  return i < 2 * half;
}

/* The greatest radius, squared, of what a camera films, in normalised coordinates: beyond it
 * the polynomial of a lens may fold back into the picture. */
static gdouble
lens_reach (const ClothCamera * camera)
{
  gdouble most = 0, u, v;

  for (gint i = 0; border (camera, i, &u, &v); i++)
    if (cloth_camera_undistort_points (camera, 1, &u, &v, &u, &v, NULL))
      most = fmax (most, u * u + v * v);
  return most * (1 + 1e-6) + 1e-12;
}

/* Where a ray of the camera's frame appears. Returns: whether it does, within half a pixel
 * of the picture. */
static gboolean
film (const ClothCamera * camera, gdouble reach, const gdouble ray[3],
    gdouble px[2])
{
  const gdouble xy[2] = { ray[0] / ray[2], ray[1] / ray[2] };

  if (!(ray[2] > 0) || !(xy[0] * xy[0] + xy[1] * xy[1] <= reach))
    return FALSE;
  cloth_camera_distort (camera, xy, px, NULL);
  return px[0] > -0.5 && px[1] > -0.5 && px[0] < camera->width - 0.5
      && px[1] < camera->height - 0.5;
}

/* ---- the pair ---- */

/* What messages call a camera. */
static const gchar *
name_of (const ClothCamera * camera)
{
  return camera->name ? camera->name : "";
}

/* @b: (out): the baseline in the first camera's frame, m
 * @turn: (out): rotation from the second camera's frame to the first's */
static void
find_partner (const ClothCamera * head, const ClothCamera * partner,
    gdouble b[3], gdouble turn[9])
{
  gdouble at[3];

  cloth_mat3_mul_nt (head->R, partner->R, turn);
  /* the partner's place, −Rᵀt, in the head's frame: R·(−R'ᵀt') + t */
  cloth_mat3_vec (turn, partner->t, at);
  for (gint i = 0; i < 3; i++)
    b[i] = head->t[i] - at[i];
}

/* The common frame. Returns: whether both cameras look about where it does. */
static gboolean
find_frame (const ClothCamera * head, const ClothCamera * partner,
    ClothRectification * pair, GError ** error)
{
  gdouble turn[9], x[3], y[3], z[3], along, cosine[2];

  find_partner (head, partner, x, turn);
  pair->baseline = cloth_vec3_normalise (x);
  if (!(pair->baseline > 1e-9)) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "Cameras “%s” and “%s” stand at one place: depth shows in pictures "
        "from two. Name another camera, or calibrate them anew",
        name_of (head), name_of (partner));
    return FALSE;
  }
  for (gint i = 0; i < 3; i++)
    z[i] = (i == 2) + turn[3 * i + 2];
  along = cloth_vec3_dot (z, x);
  cloth_vec3_add_scaled (z, -along, x);
  cloth_vec3_normalise (z);
  cosine[0] = z[2];
  cosine[1] = z[0] * turn[2] + z[1] * turn[5] + z[2] * turn[8];
  if (!(fmin (cosine[0], cosine[1]) >= LEAST_COSINE)) {
    const gdouble apart = acos (CLAMP (turn[8], -1, 1)) * 180 / G_PI;
    const gdouble ahead = acos (CLAMP (fabs (x[2]), -1, 1)) * 180 / G_PI;

    if (apart > ahead)
      g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
          "Cameras “%s” and “%s” look %.0f° apart: turned to one direction "
          "their pictures would be stretched beyond use. Name cameras that look "
          "the same way, side by side", name_of (head), name_of (partner),
          apart);
    else
      g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
          "Camera “%s” stands %.0f° off the direction in which “%s” looks, "
          "nearly before or behind it: depth hardly shows there. Name a camera "
          "beside it, at least 30° off", name_of (partner), ahead,
          name_of (head));
    return FALSE;
  }
  cloth_vec3_cross (z, x, y);
  memcpy (pair->head, x, sizeof (x));
  memcpy (pair->head + 3, y, sizeof (y));
  memcpy (pair->head + 6, z, sizeof (z));
  cloth_mat3_mul (pair->head, turn, pair->partner);
  return TRUE;
}

static gboolean
find_range (const ClothCamera * head, const ClothCamera * partner,
    gdouble near, gdouble far, ClothRectification * pair, GError ** error)
{
  const gdouble scale = pair->focal * pair->baseline;
  const gdouble most = scale / near;

  if (!(near > 0 && far > near && isfinite (far))) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "Depths from near %g m to far %g m: make near more than 0 and far more "
        "than near", near, far);
    return FALSE;
  }
  if (most < LEAST_NEAR) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "Cameras “%s” and “%s” are %.3g m apart, too near for depths from "
        "%g m on: what lies there moves by %.2g px from one picture to the "
        "other", name_of (head), name_of (partner), pair->baseline, near, most);
    return FALSE;
  }
  if (most > CLOTH_RECTIFY_MOST - BEYOND - 16
      || most - scale / far > CLOTH_RECTIFY_MOST_RANGE - 2 * BEYOND - 4) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "Depths from near %g m to far %g m are %.0f to %.0f px of disparity "
        "between cameras “%s” and “%s”: at most %d px are looked through. "
        "Raise near", near, far, scale / far, most, name_of (head),
        name_of (partner), CLOTH_RECTIFY_MOST_RANGE - 2 * BEYOND - 4);
    return FALSE;
  }
  pair->least = MAX ((gint) floor (scale / far) - BEYOND, 0);
  pair->range = ((gint) ceil (most) + BEYOND - pair->least + 16) / 16 * 16;
  return TRUE;
}

/* Room for all that the first camera films, and beside it for the disparities of what lies at
 * its left and right borders. */
static gboolean
find_size (const ClothCamera * head, ClothRectification * pair, GError ** error)
{
  /* more than twice the diagonal are rays of a fisheye that nobody can match */
  const gdouble most = hypot (head->width, head->height);
  gdouble low[2] = { most, most }, high[2] = { -most, -most }, u, v;

  for (gint i = 0; border (head, i, &u, &v); i++) {
    gdouble ray[3], turned[3];

    if (!cloth_camera_undistort_points (head, 1, &u, &v, &u, &v, NULL))
      continue;
    ray[0] = u;
    ray[1] = v;
    ray[2] = 1;
    cloth_mat3_vec (pair->head, ray, turned);
    for (gint k = 0; k < 2; k++) {
      const gdouble at = turned[2] > 0 ? pair->focal * turned[k] / turned[2] :
          turned[k] > 0 ? most : -most;

      low[k] = fmin (low[k], CLAMP (at, -most, most));
      high[k] = fmax (high[k], CLAMP (at, -most, most));
    }
  }
  pair->width = (gint) ceil (high[0] - low[0] - 1e-6) + 1 + pair->least
      + 2 * pair->range;
  pair->height = (gint) ceil (high[1] - low[1] - 1e-6) + 1;
  pair->centre[0] = pair->least + pair->range - low[0];
  pair->centre[1] = -low[1];
  if (pair->height > 1 && pair->width <= CLOTH_RIG_MAX_SIZE
      && pair->height <= CLOTH_RIG_MAX_SIZE)
    return TRUE;
  g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_LIMIT,
      "The rectified picture of camera “%s” would have %d × %d pixels: film "
      "with fewer, or raise near", name_of (head), pair->width, pair->height);
  return FALSE;
}

/* Share of the first picture that the second one shows, too, at some depth in range. */
static gdouble
find_overlap (const ClothCamera * head, const ClothCamera * partner,
    const ClothRectification * pair)
{
  const gdouble reach = lens_reach (partner);
  guint n = 0;

  for (gint i = 0; i < GRID * GRID; i++) {
    gdouble u = (i % GRID + 0.5) * head->width / GRID - 0.5;
    gdouble v = (i / GRID + 0.5) * head->height / GRID - 0.5;
    gdouble ray[3], turned[3];
    gboolean shown = FALSE;

    if (!cloth_camera_undistort_points (head, 1, &u, &v, &u, &v, NULL))
      continue;
    ray[0] = u;
    ray[1] = v;
    ray[2] = 1;
    cloth_mat3_vec (pair->head, ray, turned);
    for (gint k = 0; k <= 8 && turned[2] > 0; k++) {
      const gdouble d = pair->least + k / 8. * (pair->range - 1);
      const gdouble moved[3] = { turned[0] - turned[2] * d / pair->focal,
        turned[1], turned[2]
      };
      gdouble back[3], px[2];

      cloth_mat3_vec_t (pair->partner, moved, back);
      shown |= film (partner, reach, back, px);
    }
    n += shown;
  }
  return n / (gdouble) (GRID * GRID);
}

/* @head: the camera whose pixels shall have disparities
 * @partner: another one
 * @near: least depth, m, along the rectified z axis
 * @far: greatest, m
 * @pair: (out): the common frame and its pictures
 * @error: (out): set to #ClothRigError
 *
 * Finds the frame of a pair that may lie to each other as it likes, beside and not before one
 * another, with any lens. The pictures have room for the whole of the first camera's and, to
 * both sides, for the disparities: matching leaves out the first @least + @range columns.
 *
 * Returns: %FALSE when the pair can't be rectified
 */
gboolean
cloth_rectify_pair (const ClothCamera * head, const ClothCamera * partner,
    gdouble near, gdouble far, ClothRectification * pair, GError ** error)
{
  gdouble overlap;

  memset (pair, 0, sizeof (*pair));
  pair->focal = sqrt (head->K[0] * head->K[4]);
  if (!find_frame (head, partner, pair, error)
      || !find_range (head, partner, near, far, pair, error)
      || !find_size (head, pair, error))
    return FALSE;
  overlap = find_overlap (head, partner, pair);
  if (overlap >= LEAST_OVERLAP)
    return TRUE;
  g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
      "At depths from near %g m to far %g m camera “%s” shows %.0f%% of what "
      "“%s” does: turn them to the same place, or see that near and far are "
      "the cloth's", near, far, name_of (partner), 100 * overlap,
      name_of (head));
  return FALSE;
}

/* ---- maps ---- */

/* @pair: a frame
 * @camera: a camera
 * @rotation: row-major, from its frame to the rectified one
 * @x: (out caller-allocates): width·height of the frame's pictures: column of the filmed
 *   picture that each rectified pixel shows, px; NaN where it shows none
 * @y: (out caller-allocates): row
 *
 * The map by which a filmed picture is rectified.
 */
void
cloth_rectify_map (const ClothRectification * pair, const ClothCamera * camera,
    const gdouble rotation[9], gfloat * x, gfloat * y)
{
  const gdouble reach = lens_reach (camera);

  for (gint row = 0; row < pair->height; row++)
    for (gint column = 0; column < pair->width; column++) {
      const gdouble at[3] = { (column - pair->centre[0]) / pair->focal,
        (row - pair->centre[1]) / pair->focal, 1
      };
      gdouble ray[3], px[2] = { NAN, NAN };

      cloth_mat3_vec_t (rotation, at, ray);
      if (!film (camera, reach, ray, px))
        px[0] = px[1] = NAN;
      *x++ = (gfloat) px[0];
      *y++ = (gfloat) px[1];
    }
}

/* @camera: a camera
 * @rays: (out caller-allocates): 2·width·height: x/z and y/z of each filmed pixel in the
 *   camera's frame, the lens undone; NaN where the lens can't be
 */
void
cloth_rectify_rays (const ClothCamera * camera, gfloat * rays)
{
  gdouble x[CHUNK], y[CHUNK];

  for (gint row = 0; row < camera->height; row++)
    for (gint left = 0; left < camera->width; left += CHUNK) {
      const gint n = MIN (CHUNK, camera->width - left);

      for (gint i = 0; i < n; i++) {
        x[i] = left + i;
        y[i] = row;
      }
      cloth_camera_undistort_points (camera, (guint) n, x, y, x, y, NULL);
      for (gint i = 0; i < n; i++) {
        *rays++ = (gfloat) x[i];
        *rays++ = (gfloat) y[i];
      }
    }
}

/* @pair: a frame
 * @rays: 2·@n: x/z and y/z in the first camera's frame
 * @n: rays
 * @x: (out caller-allocates): column of the rectified picture in which each lies, px; NaN
 *   where it lies behind it
 * @y: (out caller-allocates): row
 */
void
cloth_rectify_places (const ClothRectification * pair, const gfloat * rays,
    gsize n, gfloat * x, gfloat * y)
{
  for (gsize i = 0; i < n; i++) {
    const gdouble ray[3] = { (gdouble) rays[2 * i], (gdouble) rays[2 * i + 1],
      1
    };
    gdouble at[3];

    cloth_mat3_vec (pair->head, ray, at);
    x[i] = (gfloat) (at[2] > 0 ? pair->focal * at[0] / at[2]
        + pair->centre[0] : NAN);
    y[i] = (gfloat) (at[2] > 0 ? pair->focal * at[1] / at[2]
        + pair->centre[1] : NAN);
  }
}

/* @base: the first pair
 * @pair: another one with the same first camera
 * @place: (out): homography by rows, from pixels of the first pair's left picture to those of
 *   this one's
 * @unit: (out): disparities of this pair times unit[0]·x + unit[1]·y + unit[2] are those of
 *   the first one at its pixel (x, y)
 */
void
cloth_rectify_relate (const ClothRectification * base,
    const ClothRectification * pair, gdouble place[9], gdouble unit[3])
{
  const gdouble f = base->focal, g = pair->focal;
  gdouble turn[9], between[9];

  /* with K⁻¹ before and K behind it */
  cloth_mat3_mul_nt (pair->head, base->head, turn);
  for (gint i = 0; i < 3; i++) {
    between[3 * i] = turn[3 * i] / f;
    between[3 * i + 1] = turn[3 * i + 1] / f;
    between[3 * i + 2] = turn[3 * i + 2] - (turn[3 * i] * base->centre[0]
        + turn[3 * i + 1] * base->centre[1]) / f;
  }
  for (gint j = 0; j < 3; j++) {
    place[j] = g * between[j] + pair->centre[0] * between[6 + j];
    place[3 + j] = g * between[3 + j] + pair->centre[1] * between[6 + j];
    place[6 + j] = between[6 + j];
    /* depth along this pair's axis over that along the first one's is the last row */
    unit[j] = f * base->baseline / (g * pair->baseline) * between[6 + j];
  }
}

/* @base: the first pair
 * @head: its first camera
 * @camera: any camera
 * @rotation: (out): row-major, from its frame to the rectified one
 * @shift: (out): see ClothRefineView
 * @forward: (out): see there, 1/px
 *
 * How a camera, turned as the first pair is, sees what its left picture does: a point at
 * pixel p there, with disparity d, appears at c + (p − c + d·@shift) / (1 + d·@forward),
 * c being the principal point.
 */
void
cloth_rectify_view (const ClothRectification * base, const ClothCamera * head,
    const ClothCamera * camera, gdouble rotation[9], gdouble shift[2],
    gdouble * forward)
{
  gdouble b[3], turn[9], at[3];

  find_partner (head, camera, b, turn);
  cloth_mat3_mul (base->head, turn, rotation);
  cloth_mat3_vec (base->head, b, at);
  for (gint i = 0; i < 2; i++) {
    shift[i] = -at[i] / base->baseline;
    if (fabs (shift[i]) < LEAST_SHIFT)
      shift[i] = 0;
  }
  *forward = -at[2] / (base->focal * base->baseline);
  if (fabs (*forward) < LEAST_FORWARD)
    *forward = 0;
}
