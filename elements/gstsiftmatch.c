/* siftmatch: which place of its print each feature of a cloth shows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:element-siftmatch
 * @title: siftmatch
 *
 * Finds the features of a cloth with any print, asks for each which place of the print it
 * shows, and from those that their neighbours bear out where the picture shows the vertices of
 * the pattern's grid. All of it goes along with the picture as #GstClothMatches; the picture
 * itself stays as it is and where it is. Only the luma is looked at.
 *
 * Looked at is what the silhouette on the picture says is cloth; without one what has
 * disparities, without them the whole picture. With disparities distances are measured along
 * the surface, else in the picture: folds then cost more of the matches.
 *
 * The print is looked at when the element starts, which takes seconds. Where most of it
 * repeats itself, nothing of the film is found in it, or the film has no features, a warning
 * says so.
 *
 * ## Matches over a film
 * |[
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! silhouette background=empty.png ! \
 *     siftmatch pattern=pattern.json ! clothoverlay ! videoconvert ! autovideosink
 * ]|
 */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstsiftmatch.h"

#include <gst/cloth/cloth.h>
#include <math.h>

#include "elements/gstclothpaint.h"
#include "elements/gstclothprint.h"
#include "elements/gstclothproperties.h"
#include "gst/pattern/picture.h"
#include "gst/vision/match/match.h"
#include "gst/vision/track/follow.h"

GST_DEBUG_CATEGORY_STATIC (sift_match_debug);
#define GST_CAT_DEFAULT sift_match_debug

G_STATIC_ASSERT (CLOTH_PICTURE_PATTERN_MAX <= CLOTH_GRID_MAX);
/* The metadata holds all points of a grid. */
G_STATIC_ASSERT (CLOTH_PICTURE_PATTERN_MAX_VERTICES <= GST_CLOTH_MAX_FEATURES);

/* Pictures until a print is said to be another one, and the features that such a picture must
 * have. */
#define PATIENCE 25
#define LEAST_FEATURES 50
/* Share of the features that is verified: of the print that is filmed 9% in the worst picture
 * of a falling cloth; over that film at most 0.6% of four other prints, and 1.4% of the print
 * itself where it is seen from behind and only known from the front. */
#define LEAST_SHARE 0.03

typedef struct
{
  gchar *pattern;
  guint threads, steady;
  gdouble contrast;             /* of the film; all else is as in the print */
  ClothReferenceParams reference;
  ClothGrowParams grow;
  ClothVerifyParams verify;
  ClothGridParams grid;
  gboolean follow;
  ClothFollowParams following;
} Settings;

struct _GstSiftMatch
{
  GstClothFilter parent;

  /* with the object lock */
  Settings settings;

  /* streaming thread */
  ClothPicturePattern *pattern;
  ClothPool *pool;
  const ClothReference *reference;
  ClothCvSift *sift;
  ClothGrower *grower;
  ClothVerifier *verifier;
  ClothGridder *gridder;
  ClothFollower *follower;
  ClothSteady *steady;          /* NULL: nothing is averaged */
  guint steady_most;
  GByteArray *mask;
  GArray *points;               /* gfloat: three a pixel */
  GArray *own_points;           /* gfloat: of disparities of another size */
  GArray *matches;              /* ClothMatch: one a feature */
  GArray *grid_matches;         /* ClothGridMatch: room for one a feature */
  GArray *vertices;             /* ClothGridVertex */
  GArray *to_matches;           /* GstClothMatch */
  GArray *to_points;            /* GstClothGridPoint */

  /* of the pictures since the last judgement */
  guint n_pictures;
  guint64 n_features, n_verified;
  gboolean fits;                /* the print has once been recognised */
  gboolean warned_of_print, warned_of_features, warned_of_lack;

