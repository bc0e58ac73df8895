/* Faults of the system, made on demand: what the preloaded library obeys.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @CLOTH_FAULT_KILL: the process is killed before the call
 * @CLOTH_FAULT_SHORT: half of the bytes are taken
 * @CLOTH_FAULT_CLEARED: the file is removed meanwhile
 *
 * Instead of an errno.
 */
enum
{ CLOTH_FAULT_KILL = -1, CLOTH_FAULT_SHORT = -2, CLOTH_FAULT_CLEARED = -3 };

/* @call: name of a function of the C library, `*` for any
 * @nth: which call of it fails, from 1 on; 0: none does
 * @code: an errno, or one of the above
 *
 * @for_good: whether all later ones fail as well
 *
 * Until the next one, calls are counted and not brought to the disk.
 */
typedef void (*ClothFaultArm) (const gchar * call, guint nth, gint code,
    gboolean for_good);
/* Returns: whether the fault happened. From then on none does */
typedef gboolean (*ClothFaultFired) (void);

G_END_DECLS
