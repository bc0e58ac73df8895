#!/usr/bin/python3
"""Draws the rooms of the house as floors.py has them, with what one uses of another.

  architecture.py --write FILE.svg ROOT    draws
  architecture.py --check FILE.svg ROOT    says whether FILE.svg is what is drawn today

A room stands one floor above the highest room that it uses. Of the arrows only those are
drawn that don't follow from others; all are measured in the sources.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import sys
from xml.sax.saxutils import escape

sys.dont_write_bytecode = True
import floors

WIDTH, MARGIN, BOX, HEIGHT, BETWEEN = 1220, 20, 218, 98, 58
GAP, LANE = 22, 26
# Ink and paper that are read on a bright page as on a dark one.
ARROW, INK, FAINT = '#7d8795', '#1d2733', '#51606f'
PAPER = {'algorithm': ('#dfe9f3', '#7f9dbd'), 'gstreamer': ('#f6e6cf', '#c99f5c')}
FONT = 'font-family="DejaVu Sans, Verdana, sans-serif"'


def uses_of(sources):
    """The rooms that each room uses, by the table's rules; none through another."""
    rooms = [room for room in floors.ALL if room.path != 'tests']
    uses = {room: set() for room in rooms}
    for source, module, _ in floors.arrows(sources):
        other = floors.room_of(module)
        if other != source.room and floors.may_use(source.room, other):
            uses[source.room].add(other)

    def below(room):
        return uses[room].union(*(below(other) for other in uses[room]))

    return {room: [other for other in rooms if other in uses[room] and
                   not any(other in below(third) for third in uses[room])] for room in rooms}


def storeys(uses):
    """The rooms of each floor, the lowest first, and the arrows cut at each floor: a
    bend is a pair of the arrow and its floor."""
    floor = {}

    def find(room):
        if room not in floor:
            floor[room] = max([find(other) + 1 for other in uses[room]], default=0)
        return floor[room]

    for room in uses:
        find(room)
    rows = [[room for room in uses if floor[room] == i] for i in range(max(floor.values()) + 1)]
    links, ways = [], []
    for room in uses:
        for other in uses[room]:
            way = [room] + [((room.path, other.path), i)
                            for i in range(floor[room] - 1, floor[other], -1)] + [other]
            for bend in way[1:-1]:
                rows[bend[1]].append(bend)
            links += zip(way, way[1:])
            ways.append(way)
    return rows, links, ways


def crossings(rows, links):
    place = {node: (i, k) for i, row in enumerate(rows) for k, node in enumerate(row)}
    spans = [(place[a][0], place[a][1], place[b][1]) for a, b in links]
    return sum(s[0] == t[0] and (s[1] - t[1]) * (s[2] - t[2]) < 0
               for i, s in enumerate(spans) for t in spans[:i])


def middle(node, links, row):
    near = [b if a is node else a for a, b in links if a is node or b is node]
    near = [row.index(other) for other in near if other in row]
    return sum(near) / len(near) if near else None


def untangle(rows, links):
    """Orders each row by the middle of its neighbours (Sugiyama et al., 1981), then swaps
    neighbours as long as that leaves fewer crossings."""
    best = [list(row) for row in rows]
    for sweep in range(24):
        down = sweep % 2 == 0
        for i in range(1, len(rows)) if down else range(len(rows) - 2, -1, -1):
            beside = rows[i - 1 if down else i + 1]
            key = {id(node): middle(node, links, beside) for node in rows[i]}
            # What has no neighbours stays where it is.
            key = {id(node): k / len(rows[i]) * len(beside) if key[id(node)] is None
                   else key[id(node)] for k, node in enumerate(rows[i])}
            rows[i].sort(key=lambda node: key[id(node)])
        if crossings(rows, links) < crossings(best, links):
            best = [list(row) for row in rows]
    better = True
    while better:
        better = False
        for row in best:
            for k in range(len(row) - 1):
                before = crossings(best, links)
                row[k:k + 2] = row[k + 1], row[k]
                if crossings(best, links) < before:
                    better = True
                else:
                    row[k:k + 2] = row[k + 1], row[k]
    return best


def is_room(node):
    return isinstance(node, floors.Room)


def spread(row, wish):
    """The places nearest to those wished for that leave room (pooled neighbours)."""
    offset, at = [], 0
    for k, node in enumerate(row):
        width = BOX if is_room(node) else LANE
        at += (width / 2 + GAP / 2) * (k > 0)
        offset.append(at)
        at += width / 2 + GAP / 2
    first = BOX if is_room(row[0]) else LANE
    last = BOX if is_room(row[-1]) else LANE
    low, high = MARGIN + first / 2, WIDTH - MARGIN - last / 2 - offset[-1]
    pools = []
    for k in range(len(row)):
        pools.append([wish[k] - offset[k], 1])
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            value, n = pools.pop()
            pools[-1] = [(pools[-1][0] * pools[-1][1] + value * n) / (pools[-1][1] + n),
                         pools[-1][1] + n]
    places = sum(([value] * n for value, n in pools), [])
    return [min(max(value, low), max(low, high)) + offset[k] for k, value in enumerate(places)]


