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

#include "elements/gstclothutil.h"
#include "elements/gstdotlabelchart.h"
#include "gst/pattern/marray.h"
#include "gst/vision/label/dot-colour.h"
#include "gst/vision/label/dot-label.h"

GST_DEBUG_CATEGORY_STATIC (dot_label_debug);
#define GST_CAT_DEFAULT dot_label_debug

G_STATIC_ASSERT (GST_CLOTH_DOT_MAX_COLOURS >= CLOTH_M_ARRAY_MAX_COLOURS);
G_STATIC_ASSERT (GST_CLOTH_MAX_FEATURES >= CLOTH_DOT_MAX);

#define DEFAULT_LEARN TRUE
/* Pictures with dots but without a label before the user is told, and how many dots
 * make such a picture: those of one window. */
#define PATIENCE 25
#define WINDOW 9
/* Nobody needs to know by how much more a colour is ruled out, nats. */
#define LEAST_LIKELIHOOD -100.0f

/* A warning about a pattern that doesn't fit is better than no link at all: grey pictures
 * are let in, to be refused with a word on what to do. */
#define COLOUR_FORMATS "{ I420, YV12, NV12, NV21, Y42B, NV16, NV61, Y444, " \
    "NV24, Y41B, YUV9, YVU9, A420 }"
#define DOT_LABEL_CAPS GST_VIDEO_CAPS_MAKE (COLOUR_FORMATS) \
    ", width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ]; " \
    GST_VIDEO_CAPS_MAKE ("GRAY8") \
    ", width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ]"

typedef enum
{
  GST_DOT_LABEL_COLOURS_LIKELIHOOD,
  GST_DOT_LABEL_COLOURS_HUE
} GstDotLabelColours;

struct _GstDotLabel
{
  GstClothFilter parent;

  /* Properties, protected by the object lock. */
  gchar *pattern_path, *chart_path;
  GstDotLabelColours colours_by;
  gboolean learn;
  ClothDotParams dot_params;
  ClothDotLabelParams label_params;

  /* Streaming thread. */
  ClothMArray *array;
  GstSample *chart;             /* NULL: the colours start from those of the print */
  ClothDotDetector *detector;
  ClothDotLabeller *labeller;
  ClothDotColourModel colours;
  gboolean knows_colours;       /* those of the print or of the chart */
  gboolean adapted;             /* the colours, to this camera: they gave labels */
  GstVideoColorMatrix matrix;   /* that @colours are made for */
  GArray *likelihoods;          /* gfloat, the array's n_colours for each dot */
  GArray *dots;                 /* GstClothDot */
  GByteArray *said;             /* gint8, which colour a dot's label says that it has */
  gboolean found;
  guint n_in_vain;              /* pictures with dots and no label; none any more: 0 */
  gboolean warned;
};

enum
{
  PROP_0,
  PROP_PATTERN,
  PROP_CHART,
  PROP_COLOURS,
  PROP_LEARN,
  PROP_CONTRAST,
  PROP_SHARE,
  PROP_MIN_AREA,
  PROP_MAX_DIAMETER,
  PROP_ROUNDNESS,
  PROP_C,
  PROP_COLOUR_ERROR,
  PROP_LEAD,
  PROP_MIRRORED,
  PROP_LABELS,
  PROP_LEAST_REGION
};

#define GST_TYPE_DOT_LABEL_COLOURS (gst_dot_label_colours_get_type ())
static GType
gst_dot_label_colours_get_type (void)
{
  static const GEnumValue values[] = {
    {GST_DOT_LABEL_COLOURS_LIKELIHOOD,
        "Likelihood of a dot's mean chroma over its luma", "likelihood"},
    {GST_DOT_LABEL_COLOURS_HUE,
        "Every pixel votes for the nearest hue, the paper's way", "hue"},
    {0, NULL, NULL}
  };
  static gsize type = 0;

  if (g_once_init_enter (&type))
    g_once_init_leave (&type, g_enum_register_static ("GstDotLabelColours",
            values));
  return type;
}

typedef enum
{
  GST_DOT_LABEL_LABELS_PATCHES,
  GST_DOT_LABEL_LABELS_WINDOWS
} GstDotLabelLabels;

