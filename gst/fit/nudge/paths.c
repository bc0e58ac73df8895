/* Paths of clamps that nobody logged, as the cloth that hangs from them has them.
 *
 * Model: a path is off that of cloth_recording_find_paths () by δ(t) = Σ_k c_k B((t − t_k)/Δ), cubic
 *   B-splines of the knots t_k, δ of each frame N(0, s²), s as well as the path was known there. The
 *   simulation that springs of the gain g draw to what was seen is off it, about the clamp, by
 *   e + J c + N(0, v).
 * Assumption: vertices about a clamp are off together, and as long as springs remember, so those of the
 *   frames between two knots count as one; what springs did 3/(ζ√g) ago is forgotten. Where a clamp takes
 *   the cloth is linear in small c.
 * Formula: c = (JᵀJ/v + BᵀS⁻¹B)⁻¹ (Jᵀe/v − BᵀS⁻¹δ), v the variance that is left (Gauss–Newton). Knots that
 *   far apart have nothing to do with each other, so one simulation moves many at a time: every sixth.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 5 (places of constrained points as unknowns); Curtis, Powell and Reid 1974 (columns of a banded
 *   Jacobian together).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/nudge/paths.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/recording.h"
#include "gst/math/band.h"
#include "gst/math/vec3.h"

/* The vertices about a clamp that are looked at, and of these how many, the nearest that a frame saw, tell of
 * it. */
#define MOST_ABOUT 400
#define MOST_SEEN 64
/* Numbers that are kept of them: 1 GB. */
#define MOST_NUMBERS 268435456.
/* Clamps whose paths are found at a time; with more, those of the interpolation stand. */
#define MOST_CLAMPS 4
/* By how much a knot is moved for a derivative, m. */
#define STEP 2e-3
/* Linearisations, turns of each to find the variance that it leaves, and the change of a path that is
 * none, m. */
#define MOST_PASSES 4
#define MOST_TURNS 20
#define SETTLED 1e-4
/* A path is not known better, m. */
#define LOGGED 1e-4
/* How far off a knot may be that nothing tells of, m. */
#define FARTHEST 1.
/* Time constants after which springs have forgotten, and how far a B-spline reaches to a side, knots. */
#define FORGOTTEN 3.
#define REACH 2.
/* Of so many knots at a time. */
#define N_KNOTS 5
/* Frames between two knots, at least. */
#define FRAMES 3.

typedef struct
{
  ClothRecording *r;
  guint n_paths;
  guint *paths;                 /* of all held ones those that are looked for */
  guint n_about;
  guint32 *about;               /* vertices about each, [n_paths][n_about] */
  guint n_knots, period;        /* every period-th knot is moved at a time */
  gdouble knot_s, frame_s;      /* between knots, and frames */
  guint n_models;               /* simulations: as it is, then 3·n_paths·period */
  gfloat *places;               /* of the vertices about, [n_frames][n_models][n_paths·n_about][3] */
    gdouble (*slopes)[3];       /* of a vertex, by model */
  /* unknowns: [n_knots][n_paths][3], matrices banded */
  gdouble *data, *right;        /* JᵀJ and Jᵀe */
  gdouble square, n_told;       /* sum of squares, and of how many vertices it is */
  gdouble *first;               /* the paths as they were found, [n_frames][held][3] */
  gdouble *normal;              /* factor of the normal equations */
  gdouble *change;              /* c */
} Paths;

static void
paths_clear (Paths * p)
{
  g_free (p->paths);
  g_free (p->about);
  g_free (p->places);
  g_free (p->slopes);
  g_free (p->data);
  g_free (p->right);
  g_free (p->first);
  g_free (p->normal);
  g_free (p->change);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Paths, paths_clear);

static guint
unknowns_of_knot (const Paths * p)
{
  return 3 * p->n_paths;
}

static guint
bandwidth (const Paths * p)
{
  return p->period * unknowns_of_knot (p) - 1;
}

static guint
n_unknowns (const Paths * p)
{
  return p->n_knots * unknowns_of_knot (p);
}

static gsize
n_band (const Paths * p)
{
  return (gsize) n_unknowns (p) * (bandwidth (p) + 1);
}

