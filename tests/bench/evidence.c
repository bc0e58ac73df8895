/* What a diagnosis makes of the same motions seen in other ways: as a mesh with one standard
 * deviation, as a mesh with the covariance of each place, and as rays of 1, 2, 3 and 8 cameras
 * alone. Reality is a mass–spring cloth with damping and stiffnesses of its own, the model a
 * membrane; a baseline of the same motion is given.
 *
 *   bench-evidence [SEEDS]     3 by default
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gst/gap/diagnose.h"
#include "gst/math/random.h"
#include "tests/common/gapfilm.h"
#include "tests/common/gaprecord.h"

#define LANES(name) extern const ClothEffect cloth_effect_##name;
#include "gst/effect/list.h"

#define COLUMNS 9
#define ROWS 10
#define N (COLUMNS * ROWS)
#define N_FRAMES 75
#define FPS 50.
#define NOISE_PX 0.3

static const gdouble middle[3] = { 0.15, 0., -0.2 };

typedef enum
{ ONE_SIGMA, COVARIANCES, RAYS_1, RAYS_2, RAYS_3, RAYS_8, N_KINDS } Kind;

static const gchar *const names[N_KINDS] =
    { "mesh of 2 cameras, one σ", "the same, covariances", "rays of 1 camera",
  "rays of 2 cameras", "rays of 3 cameras", "rays of 8 cameras"
};

typedef struct
{
  const ClothEffect *effect;
  guint n;                      /* of its numbers; the others are null */
  gdouble values[3];
} Case;

static const Case cases[] = {
  {&cloth_effect_air_drag, 1, {1.2}},
  {&cloth_effect_wind, 3, {0.4, -0.9, 0.}},
  {&cloth_effect_gravity_tilt, 2, {0.05, 0.04}},
  {&cloth_effect_bending, 1, {1.4}},
  {&cloth_effect_areal_mass, 1, {0.25}},
  {&cloth_effect_clamp_delay, 1, {0.03}},
};

static guint64 seed;

static void
sway (guint held, gdouble t, gfloat p[3])
{
  const gdouble w = 6. + 0.5 * (gdouble) (seed % 5);

  p[0] = (gfloat) ((held ? 0.3 : 0.) + 0.01 * sin ((3. + seed % 3) * t));
  p[1] = (gfloat) (0.06 * (1. - cos (w * t)));
  p[2] = (gfloat) ((held ? 0.03 : 0.01) * sin ((w + 2.) * t));
}

static gboolean
hide_some (guint camera, guint vertex, guint frame)
{
  return (vertex / 9 + 3 * camera + frame / 10 + (guint) seed) % 5 == 0;
}

static ClothModel *
model_new (gboolean other)
{
  ClothModel *model = cloth_model_new ();

  model->areal_density = 0.2;
  model->stretch_warp = model->stretch_weft = other ? 140. : 120.;
  model->shear = other ? 26. : 30.;
  model->bending_warp = model->bending_weft = 2e-5;
  model->damping_stiffness = other ? 1.3e-3 : 1e-3;
  if (other)
    model->force_model = CLOTH_FORCE_MASS_SPRING;
  else
    test_gap_free_parameters (model);
  return model;
}

/* Two cameras near each other: a mesh whose depth is known less well. */
static ClothRig *
pair_new (void)
{
  g_autoptr (ClothRig) ring = test_gap_ring (40, middle);
  ClothRig *rig = cloth_rig_new (2);

  for (guint c = 0; c < 2; c++)
    cloth_camera_copy (&rig->cameras[c], &ring->cameras[2 * c]);
  return rig;
}

/* A take of places that cameras triangulated, with the covariance of each or the usual deviation. */
static ClothTake *
triangulate (const ClothTake * whole, const ClothObservations * o,
    gboolean covariances, const gchar * parent)
{
  const ClothRig *rig = o->rig;
  g_autoptr (ClothTriangulator) triangulator =
      cloth_triangulator_new (rig->n_cameras, rig->cameras, NULL);
  const ClothTakeInfo *from = cloth_take_get_info (whole);
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (from->name);
  g_autofree gchar *folder = g_build_filename (parent, covariances ? "with" :
      "without", NULL);
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autoptr (GError) error = NULL;
  gdouble seen[8][5][N], square = 0.;
  guint n = 0;

  info->fps = FPS;
  info->columns = COLUMNS;
  info->rows = ROWS;
  info->width_m = from->width_m;
  info->height_m = from->height_m;
  g_array_append_vals (info->held, from->held->data, from->held->len);
  for (guint pass = 0; pass < 2; pass++) {
    if (pass) {
      info->noise_sigma_m = covariances ? NAN : sqrt (square / n);
      writer = cloth_take_writer_new (folder, info,
          cloth_take_get_topology (whole), &error);
    }
    for (guint f = 0; f < N_FRAMES; f++) {
      ClothTriangulateView views[8] = { {NULL}
      };
      const ClothTriangulation *t;
      gfloat positions[3 * N], covariance[6 * N], clamps[6];
      guint8 states[N];

      for (guint c = 0; c < rig->n_cameras; c++) {
        for (guint k = 0; k < 5; k++)
          for (guint v = 0; v < N; v++)
            seen[c][k][v] = NAN;
        views[c] = (ClothTriangulateView) {
        seen[c][0], seen[c][1], seen[c][2], seen[c][3], seen[c][4]};
      }
      for (guint i = 0; i < o->list->len; i++) {
        const ClothObservation *p = &g_array_index (o->list, ClothObservation,
            i);

        for (guint k = 0; fabs (p->time_s - f / FPS) < 1e-6 && k < p->n; k++)
          for (guint a = 0; a < 5; a++)
            seen[p->camera][a][p->vertices[k]] = a < 2 ? p->px[2 * k + a] :
                p->covariances[3 * k + a - 2];
      }
      cloth_triangulator_run (triangulator, rig->n_cameras, views, N, &t, NULL);
      for (guint v = 0; v < N; v++) {
        const gboolean fine = t->reason[v] == CLOTH_POINT_FINE;

        states[v] = fine ? CLOTH_VERTEX_MEASURED : CLOTH_VERTEX_UNSEEN;
        for (guint k = 0; k < 3; k++)
          positions[3 * v + k] = fine ? (gfloat) t->position[k][v] : NAN;
        for (guint k = 0; k < 6; k++)
          covariance[6 * v + k] = fine ? (gfloat) t->covariance[k][v] : NAN;
        if (fine && !pass) {
          square += (t->covariance[0][v] + t->covariance[3][v] +
              t->covariance[5][v]) / 3.;
          n++;
        }
      }
      for (guint held = 0; held < 2; held++)
        sway (held, f / FPS, clamps + 3 * held);
      if (pass)
        cloth_take_writer_append (writer, f / FPS, positions, states,
            covariances ? covariance : NULL, clamps, &error);
      g_assert_no_error (error);
    }
  }
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
  return cloth_take_open (folder, &error);
}

