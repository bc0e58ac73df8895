/* All frames: normal equations of what may be wrong with the cameras, and points solved again.
 *
 * Model: the whitened residuals of a point's pictures are z = J dx + B η + white noise, see
 * residuals.c. The shift dx of each point is free, without a prior, and is projected out:
 *   P = I − J (JᵀJ)⁻¹ Jᵀ,  g = BᵀPB,  s = −BᵀPz,  r = zᵀPz.
 * What is left are epipolar errors: this is the reduced camera system of bundle adjustment
 * (R. Hartley and A. Zisserman, Multiple View Geometry, 2nd ed., A6.3). A point in n pictures
 * has 2n − 3 degrees of freedom left.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/solve.h"

#include <math.h>
#include <string.h>

#include "gst/gap/camera/residuals.h"
#include "gst/math/linalg.h"
#include "gst/math/pool.h"
#include "gst/math/vec3.h"

/* Points of all frames together that are used, about; of more vertices some are left out. */
#define MOST_POINTS 60000
/* Blocks of time, s, and most of them. */
#define BLOCK_S 0.5
#define MOST_BLOCKS 64
/* Gauss–Newton steps from the interpolated position of an unseen point to where the pictures
 * have it. */
#define N_UNSEEN 4
/* A picture shows the one before once more when the residual has at least this share of the
 * displacement between the two times, and when the square that this explains is so many times
 * the mean square, per degree of freedom, of what it leaves. */
#define STALE_SHARE 0.6
#define STALE_SQUARE 25.

typedef struct
{
  const ClothCameraView *view;
  ClothCameraPoints points;
  guint n_cameras;
  guint n_blocks;
  guint *block;                 /* of each frame */
  ClothCameraColumns aim;
  ClothNormalEquations *normal;
  gdouble *dof;                 /* of each block */
  ClothCameraErrors *errors;    /* sums, of each block */
  gdouble *n_points;
  ClothCameraPicture **scratch; /* [workers][cameras] */
  gdouble **columns;            /* [workers] */
  /* of drops, per frame and camera, with d the displacement since the picture before: zᵀPd,
   * dᵀPd, zᵀPz and its degrees of freedom */
  gdouble *along, *displacement, *rest, *freedom;
} Work;

/* zᵀPz of a point. */
static gdouble
residual_square (const ClothCameraPoint * point)
{
  const gdouble *u = point->u;

  return point->z2 - u[0] * u[0] - u[1] * u[1] - u[2] * u[2];
}

/* Squared distance of a point from where the pictures have it, |(JᵀJ)⁻¹ Jᵀz|². */
static gdouble
shift_square (const ClothCameraPoint * point)
{
  gdouble x[3] = { point->u[0], point->u[1], point->u[2] };

  cloth_camera_backward (point->a, x);
  return cloth_vec3_dot (x, x);
}

static gdouble
trace_of_inverse (const gdouble * factor)
{
  gdouble inverse[9];

  cloth_cholesky_inverse (3, factor, inverse);
  return inverse[0] + inverse[4] + inverse[8];
}

/* Adds BᵀPB and −BᵀPz of a point to the block's normal equations; @v: L⁻¹JᵀB,
 * [camera][column]. */
