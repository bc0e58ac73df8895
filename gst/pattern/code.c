/* Generates the code of a coded checkerboard: every window of k by k squares, in all
 * four rotations, differs from every other by at least three dots.
 *
 * A quarter turn about the centre of a square maps the colours of a checkerboard onto
 * themselves, so all four rotations look alike but for the dots. About the centre of a
 * window of even k, which is a corner, the quarter and three-quarter turns swap the
 * colours: such a turned window looks like one that starts with the other colour. So
 * windows are compared within the class of the colour of their top-left square.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/code.h"

#include "gst/math/random.h"

#define MIN_WINDOW 4
#define MAX_WINDOW 6
/* Squares tried, for each square of the board, before the search starts afresh. */
#define TRIES_PER_SQUARE 6
/* Squares tried in all before a larger window is taken. */
#define TRIES_PER_WINDOW 200000
#define MAX_RESTARTS 1024
#define NO_WORD G_MAXUINT64

/* --- a set of words: open addressing, linear probing --------------------------- */

typedef struct
{
  guint64 *slots;
  guint64 mask;
} WordSet;

static guint64
word_slot (const WordSet * set, guint64 word)
{
  /* Fibonacci hashing, Knuth vol. 3, 6.4. */
  return ((word * G_GUINT64_CONSTANT (0x9e3779b97f4a7c15)) >> 24) & set->mask;
}

static void
word_set_init (WordSet * set, gsize words)
{
  guint64 size = 64;

  while (size < 2 * words)
    size *= 2;
  set->mask = size - 1;
  set->slots = g_new (guint64, size);
  for (guint64 i = 0; i < size; i++)
    set->slots[i] = NO_WORD;
}

static gboolean
word_set_has (const WordSet * set, guint64 word)
{
  for (guint64 i = word_slot (set, word);; i = (i + 1) & set->mask) {
    if (set->slots[i] == word)
      return TRUE;
    if (set->slots[i] == NO_WORD)
      return FALSE;
  }
}

static void
word_set_add (WordSet * set, guint64 word)
{
  guint64 i = word_slot (set, word);

  while (set->slots[i] != NO_WORD)
    i = (i + 1) & set->mask;
  set->slots[i] = word;
}

/* @word is in the set. Those behind it move up so that no probe meets a hole. */
static void
word_set_remove (WordSet * set, guint64 word)
{
  guint64 hole = word_slot (set, word);

  while (set->slots[hole] != word)
    hole = (hole + 1) & set->mask;
  for (guint64 i = (hole + 1) & set->mask; set->slots[i] != NO_WORD;
      i = (i + 1) & set->mask) {
    guint64 home = word_slot (set, set->slots[i]);

    if (((i - home) & set->mask) >= ((i - hole) & set->mask)) {
      set->slots[hole] = set->slots[i];
      hole = i;
    }
  }
  set->slots[hole] = NO_WORD;
}

/* Is any word of the set within a distance of 2? */
static gboolean
word_set_near (const WordSet * set, guint64 word, gint bits)
{
  if (word_set_has (set, word))
    return TRUE;
  for (gint a = 0; a < bits; a++) {
    guint64 one = word ^ (G_GUINT64_CONSTANT (1) << a);

    if (word_set_has (set, one))
      return TRUE;
    for (gint b = a + 1; b < bits; b++) {
      if (word_set_has (set, one ^ (G_GUINT64_CONSTANT (1) << b)))
        return TRUE;
    }
  }
  return FALSE;
}

/* --- search --------------------------------------------------------------------- */

typedef struct
{
  gint columns, rows;
  gint k;
  guint8 *code;
  /* By the colour class of the top-left square. */
  WordSet sets[2];
} Search;

/* The window at (c, r) as it looks after @turns clockwise quarter turns. */
static guint64
window_word (const Search * search, gint c, gint r, gint turns)
{
  const gint k = search->k;
  guint64 word = 0;

  for (gint y = 0; y < k; y++) {
    for (gint x = 0; x < k; x++) {
      const gint from[4][2] = { {x, y}, {y, k - 1 - x},
      {k - 1 - x, k - 1 - y}, {k - 1 - y, x}
      };

      word = word << 1
          | search->code[(r + from[turns][1]) * search->columns + c +
          from[turns][0]];
    }
  }
  return word;
}

static gint
window_class (const Search * search, gint c, gint r, gint turns)
{
  return (c + r + (search->k % 2 == 0 ? turns : 0)) & 1;
}

/* Adds the window that the square (@column, @row) completes, if any; FALSE when it
 * would be too near to one that is there or to itself turned. */
static gboolean
add_window (Search * search, gint column, gint row)
{
  const gint c = column - search->k + 1, r = row - search->k + 1;
  guint64 word[4];

  if (c < 0 || r < 0)
    return TRUE;
  for (gint q = 0; q < 4; q++) {
    word[q] = window_word (search, c, r, q);
    if (q > 0
        && window_class (search, c, r, q) == window_class (search, c, r, 0)
        && __builtin_popcountll (word[0] ^ word[q]) < CLOTH_CODE_DISTANCE)
      return FALSE;
  }
  if (word_set_near (&search->sets[window_class (search, c, r, 0)], word[0],
          search->k * search->k))
    return FALSE;
  for (gint q = 0; q < 4; q++)
    word_set_add (&search->sets[window_class (search, c, r, q)], word[q]);
  return TRUE;
}

