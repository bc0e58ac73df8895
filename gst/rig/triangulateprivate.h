/* What the files of triangulation share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"
#include "gst/rig/triangulatekernel.h"

G_BEGIN_DECLS

/* One thread's memory. */
typedef struct
{
  gdouble *obs;
  gdouble *weighted;
  gdouble out[N_OUT * BLOCK];
  gdouble trial[N_OUT * BLOCK];
  gdouble pad[N_IN * BLOCK];
} Scratch;

struct _ClothTriangulator
{
  guint n_cameras;
  TriangulateCamera *cameras;
  /* The world that the kernels see is (X − origin) / scale. */
  gdouble origin[3], scale;

  ClothTriangulateParameters parameters;
  TriangulateLimits limits;
  ClothPool *pool;
  const TriangulateKernel *kernel;

  guint n_scratch;
  Scratch **scratch;
  guint n_allocated;
  gdouble *reals;
  guint64 *words;
  guint8 *bytes;
  ClothTriangulation result;

  /* of the run under way */
  const ClothTriangulateView *views;
};

G_END_DECLS
