/* Holes filled, against closed forms and against recordings by other simulators.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/fill/fill.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"
#include "tests/common/npyfloats.h"

#define COLUMNS 17
#define ROWS 13
#define N (COLUMNS * ROWS)
#define STEP 0.02

/* What shapes and motions the sheets have: a place for u, v and the time. */
typedef void (*Shape) (gdouble u, gdouble v, gdouble t, gfloat place[3]);

static void
flat_shape (gdouble u, gdouble v, gdouble t, gfloat place[3])
{
  /* stretched and sheared: no second difference sees it */
  place[0] = (gfloat) (1 + 1.1 * u + 0.2 * v);
  place[1] = (gfloat) (2 - 0.3 * u + v);
  place[2] = (gfloat) (0.5 * u - 0.7 * v);
}

static void
cubic_shape (gdouble u, gdouble v, gdouble t, gfloat place[3])
{
  /* biharmonic: the plate through it is itself */
  place[0] = (gfloat) u;
  place[1] = (gfloat) v;
  place[2] = (gfloat) (20 * u * u * v - 9 * v * v * v + 3 * u * v);
}

static void
wave_shape (gdouble u, gdouble v, gdouble t, gfloat place[3])
{
  place[0] = (gfloat) u;
  place[1] = (gfloat) (0.02 * sin (40 * u + 5 * v));
  place[2] = (gfloat) - v;
}

/* The wave carried around as a rigid body. */
static void
turned_shape (gdouble u, gdouble v, gdouble t, gfloat place[3])
{
  gfloat p[3];
  gdouble c = cos (5 * t), s = sin (5 * t);

  wave_shape (u, v, 0, p);
  place[0] = (gfloat) (c * p[0] - s * p[1] + t);
  place[1] = (gfloat) (s * p[0] + c * p[1]);
  place[2] = (gfloat) (p[2] - 0.4 * t);
}

static void
flying_shape (gdouble u, gdouble v, gdouble t, gfloat place[3])
{
  wave_shape (u, v, 0, place);
  place[0] += (gfloat) (0.8 * t);
  place[2] -= (gfloat) (0.5 * t);
}

/* A flat sheet whose middle is a fold that takes up length: 25 mm high. */
static void
folded_shape (gdouble u, gdouble v, gdouble t, gfloat place[3])
{
  gdouble s = (u - 0.16) / 0.05, inside = fabs (s) < 1 ? s : s < 0 ? -1 : 1;

  /* the cloth goes up and down by as much as it is drawn together */
  place[0] = (gfloat) (u - 0.02 * inside);
  place[1] = (gfloat) (0.0125 * (1 + cos (G_PI * inside)));
  place[2] = (gfloat) - v;
}

typedef struct
{
  ClothTopology *topology;
  ClothFill *fill;
  gfloat *positions, *truth;
  guint8 *states;
  gboolean *hidden;
  guint frames;
} Sheet;

static const ClothFillParameters exact = { CLOTH_FILL_PLATE, 1e-6, 1, 0.2, 0 };

static void
sheet_init (Sheet * sheet, ClothTopology * topology,
    const ClothFillParameters * parameters)
{
  guint n = topology->n_vertices;

  sheet->topology = topology;
  sheet->fill = cloth_fill_new (topology, NULL, parameters);
  sheet->positions = g_new (gfloat, 3 * n);
  sheet->truth = g_new (gfloat, 3 * n);
  sheet->states = g_new (guint8, n);
  sheet->hidden = g_new0 (gboolean, n);
  sheet->frames = 0;
}

static void
sheet_clear (Sheet * sheet)
{
  cloth_fill_free (sheet->fill);
  cloth_topology_free (sheet->topology);
  g_free (sheet->positions);
  g_free (sheet->truth);
  g_free (sheet->states);
  g_free (sheet->hidden);
}

