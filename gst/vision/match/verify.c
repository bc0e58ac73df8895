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

struct _ClothVerifier
{
  ClothDelaunay *delaunay;
  GArray *members;              /* guint: features, by group */
  GArray *live;                 /* guint: those that are triangulated, by place */
  GArray *flat;                 /* guint: the same, by place on the flat cloth */
  GArray *ranks;                /* guint: where in live a feature is */
  GArray *places;               /* guint: first of either of each place, and the end */
  GArray *points;               /* gdouble */
  GArray *pairs, *starts;       /* guint: neighbouring places by the lower one */
  GArray *edges;                /* Edge: between features */
  GArray *asked;                /* Asked: by a hash of the two features */
  GArray *nodes;                /* Node */
  GArray *of_node, *links;      /* guint: edges of each node that vote on others */
};

typedef struct
{
  ClothVerifier *self;
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

/* Returns: (transfer full): room to verify in, for one thread at a time
 */
ClothVerifier *
cloth_verifier_new (void)
{
  ClothVerifier *self = g_new (ClothVerifier, 1);

  self->delaunay = cloth_delaunay_new ();
  self->members = numbers ();
  self->live = numbers ();
  self->flat = numbers ();
  self->ranks = numbers ();
  self->places = numbers ();
  self->points = g_array_new (FALSE, FALSE, sizeof (gdouble));
  self->pairs = numbers ();
  self->starts = numbers ();
  self->edges = g_array_new (FALSE, FALSE, sizeof (Edge));
  self->asked = g_array_new (FALSE, FALSE, sizeof (Asked));
  self->nodes = g_array_new (FALSE, FALSE, sizeof (Node));
  self->of_node = numbers ();
  self->links = numbers ();
  return self;
}

/* @verifier: (nullable) (transfer full): what to free
 */
void
cloth_verifier_free (ClothVerifier * verifier)
{
  if (!verifier)
    return;
  cloth_delaunay_free (verifier->delaunay);
  g_array_unref (verifier->members);
  g_array_unref (verifier->live);
  g_array_unref (verifier->flat);
  g_array_unref (verifier->ranks);
  g_array_unref (verifier->places);
  g_array_unref (verifier->points);
  g_array_unref (verifier->pairs);
  g_array_unref (verifier->starts);
  g_array_unref (verifier->edges);
  g_array_unref (verifier->asked);
  g_array_unref (verifier->nodes);
  g_array_unref (verifier->of_node);
  g_array_unref (verifier->links);
  g_free (verifier);
}

/* ---- edges ---- */

static Vote
ask (const Run * run, guint a, guint b)
{
  const ClothCvFeatures *f = run->features;
  const ClothReferenceFeatures *r = run->reference;
  const guint ra = run->matches[a].reference, rb = run->matches[b].reference;
  const gfloat from[2] = { f->x[a], f->y[a] }, to[2] = { f->x[b], f->y[b] };
  const gdouble alpha = run->metres_per_pixel;
  const gdouble distance = alpha * hypot (r->x[ra] - r->x[rb],
      r->y[ra] - r->y[rb]);
  ClothStretchRange range;

  if (hypot (to[0] - from[0], to[1] - from[1]) > run->params.reach
      || !cloth_stretch_get_range (&run->params.stretch, run->surface, from,
          to, alpha * sqrt (r->scale[ra] / f->scale[a] * r->scale[rb]
              / f->scale[b]), &range) || range.broken)
    return ABSTAINS;
  /* whichever sides they show: over the crease of a fold the surface goes on */
  return distance >= range.least
      && distance <= range.most ? IN_FAVOUR : AGAINST;
}

/* An edge of the flat cloth: the straight line between its ends is no longer. */
static Vote
ask_flat (const Run * run, guint a, guint b)
{
  const ClothCvFeatures *f = run->features;
  const ClothReferenceFeatures *r = run->reference;
  const guint ra = run->matches[a].reference, rb = run->matches[b].reference;
  const gfloat from[2] = { f->x[a], f->y[a] }, to[2] = { f->x[b], f->y[b] };
  const gdouble alpha = run->metres_per_pixel;
  const gdouble distance = alpha * hypot (r->x[ra] - r->x[rb],
      r->y[ra] - r->y[rb]);
  gdouble least;

  if (!cloth_stretch_get_least (&run->params.stretch, run->surface, from, to,
          alpha * sqrt (r->scale[ra] / f->scale[a] * r->scale[rb]
              / f->scale[b]), &least))
    return ABSTAINS;
  return distance >= least ? IN_FAVOUR : AGAINST;
}

/* A table with room for what a few triangulations ask; what comes later isn't kept. */
static void
forget (Run * run, guint n)
{
  guint size = 64;

  while (size < 16 * n)
    size *= 2;
  g_array_set_size (run->self->asked, size);
  memset (run->self->asked->data, 0, size * sizeof (Asked));
}

static Vote
ask_once (Run * run, guint a, guint b)
{
  const guint64 key = ((guint64) MIN (a, b) << 32 | MAX (a, b)) + 1;
  const guint mask = run->self->asked->len - 1;
  Asked *asked = (Asked *) run->self->asked->data;
  guint at = (guint) ((key * G_GUINT64_CONSTANT (0x9e3779b97f4a7c15)) >> 32);

  for (gint tries = 0; tries < 8; tries++, at++) {
    Asked *here = &asked[at & mask];

    if (here->key == key)
      return here->vote;
    if (here->key == 0) {
      *here = (Asked) {
      key, ask (run, MIN (a, b), MAX (a, b))};
      return here->vote;
    }
  }
  return ask (run, MIN (a, b), MAX (a, b));
}

static void
connect (Run * run, guint a, guint b, gboolean flat)
{
  const Edge edge = { a, b, flat ? ask_flat (run, a, b) : ask_once (run, a,
        b)
  };

  if (edge.vote != ABSTAINS)
    g_array_append_val (run->self->edges, edge);
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
connect_places (Run * run, guint p, guint q, gboolean flat)
{
  const GArray *from = flat ? run->self->flat : run->self->live;
  const guint *places = (const guint *) run->self->places->data;
  const guint *a = (const guint *) from->data + places[p];
  const guint *b = (const guint *) from->data + places[q];
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
connect_triangles (Run * run, const guint * triangles, guint n_triangles,
    guint n_places, gboolean flat)
{
  ClothVerifier *self = run->self;
  guint *starts = (guint *) g_array_set_size (self->starts, n_places + 1)->data;
  guint *pairs = (guint *) g_array_set_size (self->pairs,
      3 * n_triangles)->data;

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

/* Adds the edges of the live ones, in the picture or on the flat cloth. */
static void
add_edges (Run * run, gboolean flat)
{
  ClothVerifier *self = run->self;
  const ClothCvFeatures *f = run->features;
  const ClothReferenceFeatures *r = run->reference;
  const GArray *from = flat ? self->flat : self->live;
  const guint *triangles;
  gdouble last[2] = { 0, 0 };
  guint n_places, n_triangles;

  g_array_set_size (self->places, 0);
  g_array_set_size (self->points, 0);
  for (guint k = 0; k < from->len; k++) {
    const guint i = g_array_index (from, guint, k);
    const guint of = run->matches[i].reference;
    const gdouble point[2] = { flat ? r->x[of] : f->x[i],
      flat ? r->y[of] : f->y[i]
    };

    if (k && point[0] == last[0] && point[1] == last[1])
      continue;
    g_array_append_val (self->places, k);
    g_array_append_vals (self->points, point, 2);
    memcpy (last, point, sizeof last);
  }
  n_places = self->places->len;
  g_array_append_val (self->places, from->len);
  triangles = cloth_delaunay_run (self->delaunay, n_places,
      (const gdouble *) self->points->data, USUAL, &n_triangles);
  for (guint p = 0; p < n_places; p++)
    connect_places (run, p, p, flat);
  if (n_triangles)
    connect_triangles (run, triangles, n_triangles, n_places, flat);
  else                          /* all on a line */
    for (guint p = 0; p + 1 < n_places; p++)
      connect_places (run, p, p + 1, flat);
}

/* Makes the edges of the matched ones of @n @members, with @flat also those on the flat
 * cloth. */
static void
triangulate (Run * run, const guint * members, guint n, gboolean flat)
{
  ClothVerifier *self = run->self;
  guint *live;

  g_array_set_size (self->live, 0);
  g_array_set_size (self->edges, 0);
  for (guint k = 0; k < n; k++)
    if (run->matches[members[k]].state == CLOTH_MATCH_MATCHED)
      g_array_append_val (self->live, members[k]);
  if (!self->live->len)
    return;
  g_array_sort_with_data (self->live, compare_places, (gpointer) run->features);
  live = (guint *) self->live->data;
  g_array_set_size (self->ranks, run->features->n);
  for (guint k = 0; k < self->live->len; k++)
    g_array_index (self->ranks, guint, live[k]) = k;
  add_edges (run, FALSE);
  if (!flat)
    return;
  g_array_set_size (self->flat, 0);
  g_array_append_vals (self->flat, live, self->live->len);
  g_array_sort_with_data (self->flat, compare_flat_places, run);
  add_edges (run, TRUE);
}

/* ---- votes ---- */

/* Groups or live features: the number of the node of a feature. */
static guint
find_node (const Run * run, guint feature, gboolean groups)
{
  return groups ? run->matches[feature].group
      : g_array_index (run->self->ranks, guint, feature);
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
  ClothVerifier *self = run->self;
  const Edge *edges = (const Edge *) self->edges->data;
  const guint *live = (const guint *) self->live->data;
  Node *nodes = (Node *) g_array_set_size (self->nodes, n_nodes)->data;
  guint *of_node = (guint *) g_array_set_size (self->of_node,
      n_nodes + 1)->data;
  guint *links = (guint *) g_array_set_size (self->links,
      2 * self->edges->len)->data;

  if (n_nodes > 0)
    memset (nodes, 0, n_nodes * sizeof *nodes);
  memset (of_node, 0, (n_nodes + 1) * sizeof *of_node);
  for (guint k = 0; k < self->live->len; k++) {
    const ClothMatch *match = &run->matches[live[k]];

    if (groups)
      nodes[match->group].size++;
    else
      nodes[k].size = G_MAXUINT32 - match->distance;
  }
  for (guint e = 0; e < self->edges->len; e++) {
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
  for (guint e = 0; e < self->edges->len; e++) {
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

/* The node with the poorest mean vote below the least; @n_nodes when all pass. */
static guint
find_poorest (const Run * run, gdouble vote, guint n_nodes)
{
  const Node *nodes = (const Node *) run->self->nodes->data;
  guint poorest = n_nodes;

  for (guint i = 0; i < n_nodes; i++) {
    const Node *node = &nodes[i];

    if (!node->out && node->n && node->n_for < vote * node->n
        && (poorest == n_nodes || is_poorer (node, &nodes[poorest])))
      poorest = i;
  }
  return poorest;
}

/* Takes the votes of node @out away from its neighbours. */
static void
withdraw (Run * run, guint out, gboolean groups)
{
  const ClothVerifier *self = run->self;
  const Edge *edges = (const Edge *) self->edges->data;
  const guint *of_node = (const guint *) self->of_node->data;
  const guint *links = (const guint *) self->links->data;
  Node *nodes = (Node *) self->nodes->data;

  nodes[out].out = TRUE;
  for (guint k = of_node[out]; k < of_node[out + 1]; k++) {
    const Edge *edge = &edges[links[k]];
    const guint a = find_node (run, edge->a, groups);
    const guint b = find_node (run, edge->b, groups);
    Node *other = &nodes[a == out ? b : a];

    other->n--;
    other->n_for -= edge->vote == IN_FAVOUR;
  }
}

/* Refuses features of @members until all that are left pass.
 *
 * Returns: how many
 */
static guint
refuse_features (Run * run, const guint * members, guint n, gboolean flat)
{
  guint n_refused = 0;

  for (gint round = 0; round < ROUNDS; round++) {
    const guint before = n_refused;
    guint n_nodes, poorest;

    triangulate (run, members, n, flat);
    n_nodes = run->self->live->len;
    count (run, FALSE, n_nodes);
    while ((poorest = find_poorest (run, run->params.vote, n_nodes)) < n_nodes) {
      withdraw (run, poorest, FALSE);
      run->matches[g_array_index (run->self->live, guint, poorest)].state =
          CLOTH_MATCH_REFUSED;
      n_refused++;
    }
    if (n_refused == before)
      break;
  }
  return n_refused;
}

static guint
refuse_groups (Run * run, const guint * members, guint n, guint n_groups)
{
  guint n_refused = 0;

  for (gint round = 0; round < ROUNDS; round++) {
    const guint before = n_refused;
    guint poorest;

    triangulate (run, members, n, TRUE);
    count (run, TRUE, n_groups);
    while ((poorest =
            find_poorest (run, run->params.group_vote, n_groups)) < n_groups)
      withdraw (run, poorest, TRUE);
    for (guint k = 0; k < n; k++) {
      ClothMatch *match = &run->matches[members[k]];

      if (match->state == CLOTH_MATCH_MATCHED
          && g_array_index (run->self->nodes, Node, match->group).out) {
        match->state = CLOTH_MATCH_REFUSED;
        n_refused++;
      }
    }
    if (n_refused == before)
      break;
  }
  return n_refused;
}

/* Those that too few neighbours vote on. */
static guint
refuse_lonely (Run * run, const guint * members, guint n)
{
  const GArray *live = run->self->live;
  guint n_refused = 0;

  triangulate (run, members, n, FALSE);
  count (run, FALSE, live->len);
  for (guint k = 0; k < live->len; k++)
    if (g_array_index (run->self->nodes, Node, k).n < run->params.support) {
      run->matches[g_array_index (live, guint, k)].state = CLOTH_MATCH_REFUSED;
      n_refused++;
    }
  return n_refused;
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

/* @verifier: room to work in
 * @params: which votes pass
 * @reference: what was matched with
 * @features: of a picture
 * @surface: (nullable): the cloth's surface in that picture
 * @matches: (inout) (array): one a feature; it only refuses
 * @verification: (out): counts
 */
void
cloth_verifier_run (ClothVerifier * verifier, const ClothVerifyParams * params,
    const ClothReference * reference, const ClothCvFeatures * features,
    const ClothMatchSurface * surface, ClothMatch * matches,
    ClothVerification * verification)
{
  Run run = { verifier, *params, cloth_reference_get_features (reference),
    cloth_reference_get_metres_per_pixel (reference), features, surface,
    matches
  };
  const guint n_groups = sort_by_group (&run), n = verifier->members->len;
  const guint *members = (const guint *) verifier->members->data;

  *verification = (ClothVerification) {
  0};
  run.params.stretch = cloth_stretch_clamp_params (&params->stretch);
  forget (&run, n);
  for (guint first = 0, end; first < n; first = end) {
    const guint group = matches[members[first]].group;

    for (end = first + 1; end < n && matches[members[end]].group == group;)
      end++;
    verification->n_refused_within += refuse_features (&run, members + first,
        end - first, FALSE);
  }
  verification->n_refused_groups = refuse_groups (&run, members, n, n_groups);
  verification->n_refused_among = refuse_features (&run, members, n, TRUE);
  verification->n_refused_among += refuse_lonely (&run, members, n);
  for (guint k = 0; k < n; k++)
    verification->n_verified += matches[members[k]].state
        == CLOTH_MATCH_MATCHED;
}
