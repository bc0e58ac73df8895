/* glTF 2.0, binary: a short clip as morph targets that an animation steps through.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/mesh/formats/export.h"

/* Players hold every frame in the memory of the graphics card, and the animation has
 * a weight for each target in each frame. */
#define MAX_FRAMES 1000u

/* of the specification */
#define GLB_MAGIC 0x46546c67u
#define CHUNK_JSON 0x4e4f534au
#define CHUNK_BIN 0x004e4942u
#define FLOAT 5126
#define UNSIGNED_INT 5125

/* The binary chunk: uv; positions and normals of frame 0, of each later frame how much they
 * differ from these; then times, weights, triangles. A mesh without faces has no normals. */
typedef struct
{
  const ClothExportInfo *info;
  ClothOutput *output;
  ClothOutput *binary;          /* waits: the JSON text stands before it */
  guint n_triangles;
  gsize n_floats;               /* a frame: positions, and normals if it has some */
  gfloat *first;                /* those of frame 0 */
  gfloat *scratch;              /* one frame */
  gdouble start_s;
  GArray *times;                /* of gfloat */
  GArray *bounds;               /* 6 gfloat a frame, of what is written */
} Gltf;

static void
free_gltf (gpointer export)
{
  Gltf *self = export;

  cloth_output_free (self->output);
  cloth_output_free (self->binary);
  g_free (self->first);
  g_free (self->scratch);
  g_array_unref (self->times);
  g_array_unref (self->bounds);
  g_free (self);
}

static gboolean
write_floats (ClothOutput * binary, gfloat * values, gsize n, GError ** error)
{
  cloth_swap_little_endian (values, sizeof *values, n);
  return cloth_output_write (binary, values, n * sizeof *values, error);
}

static gpointer
start_gltf (const ClothExportInfo * info, GError ** error)
{
  const gsize n = info->topology->n_vertices;
  Gltf *self = g_new0 (Gltf, 1);

  self->info = info;
  self->times = g_array_new (FALSE, FALSE, sizeof (gfloat));
  self->bounds = g_array_new (FALSE, FALSE, 6 * sizeof (gfloat));
  for (gsize f = 0; f < info->topology->n_faces; f++)
    self->n_triangles += cloth_face_corners (info->topology->faces + 4 * f) - 2;
  self->n_floats = 3 * n * (self->n_triangles > 0 ? 2 : 1);
  self->first = g_new (gfloat, self->n_floats);
  self->scratch = g_new (gfloat, self->n_floats);
  self->output = cloth_export_open (info, ".glb", error);
  if (self->output)
    self->binary = cloth_export_open (info, ".bin", error);
  if (self->binary) {
    memcpy (self->scratch, info->topology->uv, 2 * n * sizeof (gfloat));
    if (write_floats (self->binary, self->scratch, 2 * n, error))
      return self;
  }
  free_gltf (self);
  return NULL;
}

/* Twice the area of a face times its normal. */
static void
add_face_normal (const guint32 * face, const gfloat * positions,
    gfloat * normals)
{
  const guint n = cloth_face_corners (face);
  gdouble side[2][3], cross[3];

  /* of a quad its diagonals, of a triangle two sides */
  for (guint k = 0; k < 3; k++) {
    const gdouble p0 = positions[3 * (gsize) face[0] + k];
    const gdouble p1 = positions[3 * (gsize) face[1] + k];
    const gdouble p2 = positions[3 * (gsize) face[2] + k];
    const gdouble p3 = n == 4 ? positions[3 * (gsize) face[3] + k] : p0;

    side[0][k] = p2 - p0;
    side[1][k] = p3 - p1;
  }
  for (guint k = 0; k < 3; k++)
    cross[k] = side[0][(k + 1) % 3] * side[1][(k + 2) % 3] -
        side[0][(k + 2) % 3] * side[1][(k + 1) % 3];
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < 3; k++)
      normals[3 * (gsize) face[i] + k] += (gfloat) cross[k];
}

/* A vertex has the mean of its faces by their areas; one without any looks up. */
static void
find_normals (const ClothTopology * topology, const gfloat * positions,
    gfloat * normals)
{
  memset (normals, 0, 3 * (gsize) topology->n_vertices * sizeof *normals);
  for (gsize f = 0; f < topology->n_faces; f++)
    add_face_normal (topology->faces + 4 * f, positions, normals);
  for (gsize i = 0; i < topology->n_vertices; i++) {
    gfloat *n = normals + 3 * i;
    const gdouble length = sqrt ((gdouble) n[0] * n[0] + (gdouble) n[1] * n[1] +
        (gdouble) n[2] * n[2]);

    for (guint k = 0; k < 3; k++)
      n[k] = length > 0 ? (gfloat) (n[k] / length) : k == 2;
  }
}

