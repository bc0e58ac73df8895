/* Dots of path-traced pictures of moving cloth, against the mesh they were rendered from.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/app/gstappsink.h>
#include <gst/video/video.h>
#include <math.h>

#include "gst/mesh/npy.h"
#include "gst/pattern/marray.h"
#include "gst/rig/rigfile.h"
#include "gst/vision/dot.h"
#include "gst/vision/dotcolour.h"
#include "gst/vision/lattice.h"
#include "tests/common/picture.h"

#define FOLDER TEST_DATA "/dots_ring8/"
/* The mesh the pictures were rendered from; bilinear in each cell. */
#define COLUMNS 33
#define ROWS 35
#define RIM 32
#define STEEPEST (70 * G_PI / 180)
/* Nearer to the camera than this much and it hides what is behind, metres. */
#define HIDES 0.003

typedef struct
{
  gdouble x, y;                 /* centre of gravity of the outline, px */
  gdouble slope[2][2];          /* of both over u and v, px/m */
  gdouble angle;                /* between the view and the normal */
  gboolean clear;               /* nothing hides any of it */
} Truth;

static ClothMArray *array;
static ClothRig *rig;
static gfloat *mesh;

static void
surface (gdouble u, gdouble v, gdouble X[3])
{
  const gdouble x = u / array->cloth_m[0] * (COLUMNS - 1);
  const gdouble y = v / array->cloth_m[1] * (ROWS - 1);
  const gint i = CLAMP ((gint) x, 0, COLUMNS - 2);
  const gint j = CLAMP ((gint) y, 0, ROWS - 2);
  const gfloat *at = mesh + 3 * (j * COLUMNS + i), *below = at + 3 * COLUMNS;

  for (gint k = 0; k < 3; k++)
    X[k] = (1 - (y - j)) * ((1 - (x - i)) * at[k] + (x - i) * at[3 + k])
        + (y - j) * ((1 - (x - i)) * below[k] + (x - i) * below[3 + k]);
}

/* Does the segment from @eye to @X meet a triangle more than HIDES before its end?
 * Möller & Trumbore 1997. */
static gboolean
meets (const gdouble eye[3], const gdouble X[3], const gfloat * a,
    const gfloat * b, const gfloat * c)
{
  gdouble d[3], e[3], f[3], s[3], p[3], q[3], det, u, v, t, length = 0;

  for (gint k = 0; k < 3; k++) {
    d[k] = X[k] - eye[k];
    e[k] = (gdouble) b[k] - a[k];
    f[k] = (gdouble) c[k] - a[k];
    s[k] = eye[k] - a[k];
    length += d[k] * d[k];
  }
  for (gint k = 0; k < 3; k++) {
    const gint l = (k + 1) % 3, m = (k + 2) % 3;

    p[k] = d[l] * f[m] - d[m] * f[l];
    q[k] = s[l] * e[m] - s[m] * e[l];
  }
  det = e[0] * p[0] + e[1] * p[1] + e[2] * p[2];
  u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det;
  v = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det;
  t = (f[0] * q[0] + f[1] * q[1] + f[2] * q[2]) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0
      && (1 - t) * sqrt (length) > HIDES;
}

static gboolean
is_hidden (const gdouble eye[3], const gdouble X[3])
{
  for (gint j = 0; j < ROWS - 1; j++) {
    for (gint i = 0; i < COLUMNS - 1; i++) {
      const gfloat *at = mesh + 3 * (j * COLUMNS + i);

      if (meets (eye, X, at, at + 3, at + 3 * COLUMNS)
          || meets (eye, X, at + 3, at + 3 * COLUMNS, at + 3 * COLUMNS + 3))
        return TRUE;
    }
  }
  return FALSE;
}

