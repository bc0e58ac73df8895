/* From recordings to numbers of a model: candidates, sensitivities, normal equations, the
 * posterior and the fit.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/broyden.h"
#include "gst/fit/estimate/candidates.h"
#include "gst/fit/estimate/gauss-newton.h"
#include "gst/fit/estimate/normal.h"
#include "gst/fit/estimate/posterior.h"
#include "gst/fit/estimate/sensitivities.h"
