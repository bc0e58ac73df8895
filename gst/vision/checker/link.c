/* Joining saddle points into patches of a square grid.
 *
 * A corner of a checkerboard has four edges, one in each quarter between the bisectors
 * of its bright and its dark quadrants. Two corners are neighbours when the straight line
 * between them has bright pixels on one side and dark ones on the other all the way, and
 * when each is the other's nearest in that quarter. Four neighbours in a ring make a
 * square; squares that share an edge make a patch. Nothing here looks at the past: a
 * patch is found again however far the cloth has moved since the last picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/link.h"

#include <math.h>

#include "gst/vision/corner/edge.h"
#include "gst/vision/pointgrid.h"

/* Saddles looked at around each one: on a board without clutter the eight neighbours of
 * a corner contain its four, the rest is for clutter and oblique views. */
#define NEAREST 16
/* So many are looked at first, for they mostly do. */
#define NEARER 8
/* Shorter edges can't be told from noise, px. */
#define MIN_EDGE 3.0f
/* Contrast of a corner's weakest edge over that of its strongest. */
#define MIN_CONTRAST 0.3f
/* Neighbouring corners have their bright bisectors across: this far from 90°, rad. */
#define AXIS_TOLERANCE 0.75f
/* A link this much longer than its opposite, and with this slope to it, skips a corner. */
#define SKIP_LENGTH 1.7f
#define SKIP_SLOPE 0.27f

/* Patch numbers of saddles in no patch. */
#define UNSEEN -1
#define REJECTED -2

typedef struct
{
  gint to[4];                   /* saddle in each quarter, -1 for none */
  guint8 in_square;             /* bit s: the ring over quarters s and s + 1 closes */
  guint8 skips;                 /* bit s: the link in quarter s skips a corner */
  guint8 turn;                  /* quarter that points along the patch's columns */
} Corner;

struct _ClothLinker
{
  GArray *corners;              /* Corner */
  GArray *nodes;                /* ClothLinkNode */
  GArray *queue;                /* guint */
  GArray *patches;              /* ClothLinkPatch */
  GArray *vertex_pool;          /* gint, the patches' node arrays */
  GArray *square_pool;          /* guint8 */
  ClothPointGrid *grid;
};

/* Returns: (transfer full): a linker; it keeps its memory from picture to picture.
 */
ClothLinker *
cloth_linker_new (void)
{
  ClothLinker *linker = g_new0 (ClothLinker, 1);

  linker->corners = g_array_new (FALSE, FALSE, sizeof (Corner));
  linker->nodes = g_array_new (FALSE, FALSE, sizeof (ClothLinkNode));
  linker->queue = g_array_new (FALSE, FALSE, sizeof (guint));
  linker->patches = g_array_new (FALSE, FALSE, sizeof (ClothLinkPatch));
  linker->vertex_pool = g_array_new (FALSE, FALSE, sizeof (gint));
  linker->square_pool = g_array_new (FALSE, FALSE, sizeof (guint8));
  linker->grid = cloth_point_grid_new ();
  return linker;
}

void
cloth_linker_free (ClothLinker * linker)
{
  g_array_unref (linker->corners);
  g_array_unref (linker->nodes);
  g_array_unref (linker->queue);
  g_array_unref (linker->patches);
  g_array_unref (linker->vertex_pool);
  g_array_unref (linker->square_pool);
  cloth_point_grid_free (linker->grid);
  g_free (linker);
}

/* Fills the four neighbours of saddle @k: the nearest in each quarter whose edge is seen,
 * among the @n_near nearest saddles. Returns how many there are, weak ones included. */
