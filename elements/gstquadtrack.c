/* quadtrack: the squares of a checkerboard, tracked through a film.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstquadtrack.h"

#include <gst/cloth/cloth.h>
#include <gst/video/navigation.h>
#include <math.h>
#include <string.h>

#include "elements/gstclothutil.h"
#include "elements/gstquadtrackseed.h"
#include "gst/pattern/pattern.h"
#include "gst/vision/quad/quad.h"
#include "gst/vision/corner/saddle.h"

GST_DEBUG_CATEGORY_STATIC (quad_track_debug);
#define GST_CAT_DEFAULT quad_track_debug

/**
 * SECTION:element-quadtrack
 *
 * Tracks the squares of a checkerboard on cloth and attaches them as #GstClothQuads. It
 * takes the saddles that `saddledetect` attached, or finds them itself.
 *
 * The board is found without help. A square can be given all the same: by four clicks
 * into any video sink (navigation events; a right click starts over) or by the property
 * `seed`; with `link=false` the tracker is that of the paper alone and needs one: until
 * there is one it warns and tracks nothing, as with a seed where no square of the board is
 * seen.
 *
 * The bus is told by the element messages `quadtrack/found` and `quadtrack/lost` when the
 * board comes into sight and when all of it is gone; their fields are `camera`,
 * `sequence`, `timestamp` (PTS, ns) and `squares`, the number of those tracked.
 *
 * ## Example
 * ```
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! saddledetect !
 *     quadtrack columns=8 rows=8 ! clothoverlay ! videoconvert ! autovideosink
 * ```
 */
struct _GstQuadTrack
{
  GstClothFilter parent;

  /* Properties, protected by the object lock. */
  gchar *pattern_path;
  gint columns, rows;
  gboolean first_black;
  gchar *seed;
  ClothQuadParams params;

  /* Clicks, protected by the object lock. */
  GArray *clicks;               /* gfloat, x and y of up to four */
  GArray *seeds;                /* gfloat, ten each: corners, column, row */

  /* Streaming thread. */
  ClothPattern *pattern;
  ClothQuadTracker *tracker;
  ClothSaddleDetector *detector;
  GArray *taken_seeds;          /* gfloat, of this picture */
  GArray *saddles;              /* GstClothSaddle */
  GArray *candidates;           /* GstClothCandidate */
  GArray *quads;                /* GstClothQuad */
  gboolean found;
  GstQuadTrackWarned warned;
  gfloat first_seed[GST_QUAD_TRACK_SEED_NUMBERS];       /* of the property */
  gboolean has_first_seed, knows_first, was_reset;
  guint64 first_sequence;       /* of the picture that the property is about */
};

enum
{
  PROP_0,
  PROP_PATTERN,
  PROP_COLUMNS,
  PROP_ROWS,
  PROP_FIRST_BLACK,
  PROP_SEED,
  PROP_LINK,
  PROP_SQUARES,
  PROP_ALPHA,
  PROP_C_LOW,
  PROP_C_HIGH,
  PROP_C_PRED,
  PROP_DAMPING,
  PROP_CONSISTENCY,
  PROP_MAX_VARIANTS
};

#define GST_TYPE_QUAD_TRACK_SQUARES (gst_quad_track_squares_get_type ())
static GType
gst_quad_track_squares_get_type (void)
{
  static const GEnumValue values[] = {
    {CLOTH_SQUARES_BLACK, "Black squares", "black"},
    {CLOTH_SQUARES_WHITE, "White squares", "white"},
    {CLOTH_SQUARES_BOTH, "Squares of both colours", "both"},
    {0, NULL, NULL}
  };
  static gsize type = 0;

  if (g_once_init_enter (&type))
    g_once_init_leave (&type, g_enum_register_static ("GstQuadTrackSquares",
            values));
  return type;
}

G_DEFINE_TYPE (GstQuadTrack, gst_quad_track, GST_TYPE_CLOTH_FILTER);

GST_ELEMENT_REGISTER_DEFINE (quadtrack, "quadtrack", GST_RANK_NONE,
    GST_TYPE_QUAD_TRACK);

