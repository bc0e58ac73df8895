#!/usr/bin/python3
"""Checks the floors of the house: which room may use which, and through which doors.

  floors.py ROOT          checks the sources and the documents under ROOT
  floors.py --table       prints the rooms, lowest first, with their doors
  floors.py --self-test   shows that each rule catches what breaks it, and nothing else

A module is a .c or .cpp with its .h and its .inc.c; a header by itself is a module of its own.
One module uses another when it includes it, or when it names a function or a variable
that the other defines. Only texts are read: nothing needs to be built. Names that a macro
puts together by ## are not seen. So the one list of effects, gst/effect/list.h, is free to
name what rooms above it define: the linker ties these to it.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import fnmatch
import glob
import os
import re
import sys
import tempfile


class Room:
    """what: the room in a few words, for the drawing.
    doors: the headers that others may include; a dictionary has them by sub-room, and
    other sub-rooms have to use them too where there are any.
    order: steps of sub-rooms, lowest first, '' being what lies in the room itself; a
    module may be named to stand on a step of its own. Those on one step don't use one
    another. A room without it is one step."""

    def __init__(self, path, what, doors, order=()):
        self.path, self.what, self.order = path, what, order
        self.doors = doors if isinstance(doors, dict) else {'': doors}

    def part(self, path):
        """The part of the order to which a file of this room belongs."""
        inside = path[len(self.path) + 1:]
        if any(stem(inside) in step for step in self.order):
            return stem(inside)
        return inside.partition('/')[0] if '/' in inside else ''

    def step(self, part):
        return next((i for i, step in enumerate(self.order) if part in step), None)

    def is_door(self, path):
        folder, name = os.path.split(path[len(self.path) + 1:])
        return any(fnmatch.fnmatch(name, door) for door in self.doors.get(folder, []))


EACH = ['*.h']
# Lowest first: a room may use itself and those before it.
ROOMS = [
    Room('gst/math', 'algebra, statistics, threads', EACH),
    Room('gst/file', 'files read with care', EACH),
    Room('gst/effect', 'the one list of effects', ['effect.h', 'list.h']),
    Room('gst/pattern', 'what is printed on the cloth', EACH),
    Room('gst/rig', 'cameras and triangulation',
         ['rig.h', 'rigfile.h', 'rigyaml.h', 'cameramodel.h', 'world.h', 'camera.h', 'capture.h', 'orbit.h', 'rotation.h',
          'planar.h', 'rectify.h', 'calibrate.h', 'uncertainty.h', 'merge.h', 'triangulate.h', 'errorfloor.h',
          'reconstruct.h']),
    Room('gst/mesh', 'meshes and their files',
         {'': ['topology.h', 'hold.h', 'seam.h', 'side.h', 'strain.h'], 'formats': ['formats.h'],
          'fill': ['fill.h'], 'garment': ['garment.h']},
         [[''], ['formats'], ['fill', 'garment']]),
    Room('gst/take', 'recordings on disk', ['take.h', 'sequence.h', 'recover.h', 'measurement.h', 'import.h', 'summary.h']),
    Room('gst/render', 'pictures of a known cloth',
         ['render.h', 'surface.h', 'coverage.h', 'wireframe.h', 'paint.h', 'draw.h', 'caption.h', 'work.h']),
    Room('gst/cv', 'what OpenCV does', ['cv.h', 'markers.h']),
    Room('gst/vision', 'pictures in, points out',
         {'': ['image.h'], 'corner': ['saddle.h', 'corner.h', 'edge.h'], 'checker': ['checker.h'],
          'quad': ['quad.h'], 'dot': ['dot.h'], 'label': ['label.h'], 'feature': ['nearest.h'],
          'mask': ['mask.h'], 'disparity': ['disparity.h'], 'match': ['match.h'], 'uv': ['uv.h'],
          'stereo': ['stereo.h'], 'track': ['follow.h', 'marker.h', 'flat.h', 'anneal.h', 'tracker.h', 'cast.h', 'crest.h',
                                        'vertices.h']},
         [[''], ['corner', 'dot', 'feature', 'mask', 'disparity'],
          ['checker', 'label', 'match', 'stereo'], ['quad', 'uv', 'track']]),
    Room('gst/sim', 'how a cloth moves',
         ['sim.h', 'model.h', 'scene.h']),
    Room('gst/fit', 'which numbers fit a recording',
         {'': ['error.h'], 'recording': ['recording.h'], 'features': ['features.h'],
          'rig': ['refine.h'], 'nudge': ['nudge.h'], 'estimate': ['estimate.h'],
          'synthesis': ['synthesis.h', 'silhouette.h'], 'search': ['search.h', 'evaluate.h']},
         [[''], ['recording', 'search'], ['features', 'rig'], ['nudge'], ['estimate'], ['synthesis']]),
    Room('gst/gap', 'why a simulation is wrong',
         {'': ['diagnose.h', 'inputs.h'],
          'report': ['result.h', 'words.h', 'patch.h', 'report.h', 'page.h', 'view.h'],
          'simulator': ['simulator.h', 'capabilities.h', 'mapping.h'], 'survey': ['survey.h']},
         [['inputs', 'report', 'survey'], ['simulator'], ['camera'], ['diagnosis'], ['load', 'inference', 'localise'],
          ['camera/faults', 'verdict', 'design', 'loop'], ['diagnose']]),
]
# Stands apart: it knows GStreamer and none of the algorithm rooms.
LIBRARY = Room('gst/cloth', 'metadata, streams; installed', ['cloth.h'])
# Above all rooms, lowest first; they know GStreamer.
UPPER = [
    Room('gst/cloth-io', 'where GStreamer meets takes', EACH),
    Room('elements', 'thin elements of GStreamer', EACH),
    Room('tools', 'programs of the command line', EACH),
    Room('tests', 'what all of it must do', EACH),
]
ALL = ROOMS + [LIBRARY] + UPPER
# Programs use the library, never the elements' own sources.
APART = {('tools', 'elements')}
# These look into a room to test what its doors don't show.
PRY = ('tests/core/', 'tests/fuzz/', 'tests/bench/')
# What does not hold yet, as rule and how the fault begins: it is told and passes.
PENDING = ()

# C++ and OpenCV are here only.
CPLUSPLUS = ('gst/cv/', 'tests/reference/', 'tests/gapbench/bullet.cc')

LICENCE = 'SPDX-License-Identifier: LGPL-2.1-or-later'
WARN_LINES, MAX_LINES, README_LINES = 800, 1200, 15
SOURCES = ('.c', '.h', '.cpp', '.cc', '.cxx', '.hpp')
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"]', re.M)
OTHER_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[^<" \t]', re.M)
NOISE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
DIRECTIVE = re.compile(r'^[ \t]*#(?:\\\n|[^\n])*', re.M)
MACRO = re.compile(r'^[ \t]*#[ \t]*define[ \t]+\w+((?:\\\n|[^\n])*)', re.M)
BRACES = re.compile(r'\{[^{}]*\}')
# A macro that adds the suffix of a variant to a name.
VARIANT = re.compile(r'\b(?:CLOTH_LANE_NAME|CLOTH_SIMD_NAME) \((\w+)\)')
# What the macros of GLib define.
QUARK = re.compile(r'^G_DEFINE_QUARK \(\s*[\w-]+,\s*(\w+)', re.M)
TYPE = re.compile(r'^G_DEFINE_(?:ABSTRACT_|BOXED_|FINAL_)?TYPE\w* \(\s*\w+,\s*(\w+)', re.M)
HIDDEN = re.compile(r'\bstatic\b|\b\w*INLINE\b')
WORD = re.compile(r'[A-Za-z_]\w*')
DOCUMENTS = ('README.md', 'CONTRIBUTING.md', 'SECURITY.md', 'docs/*.md')
# A path that a document names; one inside another path, a URL or a build folder is not ours.
NAMED = re.compile(r'(?<![\w./<$}-])((?:gst|elements|tools|tests|pipelines)/[\w.*/-]*)([<{$]?)')
# A source that is named without its folder.
BARE = re.compile(r'(?<![\w./<-])([a-z][\w-]*\.(?:inc\.c|c|h))\b')
COMMENT = re.compile(r'/\*.*?\*/', re.S)
OF_FILE = re.compile(r'`(\w+) ?\(\)` of\s+`([\w./-]+\.[ch])`')
OURS = re.compile(r'\b((?:gst_)?cloth_\w+|gst_\w+) ?\(\)')


def stem(path):
    for ending in ('.inc.c', '.c', '.cpp', '.h'):
        if path.endswith(ending):
            return path[:-len(ending)]
    return path


def room_of(path):
    return next((room for room in ALL if path.startswith(room.path + '/')), None)


def is_gstreamer(name):
    return re.search(r'(^|/)gst/', name) and room_of(name) not in ROOMS


class Source:
    """What one file includes, defines and names."""

    def __init__(self, root, path):
        with open(os.path.join(root, path), encoding='utf-8') as file:
            self.text = file.read()
        self.path, self.room, self.module = path, room_of(path), stem(path)
        self.includes = []
        for name in INCLUDE.findall(self.text):
            beside = os.path.normpath(os.path.join(os.path.dirname(path), name))
            self.includes.append(beside if os.path.exists(os.path.join(root, beside)) else name)
        code = NOISE.sub(lambda noise: '""' if noise[0][0] == '"' else ' ', self.text)
        # The macros of an error domain and of a type only give these another name.
        macros = re.sub(r'\w+_(quark|get_type)\b', '', ' '.join(MACRO.findall(code)))
        code = VARIANT.sub(r'\1', DIRECTIVE.sub('', code))
        self.globals, self.functions, self.declared, bodies = definitions(code)
        self.globals |= {name + '_quark' for name in QUARK.findall(code)}
        self.globals |= {name + '_get_type' for name in TYPE.findall(code)}
        self.functions |= self.globals
        # A prototype in a header uses nothing: only what a function there does.
        self.words = set(WORD.findall(macros + ' '.join(bodies) if path.endswith('.h')
                                      else macros + code))


def definitions(code):
    """The global functions and variables that a file defines, all its functions, what it
    declares only, and the texts of the functions."""
    names, functions, declared, bodies = set(), set(), set(), []
    depth, start, opened = 0, 0, 0
    for match in re.finditer(r'[{};]', code):
        at = match.start()
        if match[0] == '{':
            opened = at if depth == 0 else opened
            depth += 1
        elif match[0] == '}':
            depth -= 1
            head = code[start:opened].rstrip()
            if depth == 0 and head.endswith(')'):
                name = called(head)
                functions.add(name)
                bodies.append(code[opened:at])
                if not HIDDEN.search(head):
                    names.add(name)
                start = at + 1
        elif depth == 0:
            name = variable(code[start:at])
            if name is None:
                declared.add(called(code[start:at].rstrip()))
            elif re.search(r'\bextern\b', code[start:at]):
                declared.add(name)
            elif name and not re.search(r'\bstatic\b', code[start:at]):
                names.add(name)
            start = at + 1
    return names, functions, declared, bodies


def variable(text):
    """The variable of a declaration without its semicolon; '' if it has none, None if it is
    that of a function."""
    while BRACES.search(text):
        text = BRACES.sub(' ; ', text)
    head = re.split(r'[=\[]', text, maxsplit=1)[0]
    pointer = re.match(r'[\w\s*]*\(\s*\*\s*(\w+)', head)
    words = WORD.findall(head.rpartition(';')[2])
    if re.search(r'\btypedef\b', head):
        return ''
    if pointer:
        return pointer[1]
    if '(' in head:
        return None
    tagged = words and words[0] in ('struct', 'union', 'enum')
    return words[-1] if len(words) > (0 if ';' in head else 2 if tagged else 1) else ''


def called(head):
    """The name before the last pair of parentheses."""
    depth = 0
    for at in range(len(head) - 1, -1, -1):
        depth += {')': 1, '(': -1}.get(head[at], 0)
        if depth == 0:
            return head[:at].split()[-1].lstrip('*') if head[:at].split() else ''
    return ''


def read(root):
    sources = []
    for top in ('gst', 'elements', 'tools', 'tests'):
        for folder, _, names in sorted(os.walk(os.path.join(root, top))):
            sources += [Source(root, os.path.relpath(os.path.join(folder, name), root))
                        for name in sorted(names) if name.endswith(SOURCES)]
    return sources


def arrows(sources):
    """(source, module that it uses, file or name by which) of all that is not a test."""
    product, homes = of_product(sources)
    known = {source.path for source in product}
    found = []
    for source in product:
        for name in source.includes:
            if name in known:
                found.append((source, stem(name), name))
        for name in sorted(source.words & homes.keys()):
            home = min(homes[name])
            # A name of two homes is of two programs; one of a program only serves programs.
            if len(homes[name]) == 1 and (source.room.path == 'tools' or room_of(home).path != 'tools'):
                found.append((source, home, name))
    return [arrow for arrow in found if arrow[0].module != arrow[1]]


def of_product(sources):
    """The sources that are no tests, and the modules that define each global name."""
    product = [source for source in sources if source.room and source.room.path != 'tests']
    homes = {}
    for source in product:
        for name in source.globals:
            homes.setdefault(name, set()).add(source.module)
    return product, homes


def check_declarations(sources):
    """A name is defined once, and declared in its room only: others take it by a door."""
    product, homes = of_product(sources)
    for name, modules in sorted(homes.items()):
        if len(modules) > 1 and any(room_of(module).path != 'tools' for module in modules):
            yield 'globals', '%s: defined by %s' % (name, ', '.join(sorted(modules)))
    for source in product:
        for name in sorted(source.declared & homes.keys()):
            if source.room not in {room_of(module) for module in homes[name]}:
                yield 'doors', '%s: declares %s, which is of %s' % (
                    source.path, name, min(homes[name]))


def circles(pairs):
    """The strongly connected components of more than one node (Tarjan, 1972)."""
    graph, index, low, stack, found = {}, {}, {}, [], []
    for a, b in pairs:
        graph.setdefault(a, set()).add(b)
        graph.setdefault(b, set())

    def visit(a):
        index[a] = low[a] = len(index)
        stack.append(a)
        for b in sorted(graph[a]):
            if b not in index:
                visit(b)
                low[a] = min(low[a], low[b])
            elif b in stack:
                low[a] = min(low[a], index[b])
        if low[a] == index[a]:
            circle = stack[stack.index(a):]
            del stack[stack.index(a):]
            if len(circle) > 1:
                found.append(sorted(circle))

    for a in sorted(graph):
        if a not in index:
            visit(a)
    return found


def check_text(source):
    """Faults of one file by itself, as (rule, text)."""
    path, text, room = source.path, source.text, source.room
    ending = os.path.splitext(path)[1]
    if room is None:
        yield 'rooms', '%s: in no room of the house' % path
    if ending not in ('.c', '.h') and not path.startswith(CPLUSPLUS):
        yield 'cpp', '%s: C++ is only in %s' % (path, ' and '.join(CPLUSPLUS))
    if LICENCE not in text[:2000]:
        yield 'licence', '%s: no line with the licence near the top' % path
    if re.search(r'\b(TODO|FIXME|XXX)\b', text):
        yield 'words', '%s: unfinished work is not left in the source' % path
    # Tests are lists of cases: their length hides nothing.
    lines = text.count('\n')
    if room and room.path != 'tests' and lines > MAX_LINES:
        yield 'size', '%s: %d lines, over %d' % (path, lines, MAX_LINES)
    elif room and room.path != 'tests' and lines > WARN_LINES:
        yield 'long', '%s: %d lines, over %d' % (path, lines, WARN_LINES)
    if room and room.path not in ('tools', 'tests'):
        prefix = 'cloth_' if room in ROOMS else 'gst_'
        for name in sorted(source.globals):
            if not name.startswith(prefix):
                yield 'globals', '%s: %s is global without %s' % (path, name, prefix)
    if OTHER_INCLUDE.search(text) or any('..' in name for name in INCLUDE.findall(text)):
        yield 'includes', '%s: an include by a macro or by ..' % path


def check_includes(root, source):
    """Faults of what one file includes."""
    path, room = source.path, source.room
    for name in source.includes:
        other = room_of(name)
        if name.startswith('opencv') and not path.startswith(CPLUSPLUS):
            yield 'opencv', '%s: OpenCV is only in %s' % (path, ' and '.join(CPLUSPLUS))
        if other and room.path != 'tests' and not name.endswith(SOURCES):
            yield 'includes', '%s: %s is read as C, but has not the name of a source' % (path, name)
        elif room in ROOMS and is_gstreamer(name):
            yield 'gstreamer', '%s: an algorithm room includes %s' % (path, name)
        elif other and not os.path.exists(os.path.join(root, name)):
            yield 'missing', '%s: %s does not exist' % (path, name)
        elif other and not path.startswith(PRY) and not other.is_door(name) and \
                (room != other or os.path.dirname(name) not in (os.path.dirname(path), room.path)
                 and room.doors.get(os.path.relpath(name, room.path).partition('/')[0])):
            yield 'doors', '%s: includes %s, which is no door' % (path, name)


def may_use(room, other):
    """Whether what lies in one room may use the other, which is another."""
    if room == LIBRARY or (room.path, other.path) in APART:
        return False
    if other == LIBRARY:
        return room in UPPER
    return (ROOMS + UPPER).index(other) < (ROOMS + UPPER).index(room)


def check_order(source, module, by):
    """Fault of one arrow between modules, if it goes up."""
    room, other = source.room, room_of(module)
    if room != other:
        if not may_use(room, other):
            yield 'order', '%s: uses %s of %s, which it may not' % (source.path, by, other.path)
    elif room.order:
        # The ending makes a file of a module, as part () takes it.
        here, there = room.part(source.path), room.part(module + '.h')
        steps = room.step(here), room.step(there)
        if None in steps:
            yield 'order', '%s: uses %s, and one of them has no step in %s' % (
                source.path, by, room.path)
        elif here != there and steps[1] >= steps[0]:
            yield 'order', '%s: uses %s, which is not below it' % (source.path, by)


def is_own_door(source, module, by):
    """A private header stands below its module and may see the types of its door."""
    return by == module + '.h' and re.fullmatch(re.escape(module) + '-?private', source.module)


def check_modules(sources):
    found = arrows(sources)
    said = set()
    for source, module, by in found:
        for rule, text in check_order(source, module, by):
            # One fault for a file and what it uses of one folder, not one for each name.
            if (source, os.path.dirname(module)) not in said and \
                    not (source.room in ROOMS and is_gstreamer(by)):
                said.add((source, os.path.dirname(module)))
                yield rule, text
    found = [arrow for arrow in found if not is_own_door(*arrow)]
    for circle in circles({(source.module, module) for source, module, _ in found}):
        ways = {}
        for source, module, by in found:
            if source.module in circle and module in circle:
                ways.setdefault((source.module, module), by)
        yield 'circles', '%s: in a circle of %d modules: %s' % (circle[0], len(circle), '; '.join(
            '%s uses %s by %s' % (a, b, by) for (a, b), by in sorted(ways.items())[:40]))


def check_readmes(root, functions):
    """A room's page names its doors, and nothing that does not exist."""
    for room in ALL[:-1]:
        folder, path = os.path.join(root, room.path), room.path + '/README.md'
        if not os.path.isdir(folder):
            continue
        for part, doors in room.doors.items():
            for door in doors:
                if not glob.glob(os.path.join(folder, part, door)):
                    yield 'table', '%s: has no door %s' % (room.path, os.path.join(part, door))
        if not os.path.exists(os.path.join(root, path)):
            yield 'readme', '%s: missing' % path
            continue
        with open(os.path.join(root, path), encoding='utf-8') as file:
            text = file.read()
        if text.count('\n') > README_LINES:
            yield 'readme', '%s: %d lines, over %d' % (path, text.count('\n'), README_LINES)
        for part, doors in room.doors.items():
            for door in doors:
                if '`%s`' % os.path.join(part, door) not in text and not (
                        door == EACH[0] and 'each header' in text):
                    yield 'readme', '%s: does not name the door %s' % (
                        path, os.path.join(part, door))
        for name in re.findall(r'`([\w./*-]+(?:\.[a-z]{1,4}|/))`', text):
            if not glob.glob(os.path.join(folder, name)) and not glob.glob(os.path.join(root, name)):
                yield 'readme', '%s: %s does not exist' % (path, name)
        yield from check_names(path, text, functions)


