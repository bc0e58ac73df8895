/* The features of the flat picture, its oblique views and its back.
 *
 * D. Pritchard and W. Heidrich (2003), section 4.1. A view is the picture under
 * T = R(φ)·diag(1/t, 1)·R(−φ). What T squeezes is blurred before along its direction by
 * 0.8·√(t² − 1) px, as G. Yu and J.-M. Morel, “ASIFT” (2011) do, so that nothing aliases.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/reference.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/vision/match/reference-private.h"

#define BYTES CLOTH_CV_SIFT_BYTES
/* By how much metres a pixel may differ across and down. */
#define ASPECT 0.05
/* A feature found again under noise lies within so many px, and its scale and angle within
 * this share and radians. */
#define AGAIN_PX 1.0f
#define AGAIN_SCALE 0.2f
#define AGAIN_ANGLE 0.3f
/* Of features found again, the share that counts as themselves. */
#define AGAIN_SHARE 0.95
/* Elsewhere begins so many scales away. */
#define ELSEWHERE 3.0f
/* Taps of the blur on either side. */
#define TAPS 16

typedef struct
{
  gfloat x, y, scale, angle, seen;
  guint8 view, side, bytes[BYTES];
} Item;

/* Direction of each view's squeeze as steps of the grid, and by how much. */
static const struct
{
  gint dx, dy, factor;
} views[CLOTH_REFERENCE_VIEWS] = {
  {1, 0, 1}, {1, 0, 2}, {0, 1, 2}, {1, 1, 2}, {1, -1, 2},
  {1, 0, 4}, {0, 1, 4}, {1, 1, 4}, {1, -1, 4}
};

/* Returns: two sides, the views of half, noise of two grey levels, scales as measured on
 *   films of 0.6 times the flat picture's resolution; the cloth's size is to be given
 */
ClothReferenceParams
cloth_reference_default_params (void)
{
  return (ClothReferenceParams) {
  .sides = 2,.oblique = 1,.least_scale = 1.4,.seed_scale = 2.5,.sift =
        cloth_cv_sift_default_params (),.noise = 2};
}

static gfloat
wrap (gdouble angle)
{
  angle = fmod (angle, 2 * G_PI);
  return (gfloat) (angle < 0 ? angle + 2 * G_PI : angle);
}

/* Blurs @from along (@dx, @dy), whose steps reach pixels; the border goes on outside. */
static void
blur (const guint8 * from, gint width, gint height, gint dx, gint dy,
    gdouble sigma, guint8 * to)
{
  gdouble taps[2 * TAPS + 1], sum = 0;
  const gdouble step = hypot (dx, dy);

  for (gint k = -TAPS; k <= TAPS; k++)
    sum += taps[k + TAPS] = exp (-0.5 * k * k * step * step / (sigma * sigma));
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      gdouble value = 0;

      for (gint k = -TAPS; k <= TAPS; k++)
        value += taps[k + TAPS] *
            from[CLAMP (y + k * dy, 0, height - 1) * width
            + CLAMP (x + k * dx, 0, width - 1)];
      to[y * width + x] = (guint8) lrint (value / sum);
    }
}

