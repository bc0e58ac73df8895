/* What a recording makes of the positions of a cloth.
 *
 * Model: what is at x is recorded at A x + b; row and column of its label are mirrored, turned
 *   and shifted; its time is told by a clock that runs too fast and late.
 * Assumption: cloth goes on straight beyond its edge, by less than a few edges: that is where a
 *   label that is shifted off the cloth points.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

#include <math.h>
#include <string.h>

typedef struct
{
  const ClothEffect *effect;
  void (*apply) (const gdouble * values, ClothMeasurement * measurement);
} RecordingEffect;

#define RECORDING(name) extern const ClothEffect cloth_effect_##name;
#include "gst/effect/list.h"

static const RecordingEffect effects[] = {
#define RECORDING(name) { &cloth_effect_##name, cloth_measurement_##name },
#include "gst/effect/list.h"
};

static const ClothMeasurement null = {
  .matrix = {1., 0., 0., 0., 1., 0., 0., 0., 1.},.time_factor = 1.
};

/* @measurement: (out): overwritten
 *
 * A measurement without any effect.
 */
void
cloth_measurement_init (ClothMeasurement * measurement)
{
  *measurement = null;
}

/* @measurement: a measurement
 * @effect: an effect; those of other sides change nothing
 * @values: its parameters
 *
 * Lets the effect act on what the measurement gave so far.
 */
void
cloth_measurement_add_effect (ClothMeasurement * measurement,
    const ClothEffect * effect, const gdouble * values)
{
  for (guint i = 0; i < G_N_ELEMENTS (effects); i++)
    if (effects[i].effect == effect)
      effects[i].apply (values, measurement);
}

static void
multiply (const gdouble matrix[9], const gdouble x[3], gdouble product[3])
{
  for (guint i = 0; i < 3; i++)
    product[i] = matrix[3 * i] * x[0] + matrix[3 * i + 1] * x[1] +
        matrix[3 * i + 2] * x[2];
}

/* @measurement: a measurement
 * @matrix: row by row
 * @shift: m
 *
 * What was recorded at x is recorded at @matrix·x + @shift instead.
 */
void
cloth_measurement_map (ClothMeasurement * measurement,
    const gdouble matrix[9], const gdouble shift[3])
{
  const ClothMeasurement before = *measurement;

  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 3; k++) {
      gdouble sum = 0.;

      for (guint j = 0; j < 3; j++)
        sum += matrix[3 * i + j] * before.matrix[3 * j + k];
      measurement->matrix[3 * i + k] = sum;
    }
  multiply (matrix, before.shift, measurement->shift);
  for (guint k = 0; k < 3; k++)
    measurement->shift[k] += shift[k];
}

static gdouble
find_determinant (const gdouble a[9])
{
  return a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] -
      a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
}

static gboolean
is_odd (gdouble turned)
{
  return fmod (turned, 2.) != 0.;
}

/* @measurement: a measurement
 * @topology: of the cloth
 *
 * Returns: (transfer full) (nullable): why there can be no such measurement of this cloth;
 *   %NULL: there can be
 */
gchar *
cloth_measurement_find_fault (const ClothMeasurement * measurement,
    const ClothTopology * topology)
{
  const ClothMeasurement *m = measurement;

  if (!(fabs (find_determinant (m->matrix)) > 1e-6))
    return g_strdup ("positions fall together: name each axis once");
  if (!(m->time_factor > 0.) || !(m->smoothing_s >= 0.) || isnan (m->delay_s))
    return g_strdup ("its clock doesn't run");
  if (!cloth_measurement_changes_labels (m))
    return NULL;
  if (!topology->columns)
    return g_strdup ("its labels can't be exchanged: the cloth is no grid");
  if (m->mirrored != floor (m->mirrored) || m->turned != floor (m->turned)
      || m->columns != floor (m->columns) || m->rows != floor (m->rows))
    return g_strdup ("labels are exchanged and shifted by whole numbers only");
  if (is_odd (m->turned) && topology->columns != topology->rows)
    return g_strdup_printf ("labels of %u columns and %u rows don't fit "
        "after a quarter turn", topology->columns, topology->rows);
  if (fabs (m->columns) >= topology->columns
      || fabs (m->rows) >= topology->rows)
    return g_strdup ("labels are shifted off the cloth");
  return NULL;
}

/* @measurement: a measurement
 *
 * Returns: whether it changes nothing
 */
gboolean
cloth_measurement_is_null (const ClothMeasurement * measurement)
{
  return cloth_measurement_is_equal (measurement, &null);
}

/* @a: a measurement
 * @b: another one
 *
 * Returns: whether they do the same
 */
gboolean
cloth_measurement_is_equal (const ClothMeasurement * a,
    const ClothMeasurement * b)
{
  for (guint i = 0; i < 9; i++)
    if (a->matrix[i] != b->matrix[i])
      return FALSE;
  for (guint k = 0; k < 3; k++)
    if (a->shift[k] != b->shift[k])
      return FALSE;
  return a->mirrored == b->mirrored && a->turned == b->turned
      && a->columns == b->columns && a->rows == b->rows
      && a->time_factor == b->time_factor && a->delay_s == b->delay_s
      && a->smoothing_s == b->smoothing_s;
}

