/* The parts of the renderer: finer meshes, tiles of the picture, the sensor.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/render/render.h"

G_BEGIN_DECLS

/* Pixels a side of a tile, and points of a pixel at which is asked what is seen. */
#define CLOTH_RENDER_TILE 32
#define CLOTH_RENDER_SAMPLES 16

/* Every face cut into n × n: the points and triangles of the finer mesh. */
typedef struct {
  guint n_points;
  guint n_triangles;
  guint8 *n_parents;            /* 1 to 4 vertices of the mesh */
  guint (*parents)[4];
  gdouble (*weights)[4];
  gfloat (*uv)[2];
  guint (*triangles)[3];        /* counter-clockwise seen from the printed side */
} ClothRenderMesh;

ClothRenderMesh *cloth_render_mesh_new (guint n_vertices, const gfloat * uv,
    const guint32 * faces, guint n_faces, guint n);
void cloth_render_mesh_free (ClothRenderMesh * mesh);

/* One triangle in the picture. What is linear in the picture is kept as value at (x, y)
 * and slopes: 1/depth, and u, v (pixels of the finest level of the paint) and light over
 * depth. Edges: positive inside. */
typedef struct {
  gdouble ex[3], ey[3];         /* a point of each edge */
  gfloat ea[3], eb[3];          /* slopes along x and y */
  gint32 tie[3];                /* −1 when a point on the edge belongs inside */
  gdouble x, y;
  gdouble w[3], u[3], v[3];     /* value, slopes */
  gdouble light[3];             /* not over depth */
  gint left, top, right, bottom;        /* pixels that it may touch */
  gboolean front;
  guint level;                  /* of the paint whose pixels are as the points lie */
  guint flat_level;             /* whose pixels are no smaller than what a pixel sees */
} ClothRenderTriangle;

typedef struct {
  const ClothPaint *paint;
  const ClothRenderTriangle *triangles;
  gboolean two_sided;
  gfloat back;
  gfloat weight;                /* of this instant in the exposure */
  gfloat background[2];         /* at row 0, and change per row */
  ClothLight *light;            /* added to */
  const ClothWork *work;        /* nullable: when to stop */
} ClothRenderJob;

/* Draws the pixels of one tile: those triangles of the job that the list names.
 * @scratch: @scratch_size bytes, aligned to 64. */
typedef struct {
  void (*draw) (const ClothRenderJob * job, gint left, gint top,
      const guint * list, guint n_list, gpointer scratch);
  gsize scratch_size;
} ClothRenderTile;

CLOTH_SIMD_TABLES (ClothRenderTile, cloth_render_tile);

/* From light to levels. */
typedef struct _ClothSensor ClothSensor;

ClothSensor *cloth_sensor_new (void);
void cloth_sensor_free (ClothSensor * sensor);
void cloth_sensor_develop (ClothSensor * sensor, ClothPool * pool,
    const ClothCapture * capture, ClothLight * light, guint64 frame,
    guint64 seed, guint n_planes, guint8 * const *planes,
    const gint * strides, gint pixel_stride, const ClothWork * work);

G_END_DECLS
