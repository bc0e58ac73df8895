/* Where a cloth of known size lies flat on the ground, by its silhouettes in several cameras.
 *
 * Model: the cloth's surface is a rectangle of known sides in the plane z = ground. Each camera's
 *   outline, carried to that plane by rays, is that rectangle.
 * Assumption: nothing hides a side, and the print is above. A plane that is wrong by h moves a camera's
 *   outline by h over the tangent of its elevation, away from it: cameras all around undo that.
 * Method: the first and last pixel of each row and column are carried to the plane, where sides are
 *   straight whatever the lens. The smallest rectangle about their convex hull tells which points
 *   belong to which side; a line is fitted to each, neighbours meet in corners, which need not be in the
 *   picture. Corners are averaged over
 *   the cameras, and the known rectangle is laid on them by least squares: with centred model points m
 *   and corners q the angle is atan2 (Σ m × q, Σ m · q).
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   sections 4 and 5, where annealing finds the pose: cloth_anneal_find (). Freeman and Shapira,
 *   Determining the minimum-area encasing rectangle, 1975.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/flat.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "gst/vision/track/marker.h"

/* Share of a side at each end that its line is not fitted to: there the other side begins. */
#define MARGIN 0.08
/* Rounds of fitting lines. */
#define ROUNDS 4
/* Poses whose corners fit this much worse than the best, m, are not told from it. */
#define ALIKE 0.005

G_DEFINE_QUARK (cloth - flat - error - quark, cloth_flat_error);

typedef struct
{
  gdouble x, y;
} Point;

/* A line: p with normal · p = offset. */
typedef struct
{
  gdouble normal[2], offset;
} Line;

/* @width: along u, m
 * @height: along v, m
 *
 * Returns: the usual ones, on the ground z = 0
 */
ClothFlatParams
cloth_flat_default_params (gdouble width, gdouble height)
{
  return (ClothFlatParams) { {
  width, height}
  , 0., 0.01, 0.1, 0.02};
}

static const gchar *
get_name (const ClothCamera * camera)
{
  return camera->name ? camera->name : "without a name";
}

/* ---- silhouettes ---- */

/* @params: what is looked for
 * @n_views: cameras
 * @views: (array length=n_views): what they see
 * @error: #ClothFlatError
 *
 * Returns: whether sizes are above 0 and pictures those of the cameras
 */
gboolean
cloth_flat_check (const ClothFlatParams * params, guint n_views,
    const ClothFlatView * views, GError ** error)
{
  if (!(params->size[0] > 0 && params->size[1] > 0
          && isfinite (params->size[0] + params->size[1] + params->ground))) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_PARAMETER,
        "a cloth of %g × %g m at z = %g m can't be; give its sides in metres",
        params->size[0], params->size[1], params->ground);
    return FALSE;
  }
  if (n_views == 0) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_PARAMETER,
        "no camera sees the cloth; give the silhouette of at least one");
    return FALSE;
  }
  for (guint c = 0; c < n_views; c++)
    if (views[c].mask.width != views[c].camera->width
        || views[c].mask.height != views[c].camera->height) {
      g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_PARAMETER,
          "camera “%s”: its silhouette has %d × %d pixels, its pictures in "
          "the rig %d × %d", get_name (views[c].camera), views[c].mask.width,
          views[c].mask.height, views[c].camera->width,
          views[c].camera->height);
      return FALSE;
    }
  return TRUE;
}

/* Marks the piece of pixels at @start, joined by their sides, with @label. Returns: its pixels */
static guint
flood (guint8 * piece, gint width, gint height, guint start, guint8 label,
    guint * stack)
{
  guint n = 0, size = 0;

  piece[start] = label;
  stack[n++] = start;
  while (n) {
    const guint at = stack[--n];
    const gint x = (gint) (at % (guint) width), y = (gint) (at / (guint) width);
    const struct
    {
      gboolean is_inside;
      guint at;
    } next[4] = { {x > 0, at - 1}, {x + 1 < width, at + 1}, {y > 0,
        at - (guint) width}, {y + 1 < height, at + (guint) width}
    };

    size++;
    for (guint k = 0; k < 4; k++)
      if (next[k].is_inside && piece[next[k].at] == 1) {
        piece[next[k].at] = label;
        stack[n++] = next[k].at;
      }
  }
  return size;
}

