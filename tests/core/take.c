/* Takes: a real one, one we write read by NumPy, and hostile ones.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/hash.h"
#include "gst/take/take.h"
#include "tests/core/meshpeer.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* Figures of this file were read off the data with NumPy. */
static void
test_real_take (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTake) take = cloth_take_open (TEST_DATA "/take_drop", &error);
  const ClothTakeInfo *info;
  const ClothHeld *held;
  gfloat positions[1155 * 3], clamps[6];
  guint8 states[1155];
  guint n_unseen = 0;
  gdouble worst = 0;

  g_assert_no_error (error);
  info = cloth_take_get_info (take);
  g_assert_cmpstr (info->name, ==, "take_drop");
  g_assert_cmpuint (info->columns, ==, 33);
  g_assert_cmpuint (info->rows, ==, 35);
  g_assert_cmpfloat (info->noise_sigma_m, ==, 0.0004);
  g_assert_cmpfloat (info->gravity[2], ==, -9.81);
  g_assert_cmpuint (info->held->len, ==, 2);
  held = &g_array_index (info->held, ClothHeld, 1);
  g_assert_cmpuint (held->vertex, ==, 32);
  g_assert_cmpfloat (held->until_s, ==, 0.32);
  g_assert_true (isinf (held->from_s));
  g_assert_cmpuint (cloth_take_get_n_frames (take), ==, 32);
  g_assert_null (cloth_take_get_times (take));
  g_assert_cmpfloat_with_epsilon (cloth_take_get_time (take, 31), 0.62, 1e-12);
  g_assert_false (cloth_take_has_covariances (take));
  g_assert_true (cloth_take_has_clamps (take));
  for (guint frame = 0; frame < 32; frame++) {
    g_assert_true (cloth_take_read_positions (take, frame, positions, &error));
    g_assert_true (cloth_take_read_states (take, frame, positions, states,
            &error));
    g_assert_true (cloth_take_read_clamps (take, frame, clamps, &error));
    for (guint i = 0; i < 1155; i++)
      n_unseen += states[i] == CLOTH_VERTEX_UNSEEN;
    /* The clamped corner is where its clamp is logged, but for the noise. */
    for (guint k = 0; k < 3; k++)
      worst = MAX (worst, fabs (positions[k] - clamps[k]));
  }
  g_test_message ("%u unseen; corner off its clamp by %.2f mm at most",
      n_unseen, worst * 1000);
  g_assert_cmpuint (n_unseen, ==, 1152 / 3);
  g_assert_cmpfloat (worst, <, 5 * 0.0004);
}

static ClothTakeWriter *
write_frames (const gchar * name, guint n_frames, gboolean mesh)
{
  g_autofree gchar *path = scratch_path (name);
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("Umhang „ä“");
  g_autoptr (ClothTopology) topology = cloth_topology_new_grid (3, 2, 0.5f, 1);
  g_autoptr (GError) error = NULL;
  ClothTakeWriter *writer;
  ClothHeld held = {.vertex = 2,.from_s = -INFINITY,.until_s = 1.5 };
  ClothObstacle ball = {.kind = CLOTH_OBSTACLE_SPHERE,.point = {1, 2, 3},
  .radius_m = 0.25,.friction = NAN
  };

  if (mesh) {
    info->mesh = g_strdup ("mesh.obj");
  } else {
    info->columns = 3;
    info->rows = 2;
    info->width_m = 0.5;
    info->height_m = 1;
  }
  info->noise_sigma_m = 0.001;
  g_array_append_val (info->held, held);
  g_array_append_val (info->obstacles, ball);
  writer = cloth_take_writer_new (path, info, topology, &error);
  g_assert_no_error (error);
  for (guint frame = 0; frame < n_frames; frame++) {
    gfloat positions[18], covariances[36], clamps[3] = { 1, 2, (gfloat) frame };
    guint8 states[6];

    for (guint i = 0; i < 6; i++) {
      states[i] = (guint8) (i % 5);
      for (guint k = 0; k < 3; k++)
        positions[3 * i + k] = states[i] ? (gfloat) (frame + i + k) : NAN;
      for (guint k = 0; k < 6; k++)
        covariances[6 * i + k] = (gfloat) (frame + 1);
    }
    /* Covariances begin in the second frame and miss the fourth. */
    g_assert_true (cloth_take_writer_append (writer, 0.1 * (frame + frame / 3),
            positions, states, frame == 0 || frame == 3 ? NULL : covariances,
            clamps, &error));
    g_assert_no_error (error);
  }
  return writer;
}

static void
write_take (const gchar * name, guint n_frames, gboolean mesh)
{
  g_autoptr (ClothTakeWriter) writer = write_frames (name, n_frames, mesh);
  g_autoptr (GError) error = NULL;

  g_assert_true (cloth_take_writer_close (writer, &error));
  g_assert_no_error (error);
}

