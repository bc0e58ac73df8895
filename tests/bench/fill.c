/* Holes filled: how near the truth, how sure, how fast.
 *
 * Cuts holes into recordings whose truth is known and prints the RMS of the filled
 * vertices beside that of the paper's uniform bi-Laplacian; then the time that a frame of
 * 3,500 vertices takes. Further recordings (npy) may be named as arguments.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"
#include "gst/mesh/fill/fill.h"
#include "tests/common/npyfloats.h"

#define COLUMNS 33
#define ROWS 35
#define N (COLUMNS * ROWS)
#define WIDTH 0.63f
#define HEIGHT 0.67f
#define NOISE 0.0004
#define HOLES 12
#define BEFORE 9
#define LONG 16
#define REPEATS 60

typedef struct
{
  const gchar *path;
  guint frames;
  gfloat *truth;
  gfloat *seen;
  gdouble noise_of_truth;
} Recording;

typedef enum
{ SCATTERED, ROUND, UPRIGHT, LEVEL, BORDER, SIDE, CORNER } Kind;

typedef struct
{
  const gchar *name;
  Kind kind;
  gdouble size;
} Shape;

static const Shape shapes[] = {
  {"scattered 10%", SCATTERED, 0},
  {"round, 5", ROUND, 1},
  {"round, 13", ROUND, 2},
  {"round, 29", ROUND, 3},
  {"round, 69", ROUND, 4.5},
  {"round, 149", ROUND, 7},
  {"3 x 15 upright", UPRIGHT, 0},
  {"15 x 3 level", LEVEL, 0},
  {"lower border, 18", BORDER, 3},
  {"side, 18", SIDE, 3},
  {"lower corner, 11", CORNER, 3},
};

static void
cut_round (gboolean * hidden, gdouble column, gdouble row, gdouble radius)
{
  for (gint k = 0; k < N; k++) {
    gdouble dx = k % COLUMNS - column, dy = k / COLUMNS - row;

    if (dx * dx + dy * dy <= radius * radius)
      hidden[k] = TRUE;
  }
}

static guint
between (ClothRandom * random, guint from, guint to)
{
  return from + (guint) (cloth_random_uniform (random) * (to - from));
}

static void
cut (const Shape * shape, ClothRandom * random, gboolean * hidden)
{
  guint margin = 3 + (guint) shape->size, column, row, n = 0;

  memset (hidden, 0, N * sizeof *hidden);
  switch (shape->kind) {
    case SCATTERED:
      while (n < N / 10) {
        column = between (random, 0, COLUMNS);
        row = between (random, 0, ROWS);
        cut_round (hidden, column, row, 2.3 * cloth_random_uniform (random));
        n = 0;
        for (guint k = 0; k < N; k++)
          n += hidden[k];
      }
      break;
    case ROUND:
      column = between (random, margin, COLUMNS - margin);
      row = between (random, margin, ROWS - margin);
      cut_round (hidden, column, row, shape->size);
      break;
    case UPRIGHT:
    case LEVEL:
      column = between (random, 3, COLUMNS - (shape->kind == LEVEL ? 18 : 6));
      row = between (random, 3, ROWS - (shape->kind == LEVEL ? 6 : 18));
      for (guint k = 0; k < 45; k++)
        hidden[shape->kind == LEVEL ? (row + k / 15) * COLUMNS + column + k % 15
            : (row + k % 15) * COLUMNS + column + k / 15] = TRUE;
      break;
    case BORDER:
      cut_round (hidden, between (random, 4, COLUMNS - 4), ROWS - 1,
          shape->size);
      break;
    case SIDE:
      cut_round (hidden, 0, between (random, 4, ROWS - 4), shape->size);
      break;
    default:
      cut_round (hidden, 0, ROWS - 1, shape->size);
      break;
  }
}

typedef struct
{
  gdouble squares, chi;
  guint n, unseen;
} Sum;

static void
compare (const Recording * recording, guint frame, const gboolean * hidden,
    const ClothMeshFrame * filled, Sum * sum)
{
  for (guint k = 0; k < N; k++) {
    const gfloat *p = filled->positions + 3 * k;
    const gfloat *q = recording->truth + 3 * ((gsize) frame * N + k);
    const gfloat *c = filled->covariances + 6 * k;
    gdouble more = recording->noise_of_truth * recording->noise_of_truth;
    gdouble a[9] = { c[0] + more, c[1], c[2], c[1], c[3] + more, c[4],
      c[2], c[4], c[5] + more
    };
    gdouble inverse[9], e[3], ie[3];

    if (!hidden[k] || isnan (q[0]))
      continue;
    if (isnan (p[0])) {
      sum->unseen++;
      continue;
    }
    for (guint i = 0; i < 3; i++)
      e[i] = (gdouble) p[i] - q[i];
    cloth_mat3_inverse (a, inverse);
    cloth_mat3_vec (inverse, e, ie);
    for (guint i = 0; i < 3; i++) {
      sum->squares += e[i] * e[i];
      sum->chi += e[i] * ie[i];
    }
    sum->n += 3;
  }
}

/* Fills @hidden of the frames from @start on; the sums by age, and with no past. */
static void
fill (const Recording * recording, ClothFillMethod method, guint start,
    const gboolean * hidden, gboolean with_past, Sum sums[LONG])
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, WIDTH, HEIGHT);
  ClothFillParameters parameters = { method, NOISE, 1, 0, 0 };
  g_autoptr (ClothFill) filler = cloth_fill_new (topology, NULL, &parameters);
  g_autofree gfloat *positions = g_new (gfloat, 3 * N);
  g_autofree guint8 *states = g_new (guint8, N);

  for (guint age = 0; age < BEFORE + LONG; age++) {
    guint frame = start - BEFORE + age;
    ClothMeshFrame in = { positions, states, NULL }, out;

    if (!with_past && age < BEFORE)
      continue;
    memcpy (positions, recording->seen + 3 * (gsize) frame * N,
        3 * N * sizeof *positions);
    for (guint k = 0; k < N; k++) {
      if (age >= BEFORE && hidden[k])
        positions[3 * k] = positions[3 * k + 1] = positions[3 * k + 2] = NAN;
      states[k] = isnan (positions[3 * k]) ? CLOTH_VERTEX_UNSEEN
          : CLOTH_VERTEX_MEASURED;
    }
    cloth_fill_run (filler, frame * 0.02, &in, &out, NULL);
    if (age < BEFORE)
      continue;
    compare (recording, frame, hidden, &out, &sums[age - BEFORE]);
    if (!with_past)
      cloth_fill_reset (filler);
  }
}

