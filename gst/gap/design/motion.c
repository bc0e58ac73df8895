/* Motions and conditions in which a cloth could be filmed next.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/design/motion.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"

/* Motions of the clamps begin within this time, s. */
#define RAMP_S 0.25
/* When the corner that is dropped is let go, s. */
#define RELEASE_S 0.2
/* Where corners are nearer to each other than this share of their distance on the flat cloth,
 * the sheet between them starts as a bow. */
#define TAUT 0.999

/* How far clamps move to each side: this share of the cloth's longest side, but no more
 * than so many metres; and how often a second. */
static const struct
{
  gdouble share, most_m, hz;
} moves[CLOTH_N_MOTIONS] = {
  [CLOTH_MOTION_SWAY] = {0.15, 0.10, 0.5},
  [CLOTH_MOTION_SWING] = {0.15, 0.10, 1.},
  [CLOTH_MOTION_LIFT] = {0.10, 0.05, 2.},
  [CLOTH_MOTION_SHAKE] = {0.10, 0.05, 3.},
};

static gboolean
is_held (const ClothHeld * held, gdouble time_s)
{
  return time_s >= held->from_s && time_s <= held->until_s;
}

/* The last frame with the most clamps. */
static void
find_frame (ClothStage * stage)
{
  const ClothRecording *r = stage->recording;
  guint most = 0;

  for (guint frame = 0; frame < r->n_frames; frame++) {
    guint n = 0;

    for (guint i = 0; i < r->scene->held->len; i++)
      n += is_held (&g_array_index (r->scene->held, ClothHeld, i),
          r->times[frame]);
    if (n >= most) {
      most = n;
      stage->frame = frame;
    }
  }
}

/* Makes @a orthogonal to @b, which has length 1, and of length 1: whether anything is left. */
static gboolean
make_orthogonal (gdouble * a, const gdouble * b)
{
  cloth_vec3_add_scaled (a, -cloth_vec3_dot (a, b), b);
  return cloth_vec3_normalise (a) > 1e-6;
}

static void
find_axes (ClothStage * stage)
{
  const gdouble *g = stage->recording->scene->gravity;
  gdouble size = cloth_vec3_length (g), widest = 0.;
  guint n = stage->held->len;

  for (guint k = 0; k < 3; k++)
    stage->up[k] = size > 0. ? -g[k] / size : k == 2;
  for (guint i = 0; i < n; i++)
    for (guint j = 0; j < i; j++) {
      gdouble apart[3], far;

      cloth_vec3_subtract (stage->clamps + 3 * i, stage->clamps + 3 * j, apart);
      far =
          cloth_vec3_dot (apart, apart) - pow (cloth_vec3_dot (apart,
              stage->up), 2.);
      if (far > widest && make_orthogonal (apart, stage->up)) {
        widest = far;
        memcpy (stage->along, apart, sizeof apart);
      }
    }
  /* one clamp, or one above the other */
  for (guint axis = 0; axis < 2 && widest == 0.; axis++) {
    gdouble unit[3] = { axis == 0, axis == 1, 0. };

    if (make_orthogonal (unit, stage->up)) {
      widest = 1.;
      memcpy (stage->along, unit, sizeof unit);
    }
  }
  cloth_vec3_cross (stage->up, stage->along, stage->normal);
}

static gdouble
find_extent (const ClothTopology * t, guint k)
{
  gdouble low = INFINITY, high = -INFINITY;

  for (guint v = 0; v < t->n_vertices; v++) {
    low = MIN (low, t->uv[2 * v + k]);
    high = MAX (high, t->uv[2 * v + k]);
  }
  return high - low;
}

/* @recording: a take; must outlive the stage
 *
 * Sets the cloth up as it was in the last frame with the most clamps.
 *
 * Returns: (transfer full): the stage
 */
ClothStage *
cloth_stage_new (const ClothRecording * recording)
{
  ClothStage *stage = g_new0 (ClothStage, 1);
  const ClothScene *scene = recording->scene;
  guint all = scene->held->len, n = 0;

  stage->recording = recording;
  stage->held = g_array_new (FALSE, FALSE, sizeof (guint));
  stage->clamps = g_new (gdouble, 3 * all + 1);
  find_frame (stage);
  for (guint i = 0; i < all; i++) {
    const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);

    if (!is_held (held, recording->times[stage->frame]))
      continue;
    g_array_append_val (stage->held, held->vertex);
    memcpy (stage->clamps + 3 * n++, scene->clamps +
        3 * ((gsize) stage->frame * all + i), 3 * sizeof (gdouble));
  }
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < 3; k++)
      stage->centre[k] += stage->clamps[3 * i + k] / n;
  find_axes (stage);
  stage->size_m = MAX (find_extent (scene->topology, 0),
      find_extent (scene->topology, 1));
  return stage;
}

