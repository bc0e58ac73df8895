/* The seven trackers on path-traced films of a cloth that lies flat and is lifted by a corner, held
 * against the mesh that was filmed: how many points they keep, and how many of them are wrong.
 *
 *   core-trackers [--plot FOLDER]
 *
 * --plot: draws the pictures of docs/fitting.md.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <cairo.h>
#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "gst/rig/rigfile.h"
#include "gst/vision/mask/mask.h"
#include "gst/vision/track/anneal.h"
#include "gst/vision/track/cast.h"
#include "gst/vision/track/tracker.h"
#include "simplot.h"
#include "tests/common/luma.h"
#include "tests/common/npyfloats.h"
#include "tests/common/picture.h"

/* The mesh that was filmed; bilinear in each cell. */
#define FOLDER TEST_DATA "/corner_lift/"
#define COLUMNS 33
#define ROWS 35
#define N (COLUMNS * ROWS)
#define WIDTH_M 0.63
#define HEIGHT_M 0.67
#define FRAMES 42
#define FPS 25.
#define CAMERAS 4
/* Of the cloth's thickness, as it was simulated. */
#define GROUND 0.006
/* A point is off the truth, m. */
#define OFF 0.005
/* Nearer to the camera than this much and it hides what is behind, m. */
#define HIDES 0.003

typedef struct
{
  const gchar *folder, *print;
  gboolean repeats;
} Film;

static const Film films[] = {
  {"lineart", "not repeated", FALSE},
  {"repeated", "repeated", TRUE},
};

#define N_FILMS G_N_ELEMENTS (films)

/* With -m slow, and for pictures, both; else the last one: most of the time goes into features. */
static guint first_film = N_FILMS - 1;

static const guint shown[] = { 0, 10, 20, 30, 41 };

/* The trackers, and last Lucas–Kanade without the test for crests, and with only the way back of it. */
#define PLAIN CLOTH_TRACKER_N_KINDS
#define BACK (CLOTH_TRACKER_N_KINDS + 1)
#define N_RUNS (CLOTH_TRACKER_N_KINDS + 2)

/* Of whose points a picture is drawn. */
#define DRAWN_FRAME 32
#define DRAWN_CAMERA 1

typedef struct
{
  guint points, off, hidden;
} Count;

/* A picture's features, kept. */
typedef struct
{
  ClothCvFeatures features;
  gfloat *places[4];
  guint8 *descriptors;
} Kept;

typedef struct
{
  ClothRig *rig;
  guint8 *luma[CAMERAS];
  Kept kept[CAMERAS][FRAMES];
  ClothFlatPose pose;
} Footage;

static gfloat *vertices;
static Footage footage[N_FILMS];
static ClothPool *pool;
static Count counts[N_FILMS][N_RUNS][FRAMES];
/* of the first film: x, y, and whether it is off or hidden; of the tested and the plain run */
static GArray *drawn[2];

/* ---- truth ---- */

static void
surface (guint frame, const gdouble uv[2], gdouble X[3])
{
  const gdouble x = uv[0] / WIDTH_M * (COLUMNS - 1);
  const gdouble y = uv[1] / HEIGHT_M * (ROWS - 1);
  const gint i = CLAMP ((gint) x, 0, COLUMNS - 2);
  const gint j = CLAMP ((gint) y, 0, ROWS - 2);
  const gfloat *at = vertices + 3 * ((gsize) frame * N + j * COLUMNS + i);
  const gfloat *below = at + 3 * COLUMNS;

  for (gint k = 0; k < 3; k++)
    X[k] = (1 - (y - j)) * ((1 - (x - i)) * at[k] + (x - i) * at[3 + k])
        + (y - j) * ((1 - (x - i)) * below[k] + (x - i) * below[3 + k]);
}

/* Does the segment from @eye to @X meet a triangle more than HIDES before its end? Möller and
 * Trumbore 1997. */
