// Times MoveNet in TensorFlow.js with the WebAssembly backend, for benchmarks/detect: node detect_tfjs.mjs MODELS REPEATS, in a folder with the
// npm packages. Prints the best milliseconds of a crop and of an image as JSON.
import fs from 'node:fs';
import path from 'node:path';
import { createRequire } from 'node:module';

const require = createRequire(path.join(process.cwd(), 'package.json'));
const tf = require('@tensorflow/tfjs-core');
const { loadGraphModel } = require('@tensorflow/tfjs-converter');
const wasm = require('@tensorflow/tfjs-backend-wasm');

const [models, repeats] = process.argv.slice(2);

function load(name) {
  const json = JSON.parse(fs.readFileSync(path.join(models, `${name}.json`)));
  const bytes = fs.readFileSync(path.join(models, `${name}.bin`));
  return loadGraphModel({
    load: async () => ({
      modelTopology: json.modelTopology,
      weightSpecs: json.weightsManifest[0].weights,
      weightData: bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength),
      signature: json.signature,
    }),
  });
}

async function bestMilliseconds(model, height, width) {
  let best = Infinity;
  for (let i = 0; i < Number(repeats) + 1; ++i) {
    const input = tf.zeros([1, height, width, 3], 'int32');
    const started = process.hrtime.bigint();
    const output = model.execute(input);
    await output.data();
    if (i > 0) best = Math.min(best, Number(process.hrtime.bigint() - started) / 1e6);
    output.dispose();
    input.dispose();
  }
  return best;
}

wasm.setWasmPaths(path.join(process.cwd(), 'node_modules/@tensorflow/tfjs-backend-wasm/dist/'));
wasm.setThreadsCount(1);
await tf.setBackend('wasm');
await tf.ready();
const crop = await bestMilliseconds(await load('movenet-thunder'), 256, 256);
const image = await bestMilliseconds(await load('movenet-multipose'), 512, 512);
console.log(JSON.stringify({ crop, image }));
