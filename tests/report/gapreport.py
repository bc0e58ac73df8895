#!/usr/bin/python3
"""gap.json against its schema, and the report in a browser.

  gapreport.py json PROGRAM ROOT              gap.json, by tests/report/gapsheet.c
  gapreport.py page PROGRAM                   report.html
  gapreport.py picture GAP PICTURE ARGUMENT…  docs' picture, of what GAP says with ARGUMENTs

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import base64
import copy
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time

import jsonschema
import numpy

from pages import check_policy, differs, fits, move, open_page, refuse_webgl
from webdriver import Browser

HOSTILE = '</script><script>window.hacked=1</script><img src=x onerror=window.hacked=1>"\'&\ufffd\n\u2028<!--'


def written(program, kind, folder):
    # A warning of GLib is a fault.
    subprocess.run([program, kind, folder], check=True, env={**os.environ, 'G_DEBUG': 'fatal-warnings'})
    with open(os.path.join(folder, 'gap.json'), encoding='utf-8') as file:
        return json.load(file, parse_constant=lambda name: sys.exit('gap.json has %s' % name))


def refused(schema, gap, path, value):
    """Whether the schema refuses what would be right but for this."""
    gap = copy.deepcopy(gap)
    at = gap
    for key in path[:-1]:
        at = at[key]
    if value is KeyError:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    return not schema.is_valid(gap)


def check_json(program, root):
    with open(os.path.join(root, 'docs/gap.schema.json'), encoding='utf-8') as file:
        text = json.load(file)
    jsonschema.Draft202012Validator.check_schema(text)
    schema = jsonschema.Draft202012Validator(text)
    with tempfile.TemporaryDirectory() as folder:
        kinds = {kind: written(program, kind, folder) for kind in
                 ('sheet', 'example', 'spare', 'empty', 'unknown', 'calm', 'wordy', 'hostile')}
        assert sorted(os.listdir(folder)) == ['gap.json', 'report.html'], os.listdir(folder)
        with open(os.path.join(folder, 'gap.json'), 'rb') as file:
            assert b'<' not in file.read(), 'gap.json can end a script'
    for kind, gap in kinds.items():
        if kind != 'empty':
            schema.validate(gap)
    # Without a reason nobody may call it undecidable.
    assert not schema.is_valid(kinds['empty'])
    with open(os.path.join(root, 'docs/gap.example.json'), encoding='utf-8') as file:
        assert json.load(file) == kinds['example'], 'docs/gap.example.json is not what is written today'
    sheet = kinds['sheet']
    assert sheet['verdict'] == 'explained'
    assert re.fullmatch(r'Gap 3\.5 mm, 4\.\d× the floor\. Air drag explains 9\d% \[\d+, \d+\] on an unseen take\.',
                        sheet['summary']), sheet['summary']
    assert len(sheet['where']['vertices']) == 33 * 35 and len(sheet['where']['frames']) == 250
    assert abs(sum(sheet['where']['vertices']) - 1) < 1e-4
    assert sheet['effects'][0]['parameters'] == [{'name': 'coefficient', 'value': 1.14, 'sigma': 0.06, 'unit': '1'}]
    assert sheet['groups'][0]['effects'] == ['air_drag_linear', 'damping_mass']
    assert sheet['where']['stages'][0] == {'name': 'camera', 'share': None, 'reason': 'The take has no rig.json.'}
    assert sheet['where']['waves'][3] == {'from_per_m': 2.3, 'to_per_m': None, 'share': 0.08, 'after': 0.04, 'over_floor': 1.3}
    assert sheet['effects'][0]['log_bayes_factor'] == 4.783914, sheet['effects'][0]
    assert sheet['sets'] == [{'effects': ['air_drag'], 'rival': None, 'probability': 0.904},
                             {'effects': ['air_drag_linear'], 'rival': None, 'probability': 0.048}]
    assert sheet['rivals'] == {'none_acts': 0.0001, 'force_field': 0.019, 'displacement_field': 0.002}
    assert [take['role'] for take in sheet['takes']] == ['take', 'hold_out', 'baseline']
    assert sheet['takes'][0]['gap_before'] == sheet['gap_before']
    assert sheet['predicted_shrink']['free'] == {'value': 0.78, 'interval': [0.6, 0.88]}
    assert sheet['detection_limits'][0] == {'effect': 'air_drag', 'side': 'physics', 'parameter': 'coefficient', 'value': 0.09,
                                            'unit': '1', 'text': 'air drag: coefficient above 0.09'}
    assert [limit['text'] for limit in sheet['detection_limits'][3:]] == ['wind: z beyond ±0.35 m/s',
        'clamp delay: delay beyond ±0.0052 s', 'bending: factor below 0.6 or above 1.4', 'grain angle: unseen, whatever its angle']
    assert sheet['detection_limits'][-1]['value'] is None
    assert sheet['patch'] == [
        {'name': 'effects.air_drag.coefficient', 'text': 'air drag coefficient 1.14', 'before': None, 'after': 1.14, 'unit': '1', 'factor': None},
        {'name': 'areal_density', 'text': 'areal density × 0.61', 'before': 0.2, 'after': 0.122, 'unit': 'kg/m²', 'factor': 0.61}]
    assert sheet['free_numbers'][2] == {'name': 'damping.mass', 'unit': '1/s', 'value': 0.8, 'sigma': 0.1, 'range': [0.08, 0.8],
                                        'at_end': True}
    assert sheet['free_correlation'][1] == [0.31, 1, -0.94]
    assert sheet['thresholds'][0]['origin'] == 'simulated'
    assert kinds['hostile']['free_correlation'] is None and kinds['hostile']['sets'][2]['rival'] == 'force_field'
    assert kinds['unknown']['takes'][0]['free_before'] == {'value': None, 'interval': None}
    assert kinds['unknown']['free_correlation'] == 3 * [3 * [None]]
    assert kinds['calm']['sets'][0]['effects'] == [] and kinds['calm']['sets'][1]['rival'] == 'displacement_field'
    gained = (sheet['gap_before']['value'] ** 2 - sheet['gap_after']['value'] ** 2) / sheet['gap_before']['value'] ** 2
    assert abs(sum(sheet['where']['gained']) - gained) < 0.01, (sum(sheet['where']['gained']), gained)
    assert kinds['hostile']['reason'] == HOSTILE
    for path, value in ((['verdict'], 'perhaps'), (['verdict'], KeyError), (['version'], 1), (['extra'], 1),
                        (['gap_before', 'value'], -1), (['gap_before', 'interval'], [1]),
                        (['effects', 0, 'probability'], 1.01), (['effects', 0, 'side'], 'moon'),
                        (['effects', 0, 'parameters', 0, 'unit'], KeyError), (['effects', 0, 'group'], -1),
                        (['effects'], []), (['effects', 0, 'refitted'], False), (['effects', 0, 'log_bayes_factor'], 'much'),
                        (['takes', 0, 'role'], 'model'), (['takes', 1, 'free_before'], KeyError),
                        (['takes', 0, 'free_floor', 'value'], -1), (['takes_agree_p_value'], 2), (['has_simulated'], None),
                        (['predicted_shrink', 'free'], KeyError), (['measured_shrink', 'windows', 'value'], 'half'),
                        (['sets', 0, 'rival'], 'none'), (['sets', 0, 'probability'], 1.1), (['sets', 0, 'effects', 0], ''),
                        (['rivals', 'none_acts'], KeyError), (['rivals', 'force_field'], -0.1),
                        (['detection_limits', 0, 'parameter'], ''), (['detection_limits', 0, 'side'], 'left'),
                        (['patch', 0, 'text'], ''), (['patch', 0, 'after'], KeyError), (['patch_simulator'], 7),
                        (['free_numbers', 0, 'sigma'], -1), (['free_numbers', 0, 'range'], [0]),
                        (['free_numbers', 0, 'at_end'], 1), (['free_correlation', 0, 1], 1.2),
                        (['thresholds', 0, 'origin'], 'hearsay'), (['thresholds', 0, 'reason'], KeyError),
                        (['where', 'vertices'], 'all'), (['where', 'directions', 'up'], 0.1),
                        (['where', 'static'], 1.5), (['where', 'waves'], KeyError), (['where', 'gained', 0], 1.5),
                        (['where', 'bands', 0, 'over_floor'], -1), (['where', 'bands', 0, 'to_hz'], None),
                        (['where', 'stages', 0, 'reason'], KeyError), (['where', 'waves', 0, 'after'], KeyError),
                        (['seed'], 1.5), (['inputs', 0, 'sha256'], 'abc'), (['inputs', 0, 'role'], 'witness')):
        assert refused(schema, sheet, path, value), path


def check_failures(program):
    """Nothing half-written where nothing can be written."""
    with tempfile.TemporaryDirectory() as folder:
        missing = os.path.join(folder, 'missing')
        outcome = subprocess.run([program, 'example', missing], capture_output=True, text=True)
        assert outcome.returncode == 1 and 'missing' in outcome.stderr, outcome
        os.mkdir(os.path.join(folder, 'report.html'))
        outcome = subprocess.run([program, 'example', folder], capture_output=True, text=True)
        assert outcome.returncode == 1 and 'report.html' in outcome.stderr, outcome
        assert sorted(os.listdir(folder)) == ['gap.json', 'report.html'], os.listdir(folder)


def arrays_of(program, kind, folder):
    """The packed arrays of a page, unpacked."""
    written(program, kind, folder)
    with open(os.path.join(folder, 'report.html'), encoding='utf-8') as file:
        page = file.read()
    assert len(page.encode()) < 9e6, len(page)
    play = json.loads(re.search(r'<script type="application/json" id="arrays">\n(.*?)</script>', page, re.S)[1])['playback']
    for name in ('recorded', 'before', 'after'):
        packed = numpy.frombuffer(base64.b64decode(play[name]), '<u2').reshape(len(play['times']), -1, 3)
        play[name] = numpy.where(packed == 65535, numpy.nan, packed * play['step'] + play['origin'])
    play['uv'] = numpy.frombuffer(base64.b64decode(play['uv']), '<f4').reshape(-1, 2)
    play['faces'] = numpy.frombuffer(base64.b64decode(play['faces']), '<u4').reshape(-1, 4)
    play['sigma'] = play['sigma_scale'][0] * numpy.exp(play['sigma_scale'][1] * numpy.frombuffer(
        base64.b64decode(play['sigma']), 'u1')).reshape(len(play['times']), -1)
    return play


def check_arrays(program):
    """What gapsheet.c says of its sheet in closed form, from the page's bytes."""
    with tempfile.TemporaryDirectory() as folder:
        plain = arrays_of(program, 'sheet', folder)
        thin = arrays_of(program, 'long', folder)
        coarse = arrays_of(program, 'fine', folder)
    assert plain['recorded'].shape == (250, 1155, 3) and plain['frame_step'] == plain['vertex_step'] == 1
    assert plain['faces'].shape == (32 * 34, 4)
    assert thin['vertex_step'] == 1 and thin['frame_step'] > 1 and thin['before'].shape[0] == (400 - 1) // thin['frame_step'] + 1
    assert coarse['vertex_step'] == 2 and coarse['frame_step'] == 1
    assert coarse['before'].shape == (60, 51 * 52, 3) and coarse['faces'].shape == (50 * 51, 4)
    assert numpy.allclose(coarse['uv'].max(axis=0), [0.63, 0.67])
    for play in (plain, thin, coarse):
        assert play['step'] < 1e-4
        seconds = numpy.array(play['times'])[:, None]
        assert numpy.allclose(seconds[:, 0], numpy.arange(len(seconds)) * play['frame_step'] / 50)
        u = play['uv'][None, :, 0]
        top = play['uv'][:, 1] == 0
        # Nothing but small folds move the top edge.
        folds = 0.018 * 0.25 * numpy.cos(2 * math.pi * u / 0.21 + 0.6 * numpy.sin(2 * seconds))
        edge = numpy.stack(numpy.broadcast_arrays((u - 0.315) * 0.95, folds, 1.6), axis=2)[:, top]
        assert numpy.abs(play['before'][:, top] - edge).max() < 0.51 * play['step'] + 1e-6
        noise = play['recorded'][:, top] - edge
        assert abs(numpy.nanstd(noise) / 0.0004 - 1) < 0.02, numpy.nanstd(noise)
        hole = numpy.hypot(u - 0.2, play['uv'][None, :, 1] - 0.35) < 0.07
        unseen = hole & (seconds > 1.5) & (seconds < 1.9)
        assert unseen.any() == (play is not coarse)
        assert (numpy.isnan(play['recorded']).any(axis=2) == unseen).all()
        expected = 0.0004 * math.sqrt(3) + 0.002 * play['uv'][None, :, 1] / 0.67
        assert numpy.abs(play['sigma'] / expected - 1).max() < 0.031


