/* Printed patterns: what is on the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/pattern.h"