/* The features of one view of @flat, which is @side of the cloth, back in its pixels. */
static gboolean
add_view (GArray * items, ClothCvSift * sift, const ClothCvPicture * flat,
    guint view, guint side, gdouble least_scale, GError ** error)
{
  const gint width = flat->width, height = flat->height;
  const gint factor = views[view].factor;
  const gdouble length = hypot (views[view].dx, views[view].dy);
  const gdouble ex = views[view].dx / length, ey = views[view].dy / length;
  const gdouble k = factor - 1.0;
  /* T⁻¹ = 1 + (t − 1)·e·eᵀ, T = 1 − (1 − 1/t)·e·eᵀ, both about the picture's middle */
  const gdouble back[3] = { 1 + k * ex * ex, k * ex * ey, 1 + k * ey * ey };
  const gdouble s = 1 - 1.0 / factor;
  const gint w = (gint) ceil (width * (1 - s * ex * ex)
      + height * fabs (s * ex * ey)), h = (gint) ceil (height * (1 -
          s * ey * ey) + width * fabs (s * ex * ey));
  const gdouble cx = (width - 1) / 2.0, cy = (height - 1) / 2.0;
  const gdouble vx = (w - 1) / 2.0, vy = (h - 1) / 2.0;
  g_autofree guint8 *soft = NULL, *seen = NULL;
  g_autofree gfloat *map = NULL;
  ClothCvPicture picture = *flat;
  ClothCvFeatures found;

  if (view) {
    soft = g_malloc ((gsize) width * height);
    seen = g_malloc ((gsize) w * h);
    map = g_new (gfloat, 2 * (gsize) w * h);
    blur (flat->data, width, height, views[view].dx, views[view].dy,
        0.8 * sqrt (factor * factor - 1.0), soft);
    for (gint y = 0; y < h; y++)
      for (gint x = 0; x < w; x++) {
        const gdouble u = cx + back[0] * (x - vx) + back[1] * (y - vy);
        const gdouble v = cy + back[1] * (x - vx) + back[2] * (y - vy);

        /* the border goes on outside, too: no edge that isn't printed */
        map[y * w + x] = (gfloat) CLAMP (u, 0, width - 1);
        map[(gsize) w * h + y * w + x] = (gfloat) CLAMP (v, 0, height - 1);
      }
    picture = (ClothCvPicture) {
    soft, width, height, width};
    if (!cloth_cv_remap (&picture, map, map + (gsize) w * h, w, h, seen, w,
            error))
      return FALSE;
    picture = (ClothCvPicture) {
    seen, w, h, w};
  }
  if (!cloth_cv_sift_run (sift, &picture, NULL, &found, error))
    return FALSE;
  for (guint i = 0; i < found.n; i++) {
    const gdouble dx = found.x[i] - (view ? vx : cx);
    const gdouble dy = found.y[i] - (view ? vy : cy);
    const gdouble ax = cos (found.angle[i]), ay = sin (found.angle[i]);
    Item item = { (gfloat) (cx + back[0] * dx + back[1] * dy),
      (gfloat) (cy + back[1] * dx + back[2] * dy),
      (gfloat) (found.scale[i] * sqrt (factor)),
      wrap (atan2 (back[1] * ax + back[2] * ay, back[0] * ax + back[1] * ay)),
      found.angle[i],
      (guint8) view, (guint8) side, {0}
    };

    if (item.scale < least_scale || item.x < 0 || item.x > width - 1
        || item.y < 0 || item.y > height - 1)
      continue;
    if (side) {
      item.x = (gfloat) (width - 1) - item.x;
      item.angle = wrap (G_PI - item.angle);
    }
    memcpy (item.bytes, found.descriptors + (gsize) i * BYTES, BYTES);
    g_array_append_val (items, item);
  }
  return TRUE;
}

/* The index of those that are large enough. */
static void
add_nearest (ClothReference * self, gdouble seed_scale)
{
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  guint n = 0;

  self->of_nearest = g_new (guint, MAX (self->features.n, 1));
  for (guint i = 0; i < self->features.n; i++)
    if (self->scale[i] >= seed_scale) {
      self->of_nearest[n++] = i;
      g_byte_array_append (bytes, self->descriptors + (gsize) i * BYTES, BYTES);
    }
  self->nearest = cloth_nearest_new (bytes->data, n);
}

static ClothReference *
build (const Item * items, guint n, gint width, gint height,
    const gdouble cloth_m[2], gdouble seed_scale)
{
  ClothReference *self = g_new0 (ClothReference, 1);
  const gsize room = MAX (n, 1);
  guint n_bins;

  self->columns = (width - 1) / CLOTH_REFERENCE_BIN + 1;
  self->rows = (height - 1) / CLOTH_REFERENCE_BIN + 1;
  n_bins = (guint) (2 * self->columns * self->rows);
  self->starts = g_new0 (guint, n_bins + 1);
  self->x = g_new (gfloat, room);
  self->y = g_new (gfloat, room);
  self->scale = g_new (gfloat, room);
  self->angle = g_new (gfloat, room);
  self->seen = g_new (gfloat, room);
  self->view = g_new (guint8, room);
  self->side = g_new (guint8, room);
  self->descriptors = g_malloc (room * BYTES);
  /* by counting: twice over the bins, so that those of one keep their order */
  for (gint pass = 0; pass < 2; pass++) {
    for (guint i = 0; i < n; i++) {
      const Item *item = &items[i];
      const gint bin = (item->side * self->rows +
          cloth_reference_bin (item->y, self->rows)) * self->columns +
          cloth_reference_bin (item->x, self->columns);
      guint to;

      if (pass == 0) {
        self->starts[bin + 1]++;
        continue;
      }
      to = self->starts[bin]++;
      self->x[to] = item->x;
      self->y[to] = item->y;
      self->scale[to] = item->scale;
      self->angle[to] = item->angle;
      self->seen[to] = item->seen;
      self->view[to] = item->view;
      self->side[to] = item->side;
      memcpy (self->descriptors + (gsize) to * BYTES, item->bytes, BYTES);
    }
    if (pass == 0)
      for (guint b = 0; b < n_bins; b++)
        self->starts[b + 1] += self->starts[b];
  }
  memmove (self->starts + 1, self->starts, n_bins * sizeof *self->starts);
  self->starts[0] = 0;
  self->features = (ClothReferenceFeatures) {
  n, width, height, self->x, self->y, self->scale, self->angle, self->view,
        self->side, self->descriptors};
  add_nearest (self, seed_scale);
  self->metres_per_pixel = sqrt (cloth_m[0] / width * (cloth_m[1] / height));
  return self;
}

