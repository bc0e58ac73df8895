/* Wavefront OBJ: one mesh with its uv.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/obj.h"

#include "gst/mesh/formats/export.h"

#include <math.h>
#include <string.h>

#define NO_UV G_MAXUINT32

typedef struct
{
  const gchar *at, *end;        /* a 0 byte, the only one, stands at the end */
  guint line;
  GArray *positions;            /* gfloat, 3 a vertex */
  GArray *uv;                   /* gfloat, 2 each */
  GArray *faces;                /* guint32, 4 a face */
  GArray *face_uv;              /* guint32, index into uv for each corner */
  GArray *corners;              /* guint32, vertex and uv of the line's polygon */
  ClothMeshNote note;
} Parser;

static gboolean
invalid (Parser * parser, const gchar * what, GError ** error)
{
  return cloth_file_invalid (error,
      "line %u of the OBJ file: %s", parser->line, what);
}

static gboolean
too_many (Parser * parser, GError ** error)
{
  g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
      "line %u of the OBJ file: more than %u vertices or %u faces",
      parser->line, CLOTH_MAX_VERTICES, CLOTH_MAX_FACES);
  return FALSE;
}

/* Blanks within a line; a backslash before the line's end joins the next one. */
static void
skip_blanks (Parser * parser)
{
  for (;; parser->at++) {
    if (*parser->at == ' ' || *parser->at == '\t' || *parser->at == '\r')
      continue;
    if (*parser->at == '\\' && (parser->at[1] == '\n' ||
            (parser->at[1] == '\r' && parser->at[2] == '\n'))) {
      parser->at += parser->at[1] == '\r' ? 2 : 1;
      parser->line++;
      continue;
    }
    break;
  }
}

static gboolean
at_line_end (Parser * parser)
{
  return *parser->at == 0 || *parser->at == '\n' || *parser->at == '#';
}

static void
skip_line (Parser * parser)
{
  const gchar *end =
      memchr (parser->at, '\n', (gsize) (parser->end - parser->at));

  parser->at = end ? end + 1 : parser->end;
  parser->line++;
}

static gboolean
take_floats (Parser * parser, GArray * array, guint n, GError ** error)
{
  for (guint i = 0; i < n; i++) {
    gchar *end;
    gdouble value;
    gfloat number;

    skip_blanks (parser);
    if (at_line_end (parser))
      return invalid (parser, "a coordinate is missing", error);
    value = g_ascii_strtod (parser->at, &end);
    number = (gfloat) value;
    if (end == parser->at || !isfinite (number))
      return invalid (parser, "a coordinate is no finite number", error);
    parser->at = end;
    g_array_append_val (array, number);
  }
  return TRUE;
}

/* An index counts from 1, or backwards from the last one so far. */
static gboolean
take_index (Parser * parser, guint so_far, guint32 * index, GError ** error)
{
  gboolean negative = FALSE;
  guint64 n = 0;
  const gchar *start;

  if (*parser->at == '-') {
    negative = TRUE;
    parser->at++;
  }
  start = parser->at;
  while (g_ascii_isdigit (*parser->at) && n < G_MAXUINT32)
    n = n * 10 + (guint64) (*parser->at++ - '0');
  if (parser->at == start)
    return invalid (parser, "an index of the face is no whole number", error);
  if (n == 0 || n >= G_MAXUINT32 || (negative && n > so_far))
    return invalid (parser, "an index of the face is out of range", error);
  *index = (guint32) (negative ? so_far - n : n - 1);
  return TRUE;
}

/* v, v/vt, v//vn or v/vt/vn */
static gboolean
take_corner (Parser * parser, GError ** error)
{
  guint n_vertices = parser->positions->len / 3;
  guint n_uv = parser->uv->len / 2;
  guint32 corner[2] = { 0, NO_UV }, normal;

  if (!take_index (parser, n_vertices, &corner[0], error))
    return FALSE;
  if (*parser->at == '/') {
    parser->at++;
    if (*parser->at != '/' && !take_index (parser, n_uv, &corner[1], error))
      return FALSE;
    if (*parser->at == '/') {
      parser->at++;
      if (!take_index (parser, G_MAXUINT32, &normal, error))
        return FALSE;
    }
  }
  if (!at_line_end (parser) && !g_ascii_isspace (*parser->at) &&
      *parser->at != '\\')
    return invalid (parser, "a corner of the face cannot be read", error);
  g_array_append_vals (parser->corners, corner, 2);
  return TRUE;
}

static void
add_face (Parser * parser, guint a, guint b, guint c, guint d)
{
  const guint32 *corners = (const guint32 *) parser->corners->data;
  gboolean quad = d != 0;
  guint32 vertices[4] = { corners[2 * a], corners[2 * b], corners[2 * c],
    quad ? corners[2 * d] : CLOTH_NO_VERTEX
  };
  guint32 uv[4] = { corners[2 * a + 1], corners[2 * b + 1], corners[2 * c + 1],
    quad ? corners[2 * d + 1] : NO_UV
  };

  g_array_append_vals (parser->faces, vertices, 4);
  g_array_append_vals (parser->face_uv, uv, 4);
}

