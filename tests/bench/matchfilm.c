/* A rendered film of a printed cloth with the truth of every pixel.
 *
 * The folder has reference.png, cam0.mp4 and vertices.npy of 35 × 33 vertices a frame, world
 * z up; for disparities also cam1.mp4, cam2.mp4 and background0.png. The cameras are those
 * that all such films share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/bench/matchfilm.h"

#include <gst/app/gstappsink.h>
#include <gst/video/video.h>
#include <math.h>
#include <string.h>

#include "tests/common/npyfloats.h"

#define COLUMNS 33
#define ROWS 35
/* Parts of a grid cell's edge: a cell is some 20 px wide. */
#define PARTS 8
/* Between pixels of one surface, m in uv. */
#define SAME 0.02

void
match_pictures_load (const gchar * folder, const gchar * name,
    MatchPictures * to)
{
  g_autofree gchar *line = g_strdup_printf ("filesrc location=\"%s/%s\" ! "
      "decodebin ! videoconvert ! video/x-raw,format=GRAY8 ! "
      "appsink name=sink sync=false", folder, name);
  g_autoptr (GError) error = NULL;
  GstElement *pipeline = gst_parse_launch (line, &error), *sink;
  GstSample *sample;

  if (error)
    g_error ("%s", error->message);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  to->pixels = g_byte_array_new ();
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  while ((sample = gst_app_sink_try_pull_sample (GST_APP_SINK (sink),
              60 * GST_SECOND))) {
    GstVideoInfo info;
    GstVideoFrame frame;

    gst_video_info_from_caps (&info, gst_sample_get_caps (sample));
    gst_video_frame_map (&frame, &info, gst_sample_get_buffer (sample),
        GST_MAP_READ);
    to->width = GST_VIDEO_INFO_WIDTH (&info);
    to->height = GST_VIDEO_INFO_HEIGHT (&info);
    for (gint y = 0; y < to->height; y++)
      g_byte_array_append (to->pixels,
          (const guint8 *) GST_VIDEO_FRAME_PLANE_DATA (&frame, 0)
          + y * GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0), to->width);
    gst_video_frame_unmap (&frame);
    gst_sample_unref (sample);
  }
  if (!to->pixels->len)
    g_error ("no picture in %s/%s", folder, name);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

/* @still: (nullable): folder of reference.png and background0.png, if it is another one
 * @sides: whether the other cameras and the background are loaded
 */
void
match_film_load (MatchFilm * film, const gchar * folder, const gchar * still,
    gboolean sides)
{
  g_autofree gchar *path = g_build_filename (folder, "vertices.npy", NULL);
  g_autoptr (GError) error = NULL;
  ClothNpyInfo info;

  *film = (MatchFilm) {
    .focal = 12800 / 9.0,.baseline = 0.1,.centre = {
      511.5, 383.5
    },.cloth_m = {
      0.63, 0.67
  }};
  match_pictures_load (still ? still : folder, "reference.png",
      &film->reference);
  match_pictures_load (folder, "cam0.mp4", &film->film);
  if (sides) {
    match_pictures_load (still ? still : folder, "background0.png",
        &film->background);
    match_pictures_load (folder, "cam1.mp4", &film->sides[0]);
    match_pictures_load (folder, "cam2.mp4", &film->sides[1]);
  }
  film->vertices = load_npy_floats (path, &info, &error);
  if (!film->vertices || info.row_items != 3 * ROWS * COLUMNS)
    g_error ("%s: %s", path, error ? error->message : "not a cloth");
  film->n_frames = film->film.pixels->len / (film->film.width
      * film->film.height);
  film->n_frames = MIN (film->n_frames, (guint) info.n_rows);
  for (gsize i = 0; i < info.n_rows * ROWS * COLUMNS; i++) {
    gfloat *p = film->vertices + 3 * i;
    const gfloat y = p[1], z = p[2];

    p[1] = 0.85f - z;
    p[2] = 1.6f + y;
  }
}

void
match_film_clear (MatchFilm * film)
{
  g_byte_array_unref (film->reference.pixels);
  g_byte_array_unref (film->film.pixels);
  g_clear_pointer (&film->background.pixels, g_byte_array_unref);
  for (gint k = 0; k < 2; k++)
    g_clear_pointer (&film->sides[k].pixels, g_byte_array_unref);
  g_free (film->vertices);
}

void
match_truth_init (MatchTruth * truth, gint width, gint height)
{
  const gsize n = (gsize) width * height;

  *truth = (MatchTruth) {
  width, height, g_new (gfloat, 3 * n), g_new (gfloat, 2 * n),
        g_malloc (n), g_malloc (n)};
}

void
match_truth_clear (MatchTruth * truth)
{
  g_free (truth->points);
  g_free (truth->uv);
  g_free (truth->mask);
  g_free (truth->back);
}

typedef struct
{
  gdouble x, y, z, u, v;
} Corner;

static Corner
look (const MatchFilm * film, guint frame, gint i, gint j)
{
  const gint column = MIN (i / PARTS, COLUMNS - 2);
  const gint row = MIN (j / PARTS, ROWS - 2);
  const gdouble s = (gdouble) i / PARTS - column, t = (gdouble) j / PARTS - row;
  const gfloat *a = film->vertices + 3 * ((gsize) frame * ROWS * COLUMNS
      + row * COLUMNS + column), *b = a + 3 * COLUMNS;
  gdouble p[3];

  for (gint c = 0; c < 3; c++)
    p[c] = (1 - t) * ((1 - s) * a[c] + s * a[3 + c])
        + t * ((1 - s) * b[c] + s * b[3 + c]);
  return (Corner) {
  film->centre[0] + film->focal * p[0] / p[2],
        film->centre[1] + film->focal * p[1] / p[2], p[2],
        film->cloth_m[0] * i / PARTS / (COLUMNS - 1),
        film->cloth_m[1] * j / PARTS / (ROWS - 1)};
}

