/* Decides how far a residual is above what it would be without a gap, vertex by vertex.
 *
 * Model: a force f that the simulation lacks shows as a distance of f/(m·gain) from the observer's
 * targets: at once, but not only where it acts. Across the cloth the springs hold against the
 * tension of the cloth, which drags the next vertex along; along it against its stretch, which
 * drags whole rows. Part of that is undone by a Laplacian, as far as noise allows.
 * Formula, for the parts x along the normal and along the cloth:
 *   excess = ρ (|x|/σ)² − 1,  σ² = noise + share² · mean square of the null,
 * with Huber's ρ (1964), quadratic up to the gate and linear beyond.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/localise/excess.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"

/* Where a simulation was not nudged, it is off for a while once it is nudged again, but not for
 * longer than this, s. */
#define RETURN_S 0.15
/* Least null of a vertex, of the median of all. */
#define LEAST_NULL 0.25

/* @options: (out caller-allocates): how places are found unless the caller changes it
 */
void
cloth_localisation_options_init (ClothLocalisationOptions * options)
{
  *options = (ClothLocalisationOptions) {
  .smooth_s = 0.1,.sharpen = 0.5,.gate =
        2.,.null_alike = 0.3,.null_other = 1.,.doubt = 1.,.block_s =
        0.5,.draws = 99,.significance = 0.05,.onset_ratio =
        2.,.onset_evidence = 3.,.beginning_s = 0.3};
}

/* A residual along the normal and along the cloth, each [n_frames][n][3]. */
typedef struct
{
  const ClothRecording *recording;
  gfloat *parts[2];
  guint8 *known;
} Split;

static void
split_clear (Split * split)
{
  g_free (split->parts[0]);
  g_free (split->parts[1]);
  g_free (split->known);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Split, split_clear);

/* What was seen, and had been long enough for the simulation to be back. */
static guint8 *
find_known (const ClothRecording * r)
{
  guint8 *known = g_new0 (guint8, (gsize) r->n_frames * r->n);
  gdouble frame_s = (r->times[r->n_frames - 1] - r->times[0]) /
      (r->n_frames - 1);
  guint longest = (guint) round (RETURN_S / frame_s);

  for (guint v = 0; v < r->n; v++) {
    /* at first it moves as noise has it */
    guint away = 0, wait = longest;

    for (guint frame = 0; frame < r->n_frames; frame++) {
      gsize at = (gsize) frame * r->n + v;

      if (r->seen[at] == 0.) {
        away++;
        continue;
      }
      /* one lost frame is no matter */
      wait = away ? MAX (wait, MIN (away - 1, longest)) : wait;
      away = 0;
      known[at] = frame && !wait;
      wait -= wait > 0;
    }
  }
  return known;
}

/* Normals at all vertices, not of unit length. */
static void
find_normals (const ClothTopology * t, const gdouble * y, gdouble * normals)
{
  memset (normals, 0, 3 * (gsize) t->n_vertices * sizeof *normals);
  for (guint f = 0; f < t->n_faces; f++) {
    const guint32 *face = t->faces + 4 * (gsize) f;
    guint n = face[3] == CLOTH_NO_VERTEX ? 3 : 4;
    const gdouble *a = y + 3 * (gsize) face[0], *b = y + 3 * (gsize) face[1];
    const gdouble *c = y + 3 * (gsize) face[2], *d =
        y + 3 * (gsize) face[n - 1];
    const gdouble *e = n == 3 ? a : b;

    /* cross product of the diagonals, or of two sides */
    for (guint k = 0; k < 3; k++) {
      guint i = (k + 1) % 3, j = (k + 2) % 3;
      gdouble across = n == 3 ?
          (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]) :
          (c[i] - a[i]) * (d[j] - e[j]) - (c[j] - a[j]) * (d[i] - e[i]);

      for (guint corner = 0; corner < n; corner++)
        normals[3 * (gsize) face[corner] + k] += across;
    }
  }
}