static void
sheet_run (Sheet * sheet, Shape shape, ClothMeshFrame * out,
    ClothFillCounts * counts)
{
  ClothMeshFrame in = { sheet->positions, sheet->states, NULL };

  for (guint v = 0; v < sheet->topology->n_vertices; v++) {
    shape (sheet->topology->uv[2 * v], sheet->topology->uv[2 * v + 1],
        sheet->frames * STEP, sheet->truth + 3 * v);
    for (guint c = 0; c < 3; c++)
      sheet->positions[3 * v + c] = sheet->hidden[v] ? NAN
          : sheet->truth[3 * v + c];
    sheet->states[v] = sheet->hidden[v] ? CLOTH_VERTEX_UNSEEN
        : CLOTH_VERTEX_MEASURED;
  }
  cloth_fill_run (sheet->fill, sheet->frames * STEP, &in, out, counts);
  sheet->frames++;
}

/* The greatest error of a vertex, metres; every vertex has @state where hidden. */
static gdouble
sheet_error (const Sheet * sheet, const ClothMeshFrame * out,
    ClothVertexState state)
{
  gdouble most = 0;

  for (guint v = 0; v < sheet->topology->n_vertices; v++) {
    g_assert_cmpuint (out->states[v], ==, sheet->hidden[v] ? state
        : CLOTH_VERTEX_MEASURED);
    for (guint c = 0; c < 3; c++)
      most = fmax (most, fabs ((gdouble) out->positions[3 * v + c]
              - sheet->truth[3 * v + c]));
  }
  return most;
}

static void
hide (Sheet * sheet, guint column, guint row, guint width, guint height)
{
  for (guint j = row; j < row + height; j++)
    for (guint i = column; i < column + width; i++)
      sheet->hidden[j * COLUMNS + i] = TRUE;
}

static void
test_flat (void)
{
  Sheet sheet;
  ClothMeshFrame out;
  ClothFillCounts counts;

  /* cells that are no squares; holes within, at a side, at a corner */
  sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.4f, 0.5f),
      &exact);
  hide (&sheet, 3, 3, 4, 5);
  hide (&sheet, 10, 0, 3, 2);
  hide (&sheet, 15, 11, 2, 2);
  hide (&sheet, 0, 6, 1, 1);
  sheet_run (&sheet, flat_shape, &out, &counts);
  g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_FILLED), <, 2e-6);
  g_assert_cmpuint (counts.holes, ==, 4);
  g_assert_cmpuint (counts.filled, ==, 31);
  g_assert_cmpuint (counts.unseen + counts.predicted, ==, 0);
  sheet_clear (&sheet);
}

/* A grid with moved inner vertices, its quads cut into triangles here and there. */
static ClothTopology *
irregular (gboolean quads)
{
  g_autoptr (ClothTopology) grid =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.4f, 0.4f);
  ClothTopology *cut = cloth_topology_new (N, 2 * grid->n_faces);
  ClothRandom random;
  guint n = 0;

  cloth_random_init (&random, 2);
  memcpy (cut->uv, grid->uv, 2 * N * sizeof *cut->uv);
  for (guint i = 0; i < 2 * N; i++)
    cut->uv[i] += (gfloat) (0.005 * (cloth_random_uniform (&random) - 0.5));
  for (guint f = 0; f < grid->n_faces; f++) {
    const guint32 *q = &grid->faces[4 * f];

    if (quads && f % 3) {
      memcpy (&cut->faces[4 * n++], q, 4 * sizeof *q);
    } else {
      const guint32 two[8] = { q[0], q[1], q[2], CLOTH_NO_VERTEX,
        q[0], q[2], q[3], CLOTH_NO_VERTEX
      };

      memcpy (&cut->faces[4 * n], two, sizeof two);
      n += 2;
    }
  }
  cut->n_faces = n;
  return cut;
}

static void
test_triangles (void)
{
  Sheet sheet;
  ClothMeshFrame out;

  /* A hinge between triangles of any shape is exact on the plane. */
  sheet_init (&sheet, irregular (FALSE), &exact);
  hide (&sheet, 3, 3, 4, 5);
  hide (&sheet, 10, 0, 3, 2);
  hide (&sheet, 15, 11, 2, 2);
  sheet_run (&sheet, flat_shape, &out, NULL);
  g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_FILLED), <, 1e-5);
  sheet_clear (&sheet);
  /* Quads that aren't parallelograms are exact but for their shape: 2 mm of 25. */
  sheet_init (&sheet, irregular (TRUE), &exact);
  hide (&sheet, 3, 3, 4, 5);
  sheet_run (&sheet, flat_shape, &out, NULL);
  g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_FILLED), <, 4e-3);
  sheet_clear (&sheet);
}