#define GST_TYPE_DOT_LABEL_LABELS (gst_dot_label_labels_get_type ())
static GType
gst_dot_label_labels_get_type (void)
{
  static const GEnumValue values[] = {
    {GST_DOT_LABEL_LABELS_PATCHES,
          "Likelihood of whole patches of the lattice, kept through time",
        "patches"},
    {GST_DOT_LABEL_LABELS_WINDOWS,
          "Single windows as seeds of growing regions, the paper's way",
        "windows"},
    {0, NULL, NULL}
  };
  static gsize type = 0;

  if (g_once_init_enter (&type))
    g_once_init_leave (&type, g_enum_register_static ("GstDotLabelLabels",
            values));
  return type;
}

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
  path = g_strdup (self->chart_path);
  GST_OBJECT_UNLOCK (self);
  if (!path)
    return TRUE;
  self->chart = gst_dot_label_chart_load (path, &error);
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
  g_clear_pointer (&self->labeller, cloth_dot_labeller_free);
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
  path = g_strdup (self->pattern_path);
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
  self->labeller = cloth_dot_labeller_new (self->array->columns,
      self->array->rows, self->array->n_colours, self->array->matrix, &error);
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
  self->knows_colours = self->adapted = FALSE;
  self->found = self->warned = FALSE;
  self->n_in_vain = 0;
  return TRUE;
}

/* What was learnt of the colours stays: it is of the camera, not of the film. */
static void
gst_dot_label_reset (GstClothFilter * filter)
{
  GstDotLabel *self = GST_DOT_LABEL (filter);

  if (self->labeller)
    cloth_dot_labeller_reset (self->labeller);
}

/* Starts the colours from those of the print, or as the chart shows them, in the luma and
 * chroma of this film. FALSE: the chart shows none, and an error was posted. */
static gboolean
gst_dot_label_prepare_colours (GstDotLabel * self, const GstVideoInfo * info,
    const ClothDotParams * dot_params, const ClothDotLabelParams * label_params)
{
  guint8 rgb[CLOTH_M_ARRAY_MAX_COLOURS][3];
  gdouble kr = 0.299, kb = 0.114;
  g_autoptr (GError) error = NULL;

  if (self->knows_colours && self->matrix == info->colorimetry.matrix)
    return TRUE;
  self->matrix = info->colorimetry.matrix;
  self->adapted = FALSE;
  gst_video_color_matrix_get_Kr_Kb (self->matrix, &kr, &kb);
  for (gint i = 0; i < self->array->n_colours; i++)
    memcpy (rgb[i], self->array->colours[i].rgb, 3);
  cloth_dot_colour_model_init (&self->colours, self->array->n_colours,
      (const guint8 (*)[3]) rgb, (gfloat) kr, (gfloat) kb);
  if (self->chart && !gst_dot_label_chart_learn (self->chart, self->array, info,
          dot_params, label_params, &self->colours, &error)) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED,
        ("The chart teaches no colours: %s.", error->message),
        ("Set chart to a sharp picture in colour, by this camera, of the very "
            "print that is filmed, or leave it out."));
    return FALSE;
  }
  self->knows_colours = TRUE;
  return TRUE;
}

/* Classifies and labels; returns how many dots have a label. */
static guint
gst_dot_label_try (GstDotLabel * self, const ClothDotImage * image,
    const ClothDot * dots, guint n, GstDotLabelColours by,
    const ClothDotLabelParams * params)
{
  gfloat *likelihoods;

  g_byte_array_set_size (self->said, n);
  g_array_set_size (self->likelihoods, n * (guint) self->array->n_colours);
  likelihoods = (gfloat *) self->likelihoods->data;
  if (by == GST_DOT_LABEL_COLOURS_HUE)
    cloth_dot_colour_model_vote (&self->colours, image, dots, n, likelihoods);
  else
    cloth_dot_colour_model_classify (&self->colours, dots, n, likelihoods);
  cloth_dot_labeller_run (self->labeller, params, dots, n, likelihoods);
  return gst_dot_label_say (self->labeller, self->array,
      (gint8 *) self->said->data);
}

/* Until anything has been labelled, a picture that the print's own colours say nothing of
 * is looked at once more, in the light that makes its dots likeliest. */
static guint
gst_dot_label_adapt (GstDotLabel * self, const ClothDotImage * image,
    const ClothDot * dots, guint n, GstDotLabelColours by,
    const ClothDotLabelParams * params)
{
  const ClothDotColourModel before = self->colours;
  guint n_labelled = 0;

  /* Dots of another print are looked at so closely now and then only; a few dots may be of
   * any colour. */
  if ((self->n_in_vain > PATIENCE && self->n_in_vain % PATIENCE)
      || n < WINDOW * (guint) self->array->n_colours
      || !cloth_dot_colour_model_adapt (&self->colours, dots, n))
    return 0;
  n_labelled = gst_dot_label_try (self, image, dots, n, by, params);
  if (n_labelled == 0)
    self->colours = before;
  return n_labelled;
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

  if (!self->warned && cloth_dot_labeller_find_swap (self->labeller, &a, &b))
    gst_dot_label_warn_of_swap (self, a, b);
}

