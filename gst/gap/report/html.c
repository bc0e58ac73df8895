/* The page that shows a diagnosis: one file, which works without a network.
 *
 * The page may load nothing and run nothing but its own script and style: their hashes
 * stand in its content security policy. All text of strangers travels as JSON whose
 * strings can't end a script, and the script puts it into the page as text.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/html.h"

#include <gio/gio.h>
#include <string.h>

#include "gst/gap/report/arrays.h"
#include "web-resource.h"

static gchar *
hash_of (const gchar * text)
{
  g_autoptr (GChecksum) sum = g_checksum_new (G_CHECKSUM_SHA256);
  guint8 digest[32];
  gsize size = sizeof digest;

  g_checksum_update (sum, (const guchar *) text, -1);
  g_checksum_get_digest (sum, digest, &size);
  return g_base64_encode (digest, size);
}

static gboolean
load (const gchar * path, gchar ** text, GError ** error)
{
  g_autoptr (GBytes) bytes = g_resource_lookup_data
      (cloth_gap_web_get_resource (), path, G_RESOURCE_LOOKUP_FLAGS_NONE,
      error);

  if (!bytes)
    return FALSE;
  *text = g_strndup (g_bytes_get_data (bytes, NULL), g_bytes_get_size (bytes));
  return TRUE;
}

/* @result: a result
 * @path: where report.html shall be
 * @error: #GIOErrorEnum
 *
 * Writes a page that shows @result. It needs no other file and no network. It appears
 * whole or not at all. Long or fine playbacks are thinned: the file has at most 9 MB.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_gap_report_write (const ClothGapResult * result, const gchar * path,
    GError ** error)
{
  g_autofree gchar *script = NULL, *style = NULL, *script_hash = NULL;
  g_autofree gchar *style_hash = NULL, *json = NULL, *arrays = NULL;
  g_autofree gchar *summary = NULL, *words = NULL, *title = NULL;
  g_autoptr (ClothOutput) output = NULL;

  if (!load ("/cloth/gap/report.js", &script, error) ||
      !load ("/cloth/gap/report.css", &style, error))
    return FALSE;
  script_hash = hash_of (script);
  style_hash = hash_of (style);
  json = cloth_gap_result_to_json (result);
  arrays = cloth_gap_report_arrays (result);
  summary = cloth_gap_result_summary (result);
  words = g_utf8_make_valid (summary, -1);
  title = g_markup_escape_text (words, -1);
  output = cloth_output_new (path, error);
  return output && cloth_output_printf (output, error,
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; script-src 'sha256-%s'; style-src 'sha256-%s'; img-src data:; "
      "base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<title>%s</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>",
      script_hash, style_hash, title) &&
      cloth_output_write (output, style, strlen (style), error) &&
      cloth_output_printf (output, error, "</style>\n</head>\n<body>\n"
      "<main id=\"report\"><noscript><header><h1>%s</h1><p>The rest of this "
      "page needs JavaScript. gap.json says the same.</p></header></noscript>"
      "</main>\n<script type=\"application/json\" id=\"gap\">\n", title) &&
      cloth_output_write (output, json, strlen (json), error) &&
      cloth_output_printf (output, error, "</script>\n"
      "<script type=\"application/json\" id=\"arrays\">\n") &&
      cloth_output_write (output, arrays, strlen (arrays), error) &&
      cloth_output_printf (output, error, "</script>\n<script>") &&
      cloth_output_write (output, script, strlen (script), error) &&
      cloth_output_printf (output, error, "</script>\n</body>\n</html>\n") &&
      cloth_output_finish (output, error) &&
      cloth_output_commit (&output, 1, error);
}