static void
add_point (const Work * work, const ClothCameraPicture * pictures, guint i,
    const ClothCameraPoint * point, gdouble * v, guint block)
{
  const guint m = work->normal->m;
  gdouble *g = work->normal->g + (gsize) block * m * m;
  gdouble *s = work->normal->s + (gsize) block * m;
  const guint n_columns = pictures->n_columns, n = point->n * n_columns;

  for (guint q = 0; q < point->n; q++) {
    const ClothCameraPicture *p = &pictures[point->cameras[q]];
    const gdouble *b = p->b + 2 * (gsize) n_columns * i, *z = p->z + 2 * i;
    const gdouble *j = p->j + 6 * (gsize) i;
    const guint first = point->cameras[q] * n_columns;

    for (guint k = 0; k < n_columns; k++) {
      gdouble *to = v + 3 * (q * n_columns + k);

      for (guint l = 0; l < 3; l++)
        to[l] = j[l] * b[k] + j[3 + l] * b[n_columns + k];
      cloth_camera_forward (point->a, to);
      s[first + k] -= b[k] * z[0] + b[n_columns + k] * z[1] -
          cloth_vec3_dot (to, point->u);
      for (guint l = 0; l <= k; l++)
        g[(gsize) (first + k) * m + first + l] += b[k] * b[l] +
            b[n_columns + k] * b[n_columns + l];
    }
  }
  for (guint k = 0; k < n; k++) {
    const gdouble *x = v + 3 * k;
    gdouble *row = g + (gsize) (point->cameras[k / n_columns] * n_columns +
        k % n_columns) * m;

    for (guint l = 0; l <= k; l++) {
      const gdouble *y = v + 3 * l;

      row[point->cameras[l / n_columns] * n_columns + l % n_columns] -=
          cloth_vec3_dot (x, y);
    }
  }
}

/* Adds what tells how well each picture would fit the time of the one before. */
static void
add_drops (const Work * work, const ClothCameraPicture * pictures, guint i,
    const ClothCameraPoint * point, guint frame)
{
  for (guint q = 0; q < point->n; q++) {
    const guint camera = point->cameras[q];
    const ClothCameraPicture *p = &pictures[camera];
    const guint n_columns = p->n_columns;
    const gdouble *b = p->b + 2 * (gsize) n_columns * i + n_columns - 1;
    const gdouble *z = p->z + 2 * i, *j = p->j + 6 * (gsize) i;
    gsize at = (gsize) frame * work->n_cameras + camera;
    gdouble v[3];

    for (guint l = 0; l < 3; l++)
      v[l] = j[l] * b[0] + j[3 + l] * b[n_columns];
    cloth_camera_forward (point->a, v);
    work->along[at] += b[0] * z[0] + b[n_columns] * z[1] -
        cloth_vec3_dot (v, point->u);
    work->displacement[at] += b[0] * b[0] + b[n_columns] * b[n_columns] -
        cloth_vec3_dot (v, v);
    work->rest[at] += residual_square (point);
    work->freedom[at] += 2. * point->n - 3.;
  }
}

/* Square by which the cameras' faults move a point that is solved from all its pictures. */
static gdouble
displacement_square (const ClothCameraPicture * pictures, guint i,
    const ClothCameraPoint * point)
{
  gdouble x[3] = { 0. };

  for (guint q = 0; q < point->n; q++) {
    const ClothCameraPicture *p = &pictures[point->cameras[q]];
    const guint n_columns = p->n_columns;
    const gdouble *b = p->b + 2 * (gsize) n_columns * i + n_columns - 1;
    const gdouble *j = p->j + 6 * (gsize) i;

    for (guint k = 0; k < 3; k++)
      x[k] += j[k] * b[0] + j[3 + k] * b[n_columns];
  }
  cloth_camera_forward (point->a, x);
  cloth_camera_backward (point->a, x);
  return cloth_vec3_dot (x, x);
}

static void
do_frame (const Work * work, ClothCameraPicture * pictures, gdouble * columns,
    guint frame)
{
  const guint block = work->block[frame];

  cloth_camera_look (work->view, &work->points, work->aim, pictures, frame);
  for (guint i = 0; i < work->points.n; i++) {
    ClothCameraPoint point;
    ClothCameraErrors *e = work->errors ? &work->errors[block] : NULL;

    if (!cloth_camera_gather (pictures, work->n_cameras, i, FALSE, &point))
      continue;
    if (work->aim == CLOTH_CAMERA_DROPS) {
      add_drops (work, pictures, i, &point, frame);
      continue;
    }
    if (work->aim == CLOTH_CAMERA_DISPLACEMENT) {
      e->triangulation += displacement_square (pictures, i, &point);
      work->n_points[block] += 1.;
      continue;
    }
    add_point (work, pictures, i, &point, columns, block);
    work->normal->r[block] += residual_square (&point);
    work->dof[block] += 2. * point.n - 3.;
    work->n_points[block] += 1.;
    e->detection += trace_of_inverse (point.a);
    *(point.contradicted ? &e->labels : &e->triangulation) +=
        shift_square (&point);
  }
}

