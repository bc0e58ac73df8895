/* Garments: panels cut from printed cloth and sewn together.
 *
 * V. Scholz et al., “Garment Motion Capture Using Color-Coded Patterns” (2005), section 3.2:
 * vertices at the dots inside each panel's border, the grid triangulated up to the border
 * curve, seams as pairs of vertices. Border vertices lie evenly on each edge, no farther
 * apart than dots; dots nearer to the border than half a pitch get no vertex, so that
 * every piece of the border is a side of the Delaunay triangulation.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/garment/garment.h"

#include <math.h>
#include <string.h>

#include "gst/math/delaunay.h"
#include "gst/mesh/garment/panel.h"
#include "gst/mesh/seam.h"

/* Least distance of a dot's vertex from the border, pitches. */
#define CLEARANCE 0.499
/* Least area of a triangle, squares of the pitch. One with less has its three vertices on
 * a straight border. */
#define SLIVER 1e-3
#define MOST_VERTICES 65536
/* How far a panel may leave the cloth: the drawing's rounding. */
#define CLOTH_TOLERANCE 0.0005

typedef struct
{
  const ClothDotGrid *grid;
  GArray *drawn;                /* ClothDrawnPanel */
  GArray *counts;               /* guint a drawn edge: pieces */
  ClothGarment *garment;
  GArray *uv;                   /* gdouble */
  GArray *dots;                 /* gint */
  GArray *faces;                /* guint32 */
  GArray *firsts;               /* guint a drawn edge: its first vertex */
} Builder;

static void
panel_clear (gpointer data)
{
  g_free (((ClothPanel *) data)->name);
}

static ClothDrawnPanel *
get_panel (const Builder * self, guint i)
{
  return &g_array_index (self->drawn, ClothDrawnPanel, i);
}

static ClothDrawnEdge *
get_edge (const Builder * self, guint panel, guint i)
{
  return &g_array_index (get_panel (self, panel)->edges, ClothDrawnEdge, i);
}

/* The number of an edge among all. */
static guint
edge_number (const Builder * self, guint panel, guint edge)
{
  for (guint i = 0; i < panel; i++)
    edge += get_panel (self, i)->edges->len;
  return edge;
}

/* ---- seams ---- */

typedef struct
{
  guint panel, edge;
} EdgeRef;

