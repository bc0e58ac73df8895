/* Recordings of labelled points in tables of text: one line a point of a frame (long), or one
 * a frame (wide), as spreadsheets, robots' logs and motion capture write them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/mesh/formats/markers.h"

/* Lines in which the names of the columns are searched. */
#define MAX_HEADER_ROWS 16
/* Columns of a table. */
#define MAX_COLUMNS (3 * CLOTH_MAX_VERTICES + 64)
/* Lines of a long table. */
#define MAX_ROWS 16000000u
/* A coordinate beyond is no place of a cloth, in whatever unit. */
#define MAX_COORDINATE 1e9

#define EXAMPLES "the names of the columns are expected in a line above the " \
  "numbers: “time_s,marker,x_m,y_m,z_m” with a line for each marker, or " \
  "“time_s,a_x,a_y,a_z,b_x,b_y,b_z” with a line for each frame"

/* @text: the table, which becomes cells
 * @line: line of the last row, counted from 1
 * @separator: between cells; a space stands for any white space
 * @cells: (element-type utf8): of the last row, in @text
 */
typedef struct
{
  gchar *text, *end;
  guint line;
  gchar separator;
  GPtrArray *cells;
} Table;

typedef enum
{
  COLUMN_OTHER,
  COLUMN_FRAME,
  COLUMN_TIME,
  COLUMN_MARKER,
  COLUMN_AXIS
} ColumnKind;

/* @axis: of a coordinate, 0 to 2
 * @scale: seconds or metres a unit that the name gives, 0 without one
 * @name: of a coordinate's marker, empty when the column doesn't say
 * @marker: to which it belongs
 */
typedef struct
{
  ColumnKind kind;
  guint axis;
  gdouble scale;
  gchar *name;
  guint marker;
} Column;

/* One line of a long table. */
typedef struct
{
  gdouble key, time;
  guint marker;
  gfloat position[3];
} Row;

/* @rows: (element-type GPtrArray): the lines above the columns' names
 * @columns: (element-type Column)
 * @frame, @time, @marker: columns, −1 without
 * @n_axes: columns that are coordinates
 */
typedef struct
{
  Table table;
  GPtrArray *rows;
  GArray *columns;
  gint frame, time, marker;
  guint n_axes;
} Parser;

static void
column_clear (gpointer data)
{
  g_free (((Column *) data)->name);
}

/* ---- rows and cells ---- */

static gboolean
is_cell_end (const Table * table, gchar c)
{
  return table->separator == ' ' ? g_ascii_isspace (c) : c == table->separator;
}

/* Strips white space and quotes, in place. */
static gchar *
tidy (gchar * cell)
{
  gsize n;

  g_strstrip (cell);
  n = strlen (cell);
  if (n >= 2 && cell[0] == '"' && cell[n - 1] == '"') {
    cell[n - 1] = 0;
    return g_strstrip (cell + 1);
  }
  return cell;
}

static void
split (Table * table, gchar * row, gchar * end)
{
  gboolean quoted = FALSE;
  gchar *cell = row;

  g_ptr_array_set_size (table->cells, 0);
  for (gchar * at = row; at < end; at++) {
    if (*at == '"')
      quoted = !quoted;
    if (quoted || !is_cell_end (table, *at))
      continue;
    *at = 0;
    if (table->separator != ' ' || *cell)
      g_ptr_array_add (table->cells, tidy (cell));
    cell = at + 1;
  }
  if (table->separator != ' ' || *cell)
    g_ptr_array_add (table->cells, tidy (cell));
}

/* FALSE at the end. Empty lines and those that begin with # are passed over. */
static gboolean
next_row (Table * table)
{
  while (table->text < table->end) {
    gchar *row = table->text;
    gchar *end = memchr (row, '\n', (gsize) (table->end - row));

    if (!end)
      end = table->end;
    table->text = MIN (end + 1, table->end);
    *end = 0;
    table->line++;
    while (g_ascii_isspace (*row))
      row++;
    if (row >= end || *row == '#')
      continue;
    split (table, row, end);
    return TRUE;
  }
  return FALSE;
}

