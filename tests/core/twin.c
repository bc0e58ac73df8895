/* Twins: a sheet that moves by a formula, simulated on other meshes and at other times, and what is
 * no simulation of the recorded scene.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/recording.h"
#include "tests/common/gaprecord.h"

#define WIDTH 0.3
#define HEIGHT 0.2
#define SIGMA 1e-3
#define FPS 50.
#define N_FRAMES 51

/* Where the place (u, v) of the flat cloth is. */
typedef void (*Motion) (gdouble u, gdouble v, gdouble t, gdouble p[3]);

/* How a take differs from the recording; zeros: not at all. */
typedef struct
{
  const gchar *name;
  guint columns, rows;          /* 0: as recorded */
  gboolean mesh;                /* written as OBJ, each second face as two triangles */
  gdouble fps, begin_s, end_s;  /* 0: as recorded */
  gdouble wider, shifted;       /* of the flat cloth, m; its uv, m */
  gdouble off[3], off_from_s;   /* clamps and cloth, m */
  guint held;                   /* instead of the second clamp's vertex */
  gboolean third;               /* one clamp more */
  gdouble until_s;              /* of the second clamp */
  gdouble gravity_x;
  gboolean ball, torn;          /* torn: diverges from 0.6 s on */
  gdouble nan_from_s;           /* all positions, NaN from then on */
  gboolean hole;                /* vertices 3 and 4 are NaN in frames 10 and 11 */
  gdouble scale;                /* of all lengths but uv */
  gdouble noise;
  gboolean twice;               /* two sheets with the same uv, BEHIND m apart */
} Sheet;

#define BEHIND 0.1

static gchar *parent;

/* Cubic in time and linear over the cloth: resampling is exact. */
static void
move_exactly (gdouble u, gdouble v, gdouble t, gdouble p[3])
{
  p[0] = 0.98 * u + 0.1 * t;
  p[1] = 0.2 * v + 0.3 * t - 0.4 * t * t + 0.2 * t * t * t;
  p[2] = -0.95 * v + 0.1 * u + 0.05 * t * t;
}

#define RATE (2. * G_PI * 2.)
#define SWING 0.02
#define WAVE (2. * G_PI / 0.3)
#define BULGE 0.005

/* Swings, and is bent into a wave. */
static void
move_bent (gdouble u, gdouble v, gdouble t, gdouble p[3])
{
  p[0] = u;
  p[1] = SWING * sin (RATE * t) + BULGE * sin (WAVE * u);
  p[2] = -v;
}

/* Too fast for 20 frames a second. */
static void
move_fast (gdouble u, gdouble v, gdouble t, gdouble p[3])
{
  p[0] = u;
  p[1] = 0.03 * sin (2. * G_PI * 6. * t);
  p[2] = -v;
}

/* The same, blown aside below the clamps. */
static void
move_aside (gdouble u, gdouble v, gdouble t, gdouble p[3])
{
  move_fast (u, v, t, p);
  p[1] += 0.5 * v;
}

/* A grid with every other face as two triangles. */
static ClothTopology *
new_mesh (guint columns, guint rows, gdouble width, gdouble shifted)
{
  g_autoptr (ClothTopology) grid = cloth_topology_new_grid (columns, rows,
      (gfloat) width, (gfloat) HEIGHT);
  ClothTopology *mesh = cloth_topology_new (grid->n_vertices,
      grid->n_faces + grid->n_faces / 2);
  guint n = 0;

  for (gsize i = 0; i < 2 * (gsize) grid->n_vertices; i++)
    mesh->uv[i] = grid->uv[i] + (gfloat) (i % 2 ? 0. : shifted);
  for (guint f = 0; f < grid->n_faces; f++) {
    const guint32 *face = grid->faces + 4 * (gsize) f;

    memcpy (mesh->faces + 4 * (gsize) n, face, 4 * sizeof *face);
    if (f % 2) {
      mesh->faces[4 * n + 3] = CLOTH_NO_VERTEX;
      mesh->faces[4 * n + 4] = face[0];
      mesh->faces[4 * n + 5] = face[2];
      mesh->faces[4 * n + 6] = face[3];
      mesh->faces[4 * n + 7] = CLOTH_NO_VERTEX;
      n++;
    }
    n++;
  }
  g_assert_cmpuint (n, ==, mesh->n_faces);
  return mesh;
}

