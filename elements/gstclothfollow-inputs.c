/* What a stream is followed with: the files that are read at the start, the camera of an
 * observation stream, and the recording that went by.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothfollow-inputs.h"

#include <glib/gstdio.h>
#include <math.h>

#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"
#include "gst/cloth-io/observations.h"
#include "gst/cloth-io/points.h"
#include "gst/file/npy.h"
#include "gst/file/output.h"
#include "gst/gap/inputs.h"
#include "gst/rig/rigfile.h"

#define RIG "rig.json"
#define OBSERVATIONS "observations"

/* ---- files ---- */

gboolean
gst_follow_fail (GstElement * element, const gchar * property,
    const gchar * path, const GError * error)
{
  GST_ELEMENT_ERROR (element, RESOURCE, OPEN_READ, ("Can't use the %s: %s",
          property, error->message), ("%s=%s", property, path));
  return FALSE;
}

static gboolean
require (GstElement * element, const gchar * value, const gchar * name,
    const gchar * what)
{
  if (value)
    return TRUE;
  GST_ELEMENT_ERROR (element, RESOURCE, NOT_FOUND,
      ("No %s given: set the property “%s” to %s", name, name, what),
      (NULL));
  return FALSE;
}

gboolean
gst_follow_inputs_load (GstFollowInputs * inputs, GstElement * element,
    const GstFollowSettings * settings)
{
  GstFollowInputs *self = inputs;
  g_autoptr (GError) error = NULL;

  if (!require (element, settings->model, "model", "a model.json") ||
      !require (element, settings->location, "location",
          "the folder of a take that gives clamps and obstacles"))
    return FALSE;
  self->model = cloth_model_load (settings->model, &error);
  if (!self->model)
    return gst_follow_fail (element, "model", settings->model, error);
  self->take = cloth_take_open (settings->location, &error);
  self->scene = self->take ? cloth_scene_new_from_take (self->take, &error) :
      NULL;
  return (self->scene && cloth_scene_check_paths (self->scene, &error))
      || gst_follow_fail (element, "location", settings->location, error);
}

gboolean
gst_follow_inputs_check_mesh (const GstFollowInputs * inputs,
    GstElement * element, const GstCaps * caps)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) parsed = gst_cloth_read_topology (element, caps);
  g_autoptr (ClothTopology) topology = NULL;

  if (!parsed)
    return FALSE;
  topology = gst_mesh_copy_topology (parsed);
  if (cloth_gap_check_same_cloth ("the stream", topology, "the take",
          inputs->scene->topology, &error))
    return TRUE;
  GST_ELEMENT_ERROR (element, STREAM, FORMAT,
      ("The stream is not of the scene's cloth: %s", error->message),
      ("Set location= to the take of this recording."));
  return FALSE;
}

void
gst_follow_inputs_clear (GstFollowInputs * inputs)
{
  g_clear_pointer (&inputs->scene, cloth_scene_free);
  g_clear_pointer (&inputs->take, cloth_take_free);
  g_clear_pointer (&inputs->model, cloth_model_free);
}

gchar *
gst_follow_find_rig (const GstFollowSettings * settings)
{
  g_autofree gchar *beside = g_build_filename (settings->location, RIG, NULL);

  if (settings->rig)
    return g_strdup (settings->rig);
  return g_file_test (beside, G_FILE_TEST_EXISTS) ? g_steal_pointer (&beside) :
      NULL;
}

/* ---- the camera of an observation stream ---- */

struct _GstFollowView
{
  gchar *rig_file;
  gchar *property;              /* NULL: the metas name the camera */
  gchar *name;                  /* by which the camera was found; NULL: the only one */
  ClothRig *rig;
  const ClothCamera *camera;    /* NULL: not known yet */
  gint width, height;           /* of the stream; 0: it doesn't say */
  GstClothIoPoints *points;
  ClothRays *rays;
  guint64 sequence;             /* of the next picture */
  gboolean shows;               /* whether the last picture had squares, dots or matches */
  gboolean seen;                /* whether any had */
};

