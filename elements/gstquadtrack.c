/* quadtrack: the squares of a checkerboard, tracked through a film.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstquadtrack.h"

#include <gst/cloth/cloth.h>
#include <gst/video/navigation.h>
#include <math.h>

#include "elements/gstclothproperties.h"
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
 * `sequence`, `timestamp` (PTS, ns) and `squares`, the number of those tracked. At the end a warning says
 * so when none were in most of the pictures that show a board: another `pattern` than was filmed.
 *
 * ## Example
 * ```
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! saddledetect !
 *     quadtrack columns=8 rows=8 ! clothoverlay ! videoconvert ! autovideosink
 * ```
 */
/* So many corners are a piece of a board, and no clutter: the least whose place a code tells. */
#define MIN_CORNERS 16

/* A square given by hand: its corners, px, and which one of the board it is, -1 where that
 * is not told. */
typedef struct
{
  gfloat x[4], y[4];
  gint column, row;
} Seed;

typedef struct
{
  gchar *pattern, *seed;
  gint columns, rows;
  gboolean first_black;
  ClothQuadParams params;
} Settings;

struct _GstQuadTrack
{
  GstClothFilter parent;

  /* with the object lock */
  Settings settings;
  Seed clicked;                 /* corners so far */
  guint n_clicks;
  GArray *seeds;                /* Seed, for the next picture */

  /* streaming thread */
  ClothPattern *pattern;
  ClothQuadTracker *tracker;
  ClothSaddleDetector *detector;
  GArray *taken_seeds;          /* Seed, of this picture */
  GArray *saddles;              /* GstClothSaddle */
  GArray *candidates;           /* GstClothCandidate */
  GArray *quads;                /* GstClothQuad */
  gboolean found;
  guint n_pictures, n_with_squares;     /* that have corners; of them those tracked */
  gboolean warned_of_start, warned_of_seed;
  Seed first_seed;              /* of the property */
  gboolean has_first_seed, knows_first, was_reset;
  guint64 first_sequence;       /* of the picture that the property is about */
};

static const GEnumValue squares_values[] = {
  {CLOTH_SQUARES_BLACK, "Black squares", "black"},
  {CLOTH_SQUARES_WHITE, "White squares", "white"},
  {CLOTH_SQUARES_BOTH, "Squares of both colours", "both"},
  {0, NULL, NULL}
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)
#define ANY_TIME (GST_PARAM_MUTABLE_PLAYING | GST_PARAM_CONTROLLABLE)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"pattern", "Pattern",
    "File pattern.json of the board; without it columns, rows and "
    "first-black tell what the board is",
    G_TYPE_STRING, SETTING (pattern), GST_PARAM_MUTABLE_READY},
  {"columns", "Columns", "Number of squares in a row of the board",
    G_TYPE_INT, SETTING (columns), GST_PARAM_MUTABLE_READY, 2, 500},
  {"rows", "Rows", "Number of squares in a column of the board",
    G_TYPE_INT, SETTING (rows), GST_PARAM_MUTABLE_READY, 2, 500},
  {"first-black", "First square black",
    "Whether the square at the top left of the board is black",
    G_TYPE_BOOLEAN, SETTING (first_black), GST_PARAM_MUTABLE_READY},
  {"seed", "Seed",
    "Corners of one square in the first picture, x0,y0,x1,y1,x2,y2,x3,y3 "
    "in pixels, and its column,row on the board if known",
    G_TYPE_STRING, SETTING (seed), GST_PARAM_MUTABLE_READY},
  {"link", "Link",
    "Whether saddles are joined into pieces of the board in each picture, "
    "which needs no seed and recovers from total loss",
    G_TYPE_BOOLEAN, SETTING (params.link), ANY_TIME},
  {"squares", "Squares", "Colour of the squares that are tracked",
    G_TYPE_ENUM, SETTING (params.squares), ANY_TIME, 0, 0,
    "GstQuadTrackSquares", squares_values},
  {"alpha", "Alpha",
    "Width of the lapels that the template adds around a square, over the "
    "square's edge",
    G_TYPE_FLOAT, SETTING (params.alpha), ANY_TIME, 0.05, 1},
  {"c-low", "Low confidence", "Confidence below which a square is given up",
    G_TYPE_FLOAT, SETTING (params.c_low), ANY_TIME, -1, 1},
  {"c-high", "High confidence",
    "Confidence at which the search for a better match stops and above "
    "which a neighbour counts for consistency",
    G_TYPE_FLOAT, SETTING (params.c_high), ANY_TIME, -1, 1},
  {"c-pred", "Predicting confidence",
    "Confidence above which a square predicts its neighbours",
    G_TYPE_FLOAT, SETTING (params.c_pred), ANY_TIME, -1, 1},
  {"damping", "Damping",
    "Factor on the confidence of a square that extension has just added",
    G_TYPE_FLOAT, SETTING (params.damping), ANY_TIME, 0, 1},
  {"consistency", "Consistency",
    "Distance up to which two squares agree on their common corner, over "
    "the larger square's size",
    G_TYPE_FLOAT, SETTING (params.consistency), ANY_TIME, 0, 2},
  {"max-variants", "Most variants",
    "Number of corner triples tried at most for one square",
    G_TYPE_UINT, SETTING (params.max_variants), ANY_TIME, 1, 512},
};
/* *INDENT-ON* */