/* Two panels whose uv are one upon the other, as programs for textures lay them. */
static ClothTopology *
new_panels (guint columns, guint rows)
{
  g_autoptr (ClothTopology) one = new_mesh (columns, rows, WIDTH, 0.);
  const guint n = one->n_vertices;
  ClothTopology *both = cloth_topology_new (2 * n, 2 * one->n_faces);

  for (guint k = 0; k < 2; k++) {
    memcpy (both->uv + k * 2 * n, one->uv, 2 * n * sizeof *one->uv);
    for (gsize i = 0; i < 4 * (gsize) one->n_faces; i++)
      both->faces[k * 4 * one->n_faces + i] =
          one->faces[i] == CLOTH_NO_VERTEX ? one->faces[i] :
          one->faces[i] + k * n;
  }
  return both;
}

static void
place_at (const Sheet * s, Motion motion, gdouble u, gdouble v, gdouble t,
    gfloat * to)
{
  gdouble p[3];

  motion (u, v, t, p);
  for (guint k = 0; k < 3; k++) {
    if (t >= s->off_from_s)
      p[k] += s->off[k];
    to[k] = (gfloat) ((s->scale > 0. ? s->scale : 1.) * p[k]);
  }
}

static ClothTake *
write_take (const Sheet * s, Motion motion)
{
  const guint columns = s->columns ? s->columns : 7;
  const guint rows = s->rows ? s->rows : 5;
  const gdouble fps = s->fps > 0. ? s->fps : FPS, width = WIDTH + s->wider;
  const gdouble end_s = s->end_s > 0. ? s->end_s : (N_FRAMES - 1) / FPS;
  const guint n = columns * rows * (s->twice ? 2 : 1);
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (s->name);
  g_autoptr (ClothTopology) topology =
      s->twice ? new_panels (columns, rows) : s->mesh ?
      new_mesh (columns, rows, width, s->shifted) :
      cloth_topology_new_grid (columns, rows, (gfloat) width, (gfloat) HEIGHT);
  g_autofree gchar *folder = g_build_filename (parent, s->name, NULL);
  g_autofree gfloat *positions = g_new (gfloat, 3 * n);
  g_autofree guint8 *states = g_malloc (n);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeWriter) writer = NULL;
  const guint vertices[] = { 0, s->held ? s->held : columns - 1, n - 1 };
  const guint n_held = s->third ? 3 : 2;
  ClothTake *take;

  for (guint i = 0; i < n_held; i++) {
    ClothHeld held = { vertices[i], -INFINITY, INFINITY };

    if (i == 1 && s->until_s > 0.)
      held.until_s = s->until_s;
    g_array_append_val (info->held, held);
  }
  if (s->ball) {
    const ClothObstacle ball = {.kind = CLOTH_OBSTACLE_SPHERE,
      .point = {0., 1., 0.},.radius_m = 0.1,.friction = NAN
    };

    g_array_append_val (info->obstacles, ball);
  }
  if (s->mesh || s->twice) {
    info->mesh = g_strdup ("cloth.obj");
  } else {
    info->columns = columns;
    info->rows = rows;
    info->width_m = width;
    info->height_m = HEIGHT;
  }
  info->gravity[0] = s->gravity_x;
  info->noise_sigma_m = s->noise;
  writer = cloth_take_writer_new (folder, info, topology, &error);
  g_assert_no_error (error);
  memset (states, CLOTH_VERTEX_MEASURED, n);
  for (guint f = 0; s->begin_s + f / fps <= end_s + 1e-9; f++) {
    const gdouble t = s->begin_s + f / fps;
    gfloat clamps[9];

    for (guint v = 0; v < n; v++)
      place_at (s, motion, topology->uv[2 * v] - (s->mesh ? s->shifted : 0.),
          topology->uv[2 * v + 1], t, positions + 3 * v);
    for (guint v = n / 2; v < n && s->twice; v++)
      positions[3 * v + 1] += (gfloat) BEHIND;
    for (guint i = 0; i < n_held; i++)
      place_at (s, motion, topology->uv[2 * vertices[i]],
          topology->uv[2 * vertices[i] + 1], t, clamps + 3 * i);
    if (s->third && s->twice)
      clamps[7] += (gfloat) BEHIND;
    for (guint i = 0; i < 3 * n && s->torn && t > 0.59; i++)
      positions[i] *= i % 2 ? 1e4f : -1e4f;
    memset (states, CLOTH_VERTEX_MEASURED, n);
    for (guint v = 0; v < n; v++)
      if ((s->nan_from_s > 0. && t >= s->nan_from_s)
          || (s->hole && (f == 10 || f == 11) && (v == 3 || v == 4))) {
        states[v] = CLOTH_VERTEX_UNSEEN;
        for (guint k = 0; k < 3; k++)
          positions[3 * v + k] = NAN;
      }
    cloth_take_writer_append (writer, t, positions, states, NULL, clamps,
        &error);
    g_assert_no_error (error);
  }
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
  take = cloth_take_open (folder, &error);
  g_assert_no_error (error);
  return take;
}