/* @less, if any, is taken off; where it ends nothing is known any more. */
static void
split_init (Split * split, const ClothNudgedResidual * nudged,
    const ClothNudgedResidual * less)
{
  const ClothRecording *r = nudged->recording;
  gsize all = (gsize) r->n_frames * r->n;
  const gsize both = less ? MIN (all, (gsize) less->recording->n_frames *
      r->n) : 0;
  g_autofree gdouble *normals = g_new (gdouble, 3 * (gsize) r->n);

  split->recording = r;
  split->known = find_known (r);
  if (less) {
    g_autofree guint8 *other = find_known (less->recording);

    for (gsize i = 0; i < all; i++)
      split->known[i] &= i < both && other[i];
  }
  for (guint p = 0; p < 2; p++)
    split->parts[p] = g_new0 (gfloat, 3 * all);
  for (guint frame = 0; frame < r->n_frames; frame++) {
    find_normals (r->scene->topology, r->y + 3 * (gsize) frame * r->n, normals);
    for (guint v = 0; v < r->n; v++) {
      gsize at = (gsize) frame * r->n + v;
      const gdouble *normal = normals + 3 * (gsize) v;
      gdouble off[3], along = 0., square = 0.;

      for (guint k = 0; k < 3; k++) {
        off[k] = nudged->off[3 * at + k] - (at < both ? less->off[3 * at +
                k] : 0.f);
        along += off[k] * normal[k];
        square += normal[k] * normal[k];
      }
      split->known[at] &= isfinite (off[0] + off[1] + off[2]) != 0;
      for (guint k = 0; k < 3 && split->known[at]; k++) {
        gdouble part = square > 0. ? along * normal[k] / square : 0.;

        split->parts[0][3 * at + k] = (gfloat) part;
        split->parts[1][3 * at + k] = (gfloat) (off[k] - part);
      }
    }
  }
}

/* Means over @width frames of what is known, if at least half of them are. */
static void
smooth (Split * split, guint width)
{
  const ClothRecording *r = split->recording;
  guint n = r->n_frames, half = width / 2;
  gsize all = (gsize) n * r->n;
  g_autofree guint8 *known = g_new0 (guint8, all);

  for (guint p = 0; p < 2; p++) {
    gfloat *from = split->parts[p], *to = g_new0 (gfloat, 3 * all);

    for (guint frame = 0; frame < n; frame++)
      for (guint v = 0; v < r->n; v++) {
        gdouble sums[3] = { 0. };
        gsize at = (gsize) frame * r->n + v;
        guint count = 0;

        for (guint i = frame - MIN (half, frame);
            i <= MIN (frame + half, n - 1); i++) {
          gsize other = (gsize) i * r->n + v;

          count += split->known[other];
          for (guint k = 0; k < 3; k++)
            sums[k] += from[3 * other + k];
        }
        known[at] = 2 * count >= width;
        for (guint k = 0; k < 3 && known[at]; k++)
          to[3 * at + k] = (gfloat) (sums[k] / count);
      }
    g_free (from);
    split->parts[p] = to;
  }
  memcpy (split->known, known, all);
}

/* Each vertex and its neighbours along edges: [n + 1] where they begin, then they. */
static guint *
list_neighbours (const ClothTopology * t)
{
  guint n = t->n_vertices;
  g_autoptr (GHashTable) edges = g_hash_table_new_full (g_int64_hash,
      g_int64_equal, g_free, NULL);
  GHashTableIter iter;
  gint64 *edge;
  guint *list, *fill;

  for (guint f = 0; f < t->n_faces; f++) {
    const guint32 *face = t->faces + 4 * (gsize) f;
    guint sides = face[3] == CLOTH_NO_VERTEX ? 3 : 4;

    for (guint i = 0; i < sides; i++) {
      guint a = face[i], b = face[(i + 1) % sides];

      for (guint way = 0; way < 2; way++) {
        edge = g_new (gint64, 1);
        *edge = way ? (gint64) a *n + b : (gint64) b *n + a;
        g_hash_table_add (edges, edge);
      }
    }
  }
  list = g_new0 (guint, n + 1 + g_hash_table_size (edges));
  fill = g_new0 (guint, n + 1);
  g_hash_table_iter_init (&iter, edges);
  while (g_hash_table_iter_next (&iter, (gpointer *) & edge, NULL))
    list[*edge / n + 1]++;
  list[0] = n + 1;
  for (guint v = 0; v < n; v++) {
    list[v + 1] += list[v];
    fill[v] = list[v];
  }
  /* in the order of the faces, whatever the hash */
  for (guint f = 0; f < t->n_faces; f++) {
    const guint32 *face = t->faces + 4 * (gsize) f;
    guint sides = face[3] == CLOTH_NO_VERTEX ? 3 : 4;

    for (guint i = 0; i < sides; i++)
      for (guint way = 0; way < 2; way++) {
        guint a = face[(i + way) % sides], b = face[(i + 1 - way) % sides];
        gint64 key = (gint64) a * n + b;

        if (g_hash_table_remove (edges, &key))
          list[fill[a]++] = b;
      }
  }
  g_free (fill);
  return list;
}

