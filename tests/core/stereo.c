/* A stereo head on the film of a rendered cloth, whose depth is known: partners at both
 * sides, lenses, masks; and what can't be a head.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/stereo/stereo.h"

#include <malloc.h>
#include <math.h>
#include <string.h>

#include "gst/rig/rigfile.h"
#include "tests/common/picture.h"
#include "tests/common/stereo.h"
#include "tests/common/stereoscene.h"

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
  static const gint all[] = { 0, 1, 2 }, left[] = { 0, 2 };

  /* 18 mm a pixel; of what Digiclops gave the paper no figure is known */
  run (all, 3, TRUE, "three cameras", 0.99, 2.1e-3);
  run (all, 2, TRUE, "right partner", 0.99, 2.6e-3);
  run (left, 2, TRUE, "left partner", 0.99, 2.6e-3);
  run (all, 3, FALSE, "no mask", 0.99, 2.2e-3);
}

/* ---- a plane ---- */

typedef struct
{
  ClothRig *rig;
  guint8 *pictures[3];
  gint stride;
} Plane;

static void
film_plane (Plane * plane, gint stride)
{
  plane->stride = stride;
  for (guint i = 0; i < plane->rig->n_cameras; i++) {
    plane->pictures[i] = g_malloc ((gsize) (stride * SCENE_HEIGHT));
    memset (plane->pictures[i], 99, (gsize) (stride * SCENE_HEIGHT));
    scene_film (&plane->rig->cameras[i], 0, plane->pictures[i], stride);
  }
}

static void
clear_plane (Plane * plane)
{
  for (guint i = 0; i < 3; i++)
    g_free (plane->pictures[i]);
  cloth_rig_free (plane->rig);
}

static ClothStereoParams
params_of_plane (void)
{
  ClothStereoParams params = cloth_stereo_default_params ();

  params.near = SCENE_NEAR;
  params.far = SCENE_FAR;
  return params;
}

/* @order: of the cameras; @least: share of all pixels with a disparity
 * Returns: RMS of the points' distances from the plane, m */
static gdouble
measure_plane (const Plane * plane, const gint * order, guint n,
    ClothPool * pool, gdouble least)
{
  const ClothStereoParams params = params_of_plane ();
  const ClothCamera *of[3], *head = &plane->rig->cameras[order[0]];
  ClothImage images[3];
  ClothStereoResult result;
  ClothStereoGeometry geometry;
  g_autoptr (ClothStereo) stereo = NULL;
  g_autoptr (GError) error = NULL;
  gdouble sum = 0;
  guint n_known = 0;

  for (guint i = 0; i < n; i++) {
    of[i] = &plane->rig->cameras[order[i]];
    images[i] = (ClothImage) {
    plane->pictures[order[i]], SCENE_WIDTH, SCENE_HEIGHT, plane->stride};
  }
  stereo = cloth_stereo_new (of, n, &params, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_stereo_run (stereo, images, NULL, pool, &result,
          &error));
  geometry = cloth_stereo_get_geometry (stereo);
  for (gint y = 0; y < SCENE_HEIGHT; y++)
    for (gint x = 0; x < SCENE_WIDTH; x++) {
      const gsize at = (gsize) (y * SCENE_WIDTH + x);
      const gdouble ray[3] = { (gdouble) geometry.rays[2 * at],
        (gdouble) geometry.rays[2 * at + 1], 1
      };
      const gdouble d = (gdouble) result.map.disparities[at];
      gdouble along = 0, X[3], off;

      if (result.map.states[at] < CLOTH_DISPARITY_MEASURED)
        continue;
      for (gint k = 0; k < 3; k++)
        along += geometry.normal[k] * ray[k];
      off = geometry.focal_baseline / (d * along) - scene_depth (head, x, y, X);
      n_known++;
      sum += off * off;
    }
  g_assert_cmpfloat (n_known, >, least * SCENE_WIDTH * SCENE_HEIGHT);
  return sqrt (sum / n_known);
}

