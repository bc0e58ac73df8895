/* libgstcloth-1.0: what every header of the library needs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

#ifdef BUILDING_GST_CLOTH
#define GST_CLOTH_API GST_API_EXPORT
#else
#define GST_CLOTH_API GST_API_IMPORT
#endif

G_BEGIN_DECLS

/**
 * GST_CLOTH_MAX_FEATURES:
 *
 * Most saddles, candidates, quads, dots or matches that one picture's payload may hold.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_FEATURES 65536

/**
 * GST_CLOTH_MAX_VERTICES:
 *
 * Most vertices of a mesh.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_VERTICES 1000000

/**
 * GST_CLOTH_MAX_FACES:
 *
 * Most faces of a mesh.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_FACES 2000000

/**
 * GST_CLOTH_MAX_CAMERA_NAME:
 *
 * Longest name of a camera, bytes of UTF-8.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_CAMERA_NAME 255

/**
 * GstClothError:
 * @GST_CLOTH_ERROR_TRUNCATED: the bytes end before what their header announces
 * @GST_CLOTH_ERROR_MAGIC: the bytes are something else: the first four differ
 * @GST_CLOTH_ERROR_VERSION: the layout is of a version that this library can't read
 * @GST_CLOTH_ERROR_LIMIT: a count is over the limit (see the GST_CLOTH_MAX_ constants)
 * @GST_CLOTH_ERROR_VALUE: a value is out of range: a float that isn't finite, an
 *   unknown state, an index past the end, a name that isn't UTF-8
 * @GST_CLOTH_ERROR_CAPS: the caps lack something or are of another stream
 *
 * Why bytes or caps can't be read.
 *
 * Since: 0.1
 */
typedef enum {
  GST_CLOTH_ERROR_TRUNCATED,
  GST_CLOTH_ERROR_MAGIC,
  GST_CLOTH_ERROR_VERSION,
  GST_CLOTH_ERROR_LIMIT,
  GST_CLOTH_ERROR_VALUE,
  GST_CLOTH_ERROR_CAPS
} GstClothError;

/**
 * GST_CLOTH_ERROR:
 *
 * Error domain of the library; its codes are #GstClothError.
 *
 * Since: 0.1
 */
#define GST_CLOTH_ERROR (gst_cloth_error_quark ())

GST_CLOTH_API GQuark gst_cloth_error_quark (void);

G_END_DECLS
