/* The outline of a simulated cloth in a picture, and the filmed one beside it.
 *
 * Model: the filmed outline is that of the same part of the cloth, moved along the normal.
 * Formula: the pixel p of the drawn cloth has an empty neighbour; its normal n points to the mean of the
 *   empty ones of 7 × 7 around it. The filmed outline is where the silhouette ends first along
 *   ±n. A vertex has the mean of its pixels' offsets δ and normals; with J = ∂(x, y)/∂X it moves
 *   outwards by gᵀ ΔX px, g = Jᵀ n. So gᵀ ΔX = δ + N(0, s²) is all that the outline tells of it.
 * Assumption: outlines that belong together run alike, n·n′ > ½, and are no further apart than
 *   %CLOTH_OUTLINE_REACH_M on the cloth.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 4 (silhouettes); Besl and McKay 1992 (nearest points in turns).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/nudge/outline.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "gst/render/coverage.h"

/* Half the window in which a normal is found, px. */
#define AROUND 3
/* Least cosine between the normals of outlines that belong together. */
#define ALIKE 0.5
/* By what share the ways there and back may differ. */
#define MUTUAL 0.25

/* A picture: 1 where it is cloth. */
typedef struct
{
  gint width, height;
  guint8 *cloth;
  gsize size;
} Mask;

typedef struct
{
  ClothOutline public;
  const ClothRecording *r;
  const ClothObservations *observations;
  ClothPool *pool;
  ClothCoverage *coverage;
  Mask drawn, filmed;
  gdouble *normals;             /* sums, [n][2] */
  gdouble *places;              /* of the vertices when a picture was taken */
  gint *pictures;               /* which of the observations is nearest, [camera][frame]; -1: none */
} Outline;

/* @recording: mesh and times; has to outlive it
 * @observations: what cameras filmed; so has this
 * @threads: that draw; 0 = one for each processor
 *
 * Returns: (transfer full): an outline of no picture yet
 */
ClothOutline *
cloth_outline_new (const ClothRecording * recording,
    const ClothObservations * observations, guint threads)
{
  Outline *self = g_new0 (Outline, 1);
  const ClothTopology *t = recording->scene->topology;
  const guint n_cameras = observations->rig->n_cameras;

  self->r = recording;
  self->observations = observations;
  self->pool = cloth_pool_new (threads);
  self->coverage = cloth_coverage_new (t->n_vertices, t->faces, t->n_faces);
  self->public.n = t->n_vertices;
  self->public.counts = g_new (guint, t->n_vertices);
  self->public.offsets = g_new (gdouble, t->n_vertices);
  self->public.gradients = g_new (gdouble, 3 * (gsize) t->n_vertices);
  self->normals = g_new (gdouble, 2 * (gsize) t->n_vertices);
  self->places = g_new (gdouble, 3 * (gsize) t->n_vertices);
  self->pictures = g_new (gint, (gsize) n_cameras * recording->n_frames);
  for (guint c = 0; c < n_cameras; c++)
    cloth_recording_find_silhouettes (recording, observations, c,
        self->pictures + (gsize) c * recording->n_frames);
  return &self->public;
}

static void
mask_clear (Mask * mask, gint width, gint height)
{
  const gsize size = (gsize) width * (gsize) height;

  mask->width = width;
  mask->height = height;
  if (mask->size < size) {
    mask->size = size;
    mask->cloth = g_renew (guint8, mask->cloth, size);
  }
  memset (mask->cloth, 0, size);
}

static void
fill_masks (Outline * self, const ClothObservation * o)
{
  const ClothCoverage *c = self->coverage;
  const gsize size = (gsize) c->width * (gsize) c->height;

  mask_clear (&self->drawn, c->width, c->height);
  mask_clear (&self->filmed, c->width, c->height);
  for (gsize i = 0; i < size; i++)
    self->drawn.cloth[i] = c->seen[i] != CLOTH_COVERAGE_NONE;
  for (guint i = 0; i < o->n_runs; i++)
    memset (self->filmed.cloth + (gsize) o->runs[i].row *
        (gsize) c->width + o->runs[i].begin, 1,
        o->runs[i].end - o->runs[i].begin);
}