def open_report(browser, folder):
    open_page(browser, os.path.join(folder, 'report.html'))


def show(browser, program, kind, folder, complaint=None):
    written(program, kind, folder)
    path = os.path.join(folder, 'report.html')
    started = time.monotonic()
    open_report(browser, folder)
    log = browser.log()
    assert all(complaint and complaint in line for line in log), log
    assert browser.run('return performance.getEntriesByType("resource").length') == 0
    print('%s: %.1f MB, ready in %.1f s' % (kind, os.path.getsize(path) / 1e6, time.monotonic() - started))


def check_table(browser):
    assert browser.text('#verdict .pill') == 'Explained'
    assert browser.text('#summary').startswith('Gap 3.5 mm, 4.')
    rows = browser.run('return [...document.querySelectorAll("#ranking tbody tr")].map(row => '
                       '[...row.children].map(cell => cell.innerText))')
    first = ' '.join(' '.join(rows[0]).split())
    assert re.fullmatch(r'1 Air drag physics accepted Air resists with the square of the speed\. 93% p < 0\.0001 '
                        r'coefficient 1\.14 \[1\.02, 1\.26\] 9\d% \[\d+, \d+\]', first), first
    wind = ' '.join(' '.join(rows[3]).split())
    assert 'y −0.21 m/s [−0.37, −0.05]' in wind and 'changes over time' in wind, wind
    assert rows[1][4].strip() == 'damping mass', rows[1]
    hidden = 'return [...document.querySelectorAll("#ranking tr")].filter(row => row.hidden).length'
    assert browser.run(hidden) == 2
    browser.click('#effects > button')
    assert browser.run(hidden) == 0
    browser.click('#effects > button')
    assert 'no rig.json' in browser.run('return document.getElementById("untested").textContent')
    assert 'Camera: The take has no rig.json.' in browser.run('return document.querySelector(".shares details").textContent')
    shares = browser.run('return [...document.querySelectorAll(".shares")].map(table => table.textContent)')
    assert 'Stands still4%' in shares[2] and '0.5–2 Hz78%31× the floor, 5% left' in shares[2], shares[2]
    assert 'As a whole12%' in shares[3] and 'Below 43 cm8%1.3× the floor, 4% left' in shares[3], shares[3]
    assert browser.run('return [...document.querySelectorAll(".map figcaption")].map(node => node.textContent)')[2:] == \
        ['Share of the gap, whole take', 'What the effects take off it']
    place = browser.text('#place')
    assert place.startswith('More than chance makes it, the gap is at 33 of 1155 vertices (3%'), place
    assert place.endswith('from 0.8 s on.'), place
    assert browser.run('return [...document.querySelectorAll("#inputs code")].map(node => node.title)')[0].startswith('9f86d0')
    assert 'Shake the upper edge' in browser.text('#next')
    assert 'diverged at 1.34 s' in browser.text('#failures')
    assert '352 simulations, of which 1 failed, in 41.7 s; seed 1.' in browser.text('#provenance')


