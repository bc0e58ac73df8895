/* Recordings of other programs become takes: axes, units, times, the mesh and the clamps.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/import.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"
#include "gst/mesh/seam.h"
#include "gst/take/import-source.h"
#include "gst/take/sequence.h"
#include "gst/take/summary.h"

/* Frames further apart are no motion, nearer ones no camera's: the unit of time is wrong. */
#define LONGEST_STEP_S 5.0
#define SHORTEST_STEP_S 5e-5
/* Neighbours further apart than on the flat cloth, in the median: not this cloth. */
#define MOST_STRETCH 2.0
#define LEAST_STRETCH 0.2
/* Within these a unit, or columns and rows, would be right. */
#define FAIR_STRETCH 1.1
#define FAIR_SHRINKAGE 0.8
/* Frames that are looked at for it. */
#define LOOKS 32u
/* Where a clamp's place isn't known for no longer, it went straight on. */
#define LONGEST_GAP_S 0.2
/* A clamp is this near to what it holds, or two sides of the grid. */
#define CLAMP_REACH_M 0.05
/* Share of places at 0, 0, 0 that is spoken of. */
#define ODD_ZEROS 0.001
/* Pairs of vertices in the seams of a mesh, which take.json has room for. */
#define MOST_SEWN 50000u

/* @split: (nullable): the mesh in parts, where vertices have several uv
 * @vertices: of each vertex its marker, −1 when none shows it
 * @names: of what the markers are told by, for people
 * @map, @sign: which of the source's axes becomes x, y and z
 * @times: of each frame, from 0 on
 * @start: what was taken off, in the source's seconds; NaN when it has no times
 * @positions: 3 numbers a vertex, frame by frame, metres, z up
 * @paths: of each clamp, 3 numbers a frame
 */
typedef struct
{
  const ClothImport *import;
  ClothImportSource source;
  ClothMarkers *log;            /* of the clamps' own file */
  ClothTopology *topology;
  ClothSplit *split;
  gint *vertices;
  guint map[3];
  gdouble sign[3];
  gdouble unit_m;
  gdouble *times;
  gdouble start;
  gfloat *positions;
  GArray *held;                 /* of guint */
  GPtrArray *paths;             /* of gfloat[] */
  GString *told, *notes;
} Import;

static void
free_import (Import * self)
{
  cloth_import_source_clear (&self->source);
  cloth_markers_free (self->log);
  cloth_topology_free (self->topology);
  cloth_split_free (self->split);
  g_free (self->vertices);
  g_free (self->times);
  g_free (self->positions);
  g_array_unref (self->held);
  g_ptr_array_unref (self->paths);
  g_string_free (self->told, TRUE);
  g_string_free (self->notes, TRUE);
}


/* ---- axes and units ---- */
static gboolean
parse_axes (Import * self, GError ** error)
{
  static const struct
  {
    const gchar *name, *axes;
  } named[] = { {"z-up", "x,y,z"}, {"y-up", "x,-z,y"}, {"x-up", "y,z,x"} };
  const gchar *text = self->import->axes ? self->import->axes : "z-up";
  g_auto (GStrv) words = NULL;
  guint seen = 0, swaps = 0;

  for (guint i = 0; i < G_N_ELEMENTS (named); i++)
    if (g_str_equal (text, named[i].name))
      text = named[i].axes;
  words = g_strsplit (text, ",", 4);
  for (guint k = 0; g_strv_length (words) == 3 && k < 3; k++) {
    const gchar *word = g_strstrip (words[k]);

    self->sign[k] = *word == '-' ? -1 : 1;
    word += *word == '-' || *word == '+';
    if (!*word || word[1] || !strchr ("xyz", *word))
      break;
    self->map[k] = (guint) (*word - 'x');
    seen |= 1u << self->map[k];
  }
  if (seen != 7)
    return cloth_file_invalid (error,
        "axes “%s”: give z-up, y-up, x-up, or "
        "which of the source's axes become x, y and z, such as x,-z,y",
        self->import->axes);
  for (guint k = 0; k < 3; k++)
    swaps += (self->map[k] > self->map[(k + 1) % 3]) + (self->sign[k] < 0);
  if (self->import->axes)
    cloth_summary_add (self->told, "axes", "x, y, z are the source's %s%s",
        text,
        swaps % 2 == 0 ? ", mirrored: the source is taken as left-handed" : "");
  return TRUE;
}

static const struct
{
  const gchar *name;
  gdouble unit_m;
} units[] = { {"mm", 0.001}, {"cm", 0.01}, {"in", 0.0254}, {"m", 1} };