static gboolean
check_size (gint width, gint height, const gdouble cloth_m[2], GError ** error)
{
  const gdouble across = cloth_m[0] / width, down = cloth_m[1] / height;

  if (!(cloth_m[0] > 0 && cloth_m[1] > 0 && cloth_m[0] < 1e3
          && cloth_m[1] < 1e3)) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
        "the pattern has no size: give the width and height of its picture "
        "on the cloth in metres, not %g × %g", cloth_m[0], cloth_m[1]);
    return FALSE;
  }
  if (fabs (log (across / down)) > ASPECT) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
        "%d × %d pixels are no picture of %g × %g m: a pixel would be %.3g mm "
        "across and %.3g mm down; give the size of what the picture shows",
        width, height, cloth_m[0], cloth_m[1], 1e3 * across, 1e3 * down);
    return FALSE;
  }
  return TRUE;
}

static gint
compare_distances (gconstpointer pa, gconstpointer pb)
{
  const guint32 a = *(const guint32 *) pa, b = *(const guint32 *) pb;

  return a < b ? -1 : a > b;
}

static guint32
distance (const guint8 * a, const guint8 * b)
{
  gint sum = 0;

  for (gint k = 0; k < BYTES; k++)
    sum += (a[k] - b[k]) * (a[k] - b[k]);
  return (guint32) sum;
}

/* What is looked at: the picture under noise first, then the views of each side. */
typedef struct
{
  const ClothReferenceParams *params;
  ClothCvPicture pictures[3];   /* under noise; of each side */
  guint n_views;                /* of a side */
  GArray *items[2 * CLOTH_REFERENCE_VIEWS + 1];
  GError *errors[2 * CLOTH_REFERENCE_VIEWS + 1];
} Looks;

static void
looks_clear (Looks * looks)
{
  for (guint i = 0; i < G_N_ELEMENTS (looks->items); i++) {
    g_clear_pointer (&looks->items[i], g_array_unref);
    g_clear_error (&looks->errors[i]);
  }
  for (guint i = 0; i < G_N_ELEMENTS (looks->pictures); i++)
    g_free ((gpointer) looks->pictures[i].data);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Looks, looks_clear);

static void
looks_init (Looks * looks, const ClothReferenceParams * params,
    const ClothCvPicture * picture)
{
  const gint width = picture->width, height = picture->height;
  ClothRandom random;

  looks->params = params;
  looks->n_views = 4 * (guint) params->oblique + 1;
  cloth_random_init (&random, 1);
  for (gint i = 0; i <= params->sides; i++) {
    guint8 *data = g_malloc ((gsize) width * height);

    looks->pictures[i] = (ClothCvPicture) {
    data, width, height, width};
    for (gint y = 0; y < height; y++)
      for (gint x = 0; x < width; x++) {
        const gdouble value = picture->data[(gsize) y * picture->stride +
            (i == 2 ? width - 1 - x : x)] +
            (i ? 0. : params->noise * cloth_random_gaussian (&random));

        data[y * width + x] = (guint8) lrint (CLAMP (value, 0, 255));
      }
  }
}