def table_of(browser, name):
    return browser.run('return [...document.querySelectorAll(arguments[0] + " tbody tr")].map(row => '
                       '[...row.children].map(cell => cell.innerText.split(/\\s+/).join(" ").trim()))', '#' + name)


def check_numbers(browser):
    """What there is to do and to know, as gapsheet.c has it."""
    assert table_of(browser, 'changes') == [
        ['effects.air_drag.coefficient', 'not there', '1.14', 'air drag coefficient 1.14'],
        ['areal_density', '0.2 kg/m²', '0.122 kg/m²', 'areal density × 0.61']]
    assert 'add to your simulation' in browser.text('#patch')
    assert table_of(browser, 'brings') == [['windows of 0.3 s', '91% [84, 96]', '88% [80, 93]'],
                                           ['the free run', '78% [60, 88]', '71% [58, 81]']]
    assert table_of(browser, 'numbers') == [
        ['Areal density', '0.122 kg/m² [0.114, 0.130]', '0.04 to 0.4 kg/m²', 'bending warp (r 0.31)'],
        ['Bending warp', '0.000021 N·m [0.000015, 0.000027]', '1·10⁻⁵ to 1·10⁻⁴ N·m', 'damping mass (r −0.94)'],
        ['Damping mass', '0.80 1/s [0.60, 1.00]', '0.08 to 0.8 1/s At the end: the range, or the model, may be too narrow.',
         'bending warp (r −0.94)']]
    takes = table_of(browser, 'per-take')
    assert [row[0] for row in takes] == ['waving sheet diagnosed take', 'waving sheet, fast unseen take', 'hanging sheet baseline take']
    assert takes[0][1:3] == ['3.5 mm → 1.1 mm', '0.8 mm'] and takes[0][4:] == ['20.7 mm → 9.5 mm', '1.6 mm'], takes[0]
    assert '42% (p 0.42)' in browser.text('#agree')
    limits = browser.run('return [...document.querySelectorAll("#limits li")].map(node => node.textContent)')
    assert len(limits) == 6 and limits[0] == 'Air drag: coefficient above 0.09' and limits[5] == 'Bending: factor below 0.6 or above 1.4'
    assert browser.text('#limits').endswith('Not seen here, however large: grain angle.')
    assert browser.run('return [...document.querySelectorAll("#sets li")].map(node => node.textContent)') == [
        'Air drag alone 90%', 'Air drag linear alone 5%']
    assert 'that an unknown force acts is 2%' in browser.text('#rivals'), browser.text('#rivals')
    assert table_of(browser, 'thresholds')[2] == ['Window', '0.3 s', 'What the word means The gap is that over windows of 0.3 s.']
    assert not browser.run('return document.getElementById("unseen")')


