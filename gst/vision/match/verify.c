/* Votes on the edges of the Delaunay triangulation of the matched features.
 *
 * D. Pritchard and W. Heidrich (2003), section 4.3: an edge votes for its ends when their
 * places on the flat cloth are as far apart as the cloth allows. The feature with the
 * poorest mean vote is refused, until all that are left pass: within each group; then whole
 * groups, by the edges between groups; then features among all. Edges over which the surface
 * is broken don't vote: what a fold hides isn't known.
 *
 * What is added: groups are also held against each other by the triangulation of their
 * places on the flat cloth. No two places are farther apart in space than along the cloth,
 * whatever is folded or hidden between them, and each place is seen once. So a group of a
 * repeated print that has no neighbour in the picture still contradicts the one that shows
 * its place.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/verify.h"

#include <math.h>
#include <string.h>

#include "gst/math/delaunay.h"

/* Triangulations of a pass at most: each but the last refuses something. */
#define ROUNDS 8
/* Usual distance of features, px. */
#define USUAL 10.0
/* Features of a place that another one is asked about at most. Where thousands of a film claim
 * one place of the print, as of a print that repeats, all pairs would take gigabytes. */
#define CROWD 16
/* Nodes of which the poorest is known together, unless it is stale. */
#define BLOCK 64
#define STALE G_MAXUINT

typedef enum
{
  AGAINST,
  IN_FAVOUR,
  ABSTAINS
} Vote;

typedef struct
{
  guint a, b;
  Vote vote;
} Edge;

typedef struct
{
  guint n, n_for;               /* votes */
  guint size;                   /* features of a group; how unlike a feature is */
  gboolean out;
} Node;

/* What has been asked: later triangulations have mostly the same edges. */
typedef struct
{
  guint64 key;                  /* 0: empty */
  Vote vote;
} Asked;

/* Features that are neighbours in one plane, the picture or the flat cloth. */
typedef struct
{
  ClothDelaunay *delaunay;
  GArray *sorted;               /* guint: live features, by place */
  GArray *places;               /* guint: first of sorted of each place, and the end */
  GArray *points;               /* gdouble */
  GArray *pairs, *starts;       /* guint: neighbouring places by the lower one */
  GArray *edges;                /* Edge: between features */
} Net;

enum
{
  PICTURE,
  FLAT,
  N_NETS
};

/* Of one thread. */
typedef struct
{
  Net nets[N_NETS];             /* with all that vote in the edges of the first one */
  guint n_picture;              /* edges of these that are of the picture */
  GArray *ranks;                /* guint: where a feature is in the picture's order */
  GArray *asked;                /* Asked: by a hash of the two features */
  GArray *nodes;                /* Node */
  GArray *poorest;              /* guint: of each block of nodes, or STALE */
  GArray *of_node, *links;      /* guint: edges of each node that vote on others */
  gboolean flat, fresh;         /* whether nothing was refused since the edges were made */
} Room;

/* Features of one group in members. */
typedef struct
{
  guint begin, end, n_refused;
} Span;

struct _ClothVerifier
{
  GArray *members;              /* guint: features, by group */
  GArray *starts;               /* guint */
  GArray *spans;                /* Span: the largest first */
  GArray *rooms;                /* Room */
};

typedef struct
{
  ClothVerifier *self;
  Room *room;
  ClothVerifyParams params;
  const ClothReferenceFeatures *reference;
  gdouble metres_per_pixel;
  const ClothCvFeatures *features;
  const ClothMatchSurface *surface;
  ClothMatch *matches;
} Run;

/* Returns: a feature stays with three quarters of the votes; as measured on rendered cloth,
 *   where k_s = 0.08 with half a pixel of slack leaves more that are right than 0.1
 */
ClothVerifyParams
cloth_verify_default_params (void)
{
  ClothVerifyParams params =
      { 0.75, 0.5, 3, 60, cloth_stretch_default_params () };

  params.stretch.stretch = 0.08;
  params.stretch.slack = 0.5;
  return params;
}

static GArray *
numbers (void)
{
  return g_array_new (FALSE, FALSE, sizeof (guint));
}

/* Returns: (transfer full): room to verify in
 */
