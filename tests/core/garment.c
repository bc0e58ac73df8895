/* Garments from drawings: panels, dots, seams, and every way to draw them wrong.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/garment/garment.h"

#include <math.h>
#include <string.h>

#include "gst/math/delaunay-private.h"
#include "gst/math/delaunay.h"
#include "gst/math/random.h"
#include "gst/mesh/fill/fill.h"
#include "gst/mesh/formats/obj.h"
#include "gst/mesh/garment/svgpath.h"
#include "tests/core/meshpeer.h"

#define HEAD "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"400mm\" " \
    "height=\"400mm\" viewBox=\"0 0 400 400\">"
#define PANEL(id, edges) "<g id=\"" id "\" class=\"panel\">" edges "</g>"
#define EDGE(id, d) "<path id=\"" id "\" d=\"" d "\"/>"
#define SEWN(id, seam, d) "<path id=\"" id "\" data-seam=\"" seam "\" d=\"" d "\"/>"

static const ClothDotGrid grid = { 20, 20, 0.02, {0.01, 0.01}, {0.4, 0.4} };
static const ClothDotGrid paper = { 76, 251, 0.02, {0.01, 0.01}, {1.52, 5.02} };

/* ---- path data ---- */

static GArray *
parse (const gchar * d, GError ** error)
{
  GArray *points = g_array_new (FALSE, FALSE, sizeof (gdouble));

  if (!cloth_svg_path_parse (d, 1e-4, 5000, points, error))
    g_clear_pointer (&points, g_array_unref);
  return points;
}

static void
assert_same (const gchar * a, const gchar * b)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GArray) p = parse (a, &error);
  g_autoptr (GArray) q = NULL;

  g_assert_no_error (error);
  q = parse (b, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (p->len, ==, q->len);
  for (guint i = 0; i < p->len; i++)
    g_assert_cmpfloat_with_epsilon (g_array_index (p, gdouble, i),
        g_array_index (q, gdouble, i), 1e-9);
}

static void
test_path_commands (void)
{
  assert_same ("M1,2 L4,2 L4,6 L1,6 Z", "m1 2h3v4H1z");
  assert_same ("M1 2 3 4 5 6", "M1,2L3,4L5,6");
  assert_same ("m1 2 3 4 5 6", "M1,2 L4,6 L9,12");
  assert_same ("M.5.5-1-1", "M0.5,0.5 L-1,-1");
  assert_same ("M1e1,2E-1L3e+1 4", "M10,.2L30,4");
  assert_same ("M0,0C1,2 3,4 5,0S9,-4 10,0", "M0 0c1 2 3 4 5 0C7-4 9-4 10 0");
  assert_same ("M0,0Q5,5 10,0T20,0", "M0 0q5 5 10 0Q15-5 20 0");
  /* without a curve before, S and T have their control where the pen is */
  assert_same ("M0,0S3,4 5,0", "M0,0C0,0 3,4 5,0");
  assert_same ("M0,0T5,0", "M0,0Q0,0 5,0");
  /* flags need no spaces; radii that are too small grow; none is a line */
  assert_same ("M0,0A5 5 0 0110 0", "M0,0 A5,5 0 0,1 10,0");
  assert_same ("M0,0A1 1 0 0 1 10 0", "M0,0A5 5 0 0 1 10 0");
  assert_same ("M0,0A0 5 0 0 1 10 0", "M0,0L10,0");
}

