/* Paths of clamps that nobody logged, as what was seen of the cloth has them.
 *
 * Model: a clamp is where the vertex is that it holds. That one is seen as the recording's noise has it;
 *   where it isn't, or on one ray alone, its place y is off by about as much as the nearest vertex is away
 *   that was seen. Hands and grippers move without jerks: d³z/dt³ is white noise of the power q.
 * Formula: z minimises Σ (y − z)ᵀ Λ (y − z) + 1/q Σ |D³z|² Δt, D³ the third divided differences at the
 *   times of the frames: with A = Λ + D³ᵀD³ Δt/q, z = A⁻¹ Λ y, of the covariance A⁻¹. Of the powers q the
 *   one of the greatest likelihood −½ (yᵀΛ(y − z) + log |A| + 3 (n − 3) log q) is taken.
 * Reference: Wahba, Spline Models for Observational Data, 1990, chapters 1 and 4 (generalised maximum
 *   likelihood).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/paths.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/noise.h"
#include "gst/math/band.h"
#include "gst/math/vec3.h"

/* Frames of a divided difference, and how far apart the numbers are that it links. */
#define N_DIFFERENCE 4
#define BANDWIDTH (3 * (N_DIFFERENCE - 1))
/* Powers that are tried, m²/s⁵: from a clamp that hardly moves to one that is thrown about. */
#define LEAST_POWER 1e-6
#define MOST_POWER 1e8
#define POWER_STEP 4.
/* No place is known better, m: logged ones too are rounded. */
#define ROUNDING 1e-5

typedef struct
{
  const ClothRecording *r;
  guint n;                      /* frames */
  gdouble *information;         /* Λ of each, [n][6] */
  gdouble origin[3];            /* small numbers lose less */
  gdouble *y;                   /* off the origin, [n][3] */
  gdouble *differences;         /* of each row of D³ its factors by √Δt, [n − 3][4] */
  gdouble *factor;              /* of A */
  gdouble *unsure;              /* how far off each may be that was not located, m; else 0, [n] */
  gdouble *z, *right;           /* and Λ y, [n][3] */
} Path;

static void
path_clear (Path * path)
{
  g_free (path->information);
  g_free (path->y);
  g_free (path->differences);
  g_free (path->factor);
  g_free (path->unsure);
  g_free (path->z);
  g_free (path->right);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Path, path_clear);

static gboolean
is_held (const ClothRecording * r, guint held, guint frame)
{
  return cloth_held_holds (&g_array_index (r->scene->held, ClothHeld, held),
      r->times[frame]);
}

/* Whether a place is known in all directions. */
static gboolean
is_known (const ClothRecording * r, gsize at)
{
  const gdouble *draw = r->noise ? r->noise->draw + 6 * at : NULL;

  return r->seen[at] == 1. && (!draw || draw[0] + draw[1] + draw[2] > 2.5);
}

/* How far on the flat cloth the nearest other vertex is that a frame saw, m, ∞ when it saw none; and that it
 * located, into @known, the cloth's size when it located none. */
static gdouble
find_distance (const ClothRecording * r, guint frame, guint vertex,
    gdouble * known)
{
  const gfloat *uv = r->scene->topology->uv;
  gdouble nearest = INFINITY, furthest = ROUNDING;

  *known = INFINITY;
  for (guint v = 0; v < r->n; v++) {
    const gsize at = (gsize) frame * r->n + v;
    const gdouble distance = fmax (hypot (uv[2 * v] - uv[2 * vertex],
            uv[2 * v + 1] - uv[2 * vertex + 1]), ROUNDING);

    furthest = fmax (furthest, distance);
    if (v != vertex && r->seen[at] > 0.)
      nearest = fmin (nearest, distance);
    if (v != vertex && is_known (r, at))
      *known = fmin (*known, distance);
  }
  *known = fmin (*known, furthest);
  return nearest;
}

/* D³z of four frames is Σ w_i z_i: 3! times the divided difference. */
static void
find_differences (Path * p)
{
  const gdouble *t = p->r->times;
  const gdouble span = (t[p->n - 1] - t[0]) / (p->n - 1);

  for (guint f = 0; f + N_DIFFERENCE <= p->n; f++)
    for (guint i = 0; i < N_DIFFERENCE; i++) {
      gdouble product = 1.;

      for (guint k = 0; k < N_DIFFERENCE; k++)
        product *= k == i ? 1. : t[f + i] - t[f + k];
      p->differences[N_DIFFERENCE * (gsize) f + i] = 6. / product * sqrt (span);
    }
}

/* Adds λ I. */
static void
add_even (gdouble information[6], gdouble even)
{
  for (guint k = 0; k < 3; k++)
    information[k] += even;
}

/* What a frame tells of a place that it saw. Returns whether it tells of all directions. Where it doesn't, y is
 * as sure as where it does: a smooth path of rays alone would be a small one, near the camera. */