static void
look (gpointer data, guint begin, guint end, guint worker)
{
  Looks *looks = data;
  const ClothReferenceParams *params = looks->params;

  for (guint i = begin; i < end; i++) {
    g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (&params->sift,
        &looks->errors[i]);
    const guint side = i ? (i - 1) / looks->n_views : 0;

    looks->items[i] = g_array_new (FALSE, FALSE, sizeof (Item));
    if (sift)
      add_view (looks->items[i], sift, &looks->pictures[i ? 1 + side : 0],
          i ? (i - 1) % looks->n_views : 0, side, i ? params->least_scale : 0.,
          &looks->errors[i]);
  }
}

/* How far from itself a feature gets under noise: the quantile %AGAIN_SHARE of those that are
 * found again, squared; 0 when none is. */
static guint32
measure_noise (const ClothReference * self, const GArray * noisy)
{
  g_autoptr (GArray) distances = g_array_new (FALSE, FALSE, sizeof (guint32));

  for (guint i = 0; i < noisy->len; i++) {
    const Item *found = &g_array_index (noisy, Item, i);
    const gint row = cloth_reference_bin (found->y, self->rows);
    const gint column = cloth_reference_bin (found->x, self->columns);
    const guint *start = self->starts + row * self->columns + column;
    guint32 least = G_MAXUINT32;

    for (guint k = start[0]; k < start[1]; k++)
      if (self->view[k] == 0 && fabsf (self->x[k] - found->x) < AGAIN_PX
          && fabsf (self->y[k] - found->y) < AGAIN_PX
          && fabsf (self->scale[k] / found->scale - 1) < AGAIN_SCALE
          && cos (self->angle[k] - found->angle) > cos (AGAIN_ANGLE))
        least = MIN (least, distance (self->descriptors + (gsize) k * BYTES,
                found->bytes));
    if (least < G_MAXUINT32)
      g_array_append_val (distances, least);
  }
  g_array_sort (distances, compare_distances);
  return distances->len ? g_array_index (distances, guint32,
      (guint) (AGAIN_SHARE * (distances->len - 1))) : 0;
}

/* @params: what is looked for
 * @picture: the flat picture; its edges are those of the cloth's size
 * @pool: (nullable): threads that look at views, and compare features
 * @error: (out): set when there is no size, a parameter is out of range, the picture can't
 *   be or has no feature
 *
 * Returns: (transfer full): the features of all views; %NULL with @error set
 */
ClothReference *
cloth_reference_new (const ClothReferenceParams * params,
    const ClothCvPicture * picture, ClothPool * pool, GError ** error)
{
  g_autoptr (ClothReference) self = NULL;
  g_auto (Looks) looks = { NULL };
  const gint width = picture->width, height = picture->height;
  GArray *items;
  guint n;

  if (params->sides < 1 || params->sides > 2 || params->oblique < 0
      || params->oblique > 2 || !(params->noise >= 0 && params->noise <= 64)) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
        "sides are 1 or 2, oblique is 0 to 2, noise 0 to 64 grey levels, not "
        "%d, %d, %g", params->sides, params->oblique, params->noise);
    return NULL;
  }
  if (width < 2 || height < 2 || width > CLOTH_CV_MAX_SIZE
      || height > CLOTH_CV_MAX_SIZE || picture->stride < width) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "a picture of %d × %d pixels can't be a reference", width, height);
    return NULL;
  }
  if (!check_size (width, height, params->cloth_m, error))
    return NULL;
  looks_init (&looks, params, picture);
  n = (guint) params->sides * looks.n_views + 1;
  cloth_pool_run_one_by_one (pool, look, &looks, n);
  for (guint i = 0; i < n; i++)
    if (looks.errors[i]) {
      g_propagate_error (error, g_steal_pointer (&looks.errors[i]));
      return NULL;
    }
  items = looks.items[1];
  for (guint i = 2; i < n; i++)
    g_array_append_vals (items, looks.items[i]->data, looks.items[i]->len);
  if (!items->len) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "the reference has no feature: it needs a print with edges");
    return NULL;
  }
  self = build (&g_array_index (items, Item, 0), items->len, width, height,
      params->cloth_m, params->seed_scale);
  self->repeated = cloth_reference_find_repeated (self,
      measure_noise (self, looks.items[0]), pool);
  return g_steal_pointer (&self);
}

