/* Scenes of the benchmark's own simulators: what they read, and what acts from outside.
 * Nothing of the project's simulator is in here.
 *
 * A scene is text on standard input, a key, a count and as many numbers a line. Effects have
 * the names and units of docs/effects.md, as air_drag.coefficient.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double
dot (const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double
scene_number (const Scene * scene, const char *key, double otherwise)
{
  GArray *list = g_hash_table_lookup (scene->lists, key);
  return list && list->len ? g_array_index (list, double, 0) : otherwise;
}

const double *
scene_list (const Scene * scene, const char *key, int *count)
{
  GArray *list = g_hash_table_lookup (scene->lists, key);
  *count = list ? (int) list->len : 0;
  return list ? (const double *) list->data : NULL;
}

static const double *
need (const Scene * scene, const char *key, int count)
{
  int n;
  const double *list = scene_list (scene, key, &n);
  if (n != count) {
    fprintf (stderr, "scene: %s has %d numbers, not %d\n", key, n, count);
    exit (2);
  }
  return list;
}

/* Two triangles a cell, cut along alternating diagonals. */
static void
cut (Scene * scene)
{
  int k = 0;
  scene->n_triangles = 2 * (scene->columns - 1) * (scene->rows - 1);
  scene->triangles = g_new (int, 3 * scene->n_triangles);
  for (int j = 0; j + 1 < scene->rows; j++)
    for (int i = 0; i + 1 < scene->columns; i++) {
      int a = j * scene->columns + i, b = a + 1, c = a + scene->columns, d =
          c + 1;
      int one[2][3] = { {a, b, c}, {b, d, c} }, other[2][3] =
          { {a, b, d}, {a, d, c} };
      for (int t = 0; t < 2; t++, k++)
        for (int q = 0; q < 3; q++)
          scene->triangles[3 * k + q] = (i + j) % 2 ? one[t][q] : other[t][q];
    }
}

/* Lumped masses; of the rows of cells that a heavy band cuts, the share in it counts. */
static void
weigh (Scene * scene)
{
  double cell = scene->height / (scene->rows - 1), factor, height;
  double density = scene_number (scene, "areal_density", 0.15) *
      exp (scene_number (scene, "areal_mass.log_ratio", 0.));
  factor = scene_number (scene, "mass_distribution.factor", 1.);
  height = scene_number (scene, "mass_distribution.height", 0.02);
  scene->mass = g_new0 (double, scene->n_points);
  scene->area = g_new (double, scene->n_triangles);
  for (int k = 0; k < scene->n_triangles; k++) {
    int row = k / 2 / (scene->columns - 1);
    double below = scene->height - height - row * cell;
    double heavy = CLAMP (1. - below / cell, 0., 1.);
    scene->area[k] = 0.5 * cell * scene->width / (scene->columns - 1);
    for (int q = 0; q < 3; q++)
      scene->mass[scene->triangles[3 * k + q]] +=
          density * scene->area[k] * (1. + (factor - 1.) * heavy) / 3.;
  }
}

/* What hangs is turned by the rotation vector (y, -x, 0). */
static void
pull (Scene * scene)
{
  double x = scene_number (scene, "gravity_tilt.x", 0.) * G_PI / 180.;
  double y = scene_number (scene, "gravity_tilt.y", 0.) * G_PI / 180.;
  double angle = hypot (x, y), g =
      9.81 * scene_number (scene, "gravity_scale.factor", 1.);
  double part = angle > 0. ? sin (angle) / angle : 1.;
  scene->gravity[0] = g * part * x;
  scene->gravity[1] = g * part * y;
  scene->gravity[2] = -g * cos (angle);
}

static void
free_list (gpointer list)
{
  g_array_free (list, TRUE);
}

/* Reads standard input; ends the program where that is no scene. */
Scene *
scene_read (void)
{
  Scene *scene = g_new0 (Scene, 1);
  char key[64];
  int count;
  scene->lists =
      g_hash_table_new_full (g_str_hash, g_str_equal, g_free, free_list);
  while (scanf ("%63s %d", key, &count) == 2) {
    GArray *list = g_array_new (FALSE, FALSE, sizeof (double));
    for (int k = 0; k < count; k++) {
      double value;
      if (scanf ("%lf", &value) != 1) {
        fprintf (stderr, "scene: %s is cut off\n", key);
        exit (2);
      }
      g_array_append_val (list, value);
    }
    g_hash_table_replace (scene->lists, g_strdup (key), list);
  }
  scene->columns = (int) need (scene, "grid", 4)[0];
  scene->rows = (int) need (scene, "grid", 4)[1];
  scene->width = need (scene, "grid", 4)[2];
  scene->height = need (scene, "grid", 4)[3];
  scene->n_points = scene->columns * scene->rows;
  scene->n_frames = (int) need (scene, "frames", 2)[0];
  scene->interval = need (scene, "frames", 2)[1];
  scene->held = scene_list (scene, "held", &scene->n_held);
  scene->until = need (scene, "until", scene->n_held);
  scene->paths = need (scene, "paths", 3 * scene->n_frames * scene->n_held);
  scene->start = need (scene, "start", 3 * scene->n_points);
  cut (scene);
  weigh (scene);
  pull (scene);
  return scene;
}