/* How many pieces each edge is cut into. The two edges of a seam get the same number. */
static gboolean
count_pieces (Builder * self, GArray * seam_edges, GError ** error)
{
  g_autoptr (GHashTable) seams = g_hash_table_new (g_str_hash, g_str_equal);

  for (guint p = 0; p < self->drawn->len; p++)
    for (guint e = 0; e < get_panel (self, p)->edges->len; e++) {
      const ClothDrawnEdge *edge = get_edge (self, p, e);
      guint least = get_panel (self, p)->edges->len == 1 ? 3 : 1;
      guint n = (guint) MAX (ceil (edge->length_m / self->grid->pitch_m - 1e-3),
          least);
      EdgeRef ref = { p, e };
      gpointer at;

      g_array_append_val (self->counts, n);
      if (!edge->seam)
        continue;
      if (!g_hash_table_lookup_extended (seams, edge->seam, NULL, &at)) {
        g_hash_table_insert (seams, edge->seam,
            GUINT_TO_POINTER (self->garment->seam_names->len));
        g_ptr_array_add (self->garment->seam_names, g_strdup (edge->seam));
        g_array_append_val (seam_edges, ref);
        ref.panel = G_MAXUINT;
        g_array_append_val (seam_edges, ref);
        continue;
      }
      {
        EdgeRef *pair = &g_array_index (seam_edges, EdgeRef,
            2 * GPOINTER_TO_UINT (at));

        if (pair[1].panel != G_MAXUINT)
          return cloth_file_invalid (error,
              "seam “%s” is named by three edges: “%s” of "
              "panel “%s”, “%s” of “%s” and “%s” of “%s”; a seam joins two",
              edge->seam, get_edge (self, pair[0].panel, pair[0].edge)->name,
              get_panel (self, pair[0].panel)->name, get_edge (self,
                  pair[1].panel, pair[1].edge)->name, get_panel (self,
                  pair[1].panel)->name, edge->name, get_panel (self, p)->name);
        pair[1] = ref;
      }
    }
  for (guint s = 0; s < self->garment->seam_names->len; s++) {
    const gchar *name = g_ptr_array_index (self->garment->seam_names, s);
    const EdgeRef *pair = &g_array_index (seam_edges, EdgeRef, 2 * s);
    const ClothDrawnEdge *a = get_edge (self, pair[0].panel, pair[0].edge), *b;
    guint *na, *nb;

    if (pair[1].panel == G_MAXUINT)
      return cloth_file_invalid (error,
          "seam “%s” is named by edge “%s” of panel “%s” "
          "alone; give the edge that it is sewn to the same data-seam", name,
          a->name, get_panel (self, pair[0].panel)->name);
    b = get_edge (self, pair[1].panel, pair[1].edge);
    na = &g_array_index (self->counts, guint, edge_number (self, pair[0].panel,
            pair[0].edge));
    nb = &g_array_index (self->counts, guint, edge_number (self, pair[1].panel,
            pair[1].edge));
    if (fabs (a->length_m - b->length_m)
        > CLOTH_SEAM_EASE * fmax (a->length_m, b->length_m))
      return cloth_file_invalid (error,
          "the two sides of seam “%s” don't match: edge "
          "“%s” of panel “%s” is %.1f mm long and has %u vertices, edge “%s” "
          "of panel “%s” %.1f mm and %u vertices; they may differ by %g%%",
          name, a->name, get_panel (self, pair[0].panel)->name,
          1000 * a->length_m, *na + 1, b->name, get_panel (self,
              pair[1].panel)->name, 1000 * b->length_m, *nb + 1,
          100 * CLOTH_SEAM_EASE);
    *na = *nb = MAX (*na, *nb);
  }
  return TRUE;
}

/* The vertices of an edge in the direction of the outline, or against it. */
static guint *
edge_vertices (const Builder * self, EdgeRef ref, gboolean backwards, guint * n)
{
  guint number = edge_number (self, ref.panel, ref.edge);
  const ClothPanel *panel = &g_array_index (self->garment->panels, ClothPanel,
      ref.panel);
  guint first = g_array_index (self->firsts, guint, number), *vertices;

  *n = g_array_index (self->counts, guint, number) + 1;
  vertices = g_new (guint, *n);
  for (guint k = 0; k < *n; k++)
    vertices[backwards ? *n - 1 - k : k] = panel->first
        + (first - panel->first + k) % panel->n_border;
  return vertices;
}

/* The two edges of a seam run against each other along their outlines, as both panels have
 * the print up. */
static void
sew (Builder * self, const GArray * seam_edges)
{
  for (guint s = 0; s < self->garment->seam_names->len; s++) {
    ClothSeamLine line;

    for (guint side = 0; side < 2; side++)
      line.lines[side] = edge_vertices (self, g_array_index (seam_edges,
              EdgeRef, 2 * s + side), side == 1, &line.n_vertices);
    g_array_append_val (self->garment->seams, line);
  }
}

/* ---- outlines ---- */

static const gdouble *
place (const Builder * self, guint vertex)
{
  return &g_array_index (self->uv, gdouble, 2 * vertex);
}

static void
add_vertex (Builder * self, gdouble u, gdouble v, gint dot)
{
  gdouble uv[2] = { u, v };

  g_array_append_vals (self->uv, uv, 2);
  g_array_append_val (self->dots, dot);
}

/* The vertices of an edge but its last one, evenly along it. */
static void
cut_edge (Builder * self, const ClothDrawnEdge * edge, guint pieces)
{
  const gdouble *p = (gdouble *) (gpointer) edge->points->data;
  gdouble before = 0, step = edge->length_m / pieces;
  guint k = 0;

  for (guint i = 0; i + 3 < edge->points->len && k < pieces; i += 2) {
    gdouble length = hypot (p[i + 2] - p[i], p[i + 3] - p[i + 1]);

    for (; k < pieces && k * step <= before + length; k++) {
      gdouble t = length > 0 ? (k * step - before) / length : 0;

      add_vertex (self, p[i] + t * (p[i + 2] - p[i]),
          p[i + 1] + t * (p[i + 3] - p[i + 1]), CLOTH_NO_DOT);
    }
    before += length;
  }
  for (; k < pieces; k++)
    add_vertex (self, p[edge->points->len - 2], p[edge->points->len - 1],
        CLOTH_NO_DOT);
}

