/* clothdisparity: how far away the cloth is in the pictures of a stereo head.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-clothdisparity
 * @title: clothdisparity
 *
 * Joins the pictures of two or three cameras of a rig by time and finds a disparity for each
 * pixel of the first one's cloth. The picture on `sink_0` goes on as it is and where it is,
 * with #GstClothDisparity; those on the other pads are its partners, which may stand in any
 * direction beside it. Pictures are used as filmed: lenses are undone here.
 *
 * Cloth is what #GstClothSilhouette on the first picture says. Without one it is all that has
 * a disparity between those of `near` and `far`: what lies behind the cloth must then be
 * farther off than `far`.
 *
 * A picture one of whose partners is missing goes on without disparities. The first of each
 * camera gives a warning, the end of the stream an info message with their number.
 *
 * A sink pad is given its camera of `rig` by its own property `camera`, else by the order of
 * the pads.
 *
 * ## Depth as files
 * |[
 * gst-launch-1.0 clothdisparity name=d rig=rig.json sink_0::camera=cam0 \
 *     sink_1::camera=cam1 near=1 far=3 location=depth_%05d.pfm ! fakesink \
 *     filesrc location=cam0.mp4 ! decodebin ! silhouette background=background0.png ! \
 *     d.sink_0  filesrc location=cam1.mp4 ! decodebin ! d.sink_1
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothdisparity.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <math.h>

#include "elements/gstclothfilter.h"
#include "elements/gstclothpicture.h"
#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"
#include "elements/gsttriangulatepad.h"
#include "gst/file/pfm.h"
#include "gst/rig/rigfile.h"
#include "gst/vision/stereo/stereo.h"

GST_DEBUG_CATEGORY_STATIC (cloth_disparity_debug);
#define GST_CAT_DEFAULT cloth_disparity_debug

/* The states go into the metadata as they are. */
G_STATIC_ASSERT ((gint) CLOTH_DISPARITY_OUTSIDE == GST_CLOTH_DISPARITY_OUTSIDE);
G_STATIC_ASSERT ((gint) CLOTH_DISPARITY_HOLE == GST_CLOTH_DISPARITY_HOLE);
G_STATIC_ASSERT ((gint) CLOTH_DISPARITY_MEASURED ==
    GST_CLOTH_DISPARITY_MEASURED);
G_STATIC_ASSERT ((gint) CLOTH_DISPARITY_FILLED == GST_CLOTH_DISPARITY_FILLED);

/* Index of the pad whose pictures go on. */
#define HEAD 0
#define MAX_THREADS 1024

/* Of the cloth at an end of the range: what is no chance. */
#define MUCH 0.05
/* Of the cloth with a measured disparity: too little to be one; without a silhouette, of the
 * picture. */
#define LITTLE 0.2
#define HARDLY_ANY 0.005

/* What is told once. */
typedef enum
{
  TOLD_NEAR = 1, TOLD_FAR = 2, TOLD_EMPTY = 4, TOLD_LITTLE = 8
} Told;

typedef struct
{
  gchar *rig, *location;
  ClothStereoParams stereo;
  guint threads;
} Settings;

struct _GstStereoMatch
{
  GstClothSync parent;

  /* object lock */
  Settings settings;
  gboolean changed;
  guint64 n_lacking;            /* pictures that went on without disparities */