static void
do_blocks (gpointer data, guint begin, guint end, guint worker)
{
  Work *work = data;

  for (guint frame = 0; frame < work->view->recording->n_frames; frame++)
    if (work->block[frame] >= begin && work->block[frame] < end)
      do_frame (work, work->scratch[worker], work->columns[worker], frame);
}

static void
run (Work * work, guint threads, ClothPoolFunc func)
{
  g_autoptr (ClothPool) pool = cloth_pool_new (threads);
  guint n = cloth_pool_get_n_threads (pool);

  work->scratch = g_new (ClothCameraPicture *, n);
  work->columns = g_new (gdouble *, n);
  for (guint t = 0; t < n; t++) {
    work->scratch[t] = g_new0 (ClothCameraPicture, work->n_cameras);
    work->columns[t] = g_new (gdouble,
        3 * cloth_camera_n_columns () * work->n_cameras);
    for (guint c = 0; c < work->n_cameras; c++)
      cloth_camera_picture_init (&work->scratch[t][c], work->points.n);
  }
  cloth_pool_run (pool, func, work, work->n_blocks);
  for (guint t = 0; t < n; t++) {
    for (guint c = 0; c < work->n_cameras; c++)
      cloth_camera_picture_clear (&work->scratch[t][c]);
    g_free (work->scratch[t]);
    g_free (work->columns[t]);
  }
  g_free (work->scratch);
  g_free (work->columns);
}

static void
divide_time (Work * work)
{
  const ClothRecording *r = work->view->recording;
  gdouble duration = r->times[r->n_frames - 1] - r->times[0];

  work->n_blocks = (guint) CLAMP (duration / BLOCK_S, 2, MOST_BLOCKS);
  work->block = g_new (guint, r->n_frames);
  for (guint f = 0; f < r->n_frames; f++)
    work->block[f] = MIN ((guint) ((r->times[f] - r->times[0]) / duration *
            work->n_blocks), work->n_blocks - 1);
}

/* @most: points of all frames together that are used, about. */
static void
work_init (Work * work, ClothCameraView * v, ClothCameraColumns aim, gsize most)
{
  const ClothRecording *r = v->recording;

  *work = (Work) {
  .view = v,.aim = aim,.n_cameras = v->observations->rig->n_cameras};
  cloth_camera_points_init (&work->points, v,
      (guint) (1 + (gsize) r->n * r->n_frames / most));
  divide_time (work);
}

static void
work_clear (Work * work)
{
  cloth_camera_points_clear (&work->points);
  g_free (work->block);
  g_free (work->dof);
  g_free (work->n_points);
  g_free (work->errors);
  g_free (work->along);
  g_free (work->displacement);
  g_free (work->rest);
  g_free (work->freedom);
}

/* Notes which pictures show the one before once more. */
static void
find_stale (ClothCameraView * v, guint threads)
{
  Work work;
  gsize n = (gsize) v->recording->n_frames * v->observations->rig->n_cameras;

  work_init (&work, v, CLOTH_CAMERA_DROPS, MOST_POINTS);
  work.along = g_new0 (gdouble, n);
  work.displacement = g_new0 (gdouble, n);
  work.rest = g_new0 (gdouble, n);
  work.freedom = g_new0 (gdouble, n);
  run (&work, threads, do_blocks);
  for (gsize i = 0; i < n; i++) {
    const gdouble gained = work.displacement[i] > 0. ?
        work.along[i] * work.along[i] / work.displacement[i] : 0.;

    v->stale[i] = work.along[i] > STALE_SHARE * work.displacement[i]
        && gained * work.freedom[i] > STALE_SQUARE * (work.rest[i] - gained);
  }
  work_clear (&work);
}

