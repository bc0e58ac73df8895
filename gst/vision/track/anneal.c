/* Where a cloth lies flat on the ground, by simulated annealing, as the paper finds it.
 *
 * Model: a pose (x, y, angle) is as good as little of its drawn silhouettes differs from the filmed
 *   ones: the sum over the cameras of the pixels that are cloth in only one of both, as a share E of
 *   the filmed silhouettes.
 * Assumption: the drawn outline is convex, so that a row of pixels has one run of cloth. That of a flat
 *   rectangle is, but for what a lens bends.
 * Method: a random step is taken if E falls, or else with probability exp (−ΔE / T). T falls by the
 *   same factor each step, and steps shrink like it. The best pose that was met is the result. Areas
 *   are those of the outline, not of whole pixels, so that E has no steps of its own.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 5, which gives no constants; Kirkpatrick, Gelatt and Vecchi, Optimization by simulated
 *   annealing, 1983.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/anneal.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"

/* Pieces of a side that are drawn straight. */
#define CUTS 8
#define RIM (4 * CUTS)
/* Steps while it is hottest: of the place as a share of the cloth's diagonal, of the angle in rad. */
#define FIRST_STEP 0.3
#define FIRST_TURN 1.5
/* How far the cloth's middle may be from that of the silhouettes, as a share of the diagonal. */
#define ROOM 0.5
/* Poses that fit this much worse, as a share of the area, are not told from the best. */
#define ALIKE 0.005

/* A silhouette. @sums: (height) rows of width + 1 sums of the pixels before each */
typedef struct
{
  const ClothCamera *camera;
  guint32 *sums;
  gdouble *from, *to;           /* of each row of the drawn one */
} Silhouette;

typedef struct
{
  guint n;
  Silhouette *silhouettes;
  gdouble area;                 /* of all, px */
} Problem;

static void
problem_clear (Problem * p)
{
  for (guint c = 0; c < p->n && p->silhouettes; c++) {
    g_free (p->silhouettes[c].sums);
    g_free (p->silhouettes[c].from);
    g_free (p->silhouettes[c].to);
  }
  g_clear_pointer (&p->silhouettes, g_free);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Problem, problem_clear);

/* Returns: the usual ones. The paper names no numbers.
 */
ClothAnnealParams
cloth_anneal_default_params (void)
{
  return (ClothAnnealParams) {
  0, 6000, 0.3, 0.0003, 0.1};
}

/* Sums up a silhouette, and adds where its middle is on the ground to @middle. */
static gboolean
take (const ClothFlatParams * params, const ClothFlatView * view,
    Problem * problem, Silhouette * s, gdouble middle[2], GError ** error)
{
  const gint width = view->mask.width, height = view->mask.height;
  g_autofree guint8 *piece = cloth_flat_find_piece (view, error);
  gdouble sum[3] = { 0 }, xy[2];

  if (!piece)
    return FALSE;
  s->camera = view->camera;
  s->sums = g_new (guint32, (gsize) (width + 1) * (gsize) height);
  s->from = g_new (gdouble, height);
  s->to = g_new (gdouble, height);
  for (gint y = 0; y < height; y++) {
    guint32 *row = s->sums + (gsize) y * (width + 1);

    row[0] = 0;
    for (gint x = 0; x < width; x++) {
      const guint8 is_cloth = piece[(gsize) y * width + x];

      row[x + 1] = row[x] + is_cloth;
      sum[0] += is_cloth;
      sum[1] += is_cloth * x;
      sum[2] += is_cloth * y;
    }
  }
  problem->area += sum[0];
  if (!cloth_flat_reach (view->camera, params->ground, (const gdouble[2]) {
            sum[1] / sum[0], sum[2] / sum[0]
          }, xy, error))
    return FALSE;
  for (guint k = 0; k < 2; k++)
    middle[k] += xy[k] / problem->n;
  return TRUE;
}

