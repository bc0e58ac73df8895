/* uv of each pixel.
 *
 * D. Pritchard and W. Heidrich (2003), section 5. The triangles between matched places are
 * split into four where the straight line of an edge, laid on the surface, is half as long
 * as the whole (equation 6); uv of that point is the mean of the edge's ends. What holds one
 * pixel is flat. So uv runs evenly along the surface, and not along the picture.
 *
 * An edge is split from its left to its right end, whichever triangle asks: both sides get
 * the same bits. Each pixel is of one triangle, so that threads never write the same one.
 *
 * Beyond the triangles uv goes on pixel by pixel along the surface, by the slope around the
 * nearest place, each step as long on the flat cloth as on the surface.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/uv/dense.h"

#include <math.h>
#include <string.h>

#include "gst/vision/uv/place.h"

/* Step of the walk along an edge, px, and most steps of it. */
#define STEP 2.0
#define STEPS 128
/* A triangle whose edges are all shorter than this is flat, px: as the paper's, of one pixel,
 * within a hundredth of a millimetre, and twice as fast. */
#define FLAT 3.0
/* Splits of a triangle at most: 2¹⁶ px is more than any picture has. */
#define DEPTH 16
/* Triangles that a thread does at a time. */
#define CHUNK 64
#define NONE G_MAXUINT32

typedef struct
{
  gdouble at[2], uv[2], point[3];
} Corner;

typedef struct
{
  gint x, y;
} Pixel;

typedef struct
{
  GArray *pixels;               /* Pixel: of one triangle */
  guint n_between;
} Worker;

struct _ClothUV
{
  ClothUVPlaces *places;
  GArray *owners;               /* guint32 of each pixel: triangle, later the place next to it */
  GArray *front, *next;         /* guint32: pixels */
  GArray *steps;                /* Step: of the front's pixels */
  GArray *workers;              /* Worker */
  ClothUVNet net;               /* of the last run */
};

/* What a pixel of the front gets. */
typedef struct
{
  gdouble uv[2];
  guint32 owner;
} Step;

typedef struct
{
  ClothUV *self;
  ClothUVParams params;
  const ClothMatchSurface *surface;
  ClothUVNet net;
  guint32 *owners;
  gfloat *uv;
} Run;

/* Returns: as measured on rendered cloth, 1.1 mm a pixel
 */
ClothUVParams
cloth_uv_default_params (void)
{
  ClothUVParams params = { 2, 5, 0.6, 80, 8, cloth_stretch_default_params () };

  params.stretch.stretch = 0.3;
  params.stretch.slack = 2;
  return params;
}

static ClothUVParams
clamp_params (const ClothUVParams * params)
{
  return (ClothUVParams) {
  CLAMP (params->together, 0, 100),
        params->outlier > 0 ? MAX (params->outlier, 1) : 0,
        CLAMP (params->smooth, 0, 1), MAX (params->longest, 1),
        CLAMP (params->reach, 0, 1000),
        cloth_stretch_clamp_params (&params->stretch)};
}

/* Returns: (transfer full): room for the pixels of one picture at a time
 */
ClothUV *
cloth_uv_new (void)
{
  ClothUV *self = g_new0 (ClothUV, 1);

  self->places = cloth_uv_places_new ();
  self->owners = g_array_new (FALSE, FALSE, sizeof (guint32));
  self->front = g_array_new (FALSE, FALSE, sizeof (guint32));
  self->next = g_array_new (FALSE, FALSE, sizeof (guint32));
  self->steps = g_array_new (FALSE, FALSE, sizeof (Step));
  self->workers = g_array_new (FALSE, TRUE, sizeof (Worker));
  return self;
}

/* @self: (nullable) (transfer full): what to free
 */
void
cloth_uv_free (ClothUV * self)
{
  if (!self)
    return;
  for (guint i = 0; i < self->workers->len; i++)
    g_array_unref (g_array_index (self->workers, Worker, i).pixels);
  cloth_uv_places_free (self->places);
  g_array_unref (self->owners);
  g_array_unref (self->front);
  g_array_unref (self->next);
  g_array_unref (self->steps);
  g_array_unref (self->workers);
  g_free (self);
}

