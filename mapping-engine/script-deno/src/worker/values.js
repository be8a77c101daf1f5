// What a script returns as a value of the protocol, within the limits of `script_protocol::worker::result`.

const DEPTH_MAX = 16
const ELEMENTS_MAX = 65_536
const TEXT_BYTES_MAX = 65_536
const STATE_BYTES_MAX = 4096

const KIND = { syntax: 0, error: 1, timeout: 2, outOfMemory: 3, result: 4, notLoaded: 5 }

/** A rule that a script broke; thrown by this program alone, so that no script gets hold of one. */
class Refused {
  constructor(kind, message) {
    Object.assign(this, { kind, name: '', message, line: null, column: null })
  }
}

const invalid = (message) => new Refused(KIND.result, message)

/** Writes what a script yielded: nothing, a value, or the members of a result object. */
function writeYielded(to, result, tools) {
  if (result === undefined) return to.u8(0)
  let value = result
  let status = 0
  if (isRecordLike(result) && tools.kind(result) === 'result') {
    const member = result.status
    if (member !== undefined) status = checkedStatus(member)
    value = result.value
    if (value === undefined) return to.u8(0)
  }
  to.u8(1)
  writeValue(to, value, tools, { left: ELEMENTS_MAX }, 0)
  to.u32(status)
}

const isRecordLike = (value) =>
  typeof value === 'object' && value !== null && !Array.isArray(value) && !types.isPromise(value)

function checkedStatus(status) {
  if (Number.isInteger(status) && status >= 0 && status <= 0xffff_ffff) return status
  throw invalid('"status" must be an OPC UA status code, a number from 0 to 2^32-1')
}

function writeValue(to, value, tools, budget, depth) {
  if (depth > DEPTH_MAX || budget.left === 0)
    throw invalid(
      `a result nests at most ${DEPTH_MAX} deep and has at most ${ELEMENTS_MAX} elements`,
    )
  budget.left--
  switch (typeof value) {
    case 'number':
      to.u8(2)
      return to.f64(value)
    case 'boolean':
      to.u8(1)
      return to.u8(value ? 1 : 0)
    case 'undefined':
      return to.u8(0)
    case 'string':
      return writeText(to, value)
    case 'bigint':
      return writeBigInt(to, value)
    case 'object':
      return value === null ? to.u8(0) : writeObject(to, value, tools, budget, depth)
    default:
      throw invalid(`a ${typeof value} is not a value`)
  }
}

function writeText(to, text) {
  if (!text.isWellFormed()) throw invalid('a text has half a character')
  to.u8(5)
  // No character has less than one byte.
  const bytes = text.length > TEXT_BYTES_MAX ? null : toUtf8.encode(text)
  if (bytes === null || bytes.length > TEXT_BYTES_MAX)
    throw invalid(`a text has at most ${TEXT_BYTES_MAX} bytes`)
  to.blob(bytes)
}

function writeBigInt(to, value) {
  if (BigInt.asIntN(64, value) === value) to.u8(3)
  else if (BigInt.asUintN(64, value) === value) to.u8(4)
  else throw invalid('the BigInt is beyond 64 bits')
  to.i64(BigInt.asIntN(64, value))
}

function writeObject(to, value, tools, budget, depth) {
  if (types.isPromise(value))
    throw invalid('the script must return a value, not a promise: async functions do not work here')
  if (Array.isArray(value)) return writeList(to, value, tools, budget, depth)
  switch (tools.kind(value)) {
    case 'time': {
      const time = tools.timeOf(value)
      if (Number.isNaN(time)) throw invalid('the Date is invalid')
      to.u8(6)
      return to.f64(time)
    }
    case 'bytes':
      return writeBytes(to, value)
    default: {
      const names = Object.keys(value)
      if (names.length > budget.left) throw invalid(`a result has at most ${ELEMENTS_MAX} elements`)
      to.u8(9)
      to.u32(names.length)
      for (const name of names) {
        to.text(name)
        writeValue(to, value[name], tools, budget, depth + 1)
      }
    }
  }
}

function writeList(to, list, tools, budget, depth) {
  const { length } = list
  // A proxy of an array has any length that its script likes: what is written has to be what is said.
  if (!Number.isInteger(length) || length < 0 || length > budget.left)
    throw invalid(`a result has at most ${ELEMENTS_MAX} elements`)
  to.u8(8)
  to.u32(length)
  for (let index = 0; index < length; index++) writeValue(to, list[index], tools, budget, depth + 1)
}

function writeBytes(to, value) {
  // What only inherits from a Uint8Array has no bytes: its length is unknown then.
  if (!types.isUint8Array(value))
    throw invalid('an object that only looks like a Uint8Array is not a value')
  const length = lengthOfBytes(value)
  if (length > TEXT_BYTES_MAX) throw invalid(`a Uint8Array has at most ${TEXT_BYTES_MAX} bytes`)
  to.u8(7)
  to.u32(length)
  const at = to.grow(length)
  setBytes(to.bytes, value, at)
}

const lengthOfBytes = Function.prototype.call.bind(
  Object.getOwnPropertyDescriptor(Object.getPrototypeOf(Uint8Array.prototype), 'length').get,
)

/** Returns `ctx.state` as JSON where it differs from the state before. A state that was removed is `null`. */
function changedState(json, before) {
  if (
    json !== undefined &&
    (json.length > STATE_BYTES_MAX || toUtf8.encode(json).length > STATE_BYTES_MAX)
  )
    throw invalid(`ctx.state has at most ${STATE_BYTES_MAX} bytes as JSON`)
  const after = json ?? (before === null ? null : 'null')
  return after === before ? null : after
}
