/* gst-cloth-fit-1.0 track: follows points of a printed cloth through films of several cameras.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @rig: path of rig.json
 * @tracker: name of a tracker
 * @size: "63cm,67cm"
 * @near: (nullable): "x,y", m
 * @grid: (nullable): "33,35", columns and rows of vertices: a take is written, too
 * @held: (nullable): "0,32", vertices that hands hold
 * @output: folder
 * @backgrounds: (nullable): a picture for each film
 * @films: one for each camera of the rig, in its order
 * @ground: z of the cloth's surface, m
 * @anneal: the pose by annealing
 * @seed: of that
 * @threads: 0: all
 */
typedef struct {
  const gchar *rig, *output;
  gchar *tracker, *size, *near, *grid, *held;
  gchar **backgrounds, **films;
  gdouble ground;
  gboolean anneal;
  gint seed, threads;
} FitTrack;

gint fit_track (const FitTrack * arguments);

G_END_DECLS
