"""Drives headless Chromium over the WebDriver protocol, with the standard library only.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import base64
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import urllib.request

ELEMENT = 'element-6066-11e4-a52e-4f735466cecf'
KEYS = {'Tab': '\ue004', 'Enter': '\ue007', 'Right': '\ue014', 'Left': '\ue012', 'Home': '\ue011', 'End': '\ue010'}


class Browser:
    """A window of so many pixels. WebGL is rendered by the processor."""

    def __init__(self, width, height):
        self.home = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        # A group of its own, so that no process of the browser outlives the test.
        self.driver = subprocess.Popen(['chromedriver', '--port=0'], stdout=subprocess.PIPE, text=True,
                                       start_new_session=True, env={**os.environ, 'HOME': self.home.name})
        self.session = None
        # A test that takes too long is ended by this signal: its browser must not stay.
        signal.signal(signal.SIGTERM, self._end)
        try:
            self.base = 'http://127.0.0.1:%s' % self._port()
            self.session = self._call('POST', '/session', {'capabilities': {'alwaysMatch': {
                'browserName': 'chrome',
                'goog:loggingPrefs': {'browser': 'ALL'},
                'goog:chromeOptions': {'args': [
                    '--headless', '--no-sandbox', '--disable-dev-shm-usage', '--hide-scrollbars',
                    '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-first-run',
                    '--disable-background-networking', '--disable-component-update', '--disable-sync',
                    '--force-device-scale-factor=1', '--window-size=%d,%d' % (width, height),
                    '--user-data-dir=' + self.home.name]}}}})['sessionId']
        except BaseException:
            self.close()
            raise

    def _end(self, *_):
        os.killpg(self.driver.pid, signal.SIGKILL)
        sys.exit(1)

    def _port(self):
        for line in self.driver.stdout:
            found = re.search(r'started successfully on port (\d+)', line)
            if found:
                return found[1]
        raise RuntimeError('chromedriver does not start')

    def _call(self, method, path, body=None):
        if self.session:
            path = '/session/%s%s' % (self.session, path)
        request = urllib.request.Request(self.base + path, method=method,
                                         data=None if body is None else json.dumps(body).encode(),
                                         headers={'Content-Type': 'application/json'})
        try:
            # Long, for a busy machine: the processor draws every pixel.
            with urllib.request.urlopen(request, timeout=240) as answer:
                return json.load(answer)['value']
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)['value']['message']) from None

    def open(self, path):
        self._call('POST', '/url', {'url': 'file://' + os.path.abspath(path)})

    def run(self, script, *arguments):
        """The value that the script, a function's body, returns."""
        return self._call('POST', '/execute/sync', {'script': script, 'args': arguments})

    def wait_for(self, script):
        """What the script hands to its last argument, a function."""
        return self._call('POST', '/execute/async', {'script': script, 'args': []})

    def settle(self):
        """Waits until what was asked for has been drawn."""
        self.wait_for('const done = arguments[0]; let n = 3;'
                      'const step = () => --n ? requestAnimationFrame(step) : done(); step();')

    def find(self, selector):
        return self._call('POST', '/element', {'using': 'css selector', 'value': selector})[ELEMENT]

    def text(self, selector):
        return self._call('GET', '/element/%s/text' % self.find(selector))

    def click(self, selector):
        self._call('POST', '/element/%s/click' % self.find(selector), {})

    def press(self, *names):
        """Keys to whatever has the focus."""
        actions = []
        for name in names:
            key = KEYS.get(name, name)
            actions += [{'type': 'keyDown', 'value': key}, {'type': 'keyUp', 'value': key}]
        self._call('POST', '/actions', {'actions': [{'type': 'key', 'id': 'keys', 'actions': actions}]})

    def picture(self, selector=None):
        """PNG of an element, or of the window."""
        path = '/element/%s/screenshot' % self.find(selector) if selector else '/screenshot'
        return base64.b64decode(self._call('GET', path))

    def devtools(self, command, **parameters):
        return self._call('POST', '/goog/cdp/execute', {'cmd': command, 'params': parameters})

    def log(self):
        """What the console and the security policy had to say since the last call."""
        return ['%s: %s' % (item['level'], item['message']) for item in
                self._call('POST', '/se/log', {'type': 'browser'})]

    def close(self):
        try:
            if self.session:
                self._call('DELETE', '')
        finally:
            if self.driver.poll() is None:
                os.killpg(self.driver.pid, signal.SIGKILL)
            self.driver.wait()
            self.driver.stdout.close()
            self.home.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
