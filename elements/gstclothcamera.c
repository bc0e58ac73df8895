/* clothcamera: films a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-clothcamera
 * @title: clothcamera
 *
 * Draws the cloth of a mesh stream as the camera `camera` of `rig` films it: in
 * perspective, with what hides what, lens, light and, as far as asked for, rolling
 * shutter, motion blur, defocus, noise and more (`effects`). On its printed side the
 * cloth carries a `pattern` or any picture as `texture`.
 *
 * Without a `rig` the view is free: from `azimuth` and `elevation`, all of the first mesh
 * in the picture, which may be of any size.
 *
 * Otherwise pictures are as large as the rig says. They have the times of the meshes. Effects
 * that look at the cloth between two meshes hold pictures back until the meshes around
 * them are there.
 *
 * A damaged mesh gives no picture and is counted in `dropped`; the first gives a warning, the
 * end of the stream an info message with their number. With `strict`, for files, the first is
 * an error. A mesh counts as damaged, too, when the upright boxes around its triangles, each
 * as far as it lies in the picture, cover that more than 256 times, and 100 million pixels.
 * A layer of cloth meshed by about as many columns as rows covers it twice, or, seen aslant,
 * eight times.
 *
 * ## Example
 * |[
 * gst-launch-1.0 meshsrc location=take ! clothcamera rig=rig.json camera=cam0 \
 *     pattern=pattern.json effects="noise,sigma=3; rolling_shutter,seconds=0.01" ! \
 *     videoconvert ! autovideosink
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothcamera.h"

#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <math.h>
#include <string.h>

#include "elements/gstclothdamage.h"
#include "elements/gstclothpaint.h"
#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"
#include "gst/render/render.h"
#include "gst/rig/orbit.h"

GST_DEBUG_CATEGORY_STATIC (cloth_camera_debug);
#define GST_CAT_DEFAULT cloth_camera_debug

/* So many times the picture's area the boxes around all triangles may cover, hidden ones
 * included: cloth in a heap has some tens of layers. In small pictures it is so many samples
 * at least: a million triangles of one each. */
#define MOST_LAYERS 256
#define LEAST_SAMPLES 1e8

/* Of pictures of the free view, which may be of any size. */
#define DEFAULT_WIDTH 1280
#define DEFAULT_HEIGHT 720

typedef struct
{
  gchar *rig, *camera, *pattern, *texture, *effects;
  gdouble azimuth, elevation, distance;
  guint64 seed;
  guint sides, threads;
  GstClothDamage damage;
} Settings;

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)
#define ANY_TIME (GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"rig", "Rig",
    "Calibration file (rig.json) that has the camera; without one the view is free",
    G_TYPE_STRING, SETTING (rig), GST_PARAM_MUTABLE_READY},
  {"camera", "Camera",
    "Name in the rig of the camera that films; may be left out when the rig has "
    "one camera",
    G_TYPE_STRING, SETTING (camera), GST_PARAM_MUTABLE_READY},
  {"pattern", "Pattern",
    "Pattern file (pattern.json) that is printed on the cloth: squares, coloured "
    "dots or any picture",
    G_TYPE_STRING, SETTING (pattern), GST_PARAM_MUTABLE_READY},
  {"texture", "Texture",
    "Picture file that is printed over the whole cloth, instead of a pattern",
    G_TYPE_STRING, SETTING (texture), GST_PARAM_MUTABLE_READY},
  {"sides", "Sides",
    "Sides of the cloth that show the print; 2: the back shows it mirrored, as "
    "where it soaks through. A pattern of kind picture that says 2 has both",
    G_TYPE_UINT, SETTING (sides), GST_PARAM_MUTABLE_READY, 1, 2},
  {"effects", "Effects",
    "Camera and image effects, as “noise,sigma=3; "
    "rolling_shutter,seconds=0.01”",
    G_TYPE_STRING, SETTING (effects), GST_PARAM_MUTABLE_READY},
  {"seed", "Seed", "Seed of the noise and of which pictures are lost",
    G_TYPE_UINT64, SETTING (seed), GST_PARAM_MUTABLE_READY},
  {"threads", "Threads", "Threads that draw; 0: one a processor",
    G_TYPE_UINT, SETTING (threads), GST_PARAM_MUTABLE_READY, 0, 1024},
  {"azimuth", "azimuth",
    "Free view: side from which the cloth is seen, degrees counter-clockwise "
    "from above; 0: from −y, 90: from +x",
    G_TYPE_DOUBLE, SETTING (azimuth), ANY_TIME, -3600, 3600},
  {"elevation", "elevation",
    "Free view: height from which the cloth is seen, degrees above the horizon",
    G_TYPE_DOUBLE, SETTING (elevation), ANY_TIME, -90, 90},
  {"distance", "distance",
    "Free view: distance from the middle of the first mesh, m; 0: so far that "
    "all of that mesh is seen from any side",
    G_TYPE_DOUBLE, SETTING (distance), ANY_TIME, 0, 1000},
  GST_CLOTH_DAMAGE_PROPERTIES (Settings, damage),
};
/* *INDENT-ON* */

