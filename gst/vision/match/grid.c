/* From matched features to the vertices of a grid.
 *
 * Matches are triangulated in the picture. A triangle whose edges the cloth allows, that
 * faces the way its matches say and that no break of the surface crosses tells which
 * vertices it shows. About each such place a polynomial of second order is fitted to the
 * matches around, with weights that fall off with the residual (P. Holland and R. Welsch,
 * 1977) and bending held down by what cloth usually does; where it shows the vertex, the
 * vertex is seen.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/grid.h"

#include <math.h>
#include <string.h>

#include "gst/cv/cv.h"
#include "gst/math/delaunay.h"
#include "gst/math/linalg.h"

/* Usual distance of matches, px. */
#define USUAL 10.0
/* Places of one vertex that are looked at, and from which distance on they are two, px. */
#define PLACES 3
#define APART 6.0
/* Matches of one fit at most. */
#define MOST 64
/* Rounds of weighing and fitting; the first ones forgive more, by this factor each. */
#define ROUNDS 6
#define FORGIVE 2.0
/* Thinner triangles don't tell where they lead, px. */
#define THIN 2.0
#define TERMS CLOTH_WARP_TERMS

/* A vertex that a triangle shows. */
typedef struct
{
  guint vertex, triangle;
  gdouble beyond;               /* how far outside of it, px; 0: inside */
  gdouble x, y;
} Seen;

/* A triangle of matches as a map. */
typedef struct
{
  guint corners[3];
  gdouble origin[2];            /* first corner in the film, px */
  gdouble to_film[4];           /* from the flat picture's pixels */
  gboolean mirrored;
} Triangle;

/* A fit to matches. */
typedef struct
{
  ClothWarp warp;
  gdouble at[2], variance, support;
  gboolean mirrored;
} Fit;

struct _ClothGridder
{
  ClothGridShape shape;
  ClothPlanes *print;
  gint width, height;           /* of the flat picture */
  GPtrArray *aligners;          /* one a thread */
  GArray *warps;                /* ClothWarp: of aligned vertices */
  GArray *open, *next;          /* guint: vertices that are still looked for; that may be found */
  GByteArray *aligned;          /* 1: aligned when the round began */
  ClothDelaunay *delaunay;
  GArray *order;                /* guint: matches by place */
  GArray *points;               /* gdouble: of the places */
  GArray *places;               /* guint: a match of each */
  GArray *triangles;            /* Triangle */
  GArray *seen;                 /* Seen: by vertex */
  GArray *vertices;             /* guint: where in seen each vertex begins */
  GArray *cells, *in_cells;     /* guint: matches by cells of the picture */
};

typedef struct
{
  ClothGridder *self;
  ClothGridParams params;
  const ClothGridMatch *matches;
  const ClothImage *film, *mask;
  const ClothMatchSurface *surface;
  ClothGridVertex *results;
  gint cells[2];                /* across and down */
  gdouble cell;                 /* edge of one, px */
  ClothSimd level;
  gint *contradicted;
} Run;

/* Returns: as measured on rendered cloth of 1.1 mm a pixel
 */
ClothGridParams
cloth_grid_default_params (void)
{
  ClothGridParams params = { 60, cloth_stretch_default_params (), 20, 30, 24, 5,
    0.4, 0.004, 1, 0.5, 2, cloth_align_default_params ()
  };

  return params;
}

static GArray *
numbers (void)
{
  return g_array_new (FALSE, FALSE, sizeof (guint));
}

/* @shape: of the grid
 * @reference: the flat picture; it is copied
 * @error: where to tell what is wrong
 *
 * Returns: (transfer full): room to work in, for one picture at a time; %NULL of a grid that
 *   can't be
 */
