/* PLY: reading and writing frames of a mesh with what is known of each vertex.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/ply.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/mesh/formats/export.h"
#include "gst/mesh/strain.h"

/* The format: Greg Turk, "The PLY Polygon File Format" (1994). */
#define MAX_HEADER (64u << 10)
#define MAX_ELEMENTS 16
#define MAX_PROPERTIES 64
#define MAX_CORNERS 255

typedef enum
{
  ASCII,
  LITTLE,
  BIG
} Encoding;

typedef enum
{
  INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64
} Type;

static const struct
{
  const gchar *name, *alias;
  gsize size;
} types[] = {
  [INT8] = {"char", "int8", 1},
  [UINT8] = {"uchar", "uint8", 1},
  [INT16] = {"short", "int16", 2},
  [UINT16] = {"ushort", "uint16", 2},
  [INT32] = {"int", "int32", 4},
  [UINT32] = {"uint", "uint32", 4},
  [FLOAT32] = {"float", "float32", 4},
  [FLOAT64] = {"double", "float64", 8},
};

/* What a property of a vertex is to us. */
typedef enum
{
  ROLE_NONE,
  ROLE_X, ROLE_Y, ROLE_Z,
  ROLE_U, ROLE_V,
  ROLE_STATE,
  ROLE_XX, ROLE_XY, ROLE_XZ, ROLE_YY, ROLE_YZ, ROLE_ZZ,
  ROLE_CORNERS,
  N_ROLES
} Role;

static const struct
{
  const gchar *name;
  Role role;
} vertex_roles[] = {
  {"x", ROLE_X}, {"y", ROLE_Y}, {"z", ROLE_Z},
  {"s", ROLE_U}, {"t", ROLE_V}, {"u", ROLE_U}, {"v", ROLE_V},
  {"texture_u", ROLE_U}, {"texture_v", ROLE_V},
  {"state", ROLE_STATE},
  {"cov_xx", ROLE_XX}, {"cov_xy", ROLE_XY}, {"cov_xz", ROLE_XZ},
  {"cov_yy", ROLE_YY}, {"cov_yz", ROLE_YZ}, {"cov_zz", ROLE_ZZ},
};

typedef struct
{
  gboolean list;
  Type count_type, type;
  Role role;
} Property;

typedef struct
{
  enum
  { OTHER, VERTEX, FACE } kind;
  guint64 count;
  guint n_properties;
  Property properties[MAX_PROPERTIES];
} Element;

typedef struct
{
  Encoding encoding;
  guint n_elements;
  Element elements[MAX_ELEMENTS];
} Header;

/* The data, eaten from the left; a 0 byte stands at the end. */
typedef struct
{
  const gchar *at, *end;
  Encoding encoding;
} Data;

static gboolean
fail (GError ** error, gint code, const gchar * what)
{
  g_set_error (error, CLOTH_FILE_ERROR, code, "not a valid PLY file: %s", what);
  return FALSE;
}

static gboolean
find_type (const gchar * word, Type * type)
{
  for (guint i = 0; word && i < G_N_ELEMENTS (types); i++) {
    if (g_str_equal (word, types[i].name) || g_str_equal (word, types[i].alias)) {
      *type = (Type) i;
      return TRUE;
    }
  }
  return FALSE;
}

static Role
find_role (const Element * element, const Property * property,
    const gchar * name)
{
  if (element->kind == FACE && property->list &&
      (g_str_equal (name, "vertex_indices") ||
          g_str_equal (name, "vertex_index")))
    return ROLE_CORNERS;
  if (element->kind != VERTEX || property->list)
    return ROLE_NONE;
  for (guint i = 0; i < G_N_ELEMENTS (vertex_roles); i++)
    if (g_str_equal (name, vertex_roles[i].name))
      return vertex_roles[i].role;
  return ROLE_NONE;
}