static const Settings default_settings = {.elevation = 15,.sides = 1 };

/* The format of the pictures, and the RGB that those of luma and chroma come from. */
typedef struct
{
  GstVideoInfo info, drawn;
  GstVideoConverter *converter; /* NULL: drawn as it leaves */
  GstBuffer *rgb;
} Output;

/* One mesh of the window around the picture that is drawn. */
typedef struct
{
  GstBuffer *buffer;            /* its times and flags */
  guint64 sequence;
  gdouble time_s;
  gdouble *positions;
} Frame;

struct _GstClothCamera
{
  GstBaseTransform parent;

  /* with the object lock */
  Settings settings;
  GstClockTime latency;

  gint stopped;                 /* atomic: nobody waits for the picture any more */

  /* from start to stop */
  ClothCapture capture;
  gboolean free_view;           /* without a rig */
  ClothOrbit orbit;             /* of the free view */
  gboolean framed;              /* the orbit knows where the cloth is */
  gboolean still;               /* a picture shows the mesh of its own time only */

  /* streaming thread */
  GstCaps *mesh_caps;           /* that the renderer is made for */
  Output output;
  ClothRenderer *renderer;
  ClothPaint *paint;
  ClothRenderStyle style;
  guint n_vertices;
  gint fps_n, fps_d;
  GPtrArray *window;            /* of Frame, as they came */
  GPtrArray *spare;             /* of Frame, to be used again */
  guint next;                   /* in window: to be drawn next */
  guint64 count;                /* of meshes, since the last reset */
  gboolean draining;
  GstBuffer *last;              /* picture, to stand in for a lost one */
  GArray *times;                /* of gdouble, with positions */
  GPtrArray *positions;
};

#define FORMATS "{ BGRx, RGBx, xRGB, xBGR, RGB, BGR, GRAY8, I420, NV12 }"

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS ("video/x-raw, format="
        FORMATS ", width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ], "
        "framerate=(fraction)[ 0/1, max ]"));

G_DEFINE_TYPE (GstClothCamera, gst_cloth_camera, GST_TYPE_BASE_TRANSFORM);
GST_ELEMENT_REGISTER_DEFINE (clothcamera, "clothcamera", GST_RANK_NONE,
    GST_TYPE_CLOTH_CAMERA);

/* ---- the formats of pictures: drawn in them, or drawn in RGB and converted ---- */

static void
output_clear (Output * output)
{
  g_clear_pointer (&output->converter, gst_video_converter_free);
  gst_clear_buffer (&output->rgb);
}

/* Pictures of luma and chroma are computed by GStreamer from RGB, with the matrix, the
 * range and the sites of chroma that the caps say. FALSE: @caps are no video. */
static gboolean
output_set (Output * output, GstCaps * caps)
{
  output_clear (output);
  if (!gst_video_info_from_caps (&output->info, caps))
    return FALSE;
  output->drawn = output->info;
  if (!GST_VIDEO_INFO_IS_YUV (&output->info))
    return TRUE;
  if (!gst_video_info_set_format (&output->drawn, GST_VIDEO_FORMAT_RGBx,
          GST_VIDEO_INFO_WIDTH (&output->info),
          GST_VIDEO_INFO_HEIGHT (&output->info)))
    return FALSE;
  output->drawn.fps_n = GST_VIDEO_INFO_FPS_N (&output->info);
  output->drawn.fps_d = GST_VIDEO_INFO_FPS_D (&output->info);
  /* one thread, so that no seam between threads can show */
  output->converter = gst_video_converter_new (&output->drawn, &output->info,
      NULL);
  if (!output->converter)
    return FALSE;
  output->rgb = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE
      (&output->drawn), NULL);
  return TRUE;
}

