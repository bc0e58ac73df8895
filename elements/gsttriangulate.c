/* triangulate: N cameras' observations become a mesh in space.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-triangulate
 * @title: triangulate
 *
 * Joins the pictures of a rig's cameras by time and triangulates the corners of the
 * squares that they carry as #GstClothQuads, or the dots of #GstClothDots. Each frame of
 * the mesh has a vertex for every corner of the board, or every dot of the array: its
 * place, its 3×3 covariance, and whether three or more views agree on it, only two saw
 * it, or it is unseen. A vertex seen by one camera, or contradicted, is unseen; nothing is carried over from earlier frames. Clocks that the
 * rig knows to differ (`offset_s`) are known from the first pictures on, which make no
 * mesh then.
 *
 * The mesh's frame rate is the cameras'. While they differ it is the last one that was
 * sent, so that a camera joining late doesn't change it in mid-stream; 0/1, variable, when
 * they differ from the start. Frames come with the times of their pictures all the same.
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
#include "elements/gsttriangulateboard.h"
#include "elements/gsttriangulatecheck.h"
#include "elements/gsttriangulatepad.h"
#include "elements/gsttriangulatesolve.h"
#include "elements/gsttriangulateviews.h"

#include <gst/cloth/cloth.h>
#include "gst/rig/merge.h"
#include "gst/rig/rigfile.h"
#include "gst/rig/triangulate.h"

GST_DEBUG_CATEGORY_STATIC (triangulate_debug);
#define GST_CAT_DEFAULT triangulate_debug

#define DEFAULT_THRESHOLD 4.0
#define DEFAULT_MAX_ERROR 0.0
#define DEFAULT_ERROR_FLOOR -1.0
#define DEFAULT_HUBER 2.0
/* Bent into a fold a square's edge is a chord; woven cloth stretches a little. */
#define DEFAULT_MIN_LENGTH 0.8
#define DEFAULT_MAX_LENGTH 1.05
#define DEFAULT_THREADS 0
#define MAX_THREADS 1024
#define SINK_CAPS "video/x-raw(ANY), width=(int)[ 1, 16384 ], " \
    "height=(int)[ 1, 16384 ]; " GST_CLOTH_OBSERVATIONS_CAPS

struct _GstTriangulate
{
  GstClothSync parent;

  /* object lock */
  gchar *rig_location, *pattern_location;
  gboolean rig_changed, pattern_changed, parameters_changed;
  ClothTriangulateParameters parameters;
  gdouble min_length, max_length;
  guint threads;

  /* streaming thread */
  ClothRig *rig;
  GstTriangulateBoard *board;
  gint fps_n, fps_d;            /* as sent downstream; fps_n -1: not yet */
  ClothPool *pool;
  ClothMerge *merge[CLOTH_RIG_MAX_CAMERAS];
  GstTriangulateSolve solve;
  GstTriangulateView view[GST_CLOTH_SYNC_MAX_PADS];
  guint64 sequence;
  GstTriangulateCheck check;
};

enum
{
  PROP_0,
  PROP_RIG,
  PROP_PATTERN,
  PROP_THRESHOLD,
  PROP_MAX_ERROR,
  PROP_ERROR_FLOOR,
  PROP_HUBER,
  PROP_MIN_LENGTH,
  PROP_MAX_LENGTH,
  PROP_THREADS
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
  ClothTriangulator *triangulator;

  GST_OBJECT_LOCK (self);
  location = g_strdup (self->rig_location);
  self->rig_changed = FALSE;
  self->parameters_changed = TRUE;
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
  triangulator = cloth_triangulator_new (rig->n_cameras, rig->cameras, &error);
  if (!triangulator) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("%s (%s).", error->message, location),
        ("Calibrate two or more cameras together into one rig.json."));
    return FALSE;
  }
  cloth_triangulator_free (self->solve.triangulator);
  self->solve.triangulator = triangulator;
  self->solve.floor.weight = 0;
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
  location = g_strdup (self->pattern_location);
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
  gst_triangulate_solve_set_board (&self->solve, board);
  return TRUE;
}

static gboolean
gst_triangulate_apply_parameters (GstTriangulate * self)
{
  ClothTriangulateParameters parameters;
  gboolean rig_changed, changed;
  guint threads;

  GST_OBJECT_LOCK (self);
  rig_changed = self->rig_changed;
  GST_OBJECT_UNLOCK (self);
  if ((rig_changed || !self->rig) && !gst_triangulate_load_rig (self)) {
    return FALSE;
  }
  GST_OBJECT_LOCK (self);
  parameters = self->parameters;
  self->solve.min_length = self->min_length;
  self->solve.max_length = self->max_length;
  threads = self->threads;
  changed = self->parameters_changed;
  self->parameters_changed = FALSE;
  GST_OBJECT_UNLOCK (self);
  if (!changed) {
    return TRUE;
  }
  self->solve.parameters = parameters;
  if (threads == 0) {
    threads = MIN (g_get_num_processors (), MAX_THREADS);
  }
  if (threads != cloth_pool_get_n_threads (self->pool) || !self->pool) {
    cloth_pool_free (self->pool);
    self->pool = cloth_pool_new (threads);
  }
  cloth_triangulator_set_pool (self->solve.triangulator, self->pool);
  return TRUE;
}

