/* Twins: what another simulator made of a recorded scene, at the recording's vertices and times.
 *
 * Model: the simulator's cloth is a surface over the flat cloth, linear within each triangle of its
 *   mesh (flat-map.c). In time each vertex runs along the cubic through the four frames about it.
 * Assumption: both meshes are of one flat cloth, and their uv differ by rounding only.
 * Formulas: x (u, t) = Σⱼ Lⱼ (t) Σᵢ bᵢ (u) xᵢⱼ, with b barycentric and L the cubic's Lagrange weights.
 *   The cubic is off by |Π (t − tⱼ)| |x⁗|/24. With every other frame left out that shows: e₂,
 *   with three of four e₄. Errors fall by the order that these two show, at most 4: between
 *   frames e₁ = max (e₂/16, e₂²/e₄).
 * Reference: Richardson, Phil. Trans. A 226, 1927 (errors from two step lengths).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/twin.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/flat-map.h"
#include "gst/fit/recording/interpolation.h"
#include "gst/fit/recording/plausibility.h"
#include "gst/fit/recording/signal.h"
#include "gst/math/statistics.h"
#include "gst/math/vec3.h"

/* Numbers of two files that mean the same differ by no more than this share of the cloth's longest
 * side, or of the time between frames: text has four digits at least. */
#define ROUNDING 1e-4
/* Neighbours are never this many times the cloth's longest side apart (see plausibility.c). */
#define FAR 10.
/* Frames that a cubic needs. */
#define N_CUBIC 4
/* Π |t − tⱼ| midway between even frames, in fourth powers of the time between them. */
#define MIDWAY (9. / 16.)
/* What is not known between its frames is at most this share of how far a twin is from the recording, or no more than
 * noise: a hundredth of the gap's square. */
#define LEAST_KNOWN 0.1
/* How often paths that differ by noise alone are taken for others. */
#define FALSE_ALARM 0.01

/* The weights of a cubic through four frames. */
typedef struct
{
  guint first;
  gdouble weights[N_CUBIC];
  gdouble width;                /* of its error: that midway between frames is 1 */
} Moment;

/* Through the frames first, first + stride …; those before and behind are extrapolated from. */
static void
find_cubic (const gdouble * times, guint first, guint stride, gdouble at,
    Moment * moment)
{
  gdouble product = 1.;
  const gdouble step = (times[first + 3 * stride] - times[first]) / 3.;

  moment->first = first;
  for (guint i = 0; i < N_CUBIC; i++) {
    const gdouble own = times[first + i * stride];

    moment->weights[i] = 1.;
    product *= (at - own) / step;
    for (guint j = 0; j < N_CUBIC; j++)
      if (j != i)
        moment->weights[i] *= (at - times[first + j * stride]) /
            (own - times[first + j * stride]);
  }
  moment->width = fabs (product) / MIDWAY;
}

/* The twin under way. */
typedef struct
{
  const ClothRecording *recorded;
  ClothTake *take;
  gchar *name;                  /* of its folder */
  const gdouble *times;
  guint n_frames;
  gdouble side;                 /* the cloth's longest, m */
  gdouble noise;                /* that its positions are said to have, m */
  ClothScene *scene;            /* of the simulation */
  gboolean begins_torn;
  gboolean same_vertices;       /* as recorded */
  ClothFlatPlace *places;       /* of the recorded vertices */
  Moment *moments;              /* of the recorded frames */
  gfloat *samples;              /* of its own frames, [n_frames][recorded->n][3], m */
} Twin;

static void
twin_clear (Twin * t)
{
  g_free (t->name);
  cloth_scene_free (t->scene);
  g_free (t->places);
  g_free (t->moments);
  g_free (t->samples);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Twin, twin_clear);

static gboolean
G_GNUC_PRINTF (3, 4)
refuse (const Twin * t, GError ** error, const gchar * format, ...)
{
  g_autofree gchar *what = NULL;
  va_list list;

  va_start (list, format);
  what = g_strdup_vprintf (format, list);
  va_end (list);
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
      "%s is no simulation of %s: %s", t->name, t->recorded->name, what);
  return FALSE;
}

static gboolean
are_near (const gdouble * a, const gdouble * b, guint n, gdouble slack)
{
  for (guint k = 0; k < n; k++)
    if (!(fabs (a[k] - b[k]) <= slack))
      return FALSE;
  return TRUE;
}

