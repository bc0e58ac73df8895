/* silhouette: where the cloth is in a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-silhouette
 * @title: silhouette
 *
 * Finds the pixels of the cloth before a background that stands still: one that a picture
 * shows, or the median of the film's own. Shadows on the background are background. Ranges of
 * luma and chroma narrow the cloth down, or find it by themselves; so does one of disparities,
 * on pictures that `clothdisparity` has been over. The silhouette goes along
 * with the picture as #GstClothSilhouette; the picture itself stays as it is and where it is.
 *
 * ## A film's silhouettes as a stream
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! \
 *     silhouette background=background0.png camera=cam0 ! clothmetapay ! gdppay ! \
 *     filesink location=cam0.gdp
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstsilhouette.h"

#include <gst/cloth/cloth.h>

#include "elements/gstclothpaint.h"
#include "elements/gstclothproperties.h"
#include "gst/vision/mask/mask.h"

GST_DEBUG_CATEGORY_STATIC (silhouette_debug);
#define GST_CAT_DEFAULT silhouette_debug

/* The runs go into the metadata as they are. */
G_STATIC_ASSERT (sizeof (ClothRun) == sizeof (GstClothRun));
G_STATIC_ASSERT (G_STRUCT_OFFSET (ClothRun, end) ==
    G_STRUCT_OFFSET (GstClothRun, end));
G_STATIC_ASSERT (CLOTH_RUNS_MAX <= GST_CLOTH_MAX_RUNS);

/* Most pixels a side of a background: as of the film's pictures. */
#define MAX_PX GST_CLOTH_MAX_SILHOUETTE_SIZE

typedef struct
{
  gchar *background;
  guint learn, threads;
  ClothMaskParams mask;
} Settings;

struct _GstSilhouette
{
  GstClothFilter parent;

  /* with the object lock */
  Settings settings;

  /* streaming thread */
  GstSample *background;        /* NULL: none */
  GstVideoInfo film;            /* that the background is prepared for */
  ClothMask *mask;
  ClothPool *pool;
  guint until_sample;           /* pictures until the next one to learn from */
  gboolean warned;
  gboolean told;                /* that a picture has no disparities */
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)
#define ANY_TIME (GST_PARAM_MUTABLE_PLAYING | GST_PARAM_CONTROLLABLE)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"background", "Background",
    "Picture of the scene without the cloth, by this camera in the same place",
    G_TYPE_STRING, SETTING (background), GST_PARAM_MUTABLE_READY},
  {"learn", "Learn",
    "Without a background: take every so many-th picture as a sample, and the "
    "median of the last 15 samples as the background; 0: don't. The cloth must be "
    "elsewhere in more than half of them",
    G_TYPE_UINT, SETTING (learn), ANY_TIME, 0, 100000},
  {"significance", "Significance",
    "By how many standard deviations of noise a window must differ from the "
    "background in another light",
    G_TYPE_DOUBLE, SETTING (mask.significance), ANY_TIME, 0, 1000},
  {"shadow", "Shadow",
    "Least light of the background in a shadow, as a share of that without it",
    G_TYPE_DOUBLE, SETTING (mask.shadow), ANY_TIME, 0, 1},
  {"glow", "Glow",
    "Greatest light of the background, as a multiple of that in its picture",
    G_TYPE_DOUBLE, SETTING (mask.glow), ANY_TIME, 1, 10},
  {"radius", "Radius",
    "Of the window that is held against the background, px",
    G_TYPE_INT, SETTING (mask.radius), ANY_TIME, 1, CLOTH_MASK_MAX_RADIUS},
  {"thin", "Thin", "What is thinner than twice this and one is dropped, px",
    G_TYPE_INT, SETTING (mask.thin), ANY_TIME, 0, 32},
  {"least", "Least", "Pieces of fewer pixels are dropped",
    G_TYPE_UINT, SETTING (mask.least), ANY_TIME, 0, G_MAXINT},
  {"hole", "Hole", "Holes of at most so many pixels are filled",
    G_TYPE_UINT, SETTING (mask.hole), ANY_TIME, 0, G_MAXINT},
  {"luma-min", "Least luma", "Least luma of the cloth",
    G_TYPE_INT, SETTING (mask.low[0]), ANY_TIME, 0, 255},
  {"luma-max", "Greatest luma", "Greatest luma of the cloth",
    G_TYPE_INT, SETTING (mask.high[0]), ANY_TIME, 0, 255},
  {"u-min", "Least Cb", "Least Cb of the cloth",
    G_TYPE_INT, SETTING (mask.low[1]), ANY_TIME, 0, 255},
  {"u-max", "Greatest Cb", "Greatest Cb of the cloth",
    G_TYPE_INT, SETTING (mask.high[1]), ANY_TIME, 0, 255},
  {"v-min", "Least Cr", "Least Cr of the cloth",
    G_TYPE_INT, SETTING (mask.low[2]), ANY_TIME, 0, 255},
  {"v-max", "Greatest Cr", "Greatest Cr of the cloth",
    G_TYPE_INT, SETTING (mask.high[2]), ANY_TIME, 0, 255},
  {"disparity-min", "Least disparity",
    "Least disparity of the cloth, px, where the picture carries GstClothDisparity; "
    "what has none isn't cloth either",
    G_TYPE_DOUBLE, SETTING (mask.least_disparity), ANY_TIME, 0, G_MAXFLOAT},
  {"disparity-max", "Greatest disparity", "Greatest disparity of the cloth, px",
    G_TYPE_DOUBLE, SETTING (mask.most_disparity), ANY_TIME, 0, G_MAXFLOAT},
  {"threads", "Threads", "Threads that look; 0: one a processor",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_READY, 0, 1024},
};
/* *INDENT-ON* */