/* The cubic B-spline of knots at distance 1. */
static gdouble
spline (gdouble x)
{
  const gdouble a = fabs (x);

  return a >= 2. ? 0. : a >= 1. ? (2. - a) * (2. - a) * (2. - a) / 6. :
      2. / 3. - a * a + a * a * a / 2.;
}

/* The first knot reaches as far into the recording as the last: not at all at its ends. */
static gdouble
knot_time (const Paths * p, guint knot)
{
  return p->r->times[0] + (knot - 1.) * p->knot_s;
}

static gdouble
weight_at (const Paths * p, guint knot, guint frame)
{
  return spline ((p->r->times[frame] - knot_time (p, knot)) / p->knot_s);
}

/* The first of the knots whose B-splines reach a frame. */
static guint
first_knot (const Paths * p, guint frame)
{
  const gdouble at = (p->r->times[frame] - p->r->times[0]) / p->knot_s + 1.;

  return (guint) fmax (ceil (at - REACH), 0.);
}

typedef struct
{
  gdouble square;
  guint32 vertex;
} Near;

static gint
compare_near (gconstpointer a, gconstpointer b)
{
  const Near *x = a, *y = b;

  return x->square < y->square ? -1 : x->square > y->square ? 1 :
      x->vertex < y->vertex ? -1 : x->vertex > y->vertex;
}

/* The vertices nearest to what a clamp holds on the flat cloth, without those that are held. */
static void
find_about (Paths * p, guint path)
{
  const ClothScene *scene = p->r->scene;
  const gfloat *uv = scene->topology->uv;
  const guint vertex = g_array_index (scene->held, ClothHeld,
      p->paths[path]).vertex;
  g_autofree Near *near = g_new (Near, p->r->n);

  for (guint v = 0; v < p->r->n; v++)
    near[v] = (Near) {
    pow (uv[2 * v] - uv[2 * vertex], 2.) +
        pow (uv[2 * v + 1] - uv[2 * vertex + 1], 2.), v};
  for (guint i = 0; i < scene->held->len; i++)
    near[g_array_index (scene->held, ClothHeld, i).vertex].square = INFINITY;
  qsort (near, p->r->n, sizeof *near, compare_near);
  for (guint i = 0; i < p->n_about; i++)
    p->about[path * p->n_about + i] = near[i].vertex;
}

/* Vertices that are held at any time. */
static guint
count_held (const ClothScene * scene)
{
  g_autoptr (GHashTable) held = g_hash_table_new (NULL, NULL);

  for (guint i = 0; i < scene->held->len; i++)
    g_hash_table_add (held, GUINT_TO_POINTER (g_array_index (scene->held,
                ClothHeld, i).vertex));
  return g_hash_table_size (held);
}

/* FALSE when there is nothing to look for. */
static gboolean
paths_init (Paths * p, ClothRecording * r, gdouble gain)
{
  const ClothScene *scene = r->scene;
  const gdouble forgets_s = 1. / (CLOTH_ROLLOUT_ZETA * sqrt (gain));

  *p = (Paths) {
  r};
  p->paths = g_new (guint, scene->held->len + 1);
  for (guint i = 0; i < scene->held->len; i++)
    for (guint f = 0; f < r->n_frames; f++)
      if (cloth_scene_is_found (scene, (gsize) f * scene->held->len + i)) {
        p->paths[p->n_paths++] = i;
        break;
      }
  if (p->n_paths == 0 || p->n_paths > MOST_CLAMPS)
    return FALSE;
  p->frame_s = cloth_recording_get_frame_s (r);
  p->knot_s = fmax (2. * forgets_s, FRAMES * p->frame_s);
  p->period = (guint) ceil (2. * REACH + FORGOTTEN * forgets_s / p->knot_s);
  p->n_knots = (guint) ceil ((r->times[r->n_frames - 1] -
          r->times[0]) / p->knot_s) + 3;
  p->n_models = 1 + unknowns_of_knot (p) * p->period;
  p->n_about = (guint) MIN (MIN (MOST_ABOUT, MOST_NUMBERS /
          (3. * r->n_frames * p->n_models * p->n_paths)),
      r->n - count_held (scene));
  if (p->n_about == 0)
    return FALSE;
  p->about = g_new (guint32, p->n_paths * p->n_about);
  for (guint i = 0; i < p->n_paths; i++)
    find_about (p, i);
  p->places = g_new (gfloat, 3 * (gsize) r->n_frames * p->n_models *
      p->n_paths * p->n_about);
  p->slopes = g_malloc (p->n_models * sizeof *p->slopes);
  p->data = g_new (gdouble, n_band (p));
  p->normal = g_new (gdouble, n_band (p));
  p->right = g_new (gdouble, n_unknowns (p));
  p->first = g_memdup2 (scene->clamps, 3 * (gsize) r->n_frames *
      scene->held->len * sizeof (gdouble));
  p->change = g_new (gdouble, n_unknowns (p));
  return TRUE;
}

