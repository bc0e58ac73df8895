/* Every element of the plugin: state cycles, properties, blurbs, pad templates.
 * GLib makes every warning and critical fatal here.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <string.h>

#include <gst/gst.h>

#define CYCLES 30

static guint n_cycles;

static GstElement *
make (gconstpointer data)
{
  GstElement *element =
      gst_element_factory_create (GST_ELEMENT_FACTORY (data), NULL);

  g_assert_nonnull (element);
  return gst_object_ref_sink (element);
}

static guint
count_errors (GstBus * bus)
{
  GstMessage *message;
  guint errors = 0;

  while ((message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR))) {
    g_autoptr (GError) error = NULL;
    g_autofree gchar *debug = NULL;

    gst_message_parse_error (message, &error, &debug);
    g_test_message ("%s (%s)", error->message, debug ? debug : "");
    g_assert_cmpstr (error->message, !=, "");
    errors++;
    gst_message_unref (message);
  }
  return errors;
}

/* An element that lacks something, a file for example, may refuse to start, but
 * then it says why; and it starts over as often as one likes. */
static void
test_states (gconstpointer data)
{
  g_autoptr (GstElement) element = make (data);
  g_autoptr (GstBus) bus = gst_bus_new ();
  const GstState way[] = { GST_STATE_READY, GST_STATE_PAUSED, GST_STATE_PLAYING,
    GST_STATE_PAUSED, GST_STATE_READY
  };
  guint refused = 0;

  gst_element_set_bus (element, bus);
  for (guint cycle = 0; cycle < CYCLES; cycle++, n_cycles++) {
    for (guint n = 0; n < G_N_ELEMENTS (way); n++) {
      if (gst_element_set_state (element, way[n]) == GST_STATE_CHANGE_FAILURE) {
        g_assert_cmpuint (count_errors (bus), >, 0);
        refused++;
        break;
      }
    }
    g_assert_cmpint (gst_element_set_state (element, GST_STATE_NULL), ==,
        GST_STATE_CHANGE_SUCCESS);
  }
  /* It does so every time or never. */
  g_assert_true (refused == 0 || refused == CYCLES);
  gst_bus_set_flushing (bus, TRUE);
  gst_element_set_bus (element, NULL);
  g_assert_cmpint (GST_OBJECT_REFCOUNT_VALUE (element), ==, 1);
}

static void
test_states_straight (gconstpointer data)
{
  g_autoptr (GstElement) element = make (data);

  for (guint cycle = 0; cycle < CYCLES; cycle++, n_cycles++) {
    gst_element_set_state (element, GST_STATE_PLAYING);
    g_assert_cmpint (gst_element_set_state (element, GST_STATE_NULL), ==,
        GST_STATE_CHANGE_SUCCESS);
  }
}

/* A double that an element keeps as a float is the same value. */
static gboolean
same_value (GParamSpec * pspec, const GValue * a, const GValue * b)
{
  if (G_IS_PARAM_SPEC_DOUBLE (pspec))
    return (gfloat) g_value_get_double (a) == (gfloat) g_value_get_double (b);
  return g_param_values_cmp (pspec, (GValue *) a, (GValue *) b) == 0;
}

static void
set_and_compare (GstElement * element, GParamSpec * pspec, const GValue * value)
{
  g_auto (GValue) back = G_VALUE_INIT;

  g_object_set_property (G_OBJECT (element), pspec->name, value);
  if (!(pspec->flags & G_PARAM_READABLE))
    return;
  g_value_init (&back, pspec->value_type);
  g_object_get_property (G_OBJECT (element), pspec->name, &back);
  if (!same_value (pspec, value, &back)) {
    g_autofree gchar *wanted = g_strdup_value_contents (value);
    g_autofree gchar *got = g_strdup_value_contents (&back);

    g_test_message ("%s: set to %s, reads %s", pspec->name, wanted, got);
    g_test_fail ();
  }
}