static void
test_biharmonic (void)
{
  static const ClothFillMethod methods[] =
      { CLOTH_FILL_PLATE, CLOTH_FILL_BILAPLACIAN };

  for (guint m = 0; m < G_N_ELEMENTS (methods); m++) {
    ClothFillParameters parameters = exact;
    Sheet sheet;
    ClothMeshFrame out;

    parameters.method = methods[m];
    sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.4f, 0.3f),
        &parameters);
    hide (&sheet, 4, 4, 6, 5);
    hide (&sheet, 12, 3, 2, 2);
    sheet_run (&sheet, cubic_shape, &out, NULL);
    g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_FILLED), <,
        5e-6);
    /* and no other surface is: where it isn't biharmonic both differ from it */
    sheet_run (&sheet, wave_shape, &out, NULL);
    g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_FILLED), >,
        1e-3);
    sheet_clear (&sheet);
  }
}

/* A hole keeps the shape that it had, turned and moved as its surroundings are. */
static void
test_carried (void)
{
  Sheet sheet;
  ClothMeshFrame out;
  ClothFillCounts counts;

  sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
      &exact);
  for (guint frame = 0; frame < 30; frame++) {
    if (frame == 5)
      hide (&sheet, 5, 4, 6, 5);
    sheet_run (&sheet, turned_shape, &out, &counts);
    g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_FILLED), <,
        1e-4);
    g_assert_cmpuint (counts.factored, ==, frame == 5);
    g_assert_cmpuint (counts.holes, ==, frame >= 5);
  }
  /* without the past it can't know */
  cloth_fill_reset (sheet.fill);
  sheet_run (&sheet, turned_shape, &out, NULL);
  g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_FILLED), >, 0.005);
  sheet_clear (&sheet);
}

/* Nothing seen at all: predicted for a while, then unseen, and back at once. */
static void
test_nothing_seen (void)
{
  Sheet sheet;
  ClothMeshFrame out;
  ClothFillCounts counts;
  guint frame;

  sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
      &exact);
  hide (&sheet, 0, 0, COLUMNS, ROWS);
  sheet_run (&sheet, flying_shape, &out, &counts);
  g_assert_cmpuint (counts.unseen, ==, N);
  memset (sheet.hidden, 0, N * sizeof *sheet.hidden);
  for (frame = 0; frame < 32; frame++)
    sheet_run (&sheet, flying_shape, &out, NULL);
  hide (&sheet, 0, 0, COLUMNS, ROWS);
  /* 0.2 s are ten frames; steady motion goes on */
  for (frame = 0; frame < 10; frame++) {
    sheet_run (&sheet, flying_shape, &out, &counts);
    g_assert_cmpfloat (sheet_error (&sheet, &out, CLOTH_VERTEX_PREDICTED), <,
        1e-5);
    g_assert_cmpfloat (out.covariances[0], >, 0);
  }
  for (; frame < 50; frame++) {
    sheet_run (&sheet, flying_shape, &out, &counts);
    g_assert_cmpuint (counts.unseen, ==, N);
    for (guint i = 0; i < 3 * N; i++)
      g_assert_true (isnan (out.positions[i]));
    for (guint i = 0; i < 6 * N; i++)
      g_assert_true (isnan (out.covariances[i]));
  }
  memset (sheet.hidden, 0, N * sizeof *sheet.hidden);
  hide (&sheet, 5, 4, 2, 2);
  sheet_run (&sheet, flying_shape, &out, &counts);
  g_assert_cmpuint (counts.filled, ==, 4);
  sheet_clear (&sheet);
}

