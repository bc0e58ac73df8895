/* gst-cloth-take-1.0 recover: finishes recordings whose program was killed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/take-tool.h"

#include <gio/gio.h>
#include <string.h>

#include "gst/take/recover.h"

static void
tell_frames (const gchar * shown, const ClothRecovered * recovered)
{
  const guint64 n = recovered->n_frames, n_left_out = recovered->n_left_out;
  g_autofree gchar *left_out = n_left_out == 0 ? g_strdup ("") :
      n_left_out == 1 ? g_strdup ("; one more was not whole and is left out") :
      g_strdup_printf ("; %" G_GUINT64_FORMAT
      " more were not whole and are left out", n_left_out);

  g_print ("%s: %" G_GUINT64_FORMAT " frame%s kept%s\n", shown, n,
      n == 1 ? "" : "s", left_out);
}

static void
tell (const gchar * shown, const ClothRecovered * recovered)
{
  if (recovered->placed)
    g_print ("%s: it was whole; all its files have their names now\n", shown);
  else if (recovered->n_frames == 0)
    g_print ("%s: there was no whole frame; the remains are removed\n", shown);
  else
    tell_frames (shown, recovered);
  if (recovered->dropped)
    g_print ("%s: %s was not whole and is left out\n", shown,
        recovered->dropped);
}

/* A message for each that can't be finished. @took_name: (out): whether its recording has
 * the name now, or has a claim to it. */
static gboolean
recover_one (const gchar * path, gboolean overwrite, gboolean * took_name)
{
  g_autofree gchar *target = cloth_recover_get_target (path);
  g_autofree gchar *shown = g_filename_display_name (target);
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  *took_name = TRUE;
  if (cloth_recover (path, overwrite, &recovered, &error)) {
    tell (shown, &recovered);
    *took_name = recovered.placed || recovered.n_frames > 0;
    return TRUE;
  }
  if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_EXISTS))
    complain (FAILED, "%s: %s; move it away, or say --overwrite. The remains "
        "are in “%s”", shown, error->message, path);
  else
    complain (FAILED, "%s: %s. The remains are in “%s”", shown,
        error->message, path);
  return FALSE;
}

/* A name is not a folder's, nor a recording's, whole or not. */
static gboolean
is_unknown (const gchar * location)
{
  g_autofree gchar *head = cloth_recover_get_name (location,
      CLOTH_MESH_FORMAT_AUTO);
  g_autofree gchar *stem = g_strndup (head, strlen (head) -
      (g_str_has_suffix (head, ".ply") ? strlen (".ply") : 0));
  g_autofree gchar *first = g_strconcat (stem, "_00000.ply", NULL);

  return !g_file_test (location, G_FILE_TEST_EXISTS)
      && !g_file_test (head, G_FILE_TEST_EXISTS)
      && !g_file_test (first, G_FILE_TEST_EXISTS);
}

/* By what follows the last separators but those at the end. */
static gboolean
is_named (const gchar * path, const gchar * location)
{
  g_autofree gchar *a = g_path_get_basename (path);
  g_autofree gchar *b = g_path_get_basename (location);

  return g_str_equal (a, b);
}

/* Of several recordings to one name only the newest is finished: the next would replace
 * it. Another user's is finished only when it is named itself. */
static gboolean
recover_all (const gchar * location, gboolean overwrite)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GPtrArray) found = cloth_recover_find (location, &error);
  g_autoptr (GHashTable) seen =
      g_hash_table_new_full (g_str_hash, g_str_equal, g_free, NULL);
  gboolean done = TRUE;

  if (!found) {
    complain (FAILED, "%s", error->message);
    return FALSE;
  }
  if (found->len == 0 && is_unknown (location)) {
    complain (FAILED, "%s: nothing of that name was recorded", location);
    return FALSE;
  }
  if (found->len == 0)
    g_print ("%s: there is nothing to recover\n", location);
  for (guint i = 0; i < found->len; i++) {
    const gchar *path = found->pdata[i];
    gchar *target = cloth_recover_get_target (path);
    gboolean took_name = FALSE;

    if (cloth_parts_is_foreign (path) && !is_named (path, location)) {
      complain (FAILED,
          "%s: “%s” is another user's; name that itself to finish it",
          target, path);
      done = FALSE;
    } else if (!g_hash_table_contains (seen, target)) {
      done &= recover_one (path, overwrite, &took_name);
    } else {
      complain (FAILED,
          "%s: “%s” is older; wait for a program that writes the newer one, "
          "move that away and call again to finish this one too", target, path);
      done = FALSE;
    }
    if (took_name)
      g_hash_table_add (seen, target);
    else
      g_free (target);
  }
  return done;
}

gint
recover_takes (const Arguments * arguments)
{
  gboolean done = TRUE;

  if (!arguments->rest[1])
    return complain (BAD_USAGE,
        "name the recording, or the folder it lies in: recover FOLDER|FILE");
  for (guint i = 1; arguments->rest[i]; i++)
    if (!*arguments->rest[i])
      return complain (BAD_USAGE, "a name is empty");
  for (guint i = 1; arguments->rest[i]; i++)
    done &= recover_all (arguments->rest[i], arguments->overwrite);
  return done ? DONE : FAILED;
}