/* A partner in any direction, and any two of them; 37 mm a pixel. */
static void
test_directions (void)
{
  static const gint heads[][3] = { {0, 1, 2}, {0, 2, 1}, {0, 1, -1}, {0, 2, -1},
  {1, 0, -1}, {2, 0, -1}, {1, 2, -1}, {2, 1, 0}
  };
  Plane plane = { scene_rig () };

  film_plane (&plane, SCENE_WIDTH);
  for (guint i = 0; i < G_N_ELEMENTS (heads); i++) {
    const guint n = heads[i][2] < 0 ? 2 : 3;
    const gdouble rms = measure_plane (&plane, heads[i], n, NULL, 0.7);

    g_test_message ("%d %d %d: RMS %.2f mm", heads[i][0], heads[i][1],
        heads[i][2], 1e3 * rms);
    g_assert_cmpfloat (rms, <, 1.2e-3);
  }
  clear_plane (&plane);
}

/* Lenses are undone: what they bend by is up to 11 px here. */
static void
test_lenses (void)
{
  static const gdouble k[][8] = { {0}, {-0.25, 0.08, 1e-3, -5e-4, -0.01},
  {-0.1, 0.05, 1e-3, -5e-4, 0.01, 0.1, 0.02, 0.003}, {-0.02, 0.004, -1e-3, 2e-4}
  };
  static const gint order[] = { 0, 1, 2 };

  for (ClothLens lens = CLOTH_LENS_NONE; lens <= CLOTH_LENS_FISHEYE; lens++) {
    Plane plane = { scene_rig () };
    gdouble rms;

    for (guint i = 0; i < 3; i++) {
      plane.rig->cameras[i].lens = lens;
      memcpy (plane.rig->cameras[i].k, k[lens], sizeof (k[lens]));
    }
    film_plane (&plane, SCENE_WIDTH);
    rms = measure_plane (&plane, order, 3, NULL, 0.7);
    g_test_message ("%s: RMS %.2f mm", cloth_lens_to_string (lens), 1e3 * rms);
    g_assert_cmpfloat (rms, <, 1.2e-3);
    clear_plane (&plane);
  }
}

/* The same pictures with gaps between the rows, and by more threads: the same bytes. */
static void
test_same (void)
{
  const ClothStereoParams params = params_of_plane ();
  g_autofree gfloat *first = NULL;

  for (guint i = 0; i < 3; i++) {
    Plane plane = { scene_rig () };
    const ClothCamera *of[3];
    ClothImage images[3];
    ClothStereoResult result;
    g_autoptr (ClothStereo) stereo = NULL;
    g_autoptr (ClothPool) pool = i ? cloth_pool_new (1 + 2 * i) : NULL;
    const gsize size = SCENE_WIDTH * SCENE_HEIGHT * sizeof (gfloat);

    film_plane (&plane, SCENE_WIDTH + (gint) (13 * i));
    for (guint k = 0; k < 3; k++) {
      of[k] = &plane.rig->cameras[k];
      images[k] = (ClothImage) {
      plane.pictures[k], SCENE_WIDTH, SCENE_HEIGHT, plane.stride};
    }
    stereo = cloth_stereo_new (of, 3, &params, NULL);
    for (guint round = 0; round < 2; round++) {
      g_assert_true (cloth_stereo_run (stereo, images, NULL, pool, &result,
              NULL));
      if (!first)
        first = g_memdup2 (result.map.disparities, size);
      else
        g_assert_cmpmem (result.map.disparities, size, first, size);
    }
    clear_plane (&plane);
  }
}