static void
test_written_take (void)
{
  for (guint mesh = 0; mesh < 2; mesh++) {
    g_autofree gchar *path = NULL;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (ClothTopology) topology =
        cloth_topology_new_grid (3, 2, 0.5f, 1);
    gfloat covariances[36];

    scratch_begin ();
    write_take ("t", 5, mesh);
    peer_run ("import json\nos.chdir('t')\n"
        "j=json.load(open('take.json',encoding='utf8'))\n"
        "assert j['version']==1 and j['name']=='Umhang „ä“' and 'fps' not in j\n"
        "assert j['held']==[{'vertex':2,'until_s':1.5}]\n"
        "assert j['noise_sigma_m']==.001 and j['gravity']==[0,0,-9.81]\n"
        "assert j['obstacles']==[{'type':'sphere','centre':[1,2,3],"
        "'radius_m':.25,'friction':None}]\n"
        "p=np.load('positions.npy'); f=np.arange(5)[:,None,None]\n"
        "i=np.arange(6)[None,:,None]; t=f+i+np.arange(3)[None,None]\n"
        "t=np.where(i%5==0,np.nan,t)\n"
        "assert p.dtype=='f4' and np.array_equal(p,t,equal_nan=True)\n"
        "c=np.load('covariance.npy')\n"
        "assert c.dtype=='f4' and c.shape==(5,6,6)\n"
        "assert np.isnan(c[[0,3]]).all() and (c[[1,2,4]]==[[[2]],[[3]],[[5]]])"
        ".all()\n"
        "x=np.load('times.npy'); assert x.dtype=='f8'\n"
        "assert np.allclose(x,[0,.1,.2,.4,.5])\n"
        "assert (np.load('states.npy')==np.arange(6)%5).all()\n"
        "k=np.load('clamps.npy')\n"
        "assert k.shape==(5,1,3) and (k[:,0,2]==np.arange(5)).all()\n");
    path = scratch_path ("t");
    take = cloth_take_open (path, &error);
    g_assert_no_error (error);
    g_assert_true (cloth_topology_equal (cloth_take_get_topology (take),
            topology));
    g_assert_cmpfloat (cloth_take_get_time (take, 3), ==, 0.1 * 4);
    g_assert_true (cloth_take_read_covariances (take, 4, covariances, &error));
    g_assert_cmpfloat (covariances[35], ==, 5);
    scratch_end ();
  }
}

