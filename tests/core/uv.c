/* uv of pixels and vertices in space, of surfaces whose geodesics are known exactly: a plane
 * seen obliquely, and a cylinder.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/uv/uv.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"

#define WIDTH 161
#define HEIGHT 121
#define N_PIXELS (WIDTH * HEIGHT)
#define FOCAL 300.0
#define MIDDLE_X 80.0
#define MIDDLE_Y 60.0
#define COLUMNS 7
#define ROWS 6
#define N_VERTICES (COLUMNS * ROWS)
#define CLOTH_W 0.4
#define CLOTH_H 0.3
/* Of the cylinder, whose axis stands upright in front of the camera. */
#define RADIUS 0.12
#define AXIS_Z 1.0

typedef gboolean (*Shape) (gdouble x, gdouble y, gdouble point[3],
    gdouble uv[2]);

typedef struct
{
  gfloat *points, *uv, *truth;
  ClothMatchSurface surface;
  GArray *matches;
  ClothUV *dense;
  ClothUVCounts counts;
} Scene;

/* Turned by 60° about the vertical; a metre along it is a metre of u. */
static gboolean
plane (gdouble x, gdouble y, gdouble point[3], gdouble uv[2])
{
  const gdouble a = 60 * G_PI / 180;
  const gdouble rx = (x - MIDDLE_X) / FOCAL, ry = (y - MIDDLE_Y) / FOCAL;
  /* (s cos a, v, 1 + s sin a) */
  const gdouble s = rx / (cos (a) - rx * sin (a)), z = 1 + s * sin (a);

  point[0] = rx * z;
  point[1] = ry * z;
  point[2] = z;
  uv[0] = 0.2 + s;
  uv[1] = 0.15 + point[1];
  return uv[0] >= 0 && uv[0] <= CLOTH_W && uv[1] >= 0 && uv[1] <= CLOTH_H;
}

/* The near half as far as 65° from the middle: u is the arc. */
static gboolean
cylinder (gdouble x, gdouble y, gdouble point[3], gdouble uv[2])
{
  const gdouble rx = (x - MIDDLE_X) / FOCAL, ry = (y - MIDDLE_Y) / FOCAL;
  /* (rx z)² + (z − AXIS_Z)² = RADIUS² */
  const gdouble a = 1 + rx * rx;
  const gdouble root = AXIS_Z * AXIS_Z - a * (AXIS_Z * AXIS_Z
      - RADIUS * RADIUS);
  const gdouble z = (AXIS_Z - sqrt (root)) / a;
  gdouble turn;

  if (!(root > 0))
    return FALSE;
  point[0] = rx * z;
  point[1] = ry * z;
  point[2] = z;
  turn = asin (point[0] / RADIUS);
  uv[0] = 0.2 + RADIUS * turn;
  uv[1] = 0.15 + point[1];
  return fabs (turn) < 65 * G_PI / 180 && uv[1] >= 0 && uv[1] <= CLOTH_H;
}

static void
scene_init (Scene * s, Shape shape)
{
  s->points = g_new (gfloat, 3 * N_PIXELS);
  s->truth = g_new (gfloat, 2 * N_PIXELS);
  s->uv = g_new (gfloat, 2 * N_PIXELS);
  for (guint i = 0; i < N_PIXELS; i++) {
    gdouble p[3], uv[2];
    const gboolean is = shape (i % WIDTH, i / WIDTH, p, uv);

    for (guint c = 0; c < 3; c++)
      s->points[3 * i + c] = is ? (gfloat) p[c] : NAN;
    for (guint c = 0; c < 2; c++)
      s->truth[2 * i + c] = is ? (gfloat) uv[c] : NAN;
  }
  s->surface = (ClothMatchSurface) {
  s->points, WIDTH, HEIGHT, WIDTH};
  s->matches = g_array_new (FALSE, FALSE, sizeof (ClothUVMatch));
  s->dense = cloth_uv_new ();
}

