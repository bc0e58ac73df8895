/* uvmap: stereo heads' matches and disparities become a mesh in space.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-uvmap
 * @title: uvmap
 *
 * Takes the pictures of one or more stereo heads, with the #GstClothMatches and the
 * #GstClothDisparity that they carry, and finds for each pixel which place of the flat cloth
 * it shows: between the matches along the surface, a little beyond them by the slope there.
 * By that and the surface each vertex of the pattern's grid is found in space, with its 3×3
 * covariance. A vertex that siftmatch has found in the picture has its place from there.
 *
 * Each sink pad is a head. Their vertices are joined in the world by how sure each is. A head
 * that two or more others contradict is left out; where two heads contradict each other the
 * vertex is unseen. Its state is measured where three or more cameras stand behind it, else
 * two views.
 *
 * The mesh carries a #GstClothUV of each head: the place of each pixel of its picture.
 *
 * A picture without matches or disparities is one that saw nothing; the first of each pad
 * gives a warning.
 *
 * ## A mesh from the films of a stereo head
 * |[
 * gst-launch-1.0 clothdisparity name=d rig=rig.json near=1 far=3 ! \
 *     siftmatch pattern=pattern.json ! uvmap pattern=pattern.json ! \
 *     meshsink location=cloth.obj \
 *     filesrc location=cam0.mp4 ! decodebin ! d.sink_0 \
 *     filesrc location=cam1.mp4 ! decodebin ! d.sink_1
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstuvmap.h"

#include <gst/cloth/cloth.h>
#include <math.h>

#include "elements/gstclothproperties.h"
#include "elements/gsttriangulatepad.h"
#include "gst/pattern/picture.h"
#include "gst/vision/uv/uv.h"

GST_DEBUG_CATEGORY_STATIC (uv_map_debug);
#define GST_CAT_DEFAULT uv_map_debug

#define MAX_THREADS 1024
/* Every so many sets it is looked whether the heads fit together. */
#define CHECKED_SETS 25
#define SINK_CAPS "video/x-raw(ANY), width=(int)[ 1, 16384 ], " \
    "height=(int)[ 1, 16384 ]"

/* A vertex has the state of its point. */
G_STATIC_ASSERT ((gint) CLOTH_POINT_UNSEEN == GST_CLOTH_VERTEX_UNSEEN);
G_STATIC_ASSERT ((gint) CLOTH_POINT_MEASURED == GST_CLOTH_VERTEX_MEASURED);
G_STATIC_ASSERT ((gint) CLOTH_POINT_TWO_VIEWS == GST_CLOTH_VERTEX_TWO_VIEWS);

typedef struct
{
  gchar *pattern;
  guint threads;
  gdouble significance;
  ClothUVParams uv;
  ClothUVVertexParams vertex;
} Settings;

/* One sink pad: room to work in, used again and again. */
typedef struct
{
  ClothUV *dense;
  ClothUVVertices *finder;
  GArray *points, *uv;          /* gfloat: three and two of each pixel */
  GArray *matches;              /* ClothUVMatch */
  GArray *spots;                /* ClothUVSpot */
  GArray *vertices;             /* ClothUVVertex */
  gboolean warned_matches, warned_disparity;
} Head;

struct _GstUVMap
{
  GstClothSync parent;

  /* object lock */
  Settings settings;

  /* streaming thread */
  ClothPicturePattern *pattern;
  GstClothTopology *topology;
  ClothGridShape shape;
  gint fps_n, fps_d;            /* as sent downstream; fps_n -1: not yet */
  ClothPool *pool;
  GstTriangulateView view[GST_CLOTH_SYNC_MAX_PADS];
  Head head[GST_CLOTH_SYNC_MAX_PADS];
  GArray *positions, *covariances;      /* gfloat */
  GByteArray *states;
  guint64 sequence;