ClothVerifier *
cloth_verifier_new (void)
{
  ClothVerifier *self = g_new (ClothVerifier, 1);

  self->members = numbers ();
  self->starts = numbers ();
  self->spans = g_array_new (FALSE, FALSE, sizeof (Span));
  self->rooms = g_array_new (FALSE, FALSE, sizeof (Room));
  return self;
}

static void
make_rooms (ClothVerifier * self, guint n)
{
  while (self->rooms->len < n) {
    Room room = { 0 };

    for (gint k = 0; k < N_NETS; k++)
      room.nets[k] = (Net) {
      cloth_delaunay_new (), numbers (), numbers (),
          g_array_new (FALSE, FALSE, sizeof (gdouble)), numbers (),
          numbers (), g_array_new (FALSE, FALSE, sizeof (Edge))};
    room.ranks = numbers ();
    room.asked = g_array_new (FALSE, FALSE, sizeof (Asked));
    room.nodes = g_array_new (FALSE, FALSE, sizeof (Node));
    room.poorest = numbers ();
    room.of_node = numbers ();
    room.links = numbers ();
    g_array_append_val (self->rooms, room);
  }
}

static void
clear_room (Room * room)
{
  for (gint k = 0; k < N_NETS; k++) {
    const Net *net = &room->nets[k];

    cloth_delaunay_free (net->delaunay);
    g_array_unref (net->sorted);
    g_array_unref (net->places);
    g_array_unref (net->points);
    g_array_unref (net->pairs);
    g_array_unref (net->starts);
    g_array_unref (net->edges);
  }
  g_array_unref (room->ranks);
  g_array_unref (room->asked);
  g_array_unref (room->nodes);
  g_array_unref (room->poorest);
  g_array_unref (room->of_node);
  g_array_unref (room->links);
}

/* @verifier: (nullable) (transfer full): what to free
 */
void
cloth_verifier_free (ClothVerifier * verifier)
{
  if (!verifier)
    return;
  for (guint i = 0; i < verifier->rooms->len; i++)
    clear_room (&g_array_index (verifier->rooms, Room, i));
  g_array_unref (verifier->members);
  g_array_unref (verifier->starts);
  g_array_unref (verifier->spans);
  g_array_unref (verifier->rooms);
  g_free (verifier);
}

/* ---- edges ---- */

/* @from, @to: in the picture, px
 * @distance: on the flat cloth, m
 * @by_scale: metres a pixel of the picture, as the features' scales tell */
typedef struct
{
  gfloat from[2], to[2];
  gdouble distance, by_scale;
} Line;

static Line
line_between (const Run * run, guint a, guint b)
{
  const ClothCvFeatures *f = run->features;
  const ClothReferenceFeatures *r = run->reference;
  const guint ra = run->matches[a].reference, rb = run->matches[b].reference;
  const gdouble alpha = run->metres_per_pixel;

  return (Line) {
    {
    f->x[a], f->y[a]}
    , {
    f->x[b], f->y[b]}
    , alpha * hypot (r->x[ra]
        - r->x[rb], r->y[ra] - r->y[rb]),
        alpha * sqrt (r->scale[ra] / f->scale[a] * r->scale[rb] / f->scale[b])
  };
}

static Vote
ask (const Run * run, guint a, guint b)
{
  const Line line = line_between (run, a, b);
  ClothStretchRange range;

  if (hypot (line.to[0] - line.from[0],
          line.to[1] - line.from[1]) > run->params.reach
      || !cloth_stretch_get_range (&run->params.stretch, run->surface,
          line.from, line.to, line.by_scale, &range) || range.broken)
    return ABSTAINS;
  /* whichever sides they show: over the crease of a fold the surface goes on */
  return line.distance >= range.least
      && line.distance <= range.most ? IN_FAVOUR : AGAINST;
}

/* An edge of the flat cloth: the straight line between its ends is no longer. */
static Vote
ask_flat (const Run * run, guint a, guint b)
{
  const Line line = line_between (run, a, b);
  gdouble least;

  if (!cloth_stretch_get_least (&run->params.stretch, run->surface, line.from,
          line.to, line.by_scale, &least))
    return ABSTAINS;
  return line.distance >= least ? IN_FAVOUR : AGAINST;
}

/* Tables with room for what a few triangulations ask; what comes later isn't kept. */
static void
forget (Run * run, guint n)
{
  guint size = 64;

  while (size < 16 * n)
    size *= 2;
  for (guint i = 0; i < run->self->rooms->len; i++) {
    GArray *asked = g_array_index (run->self->rooms, Room, i).asked;

    g_array_set_size (asked, size);
    memset (asked->data, 0, size * sizeof (Asked));
  }
}

