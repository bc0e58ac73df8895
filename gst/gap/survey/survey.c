/* Many takes diagnosed, one table of effects over them.
 *
 * Model: a parameter differs between takes, vₜ ~ N(μ, σₜ² + τ²): σₜ is how sure a take is of it, τ
 *   how much it varies from take to take.
 * Assumption: takes are independent. Only takes on which the effect was accepted count, so the mean
 *   of an effect that is hard to see is too large.
 * Formula: with w = 1/σ², Q = Σ w (v − v̄)² and k takes, v̄ the mean weighted by w,
 *     τ² = max (0, (Q − (k − 1)) ÷ (Σw − Σw² ÷ Σw)),
 *     μ = Σ v ÷ (σ² + τ²) ÷ Σ 1 ÷ (σ² + τ²), whose variance is 1 ÷ Σ 1 ÷ (σ² + τ²).
 *   Q of takes that agree is χ² with k − 1 degrees.
 * Reference: DerSimonian and Laird, “Meta-analysis in clinical trials”, Controlled Clinical Trials 7,
 *   1986; Cochran, Biometrics 10, 1954, for Q.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/survey/survey.h"

#include <math.h>
#include <string.h>

#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"
#include "gst/math/statistics.h"

#define SURVEY_VERSION 1
/* More of these are no diagnosis. */
#define MAX_EFFECTS 10000u
#define MAX_PARAMETERS 16u

typedef struct
{
  gdouble value, low, high;
} Estimate;

typedef struct
{
  gchar *name, *unit;
  gdouble value, sigma;
} Parameter;

typedef struct
{
  gchar *name, *camera;         /* @camera may be NULL */
  gdouble probability;
  gboolean accepted;
  Estimate shrink;
  GArray *parameters;
} Effect;

typedef struct
{
  gchar *name, *report;         /* both NULL in a summary */
  gchar *error;                 /* then nothing below */
  gchar *verdict, *reason, *summary, *sha256;
  Estimate gap_before, gap_after, noise_floor, shrink;
  GArray *effects;
} Take;

struct _ClothSurvey
{
  gchar *program;
  guint64 seed;
  GPtrArray *takes;
};

static const ClothJsonFile gap_file = {
  "gap.json", cloth_file_error_quark, CLOTH_FILE_ERROR_INVALID
};

static void
clear_parameter (gpointer data)
{
  Parameter *parameter = data;

  g_free (parameter->name);
  g_free (parameter->unit);
}

static void
clear_effect (gpointer data)
{
  Effect *effect = data;

  g_free (effect->name);
  g_free (effect->camera);
  g_array_unref (effect->parameters);
}

static void
free_take (gpointer data)
{
  Take *take = data;

  g_free (take->name);
  g_free (take->report);
  g_free (take->error);
  g_free (take->verdict);
  g_free (take->reason);
  g_free (take->summary);
  g_free (take->sha256);
  g_array_unref (take->effects);
  g_free (take);
}

static Take *
new_take (void)
{
  Take *take = g_new0 (Take, 1);

  take->effects = g_array_new (FALSE, TRUE, sizeof (Effect));
  g_array_set_clear_func (take->effects, clear_effect);
  return take;
}

/* ---- reading ---- */

/* A number or null, which is NaN. */
static gboolean
get_number (JsonObject * object, const gchar * key, gdouble * value,
    GError ** error)
{
  JsonNode *node = cloth_json_find (object, key);

  *value = NAN;
  return !node || cloth_json_number (node, value) ||
      cloth_json_invalid (&gap_file, error, "“%s” must be a number or null",
      key);
}

static JsonObject *
get_object (JsonObject * object, const gchar * key, GError ** error)
{
  JsonNode *node = cloth_json_find (object, key);

  if (node && JSON_NODE_HOLDS_OBJECT (node))
    return json_node_get_object (node);
  cloth_json_invalid (&gap_file, error, "“%s” must be an object", key);
  return NULL;
}

