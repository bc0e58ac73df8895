/* How one camera takes its pictures, and what that makes of moving points.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/math/vec3.h"
#include "gst/rig/rig.h"

/* Longest text of effects, and most effects in it. */
#define MAX_TEXT 4096
/* The time of a row and the row at that time settle within so many steps: each makes the
 * error smaller by the share of the picture that the point crosses while it is read. */
#define MAX_ROW_STEPS 20
#define ROW_SETTLED_PX 1e-9

typedef struct
{
  const ClothEffect *effect;
  void (*apply) (const gdouble * values, ClothCapture * capture);
} CaptureEffect;

#define CAPTURE(name) extern const ClothEffect cloth_effect_##name;
#include "gst/effect/list.h"

static const CaptureEffect effects[] = {
#define CAPTURE(name) { &cloth_effect_##name, cloth_capture_##name },
#include "gst/effect/list.h"
};

/* @capture: (out): overwritten
 * @camera: the camera as calibrated
 *
 * A capture without any effect. The target is a corner of a printed checkerboard: 150
 * grey levels of contrast, 2 of noise, 0.7 px of blur, a window of ±5 px.
 */
void
cloth_capture_init (ClothCapture * capture, const ClothCamera * camera)
{
  *capture = (ClothCapture) {
    .camera = *camera,.target = { 150, 2, 0.7, 5, 0 }
  };
  capture->camera.name = NULL;
  capture->camera.device = NULL;
}

static const CaptureEffect *
find (const gchar * id)
{
  for (guint i = 0; i < G_N_ELEMENTS (effects); i++)
    if (g_str_equal (effects[i].effect->id, id))
      return &effects[i];
  return NULL;
}

static gchar *
list_effects (void)
{
  GString *text = g_string_new (NULL);

  for (guint i = 0; i < G_N_ELEMENTS (effects); i++)
    g_string_append_printf (text, "%s%s", i ? ", " : "", effects[i].effect->id);
  return g_string_free (text, FALSE);
}

static gchar *
list_parameters (const ClothEffect * effect)
{
  GString *text = g_string_new (NULL);

  for (guint i = 0; i < effect->n_parameters; i++)
    g_string_append_printf (text, "%s%s", i ? ", " : "",
        effect->parameters[i].name);
  return g_string_free (text, FALSE);
}

static const CaptureEffect *
find_or_tell (const gchar * id, GError ** error)
{
  const CaptureEffect *found = find (id);
  g_autofree gchar *known = NULL;

  if (found)
    return found;
  known = list_effects ();
  g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
      "“%s” is no camera or image effect; there are: %s", id, known);
  return NULL;
}

static gboolean
check_value (const ClothEffect * effect, guint index, gdouble value,
    GError ** error)
{
  const ClothEffectParameter *p = &effect->parameters[index];

  if (value >= p->min && value <= p->max)
    return TRUE;
  g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
      "%s: %s is %g: use %g to %g %s", effect->id, p->name, value, p->min,
      p->max, g_str_equal (p->unit, "1") ? "" : p->unit);
  return FALSE;
}

/* @capture: a capture
 * @id: name of a camera or image effect
 * @values: one number for each of its parameters, in their order
 * @error: return location
 *
 * Adds an effect to what there is. With all values null no bit of @capture changes.
 *
 * Returns: %TRUE; %FALSE with %CLOTH_RIG_ERROR_VALUE when there is no such effect or a
 *   value is outside its range
 */
gboolean
cloth_capture_add_effect (ClothCapture * capture, const gchar * id,
    const gdouble * values, GError ** error)
{
  const CaptureEffect *found = find_or_tell (id, error);

  if (!found)
    return FALSE;
  for (guint i = 0; i < found->effect->n_parameters; i++)
    if (!check_value (found->effect, i, values[i], error))
      return FALSE;
  found->apply (values, capture);
  return TRUE;
}

/* name=number of one effect. */
static gboolean
read_parameter (const ClothEffect * effect, const gchar * text,
    gdouble * values, guint * seen, GError ** error)
{
  g_auto (GStrv) sides = g_strsplit (text, "=", 2);
  g_autofree gchar *known = list_parameters (effect);

  if (sides[0] && sides[1]) {
    const gchar *name = g_strstrip (sides[0]), *number = g_strstrip (sides[1]);

    for (guint i = 0; i < effect->n_parameters; i++) {
      gchar *end = NULL;

      if (!g_str_equal (effect->parameters[i].name, name))
        continue;
      if (*seen & 1u << i) {
        g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
            "%s: %s is there twice", effect->id, name);
        return FALSE;
      }
      values[i] = g_ascii_strtod (number, &end);
      if (end == number || *end) {
        g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
            "%s: %s is “%s”: use a number", effect->id, name, number);
        return FALSE;
      }
      *seen |= 1u << i;
      return check_value (effect, i, values[i], error);
    }
  }
  g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
      "%s: “%s” is not name=number with a name of: %s", effect->id, text,
      known);
  return FALSE;
}

