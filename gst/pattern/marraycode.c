/* Generates M-arrays: every window of 3 by 3 dots differs from every other, however it
 * is turned.
 *
 * The eight neighbours of a window's centre are a ring; turning the ring by one place is
 * a turn by 45 degrees, which is how oblique views shear the lattice. A window is a
 * word: three bits for each colour of the ring, then three for the centre.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/marray.h"

#include "gst/math/random.h"

#define WINDOW_DOTS 9
#define RING_DOTS 8
#define SYMBOL_BITS 3
#define SYMBOL_MASK 7u
#define RING_MASK 0xffffffu
#define MAX_FORMS 16
#define WORDS (1u << (WINDOW_DOTS * SYMBOL_BITS))
/* Colours tried, for each dot, before the search starts afresh. */
#define TRIES_PER_DOT 64
/* Words looked at in all before the search is given up: about a second. */
#define MAX_LOOK_UPS 60000000

typedef struct
{
  gint columns, rows, n_colours, distance;
  gint n_forms;                 /* 8 turns, twice when mirrored ones count */
  guint8 *matrix;
  guint32 *used;                /* a bit for each word: all forms of all windows */
  gint64 look_ups;              /* how many are left */
} Search;

static gboolean
is_used (const Search * search, guint32 word)
{
  return search->used[word / 32] >> (word % 32) & 1;
}

/* The window whose last dot is (@column, @row). */
static guint32
window_word (const Search * search, gint column, gint row)
{
  static const gint8 ring[RING_DOTS][2] = { {-2, -2}, {-1, -2}, {0, -2},
  {0, -1}, {0, 0}, {-1, 0}, {-2, 0}, {-2, -1}
  };
  const guint8 *last = search->matrix + row * search->columns + column;
  guint32 word = last[-search->columns - 1];

  for (gint i = 0; i < RING_DOTS; i++)
    word = word << SYMBOL_BITS
        | last[ring[i][1] * search->columns + ring[i][0]];
  return word;
}

/* @word as it looks after each turn, then the same of its mirror image. */
static void
turn_word (guint32 word, gint n_forms, guint32 forms[MAX_FORMS])
{
  const guint32 centre = word & ~RING_MASK;
  guint32 ring = word & RING_MASK;

  for (gint n = 0; n < n_forms; n++) {
    if (n == RING_DOTS) {
      guint32 mirrored = 0;

      for (gint i = 0; i < RING_DOTS; i++)
        mirrored = mirrored << SYMBOL_BITS
            | (ring >> (i * SYMBOL_BITS) & SYMBOL_MASK);
      ring = mirrored;
    }
    forms[n] = centre | ring;
    ring = (ring << SYMBOL_BITS
        | ring >> ((RING_DOTS - 1) * SYMBOL_BITS)) & RING_MASK;
  }
}

static gint
word_distance (guint32 a, guint32 b)
{
  guint32 x = a ^ b;

  /* One bit for each symbol that differs: the lowest bits of 9 symbols, in octal. */
  return __builtin_popcount ((x | x >> 1 | x >> 2) & 0111111111u);
}

/* Is there a used word that differs from @word in at most @changes of the symbols from
 * @first on? */
static gboolean
is_near_used (Search * search, guint32 word, gint first, gint changes)
{
  search->look_ups--;
  if (is_used (search, word))
    return TRUE;
  for (gint i = first; changes > 0 && i < WINDOW_DOTS; i++) {
    const gint shift = i * SYMBOL_BITS;
    const guint32 symbol = word >> shift & SYMBOL_MASK;

    for (guint32 other = 0; other < (guint32) search->n_colours; other++) {
      if (other != symbol && is_near_used (search,
              (word & ~(SYMBOL_MASK << shift)) | other << shift, i + 1,
              changes - 1))
        return TRUE;
    }
  }
  return FALSE;
}

/* Marks or frees all forms of the window that the dot (@column, @row) completes. */
static void
flip_window (Search * search, gint column, gint row)
{
  guint32 forms[MAX_FORMS] = { 0 };

  if (column < 2 || row < 2)
    return;
  turn_word (window_word (search, column, row), search->n_forms, forms);
  for (gint n = 0; n < search->n_forms; n++)
    search->used[forms[n] / 32] ^= 1u << (forms[n] % 32);
}

/* FALSE when the window that the dot completes would be too near to one that is there
 * or to itself turned. */
static gboolean
add_window (Search * search, gint column, gint row)
{
  guint32 forms[MAX_FORMS] = { 0 };

  if (column < 2 || row < 2)
    return TRUE;
  turn_word (window_word (search, column, row), search->n_forms, forms);
  search->look_ups -= search->n_forms;
  for (gint n = 1; n < search->n_forms; n++) {
    if (word_distance (forms[0], forms[n]) < search->distance)
      return FALSE;
  }
  if (is_near_used (search, forms[0], 0, search->distance - 1))
    return FALSE;
  flip_window (search, column, row);
  return TRUE;
}

