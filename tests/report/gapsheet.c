/* Writes gap.json and report.html of a made-up diagnosis for gapreport.py.
 *
 *   report-gapsheet KIND FOLDER
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/common/gapsheet.h"

/* A name of 3,000 characters without a place to break it. */
static gchar wordy[3001];

static ClothGapResult *
make (const gchar * kind)
{
  if (strcmp (kind, "sheet") == 0)
    return gap_sheet_new (33, 35, 250);
  if (strcmp (kind, "example") == 0)
    return gap_sheet_new (4, 3, 5);
  if (strcmp (kind, "long") == 0)
    return gap_sheet_new (65, 69, 400);
  if (strcmp (kind, "fine") == 0)
    return gap_sheet_new (101, 103, 60);
  if (strcmp (kind, "spare") == 0)
    return gap_sheet_new_spare ();
  if (strcmp (kind, "empty") == 0)
    return cloth_gap_result_new ();
  if (strcmp (kind, "unknown") == 0)
    return gap_sheet_new_unknown ();
  if (strcmp (kind, "calm") == 0)
    return gap_sheet_new_calm ();
  if (strcmp (kind, "wordy") == 0)
    return gap_sheet_new_hostile (wordy);
  if (strcmp (kind, "hostile") == 0)
    return gap_sheet_new_hostile ("</script><script>window.hacked=1</script>"
        "<img src=x onerror=window.hacked=1>\"'&\xff\n\xe2\x80\xa8<!--");
  return NULL;
}

int
main (int argc, char **argv)
{
  g_autoptr (ClothGapResult) result = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *json = NULL, *report = NULL;

  memset (wordy, 'w', sizeof wordy - 1);
  result = argc == 3 ? make (argv[1]) : NULL;
  if (!result) {
    fprintf (stderr,
        "usage: %s sheet|example|long|fine|spare|empty|unknown|calm|wordy|"
        "hostile FOLDER\n", argv[0]);
    return 2;
  }
  json = g_build_filename (argv[2], "gap.json", NULL);
  report = g_build_filename (argv[2], "report.html", NULL);
  if (!cloth_gap_result_write_json (result, json, &error) ||
      !cloth_gap_report_write (result, report, &error)) {
    fprintf (stderr, "%s\n", error->message);
    return 1;
  }
  return 0;
}
