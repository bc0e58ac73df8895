/* What was found, as JSON: one object a frame, on a line of its own. docs/formats.md has the keys.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cloth-io/jsonlines.h"

#include <math.h>

#include "gst/file/jsonwriter.h"

static ClothJsonWriter *
start_line (void)
{
  ClothJsonWriter *writer = cloth_json_writer_new ();

  cloth_json_writer_set_one_line (writer, TRUE);
  cloth_json_writer_begin_object (writer, NULL);
  return writer;
}

static gchar *
finish_line (ClothJsonWriter * writer)
{
  gchar *line;

  cloth_json_writer_end_object (writer);
  line = cloth_json_writer_finish (writer);
  cloth_json_writer_free (writer);
  return line;
}

static void
add_pair (ClothJsonWriter * writer, const gchar * key, gdouble a, gdouble b)
{
  const gdouble pair[2] = { a, b };

  cloth_json_writer_numbers (writer, key, pair, 2);
}

static void
add_triple (ClothJsonWriter * writer, const gchar * key, gdouble a, gdouble b,
    gdouble c)
{
  const gdouble triple[3] = { a, b, c };

  cloth_json_writer_numbers (writer, key, triple, 3);
}

/* A dot without a label has neither column nor row. */
static void
add_index (ClothJsonWriter * writer, const gchar * key, gint index)
{
  cloth_json_writer_number (writer, key, index < 0 ? NAN : index);
}