static void
choose_unit (Import * self)
{
  const gdouble said = self->source.markers->unit_m;

  self->unit_m = self->import->unit_m > 0 ? self->import->unit_m :
      said > 0 ? said : 1;
  for (guint i = 0; i < G_N_ELEMENTS (units); i++)
    if (self->unit_m == units[i].unit_m)
      cloth_summary_add (self->told, "unit", "%s, %s; metres in the take",
          units[i].name, self->import->unit_m > 0 ? "as given" : said > 0 ?
          "as the file says" : "as nothing else is said");
}

static void
convert (const Import * self, const gfloat * from, gdouble unit_m, gfloat * to)
{
  for (guint k = 0; k < 3; k++)
    to[k] = NAN;
  if (isnan (from[0]) || isnan (from[1]) || isnan (from[2]) ||
      (self->import->zero_is_missing && from[0] == 0 && from[1] == 0
          && from[2] == 0))
    return;
  for (guint k = 0; k < 3; k++)
    to[k] = (gfloat) (self->sign[k] * unit_m * from[self->map[k]]);
}

/* ---- times ---- */

static gboolean
check_steps (const Import * self, GError ** error)
{
  const guint n = self->source.markers->n_frames;
  g_autofree gdouble *steps = NULL;
  gdouble median;

  if (n < 2)
    return TRUE;
  steps = g_new (gdouble, n - 1);
  for (guint i = 0; i + 1 < n; i++)
    steps[i] = self->times[i + 1] - self->times[i];
  median = cloth_median (steps, n - 1);
  if (median >= SHORTEST_STEP_S && median <= LONGEST_STEP_S)
    return TRUE;
  return cloth_file_invalid (error,
      "frames are %g s apart; if the times are in "
      "another unit, call their column time_ms, time_us or time_ns, or give "
      "--rate, frames a second", median);
}

static gboolean
find_times (Import * self, GError ** error)
{
  const ClothMarkers *markers = self->source.markers;
  const gdouble *numbers = markers->numbers;
  const gdouble fps = self->import->fps > 0 ? self->import->fps :
      markers->times ? 0 : markers->fps;
  gboolean counted = numbers != NULL;

  self->start = markers->times ? markers->times[0] : NAN;
  for (guint i = 0; counted && i < markers->n_frames; i++)
    counted = numbers[i] == floor (numbers[i]);
  self->times = g_new (gdouble, markers->n_frames);
  for (guint i = 0; i < markers->n_frames; i++)
    self->times[i] = fps > 0 ?
        (counted ? numbers[i] - numbers[0] : i) / fps :
        markers->times ? markers->times[i] - self->start : NAN;
  if (isnan (self->times[0])) {
    if (markers->n_frames > 1)
      return cloth_file_invalid (error, "%s says nothing of time: give --rate, "
          "frames a second", self->import->source);
    self->times[0] = 0;
  }
  if (self->import->fps > 0 && markers->times)
    cloth_summary_add (self->told, "times",
        "%g frames a second, as given; the file's own times are not used", fps);
  else if (fps > 0)
    cloth_summary_add (self->told, "times", "%g frames a second%s%s", fps,
        self->import->fps > 0 ? ", as given" : ", as the file says",
        counted ? ", by the frames' numbers" : "");
  else if (markers->times && self->start != 0)
    cloth_summary_add (self->told, "times",
        "begin at 0; %.10g s are taken off", self->start);
  return check_steps (self, error);
}

/* ---- the mesh ---- */

static gboolean
load_mesh (Import * self, GError ** error)
{
  g_autoptr (ClothObj) obj = cloth_obj_read (self->import->mesh, error);

  if (!obj)
    return FALSE;
  if (!obj->has_uv || obj->topology->n_faces == 0)
    return cloth_file_invalid (error,
        "%s has no faces with uv (vt): where each vertex lies "
        "on the flat cloth, in metres", self->import->mesh);
  if (obj->corner_uv && !(self->split = cloth_split_new (obj->topology,
              obj->corner_uv, error)))
    return FALSE;
  self->topology = g_steal_pointer (&obj->topology);
  return TRUE;
}

