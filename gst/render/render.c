/* Draws a printed cloth as a camera films it.
 *
 * The mesh is cut finer until what lies between its points is straight in the picture to
 * a fraction of a pixel, whatever the lens, the rolling shutter or the twist of a face.
 * Each point is then seen where and when the capture says; between points, depth and
 * paint are interpolated in perspective. The picture is drawn in tiles, which are shared
 * out between threads: none depends on another, so the bytes are the same for any number.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/render.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "gst/render/render-private.h"
#include "gst/render/scan.h"

#define TILE CLOTH_RENDER_TILE

/* What the middle of an edge or face may be off between the points of the mesh. */
#define STRAIGHT_PX 0.02
/* The same for the middle of a twisted face, whose true shape nobody knows; and most
 * triangles that are made for its sake. */
#define TWIST_PX 0.1
#define MAX_TWIST_TRIANGLES (1u << 16)
/* Triangles whose edges are tried for bends by the lens. */
#define LENS_TRIALS 2000
/* Each level halves the edges; so many at most, and so many triangles. */
#define MAX_LEVELS 8
#define MAX_TRIANGLES (1u << 21)
/* An exposure is drawn as instants between which no point moves farther, px. */
#define INSTANT_PX 0.75
#define MAX_INSTANTS 128

typedef struct
{
  gdouble px[2];
  gdouble position[3];
  gdouble depth;                /* along the line of sight; 0 when not seen */
  gdouble normal[3];
  gdouble light[2];             /* on the printed side, on the back */
} Point;

struct _ClothRenderer
{
  guint n_vertices, n_faces;
  gfloat *uv;
  guint32 *faces;
  ClothRenderMesh *meshes[MAX_LEVELS + 1];
  ClothPool *pool;
  const ClothRenderTile *tile;
  ClothSensor *sensor;
  ClothLight light;
  gsize light_size;

  Point *points;
  guint points_size;
  ClothRenderTriangle *triangles;
  guint triangles_size;
  guint *first;                 /* of each tile in list, and one more */
  guint tiles_size;
  guint *list;
  gsize list_size;
  guint8 *scratch;              /* one a thread */

  /* of the picture that is drawn */
  const ClothRenderMesh *mesh;
  const ClothCapture *capture;
  const ClothMotion *motion;
  gdouble time_s;
  guint n_points;               /* of the mesh that is looked at */
  gint columns, rows;           /* of tiles */
  ClothRenderJob job;
};

/* @style: (out): a lamp above and beside the camera's usual place, y < 0; a grey wall
 */
void
cloth_render_style_init (ClothRenderStyle * style)
{
  *style = (ClothRenderStyle) {
    .lamp = { -0.4, -0.8, 0.5 },.lamp_light = 0.6,.ambient_light =
        0.35,.through = 0.3,.back = 0.7,.background = { 0.14, 0.09 }
  };
}

/* @n_vertices: vertices of the mesh
 * @uv: (array): 2 numbers a vertex, metres on the flat cloth
 * @faces: (array): 4 indices a face, counter-clockwise seen from the printed side, the
 *   last 0xffffffff for a triangle; all others below @n_vertices
 * @n_faces: faces
 * @threads: threads that draw, 0 for one a processor
 * @simd: instruction set, %CLOTH_SIMD_BEST but in tests
 *
 * Returns: (transfer full): free with cloth_renderer_free ()
 */
ClothRenderer *
cloth_renderer_new (guint n_vertices, const gfloat * uv,
    const guint32 * faces, guint n_faces, guint threads, ClothSimd simd)
{
  ClothRenderer *self = g_new0 (ClothRenderer, 1);

  self->n_vertices = n_vertices;
  self->n_faces = n_faces;
  self->uv = g_memdup2 (uv, 2 * n_vertices * sizeof *uv);
  self->faces = g_memdup2 (faces, 4 * (gsize) n_faces * sizeof *faces);
  self->pool = cloth_pool_new (threads);
  self->tile = CLOTH_SIMD_TABLE (cloth_render_tile, simd);
  self->sensor = cloth_sensor_new ();
  self->scratch = g_aligned_alloc (cloth_pool_get_n_threads (self->pool),
      self->tile->scratch_size, 64);
  return self;
}

/* @renderer: (nullable) (transfer full): a renderer
 */
