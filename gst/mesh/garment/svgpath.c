/* The path data of SVG as a line of points.
 *
 * SVG 1.1, chapter 8, with the arcs of appendix F.6. Curves become as many straight pieces
 * as keep the tolerance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/garment/svgpath.h"

#include <math.h>
#include <string.h>

/* Coordinates beyond this are a mistake. */
#define MOST_COORDINATE 1e7
/* Straight pieces of one curve. */
#define MOST_PIECES 512

typedef struct
{
  const gchar *begin, *at;
  gdouble tolerance;
  guint most_points;
  GArray *points;
  gdouble here[2], start[2];
  gdouble control[2];           /* the last curve's, for S and T */
  gchar last;                   /* the last command, upper case */
  GError **error;
} Path;

static gboolean
fail (Path * path, const gchar * what)
{
  if (path->error && !*path->error)
    g_set_error (path->error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "path data, character %u: %s", (guint) (path->at - path->begin) + 1,
        what);
  return FALSE;
}

static void
skip_spaces (Path * path)
{
  while (*path->at && strchr (" \t\r\n,", *path->at))
    path->at++;
}

/* Whether a number begins here. */
static gboolean
has_number (Path * path)
{
  skip_spaces (path);
  return *path->at && strchr ("+-.0123456789", *path->at);
}

static gboolean
read_number (Path * path, gdouble * value)
{
  gchar text[48];
  const gchar *p;
  guint n = 0;
  gboolean point = FALSE, digits = FALSE;

  if (!has_number (path))
    return fail (path, "a number is missing");
  p = path->at;
  if (*p == '+' || *p == '-')
    text[n++] = *p++;
  for (; n < sizeof text - 1; p++) {
    if (g_ascii_isdigit (*p))
      digits = TRUE;
    else if (*p == '.' && !point)
      point = TRUE;
    else
      break;
    text[n++] = *p;
  }
  /* an exponent, if digits follow */
  if (digits && (*p == 'e' || *p == 'E') && n < sizeof text - 6
      && (g_ascii_isdigit (p[1]) || ((p[1] == '+' || p[1] == '-')
              && g_ascii_isdigit (p[2])))) {
    text[n++] = *p++;
    text[n++] = *p++;
    while (g_ascii_isdigit (*p) && n < sizeof text - 1)
      text[n++] = *p++;
  }
  text[n] = 0;
  if (!digits)
    return fail (path, "a number has no digits");
  *value = g_ascii_strtod (text, NULL);
  if (!(fabs (*value) <= MOST_COORDINATE))
    return fail (path, "a number is out of all measure");
  path->at = p;
  return TRUE;
}

static gboolean
read_flag (Path * path, gboolean * flag)
{
  skip_spaces (path);
  if (*path->at != '0' && *path->at != '1')
    return fail (path, "a flag of an arc is neither 0 nor 1");
  *flag = *path->at++ == '1';
  return TRUE;
}

/* A point, relative to where the pen is when asked. */
static gboolean
read_point (Path * path, gboolean relative, gdouble point[2])
{
  for (guint i = 0; i < 2; i++) {
    if (!read_number (path, &point[i]))
      return FALSE;
    if (relative)
      point[i] += path->here[i];
  }
  return TRUE;
}

static gboolean
line_to (Path * path, gdouble x, gdouble y)
{
  gdouble point[2] = { x, y };

  if (!(fabs (x) <= MOST_COORDINATE && fabs (y) <= MOST_COORDINATE))
    return fail (path, "the path leads out of all measure");
  if (path->points->len / 2 >= path->most_points)
    return fail (path, "the path has too many points");
  if (path->points->len == 0)
    g_array_append_vals (path->points, path->here, 2);
  if (x != path->here[0] || y != path->here[1])
    g_array_append_vals (path->points, point, 2);
  memcpy (path->here, point, sizeof point);
  return TRUE;
}

static gboolean
curve_to (Path * path, const gdouble b[2], const gdouble c[2],
    const gdouble d[2])
{
  gdouble a[2] = { path->here[0], path->here[1] }, bend = 0;
  guint n;

  for (guint i = 0; i < 2; i++)
    bend += fmax ((a[i] - 2 * b[i] + c[i]) * (a[i] - 2 * b[i] + c[i]),
        (b[i] - 2 * c[i] + d[i]) * (b[i] - 2 * c[i] + d[i]));
  /* a piece of 1/n of the curve lies within 6 |second difference| / (8 n²) of its chord */
  n = (guint) CLAMP (ceil (sqrt (0.75 * sqrt (bend) / path->tolerance)), 1,
      MOST_PIECES);
  for (guint k = 1; k <= n; k++) {
    gdouble t = (gdouble) k / n, s = 1 - t, p[2];

    for (guint i = 0; i < 2; i++)
      p[i] = k == n ? d[i] : s * s * s * a[i] + 3 * s * s * t * b[i]
          + 3 * s * t * t * c[i] + t * t * t * d[i];
    if (!line_to (path, p[0], p[1]))
      return FALSE;
  }
  return TRUE;
}

static gboolean
quadratic_to (Path * path, const gdouble q[2], const gdouble d[2])
{
  gdouble b[2], c[2];

  for (guint i = 0; i < 2; i++) {
    b[i] = path->here[i] + 2. / 3 * (q[i] - path->here[i]);
    c[i] = d[i] + 2. / 3 * (q[i] - d[i]);
  }
  return curve_to (path, b, c, d);
}

