/* A simulation that is nudged to a recording frame by frame, as it is filmed.
 *
 * Model: x″ = M⁻¹F(x, x′) + g·m·(y − x) + 2ζ√g·m·(y′ − x′), m whether a vertex is seen; a second
 *   simulation without springs starts from the first one's state at each window.
 * Assumption: velocities y′ are those of a polynomial through seven frames (Savitzky and Golay
 *   1964), so a frame is compared three frames after it came.
 * Formula: residual = y − x; of a window, RMS of recorded minus free over what was seen. Of
 *   frames of rays only the part across each ray counts.
 * Reference: Hoke and Anthes 1976 (nudging, an observer in the sense of Luenberger 1964).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/nudge/observer.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/recording.h"
#include "gst/mesh/fill/fill.h"
#include "gst/sim/sim.h"

/* Frames of the polynomial that velocities come from, and its order (Savitzky & Golay
 * 1964). Of fewer frames the order is lower, down to 2, so that noise is smoothed. */
#define WINDOW CLOTH_RECORDING_WINDOW
G_STATIC_ASSERT (WINDOW == 2 * CLOTH_OBSERVER_LATENCY + 1);
#define MASKS (1u << WINDOW)
/* A window's last frame may be so much of a frame early. */
#define EARLY 0.25

/* The two copies of the model in the simulation. */
#define NUDGED 0
#define FREE 1

typedef struct
{
  gdouble time, sigma;
  gdouble *places;              /* that were pushed: 3 a vertex, NaN when not seen */
  gdouble *positions;           /* they, and places on rays */
  ClothRays *rays;              /* unless has_rays, of an older frame */
  gboolean has_places, has_rays;
} Frame;

struct _ClothObserver
{
  ClothObserverOptions options;
  guint n;
  ClothSim *sim;
  ClothSim *forecast;           /* without springs: only for frames of rays */
  gdouble *scene_start;
  gdouble fps;                  /* of the scene */
  gboolean automatic;           /* the time step */
  ClothTopology *topology;
  ClothOutliers *outliers;
  guint64 n_pushed, n_popped;
  Frame ring[WINDOW];           /* frame i at i % WINDOW */
  /* of the frame that was popped last, and of the one that is */
  gdouble *velocity[2];
  gdouble *weights;             /* all 1 */
  gdouble *state, *free_state, *speeds;
  gdouble *ahead, *ahead_speeds, *reference;    /* where rays' vertices may be */
  /* which frames of the window saw a vertex → their weights in its derivative */
  gdouble table[MASKS][WINDOW];
  gboolean known[MASKS];

  /* the window that is scored */
  gdouble window_from, window_to, sum;
  guint64 n_seen, n_all;
  gboolean has_score;
  ClothObserverScore score;
};

/* @scene: what is filmed; its clamps' paths are followed by its times
 * @model: what the simulator knows of the cloth
 * @options: how
 * @error: #ClothSimError
 *
 * x″ = M⁻¹F(x, x′) + g·m·(y − x) + 2ζ√g·m·(y′ − x′), m whether a vertex is seen. It starts
 * with the first frame that is pushed. The observer keeps nothing of @scene and @model.
 *
 * Rays draw it across them only. Along them y is where the simulation would be
 * without springs, and y′ how fast; in the first frame, at rest, where places that were seen
 * beside them say that it is, else where the scene starts.
 *
 * Returns: (transfer full): an observer, or %NULL
 */
