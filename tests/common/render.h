/* Draws a printed cloth, bent over a smooth surface, as a pinhole camera sees it: true
 * pictures and true corner positions for tests, owed to no tracker code.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"
#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* Where the point (u, v) of the flat cloth is in the world, metres. Smooth, and defined
 * a little beyond the cloth's edge too. */
typedef void (*TestSurface) (gdouble u, gdouble v, gdouble point[3],
    gpointer data);

/* A cloth hanging in the plane y = 0, its middle at centre, u along x and v along −z;
 * with a travelling wave along its normal, turned by yaw (about z), pitch (about x) and
 * roll (about y), radians, about its middle. */
typedef struct {
  const ClothPattern *pattern;
  gdouble centre[3];
  gdouble yaw, pitch, roll;
  gdouble amplitude_m, wavelength_m, phase, direction;
} TestWave;

/* Occludes; px. Grey is drawn over everything. */
typedef struct {
  gdouble x, y, radius;
  guint8 grey;
} TestDisc;

typedef struct {
  const ClothPattern *pattern;
  /* A pinhole: lens must be none. */
  const ClothCamera *camera;
  TestSurface surface;
  gpointer surface_data;

  guint8 black, white, background;
  const TestDisc *discs;
  guint n_discs;
  /* Where nx·x + ny·y > d (px, n of length 1) light is multiplied by factor; factor 0
   * means no shadow. */
  struct
  {
    gdouble nx, ny, d, factor;
  } shadow;
  /* Standard deviation of the Gaussian blur, px, over the pixel's own square. */
  gdouble blur;
  /* Standard deviation of the noise, grey levels, and its seed. */
  gdouble noise;
  guint64 seed;
} TestScene;

typedef struct {
  gint width, height;
  guint8 *data;
  /* Vertex row·(columns+1)+column of the pattern: pixel position, and whether it can be
   * seen: in the picture, facing the camera, behind neither cloth nor disc. */
  guint n_vertices;
  gdouble *x, *y;
  guint8 *visible;
  /* Square row·columns+column: all of it can be seen. */
  guint n_squares;
  guint8 *square_visible;
} TestRender;

void test_surface_wave (gdouble u, gdouble v, gdouble point[3], gpointer data);

/* At (0, −distance, 0), looking along +y, z up in the picture; the middle of the picture
 * is its principal point. */
ClothCamera test_camera (gint width, gint height, gdouble focal_px,
    gdouble distance_m);

TestRender *test_render (const TestScene * scene);
void test_render_free (TestRender * render);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (TestRender, test_render_free)
G_END_DECLS