def check_copy(browser):
    browser.devtools('Browser.grantPermissions', permissions=['clipboardReadWrite', 'clipboardSanitizedWrite'])
    browser.click('#copy')
    for _ in range(100):
        browser.settle()
        if browser.text('#copied'):
            break
    assert browser.text('#copied') == 'Copied.', browser.text('#copied')
    assert browser.run('return document.activeElement.id') == 'copy'
    assert browser.run('return navigator.clipboard.readText()') == (
        'effects.air_drag.coefficient = 1.14  # new; air drag coefficient 1.14\n'
        'areal_density = 0.122  # kg/m²; was 0.2; areal density × 0.61\n')


def check_refused_copy(browser):
    """Where pages may not copy, they say so."""
    for allowed, said in (('true', 'Copied.'), ('false', 'This browser does not let pages copy')):
        browser.run('navigator.clipboard.writeText = () => Promise.reject(new Error("no"));'
                    'document.execCommand = () => %s; document.getElementById("copied").textContent = ""' % allowed)
        browser.click('#copy')
        browser.settle()
        assert browser.text('#copied').startswith(said), browser.text('#copied')
        assert browser.run('return document.activeElement.id + document.querySelectorAll("textarea").length') == 'copy0'


def check_points(browser, play):
    """Which points are shown, against the page's own arrays."""
    captions = browser.run('return [...document.querySelectorAll(".point figcaption")].map(node => node.innerText)')
    squares = numpy.nansum((play['before'] - play['recorded']) ** 2, axis=(0, 2))
    worst = int(squares.argmax())
    rms = [1000 * math.sqrt(numpy.nanmean(((play[name] - play['recorded'])[:, worst] ** 2).sum(axis=1))) for name in ('before', 'after')]
    u, v = play['uv'][worst]
    assert captions[0].split('\n') == ['Point 1: u %.3g m, v %.3g m on the flat cloth' % (u, v),
                                       'Before %.1f mm and after %.1f mm' % tuple(rms)], captions
    # The gap grows to the lower edge, whose ends are furthest from one another.
    assert [caption.split('\n')[0] for caption in captions[1:]] == [
        'Point %d: u %s m, v 0.67 m on the flat cloth' % (i, end) for i, end in ((2, '0.63'), (3, '0'))], captions
    assert browser.run('return document.getElementById("way-y").checked'), 'the sheet waves along y'
    for way in ('distance', 'x', 'y'):
        assert differs(browser, '#points canvas', lambda: browser.click('#way-' + way)), way
    assert 'start anew' in browser.text('#points .note')
    move(browser, 0)
    browser.run('const over = document.querySelector("#points .u-over"), box = over.getBoundingClientRect();'
                'for (const type of ["mousemove", "mousedown", "mouseup", "click"]) over.dispatchEvent('
                'new MouseEvent(type, {bubbles: true, clientX: box.left + box.width / 2, clientY: box.top + 20}))')
    browser.settle()
    assert abs(float(browser.text('#readout').split(' ')[0]) - 2.49) < 0.15, browser.text('#readout')


