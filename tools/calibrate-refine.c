/* refine: a rig corrected by a film of cloth, and what that changes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "calibrate-refine.h"

#include <math.h>

#include "gst/cloth-io/observations.h"
#include "gst/fit/error.h"
#include "gst/fit/rig/refine.h"
#include "gst/rig/rigfile.h"
#include "tools/tool.h"

/* What the cameras of a take saw, with the rig given in place of its own. */
static ClothObservations *
load (const gchar * rig_file, const gchar * folder, GError ** error)
{
  g_autoptr (ClothTake) take = cloth_take_open (folder, error);
  ClothObservations *observations = NULL;

  if (!take || !gst_cloth_io_observations_load_take (take, rig_file,
          &observations, error))
    return NULL;
  if (!observations)
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "“%s” has no folder observations: record what the cameras see by "
        "clothmetapay ! filesink location=observations/CAMERA.obs", folder);
  return observations;
}

static gdouble
length (const gdouble v[3])
{
  return sqrt (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void
show (const ClothRefinement * r)
{
  g_print ("%-12s %16s %16s %16s %16s %8s\n", "camera", "turned, mrad",
      "moved, mm", "focal, %", "late, ms", "points");
  for (guint c = 0; c < r->rig->n_cameras; c++) {
    const ClothRefineCamera *camera = &r->cameras[c];

    if (camera->n == 0) {
      g_print ("%-12s saw nothing that another one did; it stays as it was\n",
          r->rig->cameras[c].name);
      continue;
    }
    g_print
        ("%-12s %8.3f ± %5.3f %8.3f ± %5.3f %8.3f ± %5.3f %8.3f ± %5.3f "
        "%8u\n", r->rig->cameras[c].name, 1e3 * length (camera->turned_rad),
        1e3 * length (camera->turned_sd), 1e3 * length (camera->moved_m),
        1e3 * length (camera->moved_sd), 100. * camera->focal,
        100. * camera->focal_sd, 1e3 * camera->late_s, 1e3 * camera->late_sd,
        camera->n);
  }
  if (!r->settled)
    g_print
        ("The numbers still moved when the search ended: refine the rig that "
        "was written once more.\n");
  g_print ("%u places of the cloth, %u observations. They disagree by %.2f px "
      "beside what the pictures' noise makes.\nReprojection χ² over the "
      "degrees of freedom: %.3f, was %.3f; observations that contradict the "
      "others: %.1f%%, were %.1f%%\n", r->n_points, r->n_observations,
      sqrt (r->error_floor), r->after.chi_square, r->before.chi_square,
      100. * r->after.contradicted, 100. * r->before.contradicted);
}

gint
calibrate_refine (const gchar * rig_file, const gchar * folder,
    const gchar * output)
{
  const ClothRefineOptions options = CLOTH_REFINE_OPTIONS_DEFAULT;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRefinement) refinement = NULL;
  ClothObservations *observations = load (rig_file, folder, &error);

  if (!observations)
    return complain (FAILED, "%s", error->message);
  refinement = cloth_refine_rig (observations, &options, &error);
  cloth_observations_free (observations);
  if (!refinement || !cloth_rig_save (refinement->rig, output, &error))
    return complain (FAILED, "%s", error->message);
  show (refinement);
  g_print ("wrote %s\n", output);
  return DONE;
}