  /* since the start */
  gboolean looked;              /* at a picture */
  guint richest;                /* most features of a picture */
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)
#define ANY_TIME (GST_PARAM_MUTABLE_PLAYING | GST_PARAM_CONTROLLABLE)
#define AT_START GST_PARAM_MUTABLE_READY

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"pattern", "Pattern", "File pattern.json of kind \"picture\": the print and its grid",
    G_TYPE_STRING, SETTING (pattern), AT_START},
  {"threads", "Threads", "Threads that match; 0: one a processor",
    G_TYPE_UINT, SETTING (threads), AT_START, 0, 1024},
  {"steady", "Steady",
    "Vertices that stand still are averaged over at most so many pictures, those that "
    "move are not; 0: none",
    G_TYPE_UINT, SETTING (steady), ANY_TIME, 0, CLOTH_STEADY_MAX},
  {"contrast", "Contrast",
    "Least contrast of the film's features, as a share of the full range over layers",
    G_TYPE_DOUBLE, SETTING (contrast), AT_START, 0, 1},
  {"reference-contrast", "Contrast of the print", "The same of the print's features",
    G_TYPE_DOUBLE, SETTING (reference.sift.contrast), AT_START, 0, 1},
  {"layers", "Layers", "In which features of an octave of scales are looked for",
    G_TYPE_INT, SETTING (reference.sift.n_layers), AT_START, 1, 8},
  {"edge", "Edge",
    "Greatest ratio of a feature's two curvatures: what has more is an edge",
    G_TYPE_DOUBLE, SETTING (reference.sift.edge), AT_START, 1, 1000},
  {"blur", "Blur", "Of the first layer, px",
    G_TYPE_DOUBLE, SETTING (reference.sift.sigma), AT_START, 0.6, 10},
  {"oblique", "Oblique views",
    "Whether the print is also known as it looks obliquely: 0: no, 1: squeezed to a "
    "half in four directions, 2: also to a quarter",
    G_TYPE_INT, SETTING (reference.oblique), AT_START, 0, 2},
  {"reference-scale", "Least scale of the print",
    "The print's features of smaller scale are left out, px of its picture: a film that is "
    "coarser doesn't show them",
    G_TYPE_DOUBLE, SETTING (reference.least_scale), AT_START, 0, 1000},
  {"reference-seed-scale", "Least scale of the print's seeds",
    "The print's features of smaller scale are not compared with seeds, px of its picture",
    G_TYPE_DOUBLE, SETTING (reference.seed_scale), AT_START, 0, 1000},
  {"noise", "Noise",
    "Of the film, grey levels: what noise can turn into another place of the print counts "
    "as repeated",
    G_TYPE_DOUBLE, SETTING (reference.noise), AT_START, 0, 64},
  {"radius", "Radius", "How far growth reaches at a time, r_c of the paper, px",
    G_TYPE_DOUBLE, SETTING (grow.radius), ANY_TIME, 1, 1000},
  {"distance", "Distance", "Greatest distance in feature space of a match that grows",
    G_TYPE_DOUBLE, SETTING (grow.distance), ANY_TIME, 0, 2000},
  {"seed-distance", "Distance of seeds", "The same of a seed",
    G_TYPE_DOUBLE, SETTING (grow.seed_distance), ANY_TIME, 0, 2000},
  {"first-group", "First group",
    "Seeds that are tried first; each group is twice as large as the one before",
    G_TYPE_UINT, SETTING (grow.first), ANY_TIME, 1, GST_CLOTH_MAX_FEATURES},
  {"seed-scale", "Least scale of seeds", "Features of smaller scale are no seeds, px",
    G_TYPE_DOUBLE, SETTING (grow.least_scale), ANY_TIME, 0, 1000},
  {"least", "Least", "A seed from which fewer matches grow is none itself",
    G_TYPE_UINT, SETTING (grow.least), ANY_TIME, 1, 1000},
  {"tries", "Tries", "Neighbours from which a feature is looked for",
    G_TYPE_UINT, SETTING (grow.tries), ANY_TIME, 1, 1000},
  {"turn", "Turn",
    "By how much neighbours may be turned against each other in the picture, radians; π "
    "and more: not looked at",
    G_TYPE_DOUBLE, SETTING (grow.turn), ANY_TIME, 0, 4},
  {"zoom", "Zoom",
    "By which factor the scales of neighbours may differ, from 1 on; 0: not looked at",
    G_TYPE_DOUBLE, SETTING (grow.zoom), ANY_TIME, 0, 100},
  {"stretch", "Stretch",
    "By what share a distance may be longer or shorter than on the flat cloth, k_s of the "
    "paper",
    G_TYPE_DOUBLE, SETTING (grow.stretch.stretch), ANY_TIME, 0, 0.9},
  {"slack", "Slack", "Standard uncertainty of a distance in the picture, px",
    G_TYPE_DOUBLE, SETTING (grow.stretch.slack), ANY_TIME, 0, 100},
  {"depth-step", "Depth step",
    "With disparities: depths 2 px apart that differ by more are of two folds, m",
    G_TYPE_DOUBLE, SETTING (grow.stretch.depth_step), ANY_TIME, 0, 10},
  {"hidden", "Hidden", "Most cloth that a fold may hide between two features, m",
    G_TYPE_DOUBLE, SETTING (grow.stretch.hidden), ANY_TIME, 0, 100},
  {"metres-per-pixel", "Metres per pixel",
    "Without disparities: of cloth that faces the camera; 0: told by the scales of the "
    "features",
    G_TYPE_DOUBLE, SETTING (grow.stretch.metres_per_pixel), ANY_TIME, 0, 1},
  {"foreshortening", "Foreshortening",
    "Without disparities: how often longer a distance may be than it looks",
    G_TYPE_DOUBLE, SETTING (grow.stretch.foreshortening), ANY_TIME, 1, 100},
  {"verify-stretch", "Stretch in verification", "As stretch, where neighbours vote",
    G_TYPE_DOUBLE, SETTING (verify.stretch.stretch), ANY_TIME, 0, 0.9},
  {"verify-slack", "Slack in verification", "As slack, where neighbours vote, px",
    G_TYPE_DOUBLE, SETTING (verify.stretch.slack), ANY_TIME, 0, 100},
  {"vote", "Vote", "Least mean vote of its neighbours for a match that is kept",
    G_TYPE_DOUBLE, SETTING (verify.vote), ANY_TIME, 0, 1},
  {"group-vote", "Vote on groups",
    "Least mean vote of other groups for all matches that grew from one seed",
    G_TYPE_DOUBLE, SETTING (verify.group_vote), ANY_TIME, 0, 1},
  {"support", "Support", "A match with fewer votes is refused in the end",
    G_TYPE_UINT, SETTING (verify.support), ANY_TIME, 0, 1000},
  {"reach", "Reach", "Farthest neighbour that votes, px",
    G_TYPE_DOUBLE, SETTING (verify.reach), ANY_TIME, 1, 10000},
  {"grid-reach", "Reach of the grid",
    "Longest side of a triangle of matches in which vertices are looked for, px",
    G_TYPE_DOUBLE, SETTING (grid.reach), ANY_TIME, 1, 10000},
  {"grid-beyond", "Beyond", "How far beyond the triangles vertices are looked for, px",
    G_TYPE_DOUBLE, SETTING (grid.beyond), ANY_TIME, 0, 10000},
  {"grid-radius", "Radius of the grid", "Matches so near to a vertex tell its place, px",
    G_TYPE_DOUBLE, SETTING (grid.radius), ANY_TIME, 1, 10000},
  {"grid-most", "Most matches", "Of these so many tell it, the nearest ones",
    G_TYPE_UINT, SETTING (grid.most), ANY_TIME, 3, 1000},
  {"grid-least", "Least matches", "Fewer that agree don't tell a vertex's place",
    G_TYPE_UINT, SETTING (grid.least), ANY_TIME, 3, 1000},
  {"grid-noise", "Noise of matches", "Standard deviation of a match's place, px",
    G_TYPE_DOUBLE, SETTING (grid.noise), ANY_TIME, 0.001, 100},
  {"grid-bend", "Bend",
    "Standard deviation of half the second derivatives of the places: how much the cloth "
    "bends, 1/px",
    G_TYPE_DOUBLE, SETTING (grid.bend), ANY_TIME, 1e-9, 1},
  {"grid-outlier", "Outlier", "A match so far off counts half, px",
    G_TYPE_DOUBLE, SETTING (grid.outlier), ANY_TIME, 0.001, 1000},
  {"grid-rival", "Rival",
    "A vertex that seems to be at two places is left out where the second has as large a "
    "share of the support of the first",
    G_TYPE_DOUBLE, SETTING (grid.rival), ANY_TIME, 0, 1},
  {"grid-uncertain", "Uncertain",
    "Matches that leave a vertex a greater standard deviation don't tell it, px",
    G_TYPE_DOUBLE, SETTING (grid.uncertain), ANY_TIME, 0, 1000},
  {"follow", "Follow",
        "Carry vertices that the print doesn't tell any more from picture to picture by "
        "optical flow",
    G_TYPE_BOOLEAN, SETTING (follow), ANY_TIME},
  {"follow-window", "Window of the flow", "Side of the window that is followed, px",
    G_TYPE_INT, SETTING (following.window), ANY_TIME, 3, 255},
  {"follow-levels", "Levels of the flow", "How often pictures are halved for it",
    G_TYPE_INT, SETTING (following.levels), ANY_TIME, 0, 10},
  {"follow-back", "Way back",
        "A vertex that the flow does not lead back to where it was, so near, is lost, px",
    G_TYPE_DOUBLE, SETTING (following.back), ANY_TIME, 0.01, 100},
  {"follow-crowding", "Crowding",
        "One that comes nearer to a neighbour than this share of the usual is at a fold's "
        "crest, and is lost",
    G_TYPE_DOUBLE, SETTING (following.crowding), ANY_TIME, 0, 1},
  {"follow-drift", "Drift", "Standard deviation that each picture adds to a followed place, px",
    G_TYPE_DOUBLE, SETTING (following.drift), ANY_TIME, 0, 10},
  {"follow-uncertain", "Uncertain", "A followed place of a greater standard deviation is lost, px",
    G_TYPE_DOUBLE, SETTING (following.uncertain), ANY_TIME, 0, 1000},
};
/* *INDENT-ON* */