static gboolean
add_property (Header * header, gchar ** words, GError ** error)
{
  Element *element = header->n_elements > 0 ?
      &header->elements[header->n_elements - 1] : NULL;
  Property property = { 0 };
  guint n = g_strv_length (words);
  const gchar *name;

  if (!element || element->n_properties == MAX_PROPERTIES)
    return fail (error, CLOTH_FILE_ERROR_INVALID,
        "a property belongs to no element, or there are too many");
  if (n == 5 && g_str_equal (words[1], "list")) {
    property.list = TRUE;
    if (!find_type (words[2], &property.count_type) ||
        property.count_type >= FLOAT32 || !find_type (words[3], &property.type))
      return fail (error, CLOTH_FILE_ERROR_INVALID, "a list of unknown type");
    name = words[4];
  } else if (n == 3 && find_type (words[1], &property.type)) {
    name = words[2];
  } else {
    return fail (error, CLOTH_FILE_ERROR_INVALID,
        "a property line cannot be read");
  }
  property.role = find_role (element, &property, name);
  for (guint i = 0; property.role && i < element->n_properties; i++)
    if (element->properties[i].role == property.role)
      return fail (error, CLOTH_FILE_ERROR_INVALID, "a property stands twice");
  element->properties[element->n_properties++] = property;
  return TRUE;
}

static gboolean
add_element (Header * header, gchar ** words, GError ** error)
{
  Element *element = &header->elements[header->n_elements];
  guint64 limit = CLOTH_MAX_BUFFER;

  if (header->n_elements == MAX_ELEMENTS || g_strv_length (words) != 3)
    return fail (error, CLOTH_FILE_ERROR_INVALID,
        "an element line cannot be read, or there are too many");
  if (g_str_equal (words[1], "vertex")) {
    element->kind = VERTEX;
    limit = CLOTH_MAX_VERTICES;
  } else if (g_str_equal (words[1], "face")) {
    element->kind = FACE;
    limit = CLOTH_MAX_FACES;
  }
  for (guint i = 0; element->kind != OTHER && i < header->n_elements; i++)
    if (header->elements[i].kind == element->kind)
      return fail (error, CLOTH_FILE_ERROR_INVALID, "an element stands twice");
  if (!g_ascii_string_to_unsigned (words[2], 10, 0, G_MAXUINT64,
          &element->count, NULL))
    return fail (error, CLOTH_FILE_ERROR_INVALID,
        "an element's count is no whole number");
  if (element->count > limit)
    return fail (error, CLOTH_FILE_ERROR_LIMIT,
        "more vertices or faces than are accepted");
  header->n_elements++;
  return TRUE;
}

static gboolean
take_format (Header * header, gchar ** words, GError ** error)
{
  if (g_strv_length (words) == 3 && g_str_equal (words[2], "1.0")) {
    if (g_str_equal (words[1], "ascii")) {
      header->encoding = ASCII;
      return TRUE;
    }
    if (g_str_equal (words[1], "binary_little_endian")) {
      header->encoding = LITTLE;
      return TRUE;
    }
    if (g_str_equal (words[1], "binary_big_endian")) {
      header->encoding = BIG;
      return TRUE;
    }
  }
  return fail (error, CLOTH_FILE_ERROR_UNSUPPORTED, "unknown format line");
}

/* Returns the first byte of the data, or NULL. */
static const gchar *
parse_header (const gchar * bytes, gsize size, Header * header,
    ClothMeshNote * note, GError ** error)
{
  const gchar *at = bytes, *end = bytes + MIN (size, MAX_HEADER);
  gboolean have_format = FALSE;

  for (guint line = 0;; line++) {
    const gchar *stop = memchr (at, '\n', (gsize) (end - at));
    g_autofree gchar *text = NULL;
    g_auto (GStrv) words = NULL;
    gboolean good = TRUE;

    if (!stop || memchr (at, 0, (gsize) (stop - at))) {
      fail (error, CLOTH_FILE_ERROR_INVALID, "the header does not end");
      return NULL;
    }
    text = g_strstrip (g_strndup (at, (gsize) (stop - at)));
    at = stop + 1;
    if (line == 0) {
      if (!g_str_equal (text, "ply")) {
        fail (error, CLOTH_FILE_ERROR_INVALID,
            "it does not begin with “ply”");
        return NULL;
      }
      continue;
    }
    if (g_str_equal (text, "end_header"))
      break;
    if (g_str_has_prefix (text, "comment ")) {
      cloth_mesh_note_parse (text + strlen ("comment "), note);
      continue;
    }
    if (g_str_equal (text, "comment") || g_str_has_prefix (text, "obj_info"))
      continue;
    words = g_strsplit_set (text, " \t", 8);
    if (!words[0]) {
      good = fail (error, CLOTH_FILE_ERROR_INVALID, "an empty header line");
    } else if (g_str_equal (words[0], "format") && !have_format) {
      good = have_format = take_format (header, words, error);
    } else if (g_str_equal (words[0], "element")) {
      good = add_element (header, words, error);
    } else if (g_str_equal (words[0], "property")) {
      good = add_property (header, words, error);
    } else {
      good = fail (error, CLOTH_FILE_ERROR_INVALID, "unknown header line");
    }
    if (!good)
      return NULL;
  }
  if (!have_format) {
    fail (error, CLOTH_FILE_ERROR_INVALID, "the format line is missing");
    return NULL;
  }
  return at;
}

