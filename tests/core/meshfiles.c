/* OBJ + PC2 and PLY against readers of other people, and hostile ones.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/hold.h"
#include "gst/mesh/formats/obj.h"
#include "gst/mesh/formats/pc2.h"
#include "gst/mesh/formats/ply.h"
#include "gst/take/sequence.h"
#include "gst/take/take.h"
#include "tests/core/meshpeer.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#define COLUMNS 5
#define ROWS 4
#define N (COLUMNS * ROWS)
#define FRAMES 7

/* x = column + frame / 8, y = row, z = frame²: exact in float32. */
static void
fill_frame (guint frame, gfloat * positions, guint8 * states,
    gfloat * covariances)
{
  for (guint i = 0; i < N; i++) {
    positions[3 * i] = (gfloat) (i % COLUMNS) + (gfloat) frame / 8;
    positions[3 * i + 1] = (gfloat) (i / COLUMNS);
    positions[3 * i + 2] = (gfloat) (frame * frame);
    states[i] = (guint8) (1 + i % 4);
    for (guint k = 0; k < 6; k++)
      covariances[6 * i + k] = (gfloat) (k == 0 || k == 3 || k == 5) * 4e-6f;
  }
}

/* Vertex 7 is never seen, vertex 3 not from frame 2 to 4. */
static void
hide (guint frame, gfloat * positions, guint8 * states)
{
  for (guint k = 0; k < 3; k++)
    positions[21 + k] = NAN;
  states[7] = CLOTH_VERTEX_UNSEEN;
  if (frame >= 2 && frame <= 4) {
    for (guint k = 0; k < 3; k++)
      positions[9 + k] = NAN;
    states[3] = CLOTH_VERTEX_UNSEEN;
  }
}

static ClothMeshWriter *
write_frames (const gchar * location, ClothMeshFormat format, guint n_frames)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);
  g_autoptr (GError) error = NULL;
  ClothMeshWriter *writer = cloth_mesh_writer_new (location, format, "my cloth",
      topology, 30000, 1001, &error);

  g_assert_no_error (error);
  for (guint frame = 0; frame < n_frames; frame++) {
    gfloat positions[3 * N], covariances[6 * N];
    guint8 states[N];
    ClothMeshFrame contents = { positions, states, covariances };

    fill_frame (frame, positions, states, covariances);
    hide (frame, positions, states);
    g_assert_true (cloth_mesh_writer_append (writer, frame, &contents, &error));
    g_assert_no_error (error);
  }
  return writer;
}

static void
write_sequence (const gchar * name, ClothMeshFormat format, guint n_frames)
{
  g_autofree gchar *path = scratch_path (name);
  g_autoptr (ClothMeshWriter) writer = write_frames (path, format, n_frames);
  g_autoptr (GError) error = NULL;

  g_assert_true (cloth_mesh_writer_close (writer, &error));
  g_assert_no_error (error);
}

/* What fill_frame and hide say must come back. */
static void
check_sequence (const gchar * name, gboolean covariances_kept)
{
  g_autofree gchar *path = scratch_path (name);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshReader) reader =
      cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);

  g_assert_no_error (error);
  g_assert_true (cloth_topology_equal (topology,
          cloth_mesh_reader_get_topology (reader)));
  g_assert_cmpuint (cloth_mesh_reader_get_n_frames (reader), ==, FRAMES);
  g_assert_cmpfloat_with_epsilon (cloth_mesh_reader_get_fps (reader),
      30000 / 1001.0, 1e-9);
  for (guint frame = FRAMES; frame-- > 0;) {
    gfloat positions[3 * N], covariances[6 * N];
    guint8 states[N];
    ClothMeshFrame contents;

    fill_frame (frame, positions, states, covariances);
    hide (frame, positions, states);
    g_assert_true (cloth_mesh_reader_read (reader, frame, &contents, &error));
    for (guint i = 0; i < 3 * N; i++)
      g_assert_true (isnan (positions[i]) ? isnan (contents.positions[i]) :
          positions[i] == contents.positions[i]);
    g_assert_cmpmem (states, N, contents.states, N);
    g_assert_true (!contents.covariances == !covariances_kept);
    if (covariances_kept)
      g_assert_cmpmem (covariances, sizeof covariances, contents.covariances,
          sizeof covariances);
  }
}

static void
test_obj_pc2 (void)
{
  scratch_begin ();
  write_sequence ("c.obj", CLOTH_MESH_FORMAT_AUTO, FRAMES);
  check_sequence ("c.obj", FALSE);
  check_sequence ("c.pc2", FALSE);
  check_sequence ("c", FALSE);
  /* A plain reader of the format, and NumPy for the states. */
  peer_run ("d=open('c.pc2','rb').read()\n"
      "m,ver,n,start,rate,k=struct.unpack('<12siiffi',d[:32])\n"
      "assert (m,ver,n,start,rate,k)==(b'POINTCACHE2\\0',1,20,0,1,7)\n"
      "p=np.frombuffer(d[32:],'<f4').reshape(7,20,3)\n"
      "i=np.arange(20); f=np.arange(7)[:,None]\n"
      "t=np.stack(np.broadcast_arrays(i%5+f/8,i//5,f**2),-1)\n"
      "seen=np.ones((7,20),bool); seen[:,7]=0; seen[2:5,3]=0\n"
      "assert (p[seen]==t[seen]).all() and np.isfinite(p).all()\n"
      "assert (p[2:5,3]==t[1,3]).all()\n"
      "assert np.allclose(p[0,7],t[0,[2,6,8,12]].mean(0))\n"
      "s=np.load('c.states.npy')\n"
      "assert ((s==0)==~seen).all() and (s[seen]==(1+i%4+0*f)[seen]).all()\n"
      "v=[];vt=[];q=[]\n"
      "for l in open('c.obj'):\n"
      "  w=l.split()\n"
      "  if w[0]=='v': v.append([float(x) for x in w[1:]])\n"
      "  if w[0]=='vt': vt.append([float(x) for x in w[1:]])\n"
      "  if w[0]=='f': q.append([int(x.split('/')[0])-1 for x in w[1:]]); "
      "assert all(x.split('/')[0]==x.split('/')[1] for x in w[1:])\n"
      "  if w[0]=='o': assert w[1]=='my_cloth'\n"
      "assert (np.array(v,'f4')==p[0]).all()\n"
      "assert np.allclose(vt,np.stack([i%5*.125,i//5*.25/3],1),atol=1e-8)\n"
      "assert len(q)==12 and q[0]==[0,5,6,1]\n"
      "assert sorted(os.listdir('.'))==['c.obj','c.pc2','c.states.npy']\n");
  scratch_end ();
}