static gboolean
meets (const gdouble eye[3], const gdouble X[3], const gfloat * a,
    const gfloat * b, const gfloat * c)
{
  gdouble d[3], e[3], f[3], s[3], p[3], q[3], det, u, v, t;

  for (gint k = 0; k < 3; k++) {
    d[k] = X[k] - eye[k];
    e[k] = (gdouble) b[k] - a[k];
    f[k] = (gdouble) c[k] - a[k];
    s[k] = eye[k] - a[k];
  }
  cloth_vec3_cross (d, f, p);
  cloth_vec3_cross (s, e, q);
  det = cloth_vec3_dot (e, p);
  u = cloth_vec3_dot (s, p) / det;
  v = cloth_vec3_dot (d, q) / det;
  t = cloth_vec3_dot (f, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0
      && (1 - t) * cloth_vec3_length (d) > HIDES;
}

static gboolean
is_hidden (guint frame, const gdouble eye[3], const gdouble X[3])
{
  for (gint j = 0; j < ROWS - 1; j++)
    for (gint i = 0; i < COLUMNS - 1; i++) {
      const gfloat *at = vertices + 3 * ((gsize) frame * N + j * COLUMNS + i);

      if (meets (eye, X, at, at + 3, at + 3 * COLUMNS)
          || meets (eye, X, at + 3, at + 3 * COLUMNS, at + 3 * COLUMNS + 3))
        return TRUE;
    }
  return FALSE;
}

/* How far a place is from a ray. */
static gdouble
find_distance (const ClothRay * ray, const gdouble X[3])
{
  gdouble to[3], cross[3];

  cloth_vec3_subtract (X, ray->origin, to);
  cloth_vec3_cross (to, ray->direction, cross);
  return cloth_vec3_length (cross);
}

/* ---- footage ---- */

static void
keep (Kept * to, const ClothCvFeatures * from)
{
  const gfloat *const places[4] = { from->x, from->y, from->scale,
    from->angle
  };

  for (guint k = 0; k < 4; k++)
    to->places[k] = g_memdup2 (places[k], from->n * sizeof (gfloat));
  to->descriptors = g_memdup2 (from->descriptors,
      (gsize) from->n * CLOTH_CV_SIFT_BYTES);
  to->features = (ClothCvFeatures) {
  from->n, to->places[0], to->places[1], to->places[2], to->places[3],
        to->descriptors};
}

/* Finds the features of some pictures of all films. */
static void
describe (gpointer data, guint begin, guint end, guint worker)
{
  const ClothCvSiftParams params = cloth_cv_sift_default_params ();

  for (guint i = begin; i < end; i++) {
    Footage *f = &footage[first_film + i / (CAMERAS * FRAMES)];
    const guint camera = i / FRAMES % CAMERAS, frame = i % FRAMES;
    const ClothCamera *c = &f->rig->cameras[camera];
    const ClothCvPicture picture = { f->luma[camera] +
          (gsize) frame * c->width * c->height, c->width, c->height, c->width
    };
    g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (&params, NULL);
    ClothCvFeatures features;

    g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &features, NULL));
    keep (&f->kept[camera][frame], &features);
  }
}

/* The silhouettes of the first pictures. */
static void
find_masks (const Footage * f, guint8 * masks[CAMERAS])
{
  ClothMaskParams params = cloth_mask_default_params ();

  for (guint c = 0; c < CAMERAS; c++) {
    const ClothCamera *camera = &f->rig->cameras[c];
    g_autofree gchar *path = g_strdup_printf (FOLDER "background%u.png", c);
    g_autoptr (TestPicture) background = test_picture_load (path);
    g_autoptr (ClothMask) mask = cloth_mask_new ();
    const ClothPlanarImage image = { {f->luma[c], camera->width,
        camera->height, camera->width}, {0}, 0, 0, {0}
    };
    ClothPlanarImage behind = { background->image, {0}, 0, 0, {0} };
    const ClothRun *runs;
    guint n_runs;

    /* the film has the range of video */
    for (gsize i = 0; i < (gsize) camera->width * camera->height; i++)
      background->data[i] = (guint8) (16.5 + background->data[i] * 219. / 255.);
    cloth_mask_set_background (mask, &behind);
    cloth_mask_run (mask, &params, &image, pool, CLOTH_SIMD_BEST);
    runs = cloth_mask_get_runs (mask, &n_runs);
    masks[c] = g_malloc0 ((gsize) camera->width * camera->height);
    for (guint i = 0; i < n_runs; i++)
      memset (masks[c] + (gsize) runs[i].row * camera->width + runs[i].begin, 1,
          runs[i].end - runs[i].begin);
  }
}

