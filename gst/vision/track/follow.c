/* Vertices of a printed cloth carried from picture to picture by optical flow: the tracker “2D with
 * known (u, v), Lucas and Kanade” of Hasler et al., started anew wherever the print tells a vertex.
 *
 * Model: between two pictures the print about a vertex moves as a whole (Lucas and Kanade 1981, on a
 *   pyramid). Each step adds an error of its own, so variances add up.
 * Assumption: points that the cloth hides don't vanish: they stay at the fold's crest and pile up
 *   there. They are told by three signs: the way back doesn't lead to where it began; a neighbour
 *   of the grid comes too near; a cell of the grid turns over, which a sheet seen from one side does
 *   not do while it is seen.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   sections 4 and 4.1; Kalal, Mikolajczyk and Matas, Forward-backward error, 2010.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/follow.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"
#include "gst/vision/track/flow.h"

/* Neighbours of a vertex whose distances say how far apart they usually are. */
#define REACH 2

struct _ClothFollower
{
  guint columns, rows, n;
  ClothGridVertex *last;        /* of the picture before */
  ClothFlow *flow;              /* from it */
  gfloat *from, *to;            /* of those that are followed */
  guint8 *found;
  guint *list;
  gdouble *apart;               /* scratch */
};

/* Returns: the usual ones
 */
ClothFollowParams
cloth_follow_default_params (void)
{
  return (ClothFollowParams) {
  11, 3, 0.4, 0.3, 0.15, 2.};
}

/* @columns: of the grid
 * @rows: of it
 *
 * Returns: (transfer full): a follower that has seen nothing yet
 */
ClothFollower *
cloth_follower_new (guint columns, guint rows)
{
  ClothFollower *f = g_new0 (ClothFollower, 1);

  f->columns = columns;
  f->rows = rows;
  f->n = columns * rows;
  f->last = g_new0 (ClothGridVertex, f->n);
  f->flow = cloth_flow_new ();
  f->from = g_new (gfloat, 2 * f->n);
  f->to = g_new (gfloat, 2 * f->n);
  f->found = g_new (guint8, f->n);
  f->list = g_new (guint, f->n);
  f->apart = g_new (gdouble, (2 * REACH + 1) * (2 * REACH + 1));
  return f;
}

/* @follower: (nullable) (transfer full): a follower
 */
void
cloth_follower_free (ClothFollower * follower)
{
  if (!follower)
    return;
  g_free (follower->last);
  cloth_flow_free (follower->flow);
  g_free (follower->from);
  g_free (follower->to);
  g_free (follower->found);
  g_free (follower->list);
  g_free (follower->apart);
  g_free (follower);
}

/* @follower: a follower
 *
 * Forgets the picture before: the next one is of another film.
 */
void
cloth_follower_reset (ClothFollower * follower)
{
  cloth_flow_reset (follower->flow);
}

static gboolean
is_seen (const ClothGridVertex * vertex)
{
  return vertex->state != CLOTH_GRID_UNSEEN;
}

/* The vertex @du, @dv further; NULL: it is not seen, or from the other side. */
static const ClothGridVertex *
neighbour (const ClothFollower * f, const ClothGridVertex * vertices, guint v,
    gint du, gint dv)
{
  const gint column = (gint) (v % f->columns) + du;
  const gint row = (gint) (v / f->columns) + dv;
  const ClothGridVertex *other;

  if (column < 0 || row < 0 || column >= (gint) f->columns
      || row >= (gint) f->rows)
    return NULL;
  other = vertices + (gsize) row *f->columns + column;
  return is_seen (other) && other->mirrored == vertices[v].mirrored ? other :
      NULL;
}

/* How far apart neighbours along u (@k 0) or v (1) usually are about a vertex; NaN: none are seen. */
static gdouble
find_apart (const ClothFollower * f, const ClothGridVertex * vertices, guint v,
    guint k)
{
  guint n = 0;

  for (gint dv = -REACH; dv <= REACH; dv++)
    for (gint du = -REACH; du <= REACH; du++) {
      const ClothGridVertex *a = neighbour (f, vertices, v, du, dv);

      const ClothGridVertex *b = neighbour (f, vertices, v, du + (k == 0),
          dv + (k == 1));

      if (a && b)
        f->apart[n++] = hypot (b->x - a->x, b->y - a->y);
    }
  return n ? cloth_median (f->apart, n) : NAN;
}

/* Whether a neighbour is too near, or a cell at the vertex has turned over since the picture
 * before. */