static void
test_ply (void)
{
  scratch_begin ();
  write_sequence ("c.ply", CLOTH_MESH_FORMAT_AUTO, FRAMES);
  check_sequence ("c.ply", TRUE);
  check_sequence ("c_%05d.ply", TRUE);
  peer_run ("for f in range(7):\n"
      "  d=open('c_%05d.ply'%f,'rb').read()\n"
      "  h,b=d.split(b'end_header\\n',1)\n"
      "  assert h.startswith(b'ply\\nformat binary_little_endian 1.0\\n')\n"
      "  p=[l.split()[2].decode() for l in h.splitlines() if "
      "l.startswith(b'property') and b'list' not in l]\n"
      "  t=np.dtype([(x,'u1' if x=='state' else '<f4') for x in p])\n"
      "  v=np.frombuffer(b[:20*t.itemsize],t); i=np.arange(20)\n"
      "  seen=i!=7\n"
      "  if 2<=f<=4: seen[3]=False\n"
      "  assert (v['x']==i%5+f/8)[seen].all() and (v['y']==i//5)[seen].all()\n"
      "  assert (v['z']==f*f)[seen].all() and np.isfinite(v['x']).all()\n"
      "  assert ((v['state']==0)==~seen).all()\n"
      "  assert np.allclose(v['quality'],.002) and (v['cov_xy']==0).all()\n"
      "  assert np.allclose(v['s'],i%5*.125)\n"
      "  q=b[20*t.itemsize:]\n"
      "  assert len(q)==12*17 and struct.unpack('<B4I',q[:17])==(4,0,5,6,1)\n"
      "assert len(os.listdir('.'))==7\n");
  scratch_end ();
}

/* PLY and PC2 as other programs write them. */
static void
test_foreign_files (void)
{
  ClothMeshFrame contents;

  scratch_begin ();
  peer_run ("for f in range(1,4):\n"
      "  h='ply\\r\\nformat binary_big_endian 1.0\\r\\nelement face 1\\r\\n'\\\n"
      "  'property list uchar int vertex_index\\r\\nelement vertex 5\\r\\n'\\\n"
      "  'property double x\\r\\nproperty double y\\r\\nproperty double z\\r\\n'\\\n"
      "  'property list int double junk\\r\\nend_header\\r\\n'\n"
      "  v=b''.join(struct.pack('>3dI2d',i,f,-i,2,8,9) for i in range(5))\n"
      "  q=struct.pack('>B5i',5,0,1,2,3,4)\n"
      "  h2=h.replace('element face 1\\r\\nproperty list uchar int "
      "vertex_index\\r\\n','').replace('end_header','element face 1\\r\\n"
      "property list uchar int vertex_index\\r\\nend_header')\n"
      "  open('b_%05d.ply'%f,'wb').write(h2.encode()+v+q)\n"
      "open('k.obj','w').write('v 0 0 0\\nv 1 0 0\\nv 0 1 0\\n"
      "f 1 2 3\\n')\n"
      "open('k.pc2','wb').write(b'POINTCACHE2\\0'+struct.pack('<iiffi',1,3,1,1,2)"
      "+np.arange(18,dtype='<f4').tobytes())\n");
  {
    g_autofree gchar *path = scratch_path ("b.ply");
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothMeshReader) reader =
        cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
    const ClothTopology *topology;

    g_assert_no_error (error);
    g_assert_cmpuint (cloth_mesh_reader_get_n_frames (reader), ==, 3);
    topology = cloth_mesh_reader_get_topology (reader);
    g_assert_cmpuint (topology->n_faces, ==, 3);
    g_assert_cmpuint (topology->faces[10], ==, 4);
    g_assert_cmpuint (topology->faces[11], ==, CLOTH_NO_VERTEX);
    g_assert_true (cloth_mesh_reader_read (reader, 2, &contents, &error));
    g_assert_cmpfloat (contents.positions[12], ==, 4);
    g_assert_cmpfloat (contents.positions[13], ==, 3);
    g_assert_cmpfloat (contents.positions[14], ==, -4);
    g_assert_cmpuint (contents.states[4], ==, CLOTH_VERTEX_MEASURED);
  }
  {
    g_autofree gchar *path = scratch_path ("k.obj");
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothMeshReader) reader =
        cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);

    g_assert_no_error (error);
    g_assert_cmpuint (cloth_mesh_reader_get_n_frames (reader), ==, 2);
    g_assert_cmpfloat (cloth_mesh_reader_get_fps (reader), ==, 0);
    g_assert_true (cloth_mesh_reader_read (reader, 1, &contents, &error));
    g_assert_cmpfloat (contents.positions[8], ==, 17);
  }
  scratch_end ();
}

static void
test_obj_tolerance (void)
{
  static const gchar text[] = "# made elsewhere\r\nmtllib a.mtl\r\n"
      "o thing\nv 0 0 0 1.0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0 0\nvt .5 0\n"
      "vt 0.5 0.5\nvt 0 5e-1\nvn 0 0 1\ng a\nusemtl b\ns off\n"
      "f -4/-4/-1 -3/-3/-1 \\\n -2/-2/-1 -1/-1/-1\n"
      "f 1//1 2//1 3//1 # a triangle\nf 1/2 2 3/3 4 1\nl 1 2\n";
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothObj) obj = cloth_obj_parse (text, strlen (text), &error);
  static const guint32 faces[] = { 0, 1, 2, 3, 0, 1, 2, CLOTH_NO_VERTEX,
    0, 1, 2, CLOTH_NO_VERTEX, 0, 2, 3, CLOTH_NO_VERTEX, 0, 3, 0,
    CLOTH_NO_VERTEX
  };
  static const gfloat uv[] = { 0, 0, .5, 0, .5, .5, 0, .5 };

  g_assert_no_error (error);
  g_assert_cmpuint (obj->topology->n_vertices, ==, 4);
  g_assert_cmpmem (obj->topology->faces, obj->topology->n_faces * 16, faces,
      sizeof faces);
  g_assert_cmpmem (obj->topology->uv, 32, uv, sizeof uv);
  g_assert_true (obj->has_uv);
  g_assert_cmpuint (obj->n_seam_vertices, ==, 1);
}