G_STATIC_ASSERT (sizeof (GstClothSaddle) == sizeof (ClothSaddle));
G_STATIC_ASSERT (sizeof (GstClothCandidate) == sizeof (ClothSaddleCandidate));
G_STATIC_ASSERT ((gint) GST_CLOTH_QUAD_TRACKED == (gint) CLOTH_QUAD_TRACKED);
G_STATIC_ASSERT ((gint) GST_CLOTH_QUAD_LOST == (gint) CLOTH_QUAD_LOST);

static gboolean
gst_quad_track_start (GstClothFilter * filter)
{
  GstQuadTrack *self = GST_QUAD_TRACK (filter);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL, *seed = NULL;
  gint columns, rows;
  gboolean first_black;

  GST_OBJECT_LOCK (self);
  path = g_strdup (self->pattern_path);
  seed = g_strdup (self->seed);
  columns = self->columns;
  rows = self->rows;
  first_black = self->first_black;
  GST_OBJECT_UNLOCK (self);

  self->has_first_seed = seed != NULL;
  self->knows_first = FALSE;
  self->was_reset = TRUE;
  if (seed && !gst_quad_track_seed_parse (seed, self->first_seed)) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("Can't read the seed \"%s\".", seed),
        ("\"seed\" takes x0,y0,x1,y1,x2,y2,x3,y3 in pixels, and the square's "
            "column,row, counted from 0, if known"));
    return FALSE;
  }
  if (path) {
    self->pattern = cloth_pattern_load (path, &error);
    if (!self->pattern) {
      GST_ELEMENT_ERROR (self, RESOURCE, READ,
          ("Can't read the pattern: %s", error->message),
          ("set \"pattern\" to a pattern.json that gst-cloth-pattern-1.0 wrote, "
              "or leave it out and set \"columns\" and \"rows\""));
      return FALSE;
    }
  } else {
    self->pattern = cloth_pattern_new_checker (columns, rows, 1.0, 0.0,
        first_black, &error);
    g_assert (self->pattern);
  }
  self->tracker = cloth_quad_tracker_new (self->pattern);
  self->found = FALSE;
  memset (&self->warned, 0, sizeof (self->warned));
  return TRUE;
}

static void
gst_quad_track_stop (GstClothFilter * filter)
{
  GstQuadTrack *self = GST_QUAD_TRACK (filter);

  g_clear_pointer (&self->tracker, cloth_quad_tracker_free);
  g_clear_pointer (&self->pattern, cloth_pattern_free);
  g_clear_pointer (&self->detector, cloth_saddle_detector_free);
  GST_OBJECT_LOCK (self);
  g_array_set_size (self->clicks, 0);
  g_array_set_size (self->seeds, 0);
  GST_OBJECT_UNLOCK (self);
}

static void
gst_quad_track_reset (GstClothFilter * filter)
{
  GstQuadTrack *self = GST_QUAD_TRACK (filter);

  if (!self->tracker)
    return;
  cloth_quad_tracker_reset (self->tracker);
  self->was_reset = TRUE;
  /* what was clicked into earlier pictures is of them */
  GST_OBJECT_LOCK (self);
  g_array_set_size (self->clicks, 0);
  g_array_set_size (self->seeds, 0);
  GST_OBJECT_UNLOCK (self);
}

/* Tells the bus when the board comes into sight and when it is gone. */
static void
gst_quad_track_tell (GstQuadTrack * self, const GstClothFilterFrame * frame,
    guint tracked)
{
  gboolean found = tracked > 0;

  if (found == self->found)
    return;
  self->found = found;
  gst_element_post_message (GST_ELEMENT (self),
      gst_message_new_element (GST_OBJECT (self),
          gst_structure_new (found ? "quadtrack/found" : "quadtrack/lost",
              "camera", G_TYPE_STRING, frame->camera,
              "sequence", G_TYPE_UINT64, frame->sequence,
              "timestamp", G_TYPE_UINT64, GST_BUFFER_PTS (frame->buffer),
              "squares", G_TYPE_UINT, tracked, NULL)));
}

/* Whether a saddle that came as metadata is one of this picture: anybody may have written
 * it. What compares with NaN is false. */