static gfloat *
place (const Paths * p, guint frame, guint model, guint path, guint i)
{
  return p->places + 3 * ((((gsize) frame * p->n_models +
              model) * p->n_paths + path) * p->n_about + i);
}

static void
keep (gpointer data, guint model, guint frame, const gdouble * positions)
{
  const Paths *p = data;

  for (guint path = 0; path < p->n_paths; path++)
    for (guint i = 0; i < p->n_about; i++) {
      const gdouble *from = positions + 3 * p->about[path * p->n_about + i];
      gfloat *to = place (p, frame, model, path, i);

      for (guint c = 0; c < 3; c++)
        to[c] = (gfloat) from[c];
    }
}

/* Adds a share of B-splines to a path: of every knot @first, @first + @every, … @change[knot · @stride]. */
static void
add_splines (const Paths * p, gdouble * clamps, guint path, guint coordinate,
    guint first, guint every, const gdouble * change, guint stride)
{
  const guint n_held = p->r->scene->held->len;

  for (guint knot = first; knot < p->n_knots; knot += every)
    for (guint f = 0; f < p->r->n_frames; f++)
      clamps[3 * ((gsize) f * n_held + p->paths[path]) + coordinate] +=
          weight_at (p, knot, f) * (change ? change[knot * stride] : STEP);
}

/* Which knot a model has moved that may show in a frame; -1: none yet. */
static gint
find_moved (const Paths * p, guint phase, guint frame)
{
  const gdouble since = (p->r->times[frame] - p->r->times[0]) / p->knot_s + 1.;
  gint last = (gint) floor (since + REACH);

  last = MIN (last, (gint) p->n_knots - 1);
  return last < (gint) phase ? -1 : last - (last - (gint) phase) % (gint)
      p->period;
}

/* The simulation as it is, and with each group of knots moved; FALSE with @error set, or without when it
 * diverges. */
static gboolean
simulate (Paths * p, const ClothModel * model, gdouble gain, guint n_models,
    const ClothRolloutOptions * options, gboolean * sound, GError ** error)
{
  ClothRolloutOptions quietly = *options;
  g_autofree ClothRecording *copies = g_new (ClothRecording, n_models);
  g_autofree ClothScene *scenes = g_new (ClothScene, n_models);
  g_autofree const ClothRecording **targets =
      g_new (const ClothRecording *, n_models);
  g_autofree const ClothModel **models = g_new (const ClothModel *, n_models);
  g_autofree gdouble *gains = g_new (gdouble, n_models);
  const gsize size = 3 * (gsize) p->r->n_frames * p->r->scene->held->len;
  gboolean good;

  quietly.failed = NULL;
  for (guint m = 0; m < n_models; m++) {
    const guint unknown = (m - 1) / p->period, phase = (m - 1) % p->period;

    targets[m] = p->r;
    models[m] = model;
    gains[m] = gain;
    if (m == 0)
      continue;
    copies[m] = *p->r;
    scenes[m] = *p->r->scene;
    scenes[m].clamps = g_memdup2 (p->r->scene->clamps, size * sizeof (gdouble));
    add_splines (p, scenes[m].clamps, unknown / 3, unknown % 3, phase,
        p->period, NULL, 0);
    copies[m].scene = &scenes[m];
    targets[m] = &copies[m];
  }
  good = cloth_rollout_nudged (targets, models, gains, n_models, &quietly,
      keep, p, sound, error);
  for (guint m = 1; m < n_models; m++)
    g_free (scenes[m].clamps);
  return good && sound[0];
}