static gboolean
append_gltf (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  Gltf *self = export;
  const guint n_vertices = self->info->topology->n_vertices;
  const gsize n = self->n_floats, n_positions = 3 * (gsize) n_vertices;
  gfloat bounds[6], time;

  if (number >= MAX_FRAMES ||
      (number + 1) * n * sizeof (gfloat) > CLOTH_MAX_BUFFER) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "a glTF file is for short clips: here at most %" G_GUINT64_FORMAT
        " frames; write OBJ + PC2 or USD (format=obj-pc2 or usd)",
        MIN ((guint64) MAX_FRAMES,
            CLOTH_MAX_BUFFER / ((guint64) n * sizeof (gfloat))));
    return FALSE;
  }
  if (number == 0)
    self->start_s = time_s;
  time = (gfloat) (time_s - self->start_s);
  if (!cloth_export_check_later (number, number > 0 ?
          g_array_index (self->times, gfloat, number - 1) : 0, time, error))
    return FALSE;
  memcpy (self->scratch, frame->positions, n_positions * sizeof (gfloat));
  if (n > n_positions)
    find_normals (self->info->topology, frame->positions,
        self->scratch + n_positions);
  if (number == 0)
    memcpy (self->first, self->scratch, n * sizeof (gfloat));
  for (gsize i = 0; number > 0 && i < n; i++)
    self->scratch[i] -= self->first[i];
  cloth_export_bounds (self->scratch, n_vertices, bounds);
  g_array_append_val (self->times, time);
  g_array_append_val (self->bounds, bounds);
  return write_floats (self->binary, self->scratch, n, error);
}

/* At the time of a frame its own target has weight 1 and all others 0: between two
 * frames every vertex moves on a straight line. */
