/* The gst-cloth plugin: registers every element.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include <gst/gst.h>

#include "elements/gstclothcamera.h"
#include "elements/gstclothdisparity.h"
#include "elements/gstclothfit.h"
#include "elements/gstclothgap.h"
#include "elements/gstclothjson.h"
#include "elements/gstclothmetadepay.h"
#include "elements/gstclothmetapay.h"
#include "elements/gstclothoverlay.h"
#include "elements/gstclothsim.h"
#include "elements/gstdotlabel.h"
#include "elements/gstmeshfill.h"
#include "elements/gstmeshsink.h"
#include "elements/gstmeshsrc.h"
#include "elements/gstquadtrack.h"
#include "elements/gsttriangulate.h"
#include "elements/gstsaddledetect.h"
#include "elements/gstsiftmatch.h"
#include "elements/gstsilhouette.h"
#include "elements/gstuvmap.h"

static gboolean
plugin_init (GstPlugin * plugin)
{
  gboolean registered = TRUE;

  registered &= GST_ELEMENT_REGISTER (clothcamera, plugin);
  registered &= GST_ELEMENT_REGISTER (clothdisparity, plugin);
  registered &= GST_ELEMENT_REGISTER (clothfit, plugin);
  registered &= GST_ELEMENT_REGISTER (clothgap, plugin);
  registered &= GST_ELEMENT_REGISTER (clothjson, plugin);
  registered &= GST_ELEMENT_REGISTER (clothmetadepay, plugin);
  registered &= GST_ELEMENT_REGISTER (clothmetapay, plugin);
  registered &= GST_ELEMENT_REGISTER (clothoverlay, plugin);
  registered &= GST_ELEMENT_REGISTER (clothsim, plugin);
  registered &= GST_ELEMENT_REGISTER (dotlabel, plugin);
  registered &= GST_ELEMENT_REGISTER (meshfill, plugin);
  registered &= GST_ELEMENT_REGISTER (meshsink, plugin);
  registered &= GST_ELEMENT_REGISTER (meshsrc, plugin);
  registered &= GST_ELEMENT_REGISTER (quadtrack, plugin);
  registered &= GST_ELEMENT_REGISTER (triangulate, plugin);

  registered &= GST_ELEMENT_REGISTER (saddledetect, plugin);
  registered &= GST_ELEMENT_REGISTER (siftmatch, plugin);
  registered &= GST_ELEMENT_REGISTER (silhouette, plugin);
  registered &= GST_ELEMENT_REGISTER (uvmap, plugin);
  return registered;
}

GST_PLUGIN_DEFINE (GST_VERSION_MAJOR, GST_VERSION_MINOR, cloth,
    "Capture of moving cloth and diagnosis of cloth simulations",
    plugin_init, PACKAGE_VERSION, "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