ClothObserver *
cloth_observer_new (const ClothScene * scene, const ClothModel * model,
    const ClothObserverOptions * options, GError ** error)
{
  const ClothSimOptions sim_options = { FALSE, options->threads,
    CLOTH_SIMD_BEST, options->seed, options->stop
  };
  const ClothModel *models[2] = { model, model };
  g_autoptr (ClothSim) sim = cloth_sim_new (scene, models, 2, &sim_options,
      error);
  ClothSim *forecast = sim ? cloth_sim_new (scene, models, 1, &sim_options,
      error) : NULL;
  ClothObserver *self;
  gsize n;

  if (!forecast)
    return NULL;
  self = g_new0 (ClothObserver, 1);
  self->options = *options;
  self->sim = g_steal_pointer (&sim);
  self->forecast = forecast;
  self->n = scene->topology->n_vertices;
  self->fps = scene->fps;
  self->automatic = model->time_step == 0.;
  self->topology = cloth_topology_copy (scene->topology);
  self->outliers = cloth_outliers_new (scene->topology);
  n = 3 * (gsize) self->n;
  for (guint i = 0; i < WINDOW; i++) {
    self->ring[i].places = g_new (gdouble, n);
    self->ring[i].positions = g_new (gdouble, n);
    self->ring[i].rays = cloth_rays_new (self->n);
  }
  self->scene_start = g_memdup2 (scene->positions, n * sizeof (gdouble));
  self->ahead = g_new (gdouble, n);
  self->ahead_speeds = g_new (gdouble, n);
  self->reference = g_new (gdouble, n);
  for (guint i = 0; i < 2; i++)
    self->velocity[i] = g_new (gdouble, n);
  self->state = g_new (gdouble, n);
  self->free_state = g_new (gdouble, n);
  self->speeds = g_new (gdouble, n);
  self->weights = g_new (gdouble, self->n);
  for (guint i = 0; i < self->n; i++)
    self->weights[i] = 1.;
  return self;
}

/* @observer: an observer
 *
 * Forgets all frames; the next one begins a new recording.
 */
void
cloth_observer_restart (ClothObserver * observer)
{
  observer->n_pushed = observer->n_popped = 0;
  observer->n_all = 0;
  observer->has_score = FALSE;
}

/* A frame without rays, of which no places are known unless there are @positions. */
static Frame *
push_frame (ClothObserver * self, gdouble time_s, const gfloat * positions,
    gdouble sigma_m)
{
  Frame *frame = &self->ring[self->n_pushed++ % WINDOW];

  frame->time = time_s;
  frame->sigma = sigma_m;
  frame->has_rays = frame->has_places = FALSE;
  for (gsize i = 0; i < 3 * (gsize) self->n; i++) {
    frame->positions[i] = positions ? positions[i] : NAN;
    frame->has_places |= isfinite (frame->positions[i]);
  }
  cloth_outliers_remove (self->outliers, 0., frame->positions);
  memcpy (frame->places, frame->positions,
      3 * (gsize) self->n * sizeof *frame->places);
  return frame;
}

/* @observer: an observer that has not more than %CLOTH_OBSERVER_LATENCY frames waiting
 * @time_s: of the frame, seconds of the scene, later than the last one's
 * @positions: 3 numbers a vertex, metres; NaN when not seen
 * @sigma_m: usual standard deviation of one of them, metres; 0: not known. That of the first frame
 *   matters
 *
 * Gives it a frame. Vertices that would have to be torn off the cloth to be there count as
 * not seen.
 */
void
cloth_observer_push (ClothObserver * observer, gdouble time_s,
    const gfloat * positions, gdouble sigma_m)
{
  push_frame (observer, time_s, positions, sigma_m);
}

/* @observer: an observer that has not more than %CLOTH_OBSERVER_LATENCY frames waiting
 * @time_s: of the frame, seconds of the scene, later than the last one's
 * @rays: what one camera saw
 *
 * Gives it a frame of which only the places across the rays are known.
 */
void
cloth_observer_push_rays (ClothObserver * observer, gdouble time_s,
    const ClothRays * rays)
{
  Frame *frame = push_frame (observer, time_s, NULL, 0);

  frame->has_rays = TRUE;
  cloth_rays_copy (frame->rays, rays);
}

/* @observer: an observer that has not more than %CLOTH_OBSERVER_LATENCY frames waiting
 * @time_s: of the frame, seconds of the scene, later than the last one's
 * @positions: as of cloth_observer_push ()
 * @sigma_m: likewise
 * @rays: of vertices that one camera saw; that, then, is all that is known of them
 *
 * Gives it a frame of which some places are known, and others across a ray.
 */
