/* Base of elements that look at pictures and leave what they see as metas.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include "gst/vision/image.h"

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_FILTER (gst_cloth_filter_get_type ())
G_DECLARE_DERIVABLE_TYPE (GstClothFilter, gst_cloth_filter, GST, CLOTH_FILTER,
    GstBaseTransform)

/* Formats with a plane of 8-bit luma, which is read where it is. */
#define GST_CLOTH_FILTER_FORMATS "{ GRAY8, I420, YV12, NV12, NV21, Y42B, " \
    "NV16, NV61, Y444, NV24, Y41B, YUV9, YVU9, A420 }"

/* Formats whose luma and chroma take turns in a row, as webcams send them: they are taken
 * apart. */
#define GST_CLOTH_FILTER_PACKED_FORMATS "{ YUY2, UYVY, YVYU }"

/* @luma: the picture's luma, mapped for reading
 * @planes: the picture's luma and, of one in colour, its chroma; @luma is that of it
 * @video: the whole picture, mapped for reading
 * @sequence: number of the picture: the buffer's offset where it has one, else its stream
 *   time in pictures, else counted from the start of the stream
 * @camera: name of the camera, "" when none was set
 * @buffer: the buffer, whose metas may be changed and whose memory may not
 */
typedef struct {
  ClothImage luma;
  ClothPlanarImage planes;
  const GstVideoFrame *video;
  guint64 sequence;
  const gchar *camera;
  GstBuffer *buffer;
} GstClothFilterFrame;

/* @parent_class: the parent class
 * @start: the stream starts: load what the properties name, or post an error
 * @stop: the stream has stopped
 * @reset: pictures to come have nothing to do with those that were: at new caps, after a
 *   flush or a new segment
 * @analyse: look at one picture
 *
 * All but @analyse may be %NULL.
 */
struct _GstClothFilterClass {
  GstBaseTransformClass parent_class;

  gboolean (*start) (GstClothFilter * filter);
  void (*stop) (GstClothFilter * filter);
  void (*reset) (GstClothFilter * filter);
  GstFlowReturn (*analyse) (GstClothFilter * filter,
      const GstClothFilterFrame * frame);
};

/* Returns: the format with planes of a film in @info: its own, or what it is taken apart to */
GstVideoFormat gst_cloth_filter_get_planar_format (const GstVideoInfo * info);

/* The planes of a picture in GST_CLOTH_FILTER_FORMATS, as long as it is mapped. */
void gst_cloth_filter_view_planes (const GstVideoFrame * frame,
    ClothPlanarImage * image);

G_END_DECLS
