/* Matched places and the triangles between them.
 *
 * The paper keeps each match as it is (section 5). Here matches that lie almost on each other
 * become one, since the slope between them would be all noise; a place far from where those
 * around it say is put there, since verification lets one in a hundred wrong ones pass and
 * each spoils all its triangles; and what is left of the matches' noise is smoothed. A plane
 * is fitted to the neighbours' uv over steps as long as the surface, so that a fold is no
 * error.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/uv/place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/math/delaunay.h"
#include "gst/math/linalg.h"
#include "gst/math/statistics.h"

/* Usual distance of places, px. */
#define USUAL 10.0
/* Rounds in which outliers are left out: each takes the worst of its neighbourhood. */
#define ROUNDS 6
/* Fewest neighbours that can contradict a place, and of how many the scale is told. */
#define NEIGHBOURS 4
#define SCALED 30
/* Where its neighbours say that a place is, their variance may be this share of one's own. */
#define WITHIN 0.5
/* Rounds of smoothing. */
#define SMOOTHINGS 2
/* Share of a neighbourhood's extent that keeps the direction which it doesn't span, the
 * normal, at a slope of 0. */
#define RIDGE 1e-3

typedef struct
{
  guint other;
  gdouble length;               /* along the surface, m; < 0: no surface between */
} Neighbour;

struct _ClothUVPlaces
{
  ClothDelaunay *delaunay;
  GArray *order;                /* ClothUVMatch, by place */
  GArray *used;                 /* guint8: of the matches in order */
  GArray *places;               /* ClothUVPlace */
  GArray *points;               /* gdouble: columns and rows */
  GArray *starts;               /* guint: first neighbour of each place, and the end */
  GArray *neighbours;           /* Neighbour */
  GArray *errors, *scales;      /* gdouble */
  GArray *out;                  /* guint8 */
  GArray *sums;                 /* Sums */
  GArray *triangles;            /* guint */
};

/* Of steps d on the surface and their du: Σ d dᵀ and Σ du dᵀ. */
typedef struct
{
  gdouble dd[9], ud[6];
  guint n;
} Sums;

typedef struct
{
  ClothUVPlaces *self;
  const ClothUVParams *params;
  const ClothMatchSurface *surface;
} Run;

static GArray *
array (gsize size)
{
  return g_array_new (FALSE, FALSE, (guint) size);
}

/* Returns: (transfer full): room for the places of one picture at a time
 */
ClothUVPlaces *
cloth_uv_places_new (void)
{
  ClothUVPlaces *self = g_new (ClothUVPlaces, 1);

  self->delaunay = cloth_delaunay_new ();
  self->order = array (sizeof (ClothUVMatch));
  self->used = array (1);
  self->places = array (sizeof (ClothUVPlace));
  self->points = array (sizeof (gdouble));
  self->starts = array (sizeof (guint));
  self->neighbours = array (sizeof (Neighbour));
  self->errors = array (sizeof (gdouble));
  self->scales = array (sizeof (gdouble));
  self->out = array (1);
  self->sums = array (sizeof (Sums));
  self->triangles = array (sizeof (guint));
  return self;
}

/* @self: (nullable) (transfer full): what to free
 */
void
cloth_uv_places_free (ClothUVPlaces * self)
{
  if (!self)
    return;
  cloth_delaunay_free (self->delaunay);
  g_array_unref (self->order);
  g_array_unref (self->used);
  g_array_unref (self->places);
  g_array_unref (self->points);
  g_array_unref (self->starts);
  g_array_unref (self->neighbours);
  g_array_unref (self->errors);
  g_array_unref (self->scales);
  g_array_unref (self->out);
  g_array_unref (self->sums);
  g_array_unref (self->triangles);
  g_free (self);
}

/* ---- matches become places ---- */

