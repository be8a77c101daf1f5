// What was thrown as a fault of the protocol, with its place in the script.

/** Tells the place of an error of the compiler, which has no stack. */
const { destructureError } = Deno[Deno.internal]?.core ?? {}

const notLoaded = () => new Refused(KIND.notLoaded, 'there is no such script')
const outOfMemory = () =>
  new Refused(KIND.outOfMemory, 'the script used more memory than it may; it starts again')

/** Characters that delimit places in stack traces are replaced: a name that looks like a place would be taken for one. */
const fileName = (script) => `${script.replace(/[:()\n\r\0]/g, '_')}.js`

/** Returns what a script threw as fault. Reading it may run code of the script, which may throw again. */
function faultOf(thrown, file) {
  if (thrown instanceof Refused) return thrown
  try {
    return types.isNativeError(thrown)
      ? faultOfError(thrown, file)
      : new Refused(KIND.error, String(thrown))
  } catch {
    return new Refused(KIND.error, 'a thrown value')
  }
}

function faultOfError(error, file) {
  const text = (value) => (typeof value === 'string' ? value : '')
  const [name, message, stack] = [text(error.name), text(error.message), text(error.stack)]
  // The heap's end is the process' end; what lies beside it, the contents of buffers, is refused by an error.
  if (name === 'RangeError' && /allocation failed|out of memory/i.test(message))
    return outOfMemory()
  return Object.assign(new Refused(KIND.error, message), { name }, placeIn(stack, file))
}

/**
 * Finds the innermost place in the script's own file, as in `    at f (name.js:3:10)`. What an error is thrown at while
 * the script is loaded stands above that, without a column.
 */
function placeIn(stack, file) {
  let found = null
  for (const line of stack.split('\n')) {
    const at = line.indexOf(`${file}:`)
    if (at < 0) continue
    const [, number, column] = /^(\d+)(?::(\d+))?/.exec(line.slice(at + file.length + 1)) ?? []
    if (column !== undefined) return place(Number(number), Number(column))
    if (number !== undefined) found ??= place(Number(number), null)
  }
  return found ?? { line: null, column: null }
}

/** Positions that a script invents may be beyond 32 bits. */
function place(line, column) {
  const fits = (number) => (number !== null && number >= 1 && number <= 0xffff_ffff ? number : null)
  return { line: fits(line), column: fits(column) }
}

/** The directive stands on the first line, so that lines keep their numbers; columns of that line are moved back. */
const STRICT = '"use strict";'

/** Compiles a script's text in strict mode. */
function compiled(source, file) {
  const limit = Error.stackTraceLimit
  // Without frames of its own an error of the compiler has the place in the text as its only one.
  Error.stackTraceLimit = 0
  try {
    return new vm.Script(STRICT + source, { filename: file, columnOffset: -STRICT.length })
  } catch (error) {
    const fault = Object.assign(faultOf(error, file), { kind: KIND.syntax })
    const frame = destructureError?.(error).frames[0]
    throw frame ? Object.assign(fault, place(frame.lineNumber, frame.columnNumber)) : fault
  } finally {
    Error.stackTraceLimit = limit
  }
}