def check_names(path, text, functions):
    """functions: the files that define each."""
    for name in sorted(set(OURS.findall(text)) - functions.keys()):
        yield 'names', '%s: there is no function %s ()' % (path, name)
    for name, file in sorted(set(OF_FILE.findall(text))):
        if file not in functions.get(name, [file]):
            yield 'names', '%s: %s () is not in %s' % (path, name, file)


def check_paths(root, path, text):
    for name, rest in sorted(set(NAMED.findall(text))):
        # Of a pattern such as elements/gst<name>.c the folder exists.
        name = os.path.dirname(name) if rest else name.rstrip('.-')
        if not glob.glob(os.path.join(root, name)):
            yield 'paths', '%s: %s does not exist' % (path, name)


def check_documents(root, sources, functions):
    """What the documents and the comments name exists."""
    known = {os.path.basename(source.path) for source in sources} | {'config.h'}
    for source in sources:
        comments = ' '.join(COMMENT.findall(source.text))
        yield from check_paths(root, source.path, comments)
        for name in sorted(set(BARE.findall(comments)) - known):
            yield 'paths', '%s: %s does not exist' % (source.path, name)
    for path in sorted(sum((glob.glob(os.path.join(root, name)) for name in DOCUMENTS), [])):
        with open(path, encoding='utf-8') as file:
            text = file.read()
        path = os.path.relpath(path, root)
        yield from check_paths(root, path, text)
        yield from check_names(path, text, functions)
        for name in sorted(set(re.findall('`' + BARE.pattern + '`', text)) - known):
            yield 'paths', '%s: %s does not exist' % (path, name)