  /* of the sets since the last judgement */
  guint n_sets;
  guint64 n_compared, n_contradicted;
  gboolean warned_contradiction;
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"pattern", "Pattern",
    "File pattern.json of kind \"picture\": the mesh has a vertex for each of its grid",
    G_TYPE_STRING, SETTING (pattern), GST_PARAM_MUTABLE_READY},
  {"threads", "Threads",
    "Threads that work; 0: as many as there are processors. The result is the same",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_READY, 0, MAX_THREADS},
  {"together", "Together",
    "Matches nearer to each other than this become one, their mean, px",
    G_TYPE_DOUBLE, SETTING (uv.together), GST_PARAM_MUTABLE_PLAYING, 0, 100},
  {"outlier", "Outlier",
    "A match doesn't count when it is farther from where its neighbours say than this "
    "many standard deviations; 0: all count",
    G_TYPE_DOUBLE, SETTING (uv.outlier), GST_PARAM_MUTABLE_PLAYING, 0, 1000},
  {"smooth", "Smooth",
    "By which share of the way a match is moved to where its neighbours say; 0: the paper's, "
    "which keeps matches as they are",
    G_TYPE_DOUBLE, SETTING (uv.smooth), GST_PARAM_MUTABLE_PLAYING, 0, 1},
  {"longest", "Longest edge", "Of the triangles between matches, px",
    G_TYPE_DOUBLE, SETTING (uv.longest), GST_PARAM_MUTABLE_PLAYING, 1, 100000},
  {"reach", "Reach",
    "How far uv goes on beyond the triangles along the surface, px; 0: not at all",
    G_TYPE_DOUBLE, SETTING (uv.reach), GST_PARAM_MUTABLE_PLAYING, 0, 1000},
  {"stretch", "Stretch",
    "By what share an edge on the cloth may be longer or shorter than on the flat cloth",
    G_TYPE_DOUBLE, SETTING (uv.stretch.stretch), GST_PARAM_MUTABLE_PLAYING, 0, 0.9},
  {"slack", "Slack", "By how much more it may for the noise of its ends, px",
    G_TYPE_DOUBLE, SETTING (uv.stretch.slack), GST_PARAM_MUTABLE_PLAYING, 0, 100},
  {"depth-step", "Depth step",
    "By more than this between two samples 2 px apart the surface is broken, m",
    G_TYPE_DOUBLE, SETTING (uv.stretch.depth_step), GST_PARAM_MUTABLE_PLAYING, 0, 10},
  {"radius", "Radius",
    "How far on the flat cloth around a vertex uv and depth are fitted, m",
    G_TYPE_DOUBLE, SETTING (vertex.radius), GST_PARAM_MUTABLE_PLAYING, 1e-6, 10},
  {"edge", "Edge",
    "A vertex is known up to so far beyond the pixels with a uv, m",
    G_TYPE_DOUBLE, SETTING (vertex.edge), GST_PARAM_MUTABLE_PLAYING, 0, 10},
  {"rival", "Rival",
    "A vertex is unseen when more than this share of the pixels that show it lie elsewhere "
    "in space",
    G_TYPE_DOUBLE, SETTING (vertex.rival), GST_PARAM_MUTABLE_PLAYING, 0, 1},
  {"noise", "Noise", "Least standard deviation of uv along u or v, m",
    G_TYPE_DOUBLE, SETTING (vertex.noise), GST_PARAM_MUTABLE_PLAYING, 0, 1},
  {"doubt", "Doubt",
    "Share of the standard deviation of uv that is added to that of a vertex whose place "
    "siftmatch tells, which knows nothing of folds",
    G_TYPE_DOUBLE, SETTING (vertex.doubt), GST_PARAM_MUTABLE_PLAYING, 0, 100},
  {"depth-noise", "Noise of depth", "Least standard deviation of a disparity, px",
    G_TYPE_DOUBLE, SETTING (vertex.depth_noise), GST_PARAM_MUTABLE_PLAYING, 0, 100},
  {"significance", "Significance",
    "Heads that agree are as far apart as this rarely by their covariances; what is "
    "farther contradicts",
    G_TYPE_DOUBLE, SETTING (significance), GST_PARAM_MUTABLE_PLAYING, 0, 1},
};
/* *INDENT-ON* */

G_DEFINE_TYPE_WITH_CODE (GstUVMap, gst_uv_map, GST_TYPE_CLOTH_SYNC,
    GST_DEBUG_CATEGORY_INIT (uv_map_debug, "uvmap", 0,
        "places of the flat cloth on pictures and vertices in space"));
GST_ELEMENT_REGISTER_DEFINE (uvmap, "uvmap", GST_RANK_NONE, GST_TYPE_UV_MAP);

static GstStaticPadTemplate sink_template =
GST_STATIC_PAD_TEMPLATE ("sink_%u", GST_PAD_SINK, GST_PAD_REQUEST,
    GST_STATIC_CAPS (SINK_CAPS));
