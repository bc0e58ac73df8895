/* Quad tracker: the paper's local search for one square around its guess.
 *
 * A square that a shadow's edge crosses has two bright levels, and bright in the shadow may be
 * hardly brighter than dark beside it. In logarithms print and shadow are steps that add up,
 * and the print's is the same on both sides: what is not found as filmed is looked for there.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/vision/corner/edge.h"
#include "gst/vision/quad/quad-private.h"

/* Candidates looked at for a corner, and how many of them may be refined saddles. */
#define MAX_CANDIDATES 8
#define MAX_REFINED 4
/* They may lie this far from its guess, in shortest edges. */
#define REACH 0.5f
/* A corner's sub-pixel fit may move it this far, in shortest edges. */
#define MAX_FIT 0.3f
/* A linked corner this near a found one is the same, px. */
#define SAME 2.0f
/* What is added to grey levels before the logarithm, so that the noise of black stays small. */
#define LOG_OFFSET 8
/* How far around a guess they are taken: its longest edges, and px. */
#define LOG_AROUND 2.0f
#define LOG_MARGIN 12.0f
/* There a square is believed when the dimmest of its bright levels is no more than this share
 * of the brightest: in even light what was not found as filmed is hardly exact. */
#define SHADED 0.45f
/* And its confidence there is at least this. */
#define LEAST_SHADED 0.8f

static inline gfloat
edge2 (const gfloat x[4], const gfloat y[4], gint k)
{
  gfloat dx = x[(k + 1) & 3] - x[k], dy = y[(k + 1) & 3] - y[k];

  return dx * dx + dy * dy;
}

gfloat
cloth_quad_shortest (const gfloat x[4], const gfloat y[4])
{
  gfloat least = G_MAXFLOAT;

  for (gint k = 0; k < 4; k++)
    least = MIN (least, edge2 (x, y, k));
  return sqrtf (least);
}

gfloat
cloth_quad_longest (const gfloat x[4], const gfloat y[4])
{
  gfloat most = 0;

  for (gint k = 0; k < 4; k++)
    most = MAX (most, edge2 (x, y, k));
  return sqrtf (most);
}

/* What is searched: the picture, or a piece of what was made of it. */
typedef struct
{
  ClothImage image;
  gfloat x, y;                  /* where it begins in the picture */
} View;

typedef struct
{
  gfloat x[MAX_CANDIDATES], y[MAX_CANDIDATES];
  guint n;
  gfloat distance2;             /* of the nearest */
} Candidates;

/* Sorts the saddles by place, in pictures in which there is something to look for. */
static void
sort_candidates (ClothQuadTracker * tracker)
{
  const ClothImage *image = tracker->image;

  if (tracker->sorted)
    return;
  cloth_point_grid_clear (tracker->candidates, image->width, image->height,
      tracker->n_raw);
  for (guint k = 0; k < tracker->n_raw; k++)
    cloth_point_grid_add (tracker->candidates, tracker->raw[k].x,
        tracker->raw[k].y);
  cloth_point_grid_clear (tracker->refined, image->width, image->height,
      tracker->n_saddles);
  for (guint k = 0; k < tracker->n_saddles; k++)
    cloth_point_grid_add (tracker->refined, tracker->saddles[k].x,
        tracker->saddles[k].y);
  tracker->sorted = TRUE;
}

/* Refined saddles first, as a corner far from its guess has only the near rim of its spot
 * of candidates among the nearest. */
static void
list_candidates (ClothQuadTracker * tracker, const View * view, gfloat x,
    gfloat y, gfloat radius, Candidates * list)
{
  ClothNear near[MAX_CANDIDATES];
  guint n_refined = cloth_point_grid_nearest (tracker->refined, x, y, radius,
      near, MAX_REFINED), n;

  list->distance2 = n_refined ? near[0].distance2 : G_MAXFLOAT;
  for (guint k = 0; k < n_refined; k++) {
    list->x[k] = tracker->saddles[near[k].index].x - view->x;
    list->y[k] = tracker->saddles[near[k].index].y - view->y;
  }
  n = cloth_point_grid_nearest (tracker->candidates, x, y, radius, near,
      MAX_CANDIDATES - n_refined);
  if (n)
    list->distance2 = MIN (list->distance2, near[0].distance2);
  for (guint k = 0; k < n; k++) {
    list->x[n_refined + k] = tracker->raw[near[k].index].x - view->x;
    list->y[n_refined + k] = tracker->raw[near[k].index].y - view->y;
  }
  list->n = n_refined + n;
}

/* Section 3.7: three corners go over the candidates near them, in order of the sum of
 * their places in the lists; the fourth closes the parallelogram. The corner left out is
 * the one whose nearest candidate is farthest. */