/* Friction is what a simulation assumes, not what it is given. */
static gboolean
is_same_obstacle (const ClothObstacle * a, const ClothObstacle * b,
    gdouble slack)
{
  if (a->kind != b->kind || a->n_points != b->n_points
      || a->n_triangles != b->n_triangles
      || !are_near (a->point, b->point, 3, slack)
      || !are_near (a->end, b->end, 3, slack)
      || !are_near (a->normal, b->normal, 3, ROUNDING)
      || !are_near (&a->radius_m, &b->radius_m, 1, slack))
    return FALSE;
  return are_near (a->points, b->points, 3 * a->n_points, slack)
      && (!a->n_triangles || memcmp (a->triangles, b->triangles,
          3 * (gsize) a->n_triangles * sizeof *a->triangles) == 0);
}

static gboolean
check_world (const Twin * t, GError ** error)
{
  const ClothScene *s = t->scene, *r = t->recorded->scene;

  if (!are_near (s->gravity, r->gravity, 3,
          ROUNDING * fmax (cloth_vec3_length (r->gravity), 1.)))
    return refuse (t, error,
        "its “gravity” is %g, %g, %g m/s², that of the "
        "recording %g, %g, %g; simulate the recorded scene", s->gravity[0],
        s->gravity[1], s->gravity[2], r->gravity[0], r->gravity[1],
        r->gravity[2]);
  if (s->obstacles->len != r->obstacles->len)
    return refuse (t, error, "it has %u “obstacles”, the recording %u; "
        "simulate the recorded scene", s->obstacles->len, r->obstacles->len);
  for (guint i = 0; i < r->obstacles->len; i++)
    if (!is_same_obstacle (&g_array_index (s->obstacles, ClothObstacle, i),
            &g_array_index (r->obstacles, ClothObstacle, i),
            ROUNDING * t->side))
      return refuse (t, error,
          "number %u of its “obstacles” is another one "
          "than the recording's, or elsewhere; simulate the recorded scene",
          i + 1);
  return TRUE;
}

static ClothFlatPlace
place_of_vertex (guint vertex)
{
  ClothFlatPlace place = { {0} };

  place.corners[0] = vertex;
  place.weights[0] = 1.;
  return place;
}

/* A mesh of the recorded vertices, whatever its faces. */
static gboolean
has_same_vertices (const Twin * t)
{
  const ClothTopology *cloth = t->recorded->scene->topology;
  const ClothTopology *own = t->scene->topology;

  if (own->n_vertices != cloth->n_vertices)
    return FALSE;
  for (gsize i = 0; i < 2 * (gsize) cloth->n_vertices; i++)
    if (!(fabs ((gdouble) own->uv[i] - cloth->uv[i]) <= ROUNDING * t->side))
      return FALSE;
  return TRUE;
}

/* Sewn together, or nothing but two copies of one. */
static gboolean
are_one (const Twin * t, guint32 a, guint32 b)
{
  const ClothRecording *r = t->recorded;
  const GArray *seams = r->scene->seams;

  for (guint i = 0; i < seams->len; i++) {
    const ClothSeam *seam = &g_array_index (seams, ClothSeam, i);

    if ((seam->a == a && seam->b == b) || (seam->a == b && seam->b == a))
      return TRUE;
  }
  return are_near (r->y + 3 * (gsize) a, r->y + 3 * (gsize) b, 3,
      ROUNDING * t->side);
}

/* No place of the flat cloth is that of two vertices, unless these are one: uv would not tell them apart. */
static gboolean
check_overlap (const Twin * t, GError ** error)
{
  const ClothTopology *cloth = t->recorded->scene->topology;
  g_autoptr (ClothFlatMap) map = cloth_flat_map_new (cloth, 0.);

  for (guint32 v = 0; v < cloth->n_vertices; v++) {
    const gfloat *uv = cloth->uv + 2 * (gsize) v;
    const ClothFlatPlace place = cloth_flat_map_locate (map, uv);
    gboolean same = FALSE;

    for (guint c = 0; c < 4 && !same; c++)
      same = place.weights[c] > 0. && (place.corners[c] == v
          || are_one (t, place.corners[c], v));
    if (!same && place.outside <= 0.)
      return refuse (t, error, "its mesh is another one, and the recording's "
          "vertex %u lies where there is other cloth too, at (%g, %g) m on the "
          "flat cloth; simulate the recording's mesh, or lay its panels beside "
          "each other in its uv", v, uv[0], uv[1]);
  }
  return TRUE;
}

