/* libgstcloth-1.0: everything.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>
#include <gst/cloth/gstclothsaddles.h>
#include <gst/cloth/gstclothquads.h>
#include <gst/cloth/gstclothdots.h>
#include <gst/cloth/gstclothsilhouette.h>
#include <gst/cloth/gstclothmatches.h>
#include <gst/cloth/gstclothdisparity.h>
#include <gst/cloth/gstclothmesh.h>
#include <gst/cloth/gstclothobservations.h>
#include <gst/cloth/gstclothgap.h>
#include <gst/cloth/gstclothuv.h>
#include <gst/cloth/gstclothview.h>
