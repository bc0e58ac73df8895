/* Seven trackers of a printed cloth, compared by Hasler et al.: three of markers in space, four of
 * features in pictures.
 *
 * Model: in the first frame the cloth lies flat at a known place, so that each feature has a known (u, v).
 *   Features of several cameras that show one place make a marker. A sight is how one camera sees one
 *   marker, or one feature; it is found again by how it was described in its reference frames: the
 *   first, the one before, or the last 20. Of Lucas–Kanade and the tracker without (u, v) optical flow
 *   carries it on instead.
 * Assumption: from frame to frame nothing moves further than motion_px and motion_m. A sight that was
 *   lost for k frames may be k times as far away.
 * Method: each camera's sights choose among the features in reach; of several that choose the same the most
 *   alike gets it. A marker needs two rays that pass the filters, or there is none in this frame. If rays
 *   don't meet, its references stay what they were; a camera that alone sees it goes on seeing it, and
 *   of several references others may join again.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   sections 4 to 4.3. The paper compares with all features of a picture; see seek.c why this does not.
 *   Kalal, Mikolajczyk and Matas, Forward-backward error, 2010.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/tracker.h"

#include <math.h>
#include <string.h>

#include "gst/rig/rig.h"
#include "gst/vision/track/combine.h"
#include "gst/vision/track/flow.h"
#include "gst/vision/track/seek.h"

#define BYTES CLOTH_CV_SIFT_BYTES

G_DEFINE_QUARK (cloth - tracker - error - quark, cloth_tracker_error);

/* @track: whose sight it is
 * @px: where it was seen last
 * @seen: frame of that
 * @choice: feature of this frame, or %CLOTH_SEEK_NONE
 * @distance: how unlike that is
 */
typedef struct
{
  guint track, camera;
  gdouble px[2], before[2];
  guint seen;
  guint choice;
  guint32 distance;
} Sight;

/* @first: its sights are @first to before @end
 * @seen: frame in which it was found last
 */
typedef struct
{
  gdouble uv[2], position[3];
  guint first, end;
  guint seen, n_rays;
} Track;

struct _ClothTracker
{
  ClothTrackerKind kind;
  ClothTrackerParams params;
  guint n_cameras;
  const ClothCamera *cameras;
  guint frame;
  gboolean started;
  GArray *tracks, *sights;
  GArray *markers, *features;   /* of this frame */

  /* descriptors: depth references of each sight, in turn, and the frames they are of */
  guint depth;
  guint8 *described;
  guint *described_in;          /* G_MAXUINT: none yet */
  guint *claims;                /* of each feature of a picture the sight that gets it */
  guint claims_size;

  /* optical flow: the pictures before, and sights or features that are followed */
  ClothFlow **flows;
  GArray **waiting;             /* without (u, v): places in them, px */
  gfloat *from, *to;
  guint8 *found, *lost;
  gdouble *uv, *px;
  guint *list;
  guint size;
  ClothCrest *crest;
};

static const gchar *const names[CLOTH_TRACKER_N_KINDS] = {
  "reference", "frames", "multi", "reference-2d", "lucas-kanade", "frames-2d",
  "uvless"
};

/* @kind: a tracker
 *
 * Returns: its name
 */
const gchar *
cloth_tracker_kind_to_string (ClothTrackerKind kind)
{
  return names[kind];
}

/* @name: of a tracker
 * @kind: (out): it
 *
 * Returns: whether there is such a one
 */
gboolean
cloth_tracker_kind_from_string (const gchar * name, ClothTrackerKind * kind)
{
  for (guint k = 0; k < CLOTH_TRACKER_N_KINDS; k++)
    if (strcmp (name, names[k]) == 0) {
      *kind = (ClothTrackerKind) k;
      return TRUE;
    }
  return FALSE;
}

/* @kind: a tracker
 *
 * Returns: whether it gives markers; else it gives features
 */
gboolean
cloth_tracker_kind_is_3d (ClothTrackerKind kind)
{
  return kind <= CLOTH_TRACKER_MULTI;
}

static gboolean
is_flow (const ClothTracker * tracker)
{
  return tracker->kind == CLOTH_TRACKER_LUCAS_KANADE
      || tracker->kind == CLOTH_TRACKER_UVLESS;
}

