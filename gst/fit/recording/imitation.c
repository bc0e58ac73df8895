/* Recordings that a simulation made in place of the cloth: what a fit or a diagnosis makes of them is known
 * beforehand.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/imitation.h"

#include "gst/fit/recording/interpolation.h"
#include "gst/fit/recording/noise.h"
#include "gst/fit/recording/signal.h"
#include "gst/fit/recording/start.h"

/* @recording: a recording; must outlive its imitation
 *
 * Returns: (transfer full): one of the same scene, times, noise and gaps, whose cloth is nowhere yet: @y is to
 *   be filled
 */
ClothRecording *
cloth_imitation_new (const ClothRecording * recording)
{
  const gsize all = 3 * (gsize) recording->n * recording->n_frames;
  ClothRecording *imitation = g_memdup2 (recording, sizeof *recording);

  imitation->y = g_new0 (gdouble, all);
  imitation->velocity = g_new0 (gdouble, all);
  imitation->targets = NULL;
  return imitation;
}

/* @imitation: (inout): an imitation whose @y a simulation has filled that began where the recording did
 * @recording: what it imitates
 * @noise: which share of the recording's noise it gets
 * @seed: of that
 *
 * Makes a simulation look recorded: noise, and what was not seen stays hidden. Where the first frame of the
 * recording could not be freed of its noise the simulation has it already.
 */
void
cloth_imitation_spoil (ClothRecording * imitation,
    const ClothRecording * recording, gdouble noise, guint64 seed)
{
  ClothRecording *r = imitation;
  const gboolean is_smooth = cloth_recording_find_start (recording, r->y, NULL);
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gsize i = is_smooth ? 0 : r->n; i < (gsize) r->n * r->n_frames; i++)
    cloth_recording_add_noise (r, i, noise, &random, r->y + 3 * i);
  cloth_recording_interpolate (r);
  cloth_recording_differentiate (r);
}

/* @imitation: (nullable) (transfer full): an imitation
 */
void
cloth_imitation_free (ClothRecording * imitation)
{
  if (!imitation)
    return;
  g_free (imitation->y);
  g_free (imitation->velocity);
  g_free (imitation->targets);
  g_free (imitation);
}