  /* streaming thread */
  GstTriangulateView view[GST_CLOTH_SYNC_MAX_PADS];
  GstVideoInfo info[CLOTH_STEREO_MAX_CAMERAS];
  GstCaps *caps;                /* of the head's pictures */
  gboolean knows_strides;       /* downstream, of GstVideoMeta */
  ClothRig *rig;
  gint cameras[CLOTH_STEREO_MAX_CAMERAS];       /* of rig, as stereo has them */
  guint n_cameras;
  ClothStereo *stereo;
  GstClothStereo *shared;       /* what all disparities have in common */
  ClothPool *pool;
  guint8 *mask;
  guint64 count;
  Told told;
  guint lacked;                 /* bits of the pads that pictures were missing of */
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)
#define ANY_TIME GST_PARAM_MUTABLE_PLAYING

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"rig", "Rig",
    "File rig.json with the calibrated cameras; a new one counts from the next "
    "pictures on",
    G_TYPE_STRING, SETTING (rig), ANY_TIME},
  {"near", "Near",
    "Least depth of the cloth, in m along the axis of the head. It gives the "
    "greatest disparity",
    G_TYPE_DOUBLE, SETTING (stereo.near), ANY_TIME, 1e-3, 1e6},
  {"far", "Far",
    "Greatest depth of the cloth, m",
    G_TYPE_DOUBLE, SETTING (stereo.far), ANY_TIME, 1e-3, 1e6},
  {"window", "Window",
    "Edge of the blocks that are compared, px, odd",
    G_TYPE_INT, SETTING (stereo.window), ANY_TIME, 1, 31},
  {"small-step", "Small step",
    "Penalty of a step of 1 px of disparity between neighbours, for each pixel of a "
    "block",
    G_TYPE_INT, SETTING (stereo.small_step), ANY_TIME, 0, 99},
  {"large-step", "Large step",
    "Penalty of a greater step; above small-step. With windows above 15 px at "
    "most 28000 / window² − 16, so that OpenCV's sums hold it",
    G_TYPE_INT, SETTING (stereo.large_step), ANY_TIME, 1, 100},
  {"uniqueness", "Uniqueness",
    "By how many percent the best disparity must beat the second",
    G_TYPE_INT, SETTING (stereo.uniqueness), ANY_TIME, 0, 100},
  {"speckle", "Speckle",
    "Pieces of fewer pixels are dropped; 0: none",
    G_TYPE_INT, SETTING (stereo.speckle), ANY_TIME, 0, 100000},
  {"left-right", "Left to right",
    "Greatest difference of the disparities from one picture to its partner's and "
    "back, px",
    G_TYPE_DOUBLE, SETTING (stereo.left_right), ANY_TIME, 0, 16},
  {"agree", "Agree",
    "Greatest difference of what two partners say, px of the first one's disparity",
    G_TYPE_DOUBLE, SETTING (stereo.agree), ANY_TIME, 1e-3, 1000},
  {"step", "Step",
    "Greatest difference of neighbours on one surface, px; more is an edge of depth",
    G_TYPE_DOUBLE, SETTING (stereo.surface.step), ANY_TIME, 1e-3, 1000},
  {"hole", "Hole", "Holes of at most so many pixels are filled",
    G_TYPE_UINT, SETTING (stereo.surface.hole), ANY_TIME, 0, G_MAXINT},
  {"fill-tolerance", "Tolerance of filling",
    "How exactly the equations of filling are solved, relative to their right side",
    G_TYPE_DOUBLE, SETTING (stereo.surface.tolerance), ANY_TIME, 1e-7, 1},
  {"half-width", "Half-width",
    "How far a measured disparity may be moved to smooth the surface, px; the "
    "paper's 0.5 is for whole numbers",
    G_TYPE_DOUBLE, SETTING (stereo.surface.half_width), ANY_TIME, 0, 64},
  {"narrowing", "Narrowing",
    "Factor of the half-width each time the picture is halved",
    G_TYPE_DOUBLE, SETTING (stereo.surface.narrowing), ANY_TIME, 0.1, 1},
  {"sweeps", "Sweeps", "How often each size of the surface is smoothed",
    G_TYPE_UINT, SETTING (stereo.surface.sweeps), ANY_TIME, 0, 10000},
  {"relaxation", "Relaxation", "Factor of a correction of the smoothing",
    G_TYPE_DOUBLE, SETTING (stereo.surface.relaxation), ANY_TIME, 0.01, 1.99},
  {"refine-radius", "Radius of refining",
    "Radius of the windows by which the pictures better the disparities, px",
    G_TYPE_INT, SETTING (stereo.refine.radius), ANY_TIME, 1, 64},
  {"refine-rounds", "Rounds of refining",
    "How often the pictures better the disparities; 0: not at all",
    G_TYPE_UINT, SETTING (stereo.refine.rounds), ANY_TIME, 0, 100},
  {"refine-outlier", "Outlier of refining",
    "Difference of two pictures at which it counts half, grey levels",
    G_TYPE_DOUBLE, SETTING (stereo.refine.outlier), ANY_TIME, 1e-3, 1e6},
  {"refine-damping", "Damping of refining",
    "Windows with no more squared gradient than this stay as they are, grey levels²",
    G_TYPE_DOUBLE, SETTING (stereo.refine.damping), ANY_TIME, 0, 1e9},
  {"refine-most", "Most of refining",
    "How far a disparity may be moved in one round, px",
    G_TYPE_DOUBLE, SETTING (stereo.refine.most), ANY_TIME, 0, 4},
  {"settle", "Settle",
    "How far a refined disparity may be moved to smooth the surface, px",
    G_TYPE_DOUBLE, SETTING (stereo.settle), ANY_TIME, 0, 64},
  {"location", "Location",
    "Also write each picture's disparities into a PFM file, infinity where there is "
    "none: a name with %05d for the picture's number, or a folder",
    G_TYPE_STRING, SETTING (location), GST_PARAM_MUTABLE_READY},
  {"threads", "Threads", "Threads that work; 0: one a processor",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_READY, 0, MAX_THREADS},
};
/* *INDENT-ON* */

