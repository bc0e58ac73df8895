/* Panels as they are drawn: outlines of named edges in an SVG file.
 *
 * Of SVG, what a drawing program writes for lines: groups and paths. Whatever lies outside
 * of panels (a picture of the print, notes) is passed over.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/garment/panel.h"

#include <math.h>
#include <string.h>

#include "gst/mesh/garment/svgpath.h"

/* Limits on untrusted input. */
#define MOST_BYTES (8u << 20)
#define MOST_DEPTH 64
#define MOST_PANELS 64
#define MOST_EDGES 64
#define MOST_POINTS 4000
/* How far a line may be from its curve, and ends of edges from each other. */
#define CURVE_TOLERANCE 0.00005
#define END_TOLERANCE 0.0005

typedef struct
{
  GArray *panels;
  gdouble unit_m[2];            /* of a user unit each way; 0 before <svg> */
  gdouble corner[2];            /* of the viewBox */
  guint depth, panel_depth;     /* 0: in no panel */
  guint transform_depth;        /* 0: nothing around is transformed */
} Reader;

static void
edge_clear (gpointer data)
{
  ClothDrawnEdge *edge = data;

  g_free (edge->name);
  g_free (edge->seam);
  if (edge->points)
    g_array_unref (edge->points);
}

static void
panel_clear (gpointer data)
{
  ClothDrawnPanel *panel = data;

  g_free (panel->name);
  g_array_unref (panel->edges);
}

static const gchar *
find (const gchar ** names, const gchar ** values, const gchar * name)
{
  for (guint i = 0; names[i]; i++)
    if (strcmp (names[i], name) == 0)
      return values[i];
  return NULL;
}

/* CSS: words of a class are told apart by space. */
static gboolean
is_panel (const gchar * class)
{
  g_auto (GStrv) words = g_strsplit_set (class ? class : "", " \t\r\n", -1);

  return g_strv_contains ((const gchar * const *) words, "panel");
}

/* By its attribute or by its style. */
static gboolean
is_transformed (const gchar ** names, const gchar ** values)
{
  const gchar *style = find (names, values, "style");
  g_auto (GStrv) properties = g_strsplit (style ? style : "", ";", -1);
  gboolean found = find (names, values, "transform") != NULL;

  for (guint i = 0; properties[i] && !found; i++) {
    properties[i][strcspn (properties[i], ":")] = 0;
    found = strcmp (g_strstrip (properties[i]), "transform") == 0;
  }
  return found;
}

/* "760mm" in metres. */
static gboolean
read_length (const gchar * text, gdouble * metres)
{
  static const struct
  {
    const gchar *name;
    gdouble metres;
  } units[] = { {"mm", 1e-3}, {"cm", 1e-2}, {"in", 0.0254} };
  gchar *end;
  gdouble value = text ? g_ascii_strtod (text, &end) : 0;

  for (guint i = 0; text && i < G_N_ELEMENTS (units); i++)
    if (strcmp (end, units[i].name) == 0) {
      *metres = value * units[i].metres;
      return *metres > 1e-4 && *metres < 1000;
    }
  return FALSE;
}

static gboolean
read_root (Reader * reader, const gchar ** names, const gchar ** values,
    GError ** error)
{
  const gchar *box = find (names, values, "viewBox");
  gdouble size[2], numbers[4];

  if (!read_length (find (names, values, "width"), &size[0])
      || !read_length (find (names, values, "height"), &size[1]))
    return cloth_file_invalid (error,
        "the drawing has no true size: give <svg> a width "
        "and a height in mm, cm or in");
  for (guint i = 0; i < 4; i++) {
    gchar *end = NULL;

    numbers[i] = box ? g_ascii_strtod (box, &end) : 0;
    if (!box || end == box || !isfinite (numbers[i]))
      return cloth_file_invalid (error,
          "give <svg> a viewBox of four numbers, for "
          "instance \"0 0 760 2510\" with a width of 760mm");
    box = end;
    while (*box == ',' || *box == ' ')
      box++;
  }
  for (guint i = 0; i < 2; i++) {
    if (!(numbers[2 + i] > 0))
      return cloth_file_invalid (error, "the viewBox of <svg> is empty");
    reader->unit_m[i] = size[i] / numbers[2 + i];
    reader->corner[i] = numbers[i];
  }
  if (fabs (reader->unit_m[0] / reader->unit_m[1] - 1) > 1e-3)
    return cloth_file_invalid (error,
        "the viewBox of <svg> has another shape than its "
        "width and height, which would stretch the panels: a unit is %g mm "
        "wide and %g mm high", 1000 * reader->unit_m[0],
        1000 * reader->unit_m[1]);
  return TRUE;
}