static gfloat
search_candidates (ClothQuadTracker * tracker, const View * view,
    gboolean black, const gfloat guess_x[4], const gfloat guess_y[4],
    gfloat x[4], gfloat y[4])
{
  const ClothQuadParams *params = tracker->params;
  gfloat radius = REACH * cloth_quad_shortest (guess_x, guess_y);
  gfloat best = -1, farthest = -1;
  Candidates list[4];
  guint tried = 0, most = 0;
  gint left_out = 0, used[3];

  sort_candidates (tracker);
  for (gint k = 0; k < 4; k++) {
    list_candidates (tracker, view, guess_x[k], guess_y[k], radius, &list[k]);
    if (list[k].distance2 > farthest) {
      farthest = list[k].distance2;
      left_out = k;
    }
  }
  for (gint k = 0; k < 3; k++) {
    used[k] = (left_out + 1 + k) & 3;
    if (!list[used[k]].n)
      return -1;
    most += list[used[k]].n - 1;
  }
  for (guint sum = 0; sum <= most; sum++)
    for (guint a = 0; a <= MIN (sum, list[used[0]].n - 1); a++)
      for (guint b = 0; b <= MIN (sum - a, list[used[1]].n - 1); b++) {
        guint place[3] = { a, b, sum - a - b };
        gfloat tx[4], ty[4], confidence;

        if (place[2] >= list[used[2]].n)
          continue;
        if (tried++ >= params->max_variants)
          return best;
        for (gint k = 0; k < 3; k++) {
          tx[used[k]] = list[used[k]].x[place[k]];
          ty[used[k]] = list[used[k]].y[place[k]];
        }
        tx[left_out] = tx[used[0]] + tx[used[2]] - tx[used[1]];
        ty[left_out] = ty[used[0]] + ty[used[2]] - ty[used[1]];
        confidence = cloth_quad_confidence (&view->image, tx, ty, params->alpha,
            black);
        if (confidence > best) {
          best = confidence;
          for (gint k = 0; k < 4; k++) {
            x[k] = tx[k];
            y[k] = ty[k];
          }
          if (best >= params->c_high)
            return best;
        }
      }
  return best;
}

/* Whether a corner lies on a linked corner that is some other vertex of the board. */
static gboolean
is_elsewhere (ClothQuadTracker * tracker, gfloat x, gfloat y, gint column,
    gint row)
{
  ClothNear near;

  return tracker->params->link
      && cloth_point_grid_nearest (tracker->corners, x, y, SAME, &near, 1)
      && g_array_index (tracker->corner_vertex, gint, near.index)
      != row * (tracker->pattern.columns + 1) + column;
}

/* Whether at least three sides of a quad are edges of its colour: fitting corners is too
 * dear for what is none. */
static gboolean
has_edges (const ClothImage * image, const gfloat x[4], const gfloat y[4],
    gboolean black)
{
  gint n = 0;

  for (gint k = 0; k < 4; k++) {
    gint to = (k + 1) & 3;
    gfloat contrast = cloth_edge_contrast (image, x[k], y[k], x[to], y[to]);

    n += black ? contrast < 0 : contrast > 0;
  }
  return n >= 3;
}

/* Fits all corners to sub-pixel places, whose square need not be a parallelogram. */
static gboolean
fit_outline (ClothQuadTracker * tracker, const ClothImage * image, gint column,
    gint row, ClothOutline * outline)
{
  gboolean black = cloth_pattern_is_black (&tracker->pattern, column, row);
  gfloat reach = MAX (MAX_FIT * cloth_quad_shortest (outline->x, outline->y),
      1.5f);

  for (gint k = 0; k < 4; k++)
    cloth_outline_fit (outline, image, k, outline->x[k], outline->y[k], reach,
        black);
  if (!cloth_outline_complete (outline, image, black))
    return FALSE;
  /* An inner corner that is no saddle is where a fold cuts the square. */
  for (gint k = 0; k < 4; k++)
    if (cloth_quad_is_inner (tracker, column + cloth_quad_corner_column[k],
            row + cloth_quad_corner_row[k]) && !outline->saddle[k])
      return FALSE;
  return TRUE;
}

/* The search in one view of the picture. @confidence: of the square found, else of the best
 * that was tried, -1 if there was none. */