void
cloth_renderer_free (ClothRenderer * renderer)
{
  if (!renderer)
    return;
  for (guint i = 0; i <= MAX_LEVELS; i++)
    cloth_render_mesh_free (renderer->meshes[i]);
  cloth_pool_free (renderer->pool);
  cloth_sensor_free (renderer->sensor);
  g_free (renderer->uv);
  g_free (renderer->faces);
  g_free (renderer->light.data);
  g_free (renderer->points);
  g_free (renderer->triangles);
  g_free (renderer->first);
  g_free (renderer->list);
  g_aligned_free (renderer->scratch);
  g_free (renderer);
}

/* ---- points ---- */

static void
see_points (gpointer data, guint begin, guint end, guint worker)
{
  ClothRenderer *self = data;
  const ClothCamera *camera = &self->capture->camera;
  const ClothRenderMesh *mesh = self->mesh;

  for (guint i = begin; i < end; i++) {
    Point *p = &self->points[i];
    gboolean good = cloth_capture_project (self->capture, self->motion,
        mesh->n_parents[i], mesh->parents[i], mesh->weights[i], self->time_s,
        p->px, p->position);

    p->depth = good ? camera->R[6] * p->position[0]
        + camera->R[7] * p->position[1] + camera->R[8] * p->position[2]
        + camera->t[2] : 0;
    if (!(p->depth > 0 && fabs (p->px[0]) < CLOTH_SCAN_FAR_PX
            && fabs (p->px[1]) < CLOTH_SCAN_FAR_PX))
      p->depth = 0;
    memset (p->normal, 0, sizeof p->normal);
  }
}

static void
see (ClothRenderer * self, guint level, gdouble time_s)
{
  if (!self->meshes[level])
    self->meshes[level] = cloth_render_mesh_new (self->n_vertices, self->uv,
        self->faces, self->n_faces, 1u << level);
  self->mesh = self->meshes[level];
  self->time_s = time_s;
  if (self->points_size < self->mesh->n_points) {
    self->points_size = self->mesh->n_points;
    self->points = g_renew (Point, self->points, self->points_size);
  }
  cloth_pool_run (self->pool, see_points, self, self->mesh->n_points);
}

/* How far the middle between two points is from where the perspective between them puts
 * it. */
static gdouble
bend (const Point * a, const Point * b, const Point * middle)
{
  const gdouble sum = a->depth + b->depth;

  if (a->depth <= 0 || b->depth <= 0 || middle->depth <= 0)
    return 0;
  return hypot ((a->depth * a->px[0] + b->depth * b->px[0]) / sum
      - middle->px[0], (a->depth * a->px[1] + b->depth * b->px[1]) / sum
      - middle->px[1]);
}

static gboolean
near_picture (const ClothRenderer * self, const Point * p)
{
  const ClothCamera *camera = &self->capture->camera;

  return p->depth > 0 && p->px[0] > -0.5 * camera->width
      && p->px[0] < 1.5 * camera->width && p->px[1] > -0.5 * camera->height
      && p->px[1] < 1.5 * camera->height;
}

static gboolean
may_halve (const ClothRenderer * self, guint level, guint most)
{
  return level < MAX_LEVELS
      && (guint64) self->n_faces * 2 << 2 * (level + 1) <= most;
}

/* How far the lens bends edges of the mesh that is looked at, px: some are tried. */
static gdouble
measure_lens (const ClothRenderer * self)
{
  const ClothRenderMesh *mesh = self->mesh;
  const guint step = 1 + mesh->n_triangles / LENS_TRIALS;
  gdouble most = 0;

  for (guint i = 0; i < mesh->n_triangles; i += step) {
    for (gint k = 0; k < 3; k++) {
      const Point *a = &self->points[mesh->triangles[i][k]];
      const Point *b = &self->points[mesh->triangles[i][(k + 1) % 3]];
      Point middle = *a;

      if (!near_picture (self, a) || !near_picture (self, b))
        continue;
      for (gint j = 0; j < 3; j++)
        middle.position[j] = (a->position[j] + b->position[j]) / 2;
      if (cloth_camera_project (&self->capture->camera, middle.position,
              middle.px, NULL, NULL))
        most = MAX (most, bend (a, b, &middle));
    }
  }
  return most;
}

