/* Sink pads of the elements that join several streams: the frame at the head of each, and
 * whether its time can be believed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>
#include <gst/base/gstaggregator.h>

G_BEGIN_DECLS

#define GST_CLOTH_SYNC_MAX_PADS 64

#define GST_TYPE_CLOTH_SYNC_PAD (gst_cloth_sync_pad_get_type ())
#define GST_CLOTH_SYNC_PAD(obj) (G_TYPE_CHECK_INSTANCE_CAST ((obj), \
    GST_TYPE_CLOTH_SYNC_PAD, GstClothSyncPad))
typedef struct _GstClothSyncPad GstClothSyncPad;
typedef struct _GstClothSyncPadClass GstClothSyncPadClass;

/* @parent: the parent
 * @index: what the pad is known by in the methods of #GstClothSyncClass
 * @period: of a frame, by the caps; %GST_CLOCK_TIME_NONE when they don't say
 * @used: frames that came into sets
 * @missing: sets that went without the pad
 * @dropped: frames that came too late
 * @implausible: frames whose time the next one did not bear out
 * @lacked: sets that went without the pad since the start or the last flush
 * @late: frames that came after their set's deadline, likewise
 * @camera_name: of the camera that its frames are of, %NULL while that isn't known
 * @was_silent: it has been, likewise
 * @silent: nothing has come for a while; with the counts under the element's object lock
 *
 * A sink pad. A subclass of #GstClothSync that gives its pads properties derives them from
 * this type and names its own in the pad template; all fields are the base's.
 */
struct _GstClothSyncPad {
  GstAggregatorPad parent;

  guint index;
  GstClockTime period;
  guint64 used, missing, dropped, implausible;
  guint64 lacked, late;
  gchar *camera_name;
  gboolean silent, was_silent;

  /*< private > */
  /* object lock of the pad */
  GstBuffer *held;              /* too far ahead: waits for the next frame's word */
  GstClockTimeDiff held_time;   /* by the segment that it came with */
  gboolean believed;            /* the held one is the head */
  GstClockTimeDiff expected;    /* since when silence counts; NONE: not yet */
  GstClockTimeDiff last;        /* the latest time believed; NONE: none yet */
  guint64 interval;             /* from the time before to @last */
  guint n_flushes;

  /* streaming thread of the element */
  GstEvent *caps;               /* came after @held, and counts once that one is gone */
  gboolean warned_ahead, warned_back, warned_untimed, warned_late;
};

struct _GstClothSyncPadClass {
  GstAggregatorPadClass parent_class;
};

/* What is to be done about the times of a pad.
 *
 * @GST_CLOTH_SYNC_KEEP: nothing
 * @GST_CLOTH_SYNC_HOLD: the head is too far ahead: it waits for the next frame
 * @GST_CLOTH_SYNC_BELIEVE: the frame held is borne out: it is the head
 * @GST_CLOTH_SYNC_REFUSE: the frame held is not borne out: it goes
 */
typedef enum {
  GST_CLOTH_SYNC_KEEP,
  GST_CLOTH_SYNC_HOLD,
  GST_CLOTH_SYNC_BELIEVE,
  GST_CLOTH_SYNC_REFUSE
} GstClothSyncVerdict;

GType gst_cloth_sync_pad_get_type (void);

/* Returns: (transfer full): the sink pads of @element */
GList *gst_cloth_sync_pad_list (GstElement * element);

/* @time: (out): common time of the frame, when that is known already, else
 *   %GST_CLOCK_STIME_NONE
 *
 * Returns: (transfer full) (nullable): the frame at the head, which stays there
 */
GstBuffer *gst_cloth_sync_pad_look (GstClothSyncPad * pad,
    GstClockTimeDiff * time);

/* Whether a frame is held, or was and is the head. */
gboolean gst_cloth_sync_pad_is_holding (GstClothSyncPad * pad);

