/* Vertices carried by optical flow: pictures that move by known flows, folds whose crests swallow
 * points, and what is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/cv/cv.h"
#include "gst/vision/track/follow.h"

#define WIDTH 320
#define HEIGHT 241
#define STRIDE 352
#define COLUMNS 12
#define ROWS 9
#define N (COLUMNS * ROWS)

/* A smooth texture without a period, at any place. */
static gdouble
texture (gdouble x, gdouble y)
{
  gdouble sum = 128.;

  for (guint k = 0; k < 12; k++)
    sum += 10. * sin (x * (0.11 + 0.053 * k) * cos (1.3 * k) + y * (0.13 +
            0.047 * k) * sin (1.7 * k) + 2.1 * k * k);
  return CLAMP (sum, 0., 255.);
}

/* Where a pixel of the moved picture came from. */
typedef void (*Way) (gdouble x, gdouble y, gdouble from[2]);

static guint8 *
draw (Way way)
{
  guint8 *data = g_malloc0 (STRIDE * HEIGHT);

  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      gdouble from[2] = { x, y };

      if (way)
        way (x, y, from);
      data[y * STRIDE + x] = (guint8) (texture (from[0], from[1]) + 0.5);
    }
  return data;
}

static void
shift (gdouble x, gdouble y, gdouble from[2])
{
  from[0] = x - 3.3;
  from[1] = y + 2.6;
}

static void
turn (gdouble x, gdouble y, gdouble from[2])
{
  const gdouble c = cos (0.02), s = sin (0.02);

  from[0] = 160. + (c * (x - 160.) + s * (y - 120.)) / 1.02;
  from[1] = 120. + (-s * (x - 160.) + c * (y - 120.)) / 1.02;
}

static void
fill (ClothGridVertex * vertices)
{
  for (guint v = 0; v < N; v++)
    vertices[v] = (ClothGridVertex) {
    CLOTH_GRID_ALIGNED, FALSE, 40. + 20. * (v % COLUMNS) + 0.3, 35. +
        20. * (v / COLUMNS) + 0.4, 0.01, 0.002, 0.02};
}

static void
forget (ClothGridVertex * vertices)
{
  for (guint v = 0; v < N; v++)
    vertices[v] = (ClothGridVertex) {
    CLOTH_GRID_UNSEEN, FALSE, NAN, NAN, NAN, NAN, NAN};
}

static guint
follow (ClothFollower * follower, const ClothFollowParams * params,
    const guint8 * data, ClothGridVertex * vertices)
{
  const ClothImage image = { data, WIDTH, HEIGHT, STRIDE };
  g_autoptr (GError) error = NULL;
  guint n;

  g_assert_true (cloth_follower_run (follower, params, &image, vertices, &n,
          &error));
  g_assert_no_error (error);
  return n;
}

/* Points go where the picture goes, and are less sure; those that are known stay what they are. */
static void
test_flow (gconstpointer data)
{
  const Way way = (Way) data;
  const ClothFollowParams params = cloth_follow_default_params ();
  g_autoptr (ClothFollower) follower = cloth_follower_new (COLUMNS, ROWS);
  g_autofree guint8 *first = draw (NULL), *second = draw (way);
  ClothGridVertex vertices[N], known[N];

  fill (vertices);
  fill (known);
  g_assert_cmpuint (follow (follower, &params, first, vertices), ==, 0);
  forget (vertices);
  vertices[5] = known[5];
  vertices[5].x += 1.;
  g_assert_cmpuint (follow (follower, &params, second, vertices), >, N - 4);
  g_assert_cmpfloat (vertices[5].x, ==, known[5].x + 1.);
  for (guint v = 0; v < N; v++) {
    gdouble from[2];

    if (v == 5 || vertices[v].state == CLOTH_GRID_UNSEEN)
      continue;
    g_assert_cmpint (vertices[v].state, ==, CLOTH_GRID_FOLLOWED);
    way (vertices[v].x, vertices[v].y, from);
    g_assert_cmpfloat_with_epsilon (from[0], known[v].x, 0.2);
    g_assert_cmpfloat_with_epsilon (from[1], known[v].y, 0.2);
    g_assert_cmpfloat_with_epsilon (vertices[v].xx, 0.01 + 0.15 * 0.15, 1e-9);
    g_assert_cmpfloat_with_epsilon (vertices[v].xy, 0.002, 1e-9);
  }
}

/* The right part of the picture slides under the left one: what it covers is lost. */
static void
slide (gdouble x, gdouble y, gdouble from[2])
{
  if (x > 150.)
    from[0] = x + 14.;
}