/* Takes off what comes from the neighbours: x − amount·Laplacian. */
static void
sharpen (const Split * split, guint part, const guint * neighbours,
    gdouble amount)
{
  const ClothRecording *r = split->recording;
  g_autofree gfloat *row = g_new (gfloat, 3 * (gsize) r->n);

  for (guint frame = 0; frame < r->n_frames && amount > 0.; frame++) {
    gfloat *x = split->parts[part] + 3 * (gsize) frame * r->n;
    const guint8 *known = split->known + (gsize) frame * r->n;

    memcpy (row, x, 3 * (gsize) r->n * sizeof *x);
    for (guint v = 0; v < r->n; v++) {
      guint begin = neighbours[v], end = neighbours[v + 1];
      gdouble each = amount * MIN (1., 4. / (end - begin));

      for (guint i = begin; i < end && known[v]; i++)
        for (guint k = 0; k < 3 && known[neighbours[i]]; k++)
          x[3 * v + k] += (gfloat) (each * (row[3 * v + k] -
                  row[3 * neighbours[i] + k]));
    }
  }
}

/* Smoothed and sharpened. */
static void
prepare (Split * split, gboolean smoothed, const ClothLocalisationOptions * o,
    const guint * neighbours, guint * width)
{
  const ClothRecording *r = split->recording;
  gdouble frame_s = (r->times[r->n_frames - 1] - r->times[0]) /
      (r->n_frames - 1);

  *width = 1;
  if (!smoothed)
    return;
  *width = 2 * (guint) (o->smooth_s / frame_s / 2.) + 1;
  smooth (split, *width);
  for (guint part = 0; part < 2; part++)
    sharpen (split, part, neighbours, o->sharpen);
}

static gdouble
square_of (const Split * split, guint part, gsize at)
{
  const gfloat *x = split->parts[part] + 3 * at;

  return (gdouble) x[0] * x[0] + (gdouble) x[1] * x[1] + (gdouble) x[2] * x[2];
}

/* Mean square of each vertex over time, per axis. */
static gdouble *
find_means (const Split * split, guint part)
{
  const ClothRecording *r = split->recording;
  gdouble *means = g_new0 (gdouble, r->n);

  for (guint v = 0; v < r->n; v++) {
    guint count = 0;

    for (guint frame = 0; frame < r->n_frames; frame++) {
      gsize at = (gsize) frame * r->n + v;

      count += split->known[at];
      means[v] += split->known[at] ? square_of (split, part, at) : 0.;
    }
    means[v] /= MAX (count, 1) * (part ? 2. : 1.);
  }
  return means;
}

static void
raise_least (gdouble * values, guint n)
{
  g_autofree gdouble *sorted = g_memdup2 (values, n * sizeof *values);
  const gdouble least = MAX (LEAST_NULL * cloth_median (sorted, n), 1e-18);

  for (guint v = 0; v < n; v++)
    values[v] = MAX (values[v], least);
}

