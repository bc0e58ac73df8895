/* pattern.json of any print: from a scan of the cloth, or of a sheet that was drawn.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/pattern-picture.h"

#include <stdlib.h>
#include <string.h>

#include "gst/file/output.h"
#include "gst/vision/match/match.h"
#include "tools/frames.h"
#include "tools/tool.h"

typedef struct
{
  gint width, height;
  guint8 *grey;
} Picture;

static gboolean
keep_picture (const ClothImage * image, guint number, gpointer user_data,
    GError ** error)
{
  Picture *picture = user_data;

  picture->width = image->width;
  picture->height = image->height;
  picture->grey = g_malloc ((gsize) image->width * image->height);
  for (gint y = 0; y < image->height; y++)
    memcpy (picture->grey + (gsize) y * image->width,
        image->data + (gsize) y * image->stride, (gsize) image->width);
  return FALSE;                 /* the first is enough */
}

/* How many features the print has and which share of them it has elsewhere too; FALSE when
 * nothing can be matched to it. */
static gboolean
tell_features (const ClothPicturePattern * pattern, const guint8 * grey,
    gint width, gint height, GError ** error)
{
  const ClothCvPicture flat = { grey, width, height, width };
  ClothReferenceParams params = cloth_reference_default_params ();
  ClothPool *pool = cloth_pool_new (g_get_num_processors ());
  const ClothReferenceFeatures *features;
  g_autoptr (ClothReference) reference = NULL;
  gdouble repeated;
  guint n = 0;

  params.sides = pattern->sides;
  params.cloth_m[0] = pattern->cloth_m[0];
  params.cloth_m[1] = pattern->cloth_m[1];
  reference = cloth_reference_new (&params, &flat, pool, error);
  cloth_pool_free (pool);
  if (!reference)
    return FALSE;
  features = cloth_reference_get_features (reference);
  for (guint i = 0; i < features->n; i++)
    n += features->view[i] == 0 && features->side[i] == 0;
  repeated = cloth_reference_get_repeated (reference);
  g_printerr ("%u features, %.0f%% of them repeated elsewhere on the print\n",
      n, 100 * repeated);
  if (repeated >= CLOTH_REFERENCE_REPEATED)
    g_printerr
        ("Warning: most of this print is repeated, so its places can't be "
        "told from each other. Take a cloth whose print does not repeat, or film "
        "and scan only one repeat of it.\n");
  return TRUE;
}

/* The picture under a name in the pattern's own folder: itself when it lies there, else a
 * copy; FALSE when it can't be made. */
static gchar *
bring_reference (const gchar * scan, const gchar * output, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (output);
  g_autofree gchar *from = g_path_get_dirname (scan);
  g_autofree gchar *base = g_path_get_basename (scan);
  g_autofree gchar *name = NULL, *data = NULL;
  g_autofree gchar *copy = NULL;
  const gchar *ending = strrchr (base, '.');
  char *here = realpath (folder, NULL), *there = realpath (from, NULL);
  const gboolean same = here && there && !strcmp (here, there);
  gsize size;

  free (here);
  free (there);
  if (same)
    return g_strdup (scan);
  name = g_strconcat ("reference", ending ? ending : "", NULL);
  copy = g_build_filename (folder, name, NULL);
  if (!g_file_get_contents (scan, &data, &size, error)
      || !cloth_file_write (copy, data, size, error))
    return NULL;
  return g_steal_pointer (&copy);
}

gint
pattern_from_scan (const PrintedPicture * printed, const gchar * scan)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPicturePattern) pattern = NULL;
  g_autofree guint8 *grey = NULL;
  g_autofree gchar *reference = NULL;
  gdouble cloth_m[2] = { printed->cloth_m[0], printed->cloth_m[1] };
  Picture picture = { 0 };

  if (!cloth_frames_read (scan, 1, keep_picture, &picture, &error))
    return complain (FAILED, "%s", error->message);
  grey = picture.grey;
  if (cloth_m[1] == 0)
    cloth_m[1] = cloth_m[0] * picture.height / picture.width;
  pattern = cloth_picture_pattern_new (scan, cloth_m, printed->columns,
      printed->rows, printed->sides, &error);
  if (!pattern)
    return complain (BAD_USAGE, "%s", error->message);
  if (!tell_features (pattern, grey, picture.width, picture.height, &error))
    return complain (FAILED, "%s: %s", scan, error->message);
  if (!(reference = bring_reference (scan, printed->output, &error)))
    return complain (FAILED, "%s", error->message);
  g_free (pattern->reference);
  pattern->reference = g_strdup (reference);
  if (!cloth_picture_pattern_save (pattern, printed->output, &error))
    return complain (FAILED, "%s", error->message);
  if (strcmp (reference, scan))
    g_print ("%s\n", reference);
  g_print ("%s\n", printed->output);
  return DONE;
}

gint
pattern_from_sheet (ClothPicturePattern * pattern, const ClothSheet * sheet,
    const gchar * json)
{
  g_autofree gchar *folder = g_path_get_dirname (json);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTexture) texture = cloth_sheet_texture (sheet, &error);
  g_autoptr (GBytes) png = NULL;

  if (!texture || !(png = cloth_texture_to_png (texture, &error)))
    return complain (FAILED, "%s", error->message);
  g_free (pattern->reference);
  pattern->reference = strcmp (folder, ".")
      ? g_build_filename (folder, "reference.png", NULL)
      : g_strdup ("reference.png");
  if (!tell_features (pattern, texture->data, texture->width, texture->height,
          &error)
      || !cloth_file_write (pattern->reference, g_bytes_get_data (png, NULL),
          g_bytes_get_size (png), &error)
      || !cloth_picture_pattern_save (pattern, json, &error))
    return complain (FAILED, "%s", error->message);
  g_print ("%s\n%s\n", pattern->reference, json);
  return DONE;
}