/* @features: in any order, which are copied
 * @cloth_m: width and height of the picture on the cloth, metres
 * @seed_scale: features of smaller scale are not compared with seeds
 * @error: (out): set when there is no size
 *
 * Returns: (transfer full): the features; %NULL with @error set
 */
ClothReference *
cloth_reference_new_from_features (const ClothReferenceFeatures * features,
    const gdouble cloth_m[2], gdouble seed_scale, GError ** error)
{
  g_autofree Item *items = g_new (Item, MAX (features->n, 1));

  if (features->width < 1 || features->height < 1) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PICTURE,
        "a picture of %d × %d pixels can't be a reference", features->width,
        features->height);
    return NULL;
  }
  if (!check_size (features->width, features->height, cloth_m, error))
    return NULL;
  for (guint i = 0; i < features->n; i++) {
    items[i] = (Item) {
      features->x[i], features->y[i], features->scale[i],
          features->angle[i],
          features->side[i] ? wrap (G_PI - features->angle[i])
          : features->angle[i], features->view[i], features->side[i] != 0, {
      0}
    };
    memcpy (items[i].bytes, features->descriptors + (gsize) i * BYTES, BYTES);
  }
  return build (items, features->n, features->width, features->height, cloth_m,
      seed_scale);
}

/* @reference: (nullable) (transfer full): what to free
 */
void
cloth_reference_free (ClothReference * reference)
{
  if (!reference)
    return;
  cloth_nearest_free (reference->nearest);
  g_free (reference->of_nearest);
  g_free (reference->starts);
  g_free (reference->x);
  g_free (reference->y);
  g_free (reference->scale);
  g_free (reference->angle);
  g_free (reference->seen);
  g_free (reference->view);
  g_free (reference->side);
  g_free (reference->descriptors);
  g_free (reference);
}

/* Returns: (transfer none): the features, sorted by side and place
 */
const ClothReferenceFeatures *
cloth_reference_get_features (const ClothReference * reference)
{
  return &reference->features;
}

/* Returns: α_r, metres of cloth in a pixel of the flat picture
 */
gdouble
cloth_reference_get_metres_per_pixel (const ClothReference * reference)
{
  return reference->metres_per_pixel;
}

/* Returns: the share of flat features that another place shows as well, as far as noise
 *   lets one tell; 0 for a reference made from features
 */
gdouble
cloth_reference_get_repeated (const ClothReference * reference)
{
  return reference->repeated;
}

/* @reference: features
 * @distance: squared distance in feature space up to which two look the same
 * @pool: (nullable): threads that share the comparisons
 *
 * Those whose nearest lies at their own place are not counted: they don't tell.
 *
 * Returns: the share of flat features of the front that look the same elsewhere
 */
gdouble
cloth_reference_find_repeated (const ClothReference * reference,
    guint32 distance, ClothPool * pool)
{
  const ClothReferenceFeatures *f = &reference->features;
  g_autofree guint *of = g_new (guint, MAX (f->n, 1));
  g_autofree guint8 *bytes = g_malloc (MAX (f->n, 1) * (gsize) BYTES);
  g_autofree ClothNeighbours *found = g_new (ClothNeighbours, MAX (f->n, 1));
  g_autoptr (ClothNearest) nearest = NULL;
  guint n = 0, n_told = 0, n_repeated = 0;

  for (guint i = 0; i < f->n; i++)
    if (f->view[i] == 0 && f->side[i] == 0) {
      memcpy (bytes + (gsize) n * BYTES, f->descriptors + (gsize) i * BYTES,
          BYTES);
      of[n++] = i;
    }
  nearest = cloth_nearest_new (bytes, n);
  cloth_nearest_run (nearest, bytes, n, found, pool, CLOTH_SIMD_BEST);
  for (guint i = 0; i < n; i++) {
    const gboolean first = found[i].index != i;
    const guint32 other = first ? found[i].index : found[i].second;
    const guint32 far = first ? found[i].distance : found[i].second_distance;
    const guint a = of[i];
    guint b;

    if (other == CLOTH_NEAREST_NONE)
      continue;
    b = of[other];
    if (hypotf (f->x[a] - f->x[b], f->y[a] - f->y[b])
        < ELSEWHERE * MAX (f->scale[a], f->scale[b]))
      continue;
    n_told++;
    n_repeated += far <= distance;
  }
  return n_told ? (gdouble) n_repeated / n_told : 0;
}