G_DEFINE_TYPE (GstSiftMatch, gst_sift_match, GST_TYPE_CLOTH_FILTER);
GST_ELEMENT_REGISTER_DEFINE (siftmatch, "siftmatch", GST_RANK_NONE,
    GST_TYPE_SIFT_MATCH);

static void
gst_sift_match_stop (GstClothFilter * filter)
{
  GstSiftMatch *self = GST_SIFT_MATCH (filter);

  g_clear_pointer (&self->steady, cloth_steady_free);
  g_clear_pointer (&self->gridder, cloth_gridder_free);
  g_clear_pointer (&self->follower, cloth_follower_free);
  g_clear_pointer (&self->verifier, cloth_verifier_free);
  g_clear_pointer (&self->grower, cloth_grower_free);
  g_clear_pointer (&self->sift, cloth_cv_sift_free);
  g_clear_pointer (&self->reference, gst_cloth_print_release);
  g_clear_pointer (&self->pool, cloth_pool_free);
  g_clear_pointer (&self->pattern, cloth_picture_pattern_free);
}

/* FALSE: there is no pattern of a print, and an error was posted. */
static gboolean
gst_sift_match_load_pattern (GstSiftMatch * self, const gchar * path)
{
  g_autoptr (GError) error = NULL;

  if (!path) {
    GST_ELEMENT_ERROR (self, RESOURCE, NOT_FOUND,
        ("The print is not known: the property pattern is not set."),
        ("Set pattern to a pattern.json of kind \"picture\", which names a scan of the "
            "print and its size on the cloth."));
    return FALSE;
  }
  self->pattern = cloth_picture_pattern_load (path, &error);
  if (!self->pattern) {
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("Can't read the pattern: %s", error->message),
        ("Set pattern to a pattern.json of kind \"picture\"; it is now \"%s\". Dots are "
            "found by dotlabel, checkerboards by quadtrack.", path));
    return FALSE;
  }
  return TRUE;
}