static void
gst_triangulate_forget (GstTriangulate * self)
{
  guint i;

  gst_triangulate_solve_clear (&self->solve);
  g_clear_pointer (&self->rig, cloth_rig_free);
  g_clear_pointer (&self->board, gst_triangulate_board_free);
  g_clear_pointer (&self->pool, cloth_pool_free);
  gst_triangulate_clear_merges (self);
  self->fps_n = -1;
  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    gst_triangulate_view_forget (&self->view[i]);
  }
}

static gboolean
gst_triangulate_start (GstAggregator * agg)
{
  GstTriangulate *self = GST_TRIANGULATE (agg);

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

static gboolean
gst_triangulate_set_pad_caps (GstClothSync * sync, guint index, GstCaps * caps)
{
  GstTriangulate *self = GST_TRIANGULATE (sync);
  GstTriangulateView *view = &self->view[index];
  const GstStructure *s;

  gst_triangulate_view_forget (view);
  if (!caps) {
    return TRUE;
  }
  s = gst_caps_get_structure (caps, 0);
  view->observations =
      gst_structure_has_name (s, GST_CLOTH_OBSERVATIONS_MEDIA_TYPE);
  if (!gst_structure_get_int (s, "width", &view->width)
      || !gst_structure_get_int (s, "height", &view->height)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("Caps on sink_%u do not give the size of the picture.", index),
        ("They are %" GST_PTR_FORMAT, caps));
    return FALSE;
  }
  if (!gst_structure_get_fraction (s, "framerate", &view->fps_n, &view->fps_d)) {
    view->fps_n = 0;
    view->fps_d = 1;
  }
  view->has_caps = TRUE;
  return TRUE;
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
  *caps =
      gst_cloth_topology_to_caps (self->board->topology, self->fps_n,
      self->fps_d);
  return GST_FLOW_OK;
}

static GstFlowReturn
gst_triangulate_make_mesh (GstTriangulate * self,
    const ClothTriangulateView * views, GstBuffer ** out)
{
  GstTriangulateSolve *solve = &self->solve;
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;

  if (!gst_triangulate_solve_run (solve, self->rig, self->board, views, &error)) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED, ("%s", error->message), (NULL));
    return GST_FLOW_ERROR;
  }
  gst_triangulate_check_add (&self->check, GST_ELEMENT (self), self->board,
      self->rig, views, solve->result);
  mesh = gst_cloth_mesh_new (self->sequence, solve->n_vertices,
      solve->positions, solve->result->state, solve->covariances);
  *out = gst_cloth_mesh_to_buffer (mesh);
  GST_LOG_OBJECT (self, "frame %" G_GUINT64_FORMAT ": error floor %g px²",
      self->sequence, solve->floor.floor);
  return GST_FLOW_OK;
}

/* What a view carries, in its own or in unpacked metadata. */
static gboolean
gst_triangulate_look (GstTriangulate * self, guint index, GstBuffer * view,
    GstBuffer ** unpacked, GstTriangulateSeen * seen)
{
  g_autoptr (GError) error = NULL;

  if (!self->view[index].observations) {
    return gst_triangulate_board_see (self->board, view, seen);
  }
  *unpacked = gst_buffer_new ();
  if (!gst_cloth_observations_unpack (view, *unpacked, &error)) {
    GST_DEBUG_OBJECT (self, "sink_%u: %s", index, error->message);
    if (!self->view[index].warned) {
      self->view[index].warned = TRUE;
      GST_ELEMENT_WARNING (self, STREAM, DECODE,
          ("A buffer on sink_%u holds no observations: %s", index,
              error->message), ("It counts as a picture with nothing seen; so "
              "do others like it, of which you are not told."));
    }
    return FALSE;
  }
  return gst_triangulate_board_see (self->board, *unpacked, seen);
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

  if (!gst_triangulate_apply_parameters (self)) {
    return GST_FLOW_ERROR;
  }
  self->sequence++;
  for (i = 0; i < n; i++) {
    const gchar *name;

    self->view[i].carries = FALSE;
    if (!views[i]) {
      continue;
    }
    self->view[i].carries = gst_triangulate_look (self, i, views[i],
        &unpacked[i], &carried[i]);
    if (!stamp) {
      stamp = gst_buffer_get_reference_timestamp_meta (unpacked[i] ?
          unpacked[i] : views[i], NULL);
    }
    if (!self->view[i].carries) {
      continue;
    }
    if (n_carried++ == 0) {
      self->sequence = gst_triangulate_seen_sequence (&carried[i]);
    }
    name = gst_triangulate_seen_camera (&carried[i]);
    if (name[0] != '\0' && g_strcmp0 (name, self->view[i].meta) != 0) {
      g_free (self->view[i].meta);
      self->view[i].meta = g_strdup (name);
    }
  }
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
      self->merge[camera] = cloth_merge_new (self->solve.n_vertices);
    }
    cloth_merge_clear (self->merge[camera]);
    if (!gst_triangulate_board_take (self->board, GST_ELEMENT (self), i,
            &carried[i], self->merge[camera])) {
      goto done;
    }
    cloth_merge_finish (self->merge[camera],
        self->solve.parameters.threshold, gst_triangulate_solve_get_floor
        (&self->solve), &seen[camera]);
  }
  ret = gst_triangulate_make_mesh (self, seen, out);
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