/* Maps @picture, and what is to be drawn into: @picture itself or the RGB before. */
static gboolean
output_map (Output * output,
    GstBuffer * picture, GstVideoFrame * frame, GstVideoFrame * drawn)
{
  if (!gst_video_frame_map (frame, &output->info, picture, GST_MAP_WRITE))
    return FALSE;
  if (!output->converter) {
    *drawn = *frame;
    return TRUE;
  }
  if (gst_video_frame_map (drawn, &output->drawn, output->rgb,
          GST_MAP_READWRITE))
    return TRUE;
  gst_video_frame_unmap (frame);
  return FALSE;
}

/* To be called when all is drawn. */
static void
output_unmap (Output * output, GstVideoFrame * frame, GstVideoFrame * drawn)
{
  if (output->converter) {
    gst_video_converter_frame (output->converter, drawn, frame);
    gst_video_frame_unmap (drawn);
  }
  gst_video_frame_unmap (frame);
}

/* ---- the window of meshes ---- */

static void
frame_free (gpointer data)
{
  Frame *frame = data;

  gst_clear_buffer (&frame->buffer);
  g_free (frame->positions);
  g_free (frame);
}

static void
drop_head (GstClothCamera * self)
{
  Frame *frame = g_ptr_array_steal_index (self->window, 0);

  gst_clear_buffer (&frame->buffer);
  g_ptr_array_add (self->spare, frame);
}

static void
gst_cloth_camera_reset (GstClothCamera * self)
{
  while (self->window->len > 0)
    drop_head (self);
  self->next = 0;
  self->count = 0;
  gst_clear_buffer (&self->last);
}

static Frame *
frame_at (GstClothCamera * self, guint index)
{
  return g_ptr_array_index (self->window, index);
}

static gboolean
is_backwards (GstClothCamera * self)
{
  return GST_BASE_TRANSFORM (self)->segment.rate < 0;
}

/* The span of time that the picture of time @time_s shows. */
static void
get_span (GstClothCamera * self, gdouble time_s, gdouble span[2])
{
  const ClothCamera *camera = &self->capture.camera;

  span[0] = time_s - camera->offset_s + MIN (camera->rolling_shutter_s, 0);
  span[1] = time_s - camera->offset_s + MAX (camera->rolling_shutter_s, 0)
      + self->capture.exposure_s;
}

/* Are there a mesh behind the span of the next picture and one more, for its slope? */
static gboolean
is_ready (GstClothCamera * self)
{
  gdouble span[2], reached;

  if (self->next >= self->window->len)
    return FALSE;
  if (self->still || self->draining)
    return TRUE;
  if (self->window->len < 2)
    return FALSE;
  get_span (self, frame_at (self, self->next)->time_s, span);
  reached = frame_at (self, self->window->len - 2)->time_s;
  return is_backwards (self) ? reached <= span[0] : reached >= span[1];
}

/* Two meshes before the span of the next picture are enough. */
static void
prune (GstClothCamera * self)
{
  while (self->next > 0 && self->window->len > 2) {
    if (!self->still) {
      const guint at = MIN (self->next, self->window->len - 1);
      const gdouble third = frame_at (self, 2)->time_s;
      gdouble span[2];

      get_span (self, frame_at (self, at)->time_s, span);
      if (is_backwards (self) ? third < span[1] : third > span[0])
        break;
    }
    drop_head (self);
    self->next--;
  }
}

static GstFlowReturn
gst_cloth_camera_submit_input_buffer (GstBaseTransform * trans,
    gboolean is_discont, GstBuffer * input)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (trans);
  g_autoptr (GstBuffer) buffer = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GError) error = NULL;
  const gfloat *positions;
  Frame *frame;
  /* negotiates, and with qos drops what is late before it is drawn */
  const GstFlowReturn flow =
      GST_BASE_TRANSFORM_CLASS (gst_cloth_camera_parent_class)
      ->submit_input_buffer (trans, is_discont, input);

  buffer = g_steal_pointer (&trans->queued_buf);
  if (flow != GST_FLOW_OK)
    return flow;
  if (!self->renderer)
    return GST_FLOW_NOT_NEGOTIATED;
  mesh = gst_cloth_parse_mesh (buffer, self->n_vertices, &error);
  if (!mesh) {
    /* those without a time that come after it keep their own */
    self->count++;
    return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
        error);
  }
  frame = self->spare->len > 0 ?
      g_ptr_array_steal_index_fast (self->spare, self->spare->len - 1) :
      g_new0 (Frame, 1);
  if (!frame->positions)
    frame->positions = g_new (gdouble, 3 * (gsize) self->n_vertices);
  positions = gst_cloth_mesh_get_positions (mesh, NULL);
  for (gsize i = 0; i < 3 * (gsize) self->n_vertices; i++)
    frame->positions[i] = positions[i];
  frame->sequence = gst_cloth_mesh_get_sequence (mesh);
  if (GST_BUFFER_PTS_IS_VALID (buffer))
    frame->time_s = (gdouble) GST_BUFFER_PTS (buffer) / GST_SECOND;
  else
    frame->time_s = self->fps_n > 0 ?
        (gdouble) self->count * self->fps_d / self->fps_n : 0;
  frame->buffer = g_steal_pointer (&buffer);
  g_ptr_array_add (self->window, frame);
  self->count++;
  if (!self->still && self->window->len > 1) {
    const gdouble before = frame_at (self, self->window->len - 2)->time_s;

    if (is_backwards (self) ? frame->time_s >= before : frame->time_s <= before) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("A mesh of %g s comes after one of %g s: effects that look between "
              "meshes need rising times.", frame->time_s, before),
          ("Mend the times, or leave out of effects: rolling_shutter, "
              "sync_offset, motion_blur."));
      return GST_FLOW_ERROR;
    }
  }
  return GST_FLOW_OK;
}