void
scene_free (Scene * scene)
{
  g_hash_table_unref (scene->lists);
  g_free (scene->triangles);
  g_free (scene->area);
  g_free (scene->mass);
  g_free (scene);
}

gboolean
scene_holds (const Scene * scene, int held, double time)
{
  return time < scene->until[held];
}

/* A clamp's place on a Catmull-Rom cubic through its path. */
void
scene_clamp (const Scene * scene, int held, double time, double *place)
{
  double at = CLAMP (time / scene->interval, 0., scene->n_frames - 1.);
  int k = MIN ((int) at, scene->n_frames - 2);
  double s = at - k;
  for (int q = 0; q < 3; q++) {
    double p[4];
    for (int i = 0; i < 4; i++)
      p[i] =
          scene->paths[(CLAMP (k + i - 1, 0,
                  scene->n_frames - 1) * scene->n_held + held) * 3 + q];
    place[q] =
        p[1] + 0.5 * s * (p[2] - p[0] + s * (2. * p[0] - 5. * p[1] + 4. * p[2] -
            p[3] + s * (3. * (p[1] - p[2]) + p[3] - p[0])));
  }
}

/* A wet patch, {column, row, radius, factor, s}, all but s in vertices, dries evenly. */
double
scene_mass (const Scene * scene, int point, double time)
{
  int count;
  const double *wet = scene_list (scene, "wet", &count);
  double mass = scene->mass[point];
  if (count == 5) {
    double u = point % scene->columns - wet[0], v =
        point / scene->columns - wet[1];
    if (u * u + v * v < wet[2] * wet[2])
      mass *= 1. + (wet[3] - 1.) * MAX (1. - time / wet[4], 0.);
  }
  return mass;
}

static double
blunt (double speed, double turbulence)
{
  return sqrt (speed * speed + turbulence * turbulence);
}

/* The pressure of a wind on cloth that moves at vn along its normal n, over the drag at rest. */
static double
blow (const double *wind, const double *law, const double *n, double vn)
{
  double from = dot (wind, n) - vn;
  return 0.6 * law[0] * (blunt (from, law[1]) * from + blunt (vn, law[1]) * vn);
}

static void
add_air (const Scene * scene, double time, const double *x, const double *v,
    double *force)
{
  double drag = scene_number (scene, "air_drag.coefficient", 0.);
  double linear = scene_number (scene, "air_drag_linear.coefficient", 0.);
  double along = scene_number (scene, "air_drag_tangential.coefficient", 0.);
  double wind[3] =
      { scene_number (scene, "wind.x", 0.), scene_number (scene, "wind.y", 0.),
    scene_number (scene, "wind.z", 0.)
  };
  int n_gusts;
  const double *speeds = scene_list (scene, "gust.speeds", &n_gusts);
  double azimuth = scene_number (scene, "gust.azimuth", 90.) * G_PI / 180.;
  double gust[3] = { 0. };
  double steady[2] = { scene_number (scene, "wind.coefficient", 1.5),
    scene_number (scene, "wind.turbulence", 0.5)
  };
  double changing[2] = { scene_number (scene, "gust.coefficient", 1.5),
    scene_number (scene, "gust.turbulence", 0.5)
  };
  gboolean windy = dot (wind, wind) > 0.;
  if (n_gusts) {
    double speed =
        speeds[CLAMP ((int) (time / scene->interval), 0, n_gusts - 1)];
    gust[0] = speed * cos (azimuth);
    gust[1] = speed * sin (azimuth);
  }
  if (drag <= 0. && linear <= 0. && along <= 0. && !windy && !n_gusts)
    return;
  for (int k = 0; k < scene->n_triangles; k++) {
    const int *t = scene->triangles + 3 * k;
    double a[3], b[3], n[3], mean[3], length, vn, pressure, area;
    for (int q = 0; q < 3; q++) {
      a[q] = x[3 * t[1] + q] - x[3 * t[0] + q];
      b[q] = x[3 * t[2] + q] - x[3 * t[0] + q];
      mean[q] = (v[3 * t[0] + q] + v[3 * t[1] + q] + v[3 * t[2] + q]) / 3.;
    }
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
    length = sqrt (dot (n, n)) + 1e-30;
    for (int q = 0; q < 3; q++)
      n[q] /= length;
    area = 0.5 * length / 3.;
    vn = dot (mean, n);
    pressure = -0.6 * drag * fabs (vn) * vn;
    if (windy)
      pressure += blow (wind, steady, n, vn);
    if (n_gusts)
      pressure += blow (gust, changing, n, vn);
    for (int q = 0; q < 3; q++) {
      double f =
          area * (pressure * n[q] - linear * mean[q] - along * (mean[q] -
              vn * n[q]));
      for (int i = 0; i < 3; i++)
        force[3 * t[i] + q] += f;
    }
  }
}