static GstStaticPadTemplate sink_template =
GST_STATIC_PAD_TEMPLATE ("sink_%u", GST_PAD_SINK, GST_PAD_REQUEST,
    GST_STATIC_CAPS (GST_VIDEO_CAPS_MAKE (GST_CLOTH_FILTER_FORMATS)));
static GstStaticPadTemplate src_template =
GST_STATIC_PAD_TEMPLATE ("src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS (GST_VIDEO_CAPS_MAKE (GST_CLOTH_FILTER_FORMATS)));

GST_ELEMENT_REGISTER_DEFINE_WITH_CODE (clothdisparity, "clothdisparity",
    GST_RANK_NONE, GST_TYPE_STEREO_MATCH,
    GST_DEBUG_CATEGORY_INIT (cloth_disparity_debug, "clothdisparity", 0,
        "disparities of cloth"));

static gpointer gst_stereo_match_parent_class;

/* ---- files ---- */

/* Whether a name is one of files: with a single number. */
static gboolean
is_pattern (const gchar * location)
{
  const gchar *percent = strchr (location, '%');
  const gchar *end = percent ? percent + 1 + strspn (percent + 1,
      "0123456789") : NULL;

  return percent && *end == 'd' && end - percent <= 3
      && !strchr (end, '%') && (end == percent + 1 || percent[1] == '0');
}

/* Looks at the location, and makes the folder if it is one. FALSE: an error was posted. */
static gboolean
gst_stereo_match_check_location (GstStereoMatch * self)
{
  const gchar *location = self->settings.location;

  if (!location || is_pattern (location)) {
    return TRUE;
  }
  if (strchr (location, '%') || g_str_has_suffix (location, ".pfm")) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("“%s” can't be the name of each picture's file.", location),
        ("Set location to a name with %%05d where the picture's number shall "
            "be, and no other %%, or to a folder."));
    return FALSE;
  }
  if (g_mkdir_with_parents (location, 0777) != 0) {
    const gint code = errno;

    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_WRITE,
        ("The folder “%s” can't be made: %s", location, g_strerror (code)),
        ("Set location to a folder that may be written to, or to a name with "
            "%%05d."));
    return FALSE;
  }
  return TRUE;
}

/* Returns: (transfer full): the name of a picture's file */
static gchar *
name_file (const gchar * location, guint64 number)
{
  const gchar *percent = strchr (location, '%');
  const gchar *end = percent ? strchr (percent, 'd') : NULL;
  const gint width = percent ? atoi (percent + 1) : 5;
  g_autofree gchar *digits = g_strdup_printf ("%0*" G_GUINT64_FORMAT, width,
      number);

  if (!percent) {
    g_autofree gchar *name = g_strconcat (digits, ".pfm", NULL);

    return g_build_filename (location, name, NULL);
  }
  return g_strdup_printf ("%.*s%s%s", (gint) (percent - location), location,
      digits, end + 1);
}

static gboolean
gst_stereo_match_write (GstStereoMatch * self, const ClothDisparityMap * map,
    guint64 number)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;

  if (!self->settings.location) {
    return TRUE;
  }
  path = name_file (self->settings.location, number);
  if (cloth_pfm_write (path, map->disparities, map->width, map->height, &error)) {
    return TRUE;
  }
  gst_mesh_post_error (GST_ELEMENT (self), "write", path, TRUE, error);
  return FALSE;
}

/* ---- the head ---- */

static void
gst_stereo_match_forget_head (GstStereoMatch * self)
{
  g_clear_pointer (&self->stereo, cloth_stereo_free);
  g_clear_pointer (&self->shared, gst_cloth_stereo_unref);
  g_clear_pointer (&self->mask, g_free);
}