static void
test_crest (void)
{
  const ClothFollowParams careful = cloth_follow_default_params ();
  ClothFollowParams careless = careful;
  g_autofree guint8 *first = draw (NULL), *second = draw (slide);
  guint wrong[2] = { 0 };

  careless.crowding = 0.;
  careless.back = 100.;
  for (guint i = 0; i < 2; i++) {
    g_autoptr (ClothFollower) follower = cloth_follower_new (COLUMNS, ROWS);
    ClothGridVertex vertices[N], known[N];

    fill (vertices);
    fill (known);
    follow (follower, &careful, first, vertices);
    forget (vertices);
    follow (follower, i ? &careless : &careful, second, vertices);
    for (guint v = 0; v < N; v++) {
      const gdouble to = known[v].x < 150. ? known[v].x : known[v].x - 14.;

      wrong[i] += vertices[v].state == CLOTH_GRID_FOLLOWED
          && (fabs (vertices[v].x - to) > 2. || (known[v].x > 150.
              && to < 150.));
    }
  }
  g_test_message ("%u wrong, %u without the tests", wrong[0], wrong[1]);
  g_assert_cmpuint (wrong[0], <, wrong[1]);
  g_assert_cmpuint (wrong[0], <=, 1);
}

/* Grey pictures tell nothing, sure places become unsure, another size is another film. */
static void
test_lost (void)
{
  const ClothFollowParams params = cloth_follow_default_params ();
  g_autoptr (ClothFollower) follower = cloth_follower_new (COLUMNS, ROWS);
  g_autofree guint8 *first = draw (NULL), *second = draw (shift);
  g_autofree guint8 *grey = g_malloc0 (STRIDE * HEIGHT);
  const ClothImage small = { first, WIDTH - 8, HEIGHT, STRIDE };
  ClothGridVertex vertices[N];
  guint n;

  memset (grey, 128, STRIDE * HEIGHT);
  fill (vertices);
  follow (follower, &params, first, vertices);
  forget (vertices);
  g_assert_cmpuint (follow (follower, &params, grey, vertices), ==, 0);
  for (guint v = 0; v < N; v++)
    g_assert_true (vertices[v].state == CLOTH_GRID_UNSEEN
        && isnan (vertices[v].x));

  fill (vertices);
  for (guint v = 0; v < N; v++)
    vertices[v].yy = 3.99;
  follow (follower, &params, first, vertices);
  forget (vertices);
  g_assert_cmpuint (follow (follower, &params, second, vertices), ==, 0);

  fill (vertices);
  follow (follower, &params, first, vertices);
  forget (vertices);
  g_assert_true (cloth_follower_run (follower, &params, &small, vertices, &n,
          NULL));
  g_assert_cmpuint (n, ==, 0);

  fill (vertices);
  follow (follower, &params, first, vertices);
  cloth_follower_reset (follower);
  forget (vertices);
  g_assert_cmpuint (follow (follower, &params, second, vertices), ==, 0);
}

static void
test_refused (void)
{
  g_autofree guint8 *data = draw (NULL);
  const ClothCvPicture whole = { data, WIDTH, HEIGHT, STRIDE };
  const ClothCvPicture small = { data, WIDTH - 1, HEIGHT, STRIDE };
  const ClothCvPicture none = { NULL, WIDTH, HEIGHT, STRIDE };
  const ClothCvFlowParams usual = { 11, 3 }, wide = { 256, 3 }, deep =
      { 11, 11 };
  const gfloat point[2] = { 50, 50 };
  const struct
  {
    const ClothCvPicture *from, *to;
    const ClothCvFlowParams *params;
    const gchar *says;
  } faults[] = {
    {&whole, &small, &usual, "not of one film"},
    {&none, &whole, &usual, "No picture"},
    {&whole, &whole, &wide, "3 to 255"},
    {&whole, &whole, &deep, "0 to 10"}
  };

  for (guint i = 0; i < G_N_ELEMENTS (faults); i++) {
    g_autoptr (GError) error = NULL;
    gfloat moved[2];
    guint8 found[1];

    g_assert_false (cloth_cv_flow (faults[i].from, faults[i].to,
            faults[i].params, 1, point, moved, found, &error));
    g_assert_nonnull (strstr (error->message, faults[i].says));
  }
  g_assert_true (cloth_cv_flow (&whole, &whole, &usual, 0, NULL, NULL, NULL,
          NULL));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_data_func ("/follow/shift", (gconstpointer) shift, test_flow);
  g_test_add_data_func ("/follow/turn", (gconstpointer) turn, test_flow);
  g_test_add_func ("/follow/crest", test_crest);
  g_test_add_func ("/follow/lost", test_lost);
  g_test_add_func ("/follow/refused", test_refused);
  return g_test_run ();
}
