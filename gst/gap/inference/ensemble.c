/* Simulators that the recording might have come from if nothing acted that the model lacks.
 *
 * Model: a real cloth differs from the simulated one as simulators differ from each other. A member
 *   has one of the two force models; the mesh as it is with explicit steps, with half of them, or
 *   with implicit ones, or a mesh twice as fine, with other diagonals if it has many vertices, with
 *   implicit steps; and free numbers
 *   θ exp (0.3 N(0, 1)) (of those that may be negative: θ + a quarter of a prior), and a little of
 *   some laws that the model has not: 0.2 N(0, 1) priors.
 * Formula: a member moves freely in the recorded scene from the recorded start; with the
 *   recording's noise, of a twin with a twin's, and its gaps it is a recording y'. The model is drawn to y' as it is to the
 *   recording. The features of (simulated − y') are what the residual would be if nothing acted.
 * Reference: Kennedy and O'Hagan 2001 (discrepancy); the members stand for its Gaussian process.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/ensemble.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/recording.h"
#include "gst/math/random.h"

/* Standard deviation of a free number's logarithm, and of others in priors. */
#define LOG_SPREAD 0.3
#define SPREAD 0.25
/* That of a law that the model has not, in priors. */
#define LAW_SPREAD 0.2
/* Time step of implicit members, s. */
#define IMPLICIT_STEP_S 2e-3
/* A mesh twice as fine as one of more vertices takes longer than all other members together. */
#define MANY_VERTICES 400
static const gdouble other_diagonals = 1.;

/* How a member computes. */
typedef struct
{
  const gchar *effect;          /* of numerics, or NULL */
  gdouble factor;
  ClothIntegrator integrator;
} Way;

static const Way ways[] = {
  {NULL, 1., CLOTH_INTEGRATOR_EXPLICIT},
  {"time_step", 0.5, CLOTH_INTEGRATOR_EXPLICIT},
  {NULL, 1., CLOTH_INTEGRATOR_IMPLICIT},
  {"mesh_resolution", 2., CLOTH_INTEGRATOR_IMPLICIT},
};

#define N_WAYS G_N_ELEMENTS (ways)

/* Laws of cloth that are in any, each simulator has a little otherwise, and no model knows. */
static const gchar *const laws[] = {
  "hysteresis", "bending_softening", "biphasic_stretch", "bending_anisotropy",
  "stretch_anisotropy"
};

/* A little of a law, unless the model has it. */
static void
draw_law (ClothModel * model, const ClothEffect * effect, ClothRandom * random)
{
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];

  for (guint k = 0; k < effect->n_parameters; k++) {
    const ClothEffectParameter *p = &effect->parameters[k];
    gdouble off = LAW_SPREAD * p->prior * cloth_random_gaussian (random);

    if (p->shapes)
      off = 0.;
    values[k] = CLAMP (p->null_value + (p->one_sided ? fabs (off) : off),
        p->min, p->max);
    if (p->shapes && p->n_tried)
      values[k] = p->tried[0];
  }
  for (guint i = 0; i < model->effects->len; i++)
    if (g_array_index (model->effects, ClothModelEffect, i).effect == effect)
      return;
  cloth_model_set_effect (model, effect, values);
}

/* The model with free numbers and other laws drawn by chance. */
static ClothModel *
draw_numbers (const ClothModel * model, const ClothCandidates * candidates,
    ClothRandom * random)
{
  const guint n = candidates->n_free;
  g_autofree guint *directions = g_new (guint, n + 1);
  g_autofree gdouble *changes = g_new (gdouble, n + 1);
  ClothModel *drawn;

  for (guint i = 0; i < n; i++) {
    const ClothDirection *d = cloth_candidates_direction (candidates, i);

    directions[i] = i;
    changes[i] = (d->logarithmic ? LOG_SPREAD : SPREAD * d->prior) *
        cloth_random_gaussian (random);
  }
  drawn = cloth_candidates_move (candidates, model, directions, changes, n);
  for (guint i = 0; i < G_N_ELEMENTS (laws); i++)
    draw_law (drawn, cloth_effect_find (laws[i]), random);
  return drawn;
}

/* @model: the model that is looked at
 * @topology: of the cloth
 * @candidates: its free numbers
 * @seed: of the draws
 *
 * Returns: (transfer full): the members; those that agree in how they compute are next to each
 *   other
 */