/* Fills the upper triangle, and behind the cameras' columns those of all cameras alike, which
 * are their sums. */
static void
complete (ClothNormalEquations * normal, guint n_cameras)
{
  const guint m = normal->m, n_columns = m / (n_cameras + 1);
  const guint own = n_cameras * n_columns;

  for (guint block = 0; block < normal->n_blocks; block++) {
    gdouble *g = normal->g + (gsize) block * m * m;
    gdouble *s = normal->s + (gsize) block * m;

    for (guint i = 0; i < own; i++)
      for (guint k = 0; k < i; k++)
        g[(gsize) k * m + i] = g[(gsize) i * m + k];
    for (guint i = 0; i < own; i++)
      for (guint k = 0; k < own; k++)
        g[(gsize) i * m + own + k % n_columns] += g[(gsize) i * m + k];
    for (guint i = 0; i < own; i++) {
      const guint to = own + i % n_columns;

      for (guint k = 0; k < n_columns; k++)
        g[(gsize) to * m + own + k] += g[(gsize) i * m + own + k];
      s[to] += s[i];
    }
    for (guint i = 0; i < own; i++)
      for (guint k = 0; k < n_columns; k++)
        g[(gsize) (own + k) * m + i] = g[(gsize) i * m + own + k];
  }
}

/* Scales a column. */
static void
scale (ClothNormalEquations * normal, guint column, gdouble by)
{
  for (guint block = 0; block < normal->n_blocks; block++) {
    gdouble *g = normal->g + (gsize) block * normal->m * normal->m;

    normal->s[(gsize) block * normal->m + column] *= by;
    for (guint k = 0; k < normal->m; k++) {
      g[(gsize) column * normal->m + k] *= by;
      g[(gsize) k * normal->m + column] *= by;
    }
  }
}

static void
sum_errors (const Work * work, ClothCameraErrors * errors)
{
  const ClothNormalEquations *normal = work->normal;
  gdouble n = 0., r = 0., dof = 0.;

  *errors = (ClothCameraErrors) {
  0.};
  for (guint b = 0; b < work->n_blocks; b++) {
    errors->detection += work->errors[b].detection;
    errors->labels += work->errors[b].labels;
    errors->triangulation += work->errors[b].triangulation;
    n += work->n_points[b];
    r += normal->r[b];
    dof += work->dof[b];
  }
  errors->detection *= dof > 0. ? r / (dof * n) : 0.;
  errors->labels /= MAX (n, 1.);
  errors->triangulation /= MAX (n, 1.);
}

/* @view: a recording beside its pictures
 * @threads: threads to use, 0 = one for each processor; the result is the same for any
 * @errors: (out): what detection, labels and triangulation leave
 *
 * Finds the normal equations of the whitened residual, observed less predicted, with the points'
 * shifts projected out. Columns are those of cloth_camera_candidates_new (); that of frame_drop
 * is per share of the camera's pictures that are stale.
 *
 * Returns: (transfer full) (nullable): the equations, in blocks of half a second; %NULL
 *   when no point was seen by two cameras
 */
