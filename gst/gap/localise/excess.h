/* How far a residual is above what it would be without a gap, vertex by vertex.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"

G_BEGIN_DECLS

/* @recording: what was recorded
 * @off: simulated less recorded while the simulation was nudged to it all along,
 *   [n_frames][n][3], m; what is not seen and the first frame don't count
 */
typedef struct {
  const ClothRecording *recording;
  const gfloat *off;
} ClothNudgedResidual;

/* @smooth_s: residuals are averaged over so long
 * @sharpen: a force drags neighbours along: so much of the difference to each is added
 * @gate: residuals of more than so many deviations count by their size, not their square
 *   (Huber 1964)
 * @null_alike: how much of the null's residual returns at random in a take that moves as
 *   it did and had it taken off
 * @null_other: how much of it is expected in a take that moves otherwise
 * @doubt: this many times the null must be exceeded for there to be a place
 * @block_s: length of the blocks of the bootstrap
 * @draws: of the bootstrap
 * @significance: how often a place may be found where there is none
 * @onset_ratio: square of a residual over the null's that supports a gap
 * @onset_evidence: so much of the logarithms of it must add up
 * @beginning_s: what begins earlier is there from the beginning
 * @seed: of the bootstrap
 */
typedef struct {
  gdouble smooth_s;
  gdouble sharpen;
  gdouble gate;
  gdouble null_alike;
  gdouble null_other;
  gdouble doubt;
  gdouble block_s;
  guint draws;
  gdouble significance;
  gdouble onset_ratio;
  gdouble onset_evidence;
  gdouble beginning_s;
  guint64 seed;
} ClothLocalisationOptions;

/* Squares of residuals over those of the null, less 1: [n_frames][n]; and whether they
 * are known. */
typedef struct {
  guint n;
  guint n_frames;
  gfloat *values;
  guint8 *known;
} ClothExcess;

void cloth_localisation_options_init (ClothLocalisationOptions * options);
ClothExcess *cloth_excess_new (const ClothNudgedResidual * take,
    const ClothNudgedResidual * nulls, guint n_nulls, gboolean alike, gboolean smooth,
    const ClothLocalisationOptions * options);
ClothExcess *cloth_excess_new_null (const ClothNudgedResidual * null,
    const ClothLocalisationOptions * options);
void cloth_excess_free (ClothExcess * excess);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothExcess, cloth_excess_free)
G_END_DECLS
