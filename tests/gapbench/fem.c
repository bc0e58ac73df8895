/* Reality by finite elements: triangles of a St. Venant-Kirchhoff membrane, a tenth as
 * stiff in compression, hinges that bend, velocity Verlet steps. Reads a scene, writes float32
 * [frames][points][3].
 *
 * Membrane: E = (F^T F - 1)/2 with F = dx/d(uv); energies C_w E_uu^2/2 + C_f E_vv^2/2 +
 * G (2 E_uv)^2/2 of each unit of area; all stresses lag by beta.
 * Hinges: moment B phi (L^2/A) with phi = 2 tan(theta/2) about each inner edge (Grinspun et al.
 * 2003; gradients: Bridson, Marino and Fedkiw 2003). Between the threads' directions B goes
 * with the square of the cosine; diagonals have what makes a twist cost (B_w + B_f)/2.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene.h"

/* Of the largest stable step; of the stiffness in tension, what cloth has in compression. */
#define MARGIN 0.7
#define COMPRESSION 0.1

typedef struct
{
  int a, b, c, d;               /* edge a-b, c and d beside it */
  double stiffness;             /* N m */
  double width;                 /* m: theta over curvature */
  double least;                 /* m4: squares of crushed triangles' sides count as this */
  double made, rest;            /* phi of the edge at rest, as made and by now */
} Hinge;

typedef struct
{
  Scene *scene;
  double warp, weft, shear, lag, ratio, knee, tension, strain, stiff_line;
  double softening, plastic, yield, added, compliance;
  double *inverse;              /* [triangles][4] of the edges in material axes */
  double *stiffer;              /* [triangles] */
  double *friction;             /* [triangles][2], N/m, after Dahl */
  Hinge *hinges;
  int n_hinges;
} Sheet;

