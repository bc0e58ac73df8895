/* A recording made of what cameras saw, without a mesh: places where rays meet, and rays.
 *
 * Model: a camera sees a vertex in a direction with an error N (0, s²) all round. Rays that meet
 *   give a place with its covariance; one ray alone gives the inverse covariance
 *   (I − d dᵀ) / (s r)² at the distance r, of rank 2.
 *   Of what no camera located, an outline tells the place along its normal (outline.c): rank 1 for
 *   each camera.
 * Assumption: along a lone ray, and along an outline, the cloth is where a simulation is that all
 *   rays and outlines draw.
 * Formula: places on lone rays and the simulation are found in turn, until a turn moves places by less
 *   than the recording's noise, RMS, or no longer by much less than the one before: y = c + d dᵀ (x − c),
 *   x = simulation drawn to y with the weights of ClothRecordingNoise, which draw across the rays only. On outlines, with Λ = Σ g gᵀ/s²
 *   over the cameras, y = x + Λ⁺ Σ g δ/s²; s is what outlines are off at vertices that were located.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 3.2 (rays as targets).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/nudge/observed.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/nudge/outline.h"
#include "gst/fit/recording/recording.h"
#include "gst/math/linalg.h"
#include "gst/math/statistics.h"
#include "gst/math/vec3.h"
#include "gst/rig/errorfloor.h"

/* Most vertices times frames: 7 GB of memory. Nothing of a file's size bounds them. */
#define MOST_PLACES (1u << 25)
/* Most turns of places and simulation. */
#define MOST_TURNS 8
/* A turn that moves places by more than this share of what the last one did: what is left is what simulations
 * differ by as their numbers are rounded. */
#define STALLED 0.5
/* Least turns where outlines are followed: the cloth comes to them by and by. */
#define LEAST_TURNS 4
/* Standard deviation of what is cut to whole pixels. */
#define QUANTISED_PX 0.29
/* Where none of the located vertices lies on an outline. */
#define UNKNOWN_PX 3.
/* The places of outlines are not seen as others are. */
#define MOST_SEEN 0.99
/* Directions that outlines tell less of than this share of the best are left to the simulation. */
#define WEAK 0.1
/* A ray that is all that is known of a place. */
typedef struct
{
  guint32 frame, vertex;
  gdouble centre[3], direction[3], spread;
} Lone;

/* A place that no cloth can be at, and what is known of it. */
typedef struct
{
  gsize at;
  gdouble y[3], white[6], draw[6], seen;
} Torn;

/* What outlines tell of a place, if they are off by one pixel: Σ g gᵀ and Σ g δ over the cameras. */
typedef struct
{
  gsize at;
  gdouble information[6], pull[3];
} Told;

typedef struct
{
  const ClothObservations *observations;
  ClothRecording *r;
  ClothTriangulator *triangulator;
  ClothErrorFloor floor;
  guint n_cameras;
  ClothViews *views;
  ClothRays *rays;
  GArray *lone;
  GArray *torn;                 /* of Torn: what was taken away last */
  ClothOutline *outline;        /* NULL: there are no silhouettes */
  gboolean *outlined;           /* places of which only outlines tell */
  gsize n_apart;                /* places that several cameras see, and whose rays do not meet */
  ClothObservedCounts *counts;
} Maker;

static void
maker_clear (Maker * m)
{
  g_clear_pointer (&m->triangulator, cloth_triangulator_free);
  cloth_views_free (m->views);
  cloth_rays_free (m->rays);
  g_clear_pointer (&m->lone, g_array_unref);
  g_clear_pointer (&m->torn, g_array_unref);
  g_clear_pointer (&m->outline, cloth_outline_free);
  g_free (m->outlined);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Maker, maker_clear);

static gboolean
has_silhouettes (const ClothObservations * observations)
{
  for (guint c = 0; c < observations->rig->n_cameras; c++)
    if (cloth_observations_has_silhouettes (observations, c))
      return TRUE;
  return FALSE;
}

