/* Digital image correlation of a window of the film with the print.
 *
 * The film's pixels are compared as they are; what is looked up between pixels is the flat
 * picture, which has little noise, blurred as the film shows it. So the differences know
 * little of one another, and looking between pixels doesn't draw places towards whole ones
 * (H. Schreier et al., “Systematic Errors in Digital Image Correlation Caused by Intensity
 * Interpolation”, 2000). With film f, print p, warp W of second order, gain a and offset b
 *
 *   Σ w·(f(x) − a·p(W(x)) − b)²  +  bending² / bend²
 *
 * is made least by Gauss and Newton's steps (S. Baker and I. Matthews, “Lucas-Kanade 20 Years
 * On”, 2004: with the roles of the two pictures swapped; B. Pan et al., “Fast, Robust and
 * Accurate Digital Image Correlation Calculation Without Redundant Computations”, 2013). The
 * second term says what cloths usually do; with it bending is known as well as the window
 * tells it, and the place's covariance has what is not known of it. Where a window is seen
 * obliquely the flat picture is looked up at several places along the direction in which it
 * is squeezed (as E. Heckbert, “Survey of Texture Mapping”, 1986, asks for).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/align.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/vision/match/align-private.h"

#define PITCH CLOTH_ALIGN_PITCH
#define WIDE (2 * CLOTH_ALIGN_MAX_RADIUS + 1)
#define AREA (WIDE * PITCH)
#define TERMS CLOTH_WARP_TERMS
/* Unknowns: of the warp, gain and offset. */
#define UNKNOWNS (2 * TERMS + 2)
#define GAIN (2 * TERMS)
#define OFFSET (GAIN + 1)
/* Places that are looked up for one pixel at most. */
#define TAPS 9
/* The middle of a window: this share of its radius. */
#define MIDDLE 0.3
/* After so many steps the film has to look like the print. */
#define SOON 2
/* How far the flat picture's edge reaches into the film, in blurs. */
#define EDGE 2.0

struct _ClothAligner
{
  gfloat film[AREA], seen[AREA], weights[AREA], robust[AREA];
  gfloat print[AREA], across[AREA], down[AREA], differences[AREA];
  gfloat sums[CLOTH_ALIGN_SUMS][PITCH];
  gint stack[AREA];
};

/* How the flat picture is looked up. */
typedef struct
{
  const ClothPlane *plane;
  guint n;
  gfloat weights[TAPS];
  gdouble along[2];             /* from one tap to the next, px of the flat picture */
  gdouble edge[2];              /* what is nearer to the flat picture's edge is not seen pure */
} Filter;

typedef struct
{
  ClothAligner *self;
  const ClothAlignParams *params;
  const ClothPlanes *print;
  const ClothAlignView *view;
  const ClothAlignKernel *kernel;
  ClothWarp *warp;
  ClothAlignWindow window;
  gfloat t[WIDE];
  gint left, top;               /* of the window in the film */
  gint size;                    /* its edge */
  guint n;                      /* pixels in it */
  Filter filter;
} Run;

/* Returns: as measured on rendered cloth
 */
ClothAlignParams
cloth_align_default_params (void)
{
  return (ClothAlignParams) {
  .radius = 12,.bend = 0.01,.blur = 0.5,.reference_blur = 0,.outlier =
        3,.rounds = 8,.done = 0.03,.shift = 3,.likeness = 0.6,.all =
        0.45,.contrast = 4,.share = 0.3,.centre = 6,.model =
        0.4,.correlation = 2,.floor = 0.01,.depth_step = 0.01};
}

/* Returns: @params with all values in their ranges
 */
