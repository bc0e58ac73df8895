/* Cameras that see the falling sheet of clothgapbench.h.
 *
 * Both are 100 m away from where the sheet starts, so that sights are nearly parallel and 1 px
 * is 1 cm: "front" looks along y, "above" along −z.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/random.h"
#include "tests/elements/clothgapbench.h"

#define FOCAL 10000.
#define DISTANCE 100.
#define SIZE 1000
#define CENTRE 500.
#define X0 0.15
#define Y0 0.1
#define Z0 4.4
#define SIGMA_PX 0.04

#define CAMERA(name, R, t, more) "{\"name\": \"" name "\", \"size\": [1000, 1000], " \
    "\"K\": [[10000, 0, 500], [0, 10000, 500], [0, 0, 1]], \"distortion\": " \
    "{\"model\": \"none\", \"coefficients\": []}, \"R\": " R ", \"t\": " t more "}"
#define FRONT(name, more) CAMERA (name, "[[1, 0, 0], [0, 0, -1], [0, 1, 0]]", \
    "[-0.15, 4.4, 100]", more)
#define ABOVE CAMERA ("above", "[[1, 0, 0], [0, -1, 0], [0, 0, -1]]", \
    "[-0.15, 0.1, 105]", "")
#define RIG(cameras) "{\"version\": 1, \"cameras\": [" cameras "]}"

static inline void
put_file (const gchar * name, const gchar * text)
{
  g_autofree gchar *path = in_folder (name);

  g_assert_true (g_file_set_contents (path, text, -1, NULL));
}

static inline void
make_rigs (void)
{
  put_take ("seen", COLUMNS, ROWS, FALSE, ACCELERATION);
  put_file ("seen/rig.json", RIG (FRONT ("front", "") ", " ABOVE));
  put_file ("one.json", RIG (FRONT ("only", "")));
  put_file ("late.json", RIG (FRONT ("front", ", \"offset_s\": 0.01")));
  put_file ("broken.json", "{");
}

/* The pinhole's own formula. */
static inline void
project (const gfloat place[3], gboolean above, gfloat px[2])
{
  gdouble x = place[0] - X0, y = place[1] - Y0, z = place[2];

  px[0] = (gfloat) (CENTRE + FOCAL * x / (above ? DISTANCE + 5 - z :
          DISTANCE + place[1]));
  px[1] = (gfloat) (CENTRE - FOCAL * (above ? y / (DISTANCE + 5 - z) :
          (z - Z0) / (DISTANCE + place[1])));
}

typedef struct
{
  gboolean above, dots;
  const gchar *name;            /* in the metas */
  gdouble acceleration;
  gdouble shift;                /* across, m, from frame 60 on */
  ClothRandom *noise;
  gint missing;
  guint n_seen;                 /* of dots, the first ones; 0: all */
  gint wrong;                   /* taken for one far away; 0: none */
  guint columns;                /* of the pattern's vertices; 0: as the cloth */
} Look;

static const Look front = {.dots = TRUE,.name = "front",.acceleration =
      ACCELERATION,.missing = -1
};

static inline void
add_dots (GstBuffer * picture, const Look * look, guint frame,
    gfloat (*px)[2], guint columns)
{
  GstClothDot dots[N] = { {0} };
  const gfloat variance = (gfloat) (SIGMA_PX * SIGMA_PX);

  for (guint i = 0; i < N; i++) {
    dots[i].column = (gint) (i % COLUMNS);
    dots[i].row = (gint) (i / COLUMNS);
    dots[i].x = px[i][0];
    dots[i].y = px[i][1];
    dots[i].cov_xx = dots[i].cov_yy = variance;
    dots[i].touches = (gint) i == look->missing || (look->n_seen
        && i >= look->n_seen);
  }
  gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new (look->name,
          frame, columns, ROWS, 4, dots, N));
}

static inline void
add_quads (GstBuffer * picture, const Look * look, guint frame,
    gfloat (*px)[2], guint columns)
{
  GstClothQuad quads[(COLUMNS - 1) * (ROWS - 1)] = { {0} };
  guint n = 0;

  for (guint row = 0; row + 1 < ROWS; row++)
    for (guint column = 0; column + 1 < COLUMNS; column++, n++) {
      const guint first = row * COLUMNS + column;
      const guint corners[4] = { first, first + 1, first + COLUMNS + 1,
        first + COLUMNS
      };

      quads[n].column = (gint) column;
      quads[n].row = (gint) row;
      quads[n].confidence = 1;
      for (guint c = 0; c < 4; c++) {
        quads[n].x[c] = px[corners[c]][0];
        quads[n].y[c] = px[corners[c]][1];
        quads[n].cov_xx[c] = quads[n].cov_yy[c] =
            (gfloat) (SIGMA_PX * SIGMA_PX);
      }
    }
  gst_buffer_add_cloth_quads_meta (picture, gst_cloth_quads_new (look->name,
          frame, columns - 1, ROWS - 1, quads, n));
}

static inline GstBuffer *
see (const Look * look, guint frame)
{
  g_autoptr (GstBuffer) picture = gst_buffer_new ();
  GstBuffer *observation;
  gfloat places[3 * N], px[N][2];
  guint columns = look->columns ? look->columns : COLUMNS;

  find_places (frame, look->acceleration, places);
  for (guint i = 0; i < N; i++) {
    places[3 * i] += frame >= 60 ? (gfloat) look->shift : 0;
    project (places + 3 * i, look->above, px[i]);
    for (guint k = 0; k < 2 && look->noise; k++)
      px[i][k] += (gfloat) (SIGMA_PX * cloth_random_gaussian (look->noise));
  }
  if (look->wrong)
    px[look->wrong][0] += 60;
  if (look->dots)
    add_dots (picture, look, frame, px, columns);
  else
    add_quads (picture, look, frame, px, columns);
  observation = gst_cloth_observations_pack (picture);
  GST_BUFFER_PTS (observation) = gst_util_uint64_scale (frame, GST_SECOND, FPS);
  GST_BUFFER_DURATION (observation) = GST_SECOND / FPS;
  return observation;
}

/* A picture without squares or dots. */
static inline GstBuffer *
see_nothing (guint frame)
{
  g_autoptr (GstBuffer) nothing = gst_buffer_new ();
  GstBuffer *observation = gst_cloth_observations_pack (nothing);

  GST_BUFFER_PTS (observation) = frame * GST_SECOND / FPS;
  return observation;
}

static inline GstCaps *
make_camera_caps (gint size, gint fps)
{
  return gst_caps_new_simple (GST_CLOTH_OBSERVATIONS_MEDIA_TYPE, "version",
      G_TYPE_INT, 1, "width", G_TYPE_INT, size, "height", G_TYPE_INT, size,
      "framerate", GST_TYPE_FRACTION, fps, 1, NULL);
}
