/* clothgap: what a diagnosis is made of: the files that are read at the start, the camera of
 * an observation stream, and the recording that went by.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/fit/recording/recording.h"
#include "elements/gstclothdamage.h"
#include "gst/gap/diagnose.h"
#include "gst/mesh/topology.h"
#include "gst/sim/model.h"
#include "gst/sim/scene.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

/* The properties; a text is NULL when it is not given. */
typedef struct {
  gchar *model, *location, *rig, *camera, *baseline, *simulated, *effects, *output;
  guint64 seed;
  guint threads;
  gdouble window;               /* seconds */
  GstClothDamage damage;
} GstGapSettings;

typedef struct {
  ClothModel *model;
  ClothTake *take, *baseline, *simulated;
  ClothObservations *observations, *baseline_observations;        /* NULL: the take doesn't say */
  gchar **effects;
  ClothScene *scene;
} GstGapInputs;

/* Posts an error on @element when it fails. @inputs are to be cleared even then. */
gboolean gst_gap_inputs_load (GstGapInputs * inputs,
    GstElement * element, const GstGapSettings * settings);
/* Whether a mesh stream's caps are of the scene's cloth; else posts an error. */
gboolean gst_gap_inputs_check_mesh (const GstGapInputs * inputs,
    GstElement * element, const GstCaps * caps);
void gst_gap_inputs_clear (GstGapInputs * inputs);

typedef struct _GstGapView GstGapView;

/* All post an error on @element when they fail. */
GstGapView *gst_gap_view_new (GstElement * element,
    const GstGapSettings * settings, const ClothTopology * topology);
gboolean gst_gap_view_set_caps (GstGapView * view,
    GstElement * element, const GstCaps * caps);
/* @sequence, @offset_s: of the picture, and of the camera's clock to the rig's. What is
 * returned belongs to @view. @damage: set, and no error posted, when the picture contradicts
 * those before it. */
const ClothRays *gst_gap_view_read (GstGapView * view,
    GstElement * element, GstBuffer * picture, guint64 * sequence,
    gdouble * offset_s, GError ** damage);
/* Posts an error when no picture so far showed squares, dots or matches. */
gboolean gst_gap_view_check_seen (const GstGapView * view,
    GstElement * element);
void gst_gap_view_free (GstGapView * view);

typedef struct _GstGapRecord GstGapRecord;

GstGapRecord *gst_gap_record_new (const ClothTakeInfo * info,
    const ClothScene * scene, GError ** error);
gboolean gst_gap_record_append (GstGapRecord * record,
    gdouble time_s, const gfloat * positions, const guint8 * states,
    const gfloat * covariances, GError ** error);
ClothGapResult *gst_gap_record_diagnose (GstGapRecord * record,
    const ClothModel * model, const ClothGapOptions * options,
    GError ** error);
void gst_gap_record_free (GstGapRecord * record);

G_END_DECLS
