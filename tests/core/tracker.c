/* The trackers on features and pictures made by hand: what each keeps, finds again, loses and
 * refuses.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/vision/track/tracker.h"

#define BYTES CLOTH_CV_SIFT_BYTES
#define CAMERAS 3
#define WIDTH 320
#define HEIGHT 240
#define POINTS 60

/* A cloth of 0.6 × 0.5 m about the origin, whose points have descriptors of their own. */
typedef struct
{
  ClothCamera cameras[CAMERAS];
  ClothFlatPose pose;
  gdouble uv[POINTS][2];
  guint8 looks[POINTS][BYTES], later[POINTS][BYTES];
  guint8 *picture;
  /* of the frame at hand */
  guint n[CAMERAS];
  gfloat x[CAMERAS][POINTS + 1], y[CAMERAS][POINTS + 1];
  guint8 described[CAMERAS][POINTS + 1][BYTES];
  ClothTrackerView views[CAMERAS];
} Scene;

static ClothCamera
look_down (gdouble x, gdouble y)
{
  /* at (x, y, 1.2), down to the origin */
  const gdouble far = sqrt (x * x + y * y + 1.44);
  const gdouble z[3] = { -x / far, -y / far, -1.2 / far };
  const gdouble flat = hypot (1., z[0] / z[2]);
  /* the right is as near to the world's x as can be */
  const gdouble r[3] = { 1. / flat, 0., -z[0] / z[2] / flat };
  ClothCamera c = {.width = WIDTH,.height = HEIGHT,
    .K = {300, 0, 159.5, 0, 300, 119.5, 0, 0, 1}
  };

  for (guint k = 0; k < 3; k++) {
    c.R[k] = r[k];
    c.R[3 + k] = z[(k + 1) % 3] * r[(k + 2) % 3] - z[(k + 2) % 3] * r[(k +
            1) % 3];
    c.R[6 + k] = z[k];
  }
  for (guint k = 0; k < 3; k++)
    c.t[k] = -(c.R[3 * k] * x + c.R[3 * k + 1] * y + c.R[3 * k + 2] * 1.2);
  return c;
}

static Scene *
scene_new (void)
{
  Scene *s = g_new0 (Scene, 1);
  ClothRandom random;

  cloth_random_init (&random, 3);
  s->cameras[0] = look_down (0.5, 0.1);
  s->cameras[1] = look_down (-0.5, 0.3);
  s->cameras[2] = look_down (0.1, -0.6);
  s->pose = (ClothFlatPose) {
    -0.3, 0.25, 0., {
    0.6, 0.5}
  , 0., 0.};
  for (guint i = 0; i < POINTS; i++) {
    /* 3 cm apart at least */
    s->uv[i][0] =
        0.03 + 0.06 * (i % 10) + 0.02 * cloth_random_uniform (&random);
    s->uv[i][1] =
        0.03 + 0.08 * (i / 10) + 0.02 * cloth_random_uniform (&random);
    for (guint k = 0; k < BYTES; k++) {
      s->looks[i][k] = (guint8) (255. * cloth_random_uniform (&random));
      s->later[i][k] = (guint8) (255. * cloth_random_uniform (&random));
    }
  }
  s->picture = g_malloc0 (WIDTH * HEIGHT);
  return s;
}

