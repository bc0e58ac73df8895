/* Scenes: from takes, sewn, and everything no simulation could make sense of.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/scene.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "tests/core/meshpeer.h"

static ClothScene *
load (const gchar * path, GError ** error)
{
  g_autoptr (ClothTake) take = cloth_take_open (path, error);

  return take ? cloth_scene_new_from_take (take, error) : NULL;
}

/* Figures of this test were read off the data with NumPy. */
static void
test_real_take (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothScene) scene = load (TEST_DATA "/take_drop", &error);
  const ClothHeld *held;

  g_assert_no_error (error);
  g_assert_cmpuint (scene->topology->n_vertices, ==, 1155);
  g_assert_cmpuint (scene->n_frames, ==, 32);
  g_assert_cmpfloat (scene->fps, ==, 50);
  g_assert_cmpfloat_with_epsilon (scene->times[31], 0.62, 1e-12);
  g_assert_cmpfloat (scene->gravity[2], ==, -9.81);
  g_assert_cmpuint (scene->held->len, ==, 2);
  held = &g_array_index (scene->held, ClothHeld, 1);
  g_assert_cmpuint (held->vertex, ==, 32);
  g_assert_cmpfloat (held->until_s, ==, 0.32);
  /* The noise of the film is not in the clamps. */
  for (guint k = 0; k < 3; k++)
    g_assert_cmpfloat (scene->positions[3 * 32 + k], ==, scene->clamps[3 + k]);
  for (guint i = 0; i < 3 * 1155; i++)
    g_assert_true (isfinite (scene->positions[i]));
  g_assert_null (scene->velocities);
}

/* A take of 3 × 3 vertices written by NumPy, then changed by @change. */
static gchar *
write_take (const gchar * change)
{
  g_autofree gchar *script = g_strdup_printf ("import json\nos.mkdir('t')\n"
      "j={'version':1,'fps':10,'grid':{'columns':3,'rows':3,'width_m':2,"
      "'height_m':2},'held':[{'vertex':0},{'vertex':2}]}\n"
      "y,x=np.mgrid[0:3,0:3]\n"
      "p=np.stack([x+1,0*x+2,3-y],2).reshape(1,9,3).repeat(4,0).astype('f4')\n"
      "c=p[:,[0,2]].copy()\n" "t=None\n" "%s\n"
      "json.dump(j,open('t/take.json','w'))\n"
      "np.save('t/positions.npy',p)\n"
      "if c is not None: np.save('t/clamps.npy',c)\n"
      "if t is not None: np.save('t/times.npy',np.array(t,'f8'))\n", change);

  scratch_begin ();
  peer_run (script);
  return scratch_path ("t");
}

static void
assert_place (const ClothScene * scene, guint vertex, gdouble x, gdouble y,
    gdouble z)
{
  g_assert_cmpfloat_with_epsilon (scene->positions[3 * vertex], x, 1e-6);
  g_assert_cmpfloat_with_epsilon (scene->positions[3 * vertex + 1], y, 1e-6);
  g_assert_cmpfloat_with_epsilon (scene->positions[3 * vertex + 2], z, 1e-6);
}

static void
test_start (void)
{
  static const gchar *const changes[] = {
    "",
    /* one not seen lies between its neighbours */
    "p[0,4]=np.nan",
    /* a held one is where its clamp is, seen or not */
    "p[0,0]=np.nan; p[0,2]=[9,9,9]",
    /* nothing seen: flat from the clamps */
    "p[0]=np.nan",
    /* what is not held yet does not count for that */
    "p[0]=np.nan; j['held'][1]['from_s']=0.1; c[:,1]=[7,7,7]",
    /* times of its own */
    "t=[0,.1,.2,.3]; del j['fps']",
    /* what a clamp says after it let go means nothing */
    "j['held'][1]['until_s']=0.2; c[2:,1]=np.nan",
  };

  for (guint i = 0; i < G_N_ELEMENTS (changes); i++) {
    g_autofree gchar *path = write_take (changes[i]);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothScene) scene = load (path, &error);

    g_assert_no_error (error);
    for (guint k = 0; k < 9; k++)
      assert_place (scene, k, 1 + k % 3, 2, 3 - (gdouble) (k / 3));
    g_assert_cmpfloat_with_epsilon (scene->fps, 10, 1e-9);
    scratch_end ();
  }
}

