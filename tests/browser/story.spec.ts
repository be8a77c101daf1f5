import { expect, test, type Locator, type Page } from '@playwright/test'
import { api, connector, platform, signedIn, signIn } from './world.ts'

/** Source of a machine and the path of a counter in it, from the Objects folder. */
const SOURCE = process.env['STORY_SOURCE'] ?? 'MillingCell1'
const NODE_PATH = (process.env['STORY_NODE'] ?? 'MillingCell1/Production/PartCounter').split('/')

const REQUEST = `Browser${Date.now()}`
/** Alike to the variable, so that it is suggested. */
const COUNT = 'browserPartCounter'
const SECRET = 'browserSecret'

interface View {
  network: {
    operationNetworkId: string
    operationList: {
      operationId: string
      operationType: string
      owningFactoryId?: string
      dynamicDataRequestList?: { requesterId: string }[]
    }[]
  }
}

/** Returns the first production operation of the connector's factory, with its network. */
async function place(
  partner: Page,
  engineer: Page,
): Promise<{ network: string; operation: string }> {
  const { factoryId } = await api<{ factoryId: string }>(engineer.request, connector, '/status')
  const { items } = await api<{
    items: { operationNetworkId: string; withdrawnAt?: string | null }[]
  }>(partner.request, platform, '/operation-networks')
  for (const { operationNetworkId, withdrawnAt } of items) {
    if (withdrawnAt) continue
    const { network } = await api<View>(
      partner.request,
      platform,
      `/operation-networks/${encodeURIComponent(operationNetworkId)}`,
    )
    const operation = network.operationList.find(
      (each) => each.owningFactoryId === factoryId && each.operationType === 'PRODUCTION',
    )
    if (operation !== undefined)
      return { network: operationNetworkId, operation: operation.operationId }
  }
  throw new Error('No network has an operation of the connector’s factory that makes something.')
}

/** Opens the tree down to a variable and returns it. */
async function variable(tree: Locator, path: readonly string[]): Promise<Locator> {
  let item = tree
    .getByRole('treeitem')
    .filter({ hasText: path[0] ?? '' })
    .first()
  for (const [index, name] of path.entries()) {
    item = tree
      .locator(`[role=treeitem][aria-level="${index + 1}"]`)
      .filter({ hasText: name })
      .first()
    await item.waitFor()
    if (index < path.length - 1 && (await item.getAttribute('aria-expanded')) === 'false')
      await item.click()
  }
  return item
}

test.describe.configure({ mode: 'serial' })

test('who has no password stays outside', async ({ browser }) => {
  for (const site of [connector, platform]) {
    const page = await (await browser.newContext({ locale: 'en-GB' })).newPage()
    await page.goto(site.url)
    await page.getByLabel('User name').fill(site.userName)
    await page.getByLabel('Password').fill('certainly not this')
    await page.getByRole('button', { name: 'Sign in' }).click()
    await expect(page.getByRole('alert')).toHaveText('User name or password is not right.')
    await signIn(page, site)
    await page.getByRole('button', { name: 'Sign out' }).click()
    await expect(page.getByRole('button', { name: 'Sign in' })).toBeVisible()
    expect((await page.request.get(`${site.url.replace(/\/$/, '')}/api/v1/status`)).status()).toBe(
      401,
    )
    await page.context().close()
  }
})

