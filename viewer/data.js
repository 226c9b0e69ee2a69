// Reads what src/canonpose/view/page.cc wrote into the page.
import {gunzip} from './inflate.js';

const MISSING = 65535;

function decodeBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function decompress(bytes) {
  if (typeof DecompressionStream === 'undefined') return gunzip(bytes);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Frames x channels, row by row; NaN where a value is missing. The inverse of PackedArrays::Add(). */
function unpack(bytes, {at, channels, frames, order, offset, step, log}) {
  const values = new Float32Array(channels * frames).fill(NaN);
  const count = channels * frames;
  for (let c = 0; c < channels; ++c) {
    let last = 0;
    let before = 0;
    let isFirst = true;
    for (let t = 0; t < frames; ++t) {
      const i = at + c * frames + t;
      const coded = bytes[i] | bytes[i + count] << 8;
      if (coded === MISSING) continue;
      const difference = coded & 1 ? -((coded + 1) >> 1) : coded >> 1;
      const number = ((order === 2 ? 2 * last - before : last) + difference) & 0xFFFF;
      before = isFirst ? number : last;
      last = number;
      isFirst = false;
      const value = offset[c] + step[c] * number;
      values[t * channels + c] = log ? 2 ** value : value;
    }
  }
  return values;
}

/** {results, program, array(description)}; arrays are read when they are first asked for. */
export async function readData() {
  const data = JSON.parse(document.getElementById('canonpose-data').textContent);
  const element = document.getElementById('canonpose-arrays');
  const bytes = await decompress(decodeBase64(element.textContent.trim()));
  element.remove();  // its text takes as much memory as all else
  const read = new Map();
  data.array = description => {
    if (!description) return null;
    if (!read.has(description.at)) read.set(description.at, unpack(bytes, description));
    return read.get(description.at);
  };
  return data;
}