static gboolean
check_size (const GstFollowView * self, GstElement * element)
{
  const ClothCamera *camera = self->camera;

  if (self->width == 0 || (self->width == camera->width
          && self->height == camera->height))
    return TRUE;
  GST_ELEMENT_ERROR (element, STREAM, FORMAT,
      ("Pictures are %d×%d, but camera “%s” was calibrated at %d×%d.",
          self->width, self->height, camera->name, camera->width,
          camera->height),
      ("Film at the calibrated size, put videoscale after the detector, or "
          "calibrate at this size."));
  return FALSE;
}

static gboolean
open_camera (GstFollowView * self, GstElement * element, const gchar * name)
{
  if (self->camera && g_strcmp0 (name, self->name) == 0)
    return TRUE;
  if (self->camera && name) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("A picture is of camera “%s”, those before it are of “%s”.",
            name, self->camera->name),
        ("Give each camera an element of its own, or all of them one "
            "triangulate before it."));
    return FALSE;
  }
  if (self->camera)
    return TRUE;
  self->rig = gst_cloth_open_rig (element, self->rig_file, name, &self->camera);
  if (!self->rig)
    return FALSE;
  self->name = g_strdup (name);
  return check_size (self, element);
}

static GstFollowView *
view_new (const gchar * rig_file, const gchar * camera,
    const ClothTopology * topology)
{
  GstFollowView *self = g_new0 (GstFollowView, 1);

  self->rig_file = g_strdup (rig_file);
  self->property = g_strdup (camera);
  self->points = gst_cloth_io_points_new (topology->columns, topology->rows);
  self->rays = cloth_rays_new (topology->n_vertices);
  return self;
}

GstFollowView *
gst_follow_view_new (GstElement * element,
    const GstFollowSettings * settings, const ClothTopology * topology)
{
  g_autofree gchar *rig_file = gst_follow_find_rig (settings);

  if (topology->columns < 2 || topology->rows < 2) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("Observations name the vertices of a grid, but the scene's mesh is "
            "none."), ("location=%s", settings->location));
    return NULL;
  }
  return view_new (rig_file, settings->camera, topology);
}

/* What can be known before the first picture is checked now. */
gboolean
gst_follow_view_set_caps (GstFollowView * view, GstElement * element,
    const GstCaps * caps)
{
  const GstStructure *s = gst_caps_get_structure (caps, 0);

  view->width = view->height = 0;
  gst_structure_get_int (s, "width", &view->width);
  gst_structure_get_int (s, "height", &view->height);
  if (view->camera)
    return check_size (view, element);
  return (view->rig_file && !view->property)
      || open_camera (view, element, view->property);
}

/* A picture that shows nothing has no rays, and may not say whose it is. */
const ClothRays *
gst_follow_view_read (GstFollowView * view, GstElement * element,
    GstBuffer * picture, guint64 * sequence, GError ** damage)
{
  GstClothIoPoints *points = view->points;
  g_autoptr (GError) error = NULL;
  const gchar *name;

  view->shows = gst_cloth_io_points_has_any (picture);
  if (!view->shows) {
    cloth_rays_clear (view->rays);
  } else {
    if (!gst_cloth_io_points_find (points, picture, &error)) {
      if (view->seen) {
        g_propagate_error (damage, g_steal_pointer (&error));
        return NULL;
      }
      GST_ELEMENT_ERROR (element, STREAM, FORMAT,
          ("A picture is not of the scene's cloth: %s", error->message),
          (NULL));
      return NULL;
    }
    name = view->property ? view->property :
        points->camera && *points->camera ? points->camera : NULL;
    if (view->seen && name && view->name && g_strcmp0 (name, view->name) != 0) {
      g_set_error (damage, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
          "a picture is of camera “%s”, those before it are of “%s”",
          name, view->name);
      return NULL;
    }
    if (!open_camera (view, element, name))
      return NULL;
    if (!gst_cloth_io_points_check_places (points, view->camera, &error)) {
      if (view->seen) {
        g_propagate_error (damage, g_steal_pointer (&error));
        return NULL;
      }
      GST_ELEMENT_ERROR (element, STREAM, FORMAT,
          ("A picture is not of the camera “%s”: %s", view->camera->name,
              error->message), (NULL));
      return NULL;
    }
    cloth_rays_cast (view->rays, view->camera, &points->view);
    view->sequence = points->sequence;
    view->seen = TRUE;
  }
  *sequence = view->sequence++;
  return view->rays;
}

