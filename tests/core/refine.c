/* A rig corrected by the cloth that it films: eight cameras about a simulated sheet, some of which
 * are not as the rig says.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/rig/refine.h"
#include "gst/rig/rotation.h"
#include "gst/rig/triangulate.h"
#include "gst/math/linalg.h"
#include "tests/common/gapfilm.h"
#include "tests/common/gaprecord.h"

#define COLUMNS 9
#define ROWS 10
#define N (COLUMNS * ROWS)
#define N_FRAMES 50
#define FPS 25.
#define NOISE_PX 0.2
#define N_CAMERAS 8

static const gdouble middle[3] = { 0.15, 0., -0.2 };

static void
sway (guint held, gdouble t, gfloat p[3])
{
  p[0] = (gfloat) (held ? 0.3 : 0.);
  p[1] = (gfloat) (0.05 * (1. - cos (5. * t)));
  p[2] = (gfloat) (held ? 0.02 * sin (4. * t) : 0.);
}

static gboolean
hide_some (guint camera, guint vertex, guint frame)
{
  return (vertex / 9 + 3 * camera + frame / 10) % 5 == 0;
}

typedef struct
{
  gdouble *truth;
  gdouble times[N_FRAMES];
} Motion;

static void
motion_init (Motion * m)
{
  const TestGapSheet sheet = { COLUMNS, ROWS, N_FRAMES, 0.3, 0.34, FPS };
  g_autofree gchar *parent = g_dir_make_tmp ("cloth-refine-XXXXXX", NULL);
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothTake) take = NULL;

  model->areal_density = 0.2;
  model->stretch_warp = model->stretch_weft = 120.;
  model->shear = 30.;
  model->bending_warp = model->bending_weft = 2e-5;
  model->damping_stiffness = 1e-3;
  take = test_gap_record (&sheet, model, sway, parent, "take", 1);
  m->truth = test_gap_positions (take);
  for (guint f = 0; f < N_FRAMES; f++)
    m->times[f] = f / FPS;
  test_gap_remove (parent);
}

static void
motion_clear (Motion * m)
{
  g_free (m->truth);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Motion, motion_clear);

/* About the camera's own centre. */
static void
turn (ClothCamera * camera, const gdouble by[3])
{
  gdouble R[9], turned[9], t[3];

  cloth_rotation_from_vector (by, R);
  cloth_mat3_mul (R, camera->R, turned);
  cloth_mat3_vec (R, camera->t, t);
  memcpy (camera->R, turned, sizeof turned);
  memcpy (camera->t, t, sizeof t);
}

/* RMS distance of what a rig triangulates to the truth. */
static gdouble
find_error (const ClothRig * rig, const ClothObservations * observations,
    const Motion * m)
{
  g_autoptr (ClothTriangulator) triangulator =
      cloth_triangulator_new (rig->n_cameras, rig->cameras, NULL);
  gdouble seen[N_CAMERAS][2][N], sum = 0.;
  ClothTriangulateView views[N_CAMERAS];
  ClothTriangulateParameters parameters = CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;
  guint n = 0;

  /* every view counts: what is wrong with a camera must show */
  parameters.threshold = 1e6;
  cloth_triangulator_set_parameters (triangulator, &parameters);
  for (guint f = 2; f + 3 < N_FRAMES; f++) {
    const ClothTriangulation *t;

    memset (views, 0, sizeof views);
    for (guint c = 0; c < N_CAMERAS; c++) {
      for (guint v = 0; v < N; v++)
        seen[c][0][v] = seen[c][1][v] = NAN;
      views[c].x = seen[c][0];
      views[c].y = seen[c][1];
    }
    for (guint i = 0; i < observations->list->len; i++) {
      const ClothObservation *o = &g_array_index (observations->list,
          ClothObservation, i);
      const ClothCamera *camera = &rig->cameras[o->camera];

      if (fabs (o->time_s - camera->offset_s - m->times[f]) > 0.4 / FPS)
        continue;
      for (guint k = 0; k < o->n; k++)
        for (guint axis = 0; axis < 2; axis++)
          seen[o->camera][axis][o->vertices[k]] = o->px[2 * k + axis];
    }
    g_assert_true (cloth_triangulator_run (triangulator, N_CAMERAS, views, N,
            &t, NULL));
    for (guint v = 0; v < N; v++) {
      if (t->reason[v] != CLOTH_POINT_FINE)
        continue;
      for (guint k = 0; k < 3; k++)
        sum += pow (t->position[k][v] - m->truth[3 * (N * f + v) + k], 2.);
      n++;
    }
  }
  return sqrt (sum / n);
}

static ClothRefinement *
refine (const ClothObservations * observations)
{
  const ClothRefineOptions options = CLOTH_REFINE_OPTIONS_DEFAULT;
  g_autoptr (GError) error = NULL;
  ClothRefinement *result = cloth_refine_rig (observations, &options, &error);

  g_assert_no_error (error);
  return result;
}

