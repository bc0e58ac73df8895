/* Shared inside libgstcloth-1.0: error domain, stream headers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cloth/gstclothprivate.h"

/**
 * gst_cloth_error_quark:
 *
 * Returns: the error domain #GST_CLOTH_ERROR
 *
 * Since: 0.1
 */
GQuark
gst_cloth_error_quark (void)
{
  return g_quark_from_static_string ("gst-cloth-error-quark");
}

/* Takes both; stream headers are marked as such, for the payloaders. */
GstCaps *
gst_cloth_caps_with_header (GstCaps * caps, GstBuffer * header)
{
  GValue headers = G_VALUE_INIT;
  GValue value = G_VALUE_INIT;

  GST_BUFFER_FLAG_SET (header, GST_BUFFER_FLAG_HEADER);
  g_value_init (&headers, GST_TYPE_ARRAY);
  g_value_init (&value, GST_TYPE_BUFFER);
  gst_value_take_buffer (&value, header);
  gst_value_array_append_and_take_value (&headers, &value);
  gst_caps_set_value (caps, "streamheader", &headers);
  g_value_unset (&headers);
  return caps;
}

gboolean
gst_cloth_map (GstBuffer * buffer, GstMapInfo * map, GError ** error)
{
  if (gst_buffer_map (buffer, map, GST_MAP_READ))
    return TRUE;
  g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
      "The buffer's memory can't be read");
  return FALSE;
}

/* The first eight bytes of every layout: magic, version, size of the header. */
gboolean
gst_cloth_check_header (const guint8 * bytes, gsize size, const gchar * magic,
    guint version, gsize header, const gchar * what, GError ** error)
{
  if (size >= 4 && memcmp (bytes, magic, 4) != 0) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_MAGIC,
        "These bytes are no %s: they don't begin with %s", what, magic);
    return FALSE;
  }
  if (size >= 6 && gst_cloth_read_u16 (bytes + 4) != version) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VERSION,
        "The %s is of version %u; this library reads version %u", what,
        gst_cloth_read_u16 (bytes + 4), version);
    return FALSE;
  }
  if (size < header) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_TRUNCATED,
        "The %s ends after %" G_GSIZE_FORMAT " bytes, inside its header of %"
        G_GSIZE_FORMAT, what, size, header);
    return FALSE;
  }
  if (gst_cloth_read_u16 (bytes + 6) != header) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "The header of the %s is %u bytes long instead of %" G_GSIZE_FORMAT,
        what, gst_cloth_read_u16 (bytes + 6), header);
    return FALSE;
  }
  return TRUE;
}

gboolean
gst_cloth_check_size (gsize size, gsize expected, const gchar * what,
    GError ** error)
{
  if (size == expected)
    return TRUE;
  g_set_error (error, GST_CLOTH_ERROR,
      size < expected ? GST_CLOTH_ERROR_TRUNCATED : GST_CLOTH_ERROR_VALUE,
      "The %s is %" G_GSIZE_FORMAT " bytes long instead of %" G_GSIZE_FORMAT,
      what, size, expected);
  return FALSE;
}