static void
scene_clear (Scene * s)
{
  g_free (s->points);
  g_free (s->truth);
  g_free (s->uv);
  g_array_unref (s->matches);
  cloth_uv_free (s->dense);
}

/* True matches, about every @step px. */
static void
add_matches (Scene * s, Shape shape, gdouble step, guint64 seed)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gdouble y = 1; y < HEIGHT - 1; y += step)
    for (gdouble x = 1; x < WIDTH - 1; x += step) {
      const gdouble px = x + (cloth_random_uniform (&random) - 0.5) * step / 2;
      const gdouble py = y + (cloth_random_uniform (&random) - 0.5) * step / 2;
      gdouble p[3], uv[2];

      if (shape (px, py, p, uv)) {
        const ClothUVMatch match = { (gfloat) px, (gfloat) py, (gfloat) uv[0],
          (gfloat) uv[1]
        };

        g_array_append_val (s->matches, match);
      }
    }
}

static void
run (Scene * s, const ClothUVParams * params, ClothPool * pool)
{
  cloth_uv_run (s->dense, params, (const ClothUVMatch *) s->matches->data,
      s->matches->len, &s->surface, pool, s->uv, &s->counts);
}

/* Pixels are large here: 3 mm. */
static ClothUVParams
usual (void)
{
  ClothUVParams params = cloth_uv_default_params ();

  params.stretch.depth_step = 0.03;
  return params;
}

/* The paper's: pure interpolation, nothing beyond. */
static ClothUVParams
pure (void)
{
  ClothUVParams params = usual ();

  params.outlier = params.smooth = params.reach = params.together = 0;
  return params;
}

static gdouble
mean_error (const Scene * s, gdouble * worst, guint * n)
{
  gdouble sum = 0;

  *worst = 0;
  *n = 0;
  for (guint i = 0; i < N_PIXELS; i++) {
    const gdouble e = hypot (s->uv[2 * i] - s->truth[2 * i],
        s->uv[2 * i + 1] - s->truth[2 * i + 1]);

    if (isnan (s->uv[2 * i]))
      continue;
    g_assert_false (isnan (s->truth[2 * i]));
    sum += e;
    *worst = MAX (*worst, e);
    ++*n;
  }
  return sum / MAX (*n, 1);
}

/* As the paper's figure 8, left: the same triangles, flat in the picture. */
static gdouble
error_in_picture (const Scene * s)
{
  g_autofree gfloat *flat = g_new (gfloat, 3 * N_PIXELS);
  g_autofree gfloat *uv = g_new (gfloat, 2 * N_PIXELS);
  const ClothMatchSurface paper = { flat, WIDTH, HEIGHT, WIDTH };
  g_autoptr (ClothUV) dense = cloth_uv_new ();
  ClothUVParams params = pure ();
  ClothUVCounts counts;
  gdouble sum = 0;
  guint n = 0;

  params.stretch.slack = 1e9;
  for (guint i = 0; i < N_PIXELS; i++) {
    flat[3 * i] = isnan (s->truth[2 * i]) ? NAN : (gfloat) (i % WIDTH);
    flat[3 * i + 1] = (gfloat) (i / WIDTH);
    flat[3 * i + 2] = isnan (s->truth[2 * i]) ? NAN : 1;
  }
  cloth_uv_run (dense, &params, (const ClothUVMatch *) s->matches->data,
      s->matches->len, &paper, NULL, uv, &counts);
  for (guint i = 0; i < N_PIXELS; i++)
    if (!isnan (uv[2 * i]) && !isnan (s->uv[2 * i])) {
      sum += hypot (uv[2 * i] - s->truth[2 * i],
          uv[2 * i + 1] - s->truth[2 * i + 1]);
      n++;
    }
  return sum / n;
}