static void
show (const ClothRefinement * result)
{
  for (guint c = 0; c < N_CAMERAS; c++) {
    const ClothRefineCamera *r = &result->cameras[c];

    g_test_message ("camera %u: turned %6.3f %6.3f %6.3f ± %.3f mrad, moved "
        "%6.3f %6.3f %6.3f ± %.3f mm, focal %6.3f ± %.3f %%, late %6.2f ± %.2f "
        "ms", c, 1e3 * r->turned_rad[0], 1e3 * r->turned_rad[1],
        1e3 * r->turned_rad[2], 1e3 * r->turned_sd[0], 1e3 * r->moved_m[0],
        1e3 * r->moved_m[1], 1e3 * r->moved_m[2], 1e3 * r->moved_sd[0],
        100. * r->focal, 100. * r->focal_sd, 1e3 * r->late_s, 1e3 * r->late_sd);
  }
  g_test_message
      ("floor %.4f px², χ² %.3f, was %.3f; %.2f%% contradict, were "
      "%.1f%%", result->error_floor, result->after.chi_square,
      result->before.chi_square, 100. * result->after.contradicted,
      100. * result->before.contradicted);
}

#define WITHIN(value, truth, sd) \
    g_assert_cmpfloat (fabs ((value) - (truth)), <, 3. * (sd))

/* One camera is turned by 3 mrad, one has a longer lens by 1%, one is 40 ms late. */
static void
test_faults (void)
{
  const TestGapFilming filming = { N_CAMERAS, NOISE_PX, hide_some };
  const gdouble by[3] = { 0.002, -0.002, 0.001 };
  g_autoptr (ClothRig) rig = test_gap_ring (N_CAMERAS, middle);
  g_autoptr (ClothRig) truth = test_gap_ring (N_CAMERAS, middle);
  g_autoptr (ClothObservations) observations = NULL;
  g_autoptr (ClothRefinement) result = NULL;
  g_auto (Motion) m = { NULL };
  gdouble errors[3];

  motion_init (&m);
  turn (&truth->cameras[1], by);
  truth->cameras[3].K[0] *= 1.01;
  truth->cameras[3].K[4] *= 1.01;
  observations = test_gap_film (rig, truth, m.truth, m.times, N_FRAMES, N,
      &filming, 7);
  /* the sixth camera's clock: what it saw at t it says to have seen 40 ms later */
  truth->cameras[5].offset_s = 0.04;
  for (guint i = 0; i < observations->list->len; i++) {
    ClothObservation *o = &g_array_index (observations->list, ClothObservation,
        i);

    if (o->camera == 5)
      o->time_s += 0.04;
  }
  result = refine (observations);
  show (result);
  for (guint k = 0; k < 3; k++)
    WITHIN (result->cameras[1].turned_rad[k], by[k],
        result->cameras[1].turned_sd[k]);
  WITHIN (result->cameras[3].focal, 0.01, result->cameras[3].focal_sd);
  WITHIN (result->cameras[5].late_s, 0.04, result->cameras[5].late_sd);
  /* they say something */
  g_assert_cmpfloat (result->cameras[1].turned_sd[0], <, 4e-4);
  g_assert_cmpfloat (result->cameras[3].focal_sd, <, 2e-3);
  g_assert_cmpfloat (result->cameras[5].late_sd, <, 2e-3);
  g_assert_true (result->settled);
  /* χ² counts what they still disagree by as noise: it is nothing beside the noise's own variance */
  g_assert_cmpfloat_with_epsilon (result->after.chi_square, 1., 0.2);
  g_assert_cmpfloat (result->error_floor, <, 0.1 * NOISE_PX * NOISE_PX);
  /* the others stay */
  for (guint c = 0; c < N_CAMERAS; c++) {
    const ClothRefineCamera *r = &result->cameras[c];

    for (guint k = 0; k < 3; k++) {
      if (c != 1)
        WITHIN (r->turned_rad[k], 0., r->turned_sd[k]);
      WITHIN (r->moved_m[k], 0., r->moved_sd[k]);
    }
    if (c != 3)
      WITHIN (r->focal, 0., r->focal_sd);
    if (c != 5)
      WITHIN (r->late_s, 0., r->late_sd);
  }
  g_assert_cmpfloat (result->after.contradicted, <, 0.01);
  g_assert_cmpfloat (result->before.contradicted, >, 0.2);
  errors[0] = find_error (rig, observations, &m);
  errors[1] = find_error (result->rig, observations, &m);
  errors[2] = find_error (truth, observations, &m);
  g_test_message ("triangulated: %.3f mm with the rig, %.3f refined, %.3f with "
      "the true one", 1e3 * errors[0], 1e3 * errors[1], 1e3 * errors[2]);
  g_assert_cmpfloat (errors[1], <, 1.1 * errors[2]);
  g_assert_cmpfloat (errors[0], >, 2. * errors[2]);
}

