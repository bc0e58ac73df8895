/* A page on which recordings move beside each other.
 *
 * It carries every kept frame: places, state, σ and strain of each vertex. Strain is not
 * left to the page, which has the places only to some hundredths of a millimetre.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/view.h"

#include <math.h>
#include <string.h>

#include "gst/gap/report/pack.h"
#include "gst/gap/report/page.h"
#include "gst/mesh/strain.h"
#include "gst/take/sequence.h"

/* Bytes of all frames together; base64 makes a third more of them. */
#define MAX_BYTES 12000000u
/* Frames a second of files that don't say. */
#define USUAL_FPS 30
/* Strain in 16 bits: each is so much; the last one is of what isn't known. */
#define STRAIN_STEP 1e-4
#define STRAIN_MOST 32767
#define STRAIN_UNKNOWN (-32768)

typedef struct
{
  ClothMeshReader *reader;
  const ClothTopology *topology;
  ClothStrains *strains;        /* NULL when uv is not known */
  guint n_frames, frame_step;   /* those kept, every so many */
  ClothPackBox box;
  gboolean has_sigma;
  guint16 *places;
  guint8 *states, *sigmas;
  gint16 *strain;
} Packed;

static void
clear_packed (Packed * self)
{
  cloth_mesh_reader_free (self->reader);
  cloth_strains_free (self->strains);
  g_free (self->places);
  g_free (self->states);
  g_free (self->sigmas);
  g_free (self->strain);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Packed, clear_packed);
/* How many frames fit into @bytes; one is shown whatever it takes. */
static void
thin (Packed * self, gsize bytes)
{
  const gsize of_vertex = 3 * sizeof *self->places + sizeof *self->states +
      sizeof *self->sigmas + (self->strains ? 3 * sizeof *self->strain : 0);
  const guint n_all = cloth_mesh_reader_get_n_frames (self->reader);
  const gsize n_most = MAX (bytes / (of_vertex * self->topology->n_vertices),
      1);

  self->frame_step = (guint) ((n_all + n_most - 1) / n_most);
  self->n_frames = (n_all - 1) / self->frame_step + 1;
}