/* A plane's geodesics are the picture's straight lines. */
static void
test_plane (void)
{
  const ClothUVParams params = pure ();
  gdouble worst;
  Scene s;
  guint n;

  scene_init (&s, plane);
  add_matches (&s, plane, 12, 1);
  run (&s, &params, NULL);
  g_assert_cmpfloat (mean_error (&s, &worst, &n), <, 0.0001);
  g_assert_cmpfloat (worst, <, 0.002);
  g_assert_cmpuint (n, ==, s.counts.n_between);
  g_assert_cmpuint (n, >, s.counts.n_surface * 3 / 5);
  g_assert_cmpfloat (3 * mean_error (&s, &worst, &n), <, error_in_picture (&s));
  scene_clear (&s);
}

/* The paper's figure 7. */
static void
test_cylinder (void)
{
  const ClothUVParams params = pure ();
  gdouble worst;
  Scene s;
  guint n;

  scene_init (&s, cylinder);
  add_matches (&s, cylinder, 20, 2);
  run (&s, &params, NULL);
  g_assert_cmpfloat (mean_error (&s, &worst, &n), <, 0.0005);
  g_assert_cmpfloat (3 * mean_error (&s, &worst, &n), <, error_in_picture (&s));
  scene_clear (&s);
}

/* On beyond the matches, as far as asked for. */
static void
test_reach (void)
{
  ClothUVParams params = pure ();
  gdouble worst;
  guint n, n_within;
  Scene s;

  scene_init (&s, cylinder);
  add_matches (&s, cylinder, 10, 3);
  run (&s, &params, NULL);
  n_within = s.counts.n_between;
  g_assert_cmpuint (s.counts.n_beyond, ==, 0);
  params.reach = 8;
  run (&s, &params, NULL);
  g_assert_cmpuint (s.counts.n_between, ==, n_within);
  g_assert_cmpfloat (mean_error (&s, &worst, &n), <, 0.0006);
  g_assert_cmpfloat (worst, <, 0.01);
  g_assert_cmpuint (n, ==, n_within + s.counts.n_beyond);
  g_assert_cmpuint (n, >, s.counts.n_surface * 95 / 100);
  scene_clear (&s);
}

/* A wrong match among right ones spoils nothing, as long as outliers are looked for. */
static void
test_outliers (void)
{
  ClothUVParams params = usual ();
  gdouble worst, clean;
  ClothRandom random;
  Scene s;
  guint n;

  scene_init (&s, cylinder);
  add_matches (&s, cylinder, 8, 4);
  cloth_random_init (&random, 5);
  for (guint i = 0; i < s.matches->len; i++) {
    ClothUVMatch *m = &g_array_index (s.matches, ClothUVMatch, i);

    m->u += (gfloat) (0.0003 * cloth_random_gaussian (&random));
    m->v += (gfloat) (0.0003 * cloth_random_gaussian (&random));
  }
  run (&s, &params, NULL);
  clean = mean_error (&s, &worst, &n);
  g_assert_cmpfloat (s.counts.sigma, >, 0.0002);
  g_assert_cmpfloat (s.counts.sigma, <, 0.0006);
  g_array_index (s.matches, ClothUVMatch, s.matches->len / 2).u += 0.012f;
  run (&s, &params, NULL);
  g_assert_cmpuint (s.counts.n_outliers, >=, 1);
  g_assert_cmpuint (s.counts.n_outliers, <, 10);
  g_assert_cmpfloat (mean_error (&s, &worst, &n), <, 1.1 * clean);
  params.outlier = 0;
  run (&s, &params, NULL);
  g_assert_cmpuint (s.counts.n_outliers, ==, 0);
  g_assert_cmpfloat (mean_error (&s, &worst, &n), >, 1.1 * clean);
  scene_clear (&s);
}

