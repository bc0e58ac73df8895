/* gst-cloth-gap-1.0 survey: the list of takes, a line each.
 *
 *   # a comment
 *   takes/drop
 *   'takes/robot 2' --baseline takes/calm --simulated mine/robot2
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-survey-list.h"

#include <stdarg.h>
#include <string.h>

#include "gst/file/error.h"

/* Takes of a list: a limit on a file that nobody vouches for. */
#define MAX_LINES 100000u

static void
free_line (gpointer data)
{
  GapSurveyLine *line = data;

  g_free (line->name);
  g_free (line->take);
  g_free (line->model);
  g_free (line->effects);
  g_ptr_array_unref (line->baselines);
  g_ptr_array_unref (line->hold_outs);
  g_ptr_array_unref (line->simulated);
  g_ptr_array_unref (line->after);
  g_free (line);
}

static GapSurveyLine *
new_line (void)
{
  GapSurveyLine *line = g_new0 (GapSurveyLine, 1);

  line->baselines = g_ptr_array_new_with_free_func (g_free);
  line->hold_outs = g_ptr_array_new_with_free_func (g_free);
  line->simulated = g_ptr_array_new_with_free_func (g_free);
  line->after = g_ptr_array_new_with_free_func (g_free);
  return line;
}

/* The list that an option fills, or the text that it sets. */
static gboolean
find_option (GapSurveyLine * line, const gchar * word, GPtrArray ** list,
    gchar *** text)
{
  const struct
  {
    const gchar *name;
    GPtrArray *list;
    gchar **text;
  } options[] = {
    {"--baseline", line->baselines, NULL},
    {"--hold-out", line->hold_outs, NULL},
    {"--simulated", line->simulated, NULL},
    {"--after", line->after, NULL},
    {"--model", NULL, &line->model},
    {"--effects", NULL, &line->effects},
  };

  for (guint i = 0; i < G_N_ELEMENTS (options); i++) {
    if (!strcmp (word, options[i].name)) {
      *list = options[i].list;
      *text = options[i].text;
      return TRUE;
    }
  }
  return FALSE;
}

static gboolean
read_words (GapSurveyLine * line, gchar ** words, const gchar * folder,
    GError ** error)
{
  GPtrArray *list = NULL;
  gchar **text = NULL;
  const gchar *option = NULL;   /* that has no value yet */

  for (; *words; words++) {
    g_autofree gchar *path = NULL;

    if (!strncmp (*words, "--", 2)) {
      if (option || !find_option (line, *words, &list, &text))
        return cloth_file_invalid (error, option ? "%s needs a value" :
            "“%s” is no option of a line; there are --baseline, --hold-out, "
            "--simulated, --after, --model and --effects", option ? option :
            *words);
      option = *words;
      continue;
    }
    path = g_canonicalize_filename (*words, folder);
    if (list) {
      g_ptr_array_add (list, g_steal_pointer (&path));
    } else if (text) {
      if (*text)
        return cloth_file_invalid (error, "“%s” comes twice, or has two "
            "values", *words);
      *text = text == &line->effects ? g_strdup (*words) :
          g_steal_pointer (&path);
    } else if (!line->take) {
      line->name = g_strdup (*words);
      line->take = g_steal_pointer (&path);
    } else {
      return cloth_file_invalid (error,
          "“%s” is a second take: give each a "
          "line of its own, and put names with spaces into quotes", *words);
    }
    option = NULL;
  }
  if (option)
    return cloth_file_invalid (error, "%s needs a value", option);
  return line->take || cloth_file_invalid (error, "there is no take; it "
      "comes before the options");
}

/* @text: of the list
 * @folder: that its names are in, absolute
 * @error: %CLOTH_FILE_ERROR_INVALID
 *
 * Returns: (transfer full) (nullable) (element-type GapSurveyLine): the lines, one at least
 */
GPtrArray *
gap_survey_list_parse (const gchar * text, const gchar * folder,
    GError ** error)
{
  g_autoptr (GPtrArray) lines = g_ptr_array_new_with_free_func (free_line);
  g_auto (GStrv) rows = g_strsplit (text, "\n", -1);

  if (!g_utf8_validate (text, -1, NULL)) {
    cloth_file_invalid (error, "the list is no text in UTF-8");
    return NULL;
  }
  for (guint i = 0; rows[i]; i++) {
    g_auto (GStrv) words = NULL;
    GError *fault = NULL;
    gboolean good;

    /* line ends of Windows */
    if (g_str_has_suffix (rows[i], "\r"))
      rows[i][strlen (rows[i]) - 1] = 0;
    good = g_shell_parse_argv (rows[i], NULL, &words, &fault);

    if (g_error_matches (fault, G_SHELL_ERROR, G_SHELL_ERROR_EMPTY_STRING)) {
      g_error_free (fault);
      continue;
    }
    if (good) {
      g_ptr_array_add (lines, new_line ());
      good = read_words (lines->pdata[lines->len - 1], words, folder, &fault);
    }
    if (good && lines->len > MAX_LINES)
      good = cloth_file_invalid (&fault, "a list has at most %u takes",
          MAX_LINES);
    if (!good) {
      g_propagate_prefixed_error (error, fault, "line %u: ", i + 1);
      return NULL;
    }
  }
  if (lines->len == 0) {
    cloth_file_invalid (error, "there is no take in it: write the folder of "
        "one on each line");
    return NULL;
  }
  return g_steal_pointer (&lines);
}