void
cloth_observer_push_both (ClothObserver * observer, gdouble time_s,
    const gfloat * positions, gdouble sigma_m, const ClothRays * rays)
{
  Frame *frame = push_frame (observer, time_s, positions, sigma_m);

  for (guint v = 0; v < observer->n; v++)
    frame->has_rays |= cloth_rays_has (rays, v);
  if (frame->has_rays)
    cloth_rays_copy (frame->rays, rays);
}

/* @observer: an observer
 *
 * Returns: number of frames that were pushed and not popped. With more than
 *   %CLOTH_OBSERVER_LATENCY the next one is ready; at the end of a recording all are
 */
guint
cloth_observer_get_n_waiting (const ClothObserver * observer)
{
  return (guint) (observer->n_pushed - observer->n_popped);
}

/* Velocities at the frame that is popped, from all that the ring holds. */
static void
find_velocities (ClothObserver * self, gdouble * velocity)
{
  guint64 oldest = self->n_pushed > WINDOW ? self->n_pushed - WINDOW : 0;
  guint in_ring = (guint) (self->n_pushed - oldest);
  gdouble at = self->ring[self->n_popped % WINDOW].time;
  const gdouble *places[WINDOW];
  gdouble times[WINDOW];

  memset (self->known, 0, sizeof self->known);
  for (guint i = 0; i < in_ring; i++)
    places[i] = self->ring[(oldest + i) % WINDOW].positions;
  for (gsize v = 0; v < self->n; v++) {
    guint mask = 0;
    const gdouble *weights;

    for (guint i = 0; i < in_ring; i++) {
      const gdouble *p = places[i] + 3 * v;

      if (isfinite (p[0] + p[1] + p[2]))
        mask |= 1u << i;
    }
    weights = self->table[mask];
    if (!self->known[mask]) {
      for (guint i = 0; i < WINDOW; i++)
        times[i] = self->ring[(oldest + i) % WINDOW].time;
      cloth_recording_find_weights (times, mask, at, CLOTH_RECORDING_ORDER,
          self->table[mask]);
      self->known[mask] = TRUE;
    }
    for (guint k = 0; k < 3; k++) {
      gdouble sum = mask ? 0 : NAN;

      for (guint i = 0; i < in_ring; i++)
        if (mask >> i & 1)
          sum += weights[i] * places[i][3 * v + k];
      velocity[3 * v + k] = sum;
    }
  }
}

/* Closes the holes of the first frame. @start: as cloth_fill_close () has it. */
static void
fill_start (ClothObserver * self, gdouble sigma, const gdouble * start,
    gdouble * positions)
{
  const gsize n = 3 * (gsize) self->n;
  g_autofree gfloat *places = g_new (gfloat, n);

  for (gsize i = 0; i < n; i++)
    places[i] = (gfloat) positions[i];
  cloth_fill_close (self->topology, NULL, sigma, start, places);
  /* what was seen keeps its digits */
  for (gsize i = 0; i < n; i++)
    if (isnan (positions[i]))
      positions[i] = places[i];
}

/* Where the first frame's rays may lead to, and what nobody saw of it may be: what else was seen tells
 * better than the scene, which may not know where its cloth starts. */
static void
look_at_start (ClothObserver * self, const Frame * frame)
{
  const gsize n = 3 * (gsize) self->n;

  memset (self->ahead_speeds, 0, n * sizeof *self->ahead_speeds);
  if (!frame->has_places) {
    memcpy (self->ahead, self->scene_start, n * sizeof *self->ahead);
    return;
  }
  memcpy (self->ahead, frame->places, n * sizeof *self->ahead);
  fill_start (self, frame->sigma, self->scene_start, self->ahead);
}

