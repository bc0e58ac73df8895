/* What a take holds, in a few lines for people.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/summary.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"

/* Beyond these, in the median over the frames, a note says so: cloth doesn't shrink, and folds make
 * chords of edges by less. */
#define ODD_STRETCH 1.05
#define ODD_SHRINKAGE 0.95

static const ClothSides SIDES[2] = { CLOTH_SIDES_U, CLOTH_SIDES_V };

/* What one pass over the frames tells.
 *
 * @n_measured, @n_estimated: vertices, filled or predicted ones apart
 * @least, @least_frame: the frame in which the fewest were measured
 * @lowest, @highest: of what was seen
 * @stretches: (element-type gdouble): of each frame, along u and along v
 * @clamps: of the last frame
 * @lengths: of each clamp's path
 * @open: frames in which nobody logged its place
 * @distances: (element-type GArray): of each clamp, how far from its vertex it was
 * @beside: of each vertex another one that was in its place in all frames, else CLOTH_NO_VERTEX
 * @below: by how much the vertices that were seen are below what holds them, added up
 */
typedef struct
{
  guint64 n_measured, n_estimated;
  guint least, least_frame;
  gdouble lowest[3], highest[3];
  GArray *stretches[2];
  gfloat *clamps, *before;
  gdouble *lengths;
  guint *open;
  GPtrArray *distances;
  guint32 *beside;
  gdouble below[3];
} Pass;

/* Adds a line to a table: a label, and what @format says. */
void
cloth_summary_add (GString * table, const gchar * label,
    const gchar * format, ...)
{
  va_list arguments;

  g_string_append_printf (table, "%-10s  ", label);
  va_start (arguments, format);
  g_string_append_vprintf (table, format, arguments);
  va_end (arguments);
  g_string_append_c (table, '\n');
}

/* @sides: those along u or along v
 * @grid: of a grid
 *
 * Returns: what they run along, for people
 */
const gchar *
cloth_summary_name_sides (ClothSides sides, gboolean grid)
{
  if (grid)
    return sides == CLOTH_SIDES_U ? "rows" : "columns";
  return sides == CLOTH_SIDES_U ? "u" : "v";
}

/* @topology: a mesh
 * @positions: 3 numbers a vertex, NaN when not seen
 * @sides: which sides of the faces
 * @scratch: (element-type gdouble): reused
 *
 * Returns: how long these sides are over their length on the flat cloth, in the
 *   median; NaN when no side is seen or the mesh has no uv
 */
gdouble
cloth_summary_stretch (const ClothTopology * topology,
    const gfloat * positions, ClothSides sides, GArray * scratch)
{
  g_array_set_size (scratch, 0);
  for (gsize i = 0; i < topology->n_faces; i++) {
    const guint32 *face = topology->faces + 4 * i;
    const guint n = cloth_face_corners (face);

    for (guint k = 0; k < n; k++) {
      const gsize a = face[k], b = face[(k + 1) % n];
      const gfloat *p = positions + 3 * a, *q = positions + 3 * b;
      const gfloat *u = topology->uv + 2 * a, *v = topology->uv + 2 * b;
      const gdouble du = fabs ((gdouble) u[0] - v[0]);
      const gdouble dv = fabs ((gdouble) u[1] - v[1]), flat = hypot (du, dv);
      const gdouble stretch = hypot (hypot ((gdouble) p[0] - q[0],
              (gdouble) p[1] - q[1]), (gdouble) p[2] - q[2]) / flat;

      if (isfinite (stretch) && (sides == CLOTH_SIDES_ALL
              || (sides == CLOTH_SIDES_U) == (du > dv)))
        g_array_append_val (scratch, stretch);
    }
  }
  return scratch->len == 0 ? NAN :
      cloth_median ((gdouble *) (gpointer) scratch->data, scratch->len);
}

/* ---- one pass over the frames ---- */

static void
look_at_vertices (Pass * pass, guint frame, const gfloat * positions,
    const guint8 * states, guint n_vertices)
{
  guint n = 0;

  for (gsize i = 0; i < n_vertices; i++) {
    if (isnan (positions[3 * i]))
      continue;
    if (states[i] == CLOTH_VERTEX_FILLED || states[i] == CLOTH_VERTEX_PREDICTED)
      pass->n_estimated++;
    else
      n++;
    for (guint k = 0; k < 3; k++) {
      pass->lowest[k] = MIN (pass->lowest[k], positions[3 * i + k]);
      pass->highest[k] = MAX (pass->highest[k], positions[3 * i + k]);
    }
  }
  if (frame == 0 || n < pass->least) {
    pass->least = n;
    pass->least_frame = frame;
  }
  pass->n_measured += n;
}