/* Both are of one flat cloth, and every recorded vertex has a place on the other mesh. */
static gboolean
check_cloth (Twin * t, GError ** error)
{
  const ClothTopology *cloth = t->recorded->scene->topology;
  const gdouble slack = ROUNDING * t->side;
  gdouble low[2], high[2], own_low[2], own_high[2];
  g_autoptr (ClothFlatMap) map = NULL;

  cloth_flat_map_find_extent (cloth, low, high);
  cloth_flat_map_find_extent (t->scene->topology, own_low, own_high);
  for (guint k = 0; k < 2; k++)
    if (!(fabs (high[k] - low[k] - own_high[k] + own_low[k]) <= 2. * slack))
      return refuse (t, error, "its cloth is %g×%g m flat, that of the "
          "recording %g×%g m; simulate the recorded cloth, its size in metres",
          own_high[0] - own_low[0], own_high[1] - own_low[1],
          high[0] - low[0], high[1] - low[1]);
  t->places = g_new (ClothFlatPlace, cloth->n_vertices);
  t->same_vertices = has_same_vertices (t);
  for (guint v = 0; v < cloth->n_vertices && t->same_vertices; v++)
    t->places[v] = place_of_vertex (v);
  if (t->same_vertices)
    return TRUE;
  if (!check_overlap (t, error))
    return FALSE;
  map = cloth_flat_map_new (t->scene->topology, slack);
  for (guint v = 0; v < cloth->n_vertices; v++) {
    const gfloat *uv = cloth->uv + 2 * (gsize) v;

    t->places[v] = cloth_flat_map_locate (map, uv);
    if (t->places[v].outside <= slack)
      continue;
    return refuse (t, error, "its mesh has no cloth at (%g, %g) m on the flat "
        "cloth, where vertex %u of the recording is; give both the same uv, in "
        "metres from the same corner", uv[0], uv[1], v);
  }
  return TRUE;
}

/* A frame is as long as they are on the mean. */
static gdouble
frame_length (const gdouble * times, guint n)
{
  return (times[n - 1] - times[0]) / (n - 1);
}

/* Where the recorded times lie between the simulation's own. */
static gboolean
find_moments (Twin * t, GError ** error)
{
  const ClothRecording *r = t->recorded;
  const guint last = t->n_frames - 1;
  const gdouble frame = frame_length (t->times, t->n_frames);
  const gdouble most = (1. + ROUNDING) * fmax (frame,
      frame_length (r->times, r->n_frames));
  const gdouble early = t->times[0] - r->times[0];
  const gdouble short_by = r->times[r->n_frames - 1] - t->times[last];

  if (early > most)
    return refuse (t, error, "it begins at %g s, %.3g s after the recording; "
        "simulate from its first frame on, with its times", t->times[0], early);
  if (short_by > most)
    return refuse (t, error, "it ends at %g s, %.3g s before the recording; "
        "simulate all of it", t->times[last], short_by);
  t->moments = g_new0 (Moment, r->n_frames);
  for (guint i = 0, f = 0; i < r->n_frames; i++) {
    const gdouble at = r->times[i];
    Moment *m = &t->moments[i];
    guint nearest;

    while (f < last && t->times[f + 1] <= at)
      f++;
    nearest = f < last && t->times[f + 1] - at < at - t->times[f] ? f + 1 : f;
    if (fabs (t->times[nearest] - at) <= ROUNDING * frame) {
      m->first = MIN (nearest, t->n_frames - N_CUBIC);
      m->weights[nearest - m->first] = 1.;
    } else {
      find_cubic (t->times, CLAMP (f, 1, t->n_frames - N_CUBIC + 1) - 1, 1, at,
          m);
    }
  }
  return TRUE;
}

static gboolean
is_finite (const gfloat * p)
{
  return isfinite (p[0]) && isfinite (p[1]) && isfinite (p[2]);
}

