/* The least squared Laplacian from coarse to fine.
 *
 * A level's pixels are every second one of the next larger level. Two of them are neighbours
 * on one surface if the way between them is: what an edge of depth parts stays apart at all
 * sizes. What was given is blurred by (1 2 1)/4 across and down before it is thinned out;
 * what is found is interpolated by cubics. Both keep planes as they are.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/pyramid.h"

#include <math.h>
#include <string.h>

/* The smallest edge that is halved. */
#define LEAST_EDGE 16
/* Work is shared out from so many pixels on, and of equations from so many busy chunks on:
 * else waking other threads takes longer. */
#define FEW_PIXELS 16384
#define FEW_CHUNKS 4096
/* Planes of a level in phases. */
#define N_PLANES 9
/* The most steps of conjugate gradients on a level. */
#define MOST_STEPS 1000

#define SURFACE CLOTH_PYRAMID_SURFACE
#define RIGHT CLOTH_PYRAMID_RIGHT
#define DOWN CLOTH_PYRAMID_DOWN
#define FREE CLOTH_PYRAMID_FREE

/* ---- memory ---- */

static gint
get_phase (gint width)
{
  const gint chunks = (width + 3 * CLOTH_DISPARITY_CHUNK - 1)
      / (3 * CLOTH_DISPARITY_CHUNK);

  return (chunks + 1) * CLOTH_DISPARITY_CHUNK;
}

static gsize
get_plane_size (gint width, gint height)
{
  return (gsize) (height + 2 * CLOTH_DISPARITY_ROWS + 1) * 3
      * (gsize) get_phase (width);
}

static gsize
get_n_chunks (gint width, gint height)
{
  return (gsize) height *3 * (gsize) (get_phase (width)
      / CLOTH_DISPARITY_CHUNK - 1);
}

static void
lay_out (ClothPyramidLevel * level, gfloat ** floats, guint8 ** flags,
    guint16 ** busy, gint ** n_busy)
{
  ClothDisparityPlanes *planes = &level->planes;
  gfloat **all[N_PLANES] = { &planes->x, &planes->low, &planes->high,
    &planes->gain, &planes->h, &planes->v, &planes->residual,
    &planes->direction, &planes->product
  };
  const gsize area = (gsize) level->width * (gsize) level->height;

  planes->phase = get_phase (level->width);
  planes->chunks = planes->phase / CLOTH_DISPARITY_CHUNK - 1;
  for (guint i = 0; i < N_PLANES; i++) {
    *all[i] = *floats + CLOTH_DISPARITY_ROWS * 3 * planes->phase
        + CLOTH_DISPARITY_CHUNK;
    *floats += get_plane_size (level->width, level->height);
  }
  level->given = *floats;
  level->found = *floats + area;
  *floats += 2 * area;
  level->flags = *flags;
  *flags += area;
  planes->busy = *busy;
  *busy += get_n_chunks (level->width, level->height);
  planes->n_busy = *n_busy;
  *n_busy += level->height;
}

/* @self: pyramid, all 0 before its first use
 * @width: of the largest level
 * @height: of it
 * @n_workers: threads that will work on it
 *
 * Makes room; nothing is done if there is as much already.
 */
void
cloth_pyramid_resize (ClothPyramid * self, gint width, gint height,
    guint n_workers)
{
  gsize n_floats = 0, n_flags = 0, n_chunks = 0, n_rows = 0;
  gfloat *floats;
  guint8 *flags;
  guint16 *busy;
  gint *n_busy;

  if (self->width == width && self->height == height
      && self->n_workers >= n_workers)
    return;
  cloth_pyramid_clear (self);
  self->width = width;
  self->height = height;
  self->n_workers = n_workers;
  for (gint w = width, h = height; TRUE; w = (w + 1) / 2, h = (h + 1) / 2) {
    const gsize area = (gsize) w * (gsize) h;
    ClothPyramidLevel *level = &self->levels[self->n_levels++];

    level->width = w;
    level->height = h;
    n_floats += N_PLANES * get_plane_size (w, h) + 2 * area;
    n_flags += area;
    n_chunks += get_n_chunks (w, h);
    n_rows += (gsize) h;
    if (MIN (w, h) < LEAST_EDGE || self->n_levels == CLOTH_PYRAMID_LEVELS)
      break;
  }
  self->memory = floats = g_new0 (gfloat, n_floats);
  self->flags = flags = g_new0 (guint8, n_flags);
  self->busy = busy = g_new0 (guint16, n_chunks);
  self->n_busy = n_busy = g_new0 (gint, n_rows);
  self->sums = g_new (gdouble, height);
  self->rows = g_new (gfloat, (gsize) n_workers * 5 * (gsize) width);
  for (gint i = 0; i < self->n_levels; i++)
    lay_out (&self->levels[i], &floats, &flags, &busy, &n_busy);
}

