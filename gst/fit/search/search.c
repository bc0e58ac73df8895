/* Asynchronous parallel pattern search.
 *
 * Model: f has values only, each dear, some of them none (a simulation that blew up).
 * Formula: around the best point x, each of the 2n directions ±eᵢ has a step Δ of its own, and at
 *   most one trial, x ± Δ sᵢ eᵢ (s: scale), cut at the bounds. There is no barrier; a trial whose
 *   value comes
 *     f (y) < f (x) − α Δ²: becomes x, from which ever x it was tried; all steps become
 *       max (Δ of y, least step), and trials that are out stay out, but nothing waits for them;
 *     else, if it was tried from x: its direction's Δ shrinks by θ.
 *   A direction with Δ < tolerance has ended; when all have, so has the search.
 *   Points that are asked for again are not evaluated again: a direction whose point is known is
 *   decided at once, one whose point is out waits for it with the others.
 * Which trials are made follows from the options and from the order of the decisions, and from
 *   nothing else: there are always `in_flight` trials out, whoever evaluates them. In order, a
 *   value waits for those before it, and any number of workers makes the same search. As they
 *   come, the log is what makes it again.
 * Reference: Hough, Kolda and Torczon, “Asynchronous parallel pattern search for nonlinear
 *   optimization”, SIAM J. Sci. Comput. 23, 2001; Kolda, “Revisiting asynchronous parallel pattern
 *   search for nonlinear optimization”, SIAM J. Optim. 16, 2005: steps per direction, decrease of
 *   αΔ²; Gray and Kolda, “Algorithm 856: APPSPACK 4.0”, ACM TOMS 32, 2006: cache, bounds, defaults.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/search/search.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"

#define NO_TRIAL G_MAXUINT

typedef enum
{ OUT, TOLD, DECIDED } TrialState;

typedef struct
{
  gdouble value;                /* +∞ when there is none */
  gdouble step;
  guint direction;
  TrialState state;
} Trial;

struct _ClothSearch
{
  ClothSearchOptions options;   /* its arrays are these: */
  gdouble *start, *low, *high, *scale;
  GArray *trials;               /* Trial, by id */
  GArray *points;               /* n numbers of each */
  gdouble *x, *point;           /* the best point, and room for one */
  gdouble value;                /* there; +∞: not known yet */
  gdouble *steps;               /* of each direction */
  guint *waits;                 /* the trial that each direction waits for */
  guint direction;              /* that is tried next */
  guint lowest;                 /* trial with the least value */
  guint first_out;              /* no trial before is out */
  guint n_given;                /* trials that were asked for by cloth_search_next () */
  ClothSearchCounts counts;
  ClothSearchState state;
  GString *log;
};

/* @options: (out): what the paper takes where it says so
 *
 * All but the unknowns themselves.
 */
void
cloth_search_options_init (ClothSearchOptions * options)
{
  memset (options, 0, sizeof *options);
  options->first_step = 1.;
  options->tolerance = 0.01;
  options->least_step = 0.02;
  options->contraction = 0.5;
  options->decrease = 0.01;
  options->same = 0.005;
  options->most_evaluations = 10000;
}

static Trial *
get_trial (const ClothSearch * s, guint id)
{
  return &g_array_index (s->trials, Trial, id);
}

static const gdouble *
get_point (const ClothSearch * s, guint id)
{
  return (const gdouble *) s->points->data + (gsize) id *s->options.n;
}

/* ---- trials ---- */

static guint
count_out (const ClothSearch * s)
{
  return s->trials->len - s->counts.n_decided;
}

static void
add_trial (ClothSearch * s, const gdouble * point, gdouble step,
    guint direction)
{
  const Trial trial = { INFINITY, step, direction, OUT };

  g_array_append_val (s->trials, trial);
  g_array_append_vals (s->points, point, s->options.n);
}

static gboolean
is_same (const ClothSearch * s, const gdouble * a, const gdouble * b)
{
  for (guint k = 0; k < s->options.n; k++)
    if (fabs (a[k] - b[k]) > s->options.same * s->scale[k])
      return FALSE;
  return TRUE;
}