/* What stands between the columns' names. A semicolon leaves the comma to decimals. */
static gchar
find_separator (const gchar * text, gsize size)
{
  static const gchar marks[] = { ';', '\t', ',' };
  gsize n = 0;

  for (guint lines = 0; n < size && lines < MAX_HEADER_ROWS; n++)
    lines += text[n] == '\n';
  for (guint i = 0; i < G_N_ELEMENTS (marks); i++)
    if (memchr (text, marks[i], n))
      return marks[i];
  return ' ';
}

/* @value: NaN for a word that says that it is missing */
static gboolean
parse_number (const Table * table, gchar * cell, gdouble * value)
{
  static const gchar *const missing[] =
      { "", "nan", "na", "n/a", "null", "none", "-" };
  gchar *end, *comma;

  if (g_ascii_isdigit (*cell) || (*cell && cell[1])) {
    if (table->separator != ',' && (comma = strchr (cell, ',')))
      *comma = '.';
    *value = g_ascii_strtod (cell, &end);
    if (end != cell && !*end && isfinite (*value))
      return TRUE;
  }
  *value = NAN;
  for (guint i = 0; i < G_N_ELEMENTS (missing); i++)
    if (g_ascii_strcasecmp (cell, missing[i]) == 0)
      return TRUE;
  return FALSE;
}

/* ---- the names of the columns ---- */

/* Cuts a unit off a name such as `x_mm`, `Time (Seconds)` or `t [ms]`. */
static gdouble
cut_unit (gchar * name)
{
  static const struct
  {
    const gchar *name;
    gdouble scale;
  } units[] = { {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254},
  {"s", 1}, {"sec", 1}, {"seconds", 1}, {"ms", 1e-3}, {"us", 1e-6},
  {"ns", 1e-9}
  };
  gsize n = strlen (name);
  gboolean bracket = n > 0 && strchr (")]", name[n - 1]);
  gsize last = bracket ? n - 1 : n, first = last;

  while (first > 0 && g_ascii_isalpha (name[first - 1]))
    first--;
  if (first < 2 || !strchr (bracket ? "([" : "_ ", name[first - 1]))
    return 0;
  for (guint i = 0; i < G_N_ELEMENTS (units); i++)
    if (strlen (units[i].name) == last - first &&
        g_ascii_strncasecmp (name + first, units[i].name, last - first) == 0) {
      name[first - 1] = 0;
      g_strchomp (name);
      return units[i].scale;
    }
  return 0;
}

static gboolean
is_one_of (const gchar * name, const gchar * const *words)
{
  for (; *words; words++)
    if (g_ascii_strcasecmp (name, *words) == 0)
      return TRUE;
  return FALSE;
}

/* Coordinates of something that is no place: a word of the name says so. */
static gboolean
is_no_place (const gchar * name)
{
  static const gchar *const words[] = { "rot", "rotation", "orientation",
    "quat", "quaternion", "vel", "velocity", "acc", "acceleration", "force",
    "torque", "twist", "linear", "angular", NULL
  };

  while (*name) {
    gsize n = 0;

    while (g_ascii_isalpha (name[n]))
      n++;
    for (guint i = 0; n > 0 && words[i]; i++)
      if (strlen (words[i]) == n
          && g_ascii_strncasecmp (name, words[i], n) == 0)
        return TRUE;
    name += MAX (n, 1);
  }
  return FALSE;
}

/* `x`, `a_x`, `a.x`, `a:X`, `x0` and `x_a` name an axis. */
static gboolean
parse_axis (const gchar * name, Column * column)
{
  gsize n = strlen (name);
  const gchar *rest = name;
  gsize length = 0;
  gchar axis = 0;

  if (n == 0)
    return FALSE;
  if (n == 1) {
    axis = *name;
  } else if (strchr ("_. :-/", name[n - 2])) {
    axis = name[n - 1];
    length = n - 2;
  }
  if (!axis || !strchr ("xyzXYZ", axis)) {
    if (n < 2 || !(g_ascii_isdigit (name[1]) || strchr ("_.", name[1])))
      return FALSE;
    axis = *name;
    rest = name + (g_ascii_isdigit (name[1]) ? 1 : 2);
    length = strlen (rest);
  }
  if (!strchr ("xyzXYZ", axis))
    return FALSE;
  column->axis = (guint) (g_ascii_tolower (axis) - 'x');
  column->name = g_strndup (rest, length);
  return !is_no_place (column->name);
}

