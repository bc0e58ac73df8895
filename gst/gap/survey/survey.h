/* Many takes diagnosed, one table of effects over them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

/* What was found of each take, in the order of the list. */
typedef struct _ClothSurvey ClothSurvey;

/* @takes: on how many takes an effect was accepted and its parameter fitted
 * @value: mean over these takes
 * @sigma: standard deviation of @value
 * @spread: standard deviation between takes, beyond what each is sure of; NaN: one take
 * @p_value: that all takes have the same value; NaN: one take
 *
 * A parameter over takes.
 */
typedef struct {
  guint takes;
  gdouble value;
  gdouble sigma;
  gdouble spread;
  gdouble p_value;
} ClothSurveyPooled;

ClothSurveyPooled cloth_survey_pool (const gdouble * values,
    const gdouble * sigmas, guint n);

gchar *cloth_survey_summarise (const gchar * gap, gsize length,
    GError ** error);
ClothSurvey *cloth_survey_new (const gchar * program, guint64 seed);
gboolean cloth_survey_add (ClothSurvey * survey, const gchar * name,
    const gchar * report, const gchar * summary, GError ** error);
void cloth_survey_add_failure (ClothSurvey * survey, const gchar * name,
    const gchar * message);
guint cloth_survey_get_n_failures (const ClothSurvey * survey);
gchar *cloth_survey_to_json (const ClothSurvey * survey);
gchar *cloth_survey_to_text (const ClothSurvey * survey);
void cloth_survey_free (ClothSurvey * survey);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSurvey, cloth_survey_free)
G_END_DECLS
