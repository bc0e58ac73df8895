/* What every file of the lanes includes; the compiler reads it once for each variant, as
 * reading the intrinsics takes longer than a kernel.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib.h>
#include <math.h>
#include <string.h>

#if defined (__SSE2__)
#include <immintrin.h>
#endif