/* Where the answer is, or could be kept; %NULL if there is no room for it. */
static Asked *
look_up (const GArray * table, guint64 key)
{
  const guint mask = table->len - 1;
  Asked *asked = (Asked *) table->data;
  guint at = (guint) ((key * G_GUINT64_CONSTANT (0x9e3779b97f4a7c15)) >> 32);

  for (gint tries = 0; tries < 8; tries++, at++)
    if (asked[at & mask].key == key || asked[at & mask].key == 0)
      return &asked[at & mask];
  return NULL;
}

static Vote
ask_once (const Run * run, guint a, guint b)
{
  const guint64 key = ((guint64) MIN (a, b) << 32 | MAX (a, b)) + 1;
  Asked *here = look_up (run->room->asked, key);
  Vote vote;

  if (here && here->key == key)
    return here->vote;
  vote = ask (run, MIN (a, b), MAX (a, b));
  if (here)
    *here = (Asked) {
    key, vote};
  return vote;
}

/* The first thread learns what the others have asked. */
static void
tell (const Run * run)
{
  for (guint i = 1; i < run->self->rooms->len; i++) {
    const GArray *from = g_array_index (run->self->rooms, Room, i).asked;

    for (guint k = 0; k < from->len; k++) {
      const Asked *asked = &g_array_index (from, Asked, k);
      Asked *to = asked->key ? look_up (run->room->asked, asked->key) : NULL;

      if (to)
        *to = *asked;
    }
  }
}

static void
connect (const Run * run, guint a, guint b, gboolean flat)
{
  const Edge edge = { a, b, flat ? ask_flat (run, a, b) : ask_once (run, a,
        b)
  };

  if (edge.vote != ABSTAINS)
    g_array_append_val (run->room->nets[flat].edges, edge);
}

static gint
compare_places (gconstpointer pa, gconstpointer pb, gpointer data)
{
  const ClothCvFeatures *f = data;
  const guint a = *(const guint *) pa, b = *(const guint *) pb;

  if (f->x[a] != f->x[b])
    return f->x[a] < f->x[b] ? -1 : 1;
  if (f->y[a] != f->y[b])
    return f->y[a] < f->y[b] ? -1 : 1;
  return a < b ? -1 : a > b;
}

static gint
compare_flat_places (gconstpointer pa, gconstpointer pb, gpointer data)
{
  const Run *run = data;
  const ClothReferenceFeatures *r = run->reference;
  const guint a = *(const guint *) pa, b = *(const guint *) pb;
  const guint ra = run->matches[a].reference, rb = run->matches[b].reference;

  if (r->x[ra] != r->x[rb])
    return r->x[ra] < r->x[rb] ? -1 : 1;
  if (r->y[ra] != r->y[rb])
    return r->y[ra] < r->y[rb] ? -1 : 1;
  return a < b ? -1 : a > b;
}

/* Features of two neighbouring places, or of one; each with @CROWD of a place at most. */
static void
connect_places (const Run * run, guint p, guint q, gboolean flat)
{
  const Net *net = &run->room->nets[flat];
  const guint *places = (const guint *) net->places->data;
  const guint *a = (const guint *) net->sorted->data + places[p];
  const guint *b = (const guint *) net->sorted->data + places[q];
  const guint n_a = places[p + 1] - places[p];
  const guint n_b = places[q + 1] - places[q];

  for (guint i = 0; i < n_a; i++) {
    /* evenly spread, so that those of the other place are all asked about as often */
    const guint first = p == q ? i + 1 : (guint) ((guint64) i * n_b / n_a);
    const guint n = MIN (p == q ? n_a - first : n_b, CROWD);

    for (guint k = 0; k < n; k++)
      connect (run, a[i], b[(first + k) % n_b], flat);
  }
}

