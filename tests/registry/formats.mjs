// Khronos' validator on a glTF file, three.js' loader on a USD file: what they found, as JSON.
//   node formats.mjs FILE.glb FILE.usda
// SPDX-License-Identifier: LGPL-2.1-or-later
import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';
import { USDLoader } from 'three/addons/loaders/USDLoader.js';

const { issues, info } = await validator.validateBytes(new Uint8Array(readFileSync(process.argv[2])));
const meshes = [];
const scene = new USDLoader().parse(readFileSync(process.argv[3], 'utf8'));
scene.updateMatrixWorld(true);
scene.traverse((node) => {
  if (!node.isMesh) return;
  const shape = node.geometry.clone().applyMatrix4(node.matrixWorld);
  const { position, uv } = shape.attributes;
  meshes.push({ name: node.name, position: Array.from(position.array), uv: uv ? Array.from(uv.array) : null,
    index: shape.index ? Array.from(shape.index.array) : null });
});
console.log(JSON.stringify({ gltf: { issues, info }, usd: meshes }));