/* ---- pictures ---- */

/* What wasn't drawn: nobody wants it, its mesh is none, or it is too large. */
static GstFlowReturn
give_up (GstClothCamera * self, const ClothWork * work)
{
  const gint width = self->capture.camera.width;
  const gint height = self->capture.camera.height;
  g_autoptr (GError) error = NULL;

  if (cloth_work_is_stopped (work))
    return GST_FLOW_FLUSHING;
  if (work->left_out) {
    g_set_error (&error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_LIMIT,
        "The boxes around the mesh's triangles cover the picture too often, "
        "more than %.0f times", MAX (MOST_LAYERS, LEAST_SAMPLES /
            ((gdouble) width * height)));
    return gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
        error);
  }
  GST_ELEMENT_ERROR (self, RESOURCE, NO_SPACE_LEFT,
      ("There is no memory for a picture of %d×%d.", width, height),
      ("Take a smaller one: width and height of the caps, or of the camera in "
          "the rig."));
  return GST_FLOW_ERROR;
}

/* Leaves *@drawn FALSE when there is no picture. */
static GstFlowReturn
draw (GstClothCamera * self, const Frame * frame, GstVideoFrame * video,
    gboolean * drawn)
{
  const ClothCamera *camera = &self->capture.camera;
  ClothWork work = { MAX (LEAST_SAMPLES,
        MOST_LAYERS * (gdouble) camera->width * camera->height),
    &self->stopped, FALSE
  };
  const gboolean grey = GST_VIDEO_INFO_IS_GRAY (&video->info);
  const guint n_planes = grey ? 1 : 3;
  ClothMotion motion = { self->n_vertices, 0 };
  guint8 *planes[3];
  gint strides[3];

  g_array_set_size (self->times, 0);
  g_ptr_array_set_size (self->positions, 0);
  if (self->still) {
    g_array_append_val (self->times, frame->time_s);
    g_ptr_array_add (self->positions, frame->positions);
  } else {
    const guint n = self->window->len;

    for (guint i = 0; i < n; i++) {
      const Frame *one = frame_at (self, is_backwards (self) ? n - 1 - i : i);

      g_array_append_val (self->times, one->time_s);
      g_ptr_array_add (self->positions, one->positions);
    }
  }
  motion.n_frames = self->times->len;
  motion.times = (const gdouble *) self->times->data;
  motion.positions = (const gdouble * const *) self->positions->pdata;
  for (guint c = 0; c < n_planes; c++) {
    planes[c] = GST_VIDEO_FRAME_COMP_DATA (video, c);
    strides[c] = GST_VIDEO_FRAME_COMP_STRIDE (video, c);
  }
  /* the byte that no colour uses */
  if (GST_VIDEO_FRAME_COMP_PSTRIDE (video, 0) == 4)
    for (gint y = 0; y < GST_VIDEO_FRAME_HEIGHT (video); y++)
      memset ((guint8 *) GST_VIDEO_FRAME_PLANE_DATA (video, 0)
          + (gssize) y * strides[0], 0xff, 4 * (gsize)
          GST_VIDEO_FRAME_WIDTH (video));
  *drawn = FALSE;
  if (!cloth_renderer_draw (self->renderer, self->paint, &self->capture,
          &self->style, &motion, frame->time_s, &work))
    return give_up (self, &work);
  cloth_renderer_develop (self->renderer, &self->capture, frame->sequence,
      self->settings.seed, n_planes, planes, strides,
      GST_VIDEO_FRAME_COMP_PSTRIDE (video, 0), &work);
  if (cloth_work_is_stopped (&work))
    return GST_FLOW_FLUSHING;
  *drawn = TRUE;
  return GST_FLOW_OK;
}

