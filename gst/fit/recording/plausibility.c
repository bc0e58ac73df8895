/* Recordings that can't be what they say they are: other units, other axes, other vertices.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/plausibility.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/signal.h"
#include "gst/math/statistics.h"

/* Frames that lengths of edges are looked at in. */
#define N_LOOKS 8
/* Neighbours are never this many times the cloth's longest side apart. */
#define FAR 10.
/* A clamp begins no further from the vertex that it holds than this share of that side;
 * in so many frames that saw the vertex. */
#define NEAR 0.5
#define N_FIRST 5
/* Noise beyond this share of an edge hides the cloth. */
#define MOST_NOISE 0.5
/* No laboratory has more gravity, m/s². */
#define MOST_GRAVITY 100.
/* No cloth that is filmed is longer, m. */
#define MOST_SIDE 100.
/* Numbers of a file may be this share of an edge, or of the time between frames, apart. */
#define MOST_ROUNDING 0.01

static gboolean
is_seen (const ClothRecording * r, guint frame, guint v)
{
  return r->seen[(gsize) frame * r->n + v] > 0.;
}

static gdouble
distance (const gdouble * a, const gdouble * b)
{
  return sqrt (pow (a[0] - b[0], 2.) + pow (a[1] - b[1], 2.) +
      pow (a[2] - b[2], 2.));
}

static const gdouble *
place (const ClothRecording * r, guint frame, guint v)
{
  return r->y + 3 * ((gsize) frame * r->n + v);
}

static gdouble
flat_length (const ClothTopology * t, guint a, guint b)
{
  return hypot (t->uv[2 * (gsize) a] - t->uv[2 * (gsize) b],
      t->uv[2 * (gsize) a + 1] - t->uv[2 * (gsize) b + 1]);
}

static gdouble
typical_edge (const ClothTopology * t)
{
  g_autoptr (GArray) lengths = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint f = 0; f < t->n_faces; f++) {
    const guint32 *face = t->faces + 4 * (gsize) f;
    gdouble flat = flat_length (t, face[0], face[1]);

    if (flat > 0.)
      g_array_append_val (lengths, flat);
  }
  return cloth_median ((gdouble *) lengths->data, lengths->len);
}

/* @recording: a recording; what was not seen is left out
 * @corner: 0: edges from each face's first corner to the second, along one way of a grid; 1:
 *   from the second to the third, along the other
 * @sigma: noise of a coordinate that is taken off, m
 *
 * Returns: how many times as long as on the flat cloth such edges are, the median; NaN: none
 *   was seen
 */
gdouble
cloth_recording_find_scale (const ClothRecording * recording, guint corner,
    gdouble sigma)
{
  const ClothRecording *r = recording;
  const ClothTopology *t = r->scene->topology;
  g_autoptr (GArray) ratios = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint look = 0; look < N_LOOKS; look++)
    for (guint f = 0; f < t->n_faces; f++) {
      const guint32 *face = t->faces + 4 * (gsize) f;
      guint a = face[corner], b = face[corner + 1];
      guint frame = (guint) ((guint64) look * (r->n_frames - 1) /
          (N_LOOKS - 1));
      gdouble flat = flat_length (t, a, b), ratio;

      if (!(flat > 0.) || !is_seen (r, frame, a) || !is_seen (r, frame, b))
        continue;
      ratio = distance (place (r, frame, a), place (r, frame, b));
      /* noise makes edges longer: by the variance of six coordinates */
      ratio = sqrt (fmax (ratio * ratio - 6. * sigma * sigma, 0.)) / flat;
      g_array_append_val (ratios, ratio);
    }
  return cloth_median ((gdouble *) ratios->data, ratios->len);
}

/* @recording: a recording
 *
 * Returns: the longer side of its flat cloth, m
 */
gdouble
cloth_recording_longest_side (const ClothRecording * recording)
{
  const ClothTopology *t = recording->scene->topology;
  gdouble longest = 0.;

  for (guint k = 0; k < 2; k++) {
    gdouble low = INFINITY, high = -INFINITY;

    for (gsize i = 0; i < t->n_vertices; i++) {
      low = MIN (low, t->uv[2 * i + k]);
      high = MAX (high, t->uv[2 * i + k]);
    }
    longest = MAX (longest, high - low);
  }
  return longest;
}