/* @measurement: a measurement
 *
 * Returns: whether what it records in a frame depends on other times than the frame's
 */
gboolean
cloth_measurement_takes_time (const ClothMeasurement * measurement)
{
  return measurement->time_factor != 1. || measurement->delay_s != 0.
      || measurement->smoothing_s != 0.;
}

/* @measurement: a measurement
 *
 * Returns: whether vertices are recorded under other labels
 */
gboolean
cloth_measurement_changes_labels (const ClothMeasurement * measurement)
{
  return measurement->mirrored != 0. || measurement->turned != 0.
      || measurement->columns != 0. || measurement->rows != 0.;
}

/* Of the vertex that is recorded under a label, column and row: they may be off the cloth. */
static void
find_vertex (const ClothMeasurement * m, const ClothTopology * t, guint label,
    gint at[2])
{
  const gint last[2] = { (gint) t->columns - 1, (gint) t->rows - 1 };
  const guint turns = ((guint) ((gint) m->turned % 4 + 4)) % 4;

  at[0] = (gint) (label % t->columns) - (gint) m->columns;
  at[1] = (gint) (label / t->columns) - (gint) m->rows;
  for (guint i = 0; i < turns / 2; i++) {
    at[0] = last[0] - at[0];
    at[1] = last[1] - at[1];
  }
  if (turns % 2) {
    gint column = at[0];

    at[0] = at[1];
    at[1] = last[1] - column;
  }
  if (m->mirrored != 0.)
    at[0] = last[0] - at[0];
}

/* Where a vertex is; off the cloth, where straight lines through its last two rows or columns
 * would go on. */
static void
find_place (const ClothTopology * t, const gdouble * positions,
    const gint at[2], gdouble place[3])
{
  const gint lines[2] = { (gint) t->columns, (gint) t->rows };
  gint inside[2], strides[2] = { 1, (gint) t->columns };
  const gdouble *x;

  for (guint k = 0; k < 2; k++)
    inside[k] = CLAMP (at[k], 0, lines[k] - 1);
  x = positions + 3 * (inside[1] * strides[1] + inside[0]);
  memcpy (place, x, 3 * sizeof *place);
  for (guint k = 0; k < 2; k++) {
    const gint beyond = at[k] - inside[k];
    const gint back = beyond > 0 ? -strides[k] : strides[k];

    for (guint c = 0; beyond && c < 3; c++)
      place[c] += abs (beyond) * (x[c] - x[3 * back + (gint) c]);
  }
}

/* @measurement: a measurement
 * @topology: of the cloth
 * @positions: where its vertices are, m
 * @recorded: (out) (array): where they are recorded, but for what takes time
 */
void
cloth_measurement_apply (const ClothMeasurement * measurement,
    const ClothTopology * topology, const gdouble * positions,
    gdouble * recorded)
{
  const gboolean exchanged = cloth_measurement_changes_labels (measurement);

  for (guint v = 0; v < topology->n_vertices; v++) {
    gdouble place[3], *to = recorded + 3 * (gsize) v;

    memcpy (place, positions + 3 * (gsize) v, sizeof place);
    if (exchanged) {
      gint at[2];

      find_vertex (measurement, topology, v, at);
      find_place (topology, positions, at, place);
    }
    multiply (measurement->matrix, place, to);
    for (guint k = 0; k < 3; k++)
      to[k] += measurement->shift[k];
  }
}

/* @measurement: a measurement without fault
 * @matrix: (out): A⁻¹, row by row: x = A⁻¹ (recorded − shift)
 */
void
cloth_measurement_invert (const ClothMeasurement * measurement,
    gdouble matrix[9])
{
  const gdouble *a = measurement->matrix;
  const gdouble determinant = find_determinant (a);

  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 3; k++) {
      const guint r = (k + 1) % 3, s = (k + 2) % 3;
      const guint c = (i + 1) % 3, d = (i + 2) % 3;

      matrix[3 * i + k] = (a[3 * r + c] * a[3 * s + d] -
          a[3 * r + d] * a[3 * s + c]) / determinant;
    }
}

/* @measurement: a measurement without fault
 * @topology: of the cloth
 *
 * Returns: (transfer full) (array): the label that each vertex is recorded under; −1: none
 */
gint *
cloth_measurement_list_labels (const ClothMeasurement * measurement,
    const ClothTopology * topology)
{
  const gboolean exchanged = cloth_measurement_changes_labels (measurement);
  gint *labels = g_new (gint, topology->n_vertices);

  for (guint v = 0; v < topology->n_vertices; v++)
    labels[v] = exchanged ? -1 : (gint) v;
  for (guint label = 0; exchanged && label < topology->n_vertices; label++) {
    gint at[2];

    find_vertex (measurement, topology, label, at);
    if (at[0] >= 0 && at[1] >= 0 && at[0] < (gint) topology->columns
        && at[1] < (gint) topology->rows)
      labels[at[1] * (gint) topology->columns + at[0]] = (gint) label;
  }
  return labels;
}
