/* Reality as games have it: extended position-based dynamics in small steps (Macklin et al.
 * 2019). Springs along threads and diagonals and the second differences of threads are
 * constraints of a compliance each; all are met one after the other, once a step.
 *
 * Of a constraint C with stiffness k and lag beta, in a step h from x0: a = 1/(k h^2),
 * g = beta/h, lambda = -(C + g grad C (x - x0))/((1 + g) w + a), as one turn has no lambda yet.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "scene.h"

#define N_STEPS 20
/* Of the stiffness in tension, what cloth has in compression. */
#define COMPRESSION 0.1

typedef struct
{
  int points[3];                /* the last is -1 for a spring */
  double length, stiffness;
} Constraint;

typedef struct
{
  Scene *scene;
  Constraint *constraints;
  int n_constraints;
  double lag;
  double *weight;               /* [points], 1/kg; 0 where held */
  double *x, *v, *before;
} Cloth;

static double
dot (const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void
tie (Cloth * cloth, int a, int b, int c, double length, double stiffness)
{
  cloth->constraints[cloth->n_constraints++] = (Constraint) { {
  a, b, c}, length, stiffness};
}

static void
set_up (Cloth * cloth, Scene * scene)
{
  int columns = scene->columns, rows = scene->rows;
  double du = scene->width / (columns - 1), dv = scene->height / (rows - 1);
  double lu = du * (1. - scene_number (scene, "shrinkage.warp", 0.));
  double lv = dv * (1. - scene_number (scene, "shrinkage.weft", 0.));
  double both = exp (scene_number (scene, "stretch.log_ratio", 0.));
  double apart =
      exp (0.5 * scene_number (scene, "stretch_anisotropy.log_ratio", 0.));
  double warp =
      scene_number (scene, "stretch.warp", 40.) * both * apart * dv / du;
  double weft =
      scene_number (scene, "stretch.weft", 40.) * both / apart * du / dv;
  double shear = scene_number (scene, "shear", 12.) * exp (scene_number (scene,
          "shear.log_ratio", 0.)) * (du * du + dv * dv) / (2. * du * dv);
  double bend = exp (scene_number (scene, "bending.log_ratio", 0.));
  double bend_u =
      bend * scene_number (scene, "bending.warp", 3e-5) * dv / (du * du * du);
  double bend_v =
      bend * scene_number (scene, "bending.weft", 3e-5) * du / (dv * dv * dv);
  cloth->scene = scene;
  cloth->lag = scene_number (scene, "damping.stiffness", 5e-4);
  cloth->constraints = g_new (Constraint, 6 * scene->n_points);
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < columns; i++) {
      int at = j * columns + i;
      double edge_u = j == 0 || j == rows - 1 ? 0.5 : 1., edge_v = i == 0
          || i == columns - 1 ? 0.5 : 1.;
      if (i + 1 < columns)
        tie (cloth, at, at + 1, -1, lu, warp * edge_u);
      if (j + 1 < rows)
        tie (cloth, at, at + columns, -1, lv, weft * edge_v);
      if (i + 1 < columns && j + 1 < rows) {
        tie (cloth, at, at + columns + 1, -1, hypot (lu, lv), shear);
        tie (cloth, at + 1, at + columns, -1, hypot (lu, lv), shear);
      }
      if (i + 2 < columns)
        tie (cloth, at, at + 1, at + 2, 0., bend_u * edge_u);
      if (j + 2 < rows)
        tie (cloth, at, at + columns, at + 2 * columns, 0., bend_v * edge_v);
    }
  cloth->x = g_memdup2 (scene->start, 3 * scene->n_points * sizeof (double));
  cloth->v = g_new0 (double, 3 * scene->n_points);
  cloth->before = g_new (double, 3 * scene->n_points);
  cloth->weight = g_new (double, scene->n_points);
}

static void
meet (Cloth * cloth, const Constraint * c, double h)
{
  static const double folds[3] = { 1., -2., 1. }, ends[3] = { 1., -1., 0. };
  const double *part = c->points[2] < 0 ? ends : folds;
  int n = c->points[2] < 0 ? 2 : 3;
  double way[3] = { 0. }, moved[3] = { 0. }, w = 0., length, g =
      cloth->lag / h, off;
  for (int k = 0; k < n; k++) {
    int at = 3 * c->points[k];
    for (int q = 0; q < 3; q++) {
      way[q] += part[k] * cloth->x[at + q];
      moved[q] += part[k] * (cloth->x[at + q] - cloth->before[at + q]);
    }
    w += part[k] * part[k] * cloth->weight[c->points[k]];
  }
  length = sqrt (dot (way, way));
  if (length < 1e-12 || w <= 0.)
    return;
  off = length - c->length;
  double stiffness = c->stiffness * (off < 0. ? COMPRESSION : 1.);
  double lambda = -(off + g * dot (way, moved) / length) /
      ((1. + g) * w + 1. / (stiffness * h * h));
  for (int k = 0; k < n; k++)
    for (int q = 0; q < 3; q++)
      cloth->x[3 * c->points[k] + q] +=
          cloth->weight[c->points[k]] * lambda * part[k] * way[q] / length;
}

static void
advance (Cloth * cloth, double time, double h, double *force)
{
  const Scene *scene = cloth->scene;
  int n = 3 * scene->n_points;
  memcpy (cloth->before, cloth->x, n * sizeof *cloth->x);
  memset (force, 0, n * sizeof *force);
  scene_add_forces (scene, time, cloth->x, cloth->v, force);
  for (int i = 0; i < scene->n_points; i++)
    cloth->weight[i] = 1. / scene_mass (scene, i, time);
  for (int k = 0; k < n; k++) {
    cloth->v[k] += h * cloth->weight[k / 3] * force[k];
    cloth->x[k] += h * cloth->v[k];
  }
  for (int held = 0; held < scene->n_held; held++) {
    int i = (int) scene->held[held];
    if (!scene_holds (scene, held, time + h))
      continue;
    scene_clamp (scene, held, time + h, cloth->x + 3 * i);
    cloth->weight[i] = 0.;
  }
  for (int k = 0; k < cloth->n_constraints; k++)
    meet (cloth, cloth->constraints + k, h);
  for (int k = 0; k < n; k++)
    cloth->v[k] = (cloth->x[k] - cloth->before[k]) / h;
  for (int i = 0; i < scene->n_points; i++)
    scene_touch (scene, cloth->x + 3 * i, cloth->v + 3 * i);
}

int
main (void)
{
  Scene *scene = scene_read ();
  Cloth cloth = { 0 };
  double *force = g_new (double, 3 * scene->n_points), h =
      scene->interval / N_STEPS;
  set_up (&cloth, scene);
  for (int frame = 0; frame < scene->n_frames; frame++) {
    scene_write (scene, cloth.x);
    for (int s = 0; s < N_STEPS; s++)
      advance (&cloth, frame * scene->interval + s * h, h, force);
  }
  g_free (force);
  g_free (cloth.constraints);
  g_free (cloth.weight);
  g_free (cloth.x);
  g_free (cloth.v);
  g_free (cloth.before);
  scene_free (scene);
  return 0;
}