G_DEFINE_TYPE_WITH_CODE (GstSilhouette, gst_silhouette, GST_TYPE_CLOTH_FILTER,
    GST_DEBUG_CATEGORY_INIT (silhouette_debug, "silhouette", 0,
        "silhouettes of cloth"));
GST_ELEMENT_REGISTER_DEFINE (silhouette, "silhouette", GST_RANK_NONE,
    GST_TYPE_SILHOUETTE);

static void
gst_silhouette_stop (GstClothFilter * filter)
{
  GstSilhouette *self = GST_SILHOUETTE (filter);

  g_clear_pointer (&self->background, gst_sample_unref);
  g_clear_pointer (&self->mask, cloth_mask_free);
  g_clear_pointer (&self->pool, cloth_pool_free);
}

static gboolean
gst_silhouette_start (GstClothFilter * filter)
{
  GstSilhouette *self = GST_SILHOUETTE (filter);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;
  guint threads;

  GST_OBJECT_LOCK (self);
  path = g_strdup (self->settings.background);
  threads = self->settings.threads;
  GST_OBJECT_UNLOCK (self);
  if (path) {
    self->background = gst_cloth_load_picture (path, "Y444", MAX_PX, &error);
    if (!self->background) {
      GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
          ("Can't read the background: %s", error->message),
          ("Set background to a picture of the scene without the cloth, or "
              "leave it out and set learn."));
      return FALSE;
    }
  }
  gst_video_info_init (&self->film);
  self->mask = cloth_mask_new ();
  self->pool = cloth_pool_new (threads);
  self->until_sample = 0;
  self->warned = self->told = FALSE;
  return TRUE;
}

/* What was learnt of the background stays: it is of the camera, not of the film. */
static void
gst_silhouette_reset (GstClothFilter * filter)
{
  GST_SILHOUETTE (filter)->warned = FALSE;
}

/* Gives the mask the background in the format of this film. FALSE: it can't be, and an error
 * was posted. */
static gboolean
gst_silhouette_prepare_background (GstSilhouette * self,
    const GstVideoInfo * film)
{
  g_autoptr (GstBuffer) buffer = NULL;
  GstVideoInfo info;
  GstVideoFrame frame;
  ClothPlanarImage image;

  if (gst_video_info_is_equal (&self->film, film))
    return TRUE;
  buffer = gst_cloth_convert_picture (self->background, film,
      gst_cloth_filter_get_planar_format (film), &info);
  if (!buffer || !gst_video_frame_map (&frame, &info, buffer, GST_MAP_READ)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The background can't be converted to the film's %s.",
            GST_VIDEO_INFO_NAME (film)),
        ("Put videoconvert ! video/x-raw,format=I420 before %s.",
            GST_OBJECT_NAME (self)));
    return FALSE;
  }
  if (info.width != film->width || info.height != film->height) {
    gst_video_frame_unmap (&frame);
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The background has %d × %d pixels, the film %d × %d.", info.width,
            info.height, film->width, film->height),
        ("Set background to a picture by this very camera, and don't scale or "
            "crop the film before %s.", GST_OBJECT_NAME (self)));
    return FALSE;
  }
  gst_cloth_filter_view_planes (&frame, &image);
  cloth_mask_set_background (self->mask, &image);
  gst_video_frame_unmap (&frame);
  self->film = *film;
  return TRUE;
}

static gboolean
has_disparities (const ClothMaskParams * params)
{
  return params->least_disparity > 0
      || params->most_disparity < (gdouble) G_MAXFLOAT;
}

static gboolean
has_colours (const ClothMaskParams * params)
{
  for (guint c = 0; c < 3; c++)
    if (params->low[c] > 0 || params->high[c] < 255)
      return TRUE;
  return FALSE;
}