/* Returns: the usual ones
 */
ClothTrackerParams
cloth_tracker_default_params (void)
{
  return (ClothTrackerParams) {
    20, 0.005, 0.8, 20., 0.05, cloth_marker_default_params (), {
    21, 3}
  , 0.4, TRUE, cloth_crest_default_params ()};
}

static gboolean
check (const ClothTrackerParams * p, guint n_cameras, GError ** error)
{
  const gchar *what = NULL;

  if (p->references < 1 || p->references > CLOTH_TRACKER_MAX_REFERENCES)
    what = "references: give 1 to 100 frames";
  else if (!(p->radius > 0))
    what = "radius: give a length above 0 m";
  else if (!(p->ratio > 0 && p->ratio <= 1))
    what = "ratio: give a number above 0, at most 1";
  else if (!(p->motion_px > 0 && p->motion_m > 0))
    what = "motion: give lengths above 0";
  else if (n_cameras < 1 || n_cameras > CLOTH_RIG_MAX_CAMERAS)
    what = "cameras: give 1 to 64";
  if (what)
    g_set_error_literal (error, CLOTH_TRACKER_ERROR,
        CLOTH_TRACKER_ERROR_PARAMETER, what);
  return what == NULL;
}

/* @kind: which tracker
 * @params: how
 * @n_cameras: of the rig
 * @cameras: (array length=n_cameras): they have to outlive the tracker
 * @error: #ClothTrackerError
 *
 * Returns: (transfer full): a tracker that has seen nothing yet
 */
ClothTracker *
cloth_tracker_new (ClothTrackerKind kind, const ClothTrackerParams * params,
    guint n_cameras, const ClothCamera * cameras, GError ** error)
{
  ClothTracker *t;

  if (!check (params, n_cameras, error))
    return NULL;
  if (cloth_tracker_kind_is_3d (kind) && n_cameras < 2) {
    g_set_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_PARAMETER,
        "the tracker “%s” makes markers of rays of several cameras, and there is "
        "one; give more, or take a tracker of features", names[kind]);
    return NULL;
  }
  t = g_new0 (ClothTracker, 1);
  t->kind = kind;
  t->params = *params;
  t->n_cameras = n_cameras;
  t->cameras = cameras;
  t->depth = kind == CLOTH_TRACKER_MULTI ? params->references : 1;
  t->tracks = g_array_new (FALSE, FALSE, sizeof (Track));
  t->sights = g_array_new (FALSE, FALSE, sizeof (Sight));
  t->markers = g_array_new (FALSE, FALSE, sizeof (ClothTrackedMarker));
  t->features = g_array_new (FALSE, FALSE, sizeof (ClothTrackedFeature));
  t->flows = g_new (ClothFlow *, n_cameras);
  t->waiting = g_new (GArray *, n_cameras);
  for (guint c = 0; c < n_cameras; c++) {
    t->flows[c] = cloth_flow_new ();
    t->waiting[c] = g_array_new (FALSE, FALSE, 2 * sizeof (gfloat));
  }
  t->crest = cloth_crest_new ();
  return t;
}

/* @tracker: (nullable) (transfer full): a tracker
 */
void
cloth_tracker_free (ClothTracker * tracker)
{
  ClothTracker *t = tracker;

  if (!t)
    return;
  for (guint c = 0; c < t->n_cameras; c++) {
    cloth_flow_free (t->flows[c]);
    g_array_unref (t->waiting[c]);
  }
  g_free (t->flows);
  g_free (t->waiting);
  g_array_unref (t->tracks);
  g_array_unref (t->sights);
  g_array_unref (t->markers);
  g_array_unref (t->features);
  g_free (t->described);
  g_free (t->described_in);
  g_free (t->claims);
  g_free (t->from);
  g_free (t->to);
  g_free (t->found);
  g_free (t->lost);
  g_free (t->uv);
  g_free (t->px);
  g_free (t->list);
  cloth_crest_free (t->crest);
  g_free (t);
}