ClothGridder *
cloth_gridder_new (const ClothGridShape * shape, const ClothImage * reference,
    GError ** error)
{
  ClothGridder *self;

  if (shape->columns < 2 || shape->columns > CLOTH_GRID_MAX || shape->rows < 2
      || shape->rows > CLOTH_GRID_MAX) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
        "a grid of %d × %d vertices: use 2 to %d each way", shape->columns,
        shape->rows, CLOTH_GRID_MAX);
    return NULL;
  }
  /* also what is no number */
  if (!(shape->cloth_m[0] > 0 && shape->cloth_m[1] > 0
          && isfinite (shape->cloth_m[0] + shape->cloth_m[1]))) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
        "a cloth of %g × %g m: give the width and height of the picture on it",
        shape->cloth_m[0], shape->cloth_m[1]);
    return NULL;
  }
  self = g_new0 (ClothGridder, 1);
  self->shape = *shape;
  self->width = reference->width;
  self->height = reference->height;
  self->print = cloth_planes_new (reference);
  self->aligners =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_aligner_free);
  self->warps = g_array_new (FALSE, FALSE, sizeof (ClothWarp));
  self->open = numbers ();
  self->next = numbers ();
  self->aligned = g_byte_array_new ();
  self->delaunay = cloth_delaunay_new ();
  self->order = numbers ();
  self->points = g_array_new (FALSE, FALSE, sizeof (gdouble));
  self->places = numbers ();
  self->triangles = g_array_new (FALSE, FALSE, sizeof (Triangle));
  self->seen = g_array_new (FALSE, FALSE, sizeof (Seen));
  self->vertices = numbers ();
  self->cells = numbers ();
  self->in_cells = numbers ();
  return self;
}

/* @gridder: (nullable) (transfer full): what to free
 */
void
cloth_gridder_free (ClothGridder * gridder)
{
  if (!gridder)
    return;
  cloth_planes_free (gridder->print);
  g_ptr_array_unref (gridder->aligners);
  g_array_unref (gridder->warps);
  g_array_unref (gridder->open);
  g_array_unref (gridder->next);
  g_byte_array_unref (gridder->aligned);
  cloth_delaunay_free (gridder->delaunay);
  g_array_unref (gridder->order);
  g_array_unref (gridder->points);
  g_array_unref (gridder->places);
  g_array_unref (gridder->triangles);
  g_array_unref (gridder->seen);
  g_array_unref (gridder->vertices);
  g_array_unref (gridder->cells);
  g_array_unref (gridder->in_cells);
  g_free (gridder);
}

/* ---- the flat picture's pixels ---- */

static void
to_reference (const ClothGridder * self, gdouble u, gdouble v, gdouble to[2])
{
  to[0] = u * self->width / self->shape.cloth_m[0] - 0.5;
  to[1] = v * self->height / self->shape.cloth_m[1] - 0.5;
}

static void
find_vertex (const ClothGridder * self, guint vertex, gdouble to[2])
{
  const guint columns = (guint) self->shape.columns;

  to[0] = (gdouble) (vertex % columns) * self->width / (columns - 1) - 0.5;
  to[1] = (gdouble) (vertex / columns) * self->height
      / (self->shape.rows - 1) - 0.5;
}

/* ---- triangles ---- */

static gint
compare_matches (gconstpointer pa, gconstpointer pb, gpointer data)
{
  const ClothGridMatch *matches = data;
  const guint a = *(const guint *) pa, b = *(const guint *) pb;

  if (matches[a].x != matches[b].x)
    return matches[a].x < matches[b].x ? -1 : 1;
  if (matches[a].y != matches[b].y)
    return matches[a].y < matches[b].y ? -1 : 1;
  return a < b ? -1 : a > b;
}

/* Matches that are numbers, one a place; what shares the place of another is not looked
 * at: it is the same feature with another angle. */
static void
collect (Run * run, guint n_matches)
{
  ClothGridder *self = run->self;
  const ClothGridMatch *m = run->matches;

  g_array_set_size (self->order, 0);
  g_array_set_size (self->places, 0);
  g_array_set_size (self->points, 0);
  for (guint i = 0; i < n_matches; i++)
    if (isfinite (m[i].x + m[i].y + m[i].u + m[i].v)
        && m[i].metres_per_pixel > 0)
      g_array_append_val (self->order, i);
  if (!self->order->len)
    return;
  g_array_sort_with_data (self->order, compare_matches, (gpointer) m);
  for (guint k = 0; k < self->order->len; k++) {
    const guint i = g_array_index (self->order, guint, k);
    const gdouble point[2] = { m[i].x, m[i].y };

    if (k) {
      const guint last = g_array_index (self->places, guint,
          self->places->len - 1);

      if (m[i].x == m[last].x && m[i].y == m[last].y)
        continue;
    }
    g_array_append_val (self->places, i);
    g_array_append_vals (self->points, point, 2);
  }
}

