/* Base of the elements that hold a stream against a simulation of the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfollow-inputs.h"
#include "gst/fit/nudge/nudge.h"

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_FOLLOW (gst_cloth_follow_get_type ())
G_DECLARE_DERIVABLE_TYPE (GstClothFollow, gst_cloth_follow, GST, CLOTH_FOLLOW,
    GstElement)

/* Of the frame that leaves.
 * @time: seconds of the scene
 * @sequence: of the mesh or picture
 * @offset_s: of the camera's clock to that of its rig
 * @n_vertices: of the cloth
 * @residuals: (array): recorded minus simulated, [n_vertices][3], m; NaN when not seen
 * @sigmas: (array length=n_vertices): standard deviation of what was recorded, m
 * @positions: (array): as recorded, [n_vertices][3], m; of a picture on its rays, as far away as the
 *   simulation is
 * @states: (array length=n_vertices): as recorded, #ClothVertexState
 * @covariances: (array) (nullable): of a mesh
 * @buffer: as it came
 */
typedef struct {
  gdouble time;
  guint64 sequence;
  gdouble offset_s;
  guint n_vertices;
  const gfloat *residuals, *sigmas;
  const gfloat *positions;
  const guint8 *states;
  const gfloat *covariances;
  GstBuffer *buffer;
} GstClothFollowFrame;

/* @parent_class: the parent class
 * @open: reads what the subclass needs besides model and take, which are there; posts an error and
 *   returns %FALSE when it can't. Optional.
 * @close: forgets it, and all of the stream. Optional.
 * @restart: the stream begins anew. Optional.
 * @came: a picture came, of which @points were seen, or nothing, at @time of the scene; %FALSE when an
 *   error was posted. Optional.
 * @make_caps: (transfer full): what leaves of a stream of @caps; %NULL when an error was posted.
 *   Optional: the same.
 * @record: a frame leaves; %FALSE when an error was posted. Optional.
 * @leave: makes what leaves of @buffer, which it takes; @frame has no positions, states,
 *   covariances and buffer any more.
 * @finish: the stream has ended, and its last frame has left. One that goes on in another place begins a new
 *   recording and drops the old one. Optional.
 * @get_gain: g of the springs, 1/s²
 * @damping_ratio: ζ of the springs, 1 = critically damped
 * @score: name of the element message of a window's score
 * @lets_pass: frames outside of the scene pass as they are; else they are dropped
 *
 * Streaming thread, no lock held.
 */
struct _GstClothFollowClass {
  GstElementClass parent_class;

  gboolean (*open) (GstClothFollow * self);
  void (*close) (GstClothFollow * self);
  void (*restart) (GstClothFollow * self);
  gboolean (*came) (GstClothFollow * self, gdouble time,
      const ClothCamera * camera, const ClothTriangulateView * points);
  GstCaps *(*make_caps) (GstClothFollow * self, const GstCaps * caps);
  gboolean (*record) (GstClothFollow * self,
      const GstClothFollowFrame * frame);
  GstBuffer *(*leave) (GstClothFollow * self, GstBuffer * buffer,
      const GstClothFollowFrame * frame);
  void (*finish) (GstClothFollow * self);
  gdouble (*get_gain) (GstClothFollow * self);
  gdouble damping_ratio;
  const gchar *score;
  gboolean lets_pass;

  gpointer _reserved[2];
};

/* Files and settings, from open to close. */
const GstFollowInputs *gst_cloth_follow_get_inputs (GstClothFollow * self);
const GstFollowSettings *gst_cloth_follow_get_settings (GstClothFollow * self);
/* Whether the stream is one camera's observations. */
gboolean gst_cloth_follow_has_rays (GstClothFollow * self);
ClothObserver *gst_cloth_follow_get_observer (GstClothFollow * self);
/* Adds a frame to @record, which the first one makes. @purpose: what it is kept for, for the error that is
 * posted when it can't */
gboolean gst_cloth_follow_keep (GstClothFollow * self,
    GstFollowRecord ** record, const GstClothFollowFrame * frame,
    const gchar * purpose);
/* Whether a long computation is to end: the element is flushed or stopped. */
gboolean gst_cloth_follow_is_cancelled (GstClothFollow * self);

G_END_DECLS