def check(root):
    """All faults as (rule, text)."""
    sources = read(root)
    if not sources:
        yield 'rooms', '%s: no source found' % root
    functions = {}
    for source in sources:
        for name in source.functions:
            functions.setdefault(name, []).append(source.path)
    for source in sources:
        yield from check_text(source)
        if source.room:
            yield from check_includes(root, source)
    yield from check_declarations(sources)
    yield from check_modules(sources)
    yield from check_readmes(root, functions)
    yield from check_documents(root, sources, functions)


def write_tree(root, files):
    for path, text in files.items():
        full = os.path.join(root, path)
        os.makedirs(os.path.dirname(full), exist_ok=True)
        with open(full, 'w', encoding='utf-8') as file:
            file.write(text)


def small_house():
    """A house without a fault, as the table wants it."""
    files = {}
    for room in ALL[:-1]:
        doors = []
        for part, names in room.doors.items():
            for name in names:
                doors.append(os.path.join(part, name))
                files['%s/%s/%s' % (room.path, part, name.replace('*', 'each'))] = \
                    '/* %s */\n' % LICENCE
        files[room.path + '/README.md'] = ' '.join(
            'each header' if '*' in door else '`%s`' % door for door in doors) + '\n'
    files['README.md'] = 'See gst/math/each.h and elements/gst<name>.c, cloth_small().\n'
    files['gst/math/small.c'] = '/* %s */\nvoid\ncloth_small (void)\n{\n}\n' % LICENCE
    return {os.path.normpath(path): text for path, text in files.items()}