static Column
parse_column (const gchar * cell)
{
  static const gchar *const frames[] = { "frame", "frames", "frame#",
    "frame_id", "frame_number", "sample", "field", NULL
  };
  static const gchar *const times[] = { "t", "time", "timestamp", "stamp",
    NULL
  };
  static const gchar *const markers[] = { "vertex", "vertex_id", "marker",
    "marker_id", "marker_name", "point", "point_id", "id", "name", "label",
    "node", NULL
  };
  /* ROS marks a comment and names the message's fields: %time, field.header.stamp. */
  g_autofree gchar *name = g_strdup (cell + (*cell == '%'));
  const gchar *dot = strrchr (name, '.');
  Column column = { COLUMN_OTHER };

  if (dot && is_one_of (dot + 1, times)) {
    column.kind = COLUMN_TIME;
  } else if (is_one_of (name, frames)) {
    column.kind = COLUMN_FRAME;
  } else if (is_one_of (name, markers)) {
    column.kind = COLUMN_MARKER;
  } else {
    column.scale = cut_unit (name);
    if (is_one_of (name, times))
      column.kind = COLUMN_TIME;
    else if (parse_axis (name, &column))
      column.kind = COLUMN_AXIS;
    else
      g_clear_pointer (&column.name, g_free);
  }
  return column;
}

/* A cell of the lines above, NULL when it is empty. */
static const gchar *
cell_above (const Parser * parser, guint row, guint column)
{
  const GPtrArray *cells = parser->rows->pdata[row];
  const gchar *cell = column < cells->len ? cells->pdata[column] : "";

  return *cell ? cell : NULL;
}

/* Of columns that are called X, Y, Z only, the marker's name stands above the X: in a line
 * that is called Name, else in the nearest one. */
static const gchar *
name_above (const Parser * parser, guint column)
{
  const gchar *nearest = NULL;

  for (guint i = parser->rows->len; i-- > 0;) {
    const gchar *cell = cell_above (parser, i, column);
    gboolean named = FALSE;

    for (guint k = 0; k < 2; k++)
      named |= g_ascii_strcasecmp (cell_above (parser, i, k) ?
          cell_above (parser, i, k) : "", "name") == 0;
    if (cell && named)
      return cell;
    if (cell && !nearest && g_ascii_strcasecmp (cell, "position") != 0)
      nearest = cell;
  }
  return nearest;
}

static gboolean
is_no_place_above (const Parser * parser, guint column)
{
  for (guint i = 0; i < parser->rows->len; i++) {
    const gchar *cell = cell_above (parser, i, column);

    if (cell && is_no_place (cell))
      return TRUE;
  }
  return FALSE;
}

/* Looks for the line with the columns' names. */
static gboolean
find_columns (Parser * parser, GError ** error)
{
  parser->rows =
      g_ptr_array_new_with_free_func ((GDestroyNotify) g_ptr_array_unref);
  while (parser->rows->len < MAX_HEADER_ROWS && next_row (&parser->table)) {
    GPtrArray *cells = parser->table.cells;

    if (cells->len > MAX_COLUMNS) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
          "line %u has %u cells; %u are accepted", parser->table.line,
          cells->len, MAX_COLUMNS);
      return FALSE;
    }
    g_array_set_size (parser->columns, 0);
    parser->n_axes = 0;
    for (guint i = 0; i < cells->len; i++) {
      Column column = parse_column (cells->pdata[i]);

      if (column.kind == COLUMN_AXIS && is_no_place_above (parser, i))
        column.kind = COLUMN_OTHER;
      parser->n_axes += column.kind == COLUMN_AXIS;
      g_array_append_val (parser->columns, column);
    }
    if (parser->n_axes >= 3)
      return TRUE;
    g_ptr_array_add (parser->rows, g_ptr_array_ref (cells));
    g_ptr_array_unref (cells);
    parser->table.cells = g_ptr_array_new ();
  }
  return cloth_file_invalid (error,
      "no coordinates are found in this file, read as a table, as all are but "
      ".c3d, .npy, .obj, .ply and .pc2; " EXAMPLES);
}

