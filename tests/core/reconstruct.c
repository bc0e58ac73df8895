/* From views to vertices in space, against the geometry that the views were made with.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/rig/reconstruct.h"

#define COLUMNS 9
#define ROWS 7
#define N (COLUMNS * ROWS)
#define EDGE 0.05
#define MAX_CAMERAS 4
#define FOCAL 1000.0
#define DISTANCE 2.0

/* What the cameras see: x, y and their variance, which is that of both. */
typedef struct
{
  ClothRig *rig;
  gdouble x[MAX_CAMERAS][N], y[MAX_CAMERAS][N], v[MAX_CAMERAS][N];
  gdouble none[N];
  ClothTriangulateView views[MAX_CAMERAS];
  gdouble truth[N][3];
} Film;

static const ClothReconstructionGrid corners =
    { COLUMNS, ROWS, {EDGE, EDGE}, 0 };

/* Pinholes on a circle around the z axis that look at the origin: camera c stands at the
 * angle c·90°/(n − 1). */
static void
film_init (Film * film, guint n_cameras)
{
  memset (film, 0, sizeof *film);
  film->rig = cloth_rig_new (n_cameras);
  for (guint c = 0; c < n_cameras; c++) {
    ClothCamera *camera = &film->rig->cameras[c];
    gdouble a = G_PI / 2 * c / MAX (n_cameras - 1, 1);
    gdouble R[9] = { cos (a), sin (a), 0, 0, 0, -1, -sin (a), cos (a), 0 };

    camera->width = 1280;
    camera->height = 720;
    camera->K[0] = camera->K[4] = FOCAL;
    camera->K[2] = 639.5;
    camera->K[5] = 359.5;
    camera->K[8] = 1;
    memcpy (camera->R, R, sizeof R);
    camera->t[2] = DISTANCE;
    for (guint i = 0; i < N; i++)
      film->v[c][i] = 0.01;
    film->views[c] = (ClothTriangulateView) {
    film->x[c], film->y[c], film->v[c], film->none, film->v[c]};
  }
}

static void
film_clear (Film * film)
{
  g_clear_pointer (&film->rig, cloth_rig_free);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Film, film_clear);
static void
look (Film * film, guint camera, guint i, const gdouble X[3])
{
  gdouble px[2];

  g_assert_true (cloth_camera_project (&film->rig->cameras[camera], X, px,
          NULL, NULL));
  film->x[camera][i] = px[0];
  film->y[camera][i] = px[1];
}

/* A flat cloth through the origin, upright, 45° to the outer cameras. */
static void
film_plane (Film * film)
{
  for (guint i = 0; i < N; i++) {
    gdouble u = (i % COLUMNS - 4.) * EDGE, v = (i / COLUMNS - 3.) * EDGE;

    film->truth[i][0] = film->truth[i][1] = u * G_SQRT2 / 2;
    film->truth[i][1] *= -1;
    film->truth[i][2] = -v;
    for (guint c = 0; c < film->rig->n_cameras; c++)
      look (film, c, i, film->truth[i]);
  }
}

static ClothReconstruction *
make (const Film * film, const ClothReconstructionGrid * grid)
{
  g_autoptr (GError) error = NULL;
  ClothReconstruction *self = cloth_reconstruction_new (film->rig, &error);

  g_assert_no_error (error);
  cloth_reconstruction_set_grid (self, grid);
  return self;
}

static const ClothReconstructed *
run (ClothReconstruction * self, const Film * film)
{
  g_autoptr (GError) error = NULL;
  const ClothReconstructed *result =
      cloth_reconstruction_run (self, film->views, &error);

  g_assert_no_error (error);
  return result;
}

static gdouble
miss (const ClothReconstructed * result, const Film * film, guint i)
{
  gdouble d2 = 0;

  for (guint k = 0; k < 3; k++)
    d2 += pow (result->positions[3 * i + k] - film->truth[i][k], 2);
  return sqrt (d2);
}

static void
assert_unseen (const ClothReconstructed * result, guint i)
{
  g_assert_cmpuint (result->states[i], ==, CLOTH_POINT_UNSEEN);
  for (guint k = 0; k < 3; k++)
    g_assert_true (isnan (result->positions[3 * i + k]));
}