/* Halves edges until the middles are straight. The error of a twisted face falls to a
 * quarter each time, that of a lens may lie anywhere. */
static guint
choose_level (ClothRenderer * self, gdouble time_s)
{
  gdouble most = 0;
  guint level = 0;

  see (self, 1, time_s);
  for (guint i = self->n_vertices; i < self->mesh->n_points; i++) {
    const guint *parents = self->mesh->parents[i];
    /* The middle of a quad is cut by the diagonal from 1 to 3. */
    const guint first = self->mesh->n_parents[i] == 4 ? 1 : 0;
    const guint second = self->mesh->n_parents[i] == 4 ? 3 : 1;

    if (near_picture (self, &self->points[i]))
      most = MAX (most, bend (&self->points[parents[first]],
              &self->points[parents[second]], &self->points[i]));
  }
  for (; most > TWIST_PX && may_halve (self, level, MAX_TWIST_TRIANGLES);
      level++)
    most /= 4;
  while (self->capture->camera.lens != CLOTH_LENS_NONE
      && may_halve (self, level, MAX_TRIANGLES)) {
    see (self, level, time_s);
    if (measure_lens (self) <= STRAIGHT_PX)
      break;
    level++;
  }
  return level;
}

/* Normals by the area of the triangles around a point, then the light on both sides. */
static void
light_points (ClothRenderer * self, const ClothRenderStyle * style)
{
  const ClothRenderMesh *mesh = self->mesh;
  const gdouble length = cloth_vec3_length (style->lamp);

  for (guint i = 0; i < mesh->n_triangles; i++) {
    const guint *t = mesh->triangles[i];
    const gdouble *a = self->points[t[0]].position;
    const gdouble *b = self->points[t[1]].position;
    const gdouble *c = self->points[t[2]].position;
    gdouble p[3], q[3], normal[3];

    if (self->points[t[0]].depth <= 0 || self->points[t[1]].depth <= 0
        || self->points[t[2]].depth <= 0)
      continue;
    cloth_vec3_subtract (b, a, p);
    cloth_vec3_subtract (c, a, q);
    cloth_vec3_cross (p, q, normal);
    for (gint j = 0; j < 3; j++)
      cloth_vec3_add_scaled (self->points[t[j]].normal, 1, normal);
  }
  for (guint i = 0; i < mesh->n_points; i++) {
    Point *p = &self->points[i];
    const gdouble *n = p->normal;
    const gdouble norm = cloth_vec3_length (n);
    const gdouble facing = norm > 0 && length > 0 ?
        cloth_vec3_dot (n, style->lamp) / (norm * length) : 0;

    for (gint side = 0; side < 2; side++) {
      const gdouble towards = side ? -facing : facing;

      p->light[side] = style->ambient_light + style->lamp_light
          * (towards > 0 ? towards : -towards * style->through);
    }
  }
}

/* ---- triangles ---- */

/* Which levels of the paint fit the triangle: by the longest steps and the area of a pixel
 * of the picture on the paint, where it is nearest and where it is farthest. */
static void
set_levels (const ClothPaint * paint, ClothRenderTriangle * t,
    const Point * const *p)
{
  gdouble spacing = G_MAXDOUBLE, reach = 0;
  gint level;

  for (gint k = 0; k < 3; k++) {
    const gdouble dx = p[k]->px[0] - t->x, dy = p[k]->px[1] - t->y;
    const gdouble depth = p[k]->depth;
    gdouble J[4], area;

    for (gint j = 0; j < 2; j++) {
      const gdouble *plane = j ? t->v : t->u;
      const gdouble at = (plane[0] + plane[1] * dx + plane[2] * dy) * depth;

      J[2 * j] = (plane[1] - at * t->w[1]) * depth;
      J[2 * j + 1] = (plane[2] - at * t->w[2]) * depth;
      reach = MAX (reach, fabs (J[2 * j]) + fabs (J[2 * j + 1]));
    }
    /* The points are a quarter of a pixel apart; seen edge-on, rather some stripes than
     * all grey. */
    area = sqrt (fabs (J[0] * J[3] - J[1] * J[2])) / 4;
    spacing = MIN (spacing, MAX (area, MAX (hypot (J[0], J[2]),
                hypot (J[1], J[3])) / 8));
  }
  level = spacing > 1 && spacing < 65536 ? ilogb (spacing * G_SQRT2) : 0;
  t->level = MIN ((guint) level, paint->n_levels - 1);
  reach = 0.6 * reach + ldexp (1, (gint) t->level);
  level = reach < 65536 ? ilogb (reach) + 1 : CLOTH_PAINT_MAX_LEVELS;
  t->flat_level = MIN ((guint) MAX (level, 0), CLOTH_PAINT_MAX_LEVELS);
}

