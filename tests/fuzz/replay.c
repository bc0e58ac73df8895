/* Feeds every file of a corpus folder, and each of its truncations and single-byte
 * mutations up to a limit, to the fuzz target this is linked with, so that the
 * ordinary test run exercises what the fuzzer found.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <glib.h>

static guint64 n_inputs;

static void
replay (const guint8 * data, gsize size, gsize n_mutations)
{
  gsize step = MAX (1, size / n_mutations);

  LLVMFuzzerTestOneInput (data, size);
  n_inputs++;
  for (gsize n = 0; n < size; n += step) {
    /* An exact copy each time: an overread is seen by the sanitizers. */
    g_autofree guint8 *cut = g_memdup2 (data, n);
    g_autofree guint8 *bent = g_memdup2 (data, size);

    LLVMFuzzerTestOneInput (cut, n);
    bent[n] ^= (guint8) (0xff << (n % 7));
    LLVMFuzzerTestOneInput (bent, size);
    n_inputs += 2;
  }
}

int
main (int argc, char **argv)
{
  g_autoptr (GDir) dir = NULL;
  g_autoptr (GError) error = NULL;
  const gchar *name;
  guint files = 0;

  LLVMFuzzerInitialize (&argc, &argv);
  if (argc != 3 || !(dir = g_dir_open (argv[1], 0, &error))) {
    g_printerr ("usage: %s CORPUS-FOLDER MUTATIONS (%s)\n", argv[0],
        error ? error->message : "two arguments");
    return 2;
  }
  while ((name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (argv[1], name, NULL);
    g_autofree gchar *bytes = NULL;
    gsize size;

    if (!g_file_get_contents (path, &bytes, &size, &error)) {
      g_printerr ("%s\n", error->message);
      return 1;
    }
    replay ((const guint8 *) bytes, size,
        (gsize) MAX (1, g_ascii_strtoull (argv[2], NULL, 10)));
    files++;
  }
  g_print ("%u corpus files replayed, %" G_GUINT64_FORMAT " inputs in all\n",
      files, n_inputs);
  return files ? 0 : 1;
}
