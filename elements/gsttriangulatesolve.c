/* From what the cameras of triangulate saw to places in space.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulatesolve.h"

#include <math.h>

/* (0.1 px)²: a first guess of what a good calibration and a film's compression leave. */
#define FIRST_FLOOR 0.01
/* Rounds in which the first set finds its error floor, and how near is near. */
#define FLOOR_ROUNDS 8
#define FLOOR_NEAR 0.05

void
gst_triangulate_solve_set_board (GstTriangulateSolve * self,
    const GstTriangulateBoard * board)
{
  gsize n = gst_cloth_topology_get_n_vertices (board->topology);

  self->n_vertices = (guint) n;
  self->positions = g_renew (gfloat, self->positions, 3 * n);
  self->covariances = g_renew (gfloat, self->covariances, 6 * n);
  self->wrong = g_renew (gboolean, self->wrong, n);
  /* a number for each row as well */
  self->denials = g_renew (gdouble, self->denials, 2 * n);
  g_clear_pointer (&self->bend, cloth_dot_bend_free);
  if (board->dots) {
    self->bend = cloth_dot_bend_new (board->columns, board->rows,
        board->edge_m, board->dots->diameter_m);
  }
}

void
gst_triangulate_solve_clear (GstTriangulateSolve * self)
{
  g_clear_pointer (&self->triangulator, cloth_triangulator_free);
  g_clear_pointer (&self->bend, cloth_dot_bend_free);
  g_clear_pointer (&self->positions, g_free);
  g_clear_pointer (&self->covariances, g_free);
  g_clear_pointer (&self->wrong, g_free);
  g_clear_pointer (&self->denials, g_free);
}

gdouble
gst_triangulate_solve_get_floor (const GstTriangulateSolve * self)
{
  if (self->parameters.error_floor >= 0) {
    return self->parameters.error_floor;
  }
  return self->floor.weight > 0 ? self->floor.floor : FIRST_FLOOR;
}

static gboolean
triangulate (GstTriangulateSolve * self, guint n_cameras,
    const ClothTriangulateView * views, GError ** error)
{
  ClothTriangulateParameters parameters = self->parameters;

  if (parameters.error_floor < 0) {
    parameters.error_floor = self->floor.floor;
  }
  cloth_triangulator_set_parameters (self->triangulator, &parameters);
  return cloth_triangulator_run (self->triangulator, n_cameras, views,
      self->n_vertices, &self->result, error);
}

static void
read_result (GstTriangulateSolve * self, const GstTriangulateBoard * board)
{
  ClothIsometry isometry = { board->columns, board->rows, board->edge_m,
    self->min_length, self->max_length
  };
  const ClothTriangulation *r = self->result;
  guint i, k;

  for (i = 0; i < self->n_vertices; i++) {
    for (k = 0; k < 3; k++) {
      self->positions[3 * i + k] = (gfloat) r->position[k][i];
    }
    for (k = 0; k < 6; k++) {
      self->covariances[6 * i + k] = (gfloat) r->covariance[k][i];
    }
  }
  cloth_isometry_check (&isometry, self->positions, self->covariances,
      self->wrong, self->denials);
}

/* What was seen, as if the cloth were flat. */
static void
flatten (GstTriangulateSolve * self, const ClothRig * rig,
    const ClothTriangulateView * views)
{
  guint i;

  for (i = 0; i < self->n_vertices; i++) {
    if (self->wrong[i]) {
      self->positions[3 * i] = NAN;
    }
  }
  cloth_dot_bend_set_positions (self->bend, self->positions);
  for (i = 0; i < rig->n_cameras; i++) {
    self->views[i] = views[i];
    if (views[i].x) {
      cloth_dot_bend_correct (self->bend, i, &rig->cameras[i], &views[i],
          &self->views[i]);
    }
  }
}

/* One round: dots a second time, after the first has told how they are bent. */
static gboolean
solve (GstTriangulateSolve * self, const ClothRig * rig,
    const GstTriangulateBoard * board, const ClothTriangulateView * views,
    GError ** error)
{
  if (!triangulate (self, rig->n_cameras, views, error)) {
    return FALSE;
  }
  if (self->bend) {
    read_result (self, board);
    flatten (self, rig, views);
    return triangulate (self, rig->n_cameras, self->views, error);
  }
  return TRUE;
}

gboolean
gst_triangulate_solve_run (GstTriangulateSolve * self, const ClothRig * rig,
    const GstTriangulateBoard * board, const ClothTriangulateView * views,
    GError ** error)
{
  static const GstClothVertexState states[] = {
    [CLOTH_POINT_UNSEEN] = GST_CLOTH_VERTEX_UNSEEN,
    [CLOTH_POINT_MEASURED] = GST_CLOTH_VERTEX_MEASURED,
    [CLOTH_POINT_TWO_VIEWS] = GST_CLOTH_VERTEX_TWO_VIEWS
  };
  const gboolean first = self->floor.weight == 0;
  guint8 *state;
  guint i, round;

  if (first) {
    self->floor.floor = FIRST_FLOOR;
  }
  for (round = 0; round < FLOOR_ROUNDS; round++) {
    gdouble ratio;

    if (!solve (self, rig, board, views, error)) {
      return FALSE;
    }
    if (self->parameters.error_floor >= 0) {
      break;
    }
    ratio = cloth_error_floor_add (&self->floor, rig->n_cameras, views,
        self->result);
    if (!first || isnan (ratio) || fabs (ratio - 1) < FLOOR_NEAR) {
      break;
    }
    if (round + 1 < FLOOR_ROUNDS) {
      self->floor.weight = 0;   /* the same set again */
    }
  }
  read_result (self, board);
  if (self->bend) {
    cloth_dot_bend_add_doubt (self->bend, self->positions, self->covariances);
  }
  state = self->result->state;
  for (i = 0; i < self->n_vertices; i++) {
    state[i] = (guint8) (self->wrong[i] ? GST_CLOTH_VERTEX_UNSEEN :
        states[state[i]]);
  }
  return TRUE;
}
