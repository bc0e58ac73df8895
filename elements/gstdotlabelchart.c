/* The colours of dots as one camera sees them, from a picture of the print; and what that
 * picture and those of the film have in common.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstdotlabelchart.h"

#include <gio/gio.h>

#include "elements/gstclothpicture.h"

/* As for the film's pictures. */
#define MAX_PX 16384
/* The first look may know the colours badly; what it teaches finds more dots. */
#define LOOKS 2

void
gst_dot_label_view (const GstVideoFrame * frame, ClothDotImage * image)
{
  image->luma.data = GST_VIDEO_FRAME_COMP_DATA (frame, 0);
  image->luma.stride = GST_VIDEO_FRAME_COMP_STRIDE (frame, 0);
  image->luma.width = GST_VIDEO_FRAME_WIDTH (frame);
  image->luma.height = GST_VIDEO_FRAME_HEIGHT (frame);
  for (guint k = 0; k < 2; k++)
    image->chroma[k] = GST_VIDEO_FRAME_COMP_DATA (frame, k + 1);
  image->chroma_stride = GST_VIDEO_FRAME_COMP_STRIDE (frame, 1);
  image->chroma_step = GST_VIDEO_FRAME_COMP_PSTRIDE (frame, 1);
  image->chroma_shift[0] =
      (gint) GST_VIDEO_FORMAT_INFO_W_SUB (frame->info.finfo, 1);
  image->chroma_shift[1] =
      (gint) GST_VIDEO_FORMAT_INFO_H_SUB (frame->info.finfo, 1);
}

guint
gst_dot_label_say (const ClothDotLabeller * labeller, const ClothMArray * array,
    gint8 * said)
{
  guint n, n_labelled = 0;
  const ClothDotLabel *labels = cloth_dot_labeller_get_labels (labeller, &n);

  for (guint k = 0; k < n; k++) {
    const gboolean known = labels[k].column >= 0;

    n_labelled += known;
    said[k] = known ? (gint8) array->matrix[labels[k].row * array->columns
        + labels[k].column] : -1;
  }
  return n_labelled;
}

GstSample *
gst_dot_label_chart_load (const gchar * path, GError ** error)
{
  return gst_cloth_load_picture (path, "Y444", MAX_PX, error);
}

/* The picture with luma and chroma as the film has them. */
static GstBuffer *
convert (GstSample * chart, const GstVideoInfo * film, GstVideoInfo * info)
{
  GstVideoInfo from;
  GstVideoFrame in, out;
  GstVideoConverter *converter;
  GstBuffer *buffer;

  if (!gst_video_info_from_caps (&from, gst_sample_get_caps (chart))
      || !gst_video_frame_map (&in, &from, gst_sample_get_buffer (chart),
          GST_MAP_READ))
    return NULL;
  gst_video_info_set_format (info, GST_VIDEO_FORMAT_Y444, (guint) from.width,
      (guint) from.height);
  info->colorimetry = film->colorimetry;
  info->fps_n = from.fps_n;
  info->fps_d = from.fps_d;
  info->interlace_mode = from.interlace_mode;
  converter = gst_video_converter_new (&from, info, gst_structure_new
      ("options", GST_VIDEO_CONVERTER_OPT_DITHER_METHOD,
          GST_TYPE_VIDEO_DITHER_METHOD, GST_VIDEO_DITHER_NONE, NULL));
  buffer = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (info), NULL);
  if (converter && gst_video_frame_map (&out, info, buffer, GST_MAP_WRITE)) {
    gst_video_converter_frame (converter, &in, &out);
    gst_video_frame_unmap (&out);
  } else {
    gst_clear_buffer (&buffer);
  }
  g_clear_pointer (&converter, gst_video_converter_free);
  gst_video_frame_unmap (&in);
  return buffer;
}

/* Labels the dots by @colours, as sure as these make it. */
static guint
label (ClothDotLabeller * labeller, const ClothMArray * array,
    const ClothDotLabelParams * params, const ClothDotColourModel * colours,
    const ClothDot * dots, guint n, gfloat * likelihoods, gint8 * said)
{
  cloth_dot_colour_model_classify (colours, dots, n, likelihoods);
  cloth_dot_labeller_reset (labeller);
  cloth_dot_labeller_run (labeller, params, dots, n, likelihoods);
  return gst_dot_label_say (labeller, array, said);
}

static guint
learn (const ClothMArray * array, const ClothDotLabelParams * params,
    const ClothDot * dots, guint n, ClothDotColourModel * colours,
    GError ** error)
{
  g_autofree gfloat *likelihoods =
      g_new (gfloat, n * (gsize) array->n_colours + 1);
  g_autofree gint8 *said = g_new (gint8, n + 1);
  ClothDotLabeller *labeller = cloth_dot_labeller_new (array->columns,
      array->rows, array->n_colours, array->matrix, error);
  ClothDotColourModel model = *colours;
  guint n_labelled;

  if (!labeller)
    return 0;
  n_labelled = label (labeller, array, params, &model, dots, n, likelihoods,
      said);
  if (n_labelled == 0 && cloth_dot_colour_model_adapt (&model, dots, n))
    n_labelled = label (labeller, array, params, &model, dots, n, likelihoods,
        said);
  for (guint i = 0; i < LOOKS && n_labelled > 0; i++) {
    cloth_dot_colour_model_learn (&model, dots, n, said);
    if (i + 1 < LOOKS)
      n_labelled = label (labeller, array, params, &model, dots, n,
          likelihoods, said);
  }
  if (n_labelled > 0)
    *colours = model;
  else
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
        "%u dots are seen, but they fit nowhere into the pattern", n);
  cloth_dot_labeller_free (labeller);
  return n_labelled;
}

gboolean
gst_dot_label_chart_learn (GstSample * chart, const ClothMArray * array,
    const GstVideoInfo * film, const ClothDotParams * dot_params,
    const ClothDotLabelParams * label_params, ClothDotColourModel * colours,
    GError ** error)
{
  GstVideoInfo info;
  g_autoptr (GstBuffer) buffer = convert (chart, film, &info);
  GstVideoFrame frame;
  ClothDotDetector *detector;
  ClothDotImage image;
  const ClothDot *dots;
  guint n, n_labelled;

  if (!buffer || !gst_video_frame_map (&frame, &info, buffer, GST_MAP_READ)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED,
        "the picture can't be converted to the film's colours");
    return FALSE;
  }
  gst_dot_label_view (&frame, &image);
  detector = cloth_dot_detector_new ();
  cloth_dot_detector_run (detector, dot_params, &image, CLOTH_SIMD_BEST);
  dots = cloth_dot_detector_get_dots (detector, &n);
  n_labelled = learn (array, label_params, dots, n, colours, error);
  cloth_dot_detector_free (detector);
  gst_video_frame_unmap (&frame);
  return n_labelled > 0;
}