static void
test_path_curves (void)
{
  /* three quarters of a circle of radius 10 about the origin, then home */
  g_autoptr (GArray) arc = parse ("M10,0A10,10 0 1 0 0,10", NULL);
  g_autoptr (GArray) turned = parse ("M10,0A10,20 90 0 1 0,5", NULL);
  g_autoptr (GArray) cubic = parse ("M0,0C0,1 1,2 3,3", NULL);
  gdouble length = 0, least = INFINITY;

  for (guint i = 0; i < arc->len; i += 2)
    g_assert_cmpfloat_with_epsilon (hypot (g_array_index (arc, gdouble, i),
            g_array_index (arc, gdouble, i + 1)), 10, 1e-9);
  for (guint i = 2; i < arc->len; i += 2)
    length += hypot (g_array_index (arc, gdouble, i) - g_array_index (arc,
            gdouble, i - 2), g_array_index (arc, gdouble, i + 1)
        - g_array_index (arc, gdouble, i - 1));
  g_assert_cmpfloat_with_epsilon (length, 15 * G_PI, 1e-3);
  g_assert_cmpuint (turned->len, >, 10);
  /* its middle: (3·0 + 3·1 + 3) / 8, (3·1 + 3·2 + 3) / 8 */
  for (guint i = 0; i < cubic->len; i += 2)
    least = fmin (least, hypot (g_array_index (cubic, gdouble, i) - 0.75,
            g_array_index (cubic, gdouble, i + 1) - 1.5));
  g_assert_cmpfloat (least, <, 0.2);
}

static void
test_path_errors (void)
{
  static const gchar *const bad[] = { "", "M", "M1", "M1,1", "L1,1 2,2",
    "M0,0 L1", "M0,0 L1,x", "M0,0 L1,1 M2,2 L3,3", "M0,0 L1,1 Z L2,2",
    "M0,0 A5 5 0 2 1 10 0", "M0,0 A5 5 0 0", "M0,0 B1,1", "M0,0 L1e9,0",
    "M0,0 L1e999,0", "M0,0 L-,0", "M0,0 L..5,0", "M0,0 Lnan,0", "M0,0 L0x5,0",
    "M9e6,0 l9e6,0", "M0,0 C1,1 2,2"
  };

  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (GArray) points = parse (bad[i], &error);

    g_assert_null (points);
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_true (g_str_has_prefix (error->message, "path data"));
  }
}

/* ---- triangles ---- */

/* Of a grid, whose every cell has four points on a circle; of a circle with its centre. */
static void
test_delaunay (void)
{
  gdouble points[2 * 30 * 20];
  g_autoptr (ClothDelaunay) delaunay = cloth_delaunay_new ();
  const guint *found;
  guint n_found;
  gdouble area = 0;

  for (guint i = 0; i < 30 * 20; i++) {
    points[2 * i] = 0.02 * (i % 30);
    points[2 * i + 1] = 0.02 * (i / 30);
  }
  found = cloth_delaunay_run (delaunay, 30 * 20, points, 0.02, &n_found);
  for (guint k = 0; k < n_found; k++) {
    const guint *t = found + 3 * k;
    const gdouble *a = points + 2 * t[0], *b = points + 2 * t[1];
    const gdouble *c = points + 2 * t[2];
    gdouble twice = (b[0] - a[0]) * (c[1] - a[1])
        - (b[1] - a[1]) * (c[0] - a[0]);

    g_assert_cmpfloat (twice, >, -1e-9);
    if (twice < 1e-6)
      continue;                 /* along a straight side */
    g_assert_cmpfloat_with_epsilon (twice, 0.0004, 1e-9);
    area += twice / 2;
  }
  g_assert_cmpfloat_with_epsilon (area, 29 * 19 * 0.0004, 1e-9);
  for (guint i = 0; i < 12; i++) {
    points[2 * i] = cos (i * G_PI / 6);
    points[2 * i + 1] = sin (i * G_PI / 6);
  }
  points[24] = points[25] = 0;
  cloth_delaunay_run (delaunay, 13, points, 0.5, &n_found);
  g_assert_cmpuint (n_found, ==, 12);
  cloth_delaunay_run (delaunay, 2, points, 0.5, &n_found);
  g_assert_cmpuint (n_found, ==, 0);
}

