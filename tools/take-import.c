/* gst-cloth-take-1.0 import and info: recordings of other programs become takes; what is in one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/take-tool.h"

#include <math.h>
#include <string.h>

#include "gst/cloth-io/observations.h"
#include "gst/take/import.h"
#include "gst/take/sequence.h"
#include "gst/take/summary.h"

static gboolean
parse_unit (const gchar * text, gdouble * unit_m)
{
  static const struct
  {
    const gchar *name;
    gdouble unit_m;
  } units[] = { {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254} };

  for (guint i = 0; i < G_N_ELEMENTS (units); i++)
    if (g_str_equal (text, units[i].name)) {
      *unit_m = units[i].unit_m;
      return TRUE;
    }
  return FALSE;
}

/* A number, or a fraction as GStreamer writes frame rates. */
static gboolean
parse_rate (const gchar * text, gdouble * fps)
{
  gchar *end;
  gdouble value = g_ascii_strtod (text, &end);

  if (end == text)
    return FALSE;
  if (*end == '/') {
    text = end + 1;
    value /= g_ascii_strtod (text, &end);
    if (end == text)
      return FALSE;
  }
  *fps = value;
  return *end == 0 && value >= 1e-3 && value <= 1e6;
}

gint
import_take (const Arguments * arguments)
{
  ClothImport import = {
    .source = arguments->rest[1],.output = arguments->output,
    .axes = arguments->axes,.mesh = arguments->mesh,
    .clamps = (const gchar * const *) arguments->clamps,
    .clamp_file = arguments->clamp_file,
    .zero_is_missing = arguments->zero_is_missing,
    .overwrite = arguments->overwrite
  };
  g_autoptr (GError) error = NULL;
  g_autofree gchar *told = NULL;

  if (!arguments->rest[1] || arguments->rest[2])
    return complain (BAD_USAGE,
        "name one file; of numbered files the first: import SOURCE");
  if (!arguments->output)
    return complain (BAD_USAGE, "name the take with --output");
  if (arguments->units && !parse_unit (arguments->units, &import.unit_m))
    return complain (BAD_USAGE, "--units %s: give m, cm, mm or in",
        arguments->units);
  if (arguments->rate && !parse_rate (arguments->rate, &import.fps))
    return complain (BAD_USAGE,
        "--rate %s: give frames a second, such as 50 or 30000/1001",
        arguments->rate);
  if (arguments->columns < 0 || arguments->rows < 0)
    return complain (BAD_USAGE, "--columns and --rows count vertices");
  import.columns = (guint) arguments->columns;
  import.rows = (guint) arguments->rows;
  if ((arguments->width && !parse_length ("width", arguments->width,
              &import.width_m, &error)) || (arguments->height
          && !parse_length ("height", arguments->height, &import.height_m,
              &error)))
    return complain (BAD_USAGE, "%s", error->message);
  told = cloth_take_import (&import, &error);
  if (!told)
    return complain (FAILED, "%s", error->message);
  g_print ("%s", told);
  return DONE;
}

/* A line for each camera whose pictures are in the folder of the take. */
static void
add_cameras (GString * table, ClothTake * take)
{
  const guint n_vertices = cloth_take_get_topology (take)->n_vertices;
  const gchar *label = "cameras";
  g_autoptr (ClothObservations) seen = NULL;
  g_autoptr (GError) error = NULL;

  if (!gst_cloth_io_observations_load_take (take, NULL, &seen, &error))
    cloth_summary_add (table, label, "not read: %s", error->message);
  for (guint c = 0; seen && c < seen->rig->n_cameras; c++) {
    guint64 n_points = 0;
    guint n = 0, n_silhouettes = 0;

    for (guint i = 0; i < seen->list->len; i++) {
      const ClothObservation *picture =
          &g_array_index (seen->list, ClothObservation, i);

      if (picture->camera != c)
        continue;
      n++;
      n_points += picture->n;
      n_silhouettes += picture->has_silhouette;
    }
    if (n == 0)
      continue;
    cloth_summary_add (table, label, "%s: %u pictures, %" G_GUINT64_FORMAT
        " points, %.1f %% of the vertices in a picture",
        seen->rig->cameras[c].name, n, n_points,
        100. * (gdouble) n_points / n / n_vertices);
    label = "";
    if (n_silhouettes > 0)
      cloth_summary_add (table, label, "%s: %u silhouettes",
          seen->rig->cameras[c].name, n_silhouettes);
  }
}

gint
inform_of_takes (const Arguments * arguments)
{
  if (!arguments->rest[1])
    return complain (BAD_USAGE, "name takes: info TAKE…");
  for (guint i = 1; arguments->rest[i]; i++) {
    g_autoptr (GError) error = NULL;
    g_autofree gchar *folder =
        cloth_mesh_format_stem (arguments->rest[i], CLOTH_MESH_FORMAT_TAKE);
    g_autoptr (ClothTake) take = cloth_take_open (folder, &error);
    g_autofree gchar *told = take ? cloth_take_summarise (take, &error) : NULL;
    g_autoptr (GString) cameras = g_string_new (NULL);

    if (!told)
      return complain (FAILED, "%s: %s", arguments->rest[i], error->message);
    add_cameras (cameras, take);
    g_print ("%s%s%s", i > 1 ? "\n" : "", told, cameras->str);
  }
  return DONE;
}
