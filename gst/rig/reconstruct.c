/* From what the cameras of a rig saw of a cloth at one instant to where its vertices are.
 *
 * Each vertex is triangulated alone, with its covariance (triangulate.h). Three things are
 * known beyond that:
 *
 * - Observations have errors that their covariances know nothing of. Their variance, the
 *   error floor, is estimated from the residuals (errorfloor.h). The first set is solved
 *   with a guess, then again with what its residuals tell, until χ² over its degrees of
 *   freedom is 1 within 5%; each later set corrects the estimate.
 * - The centre of gravity of a dot's picture is not the picture of its centre when the
 *   cloth is bent (dotbend.h). The positions of a first pass tell how it is bent; the
 *   second pass has corrected observations.
 * - Cloth hardly stretches (isometry.h): vertices whose distances from their neighbours no
 *   cloth allows are wrong.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/reconstruct.h"

#include <math.h>

#include "gst/math/statistics.h"
#include "gst/rig/dotbend.h"
#include "gst/rig/errorfloor.h"
#include "gst/rig/isometry.h"
#include "gst/rig/windowbend.h"

/* (0.1 px)²: a first guess of what a good calibration and a film's compression leave. */
#define FIRST_FLOOR 0.01
/* Rounds in which the first set finds its error floor, and how near is near. */
#define FLOOR_ROUNDS 8
#define FLOOR_NEAR 0.05

struct _ClothReconstruction
{
  const ClothRig *rig;
  ClothReconstructionGrid grid;
  ClothReconstructionParameters parameters;
  ClothTriangulator *triangulator;
  ClothDotBend *bend;           /* NULL: corners */
  ClothErrorFloor floor;        /* of no weight before the first set */
  gboolean *wrong;              /* whether the isometry check denies a vertex */
  gdouble *denials;             /* room for it */
  gdouble *creases;             /* room for windows on bent cloth */
  ClothTriangulateView flat[CLOTH_RIG_MAX_CAMERAS];     /* views without the bend */
  const ClothTriangulation *triangulation;      /* of the last pass */
  ClothReconstructed result;
};

/* @rig: two or more cameras, which must outlive the reconstruction
 *
 * Returns: (transfer full): one with the default parameters, whose grid is to be set;
 *   %NULL with a %CLOTH_TRIANGULATE_ERROR when the cameras can't be used
 */
ClothReconstruction *
cloth_reconstruction_new (const ClothRig * rig, GError ** error)
{
  static const ClothReconstructionParameters standard =
      CLOTH_RECONSTRUCTION_PARAMETERS_DEFAULT;
  ClothTriangulator *triangulator = cloth_triangulator_new (rig->n_cameras,
      rig->cameras, error);
  ClothReconstruction *self;

  if (!triangulator)
    return NULL;
  self = g_new0 (ClothReconstruction, 1);
  self->rig = rig;
  self->parameters = standard;
  self->triangulator = triangulator;
  return self;
}

/* @self: (nullable) (transfer full): what cloth_reconstruction_new () gave
 */
void
cloth_reconstruction_free (ClothReconstruction * self)
{
  if (!self)
    return;
  cloth_triangulator_free (self->triangulator);
  cloth_dot_bend_free (self->bend);
  g_free (self->wrong);
  g_free (self->denials);
  g_free (self->creases);
  g_free (self->result.positions);
  g_free (self->result.covariances);
  g_free (self->result.states);
  g_free (self);
}

/* @self: a reconstruction
 * @grid: what is on the cloth, from the next set on
 *
 * What is known of the error floor stays: it is the cameras'.
 */
void
cloth_reconstruction_set_grid (ClothReconstruction * self,
    const ClothReconstructionGrid * grid)
{
  ClothReconstructed *result = &self->result;
  const gsize n = (gsize) grid->columns * grid->rows;

  self->grid = *grid;
  result->n_vertices = (guint) n;
  result->positions = g_renew (gfloat, result->positions, 3 * n);
  result->covariances = g_renew (gfloat, result->covariances, 6 * n);
  result->states = g_renew (guint8, result->states, n);
  self->wrong = g_renew (gboolean, self->wrong, n);
  /* a number for each row as well */
  self->denials = g_renew (gdouble, self->denials, n + grid->rows);
  self->creases = g_renew (gdouble, self->creases, 3 * n);
  g_clear_pointer (&self->bend, cloth_dot_bend_free);
  if (grid->dot_m > 0)
    self->bend = cloth_dot_bend_new (grid->columns, grid->rows, grid->edge_m[0],
        grid->dot_m);
}