ClothNormalEquations *
cloth_camera_view_linearise (ClothCameraView * view, guint threads,
    ClothCameraErrors * errors)
{
  Work work;
  ClothNormalEquations *normal = g_new0 (ClothNormalEquations, 1);
  const guint n_columns = cloth_camera_n_columns ();
  gdouble dof = 0.;

  work_init (&work, view, CLOTH_CAMERA_FAULTS, MOST_POINTS);
  normal->m = (work.n_cameras + 1) * n_columns;
  normal->n_blocks = work.n_blocks;
  normal->g = g_new0 (gdouble, (gsize) work.n_blocks * normal->m * normal->m);
  normal->s = g_new0 (gdouble, (gsize) work.n_blocks * normal->m);
  normal->r = g_new0 (gdouble, work.n_blocks);
  work.normal = normal;
  work.dof = g_new0 (gdouble, work.n_blocks);
  work.n_points = g_new0 (gdouble, work.n_blocks);
  work.errors = g_new0 (ClothCameraErrors, work.n_blocks);
  run (&work, threads, do_blocks);
  sum_errors (&work, errors);
  for (guint b = 0; b < work.n_blocks; b++)
    dof += work.dof[b];
  normal->per_block = dof / work.n_blocks;
  for (guint c = 0; c < work.n_cameras; c++) {
    gdouble sigma, share = cloth_camera_view_stale_share (view, c, &sigma);

    if (share > 0.)
      scale (normal, (c + 1) * n_columns - 1, 1. / share);
  }
  complete (normal, work.n_cameras);
  work_clear (&work);
  if (dof > 0.)
    return normal;
  cloth_normal_equations_free (normal);
  return NULL;
}

/* The vectors from the points of a frame to where the pictures have them; NaN where fewer than
 * two cameras see one. */
static void
find_shifts (const Work * work, ClothCameraPicture * pictures, guint frame,
    gdouble * shifts)
{
  cloth_camera_look (work->view, &work->points, work->aim, pictures, frame);
  for (guint i = 0; i < work->points.n; i++, shifts += 3) {
    ClothCameraPoint point;

    shifts[0] = shifts[1] = shifts[2] = NAN;
    if (!cloth_camera_gather (pictures, work->n_cameras, i, FALSE, &point))
      continue;
    memcpy (shifts, point.u, sizeof point.u);
    cloth_camera_backward (point.a, shifts);
  }
}

static void
shift_blocks (gpointer data, guint begin, guint end, guint worker)
{
  Work *work = data;
  const ClothRecording *r = work->view->recording;

  for (guint frame = 0; frame < r->n_frames; frame++)
    if (work->block[frame] >= begin && work->block[frame] < end)
      find_shifts (work, work->scratch[worker], frame,
          work->along + 3 * (gsize) frame * r->n);
}

static gdouble *
solve (ClothCameraView * v, guint threads)
{
  const ClothRecording *r = v->recording;
  Work work;
  gdouble *shifts;

  work_init (&work, v, CLOTH_CAMERA_SHIFT, G_MAXSIZE);
  work.along = g_new (gdouble, 3 * (gsize) r->n * r->n_frames);
  run (&work, threads, shift_blocks);
  shifts = g_steal_pointer (&work.along);
  work_clear (&work);
  return shifts;
}

/* @view: a recording beside its pictures
 * @threads: threads to use, 0 = one for each processor; the result is the same for any
 *
 * Moves points that the recording lacks to where two or more pictures have them, the cameras
 * being as they are assumed to be.
 */
void
cloth_camera_view_solve_unseen (ClothCameraView * view, guint threads)
{
  ClothCameraView *v = view;
  const ClothRecording *r = v->recording;
  gsize all = (gsize) r->n * r->n_frames, unseen = 0;

  for (gsize i = 0; i < all; i++)
    if (!(r->seen[i] > 0.)) {
      memcpy (v->y + 3 * i, r->y + 3 * i, 3 * sizeof *v->y);
      unseen++;
    }
  if (!unseen)
    return;
  /* from the interpolated positions, which may be far off */
  for (guint step = 0; step < N_UNSEEN; step++) {
    g_autofree gdouble *shifts = solve (v, threads);

    for (gsize i = 0; i < all; i++)
      for (guint k = 0; k < 3 && !(r->seen[i] > 0.); k++)
        v->y[3 * i + k] += shifts[3 * i + k];
  }
}