def check_playback(browser):
    assert browser.run('return [...document.querySelectorAll(".labels span")].map(n => n.textContent)') == \
        ['Recorded', 'Simulated before', 'Simulated after']
    move(browser, 0)
    browser.settle()
    assert browser.text('#readout').startswith('0.00 s'), browser.text('#readout')
    # Nothing moves by itself: else a changed picture proves nothing.
    assert not differs(browser, '#cloth', lambda: None)
    assert differs(browser, '#cloth', lambda: move(browser, 200))
    assert browser.text('#readout').startswith('4.00 s, RMS distance before'), browser.text('#readout')
    assert differs(browser, '#cloth', lambda: browser.click('#view-before'))
    assert differs(browser, '#cloth', lambda: browser.click('#unit-expected'))
    assert differs(browser, '.map canvas', lambda: move(browser, 100))
    assert differs(browser, '#over-time', lambda: move(browser, 150))
    browser.click('#unit-metres')
    browser.click('#view-all')
    # A patch is not seen from 1.5 to 1.9 s.
    assert differs(browser, '#cloth', lambda: move(browser, 85))
    # A click on the curve goes there.
    browser.run('const over = document.querySelector("#over-time .u-over"), box = over.getBoundingClientRect();'
                'for (const type of ["mousemove", "mousedown", "mouseup", "click"]) over.dispatchEvent('
                'new MouseEvent(type, {bubbles: true, clientX: box.left + box.width / 2, clientY: box.top + 20}))')
    browser.settle()
    assert abs(float(browser.text('#readout').split(' ')[0]) - 2.47) < 0.1, browser.text('#readout')


