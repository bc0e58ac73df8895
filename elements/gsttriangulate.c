/* triangulate: N cameras' observations become a mesh in space.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-triangulate
 * @title: triangulate
 *
 * Joins the pictures of a rig's cameras by time and triangulates the corners of the
 * squares that they carry as #GstClothQuads, the dots of #GstClothDots, or the points of any
 * print's grid of #GstClothMatches. Each frame of the mesh has a vertex for every corner of
 * the board, every dot of the array, or every vertex of the print's grid: its place, its 3×3
 * covariance, and whether three or more views agree on it, only two saw it, or it is
 * unseen. A vertex seen by one camera, or contradicted, is unseen; nothing is
 * carried over from earlier frames. Clocks that the rig knows to differ (`offset_s`) are
 * known once the pictures of a camera say whose they are: of one whose first picture doesn't, the pictures
 * that do make no mesh.
 *
 * Each mesh carries what its cameras saw, as a #GstClothView of each: `clothgap` and `clothfit` see
 * by it what one camera alone saw.
 *
 * The mesh's frame rate is the cameras'. While they differ it is the last one that was
 * sent, so that a camera joining late doesn't change it in mid-stream; 0/1, variable, when
 * they differ from the start. Frames come with the times of their pictures all the same.
 *
 * A damaged packet of observations counts as a camera that saw nothing. It is counted in
 * `dropped`; the first gives a warning, the end of the stream an info message with their
 * number. With `strict`, for files, the first is an error.
 *
 * A sink pad is given its camera of `rig` by its own property `camera`, else by the name
 * that the metadata carries, else by the order of the pads.
 *
 * ## A mesh from two films
 * |[
 * gst-launch-1.0 triangulate name=t rig=rig.json pattern=pattern.json \
 *     sink_0::camera=cam0 sink_1::camera=cam1 ! meshsink location=cloth.obj \
 *     filesrc location=cam0.mp4 ! decodebin ! saddledetect ! quadtrack ! t.sink_0 \
 *     filesrc location=cam1.mp4 ! decodebin ! saddledetect ! quadtrack ! t.sink_1
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulate.h"

#include <gst/cloth/cloth.h>
#include <math.h>

#include "elements/gstclothdamage.h"
#include "elements/gstclothproperties.h"
#include "elements/gsttriangulateboard.h"
#include "elements/gsttriangulatepad.h"
#include "gst/math/statistics.h"
#include "gst/rig/merge.h"
#include "gst/rig/reconstruct.h"
#include "gst/rig/rigfile.h"

GST_DEBUG_CATEGORY_STATIC (triangulate_debug);
#define GST_CAT_DEFAULT triangulate_debug

#define MAX_THREADS 1024
/* Every so many sets it is looked whether the cameras fit together. */
#define CHECKED_SETS 25
/* A film of fewer sets is judged at its end, by no fewer vertices than this. */
#define CHECKED_VERTICES 20
#define CONTRADICTION_HINT \
    "See that each pad has its own camera, that the films start together (a camera " \
    "whose clock is another needs offset_s in rig), that pattern is that of the " \
    "cloth that is filmed, and that the cameras stand as when rig was made; else " \
    "calibrate again, or raise error-floor."
#define SINK_CAPS "video/x-raw(ANY), width=(int)[ 1, 16384 ], " \
    "height=(int)[ 1, 16384 ]; " GST_CLOTH_OBSERVATIONS_CAPS

/* A vertex has the state of its point. */
G_STATIC_ASSERT ((gint) CLOTH_POINT_UNSEEN == GST_CLOTH_VERTEX_UNSEEN);
G_STATIC_ASSERT ((gint) CLOTH_POINT_MEASURED == GST_CLOTH_VERTEX_MEASURED);
G_STATIC_ASSERT ((gint) CLOTH_POINT_TWO_VIEWS == GST_CLOTH_VERTEX_TWO_VIEWS);

/* Whether the cameras fit together, over some sets; all 0 at the start. */
typedef struct
{
  guint n_sets;
  gboolean warned;
  gboolean seen[CLOTH_RIG_MAX_CAMERAS];
  guint64 n_compared[CLOTH_RIG_MAX_CAMERAS];
  guint64 n_left_out[CLOTH_RIG_MAX_CAMERAS];
  gdouble stretches[CHECKED_SETS];      /* of the first sets that show neighbours */
  guint n_stretches;
} Check;

typedef struct
{
  gchar *rig, *pattern;
  ClothReconstructionParameters parameters;
  guint threads;
  gboolean allow_one_camera;
  GstClothDamage damage;
} Settings;