/* Whether a cloth can be where a frame has it: its neighbours are not torn apart. */
static gboolean
check_frame (Twin * t, guint frame, const gfloat * positions, GError ** error)
{
  const ClothTopology *cloth = t->scene->topology;
  gboolean any = FALSE;

  for (gsize v = 0; v < cloth->n_vertices && !any; v++)
    any = is_finite (positions + 3 * v);
  if (!any)
    return refuse (t, error, "in frame %u, at %g s, no position is a number; "
        "let it not diverge: smaller steps, more damping, softer cloth",
        frame, t->times[frame]);
  /* what is torn from the beginning has other units or vertices, which is told later */
  for (guint f = 0; f < cloth->n_faces && !t->begins_torn; f++) {
    const guint32 *face = cloth->faces + 4 * (gsize) f;
    guint n = cloth_face_corners (face);

    for (guint i = 0; i < n; i++) {
      const gfloat *a = positions + 3 * (gsize) face[i];
      const gfloat *b = positions + 3 * (gsize) face[(i + 1) % n];
      gdouble apart = sqrt (pow ((gdouble) a[0] - b[0], 2.) +
          pow ((gdouble) a[1] - b[1], 2.) + pow ((gdouble) a[2] - b[2], 2.));

      if (!is_finite (a) || !is_finite (b) || apart < FAR * t->side)
        continue;
      t->begins_torn = frame == 0;
      if (frame)
        return refuse (t, error, "it diverges: in frame %u, at %g s, its "
            "vertices %u and %u, neighbours, are %.3g m apart; smaller steps, "
            "more damping or softer cloth help", frame, t->times[frame],
            face[i], face[(i + 1) % n], apart);
    }
  }
  return TRUE;
}

/* Reads the frames, each at the recorded vertices; NaN where a corner has no position. */
static gboolean
read_frames (Twin * t, GError ** error)
{
  const gsize row = 3 * (gsize) t->recorded->n;
  g_autofree gfloat *positions = g_new (gfloat,
      3 * (gsize) t->scene->topology->n_vertices);

  if (row * t->n_frames > CLOTH_MAX_BUFFER / sizeof *t->samples)
    return refuse (t, error, "%u frames of %u vertices are more than can be "
        "compared; write fewer frames a second", t->n_frames, t->recorded->n);
  t->samples = g_new0 (gfloat, row * t->n_frames);
  for (guint frame = 0; frame < t->n_frames; frame++) {
    gfloat *to = t->samples + frame * row;

    if (!cloth_take_read_positions (t->take, frame, positions, error)
        || !check_frame (t, frame, positions, error))
      return FALSE;
    for (gsize i = 0; i < row; i++) {
      const ClothFlatPlace *p = &t->places[i / 3];
      gdouble sum = 0.;

      for (guint c = 0; c < 4; c++)
        if (p->weights[c] > 0.)
          sum += p->weights[c] * positions[3 * (gsize) p->corners[c] + i % 3];
      to[i] = (gfloat) sum;
    }
  }
  return TRUE;
}

/* Of a coordinate, m, when a cubic through every @stride-th frame stands for those midway: what is
 * more than the simulation's own noise makes. NaN: it is too short to tell. */
static gdouble
find_error (const Twin * t, guint stride)
{
  const guint half = stride / 2, row = 3 * t->recorded->n;
  gdouble sum = 0., count = 0.;

  for (guint f = 0; f + 3 * stride < t->n_frames; f++) {
    const guint at = f + stride + half;
    gdouble noise;
    Moment m;

    find_cubic (t->times, f, stride, t->times[at], &m);
    noise = t->noise * t->noise;
    for (guint k = 0; k < N_CUBIC; k++)
      noise += pow (m.weights[k] * t->noise, 2.);
    for (gsize i = 0; i < row; i++) {
      gdouble off = -t->samples[(gsize) at * row + i];

      for (guint k = 0; k < N_CUBIC; k++)
        off += m.weights[k] * t->samples[((gsize) f + k * stride) * row + i];
      if (isnan (off))
        continue;
      sum += off * off - noise;
      count++;
    }
  }
  return count > 0. ? sqrt (fmax (sum / count, 0.)) : NAN;
}

/* How far a twin is from what was recorded, RMS of a coordinate, m. */
static gdouble
find_distance (const ClothRecording * twin, const ClothRecording * r)
{
  gdouble sum = 0., count = 0.;

  for (gsize i = 0; i < 3 * (gsize) r->n * r->n_frames; i++) {
    if (twin->seen[i / 3] == 0.)
      continue;
    sum += (twin->y[i] - r->y[i]) * (twin->y[i] - r->y[i]);
    count++;
  }
  return count > 0. ? sqrt (sum / count) : 0.;
}

/* What lies between frames must be known to better than the recording's noise, or well enough to tell how far the
 * twin is from the recording: then it counts as noise, which is one number then. */
