/* Surfaces of disparities: holes are filled, whole numbers become fractions.
 *
 * Both make the sum of the squared Laplacian least (Pritchard & Heidrich, “Cloth Motion
 * Capture”, 2003, section 3). A second difference, across or down, counts where all three of
 * its pixels are of one surface. At a border the other one still counts, so that a plane
 * stays one up to its edge. When holes are filled what was measured stays, and the equations
 * are linear: conjugate gradients; else each disparity may move by a half-width: projected
 * Gauss–Seidel. Both go from coarse to fine.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/surface.h"

#include <math.h>
#include <string.h>

#include "gst/vision/disparity/pyramid.h"

/* Pixels without a disparity that hang together across and down. */
typedef struct
{
  guint area;
  gboolean is_filled, has_rim;
} Hole;

/* What a row of the map has. */
typedef struct
{
  gdouble sum;                  /* of its disparities */
  gsize n, n_holes;             /* pixels with one, without one */
} Row;

struct _ClothDisparity
{
  ClothPyramid pyramid;
  gint32 *labels;               /* of each pixel: 1 + its hole, or 0 */
  gint32 *stack;
  gsize area;
  GArray *holes;
  GArray *rows;                 /* Row */

  /* of the map at hand */
  const ClothDisparityParams *params;
  ClothDisparityMap *map;
  ClothPool *pool;
  gdouble mean;
  gboolean filling;
};

/* Returns: steps of 1.5 px, holes of 2000 px, a tolerance of 1e-3, a half-width of 0.5 px
 *   on all levels, 30 sweeps with corrections 1.5 times as large
 */
ClothDisparityParams
cloth_disparity_default_params (void)
{
  return (ClothDisparityParams) {
  1.5, 2000, 1e-3, 0.5, 1, 30, 1.5};
}

/* Returns: (transfer full): memory that is used again for each map of one size
 */
ClothDisparity *
cloth_disparity_new (void)
{
  ClothDisparity *self = g_new0 (ClothDisparity, 1);

  self->holes = g_array_new (FALSE, FALSE, sizeof (Hole));
  self->rows = g_array_new (FALSE, FALSE, sizeof (Row));
  return self;
}

/* @self: (nullable) (transfer full): memory
 */
void
cloth_disparity_free (ClothDisparity * self)
{
  if (!self)
    return;
  cloth_pyramid_clear (&self->pyramid);
  g_free (self->labels);
  g_free (self->stack);
  g_array_unref (self->holes);
  g_array_unref (self->rows);
  g_free (self);
}

static gboolean
check_range (const gchar * name, gdouble value, gdouble least, gdouble most,
    GError ** error)
{
  if (value >= least && value <= most)
    return TRUE;
  g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_PARAMETER,
      "%s is %g: make it %g to %g", name, value, least, most);
  return FALSE;
}

static gboolean
begin (ClothDisparity * self, const ClothDisparityParams * params,
    ClothDisparityMap * map, ClothPool * pool, GError ** error)
{
  if (!cloth_disparity_check_size (map->width, map->height, map->stride, error)
      || !check_range ("step", params->step, 1e-6, CLOTH_DISPARITY_MOST, error)
      || !check_range ("tolerance", params->tolerance, 1e-7, 1, error)
      || !check_range ("half_width", params->half_width, 0, 64, error)
      || !check_range ("narrowing", params->narrowing, 0.1, 1, error)
      || !check_range ("sweeps", params->sweeps, 0, 10000, error)
      || !check_range ("relaxation", params->relaxation, 0.01, 1.99, error))
    return FALSE;
  self->params = params;
  self->map = map;
  self->pool = pool;
  cloth_pyramid_resize (&self->pyramid, map->width, map->height,
      cloth_pool_get_n_threads (pool));
  return TRUE;
}

