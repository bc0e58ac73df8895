/* The depth of a cloth out of three pictures.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/bench/filmdepth.h"

#include <string.h>

#define LEAST 32
#define RANGE 128
#define WINDOW 11

void
film_depth_init (FilmDepth * depth, gint width, gint height)
{
  const gsize n = (gsize) width * (gsize) height;
  ClothCvStereoParams params = cloth_cv_stereo_default_params ();

  params.least = LEAST;
  params.range = RANGE;
  params.window = WINDOW;
  params.small_step = 8 * WINDOW * WINDOW;
  params.large_step = 32 * WINDOW * WINDOW;
  *depth = (FilmDepth) {
    .width = width,.height = height,.pool = cloth_pool_new (2),.stereo =
        cloth_cv_stereo_new (&params, NULL),.surface =
        cloth_disparity_new (),.refine = cloth_refine_new (),.map = {
      g_new (gfloat, n), g_malloc (n), width, height, width
    }
  };
  for (gint k = 0; k < 2; k++) {
    depth->found[k] = g_new (gint16, n);
    depth->mirrored[k] = g_malloc (n);
  }
}

void
film_depth_clear (FilmDepth * depth)
{
  cloth_cv_stereo_free (depth->stereo);
  cloth_disparity_free (depth->surface);
  cloth_refine_free (depth->refine);
  cloth_pool_free (depth->pool);
  for (gint k = 0; k < 2; k++) {
    g_free (depth->found[k]);
    g_free (depth->mirrored[k]);
  }
  g_free (depth->map.disparities);
  g_free (depth->map.states);
}

/* Bounds for the sixteenths of a pixel that two baselines agree on. */
ClothDisparityParams
film_depth_sixteenths (void)
{
  ClothDisparityParams params = cloth_disparity_default_params ();

  params.half_width = 0.4;
  params.narrowing = 0.7;
  return params;
}

/* Bounds for what the pictures have refined. */
ClothDisparityParams
film_depth_polish (void)
{
  ClothDisparityParams params = cloth_disparity_default_params ();

  params.half_width = 0.05;
  return params;
}

static void
mirror (const FilmDepth * depth, const guint8 * from, guint8 * to)
{
  const gint width = depth->width;

  for (gint y = 0; y < depth->height; y++)
    for (gint x = 0; x < width; x++)
      to[y * width + x] = from[y * width + width - 1 - x];
}

/* @pictures: of the middle, the right and the left camera
 */
void
film_depth_match (FilmDepth * depth, const guint8 * const pictures[3])
{
  const gint w = depth->width, h = depth->height;
  const ClothCvPicture middle = { pictures[0], w, h, w };
  const ClothCvPicture right = { pictures[1], w, h, w };
  const ClothCvPicture one = { depth->mirrored[0], w, h, w };
  const ClothCvPicture other = { depth->mirrored[1], w, h, w };

  mirror (depth, pictures[0], depth->mirrored[0]);
  mirror (depth, pictures[2], depth->mirrored[1]);
  if (!cloth_cv_stereo_run (depth->stereo, &middle, &right, depth->found[0],
          NULL) || !cloth_cv_stereo_run (depth->stereo, &one, &other,
          depth->found[1], NULL))
    g_error ("no disparities");
}

/* The mask is that of the map's states. */
void
film_depth_merge (FilmDepth * depth, guint n_pairs)
{
  const gint w = depth->width, h = depth->height;
  const gdouble place[9] = { -1, 0, w - 1, 0, 1, 0, 0, 0, 1 };
  ClothDisparityPair pairs[2];

  for (gint k = 0; k < 2; k++)
    pairs[k] = cloth_disparity_pair (depth->found[k], w, h);
  memcpy (pairs[1].place, place, sizeof (place));
  if (!cloth_disparity_merge (pairs, n_pairs, 0.7, &depth->map, depth->pool,
          NULL))
    g_error ("not merged");
}

void
film_depth_fill (FilmDepth * depth, const ClothDisparityParams * params)
{
  if (!cloth_disparity_fill (depth->surface, params, &depth->map, depth->pool,
          CLOTH_SIMD_BEST, NULL))
    g_error ("not filled");
}

void
film_depth_smooth (FilmDepth * depth, const ClothDisparityParams * params)
{
  if (!cloth_disparity_smooth (depth->surface, params, &depth->map,
          depth->pool, CLOTH_SIMD_BEST, NULL))
    g_error ("not smoothed");
}

void
film_depth_refine (FilmDepth * depth, const guint8 * const pictures[3])
{
  const gint w = depth->width, h = depth->height;
  const ClothRefineParams params = cloth_refine_default_params ();
  const ClothImage image = { pictures[0], w, h, w };
  const ClothRefineView views[2] = { {{pictures[1], w, h, w}, {-1, 0}},
  {{pictures[2], w, h, w}, {1, 0}}
  };

  if (!cloth_refine_run (depth->refine, &params, &image, views, 2,
          &depth->map, depth->pool, NULL))
    g_error ("not refined");
}