static gboolean
refuse (const ClothFlatView * view, const gchar * what, GError ** error)
{
  g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_SILHOUETTE,
      "camera “%s”: %s", get_name (view->camera), what);
  return FALSE;
}

/* Keeps the largest piece of @piece, whose pixels are 0 or 1. */
static gboolean
keep_largest (const ClothFlatView * view, guint8 * piece, GError ** error)
{
  const gint width = view->mask.width, height = view->mask.height;
  const guint n = (guint) width * (guint) height;
  g_autofree guint *stack = g_new (guint, n);
  guint largest = 0, second = 0, where = 0, all = 0;

  for (guint i = 0; i < n; i++)
    if (piece[i] == 1) {
      const guint size = flood (piece, width, height, i, 2, stack);

      all += size;
      if (size > largest) {
        second = largest;
        largest = size;
        where = i;
      } else
        second = MAX (second, size);
    }
  if (all == 0)
    return refuse (view,
        "its silhouette is empty: is the cloth in the picture, "
        "and the background that of this camera?", error);
  if (all == n)
    return refuse (view,
        "its silhouette is the whole picture: is the background "
        "that of this camera?", error);
  if (second > CLOTH_FLAT_SPECK * largest)
    return refuse (view,
        "its silhouette has more than one piece: nothing else may "
        "move, and nothing may stand before the cloth", error);
  for (guint i = 0; i < n; i++)
    piece[i] = piece[i] != 0;
  flood (piece, width, height, where, 2, stack);
  for (guint i = 0; i < n; i++)
    piece[i] = piece[i] == 2;
  return TRUE;
}

/* @view: a camera's silhouette
 * @error: #ClothFlatError: it is empty, full or in pieces
 *
 * Returns: (transfer full): 1 where the largest piece is, else 0, rows without gaps; %NULL with
 *   @error
 */
guint8 *
cloth_flat_find_piece (const ClothFlatView * view, GError ** error)
{
  const ClothImage *mask = &view->mask;
  g_autofree guint8 *piece =
      g_malloc ((gsize) mask->width * (gsize) mask->height);

  for (gint y = 0; y < mask->height; y++)
    for (gint x = 0; x < mask->width; x++)
      piece[(gsize) y * mask->width + x] =
          mask->data[(gsize) y * mask->stride + x] != 0;
  return keep_largest (view, piece, error) ? g_steal_pointer (&piece) : NULL;
}

/* @camera: a camera
 * @ground: z of a plane, m
 * @px: a place of its picture, px
 * @xy: (out): where its ray meets the plane, m
 * @error: %CLOTH_FLAT_ERROR_SHAPE
 *
 * Returns: %FALSE when it doesn't meet it before the camera
 */
gboolean
cloth_flat_reach (const ClothCamera * camera, gdouble ground,
    const gdouble px[2], gdouble xy[2], GError ** error)
{
  ClothRay ray;
  gdouble along = NAN;

  if (cloth_marker_cast (camera, px, &ray))
    along = (ground - ray.origin[2]) / ray.direction[2];
  if (!(along > 0 && isfinite (along))) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_SHAPE,
        "camera “%s” sees the cloth above the horizon of the ground: is the "
        "rig's z axis up, and the ground at z = %g m?", get_name (camera),
        ground);
    return FALSE;
  }
  for (guint k = 0; k < 2; k++)
    xy[k] = ray.origin[k] + along * ray.direction[k];
  return TRUE;
}

/* ---- corners ---- */

static gboolean
add_point (const ClothFlatView * view, gdouble ground, gdouble x, gdouble y,
    GArray * points, GError ** error)
{
  const gdouble px[2] = { x, y };
  gdouble xy[2];
  Point point;

  if (!cloth_flat_reach (view->camera, ground, px, xy, error))
    return FALSE;
  point = (Point) {
  xy[0], xy[1]};
  g_array_append_val (points, point);
  return TRUE;
}

/* Adds to @points both ends of the piece in a line of pixels, half a pixel outside. Ends at the
 * picture's edge are not the cloth's: they set @is_cut. @step: from one pixel to the next */