/* Returns: (transfer full) (nullable): the frame at the head */
GstBuffer *gst_cloth_sync_pad_take (GstClothSyncPad * pad);

/* @time: common time of the head, a valid one; %GST_CLOCK_STIME_NONE: there is no head
 * @start: what the first frame of a pad is measured from
 * @max_jump: how far a frame may lie ahead without being doubted, ns
 *
 * A frame is doubted when it lies more than @max_jump ahead of the one before it on its
 * pad, and more than twice as far as that one did of its own predecessor. It is believed
 * when the next frame comes after it and is no farther from it than the two bounds, or the
 * jump itself, allow; at the end of the stream when the jump is of a day at most, which of
 * damaged time stamps hardly any is. So a damaged time stamp costs its frame, and a pause
 * costs nothing.
 *
 * Returns: what to do
 */
GstClothSyncVerdict gst_cloth_sync_pad_judge (GstClothSyncPad * pad,
    GstClockTimeDiff time, GstClockTimeDiff start, GstClockTime max_jump);

/* Notes that the head is kept for its time; @end: when what it says ends, of a frame @time
 * as well. */
void gst_cloth_sync_pad_note (GstClothSyncPad * pad, GstClockTimeDiff time,
    GstClockTimeDiff end);

/* From @now on the pad is expected to give something, if it wasn't before. */
void gst_cloth_sync_pad_expect (GstClothSyncPad * pad, GstClockTimeDiff now);

/* Returns: from when on the pad has given nothing; GST_CLOCK_STIME_NONE: nothing was expected */
GstClockTimeDiff gst_cloth_sync_pad_silent_since (GstClothSyncPad * pad);

/* Returns: how long a pad gives nothing before that is said */
GstClockTime gst_cloth_sync_pad_patience (const GstClothSyncPad * pad);

/* Method clip of the aggregator: what of @buffer is within the pad's segment, %NULL for none. */
GstBuffer *gst_cloth_sync_pad_clip (GstAggregator * agg,
    GstAggregatorPad * aggpad, GstBuffer * buffer);

/* Returns: whether times can be told by the segment of @event; else @element has posted the
 * error */
gboolean gst_cloth_sync_pad_check_segment (GstClothSyncPad * pad,
    GstElement * element, GstEvent * event);

/* Returns: how often the pad was flushed */
guint gst_cloth_sync_pad_count_flushes (GstClothSyncPad * pad);

/* Holds @buffer (transfer full), taken from the head; @time: its common time; @n_flushes:
 * counted before it was taken. What a flush came after is dropped. */
void gst_cloth_sync_pad_hold (GstClothSyncPad * pad, GstBuffer * buffer,
    GstClockTimeDiff time, guint n_flushes);

void gst_cloth_sync_pad_believe (GstClothSyncPad * pad);
void gst_cloth_sync_pad_refuse (GstClothSyncPad * pad);

/* The common clock of pad @index of @element was @before and is @after a stream's: so is the time of a frame that is
 * held. */
void gst_cloth_sync_pads_shift_held (GstElement * element, guint index,
    GstClockTimeDiff before, GstClockTimeDiff after);

/* Returns: 1 for a set of @element that lacks @pad, 0 when there is no pad */
guint gst_cloth_sync_pad_count_missing (GstClothSyncPad * pad,
    GstElement * element);

/* The stream begins anew: forgets all times, what is held, and what was counted since. */
void gst_cloth_sync_pad_restart (GstClothSyncPad * pad, GstElement * element);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothSyncPad, gst_object_unref)
/* What is told of a pad, under the element's lock: its usual time from frame to frame by its caps,
 * and the name of its camera. */
void gst_cloth_sync_pad_set_period (GstClothSyncPad * pad,
    GstElement * element, const GstCaps * caps);
void gst_cloth_sync_pad_set_camera (GstClothSyncPad * pad,
    GstElement * element, const gchar * name);

G_END_DECLS