/* How far a vertex about a clamp is seen off the simulation; FALSE where it was not seen. */
static gboolean
find_off (const Paths * p, guint frame, guint path, guint i, gdouble off[3])
{
  const gsize at = (gsize) frame * p->r->n + p->about[path * p->n_about + i];
  const gfloat *x = place (p, frame, 0, path, i);

  if (p->r->seen[at] < 1.)
    return FALSE;
  for (guint c = 0; c < 3; c++)
    off[c] = p->r->y[3 * at + c] - x[c];
  cloth_recording_cut_blind (p->r, at, off);
  return TRUE;
}

/* What a frame saw about a clamp, nearest first. Returns how many vertices. */
static guint
list_seen (const Paths * p, guint frame, guint path, guint * list,
    gdouble (*off)[3])
{
  guint n = 0;

  for (guint i = 0; i < p->n_about && n < MOST_SEEN; i++)
    if (find_off (p, frame, path, i, off[n]))
      list[n++] = i;
  return n;
}

/* Mean square by which vertices about clamps are seen off the simulation, m²; 0 when none is seen. */
static gdouble
find_square (const Paths * p)
{
  guint list[MOST_SEEN];
  gdouble off[MOST_SEEN][3], sum = 0.;
  gsize n = 0;

  for (guint f = 1; f < p->r->n_frames; f++)
    for (guint path = 0; path < p->n_paths; path++) {
      const guint seen = list_seen (p, f, path, list, off);

      for (guint i = 0; i < seen; i++)
        sum += cloth_vec3_dot (off[i], off[i]);
      n += seen;
    }
  return n ? sum / n : 0.;
}

/* Which unknown each model but the first shows in a frame, or -1. */
static void
list_unknowns (const Paths * p, guint frame, const gboolean * sound,
    gint * unknowns)
{
  for (guint m = 1; m < p->n_models; m++) {
    const guint unknown = (m - 1) / p->period;
    const gint knot = find_moved (p, (m - 1) % p->period, frame);

    unknowns[m] = knot < 0 || !sound[m] ? -1 :
        knot * (gint) unknowns_of_knot (p) + (gint) unknown;
  }
}

/* Adds what one vertex tells, @share times: Jᵀe and JᵀJ. */
static void
add_vertex (Paths * p, guint frame, guint path, guint i, const gint * unknowns,
    gdouble share, const gdouble off[3])
{
  const gsize at = (gsize) frame * p->r->n + p->about[path * p->n_about + i];
  const gfloat *x = place (p, frame, 0, path, i);
  gdouble (*slopes)[3] = p->slopes;

  for (guint m = 1; m < p->n_models; m++) {
    const gfloat *moved = place (p, frame, m, path, i);

    for (guint c = 0; c < 3; c++)
      slopes[m][c] = ((gdouble) moved[c] - x[c]) / STEP;
    cloth_recording_cut_blind (p->r, at, slopes[m]);
  }
  for (guint m = 1; m < p->n_models; m++) {
    if (unknowns[m] < 0)
      continue;
    for (guint c = 0; c < 3; c++)
      p->right[unknowns[m]] += share * slopes[m][c] * off[c];
    for (guint o = 1; o < p->n_models; o++) {
      gdouble product = 0.;

      if (unknowns[o] < 0 || unknowns[o] > unknowns[m])
        continue;
      for (guint c = 0; c < 3; c++)
        product += slopes[m][c] * slopes[o][c];
      CLOTH_BAND (p->data, bandwidth (p), unknowns[m], unknowns[o]) +=
          share * product;
    }
  }
}

/* What all that was seen tells: those of the frames between two knots count as one vertex. */
static void
add_all (Paths * p, const gboolean * sound)
{
  g_autofree gint *unknowns = g_new (gint, p->n_models);
  guint list[MOST_SEEN];
  gdouble off[MOST_SEEN][3];

  memset (p->data, 0, n_band (p) * sizeof *p->data);
  memset (p->right, 0, n_unknowns (p) * sizeof *p->right);
  p->square = p->n_told = 0.;
  for (guint f = 1; f < p->r->n_frames; f++) {
    list_unknowns (p, f, sound, unknowns);
    for (guint path = 0; path < p->n_paths; path++) {
      const guint n = list_seen (p, f, path, list, off);
      const gdouble share = p->frame_s / (p->knot_s * MAX (n, 1));

      for (guint i = 0; i < n; i++) {
        add_vertex (p, f, path, list[i], unknowns, share, off[i]);
        p->square += share * cloth_vec3_dot (off[i], off[i]);
        p->n_told += share;
      }
    }
  }
}