static gboolean
read_effect (ClothCapture * capture, const gchar * text, GError ** error)
{
  g_auto (GStrv) parts = g_strsplit (text, ",", -1);
  const CaptureEffect *found = find_or_tell (g_strstrip (parts[0]), error);
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
  guint seen = 0;

  if (!found)
    return FALSE;
  for (guint i = 0; i < found->effect->n_parameters; i++)
    values[i] = found->effect->parameters[i].null_value;
  for (guint i = 1; parts[i]; i++)
    if (!read_parameter (found->effect, g_strstrip (parts[i]), values, &seen,
            error))
      return FALSE;
  if (!seen) {
    g_autofree gchar *known = list_parameters (found->effect);

    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "%s: say how much, as name=number, with: %s", found->effect->id, known);
    return FALSE;
  }
  found->apply (values, capture);
  return TRUE;
}

/* @capture: a capture
 * @text: (nullable): effects with their parameters:
 *   `noise,sigma=3; rolling_shutter,seconds=0.01`
 * @error: return location
 *
 * Adds effects that a person has typed. Parameters that are left out are null. Effects
 * act from the light to the picture whatever the order they are named in.
 *
 * Returns: %TRUE; %FALSE with %CLOTH_RIG_ERROR_VALUE, @capture being as before
 */
gboolean
cloth_capture_add_effects (ClothCapture * capture, const gchar * text,
    GError ** error)
{
  ClothCapture changed = *capture;
  g_auto (GStrv) parts = NULL;

  if (!text)
    return TRUE;
  if (strlen (text) > MAX_TEXT || !g_utf8_validate (text, -1, NULL)) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "effects are UTF-8 of at most %d bytes", MAX_TEXT);
    return FALSE;
  }
  parts = g_strsplit (text, ";", -1);
  for (guint i = 0; parts[i]; i++)
    if (*g_strstrip (parts[i]) && !read_effect (&changed, parts[i], error))
      return FALSE;
  *capture = changed;
  return TRUE;
}

/* @capture: a capture
 * @frame: number of the picture; the first, 0, is never lost
 * @seed: any number
 *
 * Returns: whether the picture is lost: a function of its arguments only
 */
gboolean
cloth_capture_is_dropped (const ClothCapture * capture, guint64 frame,
    guint64 seed)
{
  ClothRandom random;

  if (capture->drop_rate == 0 || frame == 0)
    return FALSE;
  cloth_random_init (&random, seed);
  cloth_random_init (&random, cloth_random_bits (&random) ^ frame);
  return cloth_random_uniform (&random) < capture->drop_rate;
}

/* Where a point of the cloth, a weighted mean of vertices, is at a time; its velocity. */
static void
locate (const ClothMotion * motion, guint n_parents, const guint * parents,
    const gdouble * weights, gdouble time_s, gdouble X[3], gdouble * velocity)
{
  if (n_parents == 1) {
    cloth_motion_at (motion, parents[0], time_s, X, velocity);
    return;
  }
  X[0] = X[1] = X[2] = 0;
  if (velocity)
    velocity[0] = velocity[1] = velocity[2] = 0;
  for (guint i = 0; i < n_parents; i++) {
    gdouble part[3], rate[3];

    cloth_motion_at (motion, parents[i], time_s, part, velocity ? rate : NULL);
    for (gint k = 0; k < 3; k++) {
      X[k] += weights[i] * part[k];
      if (velocity)
        velocity[k] += weights[i] * rate[k];
    }
  }
}

static gboolean
project (const ClothCapture * capture, const ClothMotion * motion,
    guint n_parents, const guint * parents, const gdouble * weights,
    gdouble time_s, gdouble px[2], gdouble seen[3], gdouble * velocity,
    gdouble * d_point)
{
  const ClothCamera *camera = &capture->camera;
  const gdouble start = time_s - camera->offset_s;
  const gdouble a_row = camera->height > 1 ?
      camera->rolling_shutter_s / (camera->height - 1) : 0;
  gdouble row = 0;

  locate (motion, n_parents, parents, weights, start, seen, velocity);
  if (!cloth_camera_project (camera, seen, px, d_point, NULL))
    return FALSE;
  for (guint i = 0; a_row != 0 && i < MAX_ROW_STEPS; i++) {
    const gdouble last = row;

    /* Off the picture nothing is read out; this only keeps times near. */
    row = CLAMP (px[1], -camera->height, 2 * camera->height);
    if (fabs (row - last) < ROW_SETTLED_PX)
      break;
    locate (motion, n_parents, parents, weights, start + a_row * row, seen,
        velocity);
    if (!cloth_camera_project (camera, seen, px, d_point, NULL))
      return FALSE;
  }
  return TRUE;
}

/* @capture: a capture
 * @motion: the cloth's vertices
 * @n_parents: how many vertices the point is the mean of
 * @parents: (array length=n_parents): these vertices
 * @weights: (array length=n_parents): their shares, of sum 1
 * @time_s: the picture's time by the camera's clock
 * @px: (out caller-allocates): where the point is seen
 * @seen: (out caller-allocates): where it was in the world at that instant, metres
 *
 * Sees one point at one instant of the exposure: @time_s, moved by the camera's offset
 * and by the row on which the point falls.
 *
 * Returns: %FALSE when the point is behind the camera or not known
 */
