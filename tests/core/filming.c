/* The renderer of filmed cloth, against closed forms: where corners, edges and areas fall,
 * what hides what, what lens, shutter, light and noise do.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/render.h"

#include <math.h>
#include <string.h>

#include "gst/pattern/texture.h"
#include "gst/vision/corner/saddle.h"
#include "tests/common/captureeffects.h"
#include "tests/common/picture.h"
#include "tests/reference/reference.h"

#define WIDTH 640
#define HEIGHT 480
#define BLACK 0.03f
#define WHITE 0.8f

/* Looks along +y from (0, −2, 0), z up: (x, y, z) is seen at f·(x, −z)/(y + 2). */
static const ClothCamera camera = { NULL, WIDTH, HEIGHT,
  {800, 0, 319.5, 0, 800, 239.5, 0, 0, 1}, CLOTH_LENS_NONE, {0},
  {1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0, 2}
};

/* A flat cloth: corner (0, 0) at @origin, u along @along, v along @down. */
typedef struct
{
  gdouble origin[3], along[3], down[3];
} Plane;

static const Plane upright = { {-0.5, 0, 0.4}, {1, 0, 0}, {0, 0, -1} };
static const Plane tilted = { {-0.5, -0.3, 0.35}, {0.93, 0.3, 0.05},
{-0.08, 0.25, -0.9}
};

static void
plane_at (const Plane * plane, gdouble u, gdouble v, gdouble X[3])
{
  for (gint k = 0; k < 3; k++)
    X[k] = plane->origin[k] + u * plane->along[k] + v * plane->down[k];
}

/* The test's own pinhole. */
static void
pinhole (const gdouble X[3], gdouble px[2])
{
  px[0] = 800 * X[0] / (X[1] + 2) + 319.5;
  px[1] = -800 * X[2] / (X[1] + 2) + 239.5;
}

typedef struct
{
  guint columns, rows;          /* of vertices */
  gfloat *uv;
  guint32 *faces;
  guint n_faces;
  gdouble *positions;
} Mesh;

static void mesh_free (Mesh * mesh);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (Mesh, mesh_free);

/* What is varied in a picture; zeros are the usual. */
typedef struct
{
  const ClothCamera *camera;
  const gchar *effects;
  const gdouble *velocity;      /* of all vertices */
  guint threads;
  ClothSimd simd;
  guint64 frame, seed;
  guint n_planes;
  gboolean two_sided;
  gfloat *light;                /* what the levels were made of, not rounded */
} Options;

/* @columns × @rows vertices over width × height metres of cloth. */
static Mesh *
mesh_new (const Plane * plane, guint columns, guint rows, gdouble width,
    gdouble height)
{
  Mesh *mesh = g_new0 (Mesh, 1);

  mesh->columns = columns;
  mesh->rows = rows;
  mesh->uv = g_new (gfloat, 2 * columns * rows);
  mesh->positions = g_new (gdouble, 3 * columns * rows);
  mesh->n_faces = (columns - 1) * (rows - 1);
  mesh->faces = g_new (guint32, 4 * mesh->n_faces);
  for (guint j = 0; j < rows; j++)
    for (guint i = 0; i < columns; i++) {
      const guint at = j * columns + i;

      mesh->uv[2 * at] = (gfloat) (width * i / (columns - 1));
      mesh->uv[2 * at + 1] = (gfloat) (height * j / (rows - 1));
      plane_at (plane, width * i / (columns - 1), height * j / (rows - 1),
          mesh->positions + 3 * at);
    }
  for (guint j = 0; j + 1 < rows; j++)
    for (guint i = 0; i + 1 < columns; i++) {
      guint32 *f = mesh->faces + 4 * (j * (columns - 1) + i);

      f[0] = j * columns + i;
      f[1] = f[0] + columns;
      f[2] = f[1] + 1;
      f[3] = f[0] + 1;
    }
  return mesh;
}

static void
mesh_free (Mesh * mesh)
{
  g_free (mesh->uv);
  g_free (mesh->faces);
  g_free (mesh->positions);
  g_free (mesh);
}

/* Cloth of light 1 before black, lit from everywhere: levels are what the paint says. */
static guint8 *
film (const Mesh * mesh, const ClothPaint * paint, const Options * options)
{
  const ClothCamera *c = options->camera ? options->camera : &camera;
  const guint n = mesh->columns * mesh->rows;
  g_autofree gdouble *later = g_memdup2 (mesh->positions,
      3 * n * sizeof (gdouble));
  const gdouble times[2] = { 1, 1.04 };
  const gdouble *const frames[2] = { mesh->positions, later };
  const ClothMotion motion = { n, options->velocity ? 2 : 1, times, frames };
  g_autoptr (ClothRenderer) renderer = cloth_renderer_new (n, mesh->uv,
      mesh->faces, mesh->n_faces, options->threads,
      options->threads ? options->simd : CLOTH_SIMD_BEST);
  const guint n_planes = MAX (options->n_planes, 1);
  const gsize size = (gsize) c->width * (gsize) c->height;
  guint8 *data = g_malloc (size * n_planes);
  guint8 *planes[3] = { data, data + (n_planes == 3 ? size : 0),
    data + (n_planes == 3 ? 2 * size : 0)
  };
  const gint strides[3] = { c->width, c->width, c->width };
  const ClothLight *light;
  ClothRenderStyle style;
  ClothCapture capture;
  GError *error = NULL;

  for (guint i = 0; options->velocity && i < 3 * n; i++)
    later[i] += 0.04 * options->velocity[i % 3];
  cloth_capture_init (&capture, c);
  cloth_capture_add_effects (&capture, options->effects, &error);
  g_assert_no_error (error);
  cloth_render_style_init (&style);
  style.ambient_light = 1;
  style.lamp_light = 0;
  style.background[0] = style.background[1] = 0;
  style.two_sided = options->two_sided;
  light =
      cloth_renderer_draw (renderer, paint, &capture, &style, &motion, 1, NULL);
  cloth_renderer_develop (renderer, &capture, options->frame, options->seed,
      n_planes, planes, strides, 1, NULL);
  if (options->light)
    memcpy (options->light, light->data, size * sizeof (gfloat));
  return data;
}

