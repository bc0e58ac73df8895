/* The springs of the mass–spring model, worked out from a scene.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/sim/body.h"

static ClothBodySpring *
add_spring (ClothBody * body, guint a, guint b)
{
  ClothBodySpring *s = &body->springs[body->n_springs++];

  *s = (ClothBodySpring) { {
  body->particle[a], body->particle[b]},
      body->uv[2 * b] - body->uv[2 * a],
      body->uv[2 * b + 1] - body->uv[2 * a + 1]
  };
  return s;
}

/* Each cell gives its four sides half of its width of cloth, and has two diagonals: they
 * resist shear as the membrane does. */
static void
grid_springs (ClothBody * body)
{
  guint columns = body->columns, rows = body->rows;

  for (guint row = 0; row < rows; row++) {
    for (guint column = 0; column < columns; column++) {
      guint i = row * columns + column;
      gboolean right = column + 1 < columns, down = row + 1 < rows;
      gdouble width = right ? fabs (body->uv[2 * i + 2] - body->uv[2 * i]) : 0.;
      gdouble height = down ? fabs (body->uv[2 * (i + columns) + 1] -
          body->uv[2 * i + 1]) : 0.;

      if (right) {
        gdouble above = row ? fabs (body->uv[2 * i + 1] -
            body->uv[2 * (i - columns) + 1]) : 0.;

        add_spring (body, i, i + 1)->warp = (above + height) / (2. * width);
      }
      if (down) {
        gdouble before = column ? fabs (body->uv[2 * i] -
            body->uv[2 * i - 2]) : 0.;

        add_spring (body, i, i + columns)->weft =
            (before + width) / (2. * height);
      }
      if (right && down) {
        gdouble shear = (width * width + height * height) /
            (2. * width * height);

        add_spring (body, i, i + columns + 1)->shear = shear;
        add_spring (body, i + 1, i + columns)->shear = shear;
      }
    }
  }
}

/* A side of a triangle is a spring of stiffness modulus · area / length² (Van Gelder
 * 1998), the modulus that of its direction. Sides that triangles share are springs side
 * by side. */
static void
mesh_springs (ClothBody * body)
{
  for (guint i = 0; i < body->n_triangles; i++) {
    const ClothBodyTriangle *t = &body->triangles[i];
    gdouble det = t->g[0] * t->g[3] - t->g[1] * t->g[2];
    /* edges from corner 0 on the flat cloth */
    gdouble e[3][2] = { {0., 0.}, {t->g[3] / det, -t->g[2] / det},
    {-t->g[1] / det, t->g[0] / det}
    };

    for (guint k = 0; k < 3; k++) {
      guint a = k, b = (k + 1) % 3;
      gdouble u = e[b][0] - e[a][0], v = e[b][1] - e[a][1];
      gdouble square = u * u + v * v, share = t->area / square;
      gdouble uu = u * u / square, vv = v * v / square;

      body->springs[body->n_springs++] = (ClothBodySpring) {
        {
        t->particle[a], t->particle[b]}
      , u, v, share * uu * uu, share * vv * vv, share * 4. * uu * vv};
    }
  }
}

/* Fills the springs of a body whose triangles are known, and their part of the bounds. */
void
cloth_body_make_springs (ClothBody * body)
{
  body->springs = g_new (ClothBodySpring,
      4 * (gsize) body->n_vertices + 3 * (gsize) body->n_triangles);
  if (body->columns > 1 && body->n_particles == body->n_vertices)
    grid_springs (body);
  else
    mesh_springs (body);
  for (guint i = 0; i < body->n_springs; i++) {
    const ClothBodySpring *s = &body->springs[i];
    gdouble square = s->u * s->u + s->v * s->v, uv = fabs (s->u * s->v);
    gdouble row[2] = { 2. * (s->u * s->u + uv) / square,
      2. * (s->v * s->v + uv) / square
    };

    for (guint end = 0; end < 2; end++) {
      for (guint k = 0; k < 2; k++) {
        gdouble *bound = body->bounds[s->particle[end]].springs[k];

        bound[0] += row[k] * s->warp;
        bound[1] += row[k] * s->weft;
        bound[2] += row[k] * s->shear;
      }
    }
  }
}