typedef struct
{
  gchar *parent;
  ClothTake *take;
  ClothObservations *observations;      /* NULL: it has positions */
} Seen;

static void
see (Seen * s, Kind kind, const ClothModel * model, guint64 noise)
{
  static const guint cameras[N_KINDS] = { 2, 2, 1, 2, 3, 8 };
  const TestGapSheet sheet = { COLUMNS, ROWS, N_FRAMES, 0.3, 0.34, FPS };
  const TestGapFilming filming = { cameras[kind], NOISE_PX, hide_some };
  g_autoptr (ClothRig) rig = kind <= COVARIANCES ? pair_new () :
      test_gap_ring (cameras[kind], middle);
  g_autofree gdouble *truth = NULL;
  ClothTake *whole;
  gdouble times[N_FRAMES];

  s->parent = g_dir_make_tmp ("cloth-evidence-XXXXXX", NULL);
  whole = test_gap_record (&sheet, model, sway, s->parent, "take", 1);
  truth = test_gap_positions (whole);
  for (guint f = 0; f < N_FRAMES; f++)
    times[f] = f / FPS;
  s->observations = test_gap_film (rig, rig, truth, times, N_FRAMES, N,
      &filming, noise);
  if (kind <= COVARIANCES) {
    s->take = triangulate (whole, s->observations, kind == COVARIANCES,
        s->parent);
    g_clear_pointer (&s->observations, cloth_observations_free);
  } else {
    s->take = test_gap_forget_positions (whole, TRUE);
  }
  cloth_take_free (whole);
}

static void
seen_clear (Seen * s)
{
  cloth_take_free (s->take);
  cloth_observations_free (s->observations);
  test_gap_remove (s->parent);
  g_free (s->parent);
}

/* What came of all cases of a kind. */
typedef struct
{
  guint n, first, accepted, extra, numbers, held;
} Sum;

static void
diagnose (const Case * c, Kind kind, Sum * sum)
{
  g_autoptr (ClothModel) model = model_new (FALSE);
  g_autoptr (ClothModel) reality = model_new (TRUE);
  g_autoptr (ClothGapResult) result = NULL;
  g_autoptr (GError) error = NULL;
  ClothGapOptions options = { 0 };
  Seen take = { NULL }, baseline = { NULL };
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];

  see (&baseline, kind, reality, 100 + seed);
  for (guint k = 0; k < c->effect->n_parameters; k++)
    values[k] = k < c->n ? c->values[k] : c->effect->parameters[k].null_value;
  cloth_model_set_effect (reality, c->effect, values);
  see (&take, kind, reality, seed);
  options.baselines = &baseline.take;
  options.n_baselines = 1;
  options.observations = take.observations ? &take.observations : NULL;
  options.baseline_observations = baseline.observations ?
      &baseline.observations : NULL;
  result = cloth_gap_diagnose (&take.take, 1, model, &options, &error);
  g_assert_no_error (error);
  sum->n++;
  for (guint i = 0; i < result->effects->len; i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);
    const gboolean right = e->effect == c->effect;

    sum->first += i == 0 && right;
    sum->accepted += right && e->accepted;
    sum->extra += !right && e->accepted;
    for (guint k = 0; right && e->accepted && k < c->n; k++)
      if (c->values[k] != 0. && isfinite (e->sigmas[k])) {
        sum->numbers++;
        sum->held += fabs (e->values[k] - c->values[k]) < 1.96 * e->sigmas[k];
      }
  }
  seen_clear (&take);
  seen_clear (&baseline);
}

int
main (int argc, char **argv)
{
  const guint64 n_seeds = argc > 1 ? strtoull (argv[1], NULL, 10) : 3;

  printf ("%u effects, %" G_GUINT64_FORMAT " motions each\n",
      (guint) G_N_ELEMENTS (cases), n_seeds);
  for (Kind kind = 0; kind < N_KINDS; kind++) {
    const gint64 start = g_get_monotonic_time ();
    Sum sum = { 0 };

    for (seed = 1; seed <= n_seeds; seed++)
      for (guint i = 0; i < G_N_ELEMENTS (cases); i++)
        diagnose (&cases[i], kind, &sum);
    printf ("%-26s first %2u of %u, accepted %2u, extra effects %2u, 95%% "
        "intervals hold %2u of %2u, %.1f s each\n", names[kind], sum.first,
        sum.n, sum.accepted, sum.extra, sum.held, sum.numbers,
        (g_get_monotonic_time () - start) * 1e-6 / sum.n);
    fflush (stdout);
  }
  return 0;
}