static gboolean
add_seen (const ClothRecording * r, gsize at, gdouble information[6])
{
  const gdouble sigma = fmax (r->sigma, ROUNDING);
  const gdouble *draw;
  gdouble told[6] = { 0. }, rank;

  if (!r->noise) {
    add_even (information, 1. / (sigma * sigma));
    return TRUE;
  }
  draw = r->noise->draw + 6 * at;
  rank = round (draw[0] + draw[1] + draw[2]);
  cloth_recording_noise_add (r->noise, at, told);
  if (rank < 3.)
    add_even (information, (told[0] + told[1] + told[2]) / fmax (rank, 1.));
  for (guint k = 0; rank == 3. && k < 6; k++)
    information[k] += told[k];
  return rank == 3.;
}

/* What was seen of the vertex that a clamp holds, and where it was logged. Returns how many frames tell of
 * it. */
static guint
find_data (Path * p, guint held)
{
  const ClothRecording *r = p->r;
  const ClothScene *scene = r->scene;
  const guint vertex = g_array_index (scene->held, ClothHeld, held).vertex;
  guint n = 0;

  memcpy (p->origin, r->y + 3 * (gsize) vertex, sizeof p->origin);
  for (guint f = 0; f < p->n; f++) {
    const gsize at = (gsize) f * r->n + vertex;
    const gsize k = (gsize) f * scene->held->len + held;
    const gboolean logged = scene->clamps_sd[k] == 0.;
    gdouble *to = p->information + 6 * (gsize) f, near;

    memset (to, 0, 6 * sizeof *to);
    memset (p->y + 3 * (gsize) f, 0, 3 * sizeof *p->y);
    p->unsure[f] = 0.;
    /* what stands there is no place of a clamp */
    if (!is_held (r, held, f))
      continue;
    cloth_vec3_subtract (logged ? scene->clamps + 3 * k : r->y + 3 * at,
        p->origin, p->y + 3 * (gsize) f);
    if (logged) {
      add_even (to, 1. / (ROUNDING * ROUNDING));
      n++;
      continue;
    }
    if (r->seen[at] > 0.) {
      if (!add_seen (r, at, to))
        find_distance (r, f, vertex, &p->unsure[f]);
      n++;
      continue;
    }
    /* it may be off its neighbours by so much, and these where they are */
    near = find_distance (r, f, vertex, &p->unsure[f]);
    if (isfinite (near)) {
      add_even (to, 1. / (near * near));
      n++;
    }
  }
  return n;
}

static gdouble
penalty_at (const Path * p, guint row, guint i, guint j)
{
  const gdouble *w = p->differences + N_DIFFERENCE * (gsize) row;

  return w[i] * w[j];
}

/* z for a power. Returns the logarithm of its likelihood, but for a constant; −∞: it can't be told. */
static gdouble
smooth (Path * p, gdouble power)
{
  const guint order = 3 * p->n;
  gdouble square = 0., determinant = 0.;

  memset (p->factor, 0, (gsize) order * (BANDWIDTH + 1) * sizeof *p->factor);
  for (guint f = 0; f < p->n; f++) {
    static const guint of[3][3] = { {0, 5, 4}, {5, 1, 3}, {4, 3, 2} };
    const gdouble *information = p->information + 6 * (gsize) f;

    for (guint i = 0; i < 3; i++) {
      gdouble right = 0.;

      for (guint k = 0; k < 3; k++) {
        right += information[of[i][k]] * p->y[3 * (gsize) f + k];
        if (k <= i)
          CLOTH_BAND (p->factor, BANDWIDTH, 3 * f + i, 3 * f + k) +=
              information[of[i][k]];
      }
      p->z[3 * (gsize) f + i] = right;
    }
  }
  for (guint f = 0; f + N_DIFFERENCE <= p->n; f++)
    for (guint i = 0; i < N_DIFFERENCE; i++)
      for (guint j = 0; j <= i; j++)
        for (guint k = 0; k < 3; k++)
          CLOTH_BAND (p->factor, BANDWIDTH, 3 * (f + i) + k,
              3 * (f + j) + k) += penalty_at (p, f, i, j) / power;
  if (!cloth_band_factor (order, BANDWIDTH, p->factor))
    return -INFINITY;
  memcpy (p->right, p->z, order * sizeof *p->z);
  cloth_band_solve (order, BANDWIDTH, p->factor, 1, p->z);
  for (guint i = 0; i < order; i++) {
    determinant += 2. * log (CLOTH_BAND (p->factor, BANDWIDTH, i, i));
    square += (p->y[i] - p->z[i]) * p->right[i];
  }
  return -0.5 * (square + determinant + 3. * (p->n - N_DIFFERENCE + 1) *
      log (power));
}

