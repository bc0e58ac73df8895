/* Colour-coded dots: arrays of them, limits, reading and writing pattern.json.
 *
 * In an M-array every window of 3 by 3 dots differs from every other, however it is
 * turned. The eight neighbours of a window's centre are a ring; turning the ring by one
 * place is a turn by 45 degrees, which is how oblique views shear the lattice. A window is
 * a word: three bits for each colour of the ring, then three for the centre.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/marray.h"

#include <math.h>
#include <string.h>

#include "gst/file/jsonwriter.h"
#include "gst/file/output.h"
#include "gst/math/random.h"
#include "gst/pattern/patternjson.h"

/* Sizes of cloth beyond these are a mistake of the unit. */
#define MIN_METRES 1e-6
#define MAX_METRES 1000.0
/* Smaller dots, of their pitch, no camera sees that sees several. */
#define LEAST_DIAMETER 0.01
/* Rounding of decimal sizes that should add up exactly. */
#define SLACK 1e-9

#define WINDOW_DOTS 9
#define RING_DOTS 8
#define SYMBOL_BITS 3
#define SYMBOL_MASK 7u
#define RING_MASK 0xffffffu
#define MAX_FORMS 16
#define WORDS (1u << (WINDOW_DOTS * SYMBOL_BITS))
/* Colours tried, for each dot, before the search starts afresh. */
#define TRIES_PER_DOT 64
/* Words looked at in all before the search is given up: about a second. */
#define MAX_LOOK_UPS 60000000

/* The paper's five as they were printed for the project's own films, then those that
 * lie farthest from them. */
static const ClothDotColour default_colours[CLOTH_M_ARRAY_MAX_COLOURS] = {
  {"cyan", {40, 165, 215}}, {"magenta", {205, 40, 120}},
  {"yellow", {235, 215, 40}}, {"orange", {235, 120, 25}},
  {"green", {45, 160, 60}}, {"white", {235, 235, 235}},
  {"blue", {60, 70, 200}}, {"red", {205, 30, 30}}
};

/* *INDENT-OFF* */
static gboolean refuse (GError ** error, const gchar * format, ...)
    G_GNUC_PRINTF (2, 3);
/* *INDENT-ON* */

static gboolean
refuse (GError ** error, const gchar * format, ...)
{
  va_list arguments;

  va_start (arguments, format);
  if (error)
    *error = g_error_new_valist (CLOTH_PATTERN_ERROR,
        CLOTH_PATTERN_ERROR_VALUE, format, arguments);
  va_end (arguments);
  return FALSE;
}

typedef struct
{
  gint columns, rows, n_colours, distance;
  gint n_forms;                 /* 8 turns, twice when mirrored ones count */
  guint8 *matrix;
  guint32 *used;                /* a bit for each word: all forms of all windows */
  gint64 look_ups;              /* how many are left */
} Search;

static gboolean
is_used (const Search * search, guint32 word)
{
  return search->used[word / 32] >> (word % 32) & 1;
}

/* The window whose last dot is (@column, @row). */
static guint32
window_word (const Search * search, gint column, gint row)
{
  static const gint8 ring[RING_DOTS][2] = { {-2, -2}, {-1, -2}, {0, -2},
  {0, -1}, {0, 0}, {-1, 0}, {-2, 0}, {-2, -1}
  };
  const guint8 *last = search->matrix + row * search->columns + column;
  guint32 word = last[-search->columns - 1];

  for (gint i = 0; i < RING_DOTS; i++)
    word = word << SYMBOL_BITS
        | last[ring[i][1] * search->columns + ring[i][0]];
  return word;
}