static void
classify_rows (gpointer data, guint begin, guint end, guint worker)
{
  const ClothDisparity *self = data;
  const ClothDisparityMap *map = self->map;

  for (guint y = begin; y < end; y++) {
    Row row = { 0, 0, 0 };

    for (gint x = 0; x < map->width; x++) {
      const gsize at = (gsize) y * (gsize) map->stride + (gsize) x;
      guint8 *state = &map->states[at];
      const gfloat d = map->disparities[at];

      if (*state == CLOTH_DISPARITY_OUTSIDE)
        continue;
      if (*state != CLOTH_DISPARITY_HOLE && fabsf (d) <= CLOTH_DISPARITY_MOST) {
        if (*state != CLOTH_DISPARITY_FILLED)
          *state = CLOTH_DISPARITY_MEASURED;
        row.sum += (gdouble) d;
        row.n++;
      } else {
        *state = CLOTH_DISPARITY_HOLE;
        row.n_holes++;
      }
    }
    g_array_index (self->rows, Row, y) = row;
  }
}

/* Says of each pixel what it is, and takes the mean of the disparities: numbers about 0 have
 * more digits. Returns: how many have none. */
static gsize
classify (ClothDisparity * self)
{
  gsize n_holes = 0, n = 0;
  gdouble sum = 0;

  g_array_set_size (self->rows, (guint) self->map->height);
  cloth_pool_run (self->pool, classify_rows, self, self->rows->len);
  for (guint y = 0; y < self->rows->len; y++) {
    const Row *row = &g_array_index (self->rows, Row, y);

    sum += row->sum;
    n += row->n;
    n_holes += row->n_holes;
  }
  /* a whole number keeps those of the map */
  self->mean = n > 0 ? floor (sum / (gdouble) n) : 0;
  return n_holes;
}

/* ---- holes ---- */

/* The eight neighbours in a circle. */
static const gint circle[8][2] = { {-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1},
{0, 1}, {-1, 1}, {-1, 0}
};

static gboolean
is_known (const ClothDisparityMap * map, gint x, gint y, gfloat * d)
{
  const gsize at = (gsize) y * (gsize) map->stride + (gsize) x;

  if (x < 0 || y < 0 || x >= map->width || y >= map->height
      || map->states[at] < CLOTH_DISPARITY_MEASURED)
    return FALSE;
  *d = map->disparities[at];
  return TRUE;
}

/* Looks at what is known around a pixel of a hole. Returns: whether there is an edge of
 * depth. */
static gboolean
look_around (const ClothDisparityMap * map, gint x, gint y, gfloat step,
    gboolean * has_rim)
{
  gfloat around[8];
  gboolean known[8], edge = FALSE;

  for (gint i = 0; i < 8; i++) {
    known[i] = is_known (map, x + circle[i][0], y + circle[i][1], &around[i]);
    *has_rim |= known[i];
  }
  for (gint i = 0; i < 8; i++) {
    const gint next = (i + 1) % 8, over = (i + 4) % 8;

    edge |= known[i] && known[next] && fabsf (around[i] - around[next]) > step;
    edge |= known[i] && known[over]
        && fabsf (around[i] - around[over]) > 2 * step;
  }
  return edge;
}

/* The hole that a pixel without label belongs to. */
static Hole
flood (ClothDisparity * self, gint start, gint32 label)
{
  const ClothDisparityMap *map = self->map;
  const gfloat step = (gfloat) self->params->step;
  Hole hole = { 0, TRUE, FALSE };
  gsize n = 0;

  self->labels[start] = label;
  self->stack[n++] = start;
  while (n > 0) {
    const gint at = self->stack[--n];
    const gint x = at % map->width, y = at / map->width;

    hole.area++;
    if (look_around (map, x, y, step, &hole.has_rim))
      hole.is_filled = FALSE;
    for (gint i = 1; i < 8; i += 2) {
      const gint u = x + circle[i][0], v = y + circle[i][1];
      const gint to = v * map->width + u;

      if (u < 0 || v < 0 || u >= map->width || v >= map->height
          || self->labels[to] > 0
          || map->states[(gsize) v * (gsize) map->stride + (gsize) u] !=
          CLOTH_DISPARITY_HOLE)
        continue;
      self->labels[to] = label;
      self->stack[n++] = to;
    }
  }
  hole.is_filled &= hole.has_rim && hole.area <= self->params->hole;
  return hole;
}