static gboolean
add_ends (const ClothFlatView * view, gdouble ground, const guint8 * line,
    gint n, gsize step, gboolean is_row, gint at, GArray * points,
    gboolean * is_cut, GError ** error)
{
  gint ends[2] = { 0, n - 1 };

  while (ends[0] < n && !line[ends[0] * step])
    ends[0]++;
  if (ends[0] == n)
    return TRUE;
  while (!line[ends[1] * step])
    ends[1]--;
  for (guint k = 0; k < 2; k++) {
    const gdouble end = ends[k] + (k == 0 ? -0.5 : 0.5);

    if (ends[k] == 0 || ends[k] == n - 1)
      *is_cut = TRUE;
    else if (!add_point (view, ground, is_row ? end : at, is_row ? at : end,
            points, error))
      return FALSE;
  }
  return TRUE;
}

/* The outline of the silhouette on the ground. */
static GArray *
find_outline (const ClothFlatView * view, gdouble ground, gboolean * is_cut,
    GError ** error)
{
  const gint width = view->mask.width, height = view->mask.height;
  g_autofree guint8 *piece = cloth_flat_find_piece (view, error);
  g_autoptr (GArray) points = NULL;

  if (!piece)
    return NULL;
  points = g_array_new (FALSE, FALSE, sizeof (Point));
  for (gint y = 0; y < height; y++)
    if (!add_ends (view, ground, piece + (gsize) y * width, width, 1, TRUE, y,
            points, is_cut, error))
      return NULL;
  for (gint x = 0; x < width; x++)
    if (!add_ends (view, ground, piece + x, height, (gsize) width, FALSE, x,
            points, is_cut, error))
      return NULL;
  return g_steal_pointer (&points);
}

static gint
compare_points (gconstpointer a, gconstpointer b)
{
  const Point *p = a, *q = b;

  return p->x != q->x ? (p->x > q->x) - (p->x < q->x) :
      (p->y > q->y) - (p->y < q->y);
}

