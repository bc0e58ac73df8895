/* The matrix of a linearly implicit step.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/lanes/strain.h"

/* A triangle's part: edges, stiffness by strain, the positive part of its tension. */
typedef struct
{
  ClothLane e1[3], e2[3];
  ClothLane k[3], g[3];
} ClothLaneFacet;

/* M (1 + αh) + h βK + h² K, h the γ of the formula, from the places and velocities of the last
 * cloth_lane_stiffness_update (); mass is the first term's factor. */
typedef struct
{
  ClothLaneFacet *facets;       /* of the membrane */
  ClothLaneLink *links;         /* of the mass–spring model */
  ClothLane *grip;              /* of each clamp: its stiffness where it gives, N/m */
  ClothLane mass, h, h2;
} ClothLaneStiffness;

void CLOTH_LANE_NAME (cloth_lane_stiffness_new) (const ClothLaneState * state,
    ClothLaneStiffness * matrix);
void CLOTH_LANE_NAME (cloth_lane_stiffness_clear) (ClothLaneStiffness * matrix);
void CLOTH_LANE_NAME (cloth_lane_stiffness_update) (const ClothLaneState *
    state, ClothLaneStiffness * matrix);
void CLOTH_LANE_NAME (cloth_lane_stiffness_apply) (const ClothLaneState *
    state, const ClothLaneStiffness * matrix, const ClothLane3 * d,
    ClothLane3 * q);
void CLOTH_LANE_NAME (cloth_lane_stiffness_diagonal) (const ClothLaneState *
    state, const ClothLaneStiffness * matrix, ClothLane (*inverse)[6]);
ClothLane CLOTH_LANE_NAME (cloth_lane_stiffness_change) (const ClothLaneState *
    state, const ClothLaneStiffness * matrix, const ClothLane3 * dx);
