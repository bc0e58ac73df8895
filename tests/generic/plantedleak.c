/* Leaks one pad on purpose, so that leaks.py can prove that the tracer sees it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/gst.h>

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  gst_object_ref_sink (gst_pad_new ("planted", GST_PAD_SRC));
  gst_deinit ();
  return 0;
}
