/* Files: bounded reads, writes that appear whole or not at all.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/file.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define OUTPUT_BUFFER (1u << 18)
#define MAX_TEXT (16 * 1024 * 1024)

struct _ClothInput
{
  gint fd;                      /* -1: memory */
  const guint8 *data;
  guint64 size;
};

struct _ClothOutput
{
  gchar *path;
  gchar *temporary;             /* NULL once renamed */
  FILE *file;                   /* NULL once finished */
  gboolean sync;
};

struct _ClothFileSet
{
  gchar *stem, *ending;
  gchar *hidden;                /* the folder where they wait */
  guint64 n_files;
};

struct _ClothSpool
{
  FILE *file;
};

static gboolean
fail_errno (GError ** error, gint code, const gchar * doing, const gchar * path)
{
  g_autofree gchar *shown = g_filename_display_name (path);

  g_set_error (error, G_IO_ERROR, g_io_error_from_errno (code),
      "cannot %s “%s”: %s", doing, shown, g_strerror (code));
  return FALSE;
}

/* @path: a regular file
 * @error: #GIOErrorEnum
 *
 * Opens @path for reading. Pipes, devices and folders are refused, so that a name
 * in a hostile manifest can neither block nor read without end.
 *
 * Returns: (transfer full): the input, or %NULL
 */
ClothInput *
cloth_input_open (const gchar * path, GError ** error)
{
  ClothInput *input;
  struct stat info;
  gint fd = g_open (path, O_RDONLY | O_CLOEXEC | O_NONBLOCK, 0);

  if (fd < 0 || fstat (fd, &info) < 0) {
    fail_errno (error, errno, "open", path);
    if (fd >= 0)
      close (fd);
    return NULL;
  }
  if (!S_ISREG (info.st_mode)) {
    g_autofree gchar *shown = g_filename_display_name (path);

    close (fd);
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE,
        "“%s” is not a regular file", shown);
    return NULL;
  }
  input = g_new0 (ClothInput, 1);
  input->fd = fd;
  input->size = (guint64) info.st_size;
  return input;
}

/* @data: @size bytes, borrowed: they must outlive the input
 * @size: how many
 *
 * Returns: (transfer full): an input over memory
 */
ClothInput *
cloth_input_new_memory (const guint8 * data, gsize size)
{
  ClothInput *input = g_new0 (ClothInput, 1);

  input->fd = -1;
  input->data = data;
  input->size = size;
  return input;
}

/* @input: an input
 *
 * Returns: its size in bytes when it was opened
 */
guint64
cloth_input_get_size (const ClothInput * input)
{
  return input->size;
}

/* @input: an input
 * @offset: first byte
 * @destination: room for @size bytes
 * @size: how many bytes
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads exactly @size bytes. A file that shrank meanwhile is an error, not a crash
 * (the reason for not mapping it).
 *
 * Returns: %TRUE when all were read
 */
gboolean
cloth_input_read_at (ClothInput * input, guint64 offset, gpointer destination,
    gsize size, GError ** error)
{
  guint8 *to = destination;

  if (offset > input->size || size > input->size - offset) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED,
        "%" G_GSIZE_FORMAT " bytes wanted at %" G_GUINT64_FORMAT
        ", the file has %" G_GUINT64_FORMAT, size, offset, input->size);
    return FALSE;
  }
  if (input->fd < 0) {
    if (size > 0)
      memcpy (to, input->data + offset, size);
    return TRUE;
  }
  while (size > 0) {
    gssize n = pread (input->fd, to, size, (off_t) offset);

    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0) {
      g_set_error (error, G_IO_ERROR, g_io_error_from_errno (errno),
          "cannot read: %s", g_strerror (errno));
      return FALSE;
    }
    if (n == 0) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED,
          "the file became shorter while it was read");
      return FALSE;
    }
    to += n;
    offset += (guint64) n;
    size -= (gsize) n;
  }
  return TRUE;
}

