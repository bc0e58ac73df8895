/* A heavy hem.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "areal_mass", "air_drag",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_mass_distribution = {
  .id = "mass_distribution",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Areal mass is larger by a factor in a band along the lower edge, "
      "where v is largest: a hem, a seam, wet cloth.",
  .source =
      "Hem, seam or wet edge: 2 to 5 times over 2 cm.",
  .regressor =
      "A force in proportion to gravity minus acceleration in the "
      "lowest band alone, which tensions all above.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "factor", .unit = "1", .null_value = 1, .min = 1, .max = 20,
        .prior = 2, .one_sided = TRUE,
        .blurb = "Areal mass in the band over that of the rest"},
    {.name = "height", .unit = "m", .null_value = 0.02, .min = 0.001, .max = 10,
        .prior = 0.02, .shapes = TRUE, .n_tried = 2, .tried = {0.02, 0.06},
        .blurb = "Height of the band on the flat cloth; with a factor of 1 it "
            "means nothing"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* The part of a triangle that lies below @edge, as the share of its area times the mean
 * of each corner's weight there: cut along v = @edge. */
static void
part_below (const gdouble v[3], gdouble edge, gdouble part[3])
{
  gdouble corner[4][3], area = 0.;
  guint n = 0;

  for (guint i = 0; i < 3; i++) {
    guint j = (i + 1) % 3;

    if (v[i] >= edge) {
      memset (corner[n], 0, sizeof corner[n]);
      corner[n++][i] = 1.;
    }
    if ((v[i] >= edge) != (v[j] >= edge)) {
      memset (corner[n], 0, sizeof corner[n]);
      corner[n][j] = (edge - v[i]) / (v[j] - v[i]);
      corner[n][i] = 1. - corner[n][j];
      n++;
    }
  }
  part[0] = part[1] = part[2] = 0.;
  for (guint i = 1; i + 1 < n; i++) {
    const gdouble *a = corner[0], *b = corner[i], *c = corner[i + 1];

    area = fabs ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]));
    for (guint k = 0; k < 3; k++)
      part[k] += area * (a[k] + b[k] + c[k]) / 3.;
  }
}

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  const ClothBody *body = state->body;
  gdouble *v = g_new (gdouble, state->n), lowest = -INFINITY;

  for (guint i = 0; i < body->n_vertices; i++) {
    v[body->particle[i]] = body->uv[2 * i + 1];
    lowest = MAX (lowest, body->uv[2 * i + 1]);
  }
  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    gdouble factor = CLOTH_LANE_AT (&effect->p[0], l);
    gdouble edge = lowest - CLOTH_LANE_AT (&effect->p[1], l);

    for (guint i = 0; i < body->n_triangles; i++) {
      const ClothBodyTriangle *t = &body->triangles[i];
      const gdouble corner[3] =
          { v[t->particle[0]], v[t->particle[1]], v[t->particle[2]] };
      gdouble part[3];

      part_below (corner, edge, part);
      for (guint k = 0; k < 3; k++)
        CLOTH_LANE_AT (&state->mass[t->particle[k]], l) += (ClothReal)
            (CLOTH_LANE_AT (&state->density, l) * t->area * (factor - 1.) *
            part[k]);
    }
  }
  g_free (v);
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_mass_distribution) = {
  .setup = setup,
};
#endif