const ClothTriangulateView *
gst_follow_view_get_points (const GstFollowView * view,
    const ClothCamera ** camera)
{
  *camera = view->camera;
  return view->shows ? &view->points->view : NULL;
}

gdouble
gst_follow_view_get_offset (const GstFollowView * view)
{
  return view->camera ? view->camera->offset_s : 0.;
}

void
gst_follow_view_restart (GstFollowView * view)
{
  view->shows = view->seen = FALSE;
}

gboolean
gst_follow_view_check_seen (const GstFollowView * view, GstElement * element)
{
  if (view->seen)
    return TRUE;
  GST_ELEMENT_ERROR (element, STREAM, FAILED,
      ("No picture showed squares, dots or matches of the cloth."),
      ("Put “saddledetect ! quadtrack”, “dotlabel” or “siftmatch” before "
          "clothmetapay."));
  return FALSE;
}

void
gst_follow_view_free (GstFollowView * view)
{
  if (!view)
    return;
  g_free (view->rig_file);
  g_free (view->property);
  g_free (view->name);
  cloth_rig_free (view->rig);
  gst_cloth_io_points_free (view->points);
  cloth_rays_free (view->rays);
  g_free (view);
}

/* ---- the cameras of a mesh ---- */

struct _GstFollowCameras
{
  gchar *rig_file;
  ClothRig *rig;
  const ClothTopology *topology;
  GstFollowView *views[CLOTH_RIG_MAX_CAMERAS];  /* NULL: it saw nothing yet */
  ClothRays *rays;
  guint8 *n_seen;               /* how many cameras saw a vertex */
};

GstFollowCameras *
gst_follow_cameras_new (GstElement * element, const gchar * rig_file,
    const ClothTopology * topology)
{
  g_autoptr (GError) error = NULL;
  ClothRig *rig = cloth_rig_load (rig_file, &error);
  GstFollowCameras *self;

  if (!rig) {
    gst_follow_fail (element, "rig", rig_file, error);
    return NULL;
  }
  self = g_new0 (GstFollowCameras, 1);
  self->rig_file = g_strdup (rig_file);
  self->rig = rig;
  self->topology = topology;
  self->rays = cloth_rays_new (topology->n_vertices);
  self->n_seen = g_malloc (topology->n_vertices);
  return self;
}

/* What the view's camera has; NULL when an error was posted. */
static GstFollowView *
find_view (GstFollowCameras * self, GstElement * element, const gchar * name)
{
  const ClothCamera *camera = cloth_rig_find (self->rig, name);
  guint i;

  if (!camera) {
    GST_ELEMENT_ERROR (element, RESOURCE, SETTINGS,
        ("A mesh was made of what camera “%s” saw, which %s does not have.",
            name, self->rig_file), ("Set rig= to the one of triangulate."));
    return NULL;
  }
  i = (guint) (camera - self->rig->cameras);
  if (!self->views[i])
    self->views[i] = view_new (self->rig_file, name, self->topology);
  return self->views[i];
}

/* Adds what one camera saw; FALSE when an error was posted, or there is @damage. */
static gboolean
read_view (GstFollowCameras * self, GstElement * element,
    const GstClothView * seen, GError ** damage)
{
  const gchar *name = gst_cloth_view_get_camera (seen);
  GstFollowView *view = find_view (self, element, name);
  g_autoptr (GstBuffer) picture = gst_buffer_new ();
  const ClothRays *rays;
  guint64 sequence;

  if (!view
      || !gst_cloth_observations_unpack (gst_cloth_view_get_observation (seen),
          picture, damage)
      || !(rays = gst_follow_view_read (view, element, picture, &sequence,
              damage)))
    return FALSE;
  if (view->shows && *view->points->camera
      && !g_str_equal (view->points->camera, name)) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("What camera “%s” saw says that it is of “%s”.", name,
            view->points->camera),
        ("Give a detector the name that its pad of triangulate has."));
    return FALSE;
  }
  for (guint v = 0; v < rays->n; v++) {
    if (!cloth_rays_has (rays, v))
      continue;
    cloth_rays_take (self->rays, rays, v);
    self->n_seen[v]++;
  }
  return TRUE;
}