/* Looks at the print. FALSE: that can't be done, and an error was posted. */
static gboolean
gst_sift_match_load_print (GstSiftMatch * self,
    const ClothReferenceParams * settings)
{
  const ClothPicturePattern *pattern = self->pattern;
  ClothReferenceParams params = *settings;
  ClothGridShape shape = { pattern->columns, pattern->rows,
    {pattern->cloth_m[0], pattern->cloth_m[1]}
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (GstSample) sample = gst_cloth_load_picture (pattern->reference,
      "GRAY8", GST_CLOTH_MAX_SILHOUETTE_SIZE, &error);
  GstVideoInfo info;
  GstVideoFrame frame;

  params.sides = pattern->sides;
  params.cloth_m[0] = pattern->cloth_m[0];
  params.cloth_m[1] = pattern->cloth_m[1];
  if (sample && gst_video_info_from_caps (&info, gst_sample_get_caps (sample))
      && gst_video_frame_map (&frame, &info, gst_sample_get_buffer (sample),
          GST_MAP_READ)) {
    const ClothImage image = { GST_VIDEO_FRAME_COMP_DATA (&frame, 0),
      GST_VIDEO_FRAME_WIDTH (&frame), GST_VIDEO_FRAME_HEIGHT (&frame),
      GST_VIDEO_FRAME_COMP_STRIDE (&frame, 0)
    };
    const ClothCvPicture picture = { image.data, image.width, image.height,
      image.stride
    };

    self->reference = gst_cloth_print_acquire (&params, &picture, self->pool,
        &error);
    if (self->reference)
      self->gridder = cloth_gridder_new (&shape, &image, &error);
    gst_video_frame_unmap (&frame);
  }
  if (!self->gridder)
    GST_ELEMENT_ERROR (self, RESOURCE, OPEN_READ,
        ("Can't use the picture of the print: %s", error ? error->message :
            "it can't be read"),
        ("Let reference in the pattern name a scan or a photograph of the flat "
            "print; it is now \"%s\".", pattern->reference));
  return self->gridder != NULL;
}

static void
gst_sift_match_judge_print (GstSiftMatch * self)
{
  const gdouble repeated = cloth_reference_get_repeated (self->reference);

  GST_INFO_OBJECT (self, "%u features of the print, %.1f%% repeated",
      cloth_reference_get_features (self->reference)->n, 100 * repeated);
  if (repeated >= CLOTH_REFERENCE_REPEATED)
    GST_ELEMENT_WARNING (self, RESOURCE, SETTINGS,
        ("%.0f%% of the print's features repeat themselves elsewhere on it: cloth will be "
            "taken for other places of itself.", 100 * repeated),
        ("Use a print that doesn't repeat itself, or film a part of the cloth that is one "
            "repeat and let the pattern show just that."));
}

static gboolean
gst_sift_match_start (GstClothFilter * filter)
{
  GstSiftMatch *self = GST_SIFT_MATCH (filter);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;
  ClothReferenceParams params;
  ClothCvSiftParams film;
  guint threads;

  GST_OBJECT_LOCK (self);
  path = g_strdup (self->settings.pattern);
  threads = self->settings.threads;
  params = self->settings.reference;
  film = params.sift;
  film.contrast = self->settings.contrast;
  GST_OBJECT_UNLOCK (self);

  if (!gst_sift_match_load_pattern (self, path)) {
    gst_sift_match_stop (filter);
    return FALSE;
  }
  self->pool = cloth_pool_new (threads);
  if (!gst_sift_match_load_print (self, &params)) {
    gst_sift_match_stop (filter);
    return FALSE;
  }
  self->sift = cloth_cv_sift_new (&film, &error);
  if (!self->sift) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("Features can't be looked for: %s", error->message), (NULL));
    gst_sift_match_stop (filter);
    return FALSE;
  }
  cloth_cv_sift_keep (self->sift, GST_CLOTH_MAX_FEATURES);
  self->grower = cloth_grower_new ();
  self->follower = cloth_follower_new ((guint) self->pattern->columns,
      (guint) self->pattern->rows);
  self->verifier = cloth_verifier_new ();
  g_array_set_size (self->vertices,
      (guint) (self->pattern->columns * self->pattern->rows));
  self->n_pictures = 0;
  self->n_features = self->n_verified = 0;
  self->fits = self->warned_of_print = self->warned_of_features = FALSE;
  self->warned_of_lack = FALSE;
  self->looked = FALSE;
  self->richest = 0;
  gst_sift_match_judge_print (self);
  return TRUE;
}