/* The ends of the range of a number; TRUE and FALSE; every nick of an enum. */
static void
set_extremes (GstElement * element, GParamSpec * pspec)
{
  g_auto (GValue) value = G_VALUE_INIT;

  g_value_init (&value, pspec->value_type);
#define BOTH_ENDS(TYPE, Type, type) G_STMT_START { \
  if (G_IS_PARAM_SPEC_##TYPE (pspec)) { \
    g_value_set_##type (&value, G_PARAM_SPEC_##TYPE (pspec)->minimum); \
    set_and_compare (element, pspec, &value); \
    g_value_set_##type (&value, G_PARAM_SPEC_##TYPE (pspec)->maximum); \
    set_and_compare (element, pspec, &value); \
  } } G_STMT_END
  BOTH_ENDS (INT, Int, int);
  BOTH_ENDS (UINT, UInt, uint);
  BOTH_ENDS (INT64, Int64, int64);
  BOTH_ENDS (UINT64, UInt64, uint64);
  BOTH_ENDS (FLOAT, Float, float);
  BOTH_ENDS (DOUBLE, Double, double);
#undef BOTH_ENDS
  if (G_IS_PARAM_SPEC_BOOLEAN (pspec)) {
    g_value_set_boolean (&value, TRUE);
    set_and_compare (element, pspec, &value);
    g_value_set_boolean (&value, FALSE);
    set_and_compare (element, pspec, &value);
  } else if (G_IS_PARAM_SPEC_ENUM (pspec)) {
    GEnumClass *values = G_PARAM_SPEC_ENUM (pspec)->enum_class;

    for (guint n = 0; n < values->n_values; n++) {
      g_value_set_enum (&value, values->values[n].value);
      set_and_compare (element, pspec, &value);
    }
  } else if (G_IS_PARAM_SPEC_STRING (pspec)) {
    g_value_set_string (&value, "a name with a space");
    set_and_compare (element, pspec, &value);
    g_value_set_string (&value, NULL);
    g_object_set_property (G_OBJECT (element), pspec->name, &value);
  }
}

static gboolean
is_own (GParamSpec * pspec)
{
  /* Those of GStreamer's bases are GStreamer's to test. */
  return !g_str_has_prefix (g_type_name (pspec->owner_type), "GstBase") &&
      pspec->owner_type != GST_TYPE_ELEMENT &&
      pspec->owner_type != GST_TYPE_OBJECT &&
      pspec->owner_type != GST_TYPE_BIN &&
      strcmp (g_type_name (pspec->owner_type), "GstAggregator") != 0;
}

static void
test_properties (gconstpointer data)
{
  g_autoptr (GstElement) element = make (data);
  guint n_specs;
  g_autofree GParamSpec **specs =
      g_object_class_list_properties (G_OBJECT_GET_CLASS (element), &n_specs);

  for (guint n = 0; n < n_specs; n++) {
    g_auto (GValue) initial = G_VALUE_INIT;

    if (!is_own (specs[n]))
      continue;
    if (specs[n]->flags & G_PARAM_READABLE) {
      g_value_init (&initial, specs[n]->value_type);
      g_object_get_property (G_OBJECT (element), specs[n]->name, &initial);
      if ((specs[n]->flags & G_PARAM_WRITABLE) &&
          !same_value (specs[n], g_param_spec_get_default_value (specs[n]),
              &initial)) {
        g_test_message ("%s does not start with its default", specs[n]->name);
        g_test_fail ();
      }
    }
    if (!(specs[n]->flags & G_PARAM_WRITABLE) ||
        (specs[n]->flags & G_PARAM_CONSTRUCT_ONLY))
      continue;
    set_extremes (element, specs[n]);
    set_and_compare (element, specs[n],
        g_param_spec_get_default_value (specs[n]));
  }

  /* The extremes stay set over a start and a stop. */
  for (guint n = 0; n < n_specs; n++) {
    if (is_own (specs[n]) && (specs[n]->flags & G_PARAM_WRITABLE) &&
        !(specs[n]->flags & G_PARAM_CONSTRUCT_ONLY))
      set_extremes (element, specs[n]);
  }
  gst_element_set_state (element, GST_STATE_PLAYING);
  gst_element_set_state (element, GST_STATE_NULL);
}

static void
assert_sentence (const gchar * owner, const gchar * text)
{
  gsize length = text ? strlen (text) : 0;

  if (length < 10 || !strchr (text, ' ') || text[length - 1] == ' ' ||
      !(g_ascii_isupper (text[0]) || g_ascii_isdigit (text[0])) ||
      strstr (text, "  ") || g_str_has_suffix (text, "..")) {
    g_test_message ("%s: not a sentence: \"%s\"", owner, text ? text : "");
    g_test_fail ();
  }
}