static gdouble
turn (const Point * a, const Point * b, const Point * c)
{
  return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* The convex hull, counterclockwise (Andrew 1979). Sorts @points. */
static GArray *
find_hull (GArray * points)
{
  GArray *hull = g_array_new (FALSE, FALSE, sizeof (Point));
  const Point *p = (const Point *) points->data;

  g_array_sort (points, compare_points);
  for (guint pass = 0; pass < 2; pass++) {
    const guint floor = hull->len + (pass == 0 ? 2 : 1);

    for (guint i = pass; i < points->len; i++) {
      const Point *next = pass == 0 ? &p[i] : &p[points->len - 1 - i];

      while (hull->len >= floor && turn (&g_array_index (hull, Point,
                  hull->len - 2), &g_array_index (hull, Point, hull->len - 1),
              next) <= 0)
        g_array_set_size (hull, hull->len - 1);
      g_array_append_val (hull, *next);
    }
  }
  g_array_set_size (hull, hull->len - 1);
  return hull;
}

/* The sides of the smallest rectangle about a hull, counterclockwise, normals outwards. */
static void
enclose (const GArray * hull, Line sides[4])
{
  const Point *p = (const Point *) hull->data;
  gdouble least = INFINITY;

  for (guint i = 0; i < hull->len; i++) {
    const Point *q = &p[(i + 1) % hull->len];
    const gdouble dx = q->x - p[i].x, dy = q->y - p[i].y, length =
        hypot (dx, dy);
    const gdouble normals[4][2] = { {dy / length, -dx / length}, {dx / length,
        dy / length}, {-dy / length, dx / length}, {-dx / length,
        -dy / length}
    };
    gdouble offsets[4] = { -INFINITY, -INFINITY, -INFINITY, -INFINITY };

    for (guint j = 0; j < hull->len; j++)
      for (guint k = 0; k < 4; k++)
        offsets[k] = MAX (offsets[k], normals[k][0] * p[j].x +
            normals[k][1] * p[j].y);
    if ((offsets[0] + offsets[2]) * (offsets[1] + offsets[3]) < least) {
      least = (offsets[0] + offsets[2]) * (offsets[1] + offsets[3]);
      for (guint k = 0; k < 4; k++)
        sides[k] = (Line) { {
        normals[k][0], normals[k][1]}
        , offsets[k]};
    }
  }
}

static gboolean
intersect (const Line * a, const Line * b, Point * at)
{
  const gdouble det = a->normal[0] * b->normal[1] - a->normal[1] * b->normal[0];

  if (!(fabs (det) > 0.1))
    return FALSE;
  at->x = (a->offset * b->normal[1] - b->offset * a->normal[1]) / det;
  at->y = (a->normal[0] * b->offset - b->normal[0] * a->offset) / det;
  return TRUE;
}

/* Where each side meets the next. */
static gboolean
find_meetings (const Line sides[4], Point corners[4])
{
  for (guint k = 0; k < 4; k++)
    if (!intersect (&sides[k], &sides[(k + 1) % 4], &corners[k]))
      return FALSE;
  return TRUE;
}

/* The line of least squares through the points that lie nearest to side @k, away from its ends.
 * Returns: their RMS distance from it, m; NaN: there are none */
static gdouble
fit_side (const GArray * points, const Line sides[4], const Point corners[4],
    guint k, Line * line)
{
  const Point *from = &corners[(k + 3) % 4], *to = &corners[k];
  const gdouble dx = to->x - from->x, dy = to->y - from->y;
  gdouble n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, angle;

  for (guint i = 0; i < points->len; i++) {
    const Point *p = &g_array_index (points, Point, i);
    const gdouble along = ((p->x - from->x) * dx + (p->y - from->y) * dy) /
        (dx * dx + dy * dy);
    gdouble off[4];

    for (guint l = 0; l < 4; l++)
      off[l] = fabs (sides[l].normal[0] * p->x + sides[l].normal[1] * p->y -
          sides[l].offset);
    if (!(along > MARGIN && along < 1. - MARGIN)
        || off[k] > MIN (off[(k + 1) % 4], MIN (off[(k + 2) % 4],
                off[(k + 3) % 4])))
      continue;
    n++;
    x += p->x - from->x;
    y += p->y - from->y;
    xx += (p->x - from->x) * (p->x - from->x);
    xy += (p->x - from->x) * (p->y - from->y);
    yy += (p->y - from->y) * (p->y - from->y);
  }
  if (n < 2)
    return NAN;
  x /= n;
  y /= n;
  xx = xx / n - x * x;
  xy = xy / n - x * y;
  yy = yy / n - y * y;
  angle = 0.5 * atan2 (2. * xy, xx - yy);
  line->normal[0] = sin (angle);
  line->normal[1] = -cos (angle);
  if (line->normal[0] * sides[k].normal[0] +
      line->normal[1] * sides[k].normal[1] < 0) {
    line->normal[0] = -line->normal[0];
    line->normal[1] = -line->normal[1];
  }
  line->offset = line->normal[0] * (x + from->x) + line->normal[1] * (y +
      from->y);
  return sqrt (MAX (0.5 * (xx + yy) - hypot (0.5 * (xx - yy), xy), 0.));
}

/* Lines to the four sides of an outline, and their corners, counterclockwise. @rms: of the worst side */
static gboolean
fit_sides (GArray * points, Point corners[4], gdouble * rms)
{
  /* all of it may lie on the picture's edge */
  g_autoptr (GArray) hull = points->len ? find_hull (points) : NULL;
  Line sides[4] = { 0 };

  if (!hull || hull->len < 3)
    return FALSE;
  enclose (hull, sides);
  for (guint round = 0; round < ROUNDS; round++) {
    Line fitted[4];

    if (!find_meetings (sides, corners))
      return FALSE;
    *rms = 0.;
    for (guint k = 0; k < 4; k++) {
      const gdouble side = fit_side (points, sides, corners, k, &fitted[k]);

      if (!(side >= 0))
        return FALSE;
      *rms = MAX (*rms, side);
    }
    memcpy (sides, fitted, sizeof sides);
  }
  return find_meetings (sides, corners);
}

static gdouble
measure (const Point * a, const Point * b)
{
  return hypot (b->x - a->x, b->y - a->y);
}

/* Corners of the cloth as one camera sees it, clockwise from above as uv = 0 0, w 0, w h, 0 h are. */
static gboolean
find_corners (const ClothFlatParams * params, const ClothFlatView * view,
    Point corners[4], GError ** error)
{
  gboolean is_cut = FALSE, fits = FALSE;
  g_autoptr (GArray) points = find_outline (view, params->ground, &is_cut,
      error);
  const gchar *cut = is_cut ? " (the edge of its picture cuts the silhouette: "
      "more of the cloth must be seen)" : "";
  const gdouble *size = params->size;
  Point found[4];
  gdouble rms, sides[2];

  if (!points)
    return FALSE;
  if (!fit_sides (points, found, &rms) || rms > params->straight) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_SHAPE,
        "camera “%s”: the outline has no four straight sides; the cloth must "
        "lie flat on the ground in the first picture%s",
        get_name (view->camera), cut);
    return FALSE;
  }
  for (guint k = 0; k < 4; k++)
    corners[k] = found[3 - k];
  for (guint k = 0; k < 2; k++)
    sides[k] = 0.5 * (measure (&corners[k], &corners[k + 1])
        + measure (&corners[k + 2], &corners[(k + 3) % 4]));
  for (guint k = 0; k < 2; k++)
    fits |= fabs (sides[0] / size[k] - 1.) < params->stretch
        && fabs (sides[1] / size[1 - k] - 1.) < params->stretch;
  if (!fits) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_SHAPE,
        "camera “%s” sees a rectangle of %.3f × %.3f m, the cloth has %.3f × "
        "%.3f m: are its size, the rig and the ground at z = %g m right, and "
        "does it lie flat?%s", get_name (view->camera), sides[0], sides[1],
        size[0], size[1], params->ground, cut);
    return FALSE;
  }
  return TRUE;
}

