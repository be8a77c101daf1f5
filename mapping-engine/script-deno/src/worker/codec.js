// The messages of `script-protocol`, as it has them: little endian, lengths in four bytes, texts in UTF-8.

const FRAME_BYTES_MAX = 8 << 20
/** A message of results ends before: a fault fits in any case. */
const MESSAGE_BYTES_MAX = FRAME_BYTES_MAX - (1 << 16)
const FAULT_NAME_BYTES_MAX = 128
const FAULT_MESSAGE_BYTES_MAX = 1024

const utf8 = new TextDecoder()
const toUtf8 = new TextEncoder()

/** Takes values from the bytes of a message. The host is trusted: what ends within a value throws. */
class Decoder {
  constructor(bytes) {
    this.bytes = bytes
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
    this.at = 0
  }

  u8() {
    return this.view.getUint8(this.at++)
  }

  u16() {
    const value = this.view.getUint16(this.at, true)
    this.at += 2
    return value
  }

  u32() {
    const value = this.view.getUint32(this.at, true)
    this.at += 4
    return value
  }

  i64() {
    const value = this.view.getBigInt64(this.at, true)
    this.at += 8
    return value
  }

  u64() {
    return BigInt.asUintN(64, this.i64())
  }

  f64() {
    const value = this.view.getFloat64(this.at, true)
    this.at += 8
    return value
  }

  take() {
    const length = this.u32()
    if (length > this.bytes.length - this.at)
      throw new RangeError('the message ends within a value')
    const taken = this.bytes.subarray(this.at, this.at + length)
    this.at += length
    return taken
  }

  text() {
    return utf8.decode(this.take())
  }

  option(read) {
    return this.u8() === 1 ? read(this) : null
  }

  sequence(read) {
    return Array.from({ length: this.u32() }, () => read(this))
  }
}

/** Collects the bytes of a message. */
class Encoder {
  constructor() {
    this.bytes = new Uint8Array(1 << 12)
    this.view = new DataView(this.bytes.buffer)
    this.length = 0
    this.most = MESSAGE_BYTES_MAX
  }

  /** Makes room and returns where it begins. Throws where the message gets too long. */
  grow(count) {
    const at = this.length
    if (at + count > this.most) throw invalid('the results of a batch have at most 8 MiB')
    this.length += count
    if (this.length > this.bytes.length) {
      const larger = new Uint8Array(Math.max(this.length, this.bytes.length * 2))
      larger.set(this.bytes)
      this.bytes = larger
      this.view = new DataView(larger.buffer)
    }
    return at
  }

  u8(value) {
    const at = this.grow(1)
    this.view.setUint8(at, value)
  }

  u16(value) {
    const at = this.grow(2)
    this.view.setUint16(at, value, true)
  }

  u32(value) {
    const at = this.grow(4)
    this.view.setUint32(at, value, true)
  }

  /** 64 bits with sign or without: they are the same bits. */
  i64(value) {
    const at = this.grow(8)
    this.view.setBigInt64(at, value, true)
  }

  f64(value) {
    const at = this.grow(8)
    this.view.setFloat64(at, value, true)
  }

  raw(bytes) {
    const at = this.grow(bytes.length)
    this.bytes.set(bytes, at)
  }

  blob(bytes) {
    this.u32(bytes.length)
    this.raw(bytes)
  }

  text(text) {
    this.blob(toUtf8.encode(text))
  }

  option(value, write) {
    this.u8(value === null ? 0 : 1)
    if (value !== null) write(value)
  }

  /** Writes the result of a call that did not yield, but for its state and time. */
  refusal(fault) {
    this.most = FRAME_BYTES_MAX
    this.u8(2)
    this.fault(fault)
    this.most = MESSAGE_BYTES_MAX
  }

  /** Writes the end of a result: it fits, however long the result is. */
  spent(ms) {
    this.most = FRAME_BYTES_MAX
    this.u32(Math.min(ms * 1000, 0xffff_ffff))
    this.most = MESSAGE_BYTES_MAX
  }

  fault(fault) {
    this.u8(fault.kind)
    this.blob(cut(fault.name, FAULT_NAME_BYTES_MAX))
    this.blob(cut(fault.message, FAULT_MESSAGE_BYTES_MAX))
    this.option(fault.line, (line) => this.u32(line))
    this.option(fault.column, (column) => this.u32(column))
  }
}

/** At most so many bytes of a text, without cutting a character in two. */
function cut(text, most) {
  // A character has at least one byte.
  const bytes = toUtf8.encode(text.slice(0, most + 1))
  let end = Math.min(bytes.length, most)
  while (end < bytes.length && end > 0 && (bytes[end] & 0xc0) === 0x80) end--
  return bytes.subarray(0, end)
}

function readSpoken(from, tools) {
  return { value: readValue(from, tools), status: from.u32(), time: from.option((f) => f.f64()) }
}

/** Reads a value as one of a script's own world. */
function readValue(from, tools) {
  switch (from.u8()) {
    case 0:
      return null
    case 1:
      return from.u8() === 1
    case 2:
      return from.f64()
    case 3:
      return from.i64()
    case 4:
      return from.u64()
    case 5:
      return from.text()
    case 6:
      return tools.date(from.f64())
    case 7: {
      const bytes = from.take()
      const own = tools.bytes(bytes.length)
      setBytes(own, bytes)
      return own
    }
    case 8: {
      const list = tools.list()
      const length = from.u32()
      for (let index = 0; index < length; index++) define(list, index, readValue(from, tools))
      return list
    }
    case 9: {
      const record = tools.record()
      for (let left = from.u32(); left > 0; left--)
        define(record, from.text(), readValue(from, tools))
      return record
    }
    default:
      throw new RangeError('a value has an unknown tag')
  }
}

/** A value that is read past, so that the next is found; its objects belong to no script. */
const NO_TOOLS = {
  date: () => null,
  bytes: (length) => new Uint8Array(length),
  list: () => [],
  record: () => ({ __proto__: null }),
}

/** As a member of its own, whatever setters a prototype has. */
function define(object, name, value) {
  Object.defineProperty(object, name, {
    __proto__: null,
    value,
    writable: true,
    enumerable: true,
    configurable: true,
  })
}

const setBytes = Function.prototype.call.bind(Uint8Array.prototype.set)