def check_keyboard(browser):
    value = 'return Number(document.getElementById("time").value)'
    reached = []
    browser.run('document.activeElement.blur(); document.querySelector("#effects > button").focus()')
    for _ in range(9):
        browser.press('Tab')
        reached.append(browser.run('return document.activeElement.id || document.activeElement.textContent'))
    for wanted in ('view-all', 'cloth', 'play', 'time', 'speed', 'Reset view'):
        assert wanted in reached, reached
    browser.run('document.getElementById("time").focus()')
    move(browser, 10)
    browser.press('Right', 'Right')
    assert browser.run(value) == 12
    browser.run('document.getElementById("cloth").focus()')
    assert differs(browser, '#cloth', lambda: browser.press('Left', 'Left'))
    browser.press('Home')
    browser.run('document.getElementById("play").focus()')
    browser.press('Enter')
    assert browser.text('#play') == 'Pause'
    for _ in range(100):
        browser.settle()
        if browser.run(value) > 12:
            break
    assert browser.run(value) > 12, 'it does not play'
    browser.press('Enter')
    at = browser.run(value)
    browser.settle()
    assert browser.run(value) == at, 'it does not pause'


def check_hostile(browser):
    assert browser.run('return window.hacked') is None
    assert browser.run('return document.querySelectorAll("img, main script").length') == 0
    assert browser.run('return document.title.includes("<img src=x")')
    seen = browser.run('return document.querySelector("main").textContent')
    assert seen.count(HOSTILE) > 12, seen.count(HOSTILE)


