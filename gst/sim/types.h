/* What the parts of the simulator share with its callers: errors, options, energy.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

/* @CLOTH_SIM_ERROR_SCENE: the scene can't be simulated
 * @CLOTH_SIM_ERROR_MODEL: a model is impossible
 * @CLOTH_SIM_ERROR_PULL: what draws the cloth is impossible, or too strong
 */
typedef enum {
  CLOTH_SIM_ERROR_SCENE,
  CLOTH_SIM_ERROR_MODEL,
  CLOTH_SIM_ERROR_PULL
} ClothSimError;

#define CLOTH_SIM_ERROR (cloth_sim_error_quark ())
GQuark cloth_sim_error_quark (void);

/* @single: numbers of single precision: twice as many models at a time
 * @threads: threads to use, 0 = one for each processor
 * @simd: vector instructions to use; the result does not depend on them
 * @seed: of what is random in effects
 * @stop: (nullable): atomic: as soon as it isn't 0, cloth_sim_advance () comes back, and the models have to get a
 *   state anew
 */
typedef struct {
  gboolean single;
  guint threads;
  ClothSimd simd;
  guint64 seed;
  const gint *stop;
} ClothSimOptions;

/* @kinetic: of motion, J
 * @elastic: of stretch, shear and bending, J
 * @gravity: of height above the origin, J
 */
typedef struct {
  gdouble kinetic;
  gdouble elastic;
  gdouble gravity;
} ClothSimEnergy;

G_END_DECLS