static gdouble
measure_pose (const ClothFlatPose * pose)
{
  static const gdouble corners[4][2] =
      { {0, 0}, {WIDTH_M, 0}, {WIDTH_M, HEIGHT_M}, {0, HEIGHT_M} };
  gdouble worst = 0;

  for (guint k = 0; k < 4; k++) {
    gdouble X[3], truth[3];

    cloth_flat_place (pose, corners[k], X);
    surface (0, corners[k], truth);
    worst = MAX (worst, hypot (X[0] - truth[0], X[1] - truth[1]));
  }
  return worst;
}

static void
load (void)
{
  ClothNpyInfo info;

  pool = cloth_pool_new (0);
  vertices = load_npy_floats (FOLDER "vertices.npy", &info, NULL);
  g_assert_nonnull (vertices);
  for (guint i = first_film; i < N_FILMS; i++) {
    footage[i].rig = cloth_rig_load (FOLDER "rig.json", NULL);
    g_assert_nonnull (footage[i].rig);
    for (guint c = 0; c < CAMERAS; c++) {
      g_autofree gchar *film = g_strdup_printf (FOLDER "%s/cam%u.mp4",
          films[i].folder, c);

      footage[i].luma[c] = test_luma_decode (film,
          footage[i].rig->cameras[c].width, footage[i].rig->cameras[c].height,
          FRAMES);
    }
  }
  cloth_pool_run_one_by_one (pool, describe, NULL, (N_FILMS -
          first_film) * CAMERAS * FRAMES);
}

/* Both ways find where the cloth lies. */
static void
test_start (void)
{
  for (guint i = first_film; i < N_FILMS; i++) {
    Footage *f = &footage[i];
    ClothFlatParams params = cloth_flat_default_params (WIDTH_M, HEIGHT_M);
    const ClothAnnealParams annealing = cloth_anneal_default_params ();
    const gdouble near[2] = { vertices[0], vertices[1] };
    g_autoptr (GError) error = NULL;
    ClothFlatView views[CAMERAS];
    ClothFlatPoses poses, annealed;
    guint8 *masks[CAMERAS];

    params.ground = GROUND;
    find_masks (f, masks);
    for (guint c = 0; c < CAMERAS; c++)
      views[c] = (ClothFlatView) {
      &f->rig->cameras[c], {
      masks[c], f->rig->cameras[c].width, f->rig->cameras[c].height,
            f->rig->cameras[c].width}
      };
    cloth_flat_find (&params, CAMERAS, views, near, &poses, &error);
    g_assert_no_error (error);
    cloth_anneal_find (&annealing, &params, CAMERAS, views, near, &annealed,
        &error);
    g_assert_no_error (error);
    g_test_message ("%s: corners are %.2f mm off, annealed %.2f mm (E %.4f)",
        films[i].print, 1e3 * measure_pose (&poses.poses[0]),
        1e3 * measure_pose (&annealed.poses[0]), annealed.poses[0].residual);
    g_assert_cmpuint (poses.n, ==, 2);
    g_assert_cmpfloat (measure_pose (&poses.poses[0]), <, 0.002);
    g_assert_cmpfloat (measure_pose (&annealed.poses[0]), <, 0.003);
    f->pose = poses.poses[0];
    for (guint c = 0; c < CAMERAS; c++)
      g_free (masks[c]);
  }
}

/* ---- trackers ---- */

static void
view (const Footage * f, guint frame, ClothTrackerView views[CAMERAS])
{
  for (guint c = 0; c < CAMERAS; c++) {
    const ClothCamera *camera = &f->rig->cameras[c];

    views[c] = (ClothTrackerView) { {
    f->luma[c] + (gsize) frame *camera->width * camera->height,
            camera->width, camera->height, camera->width}
     , f->kept[c][frame].features};
  }
}