static gdouble
distance (const gfloat * a, const gfloat * b)
{
  return hypot (hypot ((gdouble) a[0] - b[0], (gdouble) a[1] - b[1]),
      (gdouble) a[2] - b[2]);
}

static void
look_at_clamps (Pass * pass, const ClothTakeInfo * info, gdouble time,
    const gfloat * positions)
{
  for (guint i = 0; i < info->held->len; i++) {
    const ClothHeld *held = &g_array_index (info->held, ClothHeld, i);
    const gfloat *vertex = positions + 3 * (gsize) held->vertex;
    const gdouble moved = distance (pass->clamps + 3 * i, pass->before + 3 * i);
    const gdouble away = distance (pass->clamps + 3 * i, vertex);

    if (isfinite (moved))
      pass->lengths[i] += moved;
    pass->open[i] += isnan (pass->clamps[3 * i])
        && cloth_held_holds (held, time);
    if (isfinite (away))
      g_array_append_val ((GArray *) pass->distances->pdata[i], away);
  }
  memcpy (pass->before, pass->clamps,
      3 * (gsize) info->held->len * sizeof *pass->before);
}

/* Adds how far the vertices are from the middle of the clamps that hold, along each axis. */
static void
look_below (Pass * pass, const ClothTakeInfo * info, gdouble time,
    const gfloat * positions, gsize n_vertices)
{
  gdouble middle[3] = { 0 };
  guint n = 0;

  for (guint i = 0; i < info->held->len; i++) {
    const gfloat *clamp = pass->clamps + 3 * i;

    if (isnan (clamp[0])
        || !cloth_held_holds (&g_array_index (info->held, ClothHeld, i), time))
      continue;
    n++;
    for (guint k = 0; k < 3; k++)
      middle[k] += ((gdouble) clamp[k] - middle[k]) / n;
  }
  for (gsize i = 0; n > 0 && i < n_vertices; i++)
    for (guint k = 0; k < 3 && !isnan (positions[3 * i]); k++)
      pass->below[k] += middle[k] - positions[3 * i + k];
}

static gint
compare_places (gconstpointer a, gconstpointer b, gpointer positions)
{
  const gfloat *p = (const gfloat *) positions + 3 * (gsize) * (guint32 *) a;
  const gfloat *q = (const gfloat *) positions + 3 * (gsize) * (guint32 *) b;

  for (guint k = 0; k < 3; k++)
    if (p[k] != q[k])
      return p[k] < q[k] ? -1 : 1;
  return 0;
}

static gboolean
is_same_place (const gfloat * positions, guint32 a, guint32 b)
{
  return compare_places (&a, &b, (gpointer) positions) == 0;
}

/* Vertices that are in one place in the first frame. */
static void
begin_beside (Pass * pass, gfloat * positions, guint32 n)
{
  g_autofree guint32 *order = g_new (guint32, n);
  guint32 n_seen = 0;

  for (guint32 v = 0; v < n; v++) {
    const gfloat *at = positions + 3 * (gsize) v;

    /* many programs write zeros for what they don't see */
    if (!isnan (at[0]) && (at[0] != 0 || at[1] != 0 || at[2] != 0))
      order[n_seen++] = v;
  }
  g_qsort_with_data (order, (gint) n_seen, sizeof *order, compare_places,
      positions);
  for (guint32 i = 1; i < n_seen; i++)
    if (is_same_place (positions, order[i], order[i - 1])) {
      pass->beside[order[i]] = order[i - 1];
      pass->beside[order[i - 1]] = order[i];
    }
}

/* Vertices that are one, though the mesh has them apart. */
static void
look_beside (Pass * pass, guint frame, gfloat * positions, guint32 n)
{
  if (frame == 0) {
    begin_beside (pass, positions, n);
    return;
  }
  for (guint32 v = 0; v < n; v++)
    if (pass->beside[v] != CLOTH_NO_VERTEX
        && !is_same_place (positions, v, pass->beside[v]))
      pass->beside[v] = CLOTH_NO_VERTEX;
}

static void
mark_unseen (gfloat * positions, gsize n_vertices)
{
  for (gsize i = 0; i < 3 * n_vertices; i++)
    positions[i] = NAN;
}