static void
gst_sift_match_reset (GstClothFilter * filter)
{
  GstSiftMatch *self = GST_SIFT_MATCH (filter);

  if (self->steady)
    cloth_steady_reset (self->steady);
  if (self->follower)
    cloth_follower_reset (self->follower);
}

/* ---- what is looked at ---- */

/* The first pixel of @n whose centre lies at or after the edge of a pixel of @of. */
static gint
first_pixel (gint edge, gint n, gint of)
{
  const gint64 twice = 2 * (gint64) n * edge - of;

  return twice <= 0 ? 0 : (gint) MIN ((twice + 2 * of - 1) / (2 * of), n);
}

/* Which pixel of @of the centre of pixel @i of @n lies in. */
static gint
pixel_of (gint i, gint n, gint of)
{
  return (gint) ((2 * (gint64) i + 1) * of / (2 * n));
}

/* What is cloth in a picture of @width by @height px, whatever the silhouette's size. */
static void
fill_mask (const GstClothSilhouette * silhouette, gint width, gint height,
    guint8 * mask)
{
  const gint columns = (gint) gst_cloth_silhouette_get_width (silhouette);
  const gint rows = (gint) gst_cloth_silhouette_get_height (silhouette);
  guint n;
  const GstClothRun *runs = gst_cloth_silhouette_get_runs (silhouette, &n);
  guint begin = 0;

  memset (mask, 0, (gsize) width * height);
  for (gint y = 0; y < height; y++) {
    const gint row = pixel_of (y, height, rows);

    while (begin < n && runs[begin].row < row)
      begin++;
    for (guint i = begin; i < n && runs[i].row == row; i++) {
      const gint from = first_pixel (runs[i].begin, width, columns);
      const gint to = first_pixel (runs[i].end, width, columns);

      if (to > from)
        memset (mask + (gsize) y * width + from, 255, (gsize) (to - from));
    }
  }
}

/* The points under the pixels of a picture of @width by @height px, whatever the disparities'
 * size; NaN where there is none. */
static const gfloat *
gst_sift_match_find_points (GstSiftMatch * self,
    const GstClothDisparity * disparity, gint width, gint height)
{
  const gint columns = (gint) gst_cloth_disparity_get_width (disparity);
  const gint rows = (gint) gst_cloth_disparity_get_height (disparity);
  const gboolean scaled = columns != width || rows != height;
  const gfloat *from;
  gfloat *to;

  g_array_set_size (self->own_points, 3 * (guint) (columns * rows));
  from = (const gfloat *) self->own_points->data;
  gst_cloth_disparity_get_points (disparity, (gfloat *) self->own_points->data);
  if (!scaled)
    return from;
  g_array_set_size (self->points, 3 * (guint) (width * height));
  to = (gfloat *) self->points->data;
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++, to += 3)
      memcpy (to, from + 3 * ((gsize) pixel_of (y, height, rows) * columns
              + pixel_of (x, width, columns)), 3 * sizeof *to);
  return (const gfloat *) self->points->data;
}

