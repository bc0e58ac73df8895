/* Pictures of corners by brute force: the ideal pattern at 24 by 24 places a pixel, blurred
 * at 8 by 8 by a sampled Gaussian, then averaged. Shares no formula with what it tests.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>
#include <math.h>
#include <string.h>

#define CHECKER_SIZE 40
#define CHECKER_FINE 8
#define CHECKER_PAD 5
#define CHECKER_GRID ((CHECKER_SIZE + 2 * CHECKER_PAD) * CHECKER_FINE)

typedef enum {
  CHECKER_X,                    /* two dark quadrants */
  CHECKER_L,                    /* one */
  CHECKER_T                     /* three levels: one side split */
} CheckerKind;

typedef struct {
  CheckerKind kind;
  gdouble x, y;                 /* px */
  gdouble theta[2];             /* radians */
  gdouble blur;                 /* px */
  gdouble dark, bright;         /* grey levels */
} CheckerCorner;

static inline gdouble
checker_level (const CheckerCorner * corner, const gdouble * edge, gdouble x,
    gdouble y)
{
  gdouble dx = x - corner->x, dy = y - corner->y;
  gboolean a = dy * edge[1] - dx * edge[0] > 0;
  gboolean b = dy * edge[3] - dx * edge[2] > 0;

  switch (corner->kind) {
    case CHECKER_X:
      return a == b ? corner->bright : corner->dark;
    case CHECKER_L:
      return a && b ? corner->dark : corner->bright;
    case CHECKER_T:
    default:
      return a ? corner->bright :
          b ? corner->dark : 0.5 * (corner->dark + corner->bright);
  }
}

/* CHECKER_SIZE² grey levels, not rounded */
static inline void
checker_render (const CheckerCorner * corner, gfloat * out)
{
  gfloat *fine = g_new (gfloat, CHECKER_GRID * CHECKER_GRID);
  gfloat *line = g_new0 (gfloat, CHECKER_GRID);
  gdouble sigma = corner->blur * CHECKER_FINE;
  gint reach = (gint) ceil (3.5 * sigma);
  gfloat *tap = g_new (gfloat, 2 * reach + 1);
  gdouble sum = 0;
  const gdouble edge[4] = { sin (corner->theta[0]), cos (corner->theta[0]),
    sin (corner->theta[1]), cos (corner->theta[1])
  };

  for (gint k = -reach; k <= reach; k++)
    sum += exp (-0.5 * k * k / (sigma * sigma));
  for (gint k = -reach; k <= reach; k++)
    tap[k + reach] = (gfloat) (exp (-0.5 * k * k / (sigma * sigma)) / sum);
  for (gint j = 0; j < CHECKER_GRID; j++) {
    for (gint i = 0; i < CHECKER_GRID; i++) {
      gdouble v = 0;
      for (gint k = 0; k < 9; k++)
        v += checker_level (corner, edge,
            (i + (k % 3 * 2 + 1) / 6.0) / CHECKER_FINE - 0.5 - CHECKER_PAD,
            (j + (k / 3 * 2 + 1) / 6.0) / CHECKER_FINE - 0.5 - CHECKER_PAD);
      fine[j * CHECKER_GRID + i] = (gfloat) (v / 9);
    }
  }
  for (gint pass = 0; pass < 2; pass++) {
    gint along = pass ? CHECKER_GRID : 1, across = pass ? 1 : CHECKER_GRID;
    for (gint j = 0; j < CHECKER_GRID; j++) {
      gfloat *row = fine + j * across;
      for (gint i = 0; i < CHECKER_GRID; i++)
        line[i] = row[i * along];
      for (gint i = reach; i < CHECKER_GRID - reach; i++) {
        gfloat v = 0;
        for (gint k = 0; k <= 2 * reach; k++)
          v += tap[k] * line[i - reach + k];
        row[i * along] = v;
      }
    }
  }
  for (gint y = 0; y < CHECKER_SIZE; y++) {
    for (gint x = 0; x < CHECKER_SIZE; x++) {
      gdouble v = 0;
      for (gint j = 0; j < CHECKER_FINE; j++)
        for (gint i = 0; i < CHECKER_FINE; i++)
          v += fine[((y + CHECKER_PAD) * CHECKER_FINE + j) * CHECKER_GRID +
              (x + CHECKER_PAD) * CHECKER_FINE + i];
      out[y * CHECKER_SIZE + x] = (gfloat) (v / CHECKER_FINE / CHECKER_FINE);
    }
  }
  g_free (fine);
  g_free (line);
  g_free (tap);
}

static inline gdouble
checker_normal (GRand * rand)
{
  gdouble u = g_rand_double_range (rand, 1e-12, 1.0);

  return sqrt (-2 * log (u)) * cos (2 * G_PI * g_rand_double (rand));
}

/* A camera's picture of it: noise, then whole levels. */
static inline void
checker_expose (const gfloat * in, gdouble noise, GRand * rand, guint8 * out)
{
  for (gint i = 0; i < CHECKER_SIZE * CHECKER_SIZE; i++) {
    gdouble v = in[i] + (noise > 0 ? noise * checker_normal (rand) : 0);
    out[i] = (guint8) CLAMP (floor (v + 0.5), 0, 255);
  }
}

/* A corner of a board seen askew: any turn, 60 to 120 degrees between the edges. */
static inline CheckerCorner
checker_random (CheckerKind kind, GRand * rand)
{
  CheckerCorner c = { .kind = kind,.dark = 40,.bright = 200 };

  c.x = CHECKER_SIZE / 2 + g_rand_double_range (rand, -0.5, 0.5);
  c.y = CHECKER_SIZE / 2 + g_rand_double_range (rand, -0.5, 0.5);
  c.theta[0] = g_rand_double_range (rand, 0, 2 * G_PI);
  c.theta[1] = c.theta[0] + g_rand_double_range (rand, G_PI / 3,
      2 * G_PI / 3);
  c.blur = g_rand_double_range (rand, 0.5, 1.0);
  return c;
}

/* Errors with the covariance claimed for them. */
typedef struct {
  guint n;
  gdouble square, claimed, chi2, worst;
} CheckerScatter;

static inline void
checker_scatter_add (CheckerScatter * s, gdouble ex, gdouble ey,
    const gfloat cov[3])
{
  gdouble det = (gdouble) cov[0] * cov[2] - (gdouble) cov[1] * cov[1];

  s->n++;
  s->square += ex * ex + ey * ey;
  s->claimed += cov[0] + cov[2];
  s->chi2 += (cov[2] * ex * ex - 2 * cov[1] * ex * ey + cov[0] * ey * ey) /
      det;
  s->worst = MAX (s->worst, hypot (ex, ey));
}

/* px, an axis */
static inline gdouble
checker_scatter_sigma (const CheckerScatter * s)
{
  return sqrt (s->square / (2.0 * s->n));
}

static inline gdouble
checker_scatter_claimed (const CheckerScatter * s)
{
  return sqrt (s->claimed / (2.0 * s->n));
}
