/* Films of a cloth with 3,500 dots, drawn by gst/render.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/bench/dotfilm.h"

#include <math.h>

#include "gst/pattern/marray.h"
#include "gst/pattern/texture.h"
#include "gst/rig/rigfile.h"
#include "gst/render/render.h"

#define SIZE 1004
#define FPS 25
/* Dots of the paper: 2 cm apart, 1.3 cm wide. */
#define COLUMNS 70
#define ROWS 50
#define PITCH 0.02
#define DIAMETER 0.013
/* Of the picture that is printed; 2 px/mm are finer than a camera's pixels. */
#define PX_PER_M 2000
#define GROUND 20
/* The mesh that is drawn. */
#define MESH_COLUMNS 141
#define MESH_ROWS 101
#define N_VERTICES (MESH_COLUMNS * MESH_ROWS)
#define N_FACES ((MESH_COLUMNS - 1) * (MESH_ROWS - 1))
/* From the cameras to the middle of the cloth, metres. */
#define SHEET_DISTANCE 2.5
#define SKIRT_DISTANCE 2.0
#define FOCAL 1550
/* The sheet's cameras stand up to this far to the left and right, rad. */
#define ASIDE 0.5
#define NOISE "noise,sigma=2; defocus,sigma=0.7"

static void
shape (DotFilmCloth cloth, gdouble u, gdouble v, const gdouble size[2],
    gdouble time_s, gdouble X[3])
{
  const gdouble wave = sin (9 * u + 6 * time_s), sway =
      sin (5 * v - 4 * time_s);

  X[2] = size[1] / 2 - v;
  if (cloth == DOT_FILM_SHEET) {
    X[0] = u - size[0] / 2;
    X[1] = 0.03 * wave + 0.02 * sway;
  } else {
    const gdouble angle = 2 * G_PI * u / size[0];
    const gdouble radius = size[0] / (2 * G_PI) * (0.95
        + 0.1 * v * sin (6 * angle + 3 * time_s));

    X[0] = radius * sin (angle) + 0.02 * sway;
    X[1] = -radius * cos (angle);
  }
}

static ClothRig *
stand (DotFilmCloth cloth)
{
  ClothRig *rig = cloth_rig_new (DOT_FILM_CAMERAS);

  for (guint i = 0; i < DOT_FILM_CAMERAS; i++) {
    const gdouble angle = cloth == DOT_FILM_SHEET
        ? ASIDE * (2. * i / (DOT_FILM_CAMERAS - 1) - 1)
        : 2 * G_PI * i / DOT_FILM_CAMERAS;
    const gdouble c = cos (angle), s = sin (angle);

    rig->cameras[i] = (ClothCamera) {
      .name = g_strdup_printf ("cam%u", i),.width = SIZE,.height = SIZE,.K =
          { FOCAL, 0, (SIZE - 1) / 2., 0, FOCAL, (SIZE - 1) / 2., 0, 0,
        1
      },.lens = CLOTH_LENS_NONE,.R =
          { c, s, 0, 0, 0, -1, -s, c, 0 },.t =
          { 0, 0, cloth == DOT_FILM_SHEET ? SHEET_DISTANCE : SKIRT_DISTANCE }
    };
  }
  return rig;
}

static ClothPaint *
print (const ClothMArray * array, GError ** error)
{
  const gdouble origin[2] = { 0, 0 };
  guint8 inks[CLOTH_M_ARRAY_MAX_COLOURS][3];
  g_autoptr (ClothTexture) texture = NULL;

  for (gint k = 0; k < array->n_colours; k++)
    for (gint i = 0; i < 3; i++)
      inks[k][i] = array->colours[k].rgb[i];
  texture = cloth_m_array_texture (array, PX_PER_M, GROUND,
      (const guint8 (*)[3]) inks, error);
  return texture ? cloth_paint_new (texture->data, texture->width,
      texture->height, 3 * texture->width, 3, NULL, origin,
      array->cloth_m) : NULL;
}

static void
lay_mesh (const gdouble size[2], gfloat * uv, guint32 * faces)
{
  for (guint32 j = 0; j < MESH_ROWS; j++)
    for (guint32 i = 0; i < MESH_COLUMNS; i++) {
      const guint32 at = j * MESH_COLUMNS + i;

      uv[2 * at] = (gfloat) (size[0] * i / (MESH_COLUMNS - 1));
      uv[2 * at + 1] = (gfloat) (size[1] * j / (MESH_ROWS - 1));
      if (i + 1 < MESH_COLUMNS && j + 1 < MESH_ROWS) {
        guint32 *f = faces + 4 * (j * (MESH_COLUMNS - 1) + i);

        f[0] = at;
        f[1] = at + MESH_COLUMNS;
        f[2] = f[1] + 1;
        f[3] = f[0] + 1;
      }
    }
}