static gboolean
gst_stereo_match_load_rig (GstStereoMatch * self)
{
  g_autofree gchar *path = NULL;
  g_autoptr (GError) error = NULL;
  ClothRig *rig;

  GST_OBJECT_LOCK (self);
  path = g_strdup (self->settings.rig);
  GST_OBJECT_UNLOCK (self);
  if (!path) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("No cameras are known: the property rig is not set."),
        ("Set rig to the rig.json that gst-cloth-calibrate-1.0 has written."));
    return FALSE;
  }
  rig = cloth_rig_load (path, &error);
  if (!rig) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("The cameras could not be read: %s", error->message),
        ("Set rig to a rig.json; it is now \"%s\".", path));
    return FALSE;
  }
  gst_stereo_match_forget_head (self);
  cloth_rig_free (self->rig);
  self->rig = rig;
  return TRUE;
}

/* Finds the cameras of the pads. FALSE: an error was posted. @cameras, @n: (out): the head's
 * and its partners'. @moved: a camera's clock turned out to be another than the set was joined
 * by. */
static gboolean
gst_stereo_match_map (GstStereoMatch * self, gint * cameras, guint * n,
    gboolean * moved)
{
  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    self->view[i].carries = TRUE;
  }
  if (!gst_triangulate_views_map (GST_CLOTH_SYNC (self), self->view, self->rig,
          moved)) {
    return FALSE;
  }
  *n = 0;
  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    if (!self->view[i].present) {
      continue;
    }
    if (i >= CLOTH_STEREO_MAX_CAMERAS || i != *n) {
      *n = G_MAXUINT;           /* too many, or a pad is left out */
      break;
    }
    cameras[(*n)++] = self->view[i].camera;
  }
  if (*n < 2 || *n > CLOTH_STEREO_MAX_CAMERAS) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED,
        ("A stereo head has two or three cameras, on the pads sink_0, sink_1 and "
            "sink_2."),
        ("Link the camera whose pictures shall go on to sink_0, its partner to "
            "sink_1, and a second partner, if there is one, to sink_2."));
    return FALSE;
  }
  return TRUE;
}

/* Brings everything up to date with the properties and the pads. FALSE: an error was
 * posted. */
static gboolean
gst_stereo_match_prepare (GstStereoMatch * self, gboolean * moved)
{
  const ClothCamera *of[CLOTH_STEREO_MAX_CAMERAS];
  gint cameras[CLOTH_STEREO_MAX_CAMERAS] = { 0 };
  g_autoptr (GError) error = NULL;
  ClothStereoGeometry geometry;
  ClothStereoParams params;
  gboolean changed;
  gsize size;
  guint n;

  GST_OBJECT_LOCK (self);
  changed = self->changed;
  self->changed = FALSE;
  params = self->settings.stereo;
  GST_OBJECT_UNLOCK (self);
  if (((changed || !self->rig) && !gst_stereo_match_load_rig (self))
      || !gst_stereo_match_map (self, cameras, &n, moved)) {
    return FALSE;
  }
  if (self->stereo && n == self->n_cameras
      && memcmp (cameras, self->cameras, sizeof (cameras)) == 0) {
    return TRUE;
  }
  gst_stereo_match_forget_head (self);
  for (guint i = 0; i < n; i++) {
    of[i] = &self->rig->cameras[cameras[i]];
  }
  self->stereo = cloth_stereo_new (of, n, &params, &error);
  if (!self->stereo) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS, ("%s.", error->message),
        ("The cameras of %s can't be a stereo head like this.",
            GST_OBJECT_NAME (self)));
    return FALSE;
  }
  self->n_cameras = n;
  memcpy (self->cameras, cameras, sizeof (cameras));
  geometry = cloth_stereo_get_geometry (self->stereo);
  size = (gsize) geometry.width * (gsize) geometry.height;
  self->mask = g_malloc (size);
  self->shared = gst_cloth_stereo_new ((guint) geometry.width,
      (guint) geometry.height, geometry.rays, (guint) (2 * size),
      geometry.normal, geometry.focal_baseline, of[0]->R, of[0]->t, n);
  return TRUE;
}

/* ---- a set ---- */

/* The mask that the head's silhouette is. FALSE: an error was posted. */
static gboolean
gst_stereo_match_draw_mask (GstStereoMatch * self,
    const GstClothSilhouette * silhouette)
{
  const guint width = (guint) GST_VIDEO_INFO_WIDTH (&self->info[HEAD]);
  const guint height = (guint) GST_VIDEO_INFO_HEIGHT (&self->info[HEAD]);
  const GstClothRun *runs;
  guint n;

  if (gst_cloth_silhouette_get_width (silhouette) != width
      || gst_cloth_silhouette_get_height (silhouette) != height) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The silhouette has %u × %u pixels, its picture %u × %u.",
            gst_cloth_silhouette_get_width (silhouette),
            gst_cloth_silhouette_get_height (silhouette), width, height),
        ("Find the silhouette in the picture that comes here: put silhouette "
            "behind what scales it."));
    return FALSE;
  }
  memset (self->mask, 0, (gsize) width * height);
  runs = gst_cloth_silhouette_get_runs (silhouette, &n);
  for (guint i = 0; i < n; i++) {
    memset (self->mask + (gsize) runs[i].row * width + runs[i].begin, 255,
        (gsize) (runs[i].end - runs[i].begin));
  }
  return TRUE;
}