/* The latest trial at a point: the near ones were made not long ago. */
static guint
find_trial (const ClothSearch * s, const gdouble * point)
{
  for (guint id = s->trials->len; id-- > 0;)
    if (is_same (s, get_point (s, id), point))
      return id;
  return NO_TRIAL;
}

/* Whether there is a point that way, cut at the bounds, that is not the best one again. */
static gboolean
find_point (const ClothSearch * s, guint direction, gdouble * point)
{
  const guint k = direction / 2;
  const gdouble step = s->steps[direction] * s->scale[k];

  memcpy (point, s->x, s->options.n * sizeof *point);
  point[k] = CLAMP (point[k] + (direction % 2 ? -step : step), s->low[k],
      s->high[k]);
  return !is_same (s, point, s->x);
}

/* ---- decisions ---- */

static gboolean
is_better (const ClothSearch * s, gdouble value, gdouble step)
{
  return isfinite (value) && (!isfinite (s->value) ||
      value < s->value - s->options.decrease * step * step);
}

static void
move_to (ClothSearch * s, guint id, gdouble step, guint direction)
{
  memcpy (s->x, get_point (s, id), s->options.n * sizeof *s->x);
  s->value = get_trial (s, id)->value;
  for (guint i = 0; i < 2 * s->options.n; i++) {
    s->steps[i] = MAX (step, s->options.least_step);
    s->waits[i] = NO_TRIAL;
  }
  s->direction = direction;     /* what helped may help again */
  s->counts.n_moves++;
}

static void
contract (ClothSearch * s, guint direction)
{
  s->waits[direction] = NO_TRIAL;
  s->steps[direction] *= s->options.contraction;
}

/* The next direction that waits for nothing and has not ended; or NO_TRIAL. */
static guint
choose_direction (const ClothSearch * s)
{
  const guint n = 2 * s->options.n;

  for (guint i = 0; i < n; i++) {
    const guint direction = (s->direction + i) % n;

    if (s->waits[direction] == NO_TRIAL &&
        s->steps[direction] >= s->options.tolerance)
      return direction;
  }
  return NO_TRIAL;
}

static void
try_direction (ClothSearch * s, guint direction)
{
  guint id;

  s->direction = (direction + 1) % (2 * s->options.n);
  if (!find_point (s, direction, s->point)) {
    s->steps[direction] = 0.;
    return;
  }
  id = find_trial (s, s->point);
  if (id == NO_TRIAL) {
    s->waits[direction] = s->trials->len;
    add_trial (s, s->point, s->steps[direction], direction);
    return;
  }
  s->counts.n_reused++;
  if (get_trial (s, id)->state != DECIDED)
    s->waits[direction] = id;
  /* with a shorter step less is enough */
  else if (is_better (s, get_trial (s, id)->value, s->steps[direction]))
    move_to (s, id, s->steps[direction], direction);
  else
    contract (s, direction);
}

static gboolean
has_ended (const ClothSearch * s)
{
  /* the start itself may be slow */
  if (get_trial (s, 0)->state != DECIDED)
    return FALSE;
  for (guint i = 0; i < 2 * s->options.n; i++)
    if (s->steps[i] >= s->options.tolerance)
      return FALSE;
  return TRUE;
}

static void
fill (ClothSearch * s)
{
  guint direction;

  while (count_out (s) < s->options.in_flight &&
      s->trials->len < s->options.most_evaluations &&
      (direction = choose_direction (s)) != NO_TRIAL)
    try_direction (s, direction);
  if (has_ended (s))
    s->state = isfinite (s->value) ? CLOTH_SEARCH_CONVERGED :
        CLOTH_SEARCH_NOWHERE;
  else if (s->trials->len >= s->options.most_evaluations && !count_out (s))
    s->state = CLOTH_SEARCH_LIMIT;
}

