/* The clock of benchmarks of one thread.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>
#include <time.h>

/* Processor time of this thread, ms: other programs that run meanwhile count less. */
static inline gdouble
cpu_ms (void)
{
  struct timespec t;

  clock_gettime (CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * (gdouble) t.tv_sec + 1e-6 * (gdouble) t.tv_nsec;
}