/* A point that fewer than two cameras see is shifted by the mean of its frame, in a frame
 * without any such mean by that of the frame before. */
static void
move_points (const ClothRecording * from, const gdouble * shifts,
    ClothRecording * to)
{
  gdouble mean[3] = { 0. };

  for (guint frame = 0; frame < from->n_frames; frame++) {
    const gdouble *shift = shifts + 3 * (gsize) frame * from->n;
    gdouble sum[3] = { 0. };
    guint n = 0;

    for (guint i = 0; i < from->n; i++)
      if (!isnan (shift[3 * i])) {
        n++;
        for (guint k = 0; k < 3; k++)
          sum[k] += shift[3 * i + k];
      }
    for (guint k = 0; k < 3 && n; k++)
      mean[k] = sum[k] / n;
    for (guint i = 0; i < 3 * from->n; i++) {
      gsize at = 3 * (gsize) frame * from->n + i;

      to->y[at] = from->y[at] + (isnan (shift[i]) ? mean[i % 3] : shift[i]);
    }
  }
}

/* @view: a recording beside its pictures, with what is wrong with the cameras applied
 * @threads: threads to use, 0 = one for each processor; the result is the same for any
 * @corrected: its recording, or a copy: the positions become what the cameras
 *   would have made of the cloth with nothing wrong with them
 *
 * Solves the points again with the cameras as they are assumed to be.
 *
 * Returns: mean square of their displacement, m²; NaN when no point was seen by two cameras
 */
gdouble
cloth_camera_view_correct (ClothCameraView * view, guint threads,
    ClothRecording * corrected)
{
  const ClothRecording *r = view->recording;
  g_autofree gdouble *shifts = solve (view, threads);
  gdouble sum = 0.;
  gsize n = 0;

  for (gsize i = 0; i < (gsize) r->n * r->n_frames; i++) {
    const gdouble *shift = shifts + 3 * i;

    if (isnan (shift[0]) || !(r->seen[i] > 0.))
      continue;
    sum += cloth_vec3_dot (shift, shift);
    n++;
  }
  move_points (r, shifts, corrected);
  return n ? sum / n : NAN;
}

/* @view: a recording beside its pictures, with what is wrong with the cameras applied
 * @threads: threads to use, 0 = one for each processor; the result is the same for any
 *
 * Returns: mean square of the displacement of points, each solved from all its pictures, by
 *   that, m²; NaN when no point was seen by two cameras
 */
gdouble
cloth_camera_view_displacement (ClothCameraView * view, guint threads)
{
  Work work;
  gdouble sum = 0., n = 0.;

  work_init (&work, view, CLOTH_CAMERA_DISPLACEMENT, MOST_POINTS);
  work.errors = g_new0 (ClothCameraErrors, work.n_blocks);
  work.n_points = g_new0 (gdouble, work.n_blocks);
  run (&work, threads, do_blocks);
  for (guint b = 0; b < work.n_blocks; b++) {
    sum += work.errors[b].triangulation;
    n += work.n_points[b];
  }
  work_clear (&work);
  return n > 0. ? sum / n : NAN;
}

/* @recording: the points' recorded positions; kept by reference
 * @observations: what was seen of it; kept by reference
 * @threads: threads to use, 0 = one for each processor; the result is the same for any
 *
 * Lays pictures beside frames, solves for points that the recording lacks, and finds the
 * pictures that show the one before once more.
 *
 * Returns: (transfer full): both side by side, the cameras being as the rig says
 */
ClothCameraView *
cloth_camera_view_new (const ClothRecording * recording,
    const ClothObservations * observations, guint threads)
{
  ClothCameraView *view = cloth_camera_view_match (recording, observations);

  cloth_camera_view_solve_unseen (view, threads);
  find_stale (view, threads);
  return view;
}