/* ---- windows on bent cloth ---- */

/* Half the edge of windows, in px; a cell is 25 px where it faces the camera. */
#define WINDOW 12

/* How far an upright cloth that faces the cameras bends towards them, @s cells from its
 * middle column. */
typedef gdouble (*Bend) (gdouble s);

static gdouble
crease (gdouble s)
{
  return 0.3 * EDGE * fabs (s);
}

static gdouble
parabola (gdouble s)
{
  return 0.03 * EDGE * s * s;
}

static void
bent_at (Bend bend, gdouble s, gdouble v, gdouble X[3])
{
  X[0] = (s * EDGE + bend (s)) * G_SQRT2 / 2;
  X[1] = (s * EDGE - bend (s)) * G_SQRT2 / 2;
  X[2] = -v;
}

/* What windows tell of a cloth that is bent about its middle column: of each window the
 * value, at its middle, of the parabola that fits best to where its columns are seen. */
static void
film_windows (Film * film, Bend bend)
{
  for (guint i = 0; i < N; i++) {
    const gdouble u = i % COLUMNS - 4., v = (i / COLUMNS - 3.) * EDGE;

    bent_at (bend, u, v, film->truth[i]);
    for (guint c = 0; c < film->rig->n_cameras; c++) {
      gdouble n = 0, s2 = 0, s4 = 0, sums[2][2] = { {0}
      }, X[3], left, step;

      bent_at (bend, u - 1, v, X);
      look (film, c, i, X);
      left = film->x[c][i];
      bent_at (bend, u + 1, v, X);
      look (film, c, i, X);
      step = 2 / (film->x[c][i] - left);        /* cells a px */
      for (gint j = -WINDOW; j <= WINDOW; j++) {
        bent_at (bend, u + j * step, v, X);
        look (film, c, i, X);
        n++;
        s2 += j * j;
        s4 += pow (j, 4);
        for (guint k = 0; k < 2; k++) {
          const gdouble px = k ? film->y[c][i] : film->x[c][i];

          sums[k][0] += px;
          sums[k][1] += px * j * j;
        }
      }
      film->x[c][i] = (sums[0][0] * s4 - sums[0][1] * s2) / (n * s4 - s2 * s2);
      film->y[c][i] = (sums[1][0] * s4 - sums[1][1] * s2) / (n * s4 - s2 * s2);
      film->v[c][i] = 1e-3;
    }
  }
}

/* The middle column of a crease is measured beside the cloth; half of that is taken off, and
 * its square is in the covariance. Of a cloth that is bent evenly the measured places are
 * right; what is moved there is within what the covariance says. */
static void
test_windows (void)
{
  const struct
  {
    Bend bend;
    gdouble least, most;        /* of the error that is left, as a share */
  } cases[] = { {crease, 0.3, 0.7}, {parabola, 0, 0} };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    ClothReconstructionGrid windows = corners;
    g_autoptr (ClothReconstruction) plain = NULL, bent = NULL;
    const ClothReconstructed *result;
    g_auto (Film) film = { 0 };
    gdouble before;

    film_init (&film, 4);
    film_windows (&film, cases[i].bend);
    windows.window_px = WINDOW;
    plain = make (&film, &corners);
    bent = make (&film, &windows);
    before = miss (run (plain, &film), &film, 3 * COLUMNS + 4);
    result = run (bent, &film);
    for (guint row = 1; row + 1 < ROWS; row++) {
      const guint vertex = row * COLUMNS + 4;
      const gfloat *c = result->covariances + 6 * vertex;
      const gdouble off = miss (result, &film, vertex);
      const gdouble told = sqrt (c[0] + c[3] + c[5]);

      g_test_message ("off by %.3f mm, %.3f before, %.3f told", 1e3 * off,
          1e3 * before, 1e3 * told);
      if (cases[i].most > 0) {
        g_assert_cmpfloat (before, >, 0.5e-3);
        g_assert_cmpfloat (off, >, cases[i].least * before);
        g_assert_cmpfloat (off, <, cases[i].most * before);
      }
      g_assert_cmpfloat (off, <, 2 * told);
      g_assert_cmpfloat (off, >, 0.2 * told);
    }
    /* beside the bend nothing changes; at the border nothing is moved, yet doubted */
    g_assert_cmpfloat (miss (result, &film, 3 * COLUMNS + 1), <,
        cases[i].most > 0 ? 1e-4 : 1e-3);
    g_assert_cmpfloat (result->covariances[0], >,
        cloth_reconstruction_run (plain, film.views, NULL)->covariances[0]);
  }
}

