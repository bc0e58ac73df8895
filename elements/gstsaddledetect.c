/* saddledetect: finds the corners of checkerboards in a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-saddledetect
 * @title: saddledetect
 *
 * Marks every pixel where the smoothed intensity is hyperbolic (a saddle) as a candidate
 * for a corner, and finds one place to a fraction of a pixel, with its covariance, for
 * each of their peaks: the detector of section 3.4 of Guskov and Zhukov, "Direct pattern
 * tracking on flexible geometry". Both go along with the picture as #GstClothSaddlesMeta;
 * the picture itself stays as it is and where it is.
 *
 * ## Corners over a film
 * |[
 * gst-launch-1.0 filesrc location=board.mp4 ! decodebin ! saddledetect ! \
 *     clothoverlay ! videoconvert ! autovideosink
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstsaddledetect.h"

#include <gst/cloth/cloth.h>

#include "elements/gstclothproperties.h"
#include "gst/vision/corner/saddle.h"

GST_DEBUG_CATEGORY_STATIC (saddle_detect_debug);
#define GST_CAT_DEFAULT saddle_detect_debug

/* The refined saddles go into the metadata as they are. */
G_STATIC_ASSERT (sizeof (ClothSaddle) == sizeof (GstClothSaddle));
G_STATIC_ASSERT (sizeof (ClothSaddleCandidate) == sizeof (GstClothCandidate));
G_STATIC_ASSERT (G_STRUCT_OFFSET (ClothSaddle, cov) ==
    G_STRUCT_OFFSET (GstClothSaddle, cov_xx));

static const GEnumValue refine_values[] = {
  {CLOTH_SADDLE_REFINE_NONE, "Candidates only", "none"},
  {CLOTH_SADDLE_REFINE_STREAM,
      "The saddle of the smoothed intensity", "stream"},
  {CLOTH_SADDLE_REFINE_MODEL,
      "A fit of two crossing edges; slower and more exact", "model"},
  {0, NULL, NULL}
};

#define SETTING(member) GST_CLOTH_SETTING (ClothSaddleParams, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"sigma", "Sigma", "Width of the Gaussian that smooths the picture, px",
    G_TYPE_DOUBLE, SETTING (sigma), GST_PARAM_MUTABLE_PLAYING, 0.5, 5},
  {"epsilon", "Epsilon",
    "A pixel is a candidate when the determinant of the Hessian is below "
    "minus this, grey levels squared per px^4",
    G_TYPE_DOUBLE, SETTING (epsilon), GST_PARAM_MUTABLE_PLAYING, 0, 1e6},
  {"relative-epsilon", "Relative epsilon",
    "The same bound as a share of what a sharp corner with the picture's "
    "own contrast would give; the larger of both holds",
    G_TYPE_DOUBLE, SETTING (relative), GST_PARAM_MUTABLE_PLAYING, 0, 1},
  {"roi-x", "Region's left", "Left column of the region searched",
    G_TYPE_INT, SETTING (roi_x), GST_PARAM_MUTABLE_PLAYING, 0, 16383},
  {"roi-y", "Region's top", "Top row of the region searched",
    G_TYPE_INT, SETTING (roi_y), GST_PARAM_MUTABLE_PLAYING, 0, 16383},
  {"roi-width", "Region's width",
    "Columns searched (0 = up to the right border)",
    G_TYPE_INT, SETTING (roi_width), GST_PARAM_MUTABLE_PLAYING, 0, 16384},
  {"roi-height", "Region's height",
    "Rows searched (0 = down to the lower border)",
    G_TYPE_INT, SETTING (roi_height), GST_PARAM_MUTABLE_PLAYING, 0, 16384},
  {"refine", "Refine", "How the place to a fraction of a pixel is found",
    G_TYPE_ENUM, SETTING (refine), GST_PARAM_MUTABLE_PLAYING, 0, 0,
    "GstSaddleDetectRefine", refine_values},
  {"radius", "Radius",
    "Window radius of refine=model, px; at most half the distance to the "
    "next saddle is used. Bent cloth wants 4 to 5, a flat board 8 to 10",
    G_TYPE_DOUBLE, SETTING (radius), GST_PARAM_MUTABLE_PLAYING, 2, 12},
  {"max-candidates", "Most candidates",
    "When more pixels than this pass, epsilon is raised for the picture",
    G_TYPE_UINT, SETTING (max_candidates), GST_PARAM_MUTABLE_PLAYING, 0,
    CLOTH_SADDLE_MAX},
  {"max-saddles", "Most saddles", "The most refined saddles a picture",
    G_TYPE_UINT, SETTING (max_saddles), GST_PARAM_MUTABLE_PLAYING, 0,
    CLOTH_SADDLE_MAX},
};
/* *INDENT-ON* */

