import { expect, test, type BrowserContext, type Page } from '@playwright/test'
import { NetworkPlug } from './network-plug.ts'
import { api, change, connector, signedIn, signIn, type Site } from './world.ts'

/** An operator at a machine, created for this run. */
const operator: Site = {
  app: 'engineer',
  url: connector.url,
  userName: `operator${Date.now()}`,
  password: 'a tablet at the belt',
}

interface Operation {
  operationNetworkId: string
  operationId: string
  name?: string
  standing: { state?: string | null; goodQuantity: number; scrapQuantity: number }
}
interface Entry {
  entryId: string
  action: string
  quantity?: number
  madeBy: string
  madeAt: string
  receivedAt: string
}

const where = ({ operationNetworkId, operationId }: Operation): string =>
  new URLSearchParams({ operationNetworkId, operationId }).toString()

async function operations(page: Page): Promise<Operation[]> {
  const week = new URLSearchParams({
    from: new Date(Date.now() - 86_400_000).toISOString(),
    until: new Date(Date.now() + 7 * 86_400_000).toISOString(),
  })
  return (
    await api<{ items: Operation[] }>(page.request, connector, `/operator/operations?${week}`)
  ).items
}

/** Entries of this operator at the connector, in order of their time. */
async function entries(page: Page, operation: Operation): Promise<Entry[]> {
  const { items } = await api<{ items: Entry[] }>(
    page.request,
    connector,
    `/operator/entries?${where(operation)}`,
  )
  return items
    .filter(({ madeBy }) => madeBy === operator.userName)
    .toSorted((a, b) => a.madeAt.localeCompare(b.madeAt))
}

/** Returns whether the browser has stored the page, so that it opens without a network. */
async function isKept(page: Page): Promise<boolean> {
  return page.evaluate(async () => {
    const script = document.querySelector<HTMLScriptElement>('script[src]')?.src ?? ''
    return (
      navigator.serviceWorker.controller !== null &&
      (await caches.match('/')) !== undefined &&
      (await caches.match(script)) !== undefined
    )
  })
}

/** Pulls the network of a tablet, whose browser notices it, too. */
async function goOffline(plug: NetworkPlug, context: BrowserContext): Promise<void> {
  plug.pull()
  await context.setOffline(true)
}

async function goOnline(plug: NetworkPlug, context: BrowserContext): Promise<void> {
  plug.putBack()
  await context.setOffline(false)
}

