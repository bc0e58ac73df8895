/* What cameras saw of a recorded cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/rig.h"

G_BEGIN_DECLS

/* @row: row of a picture, 0 the uppermost
 * @begin: first column that is cloth
 * @end: the column after the last one
 *
 * Pixels of a row that follow each other and are cloth.
 */
typedef struct {
  guint16 row, begin, end;
} ClothRun;

/* @camera: its index in the rig
 * @time_s: when, by the camera's clock
 * @n: number of points
 * @vertices: (array length=n): which vertex of the cloth each of them is, growing
 * @px: (array length=n): x, y of each, px as filmed
 * @covariances: (array length=n): xx, xy, yy of each, px²
 * @has_silhouette: whether it is known which pixels are cloth
 * @n_runs: into how many runs these fall
 * @runs: (array length=n_runs): they, row by row from the left
 *
 * One picture.
 */
typedef struct {
  guint camera;
  gdouble time_s;
  guint n;
  guint32 *vertices;
  gdouble *px;
  gdouble *covariances;
  gboolean has_silhouette;
  guint n_runs;
  ClothRun *runs;
} ClothObservation;

/* @rig: the cameras as calibrated
 * @n_vertices: number of the cloth's vertices
 * @list: (element-type ClothObservation): the pictures, of each camera in the order of time
 *
 * All pictures of one take.
 */
typedef struct {
  ClothRig *rig;
  guint n_vertices;
  GArray *list;
} ClothObservations;

ClothObservations *cloth_observations_new (ClothRig * rig, guint n_vertices);
gboolean cloth_observations_add (ClothObservations * observations, guint camera, gdouble time_s,
    guint n, const guint32 * vertices, const gdouble * px,
    const gdouble * covariances, GError ** error);
gboolean cloth_observations_set_silhouette (ClothObservations * observations,
    guint n_runs, const ClothRun * runs, GError ** error);
gboolean cloth_observations_has_silhouettes (const ClothObservations * observations, guint camera);
void cloth_observations_free (ClothObservations * observations);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothObservations, cloth_observations_free)
G_END_DECLS
