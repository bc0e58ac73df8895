/* What an effect is: one thing that may part a simulation from what was filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* No effect has more parameters. */
#define CLOTH_EFFECT_MAX_PARAMETERS 6
/* No parameter is tried at more values. */
#define CLOTH_EFFECT_MAX_TRIED 11

/* @CLOTH_EFFECT_PHYSICS: a force, a mass or a rest shape of the cloth
 * @CLOTH_EFFECT_CLAMP: where the clamps really were
 * @CLOTH_EFFECT_NUMERICS: how the simulator computes
 * @CLOTH_EFFECT_CAMERA: where and when the cameras say a point was
 * @CLOTH_EFFECT_IMAGE: what the picture does to a point found in it
 * @CLOTH_EFFECT_MEASUREMENT: what was done to the positions of all vertices alike
 *
 * On which side of the comparison an effect acts.
 */
typedef enum {
  CLOTH_EFFECT_PHYSICS,
  CLOTH_EFFECT_CLAMP,
  CLOTH_EFFECT_NUMERICS,
  CLOTH_EFFECT_CAMERA,
  CLOTH_EFFECT_IMAGE,
  CLOTH_EFFECT_MEASUREMENT
} ClothEffectSide;

/* @CLOTH_EFFECT_TEST_SCORE: by derivatives of what is simulated, or seen, along its parameters
 * @CLOTH_EFFECT_TEST_JUMP: the same, once for each clamp, from when the clamp is seen to
 *   jump off its path; its parameters “held” and “time” say which clamp and when
 * @CLOTH_EFFECT_TEST_STOCHASTIC: it is chance that another effect's parameters change with
 *   time: by how much these differ from one part of a take to the next; it is never
 *   accepted, as what it did follows from nothing
 * @CLOTH_EFFECT_TEST_REPEAT: by the share of pictures that show the one before once more;
 *   one effect of one parameter
 * @CLOTH_EFFECT_TEST_TRIAL: it is there or it is not: by what changes when it is there with the
 *   values that are tried, one trial each; where no trial is made, not at all
 * @CLOTH_EFFECT_TEST_NONE: not at all
 *
 * How a diagnosis tests an effect.
 */
typedef enum {
  CLOTH_EFFECT_TEST_SCORE,
  CLOTH_EFFECT_TEST_JUMP,
  CLOTH_EFFECT_TEST_STOCHASTIC,
  CLOTH_EFFECT_TEST_REPEAT,
  CLOTH_EFFECT_TEST_TRIAL,
  CLOTH_EFFECT_TEST_NONE
} ClothEffectTest;

/* @name: its key in model.json
 * @unit: in the notation of the SI, "1" for a ratio
 * @null_value: the value at which the effect is not there
 * @min: least value that makes sense
 * @max: greatest value that makes sense
 * @prior: scale of the values that a diagnosis expects: the standard deviation about
 *   @null_value, or the mean distance from it when @one_sided
 * @one_sided: nature has it on one side of @null_value only, that of @min < @max
 * @shapes: it only shapes the effect and means nothing at the null of the others: a
 *   diagnosis leaves it where it is
 * @moment: it is a time on the scene's clock; lanes have it from the first frame on, as clocks may have begun long ago
 * @n_tried: number of @tried
 * @tried: where to leave it, one trial each; none: at @null_value. Parameters of one effect that
 *   are tried have as many, which belong together
 * @blurb: one plain sentence
 *
 * One number of an effect.
 */
typedef struct {
  const gchar *name;
  const gchar *unit;
  gdouble null_value;
  gdouble min;
  gdouble max;
  gdouble prior;
  gboolean one_sided;
  gboolean shapes;
  gboolean moment;
  guint n_tried;
  gdouble tried[CLOTH_EFFECT_MAX_TRIED];
  const gchar *blurb;
} ClothEffectParameter;

/* @id: its name in model.json and gap.json
 * @side: where it acts
 * @blurb: one plain sentence
 * @source: where the law and the usual values come from
 * @regressor: how a residual force would show it, one sentence
 * @confusions: (nullable) (array zero-terminated=1): ids of effects that look alike
 * @test: how a diagnosis tests it
 * @untested: of %CLOTH_EFFECT_TEST_NONE: why not; of %CLOTH_EFFECT_TEST_TRIAL: why not where no
 *   trial is made; of %CLOTH_EFFECT_TEST_STOCHASTIC: why not where @varies isn't tested
 *   either; of a fault of the measurement: why only where it is asked for by name; one sentence
 * @varies: of %CLOTH_EFFECT_TEST_STOCHASTIC: id of the effect whose parameters change
 * @same_as: (nullable): the model's own number that it changes too: where that one is
 *   fitted to a take, the effect can't be tested on it
 * @needs_obstacles: without obstacles it does nothing, but for a parameter “floor”, the height of
 *   one that the scene doesn't state
 * @is_moving_air: it is not there where the air is still
 * @shared: of cameras: a value may hold for all of them
 * @n_parameters: number of @parameters
 * @parameters: its numbers
 *
 * The description of an effect. There is one for each, constant and shared by all.
 */
typedef struct {
  const gchar *id;
  ClothEffectSide side;
  const gchar *blurb;
  const gchar *source;
  const gchar *regressor;
  const gchar *const *confusions;
  ClothEffectTest test;
  const gchar *untested;
  const gchar *varies;
  const gchar *same_as;
  gboolean needs_obstacles;
  gboolean is_moving_air;
  gboolean shared;
  guint n_parameters;
  ClothEffectParameter parameters[CLOTH_EFFECT_MAX_PARAMETERS];
} ClothEffect;

const ClothEffect *const *cloth_effect_table (guint * n_effects);
const ClothEffect *cloth_effect_find (const gchar * id);
gboolean cloth_effect_is_among (const gchar * const *ids, const gchar * id);
const gchar *cloth_effect_side_name (ClothEffectSide side);

G_END_DECLS