/* Dot after dot in reading order: a random colour, else the next ones, else back. */
static gboolean
search_matrix (Search * search, ClothRandom * random)
{
  const gint n_dots = search->columns * search->rows;
  const gint columns = search->columns;
  g_autofree guint8 *tried = g_malloc0 ((gsize) n_dots);
  gint tries = n_dots * TRIES_PER_DOT, n = 0;

  while (n >= 0 && n < n_dots && tries-- > 0 && search->look_ups-- > 0) {
    if (tried[n] == search->n_colours) {
      tried[n--] = 0;
      if (n >= 0)
        flip_window (search, n % columns, n / columns);
      continue;
    }
    search->matrix[n] = (guint8) (tried[n]++
        ? (search->matrix[n] + 1) % search->n_colours
        : (gint) cloth_random_below (random, (guint) search->n_colours));
    if (add_window (search, n % columns, n / columns))
      n++;
  }
  if (n == n_dots)
    return TRUE;
  while (n-- > 0)
    flip_window (search, n % columns, n / columns);
  return FALSE;
}

static gboolean
refuse (GError ** error, const gchar * what, gint value, gint least, gint most)
{
  g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
      "%d %s: an M-array takes %d to %d", value, what, least, most);
  return FALSE;
}

/* Words of 9 symbols at a distance of d are told apart by any 10 − d of their symbols
 * (Singleton's bound), so there are at most colours^(10 − d) of them. */
static gboolean
check_room (const Search * search, GError ** error)
{
  const gint64 windows = (gint64) (search->columns - 2) * (search->rows - 2);
  gint64 words = 1, most;

  for (gint i = 0; i < WINDOW_DOTS + 1 - search->distance; i++)
    words *= search->n_colours;
  most = words / search->n_forms;
  if (windows <= most)
    return TRUE;
  g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
      "%d by %d dots have %" G_GINT64_FORMAT " windows of 3 by 3, but %d "
      "colours at a distance of %d give at most %" G_GINT64_FORMAT "%s: take "
      "fewer dots, more colours or less distance", search->columns,
      search->rows, windows, search->n_colours, search->distance, most,
      search->n_forms == MAX_FORMS ? " seen from both sides" : "");
  return FALSE;
}

/* @columns: dots in a row, %CLOTH_M_ARRAY_MIN to %CLOTH_M_ARRAY_MAX
 * @rows: dots in a column
 * @n_colours: 2 to %CLOTH_M_ARRAY_MAX_COLOURS
 * @code: distance, sides, seed
 * @matrix: (out) (array): rows·columns bytes; gets the colours, 0 to @n_colours − 1
 * @error: return location
 *
 * Colours dots so that any 3 by 3 of them tell their place and how they are turned:
 * each window differs by @code's distance from every other and from itself, all in
 * eight turns by 45 degrees (the ring around the centre shifted by a place); two-sided,
 * in their mirror images too. Random colours dot by dot, with back-tracking (Scholz et
 * al. 2005, 3.1, after Morano et al. 1998; windows that equal their own turned self are
 * refused here as well).
 *
 * Returns: %FALSE with %CLOTH_PATTERN_ERROR_VALUE where a number is outside its limits
 *   or no such array can exist, %CLOTH_PATTERN_ERROR_CODE where none was found
 */
gboolean
cloth_m_array_generate (gint columns, gint rows, gint n_colours,
    const ClothMArrayCode * code, guint8 * matrix, GError ** error)
{
  Search search = { columns, rows, n_colours, code->distance,
    code->two_sided ? MAX_FORMS : RING_DOTS, matrix, NULL, MAX_LOOK_UPS
  };
  ClothRandom random;
  gboolean found = FALSE;

  if (columns < CLOTH_M_ARRAY_MIN || columns > CLOTH_M_ARRAY_MAX)
    return refuse (error, "columns", columns, CLOTH_M_ARRAY_MIN,
        CLOTH_M_ARRAY_MAX);
  if (rows < CLOTH_M_ARRAY_MIN || rows > CLOTH_M_ARRAY_MAX)
    return refuse (error, "rows", rows, CLOTH_M_ARRAY_MIN, CLOTH_M_ARRAY_MAX);
  if (n_colours < 2 || n_colours > CLOTH_M_ARRAY_MAX_COLOURS)
    return refuse (error, "colours", n_colours, 2, CLOTH_M_ARRAY_MAX_COLOURS);
  if (code->distance < 1 || code->distance > CLOTH_M_ARRAY_MAX_DISTANCE)
    return refuse (error, "dots of distance", code->distance, 1,
        CLOTH_M_ARRAY_MAX_DISTANCE);
  if (!check_room (&search, error))
    return FALSE;
  search.used = g_new0 (guint32, WORDS / 32);
  cloth_random_init (&random, code->seed);
  while (!found && search.look_ups > 0)
    found = search_matrix (&search, &random);
  g_free (search.used);
  if (!found)
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_CODE,
        "no M-array of %d by %d dots in %d colours at a distance of %d was "
        "found%s: take fewer dots, more colours or less distance", columns,
        rows, n_colours, code->distance,
        code->two_sided ? " for both sides" : "");
  return found;
}