static gboolean
look (ClothTake * take, Pass * pass, GError ** error)
{
  const ClothTopology *topology = cloth_take_get_topology (take);
  const ClothTakeInfo *info = cloth_take_get_info (take);
  const gsize n = topology->n_vertices;
  g_autofree gfloat *positions = g_new (gfloat, 3 * n);
  g_autofree guint8 *states = g_new (guint8, n);
  g_autoptr (GArray) scratch = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint i = 0; i < cloth_take_get_n_frames (take); i++) {
    if (i >= cloth_take_get_n_positions (take))
      mark_unseen (positions, n);
    else if (!cloth_take_read_positions (take, i, positions, error) ||
        !cloth_take_read_states (take, i, positions, states, error))
      return FALSE;
    look_at_vertices (pass, i, positions, states, (guint) n);
    if (i < cloth_take_get_n_positions (take))
      look_beside (pass, i, positions, (guint32) n);
    for (guint k = 0; k < 2; k++) {
      gdouble stretch = cloth_summary_stretch (topology, positions,
          SIDES[k], scratch);

      if (isfinite (stretch))
        g_array_append_val (pass->stretches[k], stretch);
    }
    if (!cloth_take_has_clamps (take))
      continue;
    if (!cloth_take_read_clamps (take, i, pass->clamps, error))
      return FALSE;
    if (i == 0)
      memcpy (pass->before, pass->clamps,
          3 * (gsize) info->held->len * sizeof *pass->before);
    look_at_clamps (pass, info, cloth_take_get_time (take, i), positions);
    look_below (pass, info, cloth_take_get_time (take, i), positions, n);
  }
  return TRUE;
}

/* ---- the lines ---- */

static void
add_rate (GString * table, const ClothTake * take)
{
  const guint n = cloth_take_get_n_frames (take);
  const gdouble first = cloth_take_get_time (take, 0);
  const gdouble last = cloth_take_get_time (take, n - 1);
  g_autofree gdouble *steps = g_new (gdouble, n);
  const gdouble rate = cloth_take_get_rate (take);
  gdouble least = INFINITY, most = 0;

  cloth_summary_add (table, "frames", "%u", n);
  if (n < 2) {
    cloth_summary_add (table, "time", "%.13g s", first);
    return;
  }
  for (guint i = 0; i + 1 < n; i++) {
    steps[i] = cloth_take_get_time (take, i + 1) - cloth_take_get_time (take,
        i);
    least = MIN (least, steps[i]);
    most = MAX (most, steps[i]);
  }
  if (rate > 0)
    cloth_summary_add (table, "rate", "%.4g a second, even", rate);
  else
    cloth_summary_add (table, "rate",
        "%.4g a second in the median; frames are %.3g to %.3g s apart",
        1 / cloth_median (steps, n - 1), least, most);
  cloth_summary_add (table, "duration", "%.6g s, from %.6g to %.6g s",
      last - first, first, last);
}

static void
add_mesh (GString * table, const ClothTake * take)
{
  const ClothTakeInfo *info = cloth_take_get_info (take);
  const ClothTopology *topology = cloth_take_get_topology (take);

  if (info->mesh)
    cloth_summary_add (table, "vertices", "%u, a mesh of %u faces (%s)",
        topology->n_vertices, topology->n_faces, info->mesh);
  else
    cloth_summary_add (table, "vertices",
        "%u, a grid of %u columns and %u rows, %.4g m wide and %.4g m high",
        topology->n_vertices, info->columns, info->rows, info->width_m,
        info->height_m);
}