G_DEFINE_TYPE (GstQuadTrack, gst_quad_track, GST_TYPE_CLOTH_FILTER);

GST_ELEMENT_REGISTER_DEFINE (quadtrack, "quadtrack", GST_RANK_NONE,
    GST_TYPE_QUAD_TRACK);

G_STATIC_ASSERT (sizeof (GstClothSaddle) == sizeof (ClothSaddle));
G_STATIC_ASSERT (sizeof (GstClothCandidate) == sizeof (ClothSaddleCandidate));
G_STATIC_ASSERT ((gint) GST_CLOTH_QUAD_TRACKED == (gint) CLOTH_QUAD_TRACKED);
G_STATIC_ASSERT ((gint) GST_CLOTH_QUAD_LOST == (gint) CLOTH_QUAD_LOST);

/* Reads "x0,y0,…,y3" or "x0,y0,…,y3,column,row". */
static gboolean
parse_seed (const gchar * text, Seed * seed)
{
  g_auto (GStrv) parts = g_strsplit (text, ",", 11);
  gdouble values[10];
  guint n = g_strv_length (parts);

  if (n != 8 && n != 10)
    return FALSE;
  values[8] = values[9] = -1;
  for (guint k = 0; k < n; k++) {
    gchar *end;

    values[k] = g_ascii_strtod (g_strstrip (parts[k]), &end);
    if (end == parts[k] || *end || !isfinite (values[k])
        || fabs (values[k]) > 1e6
        || (k >= 8 && (values[k] < 0 || values[k] != floor (values[k]))))
      return FALSE;
  }
  for (guint c = 0; c < 4; c++) {
    seed->x[c] = (gfloat) values[2 * c];
    seed->y[c] = (gfloat) values[2 * c + 1];
  }
  seed->column = (gint) values[8];
  seed->row = (gint) values[9];
  return TRUE;
}

/* Warns, once, when nothing can be found without a seed and there is none. */
static void
check_start (GstQuadTrack * self, const ClothQuadParams * params, guint n_seeds)
{
  if (self->warned_of_start)
    return;
  if (params->link) {
    if (MIN (self->pattern->columns, self->pattern->rows) > 2)
      return;
    self->warned_of_start = TRUE;
    GST_ELEMENT_WARNING (self, RESOURCE, SETTINGS,
        ("A board of %d×%d squares is too narrow to be found by itself.",
            self->pattern->columns, self->pattern->rows),
        ("Set link=false and give a square by \"seed\" or by clicks, or use a "
            "board of three or more squares each way"));
    return;
  }
  self->warned_of_start = TRUE;
  if (!n_seeds)
    GST_ELEMENT_WARNING (self, RESOURCE, SETTINGS,
        ("With link=false nothing is tracked until a square is given."),
        ("Set \"seed\", click the four corners of a square in the video "
            "window, or set \"link\" to true"));
}

/* Warns, once, when the square that a seed is said to be can't be tracked. */
static void
check_seed (GstQuadTrack * self, const ClothQuadParams * params,
    const Seed * seed)
{
  const ClothPattern *pattern = self->pattern;
  const gint column = seed->column, row = seed->row;

  if (self->warned_of_seed || column < 0 || row < 0)
    return;
  if (column >= pattern->columns || row >= pattern->rows) {
    self->warned_of_seed = TRUE;
    GST_ELEMENT_WARNING (self, RESOURCE, SETTINGS,
        ("The seed's square %d,%d is not on the board of %d×%d squares, so the "
            "seed is of no use.", column, row, pattern->columns, pattern->rows),
        ("End \"seed\" by the square's column,row, counted from 0, or leave "
            "both out"));
  } else if (!params->link && params->squares != CLOTH_SQUARES_BOTH
      && cloth_pattern_is_black (pattern, column, row)
      != (params->squares == CLOTH_SQUARES_BLACK)) {
    self->warned_of_seed = TRUE;
    GST_ELEMENT_WARNING (self, RESOURCE, SETTINGS,
        ("The seed's square %d,%d is of the colour that is not tracked, so "
            "nothing starts from it.", column, row),
        ("Give a square of the other colour, or set \"squares\" to both"));
  }
}