static ClothPaint *
plain_paint (guint8 level)
{
  const gdouble origin[2] = { 0, 0 }, size[2] = { 1, 1 };

  return cloth_paint_new (&level, 1, 1, 1, 1, NULL, origin, size);
}

static ClothPaint *
board_paint (const ClothPattern * pattern, gdouble px_per_m)
{
  g_autoptr (ClothTexture) texture = cloth_pattern_texture (pattern, px_per_m,
      0, 255, NULL);
  const gdouble origin[2] = { 0, 0 };
  const gdouble size[2] = { texture->width / px_per_m,
    texture->height / px_per_m
  };
  gfloat light[256];

  for (gint i = 0; i < 256; i++)
    light[i] = BLACK + (WHITE - BLACK) * (gfloat) i / 255;
  return cloth_paint_new (texture->data, texture->width, texture->height,
      texture->width, 1, light, origin, size);
}

/* ---- corners ---- */

typedef void (*Truth) (const gdouble X[3], gdouble px[2]);

/* Errors of the board's inner corners in a picture: RMS an axis, mean, worst. */
typedef struct
{
  guint n;
  gdouble rms, mean[2], worst;
} Errors;

static void
error_add (Errors * e, gdouble dx, gdouble dy)
{
  e->n++;
  e->rms += dx * dx + dy * dy;
  e->mean[0] += dx;
  e->mean[1] += dy;
  e->worst = MAX (e->worst, hypot (dx, dy));
}

static void
error_end (Errors * e, const gchar * what)
{
  e->rms = sqrt (e->rms / (2 * MAX (e->n, 1)));
  e->mean[0] /= MAX (e->n, 1);
  e->mean[1] /= MAX (e->n, 1);
  g_test_message ("%s: %u corners, RMS %.4f px an axis, mean %+.4f %+.4f, "
      "worst %.4f", what, e->n, e->rms, e->mean[0], e->mean[1], e->worst);
}

static void
check_corners (const gchar * what, const guint8 * data, const Plane * plane,
    const ClothPattern * pattern, Truth truth, ClothSaddleRefine refine)
{
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  ClothSaddleParams params = cloth_saddle_default_params ();
  const ClothImage image = { data, WIDTH, HEIGHT, WIDTH };
  const ClothSaddle *saddles;
  Errors ours = { 0 }, theirs = { 0 };
  guint n;

  params.refine = refine;
  params.radius = 6;
  cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  saddles = cloth_saddle_detector_get_saddles (detector, &n);
  for (gint row = 1; row < pattern->rows; row++) {
    for (gint column = 1; column < pattern->columns; column++) {
      gdouble X[3], px[2], near = 2;
      gfloat xy[2];
      gint best = -1;

      plane_at (plane, pattern->origin_uv_m[0] + column * pattern->square_m,
          pattern->origin_uv_m[1] + row * pattern->square_m, X);
      truth (X, px);
      if (px[0] < 10 || px[1] < 10 || px[0] > WIDTH - 11 || px[1] > HEIGHT - 11)
        continue;
      for (guint i = 0; i < n; i++) {
        const gdouble d = hypot (saddles[i].x - px[0], saddles[i].y - px[1]);

        if (d < near) {
          near = d;
          best = (gint) i;
        }
      }
      g_assert_cmpint (best, >=, 0);
      error_add (&ours, saddles[best].x - px[0], saddles[best].y - px[1]);
      xy[0] = (gfloat) floor (px[0] + 0.5);
      xy[1] = (gfloat) floor (px[1] + 0.5);
      g_assert_true (cloth_cv_corner_sub_pix (data, WIDTH, HEIGHT, WIDTH, 5, xy,
              1));
      error_add (&theirs, xy[0] - px[0], xy[1] - px[1]);
    }
  }
  error_end (&ours, what);
  g_assert_cmpuint (ours.n, >, 20);
  g_assert_cmpfloat (ours.rms, <, 0.02);
  g_assert_cmpfloat (hypot (ours.mean[0], ours.mean[1]), <, 0.01);
  error_end (&theirs, "  cornerSubPix");
  g_assert_cmpfloat (theirs.rms, <, 0.05);
  g_assert_cmpfloat (hypot (theirs.mean[0], theirs.mean[1]), <, 0.02);
}