/* The edges of the triangles, each once. */
static void
connect_triangles (const Run * run, const guint * triangles,
    guint n_triangles, guint n_places, gboolean flat)
{
  const Net *net = &run->room->nets[flat];
  guint *starts = (guint *) g_array_set_size (net->starts, n_places + 1)->data;
  guint *pairs = (guint *) g_array_set_size (net->pairs, 3 * n_triangles)->data;

  memset (starts, 0, (n_places + 1) * sizeof *starts);
  for (guint k = 0; k < 3 * n_triangles; k++) {
    const guint next = k % 3 < 2 ? k + 1 : k - 2;

    starts[MIN (triangles[k], triangles[next]) + 1]++;
  }
  for (guint p = 0; p < n_places; p++)
    starts[p + 1] += starts[p];
  for (guint k = 0; k < 3 * n_triangles; k++) {
    const guint a = triangles[k], b = triangles[k % 3 < 2 ? k + 1 : k - 2];

    pairs[starts[MIN (a, b)]++] = MAX (a, b);
  }
  /* each start is now the next one's */
  for (guint p = 0; p < n_places; p++)
    for (guint i = p ? starts[p - 1] : 0, first = i; i < starts[p]; i++) {
      gboolean again = FALSE;

      for (guint j = first; j < i; j++)
        again |= pairs[j] == pairs[i];
      if (!again)
        connect_places (run, p, pairs[i], flat);
    }
}

/* Makes the edges of the live ones, in the picture or on the flat cloth. */
static void
make_net (const Run * run, gboolean flat)
{
  const Net *net = &run->room->nets[flat];
  const ClothCvFeatures *f = run->features;
  const ClothReferenceFeatures *r = run->reference;
  const guint *triangles;
  gdouble last[2] = { 0, 0 };
  guint n_places, n_triangles;

  g_array_set_size (net->places, 0);
  g_array_set_size (net->points, 0);
  g_array_set_size (net->edges, 0);
  for (guint k = 0; k < net->sorted->len; k++) {
    const guint i = g_array_index (net->sorted, guint, k);
    const guint of = run->matches[i].reference;
    const gdouble point[2] = { flat ? r->x[of] : f->x[i],
      flat ? r->y[of] : f->y[i]
    };

    if (k && point[0] == last[0] && point[1] == last[1])
      continue;
    g_array_append_val (net->places, k);
    g_array_append_vals (net->points, point, 2);
    memcpy (last, point, sizeof last);
  }
  n_places = net->places->len;
  g_array_append_val (net->places, net->sorted->len);
  triangles = cloth_delaunay_run (net->delaunay, n_places,
      (const gdouble *) net->points->data, USUAL, &n_triangles);
  for (guint p = 0; p < n_places; p++)
    connect_places (run, p, p, flat);
  if (n_triangles)
    connect_triangles (run, triangles, n_triangles, n_places, flat);
  else                          /* all on a line */
    for (guint p = 0; p + 1 < n_places; p++)
      connect_places (run, p, p + 1, flat);
}

static void
make_nets (gpointer data, guint begin, guint end, guint worker)
{
  for (guint k = begin; k < end; k++)
    make_net (data, k == FLAT);
}

/* Begins with @n @members that are matched, with @flat also on the flat cloth. */
static void
take (Run * run, const guint * members, guint n, gboolean flat)
{
  Room *room = run->room;

  room->flat = flat;
  room->fresh = FALSE;
  for (gint k = 0; k <= flat; k++) {
    GArray *sorted = g_array_set_size (room->nets[k].sorted, 0);

    g_array_append_vals (sorted, members, n);
    if (k == FLAT)
      g_array_sort_with_data (sorted, compare_flat_places, run);
    else
      g_array_sort_with_data (sorted, compare_places, (gpointer) run->features);
  }
}

static void
drop_refused (const Run * run, GArray * features)
{
  guint *f = (guint *) features->data, n = 0;

  for (guint k = 0; k < features->len; k++)
    if (run->matches[f[k]].state == CLOTH_MATCH_MATCHED)
      f[n++] = f[k];
  g_array_set_size (features, n);
}

/* Makes the edges of those that were taken and aren't refused, unless they are there. */
static void
triangulate (Run * run, ClothPool * pool)
{
  Room *room = run->room;
  GArray *live = room->nets[PICTURE].sorted, *edges = room->nets[PICTURE].edges;
  guint *ranks;

  if (room->fresh)
    return;
  room->fresh = TRUE;
  for (gint k = 0; k <= room->flat; k++)
    drop_refused (run, room->nets[k].sorted);
  ranks = (guint *) g_array_set_size (room->ranks, run->features->n)->data;
  for (guint k = 0; k < live->len; k++)
    ranks[g_array_index (live, guint, k)] = k;
  cloth_pool_run (pool, make_nets, run, room->flat ? 2 : 1);
  room->n_picture = edges->len;
  if (room->flat)
    g_array_append_vals (edges, room->nets[FLAT].edges->data,
        room->nets[FLAT].edges->len);
}