static const gfloat *
point_at (const Run * run, gint x, gint y)
{
  return run->surface->points + 3 * ((gsize) y * run->surface->stride + x);
}

/* ---- which triangle a pixel is of ---- */

/* @at: a point of it
 * @step: from there to another one
 * @turned: whether the inner side is the right one
 *
 * A line between two places. Both triangles along it have the same one, but for @turned, so
 * that a pixel on it is of one of them only.
 */
typedef struct
{
  gdouble at[2], step[2];
  gboolean turned;
} Line;

static Line
get_line (const ClothUVPlace * a, const ClothUVPlace * b)
{
  const gboolean turned = a > b;
  const gdouble *p = (turned ? b : a)->at, *q = (turned ? a : b)->at;

  return (Line) { {
  p[0], p[1]}
  , {
  q[0] - p[0], q[1] - p[1]}
  , turned};
}

static inline gboolean
is_inside (const Line * line, gdouble x, gdouble y)
{
  const gdouble s = line->step[0] * (y - line->at[1])
      - line->step[1] * (x - line->at[0]);

  return line->turned ? s < 0 : s >= 0;
}

/* The rectangle of pixels around a triangle: left, top, right, bottom. */
static void
get_box (const Run * run, const ClothUVPlace * const corners[3], gint box[4])
{
  gdouble low[2], high[2];

  for (gint c = 0; c < 2; c++) {
    low[c] = MIN (MIN (corners[0]->at[c], corners[1]->at[c]),
        corners[2]->at[c]);
    high[c] = MAX (MAX (corners[0]->at[c], corners[1]->at[c]),
        corners[2]->at[c]);
  }
  box[0] = MAX ((gint) ceil (low[0]), 0);
  box[1] = MAX ((gint) ceil (low[1]), 0);
  box[2] = MIN ((gint) floor (high[0]), run->surface->width - 1);
  box[3] = MIN ((gint) floor (high[1]), run->surface->height - 1);
}

static void
get_corners (const Run * run, guint triangle, const ClothUVPlace * corners[3])
{
  for (gint k = 0; k < 3; k++)
    corners[k] = &run->net.places[run->net.triangles[3 * triangle + k]];
}

/* Gives each pixel whose surface is known its triangle. Where the rounding of the
 * triangulation lets two have it, the later one does. */
static void
share_out (const Run * run)
{
  for (guint t = 0; t < run->net.n_triangles; t++) {
    const ClothUVPlace *c[3];
    Line lines[3];
    gint box[4];

    get_corners (run, t, c);
    get_box (run, c, box);
    for (gint k = 0; k < 3; k++)
      lines[k] = get_line (c[k], c[(k + 1) % 3]);
    for (gint y = box[1]; y <= box[3]; y++)
      for (gint x = box[0]; x <= box[2]; x++)
        if (is_inside (&lines[0], x, y) && is_inside (&lines[1], x, y)
            && is_inside (&lines[2], x, y))
          run->owners[(gsize) y * run->surface->width + x] = t;
  }
}

/* ---- inside a triangle ---- */

static inline gdouble
distance (const gdouble a[3], const gdouble b[3])
{
  const gdouble x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];

  return sqrt (x * x + y * y + z * z);
}

/* The surface between its four nearest points, as cloth_surface_get_point (), which does
 * what is rare. */
