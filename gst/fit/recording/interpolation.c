/* Where vertices may have been while nobody saw them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/interpolation.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/outliers.h"
#include "gst/math/linalg.h"

/* Sweeps over the hidden vertices until none moves further than this, m. */
#define MAX_SWEEPS 200
#define SETTLED 1e-6

typedef struct
{
  ClothRecording *recording;
  gint *first, *last;           /* frames that know a vertex; none: all later, -1 */
  guint *clamp;                 /* of a vertex the first one; none: how many there are */
  gboolean *adrift;             /* it begins where those around it say */
  guint *begin, *neighbours;    /* of a vertex, in the mesh */
  gboolean *hidden;             /* how far a vertex moved is not known */
  gdouble *moved;               /* [n][3], m */
} Bridge;

static void
bridge_clear (Bridge * b)
{
  g_free (b->first);
  g_free (b->last);
  g_free (b->clamp);
  g_free (b->adrift);
  g_free (b->begin);
  g_free (b->neighbours);
  g_free (b->hidden);
  g_free (b->moved);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Bridge, bridge_clear);

static gdouble *
place (const Bridge * b, guint frame, guint vertex)
{
  return b->recording->y + 3 * ((gsize) frame * b->recording->n + vertex);
}

/* An edge of two faces counts twice: it is as much a neighbour. */
static void
link_vertices (Bridge * b)
{
  const ClothTopology *t = b->recording->scene->topology;
  guint n = b->recording->n;

  b->begin = g_new0 (guint, n + 2);
  for (guint pass = 0; pass < 2; pass++) {
    for (guint f = 0; f < t->n_faces; f++) {
      const guint32 *face = t->faces + 4 * (gsize) f;
      guint corners = face[3] == CLOTH_NO_VERTEX ? 3 : 4;

      for (guint i = 0; i < corners; i++)
        for (guint side = 1; side < corners; side += corners - 2) {
          guint at = face[i], other = face[(i + side) % corners];

          if (pass)
            b->neighbours[b->begin[at + 1]++] = other;
          else
            b->begin[at + 2]++;
        }
    }
    for (guint v = 0; v < n && !pass; v++)
      b->begin[v + 2] += b->begin[v + 1];
    if (!pass)
      b->neighbours = g_new (guint, b->begin[n + 1] + 1);
  }
}

/* What the hidden vertices moved: as their neighbours did, on the mean. The others' is in
 * @moved. */
static void
spread (Bridge * b)
{
  gdouble furthest = INFINITY;

  for (guint v = 0; v < b->recording->n; v++)
    if (b->hidden[v])
      memset (b->moved + 3 * v, 0, 3 * sizeof (gdouble));
  for (guint s = 0; s < MAX_SWEEPS && furthest > SETTLED; s++) {
    furthest = 0.;
    for (guint v = 0; v < b->recording->n; v++) {
      guint count = b->begin[v + 1] - b->begin[v];

      for (guint k = 0; b->hidden[v] && count && k < 3; k++) {
        gdouble *to = &b->moved[3 * v + k], sum = 0.;

        for (guint i = b->begin[v]; i < b->begin[v + 1]; i++)
          sum += b->moved[3 * b->neighbours[i] + k];
        furthest = MAX (furthest, fabs (sum / count - *to));
        *to = sum / count;
      }
    }
  }
}

/* Vertices that were not seen while they were held are where their clamps were, if that is known; others where
 * a simulation has them, if one was asked. */
static gboolean
find_known (Bridge * b, guint frame, guint vertex)
{
  const ClothRecording *r = b->recording;
  const ClothScene *scene = r->scene;

  if (r->seen[(gsize) frame * r->n + vertex] > 0.)
    return TRUE;
  /* one after the other may hold it */
  for (guint i = b->clamp[vertex]; i < scene->held->len; i++) {
    const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);
    const gdouble *path = scene->clamps +
        3 * ((gsize) frame * scene->held->len + i);

    if (held->vertex != vertex || !cloth_held_holds (held, r->times[frame])
        || isnan (path[0]))
      continue;
    memcpy (place (b, frame, vertex), path, 3 * sizeof *path);
    return TRUE;
  }
  return r->simulated && isfinite (*place (b, frame, vertex));
}

/* Even motion between the frames before and after that know the vertex. */
static void
bridge_between (Bridge * b, guint vertex)
{
  const ClothRecording *r = b->recording;
  gint last = -1;

  b->first[vertex] = (gint) r->n_frames;
  for (guint frame = 0; frame < r->n_frames; frame++) {
    if (!find_known (b, frame, vertex))
      continue;
    if (last < 0)
      b->first[vertex] = (gint) frame;
    for (guint f = (guint) (last + 1); last >= 0 && f < frame; f++) {
      const gdouble *from = place (b, (guint) last, vertex);
      const gdouble *to = place (b, frame, vertex);
      gdouble share = (r->times[f] - r->times[last]) / (r->times[frame] -
          r->times[last]);

      for (guint k = 0; k < 3; k++)
        place (b, f, vertex)[k] = from[k] + share * (to[k] - from[k]);
    }
    last = (gint) frame;
  }
  b->last[vertex] = last;
}

/* Whether going from @from to @frame is what gives the vertex its place there. */
static gboolean
is_filled (const Bridge * b, guint vertex, guint from, guint frame)
{
  const gboolean later = b->first[vertex] > (gint) frame;

  return frame < from ? later : b->last[vertex] < (gint) frame ||
      (later && b->adrift[vertex]);
}

/* Vertices that @frame does not know move to it from @from as their neighbours do. On the
 * way back those that nobody saw any more at @from have no place there yet to have moved
 * from: they are as hidden as the others, and stay where they are at @frame. */
