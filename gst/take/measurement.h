/* What a recording makes of the positions of a cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/effect/effect.h"
#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* @matrix: A, row by row
 * @shift: b, m
 * @mirrored: 1 when the columns of the labels run the other way, else 0
 * @turned: by how many quarter turns the labels are turned then
 * @columns: by how many columns they are shifted then
 * @rows: by how many rows
 * @time_factor: what the recording's clock runs by while one second passes, s
 * @delay_s: how late its time stamps are, s
 * @smoothing_s: standard deviation of the bell that smooths positions in time, s
 *
 * What is at x is recorded at A x + b, with another label, and its time stamps count from
 * that of the first frame on: t is recorded as @time_factor·t + @delay_s. The three act on
 * different things, so their order doesn't matter.
 */
typedef struct {
  gdouble matrix[9];
  gdouble shift[3];
  gdouble mirrored;
  gdouble turned;
  gdouble columns;
  gdouble rows;
  gdouble time_factor;
  gdouble delay_s;
  gdouble smoothing_s;
} ClothMeasurement;

/* What each effect changes in a measurement; null @values leave every bit of it as it is. */
#define RECORDING(name) \
    void cloth_measurement_##name (const gdouble * values, \
        ClothMeasurement * measurement);
#include "gst/effect/list.h"

void cloth_measurement_init (ClothMeasurement * measurement);
void cloth_measurement_add_effect (ClothMeasurement * measurement,
    const ClothEffect * effect, const gdouble * values);
void cloth_measurement_map (ClothMeasurement * measurement,
    const gdouble matrix[9], const gdouble shift[3]);
gchar *cloth_measurement_find_fault (const ClothMeasurement * measurement,
    const ClothTopology * topology);
gboolean cloth_measurement_is_null (const ClothMeasurement * measurement);
gboolean cloth_measurement_is_equal (const ClothMeasurement * a,
    const ClothMeasurement * b);
gboolean cloth_measurement_takes_time (const ClothMeasurement * measurement);
gboolean cloth_measurement_changes_labels (const ClothMeasurement *
    measurement);
void cloth_measurement_apply (const ClothMeasurement * measurement,
    const ClothTopology * topology, const gdouble * positions,
    gdouble * recorded);
void cloth_measurement_invert (const ClothMeasurement * measurement,
    gdouble matrix[9]);
gint *cloth_measurement_list_labels (const ClothMeasurement * measurement,
    const ClothTopology * topology);

G_END_DECLS