static void
scene_free (Scene * s)
{
  g_free (s->picture);
  g_free (s);
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (Scene, scene_free);

static void
find_place (const Scene * s, guint i, gdouble height, gdouble X[3])
{
  X[0] = s->pose.x + s->uv[i][0];
  X[1] = s->pose.y - s->uv[i][1];
  X[2] = height;
}

/* What is seen of the cloth when it is lifted to @height; @seen: by each camera. @change: bytes of
 * descriptors that are what they will be later */
static void
film (Scene * s, gdouble height, const gboolean seen[CAMERAS], guint change)
{
  for (guint c = 0; c < CAMERAS; c++) {
    gdouble rows[POINTS];
    guint order[POINTS];

    s->n[c] = 0;
    for (guint i = 0; i < POINTS && seen[c]; i++) {
      gdouble X[3], px[2];
      guint at = s->n[c];

      find_place (s, i, height, X);
      g_assert_true (cloth_camera_project (&s->cameras[c], X, px, NULL, NULL));
      /* by rows, as features are */
      for (; at > 0 && rows[at - 1] > px[1]; at--) {
        rows[at] = rows[at - 1];
        order[at] = order[at - 1];
      }
      rows[at] = px[1];
      order[at] = i;
      s->n[c]++;
    }
    for (guint j = 0; j < s->n[c]; j++) {
      gdouble X[3], px[2];

      find_place (s, order[j], height, X);
      cloth_camera_project (&s->cameras[c], X, px, NULL, NULL);
      s->x[c][j] = (gfloat) px[0];
      s->y[c][j] = (gfloat) px[1];
      memcpy (s->described[c][j], s->looks[order[j]], BYTES);
      memcpy (s->described[c][j], s->later[order[j]], change);
    }
    s->views[c] = (ClothTrackerView) {
      {
      s->picture, WIDTH, HEIGHT, WIDTH}
      , {
      s->n[c], s->x[c], s->y[c], NULL, NULL, s->described[c][0]}
    };
  }
}

static const gboolean by_all[CAMERAS] = { TRUE, TRUE, TRUE };
static const gboolean by_none[CAMERAS] = { FALSE };
static const gboolean by_one[CAMERAS] = { TRUE };
static const gboolean by_another[CAMERAS] = { FALSE, TRUE };

static ClothTracker *
start (Scene * s, ClothTrackerKind kind)
{
  const ClothTrackerParams params = cloth_tracker_default_params ();
  g_autoptr (GError) error = NULL;
  ClothTracker *tracker = cloth_tracker_new (kind, &params, CAMERAS,
      s->cameras, &error);

  g_assert_no_error (error);
  film (s, 0., by_all, 0);
  cloth_tracker_start (tracker, &s->pose, s->views, &error);
  g_assert_no_error (error);
  return tracker;
}

/* Runs a frame; returns how many points there are. */
static guint
run (ClothTracker * tracker, Scene * s)
{
  g_autoptr (GError) error = NULL;
  guint n_markers, n_features;

  cloth_tracker_run (tracker, s->views, &error);
  g_assert_no_error (error);
  cloth_tracker_get_markers (tracker, &n_markers);
  cloth_tracker_get_features (tracker, &n_features);
  g_assert_true (n_markers == 0 || n_features == 0);
  return n_markers + n_features;
}

static const ClothTrackerKind by_descriptors[] = { CLOTH_TRACKER_REFERENCE,
  CLOTH_TRACKER_FRAMES, CLOTH_TRACKER_MULTI, CLOTH_TRACKER_REFERENCE_2D,
  CLOTH_TRACKER_FRAMES_2D
};

/* All points are kept, with their numbers, where they are. */
static void
test_kept (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (by_descriptors); i++) {
    const ClothTrackerKind kind = by_descriptors[i];
    const gboolean is_3d = cloth_tracker_kind_is_3d (kind);
    g_autoptr (Scene) s = scene_new ();
    g_autoptr (ClothTracker) tracker = start (s, kind);
    guint n;

    for (guint frame = 1; frame <= 10; frame++) {
      const ClothTrackedMarker *markers;
      const ClothTrackedFeature *features;

      film (s, 0.01 * frame, by_all, 0);
      g_assert_cmpuint (run (tracker, s), ==, is_3d ? POINTS :
          CAMERAS * POINTS);
      markers = cloth_tracker_get_markers (tracker, &n);
      for (guint k = 0; k < n; k++) {
        g_assert_cmpuint (markers[k].n_rays, ==, 3);
        g_assert_cmpfloat_with_epsilon (markers[k].position[0],
            s->pose.x + markers[k].uv[0], 1e-4);
        g_assert_cmpfloat_with_epsilon (markers[k].position[1],
            s->pose.y - markers[k].uv[1], 1e-4);
        g_assert_cmpfloat_with_epsilon (markers[k].position[2], 0.01 * frame,
            1e-4);
      }
      features = cloth_tracker_get_features (tracker, &n);
      for (guint k = 0; k < n; k++) {
        const gdouble X[3] = { s->pose.x + features[k].uv[0],
          s->pose.y - features[k].uv[1], 0.01 * frame
        };
        gdouble px[2];

        cloth_camera_project (&s->cameras[features[k].camera], X, px, NULL,
            NULL);
        g_assert_cmpuint (features[k].id, ==, k);
        g_assert_cmpfloat_with_epsilon (features[k].px[0], px[0], 0.01);
        g_assert_cmpfloat_with_epsilon (features[k].px[1], px[1], 0.01);
      }
    }
  }
}

