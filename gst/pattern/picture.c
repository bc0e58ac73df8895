/* Any printed cloth: limits, reading and writing pattern.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/file/jsonwriter.h"
#include "gst/file/output.h"
#include "gst/pattern/patternjson.h"

/* Sizes of cloth beyond these are a mistake of the unit. */
#define MIN_METRES 1e-6
#define MAX_METRES 1000.0

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

/* @pattern: a pattern
 * @error: return location
 *
 * Checks every limit: a name of a picture, sizes from a micrometre to a kilometre,
 * %CLOTH_PICTURE_PATTERN_MIN to %CLOTH_PICTURE_PATTERN_MAX vertices each way and
 * %CLOTH_PICTURE_PATTERN_MAX_VERTICES in all, one side or two. The picture itself is not
 * looked at.
 *
 * Returns: %TRUE when @pattern is sound, else %FALSE with %CLOTH_PATTERN_ERROR_VALUE
 */
gboolean
cloth_picture_pattern_check (const ClothPicturePattern * pattern,
    GError ** error)
{
  if (!pattern->reference || !*pattern->reference)
    return refuse (error, "there is no reference: name the picture file that "
        "shows the cloth flat");
  for (gint i = 0; i < 2; i++) {
    if (!(pattern->cloth_m[i] >= MIN_METRES
            && pattern->cloth_m[i] <= MAX_METRES))
      return refuse (error, "cloth_m has %g: give the width and height of the "
          "cloth that the picture shows in metres, from %g to %g",
          pattern->cloth_m[i], MIN_METRES, MAX_METRES);
  }
  if (pattern->columns < CLOTH_PICTURE_PATTERN_MIN
      || pattern->columns > CLOTH_PICTURE_PATTERN_MAX
      || pattern->rows < CLOTH_PICTURE_PATTERN_MIN
      || pattern->rows > CLOTH_PICTURE_PATTERN_MAX)
    return refuse (error, "a grid of %d by %d vertices: use %d to %d each way",
        pattern->columns, pattern->rows, CLOTH_PICTURE_PATTERN_MIN,
        CLOTH_PICTURE_PATTERN_MAX);
  if (pattern->columns * pattern->rows > CLOTH_PICTURE_PATTERN_MAX_VERTICES)
    return refuse (error, "a grid of %d by %d vertices: use at most %d in all",
        pattern->columns, pattern->rows, CLOTH_PICTURE_PATTERN_MAX_VERTICES);
  if (pattern->sides != 1 && pattern->sides != 2)
    return refuse (error, "%d sides: give 1, or 2 where the print shows "
        "through or is on both sides", pattern->sides);
  return TRUE;
}

/* As many vertices as make cells of about 20 mm. */
static gint
default_vertices (gdouble metres)
{
  const gdouble cells = metres / CLOTH_PICTURE_PATTERN_CELL;

  /* a size out of its limits is refused later */
  return cells >= 1 ? 1 + (gint) MIN (round (cells),
      CLOTH_PICTURE_PATTERN_MAX - 1) : CLOTH_PICTURE_PATTERN_MIN;
}

/* @reference: (type filename): the flat picture
 * @cloth_m: width and height of the cloth that it shows, metres
 * @columns: of the grid's vertices; 0: cells as near to %CLOTH_PICTURE_PATTERN_CELL as whole
 *   ones get
 * @rows: of the same
 * @sides: 1 or 2
 * @error: return location
 *
 * Returns: (transfer full): the pattern; free with cloth_picture_pattern_free(). %NULL with
 *   %CLOTH_PATTERN_ERROR_VALUE when a number is outside its limits
 */
ClothPicturePattern *
cloth_picture_pattern_new (const gchar * reference, const gdouble cloth_m[2],
    gint columns, gint rows, gint sides, GError ** error)
{
  g_autoptr (ClothPicturePattern) pattern = g_new0 (ClothPicturePattern, 1);

  pattern->reference = g_strdup (reference);
  pattern->cloth_m[0] = cloth_m[0];
  pattern->cloth_m[1] = cloth_m[1];
  pattern->columns = columns ? columns : default_vertices (cloth_m[0]);
  pattern->rows = rows ? rows : default_vertices (cloth_m[1]);
  pattern->sides = sides;
  return cloth_picture_pattern_check (pattern,
      error) ? g_steal_pointer (&pattern) : NULL;
}