static gboolean
find_path (Path * p, guint held, GError ** error)
{
  const ClothRecording *r = p->r;
  ClothScene *scene = r->scene;
  const guint order = 3 * p->n, n_held = scene->held->len;
  gdouble best = NAN, most = -INFINITY;
  guint n_told;
  g_autofree gdouble *variances = NULL;

  n_told = find_data (p, held);
  for (gdouble power = LEAST_POWER; n_told >= N_DIFFERENCE
      && power <= MOST_POWER; power *= POWER_STEP) {
    const gdouble likelihood = smooth (p, power);

    if (likelihood > most) {
      most = likelihood;
      best = power;
    }
  }
  if (isnan (best) || smooth (p, best) == -INFINITY) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: the "
        "path of the clamp of vertex %u was not logged, and %u frames that show "
        "the cloth don't tell it; give it as clamps.npy", r->name,
        g_array_index (scene->held, ClothHeld, held).vertex, n_told);
    return FALSE;
  }
  variances = g_new (gdouble, order);
  cloth_band_inverse_diagonal (order, BANDWIDTH, p->factor, variances);
  for (guint f = 0; f < p->n; f++) {
    const gsize k = (gsize) f * n_held + held;
    const gdouble *v = variances + 3 * (gsize) f;

    if (scene->clamps_sd[k] == 0. || !is_held (r, held, f))
      continue;
    for (guint c = 0; c < 3; c++)
      scene->clamps[3 * k + c] = p->origin[c] + p->z[3 * (gsize) f + c];
    /* interpolations are off by about the same for long, which no mean over frames makes less */
    scene->clamps_sd[k] = hypot (sqrt ((v[0] + v[1] + v[2]) / 3.),
        p->unsure[f]);
  }
  return TRUE;
}

/* @recording: a recording
 *
 * Puts held vertices that nobody saw where the paths have them that were found.
 */
void
cloth_recording_place_held (ClothRecording * recording)
{
  ClothRecording *r = recording;
  const GArray *held = r->scene->held;

  for (gsize k = 0; k < (gsize) r->n_frames * held->len; k++) {
    const guint i = (guint) (k % held->len), f = (guint) (k / held->len);
    const guint vertex = g_array_index (held, ClothHeld, i).vertex;
    const gsize at = (gsize) f * r->n + vertex;

    if (!cloth_scene_is_found (r->scene, k) || !is_held (r, i, f))
      continue;
    if (r->seen[at] == 0.)
      memcpy (r->y + 3 * at, r->scene->clamps + 3 * k, 3 * sizeof *r->y);
    if (f == 0)
      memcpy (r->scene->positions + 3 * (gsize) vertex,
          r->scene->clamps + 3 * k, 3 * sizeof *r->y);
  }
}

/* Whether nobody logged the place of a clamp while it held. */
static gboolean
is_open (const ClothRecording * r, gsize k)
{
  const guint n_held = r->scene->held->len;

  return isnan (r->scene->clamps[3 * k])
      && is_held (r, k % n_held, (guint) (k / n_held));
}

/* @recording: a recording
 *
 * Forgets the paths that were found, so that they can be found anew.
 */
void
cloth_recording_open_paths (ClothRecording * recording)
{
  ClothScene *scene = recording->scene;

  for (gsize k = 0; k < (gsize) recording->n_frames * scene->held->len; k++)
    for (guint c = 0; cloth_scene_is_found (scene, k) && c < 3; c++)
      scene->clamps[3 * k + c] = NAN;
}

/* @recording: a recording whose @y is known all over
 * @error: #ClothFitError when it can't be found
 *
 * Finds the paths of clamps where the scene's are NaN, and how well they are known. Held vertices that nobody
 * saw are put there.
 *
 * Returns: %FALSE when a path can't be found
 */
gboolean
cloth_recording_find_paths (ClothRecording * recording, GError ** error)
{
  ClothScene *scene = recording->scene;
  const guint n_held = scene->held->len;
  const gsize all = (gsize) recording->n_frames * n_held;
  g_autofree gboolean *open = g_new0 (gboolean, n_held + 1);
  const guint n = recording->n_frames;
  g_auto (Path) p = { recording, n };
  gboolean any = FALSE;

  for (gsize k = 0; k < all; k++)
    if (is_open (recording, k))
      open[k % n_held] = any = TRUE;
  if (!any)
    return TRUE;
  if (!scene->clamps_sd)
    scene->clamps_sd = g_new0 (gdouble, all);
  for (gsize k = 0; k < all; k++)
    if (is_open (recording, k))
      scene->clamps_sd[k] = INFINITY;
  p.information = g_new (gdouble, 6 * (gsize) n);
  p.y = g_new (gdouble, 3 * (gsize) n);
  p.unsure = g_new (gdouble, n);
  p.z = g_new (gdouble, 3 * (gsize) n);
  p.right = g_new (gdouble, 3 * (gsize) n);
  p.differences = g_new (gdouble, N_DIFFERENCE * (gsize) n);
  p.factor = g_new (gdouble, 3 * (gsize) n * (BANDWIDTH + 1));
  find_differences (&p);
  for (guint i = 0; i < n_held; i++)
    if (open[i] && !find_path (&p, i, error))
      return FALSE;
  cloth_recording_place_held (recording);
  return TRUE;
}
