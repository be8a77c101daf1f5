import { expect, test } from '@playwright/test'
import { Counted } from './counted.ts'
import { connector } from './world.ts'

const CLICKS_MAX = 20
const TEXTS_MAX = 5
/** URL of a machine's OPC UA server whose certificate is not trusted yet. */
const MACHINE = process.env['MACHINE_URL'] ?? ''
/** Title of a field that a partner requested and the machine can answer. */
const FIELD = 'Power drawn by the spindle'

test('from an empty installation to the first mapped field', async ({ page }) => {
  test.setTimeout(120_000)
  const person = new Counted()
  // The token of the platform, typed once when the connector was installed.
  person.texts.push('enrolment token')

  await page.goto(connector.url)
  await person.type('user name', page.getByLabel('User name'), connector.userName)
  await person.type('password', page.getByLabel('Password'), connector.password)
  await person.click('sign in', page.getByRole('button', { name: 'Sign in' }))

  await test.step('the overview says what to do first', async () => {
    await expect(page.getByRole('heading', { name: 'First steps' })).toBeVisible()
    await person.click('add a source', page.getByRole('link', { name: 'Add a source' }))
    await person.type('address', page.getByLabel('Address'), MACHINE)
    await person.click('save', page.getByRole('button', { name: 'Save' }))
  })

  await test.step('the machine’s certificate waits for an approval beside the problem', async () => {
    const row = page.getByRole('row').filter({ hasText: MACHINE })
    await expect(row).toContainText('certificate is not trusted yet', { timeout: 30_000 })
    await person.click('trust', row.getByRole('button', { name: 'Trust' }))
    await expect(row).toContainText('Connected', { timeout: 30_000 })
  })

  await test.step('a suggestion is taken and consented to', async () => {
    await person.click('inbox', page.getByRole('navigation').getByRole('link', { name: /Inbox/ }))
    await person.click('decide', page.getByRole('link', { name: `Decide: ${FIELD}` }))
    await person.click(
      'suggestion',
      page
        .locator('[data-suggestion]')
        .first()
        .getByRole('button', { name: /^Take it/ }),
    )
    await person.click('consent', page.getByRole('button', { name: 'Consent', exact: true }))
    await expect(page.getByText('Consent recorded. Values flow.')).toBeVisible()
    await expect(page.locator('main').getByText('Mapped').first()).toBeVisible()
  })

  await test.step('the value flows', async () => {
    await page.goto(`${connector.url.replace(/\/$/, '')}/#/`)
    const row = page.getByRole('row').filter({ hasText: FIELD })
    await expect(row.locator('.figure')).toHaveText(/^[\d.,]+$/, { timeout: 15_000 })
  })

  console.info(
    `${person.clicks.length} clicks (${person.clicks.join(', ')}), ${person.texts.length} texts (${person.texts.join(', ')})`,
  )
  expect(person.clicks.length).toBeLessThanOrEqual(CLICKS_MAX)
  expect(person.texts.length).toBeLessThanOrEqual(TEXTS_MAX)
})