struct _GstSaddleDetect
{
  GstClothFilter parent;

  /* under the object lock */
  ClothSaddleParams params;

  /* the streaming thread's own */
  ClothSaddleDetector *detector;
  gboolean warned;
};

G_DEFINE_TYPE_WITH_CODE (GstSaddleDetect, gst_saddle_detect,
    GST_TYPE_CLOTH_FILTER,
    GST_DEBUG_CATEGORY_INIT (saddle_detect_debug, "saddledetect", 0,
        "corners of checkerboards"));
GST_ELEMENT_REGISTER_DEFINE (saddledetect, "saddledetect", GST_RANK_NONE,
    GST_TYPE_SADDLE_DETECT);

static void
gst_saddle_detect_finalize (GObject * object)
{
  GstSaddleDetect *self = GST_SADDLE_DETECT (object);

  cloth_saddle_detector_free (self->detector);
  G_OBJECT_CLASS (gst_saddle_detect_parent_class)->finalize (object);
}

static GstFlowReturn
gst_saddle_detect_analyse (GstClothFilter * filter,
    const GstClothFilterFrame * frame)
{
  GstSaddleDetect *self = GST_SADDLE_DETECT (filter);
  const ClothSaddleCandidate *candidates;
  const ClothSaddle *saddles;
  GstClothSaddles *payload;
  ClothSaddleParams params;
  guint n_candidates, n_saddles;

  GST_OBJECT_LOCK (self);
  params = self->params;
  GST_OBJECT_UNLOCK (self);

  cloth_saddle_detector_run (self->detector, &params, &frame->luma,
      CLOTH_SIMD_BEST);
  candidates = cloth_saddle_detector_get_candidates (self->detector,
      &n_candidates);
  saddles = cloth_saddle_detector_get_saddles (self->detector, &n_saddles);
  if (cloth_saddle_detector_was_cut (self->detector) && !self->warned) {
    GST_WARNING_OBJECT (self, "more saddles than allowed, the weaker ones are "
        "left out; raise epsilon or sigma, or set a region of interest");
    self->warned = TRUE;
  }

  payload = gst_cloth_saddles_new (frame->camera, frame->sequence,
      (const GstClothSaddle *) saddles, n_saddles,
      (const GstClothCandidate *) candidates, n_candidates);
  gst_buffer_add_cloth_saddles_meta (frame->buffer, payload);
  GST_LOG_OBJECT (self, "%u saddles, %u candidates, epsilon %g, noise %g",
      n_saddles, n_candidates,
      cloth_saddle_detector_get_epsilon (self->detector),
      cloth_saddle_detector_get_noise (self->detector));
  return GST_FLOW_OK;
}

static void
gst_saddle_detect_reset (GstClothFilter * filter)
{
  GST_SADDLE_DETECT (filter)->warned = FALSE;
}

static void
gst_saddle_detect_class_init (GstSaddleDetectClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothFilterClass *filter_class = GST_CLOTH_FILTER_CLASS (klass);
  const ClothSaddleParams defaults = cloth_saddle_default_params ();

  object_class->finalize = gst_saddle_detect_finalize;
  filter_class->analyse = gst_saddle_detect_analyse;
  filter_class->reset = gst_saddle_detect_reset;

  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      G_STRUCT_OFFSET (GstSaddleDetect, params));
  gst_element_class_set_static_metadata (element_class, "Saddle detector",
      "Filter/Analyzer/Video",
      "Finds the corners of checkerboards to a fraction of a pixel",
      "The gst-cloth developers");
}

static void
gst_saddle_detect_init (GstSaddleDetect * self)
{
  self->params = cloth_saddle_default_params ();
  self->detector = cloth_saddle_detector_new ();
}