/* ---- votes ---- */

/* Groups or live features: the number of the node of a feature. */
static guint
find_node (const Run * run, guint feature, gboolean groups)
{
  return groups ? run->matches[feature].group
      : g_array_index (run->room->ranks, guint, feature);
}

/* Whether the edges between two groups vote on @group: on the smaller one only, or a few
 * features of wrong seeds would outvote a large group, which has few edges outwards. */
static gboolean
is_judged (const Node * nodes, guint group, guint other)
{
  return nodes[group].size != nodes[other].size
      ? nodes[group].size < nodes[other].size : group > other;
}

/* Edges between nodes, and their votes. */
static void
count (Run * run, gboolean groups, guint n_nodes)
{
  Room *room = run->room;
  const GArray *voting = room->nets[PICTURE].edges;
  const Edge *edges = (const Edge *) voting->data;
  const GArray *live = room->nets[PICTURE].sorted;
  Node *nodes = (Node *) g_array_set_size (room->nodes, n_nodes)->data;
  guint *of_node = (guint *) g_array_set_size (room->of_node,
      n_nodes + 1)->data;
  guint *links = (guint *) g_array_set_size (room->links,
      2 * voting->len)->data;
  const guint n_blocks = (n_nodes + BLOCK - 1) / BLOCK;

  if (n_nodes > 0)
    memset (nodes, 0, n_nodes * sizeof *nodes);
  memset (of_node, 0, (n_nodes + 1) * sizeof *of_node);
  g_array_set_size (room->poorest, n_blocks);
  for (guint b = 0; b < n_blocks; b++)
    g_array_index (room->poorest, guint, b) = STALE;
  for (guint k = 0; k < live->len; k++) {
    const ClothMatch *match = &run->matches[g_array_index (live, guint, k)];

    if (groups)
      nodes[match->group].size++;
    else
      nodes[k].size = G_MAXUINT32 - match->distance;
  }
  for (guint e = 0; e < voting->len; e++) {
    const guint ends[2] = { find_node (run, edges[e].a, groups),
      find_node (run, edges[e].b, groups)
    };

    if (ends[0] == ends[1])
      continue;
    for (gint k = 0; k < 2; k++) {
      if (groups && !is_judged (nodes, ends[k], ends[1 - k]))
        continue;
      nodes[ends[k]].n++;
      nodes[ends[k]].n_for += edges[e].vote == IN_FAVOUR;
      of_node[ends[1 - k]]++;
    }
  }
  for (guint i = 0, sum = 0; i <= n_nodes; i++) {
    const guint here = i < n_nodes ? of_node[i] : 0;

    of_node[i] = sum;
    sum += here;
  }
  for (guint e = 0; e < voting->len; e++) {
    const guint a = find_node (run, edges[e].a, groups);
    const guint b = find_node (run, edges[e].b, groups);

    if (a == b)
      continue;
    if (!groups || is_judged (nodes, b, a))
      links[of_node[a]++] = e;
    if (!groups || is_judged (nodes, a, b))
      links[of_node[b]++] = e;
  }
  memmove (of_node + 1, of_node, n_nodes * sizeof *of_node);
  of_node[0] = 0;
}

/* Whether the mean vote of @a is poorer than that of @b; of equal ones the smaller group or
 * less alike feature is. */
static gboolean
is_poorer (const Node * a, const Node * b)
{
  const guint64 left = (guint64) a->n_for * b->n;
  const guint64 right = (guint64) b->n_for * a->n;

  return left != right ? left < right : a->size < b->size;
}

static guint
find_poorest_of (const Node * nodes, gdouble vote, guint begin, guint end,
    guint none)
{
  guint poorest = none;

  for (guint i = begin; i < end; i++) {
    const Node *node = &nodes[i];

    if (!node->out && node->n && node->n_for < vote * node->n
        && (poorest == none || is_poorer (node, &nodes[poorest])))
      poorest = i;
  }
  return poorest;
}