def settle(rows, ways):
    """x of each node: a room near those that it has to do with, an arrow straight."""
    x = {}
    for row in rows:
        step = (WIDTH - 2 * MARGIN) / len(row)
        x.update(zip(row, spread(row, [MARGIN + step * (k + .5) for k in range(len(row))])))

    def wish(node, ends):
        near = []
        for way in ways:
            if node in way[1:-1]:
                near += [way[0], way[-1]] if ends else way[1:-1]
            elif node in way:
                # The next node; and the other end, of what is long.
                near += [way[1], way[-1]] if node is way[0] else [way[-2], way[0]]
        return sum(x[other] for other in near) / len(near) if near else x[node]

    for turn in range(80):
        for row in rows:
            x.update(zip(row, spread(row, [wish(node, turn < 20) for node in row])))
    return x


def wrap(text, most):
    lines = ['']
    for word in text.split():
        if len(lines[-1]) + len(word) >= most and lines[-1]:
            lines.append('')
        lines[-1] = (lines[-1] + ' ' + word).strip()
    return lines


def sub_rooms(room, sources):
    """Its folders, the lowest first."""
    found = {source.path[len(room.path) + 1:].partition('/')[0] for source in sources
             if source.room is room and '/' in source.path[len(room.path) + 1:]}
    steps = [part for step in room.order for part in step]
    return sorted(found, key=lambda part: (steps.index(part) if part in steps else 0, part))


def draw_box(room, parts, x, y):
    kind = 'algorithm' if room in floors.ROOMS else 'gstreamer'
    paper, edge = PAPER[kind]
    yield ('<rect x="%d" y="%d" width="%d" height="%d" rx="9" fill="%s" stroke="%s" '
           'stroke-width="1.5"/>' % (x - BOX / 2, y, BOX, HEIGHT, paper, edge))
    rows = [(room.path, 15, INK, ' font-weight="bold"'), (room.what, 12.5, INK, '')]
    rows += [(line, 11, FAINT, '') for line in wrap(' '.join(part + '/' for part in parts), 36)
             if line]
    top = y + HEIGHT / 2 - 16.5 * len(rows) / 2 + 13
    for k, (text, size, ink, weight) in enumerate(rows):
        yield '<text x="%d" y="%d" font-size="%g" fill="%s"%s>%s</text>' % (
            x, top + 16.5 * k, size, ink, weight, escape(text))


def draw(root):
    sources = floors.read(root)
    rows, links, ways = storeys(uses_of(sources))
    rows = untangle(rows, links)
    x = settle(rows, ways)
    total = len(rows) * (HEIGHT + BETWEEN) - BETWEEN + 2 * MARGIN
    y = {node: MARGIN + (len(rows) - 1 - i) * (HEIGHT + BETWEEN)
         for i, row in enumerate(rows) for node in row}
    # Arrows leave and reach a box side by side, in the order of where they come from.
    port = {}
    for node in x:
        if is_room(node):
            for side, other in ((0, 1), (1, 0)):
                mine = sorted((link for link in links if link[side] is node),
                              key=lambda link: x[link[other]])
                for k, link in enumerate(mine):
                    port[link, side] = x[node] + (k - (len(mine) - 1) / 2) * \
                        min(34, (BOX - 50) / max(1, len(mine) - 1))
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" width="%d" height="%d">'
           % (WIDTH, total, WIDTH, total),
           '<!-- Made by tests/generic/architecture.py: meson compile -C build docs-architecture -->',
           '<defs><marker id="head" viewBox="0 0 10 10" refX="8.5" refY="5" markerWidth="8" '
           'markerHeight="8" markerUnits="userSpaceOnUse" orient="auto"><path '
           'd="M0,1 L9,5 L0,9 Z" fill="%s"/></marker></defs>' % ARROW,
           '<g fill="none" stroke="%s" stroke-width="1.6">' % ARROW]
    for way in ways:
        path = ''
        for a, b in zip(way, way[1:]):
            ax, bx = port.get(((a, b), 0), x[a]), port.get(((a, b), 1), x[b])
            ay, by = y[a] + HEIGHT, y[b]
            path += '%s C%d,%d %d,%d %d,%d' % (
                '' if path else 'M%d,%d' % (ax, ay), ax, ay + BETWEEN * .55,
                bx, by - BETWEEN * .55, bx, by)
            # A bend leads straight past its floor.
            path += '' if is_room(b) else ' L%d,%d' % (bx, by + HEIGHT)
        out.append('<path d="%s" marker-end="url(#head)"/>' % path)
    out.append('</g>')
    out.append('<g %s text-anchor="middle">' % FONT)
    for node in x:
        if is_room(node):
            out += draw_box(node, sub_rooms(node, sources), round(x[node]), y[node])
    out.append('</g>')
    out.append('</svg>')
    return '\n'.join(out) + '\n'


def main(what, path, root):
    drawn = draw(root)
    if what == '--write':
        with open(path, 'w', encoding='utf-8') as file:
            file.write(drawn)
        return 0
    with open(path, encoding='utf-8') as file:
        if file.read() == drawn:
            return 0
    print('%s is not what is drawn today: meson compile -C build docs-architecture' % path)
    return 1


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