/* Circles that hold a point or lie left of it, at each level. */
static void
test_circles (void)
{
  enum
  { N = 37, ROOM = N + CLOTH_DELAUNAY_LANES };
  gdouble x[ROOM], y[ROOM], square[ROOM];
  const ClothDelaunayCircles circles = { x, y, square };
  ClothRandom random;

  cloth_random_init (&random, 7);
  for (guint round = 0; round < 100; round++) {
    for (guint i = 0; i < ROOM; i++) {
      x[i] = i < N ? cloth_random_uniform (&random) : INFINITY;
      y[i] = i < N ? cloth_random_uniform (&random) : 0;
      square[i] = i < N ? 0.01 * cloth_random_uniform (&random) : 0;
    }
    for (gint level = CLOTH_SIMD_SCALAR; level <= CLOTH_SIMD_AVX512; level++) {
      const ClothDelaunayKernel *kernel =
          CLOTH_SIMD_TABLE (cloth_delaunay_kernel, (ClothSimd) level);

      for (guint from = 0; from < N; from++) {
        guint expected = from;

        while (expected < N && !(hypot (0.3 - x[expected], 0.5 - y[expected])
                < sqrt (square[expected]))
            && !(0.3 - x[expected] > sqrt (square[expected])))
          expected++;
        g_assert_cmpuint (kernel->find (&circles, from, N, 0.3, 0.5), ==,
            expected);
        g_assert_cmpuint (kernel->find (&circles, from, N, NAN, 0.5), ==, N);
      }
      g_assert_cmpuint (kernel->find (&circles, N, N, 2, 2), ==, N);
    }
  }
}

/* ---- panels ---- */

static ClothGarment *
build (const gchar * svg, const ClothDotGrid * dots, GError ** error)
{
  return cloth_garment_new_from_svg (svg, strlen (svg), dots, error);
}

/* The area of all faces and that of one panel; every face is counter-clockwise. */
static gdouble
measure (const ClothGarment * garment)
{
  const ClothTopology *topology = garment->topology;
  gdouble sum = 0;

  g_assert_true (cloth_topology_check (topology, NULL));
  for (guint f = 0; f < topology->n_faces; f++) {
    const guint32 *v = &topology->faces[4 * f];
    guint n = cloth_face_corners (v);
    gdouble area = 0;

    for (guint i = 0; i < n; i++) {
      const gfloat *a = topology->uv + 2 * v[i];
      const gfloat *b = topology->uv + 2 * v[(i + 1) % n];

      area -= ((gdouble) a[0] * b[1] - (gdouble) a[1] * b[0]) / 2;
    }
    g_assert_cmpfloat (area, >, 0);
    sum += area;
  }
  return sum;
}

static guint
n_dots (const ClothGarment * garment)
{
  guint n = 0;

  for (guint v = 0; v < garment->topology->n_vertices; v++) {
    gint dot = garment->dots[v];

    if (dot == CLOTH_NO_DOT)
      continue;
    n++;
    /* it lies where the print has it */
    g_assert_cmpfloat_with_epsilon (garment->topology->uv[2 * v],
        0.01 + 0.02 * (dot % (gint) garment->columns), 1e-6);
    g_assert_cmpfloat_with_epsilon (garment->topology->uv[2 * v + 1],
        0.01 + 0.02 * (dot / (gint) garment->columns), 1e-6);
  }
  return n;
}

static void
test_rectangle (void)
{
  /* 160 × 120 mm whose sides lie between dots: 8 × 6 dots, and border vertices every
   * 20 mm; drawn clockwise, edge after edge in mixed directions */
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGarment) garment = build (HEAD PANEL ("r",
          EDGE ("top", "M40,60 H200") EDGE ("right", "M200,180 V60")
          EDGE ("bottom", "M200,180 H40") EDGE ("left", "M40,60 V180"))
      "</svg>", &grid, &error);
  const ClothPanel *panel;
  guint quads = 0;

  g_assert_no_error (error);
  g_assert_cmpuint (garment->panels->len, ==, 1);
  panel = &g_array_index (garment->panels, ClothPanel, 0);
  g_assert_cmpstr (panel->name, ==, "r");
  g_assert_cmpuint (panel->n_border, ==, 28);
  g_assert_cmpuint (n_dots (garment), ==, 48);
  g_assert_cmpuint (panel->n_vertices, ==, 76);
  g_assert_cmpfloat_with_epsilon (measure (garment), 0.16 * 0.12, 1e-7);
  for (guint f = 0; f < garment->topology->n_faces; f++)
    quads += garment->topology->faces[4 * f + 3] != CLOTH_NO_VERTEX;
  g_assert_cmpuint (quads, ==, 7 * 5);
  g_assert_cmpuint (garment->seams->len, ==, 0);
}

