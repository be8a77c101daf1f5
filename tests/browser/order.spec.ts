import { expect, test, type Page } from '@playwright/test'
import { connector, platform, signedIn } from './world.ts'

/** Network of the demo; its frames are late from the begin on. */
const NETWORK = 'frame-4711'

const network = (operation = ''): string =>
  `${platform.url.replace(/\/$/, '')}/#/networks/${NETWORK}${operation && `/${operation}`}`

/** Box of an operation in the graph. */
const box = (page: Page, operation: string) => page.locator(`[data-operation="${operation}"]`)

test('one operation is late, and the partner sees what it hits', async ({ browser }) => {
  // Once all of an order is done, the next one shows it.
  test.setTimeout(150_000)
  const slow = { timeout: 120_000 }
  const partner = await signedIn(browser, platform, { locale: 'en-GB' })
  await partner.goto(network())
  await expect(box(partner, 'ShipFrame1')).toContainText(/of 12/, slow)
  const timeline = partner.getByRole('group', {
    name: 'Planned and actual times of the operations',
  })
  for (const waiting of ['Ship frame 1', 'Inspect frame 1', 'Assemble frame 1'])
    await expect(timeline.getByRole('button', { name: waiting })).toContainText(
      /Held up|late|overdue/,
      slow,
    )
  await expect(box(partner, 'MakeFrame1')).toContainText(/1 min \d+ s late/, slow)
  // Counted from the start of the order, and never beyond the plan.
  await expect(box(partner, 'MakeFrame1')).toContainText(/\s(\d|1[0-2]) of 12/)
  await partner.context().close()
})

test('a failure and its reason are on the pages of both sides, until it is over', async ({
  browser,
}) => {
  // At worst it has just passed, and comes with the next order.
  test.setTimeout(300_000)
  const partner = await signedIn(browser, platform, { locale: 'en-GB' })
  await partner.goto(network('MakeFrame1'))
  const reason = partner.locator('[data-field="interruptedBy"]')
  await expect(reason).toContainText('Tool life exceeded', { timeout: 200_000 })
  await expect(box(partner, 'MakeFrame1')).toContainText('Interrupted')
  const engineer = await signedIn(browser, connector, { locale: 'en-GB' })
  await engineer.goto(
    `${connector.url.replace(/\/$/, '')}/#/fields/${NETWORK}/MakeFrame1/ReqResponse1/interruptedBy`,
  )
  await expect(engineer.locator('main')).toContainText('Tool life exceeded')
  await expect(box(partner, 'MakeFrame1')).toContainText('Running', { timeout: 60_000 })
  await expect(reason).not.toContainText('Tool life exceeded')
  await partner.context().close()
  await engineer.context().close()
})