gboolean
cloth_capture_project (const ClothCapture * capture,
    const ClothMotion * motion, guint n_parents, const guint * parents,
    const gdouble * weights, gdouble time_s, gdouble px[2], gdouble seen[3])
{
  return project (capture, motion, n_parents, parents, weights, time_s, px,
      seen, NULL, NULL);
}

/* Cramér–Rao bound of a point at the crossing of two edges, px²: an edge of length l,
 * contrast C and Gaussian blur b in noise s is known to s²·2√π·b/(C²·l) across; for a
 * blur that differs by direction b is the root of the matrix blur[3] = xx, xy, yy. */
static void
bound (const ClothCaptureTarget * target, gdouble noise2, gdouble contrast,
    const gdouble blur[3], gdouble covariance[3])
{
  const gdouble scale = noise2 * 2 * sqrt (G_PI)
      / (contrast * contrast * 2 * target->window_px);
  const gdouble s = sqrt (MAX (blur[0] * blur[2] - blur[1] * blur[1], 0));
  const gdouble t = sqrt (blur[0] + blur[2] + 2 * s);

  covariance[0] = scale * (blur[0] + s) / t;
  covariance[1] = scale * blur[1] / t;
  covariance[2] = scale * (blur[2] + s) / t;
}

/* What the effects add to a point's covariance; @w is its velocity in the picture. */
static void
spread (const ClothCapture * capture, const gdouble w[2], gdouble lag_variance,
    gdouble added[3])
{
  const ClothCaptureTarget *target = &capture->target;
  const gdouble b2 = target->blur_px * target->blur_px;
  const gdouble streak = capture->exposure_s * capture->exposure_s / 12;
  const gdouble d2 = b2 + capture->defocus_px * capture->defocus_px;
  const gdouble ww[3] = { w[0] * w[0], w[0] * w[1], w[1] * w[1] };
  const gdouble plain[3] = { b2, 0, b2 };
  const gdouble blurred[3] = { d2 + streak * ww[0], streak * ww[1],
    d2 + streak * ww[2]
  };
  const gdouble noise2 = target->noise * target->noise;
  gdouble without[3], with[3];

  bound (target, noise2, target->contrast, plain, without);
  /* Half the light falls on a window that is half bright. */
  bound (target, noise2 + capture->read_noise * capture->read_noise
      + capture->shot_noise * capture->shot_noise / 2,
      target->contrast * (1 - 1.5 * capture->crosstalk), blurred, with);
  for (gint i = 0; i < 3; i++)
    added[i] = with[i] - without[i] + lag_variance * ww[i];
}

/* @capture: a capture
 * @motion: where the points really are, a frame or more before and behind @time_s
 * @time_s: the picture's time by the camera's clock
 * @px: (array) (out caller-allocates): x, y of each point, px; NaN when it is behind the
 *   camera or not known
 * @covariances: (nullable) (array) (out caller-allocates): xx, xy, yy of each point, px²:
 *   what the effects add to the covariance that a measured point has without them
 *
 * Predicts where the points will be measured on average, and how much more they scatter.
 * Occlusion is not looked at. Lost pictures count by their mean: each point is later by
 * the mean number of pictures lost in a row. Without effects this is
 * cloth_camera_project () to the bit, and the covariances are 0.
 *
 * Returns: how many points are seen
 */
guint
cloth_capture_observe (const ClothCapture * capture,
    const ClothMotion * motion, gdouble time_s, gdouble * px,
    gdouble * covariances)
{
  const ClothCaptureTarget *target = &capture->target;
  const gdouble one = 1, rate = capture->drop_rate;
  const gdouble interval = motion->n_frames < 2 ? 0 :
      (motion->times[motion->n_frames - 1] - motion->times[0])
      / (motion->n_frames - 1);
  const gdouble lag = interval * rate / (1 - rate);
  const gdouble lag_variance = interval * interval * rate
      / ((1 - rate) * (1 - rate));
  const gdouble middle = time_s + capture->exposure_s / 2 - lag;
  guint n_seen = 0;

  for (guint i = 0; i < motion->n_points; i++) {
    gdouble *p = px + 2 * (gsize) i, seen[3], v[3], J[6];
    gboolean good = project (capture, motion, 1, &i, &one, middle, p, seen, v,
        J);

    if (good && target->dot_radius_m > 0) {
      const gdouble *R = capture->camera.R;
      const gdouble depth = cloth_vec3_dot (R + 6, seen) + capture->camera.t[2];
      const gdouble radius = target->dot_radius_m * capture->camera.K[0]
          / depth;

      for (gint k = 0; k < 2; k++)
        p[k] += capture->light_gradient[k] * radius * radius / 4;
    }
    if (!good)
      p[0] = p[1] = NAN;
    n_seen += !!good;
    if (covariances) {
      gdouble *added = covariances + 3 * (gsize) i;
      const gdouble w[2] = { cloth_vec3_dot (J, v), cloth_vec3_dot (J + 3, v) };

      if (good)
        spread (capture, w, lag_variance, added);
      else
        added[0] = added[1] = added[2] = NAN;
    }
  }
  return n_seen;
}
