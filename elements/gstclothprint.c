/* Features of prints, looked at once for all elements that follow the same one: that takes
 * seconds and tens of megabytes, and each camera of a rig has an element of its own.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothprint.h"

typedef struct
{
  gchar *key;
  ClothReference *reference;
  guint n_users;
} Print;

/* Held while a print is looked at: who asks for it meanwhile waits for that one. */
static GMutex lock;
static GSList *prints;          /* Print; those in use only */

/* What decides on the features: each parameter and pixel. */
static gchar *
make_key (const ClothReferenceParams * params, const ClothCvPicture * picture)
{
  const gdouble numbers[] = { params->sides, params->oblique,
    params->cloth_m[0], params->cloth_m[1], params->least_scale,
    params->seed_scale, params->sift.n_layers, params->sift.contrast,
    params->sift.edge, params->sift.sigma, params->noise, picture->width,
    picture->height
  };
  g_autoptr (GChecksum) sum = g_checksum_new (G_CHECKSUM_SHA256);

  g_checksum_update (sum, (const guchar *) numbers, sizeof numbers);
  for (gint y = 0; y < picture->height; y++)
    g_checksum_update (sum, picture->data + (gsize) y * picture->stride,
        picture->width);
  return g_strdup (g_checksum_get_string (sum));
}

/* @params: how features are looked for
 * @picture: the flat print
 * @pool: that looks
 * @error: return location
 *
 * Returns: (transfer full) (nullable): the print's features, shared with all who asked for the
 *   same; give back with gst_cloth_print_release (). %NULL: as of cloth_reference_new ()
 */
const ClothReference *
gst_cloth_print_acquire (const ClothReferenceParams * params,
    const ClothCvPicture * picture, ClothPool * pool, GError ** error)
{
  g_autofree gchar *key = make_key (params, picture);
  ClothReference *reference = NULL;
  GSList *at;

  g_mutex_lock (&lock);
  for (at = prints; at; at = at->next) {
    Print *print = at->data;

    if (g_str_equal (print->key, key)) {
      print->n_users++;
      reference = print->reference;
      break;
    }
  }
  if (!reference)
    reference = cloth_reference_new (params, picture, pool, error);
  if (reference && !at) {
    Print *print = g_new (Print, 1);

    *print = (Print) {
    g_steal_pointer (&key), reference, 1};
    prints = g_slist_prepend (prints, print);
  }
  g_mutex_unlock (&lock);
  return reference;
}

/* @reference: (transfer full): features of gst_cloth_print_acquire ()
 *
 * The last one who gives them back frees them.
 */
void
gst_cloth_print_release (const ClothReference * reference)
{
  g_mutex_lock (&lock);
  for (GSList * at = prints; at; at = at->next) {
    Print *print = at->data;

    if (print->reference != reference)
      continue;
    if (--print->n_users == 0) {
      prints = g_slist_delete_link (prints, at);
      cloth_reference_free (print->reference);
      g_free (print->key);
      g_free (print);
    }
    break;
  }
  g_mutex_unlock (&lock);
}