static Truth
look (const ClothCamera * camera, gint dot)
{
  const gdouble u = array->origin_uv_m[0]
      + dot % array->columns * array->pitch_m;
  const gdouble v = array->origin_uv_m[1]
      + dot / array->columns * array->pitch_m;
  const gdouble h = array->diameter_m / 2;
  gdouble rim[RIM][2], eye[3], X[3], a[3], b[3], n[3];
  gdouble area = 0, along = 0, far = 0, size = 0;
  Truth truth = {.clear = TRUE };

  for (gint k = 0; k < 3; k++)
    eye[k] = -(camera->R[k] * camera->t[0] + camera->R[3 + k] * camera->t[1]
        + camera->R[6 + k] * camera->t[2]);
  for (gint i = 0; i < RIM; i++) {
    surface (u + h * cos (2 * G_PI * i / RIM), v + h * sin (2 * G_PI * i / RIM),
        X);
    g_assert_true (cloth_camera_project (camera, X, rim[i], NULL, NULL));
    truth.clear &= rim[i][0] > 1 && rim[i][1] > 1
        && rim[i][0] < camera->width - 2 && rim[i][1] < camera->height - 2;
    if (i % 4 == 0 && truth.clear)
      truth.clear = !is_hidden (eye, X);
  }
  for (gint i = 0; i < RIM; i++) {
    const gdouble *p = rim[i], *q = rim[(i + 1) % RIM];
    const gdouble cross = p[0] * q[1] - q[0] * p[1];

    area += cross / 2;
    truth.x += (p[0] + q[0]) * cross / 6;
    truth.y += (p[1] + q[1]) * cross / 6;
  }
  truth.x /= area;
  truth.y /= area;
  for (gint k = 0; k < 2; k++) {
    gdouble p[2], q[2];

    surface (k ? u : u - h, k ? v - h : v, a);
    surface (k ? u : u + h, k ? v + h : v, b);
    cloth_camera_project (camera, a, p, NULL, NULL);
    cloth_camera_project (camera, b, q, NULL, NULL);
    for (gint i = 0; i < 2; i++)
      truth.slope[k][i] = (q[i] - p[i]) / (2 * h);
  }
  surface (u - h, v, a);
  surface (u + h, v, b);
  for (gint k = 0; k < 3; k++)
    n[k] = b[k] - a[k];
  surface (u, v - h, a);
  surface (u, v + h, b);
  surface (u, v, X);
  for (gint k = 0; k < 3; k++) {
    const gint l = (k + 1) % 3, m = (k + 2) % 3;
    const gdouble normal = n[l] * (b[m] - a[m]) - n[m] * (b[l] - a[l]);

    along += normal * (eye[k] - X[k]);
    far += pow (eye[k] - X[k], 2);
    size += normal * normal;
  }
  truth.angle = acos (MIN (1, fabs (along) / sqrt (far * size)));
  return truth;
}

/* The first picture of a camera. */
static GstSample *
decode (const gchar * name)
{
  g_autofree gchar *launch = g_strdup_printf ("filesrc location=\"" FOLDER
      "%s.mp4\" ! qtdemux ! h264parse ! avdec_h264 ! "
      "video/x-raw,format=I420 ! appsink name=sink sync=false", name);
  g_autoptr (GError) error = NULL;
  GstElement *pipeline = gst_parse_launch (launch, &error);
  g_autoptr (GstElement) sink = NULL;
  GstSample *sample;

  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  sample = gst_app_sink_try_pull_sample (GST_APP_SINK (sink), 60 * GST_SECOND);
  g_assert_nonnull (sample);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
  return sample;
}

static void
keep (const gchar * name, const ClothImage * luma, const ClothDot * dots,
    guint n_dots)
{
  g_autoptr (TestPicture) picture =
      test_picture_new (luma->width, luma->height, 0);

  for (gint y = 0; y < luma->height; y++)
    for (gint x = 0; x < luma->width; x++)
      picture->data[y * picture->image.stride + x] =
          luma->data[y * luma->stride + x];
  for (guint i = 0; i < n_dots; i++)
    for (gint k = -3; k <= 3; k++) {
      const gint x = (gint) (dots[i].x + 0.5f), y = (gint) (dots[i].y + 0.5f);

      if (x > 3 && y > 3 && x < luma->width - 4 && y < luma->height - 4)
        picture->data[y * picture->image.stride + x + k] =
            picture->data[(y + k) * picture->image.stride + x] =
            dots[i].touches ? 255 : 0;
    }
  test_picture_keep (name, picture->data, picture->image.width,
      picture->image.height);
}

/* Labels of all cameras. */
static guint total_right, total_wrong;