static gboolean
is_at_crest (const ClothFollower * f, const ClothFollowParams * p,
    const ClothGridVertex * vertices, guint v)
{
  static const gint steps[4][2] = { {1, 0}, {0, 1}, {-1, 0}, {0, -1} };
  const gdouble apart[2] = { find_apart (f, vertices, v, 0),
    find_apart (f, vertices, v, 1)
  };

  for (guint k = 0; k < 4; k++) {
    const gint *a = steps[k], *b = steps[(k + 1) % 4];
    const ClothGridVertex *now[2] =
        { neighbour (f, vertices, v, a[0], a[1]), neighbour (f, vertices, v,
          b[0], b[1])
    };
    const ClothGridVertex *then[2] =
        { neighbour (f, f->last, v, a[0], a[1]), neighbour (f, f->last, v,
          b[0], b[1])
    };
    gdouble area[2];

    if (now[0] && hypot (now[0]->x - vertices[v].x, now[0]->y -
            vertices[v].y) < p->crowding * apart[k % 2])
      return TRUE;
    if (!now[0] || !now[1] || !then[0] || !then[1] || !is_seen (&f->last[v]))
      continue;
    area[0] = (now[0]->x - vertices[v].x) * (now[1]->y - vertices[v].y) -
        (now[0]->y - vertices[v].y) * (now[1]->x - vertices[v].x);
    area[1] = (then[0]->x - f->last[v].x) * (then[1]->y - f->last[v].y) -
        (then[0]->y - f->last[v].y) * (then[1]->x - f->last[v].x);
    if (area[0] * area[1] < 0.)
      return TRUE;
  }
  return FALSE;
}

/* Those that were seen, and are not any more by themselves. */
static guint
list_lost (ClothFollower * f, const ClothGridVertex * vertices)
{
  guint n = 0;

  for (guint v = 0; v < f->n; v++) {
    if (is_seen (&vertices[v]) || !is_seen (&f->last[v]))
      continue;
    f->from[2 * n] = (gfloat) f->last[v].x;
    f->from[2 * n + 1] = (gfloat) f->last[v].y;
    f->list[n++] = v;
  }
  return n;
}

/* @follower: a follower
 * @params: how
 * @image: the next picture
 * @vertices: (inout) (array): what is known of it; where it was known of the picture before and
 *   isn't any more the flow says, and how sure it is
 * @n_followed: (out): how many were followed
 * @error: #ClothCvError
 *
 * A picture of another size begins a new film.
 *
 * Returns: %FALSE when the flow could not be found
 */
gboolean
cloth_follower_run (ClothFollower * follower, const ClothFollowParams * params,
    const ClothImage * image, ClothGridVertex * vertices, guint * n_followed,
    GError ** error)
{
  ClothFollower *f = follower;
  const ClothCvFlowParams flow = { params->window, params->levels };
  const gdouble drift = params->drift * params->drift;
  guint n = 0;

  *n_followed = 0;
  if (cloth_flow_goes_on (f->flow, image))
    n = list_lost (f, vertices);
  if (!cloth_flow_run (f->flow, &flow, params->back, image, n, f->from, f->to,
          f->found, error))
    return FALSE;
  for (guint i = 0; i < n; i++) {
    const ClothGridVertex *last = &f->last[f->list[i]];
    ClothGridVertex *to = &vertices[f->list[i]];

    if (!f->found[i]
        || last->xx + drift > params->uncertain * params->uncertain
        || last->yy + drift > params->uncertain * params->uncertain)
      continue;
    *to = *last;
    to->state = CLOTH_GRID_FOLLOWED;
    to->x = f->to[2 * i];
    to->y = f->to[2 * i + 1];
    to->xx += drift;
    to->yy += drift;
  }
  /* all are judged before any goes: a crest must not shield its neighbours */
  for (guint i = 0; i < n; i++)
    f->found[i] = vertices[f->list[i]].state == CLOTH_GRID_FOLLOWED
        && !is_at_crest (f, params, vertices, f->list[i]);
  for (guint i = 0; i < n; i++) {
    if (!f->found[i])
      vertices[f->list[i]] = (ClothGridVertex) {
      CLOTH_GRID_UNSEEN, FALSE, NAN, NAN, NAN, NAN, NAN};
    *n_followed += f->found[i];
  }
  memcpy (f->last, vertices, f->n * sizeof *f->last);
  cloth_flow_keep (f->flow, image);
  return TRUE;
}
