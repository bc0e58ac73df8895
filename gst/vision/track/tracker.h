/* Seven trackers of a printed cloth, compared by Hasler et al.: three of markers in space, four of
 * features in pictures.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/cv.h"
#include "gst/rig/camera.h"
#include "gst/vision/image.h"
#include "gst/vision/track/crest.h"
#include "gst/vision/track/flat.h"
#include "gst/vision/track/marker.h"

G_BEGIN_DECLS

/* @CLOTH_TRACKER_ERROR_PARAMETER: a parameter is out of its range
 * @CLOTH_TRACKER_ERROR_VIEWS: pictures that are not those of the cameras
 * @CLOTH_TRACKER_ERROR_START: nothing to track was found in the first pictures
 */
typedef enum {
  CLOTH_TRACKER_ERROR_PARAMETER,
  CLOTH_TRACKER_ERROR_VIEWS,
  CLOTH_TRACKER_ERROR_START
} ClothTrackerError;

#define CLOTH_TRACKER_ERROR (cloth_tracker_error_quark ())
GQuark cloth_tracker_error_quark (void);

/* @CLOTH_TRACKER_REFERENCE: markers of the first frame, by their descriptors there
 * @CLOTH_TRACKER_FRAMES: markers of the first frame, from frame to frame by descriptors
 * @CLOTH_TRACKER_MULTI: markers of the first frame, by their descriptors in the last frames
 * @CLOTH_TRACKER_REFERENCE_2D: features of the first frame, by their descriptors there
 * @CLOTH_TRACKER_LUCAS_KANADE: features of the first frame, from frame to frame by optical flow
 * @CLOTH_TRACKER_FRAMES_2D: features of the first frame, from frame to frame by descriptors
 * @CLOTH_TRACKER_UVLESS: features of each frame, by optical flow to the next; where they are on
 *   the cloth isn't known: cloth_cast_feature () tells it by a simulated cloth
 */
typedef enum {
  CLOTH_TRACKER_REFERENCE,
  CLOTH_TRACKER_FRAMES,
  CLOTH_TRACKER_MULTI,
  CLOTH_TRACKER_REFERENCE_2D,
  CLOTH_TRACKER_LUCAS_KANADE,
  CLOTH_TRACKER_FRAMES_2D,
  CLOTH_TRACKER_UVLESS
} ClothTrackerKind;

#define CLOTH_TRACKER_N_KINDS 7

/* Most frames that a multitrack looks back to. */
#define CLOTH_TRACKER_MAX_REFERENCES 100

/* @references: frames that the multitrack looks back to (the paper's 20)
 * @radius: features of several cameras within it show the same place of the flat cloth, m (0.005)
 * @ratio: greatest distance of a descriptor as a share of that of the next best place; 0 to 1 (0.8)
 * @motion_px: greatest motion from a frame to the next in the picture, px (20)
 * @motion_m: the same in the world, m (0.05)
 * @marker: when rays don't meet
 * @flow: the window and pyramid of optical flow (21 px, 3 halvings: OpenCV's own)
 * @back: a point of the flow without (u, v), or tested for crests, that does not come back to where
 *   it began, so near, is lost, px (0.4)
 * @crests: whether what piles up along crests is dropped; of Lucas–Kanade's (yes)
 * @crest: when that is
 */
typedef struct {
  guint references;
  gdouble radius, ratio, motion_px, motion_m;
  ClothMarkerParams marker;
  ClothCvFlowParams flow;
  gdouble back;
  gboolean crests;
  ClothCrestParams crest;
} ClothTrackerParams;

/* @image: a grey picture
 * @features: of it, by cloth_cv_sift_run (); of Lucas–Kanade only those of the first frame are
 *   looked at
 *
 * What a camera sees in a frame; owns nothing.
 */
typedef struct {
  ClothImage image;
  ClothCvFeatures features;
} ClothTrackerView;

/* @id: the same in all frames
 * @uv: place on the cloth, m
 * @position: m, world
 * @n_rays: cameras that see it
 */
typedef struct {
  guint id;
  gdouble uv[2];
  gdouble position[3];
  guint n_rays;
} ClothTrackedMarker;

/* @camera: which sees it
 * @id: the same in all frames, and another in each camera; of the tracker without (u, v) a number
 *   of this frame and camera only
 * @uv: place on the cloth, m; NaN of the tracker without (u, v)
 * @px: place in the picture
 * @before: place in the picture before; of the first frame @px
 */
typedef struct {
  guint camera, id;
  gdouble uv[2];
  gdouble px[2];
  gdouble before[2];
} ClothTrackedFeature;

typedef struct _ClothTracker ClothTracker;

const gchar *cloth_tracker_kind_to_string (ClothTrackerKind kind);
gboolean cloth_tracker_kind_from_string (const gchar * name,
    ClothTrackerKind * kind);
gboolean cloth_tracker_kind_is_3d (ClothTrackerKind kind);
ClothTrackerParams cloth_tracker_default_params (void);

ClothTracker *cloth_tracker_new (ClothTrackerKind kind,
    const ClothTrackerParams * params, guint n_cameras,
    const ClothCamera * cameras, GError ** error);
void cloth_tracker_free (ClothTracker * tracker);
gboolean cloth_tracker_start (ClothTracker * tracker,
    const ClothFlatPose * pose, const ClothTrackerView * views,
    GError ** error);
gboolean cloth_tracker_run (ClothTracker * tracker,
    const ClothTrackerView * views, GError ** error);
const ClothTrackedMarker *cloth_tracker_get_markers (const ClothTracker *
    tracker, guint * n_markers);
const ClothTrackedFeature *cloth_tracker_get_features (const ClothTracker *
    tracker, guint * n_features);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTracker, cloth_tracker_free)
G_END_DECLS
