/* The door of this folder: readers of OBJ, PC2, PLY and of recorded markers, writers of all
 * formats.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/formats/export.h"
#include "gst/mesh/formats/markers.h"
#include "gst/mesh/formats/obj.h"
#include "gst/mesh/formats/pc2.h"
#include "gst/mesh/formats/ply.h"
