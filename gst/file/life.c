/* Signs of life of processes that share a folder, on one host or on many.
 *
 * Each has a file with a number, which a thread keeps changing, and which is locked while it lives. Times
 * of files and clocks of hosts are never compared: who watches another notes by its own monotonic
 * clock when it last saw that one's number change. A name begins with the identity of the running
 * kernel: of those on the same one the lock tells at once whether they live.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/life.h"

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <string.h>
#include <unistd.h>

#include "gst/file/output.h"

#define BEAT_US G_USEC_PER_SEC
/* Bytes of a number that are looked at, and of the kernel's identity in a name. */
#define MAX_NUMBER 64
#define KERNEL 8

/* What was seen of another's number. */
typedef struct
{
  gchar *number;
  gint64 changed_us;
} Watch;

struct _ClothLife
{
  gchar *folder;
  gchar *name;
  gint fd;
  GThread *thread;
  GMutex mutex;
  GCond cond;
  gboolean ends;
  GHashTable *watches;          /* name → Watch */
};

static gchar *
find_kernel (void)
{
  g_autofree gchar *text = NULL;

  if (!g_file_get_contents ("/proc/sys/kernel/random/boot_id", &text, NULL,
          NULL) || strlen (text) < KERNEL)
    return g_strdup ("unknown0");
  text[KERNEL] = 0;
  for (const gchar * at = text; *at; at++)
    if (!g_ascii_isalnum (*at))
      return g_strdup ("unknown0");
  return g_steal_pointer (&text);
}

static gpointer
keep_changing (gpointer data)
{
  ClothLife *life = data;

  g_mutex_lock (&life->mutex);
  for (guint64 i = 1; !life->ends; i++) {
    gchar text[MAX_NUMBER];
    const gint n = g_snprintf (text, sizeof text, "%020" G_GUINT64_FORMAT "\n",
        i);

    /* It was as long before, so there is room; and a missed sign is no fault. */
    if (pwrite (life->fd, text, (gsize) n, 0) < 0 && errno == EBADF)
      break;
    g_cond_wait_until (&life->cond, &life->mutex,
        g_get_monotonic_time () + BEAT_US);
  }
  g_mutex_unlock (&life->mutex);
  return NULL;
}

static void
free_watch (gpointer data)
{
  Watch *watch = data;

  g_free (watch->number);
  g_free (watch);
}

/* @folder: that all share
 * @error: #GIOErrorEnum
 *
 * Returns: (transfer full) (nullable): one that gives a sign of life each second
 */
ClothLife *
cloth_life_new (const gchar * folder, GError ** error)
{
  static const gchar first[] = "00000000000000000000\n";
  g_autoptr (ClothLife) life = g_new0 (ClothLife, 1);
  g_autofree gchar *kernel = find_kernel ();
  g_autofree gchar *path = NULL;
  gint code;

  g_mutex_init (&life->mutex);
  g_cond_init (&life->cond);
  life->watches = g_hash_table_new_full (g_str_hash, g_str_equal, g_free,
      free_watch);
  life->folder = g_strdup (folder);
  life->name = g_strdup_printf ("%s-%d-%08x", kernel, (gint) getpid (),
      g_random_int ());
  path = g_build_filename (folder, life->name, NULL);
  life->fd = g_open (path, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
  if (life->fd < 0) {
    cloth_file_fail (error, errno, "write", path);
    return NULL;
  }
  cloth_file_lock_new (life->fd);
  code = cloth_file_append (life->fd, first, sizeof first - 1);
  if (code) {
    cloth_file_fail (error, code, "write", path);
    return NULL;
  }
  life->thread = g_thread_new ("life", keep_changing, life);
  return g_steal_pointer (&life);
}

/* @life: one
 *
 * Returns: (transfer none): letters, digits and `-`, which no other one has
 */
const gchar *
cloth_life_get_name (const ClothLife * life)
{
  return life->name;
}

/* Notes the number; whether it is another one than at the last look. */
static gboolean
has_changed (ClothLife * life, const gchar * name, const gchar * number)
{
  Watch *watch = g_hash_table_lookup (life->watches, name);
  const gboolean first = !watch;

  if (watch && g_str_equal (watch->number, number))
    return FALSE;
  watch = g_new0 (Watch, 1);
  watch->number = g_strdup (number);
  watch->changed_us = g_get_monotonic_time ();
  g_hash_table_insert (life->watches, g_strdup (name), watch);
  return !first;
}

/* @life: who looks
 * @name: for whom: letters, digits, `-` and `_`
 * @after_s: seconds of silence after which it is lost
 *
 * Returns: what is seen of it
 */
ClothLifeSign
cloth_life_look (ClothLife * life, const gchar * name, gdouble after_s)
{
  g_autofree gchar *path = g_build_filename (life->folder, name, NULL);
  const gboolean near = strncmp (name, life->name, KERNEL) == 0;
  gchar number[MAX_NUMBER + 1] = "";
  gboolean gone;
  const Watch *watch;
  gssize n;
  gint fd;

  if (g_str_equal (name, life->name))
    return CLOTH_LIFE_CHANGED;
  fd = g_open (path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0);
  n = fd < 0 ? 0 : read (fd, number, MAX_NUMBER);
  number[MAX (n, 0)] = 0;
  gone = near && (fd < 0 || !cloth_file_lock_old (fd));
  if (fd >= 0)
    close (fd);
  if (gone)
    return CLOTH_LIFE_LOST;
  if (has_changed (life, name, number))
    return CLOTH_LIFE_CHANGED;
  watch = g_hash_table_lookup (life->watches, name);
  return (gdouble) (g_get_monotonic_time () - watch->changed_us) >
      after_s * G_USEC_PER_SEC ? CLOTH_LIFE_LOST : CLOTH_LIFE_SILENT;
}

/* @life: (nullable) (transfer full): one, which gives no more signs
 */
void
cloth_life_free (ClothLife * life)
{
  if (!life)
    return;
  if (life->thread) {
    g_mutex_lock (&life->mutex);
    life->ends = TRUE;
    g_cond_signal (&life->cond);
    g_mutex_unlock (&life->mutex);
    g_thread_join (life->thread);
  }
  if (life->fd >= 0) {
    g_autofree gchar *path = g_build_filename (life->folder, life->name, NULL);

    g_unlink (path);
    close (life->fd);
  }
  g_mutex_clear (&life->mutex);
  g_cond_clear (&life->cond);
  g_hash_table_unref (life->watches);
  g_free (life->folder);
  g_free (life->name);
  g_free (life);
}