/* Brings the mask's background up to date. FALSE: an error was posted. */
static gboolean
gst_silhouette_update_background (GstSilhouette * self,
    const GstVideoFrame * video, const ClothPlanarImage * image,
    const Settings * settings)
{
  if (self->background)
    return gst_silhouette_prepare_background (self, &video->info);
  if (settings->learn > 0) {
    self->until_sample = MIN (self->until_sample, settings->learn);
    if (self->until_sample == 0
        || !cloth_mask_has_background (self->mask, image)) {
      cloth_mask_learn (self->mask, image, CLOTH_SIMD_BEST);
      self->until_sample = settings->learn;
    }
    self->until_sample--;
    return TRUE;
  }
  if (cloth_mask_has_background (self->mask, image)
      || has_colours (&settings->mask) || has_disparities (&settings->mask))
    return TRUE;
  GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
      ("Nothing tells the cloth from what is behind it."),
      ("Set background to a picture of the scene without the cloth; or learn, "
          "to have it learnt from the film; or a range, as luma-min or, behind "
          "clothdisparity, disparity-min."));
  return FALSE;
}

/* Gives @params the disparities that the picture carries, if they are asked for. FALSE: an error
 * was posted. */
static gboolean
gst_silhouette_take_disparities (GstSilhouette * self, GstBuffer * buffer,
    const ClothImage * luma, ClothMaskParams * params)
{
  const GstClothDisparity *disparity = gst_buffer_get_cloth_disparity (buffer);

  if (!has_disparities (params))
    return TRUE;
  if (disparity && gst_cloth_disparity_get_width (disparity) ==
      (guint) luma->width && gst_cloth_disparity_get_height (disparity) ==
      (guint) luma->height) {
    params->disparities = gst_cloth_disparity_get_disparities (disparity, NULL);
    return TRUE;
  }
  if (!disparity) {
    if (!self->told)
      GST_ELEMENT_WARNING (self, STREAM, FAILED,
          ("A picture carries no disparities, which disparity-min and "
              "disparity-max are of: they don't count for it."),
          ("Of others like it you are not told. If none does, put "
              "clothdisparity before %s.", GST_OBJECT_NAME (self)));
    self->told = TRUE;
    return TRUE;
  }
  GST_ELEMENT_ERROR (self, STREAM, FORMAT,
      ("The disparities are of %u × %u pixels, the picture of %d × %d.",
          gst_cloth_disparity_get_width (disparity),
          gst_cloth_disparity_get_height (disparity), luma->width,
          luma->height),
      ("Put %s before what scales the picture.", GST_OBJECT_NAME (self)));
  return FALSE;
}

static GstFlowReturn
gst_silhouette_analyse (GstClothFilter * filter,
    const GstClothFilterFrame * frame)
{
  GstSilhouette *self = GST_SILHOUETTE (filter);
  ClothPlanarImage image;
  const ClothRun *runs;
  Settings settings;
  guint n;

  GST_OBJECT_LOCK (self);
  settings = self->settings;
  GST_OBJECT_UNLOCK (self);
  image = frame->planes;
  if (!gst_silhouette_update_background (self, frame->video, &image, &settings)
      || !gst_silhouette_take_disparities (self, frame->buffer, &image.luma,
          &settings.mask))
    return GST_FLOW_ERROR;

  cloth_mask_run (self->mask, &settings.mask, &image, self->pool,
      CLOTH_SIMD_BEST);
  if (cloth_mask_was_cut (self->mask) && !self->warned) {
    GST_WARNING_OBJECT (self, "the silhouette is too ragged, its lower part is "
        "left out; raise significance or thin");
    self->warned = TRUE;
  }
  runs = cloth_mask_get_runs (self->mask, &n);
  /* where nothing else tells it, the cloth isn't the whole picture */
  if (!settings.mask.disparities && !has_colours (&settings.mask)
      && !cloth_mask_has_background (self->mask, &image))
    n = 0;
  gst_buffer_add_cloth_silhouette_meta (frame->buffer,
      gst_cloth_silhouette_new (frame->camera, frame->sequence,
          (guint) image.luma.width, (guint) image.luma.height,
          (const GstClothRun *) runs, n));
  GST_LOG_OBJECT (self, "%u runs", n);
  return GST_FLOW_OK;
}

static void
gst_silhouette_finalize (GObject * object)
{
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &GST_SILHOUETTE (object)->settings);
  G_OBJECT_CLASS (gst_silhouette_parent_class)->finalize (object);
}

static Settings
default_settings (void)
{
  const Settings defaults = { NULL, 0, 0, cloth_mask_default_params () };

  return defaults;
}

static void
gst_silhouette_class_init (GstSilhouetteClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstClothFilterClass *filter_class = GST_CLOTH_FILTER_CLASS (klass);
  const Settings defaults = default_settings ();

  object_class->finalize = gst_silhouette_finalize;
  filter_class->start = gst_silhouette_start;
  filter_class->stop = gst_silhouette_stop;
  filter_class->reset = gst_silhouette_reset;
  filter_class->analyse = gst_silhouette_analyse;

  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      G_STRUCT_OFFSET (GstSilhouette, settings));
  gst_element_class_set_static_metadata (GST_ELEMENT_CLASS (klass),
      "Silhouette", "Filter/Analyzer/Video",
      "Finds the pixels of the cloth before a background that stands still",
      "The gst-cloth developers");
}

static void
gst_silhouette_init (GstSilhouette * self)
{
  self->settings = default_settings ();
}