/* Where the cloth would be at the frame that is popped if nothing drew it. */
static void
look_ahead (ClothObserver * self, const Frame * frame)
{
  const gsize n = 3 * (gsize) self->n;
  const gdouble time = frame->time;
  gdouble last, dt;

  if (self->n_popped == 0) {
    look_at_start (self, frame);
    return;
  }
  last = self->ring[(self->n_popped - 1) % WINDOW].time;
  dt = time - last;
  cloth_sim_get_velocities (self->sim, NUDGED, self->speeds);
  cloth_sim_copy_state (self->forecast, 0, self->sim, NUDGED);
  cloth_sim_advance (self->forecast, time);
  cloth_sim_get_positions (self->forecast, 0, self->ahead);
  cloth_sim_get_velocities (self->forecast, 0, self->ahead_speeds);
  /* Targets move on straight lines. Here such a line has the mean of a parabola. */
  for (gsize i = 0; i < n; i++)
    self->ahead[i] -= (self->ahead_speeds[i] - self->speeds[i]) * dt / 6;
}

static void
lift (ClothObserver * self, Frame * frame, const gdouble * reference)
{
  memcpy (frame->positions, frame->places,
      3 * (gsize) self->n * sizeof *frame->positions);
  cloth_rays_lift (frame->rays, reference, frame->positions);
  cloth_outliers_remove (self->outliers, 0., frame->positions);
}

/* Lifts this frame and those behind it to where the simulation goes. */
static void
lift_waiting (ClothObserver * self, gdouble at)
{
  for (guint64 i = self->n_popped; i < self->n_pushed; i++) {
    Frame *frame = &self->ring[i % WINDOW];
    gdouble dt = frame->time - at;

    if (!frame->has_rays)
      continue;
    for (gsize k = 0; k < 3 * (gsize) self->n; k++)
      self->reference[k] = self->ahead[k] + dt * self->ahead_speeds[k];
    lift (self, frame, self->reference);
  }
}

/* Along the rays nothing was seen to move: there the speeds are the simulation's. */
static void
take_speeds_along (const ClothObserver * self, const Frame * frame,
    const gdouble * speeds, gdouble * velocity)
{
  const ClothRays *rays = frame->rays;

  for (guint v = 0; v < self->n; v++) {
    gdouble *at = velocity + 3 * (gsize) v, across[3];
    gdouble along = cloth_rays_split (rays, v, speeds + 3 * (gsize) v, across);

    if (isfinite (frame->places[3 * (gsize) v]) && !cloth_rays_has (rays, v))
      continue;
    cloth_rays_split (rays, v, at, at);
    for (guint k = 0; k < 3; k++)
      at[k] += along * rays->directions[3 * (gsize) v + k];
  }
}

/* Standard deviation of a vertex across its ray, m. */
static gdouble
find_spread (const Frame * frame, guint vertex)
{
  const gdouble *p = frame->positions + 3 * (gsize) vertex;
  const gdouble *c = frame->rays->centres + 3 * (gsize) vertex;

  return frame->rays->spreads[vertex] *
      sqrt ((p[0] - c[0]) * (p[0] - c[0]) + (p[1] - c[1]) * (p[1] - c[1]) +
      (p[2] - c[2]) * (p[2] - c[2]));
}

/* That of all vertices that have a ray, RMS. */
static gdouble
find_usual_spread (const ClothObserver * self, const Frame * frame)
{
  gdouble sum = 0;
  guint n = 0;

  for (guint v = 0; v < self->n; v++) {
    const gdouble spread = find_spread (frame, v);

    if (!isfinite (spread))
      continue;
    sum += spread * spread;
    n++;
  }
  return n ? sqrt (sum / n) : 0;
}

/* Both copies where the first frame saw the cloth: without its noise where the cloth is smooth, since a
 * sheet with folds as sharp as its mesh bursts. Where it saw nothing at all they start with the scene. */
static void
begin (ClothObserver * self, const Frame * frame, const gdouble * velocity)
{
  const gsize n = 3 * (gsize) self->n;
  const gdouble sigma = frame->has_places ? frame->sigma :
      find_usual_spread (self, frame);
  g_autofree gdouble *seen = g_new (gdouble, self->n);
  gboolean any = FALSE;

  for (gsize i = 0; i < n; i++) {
    self->state[i] = frame->has_rays && isnan (frame->positions[i]) ?
        self->ahead[i] : frame->positions[i];
    self->speeds[i] = isfinite (velocity[i]) ? velocity[i] : 0;
    seen[i / 3] = isfinite (frame->positions[i]);
    any |= seen[i / 3] != 0.;
  }
  if (any) {
    cloth_start_smooth (self->topology, seen, sigma, self->state, self->speeds);
    fill_start (self, sigma, NULL, self->state);
  } else {
    memcpy (self->state, self->scene_start, n * sizeof *self->state);
  }
  for (guint model = NUDGED; model <= FREE; model++)
    cloth_sim_set_state (self->sim, model, self->state, self->speeds,
        frame->time);
}