static void
gst_triangulate_reset (GstClothSync * sync)
{
  GstTriangulate *self = GST_TRIANGULATE (sync);

  memset (&self->check, 0, sizeof (self->check));
  self->sequence = G_MAXUINT64; /* the first set's is 0 */
}

static void
gst_triangulate_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  GstTriangulate *self = GST_TRIANGULATE (object);

  GST_OBJECT_LOCK (self);
  switch (id) {
    case PROP_RIG:
      g_free (self->rig_location);
      self->rig_location = g_value_dup_string (value);
      self->rig_changed = TRUE;
      break;
    case PROP_PATTERN:
      g_free (self->pattern_location);
      self->pattern_location = g_value_dup_string (value);
      self->pattern_changed = TRUE;
      break;
    case PROP_THRESHOLD:
      self->parameters.threshold = g_value_get_double (value);
      break;
    case PROP_MAX_ERROR:
      self->parameters.max_error = g_value_get_double (value);
      break;
    case PROP_ERROR_FLOOR:
      self->parameters.error_floor = g_value_get_double (value);
      break;
    case PROP_HUBER:
      self->parameters.huber = g_value_get_double (value);
      break;
    case PROP_MIN_LENGTH:
      self->min_length = g_value_get_double (value);
      break;
    case PROP_MAX_LENGTH:
      self->max_length = g_value_get_double (value);
      break;
    case PROP_THREADS:
      self->threads = g_value_get_uint (value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
      break;
  }
  self->parameters_changed = TRUE;
  GST_OBJECT_UNLOCK (self);
  if (id == PROP_PATTERN) {
    /* new caps before the next set */
    gst_pad_mark_reconfigure (GST_AGGREGATOR_SRC_PAD (self));
  }
}