static void
add_squares (ClothJsonWriter * writer, const GstClothQuads * quads)
{
  static const gchar *const states[] = { "tracked", "predicted", "lost" };
  guint n;
  const GstClothQuad *quad = gst_cloth_quads_get_quads (quads, &n);

  cloth_json_writer_begin_array (writer, "squares");
  for (; n > 0; n--, quad++) {
    cloth_json_writer_begin_object (writer, NULL);
    add_index (writer, "column", quad->column);
    add_index (writer, "row", quad->row);
    cloth_json_writer_string (writer, "state",
        (guint) quad->state < G_N_ELEMENTS (states) ? states[quad->state] :
        NULL);
    cloth_json_writer_boolean (writer, "black", quad->black);
    cloth_json_writer_number (writer, "confidence", quad->confidence);
    cloth_json_writer_begin_array (writer, "corners_px");
    for (guint c = 0; c < 4; c++)
      add_pair (writer, NULL, quad->x[c], quad->y[c]);
    cloth_json_writer_end_array (writer);
    cloth_json_writer_begin_array (writer, "covariances_px2");
    for (guint c = 0; c < 4; c++)
      add_triple (writer, NULL, quad->cov_xx[c], quad->cov_xy[c],
          quad->cov_yy[c]);
    cloth_json_writer_end_array (writer);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

static void
add_dots (ClothJsonWriter * writer, const GstClothDots * dots)
{
  const guint n_colours = gst_cloth_dots_get_n_colours (dots);
  guint n;
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n);

  cloth_json_writer_begin_array (writer, "dots");
  for (; n > 0; n--, dot++) {
    gdouble likelihoods[GST_CLOTH_DOT_MAX_COLOURS];

    for (guint i = 0; i < n_colours; i++)
      likelihoods[i] = dot->log_likelihood[i];
    cloth_json_writer_begin_object (writer, NULL);
    add_index (writer, "column", dot->column);
    add_index (writer, "row", dot->row);
    cloth_json_writer_boolean (writer, "mirrored", dot->mirrored);
    cloth_json_writer_boolean (writer, "touches", dot->touches);
    cloth_json_writer_number (writer, "confidence", dot->confidence);
    add_pair (writer, "centre_px", dot->x, dot->y);
    add_triple (writer, "covariance_px2", dot->cov_xx, dot->cov_xy,
        dot->cov_yy);
    cloth_json_writer_numbers (writer, "log_likelihoods", likelihoods,
        n_colours);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

static void
add_matches (ClothJsonWriter * writer, const GstClothMatches * matches)
{
  guint n;
  const GstClothMatch *match = gst_cloth_matches_get_matches (matches, &n);
  const GstClothGridPoint *point;

  cloth_json_writer_begin_array (writer, "matches");
  for (; n > 0; n--, match++) {
    cloth_json_writer_begin_object (writer, NULL);
    add_pair (writer, "place_px", match->x, match->y);
    add_pair (writer, "uv_m", match->u, match->v);
    cloth_json_writer_number (writer, "scale_px", match->scale);
    cloth_json_writer_number (writer, "distance", match->distance);
    cloth_json_writer_boolean (writer, "mirrored", match->mirrored);
    cloth_json_writer_boolean (writer, "verified", match->verified);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);

  point = gst_cloth_matches_get_points (matches, &n);
  cloth_json_writer_begin_array (writer, "vertices");
  for (; n > 0; n--, point++) {
    cloth_json_writer_begin_object (writer, NULL);
    add_index (writer, "column", point->column);
    add_index (writer, "row", point->row);
    cloth_json_writer_boolean (writer, "mirrored", point->mirrored);
    add_pair (writer, "place_px", point->x, point->y);
    add_triple (writer, "covariance_px2", point->cov_xx, point->cov_xy,
        point->cov_yy);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

gchar *
gst_cloth_io_json_of_picture (GstBuffer * picture, gdouble time_s)
{
  const GstClothQuads *quads = gst_buffer_get_cloth_quads (picture);
  const GstClothDots *dots = gst_buffer_get_cloth_dots (picture);
  const GstClothMatches *matches = gst_buffer_get_cloth_matches (picture);
  ClothJsonWriter *writer = start_line ();
  const gchar *camera = quads ? gst_cloth_quads_get_camera (quads) :
      dots ? gst_cloth_dots_get_camera (dots) :
      matches ? gst_cloth_matches_get_camera (matches) : NULL;

  if (quads || dots || matches)
    cloth_json_writer_count (writer, "frame",
        quads ? gst_cloth_quads_get_sequence (quads) :
        dots ? gst_cloth_dots_get_sequence (dots) :
        gst_cloth_matches_get_sequence (matches));
  else
    cloth_json_writer_number (writer, "frame", NAN);
  cloth_json_writer_number (writer, "time_s", time_s);
  cloth_json_writer_string (writer, "camera",
      camera && *camera ? camera : NULL);
  if (quads)
    add_squares (writer, quads);
  if (dots)
    add_dots (writer, dots);
  if (matches)
    add_matches (writer, matches);
  return finish_line (writer);
}

/* @n: numbers of a vertex; without a place it is null */
static void
add_rows (ClothJsonWriter * writer, const gchar * key, const gfloat * values,
    guint n_vertices, guint n)
{
  cloth_json_writer_begin_array (writer, key);
  for (gsize i = 0; i < n_vertices; i++) {
    gdouble row[6];

    for (guint k = 0; k < n; k++)
      row[k] = values[n * i + k];
    cloth_json_writer_numbers (writer, NULL, isnan (row[0]) ? NULL : row, n);
  }
  cloth_json_writer_end_array (writer);
}

gchar *
gst_cloth_io_json_of_mesh (const GstClothMesh * mesh,
    const GstClothTopology * topology, gdouble time_s)
{
  static const gchar *const states[] =
      { "unseen", "measured", "two_views", "filled", "predicted" };
  const guint n_vertices = gst_cloth_mesh_get_n_vertices (mesh);
  const guint8 *state = gst_cloth_mesh_get_states (mesh, NULL);
  const gfloat *covariances = gst_cloth_mesh_get_covariances (mesh, NULL);
  ClothJsonWriter *writer = start_line ();

  cloth_json_writer_count (writer, "frame", gst_cloth_mesh_get_sequence (mesh));
  cloth_json_writer_number (writer, "time_s", time_s);
  if (gst_cloth_topology_get_columns (topology) > 0) {
    cloth_json_writer_count (writer, "columns",
        gst_cloth_topology_get_columns (topology));
    cloth_json_writer_count (writer, "rows",
        gst_cloth_topology_get_rows (topology));
  }
  add_rows (writer, "positions_m", gst_cloth_mesh_get_positions (mesh, NULL),
      n_vertices, 3);
  cloth_json_writer_begin_array (writer, "states");
  for (gsize i = 0; i < n_vertices; i++)
    cloth_json_writer_string (writer, NULL, states[state[i]]);
  cloth_json_writer_end_array (writer);
  if (covariances)
    add_rows (writer, "covariances_m2", covariances, n_vertices, 6);
  return finish_line (writer);
}