static gboolean
take_ascii (Data * data, gdouble * value)
{
  gchar *end;

  while (data->at < data->end && g_ascii_isspace (*data->at))
    data->at++;
  if (data->at >= data->end)
    return FALSE;
  *value = g_ascii_strtod (data->at, &end);
  if (end == data->at)
    return FALSE;
  data->at = end;
  return TRUE;
}

#define AS(ctype) do { \
    ctype number_; \
    memcpy (&number_, raw, sizeof number_); \
    *value = (gdouble) number_; \
  } while (0)

static inline gboolean
take_value (Data * data, Type type, gdouble * value)
{
  gsize size = types[type].size;
  guint8 raw[8];

  if (data->encoding == ASCII)
    return take_ascii (data, value);
  if ((gsize) (data->end - data->at) < size)
    return FALSE;
  if ((data->encoding == LITTLE) == (G_BYTE_ORDER == G_LITTLE_ENDIAN)) {
    memcpy (raw, data->at, size);
  } else {
    for (gsize i = 0; i < size; i++)
      raw[i] = (guint8) data->at[size - 1 - i];
  }
  data->at += size;
  switch (type) {
    case INT8:
      AS (gint8);
      break;
    case UINT8:
      AS (guint8);
      break;
    case INT16:
      AS (gint16);
      break;
    case UINT16:
      AS (guint16);
      break;
    case INT32:
      AS (gint32);
      break;
    case UINT32:
      AS (guint32);
      break;
    case FLOAT32:
      AS (gfloat);
      break;
    case FLOAT64:
      AS (gdouble);
      break;
  }
  return TRUE;
}

static gboolean
cut_short (GError ** error)
{
  return fail (error, CLOTH_FILE_ERROR_TRUNCATED,
      "it is cut short, or has something that is no number");
}

/* Compares the least bytes that an element's items take with what remains, before anything is
 * allocated for them. */
static gboolean
check_count (const Element * element, const Data * data, GError ** error)
{
  guint64 least = 0;

  for (guint i = 0; i < element->n_properties; i++) {
    const Property *property = &element->properties[i];

    /* A number and a separator; the last one of the file may lack it. */
    if (data->encoding == ASCII)
      least += 2;
    else
      least += types[property->list ? property->count_type :
          property->type].size;
  }
  if (least == 0 && element->count > 0)
    return fail (error, CLOTH_FILE_ERROR_INVALID,
        "an element has no properties");
  if (element->count * least > (guint64) (data->end - data->at) + 1)
    return cut_short (error);
  return TRUE;
}

static gboolean
skip_list (Data * data, const Property * property, GError ** error)
{
  gdouble count = 0, value = 0;

  if (!take_value (data, property->count_type, &count))
    return cut_short (error);
  if (!(count >= 0 && count <= G_MAXUINT32))
    return fail (error, CLOTH_FILE_ERROR_INVALID, "a list of negative length");
  for (guint64 i = 0; i < (guint64) count; i++)
    if (!take_value (data, property->type, &value))
      return cut_short (error);
  return TRUE;
}

static gboolean
take_polygon (ClothPly * ply, Data * data, const Property * property,
    GError ** error)
{
  guint32 corners[MAX_CORNERS];
  gdouble count = 0, value = 0;
  guint n;

  if (!take_value (data, property->count_type, &count))
    return cut_short (error);
  if (!(count >= 3 && count <= MAX_CORNERS))
    return fail (error, CLOTH_FILE_ERROR_INVALID,
        "a face has less than 3 or more than 255 corners");
  n = (guint) count;
  for (guint i = 0; i < n; i++) {
    if (!take_value (data, property->type, &value))
      return cut_short (error);
    if (!(value >= 0 && value < ply->n_vertices))
      return fail (error, CLOTH_FILE_ERROR_INVALID,
          "a face names a vertex that is not there");
    corners[i] = (guint32) value;
  }
  if (ply->faces->len / 4 + n - 2 > CLOTH_MAX_FACES)
    return fail (error, CLOTH_FILE_ERROR_LIMIT, "too many faces");
  if (n == 4) {
    g_array_append_vals (ply->faces, corners, 4);
    return TRUE;
  }
  for (guint i = 1; i + 1 < n; i++) {
    guint32 face[4] = { corners[0], corners[i], corners[i + 1],
      CLOTH_NO_VERTEX
    };

    g_array_append_vals (ply->faces, face, 4);
  }
  return TRUE;
}

