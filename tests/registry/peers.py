#!/usr/bin/python3
"""What other people's programs say of our files and pages. They come from npm's registry.

  peers.py formats NPM                         glTF and USD, of a mesh that moves
  peers.py pages NPM VIEW GAPSHEET CALIBRATE BOARDS TAKE…
                                               pages, by axe-core

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '../report'))
from pages import calibrate, fits, open_page  # noqa: E402
from webdriver import Browser  # noqa: E402


def install(npm, folder):
    for name in ('package.json', 'package-lock.json', 'formats.mjs'):
        shutil.copy(os.path.join(HERE, name), folder)
    subprocess.run([npm, 'ci', '--ignore-scripts', '--no-audit', '--no-fund'], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)


# ---- files

COLUMNS, ROWS, FRAMES = 6, 5, 4


def make_take(folder):
    """A waving sheet of quads, one of which is two triangles."""
    n = COLUMNS * ROWS
    column, row = numpy.meshgrid(numpy.arange(COLUMNS), numpy.arange(ROWS))
    uv = numpy.stack([column.ravel() * 0.1, row.ravel() * 0.1], 1)
    positions = numpy.zeros((FRAMES, n, 3), 'f4')
    for f in range(FRAMES):
        positions[f] = numpy.stack([uv[:, 0], 0.05 * numpy.sin(9 * uv[:, 0] + f), 1.5 - uv[:, 1]], 1)
    faces = [[r * COLUMNS + c, (r + 1) * COLUMNS + c, (r + 1) * COLUMNS + c + 1, r * COLUMNS + c + 1]
             for r in range(ROWS - 1) for c in range(COLUMNS - 1)]
    first = faces.pop(0)
    faces += [first[:3], [first[0], first[2], first[3]]]
    os.mkdir(folder)
    numpy.save(os.path.join(folder, 'positions.npy'), positions)
    with open(os.path.join(folder, 'take.json'), 'w') as file:
        json.dump({'version': 1, 'name': 'sheet', 'fps': 25, 'mesh': 'mesh.obj'}, file)
    with open(os.path.join(folder, 'mesh.obj'), 'w') as obj:
        obj.writelines('v %.9g %.9g 0\n' % tuple(at) for at in uv)
        obj.writelines('vt %.9g %.9g\n' % tuple(at) for at in uv)
        obj.writelines('f %s\n' % ' '.join('%d/%d' % (i + 1, i + 1) for i in face) for face in faces)
    triangles = [[face[0], face[k - 1], face[k]] for face in faces for k in range(2, len(face))]
    return positions, uv, triangles


def judged(folder, gltf, usd):
    done = subprocess.run(['node', 'formats.mjs', gltf, usd], cwd=folder, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def check_formats(npm):
    with tempfile.TemporaryDirectory() as folder:
        install(npm, folder)
        positions, uv, triangles = make_take(os.path.join(folder, 'take'))
        for ending in ('glb', 'usda'):
            subprocess.run(['gst-launch-1.0', '-q', 'meshsrc', 'location=take', '!', 'meshsink', 'location=sheet.' + ending],
                           cwd=folder, check=True)
        found = judged(folder, 'sheet.glb', 'sheet.usda')
        issues = found['gltf']['issues']
        assert issues['numErrors'] == issues['numWarnings'] == 0, issues
        info = found['gltf']['info']
        assert info['totalVertexCount'] == COLUMNS * ROWS and info['totalTriangleCount'] == len(triangles), info
        assert info['hasMorphTargets'] and info['animationCount'] == 1 and info['materialCount'] == 1, info
        # Triangles as they are in the file, z turned up to three.js' y.
        mesh, = found['usd']
        places = numpy.array(mesh['position']).reshape(-1, 3)
        if mesh['index']:
            places = places[mesh['index']]
        x, y, z = positions[0][numpy.array(triangles).ravel()].T
        wanted = numpy.stack([x, z, -y], 1)
        assert places.shape == wanted.shape, places.shape
        # In whatever order of triangles.
        ordered = [rows[numpy.lexsort(rows.T)] for rows in (places.round(5), wanted.round(5).astype('f8'))]
        assert numpy.abs(ordered[0] - ordered[1]).max() < 2e-5
        assert numpy.allclose(numpy.array(mesh['uv']).reshape(-1, 2).max(0), uv.max(0), atol=1e-6)
        # The validator sees what is wrong.
        with open(os.path.join(folder, 'sheet.glb'), 'rb') as file:
            data = file.read()
        assert data.count(b'"NORMAL":5') == 1
        with open(os.path.join(folder, 'spoilt.glb'), 'wb') as file:
            file.write(data.replace(b'"NORMAL":5', b'"NORMAL":0', 1))
        issues = judged(folder, 'spoilt.glb', 'sheet.usda')['gltf']['issues']
        assert issues['numErrors'] > 0, issues


# ---- pages

def violations(browser):
    return browser.wait_for('const done = arguments[0]; axe.run().then(found => done(found.violations.map('
                            'fault => [fault.id, fault.impact, fault.nodes[0].html.slice(0, 120)])))')


# What of each page has a name that only it has, and the rule of axe-core that it needs one.
NAMED = {'view.html': ('time', 'label'), 'report.html': ('time', 'label'), 'calibration.html': ('rig', 'role-img-alt')}


def check_pages(npm, view, gapsheet, calibrate_tool, boards, *takes):
    with tempfile.TemporaryDirectory() as folder:
        install(npm, folder)
        with open(os.path.join(folder, 'node_modules/axe-core/axe.min.js'), encoding='utf-8') as file:
            axe = file.read() + '; window.axe = axe'
        subprocess.run([view, *takes, '--output', os.path.join(folder, 'view.html')], check=True)
        subprocess.run([gapsheet, 'sheet', folder], check=True)
        calibrate(calibrate_tool, boards, folder).check_returncode()
        faults = []
        with Browser(1240, 900) as browser:
            for page, (named, rule) in NAMED.items():
                for scheme in ('light', 'dark'):
                    browser.devtools('Emulation.setEmulatedMedia',
                                     features=[{'name': 'prefers-color-scheme', 'value': scheme}])
                    open_page(browser, os.path.join(folder, page))
                    browser.run(axe)
                    for width in (1240, 360):
                        if not fits(browser, width):
                            faults.append([page, width, 'does not fit'])
                        faults += [[page, scheme, width] + fault for fault in violations(browser)
                                   if fault[1] in ('serious', 'critical')]
                # It sees what is wrong.
                browser.run('document.getElementById(arguments[0]).removeAttribute("aria-label")', named)
                assert any(fault[0] == rule for fault in violations(browser)), page
        for fault in faults:
            print(*fault)
        return 1 if faults else 0


sys.exit({'formats': check_formats, 'pages': check_pages}[sys.argv[1]](*sys.argv[2:]))