ClothAlignParams
cloth_align_clamp_params (const ClothAlignParams * params)
{
  ClothAlignParams p = *params;

  p.radius = CLAMP (p.radius, 3, CLOTH_ALIGN_MAX_RADIUS);
  p.bend = CLAMP (p.bend, 1e-9, 1);
  p.blur = CLAMP (p.blur, 0, 16);
  p.reference_blur = CLAMP (p.reference_blur, 0, 16);
  p.outlier = MAX (p.outlier, 0.1);
  p.rounds = CLAMP (p.rounds, 1, 1000);
  p.done = MAX (p.done, 0);
  p.shift = MAX (p.shift, 0);
  p.likeness = CLAMP (p.likeness, 0, 1);
  p.all = CLAMP (p.all, 0, 1);
  p.contrast = MAX (p.contrast, 0);
  p.share = CLAMP (p.share, 0, 1);
  p.centre = MAX (p.centre, 0);
  p.model = MAX (p.model, 0);
  p.correlation = MAX (p.correlation, 0);
  p.floor = MAX (p.floor, 0);
  p.depth_step = MAX (p.depth_step, 0);
  return p;
}

/* Returns: (transfer full): room to work in, for one place at a time
 */
ClothAligner *
cloth_aligner_new (void)
{
  return g_new0 (ClothAligner, 1);
}

/* @aligner: (nullable) (transfer full): what to free
 */
void
cloth_aligner_free (ClothAligner * aligner)
{
  g_free (aligner);
}

/* ---- the window in the film ---- */

/* Leaves only what hangs together with the middle, or with the known pixel nearest to it. */
static void
keep_surface (Run * run)
{
  const ClothMatchSurface *surface = run->view->surface;
  const gint size = run->size, pitch = (gint) run->window.columns;
  gfloat *seen = run->self->seen;
  gint *stack = run->self->stack, n = 0, nearest = -1, least = G_MAXINT;

#define DEPTH(at) surface->points[3 * ((gsize) (run->top + (at) / pitch) \
    * surface->stride + run->left + (at) % pitch) + 2]
  for (gint y = 0; y < size; y++)
    for (gint x = 0; x < size; x++) {
      const gint at = y * pitch + x, dx = x - size / 2, dy = y - size / 2;

      if (!(seen[at] > 0))
        continue;
      if (run->left + x >= surface->width || run->top + y >= surface->height
          || !isfinite (DEPTH (at))) {
        seen[at] = 0;
        continue;
      }
      seen[at] = 2;
      if (dx * dx + dy * dy < least) {
        least = dx * dx + dy * dy;
        nearest = at;
      }
    }
  if (nearest >= 0) {
    seen[nearest] = 1;
    stack[n++] = nearest;
  }
  while (n > 0) {
    const gint at = stack[--n], x = at % pitch, y = at / pitch;
    const gint next[4] = { at - 1, at + 1, at - pitch, at + pitch };
    const gboolean is_in[4] = { x > 0, x < size - 1, y > 0, y < size - 1 };

    for (gint k = 0; k < 4; k++)
      if (is_in[k] && seen[next[k]] > 1 && fabsf (DEPTH (next[k]) - DEPTH (at))
          <= (gfloat) run->params->depth_step) {
        seen[next[k]] = 1;
        stack[n++] = next[k];
      }
  }
#undef DEPTH
  for (gint at = 0; at < size * pitch; at++)
    seen[at] = seen[at] == 1;
}

static void
take_window (Run * run)
{
  ClothAligner *self = run->self;
  const ClothImage *film = run->view->film, *mask = run->view->mask;
  const gint radius = run->params->radius, size = 2 * radius + 1;
  const gint pitch = (size + 15) / 16 * 16;

  run->left = (gint) run->warp->centre[0] - radius;
  run->top = (gint) run->warp->centre[1] - radius;
  run->size = size;
  run->n = (guint) (size * size);
  run->window = (ClothAlignWindow) {
  (guint) pitch, (guint) size, self->robust, self->film, self->print,
        self->across, self->down};
  for (gint y = 0; y < size; y++) {
    const gint row = run->top + y;

    run->t[y] = (gfloat) ((y - radius) / (gdouble) radius);
    for (gint x = 0; x < pitch; x++) {
      const gint column = run->left + x;
      const gboolean in = x < size && row >= 0 && row < film->height
          && column >= 0 && column < film->width;

      self->film[y * pitch + x] = in ? film->data[(gssize) row * film->stride
          + column] : 0;
      self->seen[y * pitch + x] = in && (!mask
          || mask->data[(gssize) row * mask->stride + column]);
    }
  }
  if (run->view->surface)
    keep_surface (run);
}