static void
fill (const MatchFilm * film, MatchTruth * truth, const Corner * a,
    const Corner * b, const Corner * c)
{
  const gdouble area = (b->x - a->x) * (c->y - a->y)
      - (b->y - a->y) * (c->x - a->x);
  const gint left = MAX ((gint) ceil (MIN (MIN (a->x, b->x), c->x)), 0);
  const gint right = MIN ((gint) floor (MAX (MAX (a->x, b->x), c->x)),
      truth->width - 1);
  const gint top = MAX ((gint) ceil (MIN (MIN (a->y, b->y), c->y)), 0);
  const gint bottom = MIN ((gint) floor (MAX (MAX (a->y, b->y), c->y)),
      truth->height - 1);

  for (gint y = top; y <= bottom; y++)
    for (gint x = left; x <= right; x++) {
      const gdouble p = ((b->x - x) * (c->y - y) - (b->y - y) * (c->x - x))
          / area, q = ((c->x - x) * (a->y - y) - (c->y - y) * (a->x - x))
          / area, r = 1 - p - q;
      const gsize i = (gsize) y * truth->width + x;
      gdouble z;

      if (!(p >= -1e-9 && q >= -1e-9 && r >= -1e-9))
        continue;
      z = 1 / (p / a->z + q / b->z + r / c->z);
      if (truth->mask[i] && truth->points[3 * i + 2] <= z)
        continue;
      truth->mask[i] = 1;
      truth->back[i] = area < 0;
      truth->points[3 * i] = (gfloat) ((x - film->centre[0]) / film->focal * z);
      truth->points[3 * i + 1] =
          (gfloat) ((y - film->centre[1]) / film->focal * z);
      truth->points[3 * i + 2] = (gfloat) z;
      truth->uv[2 * i] = (gfloat) (z * (p * a->u / a->z + q * b->u / b->z
              + r * c->u / c->z));
      truth->uv[2 * i + 1] = (gfloat) (z * (p * a->v / a->z + q * b->v / b->z
              + r * c->v / c->z));
    }
}

void
match_film_look (const MatchFilm * film, guint frame, MatchTruth * truth)
{
  const gsize n = (gsize) truth->width * truth->height;
  const gint columns = (COLUMNS - 1) * PARTS, rows = (ROWS - 1) * PARTS;

  memset (truth->mask, 0, n);
  memset (truth->back, 0, n);
  for (gsize i = 0; i < 3 * n; i++)
    truth->points[i] = NAN;
  for (gint j = 0; j < rows; j++)
    for (gint i = 0; i < columns; i++) {
      const Corner a = look (film, frame, i, j);
      const Corner b = look (film, frame, i + 1, j);
      const Corner c = look (film, frame, i, j + 1);
      const Corner d = look (film, frame, i + 1, j + 1);

      fill (film, truth, &a, &b, &c);
      fill (film, truth, &b, &d, &c);
    }
}

/* Where a place of the cloth is in the picture, hidden or not. */
void
match_film_place (const MatchFilm * film, guint frame, const gdouble uv[2],
    gdouble at[2])
{
  const gdouble i = uv[0] / film->cloth_m[0] * (COLUMNS - 1) * PARTS;
  const gdouble j = uv[1] / film->cloth_m[1] * (ROWS - 1) * PARTS;
  const Corner corner = look (film, frame,
      (gint) CLAMP (rint (i), 0, (COLUMNS - 1) * PARTS),
      (gint) CLAMP (rint (j), 0, (ROWS - 1) * PARTS));

  at[0] = corner.x;
  at[1] = corner.y;
}

/* Between the pixels around, as far as they are of the nearest one's surface. */
gboolean
match_truth_get_uv (const MatchTruth * truth, gdouble x, gdouble y,
    gdouble uv[2])
{
  const gint nx = CLAMP ((gint) rint (x), 0, truth->width - 1);
  const gint ny = CLAMP ((gint) rint (y), 0, truth->height - 1);
  const gsize nearest = (gsize) ny * truth->width + nx;
  gdouble sum = 0;

  uv[0] = uv[1] = 0;
  if (!truth->mask[nearest])
    return FALSE;
  for (gint k = 0; k < 4; k++) {
    const gint px = (gint) floor (x) + (k & 1);
    const gint py = (gint) floor (y) + (k >> 1);
    const gdouble weight = (1 - fabs (x - px)) * (1 - fabs (y - py));
    const gsize i = (gsize) py * truth->width + px;

    if (px < 0 || py < 0 || px >= truth->width || py >= truth->height
        || !truth->mask[i] || hypotf (truth->uv[2 * i]
            - truth->uv[2 * nearest], truth->uv[2 * i + 1]
            - truth->uv[2 * nearest + 1]) > SAME)
      continue;
    sum += weight;
    uv[0] += weight * truth->uv[2 * i];
    uv[1] += weight * truth->uv[2 * i + 1];
  }
  uv[0] /= sum;
  uv[1] /= sum;
  return sum > 0;
}
