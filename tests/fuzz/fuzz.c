/* What the fuzz targets share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <glib/gstdio.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

static void
stop (int number)
{
  abort ();
}

/* A critical is a fault of ours, whatever the input. GLib traps then, but libFuzzer keeps the
 * input only of a program that aborts. */
int
LLVMFuzzerInitialize (int *argc, char ***argv)
{
  signal (SIGTRAP, stop);
  g_log_set_always_fatal (G_LOG_FATAL_MASK | G_LOG_LEVEL_CRITICAL);
  return 0;
}

guint8
fuzz_take_byte (FuzzBytes * bytes)
{
  if (bytes->size == 0)
    return 0;
  bytes->size--;
  return *bytes->data++;
}

guint16
fuzz_take_short (FuzzBytes * bytes)
{
  guint low = fuzz_take_byte (bytes);

  return (guint16) (low | (guint) fuzz_take_byte (bytes) << 8);
}

guint64
fuzz_take_long (FuzzBytes * bytes)
{
  guint64 value = 0;

  for (guint i = 0; i < 64; i += 8)
    value |= (guint64) fuzz_take_byte (bytes) << i;
  return value;
}

gfloat
fuzz_take_place (FuzzBytes * bytes, gfloat extent)
{
  static const gfloat wild[] = { NAN, INFINITY, -INFINITY, 0, -0.f, -1, 1e-38f,
    1e-45f, 3.4e38f, -3.4e38f, 1e6f, -1e6f, 2.2e9f, -2.2e9f, 0.5f, -0.5f
  };
  guint8 kind = fuzz_take_byte (bytes);

  if (kind < G_N_ELEMENTS (wild))
    return wild[kind];
  return extent * (gfloat) (kind - 32) / 192.f;
}

gchar *
fuzz_take_text (FuzzBytes * bytes)
{
  gchar *text = bytes->size > 0 ?
      g_strndup ((const gchar *) bytes->data, bytes->size) : g_strdup ("");

  bytes->size = 0;
  return text;
}

gchar *
fuzz_folder_new (const gchar * const *names, FuzzBytes * bytes)
{
  guint n = g_strv_length ((gchar **) names);
  gchar *folder = g_dir_make_tmp ("cloth-fuzz-XXXXXX", NULL);

  g_assert_nonnull (folder);
  while (bytes->size > 0) {
    const gchar *name = names[fuzz_take_byte (bytes) % n];
    g_autofree gchar *path = g_build_filename (folder, name, NULL);
    g_autofree gchar *parent = g_path_get_dirname (path);
    gsize size = fuzz_take_short (bytes);

    g_mkdir (parent, 0700);
    size |= (gsize) fuzz_take_byte (bytes) << 16;
    size = MIN (size, bytes->size);
    /* Not g_file_set_contents (), which waits for the disk. */
    {
      FILE *file = g_fopen (path, "wb");

      g_assert_nonnull (file);
      g_assert_true (fwrite (bytes->data, 1, size, file) == size);
      g_assert_true (fclose (file) == 0);
    }
    bytes->data += size;
    bytes->size -= size;
  }
  return folder;
}

void
fuzz_folder_free (const gchar * const *names, gchar * folder)
{
  for (; *names; names++) {
    g_autofree gchar *path = g_build_filename (folder, *names, NULL);
    g_autofree gchar *parent = g_path_get_dirname (path);

    g_remove (path);
    if (strcmp (parent, folder))
      g_rmdir (parent);
  }
  /* Nothing else was left in it. */
  g_assert_true (g_rmdir (folder) == 0);
  g_free (folder);
}