/* What happens when nothing is seen for some frames. */
static void
test_gap (void)
{
  static const struct
  {
    ClothTrackerKind kind;
    guint gap, n;
  } cases[] = {
    {CLOTH_TRACKER_REFERENCE, 3, POINTS},
    {CLOTH_TRACKER_REFERENCE, 25, POINTS},
    {CLOTH_TRACKER_FRAMES, 0, POINTS},
    {CLOTH_TRACKER_FRAMES, 1, 0},
    {CLOTH_TRACKER_MULTI, 19, POINTS},
    {CLOTH_TRACKER_MULTI, 20, 0},
    {CLOTH_TRACKER_REFERENCE_2D, 25, CAMERAS * POINTS},
    {CLOTH_TRACKER_FRAMES_2D, 1, 0},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (Scene) s = scene_new ();
    g_autoptr (ClothTracker) tracker = start (s, cases[i].kind);

    for (guint frame = 0; frame < cases[i].gap; frame++) {
      film (s, 0., by_none, 0);
      g_assert_cmpuint (run (tracker, s), ==, 0);
    }
    film (s, 0., by_all, 0);
    g_assert_cmpuint (run (tracker, s), ==, cases[i].n);
  }
}

/* Descriptors that change a little with each frame leave the reference behind. */
static void
test_change (void)
{
  guint n[G_N_ELEMENTS (by_descriptors)];

  for (guint i = 0; i < G_N_ELEMENTS (by_descriptors); i++) {
    g_autoptr (Scene) s = scene_new ();
    g_autoptr (ClothTracker) tracker = start (s, by_descriptors[i]);

    for (guint frame = 1; frame <= 64; frame++) {
      film (s, 0., by_all, 2 * frame);
      n[i] = run (tracker, s);
    }
  }
  g_assert_cmpuint (n[0], <, POINTS / 4);
  g_assert_cmpuint (n[2], ==, POINTS);
  g_assert_cmpuint (n[3], <, CAMERAS * POINTS / 4);
}

/* One camera makes no marker, but goes on seeing it: the multitrack has it again as soon as two do, though
 * none was there for longer than it looks back. */
static void
test_alone (void)
{
  g_autoptr (Scene) s = scene_new ();
  g_autoptr (ClothTracker) multi = start (s, CLOTH_TRACKER_MULTI);
  g_autoptr (ClothTracker) frames = start (s, CLOTH_TRACKER_FRAMES);

  film (s, 0., by_one, 0);
  g_assert_cmpuint (run (multi, s), ==, 0);
  g_assert_cmpuint (run (frames, s), ==, 0);
  for (guint frame = 0; frame < 30; frame++) {
    film (s, 0., frame % 2 ? by_one : by_another, 0);
    g_assert_cmpuint (run (multi, s), ==, 0);
  }
  film (s, 0., by_all, 0);
  g_assert_cmpuint (run (multi, s), ==, POINTS);
  g_assert_cmpuint (run (frames, s), ==, 0);
}

/* Too far: 20 px and 5 cm are allowed. */
static void
test_motion (void)
{
  g_autoptr (Scene) s = scene_new ();
  g_autoptr (ClothTracker) three = start (s, CLOTH_TRACKER_MULTI);
  g_autoptr (ClothTracker) two = start (s, CLOTH_TRACKER_FRAMES_2D);

  film (s, 0.055, by_all, 0);
  g_assert_cmpuint (run (three, s), ==, 0);
  g_assert_cmpuint (run (two, s), >, 0);
  /* in two frames it may */
  g_assert_cmpuint (run (three, s), >, POINTS / 2);
  film (s, 0.4, by_all, 0);
  /* what is on a camera's axis hardly moves in its picture */
  g_assert_cmpuint (run (two, s), <, CAMERAS * POINTS / 8);
}