/* A ring that doesn't hold: a row of vertices leaves the sheet free to turn about it. */
static void
test_not_held (void)
{
  Sheet sheet;
  ClothMeshFrame out;
  ClothFillCounts counts;

  sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
      &exact);
  hide (&sheet, 0, 1, COLUMNS, ROWS - 1);
  sheet_run (&sheet, wave_shape, &out, &counts);
  g_assert_cmpuint (counts.unseen, ==, N - COLUMNS);
  g_assert_cmpuint (counts.filled, ==, 0);
  sheet_clear (&sheet);
  /* vertices that no face has, and faces that are no faces */
  {
    ClothTopology *topology = cloth_topology_new (6, 2);
    static const guint32 faces[8] = { 0, 1, 1, 0, 2, 3, 2, CLOTH_NO_VERTEX };

    memcpy (topology->faces, faces, sizeof faces);
    sheet_init (&sheet, topology, &exact);
    sheet.hidden[1] = sheet.hidden[2] = sheet.hidden[5] = TRUE;
    sheet_run (&sheet, wave_shape, &out, &counts);
    g_assert_cmpuint (counts.unseen, ==, 3);
    sheet_clear (&sheet);
  }
}

static void
test_uncertain (void)
{
  ClothFillParameters parameters = exact;
  Sheet sheet;
  ClothMeshFrame out;
  ClothFillCounts counts;

  /* The same hole in a waving sheet is filled when 1 m of σ is allowed, not with 1 mm. */
  for (guint strict = 0; strict < 2; strict++) {
    parameters.max_sigma_m = strict ? 1e-3 : 1;
    sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
        &parameters);
    hide (&sheet, 4, 3, 8, 6);
    sheet_run (&sheet, wave_shape, &out, &counts);
    g_assert_cmpuint (counts.filled + counts.unseen, ==, 48);
    if (strict)
      g_assert_cmpuint (counts.unseen, >, 40);
    else
      g_assert_cmpuint (counts.unseen, ==, 0);
    sheet_clear (&sheet);
  }
}

/* A fold in the hole: nothing around is bent, but length is lacking. */
static void
test_hidden_fold (void)
{
  Sheet sheet;
  ClothMeshFrame out;
  guint middle = 6 * COLUMNS + 8;
  gdouble error, sigma[2];

  for (guint fold = 0; fold < 2; fold++) {
    sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
        &exact);
    hide (&sheet, 5, 3, 7, 7);
    sheet_run (&sheet, fold ? folded_shape : flat_shape, &out, NULL);
    sigma[fold] = sqrt ((out.covariances[6 * middle]
            + out.covariances[6 * middle + 3]
            + out.covariances[6 * middle + 5]) / 3);
    error = fabs ((gdouble) out.positions[3 * middle + 1]
        - sheet.truth[3 * middle + 1]);
    sheet_clear (&sheet);
  }
  g_test_message ("error %.1f mm, sigma %.1f mm; flat %.3f mm", 1000 * error,
      1000 * sigma[1], 1000 * sigma[0]);
  g_assert_cmpfloat (error, >, 0.005);
  g_assert_cmpfloat (sigma[1], >, error / 3);
  g_assert_cmpfloat (sigma[1], <, 3 * error);
  g_assert_cmpfloat (sigma[0], <, 1e-4);
}

/* What came as filled or predicted was not measured, whatever its position. */
static void
test_states (void)
{
  Sheet sheet;
  ClothMeshFrame in, out;

  sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
      &exact);
  sheet_run (&sheet, flat_shape, &out, NULL);
  in = (ClothMeshFrame) {
  sheet.positions, sheet.states, NULL};
  sheet.states[40] = CLOTH_VERTEX_FILLED;
  sheet.states[90] = CLOTH_VERTEX_PREDICTED;
  sheet.states[100] = CLOTH_VERTEX_TWO_VIEWS;
  sheet.positions[3 * 40] += 1;
  sheet.positions[3 * 90] += 1;
  cloth_fill_run (sheet.fill, 1, &in, &out, NULL);
  g_assert_cmpuint (out.states[40], ==, CLOTH_VERTEX_FILLED);
  g_assert_cmpuint (out.states[90], ==, CLOTH_VERTEX_FILLED);
  g_assert_cmpuint (out.states[100], ==, CLOTH_VERTEX_TWO_VIEWS);
  g_assert_cmpfloat_with_epsilon (out.positions[3 * 40],
      sheet.truth[3 * 40], 1e-5);
  g_assert_cmpfloat_with_epsilon (out.positions[3 * 90],
      sheet.truth[3 * 90], 1e-5);
  sheet_clear (&sheet);
}

