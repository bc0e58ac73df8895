/* Moving meshes as few bytes, for a page.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/pack.h"

#include <math.h>
#include <string.h>

#define UNSEEN 0xffffu
#define MAX_STEP 0xfffeu
/* Standard deviations in 8 bits, from 1 µm up, each 6% more than the one before. */
#define SIGMA_FIRST 1e-6
#define SIGMA_RATIO 0.06

/* @box: (out): is set
 * @low: least coordinates; above @high where there are none
 * @high: greatest coordinates
 * @margin: how much room is left around, as a share of the widest side
 */
void
cloth_pack_box (ClothPackBox * box, const gfloat low[3], const gfloat high[3],
    gfloat margin)
{
  gfloat widest = 1e-3f;

  for (guint k = 0; k < 3; k++)
    if (low[k] <= high[k])
      widest = MAX (widest, high[k] - low[k]);
  for (guint k = 0; k < 3; k++)
    box->origin[k] = (low[k] <= high[k] ? low[k] : 0) - margin * widest;
  box->step = (1 + 2 * margin) * widest / MAX_STEP;
}

/* @box: what it lies in; what lies outside comes to its side
 * @place: metres; not finite when not seen
 * @packed: (out): little-endian
 */
void
cloth_pack_place (const ClothPackBox * box, const gfloat place[3],
    guint16 packed[3])
{
  const gboolean seen = isfinite (place[0]) && isfinite (place[1]) &&
      isfinite (place[2]);

  for (guint k = 0; k < 3; k++) {
    const gfloat steps = roundf ((place[k] - box->origin[k]) / box->step);

    packed[k] = GUINT16_TO_LE (seen ?
        (guint16) CLAMP (steps, 0, (gfloat) MAX_STEP) : UNSEEN);
  }
}

/* @sigma_m: a standard deviation, metres
 *
 * Returns: which of the scale is next to it; 255: it is not known
 */
guint8
cloth_pack_sigma (gdouble sigma_m)
{
  return isfinite (sigma_m) && sigma_m > 0 ? (guint8)
      CLAMP (round (log (sigma_m / SIGMA_FIRST) / SIGMA_RATIO), 0, 254) : 255;
}

void
cloth_pack_put_bytes (ClothJsonWriter * writer, const gchar * key,
    gconstpointer bytes, gsize size)
{
  g_autofree gchar *text = g_base64_encode (bytes, size);

  cloth_json_writer_string (writer, key, text);
}

void
cloth_pack_put_box (ClothJsonWriter * writer, const ClothPackBox * box)
{
  const gdouble origin[] = { box->origin[0], box->origin[1], box->origin[2] };

  cloth_json_writer_numbers (writer, "origin", origin, 3);
  cloth_json_writer_number (writer, "step", box->step);
}

void
cloth_pack_put_sigmas (ClothJsonWriter * writer, const guint8 * sigmas, gsize n)
{
  const gdouble scale[] = { SIGMA_FIRST, SIGMA_RATIO };

  cloth_pack_put_bytes (writer, "sigma", sigmas, n);
  cloth_json_writer_numbers (writer, "sigma_scale", scale, 2);
}

void
cloth_pack_put_topology (ClothJsonWriter * writer,
    const ClothTopology * topology)
{
  gsize n_uv = 2 * (gsize) topology->n_vertices;
  gsize n_corners = 4 * (gsize) topology->n_faces;
  g_autofree guint32 *packed = g_new (guint32, MAX (n_uv, n_corners) + 1);

  memcpy (packed, topology->uv, n_uv * sizeof *packed);
  for (gsize i = 0; i < n_uv; i++)
    packed[i] = GUINT32_TO_LE (packed[i]);
  cloth_pack_put_bytes (writer, "uv", packed, n_uv * sizeof *packed);
  for (gsize i = 0; i < n_corners; i++)
    packed[i] = GUINT32_TO_LE (topology->faces[i]);
  cloth_pack_put_bytes (writer, "faces", packed, n_corners * sizeof *packed);
}
