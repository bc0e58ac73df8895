/* What every caller of the diagnosis checks: the names of effects as people type them, and
 * that two cloths are the same one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inputs.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/effect/effect.h"

/* Longest text that is compared with names. */
#define LONGEST_NAME 64
#define MOST_GUESSES 3
/* A name is near another when a third of its letters differ, or fewer. */
#define NEAR 3
/* Of the cloth's size: sheets that differ by less are the same one. */
#define SIZE_SLACK 0.01

/* Levenshtein's distance: letters to insert, drop or replace. */
static guint
distance (const gchar * a, const gchar * b)
{
  guint row[LONGEST_NAME + 1];
  gsize n_a = strlen (a), n_b = strlen (b);

  if (n_a > LONGEST_NAME || n_b > LONGEST_NAME)
    return G_MAXUINT;
  for (guint j = 0; j <= n_b; j++)
    row[j] = j;
  for (guint i = 1; i <= n_a; i++) {
    guint diagonal = row[0];

    row[0] = i;
    for (guint j = 1; j <= n_b; j++) {
      guint replaced = diagonal + (a[i - 1] != b[j - 1]);

      diagonal = row[j];
      row[j] = MIN (replaced, MIN (row[j], row[j - 1]) + 1);
    }
  }
  return row[n_b];
}

/* The names nearest to @id, or NULL when none is near. A name that is part of the other
 * counts as near: "drag", "air drag". */
static gchar *
guess (const gchar * id)
{
  g_autofree gchar *typed = g_strdelimit (g_ascii_strdown (id, -1), "- ", '_');
  guint n, found = 0, limit = MAX ((guint) strlen (typed) / NEAR, 1);
  const ClothEffect *const *table = cloth_effect_table (&n);
  g_autoptr (GString) text = g_string_new (NULL);

  for (guint d = 0; d <= limit && found < MOST_GUESSES; d++) {
    for (guint i = 0; i < n && found < MOST_GUESSES; i++) {
      const gchar *name = table[i]->id;
      gboolean part = *typed && (strstr (name, typed) || strstr (typed, name));

      if (part ? d != 0 : distance (typed, name) != d)
        continue;
      g_string_append_printf (text, "%s“%s”", found ? ", " : "", name);
      found++;
    }
  }
  return found ? g_string_free (g_steal_pointer (&text), FALSE) : NULL;
}

/* @list: (nullable): ids of effects with commas between them; %NULL or "": all
 * @error: #ClothFitError
 *
 * Returns: (transfer full) (nullable) (array zero-terminated=1): the ids, each once, as
 *   cloth_gap_diagnose () takes them; %NULL for all, or with @error set when one is not
 *   known: it names those that may be meant
 */
gchar **
cloth_gap_effects_parse (const gchar * list, GError ** error)
{
  g_auto (GStrv) words = g_strsplit (list ? list : "", ",", -1);
  g_autoptr (GPtrArray) ids = g_ptr_array_new_with_free_func (g_free);

  for (guint i = 0; words[i]; i++) {
    const gchar *id = g_strstrip (words[i]);
    g_autofree gchar *near = NULL;

    if (!*id)
      continue;
    if (cloth_effect_find (id)) {
      if (!g_ptr_array_find_with_equal_func (ids, id, g_str_equal, NULL))
        g_ptr_array_add (ids, g_strdup (id));
      continue;
    }
    near = guess (id);
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_EFFECT,
        "there is no effect “%s”%s%s; “gst-cloth-gap-1.0 effects” lists them "
        "all", id, near ? ": is it " : "", near ? near : "");
    return NULL;
  }
  if (ids->len == 0)
    return NULL;
  g_ptr_array_add (ids, NULL);
  return (gchar **) g_ptr_array_free (g_steal_pointer (&ids), FALSE);
}

static void
find_size (const ClothTopology * cloth, gdouble size[2])
{
  for (guint k = 0; k < 2; k++) {
    gdouble low = INFINITY, high = -INFINITY;

    for (gsize i = 0; i < cloth->n_vertices; i++) {
      low = MIN (low, cloth->uv[2 * i + k]);
      high = MAX (high, cloth->uv[2 * i + k]);
    }
    size[k] = high - low;
  }
}

static gchar *
describe (const ClothTopology * cloth)
{
  if (cloth->columns > 0)
    return g_strdup_printf ("a grid of %u×%u vertices", cloth->columns,
        cloth->rows);
  return g_strdup_printf ("a mesh of %u vertices and %u faces",
      cloth->n_vertices, cloth->n_faces);
}

/* @name: what @cloth is called
 * @cloth: a cloth
 * @other_name: what @other is called
 * @other: another
 * @error: #ClothFitError
 *
 * Compares vertices, faces and, where both say it, the size on the flat cloth, to 1%.
 *
 * Returns: %TRUE when they are meshes of the same cloth
 */
gboolean
cloth_gap_check_same_cloth (const gchar * name, const ClothTopology * cloth,
    const gchar * other_name, const ClothTopology * other, GError ** error)
{
  gdouble size[2], other_size[2];
  gboolean same = cloth->n_vertices == other->n_vertices &&
      cloth->columns == other->columns && cloth->rows == other->rows;

  /* Of a grid the cells are known, whether or not they are listed. */
  if (same && cloth->columns == 0)
    same = cloth->n_faces == other->n_faces && memcmp (cloth->faces,
        other->faces, 4 * sizeof (guint32) * cloth->n_faces) == 0;
  if (!same) {
    g_autofree gchar *mesh = describe (cloth);
    g_autofree gchar *other_mesh = describe (other);

    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "%s is %s, %s is %s%s: they must be recorded with the same mesh of the "
        "same cloth", name, mesh, other_name, other_mesh,
        strcmp (mesh, other_mesh) == 0 ? " with other faces" : "");
    return FALSE;
  }
  find_size (cloth, size);
  find_size (other, other_size);
  for (guint k = 0; k < 2; k++) {
    gdouble most = SIZE_SLACK * MAX (size[k], other_size[k]);

    if (size[k] > 0 && other_size[k] > 0 &&
        fabs (size[k] - other_size[k]) > most) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
          "the cloth of %s is %g×%g m flat, that of %s %g×%g m: take the "
          "same cloth, and metres in both", name, size[0], size[1], other_name,
          other_size[0], other_size[1]);
      return FALSE;
    }
  }
  return TRUE;
}
