/* clothgap: what it posts on the bus.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothgap-post.h"

#include "gst/gap/report/report.h"

void
gst_cloth_gap_post_score (GstElement * element,
    const ClothObserverScore * score)
{
  GST_DEBUG_OBJECT (element, "%.3f s … %.3f s: %.2f mm, %.0f%% seen",
      score->from_s, score->to_s, 1000 * score->rms, 100 * score->coverage);
  gst_element_post_message (element,
      gst_message_new_element (GST_OBJECT (element),
          gst_structure_new ("clothgap/score",
              "time", G_TYPE_UINT64, (guint64) (score->from_s * 1e9 + 0.5),
              "duration", G_TYPE_UINT64,
              (guint64) ((score->to_s - score->from_s) * 1e9 + 0.5),
              "rms", G_TYPE_DOUBLE, score->rms,
              "coverage", G_TYPE_DOUBLE, score->coverage, NULL)));
}

gboolean
gst_cloth_gap_post_verdict (GstElement * element, const ClothGapResult * result,
    const gchar * output, GError ** error)
{
  const gchar *verdict = cloth_gap_verdict_name (result->verdict);
  g_autofree gchar *summary = cloth_gap_result_summary (result);
  g_autofree gchar *json = cloth_gap_result_to_json (result);
  GstStructure *structure = gst_structure_new ("clothgap/verdict",
      "verdict", G_TYPE_STRING, verdict, "summary", G_TYPE_STRING, summary,
      "json", G_TYPE_STRING, json, NULL);

  GST_INFO_OBJECT (element, "%s: %s", verdict, summary);
  if (output) {
    g_autofree gchar *report = g_build_filename (output, "report.html", NULL);

    if (!cloth_gap_result_write (result, output, error)) {
      gst_structure_free (structure);
      return FALSE;
    }
    gst_structure_set (structure, "report", G_TYPE_STRING, report, NULL);
  }
  gst_element_post_message (element,
      gst_message_new_element (GST_OBJECT (element), structure));
  return TRUE;
}
