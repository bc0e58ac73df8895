/* Rays of one camera, and a simulation that follows them: closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/fit/error.h"
#include "gst/fit/nudge/nudge.h"

#define NEAR(a, b, e) g_assert_cmpfloat_with_epsilon (a, b, e)
#define N 4

/* At (1, −2, 0.5), looking along y, z up: columns are x, rows −z. */
static const ClothCamera front = {
  .width = 1000,.height = 800,.K = {900, 0, 500, 0, 900, 400, 0, 0, 1},
  .R = {1, 0, 0, 0, 0, -1, 0, 1, 0},.t = {-1, 0.5, 2}
};

static const gdouble centre[3] = { 1, -2, 0.5 };

typedef struct
{
  gdouble x[N], y[N], xx[N], xy[N], yy[N];
  ClothTriangulateView view;
} Seen;

static void
see (Seen * seen, const gdouble px[N][2], gdouble xx, gdouble xy, gdouble yy)
{
  for (guint i = 0; i < N; i++) {
    seen->x[i] = px[i][0];
    seen->y[i] = px[i][1];
    seen->xx[i] = xx;
    seen->xy[i] = xy;
    seen->yy[i] = yy;
  }
  seen->view = (ClothTriangulateView) {
  seen->x, seen->y, seen->xx, seen->xy, seen->yy};
}

/* The axis; 45° to the right; 45° down; nothing. A circle of σ px is at the angle θ to the
 * axis σ/f·cos²θ wide along the radius and σ/f·cosθ across it. */
static void
test_cast (void)
{
  static const gdouble px[N][2] = { {500, 400}, {1400, 400}, {500, 1300}, {NAN,
      NAN}
  };
  const gdouble h = sqrt (0.5);
  const gdouble directions[3][3] = { {0, 1, 0}, {h, h, 0}, {0, h, -h} };
  g_autoptr (ClothRays) rays = cloth_rays_new (N);
  Seen seen;

  see (&seen, px, 0.09, 0, 0.09);
  cloth_rays_cast (rays, &front, &seen.view);
  for (guint i = 0; i < 3; i++) {
    for (guint k = 0; k < 3; k++)
      NEAR (rays->centres[3 * i + k], centre[k], 1e-15);
    for (guint k = 0; k < 3; k++)
      NEAR (rays->directions[3 * i + k], directions[i][k], 1e-15);
    NEAR (rays->spreads[i], 0.3 / 900 * (i ? sqrt ((0.25 + 0.5) / 2) : 1),
        1e-15);
  }
  g_assert_true (isnan (rays->directions[9]) && isnan (rays->spreads[3]));

  /* 45° to the right the rows' σ (0.6) counts with cosθ, the columns' (0.3) with cos²θ;
   * where both are all one, (x, y) with σ along (1, 1) moves √½ in each */
  see (&seen, px, 0.09, 0, 0.36);
  cloth_rays_cast (rays, &front, &seen.view);
  NEAR (rays->spreads[1], sqrt ((0.09 * 0.25 + 0.36 * 0.5) / 2) / 900, 1e-15);
  see (&seen, px, 0.09, 0.09, 0.09);
  cloth_rays_cast (rays, &front, &seen.view);
  NEAR (rays->spreads[0], 0.3 / 900, 1e-15);

  cloth_rays_clear (rays);
  for (guint i = 0; i < N; i++)
    g_assert_true (isnan (rays->directions[3 * i]) && isnan (rays->spreads[i]));
}

/* r_d = r·(1 − 0.1·r²): 0.5 is seen at 0.4875, where a pixel is 1/(1 − 0.3·0.25) as wide
 * along the radius and 1/(1 − 0.1·0.25) across it; behind the fold at r = √(10/3) nothing
 * can be seen. */
static void
test_lens (void)
{
  static const gdouble px[N][2] = { {500 + 900 * 0.4875, 400}, {500, 400 +
        900 * 0.4875}, {500 + 900 * 1.3, 400}, {NAN, 400}
  };
  const gdouble along = 1 / (1 - 0.075), across = 1 / (1 - 0.025);
  g_autoptr (ClothRays) rays = cloth_rays_new (N);
  ClothCamera camera = front;
  Seen seen;

  camera.lens = CLOTH_LENS_BROWN5;
  camera.k[0] = -0.1;
  see (&seen, px, 1, 0, 1);
  cloth_rays_cast (rays, &camera, &seen.view);
  for (guint i = 0; i < 2; i++) {
    NEAR (rays->directions[3 * i + 1], sqrt (0.8), 1e-12);
    NEAR (rays->directions[3 * i + (i ? 2 : 0)], sqrt (0.2) * (i ? -1 : 1),
        1e-12);
    /* cos²θ = 0.8 */
    NEAR (rays->spreads[i], sqrt ((along * along * 0.64 +
                across * across * 0.8) / 2) / 900, 1e-12);
  }
  for (guint i = 2; i < N; i++)
    g_assert_true (isnan (rays->directions[3 * i]) && isnan (rays->spreads[i]));
}