/* Whether all that is looked at around a pixel is in the picture. */
static gboolean
is_inside (const Mask * m, gint x, gint y)
{
  return x >= AROUND && y >= AROUND && x < m->width - AROUND
      && y < m->height - AROUND;
}

static gboolean
is_cloth (const Mask * m, gint x, gint y)
{
  return m->cloth[(gsize) y * (gsize) m->width + (gsize) x];
}

/* The normal that points out of the cloth, of length 1. */
static gboolean
find_normal (const Mask * m, gint x, gint y, gdouble normal[2])
{
  gint sum[2] = { 0, 0 };
  gdouble length;

  for (gint dy = -AROUND; dy <= AROUND; dy++)
    for (gint dx = -AROUND; dx <= AROUND; dx++)
      if (!is_cloth (m, x + dx, y + dy)) {
        sum[0] += dx;
        sum[1] += dy;
      }
  length = hypot (sum[0], sum[1]);
  if (!(length > 0.))
    return FALSE;
  normal[0] = sum[0] / length;
  normal[1] = sum[1] / length;
  return TRUE;
}

/* From a pixel inside of one outline along its normal to where the other mask ends. */
static gboolean
walk (const Mask * other, const gint from[2], const gdouble normal[2],
    gdouble reach, gint to[2], gdouble * offset)
{
  const gboolean outwards = is_cloth (other, from[0], from[1]);
  const gdouble sign = outwards ? 1. : -1.;
  gint last[2] = { from[0], from[1] };

  for (guint step = 1; step <= reach + 1.; step++) {
    gint next[2];

    for (guint k = 0; k < 2; k++)
      next[k] = from[k] + (gint) lrint (sign * step * normal[k]);
    if (!is_inside (other, next[0], next[1]))
      return FALSE;
    if (is_cloth (other, next[0], next[1]) != outwards) {
      *offset = outwards ? step - 1. : -(gdouble) step;
      memcpy (to, outwards ? last : next, 2 * sizeof *to);
      return TRUE;
    }
    memcpy (last, next, sizeof last);
  }
  return FALSE;
}

/* From the drawn outline's pixel to the filmed outline, and back to the drawn one: pairs that are each
 * other's. */
static gboolean
find_offset (const Outline * self, const gint from[2], const gdouble normal[2],
    gdouble reach, gdouble * offset)
{
  gint to[2], home[2];
  gdouble other[2], back;

  return walk (&self->filmed, from, normal, reach, to, offset)
      && find_normal (&self->filmed, to[0], to[1], other)
      && other[0] * normal[0] + other[1] * normal[1] > ALIKE
      && walk (&self->drawn, to, other, reach, home, &back)
      && fabs (*offset + back) <= 1. + MUTUAL * fabs (*offset);
}

/* The corner that a pixel is nearest to. */
static guint32
find_owner (const ClothCoverage * c, gsize pixel)
{
  const gfloat *w = c->places + 2 * pixel;
  const guint32 *corners = c->triangles[c->seen[pixel]];
  const gfloat first = 1.f - w[0] - w[1];

  if (first >= w[0] && first >= w[1])
    return corners[0];
  return w[0] >= w[1] ? corners[1] : corners[2];
}

static void
add_pixel (Outline * self, const ClothCamera * camera,
    const gdouble * positions, gint x, gint y)
{
  const guint32 v = find_owner (self->coverage,
      (gsize) y * (gsize) self->drawn.width + (gsize) x);
  ClothOutline *o = &self->public;
  gdouble normal[2], offset, px[2], J[6];
  const gint from[2] = { x, y };

  if (!find_normal (&self->drawn, x, y, normal)
      || !cloth_camera_project (camera, positions + 3 * (gsize) v, px, J, NULL)
      || !find_offset (self, from, normal, CLOTH_OUTLINE_REACH_M *
          sqrt ((J[0] * J[0] + J[1] * J[1] + J[2] * J[2] + J[3] * J[3] +
                  J[4] * J[4] + J[5] * J[5]) / 2.), &offset))
    return;
  o->counts[v]++;
  o->offsets[v] += offset;
  self->normals[2 * (gsize) v] += normal[0];
  self->normals[2 * (gsize) v + 1] += normal[1];
}