struct _GstTriangulate
{
  GstClothSync parent;

  /* object lock */
  Settings settings;
  gboolean rig_changed, pattern_changed;

  /* streaming thread */
  ClothRig *rig;
  GstTriangulateBoard *board;
  gint fps_n, fps_d;            /* as sent downstream; fps_n -1: not yet */
  ClothPool *pool;
  ClothReconstruction *reconstruction;
  gdouble threshold;            /* in force */
  ClothMerge *merge[CLOTH_RIG_MAX_CAMERAS];
  GstTriangulateView view[GST_CLOTH_SYNC_MAX_PADS];
  guint64 sequence;
  gboolean had_others;          /* more than one camera has been linked */
  gboolean rates_told;          /* that the cameras' rates differ */
  Check check;
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"rig", "Rig",
    "File rig.json with the calibrated cameras; a new one counts from the "
    "next set on",
    G_TYPE_STRING, SETTING (rig), GST_PARAM_MUTABLE_PLAYING},
  {"pattern", "Pattern",
    "File pattern.json of what is filmed: the mesh has a vertex for each corner "
    "of a checkerboard's squares, for each dot of an M-array, or for each vertex "
    "of the grid on any print",
    G_TYPE_STRING, SETTING (pattern), GST_PARAM_MUTABLE_PLAYING},
  {"threshold", "Threshold",
    "A view is left out when it is further from what the others say than "
    "this many standard deviations",
    G_TYPE_DOUBLE, SETTING (parameters.triangulate.threshold),
    GST_PARAM_MUTABLE_PLAYING, 0.1, G_MAXDOUBLE},
  {"max-error", "Maximum error",
    "A view is left out when its reprojection error is larger than this, in "
    "px, whatever its covariance says; 0: no such limit",
    G_TYPE_DOUBLE, SETTING (parameters.triangulate.max_error),
    GST_PARAM_MUTABLE_PLAYING, 0, G_MAXDOUBLE},
  {"error-floor", "Error floor",
    "Variance in px² added to every observation's own, which knows of the "
    "picture's noise only: what calibration, lens model and compression "
    "leave; -1: what the film's own residuals tell where three cameras see a "
    "point, 0.01 until they do",
    G_TYPE_DOUBLE, SETTING (parameters.triangulate.error_floor),
    GST_PARAM_MUTABLE_PLAYING, -1, 1e6},
  {"huber", "Huber",
    "While looking for the view to leave out, errors beyond this many "
    "standard deviations weigh less",
    G_TYPE_DOUBLE, SETTING (parameters.triangulate.huber),
    GST_PARAM_MUTABLE_PLAYING, 0.1, G_MAXDOUBLE},
  {"min-length", "Least length",
    "Vertices are dropped that are nearer to their neighbours in space than "
    "this share of their distance on the flat cloth; 0: no such limit",
    G_TYPE_DOUBLE, SETTING (parameters.shortest),
    GST_PARAM_MUTABLE_PLAYING, 0, 1},
  {"max-length", "Largest length",
    "Vertices are dropped that are farther from their neighbours in space "
    "than this share of their distance on the flat cloth, more for cloth "
    "that stretches; 0: no such limit",
    G_TYPE_DOUBLE, SETTING (parameters.longest),
    GST_PARAM_MUTABLE_PLAYING, 0, 10},
  {"threads", "Threads",
    "Threads that triangulate; 0: as many as there are processors. The "
    "result is the same",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_PLAYING, 0, MAX_THREADS},
  {"allow-one-camera", "Allow one camera",
    "Go on while a single camera is linked, which sees no vertex in space; else "
    "that is an error, unless others were linked before",
    G_TYPE_BOOLEAN, SETTING (allow_one_camera), GST_PARAM_MUTABLE_PLAYING},
  GST_CLOTH_DAMAGE_PROPERTIES (Settings, damage),
};
/* *INDENT-ON* */

static const Settings defaults = {
  .parameters = CLOTH_RECONSTRUCTION_PARAMETERS_DEFAULT
};

G_DEFINE_TYPE_WITH_CODE (GstTriangulate, gst_triangulate, GST_TYPE_CLOTH_SYNC,
    G_IMPLEMENT_INTERFACE (GST_TYPE_CHILD_PROXY,
        gst_triangulate_pad_child_proxy_init)
    GST_DEBUG_CATEGORY_INIT (triangulate_debug, "triangulate", 0,
        "points in space from several cameras"));
