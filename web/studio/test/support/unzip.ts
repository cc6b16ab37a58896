// The files of a ZIP whose entries are stored as they are.
export function unzip(bytes: Uint8Array): Map<string, Uint8Array> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const files = new Map<string, Uint8Array>();
  for (let at = 0; view.getUint32(at, true) === 0x04034b50; ) {
    const size = view.getUint32(at + 18, true);
    const length = view.getUint16(at + 26, true);
    const start = at + 30 + length;
    const name = new TextDecoder().decode(bytes.subarray(at + 30, start));
    files.set(name, bytes.subarray(start, start + size));
    at = start + size;
  }
  return files;
}