static gboolean
search (ClothQuadTracker * tracker, const View * view, gint column, gint row,
    const gfloat guess_x[4], const gfloat guess_y[4], gfloat least,
    ClothOutline * outline, gfloat * confidence)
{
  gboolean black = cloth_pattern_is_black (&tracker->pattern, column, row);
  const ClothImage *image = &view->image;

  *outline = (ClothOutline) { {
  0}};
  *confidence = search_candidates (tracker, view, black, guess_x, guess_y,
      outline->x, outline->y);
  if (*confidence < least || !has_edges (image, outline->x, outline->y, black)
      || !fit_outline (tracker, image, column, row, outline))
    return FALSE;
  *confidence = cloth_quad_confidence (image, outline->x, outline->y,
      tracker->params->alpha, black);
  for (gint k = 0; k < 4; k++) {
    outline->x[k] += view->x;
    outline->y[k] += view->y;
  }
  return *confidence >= least;
}

/* The logarithms of the picture's levels around a guess. Nothing else can be read, so what is
 * found does not hang on what was looked for before. */
static View
take_logarithms (ClothQuadTracker * tracker, const gfloat guess_x[4],
    const gfloat guess_y[4])
{
  const ClothImage *image = tracker->image;
  const gfloat around = LOG_MARGIN + LOG_AROUND * cloth_quad_longest (guess_x,
      guess_y);
  gfloat box[4] = { G_MAXFLOAT, G_MAXFLOAT, 0, 0 };
  gint left, top, width, height;
  gsize size;

  for (gint k = 0; k < 4; k++) {
    box[0] = MIN (box[0], guess_x[k] - around);
    box[1] = MIN (box[1], guess_y[k] - around);
    box[2] = MAX (box[2], guess_x[k] + around);
    box[3] = MAX (box[3], guess_y[k] + around);
  }
  left = (gint) CLAMP (box[0], 0.0f, (gfloat) image->width);
  top = (gint) CLAMP (box[1], 0.0f, (gfloat) image->height);
  width = (gint) CLAMP (box[2], 0.0f, (gfloat) image->width) - left;
  height = (gint) CLAMP (box[3], 0.0f, (gfloat) image->height) - top;
  size = (gsize) width *(gsize) height;
  if (tracker->logarithms_size < size) {
    g_free (tracker->logarithms);
    tracker->logarithms = g_malloc (size);
    tracker->logarithms_size = size;
  }
  for (gint y = 0; y < height; y++) {
    const guint8 *from = image->data + (gsize) (top + y)
        * (gsize) image->stride + left;
    guint8 *to = tracker->logarithms + (gsize) y * (gsize) width;

    for (gint x = 0; x < width; x++)
      to[x] = tracker->logarithm[from[x]];
  }
  return (View) { {
  tracker->logarithms, width, height, width}
  , (gfloat) left, (gfloat) top};
}

void
cloth_quad_set_logarithms (guint8 logarithm[256])
{
  const gfloat least = logf (LOG_OFFSET), most = logf (255 + LOG_OFFSET);

  for (gint level = 0; level < 256; level++)
    logarithm[level] = (guint8) lrintf (255 * (logf ((gfloat) (level
                    + LOG_OFFSET)) - least) / (most - least));
}

/* The same where light may fall on a square unevenly. */
static gboolean
search_shaded (ClothQuadTracker * tracker, gint column, gint row,
    const gfloat guess_x[4], const gfloat guess_y[4], ClothOutline * outline,
    gfloat * confidence)
{
  const View view = take_logarithms (tracker, guess_x, guess_y);

  return search (tracker, &view, column, row, guess_x, guess_y, LEAST_SHADED,
      outline, confidence)
      && cloth_quad_light (tracker->image, outline->x, outline->y,
      cloth_pattern_is_black (&tracker->pattern, column, row)) <= SHADED;
}

gboolean
cloth_quad_search (ClothQuadTracker * tracker, gint column, gint row,
    const gfloat guess_x[4], const gfloat guess_y[4])
{
  const View filmed = { *tracker->image, 0, 0 };
  const ClothQuadParams *params = tracker->params;
  ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);
  gboolean black = cloth_pattern_is_black (&tracker->pattern, column, row);
  ClothOutline outline;
  gfloat confidence;

  if (cell->refused)
    return FALSE;
  /* Where nothing could be tried as filmed, nothing can be in logarithms. */
  if (!search (tracker, &filmed, column, row, guess_x, guess_y, params->c_low,
          &outline, &confidence) && (!params->link || confidence <= -1
          || !search_shaded (tracker, column, row, guess_x, guess_y, &outline,
              &confidence)))
    return FALSE;
  for (gint k = 0; k < 4; k++)
    if (is_elsewhere (tracker, outline.x[k], outline.y[k],
            column + cloth_quad_corner_column[k],
            row + cloth_quad_corner_row[k]))
      return FALSE;
  return cloth_quad_take (tracker, cell, black, outline.x, outline.y,
      outline.cov, confidence);
}