/* @stage: (nullable) (transfer full): a stage
 */
void
cloth_stage_free (ClothStage * stage)
{
  if (!stage)
    return;
  g_array_unref (stage->held);
  g_free (stage->clamps);
  g_free (stage);
}

/* Which of the clamps holds the grid's upper left corner, if two hold its upper corners
 * and nothing else is held; -1. */
static gint
find_left (const ClothStage * stage)
{
  const ClothTopology *t = stage->recording->scene->topology;

  if (!t->columns || stage->held->len != 2)
    return -1;
  for (guint left = 0; left < 2; left++)
    if (g_array_index (stage->held, guint, left) == 0
        && g_array_index (stage->held, guint, 1 - left) == t->columns - 1)
      return (gint) left;
  return -1;
}

/* @stage: a stage
 * @motion: a motion
 *
 * Something must be held; among obstacles nothing is turned, as that might put the cloth
 * into one; only a grid that hangs from both its upper corners has a side edge to hang
 * from; and of the clamps one must be left when another lets go.
 *
 * Returns: whether it can be filmed with this cloth as it is held
 */
gboolean
cloth_stage_allows (const ClothStage * stage, ClothStageMotion motion)
{
  gboolean clear = stage->recording->scene->obstacles->len == 0;

  if (!stage->held->len)
    return FALSE;
  switch (motion) {
    case CLOTH_MOTION_TURN:
      return clear;
    case CLOTH_MOTION_EDGE:
      return clear && find_left (stage) >= 0;
    case CLOTH_MOTION_DROP:
      return stage->held->len > 1;
    default:
      return TRUE;
  }
}

static gdouble
amplitude (const ClothStage * stage, ClothStageMotion motion)
{
  gdouble a = MIN (moves[motion].share * stage->size_m, moves[motion].most_m);

  return MAX (0.01, round (100. * a) / 100.);
}

/* The displacement of the clamps @time_s after their motion began, m. */
static void
displace (const ClothStage * stage, ClothStageMotion motion, gdouble time_s,
    gdouble * offset)
{
  const gdouble *axis = motion == CLOTH_MOTION_LIFT ? stage->up :
      motion == CLOTH_MOTION_SWING ? stage->along : stage->normal;
  gdouble ramp = MIN (1., time_s / RAMP_S), far = 0.;

  if (moves[motion].hz > 0.)
    far = amplitude (stage, motion) * ramp * ramp * (3. - 2. * ramp) *
        sin (2. * G_PI * moves[motion].hz * time_s);
  for (guint k = 0; k < 3; k++)
    offset[k] = far * axis[k];
}

/* Turns a point by 90° about the vertical through the clamps' centre. */
static void
turn (const ClothStage * stage, gdouble * p)
{
  gdouble from[3], height;

  cloth_vec3_subtract (p, stage->centre, from);
  height = cloth_vec3_dot (from, stage->up);
  for (guint k = 0; k < 3; k++)
    p[k] = stage->centre[k] + height * stage->up[k] +
        cloth_vec3_dot (from, stage->along) * stage->normal[k] -
        cloth_vec3_dot (from, stage->normal) * stage->along[k];
}

/* Hangs the grid from the corners of its last column, with the same ratio of their distance to
 * that on the flat cloth as those of the first row had. */
static void
hang_by_edge (const ClothStage * stage, ClothScene * scene, gdouble * clamps,
    gboolean start)
{
  const ClothTopology *t = scene->topology;
  gint left = find_left (stage);
  const gdouble *a = stage->clamps + 3 * left;
  const gdouble *b = stage->clamps + 3 * (1 - left);
  gdouble width = find_extent (t, 0), height = find_extent (t, 1), apart = 0.;
  gdouble ratio, bow;

  for (guint k = 0; k < 3; k++)
    apart += (b[k] - a[k]) * (b[k] - a[k]);
  ratio = sqrt (apart) / width;
  /* of a shallow bow, the length over the chord is 1 + (π·bow/2)² */
  bow = ratio < TAUT ? 2. / G_PI * sqrt (1. / ratio - 1.) * ratio * height : 0.;
  for (guint v = 0; v < t->n_vertices; v++) {
    gdouble down = t->uv[2 * (t->columns - 1)] - t->uv[2 * v];
    gdouble across = (t->uv[2 * v + 1] - t->uv[1]) / height;

    for (guint k = 0; k < 3 && start; k++)
      scene->positions[3 * v + k] = stage->centre[k] -
          down * stage->up[k] + (across - 0.5) * ratio * height *
          stage->along[k] + bow * sin (G_PI * across) * stage->normal[k];
  }
  for (guint i = 0; i < 2; i++) {
    g_array_index (scene->held, ClothHeld, i).vertex = i ?
        t->columns * t->rows - 1 : t->columns - 1;
    for (guint k = 0; k < 3; k++)
      clamps[3 * i + k] = stage->centre[k] +
          (i - 0.5) * ratio * height * stage->along[k];
  }
}