/* ---- the print in the window ---- */

/* What blurs the flat picture as the film shows it. */
static void
choose_filter (Run * run)
{
  const ClothAlignParams *p = run->params;
  const gdouble blur = p->blur * p->blur;
  const gdouble less = p->reference_blur * p->reference_blur;
  Filter *f = &run->filter;
  gdouble j[4], xx, xy, yy, middle, half, least, most, more, spacing, axis;

  cloth_warp_get_slopes (run->warp, run->warp->centre[0], run->warp->centre[1],
      j);
  xx = blur * (j[0] * j[0] + j[1] * j[1]);
  xy = blur * (j[0] * j[2] + j[1] * j[3]);
  yy = blur * (j[2] * j[2] + j[3] * j[3]);
  f->edge[0] = EDGE * sqrt (xx);
  f->edge[1] = EDGE * sqrt (yy);
  middle = (xx + yy) / 2;
  half = hypot ((xx - yy) / 2, xy);
  least = MAX (middle - half - less, 0);
  most = MAX (middle + half - less, 0);
  f->plane = &run->print->planes[0];
  /* a plane that is a little too blurred is better than one far too sharp */
  for (guint k = 1; k < run->print->n_planes; k++)
    if (run->print->planes[k].variance <= 1.4 * least)
      f->plane = &run->print->planes[k];
  more = most - MAX (f->plane->variance, least);
  spacing = 1.5 * MAX (sqrt (f->plane->variance), 0.6 * f->plane->step);
  f->n = 1;
  f->weights[0] = 1;
  axis = 0.5 * atan2 (2 * xy, xx - yy);
  f->along[0] = cos (axis);
  f->along[1] = sin (axis);
  if (more > 0.1 * most && more > 0.01) {
    gdouble sum = 0, square = 0;

    /* equally far apart, to two standard deviations on either side */
    f->n = 2;
    while (f->n < TAPS && 4 * sqrt (more) > spacing * (f->n - 1))
      f->n++;
    for (guint k = 0; k < f->n; k++) {
      const gdouble at = k - 0.5 * (f->n - 1);
      const gdouble sigma = MAX (0.25 * (f->n - 1), 0.5);

      f->weights[k] = (gfloat) exp (-0.5 * at * at / (sigma * sigma));
      sum += f->weights[k];
      square += f->weights[k] * at * at;
    }
    for (guint k = 0; k < f->n; k++)
      f->weights[k] = (gfloat) (f->weights[k] / sum);
    for (gint c = 0; c < 2; c++)
      f->along[c] *= sqrt (more * sum / square);
  }
}