/* A camera that shows another point with the same look: rays that don't meet make no marker. */
static void
test_rays (void)
{
  g_autoptr (Scene) s = scene_new ();
  g_autoptr (ClothTracker) tracker = start (s, CLOTH_TRACKER_MULTI);

  film (s, 0., by_all, 0);
  for (guint i = 0; i < s->n[1]; i++)
    s->y[1][i] += 5.f;
  g_assert_cmpuint (run (tracker, s), ==, 0);
}

/* A place that is described in two directions is tracked once. */
static void
test_twice (void)
{
  const ClothTrackerParams params = cloth_tracker_default_params ();

  for (guint kind = 0; kind < CLOTH_TRACKER_UVLESS; kind++) {
    g_autoptr (Scene) s = scene_new ();
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothTracker) tracker = cloth_tracker_new (
        (ClothTrackerKind) kind, &params, CAMERAS, s->cameras, &error);
    guint n[2];

    film (s, 0., by_all, 0);
    for (guint c = 0; c < CAMERAS; c++) {
      s->x[c][POINTS] = s->x[c][POINTS - 1];
      s->y[c][POINTS] = s->y[c][POINTS - 1];
      memset (s->described[c][POINTS], 77, BYTES);
      s->views[c].features.n++;
    }
    cloth_tracker_start (tracker, &s->pose, s->views, &error);
    g_assert_no_error (error);
    cloth_tracker_get_markers (tracker, &n[0]);
    cloth_tracker_get_features (tracker, &n[1]);
    g_assert_cmpuint (n[0] + n[1], ==, cloth_tracker_kind_is_3d
        ((ClothTrackerKind) kind) ? POINTS : CAMERAS * POINTS);
  }
}

/* ---- optical flow ---- */

static void
paint (guint8 * picture, gdouble dx, gdouble dy)
{
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      gdouble sum = 128.;

      for (guint k = 0; k < 12; k++)
        sum += 10. * sin ((x - dx) * (0.11 + 0.053 * k) * cos (1.3 * k) + (y -
                dy) * (0.13 + 0.047 * k) * sin (1.7 * k) + 2.1 * k * k);
      picture[y * WIDTH + x] = (guint8) CLAMP (sum, 0., 255.);
    }
}

static void
test_flow (gconstpointer data)
{
  const ClothTrackerKind kind = (ClothTrackerKind) GPOINTER_TO_UINT (data);
  const ClothTrackerParams params = cloth_tracker_default_params ();
  g_autoptr (Scene) s = scene_new ();
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTracker) tracker = cloth_tracker_new (kind, &params, CAMERAS,
      s->cameras, &error);
  const ClothTrackedFeature *features;
  guint n;

  film (s, 0., by_all, 0);
  paint (s->picture, 0, 0);
  g_assert_true (cloth_tracker_start (tracker, &s->pose, s->views, &error));
  features = cloth_tracker_get_features (tracker, &n);
  g_assert_cmpuint (n, ==, kind == CLOTH_TRACKER_UVLESS ? 0 : CAMERAS * POINTS);
  for (guint frame = 1; frame <= 3; frame++) {
    paint (s->picture, 2.3 * frame, -1.1 * frame);
    g_assert_cmpuint (run (tracker, s), >, CAMERAS * POINTS * 9 / 10);
    features = cloth_tracker_get_features (tracker, &n);
    for (guint i = 0; i < n; i++) {
      g_assert_cmpfloat_with_epsilon (features[i].px[0] - features[i].before[0],
          2.3, 0.15);
      g_assert_cmpfloat_with_epsilon (features[i].px[1] - features[i].before[1],
          -1.1, 0.15);
      g_assert_true (isnan (features[i].uv[0]) ==
          (kind == CLOTH_TRACKER_UVLESS));
    }
  }
  /* another picture altogether */
  memset (s->picture, 9, WIDTH * HEIGHT);
  run (tracker, s);
  for (gint i = 0; i < WIDTH * HEIGHT; i++)
    s->picture[i] = (guint8) (i * 2654435761u >> 13);
  g_assert_cmpuint (run (tracker, s), <, CAMERAS * POINTS / 10);
}

/* ---- refused ---- */

