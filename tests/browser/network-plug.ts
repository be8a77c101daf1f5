import { createServer, connect, type AddressInfo, type Server, type Socket } from 'node:net'

/**
 * Network cable of one device: connections to `url` lead to a daemon's address until the plug is
 * pulled, which also ends those that are open. A browser's own switch for being offline is applied
 * to a page that is just being loaded a moment late; nothing passes a plug that is out.
 */
export class NetworkPlug {
  readonly #server: Server
  readonly #open = new Set<Socket>()
  #isIn = true

  private constructor(target: URL) {
    this.#server = createServer((near) => {
      if (!this.#isIn) return void near.destroy()
      const far = connect(Number(target.port || 80), target.hostname)
      this.#hold(near, far)
      this.#hold(far, near)
      near.pipe(far)
      far.pipe(near)
    })
  }

  /** Opens a port of this machine that leads to the address. */
  static async to(url: string): Promise<NetworkPlug> {
    const plug = new NetworkPlug(new URL(url))
    await new Promise<void>((resolve) => plug.#server.listen(0, '127.0.0.1', resolve))
    return plug
  }

  /** Address at which the device reaches the daemon. */
  get url(): string {
    return `http://127.0.0.1:${(this.#server.address() as AddressInfo).port}`
  }

  pull(): void {
    this.#isIn = false
    for (const socket of this.#open) socket.destroy()
  }

  putBack(): void {
    this.#isIn = true
  }

  async close(): Promise<void> {
    this.pull()
    await new Promise((resolve) => this.#server.close(resolve))
  }

  #hold(socket: Socket, other: Socket): void {
    this.#open.add(socket)
    socket.on('error', () => undefined)
    socket.on('close', () => {
      this.#open.delete(socket)
      other.destroy()
    })
  }
}