/* Renders the print into the window, and leaves out what the flat picture doesn't have. */
static void
render (Run * run)
{
  ClothAligner *self = run->self;
  const Filter *f = &run->filter;
  const gint size = run->size, pitch = (gint) run->window.columns;
  const gsize bytes = (gsize) (size * pitch) * sizeof (gfloat);
  const gdouble step = f->plane->step, unit = run->params->radius;
  const gdouble high[2] = { run->print->width - 0.5 - f->edge[0],
    run->print->height - 0.5 - f->edge[1]
  };
  const gdouble low[2] = { f->edge[0] - 0.5, f->edge[1] - 0.5 };
  const gfloat most[2] = { (gfloat) (f->plane->width - 3),
    (gfloat) (f->plane->height - 3)
  };

  memset (self->print, 0, bytes);
  memset (self->across, 0, bytes);
  memset (self->down, 0, bytes);
  for (gint y = 0; y < size; y++) {
    const gdouble t = (y - run->params->radius) / unit;
    const gdouble *p = run->warp->terms[0], *q = run->warp->terms[1];
    const gdouble p0 = p[0] + t * (p[2] + t * p[5]), p1 = p[1] + t * p[4];
    const gdouble q0 = q[0] + t * (q[2] + t * q[5]), q1 = q[1] + t * q[4];
    const gint at = y * pitch;
    gfloat u[PITCH], v[PITCH];

    for (gint x = 0; x < pitch; x++) {
      const gdouble s = (x - run->params->radius) / unit;

      u[x] = (gfloat) (p0 + s * (p1 + s * p[3]));
      v[x] = (gfloat) (q0 + s * (q1 + s * q[3]));
    }
    for (gint x = 0; x < pitch; x++)
      self->weights[at + x] = self->seen[at + x]
          * ((u[x] >= (gfloat) low[0]) & (u[x] <= (gfloat) high[0])
          & (v[x] >= (gfloat) low[1]) & (v[x] <= (gfloat) high[1]));
    for (guint k = 0; k < f->n; k++) {
      const gdouble by = k - 0.5 * (f->n - 1);
      const gfloat du = (gfloat) ((by * f->along[0] + 0.5) / step - 0.5
          + CLOTH_PLANE_PAD), dv = (gfloat) ((by * f->along[1] + 0.5) / step
          - 0.5 + CLOTH_PLANE_PAD), scale = (gfloat) (1 / step);
      gfloat px[PITCH], py[PITCH];

      for (gint x = 0; x < pitch; x++) {
        const gfloat a = u[x] * scale + du, b = v[x] * scale + dv;

        /* also what is no number */
        px[x] = a > 2 ? MIN (a, most[0]) : 2;
        py[x] = b > 2 ? MIN (b, most[1]) : 2;
      }
      run->kernel->sample (f->plane->coefficients, f->plane->stride,
          (guint) (size + 3) / 4 * 4, px, py, f->weights[k],
          f->weights[k] * scale, self->print + at, self->across + at,
          self->down + at);
    }
  }
}

/* ---- a step ---- */

static gdouble
total (const gfloat * columns, guint n)
{
  gdouble sum = 0;

  for (guint i = 0; i < n; i++)
    sum += (gdouble) columns[i];
  return sum;
}

typedef struct
{
  gdouble gain, offset;
  gdouble weight, rms;          /* pixels that count, and their differences */
  gdouble likeness, contrast;
  gdouble all;                  /* likeness of all pixels, outliers too */
} Light;

/* Gain and offset that explain the film best. */
static void
find_light (Run * run, Light * light)
{
  gfloat (*sums)[PITCH] = run->self->sums;
  gdouble s[6], pp, pf, ff;

  run->kernel->sum_light (&run->window, sums);
  for (gint k = 0; k < 6; k++)
    s[k] = total (sums[k], run->window.columns);
  *light = (Light) {
  .weight = s[0]};
  if (!(s[0] > 0))
    return;
  pp = s[3] - s[1] * s[1] / s[0];
  pf = s[4] - s[1] * s[2] / s[0];
  ff = s[5] - s[2] * s[2] / s[0];
  light->contrast = sqrt (MAX (ff, 0) / s[0]);
  if (!(pp > 0 && ff > 0))
    return;
  light->gain = pf / pp;
  light->offset = (s[2] - light->gain * s[1]) / s[0];
  light->likeness = pf > 0 ? MIN (pf * pf / (pp * ff), 1) : 0;
  light->rms = sqrt (MAX (ff - pf * pf / pp, 0) / s[0]);
}