static gboolean
store_vertex (ClothPly * ply, guint vertex, const gdouble * values,
    GError ** error)
{
  gfloat *position = ply->positions + 3 * vertex;
  gfloat *uv = ply->uv + 2 * vertex;
  gfloat *covariance = ply->covariances + 6 * vertex;

  for (guint k = 0; k < 3; k++)
    position[k] = (gfloat) values[ROLE_X + k];
  for (guint k = 0; k < 2; k++)
    uv[k] = (gfloat) values[ROLE_U + k];
  for (guint k = 0; k < 6; k++) {
    covariance[k] = (gfloat) values[ROLE_XX + k];
    if (isinf (covariance[k]))
      return fail (error, CLOTH_FILE_ERROR_INVALID, "an infinite covariance");
  }
  if (!isfinite (uv[0]) || !isfinite (uv[1]))
    return fail (error, CLOTH_FILE_ERROR_INVALID, "a uv is no finite number");
  if (!ply->has_states) {
    ply->states[vertex] = isnan (position[0]) ? CLOTH_VERTEX_UNSEEN :
        CLOTH_VERTEX_MEASURED;
  } else if (values[ROLE_STATE] >= 0 &&
      values[ROLE_STATE] <= CLOTH_VERTEX_PREDICTED) {
    ply->states[vertex] = (guint8) values[ROLE_STATE];
  } else {
    return fail (error, CLOTH_FILE_ERROR_INVALID,
        "a state that is not between 0 and 4");
  }
  return TRUE;
}