/* Half of the surface lies farther off: uv stays on either side, and no triangle joins them. */
static void
test_break (void)
{
  const ClothUVParams params = usual ();
  guint n_far = 0;
  Scene s;

  scene_init (&s, plane);
  add_matches (&s, plane, 10, 6);
  for (guint i = 0; i < N_PIXELS; i++)
    for (guint c = 0; c < 3; c++)
      s.points[3 * i + c] *= i % WIDTH < WIDTH / 2 ? 1 : 1.2f;
  /* what is farther off shows cloth that is nowhere near */
  for (guint i = 0; i < s.matches->len; i++) {
    ClothUVMatch *m = &g_array_index (s.matches, ClothUVMatch, i);

    if (m->x >= WIDTH / 2) {
      m->u = 5 + 1.2f * m->u;
      m->v = 1.2f * m->v;
    }
  }
  run (&s, &params, NULL);
  for (guint i = 0; i < N_PIXELS; i++)
    if (!isnan (s.uv[2 * i])) {
      g_assert_true (i % WIDTH < WIDTH / 2 ? s.uv[2 * i] < 0.5
          : s.uv[2 * i] > 4.9);
      n_far += s.uv[2 * i] > 4;
    }
  g_assert_cmpuint (n_far, >, 500);
  scene_clear (&s);
}

/* Same bytes by any number of threads, and in whatever order the matches come. */
static void
test_threads (void)
{
  const ClothUVParams params = usual ();
  g_autofree gfloat *first = g_new (gfloat, 2 * N_PIXELS);
  const guint threads[] = { 1, 2, 3, 8 };
  Scene s;

  scene_init (&s, cylinder);
  add_matches (&s, cylinder, 7, 7);
  run (&s, &params, NULL);
  memcpy (first, s.uv, 2 * N_PIXELS * sizeof *first);
  for (guint k = 0; k < G_N_ELEMENTS (threads); k++) {
    g_autoptr (ClothPool) pool = cloth_pool_new (threads[k]);

    run (&s, &params, pool);
    g_assert_cmpmem (s.uv, 2 * N_PIXELS * sizeof *first, first,
        2 * N_PIXELS * sizeof *first);
  }
  for (guint i = 0, j = s.matches->len - 1; i < j; i++, j--) {
    ClothUVMatch *m = (ClothUVMatch *) s.matches->data, swap = m[i];

    m[i] = m[j];
    m[j] = swap;
  }
  run (&s, &params, NULL);
  g_assert_cmpmem (s.uv, 2 * N_PIXELS * sizeof *first, first,
      2 * N_PIXELS * sizeof *first);
  scene_clear (&s);
}

/* What says nothing: no matches, two, all on a line, all on one place, off the picture, not a
 * number; no surface. */
static void
test_nothing (void)
{
  const ClothUVParams params = usual ();
  static const ClothUVMatch two[] = { {70, 60, 0.1f, 0.1f}, {90, 60, 0.2f,
      0.1f}
  };
  Scene s;

  scene_init (&s, plane);
  for (guint round = 0; round < 6; round++) {
    g_array_set_size (s.matches, 0);
    if (round == 1)
      g_array_append_vals (s.matches, two, 2);
    for (guint i = 0; i < 9 && round > 1; i++) {
      ClothUVMatch m = { 60 + 4 * (gfloat) i, 60, 0.02f * (gfloat) i, 0.1f };

      if (round == 3)
        m.x = 70;
      if (round == 4)
        m.x = i % 2 ? -500 : 1e9f;
      if (round == 5)
        m.u = i % 2 ? NAN : INFINITY;
      g_array_append_val (s.matches, m);
    }
    run (&s, &params, NULL);
    g_assert_cmpuint (s.counts.n_between + s.counts.n_beyond, ==, 0);
    for (guint i = 0; i < 2 * N_PIXELS; i++)
      g_assert_true (isnan (s.uv[i]));
  }
  g_array_set_size (s.matches, 0);
  add_matches (&s, plane, 10, 8);
  for (guint i = 0; i < 3 * N_PIXELS; i++)
    s.points[i] = NAN;
  run (&s, &params, NULL);
  g_assert_cmpuint (s.counts.n_surface + s.counts.n_places, ==, 0);
  g_assert_true (isnan (cloth_uv_get_sigma (s.dense, 0)));
  g_assert_true (isnan (cloth_uv_get_sigma (s.dense, G_MAXUINT32)));
  scene_clear (&s);
}

/* ---- vertices ---- */

