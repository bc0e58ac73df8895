"""Labels under seal: what was done to a take, shut away until the diagnoses are done.

Beside each take lies only the SHA-256 of its label. A label holds a nonce, so that it
can't be guessed from its hash, and the hashes of the case's recordings, so that it
can't be moved to others.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import hashlib
import json
import os
import secrets

COMMITMENT = 'commitment.txt'
TAKES = ('baseline', 'simulated', 'take')


class BrokenSeal(Exception):
    """A label is not the one that was committed to."""


def hash_takes(folder):
    """The hash of what a diagnosis reads of the case in a folder."""
    digest = hashlib.sha256()
    for take in TAKES:
        if not os.path.isdir(os.path.join(folder, take)):
            continue
        for name in sorted(os.listdir(os.path.join(folder, take))):
            with open(os.path.join(folder, take, name), 'rb') as file:
                content = file.read()
            digest.update(('%s/%s %d\n' % (take, name, len(content))).encode())
            digest.update(content)
    return digest.hexdigest()


def commitment_of(label):
    text = json.dumps(label, sort_keys=True, separators=(',', ':'))
    return hashlib.sha256(text.encode()).hexdigest()


def seal(label, folder):
    """Returns the label with its nonce, and writes the commitment beside the takes."""
    sealed = dict(label, nonce=secrets.token_hex(16), takes_sha256=hash_takes(folder))
    with open(os.path.join(folder, COMMITMENT), 'w', encoding='utf-8') as file:
        file.write(commitment_of(sealed) + '\n')
    return sealed


def write_labels(folder, labels):
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, 'labels.json')
    with open(path + '.part', 'w', encoding='utf-8') as file:
        json.dump({'version': 1, 'labels': labels}, file, indent=1, sort_keys=True)
    os.replace(path + '.part', path)


def open_labels(folder, takes):
    """All labels by case, or BrokenSeal: each must be what was committed to."""
    with open(os.path.join(folder, 'labels.json'), encoding='utf-8') as file:
        labels = json.load(file)['labels']
    cases = {name for name in os.listdir(takes) if os.path.isdir(os.path.join(takes, name))}
    if cases != set(labels):
        raise BrokenSeal('labels and takes differ: %s' % ' '.join(sorted(cases ^ set(labels))))
    for case, label in labels.items():
        with open(os.path.join(takes, case, COMMITMENT), encoding='utf-8') as file:
            committed = file.read().strip()
        if commitment_of(label) != committed:
            raise BrokenSeal('%s: the label is not the one that was committed to' % case)
        if hash_takes(os.path.join(takes, case)) != label['takes_sha256']:
            raise BrokenSeal('%s: the takes are not those that were labelled' % case)
    return labels
