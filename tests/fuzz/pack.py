#!/usr/bin/env python3
"""Packs a folder into one input of a fuzz target that reads folders (fuzz_folder_new ()).

  tests/fuzz/pack.py TARGET FOLDER > INPUT

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import re
import sys

here = os.path.dirname(os.path.abspath(__file__))
with open(os.path.join(here, sys.argv[1] + '.c'), encoding='utf-8') as source:
    table = re.search(r'names\[\] = \{([^}]*)\}', source.read())[1]
for number, name in enumerate(re.findall(r'"([^"]*)"', table)):
    path = os.path.join(sys.argv[2], name)
    if os.path.exists(path):
        with open(path, 'rb') as file:
            contents = file.read()
        sys.stdout.buffer.write(bytes([number]) + len(contents).to_bytes(3, 'little') + contents)
