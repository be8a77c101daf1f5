import type { Locator } from '@playwright/test'

/** Counts what a person does: clicks (mouse or finger), texts typed, and lines typed at a terminal. */
export class Counted {
  readonly clicks: string[] = []
  readonly texts: string[] = []
  readonly lines: string[] = []

  async click(what: string, place: Locator): Promise<void> {
    this.clicks.push(what)
    await place.click()
  }

  async type(what: string, place: Locator, text: string): Promise<void> {
    this.texts.push(what)
    await place.fill(text)
  }

  /** Chooses of a list: a click that opens it, and one on the choice. */
  async choose(what: string, place: Locator, value: string): Promise<void> {
    this.clicks.push(what, value)
    await place.selectOption(value)
  }
}