static gboolean
get_estimate (JsonObject * parent, const gchar * key, Estimate * estimate,
    GError ** error)
{
  JsonObject *object = get_object (parent, key, error);
  JsonNode *node;
  JsonArray *ends;

  estimate->low = estimate->high = NAN;
  if (!object || !get_number (object, "value", &estimate->value, error))
    return FALSE;
  node = cloth_json_find (object, "interval");
  if (!node)
    return TRUE;
  ends = JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) : NULL;
  return (ends && json_array_get_length (ends) == 2 &&
      cloth_json_number (json_array_get_element (ends, 0), &estimate->low) &&
      cloth_json_number (json_array_get_element (ends, 1), &estimate->high)) ||
      cloth_json_invalid (&gap_file, error,
      "“interval” of “%s” must be two numbers", key);
}

static gboolean
read_parameters (JsonObject * object, Effect * effect, GError ** error)
{
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&gap_file, object, "parameters",
      MAX_PARAMETERS, &bad, error);

  for (guint i = 0; !bad && list && i < json_array_get_length (list); i++) {
    JsonObject *item = cloth_json_item_object (&gap_file, list, i,
        "parameters", error);
    Parameter *parameter;

    if (!item)
      return FALSE;
    g_array_set_size (effect->parameters, i + 1);
    parameter = &g_array_index (effect->parameters, Parameter, i);
    if (!cloth_json_get_string (&gap_file, item, "name", &parameter->name,
            error) || !cloth_json_get_string (&gap_file, item, "unit",
            &parameter->unit, error) || !get_number (item, "value",
            &parameter->value, error) || !get_number (item, "sigma",
            &parameter->sigma, error))
      return FALSE;
    if (!parameter->name || !parameter->unit)
      return cloth_json_invalid (&gap_file, error, "a parameter lacks its "
          "“name” or “unit”");
  }
  return !bad;
}

static gboolean
read_effect (JsonObject * object, Effect * effect, GError ** error)
{
  JsonNode *accepted = cloth_json_find (object, "accepted");

  effect->parameters = g_array_new (FALSE, TRUE, sizeof (Parameter));
  g_array_set_clear_func (effect->parameters, clear_parameter);
  if (!cloth_json_get_string (&gap_file, object, "name", &effect->name, error)
      || !cloth_json_get_string (&gap_file, object, "camera", &effect->camera,
          error)
      || !get_number (object, "probability", &effect->probability, error)
      || !get_estimate (object, "shrink", &effect->shrink, error)
      || !read_parameters (object, effect, error))
    return FALSE;
  if (!effect->name || !accepted || !JSON_NODE_HOLDS_VALUE (accepted) ||
      json_node_get_value_type (accepted) != G_TYPE_BOOLEAN)
    return cloth_json_invalid (&gap_file, error,
        "an effect lacks its “name” " "or “accepted”");
  effect->accepted = json_node_get_boolean (accepted);
  return TRUE;
}

static gboolean
read_effects (JsonObject * object, Take * take, GError ** error)
{
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&gap_file, object, "effects",
      MAX_EFFECTS, &bad, error);

  for (guint i = 0; !bad && list && i < json_array_get_length (list); i++) {
    JsonObject *item = cloth_json_item_object (&gap_file, list, i, "effects",
        error);

    if (!item)
      return FALSE;
    g_array_set_size (take->effects, i + 1);
    if (!read_effect (item, &g_array_index (take->effects, Effect, i), error))
      return FALSE;
  }
  return !bad;
}

/* The hash of the first input, which is the take; a summary has it itself. */
static gboolean
read_hash (JsonObject * object, Take * take, GError ** error)
{
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&gap_file, object, "inputs",
      MAX_EFFECTS, &bad, error);
  JsonObject *item;

  if (bad
      || !cloth_json_get_string (&gap_file, object, "sha256", &take->sha256,
          error))
    return FALSE;
  if (take->sha256 || !list || json_array_get_length (list) == 0)
    return TRUE;
  item = cloth_json_item_object (&gap_file, list, 0, "inputs", error);
  return item
      && cloth_json_get_string (&gap_file, item, "sha256", &take->sha256,
      error);
}