static const ClothGridShape grid = { COLUMNS, ROWS, {CLOTH_W, CLOTH_H} };

static const ClothUVDepth depth = { 0.1, 30, {0, 0, 1} };

static guint
find_vertices (Scene * s, const ClothUVSpot * spots, guint n_spots,
    ClothUVVertex vertices[N_VERTICES])
{
  const ClothUVVertexParams params = cloth_uv_vertex_default_params ();
  g_autoptr (ClothUVVertices) self = cloth_uv_vertices_new ();

  return cloth_uv_vertices_run (self, &params, &grid, &s->surface, s->uv,
      s->dense, &depth, spots, n_spots, vertices);
}

/* Where vertex @i of the cylinder is. */
static void
vertex_of_cylinder (guint i, gdouble point[3], gdouble * turn)
{
  const gdouble u = CLOTH_W * (i % COLUMNS) / (COLUMNS - 1);

  *turn = (u - 0.2) / RADIUS;
  point[0] = RADIUS * sin (*turn);
  point[1] = CLOTH_H * (i / COLUMNS) / (ROWS - 1) - 0.15;
  point[2] = AXIS_Z - RADIUS * cos (*turn);
}

static void
test_vertices (void)
{
  const ClothUVParams params = usual ();
  ClothUVVertex v[N_VERTICES];
  guint n_seen, n = 0;
  Scene s;

  scene_init (&s, cylinder);
  add_matches (&s, cylinder, 8, 9);
  run (&s, &params, NULL);
  n_seen = find_vertices (&s, NULL, 0, v);
  for (guint i = 0; i < N_VERTICES; i++) {
    gdouble p[3], turn, e = 0;

    vertex_of_cylinder (i, p, &turn);
    n += v[i].seen;
    if (fabs (turn) > 1.13)     /* beyond what is in sight */
      g_assert_false (v[i].seen);
    if (!v[i].seen)
      continue;
    for (guint c = 0; c < 3; c++)
      e += (v[i].point[c] - p[c]) * (v[i].point[c] - p[c]);
    g_assert_cmpfloat (sqrt (e), <, 0.0015);
    for (guint c = 0; c < 6; c++)
      g_assert_true (isfinite (v[i].covariance[c]));
    /* along the ray, of 0.1 px: z²·0.1/30 */
    g_assert_cmpfloat (sqrt (v[i].covariance[5]), >, 0.0024);
    g_assert_cmpfloat (sqrt (v[i].covariance[5]), <, 0.0040);
    g_assert_cmpfloat (v[i].covariance[0], <, v[i].covariance[5]);
  }
  g_assert_cmpuint (n, ==, n_seen);
  /* three columns are in sight from well within their edges */
  g_assert_cmpuint (n, >=, 16);
  scene_clear (&s);
}

/* A place that is known better counts instead of uv's, unless they contradict each other. */
static void
test_spots (void)
{
  const ClothUVParams params = usual ();
  ClothUVVertex v[N_VERTICES], w[N_VERTICES];
  const guint middle = 3 * COLUMNS + 3;
  ClothUVSpot spots[3];
  gdouble p[3], uv[2];
  Scene s;

  scene_init (&s, cylinder);
  add_matches (&s, cylinder, 8, 9);
  run (&s, &params, NULL);
  find_vertices (&s, NULL, 0, v);
  g_assert_true (v[middle].seen);
  /* three pixels aside */
  spots[0] = (ClothUVSpot) {
  middle, FOCAL * v[middle].point[0] / v[middle].point[2] + MIDDLE_X + 3,
        FOCAL * v[middle].point[1] / v[middle].point[2] + MIDDLE_Y, 0.01, 0,
        0.01};
  spots[1] = (ClothUVSpot) {
  N_VERTICES, 10, 10, 1, 0, 1};
  spots[2] = (ClothUVSpot) {
  middle + 1, NAN, 10, 1, 0, 1};
  g_assert_true (cylinder (spots[0].x, spots[0].y, p, uv));
  find_vertices (&s, spots, 3, w);
  for (guint c = 0; c < 3; c++)
    g_assert_cmpfloat (fabs (w[middle].point[c] - p[c]), <, 0.0003);
  g_assert_cmpmem (&w[middle + 1], sizeof *w, &v[middle + 1], sizeof *w);
  /* 20 px are some 60 mm: one of the two is wrong */
  spots[0].x += 20;
  g_assert_true (cylinder (spots[0].x, spots[0].y, p, uv));
  find_vertices (&s, spots, 1, w);
  g_assert_false (w[middle].seen);
  spots[0].x = 1e30;
  find_vertices (&s, spots, 1, w);
  g_assert_false (w[middle].seen);
  w[middle] = v[middle];
  g_assert_cmpmem (w, sizeof w, v, sizeof v);
  scene_clear (&s);
}

