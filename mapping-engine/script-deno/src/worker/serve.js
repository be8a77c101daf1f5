// The loop: read, call, answer. Everything is done at once, one after the other: scripts' promises are never awaited.

const { stdin, stdout, exit } = Deno
const now = performance.now.bind(performance)

const MESSAGE = { welcome: 0, loaded: 1, results: 2 }
/** A batch ends early beyond: each call has at least the other half of a frame. */
const BATCH_BYTES_MAX = FRAME_BYTES_MAX >> 1

const scripts = new Map()

function readFrame() {
  const header = readExactly(4)
  if (header === null) return null
  const length = new DataView(header.buffer).getUint32(0, true)
  if (length > FRAME_BYTES_MAX) throw new RangeError('a frame is too long')
  return readExactly(length)
}

/** Reads ahead, so that a frame takes one call of the system. */
const ahead = { bytes: new Uint8Array(1 << 16), begin: 0, end: 0 }

/** Returns so many bytes; null where the stream ends before. */
function readExactly(count) {
  const taken = new Uint8Array(count)
  let length = 0
  while (length < count) {
    if (ahead.begin === ahead.end) {
      const read = stdin.readSync(ahead.bytes)
      if (read === null) return null
      Object.assign(ahead, { begin: 0, end: read })
    }
    const part = ahead.bytes.subarray(
      ahead.begin,
      Math.min(ahead.end, ahead.begin + count - length),
    )
    taken.set(part, length)
    length += part.length
    ahead.begin += part.length
  }
  return taken
}

/** Sends what was written as one frame. */
function send(message) {
  rest()
  const frame = new Uint8Array(4 + message.length)
  new DataView(frame.buffer).setUint32(0, message.length, true)
  frame.set(message.bytes.subarray(0, message.length), 4)
  for (let at = 0; at < frame.length;) at += stdout.writeSync(frame.subarray(at))
}

function welcome(walls) {
  const message = new Encoder()
  message.u8(MESSAGE.welcome)
  message.u16(setup.version)
  message.text(`Deno ${Deno.version.deno} (V8 ${Deno.version.v8})`)
  message.u8(walls.isFiltered ? 1 : 0)
  message.u8(setup.landlock)
  message.u32(setup.userId)
  message.u8(walls.hasLimits ? 1 : 0)
  return message
}

function load(from) {
  const script = new LoadedScript(from)
  scripts.delete(script.id)
  let fault = null
  noteLoading(script.id)
  watched(() => {
    try {
      script.start()
    } catch (thrown) {
      fault = faultOf(thrown, script.file)
    }
  })
  noteLoading(null)
  if (fault === null) scripts.set(script.id, script)
  const answer = new Encoder()
  answer.u8(MESSAGE.loaded)
  answer.u32(script.id)
  answer.option(fault, (found) => answer.fault(found))
  send(answer)
}

/** Makes calls until their time or a frame is used up; the host sends the rest again. */
function batch(from) {
  const answer = new Encoder()
  answer.u8(MESSAGE.results)
  answer.u32(0)
  noteNone()
  const begun = now()
  let last = begun
  let results = 0
  for (let left = from.u32(); left > 0; left--) {
    const begin = answer.length
    watched(() => call(from, answer))
    const ended = now()
    answer.spent(ended - last)
    last = ended
    results++
    noteResults(results, answer.bytes.subarray(begin, answer.length))
    if (ended - begun > setup.batchMs || answer.length > BATCH_BYTES_MAX) break
  }
  answer.view.setUint32(1, results, true)
  send(answer)
}

function call(from, to) {
  const script = scripts.get(from.u32())
  if (script !== undefined) return script.call(from, to)
  readPast(from, null)
  to.refusal(notLoaded())
  to.u8(0)
}

function serve() {
  for (;;) {
    const frame = readFrame()
    if (frame === null) return
    const from = new Decoder(frame)
    switch (from.u8()) {
      case 1:
        load(from)
        break
      case 2:
        scripts.delete(from.u32())
        break
      case 3:
        batch(from)
        break
      default:
        throw new RangeError('the host sent something else than work')
    }
  }
}

/** What a script could reach if it got hold of one object of this program is taken away, too. */
function disarm() {
  for (const f of [function () {}, function* () {}, async function () {}, async function* () {}])
    Object.defineProperty(Object.getPrototypeOf(f), 'constructor', { value: undefined })
  for (const type of [Object, Array, Function, Map, Uint8Array, DataView, RegExp, String, Promise])
    Object.freeze(type.prototype)
  for (const name of [
    'Deno',
    'Worker',
    'fetch',
    'WebSocket',
    'eval',
    'Function',
    'WebAssembly',
    'process',
  ])
    delete globalThis[name]
}

await startWatchdog()
const greeting = welcome(enterSandbox())
disarm()
send(greeting)
serve()
// Not to the end of the program: Deno's own loop needs calls that the filter denies.
exit(0)