static void
test_outliers (void)
{
  ClothFillParameters parameters = exact;
  Sheet sheet;
  ClothMeshFrame out;
  ClothFillCounts counts;
  ClothMeshFrame in;

  parameters.noise_m = 0.0004;
  parameters.outlier = CLOTH_FILL_OUTLIER;
  sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
      &parameters);
  for (guint frame = 0; frame < 5; frame++) {
    sheet_run (&sheet, turned_shape, &out, &counts);
    g_assert_cmpuint (counts.outliers, ==, 0);
  }
  /* 30 mm, far more than the sheet moves from frame to frame */
  in = (ClothMeshFrame) {
  sheet.positions, sheet.states, NULL};
  sheet.positions[3 * (5 * COLUMNS + 8) + 1] += 0.03f;
  sheet.positions[3 * (9 * COLUMNS + 3) + 2] -= 0.03f;
  sheet.positions[3 * (6 * COLUMNS)] += 0.03f;
  cloth_fill_run (sheet.fill, 5 * STEP, &in, &out, &counts);
  g_assert_cmpuint (counts.outliers, ==, 3);
  g_assert_cmpuint (out.states[5 * COLUMNS + 8], ==, CLOTH_VERTEX_FILLED);
  g_assert_cmpuint (out.states[9 * COLUMNS + 3], ==, CLOTH_VERTEX_FILLED);
  g_assert_cmpuint (out.states[6 * COLUMNS], ==, CLOTH_VERTEX_FILLED);
  for (guint c = 0; c < 3; c++)
    g_assert_cmpfloat_with_epsilon (out.positions[3 * (5 * COLUMNS + 8) + c],
        sheet.truth[3 * (5 * COLUMNS + 8) + c], 2e-3);
  sheet_clear (&sheet);
}

/* Recordings by other simulators with holes cut: our plate, its past and the paper's
 * operator beside each other; and whether σ is what the errors are. */
typedef struct
{
  const gchar *path;
  gdouble noise_m;              /* of the recording */
  gfloat *frames;
  guint n_frames;
} Take;

enum
{ TAKE_COLUMNS = 33, TAKE_ROWS = 35, TAKE_N = 33 * 35 };

static void
score_hole (const Take * take, ClothFillMethod method, gboolean past,
    guint start, const gboolean * hidden, gdouble sums[3])
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (TAKE_COLUMNS, TAKE_ROWS, 0.63f, 0.67f);
  ClothFillParameters parameters = { method, 0.0004, 1, 0, 0 };
  g_autoptr (ClothFill) fill = cloth_fill_new (topology, NULL, &parameters);
  g_autofree gfloat *positions = g_new (gfloat, 3 * TAKE_N);
  guint8 states[TAKE_N];
  ClothRandom random;

  cloth_random_init (&random, start);
  for (guint frame = past ? start - 8 : start; frame < start + 4; frame++) {
    const gfloat *truth = take->frames + 3 * TAKE_N * (gsize) frame;
    ClothMeshFrame in = { positions, states, NULL }, out;

    for (guint v = 0; v < TAKE_N; v++) {
      gboolean hide = frame >= start && hidden[v];

      for (guint c = 0; c < 3; c++) {
        gdouble noise = take->noise_m > 0 ? 0
            : 0.0004 * cloth_random_gaussian (&random);

        positions[3 * v + c] = hide ? NAN : truth[3 * v + c] + (gfloat) noise;
      }
      states[v] = isnan (positions[3 * v]) ? CLOTH_VERTEX_UNSEEN
          : CLOTH_VERTEX_MEASURED;
    }
    if (!past)
      cloth_fill_reset (fill);
    cloth_fill_run (fill, frame * 0.02, &in, &out, NULL);
    for (guint v = 0; frame >= start && v < TAKE_N; v++) {
      const gfloat *k = out.covariances + 6 * v;
      gdouble more = take->noise_m * take->noise_m, e[3], ie[3], inverse[9];
      gdouble a[9] = { k[0] + more, k[1], k[2], k[1], k[3] + more, k[4], k[2],
        k[4], k[5] + more
      };

      if (!hidden[v] || isnan (truth[3 * v]))
        continue;
      g_assert_cmpuint (out.states[v], ==, CLOTH_VERTEX_FILLED);
      g_assert_true (cloth_mat3_inverse (a, inverse));
      for (guint c = 0; c < 3; c++)
        e[c] = (gdouble) out.positions[3 * v + c] - truth[3 * v + c];
      cloth_mat3_vec (inverse, e, ie);
      for (guint c = 0; c < 3; c++) {
        sums[0] += e[c] * e[c];
        sums[1] += e[c] * ie[c];
        sums[2]++;
      }
    }
  }
}