static guint
look_around (const ClothLinker * linker, const ClothImage * image,
    const guint8 * levels, const ClothSaddle * saddles, gint k, gfloat reach,
    guint n_near, Corner * corner)
{
  const ClothSaddle *a = &saddles[k];
  gfloat axis_x = cosf (a->axis), axis_y = sinf (a->axis);
  ClothNear near[NEAREST];
  gfloat contrasts[4], strongest = 0;
  guint n = cloth_point_grid_nearest (linker->grid, a->x, a->y, reach, near,
      n_near), n_found = 0;

  for (gint s = 0; s < 4; s++)
    corner->to[s] = -1;
  for (guint m = 0; m < n && n_found < 4; m++) {
    const ClothSaddle *b = &saddles[near[m].index];
    gfloat dx = b->x - a->x, dy = b->y - a->y, across, contrast;
    gint quarter;

    if (near[m].distance2 < MIN_EDGE * MIN_EDGE)
      continue;
    across = fabsf (a->axis - b->axis);
    if (fabsf (across - (gfloat) G_PI_2) > AXIS_TOLERANCE)
      continue;
    if (dy * axis_x - dx * axis_y >= 0)
      quarter = dx * axis_x + dy * axis_y > 0 ? 0 : 1;
    else
      quarter = dx * axis_x + dy * axis_y < 0 ? 2 : 3;
    if (corner->to[quarter] >= 0)
      continue;
    /* In the first quarter the bright bisector lies behind and the dark one ahead. */
    contrast = levels ? cloth_edge_contrast_in_levels (image, levels, a->x,
        a->y, b->x, b->y) : cloth_edge_contrast (image, a->x, a->y, b->x, b->y);
    if (!(quarter & 1))
      contrast = -contrast;
    /* Weak edges beside strong ones are shading, not print. */
    if (contrast <= MIN_CONTRAST * strongest)
      continue;
    corner->to[quarter] = near[m].index;
    contrasts[quarter] = contrast;
    strongest = MAX (strongest, contrast);
    n_found++;
  }
  for (gint s = 0; s < 4; s++)
    if (corner->to[s] >= 0 && contrasts[s] < MIN_CONTRAST * strongest)
      corner->to[s] = -1;
  return n_found;
}

static void
find_neighbours (const ClothLinker * linker, const ClothImage * image,
    const guint8 * levels, const ClothSaddle * saddles, gint k, gfloat reach,
    Corner * corner)
{
  corner->in_square = corner->skips = 0;
  corner->turn = 0;
  if (look_around (linker, image, levels, saddles, k, reach, NEARER,
          corner) < 4)
    look_around (linker, image, levels, saddles, k, reach, NEAREST, corner);
}

/* The quarter of @corner that leads to @k, -1 for none. */
static inline gint
quarter_to (const Corner * corner, gint k)
{
  for (gint s = 0; s < 4; s++)
    if (corner->to[s] == k)
      return s;
  return -1;
}

/* Keeps the links that both ends agree on. */
static void
keep_mutual (Corner * corners, guint n)
{
  for (guint k = 0; k < n; k++)
    for (gint s = 0; s < 4; s++) {
      gint to = corners[k].to[s];

      if (to >= 0 && quarter_to (&corners[to], (gint) k) < 0)
        corners[k].to[s] = -1;
    }
}

/* The four saddles of the square between quarters @s and @s + 1 of saddle @k, in the
 * order of a turn from x towards y; FALSE when the ring does not close. */
static gboolean
square_ring (const Corner * corners, gint k, gint s, gint ring[4])
{
  gint b = corners[k].to[s], d = corners[k].to[(s + 1) & 3], c, back;

  if (b < 0 || d < 0)
    return FALSE;
  back = quarter_to (&corners[b], k);
  c = corners[b].to[(back + 3) & 3];
  back = quarter_to (&corners[d], k);
  if (c < 0 || c == k || c != corners[d].to[(back + 1) & 3])
    return FALSE;
  ring[0] = k;
  ring[1] = b;
  ring[2] = c;
  ring[3] = d;
  return TRUE;
}

/* Cuts links that skip a corner: over a corner that was not found, the next one whose
 * edge looks right is a knight's move away, twice as far as the link that leads the other
 * way, and askew to it. */
static void
cut_skips (Corner * corners, const ClothSaddle * saddles, guint n)
{
  for (guint k = 0; k < n; k++)
    for (gint s = 0; s < 4; s++) {
      gint to = corners[k].to[s], from = corners[k].to[(s + 2) & 3];
      gfloat ax, ay, bx, by, along, across;

      if (to < 0 || from < 0)
        continue;
      ax = saddles[to].x - saddles[k].x;
      ay = saddles[to].y - saddles[k].y;
      bx = saddles[k].x - saddles[from].x;
      by = saddles[k].y - saddles[from].y;
      along = ax * bx + ay * by;
      across = ax * by - ay * bx;
      if (hypotf (ax, ay) > SKIP_LENGTH * hypotf (bx, by)
          && fabsf (across) > SKIP_SLOPE * along)
        corners[k].skips |= (guint8) (1 << s);
    }
  for (guint k = 0; k < n; k++)
    for (gint s = 0; s < 4; s++) {
      gint to = corners[k].to[s];

      if (!(corners[k].skips & (1 << s)) || to < 0)
        continue;
      corners[to].to[quarter_to (&corners[to], (gint) k)] = -1;
      corners[k].to[s] = -1;
    }
}

