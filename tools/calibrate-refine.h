/* refine: a rig corrected by a film of cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

gint calibrate_refine (const gchar * rig_file, const gchar * folder,
    const gchar * output);