/* The normal equations of all unknowns. */
static void
collect (Run * run, const Light * light, gdouble a[UNKNOWNS * UNKNOWNS],
    gdouble b[UNKNOWNS], gdouble * square)
{
  /* powers of s and t of each term */
  static const guint s_of[TERMS] = { 0, 1, 0, 2, 1, 0 };
  static const guint t_of[TERMS] = { 0, 0, 1, 0, 1, 2 };
  gfloat (*sums)[PITCH] = run->self->sums;
  const guint columns = run->window.columns;
  const gdouble gain = light->gain;
  gdouble powers[5][PITCH];
  /* [what][power of s][power of t] */
  gdouble grads[3][5][5], mixed[6][3][3];

  run->kernel->add (&run->window, run->self->differences, run->t, sums);
  for (guint i = 0; i < columns; i++) {
    const gdouble s = ((gint) i - run->params->radius)
        / (gdouble) run->params->radius;

    powers[0][i] = 1;
    for (gint k = 1; k < 5; k++)
      powers[k][i] = powers[k - 1][i] * s;
  }
#define MOMENT(to, column, power) G_STMT_START { \
    gdouble sum_ = 0; \
    for (guint i = 0; i < columns; i++) \
      sum_ += powers[power][i] * (gdouble) sums[column][i]; \
    to = sum_; \
  } G_STMT_END
  for (guint what = 0; what < 3; what++)
    for (guint t = 0; t < 5; t++)
      for (guint s = 0; s + t < 5; s++)
        MOMENT (grads[what][s][t], 5 * what + t, s);
  for (guint what = 0; what < 6; what++)
    for (guint t = 0; t < 3; t++)
      for (guint s = 0; s + t < 3; s++)
        MOMENT (mixed[what][s][t], 15 + 3 * what + t, s);
#undef MOMENT
  for (guint k = 0; k < TERMS; k++) {
    const guint sk = s_of[k], tk = t_of[k];

    for (guint l = 0; l < TERMS; l++) {
      const guint s = sk + s_of[l], t = tk + t_of[l];

      a[UNKNOWNS * k + l] = gain * gain * grads[0][s][t];
      a[UNKNOWNS * k + TERMS + l] = gain * gain * grads[1][s][t];
      a[UNKNOWNS * (TERMS + k) + l] = gain * gain * grads[1][s][t];
      a[UNKNOWNS * (TERMS + k) + TERMS + l] = gain * gain * grads[2][s][t];
    }
    for (guint c = 0; c < 2; c++) {
      const guint row = TERMS * c + k;

      b[row] = gain * mixed[3 * c][sk][tk];
      a[UNKNOWNS * row + GAIN] = a[UNKNOWNS * GAIN + row] =
          gain * mixed[3 * c + 1][sk][tk];
      a[UNKNOWNS * row + OFFSET] = a[UNKNOWNS * OFFSET + row] =
          gain * mixed[3 * c + 2][sk][tk];
    }
  }
  a[UNKNOWNS * GAIN + GAIN] = total (sums[35], columns);
  a[UNKNOWNS * GAIN + OFFSET] = a[UNKNOWNS * OFFSET + GAIN] =
      total (sums[34], columns);
  a[UNKNOWNS * OFFSET + OFFSET] = total (sums[33], columns);
  b[GAIN] = total (sums[37], columns);
  b[OFFSET] = total (sums[36], columns);
  *square = total (sums[38], columns);
}

/* Adds what is known of bending: @metric has places of the film by those of the flat
 * picture, squared. */
static void
add_bending (const Run * run, const gdouble metric[3], gdouble variance,
    gdouble a[UNKNOWNS * UNKNOWNS], gdouble b[UNKNOWNS])
{
  const gdouble bend = run->params->bend * run->params->radius
      * run->params->radius;
  const gdouble by = variance / (bend * bend);

  for (guint k = 3; k < TERMS; k++) {
    const gdouble p = run->warp->terms[0][k], q = run->warp->terms[1][k];
    const guint l = TERMS + k;

    a[UNKNOWNS * k + k] += by * metric[0];
    a[UNKNOWNS * k + l] += by * metric[1];
    a[UNKNOWNS * l + k] += by * metric[1];
    a[UNKNOWNS * l + l] += by * metric[2];
    b[k] -= by * (metric[0] * p + metric[1] * q);
    b[l] -= by * (metric[1] * p + metric[2] * q);
  }
}