static gboolean
find_roles (Parser * parser, const GPtrArray * names, ClothMarkers * units,
    GString * ignored, GError ** error)
{
  parser->frame = parser->time = parser->marker = -1;
  for (guint i = 0; i < parser->columns->len; i++) {
    const Column *column = &g_array_index (parser->columns, Column, i);
    const gchar *name = names->pdata[i];
    gint *role = column->kind == COLUMN_FRAME ? &parser->frame :
        column->kind == COLUMN_TIME ? &parser->time :
        column->kind == COLUMN_MARKER ? &parser->marker : NULL;

    if (column->kind == COLUMN_AXIS && column->scale > 0) {
      if (units->unit_m > 0 && units->unit_m != column->scale)
        return cloth_file_invalid (error,
            "column “%s” has another unit of length than those before",
            name);
      units->unit_m = column->scale;
    }
    if (role && *role < 0)
      *role = (gint) i;
    else if (column->kind != COLUMN_AXIS && *name && ignored->len < 200)
      g_string_append_printf (ignored, "%s%s", ignored->len ? ", " : "", name);
  }
  return TRUE;
}

/* ---- wide: a line is a frame ---- */

/* Sorts the coordinates into markers. */
static GPtrArray *
name_markers (Parser * parser, GError ** error)
{
  g_autoptr (GPtrArray) names = g_ptr_array_new_with_free_func (g_free);
  g_autoptr (GHashTable) known = g_hash_table_new (g_str_hash, g_str_equal);
  g_autoptr (GByteArray) axes = g_byte_array_new ();
  guint last = 0;

  for (guint i = 0; i < parser->columns->len; i++) {
    Column *column = &g_array_index (parser->columns, Column, i);
    gpointer found;

    if (column->kind != COLUMN_AXIS)
      continue;
    if (!*column->name && column->axis > 0 && names->len > 0) {
      column->marker = last;
    } else {
      const gchar *above = *column->name ? NULL : name_above (parser, i);
      g_autofree gchar *name = *column->name ? g_strdup (column->name) :
          above ? g_strdup (above) : g_strdup_printf ("%u", names->len);

      if (g_hash_table_lookup_extended (known, name, NULL, &found)) {
        column->marker = GPOINTER_TO_UINT (found);
      } else {
        column->marker = names->len;
        g_ptr_array_add (names, g_steal_pointer (&name));
        g_hash_table_insert (known, names->pdata[column->marker],
            GUINT_TO_POINTER (column->marker));
        g_byte_array_append (axes, (const guint8 *) "", 1);
      }
    }
    last = column->marker;
    if (axes->data[last] & 1 << column->axis) {
      cloth_file_invalid (error, "marker “%s” has two %c columns",
          (gchar *) names->pdata[last], 'x' + (gint) column->axis);
      return NULL;
    }
    axes->data[last] |= (guint8) (1 << column->axis);
  }
  for (guint i = 0; i < names->len; i++)
    for (guint axis = 0; axis < 3; axis++)
      if (!(axes->data[i] & 1 << axis)) {
        cloth_file_invalid (error, "marker “%s” has no %c column; "
            EXAMPLES, (gchar *) names->pdata[i], 'x' + (gint) axis);
        return NULL;
      }
  return g_steal_pointer (&names);
}

static gboolean
check_rising (const Parser * parser, const gchar * what, gdouble before,
    gdouble value, GError ** error)
{
  if (isnan (value))
    return cloth_file_invalid (error, "line %u: the %s is missing",
        parser->table.line, what);
  if (value > before)
    return TRUE;
  return cloth_file_invalid (error, value == before ?
      "line %u: the %s %.10g comes twice; leave one of the lines out, or, where "
      "the times are rounded, the column, and give --rate" :
      "line %u: the %s goes back to %.10g; sort the lines by time, or, where "
      "the clock was set back, leave the column out and give --rate",
      parser->table.line, what, value);
}

static gboolean
parse_cell (Parser * parser, guint column, gdouble * value, GError ** error)
{
  gchar *cell = parser->table.cells->pdata[column];

  if (!parse_number (&parser->table, cell, value))
    return cloth_file_invalid (error,
        "line %u: “%.40s” is no number; leave the cell empty where a place is "
        "not known", parser->table.line, cell);
  if (g_array_index (parser->columns, Column, column).kind == COLUMN_AXIS &&
      fabs (*value) > MAX_COORDINATE)
    return cloth_file_invalid (error, "line %u: a coordinate of %g is no place",
        parser->table.line, *value);
  return TRUE;
}