/* @input: an input
 * @limit: the most bytes accepted
 * @bytes: set to the contents with one 0 byte behind them (`bytes->len` counts it)
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads everything. @bytes is reused, so that a sequence of files allocates once.
 *
 * Returns: %TRUE when all was read
 */
gboolean
cloth_input_load (ClothInput * input, gsize limit, GByteArray * bytes,
    GError ** error)
{
  if (input->size > MIN (limit, CLOTH_MAX_BUFFER)) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%" G_GUINT64_FORMAT " bytes are more than the %" G_GSIZE_FORMAT
        " accepted", input->size, (gsize) MIN (limit, CLOTH_MAX_BUFFER));
    return FALSE;
  }
  g_byte_array_set_size (bytes, (guint) input->size + 1);
  bytes->data[input->size] = 0;
  return cloth_input_read_at (input, 0, bytes->data, (gsize) input->size,
      error);
}

/* @input: (transfer full) (nullable): an input
 */
void
cloth_input_free (ClothInput * input)
{
  if (!input)
    return;
  if (input->fd >= 0)
    close (input->fd);
  g_free (input);
}

/* @path: the final name; its folder must exist
 * @error: #GIOErrorEnum
 *
 * Starts a file under a hidden temporary name in the same folder, so that a later
 * rename cannot cross file systems. Free without commit removes it.
 *
 * Returns: (transfer full): the output, or %NULL
 */
ClothOutput *
cloth_output_new (const gchar * path, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (path);
  g_autofree gchar *base = g_path_get_basename (path);
  g_autofree gchar *hidden = g_strdup_printf (".%s.XXXXXX", base);
  g_autofree gchar *temporary = g_build_filename (folder, hidden, NULL);
  ClothOutput *output;
  gint fd;

  if (g_file_test (path, G_FILE_TEST_IS_DIR)) {
    fail_errno (error, EISDIR, "write", path);
    return NULL;
  }
  fd = g_mkstemp_full (temporary, O_RDWR | O_CLOEXEC, 0666);
  if (fd < 0) {
    fail_errno (error, errno, "write", path);
    return NULL;
  }
  output = g_new0 (ClothOutput, 1);
  output->path = g_strdup (path);
  output->sync = TRUE;
  output->temporary = g_steal_pointer (&temporary);
  output->file = fdopen (fd, "wb");
  if (!output->file) {
    fail_errno (error, errno, "write", path);
    close (fd);
    cloth_output_free (output);
    return NULL;
  }
  setvbuf (output->file, NULL, _IOFBF, OUTPUT_BUFFER);
  return output;
}

/* @output: an output not yet finished
 * @data: bytes to append
 * @size: how many
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_output_write (ClothOutput * output, gconstpointer data, gsize size,
    GError ** error)
{
  if (size > 0 && fwrite (data, size, 1, output->file) != 1)
    return fail_errno (error, errno, "write", output->path);
  return TRUE;
}

/* @output: an output not yet finished
 * @error: #GIOErrorEnum
 * @format: as for printf. No floating point: its decimal point follows the locale
 *
 * Returns: %TRUE when the text was taken
 */
gboolean
cloth_output_printf (ClothOutput * output, GError ** error,
    const gchar * format, ...)
{
  va_list arguments;
  gint n;

  va_start (arguments, format);
  n = vfprintf (output->file, format, arguments);
  va_end (arguments);
  return n >= 0 || fail_errno (error, errno, "write", output->path);
}

/* @output: an output not yet finished
 * @offset: where in what is already written
 * @data: bytes that replace those there
 * @size: how many
 * @error: #GIOErrorEnum
 *
 * Mends a header whose counts are known at the end only; the next write appends
 * again.
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_output_write_at (ClothOutput * output, guint64 offset,
    gconstpointer data, gsize size, GError ** error)
{
  if (fseeko (output->file, (off_t) offset, SEEK_SET) < 0 ||
      fwrite (data, size, 1, output->file) != 1 ||
      fseeko (output->file, 0, SEEK_END) < 0)
    return fail_errno (error, errno, "write", output->path);
  return TRUE;
}

/* @output: an output
 * @error: #GIOErrorEnum
 *
 * Brings every byte to the disk and closes the file, still under its temporary
 * name. A second call does nothing.
 *
 * Returns: %TRUE when the file is whole
 */
