/* A page that is one file.
 *
 * It may load nothing and run nothing but its own script and style: their hashes stand in
 * its content security policy. All text of strangers travels as JSON whose strings can't end
 * a script, and the script puts it into the page as text.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/page.h"

#include <string.h>

#include "gst/file/output.h"
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
load (const gchar * name, const gchar * ending, gchar ** text, GError ** error)
{
  g_autofree gchar *path = g_strconcat ("/cloth/gap/", name, ending, NULL);
  g_autoptr (GBytes) bytes = g_resource_lookup_data
      (cloth_gap_web_get_resource (), path, G_RESOURCE_LOOKUP_FLAGS_NONE,
      error);

  if (!bytes)
    return FALSE;
  *text = g_strndup (g_bytes_get_data (bytes, NULL), g_bytes_get_size (bytes));
  return TRUE;
}

static gboolean
write_parts (ClothOutput * output, const ClothPagePart * parts, guint n_parts,
    GError ** error)
{
  for (guint i = 0; i < n_parts; i++)
    if (!cloth_output_printf (output, error,
            "<script type=\"application/json\" id=\"%s\">\n", parts[i].id) ||
        !cloth_output_write (output, parts[i].json, strlen (parts[i].json),
            error) || !cloth_output_printf (output, error, "</script>\n"))
      return FALSE;
  return TRUE;
}

/* @path: where the page shall be
 * @name: of its script and style, in gst/gap/report/web; and of the element that the script
 *   fills
 * @title: what it is about
 * @without_script: a sentence for those whose browser runs no script
 * @parts: what it carries
 * @n_parts: how many
 * @error: #GIOErrorEnum
 *
 * The page appears whole or not at all.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_page_write (const gchar * path, const gchar * name, const gchar * title,
    const gchar * without_script, const ClothPagePart * parts, guint n_parts,
    GError ** error)
{
  g_autofree gchar *script = NULL, *style = NULL, *script_hash = NULL;
  g_autofree gchar *style_hash = NULL, *words = NULL, *safe = NULL;
  g_autoptr (ClothOutput) output = NULL;

  if (!load (name, ".js", &script, error) ||
      !load (name, ".css", &style, error))
    return FALSE;
  script_hash = hash_of (script);
  style_hash = hash_of (style);
  words = g_utf8_make_valid (title, -1);
  safe = g_markup_escape_text (words, -1);
  output = cloth_output_new (path, error);
  return output && cloth_output_printf (output, error,
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
      "'none'; script-src 'sha256-%s'; style-src 'sha256-%s'; img-src data:; "
      "base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<meta name=\"referrer\" content=\"no-referrer\">\n"
      "<title>%s</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>",
      script_hash, style_hash, safe) &&
      cloth_output_write (output, style, strlen (style), error) &&
      cloth_output_printf (output, error, "</style>\n</head>\n<body>\n"
      "<main id=\"%s\"><noscript><header><h1>%s</h1><p>The rest of this "
      "page needs JavaScript. %s</p></header></noscript>"
      "</main>\n", name, safe, without_script) &&
      write_parts (output, parts, n_parts, error) &&
      cloth_output_printf (output, error, "<script>") &&
      cloth_output_write (output, script, strlen (script), error) &&
      cloth_output_printf (output, error, "</script>\n</body>\n</html>\n") &&
      cloth_output_commit (output, error);
}