/* What several cameras saw and the mesh has not, they contradict each other about. */
const ClothRays *
gst_follow_cameras_read (GstFollowCameras * cameras, GstElement * element,
    GstBuffer * buffer, const GstClothMesh * mesh, GError ** damage)
{
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);
  const GstClothView *seen;

  cloth_rays_clear (cameras->rays);
  memset (cameras->n_seen, 0, cameras->topology->n_vertices);
  for (guint i = 0; (seen = gst_buffer_get_nth_cloth_view (buffer, i)); i++)
    if (!read_view (cameras, element, seen, damage))
      return NULL;
  for (guint v = 0; v < cameras->topology->n_vertices; v++)
    if (cameras->n_seen[v] != 1 || states[v] == GST_CLOTH_VERTEX_MEASURED
        || states[v] == GST_CLOTH_VERTEX_TWO_VIEWS)
      cloth_rays_drop (cameras->rays, v);
  return cameras->rays;
}

void
gst_follow_cameras_restart (GstFollowCameras * cameras)
{
  for (guint i = 0; i < cameras->rig->n_cameras; i++)
    if (cameras->views[i])
      gst_follow_view_restart (cameras->views[i]);
}

void
gst_follow_cameras_free (GstFollowCameras * cameras)
{
  if (!cameras)
    return;
  for (guint i = 0; i < cameras->rig->n_cameras; i++)
    gst_follow_view_free (cameras->views[i]);
  g_free (cameras->rig_file);
  cloth_rig_free (cameras->rig);
  cloth_rays_free (cameras->rays);
  g_free (cameras->n_seen);
  g_free (cameras);
}

/* ---- the recording ---- */

/* What one camera saw. */
typedef struct
{
  ClothOutput *output;
  GstClockTime last;
} Seen;

struct _GstFollowRecord
{
  gchar *folder;                /* temporary */
  ClothTakeWriter *writer;
  gfloat *start;                /* of the scene; NULL: not known, or not of the first frame */
  GHashTable *seen;             /* Seen of a camera's name; NULL: there are no cameras */
  guint n_vertices;
  gdouble slack;                /* how far two times of one frame may be apart, s */
  gboolean is_begun;
  /* the scene's clamps, for a recording whose frames have times of their own */
  guint n_held, n_frames;
  GArray *held;
  gdouble *times, *clamps;
  guint after;                  /* the first frame that isn't before the last one's time */
  gfloat *row;
};

static void
seen_free (gpointer item)
{
  Seen *seen = item;

  cloth_output_free (seen->output);
  g_free (seen);
}

/* Where the take says that its first frame is. */
static gboolean
read_start (GstFollowRecord * record, ClothTake * take, GError ** error)
{
  if (cloth_take_get_n_positions (take) == 0)
    return TRUE;
  record->start = g_new (gfloat,
      3 * (gsize) cloth_take_get_topology (take)->n_vertices);
  return cloth_take_read_positions (take, 0, record->start, error);
}

/* The take starts with the first mesh that is appended. @take: the scene's. */
GstFollowRecord *
gst_follow_record_new (ClothTake * take, const ClothScene * scene,
    GError ** error)
{
  GstFollowRecord *record = g_new0 (GstFollowRecord, 1);
  g_autoptr (ClothTakeInfo) flat =
      cloth_take_info_copy (cloth_take_get_info (take));
  gsize n;

  record->folder = g_dir_make_tmp ("clothfollow-XXXXXX", error);
  record->writer = record->folder && read_start (record, take, error) ?
      cloth_take_writer_new (record->folder, flat, scene->topology,
      error) : NULL;
  if (!record->writer) {
    gst_follow_record_free (record);
    return NULL;
  }
  record->n_vertices = scene->topology->n_vertices;
  record->slack = 0.5 / scene->fps;
  record->n_held = scene->held->len;
  record->n_frames = scene->n_frames;
  record->held = g_array_copy (scene->held);
  n = 3 * (gsize) record->n_held;
  record->times = g_memdup2 (scene->times,
      record->n_frames * sizeof *record->times);
  if (n > 0) {
    record->clamps = g_memdup2 (scene->clamps,
        n * record->n_frames * sizeof *record->clamps);
    record->row = g_new (gfloat, n);
  }
  return record;
}

