/* dotlabel: coloured dots, found, classified and labelled.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-dotlabel
 * @title: dotlabel
 *
 * Finds the dots of a colour-coded pattern on dark cloth, asks for each how likely its
 * colour is under each colour of the pattern, and finds which dot of the pattern it is.
 * All of it goes along with the picture as #GstClothDots; the picture itself stays as it
 * is and where it is. Pictures need colour: grey ones are refused.
 *
 * The bus is told by the element messages `dotlabel/found` and `dotlabel/lost` when
 * labelled dots come into sight and when all of them are gone; their fields are `camera`,
 * `sequence`, `timestamp` (PTS, ns), `dots`, the number of dots seen, and `labelled`.
 * When dots have been seen for a while, or in all of a short film, and no place of the
 * pattern fits, a warning says so.
 *
 * ## Labelled dots over a film
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! dotlabel pattern=pattern.json ! \
 *     clothoverlay ! videoconvert ! autovideosink
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstdotlabel.h"

#include <gst/cloth/cloth.h>

#include "elements/gstclothpaint.h"
#include "elements/gstclothproperties.h"
#include "gst/pattern/marray.h"
#include "gst/vision/label/label.h"

GST_DEBUG_CATEGORY_STATIC (dot_label_debug);
#define GST_CAT_DEFAULT dot_label_debug

G_STATIC_ASSERT (GST_CLOTH_DOT_MAX_COLOURS >= CLOTH_M_ARRAY_MAX_COLOURS);
G_STATIC_ASSERT (GST_CLOTH_MAX_FEATURES >= CLOTH_DOT_MAX);

/* Most pixels a side of a chart: as for the film's pictures. */
#define MAX_CHART_PX 16384
/* Nobody needs to know by how much more a colour is ruled out, nats. */
#define LEAST_LIKELIHOOD -100.0f

/* A warning about a pattern that doesn't fit is better than no link at all: grey pictures
 * are let in, to be refused with a word on what to do. */
#define COLOUR_FORMATS "{ I420, YV12, NV12, NV21, Y42B, NV16, NV61, Y444, " \
    "NV24, Y41B, YUV9, YVU9, A420 }"
#define SIZES ", width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ]"
#define DOT_LABEL_CAPS GST_VIDEO_CAPS_MAKE (COLOUR_FORMATS) SIZES "; " \
    GST_VIDEO_CAPS_MAKE (GST_CLOTH_FILTER_PACKED_FORMATS) SIZES "; " \
    GST_VIDEO_CAPS_MAKE ("GRAY8") SIZES

typedef struct
{
  gchar *pattern, *chart;
  ClothDotParams dots;
  ClothFilmLabelParams film;
} Settings;

struct _GstDotLabel
{
  GstClothFilter parent;

  /* with the object lock */
  Settings settings;

  /* streaming thread */
  ClothMArray *array;
  GstSample *chart;             /* NULL: the colours start from those of the print */
  ClothDotDetector *detector;
  ClothFilmLabeller *labeller;
  gboolean knows_colours;       /* those of the print or of the chart */
  GstVideoColorMatrix matrix;   /* that the colours are made for */
  GArray *dots;                 /* GstClothDot */
  gboolean found;
  gboolean warned;
};

static const GEnumValue colours_values[] = {
  {CLOTH_LABEL_BY_LIKELIHOOD,
      "Likelihood of a dot's mean chroma over its luma", "likelihood"},
  {CLOTH_LABEL_BY_HUE,
      "Every pixel votes for the nearest hue, the paper's way", "hue"},
  {0, NULL, NULL}
};