/* A rig that is right stays as it is, to what the noise allows. */
static void
test_right (void)
{
  const TestGapFilming filming = { N_CAMERAS, NOISE_PX, hide_some };
  g_autoptr (ClothRig) rig = test_gap_ring (N_CAMERAS, middle);
  g_autoptr (ClothObservations) observations = NULL;
  g_autoptr (ClothRefinement) result = NULL;
  g_auto (Motion) m = { NULL };

  motion_init (&m);
  observations = test_gap_film (rig, rig, m.truth, m.times, N_FRAMES, N,
      &filming, 9);
  result = refine (observations);
  show (result);
  for (guint c = 0; c < N_CAMERAS; c++) {
    const ClothRefineCamera *r = &result->cameras[c];

    for (guint k = 0; k < 3; k++) {
      WITHIN (r->turned_rad[k], 0., r->turned_sd[k]);
      WITHIN (r->moved_m[k], 0., r->moved_sd[k]);
    }
    WITHIN (r->focal, 0., r->focal_sd);
    WITHIN (r->late_s, 0., r->late_sd);
    /* no worse known than before */
    g_assert_cmpfloat (r->turned_sd[0], <, 5e-4);
    g_assert_cmpfloat (r->moved_sd[0], <, 5e-4);
    g_assert_cmpfloat (r->focal_sd, <, 1e-3);
    g_assert_cmpfloat (r->late_sd, <, 1e-3);
  }
  g_assert_cmpfloat_with_epsilon (result->after.chi_square, 1., 0.1);
  g_assert_cmpfloat (result->error_floor, <, 0.1 * NOISE_PX * NOISE_PX);
}

/* A clock that is late by a third of a frame, so that all its pictures are between the others'; a
 * camera that is blind stays as it was, clock and all, and a pause is no frame. */
static void
test_between (void)
{
  const gdouble late = 0.013, pause = 30.;
  const TestGapFilming filming = { N_CAMERAS, NOISE_PX, hide_some };
  g_autoptr (ClothRig) rig = test_gap_ring (N_CAMERAS, middle);
  g_autoptr (ClothObservations) filmed = NULL, observations = NULL;
  g_autoptr (ClothRefinement) result = NULL;
  g_auto (Motion) m = { NULL };

  motion_init (&m);
  filmed =
      test_gap_film (rig, rig, m.truth, m.times, N_FRAMES, N, &filming, 11);
  observations = cloth_observations_new (test_gap_ring (N_CAMERAS, middle), N);
  for (guint i = 0; i < filmed->list->len; i++) {
    const ClothObservation *o = &g_array_index (filmed->list, ClothObservation,
        i);

    if (o->camera != 2)
      cloth_observations_add (observations, o->camera, o->time_s +
          (o->camera == 5 ? late : 0.) + (o->time_s > 0.5 *
              m.times[N_FRAMES - 1] ? pause : 0.), o->n, o->vertices, o->px,
          o->covariances, NULL);
  }
  result = refine (observations);
  show (result);
  WITHIN (result->cameras[5].late_s, late, result->cameras[5].late_sd);
  g_assert_cmpfloat (result->cameras[5].late_sd, <, 2e-3);
  g_assert_cmpuint (result->cameras[2].n, ==, 0);
  g_assert_cmpfloat (result->cameras[2].late_s, ==, 0.);
  for (guint k = 0; k < 3; k++)
    g_assert_cmpfloat (result->cameras[2].moved_m[k], ==, 0.);
}

static void
test_refused (void)
{
  const ClothRefineOptions options = CLOTH_REFINE_OPTIONS_DEFAULT;
  const guint32 vertices[2] = { 0, 1 };
  const gdouble px[4] = { 10., 10., 20., 20. };
  const gdouble covariances[6] = { 0.1, 0., 0.1, 0.1, 0., 0.1 };

  for (guint n_seeing = 0; n_seeing <= 2; n_seeing++) {
    g_autoptr (ClothObservations) observations =
        cloth_observations_new (test_gap_ring (3, middle), N);
    g_autoptr (GError) error = NULL;

    for (guint c = 0; c < n_seeing; c++)
      for (guint f = 0; f < 5; f++)
        cloth_observations_add (observations, c, f / FPS, 2, vertices, px,
            covariances, NULL);
    g_assert_null (cloth_refine_rig (observations, &options, &error));
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
    g_assert_nonnull (strstr (error->message, n_seeing < 2 ? "took pictures" :
            "at least 50"));
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/refine/faults", test_faults);
  g_test_add_func ("/refine/right", test_right);
  g_test_add_func ("/refine/between", test_between);
  g_test_add_func ("/refine/refused", test_refused);
  return g_test_run ();
}
