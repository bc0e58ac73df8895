/* What keeps an estimate, and a diagnosis by it, from being made.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* RECORDING: a take can't be used at all. EFFECT: one that the library doesn't have.
 * MODEL: it is impossible. CANCELLED: the progress function asked to stop. SEARCH: a pattern
 * search can't begin so, or a log is of another one. */
typedef enum {
  CLOTH_FIT_ERROR_RECORDING,
  CLOTH_FIT_ERROR_EFFECT,
  CLOTH_FIT_ERROR_MODEL,
  CLOTH_FIT_ERROR_CANCELLED,
  CLOTH_FIT_ERROR_SEARCH
} ClothFitError;

#define CLOTH_FIT_ERROR (cloth_fit_error_quark ())
GQuark cloth_fit_error_quark (void);

G_END_DECLS
