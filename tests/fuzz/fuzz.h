/* What the fuzz targets share: how they begin, and bytes that become numbers, folders and
 * elements.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

int LLVMFuzzerInitialize (int *argc, char ***argv);
int LLVMFuzzerTestOneInput (const guint8 * data, gsize size);

/* What is left of an input. Past its end all bytes are 0. */
typedef struct {
  const guint8 *data;
  gsize size;
} FuzzBytes;

guint8 fuzz_take_byte (FuzzBytes * bytes);
guint16 fuzz_take_short (FuzzBytes * bytes);
guint64 fuzz_take_long (FuzzBytes * bytes);
/* A place in a picture of @extent pixels, or a number that is none. */
gfloat fuzz_take_place (FuzzBytes * bytes, gfloat extent);
/* What is left, as a text. */
gchar *fuzz_take_text (FuzzBytes * bytes);

/* A folder of files packed into one input: each is the number of its name, its size in
 * three bytes, the lowest first, and its bytes. tests/fuzz/pack.py writes such inputs. */
gchar *fuzz_folder_new (const gchar * const *names, FuzzBytes * bytes);
void fuzz_folder_free (const gchar * const *names, gchar * folder);

G_END_DECLS
