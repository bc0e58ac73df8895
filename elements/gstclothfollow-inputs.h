/* What a stream is followed with: the files that are read at the start, the camera of an
 * observation stream, and the recording that went by.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "elements/gstclothdamage.h"
#include "gst/fit/recording/recording.h"
#include "gst/mesh/topology.h"
#include "gst/rig/triangulate.h"
#include "gst/sim/model.h"
#include "gst/sim/scene.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

/* The properties of all that follow; a text is NULL when it is not given. */
typedef struct {
  gchar *model, *location, *rig, *camera;
  guint64 seed;
  guint threads;
  gdouble window;               /* seconds */
  GstClothDamage damage;
} GstFollowSettings;

typedef struct {
  ClothModel *model;
  ClothTake *take;
  ClothScene *scene;
} GstFollowInputs;

/* Posts what keeps the file of a property from being used. Returns: FALSE */
gboolean gst_follow_fail (GstElement * element, const gchar * property,
    const gchar * path, const GError * error);

/* Posts an error on @element when it fails. @inputs are to be cleared even then. */
gboolean gst_follow_inputs_load (GstFollowInputs * inputs,
    GstElement * element, const GstFollowSettings * settings);
/* Whether a mesh stream's caps are of the scene's cloth; else posts an error. */
gboolean gst_follow_inputs_check_mesh (const GstFollowInputs * inputs,
    GstElement * element, const GstCaps * caps);
void gst_follow_inputs_clear (GstFollowInputs * inputs);

typedef struct _GstFollowView GstFollowView;

/* All post an error on @element when they fail. */
GstFollowView *gst_follow_view_new (GstElement * element,
    const GstFollowSettings * settings, const ClothTopology * topology);
gboolean gst_follow_view_set_caps (GstFollowView * view,
    GstElement * element, const GstCaps * caps);
/* @sequence: of the picture. What is returned belongs to @view. @damage: set, and no error posted, when the picture contradicts
 * those before it. */
const ClothRays *gst_follow_view_read (GstFollowView * view,
    GstElement * element, GstBuffer * picture, guint64 * sequence,
    GError ** damage);
/* What the picture that was read last showed, NaN where a vertex was not seen; NULL when it
 * showed nothing. @camera: whose it is. Both belong to @view. */
const ClothTriangulateView *gst_follow_view_get_points (const GstFollowView *
    view, const ClothCamera ** camera);
/* Seconds from the camera's clock to that of its rig; 0 as long as no picture named the camera. */
gdouble gst_follow_view_get_offset (const GstFollowView * view);
/* A new recording: no picture so far. */
void gst_follow_view_restart (GstFollowView * view);
/* Posts an error when no picture so far showed squares, dots or matches. */
gboolean gst_follow_view_check_seen (const GstFollowView * view,
    GstElement * element);
void gst_follow_view_free (GstFollowView * view);

/* The cameras that a mesh stream was made of. */
typedef struct _GstFollowCameras GstFollowCameras;

/* Returns: NULL after an error was posted. @rig_file: of which there must be one */
GstFollowCameras *gst_follow_cameras_new (GstElement * element,
    const gchar * rig_file, const ClothTopology * topology);
/* The rig that is known for observations, or NULL; to be freed. */
gchar *gst_follow_find_rig (const GstFollowSettings * settings);
/* What single cameras saw of the vertices that @mesh has not, and its @buffer tells: rays, which belong to
 * @cameras. As of gst_follow_view_read (). */
const ClothRays *gst_follow_cameras_read (GstFollowCameras * cameras,
    GstElement * element, GstBuffer * buffer, const GstClothMesh * mesh,
    GError ** damage);
void gst_follow_cameras_restart (GstFollowCameras * cameras);
void gst_follow_cameras_free (GstFollowCameras * cameras);

typedef struct _GstFollowRecord GstFollowRecord;

GstFollowRecord *gst_follow_record_new (ClothTake * take,
    const ClothScene * scene, GError ** error);
gboolean gst_follow_record_append (GstFollowRecord * record,
    gdouble time_s, const gfloat * positions, const guint8 * states,
    const gfloat * covariances, GError ** error);
/* Adds what the cameras saw of the frame that was appended last. @segment: of the stream. @time_s: of the frame.
 * A recording that has this is one of observations, and its positions don't count. */
gboolean gst_follow_record_see (GstFollowRecord * record,
    const GstFollowCameras * cameras, GstBuffer * buffer,
    const GstSegment * segment, gdouble time_s, GError ** error);
/* Ends the take; the record can then only be freed, after what is returned. @observations: (out): what
 * cameras saw, as it is read from any take; NULL where none did */
ClothTake *gst_follow_record_finish (GstFollowRecord * record,
    ClothObservations ** observations, GError ** error);
void gst_follow_record_free (GstFollowRecord * record);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstFollowRecord, gst_follow_record_free)
G_END_DECLS
