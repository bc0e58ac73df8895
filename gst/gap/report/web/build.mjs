// Makes the scripts and styles of the pages, report, calibration and view: `npm ci && npm run build`,
// or with `--out FOLDER` there.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] === '--out' ? process.argv[3] : here;

// What the bundle is made from; the test `gapbundle` computes the same.
const sources = ['build.mjs', 'package.json', 'package-lock.json',
  ...readdirSync(join(here, 'src')).sort().map((name) => 'src/' + name)];
const hash = createHash('sha256');
for (const name of sources) {
  const text = readFileSync(join(here, name));
  hash.update(`${name} ${text.length}\n`);
  hash.update(text);
}

const licences = ['three', 'uplot'].map((name) => {
  const folder = join(here, 'node_modules', name);
  const version = JSON.parse(readFileSync(join(folder, 'package.json'))).version;
  return `${name} ${version}\n\n${readFileSync(join(folder, 'LICENSE'), 'utf8').trim()}\n`;
});
const sources_sha256 = hash.digest('hex');

const result = await build({
  absWorkingDir: here,
  entryPoints: { calibration: 'src/calibration.js', report: 'src/main.js', view: 'src/view.js' },
  outdir: out,
  bundle: true,
  minify: true,
  write: false,
  format: 'iife',
  target: 'es2020',
  charset: 'ascii',
  legalComments: 'none',
});
for (const file of result.outputFiles) {
  // Inside a page these would end the script or the style.
  if (/<\/(script|style)|<!--/i.test(file.text)) {
    throw new Error(`${file.path} can't stand in a page`);
  }
  writeFileSync(file.path, `/*! Made by gst/gap/report/web/build.mjs: do not edit.
sources sha256 ${sources_sha256}
below sha256 ${createHash('sha256').update(file.text).digest('hex')}

Our own part: SPDX-License-Identifier: LGPL-2.1-or-later. With it come

${licences.join('\n')}*/
${file.text}`);
}
