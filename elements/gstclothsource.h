/* Base of the sources of a mesh stream whose frames are all known at the start.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstpushsrc.h>
#include <gst/cloth/cloth.h>

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_SOURCE (gst_cloth_source_get_type ())
G_DECLARE_DERIVABLE_TYPE (GstClothSource, gst_cloth_source, GST, CLOTH_SOURCE,
    GstPushSrc)

/* @parent_class: the parent class
 * @backwards: whether frames can be made in falling order too
 * @open: load what the properties name and call gst_cloth_source_publish(), or post an
 *   error and return %FALSE
 * @close: let go of what @open has loaded, or a part of it
 * @make_mesh: the mesh of a frame (transfer full), or %NULL when an error was posted or
 *   the source is flushing
 *
 * The base asks for frames in the order that seeks make.
 */
struct _GstClothSourceClass {
  GstPushSrcClass parent_class;

  gboolean backwards;
  gboolean (*open) (GstClothSource * source);
  void (*close) (GstClothSource * source);
  GstClothMesh *(*make_mesh) (GstClothSource * source, guint frame);
};

/* @location: what the stream comes from, for messages
 * @advice: appended to the message that a time can't be played, or ""
 * @topology: of every mesh
 * @n_frames: frames, 1 or more
 * @times: time of each, seconds, borrowed until the source has closed; %NULL: the rate
 *   says
 * @origin: of @times: the time that becomes 0
 * @fps_n: frames in @fps_d seconds; with @times, 0 when it isn't known
 * @fps_d: see @fps_n, over 0
 *
 * A mesh stream, but for its meshes.
 */
typedef struct {
  const gchar *location, *advice;
  const ClothTopology *topology;
  guint n_frames;
  const gdouble *times;
  gdouble origin;
  gint fps_n, fps_d;
} GstClothSourceStream;

gboolean gst_cloth_source_publish (GstClothSource * source,
    const GstClothSourceStream * stream);
gboolean gst_cloth_source_is_flushing (GstClothSource * source);

G_END_DECLS
