#!/usr/bin/python3
"""gst-cloth-view-1.0: what it refuses, what its page carries, the page in a browser.

  takeview.py check PROGRAM
  takeview.py picture PROGRAM PICTURE TAKE…    docs' picture

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import base64
import json
import os
import re
import subprocess
import sys
import tempfile

import numpy

from pages import check_policy, differs, fits, move, open_page, refuse_webgl
from webdriver import Browser

COLUMNS, ROWS, FRAMES, FPS = 9, 7, 20, 25
N = COLUMNS * ROWS
HOSTILE = '<img src=x onerror=window.hacked=1>"\'&'
PROGRAM = os.path.abspath(sys.argv[2])


def make_take(folder, stretch, columns=COLUMNS, rows=ROWS, frames=FRAMES, start=0, place=0.0, rich=True):
    """A sheet of 20 mm squares, the warp of which gets longer by so much from its first frame to its
    last. A vertex is not seen, one is filled, those of the last row are from two views."""
    n = columns * rows
    column, row = numpy.meshgrid(numpy.arange(columns), numpy.arange(rows))
    u, v = 0.02 * column.ravel(), 0.02 * row.ravel()
    growth = 1 + stretch * numpy.arange(frames) / max(1, frames - 1)
    positions = numpy.empty((frames, n, 3), 'f4')
    positions[..., 0] = growth[:, None] * u + place
    positions[..., 1] = 0
    positions[..., 2] = 1 - v
    states = numpy.ones((frames, n), 'u1')
    states[:, -columns:] = 2
    states[:, 1] = 3
    states[:, 2 * columns + 2] = 0
    covariance = numpy.zeros((frames, n, 6), 'f4')
    covariance[..., [0, 3, 5]] = (0.0001 * (1 + numpy.arange(n))[:, None] / n) ** 2
    os.makedirs(folder)
    with open(os.path.join(folder, 'take.json'), 'w') as file:
        json.dump({'version': 1, 'name': 'sheet', 'fps': FPS, 'grid': {
            'columns': columns, 'rows': rows, 'width_m': 0.02 * (columns - 1), 'height_m': 0.02 * (rows - 1)}}, file)
    if rich:
        positions[states == 0] = numpy.nan
        covariance[states == 0] = numpy.nan
        numpy.save(os.path.join(folder, 'states.npy'), states)
        numpy.save(os.path.join(folder, 'covariance.npy'), covariance)
    numpy.save(os.path.join(folder, 'times.npy'), start + numpy.arange(frames) / FPS)
    numpy.save(os.path.join(folder, 'positions.npy'), positions)
    return {'positions': positions, 'states': states, 'strain': (growth ** 2 - 1) / 2,
            'sigma': 0.0001 * (1 + numpy.arange(n)) / n}


def view(*words):
    # A warning of GLib is a fault.
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=60,
                          env={**os.environ, 'LC_ALL': 'C.UTF-8', 'G_DEBUG': 'fatal-warnings'})


def check_refusals():
    make_take('good', 0.1)
    make_take('short', 0.1)
    with open('short/positions.npy', 'r+b') as file:
        file.truncate(2000)
    make_take('bad', 0.1)
    states = numpy.load('bad/states.npy')
    states[7, 3] = 9
    numpy.save('bad/states.npy', states)
    for words, code, said in (
            ([], 2, 'name the takes'), (['good'], 2, '--output'), (['good', '--output'], 2, 'output'),
            (['good', '--output', ''], 2, '--output'), (['-o', 'page.html'], 2, 'name the takes'),
            (9 * ['good'] + ['-o', 'page.html'], 2, 'at most 8'),
            (['nowhere', '-o', 'page.html'], 1, 'neither a take nor a mesh file'),
            (['good', 'nowhere', '-o', 'page.html'], 1, 'nowhere'),
            (['short', '-o', 'page.html'], 1, 'positions.npy'), (['good', 'bad', '-o', 'page.html'], 1, 'states.npy, frame 7'),
            (['good', '-o', 'no/folder/page.html'], 1, 'no/folder'), (['good', '-o', 'good'], 1, 'good')):
        done = view(*words)
        assert done.returncode == code and said in done.stderr, (words, done)
    assert sorted(os.listdir('.')) == ['bad', 'good', 'short'], os.listdir('.')
    # What was there before stays.
    with open('page.html', 'w') as file:
        file.write('old')
    assert view('good', 'bad', '-o', 'page.html').returncode == 1
    assert open('page.html').read() == 'old'
    done = view('good', '--output', 'page.html')
    assert done.returncode == 0 and not done.stderr and 'page.html' in done.stdout, done


def carried(page):
    with open(page, encoding='utf-8') as file:
        text = file.read()
    takes = json.loads(re.search(r'<script type="application/json" id="takes">\n(.*?)</script>', text, re.S)[1])['takes']
    for take in takes:
        shape = (len(take['times']), -1)
        packed = numpy.frombuffer(base64.b64decode(take['places']), '<u2').reshape(*shape, 3)
        take['places'] = numpy.where(packed == 65535, numpy.nan, packed * take['step'] + take['origin'])
        take['states'] = numpy.frombuffer(base64.b64decode(take['states']), 'u1').reshape(shape)
        if 'sigma' in take:
            codes = numpy.frombuffer(base64.b64decode(take['sigma']), 'u1').reshape(shape)
            take['sigma'] = numpy.where(codes == 255, numpy.nan, take['sigma_scale'][0] * numpy.exp(take['sigma_scale'][1] * codes))
        if 'strain' in take:
            steps = numpy.frombuffer(base64.b64decode(take['strain']), '<i2').reshape(*shape, 3)
            take['strain'] = numpy.where(steps == -32768, numpy.nan, steps * take['strain_step'])
    return takes


def check_arrays():
    truth = make_take('red', 0.1)
    make_take('plain', -0.2, rich=False)
    long = make_take('long', 0.1, columns=41, rows=31, frames=900)
    assert view('red/', 'plain', '-o', 'two.html').returncode == 0
    red, plain = carried('two.html')
    assert [red['name'], plain['name']] == ['red', 'plain']
    assert red['all_frames'] == FRAMES and red['frame_step'] == 1
    assert numpy.allclose(red['times'], numpy.arange(FRAMES) / FPS)
    assert numpy.allclose(red['places'], truth['positions'], atol=1e-5, equal_nan=True)
    assert (red['states'] == truth['states']).all()
    seen = truth['states'] != 0
    assert (numpy.isnan(red['sigma']) == ~seen).all()
    assert numpy.abs(red['sigma'] / truth['sigma'] - 1)[seen].max() < 0.031
    # All its neighbours have other faces, too.
    assert (numpy.isnan(red['strain'][..., 0]) == ~seen).all()
    assert numpy.abs(red['strain'][..., 0] - truth['strain'][:, None])[seen].max() < 6e-5
    assert numpy.nanmax(numpy.abs(red['strain'][..., 1:])) < 6e-5
    assert 'sigma' not in plain and (plain['states'] == 1).all()
    assert abs(plain['strain'][-1, :, 0] + 0.18).max() < 6e-5
    # The same bytes again; no more than is to be downloaded.
    assert view('red', 'plain', '-o', 'again.html').returncode == 0
    assert open('two.html', 'rb').read() == open('again.html', 'rb').read()
    assert view('long', 'red', '-o', 'long.html').returncode == 0
    assert os.path.getsize('long.html') < 17e6
    thin = carried('long.html')[0]
    step = thin['frame_step']
    assert step > 1 and len(thin['times']) == (900 - 1) // step + 1
    assert numpy.allclose(thin['times'], numpy.arange(0, 900, step) / FPS)
    assert numpy.allclose(thin['places'], long['positions'][::step], atol=1e-5, equal_nan=True)
    # Two of the same name are told apart.
    make_take('other/red', 0)
    assert view('red', 'other/red', '-o', 'same.html').returncode == 0
    assert [take['name'] for take in carried('same.html')] == ['red', 'other/red']


def show(browser, page, complaint=None):
    open_page(browser, page)
    log = browser.log()
    assert all(complaint and complaint in line for line in log), log
    assert browser.run('return performance.getEntriesByType("resource").length') == 0


def values(browser):
    return browser.run('return [...document.querySelectorAll("#values tbody tr")].map(row => '
                       '[...row.children].map(cell => cell.innerText.split(/\\s+/).join(" ").trim()))')


def check_colours(browser):
    assert browser.run('return [...document.querySelectorAll(".labels span")].map(n => n.textContent)') == ['red', 'plain']
    assert browser.run('return [...document.querySelectorAll("input[name=colour]")].map(n => n.value)') == \
        ['state', 'sigma', 'warp', 'weft', 'shear']
    assert values(browser) == [['red', '83%', '14%', '2%', '0%', '2%'], ['plain', '100%', '0%', '0%', '0%', '0%']], values(browser)
    # Nothing moves by itself: else a changed picture proves nothing.
    assert not differs(browser, '#cloth', lambda: None)
    assert differs(browser, '#cloth', lambda: browser.click('#colour-sigma'))
    assert values(browser)[1][1:] == ['not known', ''], values(browser)
    assert values(browser)[0][1] == '0.05 mm', values(browser)
    move(browser, FRAMES - 1)
    assert differs(browser, '#cloth', lambda: browser.click('#colour-warp'))
    # ½ (1.1² − 1) and ½ (0.8² − 1)
    assert values(browser) == [['red', '11%', '11% to 11%'], ['plain', '−18%', '−18% to −18%']], values(browser)
    assert browser.text('#readout') == '0.76 s'
    assert differs(browser, '#cloth', lambda: move(browser, 10))
    assert differs(browser, '#cloth', lambda: browser.click('#colour-shear'))
    assert values(browser)[0][1:] == ['0%', '0% to 0%'], values(browser)


def check_keyboard(browser):
    browser.run('document.getElementById("time").focus()')
    move(browser, 3)
    browser.press('Right', 'Right')
    assert browser.text('#readout') == '0.20 s'
    browser.run('document.getElementById("cloth").focus()')
    assert differs(browser, '#cloth', lambda: browser.press('Left', 'Left'))
    browser.run('document.getElementById("play").focus()')
    browser.press('Enter')
    assert browser.text('#play') == 'Pause'
    for _ in range(100):
        browser.settle()
        if browser.text('#readout') != '0.20 s':
            break
    else:
        raise AssertionError('it does not play')
    browser.press('Enter')
    at = browser.text('#readout')
    browser.settle()
    assert browser.text('#readout') == at, 'it does not pause'


def check_page():
    make_take(HOSTILE, 0.05)
    make_take('late', 0.1, start=100, place=30)
    make_take('brief', 0.1, frames=2)
    assert view(HOSTILE, 'red', '-o', 'hostile.html').returncode == 0
    assert view('red', 'late', 'brief', '-o', 'late.html').returncode == 0
    assert view('plain', 'brief', '-o', 'brief.html').returncode == 0
    assert view('plain', 'red', 'late', 'brief', 'long', '-o', 'many.html').returncode == 0
    # The processor draws every pixel: a small window is tested faster.
    with Browser(820, 600) as browser:
        show(browser, 'two.html')
        light = browser.run('return getComputedStyle(document.body).backgroundColor')
        check_colours(browser)
        check_keyboard(browser)
        assert not browser.log()
        browser.devtools('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': 'dark'}])
        assert browser.run('return getComputedStyle(document.body).backgroundColor') != light
        assert fits(browser, 1240) and fits(browser, 360)
        check_policy(browser)
        show(browser, 'many.html')
        assert fits(browser, 360)
        text = browser.run('return document.querySelector("main").innerText')
        assert not re.search(r'NaN|undefined|Infinity|null', text), text
        assert re.search(r'129 of 900, one of 7, to keep this file small', text), text
        browser.devtools('Emulation.clearDeviceMetricsOverride')
        show(browser, 'hostile.html')
        assert browser.run('return window.hacked') is None
        assert browser.run('return document.querySelectorAll("img, main script").length') == 0
        assert browser.run('return document.title') == HOSTILE + ', red'
        assert browser.run('return document.querySelector("h1").textContent') == HOSTILE + ', red'
        assert fits(browser, 360)
        browser.devtools('Emulation.clearDeviceMetricsOverride')
        # Times that have nothing in common: each from its beginning; a place far off comes near.
        show(browser, 'late.html')
        assert 'don’t overlap' in browser.text('#cloths .note')
        assert browser.run('return document.getElementById("time").max') == str(FRAMES - 1)
        assert browser.run('return [...document.querySelectorAll(".labels span")].map(n => n.textContent)') == \
            ['red', 'late, moved here', 'brief']
        show(browser, 'brief.html')
        assert not browser.run('return document.querySelector("#cloths .note")')
        move(browser, 5)
        assert [row[0] for row in values(browser)] == ['plain', 'brief at its end: its last frame'], values(browser)
        refuse_webgl(browser)
        show(browser, 'two.html', 'WebGL')
        assert 'no WebGL' in browser.text('.stage')
        move(browser, FRAMES - 1)
        browser.click('#colour-warp')
        assert values(browser)[0][1] == '11%'


def take_picture(picture, *takes):
    with tempfile.TemporaryDirectory() as folder, Browser(1060, 1120) as browser:
        page = os.path.join(folder, 'view.html')
        assert view(*takes, '-o', page).returncode == 0
        open_page(browser, page)
        browser.click('#colour-shear')
        move(browser, 100)
        browser.settle()
        with open(picture, 'wb') as file:
            file.write(browser.picture())


if sys.argv[1] == 'picture':
    take_picture(*sys.argv[3:])
else:
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        check_refusals()
        check_arrays()
        check_page()
        os.chdir('/')