/* From the end points to the centre: F.6.5 and F.6.6. */
static gboolean
arc_to (Path * path, gdouble rx, gdouble ry, gdouble degrees, gboolean large,
    gboolean sweep, const gdouble to[2])
{
  gdouble phi = degrees * G_PI / 180, co = cos (phi), si = sin (phi);
  gdouble hx = (path->here[0] - to[0]) / 2, hy = (path->here[1] - to[1]) / 2;
  gdouble x = co * hx + si * hy, y = -si * hx + co * hy;
  gdouble scale, factor, cx, cy, centre[2], begin, turn;
  guint n;

  rx = fabs (rx);
  ry = fabs (ry);
  if (hx == 0 && hy == 0)
    return TRUE;
  if (rx == 0 || ry == 0)
    return line_to (path, to[0], to[1]);
  scale = x * x / (rx * rx) + y * y / (ry * ry);
  if (scale > 1) {
    rx *= sqrt (scale);
    ry *= sqrt (scale);
    scale = 1;
  }
  factor = sqrt (fmax (1 / scale - 1, 0)) * (large == sweep ? -1 : 1);
  cx = factor * rx * y / ry;
  cy = -factor * ry * x / rx;
  centre[0] = co * cx - si * cy + (path->here[0] + to[0]) / 2;
  centre[1] = si * cx + co * cy + (path->here[1] + to[1]) / 2;
  begin = atan2 ((y - cy) / ry, (x - cx) / rx);
  turn = atan2 ((-y - cy) / ry, (-x - cx) / rx) - begin;
  if (sweep && turn < 0)
    turn += 2 * G_PI;
  else if (!sweep && turn > 0)
    turn -= 2 * G_PI;
  /* the sagitta of a piece: r turn² / (8 n²) */
  n = (guint) CLAMP (ceil (fabs (turn) * sqrt (fmax (rx, ry)
              / (8 * path->tolerance))), 1, MOST_PIECES);
  for (guint k = 1; k < n; k++) {
    gdouble angle = begin + turn * k / n;
    gdouble px = rx * cos (angle), py = ry * sin (angle);

    if (!line_to (path, centre[0] + co * px - si * py,
            centre[1] + si * px + co * py))
      return FALSE;
  }
  return line_to (path, to[0], to[1]);
}

/* One set of arguments of a command. */
static gboolean
draw (Path * path, gchar upper, gboolean relative)
{
  gdouble a[2], b[2], c[2], r[3], value;
  gboolean large, sweep;

  switch (upper) {
    case 'L':
      return read_point (path, relative, a) && line_to (path, a[0], a[1]);
    case 'H':
      return read_number (path, &value)
          && line_to (path, value + (relative ? path->here[0] : 0),
          path->here[1]);
    case 'V':
      return read_number (path, &value)
          && line_to (path, path->here[0],
          value + (relative ? path->here[1] : 0));
    case 'C':
    case 'S':
      for (guint i = 0; i < 2; i++)
        a[i] = strchr ("CS", path->last) ? 2 * path->here[i] - path->control[i]
            : path->here[i];
      if ((upper == 'C' && !read_point (path, relative, a))
          || !read_point (path, relative, b) || !read_point (path, relative, c))
        return FALSE;
      memcpy (path->control, b, sizeof b);
      return curve_to (path, a, b, c);
    case 'Q':
    case 'T':
      for (guint i = 0; i < 2; i++)
        a[i] = strchr ("QT", path->last) ? 2 * path->here[i] - path->control[i]
            : path->here[i];
      if ((upper == 'Q' && !read_point (path, relative, a))
          || !read_point (path, relative, c))
        return FALSE;
      memcpy (path->control, a, sizeof a);
      return quadratic_to (path, a, c);
    default:
      return read_number (path, &r[0]) && read_number (path, &r[1])
          && read_number (path, &r[2]) && read_flag (path, &large)
          && read_flag (path, &sweep) && read_point (path, relative, a)
          && arc_to (path, r[0], r[1], r[2], large, sweep, a);
  }
}

static gboolean
run (Path * path)
{
  for (;;) {
    gchar command, upper;
    gboolean relative;

    skip_spaces (path);
    command = *path->at;
    if (command == 0)
      return path->points->len >= 4 || fail (path, "nothing is drawn");
    upper = g_ascii_toupper (command);
    relative = command != upper;
    if (path->last == 0 && upper != 'M')
      return fail (path, "a path begins with M");
    if (!strchr ("MLHVCSQTAZ", upper))
      return fail (path, "not a command of path data");
    if (path->last == 'Z')
      return fail (path, "an outline is one line; nothing may follow Z");
    path->at++;
    if (upper == 'Z') {
      if (!line_to (path, path->start[0], path->start[1]))
        return FALSE;
      path->last = 'Z';
      continue;
    }
    if (upper == 'M') {
      if (path->last != 0)
        return fail (path, "an outline is one line; a second M may not follow");
      if (!read_point (path, relative, path->start))
        return FALSE;
      memcpy (path->here, path->start, sizeof path->here);
      /* further points are lines */
      path->last = 'M';
      upper = 'L';
      if (!has_number (path))
        continue;
    }
    do {
      if (!draw (path, upper, relative))
        return FALSE;
      path->last = upper;
    } while (has_number (path));
  }
}

/* @data: what stands in the attribute `d`: M L H V C S Q T A Z, absolute and relative
 * @tolerance: how far the line may be from a curve, in the file's units, above 0
 * @most_points: most points of the line
 * @points: (element-type gdouble): the line's points are added to it, x and y of each; a
 *   closed one ends where it began
 * @error: #ClothFileError
 *
 * Returns: %FALSE when the data is not one line
 */
gboolean
cloth_svg_path_parse (const gchar * data, gdouble tolerance,
    guint most_points, GArray * points, GError ** error)
{
  GError *found = NULL;
  Path path = {.begin = data,.at = data,.tolerance = tolerance,
    .most_points = most_points,.points = points,.error = &found
  };

  if (run (&path))
    return TRUE;
  g_propagate_error (error, found);
  return FALSE;
}
