/* Private to camera.c, cameracandidate.c, cameraframe.c and camerasolve.c.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/camera/view.h"

G_BEGIN_DECLS

/* Columns of each camera; the last one is frame_drop, which has no derivative. */
#define CLOTH_CAMERA_N_COLUMNS 10
#define CLOTH_CAMERA_DROP (CLOTH_CAMERA_N_COLUMNS - 1)
/* Finite differences are this share of a prior. */
#define CLOTH_CAMERA_STEP 0.05

const ClothEffect *cloth_camera_column (guint column, guint * parameter);

/* The picture of a frame; whether it shows the one before once more. */
static inline const ClothObservation **
cloth_camera_picture (const ClothCameraView * v, guint frame, guint camera)
{
  return v->pictures + (gsize) frame * v->observations->rig->n_cameras + camera;
}

static inline gboolean *
cloth_camera_stale (const ClothCameraView * v, guint frame, guint camera)
{
  return v->stale + (gsize) frame * v->observations->rig->n_cameras + camera;
}

/* Every stride-th vertex, as it moved. */
typedef struct
{
  guint n, stride;
  gdouble *positions;
  const gdouble **frames;
  ClothMotion motion;
} ClothCameraPoints;

void cloth_camera_points_init (ClothCameraPoints * p, const ClothCameraView * v,
    guint stride);
void cloth_camera_points_clear (ClothCameraPoints * p);

/* What the columns of a picture are to be: the place before in the last one; the faults,
 * and there that of a stale picture; where the rig's cameras would see it; none. */
typedef enum
{
  CLOTH_CAMERA_DROPS,
  CLOTH_CAMERA_FAULTS,
  CLOTH_CAMERA_WAY,
  CLOTH_CAMERA_SHIFT
} ClothCameraAim;

/* One picture: where points are found and foretold, whitened by the covariance. */
typedef struct
{
  const ClothObservation *observation;
  gint *at;                     /* [n]: index in the observation, or -1 */
  gdouble *px, *other;          /* [n][2]: foretold */
  gdouble *z;                   /* [n][2]: found less foretold */
  gdouble *e;                   /* [n]: the length of it that no place accounts for */
  gdouble *sorted;              /* [n]: those of e that are known */
  gdouble *j;                   /* [n][2][3]: by the point's place */
  gdouble *b;                   /* [n][2][N_COLUMNS]: by the camera's faults */
  gdouble gross;                /* of e, from here on */
} ClothCameraPicture;

void cloth_camera_picture_init (ClothCameraPicture * p, guint n);
void cloth_camera_picture_clear (ClothCameraPicture * p);
/* Fills the pictures of a frame, one for each camera. */
void cloth_camera_look (const ClothCameraView * v,
    const ClothCameraPoints * points, ClothCameraAim aim,
    ClothCameraPicture * pictures, guint frame);

/* What a point's pictures have in common: the normal equations of its place. */
typedef struct
{
  guint n;                      /* pictures that count */
  guint cameras[CLOTH_RIG_MAX_CAMERAS];
  gboolean contradicted;
  gdouble a[9];                 /* Cholesky factor L */
  gdouble u[3];                 /* L⁻¹ Jᵀz */
  gdouble z2;
} ClothCameraPoint;

/* FALSE when fewer than two pictures place a point; @all: those that contradict the others
 * count, too. */
gboolean cloth_camera_gather (const ClothCameraPicture * pictures,
    guint n_cameras, guint i, gboolean all, ClothCameraPoint * point);
/* x becomes L⁻¹x, or L⁻ᵀx. */
void cloth_camera_forward (const gdouble * l, gdouble * x);
void cloth_camera_backward (const gdouble * l, gdouble * x);

/* Notes which pictures show the one before once more. */
void cloth_camera_find_stale (ClothCameraView * v, guint threads);

G_END_DECLS