static void
remove_window (Search * search, gint column, gint row)
{
  const gint c = column - search->k + 1, r = row - search->k + 1;

  if (c < 0 || r < 0)
    return;
  for (gint q = 0; q < 4; q++)
    word_set_remove (&search->sets[window_class (search, c, r, q)],
        window_word (search, c, r, q));
}

/* Each word shuts out those within a distance of 2 (the Gilbert–Varshamov count). A
 * search that would fill all words half over again has never come to its end. */
static gboolean
is_hopeless (const Search * search)
{
  const gint bits = search->k * search->k;
  const gint64 windows =
      (gint64) (search->columns - search->k + 1) * (search->rows - search->k +
      1);
  const gint64 ball = 1 + bits + bits * (bits - 1) / 2;

  return 2 * windows * ball > (G_GINT64_CONSTANT (3) << bits) / 2;
}

/* Square after square in reading order: a random bit, else the other one, else back. */
static gboolean
search_code (Search * search, ClothRandom * random)
{
  const gint n_squares = search->columns * search->rows;
  g_autofree guint8 *tried = g_malloc0 ((gsize) n_squares);
  gint64 budget = (gint64) n_squares * TRIES_PER_SQUARE;
  const gsize words = (gsize) n_squares * 2 + 16;
  gint n = 0;

  for (gint i = 0; i < 2; i++)
    word_set_init (&search->sets[i], words);
  while (n >= 0 && n < n_squares && budget-- > 0) {
    const gint column = n % search->columns, row = n / search->columns;

    if (tried[n] == 2) {
      tried[n--] = 0;
      if (n >= 0)
        remove_window (search, n % search->columns, n / search->columns);
      continue;
    }
    search->code[n] = tried[n]++ ? !search->code[n]
        : (guint8) (cloth_random_bits (random) >> 63);
    if (add_window (search, column, row))
      n++;
  }
  for (gint i = 0; i < 2; i++)
    g_free (search->sets[i].slots);
  return n == n_squares;
}

/* @pattern: a checkerboard of at least 4 by 4 squares; gets a code in place of any
 *   that it has
 * @dot_ratio: diameter of a dot over the edge of its square
 * @seed: equal seeds give equal codes on every machine
 * @window: (out) (optional): how many squares each way determine a place
 * @error: return location
 *
 * Chooses which squares carry a dot so that any @window by @window squares that are
 * seen tell their place and their rotation, even with one dot misread: any two such
 * windows differ by at least %CLOTH_CODE_DISTANCE dots, each compared in all four
 * rotations. @window is the least for which a code was found: 4 for boards to about
 * 16 by 16 squares, 5 to about 100 by 100, 6 above.
 *
 * Returns: %FALSE with %CLOTH_PATTERN_ERROR_VALUE or %CLOTH_PATTERN_ERROR_CODE;
 *   @pattern is then as it was
 */
gboolean
cloth_code_generate (ClothPattern * pattern, gdouble dot_ratio, guint64 seed,
    gint * window, GError ** error)
{
  ClothPattern plain = *pattern;
  g_autofree guint8 *code = NULL;
  Search search = { pattern->columns, pattern->rows, };

  plain.code = NULL;
  if (!cloth_pattern_check (&plain, error))
    return FALSE;
  if (MIN (pattern->columns, pattern->rows) < MIN_WINDOW) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "a coded board needs at least %d by %d squares, not %d by %d",
        MIN_WINDOW, MIN_WINDOW, pattern->columns, pattern->rows);
    return FALSE;
  }
  if (!(dot_ratio > 0 && dot_ratio < 1)) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "a dot ratio of %g: give a dot's diameter over its square's edge, "
        "between 0 and 1", dot_ratio);
    return FALSE;
  }
  search.code = code = g_malloc0 ((gsize) pattern->columns * pattern->rows);
  for (search.k = MIN_WINDOW;
      search.k <= MIN (MAX_WINDOW, MIN (pattern->columns, pattern->rows));
      search.k++) {
    const gint n_squares = pattern->columns * pattern->rows;
    const gint restarts =
        CLAMP (TRIES_PER_WINDOW / (TRIES_PER_SQUARE * n_squares), 2,
        MAX_RESTARTS);

    if (is_hopeless (&search))
      continue;
    for (gint restart = 0; restart < restarts; restart++) {
      ClothRandom random;

      cloth_random_init (&random, seed * MAX_RESTARTS + (guint64) restart);
      if (search_code (&search, &random)) {
        g_free (pattern->code);
        pattern->code = g_steal_pointer (&code);
        pattern->dot_ratio = dot_ratio;
        if (window)
          *window = search.k;
        return TRUE;
      }
    }
  }
  g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_CODE,
      "no code found for %d by %d squares: take another seed or a board that "
      "is less narrow", pattern->columns, pattern->rows);
  return FALSE;
}