static gboolean
set_triangle (const ClothRenderer * self, const guint * corners,
    ClothRenderTriangle * t)
{
  const ClothPaint *paint = self->job.paint;
  const ClothCamera *camera = &self->capture->camera;
  const Point *p[3];
  gdouble area, x[3], y[3], w[3], uv[2][3], light[3], low[2], high[2];

  for (gint k = 0; k < 3; k++) {
    p[k] = &self->points[corners[k]];
    if (p[k]->depth <= 0)
      return FALSE;
  }
  for (gint k = 0; k < 2; k++) {
    low[k] = MIN (p[0]->px[k], MIN (p[1]->px[k], p[2]->px[k]));
    high[k] = MAX (p[0]->px[k], MAX (p[1]->px[k], p[2]->px[k]));
  }
  area = (p[1]->px[0] - p[0]->px[0]) * (p[2]->px[1] - p[0]->px[1])
      - (p[1]->px[1] - p[0]->px[1]) * (p[2]->px[0] - p[0]->px[0]);
  if (area == 0 || high[0] < -0.5 || high[1] < -0.5
      || low[0] > camera->width - 0.5 || low[1] > camera->height - 0.5)
    return FALSE;
  t->left = MAX (0, (gint) floor (low[0] + 0.5));
  t->top = MAX (0, (gint) floor (low[1] + 0.5));
  t->right = MIN (camera->width - 1, (gint) floor (high[0] + 0.5));
  t->bottom = MIN (camera->height - 1, (gint) floor (high[1] + 0.5));
  /* Counter-clockwise is negative where y points down. */
  t->front = area < 0;
  t->x = p[0]->px[0];
  t->y = p[0]->px[1];
  for (gint k = 0; k < 3; k++) {
    const gfloat *at = self->mesh->uv[corners[k]];

    x[k] = p[k]->px[0];
    y[k] = p[k]->px[1];
    w[k] = 1 / p[k]->depth;
    light[k] = p[k]->light[!t->front];
    for (gint j = 0; j < 2; j++)
      uv[j][k] = (at[j] - paint->origin_uv_m[j]) * paint->px_per_m[j] * w[k];
  }
  cloth_scan_set_plane (t->w, x, y, area, w);
  cloth_scan_set_plane (t->u, x, y, area, uv[0]);
  cloth_scan_set_plane (t->v, x, y, area, uv[1]);
  cloth_scan_set_plane (t->light, x, y, area, light);
  set_levels (paint, t, p);
  for (gint k = 0; k < 3; k++) {
    /* From the lower to the higher of its ends, whichever triangle asks: both get the
     * same number with opposite signs, and a point on it belongs to one of them. */
    const guint i = corners[k], j = corners[(k + 1) % 3];
    const Point *from = &self->points[MIN (i, j)];
    const Point *to = &self->points[MAX (i, j)];
    const gboolean along = (i < j) == (area > 0);
    const gfloat a = (gfloat) (from->px[1] - to->px[1]);
    const gfloat b = (gfloat) (to->px[0] - from->px[0]);

    t->ex[k] = from->px[0];
    t->ey[k] = from->px[1];
    t->ea[k] = along ? a : -a;
    t->eb[k] = along ? b : -b;
    t->tie[k] = along ? -1 : 0;
  }
  return TRUE;
}

static void
set_triangles (gpointer data, guint begin, guint end, guint worker)
{
  ClothRenderer *self = data;

  for (guint i = begin; i < end; i++)
    if (!set_triangle (self, self->mesh->triangles[i], &self->triangles[i]))
      self->triangles[i].right = -1;
}

