/* Faults of the system, made on demand: a library that is preloaded. It stands between the
 * program, GLib and the C library.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/fault/fault.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define VISIBLE __attribute__ ((visibility ("default")))

void cloth_fault_arm (const gchar * call, guint nth, gint code,
    gboolean for_good);
gboolean cloth_fault_fired (void);

static struct
{
  const gchar *call;
  guint left;
  gint code;
  gboolean armed, fired, for_good;
} fault;

VISIBLE void
cloth_fault_arm (const gchar * call, guint nth, gint code, gboolean for_good)
{
  fault.call = call;
  fault.left = nth;
  fault.code = code;
  fault.armed = nth > 0;
  fault.for_good = for_good;
  fault.fired = FALSE;
}

VISIBLE gboolean
cloth_fault_fired (void)
{
  fault.armed = FALSE;
  return fault.fired;
}

/* Whether this call is the one that fails. */
static gboolean
strikes (const gchar * call)
{
  if (!fault.armed || (fault.fired && !fault.for_good) ||
      (*fault.call != '*' && strcmp (fault.call, call) != 0) ||
      (!fault.fired && --fault.left > 0))
    return FALSE;
  fault.fired = TRUE;
  if (fault.code == CLOTH_FAULT_KILL)
    kill (getpid (), SIGKILL);
  if (fault.code > 0)
    errno = fault.code;
  return TRUE;
}

#define NEXT(name) \
  static __typeof__ (name) *next; \
  if (!next) \
    next = (__typeof__ (name) *) dlsym (RTLD_NEXT, #name)

/* The file, and its name, of @fd vanish as if a cleaner had been here. */
static void
clear_file (gint fd)
{
  gchar link[64], path[4096];
  ssize_t n;

  snprintf (link, sizeof link, "/proc/self/fd/%d", fd);
  n = readlink (link, path, sizeof path - 1);
  if (n > 0) {
    path[n] = '\0';
    unlink (path);
  }
}

#define WRITER(name, result, failure, parameters, arguments) \
  VISIBLE result name parameters \
  { \
    NEXT (name); \
    if (strikes (#name)) \
      return failure; \
    return next arguments; \
  }

/* Large files have the same calls under two names. */
#define OPEN(name) \
  VISIBLE int name (const char *path, int flags, ...) \
  { \
    va_list arguments; \
    int mode; \
    NEXT (name); \
    va_start (arguments, flags); \
    mode = va_arg (arguments, int); \
    va_end (arguments); \
    return strikes ("open") ? -1 : next (path, flags, mode); \
  }
#define SIZED(name, call, type, size) \
  if (strikes (call)) { \
    if (fault.code != CLOTH_FAULT_SHORT) \
      return -1; \
    size = (size + 1) / 2; \
  }

#undef open
#undef open64
OPEN (open)
    OPEN (open64)
WRITER (rename, int, -1, (const char *from, const char *to), (from, to))
WRITER (close, int, (next (fd), -1), (int fd), (fd))
WRITER (mkdir, int, -1, (const char *path, mode_t mode), (path, mode))
WRITER (unlink, int, -1, (const char *path), (path))
WRITER (rmdir, int, -1, (const char *path), (path))
WRITER (opendir, DIR *, NULL, (const char *path), (path))
     VISIBLE ssize_t write (int fd, const void *data, size_t size)
{
  NEXT (write);
  SIZED (write, "write", ssize_t, size);
  return next (fd, data, size);
}

#define PLACED(name, call, pointer) \
  VISIBLE ssize_t name (int fd, pointer data, size_t size, off_t offset) \
  { \
    NEXT (name); \
    SIZED (name, call, ssize_t, size); \
    return next (fd, data, size, offset); \
  }
#define MOVED(name, call, result, parameters, arguments) \
  VISIBLE result name parameters \
  { \
    NEXT (name); \
    if (strikes (call)) \
      return -1; \
    return next arguments; \
  }

/* *INDENT-OFF* */
#undef pwrite
#undef pread
#undef ftruncate
#undef lseek
PLACED (pwrite, "pwrite", const void *)
PLACED (pwrite64, "pwrite", const void *)
PLACED (pread, "pread", void *)
PLACED (pread64, "pread", void *)
MOVED (ftruncate, "ftruncate", int, (int fd, off_t size), (fd, size))
MOVED (ftruncate64, "ftruncate", int, (int fd, off_t size), (fd, size))
MOVED (lseek, "lseek", off_t, (int fd, off_t to, int from), (fd, to, from))
MOVED (lseek64, "lseek", off_t, (int fd, off_t to, int from), (fd, to, from))
MOVED (lstat, "lstat", int, (const char *path, struct stat * info), (path, info))
MOVED (lstat64, "lstat", int, (const char *path, struct stat64 * info), (path, info))
MOVED (fstat, "fstat", int, (int fd, struct stat * info), (fd, info))
MOVED (fstat64, "fstat", int, (int fd, struct stat64 * info), (fd, info))
/* *INDENT-ON* */

VISIBLE int
fsync (int fd)
{
  NEXT (fsync);
  if (strikes ("fsync"))
    return -1;
  /* What is looked for is not how slow the disk is. */
  return fault.call ? 0 : next (fd);
}

VISIBLE int
syncfs (int fd)
{
  NEXT (syncfs);
  if (strikes ("syncfs"))
    return -1;
  return fault.call ? 0 : next (fd);
}

VISIBLE int
flock (int fd, int operation)
{
  NEXT (flock);
  if (!strikes ("flock"))
    return next (fd, operation);
  if (fault.code != CLOTH_FAULT_CLEARED)
    return -1;
  clear_file (fd);
  return next (fd, operation);
}