static gboolean
check_rate (const Twin * t, ClothRecording * twin, GError ** error)
{
  const ClothRecording *r = t->recorded;
  const guint last = t->n_frames - 1;
  gdouble two, four, off, ratio;
  guint worst = 0;

  for (guint i = 0; i < r->n_frames; i++)
    if (t->moments[i].width > t->moments[worst].width)
      worst = i;
  if (!(t->moments[worst].width > 0.))
    return TRUE;
  two = find_error (t, 2);
  four = find_error (t, 4);
  off =
      fmax (two / 16., four > two ? two * two / four : isnan (four) ? 0. : two);
  ratio = off * t->moments[worst].width / r->sigma;
  if (!(ratio > 1.))
    return TRUE;
  if (!r->noise && ratio * r->sigma < LEAST_KNOWN * find_distance (twin, r)) {
    twin->between = ratio * r->sigma;
    twin->sigma = hypot (twin->sigma, twin->between);
    return TRUE;
  }
  if (r->times[worst] < t->times[0] || r->times[worst] > t->times[last])
    return refuse (t, error, "it has no frame at %g s, at the recording's %s, "
        "and to go on from its others would be %.2g m off, more than the "
        "noise of %.2g m; simulate all of the recording", r->times[worst],
        worst ? "end" : "beginning", ratio * r->sigma, r->sigma);
  return refuse (t, error, "between its frames it is known to %.2g m only, and "
      "the noise is %.2g m; write it at the recording's times, or at %g frames "
      "a second", ratio * r->sigma, r->sigma,
      ceil (pow (ratio, 0.25) / frame_length (t->times, t->n_frames)));
}

/* The distance that the noise of two coordinates' differences reaches in one of @n tries, once
 * in a hundred such series, in standard deviations: chi with three degrees of freedom. */
static gdouble
find_limit (guint64 n)
{
  gdouble low = 0., high = 1e3;

  while (high - low > 1e-3) {
    gdouble middle = 0.5 * (low + high);

    if (cloth_chi_square_tail (middle * middle, 3) * n > FALSE_ALARM)
      low = middle;
    else
      high = middle;
  }
  return high;
}

/* Whether @a, of one vertex with @b, holds longer together with @held. */
static gboolean
holds_longer (const ClothHeld * a, const ClothHeld * b, const ClothHeld * held)
{
  return a->vertex == b->vertex
      && cloth_held_overlap (a, held) > cloth_held_overlap (b, held);
}

/* Which of the clamps of @scene holds a corner that makes up a place, the nearest of them, and of those of one
 * vertex the one that holds longest while @held does; −1: none. @apart is how far its vertex is from @uv on the flat
 * cloth, m. */
static gint
find_clamp (const ClothScene * scene, const ClothFlatPlace * place,
    const gfloat * uv, const ClothHeld * held, gdouble * apart)
{
  gint found = -1;

  *apart = INFINITY;
  for (guint i = 0; i < scene->held->len; i++) {
    guint vertex = g_array_index (scene->held, ClothHeld, i).vertex;
    const gfloat *own = scene->topology->uv + 2 * (gsize) vertex;
    gdouble off = hypot (own[0] - uv[0], own[1] - uv[1]);

    for (guint c = 0; c < 4; c++)
      if (place->corners[c] == vertex && place->weights[c] > ROUNDING
          && (off < *apart || (found >= 0
                  && holds_longer (&g_array_index (scene->held, ClothHeld, i),
                      &g_array_index (scene->held, ClothHeld, found), held)))) {
        *apart = off;
        found = (gint) i;
      }
  }
  return found;
}

/* Every clamp of @a holds where one of @b does. */
static gboolean
check_held (const Twin * t, const ClothScene * a, const ClothScene * b,
    const gchar * which, const gchar * other, GError ** error)
{
  g_autoptr (ClothFlatMap) map = NULL;

  map = cloth_flat_map_new (b->topology, ROUNDING * t->side);
  for (guint i = 0; i < a->held->len; i++) {
    guint vertex = g_array_index (a->held, ClothHeld, i).vertex;
    const gfloat *uv = a->topology->uv + 2 * (gsize) vertex;
    ClothFlatPlace place = t->same_vertices ? place_of_vertex (vertex) :
        cloth_flat_map_locate (map, uv);
    gdouble apart;

    if (find_clamp (b, &place, uv, &g_array_index (a->held, ClothHeld, i),
            &apart) < 0)
      return refuse (t, error, "%s holds vertex %u, at (%g, %g) m on the flat "
          "cloth, and %s holds nothing there; clamp the same places", which,
          vertex, uv[0], uv[1], other);
  }
  return TRUE;
}

