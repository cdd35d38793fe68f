// node mikktspace.cjs IN OUT: tangents of unindexed triangles by the npm package mikktspace (the published algorithm compiled to
// wasm). IN holds float32: 3 a position, then 3 a normal, then 2 a uv for each corner; OUT gets 4 a corner. Used by mikktspace_test.cpp.
const fs = require('fs');
const { generateTangents } = require('mikktspace');

const bytes = fs.readFileSync(process.argv[2]);
const all = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
const corners = all.length / 8;
const tangents = generateTangents(all.slice(0, 3 * corners), all.slice(3 * corners, 6 * corners), all.slice(6 * corners));
fs.writeFileSync(process.argv[3], Buffer.from(tangents.buffer, tangents.byteOffset, tangents.byteLength));
