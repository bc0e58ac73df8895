/* Fuzz target: what a survey reads: its list, a diagnosis, and the log of a pattern search. The first
 * byte says which.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <string.h>

#include "gst/fit/search/search.h"
#include "gst/gap/survey/survey.h"
#include "tools/gap-survey-list.h"

static void
read_list (const gchar * text)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GPtrArray) lines = gap_survey_list_parse (text, "/folder", &error);

  g_assert_true ((lines == NULL) == (error != NULL));
  for (guint i = 0; lines && i < lines->len; i++)
    g_assert_true (g_path_is_absolute (((GapSurveyLine *)
                lines->pdata[i])->take));
}

/* A summary of a summary is the same. */
static void
read_gap (const gchar * text)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *summary = cloth_survey_summarise (text, strlen (text),
      &error);
  g_autoptr (ClothSurvey) survey = cloth_survey_new ("0", 0);
  g_autofree gchar *again = NULL, *json = NULL, *table = NULL;

  g_assert_true ((summary == NULL) == (error != NULL));
  if (!summary)
    return;
  again = cloth_survey_summarise (summary, strlen (summary), NULL);
  g_assert_cmpstr (again, ==, summary);
  for (guint i = 0; i < 2; i++)
    g_assert_true (cloth_survey_add (survey, "a", "b", summary, NULL));
  json = cloth_survey_to_json (survey);
  table = cloth_survey_to_text (survey);
  g_assert_true (g_utf8_validate (json, -1, NULL));
}

static void
read_log (const gchar * text)
{
  const gdouble start[2] = { 1.5, -1. };
  ClothSearchOptions options;
  g_autoptr (ClothSearch) search = NULL;
  g_autofree gchar *log = NULL;

  cloth_search_options_init (&options);
  options.n = 2;
  options.start = start;
  options.as_they_come = TRUE;
  search = cloth_search_new (&options, NULL);
  log = g_strconcat (cloth_search_get_log (search), text, NULL);
  if (cloth_search_replay (search, log, NULL))
    g_assert_true (g_str_has_prefix (cloth_search_get_log (search),
            "pattern-search"));
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  const guint8 kind = fuzz_take_byte (&bytes);
  g_autofree gchar *text = fuzz_take_text (&bytes);

  if (kind % 3 == 0)
    read_list (text);
  else if (kind % 3 == 1)
    read_gap (text);
  else
    read_log (text);
  return 0;
}
