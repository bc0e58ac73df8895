/* Pictures of floats, read back by OpenCV; and what can't be written.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/pfm.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "tests/reference/reference.h"

static void
check (const gchar * folder, gint width, gint height)
{
  const gint n = width * height;
  g_autofree gchar *path = g_build_filename (folder, "a.pfm", NULL);
  g_autofree gfloat *floats = g_new (gfloat, n), *read = g_new (gfloat, n);
  g_autoptr (GError) error = NULL;

  for (gint i = 0; i < n; i++)
    floats[i] = i % 7 == 3 ? NAN : 0.37f * (gfloat) i - 100;
  g_assert_true (cloth_pfm_write (path, floats, width, height, &error));
  g_assert_no_error (error);
  g_assert_true (cloth_cv_read_floats (path, width, height, read));
  for (gint i = 0; i < n; i++)
    if (i % 7 == 3)
      g_assert_true (isinf (read[i]) && read[i] > 0);
    else
      g_assert_cmpfloat (read[i], ==, floats[i]);
  g_unlink (path);
}

static void
test_read_back (void)
{
  g_autofree gchar *folder = g_dir_make_tmp ("pfm-XXXXXX", NULL);

  check (folder, 1, 1);
  check (folder, 5, 3);
  check (folder, 257, 4);
  check (folder, 640, 48);
  /* nothing else was left */
  g_assert_cmpint (g_rmdir (folder), ==, 0);
}

static void
test_bytes (void)
{
  static const gfloat floats[2] = { 1, -2 };
  static const gchar wanted[] =
      "Pf\n1 2\n-1.0\n\x00\x00\x00\xc0\x00\x00\x80\x3f";
  g_autofree gchar *folder = g_dir_make_tmp ("pfm-XXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (folder, "a.pfm", NULL);
  g_autofree gchar *bytes = NULL;
  gsize size;

  g_assert_true (cloth_pfm_write (path, floats, 1, 2, NULL));
  g_assert_true (g_file_get_contents (path, &bytes, &size, NULL));
  g_assert_cmpmem (bytes, size, wanted, sizeof (wanted) - 1);
  g_unlink (path);
  g_rmdir (folder);
}

static void
test_refused (void)
{
  static const gfloat one = 1;
  g_autofree gchar *folder = g_dir_make_tmp ("pfm-XXXXXX", NULL);
  g_autofree gchar *gone = g_build_filename (folder, "gone", "a.pfm", NULL);
  g_autoptr (GError) error = NULL;
  g_autoptr (GError) other = NULL;

  g_assert_false (cloth_pfm_write (gone, &one, 1, 1, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_assert_nonnull (strstr (error->message, "gone"));
  /* a folder is no file */
  g_assert_false (cloth_pfm_write (folder, &one, 1, 1, &other));
  g_assert_nonnull (other);
  g_assert_cmpint (g_rmdir (folder), ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/pfm/read-back", test_read_back);
  g_test_add_func ("/pfm/bytes", test_bytes);
  g_test_add_func ("/pfm/refused", test_refused);
  return g_test_run ();
}