static inline gboolean
is_usable (const GstClothSaddle * saddle, const ClothImage * image)
{
  return saddle->x >= 0 && saddle->y >= 0
      && saddle->x <= (gfloat) (image->width - 1)
      && saddle->y <= (gfloat) (image->height - 1)
      && saddle->axis >= 0 && saddle->axis <= (gfloat) G_PI
      && saddle->cov_xx >= 0 && saddle->cov_yy >= 0
      && isfinite (saddle->response + saddle->cov_xx + saddle->cov_xy +
      saddle->cov_yy);
}

/* Takes over the saddles of @meta. */
static void
gst_quad_track_take_saddles (GstQuadTrack * self, GstClothSaddles * meta,
    const ClothImage * image)
{
  guint n;
  const GstClothSaddle *refined = gst_cloth_saddles_get_refined (meta, &n);
  const GstClothCandidate *from;
  guint n_usable = 0;

  g_array_set_size (self->saddles, n);
  for (guint k = 0; k < n; k++)
    if (is_usable (&refined[k], image))
      g_array_index (self->saddles, GstClothSaddle, n_usable++) = refined[k];
  if (n_usable < n)
    GST_DEBUG_OBJECT (self, "%u of %u saddles are none of this picture",
        n - n_usable, n);
  g_array_set_size (self->saddles, n_usable);

  from = gst_cloth_saddles_get_candidates (meta, &n);
  g_array_set_size (self->candidates, 0);
  for (guint k = 0; k < n; k++) {
    if (!(from[k].x >= -0.5f && from[k].y >= -0.5f
            && from[k].x < (gfloat) image->width - 0.5f
            && from[k].y < (gfloat) image->height - 0.5f))
      continue;
    g_array_append_val (self->candidates, from[k]);
  }
}

static GstFlowReturn
gst_quad_track_analyse (GstClothFilter * filter,
    const GstClothFilterFrame * frame)
{
  GstQuadTrack *self = GST_QUAD_TRACK (filter);
  GstClothSaddles *meta = gst_buffer_get_cloth_saddles (frame->buffer);
  const ClothSaddleCandidate *candidates;
  const ClothSaddle *saddles;
  const ClothQuad *quads;
  ClothQuadParams params;
  guint n_saddles, n_candidates, n, tracked = 0, n_seeds;

  if (meta) {
    gst_quad_track_take_saddles (self, meta, &frame->luma);
    saddles = (const ClothSaddle *) self->saddles->data;
    n_saddles = self->saddles->len;
    n_candidates = self->candidates->len;
    candidates = (const ClothSaddleCandidate *) self->candidates->data;
  } else {
    ClothSaddleParams saddle_params = cloth_saddle_default_params ();

    if (!self->detector)
      self->detector = cloth_saddle_detector_new ();
    cloth_saddle_detector_run (self->detector, &saddle_params, &frame->luma,
        CLOTH_SIMD_BEST);
    saddles = cloth_saddle_detector_get_saddles (self->detector, &n_saddles);
    candidates = cloth_saddle_detector_get_candidates (self->detector,
        &n_candidates);
  }

  if (!self->knows_first)
    self->first_sequence = frame->sequence;
  self->knows_first = TRUE;
  GST_OBJECT_LOCK (self);
  params = self->params;
  /* again after a seek back to it, not elsewhere: there it would be wrong */
  if (self->has_first_seed && self->was_reset
      && frame->sequence == self->first_sequence)
    g_array_append_vals (self->seeds, self->first_seed,
        GST_QUAD_TRACK_SEED_NUMBERS);
  self->was_reset = FALSE;
  /* a message must not be posted with the lock held */
  n_seeds = self->seeds->len / GST_QUAD_TRACK_SEED_NUMBERS;
  g_array_set_size (self->taken_seeds, 0);
  g_array_append_vals (self->taken_seeds, self->seeds->data, self->seeds->len);
  g_array_set_size (self->seeds, 0);
  GST_OBJECT_UNLOCK (self);
  gst_quad_track_seed_check_start (GST_ELEMENT (self), &self->warned,
      self->pattern, &params, n_seeds);
  for (guint s = 0; s < n_seeds; s++) {
    const gfloat *seed = &g_array_index (self->taken_seeds, gfloat,
        s * GST_QUAD_TRACK_SEED_NUMBERS);
    gint column = (gint) seed[8], row = (gint) seed[9];
    gfloat x[4], y[4];

    for (gint c = 0; c < 4; c++) {
      x[c] = seed[2 * c];
      y[c] = seed[2 * c + 1];
    }
    gst_quad_track_seed_check (GST_ELEMENT (self), &self->warned, self->pattern,
        &params, column, row);
    cloth_quad_tracker_seed (self->tracker, x, y, column, row);
  }

  quads = cloth_quad_tracker_run (self->tracker, &params, &frame->luma,
      saddles, n_saddles, candidates, n_candidates, &n);
  n = MIN (n, GST_CLOTH_MAX_FEATURES);
  g_array_set_size (self->quads, n);
  for (guint k = 0; k < n; k++) {
    GstClothQuad *quad = &g_array_index (self->quads, GstClothQuad, k);

    quad->column = quads[k].column;
    quad->row = quads[k].row;
    quad->state = (GstClothQuadState) quads[k].state;
    quad->black = quads[k].black;
    quad->confidence = quads[k].confidence;
    for (gint c = 0; c < 4; c++) {
      quad->x[c] = quads[k].x[c];
      quad->y[c] = quads[k].y[c];
      quad->cov_xx[c] = quads[k].cov[c][0];
      quad->cov_xy[c] = quads[k].cov[c][1];
      quad->cov_yy[c] = quads[k].cov[c][2];
    }
    tracked += quads[k].state == CLOTH_QUAD_TRACKED;
  }
  gst_buffer_add_cloth_quads_meta (frame->buffer,
      gst_cloth_quads_new (frame->camera, frame->sequence,
          (guint) self->pattern->columns, (guint) self->pattern->rows,
          (const GstClothQuad *) self->quads->data, n));
  gst_quad_track_seed_check_tracked (GST_ELEMENT (self), &self->warned, &params,
      n_seeds, tracked);
  gst_quad_track_tell (self, frame, tracked);
  GST_LOG_OBJECT (self, "%u saddles, %u squares tracked", n_saddles, tracked);
  return GST_FLOW_OK;
}

