/* Runs of bright pixels and the connected spots they form: union–find over the runs of
 * neighbouring rows (four-connected).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot-spots.h"

#include <math.h>

#include "gst/vision/dot/dot-private.h"
#include "gst/vision/pieces.h"

/* Room for @n more runs, as far as there may be that many; the first of them. */
static ClothDotRun *
reserve_runs (GArray * runs, guint n, guint * most)
{
  const guint len = runs->len;

  *most = MIN (n, CLOTH_DOT_MAX_RUNS - MIN (len, CLOTH_DOT_MAX_RUNS));
  g_array_set_size (runs, len + *most);
  return &g_array_index (runs, ClothDotRun, len);
}

static inline void
put_run (ClothDotRun * run, gint32 self, gint y, gint start, gint end)
{
  *run = (ClothDotRun) {
  self, -1, (gint16) y, (gint16) start, (gint16) end};
}

static void
add_run (GArray * runs, gint y, gint start, gint end)
{
  guint room;
  ClothDotRun *run = reserve_runs (runs, 1, &room);

  if (room)
    put_run (run, (gint32) runs->len - 1, y, start, end);
}

/* The runs of row @y by its tiles' @bits. */
void
cloth_dot_runs_of_bits (GArray * runs, const guint16 * bits, gint n_tiles,
    gint y)
{
  const guint len = runs->len;
  guint room, n = 0;
  ClothDotRun *run = reserve_runs (runs,
      (guint) n_tiles * CLOTH_DOT_TILE / 2 + 1, &room);
  gint start = -1;

  for (gint t = 0; t < n_tiles; t++) {
    guint left = bits[t];
    gint x = 0;

    if (left == (start < 0 ? 0u : 0xffffu))
      continue;
    while (x < CLOTH_DOT_TILE) {
      /* How far the pixels stay as they are now. */
      const guint change = start < 0 ? left >> x : (~left & 0xffffu) >> x;

      if (!change)
        break;
      x += __builtin_ctz (change);
      if (start < 0) {
        start = t * CLOTH_DOT_TILE + x;
      } else {
        if (n < room)
          put_run (&run[n], (gint32) (len + n), y, start,
              t * CLOTH_DOT_TILE + x);
        n++;
        start = -1;
      }
    }
  }
  if (start >= 0 && n++ < room)
    put_run (&run[n - 1], (gint32) (len + n - 1), y, start,
        n_tiles * CLOTH_DOT_TILE);
  g_array_set_size (runs, len + MIN (n, room));
}

/* The parts of @spot's runs above a higher @threshold. */
void
cloth_dot_runs_of_spot (GArray * runs, const ClothDotSpot * spot,
    const ClothImage * image, guint8 threshold)
{
  for (gint32 k = spot->first; k >= 0;) {
    const ClothDotRun run = g_array_index (runs, ClothDotRun, k);
    const guint8 *row = image->data + (gsize) run.y * (gsize) image->stride;
    gint start = -1;

    for (gint x = run.start; x < run.end; x++) {
      if (row[x] > threshold) {
        if (start < 0)
          start = x;
      } else if (start >= 0) {
        add_run (runs, run.y, start, x);
        start = -1;
      }
    }
    if (start >= 0)
      add_run (runs, run.y, start, run.end);
    k = run.next;
  }
}

CLOTH_DEFINE_PIECES (ClothDotRun)
/* Sums of x and x² over a run, x from @x0. */
     static void
         add_moments (ClothDotSpot * spot, const ClothDotRun * run, gint x0,
    gint y0)
{
  const gint64 n = run->end - run->start, dy = run->y - y0;
  const gint64 a = run->start - x0, b = a + n - 1;
  const gint64 sx = n * (a + b) / 2;
  const gint64 sxx = (b * (b + 1) * (2 * b + 1) - (a - 1) * a * (2 * a - 1))
      / 6;

  spot->n += n;
  spot->sx += sx;
  spot->sy += n * dy;
  spot->sxx += sxx;
  spot->sxy += sx * dy;
  spot->syy += n * dy * dy;
  spot->left = MIN (spot->left, run->start);
  spot->right = (gint16) MAX (spot->right, run->end - 1);
  spot->bottom = MAX (spot->bottom, run->y);
}

/* Joins the runs from @first_run on, which are in reading order, and appends a spot for
 * each connected piece, in the order of their first pixels. */
void
cloth_dot_spots (GArray * runs, guint first_run, GArray * spots)
{
  ClothDotRun *r = &g_array_index (runs, ClothDotRun, 0);
  const gint32 end = (gint32) runs->len;
  gint32 above = (gint32) first_run;

  for (gint32 k = (gint32) first_run; k < end; k++) {
    while (above < k && (r[above].y < r[k].y - 1
            || (r[above].y == r[k].y - 1 && r[above].end <= r[k].start)))
      above++;
    for (gint32 j = above; j < k && r[j].y == r[k].y - 1
        && r[j].start < r[k].end; j++) {
      if (r[k].parent == k)
        r[k].parent = find_root (r, j);
      else
        join (r, j, k);
    }
  }
  /* From here on a run's parent is its spot, all bits turned: what it points to, if not to
   * itself, comes before it. */
  for (gint32 k = (gint32) first_run; k < end; k++) {
    const gint32 parent = r[k].parent;
    ClothDotSpot *spot;

    if (parent == k) {
      const ClothDotSpot fresh = { k, k, r[k].start, r[k].y, r[k].start,
        r[k].y
      };

      r[k].parent = ~(gint32) spots->len;
      g_array_append_val (spots, fresh);
      spot = &g_array_index (spots, ClothDotSpot, spots->len - 1);
    } else {
      r[k].parent = r[parent].parent;
      spot = &g_array_index (spots, ClothDotSpot, ~r[k].parent);
      r[spot->last].next = k;
      spot->last = k;
    }
    add_moments (spot, &r[k], r[spot->first].start, r[spot->first].y);
  }
}

/* Centre and second moments of the spot's area; returns its area over that of the
 * ellipse with these moments: 1 for an ellipse, less for anything else. */
gdouble
cloth_dot_spot_shape (const ClothDotSpot * spot, const ClothDotRun * runs,
    gdouble * x, gdouble * y, gdouble shape[3])
{
  const gdouble n = (gdouble) spot->n;
  const gdouble mx = (gdouble) spot->sx / n, my = (gdouble) spot->sy / n;
  gdouble det;

  *x = runs[spot->first].start + mx;
  *y = runs[spot->first].y + my;
  /* A pixel is a square: 1/12. */
  shape[0] = (gdouble) spot->sxx / n - mx * mx + 1.0 / 12;
  shape[1] = (gdouble) spot->sxy / n - mx * my;
  shape[2] = (gdouble) spot->syy / n - my * my + 1.0 / 12;
  det = shape[0] * shape[2] - shape[1] * shape[1];
  return n / (4 * G_PI * sqrt (det));
}