/* Warns, once, when no square has started from the seeds of this picture. */
static void
check_tracked (GstQuadTrack * self, const ClothQuadParams * params,
    guint n_tracked)
{
  if (self->warned_of_seed || params->link || !self->taken_seeds->len
      || n_tracked)
    return;
  self->warned_of_seed = TRUE;
  GST_ELEMENT_WARNING (self, RESOURCE, SETTINGS,
      ("No square is seen where one was given, so nothing starts from it."),
      ("Give the corners of a sharp square, 8 pixels or wider, to within half of "
          "its width, and if its column,row is told, from the corner that is its "
          "top-left one on the flat board; or set \"link\" to true"));
}

/* What was clicked into earlier pictures is of them. */
static void
forget_clicks (GstQuadTrack * self)
{
  GST_OBJECT_LOCK (self);
  self->n_clicks = 0;
  g_array_set_size (self->seeds, 0);
  GST_OBJECT_UNLOCK (self);
}

static gboolean
gst_quad_track_start (GstClothFilter * filter)
{
  GstQuadTrack *self = GST_QUAD_TRACK (filter);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL, *seed = NULL;
  gint columns, rows;
  gboolean first_black;

  GST_OBJECT_LOCK (self);
  path = g_strdup (self->settings.pattern);
  seed = g_strdup (self->settings.seed);
  columns = self->settings.columns;
  rows = self->settings.rows;
  first_black = self->settings.first_black;
  GST_OBJECT_UNLOCK (self);

  self->has_first_seed = seed != NULL;
  self->knows_first = FALSE;
  self->was_reset = TRUE;
  if (seed && !parse_seed (seed, &self->first_seed)) {
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
  self->n_pictures = self->n_with_squares = 0;
  self->warned_of_start = self->warned_of_seed = FALSE;
  return TRUE;
}

static void
gst_quad_track_stop (GstClothFilter * filter)
{
  GstQuadTrack *self = GST_QUAD_TRACK (filter);

  g_clear_pointer (&self->tracker, cloth_quad_tracker_free);
  g_clear_pointer (&self->pattern, cloth_pattern_free);
  g_clear_pointer (&self->detector, cloth_saddle_detector_free);
  forget_clicks (self);
}

static void
gst_quad_track_reset (GstClothFilter * filter)
{
  GstQuadTrack *self = GST_QUAD_TRACK (filter);

  if (!self->tracker)
    return;
  cloth_quad_tracker_reset (self->tracker);
  self->n_pictures = self->n_with_squares = 0;
  self->was_reset = TRUE;
  forget_clicks (self);
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

/* The seeds of this picture are from now on in taken_seeds: with the lock held no message
 * may be posted. Returns the parameters of this picture. */
static ClothQuadParams
take_seeds (GstQuadTrack * self, guint64 sequence)
{
  ClothQuadParams params;
  GArray *seeds;

  if (!self->knows_first)
    self->first_sequence = sequence;
  self->knows_first = TRUE;
  GST_OBJECT_LOCK (self);
  params = self->settings.params;
  /* again after a seek back to it, not elsewhere: there it would be wrong */
  if (self->has_first_seed && self->was_reset
      && sequence == self->first_sequence)
    g_array_append_val (self->seeds, self->first_seed);
  self->was_reset = FALSE;
  seeds = self->seeds;
  self->seeds = self->taken_seeds;
  self->taken_seeds = seeds;
  g_array_set_size (self->seeds, 0);
  GST_OBJECT_UNLOCK (self);
  return params;
}

/* Returns how many of the squares are tracked. */
static guint
attach_quads (GstQuadTrack * self, const GstClothFilterFrame * frame,
    const ClothQuad * quads, guint n)
{
  guint n_tracked = 0;

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
    n_tracked += quads[k].state == CLOTH_QUAD_TRACKED;
  }
  gst_buffer_add_cloth_quads_meta (frame->buffer,
      gst_cloth_quads_new (frame->camera, frame->sequence,
          (guint) self->pattern->columns, (guint) self->pattern->rows,
          (const GstClothQuad *) self->quads->data, n));
  return n_tracked;
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
  guint n_saddles, n_candidates, n, n_tracked;

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

  params = take_seeds (self, frame->sequence);
  check_start (self, &params, self->taken_seeds->len);
  for (guint s = 0; s < self->taken_seeds->len; s++) {
    const Seed *seed = &g_array_index (self->taken_seeds, Seed, s);

    check_seed (self, &params, seed);
    cloth_quad_tracker_seed (self->tracker, seed->x, seed->y, seed->column,
        seed->row);
  }
  quads = cloth_quad_tracker_run (self->tracker, &params, &frame->luma,
      saddles, n_saddles, candidates, n_candidates, &n);
  n_tracked = attach_quads (self, frame, quads,
      MIN (n, GST_CLOTH_MAX_FEATURES));
  check_tracked (self, &params, n_tracked);
  gst_quad_track_tell (self, frame, n_tracked);
  if (n_saddles >= MIN_CORNERS) {
    self->n_pictures++;
    self->n_with_squares += n_tracked > 0;
  }
  GST_LOG_OBJECT (self, "%u saddles, %u squares tracked", n_saddles, n_tracked);
  return GST_FLOW_OK;
}

/* The film has ended: says so when in most pictures corners were seen that are not the board's. */
static void
tell_of_pattern (GstQuadTrack * self)
{
  /* who was told that nothing can start knows why */
  if (self->warned_of_start || self->warned_of_seed
      || 2 * self->n_with_squares >= self->n_pictures)
    return;
  GST_ELEMENT_WARNING_WITH_DETAILS (self, STREAM, FAILED,
      ("Squares were tracked in %u of the %u pictures that show %d corners or "
          "more.", self->n_with_squares, self->n_pictures, MIN_CORNERS),
      ("See that pattern is the file of the board that is filmed, and that its "
          "squares are large enough: eight pixels or more."),
      ("pictures", G_TYPE_UINT, self->n_pictures, "tracked", G_TYPE_UINT,
          self->n_with_squares, NULL));
}

static gboolean
gst_quad_track_sink_event (GstBaseTransform * trans, GstEvent * event)
{
  if (GST_EVENT_TYPE (event) == GST_EVENT_EOS)
    tell_of_pattern (GST_QUAD_TRACK (trans));
  return GST_BASE_TRANSFORM_CLASS (gst_quad_track_parent_class)->sink_event
      (trans, event);
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
      self->clicked.x[self->n_clicks] = (gfloat) x;
      self->clicked.y[self->n_clicks] = (gfloat) y;
      if (++self->n_clicks == 4) {
        self->clicked.column = self->clicked.row = -1;
        g_array_append_val (self->seeds, self->clicked);
        self->n_clicks = 0;
      }
    } else {
      self->n_clicks = 0;
    }
    GST_OBJECT_UNLOCK (self);
  }
  return GST_BASE_TRANSFORM_CLASS (gst_quad_track_parent_class)->src_event
      (trans, event);
}