/* @self: pyramid; it is all 0 again
 */
void
cloth_pyramid_clear (ClothPyramid * self)
{
  g_free (self->memory);
  g_free (self->flags);
  g_free (self->busy);
  g_free (self->n_busy);
  g_free (self->sums);
  g_free (self->rows);
  memset (self, 0, sizeof (*self));
}

/* ---- work on rows ---- */

typedef struct
{
  ClothPyramid *self;
  const ClothPyramidParams *params;
  const ClothDisparityKernels *kernels;
  ClothPool *pool;
  ClothPyramidLevel *level, *other;
  gboolean is_little;
  gint colour;                  /* rows 3·i + colour */
  gfloat factor;
} Work;

static void
share_out (Work * work, ClothPoolFunc func, gint n)
{
  if (n > 0)
    cloth_pool_run (work->is_little ? NULL : work->pool, func, work, (guint) n);
}

static gdouble
add_rows (const Work * work)
{
  gdouble sum = 0;

  for (gint y = 0; y < work->level->height; y++)
    sum += work->self->sums[y];
  return sum;
}

/* ---- from fine to coarse ---- */

static inline gboolean
is_given (guint8 flags)
{
  return (flags & (SURFACE | FREE)) == SURFACE;
}

/* The disparity of a pixel, blurred across. */
static inline gfloat
blur_across (const ClothPyramidLevel * level, gint x, gsize at)
{
  const guint8 *flags = level->flags + at;
  const gfloat *given = level->given + at;

  if (x > 0 && x + 1 < level->width && flags[-1] & RIGHT && flags[0] & RIGHT
      && is_given (flags[-1]) && is_given (flags[1]))
    return 0.25f * (given[-1] + given[1]) + 0.5f * given[0];
  return given[0];
}

static gfloat
blur (const ClothPyramidLevel * level, gint x, gint y)
{
  const gsize width = (gsize) level->width;
  const gsize at = (gsize) y * width + (gsize) x;
  const guint8 *flags = level->flags + at;

  if (!is_given (*flags))
    return level->given[at];
  if (y > 0 && y + 1 < level->height && *(flags - width) & DOWN
      && *flags & DOWN && is_given (*(flags - width))
      && is_given (flags[width]))
    return 0.25f * (blur_across (level, x, at - width)
        + blur_across (level, x, at + width))
        + 0.5f * blur_across (level, x, at);
  return blur_across (level, x, at);
}

/* Rows of work->level out of the larger work->other. */
static void
coarsen (gpointer data, guint begin, guint end, guint worker)
{
  Work *work = data;
  const ClothPyramidLevel *fine = work->other;
  ClothPyramidLevel *level = work->level;

  for (gint y = (gint) begin; y < (gint) end; y++)
    for (gint x = 0; x < level->width; x++) {
      const gsize at = (gsize) y * (gsize) level->width + (gsize) x;
      const gsize from = (gsize) 2 * (gsize) y * (gsize) fine->width
          + (gsize) (2 * x);
      const guint8 *flags = fine->flags + from;
      guint8 to = *flags & (SURFACE | FREE);

      if (x + 1 < level->width && flags[0] & RIGHT && flags[1] & RIGHT)
        to |= RIGHT;
      if (y + 1 < level->height && flags[0] & DOWN && flags[fine->width] & DOWN)
        to |= DOWN;
      level->flags[at] = to;
      level->given[at] = blur (fine, 2 * x, 2 * y);
    }
}

/* ---- from coarse to fine ---- */

/* Cubic interpolation in the middle of four, linear of two. */
static inline gfloat
middle (gfloat a, gfloat b, gfloat c, gfloat d)
{
  return 0.5625f * (b + c) - 0.0625f * (a + d);
}

/* A pixel between two others of its line, @step away, which are linked to it or not; those
 * beyond are 3·@step away. */
static inline gfloat
between (const gfloat * found, gsize step, gboolean before, gboolean after,
    gboolean far_before, gboolean far_after, gfloat given)
{
  if (before && after)
    return far_before && far_after ? middle (*(found - 3 * step),
        *(found - step), found[step], found[3 * step]) :
        0.5f * (*(found - step) + found[step]);
  if (before)
    return *(found - step) + (far_before ? 0.5f * (*(found - step)
            - *(found - 3 * step)) : 0);
  if (after)
    return found[step] + (far_after ? 0.5f * (found[step]
            - found[3 * step]) : 0);
  return given;
}