static void
test_disc (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGarment) garment = build (HEAD PANEL ("disc",
          EDGE ("rim", "M350,200 A150,150 0 1 1 50,200 "
              "A150,150 0 1 1 350,200 Z")) "</svg>", &grid, &error);
  guint border = 48;            /* 942.5 mm by 20 mm */

  g_assert_no_error (error);
  g_assert_cmpuint (g_array_index (garment->panels, ClothPanel, 0).n_border, ==,
      border);
  /* a regular polygon of 48 corners; lines may be 0.05 mm inside their curve */
  g_assert_cmpfloat_with_epsilon (measure (garment), border / 2. * 0.15 * 0.15
      * sin (2 * G_PI / border), 2 * G_PI * 0.15 * 5e-5);
}

/* Units: the same panel in centimetres with another viewBox. */
static void
test_units (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGarment) garment = build ("<svg width=\"40cm\" "
      "height=\"20cm\" viewBox=\"-100 -50 800 400\">"
      PANEL ("p", EDGE ("e", "M-20,-10 h320 v240 h-320 z")) "</svg>", &grid,
      &error);

  g_assert_no_error (error);
  g_assert_cmpfloat_with_epsilon (measure (garment), 0.16 * 0.12, 1e-7);
  g_assert_cmpfloat_with_epsilon (garment->topology->uv[0], 0.04, 1e-6);
  g_assert_cmpfloat_with_epsilon (garment->topology->uv[1], 0.02, 1e-6);
}

/* ---- seams ---- */

#define LEFT PANEL ("left", SEWN ("l1", "middle", "M120,20 V200") \
    EDGE ("l2", "M120,200 H20") EDGE ("l3", "M20,200 V20") \
    EDGE ("l4", "M20,20 H120"))
#define RIGHT(bottom) PANEL ("right", SEWN ("r1", "middle", "M200,20 V" bottom) \
    EDGE ("r2", "M200," bottom " H300") EDGE ("r3", "M300," bottom " V20") \
    EDGE ("r4", "M300,20 H200"))

static void
test_seam (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGarment) garment = build (HEAD LEFT RIGHT ("202") "</svg>",
      &grid, &error);
  const ClothSeamLine *line;
  const gfloat *uv;

  g_assert_no_error (error);
  g_assert_cmpuint (garment->seams->len, ==, 1);
  g_assert_cmpstr (g_ptr_array_index (garment->seam_names, 0), ==, "middle");
  line = &g_array_index (garment->seams, ClothSeamLine, 0);
  /* 182 mm take eleven vertices, and so do the 180 of the other side */
  g_assert_cmpuint (line->n_vertices, ==, 11);
  uv = garment->topology->uv;
  for (guint i = 0; i < 11; i++) {
    /* right side of one, left side of the other: both end at the same height */
    g_assert_cmpfloat_with_epsilon (uv[2 * line->lines[0][i]], 0.12, 1e-6);
    g_assert_cmpfloat_with_epsilon (uv[2 * line->lines[1][i]], 0.2, 1e-6);
    g_assert_cmpfloat_with_epsilon (uv[2 * line->lines[0][i] + 1],
        uv[2 * line->lines[1][i] + 1], 0.0021);
  }
}

static guint
used (const ClothGarment * garment, const gchar * name)
{
  for (guint s = 0; s < garment->seams->len; s++)
    if (strcmp (g_ptr_array_index (garment->seam_names, s), name) == 0)
      return g_array_index (garment->seams, ClothSeamLine, s).n_vertices;
  g_assert_not_reached ();
}