static GstStaticPadTemplate src_template =
GST_STATIC_PAD_TEMPLATE ("src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

/* ---- start and stop ---- */

static void
gst_uv_map_forget (GstUVMap * self)
{
  g_clear_pointer (&self->pattern, cloth_picture_pattern_free);
  g_clear_pointer (&self->topology, gst_cloth_topology_unref);
  g_clear_pointer (&self->pool, cloth_pool_free);
  self->fps_n = -1;
  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    self->head[i].warned_matches = self->head[i].warned_disparity = FALSE;
    gst_triangulate_view_forget (&self->view[i]);
  }
}

static gboolean
gst_uv_map_load (GstUVMap * self)
{
  g_autofree gchar *location = NULL;
  g_autoptr (GError) error = NULL;
  guint threads;

  GST_OBJECT_LOCK (self);
  location = g_strdup (self->settings.pattern);
  threads = self->settings.threads;
  GST_OBJECT_UNLOCK (self);
  if (!location) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("What is filmed is not known: the property pattern is not set."),
        ("Set pattern to the pattern.json of kind \"picture\" that siftmatch "
            "has."));
    return FALSE;
  }
  self->pattern = cloth_picture_pattern_load (location, &error);
  if (self->pattern)
    self->topology =
        gst_cloth_topology_new_grid ((guint) self->pattern->columns,
        (guint) self->pattern->rows, (gfloat) self->pattern->cloth_m[0],
        (gfloat) self->pattern->cloth_m[1], &error);
  if (!self->topology) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("The pattern could not be read: %s", error->message),
        ("Set pattern to a pattern.json of kind \"picture\"; it is now "
            "\"%s\".", location));
    return FALSE;
  }
  self->shape = (ClothGridShape) {
    self->pattern->columns, self->pattern->rows, {
    self->pattern->cloth_m[0], self->pattern->cloth_m[1]}
  };
  self->pool = cloth_pool_new (threads ? threads
      : MIN (g_get_num_processors (), MAX_THREADS));
  return TRUE;
}

static gboolean
gst_uv_map_start (GstAggregator * agg)
{
  GstUVMap *self = GST_UV_MAP (agg);

  if (GST_AGGREGATOR_CLASS (gst_uv_map_parent_class)->start (agg)
      && gst_uv_map_load (self))
    return TRUE;
  /* stop is not called then */
  gst_uv_map_forget (self);
  return FALSE;
}

static gboolean
gst_uv_map_stop (GstAggregator * agg)
{
  gst_uv_map_forget (GST_UV_MAP (agg));
  return GST_AGGREGATOR_CLASS (gst_uv_map_parent_class)->stop (agg);
}

/* ---- GstClothSync ---- */

static gboolean
gst_uv_map_set_pad_caps (GstClothSync * sync, guint index, GstCaps * caps)
{
  return gst_triangulate_view_set_caps (&GST_UV_MAP (sync)->view[index],
      GST_ELEMENT (sync), index, caps);
}

static GstFlowReturn
gst_uv_map_negotiate_src (GstClothSync * sync, GstCaps * downstream,
    GstCaps ** caps)
{
  GstUVMap *self = GST_UV_MAP (sync);

  if (!gst_triangulate_views_rate (self->view, &self->fps_n, &self->fps_d))
    return GST_AGGREGATOR_FLOW_NEED_DATA;
  *caps = gst_cloth_topology_to_caps (self->topology, self->fps_n, self->fps_d);
  return GST_FLOW_OK;
}

static GArray *
floats (void)
{
  return g_array_new (FALSE, FALSE, sizeof (gfloat));
}

static void
head_open (Head * head)
{
  if (head->dense)
    return;
  head->dense = cloth_uv_new ();
  head->finder = cloth_uv_vertices_new ();
  head->points = floats ();
  head->uv = floats ();
  head->matches = g_array_new (FALSE, FALSE, sizeof (ClothUVMatch));
  head->spots = g_array_new (FALSE, FALSE, sizeof (ClothUVSpot));
  head->vertices = g_array_new (FALSE, FALSE, sizeof (ClothUVVertex));
}

static void
head_close (Head * head)
{
  if (!head->dense)
    return;
  cloth_uv_free (head->dense);
  cloth_uv_vertices_free (head->finder);
  g_array_unref (head->points);
  g_array_unref (head->uv);
  g_array_unref (head->matches);
  g_array_unref (head->spots);
  g_array_unref (head->vertices);
}