static gboolean
find_mesh (Import * self, GError ** error)
{
  const ClothImport *import = self->import;

  if (import->columns > 0 || import->rows > 0) {
    if (import->mesh)
      return cloth_file_invalid (error,
          "give either --columns and --rows or --mesh");
    if (import->columns < 2 || import->rows < 2 || !(import->width_m > 0)
        || !(import->height_m > 0))
      return cloth_file_invalid (error,
          "a grid needs --columns and --rows, 2 or "
          "more vertices each, and its size on the flat cloth, --width and "
          "--height");
    if ((guint64) import->columns * import->rows > CLOTH_MAX_VERTICES)
      return cloth_file_invalid (error,
          "a grid of %u × %u vertices; %u are accepted", import->columns,
          import->rows, CLOTH_MAX_VERTICES);
    self->topology = cloth_topology_new_grid (import->columns, import->rows,
        (gfloat) import->width_m, (gfloat) import->height_m);
    return TRUE;
  }
  if (import->mesh)
    return load_mesh (self, error);
  if (self->source.topology && self->source.has_uv
      && self->source.topology->n_faces > 0) {
    self->topology = cloth_topology_copy (self->source.topology);
    self->split = g_steal_pointer (&self->source.split);
    return TRUE;
  }
  return cloth_file_invalid (error,
      "%s doesn't say where its points lie on the "
      "flat cloth: give --columns, --rows, --width and --height of a grid, or "
      "--mesh FILE.obj with uv in metres", import->source);
}

/* ---- which marker is which vertex ---- */

/* The number at the end of a name; −1 when there is none. */
static gint64
number_of (const gchar * name, gsize * prefix)
{
  gsize n = strlen (name);

  *prefix = n;
  while (*prefix > 0 && g_ascii_isdigit (name[*prefix - 1]))
    (*prefix)--;
  return *prefix == n || n - *prefix > 9 ? -1 :
      g_ascii_strtoll (name + *prefix, NULL, 10);
}

/* Whether all names are one text and a number. */
static gboolean
are_numbered (const GPtrArray * names, const GArray * markers, GArray * numbers)
{
  const gchar *first = NULL;

  for (guint i = 0; i < markers->len; i++) {
    const gchar *name = names->pdata[g_array_index (markers, guint, i)];
    gsize prefix, first_prefix = 0;
    const gint64 number = number_of (name, &prefix);

    if (!first)
      first = name;
    number_of (first, &first_prefix);
    if (number < 0 || prefix != first_prefix ||
        strncmp (name, first, prefix) != 0)
      return FALSE;
    g_array_append_val (numbers, number);
  }
  return TRUE;
}

static gboolean
refuse_count (const Import * self, guint n, GError ** error)
{
  return cloth_file_invalid (error, "%u markers are there, the %s has %u "
      "vertices; mend --columns and --rows, name the markers by the numbers of "
      "their vertices, or leave out what is no vertex", n,
      self->import->mesh ? "mesh" : "grid", self->topology->n_vertices);
}

static gboolean
place_numbered (Import * self, const GArray * markers, const GArray * numbers,
    GError ** error)
{
  const guint n = self->topology->n_vertices;
  gint64 least = G_MAXINT64, most = -1, base;

  for (guint i = 0; i < numbers->len; i++) {
    least = MIN (least, g_array_index (numbers, gint64, i));
    most = MAX (most, g_array_index (numbers, gint64, i));
  }
  /* Counted from 0, or from 1, or by numbers of their own. */
  base = most < n ? 0 : least > 0 && most == n ? 1 : least;
  if (most - base >= n || (base > 1 && numbers->len != n))
    return refuse_count (self, markers->len, error);
  for (guint i = 0; i < numbers->len; i++) {
    const gint64 vertex = g_array_index (numbers, gint64, i) - base;

    if (self->vertices[vertex] >= 0)
      return cloth_file_invalid (error, "two markers have the number %"
          G_GINT64_FORMAT, vertex + base);
    self->vertices[vertex] = (gint) g_array_index (markers, guint, i);
  }
  cloth_summary_add (self->told, "order", "vertex 0 is marker “%s”; by the "
      "markers' numbers, counted from %" G_GINT64_FORMAT,
      self->vertices[0] < 0 ? "none" : (const gchar *)
      self->source.markers->names->pdata[self->vertices[0]], base);
  return TRUE;
}

/* @apart: markers that only are clamps' paths */
static gboolean
place_vertices (Import * self, GHashTable * apart, GError ** error)
{
  const ClothMarkers *markers = self->source.markers;
  const guint n = self->topology->n_vertices;
  g_autoptr (GArray) left = g_array_new (FALSE, FALSE, sizeof (guint));
  g_autoptr (GArray) numbers = g_array_new (FALSE, FALSE, sizeof (gint64));

  self->vertices = g_new (gint, n);
  for (guint i = 0; i < n; i++)
    self->vertices[i] = -1;
  for (guint i = 0; i < markers->n_markers; i++)
    if (!g_hash_table_contains (apart, GUINT_TO_POINTER (i)))
      g_array_append_val (left, i);
  if (markers->names && are_numbered (markers->names, left, numbers))
    return place_numbered (self, left, numbers, error);
  if (left->len != n)
    return refuse_count (self, left->len, error);
  for (guint i = 0; i < n; i++)
    self->vertices[i] = (gint) g_array_index (left, guint, i);
  if (markers->names)
    cloth_summary_add (self->told, "order",
        "of the file: vertex 0 is “%s”, " "vertex %u “%s”",
        (const gchar *)
        markers->names->pdata[self->vertices[0]], n - 1, (const gchar *)
        markers->names->pdata[self->vertices[n - 1]]);
  return TRUE;
}