gboolean
cloth_output_finish (ClothOutput * output, GError ** error)
{
  gint failed = 0;

  if (!output->file)
    return TRUE;
  if (fflush (output->file) != 0 ||
      (output->sync && fsync (fileno (output->file)) < 0))
    failed = errno;
  if (fclose (output->file) != 0 && !failed)
    failed = errno;
  output->file = NULL;
  return !failed || fail_errno (error, failed, "write", output->path);
}

/* @outputs: (array length=n_outputs): files that belong together
 * @n_outputs: how many
 * @error: #GIOErrorEnum
 *
 * Finishes all, and only then gives them their final names, in order. When one
 * cannot be renamed those before it are removed, so that no incomplete set stays.
 *
 * Returns: %TRUE when all have their names
 */
gboolean
cloth_output_commit (ClothOutput * const *outputs, guint n_outputs,
    GError ** error)
{
  for (guint i = 0; i < n_outputs; i++)
    if (!cloth_output_finish (outputs[i], error))
      return FALSE;
  for (guint i = 0; i < n_outputs; i++) {
    if (g_rename (outputs[i]->temporary, outputs[i]->path) < 0) {
      fail_errno (error, errno, "write", outputs[i]->path);
      for (guint done = 0; done < i; done++)
        g_unlink (outputs[done]->path);
      return FALSE;
    }
    g_clear_pointer (&outputs[i]->temporary, g_free);
  }
  return TRUE;
}

/* @path: where the file shall be
 * @text: what is in it
 * @error: #GIOErrorEnum
 *
 * The file appears whole or not at all.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_file_write_text (const gchar * path, const gchar * text, GError ** error)
{
  g_autoptr (ClothOutput) output = cloth_output_new (path, error);

  return output && cloth_output_write (output, text, strlen (text), error) &&
      cloth_output_commit (&output, 1, error);
}

/* @output: (transfer full) (nullable): an output
 *
 * Frees it, and removes the file unless it was committed.
 */
