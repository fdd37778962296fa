// Reading numbers and texts from bytes, little-endian, with every length checked.

const TEXT = new TextDecoder();

/** A text from UTF-8. Bytes that are not UTF-8 become replacement characters. @param {Uint8Array} bytes */
export function textOf(bytes) {
  return TEXT.decode(bytes);
}

/** Reads values from the start of a block of bytes to its end. Reading past the end is an error. */
export class Cursor {
  /** @param {Uint8Array} bytes */
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }

  get left() {
    return this.bytes.length - this.at;
  }

  /** The next position, after a value of some bytes. @param {number} size */
  take(size) {
    const at = this.at;
    if (size > this.left) throw new RangeError(`${size} bytes were expected, found ${this.left}`);
    this.at += size;
    return at;
  }

  u8() {
    return this.view.getUint8(this.take(1));
  }

  u16() {
    return this.view.getUint16(this.take(2), true);
  }

  u32() {
    return this.view.getUint32(this.take(4), true);
  }

  /** A whole number of 64 bits. Values above 2^53 lose their last digits. */
  u64() {
    return Number(this.view.getBigUint64(this.take(8), true));
  }

  f64() {
    return this.view.getFloat64(this.take(8), true);
  }

  /** The next bytes, not copied. @param {number} size */
  block(size) {
    const at = this.take(size);
    return this.bytes.subarray(at, at + size);
  }

  /** A text with its length in 32 bits before it. */
  text() {
    return textOf(this.block(this.u32()));
  }
}