/* The foot of the perpendicular; none where something is missing or behind the camera. */
static void
test_lift (void)
{
  static const gdouble px[N][2] = { {1400, 400}, {500, 400}, {500, 400}, {NAN,
      NAN}
  };
  /* from the camera: (4, 2, 7) meets (1, 1, 0)/√2 after 6/√2 */
  static const gdouble reference[3 * N] = { 5, 0, 7.5, 1, -3, 0.5, NAN, NAN,
    NAN, 1, 1, 1
  };
  g_autoptr (ClothRays) rays = cloth_rays_new (N), copy = cloth_rays_new (N);
  const gdouble v[3] = { 1, 3, 5 };
  gdouble lifted[3 * N] = {[9] = 7, 8, 9 }, across[3];
  Seen seen;

  see (&seen, px, 1, 0, 1);
  cloth_rays_cast (rays, &front, &seen.view);
  cloth_rays_copy (copy, rays);
  cloth_rays_lift (copy, reference, lifted);
  NEAR (lifted[0], 4, 1e-14);
  NEAR (lifted[1], 1, 1e-14);
  NEAR (lifted[2], 0.5, 1e-14);
  for (guint i = 3; i < 9; i++)
    g_assert_true (isnan (lifted[i]));
  for (guint i = 9; i < 12; i++)
    g_assert_cmpfloat (lifted[i], ==, i - 2.);

  NEAR (cloth_rays_split (copy, 0, v, across), 4 / sqrt (2), 1e-14);
  NEAR (across[0], -1, 1e-14);
  NEAR (across[1], 1, 1e-14);
  NEAR (across[2], 5, 1e-14);
  g_assert_true (isnan (cloth_rays_split (copy, 3, v, across)));
}

/* ---- the observer ---- */

#define COLUMNS 4
#define ROWS 3
#define VERTICES (COLUMNS * ROWS)
#define FPS 50
#define FRAMES 30
#define GRAVITY 9.81