static void
find_squares (Corner * corners, guint n)
{
  gint ring[4];

  for (guint k = 0; k < n; k++)
    for (gint s = 0; s < 4; s++)
      if (square_ring (corners, (gint) k, s, ring))
        corners[k].in_square |= (guint8) (1 << s);
}

static const gint step_i[4] = { 1, 0, -1, 0 };
static const gint step_j[4] = { 0, 1, 0, -1 };

/* Gives every saddle that squares join to @seed its vertex in a grid around it. A saddle
 * reached twice with different vertices keeps the first. Returns the number of saddles;
 * they are left in the queue. */
static guint
grow_patch (ClothLinker * linker, guint seed, gint patch)
{
  Corner *corners = (Corner *) linker->corners->data;
  ClothLinkNode *nodes = (ClothLinkNode *) linker->nodes->data;

  g_array_set_size (linker->queue, 0);
  g_array_append_val (linker->queue, seed);
  nodes[seed].patch = patch;
  nodes[seed].i = nodes[seed].j = 0;
  corners[seed].turn = 0;
  for (guint head = 0; head < linker->queue->len; head++) {
    guint k = g_array_index (linker->queue, guint, head);

    for (gint s = 0; s < 4; s++) {
      /* An edge counts when a square on either side of it was seen. */
      guint8 sides = (guint8) ((1 << s) | (1 << ((s + 3) & 3)));
      gint way = (s - corners[k].turn) & 3, back;
      guint to;

      if (!(corners[k].in_square & sides))
        continue;
      if (corners[k].to[s] < 0)
        continue;
      to = (guint) corners[k].to[s];
      if (nodes[to].patch != UNSEEN)
        continue;
      back = quarter_to (&corners[to], (gint) k);
      nodes[to].patch = patch;
      nodes[to].i = nodes[k].i + step_i[way];
      nodes[to].j = nodes[k].j + step_j[way];
      /* Quarter @back of the neighbour points against @way. */
      corners[to].turn = (guint8) ((back - way - 2) & 3);
      g_array_append_val (linker->queue, to);
    }
  }
  return linker->queue->len;
}

/* Moves the vertices of the patch in the queue to start at (0, 0) and lays them out. */
static void
lay_out_patch (ClothLinker * linker, const ClothSaddle * saddles)
{
  Corner *corners = (Corner *) linker->corners->data;
  ClothLinkNode *nodes = (ClothLinkNode *) linker->nodes->data;
  const guint *queue = (const guint *) linker->queue->data;
  guint n = linker->queue->len;
  gint least_i = 0, least_j = 0, most_i = 0, most_j = 0;
  ClothLinkPatch patch = { 0 };
  gfloat diagonals = 0;
  guint n_squares = 0;
  gint *node, base;
  guint8 *square;

  for (guint m = 0; m < n; m++) {
    least_i = MIN (least_i, nodes[queue[m]].i);
    least_j = MIN (least_j, nodes[queue[m]].j);
    most_i = MAX (most_i, nodes[queue[m]].i);
    most_j = MAX (most_j, nodes[queue[m]].j);
  }
  patch.columns = most_i - least_i + 1;
  patch.rows = most_j - least_j + 1;
  /* A stray chain of squares is not a board; it would only cost memory. */
  if ((gint64) patch.columns * patch.rows > 64 + 16 * (gint64) n) {
    for (guint m = 0; m < n; m++)
      nodes[queue[m]].patch = REJECTED;
    patch.columns = patch.rows = 0;
  }
  base = (gint) linker->vertex_pool->len;
  g_array_set_size (linker->vertex_pool,
      (guint) (base + patch.columns * patch.rows));
  g_array_set_size (linker->square_pool, linker->vertex_pool->len);
  node = &g_array_index (linker->vertex_pool, gint, base);
  square = &g_array_index (linker->square_pool, guint8, base);
  for (gint m = 0; m < patch.columns * patch.rows; m++) {
    node[m] = -1;
    square[m] = 0;
  }
  for (guint m = 0; patch.columns && m < n; m++) {
    ClothLinkNode *own = &nodes[queue[m]];

    own->i -= least_i;
    own->j -= least_j;
    /* Two saddles on one vertex: a fold or clutter; the first found stays. */
    if (node[own->j * patch.columns + own->i] >= 0) {
      own->patch = REJECTED;
      continue;
    }
    node[own->j * patch.columns + own->i] = (gint) queue[m];
    patch.n_nodes++;
  }
  for (guint m = 0; patch.columns && m < n; m++) {
    const ClothLinkNode *own = &nodes[queue[m]];
    gint s = corners[queue[m]].turn, ring[4];
    gint at = own->j * patch.columns + own->i;

    if (own->patch < 0 || !(corners[queue[m]].in_square & (1 << s))
        || own->i + 1 >= patch.columns || own->j + 1 >= patch.rows)
      continue;
    square_ring (corners, (gint) queue[m], s, ring);
    if (node[at + 1] != ring[1] || node[at + patch.columns + 1] != ring[2]
        || node[at + patch.columns] != ring[3])
      continue;
    square[at] = 1;
    diagonals += hypotf (saddles[ring[2]].x - saddles[ring[0]].x,
        saddles[ring[2]].y - saddles[ring[0]].y);
    n_squares++;
    /* Between quarters 0 and 1 lies the dark bisector. */
    patch.odd_black = ((own->i + own->j) & 1) ^ (s & 1);
  }
  patch.size = n_squares ? diagonals / (gfloat) n_squares
      * (gfloat) patch.n_nodes : 0;
  g_array_append_val (linker->patches, patch);
}

