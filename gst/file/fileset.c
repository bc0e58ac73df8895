/* Numbered files that get their names together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/fileset.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <unistd.h>

struct _ClothFileSet
{
  gchar *stem, *ending;
  gchar *hidden;                /* the folder where they wait */
  guint64 n_files;
};

static gboolean
fail_errno (GError ** error, const gchar * path)
{
  gint code = errno;

  g_set_error (error, G_IO_ERROR, g_io_error_from_errno (code),
      "cannot write “%s”: %s", path, g_strerror (code));
  return FALSE;
}

/* @stem: what the names begin with
 * @ending: what they end with, with its point
 * @error: #GIOErrorEnum
 *
 * Starts `stem_00000.ending` and so on; they wait in a hidden folder beside.
 *
 * Returns: (transfer full): the set, or %NULL
 */
ClothFileSet *
cloth_file_set_new (const gchar * stem, const gchar * ending, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (stem);
  g_autofree gchar *base = g_path_get_basename (stem);
  g_autofree gchar *name = g_strdup_printf (".%s.XXXXXX", base);
  g_autofree gchar *hidden = g_build_filename (folder, name, NULL);
  ClothFileSet *set;

  if (!g_mkdtemp_full (hidden, 0777)) {
    fail_errno (error, folder);
    return NULL;
  }
  set = g_new0 (ClothFileSet, 1);
  set->stem = g_strdup (stem);
  set->ending = g_strdup (ending);
  set->hidden = g_steal_pointer (&hidden);
  return set;
}

static gchar *
hidden_path (const ClothFileSet * set, guint64 number)
{
  return g_strdup_printf ("%s/%05" G_GUINT64_FORMAT, set->hidden, number);
}

static gchar *
final_path (const ClothFileSet * set, guint64 number)
{
  return g_strdup_printf ("%s_%05" G_GUINT64_FORMAT "%s", set->stem, number,
      set->ending);
}

/* @set: the set
 * @error: #GIOErrorEnum
 *
 * Returns: (transfer full): the next file, for cloth_file_set_end(), or %NULL
 */
ClothOutput *
cloth_file_set_begin (ClothFileSet * set, GError ** error)
{
  g_autofree gchar *path = hidden_path (set, set->n_files);
  ClothOutput *output = cloth_output_new (path, error);

  if (output)
    cloth_output_set_sync (output, FALSE);
  return output;
}

/* @set: the set
 * @output: (transfer none): the file, whole now
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when the file belongs to the set
 */
gboolean
cloth_file_set_end (ClothFileSet * set, ClothOutput * output, GError ** error)
{
  if (!cloth_output_commit (&output, 1, error))
    return FALSE;
  set->n_files++;
  return TRUE;
}

/* All files to the disk at once, where the system can. */
static gboolean
sync_files (ClothFileSet * set, GError ** error)
{
#ifdef __linux__
  gint fd = g_open (set->hidden, O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0);
  gboolean done = fd >= 0 && syncfs (fd) == 0;

  if (!done)
    fail_errno (error, set->stem);
  if (fd >= 0)
    close (fd);
  return done;
#else
  sync ();
  return TRUE;
#endif
}

/* @set: the set
 * @error: #GIOErrorEnum
 *
 * Gives the files their names, replacing those of an earlier set, whole.
 *
 * Returns: %TRUE when all have them
 */
gboolean
cloth_file_set_commit (ClothFileSet * set, GError ** error)
{
  if (!sync_files (set, error))
    return FALSE;
  for (guint64 i = 0; i < set->n_files; i++) {
    g_autofree gchar *from = hidden_path (set, i);
    g_autofree gchar *to = final_path (set, i);

    if (g_rename (from, to) < 0) {
      fail_errno (error, to);
      for (guint64 done = 0; done < i; done++) {
        g_autofree gchar *path = final_path (set, done);

        g_unlink (path);
      }
      return FALSE;
    }
  }
  /* The rest of a longer sequence of this name would be read as part of it. */
  for (guint64 i = set->n_files;; i++) {
    g_autofree gchar *stale = final_path (set, i);

    if (g_unlink (stale) < 0)
      break;
  }
  return TRUE;
}

/* @set: (transfer full) (nullable): the set
 *
 * Frees it; files that were not committed are removed.
 */
void
cloth_file_set_free (ClothFileSet * set)
{
  if (!set)
    return;
  for (guint64 i = 0; i < set->n_files; i++) {
    g_autofree gchar *path = hidden_path (set, i);

    g_unlink (path);
  }
  g_rmdir (set->hidden);
  g_free (set->hidden);
  g_free (set->stem);
  g_free (set->ending);
  g_free (set);
}
