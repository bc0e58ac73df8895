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
#include "gst/cloth-io/points.h"
#include "gst/gap/inputs.h"

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

/* ---- the camera of an observation stream ---- */

struct _GstFollowView
{
  gchar *rig_file;
  gchar *property;              /* NULL: the metas name the camera */
  gchar *name;                  /* by which the camera was found; NULL: the only one */
  ClothRig *rig;
  const ClothCamera *camera;    /* NULL: not known yet */
  gint width, height;           /* of the stream */
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

  if (self->width == camera->width && self->height == camera->height)
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

GstFollowView *
gst_follow_view_new (GstElement * element,
    const GstFollowSettings * settings, const ClothTopology * topology)
{
  g_autofree gchar *beside = g_build_filename (settings->location, "rig.json",
      NULL);
  GstFollowView *self;

  if (topology->columns < 2 || topology->rows < 2) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("Observations name the vertices of a grid, but the scene's mesh is "
            "none."), ("location=%s", settings->location));
    return NULL;
  }
  self = g_new0 (GstFollowView, 1);
  if (settings->rig)
    self->rig_file = g_strdup (settings->rig);
  else if (g_file_test (beside, G_FILE_TEST_EXISTS))
    self->rig_file = g_steal_pointer (&beside);
  self->property = g_strdup (settings->camera);
  self->points = gst_cloth_io_points_new (topology->columns, topology->rows);
  self->rays = cloth_rays_new (topology->n_vertices);
  return self;
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

/* ---- the recording ---- */

struct _GstFollowRecord
{
  gchar *folder;                /* temporary */
  ClothTakeWriter *writer;
  /* the scene's clamps, for a recording whose frames have times of their own */
  guint n_held, n_frames;
  GArray *held;
  gdouble *times, *clamps;
  guint after;                  /* the first frame that isn't before the last one's time */
  gfloat *row;
};

/* The take starts with the first mesh that is appended. @info: of the scene's take. */
GstFollowRecord *
gst_follow_record_new (const ClothTakeInfo * info, const ClothScene * scene,
    GError ** error)
{
  GstFollowRecord *record = g_new0 (GstFollowRecord, 1);
  g_autoptr (ClothTakeInfo) flat = cloth_take_info_copy (info);
  gsize n;

  record->folder = g_dir_make_tmp ("clothfollow-XXXXXX", error);
  record->writer = record->folder ? cloth_take_writer_new (record->folder, flat,
      scene->topology, error) : NULL;
  if (!record->writer) {
    gst_follow_record_free (record);
    return NULL;
  }
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
  if (record->n_held > 0)
    find_clamps (record, time_s);
  return cloth_take_writer_append (record->writer, time_s,
      positions, states, covariances, record->row, error);
}

ClothTake *
gst_follow_record_finish (GstFollowRecord * record, GError ** error)
{
  return cloth_take_writer_close (record->writer, error) ?
      cloth_take_open (record->folder, error) : NULL;
}

static void
remove_folder (const gchar * folder)
{
  GDir *dir = g_dir_open (folder, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

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
  if (record->folder)
    remove_folder (record->folder);
  g_free (record->folder);
  g_clear_pointer (&record->held, g_array_unref);
  g_free (record->times);
  g_free (record->clamps);
  g_free (record->row);
  g_free (record);
}