/* Whether the cloth allows an edge, unbroken. */
static gboolean
is_edge (const Run * run, const ClothGridMatch * a, const ClothGridMatch * b)
{
  const gfloat from[2] = { a->x, a->y }, to[2] = { b->x, b->y };
  const gdouble distance = hypot (a->u - b->u, a->v - b->v);
  ClothStretchRange range;

  return hypot (to[0] - from[0], to[1] - from[1]) <= run->params.reach
      && cloth_stretch_get_range (&run->params.stretch, run->surface, from, to,
      sqrt ((gdouble) a->metres_per_pixel * b->metres_per_pixel), &range)
      && !range.broken && distance >= range.least && distance <= range.most;
}

/* Returns: whether the triangle is a piece of cloth */
static gboolean
make_triangle (const Run * run, const guint places[3], Triangle * triangle)
{
  const ClothGridMatch *c[3];
  gdouble flat[3][2], a[4], b[4], det, longest = 0;

  for (gint k = 0; k < 3; k++) {
    triangle->corners[k] = g_array_index (run->self->places, guint, places[k]);
    c[k] = &run->matches[triangle->corners[k]];
    to_reference (run->self, c[k]->u, c[k]->v, flat[k]);
  }
  if (c[0]->mirrored != c[1]->mirrored || c[0]->mirrored != c[2]->mirrored)
    return FALSE;
  for (gint k = 0; k < 2; k++) {
    a[k] = flat[k + 1][0] - flat[0][0];
    a[2 + k] = flat[k + 1][1] - flat[0][1];
    b[k] = c[k + 1]->x - c[0]->x;
    b[2 + k] = c[k + 1]->y - c[0]->y;
  }
  for (gint k = 0; k < 3; k++)
    longest = MAX (longest, hypot (c[k]->x - c[(k + 1) % 3]->x,
            c[k]->y - c[(k + 1) % 3]->y));
  /* Delaunay's triangles all turn the same way in the film */
  if (b[0] * b[3] - b[1] * b[2] < THIN * longest)
    return FALSE;
  det = a[0] * a[3] - a[1] * a[2];
  if (c[0]->mirrored ? det >= 0 : det <= 0)
    return FALSE;
  for (gint k = 0; k < 3; k++)
    if (!is_edge (run, c[k], c[(k + 1) % 3]))
      return FALSE;
  for (gint row = 0; row < 2; row++) {
    triangle->to_film[2 * row] = (b[2 * row] * a[3]
        - b[2 * row + 1] * a[2]) / det;
    triangle->to_film[2 * row + 1] = (b[2 * row + 1] * a[0]
        - b[2 * row] * a[1]) / det;
  }
  triangle->origin[0] = c[0]->x;
  triangle->origin[1] = c[0]->y;
  triangle->mirrored = c[0]->mirrored;
  return TRUE;
}

/* How far a place is outside of a triangle at least, px. */
static gdouble
measure_beyond (const Run * run, const Triangle * t, const gdouble at[2])
{
  gdouble beyond = 0;

  for (gint k = 0; k < 3; k++) {
    const ClothGridMatch *a = &run->matches[t->corners[k]];
    const ClothGridMatch *b = &run->matches[t->corners[(k + 1) % 3]];
    const gdouble dx = b->x - a->x, dy = b->y - a->y;

    beyond = MAX (beyond, (dy * (at[0] - a->x) - dx * (at[1] - a->y))
        / hypot (dx, dy));
  }
  return beyond;
}

/* Notes the vertices that a triangle shows, or nearly does. */
static void
look_at_triangle (Run * run, guint number)
{
  ClothGridder *self = run->self;
  const Triangle *t = &g_array_index (self->triangles, Triangle, number);
  const gdouble *a = t->to_film;
  const gdouble det = a[0] * a[3] - a[1] * a[2];
  const gdouble step[2] = { (gdouble) self->width / (self->shape.columns - 1),
    (gdouble) self->height / (self->shape.rows - 1)
  };
  /* of a disc in the film in the flat picture */
  const gdouble reach[2] = {
    run->params.beyond * hypot (a[1], a[3]) / fabs (det),
    run->params.beyond * hypot (a[0], a[2]) / fabs (det)
  };
  const gint last[2] = { self->shape.columns - 1, self->shape.rows - 1 };
  gdouble flat[3][2];
  gint from[2], to[2];

  for (gint k = 0; k < 3; k++)
    to_reference (self, run->matches[t->corners[k]].u,
        run->matches[t->corners[k]].v, flat[k]);
  for (gint c = 0; c < 2; c++) {
    const gdouble low = MIN (MIN (flat[0][c], flat[1][c]), flat[2][c]);
    const gdouble high = MAX (MAX (flat[0][c], flat[1][c]), flat[2][c]);

    from[c] = (gint) CLAMP (ceil ((low - reach[c] + 0.5) / step[c]), 0,
        last[c]);
    to[c] = (gint) CLAMP (floor ((high + reach[c] + 0.5) / step[c]), -1,
        last[c]);
  }
  for (gint row = from[1]; row <= to[1]; row++)
    for (gint column = from[0]; column <= to[0]; column++) {
      Seen seen = { (guint) (row * self->shape.columns + column), number };
      gdouble there[2], d[2], at[2];

      find_vertex (self, seen.vertex, there);
      d[0] = there[0] - flat[0][0];
      d[1] = there[1] - flat[0][1];
      seen.x = at[0] = t->origin[0] + a[0] * d[0] + a[1] * d[1];
      seen.y = at[1] = t->origin[1] + a[2] * d[0] + a[3] * d[1];
      seen.beyond = measure_beyond (run, t, at);
      if (seen.beyond <= run->params.beyond)
        g_array_append_val (self->seen, seen);
    }
}