static gboolean
write_animation (Gltf * self, GError ** error)
{
  const guint n = self->times->len - 1;
  g_autofree gfloat *row = g_new (gfloat, MAX (n, 1));
  g_autofree gfloat *times = g_memdup2 (self->times->data,
      self->times->len * sizeof (gfloat));

  if (n == 0)
    return TRUE;
  if (!write_floats (self->binary, times, self->times->len, error))
    return FALSE;
  for (guint i = 0; i <= n; i++) {
    memset (row, 0, n * sizeof *row);
    if (i > 0)
      row[i - 1] = 1;
    if (!write_floats (self->binary, row, n, error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
write_triangles (Gltf * self, GError ** error)
{
  const ClothTopology *topology = self->info->topology;

  for (gsize f = 0; f < topology->n_faces; f++) {
    const guint32 *face = topology->faces + 4 * f;

    for (guint k = 2; k < cloth_face_corners (topology->faces + 4 * f); k++) {
      guint32 triangle[3] = { face[0], face[k - 1], face[k] };

      cloth_swap_little_endian (triangle, sizeof *triangle, 3);
      if (!cloth_output_write (self->binary, triangle, sizeof triangle, error))
        return FALSE;
    }
  }
  return TRUE;
}

/* ---- the JSON text ---- */

static void
add_view (GString * text, gsize * offset, gsize size, const gchar * more)
{
  g_string_append_printf (text, "%s{\"buffer\":0,\"byteOffset\":%"
      G_GSIZE_FORMAT ",\"byteLength\":%" G_GSIZE_FORMAT "%s}", *offset > 0 ?
      "," : "", *offset, size, more);
  *offset += size;
}

static void
add_accessor (GString * text, guint view, gsize offset, gint component,
    gsize count, const gchar * type)
{
  g_string_append_printf (text, "%s{\"bufferView\":%u,\"byteOffset\":%"
      G_GSIZE_FORMAT ",\"componentType\":%d,\"count\":%" G_GSIZE_FORMAT
      ",\"type\":\"%s\"", view > 0 ? "," : "", view, offset, component, count,
      type);
}

static void
add_bound (GString * text, const gchar * name, const gfloat * values, guint n)
{
  g_string_append_printf (text, ",\"%s\":[", name);
  for (guint i = 0; i < n; i++) {
    if (i > 0)
      g_string_append_c (text, ',');
    cloth_text_append_float (text, values[i]);
  }
  g_string_append_c (text, ']');
}

/* Accessors: uv, positions, displacements; then, if there are any, normals and how they
 * differ, times and weights, triangles. Their buffer views are in the same order, positions
 * and normals in one. */
static GString *
make_json (const Gltf * self)
{
  const gsize n = self->info->topology->n_vertices;
  const guint n_frames = self->times->len;
  const gfloat *times = (const gfloat *) self->times->data;
  g_autofree gchar *name = cloth_export_identifier (self->info);
  GString *text = g_string_new ("{\"asset\":{\"version\":\"2.0\","
      "\"generator\":\"gst-cloth\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}]");
  const gboolean has_normals = self->n_triangles > 0;
  const guint normals = n_frames + 1;
  const guint times_at = has_normals ? 2 * n_frames + 1 : n_frames + 1;
  const guint triangles = n_frames > 1 ? times_at + 2 : times_at;
  gsize offset = 0, weights = (gsize) n_frames * (n_frames - 1);
  guint view = 0;

  /* the world's z is up, glTF's y: a quarter turn about x */
  g_string_append_printf (text, ",\"nodes\":[{\"name\":\"%s\",\"mesh\":0,"
      "\"rotation\":[-0.70710678118654752,0,0,0.70710678118654752]}]", name);
  g_string_append (text, ",\"materials\":[{\"doubleSided\":true,"
      "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.8,0.8,1],"
      "\"metallicFactor\":0,\"roughnessFactor\":0.9}}]");
  g_string_append_printf (text, ",\"meshes\":[{\"name\":\"%s\","
      "\"primitives\":[{\"attributes\":{\"POSITION\":1,", name);
  if (has_normals)
    g_string_append_printf (text, "\"NORMAL\":%u,", normals);
  g_string_append (text, "\"TEXCOORD_0\":0},\"material\":0");
  if (self->n_triangles > 0)
    g_string_append_printf (text, ",\"indices\":%u", triangles);
  else
    g_string_append (text, ",\"mode\":0");
  for (guint i = 1; i < n_frames; i++) {
    g_string_append_printf (text, "%s{\"POSITION\":%u", i == 1 ?
        ",\"targets\":[" : ",", i + 1);
    if (has_normals)
      g_string_append_printf (text, ",\"NORMAL\":%u", normals + i);
    g_string_append_c (text, '}');
  }
  g_string_append (text, n_frames > 1 ? "]}]}]" : "}]}]");
  if (n_frames > 1)
    g_string_append_printf (text, ",\"animations\":[{\"name\":\"%s\","
        "\"samplers\":[{\"input\":%u,\"output\":%u,\"interpolation\":"
        "\"LINEAR\"}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,"
        "\"path\":\"weights\"}}]}]", name, times_at, times_at + 1);

  g_string_append (text, ",\"accessors\":[");
  add_accessor (text, view++, 0, FLOAT, n, "VEC2");
  g_string_append_c (text, '}');
  for (guint i = 0; i < n_frames; i++) {
    const gfloat *bounds = &g_array_index (self->bounds, gfloat, 6 * i);

    add_accessor (text, view, 4 * self->n_floats * i, FLOAT, n, "VEC3");
    add_bound (text, "min", bounds, 3);
    add_bound (text, "max", bounds + 3, 3);
    g_string_append_c (text, '}');
  }
  for (guint i = 0; has_normals && i < n_frames; i++) {
    add_accessor (text, view, 4 * self->n_floats * i + 12 * n, FLOAT, n,
        "VEC3");
    g_string_append_c (text, '}');
  }
  view++;
  if (n_frames > 1) {
    add_accessor (text, view++, 0, FLOAT, n_frames, "SCALAR");
    add_bound (text, "min", times, 1);
    add_bound (text, "max", times + n_frames - 1, 1);
    g_string_append_c (text, '}');
    add_accessor (text, view++, 0, FLOAT, weights, "SCALAR");
    g_string_append_c (text, '}');
  }
  if (self->n_triangles > 0) {
    add_accessor (text, view, 0, UNSIGNED_INT, 3 * (gsize) self->n_triangles,
        "SCALAR");
    g_string_append_c (text, '}');
  }

  g_string_append (text, "],\"bufferViews\":[");
  add_view (text, &offset, 8 * n, ",\"target\":34962");
  add_view (text, &offset, 4 * self->n_floats * n_frames,
      ",\"byteStride\":12,\"target\":34962");
  if (n_frames > 1) {
    add_view (text, &offset, 4 * (gsize) n_frames, "");
    add_view (text, &offset, 4 * weights, "");
  }
  if (self->n_triangles > 0)
    add_view (text, &offset, 12 * (gsize) self->n_triangles,
        ",\"target\":34963");
  g_string_append_printf (text, "],\"buffers\":[{\"byteLength\":%"
      G_GSIZE_FORMAT "}]}", offset);
  while (text->len % 4 != 0)
    g_string_append_c (text, ' ');
  return text;
}

static gboolean
finish_gltf (gpointer export, GError ** error)
{
  Gltf *self = export;
  g_autoptr (GString) json = make_json (self);
  const gsize n = self->info->topology->n_vertices;
  const gsize n_frames = self->times->len;
  const gsize binary = 8 * n + 4 * self->n_floats * n_frames + (n_frames > 1 ?
      4 * n_frames + 4 * n_frames * (n_frames - 1) : 0) +
      12 * (gsize) self->n_triangles;
  guint32 header[5] = { GLB_MAGIC, 2, (guint32) (28 + json->len + binary),
    (guint32) json->len, CHUNK_JSON
  };
  guint32 chunk[2] = { (guint32) binary, CHUNK_BIN };

  cloth_swap_little_endian (header, sizeof *header, 5);
  cloth_swap_little_endian (chunk, sizeof *chunk, 2);
  return write_animation (self, error) && write_triangles (self, error) &&
      cloth_output_write (self->output, header, sizeof header, error) &&
      cloth_output_write (self->output, json->str, json->len, error) &&
      cloth_output_write (self->output, chunk, sizeof chunk, error) &&
      cloth_output_copy (self->binary, self->output, error) &&
      cloth_output_commit (self->output, error);
}

const ClothExporter cloth_gltf_exporter = {
  FALSE, ".glb", FALSE, start_gltf, append_gltf, finish_gltf, free_gltf
};