static gdouble
rms_mm (const Sum * sum)
{
  return 1000 * sqrt (sum->squares / MAX (sum->n, 1));
}

static gdouble
chi (const Sum * sum)
{
  return sum->chi / MAX (sum->n, 1);
}

static void
add (Sum * sum, const Sum * more)
{
  sum->squares += more->squares;
  sum->chi += more->chi;
  sum->n += more->n;
  sum->unseen += more->unseen;
}

static void
show (const Recording * recording)
{
  static const guint ages[] = { 1, 2, 4, 8, 16 };
  Sum total[2] = { {0,}, };

  printf ("%s: RMS of filled vertices, mm (reduced chi²)\n  %-17s %9s  "
      "%-13s %-13s  in frame 1, 2, 4, 8, 16 of the hole\n", recording->path,
      "hole", "the paper", "plate alone", "with its past");
  for (guint s = 0; s < G_N_ELEMENTS (shapes); s++) {
    Sum paper[LONG] = { {0,}, }, plate[LONG] = { {0,}, };
    Sum past[LONG] = { {0,}, }, all = { 0, };
    ClothRandom random;

    cloth_random_init (&random, 7 + s);
    for (guint hole = 0; hole < HOLES; hole++) {
      gboolean hidden[N];
      guint start = between (&random, BEFORE, recording->frames - LONG + 1);

      cut (&shapes[s], &random, hidden);
      fill (recording, CLOTH_FILL_BILAPLACIAN, start, hidden, FALSE, paper);
      fill (recording, CLOTH_FILL_PLATE, start, hidden, FALSE, plate);
      fill (recording, CLOTH_FILL_PLATE, start, hidden, TRUE, past);
    }
    /* the same frames for all three */
    for (guint age = 1; age < LONG; age++) {
      add (&paper[0], &paper[age]);
      add (&plate[0], &plate[age]);
      add (&all, &past[age]);
    }
    add (&all, &past[0]);
    printf ("  %-17s %9.2f  %5.2f (%4.2f)  %5.2f (%4.2f)", shapes[s].name,
        rms_mm (&paper[0]), rms_mm (&plate[0]), chi (&plate[0]),
        rms_mm (&all), chi (&all));
    for (guint i = 0; i < 2; i++)
      add (&total[i], i ? &all : &plate[0]);
    for (guint a = 0; a < G_N_ELEMENTS (ages); a++)
      printf ("  %5.2f (%4.2f)", rms_mm (&past[ages[a] - 1]),
          chi (&past[ages[a] - 1]));
    printf ("\n");
  }
  printf ("  all: reduced chi² of the plate alone %.2f, with the past %.2f\n",
      chi (&total[0]), chi (&total[1]));
}