static gdouble
cross (const gdouble * a, const gdouble * b, const gdouble * c)
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Whether two pieces of outline cross or touch. */
static gboolean
meet (const gdouble * a, const gdouble * b, const gdouble * c,
    const gdouble * d)
{
  gdouble s[4];

  if (fmax (a[0], b[0]) < fmin (c[0], d[0])
      || fmax (c[0], d[0]) < fmin (a[0], b[0])
      || fmax (a[1], b[1]) < fmin (c[1], d[1])
      || fmax (c[1], d[1]) < fmin (a[1], b[1]))
    return FALSE;
  s[0] = cross (a, b, c);
  s[1] = cross (a, b, d);
  s[2] = cross (c, d, a);
  s[3] = cross (c, d, b);
  return s[0] * s[1] <= 0 && s[2] * s[3] <= 0;
}

static gboolean
is_inside (const Builder * self, const ClothPanel * panel, const gdouble * p)
{
  gboolean inside = FALSE;

  for (guint i = 0, j = panel->n_border - 1; i < panel->n_border; j = i++) {
    const gdouble *a = place (self, panel->first + i);
    const gdouble *b = place (self, panel->first + j);

    if ((a[1] > p[1]) != (b[1] > p[1])
        && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0])
      inside = !inside;
  }
  return inside;
}

static gdouble
border_distance (const Builder * self, const ClothPanel * panel,
    const gdouble * p)
{
  gdouble least = INFINITY;

  for (guint i = 0; i < panel->n_border; i++) {
    const gdouble *a = place (self, panel->first + i);
    const gdouble *b = place (self, panel->first + (i + 1) % panel->n_border);
    gdouble d[2] = { b[0] - a[0], b[1] - a[1] };
    gdouble square = d[0] * d[0] + d[1] * d[1];
    gdouble t = square > 0 ? ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1])
        / square : 0;

    t = CLAMP (t, 0, 1);
    least = fmin (least, hypot (p[0] - a[0] - t * d[0],
            p[1] - a[1] - t * d[1]));
  }
  return least;
}

static gboolean
check_outline (const Builder * self, const ClothPanel * panel, GError ** error)
{
  const ClothDotGrid *grid = self->grid;
  guint n = panel->n_border;

  for (guint i = 0; i < n; i++) {
    const gdouble *a = place (self, panel->first + i);
    const gdouble *b = place (self, panel->first + (i + 1) % n);

    if (!(a[0] >= -CLOTH_TOLERANCE && a[1] >= -CLOTH_TOLERANCE
            && a[0] <= grid->cloth_m[0] + CLOTH_TOLERANCE
            && a[1] <= grid->cloth_m[1] + CLOTH_TOLERANCE))
      return cloth_file_invalid (error,
          "panel “%s” leaves the printed cloth of %.0f × "
          "%.0f mm at (%.1f, %.1f) mm", panel->name, 1000 * grid->cloth_m[0],
          1000 * grid->cloth_m[1], 1000 * a[0], 1000 * a[1]);
    for (guint j = i + 2; j < n; j++)
      if (!(i == 0 && j == n - 1)
          && meet (a, b, place (self, panel->first + j),
              place (self, panel->first + (j + 1) % n)))
        return cloth_file_invalid (error,
            "the outline of panel “%s” crosses or touches "
            "itself near (%.1f, %.1f) mm", panel->name, 1000 * a[0],
            1000 * a[1]);
  }
  return TRUE;
}

