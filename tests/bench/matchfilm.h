/* A rendered film of a printed cloth with the truth of every pixel, from a folder.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/cv.h"
#include "gst/vision/match/stretch.h"

G_BEGIN_DECLS

/* A grey picture or several of one size, without padding. */
typedef struct
{
  gint width, height;
  GByteArray *pixels;
} MatchPictures;

/* @reference: the flat print
 * @film: of the camera cam0
 * @sides: of cam1 to its right and cam2 to its left, as loaded on demand
 * @background: of cam0: the scene without the cloth, as loaded on demand
 * @baseline: from cam0 to either side, m
 * @vertices: (array): xyz, camera frame, z away from the camera; frame by frame
 * @cloth_m: width and height
 */
typedef struct
{
  MatchPictures reference, film, sides[2], background;
  guint n_frames;
  gdouble focal, centre[2], baseline;
  gfloat *vertices;
  gdouble cloth_m[2];
} MatchFilm;

/* What is true of one frame: points of the surface, and u, v and side of each pixel. */
typedef struct
{
  gint width, height;
  gfloat *points, *uv;
  guint8 *mask, *back;
} MatchTruth;

void match_pictures_load (const gchar * folder, const gchar * name,
    MatchPictures * to);
void match_film_load (MatchFilm * film, const gchar * folder,
    const gchar * still, gboolean sides);
void match_film_clear (MatchFilm * film);
void match_truth_init (MatchTruth * truth, gint width, gint height);
void match_truth_clear (MatchTruth * truth);
void match_film_look (const MatchFilm * film, guint frame, MatchTruth * truth);
void match_film_place (const MatchFilm * film, guint frame,
    const gdouble uv[2], gdouble at[2]);
gboolean match_truth_get_uv (const MatchTruth * truth, gdouble x, gdouble y,
    gdouble uv[2]);

G_END_DECLS
