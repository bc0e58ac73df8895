/* The rendered film of a cloth before three cameras, and what is true of it.
 *
 * The truth is the mesh that the film was rendered from, between whose vertices the cloth is
 * bilinear. Disparities are linear in the picture of a plane, so that triangles of it are
 * drawn as they are; of several the greatest hides the others.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/stereo.h"

#include <math.h>
#include <string.h>

#include "gst/rig/rigfile.h"
#include "tests/common/luma.h"
#include "tests/common/npyfloats.h"

#define COLUMNS 33
#define ROWS 35
/* A cell of the mesh is drawn as so many squares across and down. */
#define PARTS 6

TestStereo *
test_stereo_load (const gchar * folder)
{
  TestStereo *film = g_new0 (TestStereo, 1);
  g_autofree gchar *path = g_build_filename (folder, "rig.json", NULL);
  g_autofree gchar *truth = g_build_filename (folder, "vertices.npy", NULL);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_load (path, &error);
  const ClothCamera *camera;
  ClothNpyInfo info;

  g_assert_no_error (error);
  g_assert_cmpuint (rig->n_cameras, ==, TEST_STEREO_CAMERAS);
  camera = &rig->cameras[0];
  film->width = camera->width;
  film->height = camera->height;
  film->focal = camera->K[0];
  film->centre[0] = camera->K[2];
  film->centre[1] = camera->K[5];
  film->baseline = camera->t[0] - rig->cameras[1].t[0];
  memcpy (film->rotation, camera->R, sizeof (film->rotation));
  memcpy (film->translation, camera->t, sizeof (film->translation));
  film->vertices = load_npy_floats (truth, &info, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (info.row_items, ==, 3 * ROWS * COLUMNS);
  film->n_frames = (guint) info.n_rows;
  for (guint k = 0; k < TEST_STEREO_CAMERAS; k++) {
    g_autofree gchar *name = g_strdup_printf ("cam%u.mp4", k);
    g_autofree gchar *file = g_build_filename (folder, name, NULL);

    film->luma[k] =
        test_luma_decode (file, film->width, film->height, film->n_frames);
  }
  return film;
}

void
test_stereo_free (TestStereo * film)
{
  if (!film)
    return;
  for (guint k = 0; k < TEST_STEREO_CAMERAS; k++)
    g_free (film->luma[k]);
  g_free (film->vertices);
  g_free (film);
}

/* Returns: (transfer none): the luma of a picture */
const guint8 *
test_stereo_picture (const TestStereo * film, guint camera, guint frame)
{
  return film->luma[camera] + (gsize) frame *(gsize) film->width
      * (gsize) film->height;
}

/* @to: (out): where a point is in the picture, and its disparity */
static void
project (const TestStereo * film, const gdouble point[3], gdouble to[3])
{
  const gdouble *r = film->rotation, *t = film->translation;
  gdouble p[3];

  for (gint i = 0; i < 3; i++)
    p[i] = r[3 * i] * point[0] + r[3 * i + 1] * point[1]
        + r[3 * i + 2] * point[2] + t[i];
  to[0] = film->focal * p[0] / p[2] + film->centre[0];
  to[1] = film->focal * p[1] / p[2] + film->centre[1];
  to[2] = film->focal * film->baseline / p[2];
}

static void
draw (const TestStereo * film, const gdouble a[3], const gdouble b[3],
    const gdouble c[3], gfloat * disparities)
{
  const gdouble area = (b[0] - a[0]) * (c[1] - a[1])
      - (c[0] - a[0]) * (b[1] - a[1]);
  const gint left = (gint) ceil (MAX (fmin (a[0], fmin (b[0], c[0])), 0));
  const gint top = (gint) ceil (MAX (fmin (a[1], fmin (b[1], c[1])), 0));
  const gint right = (gint) floor (MIN (fmax (a[0], fmax (b[0], c[0])),
          film->width - 1));
  const gint bottom = (gint) floor (MIN (fmax (a[1], fmax (b[1], c[1])),
          film->height - 1));

  if (fabs (area) < 1e-12)
    return;
  for (gint y = top; y <= bottom; y++)
    for (gint x = left; x <= right; x++) {
      const gdouble u = ((x - a[0]) * (c[1] - a[1])
          - (c[0] - a[0]) * (y - a[1])) / area;
      const gdouble v = ((b[0] - a[0]) * (y - a[1])
          - (x - a[0]) * (b[1] - a[1])) / area;
      const gdouble d = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
      gfloat *to = &disparities[y * film->width + x];

      /* edges belong to both sides */
      if (u > -1e-9 && v > -1e-9 && u + v < 1 + 1e-9
          && (isnan (*to) || *to < (gfloat) d))
        *to = (gfloat) d;
    }
}

/* @disparities: (out caller-allocates): of each pixel of the middle camera, px; NaN beside
 *   the cloth
 */
void
test_stereo_truth (const TestStereo * film, guint frame, gfloat * disparities)
{
  const gfloat *cell = film->vertices + (gsize) frame * 3 * ROWS * COLUMNS;

  for (gint i = 0; i < film->width * film->height; i++)
    disparities[i] = NAN;
  for (gint k = 0; k < (ROWS - 1) * COLUMNS; k++, cell += 3) {
    gdouble grid[PARTS + 1][PARTS + 1][3];

    if (k % COLUMNS == COLUMNS - 1)
      continue;
    for (gint i = 0; i <= PARTS; i++)
      for (gint j = 0; j <= PARTS; j++) {
        const gdouble v = i / (gdouble) PARTS, u = j / (gdouble) PARTS;
        gdouble point[3];

        for (gint c = 0; c < 3; c++)
          point[c] = (1 - v) * ((1 - u) * (gdouble) cell[c]
              + u * (gdouble) cell[3 + c])
              + v * ((1 - u) * (gdouble) cell[3 * COLUMNS + c]
              + u * (gdouble) cell[3 * COLUMNS + 3 + c]);
        project (film, point, grid[i][j]);
      }
    for (gint i = 0; i < PARTS; i++)
      for (gint j = 0; j < PARTS; j++) {
        draw (film, grid[i][j], grid[i][j + 1], grid[i + 1][j], disparities);
        draw (film, grid[i + 1][j + 1], grid[i][j + 1], grid[i + 1][j],
            disparities);
      }
  }
}