static inline gboolean
get_point (const Run * run, gdouble x, gdouble y, gdouble point[3])
{
  const ClothMatchSurface *surface = run->surface;
  const gint x0 = (gint) x, y0 = (gint) y;

  if (x >= 0 && y >= 0 && x0 < surface->width - 1 && y0 < surface->height - 1) {
    const gfloat *p = surface->points + 3 * ((gsize) y0 * surface->stride + x0);
    const gfloat *q = p + 3 * surface->stride;
    const gfloat low = MIN (MIN (p[2], p[5]), MIN (q[2], q[5]));
    const gfloat high = MAX (MAX (p[2], p[5]), MAX (q[2], q[5]));
    const gdouble s = x - x0, t = y - y0;
    const gdouble w[4] = { (1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t };

    if (high - low <= run->params.stretch.depth_step
        && isfinite (p[2] + p[5] + q[2] + q[5])) {
      for (gint c = 0; c < 3; c++)
        point[c] = w[0] * p[c] + w[1] * p[c + 3] + w[2] * q[c]
            + w[3] * q[c + 3];
      return TRUE;
    }
  }
  return cloth_surface_get_point (surface, x, y,
      run->params.stretch.depth_step, point);
}

/* Puts the point that halves an edge along the surface into @m; FALSE where the surface is
 * broken between its ends. */
static gboolean
halve (const Run * run, const Corner * a, const Corner * b, Corner * m)
{
  const gdouble depth_step = run->params.stretch.depth_step;
  gdouble points[STEPS + 1][3], lengths[STEPS + 1];
  gdouble dx, dy, half, t, share;
  gint n, k;

  if (b->at[0] < a->at[0] || (b->at[0] == a->at[0] && b->at[1] < a->at[1])) {
    const Corner *swap = a;

    a = b;
    b = swap;
  }
  dx = b->at[0] - a->at[0];
  dy = b->at[1] - a->at[1];
  n = CLAMP ((gint) ceil (sqrt (dx * dx + dy * dy) / STEP), 2, STEPS);
  share = 1. / n;
  memcpy (points[0], a->point, sizeof points[0]);
  memcpy (points[n], b->point, sizeof points[0]);
  lengths[0] = 0;
  for (k = 1; k <= n; k++) {
    if (k < n && !get_point (run, a->at[0] + dx * k * share,
            a->at[1] + dy * k * share, points[k]))
      return FALSE;
    if (!(fabs (points[k][2] - points[k - 1][2]) <= depth_step))
      return FALSE;
    lengths[k] = lengths[k - 1] + distance (points[k], points[k - 1]);
  }
  half = lengths[n] / 2;
  for (k = 1; k < n && lengths[k] < half; k++);
  t = lengths[k] > lengths[k - 1] ?
      (half - lengths[k - 1]) / (lengths[k] - lengths[k - 1]) : 0.5;
  m->at[0] = a->at[0] + dx * (k - 1 + t) * share;
  m->at[1] = a->at[1] + dy * (k - 1 + t) * share;
  for (gint c = 0; c < 2; c++)
    m->uv[c] = (a->uv[c] + b->uv[c]) / 2;
  for (gint c = 0; c < 3; c++)
    m->point[c] = (1 - t) * points[k - 1][c] + t * points[k][c];
  return TRUE;
}

static inline gdouble
area (const gdouble a[2], const gdouble b[2], gdouble x, gdouble y)
{
  return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

/* uv of a pixel in a flat triangle; none where the pixel is of another surface. */
static void
interpolate (const Run * run, Worker * worker, const Corner * const c[3],
    Pixel pixel)
{
  const gdouble x = pixel.x, y = pixel.y;
  gfloat *uv = run->uv + 2 * ((gsize) pixel.y * run->surface->width + pixel.x);
  const gdouble z = point_at (run, pixel.x, pixel.y)[2];
  const gdouble low = MIN (MIN (c[0]->point[2], c[1]->point[2]),
      c[2]->point[2]);
  const gdouble high = MAX (MAX (c[0]->point[2], c[1]->point[2]),
      c[2]->point[2]);
  const gdouble depth_step = run->params.stretch.depth_step;
  const gdouble whole = area (c[0]->at, c[1]->at, c[2]->at[0], c[2]->at[1]);
  gdouble w[3];

  if (!(z >= low - depth_step && z <= high + depth_step))
    return;
  w[0] = area (c[1]->at, c[2]->at, x, y) / whole;
  w[1] = area (c[2]->at, c[0]->at, x, y) / whole;
  if (!(whole > 0) || !isfinite (w[0] + w[1]))
    w[0] = w[1] = 1 / 3.;
  w[2] = 1 - w[0] - w[1];
  for (gint k = 0; k < 2; k++)
    uv[k] = (gfloat) (w[0] * c[0]->uv[k] + w[1] * c[1]->uv[k]
        + w[2] * c[2]->uv[k]);
  worker->n_between++;
}

/* Moves the pixels beyond the line from @a to @b to the front; returns how many. */
static guint
cut (Pixel * pixels, guint n, const Corner * a, const Corner * b)
{
  guint n_beyond = 0;

  for (guint i = 0; i < n; i++)
    if (area (a->at, b->at, pixels[i].x, pixels[i].y) < 0) {
      const Pixel pixel = pixels[i];

      pixels[i] = pixels[n_beyond];
      pixels[n_beyond++] = pixel;
    }
  return n_beyond;
}

static gboolean
is_small (const Corner * const c[3])
{
  for (gint k = 0; k < 3; k++) {
    const gdouble dx = c[(k + 1) % 3]->at[0] - c[k]->at[0];
    const gdouble dy = c[(k + 1) % 3]->at[1] - c[k]->at[1];

    if (dx * dx + dy * dy > FLAT * FLAT)
      return FALSE;
  }
  return TRUE;
}

static void
descend (const Run * run, Worker * worker, const Corner * const c[3],
    Pixel * pixels, guint n, guint depth)
{
  Corner m[3];                  /* of the edge after each corner */

  if (n == 0)
    return;
  if (n == 1 || depth == DEPTH || is_small (c)) {
    for (guint i = 0; i < n; i++)
      interpolate (run, worker, c, pixels[i]);
    return;
  }
  for (gint k = 0; k < 3; k++)
    if (!halve (run, c[k], c[(k + 1) % 3], &m[k]))
      return;
  for (gint k = 0; k < 3; k++) {
    const Corner *before = &m[(k + 2) % 3];
    const Corner *part[3] = { c[k], &m[k], before };
    const guint n_part = cut (pixels, n, before, &m[k]);

    descend (run, worker, part, pixels, n_part, depth + 1);
    pixels += n_part;
    n -= n_part;
  }
  descend (run, worker, (const Corner *[3]) {
        &m[0], &m[1], &m[2]
      }, pixels, n, depth + 1);
}

static void
do_triangles (gpointer data, guint begin, guint end, guint index)
{
  const Run *run = data;
  Worker *worker = &g_array_index (run->self->workers, Worker, index);
  const guint last = MIN (end * CHUNK, run->net.n_triangles);

  for (guint t = begin * CHUNK; t < last; t++) {
    const ClothUVPlace *places[3];
    Corner corners[3];
    gint box[4];

    get_corners (run, t, places);
    get_box (run, places, box);
    for (gint k = 0; k < 3; k++) {
      memcpy (corners[k].at, places[k]->at, sizeof corners[k].at);
      memcpy (corners[k].uv, places[k]->uv, sizeof corners[k].uv);
      memcpy (corners[k].point, places[k]->point, sizeof corners[k].point);
    }
    g_array_set_size (worker->pixels, 0);
    for (gint y = box[1]; y <= box[3]; y++)
      for (gint x = box[0]; x <= box[2]; x++) {
        const Pixel pixel = { x, y };

        if (run->owners[(gsize) y * run->surface->width + x] == t)
          g_array_append_val (worker->pixels, pixel);
      }
    descend (run, worker, (const Corner *[3]) {
          &corners[0], &corners[1], &corners[2]
        },
        (Pixel *) worker->pixels->data, worker->pixels->len, 0);
  }
}

/* ---- beyond the triangles ---- */

/* From triangles to the nearest of their places; what got no uv has none. */
static void
name_places (const Run * run)
{
  const gint width = run->surface->width;

  for (gint y = 0; y < run->surface->height; y++)
    for (gint x = 0; x < width; x++) {
      const gsize i = (gsize) y * width + x;
      const ClothUVPlace *c[3];
      gdouble best = INFINITY;
      gint nearest = 0;

      if (run->owners[i] == NONE)
        continue;
      if (isnan (run->uv[2 * i])) {
        run->owners[i] = NONE;
        continue;
      }
      get_corners (run, run->owners[i], c);
      for (gint k = 0; k < 3; k++) {
        const gdouble dx = c[k]->at[0] - x, dy = c[k]->at[1] - y;

        if (dx * dx + dy * dy < best) {
          best = dx * dx + dy * dy;
          nearest = k;
        }
      }
      run->owners[i] = (guint32) (c[nearest] - run->net.places);
    }
}

/* Whether a step from one pixel to a neighbour stays on the surface. */
static gboolean
is_step (const Run * run, const gfloat * from, const gfloat * to)
{
  return fabsf (from[2] - to[2]) <= 0.25 * run->params.stretch.depth_step;
}

/* What the neighbours that have a uv say of a pixel; FALSE where none is on its surface. */
static gboolean
go_on (const Run * run, guint32 pixel, Step * step)
{
  const gint width = run->surface->width;
  const gint x = (gint) (pixel % width), y = (gint) (pixel / width);
  const gfloat *p = point_at (run, x, y);
  gdouble sum[2] = { 0 }, weights = 0, best = 0;

  for (gint k = 0; k < 9; k++) {
    const gint nx = x + k % 3 - 1, ny = y + k / 3 - 1;
    const gdouble weight = k % 2 ? 1 : 0.5;
    const gdouble *slope;
    const gfloat *q;
    gdouble d[3], du[2], length, flat;
    gsize i;

    if (k == 4 || nx < 0 || ny < 0 || nx >= width || ny >= run->surface->height)
      continue;
    i = (gsize) ny *width + nx;
    q = point_at (run, nx, ny);
    if (run->owners[i] == NONE || !is_step (run, q, p))
      continue;
    slope = run->net.places[run->owners[i]].slope;
    for (gint c = 0; c < 3; c++)
      d[c] = p[c] - q[c];
    for (gint c = 0; c < 2; c++)
      du[c] = slope[3 * c] * d[0] + slope[3 * c + 1] * d[1]
          + slope[3 * c + 2] * d[2];
    length = sqrt (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    flat = sqrt (du[0] * du[0] + du[1] * du[1]);
    if (!(flat > 0))
      continue;
    for (gint c = 0; c < 2; c++)
      sum[c] += weight * (run->uv[2 * i + c] + du[c] * length / flat);
    weights += weight;
    if (weight > best) {
      best = weight;
      step->owner = run->owners[i];
    }
  }
  for (gint c = 0; c < 2 && weights > 0; c++)
    step->uv[c] = sum[c] / weights;
  return weights > 0;
}

/* Appends the neighbours of a pixel that wait for a uv. */
static void
add_neighbours (const Run * run, guint32 pixel, GArray * front)
{
  const gint width = run->surface->width;
  const gint x = (gint) (pixel % width), y = (gint) (pixel / width);

  for (gint k = 0; k < 9; k++) {
    const gint nx = x + k % 3 - 1, ny = y + k / 3 - 1;
    const guint32 i = (guint32) ny * width + nx;

    if (nx < 0 || ny < 0 || nx >= width || ny >= run->surface->height
        || run->owners[i] != NONE || !isfinite (point_at (run, nx, ny)[2])
        || !is_step (run, point_at (run, nx, ny), point_at (run, x, y)))
      continue;
    /* once: what is listed is 0 until it gets its uv */
    if (isnan (run->uv[2 * (gsize) i])) {
      run->uv[2 * (gsize) i] = 0;
      g_array_append_val (front, i);
    }
  }
}

/* Whether a neighbour of a pixel has a uv. */
static gboolean
is_beside (const Run * run, gint x, gint y)
{
  const gint left = MAX (x - 1, 0), right = MIN (x + 1,
      run->surface->width - 1);
  const gint top = MAX (y - 1, 0), bottom = MIN (y + 1,
      run->surface->height - 1);

  for (gint ny = top; ny <= bottom; ny++)
    for (gint nx = left; nx <= right; nx++)
      if (run->owners[(gsize) ny * run->surface->width + nx] != NONE)
        return TRUE;
  return FALSE;
}

static guint
extend (const Run * run)
{
  ClothUV *self = run->self;
  const guint rings = (guint) run->params.reach;
  GArray *front = self->front, *next = self->next;
  guint n_beyond = 0;

  g_array_set_size (front, 0);
  for (gint y = 0; rings && y < run->surface->height; y++)
    for (gint x = 0; x < run->surface->width; x++) {
      const guint32 i = (guint32) y * run->surface->width + x;

      if (run->owners[i] == NONE && isfinite (point_at (run, x, y)[2])
          && is_beside (run, x, y)) {
        run->uv[2 * (gsize) i] = 0;
        g_array_append_val (front, i);
      }
    }
  for (guint ring = 0; ring < rings && front->len; ring++) {
    const guint32 *pixels = (const guint32 *) front->data;
    const guint n = front->len;
    Step *steps = (Step *) g_array_set_size (self->steps, n)->data;
    GArray *swap = next;

    for (guint k = 0; k < n; k++)
      if (!go_on (run, pixels[k], &steps[k]))
        steps[k].owner = NONE;
    for (guint k = 0; k < n; k++) {
      gfloat *uv = run->uv + 2 * (gsize) pixels[k];

      run->owners[pixels[k]] = steps[k].owner;
      if (steps[k].owner == NONE) {
        uv[0] = NAN;
        continue;
      }
      uv[0] = (gfloat) steps[k].uv[0];
      uv[1] = (gfloat) steps[k].uv[1];
      n_beyond++;
    }
    g_array_set_size (next, 0);
    for (guint k = 0; k < n && ring + 1 < rings; k++)
      if (run->owners[pixels[k]] != NONE)
        add_neighbours (run, pixels[k], next);
    next = front;
    front = swap;
  }
  return n_beyond;
}

/* ---- all together ---- */

/* @self: room to work in
 * @params: what to do
 * @matches: (array length=n_matches): those that are believed, in any order
 * @n_matches: at most %CLOTH_UV_MAX_MATCHES; fewer than 3 make no triangle
 * @surface: point of each pixel, m, NaN where the surface isn't known
 * @pool: (nullable): threads; the result is the same for any number of them
 * @uv: (out): (array): u and v of each pixel of @surface, without padding, m; NaN where
 *   nothing is known
 * @counts: (out): what was done
 *
 * Pure interpolation within the triangles whose edges lie on the surface; beyond them uv
 * goes on for @params.reach pixels.
 */
void
cloth_uv_run (ClothUV * self, const ClothUVParams * params,
    const ClothUVMatch * matches, guint n_matches,
    const ClothMatchSurface * surface, ClothPool * pool, gfloat * uv,
    ClothUVCounts * counts)
{
  const gsize n_pixels = (gsize) surface->width * surface->height;
  const guint n_workers = pool ? cloth_pool_get_n_threads (pool) : 1;
  Run run = { self, clamp_params (params), surface };
  guint n_chunks;

  *counts = (ClothUVCounts) {
  0};
  run.uv = uv;
  run.owners = (guint32 *) g_array_set_size (self->owners,
      (guint) n_pixels)->data;
  memset (run.owners, 0xff, n_pixels * sizeof *run.owners);
  for (gsize i = 0; i < 2 * n_pixels; i++)
    uv[i] = NAN;
  for (gint y = 0; y < surface->height; y++)
    for (gint x = 0; x < surface->width; x++)
      counts->n_surface += isfinite (point_at (&run, x, y)[2]);
  cloth_uv_places_run (self->places, &run.params, matches,
      MIN (n_matches, CLOTH_UV_MAX_MATCHES), surface, &run.net, counts);
  share_out (&run);
  while (self->workers->len < n_workers) {
    const Worker worker = {
      g_array_new (FALSE, FALSE, sizeof (Pixel))
    };

    g_array_append_val (self->workers, worker);
  }
  for (guint k = 0; k < n_workers; k++)
    g_array_index (self->workers, Worker, k).n_between = 0;
  n_chunks = (run.net.n_triangles + CHUNK - 1) / CHUNK;
  if (pool)
    cloth_pool_run_one_by_one (pool, do_triangles, &run, n_chunks);
  else
    do_triangles (&run, 0, n_chunks, 0);
  for (guint k = 0; k < n_workers; k++)
    counts->n_between += g_array_index (self->workers, Worker, k).n_between;
  name_places (&run);
  counts->n_beyond = extend (&run);
  self->net = run.net;
}

/* @self: after cloth_uv_run ()
 * @pixel: row·width + column
 *
 * Returns: standard deviation of its uv along u or v, m; NaN where it has none
 */
gdouble
cloth_uv_get_sigma (const ClothUV * self, guint32 pixel)
{
  const guint32 owner = pixel < self->owners->len ?
      g_array_index (self->owners, guint32, pixel) : NONE;

  return owner == NONE ? NAN : self->net.places[owner].sigma;
}