GST_ELEMENT_REGISTER_DEFINE (triangulate, "triangulate", GST_RANK_NONE,
    GST_TYPE_TRIANGULATE);

static GstStaticPadTemplate sink_template =
GST_STATIC_PAD_TEMPLATE ("sink_%u", GST_PAD_SINK, GST_PAD_REQUEST,
    GST_STATIC_CAPS (SINK_CAPS));
static GstStaticPadTemplate src_template =
GST_STATIC_PAD_TEMPLATE ("src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

/* ---- whether the cameras fit together ---- */

/* Two cameras that see the same to the last bit are one film, given twice. */
static void
check_same_film (Check * check, GstElement * element,
    const GstTriangulateBoard * board, const ClothRig * rig,
    const ClothTriangulateView * views)
{
  const guint n = board->grid.columns * board->grid.rows;

  for (guint c = 1; c < rig->n_cameras; c++) {
    for (guint other = 0; other < c && views[c].x; other++) {
      guint n_seen = 0, n_same = 0;

      for (guint i = 0; i < n && views[other].x; i++) {
        n_seen += isfinite (views[c].x[i]);
        n_same += views[c].x[i] == views[other].x[i]
            && views[c].y[i] == views[other].y[i];
      }
      if (n_same < CHECKED_VERTICES || n_same < n_seen) {
        continue;
      }
      check->warned = TRUE;
      GST_ELEMENT_WARNING_WITH_DETAILS (element, STREAM, FAILED,
          ("Cameras \"%s\" and \"%s\" show the very same picture.",
              rig->cameras[other].name, rig->cameras[c].name),
          ("Give each pad the film of its own camera."),
          ("camera", G_TYPE_STRING, rig->cameras[c].name, NULL));
      return;
    }
  }
}

static void
check_count (Check * check, const ClothRig * rig,
    const ClothTriangulateView * views, const ClothReconstructed * result)
{
  for (guint c = 0; c < rig->n_cameras; c++) {
    check->seen[c] |= views[c].x != NULL;
    check->n_compared[c] += result->n_compared[c];
    check->n_left_out[c] += result->n_left_out[c];
  }
}

/* Posts, once, a warning if fewer than two cameras have carried any yet, or if a camera
 * contradicts the others on more than half of what it sees; the message's details name it as
 * "camera". Of two nobody knows which is wrong. */
static void
check_judge (Check * check, GstElement * element,
    const GstTriangulateBoard * board, const ClothRig * rig)
{
  guint c, worst = 0, n_seeing = 0;
  const gchar *seeing = NULL, *others = NULL;
  gdouble share = 0.;

  for (c = 0; c < rig->n_cameras; c++) {
    if (check->seen[c]) {
      others = seeing;
      seeing = rig->cameras[c].name;
      n_seeing++;
    }
  }
  if (n_seeing == 1) {
    check->warned = TRUE;
    GST_ELEMENT_WARNING (element, STREAM, FAILED,
        ("Only camera \"%s\" carries %s so far, so every vertex is unseen.",
            seeing, board->features),
        ("Link two or more cameras, each with %s before its sink pad.",
            board->detector));
    return;
  }
  if (n_seeing == 0) {
    check->warned = TRUE;
    GST_ELEMENT_WARNING (element, STREAM, FAILED,
        ("No picture so far carries %s, so every vertex is unseen.",
            board->features),
        ("Put %s before each sink pad, and nothing that drops metadata between "
            "them and it.", board->detector));
    return;
  }
  for (c = 0; c < rig->n_cameras; c++) {
    gdouble s = (gdouble) check->n_left_out[c] /
        (gdouble) MAX (check->n_compared[c], CHECKED_VERTICES);

    if (s > share) {
      share = s;
      worst = c;
    }
    check->n_compared[c] = check->n_left_out[c] = 0;
  }
  if (share <= 0.5) {
    return;
  }
  check->warned = TRUE;
  if (n_seeing == 2) {
    GST_ELEMENT_WARNING (element, STREAM, FAILED,
        ("Cameras \"%s\" and \"%s\" contradict each other on %.0f%% of the %s "
            "that both see.", others, seeing, 100. * share, board->features),
        (CONTRADICTION_HINT));
  } else {
    GST_ELEMENT_WARNING_WITH_DETAILS (element, STREAM, FAILED,
        ("Camera \"%s\" contradicts the others on %.0f%% of the %s it sees.",
            rig->cameras[worst].name, 100. * share, board->features),
        (CONTRADICTION_HINT), ("camera", G_TYPE_STRING,
            rig->cameras[worst].name, NULL));
  }
}

/* Posts a warning if so many neighbours are too far apart that cameras and print must be of
 * different sizes. */
static void
check_size (Check * check, GstElement * element,
    const ClothReconstruction * reconstruction)
{
  const gdouble stretch = cloth_median (check->stretches, check->n_stretches);

  if (isnan (stretch) || cloth_reconstruction_allows (reconstruction, stretch)) {
    return;
  }
  check->warned = TRUE;
  GST_ELEMENT_WARNING (element, STREAM, FAILED,
      ("Neighbours are %.3g times as far apart as on the flat cloth, in the "
          "median, so their vertices are dropped.", stretch),
      ("See that t in rig is in metres, that the size in pattern is what a ruler "
          "says of the print, in metres, and that the films start together; else "
          "set min-length and max-length to what this cloth does."));
}

static void
check_all (Check * check, GstElement * element,
    const GstTriangulateBoard * board, const ClothRig * rig,
    const ClothReconstruction * reconstruction)
{
  check_judge (check, element, board, rig);
  if (!check->warned) {
    check_size (check, element, reconstruction);
  }
}

/* Counts one set and judges every 25th time. */
static void
check_add (Check * check, GstElement * element,
    const GstTriangulateBoard * board, const ClothRig * rig,
    const ClothReconstruction * reconstruction,
    const ClothTriangulateView * views, const ClothReconstructed * result)
{
  if (check->warned) {
    return;
  }
  check_same_film (check, element, board, rig, views);
  check_count (check, rig, views, result);
  if (check->n_stretches < CHECKED_SETS) {
    const gdouble stretch = cloth_reconstruction_get_stretch (reconstruction);

    if (isfinite (stretch)) {
      check->stretches[check->n_stretches++] = stretch;
    }
  }
  if (++check->n_sets % CHECKED_SETS == 0 && !check->warned) {
    check_all (check, element, board, rig, reconstruction);
  }
}

/* At the end: a film that is too short to be judged before. */
static void
check_end (Check * check, GstElement * element,
    const GstTriangulateBoard * board, const ClothRig * rig,
    const ClothReconstruction * reconstruction)
{
  if (check->n_sets > 0 && check->n_sets < CHECKED_SETS && !check->warned) {
    check_all (check, element, board, rig, reconstruction);
  }
}

/* ---- rig, pattern and parameters ---- */

static void
gst_triangulate_clear_merges (GstTriangulate * self)
{
  guint i;

  for (i = 0; i < CLOTH_RIG_MAX_CAMERAS; i++) {
    g_clear_pointer (&self->merge[i], cloth_merge_free);
  }
}

static gboolean
gst_triangulate_load_rig (GstTriangulate * self)
{
  g_autofree gchar *location = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = NULL;
  ClothReconstruction *reconstruction;

  GST_OBJECT_LOCK (self);
  location = g_strdup (self->settings.rig);
  self->rig_changed = FALSE;
  GST_OBJECT_UNLOCK (self);

  if (!location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("No cameras are known: the property rig is not set."),
        ("Set rig to the rig.json that gst-cloth-calibrate-1.0 has written."));
    return FALSE;
  }
  rig = cloth_rig_load (location, &error);
  if (!rig) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("The cameras could not be read: %s", error->message),
        ("Set rig to a rig.json; it is now \"%s\".", location));
    return FALSE;
  }
  reconstruction = cloth_reconstruction_new (rig, &error);
  if (!reconstruction) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("%s (%s).", error->message, location),
        ("Calibrate two or more cameras together into one rig.json."));
    return FALSE;
  }
  if (self->board) {
    cloth_reconstruction_set_grid (reconstruction, &self->board->grid);
  }
  cloth_reconstruction_free (self->reconstruction);
  self->reconstruction = reconstruction;
  cloth_rig_free (self->rig);
  self->rig = g_steal_pointer (&rig);
  return TRUE;
}