/* @word as it looks after each turn, then the same of its mirror image. */
static void
turn_word (guint32 word, gint n_forms, guint32 forms[MAX_FORMS])
{
  const guint32 centre = word & ~RING_MASK;
  guint32 ring = word & RING_MASK;

  for (gint n = 0; n < n_forms; n++) {
    if (n == RING_DOTS) {
      guint32 mirrored = 0;

      for (gint i = 0; i < RING_DOTS; i++)
        mirrored = mirrored << SYMBOL_BITS
            | (ring >> (i * SYMBOL_BITS) & SYMBOL_MASK);
      ring = mirrored;
    }
    forms[n] = centre | ring;
    ring = (ring << SYMBOL_BITS
        | ring >> ((RING_DOTS - 1) * SYMBOL_BITS)) & RING_MASK;
  }
}

static gint
word_distance (guint32 a, guint32 b)
{
  guint32 x = a ^ b;

  /* One bit for each symbol that differs: the lowest bits of 9 symbols, in octal. */
  return __builtin_popcount ((x | x >> 1 | x >> 2) & 0111111111u);
}

/* Is there a used word that differs from @word in at most @changes of the symbols from
 * @first on? */
static gboolean
is_near_used (Search * search, guint32 word, gint first, gint changes)
{
  search->look_ups--;
  if (is_used (search, word))
    return TRUE;
  for (gint i = first; changes > 0 && i < WINDOW_DOTS; i++) {
    const gint shift = i * SYMBOL_BITS;
    const guint32 symbol = word >> shift & SYMBOL_MASK;

    for (guint32 other = 0; other < (guint32) search->n_colours; other++) {
      if (other != symbol && is_near_used (search,
              (word & ~(SYMBOL_MASK << shift)) | other << shift, i + 1,
              changes - 1))
        return TRUE;
    }
  }
  return FALSE;
}

/* Marks or frees all forms of the window that the dot (@column, @row) completes. */
static void
flip_window (Search * search, gint column, gint row)
{
  guint32 forms[MAX_FORMS] = { 0 };

  if (column < 2 || row < 2)
    return;
  turn_word (window_word (search, column, row), search->n_forms, forms);
  for (gint n = 0; n < search->n_forms; n++)
    search->used[forms[n] / 32] ^= 1u << (forms[n] % 32);
}

/* FALSE when the window that the dot completes would be too near to one that is there
 * or to itself turned. */
static gboolean
add_window (Search * search, gint column, gint row)
{
  guint32 forms[MAX_FORMS] = { 0 };

  if (column < 2 || row < 2)
    return TRUE;
  turn_word (window_word (search, column, row), search->n_forms, forms);
  search->look_ups -= search->n_forms;
  for (gint n = 1; n < search->n_forms; n++) {
    if (word_distance (forms[0], forms[n]) < search->distance)
      return FALSE;
  }
  if (is_near_used (search, forms[0], 0, search->distance - 1))
    return FALSE;
  flip_window (search, column, row);
  return TRUE;
}

/* Dot after dot in reading order: a random colour, else the next ones, else back. */
static gboolean
search_matrix (Search * search, ClothRandom * random)
{
  const gint n_dots = search->columns * search->rows;
  const gint columns = search->columns;
  g_autofree guint8 *tried = g_malloc0 ((gsize) n_dots);
  gint tries = n_dots * TRIES_PER_DOT, n = 0;

  while (n >= 0 && n < n_dots && tries-- > 0 && search->look_ups-- > 0) {
    if (tried[n] == search->n_colours) {
      tried[n--] = 0;
      if (n >= 0)
        flip_window (search, n % columns, n / columns);
      continue;
    }
    search->matrix[n] = (guint8) (tried[n]++
        ? (search->matrix[n] + 1) % search->n_colours
        : (gint) cloth_random_below (random, (guint) search->n_colours));
    if (add_window (search, n % columns, n / columns))
      n++;
  }
  if (n == n_dots)
    return TRUE;
  while (n-- > 0)
    flip_window (search, n % columns, n / columns);
  return FALSE;
}

static gboolean
refuse_number (GError ** error, const gchar * what, gint value, gint least,
    gint most)
{
  return refuse (error, "%d %s: an M-array takes %d to %d", value, what, least,
      most);
}

/* Words of 9 symbols at a distance of d are told apart by any 10 − d of their symbols
 * (Singleton's bound), so there are at most colours^(10 − d) of them. */