/* A vertex that two parts of the picture show, as far apart as the cloth can't be. */
static void
test_contradiction (void)
{
  const ClothUVParams params = usual ();
  const guint middle = 3 * COLUMNS + 3;
  ClothUVVertex v[N_VERTICES];
  Scene s;

  scene_init (&s, cylinder);
  add_matches (&s, cylinder, 8, 9);
  run (&s, &params, NULL);
  g_assert_cmpuint (find_vertices (&s, NULL, 0, v), >, 0);
  g_assert_true (v[middle].seen);
  /* a place at the lower left now shows a good part of the same cloth */
  for (guint y = 85; y < 105; y++)
    for (guint x = 52; x < 64; x++) {
      const guint i = y * WIDTH + x;

      s.uv[2 * i] = (gfloat) (0.2 + 0.003 * (x - 62.));
      s.uv[2 * i + 1] = (gfloat) (0.18 + 0.003 * (y - 95.));
    }
  find_vertices (&s, NULL, 0, v);
  g_assert_false (v[middle].seen);
  for (guint i = 0; i < 2 * N_PIXELS; i++)
    s.uv[i] = NAN;
  g_assert_cmpuint (find_vertices (&s, NULL, 0, v), ==, 0);
  scene_clear (&s);
}

/* ---- several heads ---- */

static ClothUVHead
head (const ClothUVVertex * v, guint n_cameras)
{
  return (ClothUVHead) {
    v, {
    1, 0, 0, 0, 1, 0, 0, 0, 1}
    , {
    0, 0, 0}
  , n_cameras};
}

/* Vertex at @x on the x axis of its head, 1 mm unsure along x, 2 mm else. */
static ClothUVVertex
at (gdouble x)
{
  return (ClothUVVertex) {
    TRUE, {
    x, 0, 1}
    , {
    1e-6, 0, 0, 4e-6, 0, 4e-6}
  };
}

