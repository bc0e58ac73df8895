/* Buffers whose memory the processor can't read, as some devices have it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

G_DECLARE_FINAL_TYPE (FarAllocator, far_allocator, FAR, ALLOCATOR, GstAllocator);

struct _FarAllocator
{
  GstAllocator parent;
};

G_DEFINE_FINAL_TYPE (FarAllocator, far_allocator, GST_TYPE_ALLOCATOR);

static void
far_free (GstAllocator * allocator, GstMemory * memory)
{
  g_free (memory);
}

static gpointer
far_map (GstMemory * memory, gsize size, GstMapFlags flags)
{
  return NULL;
}

static void
far_allocator_class_init (FarAllocatorClass * class)
{
  GST_ALLOCATOR_CLASS (class)->free = far_free;
}

static void
far_allocator_init (FarAllocator * self)
{
  GST_ALLOCATOR (self)->mem_map = far_map;
}

static inline GstBuffer *
far_buffer (gsize size)
{
  GstAllocator *allocator = g_object_new (far_allocator_get_type (), NULL);
  GstMemory *memory = g_new0 (GstMemory, 1);
  GstBuffer *buffer = gst_buffer_new ();

  gst_memory_init (memory, 0, allocator, NULL, size, 0, 0, size);
  gst_buffer_append_memory (buffer, memory);
  gst_object_unref (allocator);
  return buffer;
}
