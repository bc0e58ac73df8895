/* Points carried from one picture of a film to the next by optical flow.
 *
 * Model: the picture about a point moves as a whole (Lucas and Kanade 1981, on a pyramid: OpenCV's).
 * Assumption: a point that the flow doesn't lead back to where it began was not followed.
 * Reference: Kalal, Mikolajczyk and Matas, Forward-backward error, 2010.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/flow.h"

#include <math.h>
#include <string.h>

struct _ClothFlow
{
  GByteArray *picture;          /* the one before, rows without gaps */
  gint width, height;           /* 0: none */
  gfloat *back;
  guint8 *returned;
  guint size;                   /* of these */
};

/* Returns: (transfer full): a flow that has seen nothing yet
 */
ClothFlow *
cloth_flow_new (void)
{
  ClothFlow *flow = g_new0 (ClothFlow, 1);

  flow->picture = g_byte_array_new ();
  return flow;
}

/* @flow: (nullable) (transfer full): a flow
 */
void
cloth_flow_free (ClothFlow * flow)
{
  if (!flow)
    return;
  g_byte_array_unref (flow->picture);
  g_free (flow->back);
  g_free (flow->returned);
  g_free (flow);
}

/* @flow: a flow
 *
 * Forgets the picture before: the next one is of another film.
 */
void
cloth_flow_reset (ClothFlow * flow)
{
  flow->width = flow->height = 0;
}

/* @flow: a flow
 * @image: a picture: the one before from now on
 */
void
cloth_flow_keep (ClothFlow * flow, const ClothImage * image)
{
  g_byte_array_set_size (flow->picture, (guint) (image->width * image->height));
  for (gint y = 0; y < image->height; y++)
    memcpy (flow->picture->data + (gsize) y * image->width,
        image->data + (gsize) y * image->stride, (gsize) image->width);
  flow->width = image->width;
  flow->height = image->height;
}

/* @flow: a flow
 * @image: a picture
 *
 * Returns: whether it can be of the same film as the picture before
 */
gboolean
cloth_flow_goes_on (const ClothFlow * flow, const ClothImage * image)
{
  return flow->width == image->width && flow->height == image->height;
}

/* @flow: a flow that goes on with @image
 * @params: how
 * @back: how near to where it began a point has to come back, px, or %CLOTH_FLOW_ANYWHERE
 * @image: the next picture; it is not kept
 * @n: number of points
 * @from: (array): where they are in the picture before, px, [n][2]
 * @to: (out) (array): where they are in this one
 * @found: (out) (array length=n): 1 of those that were followed and are in the picture, else 0
 * @error: #ClothCvError
 *
 * Returns: %FALSE when the flow could not be found
 */
gboolean
cloth_flow_run (ClothFlow * flow, const ClothCvFlowParams * params,
    gdouble back, const ClothImage * image, guint n, const gfloat * from,
    gfloat * to, guint8 * found, GError ** error)
{
  const ClothCvPicture now =
      { image->data, image->width, image->height, image->stride };
  const ClothCvPicture before = { flow->picture->data, flow->width,
    flow->height, flow->width
  };
  const gboolean returns = isfinite (back);

  if (n == 0)
    return TRUE;
  if (n > flow->size) {
    flow->size = n;
    flow->back = g_renew (gfloat, flow->back, 2 * n);
    flow->returned = g_renew (guint8, flow->returned, n);
  }
  if (!cloth_cv_flow (&before, &now, params, n, from, to, found, error)
      || (returns && !cloth_cv_flow (&now, &before, params, n, to, flow->back,
              flow->returned, error)))
    return FALSE;
  for (guint i = 0; i < n; i++) {
    const gfloat *a = from + 2 * i, *b = to + 2 * i, *c = flow->back + 2 * i;

    found[i] = found[i] && b[0] >= 0 && b[1] >= 0 && b[0] <= image->width - 1
        && b[1] <= image->height - 1 && (!returns || (flow->returned[i]
            && hypot (c[0] - a[0], c[1] - a[1]) <= back));
  }
  return TRUE;
}