/* A cloth's edges are about as long as on the flat cloth, in metres: both ways of a grid. */
static gboolean
check_scale (const ClothRecording * r, GError ** error)
{
  for (guint corner = 0; corner < 2; corner++) {
    gdouble ratio = cloth_recording_find_scale (r, corner, 0.);

    if (isnan (ratio) || (ratio > 0.5 && ratio < 2.))
      continue;
    if (ratio > 500. && ratio < 2000.)
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "%s: edges "
          "are %.0f times as long as on the flat cloth: positions.npy is in "
          "millimetres; write it in metres", r->name, ratio);
    else
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "%s: edges "
          "are %.3g times as long as on the flat cloth; positions.npy and the "
          "size of the cloth must both be in metres, the vertices in the order "
          "of the mesh", r->name, ratio);
    return FALSE;
  }
  return TRUE;
}

/* One place far off the cloth would tear every simulation that is drawn to it. */
static gboolean
check_places (const ClothRecording * r, gdouble side, GError ** error)
{
  const ClothTopology *t = r->scene->topology;

  for (guint frame = 0; frame < r->n_frames; frame++)
    for (guint f = 0; f < t->n_faces; f++) {
      const guint32 *face = t->faces + 4 * (gsize) f;
      guint corners = face[3] == CLOTH_NO_VERTEX ? 3 : 4;

      for (guint i = 0; i < corners; i++) {
        guint a = face[i], b = face[(i + 1) % corners];
        gdouble apart = distance (place (r, frame, a), place (r, frame, b));

        if (is_seen (r, frame, a) && is_seen (r, frame, b)
            && !(apart < FAR * side)) {
          g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
              "%s: in frame %u the vertices %u and %u, neighbours on a cloth of "
              "%.3g m, are %.3g m apart; write NaN where a vertex was not seen",
              r->name, frame, a, b, side, apart);
          return FALSE;
        }
      }
    }
  return TRUE;
}

/* How far a clamp's path, times @scale, begins from the vertex that it holds; NaN: that
 * was not seen. */
static gdouble
find_start (const ClothRecording * r, guint held, gdouble scale)
{
  const ClothHeld *h = &g_array_index (r->scene->held, ClothHeld, held);
  gdouble nearest = NAN;
  guint seen = 0;

  for (guint frame = 0; frame < r->n_frames && seen < N_FIRST; frame++) {
    const gsize k = (gsize) frame * r->scene->held->len + held;
    const gdouble *clamp = r->scene->clamps + 3 * k;
    const gdouble at[3] = { scale * clamp[0], scale * clamp[1],
      scale * clamp[2]
    };

    if (!cloth_held_holds (h, r->times[frame])
        || !is_seen (r, frame, h->vertex) || cloth_scene_is_found (r->scene, k))
      continue;
    nearest = fmin (nearest, distance (at, place (r, frame, h->vertex)));
    seen++;
  }
  return nearest;
}

/* @recording: a recording as it was read
 * @error: #ClothFitError
 *
 * Returns: %FALSE when a clamp does not begin where its vertex is seen
 */
gboolean
cloth_recording_check_clamps (const ClothRecording * recording, GError ** error)
{
  const ClothRecording *r = recording;
  const gdouble side = cloth_recording_longest_side (r);

  for (guint i = 0; i < r->scene->held->len; i++) {
    guint vertex = g_array_index (r->scene->held, ClothHeld, i).vertex;
    gdouble off = find_start (r, i, 1.);

    if (isnan (off) || off < NEAR * side)
      continue;
    if (find_start (r, i, 1e-3) < NEAR * side)
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "%s: the clamp "
          "of vertex %u begins %.3g m from where the vertex is seen: clamps.npy "
          "is in millimetres; write it in metres", r->name, vertex, off);
    else
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "%s: the clamp "
          "of vertex %u begins %.3g m from where the vertex is seen; "
          "positions.npy and clamps.npy must have the same axes and units, the "
          "vertices the order of the mesh (not mirrored), and the clamps that "
          "of “held”", r->name, vertex, off);
    return FALSE;
  }
  return TRUE;
}