static Settings
default_settings (void)
{
  const Settings defaults = { NULL, NULL, 8, 8, TRUE,
    cloth_quad_default_params ()
  };

  return defaults;
}

static void
gst_quad_track_finalize (GObject * object)
{
  GstQuadTrack *self = GST_QUAD_TRACK (object);

  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
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
  const Settings defaults = default_settings ();

  GST_DEBUG_CATEGORY_INIT (quad_track_debug, "quadtrack", 0,
      "tracking of checkerboard squares");
  object_class->finalize = gst_quad_track_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      G_STRUCT_OFFSET (GstQuadTrack, settings));
  gst_element_class_set_static_metadata (element_class, "Quad tracker",
      "Filter/Analyzer/Video",
      "Tracks the squares of a checkerboard on cloth",
      "The gst-cloth developers");
  trans_class->sink_event = gst_quad_track_sink_event;
  trans_class->src_event = gst_quad_track_src_event;
  filter_class->start = gst_quad_track_start;
  filter_class->stop = gst_quad_track_stop;
  filter_class->reset = gst_quad_track_reset;
  filter_class->analyse = gst_quad_track_analyse;
}

static void
gst_quad_track_init (GstQuadTrack * self)
{
  self->settings = default_settings ();
  self->seeds = g_array_new (FALSE, FALSE, sizeof (Seed));
  self->taken_seeds = g_array_new (FALSE, FALSE, sizeof (Seed));
  self->saddles = g_array_new (FALSE, FALSE, sizeof (GstClothSaddle));
  self->candidates = g_array_new (FALSE, FALSE, sizeof (GstClothCandidate));
  self->quads = g_array_new (FALSE, FALSE, sizeof (GstClothQuad));
}