/* Labels of the dots: a label is right where the dot lies where it says. */
static void
check_labels (const ClothDot * dots, guint n, const Truth * truth)
{
  const gint n_all = array->columns * array->rows;
  const ClothDotLabelParams params = cloth_dot_label_default_params ();
  g_autofree gfloat *likelihoods = g_new (gfloat, n * (guint) array->n_colours);
  g_autofree gboolean *labelled = g_new0 (gboolean, n_all);
  g_autoptr (ClothDotLabeller) labeller = NULL;
  g_autoptr (GError) error = NULL;
  guint8 rgb[CLOTH_M_ARRAY_MAX_COLOURS][3];
  guint n_labels, right = 0, wrong = 0, seen = 0, found = 0, behind = 0;
  const ClothDotLabel *labels;
  ClothDotColourModel model;

  labeller = cloth_dot_labeller_new (array->columns, array->rows,
      array->n_colours, array->matrix, &error);
  g_assert_no_error (error);
  for (gint k = 0; k < array->n_colours; k++)
    memcpy (rgb[k], array->colours[k].rgb, sizeof rgb[k]);
  cloth_dot_colour_model_init (&model, array->n_colours,
      (const guint8 (*)[3]) rgb, 0.2126f, 0.0722f);
  cloth_dot_colour_model_classify (&model, dots, n, likelihoods);
  cloth_dot_labeller_run (labeller, &params, dots, n, likelihoods);
  labels = cloth_dot_labeller_get_labels (labeller, &n_labels);
  g_assert_cmpuint (n_labels, ==, n);
  for (guint i = 0; i < n; i++) {
    const gint k = labels[i].row * array->columns + labels[i].column;

    if (labels[i].column < 0)
      continue;
    g_assert_false (labelled[k]);
    labelled[k] = hypot (dots[i].x - truth[k].x, dots[i].y - truth[k].y) < 1.5;
    if (labelled[k])
      right++;
    else
      /* What hides a part of it moves a dot's centre. */
      wrong += truth[k].clear || hypot (dots[i].x - truth[k].x,
          dots[i].y - truth[k].y) > 4;
    behind += labelled[k] && labels[i].mirrored
        != (truth[k].slope[0][0] * truth[k].slope[1][1]
        < truth[k].slope[0][1] * truth[k].slope[1][0]);
  }
  for (gint k = 0; k < n_all; k++) {
    seen += truth[k].clear && truth[k].angle <= STEEPEST;
    found += truth[k].clear && truth[k].angle <= STEEPEST && labelled[k];
  }
  g_test_message ("labels: %u right, %u wrong; of %u in clear view below 70 "
      "degrees %.2f%%", right, wrong, seen, 100.0 * found / seen);
  g_assert_cmpuint (100 * wrong, <=, right + wrong);
  g_assert_cmpuint (100 * found, >=, 95 * seen);
  g_assert_cmpuint (behind, ==, 0);
  total_right += right;
  total_wrong += wrong;
}

