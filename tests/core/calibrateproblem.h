/* Boards before cameras: read from files, or filmed by cameras that are known.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"
#include "gst/rig/calibrate.h"
#include "gst/rig/rotation.h"

/* A problem that owns its arrays. */
typedef struct
{
  ClothCamera cameras[4];
  gdouble *board;
  GArray *views;
  ClothCalibrateInput input;
} Problem;

static inline void
problem_init (Problem * p, guint n_cameras, guint columns, guint rows,
    gdouble square, guint n_poses)
{
  memset (p, 0, sizeof *p);
  p->board = g_new0 (gdouble, 3 * columns * rows);
  for (guint i = 0; i < columns * rows; i++) {
    p->board[3 * i] = i % columns * square;
    p->board[3 * i + 1] = i / columns * square;
  }
  p->views = g_array_new (FALSE, TRUE, sizeof (ClothBundleView));
  p->input.n_cameras = n_cameras;
  p->input.cameras = p->cameras;
  p->input.n_vertices = columns * rows;
  p->input.board = p->board;
  p->input.n_poses = n_poses;
  for (guint c = 0; c < n_cameras; c++) {
    ClothCamera *camera = &p->cameras[c];

    camera->name = g_strdup_printf ("cam%u", c);
    camera->width = 640;
    camera->height = 480;
    camera->lens = CLOTH_LENS_BROWN5;
    camera->K[8] = camera->R[0] = camera->R[4] = camera->R[8] = 1;
  }
}

static inline ClothBundleView *
problem_add (Problem * p, guint camera, guint pose)
{
  guint n = p->input.n_vertices;
  ClothBundleView view = { camera, pose, TRUE, 0, g_new0 (guint, n),
    g_new0 (gdouble, n), g_new0 (gdouble, n), NULL
  };

  g_array_append_val (p->views, view);
  p->input.n_views = p->views->len;
  p->input.views = (const ClothBundleView *) p->views->data;
  return &g_array_index (p->views, ClothBundleView, p->views->len - 1);
}

static inline void
problem_clear (Problem * p)
{
  for (guint v = 0; v < p->views->len; v++) {
    ClothBundleView *view = &g_array_index (p->views, ClothBundleView, v);

    g_free ((gpointer) view->vertex);
    g_free ((gpointer) view->x);
    g_free ((gpointer) view->y);
    g_free ((gpointer) view->cov);
  }
  g_array_unref (p->views);
  for (guint c = 0; c < p->input.n_cameras; c++)
    cloth_camera_clear (&p->cameras[c]);
  g_free (p->board);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Problem, problem_clear)
/* Corners that OpenCV found, camera by camera. */
static inline void
load_corners (Problem * p, const gint * cameras)
{
  g_autofree gchar *text = NULL;
  gchar *line;
  ClothBundleView *view = NULL;

  g_assert_true (g_file_get_contents (TEST_DATA
          "/opencv_boards/corners_cv2.txt", &text, NULL, NULL));
  for (line = text; line && *line; line = strchr (line, '\n') + 1) {
    gint side, pose, vertex;
    gdouble x, y;

    g_assert_cmpint (sscanf (line, "%d %d %d %lf %lf", &side, &pose, &vertex,
            &x, &y), ==, 5);
    if (cameras[side] < 0)
      continue;
    if (vertex == 0)
      view = problem_add (p, (guint) cameras[side], (guint) pose);
    /* OpenCV holds corners as floats. */
    ((guint *) view->vertex)[view->n] = (guint) vertex;
    ((gdouble *) view->x)[view->n] = (gfloat) x;
    ((gdouble *) view->y)[view->n++] = (gfloat) y;
  }
}

/* Four cameras on an arc, each with another lens; each sees a part of the poses. */
static inline void
true_rig (ClothCamera * cameras)
{
  static const ClothLens lenses[4] = { CLOTH_LENS_BROWN5, CLOTH_LENS_NONE,
    CLOTH_LENS_FISHEYE, CLOTH_LENS_BROWN8
  };
  static const gdouble k[4][8] = {
    {-.28, .11, .0013, -.0007, -.02}, {0}, {.031, -.012, .004, -.0021},
    {.31, -.22, -.0009, .0011, .05, .6, -.18, .03}
  };

  for (gint c = 0; c < 4; c++) {
    gdouble r[3] = { 0.05 * c, 0.3 * c, 0.02 * c };
    ClothCamera *camera = &cameras[c];

    camera->lens = lenses[c];
    memcpy (camera->k, k[c], sizeof camera->k);
    camera->K[0] = 520 + 10 * c;
    camera->K[4] = 523 + 9 * c;
    camera->K[2] = 320 + 3 * c;
    camera->K[5] = 236 - 2 * c;
    cloth_rotation_from_vector (r, camera->R);
    camera->t[0] = -0.3 * c;
    camera->t[1] = 0.02 * c;
    camera->t[2] = 0.06 * c;
  }
}