/* A vertex with several uv is there once for each, all at the place of its marker, and sewn
 * together. */
static gboolean
part_at_seams (Import * self, GError ** error)
{
  const ClothSplit *split = self->split;
  const guint n = self->topology->n_vertices;
  gsize n_sewn = 0;

  if (!split)
    return TRUE;
  for (guint i = 0; i < split->seams->len; i++)
    n_sewn += g_array_index (split->seams, ClothSeamLine, i).n_vertices;
  if (split->seams->len > CLOTH_MAX_SEAMS || n_sewn > MOST_SEWN)
    return cloth_file_invalid (error, "the uv of the mesh have %u seams of %"
        G_GSIZE_FORMAT " pairs of vertices; %u and %u are accepted: unwrap it "
        "in fewer pieces", split->seams->len, n_sewn, CLOTH_MAX_SEAMS,
        MOST_SEWN);
  cloth_topology_free (self->topology);
  self->topology = cloth_topology_copy (split->topology);
  self->vertices = g_renew (gint, self->vertices, self->topology->n_vertices);
  for (guint i = n; i < self->topology->n_vertices; i++)
    self->vertices[i] = self->vertices[split->sources[i]];
  cloth_summary_add (self->told, "seams", "%u, where the mesh gives vertices "
      "several uv: it is parted there and sewn, with %u vertices more",
      split->seams->len, self->topology->n_vertices - n);
  for (guint i = 0; i < split->seams->len; i++) {
    const ClothSeamLine *line = &g_array_index (split->seams, ClothSeamLine, i);
    gdouble lengths[2];

    if (!cloth_seam_fits (self->topology, line, lengths))
      cloth_summary_add (self->notes, "note",
          "the seam from vertex %u to %u is "
          "%.4g m long there and %.4g m from %u to %u: a simulation takes no "
          "seam whose lines differ by more than %g %%", line->lines[0][0],
          line->lines[0][line->n_vertices - 1], lengths[0], lengths[1],
          line->lines[1][0], line->lines[1][line->n_vertices - 1],
          100 * CLOTH_SEAM_EASE);
  }
  return TRUE;
}

/* ---- positions ---- */

static gboolean
place_positions (Import * self, GError ** error)
{
  const ClothMarkers *markers = self->source.markers;
  const gsize n = self->topology->n_vertices;
  gsize n_seen = 0, n_zeros = 0;

  if (markers->n_frames > CLOTH_MAX_MARKER_POSITIONS / n) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%u frames of %" G_GSIZE_FORMAT
        " vertices; import the recording in parts", markers->n_frames, n);
    return FALSE;
  }
  self->positions = g_new (gfloat, 3 * n * markers->n_frames);
  for (gsize i = 0; i < markers->n_frames; i++)
    for (gsize k = 0; k < n; k++) {
      static const gfloat unseen[3] = { NAN, NAN, NAN };
      const gint marker = self->vertices[k];
      gfloat *to = self->positions + 3 * (i * n + k);

      convert (self, marker < 0 ? unseen : markers->positions +
          3 * (i * markers->n_markers + (gsize) marker), self->unit_m, to);
      n_seen += !isnan (to[0]);
      n_zeros += to[0] == 0 && to[1] == 0 && to[2] == 0;
    }
  if (n_seen == 0)
    return cloth_file_invalid (error, "%s: no place of any vertex is known",
        self->import->source);
  if ((gdouble) n_zeros > ODD_ZEROS * (gdouble) n_seen)
    cloth_summary_add (self->notes, "note", "%.1f %% of the places are exactly "
        "0, 0, 0; if that means not seen, give --zero-is-missing",
        100. * (gdouble) n_zeros / (gdouble) n_seen);
  return cloth_positions_check (self->positions,
      (guint) MIN (n * markers->n_frames, G_MAXUINT), error);
}