static gboolean
is_moved (gdouble a, gdouble b, gdouble frame)
{
  return !(a == b || fabs (a - b) <= frame);
}

static gchar *
describe_span (const ClothHeld * held)
{
  g_autofree gchar *until = isfinite (held->until_s) ?
      g_strdup_printf ("until %g s", held->until_s) : g_strdup ("to the end");

  return isfinite (held->from_s) ? g_strdup_printf ("from %g s %s",
      held->from_s, until) : g_steal_pointer (&until);
}

static gboolean
refuse_span (const Twin * t, const ClothHeld * own, const ClothHeld * held,
    GError ** error)
{
  g_autofree gchar *span = describe_span (own);
  g_autofree gchar *recorded = describe_span (held);

  return refuse (t, error, "it holds vertex %u %s, and the recording vertex %u "
      "%s; hold and let go as recorded", own->vertex, span, held->vertex,
      recorded);
}

/* The clamps' paths are those of the recording's log while it holds. Clamps of other vertices may
 * be as far from each other as these are on the flat cloth. */
static gboolean
check_paths (const Twin * t, GError ** error)
{
  const ClothRecording *r = t->recorded;
  const ClothScene *s = r->scene, *own = t->scene;
  const guint n = s->held->len, n_own = own->held->len;
  const gdouble noise = n ? r->sigma * find_limit ((guint64) n * r->n_frames) :
      0.;
  const gdouble frame = (1. + ROUNDING) *
      fmax (frame_length (t->times, t->n_frames),
      frame_length (r->times, r->n_frames));

  for (guint i = 0; i < n; i++) {
    const ClothHeld *held = &g_array_index (s->held, ClothHeld, i), *other;
    gdouble apart, most = 0., first_s = NAN;
    gint k = find_clamp (own, &t->places[held->vertex],
        s->topology->uv + 2 * (gsize) held->vertex, held, &apart);

    other = &g_array_index (own->held, ClothHeld, k);
    if (is_moved (held->from_s, other->from_s, frame)
        || is_moved (held->until_s, other->until_s, frame))
      return refuse_span (t, other, held, error);
    for (guint f = 0; f < r->n_frames; f++) {
      const Moment *m = &t->moments[f];
      const gdouble *at = s->clamps + 3 * ((gsize) f * n + i);
      gdouble off[3];

      if (r->times[f] < fmax (held->from_s, other->from_s)
          || r->times[f] >= fmin (held->until_s, other->until_s) - frame)
        continue;
      for (guint c = 0; c < 3; c++) {
        off[c] = -at[c];
        for (guint j = 0; j < N_CUBIC; j++)
          off[c] += m->weights[j] * own->clamps[3 *
              ((gsize) (m->first + j) * n_own + (guint) k) + c];
      }
      if (cloth_vec3_length (off) > noise + apart + ROUNDING * t->side) {
        most = fmax (most, cloth_vec3_length (off));
        if (isnan (first_s))
          first_s = r->times[f];
      }
    }
    if (most > 0.)
      return refuse (t, error, "its clamp of vertex %u is up to %.2g m from "
          "the recorded path of vertex %u, more than noise hides (%.2g m), "
          "first at %g s; let the clamps follow clamps.npy of the recording",
          other->vertex, most, held->vertex, noise, first_s);
  }
  return TRUE;
}

static void
fill_positions (const Twin * t, ClothRecording * twin)
{
  const gsize row = 3 * (gsize) twin->n;

  for (guint f = 0; f < twin->n_frames; f++) {
    const Moment *m = &t->moments[f];

    for (guint v = 0; v < twin->n; v++) {
      gsize at = (gsize) f * twin->n + v;
      gboolean known = TRUE;

      for (guint k = 0; k < 3; k++) {
        gdouble sum = 0.;

        for (guint i = 0; i < N_CUBIC; i++)
          if (m->weights[i] != 0.)
            sum += m->weights[i] *
                t->samples[(gsize) (m->first + i) * row + 3 * v + k];
        known &= isfinite (sum) != 0;
        twin->y[3 * at + k] = sum;
      }
      if (!known)
        twin->seen[at] = 0.;
      known &= twin->seen[at] > 0. || twin->simulated;
      for (guint k = 0; k < 3 && !known; k++)
        twin->y[3 * at + k] = NAN;
    }
  }
}