/* A board about half a metre from the first camera, tilted every way. */
static inline void
true_pose (ClothRandom * random, gdouble tilt, gdouble pose[12])
{
  gdouble r[3], c[3], Rc[3];

  for (gint j = 0; j < 3; j++)
    r[j] = tilt * (2 * cloth_random_uniform (random) - 1);
  cloth_rotation_from_vector (r, pose);
  c[0] = 0.1 + 0.25 * (2 * cloth_random_uniform (random) - 1);
  c[1] = 0.18 * (2 * cloth_random_uniform (random) - 1);
  c[2] = 0.6 + 0.15 * (2 * cloth_random_uniform (random) - 1);
  cloth_mat3_vec (pose, (const gdouble[3]) { 0.12, 0.09, 0 }, Rc);
  for (gint j = 0; j < 3; j++)
    pose[9 + j] = c[j] - Rc[j];
}

/* Adds what the camera sees of the board, with noise of @sigma px. With @cov corners at
 * the rim of the picture are noisier, and say so. */
static inline void
see (Problem * p, const ClothCamera * truth, guint camera, guint pose,
    const gdouble * P, ClothRandom * random, gdouble sigma, gboolean cov)
{
  ClothBundleView *view = problem_add (p, camera, pose);

  if (cov)
    view->cov = g_new (gdouble, 3 * p->input.n_vertices);
  for (guint i = 0; i < p->input.n_vertices; i++) {
    gdouble X[3], px[2], s = sigma, e[2];

    cloth_mat3_vec (P, p->board + 3 * i, X);
    for (gint j = 0; j < 3; j++)
      X[j] += P[9 + j];
    if (!cloth_camera_project (truth, X, px, NULL, NULL) || px[0] < 0
        || px[1] < 0 || px[0] > 639 || px[1] > 479)
      continue;
    if (cov)
      s *= 0.5 + hypot (px[0] - 320, px[1] - 240) / 250;
    e[0] = s * cloth_random_gaussian (random);
    e[1] = s * cloth_random_gaussian (random);
    ((guint *) view->vertex)[view->n] = i;
    ((gdouble *) view->x)[view->n] = px[0] + e[0];
    ((gdouble *) view->y)[view->n] = px[1] + e[1] + 0.5 * e[0];
    if (cov) {
      gdouble *c = (gdouble *) view->cov + 3 * view->n;

      c[0] = s * s;
      c[1] = 0.5 * s * s;
      c[2] = 1.25 * s * s;
    }
    view->n++;
  }
}

/* The value of a camera's parameter in the order of the results, and what it is known to. */
static inline gdouble
parameter (const ClothCamera * c, guint i, gdouble * sd)
{
  static const guint k_index[4] = { 0, 4, 2, 5 };

  *sd = i < 4 ? c->K_sd[i] : i < 12 ? c->k_sd[i - 4] : i < 15 ?
      c->r_sd[i - 12] : c->t_sd[i - 15];
  if (i < 4)
    return c->K[k_index[i]];
  if (i < 12)
    return c->k[i - 4];
  return i < 15 ? 0 : c->t[i - 15];
}

/* How many standard deviations the first @n parameters of cameras are from the truth, at the
 * most. Those that a lens has not got are as in the truth. */
static inline gdouble
worst_deviation (const ClothRig * rig, const ClothCamera * truth, guint n)
{
  gdouble worst = 0;

  for (guint c = 0; c < rig->n_cameras; c++) {
    for (guint i = 0; i < n; i++) {
      gdouble sd, none, value = parameter (&rig->cameras[c], i, &sd);
      gdouble error = fabs (value - parameter (&truth[c], i, &none));

      if (sd > 0)
        worst = fmax (worst, error / sd);
      else
        g_assert_cmpfloat (error, ==, 0);
    }
  }
  return worst;
}