/* Of some frames the median; NaN when no neighbours are seen together. */
static gdouble
stretch_of (const Import * self, const ClothTopology * topology)
{
  const guint n_frames = self->source.markers->n_frames;
  const guint step = (n_frames + LOOKS - 1) / LOOKS;
  g_autoptr (GArray) scratch = g_array_new (FALSE, FALSE, sizeof (gdouble));
  gdouble looks[LOOKS];
  guint n = 0;

  for (guint i = 0; i < n_frames && n < LOOKS; i += step) {
    looks[n] = cloth_summary_stretch (topology, self->positions +
        3 * (gsize) i * topology->n_vertices, CLOTH_SIDES_ALL, scratch);
    n += isfinite (looks[n]);
  }
  return n > 0 ? cloth_median (looks, n) : NAN;
}

/* Whether the grid fits with its columns and rows exchanged. */
static gboolean
fits_turned (const Import * self)
{
  const ClothImport *import = self->import;
  g_autoptr (ClothTopology) turned = NULL;
  gdouble stretch;

  if (import->columns == 0 || import->columns == import->rows)
    return FALSE;
  turned = cloth_topology_new_grid (import->rows, import->columns,
      (gfloat) import->height_m, (gfloat) import->width_m);
  stretch = stretch_of (self, turned);
  return stretch > LEAST_STRETCH && stretch < FAIR_STRETCH;
}

/* A unit that would make the cloth as large as it is. */
static const gchar *
better_unit (gdouble unit_m, gdouble stretch)
{
  for (guint i = 0; i < G_N_ELEMENTS (units); i++) {
    const gdouble then = stretch / unit_m * units[i].unit_m;

    if (then > FAIR_SHRINKAGE && then < FAIR_STRETCH)
      return units[i].name;
  }
  return NULL;
}

static gboolean
check_size (Import * self, GError ** error)
{
  const gdouble stretch = stretch_of (self, self->topology);
  const gchar *unit;

  if (isnan (stretch))
    return TRUE;
  if (stretch > LEAST_STRETCH && stretch < MOST_STRETCH) {
    if (fits_turned (self) && stretch > FAIR_STRETCH)
      cloth_summary_add (self->notes, "note", "%u columns and %u rows, with "
          "width and height exchanged, would fit the places better",
          self->import->rows, self->import->columns);
    return TRUE;
  }
  unit = better_unit (self->unit_m, stretch);
  if (unit)
    return cloth_file_invalid (error,
        "neighbours are %.3g times as far apart as "
        "on the flat cloth: the coordinates look like %s: give --units %s",
        stretch, unit, unit);
  if (fits_turned (self))
    return cloth_file_invalid (error,
        "neighbours are %.3g times as far apart as "
        "on the flat cloth; with columns and rows exchanged they fit: give "
        "--columns %u --rows %u, and exchange --width and --height", stretch,
        self->import->rows, self->import->columns);
  return cloth_file_invalid (error,
      "neighbours are %.3g times as far apart as on "
      "the flat cloth: mend --units, the size of the cloth in metres (--width and "
      "--height, or the uv of the mesh), or the order of the vertices (vertex = "
      "row × columns + column)", stretch);
}

/* ---- clamps ---- */

/* @vertex: a marker's name or a number */
static gboolean
find_vertex (const Import * self, const gchar * text, guint * vertex,
    GError ** error)
{
  const gint marker = cloth_markers_find (self->source.markers, text);
  gchar *end;
  guint64 number;

  for (guint i = 0; marker >= 0 && i < self->topology->n_vertices; i++)
    if (self->vertices[i] == marker) {
      *vertex = i;
      return TRUE;
    }
  number = g_ascii_strtoull (text, &end, 10);
  if (!g_ascii_isdigit (*text) || *end || number >= self->topology->n_vertices)
    return cloth_file_invalid (error,
        "--clamp %s: no vertex is called so; give a "
        "marker's name or a number from 0 to %u", text,
        self->topology->n_vertices - 1);
  *vertex = (guint) number;
  return TRUE;
}

static gchar *
list_names (const ClothMarkers * markers)
{
  GString *text = g_string_new (NULL);
  const guint n = markers->names ? markers->names->len : 0;

  for (guint i = 0; i < MIN (n, 10); i++)
    g_string_append_printf (text, "%s“%s”", i > 0 ? ", " : "",
        (const gchar *) markers->names->pdata[i]);
  if (n == 0)
    g_string_append (text, "markers without names");
  else if (n > 10)
    g_string_append_printf (text, " and %u more", n - 10);
  return g_string_free (text, FALSE);
}

/* @at: when, from the beginning of the recording
 * @path: 3 numbers at each of @n times, NaN where not known
 * @place: (out): on the straight line between the known ones before and after; those before
 *   the first and behind the last stay where they are
 *
 * Returns: how long it is to the nearest known one, or between the two
 */
