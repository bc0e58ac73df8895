/* Which features of a picture say that they are at the same place of the pattern.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <stdlib.h>

#include "gst/cloth/gstclothplaces.h"

/* Where in the pattern a feature is, and its number: sorted by both. */
guint64
gst_cloth_place (gint column, gint row, guint columns, guint number)
{
  return (guint64) ((guint) row * columns + (guint) column) << 32 | number;
}

static gint
compare_places (gconstpointer a, gconstpointer b)
{
  const guint64 p = *(const guint64 *) a, q = *(const guint64 *) b;

  return p < q ? -1 : p > q;
}

/* Sorts the places of @n features; FALSE when two features have the same. However they come
 * it takes n log n. */
gboolean
gst_cloth_places_sort (guint64 * places, guint n)
{
  guint in_order = 1;

  /* trackers write row by row */
  while (in_order < n && places[in_order - 1] >> 32 < places[in_order] >> 32)
    in_order++;
  if (in_order >= n)
    return TRUE;
  qsort (places, n, sizeof *places, compare_places);
  for (guint i = 1; i < n; i++)
    if (places[i - 1] >> 32 == places[i] >> 32)
      return FALSE;
  return TRUE;
}

/* Sets @left_out, by their numbers, of the features whose place an earlier one has. */
void
gst_cloth_places_mark_repeated (guint64 * places, guint n, guint8 * left_out)
{
  if (gst_cloth_places_sort (places, n))
    return;
  for (guint i = 1; i < n; i++)
    if (places[i - 1] >> 32 == places[i] >> 32)
      left_out[(guint32) places[i]] = TRUE;
}