static gboolean
check_width (const Parser * parser, GError ** error)
{
  const GPtrArray *cells = parser->table.cells;

  for (guint i = parser->columns->len; i < cells->len; i++)
    if (*(gchar *) cells->pdata[i])
      return cloth_file_invalid (error, "line %u has %u cells, the names of "
          "the columns are %u", parser->table.line, cells->len,
          parser->columns->len);
  return cells->len >= parser->columns->len || cloth_file_invalid (error,
      "line %u has %u cells, the names of the columns are %u",
      parser->table.line, cells->len, parser->columns->len);
}

/* A line of units only, such as Vicon's. */
static gboolean
is_units (const Parser * parser, gdouble * unit_m)
{
  const GPtrArray *cells = parser->table.cells;
  gboolean any = FALSE;

  for (guint i = 0; i < cells->len; i++) {
    g_autofree gchar *name = g_strconcat ("u ", cells->pdata[i], NULL);
    gdouble scale = *(gchar *) cells->pdata[i] ? cut_unit (name) : 0;

    if (*(gchar *) cells->pdata[i] && scale == 0)
      return FALSE;
    if (i < parser->columns->len &&
        g_array_index (parser->columns, Column, i).kind == COLUMN_AXIS)
      *unit_m = scale;
    any |= scale > 0;
  }
  return any;
}

/* The coordinates of a line, those of each marker @stride numbers behind those of the one before. */
static gboolean
parse_places (Parser * parser, gfloat * places, gsize stride, GError ** error)
{
  for (guint i = 0; i < parser->columns->len; i++) {
    const Column *column = &g_array_index (parser->columns, Column, i);
    gdouble value;

    if (column->kind != COLUMN_AXIS)
      continue;
    if (!parse_cell (parser, i, &value, error))
      return FALSE;
    places[stride * column->marker + column->axis] = (gfloat) value;
  }
  return TRUE;
}

static gboolean
read_wide_row (Parser * parser, guint n_markers, gdouble before[2],
    GArray * values[3], GError ** error)
{
  const gint roles[2] = { parser->frame, parser->time };
  const gsize at = values[2]->len;

  if (!check_width (parser, error))
    return FALSE;
  for (guint i = 0; i < 2; i++) {
    gdouble value;

    if (roles[i] < 0)
      continue;
    if (!parse_cell (parser, (guint) roles[i], &value, error))
      return FALSE;
    if (n_markers == 1 && value == before[i])
      return cloth_file_invalid (error,
          "line %u: the %s %.10g comes twice, and "
          "each line has one place: call the column that tells the markers "
          "apart “marker”, or leave one of the lines out",
          parser->table.line, i == 0 ? "frame" : "time", value);
    if (!check_rising (parser, i == 0 ? "frame" : "time", before[i], value,
            error))
      return FALSE;
    g_array_append_val (values[i], value);
    before[i] = value;
  }
  if (at / 3 + n_markers > CLOTH_MAX_MARKER_POSITIONS) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "line %u: more than %" G_GSIZE_FORMAT
        " positions: import the recording in parts", parser->table.line,
        CLOTH_MAX_MARKER_POSITIONS);
    return FALSE;
  }
  g_array_set_size (values[2], (guint) at + 3 * n_markers);
  return parse_places (parser, &g_array_index (values[2], gfloat, at), 3,
      error);
}

static ClothMarkers *
read_wide (Parser * parser, GError ** error)
{
  g_autoptr (GPtrArray) names = name_markers (parser, error);
  g_autoptr (ClothMarkers) markers = NULL;
  g_autoptr (GArray) numbers = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autoptr (GArray) times = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autoptr (GArray) positions = g_array_new (FALSE, FALSE, sizeof (gfloat));
  GArray *values[3] = { numbers, times, positions };
  gdouble before[2] = { -INFINITY, -INFINITY }, unit_m = 0;
  gboolean first = TRUE;

  if (!names)
    return NULL;
  for (; next_row (&parser->table); first = FALSE) {
    if (first && is_units (parser, &unit_m))
      continue;
    if (!read_wide_row (parser, names->len, before, values, error))
      return NULL;
  }
  markers = cloth_markers_new (positions->len / 3 / names->len, names->len,
      error);
  if (!markers)
    return NULL;
  memcpy (markers->positions, positions->data,
      positions->len * sizeof (gfloat));
  markers->names = g_steal_pointer (&names);
  markers->unit_m = unit_m;
  if (parser->frame >= 0)
    markers->numbers = g_memdup2 (numbers->data,
        numbers->len * sizeof (gdouble));
  if (parser->time >= 0)
    markers->times = g_memdup2 (times->data, times->len * sizeof (gdouble));
  markers->layout = "a line for each frame";
  return g_steal_pointer (&markers);
}