static void
log_decision (ClothSearch * s, guint id)
{
  gchar text[G_ASCII_DTOSTR_BUF_SIZE];

  g_string_append_printf (s->log, "%u %s", id, g_ascii_dtostr (text,
          sizeof text, get_trial (s, id)->value));
  for (guint k = 0; k < s->options.n; k++)
    g_string_append_printf (s->log, " %s", g_ascii_dtostr (text, sizeof text,
            get_point (s, id)[k]));
  g_string_append_c (s->log, '\n');
}

static void
decide (ClothSearch * s, guint id)
{
  Trial *trial = get_trial (s, id);

  trial->state = DECIDED;
  s->counts.n_decided++;
  while (s->first_out < s->trials->len &&
      get_trial (s, s->first_out)->state == DECIDED)
    s->first_out++;
  log_decision (s, id);
  if (!isfinite (trial->value))
    s->counts.n_failed++;
  else if (s->lowest == NO_TRIAL ||
      trial->value < get_trial (s, s->lowest)->value)
    s->lowest = id;
  if (is_better (s, trial->value, trial->step))
    move_to (s, id, trial->step, trial->direction);
  for (guint i = 0; i < 2 * s->options.n; i++)
    if (s->waits[i] == id)
      contract (s, i);
  fill (s);
}

/* ---- the search ---- */

static gboolean
refuse (GError ** error, const gchar * text)
{
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_SEARCH,
      "pattern search: %s", text);
  return FALSE;
}

static gboolean
check_unknowns (const ClothSearchOptions * o, GError ** error)
{
  for (guint k = 0; k < o->n; k++) {
    const gdouble low = o->low ? o->low[k] : -INFINITY;
    const gdouble high = o->high ? o->high[k] : INFINITY;

    if (!isfinite (o->start[k]) || !(low <= o->start[k])
        || !(o->start[k] <= high))
      return refuse (error, "the start must be finite and within the bounds");
    if (o->scale && !(isfinite (o->scale[k]) && o->scale[k] > 0.))
      return refuse (error, "each scale must be a number above 0");
  }
  return TRUE;
}

static gboolean
check (const ClothSearchOptions * o, GError ** error)
{
  if (o->n < 1 || o->n > CLOTH_SEARCH_MAX_N)
    return refuse (error, "give 1 to 1000 unknowns");
  if (!(o->tolerance > 0.) || !(o->first_step >= o->tolerance) ||
      !(o->least_step >= o->tolerance) || !isfinite (o->first_step) ||
      !isfinite (o->least_step))
    return refuse (error, "the tolerance must be above 0 and the steps no "
        "shorter than it");
  if (!(o->contraction > 0. && o->contraction < 1.))
    return refuse (error, "the contraction must be between 0 and 1");
  if (!(o->decrease >= 0.) || !isfinite (o->decrease))
    return refuse (error, "the decrease must be 0 or above");
  if (!(o->same >= 0. && o->same < o->tolerance))
    return refuse (error, "points that are the same must be nearer than the "
        "tolerance");
  if (o->most_evaluations < 1
      || o->most_evaluations > CLOTH_SEARCH_MAX_EVALUATIONS)
    return refuse (error, "give 1 to 1000000 evaluations");
  return check_unknowns (o, error);
}

static void
copy_unknowns (ClothSearch * s, const ClothSearchOptions * o)
{
  s->start = g_new (gdouble, o->n);
  s->low = g_new (gdouble, o->n);
  s->high = g_new (gdouble, o->n);
  s->scale = g_new (gdouble, o->n);
  for (guint k = 0; k < o->n; k++) {
    s->start[k] = o->start[k];
    s->low[k] = o->low ? o->low[k] : -INFINITY;
    s->high[k] = o->high ? o->high[k] : INFINITY;
    s->scale[k] = o->scale ? o->scale[k] : s->high[k] - s->low[k];
    if (!isfinite (s->scale[k]) || s->scale[k] <= 0.)
      s->scale[k] = 1.;
  }
  s->options.start = s->start;
  s->options.low = s->low;
  s->options.high = s->high;
  s->options.scale = s->scale;
}