static gboolean
begin_panel (Reader * reader, const gchar * id, GError ** error)
{
  ClothDrawnPanel panel = { NULL, NULL };

  if (!id || !*id)
    return cloth_file_invalid (error,
        "a panel has no id; it is the panel's name");
  if (strlen (id) > 255 || !g_utf8_validate (id, -1, NULL))
    return cloth_file_invalid (error, "the id of a panel is too long");
  for (guint i = 0; i < reader->panels->len; i++)
    if (strcmp (g_array_index (reader->panels, ClothDrawnPanel, i).name,
            id) == 0)
      return cloth_file_invalid (error, "two panels are called “%s”", id);
  if (reader->panels->len == MOST_PANELS)
    return cloth_file_invalid (error, "more than %d panels", MOST_PANELS);
  panel.name = g_strdup (id);
  panel.edges = g_array_new (FALSE, TRUE, sizeof (ClothDrawnEdge));
  g_array_set_clear_func (panel.edges, edge_clear);
  g_array_append_val (reader->panels, panel);
  reader->panel_depth = reader->depth;
  return TRUE;
}

static gboolean
read_path (Reader * reader, const gchar ** names, const gchar ** values,
    GError ** error)
{
  ClothDrawnPanel *panel = &g_array_index (reader->panels, ClothDrawnPanel,
      reader->panels->len - 1);
  const gchar *id = find (names, values, "id");
  const gchar *seam = find (names, values, "data-seam");
  const gchar *d = find (names, values, "d");
  ClothDrawnEdge *edge;

  if (panel->edges->len == MOST_EDGES)
    return cloth_file_invalid (error, "panel “%s” has more than %d edges",
        panel->name, MOST_EDGES);
  g_array_set_size (panel->edges, panel->edges->len + 1);
  edge = &g_array_index (panel->edges, ClothDrawnEdge, panel->edges->len - 1);
  edge->name = id ? g_strndup (id, 255)
      : g_strdup_printf ("edge %u", panel->edges->len);
  edge->seam = seam && *seam ? g_strndup (seam, 255) : NULL;
  edge->points = g_array_new (FALSE, FALSE, sizeof (gdouble));
  if (!d)
    return cloth_file_invalid (error,
        "panel “%s”: edge “%s” has no path data (d)", panel->name,
        edge->name);
  if (!cloth_svg_path_parse (d, CURVE_TOLERANCE / reader->unit_m[0],
          MOST_POINTS, edge->points, error)) {
    g_prefix_error (error, "panel “%s”, edge “%s”: ", panel->name,
        edge->name);
    return FALSE;
  }
  for (guint i = 0; i < edge->points->len; i++) {
    gdouble *p = &g_array_index (edge->points, gdouble, i);

    *p = (*p - reader->corner[i % 2]) * reader->unit_m[i % 2];
    if (i >= 2 && i % 2)
      edge->length_m += hypot (p[0] - p[-2], p[-1] - p[-3]);
  }
  if (!(edge->length_m > 2 * END_TOLERANCE))
    return cloth_file_invalid (error,
        "panel “%s”: edge “%s” has no length", panel->name, edge->name);
  return TRUE;
}

static void
start_element (GMarkupParseContext * context, const gchar * element,
    const gchar ** names, const gchar ** values, gpointer data, GError ** error)
{
  Reader *reader = data;
  const gchar *colon = strrchr (element, ':');
  const gchar *name = colon ? colon + 1 : element;

  reader->depth++;
  if (reader->depth > MOST_DEPTH) {
    cloth_file_invalid (error, "groups are nested more than %d deep",
        MOST_DEPTH);
    return;
  }
  if (reader->depth == 1) {
    if (strcmp (name, "svg"))
      cloth_file_invalid (error, "the file is no SVG drawing but has a <%s>",
          name);
    else
      read_root (reader, names, values, error);
    return;
  }
  if (!reader->transform_depth && is_transformed (names, values))
    reader->transform_depth = reader->depth;
  if (!reader->panel_depth && strcmp (name, "g") == 0
      && is_panel (find (names, values, "class"))
      && !begin_panel (reader, find (names, values, "id"), error))
    return;
  if (!reader->panel_depth || strcmp (name, "path"))
    return;
  if (reader->transform_depth)
    cloth_file_invalid (error,
        "panel “%s” is moved by a transform; apply it to the "
        "paths (in Inkscape: ungroup, or move with objects' coordinates set to "
        "optimised)", g_array_index (reader->panels, ClothDrawnPanel,
            reader->panels->len - 1).name);
  else
    read_path (reader, names, values, error);
}

static void
end_element (GMarkupParseContext * context, const gchar * element,
    gpointer data, GError ** error)
{
  Reader *reader = data;

  if (reader->panel_depth == reader->depth)
    reader->panel_depth = 0;
  if (reader->transform_depth == reader->depth)
    reader->transform_depth = 0;
  reader->depth--;
}

static const gdouble *
edge_end (const ClothDrawnEdge * edge, gboolean last)
{
  return &g_array_index (edge->points, gdouble, last ? edge->points->len -
      2 : 0);
}

static gdouble
distance (const gdouble * a, const gdouble * b)
{
  return hypot (a[0] - b[0], a[1] - b[1]);
}

static void
turn_edge (ClothDrawnEdge * edge)
{
  gdouble *p = (gdouble *) (gpointer) edge->points->data;

  for (guint i = 0, j = edge->points->len - 2; i < j; i += 2, j -= 2)
    for (guint c = 0; c < 2; c++) {
      gdouble swap = p[i + c];

      p[i + c] = p[j + c];
      p[j + c] = swap;
    }
}

