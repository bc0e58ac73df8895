/* Bullet's soft bodies behind the contract of docs/own-simulator.md (Bullet 3.24, package
 * libbullet-dev). Build it with
 *
 *   c++ -O2 -o bullet-cloth pipelines/simulators/bullet.cc \
 *       $(pkg-config --cflags --libs bullet json-glib-1.0)
 *
 * and ask it with
 *
 *   gst-cloth-gap-1.0 check-simulator ./bullet-cloth --scene TAKE
 *
 * Links are moved to their lengths by shares (kLST of a link, from 0 to 1), not by forces: the
 * same numbers are stiffer with more iterations or shorter steps. So these are settings here,
 * which no fit moves. kAST is not listed: nothing in Bullet reads it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#include <json-glib/json-glib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using std::string;
using std::vector;

struct Parameter {
  const char *name, *unit;
  double value;
  const char *range, *is, *scale, *blurb;
};

const Parameter parameters[] = {
  {"mass", "kg/m²", 0.187, "[0.02, 2]", "\"areal_density\"", "1", "Mass of a square metre"},
  {"kLST", "1", 0.6, "[0.02, 1]", "[\"stretch.warp\", \"stretch.weft\"]", "null",
   "Linear stiffness of links along the threads"},
  {"kLST_shear", "1", 0.2, "[0.002, 1]", "\"shear\"", "null",
   "Linear stiffness of links across the squares"},
  {"kLST_bending", "1", 0.02, "[0.0005, 1]", "[\"bending.warp\", \"bending.weft\"]", "null",
   "Linear stiffness of links to the second neighbours"},
  {"kDP", "1", 0.001, "[0, 0.05]", "\"damping.mass\"", "500", "Damping, of a step"},
  {"kDG", "1", 0.3, "[0, 10]", "\"effects.air_drag.coefficient\"", "2", "Drag"},
  {"kLF", "1", 0, "null", "null", "null", "Lift"},
  {"kMT", "1", 0, "null", "null", "null", "Pose matching, to the flat cloth"},
  {"wind_x", "m/s", 0, "[-30, 30]", "\"effects.wind.x\"", "0.3", "Velocity of the air along x"},
  {"wind_y", "m/s", 0, "[-30, 30]", "\"effects.wind.y\"", "0.3", "Velocity of the air along y"},
  {"wind_z", "m/s", 0, "[-30, 30]", "\"effects.wind.z\"", "0.3", "Velocity of the air along z"},
  {"gravity", "1", 1, "[0.25, 4]", "\"effects.gravity_scale.factor\"", "1",
   "What gravity is multiplied with"},
  {"gravity_x", "m/s²", 0, "[-5, 5]", "\"effects.gravity_tilt.x\"", "5.84",
   "Gravity along x, more"},
  {"gravity_y", "m/s²", 0, "[-5, 5]", "\"effects.gravity_tilt.y\"", "5.84",
   "Gravity along y, more"},
  {"rest_scale", "1", 0, "[-0.2, 0.2]", "[\"effects.shrinkage.warp\", \"effects.shrinkage.weft\"]",
   "1", "Share that links are shorter by than on the flat cloth"},
  {"kDF", "1", 0.2, "null", "null", "null", "Friction"},
  {"margin", "m", 0.003, "null", "null", "null", "Distance of collisions"},
  {"piterations", "1", 40, "null", "null", "null", "Position iterations of a step"},
  {"steps", "1", 10, "null", "null", "null", "Steps between two frames"},
};

[[noreturn]] void
fail (const string & text)
{
  std::cerr << "bullet-cloth: " << text << std::endl;
  std::exit (1);
}

void
print_capabilities ()
{
  std::cout << "{\"version\": 1, \"simulator\": \"Bullet soft body\", \"simulator_version\": \""
            << BT_BULLET_VERSION / 100 << '.' << BT_BULLET_VERSION % 100
            << "\", \"parameters\": [";
  for (const Parameter & p : parameters)
    std::cout << (&p == parameters ? "" : ", ") << "{\"name\": \"" << p.name
              << "\", \"unit\": \"" << p.unit << "\", \"value\": " << p.value << ", \"range\": "
              << p.range << ", \"is\": " << p.is << ", \"scale\": " << p.scale
              << ", \"blurb\": \"" << p.blurb << "\"}";
  std::cout << "]}" << std::endl;
}

/* ---- files ---- */