/* A flat cloth in noise: what its neighbours seem to tell of bending is noise as well, and must
 * not be added to a vertex's own. */
static void
test_windows_in_noise (void)
{
  ClothReconstructionGrid windows = corners;
  g_autoptr (ClothReconstruction) plain = NULL, bent = NULL;
  gdouble sums[2] = { 0 };
  ClothRandom random;

  windows.window_px = WINDOW;
  cloth_random_init (&random, 1);
  for (guint round = 0; round < 20; round++) {
    g_auto (Film) film = { 0 };

    film_init (&film, 3);
    film_plane (&film);
    for (guint c = 0; c < 3; c++)
      for (guint i = 0; i < N; i++) {
        film.x[c][i] += 0.3 * cloth_random_gaussian (&random);
        film.y[c][i] += 0.3 * cloth_random_gaussian (&random);
        film.v[c][i] = 0.09;
      }
    g_clear_pointer (&plain, cloth_reconstruction_free);
    g_clear_pointer (&bent, cloth_reconstruction_free);
    plain = make (&film, &corners);
    bent = make (&film, &windows);
    for (guint k = 0; k < 2; k++) {
      const ClothReconstructed *result = run (k ? bent : plain, &film);

      for (guint i = 0; i < N; i++)
        if (result->states[i] != CLOTH_POINT_UNSEEN)
          sums[k] += pow (miss (result, &film, i), 2);
    }
  }
  g_test_message ("%.3f of the RMS of points", sqrt (sums[1] / sums[0]));
  g_assert_cmpfloat (sqrt (sums[1] / sums[0]), <, 1.04);
}

/* ---- what is found ---- */

static void
test_plane (void)
{
  for (guint n = 2; n <= MAX_CAMERAS; n++) {
    g_autoptr (ClothReconstruction) self = NULL;
    const ClothReconstructed *result;
    g_auto (Film) film = { 0 };

    film_init (&film, n);
    film_plane (&film);
    self = make (&film, &corners);
    result = run (self, &film);
    g_assert_cmpuint (result->n_vertices, ==, N);
    for (guint i = 0; i < N; i++) {
      g_assert_cmpuint (result->states[i], ==, n > 2 ? CLOTH_POINT_MEASURED :
          CLOTH_POINT_TWO_VIEWS);
      g_assert_cmpfloat (miss (result, &film, i), <, 1e-6);
    }
    for (guint c = 0; c < n; c++) {
      g_assert_cmpuint (result->n_compared[c], ==, N);
      g_assert_cmpuint (result->n_left_out[c], ==, 0);
    }
  }
}

/* Two cameras at right angles see the vertex at the origin on their axes, from the
 * distance d. Each measures the two directions across its axis with the standard
 * deviation s·d/f: both the upright one. */
static void
test_covariance (void)
{
  ClothReconstructionParameters parameters =
      CLOTH_RECONSTRUCTION_PARAMETERS_DEFAULT;
  g_autoptr (ClothReconstruction) self = NULL;
  const guint middle = ROWS / 2 * COLUMNS + COLUMNS / 2;
  const gfloat *c;
  gdouble each;
  g_auto (Film) film = { 0 };

  film_init (&film, 2);
  film_plane (&film);
  self = make (&film, &corners);
  parameters.triangulate.error_floor = 0.03;
  cloth_reconstruction_set_parameters (self, &parameters);
  g_assert_cmpfloat (cloth_reconstruction_get_error_floor (self), ==, 0.03);
  c = run (self, &film)->covariances + 6 * middle;
  each = (0.01 + 0.03) * pow (DISTANCE / FOCAL, 2);
  g_assert_cmpfloat_with_epsilon (c[0], each, 1e-4 * each);
  g_assert_cmpfloat_with_epsilon (c[3], each, 1e-4 * each);
  g_assert_cmpfloat_with_epsilon (c[5], each / 2, 1e-4 * each);
  for (guint k = 1; k < 5; k += k == 2 ? 2 : 1)
    g_assert_cmpfloat_with_epsilon (c[k], 0, 1e-4 * each);
}

