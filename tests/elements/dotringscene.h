/* The path-traced cloth with dots that eight cameras film: what the renderer was given.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/check/gstcheck.h>
#include <gst/video/video.h>
#include <math.h>

#include "gst/pattern/marray.h"
#include "gst/rig/rigfile.h"
#include "tests/common/npyfloats.h"

#define RING TEST_DATA "/dots_ring8/"
/* The mesh that the pictures were rendered from; bilinear in each cell. */
#define MESH_COLUMNS 33
#define MESH_ROWS 35
/* By how much the print lies beside its place, each way: half a texel. */
#define PRINT_OFF 0.000125

typedef struct
{
  ClothMArray *array;
  ClothRig *rig;
  gfloat *mesh;                 /* of the first picture, then of the next */
} Ring;

static inline void
ring_open (Ring * ring)
{
  g_autoptr (GError) error = NULL;
  ClothNpyInfo info;

  ring->array = cloth_m_array_load (RING "pattern.json", &error);
  g_assert_no_error (error);
  ring->rig = cloth_rig_load (RING "rig.json", &error);
  g_assert_no_error (error);
  ring->mesh = load_npy_floats (RING "vertices.npy", &info, &error);
  g_assert_no_error (error);
}

static inline void
ring_close (Ring * ring)
{
  cloth_m_array_free (ring->array);
  cloth_rig_free (ring->rig);
  g_free (ring->mesh);
}

/* Where the centre of a dot is, metres. */
static inline void
ring_place (const Ring * ring, guint frame, gint column, gint row, gdouble X[3])
{
  const ClothMArray *array = ring->array;
  const gdouble u = array->origin_uv_m[0] + PRINT_OFF + column * array->pitch_m;
  const gdouble v = array->origin_uv_m[1] + PRINT_OFF + row * array->pitch_m;
  const gdouble x = u / array->cloth_m[0] * (MESH_COLUMNS - 1);
  const gdouble y = v / array->cloth_m[1] * (MESH_ROWS - 1);
  const gint i = CLAMP ((gint) x, 0, MESH_COLUMNS - 2);
  const gint j = CLAMP ((gint) y, 0, MESH_ROWS - 2);
  const gfloat *at = ring->mesh + 3 * (frame * MESH_COLUMNS * MESH_ROWS
      + (guint) (j * MESH_COLUMNS + i));
  const gfloat *below = at + 3 * MESH_COLUMNS;

  for (gint k = 0; k < 3; k++)
    X[k] = (1 - (y - j)) * ((1 - (x - i)) * at[k] + (x - i) * at[3 + k])
        + (y - j) * ((1 - (x - i)) * below[k] + (x - i) * below[3 + k]);
}

/* How far from (x, y) a camera of the rig sees the centre of a dot, px. */
static inline gdouble
ring_distance (const Ring * ring, const gchar * camera, guint frame,
    gint column, gint row, gdouble x, gdouble y)
{
  gdouble X[3], px[2];

  ring_place (ring, frame, column, row, X);
  fail_unless (cloth_camera_project (cloth_rig_find (ring->rig, camera), X, px,
          NULL, NULL));
  return hypot (px[0] - x, px[1] - y);
}

/* The first picture of a camera, decoded, I420. */
static inline GstSample *
ring_picture (const gchar * camera)
{
  g_autofree gchar *launch = g_strdup_printf ("filesrc location=\"" RING
      "%s.mp4\" ! qtdemux ! h264parse ! avdec_h264 ! "
      "video/x-raw,format=I420 ! appsink name=sink sync=false", camera);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstElement) pipeline = gst_parse_launch (launch, &error);
  g_autoptr (GstElement) sink = NULL;
  GstSample *sample = NULL;

  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  g_signal_emit_by_name (sink, "try-pull-sample", 60 * GST_SECOND, &sample);
  fail_unless (sample != NULL);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  return sample;
}