test('an operator works on without a network, and everything arrives once', async ({ browser }) => {
  test.setTimeout(180_000)
  const engineer = await signedIn(browser, connector, { locale: 'en-GB' })
  await change(engineer, connector, 'PUT', `/users/${operator.userName}`, {
    role: 'OPERATOR',
    password: operator.password,
  })
  const operation = (await operations(engineer))[0]
  if (operation === undefined) throw new Error('No operation has a field to be filled by hand.')

  // An earlier run may have left it running.
  const isRunning = operation.standing.state === 'Running'
  const context = await browser.newContext({
    locale: 'en-GB',
    viewport: { width: 1180, height: 820 },
  })
  const page = await context.newPage()
  const plug = await NetworkPlug.to(connector.url)
  await signIn(page, { ...operator, url: plug.url })
  const card = page.locator(`[data-operation="${operation.operationId}"]`)
  const waiting = page.locator('[data-waiting]')
  await expect(card).toBeVisible()
  await expect.poll(() => isKept(page), { timeout: 20_000 }).toBe(true)
  const good = card.locator('.figure').first()
  const counted = (pieces: number): string => String(operation.standing.goodQuantity + pieces)
  const one = card.getByRole('button', { name: 'One more good piece' })

  await test.step('what is entered without a network is counted on the page and shown as waiting', async () => {
    await goOffline(plug, context)
    await card.getByRole('button', { name: isRunning ? 'Done' : /^(Start|Resume)$/ }).click()
    for (let piece = 0; piece < 3; piece += 1) await one.click()
    await expect(waiting).toHaveAttribute('data-waiting', '4')
    await expect(waiting).toContainText('4 entries are kept on this device.')
    await expect(card).toContainText('4 entries not sent yet')
    await expect(good).toHaveText(counted(3))
    expect(await entries(engineer, operation), 'nothing has left the tablet').toEqual([])
  })

  await test.step('a restart of the tablet loses nothing', async () => {
    await page.reload()
    await expect(waiting).toHaveAttribute('data-waiting', '4')
    await expect(good).toHaveText(counted(3))
    await one.click()
    await expect(waiting).toContainText('5 entries are kept on this device.')
    await expect(good).toHaveText(counted(4))
    expect(await entries(engineer, operation), 'nothing has left the tablet').toEqual([])
  })

  await test.step('back on the network each arrives once, with the time at which it was entered', async () => {
    // The browser's clock may be some milliseconds ahead of this one.
    await page.waitForTimeout(250)
    const back = new Date().toISOString()
    await goOnline(plug, context)
    await expect(waiting).toHaveAttribute('data-waiting', '0', { timeout: 30_000 })
    await expect(waiting).toContainText('Everything you entered has arrived.')
    await expect(good).toHaveText(counted(4))
    const arrived = await entries(engineer, operation)
    expect(arrived.map(({ action, quantity }) => [action, quantity ?? 0])).toEqual([
      [isRunning ? 'DONE' : 'START', 0],
      ...Array<[string, number]>(4).fill(['ADD', 1]),
    ])
    expect(new Set(arrived.map(({ entryId }) => entryId)).size).toBe(5)
    for (const { madeAt, receivedAt } of arrived)
      expect([
        Date.parse(madeAt) <= Date.parse(back),
        Date.parse(receivedAt) >= Date.parse(back),
      ]).toEqual([true, true])
  })

  await test.step('an answer that is lost on its way makes nothing count twice', async () => {
    let lost = 0
    await context.route('**/api/v1/operator/entries', async (route) => {
      if (lost > 0) return route.fallback()
      lost += 1
      await route.fetch()
      await route.abort('connectionreset')
    })
    await one.click()
    await expect(waiting).toHaveAttribute('data-waiting', '0', { timeout: 30_000 })
    expect(lost, 'the first answer was lost').toBe(1)
    expect(await entries(engineer, operation)).toHaveLength(6)
    await expect(good).toHaveText(counted(5))
    const standing = (await operations(engineer)).find(
      ({ operationId }) => operationId === operation.operationId,
    )?.standing
    expect(standing?.goodQuantity).toBe(operation.standing.goodQuantity + 5)
  })

  await test.step('who has to sign in again meanwhile loses nothing either', async () => {
    await context.unroute('**/api/v1/operator/entries')
    await goOffline(plug, context)
    await one.click()
    await one.click()
    await expect(waiting).toHaveAttribute('data-waiting', '2')
    const password = 'another tablet at the belt'
    await change(engineer, connector, 'PUT', `/users/${operator.userName}`, {
      role: 'OPERATOR',
      password,
    })
    await goOnline(plug, context)
    await expect(page.getByRole('button', { name: 'Sign in' })).toBeVisible({ timeout: 30_000 })
    expect(await entries(engineer, operation), 'the old session delivers nothing').toHaveLength(6)
    await page.getByLabel('User name').fill(operator.userName)
    await page.getByLabel('Password').fill(password)
    await page.getByRole('button', { name: 'Sign in' }).click()
    await expect(waiting).toHaveAttribute('data-waiting', '0', { timeout: 30_000 })
    expect(await entries(engineer, operation)).toHaveLength(8)
    await expect(good).toHaveText(counted(7))
  })

  await change(engineer, connector, 'DELETE', `/users/${operator.userName}`)
  await expect(
    page.getByRole('button', { name: 'Sign in' }),
    'who was removed is signed out',
  ).toBeVisible({ timeout: 30_000 })
  await context.close()
  await plug.close()
  await engineer.context().close()
})