static gboolean
take_element (ClothPly * ply, Data * data, const Element * element,
    GError ** error)
{
  gdouble values[N_ROLES] = { 0 };

  for (guint64 item = 0; item < element->count; item++) {
    for (guint i = 0; i < element->n_properties; i++) {
      const Property *property = &element->properties[i];

      if (property->role == ROLE_CORNERS) {
        if (!take_polygon (ply, data, property, error))
          return FALSE;
      } else if (property->list) {
        if (!skip_list (data, property, error))
          return FALSE;
      } else if (!take_value (data, property->type, &values[property->role])) {
        return cut_short (error);
      }
    }
    if (element->kind == VERTEX &&
        !store_vertex (ply, (guint) item, values, error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
has_role (const Element * element, Role role)
{
  for (guint i = 0; i < element->n_properties; i++)
    if (element->properties[i].role == role)
      return TRUE;
  return FALSE;
}

static gboolean
prepare_vertices (ClothPly * ply, const Element * element, GError ** error)
{
  guint n = (guint) element->count;

  if (n == 0)
    return fail (error, CLOTH_FILE_ERROR_INVALID, "it has no vertices");
  for (Role role = ROLE_X; role <= ROLE_Z; role++)
    if (!has_role (element, role))
      return fail (error, CLOTH_FILE_ERROR_INVALID, "x, y or z is missing");
  ply->n_vertices = n;
  ply->has_uv = has_role (element, ROLE_U) && has_role (element, ROLE_V);
  ply->has_states = has_role (element, ROLE_STATE);
  ply->has_covariances = TRUE;
  for (Role role = ROLE_XX; role <= ROLE_ZZ; role++)
    ply->has_covariances = ply->has_covariances && has_role (element, role);
  if (n > ply->capacity) {
    ply->positions = g_renew (gfloat, ply->positions, 3 * (gsize) n);
    ply->uv = g_renew (gfloat, ply->uv, 2 * (gsize) n);
    ply->states = g_renew (guint8, ply->states, n);
    ply->covariances = g_renew (gfloat, ply->covariances, 6 * (gsize) n);
    ply->capacity = n;
  }
  return TRUE;
}

/* Returns: (transfer full): an empty frame to parse into
 */
ClothPly *
cloth_ply_new (void)
{
  ClothPly *ply = g_new0 (ClothPly, 1);

  ply->faces = g_array_new (FALSE, FALSE, sizeof (guint32));
  ply->bytes = g_byte_array_new ();
  return ply;
}

/* @ply: set to what the file holds
 * @bytes: a PLY file with a 0 byte behind its @size bytes
 * @size: how many
 * @error: #ClothFileError
 *
 * Reads ascii, binary little-endian and binary big-endian. uv may be called s and t,
 * u and v or texture_u and texture_v. Vertices that `state` calls unseen become NaN.
 * Other elements and properties are skipped.
 *
 * Returns: %TRUE when the file is valid
 */
gboolean
cloth_ply_parse (ClothPly * ply, const gchar * bytes, gsize size,
    GError ** error)
{
  g_autofree Header *header = g_new0 (Header, 1);
  Data data = {.end = bytes + size };

  memset (&ply->note, 0, sizeof ply->note);
  ply->n_vertices = 0;
  g_array_set_size (ply->faces, 0);
  data.at = parse_header (bytes, size, header, &ply->note, error);
  if (!data.at)
    return FALSE;
  data.encoding = header->encoding;
  for (guint i = 0; i < header->n_elements; i++) {
    const Element *element = &header->elements[i];

    if (!check_count (element, &data, error))
      return FALSE;
    if (element->kind == VERTEX && !prepare_vertices (ply, element, error))
      return FALSE;
    if (!take_element (ply, &data, element, error))
      return FALSE;
  }
  if (ply->n_vertices == 0)
    return fail (error, CLOTH_FILE_ERROR_INVALID, "it has no vertices");
  ply->n_faces = ply->faces->len / 4;
  for (guint i = 0; i < ply->n_vertices; i++)
    if (ply->states[i] == CLOTH_VERTEX_UNSEEN)
      for (guint k = 0; k < 3; k++)
        ply->positions[3 * i + k] = NAN;
  return cloth_positions_check (ply->positions, ply->n_vertices, error);
}

/* @ply: set to what the file holds
 * @path: a PLY file of at most 512 MiB
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when the file is valid
 */
gboolean
cloth_ply_read (ClothPly * ply, const gchar * path, GError ** error)
{
  g_autoptr (ClothInput) input = cloth_input_open (path, error);

  if (!input)
    return FALSE;
  if (!cloth_input_load (input, CLOTH_MAX_BUFFER, ply->bytes, error) ||
      !cloth_ply_parse (ply, (const gchar *) ply->bytes->data,
          ply->bytes->len - 1, error)) {
    g_prefix_error (error, "%s: ", path);
    return FALSE;
  }
  return TRUE;
}

/* @ply: (transfer full) (nullable): a frame
 */
void
cloth_ply_free (ClothPly * ply)
{
  if (!ply)
    return;
  g_free (ply->positions);
  g_free (ply->uv);
  g_free (ply->states);
  g_free (ply->covariances);
  g_array_unref (ply->faces);
  g_byte_array_unref (ply->bytes);
  g_free (ply);
}

static guint8 *
put_float (guint8 * to, gfloat value)
{
  cloth_swap_little_endian (&value, sizeof value, 1);
  memcpy (to, &value, sizeof value);
  return to + sizeof value;
}

static guint8 *
put_index (guint8 * to, guint32 value)
{
  cloth_swap_little_endian (&value, sizeof value, 1);
  memcpy (to, &value, sizeof value);
  return to + sizeof value;
}

/* Binary little-endian. Properties of a vertex: x y z, s t (uv), state; with covariances
 * also `quality` = standard deviation in metres (RMS of the axes; the scalar that viewers
 * colour by; 0 where not known) and cov_xx to cov_zz; with @strains, which have measured the
 * frame, strain_warp, strain_weft, strain_shear. Faces have their corners only: many readers
 * expect no more. @scratch is reused from frame to frame. */
static gboolean
write_frame (ClothOutput * output, const ClothTopology * topology,
    const gfloat * positions, const guint8 * states,
    const gfloat * covariances, const ClothStrains * strains, gint fps_n,
    gint fps_d, GByteArray * scratch, GError ** error)
{
  g_autofree gchar *note = cloth_mesh_note_format (topology, fps_n, fps_d);
  gsize n_vertices = topology->n_vertices, n_faces = topology->n_faces;
  gsize vertex_size = (covariances ? 49 : 21) + (strains ? 12 : 0);
  guint8 *to;

  if (!cloth_output_printf (output, error, "ply\n"
          "format binary_little_endian 1.0\ncomment %s\n"
          "comment metres, z up; uv (s, t) in metres; state 0 unseen "
          "(position held), 1 measured, 2 two views, 3 filled, 4 predicted\n"
          "element vertex %u\nproperty float x\nproperty float y\n"
          "property float z\nproperty float s\nproperty float t\n"
          "property uchar state\n%s%selement face %u\n"
          "property list uchar uint vertex_indices\nend_header\n",
          note, topology->n_vertices, covariances ?
          "property float quality\nproperty float cov_xx\n"
          "property float cov_xy\nproperty float cov_xz\n"
          "property float cov_yy\nproperty float cov_yz\n"
          "property float cov_zz\n" : "", strains ?
          "property float strain_warp\nproperty float strain_weft\n"
          "property float strain_shear\n" : "", topology->n_faces))
    return FALSE;
  g_byte_array_set_size (scratch, (guint) (n_vertices * vertex_size +
          n_faces * 17));
  to = scratch->data;
  for (gsize i = 0; i < n_vertices; i++) {
    for (guint k = 0; k < 3; k++)
      to = put_float (to, positions[3 * i + k]);
    for (guint k = 0; k < 2; k++)
      to = put_float (to, topology->uv[2 * i + k]);
    *to++ = states[i];
    if (covariances) {
      gfloat sigma = cloth_export_sigma (covariances + 6 * i);

      to = put_float (to, isnan (sigma) ? 0 : sigma);
      for (guint k = 0; k < 6; k++)
        to = put_float (to, covariances[6 * i + k]);
    }
    if (strains) {
      const gfloat *strain = cloth_strains_get_vertices (strains) + 3 * i;

      for (guint k = 0; k < CLOTH_STRAIN_SIZE; k++)
        to = put_float (to, strain[k]);
    }
  }
  for (gsize i = 0; i < n_faces; i++) {
    const guint32 *face = topology->faces + 4 * i;
    guint n = cloth_face_corners (face);

    *to++ = (guint8) n;
    for (guint k = 0; k < n; k++)
      to = put_index (to, face[k]);
  }
  return cloth_output_write (output, scratch->data,
      (gsize) (to - scratch->data), error);
}

typedef struct
{
  const ClothExportInfo *info;
  guint64 n_frames;
  GByteArray *scratch;
  ClothStrains *strains;        /* NULL when uv is not known */
} Export;

static gpointer
start_ply (const ClothExportInfo * info, GError ** error)
{
  Export *self = g_new0 (Export, 1);

  self->info = info;
  self->scratch = g_byte_array_new ();
  self->strains = cloth_strains_new (info->topology);
  return self;
}

static gboolean
append_ply (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  Export *self = export;
  const ClothExportInfo *info = self->info;
  g_autoptr (ClothOutput) output = cloth_parts_open_numbered (info->parts,
      info->base, number, ".ply", error);

  if (self->strains)
    cloth_strains_measure (self->strains, frame->positions, frame->states);
  if (!output || !write_frame (output, info->topology, frame->positions,
          frame->states, frame->covariances, self->strains, info->fps_n,
          info->fps_d, self->scratch, error)
      || !cloth_output_commit (output, error))
    return FALSE;
  self->n_frames = number + 1;
  return TRUE;
}

static gboolean
finish_ply (gpointer export, GError ** error)
{
  Export *self = export;

  return cloth_parts_replace_numbered (self->info->parts, self->info->base,
      self->n_frames, ".ply", error);
}

static void
free_ply (gpointer export)
{
  Export *self = export;

  g_byte_array_unref (self->scratch);
  cloth_strains_free (self->strains);
  g_free (self);
}

gboolean
cloth_ply_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error)
{
  const guint64 *n = &recovered->n_frames;

  if (!cloth_parts_count_numbered (parts, base, ".ply", &recovered->n_frames,
          error))
    return FALSE;
  recovered->n_left_out = cloth_parts_has_unfinished (parts);
  return *n == 0 || (cloth_parts_drop_numbered (parts, base, *n, ".ply", error)
      && cloth_parts_replace_numbered (parts, base, *n, ".ply", error));
}

const ClothExporter cloth_ply_exporter = {
  FALSE, ".ply", TRUE, start_ply, append_ply, finish_ply, free_ply
};