/* The node with the poorest mean vote below the least; @n_nodes when all pass. Only blocks
 * that votes were taken from are looked at again. */
static guint
find_poorest (const Run * run, gdouble vote, guint n_nodes)
{
  const Node *nodes = (const Node *) run->room->nodes->data;
  guint *of_block = (guint *) run->room->poorest->data;
  guint poorest = n_nodes;

  for (guint b = 0; b < run->room->poorest->len; b++) {
    if (of_block[b] == STALE)
      of_block[b] = find_poorest_of (nodes, vote, b * BLOCK,
          MIN ((b + 1) * BLOCK, n_nodes), n_nodes);
    if (of_block[b] != n_nodes && (poorest == n_nodes
            || is_poorer (&nodes[of_block[b]], &nodes[poorest])))
      poorest = of_block[b];
  }
  return poorest;
}

/* Takes the votes of node @out away from its neighbours. */
static void
withdraw (Run * run, guint out, gboolean groups)
{
  const Room *room = run->room;
  const Edge *edges = (const Edge *) room->nets[PICTURE].edges->data;
  const guint *of_node = (const guint *) room->of_node->data;
  const guint *links = (const guint *) room->links->data;
  Node *nodes = (Node *) room->nodes->data;
  guint *of_block = (guint *) room->poorest->data;

  nodes[out].out = TRUE;
  of_block[out / BLOCK] = STALE;
  for (guint k = of_node[out]; k < of_node[out + 1]; k++) {
    const Edge *edge = &edges[links[k]];
    const guint a = find_node (run, edge->a, groups);
    const guint b = find_node (run, edge->b, groups);
    const guint other = a == out ? b : a;

    nodes[other].n--;
    nodes[other].n_for -= edge->vote == IN_FAVOUR;
    of_block[other / BLOCK] = STALE;
  }
}

static void
refuse (Run * run, guint feature)
{
  run->matches[feature].state = CLOTH_MATCH_REFUSED;
  run->room->fresh = FALSE;
}

/* Refuses features of those that were taken until all that are left pass.
 *
 * Returns: how many
 */
static guint
refuse_features (Run * run, ClothPool * pool)
{
  const GArray *live = run->room->nets[PICTURE].sorted;
  guint n_refused = 0;

  for (gint round = 0; round < ROUNDS; round++) {
    const guint before = n_refused;
    guint poorest;

    triangulate (run, pool);
    count (run, FALSE, live->len);
    while ((poorest = find_poorest (run, run->params.vote,
                live->len)) < live->len) {
      withdraw (run, poorest, FALSE);
      refuse (run, g_array_index (live, guint, poorest));
      n_refused++;
    }
    if (n_refused == before)
      break;
  }
  return n_refused;
}

static guint
refuse_groups (Run * run, guint n_groups, ClothPool * pool)
{
  const GArray *live = run->room->nets[PICTURE].sorted;
  guint n_refused = 0;

  for (gint round = 0; round < ROUNDS; round++) {
    const guint before = n_refused;
    guint poorest;

    triangulate (run, pool);
    count (run, TRUE, n_groups);
    while ((poorest =
            find_poorest (run, run->params.group_vote, n_groups)) < n_groups)
      withdraw (run, poorest, TRUE);
    for (guint k = 0; k < live->len; k++) {
      const guint i = g_array_index (live, guint, k);

      if (g_array_index (run->room->nodes, Node, run->matches[i].group).out) {
        refuse (run, i);
        n_refused++;
      }
    }
    if (n_refused == before)
      break;
  }
  return n_refused;
}

/* Those that too few neighbours in the picture vote on. */
static guint
refuse_lonely (Run * run, ClothPool * pool)
{
  const Room *room = run->room;
  const GArray *live = room->nets[PICTURE].sorted;
  guint n_refused = 0;

  triangulate (run, pool);
  g_array_set_size (room->nets[PICTURE].edges, room->n_picture);
  count (run, FALSE, live->len);
  for (guint k = 0; k < live->len; k++)
    if (g_array_index (room->nodes, Node, k).n < run->params.support) {
      refuse (run, g_array_index (live, guint, k));
      n_refused++;
    }
  return n_refused;
}