/* The prior: δ of each frame N(0, sd²), those between two knots as one; about the paths that were found first. */
static void
add_prior (Paths * p)
{
  const guint each = unknowns_of_knot (p);
  const guint n_held = p->r->scene->held->len;

  for (guint f = 0; f < p->r->n_frames; f++)
    for (guint path = 0; path < p->n_paths; path++) {
      const gsize at = (gsize) f * n_held + p->paths[path];
      const gdouble sd = fmax (p->r->scene->clamps_sd[at], LOGGED);
      const gdouble share = p->frame_s / (p->knot_s * sd * sd);
      guint first = first_knot (p, f);

      if (!cloth_held_holds (&g_array_index (p->r->scene->held, ClothHeld,
                  p->paths[path]), p->r->times[f]))
        continue;
      for (guint k = first; k < MIN (first + N_KNOTS, p->n_knots); k++)
        for (guint c = 0; c < 3; c++) {
          const guint i = k * each + 3 * path + c;
          const gdouble weight = share * weight_at (p, k, f);

          p->change[i] -= weight * (p->r->scene->clamps[3 * at + c] -
              p->first[3 * at + c]);
          for (guint l = first; l <= k; l++)
            CLOTH_BAND (p->normal, bandwidth (p), i, l * each + 3 * path +
                c) += weight * weight_at (p, l, f);
        }
    }
}

/* c for the variance v of what is left; FALSE when nothing tells of it. */
static gboolean
solve_for (Paths * p, gdouble variance)
{
  const guint all = n_unknowns (p);

  for (gsize k = 0; k < n_band (p); k++)
    p->normal[k] = p->data[k] / variance;
  for (guint k = 0; k < all; k++) {
    p->change[k] = p->right[k] / variance;
    /* knots beyond the ends, and where no clamp holds */
    CLOTH_BAND (p->normal, bandwidth (p), k, k) += 1. / (FARTHEST * FARTHEST);
  }
  add_prior (p);
  if (!cloth_band_factor (all, bandwidth (p), p->normal))
    return FALSE;
  cloth_band_solve (all, bandwidth (p), p->normal, 1, p->change);
  return TRUE;
}

/* 2 cᵀJᵀe − cᵀJᵀJc: by how much c lowers the sum of squares. */
static gdouble
find_gain (const Paths * p)
{
  const guint all = n_unknowns (p), width = bandwidth (p);
  gdouble sum = 0.;

  for (guint i = 0; i < all; i++) {
    sum += 2. * p->change[i] * p->right[i];
    for (guint j = i > width ? i - width : 0; j <= i; j++)
      sum -= (j < i ? 2. : 1.) * p->change[i] * p->change[j] *
          CLOTH_BAND (p->data, width, i, j);
  }
  return sum;
}

/* The change of all unknowns, with the variance that it leaves itself: a path that is far off is no noise.
 * FALSE when nothing tells of it. */
static gboolean
solve (Paths * p, const gboolean * sound)
{
  const ClothRecording *r = p->r;
  const gdouble least = fmax (r->sigma * r->sigma, LOGGED * LOGGED);
  gdouble left;

  add_all (p, sound);
  if (!(p->n_told > 0.))
    return FALSE;
  /* of a coordinate */
  left = fmax (p->square / (3. * p->n_told), least);
  for (guint turn = 0; turn < MOST_TURNS; turn++) {
    const gdouble before = left;

    if (!solve_for (p, left))
      return FALSE;
    left = fmax ((p->square - find_gain (p)) / (3. * p->n_told), least);
    if (fabs (left - before) < 0.01 * before)
      break;
  }
  return TRUE;
}

