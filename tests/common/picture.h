/* Grey pictures out of JPEG and PNG files, decoded by GStreamer.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

/* A picture that owns its pixels. */
typedef struct
{
  ClothImage image;
  guint8 *data;
} TestPicture;

void test_picture_init (gint * argc, gchar *** argv);
TestPicture *test_picture_new (gint width, gint height, guint8 grey);
TestPicture *test_picture_load (const gchar * path);
TestPicture *test_picture_copy (const TestPicture * picture);
void test_picture_disc (TestPicture * picture, gdouble x, gdouble y,
    gdouble radius, gint grey, guint32 seed);
void test_picture_keep (const gchar * name, const guint8 * data, gint width,
    gint height);
void test_picture_free (TestPicture * picture);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (TestPicture, test_picture_free)
G_END_DECLS
