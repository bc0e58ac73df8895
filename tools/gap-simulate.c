/* gst-cloth-gap-1.0 simulate: simulates the cloth of a take.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-tool.h"

#include <gio/gio.h>
#include <stdlib.h>
#include <string.h>

#include "gst/sim/sim.h"

static gboolean
write_frames (ClothSim * sim, const ClothScene * scene,
    ClothTakeWriter * writer, GError ** error)
{
  gsize n = scene->topology->n_vertices, n_held = scene->held->len;
  g_autofree gdouble *positions = g_new (gdouble, 3 * n);
  g_autofree gfloat *places = g_new (gfloat, 3 * n);
  g_autofree gfloat *clamps = g_new (gfloat, 3 * n_held + 1);
  g_autofree guint8 *states = g_malloc (n);

  memset (states, CLOTH_VERTEX_PREDICTED, n);
  for (guint frame = 0; frame < scene->n_frames; frame++) {
    gdouble since_s;

    if (was_interrupted ()) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
          "stopped; nothing was written");
      return FALSE;
    }
    cloth_sim_advance (sim, scene->times[frame]);
    if (cloth_sim_get_state (sim, 0, &since_s) != CLOTH_SIM_OK) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "the simulation blew up at %.3f s: set “time_step” below %g s or to "
          "0, or lower the stiffnesses and damping.stiffness", since_s,
          cloth_sim_get_time_step (sim));
      return FALSE;
    }
    cloth_sim_get_positions (sim, 0, positions);
    for (gsize i = 0; i < 3 * n; i++)
      places[i] = (gfloat) positions[i];
    for (gsize i = 0; i < 3 * n_held; i++)
      clamps[i] = (gfloat) scene->clamps[3 * n_held * frame + i];
    if (!cloth_take_writer_append (writer, scene->times[frame], places, states,
            NULL, n_held > 0 ? clamps : NULL, error))
      return FALSE;
    tell_progress ((frame + 1.) / scene->n_frames, NULL);
  }
  return TRUE;
}

static gboolean
run_simulation (const Arguments * arguments, GError ** error)
{
  const ClothSimOptions options = { FALSE, (guint) arguments->threads,
    CLOTH_SIMD_BEST, (guint64) arguments->seed
  };
  g_autoptr (ClothModel) model = cloth_model_load (arguments->rest[1], error);
  g_autoptr (ClothTake) take = model ?
      cloth_take_open (arguments->scene, error) : NULL;
  g_autoptr (ClothScene) scene = NULL;
  g_autoptr (ClothSim) sim = NULL;
  g_autoptr (ClothTakeInfo) info = NULL;
  g_autoptr (ClothTakeWriter) writer = NULL;
  const ClothModel *models[1] = { model };

  if (!take)
    return FALSE;
  scene = cloth_scene_new_from_take (take, error);
  sim = scene && cloth_scene_check_paths (scene, error) ?
      cloth_sim_new (scene, models, 1, &options, error) : NULL;
  if (!sim) {
    g_prefix_error (error, "%s: ", arguments->scene);
    return FALSE;
  }
  info = cloth_take_info_copy (cloth_take_get_info (take));
  info->noise_sigma_m = 0;
  g_free (info->notes);
  info->notes = g_strdup ("simulated by " PROGRAM);
  writer = cloth_take_writer_new (arguments->output, info, scene->topology,
      error);
  return writer && write_frames (sim, scene, writer, error) &&
      cloth_take_writer_close (writer, error);
}

/* However they are spelt. */
static gboolean
is_same_folder (const gchar * a, const gchar * b)
{
  gchar *path = realpath (a, NULL), *other = realpath (b, NULL);
  gboolean same = path && other && !strcmp (path, other);

  free (path);
  free (other);
  return same;
}

gint
simulate (const Arguments * arguments)
{
  g_autoptr (GError) error = NULL;

  if (arguments->format)
    return complain (BAD_USAGE, "simulate takes no --format");
  if (g_strv_length (arguments->rest) != 2)
    return complain (BAD_USAGE, "simulate needs one model.json");
  if (!arguments->scene)
    return complain (BAD_USAGE,
        "name the take that gives mesh, clamps and times: --scene TAKE");
  if (!arguments->output)
    return complain (BAD_USAGE, "name the take to write: --output TAKE");
  if (arguments->threads < 0)
    return complain (BAD_USAGE, "--threads: give 0 for all, or a number");
  if (is_same_folder (arguments->scene, arguments->output))
    return complain (BAD_USAGE, "--output is the scene itself; name another");
  catch_interrupts ();
  if (run_simulation (arguments, &error))
    return DONE;
  return complain (FAILED, "%s", error->message);
}
