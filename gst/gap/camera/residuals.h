/* One frame: what each camera's picture shows of the points, less what its camera model
 * predicts, with the derivatives of that by the points' positions and by the cameras' faults.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/camera/candidates.h"
#include "gst/gap/camera/view.h"

G_BEGIN_DECLS

/* Every stride-th vertex, as it moved. */
typedef struct
{
  guint n, stride;
  gdouble *positions;
  const gdouble **frames;
  ClothMotion motion;
} ClothCameraPoints;

/* @stride: that or a little more, so that vertices of a grid are of all its columns. */
void cloth_camera_points_init (ClothCameraPoints * p, const ClothCameraView * v,
    guint stride);
void cloth_camera_points_clear (ClothCameraPoints * p);

/* @CLOTH_CAMERA_DROPS: in the last column the difference to the prediction for the time of
 *   the picture before
 * @CLOTH_CAMERA_FAULTS: the derivatives by all faults, and in the last column that
 *   difference where the picture is stale
 * @CLOTH_CAMERA_DISPLACEMENT: in the last column the difference to what the rig's cameras,
 *   without faults, would see
 * @CLOTH_CAMERA_SHIFT: none
 *
 * What the columns of a picture are to hold.
 */
typedef enum
{
  CLOTH_CAMERA_DROPS,
  CLOTH_CAMERA_FAULTS,
  CLOTH_CAMERA_DISPLACEMENT,
  CLOTH_CAMERA_SHIFT
} ClothCameraColumns;

/* One picture. z, j and b are whitened: multiplied by the inverse Cholesky factor of the
 * covariance of each observed point. */
typedef struct
{
  const ClothObservation *observation;
  gint *at;                     /* [n]: index in the observation, or -1 */
  gdouble *px, *other;          /* [n][2]: predicted, px; a second prediction */
  gdouble *z;                   /* [n][2]: observed less predicted */
  gdouble *e;                   /* [n]: length of z less its part that a shift of the point explains */
  gdouble *sorted;              /* [n]: those of e that are known */
  gdouble *j;                   /* [n][2][3]: derivative by the point's position */
  guint n_columns;
  gdouble *b;                   /* [n][2][n_columns]: derivative by the camera's faults; the
                                 * last column is that of lost pictures */
  gdouble gross;                /* an e above this is an outlier */
} ClothCameraPicture;

void cloth_camera_picture_init (ClothCameraPicture * p, guint n);
void cloth_camera_picture_clear (ClothCameraPicture * p);
/* Fills the pictures of a frame, one for each camera. */
void cloth_camera_look (const ClothCameraView * v,
    const ClothCameraPoints * points, ClothCameraColumns columns,
    ClothCameraPicture * pictures, guint frame);

/* The normal equations JᵀJ dx = Jᵀz of a point's shift dx, summed over its pictures. */
typedef struct
{
  guint n;                      /* pictures that count */
  guint cameras[CLOTH_RIG_MAX_CAMERAS];
  gboolean contradicted;        /* whether an outlier was left out */
  gdouble a[9];                 /* Cholesky factor L of JᵀJ */
  gdouble u[3];                 /* L⁻¹ Jᵀz */
  gdouble z2;                   /* zᵀz */
} ClothCameraPoint;

/* FALSE when fewer than two pictures see the point; @all: outliers count, too. */
gboolean cloth_camera_gather (const ClothCameraPicture * pictures,
    guint n_cameras, guint i, gboolean all, ClothCameraPoint * point);
/* x becomes L⁻¹x, or L⁻ᵀx. */
void cloth_camera_forward (const gdouble * l, gdouble * x);
void cloth_camera_backward (const gdouble * l, gdouble * x);

G_END_DECLS
