/* Whether the cameras of triangulate fit together: what a user should be told.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulatecheck.h"

#include <math.h>

#define WINDOW 25

void
gst_triangulate_check_add (GstTriangulateCheck * check, GstElement * element,
    const GstTriangulateBoard * board, const ClothRig * rig,
    const ClothTriangulateView * views, const ClothTriangulation * result)
{
  guint c, i, worst = 0, n_seeing = 0;
  const gchar *seeing = NULL;
  gdouble share = 0.;

  if (check->warned) {
    return;
  }
  for (c = 0; c < rig->n_cameras; c++) {
    check->seen[c] |= views[c].x != NULL;
    for (i = 0; i < result->n_points && views[c].x; i++) {
      if (isfinite (views[c].x[i])
          && result->reason[i] != CLOTH_POINT_FEW_VIEWS) {
        check->n_compared[c]++;
        check->n_left_out[c] += !(result->views[i] >> c & 1);
      }
    }
  }
  if (++check->n_sets % WINDOW) {
    return;
  }
  for (c = 0; c < rig->n_cameras; c++) {
    if (check->seen[c]) {
      seeing = rig->cameras[c].name;
      n_seeing++;
    }
  }
  if (n_seeing == 1) {
    check->warned = TRUE;
    GST_ELEMENT_WARNING (element, STREAM, FAILED,
        ("Only camera \"%s\" carries %s so far, so every vertex is unseen.",
            seeing, board->features),
        ("Link two or more cameras, each with %s before its sink pad.",
            board->detector));
    return;
  }
  if (n_seeing == 0) {
    check->warned = TRUE;
    GST_ELEMENT_WARNING (element, STREAM, FAILED,
        ("No picture so far carries %s, so every vertex is unseen.",
            board->features),
        ("Put %s before each sink pad, and nothing that drops metadata between "
            "them and it.", board->detector));
    return;
  }
  for (c = 0; c < rig->n_cameras; c++) {
    gdouble s = (gdouble) check->n_left_out[c] /
        (gdouble) MAX (check->n_compared[c], 1);

    if (s > share) {
      share = s;
      worst = c;
    }
    check->n_compared[c] = check->n_left_out[c] = 0;
  }
  if (share > 0.5) {
    check->warned = TRUE;
    GST_ELEMENT_WARNING_WITH_DETAILS (element, STREAM, FAILED,
        ("Camera \"%s\" contradicts the others on %.0f%% of the %s it sees.",
            rig->cameras[worst].name, 100. * share, board->features),
        ("See that each pad has its own camera and that the cameras stand as when "
            "rig was made; else calibrate again, or raise error-floor."),
        ("camera", G_TYPE_STRING, rig->cameras[worst].name, NULL));
  }
}