/* Cloth that hangs over a cylinder and is hidden about a corner that a clamp holds starts there
 * as a cylinder: with vertices in one place a simulator divides by nothing. */
static void
test_hidden_corner (void)
{
  const gdouble radius = 0.2, edge = 0.05;
  g_autofree gchar *path = write_take ("y,x=np.mgrid[0:9,0:11]\n"
      "j['grid']={'columns':11,'rows':9,'width_m':0.5,'height_m':0.4}\n"
      "p=np.stack([0.05*x,0.2*np.cos(0.25*y),0.2*np.sin(-0.25*y)],2)\n"
      "p=p.reshape(1,99,3).repeat(4,0).astype('f4'); c=p[:,[0,2]].copy()\n"
      "p.reshape(4,9,11,3)[0,:4,:4]=np.nan");
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothScene) scene = load (path, &error);

  g_assert_no_error (error);
  for (guint v = 0; v < 99; v++) {
    const gdouble angle = edge * (v / 11) / radius;
    const gdouble *at = scene->positions + 3 * (gsize) v;
    const gdouble off[3] = { at[0] - edge * (v % 11),
      at[1] - radius * cos (angle), at[2] + radius * sin (angle)
    };

    g_assert_cmpfloat (cloth_vec3_length (off), <, 0.2 * edge);
  }
  scratch_end ();
}

/* Clamps that stand still may be written once. */
static void
test_still_clamps (void)
{
  g_autofree gchar *path = write_take ("c=c[:1]");
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothScene) scene = load (path, &error);

  g_assert_no_error (error);
  for (guint frame = 0; frame < 4; frame++) {
    const gdouble *row = scene->clamps + 6 * (gsize) frame;

    for (guint i = 0; i < 2; i++) {
      g_assert_cmpfloat (row[3 * i], ==, 1 + 2 * i);
      g_assert_cmpfloat (row[3 * i + 1], ==, 2);
      g_assert_cmpfloat (row[3 * i + 2], ==, 3);
    }
  }
  scratch_end ();
}