/* Groups by themselves. */
static void
refuse_within (gpointer data, guint begin, guint end, guint worker)
{
  Run run = *(const Run *) data;

  run.room = &g_array_index (run.self->rooms, Room, worker);
  for (guint k = begin; k < end; k++) {
    Span *span = &g_array_index (run.self->spans, Span, k);

    take (&run, (const guint *) run.self->members->data + span->begin,
        span->end - span->begin, FALSE);
    span->n_refused = refuse_features (&run, NULL);
  }
}

/* Fills members with all that are matched, by group.
 *
 * Returns: one past the last group
 */
static guint
sort_by_group (Run * run)
{
  ClothVerifier *self = run->self;
  guint n_groups = 0, n = 0, *starts, *members;

  for (guint i = 0; i < run->features->n; i++)
    if (run->matches[i].state == CLOTH_MATCH_MATCHED) {
      n_groups = MAX (n_groups, run->matches[i].group + 1);
      n++;
    }
  starts = (guint *) g_array_set_size (self->starts, n_groups + 1)->data;
  members = (guint *) g_array_set_size (self->members, n)->data;
  memset (starts, 0, (n_groups + 1) * sizeof *starts);
  for (guint i = 0; i < run->features->n; i++)
    if (run->matches[i].state == CLOTH_MATCH_MATCHED)
      starts[run->matches[i].group + 1]++;
  for (guint g = 0; g < n_groups; g++)
    starts[g + 1] += starts[g];
  for (guint i = 0; i < run->features->n; i++)
    if (run->matches[i].state == CLOTH_MATCH_MATCHED)
      members[starts[run->matches[i].group]++] = i;
  return n_groups;
}

static gint
compare_spans (gconstpointer pa, gconstpointer pb)
{
  const Span *a = pa, *b = pb;
  const guint na = a->end - a->begin, nb = b->end - b->begin;

  if (na != nb)
    return na > nb ? -1 : 1;
  return a->begin < b->begin ? -1 : 1;
}

/* Returns: (transfer none): where each group is in members, the largest first. */
static const GArray *
sort_spans (Run * run)
{
  const GArray *members = run->self->members;
  GArray *spans = g_array_set_size (run->self->spans, 0);

  for (guint k = 0; k < members->len; k++) {
    const Span span = { k, k + 1, 0 };
    Span *last = spans->len ? &g_array_index (spans, Span,
        spans->len - 1) : NULL;

    if (last && run->matches[g_array_index (members, guint, k)].group
        == run->matches[g_array_index (members, guint, last->begin)].group)
      last->end++;
    else
      g_array_append_val (spans, span);
  }
  g_array_sort (spans, compare_spans);
  return spans;
}

/* @verifier: room to work in
 * @params: which votes pass
 * @reference: what was matched with
 * @features: of a picture
 * @surface: (nullable): the cloth's surface in that picture
 * @matches: (inout) (array): one a feature; it only refuses
 * @verification: (out): counts
 * @pool: (nullable): threads; the result doesn't depend on it
 */
void
cloth_verifier_run (ClothVerifier * verifier, const ClothVerifyParams * params,
    const ClothReference * reference, const ClothCvFeatures * features,
    const ClothMatchSurface * surface, ClothMatch * matches,
    ClothVerification * verification, ClothPool * pool)
{
  Run run = { verifier, NULL, *params,
    cloth_reference_get_features (reference),
    cloth_reference_get_metres_per_pixel (reference), features, surface,
    matches
  };
  const guint n_groups = sort_by_group (&run), n = verifier->members->len;
  const guint *members = (const guint *) verifier->members->data;
  const GArray *spans = sort_spans (&run);

  *verification = (ClothVerification) {
  0};
  run.params.stretch = cloth_stretch_clamp_params (&params->stretch);
  make_rooms (verifier, cloth_pool_get_n_threads (pool));
  run.room = (Room *) verifier->rooms->data;
  forget (&run, n);
  cloth_pool_run_one_by_one (pool, refuse_within, &run, spans->len);
  for (guint k = 0; k < spans->len; k++)
    verification->n_refused_within += g_array_index (spans, Span, k).n_refused;
  tell (&run);
  take (&run, members, n, TRUE);
  verification->n_refused_groups = refuse_groups (&run, n_groups, pool);
  verification->n_refused_among = refuse_features (&run, pool);
  verification->n_refused_among += refuse_lonely (&run, pool);
  verification->n_verified = n - verification->n_refused_within
      - verification->n_refused_groups - verification->n_refused_among;
}
