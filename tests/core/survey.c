/* The table of a survey: means of takes that agree and that don't, by hand; what is no diagnosis.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/gap/survey/survey.h"

static void
test_pool (void)
{
  const gdouble values[] = { 1., 2., NAN, 7. };
  const gdouble sigmas[] = { 0.1, 0.1, 0.1, 0. };
  const gdouble uneven[] = { 0.5, 1. };
  ClothSurveyPooled pooled;

  /* Q = 2 (0.5 ÷ 0.1)² = 50, τ² = (50 − 1) ÷ (200 − 100) = 0.49, variance (0.01 + 0.49) ÷ 2 */
  pooled = cloth_survey_pool (values, sigmas, 4);
  g_assert_cmpuint (pooled.takes, ==, 2);
  g_assert_cmpfloat_with_epsilon (pooled.value, 1.5, 1e-12);
  g_assert_cmpfloat_with_epsilon (pooled.spread, 0.7, 1e-12);
  g_assert_cmpfloat_with_epsilon (pooled.sigma, 0.5, 1e-12);
  /* P (χ²₁ > 50) = erfc (5) */
  g_assert_cmpfloat_with_epsilon (pooled.p_value, erfc (5.), 1e-14);

  /* Q = (1 ÷ 5)² ⋅ … < 1: no spread; weights 4 and 1 */
  pooled = cloth_survey_pool (values, uneven, 2);
  g_assert_cmpfloat_with_epsilon (pooled.value, 1.2, 1e-12);
  g_assert_cmpfloat (pooled.spread, ==, 0.);
  g_assert_cmpfloat_with_epsilon (pooled.sigma, sqrt (0.2), 1e-12);
  /* Q = 4 ⋅ 0.2² + 0.8² = 0.8 */
  g_assert_cmpfloat_with_epsilon (pooled.p_value, erfc (sqrt (0.4)), 1e-12);

  pooled = cloth_survey_pool (values, sigmas, 1);
  g_assert_cmpfloat (pooled.value, ==, 1.);
  g_assert_cmpfloat_with_epsilon (pooled.sigma, 0.1, 1e-15);
  g_assert_true (isnan (pooled.spread) && isnan (pooled.p_value));
  pooled = cloth_survey_pool (values, sigmas, 0);
  g_assert_true (pooled.takes == 0 && isnan (pooled.value));
}

#define NONE "{\"value\": null, \"interval\": null}"
#define GAP(verdict, effects) "{\"verdict\": " verdict ", \"gap_before\": " NONE \
    ", \"gap_after\": " NONE ", \"noise_floor\": " NONE ", \"shrink\": " NONE \
    ", \"effects\": [" effects "]}"
#define EFFECT(name, camera, accepted, value) "{\"name\": \"" name "\", \"camera\": " camera \
    ", \"probability\": 0.5, \"accepted\": " accepted ", \"shrink\": " NONE \
    ", \"parameters\": [{\"name\": \"p\", \"unit\": \"m\", \"value\": " value \
    ", \"sigma\": 0.1}]}"

/* An effect of another camera is another one; one that was not accepted is tested only. */
static void
test_table (void)
{
  static const gchar *const gaps[] = {
    GAP ("\"explained\"", EFFECT ("a", "\"left\"", "true", "1") ", "
        EFFECT ("a", "\"right\"", "true", "5")),
    GAP ("\"explained\"", EFFECT ("a", "\"left\"", "true", "2") ", "
        EFFECT ("b", "null", "false", "9")),
    GAP ("\"no_gap\"", "")
  };
  g_autoptr (ClothSurvey) survey = cloth_survey_new ("0", 0);
  g_autofree gchar *text = NULL, *json = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (gaps); i++) {
    g_autoptr (GError) error = NULL;

    cloth_survey_add (survey, "take", "r", gaps[i], &error);
    g_assert_no_error (error);
  }
  cloth_survey_add_failure (survey, "bad", "why");
  g_assert_cmpuint (cloth_survey_get_n_failures (survey), ==, 1);
  text = cloth_survey_to_text (survey);
  g_assert_cmpstr (strstr (text, "\n\n") + 2, ==,
      "effect      takes   size\n"
      "a of left   2 of 2  p 1.5 ± 0.5 m (± 0.7 between takes)\n"
      "a of right  1 of 1  p 5 ± 0.1 m\n");
  g_assert_nonnull (strstr (text,
          "\nbad   failed     -    -      -       why\n"));
  json = cloth_survey_to_json (survey);
  g_assert_nonnull (strstr (json, "\"name\": \"b\""));
}

static void
test_refused (void)
{
  static const struct
  {
    const gchar *gap, *text;
  } cases[] = {
    {"{}", "“gap_before” must be an object"},
    {GAP ("\"fine\"", ""), "“verdict” must be"},
    {GAP ("3", ""), "“verdict” must be a text"},
    {GAP ("\"no_gap\"", "3"), "item 0 of “effects”"},
    {GAP ("\"no_gap\"", "{}"), "“shrink” must be an object"},
    {GAP ("\"no_gap\"", EFFECT ("a", "3", "true", "1")), "“camera”"},
    {GAP ("\"no_gap\"", EFFECT ("a", "null", "1", "1")), "“accepted”"},
    {GAP ("\"no_gap\"", EFFECT ("a", "null", "true", "\"x\"")), "“value”"},
    {"{\"verdict\": \"no_gap\", \"gap_before\": {\"value\": 1, \"interval\": [1]}}",
        "“interval” of “gap_before”"},
    {"[]", "not JSON"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_survey_summarise (cases[i].gap,
            strlen (cases[i].gap), &error));
    g_test_message ("%s", error->message);
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_nonnull (strstr (error->message, cases[i].text));
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/survey/pool", test_pool);
  g_test_add_func ("/survey/table", test_table);
  g_test_add_func ("/survey/refused", test_refused);
  return g_test_run ();
}