/* Which triangles touch which tile, in the order of the mesh. */
static void
sort_triangles (ClothRenderer * self)
{
  const guint n_tiles = (guint) (self->columns * self->rows);
  const guint n = self->mesh->n_triangles;
  gsize total = 0;

  memset (self->first, 0, (n_tiles + 1) * sizeof *self->first);
  for (gint pass = 0; pass < 2; pass++) {
    for (guint i = 0; i < n; i++) {
      const ClothRenderTriangle *t = &self->triangles[i];

      if (t->right < 0)
        continue;
      for (gint y = t->top / TILE; y <= t->bottom / TILE; y++)
        for (gint x = t->left / TILE; x <= t->right / TILE; x++) {
          guint *slot = &self->first[y * self->columns + x];

          if (pass)
            self->list[*slot] = i;
          (*slot)++;
        }
    }
    if (pass == 0) {
      /* Counts become places; filling then moves each to the next one's. */
      for (guint i = 0; i <= n_tiles; i++) {
        const guint count = i < n_tiles ? self->first[i] : 0;

        self->first[i] = (guint) total;
        total += count;
      }
      if (self->list_size < total) {
        self->list_size = total;
        self->list = g_renew (guint, self->list, total);
      }
    }
  }
  memmove (self->first + 1, self->first, n_tiles * sizeof *self->first);
  self->first[0] = 0;
}

/* The boxes around all the triangles, whatever they hide of each other: a triangle is asked at
 * each pixel of its box. */
static gboolean
take_work (const ClothRenderer * self, ClothWork * work)
{
  for (guint i = 0; i < self->mesh->n_triangles; i++) {
    const ClothRenderTriangle *t = &self->triangles[i];

    if (t->right >= 0 && !cloth_work_take (work,
            (gdouble) (t->right - t->left + 1) * (t->bottom - t->top + 1)))
      return FALSE;
  }
  return TRUE;
}

static void
draw_tiles (gpointer data, guint begin, guint end, guint worker)
{
  ClothRenderer *self = data;
  const guint n = (guint) (self->columns * self->rows);
  gpointer scratch = self->scratch + worker * self->tile->scratch_size;

  for (guint i = begin; i < end && !cloth_work_is_stopped (self->job.work); i++) {
    /* Each thread gets some rows of all parts of the picture: work is even. */
    const guint row = i / (guint) self->columns;
    const guint half = ((guint) self->rows + 1) / 2;
    const guint y = row < half ? 2 * row : 2 * (row - half) + 1;
    const guint tile = y * (guint) self->columns + i % (guint) self->columns;

    g_assert (tile < n);
    self->tile->draw (&self->job, (gint) (tile % (guint) self->columns) * TILE,
        (gint) y * TILE, self->list + self->first[tile],
        self->first[tile + 1] - self->first[tile], scratch);
  }
}

/* ---- the picture ---- */

/* FALSE when there is no memory for the picture. */
static gboolean
prepare_light (ClothRenderer * self, const ClothPaint * paint)
{
  const ClothCamera *camera = &self->capture->camera;
  const gsize size = (gsize) camera->width * (gsize) camera->height
      * paint->n_channels;
  guint n_tiles;

  self->light.width = camera->width;
  self->light.height = camera->height;
  self->light.n_channels = paint->n_channels;
  if (self->light_size < size) {
    g_clear_pointer (&self->light.data, g_free);
    self->light_size = 0;
    self->light.data = g_try_new (gfloat, size);
    if (!self->light.data)
      return FALSE;
    self->light_size = size;
  }
  memset (self->light.data, 0, size * sizeof (gfloat));
  self->columns = (camera->width + TILE - 1) / TILE;
  self->rows = (camera->height + TILE - 1) / TILE;
  n_tiles = (guint) (self->columns * self->rows);
  if (self->tiles_size < n_tiles) {
    self->tiles_size = n_tiles;
    self->first = g_renew (guint, self->first, n_tiles + 1);
  }
  return TRUE;
}

/* Instants of the exposure: by how far points move in the picture meanwhile. */
static guint
count_instants (ClothRenderer * self, gdouble time_s)
{
  const gdouble exposure = self->capture->exposure_s;
  g_autofree Point *start = NULL;
  gdouble farthest = 0;

  if (exposure <= 0)
    return 1;
  see (self, 0, time_s);
  start = g_memdup2 (self->points, self->n_vertices * sizeof *start);
  for (gint half = 1; half <= 2; half++) {
    see (self, 0, time_s + exposure * half / 2);
    for (guint i = 0; i < self->n_vertices; i++)
      if (start[i].depth > 0 && self->points[i].depth > 0)
        farthest = MAX (farthest, hypot (self->points[i].px[0]
                - start[i].px[0], self->points[i].px[1] - start[i].px[1]));
  }
  return (guint) CLAMP (ceil (farthest / INSTANT_PX), 1, MAX_INSTANTS);
}