struct Array {
  vector < size_t > shape;
  vector < double >values;
};

/* Little-endian float32 and float64 in C order, which is all that the contract has. */
Array
read_npy (const string & path)
{
  std::ifstream file (path, std::ios::binary);
  string bytes ((std::istreambuf_iterator < char >(file)), { });
  Array array;

  if (bytes.size () < 12 || bytes.compare (0, 6, "\x93NUMPY") != 0)
    fail ("no numpy array: " + path);
  size_t head = bytes[6] == 1 ? 10 : 12;
  size_t length = (unsigned char) bytes[8] + 256 * (unsigned char) bytes[9];
  string header = bytes.substr (head, length);
  size_t at = header.find ('(', header.find ("shape"));
  size_t n = 1, size = header.find ("<f4") != string::npos ? 4 : 8;
  std::istringstream shape (header.substr (at + 1, header.find (')', at) - at - 1));

  for (string word; std::getline (shape, word, ',');)
    if (word.find_first_of ("0123456789") != string::npos) {
      array.shape.push_back (std::stoul (word));
      n *= array.shape.back ();
    }
  if (bytes.size () < head + length + n * size)
    fail ("cut off: " + path);
  for (size_t i = 0; i < n; i++) {
    const char *from = bytes.data () + head + length + i * size;
    float single;
    double twice;

    if (size == 4) {
      std::memcpy (&single, from, 4);
      array.values.push_back (single);
    } else {
      std::memcpy (&twice, from, 8);
      array.values.push_back (twice);
    }
  }
  return array;
}

void
write_npy (const string & path, const vector < float >&values, size_t frames, size_t n)
{
  std::ostringstream head;

  head << "{'descr': '<f4', 'fortran_order': False, 'shape': (" << frames << ", " << n
       << ", 3), }";
  string text = head.str ();
  text.append (63 - (10 + text.size ()) % 64, ' ');
  text += '\n';
  std::ofstream file (path, std::ios::binary);
  file.write ("\x93NUMPY\x01\x00", 8);
  file.put ((char) (text.size () % 256)).put ((char) (text.size () / 256));
  file << text;
  file.write (reinterpret_cast < const char *>(values.data ()),
      (std::streamsize) (values.size () * sizeof (float)));
  if (!file)
    fail ("can't write " + path);
}

JsonObject *
read_json (const string & path)
{
  JsonParser *parser = json_parser_new ();
  GError *error = nullptr;

  if (!json_parser_load_from_file (parser, path.c_str (), &error))
    fail (error->message);
  return json_node_get_object (json_parser_get_root (parser));
}

btVector3
get_vector (JsonObject * object, const char *key)
{
  JsonArray *list = json_object_get_array_member (object, key);

  return btVector3 (json_array_get_double_element (list, 0),
      json_array_get_double_element (list, 1), json_array_get_double_element (list, 2));
}

/* ---- the cloth on the table ---- */

struct Cloth {
  vector < btVector3 > flat;
  vector < vector < int >>faces;
};

Cloth
make_grid (JsonObject * grid)
{
  Cloth cloth;
  int columns = (int) json_object_get_int_member (grid, "columns");
  int rows = (int) json_object_get_int_member (grid, "rows");
  double width = json_object_get_double_member (grid, "width_m");
  double height = json_object_get_double_member (grid, "height_m");

  for (int r = 0; r < rows; r++)
    for (int c = 0; c < columns; c++)
      cloth.flat.push_back (btVector3 (c * width / (columns - 1), r * height / (rows - 1), 0));
  for (int r = 0; r + 1 < rows; r++)
    for (int c = 0; c + 1 < columns; c++) {
      int k = r * columns + c;
      cloth.faces.push_back ({ k, k + columns, k + columns + 1, k + 1 });
    }
  return cloth;
}