static gint
compare_seen (gconstpointer pa, gconstpointer pb)
{
  const Seen *a = pa, *b = pb;

  if (a->vertex != b->vertex)
    return a->vertex < b->vertex ? -1 : 1;
  if (a->beyond != b->beyond)
    return a->beyond < b->beyond ? -1 : 1;
  return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static void
triangulate (Run * run)
{
  ClothGridder *self = run->self;
  const guint n_vertices = (guint) (self->shape.columns * self->shape.rows);
  const guint *corners;
  guint n, *starts;

  g_array_set_size (self->triangles, 0);
  g_array_set_size (self->seen, 0);
  corners = cloth_delaunay_run (self->delaunay, self->places->len,
      (const gdouble *) self->points->data, USUAL, &n);
  for (guint k = 0; k < n; k++) {
    Triangle triangle;

    if (make_triangle (run, corners + 3 * k, &triangle)) {
      g_array_append_val (self->triangles, triangle);
      look_at_triangle (run, self->triangles->len - 1);
    }
  }
  if (self->seen->len > 1)
    g_array_sort (self->seen, compare_seen);
  starts = (guint *) g_array_set_size (self->vertices, n_vertices + 1)->data;
  for (guint v = 0, k = 0; v <= n_vertices; v++) {
    while (k < self->seen->len
        && g_array_index (self->seen, Seen, k).vertex < v)
      k++;
    starts[v] = k;
  }
}

/* ---- matches around a place ---- */

static gint
find_cell (const Run * run, gdouble x, gint axis)
{
  return (gint) CLAMP (floor (x / run->cell), 0, run->cells[axis] - 1);
}

static void
sort_into_cells (Run * run)
{
  ClothGridder *self = run->self;
  const guint n = self->places->len;
  guint *starts, *in;

  run->cell = MAX (run->params.radius, 8);
  run->cells[0] = (gint) ceil (run->film->width / run->cell);
  run->cells[1] = (gint) ceil (run->film->height / run->cell);
  starts = (guint *) g_array_set_size (self->cells,
      (guint) (run->cells[0] * run->cells[1]) + 1)->data;
  in = (guint *) g_array_set_size (self->in_cells, n)->data;
  memset (starts, 0, self->cells->len * sizeof *starts);
  for (gint pass = 0; pass < 2; pass++) {
    for (guint k = n; k > 0; k--) {
      const guint i = g_array_index (self->places, guint, k - 1);
      const gint cell = find_cell (run, run->matches[i].y, 1) * run->cells[0]
          + find_cell (run, run->matches[i].x, 0);

      if (pass)
        in[--starts[cell]] = i;
      else
        starts[cell]++;
    }
    for (guint c = 1; !pass && c < self->cells->len; c++)
      starts[c] += starts[c - 1];
  }
}

typedef struct
{
  guint match;
  gdouble square;
} Near;

/* Returns: how many of the nearest matches there are, by distance; of one side */
static guint
gather (const Run * run, const gdouble at[2], gboolean mirrored,
    Near near[MOST])
{
  const guint *starts = (const guint *) run->self->cells->data;
  const guint *in = (const guint *) run->self->in_cells->data;
  const gdouble radius = run->params.radius;
  const guint most = run->params.most;
  guint n = 0;

  for (gint cy = find_cell (run, at[1] - radius, 1);
      cy <= find_cell (run, at[1] + radius, 1); cy++)
    for (gint cx = find_cell (run, at[0] - radius, 0);
        cx <= find_cell (run, at[0] + radius, 0); cx++) {
      const guint cell = (guint) (cy * run->cells[0] + cx);

      for (guint k = starts[cell]; k < starts[cell + 1]; k++) {
        const ClothGridMatch *m = &run->matches[in[k]];
        const gdouble dx = m->x - at[0], dy = m->y - at[1];
        const Near here = { in[k], dx * dx + dy * dy };
        guint j;

        if (here.square > radius * radius || m->mirrored != mirrored
            || (n == most && here.square >= near[n - 1].square))
          continue;
        if (n < most)
          n++;
        for (j = n - 1; j > 0 && near[j - 1].square > here.square; j--)
          near[j] = near[j - 1];
        near[j] = here;
      }
    }
  return n;
}

/* Leaves out what lies beyond a break of the surface. */
static guint
drop_broken (const Run * run, const gdouble at[2], Near near[MOST], guint n)
{
  const gfloat from[2] = { (gfloat) at[0], (gfloat) at[1] };
  guint left = 0;

  if (!run->surface)
    return n;
  for (guint k = 0; k < n; k++) {
    const gfloat to[2] = { run->matches[near[k].match].x,
      run->matches[near[k].match].y
    };
    gdouble length;
    gboolean broken;

    if (!cloth_surface_measure (run->surface, from, to,
            run->params.stretch.depth_step, &length, &broken) || !broken)
      near[left++] = near[k];
  }
  return left;
}

/* ---- a polynomial through matches ---- */

/* One round: @weights are of the squared residuals, 1/px².
 * Returns: FALSE if the matches don't tell it */
static gboolean
solve (const Run * run, const Near * near, guint n, const gdouble * weights,
    ClothWarp * warp, gdouble inverse[TERMS * TERMS])
{
  const gdouble bend = run->params.bend * warp->unit * warp->unit;
  gdouble a[TERMS * TERMS] = { 0 }, b[2][TERMS] = { {0} };

  for (guint i = 0; i < n; i++) {
    const ClothGridMatch *m = &run->matches[near[i].match];
    gdouble terms[TERMS], to[2];

    cloth_warp_get_terms (warp, m->x, m->y, terms);
    to_reference (run->self, m->u, m->v, to);
    for (gint k = 0; k < TERMS; k++) {
      for (gint l = 0; l < TERMS; l++)
        a[TERMS * k + l] += weights[i] * terms[k] * terms[l];
      for (gint c = 0; c < 2; c++)
        b[c][k] += weights[i] * terms[k] * to[c];
    }
  }
  for (gint k = 3; k < TERMS; k++)
    a[(TERMS + 1) * k] += 1 / (bend * bend);
  if (!cloth_cholesky_factor (TERMS, a))
    return FALSE;
  for (gint c = 0; c < 2; c++) {
    cloth_cholesky_solve (TERMS, a, b[c]);
    memcpy (warp->terms[c], b[c], sizeof b[c]);
  }
  cloth_cholesky_inverse (TERMS, a, inverse);
  return TRUE;
}

/* How far the map is off at a match, squared, as seen in the film. */
static gdouble
get_residual (const Run * run, const ClothWarp * warp, const gdouble slopes[4],
    gdouble det, const ClothGridMatch * m)
{
  gdouble to[2], here[2];

  to_reference (run->self, m->u, m->v, to);
  cloth_warp_apply (warp, m->x, m->y, here);
  to[0] -= here[0];
  to[1] -= here[1];
  here[0] = (slopes[3] * to[0] - slopes[1] * to[1]) / det;
  here[1] = (slopes[0] * to[1] - slopes[2] * to[0]) / det;
  return here[0] * here[0] + here[1] * here[1];
}

/* @at: about where the vertex is
 *
 * Returns: FALSE if too few matches agree */
static gboolean
fit_place (const Run * run, guint vertex, const Triangle * triangle,
    const gdouble at[2], Fit * fit)
{
  const ClothGridParams *p = &run->params;
  const gdouble *a = triangle->to_film;
  const gdouble size = a[0] * a[3] - a[1] * a[2];
  ClothWarp *warp = &fit->warp;
  Near near[MOST];
  gdouble weights[MOST], inverse[TERMS * TERMS], terms[TERMS], to[2], sum = 0;
  guint n = gather (run, at, triangle->mirrored, near);

  n = drop_broken (run, at, near, n);
  if (n < p->least)
    return FALSE;
  find_vertex (run->self, vertex, to);
  *warp = (ClothWarp) {
    {
    at[0], at[1]}
    , p->radius, { {
    to[0], p->radius * a[3] / size, -p->radius * a[1] / size}
    , {
    to[1], -p->radius * a[2] / size, p->radius * a[0] / size}
    }
  };
  for (gint round = 0; round < ROUNDS; round++) {
    const gdouble scale = p->outlier * pow (FORGIVE, MAX (3 - round, 0));
    gdouble slopes[4], det;

    cloth_warp_get_slopes (warp, at[0], at[1], slopes);
    det = slopes[0] * slopes[3] - slopes[1] * slopes[2];
    if (!(fabs (det) > 0))
      return FALSE;
    fit->support = sum = 0;
    for (guint i = 0; i < n; i++) {
      const gdouble square = get_residual (run, warp, slopes, det,
          &run->matches[near[i].match]);
      const gdouble weight = 1 / (1 + square / (scale * scale));

      fit->support += weight;
      sum += weight * square;
      weights[i] = weight / (p->noise * p->noise);
    }
    if (!(fit->support >= p->least)
        || !solve (run, near, n, weights, warp, inverse))
      return FALSE;
  }
  fit->at[0] = at[0];
  fit->at[1] = at[1];
  if (!cloth_warp_find (warp, to, fit->at))
    return FALSE;
  cloth_warp_get_terms (warp, fit->at[0], fit->at[1], terms);
  fit->variance = 0;
  for (gint k = 0; k < TERMS; k++)
    for (gint l = 0; l < TERMS; l++)
      fit->variance += terms[k] * inverse[TERMS * k + l] * terms[l];
  /* more than noise is told by the residuals: two each, less the six of an affine map */
  sum /= (2 * MAX (fit->support - 3, 1)) * p->noise * p->noise;
  fit->variance *= MAX (sum, 1);
  fit->mirrored = triangle->mirrored;
  return hypot (fit->at[0] - at[0], fit->at[1] - at[1]) <= p->radius
      && fit->variance <= p->uncertain * p->uncertain;
}

/* ---- vertices ---- */

static gboolean
is_inside (const ClothImage * image, const gdouble at[2])
{
  return at[0] >= -0.5 && at[1] >= -0.5 && at[0] < image->width - 0.5
      && at[1] < image->height - 0.5;
}

/* Returns: whether a place of the vertex has most support; @contradicted: (out): whether
 * another has as much */
static gboolean
choose_place (const Run * run, guint vertex, Fit * best,
    gboolean * contradicted)
{
  const guint *starts = (const guint *) run->self->vertices->data;
  const Seen *seen = (const Seen *) run->self->seen->data;
  gdouble tried[PLACES][2], rival = 0;
  guint n_tried = 0;
  Fit fit;

  *contradicted = FALSE;
  *best = (Fit) {
  .support = 0};
  for (guint k = starts[vertex]; k < starts[vertex + 1] && n_tried < PLACES;
      k++) {
    const Triangle *triangle = &g_array_index (run->self->triangles, Triangle,
        seen[k].triangle);
    const gdouble at[2] = { seen[k].x, seen[k].y };
    gboolean again = FALSE;

    if (seen[k].beyond > 0 && best->support > 0)
      break;
    for (guint i = 0; i < n_tried; i++)
      again |= hypot (at[0] - tried[i][0], at[1] - tried[i][1]) < APART;
    if (again || !is_inside (run->film, at))
      continue;
    tried[n_tried][0] = at[0];
    tried[n_tried++][1] = at[1];
    if (!fit_place (run, vertex, triangle, at, &fit)
        || !is_inside (run->film, fit.at))
      continue;
    if (best->support > 0 && hypot (fit.at[0] - best->at[0],
            fit.at[1] - best->at[1]) < APART)
      continue;
    if (fit.support > best->support) {
      rival = MAX (rival, best->support);
      *best = fit;
    } else
      rival = MAX (rival, fit.support);
  }
  if (!(best->support > 0))
    return FALSE;
  *contradicted = rival > run->params.rival * best->support;
  return !*contradicted;
}

/* Looks for a vertex by the print, from what @first says is about it. */
static ClothAlignResult
align (const Run * run, guint vertex, guint worker, const ClothWarp * first,
    gboolean mirrored)
{
  const ClothAlignView view = { run->film, run->mask, run->surface };
  const gdouble most = run->params.uncertain * run->params.uncertain;
  ClothWarp warp = *first;
  ClothAlignment alignment;
  ClothAlignResult result;
  gdouble place[2];

  find_vertex (run->self, vertex, place);
  result = cloth_align_run (g_ptr_array_index (run->self->aligners, worker),
      &run->params.align, run->self->print, &view, place, &warp, &alignment,
      run->level);
  if (result != CLOTH_ALIGN_FOUND)
    return result;
  if (!is_inside (run->film, alignment.at))
    return CLOTH_ALIGN_UNLIKE;
  if (alignment.xx + alignment.yy > 2 * most)
    return CLOTH_ALIGN_PLAIN;
  g_array_index (run->self->warps, ClothWarp, vertex) = warp;
  run->results[vertex] = (ClothGridVertex) {
  CLOTH_GRID_ALIGNED, mirrored, alignment.at[0], alignment.at[1],
        alignment.xx, alignment.xy, alignment.yy};
  return CLOTH_ALIGN_FOUND;
}

/* By the matches, then by the print; the matches' place stays where there is no print. */
static void
place_vertices (gpointer data, guint begin, guint end, guint worker)
{
  const Run *run = data;
  gint n_contradicted = 0;

  for (guint v = begin; v < end; v++) {
    ClothGridVertex *result = &run->results[v];
    gboolean contradicted;
    Fit fit;

    *result = (ClothGridVertex) {
    CLOTH_GRID_UNSEEN, FALSE, NAN, NAN, NAN, NAN, NAN};
    if (!choose_place (run, v, &fit, &contradicted))
      n_contradicted += contradicted;
    else if (align (run, v, worker, &fit.warp, fit.mirrored)
        == CLOTH_ALIGN_PLAIN)
      *result = (ClothGridVertex) {
      CLOTH_GRID_MATCHED, fit.mirrored, fit.at[0], fit.at[1], fit.variance, 0,
          fit.variance};
  }
  g_atomic_int_add (run->contradicted, n_contradicted);
}

/* The k-th neighbour of a vertex in the grid. Returns: FALSE at the border */
static gboolean
get_neighbour (const ClothGridder * self, guint vertex, gint k,
    guint * neighbour)
{
  static const gint steps[4][2] = { {-1, 0}, {1, 0}, {0, -1}, {0, 1} };
  const gint column = (gint) (vertex % (guint) self->shape.columns)
      + steps[k][0];
  const gint row = (gint) (vertex / (guint) self->shape.columns) + steps[k][1];

  *neighbour = (guint) (row * self->shape.columns + column);
  return column >= 0 && row >= 0 && column < self->shape.columns
      && row < self->shape.rows;
}

/* Vertices beside aligned ones, from what these say. */
static void
extend_vertices (gpointer data, guint begin, guint end, guint worker)
{
  const Run *run = data;

  for (guint i = begin; i < end; i++) {
    const guint v = g_array_index (run->self->next, guint, i);
    guint from;

    for (gint k = 0; k < 4; k++)
      if (get_neighbour (run->self, v, k, &from)
          && run->self->aligned->data[from]
          && align (run, v, worker, &g_array_index (run->self->warps,
                  ClothWarp, from), run->results[from].mirrored)
          == CLOTH_ALIGN_FOUND)
        break;
  }
}

/* Goes on from aligned vertices to their neighbours, until no more are found. */
static void
extend (Run * run, guint n, ClothPool * pool)
{
  ClothGridder *self = run->self;
  guint8 *aligned;

  g_byte_array_set_size (self->aligned, n);
  aligned = self->aligned->data;
  memset (aligned, 0, n);
  do {
    g_array_set_size (self->next, 0);
    g_array_set_size (self->open, 0);
    for (guint v = 0; v < n; v++)
      if (!aligned[v] && run->results[v].state == CLOTH_GRID_ALIGNED)
        g_array_append_val (self->open, v);
    for (guint i = 0; i < self->open->len; i++)
      aligned[g_array_index (self->open, guint, i)] = 1;
    /* beside those that are new */
    for (guint i = 0; i < self->open->len; i++)
      for (gint k = 0; k < 4; k++) {
        guint v;

        if (get_neighbour (self, g_array_index (self->open, guint, i), k, &v)
            && run->results[v].state == CLOTH_GRID_UNSEEN && !aligned[v]) {
          aligned[v] = 2;
          g_array_append_val (self->next, v);
        }
      }
    for (guint i = 0; i < self->next->len; i++)
      aligned[g_array_index (self->next, guint, i)] = 0;
    cloth_pool_run_one_by_one (pool, extend_vertices, run, self->next->len);
  } while (self->next->len > 0);
}

static ClothGridParams
clamp_params (const ClothGridParams * params)
{
  ClothGridParams p = *params;

  p.stretch = cloth_stretch_clamp_params (&params->stretch);
  p.reach = MAX (p.reach, 0);
  p.beyond = MAX (p.beyond, 0);
  p.radius = CLAMP (p.radius, 1, 1000);
  p.most = CLAMP (p.most, 3, MOST);
  p.least = CLAMP (p.least, 3, p.most);
  p.noise = MAX (p.noise, 1e-3);
  p.bend = CLAMP (p.bend, 1e-9, 1);
  p.outlier = MAX (p.outlier, 1e-3);
  p.rival = CLAMP (p.rival, 0, 1);
  p.uncertain = MAX (p.uncertain, 0);
  p.align = cloth_align_clamp_params (&params->align);
  return p;
}

/* @gridder: room to work in
 * @params: what counts; values out of range are brought into it
 * @matches: (array length=n_matches): what the picture shows, as far as it is verified;
 *   those that aren't numbers are left out
 * @n_matches: number of them
 * @film: the picture
 * @mask: (nullable): where it isn't 0 the film shows cloth; of the film's size; %NULL:
 *   everywhere
 * @surface: (nullable): under the film's pixels, for breaks and lengths
 * @vertices: (out) (array): row by row
 * @gridding: (out): counts
 * @pool: (nullable): threads to share the work
 * @level: instructions to use
 */
void
cloth_gridder_run (ClothGridder * gridder, const ClothGridParams * params,
    const ClothGridMatch * matches, guint n_matches, const ClothImage * film,
    const ClothImage * mask, const ClothMatchSurface * surface,
    ClothGridVertex * vertices, ClothGridding * gridding, ClothPool * pool,
    ClothSimd level)
{
  const guint n = (guint) (gridder->shape.columns * gridder->shape.rows);
  gint contradicted = 0;
  Run run = { gridder, clamp_params (params), matches, film, mask, surface,
    vertices,.level = level,.contradicted = &contradicted
  };

  while (gridder->aligners->len < cloth_pool_get_n_threads (pool))
    g_ptr_array_add (gridder->aligners, cloth_aligner_new ());
  collect (&run, n_matches);
  triangulate (&run);
  sort_into_cells (&run);
  g_array_set_size (gridder->warps, n);
  cloth_pool_run_one_by_one (pool, place_vertices, &run, n);
  extend (&run, n, pool);
  *gridding = (ClothGridding) {
  .n_contradicted = (guint) contradicted};
  for (guint v = 0; v < n; v++) {
    gridding->n_matched += vertices[v].state == CLOTH_GRID_MATCHED;
    gridding->n_aligned += vertices[v].state == CLOTH_GRID_ALIGNED;
  }
}

/* @reference: what was matched with
 * @cloth_m: width and height of the flat picture on the cloth, m
 * @features: of a picture
 * @matches: (array): one a feature, verified
 * @to: (out) (array): room for one a feature
 *
 * Returns: how many are matched, which @to then has
 */
guint
cloth_grid_get_matches (const ClothReference * reference,
    const gdouble cloth_m[2], const ClothCvFeatures * features,
    const ClothMatch * matches, ClothGridMatch * to)
{
  const ClothReferenceFeatures *r = cloth_reference_get_features (reference);
  const gdouble alpha = cloth_reference_get_metres_per_pixel (reference);
  guint n = 0;

  for (guint i = 0; i < features->n; i++) {
    const guint32 k = matches[i].reference;

    if (matches[i].state != CLOTH_MATCH_MATCHED)
      continue;
    to[n++] = (ClothGridMatch) {
    features->x[i], features->y[i],
          (gfloat) (cloth_m[0] * (r->x[k] + 0.5) / r->width),
          (gfloat) (cloth_m[1] * (r->y[k] + 0.5) / r->height),
          (gfloat) (alpha * r->scale[k] / features->scale[i]), r->side[k] > 0};
  }
  return n;
}
