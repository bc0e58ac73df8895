#!/usr/bin/python3
"""Keeps docs/elements.md true: its tables are made from the plugin itself.

  elementsdoc.py --check FILE.md     exit code 1 when a table differs or an element is missing
  elementsdoc.py --write FILE.md     puts the tables in; the prose around them stays

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import difflib
import re
import sys

import gi

gi.require_version('Gst', '1.0')
from gi.repository import GObject, Gst  # noqa: E402

FOREIGN = ('GstObject', 'GstElement', 'GstBin', 'GstBaseTransform', 'GstBaseSink', 'GstBaseSrc',
           'GstAggregator', 'GstPushSrc', 'GstVideoFilter', 'GstVideoAggregator')
PRESENCE = {Gst.PadPresence.ALWAYS: 'always', Gst.PadPresence.SOMETIMES: 'sometimes',
            Gst.PadPresence.REQUEST: 'on request'}
DIRECTION = {Gst.PadDirection.SINK: 'sink', Gst.PadDirection.SRC: 'source'}


def number(value):
    if isinstance(value, float):
        if abs(value) > 1e300:
            return '∞' if value > 0 else '−∞'
        return '%.7g' % value
    return {-2 ** 63: '−2⁶³', 2 ** 64 - 1: '2⁶⁴−1', 2 ** 63 - 1: '2⁶³−1', 2 ** 32 - 1: '2³²−1',
            2 ** 31 - 1: '2³¹−1'}.get(value, str(value))


# What GStreamer's own words leave open.
EXPLAINED = {
    'latency': 'How much longer than upstream says a live set waits for frames that are missing, '
               'in ns: see [latency](streams.md#live-cameras)',
}

# Of the bases' own properties those that a user of these elements sets or reads.
INHERITED = {
    'GstAggregator': ('latency', 'start-time-selection', 'start-time'),
    'GstBaseTransform': ('qos',),
    'GstBaseSink': ('sync', 'async', 'max-lateness', 'qos', 'ts-offset', 'processing-deadline'),
    'GstBaseSrc': ('num-buffers', 'do-timestamp'),
}


def describe(spec, element):
    """Type with range, default: that of a new element, which may differ from its base's."""
    default = spec.default_value
    if spec.owner_type.name in FOREIGN:
        default = element.get_property(spec.name)
    kind = spec.value_type
    if GObject.type_is_a(kind, GObject.TYPE_ENUM):
        nicks = ['`%s`' % v.value_nick for v in kind.pytype.__enum_values__.values()] \
            if kind.pytype and hasattr(kind.pytype, '__enum_values__') else []
        if not nicks:
            nicks = ['`%s`' % v.value_nick for v in spec.enum_class.values] \
                if hasattr(spec, 'enum_class') else []
        nick = getattr(default, 'value_nick', None) or str(default)
        return ', '.join(nicks) or kind.name, '`%s`' % nick
    if kind == GObject.TYPE_STRING:
        return 'text', '`%s`' % default if default else '–'
    if kind == GObject.TYPE_BOOLEAN:
        return 'boolean', '`%s`' % str(bool(default)).lower()
    if hasattr(spec, 'minimum'):
        return ('%s … %s' % (number(spec.minimum), number(spec.maximum)),
                '`%s`' % number(default))
    return kind.name, '–' if default is None else '`%s`' % default


def caps_line(caps):
    if caps.is_any():
        return 'anything'
    names = []
    for n in range(caps.get_size()):
        structure = caps.get_structure(n)
        name = '`%s`' % structure.get_name()
        features = caps.get_features(n)
        if features and not features.is_equal(Gst.CapsFeatures.from_string('memory:SystemMemory')):
            name = '`%s(%s)`' % (structure.get_name(), features.to_string())
        if structure.has_field('format'):
            value = re.search(r'format=(?:\(string\))?(\{[^}]*\}|[A-Za-z0-9_]+)',
                              structure.to_string()).group(1)
            formats = re.findall(r'[A-Za-z0-9_]+', value.replace('(string)', ''))
            name += ' ' + ', '.join(formats)
        if name not in names:
            names.append(name)
    return '; '.join(names)


def table(factory):
    element = factory.create(None)
    lines = ['', '| pad | direction | there | carries |', '|---|---|---|---|']
    # The registry gives them in either order.
    for template in sorted(factory.get_static_pad_templates(), key=lambda pad: (
            pad.direction != Gst.PadDirection.SINK, pad.presence, pad.name_template)):
        lines.append('| `%s` | %s | %s | %s |' % (
            template.name_template, DIRECTION[template.direction], PRESENCE[template.presence],
            caps_line(template.get_caps())))
    rows = []
    # The element's own before those of its base.
    for spec in sorted(element.list_properties(),
                       key=lambda spec: (spec.owner_type.name in FOREIGN,
                                         spec.owner_type != element.__gtype__)):
        owner = spec.owner_type.name
        if owner in FOREIGN and spec.name not in INHERITED.get(owner, ()):
            continue
        kind, default = describe(spec, element)
        blurb = (spec.blurb or '').replace('|', '\\|')
        if spec.name in EXPLAINED:
            blurb = EXPLAINED[spec.name]
        if owner in FOREIGN:
            blurb += ' (of %s)' % owner
        rows.append('| `%s` | %s | %s | %s |' % (spec.name, kind, default, blurb))
    if rows:
        lines += ['', '| property | values | default | meaning |', '|---|---|---|---|'] + rows
    else:
        lines += ['', 'No properties of its own.']
    return '\n'.join(lines) + '\n\n'


def main():
    Gst.init(None)
    mode, path = sys.argv[1:]
    with open(path, encoding='utf-8') as file:
        text = file.read()
    features = Gst.Registry.get().get_feature_list_by_plugin('cloth')
    factories = {f.get_name(): f for f in features if isinstance(f, Gst.ElementFactory)}
    if not factories:
        sys.exit('the plugin was not found in GST_PLUGIN_PATH_1_0')

    def fill(match):
        name = match.group(1)
        if name not in factories:
            sys.exit('%s: the plugin has no element %s' % (path, name))
        return '<!-- made from the plugin: %s -->%s<!-- end -->' % (name, '\n' + table(factories[name]))

    new = re.sub(r'<!-- made from the plugin: (\w+) -->.*?<!-- end -->', fill, text, flags=re.S)
    missing = [name for name in sorted(factories)
               if '<!-- made from the plugin: %s -->' % name not in new]
    if mode == '--write':
        for name in missing:
            factory = factories[name]
            new += '\n## %s\n%s.\n<!-- made from the plugin: %s -->\n%s<!-- end -->\n' % (
                name, factory.get_metadata('description').rstrip('.'), name, table(factory))
        with open(path, 'w', encoding='utf-8') as file:
            file.write(new)
        return 0
    for name in missing:
        print('%s: nothing on %s' % (path, name))
    difference = ''.join(difflib.unified_diff(text.splitlines(True), new.splitlines(True),
                                              path, 'the plugin'))
    if difference:
        print(difference)
    if missing or difference:
        print('Run `meson compile -C build docs-elements`.')
        return 1
    print('%d elements, tables true' % len(factories))
    return 0


sys.exit(main())