/* Where a text may end, or a line go on: the faces that come of it, of a mesh of three
 * vertices and one uv. */
static void
test_obj_ends (void)
{
  static const struct
  {
    const gchar *text;
    guint n_faces;
  } good[] = {
    {"", 0}, {"f", 0}, {"v", 0}, {" \t\r", 0}, {"# nothing", 0},
    {"vtx 1 2\nff 1 2 3\nv\n", 0},
    {"f 1 2 3", 1}, {"f 1 2 3 ", 1}, {"f 1 2 3\r\n", 1}, {"f\t1 2 3#4", 1},
    {"f 1/1 2/1 3/1", 1}, {"f 1/1/1 2//1 3/1/9", 1},
    {"f 1 2 \\\r\n3 1", 1}, {"f 1 2\\\n3 1", 1}, {"f 1 \\\n2 3 1 2", 3},
  };
  static const gchar *const bad[] = {
    "f 1 2 \\", "f 1 2 \\3", "f 1 2 \\\r", "f 1 2 \\\r3", "f 1 2 \\\r\n",
    "f 1 2 -", "f 1 2 3//", "f 1 2 3//x", "f 1 2 3//0", "f 1 2 42949672970",
    "v 1 2", "v 1 2 #3", "vt 1", "f 1 2 3x", "f 1 2 3/x", "f 1/2 2 3",
    "f 1 2 3/", "f 1/ 2 3",
  };
#define MESH "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n"

  for (guint i = 0; i < G_N_ELEMENTS (good); i++) {
    g_autofree gchar *text = g_strconcat (MESH, good[i].text, NULL);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothObj) obj = cloth_obj_parse (text, strlen (text), &error);

    g_assert_no_error (error);
    g_assert_cmpuint (obj->topology->n_vertices, ==, 3);
    g_assert_cmpuint (obj->topology->n_faces, ==, good[i].n_faces);
  }
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_autofree gchar *text = g_strconcat (MESH, bad[i], NULL);
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_obj_parse (text, strlen (text), &error));
    g_test_message ("%s: %s", bad[i], error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  }
  {
    static const gchar zero[] = MESH "f 1 2 3\0", seam[] = MESH "vt 0 1\n"
        "f 1/1 2/1 3/1\nf 1/2 2/1 3/1\nf 1/1 2/1 3/1\n";
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothObj) obj = cloth_obj_parse (seam, strlen (seam), &error);

    g_assert_no_error (error);
    g_assert_cmpuint (obj->n_seam_vertices, ==, 1);
    g_assert_null (cloth_obj_parse (zero, sizeof zero - 1, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_nonnull (strstr (error->message, "no text"));
  }
}

/* Every type of number, and what means nothing to us: elements without properties, a
 * face's colour and a list that is not its corners, a u without a v. */