static ClothRecording *
record (const Sheet * s, Motion motion)
{
  g_autoptr (ClothTake) take = write_take (s, motion);
  g_autoptr (GError) error = NULL;
  ClothRecording *r = cloth_recording_new (take, &error);

  g_assert_no_error (error);
  return r;
}

static const Sheet recorded = {.name = "recorded",.noise = SIGMA };

/* The largest distance of a twin from the formula at its recording's vertices and times, where it
 * is seen. */
static gdouble
find_worst (const ClothRecording * twin, Motion motion)
{
  const gfloat *uv = twin->scene->topology->uv;
  gdouble worst = 0.;

  for (guint f = 0; f < twin->n_frames; f++)
    for (guint v = 0; v < twin->n; v++) {
      gsize at = (gsize) f * twin->n + v;
      gdouble p[3];

      if (twin->seen[at] == 0.)
        continue;
      motion (uv[2 * v], uv[2 * v + 1], twin->times[f], p);
      for (guint k = 0; k < 3; k++)
        worst = fmax (worst, fabs (twin->y[3 * at + k] - p[k]));
    }
  return worst;
}

/* Of motions that are cubic in time and linear over the cloth nothing is lost, on any mesh and at
 * any times. */
static void
test_exact (void)
{
  static const Sheet simulated[] = {
    {.name = "same"},
    {.name = "finer",.columns = 12,.rows = 9},
    {.name = "coarser",.columns = 4,.rows = 3},
    {.name = "faces",.mesh = TRUE,.columns = 6,.rows = 8},
    {.name = "seldom",.fps = 13.,.end_s = 1.1},
    {.name = "often",.fps = 241.,.end_s = 1.1},
    {.name = "all",.mesh = TRUE,.columns = 9,.rows = 4,.fps = 31.,.end_s = 1.2},
  };
  g_autoptr (ClothRecording) r = record (&recorded, move_exactly);

  for (guint i = 0; i < G_N_ELEMENTS (simulated); i++) {
    g_autoptr (ClothTake) take = write_take (&simulated[i], move_exactly);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRecording) twin =
        cloth_recording_new_twin (take, r, &error);

    g_assert_no_error (error);
    g_assert_cmpuint (twin->n, ==, r->n);
    g_assert_cmpuint (twin->n_frames, ==, r->n_frames);
    g_assert_cmpmem (twin->times, r->n_frames * sizeof (gdouble), r->times,
        r->n_frames * sizeof (gdouble));
    g_assert_cmpfloat (find_worst (twin, move_exactly), <, 1e-6);
    g_assert_cmpfloat (twin->sigma, ==, r->sigma);
    /* its velocity at (0, 0), where x′ = 0.1 and z′ = 0.1 t */
    g_assert_cmpfloat_with_epsilon (twin->velocity[3 * (20 * r->n)], 0.1, 1e-4);
    g_assert_cmpfloat_with_epsilon (twin->velocity[3 * (20 * r->n) + 2],
        0.1 * r->times[20], 1e-4);
  }
}

/* What cubics and triangles lose is no more than their errors' bounds: 3/128 A ω⁴ h⁴ midway
 * between frames, and A k² d²/8 midway between vertices. */
