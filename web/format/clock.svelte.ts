/** Time of the server, updated every second. Ages stay right on a device whose clock is wrong. */
class Clock {
  now = $state(Date.now())
  #ahead = 0

  constructor() {
    setInterval(() => (this.now = Date.now() + this.#ahead), 1000)
  }

  /**
   * Corrects for the device's clock. `Date` headers have whole seconds, so small differences are
   * ignored.
   */
  heard(date: string | null): void {
    const server = date === null ? Number.NaN : Date.parse(date)
    if (Number.isNaN(server)) return
    const ahead = server + 500 - Date.now()
    this.#ahead = Math.abs(ahead) > 2500 ? ahead : 0
  }
}

export const clock = new Clock()