static void
test_ply_tolerance (void)
{
  static const gchar head[] = "ply\nformat binary_little_endian 1.0\n"
      "element nothing 0\nelement vertex 3\nproperty short x\n"
      "property ushort y\nproperty char z\nproperty float u\n"
      "element face 1\nproperty list uchar uchar other\n"
      "property uchar red\nproperty list ushort uint vertex_indices\n"
      "end_header\n";
  static const guint8 data[] = {
    0xfe, 0xff, 0xfe, 0xff, 0xfd, 0, 0, 0x80, 0x3f,
    1, 0, 2, 0, 3, 0, 0, 0, 0x40,
    0, 1, 0, 2, 127, 0, 0, 0, 0,
    2, 7, 7, 255, 3, 0, 2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0
  };
  static const gfloat positions[] = { -2, 65534, -3, 1, 2, 3, 256, 512, 127 };
  static const guint32 face[] = { 2, 1, 0, CLOTH_NO_VERTEX };
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  g_autoptr (ClothPly) ply = cloth_ply_new ();
  g_autoptr (GError) error = NULL;

  g_byte_array_append (bytes, (const guint8 *) head, sizeof head - 1);
  g_byte_array_append (bytes, data, sizeof data);
  g_assert_true (cloth_ply_parse (ply, (const gchar *) bytes->data,
          bytes->len - 1, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (ply->n_vertices, ==, 3);
  g_assert_cmpmem (ply->positions, 36, positions, sizeof positions);
  g_assert_false (ply->has_uv);
  g_assert_cmpuint (ply->n_faces, ==, 1);
  g_assert_cmpmem (ply->faces->data, 16, face, sizeof face);
}

/* A triangle has three corners in the file. */
static void
test_ply_triangle (void)
{
  g_autoptr (ClothTopology) topology = cloth_topology_new (3, 1);
  static const guint32 face[] = { 0, 1, 2, CLOTH_NO_VERTEX };
  static const gfloat positions[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
  static const guint8 states[] = { 1, 1, 1 };
  ClothMeshFrame frame = { positions, states, NULL };
  g_autoptr (ClothMeshWriter) writer = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;

  memcpy (topology->faces, face, sizeof face);
  scratch_begin ();
  path = scratch_path ("t.ply");
  writer = cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO, "t", topology,
      25, 1, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_mesh_writer_append (writer, 0, &frame, &error));
  g_assert_true (cloth_mesh_writer_close (writer, &error));
  peer_run ("d=open('t_00000.ply','rb').read()\n"
      "assert struct.unpack('<B3I',d[-13:])==(3,0,1,2)\n"
      "assert len(d.split(b'end_header\\n',1)[1])==3*21+13\n");
  scratch_end ();
}

/* One vertex, or one face, more than is accepted. */
static void
test_too_many (void)
{
  static const gchar vertex[] = "v 0 0 0\n";
  g_autoptr (GString) text = g_string_new (NULL);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPly) ply = cloth_ply_new ();

  for (guint i = 0; i <= CLOTH_MAX_VERTICES; i++)
    g_string_append_len (text, vertex, sizeof vertex - 1);
  g_assert_null (cloth_obj_parse (text->str, text->len, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
  g_assert_true (g_str_has_prefix (error->message, "line 1000001 "));
  g_clear_error (&error);

  g_string_assign (text, "v 0 0 0\nf");
  for (guint i = 0; i <= CLOTH_MAX_FACES; i++)
    g_string_append (text, " 1");
  g_assert_null (cloth_obj_parse (text->str, text->len, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
  g_assert_true (g_str_has_prefix (error->message, "line 2 "));
  g_clear_error (&error);

  /* Each of these faces is 253 triangles. */
  g_string_assign (text, "ply\nformat binary_little_endian 1.0\n"
      "element vertex 1\nproperty char x\nproperty char y\nproperty char z\n"
      "element face 8000\nproperty list uchar uchar vertex_index\n"
      "end_header\n");
  g_string_set_size (text, text->len + 3);
  memset (text->str + text->len - 3, 0, 3);
  for (guint i = 0; i < 8000; i++) {
    g_string_append_c (text, '\xff');
    g_string_set_size (text, text->len + 255);
    memset (text->str + text->len - 255, 0, 255);
  }
  g_assert_false (cloth_ply_parse (ply, text->str, text->len, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
  g_assert_nonnull (strstr (error->message, "too many faces"));
}

/* Files that the memory does not take are refused by their size: this one is all hole. */
static void
test_too_large (void)
{
  static const gchar *const names[] = { "a.obj", "a.ply" };

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = scratch_path (names[i]);
    g_autoptr (ClothPly) ply = cloth_ply_new ();
    g_autoptr (GError) error = NULL;

    scratch_write (names[i], "x\n", -1);
    g_assert_cmpint (truncate (path, (off_t) CLOTH_MAX_BUFFER + 1), ==, 0);
    if (i == 0)
      g_assert_null (cloth_obj_read (path, &error));
    else
      g_assert_false (cloth_ply_read (ply, path, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
    g_assert_true (g_str_has_prefix (error->message, path));
  }
  scratch_end ();
}

static const struct
{
  const gchar *text;
  gint code;
} bad_obj[] = {
  {"", CLOTH_FILE_ERROR_LIMIT},
  {"f 1 2 3\n", CLOTH_FILE_ERROR_LIMIT},
  {"v 0 0\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 nan\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 1e99\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 x\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0\n1\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1 1\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1 1 2\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1 1 0\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1 1 -2\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1 1 4294967297\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1 1 1.5\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1/1 1/1 1/1\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nvt inf 0\n", CLOTH_FILE_ERROR_INVALID},
  {"v 0 0 0\nf 1/ 1/x 1\n", CLOTH_FILE_ERROR_INVALID},
};

static const struct
{
  const gchar *text;
  gint code;
} bad_ply[] = {
  {"", CLOTH_FILE_ERROR_INVALID},
  {"plx\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nend_header\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 2.0\n", CLOTH_FILE_ERROR_UNSUPPORTED},
  {"ply\nformat ascii 1.0\nend_header\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 999999999999\n",
      CLOTH_FILE_ERROR_LIMIT},
  {"ply\nformat ascii 1.0\nelement vertex -1\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nproperty float x\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty quux x\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
        "property float x\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 1\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement junk 100000000\nend_header\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
        "property float y\nend_header\n1 2\n", CLOTH_FILE_ERROR_INVALID},
#define XYZ "property float x\nproperty float y\nproperty float z\n"
  {"ply\nformat ascii 1.0\nelement vertex 1000000\n" XYZ "end_header\n1 2 3\n",
      CLOTH_FILE_ERROR_TRUNCATED},
  {"ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ
        "end_header\nabcdefghijk", CLOTH_FILE_ERROR_TRUNCATED},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "end_header\n1 2 inf\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "end_header\n1 nan 2\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "property uchar state\n"
        "end_header\n1 2 3 5\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\n"
        "property list uchar int vertex_indices\nend_header\n1 2 3 3 0 0 1\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\n"
        "property list uchar int vertex_indices\nend_header\n1 2 3 2 0 0\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\n\nend_header\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\ncomment\nobj_info x\nformat ascii 1.0\nformat ascii 1.0\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 0\n" XYZ "end_header\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement junk 1\nelement vertex 1\n" XYZ
        "end_header\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty list char quux x\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement junk 1\nproperty list char int x\n"
        "element vertex 1\n" XYZ "end_header\n-1\n1 2 3\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement junk 1\nproperty list int16 uint16 x\n"
        "element vertex 1\n" XYZ "end_header\n9 1\n1 2 3\n",
      CLOTH_FILE_ERROR_TRUNCATED},
  {"ply\nformat binary_big_endian 1.0\nelement junk 1\n"
        "property list char short x\nelement vertex 1\n" XYZ "end_header\n"
        "\xff" "0123456789abcdef", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "property float u\n"
        "property float v\nend_header\n1 2 3 nan 0\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "property char state\n"
        "end_header\n1 2 3 -1\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\n"
        "property list uchar int vertex_indices\nend_header\n1 2 3 3 0 0 -1\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\n"
        "property list uint int vertex_indices\nend_header\n1 2 3 256 0 0 0\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\n"
        "property list uchar int vertex_indices\nend_header\n1 2 3 3 0 0\n",
      CLOTH_FILE_ERROR_TRUNCATED},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\n"
        "property list uchar int vertex_indices\nend_header\n1 2 3 ",
      CLOTH_FILE_ERROR_TRUNCATED},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "end_header\n1 2 x\n",
      CLOTH_FILE_ERROR_TRUNCATED},
  {"ply\nformat ascii 1.0\nelement junk 1\nproperty list char int x\n"
        "end_header\n\n", CLOTH_FILE_ERROR_TRUNCATED},
  {"ply\nformat ascii 1.0\nelement junk 1\nproperty list char int x\n"
        "end_header\n1e10\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement junk 1\nproperty list char int x\n"
        "end_header\nnan\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\n"
        "property list uchar int vertex_indices\nend_header\n1 2 3 nan\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "property float cov_xx\n"
        "end_header\n1 2 3 inf\n", CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "property float u\n"
        "property float v\nend_header\n1 2 3 0 -inf\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty list int32 float\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty map int32 float x\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii 1.0\nelement vertex 1\nproperty list quux int x\n",
      CLOTH_FILE_ERROR_INVALID},
  {"ply\nformat ascii\n", CLOTH_FILE_ERROR_UNSUPPORTED},
  {"ply\nformat binary_middle_endian 1.0\n", CLOTH_FILE_ERROR_UNSUPPORTED},
  {"ply\nformat ascii 1.0\nelement a 0\nelement b 0\nelement c 0\n"
        "element d 0\nelement e 0\nelement f 0\nelement g 0\nelement h 0\n"
        "element i 0\nelement j 0\nelement k 0\nelement l 0\nelement m 0\n"
        "element n 0\nelement o 0\nelement p 0\nelement q 0\n",
      CLOTH_FILE_ERROR_INVALID},
};

static void
test_hostile_text (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (bad_obj); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_obj_parse (bad_obj[i].text, strlen (bad_obj[i].text),
            &error));
    g_test_message ("obj %u: %s", i, error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, bad_obj[i].code);
  }
  {
    static const gchar zero[] = "ply\nformat ascii 1.0\nelement vertex\0 1\n";
    g_autoptr (GString) text = g_string_new ("ply\nformat ascii 1.0\n"
        "element vertex 1\n");
    g_autoptr (ClothPly) ply = cloth_ply_new ();
    g_autoptr (GError) error = NULL;

    g_assert_false (cloth_ply_parse (ply, zero, sizeof zero - 1, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_clear_error (&error);
    for (guint i = 0; i < 1000; i++)
      g_string_append_printf (text, "property float p%u\n", i);
    g_assert_false (cloth_ply_parse (ply, text->str, text->len, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_nonnull (strstr (error->message, "too many"));
  }
  for (guint i = 0; i < G_N_ELEMENTS (bad_ply); i++) {
    g_autoptr (ClothPly) ply = cloth_ply_new ();
    g_autoptr (GError) error = NULL;

    g_assert_false (cloth_ply_parse (ply, bad_ply[i].text,
            strlen (bad_ply[i].text), &error));
    g_test_message ("ply %u: %s", i, error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, bad_ply[i].code);
  }
}

static void
test_hostile_pc2 (void)
{
  static const struct
  {
    gint32 version, points;
    gfloat start, rate;
    gint32 samples;
    gint code;
  } cases[] = {
    {2, 1, 0, 1, 1, CLOTH_FILE_ERROR_INVALID},
    {1, 0, 0, 1, 1, CLOTH_FILE_ERROR_LIMIT},
    {1, -5, 0, 1, 1, CLOTH_FILE_ERROR_LIMIT},
    {1, 2000000, 0, 1, 0, CLOTH_FILE_ERROR_LIMIT},
    {1, 1, 0, 1, -1, CLOTH_FILE_ERROR_INVALID},
    {1, 1, NAN, 1, 1, CLOTH_FILE_ERROR_INVALID},
    {1, 1, 0, 0, 1, CLOTH_FILE_ERROR_INVALID},
    {1, 1, 0, INFINITY, 1, CLOTH_FILE_ERROR_INVALID},
    {1, 1, 0, 1, 3, CLOTH_FILE_ERROR_TRUNCATED},
    {1, 1000000, 0, 1, G_MAXINT32, CLOTH_FILE_ERROR_TRUNCATED},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    guint8 bytes[56] = "POINTCACHE2";
    g_autoptr (GError) error = NULL;

    memcpy (bytes + 12, &cases[i].version, 4);
    memcpy (bytes + 16, &cases[i].points, 4);
    memcpy (bytes + 20, &cases[i].start, 4);
    memcpy (bytes + 24, &cases[i].rate, 4);
    memcpy (bytes + 28, &cases[i].samples, 4);
    cloth_swap_little_endian (bytes + 12, 4, 5);
    g_assert_null (cloth_pc2_reader_new (cloth_input_new_memory (bytes,
                sizeof bytes), &error));
    g_assert_error (error, CLOTH_FILE_ERROR, cases[i].code);
  }
  {
    guint8 bytes[32] = "POINTCACHE3";
    g_autoptr (GError) error = NULL;

    bytes[12] = 1;
    g_assert_null (cloth_pc2_reader_new (cloth_input_new_memory (bytes,
                sizeof bytes), &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_cmpstr (error->message, ==, "not a PC2 file of version 1");
    g_clear_error (&error);
    g_assert_null (cloth_pc2_reader_new (cloth_input_new_memory (bytes,
                sizeof bytes - 1), &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED);
  }
}

/* Samples that are not there, or no longer. */
static void
test_pc2_samples (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (ClothPc2Reader) reader = NULL;
  g_autoptr (GError) error = NULL;
  gfloat positions[3 * N];

  g_assert_null (cloth_pc2_reader_open ("/nonexistent.pc2", &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);
  scratch_begin ();
  write_sequence ("c.obj", CLOTH_MESH_FORMAT_AUTO, FRAMES);
  path = scratch_path ("c.pc2");
  reader = cloth_pc2_reader_open (path, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_pc2_reader_read (reader, FRAMES - 1, positions, &error));
  g_assert_cmpfloat (positions[2], ==, (FRAMES - 1) * (FRAMES - 1));
  g_assert_false (cloth_pc2_reader_read (reader, FRAMES, positions, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_cmpstr (error->message, ==, "sample 7 of 7");
  g_clear_error (&error);
  g_assert_cmpint (truncate (path, 32 + 12 * N), ==, 0);
  g_assert_false (cloth_pc2_reader_read (reader, 1, positions, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED);
  scratch_end ();
}

static void
expect_open_error (const gchar * name)
{
  g_autofree gchar *path = scratch_path (name);
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error));
  g_test_message ("%s", error->message);
  g_assert_nonnull (error);
}

static void
test_sets_that_do_not_fit (void)
{
  scratch_begin ();
  write_sequence ("c.obj", CLOTH_MESH_FORMAT_AUTO, FRAMES);
  peer_run ("np.save('c.states.npy',np.zeros((7,19),'u1'))");
  expect_open_error ("c.obj");
  peer_run ("os.remove('c.states.npy')\n"
      "d=bytearray(open('c.pc2','rb').read()); d[16]=21\n"
      "open('c.pc2','wb').write(d)");
  expect_open_error ("c.obj");
  expect_open_error ("nothing.obj");
  expect_open_error ("nothing.ply");
  expect_open_error ("nothing.take");
  /* The mesh changes in the middle of a PLY sequence. */
  write_sequence ("p.ply", CLOTH_MESH_FORMAT_AUTO, 3);
  scratch_write ("p_00001.ply", "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
      "end_header\n1 2 3\n", -1);
  {
    g_autofree gchar *path = scratch_path ("p.ply");
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothMeshReader) reader =
        cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
    ClothMeshFrame contents;

    g_assert_no_error (error);
    g_assert_false (cloth_mesh_reader_read (reader, 1, &contents, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_clear_error (&error);
    g_assert_false (cloth_mesh_reader_read (reader, 3, &contents, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  }
  scratch_end ();
}

/* What a location means, and what the names of its files begin with. */
static void
test_locations (void)
{
  static const struct
  {
    const gchar *location;
    ClothMeshFormat format;
    const gchar *stem;
  } cases[] = {
    {"a.obj", CLOTH_MESH_FORMAT_OBJ_PC2, "a"},
    {"a.PC2", CLOTH_MESH_FORMAT_OBJ_PC2, "a"},
    {"b", CLOTH_MESH_FORMAT_OBJ_PC2, "b"},
    {"a_%05d.ply", CLOTH_MESH_FORMAT_PLY, "a"},
    {"a.ply", CLOTH_MESH_FORMAT_PLY, "a"},
    {"a.take", CLOTH_MESH_FORMAT_TAKE, "a.take"},
    {"a.take/", CLOTH_MESH_FORMAT_TAKE, "a.take"},
    {"a//", CLOTH_MESH_FORMAT_TAKE, "a"},
    {"/", CLOTH_MESH_FORMAT_TAKE, "/"},
    {"take.json", CLOTH_MESH_FORMAT_TAKE, "."},
    {"a/take.json", CLOTH_MESH_FORMAT_TAKE, "a"},
    {"a//take.json", CLOTH_MESH_FORMAT_TAKE, "a"},
    {"a.vtp", CLOTH_MESH_FORMAT_VTP, "a"},
    {"a.pvd", CLOTH_MESH_FORMAT_VTP, "a"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    ClothMeshFormat format = cloth_mesh_format_guess (cases[i].location);
    g_autofree gchar *stem = cloth_mesh_format_stem (cases[i].location, format);

    g_test_message ("%s: %s", cases[i].location, stem);
    g_assert_cmpint (format, ==, cases[i].format);
    g_assert_cmpstr (stem, ==, cases[i].stem);
  }
}

/* A point cache or its states that do not fit the mesh: which of them is wrong. */
static void
test_caches_that_do_not_fit (void)
{
  static const struct
  {
    const gchar *script, *says;
  } cases[] = {
    {"d[16]=19", "c.pc2 has 19 points, the OBJ file 20 vertices"},
    {"d[28]=0", "the point cache has no samples"},
    {"d[24:28]=b'\\0'*4", "c.pc2: the PC2 file has a negative number"},
    {"np.save('c.states.npy',np.zeros((7,20),'i4'))", "c.states.npy does not"},
    {"np.save('c.states.npy',np.zeros(140,'u1'))", "c.states.npy does not"},
    {"np.save('c.states.npy',np.zeros((6,20),'u1'))", "c.states.npy does not"},
    {"np.save('c.states.npy',np.zeros((7,21),'u1'))", "c.states.npy does not"},
    {"open('c.states.npy','wb').write(b'')", "c.states.npy: 10 bytes wanted"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = NULL, *script = NULL;
    g_autoptr (GError) error = NULL;

    scratch_begin ();
    path = scratch_path ("c.obj");
    write_sequence ("c.obj", CLOTH_MESH_FORMAT_AUTO, FRAMES);
    script = g_strdup_printf ("d=bytearray(open('c.pc2','rb').read())\n%s\n"
        "open('c.pc2','wb').write(d)", cases[i].script);
    peer_run (script);
    g_assert_null (cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO,
            &error));
    g_test_message ("%s", error->message);
    g_assert_cmpint (error->domain, ==, CLOTH_FILE_ERROR);
    g_assert_nonnull (strstr (error->message, cases[i].says));
    scratch_end ();
  }
}

/* What shows only at the frame: the files change while they are read, or hold there what
 * is no place and no state. */
static void
test_broken_frames (void)
{
  static const struct
  {
    const gchar *name, *script;
    ClothFileError code;
  } cases[] = {
    {"c.obj", "os.truncate('c.pc2',100)", CLOTH_FILE_ERROR_TRUNCATED},
    {"c.obj", "os.truncate('c.states.npy',100)", CLOTH_FILE_ERROR_TRUNCATED},
    {"c.obj", "f=open('c.pc2','r+b'); f.seek(32+4*240); "
          "f.write(struct.pack('<f',np.inf))", CLOTH_FILE_ERROR_INVALID},
    {"c.obj", "f=open('c.states.npy','r+b'); f.seek(-3*20,2); f.write(b'\\5')",
        CLOTH_FILE_ERROR_INVALID},
    {"c.take", "os.truncate('c.take/states.npy',130)",
        CLOTH_FILE_ERROR_TRUNCATED},
    {"c.take", "os.truncate('c.take/covariance.npy',130)",
        CLOTH_FILE_ERROR_TRUNCATED},
    {"c.ply", "os.truncate('c_00004.ply',100)", CLOTH_FILE_ERROR_INVALID},
    {"c.ply", "d=open('c_00004.ply','rb').read().replace(b'face 12',b'face 11')"
          "\nopen('c_00004.ply','wb').write(d)", CLOTH_FILE_ERROR_INVALID},
    {"c.ply", "f=open('c_00004.ply','r+b'); f.seek(-1,2); "
          "f.seek(-3,1); f.write(b'\\0')", CLOTH_FILE_ERROR_INVALID},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = NULL;
    g_autoptr (ClothMeshReader) reader = NULL;
    g_autoptr (GError) error = NULL;
    ClothMeshFrame contents;

    scratch_begin ();
    path = scratch_path (cases[i].name);
    write_sequence (cases[i].name, CLOTH_MESH_FORMAT_AUTO, FRAMES);
    reader = cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
    g_assert_no_error (error);
    g_assert_true (cloth_mesh_reader_read (reader, 4, &contents, &error));
    peer_run (cases[i].script);
    g_assert_false (cloth_mesh_reader_read (reader, 4, &contents, &error));
    g_test_message ("%s", error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, (gint) cases[i].code);
    scratch_end ();
  }
}

/* A mesh without a cache is one frame; a cloud of points has no faces. */
static void
test_lone_files (void)
{
  g_autofree gchar *obj = NULL, *ply = NULL;
  ClothMeshFrame contents;

  scratch_begin ();
  obj = scratch_path ("a.obj");
  ply = scratch_path ("p.ply");
  scratch_write ("a.obj", "v 1 2 3\nv 4 5 6\nv 7 8 9\nf 1 2 3\n", -1);
  scratch_write ("p_00000.ply", "ply\nformat ascii 1.0\nelement vertex 2\n" XYZ
      "end_header\n1 2 3\n4 5 6\n", -1);
  for (guint i = 0; i < 2; i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothMeshReader) reader = cloth_mesh_reader_open (i ? ply : obj,
        CLOTH_MESH_FORMAT_AUTO, &error);

    g_assert_no_error (error);
    g_assert_cmpuint (cloth_mesh_reader_get_n_frames (reader), ==, 1);
    g_assert_cmpuint (cloth_mesh_reader_get_topology (reader)->n_faces, ==,
        i ? 0 : 1);
    g_assert_true (cloth_mesh_reader_read (reader, 0, &contents, &error));
    g_assert_cmpfloat (contents.positions[5], ==, 6);
    g_assert_cmpuint (contents.states[1], ==, CLOTH_VERTEX_MEASURED);
  }
  scratch_end ();
}

/* The uv of a print's grid are so many cells each, rounded otherwise than the parts of its
 * width. The take has a grid all the same, unless a vertex is off by more than rounding, and
 * every format gives it back. */
static void
test_summed_grids (void)
{
  const gdouble edge_m[2] = { 0.63 / 32, 0.67 / 34 };

  for (guint i = 0; i < 2; i++) {
    const gfloat off = i ? 1e-5f : 0;
    g_autoptr (ClothTopology) topology = cloth_topology_new_grid (33, 35, 1, 1);
    g_autofree gfloat *positions = g_new0 (gfloat, (gsize) 3 * 33 * 35);
    g_autofree guint8 *states = g_new (guint8, 33 * 35);
    const ClothMeshFrame frame = { positions, states, NULL };
    guint n_rounded = 0;

    memset (states, 1, 33 * 35);
    for (guint k = 0; k < 33 * 35; k++) {
      topology->uv[2 * k] = (gfloat) ((k % 33) * edge_m[0]);
      topology->uv[2 * k + 1] = (gfloat) ((k / 33) * edge_m[1]);
      n_rounded += topology->uv[2 * k + 1] !=
          (gfloat) ((gdouble) 0.67f * (k / 33) / 34);
    }
    g_assert_cmpuint (n_rounded, >, 0);
    topology->uv[2 * 40] += off;
    scratch_begin ();
    for (guint k = 0; k < 3; k++) {
      static const gchar *const names[] = { "g.take", "g.obj", "g.ply" };
      g_autofree gchar *path = scratch_path (names[k]);
      g_autoptr (ClothMeshWriter) writer = cloth_mesh_writer_new (path,
          CLOTH_MESH_FORMAT_AUTO, NULL, topology, 25, 1, NULL);
      g_autoptr (ClothMeshReader) reader = NULL;
      g_autoptr (GError) error = NULL;
      const ClothTopology *got;

      g_assert_true (cloth_mesh_writer_append (writer, 0, &frame, &error));
      g_assert_true (cloth_mesh_writer_close (writer, &error));
      reader = cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
      g_assert_no_error (error);
      got = cloth_mesh_reader_get_topology (reader);
      g_assert_cmpuint (got->columns, ==, 33);
      g_assert_cmpuint (got->rows, ==, 35);
      for (guint v = 0; v < 2 * 33 * 35; v++)
        g_assert_cmpfloat_with_epsilon (got->uv[v], topology->uv[v], 1e-6);
    }
    peer_run (i ?
        "import json\nassert json.load(open('g.take/take.json'))['mesh']=='mesh.obj'\n"
        : "import json\nj=json.load(open('g.take/take.json'))\n"
        "assert j['grid']=={'columns':33,'rows':35,'width_m':.63,"
        "'height_m':.67},j['grid']\n"
        "assert not os.path.exists('g.take/mesh.obj')\n");
    scratch_end ();
  }
}

/* A take has a grid only when its sizes give the very mesh. */
static void
test_grids_of_takes (void)
{
  static const struct
  {
    guint columns, rows;
    gfloat width, height;
    gboolean grid;
  } cases[] = {
    {3, 2, 0.63f, 1, TRUE}, {3, 2, 1 / 3.f, 1, TRUE}, {0, 2, 1, 1, FALSE},
    {3, 0, 1, 1, FALSE}, {3, 2, 1e-7f, 1, FALSE}, {3, 2, 1, 1e-7f, FALSE},
    {3, 2, 2e6f, 1, FALSE}, {3, 2, 1, 2e6f, FALSE}, {3, 2, 1e-6f, 1e6f, TRUE},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (ClothTopology) topology = cloth_topology_new_grid (3, 2,
        cases[i].width, cases[i].height);
    g_autoptr (ClothMeshWriter) writer = NULL;
    g_autoptr (ClothTake) take = NULL;
    g_autoptr (GError) error = NULL;
    g_autofree gchar *path = NULL;
    static const gfloat positions[18] = { 0 };
    static const guint8 states[6] = { 1, 1, 1, 1, 1, 1 };
    ClothMeshFrame frame = { positions, states, NULL };

    topology->columns = cases[i].columns;
    topology->rows = cases[i].rows;
    scratch_begin ();
    path = scratch_path ("g.take");
    writer = cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO, NULL,
        topology, 0, 1, &error);
    g_assert_no_error (error);
    g_assert_true (cloth_mesh_writer_append (writer, 0, &frame, &error));
    g_assert_true (cloth_mesh_writer_close (writer, &error));
    g_assert_no_error (error);
    take = cloth_take_open (path, &error);
    g_assert_no_error (error);
    g_assert_cmpfloat (cloth_take_get_info (take)->fps, ==, 0);
    g_assert_cmpstr (cloth_take_get_info (take)->mesh, ==,
        cases[i].grid ? NULL : "mesh.obj");
    g_assert_cmpfloat (cloth_take_get_topology (take)->uv[10], ==,
        cases[i].width);
    scratch_end ();
  }
  {
    g_autoptr (ClothTopology) nothing = cloth_topology_new (0, 0);
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_mesh_writer_new ("/nonexistent/a.take",
            CLOTH_MESH_FORMAT_AUTO, NULL, nothing, 0, 1, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
  }
}

static void
test_abort_and_replace (void)
{
  static const gchar *const names[] = { "c.obj", "c.ply", "c.take" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = NULL;
    ClothMeshWriter *writer;
    g_autoptr (GError) error = NULL;

    scratch_begin ();
    path = scratch_path (names[i]);
    /* Nothing under its name before the close, nothing at all after an abort. */
    writer = write_frames (path, CLOTH_MESH_FORMAT_AUTO, 3);
    g_assert_cmpuint (scratch_count (), >, 0);
    expect_open_error (names[i]);
    cloth_mesh_writer_free (writer);
    g_assert_cmpuint (scratch_count (), ==, 0);
    /* An empty sequence is refused. */
    writer = write_frames (path, CLOTH_MESH_FORMAT_AUTO, 0);
    g_assert_false (cloth_mesh_writer_close (writer, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    cloth_mesh_writer_free (writer);
    g_assert_cmpuint (scratch_count (), ==, 0);
    /* A shorter one replaces a longer one, whole. */
    write_sequence (names[i], CLOTH_MESH_FORMAT_AUTO, FRAMES + 5);
    write_sequence (names[i], CLOTH_MESH_FORMAT_AUTO, FRAMES);
    check_sequence (names[i], i > 0);
    scratch_end ();
  }
}

static void
test_refused_frames (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (ClothMeshWriter) writer = NULL;
  g_autoptr (GError) error = NULL;
  gfloat positions[3 * N] = { 0 };
  guint8 states[N] = { 0 };
  ClothMeshFrame contents = { positions, states, NULL };

  scratch_begin ();
  path = scratch_path ("c.obj");
  writer = write_frames (path, CLOTH_MESH_FORMAT_AUTO, 1);
  positions[4] = INFINITY;
  g_assert_false (cloth_mesh_writer_append (writer, 1, &contents, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_clear_error (&error);
  positions[4] = NAN;
  g_assert_false (cloth_mesh_writer_append (writer, 1, &contents, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_clear_error (&error);
  positions[4] = 0;
  states[3] = 9;
  g_assert_false (cloth_mesh_writer_append (writer, 1, &contents, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  scratch_end ();
}

/* A strip of which one end was seen takes that end's place; a part that is joined to
 * nothing seen lies flat. */
static void
test_hold_unseen_parts (void)
{
  g_autoptr (ClothTopology) topology = cloth_topology_new (8, 2);
  static const guint32 faces[] = { 0, 1, 2, 3, 4, 5, 6, CLOTH_NO_VERTEX };
  g_autoptr (ClothHold) hold = NULL;
  gfloat positions[24];
  const gfloat *shown;

  memcpy (topology->faces, faces, sizeof faces);
  for (guint i = 0; i < 16; i++)
    topology->uv[i] = (gfloat) i;
  hold = cloth_hold_new (topology);
  for (guint i = 0; i < 24; i++)
    positions[i] = NAN;
  shown = cloth_hold_apply (hold, positions);
  g_assert_cmpfloat (shown[3 * 5], ==, 10);
  g_assert_cmpfloat (shown[3 * 5 + 1], ==, 11);
  g_assert_cmpfloat (shown[3 * 5 + 2], ==, 0);
  positions[0] = 100;
  positions[1] = 200;
  positions[2] = 300;
  shown = cloth_hold_apply (hold, positions);
  for (guint i = 0; i < 4; i++)
    for (guint k = 0; k < 3; k++)
      g_assert_cmpfloat (shown[3 * i + k], ==, (gfloat) (100 * (k + 1)));
  g_assert_cmpfloat (shown[3 * 7], ==, 14);
}

static void
test_paths_stay_inside (void)
{
  static const gchar *const bad[] = { "", "/etc/passwd", "../a", "a/../../b",
    "link", "dir/passwd"
  };
  g_autofree gchar *link = NULL, *dir = NULL, *found = NULL;
  g_autoptr (GError) error = NULL;

  scratch_begin ();
  link = scratch_path ("link");
  dir = scratch_path ("dir");
  g_assert_cmpint (symlink ("/etc/passwd", link), ==, 0);
  g_assert_cmpint (symlink ("/etc", dir), ==, 0);
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_autoptr (GError) fault = NULL;

    g_assert_null (cloth_path_inside (scratch, bad[i], &fault));
    g_assert_error (fault, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  }
  scratch_write ("a", "x", 1);
  found = cloth_path_inside (scratch, "a", &error);
  g_assert_no_error (error);
  g_assert_nonnull (found);
  g_assert_null (cloth_path_inside (scratch, "b", &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  scratch_end ();
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/meshfiles/obj-pc2", test_obj_pc2);
  g_test_add_func ("/meshfiles/ply", test_ply);
  g_test_add_func ("/meshfiles/foreign", test_foreign_files);
  g_test_add_func ("/meshfiles/obj-tolerance", test_obj_tolerance);
  g_test_add_func ("/meshfiles/obj-ends", test_obj_ends);
  g_test_add_func ("/meshfiles/ply-tolerance", test_ply_tolerance);
  g_test_add_func ("/meshfiles/ply-triangle", test_ply_triangle);
  g_test_add_func ("/meshfiles/too-many", test_too_many);
  g_test_add_func ("/meshfiles/too-large", test_too_large);
  g_test_add_func ("/meshfiles/hold-unseen-parts", test_hold_unseen_parts);
  g_test_add_func ("/meshfiles/hostile-text", test_hostile_text);
  g_test_add_func ("/meshfiles/hostile-pc2", test_hostile_pc2);
  g_test_add_func ("/meshfiles/pc2-samples", test_pc2_samples);
  g_test_add_func ("/meshfiles/sets-that-do-not-fit",
      test_sets_that_do_not_fit);
  g_test_add_func ("/meshfiles/locations", test_locations);
  g_test_add_func ("/meshfiles/caches-that-do-not-fit",
      test_caches_that_do_not_fit);
  g_test_add_func ("/meshfiles/broken-frames", test_broken_frames);
  g_test_add_func ("/meshfiles/lone-files", test_lone_files);
  g_test_add_func ("/meshfiles/summed-grids", test_summed_grids);
  g_test_add_func ("/meshfiles/grids-of-takes", test_grids_of_takes);
  g_test_add_func ("/meshfiles/abort-and-replace", test_abort_and_replace);
  g_test_add_func ("/meshfiles/refused-frames", test_refused_frames);
  g_test_add_func ("/meshfiles/paths-stay-inside", test_paths_stay_inside);
  return g_test_run ();
}