static void
test_examples (void)
{
  static const struct
  {
    const gchar *file;
    guint panels, seams;
  } examples[] = { {"/tshirt.svg", 4, 10}, {"/skirt.svg", 2, 2} };

  for (guint e = 0; e < G_N_ELEMENTS (examples); e++) {
    g_autofree gchar *path =
        g_strconcat (TEST_DATA "/../../pipelines", examples[e].file, NULL);
    g_autofree gchar *svg = NULL, *json = NULL, *again = NULL;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothGarment) garment = NULL, twin = NULL;
    g_autofree gboolean *in_face = NULL;

    g_assert_true (g_file_get_contents (path, &svg, NULL, NULL));
    garment = build (svg, &paper, &error);
    g_assert_no_error (error);
    g_assert_cmpuint (garment->panels->len, ==, examples[e].panels);
    g_assert_cmpuint (garment->seams->len, ==, examples[e].seams);
    g_assert_cmpuint (n_dots (garment), >, 1000);
    measure (garment);
    /* every vertex is used, and seams join tops to tops */
    in_face = g_new0 (gboolean, garment->topology->n_vertices);
    for (guint i = 0; i < 4 * garment->topology->n_faces; i++)
      if (garment->topology->faces[i] != CLOTH_NO_VERTEX)
        in_face[garment->topology->faces[i]] = TRUE;
    for (guint v = 0; v < garment->topology->n_vertices; v++)
      g_assert_true (in_face[v]);
    if (e == 0)
      g_assert_cmpuint (used (garment, "armhole-left-front"), ==,
          used (garment, "armhole-right-back"));
    for (guint s = 0; s < garment->seams->len; s++) {
      const ClothSeamLine *line = &g_array_index (garment->seams, ClothSeamLine,
          s);
      guint last = line->n_vertices - 1;
      const gfloat *uv = garment->topology->uv;

      g_assert_true ((uv[2 * line->lines[0][0] + 1] < uv[2 * line->lines[0]
                  [last] + 1]) == (uv[2 * line->lines[1][0] + 1] <
              uv[2 * line->lines[1][last] + 1]));
    }
    twin = build (svg, &paper, &error);
    json = cloth_garment_to_json (garment);
    again = cloth_garment_to_json (twin);
    g_assert_cmpstr (json, ==, again);
  }
}

static void
test_save (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGarment) garment = build (HEAD LEFT RIGHT ("200") "</svg>",
      &grid, &error);
  g_autoptr (ClothObj) obj = NULL;
  g_autofree gchar *path = NULL, *missing = NULL;

  scratch_begin ();
  g_assert_true (cloth_garment_save (garment, scratch, &error));
  g_assert_no_error (error);
  path = scratch_path ("garment.obj");
  obj = cloth_obj_read (path, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (obj->topology->n_vertices, ==,
      garment->topology->n_vertices);
  g_assert_cmpuint (obj->n_seam_vertices, ==, 0);
  for (guint i = 0; i < 2 * garment->topology->n_vertices; i++)
    g_assert_cmpfloat_with_epsilon (obj->topology->uv[i],
        garment->topology->uv[i], 1e-6);
  g_assert_cmpuint (scratch_count (), ==, 2);
  missing = scratch_path ("not/there");
  g_assert_false (cloth_garment_save (garment, missing, &error));
  g_assert_nonnull (error);
  scratch_end ();
}

/* Two panels sewn at both sides to a tube around which they go once, @radius wide; or one
 * after the other in a plane, sewn once. Outlines have no dots: they must be found. */
