/* Recordings whose program was killed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/recover.h"

#include <gio/gio.h>
#include <string.h>

#include "gst/take/take.h"

/* By the end of the name of the file that readers open first. The last three keep what they
 * need until their end in memory, or write it there. */
static const struct
{
  const gchar *ending;
  ClothRecover recover;
} formats[] = {
  {"take.json", cloth_take_recover}, {".obj", cloth_obj_pc2_recover},
  {".ply", cloth_ply_recover}, {".pvd", cloth_vtp_recover},
  {".csv", cloth_csv_recover}, {".glb", NULL}, {".usda", NULL}, {".c3d", NULL}
};

/* The place in the table, or its length. */
static guint
find_format (const gchar * head)
{
  guint i = 0;

  while (i < G_N_ELEMENTS (formats) &&
      !g_str_has_suffix (head, formats[i].ending))
    i++;
  return i;
}

/* @location: where a recording is to be written
 * @format: its format
 *
 * Returns: what a program that was killed left there
 */
ClothLeft
cloth_recover_look (const gchar * location, ClothMeshFormat format)
{
  g_autofree gchar *head = cloth_mesh_format_head (location, format);
  g_autoptr (GPtrArray) found = cloth_parts_find_for (head, NULL);
  ClothLeft left = CLOTH_LEFT_NOTHING;

  for (guint i = 0; found && i < found->len; i++) {
    if (!cloth_parts_is_dead (found->pdata[i]))
      continue;
    if (cloth_parts_has_frame (found->pdata[i]))
      return CLOTH_LEFT_FRAMES;
    left = CLOTH_LEFT_LOST;
  }
  return left;
}

/* The path alone, without a separator at its end. */
static GPtrArray *
name_one (const gchar * path)
{
  GPtrArray *paths = g_ptr_array_new_with_free_func (g_free);
  gsize n = strlen (path);

  while (path[n - 1] == G_DIR_SEPARATOR)
    n--;
  g_ptr_array_add (paths, g_strndup (path, n));
  return paths;
}

/* What is in a folder, and what takes in it have. */
static GPtrArray *
find_below (const gchar * folder, GError ** error)
{
  GPtrArray *found = cloth_parts_find (folder, NULL, error);
  GDir *dir = found ? g_dir_open (folder, 0, NULL) : NULL;
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *take = g_build_filename (folder, name, NULL);
    g_autoptr (GPtrArray) more = NULL;

    if (*name != '.' && g_file_test (take, G_FILE_TEST_IS_DIR)
        && !g_file_test (take, G_FILE_TEST_IS_SYMLINK))
      more = cloth_parts_find (take, "take.json", NULL);
    for (guint i = 0; more && i < more->len; i++)
      g_ptr_array_add (found, g_strdup (more->pdata[i]));
  }
  g_clear_pointer (&dir, g_dir_close);
  return found;
}

/* @location: where a recording is, or was to be
 * @format: its format
 *
 * Returns: (transfer full): what cloth_recover_find() is to be told
 */
gchar *
cloth_recover_get_name (const gchar * location, ClothMeshFormat format)
{
  gchar *head = cloth_mesh_format_head (location, format);

  if (!g_str_has_suffix (head, "/take.json"))
    return head;
  g_free (head);
  return g_strdup (location);
}

/* @location: a folder, or a recording as it was to be called, or what is left of it
 * @error: #GFileError
 *
 * Finds what programs left there, be they killed or at work.
 *
 * Returns: (transfer full) (element-type filename): for cloth_recover(); of each recording
 *   what was written to last comes first. Or %NULL
 */
GPtrArray *
cloth_recover_find (const gchar * location, GError ** error)
{
  g_autofree gchar *part = cloth_parts_get_head (location);
  g_autofree gchar *head = NULL;

  if (part && g_file_test (location, G_FILE_TEST_EXISTS))
    return name_one (location);
  if (g_file_test (location, G_FILE_TEST_IS_DIR))
    return find_below (location, error);
  head = cloth_mesh_format_head (location, CLOTH_MESH_FORMAT_AUTO);
  return cloth_parts_find_for (head, error);
}

/* @path: one that cloth_recover_find() found
 *
 * Returns: (transfer full): what it was to be: a file, or the folder of a take
 */
gchar *
cloth_recover_get_target (const gchar * path)
{
  g_autofree gchar *folder = g_path_get_dirname (path);
  g_autofree gchar *head = cloth_parts_get_head (path);

  if (g_str_equal (head, "take.json"))
    return g_steal_pointer (&folder);
  return g_str_equal (folder, ".") ? g_steal_pointer (&head) :
      g_build_filename (folder, head, NULL);
}

static gboolean
finish (ClothParts * parts, const gchar * head, ClothRecovered * recovered,
    GError ** error)
{
  const guint i = find_format (head);
  g_autofree gchar *base = NULL;

  if (i == G_N_ELEMENTS (formats)) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
        "it is no recording, and is left alone");
    return FALSE;
  }
  if (!formats[i].recover) {
    /* These are of one file: maybe only its name is missing. */
    recovered->placed = cloth_parts_is_whole (parts, head);
    if (recovered->placed)
      return cloth_parts_commit (parts, error);
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
        "a file of this format can't be finished: its frames are lost. Record a "
        "take, OBJ + PC2, PLY, VTP or CSV where that matters");
    return FALSE;
  }
  base = g_strndup (head, strlen (head) - strlen (formats[i].ending));
  if (!formats[i].recover (parts, base, recovered, error))
    return FALSE;
  if (recovered->n_frames > 0)
    return cloth_parts_commit (parts, error);
  /* Somebody may know what to do with it. */
  if (cloth_parts_had_frame (parts))
    return cloth_file_invalid (error,
        "no whole frame is found, though there was one: it is left as it is");
  return cloth_parts_discard (parts, error);
}

/* @path: one that cloth_recover_find() found
 * @overwrite: whether a recording may be replaced that has the name meanwhile
 * @recovered: (out): what it became
 * @error: #ClothFileError, #GIOErrorEnum; %G_IO_ERROR_BUSY: the program lives;
 *   %G_IO_ERROR_EXISTS: a recording would be replaced
 *
 * Finishes a recording; one without a whole frame is removed. After an error no whole frame
 * is lost.
 *
 * Returns: %TRUE when nothing is left of it but the recording
 */
gboolean
cloth_recover (const gchar * path, gboolean overwrite,
    ClothRecovered * recovered, GError ** error)
{
  g_autofree gchar *head = cloth_parts_get_head (path);
  g_autoptr (ClothParts) parts = NULL;
  ClothRemains remains;

  memset (recovered, 0, sizeof *recovered);
  if (!g_file_test (path, G_FILE_TEST_IS_DIR)
      || g_file_test (path, G_FILE_TEST_IS_SYMLINK))
    return cloth_parts_remove_lone (path, error);
  parts = cloth_parts_reopen (path, overwrite, &remains, error);
  if (!parts)
    return FALSE;
  switch (remains) {
    case CLOTH_REMAINS_PLACED:
      recovered->placed = TRUE;
      return TRUE;
    case CLOTH_REMAINS_NOTHING:
      return cloth_parts_discard (parts, error);
    default:
      return finish (parts, head, recovered, error);
  }
}
