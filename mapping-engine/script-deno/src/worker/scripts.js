// The scripts, each in a context of its own: a world with its own objects, without anything of Deno.

/** Completes the prelude's tools with what only this engine needs, in a script's own world. */
const OWN_TOOLS = `(tools) => {
  "use strict";
  const list = () => [], record = () => ({});
  // Deno would hand it functions of this program, and looks for it at what is called Error.
  Object.defineProperty(Error, "prepareStackTrace", { value: undefined });
  Object.defineProperty(globalThis, "Error", { writable: false, configurable: false });
  return Object.assign(tools, { list, record });
}`

const prelude = new vm.Script(setup.prelude, { filename: 'prelude' })
const ownTools = new vm.Script(OWN_TOOLS, { filename: 'tools' })

/** A script with everything that starts it again: its text, its state and the values of its inputs. */
class LoadedScript {
  /** Reads all of it but the values, which are read into its world. */
  constructor(from) {
    this.id = from.u32()
    this.file = fileName(from.text())
    this.source = from.text()
    this.inputs = from.sequence((f) => f.text())
    this.state = from.option((f) => f.text())
    /** The last bytes of each input's value, by its position. */
    this.values = new Map()
    this.running = null
    readInputs(from, this, null)
  }

  /** Compiles and runs the text in a new world; it evaluates to the function of the script. */
  start() {
    const world = vm.createContext(vm.constants.DONT_CONTEXTIFY, {
      codeGeneration: { strings: false, wasm: false },
    })
    const tools = ownTools.runInContext(world)(prelude.runInContext(world))
    this.inputs.forEach((name, index) => tools.define(index, name))
    if (this.state !== null) tools.restore(this.state)
    this.values.forEach((bytes, index) => setInput(tools, index, new Decoder(bytes)))
    const script = compiled(this.source, this.file).runInContext(world)
    if (typeof script !== 'function')
      throw invalid('the script must end with a function, as (value, ctx) => value')
    this.running = { tools, script }
    return this.running
  }

  /** Makes one call, whose arguments follow in the message, and writes its result but for the time. */
  call(from, to) {
    const begin = [from.at, to.length]
    const progress = { isRead: false }
    try {
      this.callNow(from, to, progress)
    } catch (thrown) {
      // Setting an input may run code of the script, which may throw: the next call follows all the same.
      if (!progress.isRead) {
        from.at = begin[0]
        readPast(from, this)
      }
      to.length = begin[1]
      const fault = faultOf(thrown, this.file)
      // Closures may hold what such a script allocated: only a new world is sure to have the memory back.
      if (fault.kind === KIND.outOfMemory) this.running = null
      to.refusal(fault)
      to.u8(0)
    }
  }

  callNow(from, to, progress) {
    const { tools, script } = this.running ?? this.start()
    let invoke
    if (from.u8() === 0) {
      const index = from.u16()
      invoke = () => tools.invokeInput(script, index)
    } else {
      const { value, status, time } = readSpoken(from, tools)
      invoke = () => tools.invoke(script, value, status, time)
    }
    readInputs(from, this, tools)
    progress.isRead = true
    const result = invoke()
    const begin = to.length
    try {
      writeYielded(to, result, tools)
    } catch (thrown) {
      // What is not a value is an outcome: the script ran to its end, so its state counts.
      if (!(thrown instanceof Refused)) throw thrown
      to.length = begin
      to.refusal(thrown)
    }
    const state = changedState(tools.state(), this.state)
    to.option(state, (json) => to.text(json))
    this.state = state ?? this.state
  }
}

/** Reads a call without making it. Inputs that it carries are kept where its script is known. */
function readPast(from, script) {
  if (from.u8() === 0) from.u16()
  else readSpoken(from, NO_TOOLS)
  readInputs(from, script, null)
}

/** Reads the inputs that changed: keeps their bytes, and sets them in the script's world where it has one. */
function readInputs(from, script, tools) {
  for (let left = from.u32(); left > 0; left--) {
    const index = from.u16()
    const begin = from.at
    if (tools === null) readSpoken(from, NO_TOOLS)
    else setInput(tools, index, from)
    script?.values.set(index, from.bytes.slice(begin, from.at))
  }
}

function setInput(tools, index, from) {
  const { value, status, time } = readSpoken(from, tools)
  tools.input(index, value, status, time)
}
