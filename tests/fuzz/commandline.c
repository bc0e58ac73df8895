/* Fuzz target: lengths, sizes, papers and lists of effects as people type them on command
 * lines. One text a line.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <math.h>

#include "gst/gap/inputs.h"
#include "gst/pattern/print.h"
#include "tools/tool.h"

#define MAX_SHEETS 400

static void
check_length (const gchar * text, gdouble * metres)
{
  g_autoptr (GError) error = NULL;

  g_assert_true (parse_length ("length", text, metres, &error)
      == (error == NULL));
  g_assert_true (isfinite (*metres) && *metres >= 0);
}

static void
check_size (const gchar * text)
{
  gint width = 0, height = 0;

  if (parse_size (text, &width, &height))
    g_assert_true (width >= 1 && height >= 1);
}

/* Every page of a layout has a place and a size. */
static void
check_layout (gdouble square, gdouble margin, gdouble overlap,
    const gdouble paper_mm[2])
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (8, 8, square, margin, TRUE, &error);
  const ClothArtwork artwork = { pattern, NULL };
  const ClothPrintOptions options = { {paper_mm[0], paper_mm[1]},
  1000 * margin, 1000 * overlap, NULL
  };
  ClothPrintLayout layout = { {0} };

  g_assert_true ((pattern == NULL) == (error != NULL));
  if (!pattern)
    return;
  g_assert_true (cloth_print_layout (&artwork, &options, &layout, &error)
      == (error == NULL));
  if (error)
    return;
  for (guint i = 0; i < 2; i++) {
    g_assert_true (layout.sheets[i] >= 1);
    g_assert_true (isfinite (layout.page_mm[i]) && layout.page_mm[i] > 0);
    g_assert_true (isfinite (layout.step_mm[i]));
  }
  g_assert_cmpint (layout.sheets[0] * layout.sheets[1], <=, MAX_SHEETS);
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  g_autofree gchar *text = fuzz_take_text (&bytes);
  g_auto (GStrv) lines = g_strsplit (text, "\n", 6);
  gdouble lengths[3] = { 0.05, 0.01, 0.01 }, paper_mm[2] = { 210, 297 };

  for (guint i = 0; lines[i]; i++) {
    g_autoptr (GError) error = NULL;

    if (i < G_N_ELEMENTS (lengths)) {
      check_length (lines[i], &lengths[i]);
    } else if (i == 3) {
      gdouble size_mm[2];

      if (cloth_print_paper (lines[i], size_mm)) {
        paper_mm[0] = size_mm[0];
        paper_mm[1] = size_mm[1];
      }
    } else if (i == 4) {
      check_size (lines[i]);
    } else {
      g_auto (GStrv) effects = cloth_gap_effects_parse (lines[i], &error);

      g_assert_true (!effects || !error);
    }
  }
  check_layout (lengths[0], lengths[1], lengths[2], paper_mm);
  return 0;
}
