/* Reality by Bullet's soft bodies: links along threads, diagonals and over two vertices, met by
 * position. Reads a scene, writes float32 [frames][points][3]. What acts from outside is the
 * benchmark's, all within the cloth is Bullet's.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <btBulletDynamicsCommon.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <cmath>
#include <vector>

#include "scene.h"

namespace
{
  const int kSteps = 5, kIterations = 10;

  class World
  {
  public:
    World ()
      : dispatcher_ (&configuration_),
        world_ (&dispatcher_, &broadphase_, &solver_, &configuration_)
    {
      world_.setGravity (btVector3 (0, 0, 0));
      world_.getWorldInfo ().m_gravity = btVector3 (0, 0, 0);
      world_.getWorldInfo ().air_density = 0;
    }

    btSoftRigidDynamicsWorld &operator* () { return world_; }

  private:
    btSoftBodyRigidBodyCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btSoftRigidDynamicsWorld world_;
  };

  btSoftBody::Material *
  add_material (btSoftBody *body, double stiffness)
  {
    btSoftBody::Material *material = body->appendMaterial ();
    material->m_kLST = btScalar (std::fmin (stiffness, 1.));
    return material;
  }

  /* Links have the parts of a threads' stiffness that hang and swing about as the diagnosed
   * numbers do; a number of Bullet's is the share of a link's error that a turn takes off. */
  btSoftBody *
  make_body (const Scene *scene, btSoftRigidDynamicsWorld &world)
  {
    std::vector<btVector3> places;
    std::vector<btScalar> masses, lengths;
    for (int i = 0; i < scene->n_points; i++)
      {
        const double *x = scene->start + 3 * i;
        places.push_back (btVector3 (btScalar (x[0]), btScalar (x[1]), btScalar (x[2])));
        masses.push_back (btScalar (scene->mass[i]));
      }
    btSoftBody *body = new btSoftBody (&world.getWorldInfo (), scene->n_points, places.data (),
                                       masses.data ());
    btSoftBody::Material *thread
        = add_material (body, 0.5 * scene_number (scene, "stretch.warp", 40.) / 40.);
    btSoftBody::Material *shear = add_material (body, 0.1 * scene_number (scene, "shear", 12.) / 12.);
    btSoftBody::Material *fold
        = add_material (body, 0.003 * scene_number (scene, "bending.warp", 3e-5) / 3e-5);
    int columns = scene->columns;
    double du = (1. - scene_number (scene, "shrinkage.warp", 0.)) * scene->width / (columns - 1);
    double dv
        = (1. - scene_number (scene, "shrinkage.weft", 0.)) * scene->height / (scene->rows - 1);
    for (int a = 0; a < scene->n_points; a++)
      for (int j = 0; j <= 2; j++)
        for (int i = -1; i <= 2; i++)
          {
            int column = a % columns + i, row = a / columns + j;
            bool near = (i == 1 && j == 0) || (i == 0 && j == 1), across = j == 1 && (i == 1 || i == -1),
                 far = (i == 2 && j == 0) || (i == 0 && j == 2);
            if (column < 0 || column >= columns || row >= scene->rows || !(near || across || far))
              continue;
            body->appendLink (a, row * columns + column, near ? thread : across ? shear : fold);
            lengths.push_back (btScalar (std::hypot (i * du, j * dv)));
          }
    body->m_cfg.piterations = kIterations;
    body->m_cfg.collisions = 0;
    body->m_cfg.kDP = 0;
    /* Else the first step takes the lengths from the places. */
    body->updateConstants ();
    body->m_bUpdateRtCst = false;
    for (int k = 0; k < body->m_links.size (); k++)
      {
        body->m_links[k].m_rl = lengths[k];
        body->m_links[k].m_c1 = lengths[k] * lengths[k];
      }
    body->randomizeConstraints ();
    world.addSoftBody (body);
    return body;
  }

  void
  advance (const Scene *scene, btSoftRigidDynamicsWorld &world, btSoftBody *body, double time,
           double h)
  {
    std::vector<double> x (3 * scene->n_points), v (x.size ()), force (x.size ());
    for (int k = 0; k < 3 * scene->n_points; k++)
      {
        x[k] = body->m_nodes[k / 3].m_x[k % 3];
        v[k] = body->m_nodes[k / 3].m_v[k % 3];
      }
    scene_add_forces (scene, time, x.data (), v.data (), force.data ());
    for (int i = 0; i < scene->n_points; i++)
      {
        body->m_nodes[i].m_im = btScalar (1. / scene_mass (scene, i, time));
        body->addForce (btVector3 (btScalar (force[3 * i]), btScalar (force[3 * i + 1]),
                                   btScalar (force[3 * i + 2])), i);
      }
    /* What has no inverse mass goes where its speed takes it. */
    for (int held = 0; held < scene->n_held; held++)
      {
        int i = int (scene->held[held]);
        double place[3];
        if (!scene_holds (scene, held, time + h))
          continue;
        scene_clamp (scene, held, time + h, place);
        body->m_nodes[i].m_im = 0;
        for (int q = 0; q < 3; q++)
          body->m_nodes[i].m_v[q] = btScalar ((place[q] - x[3 * i + q]) / h);
      }
    body->updateLinkConstants ();
    world.stepSimulation (btScalar (h), 0);
    for (int i = 0; i < scene->n_points; i++)
      {
        btSoftBody::Node &node = body->m_nodes[i];
        double at[3] = { node.m_x[0], node.m_x[1], node.m_x[2] };
        double speed[3] = { node.m_v[0], node.m_v[1], node.m_v[2] };
        if (scene_touch (scene, at, speed))
          for (int q = 0; q < 3; q++)
            {
              node.m_x[q] = btScalar (at[q]);
              node.m_v[q] = btScalar (speed[q]);
            }
      }
  }
}

int
main ()
{
  Scene *scene = scene_read ();
  {
    World world;
    btSoftBody *body = make_body (scene, *world);
    std::vector<double> x (3 * scene->n_points);
    double h = scene->interval / kSteps;
    for (int frame = 0; frame < scene->n_frames; frame++)
      {
        for (int k = 0; k < 3 * scene->n_points; k++)
          x[k] = body->m_nodes[k / 3].m_x[k % 3];
        scene_write (scene, x.data ());
        for (int s = 0; s < kSteps; s++)
          advance (scene, *world, body, frame * scene->interval + s * h, h);
      }
    (*world).removeSoftBody (body);
    delete body;
  }
  scene_free (scene);
  return 0;
}