/* Of whether dots are labelled the paper's way. */
static const GEnumValue labels_values[] = {
  {FALSE, "Likelihood of whole patches of the lattice, kept through time",
      "patches"},
  {TRUE, "Single windows as seeds of growing regions, the paper's way",
      "windows"},
  {0, NULL, NULL}
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)
#define ANY_TIME (GST_PARAM_MUTABLE_PLAYING | GST_PARAM_CONTROLLABLE)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"pattern", "Pattern", "File pattern.json of the M-array that is filmed",
    G_TYPE_STRING, SETTING (pattern), GST_PARAM_MUTABLE_READY},
  {"chart", "Chart",
    "Picture of the print by this camera, from which the colours of the dots "
    "are learnt before the film",
    G_TYPE_STRING, SETTING (chart), GST_PARAM_MUTABLE_READY},
  {"colours", "Colours", "How dots are told apart by colour",
    G_TYPE_ENUM, SETTING (film.colours), ANY_TIME, 0, 0,
    "GstDotLabelColours", colours_values},
  {"learn", "Learn",
    "Whether the colours as the camera sees them are learnt from the film, "
    "blindly at first, then from labelled dots; else they are as printed or as on "
    "the chart",
    G_TYPE_BOOLEAN, SETTING (film.learn), ANY_TIME},
  {"contrast", "Contrast",
    "Least luma of a dot above the ground around it, grey levels",
    G_TYPE_FLOAT, SETTING (dots.contrast), ANY_TIME, 1, 254},
  {"share", "Share",
    "Least luma of a dot above the ground as a share of the brightest around",
    G_TYPE_FLOAT, SETTING (dots.share), ANY_TIME, 0, 0.9},
  {"min-area", "Least area", "Area from which on a spot is a dot, px",
    G_TYPE_FLOAT, SETTING (dots.min_area), ANY_TIME, 4, 40000},
  {"max-diameter", "Greatest diameter",
    "Extent up to which a spot is a dot, px",
    G_TYPE_INT, SETTING (dots.max_diameter), ANY_TIME, 4,
    CLOTH_DOT_MAX_DIAMETER},
  {"roundness", "Roundness",
    "Area from which on a spot is a dot, as a share of that of the ellipse with "
    "the same second moments",
    G_TYPE_FLOAT, SETTING (dots.roundness), ANY_TIME, 0, 1},
  {"c", "c",
    "Greatest change of the vector from dot to neighbouring dot from one dot to "
    "the next, as a share of its length; folds change it more and end the "
    "growing",
    G_TYPE_FLOAT, SETTING (film.label.c), ANY_TIME, 0, 1},
  {"colour-error", "Colour error",
    "Share of the dots that are taken for having any colour at all",
    G_TYPE_FLOAT, SETTING (film.label.colour_error), ANY_TIME, 0.001, 0.9},
  {"lead", "Lead",
    "Least log-odds of a patch's place in the pattern, nats: against the next "
    "best place and against dots of random colours",
    G_TYPE_FLOAT, SETTING (film.label.lead), ANY_TIME, 0, 1000},
  {"mirrored", "Mirrored",
    "Whether the print may be seen from behind, as in a mirror",
    G_TYPE_BOOLEAN, SETTING (film.label.mirrored), ANY_TIME},
  {"labels", "Labels", "How dots are given their place in the pattern",
    G_TYPE_ENUM, SETTING (film.label.paper), ANY_TIME, 0, 0,
    "GstDotLabelLabels", labels_values},
  {"least-region", "Least region",
    "Fewest dots of a region that labels=windows keeps",
    G_TYPE_UINT, SETTING (film.label.least_region), ANY_TIME, 3, 65536},
};
/* *INDENT-ON* */

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (DOT_LABEL_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (DOT_LABEL_CAPS));

G_DEFINE_TYPE (GstDotLabel, gst_dot_label, GST_TYPE_CLOTH_FILTER);
GST_ELEMENT_REGISTER_DEFINE (dotlabel, "dotlabel", GST_RANK_NONE,
    GST_TYPE_DOT_LABEL);

/* FALSE: there is a chart, it can't be read, and an error was posted. */
static gboolean
gst_dot_label_load_chart (GstDotLabel * self)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;

  GST_OBJECT_LOCK (self);
  path = g_strdup (self->settings.chart);
  GST_OBJECT_UNLOCK (self);
  if (!path)
    return TRUE;
  self->chart = gst_cloth_load_picture (path, "Y444", MAX_CHART_PX, &error);
  if (!self->chart)
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("Can't read the chart: %s", error->message),
        ("Set chart to a picture of the print by this camera, or leave it out."));
  return self->chart != NULL;
}