/* A picture that has lost a partner goes on as it is. */
static void
gst_stereo_match_lack (GstStereoMatch * self, guint pad, GstClockTime pts)
{
  GST_OBJECT_LOCK (self);
  self->n_lacking++;
  GST_OBJECT_UNLOCK (self);
  if (self->lacked >> pad & 1) {
    return;
  }
  self->lacked |= 1u << pad;
  GST_ELEMENT_WARNING (self, STREAM, FAILED,
      ("Camera \"%s\" (sink_%u) has no picture of %.3f s: pictures without "
          "all partners go on without disparities.",
          self->rig->cameras[self->view[pad].camera].name, pad,
          (gdouble) pts / GST_SECOND),
      ("Others like it are only counted. See that the cameras film at the same "
          "instants, that their clocks agree (offset_s of rig), or raise "
          "tolerance."));
}

/* Says what is lost, once. */
static void
gst_stereo_match_tell (GstStereoMatch * self, const ClothStereoResult * result,
    gboolean masked)
{
  const gdouble share =
      (gdouble) result->n_measured / (gdouble) MAX (result->n_mask, 1);
  gdouble near_end = 0, far_end = 0;

  for (guint k = 0; k + 1 < self->n_cameras; k++) {
    const ClothStereoBorder *border = &result->border[k];

    if (border->near_end > MUCH + border->chance) {
      near_end = fmax (near_end, border->near_end);
    }
    if (border->far_end > MUCH + border->chance) {
      far_end = fmax (far_end, border->far_end);
    }
  }
  if (near_end > 0 && !(self->told & TOLD_NEAR)) {
    self->told |= TOLD_NEAR;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("%.0f%% of what is found lies at the near end of the range or before "
            "it.", 100 * near_end),
        ("The cloth seems to come nearer than near: make near smaller."));
  }
  if (far_end > 0 && !(self->told & TOLD_FAR)) {
    self->told |= TOLD_FAR;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("%.0f%% of what is found lies at the far end of the range or behind "
            "it.", 100 * far_end),
        ("The cloth seems to go farther than far: make far larger."));
  }
  if (result->n_mask == 0) {
    if (!(self->told & TOLD_EMPTY)) {
      self->told |= TOLD_EMPTY;
      GST_ELEMENT_WARNING (self, STREAM, FAILED,
          ("The silhouette is empty, so there are no disparities."),
          ("See that silhouette finds the cloth: clothoverlay draws it."));
    }
  } else if (share < (masked ? LITTLE : HARDLY_ANY)
      && !(self->told & TOLD_LITTLE)) {
    self->told |= TOLD_LITTLE;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("Disparities were found for %.1f%% of the %s only.", 100 * share,
            masked ? "cloth" : "picture"),
        ("See that each pad has its own camera, that the cameras stand as when "
            "rig was made, that near and far are the cloth's, and that the cloth "
            "shows a print."));
  }
}