static gboolean
maker_init (Maker * m, ClothTake * take, ClothRecording * r,
    const ClothObservations * observations, guint threads,
    ClothObservedCounts * counts, GError ** error)
{
  const ClothRig *rig = observations->rig;

  *m = (Maker) {
  observations, r,.n_cameras = rig->n_cameras,.counts = counts};
  if (cloth_take_get_n_positions (take) > 0) {
    r->start = g_new (gfloat, 3 * (gsize) r->n);
    if (!cloth_take_read_positions (take, 0, r->start, error))
      return FALSE;
  }
  m->views = cloth_views_new (observations, cloth_recording_get_frame_s (r));
  m->rays = cloth_rays_new (r->n);
  m->lone = g_array_new (FALSE, FALSE, sizeof (Lone));
  m->torn = g_array_new (FALSE, FALSE, sizeof (Torn));
  if (has_silhouettes (observations)) {
    m->outline = cloth_outline_new (r, observations, threads);
    m->outlined = g_new0 (gboolean, (gsize) r->n * r->n_frames);
  }
  if (rig->n_cameras == 1)
    return TRUE;
  m->triangulator = cloth_triangulator_new (rig->n_cameras, rig->cameras,
      error);
  return m->triangulator != NULL;
}

/* A camera by another clock would be left out without a word. */
static gboolean
check_clocks (const Maker * m, GError ** error)
{
  const ClothRecording *r = m->r;
  const GArray *list = m->observations->list;

  for (guint c = 0; c < m->n_cameras; c++) {
    const ClothCamera *camera = &m->observations->rig->cameras[c];
    gdouble first = NAN, last = NAN;
    guint n = 0, n_within = 0;

    for (guint i = 0; i < list->len; i++) {
      const ClothObservation *o = &g_array_index (list, ClothObservation, i);

      if (o->camera != c)
        continue;
      last = o->time_s - camera->offset_s;
      first = n++ ? first : last;
      n_within += cloth_recording_find_frame (r, last) >= 0;
    }
    if (n == 0 || n_within > 0)
      continue;
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: all "
        "%u pictures of camera “%s” are from %.3f to %.3f s, and the frames from "
        "%.3f to %.3f s: give both times by one clock, say by offset_s in the rig "
        "how late the camera's is, or leave its observations out", r->name, n,
        camera->name, first, last, r->times[0], r->times[r->n_frames - 1]);
    return FALSE;
  }
  return TRUE;
}

static gboolean
triangulate (Maker * m, guint frame, const ClothTriangulation ** result,
    GError ** error)
{
  ClothTriangulateParameters parameters = CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;

  for (guint c = 0; c < m->n_cameras; c++)
    cloth_views_find (m->views, c, m->r->times[frame] +
        m->observations->rig->cameras[c].offset_s);
  *result = NULL;
  if (!m->triangulator)
    return TRUE;
  parameters.error_floor = m->floor.floor;
  cloth_triangulator_set_parameters (m->triangulator, &parameters);
  return cloth_triangulator_run (m->triangulator, m->n_cameras, m->views->views,
      m->r->n, result, error);
}

/* How well the cameras agree, beside what their covariances say. */
static gboolean
find_floor (Maker * m, GError ** error)
{
  for (guint f = 0; m->triangulator && f < m->r->n_frames; f++) {
    const ClothTriangulation *t;

    if (!triangulate (m, f, &t, error))
      return FALSE;
    cloth_error_floor_add (&m->floor, m->n_cameras, m->views->views, t);
  }
  m->counts->error_floor = m->floor.floor;
  return TRUE;
}