static void
gst_dot_label_stop (GstClothFilter * filter)
{
  GstDotLabel *self = GST_DOT_LABEL (filter);

  g_clear_pointer (&self->detector, cloth_dot_detector_free);
  g_clear_pointer (&self->labeller, cloth_film_labeller_free);
  g_clear_pointer (&self->array, cloth_m_array_free);
  g_clear_pointer (&self->chart, gst_sample_unref);
}

static gboolean
gst_dot_label_start (GstClothFilter * filter)
{
  GstDotLabel *self = GST_DOT_LABEL (filter);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;

  GST_OBJECT_LOCK (self);
  path = g_strdup (self->settings.pattern);
  GST_OBJECT_UNLOCK (self);
  if (!path) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("The dots are not known: the property pattern is not set."),
        ("Set pattern to the pattern.json that gst-cloth-pattern-1.0 m-array has "
            "written beside the print."));
    return FALSE;
  }
  self->array = cloth_m_array_load (path, &error);
  if (!self->array) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("Can't read the pattern: %s", error->message),
        ("Set pattern to the pattern.json of an M-array; it is now \"%s\".",
            path));
    return FALSE;
  }
  self->labeller = cloth_film_labeller_new (self->array, &error);
  if (!self->labeller) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("Dots can't be labelled by this pattern: %s", error->message),
        ("pattern=%s", path));
    gst_dot_label_stop (filter);
    return FALSE;
  }
  if (!gst_dot_label_load_chart (self)) {
    gst_dot_label_stop (filter);
    return FALSE;
  }
  self->detector = cloth_dot_detector_new ();
  self->knows_colours = self->found = self->warned = FALSE;
  return TRUE;
}

/* What was learnt of the colours stays: it is of the camera, not of the film. */
static void
gst_dot_label_reset (GstClothFilter * filter)
{
  GstDotLabel *self = GST_DOT_LABEL (filter);

  if (self->labeller)
    cloth_film_labeller_reset (self->labeller);
}

/* FALSE: the chart teaches no colours, and an error was posted. */
static gboolean
learn_chart (GstDotLabel * self, const GstVideoInfo * film,
    const ClothDotParams * dot_params, const ClothDotLabelParams * label_params)
{
  GstVideoInfo info;
  g_autoptr (GstBuffer) buffer = gst_cloth_convert_picture (self->chart, film,
      GST_VIDEO_FORMAT_Y444, &info);
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();
  g_autofree gchar *reason = NULL;
  GstVideoFrame frame;
  ClothPlanarImage image;
  const ClothDot *dots;
  guint n;

  if (!buffer || !gst_video_frame_map (&frame, &info, buffer, GST_MAP_READ)) {
    reason = g_strdup ("the picture can't be converted to the film's colours");
  } else {
    gst_cloth_filter_view_planes (&frame, &image);
    cloth_dot_detector_run (detector, dot_params, &image, CLOTH_SIMD_BEST);
    gst_video_frame_unmap (&frame);
    dots = cloth_dot_detector_get_dots (detector, &n);
    if (cloth_film_labeller_learn_chart (self->labeller, label_params, dots, n))
      return TRUE;
    reason = g_strdup_printf
        ("%u dots are seen, but they fit nowhere into the pattern", n);
  }
  GST_ELEMENT_ERROR (self, STREAM, FAILED,
      ("The chart teaches no colours: %s.", reason),
      ("Set chart to a sharp picture in colour, by this camera, of the very "
          "print that is filmed, or leave it out."));
  return FALSE;
}

/* Starts the colours from those of the print, or as the chart shows them, in the luma and
 * chroma of this film. FALSE: the chart shows none, and an error was posted. */
static gboolean
gst_dot_label_prepare_colours (GstDotLabel * self, const GstVideoInfo * info,
    const ClothDotParams * dot_params, const ClothDotLabelParams * label_params)
{
  gdouble kr = 0.299, kb = 0.114;

  if (self->knows_colours && self->matrix == info->colorimetry.matrix)
    return TRUE;
  self->matrix = info->colorimetry.matrix;
  gst_video_color_matrix_get_Kr_Kb (self->matrix, &kr, &kb);
  cloth_film_labeller_start_colours (self->labeller, (gfloat) kr, (gfloat) kb);
  if (self->chart && !learn_chart (self, info, dot_params, label_params))
    return FALSE;
  self->knows_colours = TRUE;
  return TRUE;
}

