/** The time, ticking once a second, as the server tells it: ages stay right on a tablet whose clock is wrong. */
class Clock {
  now = $state(Date.now())
  #ahead = 0

  constructor() {
    setInterval(() => (this.now = Date.now() + this.#ahead), 1000)
  }

  /** Corrects for this machine's clock. `Date` headers count whole seconds, so small differences are left alone. */
  heard(date: string | null): void {
    const server = date === null ? Number.NaN : Date.parse(date)
    if (Number.isNaN(server)) return
    const ahead = server + 500 - Date.now()
    this.#ahead = Math.abs(ahead) > 2500 ? ahead : 0
  }
}

export const clock = new Clock()