/* Puts the disparities of the mapped pictures on @buffer. */
static GstFlowReturn
gst_stereo_match_match (GstStereoMatch * self, const ClothImage * images,
    GstBuffer * buffer)
{
  const GstClothSilhouette *silhouette =
      gst_buffer_get_cloth_silhouette (buffer);
  const GstVideoInfo *info = &self->info[HEAD];
  const ClothImage mask =
      { self->mask, info->width, info->height, info->width };
  const guint64 number =
      gst_cloth_number_picture (gst_cloth_sync_get_segment (GST_CLOTH_SYNC
          (self), HEAD), GST_VIDEO_INFO_FPS_N (info),
      GST_VIDEO_INFO_FPS_D (info), buffer,
      self->count);
  g_autoptr (GError) error = NULL;
  GstClothDisparity *disparity;
  ClothStereoResult result;
  guint n;

  if (silhouette && !gst_stereo_match_draw_mask (self, silhouette)) {
    return GST_FLOW_ERROR;
  }
  if (!cloth_stereo_run (self->stereo, images, silhouette ? &mask : NULL,
          self->pool, &result, &error)) {
    GST_ELEMENT_ERROR (self, STREAM, FAILED, ("%s", error->message), (NULL));
    return GST_FLOW_ERROR;
  }
  gst_stereo_match_tell (self, &result, silhouette != NULL);
  n = (guint) (result.map.width * result.map.height);
  disparity =
      gst_cloth_disparity_new (self->rig->cameras[self->cameras[0]].name,
      number, self->shared, (gfloat) result.sigma, result.map.disparities, n,
      result.map.states, n);
  gst_buffer_add_cloth_disparity_meta (buffer, disparity);
  GST_LOG_OBJECT (self, "picture %" G_GUINT64_FORMAT ": %" G_GSIZE_FORMAT
      " of %" G_GSIZE_FORMAT " px measured, sigma %g px", number,
      result.n_measured, result.n_mask, result.sigma);
  return gst_stereo_match_write (self, &result.map, number) ? GST_FLOW_OK :
      GST_FLOW_ERROR;
}

/* Whether each pad has a picture; if not that is told. */
static gboolean
gst_stereo_match_is_whole (GstStereoMatch * self, GstBuffer ** views,
    GstClockTime pts)
{
  for (guint i = 1; i < self->n_cameras; i++) {
    if (!views[i]) {
      gst_stereo_match_lack (self, i, pts);
      return FALSE;
    }
  }
  return TRUE;
}

static GstFlowReturn
gst_stereo_match_process_set (GstClothSync * sync, GstBuffer ** views, guint n,
    guint64 mask, GstClockTime pts, GstClockTime duration, GstBuffer ** out)
{
  GstStereoMatch *self = GST_STEREO_MATCH (sync);
  GstVideoFrame frames[CLOTH_STEREO_MAX_CAMERAS];
  ClothImage images[CLOTH_STEREO_MAX_CAMERAS];
  GstFlowReturn ret = GST_FLOW_ERROR;
  gboolean moved;
  guint n_mapped = 0;

  if (!views[HEAD]) {
    g_autoptr (GstPad) head =
        gst_element_get_static_pad (GST_ELEMENT (self), "sink_0");

    /* partners without the picture that they would be of: not yet, or no more */
    return head && gst_aggregator_pad_is_eos (GST_AGGREGATOR_PAD (head)) ?
        GST_FLOW_EOS : GST_FLOW_OK;
  }
  if (!gst_stereo_match_prepare (self, &moved)) {
    return GST_FLOW_ERROR;
  }
  *out = g_steal_pointer (&views[HEAD]);
  if (!self->knows_strides
      && !gst_cloth_picture_make_plain (GST_ELEMENT (self), &self->info[HEAD],
          out)) {
    return GST_FLOW_ERROR;
  }
  if (moved) {
    GST_DEBUG_OBJECT (self, "these pictures are of different instants");
    gst_stereo_match_lack (self, 1, pts);
    return GST_FLOW_OK;
  }
  if (!gst_stereo_match_is_whole (self, views, pts)) {
    return GST_FLOW_OK;
  }
  *out = gst_buffer_make_writable (*out);
  for (; n_mapped < self->n_cameras; n_mapped++) {
    GstVideoFrame *frame = &frames[n_mapped];

    /* no reference for the map: the buffer must stay writable for its meta */
    if (!gst_cloth_picture_map (GST_ELEMENT (self), &self->info[n_mapped],
            n_mapped == HEAD ? *out : views[n_mapped],
            GST_MAP_READ | (GstMapFlags) GST_VIDEO_FRAME_MAP_FLAG_NO_REF,
            frame)) {
      goto done;
    }
    images[n_mapped] = (ClothImage) {
    GST_VIDEO_FRAME_COMP_DATA (frame, 0), GST_VIDEO_FRAME_WIDTH (frame),
          GST_VIDEO_FRAME_HEIGHT (frame), GST_VIDEO_FRAME_COMP_STRIDE (frame,
          0)};
  }
  ret = gst_stereo_match_match (self, images, *out);
  self->count++;

done:
  while (n_mapped > 0) {
    gst_video_frame_unmap (&frames[--n_mapped]);
  }
  return ret;
}

/* ---- GstClothSync ---- */