static void
test_corners (void)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (12, 9, 0.0773, 0.03, TRUE, NULL);
  g_autoptr (ClothPaint) paint = board_paint (pattern, 3000);
  static const struct
  {
    const gchar *name;
    const Plane *plane;
    guint columns, rows;
  } cases[] = {
    {"upright, one face", &upright, 2, 2},
    {"tilted, one face", &tilted, 2, 2},
    {"tilted, 33 × 35 vertices", &tilted, 33, 35}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (Mesh) mesh = mesh_new (cases[i].plane, cases[i].columns,
        cases[i].rows, pattern->cloth_m[0], pattern->cloth_m[1]);
    const Options options = { NULL, "defocus,sigma=0.7" };
    g_autofree guint8 *data = film (mesh, paint, &options);
    g_autofree gchar *name = g_strdup_printf ("corners%u.pgm", i);

    test_picture_keep (name, data, WIDTH, HEIGHT);
    check_corners (cases[i].name, data, cases[i].plane, pattern, pinhole,
        CLOTH_SADDLE_REFINE_MODEL);
    check_corners ("by Newton's method", data, cases[i].plane, pattern,
        pinhole, CLOTH_SADDLE_REFINE_STREAM);
    /* Without the transfer curve: what is left then is the finders' own. */
    for (gint k = 0; k < WIDTH * HEIGHT; k++)
      data[k] = (guint8) (255 * cloth_light_from_level (data[k]) + 0.5f);
    check_corners ("in linear light", data, cases[i].plane, pattern, pinhole,
        CLOTH_SADDLE_REFINE_MODEL);
  }
}

/* Across an edge the sum of the light in a row of pixels tells where the edge is: owed to
 * no detector. */
static void
test_edges (void)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (12, 9, 0.0773, 0.03, TRUE, NULL);
  g_autoptr (ClothPaint) paint = board_paint (pattern, 3000);
  static const Plane *const planes[] = { &upright, &tilted };

  for (guint i = 0; i < G_N_ELEMENTS (planes); i++) {
    g_autoptr (Mesh) mesh = mesh_new (planes[i], 2, 2, pattern->cloth_m[0],
        pattern->cloth_m[1]);
    const Options options = { NULL };
    g_autofree guint8 *data = film (mesh, paint, &options);
    Errors errors = { 0 };

    for (gint row = 0; row < 9; row++) {
      for (gint column = 1; column < 12; column++) {
        const gdouble u = 0.03 + 0.0773 * column, v = 0.03 + 0.0773 * row;
        gdouble X[3], px[2][2], side[2], at, sum = 0;
        gint y, first;

        for (gint k = 0; k < 2; k++) {
          plane_at (planes[i], u, v + (0.4 + 0.2 * k) * 0.0773, X);
          pinhole (X, px[k]);
        }
        y = (gint) floor ((px[0][1] + px[1][1]) / 2 + 0.5);
        /* where the edge crosses this row of pixels */
        at = px[0][0] + (y - px[0][1]) * (px[1][0] - px[0][0])
            / (px[1][1] - px[0][1]);
        first = (gint) floor (at + 0.5) - 8;
        if (first < 0 || first + 17 > WIDTH || y < 0 || y >= HEIGHT)
          continue;
        /* between the levels on both sides, rounded as they are */
        for (gint k = 0; k < 2; k++)
          side[k] = cloth_light_from_level (data[y * WIDTH + first + 16 * k]);
        for (gint k = 0; k < 17; k++)
          sum += (cloth_light_from_level (data[y * WIDTH + first + k])
              - side[1]) / (side[0] - side[1]);
        error_add (&errors, first - 0.5 + sum - at, 0);
      }
    }
    error_end (&errors, i ? "edges, tilted" : "edges, upright");
    g_assert_cmpuint (errors.n, >, 60);
    g_assert_cmpfloat (errors.worst, <, 0.02);
  }
}

/* Barrel distortion of 30 px in the corners, on one face: it must be cut. */
static void
barrel (const gdouble X[3], gdouble px[2])
{
  const gdouble x = X[0] / (X[1] + 2), y = -X[2] / (X[1] + 2);
  const gdouble r2 = x * x + y * y, bend = 1 - 0.3 * r2 + 0.08 * r2 * r2;

  px[0] = 800 * x * bend + 319.5;
  px[1] = 800 * y * bend + 239.5;
}

static void
test_lens (void)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (14, 10, 0.0773, 0.03, TRUE, NULL);
  g_autoptr (ClothPaint) paint = board_paint (pattern, 3000);
  g_autoptr (Mesh) mesh = mesh_new (&tilted, 2, 2, pattern->cloth_m[0],
      pattern->cloth_m[1]);
  const Options options = { NULL, "lens_distortion,k1=-0.3,k2=0.08; "
        "defocus,sigma=0.7"
  };
  g_autofree guint8 *data = film (mesh, paint, &options);

  test_picture_keep ("lens.pgm", data, WIDTH, HEIGHT);
  check_corners ("barrel", data, &tilted, pattern, barrel,
      CLOTH_SADDLE_REFINE_STREAM);
}

/* ---- areas ---- */

static gdouble
sum_of (const guint8 * data)
{
  gdouble sum = 0;

  for (gint k = 0; k < WIDTH * HEIGHT; k++)
    sum += cloth_light_from_level (data[k]);
  return sum;
}