static gboolean
find_box (Packed * self, GError ** error)
{
  gfloat low[3] = { INFINITY, INFINITY, INFINITY };
  gfloat high[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (guint f = 0; f < self->n_frames; f++) {
    ClothMeshFrame frame;

    if (!cloth_mesh_reader_read (self->reader, f * self->frame_step, &frame,
            error))
      return FALSE;
    self->has_sigma |= frame.covariances != NULL;
    for (gsize i = 0; i < 3 * (gsize) self->topology->n_vertices; i++) {
      if (isfinite (frame.positions[i])) {
        low[i % 3] = MIN (low[i % 3], frame.positions[i]);
        high[i % 3] = MAX (high[i % 3], frame.positions[i]);
      }
    }
  }
  cloth_pack_box (&self->box, low, high, 0);
  return TRUE;
}

/* RMS of the three axes. */
static gdouble
sigma_of (const gfloat * covariance)
{
  return sqrt (((gdouble) covariance[0] + covariance[3] + covariance[5]) / 3);
}

static void
pack_strain (ClothStrains * strains, const ClothMeshFrame * frame, gsize n,
    gint16 * packed)
{
  const gfloat *strain;

  cloth_strains_measure (strains, frame->positions, frame->states);
  strain = cloth_strains_get_vertices (strains);
  for (gsize i = 0; i < CLOTH_STRAIN_SIZE * n; i++)
    packed[i] = GINT16_TO_LE (isnan (strain[i]) ? STRAIN_UNKNOWN :
        (gint16) CLAMP (round (strain[i] / STRAIN_STEP), -STRAIN_MOST,
            STRAIN_MOST));
}

static gboolean
pack_frames (Packed * self, GError ** error)
{
  const gsize n = self->topology->n_vertices, all = n * self->n_frames;

  self->places = g_new (guint16, 3 * all);
  self->states = g_new (guint8, all);
  self->sigmas = self->has_sigma ? g_new (guint8, all) : NULL;
  self->strain = self->strains ? g_new (gint16, CLOTH_STRAIN_SIZE * all) : NULL;
  for (gsize f = 0; f < self->n_frames; f++) {
    ClothMeshFrame frame;

    if (!cloth_mesh_reader_read (self->reader, (guint) f * self->frame_step,
            &frame, error))
      return FALSE;
    for (gsize i = 0; i < n; i++)
      cloth_pack_place (&self->box, frame.positions + 3 * i,
          self->places + 3 * (f * n + i));
    memcpy (self->states + f * n, frame.states, n);
    for (gsize i = 0; self->sigmas && i < n; i++)
      self->sigmas[f * n + i] = cloth_pack_sigma (frame.covariances ?
          sigma_of (frame.covariances + 6 * i) : NAN);
    if (self->strains)
      pack_strain (self->strains, &frame, n,
          self->strain + CLOTH_STRAIN_SIZE * f * n);
  }
  return TRUE;
}

static gboolean
load_take (Packed * self, const gchar * location, gsize bytes, GError ** error)
{
  self->reader = cloth_mesh_reader_open (location, CLOTH_MESH_FORMAT_AUTO,
      error);
  if (!self->reader) {
    if (!g_file_test (location, G_FILE_TEST_EXISTS))
      g_prefix_error (error, "“%s” is neither a take nor a mesh file: ",
          location);
    return FALSE;
  }
  self->topology = cloth_mesh_reader_get_topology (self->reader);
  self->strains = cloth_strains_new (self->topology);
  thin (self, bytes);
  return find_box (self, error) && pack_frames (self, error);
}

static void
put_take (ClothJsonWriter * writer, const Packed * self, const gchar * name)
{
  const gsize n = (gsize) self->n_frames * self->topology->n_vertices;
  const gdouble *times = cloth_mesh_reader_get_times (self->reader);
  const gdouble fps = cloth_mesh_reader_get_fps (self->reader);
  g_autofree gdouble *kept = g_new (gdouble, self->n_frames);

  for (guint f = 0; f < self->n_frames; f++) {
    const guint at = f * self->frame_step;

    kept[f] = times ? times[at] : at / (fps > 0 ? fps : USUAL_FPS);
  }
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "name", name);
  cloth_json_writer_count (writer, "all_frames",
      cloth_mesh_reader_get_n_frames (self->reader));
  cloth_json_writer_count (writer, "frame_step", self->frame_step);
  cloth_json_writer_numbers (writer, "times", kept, self->n_frames);
  cloth_pack_put_box (writer, &self->box);
  cloth_pack_put_topology (writer, self->topology);
  cloth_pack_put_bytes (writer, "places", self->places,
      3 * n * sizeof *self->places);
  cloth_pack_put_bytes (writer, "states", self->states, n);
  if (self->sigmas)
    cloth_pack_put_sigmas (writer, self->sigmas, n);
  if (self->strain) {
    cloth_pack_put_bytes (writer, "strain", self->strain,
        CLOTH_STRAIN_SIZE * n * sizeof *self->strain);
    cloth_json_writer_number (writer, "strain_step", STRAIN_STEP);
  }
  cloth_json_writer_end_object (writer);
}

/* The last part of its path, or, where another has the same, the whole.
 *
 * Returns: (transfer full): how the take is called */
static gchar *
name_of (const gchar * const *locations, guint n, guint which)
{
  g_autofree gchar *base = g_path_get_basename (locations[which]);

  for (guint i = 0; i < n; i++) {
    g_autofree gchar *other = g_path_get_basename (locations[i]);

    if (i != which && g_str_equal (base, other))
      return g_filename_display_name (locations[which]);
  }
  return g_filename_display_name (base);
}

/* @locations: takes, or mesh sequences in any format that can be read
 * @n: how many, 1 … %CLOTH_VIEW_MAX_TAKES
 * @path: where the page shall be
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Writes a page that shows them. It needs no other file and no network. It appears whole
 * or not at all. Of long takes frames are left out: the file has some 17 MB at most, unless
 * a single frame of a fine mesh is more than its share.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_view_write (const gchar * const *locations, guint n, const gchar * path,
    GError ** error)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
  g_autoptr (GString) title = g_string_new (NULL);
  g_autofree gchar *json = NULL;
  ClothPagePart part = { "takes", NULL };

  g_return_val_if_fail (n >= 1 && n <= CLOTH_VIEW_MAX_TAKES, FALSE);
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_begin_array (writer, "takes");
  for (guint i = 0; i < n; i++) {
    g_auto (Packed) packed = { 0 };
    g_autofree gchar *name = name_of (locations, n, i);

    if (!load_take (&packed, locations[i], MAX_BYTES / n, error))
      return FALSE;
    put_take (writer, &packed, name);
    g_string_append_printf (title, "%s%s", i ? ", " : "", name);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_end_object (writer);
  json = cloth_json_writer_finish (writer);
  part.json = json;
  return cloth_page_write (path, "view", title->str,
      "The takes can be opened in other programs, too.", &part, 1, error);
}