/* What a picture carries; FALSE where something is missing, which is told once. */
static gboolean
gst_uv_map_look (GstUVMap * self, guint index, GstBuffer * buffer,
    GstClothMatches ** matches, GstClothDisparity ** disparity)
{
  Head *head = &self->head[index];

  *matches = gst_buffer_get_cloth_matches (buffer);
  *disparity = gst_buffer_get_cloth_disparity (buffer);
  if (!*matches && !head->warned_matches) {
    head->warned_matches = TRUE;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("A picture on sink_%u carries no matches: it counts as one that saw "
            "nothing.", index),
        ("Put siftmatch before the pad, and nothing that drops metadata "
            "between them."));
  }
  if (!*disparity && !head->warned_disparity) {
    head->warned_disparity = TRUE;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("A picture on sink_%u carries no disparities: it counts as one that "
            "saw nothing.", index),
        ("Put clothdisparity before siftmatch, and nothing that drops "
            "metadata between them and this pad."));
  }
  return *matches && *disparity;
}

/* Brings what is matched onto the pixels of the disparities, which keep their size when the
 * picture is scaled. */
static void
gst_uv_map_take_matches (GstUVMap * self, guint index,
    GstClothMatches * matches, GstClothDisparity * disparity)
{
  Head *head = &self->head[index];
  const gdouble sx = (gdouble) gst_cloth_disparity_get_width (disparity)
      / self->view[index].width;
  const gdouble sy = (gdouble) gst_cloth_disparity_get_height (disparity)
      / self->view[index].height;
  const GstClothMatch *found;
  const GstClothGridPoint *points;
  guint n, n_points;

  found = gst_cloth_matches_get_matches (matches, &n);
  points = gst_cloth_matches_get_points (matches, &n_points);
  g_array_set_size (head->matches, 0);
  g_array_set_size (head->spots, 0);
  for (guint i = 0; i < n; i++) {
    const ClothUVMatch match = {
      (gfloat) ((found[i].x + 0.5) * sx - 0.5),
      (gfloat) ((found[i].y + 0.5) * sy - 0.5), found[i].u, found[i].v
    };

    if (found[i].verified)
      g_array_append_val (head->matches, match);
  }
  for (guint i = 0; i < n_points; i++) {
    const ClothUVSpot spot = {
      (guint) (points[i].row * self->shape.columns + points[i].column),
      (points[i].x + 0.5) * sx - 0.5, (points[i].y + 0.5) * sy - 0.5,
      points[i].cov_xx * sx * sx, points[i].cov_xy * sx * sy,
      points[i].cov_yy * sy * sy
    };

    if (points[i].column >= 0 && points[i].row >= 0
        && points[i].column < self->shape.columns
        && points[i].row < self->shape.rows)
      g_array_append_val (head->spots, spot);
  }
}

/* What one head knows of the vertices. */
static void
gst_uv_map_do_head (GstUVMap * self, guint index, const Settings * settings,
    GstClothMatches * matches, GstClothDisparity * disparity,
    ClothUVHead * result)
{
  Head *head = &self->head[index];
  GstClothStereo *stereo = gst_cloth_disparity_get_stereo (disparity);
  const guint width = gst_cloth_disparity_get_width (disparity);
  const guint height = gst_cloth_disparity_get_height (disparity);
  const guint n_pixels = width * height;
  const guint n = (guint) self->shape.columns * self->shape.rows;
  ClothUVDepth depth = {
    gst_cloth_disparity_get_sigma (disparity),
    gst_cloth_stereo_get_focal_baseline (stereo)
  };
  ClothMatchSurface surface = { NULL, (gint) width, (gint) height,
    (gint) width
  };
  ClothUVCounts counts;
  guint n_seen;

  head_open (head);
  memcpy (depth.normal, gst_cloth_stereo_get_normal (stereo),
      sizeof depth.normal);
  g_array_set_size (head->points, 3 * n_pixels);
  g_array_set_size (head->uv, 2 * n_pixels);
  g_array_set_size (head->vertices, n);
  gst_cloth_disparity_get_points (disparity, (gfloat *) head->points->data);
  surface.points = (const gfloat *) head->points->data;
  gst_uv_map_take_matches (self, index, matches, disparity);
  cloth_uv_run (head->dense, &settings->uv,
      (const ClothUVMatch *) head->matches->data, head->matches->len,
      &surface, self->pool, (gfloat *) head->uv->data, &counts);
  n_seen = cloth_uv_vertices_run (head->finder, &settings->vertex,
      &self->shape, &surface, (const gfloat *) head->uv->data, head->dense,
      &depth, (const ClothUVSpot *) head->spots->data, head->spots->len,
      (ClothUVVertex *) head->vertices->data);
  *result = (ClothUVHead) {
  .vertices = (const ClothUVVertex *) head->vertices->data,.n_cameras =
        gst_cloth_stereo_get_n_cameras (stereo)};
  memcpy (result->R, gst_cloth_stereo_get_rotation (stereo), sizeof result->R);
  memcpy (result->t, gst_cloth_stereo_get_translation (stereo),
      sizeof result->t);
  GST_LOG_OBJECT (self, "sink_%u: %u places (%u outliers, sigma %g m), %u "
      "triangles, uv on %u + %u of %u pixels, %u vertices", index,
      counts.n_places, counts.n_outliers, counts.sigma, counts.n_triangles,
      counts.n_between, counts.n_beyond, counts.n_surface, n_seen);
}