static void
gst_dot_label_refuse_grey (GstDotLabel * self, const GstVideoFrame * video)
{
  GST_ELEMENT_ERROR (self, STREAM, FORMAT,
      ("Dots are told apart by their colours, and these pictures are grey."),
      ("Film in colour, and leave out what turns the pictures to %s before %s.",
          GST_VIDEO_INFO_NAME (&video->info), GST_OBJECT_NAME (self)));
}

static void
gst_dot_label_warn_of_swap (GstDotLabel * self, gint a, gint b)
{
  self->warned = TRUE;
  GST_ELEMENT_WARNING (self, STREAM, FAILED,
      ("Dots that should be %s look %s and the other way round: the two are "
          "swapped.", self->array->colours[a].name,
          self->array->colours[b].name),
      ("Give them in the order of the print in the list of colours in "
          "pattern.json."));
}

/* Some labels are found all the same where the print's colours are in another order. */
static void
gst_dot_label_check_swap (GstDotLabel * self)
{
  gint a, b;

  if (!self->warned && cloth_film_labeller_find_swap (self->labeller, &a, &b))
    gst_dot_label_warn_of_swap (self, a, b);
}

static void
gst_dot_label_warn_of_pattern (GstDotLabel * self)
{
  ClothDotLabelParams params;
  const ClothDot *dots;
  gint a, b;
  guint n;

  if (self->warned)
    return;
  GST_OBJECT_LOCK (self);
  params = self->settings.film.label;
  GST_OBJECT_UNLOCK (self);
  dots = cloth_dot_detector_get_dots (self->detector, &n);
  if (cloth_film_labeller_try_swaps (self->labeller, &params, dots, n, &a, &b)) {
    gst_dot_label_warn_of_swap (self, a, b);
    return;
  }
  self->warned = TRUE;
  GST_ELEMENT_WARNING (self, STREAM, FAILED,
      ("%u dots are seen, but they fit nowhere into the pattern.",
          self->dots->len),
      ("Set pattern to the file of the very print that is filmed. Colours "
          "that the printer has swapped, or a camera that sees them alike, "
          "look like another pattern too."));
}

/* A film may end before patience does. */
static gboolean
gst_dot_label_sink_event (GstBaseTransform * trans, GstEvent * event)
{
  GstDotLabel *self = GST_DOT_LABEL (trans);

  if (GST_EVENT_TYPE (event) == GST_EVENT_EOS && self->labeller
      && cloth_film_labeller_is_in_vain (self->labeller, TRUE))
    gst_dot_label_warn_of_pattern (self);
  return GST_BASE_TRANSFORM_CLASS (gst_dot_label_parent_class)->sink_event
      (trans, event);
}

/* Tells the bus when the pattern comes into sight and when it is gone, and the user when
 * it is another one. */
static void
gst_dot_label_tell (GstDotLabel * self, const GstClothFilterFrame * frame,
    guint n_dots, guint n_labelled)
{
  gboolean found = n_labelled > 0;

  if (found != self->found) {
    self->found = found;
    gst_element_post_message (GST_ELEMENT (self),
        gst_message_new_element (GST_OBJECT (self),
            gst_structure_new (found ? "dotlabel/found" : "dotlabel/lost",
                "camera", G_TYPE_STRING, frame->camera,
                "sequence", G_TYPE_UINT64, frame->sequence,
                "timestamp", G_TYPE_UINT64, GST_BUFFER_PTS (frame->buffer),
                "dots", G_TYPE_UINT, n_dots,
                "labelled", G_TYPE_UINT, n_labelled, NULL)));
  }
  if (cloth_film_labeller_is_in_vain (self->labeller, FALSE))
    gst_dot_label_warn_of_pattern (self);
  gst_dot_label_check_swap (self);
}