/* @pattern: (nullable) (transfer full): a pattern
 */
void
cloth_picture_pattern_free (ClothPicturePattern * pattern)
{
  if (!pattern)
    return;
  g_free (pattern->reference);
  g_free (pattern);
}

/* @pattern: a sound pattern
 * @edge_m: (out): from a vertex to the next one along u and along v, metres
 */
void
cloth_picture_pattern_get_edges (const ClothPicturePattern * pattern,
    gdouble edge_m[2])
{
  edge_m[0] = pattern->cloth_m[0] / (pattern->columns - 1);
  edge_m[1] = pattern->cloth_m[1] / (pattern->rows - 1);
}

/* --- reading ------------------------------------------------------------------ */

static gboolean
read_size (JsonObject * object, gdouble cloth_m[2], GError ** error)
{
  gboolean bad;
  JsonArray *list =
      cloth_json_get_list (&cloth_pattern_json, object, "cloth_m", 2,
      &bad, error);

  if (bad)
    return FALSE;
  if (!list)
    return cloth_json_invalid (&cloth_pattern_json, error,
        "a picture without a size: give “cloth_m”, the width and height of "
        "the cloth that it shows, in metres");
  if (json_array_get_length (list) != 2
      || !cloth_json_number (json_array_get_element (list, 0), &cloth_m[0])
      || !cloth_json_number (json_array_get_element (list, 1), &cloth_m[1]))
    return cloth_json_invalid (&cloth_pattern_json, error,
        "“cloth_m” must be a list of two numbers, metres");
  return TRUE;
}

static gboolean
read_picture (JsonObject * object, ClothPicturePattern * pattern,
    GError ** error)
{
  guint columns, rows, sides = 1;

  if (!cloth_json_get_string (&cloth_pattern_json, object, "reference",
          &pattern->reference, error))
    return FALSE;
  if (!pattern->reference || !*pattern->reference)
    return cloth_json_invalid (&cloth_pattern_json, error, "there is no "
        "“reference”: name the picture file that shows the cloth flat");
  if (!read_size (object, pattern->cloth_m, error)
      || !cloth_json_get_count (&cloth_pattern_json, object, "columns",
          CLOTH_PICTURE_PATTERN_MIN, CLOTH_PICTURE_PATTERN_MAX, &columns, error)
      || !cloth_json_get_count (&cloth_pattern_json, object, "rows",
          CLOTH_PICTURE_PATTERN_MIN, CLOTH_PICTURE_PATTERN_MAX, &rows, error)
      || (cloth_json_find (object, "sides")
          && !cloth_json_get_count (&cloth_pattern_json, object, "sides", 1, 2,
              &sides, error)))
    return FALSE;
  pattern->columns = (gint) columns;
  pattern->rows = (gint) rows;
  pattern->sides = (gint) sides;
  return cloth_picture_pattern_check (pattern, error);
}

/* @data: (array length=size): the text of a pattern.json, not ended by 0
 * @size: its bytes
 * @error: return location
 *
 * Reads a pattern from memory. Keys: `version` (1; may be missing), `pattern`
 * ("picture"), `reference` (a file name), `cloth_m`, `columns`, `rows` and `sides` (1, the
 * default, or 2). Other keys are an error.
 *
 * Returns: (transfer full): the pattern, whose reference is the name as it was written, or
 *   %NULL with a #ClothPatternError
 */
ClothPicturePattern *
cloth_picture_pattern_load_data (const gchar * data, gsize size,
    GError ** error)
{
  static const gchar *const keys[] = { "version", "pattern", "reference",
    "cloth_m", "columns", "rows", "sides", NULL
  };
  static const ClothPatternKind kind =
      { "picture", "a printed picture is", "a printed picture", keys };
  g_autoptr (JsonParser) parser = NULL;
  g_autoptr (ClothPicturePattern) pattern = NULL;
  JsonObject *object;

  parser = cloth_pattern_json_open (&kind, data, size, &object, error);
  if (!parser)
    return NULL;
  pattern = g_new0 (ClothPicturePattern, 1);
  if (!read_picture (object, pattern, error))
    return NULL;
  return g_steal_pointer (&pattern);
}

