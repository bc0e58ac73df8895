/* Tells the thread sanitizer of GLib's locks, which are futexes of its own: preloaded by
 * tests/run.sh --tsan.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <dlfcn.h>
#include <glib.h>
#include <sanitizer/tsan_interface.h>

/* A lock that is zero at first is known from its first use on. */
#define LINKER __tsan_mutex_linker_init

/* What GLib itself has of that name. */
static gpointer
find (const gchar * name)
{
  return dlsym (RTLD_NEXT, name);
}

#define REAL(name) \
  static __typeof__ (&name) real; \
  if (!real) \
    real = (__typeof__ (real)) find (#name)

void
g_mutex_lock (GMutex * mutex)
{
  REAL (g_mutex_lock);
  __tsan_mutex_pre_lock (mutex, LINKER);
  real (mutex);
  __tsan_mutex_post_lock (mutex, LINKER, 0);
}

gboolean
g_mutex_trylock (GMutex * mutex)
{
  gboolean locked;

  REAL (g_mutex_trylock);
  __tsan_mutex_pre_lock (mutex, LINKER | __tsan_mutex_try_lock);
  locked = real (mutex);
  __tsan_mutex_post_lock (mutex, LINKER | __tsan_mutex_try_lock |
      (locked ? 0 : __tsan_mutex_try_lock_failed), 0);
  return locked;
}

void
g_mutex_unlock (GMutex * mutex)
{
  REAL (g_mutex_unlock);
  __tsan_mutex_pre_unlock (mutex, 0);
  real (mutex);
  __tsan_mutex_post_unlock (mutex, 0);
}

void
g_mutex_clear (GMutex * mutex)
{
  REAL (g_mutex_clear);
  __tsan_mutex_destroy (mutex, LINKER);
  real (mutex);
}

void
g_rec_mutex_lock (GRecMutex * mutex)
{
  REAL (g_rec_mutex_lock);
  __tsan_mutex_pre_lock (mutex, LINKER | __tsan_mutex_write_reentrant);
  real (mutex);
  __tsan_mutex_post_lock (mutex, LINKER | __tsan_mutex_write_reentrant, 1);
}

void
g_rec_mutex_unlock (GRecMutex * mutex)
{
  REAL (g_rec_mutex_unlock);
  __tsan_mutex_pre_unlock (mutex, 0);
  real (mutex);
  __tsan_mutex_post_unlock (mutex, 0);
}

void
g_rec_mutex_clear (GRecMutex * mutex)
{
  REAL (g_rec_mutex_clear);
  __tsan_mutex_destroy (mutex, LINKER | __tsan_mutex_write_reentrant);
  real (mutex);
}

void
g_cond_wait (GCond * cond, GMutex * mutex)
{
  REAL (g_cond_wait);
  __tsan_mutex_pre_unlock (mutex, 0);
  __tsan_mutex_post_unlock (mutex, 0);
  real (cond, mutex);
  __tsan_mutex_pre_lock (mutex, LINKER);
  __tsan_mutex_post_lock (mutex, LINKER, 0);
}

gboolean
g_cond_wait_until (GCond * cond, GMutex * mutex, gint64 end_time)
{
  gboolean signalled;

  REAL (g_cond_wait_until);
  __tsan_mutex_pre_unlock (mutex, 0);
  __tsan_mutex_post_unlock (mutex, 0);
  signalled = real (cond, mutex, end_time);
  __tsan_mutex_pre_lock (mutex, LINKER);
  __tsan_mutex_post_lock (mutex, LINKER, 0);
  return signalled;
}

/* What one thread makes for all. */
gboolean (g_once_init_enter) (volatile void *location) {
  gboolean first;

  REAL (g_once_init_enter);
  first = real (location);
  __tsan_acquire ((void *) location);
  return first;
}

void (g_once_init_leave) (volatile void *location, gsize result)
{
  REAL (g_once_init_leave);
  __tsan_release ((void *) location);
  real (location, result);
}

/* A queue hands on what was made before. */
void
g_async_queue_push (GAsyncQueue * queue, gpointer data)
{
  REAL (g_async_queue_push);
  __tsan_release (queue);
  real (queue, data);
}

gpointer
g_async_queue_pop (GAsyncQueue * queue)
{
  gpointer data;

  REAL (g_async_queue_pop);
  data = real (queue);
  __tsan_acquire (queue);
  return data;
}

gpointer
g_async_queue_try_pop (GAsyncQueue * queue)
{
  gpointer data;

  REAL (g_async_queue_try_pop);
  data = real (queue);
  __tsan_acquire (queue);
  return data;
}

gpointer
g_async_queue_timeout_pop (GAsyncQueue * queue, guint64 timeout)
{
  gpointer data;

  REAL (g_async_queue_timeout_pop);
  data = real (queue, timeout);
  __tsan_acquire (queue);
  return data;
}

gint
g_async_queue_length (GAsyncQueue * queue)
{
  gint length;

  REAL (g_async_queue_length);
  length = real (queue);
  __tsan_acquire (queue);
  return length;
}

/* Who drops the last reference sees what the others did before they dropped theirs. */
void
g_object_unref (gpointer object)
{
  REAL (g_object_unref);
  __tsan_release (object);
  __tsan_acquire (object);
  real (object);
}

void
gst_mini_object_unref (gpointer object)
{
  static void (*real) (gpointer);

  if (!real)
    real = (void (*)(gpointer)) find ("gst_mini_object_unref");
  __tsan_release (object);
  __tsan_acquire (object);
  real (object);
}