static gboolean
load (Recording * recording, const gchar * path)
{
  g_autoptr (GError) error = NULL;
  ClothNpyInfo info;
  ClothRandom random;
  gsize n;

  cloth_random_init (&random, 1);
  recording->path = path;
  recording->truth = load_npy_floats (path, &info, &error);
  if (!recording->truth) {
    fprintf (stderr, "%s\n", error->message);
    return FALSE;
  }
  if (info.row_items != 3 * N || info.n_rows < BEFORE + LONG) {
    fprintf (stderr, "%s: not %d vertices in %d frames or more\n", path, N,
        BEFORE + LONG);
    return FALSE;
  }
  recording->frames = (guint) info.n_rows;
  n = (gsize) recording->frames * 3 * N;
  recording->seen = g_memdup2 (recording->truth, n * sizeof (gfloat));
  /* takes have their noise already */
  recording->noise_of_truth = g_str_has_suffix (path, "positions.npy") ? NOISE
      : 0;
  for (gsize i = 0; i < n && recording->noise_of_truth == 0; i++)
    recording->seen[i] += (gfloat) (NOISE * cloth_random_gaussian (&random));
  return TRUE;
}

/* The recording's frames stretched to another grid. */
#define MORE_COLUMNS 50
#define MORE_ROWS 70
#define MORE (MORE_COLUMNS * MORE_ROWS)

static void
stretch (const gfloat * from, gfloat * to)
{
  for (guint k = 0; k < MORE; k++) {
    gdouble x =
        (gdouble) (k % MORE_COLUMNS) * (COLUMNS - 1) / (MORE_COLUMNS - 1);
    gdouble y = (gdouble) (k / MORE_COLUMNS) * (ROWS - 1) / (MORE_ROWS - 1);
    guint i = MIN ((guint) x, COLUMNS - 2), j = MIN ((guint) y, ROWS - 2);
    const gfloat *p = from + 3 * (j * COLUMNS + i);

    x -= i;
    y -= j;
    for (guint c = 0; c < 3; c++)
      to[3 * k + c] = (gfloat) ((1 - y) * ((1 - x) * p[c] + x * p[3 + c])
          + y * ((1 - x) * p[3 * COLUMNS + c] + x * p[3 * COLUMNS + 3 + c]));
  }
}

static void
time_frames (const Recording * recording)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (MORE_COLUMNS, MORE_ROWS, 0.98f, 1.38f);
  g_autofree gfloat *positions = g_new (gfloat, 3 * MORE);
  g_autofree guint8 *states = g_new (guint8, MORE);
  g_autofree gboolean *hidden = g_new (gboolean, MORE);
  static const gchar *const names[] = { "holes stay, no outliers sought",
    "holes stay", "new holes in every frame", "the paper's solver, holes stay"
  };

  printf
      ("%d vertices, 10%% missing in scattered holes, one core; ms a frame\n",
      MORE);
  for (guint mode = 0; mode < G_N_ELEMENTS (names); mode++) {
    ClothFillParameters parameters = {
      mode == 3 ? CLOTH_FILL_BILAPLACIAN : CLOTH_FILL_PLATE, NOISE, 1,
      CLOTH_FILL_PREDICTION, mode == 0 ? 0 : CLOTH_FILL_OUTLIER
    };
    g_autoptr (ClothFill) filler = cloth_fill_new (topology, NULL, &parameters);
    ClothRandom random;
    ClothFillCounts counts;
    gdouble best = G_MAXDOUBLE, sum = 0;

    cloth_random_init (&random, 3);
    for (guint frame = 0; frame < REPEATS; frame++) {
      ClothMeshFrame in = { positions, states, NULL }, out;
      gint64 start;
      guint n = 0;

      if (frame == 0 || mode == 2) {
        memset (hidden, 0, MORE * sizeof *hidden);
        while (n < MORE / 10) {
          gint x = (gint) between (&random, 0, MORE_COLUMNS);
          gint y = (gint) between (&random, 0, MORE_ROWS);
          gdouble radius = 2.3 * cloth_random_uniform (&random);

          for (gint k = 0; k < MORE; k++)
            if (hypot (k % MORE_COLUMNS - x, k / MORE_COLUMNS - y) <= radius
                && !hidden[k]) {
              hidden[k] = TRUE;
              n++;
            }
        }
      }
      stretch (recording->seen + 3 * N * (gsize) (frame % recording->frames),
          positions);
      for (guint k = 0; k < MORE; k++) {
        states[k] = hidden[k] ? CLOTH_VERTEX_UNSEEN : CLOTH_VERTEX_MEASURED;
        if (hidden[k])
          positions[3 * k] = positions[3 * k + 1] = positions[3 * k + 2] = NAN;
      }
      start = g_get_monotonic_time ();
      cloth_fill_run (filler, frame * 0.02, &in, &out, &counts);
      if (frame >= 10) {
        gdouble ms = (g_get_monotonic_time () - start) / 1000.;

        best = MIN (best, ms);
        sum += ms / (REPEATS - 10);
      }
    }
    printf ("  %-32s %6.2f (mean %.2f); %u holes, %u factored, %u filled, "
        "%u outliers\n", names[mode], best, sum, counts.holes, counts.factored,
        counts.filled, counts.outliers);
  }
}