static gboolean
take_face (Parser * parser, GError ** error)
{
  guint n;

  g_array_set_size (parser->corners, 0);
  for (;;) {
    skip_blanks (parser);
    if (at_line_end (parser))
      break;
    if (!take_corner (parser, error))
      return FALSE;
  }
  n = parser->corners->len / 2;
  if (n < 3)
    return invalid (parser, "a face needs three corners", error);
  if (parser->faces->len / 4 + n > CLOTH_MAX_FACES)
    return too_many (parser, error);
  if (n == 4) {
    add_face (parser, 0, 1, 2, 3);
  } else {
    for (guint i = 1; i + 1 < n; i++)
      add_face (parser, 0, i, i + 1, 0);
  }
  return TRUE;
}

static gboolean
keyword (Parser * parser, const gchar * word)
{
  gsize n = strlen (word);

  if (strncmp (parser->at, word, n) != 0 ||
      (parser->at[n] != ' ' && parser->at[n] != '\t'))
    return FALSE;
  parser->at += n;
  return TRUE;
}

static gboolean
take_line (Parser * parser, GError ** error)
{
  skip_blanks (parser);
  if (keyword (parser, "v")) {
    if (parser->positions->len / 3 >= CLOTH_MAX_VERTICES)
      return too_many (parser, error);
    return take_floats (parser, parser->positions, 3, error);
  }
  if (keyword (parser, "vt")) {
    if (parser->uv->len / 2 >= 4 * CLOTH_MAX_FACES)
      return too_many (parser, error);
    return take_floats (parser, parser->uv, 2, error);
  }
  if (keyword (parser, "f"))
    return take_face (parser, error);
  if (*parser->at == '#')
    cloth_mesh_note_parse (parser->at + 1, &parser->note);
  return TRUE;
}

static gboolean
assign_uv (Parser * parser, ClothObj * obj, GError ** error)
{
  const guint32 *corners = (const guint32 *) parser->face_uv->data;
  const gfloat *given = (const gfloat *) parser->uv->data;
  ClothTopology *topology = obj->topology;
  /* 0 not yet, 1 given, 2 given in two ways */
  g_autofree guint8 *seen = g_new0 (guint8, topology->n_vertices);

  for (gsize i = 0; i < 4 * (gsize) topology->n_faces; i++) {
    guint32 vertex = topology->faces[i];
    const gfloat *from;
    gfloat *to;

    if (vertex == CLOTH_NO_VERTEX || corners[i] == NO_UV)
      continue;
    if (corners[i] >= parser->uv->len / 2)
      return cloth_file_invalid (error,
          "face %u of the OBJ file names a uv that is not there",
          (guint) (i / 4));
    from = given + 2 * corners[i];
    to = topology->uv + 2 * vertex;
    if (!seen[vertex]) {
      memcpy (to, from, 2 * sizeof *to);
      seen[vertex] = 1;
      obj->has_uv = TRUE;
    } else if (seen[vertex] == 1 && (to[0] != from[0] || to[1] != from[1])) {
      seen[vertex] = 2;
      obj->n_seam_vertices++;
    }
  }
  return TRUE;
}

/* The uv of every corner; of those without one, their vertex'. */
static void
keep_corner_uv (const Parser * parser, ClothObj * obj)
{
  const guint32 *corners = (const guint32 *) parser->face_uv->data;
  const gfloat *given = (const gfloat *) parser->uv->data;
  const ClothTopology *topology = obj->topology;
  const gsize n = 4 * (gsize) topology->n_faces;

  obj->corner_uv = g_new0 (gfloat, 2 * n);
  for (gsize i = 0; i < n; i++)
    if (topology->faces[i] != CLOTH_NO_VERTEX)
      memcpy (obj->corner_uv + 2 * i, corners[i] == NO_UV ?
          topology->uv + 2 * topology->faces[i] : given + 2 * corners[i],
          2 * sizeof *given);
}

static ClothObj *
parse (Parser * parser, GError ** error)
{
  g_autoptr (ClothObj) obj = NULL;
  guint n_vertices, n_faces;

  for (parser->line = 1; parser->at < parser->end; skip_line (parser))
    if (!take_line (parser, error))
      return NULL;
  n_vertices = parser->positions->len / 3;
  n_faces = parser->faces->len / 4;
  obj = g_new0 (ClothObj, 1);
  obj->topology = cloth_topology_new (n_vertices, n_faces);
  memcpy (obj->topology->faces, parser->faces->data,
      parser->faces->len * sizeof (guint32));
  if (!cloth_topology_check (obj->topology, error) ||
      !assign_uv (parser, obj, error))
    return NULL;
  if (obj->n_seam_vertices > 0)
    keep_corner_uv (parser, obj);
  obj->positions = g_memdup2 (parser->positions->data,
      parser->positions->len * sizeof (gfloat));
  obj->fps = parser->note.fps;
  cloth_mesh_note_apply (&parser->note, obj->topology);
  return g_steal_pointer (&obj);
}