/* The light of a white triangle is its area in the picture, from either side. */
static void
test_area (void)
{
  g_autoptr (ClothPaint) white = plain_paint (255);
  const gfloat uv[6] = { 0, 0, 1, 0, 0, 1 };
  const guint32 face[4] = { 0, 1, 2, 0xffffffff };
  gdouble worst = 0, square = 0;

  for (gint i = 0; i < 24; i++) {
    gdouble positions[9], px[3][2], area, found;
    g_autofree guint8 *data = NULL;
    guint8 full = 0;
    Mesh mesh = { 3, 1, (gfloat *) uv, (guint32 *) face, 1, positions };
    const Options options = { NULL };

    for (gint k = 0; k < 3; k++) {
      const gdouble angle = 2.1 * k + 0.37 * i;

      positions[3 * k] = 0.013 * i - 0.1 + 0.3 * cos (angle);
      positions[3 * k + 1] = 0.1 * k;
      positions[3 * k + 2] = 0.25 * sin (angle + 0.1 * k);
      pinhole (positions + 3 * k, px[k]);
    }
    area = fabs ((px[1][0] - px[0][0]) * (px[2][1] - px[0][1])
        - (px[1][1] - px[0][1]) * (px[2][0] - px[0][0])) / 2;
    if (i % 2) {
      /* seen from its other side */
      for (gint k = 0; k < 3; k++) {
        const gdouble kept = positions[k];

        positions[k] = positions[3 + k];
        positions[3 + k] = kept;
      }
    }
    data = film (&mesh, white, &options);
    for (gint k = 0; k < WIDTH * HEIGHT; k++)
      full = MAX (full, data[k]);
    g_assert_cmpint (full, ==, i % 2 ? 218 : 255);
    found = sum_of (data) / cloth_light_from_level (full);
    worst = MAX (worst, fabs (found - area));
    square += pow (found - area, 2) / 24;
  }
  g_test_message ("areas of 14,000 px²: RMS error %.2f px², worst %.2f",
      sqrt (square), worst);
  /* Sixteen points a pixel: an edge of 200 px that runs along a column of them is off by
   * 1/32 px at worst. */
  g_assert_cmpfloat (worst, <, 200 / 32.0);
  g_assert_cmpfloat (sqrt (square), <, 1.5);
}

/* White on white over a mesh of many faces: no seam between them. */
static void
test_no_gaps (void)
{
  g_autoptr (ClothPaint) white = plain_paint (255);
  g_autoptr (Mesh) mesh = mesh_new (&tilted, 41, 37, 2, 2);
  const Options options = { NULL, "lens_distortion,k1=-0.1" };
  g_autofree guint8 *data = NULL;
  gint dark = 0;

  for (guint i = 0; i < 41 * 37; i++) {
    mesh->positions[3 * i] -= 0.4;
    mesh->positions[3 * i + 2] += 0.5;
    mesh->positions[3 * i + 1] += 0.004 * sin (i * 12.9898);
  }
  data = film (mesh, white, &options);
  test_picture_keep ("gaps.pgm", data, WIDTH, HEIGHT);
  for (gint y = 0; y < HEIGHT - 5; y++)
    for (gint x = 0; x < 540; x++)
      dark += data[y * WIDTH + x] != 255;
  g_assert_cmpint (dark, ==, 0);
}

/* ---- what hides what ---- */

/* Two sheets that cross along a vertical line, in both orders of the faces: what is
 * nearer is seen, left of the line the one, right of it the other. */
static void
test_occlusion (void)
{
  const guint8 greys[2] = { 60, 220 };
  const gdouble origin[2] = { 0, 0 }, size[2] = { 2, 1 };
  g_autoptr (ClothPaint) paint =
      cloth_paint_new (greys, 2, 1, 2, 1, NULL, origin, size);
  /* u 0.1 … 0.4 is dark, u 1.6 … 1.9 bright */
  const gfloat uv[16] = { 0.1f, 0, 0.1f, 1, 0.4f, 1, 0.4f, 0,
    1.6f, 0, 1.6f, 1, 1.9f, 1, 1.9f, 0
  };
  const gdouble positions[24] = {
    -0.4, -0.1, 0.3, -0.4, -0.1, -0.3, 0.4, 0.1, -0.3, 0.4, 0.1, 0.3,
    -0.4, 0.1, 0.3, -0.4, 0.1, -0.3, 0.4, -0.1, -0.3, 0.4, -0.1, 0.3
  };

  for (gint order = 0; order < 2; order++) {
    const guint32 faces[2][8] = { {0, 1, 2, 3, 4, 5, 6, 7},
    {4, 5, 6, 7, 0, 1, 2, 3}
    };
    Mesh mesh = { 8, 1, (gfloat *) uv, (guint32 *) faces[order], 2,
      (gdouble *) positions
    };
    const Options options = { NULL };
    g_autofree guint8 *data = film (&mesh, paint, &options);

    test_picture_keep ("crossing.pgm", data, WIDTH, HEIGHT);
    for (gint y = 130; y < 350; y++) {
      for (gint x = 170; x < 470; x++) {
        if (x < 319)
          g_assert_cmpint (data[y * WIDTH + x], ==, 60);
        else if (x > 320)
          g_assert_cmpint (data[y * WIDTH + x], ==, 220);
      }
    }
  }
}

/* A print on both sides: from behind the film is that of the front in a mirror, here one whose
 * plane is the picture's middle column. The board is not its own mirror image. */
static void
test_two_sided (void)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (7, 8, 0.05, 0.025, TRUE, NULL);
  g_autoptr (ClothPaint) paint = board_paint (pattern, 2000);
  const Plane behind = { {0.2, 0, 0.225}, {-1, 0, 0}, {0, 0, -1} };
  const Plane front = { {-0.2, 0, 0.225}, {1, 0, 0}, {0, 0, -1} };
  const Options one = { NULL }, both = {.two_sided = TRUE };
  g_autoptr (Mesh) turned = mesh_new (&behind, 10, 10, 0.4, 0.45);
  g_autoptr (Mesh) straight = mesh_new (&front, 10, 10, 0.4, 0.45);
  g_autofree guint8 *back = film (turned, paint, &both);
  g_autofree guint8 *from_front = film (straight, paint, &one);
  const gint twice = (gint) lrint (2 * camera.K[2]);
  guint n_dark = 0;

  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = MAX (0, twice - WIDTH + 1); x < MIN (WIDTH, twice + 1); x++) {
      const gint level = from_front[y * WIDTH + twice - x];

      g_assert_cmpint (ABS (back[y * WIDTH + x] - level), <=, 3);
      n_dark += back[y * WIDTH + x] < 100 && x > 240 && x < 400 && y > 160
          && y < 320;
    }
  g_assert_cmpuint (n_dark, >, 160 * 160 / 3);
}

