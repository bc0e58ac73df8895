/* Runs of pixels and their pieces: union–find over the runs of neighbouring rows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/mask/runs.h"

#include "gst/vision/pieces.h"

#define RUN(runs, i) g_array_index (runs, ClothRun, i)

/* One for each run: an earlier run of its piece or itself, and the pixels of the piece that
 * it is the first run of. */
typedef struct
{
  gint32 parent;
  guint32 area;
} Piece;

/* Returns: (transfer full): scratch memory
 */
GArray *
cloth_runs_new_pieces (void)
{
  return g_array_new (FALSE, FALSE, sizeof (Piece));
}

/* @runs: (out): #ClothRun; what was in it is lost
 * @bits: @height rows of ⌈@width / 64⌉ words, the first column in the lowest bit; 0 beyond
 *   @width
 * @width: columns
 * @height: rows
 *
 * Returns: %FALSE when there are more than %CLOTH_RUNS_MAX, of which the first are kept
 */
gboolean
cloth_runs_of_bits (GArray * runs, const guint64 * bits, gint width,
    gint height)
{
  const gint n_words = (width + 63) / 64;

  g_array_set_size (runs, 0);
  for (gint y = 0; y < height; y++, bits += n_words) {
    gint begin = -1;

    for (gint k = 0; k < n_words; k++) {
      /* a bit where a run begins or ends */
      const guint64 before = bits[k] << 1 | (begin >= 0);

      for (guint64 edges = bits[k] ^ before; edges; edges &= edges - 1) {
        const gint x = 64 * k + __builtin_ctzll (edges);
        const ClothRun run = { (guint16) y, (guint16) begin, (guint16) x };

        if (begin < 0) {
          begin = x;
          continue;
        }
        begin = -1;
        if (runs->len == CLOTH_RUNS_MAX)
          return FALSE;
        g_array_append_val (runs, run);
      }
    }
    if (begin >= 0) {
      const ClothRun run = { (guint16) y, (guint16) begin, (guint16) width };

      if (runs->len == CLOTH_RUNS_MAX)
        return FALSE;
      g_array_append_val (runs, run);
    }
  }
  return TRUE;
}

/* @runs: #ClothRun of a picture, by row and column
 * @others: (out): the runs of all other pixels
 * @width: columns
 * @height: rows
 */
void
cloth_runs_complement (const GArray * runs, GArray * others, gint width,
    gint height)
{
  guint i = 0;

  g_array_set_size (others, 0);
  for (gint y = 0; y < height; y++) {
    ClothRun gap = { (guint16) y, 0, 0 };

    for (; i < runs->len && RUN (runs, i).row == y; i++) {
      gap.end = RUN (runs, i).begin;
      if (gap.end > gap.begin)
        g_array_append_val (others, gap);
      gap.begin = RUN (runs, i).end;
    }
    gap.end = (guint16) width;
    if (gap.end > gap.begin)
      g_array_append_val (others, gap);
  }
}

CLOTH_DEFINE_PIECES (Piece)
/* Finds the piece of each run; runs of neighbouring rows touch when they overlap, or with
 * @diagonal 1 when their corners meet. */
     static void
         find_pieces (const GArray * runs, GArray * array, guint diagonal)
{
  Piece *pieces;
  guint above = 0;

  g_array_set_size (array, runs->len);
  pieces = (Piece *) array->data;
  for (guint32 i = 0; i < runs->len; i++) {
    const ClothRun run = RUN (runs, i);

    pieces[i] = (Piece) {
    (gint32) i, 0};
    while (above < i && (RUN (runs, above).row + 1 < run.row
            || (RUN (runs, above).row + 1 == run.row
                && RUN (runs, above).end + diagonal <= run.begin)))
      above++;
    for (guint j = above; j < i && RUN (runs, j).row + 1 == run.row
        && RUN (runs, j).begin < run.end + diagonal; j++)
      join (pieces, (gint32) j, (gint32) i);
  }
  for (guint32 i = 0; i < runs->len; i++)
    pieces[find_root (pieces, (gint32) i)].area +=
        (guint32) (RUN (runs, i).end - RUN (runs, i).begin);
}

/* Keeps the runs of pieces of at least @least pixels. */
static void
keep (GArray * runs, GArray * array, guint least)
{
  Piece *pieces = (Piece *) array->data;
  guint n = 0;

  for (guint32 i = 0; i < runs->len; i++)
    if (pieces[find_root (pieces, (gint32) i)].area >= least)
      RUN (runs, n++) = RUN (runs, i);
  g_array_set_size (runs, n);
}

/* @runs: (inout): #ClothRun, by row and column
 * @pieces: scratch memory, made by cloth_runs_new_pieces ()
 * @least: pieces of fewer pixels are dropped; pixels whose corners meet are of one piece
 */
void
cloth_runs_drop (GArray * runs, GArray * pieces, guint least)
{
  find_pieces (runs, pieces, 1);
  keep (runs, pieces, least);
}

/* @runs: (inout): #ClothRun, by row and column
 * @gaps: scratch memory, of #ClothRun
 * @pieces: scratch memory, made by cloth_runs_new_pieces ()
 * @most: holes of at most so many pixels are filled; what lies at the border is none
 * @width: columns
 * @height: rows
 */
void
cloth_runs_fill (GArray * runs, GArray * gaps, GArray * pieces, guint most,
    gint width, gint height)
{
  Piece *piece;

  if (most == 0)
    return;
  cloth_runs_complement (runs, gaps, width, height);
  find_pieces (gaps, pieces, 0);
  piece = (Piece *) pieces->data;
  for (guint32 i = 0; i < gaps->len; i++) {
    const ClothRun gap = RUN (gaps, i);

    if (gap.row == 0 || gap.row == height - 1 || gap.begin == 0
        || gap.end == width)
      piece[find_root (piece, (gint32) i)].area = G_MAXUINT32;
  }
  keep (gaps, pieces, most == G_MAXUINT32 ? most : most + 1);
  cloth_runs_complement (gaps, runs, width, height);
}