/* A take without what the earlier one in its folder had does not inherit it. */
static void
test_replaces_whole (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (GError) error = NULL;
  ClothTakeWriter *writer;

  scratch_begin ();
  path = scratch_path ("t");
  write_take ("t", 5, FALSE);
  peer_run ("open('t/rig.json','w').write('{}')");
  write_take ("t", 1, FALSE);
  take = cloth_take_open (path, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (cloth_take_get_n_frames (take), ==, 1);
  g_assert_false (cloth_take_has_covariances (take));
  /* An abort leaves the old one, and what else is in the folder. */
  writer = write_frames ("t", 3, TRUE);
  cloth_take_writer_free (writer);
  peer_run ("assert sorted(os.listdir('t'))==['clamps.npy','positions.npy',"
      "'rig.json','states.npy','take.json','times.npy'],os.listdir('t')");
  scratch_end ();
}

/* Two panels of two triangles each, sewn along an edge; a wedge as obstacle. */
#define PANELS "v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 1 1 0\\n" \
    "v 0 0 1\\nv 1 0 1\\nv 0 1 1\\nv 1 1 1\\n" \
    "vt 0 0\\nvt .1 0\\nvt 0 .2\\nvt .1 .2\\n" \
    "vt .5 0\\nvt .6 0\\nvt .5 .2\\nvt .6 .2\\n" \
    "f 1/1 2/2 3/3\\nf 2/2 4/4 3/3\\nf 5/5 6/6 7/7\\nf 6/6 8/8 7/7\\n"
#define WEDGE "v 0 0 0\\nv 3 0 0\\nv 3 2 0\\nv 0 2 0\\nv 0 0 1\\n" \
    "f 1 2 3 4\\nf 1 2 5\\n"

static void
write_garment (const gchar * seams, const gchar * wedge)
{
  g_autofree gchar *script = g_strdup_printf ("os.mkdir('g')\n"
      "open('g/mesh.obj','w').write('" PANELS "')\n"
      "open('g/wedge.obj','w').write('%s')\n"
      "np.save('g/positions.npy',np.zeros((2,8,3),'f4'))\n"
      "open('g/take.json','w').write('{\"version\":1,\"fps\":25,"
      "\"mesh\":\"mesh.obj\",\"seams\":%s,\"obstacles\":["
      "{\"type\":\"capsule\",\"from\":[0,0,1],\"to\":[0,1,1],"
      "\"radius_m\":0.1,\"friction\":0.3},"
      "{\"type\":\"mesh\",\"mesh\":\"wedge.obj\"}]}')\n", wedge, seams);

  scratch_begin ();
  peer_run (script);
}

static void
test_garment (void)
{
  static const guint32 triangles[] = { 0, 1, 2, 0, 2, 3, 0, 1, 4 };

  write_garment ("[{\"lines\":[[1,3],[4,6]]}]", WEDGE);
  /* Once as it was written by hand, once as we write it. */
  for (guint turn = 0; turn < 2; turn++) {
    g_autofree gchar *path = scratch_path (turn ? "h" : "g");
    g_autofree gchar *copy = scratch_path ("h");
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothTake) take = cloth_take_open (path, &error);
    g_autoptr (ClothTakeWriter) writer = NULL;
    const ClothTakeInfo *info;
    const ClothSeamLine *seam;
    const ClothObstacle *capsule, *wedge;
    gfloat positions[24] = { 0 };
    guint8 states[8] = { 0 };

    g_assert_no_error (error);
    info = cloth_take_get_info (take);
    g_assert_cmpuint (info->seams->len, ==, 1);
    seam = &g_array_index (info->seams, ClothSeamLine, 0);
    g_assert_cmpuint (seam->n_vertices, ==, 2);
    g_assert_cmpuint (seam->lines[0][1], ==, 3);
    g_assert_cmpuint (seam->lines[1][0], ==, 4);
    g_assert_cmpuint (info->obstacles->len, ==, 2);
    capsule = &g_array_index (info->obstacles, ClothObstacle, 0);
    g_assert_cmpint (capsule->kind, ==, CLOTH_OBSTACLE_CAPSULE);
    g_assert_cmpfloat (capsule->point[1], ==, 0);
    g_assert_cmpfloat (capsule->end[1], ==, 1);
    g_assert_cmpfloat (capsule->radius_m, ==, 0.1);
    wedge = capsule + 1;
    g_assert_cmpint (wedge->kind, ==, CLOTH_OBSTACLE_MESH);
    g_assert_true (isnan (wedge->friction));
    g_assert_cmpuint (wedge->n_points, ==, 5);
    g_assert_cmpfloat (wedge->points[3 * 2 + 1], ==, 2);
    g_assert_cmpmem (wedge->triangles, 12 * wedge->n_triangles, triangles,
        sizeof triangles);
    writer = cloth_take_writer_new (copy, info, cloth_take_get_topology (take),
        &error);
    g_assert_no_error (error);
    g_assert_true (cloth_take_writer_append (writer, 0, positions, states, NULL,
            NULL, &error));
    g_assert_true (cloth_take_writer_close (writer, &error));
    g_assert_no_error (error);
  }
  scratch_end ();
}

/* What shows only when the mesh or the obstacle's file is read. */
static void
test_broken_garments (void)
{
  static const gchar *const broken[][2] = {
    {"[{\"lines\":[[1,3],[4,8]]}]", WEDGE},
    {"[{\"lines\":[[999999,3],[4,6]]}]", WEDGE},
    {"[]", "v 0 0 0\\n"},
    {"[]", "v 0 0 0\\nv 1 nan 0\\nv 0 1 0\\nf 1 2 3\\n"},
    {"[]", "v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 4\\n"},
    {"[]", ""},
  };
  g_autoptr (GError) fault = NULL;
  g_autofree gchar *folder = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (broken); i++) {
    g_autofree gchar *path = NULL;
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (GError) error = NULL;

    write_garment (broken[i][0], broken[i][1]);
    path = scratch_path ("g");
    take = cloth_take_open (path, &error);
    g_assert_null (take);
    g_assert_cmpint (error->domain, ==, CLOTH_FILE_ERROR);
    g_test_message ("%s", error->message);
    scratch_end ();
  }
  write_garment ("[]", WEDGE);
  peer_run ("os.remove('g/wedge.obj')");
  folder = scratch_path ("g");
  g_assert_null (cloth_take_open (folder, &fault));
  g_assert_error (fault, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_assert_nonnull (strstr (fault->message, "wedge.obj"));
  scratch_end ();
}