static gboolean
check_views (const ClothTracker * t, const ClothTrackerView * views,
    GError ** error)
{
  for (guint c = 0; c < t->n_cameras; c++) {
    const ClothCamera *camera = &t->cameras[c];

    if (views[c].image.width != camera->width
        || views[c].image.height != camera->height) {
      g_set_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_VIEWS,
          "camera “%s”: its picture has %d × %d pixels, in the rig %d × %d",
          camera->name ? camera->name : "without a name",
          views[c].image.width, views[c].image.height, camera->width,
          camera->height);
      return FALSE;
    }
  }
  return TRUE;
}

/* ---- the first frame ---- */

/* A feature of the first frame that is on the cloth. */
typedef struct
{
  guint camera, feature;
  gdouble px[2];
} Candidate;

/* All features on the cloth, camera by camera. */
static void
list_candidates (const ClothTracker * t, const ClothFlatPose * pose,
    const ClothTrackerView * views, GArray * candidates, GArray * items)
{
  for (guint c = 0; c < t->n_cameras; c++) {
    const ClothCvFeatures *f = &views[c].features;

    for (guint i = 0; i < f->n; i++) {
      const Candidate candidate = { c, i, {f->x[i], f->y[i]} };
      ClothCombineItem item = { c, {0}, f->descriptors + (gsize) i * BYTES };

      if (!cloth_flat_uv (pose, &t->cameras[c], candidate.px, item.place))
        continue;
      g_array_append_val (candidates, candidate);
      g_array_append_val (items, item);
    }
  }
}

static void
add_sight (ClothTracker * t, const Candidate * from)
{
  const Sight sight = { t->tracks->len, from->camera, {from->px[0],
      from->px[1]}, {from->px[0], from->px[1]}, 0, from->feature, 0
  };

  g_array_append_val (t->sights, sight);
}

/* Of features at one place, described in several directions, the first; they follow each other. */
static gboolean
is_again (const Candidate * candidates, guint i)
{
  return i > 0 && candidates[i].camera == candidates[i - 1].camera
      && candidates[i].px[0] == candidates[i - 1].px[0]
      && candidates[i].px[1] == candidates[i - 1].px[1];
}

static void
start_features (ClothTracker * t, guint n, const Candidate * candidates,
    const ClothCombineItem * items)
{
  for (guint i = 0; i < n; i++) {
    const Track track = { {items[i].place[0], items[i].place[1]}, {NAN, NAN,
        NAN}, t->sights->len, t->sights->len + 1, 0, 1
    };

    if (is_again (candidates, i))
      continue;
    add_sight (t, &candidates[i]);
    g_array_append_val (t->tracks, track);
  }
}

/* Where the chosen features of a track's sights are seen; the result of cloth_marker_find (). */
static ClothMarkerResult
intersect (const ClothTracker * t, const Track * track,
    const ClothTrackerView * views, ClothMarker * marker, guint * n_rays)
{
  ClothRay rays[CLOTH_RIG_MAX_CAMERAS];
  guint n = 0;

  for (guint s = track->first; s < track->end; s++) {
    const Sight *sight = &g_array_index (t->sights, Sight, s);
    const ClothCvFeatures *f = &views[sight->camera].features;

    if (sight->choice != CLOTH_SEEK_NONE
        && cloth_marker_cast (&t->cameras[sight->camera], (const gdouble[2]) {
              f->x[sight->choice], f->y[sight->choice]
            }, &rays[n]))
      n++;
  }
  *n_rays = n;
  return cloth_marker_find (&t->params.marker, n, rays, marker);
}

/* Marks a feature of a candidate and those at the same place as used. */
static void
use (guint8 * used, guint n, const Candidate * candidates, guint i)
{
  used[i] = 1;
  for (guint j = i; is_again (candidates, j); j--)
    used[j - 1] = 1;
  for (guint j = i + 1; j < n && is_again (candidates, j); j++)
    used[j] = 1;
}

