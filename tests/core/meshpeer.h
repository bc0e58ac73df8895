/* For tests of file formats: a scratch folder, and NumPy as the independent reader
 * and writer.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gio/gio.h>
#include <glib/gstdio.h>

/* The scratch folder of the running test. */
static gchar *scratch;

static inline void
scratch_remove (const gchar * folder)
{
  g_autoptr (GDir) dir = g_dir_open (folder, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);

    if (g_file_test (path, G_FILE_TEST_IS_DIR)
        && !g_file_test (path, G_FILE_TEST_IS_SYMLINK))
      scratch_remove (path);
    else
      g_unlink (path);
  }
  g_rmdir (folder);
}

static inline void
scratch_begin (void)
{
  g_autoptr (GError) error = NULL;

  scratch = g_dir_make_tmp ("cloth-test-XXXXXX", &error);
  g_assert_no_error (error);
}

static inline void
scratch_end (void)
{
  scratch_remove (scratch);
  g_clear_pointer (&scratch, g_free);
}

static inline gchar *
scratch_path (const gchar * name)
{
  return g_build_filename (scratch, name, NULL);
}

static inline guint
scratch_count (void)
{
  g_autoptr (GDir) dir = g_dir_open (scratch, 0, NULL);
  guint n = 0;

  while (g_dir_read_name (dir))
    n++;
  return n;
}

static inline void
scratch_write (const gchar * name, gconstpointer bytes, gssize size)
{
  g_autofree gchar *path = scratch_path (name);
  g_autoptr (GError) error = NULL;

  g_file_set_contents (path, bytes, size, &error);
  g_assert_no_error (error);
}

/* Runs @script with the system's Python in the scratch folder; it must succeed. */
static inline void
peer_run (const gchar * script)
{
  g_autofree gchar *whole = g_strconcat ("import numpy as np, struct, os\n",
      script, NULL);
  const gchar *argv[] = { "/usr/bin/python3", "-c", whole, NULL };
  g_autofree gchar *errors = NULL;
  g_autoptr (GError) error = NULL;
  gint status;

  g_spawn_sync (scratch, (gchar **) argv, NULL, G_SPAWN_DEFAULT, NULL, NULL,
      NULL, &errors, &status, &error);
  g_assert_no_error (error);
  if (!g_spawn_check_wait_status (status, NULL))
    g_error ("the peer disagrees: %s", errors);
}
