/* clothgap: the files it reads at the start.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

#include "elements/gstclothgap-settings.h"
#include "gst/fit/recording/recording.h"
#include "gst/take/take.h"
#include "gst/sim/model.h"
#include "gst/sim/scene.h"

G_BEGIN_DECLS

typedef struct {
  ClothModel *model;
  ClothTake *take, *baseline;
  ClothObservations *observations, *baseline_observations;        /* NULL: the take doesn't say */
  gchar **effects;
  ClothScene *scene;
} GstClothGapInputs;

/* Posts an error on @element when it fails. @inputs are to be cleared even then. */
gboolean gst_cloth_gap_inputs_load (GstClothGapInputs * inputs,
    GstElement * element, const GstClothGapSettings * settings);
/* Whether a mesh stream's caps are of the scene's cloth; else posts an error. */
gboolean gst_cloth_gap_inputs_check_mesh (const GstClothGapInputs * inputs,
    GstElement * element, const GstCaps * caps);
void gst_cloth_gap_inputs_clear (GstClothGapInputs * inputs);

G_END_DECLS