static gboolean
gst_triangulate_load_pattern (GstTriangulate * self)
{
  g_autofree gchar *location = NULL;
  g_autoptr (GError) error = NULL;
  GstTriangulateBoard *board;

  GST_OBJECT_LOCK (self);
  location = g_strdup (self->settings.pattern);
  self->pattern_changed = FALSE;
  GST_OBJECT_UNLOCK (self);

  if (!location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("What is filmed is not known: the property pattern is not set."),
        ("Set pattern to the pattern.json that gst-cloth-pattern-1.0 has "
            "written beside the print."));
    return FALSE;
  }
  board = gst_triangulate_board_load (location, &error);
  if (!board) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("The pattern could not be read: %s", error->message),
        ("Set pattern to a pattern.json; it is now \"%s\".", location));
    return FALSE;
  }
  gst_triangulate_board_free (self->board);
  self->board = board;
  gst_triangulate_clear_merges (self);
  cloth_reconstruction_set_grid (self->reconstruction, &board->grid);
  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    self->view[i].trusted = FALSE;
  }
  return TRUE;
}

static gboolean
gst_triangulate_apply_parameters (GstTriangulate * self)
{
  ClothReconstructionParameters parameters;
  gboolean rig_changed;
  guint threads;

  GST_OBJECT_LOCK (self);
  rig_changed = self->rig_changed;
  GST_OBJECT_UNLOCK (self);
  if ((rig_changed || !self->rig) && !gst_triangulate_load_rig (self)) {
    return FALSE;
  }
  GST_OBJECT_LOCK (self);
  parameters = self->settings.parameters;
  threads = self->settings.threads;
  GST_OBJECT_UNLOCK (self);
  self->threshold = parameters.triangulate.threshold;
  cloth_reconstruction_set_parameters (self->reconstruction, &parameters);
  if (threads == 0) {
    threads = MIN (g_get_num_processors (), MAX_THREADS);
  }
  if (threads != cloth_pool_get_n_threads (self->pool) || !self->pool) {
    cloth_pool_free (self->pool);
    self->pool = cloth_pool_new (threads);
  }
  cloth_reconstruction_set_pool (self->reconstruction, self->pool);
  return TRUE;
}