static void
keep_point (Maker * m, guint frame, guint v, const ClothTriangulation * t)
{
  const gsize at = (gsize) frame * m->r->n + v;
  const gdouble *const *c = (const gdouble * const *) t->covariance;
  const gdouble full[9] = { c[0][v], c[1][v], c[2][v], c[1][v], c[3][v],
    c[4][v], c[2][v], c[4][v], c[5][v]
  };
  gdouble i[9];

  if (!cloth_mat3_inverse (full, i)
      || !cloth_recording_noise_set (m->r->noise, at,
          (const gdouble[6]) { i[0], i[4], i[8], i[5], i[2], i[1] }, 0.))
    return;
  for (guint k = 0; k < 3; k++)
    m->r->y[3 * at + k] = t->position[k][v];
  m->r->seen[at] = 1.;
  m->counts->triangulated++;
}

/* The rays of one camera to vertices that no other one helps with; of several the sharpest counts. */
static void
keep_rays (Maker * m, guint frame, guint camera, const ClothTriangulation * t,
    Lone * lone)
{
  for (guint axis = 0; axis < 2; axis++) {
    gdouble *variance = cloth_views_variance (m->views, camera, axis);

    for (guint v = 0; v < m->r->n; v++)
      variance[v] += m->floor.floor;
  }
  cloth_rays_cast (m->rays, &m->observations->rig->cameras[camera],
      &m->views->views[camera]);
  for (guint v = 0; v < m->r->n; v++) {
    const gsize at = (gsize) frame * m->r->n + v;
    const gdouble spread = m->rays->spreads[v];

    if (m->r->seen[at] > 0. || !(spread > 0.) || (t
            && t->reason[v] == CLOTH_POINT_DISAGREE)
        || (lone[v].spread > 0. && spread >= lone[v].spread))
      continue;
    lone[v] = (Lone) {
    frame, v,.spread = spread};
    memcpy (lone[v].centre, m->rays->centres + 3 * (gsize) v,
        sizeof lone[v].centre);
    memcpy (lone[v].direction, m->rays->directions + 3 * (gsize) v,
        sizeof lone[v].direction);
  }
}

static gboolean
find_places (Maker * m, GError ** error)
{
  g_autofree Lone *lone = g_new (Lone, m->r->n);

  for (guint f = 0; f < m->r->n_frames; f++) {
    const ClothTriangulation *t;

    if (!triangulate (m, f, &t, error))
      return FALSE;
    for (guint v = 0; t && v < m->r->n; v++) {
      if (t->reason[v] == CLOTH_POINT_FINE)
        keep_point (m, f, v, t);
      m->counts->contradicted += t->reason[v] == CLOTH_POINT_DISAGREE;
      m->n_apart += t->reason[v] != CLOTH_POINT_FINE
          && t->reason[v] != CLOTH_POINT_FEW_VIEWS;
    }
    memset (lone, 0, m->r->n * sizeof *lone);
    for (guint c = 0; c < m->n_cameras; c++)
      keep_rays (m, f, c, t, lone);
    for (guint v = 0; v < m->r->n; v++)
      if (lone[v].spread > 0.)
        g_array_append_val (m->lone, lone[v]);
  }
  m->counts->places = (gsize) m->r->n * m->r->n_frames;
  m->counts->single = m->lone->len;
  return TRUE;
}

/* What is known across a ray at the place that it has now. */
static void
weigh (ClothRecording * r, const Lone * lone)
{
  const gsize at = (gsize) lone->frame * r->n + lone->vertex;
  const gdouble *d = lone->direction;
  gdouble along[3], distance, square, information[6];

  cloth_vec3_subtract (r->y + 3 * at, lone->centre, along);
  distance = sqrt (cloth_vec3_dot (along, along));
  square = 1. / (lone->spread * lone->spread * distance * distance);
  for (guint k = 0; k < 3; k++) {
    information[k] = square * (1. - d[k] * d[k]);
    information[3 + k] = -square * d[(k + 1) % 3] * d[(k + 2) % 3];
  }
  r->seen[at] = cloth_recording_noise_set (r->noise, at, information, 0.);
}

/* To the foot of the perpendicular from where it is. Returns its squared way. Behind the camera
 * nothing was seen. */
