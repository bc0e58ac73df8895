/* What an element that joins several streams answers downstream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstaggregator.h>

G_BEGIN_DECLS

/* Method src_query of the aggregator. What is joined can be sought where all streams can, and one
 * stream alone has no latency of others. */
gboolean gst_cloth_sync_src_query (GstAggregator * agg, GstQuery * query);

G_END_DECLS