static void
gst_triangulate_forget (GstTriangulate * self)
{
  guint i;

  g_clear_pointer (&self->reconstruction, cloth_reconstruction_free);
  g_clear_pointer (&self->rig, cloth_rig_free);
  g_clear_pointer (&self->board, gst_triangulate_board_free);
  g_clear_pointer (&self->pool, cloth_pool_free);
  gst_triangulate_clear_merges (self);
  self->fps_n = -1;
  self->had_others = self->rates_told = FALSE;
  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    gst_triangulate_view_forget (&self->view[i]);
  }
}

static gboolean
gst_triangulate_start (GstAggregator * agg)
{
  GstTriangulate *self = GST_TRIANGULATE (agg);

  gst_cloth_damage_reset (&self->settings.damage, GST_ELEMENT (self));
  if (GST_AGGREGATOR_CLASS (gst_triangulate_parent_class)->start (agg)
      && gst_triangulate_load_rig (self) && gst_triangulate_load_pattern (self)) {
    return TRUE;
  }
  /* stop is not called then */
  gst_triangulate_forget (self);
  return FALSE;
}

static gboolean
gst_triangulate_stop (GstAggregator * agg)
{
  gst_triangulate_forget (GST_TRIANGULATE (agg));
  return GST_AGGREGATOR_CLASS (gst_triangulate_parent_class)->stop (agg);
}

/* ---- GstClothSync ---- */

static gboolean
gst_triangulate_set_pad_caps (GstClothSync * sync, guint index, GstCaps * caps)
{
  return gst_triangulate_view_set_caps (&GST_TRIANGULATE (sync)->view[index],
      GST_ELEMENT (sync), index, caps);
}

static GstFlowReturn
gst_triangulate_negotiate_src (GstClothSync * sync, GstCaps * downstream,
    GstCaps ** caps)
{
  GstTriangulate *self = GST_TRIANGULATE (sync);
  gboolean changed;

  GST_OBJECT_LOCK (self);
  changed = self->pattern_changed;
  GST_OBJECT_UNLOCK (self);
  if ((changed || !self->board) && !gst_triangulate_load_pattern (self)) {
    return GST_FLOW_ERROR;
  }
  if (!gst_triangulate_views_rate (self->view, &self->fps_n, &self->fps_d)) {
    return GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  if (!self->rates_told) {
    self->rates_told = !gst_triangulate_views_check_rates (self->view,
        GST_ELEMENT (self));
  }
  *caps =
      gst_cloth_topology_to_caps (self->board->topology, self->fps_n,
      self->fps_d);
  return GST_FLOW_OK;
}

static GstFlowReturn
gst_triangulate_make_mesh (GstTriangulate * self,
    const ClothTriangulateView * views, GstBuffer ** out)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  const ClothReconstructed *result =
      cloth_reconstruction_run (self->reconstruction, views, &error);

  if (!result) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED, ("%s", error->message), (NULL));
    return GST_FLOW_ERROR;
  }
  check_add (&self->check, GST_ELEMENT (self), self->board, self->rig,
      self->reconstruction, views, result);
  mesh = gst_cloth_mesh_new (self->sequence, result->n_vertices,
      result->positions, result->states, result->covariances);
  *out = gst_cloth_mesh_to_buffer (mesh);
  GST_LOG_OBJECT (self, "frame %" G_GUINT64_FORMAT ": error floor %g px²",
      self->sequence, result->error_floor);
  return GST_FLOW_OK;
}