static gdouble
put_on_ray (ClothRecording * r, const Lone * lone, const gdouble from[3])
{
  const gsize at = (gsize) lone->frame * r->n + lone->vertex;
  gdouble v[3], along, way = 0.;

  cloth_vec3_subtract (from, lone->centre, v);
  along = cloth_vec3_dot (v, lone->direction);
  if (!(along > 0.)) {
    r->seen[at] = 0.;
    return 0.;
  }
  for (guint k = 0; k < 3; k++) {
    gdouble to = lone->centre[k] + along * lone->direction[k];

    way += (to - r->y[3 * at + k]) * (to - r->y[3 * at + k]);
    r->y[3 * at + k] = to;
  }
  r->seen[at] = 1.;
  weigh (r, lone);
  return way;
}

/* The first guess of all that was not triangulated: between those that were, else where the cloth
 * starts. */
static gboolean
guess (Maker * m, GError ** error)
{
  ClothRecording *r = m->r;
  const gsize row = 3 * (gsize) r->n;

  if (m->counts->triangulated == 0 && m->n_apart > 0
      && (!r->start || m->counts->single == 0)) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: "
        "%" G_GSIZE_FORMAT " times several cameras see the same vertex, and "
        "their rays meet nowhere: give the rig of these cameras, each by its name, "
        "and see that their clocks agree", r->name, m->n_apart);
    return FALSE;
  }
  if (m->counts->triangulated == 0 && !r->start) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: no "
        "two cameras see the same vertex at a time, so nothing says where the "
        "cloth starts; give its places in the first frame as positions.npy "
        "[1][vertices][3]", r->name);
    return FALSE;
  }
  if (m->counts->triangulated + m->counts->single == 0) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: no "
        "camera saw a vertex in any of its %u frames; do their times agree "
        "with times.npy?", r->name, r->n_frames);
    return FALSE;
  }
  if (m->counts->triangulated == 0)
    for (guint f = 0; f < r->n_frames; f++)
      memcpy (r->y + f * row, r->scene->positions, row * sizeof *r->y);
  else
    cloth_recording_interpolate (r);
  for (guint i = 0; i < m->lone->len; i++) {
    const Lone *lone = &g_array_index (m->lone, Lone, i);

    put_on_ray (r, lone, r->y + 3 * ((gsize) lone->frame * r->n +
            lone->vertex));
  }
  return TRUE;
}

/* Springs draw from a frame to the next one, at vertices that are seen in both; outlines are of any frame. */
static gboolean
check_rate (const Maker * m, GError ** error)
{
  const ClothRecording *r = m->r;
  const GArray *list = m->observations->list;
  const ClothObservation *one = NULL, *next = NULL;

  if (m->outline)
    return TRUE;
  for (gsize at = r->n; at < (gsize) r->n * r->n_frames; at++)
    if (r->seen[at] > 0. && r->seen[at - r->n] > 0.)
      return TRUE;
  for (guint i = 0; i < list->len && !next; i++) {
    const ClothObservation *o = &g_array_index (list, ClothObservation, i);

    if (!one)
      one = o;
    else if (o->camera == one->camera)
      next = o;
  }
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: no "
      "vertex is seen in two frames that follow each other: frames are %.4g s "
      "apart, and the first pictures of “%s” %.4g s; give the take, by fps or "
      "times.npy, the rate of its cameras", r->name,
      cloth_recording_get_frame_s (r),
      m->observations->rig->cameras[one->camera].name,
      next ? next->time_s - one->time_s : NAN);
  return FALSE;
}

/* What was torn comes back: places on lone rays move, and others may be found to be right by the next turn. */
static void
restore_torn (Maker * m)
{
  ClothRecording *r = m->r;

  for (guint i = 0; i < m->torn->len; i++) {
    const Torn *t = &g_array_index (m->torn, Torn, i);

    memcpy (r->y + 3 * t->at, t->y, sizeof t->y);
    memcpy (r->noise->white + 6 * t->at, t->white, sizeof t->white);
    memcpy (r->noise->draw + 6 * t->at, t->draw, sizeof t->draw);
    r->seen[t->at] = t->seen;
  }
  g_array_set_size (m->torn, 0);
}