/* About where the cloth was when it was first seen, from where the settings say. */
static void
aim (GstClothCamera * self, const Frame * frame)
{
  GstClockTime time = gst_cloth_stream_time (&GST_BASE_TRANSFORM
      (self)->segment, frame->buffer);
  ClothCamera camera;

  if (GST_CLOCK_TIME_IS_VALID (time))
    gst_object_sync_values (GST_OBJECT (self), time);
  if (!self->framed)
    self->framed = cloth_orbit_frame (&self->orbit, self->n_vertices,
        frame->positions);
  GST_OBJECT_LOCK (self);
  self->orbit.azimuth = self->settings.azimuth;
  self->orbit.elevation = self->settings.elevation;
  self->orbit.distance = self->settings.distance;
  GST_OBJECT_UNLOCK (self);
  cloth_orbit_camera (&self->orbit, GST_VIDEO_INFO_WIDTH (&self->output.info),
      GST_VIDEO_INFO_HEIGHT (&self->output.info), &camera);
  cloth_capture_init (&self->capture, &camera);
  /* they were good at the start */
  cloth_capture_add_effects (&self->capture, self->settings.effects, NULL);
}

/* Leaves *@picture NULL when the mesh is dropped. */
static GstFlowReturn
make_picture (GstClothCamera * self, const Frame * frame, GstBuffer ** picture)
{
  g_autoptr (GstBuffer) made = NULL;
  GstVideoFrame video, rgb;
  GstFlowReturn flow;
  gboolean drawn;

  if (self->last && cloth_capture_is_dropped (&self->capture,
          frame->sequence, self->settings.seed)) {
    *picture = gst_buffer_copy (self->last);
    gst_buffer_copy_into (*picture, frame->buffer, GST_BUFFER_COPY_TIMESTAMPS,
        0, -1);
    return GST_FLOW_OK;
  }
  flow = GST_BASE_TRANSFORM_CLASS (gst_cloth_camera_parent_class)
      ->prepare_output_buffer (GST_BASE_TRANSFORM (self), frame->buffer, &made);
  if (flow != GST_FLOW_OK)
    return flow;
  if (!output_map (&self->output, made, &video, &rgb)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The picture does not fit its caps."), (NULL));
    return GST_FLOW_ERROR;
  }
  flow = draw (self, frame, &rgb, &drawn);
  output_unmap (&self->output, &video, &rgb);
  if (!drawn)
    return flow;
  if (self->capture.drop_rate > 0)
    gst_buffer_replace (&self->last, made);
  *picture = g_steal_pointer (&made);
  return GST_FLOW_OK;
}

static GstFlowReturn
gst_cloth_camera_generate_output (GstBaseTransform * trans, GstBuffer ** output)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (trans);
  GstFlowReturn flow;

  *output = NULL;
  while (!*output && is_ready (self)) {
    const Frame *frame = frame_at (self, self->next);

    if (self->free_view)
      aim (self, frame);
    flow = make_picture (self, frame, output);
    if (flow != GST_FLOW_OK)
      return flow;
    if (*output) {
      GST_BUFFER_OFFSET (*output) = frame->sequence;
      GST_BUFFER_OFFSET_END (*output) = frame->sequence + 1;
    }
    self->next++;
    prune (self);
  }
  return GST_FLOW_OK;
}

/* Never called: the base class takes an element without it for a pass-through. */
static GstFlowReturn
gst_cloth_camera_transform (GstBaseTransform * trans, GstBuffer * mesh,
    GstBuffer * picture)
{
  return GST_FLOW_OK;
}

/* Pushes what still waits for meshes that will not come. */
static GstFlowReturn
gst_cloth_camera_drain (GstClothCamera * self)
{
  GstFlowReturn flow = GST_FLOW_OK;

  self->draining = TRUE;
  while (flow == GST_FLOW_OK && self->renderer) {
    GstBuffer *picture = NULL;

    flow = gst_cloth_camera_generate_output (GST_BASE_TRANSFORM (self),
        &picture);
    if (!picture)
      break;
    flow = gst_pad_push (GST_BASE_TRANSFORM_SRC_PAD (self), picture);
  }
  self->draining = FALSE;
  return flow;
}

