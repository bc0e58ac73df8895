/* Recordings that simulations made in place of the cloth: what a fit or a diagnosis makes of them is known
 * beforehand.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/imitation.h"

#include <string.h>

#include "gst/fit/recording/interpolation.h"
#include "gst/fit/recording/noise.h"
#include "gst/fit/recording/signal.h"
#include "gst/fit/recording/start.h"

/* @recording: a recording; must outlive its imitations
 * @n: how many
 *
 * Returns: (transfer full): recordings of the same scene, times, noise and gaps, whose cloth is nowhere yet
 */
ClothImitations *
cloth_imitations_new (const ClothRecording * recording, guint n)
{
  const gsize all = 3 * (gsize) recording->n * recording->n_frames;
  ClothImitations *imitations = g_new (ClothImitations, 1);

  *imitations = (ClothImitations) {
  recording, g_new (ClothRecording *, n), n};
  for (guint i = 0; i < n; i++) {
    ClothRecording *r = imitations->list[i] =
        g_memdup2 (recording, sizeof *recording);

    r->y = g_new0 (gdouble, all);
    r->velocity = g_new0 (gdouble, all);
    r->targets = NULL;
    r->start = NULL;
  }
  return imitations;
}

/* @imitations: #ClothImitations
 * @model: which of them
 * @frame: which frame
 * @positions: where a simulation that began where the recording did has the vertices, [n][3], m
 *
 * Keeps a frame, as simulations report it.
 */
void
cloth_imitations_keep (gpointer imitations, guint model, guint frame,
    const gdouble * positions)
{
  const ClothImitations *all = imitations;
  const gsize row = 3 * (gsize) all->of->n;

  memcpy (all->list[model]->y + frame * row, positions, row * sizeof (gdouble));
}

/* @imitations: (inout): imitations with all their frames
 * @sound: (array length=n): which of the simulations did not diverge; in place of others the recording stands
 * @noise: which share of the recording's noise they get
 * @seed: of that
 *
 * Makes simulations look recorded: noise, and what was not seen stays hidden. Where the first frame of the
 * recording could not be freed of its noise the simulations have it already.
 */
void
cloth_imitations_spoil (ClothImitations * imitations, const gboolean * sound,
    gdouble noise, guint64 seed)
{
  const gsize places = (gsize) imitations->of->n * imitations->of->n_frames;

  for (guint i = 0; i < imitations->n; i++) {
    ClothRecording *r = imitations->list[i];
    ClothRandom random;
    gboolean is_smooth;

    if (!sound[i]) {
      memcpy (r->y, imitations->of->y, 3 * places * sizeof (gdouble));
      continue;
    }
    is_smooth = cloth_recording_find_start (imitations->of, r->y, NULL);
    cloth_random_init (&random, seed + i);
    for (gsize at = is_smooth ? 0 : r->n; at < places; at++)
      cloth_recording_add_noise (r, at, noise, &random, r->y + 3 * at);
    cloth_recording_interpolate (r);
    cloth_recording_differentiate (r);
  }
}

/* @imitations: (nullable) (transfer full): imitations
 */
void
cloth_imitations_free (ClothImitations * imitations)
{
  if (!imitations)
    return;
  for (guint i = 0; i < imitations->n; i++) {
    g_free (imitations->list[i]->y);
    g_free (imitations->list[i]->velocity);
    g_free (imitations->list[i]->targets);
    g_free (imitations->list[i]);
  }
  g_free (imitations->list);
  g_free (imitations);
}