static gboolean
check_overlap (const Builder * self, GError ** error)
{
  const GArray *panels = self->garment->panels;

  for (guint p = 0; p < panels->len; p++)
    for (guint q = 0; q < p; q++) {
      const ClothPanel *a = &g_array_index (panels, ClothPanel, p);
      const ClothPanel *b = &g_array_index (panels, ClothPanel, q);
      const gdouble *at = place (self, a->first);
      gboolean overlap = is_inside (self, b, at)
          || is_inside (self, a, place (self, b->first));

      for (guint i = 0; i < a->n_border && !overlap; i++)
        for (guint j = 0; j < b->n_border && !overlap; j++) {
          at = place (self, a->first + i);
          overlap = meet (at, place (self, a->first + (i + 1) % a->n_border),
              place (self, b->first + j),
              place (self, b->first + (j + 1) % b->n_border));
        }
      if (overlap)
        return cloth_file_invalid (error,
            "panels “%s” and “%s” overlap near (%.1f, "
            "%.1f) mm; each dot can be in one panel only", b->name, a->name,
            1000 * at[0], 1000 * at[1]);
    }
  return TRUE;
}

/* ---- faces ---- */

static void
add_dots (Builder * self, ClothPanel * panel)
{
  const ClothDotGrid *grid = self->grid;
  gdouble low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  gint from[2], to[2];
  const guint counts[2] = { grid->columns, grid->rows };

  for (guint i = 0; i < panel->n_border; i++)
    for (guint c = 0; c < 2; c++) {
      low[c] = fmin (low[c], place (self, panel->first + i)[c]);
      high[c] = fmax (high[c], place (self, panel->first + i)[c]);
    }
  for (guint c = 0; c < 2; c++) {
    from[c] = (gint) MAX (ceil ((low[c] - grid->origin_m[c])
            / grid->pitch_m), 0);
    to[c] = (gint) MIN (floor ((high[c] - grid->origin_m[c]) / grid->pitch_m),
        counts[c] - 1.);
  }
  for (gint row = from[1]; row <= to[1]; row++)
    for (gint column = from[0]; column <= to[0]; column++) {
      gdouble p[2] = { grid->origin_m[0] + column * grid->pitch_m,
        grid->origin_m[1] + row * grid->pitch_m
      };

      if (is_inside (self, panel, p)
          && border_distance (self, panel, p) >= CLEARANCE * grid->pitch_m)
        add_vertex (self, p[0], p[1], row * (gint) grid->columns + column);
    }
}

/* The cell of four dots of which the triangle @t is one half; −1 when it is of none. */
static gint
find_cell (const Builder * self, const ClothPanel * panel, const guint * t)
{
  gint columns = (gint) self->grid->columns, low[2] = { G_MAXINT, G_MAXINT };
  gint high[2] = { -1, -1 };

  for (guint i = 0; i < 3; i++) {
    gint dot = g_array_index (self->dots, gint, panel->first + t[i]);
    gint at[2] = { dot % columns, dot / columns };

    if (dot == CLOTH_NO_DOT)
      return -1;
    for (guint c = 0; c < 2; c++) {
      low[c] = MIN (low[c], at[c]);
      high[c] = MAX (high[c], at[c]);
    }
  }
  return high[0] == low[0] + 1 && high[1] == low[1] + 1 ? low[1] * columns
      + low[0] : -1;
}

static gint
compare_numbers (gconstpointer a, gconstpointer b)
{
  guint64 x = *(const guint64 *) a, y = *(const guint64 *) b;

  return x < y ? -1 : x > y;
}

