/* Jobs in a folder that several processes share, on one host or on many.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

/* Seconds without a sign of life after which a worker on another host is lost. File systems of
 * networks show changes up to half a minute late. */
#define CLOTH_SPOOL_LOST_S 60.
/* A job that lost so many workers has failed: it is what ends them. */
#define CLOTH_SPOOL_MOST_LOST 3

/* One end of a spool: a manager's or a worker's. */
typedef struct _ClothSpool ClothSpool;

/* @kind: what the jobs are; workers of other kinds are refused
 * @version: of the program: results of others may differ, so they are refused as well
 * @lost_s: seconds without a sign of life after which a worker is lost, 0 for
 *   %CLOTH_SPOOL_LOST_S
 */
typedef struct {
  const gchar *kind;
  const gchar *version;
  gdouble lost_s;
} ClothSpoolOptions;

/* @id: of the job
 * @json: of a worker's job what to do, of a manager's what came of it
 * @failed: it did not work, and @json says why
 */
typedef struct {
  gchar *id;
  gchar *json;
  gboolean failed;
} ClothSpoolJob;

/* @CLOTH_SPOOL_OPEN: there may be more jobs
 * @CLOTH_SPOOL_CLOSED: all is done
 * @CLOTH_SPOOL_ABANDONED: there is no manager, and no job
 */
typedef enum {
  CLOTH_SPOOL_OPEN,
  CLOTH_SPOOL_CLOSED,
  CLOTH_SPOOL_ABANDONED
} ClothSpoolState;

ClothSpool *cloth_spool_manage (const gchar * folder,
    const ClothSpoolOptions * options, const gchar * problem, gboolean resume,
    GError ** error);
gboolean cloth_spool_put (ClothSpool * spool, const gchar * id,
    const gchar * json, gboolean again, GError ** error);
ClothSpoolJob *cloth_spool_take (ClothSpool * spool, GError ** error);
gboolean cloth_spool_look_after (ClothSpool * spool, GError ** error);
guint cloth_spool_get_n_lost (const ClothSpool * spool);
gchar *cloth_spool_begin_notes (ClothSpool * spool, GError ** error);
gboolean cloth_spool_note (ClothSpool * spool, const gchar * lines,
    GError ** error);
gboolean cloth_spool_close (ClothSpool * spool, GError ** error);

ClothSpool *cloth_spool_join (const gchar * folder,
    const ClothSpoolOptions * options, gdouble wait_s, GError ** error);
ClothSpoolJob *cloth_spool_claim (ClothSpool * spool, GError ** error);
gboolean cloth_spool_finish (ClothSpool * spool, const ClothSpoolJob * job,
    const gchar * json, gboolean failed, GError ** error);
gboolean cloth_spool_give_back (ClothSpool * spool, const ClothSpoolJob * job,
    GError ** error);
ClothSpoolState cloth_spool_get_state (ClothSpool * spool);

void cloth_spool_wait (ClothSpool * spool);
void cloth_spool_job_free (ClothSpoolJob * job);
void cloth_spool_free (ClothSpool * spool);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSpoolJob, cloth_spool_job_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSpool, cloth_spool_free)
G_END_DECLS
