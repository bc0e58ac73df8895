/* Properties from a table: every kind of value, refusal while running, ownership.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>

#include "elements/gstclothproperties.h"

typedef enum
{
  COLOUR_RED,
  COLOUR_BLUE
} Colour;

typedef struct
{
  gboolean boolean;
  gint integer;
  guint natural;
  guint64 large, count;
  gfloat single;
  gdouble real;
  gfloat narrow;                /* of a property that is a double */
  Colour colour;
  gchar *text, *fixed;
  gint fraction[2];
} Settings;

static const Settings default_settings =
    { TRUE, -3, 4, G_MAXUINT64, 7, 0.5f, 0.1,
  0.25f, COLOUR_BLUE, NULL, NULL, {30, 1}
};

static const GEnumValue colours[] = {
  {COLOUR_RED, "Red", "red"},
  {COLOUR_BLUE, "Blue", "blue"},
  {0, NULL, NULL}
};

#define SETTING(member) GST_CLOTH_SETTING (Settings, member)

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"boolean", "b", "B", G_TYPE_BOOLEAN, SETTING (boolean), GST_PARAM_MUTABLE_PLAYING},
  {"integer", "i", "I", G_TYPE_INT, SETTING (integer), GST_PARAM_MUTABLE_PLAYING, -5, 5},
  {"natural", "n", "N", G_TYPE_UINT, SETTING (natural), GST_PARAM_MUTABLE_PLAYING, 0, G_MAXUINT},
  {"large", "l", "L", G_TYPE_UINT64, SETTING (large), GST_PARAM_MUTABLE_PLAYING},
  {"count", "o", "O", G_TYPE_UINT64, SETTING (count), G_PARAM_READABLE},
  {"single", "s", "S", G_TYPE_FLOAT, SETTING (single), GST_PARAM_MUTABLE_PLAYING, 0, 0.9},
  {"real", "r", "R", G_TYPE_DOUBLE, SETTING (real), GST_PARAM_MUTABLE_PLAYING, 0, G_MAXDOUBLE},
  {"narrow", "w", "W", G_TYPE_DOUBLE, SETTING (narrow), GST_PARAM_MUTABLE_PLAYING, -1, 1},
  {"colour", "c", "C", G_TYPE_ENUM, SETTING (colour), GST_PARAM_MUTABLE_PLAYING, 0, 0,
    "TestColour", colours},
  {"text", "t", "T", G_TYPE_STRING, SETTING (text), GST_PARAM_MUTABLE_PLAYING},
  {"fixed", "f", "F", G_TYPE_STRING, SETTING (fixed), GST_PARAM_MUTABLE_READY},
  {"fraction", "q", "Q", GST_CLOTH_TYPE_FRACTION, SETTING (fraction), GST_PARAM_MUTABLE_PLAYING},
};
/* *INDENT-ON* */

/* A base that keeps its settings in private data, and an element on it with one of the same
 * table: each class has ids of its own. */
typedef struct
{
  GstElement parent;
} TestBase;
typedef struct
{
  GstElementClass parent_class;
} TestBaseClass;
typedef struct
{
  guint before;
  gchar *name;
} TestBasePrivate;

GType test_base_get_type (void);
G_DEFINE_TYPE_WITH_PRIVATE (TestBase, test_base, GST_TYPE_ELEMENT);

/* *INDENT-OFF* */
static const GstClothProperty base_properties[] = {
  {"camera", "camera", "Camera", G_TYPE_STRING, GST_CLOTH_SETTING (TestBasePrivate, name),
    GST_PARAM_MUTABLE_PLAYING},
};
/* *INDENT-ON* */

static void
test_base_finalize (GObject * object)
{
  gst_cloth_clear_settings (base_properties, G_N_ELEMENTS (base_properties),
      test_base_get_instance_private ((TestBase *) object));
  G_OBJECT_CLASS (test_base_parent_class)->finalize (object);
}

static void
test_base_class_init (TestBaseClass * klass)
{
  const TestBasePrivate defaults = { 0, NULL };

  gst_cloth_install_properties (G_OBJECT_CLASS (klass), base_properties,
      G_N_ELEMENTS (base_properties), &defaults,
      g_type_class_get_instance_private_offset (klass));
  G_OBJECT_CLASS (klass)->finalize = test_base_finalize;
}

static void
test_base_init (TestBase * self)
{
}

typedef struct
{
  TestBase parent;
  guint before;
  Settings settings;
} TestElement;
typedef struct
{
  TestBaseClass parent_class;
} TestElementClass;

GType test_element_get_type (void);
G_DEFINE_TYPE (TestElement, test_element, test_base_get_type ());

static void
test_element_finalize (GObject * object)
{
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties),
      &((TestElement *) object)->settings);
  G_OBJECT_CLASS (test_element_parent_class)->finalize (object);
}

static void
test_element_class_init (TestElementClass * klass)
{
  gst_cloth_install_properties (G_OBJECT_CLASS (klass), properties,
      G_N_ELEMENTS (properties), &default_settings,
      G_STRUCT_OFFSET (TestElement, settings));
  G_OBJECT_CLASS (klass)->finalize = test_element_finalize;
}

