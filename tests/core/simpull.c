/* Pulls: forces of each rank and law against closed forms, what the corners feel, steps,
 * derivatives, and what is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#define NEAR(a, b, e) g_assert_cmpfloat_with_epsilon (a, b, e)
#define GAIN 100.
#define SIGMA 0.002
#define STEP 1e-6

/* A small flat sheet without weight. */
static ClothScene *
weightless (guint columns, guint rows)
{
  ClothScene *scene = sheet_new (columns, rows, 0.1 * (columns - 1),
      0.12 * (rows - 1));

  memset (scene->gravity, 0, sizeof scene->gravity);
  return scene;
}

/* Λ of what is known along each of @n unit vectors to σ. */
static void
know (gdouble information[6], guint n, const gdouble (*along)[3], gdouble sigma)
{
  memset (information, 0, 6 * sizeof *information);
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < 3; k++) {
      information[k] += along[i][k] * along[i][k] / (sigma * sigma);
      information[3 + k] += along[i][(k + 1) % 3] * along[i][(k + 2) % 3] /
          (sigma * sigma);
    }
}

static void
keep (ClothPull * pull)
{
  pull->next = pull->now;
}

static gdouble
fall_off (ClothPullLaw law, gdouble d, gdouble s)
{
  return law == CLOTH_PULL_LINEAR ? 1. : law == CLOTH_PULL_RECIPROCAL ?
      1. / (d * d + s * s) : pow (d * d + s * s, -1.5);
}