/* Where none are: which two colours, taken for each other, give the last picture the most
 * labels, at least those of a few windows. */
static gboolean
gst_dot_label_try_swaps (GstDotLabel * self, gint * a, gint * b)
{
  const ClothDotColourModel colours = self->colours;
  ClothDotLabelParams params;
  const ClothDot *dots;
  guint n, most = 4 * WINDOW;
  gboolean found = FALSE;

  GST_OBJECT_LOCK (self);
  params = self->label_params;
  GST_OBJECT_UNLOCK (self);
  dots = cloth_dot_detector_get_dots (self->detector, &n);
  for (gint i = 0; i < colours.n; i++) {
    for (gint j = 0; j < i; j++) {
      guint n_labelled;

      self->colours.classes[i] = colours.classes[j];
      self->colours.classes[j] = colours.classes[i];
      cloth_dot_labeller_reset (self->labeller);
      n_labelled = gst_dot_label_try (self, NULL, dots, n,
          GST_DOT_LABEL_COLOURS_LIKELIHOOD, &params);
      self->colours = colours;
      if (n_labelled < most)
        continue;
      most = n_labelled;
      *a = j;
      *b = i;
      found = TRUE;
    }
  }
  cloth_dot_labeller_reset (self->labeller);
  return found;
}

static void
gst_dot_label_warn_of_pattern (GstDotLabel * self)
{
  gint a, b;

  if (self->warned)
    return;
  if (gst_dot_label_try_swaps (self, &a, &b)) {
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

  if (GST_EVENT_TYPE (event) == GST_EVENT_EOS && self->n_in_vain > 0
      && !self->adapted)
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
  if (found)
    self->n_in_vain = 0;
  else if (n_dots >= WINDOW)
    self->n_in_vain++;
  if (self->n_in_vain == PATIENCE)
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
  ClothDotLabelParams label_params;
  GstDotLabelColours colours_by;
  ClothDotImage image;
  const ClothDot *dots;
  const ClothDotLabel *labels;
  const gfloat *likelihoods;
  gboolean learn;
  guint n, n_labels, n_labelled = 0;

  if (GST_VIDEO_FRAME_N_COMPONENTS (frame->video) < 3) {
    gst_dot_label_refuse_grey (self, frame->video);
    return GST_FLOW_ERROR;
  }
  gst_dot_label_view (frame->video, &image);
  GST_OBJECT_LOCK (self);
  dot_params = self->dot_params;
  label_params = self->label_params;
  colours_by = self->colours_by;
  learn = self->learn;
  GST_OBJECT_UNLOCK (self);
  if (!gst_dot_label_prepare_colours (self, &frame->video->info, &dot_params,
          &label_params))
    return GST_FLOW_ERROR;

  cloth_dot_detector_run (self->detector, &dot_params, &image, CLOTH_SIMD_BEST);
  dots = cloth_dot_detector_get_dots (self->detector, &n);
  n_labelled = gst_dot_label_try (self, &image, dots, n, colours_by,
      &label_params);
  if (n_labelled == 0 && learn && !self->adapted)
    n_labelled = gst_dot_label_adapt (self, &image, dots, n, colours_by,
        &label_params);
  self->adapted |= n_labelled > 0;
  likelihoods = (const gfloat *) self->likelihoods->data;
  labels = cloth_dot_labeller_get_labels (self->labeller, &n_labels);
  /* what the labels tell of the camera's colours is for the next picture */
  if (learn)
    cloth_dot_colour_model_learn (&self->colours, dots, n,
        (const gint8 *) self->said->data);

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
gst_dot_label_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  GstDotLabel *self = GST_DOT_LABEL (object);

  GST_OBJECT_LOCK (self);
  if (!gst_cloth_may_change (GST_ELEMENT (self), pspec)) {
    GST_OBJECT_UNLOCK (self);
    return;
  }
  switch (id) {
    case PROP_PATTERN:
      g_free (self->pattern_path);
      self->pattern_path = g_value_dup_string (value);
      break;
    case PROP_CHART:
      g_free (self->chart_path);
      self->chart_path = g_value_dup_string (value);
      break;
    case PROP_COLOURS:
      self->colours_by = (GstDotLabelColours) g_value_get_enum (value);
      break;
    case PROP_LEARN:
      self->learn = g_value_get_boolean (value);
      break;
    case PROP_CONTRAST:
      self->dot_params.contrast = g_value_get_float (value);
      break;
    case PROP_SHARE:
      self->dot_params.share = g_value_get_float (value);
      break;
    case PROP_MIN_AREA:
      self->dot_params.min_area = g_value_get_float (value);
      break;
    case PROP_MAX_DIAMETER:
      self->dot_params.max_diameter = g_value_get_int (value);
      break;
    case PROP_ROUNDNESS:
      self->dot_params.roundness = g_value_get_float (value);
      break;
    case PROP_C:
      self->label_params.c = g_value_get_float (value);
      break;
    case PROP_COLOUR_ERROR:
      self->label_params.colour_error = g_value_get_float (value);
      break;
    case PROP_LEAD:
      self->label_params.lead = g_value_get_float (value);
      break;
    case PROP_MIRRORED:
      self->label_params.mirrored = g_value_get_boolean (value);
      break;
    case PROP_LABELS:
      self->label_params.paper =
          g_value_get_enum (value) == GST_DOT_LABEL_LABELS_WINDOWS;
      break;
    case PROP_LEAST_REGION:
      self->label_params.least_region = g_value_get_uint (value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_dot_label_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * pspec)
{
  GstDotLabel *self = GST_DOT_LABEL (object);

  GST_OBJECT_LOCK (self);
  switch (id) {
    case PROP_PATTERN:
      g_value_set_string (value, self->pattern_path);
      break;
    case PROP_CHART:
      g_value_set_string (value, self->chart_path);
      break;
    case PROP_COLOURS:
      g_value_set_enum (value, (gint) self->colours_by);
      break;
    case PROP_LEARN:
      g_value_set_boolean (value, self->learn);
      break;
    case PROP_CONTRAST:
      g_value_set_float (value, self->dot_params.contrast);
      break;
    case PROP_SHARE:
      g_value_set_float (value, self->dot_params.share);
      break;
    case PROP_MIN_AREA:
      g_value_set_float (value, self->dot_params.min_area);
      break;
    case PROP_MAX_DIAMETER:
      g_value_set_int (value, self->dot_params.max_diameter);
      break;
    case PROP_ROUNDNESS:
      g_value_set_float (value, self->dot_params.roundness);
      break;
    case PROP_C:
      g_value_set_float (value, self->label_params.c);
      break;
    case PROP_COLOUR_ERROR:
      g_value_set_float (value, self->label_params.colour_error);
      break;
    case PROP_LEAD:
      g_value_set_float (value, self->label_params.lead);
      break;
    case PROP_MIRRORED:
      g_value_set_boolean (value, self->label_params.mirrored);
      break;
    case PROP_LABELS:
      g_value_set_enum (value, self->label_params.paper ?
          GST_DOT_LABEL_LABELS_WINDOWS : GST_DOT_LABEL_LABELS_PATCHES);
      break;
    case PROP_LEAST_REGION:
      g_value_set_uint (value, self->label_params.least_region);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_dot_label_finalize (GObject * object)
{
  GstDotLabel *self = GST_DOT_LABEL (object);

  g_free (self->pattern_path);
  g_free (self->chart_path);
  g_array_unref (self->likelihoods);
  g_array_unref (self->dots);
  g_byte_array_unref (self->said);
  G_OBJECT_CLASS (gst_dot_label_parent_class)->finalize (object);
}

static void
install_float (GObjectClass * klass, guint id, const gchar * name,
    const gchar * nick, const gchar * blurb, gfloat low, gfloat high,
    gfloat value)
{
  g_object_class_install_property (klass, id, g_param_spec_float (name, nick,
          blurb, low, high, value, G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_PLAYING | GST_PARAM_CONTROLLABLE));
}

static void
gst_dot_label_class_init (GstDotLabelClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothFilterClass *filter_class = GST_CLOTH_FILTER_CLASS (klass);
  const ClothDotParams dots = cloth_dot_default_params ();
  const ClothDotLabelParams labels = cloth_dot_label_default_params ();
  const GParamFlags any_time = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
      | GST_PARAM_MUTABLE_PLAYING | GST_PARAM_CONTROLLABLE;

  GST_DEBUG_CATEGORY_INIT (dot_label_debug, "dotlabel", 0,
      "labelling of coloured dots");
  object_class->set_property = gst_dot_label_set_property;
  object_class->get_property = gst_dot_label_get_property;
  object_class->finalize = gst_dot_label_finalize;

  g_object_class_install_property (object_class, PROP_PATTERN,
      g_param_spec_string ("pattern", "Pattern",
          "File pattern.json of the M-array that is filmed", NULL,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_READY));
  g_object_class_install_property (object_class, PROP_CHART,
      g_param_spec_string ("chart", "Chart",
          "Picture of the print by this camera, from which the colours of the dots "
          "are learnt before the film", NULL,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_READY));
  g_object_class_install_property (object_class, PROP_COLOURS,
      g_param_spec_enum ("colours", "Colours",
          "How dots are told apart by colour", GST_TYPE_DOT_LABEL_COLOURS,
          GST_DOT_LABEL_COLOURS_LIKELIHOOD, any_time));
  g_object_class_install_property (object_class, PROP_LEARN,
      g_param_spec_boolean ("learn", "Learn",
          "Whether the colours as the camera sees them are learnt from the film, "
          "blindly at first, then from labelled dots; else they are as printed or as on "
          "the chart", DEFAULT_LEARN, any_time));
  install_float (object_class, PROP_CONTRAST, "contrast", "Contrast",
      "Least luma of a dot above the ground around it, grey levels", 1, 254,
      dots.contrast);
  install_float (object_class, PROP_SHARE, "share", "Share",
      "Least luma of a dot above the ground as a share of the brightest around",
      0, 0.9f, dots.share);
  install_float (object_class, PROP_MIN_AREA, "min-area", "Least area",
      "Area from which on a spot is a dot, px", 4, 40000, dots.min_area);
  g_object_class_install_property (object_class, PROP_MAX_DIAMETER,
      g_param_spec_int ("max-diameter", "Greatest diameter",
          "Extent up to which a spot is a dot, px", 4, CLOTH_DOT_MAX_DIAMETER,
          dots.max_diameter, any_time));
  install_float (object_class, PROP_ROUNDNESS, "roundness", "Roundness",
      "Area from which on a spot is a dot, as a share of that of the ellipse with "
      "the same second moments", 0, 1, dots.roundness);
  install_float (object_class, PROP_C, "c", "c",
      "Greatest change of the vector from dot to neighbouring dot from one dot to "
      "the next, as a share of its length; folds change it more and end the "
      "growing", 0, 1, labels.c);
  install_float (object_class, PROP_COLOUR_ERROR, "colour-error",
      "Colour error",
      "Share of the dots that are taken for having any colour at all", 0.001f,
      0.9f, labels.colour_error);
  install_float (object_class, PROP_LEAD, "lead", "Lead",
      "Least log-odds of a patch's place in the pattern, nats: against the next "
      "best place and against dots of random colours", 0, 1000, labels.lead);
  g_object_class_install_property (object_class, PROP_MIRRORED,
      g_param_spec_boolean ("mirrored", "Mirrored",
          "Whether the print may be seen from behind, as in a mirror",
          labels.mirrored, any_time));
  g_object_class_install_property (object_class, PROP_LABELS,
      g_param_spec_enum ("labels", "Labels",
          "How dots are given their place in the pattern",
          GST_TYPE_DOT_LABEL_LABELS, labels.paper ?
          GST_DOT_LABEL_LABELS_WINDOWS : GST_DOT_LABEL_LABELS_PATCHES,
          any_time));
  g_object_class_install_property (object_class, PROP_LEAST_REGION,
      g_param_spec_uint ("least-region", "Least region",
          "Fewest dots of a region that labels=windows keeps", 3, 65536,
          labels.least_region, any_time));

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
  gst_type_mark_as_plugin_api (GST_TYPE_DOT_LABEL_COLOURS, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_DOT_LABEL_LABELS, 0);
}

static void
gst_dot_label_init (GstDotLabel * self)
{
  self->dot_params = cloth_dot_default_params ();
  self->label_params = cloth_dot_label_default_params ();
  self->likelihoods = g_array_new (FALSE, FALSE, sizeof (gfloat));
  self->dots = g_array_new (FALSE, FALSE, sizeof (GstClothDot));
  self->said = g_byte_array_new ();
  self->learn = DEFAULT_LEARN;
}