/* Turns @corners so that each is near to its like of @to. */
static void
turn_to (Point corners[4], const Point to[4])
{
  gdouble least = INFINITY;
  guint best = 0;
  Point turned[4];

  for (guint shift = 0; shift < 4; shift++) {
    gdouble sum = 0.;

    for (guint k = 0; k < 4; k++)
      sum += measure (&corners[(k + shift) % 4], &to[k]);
    if (sum < least) {
      least = sum;
      best = shift;
    }
  }
  for (guint k = 0; k < 4; k++)
    turned[k] = corners[(k + best) % 4];
  memcpy (corners, turned, sizeof turned);
}

/* The mean of each corner over the cameras, if they agree. */
static gboolean
average (const ClothFlatParams * params, guint n, const ClothFlatView * views,
    const Point * corners, Point mean[4], GError ** error)
{
  gdouble worst = 0.;
  guint who = 0;

  memset (mean, 0, 4 * sizeof *mean);
  for (guint c = 0; c < n; c++)
    for (guint k = 0; k < 4; k++) {
      mean[k].x += corners[4 * c + k].x / n;
      mean[k].y += corners[4 * c + k].y / n;
    }
  for (guint c = 0; c < n && n > 1; c++)
    for (guint k = 0; k < 4; k++) {
      /* from the mean of the others */
      const gdouble off = measure (&corners[4 * c + k], &mean[k]) * n / (n - 1);

      if (off > worst) {
        worst = off;
        who = c;
      }
    }
  if (worst > params->agree) {
    g_set_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_DISAGREE,
        "camera “%s” sees a corner of the cloth %.0f mm from where the others "
        "see it: is it where the rig says, and the ground at z = %g m?",
        get_name (views[who].camera), 1e3 * worst, params->ground);
    return FALSE;
  }
  return TRUE;
}

/* Lays the known rectangle on corners, the first on corner @shift. */
static ClothFlatPose
lay (const ClothFlatParams * params, const Point corners[4], guint shift)
{
  const gdouble w = params->size[0], h = params->size[1];
  /* places of the corners, v downwards, about the middle */
  const Point model[4] = { {-w / 2, h / 2}, {w / 2, h / 2}, {w / 2, -h / 2},
  {-w / 2, -h / 2}
  };
  ClothFlatPose pose = { 0., 0., 0., {w, h}, params->ground, 0. };
  Point middle = { 0., 0. };
  gdouble dot = 0., cross = 0., sum = 0., c, s;

  for (guint k = 0; k < 4; k++) {
    middle.x += corners[k].x / 4;
    middle.y += corners[k].y / 4;
  }
  for (guint k = 0; k < 4; k++) {
    const Point *q = &corners[(k + shift) % 4];

    dot += model[k].x * (q->x - middle.x) + model[k].y * (q->y - middle.y);
    cross += model[k].x * (q->y - middle.y) - model[k].y * (q->x - middle.x);
  }
  pose.angle = atan2 (cross, dot);
  c = cos (pose.angle);
  s = sin (pose.angle);
  pose.x = middle.x + c * model[0].x - s * model[0].y;
  pose.y = middle.y + s * model[0].x + c * model[0].y;
  for (guint k = 0; k < 4; k++) {
    const Point at = { middle.x + c * model[k].x - s * model[k].y,
      middle.y + s * model[k].x + c * model[k].y
    };
    const gdouble off = measure (&at, &corners[(k + shift) % 4]);

    sum += off * off;
  }
  pose.residual = sqrt (sum / 4);
  return pose;
}