static void
test_join (void)
{
  const ClothUVVertex a[3] = { at (0), at (0), at (0) };
  const ClothUVVertex b[3] = { at (0.001), at (0.02), {FALSE} };
  const ClothUVVertex c[3] = { at (0.0005), at (0.0005), {FALSE} };
  ClothUVHead heads[3] = { head (a, 2), head (b, 2), head (c, 2) };
  gfloat positions[9], covariances[18];
  ClothUVJoined joined;
  guint8 states[3];

  cloth_uv_join (heads, 1, 3, 0.01, positions, states, covariances, &joined);
  g_assert_cmpuint (joined.n_seen, ==, 3);
  g_assert_cmpint (states[0], ==, CLOTH_POINT_TWO_VIEWS);
  g_assert_cmpfloat (fabs (covariances[5] - 4e-6), <, 1e-9);
  heads[0].n_cameras = 3;
  cloth_uv_join (heads, 1, 3, 0.01, positions, states, covariances, &joined);
  g_assert_cmpint (states[0], ==, CLOTH_POINT_MEASURED);
  heads[0].n_cameras = 2;
  /* two heads: half way with half the variance; contradiction; one only */
  cloth_uv_join (heads, 2, 3, 0.01, positions, states, covariances, &joined);
  g_assert_cmpint (states[0], ==, CLOTH_POINT_MEASURED);
  g_assert_cmpfloat (fabs (positions[0] - 0.0005), <, 1e-7);
  g_assert_cmpfloat (fabs (covariances[0] - 0.5e-6), <, 1e-9);
  g_assert_cmpint (states[1], ==, CLOTH_POINT_UNSEEN);
  g_assert_true (isnan (positions[3]) && isnan (covariances[6]));
  g_assert_cmpint (states[2], ==, CLOTH_POINT_TWO_VIEWS);
  g_assert_cmpuint (joined.n_contradicted, ==, 1);
  g_assert_cmpuint (joined.n_joined, ==, 1);
  /* a third one tells which of the two is wrong */
  cloth_uv_join (heads, 3, 3, 0.01, positions, states, covariances, &joined);
  g_assert_cmpint (states[1], ==, CLOTH_POINT_MEASURED);
  g_assert_cmpfloat (fabs (positions[3] - 0.00025), <, 1e-7);
  g_assert_cmpuint (joined.n_left_out, ==, 1);
  g_assert_cmpuint (joined.n_contradicted, ==, 0);
  /* nobody */
  cloth_uv_join (heads, 0, 3, 0.01, positions, states, covariances, &joined);
  g_assert_cmpuint (joined.n_seen, ==, 0);
  g_assert_true (isnan (positions[0]));
}

/* What two agree on in the world they see from two sides; a covariance that is none counts as
 * unseen. */
static void
test_frames (void)
{
  /* world point (0.1, 0.2, 0.3); the second head looks along world −x */
  ClothUVVertex a = { TRUE, {0.1, 0.2, 1.3}, {1e-6, 0, 0, 1e-6, 0, 9e-6} };
  ClothUVVertex b = { TRUE, {0.3, 0.2, 1.9}, {1e-6, 0, 0, 1e-6, 0, 9e-6} };
  const ClothUVHead heads[2] = {
    {&a, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 1}, 2},
    {&b, {0, 0, 1, 0, 1, 0, -1, 0, 0}, {0, 0, 2}, 2}
  };
  gfloat positions[3], covariances[6];
  ClothUVJoined joined;
  guint8 state;

  cloth_uv_join (heads, 2, 1, 0.01, positions, &state, covariances, &joined);
  g_assert_cmpint (state, ==, CLOTH_POINT_MEASURED);
  g_assert_cmpfloat (fabs (positions[0] - 0.1), <, 1e-6);
  g_assert_cmpfloat (fabs (positions[1] - 0.2), <, 1e-6);
  g_assert_cmpfloat (fabs (positions[2] - 0.3), <, 1e-6);
  /* each is sure where the other is not: 1·9/(1 + 9) mm² along x and z */
  g_assert_cmpfloat (fabs (covariances[0] - 0.9e-6), <, 1e-9);
  g_assert_cmpfloat (fabs (covariances[3] - 0.5e-6), <, 1e-9);
  g_assert_cmpfloat (fabs (covariances[5] - 0.9e-6), <, 1e-9);
  memset (b.covariance, 0, sizeof b.covariance);
  cloth_uv_join (heads, 2, 1, 0.01, positions, &state, covariances, &joined);
  g_assert_cmpint (state, ==, CLOTH_POINT_TWO_VIEWS);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/uv/plane", test_plane);
  g_test_add_func ("/uv/cylinder", test_cylinder);
  g_test_add_func ("/uv/reach", test_reach);
  g_test_add_func ("/uv/outliers", test_outliers);
  g_test_add_func ("/uv/break", test_break);
  g_test_add_func ("/uv/threads", test_threads);
  g_test_add_func ("/uv/nothing", test_nothing);
  g_test_add_func ("/uv/vertices", test_vertices);
  g_test_add_func ("/uv/spots", test_spots);
  g_test_add_func ("/uv/contradiction", test_contradiction);
  g_test_add_func ("/uv/join", test_join);
  g_test_add_func ("/uv/frames", test_frames);
  return g_test_run ();
}