/* @self: a reconstruction
 * @parameters: of the next sets
 */
void
cloth_reconstruction_set_parameters (ClothReconstruction * self,
    const ClothReconstructionParameters * parameters)
{
  self->parameters = *parameters;
}

/* @self: a reconstruction
 * @pool: (nullable): threads to use, which must outlive their use; %NULL: the calling
 *   thread. The results are the same bytes.
 */
void
cloth_reconstruction_set_pool (ClothReconstruction * self, ClothPool * pool)
{
  cloth_triangulator_set_pool (self->triangulator, pool);
}

/* @self: a reconstruction
 *
 * Returns: variance on top of what each observation states that the next set starts from,
 *   px²
 */
gdouble
cloth_reconstruction_get_error_floor (const ClothReconstruction * self)
{
  if (self->parameters.triangulate.error_floor >= 0)
    return self->parameters.triangulate.error_floor;
  return self->floor.weight > 0 ? self->floor.floor : FIRST_FLOOR;
}

/* @self: a reconstruction
 *
 * Returns: how far neighbours of the last set were apart over their distance on the flat
 *   cloth, in the median, before any vertex was dropped for it; NaN where no neighbours
 *   were seen
 */
gdouble
cloth_reconstruction_get_stretch (const ClothReconstruction * self)
{
  const ClothTriangulation *t = self->triangulation;
  const guint columns = self->grid.columns;
  g_autoptr (GArray) ratios = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint i = 0; i < self->result.n_vertices; i++)
    for (guint k = 0; k < 2; k++) {
      const guint next = i + (k ? columns : 1);
      gdouble squares = 0, ratio;

      if (k ? next >= self->result.n_vertices : next % columns == 0)
        continue;
      for (guint axis = 0; axis < 3; axis++)
        squares += pow (t->position[axis][next] - t->position[axis][i], 2);
      ratio = sqrt (squares) / self->grid.edge_m[k];
      if (isfinite (ratio))
        g_array_append_val (ratios, ratio);
    }
  return cloth_median ((gdouble *) (gpointer) ratios->data, ratios->len);
}

/* @self: a reconstruction
 * @stretch: distance of neighbours over that on the flat cloth
 *
 * Returns: whether it is within the limits beyond which vertices are dropped
 */
gboolean
cloth_reconstruction_allows (const ClothReconstruction * self, gdouble stretch)
{
  return stretch >= self->parameters.shortest
      && (self->parameters.longest == 0 || stretch <= self->parameters.longest);
}

/* Each vertex alone, with the error floor as it is estimated now. */
static gboolean
triangulate (ClothReconstruction * self, const ClothTriangulateView * views,
    GError ** error)
{
  ClothTriangulateParameters parameters = self->parameters.triangulate;

  if (parameters.error_floor < 0)
    parameters.error_floor = self->floor.floor;
  cloth_triangulator_set_parameters (self->triangulator, &parameters);
  return cloth_triangulator_run (self->triangulator, self->rig->n_cameras,
      views, self->result.n_vertices, &self->triangulation, error);
}

/* Copies the positions and covariances of the last pass, and finds the wrong ones. */
static void
read_pass (ClothReconstruction * self)
{
  const ClothIsometry isometry = { self->grid.columns, self->grid.rows,
    {self->grid.edge_m[0], self->grid.edge_m[1]},
    self->parameters.shortest, self->parameters.longest
  };
  const ClothTriangulation *t = self->triangulation;
  ClothReconstructed *result = &self->result;

  for (guint i = 0; i < result->n_vertices; i++) {
    for (guint k = 0; k < 3; k++)
      result->positions[3 * i + k] = (gfloat) t->position[k][i];
    for (guint k = 0; k < 6; k++)
      result->covariances[6 * i + k] = (gfloat) t->covariance[k][i];
  }
  cloth_isometry_check (&isometry, result->positions, result->covariances,
      self->wrong, self->denials);
}