/* @path: (type filename): a pattern.json
 * @error: return location
 *
 * Reads a pattern; see cloth_picture_pattern_load_data() for what the file holds. The
 * picture must lie in the file's folder or below. The error's message begins with @path.
 *
 * Returns: (transfer full): the pattern, whose reference can be opened from where the
 *   program runs, or %NULL with a #ClothPatternError, #ClothFileError or #GIOErrorEnum when
 *   there is no such picture or it lies elsewhere, #ClothFileError when the file is too
 *   large, or #GFileError
 */
ClothPicturePattern *
cloth_picture_pattern_load (const gchar * path, GError ** error)
{
  g_autofree gchar *data = NULL, *folder = NULL, *reference = NULL;
  g_autoptr (ClothPicturePattern) pattern = NULL;
  gsize size;

  if (!(data = cloth_text_file_load (path, &size, error)))
    return NULL;
  folder = g_path_get_dirname (path);
  pattern = cloth_picture_pattern_load_data (data, size, error);
  if (pattern)
    reference = cloth_path_inside (folder, pattern->reference, error);
  if (!reference) {
    g_prefix_error (error, "%s: ", path);
    return NULL;
  }
  g_free (pattern->reference);
  pattern->reference = g_steal_pointer (&reference);
  return g_steal_pointer (&pattern);
}

/* --- writing ------------------------------------------------------------------ */

/* @pattern: a sound pattern
 *
 * Returns: (transfer full): the text of its pattern.json, with the reference as it stands;
 *   equal patterns give equal bytes and every number reads back as it was
 */
gchar *
cloth_picture_pattern_to_json (const ClothPicturePattern * pattern)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();

  cloth_json_writer_set_exact (writer);
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_count (writer, "version", 1);
  cloth_json_writer_string (writer, "pattern", "picture");
  cloth_json_writer_string (writer, "reference", pattern->reference);
  cloth_json_writer_numbers (writer, "cloth_m", pattern->cloth_m, 2);
  cloth_json_writer_count (writer, "columns", (guint64) pattern->columns);
  cloth_json_writer_count (writer, "rows", (guint64) pattern->rows);
  cloth_json_writer_count (writer, "sides", (guint64) pattern->sides);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

/* @reference as it is called from @path's folder: %NULL when it is no file there or below. */
static gchar *
name_from (const gchar * path, const gchar * reference)
{
  g_autofree gchar *folder = g_path_get_dirname (path);
  char *root = realpath (folder, NULL), *real = realpath (reference, NULL);
  gchar *name = NULL;

  if (root && real) {
    const gsize length = strcmp (root, "/") ? strlen (root) : 0;

    if (!strncmp (real, root, length) && real[length] == '/')
      name = g_strdup (real + length + 1);
  }
  free (root);
  free (real);
  return name;
}

/* @pattern: a pattern
 * @path: (type filename): where to; the reference must be a file in the same folder or below
 * @error: return location
 *
 * Writes pattern.json, which names the reference from its own folder, so that the folder can
 * be moved; the file appears whole or not at all.
 *
 * Returns: %FALSE with %CLOTH_PATTERN_ERROR_VALUE or a #GIOErrorEnum
 */
gboolean
cloth_picture_pattern_save (const ClothPicturePattern * pattern,
    const gchar * path, GError ** error)
{
  ClothPicturePattern moved = *pattern;
  g_autofree gchar *name = NULL, *text = NULL;

  if (!cloth_picture_pattern_check (pattern, error))
    return FALSE;
  name = name_from (path, pattern->reference);
  if (!name || !g_utf8_validate (name, -1, NULL) || strstr (name, ".."))
    return refuse (error, "%s: no pattern in %s can name it; put the picture "
        "into that folder", pattern->reference, path);
  moved.reference = name;
  text = cloth_picture_pattern_to_json (&moved);
  return cloth_file_write_text (path, text, error);
}