test('from a partner’s question to the value on its page, and back', async ({ browser }) => {
  test.setTimeout(180_000)
  const partner = await signedIn(browser, platform, { locale: 'en-GB' })
  const engineer = await signedIn(browser, connector, { locale: 'en-GB' })
  const { network, operation } = await place(partner, engineer)
  await engineer.goto(`${connector.url.replace(/\/$/, '')}/#/inbox`)
  await expect(engineer.getByRole('heading', { name: 'Inbox', level: 1 })).toBeVisible()

  await test.step('the partner asks', async () => {
    await partner.goto(
      `${platform.url.replace(/\/$/, '')}/#/networks/${encodeURIComponent(network)}/${encodeURIComponent(operation)}`,
    )
    await partner.getByRole('button', { name: 'Request data' }).click()
    const dialog = partner.getByRole('dialog')
    await dialog.getByLabel('What for').fill('See that the browser tests reach both ends')
    await dialog.getByText('Technical details').click()
    await dialog.getByLabel('Request id').fill(REQUEST)
    await dialog.getByRole('spinbutton', { name: 'How often' }).fill('1')
    await dialog.getByRole('combobox', { name: 'times per' }).selectOption('SECOND')
    await dialog.getByLabel('Name 1').fill(COUNT)
    await dialog.getByLabel('Unit 1').fill('')
    await dialog.getByLabel('Meaning 1').selectOption('')
    await dialog.getByRole('button', { name: 'Something else' }).click()
    await dialog.getByLabel('Name 2').fill(SECRET)
    await dialog.getByLabel('Type 2').selectOption('String')
    await dialog.getByRole('button', { name: 'Send the request' }).click()
    await expect(dialog).toBeHidden()
    await expect(partner.locator(`[data-field="${COUNT}"]`)).toContainText('Pending')
  })

  const row = engineer.locator(`tr[data-field="${COUNT}"]`).last()
  await test.step('the question appears on the open page of the factory', async () => {
    await expect(row).toContainText('Pending', { timeout: 10_000 })
    await row.getByRole('link', { name: `Decide: ${COUNT}` }).click()
    await expect(engineer.getByRole('heading', { name: COUNT, level: 1 })).toBeVisible()
  })

  const consent = engineer.getByRole('button', { name: 'Consent', exact: true })
  await test.step('the engineer takes a suggestion', async () => {
    const suggestions = engineer.getByRole('region', { name: 'Suggestions' })
    await expect(suggestions.locator('[data-suggestion]').first()).toBeVisible({ timeout: 30_000 })
    const more = suggestions.getByRole('button', { name: /^\d+ more$/ })
    if (await more.isVisible()) await more.click()
    const fitting = suggestions
      .locator('[data-suggestion]')
      .filter({ hasText: `${SOURCE} ›` })
      .filter({ hasText: NODE_PATH.at(-1) ?? '' })
      .first()
    await fitting.getByRole('button', { name: /^Take it: / }).click()
    await expect(
      engineer.getByText('Suggestion taken. Look at the preview, then consent.'),
    ).toBeVisible()
    await expect(fitting).toHaveClass(/picked/)
    await expect(fitting.getByRole('button')).toHaveCount(0)
    await expect(consent).toBeEnabled()
  })

  await test.step('the engineer looks it up among all variables', async () => {
    await engineer.getByRole('combobox', { name: 'Source' }).selectOption(SOURCE)
    const item = await variable(engineer.getByRole('tree'), NODE_PATH)
    await expect(item.locator('.figure')).not.toHaveText('no value')
    await item.click()
    await expect(item).toHaveAttribute('aria-selected', 'true')
    await expect(consent).toBeEnabled()
  })

  await test.step('a script error is shown at its line and prevents consent', async () => {
    await engineer.getByRole('combobox', { name: 'Add a function' }).selectOption('script')
    const code = engineer.locator('.code .cm-content')
    await code.click()
    await engineer.keyboard.press('Control+A')
    await engineer.keyboard.insertText('(value, ctx) => {\n  return value +\n}')
    await expect(engineer.locator('li .fault')).toBeVisible()
    await expect(consent).toBeDisabled()
    await code.click()
    await engineer.keyboard.press('Control+A')
    await engineer.keyboard.insertText('(value, ctx) => valeu + 1')
    await expect(engineer.getByText('Fails on the present value')).toBeVisible()
    await expect(consent).toBeDisabled()
    await code.click()
    await engineer.keyboard.press('Control+A')
    await engineer.keyboard.insertText('(value, ctx) => value')
    await expect(engineer.locator('li .fault')).toBeHidden()
    await expect(consent).toBeEnabled()
  })

  await test.step('the preview is the message to the partner, and follows the disclosure', async () => {
    const message = engineer.getByRole('region', { name: 'Message to the partner' })
    await expect(message).toContainText(REQUEST)
    await engineer.getByLabel('Rounding step').fill('5')
    await expect(engineer.getByText('Description for the partner:')).toContainText(/multiples of 5/)
    await expect.poll(async () => shownIn(await message.textContent()) % 5).toBe(0)
  })

  await test.step('a draft outlasts a reload', async () => {
    engineer.once('dialog', (dialog) => void dialog.accept())
    await engineer.reload()
    await expect(engineer.getByText('This is your draft from before.')).toBeVisible()
    await expect(engineer.getByLabel('Rounding step')).toHaveValue('5')
    await expect(consent).toBeEnabled()
  })

  await test.step('consent lets the value through to the partner’s open page', async () => {
    await consent.click()
    const said = engineer.getByText('Consent recorded. Values flow.')
    await expect(said).toBeVisible()
    await expect(engineer.getByText('In effect')).toBeVisible()
    // The message is beside the buttons of the bar, not over them.
    const bar = await engineer.getByRole('button', { name: 'Stop disclosing' }).boundingBox()
    const toast = await said.boundingBox()
    expect((toast?.y ?? 0) + (toast?.height ?? 0)).toBeLessThanOrEqual(bar?.y ?? 0)
    const field = partner.locator(`[data-field="${COUNT}"]`)
    await expect(field).toContainText('Mapped', { timeout: 10_000 })
    await expect(field.locator('.figure')).toHaveText(/^[\d,]*[05]$/, { timeout: 10_000 })
    await expect(field).toContainText(/multiples of 5/)
  })

  await test.step('what is refused stays in the factory, with the reason', async () => {
    await engineer.goto(
      `${connector.url.replace(/\/$/, '')}/#/fields/${[network, operation, REQUEST, SECRET].map(encodeURIComponent).join('/')}`,
    )
    await engineer.getByRole('radio', { name: 'Refuse' }).check({ force: true })
    await engineer.getByLabel('Reason').fill('That is our secret.')
    await engineer.getByRole('button', { name: 'Refuse this field' }).click()
    await expect(engineer.getByText('The field is refused.')).toBeVisible()
    const field = partner.locator(`[data-field="${SECRET}"]`)
    await expect(field).toContainText('Refused')
    await expect(field).toContainText('That is our secret.')
  })

  await test.step('everything that left is in the ledger, which verifies', async () => {
    await engineer.goto(`${connector.url.replace(/\/$/, '')}/#/ledger`)
    await expect(engineer.getByRole('row').filter({ hasText: REQUEST }).first()).toBeVisible()
    await engineer.getByRole('button', { name: 'Verify the chain' }).click()
    await expect(engineer.getByText(/^Intact:/)).toBeVisible({ timeout: 30_000 })
  })

  await test.step('a consent can be taken back', async () => {
    await engineer.goto(
      `${connector.url.replace(/\/$/, '')}/#/fields/${[network, operation, REQUEST, COUNT].map(encodeURIComponent).join('/')}`,
    )
    await engineer.getByRole('button', { name: 'Stop disclosing' }).click()
    const dialog = engineer.getByRole('dialog')
    await expect(dialog).toContainText('gets no more values from now on')
    await dialog.getByRole('button', { name: 'Stop disclosing' }).click()
    await expect(engineer.getByText('Nothing leaves.')).toBeVisible()
    await expect(partner.locator(`[data-field="${COUNT}"]`)).toContainText('Pending')
  })

  await test.step('a withdrawn question disappears from the factory', async () => {
    await partner.getByRole('button', { name: `Withdraw this request: ${REQUEST}` }).click()
    await expect(partner.locator(`[data-field="${COUNT}"]`)).toHaveCount(0)
    await engineer.goto(`${connector.url.replace(/\/$/, '')}/#/inbox`)
    await expect(engineer.locator('main h1')).toBeVisible()
    await expect(engineer.locator(`tr[data-field="${COUNT}"]`)).toHaveCount(0)
  })
  await partner.context().close()
  await engineer.context().close()
})

