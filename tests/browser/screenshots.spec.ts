import { test } from '@playwright/test'
import { connector, enter, places, platform, signedIn } from './world.ts'

const FOLDER = process.env['SCREENSHOTS'] ?? '../../target/screenshots'
const SIZES = {
  desktop: { width: 1440, height: 900 },
  tablet: { width: 834, height: 1112 },
} as const

for (const site of [connector, platform]) {
  for (const colorScheme of ['light', 'dark'] as const) {
    for (const language of ['en', 'de'] as const) {
      for (const [size, viewport] of Object.entries(SIZES)) {
        test(`${site.app} ${colorScheme} ${language} ${size}`, async ({ browser }) => {
          const page = await signedIn(browser, site, {
            colorScheme,
            viewport,
            locale: language === 'de' ? 'de-DE' : 'en-GB',
            hasTouch: size === 'tablet',
          })
          await page.evaluate((code) => localStorage.setItem('verbund.language', code), language)
          await page.reload()
          for (const place of await places(page, site)) {
            const { name } = place
            await enter(page, site, place)
            await page.waitForTimeout(name.startsWith('field') || name === 'source' ? 1500 : 400)
            await page.screenshot({
              path: `${FOLDER}/${site.app}-${name}-${colorScheme}-${language}-${size}.png`,
              fullPage: true,
            })
          }
          await page.context().close()

          const stranger = await browser.newContext({
            colorScheme,
            viewport,
            locale: language === 'de' ? 'de-DE' : 'en-GB',
          })
          const entrance = await stranger.newPage()
          await entrance.goto(site.url)
          await entrance.getByRole('button', { name: /sign in|anmelden/i }).waitFor()
          await entrance.screenshot({
            path: `${FOLDER}/${site.app}-sign-in-${colorScheme}-${language}-${size}.png`,
          })
          await stranger.close()
        })
      }
    }
  }
}