/* Whether hidden points are counted, which takes long; before, hardly any is. */
static gboolean
is_searched (guint frame)
{
  for (guint i = 0; i < G_N_ELEMENTS (shown); i++)
    if (shown[i] == frame)
      return frame >= 20;
  return FALSE;
}

static void
count_markers (const ClothTracker * tracker, guint frame, Count * count)
{
  guint n;
  const ClothTrackedMarker *markers = cloth_tracker_get_markers (tracker, &n);

  for (guint i = 0; i < n; i++) {
    gdouble X[3], off[3];

    surface (frame, markers[i].uv, X);
    cloth_vec3_subtract (markers[i].position, X, off);
    count->off += cloth_vec3_length (off) > OFF;
  }
  count->points = n;
}

static void
count_features (const ClothTracker * tracker, const Footage * f, guint frame,
    Count * count)
{
  guint n;
  const ClothTrackedFeature *features =
      cloth_tracker_get_features (tracker, &n);

  for (guint i = 0; i < n; i++) {
    ClothRay ray;
    gdouble X[3];

    g_assert_true (cloth_marker_cast (&f->rig->cameras[features[i].camera],
            features[i].px, &ray));
    surface (frame, features[i].uv, X);
    count->off += find_distance (&ray, X) > OFF;
    if (is_searched (frame))
      count->hidden += is_hidden (frame, ray.origin, X);
  }
  count->points = n;
}

/* Features without (u, v) are cast on the true cloth of the frame before. */
static void
count_uvless (const ClothTracker * tracker, const Footage * f, guint frame,
    ClothCoverage * coverage, Count * count)
{
  g_autofree gdouble *now = g_new (gdouble, 3 * N);
  g_autofree gdouble *then = g_new (gdouble, 3 * N);
  guint n, drawn = G_MAXUINT;
  const ClothTrackedFeature *features =
      cloth_tracker_get_features (tracker, &n);

  if (frame == 0)
    return;
  for (guint i = 0; i < 3 * N; i++) {
    now[i] = vertices[(gsize) frame * 3 * N + i];
    then[i] = vertices[(gsize) (frame - 1) * 3 * N + i];
  }
  for (guint i = 0; i < n; i++) {
    const ClothCamera *camera = &f->rig->cameras[features[i].camera];
    gdouble X[3] = { 0 };
    ClothCast cast;

    if (features[i].camera != drawn) {
      cloth_coverage_draw (coverage, camera, then, NULL);
      drawn = features[i].camera;
    }
    if (!cloth_cast_feature (coverage, camera, then, features[i].before,
            features[i].px, &cast))
      continue;
    for (guint k = 0; k < 3; k++)
      cloth_vec3_add_scaled (X, cast.weight[k], now + 3 * cast.corner[k]);
    count->points++;
    count->off += find_distance (&cast.ray, X) > OFF;
  }
}

static ClothCoverage *
cover (void)
{
  guint32 faces[(ROWS - 1) * (COLUMNS - 1)][4];
  guint n = 0;

  for (guint j = 0; j < ROWS - 1; j++)
    for (guint i = 0; i < COLUMNS - 1; i++) {
      const guint32 a = j * COLUMNS + i;

      faces[n][0] = a;
      faces[n][1] = a + COLUMNS;
      faces[n][2] = a + COLUMNS + 1;
      faces[n++][3] = a + 1;
    }
  return cloth_coverage_new (N, faces[0], n);
}

/* Keeps the points of one picture. */
static void
keep_points (const ClothTracker * tracker, const Footage * f, GArray * to)
{
  const ClothCamera *camera = &f->rig->cameras[DRAWN_CAMERA];
  guint n;
  const ClothTrackedFeature *features =
      cloth_tracker_get_features (tracker, &n);

  for (guint i = 0; i < n; i++) {
    gdouble point[3] = { features[i].px[0], features[i].px[1], 0. }, X[3];
    ClothRay ray;

    if (features[i].camera != DRAWN_CAMERA)
      continue;
    g_assert_true (cloth_marker_cast (camera, features[i].px, &ray));
    surface (DRAWN_FRAME, features[i].uv, X);
    point[2] = find_distance (&ray, X) > OFF
        || is_hidden (DRAWN_FRAME, ray.origin, X);
    g_array_append_vals (to, point, 1);
  }
}