test('both pages work by keyboard alone', async ({ browser }) => {
  const partner = await signedIn(browser, platform, { locale: 'en-GB' })
  await partner.keyboard.press('Tab')
  await expect(partner.getByRole('link', { name: 'Skip to content' })).toBeFocused()
  await partner.keyboard.press('Enter')
  await expect(partner.locator('main h1')).toBeFocused()
  const { items } = await api<{ items: { operationNetworkId: string }[] }>(
    partner.request,
    platform,
    '/operation-networks',
  )
  await partner.goto(
    `${platform.url.replace(/\/$/, '')}/#/networks/${encodeURIComponent(items[0]?.operationNetworkId ?? '')}`,
  )
  const first = partner.locator('[data-operation]').first()
  await first.focus()
  await partner.keyboard.press('ArrowRight')
  await expect(first).not.toBeFocused()
  await partner.keyboard.press('Enter')
  await expect(partner.locator('[data-operation][aria-pressed=true]')).toHaveCount(1)
  await expect(partner.getByRole('button', { name: 'Request data' })).toBeVisible()
  await partner.context().close()

  const engineer = await signedIn(browser, connector, { locale: 'en-GB' })
  await engineer.goto(`${connector.url.replace(/\/$/, '')}/#/sources/${SOURCE}`)
  const tree = engineer.getByRole('tree')
  await tree.getByRole('treeitem').first().focus()
  await engineer.keyboard.press('End')
  await engineer.keyboard.press('Home')
  await expect(tree.getByRole('treeitem').first()).toBeFocused()
  await engineer.context().close()
})

/** The number under the field's name in the message. */
function shownIn(message: string | null): number {
  const value = new RegExp(`"${COUNT}":\\s*(?:\\{[^}]*"Body":\\s*)?"?(\\d+)`).exec(
    message ?? '',
  )?.[1]
  return value === undefined ? Number.NaN : Number(value)
}