static GstFlowReturn
gst_dot_label_analyse (GstClothFilter * filter,
    const GstClothFilterFrame * frame)
{
  GstDotLabel *self = GST_DOT_LABEL (filter);
  const guint n_colours = (guint) self->array->n_colours;
  ClothDotParams dot_params;
  ClothFilmLabelParams film_params;
  ClothPlanarImage image;
  const ClothDot *dots;
  const ClothDotLabel *labels;
  const gfloat *likelihoods;
  guint n, n_labels, n_labelled;

  if (GST_VIDEO_FRAME_N_COMPONENTS (frame->video) < 3) {
    gst_dot_label_refuse_grey (self, frame->video);
    return GST_FLOW_ERROR;
  }
  image = frame->planes;
  GST_OBJECT_LOCK (self);
  dot_params = self->settings.dots;
  film_params = self->settings.film;
  GST_OBJECT_UNLOCK (self);
  if (!gst_dot_label_prepare_colours (self, &frame->video->info, &dot_params,
          &film_params.label))
    return GST_FLOW_ERROR;

  cloth_dot_detector_run (self->detector, &dot_params, &image, CLOTH_SIMD_BEST);
  dots = cloth_dot_detector_get_dots (self->detector, &n);
  n_labelled = cloth_film_labeller_run (self->labeller, &film_params, &image,
      dots, n);
  likelihoods = cloth_film_labeller_get_likelihoods (self->labeller);
  labels = cloth_film_labeller_get_labels (self->labeller, &n_labels);

  g_array_set_size (self->dots, n);
  for (guint k = 0; k < n; k++) {
    GstClothDot *dot = &g_array_index (self->dots, GstClothDot, k);

    memset (dot, 0, sizeof *dot);
    dot->column = labels[k].column;
    dot->row = labels[k].row;
    dot->mirrored = labels[k].mirrored;
    dot->confidence = labels[k].confidence;
    dot->touches = dots[k].touches;
    dot->x = dots[k].x;
    dot->y = dots[k].y;
    dot->cov_xx = dots[k].cov[0];
    dot->cov_xy = dots[k].cov[1];
    dot->cov_yy = dots[k].cov[2];
    for (guint c = 0; c < n_colours; c++)
      dot->log_likelihood[c] = MAX (likelihoods[k * n_colours + c],
          LEAST_LIKELIHOOD);
  }
  gst_buffer_add_cloth_dots_meta (frame->buffer,
      gst_cloth_dots_new (frame->camera, frame->sequence,
          (guint) self->array->columns, (guint) self->array->rows, n_colours,
          (const GstClothDot *) self->dots->data, n));
  gst_dot_label_tell (self, frame, n, n_labelled);
  GST_LOG_OBJECT (self, "%u dots, %u labelled", n, n_labelled);
  return GST_FLOW_OK;
}

static void
gst_dot_label_finalize (GObject * object)
{
  GstDotLabel *self = GST_DOT_LABEL (object);

  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  g_array_unref (self->dots);
  G_OBJECT_CLASS (gst_dot_label_parent_class)->finalize (object);
}

static Settings
default_settings (void)
{
  const Settings defaults = { NULL, NULL, cloth_dot_default_params (),
    cloth_film_label_default_params ()
  };

  return defaults;
}

static void
gst_dot_label_class_init (GstDotLabelClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothFilterClass *filter_class = GST_CLOTH_FILTER_CLASS (klass);
  const Settings defaults = default_settings ();

  GST_DEBUG_CATEGORY_INIT (dot_label_debug, "dotlabel", 0,
      "labelling of coloured dots");
  object_class->finalize = gst_dot_label_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      G_STRUCT_OFFSET (GstDotLabel, settings));

  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Dot labeller",
      "Filter/Analyzer/Video",
      "Finds and labels the dots of a colour-coded pattern on cloth",
      "The gst-cloth developers");
  GST_BASE_TRANSFORM_CLASS (klass)->sink_event = gst_dot_label_sink_event;
  filter_class->start = gst_dot_label_start;
  filter_class->stop = gst_dot_label_stop;
  filter_class->reset = gst_dot_label_reset;
  filter_class->analyse = gst_dot_label_analyse;
}

static void
gst_dot_label_init (GstDotLabel * self)
{
  self->settings = default_settings ();
  self->dots = g_array_new (FALSE, FALSE, sizeof (GstClothDot));
}
