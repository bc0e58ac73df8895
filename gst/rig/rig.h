/* A rig: up to 64 cameras in one world.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* Most cameras a rig may have.
 */
#define CLOTH_RIG_MAX_CAMERAS 64

/* Largest width and height of a camera's picture, px.
 */
#define CLOTH_RIG_MAX_SIZE 16384

/* Seconds that a camera's clock may be off, and its shutter may roll: 31 years.
 */
#define CLOTH_RIG_MAX_SECONDS 1e9

/* @CLOTH_RIG_ERROR_SYNTAX: the file is not YAML
 * @CLOTH_RIG_ERROR_VALUE: a key is missing or has an impossible value
 * @CLOTH_RIG_ERROR_LIMIT: a YAML file is deeper or longer than allowed
 */
typedef enum {
  CLOTH_RIG_ERROR_SYNTAX,
  CLOTH_RIG_ERROR_VALUE,
  CLOTH_RIG_ERROR_LIMIT
} ClothRigError;

#define CLOTH_RIG_ERROR (cloth_rig_error_quark ())
GQuark cloth_rig_error_quark (void);
gboolean cloth_rig_invalid (GError ** error, const gchar * where,
    const gchar * key, const gchar * format, ...) G_GNUC_PRINTF (4, 5);

/* @n_cameras: how many, 1 to %CLOTH_RIG_MAX_CAMERAS
 * @cameras: (array length=n_cameras): the cameras
 */
typedef struct {
  guint n_cameras;
  ClothCamera *cameras;
} ClothRig;

ClothRig *cloth_rig_new (guint n_cameras);
void cloth_rig_free (ClothRig * rig);
const ClothCamera *cloth_rig_find (const ClothRig * rig, const gchar * name);
gboolean cloth_rig_check (const ClothRig * rig, GError ** error);
void cloth_rig_mend_rotations (ClothRig * rig);

const gchar *cloth_lens_to_string (ClothLens lens);
gboolean cloth_lens_from_string (const gchar * name, ClothLens * lens);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRig, cloth_rig_free)
G_END_DECLS
