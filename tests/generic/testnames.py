#!/usr/bin/env python3
"""Are all tests called differently? meson 1.0 crashes when a name that two share is given
twice, and a name that two share can't be run alone. Usage: testnames.py BUILD | --self-test
"""
import collections
import json
import pathlib
import sys


def shared(tests):
    """Names that several tests have, with the suites of each."""
    suites = collections.defaultdict(list)
    for test in tests:
        suites[test['name']].append(' '.join(test['suite']))
    return {name: found for name, found in suites.items() if len(found) > 1}


def self_test():
    def test(name, suite):
        return {'name': name, 'suite': ['p:' + suite]}

    assert shared([]) == {}
    assert shared([test('a', 'core'), test('b', 'core'), test('aa', 'core')]) == {}
    assert shared([test('a', 'core'), test('b', 'core'), test('a', 'elements')]) == {
        'a': ['p:core', 'p:elements']}
    assert len(shared([test('a', 'core')] * 3 + [test('b', 'core')] * 2)) == 2


def main():
    if sys.argv[1:] == ['--self-test']:
        self_test()
        return 0
    info = pathlib.Path(sys.argv[1]) / 'meson-info'
    n_shared = 0
    for kind in ('tests', 'benchmarks'):
        tests = json.loads((info / f'intro-{kind}.json').read_text())
        if kind == 'tests':
            assert tests, 'no test is known'
        for name, suites in sorted(shared(tests).items()):
            print(f'{kind} called “{name}”: {len(suites)} ({", ".join(suites)}); '
                  'give each its own name in meson.build')
            n_shared += 1
    return 1 if n_shared else 0


if __name__ == '__main__':
    sys.exit(main())