/* Where a clamp is logged in a frame; NULL: it doesn't hold then. */
static const gdouble *
find_logged (const GstFollowRecord * record, guint held, guint frame)
{
  return cloth_held_holds (&g_array_index (record->held, ClothHeld, held),
      record->times[frame]) ?
      record->clamps + 3 * ((gsize) frame * record->n_held + held) : NULL;
}

/* Between two logged places a clamp moves evenly. */
static void
find_clamps (GstFollowRecord * record, gdouble time)
{
  const guint last = record->n_frames - 1;
  guint before, after;
  gdouble share = 0.;

  while (record->after < record->n_frames
      && record->times[record->after] < time)
    record->after++;
  after = MIN (record->after, last);
  before = record->after > 0 ? record->after - 1 : 0;
  if (before < after)
    share = (time - record->times[before]) /
        (record->times[after] - record->times[before]);
  for (guint i = 0; i < record->n_held; i++) {
    const gdouble *a = find_logged (record, i, before);
    const gdouble *b = find_logged (record, i, after);

    /* of one that doesn't hold what stands there means nothing */
    if (!a && !b)
      a = b = record->clamps + 3 * ((gsize) after * record->n_held + i);
    a = a ? a : b;
    b = b ? b : a;
    for (guint k = 0; k < 3; k++)
      record->row[3 * i + k] = (gfloat) (a[k] + share * (b[k] - a[k]));
  }
}

gboolean
gst_follow_record_append (GstFollowRecord * record, gdouble time_s,
    const gfloat * positions, const guint8 * states, const gfloat * covariances,
    GError ** error)
{
  if (!record->is_begun && fabs (time_s - record->times[0]) > record->slack)
    g_clear_pointer (&record->start, g_free);
  record->is_begun = TRUE;
  if (record->n_held > 0)
    find_clamps (record, time_s);
  return cloth_take_writer_append (record->writer, time_s,
      positions, states, covariances, record->row, error);
}

static gchar *
in_folder (const GstFollowRecord * record, const gchar * name)
{
  return g_build_filename (record->folder, name, NULL);
}

/* A take with what cameras saw has their rig. */
static gboolean
begin_seen (GstFollowRecord * record, const gchar * rig_file, GError ** error)
{
  g_autofree gchar *rig = in_folder (record, RIG);
  g_autofree gchar *folder = in_folder (record, OBSERVATIONS);
  g_autofree gchar *text = NULL;
  gsize length;

  if (record->seen)
    return TRUE;
  if (!g_file_get_contents (rig_file, &text, &length, error)
      || !g_file_set_contents (rig, text, (gssize) length, error)
      || !cloth_folder_make (folder, error))
    return FALSE;
  record->seen = g_hash_table_new_full (g_str_hash, g_str_equal, g_free,
      seen_free);
  return TRUE;
}

/* A camera's file begins with the first picture that shows anything. NULL: with none yet, or there is
 * an error. */
static Seen *
find_seen (GstFollowRecord * record, const GstFollowCameras * cameras,
    const GstClothView * view, GError ** error)
{
  const gchar *name = gst_cloth_view_get_camera (view);
  Seen *seen = record->seen ? g_hash_table_lookup (record->seen, name) : NULL;
  g_autoptr (GstBuffer) picture = NULL;
  g_autofree gchar *file = NULL, *path = NULL;
  ClothOutput *output;

  if (seen)
    return seen;
  picture = gst_buffer_new ();
  if (!gst_cloth_observations_unpack (gst_cloth_view_get_observation (view),
          picture, error) || !(gst_cloth_io_points_has_any (picture)
          || gst_buffer_get_cloth_silhouette (picture))
      || !begin_seen (record, cameras->rig_file, error))
    return NULL;
  file = g_strconcat (OBSERVATIONS G_DIR_SEPARATOR_S, name, ".obs", NULL);
  path = in_folder (record, file);
  output = cloth_output_new (path, error);
  if (!output)
    return NULL;
  seen = g_new0 (Seen, 1);
  seen->output = output;
  seen->last = GST_CLOCK_TIME_NONE;
  g_hash_table_insert (record->seen, g_strdup (name), seen);
  return seen;
}

