/* gst-cloth-take-1.0 recover: finishes recordings whose program was killed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/take-tool.h"

#include <gio/gio.h>

#include "gst/take/recover.h"

static void
tell (const gchar * shown, const ClothRecovered * recovered)
{
  if (recovered->placed)
    g_print ("%s: it was whole; all its files have their names now\n", shown);
  else if (recovered->n_frames == 0)
    g_print ("%s: there was no whole frame; the remains are removed\n", shown);
  else
    g_print ("%s: %" G_GUINT64_FORMAT " frame%s kept%s\n", shown,
        recovered->n_frames, recovered->n_frames == 1 ? "" : "s",
        recovered->cut ? "; the last one was not whole and is left out" : "");
  if (recovered->dropped)
    g_print ("%s: %s was not whole and is left out\n", shown,
        recovered->dropped);
}

/* A message for each that can't be finished. */
static gboolean
recover_one (const gchar * path, gboolean overwrite)
{
  g_autofree gchar *target = cloth_recover_get_target (path);
  g_autofree gchar *shown = g_filename_display_name (target);
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  if (cloth_recover (path, overwrite, &recovered, &error)) {
    tell (shown, &recovered);
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

/* Of several recordings to one name only the newest is finished: the next would replace
 * it. */
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
  if (found->len == 0)
    g_print ("%s: there is nothing to recover\n", location);
  for (guint i = 0; i < found->len; i++) {
    const gchar *path = found->pdata[i];
    gchar *target = cloth_recover_get_target (path);

    if (g_hash_table_add (seen, target)) {
      done &= recover_one (path, overwrite);
    } else {
      complain (FAILED,
          "%s: “%s” is older; move the newer one away and call "
          "again to finish it too", (const gchar *) target, path);
      done = FALSE;
    }
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
    done &= recover_all (arguments->rest[i], arguments->overwrite);
  return done ? DONE : FAILED;
}
