/* Noise of a recording that differs from place to place and from direction to direction.
 *
 * Model: a place is recorded with an error N (0, Λ⁻¹), Λ = Σ of what each camera adds to the
 *   inverse covariance; along a direction that no camera tells of Λ is 0.
 * Formula: Λ = Σ λ_k e_k e_kᵀ. White: Λ^½ (x − y), which is N (0, I) on what is known. The
 *   observer draws along all that is known, W = I − d dᵀ on a ray d, else I: weaker springs along what is
 *   known less well let the cloth be chaotic there, and effects are named worse.
 * Reference: Strang, Introduction to Applied Mathematics, 1986, section 2.5 (weighted least
 *   squares).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/noise.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"
#include "gst/math/vec3.h"

/* Of a direction with less than this part of the best one's information nothing is known: it is
 * rounding. */
#define NOTHING 1e-9

static void
unpack (const gdouble s[6], gdouble m[9])
{
  const gdouble full[9] =
      { s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2] };

  memcpy (m, full, sizeof full);
}

/* @to may be @from. */
static void
multiply (const gdouble s[6], const gdouble from[3], gdouble to[3])
{
  const gdouble a[3] = { from[0], from[1], from[2] };

  to[0] = s[0] * a[0] + s[5] * a[1] + s[4] * a[2];
  to[1] = s[5] * a[0] + s[1] * a[1] + s[3] * a[2];
  to[2] = s[4] * a[0] + s[3] * a[1] + s[2] * a[2];
}

/* Σ f_k e_k e_kᵀ of the rows e_k: xx, yy, zz, yz, xz, xy. */
static void
compose (const gdouble f[3], const gdouble e[9], gdouble s[6])
{
  memset (s, 0, 6 * sizeof *s);
  for (guint k = 0; k < 3; k++)
    for (guint i = 0; i < 3; i++) {
      s[i] += f[k] * e[3 * k + i] * e[3 * k + i];
      s[3 + i] += f[k] * e[3 * k + (i + 1) % 3] * e[3 * k + (i + 2) % 3];
    }
}

/* @noise: noise
 * @at: which place
 * @information: its inverse covariance: xx, yy, zz, yz, xz, xy, 1/m²; of rank 3, 2 when nothing is
 *   known along one direction, or 1 when only that along one is known
 * @least: directions with less than this share of the best one's information count as not known
 *
 * Returns: %FALSE when it is none; then nothing is known of the place
 */
gboolean
cloth_recording_noise_set (ClothRecordingNoise * noise, gsize at,
    const gdouble information[6], gdouble least)
{
  gdouble m[9], values[3], vectors[9], roots[3], known[3], sum = 0.;
  gboolean is_one = TRUE;

  memset (noise->white + 6 * at, 0, 6 * sizeof (gdouble));
  memset (noise->draw + 6 * at, 0, 6 * sizeof (gdouble));
  for (guint k = 0; k < 6; k++)
    sum += information[k];
  unpack (information, m);
  if (!isfinite (sum) || !cloth_sym_eigen (3, m, values, vectors)
      || !(values[2] > 0.))
    return FALSE;
  /* they ascend */
  for (guint k = 0; k < 3; k++) {
    if (values[k] < -NOTHING * values[2])
      return FALSE;
    known[k] = values[k] > fmax (least, NOTHING) * values[2];
    roots[k] = known[k] > 0. ? sqrt (values[k]) : 0.;
    is_one = is_one && known[k] > 0.;
  }
  compose (roots, vectors, noise->white + 6 * at);
  if (is_one)
    noise->draw[6 * at] = noise->draw[6 * at + 1] = noise->draw[6 * at + 2] =
        1.;
  else
    compose (known, vectors, noise->draw + 6 * at);
  return TRUE;
}

/* @noise: noise
 * @at: which place, one that is set
 * @information: (inout): what its inverse covariance is added to, 1/m²
 */
void
cloth_recording_noise_add (const ClothRecordingNoise * noise, gsize at,
    gdouble information[6])
{
  const gdouble *s = noise->white + 6 * at;

  for (guint k = 0; k < 3; k++) {
    const guint a = (k + 1) % 3, b = (k + 2) % 3;

    /* the root's square: rows a and b of the off-diagonal element k */
    information[k] += s[k] * s[k] + s[3 + a] * s[3 + a] + s[3 + b] * s[3 + b];
    information[3 + k] += s[3 + k] * (s[a] + s[b]) + s[3 + a] * s[3 + b];
  }
}

/* @noise: noise of places A x
 * @matrix: A, a turn, mirror image or scale, row by row
 *
 * Returns: (transfer full): that of x: AᵀΛA
 */
ClothRecordingNoise *
cloth_recording_noise_map (const ClothRecordingNoise * noise,
    const gdouble matrix[9])
{
  ClothRecordingNoise *mapped = cloth_recording_noise_new (noise->n);

  mapped->square = noise->square / pow (fabs (cloth_mat3_det (matrix)),
      2. / 3.);
  for (gsize at = 0; at < noise->n; at++) {
    gdouble information[6] = { 0. }, full[9], half[9];

    cloth_recording_noise_add (noise, at, information);
    unpack (information, full);
    cloth_mat3_mul (full, matrix, half);
    cloth_mat3_mul_tn (matrix, half, full);
    for (guint k = 0; k < 3; k++) {
      information[k] = full[4 * k];
      information[3 + k] = full[3 * ((k + 1) % 3) + (k + 2) % 3];
    }
    cloth_recording_noise_set (mapped, at, information, 0.);
  }
  return mapped;
}