Cloth
read_obj (const string & path)
{
  Cloth cloth;
  vector < btVector3 > uv;
  std::ifstream file (path);

  for (string line; std::getline (file, line);) {
    std::istringstream words (line);
    string word;
    words >> word;
    if (word == "v") {
      cloth.flat.push_back (btVector3 (0, 0, 0));
    } else if (word == "vt") {
      double u = 0, v = 0;
      words >> u >> v;
      uv.push_back (btVector3 (u, v, 0));
    } else if (word == "f") {
      cloth.faces.emplace_back ();
      while (words >> word) {
        size_t slash = word.find ('/');
        int vertex = std::stoi (word) - 1;
        cloth.faces.back ().push_back (vertex);
        if (slash != string::npos)
          cloth.flat.at (vertex) = uv.at (std::stoi (word.substr (slash + 1)) - 1);
      }
    }
  }
  return cloth;
}

using Pair = std::pair < int, int >;

Pair
sorted (int a, int b)
{
  return { std::min (a, b), std::max (a, b) };
}

/* Links along the sides of faces, across them, and over them: what faces that share a side
 * have opposite of it. */
struct Links {
  std::set < Pair > sides, across, over;
};

Links
find_links (const Cloth & cloth)
{
  Links links;
  std::map < Pair, vector < Pair >> beyond;

  for (const auto & face : cloth.faces) {
    int n = (int) face.size ();
    for (int k = 0; k < n; k++) {
      int a = face[k], b = face[(k + 1) % n];
      links.sides.insert (sorted (a, b));
      /* of a square the corners that continue its two sides */
      beyond[sorted (a, b)].push_back (a < b ? Pair (face[(k + n - 1) % n], face[(k + 2) % n]) :
          Pair (face[(k + 2) % n], face[(k + n - 1) % n]));
    }
    if (n == 4) {
      links.across.insert (sorted (face[0], face[2]));
      links.across.insert (sorted (face[1], face[3]));
    }
  }
  for (const auto & item : beyond)
    if (item.second.size () == 2) {
      links.over.insert (sorted (item.second[0].first, item.second[1].first));
      links.over.insert (sorted (item.second[0].second, item.second[1].second));
    }
  return links;
}

/* ---- the simulation ---- */

struct World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher { &configuration };
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world { &dispatcher, &broadphase, &solver, &configuration };
};

using Numbers = std::map < string, double >;

void
add_obstacle (World & w, JsonObject * obstacle)
{
  string type = json_object_get_string_member (obstacle, "type");
  btTransform at = btTransform::getIdentity ();
  btCollisionShape *shape = nullptr;

  if (type == "sphere") {
    shape = new btSphereShape (json_object_get_double_member (obstacle, "radius_m"));
    at.setOrigin (get_vector (obstacle, "centre"));
  } else if (type == "plane") {
    btVector3 normal = get_vector (obstacle, "normal").normalized ();
    /* Soft bodies touch convex shapes only. */
    shape = new btBoxShape (btVector3 (10, 10, 1));
    shape->setMargin (0);
    at.setRotation (shortestArcQuat (btVector3 (0, 0, 1), normal));
    at.setOrigin (get_vector (obstacle, "point") - normal);
  } else {
    fail ("knows spheres and planes as obstacles, not " + type);
  }
  auto *body = new btRigidBody (0, nullptr, shape);
  body->setWorldTransform (at);
  body->setFriction (1);
  w.world.addRigidBody (body);
}

void
link_all (btSoftBody * body, const std::set < Pair > &pairs, double stiffness)
{
  btSoftBody::Material * material = body->appendMaterial ();
  material->m_kLST = stiffness;
  for (const Pair & pair : pairs)
    body->appendLink (pair.first, pair.second, material);
}