/* The RGB picture as a decoder would give it. */
static GstSample *
pack (GstVideoConverter * converter, const GstVideoInfo * from, guint8 * rgb,
    const GstVideoInfo * to)
{
  g_autoptr (GstCaps) caps = gst_video_info_to_caps (to);
  g_autoptr (GstBuffer) in = gst_buffer_new_wrapped_full
      (GST_MEMORY_FLAG_READONLY, rgb, from->size, 0, from->size, NULL, NULL);
  g_autoptr (GstBuffer) out = gst_buffer_new_allocate (NULL, to->size, NULL);
  GstVideoFrame a, b;

  gst_video_frame_map (&a, from, in, GST_MAP_READ);
  gst_video_frame_map (&b, to, out, GST_MAP_WRITE);
  gst_video_converter_frame (converter, &a, &b);
  gst_video_frame_unmap (&a);
  gst_video_frame_unmap (&b);
  return gst_sample_new (out, caps, NULL, NULL);
}

static void
film (DotFilmCloth cloth, const gdouble size[2], const ClothRig * rig,
    const ClothPaint * paint,
    GstSample * pictures[DOT_FILM_CAMERAS][DOT_FILM_LENGTH])
{
  g_autofree gfloat *uv = g_new (gfloat, 2 * N_VERTICES);
  g_autofree guint32 *faces = g_new (guint32, 4 * N_FACES);
  g_autofree gdouble *at = g_new (gdouble, 3 * N_VERTICES);
  g_autoptr (ClothRenderer) renderer = NULL;
  GstVideoConverter *converter;
  ClothRenderStyle style;
  GstVideoInfo from, to;
  g_autofree guint8 *rgb = NULL;

  gst_video_info_set_format (&from, GST_VIDEO_FORMAT_RGB, SIZE, SIZE);
  gst_video_info_set_format (&to, GST_VIDEO_FORMAT_I420, SIZE, SIZE);
  GST_VIDEO_INFO_FPS_N (&from) = GST_VIDEO_INFO_FPS_N (&to) = FPS;
  rgb = g_malloc (from.size);
  converter = gst_video_converter_new (&from, &to, NULL);
  lay_mesh (size, uv, faces);
  renderer = cloth_renderer_new (N_VERTICES, uv, faces, N_FACES, 0,
      CLOTH_SIMD_BEST);
  cloth_render_style_init (&style);
  /* from all sides */
  style.ambient_light = 0.9;
  style.lamp_light = 0;
  for (guint k = 0; k < DOT_FILM_LENGTH; k++) {
    const gdouble time_s = (gdouble) k / FPS;
    const gdouble *const positions[1] = { at };
    const ClothMotion motion = { N_VERTICES, 1, &time_s, positions };

    for (gint i = 0; i < N_VERTICES; i++)
      shape (cloth, uv[2 * i], uv[2 * i + 1], size, time_s, at + 3 * i);
    for (guint i = 0; i < DOT_FILM_CAMERAS; i++) {
      guint8 *const planes[3] = { rgb, rgb + 1, rgb + 2 };
      const gint stride = GST_VIDEO_INFO_PLANE_STRIDE (&from, 0);
      const gint strides[3] = { stride, stride, stride };
      ClothCapture capture;

      cloth_capture_init (&capture, &rig->cameras[i]);
      cloth_capture_add_effects (&capture, NOISE, NULL);
      cloth_renderer_draw (renderer, paint, &capture, &style, &motion, time_s,
          NULL);
      cloth_renderer_develop (renderer, &capture, k, i, 3, planes, strides, 3,
          NULL);
      pictures[i][k] = pack (converter, &from, rgb, &to);
    }
  }
  gst_video_converter_free (converter);
}

gboolean
dot_film_draw (DotFilmCloth cloth, const gchar * folder,
    GstSample * pictures[DOT_FILM_CAMERAS][DOT_FILM_LENGTH], GError ** error)
{
  const ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;
  g_autofree gchar *pattern = g_build_filename (folder, "pattern.json", NULL);
  g_autofree gchar *rig_file = g_build_filename (folder, "rig.json", NULL);
  g_autoptr (ClothMArray) array = cloth_m_array_new (COLUMNS, ROWS, 5, PITCH,
      DIAMETER, PITCH / 2, &code, error);
  g_autoptr (ClothPaint) paint = NULL;
  g_autoptr (ClothRig) rig = stand (cloth);

  if (!array || !cloth_m_array_save (array, pattern, error)
      || !cloth_rig_save (rig, rig_file, error)
      || !(paint = print (array, error)))
    return FALSE;
  film (cloth, array->cloth_m, rig, paint, pictures);
  return TRUE;
}
