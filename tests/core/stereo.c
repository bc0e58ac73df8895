/* A stereo head on the film of a rendered cloth, whose depth is known: partners at both
 * sides, lenses, masks; and what can't be a head.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/stereo/stereo.h"

#include <math.h>
#include <string.h>

#include "gst/cv/cv.h"
#include "gst/rig/rigfile.h"
#include "tests/common/picture.h"
#include "tests/common/stereo.h"

#define FRAME 5
/* Depths that are further off are of another surface, m. */
#define WILD 0.02

typedef struct
{
  TestStereo *film;
  ClothRig *rig;
  gfloat *truth;                /* disparities of frame FRAME */
  guint8 *mask;
  gsize n;
} Scene;

static Scene scene;

static void
load (void)
{
  scene.film = test_stereo_load (TEST_DATA "/lineart_stereo3");
  scene.rig = cloth_rig_load (TEST_DATA "/lineart_stereo3/rig.json", NULL);
  scene.n = (gsize) scene.film->width * (gsize) scene.film->height;
  scene.truth = g_new (gfloat, scene.n);
  scene.mask = g_malloc (scene.n);
  test_stereo_truth (scene.film, FRAME, scene.truth);
  for (gsize i = 0; i < scene.n; i++)
    scene.mask[i] = isnan (scene.truth[i]) ? 0 : 255;
}

static ClothImage
picture (guint camera)
{
  return (ClothImage) {
  test_stereo_picture (scene.film, camera, FRAME), scene.film->width,
        scene.film->height, scene.film->width};
}

static ClothImage
mask (void)
{
  return (ClothImage) {
  scene.mask, scene.film->width, scene.film->height, scene.film->width};
}

static ClothStereoParams
params_of_film (void)
{
  ClothStereoParams params = cloth_stereo_default_params ();

  params.near = 1;
  params.far = 3;
  return params;
}

/* @rms: (out): of the depth of what is less than WILD off, m
 * Returns: share of the cloth that has a depth */
static gdouble
measure (const ClothStereo * stereo, const ClothStereoResult * result,
    gdouble * rms, gdouble * wild)
{
  const ClothStereoGeometry geometry = cloth_stereo_get_geometry (stereo);
  gdouble n = 0, n_known = 0, n_wild = 0, sum = 0;

  for (gsize i = 0; i < scene.n; i++) {
    const gdouble ray[3] = { (gdouble) geometry.rays[2 * i],
      (gdouble) geometry.rays[2 * i + 1], 1
    };
    const gdouble d = (gdouble) result->map.disparities[i];
    gdouble along = 0, z, off;

    if (isnan (scene.truth[i]))
      continue;
    n++;
    if (result->map.states[i] < CLOTH_DISPARITY_MEASURED)
      continue;
    n_known++;
    for (gint k = 0; k < 3; k++)
      along += geometry.normal[k] * ray[k];
    /* of the point s·(rx, ry, 1) the depth along the camera's own axis is s */
    z = geometry.focal_baseline / (d * along);
    off = z - scene.film->focal * scene.film->baseline /
        (gdouble) scene.truth[i];
    if (!(fabs (off) < WILD))
      n_wild++;
    else
      sum += off * off;
  }
  *rms = sqrt (sum / (n_known - n_wild));
  *wild = n_wild / n_known;
  return n_known / n;
}

/* The first @n of @cameras, as a head with or without a mask. */
static void
run (const gint * cameras, guint n, gboolean masked, const gchar * what,
    gdouble least_share, gdouble most_rms)
{
  const ClothCamera *of[3];
  ClothImage images[3], cloth = mask ();
  ClothStereoParams params = params_of_film ();
  ClothStereoResult result;
  g_autoptr (ClothStereo) stereo = NULL;
  g_autoptr (ClothPool) pool = cloth_pool_new (2);
  g_autoptr (GError) error = NULL;
  gdouble share, rms, wild;

  for (guint i = 0; i < n; i++) {
    of[i] = &scene.rig->cameras[cameras[i]];
    images[i] = picture ((guint) cameras[i]);
  }
  stereo = cloth_stereo_new (of, n, &params, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_stereo_run (stereo, images, masked ? &cloth : NULL, pool,
          &result, &error));
  g_assert_no_error (error);
  share = measure (stereo, &result, &rms, &wild);
  g_test_message ("%s: %.2f%% of the cloth, RMS %.2f mm, wild %.2f%%, sigma "
      "%.3f px, borders %.3f %.3f", what, 100 * share, 1e3 * rms, 100 * wild,
      result.sigma, result.border[0].near_end, result.border[0].far_end);
  g_assert_cmpfloat (share, >, least_share);
  g_assert_cmpfloat (rms, <, most_rms);
}

static void
test_film (void)
{
  static const gint all[] = { 0, 1, 2 }, left[] = { 0, 2 }, others[] = { 1, 0 };

  run (all, 3, TRUE, "three cameras", 0.9, 0.004);
  run (all, 2, TRUE, "right partner", 0.9, 0.005);
  run (left, 2, TRUE, "left partner", 0.9, 0.005);
  run (all, 3, FALSE, "no mask", 0.8, 0.004);
  (void) others;
}

int
main (int argc, char **argv)
{
  test_picture_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  load ();
  g_test_add_func ("/stereo/film", test_film);
  return g_test_run ();
}