static gint
compare_matches (gconstpointer pa, gconstpointer pb)
{
  const ClothUVMatch *a = pa, *b = pb;

  if (a->x != b->x)
    return a->x < b->x ? -1 : 1;
  if (a->y != b->y)
    return a->y < b->y ? -1 : 1;
  if (a->u != b->u)
    return a->u < b->u ? -1 : 1;
  return a->v < b->v ? -1 : a->v > b->v;
}

static void
add_place (const Run * run, const gdouble sum[4], gdouble n)
{
  ClothUVPlace place = {
    {sum[0] / n, sum[1] / n}
    , {sum[2] / n, sum[3] / n}
  };

  if (!cloth_surface_get_point (run->surface, place.at[0], place.at[1],
          run->params->stretch.depth_step, place.point))
    return;
  g_array_append_val (run->self->places, place);
  g_array_append_vals (run->self->points, place.at, 2);
}

/* Each match that is not near an earlier one takes those near to it along. */
static void
make_places (const Run * run, const ClothUVMatch * matches, guint n)
{
  ClothUVPlaces *self = run->self;
  const gdouble together = run->params->together;
  const ClothUVMatch *m;
  guint8 *used;

  g_array_set_size (self->order, 0);
  g_array_set_size (self->places, 0);
  g_array_set_size (self->points, 0);
  for (guint i = 0; i < n; i++)
    if (isfinite (matches[i].x + matches[i].y + matches[i].u + matches[i].v))
      g_array_append_val (self->order, matches[i]);
  n = self->order->len;
  m = (const ClothUVMatch *) self->order->data;
  /* an empty array has no data */
  if (n)
    qsort (self->order->data, n, sizeof *m, compare_matches);
  used = (guint8 *) g_array_set_size (self->used, n)->data;
  if (n)
    memset (used, 0, n);
  for (guint i = 0; i < n; i++) {
    gdouble sum[4] = { m[i].x, m[i].y, m[i].u, m[i].v }, count = 1;

    if (used[i])
      continue;
    for (guint j = i + 1; j < n && m[j].x - m[i].x <= together; j++) {
      const gdouble dx = m[j].x - m[i].x, dy = m[j].y - m[i].y;

      if (used[j] || dx * dx + dy * dy > together * together)
        continue;
      used[j] = 1;
      sum[0] += m[j].x;
      sum[1] += m[j].y;
      sum[2] += m[j].u;
      sum[3] += m[j].v;
      count++;
    }
    add_place (run, sum, count);
  }
}

/* ---- neighbours ---- */

/* Length of the surface between two places, m; < 0 where it is broken, or where they are
 * too far apart in the picture. */
static gdouble
measure (const Run * run, const ClothUVPlace * a, const ClothUVPlace * b)
{
  const gfloat from[2] = { (gfloat) a->at[0], (gfloat) a->at[1] };
  const gfloat to[2] = { (gfloat) b->at[0], (gfloat) b->at[1] };
  gdouble length;
  gboolean broken;

  if (hypot (from[0] - to[0], from[1] - to[1]) > run->params->longest
      || !cloth_surface_measure (run->surface, from, to,
          run->params->stretch.depth_step, &length, &broken) || broken)
    return -1;
  return length;
}

/* A few only. */
static void
sort_neighbours (Neighbour * of, guint n)
{
  for (guint i = 1; i < n; i++) {
    const Neighbour moved = of[i];
    guint k;

    for (k = i; k && of[k - 1].other > moved.other; k--)
      of[k] = of[k - 1];
    of[k] = moved;
  }
}

static Neighbour *
find_neighbour (const ClothUVPlaces * self, guint a, guint b)
{
  const guint *starts = (const guint *) self->starts->data;
  Neighbour *of = (Neighbour *) self->neighbours->data;

  for (guint k = starts[a]; k < starts[a + 1]; k++)
    if (of[k].other == b)
      return &of[k];
  return NULL;
}

