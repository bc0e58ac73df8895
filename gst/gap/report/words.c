/* What a diagnosis found, in words and plain numbers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/words.h"

#include <math.h>
#include <string.h>

static const ClothGapEffect *
effect_at (const ClothGapResult * result, guint i)
{
  return &g_array_index (result->effects, ClothGapEffect, i);
}

/* "air_drag" is said "air drag", "stretch.warp" "stretch warp". */
static void
say_name (GString * text, const gchar * name)
{
  for (; *name; name++)
    g_string_append_c (text, *name == '_' || *name == '.' ? ' ' : *name);
}

/* Of which camera, too. */
static void
say_effect (GString * text, const ClothGapEffect * effect)
{
  say_name (text, effect->effect->id);
  if (effect->camera)
    g_string_append_printf (text, " of %s", effect->camera);
}

/* "(or this, or that)": what is confused with an accepted effect. */
static void
say_alternatives (GString * text, const ClothGapResult * result,
    const ClothGapEffect * of)
{
  guint n = 0;

  for (guint i = 0; of->group >= 0 && i < result->effects->len; i++) {
    const ClothGapEffect *other = effect_at (result, i);

    if (other == of || other->group != of->group || other->accepted)
      continue;
    g_string_append (text, n++ ? ", or " : " (or ");
    say_effect (text, other);
  }
  if (n > 0)
    g_string_append_c (text, ')');
}

/* The names of the accepted effects; returns how many there are. */
static guint
say_accepted (GString * text, const ClothGapResult * result)
{
  guint n = 0, said = 0;

  for (guint i = 0; i < result->effects->len; i++)
    n += effect_at (result, i)->accepted ? 1 : 0;
  for (guint i = 0; i < result->effects->len; i++) {
    const ClothGapEffect *effect = effect_at (result, i);

    if (!effect->accepted)
      continue;
    if (said > 0)
      g_string_append (text, said + 1 == n ? " and " : ", ");
    say_effect (text, effect);
    say_alternatives (text, result, effect);
    said++;
  }
  return n;
}

/* With a point, whatever the language. */
static void
say_number (GString * text, const gchar * format, gdouble value)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE];

  g_string_append (text, g_ascii_formatd (digits, sizeof digits, format,
          value));
}

static void
say_percent (GString * text, const ClothGapEstimate * share)
{
  say_number (text, "%.0f", 100 * share->value);
  g_string_append_c (text, '%');
  if (isfinite (share->low) && isfinite (share->high)) {
    g_string_append (text, " [");
    say_number (text, "%.0f", 100 * share->low);
    g_string_append (text, ", ");
    say_number (text, "%.0f", 100 * share->high);
    g_string_append_c (text, ']');
  }
}

static void
say_length (GString * text, gdouble metres)
{
  say_number (text, "%.1f", 1000 * metres);
  g_string_append (text, " mm");
}

/* ", 2.1× the floor" */
static void
say_floor (GString * text, const ClothGapResult * result)
{
  if (!(result->noise_floor.value > 0))
    return;
  g_string_append (text, ", ");
  say_number (text, "%.1f", result->gap_before.value /
      result->noise_floor.value);
  g_string_append (text, "× the floor");
}

static void
say_gap (GString * text, const ClothGapResult * result)
{
  if (!isfinite (result->gap_before.value))
    return;
  g_string_append (text, "Gap ");
  say_length (text, result->gap_before.value);
  say_floor (text, result);
  g_string_append (text, ". ");
}

static const gchar *
where_judged (const ClothGapResult * result)
{
  return result->held_out_takes ? "on an unseen take" :
      "on held-out time blocks";
}

/* Gusts are never accepted: what they do follows from nothing. */
static void
say_none (GString * text, const ClothGapResult * result)
{
  const ClothGapEffect *first = result->effects->len ?
      &g_array_index (result->effects, ClothGapEffect, 0) : NULL;

  if (first && first->effect->test == CLOTH_EFFECT_TEST_STOCHASTIC
      && first->probability > 0.3)
    g_string_append_printf (text, "Gusts are the likeliest cause (%.0f%%), "
        "which no simulation can foretell", 100. * first->probability);
  else
    g_string_append (text, "No effect of the library explains it");
}

/* What the accepted effects bring, on which data. */
static void
say_explained (GString * text, const ClothGapResult * result)
{
  gsize start = text->len;
  guint n = say_accepted (text, result);

  if (n > 0)
    text->str[start] = g_ascii_toupper (text->str[start]);
  if (n == 0) {
    say_none (text, result);
  } else if (isfinite (result->shrink.value)) {
    g_string_append (text, n > 1 ? " explain " : " explains ");
    say_percent (text, &result->shrink);
    g_string_append_printf (text, " %s", where_judged (result));
  } else if (isfinite (result->gap_after.value)) {
    g_string_append (text, n > 1 ? " take it to " : " takes it to ");
    say_length (text, result->gap_after.value);
  } else {
    g_string_append (text, n > 1 ? " were added" : " was added");
  }
}