/* @poses: (inout): poses that fit alike
 * @near: (nullable) (array fixed-size=2): a place near to vertex 0, m, world
 *
 * Puts first the one whose vertex 0 is nearest to @near, or without that the one of the least
 * residual, of equal ones that of the least angle.
 */
void
cloth_flat_sort (ClothFlatPoses * poses, const gdouble * near)
{
  for (guint i = 1; i < poses->n; i++)
    for (guint j = i; j > 0; j--) {
      ClothFlatPose *a = &poses->poses[j - 1], *b = &poses->poses[j];
      const ClothFlatPose kept = *a;
      const gdouble gain = near ? hypot (a->x - near[0], a->y - near[1]) -
          hypot (b->x - near[0], b->y - near[1]) : a->residual - b->residual;

      if (gain < -1e-9 || (gain < 1e-9 && a->angle <= b->angle))
        break;
      *a = *b;
      *b = kept;
    }
}

/* @params: what is looked for
 * @n_views: cameras
 * @views: (array length=n_views): what they see
 * @near: (nullable) (array fixed-size=2): a place near to vertex 0, m, world: the pose that is
 *   meant comes first
 * @poses: (out): those that fit
 * @error: #ClothFlatError
 *
 * The closed form: corners, and the known rectangle laid on them.
 *
 * Returns: %FALSE when no pose fits
 */
gboolean
cloth_flat_find (const ClothFlatParams * params, guint n_views,
    const ClothFlatView * views, const gdouble * near, ClothFlatPoses * poses,
    GError ** error)
{
  g_autofree Point *corners = NULL;
  Point mean[4];
  gdouble least = INFINITY;

  poses->n = 0;
  if (!cloth_flat_check (params, n_views, views, error))
    return FALSE;
  corners = g_new (Point, 4 * n_views);
  for (guint c = 0; c < n_views; c++) {
    if (!find_corners (params, &views[c], corners + 4 * c, error))
      return FALSE;
    turn_to (corners + 4 * c, corners);
  }
  if (!average (params, n_views, views, corners, mean, error))
    return FALSE;
  for (guint shift = 0; shift < 4; shift++)
    least = MIN (least, lay (params, mean, shift).residual);
  for (guint shift = 0; shift < 4; shift++) {
    const ClothFlatPose pose = lay (params, mean, shift);

    if (pose.residual < least + ALIKE)
      poses->poses[poses->n++] = pose;
  }
  cloth_flat_sort (poses, near);
  return TRUE;
}

/* ---- places ---- */

/* @pose: where the cloth lies
 * @uv: a place of it, m
 * @X: (out): where that is, m, world
 */
void
cloth_flat_place (const ClothFlatPose * pose, const gdouble uv[2], gdouble X[3])
{
  const gdouble c = cos (pose->angle), s = sin (pose->angle);

  X[0] = pose->x + c * uv[0] + s * uv[1];
  X[1] = pose->y + s * uv[0] - c * uv[1];
  X[2] = pose->ground;
}

/* @pose: where the cloth lies
 * @camera: a camera
 * @px: a place of its picture, px
 * @uv: (out): which place of the cloth it shows, m
 *
 * Returns: %FALSE when it shows none
 */
gboolean
cloth_flat_uv (const ClothFlatPose * pose, const ClothCamera * camera,
    const gdouble px[2], gdouble uv[2])
{
  const gdouble c = cos (pose->angle), s = sin (pose->angle);
  gdouble xy[2];

  if (!cloth_flat_reach (camera, pose->ground, px, xy, NULL))
    return FALSE;
  uv[0] = c * (xy[0] - pose->x) + s * (xy[1] - pose->y);
  uv[1] = s * (xy[0] - pose->x) - c * (xy[1] - pose->y);
  return uv[0] >= 0 && uv[0] <= pose->size[0] && uv[1] >= 0
      && uv[1] <= pose->size[1];
}