/* Whether a view carries anything, in its own or in unpacked metadata; not with @error: it is damaged. */
static gboolean
gst_triangulate_see (GstTriangulate * self, guint index, GstBuffer * view,
    GstBuffer ** unpacked, GstTriangulateSeen * seen, GError ** error)
{
  if (!self->view[index].observations) {
    return gst_triangulate_board_see (self->board, view, seen);
  }
  *unpacked = gst_buffer_new ();
  return gst_cloth_observations_unpack (view, *unpacked, error)
      && gst_triangulate_board_see (self->board, *unpacked, seen);
}

/* The same of a view that is joined. A damaged one is as good as none, and is not unpacked. */
static GstFlowReturn
gst_triangulate_look (GstTriangulate * self, guint index, GstBuffer * view,
    GstBuffer ** unpacked, GstTriangulateSeen * seen, gboolean * carries)
{
  g_autoptr (GError) error = NULL;

  *carries = gst_triangulate_see (self, index, view, unpacked, seen, &error);
  if (error) {
    gst_clear_buffer (unpacked);
    g_prefix_error (&error, "sink_%u: ", index);
    return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
        error);
  }
  if (!*carries || !self->view[index].trusted
      || (gst_triangulate_board_fits (self->board, seen)
          && (seen->camera[0] == '\0' || !self->view[index].meta
              || g_str_equal (seen->camera, self->view[index].meta))))
    return GST_FLOW_OK;
  /* those before it were right, so it is this one that isn't */
  *carries = FALSE;
  gst_clear_buffer (unpacked);
  g_set_error (&error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
      "sink_%u: it is of another camera or pattern than those before it",
      index);
  return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
      error);
}

/* One camera makes no vertex: FALSE after an element error. */
static gboolean
gst_triangulate_has_cameras (GstTriangulate * self)
{
  gboolean allowed;
  guint n_pads;

  GST_OBJECT_LOCK (self);
  n_pads = GST_ELEMENT (self)->numsinkpads;
  allowed = self->settings.allow_one_camera;
  GST_OBJECT_UNLOCK (self);
  self->had_others |= n_pads > 1;
  if (self->had_others || allowed) {
    return TRUE;
  }
  GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
      ("Only one camera is linked, and a place in space takes two."),
      ("Link another camera to sink_%%u, or set allow-one-camera=true when it "
          "comes later."));
  return FALSE;
}

static void
gst_triangulate_set_name (GstTriangulateView * view,
    const GstTriangulateSeen * seen)
{
  if (seen->camera[0] != '\0' && g_strcmp0 (seen->camera, view->meta) != 0) {
    g_free (view->meta);
    view->meta = g_strdup (seen->camera);
  }
}

/* Whose a pad's first picture is, before it is joined by its camera's clock; a gap doesn't say. Damage is told when it
 * is joined. */
static GstFlowReturn
gst_triangulate_look_ahead (GstClothSync * sync, GstBuffer ** heads, guint n)
{
  GstTriangulate *self = GST_TRIANGULATE (sync);
  gboolean moved, is_new = FALSE;

  if (!self->rig || !self->board) {
    return GST_FLOW_OK;
  }
  for (guint i = 0; i < n; i++) {
    GstTriangulateView *view = &self->view[i];
    g_autoptr (GstBuffer) unpacked = NULL;
    GstTriangulateSeen seen;

    if (view->looked || !heads[i]
        || GST_BUFFER_FLAG_IS_SET (heads[i], GST_BUFFER_FLAG_GAP)) {
      continue;
    }
    view->looked = is_new = TRUE;
    view->carries = gst_triangulate_see (self, i, heads[i], &unpacked, &seen,
        NULL);
    if (view->carries) {
      gst_triangulate_set_name (view, &seen);
    }
  }
  if (!is_new) {
    return GST_FLOW_OK;
  }
  if (!gst_triangulate_has_cameras (self)
      || !gst_triangulate_views_map (sync, self->view, self->rig, &moved)) {
    return GST_FLOW_ERROR;
  }
  return moved ? GST_AGGREGATOR_FLOW_NEED_DATA : GST_FLOW_OK;
}