static void
test_bent (void)
{
  static const Sheet often = {.name = "often",.fps = 33.,.end_s = 1.1 };
  static const Sheet bent = {.name = "bent",.columns = 31,.rows = 3 };
  g_autoptr (ClothRecording) r = record (&recorded, move_bent);
  g_autoptr (ClothTake) one = write_take (&often, move_bent);
  g_autoptr (ClothTake) two = write_take (&bent, move_bent);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) in_time = cloth_recording_new_twin (one, r,
      &error);
  g_autoptr (ClothRecording) in_space = cloth_recording_new_twin (two, r,
      &error);
  const gdouble time_bound = 3. / 128. * SWING * pow (RATE / 33., 4.);
  gdouble worst;

  g_assert_no_error (error);
  worst = find_worst (in_time, move_bent);
  g_test_message ("%.2g m of %.2g m", worst, time_bound);
  g_assert_cmpfloat (worst, <, 1.05 * time_bound);
  g_assert_cmpfloat (worst, >, 0.5 * time_bound);
  /* every vertex of 7 columns is one of 31, those of rows 1 and 3 lie midway between two alike */
  g_assert_cmpfloat (find_worst (in_space, move_bent), <, 1e-6);
}

/* What one of them did not see counts in neither, and both are bridged alike. */
static void
test_masked (void)
{
  static const Sheet hidden = {.name = "recorded",.noise = SIGMA,.hole = TRUE };
  static const Sheet whole = {.name = "whole" };
  static const Sheet holed = {.name = "holed",.hole = TRUE,.noise = 3e-3 };
  g_autoptr (ClothRecording) seen = record (&recorded, move_bent);
  g_autoptr (ClothRecording) masked = record (&hidden, move_bent);
  g_autoptr (ClothTake) one = write_take (&whole, move_bent);
  g_autoptr (ClothTake) two = write_take (&holed, move_bent);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) a = cloth_recording_new_twin (one, masked, &error);
  g_autoptr (ClothRecording) b = cloth_recording_new_twin (two, seen, &error);
  const gsize all = 3 * (gsize) seen->n * seen->n_frames;

  g_assert_no_error (error);
  g_assert_cmpfloat (a->seen[10 * seen->n + 3], ==, 0.);
  g_assert_cmpfloat (a->seen[12 * seen->n + 3], ==, 1.);
  g_assert_cmpmem (a->seen, all / 3 * sizeof (gdouble), b->seen,
      all / 3 * sizeof (gdouble));
  for (gsize i = 0; i < all; i++) {
    g_assert_cmpfloat (a->y[i], ==, masked->y[i]);
    g_assert_cmpfloat (a->y[i], ==, b->y[i]);
  }
  g_assert_cmpfloat (a->sigma, ==, SIGMA);
  g_assert_cmpfloat_with_epsilon (b->sigma, sqrt (1e-6 + 9e-6), 1e-9);
}

/* Clamps that differ by less than noise hides are the same; those of another mesh may hold what is
 * next to the place; frames before and after are cut. */
static void
test_accepted (void)
{
  static const Sheet simulated[] = {
    {.name = "near",.off = {0., SIGMA, 0.},.off_from_s = 0.5},
    {.name = "beyond",.end_s = 3.},
    {.name = "before",.begin_s = -0.5,.fps = 100.},
    {.name = "half a frame short",.fps = 100.,.end_s = 0.995},
    /* whatever happens between its frames, if they are the recording's */
    {.name = "alike",.fps = 50.},
  };
  g_autoptr (ClothRecording) r = record (&recorded, move_bent);

  for (guint i = 0; i < G_N_ELEMENTS (simulated); i++) {
    g_autoptr (ClothTake) take = write_take (&simulated[i], move_bent);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRecording) twin =
        cloth_recording_new_twin (take, r, &error);

    g_assert_no_error (error);
    g_assert_cmpfloat (find_worst (twin, move_bent), <, 1.01 * SIGMA);
  }
}