btSoftBody *
make_body (World & w, const Cloth & cloth, const Array & start, const Numbers & p)
{
  Links links = find_links (cloth);
  auto *body = new btSoftBody (&w.world.getWorldInfo (), (int) cloth.flat.size (),
      cloth.flat.data (), nullptr);
  vector < double >area (cloth.flat.size ());

  link_all (body, links.sides, p.at ("kLST"));
  link_all (body, links.across, p.at ("kLST_shear"));
  link_all (body, links.over, p.at ("kLST_bending"));
  for (const auto & face : cloth.faces)
    for (size_t k = 1; k + 1 < face.size (); k++) {
      int corner[3] = { face[0], face[k], face[k + 1] };
      double flat = (cloth.flat[corner[1]] - cloth.flat[corner[0]]).cross (
          cloth.flat[corner[2]] - cloth.flat[corner[0]]).length () / 2;
      body->appendFace (corner[0], corner[1], corner[2]);
      for (int i : corner)
        area[i] += flat / 3;
    }
  for (size_t i = 0; i < area.size (); i++)
    body->setMass ((int) i, area[i] * p.at ("mass"));
  body->m_cfg.aeromodel = btSoftBody::eAeroModel::F_TwoSided;
  body->m_cfg.kDP = p.at ("kDP");
  body->m_cfg.kDG = p.at ("kDG");
  body->m_cfg.kLF = p.at ("kLF");
  body->m_cfg.kMT = p.at ("kMT");
  body->m_cfg.kDF = p.at ("kDF");
  body->m_cfg.piterations = (int) p.at ("piterations");
  /* Obstacles that don't move are soft, 0.1, unless one says otherwise. */
  body->m_cfg.kKHR = 1;
  body->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
  body->getCollisionShape ()->setMargin (p.at ("margin"));
  body->setPose (false, p.at ("kMT") > 0);
  /* Which measures the links where they are, as the first step would do again. */
  body->m_bUpdateRtCst = false;
  for (int i = 0; i < body->m_links.size (); i++) {
    btSoftBody::Link & link = body->m_links[i];
    link.m_rl *= 1 - p.at ("rest_scale");
    link.m_c1 = link.m_rl * link.m_rl;
  }
  for (size_t i = 0; i < cloth.flat.size (); i++) {
    btSoftBody::Node & node = body->m_nodes[(int) i];
    node.m_x = node.m_q = btVector3 (start.values[3 * i], start.values[3 * i + 1],
        start.values[3 * i + 2]);
    node.m_v = btVector3 (0, 0, 0);
  }
  body->updateNormals ();
  body->updateLinkConstants ();
  body->updateBounds ();
  body->setWindVelocity (btVector3 (p.at ("wind_x"), p.at ("wind_y"), p.at ("wind_z")));
  w.world.addSoftBody (body);
  return body;
}

/* Where the logged path of a clamp is between two frames. */
btVector3
along (const Array & clamps, size_t n_held, size_t k, size_t frame, double share)
{
  const double *a = &clamps.values[3 * (frame * n_held + k)];
  const double *b = a + 3 * n_held;

  return btVector3 (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]),
      a[2] + share * (b[2] - a[2]));
}

struct Held {
  int vertex;
  double from, until, mass;
};

vector < Held >
read_held (JsonObject * take)
{
  vector < Held > list;

  if (!json_object_has_member (take, "held"))
    return list;
  JsonArray *array = json_object_get_array_member (take, "held");
  for (guint i = 0; i < json_array_get_length (array); i++) {
    JsonObject *item = json_array_get_object_element (array, i);
    Held held = { (int) json_object_get_int_member (item, "vertex"), -HUGE_VAL, HUGE_VAL, 0 };
    if (json_object_has_member (item, "from_s"))
      held.from = json_object_get_double_member (item, "from_s");
    if (json_object_has_member (item, "until_s"))
      held.until = json_object_get_double_member (item, "until_s");
    list.push_back (held);
  }
  return list;
}