static gboolean
check_room (const Search * search, GError ** error)
{
  const gint64 windows = (gint64) (search->columns - 2) * (search->rows - 2);
  gint64 words = 1, most;

  for (gint i = 0; i < WINDOW_DOTS + 1 - search->distance; i++)
    words *= search->n_colours;
  most = words / search->n_forms;
  if (windows <= most)
    return TRUE;
  return refuse (error,
      "%d by %d dots have %" G_GINT64_FORMAT " windows of 3 by 3, but %d "
      "colours at a distance of %d give at most %" G_GINT64_FORMAT "%s: take "
      "fewer dots, more colours or less distance", search->columns,
      search->rows, windows, search->n_colours, search->distance, most,
      search->n_forms == MAX_FORMS ? " seen from both sides" : "");
}

/* @columns: dots in a row, %CLOTH_M_ARRAY_MIN to %CLOTH_M_ARRAY_MAX
 * @rows: dots in a column
 * @n_colours: 2 to %CLOTH_M_ARRAY_MAX_COLOURS
 * @code: distance, sides, seed
 * @matrix: (out) (array): rows·columns bytes; gets the colours, 0 to @n_colours − 1
 * @error: return location
 *
 * Colours dots so that any 3 by 3 of them tell their place and how they are turned:
 * each window differs by @code's distance from every other and from itself, all in
 * eight turns by 45 degrees (the ring around the centre shifted by a place); two-sided,
 * in their mirror images too. Random colours dot by dot, with back-tracking (Scholz et
 * al. 2005, 3.1, after Morano et al. 1998; windows that equal their own turned self are
 * refused here as well).
 *
 * Returns: %FALSE with %CLOTH_PATTERN_ERROR_VALUE where a number is outside its limits
 *   or no such array can exist, %CLOTH_PATTERN_ERROR_CODE where none was found
 */
gboolean
cloth_m_array_generate (gint columns, gint rows, gint n_colours,
    const ClothMArrayCode * code, guint8 * matrix, GError ** error)
{
  Search search = { columns, rows, n_colours, code->distance,
    code->two_sided ? MAX_FORMS : RING_DOTS, matrix, NULL, MAX_LOOK_UPS
  };
  ClothRandom random;
  gboolean found = FALSE;

  if (columns < CLOTH_M_ARRAY_MIN || columns > CLOTH_M_ARRAY_MAX)
    return refuse_number (error, "columns", columns, CLOTH_M_ARRAY_MIN,
        CLOTH_M_ARRAY_MAX);
  if (rows < CLOTH_M_ARRAY_MIN || rows > CLOTH_M_ARRAY_MAX)
    return refuse_number (error, "rows", rows, CLOTH_M_ARRAY_MIN,
        CLOTH_M_ARRAY_MAX);
  if (n_colours < 2 || n_colours > CLOTH_M_ARRAY_MAX_COLOURS)
    return refuse_number (error, "colours", n_colours, 2,
        CLOTH_M_ARRAY_MAX_COLOURS);
  if (code->distance < 1 || code->distance > CLOTH_M_ARRAY_MAX_DISTANCE)
    return refuse_number (error, "dots of distance", code->distance, 1,
        CLOTH_M_ARRAY_MAX_DISTANCE);
  if (!check_room (&search, error))
    return FALSE;
  search.used = g_new0 (guint32, WORDS / 32);
  cloth_random_init (&random, code->seed);
  while (!found && search.look_ups > 0)
    found = search_matrix (&search, &random);
  g_free (search.used);
  if (!found)
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_CODE,
        "no M-array of %d by %d dots in %d colours at a distance of %d was "
        "found%s: take fewer dots, more colours or less distance", columns,
        rows, n_colours, code->distance,
        code->two_sided ? " for both sides" : "");
  return found;
}