/* What a twin's own frames leave unknown counts as noise where the gap is much larger, else it is refused. */
static void
test_seldom (void)
{
  static const Sheet simulated = {.name = "rarely",.fps = 30.,.end_s = 1.1 };
  g_autoptr (ClothRecording) far = record (&recorded, move_aside);
  g_autoptr (ClothRecording) near = record (&recorded, move_fast);
  g_autoptr (ClothTake) take = write_take (&simulated, move_fast);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) twin = cloth_recording_new_twin (take, far,
      &error);

  g_assert_no_error (error);
  /* a cubic midway between frames h apart is off by 3/128 h⁴ of the fourth derivative, at most */
  g_assert_cmpfloat (find_worst (twin, move_fast), <,
      3. / 128. * pow (2. * G_PI * 6. / 30., 4.) * 0.03 + SIGMA);
  g_assert_cmpfloat (twin->between, >, SIGMA);
  g_assert_cmpfloat (twin->between, <, 3. * SIGMA);
  g_assert_cmpfloat_with_epsilon (twin->sigma, hypot (SIGMA, twin->between),
      1e-9);
  g_assert_null (cloth_recording_new_twin (take, near, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
}

typedef struct
{
  Sheet sheet;
  const gchar *says[3];
  gboolean fast;
} Refused;

static const Refused refused[] = {
  {{.name = "clamp",.off = {0., 0.03, 0.},.off_from_s = 0.5},
      {"up to 0.03 m", "first at 0.5 s", "clamps.npy"}},
  {{.name = "elsewhere",.off = {0., 1., 0.}}, {"up to 1 m",
          "first at 0 s", "clamps.npy of the recording"}},
  {{.name = "held",.held = 5}, {"vertex 6", "holds nothing there", "clamp"}},
  {{.name = "third",.third = TRUE}, {"vertex 34", "holds nothing there",
          "clamp"}},
  {{.name = "let go",.until_s = 0.4}, {"until 0.4 s", "let go as recorded",
          "vertex 6"}},
  {{.name = "wide",.wider = 0.05}, {"0.35×0.2 m", "0.3×0.2 m", "metres"}},
  {{.name = "shifted",.mesh = TRUE,.shifted = 0.02}, {"no cloth at (0, 0) m",
          "vertex 0", "same corner"}},
  {{.name = "short",.end_s = 0.9}, {"ends at 0.9 s", "0.1 s before",
          "simulate all"}},
  {{.name = "late",.begin_s = 0.2}, {"begins at 0.2 s", "0.2 s after",
          "first frame"}},
  {{.name = "few",.fps = 25.,.end_s =
              0.04}, {"2 frames", "51", "one for each"}},
  {{.name = "seldom",.fps = 17.,.end_s = 1.1}, {"between its frames",
          "frames a second", "0.001 m"}, TRUE},
  {{.name = "nan",.nan_from_s = 0.5}, {"frame 25", "0.5 s", "diverge"}},
  {{.name = "torn",.torn = TRUE}, {"diverges", "frame 30", "0.6 s"}},
  {{.name = "gravity",.gravity_x = 1.}, {"gravity", "1, 0, -9.81",
          "0, 0, -9.81"}},
  {{.name = "ball",.ball = TRUE}, {"has 1", "recording 0", "scene"}},
  {{.name = "millimetres",.scale = 1000.}, {"millimetres", "metres",
          "positions.npy"}},
};

static void
test_refused (gconstpointer data)
{
  const Refused *c = data;
  const Motion motion = c->fast ? move_fast : move_bent;
  g_autoptr (ClothRecording) r = record (&recorded, motion);
  g_autoptr (ClothTake) take = write_take (&c->sheet, motion);
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_recording_new_twin (take, r, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
  g_test_message ("%s", error->message);
  for (guint i = 0; i < G_N_ELEMENTS (c->says); i++)
    if (!strstr (error->message, c->says[i]))
      g_error ("“%s” does not say “%s”", error->message, c->says[i]);
}

/* Where a simulation says where the recording's unseen places are, those of the twin are where it has them; only
 * where it has none they are bridged: move_exactly is no straight line. */
static void
test_simulated (void)
{
  static const Sheet whole = {.name = "whole" }, hole = {.name =
        "hole",.hole = TRUE
  };
  g_autoptr (ClothTake) take = write_take (&whole, move_exactly);
  g_autoptr (ClothTake) holed = write_take (&hole, move_exactly);
  g_autoptr (ClothRecording) r = record (&recorded, move_exactly);

  for (guint f = 5; f < 45; f++)
    r->seen[f * r->n + 3] = 0.;
  for (guint k = 0; k < 3; k++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRecording) twin = NULL;
    gdouble worst = 0.;

    r->simulated = k > 0;
    twin = cloth_recording_new_twin (k < 2 ? take : holed, r, &error);
    g_assert_no_error (error);
    for (guint f = 5; f < 45; f++) {
      const gfloat *uv = twin->scene->topology->uv + 2 * 3;
      gdouble p[3];

      move_exactly (uv[0], uv[1], twin->times[f], p);
      for (guint c = 0; c < 3; c++) {
        const gdouble off = fabs (twin->y[3 * (f * twin->n + 3) + c] - p[c]);

        worst = fmax (worst, off);
        g_assert_true (isfinite (off));
      }
      g_assert_cmpfloat (twin->seen[f * twin->n + 3], ==, 0.);
    }
    g_test_message ("%u: %g m", k, worst);
    if (k == 0)
      g_assert_cmpfloat (worst, >, 5e-3);
    else if (k == 1)
      g_assert_cmpfloat (worst, <, 1e-6);
    else
      g_assert_cmpfloat (worst, <, 1e-3);
  }
}

/* Panels that lie upon each other on the flat cloth are told apart by the numbers of their vertices, and by nothing
 * on another mesh. */
static void
test_panels (void)
{
  static const Sheet both = {.name = "both",.noise = SIGMA,.twice = TRUE,
    .third = TRUE
  };
  static const Sheet finer = {.name = "finer",.columns = 12,.twice = TRUE,
    .third = TRUE
  };
  g_autoptr (ClothRecording) r = record (&both, move_bent);
  g_autoptr (ClothTake) same = write_take (&both, move_bent);
  g_autoptr (ClothTake) other = write_take (&finer, move_bent);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRecording) twin = cloth_recording_new_twin (same, r, &error);

  g_assert_no_error (error);
  g_assert_cmpuint (twin->n, ==, 70);
  for (gsize i = 0; i < 3 * (gsize) twin->n * twin->n_frames; i++)
    g_assert_cmpfloat_with_epsilon (twin->y[i], r->y[i], 1e-6);
  g_assert_null (cloth_recording_new_twin (other, r, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
  g_assert_nonnull (strstr (error->message,
          "lay its panels beside each other"));
}

/* A place that outlines alone tell of is told of no less because several simulations are held against it. */
static void
test_alike (void)
{
  gdouble recorded[6] = { 1., 1., 0., 0., 0.5, 0.5 };
  gdouble before[6] = { 1., 0., 1., 0., 0.5, 1. };
  gdouble after[6] = { 1., 1., 1., 1., 0.5, 0.25 };
  static const gdouble expected[6] = { 1., 0., 0., 0., 0.5, 0.25 };
  ClothRecording r = {.n = 3,.n_frames = 2,.seen = recorded };
  ClothRecording twin = {.n = 3,.n_frames = 2,.seen = before };
  ClothRecording other = {.n = 3,.n_frames = 2,.seen = after };

  cloth_recording_see_alike (&r, &twin);
  cloth_recording_see_alike (&r, &other);
  cloth_recording_see_alike (&r, &twin);
  for (guint i = 0; i < 6; i++) {
    g_assert_cmpfloat (recorded[i], ==, expected[i]);
    g_assert_cmpfloat (before[i], ==, expected[i]);
    g_assert_cmpfloat (after[i], ==, expected[i]);
  }
}

int
main (int argc, char **argv)
{
  int status;

  g_test_init (&argc, &argv, NULL);
  parent = g_dir_make_tmp ("cloth-twin-XXXXXX", NULL);
  g_test_add_func ("/twin/exact", test_exact);
  g_test_add_func ("/twin/bent", test_bent);
  g_test_add_func ("/twin/masked", test_masked);
  g_test_add_func ("/twin/simulated", test_simulated);
  g_test_add_func ("/twin/panels", test_panels);
  g_test_add_func ("/twin/alike", test_alike);
  g_test_add_func ("/twin/accepted", test_accepted);
  g_test_add_func ("/twin/seldom", test_seldom);
  for (guint i = 0; i < G_N_ELEMENTS (refused); i++) {
    g_autofree gchar *path = g_strdup_printf ("/twin/refused/%s",
        refused[i].sheet.name);

    g_test_add_data_func (path, &refused[i], test_refused);
  }
  status = g_test_run ();
  test_gap_remove (parent);
  g_free (parent);
  return status;
}