/* Seen from behind there is no print; unknown vertices and what is behind the camera are
 * not drawn, nor do they harm. */
static void
test_back_and_unknown (void)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (8, 8, 0.05, 0.025, TRUE, NULL);
  g_autoptr (ClothPaint) paint = board_paint (pattern, 2000);
  const Plane behind = { {0.225, 0, 0.225}, {-1, 0, 0}, {0, 0, -1} };
  const Plane front = { {-0.225, 0, 0.225}, {1, 0, 0}, {0, 0, -1} };
  const Options options = { NULL };
  g_autoptr (Mesh) turned = mesh_new (&behind, 10, 10, 0.45, 0.45);
  g_autoptr (Mesh) holed = mesh_new (&front, 10, 10, 0.45, 0.45);
  g_autofree guint8 *back = film (turned, paint, &options);
  g_autofree guint8 *hole = NULL;

  for (gint y = 160; y < 320; y++)
    for (gint x = 240; x < 400; x++)
      g_assert_cmpint (ABS (back[y * WIDTH + x] - 218), <=, 1);
  holed->positions[3 * 44] = NAN;
  holed->positions[3 * 77 + 1] = -2.5;
  hole = film (holed, paint, &options);
  test_picture_keep ("hole.pgm", hole, WIDTH, HEIGHT);
  /* vertex 44 is at column 4, row 4; 20 px a cell */
  g_assert_cmpint (hole[229 * WIDTH + 309], ==, 0);
  g_assert_cmpint (hole[169 * WIDTH + 249], >, 0);
}

/* ---- time ---- */

/* Mean place of the light, px. */
static void
middle_of_light (const gfloat * data, gdouble middle[2], gdouble spread[2])
{
  gdouble sum = 0, first[2] = { 0, 0 }, second[2] = { 0, 0 };

  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      const gdouble light = data[y * WIDTH + x];

      sum += light;
      first[0] += light * x;
      first[1] += light * y;
      second[0] += light * x * x;
      second[1] += light * y * y;
    }
  for (gint k = 0; k < 2; k++) {
    middle[k] = first[k] / sum;
    spread[k] = second[k] / sum - middle[k] * middle[k];
  }
}

static void
middle_of (const guint8 * data, gdouble middle[2], gdouble spread[2])
{
  g_autofree gfloat *light = g_new (gfloat, WIDTH * HEIGHT);

  for (gint k = 0; k < WIDTH * HEIGHT; k++)
    light[k] = cloth_light_from_level (data[k]);
  middle_of_light (light, middle, spread);
}

/* A white square of 80 px, upright at depth 2. */
static Mesh *
square (void)
{
  const Plane plane = { {-0.1, 0, 0.1}, {1, 0, 0}, {0, 0, -1} };

  return mesh_new (&plane, 3, 3, 0.2, 0.2);
}

static void
test_shutter (void)
{
  g_autoptr (ClothPaint) white = plain_paint (255);
  g_autoptr (Mesh) mesh = square ();
  /* 400 px/s to the right, 200 px/s down */
  const gdouble velocity[3] = { 1, 0, -0.5 }, still[3] = { 0, 0, 0 };
  const Options at_rest = { NULL, "motion_blur,exposure=0.03; "
        "rolling_shutter,seconds=0.02; sync_offset,seconds=0.1", still
  };
  const Options plain = { NULL, NULL, velocity };
  const Options blur = { NULL, "motion_blur,exposure=0.03", velocity };
  const Options rolling = { NULL, "rolling_shutter,seconds=0.02", velocity };
  const Options late = { NULL, "sync_offset,seconds=0.05", velocity };
  g_autofree guint8 *a = film (mesh, white, &plain);
  g_autofree guint8 *b = film (mesh, white, &blur);
  g_autofree guint8 *c = film (mesh, white, &rolling);
  g_autofree guint8 *d = film (mesh, white, &late);
  g_autofree guint8 *e = film (mesh, white, &at_rest);
  gdouble m[2], s[2], n[2], t[2];

  g_assert_cmpmem (a, WIDTH * HEIGHT, e, WIDTH * HEIGHT);
  middle_of (a, m, s);
  g_assert_cmpfloat_with_epsilon (m[0], 319.5, 0.002);
  g_assert_cmpfloat_with_epsilon (m[1], 239.5, 0.002);
  g_assert_cmpfloat_with_epsilon (s[0], 80 * 80 / 12.0, 0.5);

  /* The middle moves on for half the exposure; a streak's variance is e²v²/12.
   * The square at rest ends on borders of pixels: its sum over their centres lacks 1/12,
   * where the streak's has 1/12 too much. */
  test_picture_keep ("streak.pgm", b, WIDTH, HEIGHT);
  middle_of (b, n, t);
  g_test_message ("streak: middle %+.4f %+.4f, variance %+.4f %+.4f",
      n[0] - m[0], n[1] - m[1], t[0] - s[0], t[1] - s[1]);
  g_assert_cmpfloat_with_epsilon (n[0] - m[0], 6, 0.01);
  g_assert_cmpfloat_with_epsilon (n[1] - m[1], 3, 0.01);
  g_assert_cmpfloat_with_epsilon (t[0] - s[0], 12 + 1 / 6.0, 0.1);
  g_assert_cmpfloat_with_epsilon (t[1] - s[1], 3 + 1 / 6.0, 0.1);

  /* Row y is read 0.02·y/479 s later: the square leans, its rows move on. A row that was
   * y0 is seen at y = y0/(1 − 200·0.02/479). */
  test_picture_keep ("leaning.pgm", c, WIDTH, HEIGHT);
  middle_of (c, n, t);
  {
    const gdouble stretch = 1 / (1 - 200 * 0.02 / 479);
    const gdouble y = 239.5 * stretch;
    gdouble top[2] = { 0, 0 }, bottom[2] = { 0, 0 };

    /* level edges: a sixteenth of a pixel, halved */
    g_assert_cmpfloat_with_epsilon (n[1], y, 1 / 32.0);
    g_assert_cmpfloat_with_epsilon (n[0], 319.5 + 400 * 0.02 * y / 479, 0.01);
    for (gint x = 0; x < WIDTH; x++) {
      const gdouble high = cloth_light_from_level (c[211 * WIDTH + x]);
      const gdouble low = cloth_light_from_level (c[271 * WIDTH + x]);

      top[0] += high;
      top[1] += high * x;
      bottom[0] += low;
      bottom[1] += low * x;
    }
    g_assert_cmpfloat_with_epsilon (bottom[1] / bottom[0] - top[1] / top[0],
        400 * 0.02 * 60 / 479, 0.01);
  }

  middle_of (d, n, t);
  g_assert_cmpfloat_with_epsilon (n[0] - m[0], -20, 0.01);
  g_assert_cmpfloat_with_epsilon (n[1] - m[1], -10, 0.01);
}

