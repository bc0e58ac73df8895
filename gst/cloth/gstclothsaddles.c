/* Saddle points of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothsaddles.h"
#include "gst/cloth/gstclothpayload.h"

/* The candidates follow the refined saddles. */
struct _GstClothSaddles
{
  GstClothPayload payload;
  guint n_refined, n_candidates;
  GstClothSaddle refined[];
};

G_STATIC_ASSERT (sizeof (GstClothSaddlesMeta) == sizeof (GstClothPayloadMeta));
/* They are written as rows of floats. */
G_STATIC_ASSERT (sizeof (GstClothSaddle) == 7 * sizeof (gfloat));
G_STATIC_ASSERT (sizeof (GstClothCandidate) == 3 * sizeof (gfloat));

G_DEFINE_BOXED_TYPE (GstClothSaddle, gst_cloth_saddle, gst_cloth_saddle_copy,
    gst_cloth_saddle_free);
G_DEFINE_BOXED_TYPE (GstClothCandidate, gst_cloth_candidate,
    gst_cloth_candidate_copy, gst_cloth_candidate_free);
G_DEFINE_BOXED_TYPE (GstClothSaddles, gst_cloth_saddles, gst_cloth_saddles_ref,
    gst_cloth_saddles_unref);

/**
 * gst_cloth_saddle_copy:
 * @saddle: a saddle
 *
 * Returns: (transfer full): a copy
 *
 * Since: 0.1
 */
GstClothSaddle *
gst_cloth_saddle_copy (const GstClothSaddle * saddle)
{
  return g_memdup2 (saddle, sizeof *saddle);
}

/**
 * gst_cloth_saddle_free:
 * @saddle: (transfer full): a saddle
 *
 * Frees a copy.
 *
 * Since: 0.1
 */
void
gst_cloth_saddle_free (GstClothSaddle * saddle)
{
  g_free (saddle);
}

/**
 * gst_cloth_candidate_copy:
 * @candidate: a candidate
 *
 * Returns: (transfer full): a copy
 *
 * Since: 0.1
 */
GstClothCandidate *
gst_cloth_candidate_copy (const GstClothCandidate * candidate)
{
  return g_memdup2 (candidate, sizeof *candidate);
}

/**
 * gst_cloth_candidate_free:
 * @candidate: (transfer full): a candidate
 *
 * Frees a copy.
 *
 * Since: 0.1
 */
void
gst_cloth_candidate_free (GstClothCandidate * candidate)
{
  g_free (candidate);
}

static GstClothCandidate *
saddles_candidates (const GstClothSaddles * saddles)
{
  return (GstClothCandidate *) (saddles->refined + saddles->n_refined);
}

/* The Hessian H of a saddle becomes S⁻¹ H S⁻¹. Taking the board's squares for right-
 * angled, H is a multiple of [cos 2a, sin 2a; sin 2a, -cos 2a]; the axis is the
 * eigenvector of its positive eigenvalue. */
static gfloat
scale_axis (gfloat axis, gdouble sx, gdouble sy)
{
  gdouble a;

  if (sx == sy)
    return axis;
  a = 0.5 * atan2 (2 * sin (2 * axis) / (sx * sy),
      cos (2 * axis) * (1 / (sx * sx) + 1 / (sy * sy)));
  if (a < 0)
    a += G_PI;
  return (gfloat) a < (gfloat) G_PI ? (gfloat) a : 0;
}

/* A response is a determinant of second derivatives. */
static void
saddles_scale (GstClothPayload * payload, gdouble scale_x, gdouble scale_y)
{
  GstClothSaddles *saddles = (GstClothSaddles *) payload;
  GstClothCandidate *candidate = saddles_candidates (saddles);
  gdouble det = 1 / (scale_x * scale_x * scale_y * scale_y);

  for (guint i = 0; i < saddles->n_refined; i++) {
    GstClothSaddle *s = &saddles->refined[i];

    gst_cloth_scale_place (&s->x, &s->y, scale_x, scale_y);
    s->response = (gfloat) (s->response * det);
    s->axis = scale_axis (s->axis, scale_x, scale_y);
    gst_cloth_scale_covariance (&s->cov_xx, &s->cov_xy, &s->cov_yy, scale_x,
        scale_y);
  }
  for (guint i = 0; i < saddles->n_candidates; i++, candidate++) {
    gst_cloth_scale_place (&candidate->x, &candidate->y, scale_x, scale_y);
    candidate->response = (gfloat) (candidate->response * det);
  }
}

