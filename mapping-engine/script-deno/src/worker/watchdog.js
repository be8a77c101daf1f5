// Ends the process when a call has used up its computing time. V8 stops no function of its own, and there is no way back
// into a script: so a second thread looks at the call at work, and when it overran sends what was reached so far and exits.

const WORD = { call: 0, busy: 1, bytes: 2, results: 3, loading: 4, script: 5, never: 6 }
const WORDS_BYTES = 64
const OVERRUN = 3
const LOAD_OVERRUN = 4
/** The clock of the computing time of one thread, as Linux numbers it: the main one, not those that collect garbage of all. */
const THREAD_CLOCK = (~Deno.pid << 3) | 6
/** A call that neither computes nor ends is ended after so many budgets by the wall clock. */
const WALL_FACTOR = 20

/** The permission for it is the main thread's, which gives it up for both. */
const library = Deno.dlopen('libc.so.6', {
  clock_gettime: { parameters: ['i32', 'buffer'], result: 'i32' },
  _exit: { parameters: ['i32'], result: 'void' },
}).symbols

const time = new BigInt64Array(2)
const timeBytes = new Uint8Array(time.buffer)

/** Milliseconds that the main thread has computed. A busy machine makes no script guilty. */
function computed() {
  library.clock_gettime(THREAD_CLOCK, timeBytes)
  return Number(time[0]) * 1000 + Number(time[1]) / 1e6
}

onmessage = ({ data: { shared, budgetMs } }) => {
  const words = new Int32Array(shared, 0, WORDS_BYTES / 4)
  const pause = Math.min(Math.max(budgetMs / 16, 1), 100)
  computed()
  postMessage('watching')
  let seen = { call: 0, computed: 0, wall: 0 }
  for (;;) {
    if (Atomics.load(words, WORD.busy) === 0) {
      Atomics.wait(words, WORD.busy, 0)
      continue
    }
    Atomics.wait(words, WORD.never, 0, pause)
    const now = {
      call: Atomics.load(words, WORD.call),
      computed: computed(),
      wall: performance.now(),
    }
    if (now.call !== seen.call) seen = now
    else if (
      now.call % 2 === 1 &&
      (now.computed - seen.computed >= budgetMs ||
        now.wall - seen.wall >= budgetMs * WALL_FACTOR) &&
      // The call may have ended in the last moment; then nothing happens.
      Atomics.compareExchange(words, WORD.call, now.call, -1) === now.call
    )
      end(words, new Uint8Array(shared, WORDS_BYTES))
  }
}

function end(words, reached) {
  const isLoading = words[WORD.loading] === 1
  const bytes = isLoading ? 0 : words[WORD.bytes]
  const frame = new Uint8Array(9 + bytes)
  const view = new DataView(frame.buffer)
  view.setUint32(0, frame.length - 4, true)
  view.setUint8(4, isLoading ? LOAD_OVERRUN : OVERRUN)
  view.setUint32(5, isLoading ? words[WORD.script] : words[WORD.results], true)
  frame.set(reached.subarray(0, bytes), 9)
  // Read by the host or not, this process ends here.
  try {
    for (let at = 0; at < frame.length;) at += Deno.stdout.writeSync(frame.subarray(at))
  } catch {}
  library._exit(1)
}