/* Takes places away that no cloth can be at, and keeps what is known of them. */
static void
remove_torn (Maker * m)
{
  ClothRecording *r = m->r;
  const gsize all = (gsize) r->n * r->n_frames;
  g_autofree gdouble *before = g_memdup2 (r->seen, all * sizeof *before);

  r->sigma = cloth_recording_noise_finish (r->noise, r->seen);
  m->counts->torn = cloth_recording_remove_torn (r);
  for (gsize at = 0; m->counts->torn && at < all; at++)
    if (before[at] > 0. && r->seen[at] == 0.) {
      Torn t = {.at = at,.seen = before[at] };

      memcpy (t.y, r->y + 3 * at, sizeof t.y);
      memcpy (t.white, r->noise->white + 6 * at, sizeof t.white);
      memcpy (t.draw, r->noise->draw + 6 * at, sizeof t.draw);
      g_array_append_val (m->torn, t);
    }
}

/* Without places that no cloth can be at, and with the paths of all clamps. */
static gboolean
finish (Maker * m, GError ** error)
{
  ClothRecording *r = m->r;

  remove_torn (m);
  cloth_recording_open_paths (r);
  cloth_recording_interpolate (r);
  if (!cloth_recording_find_paths (r, error))
    return FALSE;
  cloth_recording_differentiate (r);
  return TRUE;
}

/* Adds what an outline tells of a frame. */
static void
add_outline (const Maker * m, guint frame, Told * told, GArray * off)
{
  const ClothOutline *o = m->outline;

  for (guint v = 0; v < o->n; v++) {
    const gdouble *g = o->gradients + 3 * (gsize) v;
    const gdouble distance = fabs (o->offsets[v]);

    if (!o->counts[v])
      continue;
    if (m->r->seen[(gsize) frame * m->r->n + v] > 0.) {
      g_array_append_val (off, distance);
      continue;
    }
    for (guint k = 0; k < 3; k++) {
      told[v].information[k] += g[k] * g[k];
      told[v].information[3 + k] += g[(k + 1) % 3] * g[(k + 2) % 3];
      told[v].pull[k] += g[k] * o->offsets[v];
    }
  }
}

/* All that outlines of the cloth at @x tell of places that nothing else tells of.
 * Returns: their standard deviation, px: robust, where the place is known otherwise */
static gdouble
look_at_outlines (const Maker * m, const gdouble * x, GArray * list)
{
  const ClothRecording *r = m->r;
  g_autoptr (GArray) off = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autofree Told *told = g_new (Told, r->n);

  for (guint f = 0; f < r->n_frames; f++) {
    memset (told, 0, r->n * sizeof *told);
    for (guint c = 0; c < m->n_cameras; c++)
      if (cloth_outline_find (m->outline, c, f, x))
        add_outline (m, f, told, off);
    /* where the cloth starts is known */
    for (guint v = 0; f && v < r->n; v++) {
      const gdouble *s = told[v].information;

      told[v].at = (gsize) f *r->n + v;
      if (s[0] + s[1] + s[2] > 0.)
        g_array_append_val (list, told[v]);
    }
  }
  return off->len == 0 ? UNKNOWN_PX : fmax (CLOTH_MEDIAN_TO_SIGMA *
      cloth_median ((gdouble *) off->data, off->len), QUANTISED_PX);
}

