import { spawn, type ChildProcessWithoutNullStreams } from 'node:child_process'
import { mkdirSync, readFileSync } from 'node:fs'
import { expect } from '@playwright/test'

const COMMAND_MS_MAX = 60_000
const START_MS_MAX = 60_000

/** Shell of a person: lines are typed into it, and stand in its output with what they print. */
export class Terminal {
  readonly #shell: ChildProcessWithoutNullStreams
  #output = ''
  #commands = 0

  constructor(
    readonly folder: string,
    variables: Record<string, string>,
  ) {
    mkdirSync(folder, { recursive: true })
    // The kernel ends the shell with the test, however that ends.
    this.#shell = spawn('setpriv', ['--pdeathsig', 'KILL', '--', 'bash', '--norc', '--noprofile'], {
      cwd: folder,
      env: { ...process.env, ...variables },
    })
    for (const stream of [this.#shell.stdout, this.#shell.stderr])
      stream.on('data', (text: Buffer) => (this.#output += text.toString()))
  }

  /** Types a command, and what it asks for; returns what it printed once it ended well. */
  async run(command: string, answers: readonly string[] = []): Promise<string> {
    const before = this.#output.length
    const ended = new RegExp(`^ended ${++this.#commands} with (\\d+)$`, 'm')
    // In the same line: what follows is read by the command.
    this.#type([`${command}; echo -e "\\nended ${this.#commands} with $?"`, ...answers])
    await expect
      .poll(() => this.#output.slice(before), { message: command, timeout: COMMAND_MS_MAX })
      .toMatch(ended)
    const printed = this.#output.slice(before)
    expect(ended.exec(printed)?.[1], `${command}\n${printed}`).toBe('0')
    return printed.replace(ended, '').trim()
  }

  /** Types a command that goes on running, and waits until its pages answer. */
  async serve(command: string, url: string): Promise<void> {
    this.#type([command])
    const answers = (): Promise<boolean> =>
      fetch(`${url}/readyz`).then(
        ({ status }) => status > 0,
        () => false,
      )
    await expect
      .poll(answers, { message: `${command} answers\n${this.#output}`, timeout: START_MS_MAX })
      .toBe(true)
  }

  /** Presses Ctrl-C and waits for the end of the command. */
  async interrupt(): Promise<void> {
    for (const child of this.#children()) process.kill(child, 'SIGINT')
    await expect.poll(() => this.#children(), { timeout: COMMAND_MS_MAX }).toEqual([])
  }

  async close(): Promise<void> {
    await this.interrupt()
    this.#shell.stdin.end()
  }

  /** Last lines, to find the cause of a failure. */
  get tail(): string {
    return this.#output.split('\n').slice(-15).join('\n')
  }

  #type(lines: readonly string[]): void {
    this.#shell.stdin.write(`${lines.join('\n')}\n`)
  }

  #children(): number[] {
    const { pid } = this.#shell
    const list = readFileSync(`/proc/${pid}/task/${pid}/children`, 'utf8')
    return list.split(' ').filter(Boolean).map(Number)
  }
}