/* One step, in which what is held goes from one place of its path to the next. */
void
step (World & w, btSoftBody * body, const vector < Held > &held, const Array & clamps,
    size_t frame, double from, double to, double time, double dt)
{
  for (size_t k = 0; k < held.size (); k++) {
    bool on = time >= held[k].from && time < held[k].until;
    btSoftBody::Node & node = body->m_nodes[held[k].vertex];
    double inverse = on ? 0 : 1 / held[k].mass;
    /* setMass () would have all links measured anew. */
    if (node.m_im != (btScalar) inverse) {
      node.m_im = inverse;
      body->updateLinkConstants ();
    }
    if (!on)
      continue;
    node.m_x = along (clamps, held.size (), k, frame, from);
    node.m_v = (along (clamps, held.size (), k, frame, to) - node.m_x) / dt;
  }
  w.world.stepSimulation (dt, 0);
  for (size_t k = 0; k < held.size (); k++)
    if (time >= held[k].from && time < held[k].until)
      body->m_nodes[held[k].vertex].m_x = along (clamps, held.size (), k, frame, to);
}

void
simulate (const string & folder)
{
  string scene = folder + "/scene", out = folder + "/simulated";
  JsonObject *take = read_json (scene + "/take.json");
  JsonObject *asked = read_json (folder + "/parameters.json");
  Numbers p;
  for (const Parameter & parameter : parameters)
    p[parameter.name] = json_object_has_member (asked, parameter.name) ?
        json_object_get_double_member (asked, parameter.name) : parameter.value;
  Array start = read_npy (scene + "/positions.npy");
  Array times = read_npy (scene + "/times.npy"), clamps;
  vector < Held > held = read_held (take);
  if (!held.empty ())
    clamps = read_npy (scene + "/clamps.npy");
  Cloth cloth = json_object_has_member (take, "grid") ?
      make_grid (json_object_get_object_member (take, "grid")) :
      read_obj (scene + "/" + json_object_get_string_member (take, "mesh"));

  auto w = std::make_unique < World > ();
  btVector3 gravity = json_object_has_member (take, "gravity") ?
      get_vector (take, "gravity") : btVector3 (0, 0, -9.81);
  gravity = gravity * p["gravity"] + btVector3 (p["gravity_x"], p["gravity_y"], 0);
  w->world.setGravity (gravity);
  w->world.getWorldInfo ().m_gravity = gravity;
  w->world.getWorldInfo ().air_density = 1.2;
  w->world.getWorldInfo ().water_density = 0;
  w->world.getWorldInfo ().m_sparsesdf.Initialize ();
  /* Distances from obstacles are sampled this finely, m. */
  w->world.getWorldInfo ().m_sparsesdf.setDefaultVoxelsz (0.02);
  w->world.getWorldInfo ().m_sparsesdf.Reset ();
  if (json_object_has_member (take, "obstacles")) {
    JsonArray *list = json_object_get_array_member (take, "obstacles");
    for (guint i = 0; i < json_array_get_length (list); i++)
      add_obstacle (*w, json_array_get_object_element (list, i));
  }
  btSoftBody *body = make_body (*w, cloth, start, p);
  for (Held & item : held)
    item.mass = body->getMass (item.vertex);

  int n_steps = (int) p["steps"];
  vector < float >positions;
  for (size_t frame = 0; frame < times.values.size (); frame++) {
    for (int i = 0; frame > 0 && i < n_steps; i++) {
      double begin = times.values[frame - 1], whole = times.values[frame] - begin;
      step (*w, body, held, clamps, frame - 1, (double) i / n_steps, (i + 1.) / n_steps,
          begin + whole * i / n_steps, whole / n_steps);
    }
    for (int i = 0; i < body->m_nodes.size (); i++)
      for (int k = 0; k < 3; k++)
        positions.push_back ((float) body->m_nodes[i].m_x[k]);
  }
  std::filesystem::create_directories (out);
  for (const auto & entry : std::filesystem::directory_iterator (scene)) {
    string name = entry.path ().filename ().string ();
    if (name != "positions.npy" && name != "states.npy")
      std::filesystem::copy_file (entry.path (), out + "/" + name,
          std::filesystem::copy_options::overwrite_existing);
  }
  write_npy (out + "/positions.npy", positions, times.values.size (), cloth.flat.size ());
  w.release ();
}

}                               // namespace

int
main (int argc, char **argv)
{
  if (argc != 2)
    fail ("give a folder or --capabilities");
  if (!std::strcmp (argv[1], "--capabilities"))
    print_capabilities ();
  else
    simulate (argv[1]);
  return 0;
}