/* Lists the neighbours of each place both ways, and measures them. */
static void
make_neighbours (const Run * run, const guint * triangles, guint n_triangles)
{
  ClothUVPlaces *self = run->self;
  const guint n = self->places->len;
  const ClothUVPlace *places = (const ClothUVPlace *) self->places->data;
  guint *starts = (guint *) g_array_set_size (self->starts, n + 2)->data;
  Neighbour *of = (Neighbour *) g_array_set_size (self->neighbours,
      6 * n_triangles)->data;
  guint end = 0;

  memset (starts, 0, (n + 2) * sizeof *starts);
  for (guint k = 0; k < 3 * n_triangles; k++)
    starts[triangles[k] + 2] += 2;
  for (guint i = 2; i < n + 2; i++)
    starts[i] += starts[i - 1];
  for (guint k = 0; k < 3 * n_triangles; k++) {
    const guint a = triangles[k], b = triangles[k % 3 < 2 ? k + 1 : k - 2];

    of[starts[a + 1]++] = (Neighbour) {
    b, 0};
    of[starts[b + 1]++] = (Neighbour) {
    a, 0};
  }
  /* an edge of two triangles is there twice */
  for (guint i = 0; i < n; i++) {
    const guint first = starts[i], last = starts[i + 1];

    starts[i] = end;
    sort_neighbours (of + first, last - first);
    for (guint k = first; k < last; k++)
      if (k == first || of[k].other != of[k - 1].other)
        of[end++] = of[k];
  }
  starts[n] = end;
  for (guint i = 0; i < n; i++)
    for (guint k = starts[i]; k < starts[i + 1]; k++)
      of[k].length = of[k].other < i ?
          find_neighbour (self, of[k].other, i)->length
          : measure (run, &places[i], &places[of[k].other]);
}

/* ---- slopes ---- */

/* The step to a neighbour, as long as the surface between. */
static void
get_step (const ClothUVPlace * from, const ClothUVPlace * to, gdouble length,
    gdouble step[3])
{
  gdouble chord = 0;

  for (gint c = 0; c < 3; c++) {
    step[c] = to->point[c] - from->point[c];
    chord += step[c] * step[c];
  }
  chord = sqrt (chord);
  for (gint c = 0; c < 3 && chord > 0; c++)
    step[c] *= length / chord;
}

static void
sums_add (Sums * sums, const gdouble d[3], const gdouble du[2])
{
  for (gint i = 0; i < 3; i++) {
    for (gint j = 0; j < 3; j++)
      sums->dd[3 * i + j] += d[i] * d[j];
    sums->ud[i] += du[0] * d[i];
    sums->ud[3 + i] += du[1] * d[i];
  }
  sums->n++;
}

static void
sums_add_sums (Sums * sums, const Sums * more)
{
  for (gint i = 0; i < 9; i++)
    sums->dd[i] += more->dd[i];
  for (gint i = 0; i < 6; i++)
    sums->ud[i] += more->ud[i];
  sums->n += more->n;
}

/* The slope that fits best; FALSE where the steps span no plane. */
static gboolean
sums_solve (const Sums * sums, gdouble slope[6], gdouble inverse[9])
{
  const gdouble trace = sums->dd[0] + sums->dd[4] + sums->dd[8];
  gdouble a[9];

  memcpy (a, sums->dd, sizeof a);
  for (gint i = 0; i < 3; i++)
    a[4 * i] += RIDGE * trace;
  if (!(trace > 0) || !cloth_mat3_inverse (a, inverse))
    return FALSE;
  for (gint r = 0; r < 2; r++)
    for (gint c = 0; c < 3; c++)
      slope[3 * r + c] = sums->ud[3 * r] * inverse[c]
          + sums->ud[3 * r + 1] * inverse[3 + c]
          + sums->ud[3 * r + 2] * inverse[6 + c];
  return TRUE;
}

/* ---- outliers ---- */