/* ---- light ---- */

static void
test_defocus (void)
{
  g_autoptr (ClothPaint) white = plain_paint (255);
  g_autoptr (Mesh) mesh = square ();
  static const gdouble sigmas[] = { 0.15, 0.4, 1, 3.7 };
  g_autofree gfloat *light = g_new (gfloat, WIDTH * HEIGHT);
  const Options plain = {.light = light };
  gdouble m[2], s[2], n[2], t[2];

  g_free (film (mesh, white, &plain));
  middle_of_light (light, m, s);
  for (guint i = 0; i < G_N_ELEMENTS (sigmas); i++) {
    g_autofree gchar *effects = g_strdup_printf ("defocus,sigma=%g",
        sigmas[i]);
    const Options options = {.effects = effects,.light = light };

    g_free (film (mesh, white, &options));
    middle_of_light (light, n, t);
    g_assert_cmpfloat_with_epsilon (n[0], m[0], 1e-4);
    g_assert_cmpfloat_with_epsilon (n[1], m[1], 1e-4);
    g_assert_cmpfloat_with_epsilon (t[0] - s[0], sigmas[i] * sigmas[i],
        0.002 + 0.002 * sigmas[i] * sigmas[i]);
    g_assert_cmpfloat_with_epsilon (t[1] - s[1], sigmas[i] * sigmas[i],
        0.002 + 0.002 * sigmas[i] * sigmas[i]);
  }
}

/* A disc's middle moves by g·r²/4: what is foretold of points is what is drawn. */
static void
test_shading_shift (void)
{
  guint8 *disc = g_malloc0 (400 * 400);
  const gdouble origin[2] = { 0, 0 }, size[2] = { 0.2, 0.2 };
  /* 80 px are the square, the disc has 0.8 of it: r = 32 px. It is half bright, so that
   * nothing is cut off above. */
  const Options plain = { NULL };
  const Options shaded = { NULL, "shading_shift,x=0.004,y=-0.002" };
  g_autoptr (Mesh) mesh = square ();
  g_autoptr (ClothPaint) paint = NULL;
  g_autofree guint8 *a = NULL, *b = NULL;
  gdouble m[2], s[2], n[2], t[2];

  for (gint y = 0; y < 400; y++)
    for (gint x = 0; x < 400; x++)
      if (hypot (x - 199.5, y - 199.5) < 160)
        disc[400 * y + x] = 188;
  paint = cloth_paint_new (disc, 400, 400, 400, 1, NULL, origin, size);
  g_free (disc);
  a = film (mesh, paint, &plain);
  b = film (mesh, paint, &shaded);
  test_picture_keep ("disc.pgm", b, WIDTH, HEIGHT);
  middle_of (a, m, s);
  middle_of (b, n, t);
  g_test_message ("shift %+.4f %+.4f", n[0] - m[0], n[1] - m[1]);
  g_assert_cmpfloat_with_epsilon (n[0] - m[0], 0.004 * 32 * 32 / 4, 0.01);
  g_assert_cmpfloat_with_epsilon (n[1] - m[1], -0.002 * 32 * 32 / 4, 0.01);
}