static gboolean
check_state (ClothObserver * self, GError ** error)
{
  if (self->options.stop && g_atomic_int_get (self->options.stop)) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED, "stopped");
    return FALSE;
  }
  for (guint model = NUDGED; model <= FREE; model++) {
    gdouble since_s;

    if (cloth_sim_get_state (self->sim, model, &since_s) == CLOTH_SIM_OK)
      continue;
    if (self->automatic)
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "the simulation blew up at %.3f s: lower the stiffnesses and "
          "damping.stiffness of the model; and if the scene's take has no "
          "positions, give it those of the first frame, without which the "
          "cloth starts flat below its clamps, far from where it was seen",
          since_s);
    else
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "the simulation blew up at %.3f s: set “time_step” of the model "
          "below %g s or to 0, or lower the stiffnesses and damping.stiffness",
          since_s, cloth_sim_get_time_step (self->sim));
    return FALSE;
  }
  return TRUE;
}

/* The free copy goes on from where the springs have brought the other one. */
static void
open_window (ClothObserver * self, gdouble time)
{
  cloth_sim_copy_state (self->sim, FREE, self->sim, NUDGED);
  self->window_from = time;
  self->sum = 0;
  self->n_seen = self->n_all = 0;
}

static void
close_window (ClothObserver * self)
{
  self->score.from_s = self->window_from;
  self->score.to_s = self->window_to;
  self->score.rms = self->n_seen > 0 ? sqrt (self->sum / self->n_seen) : NAN;
  self->score.coverage = (gdouble) self->n_seen / self->n_all;
  self->has_score = TRUE;
}

static void
add_to_window (ClothObserver * self, const Frame * frame)
{
  cloth_sim_get_positions (self->sim, FREE, self->free_state);
  for (gsize v = 0; v < self->n; v++) {
    gdouble away[3], square;

    for (guint k = 0; k < 3; k++)
      away[k] = frame->positions[3 * v + k] - self->free_state[3 * v + k];
    if (frame->has_rays && cloth_rays_has (frame->rays, (guint) v))
      cloth_rays_split (frame->rays, (guint) v, away, away);
    square = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
    if (isfinite (square)) {
      self->sum += square;
      self->n_seen++;
    }
  }
  self->n_all += self->n;
  self->window_to = frame->time;
}

/* @observer: an observer that has a frame waiting
 * @residuals: (out caller-allocates): recorded minus simulated, 3 numbers a vertex,
 *   metres; NaN when not seen. Of rays: what is across them
 * @error: #ClothSimError when the simulation blew up, #ClothFitError when it was stopped
 *
 * Goes on by one frame. The first frame's residual is 0 where it was seen, or its noise.
 *
 * Returns: %TRUE when there is a residual; after an error only
 *   cloth_observer_restart () helps
 */
