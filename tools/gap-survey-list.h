/* gst-cloth-gap-1.0 survey: the list of takes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @name: the take as the list has it
 * @take: absolute path
 * @model: (nullable): absolute path; %NULL: --model's
 * @effects: (nullable): names with commas between them; %NULL: --effects'
 * @baselines: absolute paths
 * @hold_outs: absolute paths
 * @simulated: absolute paths
 * @after: absolute paths
 *
 * One line of the list: a diagnosis.
 */
typedef struct {
  gchar *name;
  gchar *take;
  gchar *model;
  gchar *effects;
  GPtrArray *baselines;
  GPtrArray *hold_outs;
  GPtrArray *simulated;
  GPtrArray *after;
} GapSurveyLine;

GPtrArray *gap_survey_list_parse (const gchar * text, const gchar * folder,
    GError ** error);

G_END_DECLS