/* Markers of the groups of features whose rays meet. */
static void
start_markers (ClothTracker * t, const ClothTrackerView * views, guint n,
    const Candidate * candidates, const ClothCombineItem * items)
{
  g_autofree guint32 *groups = g_new (guint32, MAX (n, 1));
  g_autofree guint8 *used = g_malloc0 (MAX (n, 1));
  const guint n_groups = cloth_combine_run (n, items, t->params.radius, groups);
  g_autofree guint *heads = g_new (guint, MAX (n_groups, 1));
  g_autofree guint *next = g_new (guint, MAX (n, 1));

  for (guint g = 0; g < n_groups; g++)
    heads[g] = G_MAXUINT;
  for (guint i = n; i-- > 0;)
    if (groups[i] != CLOTH_COMBINE_NONE) {
      next[i] = heads[groups[i]];
      heads[groups[i]] = i;
    }
  for (guint g = 0; g < n_groups; g++) {
    Track track = { {0}, {0}, t->sights->len, t->sights->len, 0, 0 };
    gboolean is_new = TRUE;
    ClothMarker marker;

    for (guint i = heads[g]; i != G_MAXUINT; i = next[i]) {
      is_new &= !used[i];
      add_sight (t, &candidates[i]);
      track.end++;
      for (guint k = 0; k < 2; k++)
        track.uv[k] += items[i].place[k];
    }
    for (guint k = 0; k < 2; k++)
      track.uv[k] /= track.end - track.first;
    if (!is_new || intersect (t, &track, views, &marker,
            &track.n_rays) != CLOTH_MARKER_FOUND) {
      g_array_set_size (t->sights, track.first);
      continue;
    }
    for (guint i = heads[g]; i != G_MAXUINT; i = next[i])
      use (used, n, candidates, i);
    memcpy (track.position, marker.position, sizeof track.position);
    g_array_append_val (t->tracks, track);
  }
}

/* Keeps what a sight looks like in this frame. */
static void
describe (ClothTracker * t, guint s, const ClothTrackerView * views)
{
  const Sight *sight = &g_array_index (t->sights, Sight, s);
  const gsize slot = (gsize) s * t->depth + t->frame % t->depth;

  memcpy (t->described + slot * BYTES, views[sight->camera].features.descriptors
      + (gsize) sight->choice * BYTES, BYTES);
  t->described_in[slot] = t->frame;
}

/* ---- what was found ---- */

static void
report (ClothTracker * t)
{
  g_array_set_size (t->markers, 0);
  g_array_set_size (t->features, 0);
  for (guint i = 0; i < t->tracks->len; i++) {
    const Track *track = &g_array_index (t->tracks, Track, i);
    const Sight *sight = &g_array_index (t->sights, Sight, track->first);

    if (track->seen != t->frame)
      continue;
    if (cloth_tracker_kind_is_3d (t->kind)) {
      ClothTrackedMarker m = { i, {track->uv[0], track->uv[1]}, {0},
      track->n_rays
      };

      memcpy (m.position, track->position, sizeof m.position);
      g_array_append_val (t->markers, m);
    } else {
      const ClothTrackedFeature f = { sight->camera, i, {track->uv[0],
          track->uv[1]}, {sight->px[0], sight->px[1]}, {sight->before[0],
          sight->before[1]}
      };

      g_array_append_val (t->features, f);
    }
  }
}

/* ---- descriptors ---- */

/* Chooses a feature for each sight of a camera. */
static void
choose (ClothTracker * t, guint camera, const ClothCvFeatures * f)
{
  if (f->n > t->claims_size) {
    t->claims_size = f->n;
    t->claims = g_renew (guint, t->claims, f->n);
  }
  for (guint i = 0; i < f->n; i++)
    t->claims[i] = G_MAXUINT;
  for (guint s = 0; s < t->sights->len; s++) {
    Sight *sight = &g_array_index (t->sights, Sight, s);
    const guint8 *references[CLOTH_TRACKER_MAX_REFERENCES];
    guint n = 0;

    if (sight->camera != camera)
      continue;
    sight->choice = CLOTH_SEEK_NONE;
    for (guint k = 0; k < t->depth; k++) {
      const gsize slot = (gsize) s * t->depth + k;

      if (t->described_in[slot] != G_MAXUINT
          && (t->kind == CLOTH_TRACKER_REFERENCE
              || t->kind == CLOTH_TRACKER_REFERENCE_2D
              || t->described_in[slot] + t->depth >= t->frame))
        references[n++] = t->described + slot * BYTES;
    }
    if (n == 0)
      continue;
    sight->choice = cloth_seek_run (f, sight->px, t->params.motion_px *
        (t->frame - sight->seen), t->params.ratio, n, references,
        &sight->distance);
    if (sight->choice != CLOTH_SEEK_NONE) {
      guint *claim = &t->claims[sight->choice];

      if (*claim == G_MAXUINT || sight->distance < g_array_index (t->sights,
              Sight, *claim).distance)
        *claim = s;
    }
  }
  for (guint s = 0; s < t->sights->len; s++) {
    Sight *sight = &g_array_index (t->sights, Sight, s);

    if (sight->camera == camera && sight->choice != CLOTH_SEEK_NONE
        && t->claims[sight->choice] != s)
      sight->choice = CLOTH_SEEK_NONE;
  }
}