static gboolean
gst_cloth_camera_sink_event (GstBaseTransform * trans, GstEvent * event)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (trans);

  switch (GST_EVENT_TYPE (event)) {
    case GST_EVENT_GAP:
    case GST_EVENT_SEGMENT_DONE:
    case GST_EVENT_STREAM_START:
      gst_cloth_camera_drain (self);
      break;
    case GST_EVENT_EOS:
    case GST_EVENT_SEGMENT:
    case GST_EVENT_CAPS:
      gst_cloth_camera_drain (self);
      gst_cloth_camera_reset (self);
      break;
    case GST_EVENT_FLUSH_START:
      g_atomic_int_set (&self->stopped, TRUE);
      break;
    case GST_EVENT_FLUSH_STOP:
      g_atomic_int_set (&self->stopped, FALSE);
      gst_cloth_camera_reset (self);
      break;
    default:
      break;
  }
  return GST_BASE_TRANSFORM_CLASS (gst_cloth_camera_parent_class)->sink_event
      (trans, event);
}

/* A large picture takes its time, and holds the streaming thread, which has to end. */
static GstStateChangeReturn
gst_cloth_camera_change_state (GstElement * element, GstStateChange transition)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (element);

  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED)
    g_atomic_int_set (&self->stopped, FALSE);
  else if (transition == GST_STATE_CHANGE_PAUSED_TO_READY)
    g_atomic_int_set (&self->stopped, TRUE);
  return GST_ELEMENT_CLASS (gst_cloth_camera_parent_class)->change_state
      (element, transition);
}

/* How long a picture waits: for the last instant that it shows, the mesh behind it, and
 * one more. */
static void
update_latency (GstClothCamera * self)
{
  GstClockTime latency = 0;
  gboolean changed;
  gdouble span[2];

  if (!self->still && self->fps_n > 0) {
    get_span (self, 0, span);
    latency = (GstClockTime) (MAX (span[1], 0) * GST_SECOND) + 2 *
        gst_util_uint64_scale_int (GST_SECOND, self->fps_d, self->fps_n);
  }
  GST_OBJECT_LOCK (self);
  changed = self->latency != latency;
  self->latency = latency;
  GST_OBJECT_UNLOCK (self);
  if (changed)
    gst_element_post_message (GST_ELEMENT (self),
        gst_message_new_latency (GST_OBJECT (self)));
}

static gboolean
gst_cloth_camera_query (GstBaseTransform * trans, GstPadDirection direction,
    GstQuery * query)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (trans);
  gboolean done = GST_BASE_TRANSFORM_CLASS (gst_cloth_camera_parent_class)
      ->query (trans, direction, query);

  if (done && GST_QUERY_TYPE (query) == GST_QUERY_LATENCY) {
    GstClockTime own;

    GST_OBJECT_LOCK (self);
    own = self->latency;
    GST_OBJECT_UNLOCK (self);
    gst_cloth_add_latency (query, own);
  }
  return done;
}

/* ---- settings ---- */

static gboolean
gst_cloth_camera_load (GstClothCamera * self)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = NULL;
  const ClothCamera *camera;
  ClothCamera any;

  self->free_view = !self->settings.rig && !self->settings.camera;
  if (self->free_view) {
    cloth_orbit_camera (&self->orbit, 1, 1, &any);
    camera = &any;
  } else {
    rig = gst_cloth_open_rig (GST_ELEMENT (self), self->settings.rig,
        self->settings.camera, &camera);
    if (!rig)
      return FALSE;
  }
  cloth_capture_init (&self->capture, camera);
  if (!cloth_capture_add_effects (&self->capture, self->settings.effects,
          &error)) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS, ("Wrong effects: %s",
            error->message), ("effects=%s", self->settings.effects));
    return FALSE;
  }
  self->still = self->capture.exposure_s == 0
      && self->capture.camera.rolling_shutter_s == 0
      && self->capture.camera.offset_s == 0;
  return TRUE;
}

static gboolean
gst_cloth_camera_start (GstBaseTransform * trans)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (trans);

  if (self->settings.pattern && self->settings.texture) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("The cloth can't carry both a pattern and a texture."),
        ("Leave out pattern= or texture=."));
    return FALSE;
  }
  gst_cloth_damage_reset (&self->settings.damage, GST_ELEMENT (self));
  return gst_cloth_camera_load (self);
}