static void
test_names (void)
{
  ClothTrackerKind kind;

  for (guint k = 0; k < CLOTH_TRACKER_N_KINDS; k++) {
    g_assert_true (cloth_tracker_kind_from_string (cloth_tracker_kind_to_string
            ((ClothTrackerKind) k), &kind));
    g_assert_cmpuint (kind, ==, k);
  }
  g_assert_false (cloth_tracker_kind_from_string ("best", &kind));
  g_assert_false (cloth_tracker_kind_from_string ("", &kind));
}

static void
refuse (const ClothTrackerParams * params, guint n_cameras,
    ClothTrackerKind kind, const gchar * words)
{
  g_autoptr (Scene) s = scene_new ();
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_tracker_new (kind, params, n_cameras, s->cameras,
          &error));
  g_assert_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_PARAMETER);
  g_assert_true (g_pattern_match_simple (words, error->message));
}

static void
test_parameters (void)
{
  const ClothTrackerParams good = cloth_tracker_default_params ();
  ClothTrackerParams p = good;

  p.references = 0;
  refuse (&p, CAMERAS, CLOTH_TRACKER_MULTI, "*references*1 to 100*");
  p.references = 101;
  refuse (&p, CAMERAS, CLOTH_TRACKER_MULTI, "*references*");
  p = good;
  p.radius = 0.;
  refuse (&p, CAMERAS, CLOTH_TRACKER_MULTI, "*radius*");
  p = good;
  p.ratio = 1.1;
  refuse (&p, CAMERAS, CLOTH_TRACKER_MULTI, "*ratio*");
  p = good;
  p.motion_px = NAN;
  refuse (&p, CAMERAS, CLOTH_TRACKER_MULTI, "*motion*");
  refuse (&good, 0, CLOTH_TRACKER_UVLESS, "*cameras*");
  refuse (&good, 65, CLOTH_TRACKER_UVLESS, "*cameras*");
  refuse (&good, 1, CLOTH_TRACKER_FRAMES, "*frames*there is one*");
}

static void
test_views (void)
{
  g_autoptr (Scene) s = scene_new ();
  g_autoptr (ClothTracker) tracker = start (s, CLOTH_TRACKER_MULTI);
  g_autoptr (GError) error = NULL;

  s->views[2].image.width = 100;
  g_assert_false (cloth_tracker_run (tracker, s->views, &error));
  g_assert_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_VIEWS);
  g_clear_error (&error);
  g_assert_false (cloth_tracker_start (tracker, &s->pose, s->views, &error));
  g_assert_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_VIEWS);
}

static void
test_nothing (void)
{
  const ClothTrackerParams params = cloth_tracker_default_params ();
  g_autoptr (Scene) s = scene_new ();
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTracker) tracker = cloth_tracker_new (CLOTH_TRACKER_MULTI,
      &params, CAMERAS, s->cameras, &error);

  film (s, 0., by_all, 0);
  g_assert_false (cloth_tracker_run (tracker, s->views, &error));
  g_assert_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_START);
  g_clear_error (&error);
  /* the cloth lies elsewhere */
  s->pose.x += 3.;
  g_assert_false (cloth_tracker_start (tracker, &s->pose, s->views, &error));
  g_assert_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_START);
  g_clear_error (&error);
  /* or only one camera sees it */
  s->pose.x -= 3.;
  film (s, 0., by_one, 0);
  g_assert_false (cloth_tracker_start (tracker, &s->pose, s->views, &error));
  g_assert_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_START);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/tracker/kept", test_kept);
  g_test_add_func ("/tracker/gap", test_gap);
  g_test_add_func ("/tracker/change", test_change);
  g_test_add_func ("/tracker/alone", test_alone);
  g_test_add_func ("/tracker/motion", test_motion);
  g_test_add_func ("/tracker/rays", test_rays);
  g_test_add_func ("/tracker/twice", test_twice);
  g_test_add_data_func ("/tracker/lucas-kanade",
      GUINT_TO_POINTER (CLOTH_TRACKER_LUCAS_KANADE), test_flow);
  g_test_add_data_func ("/tracker/uvless",
      GUINT_TO_POINTER (CLOTH_TRACKER_UVLESS), test_flow);
  g_test_add_func ("/tracker/names", test_names);
  g_test_add_func ("/tracker/parameters", test_parameters);
  g_test_add_func ("/tracker/views", test_views);
  g_test_add_func ("/tracker/nothing", test_nothing);
  return g_test_run ();
}