static gboolean
gst_stereo_match_set_pad_caps (GstClothSync * sync, guint index, GstCaps * caps)
{
  GstStereoMatch *self = GST_STEREO_MATCH (sync);

  if (index == HEAD) {
    gst_caps_replace (&self->caps, caps);
  }
  if (index >= CLOTH_STEREO_MAX_CAMERAS) {
    caps = NULL;                /* too many pads are told of when they are mapped */
  }
  if (caps && !gst_video_info_from_caps (&self->info[index], caps)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("Bad video caps."),
        ("%" GST_PTR_FORMAT, caps));
    return FALSE;
  }
  return gst_triangulate_view_set_caps (&self->view[index], GST_ELEMENT (self),
      index, caps);
}

static GstFlowReturn
gst_stereo_match_negotiate_src (GstClothSync * sync, GstCaps * downstream,
    GstCaps ** caps)
{
  GstStereoMatch *self = GST_STEREO_MATCH (sync);
  gboolean moved;

  if (!self->caps) {
    return GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  /* now, so that the first pictures are joined by the cameras' clocks already */
  if (!gst_stereo_match_prepare (self, &moved)) {
    return GST_FLOW_ERROR;
  }
  *caps = gst_caps_ref (self->caps);
  return GST_FLOW_OK;
}

static void
gst_stereo_match_reset (GstClothSync * sync)
{
  GST_STEREO_MATCH (sync)->count = 0;
}

static const gchar *
gst_stereo_match_get_camera (GstClothSync * sync, guint index)
{
  GstStereoMatch *self = GST_STEREO_MATCH (sync);
  const gint camera = self->view[index].camera;

  return self->rig && camera >= 0 ? self->rig->cameras[camera].name : NULL;
}

/* ---- GstAggregator ---- */

/* Whatever layout the pictures come in they go on in: downstream is asked whether it can
 * read that. */
static gboolean
gst_stereo_match_decide_allocation (GstAggregator * agg, GstQuery * query)
{
  GST_STEREO_MATCH (agg)->knows_strides =
      gst_query_find_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL);
  return TRUE;
}

static gboolean
gst_stereo_match_sink_query (GstAggregator * agg, GstAggregatorPad * pad,
    GstQuery * query)
{
  if (GST_QUERY_TYPE (query) == GST_QUERY_CAPS
      && GST_CLOTH_SYNC_PAD (pad)->index == HEAD) {
    gst_cloth_picture_proxy_caps (GST_PAD (pad), GST_AGGREGATOR_SRC_PAD (agg),
        query);
    return TRUE;
  }
  return GST_AGGREGATOR_CLASS (gst_stereo_match_parent_class)->sink_query (agg,
      pad, query);
}

static gboolean
gst_stereo_match_src_query (GstAggregator * agg, GstQuery * query)
{
  g_autoptr (GstPad) head =
      gst_element_get_static_pad (GST_ELEMENT (agg), "sink_0");

  if (GST_QUERY_TYPE (query) == GST_QUERY_CAPS && head) {
    gst_cloth_picture_proxy_caps (GST_AGGREGATOR_SRC_PAD (agg), head, query);
    return TRUE;
  }
  return GST_AGGREGATOR_CLASS (gst_stereo_match_parent_class)->src_query (agg,
      query);
}

static void
gst_stereo_match_forget (GstStereoMatch * self)
{
  gst_stereo_match_forget_head (self);
  g_clear_pointer (&self->rig, cloth_rig_free);
  g_clear_pointer (&self->pool, cloth_pool_free);
  gst_caps_replace (&self->caps, NULL);
  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    gst_triangulate_view_forget (&self->view[i]);
  }
}

static gboolean
gst_stereo_match_start (GstAggregator * agg)
{
  GstStereoMatch *self = GST_STEREO_MATCH (agg);

  GST_OBJECT_LOCK (self);
  self->n_lacking = 0;
  self->changed = FALSE;
  GST_OBJECT_UNLOCK (self);
  self->told = 0;
  self->lacked = 0;
  self->pool = cloth_pool_new (self->settings.threads);
  if (GST_AGGREGATOR_CLASS (gst_stereo_match_parent_class)->start (agg)
      && gst_stereo_match_check_location (self)
      && gst_stereo_match_load_rig (self)) {
    return TRUE;
  }
  /* stop is not called then */
  gst_stereo_match_forget (self);
  return FALSE;
}

static gboolean
gst_stereo_match_stop (GstAggregator * agg)
{
  gst_stereo_match_forget (GST_STEREO_MATCH (agg));
  return GST_AGGREGATOR_CLASS (gst_stereo_match_parent_class)->stop (agg);
}

