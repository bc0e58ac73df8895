/* Pulls: weak forces that draw points of a simulated cloth to what was seen of them. One form
 * for all evidence: a marker, a camera's ray, a point of a contour.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @CLOTH_PULL_LINEAR: f ∝ d: follows best, and every outlier
 * @CLOTH_PULL_RECIPROCAL: f ∝ 1/d: outliers hardly count
 * @CLOTH_PULL_RECIPROCAL_SQUARE: f ∝ 1/d²: less still
 *
 * How a force falls off with the distance (Hasler et al., section 3).
 */
typedef enum {
  CLOTH_PULL_LINEAR,
  CLOTH_PULL_RECIPROCAL,
  CLOTH_PULL_RECIPROCAL_SQUARE
} ClothPullLaw;

/* @CLOTH_PULL_BALANCED: f_i = ω_i f, which keeps force and moment
 * @CLOTH_PULL_PRINTED: f_i = ω_i·2f / (1 + ω₁² + ω₂² + ω₃²), as the paper prints it after
 *   Bridson et al.: 1.5 f in all at the middle of a triangle
 *
 * What of a force f at the barycentric place ω the corners of its triangle feel.
 */
typedef enum {
  CLOTH_PULL_BALANCED,
  CLOTH_PULL_PRINTED
} ClothPullShares;

/* @target: a place y that the point is drawn to, m, world
 * @velocity: how fast that is, m/s
 * @information: inverse covariance Λ of @target: xx, yy, zz, yz, xz, xy, 1/m²; not negative
 *   in any direction. Of rank 3: a marker, or a vertex with its covariance; of rank 2: a ray,
 *   along which Λ is 0 and @target any point near the cloth; of rank 1: a point of a contour,
 *   which is known along the contour's normal only; 0: nothing was seen
 */
typedef struct {
  gdouble target[3];
  gdouble velocity[3];
  gdouble information[6];
} ClothPullEnd;

/* @corner: vertices of a triangle; of a pull at a vertex all three are that one
 * @weight: barycentric place ω of the point in it; sum 1
 * @now: what draws it at the start of the interval
 * @next: at its end; between them all numbers lie on straight lines
 *
 * In an interval of time a point p = Σ ω_i x_i of mass m = Σ ω_i m_i feels
 * f = m ψ(d) σ² Λ (gain (y − p) + damping (y′ − p′)), d² = (y − p)ᵀ Λ (y − p): the distance in
 * standard deviations. ψ = 1, 1/(d² + s²) or 1/(d² + s²)^{3/2} with the softening s.
 */
typedef struct {
  guint32 corner[3];
  gdouble weight[3];
  ClothPullEnd now;
  ClothPullEnd next;
} ClothPull;

/* @law: how the force falls off
 * @softening: s, in standard deviations (1); of the linear law nothing
 * @shares: what the corners feel
 * @sigma: σ, m: where Λ = 1/σ² the point is drawn with the gain itself
 */
typedef struct {
  ClothPullLaw law;
  gdouble softening;
  ClothPullShares shares;
  gdouble sigma;
} ClothPullOptions;

G_END_DECLS
