/* What OpenCV throws becomes a GError.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <opencv2/core.hpp>

#include <exception>
#include <new>

#include "gst/cv/error.h"

/* Runs @work with OpenCV's threads off: no exception leaves it. */
template < typename Work > static gboolean
guard (GError ** error, Work work)
{
  try {
    static const bool once = (cv::setNumThreads (1), true);

    (void) once;
    work ();
    return TRUE;
  } catch (const std::bad_alloc &) {
    g_set_error_literal (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_FAILED,
        "OpenCV has not enough memory");
  } catch (const cv::Exception & e) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_FAILED,
        "OpenCV failed in %s: %s", e.func.c_str (), e.err.c_str ());
  } catch (const std::exception & e) {
    g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_FAILED,
        "OpenCV failed: %s", e.what ());
  } catch (...) {
    g_set_error_literal (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_FAILED,
        "OpenCV failed");
  }
  return FALSE;
}