/* ---- long: a line is a marker in a frame ---- */

/* @last: (element-type gdouble): of each marker, the key of its last line */
static gboolean
read_long_row (Parser * parser, GHashTable * known, GPtrArray * names,
    GArray * last, GArray * rows, GError ** error)
{
  const gint key = parser->frame >= 0 ? parser->frame : parser->time;
  Row row = { 0 };
  const gchar *name;
  gpointer found;

  if (!check_width (parser, error) ||
      !parse_cell (parser, (guint) key, &row.key, error) ||
      (parser->time >= 0 && !parse_cell (parser, (guint) parser->time,
              &row.time, error)))
    return FALSE;
  name = parser->table.cells->pdata[parser->marker];
  if (!*name)
    return cloth_file_invalid (error, "line %u: the marker is missing",
        parser->table.line);
  if (g_hash_table_lookup_extended (known, name, NULL, &found)) {
    row.marker = GPOINTER_TO_UINT (found);
  } else {
    const gdouble never = -INFINITY;

    row.marker = names->len;
    g_ptr_array_add (names, g_strdup (name));
    g_hash_table_insert (known, names->pdata[row.marker],
        GUINT_TO_POINTER (row.marker));
    g_array_append_val (last, never);
  }
  if (isnan (row.time))
    return cloth_file_invalid (error, "line %u: the time is missing",
        parser->table.line);
  if (!check_rising (parser, key == parser->frame ? "frame" : "time",
          g_array_index (last, gdouble, row.marker), row.key, error)) {
    g_prefix_error (error, "marker “%s”, ", name);
    return FALSE;
  }
  g_array_index (last, gdouble, row.marker) = row.key;
  if (!parse_places (parser, row.position, 0, error))
    return FALSE;
  if (rows->len == MAX_ROWS) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "more than %u lines: import the recording in parts", MAX_ROWS);
    return FALSE;
  }
  g_array_append_val (rows, row);
  return TRUE;
}

static gint
compare_keys (gconstpointer a, gconstpointer b)
{
  const gdouble x = *(const gdouble *) a, y = *(const gdouble *) b;

  return (x > y) - (x < y);
}

/* Returns the keys of the frames, rising, each once. */
static GArray *
sort_keys (const GArray * rows)
{
  GArray *keys = g_array_new (FALSE, FALSE, sizeof (gdouble));
  guint n = 0;

  for (guint i = 0; i < rows->len; i++)
    if (i == 0 || g_array_index (rows, Row, i).key !=
        g_array_index (rows, Row, i - 1).key)
      g_array_append_val (keys, g_array_index (rows, Row, i).key);
  g_array_sort (keys, compare_keys);
  for (guint i = 0; i < keys->len; i++)
    if (n == 0 || g_array_index (keys, gdouble, i) !=
        g_array_index (keys, gdouble, n - 1))
      g_array_index (keys, gdouble, n++) = g_array_index (keys, gdouble, i);
  g_array_set_size (keys, n);
  return keys;
}

/* The time of a frame is that of its first line. */
static gboolean
fill_times (ClothMarkers * markers, GError ** error)
{
  for (guint i = 1; i < markers->n_frames; i++)
    if (markers->times[i] <= markers->times[i - 1])
      return cloth_file_invalid (error,
          "the time of frame %g, %.10g, is not after that of frame %g, %.10g; "
          "mend it, or leave the column out and give --rate",
          markers->numbers[i], markers->times[i], markers->numbers[i - 1],
          markers->times[i - 1]);
  return TRUE;
}