static void
fill_mask_of_disparity (const GstClothDisparity * disparity, gint width,
    gint height, guint8 * mask)
{
  const gint columns = (gint) gst_cloth_disparity_get_width (disparity);
  const gint rows = (gint) gst_cloth_disparity_get_height (disparity);
  const guint8 *states = gst_cloth_disparity_get_states (disparity, NULL);

  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++)
      mask[(gsize) y * width + x] =
          states[(gsize) pixel_of (y, height, rows) * columns
          + pixel_of (x, width, columns)] == GST_CLOTH_DISPARITY_OUTSIDE ?
          0 : 255;
}

/* NULL: the whole picture. */
static const guint8 *
gst_sift_match_find_mask (GstSiftMatch * self, GstBuffer * buffer, gint width,
    gint height)
{
  const GstClothSilhouette *silhouette =
      gst_buffer_get_cloth_silhouette (buffer);
  const GstClothDisparity *disparity = gst_buffer_get_cloth_disparity (buffer);

  if (!silhouette && !disparity)
    return NULL;
  g_byte_array_set_size (self->mask, (guint) (width * height));
  if (silhouette)
    fill_mask (silhouette, width, height, self->mask->data);
  else
    fill_mask_of_disparity (disparity, width, height, self->mask->data);
  return self->mask->data;
}

/* ---- what is found ---- */

static void
gst_sift_match_collect (GstSiftMatch * self, const ClothCvFeatures * features)
{
  const ClothReferenceFeatures *print =
      cloth_reference_get_features (self->reference);
  const gdouble *cloth_m = self->pattern->cloth_m;
  const guint columns = (guint) self->pattern->columns;

  g_array_set_size (self->to_matches, 0);
  for (guint i = 0; i < features->n; i++) {
    const ClothMatch *match = &g_array_index (self->matches, ClothMatch, i);
    const guint32 k = match->reference;
    GstClothMatch to;

    if (match->state != CLOTH_MATCH_MATCHED
        && match->state != CLOTH_MATCH_REFUSED)
      continue;
    to = (GstClothMatch) {
    .x = features->x[i],.y = features->y[i],.u =
          (gfloat) (cloth_m[0] * (print->x[k] + 0.5) / print->width),.v =
          (gfloat) (cloth_m[1] * (print->y[k] + 0.5) / print->height),.scale =
          features->scale[i],.distance =
          (gfloat) sqrt (match->distance),.group = match->group,.oblique =
          print->view[k] > 0,.mirrored = print->side[k] > 0,.verified =
          match->state == CLOTH_MATCH_MATCHED};
    g_array_append_val (self->to_matches, to);
  }

  g_array_set_size (self->to_points, 0);
  for (guint v = 0; v < self->vertices->len; v++) {
    const ClothGridVertex *vertex =
        &g_array_index (self->vertices, ClothGridVertex, v);
    GstClothGridPoint to;

    if (vertex->state == CLOTH_GRID_UNSEEN)
      continue;
    to = (GstClothGridPoint) {
    .column = (gint) (v % columns),.row = (gint) (v / columns),.mirrored =
          vertex->mirrored,.x = (gfloat) vertex->x,.y =
          (gfloat) vertex->y,.cov_xx = (gfloat) vertex->xx,.cov_xy =
          (gfloat) vertex->xy,.cov_yy = (gfloat) vertex->yy};
    g_array_append_val (self->to_points, to);
  }
}

/* Averages vertices over time, over as many pictures as is wanted now. */
static void
gst_sift_match_average (GstSiftMatch * self, guint most)
{
  if (most != self->steady_most || !self->steady) {
    g_clear_pointer (&self->steady, cloth_steady_free);
    self->steady_most = most;
    if (most > 0)
      self->steady = cloth_steady_new (self->vertices->len, most);
  }
  if (self->steady)
    cloth_steady_run (self->steady, (ClothGridVertex *) self->vertices->data);
}

/* Adds vertices that the print doesn't tell any more. */
static gboolean
gst_sift_match_follow (GstSiftMatch * self, const ClothFollowParams * params,
    const ClothImage * luma)
{
  g_autoptr (GError) error = NULL;
  guint n;

  if (cloth_follower_run (self->follower, params, luma,
          (ClothGridVertex *) self->vertices->data, &n, &error)) {
    GST_LOG_OBJECT (self, "%u vertices followed", n);
    return TRUE;
  }
  GST_ELEMENT_ERROR (self, STREAM, FAILED,
      ("Vertices can't be followed: %s", error->message), (NULL));
  return FALSE;
}

/* Whether the pictures since the last judgement show the print; one warning when none has. */
static void
gst_sift_match_judge_pictures (GstSiftMatch * self)
{
  const gdouble share = (gdouble) self->n_verified / (gdouble) MAX
      (self->n_features, 1);

  if (share >= LEAST_SHARE) {
    self->fits = TRUE;
  } else if (!self->fits && !self->warned_of_print) {
    self->warned_of_print = TRUE;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("Hardly anything of the film is found in the print: %.1f%% of the features in %u "
            "pictures.", 100 * share, self->n_pictures),
        ("Let the pattern name the very print that is filmed; and if it is printed on one "
            "side and the back is filmed, film the front, or set sides to 2 in the pattern "
            "where the print shows through. Where much else than cloth is in the picture, "
            "put silhouette before %s.", GST_OBJECT_NAME (self)));
  }
  self->n_pictures = 0;
  self->n_features = self->n_verified = 0;
}