static gboolean
twin_init (Twin * t, ClothTake * take, const ClothRecording * recorded,
    GError ** error)
{
  *t = (Twin) {
  recorded, take};
  /* its take.json is often a copy of the recording's */
  t->name = g_path_get_basename (cloth_take_get_folder (take));
  t->side = cloth_recording_longest_side (recorded);
  t->noise = fmax (cloth_take_get_info (take)->noise_sigma_m, 0.);
  t->n_frames = cloth_take_get_n_frames (take);
  if (t->n_frames < N_CUBIC)
    return refuse (t, error, "it has %u frames; write one for each of the "
        "recording's %u", t->n_frames, recorded->n_frames);
  t->scene = cloth_scene_new_from_take (take, error);
  if (!t->scene) {
    g_prefix_error (error, "%s: ", t->name);
    return FALSE;
  }
  t->times = t->scene->times;
  return TRUE;
}

/* @simulated: what a simulator made of the recorded scene: the same flat cloth in any mesh, at any
 *   times, with the same clamps, gravity and obstacles
 * @recorded: what was recorded
 * @error: #ClothFitError when it is of another scene, cloth or time, diverged, or was written too
 *   seldom to say where the cloth is between its frames to better than the noise, or than a tenth of how far it is
 *   from the recording; or what
 *   reading it says
 *
 * What was not seen counts as not simulated and is bridged alike, so that an observer does the
 * same to both; it stays where a simulation says where the recording's is. Vertices that the
 * simulation has no position of are masked too. Frames before and after the recording are cut.
 * The scene is the recording's, but for the start.
 *
 * Returns: (transfer full) (nullable): the simulation at the recording's vertices and times; its
 *   sigma is that of a coordinate of recorded less simulated, the noise of both, m
 */
ClothRecording *
cloth_recording_new_twin (ClothTake * simulated,
    const ClothRecording * recorded, GError ** error)
{
  g_auto (Twin) t = { NULL };
  gsize all = (gsize) recorded->n * recorded->n_frames;
  ClothRecording *twin;

  if (!twin_init (&t, simulated, recorded, error)
      || !check_world (&t, error) || !check_cloth (&t, error)
      || !find_moments (&t, error) || !read_frames (&t, error))
    return NULL;
  twin = g_new0 (ClothRecording, 1);
  twin->name = g_strdup (t.name);
  /* the observer runs on both alike in it */
  twin->scene = cloth_scene_copy (recorded->scene);
  twin->n = recorded->n;
  twin->n_frames = recorded->n_frames;
  twin->times = g_memdup2 (recorded->times,
      recorded->n_frames * sizeof *recorded->times);
  twin->sigma = hypot (recorded->sigma, t.noise);
  twin->seen = g_memdup2 (recorded->seen, all * sizeof *recorded->seen);
  twin->noise = cloth_recording_noise_ref (recorded->noise);
  twin->simulated = recorded->simulated;
  twin->y = g_new (gdouble, 3 * all);
  twin->velocity = g_new (gdouble, 3 * all);
  fill_positions (&t, twin);
  /* its clamps last: those of @twin are the recording's, so only where its own are the same does
   * this speak of the simulation's places */
  if (!check_held (&t, recorded->scene, t.scene, "the recording", "it", error)
      || !check_held (&t, t.scene, recorded->scene, "it", "the recording",
          error)
      || !cloth_recording_check_cloth (twin, TRUE, error)
      || !check_rate (&t, twin, error) || !check_paths (&t, error)
      || !cloth_recording_check_clamps (twin, error)) {
    cloth_recording_free (twin);
    return NULL;
  }
  cloth_recording_interpolate (twin);
  cloth_recording_differentiate (twin);
  memcpy (twin->scene->positions, twin->y,
      3 * (gsize) twin->n * sizeof *twin->y);
  return twin;
}

/* @a: (inout): a recording
 * @b: (inout): what was simulated of it, or another such simulation
 *
 * What one of them has no position of counts in none; where outlines alone tell of a place it counts as much as
 * in the one that knows less.
 */
void
cloth_recording_see_alike (ClothRecording * a, ClothRecording * b)
{
  for (gsize i = 0; i < (gsize) a->n_frames * a->n; i++)
    a->seen[i] = b->seen[i] = MIN (a->seen[i], b->seen[i]);
}