/* Moves the paths. Returns how far, RMS, m. */
static gdouble
move (Paths * p)
{
  ClothScene *scene = p->r->scene;
  const gsize size = 3 * (gsize) p->r->n_frames * scene->held->len;
  g_autofree gdouble *before = g_memdup2 (scene->clamps,
      size * sizeof (gdouble));
  gdouble sum = 0.;

  for (guint u = 0; u < unknowns_of_knot (p); u++)
    add_splines (p, scene->clamps, u / 3, u % 3, 0, 1, p->change + u,
        unknowns_of_knot (p));
  for (gsize k = 0; k < size; k++) {
    /* what was logged stays, and what is behind a clamp's last frame */
    if (scene->clamps_sd[k / 3] == 0.)
      scene->clamps[k] = before[k];
    else
      sum += pow (scene->clamps[k] - before[k], 2.);
  }
  return sqrt (sum / (p->r->n_frames * p->n_paths));
}

/* How well the paths are known after a step, into @sd: at least as well as @p's B-splines, if these were all off
 * alike, and as before. */
static void
find_deviations (Paths * p, gdouble * sd)
{
  const guint each = unknowns_of_knot (p), all = n_unknowns (p);
  const guint n_held = p->r->scene->held->len;
  g_autofree gdouble *variances = g_new (gdouble, all);

  cloth_band_inverse_diagonal (all, bandwidth (p), p->normal, variances);
  for (guint f = 0; f < p->r->n_frames; f++)
    for (guint path = 0; path < p->n_paths; path++) {
      const gsize at = (gsize) f * n_held + p->paths[path];
      const guint first = first_knot (p, f);
      gdouble sum = 0.;

      for (guint k = first; k < MIN (first + N_KNOTS, p->n_knots); k++) {
        const gdouble *v = variances + k * each + 3 * path;

        sum += weight_at (p, k, f) * sqrt ((v[0] + v[1] + v[2]) / 3.);
      }
      sd[at] = fmin (p->r->scene->clamps_sd[at], fmax (sum, LOGGED));
    }
}

/* What goes with the paths: places that nobody saw, and how fast all are. */
static void
take_along (ClothRecording * r)
{
  cloth_recording_interpolate (r);
  cloth_recording_place_held (r);
  cloth_recording_differentiate (r);
}

/* @recording: a recording
 * @model: what is known of the cloth
 * @gain: of the springs that draw it to what was seen, 1/s²
 * @options: how to simulate
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * Moves the paths of clamps that nobody logged to where the simulated cloth about them is nearest to what was
 * seen. A simulation that diverges moves none: whoever uses the recording is told.
 *
 * Returns: %FALSE with an error
 */
gboolean
cloth_recording_refine_paths (ClothRecording * recording,
    const ClothModel * model, gdouble gain,
    const ClothRolloutOptions * options, GError ** error)
{
  ClothScene *scene = recording->scene;
  const gsize places = (gsize) recording->n_frames * scene->held->len;
  const gsize size = 3 * places * sizeof (gdouble);
  g_auto (Paths) p = { NULL };
  g_autofree gboolean *sound = NULL;
  g_autofree gdouble *best = NULL, *sd = NULL;
  gdouble least = INFINITY, moved = INFINITY;
  GError *stopped = NULL;

  if (!paths_init (&p, recording, gain))
    return TRUE;
  sound = g_new (gboolean, p.n_models);
  best = g_memdup2 (scene->clamps, size);
  sd = g_memdup2 (scene->clamps_sd, places * sizeof (gdouble));
  for (guint pass = 0; pass <= MOST_PASSES; pass++) {
    const gboolean is_last = pass == MOST_PASSES || moved < SETTLED;
    gdouble square;

    if (!simulate (&p, model, gain, is_last ? 1 : p.n_models, options, sound,
            &stopped))
      break;
    square = find_square (&p);
    if (!(square > 0.) || !(square < least))
      break;
    if (pass > 0)
      find_deviations (&p, sd);
    least = square;
    memcpy (best, scene->clamps, size);
    if (is_last || !solve (&p, sound))
      break;
    moved = move (&p);
  }
  memcpy (scene->clamps, best, size);
  memcpy (scene->clamps_sd, sd, places * sizeof (gdouble));
  take_along (recording);
  if (stopped)
    g_propagate_error (error, stopped);
  return !stopped;
}
