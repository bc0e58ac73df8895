/* Properties of elements, from tables.
 *
 * A GParamSpec made here carries its line of the table and the place of the settings in the
 * instance, so that one pair of functions serves all classes, abstract bases included.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstclothproperties.h"

static GQuark
property_quark (void)
{
  return g_quark_from_static_string ("gst-cloth-property");
}

static GQuark
settings_quark (void)
{
  return g_quark_from_static_string ("gst-cloth-settings");
}

static gboolean
size_is_right (const GstClothProperty * property)
{
  switch (property->type) {
    case G_TYPE_UINT64:
      return property->size == sizeof (guint64);
    case G_TYPE_DOUBLE:
      return property->size == sizeof (gdouble)
          || property->size == sizeof (gfloat);
    case G_TYPE_STRING:
      return property->size == sizeof (gchar *);
    case GST_CLOTH_TYPE_FRACTION:
      return property->size == 2 * sizeof (gint);
    case G_TYPE_BOOLEAN:
    case G_TYPE_INT:
    case G_TYPE_UINT:
    case G_TYPE_FLOAT:
    case G_TYPE_ENUM:
      return property->size == sizeof (gint);
    default:
      return FALSE;
  }
}

static gdouble
read_double (const GstClothProperty * property, gconstpointer member)
{
  return property->size == sizeof (gfloat) ? *(const gfloat *) member :
      *(const gdouble *) member;
}

static GParamSpec *
make_enum_spec (const GstClothProperty * property, gint standard,
    GParamFlags flags)
{
  GType type = g_type_from_name (property->enum_name);

  /* Classes are initialised one at a time. */
  if (type == 0) {
    type = g_enum_register_static (property->enum_name, property->enum_values);
    gst_type_mark_as_plugin_api (type, 0);
  }
  return g_param_spec_enum (property->name, property->nick, property->blurb,
      type, standard, flags);
}

static GParamSpec *
make_spec (const GstClothProperty * property, gconstpointer standard)
{
  const GParamFlags access =
      property->flags & G_PARAM_READABLE ? 0 : G_PARAM_READWRITE;
  const GParamFlags flags = property->flags | access | G_PARAM_STATIC_STRINGS;
  const gchar *name = property->name, *nick = property->nick;
  const gchar *blurb = property->blurb;
  const gdouble low = property->minimum, high = property->maximum;

  switch (property->type) {
    case G_TYPE_BOOLEAN:
      return g_param_spec_boolean (name, nick, blurb,
          *(const gboolean *) standard, flags);
    case G_TYPE_INT:
      return g_param_spec_int (name, nick, blurb, (gint) low, (gint) high,
          *(const gint *) standard, flags);
    case G_TYPE_UINT:
      return g_param_spec_uint (name, nick, blurb, (guint) low, (guint) high,
          *(const guint *) standard, flags);
    case G_TYPE_UINT64:
      return g_param_spec_uint64 (name, nick, blurb, 0, G_MAXUINT64,
          *(const guint64 *) standard, flags);
    case G_TYPE_FLOAT:
      return g_param_spec_float (name, nick, blurb, (gfloat) low, (gfloat) high,
          *(const gfloat *) standard, flags);
    case G_TYPE_DOUBLE:
      return g_param_spec_double (name, nick, blurb, low, high,
          read_double (property, standard), flags);
    case G_TYPE_ENUM:
      return make_enum_spec (property, *(const gint *) standard, flags);
    case G_TYPE_STRING:
      return g_param_spec_string (name, nick, blurb,
          *(const gchar * const *) standard, flags);
    case GST_CLOTH_TYPE_FRACTION:
      return gst_param_spec_fraction (name, nick, blurb, 0, 1, G_MAXINT, 1,
          ((const gint *) standard)[0], ((const gint *) standard)[1], flags);
    default:
      g_assert_not_reached ();
  }
}

void
gst_cloth_install_properties (GObjectClass * klass,
    const GstClothProperty * properties, guint n_properties,
    gconstpointer defaults, gssize settings_offset)
{
  klass->set_property = gst_cloth_set_property;
  klass->get_property = gst_cloth_get_property;
  for (guint i = 0; i < n_properties; i++) {
    const GstClothProperty *property = &properties[i];
    GParamSpec *spec;

    g_assert (size_is_right (property));
    spec = make_spec (property, (const guint8 *) defaults + property->offset);
    g_param_spec_set_qdata (spec, property_quark (), (gpointer) property);
    g_param_spec_set_qdata (spec, settings_quark (),
        GSIZE_TO_POINTER (settings_offset));
    g_object_class_install_property (klass, i + 1, spec);
  }
}