/* @stage: a stage that allows @motion
 * @motion: how the cloth moves
 * @fps: frames a second
 * @seconds: how long
 * @start: (nullable) (array): where the vertices are at the start, [n][3], m: before the
 *   sheet is turned about the vertical; %NULL: as they were recorded, or flat when it
 *   hangs from its side edge
 *
 * Returns: (transfer full): the scene; it begins at 0 s, at rest
 */
ClothScene *
cloth_stage_make_scene (const ClothStage * stage, ClothStageMotion motion,
    gdouble fps, gdouble seconds, const gdouble * start)
{
  const ClothRecording *r = stage->recording;
  guint n = stage->held->len, n_frames = MAX (CLOTH_RECORDING_WINDOW,
      (guint) round (seconds * fps) + 1);
  ClothScene *scene = cloth_scene_new (cloth_topology_copy (r->scene->topology),
      fps, n_frames);
  g_autofree gdouble *clamps = g_memdup2 (stage->clamps,
      3 * n * sizeof (gdouble) + 1);

  memcpy (scene->gravity, r->scene->gravity, sizeof scene->gravity);
  g_array_unref (scene->obstacles);
  scene->obstacles = cloth_obstacles_copy (r->scene->obstacles);
  g_array_append_vals (scene->seams, r->scene->seams->data,
      r->scene->seams->len);
  memcpy (scene->positions, start ? start :
      r->y + 3 * (gsize) stage->frame * r->n, 3 * r->n * sizeof (gdouble));
  for (guint i = 0; i < n; i++) {
    ClothHeld held = { g_array_index (stage->held, guint, i), -INFINITY,
      motion == CLOTH_MOTION_DROP && i == n - 1 ? RELEASE_S : INFINITY
    };

    g_array_append_val (scene->held, held);
  }
  if (motion == CLOTH_MOTION_EDGE)
    hang_by_edge (stage, scene, clamps, !start);
  if (motion == CLOTH_MOTION_TURN) {
    for (guint v = 0; v < r->n; v++)
      turn (stage, scene->positions + 3 * v);
    for (guint i = 0; i < n; i++)
      turn (stage, clamps + 3 * i);
  }
  scene->clamps = g_new (gdouble, 3 * (gsize) n * n_frames + 1);
  for (guint frame = 0; frame < n_frames; frame++) {
    gdouble offset[3];

    displace (stage, motion, scene->times[frame], offset);
    for (guint i = 0; i < 3 * n; i++)
      scene->clamps[3 * (gsize) n * frame + i] = clamps[i] + offset[i % 3];
  }
  return scene;
}

/* @stage: a stage
 * @motion: a motion
 *
 * Returns: (transfer full): what to do, without a full stop
 */
gchar *
cloth_stage_describe (const ClothStage * stage, ClothStageMotion motion)
{
  static const gchar *const still[CLOTH_N_MOTIONS] = {
    [CLOTH_MOTION_HANG] = "Let the sheet hang still and film it for %g s",
    [CLOTH_MOTION_TURN] = "Turn the sheet with its clamps by 90° about the "
        "vertical, let it hang still and film it for %g s",
    [CLOTH_MOTION_EDGE] = "Turn the sheet by 90° in its plane: hang it by the "
        "two corners of its side edge (u largest), let it hang still and film it for %g s",
    [CLOTH_MOTION_DROP] = "Let one of the clamps go and film for %g s how the "
        "sheet falls",
    [CLOTH_MOTION_FAN_OFF] = "Keep all moving air away (fans off, doors shut), "
        "let the sheet hang still and film it for %g s",
  };
  static const gchar *const moving[CLOTH_N_MOTIONS] = {
    [CLOTH_MOTION_SWAY] = "Sway the clamps slowly out of the sheet's plane and "
        "back",
    [CLOTH_MOTION_SWING] = "Swing the clamps from side to side in the sheet's "
        "plane",
    [CLOTH_MOTION_LIFT] = "Move the clamps up and down",
    [CLOTH_MOTION_SHAKE] = "Shake the clamps fast out of the sheet's plane and "
        "back",
  };

  if (motion == CLOTH_MOTION_FAN_ON)
    return g_strdup_printf ("Let a fan blow square at the hanging sheet with "
        "%g m/s, film it for %g s, and give that wind to the model",
        CLOTH_MOTION_FAN_M_S, CLOTH_MOTION_SECONDS);
  if (moving[motion])
    return g_strdup_printf ("%s, by %g cm to each side %g times a second, and "
        "film it for %g s", moving[motion], 100. * amplitude (stage, motion),
        moves[motion].hz, CLOTH_MOTION_SECONDS);
  return g_strdup_printf (still[motion], CLOTH_MOTION_SECONDS);
}