ClothEnsemble *
cloth_ensemble_new (const ClothModel * model,
    const ClothTopology * topology, const ClothCandidates * candidates,
    guint64 seed)
{
  ClothEnsemble *e = g_new0 (ClothEnsemble, 1);
  ClothModel *drawn[2 * CLOTH_ENSEMBLE_DRAWS];
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint i = 0; i < G_N_ELEMENTS (drawn); i++)
    drawn[i] = draw_numbers (model, candidates, &random);
  e->models = g_new (ClothModel *, N_WAYS * G_N_ELEMENTS (drawn));
  e->families = g_new (guint, N_WAYS * G_N_ELEMENTS (drawn));
  for (guint family = 0; family < 2; family++)
    for (guint way = 0; way < N_WAYS; way++)
      for (guint draw = 0; draw < CLOTH_ENSEMBLE_DRAWS; draw++) {
        ClothModel *m =
            cloth_model_copy (drawn[family * CLOTH_ENSEMBLE_DRAWS + draw]);

        if (family)
          m->force_model = m->force_model == CLOTH_FORCE_MEMBRANE ?
              CLOTH_FORCE_MASS_SPRING : CLOTH_FORCE_MEMBRANE;
        m->integrator = ways[way].integrator;
        m->time_step = m->integrator == CLOTH_INTEGRATOR_IMPLICIT ?
            IMPLICIT_STEP_S : 0.;
        if (ways[way].effect) {
          const gboolean coarse = ways[way].factor > 1.
              && topology->n_vertices > MANY_VERTICES;

          cloth_model_set_effect (m, cloth_effect_find (coarse ?
                  "mesh_diagonals" : ways[way].effect),
              coarse ? &other_diagonals : &ways[way].factor);
        }
        e->families[e->n] = family;
        e->models[e->n++] = m;
      }
  for (guint i = 0; i < G_N_ELEMENTS (drawn); i++)
    cloth_model_free (drawn[i]);
  return e;
}

/* @ensemble: an ensemble
 * @member: one of its members
 * @kin: how another one is to be related to it
 *
 * Returns: that other one; each is one's only
 */
guint
cloth_ensemble_find_kin (const ClothEnsemble * ensemble, guint member,
    ClothEnsembleKin kin)
{
  guint draw = member % CLOTH_ENSEMBLE_DRAWS;
  guint way = member / CLOTH_ENSEMBLE_DRAWS % N_WAYS;
  guint family = member / (CLOTH_ENSEMBLE_DRAWS * N_WAYS);

  if (kin & CLOTH_KIN_OTHER_CLOTH)
    draw = (draw + 1) % CLOTH_ENSEMBLE_DRAWS;
  if (kin & CLOTH_KIN_OTHER_NUMERICS)
    way = (way + 1) % N_WAYS;
  if (kin & CLOTH_KIN_OTHER_FORCES)
    family = !family;
  return (family * N_WAYS + way) * CLOTH_ENSEMBLE_DRAWS + draw;
}

/* @ensemble: (nullable) (transfer full): an ensemble
 */
void
cloth_ensemble_free (ClothEnsemble * ensemble)
{
  if (!ensemble)
    return;
  for (guint i = 0; i < ensemble->n; i++)
    cloth_model_free (ensemble->models[i]);
  g_free (ensemble->models);
  g_free (ensemble->families);
  g_free (ensemble);
}

/* What members make of the scene, and the model drawn to it. */
typedef struct
{
  const ClothFeatures *features;
  const ClothImitations *made;
  gdouble *z;
} Made;

static void
collect (gpointer data, guint model, guint frame, const gdouble * positions)
{
  const Made *m = data;

  cloth_features_add (m->features, m->made->list[model], frame, positions,
      m->z + model * m->features->size);
}

/* @ensemble: an ensemble
 * @study: of the recording whose scene, noise and gaps the members get
 * @model: what follows them
 * @noise: what the members have of the recording's noise: 1, or less for what a simulator wrote
 * @stream: of random numbers: recordings of different streams have independent noise
 * @options: how to simulate
 * @z: (inout) (array): features of each member's residual, [n][size]; start with zeros
 * @sound: (out) (array length=n): which members did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * Returns: whether that could be done
 */
gboolean
cloth_ensemble_run (const ClothEnsemble * ensemble,
    const ClothSensitivities * study, const ClothModel * model,
    gdouble noise, guint stream, ClothEstimateOptions * options, gdouble * z,
    gboolean * sound, GError ** error)
{
  const ClothEnsemble *e = ensemble;
  const ClothRecording *r = study->recording;
  g_autoptr (ClothImitations) made = cloth_imitations_new (r, e->n);
  Made m = { study->features, made, z };
  g_autofree const ClothModel **models = g_new (const ClothModel *, e->n);
  g_autofree gdouble *gains = g_new (gdouble, e->n);
  g_autofree gboolean *followed = g_new (gboolean, e->n);
  /* a member that diverges is no failure of the model's */
  ClothRolloutOptions quiet = options->rollout;

  quiet.failed = NULL;
  for (guint i = 0; i < e->n; i++) {
    models[i] = model;
    gains[i] = options->gain;
  }
  options->simulations += 2 * e->n;
  if (!cloth_rollout_free (r, (const ClothModel * const *) e->models, e->n,
          &quiet, cloth_imitations_keep, made, sound, error))
    return FALSE;
  cloth_imitations_spoil (made, sound, noise, options->rollout.seed +
      stream * e->n + 1);
  if (!cloth_rollout_nudged ((const ClothRecording * const *) made->list,
          models, gains, e->n, &quiet, collect, &m, followed, error))
    return FALSE;
  for (guint i = 0; i < e->n; i++)
    sound[i] = sound[i] && followed[i];
  return TRUE;
}
