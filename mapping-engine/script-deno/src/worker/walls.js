// The last walls, which take effect once Deno has started its threads and read its libraries. The launcher has set what
// holds from the start. `setup` is what it hands over.
import process from 'node:process'
import { types } from 'node:util'
import vm from 'node:vm'

const setup = JSON.parse(Deno.args[0])

/** Numbers of Linux that every processor has in common. */
const PR_SET_DUMPABLE = 4
const RLIMIT = { nproc: 6, nofile: 7 }
const SECCOMP_SET_MODE_FILTER = 1
const SECCOMP_FILTER_FLAG_TSYNC = 1
const SYS_SECCOMP = { x64: 317, arm64: 277 }[process.arch]

function openLibrary() {
  return Deno.dlopen('libc.so.6', {
    prctl: { parameters: ['i32', 'usize', 'usize', 'usize', 'usize'], result: 'i32' },
    setrlimit: { parameters: ['i32', 'buffer'], result: 'i32' },
    getrlimit: { parameters: ['i32', 'buffer'], result: 'i32' },
    syscall: { parameters: ['isize', 'usize', 'usize', 'buffer'], result: 'isize' },
  }).symbols
}

/** Lets the kernel filter the calls of all threads. False where it does not. */
function filtered(library) {
  const program = Uint8Array.from(setup.filter.match(/../g) ?? [], (byte) => parseInt(byte, 16))
  if (program.length === 0 || SYS_SECCOMP === undefined) return false
  // struct sock_fprog: the number of instructions, of eight bytes each, and where they are.
  const head = new DataView(new ArrayBuffer(16))
  head.setUint16(0, program.length / 8, true)
  head.setBigUint64(8, BigInt(Deno.UnsafePointer.value(Deno.UnsafePointer.of(program))), true)
  const flags = SECCOMP_FILTER_FLAG_TSYNC
  return (
    Number(
      library.syscall(SYS_SECCOMP, SECCOMP_SET_MODE_FILTER, flags, new Uint8Array(head.buffer)),
    ) === 0
  )
}

/** Sets both bounds of a resource, and returns whether they read back. */
function bounded(library, resource, value) {
  const bounds = new BigUint64Array([BigInt(value), BigInt(value)])
  library.setrlimit(resource, new Uint8Array(bounds.buffer))
  const read = new BigUint64Array(2)
  library.getrlimit(resource, new Uint8Array(read.buffer))
  return read[0] === bounds[0] && read[1] === bounds[1]
}

/** Returns the walls that hold from here on. Nothing of this program can be taken back, by itself least of all. */
function enterSandbox() {
  const library = openLibrary()
  library.prctl(PR_SET_DUMPABLE, 0n, 0n, 0n, 0n)
  const hasLimits = [
    bounded(library, RLIMIT.nproc, 0),
    // No number is free for another file.
    bounded(library, RLIMIT.nofile, 0),
  ].every(Boolean)
  const isFiltered = filtered(library)
  Deno.permissions.revokeSync({ name: 'ffi' })
  const isGivenBack = Deno.permissions.querySync({ name: 'ffi' }).state !== 'granted'
  return { isFiltered: isFiltered && isGivenBack, hasLimits: hasLimits && setup.hasLimits }
}