/* One vertex in a hundred is put somewhere else: how many are found, and how many of the
 * others are taken for such. A wrong vertex stays wrong for four frames. */
static void
find_wrong (const Recording * recording)
{
  static const gdouble shifts[] = { 0.003, 0.005, 0.01, 0.02, 0.05 };
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, WIDTH, HEIGHT);
  ClothFillParameters parameters = { CLOTH_FILL_PLATE, NOISE, 1,
    CLOTH_FILL_PREDICTION, CLOTH_FILL_OUTLIER
  };
  g_autofree gfloat *positions = g_new (gfloat, 3 * N);
  g_autofree guint8 *states = g_new (guint8, N);

  printf ("  outliers found, first frame and later (others removed):");
  for (guint s = 0; s < G_N_ELEMENTS (shifts); s++) {
    g_autoptr (ClothFill) filler = cloth_fill_new (topology, NULL, &parameters);
    guint found[2] = { 0, }, all[2] = { 0, }, others = 0, seen = 0;
    gfloat offset[N][3] = { {0,}, };
    guint8 left[N] = { 0, };
    ClothRandom random;

    cloth_random_init (&random, 5);
    for (guint frame = 0; frame < recording->frames; frame++) {
      ClothMeshFrame in = { positions, states, NULL }, out;

      memcpy (positions, recording->seen + 3 * (gsize) frame * N,
          3 * N * sizeof *positions);
      for (guint k = 0; k < N; k++) {
        states[k] = isnan (positions[3 * k]) ? CLOTH_VERTEX_UNSEEN
            : CLOTH_VERTEX_MEASURED;
        if (left[k] > 0) {
          left[k]--;
        } else if (frame > 0 && cloth_random_uniform (&random) < 0.0025) {
          gdouble d[3], length = 0;

          for (guint c = 0; c < 3; c++) {
            d[c] = cloth_random_gaussian (&random);
            length += d[c] * d[c];
          }
          for (guint c = 0; c < 3; c++)
            offset[k][c] = (gfloat) (shifts[s] * d[c] / sqrt (length));
          left[k] = 4;
        }
        for (guint c = 0; c < 3 && left[k] > 0; c++)
          positions[3 * k + c] += offset[k][c];
      }
      cloth_fill_run (filler, frame * 0.02, &in, &out, NULL);
      for (guint k = 0; k < N; k++) {
        gboolean removed = states[k] != out.states[k];

        if (states[k] == CLOTH_VERTEX_UNSEEN)
          continue;
        if (left[k] > 0) {
          found[left[k] < 4] += removed;
          all[left[k] < 4]++;
        } else {
          others += removed;
          seen++;
        }
      }
    }
    printf ("  %g mm %.0f%% %.0f%% (%.3f%%)", shifts[s] * 1000,
        100. * found[0] / all[0], 100. * found[1] / all[1],
        100. * others / seen);
  }
  printf ("\n");
}

int
main (int argc, char **argv)
{
  static const gchar *const standard[] = {
    TEST_DATA "/checker_pair/vertices.npy",
    TEST_DATA "/arcsim/base/positions.npy",
    TEST_DATA "/take_drop/positions.npy",
  };
  gboolean given = argc > 1;
  guint n = given ? (guint) argc - 1 : G_N_ELEMENTS (standard);

  for (guint i = 0; i < n; i++) {
    Recording recording = { 0, };

    if (!load (&recording, given ? argv[i + 1] : standard[i]))
      return 1;
    show (&recording);
    find_wrong (&recording);
    if (i == 0)
      time_frames (&recording);
    g_free (recording.truth);
    g_free (recording.seen);
  }
  return 0;
}