/* A film without features; pictures without cloth before and after others are no matter. */
static void
gst_sift_match_judge_film (GstSiftMatch * self)
{
  if (!self->looked || self->richest >= LEAST_FEATURES || self->warned_of_lack)
    return;
  self->warned_of_lack = TRUE;
  GST_ELEMENT_WARNING (self, STREAM, FAILED,
      ("No picture of the film has more than %u features: too few to find the print.",
          self->richest),
      ("See that the print is sharp and large in the picture, and that what silhouette or "
          "clothdisparity takes for cloth is cloth; else lower contrast."));
}

static void
gst_sift_match_count (GstSiftMatch * self, guint n_features, guint n_verified)
{
  self->looked = TRUE;
  self->richest = MAX (self->richest, n_features);
  if (n_features < LEAST_FEATURES)
    return;
  self->n_pictures++;
  self->n_features += n_features;
  self->n_verified += n_verified;
  if (self->n_pictures == PATIENCE)
    gst_sift_match_judge_pictures (self);
}

/* A film may end before patience does. */
static gboolean
gst_sift_match_sink_event (GstBaseTransform * trans, GstEvent * event)
{
  GstSiftMatch *self = GST_SIFT_MATCH (trans);

  if (GST_EVENT_TYPE (event) == GST_EVENT_EOS) {
    if (self->n_pictures > 0)
      gst_sift_match_judge_pictures (self);
    gst_sift_match_judge_film (self);
  }
  return GST_BASE_TRANSFORM_CLASS (gst_sift_match_parent_class)->sink_event
      (trans, event);
}

/* FALSE: no features can be looked for in such a picture, and an error was posted. */
static gboolean
gst_sift_match_find_features (GstSiftMatch * self, const ClothImage * luma,
    const guint8 * mask, ClothCvFeatures * features)
{
  const ClothCvPicture picture = { luma->data, luma->width, luma->height,
    luma->stride
  };
  const ClothCvPicture where = { mask, luma->width, luma->height, luma->width };
  g_autoptr (GError) error = NULL;

  if (!cloth_cv_sift_run (self->sift, &picture, mask ? &where : NULL, features,
          &error)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("Features can't be found in a picture: %s", error->message),
        ("Put videoscale before %s.", GST_OBJECT_NAME (self)));
    return FALSE;
  }
  if (cloth_cv_sift_get_n_dropped (self->sift) && !self->warned_of_features) {
    self->warned_of_features = TRUE;
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("A picture has %u features; the %d strongest are looked at.",
            features->n + cloth_cv_sift_get_n_dropped (self->sift),
            GST_CLOTH_MAX_FEATURES),
        ("Put silhouette before %s, so that only the cloth is looked at, or raise "
            "contrast.", GST_OBJECT_NAME (self)));
  }
  return TRUE;
}