/* From @eye, far away, along y or, from above, along −z. */
static void
look (ClothRays * rays, gboolean above, const gdouble * places)
{
  const gdouble eye[2][3] = { {0, -50, 0}, {0, 0, 50} };

  for (guint i = 0; i < VERTICES; i++) {
    gdouble d[3], length;

    memcpy (rays->centres + 3 * i, eye[above], sizeof eye[above]);
    for (guint k = 0; k < 3; k++)
      d[k] = places[3 * i + k] - eye[above][k];
    length = sqrt (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (guint k = 0; k < 3; k++)
      rays->directions[3 * i + k] = d[k] / length;
    rays->spreads[i] = 1e-5;
  }
}

/* A loose sheet at z = 0 is seen to hang in the air, the simulated one falls. From above
 * that is along the observation: it falls on undrawn, g·t²/2, and almost nothing remains. From
 * the side the springs pull it to where it settles g/gain below what was seen. Unseen
 * vertices lie where the scene starts. */
static void
test_observer (gconstpointer data)
{
  const gboolean above = GPOINTER_TO_INT (data);
  const ClothObserverOptions options = { 100, 0.5, 0.3, 0, 1 };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.3f, 0.2f), FPS,
      2);
  g_autoptr (ClothObserver) observer = NULL;
  g_autoptr (ClothRays) rays = cloth_rays_new (VERTICES);
  gfloat residuals[3 * VERTICES], lifted[3 * VERTICES], sigmas[VERTICES];
  guint n = 0;

  g_assert_true (cloth_model_set (model, "damping.mass", 0, &error));
  model->time_step = 0.0001;    /* the closed forms have none */
  for (guint i = 0; i < VERTICES; i++) {
    scene->positions[3 * i] = 0.1 * (i % COLUMNS);
    scene->positions[3 * i + 1] = 0.1 * (i / COLUMNS);
    scene->positions[3 * i + 2] = 0;
  }
  observer = cloth_observer_new (scene, model, &options, &error);
  g_assert_no_error (error);
  look (rays, above, scene->positions);
  for (guint frame = 0; frame < FRAMES + CLOTH_OBSERVER_LATENCY; frame++) {
    cloth_observer_push_rays (observer, (gdouble) frame / FPS, rays);
    if (cloth_observer_get_n_waiting (observer) <= CLOTH_OBSERVER_LATENCY)
      continue;
    g_assert_true (cloth_observer_pop (observer, residuals, &error));
    cloth_observer_get_lifted (observer, lifted, sigmas);
    for (guint i = 0; i < VERTICES; i++) {
      gdouble t = (gdouble) n / FPS, fall = 0.5 * GRAVITY * t * t;
      gdouble w = sqrt (75), e = GRAVITY / 100 * (1 - exp (-5 * t) *
          (cos (w * t) + 5 / w * sin (w * t)));

      if (above) {
        NEAR (lifted[3 * i + 2], -fall, 1e-3 * fall + 1e-3 * t + 1e-9);
        /* 1.7 m nearer to it, of 50 m: 3.5% of 0.3 m */
        g_assert_cmpfloat (hypot (residuals[3 * i], residuals[3 * i + 1]), <,
            0.035 * 0.36);
        g_assert_cmpfloat (fabs (residuals[3 * i + 2]), <, 2e-4);
      } else {
        NEAR (residuals[3 * i + 2], e, 2e-3 * GRAVITY / 10 + 1e-6);
        NEAR (lifted[3 * i + 1], 0.1 * (i / COLUMNS), 1e-4);
      }
      NEAR (sigmas[i], 1e-5 * (50 + (above ? fall : 0)), 1e-5);
    }
    n++;
  }
  g_assert_cmpint (n, ==, FRAMES);

  /* anew, with nothing to see */
  cloth_observer_restart (observer);
  cloth_rays_clear (rays);
  cloth_observer_push_rays (observer, 0, rays);
  g_assert_true (cloth_observer_pop (observer, residuals, &error));
  cloth_observer_get_lifted (observer, lifted, sigmas);
  for (guint i = 0; i < VERTICES; i++)
    g_assert_true (isnan (residuals[3 * i]) && isnan (lifted[3 * i])
        && isnan (sigmas[i]));
  look (rays, above, scene->positions);
  cloth_observer_push_rays (observer, 1. / FPS, rays);
  g_assert_true (cloth_observer_pop (observer, residuals, &error));
  for (guint i = 0; i < 3 * VERTICES; i++)
    g_assert_cmpfloat (fabs (residuals[i]), <, 0.003);
}

/* Of the same sheet two rows are known and the third is seen from the side. All are drawn alike, so all settle as before. The scene's start is half a metre behind: the rays
 * lead to where the rows that are known say the third one is; alone they lead to the scene's. */