/* Adds Huber's square of what is over the null. */
static void
add (ClothExcess * excess, const Split * split, guint part,
    const gdouble * nulls, gdouble gate)
{
  for (gsize i = 0; i < (gsize) excess->n_frames * excess->n; i++) {
    gdouble q = sqrt (square_of (split, part, i) / (part ? 2. : 1.) /
        nulls[i % excess->n]);

    if (split->known[i])
      excess->values[i] += (gfloat) ((q < gate ? q * q : gate * (2. * q - gate))
          - 1.);
  }
}

static ClothExcess *
excess_new (const Split * split)
{
  const ClothRecording *r = split->recording;
  ClothExcess *excess = g_new0 (ClothExcess, 1);

  excess->n = r->n;
  excess->n_frames = r->n_frames;
  excess->values = g_new0 (gfloat, (gsize) r->n * r->n_frames);
  excess->known = g_memdup2 (split->known, (gsize) r->n * r->n_frames);
  return excess;
}

/* @take: a residual
 * @nulls: those of simulations that lack nothing; the larger counts
 * @n_nulls: how many
 * @alike: whether the first moves as the take does: it is taken off, frame by frame
 * @smooth: whether to smooth and sharpen, for the place; else it is for the time
 * @options: how
 *
 * Returns: (transfer full): its excess */
ClothExcess *
cloth_excess_new (const ClothNudgedResidual * take,
    const ClothNudgedResidual * nulls, guint n_nulls, gboolean alike,
    gboolean smooth, const ClothLocalisationOptions * options)
{
  const ClothRecording *r = take->recording;
  g_autofree guint *neighbours = list_neighbours (r->scene->topology);
  gdouble share = alike ? options->null_alike : options->null_other;
  gdouble noise = isfinite (r->sigma) ? r->sigma * r->sigma : 0.;
  g_autofree gdouble *means = g_new0 (gdouble, 2 * (gsize) r->n);
  g_auto (Split) split = { NULL };
  ClothExcess *excess;
  guint width;

  for (guint i = 0; i < n_nulls; i++) {
    g_auto (Split) null = { NULL };

    split_init (&null, &nulls[i], NULL);
    prepare (&null, smooth, options, neighbours, &width);
    for (guint part = 0; part < 2; part++) {
      g_autofree gdouble *here = find_means (&null, part);

      for (guint v = 0; v < r->n; v++)
        means[part * r->n + v] = MAX (means[part * r->n + v], here[v]);
    }
  }
  split_init (&split, take, alike ? nulls : NULL);
  prepare (&split, smooth, options, neighbours, &width);
  if (alike && isfinite (nulls->recording->sigma))
    noise += nulls->recording->sigma * nulls->recording->sigma;
  excess = excess_new (&split);
  for (guint part = 0; part < 2; part++) {
    gdouble *null = means + part * r->n;
    gdouble b = smooth ? options->sharpen : 0.;
    /* white noise in the mean, and in the difference to four neighbours */
    gdouble left = ((1. + 4. * b) * (1. + 4. * b) + 4. * b * b) / width;

    for (guint v = 0; v < r->n; v++)
      null[v] = left * noise + share * share * null[v];
    raise_least (null, r->n);
    add (excess, &split, part, null, options->gate);
  }
  return excess;
}

/* @null: the residual of a simulation that lacks nothing
 * @options: how
 *
 * Returns: (transfer full): its excess over its own mean of each vertex */
ClothExcess *
cloth_excess_new_null (const ClothNudgedResidual * null,
    const ClothLocalisationOptions * options)
{
  const ClothRecording *r = null->recording;
  g_autofree guint *neighbours = list_neighbours (r->scene->topology);
  g_auto (Split) split = { NULL };
  ClothExcess *excess;
  guint width;

  split_init (&split, null, NULL);
  prepare (&split, TRUE, options, neighbours, &width);
  excess = excess_new (&split);
  for (guint part = 0; part < 2; part++) {
    g_autofree gdouble *nulls = find_means (&split, part);

    raise_least (nulls, r->n);
    add (excess, &split, part, nulls, options->gate);
  }
  return excess;
}

/* @excess: (nullable) (transfer full): an excess */
void
cloth_excess_free (ClothExcess * excess)
{
  if (!excess)
    return;
  g_free (excess->values);
  g_free (excess->known);
  g_free (excess);
}
