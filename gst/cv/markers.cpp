/* OpenCV's ArUco markers, as on ChArUco boards, as plain C functions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cv/markers.h"

#include "gst/cv/guard-private.h"

/* Since 4.7 they are in objdetect, before that in a library of their own. */
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7)
#include <opencv2/objdetect/aruco_detector.hpp>
#define NEW_API 1
#else
#include <opencv2/aruco.hpp>
#define NEW_API 0
#endif

#include <memory>
#include <vector>

#define DICTIONARY(name) { #name, cv::aruco::DICT_ ## name }

static const struct
{
  const gchar *name;
  int id;
} dictionaries[] = {
  DICTIONARY (4X4_50), DICTIONARY (4X4_100), DICTIONARY (4X4_250),
  DICTIONARY (4X4_1000), DICTIONARY (5X5_50), DICTIONARY (5X5_100),
  DICTIONARY (5X5_250), DICTIONARY (5X5_1000), DICTIONARY (6X6_50),
  DICTIONARY (6X6_100), DICTIONARY (6X6_250), DICTIONARY (6X6_1000),
  DICTIONARY (7X7_50), DICTIONARY (7X7_100), DICTIONARY (7X7_250),
  DICTIONARY (7X7_1000), DICTIONARY (ARUCO_ORIGINAL),
  DICTIONARY (APRILTAG_16h5), DICTIONARY (APRILTAG_25h9),
  DICTIONARY (APRILTAG_36h10), DICTIONARY (APRILTAG_36h11),
};

struct _ClothCvMarkers
{
#if NEW_API
  cv::aruco::Dictionary dictionary;
  cv::aruco::ArucoDetector detector;
#else
  cv::Ptr < cv::aruco::Dictionary > dictionary;
#endif
  std::vector < int >ids;
  std::vector < gfloat > corners;
};

/* @dictionary: one of OpenCV's, by its name with or without “DICT_” and in any case, for instance 5x5_100
 * @error: %CLOTH_CV_ERROR_PARAMETER, when there is none of this name; it lists them
 *
 * Returns: (transfer full) (nullable): what finds its markers
 */
ClothCvMarkers *
cloth_cv_markers_new (const gchar * dictionary, GError ** error)
{
  const gchar *name = g_ascii_strncasecmp (dictionary, "DICT_", 5) ? dictionary
      : dictionary + 5;
  GString *names = g_string_new (NULL);
  ClothCvMarkers *markers = NULL;

  for (const auto & known : dictionaries) {
    g_string_append_printf (names, "%s%s", names->len ? ", " : "", known.name);
    if (g_ascii_strcasecmp (name, known.name))
      continue;
    guard (error, [&]() {
          std::unique_ptr < ClothCvMarkers > made (new ClothCvMarkers);

          made->dictionary = cv::aruco::getPredefinedDictionary (known.id);
#if NEW_API
          made->detector = cv::aruco::ArucoDetector (made->dictionary);
#endif
          markers = made.release ();
        });
    g_string_free (names, TRUE);
    return markers;
  }
  g_set_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER,
      "there is no dictionary of markers named %s; there are %s", dictionary,
      names->str);
  g_string_free (names, TRUE);
  return NULL;
}

/* @markers: what finds them
 *
 * Returns: how many markers its dictionary has; they are numbered from 0
 */
guint
cloth_cv_markers_get_size (const ClothCvMarkers * markers)
{
#if NEW_API
  return static_cast < guint > (markers->dictionary.bytesList.rows);
#else
  return static_cast < guint > (markers->dictionary->bytesList.rows);
#endif
}

/* @markers: what finds them
 * @picture: where
 * @n: (out): how many there are
 * @ids: (out) (transfer none) (array length=n): their numbers in the dictionary
 * @corners: (out) (transfer none) (array): of each the top left corner, as it is printed,
 *   and the others clockwise, x and y, px, [n][4][2]
 * @error: what OpenCV had against the picture
 *
 * Both arrays are valid until the next call.
 *
 * Returns: whether the picture could be looked at
 */
gboolean
cloth_cv_markers_find (ClothCvMarkers * markers,
    const ClothCvPicture * picture, guint * n, const gint ** ids,
    const gfloat ** corners, GError ** error)
{
  std::vector < std::vector < cv::Point2f >> found;
  gboolean good = guard (error,[&]() {
        cv::Mat image (picture->height, picture->width, CV_8UC1,
            const_cast < guint8 * >(picture->data), picture->stride);

        markers->ids.clear ();
        markers->corners.clear ();
#if NEW_API
        markers->detector.detectMarkers (image, found, markers->ids);
#else
        cv::aruco::detectMarkers (image, markers->dictionary, found,
            markers->ids);
#endif
        for (const auto & marker : found)
          for (const auto & corner : marker) {
            markers->corners.push_back (corner.x);
            markers->corners.push_back (corner.y);
          }
      });

  *n = static_cast < guint > (markers->ids.size ());
  *ids = markers->ids.data ();
  *corners = markers->corners.data ();
  return good;
}

/* @markers: (transfer full): what found them
 */
void
cloth_cv_markers_free (ClothCvMarkers * markers)
{
  delete markers;
}