static gdouble
place_at (const gdouble * times, const gfloat * path, guint n, gdouble at,
    guint * hint, gfloat * place)
{
  guint before = *hint, after;

  while (before + 1 < n && times[before + 1] <= at)
    before++;
  *hint = before;
  after = times[before] < at ? before + 1 : before;
  while (before > 0 && isnan (path[3 * (gsize) before]))
    before--;
  while (after < n && isnan (path[3 * (gsize) after]))
    after++;
  if (isnan (path[3 * (gsize) before]) || times[before] > at) {
    if (after >= n)
      return INFINITY;
    memcpy (place, path + 3 * (gsize) after, 3 * sizeof *place);
    return times[after] - at;
  }
  if (after >= n || after == before) {
    memcpy (place, path + 3 * (gsize) before, 3 * sizeof *place);
    return after == before ? 0 : at - times[before];
  }
  for (guint k = 0; k < 3; k++) {
    const gdouble a = path[3 * (gsize) before + k];
    const gdouble b = path[3 * (gsize) after + k];

    place[k] = (gfloat) (a + (b - a) * (at - times[before]) /
        (times[after] - times[before]));
  }
  return times[after] - times[before];
}

/* @from: the recording that has the path of this clamp, whose times are @times
 * Returns: (transfer full): 3 numbers a frame, or NULL */
static gfloat *
follow (Import * self, const ClothMarkers * from, const gdouble * times,
    guint marker, gdouble unit_m, const gchar * what, GError ** error)
{
  const guint n_frames = self->source.markers->n_frames;
  g_autofree gfloat *path = g_new (gfloat, 3 * (gsize) from->n_frames);
  g_autofree gfloat *places = g_new (gfloat, 3 * (gsize) n_frames);
  const gdouble step = from->n_frames > 1 ?
      (times[from->n_frames - 1] - times[0]) / (from->n_frames - 1) : 0;
  guint hint = 0, n_bridged = 0;

  for (gsize i = 0; i < from->n_frames; i++)
    convert (self, from->positions + 3 * (i * from->n_markers + marker),
        unit_m, path + 3 * i);
  for (guint i = 0; i < n_frames; i++) {
    const gdouble gap = place_at (times, path, from->n_frames, self->times[i],
        &hint, places + 3 * (gsize) i);

    if (gap > MAX (LONGEST_GAP_S, 2 * step)) {
      cloth_file_invalid (error, "clamp %s: its place is not known at %.4g s; "
          "what a clamp holds needs a path from the first frame to the last: "
          "give its log by --clamp-file, on the clock of the recording", what,
          self->times[i]);
      return NULL;
    }
    n_bridged += gap > 1.5 * step;
  }
  if (n_bridged > 0)
    cloth_summary_add (self->notes, "note",
        "clamp %s: its place was not known in %u frames and is taken from the "
        "frames about them", what, n_bridged);
  return g_steal_pointer (&places);
}

static gdouble
median_distance (const Import * self, const gfloat * path, guint vertex)
{
  const guint n_frames = self->source.markers->n_frames;
  const gsize n = self->topology->n_vertices;
  g_autofree gdouble *away = g_new (gdouble, n_frames);
  guint n_seen = 0;

  for (gsize i = 0; i < n_frames; i++) {
    const gfloat *p = self->positions + 3 * (i * n + vertex);
    const gfloat *q = path + 3 * i;

    away[n_seen] = hypot (hypot ((gdouble) p[0] - q[0], (gdouble) p[1] - q[1]),
        (gdouble) p[2] - q[2]);
    n_seen += isfinite (away[n_seen]);
  }
  return n_seen > 0 ? cloth_median (away, n_seen) : NAN;
}

/* A clamp that is far from what it holds holds something else. */
static gboolean
check_reach (const Import * self, const gfloat * path, guint vertex,
    const gchar * what, GError ** error)
{
  const ClothTopology *topology = self->topology;
  const guint32 *face = topology->faces;
  const gfloat *u = topology->uv + 2 * (gsize) face[0];
  const gfloat *v = topology->uv + 2 * (gsize) face[1];
  const gdouble side = hypot ((gdouble) u[0] - v[0], (gdouble) u[1] - v[1]);
  const gdouble away = median_distance (self, path, vertex);
  gdouble least = INFINITY;
  guint nearest = vertex;

  if (isnan (away) || away <= MAX (CLAMP_REACH_M, 2 * side))
    return TRUE;
  for (guint i = 0; i < topology->n_vertices; i++) {
    const gdouble distance = median_distance (self, path, i);

    if (distance < least) {
      least = distance;
      nearest = i;
    }
  }
  if (least <= MAX (CLAMP_REACH_M, 2 * side))
    return cloth_file_invalid (error,
        "clamp %s is %.3g m from vertex %u in the "
        "median; the nearest is vertex %u (%.3g m): is it that which it holds?",
        what, away, vertex, nearest, least);
  return cloth_file_invalid (error,
      "clamp %s is %.3g m from vertex %u in the "
      "median, and %.3g m from every other: its file needs the unit and axes of "
      "the recording (columns x_mm, y_mm, z_mm name their unit)", what, away,
      vertex, least);
}