/* Means of what pixels say. */
static void
finish (Outline * self, const ClothCamera * camera, const gdouble * positions)
{
  ClothOutline *o = &self->public;

  for (guint v = 0; v < o->n; v++) {
    const gdouble *n = self->normals + 2 * (gsize) v;
    const gdouble length = hypot (n[0], n[1]);
    gdouble px[2], J[6];

    if (!o->counts[v])
      continue;
    if (!(length > 0.) || !cloth_camera_project (camera,
            positions + 3 * (gsize) v, px, J, NULL)) {
      o->counts[v] = 0;
      continue;
    }
    o->offsets[v] /= o->counts[v];
    for (guint k = 0; k < 3; k++)
      o->gradients[3 * (gsize) v + k] = (n[0] * J[k] + n[1] * J[3 + k]) /
          length;
  }
}

/* Puts the cloth where it is at a time. */
static void
place (Outline * self, gdouble time, guint frame, const gdouble * path)
{
  const gsize row = 3 * (gsize) self->r->n;
  gdouble share;
  const gdouble *from = path + row * cloth_recording_find_between (self->r,
      time, frame, &share);

  for (gsize i = 0; i < row; i++)
    self->places[i] = (1. - share) * from[i] + share * from[row + i];
}

/* @outline: an outline
 * @camera: which camera looks
 * @frame: of the recording
 * @path: (array): where the cloth is in all frames, [n_frames][n][3], m
 *
 * Finds how far the filmed outline is from that of the cloth at the time of the picture that is nearest.
 *
 * Returns: whether a picture of that camera at that time has a silhouette
 */
gboolean
cloth_outline_find (ClothOutline * outline, guint camera, guint frame,
    const gdouble * path)
{
  Outline *self = (Outline *) outline;
  const ClothCamera *c = &self->observations->rig->cameras[camera];
  const gint picture = self->pictures[(gsize) camera * self->r->n_frames +
      frame];
  const gdouble *positions = self->places;
  const ClothObservation *o;

  memset (outline->counts, 0, outline->n * sizeof *outline->counts);
  memset (outline->offsets, 0, outline->n * sizeof *outline->offsets);
  memset (self->normals, 0, 2 * (gsize) outline->n * sizeof *self->normals);
  if (picture < 0)
    return FALSE;
  o = &g_array_index (self->observations->list, ClothObservation, picture);
  place (self, o->time_s - c->offset_s, frame, path);
  cloth_coverage_draw (self->coverage, c, positions, self->pool);
  fill_masks (self, o);
  for (gint y = AROUND; y < self->drawn.height - AROUND; y++)
    for (gint x = AROUND; x < self->drawn.width - AROUND; x++)
      if (is_cloth (&self->drawn, x, y) && (!is_cloth (&self->drawn, x - 1, y)
              || !is_cloth (&self->drawn, x + 1, y)
              || !is_cloth (&self->drawn, x, y - 1)
              || !is_cloth (&self->drawn, x, y + 1)))
        add_pixel (self, c, positions, x, y);
  finish (self, c, positions);
  return TRUE;
}

/* @outline: (nullable) (transfer full): an outline
 */
void
cloth_outline_free (ClothOutline * outline)
{
  Outline *self = (Outline *) outline;

  if (!self)
    return;
  cloth_pool_free (self->pool);
  cloth_coverage_free (self->coverage);
  g_free (self->drawn.cloth);
  g_free (self->filmed.cloth);
  g_free (self->normals);
  g_free (self->places);
  g_free (self->pictures);
  g_free (outline->counts);
  g_free (outline->offsets);
  g_free (outline->gradients);
  g_free (self);
}