static gdouble
wear (const ClothGarment * garment, gboolean tube, gboolean sewn)
{
  const ClothTopology *topology = garment->topology;
  guint n = topology->n_vertices;
  ClothFillParameters parameters = { CLOTH_FILL_PLATE, 1e-6, 1, 0, 0 };
  g_autoptr (ClothFill) fill = cloth_fill_new (topology,
      sewn ? garment->seams : NULL, &parameters);
  g_autofree gfloat *truth = g_new (gfloat, 3 * n);
  g_autofree gfloat *seen = g_new (gfloat, 3 * n);
  g_autofree guint8 *states = g_new (guint8, n);
  ClothMeshFrame in = { seen, states, NULL }, out;
  gdouble radius = 0.2 / G_PI, most = 0;

  for (guint v = 0; v < n; v++) {
    /* u along the cloth without the gap between the panels */
    gdouble u = topology->uv[2 * v], height = topology->uv[2 * v + 1];

    u -= v >= g_array_index (garment->panels, ClothPanel, 1).first ? 0.16
        : 0.02;
    truth[3 * v] =
        (gfloat) (tube ? radius * cos (u / radius) : u + 0.1 * height);
    truth[3 * v + 1] = (gfloat) (tube ? radius * sin (u / radius) : 0.3 * u);
    truth[3 * v + 2] = (gfloat) - height;
    for (guint c = 0; c < 3; c++)
      seen[3 * v + c] = garment->dots[v] == CLOTH_NO_DOT ? NAN
          : truth[3 * v + c];
    states[v] = garment->dots[v] == CLOTH_NO_DOT ? CLOTH_VERTEX_UNSEEN
        : CLOTH_VERTEX_MEASURED;
  }
  cloth_fill_run (fill, 0, &in, &out, NULL);
  for (guint s = 0; s < garment->seams->len; s++) {
    const ClothSeamLine *line = &g_array_index (garment->seams, ClothSeamLine,
        s);

    for (guint i = 0; i < line->n_vertices; i++)
      for (guint side = 0; side < 2; side++)
        for (guint c = 0; c < 3; c++) {
          guint v = line->lines[side][i];

          g_assert_cmpuint (out.states[v], ==, CLOTH_VERTEX_FILLED);
          if (sewn)
            g_assert_cmpfloat (out.positions[3 * v + c], ==,
                out.positions[3 * line->lines[0][i] + c]);
          most = fmax (most, fabs ((gdouble) out.positions[3 * v + c]
                  - truth[3 * v + c]));
        }
  }
  return most;
}

static void
test_worn (void)
{
  /* 200 mm each, so that the tube is 400 mm around */
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGarment) tube = build (HEAD PANEL ("a",
          EDGE ("a1", "M20,20 H220") SEWN ("a2", "one", "M220,20 V180")
          EDGE ("a3", "M220,180 H20") SEWN ("a4", "two", "M20,180 V20"))
      PANEL ("b", EDGE ("b1", "M360,200 H560")
          SEWN ("b2", "two", "M560,200 V360") EDGE ("b3", "M560,360 H360")
          SEWN ("b4", "one", "M360,360 V200")) "</svg>", &paper, &error);
  g_autoptr (ClothGarment) plane = NULL;
  gdouble loose, sewn;

  /* the second lies 180 mm lower on the cloth; it is worn at the first one's height */
  g_assert_no_error (error);
  for (guint v = g_array_index (tube->panels, ClothPanel, 1).first;
      v < tube->topology->n_vertices; v++)
    tube->topology->uv[2 * v + 1] -= 0.18f;
  sewn = wear (tube, TRUE, TRUE);
  loose = wear (tube, TRUE, FALSE);
  g_test_message
      ("seams of a tube of 127 mm: %.2f mm off when sewn, %.2f loose",
      1000 * sewn, 1000 * loose);
  g_assert_cmpfloat (sewn, <, 0.0015);
  g_assert_cmpfloat (sewn, <, loose / 2);
  plane = build (HEAD PANEL ("a",
          EDGE ("a1", "M20,20 H220") SEWN ("a2", "one", "M220,20 V180")
          EDGE ("a3", "M220,180 H20") EDGE ("a4", "M20,180 V20"))
      PANEL ("b", EDGE ("b1", "M360,20 H560") EDGE ("b2", "M560,20 V180")
          EDGE ("b3", "M560,180 H360") SEWN ("b4", "one", "M360,180 V20"))
      "</svg>", &paper, &error);
  g_assert_no_error (error);
  g_assert_cmpfloat (wear (plane, FALSE, TRUE), <, 1e-5);
}