/* A camera's times rise in a file. */
static gboolean
see_one (GstFollowRecord * record, const GstFollowCameras * cameras,
    const GstClothView * view, GstClockTime time, GError ** error)
{
  GError *fault = NULL;
  Seen *seen = find_seen (record, cameras, view, &fault);

  if (fault)
    g_propagate_error (error, fault);
  if (!seen)
    return fault == NULL;
  if (GST_CLOCK_TIME_IS_VALID (seen->last) && time <= seen->last)
    return TRUE;
  seen->last = time;
  return gst_cloth_io_observations_write (seen->output,
      gst_cloth_view_get_observation (view), time, error);
}

gboolean
gst_follow_record_see (GstFollowRecord * record,
    const GstFollowCameras * cameras, GstBuffer * buffer,
    const GstSegment * segment, gdouble time_s, GError ** error)
{
  const GstClothView *view;

  for (guint i = 0; (view = gst_buffer_get_nth_cloth_view (buffer, i)); i++) {
    const ClothCamera *camera = cloth_rig_find (cameras->rig,
        gst_cloth_view_get_camera (view));
    GstClockTime time = gst_cloth_stream_time (segment,
        gst_cloth_view_get_observation (view));

    /* streams that tell no time are of one instant */
    if (!GST_CLOCK_TIME_IS_VALID (time))
      time = (GstClockTime) MAX (0., (time_s + camera->offset_s) * 1e9 + 0.5);
    if (!see_one (record, cameras, view, time, error))
      return FALSE;
  }
  return TRUE;
}

/* Of a take that cameras saw only the start has positions. */
static gboolean
write_start (const GstFollowRecord * record, GError ** error)
{
  static const gchar *const names[] =
      { "positions.npy", "states.npy", "covariance.npy" };
  const guint64 shape[] = { record->n_vertices, 3 };
  g_autofree gchar *path = in_folder (record, names[0]);
  g_autoptr (ClothNpyWriter) writer = NULL;
  ClothOutput *output;

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *old = in_folder (record, names[i]);

    g_unlink (old);
  }
  if (!record->start)
    return TRUE;
  output = cloth_output_new (path, error);
  writer = output ? cloth_npy_writer_new (output, CLOTH_NPY_FLOAT32, 3, shape,
      error) : NULL;
  return writer && cloth_npy_writer_append (writer, record->start, 1, error)
      && cloth_npy_writer_finish (writer, error);
}

static gboolean
commit_seen (const GstFollowRecord * record, GError ** error)
{
  GHashTableIter iterator;
  gpointer seen;

  g_hash_table_iter_init (&iterator, record->seen);
  while (g_hash_table_iter_next (&iterator, NULL, &seen))
    if (!cloth_output_commit (((Seen *) seen)->output, error))
      return FALSE;
  return write_start (record, error);
}

ClothTake *
gst_follow_record_finish (GstFollowRecord * record,
    ClothObservations ** observations, GError ** error)
{
  g_autoptr (ClothTake) take = NULL;

  *observations = NULL;
  if (!cloth_take_writer_close (record->writer, error) || (record->seen
          && !commit_seen (record, error))
      || !(take = cloth_take_open (record->folder, error)) || (record->seen
          && !gst_cloth_io_observations_load_take (take, NULL, observations,
              error)))
    return NULL;
  return g_steal_pointer (&take);
}

static void
remove_folder (const gchar * folder)
{
  GDir *dir = g_dir_open (folder, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    if (g_str_equal (name, OBSERVATIONS))
      remove_folder (path);
    else
      g_unlink (path);
  }
  if (dir)
    g_dir_close (dir);
  g_rmdir (folder);
}

void
gst_follow_record_free (GstFollowRecord * record)
{
  if (!record)
    return;
  cloth_take_writer_free (record->writer);
  g_clear_pointer (&record->seen, g_hash_table_unref);
  if (record->folder)
    remove_folder (record->folder);
  g_free (record->folder);
  g_free (record->start);
  g_clear_pointer (&record->held, g_array_unref);
  g_free (record->times);
  g_free (record->clamps);
  g_free (record->row);
  g_free (record);
}