/* Returns: whether any hole is to be filled. */
static gboolean
find_holes (ClothDisparity * self)
{
  const ClothDisparityMap *map = self->map;
  const gsize area = (gsize) map->width * (gsize) map->height;
  gboolean any = FALSE;

  if (area > self->area) {
    g_free (self->labels);
    g_free (self->stack);
    self->labels = g_new (gint32, area);
    self->stack = g_new (gint32, area);
    self->area = area;
  }
  memset (self->labels, 0, area * sizeof (*self->labels));
  g_array_set_size (self->holes, 0);
  for (gint y = 0; y < map->height; y++)
    for (gint x = 0; x < map->width; x++) {
      const gint at = y * map->width + x;

      if (map->states[(gsize) y * (gsize) map->stride + (gsize) x] ==
          CLOTH_DISPARITY_HOLE && self->labels[at] == 0) {
        const Hole hole = flood (self, at, (gint32) self->holes->len + 1);

        g_array_append_val (self->holes, hole);
        any |= hole.is_filled;
      }
    }
  return any;
}

/* The hole of a pixel; %NULL if it is in none. */
static Hole *
get_hole (ClothDisparity * self, gsize at)
{
  const gint32 label = self->labels[at];

  return label > 0 ? &g_array_index (self->holes, Hole, label - 1) : NULL;
}

/* ---- in and out ---- */

static guint8
get_flags (const ClothDisparity * self, gboolean filling, gsize from, gsize at)
{
  switch (self->map->states[from]) {
    case CLOTH_DISPARITY_MEASURED:
      return CLOTH_PYRAMID_SURFACE;
    case CLOTH_DISPARITY_FILLED:
      return filling ? CLOTH_PYRAMID_SURFACE :
          CLOTH_PYRAMID_SURFACE | CLOTH_PYRAMID_FREE;
    case CLOTH_DISPARITY_HOLE:
      if (filling && g_array_index (self->holes, Hole, self->labels[at]
              - 1).is_filled)
        return CLOTH_PYRAMID_SURFACE | CLOTH_PYRAMID_FREE;
      return 0;
    default:
      return 0;
  }
}

/* What the pyramid is given of a pixel. */
typedef struct
{
  guint8 flags;
  gfloat given;
} Pixel;

static Pixel
get_pixel (const ClothDisparity * self, gsize x, gsize y)
{
  const ClothDisparityMap *map = self->map;
  const gsize from = y * (gsize) map->stride + x;

  return (Pixel) {
  get_flags (self, self->filling, from, y * (gsize) map->width + x),
        map->states[from] >= CLOTH_DISPARITY_MEASURED ?
        map->disparities[from] - (gfloat) self->mean : 0};
}

/* Whether two neighbours are of one surface. What is to be filled has no disparity yet. */
static gboolean
is_linked (const ClothDisparity * self, Pixel a, Pixel b)
{
  return a.flags & b.flags & CLOTH_PYRAMID_SURFACE && ((self->filling
          && (a.flags | b.flags) & CLOTH_PYRAMID_FREE)
      || fabsf (a.given - b.given) <= (gfloat) self->params->step);
}

static void
load_rows (gpointer data, guint begin, guint end, guint worker)
{
  const ClothDisparity *self = data;
  const ClothPyramidLevel *level = &self->pyramid.levels[0];
  const gsize width = (gsize) level->width, height = (gsize) level->height;

  for (gsize y = begin; y < end; y++) {
    Pixel here = get_pixel (self, 0, y);

    for (gsize x = 0; x < width; x++) {
      const gsize at = y * width + x;
      Pixel right = { 0, 0 };

      level->given[at] = here.given;
      level->flags[at] = here.flags;
      if (x + 1 < width) {
        right = get_pixel (self, x + 1, y);
        if (is_linked (self, here, right))
          level->flags[at] |= CLOTH_PYRAMID_RIGHT;
      }
      if (here.flags && y + 1 < height && is_linked (self, here,
              get_pixel (self, x, y + 1)))
        level->flags[at] |= CLOTH_PYRAMID_DOWN;
      here = right;
    }
  }
}

static void
load (ClothDisparity * self, gboolean filling)
{
  self->filling = filling;
  cloth_pool_run (self->pool, load_rows, self, (guint) self->map->height);
}