static gboolean
check_sizes (const ClothMArray * array, GError ** error)
{
  const gint dots[2] = { array->columns, array->rows };

  if (!(array->pitch_m >= MIN_METRES && array->pitch_m <= MAX_METRES))
    return refuse (error, "pitch_m is %g: give the distance of the dots' "
        "centres in metres, from %g to %g", array->pitch_m, MIN_METRES,
        MAX_METRES);
  if (!(array->diameter_m >= LEAST_DIAMETER * array->pitch_m
          && array->diameter_m < array->pitch_m))
    return refuse (error, "diameter_m is %g: give the dots' diameter in "
        "metres, at least %g and less than the pitch of %g", array->diameter_m,
        LEAST_DIAMETER * array->pitch_m, array->pitch_m);
  for (gint i = 0; i < 2; i++) {
    const gdouble first = array->origin_uv_m[i] - array->diameter_m / 2;
    const gdouble last = array->origin_uv_m[i]
        + (dots[i] - 1) * array->pitch_m + array->diameter_m / 2;

    if (!(array->cloth_m[i] > 0 && array->cloth_m[i] <= MAX_METRES))
      return refuse (error, "cloth_m has %g: give the width and height of the "
          "cloth in metres, more than 0 and at most %g", array->cloth_m[i],
          MAX_METRES);
    if (!(first >= -SLACK && last <= array->cloth_m[i] + SLACK))
      return refuse (error, "the dots' %s goes from %g m to %g m but the cloth "
          "from 0 to %g m: move origin_uv_m, make the pitch smaller or the "
          "cloth larger", i == 0 ? "width" : "height", first, last,
          array->cloth_m[i]);
  }
  return TRUE;
}

/* Everything but the matrix. */
static gboolean
check_frame (const ClothMArray * array, GError ** error)
{
  if (array->columns < CLOTH_M_ARRAY_MIN || array->columns > CLOTH_M_ARRAY_MAX
      || array->rows < CLOTH_M_ARRAY_MIN || array->rows > CLOTH_M_ARRAY_MAX)
    return refuse (error, "%d by %d dots: use %d to %d each way",
        array->columns, array->rows, CLOTH_M_ARRAY_MIN, CLOTH_M_ARRAY_MAX);
  if (array->n_colours < 2 || array->n_colours > CLOTH_M_ARRAY_MAX_COLOURS)
    return refuse (error, "%d colours: use 2 to %d", array->n_colours,
        CLOTH_M_ARRAY_MAX_COLOURS);
  for (gint i = 0; i < array->n_colours; i++) {
    for (gint j = 0; j < i; j++) {
      if (!strcmp (array->colours[i].name, array->colours[j].name))
        return refuse (error, "two colours are called \"%s\"",
            array->colours[i].name);
      if (!memcmp (array->colours[i].rgb, array->colours[j].rgb, 3))
        return refuse (error, "%s and %s are the same rgb: give the colours as "
            "they are printed", array->colours[j].name, array->colours[i].name);
    }
  }
  return check_sizes (array, error);
}

/* @array: an array
 * @error: return location
 *
 * Checks every limit: %CLOTH_M_ARRAY_MIN to %CLOTH_M_ARRAY_MAX dots each way, 2 to
 * %CLOTH_M_ARRAY_MAX_COLOURS different colours of different names, sizes from a micrometre
 * to a kilometre, dots apart from each other and within the cloth, colours of the matrix among
 * those named and not all the same. Whether windows are unique is not checked: print that has
 * a few twins is still read.
 *
 * Returns: %TRUE when @array is sound, else %FALSE with %CLOTH_PATTERN_ERROR_VALUE
 */
gboolean
cloth_m_array_check (const ClothMArray * array, GError ** error)
{
  const guint8 *matrix = array->matrix;
  gint n, n_alike = 0;

  if (!check_frame (array, error))
    return FALSE;
  n = array->columns * array->rows;
  for (gint i = 0; i < n; i++) {
    if (matrix[i] >= array->n_colours)
      return refuse (error, "the matrix has a colour %d: there are 0 to %d",
          matrix[i], array->n_colours - 1);
    n_alike += matrix[i] == matrix[0];
  }
  if (n_alike == n)
    return refuse (error, "all dots of the matrix are %s: without a second "
        "colour no dot can be told from another",
        array->colours[matrix[0]].name);
  return TRUE;
}

