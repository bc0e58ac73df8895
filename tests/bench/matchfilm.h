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
 * @vertices: (array): xyz, camera frame, z away from the camera; frame by frame
 * @cloth_m: width and height
 */
typedef struct
{
  MatchPictures reference, film;
  guint n_frames;
  gdouble focal, centre[2];
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
void match_film_load (MatchFilm * film, const gchar * folder);
void match_film_clear (MatchFilm * film);
void match_truth_init (MatchTruth * truth, gint width, gint height);
void match_truth_clear (MatchTruth * truth);
void match_film_look (const MatchFilm * film, guint frame, MatchTruth * truth);
gboolean match_truth_get_uv (const MatchTruth * truth, gdouble x, gdouble y,
    gdouble uv[2]);

G_END_DECLS
