/* Quad tracker: the print's own ratio of dark to bright, which tells it from other
 * checkerboards.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/vision/quad/quad-private.h"

/* Squares from which the print's shade is known, and how far from it a square's may be. */
#define LEAST_SHADES 20
#define REACH 0.12f
/* Steps of shade told apart at first, and pictures that it is the mean of at most. */
#define SHADES 100
#define MOST_PICTURES 10
/* Pictures in a row in which more squares may be refused for their shade than found. */
#define MAX_CONTRARY 2

/* Other checkerboards mostly have another shade. A square refused is not looked for any more:
 * that would find the next best, which is no square at all. Without linking what is lost
 * can't be found again, so none is refused. */
gboolean
cloth_quad_take (ClothQuadTracker * tracker, ClothQuadCell * cell,
    gboolean black, const gfloat x[4], const gfloat y[4], gfloat cov[4][3],
    gfloat confidence)
{
  cell->shade = cloth_quad_shade (tracker->image, x, y, black);
  cell->refused = tracker->params->link && cell->shade >= 0
      && tracker->n_shades >= LEAST_SHADES
      && fabsf (cell->shade - tracker->shade) > REACH;
  if (cell->refused)
    return FALSE;
  memcpy (cell->here_x, x, sizeof cell->here_x);
  memcpy (cell->here_y, y, sizeof cell->here_y);
  memcpy (cell->cov, cov, sizeof cell->cov);
  cell->confidence = confidence;
  cell->found = TRUE;
  return TRUE;
}

/* The shade that most of the squares seen have, those refused for it too: a mean of two
 * kinds would be that of neither. */
static gfloat
commonest_shade (const ClothQuadTracker * tracker)
{
  const gint n = tracker->pattern.columns * tracker->pattern.rows;
  const gint reach = (gint) (REACH * SHADES);
  guint count[SHADES + 1] = { 0 }, most = 0;
  gint first = 0, last = 0;

  for (gint k = 0; k < n; k++) {
    const ClothQuadCell *cell = &tracker->cells[k];

    if ((cell->found || cell->refused) && cell->shade >= 0)
      count[(gint) (MIN (cell->shade, 1.0f) * SHADES)]++;
  }
  for (gint at = 0; at <= SHADES; at++) {
    guint near = 0;

    for (gint k = MAX (at - reach, 0); k <= MIN (at + reach, SHADES); k++)
      near += count[k];
    if (near > most)
      first = at;
    if (near >= most)
      last = at;
    most = MAX (most, near);
  }
  return (0.5f * (gfloat) (first + last) + 0.5f) / SHADES;
}

/* Learns the print's shade from the squares found. Where more are refused for theirs,
 * picture after picture, the print is seen in another way, say overexposed. */
void
cloth_quad_learn_shade (ClothQuadTracker * tracker)
{
  const gint n = tracker->pattern.columns * tracker->pattern.rows;
  guint n_found = 0, n_refused = 0, most;

  for (gint k = 0; k < n; k++) {
    n_found += tracker->cells[k].found;
    n_refused += tracker->cells[k].refused && !tracker->cells[k].found;
  }
  tracker->contrary = n_refused > n_found ? tracker->contrary + 1 : 0;
  if (tracker->contrary > MAX_CONTRARY) {
    tracker->contrary = 0;
    tracker->n_shades = LEAST_SHADES;
    tracker->shade = commonest_shade (tracker);
  } else if (tracker->n_shades < LEAST_SHADES) {
    tracker->shade = commonest_shade (tracker);
  }
  most = MAX (MOST_PICTURES * n_found, LEAST_SHADES);
  for (gint k = 0; k < n; k++) {
    const ClothQuadCell *cell = &tracker->cells[k];

    if (!cell->found || cell->shade < 0
        || fabsf (cell->shade - tracker->shade) > REACH)
      continue;
    tracker->n_shades = MIN (tracker->n_shades + 1, most);
    tracker->shade += (cell->shade - tracker->shade)
        / (gfloat) MAX (tracker->n_shades, LEAST_SHADES);
  }
}
