import AxeBuilder from '@axe-core/playwright'
import { expect, test } from '@playwright/test'
import { connector, enter, places, platform, signedIn, visit } from './world.ts'

/** True where pages are looked at as they open, without what their buttons show. */
const WITHOUT_DIALOGS = process.env['WITHOUT_DIALOGS'] === '1'

for (const site of [connector, platform]) {
  for (const colorScheme of ['light', 'dark'] as const) {
    test(`${site.app} has no barriers in ${colorScheme}`, async ({ browser }) => {
      const page = await signedIn(browser, site, { colorScheme })
      const all = await places(page, site)
      const shown = WITHOUT_DIALOGS ? all.filter(({ act }) => act === undefined) : all
      expect(shown.length).toBeGreaterThan(10)
      for (const place of shown) {
        await enter(page, site, place)
        const { violations } = await new AxeBuilder({ page })
          .withTags(['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa'])
          .analyze()
        const said = violations.map(
          (violation) =>
            `${violation.id}: ${violation.nodes.map((node) => `${node.target.join(' ')} ${node.any[0]?.message ?? ''}`).join('; ')}`,
        )
        expect.soft(said, `${site.app}/${place.name}`).toEqual([])
      }
      await page.context().close()
    })
  }

  test(`${site.app} asks for nothing elsewhere and breaks no rule of its own policy`, async ({
    browser,
  }) => {
    const page = await signedIn(browser, site)
    const foreign: string[] = []
    const complaints: string[] = []
    page.on('request', (request) => {
      if (
        !request.url().startsWith(site.url.replace(/\/$/, '')) &&
        !request.url().startsWith('data:')
      )
        foreign.push(request.url())
    })
    page.on('console', (message) => {
      if (message.type() === 'error') complaints.push(message.text())
    })
    page.on('pageerror', (error) => complaints.push(String(error)))
    for (const { hash } of await places(page, site)) {
      await visit(page, site, hash)
      await page.reload()
      await expect(page.locator('main h1')).toBeVisible()
    }
    expect(foreign).toEqual([])
    expect(complaints).toEqual([])
    await page.context().close()
  })
}