/* A thread from a point of the cloth to one of the world, {point, x, y, z, length, N/m}, and
 * a plane that pulls, {x, y, z of its normal, offset, N/m2 at it, reach}. */
static void
add_strange (const Scene * scene, const double *x, const double *mass,
    double *force)
{
  int count;
  const double *thread = scene_list (scene, "thread", &count);
  double d[3];
  if (count == 6) {
    int point = (int) thread[0];
    for (int q = 0; q < 3; q++)
      d[q] = thread[1 + q] - x[3 * point + q];
    double length = sqrt (dot (d, d));
    for (int q = 0; q < 3 && length > thread[4]; q++)
      force[3 * point + q] += thread[5] * (length - thread[4]) * d[q] / length;
  }
  const double *plane = scene_list (scene, "attraction", &count);
  double density = scene_number (scene, "areal_density", 0.15);
  for (int i = 0; count == 6 && i < scene->n_points; i++) {
    double apart = dot (plane, x + 3 * i) - plane[3];
    for (int q = 0; q < 3; q++)
      force[3 * i + q] -=
          mass[i] / density * plane[4] * exp (-fabs (apart) / plane[5]) *
          plane[q];
  }
}

/* Adds all that acts from outside but clamps and obstacles: weight, air, friction of air with
 * all mass, and what no effect is. */
void
scene_add_forces (const Scene * scene, double time, const double *x,
    const double *v, double *force)
{
  double alpha = scene_number (scene, "damping.mass", 0.3) +
      scene_number (scene, "damping_mass.rate", 0.);
  int n_drops;
  const double *drops = scene_list (scene, "rain", &n_drops);
  for (int i = 0; i < scene->n_points; i++) {
    double mass = scene_mass (scene, i, time);
    for (int q = 0; q < 3; q++)
      force[3 * i + q] += mass * (scene->gravity[q] - alpha * v[3 * i + q]);
  }
  /* Drops {s, point, N s}, down, each within 10 ms. */
  for (int k = 0; k + 2 < n_drops; k += 3)
    if (time >= drops[k] && time < drops[k] + 0.01)
      force[3 * (int) drops[k + 1] + 2] -= drops[k + 2] / 0.01;
  add_air (scene, time, x, v, force);
  add_strange (scene, x, scene->mass, force);
}

/* Moves a point out of obstacles, {x, y, z, radius} for balls, {x, y, z of the normal, offset}
 * for planes; takes away the speed into them and by Coulomb's law that along them. */
gboolean
scene_touch (const Scene * scene, double *x, double *v)
{
  int n_balls, n_planes;
  const double *balls = scene_list (scene, "balls", &n_balls);
  const double *planes = scene_list (scene, "planes", &n_planes);
  double friction = scene_number (scene, "friction.coefficient", 0.);
  gboolean touched = FALSE;
  for (int k = 0; k < n_balls + n_planes; k += 4) {
    const double *o = k < n_balls ? balls + k : planes + k - n_balls;
    double n[3], depth;
    if (k < n_balls) {
      for (int q = 0; q < 3; q++)
        n[q] = x[q] - o[q];
      double length = sqrt (dot (n, n)) + 1e-30;
      for (int q = 0; q < 3; q++)
        n[q] /= length;
      depth = o[3] - length;
    } else {
      for (int q = 0; q < 3; q++)
        n[q] = o[q];
      depth = o[3] - dot (n, x);
    }
    if (depth <= 0.)
      continue;
    double vn = dot (v, n), along[3], speed;
    touched = TRUE;
    for (int q = 0; q < 3; q++) {
      x[q] += depth * n[q];
      along[q] = v[q] - vn * n[q];
    }
    speed = sqrt (dot (along, along)) + 1e-30;
    double lost = vn < 0. ? MIN (friction * -vn / speed, 1.) : 0.;
    for (int q = 0; q < 3; q++)
      v[q] = (1. - lost) * along[q] + MAX (vn, 0.) * n[q];
  }
  return touched;
}

/* Writes all points as float32. */
void
scene_write (const Scene * scene, const double *x)
{
  for (int k = 0; k < 3 * scene->n_points; k++) {
    float value = (float) x[k];
    if (!isfinite (value) || fabsf (value) > 100.f) {
      fprintf (stderr, "the simulation has run away\n");
      exit (1);
    }
    if (fwrite (&value, sizeof value, 1, stdout) != 1)
      exit (1);
  }
}