static void
test_element_init (TestElement * self)
{
  self->settings = default_settings;
}

/* What an element begins with is what its properties say that they begin with. */
GST_START_TEST (test_defaults)
{
  TestElement *element = g_object_new (test_element_get_type (), NULL);
  guint n;
  g_autofree GParamSpec **specs =
      g_object_class_list_properties (G_OBJECT_GET_CLASS (element), &n);
  guint n_own = 0;

  for (guint i = 0; i < n; i++) {
    GValue value = G_VALUE_INIT;

    if (specs[i]->owner_type != test_element_get_type ())
      continue;
    fail_unless_equals_string (specs[i]->name, properties[n_own++].name);
    g_object_get_property (G_OBJECT (element), specs[i]->name, &value);
    fail_unless (g_param_value_defaults (specs[i], &value), "%s",
        specs[i]->name);
    g_value_unset (&value);
  }
  fail_unless_equals_int (n_own, G_N_ELEMENTS (properties));
  gst_object_unref (element);
}

GST_END_TEST;

GST_START_TEST (test_round)
{
  TestElement *element = g_object_new (test_element_get_type (), NULL);
  gboolean boolean;
  gint integer, colour, fraction[2];
  guint natural;
  guint64 large;
  gfloat single;
  gdouble real, narrow;
  g_autofree gchar *text = NULL, *camera = NULL;
  gchar passed[] = "mine";

  g_object_set (element, "boolean", FALSE, "integer", 5, "natural", G_MAXUINT,
      "large", (guint64) 1 << 63, "single", 0.75, "real", 1e300, "narrow",
      -0.5, "colour", COLOUR_RED, "text", passed, "fraction", 24000, 1001,
      "camera", "left", NULL);
  passed[0] = 'x';
  g_object_get (element, "boolean", &boolean, "integer", &integer, "natural",
      &natural, "large", &large, "single", &single, "real", &real, "narrow",
      &narrow, "colour", &colour, "text", &text, "camera", &camera, NULL);
  fail_unless (!boolean && integer == 5 && natural == G_MAXUINT);
  fail_unless (large == (guint64) 1 << 63 && single == 0.75f && real == 1e300
      && narrow == -0.5 && colour == COLOUR_RED);
  fail_unless_equals_string (text, "mine");
  fail_unless_equals_string (camera, "left");
  fail_unless (element->settings.narrow == -0.5f
      && element->settings.colour == COLOUR_RED);
  g_object_get (element, "fraction", &fraction[0], &fraction[1], NULL);
  fail_unless (fraction[0] == 24000 && fraction[1] == 1001);
  /* the copy is let go of; NULL is a value */
  g_object_set (element, "text", "other", NULL);
  g_object_set (element, "text", NULL, NULL);
  fail_unless (element->settings.text == NULL);
  g_object_set (element, "text", "last", NULL);
  fail_unless (element->before == 0);
  gst_object_unref (element);
}

GST_END_TEST;

/* What the element counts others can look at. */
GST_START_TEST (test_read_only)
{
  TestElement *element = g_object_new (test_element_get_type (), NULL);
  GParamSpec *spec = g_object_class_find_property (G_OBJECT_GET_CLASS (element),
      "count");
  guint64 count;

  fail_unless (spec->flags & G_PARAM_READABLE);
  fail_if (spec->flags & G_PARAM_WRITABLE);
  element->settings.count = 8;
  g_object_get (element, "count", &count, NULL);
  fail_unless_equals_uint64 (count, 8);
  ASSERT_WARNING (g_object_set (element, "count", (guint64) 9, NULL));
  fail_unless_equals_uint64 (element->settings.count, 8);
  gst_object_unref (element);
}

GST_END_TEST;

/* What holds from start to stop is refused while the element runs; the rest is not. */
GST_START_TEST (test_running)
{
  TestElement *element = g_object_new (test_element_get_type (), NULL);

  g_object_set (element, "fixed", "before", NULL);
  gst_element_set_state (GST_ELEMENT (element), GST_STATE_READY);
  g_object_set (element, "fixed", "ready", NULL);
  fail_unless_equals_string (element->settings.fixed, "ready");
  gst_element_set_state (GST_ELEMENT (element), GST_STATE_PAUSED);
  g_object_set (element, "fixed", "too late", "text", "now", "integer", 2,
      NULL);
  fail_unless_equals_string (element->settings.fixed, "ready");
  fail_unless_equals_string (element->settings.text, "now");
  fail_unless_equals_int (element->settings.integer, 2);
  gst_element_set_state (GST_ELEMENT (element), GST_STATE_NULL);
  g_object_set (element, "fixed", "after", NULL);
  fail_unless_equals_string (element->settings.fixed, "after");
  gst_object_unref (element);
}

GST_END_TEST;

static Suite *
clothproperties_suite (void)
{
  Suite *suite = suite_create ("clothproperties");
  TCase *general = tcase_create ("general");

  suite_add_tcase (suite, general);
  tcase_add_test (general, test_defaults);
  tcase_add_test (general, test_round);
  tcase_add_test (general, test_read_only);
  tcase_add_test (general, test_running);
  return suite;
}

GST_CHECK_MAIN (clothproperties);