static void
test_crosstalk (void)
{
  const guint8 red[3] = { 255, 0, 0 };
  const gdouble origin[2] = { 0, 0 }, size[2] = { 1, 1 };
  g_autoptr (ClothPaint) paint = cloth_paint_new (red, 1, 1, 3, 3, NULL, origin,
      size);
  g_autoptr (Mesh) mesh = square ();
  const Options pure = {.n_planes = 3 };
  const Options mixed = {.effects = "colour_crosstalk,share=0.3",.n_planes = 3
  };
  const Options grey = { NULL };
  g_autofree guint8 *a = film (mesh, paint, &pure);
  g_autofree guint8 *b = film (mesh, paint, &mixed);
  g_autofree guint8 *c = film (mesh, paint, &grey);
  const gsize at = 240 * WIDTH + 320, plane = WIDTH * HEIGHT;

  g_assert_cmpint (a[at], ==, 255);
  g_assert_cmpint (a[at + plane], ==, 0);
  g_assert_cmpfloat_with_epsilon (cloth_light_from_level (b[at]), 0.7, 0.005);
  g_assert_cmpfloat_with_epsilon (cloth_light_from_level (b[at + plane]),
      0.15, 0.005);
  g_assert_cmpint (b[at + 2 * plane], ==, b[at + plane]);
  g_assert_cmpint (c[at], ==, 76);      /* 0.299 · 255 */
}

static void
test_noise (void)
{
  static const struct
  {
    const gchar *effects;
    guint8 grey;
    gdouble sigma;
  } cases[] = {
    {"noise,sigma=3", 128, 3},
    {"noise,sigma=0.8", 200, 0.8},
    /* half the light: level 188 */
    {"noise,shot=4", 188, 2.8284},
    {"noise,sigma=2,shot=4", 188, 3.4641}
  };
  g_autoptr (Mesh) mesh = square ();

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (ClothPaint) paint = plain_paint (cases[i].grey);
    const Options options = { NULL, cases[i].effects,.frame = 3,.seed = 5 };
    const Options next = { NULL, cases[i].effects,.frame = 4,.seed = 5 };
    g_autofree guint8 *a = film (mesh, paint, &options);
    g_autofree guint8 *b = film (mesh, paint, &next);
    gdouble sum = 0, square = 0, with[3] = { 0, 0, 0 }, fourth = 0;
    gint n = 0;

    for (gint y = 202; y < 277; y++)
      for (gint x = 282; x < 357; x++, n++) {
        const gdouble d = a[y * WIDTH + x] - cases[i].grey;

        sum += d;
        square += d * d;
        fourth += d * d * d * d;
        with[0] += d * (a[y * WIDTH + x + 1] - cases[i].grey);
        with[1] += d * (a[(y + 1) * WIDTH + x] - cases[i].grey);
        with[2] += d * (b[y * WIDTH + x] - cases[i].grey);
      }
    square /= n;
    g_test_message ("%s: σ %.4f, kurtosis %.3f", cases[i].effects,
        sqrt (square), fourth / n / (square * square));
    /* five standard deviations; rounding adds 1/12 */
    g_assert_cmpfloat_with_epsilon (sum / n, 0,
        5 * cases[i].sigma / sqrt (n) + 0.01);
    g_assert_cmpfloat_with_epsilon (square, cases[i].sigma * cases[i].sigma
        + 1 / 12.0, 5 * square * sqrt (2.0 / n));
    g_assert_cmpfloat_with_epsilon (fourth / n / (square * square), 3, 0.35);
    for (gint k = 0; k < 3; k++)
      g_assert_cmpfloat_with_epsilon (with[k] / n / square, 0, 5 / sqrt (n));
  }
}

/* Lambert: a lamp that a cloth turns away from by an angle gives its cosine; behind it,
 * what comes through. */
static void
test_lambert (void)
{
  g_autoptr (ClothPaint) white = plain_paint (255);
  g_autoptr (Mesh) mesh = square ();
  const gdouble times[1] = { 0 };
  const gdouble *const frames[1] = { mesh->positions };
  const ClothMotion motion = { 9, 1, times, frames };
  g_autoptr (ClothRenderer) renderer = cloth_renderer_new (9, mesh->uv,
      mesh->faces, mesh->n_faces, 1, CLOTH_SIMD_BEST);
  ClothCapture capture;

  cloth_capture_init (&capture, &camera);
  for (gint angle = 0; angle <= 180; angle += 30) {
    const gdouble facing = cos (angle * G_PI / 180);
    ClothRenderStyle style;
    const ClothLight *light;

    cloth_render_style_init (&style);
    style.lamp[0] = 3 * sin (angle * G_PI / 180);
    style.lamp[1] = -3 * facing;
    style.lamp[2] = 0;
    light =
        cloth_renderer_draw (renderer, white, &capture, &style, &motion, 0,
        NULL);
    g_assert_cmpfloat_with_epsilon (light->data[240 * WIDTH + 320],
        0.35 + 0.6 * (facing > 0 ? facing : -0.3 * facing), 1e-5);
    g_assert_cmpfloat_with_epsilon (light->data[0], 0.14, 1e-5);
    g_assert_cmpfloat_with_epsilon (light->data[(HEIGHT - 1) * WIDTH], 0.09,
        1e-5);
  }
}

/* Two triangles of about the picture's area: too little for a hundredth of it, enough for
 * all of it; of a picture that nobody wants nothing is left. */
