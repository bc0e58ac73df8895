#!/usr/bin/python3
"""The page of a calibration in a browser.

  calibrationpage.py TOOL TEST_DATA             tests it
  calibrationpage.py TOOL TEST_DATA PICTURE     takes the picture of docs/calibration.md

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import functools
import json
import os
import re
import shutil
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from pages import calibrate, differs, open_page, refuse_webgl
from webdriver import Browser

tool, picture, boards = sys.argv[1], sys.argv[3:], os.path.join(sys.argv[2], 'opencv_boards')
calibrate = functools.partial(calibrate, tool, boards)
# A file's name may be anything but a folder's.
HOSTILE = '<img src=x onerror="window.hacked = 1">'


def carried(path):
    with open(path, encoding='utf-8') as file:
        page = file.read()
    return page, json.loads(re.search(r'id="calibration-data">\n(.*?)</script>', page, re.S)[1])


def show(browser, path, complaint=None):
    open_page(browser, path)
    log = browser.log()
    assert all(complaint and complaint in line for line in log), log
    assert browser.run('return performance.getEntriesByType("resource").length') == 0


def count(browser, selector):
    return browser.run('return document.querySelectorAll(arguments[0]).length', selector)


def check_pair(browser, folder):
    """All that a page has, in light and dark, on a desk and on a phone."""
    done = calibrate(folder)
    assert done.returncode == 0, done.stderr
    path = os.path.join(folder, 'calibration.html')
    page, data = carried(path)
    assert "default-src 'none'" in page and 'http-equiv="Content-Security-Policy"' in page
    assert len(page) < 3e6, len(page)
    # What it carries is what was printed and written.
    with open(os.path.join(folder, 'rig.json'), encoding='utf-8') as file:
        rig = json.load(file)
    for kept, written in zip(data['cameras'], rig['cameras']):
        assert abs(kept['parameters'][2]['value'] - written['K'][0][2]) < 1e-3
        assert kept['corners'] == 702 and kept['outliers'] == 1
        assert max(kept['near']) == max(kept['near'][i] for i in (0, 32, -33, -1)), 'worst in a corner'
        printed = re.search(r'at %.2f m +([\d.]+)' % kept['distance'], done.stdout)[1]
        assert abs(float(printed) - kept['near'][len(kept['near']) // 2]) < 1e-3
        assert all(text in done.stdout for text in kept['warnings']) and len(kept['warnings']) == 2
    worst = max(data['views'], key=lambda view: view['rms'])
    assert worst['label'] == 'left08.jpg' and len(worst['outliers']) == 1
    assert sum('picture' in view for view in data['views']) == 24

    show(browser, path)
    assert browser.text('#verdict .pill') == 'Warnings' and count(browser, '#verdict .warning') == 4
    assert count(browser, '#certainty canvas') == 2 and count(browser, '#residuals canvas') == 4
    assert 'left08.jpg' in browser.text('#pictures figure figcaption')
    assert count(browser, '#pictures figure:not([hidden])') == 6
    browser.click('#pictures button')
    assert count(browser, '#pictures figure:not([hidden])') == 24
    assert differs(browser, '#certainty canvas', lambda: browser.click('#range-far'))
    browser.run('document.getElementById("rig").focus()')
    assert differs(browser, '#rig', lambda: browser.press('Right', '+'))
    assert differs(browser, '#rig', lambda: browser.press('Home'))
    assert browser.run('return document.querySelectorAll("#view-table tbody tr").length') == 26
    light = browser.run('return getComputedStyle(document.body).backgroundColor')
    browser.devtools('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': 'dark'}])
    assert browser.run('return getComputedStyle(document.body).backgroundColor') != light
    browser.click('#views summary')
    for width in (1240, 360):
        browser.devtools('Emulation.setDeviceMetricsOverride', width=width, height=800, deviceScaleFactor=1, mobile=False)
        browser.settle()
        assert browser.run('return document.documentElement.scrollWidth') == width, width
    browser.devtools('Emulation.clearDeviceMetricsOverride')
    # Nothing but its own script runs.
    browser.run('const script = document.createElement("script"); script.textContent = "window.hacked = 1";'
                'document.body.append(script)')
    browser.settle()
    assert browser.run('return window.hacked') is None
    assert any('script-src' in line for line in browser.log())


def check_hostile(browser, folder):
    """Names are text; cameras that were not placed have no scene."""
    for i in range(1, 8):
        shutil.copy('%s/left0%d.jpg' % (boards, i), os.path.join(folder, '%s%d.jpg' % (HOSTILE, i)))
    path = os.path.join(folder, 'named.html')
    done = calibrate(folder, '--intrinsics-only', '--warp', '--report', path, '<b>bold=%s/*.jpg' % folder)
    assert done.returncode == 0 and path in done.stdout, done.stderr
    assert not os.path.exists(os.path.join(folder, 'calibration.html'))
    show(browser, path)
    seen = browser.run('return document.querySelector("main").textContent')
    assert seen.count(HOSTILE) > 7 and '<b>bold' in seen
    assert browser.run('return window.hacked') is None and count(browser, 'main img, main b') == 0
    assert 'bent along rows and columns' in seen
    assert count(browser, '#rig') == 0 and count(browser, '#certainty canvas') == 1


def check_without_webgl(browser, folder):
    refuse_webgl(browser)
    show(browser, os.path.join(folder, 'calibration.html'), 'WebGL')
    assert 'no 3D' in browser.text('.stage') and count(browser, '#certainty canvas') == 2


def check_refused(folder):
    """Without the page there is no rig either, and nothing is left behind."""
    done = calibrate(folder, '--report', os.path.join(folder, 'none', 'x.html'), 'left=%s/left*.jpg' % boards)
    assert done.returncode == 1 and 'x.html' in done.stderr, done.stderr
    assert os.listdir(folder) == [], os.listdir(folder)
    # Nor is there a page without a rig.
    done = calibrate(folder, 'a/b=%s/left*.jpg' % boards)
    assert done.returncode == 1 and 'slash' in done.stderr, done.stderr
    assert os.listdir(folder) == [], os.listdir(folder)


def take_picture(path):
    with tempfile.TemporaryDirectory() as folder, Browser(1240, 1570) as browser:
        done = calibrate(folder)
        assert done.returncode == 0, done.stderr
        show(browser, os.path.join(folder, 'calibration.html'))
        with open(path, 'wb') as file:
            file.write(browser.picture())


if picture:
    take_picture(picture[0])
    sys.exit()
with Browser(820, 600) as window:
    for check in (check_hostile, check_pair):
        with tempfile.TemporaryDirectory() as place:
            check(window, place)
            if check is check_pair:
                check_without_webgl(window, place)
with tempfile.TemporaryDirectory() as place:
    check_refused(place)
