"""What is asked of every page that our programs write.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import subprocess


def calibrate(tool, boards, folder, *arguments):
    """Calibrates cameras from pictures of the shipped board, into a folder; what is not named otherwise
    are both cameras."""
    both = ['%s=%s/%s*.jpg' % (side, boards, side) for side in ('left', 'right')]
    return subprocess.run([tool, '--pattern', os.path.join(boards, 'pattern.json'), '--output',
                           os.path.join(folder, 'rig.json'), *(arguments or both)], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding='utf-8', timeout=120)


def open_page(browser, path):
    browser.open(path)
    for _ in range(200):
        if browser.run('return document.documentElement.dataset.ready') == 'yes':
            break
        browser.settle()
    else:
        raise AssertionError('%s does not get ready: %s' % (path, browser.log()))
    browser.settle()


def differs(browser, selector, change):
    before = browser.picture(selector)
    change()
    browser.settle()
    return browser.picture(selector) != before


def move(browser, frame):
    browser.run('const slider = document.getElementById("time"); slider.value = arguments[0];'
                'slider.dispatchEvent(new Event("input"))', frame)


def check_policy(browser):
    """The page's own guard is up: what it lets through would be seen in the log."""
    browser.run('const script = document.createElement("script"); script.textContent = "window.hacked = 1";'
                'document.body.append(script); const picture = new Image(); picture.src = "file:///x.png";'
                'const style = document.createElement("style"); style.textContent = "body { display: none }";'
                'document.body.append(style); document.body.append(picture)')
    browser.settle()
    log = browser.log()
    assert browser.run('return window.hacked') is None
    for directive in ('script-src', 'style-src', 'img-src'):
        assert any(directive in line for line in log), log


def fits(browser, width):
    """Whether a window so wide needs no sideways scrolling, nor any table in it."""
    browser.devtools('Emulation.setDeviceMetricsOverride', width=width, height=800, deviceScaleFactor=1, mobile=False)
    browser.settle()
    wide = browser.run('return [...document.querySelectorAll(".wide, .shares, body")].filter('
                       'node => node.scrollWidth > node.clientWidth).map(node => node.outerHTML.slice(0, 200))')
    return browser.run('return document.documentElement.scrollWidth') == width and not wide


def refuse_webgl(browser):
    """Of the pages that are opened from now on."""
    browser.devtools('Page.addScriptToEvaluateOnNewDocument', source='const all = HTMLCanvasElement.prototype.getContext;'
                     'HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {'
                     'return kind.startsWith("webgl") ? null : all.call(this, kind, ...rest); }')