/* The member that keeps the value of a property; NULL when no table has it. */
static gpointer
find_member (GObject * object, GParamSpec * spec,
    const GstClothProperty ** property)
{
  *property = g_param_spec_get_qdata (spec, property_quark ());
  if (!*property)
    return NULL;
  return (guint8 *) object + (*property)->offset +
      (gssize) GPOINTER_TO_SIZE (g_param_spec_get_qdata (spec,
          settings_quark ()));
}

static gboolean
may_change (GObject * object, const GParamSpec * spec)
{
  if (!GST_IS_ELEMENT (object) || GST_STATE (object) <= GST_STATE_READY
      || !(spec->flags & GST_PARAM_MUTABLE_READY))
    return TRUE;
  GST_WARNING_OBJECT (object, "“%s” cannot change while running",
      spec->name);
  return FALSE;
}

static void
write_member (const GstClothProperty * property, gpointer member,
    const GValue * value)
{
  switch (property->type) {
    case G_TYPE_BOOLEAN:
      *(gboolean *) member = g_value_get_boolean (value);
      break;
    case G_TYPE_INT:
      *(gint *) member = g_value_get_int (value);
      break;
    case G_TYPE_UINT:
      *(guint *) member = g_value_get_uint (value);
      break;
    case G_TYPE_UINT64:
      *(guint64 *) member = g_value_get_uint64 (value);
      break;
    case G_TYPE_FLOAT:
      *(gfloat *) member = g_value_get_float (value);
      break;
    case G_TYPE_DOUBLE:
      if (property->size == sizeof (gfloat))
        *(gfloat *) member = (gfloat) g_value_get_double (value);
      else
        *(gdouble *) member = g_value_get_double (value);
      break;
    case G_TYPE_ENUM:
      *(gint *) member = g_value_get_enum (value);
      break;
    case G_TYPE_STRING:
      g_free (*(gchar **) member);
      *(gchar **) member = g_value_dup_string (value);
      break;
    case GST_CLOTH_TYPE_FRACTION:
      ((gint *) member)[0] = gst_value_get_fraction_numerator (value);
      ((gint *) member)[1] = gst_value_get_fraction_denominator (value);
      break;
    default:
      g_assert_not_reached ();
  }
}

static void
read_member (const GstClothProperty * property, gconstpointer member,
    GValue * value)
{
  switch (property->type) {
    case G_TYPE_BOOLEAN:
      g_value_set_boolean (value, *(const gboolean *) member);
      break;
    case G_TYPE_INT:
      g_value_set_int (value, *(const gint *) member);
      break;
    case G_TYPE_UINT:
      g_value_set_uint (value, *(const guint *) member);
      break;
    case G_TYPE_UINT64:
      g_value_set_uint64 (value, *(const guint64 *) member);
      break;
    case G_TYPE_FLOAT:
      g_value_set_float (value, *(const gfloat *) member);
      break;
    case G_TYPE_DOUBLE:
      g_value_set_double (value, read_double (property, member));
      break;
    case G_TYPE_ENUM:
      g_value_set_enum (value, *(const gint *) member);
      break;
    case G_TYPE_STRING:
      g_value_set_string (value, *(const gchar * const *) member);
      break;
    case GST_CLOTH_TYPE_FRACTION:
      gst_value_set_fraction (value, ((const gint *) member)[0],
          ((const gint *) member)[1]);
      break;
    default:
      g_assert_not_reached ();
  }
}

void
gst_cloth_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * spec)
{
  const GstClothProperty *property;
  gpointer member = find_member (object, spec, &property);

  if (!member) {
    G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, spec);
    return;
  }
  GST_OBJECT_LOCK (object);
  if (may_change (object, spec))
    write_member (property, member, value);
  GST_OBJECT_UNLOCK (object);
}

void
gst_cloth_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * spec)
{
  const GstClothProperty *property;
  gconstpointer member = find_member (object, spec, &property);

  if (!member) {
    G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, spec);
    return;
  }
  GST_OBJECT_LOCK (object);
  read_member (property, member, value);
  GST_OBJECT_UNLOCK (object);
}

void
gst_cloth_clear_settings (const GstClothProperty * properties,
    guint n_properties, gpointer settings)
{
  for (guint i = 0; i < n_properties; i++)
    if (properties[i].type == G_TYPE_STRING)
      g_clear_pointer ((gchar **) ((guint8 *) settings + properties[i].offset),
          g_free);
}
