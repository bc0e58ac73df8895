/* clothgap: its properties.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothgap-settings.h"

#define DEFAULT_SEED 0
#define DEFAULT_THREADS 0
#define DEFAULT_WINDOW 0.3

enum
{
  PROP_0,
  PROP_MODEL,
  PROP_LOCATION,
  PROP_RIG,
  PROP_CAMERA,
  PROP_BASELINE,
  PROP_EFFECTS,
  PROP_OUTPUT,
  PROP_SEED,
  PROP_THREADS,
  PROP_WINDOW
};

static const struct
{
  guint id;
  gsize offset;
  const gchar *name, *nick, *blurb;
} strings[] = {
  {PROP_MODEL, G_STRUCT_OFFSET (GstClothGapSettings, model), "model", "Model",
      "What the simulator knows of the cloth (model.json)"},
  {PROP_LOCATION, G_STRUCT_OFFSET (GstClothGapSettings, location), "location",
        "Location",
      "Folder of the take that gives the scene: mesh, paths of the "
        "clamps, obstacles, gravity; for a stream from a take, that take"},
  {PROP_RIG, G_STRUCT_OFFSET (GstClothGapSettings, rig), "rig", "Rig",
      "Calibration file (rig.json) that has the camera of the observations; by "
        "default the one in the folder of location"},
  {PROP_CAMERA, G_STRUCT_OFFSET (GstClothGapSettings, camera), "camera",
        "Camera",
      "Name in the rig of the camera of the observations; by default the one that "
        "the metadata names, else the only one of the rig"},
  {PROP_BASELINE, G_STRUCT_OFFSET (GstClothGapSettings, baseline), "baseline",
      "Baseline", "Folder of a take the model is accepted on: its free "
        "parameters are fitted there"},
  {PROP_EFFECTS, G_STRUCT_OFFSET (GstClothGapSettings, effects), "effects",
        "Effects",
      "Effects to consider, with commas between them; by default all"},
  {PROP_OUTPUT, G_STRUCT_OFFSET (GstClothGapSettings, output), "output",
        "Output",
      "Folder for gap.json, report.html and fitted.json; by default none is written"}
};

void
gst_cloth_gap_settings_install (GObjectClass * klass)
{
  const GParamFlags flags = G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
      GST_PARAM_MUTABLE_READY;

  for (guint i = 0; i < G_N_ELEMENTS (strings); i++)
    g_object_class_install_property (klass, strings[i].id,
        g_param_spec_string (strings[i].name, strings[i].nick,
            strings[i].blurb, NULL, flags));
  g_object_class_install_property (klass, PROP_SEED,
      g_param_spec_uint64 ("seed", "Seed", "Seed of all random numbers", 0,
          G_MAXUINT64, DEFAULT_SEED, flags));
  g_object_class_install_property (klass, PROP_THREADS,
      g_param_spec_uint ("threads", "Threads",
          "Threads that simulate; 0: one a processor. The result is the same",
          0, 1024, DEFAULT_THREADS, flags));
  g_object_class_install_property (klass, PROP_WINDOW,
      g_param_spec_double ("window", "Window",
          "Length of a scored window, seconds", 0.01, 60, DEFAULT_WINDOW,
          flags));
}

void
gst_cloth_gap_settings_init (GstClothGapSettings * settings)
{
  settings->seed = DEFAULT_SEED;
  settings->threads = DEFAULT_THREADS;
  settings->window = DEFAULT_WINDOW;
}

/* The text of a property, or NULL when it is none. */
static gchar **
find_string (const GstClothGapSettings * settings, guint id)
{
  for (guint i = 0; i < G_N_ELEMENTS (strings); i++)
    if (strings[i].id == id)
      return (gchar **) ((guint8 *) settings + strings[i].offset);
  return NULL;
}

void
gst_cloth_gap_settings_set (GstClothGapSettings * settings, guint id,
    const GValue * value)
{
  gchar **string = find_string (settings, id);

  if (string) {
    g_free (*string);
    *string = g_value_dup_string (value);
  } else if (id == PROP_SEED) {
    settings->seed = g_value_get_uint64 (value);
  } else if (id == PROP_THREADS) {
    settings->threads = g_value_get_uint (value);
  } else {
    settings->window = g_value_get_double (value);
  }
}

void
gst_cloth_gap_settings_get (const GstClothGapSettings * settings, guint id,
    GValue * value)
{
  gchar **string = find_string (settings, id);

  if (string)
    g_value_set_string (value, *string);
  else if (id == PROP_SEED)
    g_value_set_uint64 (value, settings->seed);
  else if (id == PROP_THREADS)
    g_value_set_uint (value, settings->threads);
  else
    g_value_set_double (value, settings->window);
}

void
gst_cloth_gap_settings_clear (GstClothGapSettings * settings)
{
  for (guint i = 0; i < G_N_ELEMENTS (strings); i++)
    g_free (*find_string (settings, strings[i].id));
}