static void
track (guint film, guint run)
{
  const Footage *f = &footage[film];
  const ClothTrackerKind kind = run >= PLAIN ? CLOTH_TRACKER_LUCAS_KANADE :
      (ClothTrackerKind) run;
  ClothTrackerParams params = cloth_tracker_default_params ();
  g_autoptr (ClothTracker) tracker = NULL;
  g_autoptr (ClothCoverage) coverage = cover ();
  g_autoptr (GError) error = NULL;

  params.crests = run != PLAIN;
  if (run == BACK)
    params.crest = (ClothCrestParams) {
    0., INFINITY, INFINITY};
  tracker = cloth_tracker_new (kind, &params, CAMERAS, f->rig->cameras, &error);
  g_assert_no_error (error);
  for (guint frame = 0; frame < FRAMES; frame++) {
    Count *count = &counts[film][run][frame];
    ClothTrackerView views[CAMERAS];

    view (f, frame, views);
    if (frame == 0)
      cloth_tracker_start (tracker, &f->pose, views, &error);
    else
      cloth_tracker_run (tracker, views, &error);
    g_assert_no_error (error);
    if (cloth_tracker_kind_is_3d (kind))
      count_markers (tracker, frame, count);
    else if (kind == CLOTH_TRACKER_UVLESS)
      count_uvless (tracker, f, frame, coverage, count);
    else
      count_features (tracker, f, frame, count);
    if (film == 0 && frame == DRAWN_FRAME && run != BACK
        && kind == CLOTH_TRACKER_LUCAS_KANADE)
      keep_points (tracker, f, drawn[run == PLAIN]);
  }
}

static const gchar *
get_name (guint run)
{
  return run == BACK ? "lucas-kanade, way back only" : run == PLAIN ?
      "lucas-kanade, no crest test" :
      cloth_tracker_kind_to_string ((ClothTrackerKind) run);
}

/* The share of all points from frame 1 on that are off. */
static gdouble
share_off (guint film, guint run)
{
  guint n = 0, off = 0;

  for (guint frame = 1; frame < FRAMES; frame++) {
    n += counts[film][run][frame].points;
    off += counts[film][run][frame].off;
  }
  return n ? (gdouble) off / n : 0.;
}

/* Points a frame that are not off, from frame 1 on. */
static gdouble
mean_right (guint film, guint run)
{
  gdouble sum = 0.;

  for (guint frame = 1; frame < FRAMES; frame++)
    sum += counts[film][run][frame].points - counts[film][run][frame].off;
  return sum / (FRAMES - 1);
}

static void
tell (guint film, guint run)
{
  g_autoptr (GString) line = g_string_new (NULL);

  for (guint i = 0; i < G_N_ELEMENTS (shown); i++) {
    const Count *c = &counts[film][run][shown[i]];

    g_string_append_printf (line, " %4u", c->points);
    g_string_append_printf (line, c->points ? " (%3.0f%% off, %2.0f%% hidden)" :
        "                      ", 100. * c->off / MAX (c->points, 1),
        100. * c->hidden / MAX (c->points, 1));
  }
  g_test_message ("%-8s %-27s%s; %.1f%% off", films[film].print,
      get_name (run), line->str, 100. * share_off (film, run));
}

static void
track_some (gpointer data, guint begin, guint end, guint worker)
{
  for (guint i = begin; i < end; i++)
    track (first_film + i / N_RUNS, i % N_RUNS);
}