static void
test_take (gconstpointer data)
{
  Take take = *(const Take *) data;
  /* column, row, radius: within, at a side, at the lower border */
  static const gdouble places[][2][3] = {
    {{9, 12, 2.3}, {22, 21, 3.2}}, {{0, 20, 3}, {32, 13, 3}},
    {{10, 34, 3}, {21, 34, 3}}
  };
  gdouble all[2] = { 0, 0 }, squares[3] = { 0, };
  ClothNpyInfo info;

  take.frames = load_npy_floats (take.path, &info, NULL);
  g_assert_nonnull (take.frames);
  g_assert_cmpuint (info.row_items, ==, 3 * TAKE_N);
  for (guint place = 0; place < G_N_ELEMENTS (places); place++) {
    gdouble sums[3][3] = { {0,}, }, rms[3];

    for (guint i = 0; i < 2; i++) {
      gboolean hidden[TAKE_N] = { FALSE, };
      const gdouble *p = places[place][i];

      for (gint v = 0; v < TAKE_N; v++)
        hidden[v] = hypot (v % TAKE_COLUMNS - p[0], v / TAKE_COLUMNS - p[1])
            <= p[2];
      for (guint start = 9; start + 4 <= info.n_rows; start += 7) {
        score_hole (&take, CLOTH_FILL_BILAPLACIAN, FALSE, start, hidden,
            sums[0]);
        score_hole (&take, CLOTH_FILL_PLATE, FALSE, start, hidden, sums[1]);
        score_hole (&take, CLOTH_FILL_PLATE, TRUE, start, hidden, sums[2]);
      }
    }
    for (guint m = 0; m < 3; m++)
      rms[m] = 1000 * sqrt (sums[m][0] / sums[m][2]);
    g_test_message ("%s: the paper %.2f mm, plate %.2f (chi² %.2f), with its "
        "past %.2f (%.2f)", place == 0 ? "within" : place == 1 ? "side"
        : "border", rms[0], rms[1], sums[1][1] / sums[1][2], rms[2],
        sums[2][1] / sums[2][2]);
    /* the paper's two fixed rings and ours are the same plate within the sheet */
    if (place == 0)
      g_assert_cmpfloat_with_epsilon (rms[1], rms[0], 0.01 * rms[0]);
    else
      g_assert_cmpfloat (rms[1], <, 0.8 * rms[0]);
    for (guint m = 0; m < 3; m++)
      squares[m] += sums[m][0];
    for (guint i = 0; i < 2; i++)
      all[i] += sums[2][1 + i] + sums[1][1 + i];
  }
  g_assert_cmpfloat (squares[1], <, 0.7 * squares[0]);
  g_assert_cmpfloat (squares[2], <, 0.8 * squares[1]);
  g_test_message ("reduced chi² %.2f", all[0] / all[1]);
  g_assert_cmpfloat (all[0] / all[1], >, 0.6);
  g_assert_cmpfloat (all[0] / all[1], <, 1.5);
  g_free (take.frames);
}