def self_test():
    head = '/* ' + LICENCE + ' */\n'
    define = head + 'void\n%s (void)\n{\n}\n'
    use = head + 'static void\nrun (void)\n{\n  %s ();\n}\n'
    cases = [
        ('rooms', {'gst/other/a.c': head}),
        ('cpp', {'gst/vision/a.cpp': head}),
        ('licence', {'gst/math/b.c': '/* no licence */\n'}),
        ('words', {'tools/a.c': head + '/* TO' + 'DO: think */\n'}),
        ('size', {'gst/math/c.c': head + '\n' * MAX_LINES}),
        ('long', {'gst/math/c.c': head + '\n' * WARN_LINES}),
        ('globals', {'gst/math/a.c': define % 'small_sum'}),
        ('globals', {'gst/math/a.c': head + 'int small_table[] = { 1 };\n'}),
        ('globals', {'elements/gsta.c': define % 'cloth_sum'}),
        ('opencv', {'gst/pattern/a.c': head + '#include <opencv2/core.hpp>\n'}),
        ('opencv', {'tests/core/a.c': head + '#include <opencv2/core.hpp>\n'}),
        ('globals', {'gst/cv/a.cpp': define % 'small_sum'}),
        ('order', {'gst/cv/a.cpp': head + '#include "gst/vision/quad/quad.h"\n'}),
        ('gstreamer', {'gst/vision/a.c': head + '#include <gst/gst.h>\n'}),
        ('missing', {'gst/rig/a.c': head + '#include "gst/math/gone.h"\n'}),
        ('doors', {'gst/fit/a.c': head + '#include "gst/sim/body.h"\n', 'gst/sim/body.h': head}),
        ('doors', {'gst/vision/quad/a.c': head + '#include "gst/vision/corner/b.h"\n',
                   'gst/vision/corner/b.h': head}),
        ('doors', {'tests/elements/a.c': head + '#include "gst/sim/body.h"\n',
                   'gst/sim/body.h': head}),
        ('doors', {'elements/gsta.c': head + 'void cloth_rig_sum (void);\n',
                   'gst/rig/a.c': define % 'cloth_rig_sum'}),
        ('doors', {'elements/gsta.c': head + 'extern struct Rig cloth_rig;\n',
                   'gst/rig/a.c': head + 'struct Rig cloth_rig = { 1 };\n'}),
        ('globals', {'gst/math/a.c': head + 'struct Sum small_sum = { 1 };\n'}),
        ('globals', {'gst/math/a.c': head + 'void (*small_hook) (void);\n'}),
        ('globals', {'gst/math/a.c': head + 'struct { int a; } small_sum;\n'}),
        ('globals', {'gst/math/a.c': define % 'cloth_sum', 'gst/rig/a.c': define % 'cloth_sum'}),
        ('includes', {'gst/math/a.c': head + '#include FILE_OF_SUMS\n'}),
        ('includes', {'gst/math/a.c': head + '#include "table.inc"\n', 'gst/math/table.inc': head}),
        ('includes', {'gst/vision/dot/a.c': head + '#include "../image.h"\n'}),
        ('gstreamer', {'gst/rig/a.c': head + '#include <gstreamer-1.0/gst/gst.h>\n'}),
        ('order', {'gst/math/a.h': head + '#define SUM \\\n  cloth_rig_sum ()\n',
                   'gst/rig/a.c': define % 'cloth_rig_sum'}),
        ('order', {'gst/math/a.c': head + '#include "gst/vision/quad/quad.h"\n'}),
        ('order', {'gst/math/a.c': use % 'cloth_rig_sum', 'gst/rig/a.c': define % 'cloth_rig_sum'}),
        ('order', {'gst/cloth/a.c': head + '#include "gst/math/each.h"\n'}),
        ('order', {'gst/mesh/a.c': head + '#include "elements/each.h"\n'}),
        ('order', {'elements/a.c': head + '#include "tools/each.h"\n'}),
        ('order', {'tools/a.c': head + '#include "elements/each.h"\n'}),
        ('order', {'gst/vision/corner/a.c': head + '#include "gst/vision/quad/quad.h"\n'}),
        ('order', {'gst/mesh/fill/a.c': use % 'cloth_obj_sum',
                   'gst/mesh/garment/obj.c': define % 'cloth_obj_sum'}),
        ('circles', {'gst/rig/a.h': head + '#include "gst/rig/b.h"\n',
                     'gst/rig/b.h': head + '#include "gst/rig/a.h"\n'}),
        ('circles', {'gst/rig/a.c': define % 'cloth_a' + (use % 'cloth_b'),
                     'gst/rig/b.c': define % 'cloth_b' + (use % 'cloth_a')}),
        ('circles', {'gst/rig/a.h': head, 'gst/rig/b.c': define % 'cloth_b' +
                     '#include "gst/rig/a.h"\n', 'gst/rig/a.c': use % 'cloth_b'}),
        ('circles', {'gst/sim/lanes/a.c': define % 'CLOTH_LANE_NAME (cloth_a)' + (use % 'cloth_b'),
                     'gst/sim/lanes/b.c': define % 'cloth_b' +
                     (use % 'CLOTH_LANE_NAME (cloth_a)')}),
        ('table', {'gst/take/take.h': None}),
        ('readme', {'gst/math/README.md': None}),
        ('readme', {'gst/math/README.md': 'each header\n' + '\n' * README_LINES}),
        ('readme', {'gst/effect/README.md': 'One door: `effect.h`\n'}),
        ('readme', {'gst/math/README.md': 'each header; first `gone.c`\n'}),
        ('names', {'gst/math/README.md': 'each header; cloth_gone ()\n'}),
        ('names', {'docs/a.md': 'It calls `cloth_gone()`.\n'}),
        ('names', {'docs/a.md': '`cloth_small()` of `gst/math/each.h`\n'}),
        ('paths', {'docs/a.md': 'See `gst/gone/a.c`.\n'}),
        ('paths', {'docs/a.md': 'See `gone.c`.\n'}),
        ('paths', {'CONTRIBUTING.md': 'See `tests/gone*`.\n'}),
        ('paths', {'gst/math/a.c': head + '/* As in gone.c. */\n'}),
        ('paths', {'elements/gsta.c': head + '/* As in gst/gone/a.h. */\n'}),
        # A private header sees its own module's door; tests/core sees all.
        (None, {'gst/rig/rig-private.h': head + '#include "gst/rig/rig.h"\n',
                'gst/rig/rig.c': head + '#include "gst/rig/rig-private.h"\n'}),
        (None, {'tests/core/a.c': head + '#include "gst/sim/body.h"\n', 'gst/sim/body.h': head}),
        (None, {'gst/cv/a.cpp': head + '#include <opencv2/core.hpp>\n'}),
    ]
    status = 0
    for rule, files in cases:
        house = {**small_house(), **files}
        if rule == 'table':
            # What is gone is gone from the page as well.
            house['gst/take/README.md'] = 'each door: `sequence.h`\n'
        with tempfile.TemporaryDirectory() as root:
            write_tree(root, {path: text for path, text in house.items() if text is not None})
            faults = [fault for fault in check(root)
                      if rule != 'table' or fault[0] != 'readme']
        if [fault[0] for fault in faults] != [rule] * (rule is not None):
            print('%s expected of %s, found %s' % (rule, sorted(files), faults))
            status = 1
    print('%d cases' % len(cases))
    return status


def print_table():
    for room in ALL:
        print('%-13s %s' % (room.path, room.what))
        print('%-13s %s' % ('', '  '.join(
            os.path.join(part, door) for part, doors in room.doors.items() for door in doors)))
        if room.order:
            print('%-13s %s' % ('', ' < '.join(
                ', '.join(part or '.' for part in step) for step in room.order)))


def main(arguments):
    sys.setrecursionlimit(10000)
    if arguments == ['--self-test']:
        return self_test()
    if arguments == ['--table']:
        print_table()
        return 0
    faults = list(check(arguments[0]))
    status = 0
    for rule, text in faults:
        told = rule == 'long' or any(
            rule == kind and text.startswith(start) for kind, start in PENDING)
        print('%s: %s: %s' % ('warning' if told else 'error', rule, text))
        status |= not told
    return int(status)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