/* Eigenvalues of the root of an information, and its vectors. */
static void
take_apart (const ClothRecordingNoise * noise, gsize at, gdouble roots[3],
    gdouble vectors[9])
{
  gdouble m[9];

  unpack (noise->white + 6 * at, m);
  if (!cloth_sym_eigen (3, m, roots, vectors))
    memset (roots, 0, 3 * sizeof *roots);
  /* they ascend */
  for (guint k = 0; k < 3; k++)
    if (roots[k] * roots[k] <= NOTHING * roots[2] * roots[2])
      roots[k] = 0.;
}

/* @noise: noise
 * @at: which place, one that is set
 * @pull: Λ times a way, 1/m
 * @way: (out): the shortest such way, m: Λ⁺ @pull
 *
 * Returns: root of the information along the direction that is known best, 1/m
 */
gdouble
cloth_recording_noise_solve (const ClothRecordingNoise * noise, gsize at,
    const gdouble pull[3], gdouble way[3])
{
  gdouble roots[3], vectors[9];

  take_apart (noise, at, roots, vectors);
  memset (way, 0, 3 * sizeof *way);
  for (guint k = 0; k < 3; k++) {
    const gdouble *e = vectors + 3 * k;

    for (guint i = 0; roots[k] > 0. && i < 3; i++)
      way[i] += cloth_vec3_dot (e, pull) / (roots[k] * roots[k]) * e[i];
  }
  return roots[2];
}

/* @noise: noise of which every place that was seen is set
 * @seen: (array): not 0 where
 *
 * Works out what follows from it.
 *
 * Returns: the usual standard deviation of a coordinate, m: that of the median information; NaN
 *   when nothing was seen
 */
gdouble
cloth_recording_noise_finish (ClothRecordingNoise * noise, const gdouble * seen)
{
  g_autoptr (GArray) all = g_array_new (FALSE, FALSE, sizeof (gdouble));
  gdouble sum = 0.;

  for (gsize at = 0; at < noise->n; at++) {
    gdouble roots[3], vectors[9], information = 0., known = 0.;

    if (seen[at] == 0.)
      continue;
    take_apart (noise, at, roots, vectors);
    for (guint k = 0; k < 3; k++) {
      if (!(roots[k] > 0.))
        continue;
      information += roots[k] * roots[k];
      sum += 1. / (roots[k] * roots[k]);
      known += 1.;
    }
    information /= fmax (known, 1.);
    g_array_append_val (all, information);
  }
  if (all->len == 0)
    return NAN;
  noise->square = sum / all->len;
  return 1. / sqrt (cloth_median ((gdouble *) all->data, all->len));
}

/* @recording: a recording
 *
 * Returns: mean square of the error of a place along what is known of it, m²
 */
gdouble
cloth_recording_noise_square (const ClothRecording * recording)
{
  return recording->noise ? recording->noise->square :
      3. * recording->sigma * recording->sigma;
}

/* @recording: a recording
 * @at: which place: frame times vertices plus vertex
 * @off: a distance from it, m
 * @white: (out): in standard deviations; may be @off
 */
void
cloth_recording_whiten (const ClothRecording * recording, gsize at,
    const gdouble off[3], gdouble white[3])
{
  multiply (recording->noise->white + 6 * at, off, white);
}

/* @recording: a recording
 * @at: which place, one that was seen
 * @off: (inout): a distance from it, m: what of it lies along directions of which nothing is known is
 *   taken away
 */
void
cloth_recording_cut_blind (const ClothRecording * recording, gsize at,
    gdouble off[3])
{
  if (recording->noise && recording->seen[at] != 0.)
    multiply (recording->noise->draw + 6 * at, off, off);
}

/* @recording: a recording
 * @at: which place
 * @scale: of the noise
 * @random: where chance comes from
 * @place: (inout): gets an error like the recording's there, m; one that was not seen none that
 *   differs from place to place, and none where a simulation has it
 */
void
cloth_recording_add_noise (const ClothRecording * recording, gsize at,
    gdouble scale, ClothRandom * random, gdouble place[3])
{
  gdouble roots[3], vectors[9], error[3];

  for (guint k = 0; k < 3; k++)
    error[k] = scale * cloth_random_gaussian (random);
  if (recording->simulated && recording->seen[at] == 0.)
    return;
  if (!recording->noise || recording->seen[at] == 0.) {
    for (guint k = 0; k < 3; k++)
      place[k] += recording->sigma * error[k];
    return;
  }
  take_apart (recording->noise, at, roots, vectors);
  for (guint k = 0; k < 3; k++)
    for (guint i = 0; i < 3; i++)
      place[i] += roots[k] > 0. ? error[k] / roots[k] * vectors[3 * k + i] : 0.;
}