static void
add_seen (GString * table, const ClothTake * take, const Pass * pass)
{
  const guint n_vertices = cloth_take_get_topology (take)->n_vertices;
  const gdouble n = (gdouble) n_vertices * cloth_take_get_n_frames (take);

  if (pass->lowest[0] <= pass->highest[0])
    cloth_summary_add (table, "extent",
        "x %.3f to %.3f m, y %.3f to %.3f m, z %.3f to %.3f m",
        pass->lowest[0], pass->highest[0], pass->lowest[1], pass->highest[1],
        pass->lowest[2], pass->highest[2]);
  if (cloth_take_get_n_positions (take) < cloth_take_get_n_frames (take)) {
    cloth_summary_add (table, "seen", "%s", cloth_take_get_n_positions (take) ?
        "places of the first frame only" : "no places, only what cameras saw");
    return;
  }
  cloth_summary_add (table, "seen", "%.1f %%, the least %.1f %% in frame %u",
      100 * (gdouble) pass->n_measured / n, 100. * pass->least / n_vertices,
      pass->least_frame);
  if (pass->n_estimated > 0)
    cloth_summary_add (table, "filled", "%.1f %%, estimated and not seen",
        100 * (gdouble) pass->n_estimated / n);
  for (guint k = 0; k < 2; k++) {
    gboolean grid = !cloth_take_get_info (take)->mesh;
    GArray *stretches = pass->stretches[k];

    if (stretches->len > 0)
      cloth_summary_add (table, k == 0 ? "stretch" : "",
          "along %s neighbours are %.3f times as far apart as on the flat cloth, "
          "in the median", cloth_summary_name_sides (SIDES[k], grid),
          cloth_median ((gdouble *) (gpointer) stretches->data,
              stretches->len));
  }
  if (pass->stretches[0]->len + pass->stretches[1]->len == 0)
    cloth_summary_add (table, "stretch",
        "not known: no neighbours were seen together");
}

/* The noise of a coordinate that makes neighbours look @stretch times as far apart as they are, m:
 * each of the two ends adds σ² in three directions to the square of their distance. */
static gdouble
find_noise (const ClothTopology * topology, ClothSides sides, gdouble stretch)
{
  g_autoptr (GArray) edges = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (gsize i = 0; i < topology->n_faces; i++) {
    const guint32 *face = topology->faces + 4 * i;
    const guint n = cloth_face_corners (face);

    for (guint k = 0; k < n; k++) {
      const gfloat *u = topology->uv + 2 * (gsize) face[k];
      const gfloat *v = topology->uv + 2 * (gsize) face[(k + 1) % n];
      const gdouble du = fabs ((gdouble) u[0] - v[0]);
      const gdouble dv = fabs ((gdouble) u[1] - v[1]), edge = hypot (du, dv);

      if ((sides == CLOTH_SIDES_U) == (du > dv))
        g_array_append_val (edges, edge);
    }
  }
  return cloth_median ((gdouble *) (gpointer) edges->data, edges->len) *
      sqrt ((stretch * stretch - 1.) / 6.);
}

/* A mesh of a file: vertices without a face, and those that are nothing but a copy of another. */
static void
add_mesh_notes (GString * table, const ClothTake * take, const Pass * pass)
{
  const ClothTopology *topology = cloth_take_get_topology (take);
  const GArray *seams = cloth_take_get_info (take)->seams;
  g_autofree gboolean *has_face = g_new0 (gboolean, topology->n_vertices);
  g_autofree gboolean *sewn = g_new0 (gboolean, topology->n_vertices);
  guint n_loose = 0, n_open = 0, loose = 0, open = 0;

  for (gsize i = 0; i < 4 * (gsize) topology->n_faces; i++)
    if (topology->faces[i] != CLOTH_NO_VERTEX)
      has_face[topology->faces[i]] = TRUE;
  for (guint s = 0; s < seams->len; s++) {
    const ClothSeamLine *line = &g_array_index (seams, ClothSeamLine, s);

    for (guint i = 0; i < line->n_vertices; i++)
      sewn[line->lines[0][i]] = sewn[line->lines[1][i]] = TRUE;
  }
  for (guint v = topology->n_vertices; v-- > 0;) {
    const guint other = pass->beside[v];

    if (!has_face[v]) {
      n_loose++;
      loose = v;
    } else if (other != CLOTH_NO_VERTEX && has_face[other] && !sewn[v]
        && !sewn[other]) {
      n_open++;
      open = v;
    }
  }
  if (n_loose > 0)
    cloth_summary_add (table, "note",
        "%u vertices belong to no face, the first "
        "is %u: no simulation takes the mesh; leave them out", n_loose, loose);
  if (n_open > 0)
    cloth_summary_add (table, "note", "%u vertices lie where others do, and "
        "nothing sews them, the first are %u and %u: a simulation comes apart "
        "there; merge them where the mesh was made, or write “seams” into "
        "take.json", n_open, open, pass->beside[open]);
}