/* What must be equal for a log to make the same search. */
static void
begin_log (ClothSearch * s)
{
  const ClothSearchOptions *o = &s->options;
  const gdouble numbers[] = { o->first_step, o->tolerance, o->least_step,
    o->contraction, o->decrease, o->same
  };
  gchar text[G_ASCII_DTOSTR_BUF_SIZE];

  s->log = g_string_new (NULL);
  g_string_printf (s->log, "pattern-search 1 %s %u %u %u",
      o->as_they_come ? "as-they-come" : "in-order", o->n, o->in_flight,
      o->most_evaluations);
  for (guint i = 0; i < G_N_ELEMENTS (numbers); i++)
    g_string_append_printf (s->log, " %s", g_ascii_dtostr (text, sizeof text,
            numbers[i]));
  if (o->what)
    g_string_append_printf (s->log, " %s", o->what);
  g_string_append_c (s->log, '\n');
  /* the caller's */
  s->options.what = NULL;
}

/* @options: what is searched, copied
 * @error: %CLOTH_FIT_ERROR_SEARCH
 *
 * Returns: (transfer full) (nullable): a search that has trials to evaluate
 */
ClothSearch *
cloth_search_new (const ClothSearchOptions * options, GError ** error)
{
  const guint n = options->n;
  ClothSearch *s;

  if (!check (options, error))
    return NULL;
  s = g_new0 (ClothSearch, 1);
  s->options = *options;
  copy_unknowns (s, options);
  if (!options->in_flight)
    s->options.in_flight = 2 * n;
  s->trials = g_array_new (FALSE, FALSE, sizeof (Trial));
  s->points = g_array_new (FALSE, FALSE, sizeof (gdouble));
  s->x = g_memdup2 (s->start, n * sizeof *s->x);
  s->point = g_new (gdouble, n);
  s->value = INFINITY;
  s->steps = g_new (gdouble, 2 * n);
  s->waits = g_new (guint, 2 * n);
  s->lowest = NO_TRIAL;
  for (guint i = 0; i < 2 * n; i++) {
    s->steps[i] = options->first_step;
    s->waits[i] = NO_TRIAL;
  }
  begin_log (s);
  add_trial (s, s->start, options->first_step, 0);
  fill (s);
  return s;
}

/* @search: a search
 *
 * Returns: number of unknowns
 */
guint
cloth_search_get_n (const ClothSearch * search)
{
  return search->options.n;
}

/* @search: a search
 * @id: (out): of the trial
 * @point: (out) (array): where to evaluate, n numbers
 *
 * The next trial that nobody evaluates yet. Each is given once; after a replay, those
 * whose values the log does not have.
 *
 * Returns: whether there is one
 */
gboolean
cloth_search_next (ClothSearch * search, guint * id, gdouble * point)
{
  if (search->state != CLOTH_SEARCH_RUNS)
    return FALSE;
  while (search->n_given < search->trials->len &&
      get_trial (search, search->n_given)->state != OUT)
    search->n_given++;
  if (search->n_given == search->trials->len)
    return FALSE;
  *id = search->n_given++;
  memcpy (point, get_point (search, *id), search->options.n * sizeof *point);
  return TRUE;
}

/* @search: a search
 * @id: of a trial
 * @value: of the function there; what is not finite is no value
 *
 * A value that comes twice, late or of a trial that was never made changes nothing.
 *
 * Returns: whether it was waited for
 */
gboolean
cloth_search_tell (ClothSearch * search, guint id, gdouble value)
{
  Trial *trial;

  if (search->state != CLOTH_SEARCH_RUNS || id >= search->trials->len)
    return FALSE;
  trial = get_trial (search, id);
  if (trial->state != OUT)
    return FALSE;
  trial->value = isfinite (value) ? value : INFINITY;
  trial->state = TOLD;
  if (search->options.as_they_come) {
    decide (search, id);
    return TRUE;
  }
  while (search->state == CLOTH_SEARCH_RUNS &&
      search->first_out < search->trials->len &&
      get_trial (search, search->first_out)->state == TOLD)
    decide (search, search->first_out);
  return TRUE;
}

/* @search: a search
 *
 * Returns: whether it has ended, and why
 */