/* Whether what is in the middle is the print as well. */
static gboolean
is_middle_seen (const Run * run, const gdouble at[2], gdouble variance)
{
  const ClothAligner *self = run->self;
  const gdouble radius = MAX (MIDDLE * run->params->radius, 2);
  gdouble sum = 0, n = 0;

  for (gint y = 0; y < run->size; y++)
    for (gint x = 0; x < run->size; x++) {
      const gint i = y * (gint) run->window.columns + x;
      const gdouble e = self->differences[i];

      if (hypot (run->left + x - at[0], run->top + y - at[1]) > radius)
        continue;
      sum += self->weights[i] * e * e;
      n += self->weights[i];
    }
  return n > 0 && sum <= run->params->centre * n * variance;
}

/* Covariance of the place in the film, from that of the unknowns. */
static void
find_covariance (const Run * run, const gdouble inverse[UNKNOWNS * UNKNOWNS],
    gdouble variance, ClothAlignment * to)
{
  const gdouble least = run->params->floor * run->params->floor;
  gdouble terms[TERMS], j[4], det, flat[3] = { 0 }, b[4];
  gdouble bent[3] = { 0 };

  cloth_warp_get_terms (run->warp, to->at[0], to->at[1], terms);
  cloth_warp_get_slopes (run->warp, to->at[0], to->at[1], j);
  det = j[0] * j[3] - j[1] * j[2];
  for (guint k = 0; k < TERMS; k++)
    for (guint l = 0; l < TERMS; l++) {
      const gdouble m = terms[k] * terms[l] * variance
          * run->params->correlation;

      flat[0] += m * inverse[UNKNOWNS * k + l];
      flat[1] += m * inverse[UNKNOWNS * k + TERMS + l];
      flat[2] += m * inverse[UNKNOWNS * (TERMS + k) + TERMS + l];
    }
  b[0] = j[3] / det;
  b[1] = -j[1] / det;
  b[2] = -j[2] / det;
  b[3] = j[0] / det;
  /* bending over half the window, in the film */
  for (gint k = 0; k < 2; k++) {
    const gdouble p = run->warp->terms[0][3 + 2 * k];
    const gdouble q = run->warp->terms[1][3 + 2 * k];
    const gdouble x = run->params->model * (b[0] * p + b[1] * q);
    const gdouble y = run->params->model * (b[2] * p + b[3] * q);

    bent[0] += x * x;
    bent[1] += x * y;
    bent[2] += y * y;
  }
  to->xx = bent[0] + b[0] * b[0] * flat[0] + 2 * b[0] * b[1] * flat[1]
      + b[1] * b[1] * flat[2] + least;
  to->xy =
      bent[1] + b[0] * b[2] * flat[0] + (b[0] * b[3] + b[1] * b[2]) * flat[1]
      + b[1] * b[3] * flat[2];
  to->yy = bent[2] + b[2] * b[2] * flat[0] + 2 * b[2] * b[3] * flat[1]
      + b[3] * b[3] * flat[2] + least;
}

/* Renders the print, and weighs its differences from the film. */
static ClothAlignResult
look (Run * run, Light * light)
{
  const ClothAlignParams *p = run->params;
  ClothAligner *self = run->self;

  render (run);
  run->window.weights = self->weights;
  find_light (run, light);
  if (!(light->weight >= p->share * run->n && light->contrast >= p->contrast))
    return CLOTH_ALIGN_PLAIN;
  /* twice: outliers lift the first scale */
  for (gint pass = 0; pass < 2; pass++) {
    const gdouble scale = p->outlier * MAX (light->rms, 0.3);

    if (!(light->gain > 0))
      return CLOTH_ALIGN_UNLIKE;
    run->window.weights = self->weights;
    run->kernel->weigh (&run->window, (gfloat) light->gain,
        (gfloat) light->offset, (gfloat) (1 / (scale * scale)),
        self->differences, self->robust);
    run->window.weights = self->robust;
    if (pass == 0) {
      const gdouble all = light->likeness;

      find_light (run, light);
      light->all = all;
    }
  }
  return CLOTH_ALIGN_FOUND;
}

