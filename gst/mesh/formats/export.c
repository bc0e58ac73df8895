/* What the writers of the formats have in common.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/export.h"

#include <math.h>

/* @info: the export
 * @ending: of the file's name, with its point
 * @error: #GIOErrorEnum
 *
 * Returns: (transfer full): a file of the export, or %NULL
 */
ClothOutput *
cloth_export_open (const ClothExportInfo * info, const gchar * ending,
    GError ** error)
{
  g_autofree gchar *name = g_strconcat (info->base, ending, NULL);

  return cloth_parts_open (info->parts, name, error);
}

/* @info: the export
 *
 * Returns: (transfer full): its name in ASCII letters, digits and underscores, not
 *   beginning with a digit, as all formats take it
 */
gchar *
cloth_export_identifier (const ClothExportInfo * info)
{
  const gboolean plain = *info->name && !g_ascii_isdigit (*info->name);
  gchar *name = g_strconcat (plain ? "" : "_", info->name, NULL);

  return g_strcanon (name, G_CSET_A_2_Z G_CSET_a_2_z G_CSET_DIGITS, '_');
}

/* @covariance: 6 numbers, m²
 *
 * Returns: standard deviation, m, RMS over the three axes; NaN when not known
 */
gfloat
cloth_export_sigma (const gfloat * covariance)
{
  gdouble trace = (gdouble) covariance[0] + covariance[3] + covariance[5];

  return trace >= 0 ? (gfloat) sqrt (trace / 3) : NAN;
}

/* @positions: 3 finite numbers a vertex
 * @n_vertices: at least 1
 * @bounds: (out caller-allocates): least x, y, z, greatest x, y, z
 */
void
cloth_export_bounds (const gfloat * positions, guint n_vertices,
    gfloat bounds[6])
{
  for (guint k = 0; k < 3; k++)
    bounds[k] = bounds[3 + k] = positions[k];
  for (gsize i = 3; i < 3 * (gsize) n_vertices; i += 3)
    for (guint k = 0; k < 3; k++) {
      bounds[k] = MIN (bounds[k], positions[i + k]);
      bounds[3 + k] = MAX (bounds[3 + k], positions[i + k]);
    }
}

/* @number: of the frame
 * @before: time of the frame before; of no meaning for frame 0
 * @time_s: its own
 * @error: #ClothFileError
 *
 * Returns: whether the time rises
 */
gboolean
cloth_export_check_later (guint64 number, gdouble before, gdouble time_s,
    GError ** error)
{
  if (isfinite (time_s) && (number == 0 || time_s > before))
    return TRUE;
  return cloth_file_invalid (error,
      "frame %" G_GUINT64_FORMAT " is not later than the one before", number);
}

/* @text: text
 * @value: a number
 *
 * Nine digits bring every float32 back exactly, in any locale.
 */
void
cloth_text_append_float (GString * text, gfloat value)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE];

  g_string_append (text, g_ascii_formatd (digits, sizeof digits, "%.9g",
          value));
}

/* @text: text
 * @value: a number; twelve digits of it are kept
 */
void
cloth_text_append_double (GString * text, gdouble value)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE];

  g_string_append (text, g_ascii_formatd (digits, sizeof digits, "%.12g",
          value));
}

/* @text: text; empty afterwards
 * @output: where to
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when it was taken
 */
gboolean
cloth_text_flush (GString * text, ClothOutput * output, GError ** error)
{
  gboolean done = cloth_output_write (output, text->str, text->len, error);

  g_string_truncate (text, 0);
  return done;
}