static void
gst_cloth_camera_forget (GstClothCamera * self)
{
  gst_cloth_camera_reset (self);
  g_ptr_array_set_size (self->spare, 0);
  gst_clear_caps (&self->mesh_caps);
  self->framed = FALSE;
  g_clear_pointer (&self->renderer, cloth_renderer_free);
  g_clear_pointer (&self->paint, cloth_paint_free);
}

static gboolean
gst_cloth_camera_stop (GstBaseTransform * trans)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (trans);

  gst_cloth_camera_forget (self);
  output_clear (&self->output);
  memset (&self->capture, 0, sizeof (self->capture));
  GST_OBJECT_LOCK (self);
  self->latency = 0;
  GST_OBJECT_UNLOCK (self);
  return TRUE;
}

static gboolean
gst_cloth_camera_set_caps (GstBaseTransform * trans, GstCaps * in,
    GstCaps * out)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (trans);
  const Settings *settings = &self->settings;
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) topology = NULL;
  const gfloat *uv;
  const guint32 *faces;
  guint sides = settings->sides;

  if (!output_set (&self->output, out)) {
    GST_ERROR_OBJECT (self, "can't make pictures of %" GST_PTR_FORMAT, out);
    return FALSE;
  }
  if (self->mesh_caps && gst_caps_is_equal (self->mesh_caps, in)) {
    /* only the pictures are of another format: what waits are meshes */
    gst_clear_buffer (&self->last);
    return TRUE;
  }
  gst_cloth_camera_forget (self);
  topology = gst_cloth_read_topology (GST_ELEMENT (self), in);
  if (!topology)
    return FALSE;
  if (gst_cloth_topology_get_n_faces (topology) == 0) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The mesh has no faces: nothing of it can be filmed."),
        ("Give the mesh faces, or a grid."));
    return FALSE;
  }
  self->n_vertices = gst_cloth_topology_get_n_vertices (topology);
  self->fps_n = GST_VIDEO_INFO_FPS_N (&self->output.info);
  self->fps_d = GST_VIDEO_INFO_FPS_D (&self->output.info);
  uv = gst_cloth_topology_get_uv (topology, NULL);
  faces = gst_cloth_topology_get_faces (topology, NULL);
  if (settings->pattern)
    self->paint = gst_cloth_paint_pattern (settings->pattern, &sides, &error);
  else if (settings->texture)
    self->paint = gst_cloth_paint_texture (settings->texture, uv,
        self->n_vertices, &error);
  else
    self->paint = gst_cloth_paint_white ();
  if (!self->paint) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("Can't put “%s” on the cloth: %s", settings->pattern ?
            settings->pattern : settings->texture, error->message), (NULL));
    return FALSE;
  }
  self->style.two_sided = sides > 1;
  self->renderer = cloth_renderer_new (self->n_vertices, uv, faces,
      gst_cloth_topology_get_n_faces (topology), settings->threads,
      CLOTH_SIMD_BEST);
  gst_caps_replace (&self->mesh_caps, in);
  update_latency (self);
  return TRUE;
}

static GstCaps *
gst_cloth_camera_transform_caps (GstBaseTransform * trans,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter)
{
  static const gchar *const kept[] = { "framerate", NULL };
  const ClothCamera *camera = &GST_CLOTH_CAMERA (trans)->capture.camera;
  GstCaps *other = gst_static_pad_template_get_caps (direction ==
      GST_PAD_SINK ? &src_template : &sink_template);

  if (direction == GST_PAD_SINK && camera->width > 0) {
    other = gst_caps_make_writable (other);
    gst_caps_set_simple (other, "pixel-aspect-ratio", GST_TYPE_FRACTION, 1, 1,
        NULL);
    if (!GST_CLOTH_CAMERA (trans)->free_view)
      gst_caps_set_simple (other, "width", G_TYPE_INT, camera->width, "height",
          G_TYPE_INT, camera->height, NULL);
  }
  return gst_cloth_carry_caps (caps, kept, other, filter);
}

static GstCaps *
gst_cloth_camera_fixate_caps (GstBaseTransform * trans,
    GstPadDirection direction, GstCaps * caps, GstCaps * other)
{
  g_autoptr (GstCaps) src_caps =
      gst_static_pad_template_get_caps (&src_template);
  GstStructure *structure;

  if (direction == GST_PAD_SINK) {
    /* without a peer the base class gives what came */
    if (!gst_caps_can_intersect (other, src_caps))
      gst_caps_take (&other, gst_cloth_camera_transform_caps (trans, direction,
              caps, NULL));
    other = gst_caps_make_writable (gst_caps_truncate (other));
    structure = gst_caps_get_structure (other, 0);
    gst_structure_fixate_field_nearest_int (structure, "width", DEFAULT_WIDTH);
    gst_structure_fixate_field_nearest_int (structure, "height",
        DEFAULT_HEIGHT);
  }
  return gst_caps_fixate (other);
}