/* Widens the runs of the rows that an edge of the outline crosses. */
static void
add_edge (Silhouette * s, const gdouble a[2], const gdouble b[2])
{
  const gdouble *low = a[1] < b[1] ? a : b, *high = low == a ? b : a;
  const gdouble bottom = s->camera->height - 1.;
  const gint last = (gint) floor (CLAMP (high[1], -1., bottom));

  for (gint y = (gint) ceil (CLAMP (low[1], 0., bottom + 1.)); y <= last; y++) {
    const gdouble x = high[1] > low[1] ? low[0] + (high[0] - low[0]) * (y -
        low[1]) / (high[1] - low[1]) : low[0];

    s->from[y] = MIN (s->from[y], x);
    s->to[y] = MAX (s->to[y], x);
  }
}

/* Pixels of the filmed silhouette in a row left of x. */
static gdouble
count (const guint32 * row, gint width, gdouble x)
{
  const gdouble at = CLAMP (x + 0.5, 0., (gdouble) width);
  const gint i = MIN ((gint) at, width - 1);

  return row[i] + (at - i) * (row[i + 1] - row[i]);
}

/* E of one camera, px. */
static gdouble
differ (Silhouette * s, const ClothFlatPose * pose)
{
  static const gdouble rim[5][2] = { {0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0} };
  const gint width = s->camera->width, height = s->camera->height;
  gdouble points[RIM + 1][2], sum = 0.;

  for (guint i = 0; i <= RIM; i++) {
    const guint side = MIN (i / CUTS, 3);
    const gdouble share = (gdouble) i / CUTS - side;
    gdouble uv[2], X[3];

    for (guint k = 0; k < 2; k++)
      uv[k] = pose->size[k] * (rim[side][k] + share * (rim[side + 1][k] -
              rim[side][k]));
    cloth_flat_place (pose, uv, X);
    if (!cloth_camera_project (s->camera, X, points[i], NULL, NULL))
      return INFINITY;
  }
  for (gint y = 0; y < height; y++) {
    s->from[y] = INFINITY;
    s->to[y] = -INFINITY;
  }
  for (guint i = 0; i < RIM; i++)
    add_edge (s, points[i], points[i + 1]);
  for (gint y = 0; y < height; y++) {
    const guint32 *row = s->sums + (gsize) y * (width + 1);
    /* what is outside the picture can't be compared */
    const gdouble from = CLAMP (s->from[y], -0.5, width - 0.5);
    const gdouble to = CLAMP (s->to[y], -0.5, width - 0.5);
    const gboolean is_drawn = s->from[y] <= s->to[y];
    const gdouble drawn = is_drawn ? to - from : 0.;
    const gdouble both = is_drawn ? count (row, width, to) - count (row, width,
        from) : 0.;

    sum += drawn + row[width] - 2. * both;
  }
  return sum;
}

static gdouble
evaluate (const Problem * problem, const ClothFlatPose * pose)
{
  gdouble sum = 0.;

  for (guint c = 0; c < problem->n; c++)
    sum += differ (&problem->silhouettes[c], pose);
  return sum / problem->area;
}

/* The pose about the middle of the cloth, turned on. */
static ClothFlatPose
pose_about (const ClothFlatParams * params, const gdouble middle[2],
    gdouble angle)
{
  const gdouble c = cos (angle), s = sin (angle);
  const gdouble w = params->size[0] / 2, h = params->size[1] / 2;

  return (ClothFlatPose) {
    middle[0] - c * w - s * h, middle[1] - s * w + c * h,
        remainder (angle, 2. * G_PI), {
    params->size[0], params->size[1]}
  , params->ground, 0.};
}