/* @linker: the linker
 * @image: the picture the saddles were found in
 * @levels: (nullable) (array fixed-size=256): what each grey level counts as, %NULL: as
 *   itself. In logarithms an edge in the shadow is as strong as beside it.
 * @saddles: (array length=n_saddles): refined saddles, px
 * @n_saddles: how many
 * @patches: (out) (transfer none): the patches found, valid until the next call
 * @nodes: (out) (transfer none) (optional): patch and vertex of each saddle
 *
 * Joins saddles into patches of checkerboard. Cost grows with the number of saddles, not
 * with the size of the picture.
 *
 * Returns: number of patches
 */
guint
cloth_linker_run (ClothLinker * linker, const ClothImage * image,
    const guint8 * levels, const ClothSaddle * saddles, guint n_saddles,
    const ClothLinkPatch ** patches, const ClothLinkNode ** nodes)
{
  Corner *corners;
  ClothLinkNode *node;
  gfloat reach = (gfloat) MAX (image->width, image->height) / 3;
  guint base = 0;

  g_array_set_size (linker->corners, n_saddles);
  g_array_set_size (linker->nodes, n_saddles);
  g_array_set_size (linker->patches, 0);
  g_array_set_size (linker->vertex_pool, 0);
  g_array_set_size (linker->square_pool, 0);
  corners = (Corner *) linker->corners->data;
  node = (ClothLinkNode *) linker->nodes->data;

  cloth_point_grid_clear (linker->grid, image->width, image->height, n_saddles);
  for (guint k = 0; k < n_saddles; k++)
    cloth_point_grid_add (linker->grid, saddles[k].x, saddles[k].y);
  for (guint k = 0; k < n_saddles; k++) {
    find_neighbours (linker, image, levels, saddles, (gint) k, reach,
        &corners[k]);
    node[k].patch = UNSEEN;
    node[k].i = node[k].j = 0;
  }
  keep_mutual (corners, n_saddles);
  cut_skips (corners, saddles, n_saddles);
  find_squares (corners, n_saddles);
  for (guint k = 0; k < n_saddles; k++)
    if (node[k].patch == UNSEEN && corners[k].in_square) {
      grow_patch (linker, k, (gint) linker->patches->len);
      lay_out_patch (linker, saddles);
    }

  /* The pools have stopped moving: hand out pointers into them. */
  for (guint p = 0; p < linker->patches->len; p++) {
    ClothLinkPatch *patch = &g_array_index (linker->patches, ClothLinkPatch, p);

    patch->node = &g_array_index (linker->vertex_pool, gint, base);
    patch->square = &g_array_index (linker->square_pool, guint8, base);
    base += (guint) (patch->columns * patch->rows);
  }
  *patches = (const ClothLinkPatch *) linker->patches->data;
  if (nodes)
    *nodes = node;
  return linker->patches->len;
}

/* @patches: (array length=n_patches): linked patches
 * @n_patches: how many
 * @order: (out caller-allocates) (array length=n_order): numbers of the largest patches of
 *   at least four saddles, largest first
 * @n_order: room in @order
 *
 * Returns: how many were put into @order
 */
guint
cloth_link_largest (const ClothLinkPatch * patches, guint n_patches,
    guint * order, guint n_order)
{
  guint n = 0;

  for (guint k = 0; k < n_patches; k++) {
    guint at;

    if (patches[k].n_nodes < 4)
      continue;
    if (n == n_order && patches[k].size <= patches[order[n - 1]].size)
      continue;
    if (n < n_order)
      n++;
    for (at = n - 1; at > 0
        && patches[k].size > patches[order[at - 1]].size; at--)
      order[at] = order[at - 1];
    order[at] = k;
  }
  return n;
}