/* Of gap.json or of a summary of it, whose keys are the same. */
static Take *
read_take (JsonObject * object, GError ** error)
{
  static const gchar *const verdicts[] = { "no_gap", "explained", "ambiguous",
    "unexplained", "undecidable", NULL
  };
  Take *take = new_take ();

  if (cloth_json_get_string (&gap_file, object, "verdict", &take->verdict,
          error)
      && cloth_json_get_string (&gap_file, object, "reason", &take->reason,
          error)
      && cloth_json_get_string (&gap_file, object, "summary", &take->summary,
          error)
      && get_estimate (object, "gap_before", &take->gap_before, error)
      && get_estimate (object, "gap_after", &take->gap_after, error)
      && get_estimate (object, "noise_floor", &take->noise_floor, error)
      && get_estimate (object, "shrink", &take->shrink, error)
      && read_effects (object, take, error)
      && read_hash (object, take, error)) {
    if (take->verdict && g_strv_contains (verdicts, take->verdict))
      return take;
    cloth_json_invalid (&gap_file, error, "“verdict” must be no_gap, "
        "explained, ambiguous, unexplained or undecidable");
  }
  free_take (take);
  return NULL;
}

/* ---- writing ---- */

static void
put_estimate (ClothJsonWriter * writer, const gchar * key,
    const Estimate * estimate)
{
  const gdouble ends[] = { estimate->low, estimate->high };
  const gboolean has = isfinite (ends[0]) && isfinite (ends[1]);

  cloth_json_writer_begin_object (writer, key);
  cloth_json_writer_number (writer, "value", estimate->value);
  cloth_json_writer_numbers (writer, "interval", has ? ends : NULL, 2);
  cloth_json_writer_end_object (writer);
}