/* Surfaces that were found, back to the map. */
static void
unload_rows (gpointer data, guint begin, guint end, guint worker)
{
  const ClothDisparity *self = data;
  const ClothDisparityMap *map = self->map;

  for (gsize y = begin; y < end; y++)
    for (gsize x = 0; x < (gsize) map->width; x++) {
      const gsize to = y * (gsize) map->stride + x;

      if (map->states[to] >= CLOTH_DISPARITY_MEASURED)
        map->disparities[to] =
            self->pyramid.levels[0].found[y * (gsize) map->width + x]
            + (gfloat) self->mean;
    }
}

/* A hole that became steeper than a surface can be had an edge of depth in it. */
static void
check_slopes (ClothDisparity * self)
{
  const ClothPyramidLevel *level = &self->pyramid.levels[0];
  const gsize width = (gsize) level->width, height = (gsize) level->height;
  const gfloat step = (gfloat) self->params->step;

  for (gsize y = 0; y < height; y++)
    for (gsize x = 0; x < width; x++)
      for (gint down = 0; down < 2; down++) {
        const gsize at = y * width + x, next = at + (down ? width : 1);
        Hole *hole;

        if (!(level->flags[at] & (down ? CLOTH_PYRAMID_DOWN :
                    CLOTH_PYRAMID_RIGHT))
            || fabsf (level->found[at] - level->found[next]) <= step)
          continue;
        if ((hole = get_hole (self, at)))
          hole->is_filled = FALSE;
        if ((hole = get_hole (self, next)))
          hole->is_filled = FALSE;
      }
}

/* @self: memory
 * @params: %step, %hole and %tolerance
 * @map: (inout): disparities, and states
 * @pool: (nullable): threads
 * @level: vector instructions
 * @error: (out): set on failure
 *
 * Holes of the mask get disparities that join those around smoothly. Holes that are larger
 * than %hole, that lie at an edge of depth or away from anything known stay, with NaN.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_disparity_fill (ClothDisparity * self,
    const ClothDisparityParams * params, ClothDisparityMap * map,
    ClothPool * pool, ClothSimd level, GError ** error)
{
  const ClothPyramidParams how = { 0, 1, 0, 1, params->tolerance };
  gboolean any;

  if (!begin (self, params, map, pool, error))
    return FALSE;
  if (classify (self) == 0)
    return TRUE;
  any = find_holes (self);
  if (any) {
    load (self, TRUE);
    cloth_pyramid_solve (&self->pyramid, &how, pool, level);
    check_slopes (self);
  }
  for (gint y = 0; y < map->height; y++)
    for (gint x = 0; x < map->width; x++) {
      const gsize at = (gsize) y * (gsize) map->width + (gsize) x;
      const gsize to = (gsize) y * (gsize) map->stride + (gsize) x;
      const Hole *hole = get_hole (self, at);

      if (!hole)
        continue;
      map->disparities[to] = hole->is_filled ?
          self->pyramid.levels[0].found[at] + (gfloat) self->mean : NAN;
      if (hole->is_filled)
        map->states[to] = CLOTH_DISPARITY_FILLED;
    }
  return TRUE;
}

/* @self: memory
 * @params: %step, %half_width, %sweeps and %relaxation
 * @map: (inout): disparities
 * @pool: (nullable): threads
 * @level: vector instructions
 * @error: (out): set on failure
 *
 * Moves each measured disparity by at most %half_width, and filled ones freely, to where the
 * squared Laplacian is least.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_disparity_smooth (ClothDisparity * self,
    const ClothDisparityParams * params, ClothDisparityMap * map,
    ClothPool * pool, ClothSimd level, GError ** error)
{
  const ClothPyramidParams how = { params->half_width, params->narrowing,
    params->sweeps, params->relaxation, params->tolerance
  };

  if (!begin (self, params, map, pool, error))
    return FALSE;
  classify (self);
  load (self, FALSE);
  cloth_pyramid_solve (&self->pyramid, &how, pool, level);
  cloth_pool_run (pool, unload_rows, self, (guint) map->height);
  return TRUE;
}
