/* The paper's filling: the uniform bi-Laplacian with an iterative solver.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/fill/fill-private.h"

#include <math.h>
#include <string.h>

/* The residual that ends the iteration, of the first one's, and the most steps for each
 * unknown. */
#define TOLERANCE 1e-8
#define MOST_STEPS 4

/* The Laplacian of @x at @v by its neighbours that are @x or known. */
static void
laplacian (const ClothFill * self, const gdouble * x, guint v,
    gboolean homogeneous, gdouble value[3])
{
  const ClothStencils *s = self->stencils;
  guint n = s->near_start[v + 1] - s->near_start[v];

  value[0] = value[1] = value[2] = 0;
  for (guint i = s->near_start[v]; i <= s->near_start[v + 1]; i++) {
    /* last comes the vertex itself */
    guint w = i < s->near_start[v + 1] ? s->near[i] : v;
    gdouble weight = w == v ? -1. : 1. / n;

    for (guint c = 0; c < 3; c++) {
      if (self->index[w] >= 0)
        value[c] += weight * x[3 * self->index[w] + c];
      else if (!homogeneous && !isnan (self->measured[3 * w]))
        value[c] += weight * self->measured[3 * w + c];
      else if (!homogeneous)
        value[c] += weight * self->positions[3 * w + c];
    }
  }
}

/* L² x at the hole's vertices; with @homogeneous the known vertices count as 0. */
static void
apply (const ClothFill * self, const ClothHole * hole, const gdouble * x,
    gboolean homogeneous, gdouble * y)
{
  const ClothStencils *s = self->stencils;

  for (guint i = 0; i < hole->n; i++) {
    guint v = hole->vertices[i], n = s->near_start[v + 1] - s->near_start[v];
    gdouble own[3], other[3];

    laplacian (self, x, v, homogeneous, own);
    for (guint c = 0; c < 3; c++)
      y[3 * i + c] = -own[c];
    for (guint k = s->near_start[v]; k < s->near_start[v + 1]; k++) {
      laplacian (self, x, s->near[k], homogeneous, other);
      for (guint c = 0; c < 3; c++)
        y[3 * i + c] += other[c] / n;
    }
  }
}

static gdouble
dot (guint n, const gdouble * a, const gdouble * b)
{
  gdouble sum = 0;

  for (guint i = 0; i < n; i++)
    sum += a[i] * b[i];
  return sum;
}

/* H. van der Vorst, “Bi-CGSTAB”, 1992, for the three coordinates as one system. @x is the
 * first guess and becomes the solution; the other six are to work in. */
static void
iterate (const ClothFill * self, const ClothHole * hole, gdouble * x)
{
  guint n = 3 * hole->n;
  gdouble *r = x + n, *r0 = r + n, *p = r0 + n, *v = p + n, *s = v + n;
  gdouble *t = s + n;
  gdouble rho = 1, alpha = 1, omega = 1, start;

  apply (self, hole, x, FALSE, r);
  for (guint i = 0; i < n; i++)
    r[i] = -r[i];
  memcpy (r0, r, n * sizeof *r);
  memset (p, 0, n * sizeof *p);
  memset (v, 0, n * sizeof *v);
  start = dot (n, r, r);
  for (guint step = 0; step < MOST_STEPS * n; step++) {
    gdouble next = dot (n, r0, r), beta = next / rho * alpha / omega, tt;

    if (!(dot (n, r, r) > TOLERANCE * TOLERANCE * start) || !isfinite (beta))
      return;
    for (guint i = 0; i < n; i++)
      p[i] = r[i] + beta * (p[i] - omega * v[i]);
    apply (self, hole, p, TRUE, v);
    alpha = next / dot (n, r0, v);
    rho = next;
    for (guint i = 0; i < n; i++)
      s[i] = r[i] - alpha * v[i];
    apply (self, hole, s, TRUE, t);
    tt = dot (n, t, t);
    omega = tt > 0 ? dot (n, t, s) / tt : 0;
    if (!isfinite (alpha) || !isfinite (omega))
      return;
    for (guint i = 0; i < n; i++) {
      x[i] += alpha * p[i] + omega * s[i];
      r[i] = s[i] - omega * t[i];
    }
  }
}

/* @self: the frame; the plate's places are the first guess
 * @hole: an anchored hole
 *
 * Puts the vertices of the hole where L²(p) = 0, with L(p) = (1/n) Σ (p_i − p) and
 * L²(p) = (1/n) Σ (L(p_i) − L(p)) over the neighbours along edges: of a grid the horizontal
 * and vertical ones. Section 4.4 of the paper.
 */
void
cloth_fill_bilaplacian (ClothFill * self, const ClothHole * hole)
{
  gdouble *x;

  g_array_set_size (self->numbers, 7 * 3 * hole->n);
  x = (gdouble *) (gpointer) self->numbers->data;
  for (guint i = 0; i < hole->n; i++) {
    self->index[hole->vertices[i]] = (gint) i;
    for (guint c = 0; c < 3; c++)
      x[3 * i + c] = self->positions[3 * hole->vertices[i] + c];
  }
  /* where the plate is too unsure to say, the mean of the ring begins */
  for (guint i = 0; i < 3 * hole->n; i++)
    if (isnan (x[i])) {
      x[i] = 0;
      for (guint k = 0; k < hole->n_ring; k++)
        x[i] += self->measured[3 * hole->ring[k] + i % 3] / hole->n_ring;
    }
  iterate (self, hole, x);
  for (guint i = 0; i < hole->n; i++) {
    guint v = hole->vertices[i];

    self->index[v] = -1;
    for (guint c = 0; c < 3; c++)
      if (self->states[v] == CLOTH_VERTEX_FILLED)
        self->positions[3 * v + c] = (gfloat) x[3 * i + c];
  }
}