/* What holds of both prints, and what a motif that is repeated changes. */
static void
test_figures (void)
{
  cloth_pool_run_one_by_one (pool, track_some, NULL, (N_FILMS -
          first_film) * N_RUNS);
  for (guint i = first_film; i < N_FILMS; i++) {
    const Count *lucas = counts[i][CLOTH_TRACKER_LUCAS_KANADE];

    for (guint run = 0; run < N_RUNS; run++)
      tell (i, run);
    /* from frame to frame most markers are lost, and hardly any is wrong */
    g_assert_cmpfloat (mean_right (i, CLOTH_TRACKER_MULTI), >,
        1.5 * mean_right (i, CLOTH_TRACKER_FRAMES));
    g_assert_cmpfloat (share_off (i, CLOTH_TRACKER_FRAMES), <, 0.1);
    /* the last frames are better references than the first, where a motif is repeated */
    if (films[i].repeats)
      g_assert_cmpfloat (mean_right (i, CLOTH_TRACKER_MULTI), >,
          1.1 * mean_right (i, CLOTH_TRACKER_REFERENCE));
    else {
      g_assert_cmpfloat (share_off (i, CLOTH_TRACKER_MULTI), <, 0.05);
      g_assert_cmpfloat (share_off (i, CLOTH_TRACKER_REFERENCE), <, 0.05);
    }
    /* there are more features than markers, and flow keeps them best */
    g_assert_cmpfloat (mean_right (i, CLOTH_TRACKER_REFERENCE_2D), >,
        mean_right (i, CLOTH_TRACKER_MULTI));
    g_assert_cmpfloat (mean_right (i, CLOTH_TRACKER_LUCAS_KANADE), >,
        1.5 * mean_right (i, CLOTH_TRACKER_REFERENCE_2D));
    g_assert_cmpuint (lucas[FRAMES - 1].points, >, lucas[0].points / 5);
    /* crests: without the test points pile up */
    g_assert_cmpfloat (share_off (i, PLAIN), >, 0.1);
    g_assert_cmpfloat (share_off (i, CLOTH_TRACKER_LUCAS_KANADE), <,
        0.33 * share_off (i, PLAIN));
    g_assert_cmpfloat (share_off (i, CLOTH_TRACKER_LUCAS_KANADE), <,
        0.97 * share_off (i, BACK));
    g_assert_cmpfloat (share_off (i, CLOTH_TRACKER_UVLESS), <, 0.05);
  }
}

/* ---- pictures ---- */

static const guint32 colours[PLAIN + 1] =
    { 0x888888, 0xd07000, 0x1060c0, 0x888888,
  0x108040, 0xd07000, 0x8030a0, 0xc02020
};

static void
plot_points (cairo_t * cr, guint row, guint column, const gchar * what,
    guint first, guint last)
{
  g_autofree gchar *title = g_strdup_printf ("%s, print %s", what,
      films[row].print);
  Panel panel = panel_begin (cr, column, row, title, (FRAMES - 1) / FPS, 0.,
      column == 0 ? 1500. : 5000.);

  for (guint run = first; run <= last; run++) {
    gdouble values[FRAMES];

    for (guint frame = 0; frame < FRAMES; frame++)
      values[frame] = run == CLOTH_TRACKER_UVLESS && frame == 0 ? NAN :
          counts[row][run][frame].points;
    panel_line (&panel, values, 1, FRAMES, 1. / FPS, colours[run],
        run == PLAIN ? "no crest test" : get_name (run));
  }
}

static void
plot_off (cairo_t * cr, guint row)
{
  static const guint runs[4] = { CLOTH_TRACKER_MULTI,
    CLOTH_TRACKER_LUCAS_KANADE, CLOTH_TRACKER_UVLESS, PLAIN
  };
  Panel panel = panel_begin (cr, 2, row, "off the truth by > 5 mm, %",
      (FRAMES - 1) / FPS, 0., 125.);

  for (guint i = 0; i < 4; i++) {
    gdouble values[FRAMES];

    for (guint frame = 0; frame < FRAMES; frame++) {
      const Count *c = &counts[row][runs[i]][frame];

      values[frame] = c->points ? 100. * c->off / c->points : NAN;
    }
    panel_line (&panel, values, 1, FRAMES, 1. / FPS, colours[runs[i]],
        runs[i] == PLAIN ? "no crest test" : get_name (runs[i]));
  }
}