void
cloth_output_free (ClothOutput * output)
{
  if (!output)
    return;
  if (output->file)
    fclose (output->file);
  if (output->temporary)
    g_unlink (output->temporary);
  g_free (output->temporary);
  g_free (output->path);
  g_free (output);
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
    fail_errno (error, errno, "write", folder);
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
    output->sync = FALSE;
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
    fail_errno (error, errno, "write", set->stem);
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
      fail_errno (error, errno, "write", to);
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

static gboolean
fail_spool (GError ** error)
{
  gint code = errno;

  g_set_error (error, G_IO_ERROR, g_io_error_from_errno (code),
      "cannot keep what is to be written: %s", g_strerror (code));
  return FALSE;
}

/* @stem: what the names of the files begin with: the bytes wait on the same disk
 * @error: #GIOErrorEnum
 *
 * Starts a file without a name, which is gone with the process.
 *
 * Returns: (transfer full): an empty spool, or %NULL
 */
ClothSpool *
cloth_spool_new (const gchar * stem, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (stem);
  g_autofree gchar *path = g_build_filename (folder, ".spool.XXXXXX", NULL);
  gint fd = g_mkstemp_full (path, O_RDWR | O_CLOEXEC, 0600);
  FILE *file;
  ClothSpool *spool;

  if (fd < 0) {
    fail_spool (error);
    return NULL;
  }
  g_unlink (path);
  file = fdopen (fd, "w+b");
  if (!file) {
    fail_spool (error);
    close (fd);
    return NULL;
  }
  spool = g_new (ClothSpool, 1);
  spool->file = file;
  return spool;
}

/* @spool: a spool
 * @data: bytes to append
 * @size: how many
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_spool_write (ClothSpool * spool, gconstpointer data, gsize size,
    GError ** error)
{
  return size == 0 || fwrite (data, size, 1, spool->file) == 1 ||
      fail_spool (error);
}

/* @spool: a spool, which takes no more after this
 * @output: where to append all that it holds
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when all was taken
 */
gboolean
cloth_spool_copy (ClothSpool * spool, ClothOutput * output, GError ** error)
{
  gchar block[1 << 14];
  gsize n;

  if (fflush (spool->file) != 0 || fseeko (spool->file, 0, SEEK_SET) < 0)
    return fail_spool (error);
  while ((n = fread (block, 1, sizeof block, spool->file)) > 0)
    if (!cloth_output_write (output, block, n, error))
      return FALSE;
  return !ferror (spool->file) || fail_spool (error);
}

/* @spool: (transfer full) (nullable): a spool
 */
void
cloth_spool_free (ClothSpool * spool)
{
  if (!spool)
    return;
  fclose (spool->file);
  g_free (spool);
}

/* @path: a file
 * @length: (out): its bytes
 * @error: #GFileError, or #ClothFileError when it exceeds 16 MiB
 *
 * Looks at the size before it reads. Devices and pipes are refused: they may never end.
 *
 * Returns: (transfer full): the bytes and a 0, or %NULL.
 */
gchar *
cloth_text_file_load (const gchar * path, gsize * length, GError ** error)
{
  GStatBuf st;
  gchar *data = NULL;

  if (g_stat (path, &st) == 0) {
    if (!S_ISREG (st.st_mode)) {
      g_set_error (error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
          "%s: not a regular file", path);
      return NULL;
    }
    if (st.st_size > MAX_TEXT) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
          "%s: %" G_GINT64_FORMAT " bytes are more than the %d allowed", path,
          (gint64) st.st_size, MAX_TEXT);
      return NULL;
    }
  }
  if (!g_file_get_contents (path, &data, length, error))
    return NULL;
  if (*length > MAX_TEXT) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%s: grew beyond the %d bytes allowed", path, MAX_TEXT);
    g_free (data);
    return NULL;
  }
  return data;
}

/* @folder: the folder of a manifest
 * @name: a file name that the manifest gives
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Joins the two and makes sure that the file exists and lies inside @folder, after
 * every symbolic link was followed.
 *
 * Returns: (transfer full) (type filename): the path, or %NULL
 */
gchar *
cloth_path_inside (const gchar * folder, const gchar * name, GError ** error)
{
  g_autofree gchar *path = NULL;
  char *root = NULL, *real = NULL;
  gboolean inside = FALSE;

  if (!*name || g_path_is_absolute (name) || strstr (name, "..")) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "“%s” is no path inside the folder: name a file below it", name);
    return NULL;
  }
  path = g_build_filename (folder, name, NULL);
  root = realpath (folder, NULL);
  real = realpath (path, NULL);
  if (!root || !real) {
    fail_errno (error, errno, "open", path);
  } else {
    gsize length = strlen (root);

    inside = g_str_has_prefix (real, root) &&
        (real[length] == '/' || g_str_equal (root, "/"));
    if (!inside)
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
          "“%s” leads out of its folder", name);
  }
  free (root);
  free (real);
  return inside ? g_steal_pointer (&path) : NULL;
}

/* @items: numbers as they stand in a little-endian file, or are to stand there
 * @item_size: 1, 2, 4 or 8 bytes each
 * @n_items: how many
 *
 * Turns them in place into the processor's byte order, or back.
 */
void
cloth_swap_little_endian (gpointer items, gsize item_size, gsize n_items)
{
#if G_BYTE_ORDER != G_LITTLE_ENDIAN
  guint8 *p = items;

  for (gsize i = 0; i < n_items; i++, p += item_size) {
    for (gsize a = 0, b = item_size - 1; a < b; a++, b--) {
      guint8 kept = p[a];

      p[a] = p[b];
      p[b] = kept;
    }
  }
#endif
}