/* Tells once when heads contradict each other on most of what two or more have seen since the
 * last judgement. */
static void
gst_uv_map_judge_heads (GstUVMap * self)
{
  if (2 * self->n_contradicted > self->n_compared
      && !self->warned_contradiction) {
    self->warned_contradiction = TRUE;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("Heads contradict each other on %.0f%% of the vertices that two or "
            "more see.", 100. * (gdouble) self->n_contradicted
            / (gdouble) self->n_compared),
        ("See that all heads are of one rig.json and that the cameras stand "
            "as when it was made; else calibrate again, or lower "
            "significance."));
  }
  self->n_sets = 0;
  self->n_compared = self->n_contradicted = 0;
}

static void
gst_uv_map_check (GstUVMap * self, const ClothUVJoined * joined)
{
  const guint64 lost = joined->n_contradicted + joined->n_left_out;

  self->n_compared += joined->n_joined + lost;
  self->n_contradicted += lost;
  if (++self->n_sets >= CHECKED_SETS)
    gst_uv_map_judge_heads (self);
}

/* A film may end before the next judgement is due. Seen on the source pad, in the thread that
 * makes the meshes. */
static GstPadProbeReturn
gst_uv_map_sum_up (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  if (GST_EVENT_TYPE (GST_PAD_PROBE_INFO_EVENT (info)) == GST_EVENT_EOS)
    gst_uv_map_judge_heads (data);
  return GST_PAD_PROBE_OK;
}

static GstFlowReturn
gst_uv_map_process_set (GstClothSync * sync, GstBuffer ** views, guint n,
    guint64 mask, GstClockTime pts, GstClockTime duration, GstBuffer ** out)
{
  GstUVMap *self = GST_UV_MAP (sync);
  const guint n_vertices = (guint) self->shape.columns * self->shape.rows;
  ClothUVHead heads[CLOTH_UV_MAX_HEADS];
  GstClothUV *maps[CLOTH_UV_MAX_HEADS];
  GstReferenceTimestampMeta *stamp = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  ClothUVJoined joined;
  Settings settings;
  guint n_heads = 0;

  GST_OBJECT_LOCK (self);
  settings = self->settings;
  GST_OBJECT_UNLOCK (self);
  self->sequence++;
  for (guint i = 0; i < n; i++) {
    GstClothMatches *matches;
    GstClothDisparity *disparity;
    GArray *uv;

    if (!views[i])
      continue;
    if (!stamp)
      stamp = gst_buffer_get_reference_timestamp_meta (views[i], NULL);
    if (!gst_uv_map_look (self, i, views[i], &matches, &disparity))
      continue;
    if (gst_cloth_matches_get_columns (matches) != (guint) self->shape.columns
        || gst_cloth_matches_get_rows (matches) != (guint) self->shape.rows) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("The matches on sink_%u are of a grid of %u×%u vertices, but "
              "pattern has %d×%d.", i, gst_cloth_matches_get_columns (matches),
              gst_cloth_matches_get_rows (matches), self->shape.columns,
              self->shape.rows),
          ("Give siftmatch and this element the same pattern."));
      goto fail;
    }
    if (n_heads == 0)
      self->sequence = gst_cloth_matches_get_sequence (matches);
    gst_uv_map_do_head (self, i, &settings, matches, disparity,
        &heads[n_heads]);
    uv = self->head[i].uv;
    maps[n_heads++] =
        gst_cloth_uv_new (gst_cloth_disparity_get_camera (disparity),
        gst_cloth_disparity_get_sequence (disparity),
        gst_cloth_disparity_get_width (disparity),
        gst_cloth_disparity_get_height (disparity),
        (const gfloat *) uv->data, uv->len);
  }
  g_array_set_size (self->positions, 3 * n_vertices);
  g_array_set_size (self->covariances, 6 * n_vertices);
  g_byte_array_set_size (self->states, n_vertices);
  cloth_uv_join (heads, n_heads, n_vertices, settings.significance,
      (gfloat *) self->positions->data, self->states->data,
      (gfloat *) self->covariances->data, &joined);
  gst_uv_map_check (self, &joined);
  GST_LOG_OBJECT (self, "frame %" G_GUINT64_FORMAT ": %u vertices, %u of "
      "several heads, %u contradicted, %u views left out", self->sequence,
      joined.n_seen, joined.n_joined, joined.n_contradicted, joined.n_left_out);
  mesh = gst_cloth_mesh_new (self->sequence, n_vertices,
      (const gfloat *) self->positions->data, self->states->data,
      (const gfloat *) self->covariances->data);
  *out = gst_cloth_mesh_to_buffer (mesh);
  for (guint h = 0; h < n_heads; h++)
    gst_buffer_add_cloth_uv_meta (*out, maps[h]);
  if (stamp)
    gst_buffer_add_reference_timestamp_meta (*out, stamp->reference,
        stamp->timestamp, stamp->duration);
  return GST_FLOW_OK;