static void
test_refused_takes (void)
{
  static const struct
  {
    const gchar *change, *text;
  } cases[] = {
    {"c=None", "/t: take.json says that 2 vertices are held"},
    {"c=None", "[4][2][3], or [1][2][3]"},
    {"c=c[:2]", "clamps.npy has 2 rows; the take needs 4"},
    {"c=c[:0]", "clamps.npy"},
    {"c=c[:1]; c[0,1]=np.nan", "vertex 2"},
    {"c[1,1]=np.nan", "vertex 2"},
    {"j['held'].append({'vertex':2}); c=c[:,[0,1,1]]",
        "vertex 2 is held twice"},
    {"j['held'][1]['vertex']=0", "vertex 0 is held twice"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = write_take (cases[i].change);
    g_autoptr (GError) error = NULL;

    g_assert_null (load (path, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_test_message ("%s", error->message);
    g_assert_nonnull (strstr (error->message, cases[i].text));
    scratch_end ();
  }
  /* Held again after it was let go is fine. */
  {
    g_autofree gchar *path = write_take ("j['held'][1]={'vertex':0,"
        "'from_s':.2}; j['held'][0]['until_s']=.2");
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothScene) scene = load (path, &error);

    g_assert_no_error (error);
    g_assert_nonnull (scene);
    scratch_end ();
  }
}

/* Clamps that jump, for those who would simulate them; the scene itself can be read. */
static void
test_paths (void)
{
  static const struct
  {
    const gchar *change, *text;
  } cases[] = {
    {"c[2:,1,0]+=100", "vertex 2 jumps 100 m between frames 1 and 2"},
    {"c[3,0,2]-=35", "vertex 0 jumps 35 m between frames 2 and 3"},
    {"t=[0,.1,.1001,.3]; c[2:,1,1]+=1", "vertex 2 jumps 1 m"},
    {"c[1,1]=3e38", "vertex 2 jumps"},
    /* an arm that throws; what is let go before it jumps, or not yet held */
    {"c[2:,1,0]+=33", NULL},
    {"j['held'][1]['until_s']=0.2; c[2:,1,0]+=1e6", NULL},
    {"j['held'][1]['from_s']=0.2; c[:2,1,0]=np.nan", NULL},
    {"j['held']=[]; c=None", NULL},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = write_take (cases[i].change);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothScene) scene = load (path, &error);

    g_assert_no_error (error);
    g_assert_true (cloth_scene_check_paths (scene, &error) == !cases[i].text);
    if (cases[i].text) {
      g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
      g_test_message ("%s", error->message);
      g_assert_nonnull (strstr (error->message, cases[i].text));
    }
    scratch_end ();
  }
}

/* Two sheets of 2 × 2 vertices beside each other, v of the second stretched. */
static ClothScene *
panels (gfloat stretch)
{
  static const gfloat uv[] = { 0, 0, 1, 0, 0, 1, 1, 1, 2, 0, 3, 0, 2, 1, 3, 1 };
  static const guint32 faces[] = { 0, 2, 3, 1, 4, 6, 7, 5 };
  ClothTopology *topology = cloth_topology_new (8, 2);

  memcpy (topology->uv, uv, sizeof uv);
  memcpy (topology->faces, faces, sizeof faces);
  topology->uv[2 * 6 + 1] = topology->uv[2 * 7 + 1] = stretch;
  return cloth_scene_new (topology, 50, 2);
}

static void
test_sewn (void)
{
  guint right[] = { 1, 3 }, left[] = { 4, 6 }, dart[] = { 3, 1 };
  guint beyond[] = { 4, 8 };
  const ClothSeamLine good = { 2, {right, left} }, tip = { 2, {right, right} };
  const ClothSeamLine wrong = { 2, {right, beyond} };
  const ClothSeamLine crossed = { 2, {right, dart} };
  g_autoptr (ClothScene) scene = panels (1.015f), longer = panels (1.03f);
  g_autoptr (GError) error = NULL;
  const ClothSeam *seam;

  g_assert_true (cloth_scene_sew (scene, &good, &error));
  g_assert_cmpuint (scene->seams->len, ==, 2);
  seam = &g_array_index (scene->seams, ClothSeam, 1);
  g_assert_cmpuint (seam->a, ==, 3);
  g_assert_cmpuint (seam->b, ==, 6);
  g_assert_true (cloth_scene_sew (scene, &tip, &error));
  g_assert_cmpuint (scene->seams->len, ==, 2);
  g_assert_true (cloth_scene_sew (scene, &crossed, &error));
  g_assert_true (cloth_scene_check (scene, &error));
  g_assert_no_error (error);
  g_assert_false (cloth_scene_sew (scene, &wrong, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "vertex 8"));
  g_clear_error (&error);
  g_assert_false (cloth_scene_sew (longer, &good, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "1.03 m"));
  g_assert_cmpuint (longer->seams->len, ==, 0);
}

static void
break_duplicate (ClothScene * scene)
{
  scene->topology->faces[4] = 3;
  scene->topology->faces[5] = 1;
  scene->topology->faces[6] = 0;
  scene->topology->faces[7] = 2;
}

static void
break_degenerate (ClothScene * scene)
{
  scene->topology->faces[5] = scene->topology->faces[4];
}

static void
break_flat (ClothScene * scene)
{
  for (guint i = 4; i < 8; i++)
    scene->topology->uv[2 * i] = 2;
}

/* The second panel shares an edge with the first one and runs the same way along it. */
static void
break_winding (ClothScene * scene)
{
  const guint32 face[] = { 3, 1, 5, 7 };

  memcpy (scene->topology->faces + 4, face, sizeof face);
}

static void
break_folded (ClothScene * scene)
{
  const guint32 face[] = { 1, 3, 7, 5 };

  memcpy (scene->topology->faces + 4, face, sizeof face);
  g_assert_true (cloth_scene_check (scene, NULL));
  scene->topology->uv[2 * 5] = scene->topology->uv[2 * 7] = 0.5f;
}

static void
break_uv (ClothScene * scene)
{
  scene->topology->uv[3] = NAN;
}

static void
break_index (ClothScene * scene)
{
  scene->topology->faces[1] = 8;
}

static void
break_position (ClothScene * scene)
{
  scene->positions[3 * 5 + 1] = NAN;
}

static void
break_velocity (ClothScene * scene)
{
  scene->velocities = g_new0 (gdouble, 24);
  g_assert_true (cloth_scene_check (scene, NULL));
  scene->velocities[3 * 5 + 2] = INFINITY;
}

static void
break_gravity (ClothScene * scene)
{
  scene->gravity[1] = NAN;
}

static void
break_times (ClothScene * scene)
{
  scene->times[1] = scene->times[0];
}

static void
break_fps (ClothScene * scene)
{
  scene->fps = 0;
}

static void
break_held (ClothScene * scene)
{
  cloth_scene_hold (scene, 3);
  g_assert_true (cloth_scene_check (scene, NULL));
  g_array_index (scene->held, ClothHeld, 0).vertex = 8;
}

static void
break_clamp (ClothScene * scene)
{
  cloth_scene_hold (scene, 3);
  scene->clamps[4] = NAN;
}

static void
break_release (ClothScene * scene)
{
  cloth_scene_hold (scene, 3);
  g_array_index (scene->held, ClothHeld, 0).from_s = INFINITY;
}

static void
break_seam (ClothScene * scene)
{
  const ClothSeam seam = { 3, 8 };

  g_array_append_val (scene->seams, seam);
}

static void
break_radius (ClothScene * scene)
{
  const ClothObstacle ball = {.radius_m = -0.5,.friction = NAN };

  g_array_append_val (scene->obstacles, ball);
}

static void
break_friction (ClothScene * scene)
{
  const ClothObstacle ball = {.radius_m = 0.5,.friction = -1 };

  g_array_append_val (scene->obstacles, ball);
}

static void
break_obstacle_mesh (ClothScene * scene)
{
  const ClothObstacle mesh = {.kind = CLOTH_OBSTACLE_MESH,.friction = NAN };

  g_array_append_val (scene->obstacles, mesh);
}

static void
break_obstacle_point (ClothScene * scene)
{
  const guint32 triangle[3] = { 0, 1, 2 };
  const gdouble points[9] = { 0, 0, 0, 1, 0, NAN, 0, 1, 0 };
  const ClothObstacle mesh = {.kind = CLOTH_OBSTACLE_MESH,.friction = NAN,
    .points = g_memdup2 (points, sizeof points),.n_points = 3,
    .triangles = g_memdup2 (triangle, sizeof triangle),.n_triangles = 1
  };

  g_array_append_val (scene->obstacles, mesh);
}

static void
test_refused (void)
{
  static const struct
  {
    void (*change) (ClothScene * scene);
    const gchar *text;
  } cases[] = {
    {break_duplicate, "faces 0 and 1 are the same"},
    {break_degenerate, "face 1 has vertex 4 twice"},
    {break_flat, "face 1 (vertices 4, 6, 7) has no area"},
    {break_winding, "face 1 is inverted against face 0"},
    {break_folded, "face 1 is inverted against face 0"},
    {break_uv, "vertex 1"}, {break_index, "face 0"},
    {break_position, "the position of vertex 5 along y is nan"},
    {break_velocity, "the velocity of vertex 5 along z is inf"},
    {break_gravity, "gravity along y"}, {break_times, "frame 1"},
    {break_fps, "a frame rate of 0"}, {break_held, "held vertex 8"},
    {break_clamp, "the clamp of vertex 3 has no place in frame 1"},
    {break_release, "held vertex 3 is let go"},
    {break_seam, "vertices 3 and 8"},
    {break_radius, "obstacle 0 has the radius -0.5"},
    {break_friction, "obstacle 0 has the friction -1"},
    {break_obstacle_mesh, "obstacle 0 is a mesh without triangles"},
    {break_obstacle_point, "point 1 of obstacle 0 is nan along z"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (ClothScene) scene = panels (1);
    g_autoptr (GError) error = NULL;

    g_assert_true (cloth_scene_check (scene, &error));
    cases[i].change (scene);
    g_assert_false (cloth_scene_check (scene, &error));
    g_assert_cmpint (error->domain, ==, CLOTH_FILE_ERROR);
    g_test_message ("%s", error->message);
    g_assert_nonnull (strstr (error->message, cases[i].text));
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/scene/real-take", test_real_take);
  g_test_add_func ("/scene/start", test_start);
  g_test_add_func ("/scene/hidden-corner", test_hidden_corner);
  g_test_add_func ("/scene/still-clamps", test_still_clamps);
  g_test_add_func ("/scene/refused-takes", test_refused_takes);
  g_test_add_func ("/scene/paths", test_paths);
  g_test_add_func ("/scene/sewn", test_sewn);
  g_test_add_func ("/scene/refused", test_refused);
  return g_test_run ();
}