/* Puts the edges of a panel end to end. */
static gboolean
join_edges (ClothDrawnPanel * panel, GError ** error)
{
  guint n = panel->edges->len;
  ClothDrawnEdge *edges = (ClothDrawnEdge *) (gpointer) panel->edges->data;
  gdouble area = 0;

  if (n == 0)
    return cloth_file_invalid (error, "panel “%s” has no path",
        panel->name);
  if (n > 1) {
    /* the first edge ends where the second has an end */
    gdouble away[2];

    for (guint i = 0; i < 2; i++)
      away[i] = fmin (distance (edge_end (&edges[0], i == 0),
              edge_end (&edges[1], FALSE)), distance (edge_end (&edges[0],
                  i == 0), edge_end (&edges[1], TRUE)));
    if (away[1] < away[0])
      turn_edge (&edges[0]);
    /* two edges that share both ends: the first is right as it is */
  }
  for (guint i = 0; i < n; i++) {
    ClothDrawnEdge *edge = &edges[i], *next = &edges[(i + 1) % n];
    const gdouble *end = edge_end (edge, TRUE);
    gdouble *begin;

    if (i + 1 < n && distance (end, edge_end (next, TRUE))
        < distance (end, edge_end (next, FALSE)))
      turn_edge (next);
    begin = (gdouble *) edge_end (next, FALSE);
    if (i + 1 < n && distance (end, begin) > END_TOLERANCE
        && distance (end, edge_end (&edges[0], FALSE)) <= END_TOLERANCE)
      return cloth_file_invalid (error,
          "the outline of panel “%s” is closed before its edge “%s”; a panel "
          "is cut along one line, without holes: draw two panels, and sew "
          "them together at the hole", panel->name, next->name);
    if (distance (end, begin) > END_TOLERANCE)
      return cloth_file_invalid (error,
          "the outline of panel “%s” is open: its edge "
          "“%s” ends at (%.1f, %.1f) mm and “%s” begins %.1f mm away at "
          "(%.1f, %.1f); draw the edges one after the other, end to end",
          panel->name, edge->name, 1000 * end[0], 1000 * end[1], next->name,
          1000 * distance (end, begin), 1000 * begin[0], 1000 * begin[1]);
    memcpy (begin, end, 2 * sizeof *begin);
  }
  for (guint i = 0; i < n; i++) {
    const gdouble *p = (gdouble *) (gpointer) edges[i].points->data;

    for (guint k = 0; k + 3 < edges[i].points->len; k += 2)
      area += p[k] * p[k + 3] - p[k + 2] * p[k + 1];
  }
  /* y goes down the page: what is counter-clockwise to the eye has a negative area */
  if (area > 0) {
    for (guint i = 0; i < n; i++)
      turn_edge (&edges[i]);
    for (guint i = 0, j = n - 1; i < j; i++, j--) {
      ClothDrawnEdge swap = edges[i];

      edges[i] = edges[j];
      edges[j] = swap;
    }
  }
  return TRUE;
}

/* @svg: (nullable): an SVG drawing, UTF-8
 * @size: its bytes
 * @error: #ClothFileError
 *
 * A panel is a group of class `panel` with an id. Its paths are the edges of its outline,
 * one after the other, each in either direction; `data-seam` names the seam of an edge. The
 * size of <svg> in mm, cm or in and its viewBox give the scale; the drawing's top-left
 * corner is that of the printed cloth.
 *
 * Returns: (transfer full) (element-type ClothDrawnPanel): the panels
 */
GArray *
cloth_panels_parse (const gchar * svg, gsize size, GError ** error)
{
  static const GMarkupParser parser = { start_element, end_element, NULL, NULL,
    NULL
  };
  Reader reader = { NULL, };
  g_autoptr (GMarkupParseContext) context = NULL;
  g_autoptr (GArray) panels = g_array_new (FALSE, TRUE,
      sizeof (ClothDrawnPanel));

  if (size > MOST_BYTES) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "the drawing has %" G_GSIZE_FORMAT " bytes, more than %u", size,
        MOST_BYTES);
    return NULL;
  }
  g_array_set_clear_func (panels, panel_clear);
  reader.panels = panels;
  context = g_markup_parse_context_new (&parser,
      G_MARKUP_TREAT_CDATA_AS_TEXT, &reader, NULL);
  if (!g_markup_parse_context_parse (context, size > 0 ? svg : "",
          (gssize) size, error)
      || !g_markup_parse_context_end_parse (context, error))
    return NULL;
  if (panels->len == 0) {
    cloth_file_invalid (error,
        "the drawing has no panel: put the paths of each into a "
        "group with an id and class=\"panel\"");
    return NULL;
  }
  for (guint i = 0; i < panels->len; i++)
    if (!join_edges (&g_array_index (panels, ClothDrawnPanel, i), error))
      return NULL;
  return g_steal_pointer (&panels);
}