/* Anneals; @at: (inout): middle and angle. */
static void
anneal (const Problem * problem, const ClothAnnealParams * a,
    const ClothFlatParams * params, gdouble at[3])
{
  const gdouble diagonal = hypot (params->size[0], params->size[1]);
  const gdouble middle[2] = { at[0], at[1] };
  const gdouble fall = pow (a->cold / a->hot, 1. / MAX (a->steps, 1u));
  gdouble now[3] = { at[0], at[1], at[2] };
  ClothFlatPose pose = pose_about (params, now, now[2]);
  gdouble e = evaluate (problem, &pose), best = e, t = a->hot;
  ClothRandom random;

  cloth_random_init (&random, a->seed);
  for (guint i = 0; i < a->steps; i++, t *= fall) {
    const gdouble share = t / a->hot;
    gdouble next[3] = { now[0], now[1], now[2] }, moved;

    for (guint k = 0; k < 3; k++)
      next[k] += (k == 2 ? FIRST_TURN : FIRST_STEP * diagonal) * share *
          cloth_random_gaussian (&random);
    /* far away all poses are alike, and there are endlessly many */
    if (hypot (next[0] - middle[0], next[1] - middle[1]) > ROOM * diagonal)
      continue;
    pose = pose_about (params, next, next[2]);
    moved = evaluate (problem, &pose);
    if (!(moved <= e || cloth_random_uniform (&random) < exp ((e - moved) / t)))
      continue;
    memcpy (now, next, sizeof now);
    e = moved;
    if (e < best) {
      best = e;
      memcpy (at, now, sizeof now);
    }
  }
}

/* @annealing: how
 * @params: what is looked for; @straight, @stretch and @agree are not looked at
 * @n_views: cameras
 * @views: (array length=n_views): what they see
 * @near: (nullable) (array fixed-size=2): a place near to vertex 0, m, world: the pose that is
 *   meant comes first
 * @poses: (out): those that fit alike: turned by a half, of a cloth that is nearly a square by
 *   quarters
 * @error: #ClothFlatError
 *
 * The same seed gives the same poses.
 *
 * Returns: %FALSE when a silhouette is of no use
 */
gboolean
cloth_anneal_find (const ClothAnnealParams * annealing,
    const ClothFlatParams * params, guint n_views, const ClothFlatView * views,
    const gdouble * near, ClothFlatPoses * poses, GError ** error)
{
  g_auto (Problem) problem = { 0 };
  gdouble at[3] = { 0 }, least = INFINITY;
  ClothFlatPose turned[4];

  poses->n = 0;
  if (!cloth_flat_check (params, n_views, views, error))
    return FALSE;
  if (!(annealing->hot > 0 && annealing->cold > 0
          && annealing->cold <= annealing->hot && isfinite (annealing->hot))) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_PARAMETER,
        "temperatures from %g to %g can't be: both must be above 0, the last "
        "not above the first", annealing->hot, annealing->cold);
    return FALSE;
  }
  problem.n = n_views;
  problem.silhouettes = g_new0 (Silhouette, n_views);
  for (guint c = 0; c < n_views; c++)
    if (!take (params, &views[c], &problem, &problem.silhouettes[c], at, error))
      return FALSE;
  anneal (&problem, annealing, params, at);
  for (guint k = 0; k < 4; k++) {
    turned[k] = pose_about (params, at, at[2] + k * G_PI / 2);
    turned[k].residual = evaluate (&problem, &turned[k]);
    least = MIN (least, turned[k].residual);
  }
  if (!(least <= annealing->differ)) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_SHAPE,
        "no cloth of %g × %g m that lies flat at z = %g m looks as in the first "
        "pictures: the nearest differs from them by %.0f%% of its area; are its "
        "size, the ground and the rig right?", params->size[0],
        params->size[1], params->ground, 100. * fmin (least, 10.));
    return FALSE;
  }
  for (guint k = 0; k < 4; k++)
    if (turned[k].residual < least + ALIKE)
      poses->poses[poses->n++] = turned[k];
  cloth_flat_sort (poses, near);
  return TRUE;
}
