/* What the cameras of a calibration saw of the board.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"
#include "gst/rig/calibrate.h"

G_BEGIN_DECLS

/* What board it is.
 * @pattern: its squares
 * @dictionary: (nullable): where its white squares have markers (ChArUco), of which dictionary
 * @marker: edge of these over that of a square
 */
typedef struct {
  ClothPattern *pattern;
  gchar *dictionary;
  gdouble marker;
} ClothShotBoard;

/* One picture with the board in it. Corners of the board's inside only: those of its rim
 * are no saddles. */
typedef struct {
  gint64 number;                /* what pictures of several cameras agree in */
  gchar *label;                 /* file name or frame number */
  guint n;
  guint *vertex;
  gdouble *x, *y, *cov;
  gdouble outline[8];           /* the board's four corners over the picture's size */
  GBytes *picture;              /* JPEG; NULL where none can be made */
} ClothShot;

typedef struct {
  gchar *name;
  GPtrArray *files;
  gboolean film;
  gint width, height;
  guint most_pictures;          /* of a film to look at; 0: all */
  guint n_pictures;             /* looked at */
  guint n_marked;               /* that show markers of the board's dictionary */
  guint n_contradicted;         /* whose markers are not where the board has them */
  GPtrArray *shots;             /* ClothShot, the board found */
} ClothShotCamera;

typedef void (*ClothShotProgress) (const ClothShotCamera * camera,
    guint n_files_done, gpointer user_data);

void cloth_shot_board_free (ClothShotBoard * board);

ClothShotCamera *cloth_shot_camera_new (const gchar * name);
void cloth_shot_camera_free (ClothShotCamera * camera);
gboolean cloth_shot_camera_add (ClothShotCamera * camera,
    const gchar * pattern, GError ** error);
void cloth_shot_cameras_number (GPtrArray * cameras);
gboolean cloth_shot_camera_read (ClothShotCamera * camera,
    const ClothShotBoard * board, guint every, ClothShotProgress progress,
    gpointer user_data, GError ** error);
void cloth_shot_cameras_choose (GPtrArray * cameras, guint max_views);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothShotBoard, cloth_shot_board_free)

G_END_DECLS