/* Keeps what lies within the outline, joins halves of cells, checks the border's sides. */
static gboolean
add_faces (Builder * self, const ClothPanel * panel, GError ** error)
{
  gdouble pitch = self->grid->pitch_m;
  g_autoptr (ClothDelaunay) delaunay = cloth_delaunay_new ();
  guint n_found;
  guint *found = cloth_delaunay_run (delaunay, panel->n_vertices,
      place (self, panel->first), pitch, &n_found);
  g_autoptr (GHashTable) halves = g_hash_table_new (NULL, NULL);
  g_autoptr (GHashTable) vertex_of = g_hash_table_new (NULL, NULL);
  g_autoptr (GArray) sides = g_array_new (FALSE, FALSE, sizeof (guint64));
  gint columns = (gint) self->grid->columns;
  guint kept = 0;

  for (guint i = panel->n_border; i < panel->n_vertices; i++)
    g_hash_table_insert (vertex_of, GINT_TO_POINTER (g_array_index (self->dots,
                gint, panel->first + i)), GUINT_TO_POINTER (panel->first + i));
  for (guint k = 0; k < n_found; k++) {
    const guint *t = found + 3 * k;
    const gdouble *p[3];
    gdouble middle[2];
    gint cell;

    for (guint i = 0; i < 3; i++)
      p[i] = place (self, panel->first + t[i]);
    for (guint c = 0; c < 2; c++)
      middle[c] = (p[0][c] + p[1][c] + p[2][c]) / 3;
    if (fabs (cross (p[0], p[1], p[2])) < SLIVER * pitch * pitch
        || !is_inside (self, panel, middle))
      continue;
    t = memmove (found + kept, t, 3 * sizeof *t);
    kept += 3;
    for (guint i = 0; i < 3; i++) {
      guint64 a = t[i], b = t[(i + 1) % 3];
      guint64 side = MIN (a, b) << 32 | MAX (a, b);

      g_array_append_val (sides, side);
    }
    cell = find_cell (self, panel, t);
    if (cell >= 0)
      g_hash_table_insert (halves, GINT_TO_POINTER (cell + 1),
          GINT_TO_POINTER (GPOINTER_TO_INT (g_hash_table_lookup (halves,
                      GINT_TO_POINTER (cell + 1))) + 1));
  }
  g_array_sort (sides, compare_numbers);
  for (guint i = 0; i < panel->n_border; i++) {
    guint64 j = (i + 1) % panel->n_border;
    guint64 side = MIN (i, j) << 32 | MAX (i, j);

    if (!g_array_binary_search (sides, &side, compare_numbers, NULL))
      return cloth_file_invalid (error,
          "panel “%s” is too narrow or too sharp near "
          "(%.1f, %.1f) mm for dots %.1f mm apart", panel->name,
          1000 * place (self, panel->first + i)[0], 1000 * place (self,
              panel->first + i)[1], 1000 * pitch);
  }
  for (guint k = 0; k < kept; k += 3) {
    const guint *t = found + k;
    gint cell = find_cell (self, panel, t);
    gint n = cell < 0 ? 0 : GPOINTER_TO_INT (g_hash_table_lookup (halves,
            GINT_TO_POINTER (cell + 1)));
    /* counter-clockwise to the eye, as a grid's faces are */
    guint32 face[4] = { panel->first + t[0], panel->first + t[2],
      panel->first + t[1], CLOTH_NO_VERTEX
    };

    if (n == 2) {
      const gint corners[4] = { cell, cell + columns, cell + columns + 1,
        cell + 1
      };

      for (guint i = 0; i < 4; i++)
        face[i] = GPOINTER_TO_UINT (g_hash_table_lookup (vertex_of,
                GINT_TO_POINTER (corners[i])));
      /* its other half adds nothing */
      g_hash_table_insert (halves, GINT_TO_POINTER (cell + 1),
          GINT_TO_POINTER (3));
    } else if (n == 3) {
      continue;
    }
    g_array_append_vals (self->faces, face, 4);
  }
  return TRUE;
}

static gboolean
add_panel (Builder * self, guint p, GError ** error)
{
  const ClothDrawnPanel *drawn = get_panel (self, p);
  ClothPanel panel = { g_strdup (drawn->name), self->dots->len, 0, 0 };

  for (guint e = 0; e < drawn->edges->len; e++) {
    g_array_append_val (self->firsts, self->dots->len);
    cut_edge (self, get_edge (self, p, e), g_array_index (self->counts, guint,
            edge_number (self, p, e)));
  }
  panel.n_border = self->dots->len - panel.first;
  g_array_append_val (self->garment->panels, panel);
  if (panel.n_border < 3)
    return cloth_file_invalid (error,
        "panel “%s” is smaller than a dot's cell", panel.name);
  if (self->dots->len > MOST_VERTICES)
    return cloth_file_invalid (error, "the outlines have more than %d vertices",
        MOST_VERTICES);
  if (!check_outline (self, &panel, error))
    return FALSE;
  add_dots (self, &panel);
  if (self->dots->len > MOST_VERTICES)
    return cloth_file_invalid (error, "the garment has more than %d vertices",
        MOST_VERTICES);
  panel.n_vertices = self->dots->len - panel.first;
  g_array_index (self->garment->panels, ClothPanel, p) = panel;
  if (panel.n_vertices == panel.n_border)
    return cloth_file_invalid (error, "panel “%s” has no dot within",
        panel.name);
  return add_faces (self, &panel, error);
}