/* The time of a picture by its camera's clock, in the mesh's segment. */
static GstClockTime
gst_triangulate_find_time (GstTriangulate * self, guint index,
    GstBuffer * picture)
{
  const GstSegment *to =
      &GST_AGGREGATOR_PAD (GST_AGGREGATOR_SRC_PAD (self))->segment;
  const guint64 time =
      gst_segment_to_running_time (gst_cloth_sync_get_segment (GST_CLOTH_SYNC
          (self), index), GST_FORMAT_TIME, GST_BUFFER_PTS (picture));

  return GST_CLOCK_TIME_IS_VALID (time) ?
      gst_segment_position_from_running_time (to, GST_FORMAT_TIME, time) :
      GST_CLOCK_TIME_NONE;
}

/* Puts what the cameras saw on their mesh, pictures that show nothing too: nothing was seen then. */
static void
gst_triangulate_add_views (GstTriangulate * self, GstBuffer ** views,
    GstBuffer ** unpacked, const GstTriangulateSeen * carried, guint n,
    GstBuffer * mesh)
{
  for (guint i = 0; i < n; i++) {
    const GstTriangulateView *view = &self->view[i];
    GstBuffer *observation;

    if (!views[i] || view->camera < 0 || (view->observations && !unpacked[i])) {
      continue;
    }
    observation = view->observations ? gst_buffer_copy (views[i]) :
        gst_cloth_observations_pack (views[i]);
    GST_BUFFER_PTS (observation) =
        gst_triangulate_find_time (self, i, views[i]);
    gst_buffer_add_cloth_view_meta (mesh,
        gst_cloth_view_new (self->rig->cameras[view->camera].name,
            view->carries ? carried[i].sequence : 0, observation));
  }
}

static GstFlowReturn
gst_triangulate_process_set (GstClothSync * sync, GstBuffer ** views, guint n,
    guint64 mask, GstClockTime pts, GstClockTime duration, GstBuffer ** out)
{
  GstTriangulate *self = GST_TRIANGULATE (sync);
  ClothTriangulateView seen[CLOTH_RIG_MAX_CAMERAS] = { {NULL} };
  GstBuffer *unpacked[GST_CLOTH_SYNC_MAX_PADS] = { NULL };
  GstTriangulateSeen carried[GST_CLOTH_SYNC_MAX_PADS];
  GstReferenceTimestampMeta *stamp = NULL;
  GstFlowReturn ret = GST_FLOW_ERROR;
  gboolean moved;
  guint i, n_carried = 0;

  if (!gst_triangulate_has_cameras (self)
      || !gst_triangulate_apply_parameters (self)) {
    return GST_FLOW_ERROR;
  }
  self->sequence++;
  for (i = 0; i < n; i++) {
    self->view[i].carries = FALSE;
    if (!views[i]) {
      continue;
    }
    ret = gst_triangulate_look (self, i, views[i], &unpacked[i], &carried[i],
        &self->view[i].carries);
    if (ret != GST_FLOW_OK) {
      goto done;
    }
    if (!stamp) {
      stamp = gst_buffer_get_reference_timestamp_meta (unpacked[i] ?
          unpacked[i] : views[i], NULL);
    }
    if (!self->view[i].carries) {
      continue;
    }
    if (n_carried++ == 0) {
      self->sequence = carried[i].sequence;
    }
    gst_triangulate_set_name (&self->view[i], &carried[i]);
  }
  ret = GST_FLOW_ERROR;
  if (!gst_triangulate_views_map (sync, self->view, self->rig, &moved)) {
    goto done;
  }
  if (moved) {
    GST_DEBUG_OBJECT (self,
        "these pictures are of different instants: no mesh");
    ret = GST_FLOW_OK;
    goto done;
  }
  for (i = 0; i < n; i++) {
    gint camera = self->view[i].camera;

    if (!self->view[i].carries || camera < 0) {
      continue;
    }
    if (!self->merge[camera]) {
      self->merge[camera] = cloth_merge_new (self->board->grid.columns
          * self->board->grid.rows);
    }
    cloth_merge_clear (self->merge[camera]);
    if (!gst_triangulate_board_take (self->board, GST_ELEMENT (self), i,
            &carried[i], self->merge[camera])) {
      goto done;
    }
    self->view[i].trusted = self->view[i].observations;
    cloth_merge_finish (self->merge[camera], self->threshold,
        cloth_reconstruction_get_error_floor (self->reconstruction),
        &seen[camera]);
  }
  ret = gst_triangulate_make_mesh (self, seen, out);
  if (ret == GST_FLOW_OK) {
    gst_triangulate_add_views (self, views, unpacked, carried, n, *out);
  }
  if (ret == GST_FLOW_OK && stamp) {
    gst_buffer_add_reference_timestamp_meta (*out, stamp->reference,
        stamp->timestamp, stamp->duration);
  }

done:
  for (i = 0; i < n; i++) {
    gst_clear_buffer (&unpacked[i]);
  }
  return ret;
}