/* Observations say 0.01 px² and scatter by 0.01 + 0.09 px². */
static void
test_error_floor (void)
{
  const gdouble sd = sqrt (0.1);
  g_autoptr (ClothReconstruction) self = NULL, anew = NULL;
  ClothRandom random;
  gdouble floor = 0;
  g_auto (Film) film = { 0 };

  film_init (&film, MAX_CAMERAS);
  self = make (&film, &corners);
  g_assert_cmpfloat (cloth_reconstruction_get_error_floor (self), ==, 0.01);
  cloth_random_init (&random, 1);
  for (guint set = 0; set < 40; set++) {
    film_plane (&film);
    for (guint c = 0; c < MAX_CAMERAS; c++)
      for (guint i = 0; i < N; i++) {
        film.x[c][i] += sd * cloth_random_gaussian (&random);
        film.y[c][i] += sd * cloth_random_gaussian (&random);
      }
    floor = run (self, &film)->error_floor;
    if (set == 0)
      g_assert_cmpfloat_with_epsilon (floor, 0.09, 0.03);
  }
  /* 12600 degrees of freedom: known to within 1.3% of 0.1 */
  g_assert_cmpfloat_with_epsilon (floor, 0.09, 0.005);
  /* It is the cameras': another cloth before them doesn't change it. */
  cloth_reconstruction_set_grid (self, &corners);
  g_assert_cmpfloat (cloth_reconstruction_get_error_floor (self), ==, floor);
  film_plane (&film);
  anew = make (&film, &corners);
  g_assert_cmpfloat (run (anew, &film)->error_floor, <, 1e-3);
}

/* The centre of gravity of the picture of a dot on a cylinder of 0.1 m, by its outline. */
static void
look_at_dot (Film * film, guint camera, guint i, gdouble s, gdouble z,
    gdouble radius)
{
  enum
  { CORNERS = 360 };
  gdouble px[CORNERS + 1][2], area = 0, gx = 0, gy = 0;

  for (guint k = 0; k <= CORNERS; k++) {
    gdouble a = 2 * G_PI * k / CORNERS;
    gdouble angle = (s + radius * cos (a)) / 0.1 - G_PI / 4;
    gdouble X[3] = { 0.1 * cos (angle), 0.1 * sin (angle),
      z + radius * sin (a)
    };

    g_assert_true (cloth_camera_project (&film->rig->cameras[camera], X, px[k],
            NULL, NULL));
  }
  for (guint k = 0; k < CORNERS; k++) {
    gdouble cross = px[k][0] * px[k + 1][1] - px[k + 1][0] * px[k][1];

    area += cross;
    gx += cross * (px[k][0] + px[k + 1][0]);
    gy += cross * (px[k][1] + px[k + 1][1]);
  }
  film->x[camera][i] = gx / (3 * area);
  film->y[camera][i] = gy / (3 * area);
}

/* The second pass takes most of the bend's error away. */
static void
test_dots (void)
{
  const gdouble pitch = 0.012, radius = 0.004;
  gdouble rms[2] = { 0 };
  g_auto (Film) film = { 0 };

  film_init (&film, MAX_CAMERAS);
  for (guint i = 0; i < N; i++) {
    gdouble s = (i % COLUMNS - 4.) * pitch, z = (3. - i / COLUMNS) * pitch;

    film.truth[i][0] = 0.1 * cos (s / 0.1 - G_PI / 4);
    film.truth[i][1] = 0.1 * sin (s / 0.1 - G_PI / 4);
    film.truth[i][2] = z;
    for (guint c = 0; c < MAX_CAMERAS; c++)
      look_at_dot (&film, c, i, s, z, radius);
  }
  for (guint k = 0; k < 2; k++) {
    const ClothReconstructionGrid grid = { COLUMNS, ROWS, {pitch, pitch},
    k == 0 ? 0 : 2 * radius
    };
    g_autoptr (ClothReconstruction) self = make (&film, &grid);
    const ClothReconstructed *result = run (self, &film);

    for (guint i = 0; i < N; i++) {
      g_assert_cmpuint (result->states[i], ==, CLOTH_POINT_MEASURED);
      rms[k] += pow (miss (result, &film, i), 2) / N;
    }
  }
  g_assert_cmpfloat (sqrt (rms[0]), >, 1.5e-5);
  g_assert_cmpfloat (sqrt (rms[1]), <, sqrt (rms[0]) / 5);
}