static void
test_both (void)
{
  const ClothObserverOptions options = { 100, 0.5, 0.3, 0, 1 };
  const gdouble behind = 0.5;
  const guint first = 2 * COLUMNS, unseen = VERTICES - 1;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.3f, 0.2f), FPS,
      2);
  g_autoptr (ClothObserver) observer = NULL;
  g_autoptr (ClothRays) all = cloth_rays_new (VERTICES);
  g_autoptr (ClothRays) rays = cloth_rays_new (VERTICES);
  gfloat places[3 * VERTICES], residuals[3 * VERTICES], lifted[3 * VERTICES];
  gfloat sigmas[VERTICES];
  gdouble truth[3 * VERTICES] = { 0 };
  guint n = 0;

  g_assert_true (cloth_model_set (model, "damping.mass", 0, &error));
  model->time_step = 0.0001;
  for (guint i = 0; i < VERTICES; i++) {
    truth[3 * i] = 0.1 * (i % COLUMNS);
    truth[3 * i + 1] = 0.1 * (i / COLUMNS);
    for (guint k = 0; k < 3; k++) {
      scene->positions[3 * i + k] = truth[3 * i + k] + (k == 1 ? behind : 0.);
      places[3 * i + k] = i < first ? (gfloat) truth[3 * i + k] : NAN;
    }
  }
  observer = cloth_observer_new (scene, model, &options, &error);
  g_assert_no_error (error);
  look (all, FALSE, truth);
  for (guint i = first; i < VERTICES; i++)
    cloth_rays_take (rays, all, i);
  for (guint frame = 0; frame < FRAMES + CLOTH_OBSERVER_LATENCY; frame++) {
    cloth_observer_push_both (observer, (gdouble) frame / FPS, places, 0, rays);
    if (cloth_observer_get_n_waiting (observer) <= CLOTH_OBSERVER_LATENCY)
      continue;
    g_assert_true (cloth_observer_pop (observer, residuals, &error));
    for (guint i = 0; i < VERTICES; i++)
      sigmas[i] = 7;
    cloth_observer_get_lifted (observer, lifted, sigmas);
    for (guint i = 0; i < VERTICES; i++) {
      gdouble t = (gdouble) n / FPS, w = sqrt (75);
      gdouble e = GRAVITY / 100 * (1 - exp (-5 * t) *
          (cos (w * t) + 5 / w * sin (w * t)));

      NEAR (residuals[3 * i + 2], e, 2e-3 * GRAVITY / 10 + 1e-6);
      NEAR (lifted[3 * i + 1], truth[3 * i + 1], 0.01);
      NEAR (sigmas[i], i < first ? 7 : 50e-5, 1e-5);
    }
    n++;
  }
  g_assert_cmpint (n, ==, FRAMES);

  /* one is not seen at all */
  cloth_observer_restart (observer);
  for (guint i = 0; i < 3 * VERTICES; i++)
    places[i] = NAN;
  cloth_rays_drop (rays, unseen);
  cloth_observer_push_both (observer, 0, places, 0, rays);
  g_assert_true (cloth_observer_pop (observer, residuals, &error));
  cloth_observer_get_lifted (observer, lifted, sigmas);
  for (guint i = first; i < unseen; i++)
    NEAR (lifted[3 * i + 1], truth[3 * i + 1] + behind, 0.01);
  g_assert_true (isnan (residuals[3 * unseen]) && isnan (lifted[3 * unseen])
      && isnan (sigmas[unseen]));

  /* no ray at all: as of a mesh */
  cloth_observer_restart (observer);
  cloth_rays_clear (rays);
  for (guint i = 0; i < 3 * first; i++)
    places[i] = (gfloat) truth[i];
  cloth_observer_push_both (observer, 0, places, 0, rays);
  g_assert_true (cloth_observer_pop (observer, residuals, &error));
  cloth_observer_get_lifted (observer, lifted, sigmas);
  for (guint i = 0; i < VERTICES; i++)
    g_assert_cmpint (isnan (lifted[3 * i]), ==, i >= first);
}

/* Simulating eleven days takes minutes; when it is to stop it comes back, and can begin anew. */
static void
test_stop (void)
{
  gint stop = 0;
  const ClothObserverOptions options = { 100, 0.5, 0.3, 0, 1, &stop };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.3f, 0.2f), FPS,
      2);
  g_autoptr (ClothObserver) observer = NULL;
  gfloat places[3 * VERTICES] = { 0 }, residuals[2][3 * VERTICES];
  gfloat rest[3 * VERTICES];

  model->time_step = 0.0001;
  for (guint i = 0; i < VERTICES; i++) {
    places[3 * i] = 0.1f * (i % COLUMNS);
    places[3 * i + 1] = 0.1f * (i / COLUMNS);
    scene->positions[3 * i] = places[3 * i];
    scene->positions[3 * i + 1] = places[3 * i + 1];
  }
  observer = cloth_observer_new (scene, model, &options, &error);
  g_assert_no_error (error);
  for (guint turn = 0; turn < 2; turn++) {
    /* anew, the second time at the very frame at which it was stopped */
    const gdouble begin = turn ? 1e6 : 0.;

    cloth_observer_restart (observer);
    for (guint frame = 0; frame < 2; frame++) {
      cloth_observer_push (observer, begin + (gdouble) frame / FPS, places, 0);
      g_assert_true (cloth_observer_pop (observer, residuals[turn], &error));
      g_assert_no_error (error);
    }
    cloth_observer_push (observer, begin + 1e6, places, 0);
    g_atomic_int_set (&stop, 1);
    g_assert_false (cloth_observer_pop (observer, rest, &error));
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED);
    g_clear_error (&error);
    g_atomic_int_set (&stop, 0);
  }
  /* a million seconds have fewer digits behind the point */
  for (guint i = 0; i < 3 * VERTICES; i++)
    NEAR (residuals[0][i], residuals[1][i], 1e-6);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gaprays/cast", test_cast);
  g_test_add_func ("/gaprays/lens", test_lens);
  g_test_add_func ("/gaprays/lift", test_lift);
  g_test_add_data_func ("/gaprays/observer/side", GINT_TO_POINTER (FALSE),
      test_observer);
  g_test_add_data_func ("/gaprays/observer/above", GINT_TO_POINTER (TRUE),
      test_observer);
  g_test_add_func ("/gaprays/observer/both", test_both);
  g_test_add_func ("/gaprays/observer/stop", test_stop);
  return g_test_run ();
}