/* Arrays of whole numbers, as numpy.arange makes times: the error says which types are read. */
static void
test_types (void)
{
  static const struct
  {
    const gchar *array, *type;
  } cases[] = {
    {"times", "float64"}, {"positions", "float32 or float64"},
    {"states", "uint8"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = NULL, *script = g_strdup_printf ("np.save("
        "'t/%s.npy',np.load('t/%s.npy').astype('i4'))\n", cases[i].array,
        cases[i].array);
    g_autoptr (GError) error = NULL;

    scratch_begin ();
    write_take ("t", 2, FALSE);
    peer_run (script);
    path = scratch_path ("t");
    g_assert_null (cloth_take_open (path, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_nonnull (strstr (error->message, cases[i].array));
    g_assert_nonnull (strstr (error->message, cases[i].type));
    scratch_end ();
  }
}

static void
test_refused_frames (void)
{
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autoptr (GError) error = NULL;
  gfloat positions[18] = { 0 }, clamps[3] = { 0 };
  guint8 states[6] = { 1, 1, 1, 1, 1, 1 };

  scratch_begin ();
  writer = write_frames ("t", 2, FALSE);
  g_assert_false (cloth_take_writer_append (writer, 0.1, positions, states,
          NULL, clamps, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_clear_error (&error);
  g_assert_false (cloth_take_writer_append (writer, NAN, positions, states,
          NULL, clamps, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_clear_error (&error);
  g_assert_false (cloth_take_writer_append (writer, 1, positions, states, NULL,
          NULL, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  scratch_end ();
}

#define GRID "\"grid\":{\"columns\":3,\"rows\":2,\"width_m\":1,\"height_m\":1}"
#define MESH "{\"version\":1,\"fps\":25,\"mesh\":\"a.obj\""
#define OK "{\"version\":1,\"fps\":25," GRID

static const gchar *const bad_json[] = {
  "", "{}", "[]", "null", "{", OK, "{\"version\":2," GRID "}",
  "{\"version\":\"1\"," GRID "}", "{\"version\":1.5," GRID "}",
  "{\"version\":1}", OK ",\"mesh\":\"a.obj\"}", OK ",\"fsp\":25}",
  OK ",\"name\":3}", OK ",\"gravity\":[0,0]}", OK ",\"gravity\":[0,0,\"x\"]}",
  OK ",\"gravity\":9.81}", OK ",\"noise_sigma_m\":-1}",
  OK ",\"noise_sigma_m\":\"small\"}", OK ",\"held\":3}", OK ",\"held\":[3]}",
  OK ",\"held\":[{}]}", OK ",\"held\":[{\"vertex\":6}]}",
  OK ",\"held\":[{\"vertex\":-1}]}", OK ",\"held\":[{\"vertex\":0.5}]}",
  OK ",\"held\":[{\"vertex\":1,\"until\":3}]}",
  OK ",\"held\":[{\"vertex\":1,\"from_s\":3,\"until_s\":2}]}",
  OK ",\"obstacles\":[{}]}", OK ",\"obstacles\":[{\"type\":\"cube\"}]}",
  OK ",\"obstacles\":[{\"type\":\"sphere\",\"centre\":[0,0,0]}]}",
  OK ",\"obstacles\":[{\"type\":\"plane\",\"point\":[0,0,0],"
      "\"normal\":[0,0,0]}]}",
  "{\"version\":1,\"fps\":0," GRID "}", "{\"version\":1,\"fps\":-25," GRID "}",
  "{\"version\":1,\"grid\":{\"columns\":1,\"rows\":2,\"width_m\":1,"
      "\"height_m\":1}}",
  "{\"version\":1,\"grid\":{\"columns\":3,\"rows\":2,\"width_m\":0,"
      "\"height_m\":1}}",
  "{\"version\":1,\"grid\":{\"columns\":3,\"rows\":2,\"width_m\":1}}",
  "{\"version\":1,\"grid\":{\"columns\":400000,\"rows\":400000,\"width_m\":1,"
      "\"height_m\":1}}",
  "{\"version\":1,\"grid\":[3,2]}", OK ",\"notes\":\"\xff\"}",
  OK ",/* [ */\"notes\":\"x\"}", OK "}{}", OK "} 7", OK ",\"fps\":30}",
  OK ",\"name\":\"\\ud800\"}", OK ",\"name\":\"\\udc00\\ud800\"}",
  OK ",\"name\":\"a\\u0000b\"}", OK ",\"name\":\"\\ud83d\\u0041\"}",
  OK ",\"name\":\"\\ud8", OK ",\"name\":\"\\222\"}", OK ",\"name\":\"\\",
  OK ",\"held\":[{\"vertex\":1,\"vertex\":2}]}",
  OK ",\"obstacles\":[{\"type\":\"capsule\",\"from\":[0,0,0],"
      "\"radius_m\":1}]}",
  OK ",\"obstacles\":[{\"type\":\"capsule\",\"from\":[0,0,0],"
      "\"to\":[0,0,1]}]}",
  OK ",\"obstacles\":[{\"type\":\"capsule\",\"from\":[0,0,0],"
      "\"to\":[0,0,1],\"radius_m\":-1}]}",
  OK ",\"obstacles\":[{\"type\":\"mesh\"}]}",
  OK ",\"obstacles\":[{\"type\":\"mesh\",\"mesh\":\"\"}]}",
  OK ",\"obstacles\":[{\"type\":\"mesh\",\"mesh\":\"a.obj\","
      "\"radius_m\":1}]}",
  OK ",\"seams\":[{\"lines\":[[0,1],[2,3]]}]}",
  MESH ",\"seams\":3}", MESH ",\"seams\":[3]}", MESH ",\"seams\":[{}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1]]}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1],[2,3],[4,5]]}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1],[2,3]],\"ease\":2}]}",
  MESH ",\"seams\":[{\"lines\":[[0],[2]]}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1],[2,3,4]]}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1],[2,-3]]}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1],[2,2]]}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1.5],[2,3]]}]}",
  MESH ",\"seams\":[{\"lines\":[[0,1000000],[2,3]]}]}",
};

/* What a mistake in take.json is called. */
static const struct
{
  const gchar *text, *says;
} named_json[] = {
  {"{\"version\":1,\"grid\":{\"columns\":3,\"colums\":2}}", "colums"},
  {"{\"version\":1,\"grid\":{\"columns\":3,\"rows\":1}}", "“rows”"},
  {"{\"version\":1,\"grid\":{\"columns\":3,\"rows\":2,\"width_m\":1,"
        "\"height_m\":\"1\"}}", "“height_m”"},
  {"{\"version\":1,\"grid\":{\"columns\":3,\"rows\":2,\"height_m\":1}}",
      "“grid” needs width_m and height_m"},
  {OK ",\"held\":[{\"vertex\":1,\"from_s\":\"0\"}]}", "“from_s”"},
  {OK ",\"held\":[{\"vertex\":1,\"until_s\":1e12}]}", "“until_s”"},
  {MESH ",\"seams\":[{\"lines\":[3,[0,1]]}]}",
      "a line of seam 0 must be a list of at least two vertices"},
  {MESH ",\"seams\":[{\"lines\":[[0,\"1\"],[2,3]]}]}", "whole numbers"},
  {OK ",\"obstacles\":[{\"type\":\"sphere\",\"radius_m\":1}]}", "“centre”"},
  {OK ",\"obstacles\":[{\"type\":\"plane\",\"normal\":[0,0,1]}]}",
      "“point”"},
  {OK ",\"obstacles\":[{\"type\":\"plane\",\"point\":[0,0,1]}]}",
      "“normal”"},
  {OK ",\"obstacles\":[{\"type\":\"mesh\",\"mesh\":3}]}", "“mesh”"},
  {OK ",\"obstacles\":[{\"type\":3}]}", "“type”"},
  {OK ",\"obstacles\":[{\"type\":\"plane\",\"friction\":-1}]}",
      "“friction”"},
  {OK ",\"obstacles\":3}", "“obstacles”"},
  {OK ",\"obstacles\":[3]}", "“obstacles”"},
  {"{\"version\":1,\"mesh\":3}", "“mesh”"},
  {OK ",\"notes\":3}", "“notes”"},
};

static void
test_named_json (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (named_json); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_take_info_parse (named_json[i].text,
            strlen (named_json[i].text), &error));
    g_test_message ("%s", error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_true (g_str_has_prefix (error->message, "take.json: "));
    g_assert_nonnull (strstr (error->message, named_json[i].says));
  }
}

/* A description without a name, and one of every obstacle, for another take. */
static void
test_copied_info (void)
{
  static const gchar text[] = MESH ",\"obstacles\":["
      "{\"type\":\"plane\",\"point\":[1,2,3],\"normal\":[0,0,5]},"
      "{\"type\":\"mesh\",\"mesh\":\"sub/wedge.obj\",\"friction\":0.5}],"
      "\"held\":[{\"vertex\":3,\"from_s\":-2}],"
      "\"seams\":[{\"lines\":[[0,1],[2,3]]}],\"notes\":\"n\"}";
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeInfo) info =
      cloth_take_info_parse (text, strlen (text), &error);
  g_autoptr (ClothTakeInfo) unnamed = cloth_take_info_new (NULL);
  g_autoptr (ClothTakeInfo) copy = NULL, empty = NULL;
  const ClothObstacle *plane;

  g_assert_no_error (error);
  copy = cloth_take_info_copy (info);
  g_assert_cmpstr (copy->mesh, ==, "mesh.obj");
  g_assert_cmpstr (copy->notes, ==, "n");
  g_assert_cmpuint (copy->obstacles->len, ==, 2);
  plane = &g_array_index (copy->obstacles, ClothObstacle, 0);
  g_assert_cmpint (plane->kind, ==, CLOTH_OBSTACLE_PLANE);
  g_assert_cmpfloat (plane->point[2], ==, 3);
  g_assert_cmpfloat (plane->normal[2], ==, 1);
  g_assert_true (isnan (plane->friction));
  g_assert_null (plane->mesh);
  g_assert_cmpstr (plane[1].mesh, ==, "obstacle-1.obj");
  g_assert_cmpfloat (plane[1].friction, ==, 0.5);
  g_assert_cmpuint (copy->held->len, ==, 1);
  g_assert_cmpfloat (g_array_index (copy->held, ClothHeld, 0).from_s, ==, -2);
  g_assert_cmpuint (copy->seams->len, ==, 1);

  unnamed->columns = unnamed->rows = 2;
  unnamed->width_m = unnamed->height_m = 1;
  unnamed->fps = 25;
  empty = cloth_take_info_copy (unnamed);
  g_assert_cmpstr (empty->name, ==, "");
  g_assert_null (empty->mesh);
  g_assert_cmpuint (empty->rows, ==, 2);
}

static void
test_hostile_json (void)
{
  g_autoptr (GString) deep = g_string_new (OK ",\"held\":");
  g_autoptr (GError) fault = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (bad_json); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_take_info_parse (bad_json[i], strlen (bad_json[i]),
            &error));
    g_assert_nonnull (error);
    g_assert_cmpint (error->domain, ==, CLOTH_FILE_ERROR);
    g_test_message ("%s", error->message);
  }
  /* Deep enough to overflow the stack of a recursive parser. */
  for (guint i = 0; i < 1000000; i++)
    g_string_append_c (deep, '[');
  g_assert_null (cloth_take_info_parse (deep->str, deep->len, &fault));
  g_assert_error (fault, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
}

/* Each line breaks a whole take in one way. */
static const gchar *const breaks[] = {
  "os.remove('t/positions.npy')",
  "os.remove('t/times.npy')",   /* and there is no fps */
  "os.remove('t/take.json')",
  "np.save('t/positions.npy',np.zeros((5,5,3),'f4'))",
  "np.save('t/positions.npy',np.zeros((0,6,3),'f4'))",
  "np.save('t/positions.npy',np.zeros((5,6,3),'i4'))",
  "np.save('t/positions.npy',np.zeros((4,6,3),'f4'))",
  "np.save('t/covariance.npy',np.zeros((5,6,3,3),'f4'))",
  "np.save('t/times.npy',np.zeros(5))",
  "np.save('t/times.npy',np.array([0,1,2,np.nan,4]))",
  "np.save('t/times.npy',np.arange(4.))",
  "np.save('t/clamps.npy',np.zeros((5,2,3),'f4'))",
  "np.save('t/states.npy',np.zeros((5,6),'f4'))",
  "d=open('t/positions.npy','rb').read()\n"
      "open('t/positions.npy','wb').write(d[:-1])",
  "os.rename('t/positions.npy','p.npy'); os.symlink('../p.npy',"
      "'t/positions.npy')",
  "os.remove('t/states.npy'); os.symlink('/dev/zero','t/states.npy')",
  "os.remove('t/states.npy'); os.mkdir('t/states.npy')",
  "s=open('t/take.json').read()\n"
      "open('t/take.json','w').write(s.replace('mesh.obj','../mesh.obj'))\n"
      "os.rename('t/mesh.obj','mesh.obj')",
  "open('t/mesh.obj','w').write('v 0 0 0\\n'*6)",
  "open('t/mesh.obj','w').write('v 0 0 0\\nvt 0 0\\nf 1/1 1/1 1/1\\n')",
  "open('t/mesh.obj','w').write('v 0 x 0\\n')",
  "os.truncate('t/take.json',(512<<20)+1)",
  "os.remove('t/times.npy'); os.mkdir('t/times.npy')",
  "os.remove('t/covariance.npy'); os.mkdir('t/covariance.npy')",
  "np.save('t/covariance.npy',np.zeros((5,6,6),'i4'))",
  "np.save('t/clamps.npy',np.zeros((5,1,3),'i4'))",
  "np.save('t/times.npy',np.arange(5))",
  "s=open('t/take.json').read()\nimport json\nd=json.loads(s)\nd['held']=[]\n"
      "json.dump(d,open('t/take.json','w'))",
};

/* These show only when the frame is read. */
static const gchar *const frame_breaks[] = {
  "a=np.load('t/positions.npy'); a[2,3,1]=np.inf; np.save('t/positions.npy',a)",
  "a=np.load('t/positions.npy'); a[2,3,1]=np.nan; np.save('t/positions.npy',a)",
  "c='t/covariance.npy'; a=np.load(c); a[2,3,1]=np.inf; np.save(c,a)",
  "a=np.load('t/covariance.npy'); a[2,3,5]=-1; np.save('t/covariance.npy',a)",
  "a=np.load('t/states.npy'); a[2,3]=5; np.save('t/states.npy',a)",
  "a=np.load('t/clamps.npy'); a[2]=np.inf; np.save('t/clamps.npy',a)",
  "a=np.load('t/clamps.npy'); a[2,0,1]=np.nan; np.save('t/clamps.npy',a)",
};

static const gchar *const frame_files[] = {
  "positions.npy", "states.npy", "covariance.npy", "clamps.npy"
};

static gboolean
read_frame (ClothTake * take, guint frame, GError ** error)
{
  gfloat positions[18], covariances[36], clamps[3];
  guint8 states[6];

  return cloth_take_read_positions (take, frame, positions, error) &&
      cloth_take_read_states (take, frame, positions, states, error) &&
      cloth_take_read_covariances (take, frame, covariances, error) &&
      cloth_take_read_clamps (take, frame, clamps, error);
}

static void
test_broken_takes (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (breaks); i++) {
    g_autofree gchar *path = NULL;
    g_autoptr (GError) error = NULL;

    scratch_begin ();
    path = scratch_path ("t");
    write_take ("t", 5, TRUE);
    peer_run (breaks[i]);
    g_assert_null (cloth_take_open (path, &error));
    g_test_message ("%s", error->message);
    scratch_end ();
  }
  for (guint i = 0; i < G_N_ELEMENTS (frame_breaks); i++) {
    g_autofree gchar *path = NULL;
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (GError) error = NULL;

    scratch_begin ();
    path = scratch_path ("t");
    write_take ("t", 5, FALSE);
    peer_run (frame_breaks[i]);
    take = cloth_take_open (path, &error);
    g_assert_no_error (error);
    g_assert_true (read_frame (take, 1, &error));
    g_assert_no_error (error);
    g_assert_false (read_frame (take, 2, &error));
    g_test_message ("%s", error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    scratch_end ();
  }
}

/* Arrays that become shorter while the take is open. */
static void
test_shrinking_takes (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (frame_files); i++) {
    g_autofree gchar *path = NULL, *file = NULL;
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (GError) error = NULL;

    scratch_begin ();
    path = scratch_path ("t");
    file = g_build_filename (path, frame_files[i], NULL);
    write_take ("t", 5, FALSE);
    take = cloth_take_open (path, &error);
    g_assert_no_error (error);
    g_assert_true (read_frame (take, 4, &error));
    g_assert_cmpint (truncate (file, 128), ==, 0);
    g_assert_false (read_frame (take, 4, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED);
    scratch_end ();
  }
}

/* coreutils says the same: LC_ALL=C sha256sum * | sha256sum. */
static void
test_hash (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTake) real = cloth_take_open (TEST_DATA "/take_drop", &error);
  g_autoptr (ClothTake) take = NULL;
  g_autofree gchar *sha256 = cloth_take_sha256 (real, &error);
  g_autofree gchar *path = NULL, *spare = NULL, *before = NULL, *after = NULL;

  g_assert_no_error (error);
  g_assert_cmpstr (sha256, ==,
      "86b74633fbf508f2894f5d0772c9047f14f1dd27073faa6cdb5c0830ced28e20");

  scratch_begin ();
  write_take ("t", 5, TRUE);
  path = scratch_path ("t");
  /* what reading a take does not read is not in it; its mesh is */
  spare = g_build_filename (path, "notes.txt", NULL);
  g_assert_true (g_file_set_contents (spare, "x", -1, &error));
  take = cloth_take_open (path, &error);
  before = cloth_take_sha256 (take, &error);
  g_assert_no_error (error);
  peer_run ("import hashlib\nos.chdir('t')\n"
      "h=lambda b:hashlib.sha256(b).hexdigest()\n"
      "n=sorted(x for x in os.listdir() if x!='notes.txt')\n"
      "assert 'mesh.obj' in n and 'times.npy' in n\n"
      "a=''.join(h(open(x,'rb').read())+'  '+x+'\\n' for x in n)\n"
      "open('../sum','w').write(h(a.encode()))");
  {
    g_autofree gchar *said = scratch_path ("sum"), *expected = NULL;

    g_assert_true (g_file_get_contents (said, &expected, NULL, &error));
    g_assert_cmpstr (before, ==, expected);
  }
  peer_run ("open('t/mesh.obj','ab').write(b'#')");
  after = cloth_take_sha256 (take, &error);
  g_assert_no_error (error);
  g_assert_cmpstr (after, !=, before);
  peer_run ("os.remove('t/times.npy')");
  g_assert_null (cloth_take_sha256 (take, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);
  g_assert_null (cloth_file_sha256 (path, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
  scratch_end ();
}

/* Longer than what is read at a time, and the figures of FIPS 180-2. */
static void
test_file_hash (void)
{
  static const gchar *const known[][2] = {
    {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
    {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
  };
  static const gchar million[] =
      "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
  g_autofree gchar *path = NULL, *as = g_strnfill (1000000, 'a'), *got = NULL;
  g_autoptr (GError) error = NULL;

  scratch_begin ();
  path = scratch_path ("f");
  for (guint i = 0; i < G_N_ELEMENTS (known); i++) {
    g_autofree gchar *said = NULL;

    scratch_write ("f", known[i][0], -1);
    said = cloth_file_sha256 (path, &error);
    g_assert_cmpstr (said, ==, known[i][1]);
  }
  scratch_write ("f", as, 1000000);
  got = cloth_file_sha256 (path, &error);
  g_assert_no_error (error);
  g_assert_cmpstr (got, ==, million);
  scratch_end ();
}

static void
test_unwritable (void)
{
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("x");
  g_autoptr (ClothTopology) topology = cloth_topology_new_grid (3, 2, 1, 1);
  g_autoptr (GError) error = NULL;

  info->columns = 3;
  info->rows = 2;
  info->width_m = info->height_m = 1;
  g_assert_null (cloth_take_writer_new ("/nonexistent/t", info, topology,
          &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);
  g_assert_null (cloth_take_writer_new ("/dev/null", info, topology, &error));
  g_assert_nonnull (error);
}

/* Folders have the names that files of the take need. */
static void
test_names_taken (void)
{
  static const gchar *const names[] = { "take.json", "mesh.obj", "wedge.obj",
    "positions.npy", "times.npy", "states.npy"
  };
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autoptr (GError) fault = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = NULL, *folder = NULL, *taken = NULL;
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (GError) error = NULL;

    write_garment ("[]", WEDGE);
    path = scratch_path ("g");
    folder = scratch_path ("h");
    taken = g_build_filename (folder, names[i], NULL);
    g_assert_cmpint (g_mkdir_with_parents (taken, 0755), ==, 0);
    take = cloth_take_open (path, &error);
    g_assert_no_error (error);
    g_assert_null (cloth_take_writer_new (folder, cloth_take_get_info (take),
            cloth_take_get_topology (take), &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_IS_DIRECTORY);
    g_assert_nonnull (strstr (error->message, names[i]));
    scratch_end ();
  }
  /* Those that begin with a frame, or never. */
  scratch_begin ();
  peer_run ("os.makedirs('t/clamps.npy'); os.makedirs('u/covariance.npy')");
  for (guint i = 0; i < 2; i++) {
    g_autofree gchar *path = scratch_path (i ? "u" : "t");
    g_autoptr (ClothTopology) topology = cloth_topology_new_grid (3, 2, 1, 1);
    g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("x");
    g_autoptr (ClothTakeWriter) own = NULL;
    g_autoptr (GError) error = NULL;
    ClothHeld held = {.vertex = 2,.from_s = -INFINITY,.until_s = 1.5 };
    gfloat positions[18] = { 0 }, covariances[36] = { 0 }, clamps[3] = { 0 };
    guint8 states[6] = { 1, 1, 1, 1, 1, 1 };

    info->columns = 3;
    info->rows = 2;
    info->width_m = info->height_m = 1;
    g_array_append_val (info->held, held);
    own = cloth_take_writer_new (path, info, topology, &error);
    g_assert_no_error (error);
    g_assert_false (cloth_take_writer_append (own, 0, positions, states,
            covariances, clamps, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_IS_DIRECTORY);
  }
  /* Clamps of no vertex are no file. */
  {
    static const gfloat positions[12] = { 0 }, clamps[3] = { 0 };
    static const guint8 states[4] = { 1, 1, 1, 1 };
    g_autofree gchar *path = scratch_path ("w");
    g_autofree gchar *file = g_build_filename (path, "clamps.npy", NULL);
    g_autoptr (ClothTopology) topology = cloth_topology_new_grid (2, 2, 1, 1);
    g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("x");
    g_autoptr (ClothTakeWriter) own = NULL;
    g_autoptr (GError) error = NULL;

    info->columns = info->rows = 2;
    info->width_m = info->height_m = 1;
    own = cloth_take_writer_new (path, info, topology, &error);
    g_assert_no_error (error);
    g_assert_true (cloth_take_writer_append (own, 0, positions, states, NULL,
            clamps, &error));
    g_assert_true (cloth_take_writer_close (own, &error));
    g_assert_false (g_file_test (file, G_FILE_TEST_EXISTS));
  }
  writer = write_frames ("v", 0, FALSE);
  g_assert_false (cloth_take_writer_close (writer, &fault));
  g_assert_error (fault, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_cmpstr (fault->message, ==, "a take needs at least one frame");
  scratch_end ();
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/take/real", test_real_take);
  g_test_add_func ("/take/written", test_written_take);
  g_test_add_func ("/take/replaces-whole", test_replaces_whole);
  g_test_add_func ("/take/types", test_types);
  g_test_add_func ("/take/refused-frames", test_refused_frames);
  g_test_add_func ("/take/hostile-json", test_hostile_json);
  g_test_add_func ("/take/broken", test_broken_takes);
  g_test_add_func ("/take/garment", test_garment);
  g_test_add_func ("/take/broken-garments", test_broken_garments);
  g_test_add_func ("/take/hash", test_hash);
  g_test_add_func ("/take/file-hash", test_file_hash);
  g_test_add_func ("/take/unwritable", test_unwritable);
  g_test_add_func ("/take/named-json", test_named_json);
  g_test_add_func ("/take/copied-info", test_copied_info);
  g_test_add_func ("/take/shrinking", test_shrinking_takes);
  g_test_add_func ("/take/names-taken", test_names_taken);
  return g_test_run ();
}