/* Offers pools of buffers that may have strides of their own. */
static gboolean
gst_cloth_camera_decide_allocation (GstBaseTransform * trans, GstQuery * query)
{
  g_autoptr (GstBufferPool) pool = NULL;
  GstStructure *config;
  GstCaps *caps;
  GstVideoInfo info;
  guint size, least = 0, most = 0;
  const gboolean offered = gst_query_get_n_allocation_pools (query) > 0;

  gst_query_parse_allocation (query, &caps, NULL);
  if (!caps || !gst_video_info_from_caps (&info, caps))
    return FALSE;
  size = (guint) GST_VIDEO_INFO_SIZE (&info);
  if (offered) {
    guint asked;

    gst_query_parse_nth_allocation_pool (query, 0, &pool, &asked, &least,
        &most);
    size = MAX (size, asked);
  }
  if (!pool)
    pool = gst_video_buffer_pool_new ();
  config = gst_buffer_pool_get_config (pool);
  gst_buffer_pool_config_set_params (config, caps, size, least, most);
  if (gst_query_find_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL))
    gst_buffer_pool_config_add_option (config,
        GST_BUFFER_POOL_OPTION_VIDEO_META);
  gst_buffer_pool_set_config (pool, config);
  if (offered)
    gst_query_set_nth_allocation_pool (query, 0, pool, size, least, most);
  else
    gst_query_add_allocation_pool (query, pool, size, least, most);
  return GST_BASE_TRANSFORM_CLASS (gst_cloth_camera_parent_class)
      ->decide_allocation (trans, query);
}

/* ---- GObject ---- */

static void
gst_cloth_camera_finalize (GObject * object)
{
  GstClothCamera *self = GST_CLOTH_CAMERA (object);

  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  gst_cloth_camera_forget (self);
  g_ptr_array_unref (self->window);
  g_ptr_array_unref (self->spare);
  g_ptr_array_unref (self->positions);
  g_array_unref (self->times);
  G_OBJECT_CLASS (gst_cloth_camera_parent_class)->finalize (object);
}

static void
gst_cloth_camera_class_init (GstClothCameraClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseTransformClass *trans_class = GST_BASE_TRANSFORM_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (cloth_camera_debug, "clothcamera", 0,
      "synthetic film of meshes");
  object_class->finalize = gst_cloth_camera_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &default_settings,
      G_STRUCT_OFFSET (GstClothCamera, settings));
  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class, "Cloth camera",
      "Filter/Converter/Video",
      "Films a mesh stream: a textured cloth as a camera of a rig sees it",
      "The gst-cloth developers");
  element_class->change_state = gst_cloth_camera_change_state;
  trans_class->start = gst_cloth_camera_start;
  trans_class->stop = gst_cloth_camera_stop;
  trans_class->set_caps = gst_cloth_camera_set_caps;
  trans_class->transform_caps = gst_cloth_camera_transform_caps;
  trans_class->fixate_caps = gst_cloth_camera_fixate_caps;
  trans_class->decide_allocation = gst_cloth_camera_decide_allocation;
  trans_class->transform = gst_cloth_camera_transform;
  trans_class->submit_input_buffer = gst_cloth_camera_submit_input_buffer;
  trans_class->generate_output = gst_cloth_camera_generate_output;
  trans_class->sink_event = gst_cloth_camera_sink_event;
  trans_class->query = gst_cloth_camera_query;
}

static void
gst_cloth_camera_init (GstClothCamera * self)
{
  self->window = g_ptr_array_new_with_free_func (frame_free);
  self->spare = g_ptr_array_new_with_free_func (frame_free);
  self->positions = g_ptr_array_new ();
  self->times = g_array_new (FALSE, FALSE, sizeof (gdouble));
  cloth_orbit_init (&self->orbit);
  self->settings = default_settings;
  gst_cloth_damage_watch (&self->settings.damage, GST_ELEMENT (self),
      GST_BASE_TRANSFORM_SRC_PAD (self));
  cloth_render_style_init (&self->style);
  gst_base_transform_set_qos_enabled (GST_BASE_TRANSFORM (self), FALSE);
}