static void
finish (Builder * self)
{
  ClothGarment *garment = self->garment;
  guint n = self->dots->len;

  garment->topology = cloth_topology_new (n, self->faces->len / 4);
  for (guint i = 0; i < 2 * n; i++)
    garment->topology->uv[i] = (gfloat) g_array_index (self->uv, gdouble, i);
  if (self->faces->len > 0)
    memcpy (garment->topology->faces, self->faces->data,
        self->faces->len * sizeof (guint32));
  garment->dots = g_memdup2 (self->dots->data, n * sizeof (gint));
}

/* Returns: (transfer full): a garment without mesh and panels, to be filled
 */
ClothGarment *
cloth_garment_new (void)
{
  ClothGarment *garment = g_new0 (ClothGarment, 1);

  garment->panels = g_array_new (FALSE, TRUE, sizeof (ClothPanel));
  g_array_set_clear_func (garment->panels, panel_clear);
  garment->seam_names = g_ptr_array_new_with_free_func (g_free);
  garment->seams = cloth_seams_new ();
  return garment;
}

/* @svg: a drawing of the panels; see cloth_panels_parse ()
 * @size: its bytes
 * @grid: the dots of the print that the panels are cut from
 * @error: #ClothFileError or #GMarkupError
 *
 * Returns: (transfer full): the garment's mesh; %NULL with an error that names panel and
 *   place when an outline is open, crosses itself, leaves the cloth, lies over another
 *   panel or is too narrow, or when the edges of a seam don't match
 */
ClothGarment *
cloth_garment_new_from_svg (const gchar * svg, gsize size,
    const ClothDotGrid * grid, GError ** error)
{
  g_autoptr (ClothGarment) garment = cloth_garment_new ();
  g_autoptr (GArray) seam_edges = g_array_new (FALSE, FALSE, sizeof (EdgeRef));
  Builder builder = { grid, cloth_panels_parse (svg, size, error), };
  gboolean good = builder.drawn != NULL;

  garment->columns = grid->columns;
  garment->rows = grid->rows;
  if (!good)
    return NULL;
  builder.garment = garment;
  builder.counts = g_array_new (FALSE, FALSE, sizeof (guint));
  builder.firsts = g_array_new (FALSE, FALSE, sizeof (guint));
  builder.uv = g_array_new (FALSE, FALSE, sizeof (gdouble));
  builder.dots = g_array_new (FALSE, FALSE, sizeof (gint));
  builder.faces = g_array_new (FALSE, FALSE, sizeof (guint32));
  good = count_pieces (&builder, seam_edges, error);
  for (guint p = 0; p < builder.drawn->len && good; p++)
    good = add_panel (&builder, p, error);
  good = good && check_overlap (&builder, error);
  if (good) {
    sew (&builder, seam_edges);
    finish (&builder);
  }
  g_array_unref (builder.drawn);
  g_array_unref (builder.counts);
  g_array_unref (builder.firsts);
  g_array_unref (builder.uv);
  g_array_unref (builder.dots);
  g_array_unref (builder.faces);
  return good ? g_steal_pointer (&garment) : NULL;
}

/* @garment: (transfer full) (nullable): a garment
 */
void
cloth_garment_free (ClothGarment * garment)
{
  if (!garment)
    return;
  cloth_topology_free (garment->topology);
  g_free (garment->dots);
  if (garment->panels)
    g_array_unref (garment->panels);
  if (garment->seam_names)
    g_ptr_array_unref (garment->seam_names);
  if (garment->seams)
    g_array_unref (garment->seams);
  g_free (garment);
}