/* Whether what its sights chose is the track: @alone: it is, but one camera makes no marker. */
static gboolean
accept (ClothTracker * t, Track * track, const ClothTrackerView * views,
    gboolean * alone)
{
  const gdouble reach = t->params.motion_m * (t->frame - track->seen);
  ClothMarkerResult result;
  ClothMarker marker;
  gdouble moved = 0.;
  guint n_rays;

  *alone = FALSE;
  if (!cloth_tracker_kind_is_3d (t->kind))
    return g_array_index (t->sights, Sight,
        track->first).choice != CLOTH_SEEK_NONE;
  result = intersect (t, track, views, &marker, &n_rays);
  *alone = result == CLOTH_MARKER_FEW;
  if (result != CLOTH_MARKER_FOUND)
    return FALSE;
  for (guint k = 0; k < 3; k++)
    moved += (marker.position[k] - track->position[k]) *
        (marker.position[k] - track->position[k]);
  if (moved > reach * reach)
    return FALSE;
  memcpy (track->position, marker.position, sizeof track->position);
  track->n_rays = n_rays;
  return TRUE;
}

static void
run_descriptors (ClothTracker * t, const ClothTrackerView * views)
{
  const gboolean keeps = t->kind != CLOTH_TRACKER_REFERENCE
      && t->kind != CLOTH_TRACKER_REFERENCE_2D;

  for (guint c = 0; c < t->n_cameras; c++)
    choose (t, c, &views[c].features);
  for (guint i = 0; i < t->tracks->len; i++) {
    Track *track = &g_array_index (t->tracks, Track, i);
    gboolean alone;

    if (accept (t, track, views, &alone))
      track->seen = t->frame;
    else if (!alone)
      continue;
    for (guint s = track->first; s < track->end; s++) {
      Sight *sight = &g_array_index (t->sights, Sight, s);
      const ClothCvFeatures *f = &views[sight->camera].features;

      if (sight->choice == CLOTH_SEEK_NONE)
        continue;
      memcpy (sight->before, sight->px, sizeof sight->before);
      sight->px[0] = f->x[sight->choice];
      sight->px[1] = f->y[sight->choice];
      sight->seen = t->frame;
      if (keeps)
        describe (t, s, views);
    }
  }
}

/* ---- optical flow ---- */

static void
make_room (ClothTracker * t, guint n)
{
  if (n <= t->size)
    return;
  t->size = n;
  t->from = g_renew (gfloat, t->from, 2 * n);
  t->to = g_renew (gfloat, t->to, 2 * n);
  t->found = g_renew (guint8, t->found, n);
  t->lost = g_renew (guint8, t->lost, n);
  t->uv = g_renew (gdouble, t->uv, 2 * n);
  t->px = g_renew (gdouble, t->px, 2 * n);
  t->list = g_renew (guint, t->list, n);
}

/* Follows @n points from t->from to t->to, and, if @returns, back; t->found has those that are
 * good. */
static gboolean
flow (ClothTracker * t, guint camera, const ClothImage * image, guint n,
    gboolean returns, GError ** error)
{
  if (!cloth_flow_run (t->flows[camera], &t->params.flow, returns ?
          t->params.back : CLOTH_FLOW_ANYWHERE, image, n, t->from, t->to,
          t->found, error))
    return FALSE;
  for (guint i = 0; i < n; i++)
    t->found[i] = t->found[i] && hypot (t->to[2 * i] - t->from[2 * i],
        t->to[2 * i + 1] - t->from[2 * i + 1]) <= t->params.motion_px;
  return TRUE;
}

