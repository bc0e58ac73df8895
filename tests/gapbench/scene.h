/* Scenes of the benchmark's own simulators: what they read, and what acts from outside.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS
/* A grid of points, point = row * columns + column, flat at (u, v) before anything moves it. */
typedef struct
{
  GHashTable *lists;            /* key to GArray of double */
  int columns, rows, n_points, n_frames, n_held, n_triangles;
  double width, height;         /* m */
  double interval;              /* s between frames */
  const double *held, *paths;   /* [n_held], [n_frames][n_held][3] */
  const double *until;          /* [n_held], s: let go from then on */
  const double *start;          /* [n_points][3] */
  int *triangles;               /* [n_triangles][3] */
  double *area;                 /* [n_triangles], m2 of flat cloth */
  double *mass;                 /* [n_points], kg */
  double gravity[3];
} Scene;

Scene *scene_read (void);
void scene_free (Scene * scene);
double scene_number (const Scene * scene, const char *key, double otherwise);
const double *scene_list (const Scene * scene, const char *key, int *count);
gboolean scene_holds (const Scene * scene, int held, double time);
void scene_clamp (const Scene * scene, int held, double time, double *place);
double scene_mass (const Scene * scene, int point, double time);
void scene_add_forces (const Scene * scene, double time, const double *x, const double *v,
    double *force);
gboolean scene_touch (const Scene * scene, double *x, double *v);
void scene_write (const Scene * scene, const double *x);
G_END_DECLS
