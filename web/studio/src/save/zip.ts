// A ZIP file of files that are stored as they are.

const table = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

export function crc32(bytes: Uint8Array): number {
  let crc = ~0;
  for (const byte of bytes) crc = table[(crc ^ byte) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}

export interface Entry {
  name: string;
  bytes: Uint8Array;
}

export const textBytes = (text: string): Uint8Array => new TextEncoder().encode(text);

/** The same entries give the same bytes: no time is in it but 1980. Less than 4 GiB. */
export function zip(entries: readonly Entry[]): Uint8Array {
  const parts: Uint8Array[] = [];
  const directory: Uint8Array[] = [];
  let offset = 0;
  for (const { name, bytes } of entries) {
    const path = textBytes(name);
    // Version 2, UTF-8 names, stored, the first of January 1980.
    const common = [20, 0x0800, 0, 0, 0x21];
    const sizes = [crc32(bytes), bytes.length, bytes.length];
    const head = new DataView(new ArrayBuffer(30));
    head.setUint32(0, 0x04034b50, true);
    common.forEach((value, i) => head.setUint16(4 + 2 * i, value, true));
    sizes.forEach((value, i) => head.setUint32(14 + 4 * i, value, true));
    head.setUint16(26, path.length, true);
    const entry = new DataView(new ArrayBuffer(46));
    entry.setUint32(0, 0x02014b50, true);
    entry.setUint16(4, 20, true);
    common.forEach((value, i) => entry.setUint16(6 + 2 * i, value, true));
    sizes.forEach((value, i) => entry.setUint32(16 + 4 * i, value, true));
    entry.setUint16(28, path.length, true);
    entry.setUint32(42, offset, true);
    parts.push(bytesOf(head), path, bytes);
    directory.push(bytesOf(entry), path);
    offset += 30 + path.length + bytes.length;
  }
  const length = directory.reduce((sum, part) => sum + part.length, 0);
  const end = new DataView(new ArrayBuffer(22));
  end.setUint32(0, 0x06054b50, true);
  end.setUint16(8, entries.length, true);
  end.setUint16(10, entries.length, true);
  end.setUint32(12, length, true);
  end.setUint32(16, offset, true);
  return joined([...parts, ...directory, bytesOf(end)]);
}

const bytesOf = (view: DataView): Uint8Array => new Uint8Array(view.buffer);

export function joined(parts: readonly Uint8Array[]): Uint8Array {
  const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}