/* Drops of the @n points that are followed those that lie in crests. */
static void
drop_crests (ClothTracker * t, guint n)
{
  guint n_left = 0;

  for (guint i = 0; i < n; i++)
    if (t->found[i]) {
      const Track *track = &g_array_index (t->tracks, Track, t->list[i]);

      for (guint k = 0; k < 2; k++) {
        t->uv[2 * n_left + k] = track->uv[k];
        t->px[2 * n_left + k] = t->to[2 * i + k];
      }
      n_left++;
    }
  cloth_crest_run (t->crest, &t->params.crest, n_left, t->uv, t->px, t->lost);
  n_left = 0;
  for (guint i = 0; i < n; i++)
    if (t->found[i])
      t->found[i] = !t->lost[n_left++];
}

static gboolean
run_lucas_kanade (ClothTracker * t, guint camera, const ClothImage * image,
    GError ** error)
{
  guint n = 0;

  make_room (t, t->tracks->len);
  for (guint i = 0; i < t->tracks->len; i++) {
    const Track *track = &g_array_index (t->tracks, Track, i);
    const Sight *sight = &g_array_index (t->sights, Sight, track->first);

    if (sight->camera != camera || track->seen + 1 != t->frame)
      continue;
    t->from[2 * n] = (gfloat) sight->px[0];
    t->from[2 * n + 1] = (gfloat) sight->px[1];
    t->list[n++] = i;
  }
  if (!flow (t, camera, image, n, t->params.crests, error))
    return FALSE;
  if (t->params.crests)
    drop_crests (t, n);
  for (guint i = 0; i < n; i++) {
    Track *track = &g_array_index (t->tracks, Track, t->list[i]);
    Sight *sight = &g_array_index (t->sights, Sight, track->first);

    if (!t->found[i])
      continue;
    track->seen = t->frame;
    memcpy (sight->before, sight->px, sizeof sight->before);
    sight->px[0] = t->to[2 * i];
    sight->px[1] = t->to[2 * i + 1];
  }
  return TRUE;
}

/* Lists the features of a frame, which are followed to the next. */
static void
wait_for_next (ClothTracker * t, guint camera, const ClothCvFeatures * f)
{
  g_array_set_size (t->waiting[camera], 0);
  for (guint i = 0; i < f->n; i++) {
    const gfloat point[2] = { f->x[i], f->y[i] };

    if (i == 0 || f->x[i] != f->x[i - 1] || f->y[i] != f->y[i - 1])
      g_array_append_vals (t->waiting[camera], point, 1);
  }
}

static gboolean
run_uvless (ClothTracker * t, guint camera, const ClothTrackerView * view,
    GError ** error)
{
  const guint n = t->waiting[camera]->len;

  make_room (t, n);
  if (n)
    memcpy (t->from, t->waiting[camera]->data, 2 * n * sizeof *t->from);
  if (!flow (t, camera, &view->image, n, TRUE, error))
    return FALSE;
  for (guint i = 0; i < n; i++) {
    const ClothTrackedFeature f = { camera, i, {NAN, NAN}, {t->to[2 * i],
        t->to[2 * i + 1]}, {t->from[2 * i], t->from[2 * i + 1]}
    };

    if (t->found[i])
      g_array_append_val (t->features, f);
  }
  wait_for_next (t, camera, &view->features);
  return TRUE;
}

/* ---- frames ---- */

/* Makes room for what sights look like, and keeps what they look like in the first frame. */
static void
start_descriptors (ClothTracker * t, const ClothTrackerView * views)
{
  const gsize n = (gsize) t->sights->len * t->depth;

  t->described = g_realloc (t->described, MAX (n, 1) * BYTES);
  t->described_in = g_renew (guint, t->described_in, MAX (n, 1));
  for (gsize i = 0; i < n; i++)
    t->described_in[i] = G_MAXUINT;
  for (guint s = 0; s < t->sights->len; s++)
    describe (t, s, views);
}

