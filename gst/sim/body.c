/* What of a body the lanes ask while they run, and its end.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/body.h"

/* @paths: the clamps' places, [frame][held][3], m: the body's own or others
 * @held: index of what is held
 *
 * The place of a clamp on its path: a cubic through the frames' places whose slope
 * at a frame is that between its neighbours (Catmull and Rom 1974), so that the clamp's
 * speed has no jumps, which would shake the cloth at the frame rate. Straight on beyond
 * the ends.
 */
void
cloth_body_path (const ClothBody * body, const gdouble * paths, guint held,
    gdouble time_s, gdouble position[3])
{
  const ClothBodyHeld *h = &body->held[held];
  const gdouble *t = body->times;
  guint low = h->first, high = h->last;

  while (high - low > 1) {
    guint middle = (low + high) / 2;

    if (t[middle] <= time_s)
      low = middle;
    else
      high = middle;
  }
  for (guint k = 0; k < 3; k++) {
#define AT(frame) paths[3 * ((gsize) (frame) * body->n_held + held) + k]
    gdouble span = t[high] - t[low], s, slope[2], rise;

    if (high == low) {
      position[k] = AT (low);
      continue;
    }
    s = (time_s - t[low]) / span;
    rise = AT (high) - AT (low);
    for (guint end = 0; end < 2; end++) {
      guint at = end ? high : low;
      guint a = at > h->first ? at - 1 : at, b = at < h->last ? at + 1 : at;

      slope[end] = (AT (b) - AT (a)) / (t[b] - t[a]) * span;
    }
    if (s < 0.)
      position[k] = AT (low) + s * slope[0];
    else if (s > 1.)
      position[k] = AT (high) + (s - 1.) * slope[1];
    else
      position[k] = AT (low) + s * (slope[0] + s * (3. * rise - 2. * slope[0] -
              slope[1] + s * (slope[0] + slope[1] - 2. * rise)));
#undef AT
  }
}

/* @body: (nullable) (transfer full): a body
 */
void
cloth_body_free (ClothBody * body)
{
  if (!body)
    return;
  for (guint i = 0; body->obstacles && i < body->obstacles->len; i++)
    cloth_bvh_free (body->bvhs[i]);
  g_clear_pointer (&body->obstacles, g_array_unref);
  g_free (body->bvhs);
  g_free (body->particle);
  g_free (body->uv);
  g_free (body->area);
  g_free (body->triangles);
  g_free (body->hinges);
  g_free (body->first_bend);
  g_free (body->bends);
  g_free (body->springs);
  g_free (body->bounds);
  g_free (body->held);
  g_free (body->times);
  g_free (body->clamps);
  g_free (body->positions);
  g_free (body->velocities);
  g_free (body);
}