/* @result: a result
 *
 * Returns: (transfer full): the verdict in words, one line
 */
gchar *
cloth_gap_result_summary (const ClothGapResult * result)
{
  GString *text = g_string_new (NULL);

  switch (result->verdict) {
    case CLOTH_GAP_UNDECIDABLE:
      g_string_append (text, "Undecidable: ");
      g_string_append (text, result->reason ? result->reason :
          "no reason was given.");
      break;
    case CLOTH_GAP_NO_GAP:
      g_string_append (text, "No gap");
      if (!isfinite (result->gap_before.value)) {
        g_string_append_c (text, '.');
        break;
      }
      g_string_append (text, ": ");
      say_length (text, result->gap_before.value);
      g_string_append_printf (text, " %s", where_judged (result));
      say_floor (text, result);
      g_string_append_c (text, '.');
      break;
    case CLOTH_GAP_EXPLAINED:
    case CLOTH_GAP_AMBIGUOUS:
      say_gap (text, result);
      say_explained (text, result);
      g_string_append (text, result->verdict == CLOTH_GAP_AMBIGUOUS ?
          "; these data can't tell which." : ".");
      break;
    case CLOTH_GAP_UNEXPLAINED:
      say_gap (text, result);
      say_explained (text, result);
      if (isfinite (result->gap_after.value)) {
        g_string_append (text, "; ");
        say_length (text, result->gap_after.value);
        g_string_append (text, " remain that no effect of the library "
            "explains");
      }
      g_string_append_c (text, '.');
      if (result->reason)
        g_string_append_printf (text, " %s", result->reason);
      break;
  }
  return g_string_free (text, FALSE);
}

/* Three digits, with the sign that is as wide as a digit. */
static void
say_signed (GString * text, gdouble value)
{
  if (value < 0.)
    g_string_append (text, "−");
  say_number (text, "%.3g", fabs (value));
}

/* A number with its unit, as people say it: angles in degrees, short lengths in mm. */
static void
say_quantity (GString * text, gdouble value, const gchar * unit)
{
  if (strcmp (unit, "rad") == 0) {
    value *= 180. / G_PI;
    unit = "°";
  } else if (strcmp (unit, "m") == 0 && fabs (value) < 0.1) {
    value *= 1000.;
    unit = "mm";
  }
  say_signed (text, value);
  if (strcmp (unit, "1") == 0 || *unit == '\0')
    return;
  if (strcmp (unit, "°") != 0)
    g_string_append_c (text, ' ');
  g_string_append (text, unit);
}

/* @limit: of which effect how much may be there unseen
 *
 * Returns: (transfer full): it in words: "air drag: coefficient above 0.9",
 *   "wind: x beyond ±0.1 m/s"
 */
gchar *
cloth_gap_limit_text (const ClothGapLimit * limit)
{
  const ClothEffectParameter *p = &limit->effect->parameters[limit->parameter];
  GString *text = g_string_new (NULL);

  say_name (text, limit->effect->id);
  g_string_append (text, isfinite (limit->value) ? ": " :
      ": unseen, whatever its ");
  say_name (text, p->name);
  if (!isfinite (limit->value))
    return g_string_free (text, FALSE);
  if (p->one_sided) {
    g_string_append (text, " above ");
    say_quantity (text, p->null_value + limit->value, p->unit);
  } else if (p->null_value == 0.) {
    g_string_append (text, " beyond ±");
    say_quantity (text, limit->value, p->unit);
  } else {
    g_string_append (text, " below ");
    say_quantity (text, p->null_value - limit->value, p->unit);
    g_string_append (text, " or above ");
    say_quantity (text, p->null_value + limit->value, p->unit);
  }
  return g_string_free (text, FALSE);
}

/* @name: of a number: a key of model.json
 * @before: its value; NaN: it was not there
 * @after: its value to set
 * @unit: of both, "1" for a ratio
 *
 * Returns: (transfer full): the change in words: "areal density × 0.61",
 *   "damping mass 0 → 0.3 1/s", "air drag coefficient 1.14"
 */
gchar *
cloth_gap_change_text (const gchar * name, gdouble before, gdouble after,
    const gchar * unit)
{
  GString *text = g_string_new (NULL);

  say_name (text, g_str_has_prefix (name, "effects.") ?
      name + strlen ("effects.") : name);
  g_string_append_c (text, ' ');
  if (before > 0. && after > 0.) {
    g_string_append (text, "× ");
    say_number (text, "%.3g", after / before);
    return g_string_free (text, FALSE);
  }
  if (!isnan (before)) {
    say_signed (text, before);
    g_string_append (text, " → ");
  }
  say_quantity (text, after, unit);
  return g_string_free (text, FALSE);
}