/* What is wrong, more likely than not. */
static void
add_notes (GString * table, const ClothTake * take, const Pass * pass)
{
  const gboolean grid = !cloth_take_get_info (take)->mesh;

  for (guint k = 0; k < 2; k++) {
    GArray *stretches = pass->stretches[k];
    const gdouble stretch = cloth_median ((gdouble *) (gpointer)
        stretches->data, stretches->len);
    g_autofree gchar *noise = NULL;

    /* NaN is neither */
    if (!(stretch > ODD_STRETCH || stretch < ODD_SHRINKAGE))
      continue;
    noise = stretch > 1 ?
        g_strdup_printf ("; noise of about %.2g mm would do the same",
        1000 * find_noise (cloth_take_get_topology (take), SIDES[k],
            stretch)) : g_strdup ("");
    cloth_summary_add (table, "note", "along %s neighbours are %.2f times "
        "as far apart as on the flat cloth: see that %s, the unit of the "
        "places (of filmed cloth that of the rig) and the order of the vertices "
        "are right%s", cloth_summary_name_sides (SIDES[k], grid), stretch,
        !grid ? "the uv of the mesh" : k == 0 ? "its width" : "its height",
        noise);
  }
  if (pass->below[2] < MAX (fabs (pass->below[0]), MAX (fabs (pass->below[1]),
              fabs (pass->below[2]))) / 2)
    cloth_summary_add (table, "note", "the cloth does not hang below its "
        "clamps: see that z is up (--axes of an import)");
  if (!grid)
    add_mesh_notes (table, take, pass);
}

static void
add_clamps (GString * table, const ClothTake * take, const Pass * pass)
{
  const GArray *held = cloth_take_get_info (take)->held;

  if (held->len == 0)
    cloth_summary_add (table, "clamps", "none");
  for (guint i = 0; i < held->len; i++) {
    const ClothHeld *item = &g_array_index (held, ClothHeld, i);
    const GArray *away = pass->distances->pdata[i];
    g_autoptr (GString) text = g_string_new (NULL);

    g_string_append_printf (text, "vertex %u", item->vertex);
    if (isfinite (item->from_s))
      g_string_append_printf (text, ", held from %.13g s", item->from_s);
    if (isfinite (item->until_s))
      g_string_append_printf (text, ", let go at %.13g s", item->until_s);
    if (pass->open[i])
      g_string_append_printf (text, ", not logged in %u of %u frames",
          pass->open[i], cloth_take_get_n_frames (take));
    else if (cloth_take_has_clamps (take))
      g_string_append_printf (text, ", path %.3f m long", pass->lengths[i]);
    if (away->len > 0)
      g_string_append_printf (text, ", %.1f mm from its vertex in the median",
          1000 * cloth_median ((gdouble *) (gpointer) away->data, away->len));
    cloth_summary_add (table, i == 0 ? "clamps" : "", "%s", text->str);
  }
}

static void
free_distances (gpointer data)
{
  g_array_unref (data);
}

/* @take: a take
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads every frame once.
 *
 * Returns: (transfer full): a table of frames, rate, vertices, extent, what was seen and what
 *   clamps hold, and of what is likely wrong, or %NULL
 */
gchar *
cloth_take_summarise (ClothTake * take, GError ** error)
{
  const gsize n_held = cloth_take_get_info (take)->held->len;
  g_autoptr (GString) table = g_string_new (NULL);
  g_autoptr (GArray) along_u = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autoptr (GArray) along_v = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autoptr (GPtrArray) distances =
      g_ptr_array_new_with_free_func (free_distances);
  g_autofree gfloat *clamps = g_new0 (gfloat, 6 * n_held);
  g_autofree gdouble *lengths = g_new0 (gdouble, n_held);
  g_autofree guint *open = g_new0 (guint, n_held);
  const guint n = cloth_take_get_topology (take)->n_vertices;
  g_autofree guint32 *beside = g_new (guint32, n);
  Pass pass = {
    .lowest = {INFINITY, INFINITY, INFINITY},
    .highest = {-INFINITY, -INFINITY, -INFINITY},
    .stretches = {along_u, along_v},.distances = distances,.lengths =
        lengths,.open = open,
    .clamps = clamps,.before = clamps + 3 * n_held,.beside = beside
  };

  for (guint v = 0; v < n; v++)
    beside[v] = CLOTH_NO_VERTEX;
  for (gsize i = 0; i < n_held; i++)
    g_ptr_array_add (distances, g_array_new (FALSE, FALSE, sizeof (gdouble)));
  if (!look (take, &pass, error))
    return NULL;
  cloth_summary_add (table, "take", "%s", cloth_take_get_folder (take));
  add_rate (table, take);
  add_mesh (table, take);
  add_seen (table, take, &pass);
  add_clamps (table, take, &pass);
  add_notes (table, take, &pass);
  return g_string_free (g_steal_pointer (&table), FALSE);
}