/* @aligner: room to work in
 * @params: what counts, in their ranges
 * @print: the flat picture
 * @view: the film and what is known of it
 * @place: in the flat picture, px
 * @warp: (inout): the first guess of what the film shows about the place; then as found, about
 *   the window's middle
 * @alignment: (out): the place in the film
 * @level: instructions to use
 *
 * Returns: whether the film tells it; if not, @warp and @alignment are undefined
 */
ClothAlignResult
cloth_align_run (ClothAligner * aligner, const ClothAlignParams * params,
    const ClothPlanes * print, const ClothAlignView * view,
    const gdouble place[2], ClothWarp * warp, ClothAlignment * alignment,
    ClothSimd level)
{
  Run run = { aligner, params, print, view,
    CLOTH_SIMD_TABLE (cloth_align_kernel, level), warp
  };
  gdouble first[2] = { warp->centre[0], warp->centre[1] }, *at = alignment->at;
  gdouble j[4], det, metric[3];

  if (!cloth_warp_find (warp, place, first) || !(fabs (first[0]) < 1e6
          && fabs (first[1]) < 1e6))
    return CLOTH_ALIGN_UNLIKE;
  cloth_warp_move (warp, rint (first[0]), rint (first[1]), params->radius);
  cloth_warp_get_slopes (warp, first[0], first[1], j);
  det = j[0] * j[3] - j[1] * j[2];
  if (!(fabs (det) > 1e-6 && isfinite (det)))
    return CLOTH_ALIGN_UNLIKE;
  metric[0] = (j[3] * j[3] + j[2] * j[2]) / (det * det);
  metric[1] = -(j[1] * j[3] + j[0] * j[2]) / (det * det);
  metric[2] = (j[1] * j[1] + j[0] * j[0]) / (det * det);
  take_window (&run);
  choose_filter (&run);
  at[0] = first[0];
  at[1] = first[1];
  for (guint round = 0; round < params->rounds; round++) {
    gdouble a[UNKNOWNS * UNKNOWNS], b[UNKNOWNS], inverse[UNKNOWNS * UNKNOWNS];
    gdouble square, variance, from[2] = { at[0], at[1] };
    ClothAlignResult result;
    Light light;

    result = look (&run, &light);
    if (result != CLOTH_ALIGN_FOUND)
      return result;
    if (round >= SOON && light.all < params->all)
      return CLOTH_ALIGN_UNLIKE;
    collect (&run, &light, a, b, &square);
    variance = MAX (square / MAX (a[UNKNOWNS * OFFSET + OFFSET] - UNKNOWNS, 1),
        0.1);
    add_bending (&run, metric, variance, a, b);
    if (!cloth_cholesky_factor (UNKNOWNS, a))
      return CLOTH_ALIGN_PLAIN;
    cloth_cholesky_solve (UNKNOWNS, a, b);
    for (guint k = 0; k < TERMS; k++) {
      warp->terms[0][k] += b[k];
      warp->terms[1][k] += b[TERMS + k];
    }
    if (!cloth_warp_find (warp, place, at)
        || !(hypot (at[0] - first[0], at[1] - first[1]) <= params->shift))
      return CLOTH_ALIGN_UNLIKE;
    if (hypot (at[0] - from[0], at[1] - from[1]) > params->done)
      continue;
    if (light.likeness < params->likeness || light.all < params->all
        || !is_middle_seen (&run, from, variance))
      return CLOTH_ALIGN_UNLIKE;
    cloth_cholesky_inverse (UNKNOWNS, a, inverse);
    find_covariance (&run, inverse, variance, alignment);
    alignment->likeness = light.likeness;
    alignment->noise = sqrt (variance);
    return isfinite (alignment->xx + alignment->xy + alignment->yy) ?
        CLOTH_ALIGN_FOUND : CLOTH_ALIGN_PLAIN;
  }
  return CLOTH_ALIGN_UNLIKE;
}