/* How far place @i lies from where its neighbours that are not out say, in metres of a place
 * whose neighbours were exact, and by how much along u and v; < 0: too few say. They are
 * fitted by a plane around their mean, without the place itself; the farther that mean lies
 * off, the less sure is what it says. @within: whether it is sure enough to go by. */
static gdouble
get_error (const ClothUVPlaces * self, guint i, gdouble e[2], gboolean * within)
{
  const ClothUVPlace *places = (const ClothUVPlace *) self->places->data;
  const guint *starts = (const guint *) self->starts->data;
  const Neighbour *of = (const Neighbour *) self->neighbours->data;
  const guint8 *out = (const guint8 *) self->out->data;
  gdouble mean[3] = { 0 }, mean_uv[2] = { 0 }, slope[6];
  gdouble inverse[9], leverage[3], unsure;
  Sums sums = { {0} };
  guint n = 0;

  for (guint k = starts[i]; k < starts[i + 1]; k++) {
    gdouble d[3];

    if (of[k].length < 0 || out[of[k].other])
      continue;
    get_step (&places[i], &places[of[k].other], of[k].length, d);
    for (gint c = 0; c < 3; c++)
      mean[c] += d[c];
    for (gint c = 0; c < 2; c++)
      mean_uv[c] += places[of[k].other].uv[c] - places[i].uv[c];
    n++;
  }
  if (n < NEIGHBOURS)
    return -1;
  for (guint k = starts[i]; k < starts[i + 1]; k++) {
    gdouble d[3], du[2];

    if (of[k].length < 0 || out[of[k].other])
      continue;
    get_step (&places[i], &places[of[k].other], of[k].length, d);
    for (gint c = 0; c < 3; c++)
      d[c] -= mean[c] / n;
    for (gint c = 0; c < 2; c++)
      du[c] = places[of[k].other].uv[c] - places[i].uv[c] - mean_uv[c] / n;
    sums_add (&sums, d, du);
  }
  if (!sums_solve (&sums, slope, inverse))
    return -1;
  for (gint c = 0; c < 3; c++)
    mean[c] /= n;
  for (gint r = 0; r < 2; r++)
    e[r] = mean_uv[r] / n - slope[3 * r] * mean[0] - slope[3 * r + 1] * mean[1]
        - slope[3 * r + 2] * mean[2];
  cloth_mat3_vec (inverse, mean, leverage);
  unsure = 1. / n + leverage[0] * mean[0] + leverage[1] * mean[1]
      + leverage[2] * mean[2];
  *within = unsure <= WITHIN;
  return sqrt ((e[0] * e[0] + e[1] * e[1]) / (1 + MAX (unsure, 0)));
}

/* Marks those that lie too far from where their neighbours say; of neighbours the worst
 * first. Returns: how many. */
static guint
mark_outliers (const Run * run, gdouble * sigma)
{
  ClothUVPlaces *self = run->self;
  const guint n = self->places->len;
  const guint *starts = (const guint *) self->starts->data;
  const Neighbour *of = (const Neighbour *) self->neighbours->data;
  guint8 *out = (guint8 *) g_array_set_size (self->out, n)->data;
  gdouble *errors = (gdouble *) g_array_set_size (self->errors, n)->data;
  gdouble *scales = (gdouble *) g_array_set_size (self->scales, n)->data;
  guint n_out = 0, n_scaled = 0, before = G_MAXUINT;
  gdouble bound, e[2];
  gboolean within;

  *sigma = 0;
  if (n)
    memset (out, 0, n);
  for (guint i = 0; i < n; i++) {
    errors[i] = get_error (self, i, e, &within);
    if (errors[i] >= 0)
      scales[n_scaled++] = errors[i];
  }
  if (n_scaled < SCALED)
    return 0;
  /* half of the lengths of two normal errors are below 1.18 σ */
  *sigma = cloth_median (scales, n_scaled) / 1.18;
  bound = run->params->outlier * *sigma;
  for (gint round = 0; round < ROUNDS && bound > 0 && n_out != before; round++) {
    before = n_out;
    for (guint i = 0; i < n; i++) {
      gboolean worst = errors[i] > bound && !out[i];

      for (guint k = starts[i]; k < starts[i + 1] && worst; k++)
        worst = of[k].length < 0 || out[of[k].other]
            || errors[of[k].other] < errors[i]
            || (errors[of[k].other] == errors[i] && of[k].other > i);
      if (worst) {
        out[i] = 2;
        n_out++;
      }
    }
    for (guint i = 0; i < n; i++)
      if (out[i] == 2) {
        out[i] = 1;
        for (guint k = starts[i]; k < starts[i + 1]; k++)
          if (!out[of[k].other])
            errors[of[k].other] = get_error (self, of[k].other, e, &within);
      }
  }
  return n_out;
}