static double
dot (const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void
cross (const double *a, const double *b, double *c)
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* A point of the flat cloth in the axes of its threads, as shrunk as they are. */
static void
flatten (const Scene * scene, int point, double *uv)
{
  double angle = scene_number (scene, "grain_angle.angle", 0.) * G_PI / 180.;
  double u = point % scene->columns * scene->width / (scene->columns - 1);
  double v = point / scene->columns * scene->height / (scene->rows - 1);
  u *= 1. - scene_number (scene, "shrinkage.warp", 0.);
  v *= 1. - scene_number (scene, "shrinkage.weft", 0.);
  uv[0] = cos (angle) * u + sin (angle) * v;
  uv[1] = -sin (angle) * u + cos (angle) * v;
}

static void
lay (Sheet * sheet)
{
  const Scene *scene = sheet->scene;
  int count;
  /* A seam across, {first row, last row, times as stiff}. */
  const double *seam = scene_list (scene, "seam", &count);
  sheet->inverse = g_new (double, 4 * scene->n_triangles);
  sheet->stiffer = g_new (double, scene->n_triangles);
  sheet->friction = g_new0 (double, 2 * scene->n_triangles);
  for (int k = 0; k < scene->n_triangles; k++) {
    double p[3][2], a, b, c, d, det;
    int row = k / 2 / (scene->columns - 1);
    for (int q = 0; q < 3; q++)
      flatten (scene, scene->triangles[3 * k + q], p[q]);
    a = p[1][0] - p[0][0];
    b = p[2][0] - p[0][0];
    c = p[1][1] - p[0][1];
    d = p[2][1] - p[0][1];
    det = a * d - b * c;
    sheet->inverse[4 * k] = d / det;
    sheet->inverse[4 * k + 1] = -b / det;
    sheet->inverse[4 * k + 2] = -c / det;
    sheet->inverse[4 * k + 3] = a / det;
    sheet->stiffer[k] = count == 3 && row >= seam[0]
        && row < seam[1] ? seam[2] : 1.;
  }
}

/* The triangle's corner that is not on the edge a-b, or -1 where it has no such edge. */
static int
opposite (const int *t, int a, int b)
{
  for (int q = 0; q < 3; q++)
    if ((t[q] == a && t[(q + 1) % 3] == b) || (t[q] == b
            && t[(q + 1) % 3] == a))
      return t[(q + 2) % 3];
  return -1;
}

static void
fold (Sheet * sheet)
{
  const Scene *scene = sheet->scene;
  double du = scene->width / (scene->columns - 1), dv =
      scene->height / (scene->rows - 1);
  double both = exp (scene_number (scene, "bending.log_ratio", 0.));
  double apart =
      exp (0.5 * scene_number (scene, "bending_anisotropy.log_ratio", 0.));
  double warp = scene_number (scene, "bending.warp", 3e-5) * both * apart;
  double weft = scene_number (scene, "bending.weft", 3e-5) * both / apart;
  double angle = scene_number (scene, "grain_angle.angle", 0.) * G_PI / 180.;
  double curve[2] = { scene_number (scene, "rest_curvature.warp", 0.),
    scene_number (scene, "rest_curvature.weft", 0.)
  };
  sheet->hinges = g_new0 (Hinge, 3 * scene->n_triangles);
  /* Triangles that share an edge are at most a row apart. */
  for (int k = 0; k < scene->n_triangles; k++)
    for (int l = k + 1;
        l < MIN (k + 2 * scene->columns + 2, scene->n_triangles); l++)
      for (int q = 0; q < 3; q++) {
        const int *t = scene->triangles + 3 * k;
        Hinge *h = sheet->hinges + sheet->n_hinges;
        int d = opposite (scene->triangles + 3 * l, t[q], t[(q + 1) % 3]);
        if (d < 0)
          continue;
        h->a = t[q];
        h->b = t[(q + 1) % 3];
        h->c = t[(q + 2) % 3];
        h->d = d;
        double u = (h->b % scene->columns - h->a % scene->columns) * du;
        double v = (h->b / scene->columns - h->a / scene->columns) * dv;
        double length = u * u + v * v, across =
            pow (v * cos (angle) - u * sin (angle), 2.);
        gboolean diagonal = u != 0. && v != 0.;
        double b = (across * warp + (length - across) * weft) / length;
        h->stiffness =
            diagonal ? (warp +
            weft) * du * dv / length : b * length / (du * dv);
        h->width = du * dv / sqrt (length);
        h->least = 0.5 * pow (du * dv, 2.);
        if (!diagonal)
          h->made = h->rest = -(v != 0. ? curve[0] : curve[1]) * h->width;
        sheet->n_hinges++;
      }
}

static void
set_up (Sheet * sheet, Scene * scene)
{
  double both = exp (scene_number (scene, "stretch.log_ratio", 0.));
  double apart =
      exp (0.5 * scene_number (scene, "stretch_anisotropy.log_ratio", 0.));
  sheet->scene = scene;
  sheet->warp = scene_number (scene, "stretch.warp", 40.) * both * apart;
  sheet->weft = scene_number (scene, "stretch.weft", 40.) * both / apart;
  sheet->shear = scene_number (scene, "shear", 12.) *
      exp (scene_number (scene, "shear.log_ratio", 0.));
  sheet->lag = scene_number (scene, "damping.stiffness", 5e-4) +
      scene_number (scene, "damping_stiffness.time", 0.);
  sheet->ratio = scene_number (scene, "biphasic_stretch.ratio", 0.);
  sheet->knee = scene_number (scene, "biphasic_stretch.knee", 0.1);
  sheet->tension = scene_number (scene, "hysteresis.tension", 0.);
  sheet->strain = scene_number (scene, "hysteresis.strain", 0.01);
  sheet->softening = scene_number (scene, "bending_softening.length", 0.);
  sheet->plastic = scene_number (scene, "plasticity.share", 0.);
  sheet->yield = scene_number (scene, "plasticity.yield", 30.);
  sheet->added = scene_number (scene, "added_mass.mass", 0.);
  sheet->compliance = scene_number (scene, "clamp_compliance.compliance", 0.);
  lay (sheet);
  fold (sheet);
}

static double
pull_thread (const Sheet * sheet, double stiffness, double strain)
{
  if (strain < 0.)
    return COMPRESSION * stiffness * strain;
  return stiffness * (strain + sheet->ratio * MAX (strain - sheet->knee, 0.));
}

/* Dahl's law over a step. */
static double
rub (const Sheet * sheet, double *tension, double rate, double dt)
{
  double turn =
      sheet->tension / sheet->strain * rate -
      fabs (rate) / sheet->strain * *tension;
  *tension = CLAMP (*tension + dt * turn, -sheet->tension, sheet->tension);
  return *tension;
}

static void
stretch (Sheet * sheet, double time, const double *x, const double *v,
    double dt, double *force)
{
  const Scene *scene = sheet->scene;
  /* The weft gets longer all the time. */
  double longer = 1. + scene_number (scene, "creep", 0.) * time;
  for (int k = 0; k < scene->n_triangles; k++) {
    const int *t = scene->triangles + 3 * k;
    const double *inverse = sheet->inverse + 4 * k;
    double f[2][3], g[2][3], s[3], lag = sheet->lag;
    for (int q = 0; q < 3; q++) {
      double a = x[3 * t[1] + q] - x[3 * t[0] + q], b =
          x[3 * t[2] + q] - x[3 * t[0] + q];
      double c = v[3 * t[1] + q] - v[3 * t[0] + q], d =
          v[3 * t[2] + q] - v[3 * t[0] + q];
      f[0][q] = a * inverse[0] + b * inverse[2];
      f[1][q] = (a * inverse[1] + b * inverse[3]) / longer;
      g[0][q] = c * inverse[0] + d * inverse[2];
      g[1][q] = c * inverse[1] + d * inverse[3];
    }
    double eu = 0.5 * (dot (f[0], f[0]) - 1.), ev =
        0.5 * (dot (f[1], f[1]) - 1.);
    double ru = dot (f[0], g[0]), rv = dot (f[1], g[1]);
    s[0] = pull_thread (sheet, sheet->warp, eu) + lag * sheet->warp * ru;
    s[1] = pull_thread (sheet, sheet->weft, ev) + lag * sheet->weft * rv;
    s[2] =
        sheet->shear * (dot (f[0], f[1]) + lag * (dot (f[0], g[1]) + dot (g[0],
                f[1])));
    if (sheet->tension > 0.) {
      s[0] += rub (sheet, sheet->friction + 2 * k, ru, dt);
      s[1] += rub (sheet, sheet->friction + 2 * k + 1, rv, dt);
    }
    for (int q = 0; q < 3; q++) {
      double part = scene->area[k] * sheet->stiffer[k];
      double pu = part * (f[0][q] * s[0] + f[1][q] * s[2]);
      double pv = part * (f[0][q] * s[2] + f[1][q] * s[1]);
      double b = pu * inverse[0] + pv * inverse[1], c =
          pu * inverse[2] + pv * inverse[3];
      force[3 * t[1] + q] -= b;
      force[3 * t[2] + q] -= c;
      force[3 * t[0] + q] += b + c;
    }
  }
}

/* phi of a hinge and its gradient by a, b, c and d. */
static double
open_hinge (const Hinge * h, const double *x, double gradient[4][3])
{
  const double *p[4] =
      { x + 3 * h->a, x + 3 * h->b, x + 3 * h->c, x + 3 * h->d };
  double e[3], ca[3], cb[3], da[3], db[3], n[3], m[3], both[3];
  for (int q = 0; q < 3; q++) {
    e[q] = p[1][q] - p[0][q];
    ca[q] = p[2][q] - p[0][q];
    cb[q] = p[2][q] - p[1][q];
    da[q] = p[3][q] - p[0][q];
    db[q] = p[3][q] - p[1][q];
  }
  cross (ca, cb, n);
  cross (db, da, m);
  cross (n, m, both);
  double length = sqrt (dot (e, e)), nn = MAX (dot (n, n), h->least), mm =
      MAX (dot (m, m), h->least), norm = sqrt (nn * mm);
  double cosine = dot (n, m) / norm, sine = dot (both, e) / (norm * length);
  double phi = 2. * sine / (1. + MAX (cosine, -0.9));
  /* d theta, and d phi = (1 + phi^2/4) d theta. */
  double more = 1. + 0.25 * phi * phi;
  for (int q = 0; q < 3; q++) {
    gradient[2][q] = -more * length * n[q] / nn;
    gradient[3][q] = -more * length * m[q] / mm;
    gradient[0][q] =
        -more * (dot (cb, e) * n[q] / nn + dot (db, e) * m[q] / mm) / length;
    gradient[1][q] =
        more * (dot (ca, e) * n[q] / nn + dot (da, e) * m[q] / mm) / length;
  }
  return phi;
}

static void
bend (Sheet * sheet, const double *x, const double *v, double *force)
{
  for (int k = 0; k < sheet->n_hinges; k++) {
    Hinge *h = sheet->hinges + k;
    int at[4] = { h->a, h->b, h->c, h->d };
    double gradient[4][3], rate = 0.;
    double phi = open_hinge (h, x, gradient), off = phi - h->rest;
    double beyond = fabs (phi - h->made) - sheet->yield * h->width;
    if (sheet->plastic > 0. && beyond > 0.) {
      double crease =
          h->made + copysign (sheet->plastic * beyond, phi - h->made);
      if ((crease - h->rest) * (phi - h->made) > 0.)
        h->rest = crease;
    }
    for (int i = 0; i < 4; i++)
      rate += dot (gradient[i], v + 3 * at[i]);
    double soft = 1. + sheet->softening * fabs (off) / h->width;
    double moment = h->stiffness * (off / soft + sheet->lag * rate);
    for (int i = 0; i < 4; i++)
      for (int q = 0; q < 3; q++)
        force[3 * at[i] + q] -= moment * gradient[i][q];
  }
}

/* A step that is stable, h^2 w^2 + 2 h c < 4 with w the highest frequency and c = lag w^2: w by
 * power iteration on the forces of cloth that is stretched by a tenth and beyond its knee. */
static double
find_step (Sheet * sheet)
{
  const Scene *scene = sheet->scene;
  int n = 3 * scene->n_points;
  double *x = g_new (double, n), *way = g_new (double, n), *rest =
      g_new0 (double, n);
  double *force = g_new0 (double, n), *force0 = g_new0 (double, n), square =
      0., lag = sheet->lag;
  double tension = sheet->tension, plastic = sheet->plastic, knee = sheet->knee;
  sheet->lag = sheet->tension = sheet->plastic = sheet->knee = 0.;
  for (int k = 0; k < n; k++)
    way[k] = 1e-7 * ((7919 * k) % 101 / 50. - 1.);
  for (int turn = 0; turn < 60; turn++) {
    double sum = 0.;
    memset (force0, 0, n * sizeof *force);
    memset (force, 0, n * sizeof *force);
    for (int k = 0; k < n; k++)
      x[k] = 1.1 * scene->start[k];
    stretch (sheet, 0., x, rest, 0., force0);
    bend (sheet, x, rest, force0);
    for (int k = 0; k < n; k++)
      x[k] += way[k];
    stretch (sheet, 0., x, rest, 0., force);
    bend (sheet, x, rest, force);
    for (int k = 0; k < n; k++) {
      way[k] = (force0[k] - force[k]) / scene->mass[k / 3];
      sum += way[k] * way[k];
    }
    sum = sqrt (sum);
    square = sum / 1e-7;
    for (int k = 0; k < n; k++)
      way[k] *= 1e-7 / sum;
  }
  sheet->lag = lag;
  sheet->tension = tension;
  sheet->plastic = plastic;
  sheet->knee = knee;
  square *= 1. + tension / sheet->strain / MIN (sheet->warp, sheet->weft);
  if (sheet->compliance > 0.)
    square =
        MAX (square, 2. / sheet->compliance / scene->mass[scene->columns + 1]);
  g_free (x);
  g_free (way);
  g_free (rest);
  g_free (force);
  g_free (force0);
  double c = lag * square;
  return MARGIN * (sqrt (c * c + 4. * square) - c) / square;
}

/* Accelerations of all points at a time. */
static void
accelerate (Sheet * sheet, double time, const double *x, const double *v,
    double dt, double *force)
{
  const Scene *scene = sheet->scene;
  memset (force, 0, 3 * scene->n_points * sizeof *force);
  stretch (sheet, time, x, v, dt, force);
  bend (sheet, x, v, force);
  scene_add_forces (scene, time, x, v, force);
  for (int h = 0; sheet->compliance > 0. && h < scene->n_held; h++) {
    int i = (int) scene->held[h];
    double place[3], before[3];
    if (!scene_holds (scene, h, time))
      continue;
    scene_clamp (scene, h, time, place);
    scene_clamp (scene, h, time - 1e-4, before);
    double k = 1. / sheet->compliance, c = sqrt (k * scene->mass[i]);
    for (int q = 0; q < 3; q++)
      force[3 * i + q] += k * (place[q] - x[3 * i + q]) +
          c * ((place[q] - before[q]) / 1e-4 - v[3 * i + q]);
  }
  double *normal = NULL;
  if (sheet->added > 0.) {
    normal = g_new0 (double, 3 * scene->n_points);
    for (int k = 0; k < scene->n_triangles; k++) {
      const int *t = scene->triangles + 3 * k;
      double a[3], b[3], n[3];
      for (int q = 0; q < 3; q++) {
        a[q] = x[3 * t[1] + q] - x[3 * t[0] + q];
        b[q] = x[3 * t[2] + q] - x[3 * t[0] + q];
      }
      cross (a, b, n);
      for (int i = 0; i < 9; i++)
        normal[3 * t[i / 3] + i % 3] += n[i % 3] / 6.;
    }
  }
  for (int i = 0; i < scene->n_points; i++) {
    double mass = scene_mass (scene, i, time), *f = force + 3 * i;
    if (normal) {
      /* (m + a A n n^T) u = f after Sherman and Morrison; the normal's length is the area. */
      double *n = normal + 3 * i, area = sqrt (dot (n, n)) + 1e-30;
      double part =
          sheet->added / (mass + sheet->added * area) * dot (f, n) / area;
      for (int q = 0; q < 3; q++)
        f[q] -= part * n[q];
    }
    for (int q = 0; q < 3; q++)
      f[q] /= mass;
  }
  g_free (normal);
}

/* A frame of velocity Verlet; the forces by velocity take that at half the step. */
static void
advance (Sheet * sheet, int frame, int n_steps, double *x, double *v, double *a)
{
  const Scene *scene = sheet->scene;
  double dt = scene->interval / n_steps;
  for (int s = 0; s < n_steps; s++) {
    double time = frame * scene->interval + (s + 1) * dt;
    for (int k = 0; k < 3 * scene->n_points; k++) {
      v[k] += 0.5 * dt * a[k];
      x[k] += dt * v[k];
    }
    for (int h = 0; sheet->compliance <= 0. && h < scene->n_held; h++) {
      int i = 3 * (int) scene->held[h];
      double place[3], before[3];
      if (!scene_holds (scene, h, time))
        continue;
      scene_clamp (scene, h, time, place);
      scene_clamp (scene, h, time - dt, before);
      for (int q = 0; q < 3; q++) {
        x[i + q] = place[q];
        v[i + q] = (place[q] - before[q]) / dt;
      }
    }
    for (int i = 0; i < scene->n_points; i++)
      scene_touch (scene, x + 3 * i, v + 3 * i);
    accelerate (sheet, time, x, v, dt, a);
    for (int k = 0; k < 3 * scene->n_points; k++)
      v[k] += 0.5 * dt * a[k];
  }
}

int
main (void)
{
  Scene *scene = scene_read ();
  Sheet sheet = { 0 };
  double *x = g_memdup2 (scene->start, 3 * scene->n_points * sizeof *x);
  double *v = g_new0 (double, 3 * scene->n_points), *a =
      g_new0 (double, 3 * scene->n_points);
  set_up (&sheet, scene);
  accelerate (&sheet, 0., x, v, 0., a);
  int n_steps = (int) ceil (scene->interval / find_step (&sheet));
  for (int frame = 0; frame < scene->n_frames; frame++) {
    scene_write (scene, x);
    advance (&sheet, frame, n_steps, x, v, a);
  }
  g_free (sheet.inverse);
  g_free (sheet.stiffer);
  g_free (sheet.friction);
  g_free (sheet.hinges);
  g_free (x);
  g_free (v);
  g_free (a);
  scene_free (scene);
  return 0;
}