static GstFlowReturn
gst_triangulate_aggregate (GstAggregator * agg, gboolean timeout)
{
  GstTriangulate *self = GST_TRIANGULATE (agg);
  const GstFlowReturn ret =
      GST_AGGREGATOR_CLASS (gst_triangulate_parent_class)->aggregate (agg,
      timeout);

  if (ret == GST_FLOW_EOS && self->board) {
    check_end (&self->check, GST_ELEMENT (self), self->board, self->rig,
        self->reconstruction);
  }
  return ret;
}

static void
gst_triangulate_reset (GstClothSync * sync)
{
  GstTriangulate *self = GST_TRIANGULATE (sync);

  memset (&self->check, 0, sizeof (self->check));
  self->sequence = G_MAXUINT64; /* the first set's is 0 */
}

static const gchar *
gst_triangulate_get_camera (GstClothSync * sync, guint index)
{
  GstTriangulate *self = GST_TRIANGULATE (sync);
  const gint camera = self->view[index].camera;

  return self->rig && camera >= 0 ? self->rig->cameras[camera].name : NULL;
}

/* ---- GObject ---- */

static void
gst_triangulate_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  GstTriangulate *self = GST_TRIANGULATE (object);
  const gboolean is_pattern = g_str_equal (pspec->name, "pattern");

  gst_cloth_set_property (object, id, value, pspec);
  GST_OBJECT_LOCK (self);
  self->rig_changed |= g_str_equal (pspec->name, "rig");
  self->pattern_changed |= is_pattern;
  GST_OBJECT_UNLOCK (self);
  if (is_pattern) {
    /* new caps before the next set */
    gst_pad_mark_reconfigure (GST_AGGREGATOR_SRC_PAD (self));
  }
}

static void
gst_triangulate_finalize (GObject * object)
{
  GstTriangulate *self = GST_TRIANGULATE (object);

  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  G_OBJECT_CLASS (gst_triangulate_parent_class)->finalize (object);
}

static void
gst_triangulate_class_init (GstTriangulateClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstAggregatorClass *agg_class = GST_AGGREGATOR_CLASS (klass);
  GstClothSyncClass *sync_class = GST_CLOTH_SYNC_CLASS (klass);

  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstTriangulate,
          settings));
  object_class->set_property = gst_triangulate_set_property;
  object_class->finalize = gst_triangulate_finalize;
  element_class->request_new_pad = gst_triangulate_pad_request_new;
  element_class->release_pad = gst_triangulate_pad_release;
  agg_class->start = gst_triangulate_start;
  agg_class->stop = gst_triangulate_stop;
  agg_class->aggregate = gst_triangulate_aggregate;
  sync_class->set_pad_caps = gst_triangulate_set_pad_caps;
  sync_class->negotiate_src = gst_triangulate_negotiate_src;
  sync_class->look = gst_triangulate_look_ahead;
  sync_class->process_set = gst_triangulate_process_set;
  sync_class->reset = gst_triangulate_reset;
  sync_class->get_camera = gst_triangulate_get_camera;
  sync_class->prefix = "triangulate";

  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &sink_template, GST_TYPE_TRIANGULATE_PAD);
  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &src_template, GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_set_static_metadata (element_class, "Triangulate",
      "Filter/Analyzer/Video",
      "Makes a mesh with covariances from what several cameras see of a pattern",
      "The gst-cloth developers");
  gst_type_mark_as_plugin_api (GST_TYPE_TRIANGULATE_PAD, 0);
}

static void
gst_triangulate_init (GstTriangulate * self)
{
  guint i;

  self->settings = defaults;
  gst_cloth_damage_watch (&self->settings.damage, GST_ELEMENT (self),
      GST_AGGREGATOR_SRC_PAD (self));
  self->fps_n = -1;
  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    self->view[i].camera = -1;
  }
}