static void
test_load (void)
{
  static const gchar *const bad[][2] = {
    {"{}", "version"}, {"[]", ""}, {"{\"version\": 2, \"columns\": 1, "
          "\"rows\": 1}", "version 2"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2}", "dots"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2, \"dots\": [0, 1, 2]}",
        "each of the 4"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2, \"dots\": [0, 1, 2, 4]}",
        "vertex 3"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2, \"dots\": [0, 1, 2, 2]}",
        "dot 2"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2, \"dots\": [0, 1, 2, 3], "
          "\"seams\": [{\"lines\": [[0, 1], [2]]}]}", "seam 0"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2, \"dots\": [0, 1, 2, 3], "
          "\"seams\": [{\"lines\": [[0, 1], [2, 4]]}]}", "seam 0"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2, \"dots\": [0, 1, 2, 3], "
          "\"panels\": [{\"first\": 2, \"vertices\": 3}]}", "vertices"},
    {"{\"version\": 1, \"columns\": 2, \"rows\": 2, \"dots\": [0, 1, 2, 3], "
          "\"seam\": []}", "seam"},
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGarment) garment = build (HEAD LEFT RIGHT ("200") "</svg>",
      &grid, &error);
  g_autoptr (ClothGarment) again = NULL;
  g_autofree gchar *path = NULL, *json = NULL, *other = NULL;

  scratch_begin ();
  path = scratch_path ("garment.json");
  g_assert_true (cloth_garment_save (garment, scratch, &error));
  again = cloth_garment_load (path, &error);
  g_assert_no_error (error);
  json = cloth_garment_to_json (garment);
  other = cloth_garment_to_json (again);
  g_assert_cmpstr (json, ==, other);
  g_assert_true (cloth_topology_equal (garment->topology, again->topology));
  scratch_end ();
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_clear_error (&error);
    g_assert_null (cloth_garment_parse (bad[i][0], strlen (bad[i][0]),
            cloth_topology_new_grid (2, 2, 1, 1), &error));
    g_assert_nonnull (error);
    if (!strstr (error->message, bad[i][1]))
      g_error ("case %u: “%s” doesn't say “%s”", i, error->message,
          bad[i][1]);
  }
  g_clear_error (&error);
  g_assert_null (cloth_garment_load ("/no/such/garment.json", &error));
  g_assert_nonnull (error);
}

/* ---- what is wrong, and what is said of it ---- */