/* Puts them where their neighbours say: without them their triangles would be holes. What
 * has too few neighbours stays out. */
static void
mend_outliers (ClothUVPlaces * self)
{
  guint8 *out = (guint8 *) self->out->data;
  ClothUVPlace *places = (ClothUVPlace *) self->places->data;
  gdouble e[2];
  gboolean within;

  for (guint i = 0; i < self->places->len; i++)
    if (out[i] && get_error (self, i, e, &within) >= 0 && within) {
      places[i].uv[0] += e[0];
      places[i].uv[1] += e[1];
      out[i] = 2;
    }
  for (guint i = 0; i < self->places->len; i++)
    out[i] = out[i] == 1;
}

/* How sure each place is, by the errors around it: near folds they are larger. */
static void
set_sigmas (ClothUVPlaces * self, gdouble usual)
{
  ClothUVPlace *places = (ClothUVPlace *) self->places->data;
  const guint *starts = (const guint *) self->starts->data;
  const Neighbour *of = (const Neighbour *) self->neighbours->data;
  const gdouble *errors = (const gdouble *) self->errors->data;

  for (guint i = 0; i < self->places->len; i++) {
    /* two more as usual, so that one error alone says little */
    gdouble sum = 4 * usual * usual, n = 2;

    for (guint k = starts[i]; k <= starts[i + 1]; k++) {
      const guint j = k < starts[i + 1] ? of[k].other : i;

      if (errors[j] < 0 || (k < starts[i + 1] && of[k].length < 0))
        continue;
      sum += errors[j] * errors[j];
      n++;
    }
    places[i].sigma = sqrt (sum / 2 / n);
  }
}

/* Moves each place towards where those around it say: matches err by half a pixel, which the
 * mean of seven doesn't. */
static void
smooth (const Run * run)
{
  ClothUVPlaces *self = run->self;
  const guint n = self->places->len;
  const guint8 *out = (const guint8 *) self->out->data;
  ClothUVPlace *places = (ClothUVPlace *) self->places->data;
  gdouble *moves = (gdouble *) g_array_set_size (self->scales, 2 * n)->data;
  gboolean within;

  for (guint round = 0; round < SMOOTHINGS && run->params->smooth > 0; round++) {
    for (guint i = 0; i < n; i++)
      if (out[i] || get_error (self, i, moves + 2 * i, &within) < 0 || !within)
        moves[2 * i] = moves[2 * i + 1] = 0;
    for (guint i = 0; i < n; i++)
      for (gint c = 0; c < 2; c++)
        places[i].uv[c] += run->params->smooth * moves[2 * i + c];
  }
}

/* ---- the net ---- */