static void
test_threads (void)
{
  g_autoptr (ClothPool) pool = cloth_pool_new (3);
  g_autoptr (ClothReconstruction) one = NULL, many = NULL;
  const ClothReconstructed *a, *b;
  g_auto (Film) film = { 0 };

  film_init (&film, 3);
  film_plane (&film);
  film.x[1][20] += 7;
  one = make (&film, &corners);
  many = make (&film, &corners);
  cloth_reconstruction_set_pool (many, pool);
  a = run (one, &film);
  b = run (many, &film);
  g_assert_cmpmem (a->positions, 3 * N * sizeof (gfloat), b->positions,
      3 * N * sizeof (gfloat));
  g_assert_cmpmem (a->covariances, 6 * N * sizeof (gfloat), b->covariances,
      6 * N * sizeof (gfloat));
  g_assert_cmpmem (a->states, N, b->states, N);
}

/* ---- what is not ---- */

/* One of four cameras takes a vertex for another place: the others outvote it. */
static void
test_wrong_view (void)
{
  g_autoptr (ClothReconstruction) self = NULL;
  const ClothReconstructed *result;
  g_auto (Film) film = { 0 };

  film_init (&film, MAX_CAMERAS);
  film_plane (&film);
  film.x[2][17] += 30;
  film.y[2][17] -= 12;
  self = make (&film, &corners);
  result = run (self, &film);
  for (guint i = 0; i < N; i++) {
    g_assert_cmpuint (result->states[i], ==, CLOTH_POINT_MEASURED);
    g_assert_cmpfloat (miss (result, &film, i), <, 1e-6);
  }
  for (guint c = 0; c < MAX_CAMERAS; c++) {
    g_assert_cmpuint (result->n_compared[c], ==, N);
    g_assert_cmpuint (result->n_left_out[c], ==, c == 2);
  }
}

/* Of two cameras none can be outvoted: what leaves the epipolar line is not known. */
static void
test_contradiction (void)
{
  g_autoptr (ClothReconstruction) self = NULL;
  const ClothReconstructed *result;
  g_auto (Film) film = { 0 };

  film_init (&film, 2);
  film_plane (&film);
  film.y[1][30] += 12;
  self = make (&film, &corners);
  result = run (self, &film);
  assert_unseen (result, 30);
  for (guint i = 0; i < N; i++)
    if (i != 30)
      g_assert_cmpuint (result->states[i], ==, CLOTH_POINT_TWO_VIEWS);
  g_assert_cmpuint (result->n_left_out[0] + result->n_left_out[1], >, 0);
}

/* Both cameras see another place than the vertex: only its neighbours tell. */
static void
test_stretched (void)
{
  ClothReconstructionParameters parameters =
      CLOTH_RECONSTRUCTION_PARAMETERS_DEFAULT;
  g_autoptr (ClothReconstruction) self = NULL;
  const ClothReconstructed *result;
  g_auto (Film) film = { 0 };

  film_init (&film, 2);
  film_plane (&film);
  film.truth[31][0] += 0.03;
  film.truth[31][1] += 0.03;
  look (&film, 0, 31, film.truth[31]);
  look (&film, 1, 31, film.truth[31]);
  self = make (&film, &corners);
  result = run (self, &film);
  assert_unseen (result, 31);
  for (guint i = 0; i < N; i++)
    if (i != 31)
      g_assert_cmpuint (result->states[i], ==, CLOTH_POINT_TWO_VIEWS);
  /* without limits nothing denies it */
  parameters.shortest = parameters.longest = 0;
  cloth_reconstruction_set_parameters (self, &parameters);
  result = run (self, &film);
  g_assert_cmpuint (result->states[31], ==, CLOTH_POINT_TWO_VIEWS);
  g_assert_cmpfloat (miss (result, &film, 31), <, 1e-6);
}