/* The same frames give the same bytes, also after a reset and after other holes. */
static void
test_same_bytes (void)
{
  Sheet sheet;
  ClothMeshFrame out;
  gfloat first[9 * N];

  sheet_init (&sheet, cloth_topology_new_grid (COLUMNS, ROWS, 0.32f, 0.24f),
      &exact);
  for (guint turn = 0; turn < 3; turn++) {
    memset (sheet.hidden, 0, N * sizeof *sheet.hidden);
    for (guint frame = 0; frame < 6; frame++) {
      if (frame == 3)
        hide (&sheet, 5, 4, 4, 4);
      sheet_run (&sheet, turned_shape, &out, NULL);
    }
    if (turn == 0) {
      memcpy (first, out.positions, 3 * N * sizeof *first);
      memcpy (first + 3 * N, out.covariances, 6 * N * sizeof *first);
    }
    g_assert_cmpmem (first, 3 * N * sizeof *first, out.positions,
        3 * N * sizeof *first);
    g_assert_cmpmem (first + 3 * N, 6 * N * sizeof *first, out.covariances,
        6 * N * sizeof *first);
    /* a time that goes back is a new sequence, as a reset is */
    hide (&sheet, 1, 1, 3, 3);
    sheet_run (&sheet, turned_shape, &out, NULL);
    sheet.frames = 0;
    if (turn == 1)
      cloth_fill_reset (sheet.fill);
  }
  sheet_clear (&sheet);
}

static void
test_smooth (void)
{
  g_autoptr (ClothTopology) topology = cloth_topology_new_grid (3, 3, 2, 2);
  g_autoptr (ClothStencils) stencils = cloth_stencils_new (topology, NULL);
  gfloat p[27], q[27], before[3] = { 0, 1, NAN }, after[3] = { 2, 1, 1 };
  gfloat now[3] = { 0, 3, 1 };

  for (guint v = 0; v < 9; v++) {
    p[3 * v] = topology->uv[2 * v];
    p[3 * v + 1] = topology->uv[2 * v + 1];
    p[3 * v + 2] = v == 4 ? 1 : 0;
  }
  cloth_smooth_space (stencils, 0.25, p, q);
  for (guint v = 0; v < 9; v++) {
    /* the flat directions stay, the bump loses a quarter, the border hears of it not */
    g_assert_cmpfloat_with_epsilon (q[3 * v], p[3 * v], 1e-6);
    g_assert_cmpfloat_with_epsilon (q[3 * v + 1], p[3 * v + 1], 1e-6);
    g_assert_cmpfloat_with_epsilon (q[3 * v + 2], v == 4 ? 0.75 : 0, 1e-6);
  }
  p[3] = p[4] = p[5] = NAN;
  cloth_smooth_space (stencils, 0.25, p, q);
  g_assert_cmpfloat (q[3 * 4 + 2], ==, 1);
  g_assert_true (isnan (q[3]));
  cloth_smooth_time (1, 0.5, before, after, now);
  g_assert_cmpfloat (now[0], ==, 0.5);
  g_assert_cmpfloat (now[1], ==, 2);
  g_assert_cmpfloat (now[2], ==, 1);
}

int
main (int argc, char **argv)
{
  static const Take takes[] = {
    {TEST_DATA "/arcsim/base/positions.npy", 0.0004, NULL, 0},
    {TEST_DATA "/take_drop/positions.npy", 0.0004, NULL, 0},
    {TEST_DATA "/checker_pair/vertices.npy", 0, NULL, 0}
  };

  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/fill/flat", test_flat);
  g_test_add_func ("/fill/triangles", test_triangles);
  g_test_add_func ("/fill/biharmonic", test_biharmonic);
  g_test_add_func ("/fill/carried", test_carried);
  g_test_add_func ("/fill/nothing-seen", test_nothing_seen);
  g_test_add_func ("/fill/not-held", test_not_held);
  g_test_add_func ("/fill/uncertain", test_uncertain);
  g_test_add_func ("/fill/hidden-fold", test_hidden_fold);
  g_test_add_func ("/fill/states", test_states);
  g_test_add_func ("/fill/outliers", test_outliers);
  g_test_add_func ("/fill/same-bytes", test_same_bytes);
  g_test_add_func ("/fill/smooth", test_smooth);
  g_test_add_data_func ("/fill/arcsim", &takes[0], test_take);
  g_test_add_data_func ("/fill/blender", &takes[1], test_take);
  g_test_add_data_func ("/fill/gust", &takes[2], test_take);
  return g_test_run ();
}
