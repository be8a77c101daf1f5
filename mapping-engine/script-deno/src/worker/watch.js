// The call at work in memory that the watchdog shares, so that it can end a call that nothing else ends.

/** Positions in the shared words. The watchdog has the same. */
const WORD = { call: 0, busy: 1, bytes: 2, results: 3, loading: 4, script: 5, never: 6 }
const WORDS_BYTES = 64
/** Calls are numbered up to here, odd while they run. */
const CALLS = 0x3fff_ffff

const shared = new SharedArrayBuffer(WORDS_BYTES + FRAME_BYTES_MAX)
const words = new Int32Array(shared, 0, WORDS_BYTES / 4)
const reached = new Uint8Array(shared, WORDS_BYTES)
let number = 0

/** Starts the watchdog and waits until it watches. */
function startWatchdog() {
  const watchdog = new Worker(setup.watchdog, { type: 'module' })
  return new Promise((resolve, reject) => {
    watchdog.onmessage = resolve
    watchdog.onerror = reject
    watchdog.postMessage({ shared, budgetMs: setup.overrunMs })
  })
}

/** Runs a call or a start under the watchdog's eyes. */
function watched(run) {
  number = (number + 1) & CALLS
  Atomics.store(words, WORD.call, number)
  if (words[WORD.busy] === 0) {
    Atomics.store(words, WORD.busy, 1)
    Atomics.notify(words, WORD.busy)
  }
  try {
    run()
  } finally {
    const next = (number + 1) & CALLS
    // The watchdog was faster: it is ending this process.
    while (Atomics.compareExchange(words, WORD.call, number, next) !== number)
      Atomics.wait(words, WORD.never, 0)
    number = next
  }
}

/** Notes what the watchdog sends in place of a message that this call keeps from being sent. */
function noteLoading(script) {
  words[WORD.loading] = script === null ? 0 : 1
  words[WORD.script] = script ?? 0
}

function noteResults(count, bytes) {
  reached.set(bytes, words[WORD.bytes])
  words[WORD.bytes] += bytes.length
  words[WORD.results] = count
}

function noteNone() {
  words[WORD.bytes] = 0
  words[WORD.results] = 0
}

/** The host waits for nothing: no call is at work until its next message. */
function rest() {
  Atomics.store(words, WORD.busy, 0)
}