static void
write_picture (cairo_surface_t * surface, cairo_t * cr, const gchar * folder,
    const gchar * name)
{
  g_autofree gchar *path = g_build_filename (folder, name, NULL);

  g_assert_cmpint (cairo_surface_write_to_png (surface, path), ==,
      CAIRO_STATUS_SUCCESS);
  cairo_destroy (cr);
  cairo_surface_destroy (surface);
}

static cairo_t *
begin_picture (gint width, gint height, cairo_surface_t ** surface)
{
  cairo_t *cr;

  *surface = cairo_image_surface_create (CAIRO_FORMAT_RGB24, width, height);
  cr = cairo_create (*surface);
  cairo_set_source_rgb (cr, 1., 1., 1.);
  cairo_paint (cr);
  return cr;
}

/* Part of the film's picture, with the points that are where they seem and those that are not. */
static void
plot_crests (cairo_t * cr, guint side)
{
  const gint left = 150, top = 150, width = 300, height = 300;
  const ClothCamera *camera = &footage[0].rig->cameras[DRAWN_CAMERA];
  const guint8 *luma = footage[0].luma[DRAWN_CAMERA] +
      (gsize) DRAWN_FRAME * camera->width * camera->height;
  cairo_surface_t *part = cairo_image_surface_create (CAIRO_FORMAT_RGB24,
      width, height);
  guint8 *data = cairo_image_surface_get_data (part);

  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      /* in 16 steps, paler, so that points show and the file stays small */
      const guint32 grey = 96 + luma[(top + y) * camera->width + left +
          x] / 16 * 8;

      ((guint32 *) (data + y * cairo_image_surface_get_stride (part)))[x] =
          MIN (grey, 255) * 0x10101;
    }
  cairo_surface_mark_dirty (part);
  cairo_save (cr);
  /* left the plain run */
  cairo_translate (cr, 460. * (1. - side), 0.);
  cairo_rectangle (cr, 0., 0., 450., 450.);
  cairo_clip (cr);
  cairo_scale (cr, 1.5, 1.5);
  cairo_set_source_surface (cr, part, 0., 0.);
  cairo_paint (cr);
  for (guint pass = 0; pass < 2; pass++)
    for (guint i = 0; i < drawn[side]->len; i++) {
      const gdouble *point = (const gdouble *) drawn[side]->data + 3 * i;

      if (point[2] != pass)
        continue;
      cairo_set_source_rgb (cr, pass ? 0.85 : 0.05, pass ? 0.05 : 0.45,
          pass ? 0.05 : 0.2);
      cairo_arc (cr, point[0] - left + 0.5, point[1] - top + 0.5, 1.3, 0.,
          2. * G_PI);
      cairo_fill (cr);
    }
  cairo_restore (cr);
  cairo_surface_destroy (part);
}

static void
plot_all (const gchar * folder)
{
  cairo_surface_t *surface;
  cairo_t *cr = begin_picture (3 * (gint) PANEL_WIDTH,
      (gint) (N_FILMS * PANEL_HEIGHT), &surface);

  for (guint i = first_film; i < N_FILMS; i++) {
    plot_points (cr, i, 0, "markers", 0, CLOTH_TRACKER_MULTI);
    plot_points (cr, i, 1, "features", CLOTH_TRACKER_REFERENCE_2D, PLAIN);
    plot_off (cr, i);
  }
  write_picture (surface, cr, folder, "trackers.png");
  cr = begin_picture (910, 450, &surface);
  for (guint side = 0; side < 2; side++)
    plot_crests (cr, side);
  write_picture (surface, cr, folder, "crests.png");
}

int
main (int argc, char **argv)
{
  test_picture_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  for (guint i = 0; i < 2; i++)
    drawn[i] = g_array_new (FALSE, FALSE, 3 * sizeof (gdouble));
  if (g_test_slow () || argc == 3)
    first_film = 0;
  load ();
  if (argc == 3 && strcmp (argv[1], "--plot") == 0) {
    test_start ();
    test_figures ();
    plot_all (argv[2]);
    return 0;
  }
  g_test_add_func ("/trackers/start", test_start);
  g_test_add_func ("/trackers/figures", test_figures);
  return g_test_run ();
}
