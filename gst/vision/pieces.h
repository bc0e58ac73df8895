/* Connected pieces: union–find with path halving over items that know an earlier one of theirs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

/* @Item: a structure whose member `parent`, a gint32, is an earlier item of the same piece,
 *   or the item itself
 *
 * Defines find_root (), the first item of a piece, and join (), which makes two pieces one.
 */
#define CLOTH_DEFINE_PIECES(Item) \
  static inline gint32 \
  find_root (Item * items, gint32 i) \
  { \
    while (items[i].parent != i) { \
      items[i].parent = items[items[i].parent].parent; \
      i = items[i].parent; \
    } \
    return i; \
  } \
  \
  static inline void \
  join (Item * items, gint32 a, gint32 b) \
  { \
    a = find_root (items, a); \
    b = find_root (items, b); \
    if (a < b) \
      items[b].parent = a; \
    else \
      items[a].parent = b; \
  }