/* @tracker: a tracker
 * @pose: where the cloth lies; not looked at without (u, v)
 * @views: (array): what each camera sees in the first frame
 * @error: #ClothTrackerError
 *
 * Begins a film; what was before it is forgotten.
 *
 * Returns: %FALSE when nothing can be tracked
 */
gboolean
cloth_tracker_start (ClothTracker * tracker, const ClothFlatPose * pose,
    const ClothTrackerView * views, GError ** error)
{
  ClothTracker *t = tracker;
  g_autoptr (GArray) candidates = g_array_new (FALSE, FALSE,
      sizeof (Candidate));
  g_autoptr (GArray) items = g_array_new (FALSE, FALSE,
      sizeof (ClothCombineItem));

  t->started = FALSE;
  t->frame = 0;
  g_array_set_size (t->tracks, 0);
  g_array_set_size (t->sights, 0);
  if (!check_views (t, views, error))
    return FALSE;
  if (t->kind != CLOTH_TRACKER_UVLESS) {
    list_candidates (t, pose, views, candidates, items);
    if (cloth_tracker_kind_is_3d (t->kind))
      start_markers (t, views, candidates->len,
          (const Candidate *) candidates->data,
          (const ClothCombineItem *) items->data);
    else
      start_features (t, candidates->len, (const Candidate *) candidates->data,
          (const ClothCombineItem *) items->data);
    if (t->tracks->len == 0) {
      g_set_error (error, CLOTH_TRACKER_ERROR, CLOTH_TRACKER_ERROR_START,
          "%u features of the first pictures are on the cloth, and none of them "
          "can be tracked%s", candidates->len, cloth_tracker_kind_is_3d
          (t->kind) ?
          " by two cameras: is the cloth where the pose says, and do "
          "the cameras see it from the same side?" : "");
      return FALSE;
    }
  }
  if (!is_flow (t))
    start_descriptors (t, views);
  for (guint c = 0; c < t->n_cameras && is_flow (t); c++) {
    cloth_flow_keep (t->flows[c], &views[c].image);
    wait_for_next (t, c, &views[c].features);
  }
  report (t);
  t->started = TRUE;
  return TRUE;
}

/* @tracker: a tracker that was started
 * @views: (array): what each camera sees in the next frame
 * @error: #ClothTrackerError or #ClothCvError
 *
 * Returns: %FALSE when pictures are not those of the cameras, or have no flow
 */
gboolean
cloth_tracker_run (ClothTracker * tracker, const ClothTrackerView * views,
    GError ** error)
{
  ClothTracker *t = tracker;

  if (!t->started) {
    g_set_error_literal (error, CLOTH_TRACKER_ERROR,
        CLOTH_TRACKER_ERROR_START, "a tracker has to be started by the first "
        "pictures");
    return FALSE;
  }
  if (!check_views (t, views, error))
    return FALSE;
  t->frame++;
  if (!is_flow (t))
    run_descriptors (t, views);
  g_array_set_size (t->features, 0);
  for (guint c = 0; c < t->n_cameras && is_flow (t); c++) {
    if (t->kind == CLOTH_TRACKER_UVLESS ?
        !run_uvless (t, c, &views[c], error) :
        !run_lucas_kanade (t, c, &views[c].image, error)) {
      t->started = FALSE;
      return FALSE;
    }
    cloth_flow_keep (t->flows[c], &views[c].image);
  }
  if (t->kind != CLOTH_TRACKER_UVLESS)
    report (t);
  return TRUE;
}

/* @tracker: a tracker
 * @n_markers: (out): how many
 *
 * Returns: (transfer none): markers of this frame, by id; valid until the next one
 */
const ClothTrackedMarker *
cloth_tracker_get_markers (const ClothTracker * tracker, guint * n_markers)
{
  *n_markers = tracker->markers->len;
  return (const ClothTrackedMarker *) tracker->markers->data;
}

/* @tracker: a tracker
 * @n_features: (out): how many
 *
 * Returns: (transfer none): features of this frame, by camera; valid until the next one
 */
const ClothTrackedFeature *
cloth_tracker_get_features (const ClothTracker * tracker, guint * n_features)
{
  *n_features = tracker->features->len;
  return (const ClothTrackedFeature *) tracker->features->data;
}
