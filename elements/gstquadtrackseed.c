/* Squares given to quadtrack by hand: the property, and what keeps one from starting.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstquadtrackseed.h"

#include <math.h>

#define N GST_QUAD_TRACK_SEED_NUMBERS

gboolean
gst_quad_track_seed_parse (const gchar * text, gfloat seed[N])
{
  g_auto (GStrv) parts = g_strsplit (text, ",", N + 1);
  guint n = g_strv_length (parts);

  if (n != N - 2 && n != N)
    return FALSE;
  seed[8] = seed[9] = -1;
  for (guint k = 0; k < n; k++) {
    gchar *end;
    gdouble value = g_ascii_strtod (g_strstrip (parts[k]), &end);

    if (end == parts[k] || *end || !isfinite (value) || fabs (value) > 1e6
        || (k >= 8 && (value < 0 || value != floor (value))))
      return FALSE;
    seed[k] = (gfloat) value;
  }
  return TRUE;
}

void
gst_quad_track_seed_check_start (GstElement * element,
    GstQuadTrackWarned * warned, const ClothPattern * pattern,
    const ClothQuadParams * params, guint n_seeds)
{
  if (warned->of_start)
    return;
  if (params->link) {
    if (MIN (pattern->columns, pattern->rows) > 2)
      return;
    warned->of_start = TRUE;
    GST_ELEMENT_WARNING (element, RESOURCE, SETTINGS,
        ("A board of %d×%d squares is too narrow to be found by itself.",
            pattern->columns, pattern->rows),
        ("Set link=false and give a square by \"seed\" or by clicks, or use a "
            "board of three or more squares each way"));
    return;
  }
  warned->of_start = TRUE;
  if (!n_seeds)
    GST_ELEMENT_WARNING (element, RESOURCE, SETTINGS,
        ("With link=false nothing is tracked until a square is given."),
        ("Set \"seed\", click the four corners of a square in the video "
            "window, or set \"link\" to true"));
}

void
gst_quad_track_seed_check (GstElement * element, GstQuadTrackWarned * warned,
    const ClothPattern * pattern, const ClothQuadParams * params, gint column,
    gint row)
{
  if (warned->of_seed || column < 0 || row < 0)
    return;
  if (column >= pattern->columns || row >= pattern->rows) {
    warned->of_seed = TRUE;
    GST_ELEMENT_WARNING (element, RESOURCE, SETTINGS,
        ("The seed's square %d,%d is not on the board of %d×%d squares, so the "
            "seed is of no use.", column, row, pattern->columns, pattern->rows),
        ("End \"seed\" by the square's column,row, counted from 0, or leave "
            "both out"));
  } else if (!params->link && params->squares != CLOTH_SQUARES_BOTH
      && cloth_pattern_is_black (pattern, column, row)
      != (params->squares == CLOTH_SQUARES_BLACK)) {
    warned->of_seed = TRUE;
    GST_ELEMENT_WARNING (element, RESOURCE, SETTINGS,
        ("The seed's square %d,%d is of the colour that is not tracked, so "
            "nothing starts from it.", column, row),
        ("Give a square of the other colour, or set \"squares\" to both"));
  }
}

void
gst_quad_track_seed_check_tracked (GstElement * element,
    GstQuadTrackWarned * warned, const ClothQuadParams * params,
    guint n_seeds, guint n_tracked)
{
  if (warned->of_seed || params->link || !n_seeds || n_tracked)
    return;
  warned->of_seed = TRUE;
  GST_ELEMENT_WARNING (element, RESOURCE, SETTINGS,
      ("No square is seen where one was given, so nothing starts from it."),
      ("Give the corners of a sharp square, 8 pixels or wider, to within half of "
          "its width, and if its column,row is told, from the corner that is its "
          "top-left one on the flat board; or set \"link\" to true"));
}
