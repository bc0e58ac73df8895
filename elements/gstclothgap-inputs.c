/* clothgap: the files it reads at the start.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothgap-inputs.h"

#include "gst/cloth-io/observations.h"
#include "elements/gstclothutil.h"
#include "elements/gstmeshformat.h"
#include "gst/gap/inputs.h"

static gboolean
fail (GstElement * element, const gchar * property, const gchar * path,
    const GError * error)
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

static gboolean
load_baseline (GstClothGapInputs * self, const gchar * folder, GError ** error)
{
  if (!folder)
    return TRUE;
  self->baseline = cloth_take_open (folder, error);
  return self->baseline && cloth_gap_check_same_cloth ("the baseline",
      cloth_take_get_topology (self->baseline), "the take of location",
      cloth_take_get_topology (self->take), error)
      && gst_cloth_io_observations_load (folder,
      cloth_take_get_topology (self->baseline), &self->baseline_observations,
      error);
}

gboolean
gst_cloth_gap_inputs_load (GstClothGapInputs * inputs, GstElement * element,
    const GstClothGapSettings * settings)
{
  GstClothGapInputs *self = inputs;
  g_autoptr (GError) error = NULL;

  if (!require (element, settings->model, "model", "a model.json") ||
      !require (element, settings->location, "location",
          "the folder of a take that gives clamps and obstacles"))
    return FALSE;
  self->model = cloth_model_load (settings->model, &error);
  if (!self->model)
    return fail (element, "model", settings->model, error);
  self->take = cloth_take_open (settings->location, &error);
  self->scene = self->take ? cloth_scene_new_from_take (self->take, &error) :
      NULL;
  if (!self->scene || !gst_cloth_io_observations_load (settings->location,
          cloth_take_get_topology (self->take), &self->observations, &error))
    return fail (element, "location", settings->location, error);
  if (!load_baseline (self, settings->baseline, &error))
    return fail (element, "baseline", settings->baseline, error);
  self->effects = cloth_gap_effects_parse (settings->effects, &error);
  return !error || fail (element, "effects", settings->effects, error);
}

gboolean
gst_cloth_gap_inputs_check_mesh (const GstClothGapInputs * inputs,
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
gst_cloth_gap_inputs_clear (GstClothGapInputs * inputs)
{
  g_clear_pointer (&inputs->scene, cloth_scene_free);
  g_clear_pointer (&inputs->take, cloth_take_free);
  g_clear_pointer (&inputs->baseline, cloth_take_free);
  g_clear_pointer (&inputs->observations, cloth_observations_free);
  g_clear_pointer (&inputs->baseline_observations, cloth_observations_free);
  g_clear_pointer (&inputs->model, cloth_model_free);
  g_clear_pointer (&inputs->effects, g_strfreev);
}