/* Four left clicks make a seed, a right click takes back those made so far. */
static gboolean
gst_quad_track_src_event (GstBaseTransform * trans, GstEvent * event)
{
  GstQuadTrack *self = GST_QUAD_TRACK (trans);
  gint button;
  gdouble x, y;

  if (GST_EVENT_TYPE (event) == GST_EVENT_NAVIGATION
      && gst_navigation_event_get_type (event) ==
      GST_NAVIGATION_EVENT_MOUSE_BUTTON_PRESS
      && gst_navigation_event_parse_mouse_button_event (event, &button, &x,
          &y) && isfinite (x) && isfinite (y)) {
    GST_OBJECT_LOCK (self);
    if (button == 1) {
      gfloat point[2] = { (gfloat) x, (gfloat) y };

      g_array_append_vals (self->clicks, point, 2);
      if (self->clicks->len == 8) {
        gfloat untold[2] = { -1, -1 };

        g_array_append_vals (self->seeds, self->clicks->data, 8);
        g_array_append_vals (self->seeds, untold, 2);
        g_array_set_size (self->clicks, 0);
      }
    } else {
      g_array_set_size (self->clicks, 0);
    }
    GST_OBJECT_UNLOCK (self);
  }
  return GST_BASE_TRANSFORM_CLASS (gst_quad_track_parent_class)->src_event
      (trans, event);
}

