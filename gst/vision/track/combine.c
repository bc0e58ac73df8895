/* Features of several cameras that show the same place of a cloth that lies flat.
 *
 * Model: features of one place lie within a radius of each other on the cloth; of several that do, those
 *   belong together whose descriptors differ least.
 * Method: all pairs of different cameras within the radius, the most alike first; a pair joins its two
 *   groups if these have no camera in common and all their features lie within the radius.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 4.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/combine.h"

#include <math.h>

#include "gst/vision/track/seek.h"

typedef struct
{
  guint32 distance, a, b;
} Pair;

typedef struct
{
  gdouble u;
  guint32 item;
} Order;

static gint
compare_orders (gconstpointer a, gconstpointer b)
{
  const Order *p = a, *q = b;

  return p->u != q->u ? (p->u > q->u) - (p->u < q->u) :
      (p->item > q->item) - (p->item < q->item);
}

static gint
compare_pairs (gconstpointer a, gconstpointer b)
{
  const Pair *p = a, *q = b;

  if (p->distance != q->distance)
    return p->distance < q->distance ? -1 : 1;
  if (p->a != q->a)
    return p->a < q->a ? -1 : 1;
  return (p->b > q->b) - (p->b < q->b);
}

static gboolean
are_near (const ClothCombineItem * a, const ClothCombineItem * b,
    gdouble radius)
{
  return hypot (a->place[0] - b->place[0], a->place[1] - b->place[1]) <= radius;
}

/* Pairs of different cameras within the radius, the most alike first. */
static GArray *
list_pairs (guint n, const ClothCombineItem * items, gdouble radius)
{
  GArray *pairs = g_array_new (FALSE, FALSE, sizeof (Pair));
  g_autofree Order *order = g_new (Order, MAX (n, 1));

  for (guint i = 0; i < n; i++)
    order[i] = (Order) {
    items[i].place[0], i};
  qsort (order, n, sizeof *order, compare_orders);
  for (guint i = 0; i < n; i++)
    for (guint j = i + 1; j < n && order[j].u - order[i].u <= radius; j++) {
      const guint32 a = MIN (order[i].item, order[j].item);
      const guint32 b = MAX (order[i].item, order[j].item);
      Pair pair;

      if (items[a].camera == items[b].camera
          || !are_near (&items[a], &items[b], radius))
        continue;
      pair = (Pair) {
      cloth_seek_distance (items[a].descriptor, items[b].descriptor), a, b};
      g_array_append_val (pairs, pair);
    }
  g_array_sort (pairs, compare_pairs);
  return pairs;
}

/* Whether all items of two groups, linked from @a and @b, may be one. */
static gboolean
may_join (const ClothCombineItem * items, const guint32 * next, guint32 a,
    guint32 b, gdouble radius)
{
  for (guint32 i = a; i != CLOTH_COMBINE_NONE; i = next[i])
    for (guint32 j = b; j != CLOTH_COMBINE_NONE; j = next[j])
      if (items[i].camera == items[j].camera
          || !are_near (&items[i], &items[j], radius))
        return FALSE;
  return TRUE;
}

/* @n: features
 * @items: (array length=n): them
 * @radius: greatest distance of two of a group, m
 * @groups: (array length=n) (out caller-allocates): the group of each, or %CLOTH_COMBINE_NONE
 *
 * A group has features of two cameras or more, one of each. Groups are numbered by their first
 * feature.
 *
 * Returns: how many groups there are
 */
guint
cloth_combine_run (guint n, const ClothCombineItem * items, gdouble radius,
    guint32 * groups)
{
  g_autoptr (GArray) pairs = list_pairs (n, items, radius);
  g_autofree guint32 *first = g_new (guint32, MAX (n, 1));
  g_autofree guint32 *next = g_new (guint32, MAX (n, 1));
  guint n_groups = 0;

  for (guint i = 0; i < n; i++) {
    first[i] = i;
    next[i] = groups[i] = CLOTH_COMBINE_NONE;
  }
  for (guint i = 0; i < pairs->len; i++) {
    const Pair *pair = &g_array_index (pairs, Pair, i);
    const guint32 a = MIN (first[pair->a], first[pair->b]);
    const guint32 b = MAX (first[pair->a], first[pair->b]);
    guint32 last = a;

    if (a == b || !may_join (items, next, a, b, radius))
      continue;
    while (next[last] != CLOTH_COMBINE_NONE)
      last = next[last];
    next[last] = b;
    for (guint32 j = b; j != CLOTH_COMBINE_NONE; j = next[j])
      first[j] = a;
  }
  for (guint i = 0; i < n; i++) {
    if (first[i] == i && next[i] != CLOTH_COMBINE_NONE)
      groups[i] = n_groups++;
    else if (first[i] != i)
      groups[i] = groups[first[i]];
  }
  return n_groups;
}