/* At the end of the stream, seen on the source pad, says how many pictures lacked a
 * partner. */
static GstPadProbeReturn
sum_up (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  GstStereoMatch *self = data;
  guint64 n;

  if (GST_EVENT_TYPE (GST_PAD_PROBE_INFO_EVENT (info)) != GST_EVENT_EOS) {
    return GST_PAD_PROBE_OK;
  }
  GST_OBJECT_LOCK (self);
  n = self->n_lacking;
  self->n_lacking = 0;
  GST_OBJECT_UNLOCK (self);
  if (n > 0) {
    GST_ELEMENT_INFO_WITH_DETAILS (self, STREAM, FAILED,
        ("%" G_GUINT64_FORMAT " picture%s went on without disparities.", n,
            n == 1 ? "" : "s"),
        ("Pictures of a partner were missing."),
        ("lacking", G_TYPE_UINT64, n, NULL));
  }
  return GST_PAD_PROBE_OK;
}

/* ---- GObject ---- */

static void
gst_stereo_match_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  GstStereoMatch *self = GST_STEREO_MATCH (object);

  gst_cloth_set_property (object, id, value, pspec);
  GST_OBJECT_LOCK (self);
  self->changed = TRUE;
  GST_OBJECT_UNLOCK (self);
}

static void
gst_stereo_match_finalize (GObject * object)
{
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &GST_STEREO_MATCH (object)->settings);
  G_OBJECT_CLASS (gst_stereo_match_parent_class)->finalize (object);
}

static Settings
default_settings (void)
{
  const Settings defaults = {.stereo = cloth_stereo_default_params () };

  return defaults;
}

static void
gst_stereo_match_class_init (gpointer klass, gpointer data)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstAggregatorClass *agg_class = GST_AGGREGATOR_CLASS (klass);
  GstClothSyncClass *sync_class = GST_CLOTH_SYNC_CLASS (klass);
  const Settings defaults = default_settings ();

  gst_stereo_match_parent_class = g_type_class_peek_parent (klass);
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, G_STRUCT_OFFSET (GstStereoMatch,
          settings));
  object_class->set_property = gst_stereo_match_set_property;
  object_class->finalize = gst_stereo_match_finalize;
  element_class->request_new_pad = gst_triangulate_pad_request_new;
  element_class->release_pad = gst_triangulate_pad_release;
  agg_class->decide_allocation = gst_stereo_match_decide_allocation;
  agg_class->sink_query = gst_stereo_match_sink_query;
  agg_class->src_query = gst_stereo_match_src_query;
  agg_class->start = gst_stereo_match_start;
  agg_class->stop = gst_stereo_match_stop;
  sync_class->set_pad_caps = gst_stereo_match_set_pad_caps;
  sync_class->negotiate_src = gst_stereo_match_negotiate_src;
  sync_class->process_set = gst_stereo_match_process_set;
  sync_class->reset = gst_stereo_match_reset;
  sync_class->get_camera = gst_stereo_match_get_camera;
  sync_class->prefix = "clothdisparity";

  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &sink_template, GST_TYPE_TRIANGULATE_PAD);
  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &src_template, GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_set_static_metadata (element_class, "Cloth disparity",
      "Filter/Analyzer/Video",
      "Finds how far away the cloth is at each pixel of a stereo head's picture",
      "The gst-cloth developers");
}

static void
gst_stereo_match_init (GTypeInstance * instance, gpointer klass)
{
  GstStereoMatch *self = GST_STEREO_MATCH (instance);

  self->settings = default_settings ();
  gst_pad_add_probe (GST_AGGREGATOR_SRC_PAD (self),
      GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, sum_up, self, NULL);
  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    self->view[i].camera = -1;
  }
}

/* In C the type has another name than GstClothDisparity, the payload that it puts on pictures.
 * What users see of it, also in the names of its instances, is the element's name. */
GType
gst_stereo_match_get_type (void)
{
  static const GInterfaceInfo proxy = { gst_triangulate_pad_child_proxy_init,
    NULL, NULL
  };
  static gsize once;

  if (g_once_init_enter (&once)) {
    const GType type = g_type_register_static_simple (GST_TYPE_CLOTH_SYNC,
        "GstClothdisparity", sizeof (GstStereoMatchClass),
        gst_stereo_match_class_init, sizeof (GstStereoMatch),
        gst_stereo_match_init, 0);

    g_type_add_interface_static (type, GST_TYPE_CHILD_PROXY, &proxy);
    g_once_init_leave (&once, type);
  }
  return once;
}