/* @columns: dots in a row
 * @rows: dots in a column
 * @n_colours: how many colours; their names and shades are cyan, magenta, yellow,
 *   orange, green (the paper's), white, blue, red
 * @pitch_m: from the centre of a dot to that of the next, metres
 * @diameter_m: of a dot, metres
 * @margin_m: from the centres of the outer dots to the cloth's edge, metres
 * @code: distance, sides, seed
 * @error: return location
 *
 * A cloth with a new M-array; see cloth_m_array_generate().
 *
 * Returns: (transfer full): the array; free with cloth_m_array_free(). %NULL with
 *   %CLOTH_PATTERN_ERROR_VALUE or %CLOTH_PATTERN_ERROR_CODE
 */
ClothMArray *
cloth_m_array_new (gint columns, gint rows, gint n_colours, gdouble pitch_m,
    gdouble diameter_m, gdouble margin_m, const ClothMArrayCode * code,
    GError ** error)
{
  g_autoptr (ClothMArray) array = g_new0 (ClothMArray, 1);

  *array = (ClothMArray) {
    .columns = columns,.rows = rows,.n_colours = n_colours,.pitch_m =
        pitch_m,.diameter_m = diameter_m,.origin_uv_m = {
      margin_m, margin_m
    },.cloth_m = {
      (columns - 1) * pitch_m + 2 * margin_m,
      (rows - 1) * pitch_m + 2 * margin_m
  }};
  memcpy (array->colours, default_colours, sizeof default_colours);
  array->matrix = g_malloc0 (CLOTH_M_ARRAY_MAX * CLOTH_M_ARRAY_MAX);
  /* The sizes first: the search may take a while. */
  if (!check_frame (array, error)
      || !cloth_m_array_generate (columns, rows, n_colours, code,
          array->matrix, error))
    return NULL;
  return g_steal_pointer (&array);
}

/* @array: (nullable) (transfer full): an array
 */
void
cloth_m_array_free (ClothMArray * array)
{
  if (!array)
    return;
  g_free (array->matrix);
  g_free (array);
}

/* --- reading ------------------------------------------------------------------ */

/* Whole numbers from 0 to @most, @n of them, from item @i of @list. */
static gboolean
read_bytes (JsonArray * list, guint i, const gchar * key, guint n, guint most,
    guint8 * values, GError ** error)
{
  JsonNode *item = json_array_get_element (list, i);
  JsonArray *row = JSON_NODE_HOLDS_ARRAY (item)
      ? json_node_get_array (item) : NULL;

  if (!row || json_array_get_length (row) != n)
    return cloth_json_invalid (&cloth_pattern_json, error,
        "item %u of “%s” must be a list of %u whole numbers from 0 to %u",
        i, key, n, most);
  for (guint k = 0; k < n; k++) {
    gdouble number;

    if (!cloth_json_number (json_array_get_element (row, k), &number)
        || number != floor (number) || number < 0 || number > most)
      return cloth_json_invalid (&cloth_pattern_json, error,
          "item %u of “%s” must be a list of %u whole numbers from 0 to %u",
          i, key, n, most);
    values[k] = (guint8) number;
  }
  return TRUE;
}

/* A list that must be there with @n items; with @n 0, with 2 to the most colours. */
static JsonArray *
read_list (JsonObject * object, const gchar * key, guint n, GError ** error)
{
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&cloth_pattern_json, object, key,
      CLOTH_M_ARRAY_MAX, &bad, error);
  guint length = list ? json_array_get_length (list) : 0;

  if (bad)
    return NULL;
  if (n == 0 && (length < 2 || length > CLOTH_M_ARRAY_MAX_COLOURS)) {
    cloth_json_invalid (&cloth_pattern_json, error,
        "“%s” must be a list of 2 to %d names", key,
        CLOTH_M_ARRAY_MAX_COLOURS);
    return NULL;
  }
  if (n > 0 && length != n) {
    cloth_json_invalid (&cloth_pattern_json, error,
        "“%s” must be a list of %u items, not %u", key, n, length);
    return NULL;
  }
  return list;
}

