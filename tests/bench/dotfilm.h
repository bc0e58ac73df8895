/* Films of a cloth with 3,500 dots for benchmarks, drawn as eight cameras see it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/video/video.h>

G_BEGIN_DECLS

#define DOT_FILM_CAMERAS 8
/* Pictures of each camera. */
#define DOT_FILM_LENGTH 6

/* A sheet that all cameras see whole, or a skirt that they stand around. */
typedef enum {
  DOT_FILM_SHEET,
  DOT_FILM_SKIRT
} DotFilmCloth;

/* Writes pattern.json and rig.json (cameras cam0 to cam7) into @folder; the pictures are
 * I420, 1004×1004. FALSE with an error when a file can't be written. */
gboolean dot_film_draw (DotFilmCloth cloth, const gchar * folder,
    GstSample * pictures[DOT_FILM_CAMERAS][DOT_FILM_LENGTH], GError ** error);

G_END_DECLS