/* The recording that has the clamps' paths, its times on the clock of the frames, and its
 * unit. */
static const ClothMarkers *
find_log (const Import * self, gdouble ** times, gdouble * unit_m,
    GError ** error)
{
  const ClothMarkers *log = self->log ? self->log : self->source.markers;

  *unit_m = self->unit_m;
  *times = g_new (gdouble, log->n_frames);
  if (self->log && log->unit_m > 0)
    *unit_m = log->unit_m;
  if (!self->log || !log->times) {
    if (log->n_frames != self->source.markers->n_frames) {
      cloth_file_invalid (error,
          "%s has %u lines and no times, the recording %u "
          "frames: give the log a column time_s", self->import->clamp_file,
          log->n_frames, self->source.markers->n_frames);
      g_clear_pointer (times, g_free);
      return NULL;
    }
    memcpy (*times, self->times, log->n_frames * sizeof **times);
    return log;
  }
  for (guint i = 0; i < log->n_frames; i++)
    (*times)[i] = log->times[i] -
        (isnan (self->start) ? log->times[0] : self->start);
  return log;
}

static gboolean
add_clamp (Import * self, const gchar * text, const ClothMarkers * log,
    const gdouble * times, gdouble unit_m, GError ** error)
{
  g_auto (GStrv) words = g_strsplit (text, "=", 2);
  const ClothMarkers *from = self->source.markers;
  gfloat *path;
  guint vertex;
  gint marker;

  if (!words[0] || !find_vertex (self, words[0], &vertex, error))
    return FALSE;
  for (guint i = 0; i < self->held->len; i++)
    if (g_array_index (self->held, guint, i) == vertex)
      return cloth_file_invalid (error, "--clamp %s: vertex %u is held twice",
          text, vertex);
  marker = words[1] ? cloth_markers_find (log, words[1]) :
      self->vertices[vertex];
  if (marker < 0) {
    g_autofree gchar *names = list_names (log);

    return words[1] ? cloth_file_invalid (error,
        "--clamp %s: no marker is called “%s”; there are %s", text,
        words[1], names) : cloth_file_invalid (error,
        "--clamp %s: no marker shows this vertex: name the marker whose path "
        "the clamp took, VERTEX=NAME", text);
  }
  path = words[1] ? follow (self, log, times, (guint) marker, unit_m, text,
      error) : follow (self, from, self->times, (guint) marker, self->unit_m,
      text, error);
  if (!path)
    return FALSE;
  g_array_append_val (self->held, vertex);
  g_ptr_array_add (self->paths, path);
  cloth_summary_add (self->told, "clamp", "vertex %u follows %s%s%s%s", vertex,
      words[1] ? "“" : "its own places", words[1] ? words[1] : "",
      words[1] ? "”" : "", words[1] && self->log ? ", between its lines on a "
      "straight line" : "");
  return check_reach (self, path, vertex, text, error);
}

static gboolean
add_clamps (Import * self, GError ** error)
{
  const gchar *const *clamps = self->import->clamps;
  g_autofree gdouble *times = NULL;
  gdouble unit_m;
  const ClothMarkers *log = find_log (self, &times, &unit_m, error);

  if (!log)
    return FALSE;
  for (guint i = 0; clamps && clamps[i]; i++)
    if (!add_clamp (self, clamps[i], log, times, unit_m, error))
      return FALSE;
  if (self->held->len == 0)
    cloth_summary_add (self->notes, "note",
        "no clamp is given (--clamp); without "
        "one a simulation of this take lets the cloth fall");
  return TRUE;
}

/* Markers of the source that are no vertices. */
static GHashTable *
find_apart (const Import * self)
{
  GHashTable *apart = g_hash_table_new (NULL, NULL);
  const gchar *const *clamps = self->import->clamps;

  for (guint i = 0; !self->log && clamps && clamps[i]; i++) {
    const gchar *name = strchr (clamps[i], '=');
    const gint marker = name ? cloth_markers_find (self->source.markers,
        name + 1) : -1;

    if (marker >= 0)
      g_hash_table_add (apart, GUINT_TO_POINTER ((guint) marker));
  }
  return apart;
}