/* Moves a place to where outlines have it. */
static void
put_on_outlines (Maker * m, const Told * told, gdouble px)
{
  ClothRecording *r = m->r;
  gdouble information[6], pull[3], way[3], root;

  for (guint k = 0; k < 6; k++)
    information[k] = told->information[k] / (px * px);
  for (guint k = 0; k < 3; k++)
    pull[k] = told->pull[k] / (px * px);
  /* what cameras that look alike tell of a second direction is noise */
  if (!cloth_recording_noise_set (r->noise, told->at, information, WEAK))
    return;
  root = cloth_recording_noise_solve (r->noise, told->at, pull, way);
  for (guint k = 0; k < 3; k++)
    r->y[3 * told->at + k] += way[k];
  /* Springs are as strong as the outline is sharp, gain ~ 1/σ, as those of a steady Kalman filter of a
   * mass under white forces. Those of two frames are multiplied. */
  r->seen[told->at] = fmin (sqrt (r->sigma * root), MOST_SEEN);
  m->outlined[told->at] = TRUE;
  m->counts->outlined++;
}

/* Places of which outlines told are as if nobody had seen them. */
static void
forget_outlines (Maker * m)
{
  for (gsize at = 0; at < (gsize) m->r->n * m->r->n_frames; at++) {
    if (m->outlined[at])
      m->r->seen[at] = 0.;
    m->outlined[at] = FALSE;
  }
  m->counts->outlined = 0;
}

/* What the outlines of the cloth at @x say of places that nothing else tells of. Where they don't either,
 * the cloth is at @x: what is outlined comes and goes, and would jump from there to a bridge. */
static void
draw_to_outlines (Maker * m, const gdouble * x)
{
  ClothRecording *r = m->r;
  g_autoptr (GArray) list = g_array_new (FALSE, FALSE, sizeof (Told));
  const gdouble px = look_at_outlines (m, x, list);

  for (gsize at = r->n; at < (gsize) r->n * r->n_frames; at++)
    if (r->seen[at] == 0.)
      memcpy (r->y + 3 * at, x + 3 * at, 3 * sizeof (gdouble));
  for (guint i = 0; i < list->len; i++)
    put_on_outlines (m, &g_array_index (list, Told, i), px);
  cloth_recording_differentiate (r);
}

/* Simulates the cloth drawn to all that is known, @x in each frame, and moves places along their rays there.
 * Returns how far, RMS; NaN: it diverged. */
static gdouble
turn (Maker * m, const ClothModel * model, gdouble gain,
    const ClothRolloutOptions * options, gdouble * x, GError ** error)
{
  const ClothRecording *r = m->r;
  g_autofree gdouble *ways = NULL;
  gdouble sum = 0.;
  guint n = 0;
  gboolean sound;

  if (!cloth_rollout_follow (&r, 1, model, gain, options, x, &sound, error))
    return NAN;
  if (!sound) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "%s: the "
        "simulation that follows the cameras diverged; lower “time_step” of "
        "the model, or its stiffnesses", r->name);
    return NAN;
  }
  /* a ray that was lost for a turn is better than an outline */
  if (m->outline)
    forget_outlines (m);
  restore_torn (m);
  ways = g_new (gdouble, m->lone->len);
  for (guint i = 0; i < m->lone->len; i++) {
    const Lone *lone = &g_array_index (m->lone, Lone, i);

    ways[i] = put_on_ray (m->r, lone, x + 3 * ((gsize) lone->frame * r->n +
            lone->vertex));
  }
  if (!finish (m, error))
    return NAN;
  /* from a bridge to a ray and back is no way */
  for (guint i = 0; i < m->lone->len; i++) {
    const Lone *lone = &g_array_index (m->lone, Lone, i);

    if (r->seen[(gsize) lone->frame * r->n + lone->vertex] == 0.)
      continue;
    sum += ways[i];
    n++;
  }
  if (m->outline)
    draw_to_outlines (m, x);
  return sqrt (sum / MAX (n, 1));
}