static void
test_words (gconstpointer data)
{
  GstElementFactory *factory = GST_ELEMENT_FACTORY (data);
  const gchar *const keys[] = { GST_ELEMENT_METADATA_LONGNAME,
    GST_ELEMENT_METADATA_DESCRIPTION, GST_ELEMENT_METADATA_AUTHOR,
    GST_ELEMENT_METADATA_KLASS
  };
  g_autoptr (GstElement) element = make (data);
  guint n_specs;
  g_autofree GParamSpec **specs =
      g_object_class_list_properties (G_OBJECT_GET_CLASS (element), &n_specs);
  const GList *item;

  for (guint n = 0; n < G_N_ELEMENTS (keys); n++) {
    const gchar *text = gst_element_factory_get_metadata (factory, keys[n]);

    g_assert_nonnull (text);
    g_assert_cmpstr (text, !=, "");
  }
  assert_sentence (GST_OBJECT_NAME (factory),
      gst_element_factory_get_metadata (factory,
          GST_ELEMENT_METADATA_DESCRIPTION));
  for (guint n = 0; n < n_specs; n++) {
    if (is_own (specs[n]))
      assert_sentence (specs[n]->name, g_param_spec_get_blurb (specs[n]));
  }

  g_assert_nonnull (gst_element_factory_get_static_pad_templates (factory));
  for (item = gst_element_factory_get_static_pad_templates (factory); item;
      item = item->next) {
    GstStaticPadTemplate *pad_template = item->data;
    g_autoptr (GstCaps) caps = gst_static_pad_template_get_caps (pad_template);

    g_assert_false (gst_caps_is_empty (caps));
    if (pad_template->presence == GST_PAD_ALWAYS) {
      g_autoptr (GstPad) pad =
          gst_element_get_static_pad (element, pad_template->name_template);

      g_assert_nonnull (pad);
    }
  }
  /* One word all the way: element "quadtrack" has the type GstQuadTrack. */
  {
    g_autofree gchar *wanted =
        g_strconcat ("gst", GST_OBJECT_NAME (factory), NULL);
    g_autofree gchar *type = g_ascii_strdown (G_OBJECT_TYPE_NAME (element), -1);

    g_assert_cmpstr (type, ==, wanted);
  }
}

static void
test_request_pads (gconstpointer data)
{
  g_autoptr (GstElement) element = make (data);
  const GList *item;

  for (item =
      gst_element_factory_get_static_pad_templates (GST_ELEMENT_FACTORY (data));
      item; item = item->next) {
    GstStaticPadTemplate *pad_template = item->data;
    /* A template without a number gives one pad. */
    guint wanted = strchr (pad_template->name_template, '%') ? 3 : 1;

    if (pad_template->presence != GST_PAD_REQUEST)
      continue;
    for (guint cycle = 0; cycle < CYCLES; cycle++, n_cycles++) {
      GstPad *pads[3] = { NULL };

      for (guint n = 0; n < wanted; n++) {
        pads[n] = gst_element_request_pad_simple (element,
            pad_template->name_template);
        g_assert_nonnull (pads[n]);
      }
      gst_element_set_state (element, GST_STATE_PLAYING);
      for (guint n = 0; n < wanted; n++) {
        gst_element_release_request_pad (element, pads[n]);
        gst_object_unref (pads[n]);
      }
      gst_element_set_state (element, GST_STATE_NULL);
    }
  }
}

static void
add (const gchar * what, GstPluginFeature * feature, GTestDataFunc function)
{
  g_autofree gchar *path =
      g_strdup_printf ("/%s/%s", gst_plugin_feature_get_name (feature), what);

  g_test_add_data_func (path, feature, function);
}

int
main (int argc, char **argv)
{
  GList *features, *item;
  guint n_elements = 0;
  int status;

  g_test_init (&argc, &argv, NULL);
  gst_init (&argc, &argv);

  features = gst_registry_get_feature_list_by_plugin (gst_registry_get (),
      "cloth");
  for (item = features; item; item = item->next) {
    if (!GST_IS_ELEMENT_FACTORY (item->data))
      continue;
    add ("states", item->data, test_states);
    add ("states-straight", item->data, test_states_straight);
    add ("properties", item->data, test_properties);
    add ("words", item->data, test_words);
    add ("request-pads", item->data, test_request_pads);
    n_elements++;
  }
  if (n_elements == 0)
    g_error ("no element of the plugin was found in GST_PLUGIN_PATH_1_0");
  g_test_message ("%u elements", n_elements);
  status = g_test_run ();
  g_print ("# %u state cycles\n", n_cycles);
  gst_plugin_feature_list_free (features);
  gst_deinit ();
  return status;
}