static GstFlowReturn
gst_sift_match_analyse (GstClothFilter * filter,
    const GstClothFilterFrame * frame)
{
  GstSiftMatch *self = GST_SIFT_MATCH (filter);
  const gint width = frame->luma.width, height = frame->luma.height;
  const GstClothDisparity *disparity =
      gst_buffer_get_cloth_disparity (frame->buffer);
  const guint8 *mask;
  ClothImage where = { NULL, width, height, width };
  ClothMatchSurface under = { NULL, width, height, width };
  const ClothMatchSurface *surface = NULL;
  ClothCvFeatures features;
  ClothGrowParams grow;
  ClothVerifyParams verify;
  ClothGridParams grid;
  ClothGrowth growth;
  ClothVerification verification;
  ClothGridding gridding;
  ClothMatch *matches;
  ClothGridMatch *grid_matches;
  ClothFollowParams following;
  gboolean follow;
  guint steady, n;

  GST_OBJECT_LOCK (self);
  grow = self->settings.grow;
  verify = self->settings.verify;
  grid = self->settings.grid;
  steady = self->settings.steady;
  follow = self->settings.follow;
  following = self->settings.following;
  GST_OBJECT_UNLOCK (self);
  verify.stretch.depth_step = grow.stretch.depth_step;
  verify.stretch.hidden = grow.stretch.hidden;
  verify.stretch.metres_per_pixel = grow.stretch.metres_per_pixel;
  verify.stretch.foreshortening = grow.stretch.foreshortening;
  grid.stretch = grow.stretch;

  mask = gst_sift_match_find_mask (self, frame->buffer, width, height);
  if (!gst_sift_match_find_features (self, &frame->luma, mask, &features))
    return GST_FLOW_ERROR;
  if (disparity) {
    under.points = gst_sift_match_find_points (self, disparity, width, height);
    surface = &under;
  }
  matches = (ClothMatch *) g_array_set_size (self->matches, features.n)->data;
  cloth_grower_run (self->grower, &grow, self->reference, &features, surface,
      matches, &growth, self->pool, CLOTH_SIMD_BEST);
  cloth_verifier_run (self->verifier, &verify, self->reference, &features,
      surface, matches, &verification, self->pool);

  grid_matches = (ClothGridMatch *) g_array_set_size (self->grid_matches,
      features.n)->data;
  n = cloth_grid_get_matches (self->reference, self->pattern->cloth_m,
      &features, matches, grid_matches);
  where.data = mask;
  cloth_gridder_run (self->gridder, &grid, grid_matches, n, &frame->luma,
      mask ? &where : NULL, surface, (ClothGridVertex *) self->vertices->data,
      &gridding, self->pool, CLOTH_SIMD_BEST);
  gst_sift_match_average (self, steady);
  if (follow && !gst_sift_match_follow (self, &following, &frame->luma))
    return GST_FLOW_ERROR;

  gst_sift_match_collect (self, &features);
  gst_buffer_add_cloth_matches_meta (frame->buffer,
      gst_cloth_matches_new (frame->camera, frame->sequence,
          (guint) self->pattern->columns, (guint) self->pattern->rows,
          features.n, surface != NULL,
          (const GstClothMatch *) self->to_matches->data, self->to_matches->len,
          (const GstClothGridPoint *) self->to_points->data,
          self->to_points->len));
  gst_sift_match_count (self, features.n, verification.n_verified);
  GST_LOG_OBJECT (self, "%u features, %u matched, %u verified, %u vertices",
      features.n, growth.n_matched, verification.n_verified,
      self->to_points->len);
  return GST_FLOW_OK;
}

static void
gst_sift_match_finalize (GObject * object)
{
  GstSiftMatch *self = GST_SIFT_MATCH (object);

  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &self->settings);
  g_byte_array_unref (self->mask);
  g_array_unref (self->points);
  g_array_unref (self->own_points);
  g_array_unref (self->matches);
  g_array_unref (self->grid_matches);
  g_array_unref (self->vertices);
  g_array_unref (self->to_matches);
  g_array_unref (self->to_points);
  G_OBJECT_CLASS (gst_sift_match_parent_class)->finalize (object);
}

static Settings
default_settings (void)
{
  const Settings defaults = {
    .contrast = cloth_cv_sift_default_params ().contrast,
    .reference = cloth_reference_default_params (),
    .grow = cloth_grow_default_params (),
    .verify = cloth_verify_default_params (),
    .grid = cloth_grid_default_params (),
    .following = cloth_follow_default_params ()
  };

  return defaults;
}

static void
gst_sift_match_class_init (GstSiftMatchClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstClothFilterClass *filter_class = GST_CLOTH_FILTER_CLASS (klass);
  const Settings defaults = default_settings ();

  GST_DEBUG_CATEGORY_INIT (sift_match_debug, "siftmatch", 0,
      "matching of a print");
  object_class->finalize = gst_sift_match_finalize;
  GST_BASE_TRANSFORM_CLASS (klass)->sink_event = gst_sift_match_sink_event;
  filter_class->start = gst_sift_match_start;
  filter_class->stop = gst_sift_match_stop;
  filter_class->reset = gst_sift_match_reset;
  filter_class->analyse = gst_sift_match_analyse;

  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      G_STRUCT_OFFSET (GstSiftMatch, settings));
  gst_element_class_set_static_metadata (GST_ELEMENT_CLASS (klass),
      "Print matcher", "Filter/Analyzer/Video",
      "Finds which place of its print each feature of a cloth shows",
      "The gst-cloth developers");
}

static void
gst_sift_match_init (GstSiftMatch * self)
{
  self->settings = default_settings ();
  self->mask = g_byte_array_new ();
  self->points = g_array_new (FALSE, FALSE, sizeof (gfloat));
  self->own_points = g_array_new (FALSE, FALSE, sizeof (gfloat));
  self->matches = g_array_new (FALSE, FALSE, sizeof (ClothMatch));
  self->grid_matches = g_array_new (FALSE, FALSE, sizeof (ClothGridMatch));
  self->vertices = g_array_new (FALSE, FALSE, sizeof (ClothGridVertex));
  self->to_matches = g_array_new (FALSE, FALSE, sizeof (GstClothMatch));
  self->to_points = g_array_new (FALSE, FALSE, sizeof (GstClothGridPoint));
}