/**
 * gst_cloth_saddles_new:
 * @camera: (nullable): name of the camera in the rig, UTF-8 of at most
 *   #GST_CLOTH_MAX_CAMERA_NAME bytes; %NULL or "" when it isn't known
 * @sequence: number of the frame, counted by the camera
 * @refined: (array length=n_refined) (nullable): refined saddles, copied
 * @n_refined: how many, at most #GST_CLOTH_MAX_FEATURES
 * @candidates: (array length=n_candidates) (nullable): candidates, copied
 * @n_candidates: how many, at most #GST_CLOTH_MAX_FEATURES
 *
 * What a saddle detector saw in one picture. Immutable; none seen is a valid payload
 * and says so.
 *
 * Returns: (transfer full): new saddles
 *
 * Since: 0.1
 */
GstClothSaddles *
gst_cloth_saddles_new (const gchar * camera, guint64 sequence,
    const GstClothSaddle * refined, guint n_refined,
    const GstClothCandidate * candidates, guint n_candidates)
{
  GstClothSaddles *saddles;

  g_return_val_if_fail (gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (refined || !n_refined, NULL);
  g_return_val_if_fail (candidates || !n_candidates, NULL);
  g_return_val_if_fail (n_refined <= GST_CLOTH_MAX_FEATURES, NULL);
  g_return_val_if_fail (n_candidates <= GST_CLOTH_MAX_FEATURES, NULL);

  saddles = gst_cloth_payload_new (sizeof *saddles
      + n_refined * sizeof *refined + n_candidates * sizeof *candidates,
      camera, sequence, saddles_scale);
  if (!saddles)
    return NULL;
  saddles->n_refined = n_refined;
  saddles->n_candidates = n_candidates;
  if (n_refined)
    memcpy (saddles->refined, refined, n_refined * sizeof *refined);
  if (n_candidates)
    memcpy (saddles_candidates (saddles), candidates,
        n_candidates * sizeof *candidates);
  return saddles;
}

/**
 * gst_cloth_saddles_ref:
 * @saddles: saddles
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothSaddles *
gst_cloth_saddles_ref (GstClothSaddles * saddles)
{
  return g_atomic_rc_box_acquire (saddles);
}

/**
 * gst_cloth_saddles_unref:
 * @saddles: (transfer full): saddles
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_saddles_unref (GstClothSaddles * saddles)
{
  gst_cloth_payload_release (saddles);
}

/**
 * gst_cloth_saddles_get_camera:
 * @saddles: saddles
 *
 * Returns: (transfer none): name of the camera, "" when it isn't known
 *
 * Since: 0.1
 */
const gchar *
gst_cloth_saddles_get_camera (const GstClothSaddles * saddles)
{
  return saddles->payload.camera;
}

/**
 * gst_cloth_saddles_get_sequence:
 * @saddles: saddles
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.1
 */
guint64
gst_cloth_saddles_get_sequence (const GstClothSaddles * saddles)
{
  return saddles->payload.sequence;
}

/**
 * gst_cloth_saddles_get_n_refined:
 * @saddles: saddles
 *
 * Returns: how many refined saddles there are
 *
 * Since: 0.1
 */
guint
gst_cloth_saddles_get_n_refined (const GstClothSaddles * saddles)
{
  return saddles->n_refined;
}

/**
 * gst_cloth_saddles_get_n_candidates:
 * @saddles: saddles
 *
 * Returns: how many candidates there are
 *
 * Since: 0.1
 */
guint
gst_cloth_saddles_get_n_candidates (const GstClothSaddles * saddles)
{
  return saddles->n_candidates;
}

/**
 * gst_cloth_saddles_get_refined:
 * @saddles: saddles
 * @n_refined: (out) (optional): how many
 *
 * Returns: (array length=n_refined) (transfer none): the refined saddles, valid as
 *   long as @saddles is
 *
 * Since: 0.1
 */
const GstClothSaddle *
gst_cloth_saddles_get_refined (const GstClothSaddles * saddles,
    guint * n_refined)
{
  if (n_refined)
    *n_refined = saddles->n_refined;
  return saddles->refined;
}

/**
 * gst_cloth_saddles_get_candidates:
 * @saddles: saddles
 * @n_candidates: (out) (optional): how many
 *
 * Returns: (array length=n_candidates) (transfer none): the candidates, valid as long
 *   as @saddles is
 *
 * Since: 0.1
 */
const GstClothCandidate *
gst_cloth_saddles_get_candidates (const GstClothSaddles * saddles,
    guint * n_candidates)
{
  if (n_candidates)
    *n_candidates = saddles->n_candidates;
  return saddles_candidates (saddles);
}

/**
 * gst_cloth_saddles_get_saddle:
 * @saddles: saddles
 * @index: which refined saddle
 * @saddle: (out caller-allocates): its copy
 *
 * Returns: %FALSE when @index is past the end
 *
 * Since: 0.1
 */
gboolean
gst_cloth_saddles_get_saddle (const GstClothSaddles * saddles, guint index,
    GstClothSaddle * saddle)
{
  if (index >= saddles->n_refined)
    return FALSE;
  *saddle = saddles->refined[index];
  return TRUE;
}

/**
 * gst_cloth_saddles_get_candidate:
 * @saddles: saddles
 * @index: which candidate
 * @candidate: (out caller-allocates): its copy
 *
 * Returns: %FALSE when @index is past the end
 *
 * Since: 0.1
 */
gboolean
gst_cloth_saddles_get_candidate (const GstClothSaddles * saddles, guint index,
    GstClothCandidate * candidate)
{
  if (index >= saddles->n_candidates)
    return FALSE;
  *candidate = saddles_candidates (saddles)[index];
  return TRUE;
}

/**
 * gst_cloth_saddles_get_points:
 * @saddles: saddles
 *
 * The refined saddles as an array of 32 bit floats of the host, shape
 * (n_refined, 7): x, y, response, axis, cov_xx, cov_xy, cov_yy. Nothing is copied.
 * From Python: `numpy.frombuffer (saddles.get_points ().get_data (),
 * numpy.float32).reshape (-1, 7)`.
 *
 * Returns: (transfer full): bytes that keep @saddles alive
 *
 * Since: 0.1
 */
GBytes *
gst_cloth_saddles_get_points (GstClothSaddles * saddles)
{
  return g_bytes_new_with_free_func (saddles->refined,
      saddles->n_refined * sizeof (GstClothSaddle), g_atomic_rc_box_release,
      gst_cloth_saddles_ref (saddles));
}

/**
 * gst_cloth_saddles_scale:
 * @saddles: saddles
 * @scale_x: new width over old width, over 0
 * @scale_y: new height over old height, over 0
 *
 * The saddles of the same picture at another size: x' = (x + ½)·@scale_x − ½, the
 * covariance and the response in the new pixels; the axis as it is for squares seen
 * at right angles.
 *
 * Returns: (transfer full): new saddles
 *
 * Since: 0.1
 */
GstClothSaddles *
gst_cloth_saddles_scale (const GstClothSaddles * saddles, gdouble scale_x,
    gdouble scale_y)
{
  return gst_cloth_payload_scale ((const GstClothPayload *) saddles, scale_x,
      scale_y);
}

/**
 * gst_cloth_saddles_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_saddles_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothSaddlesMetaAPI", TRUE);
}

/**
 * gst_cloth_saddles_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_saddles_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_saddles_meta_api_get_type (), "GstClothSaddlesMeta");
}

/**
 * gst_buffer_add_cloth_saddles_meta:
 * @buffer: a writable buffer
 * @saddles: (transfer full): what was seen in its picture
 *
 * Puts @saddles on @buffer, in place of those it may have had.
 *
 * Returns: (transfer none): the meta that now holds @saddles
 *
 * Since: 0.1
 */
GstClothSaddlesMeta *
gst_buffer_add_cloth_saddles_meta (GstBuffer * buffer,
    GstClothSaddles * saddles)
{
  return gst_cloth_payload_attach (saddles, buffer,
      gst_cloth_saddles_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_saddles:
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the saddles on @buffer, owned by it; %NULL
 *   when it has none
 *
 * Since: 0.1
 */
GstClothSaddles *
gst_buffer_get_cloth_saddles (GstBuffer * buffer)
{
  return gst_cloth_payload_find (buffer,
      gst_cloth_saddles_meta_api_get_type ());
}