static ClothMarkers *
gather (const Parser * parser, GPtrArray * names, const GArray * rows,
    GError ** error)
{
  g_autoptr (GArray) keys = sort_keys (rows);
  g_autoptr (ClothMarkers) markers =
      cloth_markers_new (keys->len, names->len, error);
  gsize frame = 0;

  if (!markers)
    return NULL;
  markers->names = g_ptr_array_ref (names);
  markers->numbers = g_memdup2 (keys->data, keys->len * sizeof (gdouble));
  if (parser->time >= 0) {
    markers->times = g_new (gdouble, keys->len);
    for (guint i = 0; i < keys->len; i++)
      markers->times[i] = NAN;
  }
  for (guint i = 0; i < rows->len; i++) {
    const Row *row = &g_array_index (rows, Row, i);

    if (g_array_index (keys, gdouble, frame) != row->key)
      frame = (gsize) ((const gdouble *) bsearch (&row->key, keys->data,
              keys->len, sizeof (gdouble), compare_keys) -
          (const gdouble *) (gconstpointer) keys->data);
    memcpy (markers->positions + 3 * (frame * markers->n_markers +
            row->marker), row->position, sizeof row->position);
    if (markers->times && isnan (markers->times[frame]))
      markers->times[frame] = row->time;
  }
  if (markers->times && !fill_times (markers, error))
    return NULL;
  if (parser->frame < 0)
    g_clear_pointer (&markers->numbers, g_free);
  markers->layout = "a line for each marker of each frame";
  return g_steal_pointer (&markers);
}

static ClothMarkers *
read_long (Parser * parser, GError ** error)
{
  g_autoptr (GPtrArray) names = g_ptr_array_new_with_free_func (g_free);
  g_autoptr (GHashTable) known = g_hash_table_new (g_str_hash, g_str_equal);
  g_autoptr (GArray) last = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autoptr (GArray) rows = g_array_new (FALSE, FALSE, sizeof (Row));

  if (parser->frame < 0 && parser->time < 0) {
    cloth_file_invalid (error,
        "a line for each marker needs a column “frame” "
        "or “time_s”, to tell the frames apart");
    return NULL;
  }
  if (parser->n_axes > 3) {
    cloth_file_invalid (error,
        "a line for each marker has one x, y and z; there "
        "are %u columns of coordinates: leave those out that are not the "
        "marker's place", parser->n_axes);
    return NULL;
  }
  while (next_row (&parser->table))
    if (!read_long_row (parser, known, names, last, rows, error))
      return NULL;
  return gather (parser, names, rows, error);
}

/* ---- */

static ClothMarkers *
parse (Parser * parser, GError ** error)
{
  g_autoptr (GString) ignored = g_string_new (NULL);
  ClothMarkers units = { 0 }, *markers;

  if (!find_columns (parser, error) ||
      !find_roles (parser, parser->table.cells, &units, ignored, error))
    return NULL;
  markers =
      parser->marker >= 0 ? read_long (parser, error) : read_wide (parser,
      error);
  if (!markers)
    return NULL;
  if (units.unit_m > 0)
    markers->unit_m = units.unit_m;
  if (ignored->len > 0)
    markers->ignored = g_strdup (ignored->str);
  if (markers->times && parser->time >= 0) {
    const gdouble scale =
        g_array_index (parser->columns, Column, parser->time).scale;

    for (guint i = 0; scale > 0 && i < markers->n_frames; i++)
      markers->times[i] *= scale;
  }
  return markers;
}

/* @text: a table, with a zero behind; it is changed
 * @size: its bytes
 * @error: #ClothFileError
 *
 * Cells are parted by commas, semicolons, tabs or spaces; with another than the comma, numbers
 * may have a decimal comma.
 *
 * Returns: (transfer full): the recording, or %NULL
 */
ClothMarkers *
cloth_markers_parse_csv (gchar * text, gsize size, GError ** error)
{
  Parser parser = {.columns = g_array_new (FALSE, TRUE, sizeof (Column)) };
  ClothMarkers *markers = NULL;

  if (memchr (text, 0, size)) {
    cloth_file_invalid (error,
        "this is no table of text; CSV in UTF-8 is read, and .c3d, .npy, .obj, "
        ".ply and .pc2 by their endings");
    g_array_unref (parser.columns);
    return NULL;
  }
  g_array_set_clear_func (parser.columns, column_clear);
  parser.table.end = text + size;
  /* the mark that some programs begin UTF-8 with */
  parser.table.text = g_str_has_prefix (text, "\xef\xbb\xbf") ? text + 3 : text;
  parser.table.separator = find_separator (text, size);
  parser.table.cells = g_ptr_array_new ();
  markers = parse (&parser, error);
  g_ptr_array_unref (parser.table.cells);
  g_array_unref (parser.columns);
  g_clear_pointer (&parser.rows, g_ptr_array_unref);
  return markers;
}