/* @text: an OBJ file with a 0 byte behind its @size bytes
 * @size: how many
 * @error: #ClothFileError
 *
 * Reads `v`, `vt` and `f`; everything else (normals, groups, materials) is skipped.
 * Indices may be negative, corners `v`, `v/vt`, `v//vn` or `v/vt/vn`.
 *
 * Returns: (transfer full): the mesh, or %NULL
 */
ClothObj *
cloth_obj_parse (const gchar * text, gsize size, GError ** error)
{
  Parser parser = {.at = text,.end = text + size };
  ClothObj *obj;

  if (memchr (text, 0, size)) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "this is no OBJ file: it has bytes that are no text");
    return NULL;
  }
  parser.positions = g_array_new (FALSE, FALSE, sizeof (gfloat));
  parser.uv = g_array_new (FALSE, FALSE, sizeof (gfloat));
  parser.faces = g_array_new (TRUE, FALSE, sizeof (guint32));
  parser.face_uv = g_array_new (TRUE, FALSE, sizeof (guint32));
  parser.corners = g_array_new (FALSE, FALSE, sizeof (guint32));
  obj = parse (&parser, error);
  g_array_unref (parser.positions);
  g_array_unref (parser.uv);
  g_array_unref (parser.faces);
  g_array_unref (parser.face_uv);
  g_array_unref (parser.corners);
  return obj;
}

/* @path: an OBJ file of at most 512 MiB
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full): the mesh, or %NULL
 */
ClothObj *
cloth_obj_read (const gchar * path, GError ** error)
{
  g_autoptr (ClothInput) input = cloth_input_open (path, error);
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  ClothObj *obj;

  if (!input)
    return NULL;
  obj = cloth_input_load (input, CLOTH_MAX_BUFFER, bytes, error) ?
      cloth_obj_parse ((const gchar *) bytes->data, bytes->len - 1, error) :
      NULL;
  if (!obj)
    g_prefix_error (error, "%s: ", path);
  return obj;
}

/* @obj: (transfer full) (nullable): a mesh
 */
void
cloth_obj_free (ClothObj * obj)
{
  if (!obj)
    return;
  cloth_topology_free (obj->topology);
  g_free (obj->positions);
  g_free (obj->corner_uv);
  g_free (obj);
}

/* @output: where to
 * @name: name of the object; blanks become underscores
 * @topology: faces and uv
 * @positions: 3 finite numbers a vertex
 * @fps_n: numerator of the frame rate, 0 when it varies
 * @fps_d: its denominator
 * @error: #GIOErrorEnum
 *
 * Writes one uv a vertex, so that `f` has the form `v/v`.
 *
 * Returns: %TRUE when all was taken
 */
gboolean
cloth_obj_write (ClothOutput * output, const gchar * name,
    const ClothTopology * topology, const gfloat * positions, gint fps_n,
    gint fps_d, GError ** error)
{
  g_autoptr (GString) text = g_string_new (NULL);
  g_autofree gchar *note = cloth_mesh_note_format (topology, fps_n, fps_d);
  g_autofree gchar *object = g_strdup (name);

  g_strcanon (object, G_CSET_A_2_Z G_CSET_a_2_z G_CSET_DIGITS "-.", '_');
  g_string_append_printf (text, "# %s\n# metres, z up; uv in metres\no %s\n",
      note, object);
  for (guint i = 0; i < topology->n_vertices; i++) {
    g_string_append_c (text, 'v');
    for (guint k = 0; k < 3; k++) {
      g_string_append_c (text, ' ');
      cloth_text_append_float (text, positions[3 * (gsize) i + k]);
    }
    g_string_append_c (text, '\n');
  }
  for (guint i = 0; i < topology->n_vertices; i++) {
    g_string_append (text, "vt");
    for (guint k = 0; k < 2; k++) {
      g_string_append_c (text, ' ');
      cloth_text_append_float (text, topology->uv[2 * (gsize) i + k]);
    }
    g_string_append_c (text, '\n');
  }
  for (guint i = 0; i < topology->n_faces; i++) {
    g_string_append_c (text, 'f');
    for (guint k = 0; k < 4; k++) {
      guint32 index = topology->faces[4 * (gsize) i + k];

      if (index != CLOTH_NO_VERTEX)
        g_string_append_printf (text, " %u/%u", index + 1, index + 1);
    }
    g_string_append_c (text, '\n');
  }
  return cloth_output_write (output, text->str, text->len, error);
}
