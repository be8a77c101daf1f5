import type { Locator } from '@playwright/test'

/** Counts what a person does: clicks (mouse or finger) and texts typed. */
export class Counted {
  readonly clicks: string[] = []
  readonly texts: string[] = []

  async click(what: string, place: Locator): Promise<void> {
    this.clicks.push(what)
    await place.click()
  }

  async type(what: string, place: Locator, text: string): Promise<void> {
    this.texts.push(what)
    await place.fill(text)
  }
}