static void
cross (const gdouble a[3], const gdouble b[3], gdouble c[3])
{
  for (guint k = 0; k < 3; k++)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Accelerations of the vertices in one short step from rest. */
static void
accelerate (const ClothScene * scene, ClothIntegrator integrator,
    const ClothPull * pull, const ClothPullOptions * options, gdouble damping,
    gdouble * a)
{
  g_autoptr (ClothModel) model = model_new (0.2, 30.);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = NULL;
  const gdouble gain = GAIN;

  model->integrator = integrator;
  model->time_step = STEP;
  sim = run_new (scene, model);
  g_assert_true (cloth_sim_set_pulls (sim, pull, 1, options, &gain, &damping,
          0., 0.02, &error));
  g_assert_no_error (error);
  cloth_sim_advance (sim, STEP);
  cloth_sim_get_velocities (sim, 0, a);
  /* explicit steps have the velocity of their middle */
  for (guint i = 0; i < 3 * scene->topology->n_vertices; i++)
    a[i] /= integrator == CLOTH_INTEGRATOR_EXPLICIT ? STEP / 2. : STEP;
}

/* In a triangle of the sheet; masses of its corners are areas times 0.2 kg/m². */
typedef struct
{
  ClothPull pull;
  gdouble p[3], mass, m[3];
} Point;

static void
place (Point * point, const ClothScene * scene)
{
  static const guint32 corner[3] = { 0, 1, 3 };
  /* of a 3 × 3 sheet whose cells have 0.1 m × 0.12 m: a quarter, a half, a half */
  static const gdouble share[3] = { 0.25, 0.5, 0.5 };

  memset (point, 0, sizeof *point);
  for (guint i = 0; i < 3; i++) {
    point->pull.corner[i] = corner[i];
    point->pull.weight[i] = (gdouble[]) {
    0.2, 0.5, 0.3}
    [i];
    point->m[i] = 0.2 * 0.1 * 0.12 * share[i];
    point->mass += point->pull.weight[i] * point->m[i];
    for (guint k = 0; k < 3; k++)
      point->p[k] += point->pull.weight[i] *
          scene->positions[3 * corner[i] + k];
  }
}

/* f of a force law: rank 3 along y − p; rank 2 along the shortest vector to a ray in Plücker
 * coordinates, (m₀ − p×d₀)×d₀ up to the sign; rank 1 along a normal. */
static void
test_forces (gconstpointer data)
{
  const ClothIntegrator integrator = GPOINTER_TO_UINT (data);
  g_autoptr (ClothScene) scene = weightless (3, 3);
  const gdouble h = sqrt (0.5), s = 0.8;
  const gdouble axes[3][3] = { {1, 0, 0}, {0, 1, 0}, {0, 0, 1} };
  /* a ray along (0.6, 0, 0.8), and what is across it */
  const gdouble ray[3] = { 0.6, 0, 0.8 };
  const gdouble across[2][3] = { {0, 1, 0}, {0.8, 0, -0.6} };
  const gdouble normal[1][3] = { {h, -h, 0} };
  const gdouble off[3] = { 0.003, -0.001, 0.004 };

  for (guint rank = 1; rank <= 3; rank++)
    for (ClothPullLaw law = CLOTH_PULL_LINEAR;
        law <= CLOTH_PULL_RECIPROCAL_SQUARE; law++) {
      const ClothPullOptions options = { law, s, CLOTH_PULL_BALANCED, SIGMA };
      gdouble v[3], a[27], d, moment[3] = { 0. }, total[3] = { 0. }, arm[3];
      Point point;

      place (&point, scene);
      for (guint k = 0; k < 3; k++)
        point.pull.now.target[k] = point.p[k] + off[k];
      if (rank == 3) {
        know (point.pull.now.information, 3, axes, SIGMA / 2);
        memcpy (v, off, sizeof v);
      } else if (rank == 2) {
        gdouble m0[3], moved[3], pd[3];

        know (point.pull.now.information, 2, across, SIGMA / 2);
        cross (point.pull.now.target, ray, m0);
        cross (point.p, ray, pd);
        for (guint k = 0; k < 3; k++)
          moved[k] = pd[k] - m0[k];
        cross (moved, ray, v);
        /* along the ray the target may be anywhere */
        for (guint k = 0; k < 3; k++)
          point.pull.now.target[k] += 0.3 * ray[k];
      } else {
        gdouble along = off[0] * h - off[1] * h;

        know (point.pull.now.information, 1, normal, SIGMA / 2);
        for (guint k = 0; k < 3; k++)
          v[k] = along * normal[0][k];
        point.pull.now.target[2] += 0.7;
      }
      keep (&point.pull);
      accelerate (scene, integrator, &point.pull, &options, 0., a);
      d = sqrt (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (SIGMA / 2);
      for (guint k = 0; k < 3; k++)
        v[k] *= point.mass * GAIN * 4. * fall_off (law, d, s);
      for (guint i = 0; i < 3; i++)
        for (guint k = 0; k < 3; k++) {
          const guint c = point.pull.corner[i];
          gdouble expected = point.pull.weight[i] * v[k] / point.m[i];

          /* an implicit step also sees the force fade: h² g is 1e-10 */
          NEAR (a[3 * c + k], expected, (integrator ? 3e-8 : 1e-9) *
              (1. + fabs (expected)));
          total[k] += point.m[i] * a[3 * c + k];
        }
      for (guint i = 0; i < 3; i++) {
        gdouble push[3];

        for (guint k = 0; k < 3; k++)
          push[k] = point.m[i] * a[3 * point.pull.corner[i] + k];
        cross (scene->positions + 3 * point.pull.corner[i], push, arm);
        for (guint k = 0; k < 3; k++)
          moment[k] += arm[k];
      }
      cross (point.p, v, arm);
      for (guint k = 0; k < 3; k++) {
        NEAR (total[k], v[k], integrator ? 1e-10 : 1e-12);
        NEAR (moment[k], arm[k], integrator ? 1e-10 : 1e-12);
      }
    }
}

/* As printed, 1.5 f at the middle of a triangle, and f at a corner. */
static void
test_printed (void)
{
  g_autoptr (ClothScene) scene = weightless (3, 3);
  const gdouble axes[3][3] = { {1, 0, 0}, {0, 1, 0}, {0, 0, 1} };

  for (guint at_corner = 0; at_corner < 2; at_corner++) {
    gdouble total[2] = { 0. };

    for (ClothPullShares shares = CLOTH_PULL_BALANCED;
        shares <= CLOTH_PULL_PRINTED; shares++) {
      const ClothPullOptions options = { CLOTH_PULL_LINEAR, 1., shares, SIGMA };
      gdouble a[27];
      Point point;

      place (&point, scene);
      for (guint i = 0; i < 3; i++) {
        point.pull.weight[i] = at_corner ? i == 1 : 1. / 3.;
        if (at_corner)
          point.pull.corner[i] = 1;
      }
      know (point.pull.now.information, 3, axes, SIGMA);
      point.pull.now.target[2] = 0.01;
      keep (&point.pull);
      accelerate (scene, CLOTH_INTEGRATOR_EXPLICIT, &point.pull, &options, 0.,
          a);
      for (guint i = 0; i < (at_corner ? 1 : 3); i++)
        total[shares] += point.m[at_corner ? 1 : i] *
            a[3 * point.pull.corner[i] + 2];
    }
    NEAR (total[1], (at_corner ? 1. : 1.5) * total[0], 1e-12);
    g_assert_cmpfloat (total[0], >, 1e-4);
  }
}

/* The damping's part, and straight lines between the ends of the interval: at rest and on the
 * target only the target's velocity draws. */
static void
test_velocity (void)
{
  g_autoptr (ClothScene) scene = weightless (3, 3);
  const ClothPullOptions options = { CLOTH_PULL_LINEAR, 1.,
    CLOTH_PULL_BALANCED, SIGMA
  };
  const gdouble axes[3][3] = { {1, 0, 0}, {0, 1, 0}, {0, 0, 1} };
  gdouble a[27];
  Point point;

  place (&point, scene);
  know (point.pull.now.information, 3, axes, SIGMA);
  memcpy (point.pull.now.target, point.p, sizeof point.p);
  point.pull.now.velocity[1] = 0.5;
  point.pull.next = point.pull.now;
  point.pull.next.target[1] += 10.;
  point.pull.next.velocity[1] += 10.;
  accelerate (scene, CLOTH_INTEGRATOR_EXPLICIT, &point.pull, &options, 8., a);
  NEAR (a[3 * 1 + 1], 0.5 * point.mass / point.m[1] * 8. * 0.5, 1e-9);
}

/* @n models of one sheet, swinging at two corners while all that is seen of it draws it: by
 * targets, or by a pull at each vertex. */
static gdouble *
follow (const ClothModel * const *models, guint n, gboolean pulled,
    const gdouble * gains, ClothSimOptions sim_options)
{
  g_autoptr (ClothScene) scene = sheet_new (6, 7, 0.3, 0.35);
  const guint n_vertices = scene->topology->n_vertices;
  const gdouble axes[3][3] = { {1, 0, 0}, {0, 1, 0}, {0, 0, 1} };
  const ClothPullOptions options = { CLOTH_PULL_LINEAR, 1.,
    CLOTH_PULL_BALANCED, SIGMA
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *y = g_new (gdouble, 3 * n_vertices);
  g_autofree gdouble *next = g_new (gdouble, 3 * n_vertices);
  g_autofree gdouble *u = g_new0 (gdouble, 3 * n_vertices);
  g_autofree gdouble *weights = g_new (gdouble, n_vertices);
  g_autofree gdouble *dampings = g_new (gdouble, n);
  g_autofree ClothPull *pulls = g_new0 (ClothPull, n_vertices);
  gdouble *x = g_new (gdouble, 3 * (gsize) n_vertices * n);

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, 5);
  sim = cloth_sim_new (scene, models, n, &sim_options, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < n; i++)
    dampings[i] = sqrt (gains[i]);
  for (guint frame = 0; frame < 10; frame++) {
    for (guint i = 0; i < n_vertices; i++) {
      weights[i] = 1.;
      for (guint k = 0; k < 3; k++) {
        y[3 * i + k] = scene->positions[3 * i + k] +
            (k == 1 ? 0.01 * frame * (i % 6 != 0 || i > 6) : 0.);
        next[3 * i + k] = y[3 * i + k] + (k == 1 ? 0.01 : 0.);
        u[3 * i + k] = k == 1 ? 0.5 : 0.;
      }
      for (guint k = 0; k < 3; k++)
        pulls[i].corner[k] = i;
      pulls[i].weight[0] = 1.;
      know (pulls[i].now.information, 3, axes, SIGMA);
      memcpy (pulls[i].now.target, y + 3 * i, 3 * sizeof *y);
      memcpy (pulls[i].now.velocity, u + 3 * i, 3 * sizeof *u);
      pulls[i].next = pulls[i].now;
      memcpy (pulls[i].next.target, next + 3 * i, 3 * sizeof *y);
    }
    if (pulled)
      g_assert_true (cloth_sim_set_pulls (sim, pulls, n_vertices, &options,
              gains, dampings, 0.02 * frame, 0.02 * (frame + 1), &error));
    else
      cloth_sim_set_all_targets (sim, y, next, u, u, weights, NULL, gains,
          dampings, 0.02 * frame, 0.02 * (frame + 1));
    g_assert_no_error (error);
    cloth_sim_advance (sim, 0.02 * (frame + 1));
  }
  for (guint i = 0; i < n; i++)
    cloth_sim_get_positions (sim, i, x + 3 * (gsize) n_vertices * i);
  return x;
}

/* Pulls at all vertices are the observer's springs. */
static void
test_as_targets (void)
{
  const gdouble gain = 400.;

  for (guint kind = 0; kind < 6; kind++) {
    g_autoptr (ClothModel) model = model_new (0.2, 30.);
    const ClothModel *models[1] = { model };
    const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
    g_autofree gdouble *a = NULL, *b = NULL;
    gdouble most = 0.;

    model->force_model = kind % 2 ? CLOTH_FORCE_MASS_SPRING :
        CLOTH_FORCE_MEMBRANE;
    model->integrator = kind / 2 == 2 ? CLOTH_INTEGRATOR_IMPLICIT :
        CLOTH_INTEGRATOR_EXPLICIT;
    model->time_step = kind / 2 == 1 ? 0. : 2e-4;
    model->damping_stiffness = kind / 2 == 1 ? 3e-3 : 0.;
    a = follow (models, 1, FALSE, &gain, options);
    b = follow (models, 1, TRUE, &gain, options);
    for (guint i = 0; i < 3 * 42; i++)
      most = MAX (most, fabs (a[i] - b[i]));
    /* conjugate gradients end at another rest; an automatic step may be another one */
    g_assert_cmpfloat (most, <, kind / 2 == 0 ? 1e-12 : 2e-5);
  }
}

/* A strength for each lane; threads, instruction sets and neighbours change no bit. */
static void
test_lanes (void)
{
  const ClothSimd sets[] =
      { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2, CLOTH_SIMD_AVX512 };
  enum
  { N = 19 };
  ClothModel *models[N];
  gdouble gains[N];
  const gsize row = 3 * 42 * sizeof (gdouble);

  for (guint i = 0; i < N; i++) {
    models[i] = model_new (0.2, 30.);
    models[i]->time_step = 5e-4;
    gains[i] = 50. * (i % 5);
  }
  for (guint single = 0; single < 2; single++) {
    g_autofree gdouble *reference = NULL;

    for (guint s = 0; s < G_N_ELEMENTS (sets); s++)
      for (guint threads = 1; threads <= 3; threads += 2) {
        g_autofree gdouble *got = follow ((const ClothModel * const *) models,
            N, TRUE, gains, (ClothSimOptions) { single != 0, threads, sets[s],
              0
            });

        if (!reference)
          reference = g_steal_pointer (&got);
        else
          g_assert_cmpmem (reference, N * row, got, N * row);
      }
    g_assert_cmpmem (reference, row, reference + 5 * 3 * 42, row);
    g_assert_cmpint (memcmp (reference, reference + 3 * 42, row), !=, 0);
    for (guint i = 0; i < N; i++) {
      g_autofree gdouble *alone = follow ((const ClothModel * const *) models +
          i, 1, TRUE, gains + i, (ClothSimOptions) { single != 0, 1,
            CLOTH_SIMD_BEST, 0
          });

      g_assert_cmpmem (reference + i * 3 * 42, row, alone, row);
    }
  }
  for (guint i = 0; i < N; i++)
    cloth_model_free (models[i]);
}

/* The derivative of all places by the stretch stiffness, with steps of two widths. */
static void
test_derivative (void)
{
  const gdouble gains[5] = { 400., 400., 400., 400., 400. };
  const gdouble widths[2] = { 1e-3, 1e-5 };
  ClothModel *models[5];
  g_autofree gdouble *x = NULL;
  gdouble square = 0., off = 0.;

  for (guint i = 0; i < 5; i++) {
    models[i] = model_new (0.2, 30. * (1. + (i == 0 ? 0. : (i % 2 ? 1. : -1.) *
                widths[(i - 1) / 2])));
    models[i]->time_step = 2e-4;
  }
  x = follow ((const ClothModel * const *) models, 5, TRUE, gains,
      (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_BEST, 0});
  for (guint i = 0; i < 3 * 42; i++) {
    gdouble d[2];

    for (guint w = 0; w < 2; w++)
      d[w] = (x[(1 + 2 * w) * 3 * 42 + i] - x[(2 + 2 * w) * 3 * 42 + i]) /
          (2. * widths[w]);
    square += d[1] * d[1];
    off += (d[0] - d[1]) * (d[0] - d[1]);
  }
  g_assert_cmpfloat (square, >, 1e-10);
  g_assert_cmpfloat (sqrt (off / square), <, 1e-3);
  for (guint i = 0; i < 5; i++)
    cloth_model_free (models[i]);
}

/* On a finer mesh the same points carry the whole cloth: it goes as a whole with the gain
 * times the distance. */
static void
test_finer_mesh (void)
{
  const gdouble axes[3][3] = { {1, 0, 0}, {0, 1, 0}, {0, 0, 1} }, gain = GAIN;
  const gdouble none = 0., factor = 2.;
  const ClothPullOptions options = { CLOTH_PULL_LINEAR, 1.,
    CLOTH_PULL_BALANCED, SIGMA
  };

  for (guint fine = 0; fine < 2; fine++) {
    g_autoptr (ClothScene) scene = weightless (5, 5);
    g_autoptr (ClothModel) model = model_new (0.2, 3000.);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothSim) sim = NULL;
    ClothPull pulls[25] = { 0 };
    gdouble x[75], mean = 0.;

    model->damping_stiffness = 1e-4;
    model->time_step = 1e-5;
    if (fine)
      cloth_model_set_effect (model, &cloth_effect_mesh_resolution, &factor);
    sim = run_new (scene, model);
    for (guint i = 0; i < 25; i++) {
      for (guint k = 0; k < 3; k++)
        pulls[i].corner[k] = i;
      pulls[i].weight[0] = 1.;
      know (pulls[i].now.information, 3, axes, SIGMA);
      memcpy (pulls[i].now.target, scene->positions + 3 * i,
          3 * sizeof (gdouble));
      pulls[i].now.target[0] += 0.01;
      keep (&pulls[i]);
    }
    g_assert_true (cloth_sim_set_pulls (sim, pulls, 25, &options, &gain, &none,
            0., 0.02, &error));
    cloth_sim_advance (sim, 0.02);
    cloth_sim_get_positions (sim, 0, x);
    for (guint i = 0; i < 25; i++)
      mean += (x[3 * i] - scene->positions[3 * i]) / 25.;
    /* d (1 − cos √g t) */
    NEAR (mean, 0.01 * (1. - cos (10. * 0.02)), 3e-6);
  }
}

/* Two models whose clamps go elsewhere. */
static void
test_clamps (void)
{
  g_autoptr (ClothScene) scene = weightless (3, 3);
  g_autoptr (ClothModel) model = model_new (0.2, 30.);
  const ClothModel *models[3] = { model, model, model };
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = NULL;
  gdouble paths[6], x[27];

  cloth_scene_hold (scene, 4);
  sim = cloth_sim_new (scene, models, 3, &options, &error);
  g_assert_no_error (error);
  memcpy (paths, scene->clamps, sizeof paths);
  paths[3 + 2] += 0.002;
  cloth_sim_set_clamps (sim, 1, paths);
  cloth_sim_advance (sim, 0.02);
  for (guint m = 0; m < 3; m++) {
    cloth_sim_get_positions (sim, m, x);
    NEAR (x[3 * 4 + 2], scene->positions[3 * 4 + 2] + (m == 1 ? 0.002 : 0.),
        1e-12);
  }
  cloth_sim_set_clamps (sim, 1, NULL);
  cloth_sim_set_state (sim, 1, scene->positions, NULL, 0.);
  cloth_sim_advance (sim, 0.02);
  cloth_sim_get_positions (sim, 1, x);
  NEAR (x[3 * 4 + 2], scene->positions[3 * 4 + 2], 1e-12);
}

static void
test_refused (void)
{
  g_autoptr (ClothScene) scene = weightless (3, 3);
  g_autoptr (ClothModel) model = model_new (0.2, 30.);
  g_autoptr (ClothSim) sim = run_new (scene, model);
  const gdouble axes[3][3] = { {1, 0, 0}, {0, 1, 0}, {0, 0, 1} };
  const ClothPullOptions usual = { CLOTH_PULL_LINEAR, 1., CLOTH_PULL_BALANCED,
    SIGMA
  };
  const gdouble gain = GAIN, damping = 0., huge = 1e22;
  gdouble x[27];
  Point sound;

  place (&sound, scene);
  know (sound.pull.now.information, 3, axes, SIGMA);
  keep (&sound.pull);
  for (guint fault = 0; fault < 11; fault++) {
    g_autoptr (GError) error = NULL;
    ClothPull pull = sound.pull;
    ClothPullOptions options = usual;
    const gchar *word = NULL;
    gdouble until = 0.02;

    switch (fault) {
      case 0:
        pull.now.information[1] = -1.;
        word = "*negative*";
        break;
      case 1:
        pull.next.information[3] = 2. * pull.next.information[0];
        word = "*negative*";
        break;
      case 2:
        /* its minors are not negative, but it is along (1, 1, 1) */
        for (guint k = 3; k < 6; k++)
          pull.now.information[k] = -0.7 * pull.now.information[0];
        word = "*negative*";
        break;
      case 3:
        pull.now.target[0] = NAN;
        word = "*not finite*";
        break;
      case 4:
        pull.next.velocity[2] = INFINITY;
        word = "*not finite*";
        break;
      case 5:
        pull.weight[1] += 0.1;
        word = "*sum is not 1*";
        break;
      case 6:
        pull.corner[2] = 9;
        word = "*cloth has not*";
        break;
      case 7:
        options.sigma = 0.;
        word = "*above 0*";
        break;
      case 8:
        options.softening = NAN;
        word = "*above 0*";
        break;
      case 9:
        until = 0.;
        word = "*not empty*";
        break;
      default:
        word = "*lower the gain*";
        break;
    }
    g_assert_false (cloth_sim_set_pulls (sim, &pull, 1, &options,
            fault == 10 ? &huge : &gain, &damping, 0., until, &error));
    g_assert_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_PULL);
    if (!g_pattern_match_simple (word, error->message))
      g_error ("fault %u: %s", fault, error->message);
  }
  /* nothing draws it after an error */
  cloth_sim_advance (sim, 0.02);
  cloth_sim_get_positions (sim, 0, x);
  for (guint i = 0; i < 27; i++)
    NEAR (x[i], scene->positions[i], 1e-12);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_data_func ("/simpull/forces/explicit",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_EXPLICIT), test_forces);
  g_test_add_data_func ("/simpull/forces/implicit",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_IMPLICIT), test_forces);
  g_test_add_func ("/simpull/printed", test_printed);
  g_test_add_func ("/simpull/velocity", test_velocity);
  g_test_add_func ("/simpull/as-targets", test_as_targets);
  g_test_add_func ("/simpull/lanes", test_lanes);
  g_test_add_func ("/simpull/derivative", test_derivative);
  g_test_add_func ("/simpull/finer-mesh", test_finer_mesh);
  g_test_add_func ("/simpull/clamps", test_clamps);
  g_test_add_func ("/simpull/refused", test_refused);
  return g_test_run ();
}
