/* What the writers of the formats have in common.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/parts.h"
#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* @stem: what the names of the files begin with; a take's folder
 * @base: the same without its folder
 * @parts: where the files are until they are whole; %NULL for a take, which has its own
 * @name: name of the object or take
 * @topology: the mesh of every frame
 * @fps_n: numerator of the frame rate, 0 when it varies
 * @fps_d: its denominator
 *
 * What is known before the first frame. It outlives the export.
 */
typedef struct {
  gchar *stem;
  gchar *base;
  ClothParts *parts;
  gchar *name;
  ClothTopology *topology;
  gint fps_n, fps_d;
} ClothExportInfo;

/* @keeps_nan: positions of vertices that are not seen come as NaN; else each has a
 *   place
 * @ending: of the file that readers open first; %NULL for a take
 * @lasts: what is written can be read before the end, and so be recovered
 * @start: starts the files
 * @append: takes a frame; its number counts from 0
 * @finish: makes the files whole; there was at least one frame
 * @free: frees what @start returned
 *
 * How one format is written.
 */
typedef struct {
  gboolean keeps_nan;
  const gchar *ending;
  gboolean lasts;
  gpointer (*start) (const ClothExportInfo * info, GError ** error);
  gboolean (*append) (gpointer export, guint64 number, gdouble time_s,
      const ClothMeshFrame * frame, GError ** error);
  gboolean (*finish) (gpointer export, GError ** error);
  void (*free) (gpointer export);
} ClothExporter;

/* @placed: all frames were whole, and only had to get their names
 * @n_frames: else how many are kept
 * @n_left_out: how many more, whole or not, are left out; 0 when that is none
 * @dropped: (nullable): a file that had fewer frames and is left out
 *
 * What could be finished of a recording that was interrupted.
 */
typedef struct {
  gboolean placed;
  guint64 n_frames;
  guint64 n_left_out;
  const gchar *dropped;
} ClothRecovered;

/* @parts: what was left; its files are whole afterwards
 * @base: what the names begin with, without the folder
 * @recovered: (out): how much it is; without a frame nothing was done
 *
 * Finishes a recording of one format.
 */
typedef gboolean (*ClothRecover) (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error);

gboolean cloth_obj_pc2_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error);
gboolean cloth_ply_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error);
gboolean cloth_vtp_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error);
gboolean cloth_csv_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error);

extern const ClothExporter cloth_obj_pc2_exporter, cloth_ply_exporter,
    cloth_gltf_exporter, cloth_usd_exporter, cloth_vtp_exporter,
    cloth_c3d_exporter, cloth_csv_exporter;

ClothOutput *cloth_export_open (const ClothExportInfo * info,
    const gchar * ending, GError ** error);
gchar *cloth_export_identifier (const ClothExportInfo * info);
gfloat cloth_export_sigma (const gfloat * covariance);
void cloth_export_bounds (const gfloat * positions, guint n_vertices,
    gfloat bounds[6]);
gboolean cloth_export_check_later (guint64 number, gdouble before,
    gdouble time_s, GError ** error);

void cloth_text_append_float (GString * text, gfloat value);
void cloth_text_append_double (GString * text, gdouble value);
gboolean cloth_text_flush (GString * text, ClothOutput * output,
    GError ** error);

G_END_DECLS