fail:
  for (guint h = 0; h < n_heads; h++)
    gst_cloth_uv_unref (maps[h]);
  return GST_FLOW_ERROR;
}

static void
gst_uv_map_reset (GstClothSync * sync)
{
  GstUVMap *self = GST_UV_MAP (sync);

  self->sequence = G_MAXUINT64; /* the first set's is 0 */
  self->n_sets = 0;
  self->n_compared = self->n_contradicted = 0;
  self->warned_contradiction = FALSE;
}

static GstPad *
gst_uv_map_request_new_pad (GstElement * element, GstPadTemplate * templ,
    const gchar * name, const GstCaps * caps)
{
  gboolean full;

  GST_OBJECT_LOCK (element);
  full = element->numsinkpads >= CLOTH_UV_MAX_HEADS;
  GST_OBJECT_UNLOCK (element);
  if (full) {
    GST_WARNING_OBJECT (element, "there are %d heads already, the most that "
        "can be", CLOTH_UV_MAX_HEADS);
    return NULL;
  }
  return GST_ELEMENT_CLASS (gst_uv_map_parent_class)->request_new_pad (element,
      templ, name, caps);
}

/* ---- GObject ---- */

static void
gst_uv_map_finalize (GObject * object)
{
  GstUVMap *self = GST_UV_MAP (object);

  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++)
    head_close (&self->head[i]);
  g_array_unref (self->positions);
  g_array_unref (self->covariances);
  g_byte_array_unref (self->states);
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  G_OBJECT_CLASS (gst_uv_map_parent_class)->finalize (object);
}

static Settings
get_defaults (void)
{
  return (Settings) {
  .significance = 0.001,.uv = cloth_uv_default_params (),.vertex =
        cloth_uv_vertex_default_params ()};
}

static void
gst_uv_map_class_init (GstUVMapClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstAggregatorClass *agg_class = GST_AGGREGATOR_CLASS (klass);
  GstClothSyncClass *sync_class = GST_CLOTH_SYNC_CLASS (klass);
  const Settings defaults = get_defaults ();

  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstUVMap,
          settings));
  object_class->finalize = gst_uv_map_finalize;
  element_class->request_new_pad = gst_uv_map_request_new_pad;
  agg_class->start = gst_uv_map_start;
  agg_class->stop = gst_uv_map_stop;
  sync_class->set_pad_caps = gst_uv_map_set_pad_caps;
  sync_class->negotiate_src = gst_uv_map_negotiate_src;
  sync_class->process_set = gst_uv_map_process_set;
  sync_class->reset = gst_uv_map_reset;
  sync_class->prefix = "uvmap";

  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &sink_template, GST_TYPE_CLOTH_SYNC_PAD);
  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &src_template, GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_set_static_metadata (element_class, "UV map",
      "Filter/Analyzer/Video",
      "Makes a mesh of a printed cloth from stereo heads' matches and disparities",
      "The gst-cloth developers");
}

static void
gst_uv_map_init (GstUVMap * self)
{
  self->settings = get_defaults ();
  self->fps_n = -1;
  self->positions = floats ();
  self->covariances = floats ();
  self->states = g_byte_array_new ();
  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++)
    self->view[i].camera = -1;
  gst_pad_add_probe (GST_AGGREGATOR_SRC_PAD (self),
      GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, gst_uv_map_sum_up, self, NULL);
}
