// Decompression for browsers without DecompressionStream (RFC 1951, in a gzip file: RFC 1952).

const LENGTH_BASE = [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258];
const LENGTH_BITS = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0];
const DISTANCE_BASE = [1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577];
const DISTANCE_BITS = [0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13];
const CODE_LENGTH_ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
const MAX_BITS = 15;

class BitReader {
  constructor(bytes, at) {
    this.bytes = bytes;
    this.at = at;
    this.buffer = 0;
    this.count = 0;
  }

  bits(n) {
    while (this.count < n) {
      this.buffer |= this.bytes[this.at++] << this.count;
      this.count += 8;
    }
    const value = this.buffer & ((1 << n) - 1);
    this.buffer >>>= n;
    this.count -= n;
    return value;
  }

  alignToByte() {
    this.buffer = 0;
    this.count = 0;
  }
}

// A canonical Huffman code as counts of codes by length and symbols in order.
function makeCode(lengths) {
  const counts = new Uint16Array(MAX_BITS + 1);
  for (const length of lengths) ++counts[length];
  counts[0] = 0;
  const starts = new Uint16Array(MAX_BITS + 2);
  for (let n = 1; n <= MAX_BITS; ++n) starts[n + 1] = starts[n] + counts[n];
  const symbols = new Uint16Array(lengths.length);
  lengths.forEach((length, symbol) => {
    if (length > 0) symbols[starts[length]++] = symbol;
  });
  return {counts, symbols};
}

function readSymbol(reader, {counts, symbols}) {
  let code = 0;
  let first = 0;
  let index = 0;
  for (let n = 1; n <= MAX_BITS; ++n) {
    code |= reader.bits(1);
    const count = counts[n];
    if (code - count < first) return symbols[index + code - first];
    index += count;
    first = (first + count) << 1;
    code <<= 1;
  }
  throw new Error('the data of this page are damaged');
}

function fixedCodes() {
  const lengths = new Array(288);
  for (let i = 0; i < 288; ++i) lengths[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
  return [makeCode(lengths), makeCode(new Array(30).fill(5))];
}

function readCodes(reader) {
  const literals = reader.bits(5) + 257;
  const distances = reader.bits(5) + 1;
  const codeLengths = new Array(19).fill(0);
  const given = reader.bits(4) + 4;
  for (let i = 0; i < given; ++i) codeLengths[CODE_LENGTH_ORDER[i]] = reader.bits(3);
  const code = makeCode(codeLengths);
  const lengths = [];
  while (lengths.length < literals + distances) {
    const symbol = readSymbol(reader, code);
    if (symbol < 16) {
      lengths.push(symbol);
      continue;
    }
    const value = symbol === 16 ? lengths[lengths.length - 1] : 0;
    const times = symbol === 16 ? 3 + reader.bits(2) : symbol === 17 ? 3 + reader.bits(3) : 11 + reader.bits(7);
    for (let i = 0; i < times; ++i) lengths.push(value);
  }
  return [makeCode(lengths.slice(0, literals)), makeCode(lengths.slice(literals))];
}

/** The contents of a gzip file. Its last four bytes say how long they are. */
export function gunzip(bytes) {
  const size = new DataView(bytes.buffer, bytes.byteOffset + bytes.length - 4, 4).getUint32(0, true);
  const output = new Uint8Array(size);
  const reader = new BitReader(bytes, 10);  // our own files have gzip's shortest header
  let at = 0;
  for (let isLast = false; !isLast;) {
    isLast = reader.bits(1) === 1;
    const kind = reader.bits(2);
    if (kind === 0) {
      reader.alignToByte();
      const length = bytes[reader.at] | bytes[reader.at + 1] << 8;
      reader.at += 4;
      output.set(bytes.subarray(reader.at, reader.at + length), at);
      reader.at += length;
      at += length;
      continue;
    }
    const [literalCode, distanceCode] = kind === 1 ? fixedCodes() : readCodes(reader);
    for (;;) {
      const symbol = readSymbol(reader, literalCode);
      if (symbol < 256) {
        output[at++] = symbol;
      } else if (symbol === 256) {
        break;
      } else {
        const length = LENGTH_BASE[symbol - 257] + reader.bits(LENGTH_BITS[symbol - 257]);
        const far = readSymbol(reader, distanceCode);
        const distance = DISTANCE_BASE[far] + reader.bits(DISTANCE_BITS[far]);
        for (let i = 0; i < length; ++i, ++at) output[at] = output[at - distance];
      }
    }
  }
  return output;
}