/* Memory stays as it is from one set to the next. */
static void
test_steady (void)
{
  const ClothStereoParams params = params_of_plane ();
  Plane plane = { scene_rig () };
  const ClothCamera *of[3];
  ClothImage images[3];
  g_autoptr (ClothStereo) stereo = NULL;
  gsize before = 0;

  film_plane (&plane, SCENE_WIDTH);
  for (guint k = 0; k < 3; k++) {
    of[k] = &plane.rig->cameras[k];
    images[k] = (ClothImage) {
    plane.pictures[k], SCENE_WIDTH, SCENE_HEIGHT, SCENE_WIDTH};
  }
  stereo = cloth_stereo_new (of, 3, &params, NULL);
  for (guint i = 0; i < 6; i++) {
    ClothStereoResult result;

    g_assert_true (cloth_stereo_run (stereo, images, NULL, NULL, &result,
            NULL));
    if (i == 1)
      before = mallinfo2 ().uordblks;
  }
  g_assert_cmpuint (mallinfo2 ().uordblks, <=, before + 4096);
  clear_plane (&plane);
}

/* What the range leaves out is told, and what the mask does has no disparity. */
static void
test_range (void)
{
  static const gdouble ranges[][2] = { {0.8, 1.6}, {1.12, 1.6}, {0.8, 1.08} };
  Plane plane = { scene_rig () };
  guint8 mask[SCENE_WIDTH * SCENE_HEIGHT] = { 0 };
  const ClothImage cloth = { mask, SCENE_WIDTH, SCENE_HEIGHT, SCENE_WIDTH };
  const ClothCamera *of[2] = { &plane.rig->cameras[0], &plane.rig->cameras[1] };
  ClothImage images[2];

  film_plane (&plane, SCENE_WIDTH);
  for (gint y = 40; y < 150; y++)
    memset (mask + y * SCENE_WIDTH + 60, 255, 120);
  for (guint k = 0; k < 2; k++)
    images[k] = (ClothImage) {
    plane.pictures[k], SCENE_WIDTH, SCENE_HEIGHT, SCENE_WIDTH};
  for (guint i = 0; i < 3; i++) {
    ClothStereoParams params = params_of_plane ();
    ClothStereoResult result;
    g_autoptr (ClothStereo) stereo = NULL;

    params.near = ranges[i][0];
    params.far = ranges[i][1];
    stereo = cloth_stereo_new (of, 2, &params, NULL);
    g_assert_true (cloth_stereo_run (stereo, images, &cloth, NULL, &result,
            NULL));
    g_test_message ("%g to %g m: %.3f near, %.3f far, chance %.3f", params.near,
        params.far, result.border[0].near_end, result.border[0].far_end,
        result.border[0].chance);
    g_assert_cmpuint (result.n_mask, ==, 110 * 120);
    for (gsize k = 0; k < SCENE_WIDTH * SCENE_HEIGHT; k++) {
      g_assert_true ((result.map.states[k] == CLOTH_DISPARITY_OUTSIDE) ==
          !mask[k]);
      g_assert_true (isnan (result.map.disparities[k]) ==
          (result.map.states[k] < CLOTH_DISPARITY_MEASURED));
    }
    if (i == 0)
      g_assert_cmpuint (result.n_measured, >, 120 * 105);
    g_assert_true ((result.border[0].near_end > 0.1) == (i == 1));
    g_assert_true ((result.border[0].far_end > 0.1) == (i == 2));
  }
  clear_plane (&plane);
}

/* Nothing of the cloth, or of any print: no disparity, and no error. */
static void
test_nothing (void)
{
  const ClothStereoParams params = params_of_plane ();
  Plane plane = { scene_rig () };
  guint8 mask[SCENE_WIDTH * SCENE_HEIGHT] = { 0 };
  const ClothImage none = { mask, SCENE_WIDTH, SCENE_HEIGHT, SCENE_WIDTH };
  const ClothCamera *of[2] = { &plane.rig->cameras[0], &plane.rig->cameras[1] };
  ClothImage images[2];
  ClothStereoResult result;
  g_autoptr (ClothStereo) stereo = cloth_stereo_new (of, 2, &params, NULL);

  film_plane (&plane, SCENE_WIDTH);
  for (guint k = 0; k < 2; k++)
    images[k] = (ClothImage) {
    plane.pictures[k], SCENE_WIDTH, SCENE_HEIGHT, SCENE_WIDTH};
  g_assert_true (cloth_stereo_run (stereo, images, &none, NULL, &result, NULL));
  g_assert_cmpuint (result.n_mask, ==, 0);
  g_assert_cmpuint (result.n_measured, ==, 0);
  g_assert_true (isnan (result.sigma));
  for (guint k = 0; k < 2; k++)
    memset (plane.pictures[k], 128, SCENE_WIDTH * SCENE_HEIGHT);
  g_assert_true (cloth_stereo_run (stereo, images, NULL, NULL, &result, NULL));
  g_assert_cmpfloat (result.n_measured, <, 0.01 * SCENE_WIDTH * SCENE_HEIGHT);
  clear_plane (&plane);
}

