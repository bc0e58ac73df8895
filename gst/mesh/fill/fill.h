/* A mesh with holes becomes a whole one, frame by frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"
#include "gst/mesh/stencil.h"

G_BEGIN_DECLS

/* @CLOTH_FILL_PLATE: a thin plate with the flat cloth's measures, free at the cloth's
 *   border, that keeps the shape last seen as far as its surroundings keep theirs
 * @CLOTH_FILL_BILAPLACIAN: the uniform bi-Laplacian of the paper, each frame alone
 */
typedef enum {
  CLOTH_FILL_PLATE,
  CLOTH_FILL_BILAPLACIAN
} ClothFillMethod;

/* @method: what fills a hole
 * @noise_m: standard deviation of a coordinate that comes without covariance, metres
 * @max_sigma_m: a vertex less certain than this (RMS of its axes) stays unseen, metres
 * @prediction_s: how long a vertex that no ring holds is carried on, seconds
 * @outlier: a vertex is removed when it differs from what its neighbours and its past
 *   say by more than this many times what is usual around it; 0: never
 */
typedef struct {
  ClothFillMethod method;
  gdouble noise_m;
  gdouble max_sigma_m;
  gdouble prediction_s;
  gdouble outlier;
} ClothFillParameters;

/* The defaults. */
#define CLOTH_FILL_NOISE 0.0005
#define CLOTH_FILL_MAX_SIGMA 0.03
#define CLOTH_FILL_PREDICTION 0.2
#define CLOTH_FILL_OUTLIER 6.0

/* @outliers: measured vertices that were removed
 * @filled: vertices filled
 * @predicted: vertices predicted
 * @unseen: vertices that stay unseen
 * @holes: holes
 * @factored: holes whose system was new and had to be factored
 *
 * What was done to a frame.
 */
typedef struct {
  guint outliers;
  guint filled;
  guint predicted;
  guint unseen;
  guint holes;
  guint factored;
} ClothFillCounts;

typedef struct _ClothFill ClothFill;

ClothFill *cloth_fill_new (const ClothTopology * topology,
    const GArray * seams, const ClothFillParameters * parameters);
void cloth_fill_set_parameters (ClothFill * fill,
    const ClothFillParameters * parameters);
const ClothStencils *cloth_fill_get_stencils (const ClothFill * fill);
void cloth_fill_reset (ClothFill * fill);
void cloth_fill_run (ClothFill * fill, gdouble time_s,
    const ClothMeshFrame * frame, ClothMeshFrame * filled,
    ClothFillCounts * counts);
void cloth_fill_close (const ClothTopology * topology,
    const GArray * seams, gdouble noise_m, const gdouble * start,
    gfloat * positions);
void cloth_fill_free (ClothFill * fill);

void cloth_smooth_space (const ClothStencils * stencils, gdouble weight,
    const gfloat * positions, gfloat * smoothed);
void cloth_smooth_time (guint n_vertices, gdouble weight,
    const gfloat * before, const gfloat * after, gfloat * positions);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothFill, cloth_fill_free)
G_END_DECLS