static void
gst_quad_track_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  GstQuadTrack *self = GST_QUAD_TRACK (object);

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
    case PROP_COLUMNS:
      self->columns = g_value_get_int (value);
      break;
    case PROP_ROWS:
      self->rows = g_value_get_int (value);
      break;
    case PROP_FIRST_BLACK:
      self->first_black = g_value_get_boolean (value);
      break;
    case PROP_SEED:
      g_free (self->seed);
      self->seed = g_value_dup_string (value);
      break;
    case PROP_LINK:
      self->params.link = g_value_get_boolean (value);
      break;
    case PROP_SQUARES:
      self->params.squares = (ClothSquares) g_value_get_enum (value);
      break;
    case PROP_ALPHA:
      self->params.alpha = g_value_get_float (value);
      break;
    case PROP_C_LOW:
      self->params.c_low = g_value_get_float (value);
      break;
    case PROP_C_HIGH:
      self->params.c_high = g_value_get_float (value);
      break;
    case PROP_C_PRED:
      self->params.c_pred = g_value_get_float (value);
      break;
    case PROP_DAMPING:
      self->params.damping = g_value_get_float (value);
      break;
    case PROP_CONSISTENCY:
      self->params.consistency = g_value_get_float (value);
      break;
    case PROP_MAX_VARIANTS:
      self->params.max_variants = g_value_get_uint (value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_quad_track_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * pspec)
{
  GstQuadTrack *self = GST_QUAD_TRACK (object);

  GST_OBJECT_LOCK (self);
  switch (id) {
    case PROP_PATTERN:
      g_value_set_string (value, self->pattern_path);
      break;
    case PROP_COLUMNS:
      g_value_set_int (value, self->columns);
      break;
    case PROP_ROWS:
      g_value_set_int (value, self->rows);
      break;
    case PROP_FIRST_BLACK:
      g_value_set_boolean (value, self->first_black);
      break;
    case PROP_SEED:
      g_value_set_string (value, self->seed);
      break;
    case PROP_LINK:
      g_value_set_boolean (value, self->params.link);
      break;
    case PROP_SQUARES:
      g_value_set_enum (value, (gint) self->params.squares);
      break;
    case PROP_ALPHA:
      g_value_set_float (value, self->params.alpha);
      break;
    case PROP_C_LOW:
      g_value_set_float (value, self->params.c_low);
      break;
    case PROP_C_HIGH:
      g_value_set_float (value, self->params.c_high);
      break;
    case PROP_C_PRED:
      g_value_set_float (value, self->params.c_pred);
      break;
    case PROP_DAMPING:
      g_value_set_float (value, self->params.damping);
      break;
    case PROP_CONSISTENCY:
      g_value_set_float (value, self->params.consistency);
      break;
    case PROP_MAX_VARIANTS:
      g_value_set_uint (value, self->params.max_variants);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_quad_track_finalize (GObject * object)
{
  GstQuadTrack *self = GST_QUAD_TRACK (object);

  g_free (self->pattern_path);
  g_free (self->seed);
  g_array_unref (self->clicks);
  g_array_unref (self->seeds);
  g_array_unref (self->taken_seeds);
  g_array_unref (self->saddles);
  g_array_unref (self->candidates);
  g_array_unref (self->quads);
  G_OBJECT_CLASS (gst_quad_track_parent_class)->finalize (object);
}

static void
gst_quad_track_class_init (GstQuadTrackClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseTransformClass *trans_class = GST_BASE_TRANSFORM_CLASS (klass);
  GstClothFilterClass *filter_class = GST_CLOTH_FILTER_CLASS (klass);
  const ClothQuadParams standard = cloth_quad_default_params ();
  const GParamFlags at_start = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
      | GST_PARAM_MUTABLE_READY;
  const GParamFlags any_time = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
      | GST_PARAM_MUTABLE_PLAYING | GST_PARAM_CONTROLLABLE;

  GST_DEBUG_CATEGORY_INIT (quad_track_debug, "quadtrack", 0,
      "tracking of checkerboard squares");
  object_class->set_property = gst_quad_track_set_property;
  object_class->get_property = gst_quad_track_get_property;
  object_class->finalize = gst_quad_track_finalize;

  g_object_class_install_property (object_class, PROP_PATTERN,
      g_param_spec_string ("pattern", "Pattern",
          "File pattern.json of the board; without it columns, rows and "
          "first-black tell what the board is", NULL, at_start));
  g_object_class_install_property (object_class, PROP_COLUMNS,
      g_param_spec_int ("columns", "Columns",
          "Number of squares in a row of the board", 2, 500, 8, at_start));
  g_object_class_install_property (object_class, PROP_ROWS,
      g_param_spec_int ("rows", "Rows",
          "Number of squares in a column of the board", 2, 500, 8, at_start));
  g_object_class_install_property (object_class, PROP_FIRST_BLACK,
      g_param_spec_boolean ("first-black", "First square black",
          "Whether the square at the top left of the board is black", TRUE,
          at_start));
  g_object_class_install_property (object_class, PROP_SEED,
      g_param_spec_string ("seed", "Seed",
          "Corners of one square in the first picture, x0,y0,x1,y1,x2,y2,x3,y3 "
          "in pixels, and its column,row on the board if known", NULL,
          at_start));
  g_object_class_install_property (object_class, PROP_LINK,
      g_param_spec_boolean ("link", "Link",
          "Whether saddles are joined into pieces of the board in each picture, "
          "which needs no seed and recovers from total loss", standard.link,
          any_time));
  g_object_class_install_property (object_class, PROP_SQUARES,
      g_param_spec_enum ("squares", "Squares",
          "Colour of the squares that are tracked",
          GST_TYPE_QUAD_TRACK_SQUARES, (gint) standard.squares, any_time));
  g_object_class_install_property (object_class, PROP_ALPHA,
      g_param_spec_float ("alpha", "Alpha",
          "Width of the lapels that the template adds around a square, over the "
          "square's edge", 0.05f, 1.0f, standard.alpha, any_time));
  g_object_class_install_property (object_class, PROP_C_LOW,
      g_param_spec_float ("c-low", "Low confidence",
          "Confidence below which a square is given up", -1.0f, 1.0f,
          standard.c_low, any_time));
  g_object_class_install_property (object_class, PROP_C_HIGH,
      g_param_spec_float ("c-high", "High confidence",
          "Confidence at which the search for a better match stops and above "
          "which a neighbour counts for consistency", -1.0f, 1.0f,
          standard.c_high, any_time));
  g_object_class_install_property (object_class, PROP_C_PRED,
      g_param_spec_float ("c-pred", "Predicting confidence",
          "Confidence above which a square predicts its neighbours", -1.0f,
          1.0f, standard.c_pred, any_time));
  g_object_class_install_property (object_class, PROP_DAMPING,
      g_param_spec_float ("damping", "Damping",
          "Factor on the confidence of a square that extension has just added",
          0.0f, 1.0f, standard.damping, any_time));
  g_object_class_install_property (object_class, PROP_CONSISTENCY,
      g_param_spec_float ("consistency", "Consistency",
          "Distance up to which two squares agree on their common corner, over "
          "the larger square's size", 0.0f, 2.0f, standard.consistency,
          any_time));
  g_object_class_install_property (object_class, PROP_MAX_VARIANTS,
      g_param_spec_uint ("max-variants", "Most variants",
          "Number of corner triples tried at most for one square", 1, 512,
          standard.max_variants, any_time));

  gst_element_class_set_static_metadata (element_class, "Quad tracker",
      "Filter/Analyzer/Video",
      "Tracks the squares of a checkerboard on cloth",
      "The gst-cloth developers");
  trans_class->src_event = gst_quad_track_src_event;
  filter_class->start = gst_quad_track_start;
  filter_class->stop = gst_quad_track_stop;
  filter_class->reset = gst_quad_track_reset;
  filter_class->analyse = gst_quad_track_analyse;
  gst_type_mark_as_plugin_api (GST_TYPE_QUAD_TRACK_SQUARES, 0);
}

static void
gst_quad_track_init (GstQuadTrack * self)
{
  self->columns = self->rows = 8;
  self->first_black = TRUE;
  self->params = cloth_quad_default_params ();
  self->clicks = g_array_new (FALSE, FALSE, sizeof (gfloat));
  self->seeds = g_array_new (FALSE, FALSE, sizeof (gfloat));
  self->taken_seeds = g_array_new (FALSE, FALSE, sizeof (gfloat));
  self->saddles = g_array_new (FALSE, FALSE, sizeof (GstClothSaddle));
  self->candidates = g_array_new (FALSE, FALSE, sizeof (GstClothCandidate));
  self->quads = g_array_new (FALSE, FALSE, sizeof (GstClothQuad));
}