ClothSearchState
cloth_search_get_state (const ClothSearch * search)
{
  return search->state;
}

/* @search: a search
 *
 * Returns: whether it decides in the order in which values come
 */
gboolean
cloth_search_is_as_they_come (const ClothSearch * search)
{
  return search->options.as_they_come;
}

/* @search: a search
 *
 * Returns: what it has done
 */
ClothSearchCounts
cloth_search_get_counts (const ClothSearch * search)
{
  return search->counts;
}

/* @search: a search
 * @point: (out) (array): where, n numbers; the start as long as there is no value
 *
 * Returns: the least value that was decided on, the earliest trial's of equal ones; infinite as
 *   long as there is none
 */
gdouble
cloth_search_get_best (const ClothSearch * search, gdouble * point)
{
  const gboolean has = search->lowest != NO_TRIAL;

  memcpy (point, get_point (search, has ? search->lowest : 0),
      search->options.n * sizeof *point);
  return has ? get_trial (search, search->lowest)->value : INFINITY;
}

/* @search: a search
 *
 * Returns: (transfer none): a line of the options, then one of each decision: trial, value
 *   (`inf`: none), point. It makes the same search again, and its end is where a search that
 *   was cut off goes on
 */
const gchar *
cloth_search_get_log (const ClothSearch * search)
{
  return search->log->str;
}

static gboolean
replay_line (ClothSearch * s, const gchar * line)
{
  gchar *end;
  const guint64 id = g_ascii_strtoull (line, &end, 10);
  gdouble value;

  if (end == line || id >= s->trials->len || s->state != CLOTH_SEARCH_RUNS ||
      get_trial (s, (guint) id)->state != OUT ||
      (!s->options.as_they_come && id != s->first_out))
    return FALSE;
  value = g_ascii_strtod (end, &end);
  if (isnan (value))
    return FALSE;
  for (guint k = 0; k < s->options.n; k++) {
    if (*end != ' ' ||
        g_ascii_strtod (end, &end) != get_point (s, (guint) id)[k])
      return FALSE;
  }
  return !*end && cloth_search_tell (s, (guint) id, value);
}

/* @search: a search that is new, or was told nothing but what @log begins with
 * @log: what one of the same options has logged; what stands behind its last line end is not
 *   read, as its writer may have been killed
 * @error: %CLOTH_FIT_ERROR_SEARCH: it is the log of another search
 *
 * Decides as that one did. Its log is then the same bytes. After an error the search is of
 * no use.
 *
 * Returns: whether it could
 */
gboolean
cloth_search_replay (ClothSearch * search, const gchar * log, GError ** error)
{
  g_auto (GStrv) lines = g_strsplit (log, "\n", -1);
  const gsize n_lines = g_strv_length (lines);
  const gchar *own = search->log->str;
  const gsize begin = search->counts.n_decided + 1;

  if (n_lines < 2 || !g_str_has_prefix (log, "pattern-search "))
    return refuse (error, "this is no log of a search");
  if (!g_str_has_prefix (log, own)) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_SEARCH,
        "pattern search: the log is of a search with other options, or of "
        "something else: it begins “%s”, and this search's would “%.*s”",
        lines[0], (int) strcspn (own, "\n"), own);
    return FALSE;
  }
  for (gsize i = begin; i + 1 < n_lines; i++)
    if (!replay_line (search, lines[i])) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_SEARCH,
          "pattern search: line %" G_GSIZE_FORMAT " of the log is none that "
          "this search would write: it is of another start, other bounds or "
          "damaged", i + 1);
      return FALSE;
    }
  return TRUE;
}

/* @search: (nullable) (transfer full): a search
 */
void
cloth_search_free (ClothSearch * search)
{
  if (!search)
    return;
  g_array_unref (search->trials);
  g_array_unref (search->points);
  g_string_free (search->log, TRUE);
  g_free (search->start);
  g_free (search->low);
  g_free (search->high);
  g_free (search->scale);
  g_free (search->x);
  g_free (search->point);
  g_free (search->steps);
  g_free (search->waits);
  g_free (search);
}
