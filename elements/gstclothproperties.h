/* Properties of elements, from tables.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

/* GST_TYPE_FRACTION is known at run time only. */
#define GST_CLOTH_TYPE_FRACTION G_TYPE_FUNDAMENTAL_MAX

/* Where a property's value is kept: a member of the element's settings, which are a struct
 * of the element's own or the algorithm's parameters. */
#define GST_CLOTH_SETTING(struct_type, member) \
    G_STRUCT_OFFSET (struct_type, member), G_SIZEOF_MEMBER (struct_type, member)

/* @name: as in gst-inspect, and so are @nick and @blurb
 * @type: of the value, and of the member that keeps it:
 *   %G_TYPE_BOOLEAN in a gboolean, %G_TYPE_INT in a gint, %G_TYPE_UINT in a guint,
 *   %G_TYPE_UINT64 in a guint64, %G_TYPE_FLOAT in a gfloat,
 *   %G_TYPE_DOUBLE in a gdouble or a gfloat,
 *   %G_TYPE_ENUM in any enum,
 *   %G_TYPE_STRING in a gchar *, a copy that the settings own,
 *   %GST_CLOTH_TYPE_FRACTION in a gint[2], numerator and denominator
 * @offset: of the member in the settings; GST_CLOTH_SETTING() gives it and @size
 * @size: of the member
 * @flags: when the property may be set: GST_PARAM_MUTABLE_…, GST_PARAM_CONTROLLABLE; one of
 *   %GST_PARAM_MUTABLE_READY is refused while the element runs. %G_PARAM_READABLE: it can
 *   only be read; all others are readable and writable
 * @minimum: of numbers; a %G_TYPE_UINT64 takes all that fit, a fraction any from 0 on
 * @maximum: see @minimum
 * @enum_name: of the GType that is registered for @enum_values; tables may share it
 * @enum_values: of an enum, the last one all 0
 *
 * One property. Its default is what the member has in the default settings.
 */
typedef struct {
  const gchar *name, *nick, *blurb;
  GType type;
  gsize offset, size;
  GParamFlags flags;
  gdouble minimum, maximum;
  const gchar *enum_name;
  const GEnumValue *enum_values;
} GstClothProperty;

/* In class_init: installs @properties with ids from 1 on, and sets the class's
 * set_property and get_property to the two below. @defaults are the settings that every
 * instance begins with; @settings_offset is where an instance has its own, from the instance's address on. An element that
 * does more when a property is set, or has properties of other kinds, overrides the two
 * afterwards and calls them from its own. */
void gst_cloth_install_properties (GObjectClass * klass,
    const GstClothProperty * properties, guint n_properties,
    gconstpointer defaults, gssize settings_offset);

/* Both take the object's lock. */
void gst_cloth_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * spec);
void gst_cloth_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * spec);

/* In finalize: frees the strings. */
void gst_cloth_clear_settings (const GstClothProperty * properties,
    guint n_properties, gpointer settings);

G_END_DECLS