/* ---- the take ---- */

static gboolean
write_take (Import * self, const gchar * folder, GError ** error)
{
  const gsize n = self->topology->n_vertices;
  g_autofree gchar *base = g_path_get_basename (folder);
  g_autofree gchar *name = g_strndup (base, strlen (base) -
      (g_str_has_suffix (base, ".take") ? strlen (".take") : 0));
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (name);
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree guint8 *states = g_new (guint8, n);
  g_autofree gfloat *clamps = g_new (gfloat, 3 * (gsize) self->held->len);

  cloth_take_info_set_mesh (info, self->topology);
  if (self->split) {
    g_array_unref (info->seams);
    info->seams = g_array_ref (self->split->seams);
  }
  for (guint i = 0; i < self->held->len; i++) {
    ClothHeld held = { g_array_index (self->held, guint, i), -INFINITY,
      INFINITY
    };

    g_array_append_val (info->held, held);
  }
  writer = cloth_take_writer_new (folder, info, self->topology, error);
  if (!writer)
    return FALSE;
  for (gsize i = 0; i < self->source.markers->n_frames; i++) {
    const gfloat *positions = self->positions + 3 * i * n;

    for (gsize k = 0; k < n; k++)
      states[k] = isnan (positions[3 * k]) ? CLOTH_VERTEX_UNSEEN :
          CLOTH_VERTEX_MEASURED;
    for (guint c = 0; c < self->held->len; c++)
      memcpy (clamps + 3 * (gsize) c,
          (const gfloat *) self->paths->pdata[c] + 3 * i, 3 * sizeof *clamps);
    if (!cloth_take_writer_append (writer, self->times[i], positions, states,
            NULL, self->held->len > 0 ? clamps : NULL, error))
      return FALSE;
  }
  return cloth_take_writer_close (writer, error);
}

static gboolean
understand (Import * self, GError ** error)
{
  const ClothImport *import = self->import;
  g_autoptr (GHashTable) apart = NULL;

  if (!cloth_import_source_read (&self->source, import->source, error))
    return FALSE;
  if (import->clamp_file &&
      !(self->log = cloth_markers_read (import->clamp_file, error)))
    return FALSE;
  cloth_summary_add (self->told, "source", "%s: %s, %u frames of %u markers",
      import->source, self->source.markers->layout,
      self->source.markers->n_frames, self->source.markers->n_markers);
  if (self->source.markers->ignored)
    cloth_summary_add (self->told, "not used", "columns %s",
        self->source.markers->ignored);
  if (!parse_axes (self, error))
    return FALSE;
  choose_unit (self);
  apart = find_apart (self);
  return find_times (self, error) && find_mesh (self, error) &&
      place_vertices (self, apart, error) && part_at_seams (self, error) &&
      place_positions (self, error) && check_size (self, error)
      && add_clamps (self, error);
}

static gchar *
run (Import * self, const gchar * folder, GError ** error)
{
  g_autoptr (ClothTake) take = NULL;
  g_autofree gchar *summary = NULL;

  if (!understand (self, error))
    return NULL;
  if (!write_take (self, folder, error) ||
      !(take = cloth_take_open (folder, error)) ||
      !(summary = cloth_take_summarise (take, error)))
    return NULL;
  return g_strconcat (self->told->str, summary, self->notes->str, NULL);
}

/* @import: what to import, and how
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Makes a take of a recording of another program. What is surely wrong, a unit, times that go
 * back, clamps far from what they hold, is an error that says what to do.
 *
 * Returns: (transfer full): what was understood, as a table for people; %NULL when there is no
 *   take
 */
gchar *
cloth_take_import (const ClothImport * import, GError ** error)
{
  g_autofree gchar *folder =
      cloth_mesh_format_stem (import->output, CLOTH_MESH_FORMAT_TAKE);
  g_autofree gchar *head = g_build_filename (folder, "take.json", NULL);
  Import self = {.import = import };
  gchar *told;

  if (!import->overwrite && g_file_test (head, G_FILE_TEST_EXISTS)) {
    cloth_file_invalid (error,
        "%s is there already; give another --output, or --overwrite", folder);
    return NULL;
  }
  self.held = g_array_new (FALSE, FALSE, sizeof (guint));
  self.paths = g_ptr_array_new_with_free_func (g_free);
  self.told = g_string_new (NULL);
  self.notes = g_string_new (NULL);
  told = run (&self, folder, error);
  free_import (&self);
  return told;
}