static void
carry (Bridge * b, guint from, guint frame)
{
  const ClothRecording *r = b->recording;
  const gboolean back = frame < from;
  gboolean any = FALSE;

  for (guint v = 0; v < r->n; v++) {
    b->hidden[v] = is_filled (b, v, from, frame) || (back
        && b->last[v] < (gint) from);
    any |= is_filled (b, v, from, frame);
    for (guint k = 0; k < 3; k++)
      b->moved[3 * v + k] = place (b, frame, v)[k] - place (b, from, v)[k];
  }
  if (!any)
    return;
  spread (b);
  for (guint v = 0; v < r->n; v++)
    for (guint k = 0; is_filled (b, v, from, frame) && k < 3; k++)
      place (b, frame, v)[k] = place (b, from, v)[k] + b->moved[3 * v + k];
}

/* The plane over the flat cloth nearest to what the first frame saw: positions are
 * plane[k] · (1, u, v). */
static gboolean
fit_plane (const Bridge * b, gdouble plane[3][3])
{
  const ClothRecording *r = b->recording;
  gdouble normal[9] = { 0. };

  memset (plane, 0, 9 * sizeof (gdouble));
  for (guint v = 0; v < r->n; v++) {
    const gfloat *uv = r->scene->topology->uv + 2 * (gsize) v;
    gdouble terms[3] = { 1., uv[0], uv[1] };

    for (guint i = 0; b->first[v] == 0 && i < 3; i++)
      for (guint k = 0; k < 3; k++) {
        normal[3 * i + k] += terms[i] * terms[k];
        plane[k][i] += terms[i] * place (b, 0, v)[k];
      }
  }
  if (!cloth_cholesky_factor (3, normal))
    return FALSE;
  for (guint k = 0; k < 3; k++)
    cloth_cholesky_solve (3, normal, plane[k]);
  return TRUE;
}

/* Vertices adrift begin as far off the plane as those around them that the first frame
 * saw; where the scene starts them when it saw next to nothing. */
static void
start_adrift (Bridge * b)
{
  const ClothRecording *r = b->recording;
  const gfloat *uv = r->scene->topology->uv;
  gdouble plane[3][3];
  gboolean any = FALSE, flat;

  for (guint v = 0; v < r->n; v++)
    any |= b->adrift[v];
  if (!any)
    return;
  flat = fit_plane (b, plane);
  for (guint v = 0; v < r->n; v++) {
    b->hidden[v] = b->adrift[v] || b->first[v] > 0;
    for (guint k = 0; k < 3; k++)
      b->moved[3 * v + k] = place (b, 0, v)[k] - plane[k][0] -
          plane[k][1] * uv[2 * v] - plane[k][2] * uv[2 * v + 1];
  }
  spread (b);
  for (guint v = 0; v < r->n; v++)
    for (guint k = 0; b->adrift[v] && k < 3; k++)
      place (b, 0, v)[k] = flat ? plane[k][0] + plane[k][1] * uv[2 * v] +
          plane[k][2] * uv[2 * v + 1] + b->moved[3 * v + k] :
          r->scene->positions[3 * v + k];
}

/* What was seen later, and elsewhere, is no place to have begun at when that tears the
 * cloth. Returns whether there is more adrift than before. */
static gboolean
cut_loose (Bridge * b)
{
  const ClothRecording *r = b->recording;
  g_autoptr (ClothOutliers) outliers = cloth_outliers_new (r->scene->topology);
  gdouble *start = b->moved;
  gboolean any = FALSE;

  memcpy (start, place (b, 0, 0), 3 * (gsize) r->n * sizeof *start);
  if (!cloth_outliers_remove (outliers, 0., start))
    return FALSE;
  for (guint v = 0; v < r->n; v++)
    if (isnan (start[3 * v]) && b->first[v] > 0)
      b->adrift[v] = any = TRUE;
  return any;
}

/* @recording: a recording whose @y is known where @seen is 1, and where it is finite if a simulation says
 *   where places are that nobody saw
 *
 * Fills the rest of @y. A held vertex is where its clamp was. Between two frames that know
 * it a vertex moves evenly; before the first and after the last one it moves as its
 * neighbours in the mesh do, which keeps the cloth whole: a simulation that starts from a
 * crumpled patch would burst. One that would begin torn off begins between its neighbours.
 * Where the first frame is known otherwise the cloth is there.
 */
void
cloth_recording_interpolate (ClothRecording * recording)
{
  const guint n = recording->n;
  const gfloat *start = recording->start;
  g_auto (Bridge) b = { recording, g_new (gint, n), g_new (gint, n) };

  b.clamp = g_new (guint, n);
  for (guint v = 0; v < n; v++)
    b.clamp[v] = recording->scene->held->len;
  for (guint i = recording->scene->held->len; i-- > 0;)
    b.clamp[g_array_index (recording->scene->held, ClothHeld, i).vertex] = i;
  b.adrift = g_new0 (gboolean, n);
  b.hidden = g_new (gboolean, n);
  b.moved = g_new (gdouble, 3 * n);
  link_vertices (&b);
  for (guint v = 0; v < n; v++)
    bridge_between (&b, v);
  for (guint v = 0; v < n; v++)
    b.adrift[v] = b.last[v] < 0;
  for (guint frame = recording->n_frames - 1; frame-- > 0;)
    carry (&b, frame + 1, frame);
  start_adrift (&b);
  if (cut_loose (&b))
    start_adrift (&b);
  for (guint frame = 1; frame < recording->n_frames; frame++)
    carry (&b, frame - 1, frame);
  for (gsize i = 0; start && i < 3 * (gsize) n; i++)
    if (isfinite (start[i]))
      recording->y[i] = start[i];
}