static void
test_work (void)
{
  g_autoptr (ClothPaint) white = plain_paint (255);
  g_autoptr (Mesh) mesh = square ();
  const gdouble times[1] = { 0 };
  const gdouble *const frames[1] = { mesh->positions };
  const ClothMotion motion = { 9, 1, times, frames };
  g_autoptr (ClothRenderer) renderer = cloth_renderer_new (9, mesh->uv,
      mesh->faces, mesh->n_faces, 2, CLOTH_SIMD_BEST);
  const gsize size = WIDTH * HEIGHT;
  g_autofree guint8 *data = g_malloc0 (size);
  g_autofree gfloat *light = NULL;
  guint8 *const planes[1] = { data };
  const gint strides[1] = { WIDTH };
  gint stop = 0;
  ClothWork little = { size / 100., &stop, FALSE };
  ClothWork enough = { 8. * size, &stop, FALSE };
  ClothRenderStyle style;
  ClothCapture capture;

  cloth_render_style_init (&style);
  cloth_capture_init (&capture, &camera);
  light = g_memdup2 (cloth_renderer_draw (renderer, white, &capture, &style,
          &motion, 0, NULL)->data, size * sizeof (gfloat));
  g_assert_null (cloth_renderer_draw (renderer, white, &capture, &style,
          &motion, 0, &little));
  g_assert_true (little.left_out);
  stop = 1;
  g_assert_null (cloth_renderer_draw (renderer, white, &capture, &style,
          &motion, 0, &enough));
  g_assert_false (enough.left_out);
  cloth_renderer_develop (renderer, &capture, 0, 0, 1, planes, strides, 1,
      &enough);
  for (gsize i = 0; i < size; i++)
    g_assert_cmpint (data[i], ==, 0);
  stop = 0;
  g_assert_cmpmem (cloth_renderer_draw (renderer, white, &capture, &style,
          &motion, 0, &enough)->data, size * sizeof (gfloat), light,
      size * sizeof (gfloat));
  g_assert_false (enough.left_out);
}

/* ---- sameness ---- */

/* Any number of threads and any instruction set: the same bytes. An effect at its null:
 * the same bytes as without it. */
static void
test_same_bytes (void)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (8, 8, 0.1, 0.05, TRUE, NULL);
  g_autoptr (ClothPaint) paint = board_paint (pattern, 1500);
  g_autoptr (Mesh) mesh = mesh_new (&tilted, 12, 9, 0.9, 0.9);
  const gdouble velocity[3] = { 0.4, 0.1, -0.3 };
  const gchar *all = "noise,sigma=2,shot=1; defocus,sigma=0.8; "
      "motion_blur,exposure=0.01; rolling_shutter,seconds=0.01; "
      "lens_distortion,k1=-0.1; shading_shift,x=0.0005; "
      "colour_crosstalk,share=0.1";
  const Options first = { NULL, all, velocity, 1, CLOTH_SIMD_SCALAR, 7, 3 };
  const Options without = { NULL, NULL, velocity };
  g_autofree guint8 *a = film (mesh, paint, &first);
  g_autofree guint8 *plain = film (mesh, paint, &without);
  const ClothEffect *effect;

  test_picture_keep ("everything.pgm", a, WIDTH, HEIGHT);
  for (guint threads = 1; threads <= 5; threads += 2)
    for (gint simd = CLOTH_SIMD_SCALAR; simd <= CLOTH_SIMD_AVX512; simd++) {
      const Options options = { NULL, all, velocity, threads,
        (ClothSimd) simd, 7, 3
      };
      g_autofree guint8 *b = film (mesh, paint, &options);

      g_assert_cmpmem (a, WIDTH * HEIGHT, b, WIDTH * HEIGHT);
    }
  for (guint i = 0; (effect = capture_effects[i]); i++) {
    g_autofree gchar *text = g_strdup_printf ("%s,%s=%g", effect->id,
        effect->parameters[0].name, effect->parameters[0].null_value);
    const Options options = { NULL, text, velocity };
    g_autofree guint8 *b = film (mesh, paint, &options);

    g_assert_cmpmem (plain, WIDTH * HEIGHT, b, WIDTH * HEIGHT);
  }
}

/* Sizes that fit no tile; a picture of one pixel. */
static void
test_odd_sizes (void)
{
  static const gint sizes[][2] = { {1, 1}, {33, 31}, {97, 1}, {1, 65} };
  g_autoptr (ClothPaint) white = plain_paint (255);
  g_autoptr (Mesh) mesh = mesh_new (&upright, 3, 3, 1, 0.8);

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    ClothCamera small = camera;
    const Options options = { &small, "defocus,sigma=2; "
          "rolling_shutter,seconds=0.01; noise,sigma=1",.threads = 2,
      .simd = CLOTH_SIMD_BEST
    };
    g_autofree guint8 *data = NULL;

    small.width = sizes[i][0];
    small.height = sizes[i][1];
    small.K[2] = (small.width - 1) / 2.0;
    small.K[5] = (small.height - 1) / 2.0;
    data = film (mesh, white, &options);
    for (gint k = 0; k < small.width * small.height; k++)
      g_assert_cmpint (data[k], >, 240);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/filming/work", test_work);
  g_test_add_func ("/filming/edges", test_edges);
  g_test_add_func ("/filming/corners", test_corners);
  g_test_add_func ("/filming/lens", test_lens);
  g_test_add_func ("/filming/area", test_area);
  g_test_add_func ("/filming/no-gaps", test_no_gaps);
  g_test_add_func ("/filming/occlusion", test_occlusion);
  g_test_add_func ("/filming/back-and-unknown", test_back_and_unknown);
  g_test_add_func ("/filming/two-sided", test_two_sided);
  g_test_add_func ("/filming/shutter", test_shutter);
  g_test_add_func ("/filming/defocus", test_defocus);
  g_test_add_func ("/filming/shading-shift", test_shading_shift);
  g_test_add_func ("/filming/crosstalk", test_crosstalk);
  g_test_add_func ("/filming/noise", test_noise);
  g_test_add_func ("/filming/lambert", test_lambert);
  g_test_add_func ("/filming/same-bytes", test_same_bytes);
  g_test_add_func ("/filming/odd-sizes", test_odd_sizes);
  return g_test_run ();
}