static void
gst_triangulate_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * pspec)
{
  GstTriangulate *self = GST_TRIANGULATE (object);

  GST_OBJECT_LOCK (self);
  switch (id) {
    case PROP_RIG:
      g_value_set_string (value, self->rig_location);
      break;
    case PROP_PATTERN:
      g_value_set_string (value, self->pattern_location);
      break;
    case PROP_THRESHOLD:
      g_value_set_double (value, self->parameters.threshold);
      break;
    case PROP_MAX_ERROR:
      g_value_set_double (value, self->parameters.max_error);
      break;
    case PROP_ERROR_FLOOR:
      g_value_set_double (value, self->parameters.error_floor);
      break;
    case PROP_HUBER:
      g_value_set_double (value, self->parameters.huber);
      break;
    case PROP_MIN_LENGTH:
      g_value_set_double (value, self->min_length);
      break;
    case PROP_MAX_LENGTH:
      g_value_set_double (value, self->max_length);
      break;
    case PROP_THREADS:
      g_value_set_uint (value, self->threads);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
      break;
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_triangulate_finalize (GObject * object)
{
  GstTriangulate *self = GST_TRIANGULATE (object);

  g_free (self->rig_location);
  g_free (self->pattern_location);
  G_OBJECT_CLASS (gst_triangulate_parent_class)->finalize (object);
}

static GstPad *
gst_triangulate_request_new_pad (GstElement * element, GstPadTemplate * templ,
    const gchar * name, const GstCaps * caps)
{
  GstPad *pad =
      GST_ELEMENT_CLASS (gst_triangulate_parent_class)->request_new_pad
      (element, templ, name, caps);

  if (pad) {
    gst_child_proxy_child_added (GST_CHILD_PROXY (element), G_OBJECT (pad),
        GST_OBJECT_NAME (pad));
  }
  return pad;
}

static void
gst_triangulate_release_pad (GstElement * element, GstPad * pad)
{
  gst_child_proxy_child_removed (GST_CHILD_PROXY (element), G_OBJECT (pad),
      GST_OBJECT_NAME (pad));
  GST_ELEMENT_CLASS (gst_triangulate_parent_class)->release_pad (element, pad);
}

static void
gst_triangulate_class_init (GstTriangulateClass * klass)
{
  const GParamFlags flags = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
      GST_PARAM_MUTABLE_PLAYING;
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstAggregatorClass *agg_class = GST_AGGREGATOR_CLASS (klass);
  GstClothSyncClass *sync_class = GST_CLOTH_SYNC_CLASS (klass);

  object_class->set_property = gst_triangulate_set_property;
  object_class->get_property = gst_triangulate_get_property;
  object_class->finalize = gst_triangulate_finalize;
  element_class->request_new_pad = gst_triangulate_request_new_pad;
  element_class->release_pad = gst_triangulate_release_pad;
  agg_class->start = gst_triangulate_start;
  agg_class->stop = gst_triangulate_stop;
  sync_class->set_pad_caps = gst_triangulate_set_pad_caps;
  sync_class->negotiate_src = gst_triangulate_negotiate_src;
  sync_class->process_set = gst_triangulate_process_set;
  sync_class->reset = gst_triangulate_reset;

  /**
   * GstTriangulate:rig:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_RIG,
      g_param_spec_string ("rig", "Rig",
          "File rig.json with the calibrated cameras; a new one counts from the "
          "next set on", NULL, flags));
  /**
   * GstTriangulate:pattern:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_PATTERN,
      g_param_spec_string ("pattern", "Pattern",
          "File pattern.json of what is filmed: the mesh has a vertex for each corner "
          "of a checkerboard's squares, or for each dot of an M-array", NULL,
          flags));
  /**
   * GstTriangulate:threshold:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_THRESHOLD,
      g_param_spec_double ("threshold", "Threshold",
          "A view is left out when it is further from what the others say than "
          "this many standard deviations", 0.1, G_MAXDOUBLE, DEFAULT_THRESHOLD,
          flags));
  /**
   * GstTriangulate:max-error:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_MAX_ERROR,
      g_param_spec_double ("max-error", "Maximum error",
          "A view is left out when its reprojection error is larger than this, in "
          "px, whatever its covariance says; 0: no such limit", 0.0,
          G_MAXDOUBLE, DEFAULT_MAX_ERROR, flags));
  /**
   * GstTriangulate:error-floor:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_ERROR_FLOOR,
      g_param_spec_double ("error-floor", "Error floor",
          "Variance in px² added to every observation's own, which knows of the "
          "picture's noise only: what calibration, lens model and compression "
          "leave; -1: what the film's own residuals tell where three cameras see a "
          "point, 0.01 until they do", -1.0, 1e6, DEFAULT_ERROR_FLOOR, flags));
  /**
   * GstTriangulate:huber:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_HUBER,
      g_param_spec_double ("huber", "Huber",
          "While looking for the view to leave out, errors beyond this many "
          "standard deviations weigh less", 0.1, G_MAXDOUBLE, DEFAULT_HUBER,
          flags));
  /**
   * GstTriangulate:min-length:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_MIN_LENGTH,
      g_param_spec_double ("min-length", "Least length",
          "Vertices are dropped that are nearer to their neighbours in space than "
          "this share of their distance on the flat cloth; 0: no such limit",
          0.0, 1.0, DEFAULT_MIN_LENGTH, flags));
  /**
   * GstTriangulate:max-length:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_MAX_LENGTH,
      g_param_spec_double ("max-length", "Largest length",
          "Vertices are dropped that are farther from their neighbours in space "
          "than this share of their distance on the flat cloth, more for cloth "
          "that stretches; 0: no such limit", 0.0, 10.0, DEFAULT_MAX_LENGTH,
          flags));
  /**
   * GstTriangulate:threads:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_THREADS,
      g_param_spec_uint ("threads", "Threads",
          "Threads that triangulate; 0: as many as there are processors. The "
          "result is the same", 0, MAX_THREADS, DEFAULT_THREADS, flags));

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
  static const ClothTriangulateParameters parameters = { 2, DEFAULT_THRESHOLD,
    DEFAULT_MAX_ERROR, DEFAULT_ERROR_FLOOR, DEFAULT_HUBER
  };
  guint i;

  self->parameters = parameters;
  self->min_length = DEFAULT_MIN_LENGTH;
  self->max_length = DEFAULT_MAX_LENGTH;
  self->threads = DEFAULT_THREADS;
  self->fps_n = -1;
  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    self->view[i].camera = -1;
  }
}
