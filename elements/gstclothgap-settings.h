/* clothgap: its properties.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

typedef struct {
  /* NULL: not given */
  gchar *model, *location, *rig, *camera, *baseline, *effects, *output;
  guint64 seed;
  guint threads;
  gdouble window;               /* seconds */
} GstClothGapSettings;

void gst_cloth_gap_settings_install (GObjectClass * klass);
void gst_cloth_gap_settings_init (GstClothGapSettings * settings);
void gst_cloth_gap_settings_set (GstClothGapSettings * settings, guint id,
    const GValue * value);
void gst_cloth_gap_settings_get (const GstClothGapSettings * settings,
    guint id, GValue * value);
void gst_cloth_gap_settings_clear (GstClothGapSettings * settings);

G_END_DECLS