/* @renderer: a renderer
 * @paint: what is on the printed side
 * @capture: the camera
 * @style: light and background
 * @motion: positions of the mesh's vertices around @time_s; what touches an unknown
 *   vertex is left out
 * @time_s: the picture's time by the camera's clock
 * @work: (nullable): how much may be drawn in one instant of the exposure; each of the others
 *   adds an eighth
 *
 * Draws the light that reaches the sensor: everything but what sensor and lens do to a
 * picture that is already there, which is cloth_renderer_develop ()'s. What reaches
 * behind the camera is left out. A corner of a printed square lies within some
 * thousandths of a pixel of its place.
 *
 * Returns: (transfer none) (nullable): the light, until the next call; %NULL when @work was
 *   stopped or too little, or else when there is no memory for such a picture
 */
const ClothLight *
cloth_renderer_draw (ClothRenderer * renderer, const ClothPaint * paint,
    const ClothCapture * capture, const ClothRenderStyle * style,
    const ClothMotion * motion, gdouble time_s, ClothWork * work)
{
  ClothRenderer *self = renderer;
  const gdouble each = work ? work->left : 0;
  guint level, instants;

  g_return_val_if_fail (motion->n_points == self->n_vertices, NULL);
  self->capture = capture;
  self->motion = motion;
  if (!prepare_light (self, paint))
    return NULL;
  level = choose_level (self, time_s);
  instants = count_instants (self, time_s);
  self->job = (ClothRenderJob) {
    .paint = paint,.triangles = self->triangles,.two_sided =
        style->two_sided,.back = (gfloat) style->back,.weight =
        1 / (gfloat) instants,.background = { (gfloat) style->background[0],
      (gfloat) ((style->background[1] - style->background[0])
          / MAX (1, self->light.height - 1))
  },.light = &self->light,.work = work};
  for (guint i = 0; i < instants; i++) {
    if (cloth_work_is_stopped (work))
      return NULL;
    see (self, level, time_s + capture->exposure_s * (i + 0.5) / instants);
    light_points (self, style);
    if (self->triangles_size < self->mesh->n_triangles) {
      self->triangles_size = self->mesh->n_triangles;
      self->triangles = g_renew (ClothRenderTriangle, self->triangles,
          self->triangles_size);
      self->job.triangles = self->triangles;
    }
    cloth_pool_run (self->pool, set_triangles, self, self->mesh->n_triangles);
    if (work && i > 0)
      work->left = MIN (work->left + each / 8, each);
    if (!take_work (self, work))
      return NULL;
    sort_triangles (self);
    cloth_pool_run (self->pool, draw_tiles, self,
        (guint) (self->columns * self->rows));
  }
  return cloth_work_is_stopped (work) ? NULL : &self->light;
}

/* @renderer: a renderer that has drawn
 * @capture: the camera
 * @frame: number of the picture
 * @seed: of the noise
 * @n_planes: 1 for a grey picture, 3 for red, green and blue
 * @planes: (array length=n_planes): the first pixel of each plane
 * @strides: (array length=n_planes): bytes from one row to the next
 * @pixel_stride: bytes from one pixel to the next
 * @work: (nullable): when to stop; what isn't done then stays as it was
 *
 * Makes a picture of the light, once for each drawing: change of the light across the
 * picture, defocus, crosstalk of the colours, the transfer curve of sRGB, noise, whole
 * levels. The noise is a function of seed, frame, pixel and channel only.
 */
void
cloth_renderer_develop (ClothRenderer * renderer,
    const ClothCapture * capture, guint64 frame, guint64 seed, guint n_planes,
    guint8 * const *planes, const gint * strides, gint pixel_stride,
    const ClothWork * work)
{
  cloth_sensor_develop (renderer->sensor, renderer->pool, capture,
      &renderer->light, frame, seed, n_planes, planes, strides, pixel_stride,
      work);
}