static void
test_errors (void)
{
  static const struct
  {
    const gchar *svg, *says[3];
  } cases[] = {
    {"", {NULL}},
    {"<html/>", {"no SVG"}},
    {"<svg viewBox=\"0 0 1 1\"/>", {"no true size", "mm"}},
    {"<svg width=\"400\" height=\"400\" viewBox=\"0 0 4 4\"/>", {"true size"}},
    {"<svg width=\"1cm\" height=\"1cm\"/>", {"viewBox"}},
    {"<svg width=\"1cm\" height=\"1cm\" viewBox=\"0 0 1 2\"/>", {"stretch"}},
    {"<svg width=\"1cm\" height=\"1cm\" viewBox=\"0 0 0 0\"/>", {"empty"}},
    {HEAD "</svg>", {"no panel", "class"}},
    {HEAD "<g class=\"panel\"/></svg>", {"no id"}},
    {HEAD PANEL ("a", "") "</svg>", {"“a”", "no path"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h100 v100 z"))
        PANEL ("a", "") "</svg>", {"two panels", "“a”"}},
    {HEAD PANEL ("a", "<path id=\"e\"/>") "</svg>", {"“e”", "path data"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h100 v")) "</svg>",
        {"“a”", "“e”", "character"}},
    {HEAD "<g transform=\"scale(2)\">" PANEL ("a", EDGE ("e",
                  "M20,20 h100 v100 z")) "</g></svg>",
        {"“a”", "transform"}},
    {HEAD "<g style=\"fill:none; transform : scale(2)\">" PANEL ("a", EDGE ("e",
                  "M20,20 h100 v100 z")) "</g></svg>",
        {"“a”", "transform"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h100 v100 h-100") EDGE ("f",
                  "M20,120 V20") EDGE ("g", "M60,60 h20 v20 z")) "</svg>",
        {"“a”", "closed before", "“g”"}},
    {HEAD "<g id=\"a\" class=\"cut panel\"/></svg>", {"“a”", "no path"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h100 v100") EDGE ("f",
                  "M120,123 L20,20")) "</svg>",
        {"“a”", "3.0 mm away", "“f”"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 L200,200 L200,20 L20,200 Z"))
        "</svg>", {"“a”", "crosses"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h100 v-100 h-100 Z")) "</svg>",
        {"“a”", "leaves the printed cloth", "400 × 400"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h300 v100 h-300 Z"))
          PANEL ("b", EDGE ("e", "M200,100 h100 v200 h-100 Z")) "</svg>",
        {"“a” and “b”", "overlap"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h300 v300 h-300 Z"))
          PANEL ("b", EDGE ("e", "M100,100 h100 v100 h-100 Z")) "</svg>",
        {"“a” and “b”", "overlap"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h9 v9 h-9 Z")) "</svg>",
        {"“a”", "no dot"}},
    {HEAD PANEL ("a", EDGE ("e", "M20,20 h100 v100 h-40 v-60 h-6 v60 h-54 Z"))
        "</svg>", {"“a”", "too narrow"}},
    {HEAD LEFT "</svg>", {"“middle”", "alone", "“l1”"}},
    {HEAD LEFT RIGHT ("200") PANEL ("third", SEWN ("t", "middle",
                  "M20,250 H200") EDGE ("u", "M200,250 L20,390 V250"))
        "</svg>", {"“middle”", "three", "“t”"}},
    /* both seams' sides with their counts */
    {HEAD LEFT RIGHT ("220") "</svg>", {"seam “middle”",
                "“l1” of panel “left” is 180.0 mm long and has 10 vertices",
            "“r1” of panel “right” 200.0 mm and 11 vertices"}},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothGarment) garment = build (cases[i].svg, &grid, &error);

    g_assert_null (garment);
    g_assert_nonnull (error);
    for (guint k = 0; k < 3 && cases[i].says[k]; k++)
      if (!strstr (error->message, cases[i].says[k]))
        g_error ("case %u: “%s” doesn't say “%s”", i, error->message,
            cases[i].says[k]);
  }
}

static void
test_limits (void)
{
  g_autoptr (GString) svg = g_string_new (HEAD);
  g_autoptr (GString) nested = g_string_new (HEAD);
  g_autoptr (GString) edges =
      g_string_new (HEAD "<g id=\"a\" class=\"panel\">");
  g_autofree gchar *large = g_malloc0 ((8u << 20) + 1);
  g_autoptr (GError) error = NULL;

  for (guint i = 0; i < 65; i++) {
    g_string_append_printf (svg, "<g id=\"p%u\" class=\"panel\"/>", i);
    g_string_append (nested, "<g>");
    g_string_append (edges, "<path d=\"M0,0h9\"/>");
  }
  g_assert_null (build (svg->str, &grid, &error));
  g_assert_nonnull (strstr (error->message, "more than 64 panels"));
  g_clear_error (&error);
  g_assert_null (build (nested->str, &grid, &error));
  g_assert_nonnull (strstr (error->message, "nested"));
  g_clear_error (&error);
  g_assert_null (build (edges->str, &grid, &error));
  g_assert_nonnull (strstr (error->message, "more than 64 edges"));
  g_clear_error (&error);
  g_assert_null (cloth_garment_new_from_svg (large, (8u << 20) + 1, &grid,
          &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/garment/path/commands", test_path_commands);
  g_test_add_func ("/garment/path/curves", test_path_curves);
  g_test_add_func ("/garment/path/errors", test_path_errors);
  g_test_add_func ("/garment/delaunay", test_delaunay);
  g_test_add_func ("/garment/circles", test_circles);
  g_test_add_func ("/garment/rectangle", test_rectangle);
  g_test_add_func ("/garment/disc", test_disc);
  g_test_add_func ("/garment/units", test_units);
  g_test_add_func ("/garment/seam", test_seam);
  g_test_add_func ("/garment/examples", test_examples);
  g_test_add_func ("/garment/save", test_save);
  g_test_add_func ("/garment/worn", test_worn);
  g_test_add_func ("/garment/load", test_load);
  g_test_add_func ("/garment/errors", test_errors);
  g_test_add_func ("/garment/limits", test_limits);
  return g_test_run ();
}