static void
test_camera (gconstpointer data)
{
  const ClothCamera *camera = &rig->cameras[GPOINTER_TO_UINT (data)];
  const ClothDotParams params = cloth_dot_default_params ();
  const gint n_all = array->columns * array->rows;
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();
  g_autofree Truth *truth = g_new (Truth, n_all);
  GstSample *sample = decode (camera->name);
  GstVideoFrame frame;
  GstVideoInfo info;
  ClothDotImage image;
  const ClothDot *dots;
  guint n, seen = 0, found = 0, ghosts = 0, good = 0;
  gdouble sum = 0, A[3] = { 0 }, b[2] = { 0 }, shift[2], rest, det;

  g_assert_true (gst_video_info_from_caps (&info,
          gst_sample_get_caps (sample)));
  g_assert_true (gst_video_frame_map (&frame, &info,
          gst_sample_get_buffer (sample), GST_MAP_READ));
  image = (ClothDotImage) {
    .luma = {
      GST_VIDEO_FRAME_PLANE_DATA (&frame, 0), info.width, info.height,
      GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0)
    },.chroma = {
      GST_VIDEO_FRAME_PLANE_DATA (&frame, 1),
      GST_VIDEO_FRAME_PLANE_DATA (&frame, 2)
    },.chroma_stride = GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 1),.chroma_step =
        1,.chroma_shift = {
      1, 1
    }
  };
  cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  dots = cloth_dot_detector_get_dots (detector, &n);
  keep (camera->name, &image.luma, dots, n);
  for (gint k = 0; k < n_all; k++)
    truth[k] = look (camera, k);
  for (gint k = 0; k < n_all; k++) {
    const ClothDot *best = NULL;
    gdouble dx, dy;

    if (!truth[k].clear || truth[k].angle > STEEPEST)
      continue;
    seen++;
    for (guint i = 0; i < n; i++)
      if (!best || hypot (dots[i].x - truth[k].x, dots[i].y - truth[k].y)
          < hypot (best->x - truth[k].x, best->y - truth[k].y))
        best = &dots[i];
    g_assert_nonnull (best);
    dx = best->x - truth[k].x;
    dy = best->y - truth[k].y;
    if (hypot (dx, dy) > 1.5) {
      g_test_message ("missed: dot %d at %.1f, %.1f, %.0f degrees", k,
          truth[k].x, truth[k].y, truth[k].angle * 180 / G_PI);
      continue;
    }
    found++;
    if (!best->touches) {
      const gdouble *du = truth[k].slope[0], *dv = truth[k].slope[1];

      good++;
      sum += dx * dx + dy * dy;
      A[0] += du[0] * du[0] + du[1] * du[1];
      A[1] += du[0] * dv[0] + du[1] * dv[1];
      A[2] += dv[0] * dv[0] + dv[1] * dv[1];
      b[0] += du[0] * dx + du[1] * dy;
      b[1] += dv[0] * dx + dv[1] * dy;
    }
  }
  /* The print as a whole lies a little beside its place on the mesh: what a shift of
   * it, least squares, does not explain. */
  det = A[0] * A[2] - A[1] * A[1];
  shift[0] = (A[2] * b[0] - A[1] * b[1]) / det;
  shift[1] = (A[0] * b[1] - A[1] * b[0]) / det;
  rest = sum - shift[0] * b[0] - shift[1] * b[1];
  for (guint i = 0; i < n; i++) {
    gdouble least = G_MAXDOUBLE;

    for (gint k = 0; k < n_all; k++)
      least = MIN (least,
          hypot (dots[i].x - truth[k].x, dots[i].y - truth[k].y));
    ghosts += least > 4;
  }
  g_test_message ("%s: %u dots found; of %u in clear view below 70 degrees %u "
      "(%.2f%%), %.3f px RMS each way; the print lies %+.3f, %+.3f mm off, "
      "without that %.3f px; %u where there is none; noise %.2f", camera->name,
      n, seen, found, 100.0 * found / seen, sqrt (sum / (2 * good)),
      1000 * shift[0], 1000 * shift[1], sqrt (rest / (2 * good)), ghosts,
      cloth_dot_detector_get_noise (detector));
  g_assert_cmpuint (seen, >, 300);
  g_assert_cmpuint (100 * found, >=, 98 * seen);
  g_assert_cmpfloat (sqrt (sum / (2 * good)), <, 0.15);
  /* Half a texel of 0.25 mm, as every camera sees it. */
  g_assert_cmpfloat_with_epsilon (shift[0], 0.000125, 0.00001);
  g_assert_cmpfloat_with_epsilon (shift[1], 0.000125, 0.00001);
  g_assert_cmpfloat (sqrt (rest / (2 * good)), <, 0.07);
  g_assert_cmpuint (ghosts, ==, 0);
  check_labels (dots, n, truth);
  gst_video_frame_unmap (&frame);
  gst_sample_unref (sample);
}

static void
test_all_labels (void)
{
  g_assert_cmpuint (total_right, >, 2000);
  g_assert_cmpuint (1000 * total_wrong, <=, 5 * (total_right + total_wrong));
}

int
main (int argc, char **argv)
{
  g_autoptr (GError) error = NULL;
  ClothNpyInfo info;
  gint failed;

  g_test_init (&argc, &argv, NULL);
  test_picture_init (&argc, &argv);
  array = cloth_m_array_load (FOLDER "pattern.json", &error);
  g_assert_no_error (error);
  rig = cloth_rig_load (FOLDER "rig.json", &error);
  g_assert_no_error (error);
  mesh = cloth_npy_load_float (FOLDER "vertices.npy", &info, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (info.row_items, ==, 3 * ROWS * COLUMNS);
  for (guint i = 0; i < rig->n_cameras; i++) {
    g_autofree gchar *name = g_strdup_printf ("/dot-ring/%s",
        rig->cameras[i].name);

    g_test_add_data_func (name, GUINT_TO_POINTER (i), test_camera);
  }
  g_test_add_func ("/dot-ring/labels-of-all", test_all_labels);
  failed = g_test_run ();
  g_free (mesh);
  cloth_rig_free (rig);
  cloth_m_array_free (array);
  return failed;
}