static gboolean
read_colours (JsonObject * object, ClothMArray * array, GError ** error)
{
  JsonArray *names = read_list (object, "colours", 0, error), *rgb;

  if (!names)
    return FALSE;
  array->n_colours = (gint) json_array_get_length (names);
  if (!(rgb = read_list (object, "rgb", (guint) array->n_colours, error)))
    return FALSE;
  for (guint i = 0; i < (guint) array->n_colours; i++) {
    JsonNode *item = json_array_get_element (names, i);
    const gchar *name = NULL;

    if (JSON_NODE_HOLDS_VALUE (item)
        && json_node_get_value_type (item) == G_TYPE_STRING)
      name = json_node_get_string (item);
    if (!name || !*name || strlen (name) >= sizeof array->colours[i].name)
      return cloth_json_invalid (&cloth_pattern_json, error,
          "item %u of “colours” must be a name of 1 to %u bytes", i,
          (guint) sizeof array->colours[i].name - 1);
    g_strlcpy (array->colours[i].name, name, sizeof array->colours[i].name);
    if (!read_bytes (rgb, i, "rgb", 3, 255, array->colours[i].rgb, error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
read_pair (JsonObject * object, const gchar * key, gdouble pair[2],
    GError ** error)
{
  JsonArray *list = read_list (object, key, 2, error);

  if (!list)
    return FALSE;
  if (!cloth_json_number (json_array_get_element (list, 0), &pair[0])
      || !cloth_json_number (json_array_get_element (list, 1), &pair[1]))
    return cloth_json_invalid (&cloth_pattern_json, error,
        "“%s” must be a list of two numbers, metres", key);
  return TRUE;
}

static gboolean
read_array (JsonObject * object, ClothMArray * array, GError ** error)
{
  guint columns, rows;
  JsonArray *matrix;

  if (!read_colours (object, array, error)
      || !cloth_json_get_count (&cloth_pattern_json, object, "columns",
          CLOTH_M_ARRAY_MIN, CLOTH_M_ARRAY_MAX, &columns, error)
      || !cloth_json_get_count (&cloth_pattern_json, object, "rows",
          CLOTH_M_ARRAY_MIN, CLOTH_M_ARRAY_MAX, &rows, error)
      || !cloth_json_get_number (&cloth_pattern_json, object, "pitch_m", 0,
          MAX_METRES, &array->pitch_m, error)
      || !cloth_json_get_number (&cloth_pattern_json, object, "diameter_m", 0,
          MAX_METRES, &array->diameter_m, error)
      || !read_pair (object, "origin_uv_m", array->origin_uv_m, error)
      || !read_pair (object, "cloth_m", array->cloth_m, error)
      || !(matrix = read_list (object, "matrix", rows, error)))
    return FALSE;
  array->columns = (gint) columns;
  array->rows = (gint) rows;
  array->matrix = g_malloc0 ((gsize) columns * rows);
  for (guint row = 0; row < rows; row++) {
    if (!read_bytes (matrix, row, "matrix", columns,
            (guint) array->n_colours - 1, array->matrix + row * columns, error))
      return FALSE;
  }
  return cloth_m_array_check (array, error);
}

/* @data: (array length=size): the text of a pattern.json, not ended by 0
 * @size: its bytes
 * @error: return location
 *
 * Reads an M-array from memory. Keys: `version` (1; may be missing), `pattern`
 * ("m-array"), `colours` (names), `rgb` (a list of three for each), `pitch_m`,
 * `diameter_m`, `origin_uv_m`, `cloth_m`, `columns`, `rows` and `matrix`, a list of
 * colours for each row. Other keys are an error.
 *
 * Returns: (transfer full): the array, or %NULL with a #ClothPatternError
 */
ClothMArray *
cloth_m_array_load_data (const gchar * data, gsize size, GError ** error)
{
  static const gchar *const keys[] = { "version", "pattern", "colours", "rgb",
    "pitch_m", "diameter_m", "origin_uv_m", "cloth_m", "columns", "rows",
    "matrix", NULL
  };
  static const ClothPatternKind kind =
      { "m-array", "dots are", "an M-array", keys };
  g_autoptr (JsonParser) parser = NULL;
  g_autoptr (ClothMArray) array = NULL;
  JsonObject *object;

  parser = cloth_pattern_json_open (&kind, data, size, &object, error);
  if (!parser)
    return NULL;
  array = g_new0 (ClothMArray, 1);
  if (!read_array (object, array, error))
    return NULL;
  return g_steal_pointer (&array);
}

/* @path: (type filename): a pattern.json
 * @error: return location
 *
 * Reads an M-array; see cloth_m_array_load_data() for what the file holds. The error's
 * message begins with @path.
 *
 * Returns: (transfer full): the array, or %NULL with a #ClothPatternError,
 *   #ClothFileError when the file is too large, or #GFileError
 */
ClothMArray *
cloth_m_array_load (const gchar * path, GError ** error)
{
  g_autofree gchar *data = NULL;
  ClothMArray *array;
  gsize size;

  if (!(data = cloth_text_file_load (path, &size, error)))
    return NULL;
  array = cloth_m_array_load_data (data, size, error);
  if (!array)
    g_prefix_error (error, "%s: ", path);
  return array;
}

/* --- writing ------------------------------------------------------------------ */

static void
put_bytes (ClothJsonWriter * writer, const guint8 * values, gint n)
{
  gdouble numbers[CLOTH_M_ARRAY_MAX];

  for (gint i = 0; i < n; i++)
    numbers[i] = values[i];
  cloth_json_writer_numbers (writer, NULL, numbers, (gsize) n);
}

/* @array: a sound array
 *
 * Returns: (transfer full): the text of its pattern.json; equal arrays give equal bytes
 *   and every number reads back as it was
 */
gchar *
cloth_m_array_to_json (const ClothMArray * array)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();

  cloth_json_writer_set_exact (writer);
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_count (writer, "version", 1);
  cloth_json_writer_string (writer, "pattern", "m-array");
  cloth_json_writer_begin_array (writer, "colours");
  for (gint i = 0; i < array->n_colours; i++)
    cloth_json_writer_string (writer, NULL, array->colours[i].name);
  cloth_json_writer_end_array (writer);
  cloth_json_writer_begin_array (writer, "rgb");
  for (gint i = 0; i < array->n_colours; i++)
    put_bytes (writer, array->colours[i].rgb, 3);
  cloth_json_writer_end_array (writer);
  cloth_json_writer_number (writer, "pitch_m", array->pitch_m);
  cloth_json_writer_number (writer, "diameter_m", array->diameter_m);
  cloth_json_writer_numbers (writer, "origin_uv_m", array->origin_uv_m, 2);
  cloth_json_writer_numbers (writer, "cloth_m", array->cloth_m, 2);
  cloth_json_writer_count (writer, "columns", (guint64) array->columns);
  cloth_json_writer_count (writer, "rows", (guint64) array->rows);
  cloth_json_writer_begin_array (writer, "matrix");
  for (gint row = 0; row < array->rows; row++)
    put_bytes (writer, array->matrix + row * array->columns, array->columns);
  cloth_json_writer_end_array (writer);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

/* @array: an array
 * @path: (type filename): where to
 * @error: return location
 *
 * Writes pattern.json; the file appears whole or not at all.
 *
 * Returns: %FALSE with %CLOTH_PATTERN_ERROR_VALUE or a #GIOErrorEnum
 */
gboolean
cloth_m_array_save (const ClothMArray * array, const gchar * path,
    GError ** error)
{
  g_autofree gchar *text = NULL;

  if (!cloth_m_array_check (array, error))
    return FALSE;
  text = cloth_m_array_to_json (array);
  return cloth_file_write_text (path, text, error);
}
