/* clothgap: the camera of an observation stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothgap-view.h"

#include <math.h>

#include "gst/cloth-io/points.h"
#include "elements/gstclothutil.h"

struct _GstClothGapView
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
  gboolean seen;                /* whether any picture had squares or dots */
};

static gboolean
check_size (const GstClothGapView * self, GstElement * element)
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
open_camera (GstClothGapView * self, GstElement * element, const gchar * name)
{
  if (self->camera && g_strcmp0 (name, self->name) == 0)
    return TRUE;
  if (self->camera && name) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("A picture is of camera “%s”, those before it are of “%s”.",
            name, self->camera->name),
        ("Give each camera a clothgap of its own, or all of them one "
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

GstClothGapView *
gst_cloth_gap_view_new (GstElement * element,
    const GstClothGapSettings * settings, const ClothTopology * topology)
{
  g_autofree gchar *beside = g_build_filename (settings->location, "rig.json",
      NULL);
  GstClothGapView *self;

  if (topology->columns < 2 || topology->rows < 2) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("Observations name the vertices of a grid, but the scene's mesh is "
            "none."), ("location=%s", settings->location));
    return NULL;
  }
  self = g_new0 (GstClothGapView, 1);
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
gst_cloth_gap_view_set_caps (GstClothGapView * view, GstElement * element,
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
gst_cloth_gap_view_read (GstClothGapView * view, GstElement * element,
    GstBuffer * buffer, guint64 * sequence, gdouble * offset_s)
{
  GstClothIoPoints *points = view->points;
  g_autoptr (GstBuffer) picture = gst_buffer_new ();
  g_autoptr (GError) error = NULL;
  const gchar *name;

  if (!gst_cloth_observations_unpack (buffer, picture, &error)) {
    GST_ELEMENT_ERROR (element, STREAM, DECODE,
        ("The observation stream is damaged: %s. Write it anew with "
            "clothmetapay.", error->message), (NULL));
    return NULL;
  }
  if (!gst_buffer_get_cloth_quads (picture)
      && !gst_buffer_get_cloth_dots (picture)) {
    cloth_rays_clear (view->rays);
  } else {
    if (!gst_cloth_io_points_find (points, picture, &error)) {
      GST_ELEMENT_ERROR (element, STREAM, FORMAT,
          ("A picture is not of the scene's cloth: %s", error->message),
          (NULL));
      return NULL;
    }
    name = view->property ? view->property :
        points->camera && *points->camera ? points->camera : NULL;
    if (!open_camera (view, element, name))
      return NULL;
    if (!gst_cloth_io_points_check_places (points, view->camera, &error)) {
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
  *offset_s = view->camera ? view->camera->offset_s : 0.;
  return view->rays;
}

gboolean
gst_cloth_gap_view_check_seen (const GstClothGapView * view,
    GstElement * element)
{
  if (view->seen)
    return TRUE;
  GST_ELEMENT_ERROR (element, STREAM, FAILED,
      ("No picture showed squares or dots of the cloth."),
      ("Put “saddledetect ! quadtrack” or “dotlabel” before clothmetapay."));
  return FALSE;
}

void
gst_cloth_gap_view_free (GstClothGapView * view)
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
