/* Shared inside libgstcloth-1.0: bounded reading of bytes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>
#include <string.h>

G_BEGIN_DECLS

GstCaps *gst_cloth_caps_with_header (GstCaps * caps, GstBuffer * header);
gboolean gst_cloth_map (GstBuffer * buffer, GstMapInfo * map, GError ** error);
gboolean gst_cloth_check_header (const guint8 * bytes, gsize size,
    const gchar * magic, guint version, gsize header, const gchar * what,
    GError ** error);
gboolean gst_cloth_check_size (gsize size, gsize expected, const gchar * what,
    GError ** error);

/* Numbers are kept little-endian on the wire, at any address. */
static inline guint16
gst_cloth_read_u16 (const guint8 * bytes)
{
  guint16 value;

  memcpy (&value, bytes, 2);
  return GUINT16_FROM_LE (value);
}

static inline guint32
gst_cloth_read_u32 (const guint8 * bytes)
{
  guint32 value;

  memcpy (&value, bytes, 4);
  return GUINT32_FROM_LE (value);
}

static inline guint64
gst_cloth_read_u64 (const guint8 * bytes)
{
  guint64 value;

  memcpy (&value, bytes, 8);
  return GUINT64_FROM_LE (value);
}

/* Copies n 32 bit words, swapping them on a big-endian host. */
static inline void
gst_cloth_copy_le32 (gpointer target, gconstpointer source, gsize n)
{
#if G_BYTE_ORDER == G_LITTLE_ENDIAN
  memcpy (target, source, n * 4);
#else
  for (gsize i = 0; i < n; i++) {
    guint32 word;

    memcpy (&word, (const guint8 *) source + 4 * i, 4);
    word = GUINT32_SWAP_LE_BE (word);
    memcpy ((guint8 *) target + 4 * i, &word, 4);
  }
#endif
}

G_END_DECLS