static void
test_few_views (void)
{
  const ClothTriangulateView nothing = { NULL };

  for (guint seeing = 0; seeing < 2; seeing++) {
    g_autoptr (ClothReconstruction) self = NULL;
    const ClothReconstructed *result;
    g_auto (Film) film = { 0 };

    film_init (&film, 3);
    film_plane (&film);
    for (guint c = seeing; c < 3; c++)
      film.views[c] = nothing;
    self = make (&film, &corners);
    result = run (self, &film);
    for (guint i = 0; i < N; i++)
      assert_unseen (result, i);
    for (guint c = 0; c < 3; c++)
      g_assert_cmpuint (result->n_compared[c], ==, 0);
    g_assert_cmpfloat (result->error_floor, ==, 0.01);
  }
}

/* Observations that say nothing: each leaves its vertex to one camera. */
static void
test_unusable_views (void)
{
  g_autoptr (ClothReconstruction) self = NULL;
  const ClothReconstructed *result;
  g_auto (Film) film = { 0 };

  film_init (&film, 2);
  film_plane (&film);
  film.x[0][0] = NAN;
  film.y[1][1] = INFINITY;
  film.v[0][2] = -INFINITY;
  film.v[1][3] = -1;
  film.v[0][4] = NAN;
  film.v[1][5] = INFINITY;
  self = make (&film, &corners);
  result = run (self, &film);
  for (guint i = 0; i < N; i++) {
    if (i < 6)
      assert_unseen (result, i);
    else
      g_assert_cmpuint (result->states[i], ==, CLOTH_POINT_TWO_VIEWS);
  }
}

static void
test_unusable_cameras (void)
{
  for (guint fault = 0; fault < 3; fault++) {
    const ClothTriangulateError expected = fault == 0 ?
        CLOTH_TRIANGULATE_ERROR_CAMERAS : CLOTH_TRIANGULATE_ERROR_CAMERA;
    g_autoptr (GError) error = NULL;
    g_auto (Film) film = { 0 };

    film_init (&film, fault == 0 ? 1 : 2);
    if (fault == 1)
      film.rig->cameras[1].K[0] = 0;
    if (fault == 2)
      film.rig->cameras[0].t[1] = NAN;
    g_assert_null (cloth_reconstruction_new (film.rig, &error));
    g_assert_true (g_error_matches (error, CLOTH_TRIANGULATE_ERROR, expected));
  }
}

static void
test_too_many_vertices (void)
{
  const ClothReconstructionGrid huge = { 1001, 1000, {EDGE, EDGE}, 0 };
  g_autoptr (ClothReconstruction) self = NULL;
  g_autoptr (GError) error = NULL;
  g_auto (Film) film = { 0 };

  film_init (&film, 2);
  film_plane (&film);
  self = make (&film, &huge);
  g_assert_null (cloth_reconstruction_run (self, film.views, &error));
  g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
      CLOTH_TRIANGULATE_ERROR_POINTS);
  /* and goes on with a grid that it can do */
  cloth_reconstruction_set_grid (self, &corners);
  g_assert_cmpfloat (miss (run (self, &film), &film, 0), <, 1e-6);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/reconstruct/windows", test_windows);
  g_test_add_func ("/reconstruct/windows-in-noise", test_windows_in_noise);
  g_test_add_func ("/reconstruct/plane", test_plane);
  g_test_add_func ("/reconstruct/covariance", test_covariance);
  g_test_add_func ("/reconstruct/error-floor", test_error_floor);
  g_test_add_func ("/reconstruct/dots", test_dots);
  g_test_add_func ("/reconstruct/threads", test_threads);
  g_test_add_func ("/reconstruct/wrong-view", test_wrong_view);
  g_test_add_func ("/reconstruct/contradiction", test_contradiction);
  g_test_add_func ("/reconstruct/stretched", test_stretched);
  g_test_add_func ("/reconstruct/few-views", test_few_views);
  g_test_add_func ("/reconstruct/unusable-views", test_unusable_views);
  g_test_add_func ("/reconstruct/unusable-cameras", test_unusable_cameras);
  g_test_add_func ("/reconstruct/too-many-vertices", test_too_many_vertices);
  return g_test_run ();
}
