/* Fuzz target: a spool that somebody else filled, for a worker and for a manager.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <glib/gstdio.h>
#include <string.h>

#include "gst/file/spool.h"

static const gchar *const names[] = {
  "spool.json", "todo/1.json", "todo/2.json", "todo/ .json",
  "running/1@other-1",
  "running/3@", "done/2.json", "done/3.json", "failed/3.json",
  "beats/other-1", "manager.json", "closed", NULL
};

static const ClothSpoolOptions options = { "test", "0.1", 1e-3 };

static void
remove_all (const gchar * path)
{
  GDir *dir = g_dir_open (path, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *inside = g_build_filename (path, name, NULL);

    remove_all (inside);
  }
  if (dir)
    g_dir_close (dir);
  g_remove (path);
}

static void
work (const gchar * folder)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSpool) spool = cloth_spool_join (folder, &options, 0.,
      &error);

  g_assert_true ((spool == NULL) == (error != NULL));
  for (guint i = 0; spool && i < 4; i++) {
    g_autoptr (ClothSpoolJob) job = cloth_spool_claim (spool, NULL);

    if (job && i % 2)
      cloth_spool_finish (spool, job, job->json, FALSE, NULL);
    else if (job)
      cloth_spool_give_back (spool, job, NULL);
    cloth_spool_get_state (spool);
  }
}

static void
manage (const gchar * folder)
{
  g_autofree gchar *path = g_build_filename (folder, "manager.json", NULL);
  g_autoptr (ClothSpool) spool = NULL;

  g_remove (path);              /* one that may live is waited for */
  spool = cloth_spool_manage (folder, &options, "p", TRUE, NULL);
  if (!spool)
    return;
  for (guint i = 1; i <= 3; i++) {
    g_autofree gchar *id = g_strdup_printf ("%u", i);

    cloth_spool_put (spool, id, "{}", i == 3, NULL);
  }
  for (guint i = 0; i < 6; i++) {
    g_autoptr (ClothSpoolJob) job = cloth_spool_take (spool, NULL);

    g_assert_true (!job || *job->json == '{' || strchr (job->json, '{'));
  }
  cloth_spool_look_after (spool, NULL);
  cloth_spool_close (spool, NULL);
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  gchar *folder = fuzz_folder_new (names, &bytes);

  work (folder);
  manage (folder);
  remove_all (folder);
  g_assert_false (g_file_test (folder, G_FILE_TEST_EXISTS));
  g_free (folder);
  return 0;
}