gboolean
cloth_observer_pop (ClothObserver * observer, gfloat * residuals,
    GError ** error)
{
  ClothObserver *self = observer;
  Frame *frame = &self->ring[self->n_popped % WINDOW];
  gdouble *velocity = self->velocity[self->n_popped % 2];
  gdouble gain = self->options.gain;

  if (frame->has_rays) {
    look_ahead (self, frame);
    lift_waiting (self, frame->time);
  }
  find_velocities (self, velocity);
  if (frame->has_rays)
    take_speeds_along (self, frame, self->ahead_speeds, velocity);
  if (self->n_popped == 0) {
    begin (self, frame, velocity);
  } else {
    const Frame *last = &self->ring[(self->n_popped - 1) % WINDOW];

    cloth_sim_set_targets (self->sim, NUDGED, last->positions,
        frame->positions, self->velocity[(self->n_popped - 1) % 2], velocity,
        self->weights, NULL, gain,
        2 * self->options.damping_ratio * sqrt (gain), last->time, frame->time);
    cloth_sim_advance (self->sim, frame->time);
    if (!check_state (self, error))
      return FALSE;
    cloth_sim_get_positions (self->sim, NUDGED, self->state);
    if (frame->has_rays)
      lift (self, frame, self->state);
    add_to_window (self, frame);
  }
  for (gsize i = 0; i < 3 * (gsize) self->n; i++)
    residuals[i] = (gfloat) (frame->positions[i] - self->state[i]);
  if (self->n_popped == 0) {
    open_window (self, frame->time);
  } else if (frame->time >= self->window_from +
      self->options.window_s - EARLY / self->fps) {
    close_window (self);
    open_window (self, frame->time);
  }
  self->n_popped++;
  return TRUE;
}

/* @observer: an observer that has popped a frame, and got none since
 * @positions: (out caller-allocates): where the simulation has the vertices then, drawn by the springs;
 *   3 numbers a vertex, metres
 */
void
cloth_observer_get_drawn (const ClothObserver * observer, gfloat * positions)
{
  for (gsize i = 0; i < 3 * (gsize) observer->n; i++)
    positions[i] = (gfloat) observer->state[i];
}

/* @observer: an observer that has popped a frame, and got none since
 * @positions: (out caller-allocates): where that frame has its vertices; those on rays
 *   as far away as the simulation is; 3 numbers a vertex, metres, NaN when not seen
 * @sigmas: (inout): standard deviation of each across its ray, metres. Where no camera saw a vertex
 *   alone they stay; NaN where nothing was seen at all
 */
void
cloth_observer_get_lifted (const ClothObserver * observer, gfloat * positions,
    gfloat * sigmas)
{
  const Frame *frame = &observer->ring[(observer->n_popped - 1) % WINDOW];

  for (gsize i = 0; i < 3 * (gsize) observer->n; i++)
    positions[i] = (gfloat) frame->positions[i];
  for (guint i = 0; i < observer->n; i++)
    if (frame->has_rays && cloth_rays_has (frame->rays, i))
      sigmas[i] = (gfloat) find_spread (frame, i);
    else if (isnan (frame->places[3 * (gsize) i]))
      sigmas[i] = NAN;
}

/* @observer: an observer
 * @last: at the end of a recording: also score a window that is half full, or more
 * @score: (out): the score
 *
 * To be asked after each frame that was popped, and at the end.
 *
 * Returns: %TRUE when a window was completed since it was asked last
 */
gboolean
cloth_observer_take_score (ClothObserver * observer, gboolean last,
    ClothObserverScore * score)
{
  if (last && !observer->has_score && observer->n_all > 0 &&
      observer->window_to - observer->window_from >=
      0.5 * observer->options.window_s) {
    close_window (observer);
    observer->n_all = 0;
  }
  if (!observer->has_score)
    return FALSE;
  *score = observer->score;
  observer->has_score = FALSE;
  return TRUE;
}

/* @observer: (transfer full) (nullable): an observer
 */
void
cloth_observer_free (ClothObserver * observer)
{
  if (!observer)
    return;
  for (guint i = 0; i < WINDOW; i++) {
    g_free (observer->ring[i].places);
    g_free (observer->ring[i].positions);
    cloth_rays_free (observer->ring[i].rays);
  }
  for (guint i = 0; i < 2; i++)
    g_free (observer->velocity[i]);
  g_free (observer->state);
  g_free (observer->free_state);
  g_free (observer->speeds);
  g_free (observer->weights);
  g_free (observer->scene_start);
  g_free (observer->ahead);
  g_free (observer->ahead_speeds);
  g_free (observer->reference);
  cloth_topology_free (observer->topology);
  cloth_outliers_free (observer->outliers);
  cloth_sim_free (observer->sim);
  cloth_sim_free (observer->forecast);
  g_free (observer);
}
