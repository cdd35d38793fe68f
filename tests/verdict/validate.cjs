// The Khronos validator over the files whose paths stand on standard input: one JSON object a line.
const fs = require('fs');
const path = require('path');
const validator = require('gltf-validator');

const read = (folder) => (uri) => fs.promises.readFile(path.resolve(folder, decodeURIComponent(uri))).then((data) => new Uint8Array(data));

async function main() {
  for (const file of fs.readFileSync(0, 'utf8').split('\n').filter((line) => line)) {
    const out = { path: file, errors: [] };
    try {
      const options = { uri: path.basename(file), maxIssues: 0, externalResourceFunction: read(path.dirname(file)) };
      const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), options);
      const errors = report.issues.messages.filter((message) => message.severity === 0);
      out.errors = errors.map((message) => ({ code: message.code, pointer: message.pointer || '' }));
    } catch (error) {
      out.errors.push({ code: 'NOT_GLTF', pointer: '' });
    }
    console.log(JSON.stringify(out));
  }
  console.error(validator.version());
}
main();