/* ---- what can't be ---- */

static void
refuse (const ClothRig * rig, const gint * order, guint n,
    const ClothStereoParams * params, const gchar * word)
{
  const ClothCamera *of[4];
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothStereo) stereo = NULL;

  for (guint i = 0; i < n; i++)
    of[i] = &rig->cameras[order[i]];
  stereo = cloth_stereo_new (of, n, params, &error);
  g_assert_null (stereo);
  g_assert_nonnull (error);
  if (!strstr (error->message, word))
    g_error ("“%s” says nothing of “%s”", error->message, word);
}

static void
test_refused (void)
{
  static const gint order[] = { 0, 1, 2, 0 }, twice[] = { 0, 1, 0 };
  g_autoptr (ClothRig) rig = scene_rig ();
  const ClothCamera *of[2] = { &rig->cameras[0], &rig->cameras[1] };
  ClothStereoParams params = params_of_plane ();
  g_autoptr (ClothStereo) stereo = cloth_stereo_new (of, 2, &params, NULL);
  static const guint8 pixels[SCENE_WIDTH * SCENE_HEIGHT];
  ClothImage images[2] = { {pixels, SCENE_WIDTH, SCENE_HEIGHT, SCENE_WIDTH},
  {pixels, SCENE_WIDTH - 1, SCENE_HEIGHT, SCENE_WIDTH}
  };
  ClothStereoResult result;
  g_autoptr (GError) error = NULL;

  refuse (rig, order, 1, &params, "2 to 3");
  refuse (rig, order, 4, &params, "2 to 3");
  refuse (rig, twice, 3, &params, "one place");
  params.near = 2;
  refuse (rig, order, 2, &params, "far more than near");
  params = params_of_plane ();
  params.near = 1e-3;
  refuse (rig, order, 2, &params, "Raise near");
  params = params_of_plane ();
  params.window = 8;
  refuse (rig, order, 2, &params, "odd");
  params = params_of_plane ();
  params.large_step = params.small_step;
  refuse (rig, order, 2, &params, "small-step");
  params = params_of_plane ();
  params.left_right = -1;
  refuse (rig, order, 2, &params, "left-right");
  params = params_of_plane ();
  params.agree = NAN;
  refuse (rig, order, 2, &params, "agree");
  /* pictures of another size than the cameras' */
  g_assert_false (cloth_stereo_run (stereo, images, NULL, NULL, &result,
          &error));
  g_assert_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP);
  g_clear_error (&error);
  images[1] = images[0];
  images[0].stride = SCENE_WIDTH - 1;
  g_assert_false (cloth_stereo_run (stereo, images, NULL, NULL, &result,
          &error));
  g_assert_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP);
}

int
main (int argc, char **argv)
{
  test_picture_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  load ();
  g_test_add_func ("/stereo/film", test_film);
  g_test_add_func ("/stereo/directions", test_directions);
  g_test_add_func ("/stereo/lenses", test_lenses);
  g_test_add_func ("/stereo/same", test_same);
  g_test_add_func ("/stereo/steady", test_steady);
  g_test_add_func ("/stereo/range", test_range);
  g_test_add_func ("/stereo/nothing", test_nothing);
  g_test_add_func ("/stereo/refused", test_refused);
  return g_test_run ();
}