def check_without_webgl(browser, program, folder):
    """All but the view in 3D is there."""
    refuse_webgl(browser)
    show(browser, program, 'example', folder, 'WebGL')
    assert 'no WebGL' in browser.text('.stage')
    assert differs(browser, '.map canvas', lambda: move(browser, 3))


def take_picture(program, picture, *arguments):
    with tempfile.TemporaryDirectory() as folder, Browser(1240, 2150) as browser:
        subprocess.run([program, *arguments, '--output', folder], check=True)
        open_report(browser, folder)
        with open(picture, 'wb') as file:
            file.write(browser.picture())


def check_page(program):
    # The processor draws every pixel: a small window is tested faster.
    with tempfile.TemporaryDirectory() as folder, Browser(820, 600) as browser:
        play = arrays_of(program, 'sheet', folder)
        show(browser, program, 'sheet', folder)
        light = browser.run('return getComputedStyle(document.body).backgroundColor')
        check_table(browser)
        check_numbers(browser)
        check_copy(browser)
        check_points(browser, play)
        check_refused_copy(browser)
        check_playback(browser)
        check_keyboard(browser)
        assert not browser.log()
        browser.devtools('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': 'dark'}])
        assert browser.run('return getComputedStyle(document.body).backgroundColor') != light
        assert fits(browser, 1240) and fits(browser, 360)
        check_policy(browser)
        browser.devtools('Emulation.clearDeviceMetricsOverride')
        show(browser, program, 'hostile', folder)
        check_hostile(browser)
        show(browser, program, 'wordy', folder)
        assert fits(browser, 360)
        browser.devtools('Emulation.clearDeviceMetricsOverride')
        show(browser, program, 'unknown', folder)
        text = browser.run('return document.querySelector("main").innerText')
        assert not re.search(r'NaN|undefined|Infinity|\bnull\b(?! 17)|– \w', text), text
        assert table_of(browser, 'changes')[1][1:3] == ['not there', 'not possible there']
        assert not browser.run('return document.getElementById("points")'), 'no point was ever seen'
        show(browser, program, 'calm', folder)
        assert browser.text('#unseen') == ('This would have shown: air drag: coefficient above 0.09; wind: x beyond ±0.14 m/s; '
                                           'wind: y beyond ±0.16 m/s; and 3 more.')
        assert browser.run('return [...document.querySelectorAll("#sets li")].map(node => node.textContent)') == [
            'No effect of the library 90%',
            'Air drag linear and an unknown error of the measured positions together 5%']
        assert not browser.run('return document.getElementById("patch")')
        take = browser.run('return JSON.parse(document.getElementById("gap").textContent)')['takes'][1]
        before, after, floor = (take['free_' + when]['value'] ** 2 for when in ('before', 'after', 'floor'))
        share = ('%.0f%%' % (100 * (before - after) / (before - floor))).replace('-', '−')
        assert table_of(browser, 'brings') == [['windows of 0.3 s', 'not measured'], ['the free run', share]], share
        assert 'never put right' in browser.text('#points .note')
        show(browser, program, 'empty', folder)
        assert browser.text('#verdict .pill') == 'Undecidable'
        assert not browser.run('return document.getElementById("where")')
        show(browser, program, 'spare', folder)
        assert browser.text('#verdict .pill') == 'Unexplained'
        assert browser.run('return document.querySelectorAll(".map, #ranking").length') == 0
        assert browser.text('#readout').startswith('0.00 s, RMS distance before'), browser.text('#readout')
        browser.press('Tab')
        check_without_webgl(browser, program, folder)


if sys.argv[1] == 'json':
    check_json(*sys.argv[2:4])
    check_failures(sys.argv[2])
    check_arrays(sys.argv[2])
elif sys.argv[1] == 'page':
    check_page(sys.argv[2])
else:
    take_picture(*sys.argv[2:])