/* What was seen of the dots, as if the cloth were flat at each of them. */
static void
flatten (ClothReconstruction * self, const ClothTriangulateView * views)
{
  for (guint i = 0; i < self->result.n_vertices; i++)
    if (self->wrong[i])
      self->result.positions[3 * i] = NAN;
  cloth_dot_bend_set_positions (self->bend, self->result.positions);
  for (guint i = 0; i < self->rig->n_cameras; i++) {
    self->flat[i] = views[i];
    if (views[i].x)
      cloth_dot_bend_correct (self->bend, i, &self->rig->cameras[i], &views[i],
          &self->flat[i]);
  }
}

/* One round: dots a second time, after the first has told how they are bent. */
static gboolean
solve (ClothReconstruction * self, const ClothTriangulateView * views,
    GError ** error)
{
  if (!triangulate (self, views, error))
    return FALSE;
  if (!self->bend)
    return TRUE;
  read_pass (self);
  flatten (self, views);
  return triangulate (self, self->flat, error);
}

/* Solves a set, the first one until its error floor stands. */
static gboolean
solve_with_floor (ClothReconstruction * self,
    const ClothTriangulateView * views, GError ** error)
{
  const gboolean first = self->floor.weight == 0;

  if (first)
    self->floor.floor = FIRST_FLOOR;
  for (guint round = 0; round < FLOOR_ROUNDS; round++) {
    gdouble ratio;

    if (!solve (self, views, error))
      return FALSE;
    if (self->parameters.triangulate.error_floor >= 0)
      return TRUE;
    ratio = cloth_error_floor_add (&self->floor, self->rig->n_cameras, views,
        self->triangulation);
    if (!first || isnan (ratio) || fabs (ratio - 1) < FLOOR_NEAR)
      return TRUE;
    if (round + 1 < FLOOR_ROUNDS)
      self->floor.weight = 0;   /* the same set again */
  }
  return TRUE;
}

/* How often each camera contradicts the others. */
static void
compare_cameras (ClothReconstruction * self, const ClothTriangulateView * views)
{
  const ClothTriangulation *t = self->triangulation;
  ClothReconstructed *result = &self->result;

  for (guint c = 0; c < self->rig->n_cameras; c++) {
    result->n_compared[c] = result->n_left_out[c] = 0;
    for (guint i = 0; views[c].x && i < t->n_points; i++) {
      if (isfinite (views[c].x[i]) && t->reason[i] != CLOTH_POINT_FEW_VIEWS) {
        result->n_compared[c]++;
        result->n_left_out[c] += !(t->views[i] >> c & 1);
      }
    }
  }
}

/* @self: a reconstruction with a grid
 * @views: (array): what each camera of the rig saw of each vertex at one instant
 *
 * Returns: (transfer none): where the vertices are, valid until the next call; %NULL with
 *   a %CLOTH_TRIANGULATE_ERROR when the grid has too many vertices
 */
const ClothReconstructed *
cloth_reconstruction_run (ClothReconstruction * self,
    const ClothTriangulateView * views, GError ** error)
{
  ClothReconstructed *result = &self->result;

  if (!solve_with_floor (self, views, error))
    return NULL;
  read_pass (self);
  if (self->bend)
    cloth_dot_bend_add_doubt (self->bend, result->positions,
        result->covariances);
  for (guint i = 0; i < result->n_vertices; i++) {
    result->states[i] = self->triangulation->state[i];
    if (self->wrong[i]) {
      result->states[i] = CLOTH_POINT_UNSEEN;
      for (guint k = 0; k < 3; k++)
        result->positions[3 * i + k] = NAN;
    }
  }
  if (self->grid.window_px > 0)
    cloth_window_bend_correct (self->grid.columns, self->grid.rows,
        self->grid.window_px, self->rig, views, result->positions,
        result->covariances, self->creases);
  compare_cameras (self, views);
  result->error_floor = cloth_reconstruction_get_error_floor (self);
  return result;
}