/* float32 can't tell places apart that are far from the origin, nor float64 times. */
static gboolean
check_rounding (const ClothRecording * r, gdouble edge, GError ** error)
{
  gdouble interval = cloth_recording_get_frame_s (r);
  gdouble late = fmax (fabs (r->times[0]), fabs (r->times[r->n_frames - 1]));
  gdouble far = 0.;

  for (gsize i = 0; i < 3 * (gsize) r->n * r->n_frames; i++)
    far = fmax (far, fabs (r->y[i]));
  if (far * FLT_EPSILON > MOST_ROUNDING * edge) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "%s: places "
        "lie up to %.3g m from the origin, where positions.npy holds them to "
        "%.2g m only; move the origin near to the cloth, and write NaN where a "
        "vertex was not seen", r->name, far, far * FLT_EPSILON);
    return FALSE;
  }
  if (late * DBL_EPSILON > MOST_ROUNDING * interval) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: times "
        "reach %.3g s, where numbers are %.2g s apart; begin them near 0 in "
        "times.npy and “held”", r->name, late, late * DBL_EPSILON);
    return FALSE;
  }
  return TRUE;
}

static gboolean
check_numbers (const ClothRecording * r, gdouble side, GError ** error)
{
  const gdouble *g = r->scene->gravity;
  const gdouble none[3] = { 0. };

  if (side > MOST_SIDE) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "%s: the cloth "
        "is %.3g m long; give its size in metres, and so positions.npy and "
        "clamps.npy", r->name, side);
    return FALSE;
  }
  if (distance (g, none) > MOST_GRAVITY) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "%s: “gravity” is %.3g m/s²; give it in m/s², on earth 9.81",
        r->name, distance (g, none));
    return FALSE;
  }
  return TRUE;
}

static gboolean
check_noise (const ClothRecording * r, gboolean told, gdouble edge,
    GError ** error)
{
  if (!(r->sigma > MOST_NOISE * edge))
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
      "%s: noise of " "%.3g m hides a cloth whose edges are %.3g m long; %s",
      r->name, r->sigma, edge,
      told ? "“noise_sigma_m” is in metres, null estimates it" :
      "it was estimated from jumps between frames: mind the order of frames and "
      "vertices, film more frames a second, or give “noise_sigma_m” in metres");
  return FALSE;
}

/* @recording: a recording as it was read: what was not seen is not bridged yet
 * @told: whether its noise is what take.json says; else it was estimated
 * @error: #ClothFitError
 *
 * Returns: %FALSE when it contradicts its cloth: units, places that no cloth can be in, noise
 *   that hides it
 */
gboolean
cloth_recording_check_cloth (const ClothRecording * recording, gboolean told,
    GError ** error)
{
  gdouble side = cloth_recording_longest_side (recording);
  gdouble edge = typical_edge (recording->scene->topology);

  return check_numbers (recording, side, error)
      && check_rounding (recording, edge, error)
      && check_scale (recording, error)
      && check_places (recording, side, error)
      && check_noise (recording, told, edge, error);
}

/* @recording: a recording as it was read
 * @told: as of cloth_recording_check_cloth ()
 * @error: #ClothFitError
 *
 * Returns: %FALSE when it contradicts its cloth or itself: clamps are not where they hold
 */
gboolean
cloth_recording_check (const ClothRecording * recording, gboolean told,
    GError ** error)
{
  return cloth_recording_check_cloth (recording, told, error)
      && cloth_recording_check_clamps (recording, error);
}

/* @recording: a recording that cloth_recording_check () accepts, with the paths of its clamps
 * @error: #ClothFileError
 *
 * Returns: as cloth_scene_check_paths ()
 */
gboolean
cloth_recording_check_paths (const ClothRecording * recording, GError ** error)
{
  if (cloth_scene_check_paths (recording->scene, error))
    return TRUE;
  g_prefix_error (error, "%s: ", recording->name);
  return FALSE;
}

/* @recording: a recording
 * @other: another of the same cloth
 * @error: #ClothFitError
 *
 * Returns: %FALSE when both hold the same positions: what judges must not be judged
 */
gboolean
cloth_recording_check_other (const ClothRecording * recording,
    const ClothRecording * other, GError ** error)
{
  const ClothRecording *r = recording;

  if (r->n != other->n || r->n_frames != other->n_frames
      || memcmp (r->y, other->y, 3 * (gsize) r->n * r->n_frames *
          sizeof *r->y) != 0)
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
      "%s and %s hold "
      "the same positions; a take, a --baseline and a --hold-out must be "
      "recordings of their own", other->name, r->name);
  return FALSE;
}