/* Even rows of work->level out of the smaller work->other. */
static void
refine_across (gpointer data, guint begin, guint end, guint worker)
{
  Work *work = data;
  const ClothPyramidLevel *coarse = work->other;
  ClothPyramidLevel *level = work->level;
  const gint width = level->width;

  for (gsize y = begin; y < end; y++) {
    const gfloat *from = coarse->found + y * (gsize) coarse->width;
    const gsize at = 2 * y * (gsize) width;
    const guint8 *flags = level->flags + at;
    gfloat *to = level->found + at;

    for (gint x = 0; x < width; x += 2)
      to[x] = from[x / 2];
    for (gint x = 1; x < width; x += 2) {
      const gboolean before = flags[x - 1] & RIGHT, after = flags[x] & RIGHT;

      to[x] = between (to + x, 1, before, after,
          before && x >= 3 && flags[x - 2] & RIGHT && flags[x - 3] & RIGHT,
          after && x + 3 < width && flags[x + 1] & RIGHT
          && flags[x + 2] & RIGHT, level->given[at + (gsize) x]);
    }
  }
}

/* Odd rows out of the even ones. */
static void
refine_down (gpointer data, guint begin, guint end, guint worker)
{
  Work *work = data;
  ClothPyramidLevel *level = work->level;
  const gsize width = (gsize) level->width;

  for (guint i = begin; i < end; i++) {
    const gint y = 2 * (gint) i + 1;

    for (gsize x = 0; x < width; x++) {
      const gsize at = (gsize) y * width + x;
      const guint8 *flags = level->flags + at;
      const gboolean before = *(flags - width) & DOWN, after = *flags & DOWN;

      level->found[at] = between (level->found + at, width, before, after,
          before && y >= 3 && *(flags - 2 * width) & DOWN
          && *(flags - 3 * width) & DOWN,
          after && y + 3 < level->height && flags[width] & DOWN
          && flags[2 * width] & DOWN, level->given[at]);
    }
  }
}

/* ---- one level ---- */

static void
pack_rows (gpointer data, guint begin, guint end, guint worker)
{
  Work *work = data;
  ClothPyramidLevel *level = work->level;
  ClothDisparityPlanes *planes = &level->planes;
  const ClothDisparityKernels *kernels = work->kernels;
  const gfloat b = (gfloat) (work->params->half_width
      * pow (work->params->narrowing, (gdouble) (level - work->self->levels)));
  const gint width = level->width;
  gfloat *low = work->self->rows + (gsize) worker * 5 * (gsize) width;
  gfloat *high = low + width, *gain = high + width;
  gfloat *h = gain + width, *v = h + width;

  for (gint y = (gint) begin; y < (gint) end; y++) {
    const gsize at = (gsize) y * (gsize) width;
    const guint8 *flags = level->flags + at;
    const guint8 *above = y > 0 ? flags - width : NULL;
    const gfloat *given = level->given + at;
    gfloat *found = level->found + at;

    for (gint x = 0; x < width; x++) {
      const gboolean is_free = flags[x] & FREE;

      low[x] = is_free ? -CLOTH_DISPARITY_FAR : given[x] - b;
      high[x] = is_free ? CLOTH_DISPARITY_FAR : given[x] + b;
      found[x] = CLAMP (found[x], low[x], high[x]);
      gain[x] = flags[x] & SURFACE && (is_free || b > 0) ? 1 : 0;
      h[x] = x > 0 && flags[x - 1] & RIGHT && flags[x] & RIGHT ? 1 : 0;
      v[x] = above && above[x] & DOWN && flags[x] & DOWN ? 1 : 0;
    }
    kernels->pack (planes, found, width, y, planes->x);
    kernels->pack (planes, low, width, y, planes->low);
    kernels->pack (planes, high, width, y, planes->high);
    kernels->pack (planes, gain, width, y, planes->gain);
    kernels->pack (planes, h, width, y, planes->h);
    kernels->pack (planes, v, width, y, planes->v);
    /* what is idle now may not have been so before */
    if (!(b > 0))
      memset (planes->direction + (gsize) y * 3 * (gsize) planes->phase, 0,
          3 * (gsize) planes->phase * sizeof (gfloat));
  }
}

static void
prepare_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Work *work = data;

  for (guint y = begin; y < end; y++)
    work->kernels->prepare (&work->level->planes, (gint) y);
}

static void
unpack_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Work *work = data;
  ClothPyramidLevel *level = work->level;

  for (guint y = begin; y < end; y++)
    work->kernels->unpack (&level->planes, level->planes.x, level->width,
        (gint) y, level->found + (gsize) y * (gsize) level->width);
}

static void
relax_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Work *work = data;

  for (guint i = begin; i < end; i++)
    work->kernels->relax (&work->level->planes, 3 * (gint) i + work->colour,
        work->factor);
}