static void
put_effect (ClothJsonWriter * writer, const Effect * effect)
{
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "name", effect->name);
  cloth_json_writer_string (writer, "camera", effect->camera);
  cloth_json_writer_number (writer, "probability", effect->probability);
  cloth_json_writer_boolean (writer, "accepted", effect->accepted);
  cloth_json_writer_begin_array (writer, "parameters");
  for (guint i = 0; i < effect->parameters->len; i++) {
    const Parameter *parameter = &g_array_index (effect->parameters,
        Parameter, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", parameter->name);
    cloth_json_writer_number (writer, "value", parameter->value);
    cloth_json_writer_number (writer, "sigma", parameter->sigma);
    cloth_json_writer_string (writer, "unit", parameter->unit);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  put_estimate (writer, "shrink", &effect->shrink);
  cloth_json_writer_end_object (writer);
}

static void
put_take (ClothJsonWriter * writer, const Take * take)
{
  cloth_json_writer_string (writer, "sha256", take->sha256);
  cloth_json_writer_string (writer, "verdict", take->verdict);
  cloth_json_writer_string (writer, "summary", take->summary);
  cloth_json_writer_string (writer, "reason", take->reason);
  put_estimate (writer, "gap_before", &take->gap_before);
  put_estimate (writer, "gap_after", &take->gap_after);
  put_estimate (writer, "noise_floor", &take->noise_floor);
  put_estimate (writer, "shrink", &take->shrink);
  cloth_json_writer_begin_array (writer, "effects");
  for (guint i = 0; i < take->effects->len; i++)
    put_effect (writer, &g_array_index (take->effects, Effect, i));
  cloth_json_writer_end_array (writer);
}

/* @gap: the text of gap.json
 * @length: its bytes
 * @error: #ClothFileError
 *
 * What a survey needs of a diagnosis, and nothing that differs from run to run.
 *
 * Returns: (transfer full) (nullable): an object of JSON
 */
gchar *
cloth_survey_summarise (const gchar * gap, gsize length, GError ** error)
{
  g_autoptr (JsonParser) parser = cloth_json_parse (gap, length, error);
  g_autoptr (ClothJsonWriter) writer = NULL;
  Take *take = parser ?
      read_take (json_node_get_object (json_parser_get_root (parser)), error) :
      NULL;

  if (!take)
    return NULL;
  writer = cloth_json_writer_new ();
  cloth_json_writer_set_exact (writer);
  cloth_json_writer_begin_object (writer, NULL);
  put_take (writer, take);
  cloth_json_writer_end_object (writer);
  free_take (take);
  return cloth_json_writer_finish (writer);
}

/* ---- pooling ---- */

/* @values: of a parameter on each take
 * @sigmas: their standard deviations; a value with none above 0 doesn't count
 * @n: how many
 *
 * Returns: the mean over takes that may differ; NaN without any
 */
ClothSurveyPooled
cloth_survey_pool (const gdouble * values, const gdouble * sigmas, guint n)
{
  ClothSurveyPooled pooled = { 0, NAN, NAN, NAN, NAN };
  gdouble w = 0., w_squared = 0., mean = 0., q = 0., variance = 0.;
  gdouble weight = 0., sum = 0.;

  for (guint i = 0; i < n; i++) {
    if (!isfinite (values[i]) || !(sigmas[i] > 0.) || !isfinite (sigmas[i]))
      continue;
    pooled.takes++;
    w += 1. / (sigmas[i] * sigmas[i]);
    w_squared += pow (sigmas[i], -4.);
    mean += values[i] / (sigmas[i] * sigmas[i]);
  }
  if (pooled.takes == 0)
    return pooled;
  mean /= w;
  for (guint i = 0; i < n; i++)
    if (isfinite (values[i]) && sigmas[i] > 0. && isfinite (sigmas[i]))
      q += pow ((values[i] - mean) / sigmas[i], 2.);
  if (pooled.takes > 1) {
    variance = MAX (0., (q - (pooled.takes - 1)) / (w - w_squared / w));
    pooled.spread = sqrt (variance);
    pooled.p_value = cloth_chi_square_tail (q, pooled.takes - 1);
  }
  for (guint i = 0; i < n; i++) {
    if (isfinite (values[i]) && sigmas[i] > 0. && isfinite (sigmas[i])) {
      weight += 1. / (sigmas[i] * sigmas[i] + variance);
      sum += values[i] / (sigmas[i] * sigmas[i] + variance);
    }
  }
  pooled.value = sum / weight;
  pooled.sigma = sqrt (1. / weight);
  return pooled;
}

/* An effect over takes: where it was tested, and the first take that has it. */
typedef struct
{
  const Effect *first;
  GPtrArray *accepted;          /* Effect */
  guint n_tested;
  gdouble probability;          /* sum */
} Row;

static void
clear_row (gpointer data)
{
  g_ptr_array_unref (((Row *) data)->accepted);
}

static Row *
find_row (GArray * rows, const Effect * effect)
{
  Row row = { effect, NULL, 0, 0. };

  for (guint i = 0; i < rows->len; i++) {
    Row *its = &g_array_index (rows, Row, i);

    if (!strcmp (its->first->name, effect->name) &&
        !g_strcmp0 (its->first->camera, effect->camera))
      return its;
  }
  row.accepted = g_ptr_array_new ();
  g_array_append_val (rows, row);
  return &g_array_index (rows, Row, rows->len - 1);
}

/* Those on most takes first, then the likeliest, then by name. */
static gint
compare_rows (gconstpointer a, gconstpointer b)
{
  const Row *x = a, *y = b;

  if (x->accepted->len != y->accepted->len)
    return x->accepted->len > y->accepted->len ? -1 : 1;
  if (x->probability != y->probability)
    return x->probability > y->probability ? -1 : 1;
  return strcmp (x->first->name, y->first->name) ? strcmp (x->first->name,
      y->first->name) : g_strcmp0 (x->first->camera, y->first->camera);
}

static GArray *
collect_rows (const ClothSurvey * survey)
{
  GArray *rows = g_array_new (FALSE, TRUE, sizeof (Row));

  g_array_set_clear_func (rows, clear_row);
  for (guint t = 0; t < survey->takes->len; t++) {
    const Take *take = survey->takes->pdata[t];

    for (guint i = 0; i < take->effects->len; i++) {
      Effect *effect = &g_array_index (take->effects, Effect, i);
      Row *row = find_row (rows, effect);

      row->n_tested++;
      row->probability += isfinite (effect->probability) ?
          effect->probability : 0.;
      if (effect->accepted)
        g_ptr_array_add (row->accepted, effect);
    }
  }
  g_array_sort (rows, compare_rows);
  return rows;
}

static ClothSurveyPooled
pool_row (const Row * row, const Parameter * parameter)
{
  const guint n = row->accepted->len;
  g_autofree gdouble *values = g_new (gdouble, n + 1);
  g_autofree gdouble *sigmas = g_new (gdouble, n + 1);

  for (guint t = 0; t < n; t++) {
    const Effect *effect = row->accepted->pdata[t];

    values[t] = sigmas[t] = NAN;
    for (guint i = 0; i < effect->parameters->len; i++) {
      const Parameter *its = &g_array_index (effect->parameters, Parameter, i);

      if (!strcmp (its->name, parameter->name)) {
        values[t] = its->value;
        sigmas[t] = its->sigma;
      }
    }
  }
  return cloth_survey_pool (values, sigmas, n);
}

/* ---- the survey ---- */

/* @program: version of the program
 * @seed: of the diagnoses
 *
 * Returns: (transfer full): a survey of no take
 */
ClothSurvey *
cloth_survey_new (const gchar * program, guint64 seed)
{
  ClothSurvey *survey = g_new0 (ClothSurvey, 1);

  survey->program = g_strdup (program);
  survey->seed = seed;
  survey->takes = g_ptr_array_new_with_free_func (free_take);
  return survey;
}

/* @survey: a survey
 * @name: of the take, as its list has it
 * @report: where the report is
 * @summary: what cloth_survey_summarise () says of it
 * @error: #ClothFileError
 *
 * Returns: whether it could be read
 */
gboolean
cloth_survey_add (ClothSurvey * survey, const gchar * name,
    const gchar * report, const gchar * summary, GError ** error)
{
  g_autoptr (JsonParser) parser = cloth_json_parse (summary, strlen (summary),
      error);
  Take *take = parser ?
      read_take (json_node_get_object (json_parser_get_root (parser)), error) :
      NULL;

  if (!take) {
    g_prefix_error (error, "%s: ", name);
    return FALSE;
  }
  take->name = g_strdup (name);
  take->report = g_strdup (report);
  g_ptr_array_add (survey->takes, take);
  return TRUE;
}

/* @survey: a survey
 * @name: of a take that could not be diagnosed
 * @message: why
 */
void
cloth_survey_add_failure (ClothSurvey * survey, const gchar * name,
    const gchar * message)
{
  Take *take = new_take ();

  take->name = g_strdup (name);
  take->error = g_strdup (message);
  g_ptr_array_add (survey->takes, take);
}

/* @survey: a survey
 *
 * Returns: how many takes could not be diagnosed
 */
guint
cloth_survey_get_n_failures (const ClothSurvey * survey)
{
  guint n = 0;

  for (guint t = 0; t < survey->takes->len; t++)
    n += ((const Take *) survey->takes->pdata[t])->error != NULL;
  return n;
}

static void
put_row (ClothJsonWriter * writer, const Row * row)
{
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "name", row->first->name);
  cloth_json_writer_string (writer, "camera", row->first->camera);
  cloth_json_writer_count (writer, "accepted", row->accepted->len);
  cloth_json_writer_count (writer, "tested", row->n_tested);
  cloth_json_writer_number (writer, "mean_probability",
      row->probability / row->n_tested);
  cloth_json_writer_begin_array (writer, "parameters");
  for (guint i = 0; i < row->first->parameters->len; i++) {
    const Parameter *parameter = &g_array_index (row->first->parameters,
        Parameter, i);
    const ClothSurveyPooled pooled = pool_row (row, parameter);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", parameter->name);
    cloth_json_writer_count (writer, "takes", pooled.takes);
    cloth_json_writer_number (writer, "value", pooled.value);
    cloth_json_writer_number (writer, "sigma", pooled.sigma);
    cloth_json_writer_number (writer, "spread", pooled.spread);
    cloth_json_writer_number (writer, "p_value", pooled.p_value);
    cloth_json_writer_string (writer, "unit", parameter->unit);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_end_object (writer);
}

/* @survey: a survey
 *
 * docs/survey.schema.json describes it. It holds nothing that differs from run to run.
 *
 * Returns: (transfer full): the text of survey.json
 */
gchar *
cloth_survey_to_json (const ClothSurvey * survey)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
  g_autoptr (GArray) rows = collect_rows (survey);

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_count (writer, "version", SURVEY_VERSION);
  cloth_json_writer_begin_array (writer, "takes");
  for (guint t = 0; t < survey->takes->len; t++) {
    const Take *take = survey->takes->pdata[t];

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", take->name);
    cloth_json_writer_string (writer, "error", take->error);
    if (!take->error) {
      cloth_json_writer_string (writer, "report", take->report);
      put_take (writer, take);
    }
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_begin_array (writer, "effects");
  for (guint i = 0; i < rows->len; i++)
    put_row (writer, &g_array_index (rows, Row, i));
  cloth_json_writer_end_array (writer);
  cloth_json_writer_count (writer, "seed", survey->seed);
  cloth_json_writer_string (writer, "program", survey->program);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

/* ---- for people ---- */

static void
add_cell (GPtrArray * cells, const gchar * format, ...)
G_GNUC_PRINTF (2, 3);

     static void add_cell (GPtrArray * cells, const gchar * format, ...)
{
  va_list arguments;

  va_start (arguments, format);
  g_ptr_array_add (cells, g_strdup_vprintf (format, arguments));
  va_end (arguments);
}

static void
add_number (GPtrArray * cells, gdouble value, gdouble factor,
    const gchar * format, const gchar * unit)
{
  gchar text[G_ASCII_DTOSTR_BUF_SIZE];

  if (isfinite (value))
    add_cell (cells, "%s%s", g_ascii_formatd (text, sizeof text, format,
            factor * value), unit);
  else
    add_cell (cells, "-");
}

/* The accepted effects; without any the likeliest one, in parentheses. */
static gchar *
describe_effects (const Take * take)
{
  g_autoptr (GString) text = g_string_new (NULL);
  gboolean any = FALSE;

  for (guint i = 0; i < take->effects->len; i++)
    any |= g_array_index (take->effects, Effect, i).accepted;
  for (guint i = 0; i < take->effects->len; i++) {
    const Effect *effect = &g_array_index (take->effects, Effect, i);
    gchar number[G_ASCII_DTOSTR_BUF_SIZE];

    if ((any ? !effect->accepted : i > 0) || !isfinite (effect->probability))
      continue;
    g_ascii_formatd (number, sizeof number, "%.2f", effect->probability);
    g_string_append_printf (text, "%s%s%s%s%s %s%s", *text->str ? ", " : "",
        any ? "" : "(", effect->name, effect->camera ? " of " : "",
        effect->camera ? effect->camera : "", number, any ? "" : ")");
  }
  return g_string_free (g_steal_pointer (&text), FALSE);
}

/* Columns under each other; the last one is not filled up. */
static void
write_table (GString * text, const GPtrArray * cells, guint n_columns)
{
  glong widths[8] = { 0 };

  for (guint i = 0; i < cells->len; i++)
    widths[i % n_columns] = MAX (widths[i % n_columns],
        g_utf8_strlen (cells->pdata[i], -1));
  for (guint i = 0; i < cells->len; i++) {
    const gchar *cell = cells->pdata[i];
    const guint column = i % n_columns;

    g_string_append (text, cell);
    if (column + 1 == n_columns) {
      while (g_str_has_suffix (text->str, " "))
        g_string_truncate (text, text->len - 1);
      g_string_append_c (text, '\n');
      continue;
    }
    for (glong k = g_utf8_strlen (cell, -1); k < widths[column] + 2; k++)
      g_string_append_c (text, ' ');
  }
}

static gchar *
describe_size (const Row * row)
{
  g_autoptr (GString) text = g_string_new (NULL);

  for (guint i = 0; i < row->first->parameters->len; i++) {
    const Parameter *parameter = &g_array_index (row->first->parameters,
        Parameter, i);
    const ClothSurveyPooled pooled = pool_row (row, parameter);
    gchar number[3][G_ASCII_DTOSTR_BUF_SIZE];

    if (!pooled.takes)
      continue;
    g_ascii_formatd (number[0], sizeof *number, "%.3g", pooled.value);
    g_ascii_formatd (number[1], sizeof *number, "%.2g", pooled.sigma);
    g_string_append_printf (text, "%s%s %s ± %s%s%s", *text->str ? ", " : "",
        parameter->name, number[0], number[1],
        strcmp (parameter->unit, "1") ? " " : "",
        strcmp (parameter->unit, "1") ? parameter->unit : "");
    if (pooled.spread > 0.)
      g_string_append_printf (text, " (± %s between takes)",
          g_ascii_formatd (number[2], sizeof *number, "%.2g", pooled.spread));
  }
  return g_string_free (g_steal_pointer (&text), FALSE);
}

/* @survey: a survey
 *
 * Returns: (transfer full): two tables for people: the takes, and the effects that were accepted on
 *   any
 */
gchar *
cloth_survey_to_text (const ClothSurvey * survey)
{
  g_autoptr (GPtrArray) takes = g_ptr_array_new_with_free_func (g_free);
  g_autoptr (GPtrArray) effects = g_ptr_array_new_with_free_func (g_free);
  g_autoptr (GArray) rows = collect_rows (survey);
  g_autoptr (GString) text = g_string_new (NULL);
  static const gchar *const heads[] = {
    "take", "verdict", "gap", "after", "shrink", "effects"
  };

  for (guint i = 0; i < G_N_ELEMENTS (heads); i++)
    add_cell (takes, "%s", heads[i]);
  for (guint t = 0; t < survey->takes->len; t++) {
    const Take *take = survey->takes->pdata[t];
    g_autofree gchar *its = describe_effects (take);

    add_cell (takes, "%s", take->name);
    add_cell (takes, "%s", take->error ? "failed" : take->verdict);
    add_number (takes, take->error ? NAN : take->gap_before.value, 1000.,
        "%.2f", " mm");
    add_number (takes, take->error ? NAN : take->gap_after.value, 1000.,
        "%.2f", " mm");
    add_number (takes, take->error ? NAN : take->shrink.value, 100., "%.0f",
        "%");
    add_cell (takes, "%s", take->error ? take->error : its);
  }
  write_table (text, takes, G_N_ELEMENTS (heads));
  add_cell (effects, "effect");
  add_cell (effects, "takes");
  add_cell (effects, "size");
  for (guint i = 0; i < rows->len; i++) {
    const Row *row = &g_array_index (rows, Row, i);
    g_autofree gchar *size = describe_size (row);

    if (!row->accepted->len)
      continue;
    add_cell (effects, "%s%s%s", row->first->name,
        row->first->camera ? " of " : "",
        row->first->camera ? row->first->camera : "");
    add_cell (effects, "%u of %u", row->accepted->len, row->n_tested);
    add_cell (effects, "%s", size);
  }
  g_string_append_c (text, '\n');
  if (effects->len > 3)
    write_table (text, effects, 3);
  else
    g_string_append (text, "No effect was accepted on any take.\n");
  return g_string_free (g_steal_pointer (&text), FALSE);
}

/* @survey: (nullable) (transfer full): a survey
 */
void
cloth_survey_free (ClothSurvey * survey)
{
  if (!survey)
    return;
  g_ptr_array_unref (survey->takes);
  g_free (survey->program);
  g_free (survey);
}