/* The slope around each place, of the steps from it and from its neighbours. */
static void
make_slopes (ClothUVPlaces * self)
{
  const guint n = self->places->len;
  ClothUVPlace *places = (ClothUVPlace *) self->places->data;
  const guint *starts = (const guint *) self->starts->data;
  const Neighbour *of = (const Neighbour *) self->neighbours->data;
  Sums *sums = (Sums *) g_array_set_size (self->sums, n)->data;

  if (n)
    memset (sums, 0, n * sizeof *sums);
  for (guint i = 0; i < n; i++)
    for (guint k = starts[i]; k < starts[i + 1]; k++) {
      const ClothUVPlace *other = &places[of[k].other];
      const gdouble du[2] = { other->uv[0] - places[i].uv[0],
        other->uv[1] - places[i].uv[1]
      };
      gdouble d[3];

      if (of[k].length < 0)
        continue;
      get_step (&places[i], other, of[k].length, d);
      sums_add (&sums[i], d, du);
    }
  for (guint i = 0; i < n; i++) {
    Sums around = sums[i];
    gdouble inverse[9];

    for (guint k = starts[i]; k < starts[i + 1]; k++)
      if (of[k].length >= 0)
        sums_add_sums (&around, &sums[of[k].other]);
    if (around.n < 2 * NEIGHBOURS
        || !sums_solve (&around, places[i].slope, inverse))
      memset (places[i].slope, 0, sizeof places[i].slope);
  }
}

/* Whether an edge lies on the surface: unbroken, and as long as the cloth lets it be. */
static gboolean
is_edge (const Run * run, guint a, guint b)
{
  const ClothUVPlace *places = (const ClothUVPlace *) run->self->places->data;
  const Neighbour *edge = find_neighbour (run->self, a, b);
  const ClothStretchParams *s = &run->params->stretch;
  const guint8 *out = (const guint8 *) run->self->out->data;
  gdouble flat, pixels, slack;

  if (edge->length < 0 || out[a] || out[b])
    return FALSE;
  flat = hypot (places[a].uv[0] - places[b].uv[0],
      places[a].uv[1] - places[b].uv[1]);
  pixels = hypot (places[a].at[0] - places[b].at[0],
      places[a].at[1] - places[b].at[1]);
  slack = pixels > 0 ? s->slack * MAX (edge->length, flat) / MAX (pixels, 1)
      : 0;
  return flat * (1 - s->stretch) <= edge->length + slack
      && flat * (1 + s->stretch) >= edge->length - slack;
}

/* @self: room to work in; what @net refers to is the caller's until the next call
 * @params: in their ranges
 * @matches: (array length=n_matches): in any order
 * @n_matches: how many
 * @surface: what they lie on
 * @net: (out): the places and their triangles
 * @counts: (inout): what was left out, the triangles and sigma are filled in
 */
void
cloth_uv_places_run (ClothUVPlaces * self, const ClothUVParams * params,
    const ClothUVMatch * matches, guint n_matches,
    const ClothMatchSurface * surface, ClothUVNet * net, ClothUVCounts * counts)
{
  const Run run = { self, params, surface };
  const guint *found;
  guint n_found;

  make_places (&run, matches, n_matches);
  found = cloth_delaunay_run (self->delaunay, self->places->len,
      (const gdouble *) self->points->data, USUAL, &n_found);
  make_neighbours (&run, found, n_found);
  counts->n_outliers = mark_outliers (&run, &counts->sigma);
  set_sigmas (self, counts->sigma);
  mend_outliers (self);
  smooth (&run);
  make_slopes (self);
  g_array_set_size (self->triangles, 0);
  for (guint k = 0; k < 3 * n_found; k += 3)
    if (is_edge (&run, found[k], found[k + 1])
        && is_edge (&run, found[k + 1], found[k + 2])
        && is_edge (&run, found[k + 2], found[k]))
      g_array_append_vals (self->triangles, found + k, 3);
  *net = (ClothUVNet) {
  (const ClothUVPlace *) self->places->data,
        (const guint *) self->triangles->data, self->places->len,
        self->triangles->len / 3};
  counts->n_places = net->n;
  counts->n_triangles = net->n_triangles;
}