static void
relax (Work * work)
{
  work->factor = (gfloat) work->params->relaxation;
  for (guint sweep = 0; sweep < work->params->sweeps; sweep++)
    for (work->colour = 0; work->colour < 3; work->colour++)
      share_out (work, relax_rows, (work->level->height + 2
              - work->colour) / 3);
}

/* ---- conjugate gradients (with the diagonal as preconditioner) ---- */

static void
residual_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Work *work = data;

  for (guint y = begin; y < end; y++)
    work->self->sums[y] = work->kernels->residual (&work->level->planes,
        (gint) y);
}

static void
apply_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Work *work = data;

  for (guint y = begin; y < end; y++)
    work->self->sums[y] = work->kernels->apply (&work->level->planes, (gint) y);
}

static void
step_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Work *work = data;

  for (guint y = begin; y < end; y++)
    work->self->sums[y] = work->kernels->step (&work->level->planes, (gint) y,
        work->factor);
}

static void
turn_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Work *work = data;

  for (guint y = begin; y < end; y++)
    work->kernels->turn (&work->level->planes, (gint) y, work->factor);
}

/* The right side of the equations is what x = 0 leaves. */
static gdouble
get_right_side (Work * work)
{
  ClothDisparityPlanes *planes = &work->level->planes;
  gfloat *const x = planes->x;
  gdouble sum;

  for (gint y = 0; y < work->level->height; y++)
    for (gint i = 0; i < 3 * planes->phase; i++) {
      const gssize at = (gssize) y * 3 * planes->phase + i;

      planes->product[at] = planes->gain[at] > 0 ? 0 : x[at];
    }
  planes->x = planes->product;
  share_out (work, residual_rows, work->level->height);
  sum = add_rows (work);
  planes->x = x;
  return sum;
}

static void
descend (Work * work)
{
  const gint height = work->level->height;
  const gdouble tolerance = work->params->tolerance;
  const gdouble least = tolerance * tolerance * get_right_side (work);
  gdouble left;

  share_out (work, residual_rows, height);
  left = add_rows (work);
  work->factor = 0;
  share_out (work, turn_rows, height);
  for (gint i = 0; i < MOST_STEPS && left > least; i++) {
    gdouble curvature, next;

    share_out (work, apply_rows, height);
    curvature = add_rows (work);
    if (!(curvature > 0))
      break;
    work->factor = (gfloat) (left / curvature);
    share_out (work, step_rows, height);
    next = add_rows (work);
    work->factor = (gfloat) (next / left);
    left = next;
    share_out (work, turn_rows, height);
  }
}

static gboolean
is_little (const ClothPyramidLevel * level)
{
  return level->width * level->height < FEW_PIXELS;
}

static void
solve_level (Work * work)
{
  const gint height = work->level->height;
  gint n = 0;

  share_out (work, pack_rows, height);
  share_out (work, prepare_rows, height);
  for (gint y = 0; y < height; y++)
    n += work->level->planes.n_busy[y];
  work->is_little |= n < FEW_CHUNKS;
  if (work->params->half_width > 0)
    relax (work);
  else
    descend (work);
  work->is_little = is_little (work->level);
  share_out (work, unpack_rows, height);
}

/* @self: pyramid with flags and given disparities on its largest level; of free pixels they
 *   are a first guess
 * @params: how
 * @pool: (nullable): threads
 * @level: vector instructions
 *
 * Finds the disparities of the largest level.
 */
void
cloth_pyramid_solve (ClothPyramid * self, const ClothPyramidParams * params,
    ClothPool * pool, ClothSimd level)
{
  Work work = { self, params, CLOTH_SIMD_TABLE (cloth_disparity_kernels,
        level), pool, NULL, NULL, FALSE, 0, 0
  };
  ClothPyramidLevel *levels = self->levels;
  ClothPyramidLevel *last = &levels[self->n_levels - 1];

  for (gint i = 1; i < self->n_levels; i++) {
    work.level = &levels[i];
    work.other = &levels[i - 1];
    work.is_little = is_little (work.level);
    share_out (&work, coarsen, work.level->height);
  }
  memcpy (last->found, last->given, sizeof (*last->found)
      * (gsize) last->width * (gsize) last->height);
  for (gint i = self->n_levels - 1; i >= 0; i--) {
    work.level = &levels[i];
    work.is_little = is_little (work.level);
    if (work.level != last) {
      work.other = &levels[i + 1];
      share_out (&work, refine_across, (work.level->height + 1) / 2);
      share_out (&work, refine_down, work.level->height / 2);
    }
    solve_level (&work);
  }
}