/* Of the motion at lone rays the share along them. */
static gdouble
find_share_along (const Maker * m)
{
  gdouble along = 0., all = 0.;

  for (guint i = 0; i < m->lone->len; i++) {
    const Lone *lone = &g_array_index (m->lone, Lone, i);
    const gdouble *v = m->r->velocity + 3 * ((gsize) lone->frame * m->r->n +
        lone->vertex);
    const gdouble part = cloth_vec3_dot (v, lone->direction);

    along += part * part;
    all += cloth_vec3_dot (v, v);
  }
  return all > 0. ? along / all : 0.;
}

static ClothRecording *
recording_new (ClothTake * take, GError ** error)
{
  g_autoptr (ClothRecording) r = g_new0 (ClothRecording, 1);
  gsize all;

  r->name = g_strdup (cloth_take_get_info (take)->name);
  r->n = cloth_take_get_topology (take)->n_vertices;
  r->n_frames = cloth_take_get_n_frames (take);
  if (r->n_frames < CLOTH_RECORDING_WINDOW) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s has %u "
        "frames; a diagnosis needs motion, at least %u", r->name, r->n_frames,
        CLOTH_RECORDING_WINDOW);
    return NULL;
  }
  all = (gsize) r->n_frames * r->n;
  if (all > MOST_PLACES) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s has %u "
        "frames of %u vertices; without positions at most %u places are "
        "found: cut the take into shorter ones", r->name, r->n_frames, r->n,
        MOST_PLACES);
    return NULL;
  }
  r->scene = cloth_scene_new_with_open_paths (take, error);
  if (!r->scene)
    return NULL;
  r->times = g_new (gdouble, r->n_frames);
  for (guint f = 0; f < r->n_frames; f++)
    r->times[f] = cloth_take_get_time (take, f);
  r->y = g_new0 (gdouble, 3 * all);
  r->velocity = g_new0 (gdouble, 3 * all);
  r->seen = g_new0 (gdouble, all);
  r->noise = cloth_recording_noise_new (all);
  return g_steal_pointer (&r);
}

/* @take: mesh, clamps and times; its positions, if it has any, are where the cloth starts
 * @observations: what cameras saw of it, any number of them
 * @model: what the simulator knows of the cloth
 * @gain: of the observer, 1/s²
 * @options: how to simulate
 * @counts: (out): what was seen
 * @error: #ClothFitError, #ClothSimError, or what reading the take says
 *
 * Pictures between two frames are interpolated, so cameras need not run in step. The clock of the
 * frames is the rig's: that of cameras whose offset is 0.
 *
 * Returns: (transfer full) (nullable): the recording, with the covariance of each place
 */
ClothRecording *
cloth_recording_new_observed (ClothTake * take,
    const ClothObservations * observations, const ClothModel * model,
    gdouble gain, const ClothRolloutOptions * options,
    ClothObservedCounts * counts, GError ** error)
{
  g_autoptr (ClothRecording) r = recording_new (take, error);
  g_auto (Maker) m = { NULL };
  g_autofree gdouble *x = NULL;
  gdouble last = INFINITY;

  *counts = (ClothObservedCounts) {
  0};
  if (!r
      || !maker_init (&m, take, r, observations, options->threads, counts,
          error)
      || !check_clocks (&m, error) || !find_floor (&m, error)
      || !find_places (&m, error) || !guess (&m, error)
      || !check_rate (&m, error) || !finish (&m, error))
    return NULL;
  if (!cloth_recording_check (r, TRUE, error)
      || !cloth_recording_check_paths (r, error))
    return NULL;
  x = g_new (gdouble, 3 * (gsize) r->n * r->n_frames);
  for (guint k = 0; (m.lone->len || m.outline) && k < MOST_TURNS; k++) {
    const gdouble moved = turn (&m, model, gain, options, x, error);

    if (isnan (moved))
      return NULL;
    if ((moved < r->sigma || moved > STALLED * last)
        && (!m.outline || k + 1 >= LEAST_TURNS))
      break;
    last = moved;
  }
  r->simulated = m.outline != NULL;
  counts->along = find_share_along (&m);
  return g_steal_pointer (&r);
}
