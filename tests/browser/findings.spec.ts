import { expect, test, type Browser, type Locator, type Page } from '@playwright/test'
import { api, change, connector, platform, signedIn, signIn, type Site } from './world.ts'

/**
 * What people met in their first week, each on the page that has to be otherwise. docs/promises.md lists all of it, with the
 * tests elsewhere. It happens in a network of its own, which is withdrawn at the end.
 */
const RUN = Date.now()
const NETWORK = `Findings${RUN}`
const LATE = 'Late'
const HOUR_MS = 3_600_000
const ENGLISH = { locale: 'en-GB' }

const at = (site: Site, ...parts: string[]): string =>
  `${site.url.replace(/\/$/, '')}/#/${parts.map(encodeURIComponent).join('/')}`
const inHours = (hours: number): string =>
  new Date(RUN + hours * HOUR_MS).toISOString().replace(/\.\d+/, '')
const field = (name: string, type: number, semantic?: string): object => ({
  name,
  type,
  ...(semantic ? { semantic } : {}),
})

/** Both people, signed in. */
async function people(browser: Browser): Promise<{ partner: Page; engineer: Page }> {
  return {
    partner: await signedIn(browser, platform, ENGLISH),
    engineer: await signedIn(browser, connector, ENGLISH),
  }
}

/** Card of the request in the inbox. */
const cardOf = (page: Page): Locator =>
  page.getByRole('region').filter({ hasText: `${NETWORK} / Asked` })

test.beforeAll(async ({ browser }) => {
  const { partner, engineer } = await people(browser)
  const { factoryId } = await api<{ factoryId: string }>(engineer.request, connector, '/status')
  const known = await api<{ items: { collaborationId: string; withdrawnAt?: string | null }[] }>(
    partner.request,
    platform,
    '/operation-networks',
  )
  const collaborationId = known.items.find(
    ({ withdrawnAt }) => withdrawnAt == null,
  )?.collaborationId
  const session = await api<{ organisationId: string }>(partner.request, platform, '/session')
  const request = {
    dynamicDataRequestId: 'Asked',
    dynamicDataRequestPublisherId: 'Planning',
    requesterId: session.organisationId,
    recipientList: [session.organisationId],
    purpose: 'See what people see',
    reportDataFormat: {
      reportName: 'Findings',
      reportFieldList: [
        field('state', 12, 'OPERATION_STATE'),
        field('made', 9, 'PRODUCED_QUANTITY'),
        field('checkedAt', 13),
      ],
    },
  }
  const operation = (operationId: string, from: number, until: number): object => ({
    operationId,
    name: operationId,
    operationType: 'PRODUCTION',
    owningFactoryId: factoryId,
    productId: 'P',
    plannedQuantity: 12,
    quantityUnit: 'PIECE',
    plannedStart: inHours(from),
    plannedEnd: inHours(until),
  })
  await change(partner, platform, 'PUT', `/operation-networks/${NETWORK}`, {
    collaborationId,
    operationNetwork: {
      operationNetworkId: NETWORK,
      name: NETWORK,
      operationList: [
        { ...operation(LATE, -10, -2), dynamicDataRequestList: [request] },
        operation('Next', -1, 5),
      ],
      operationRelationList: [
        {
          operationRelationId: 'Then',
          relationType: 'FINISH_TO_START',
          predecessorOperationId: LATE,
          successorOperationId: 'Next',
        },
      ],
    },
  })
  for (const page of [partner, engineer]) await page.context().close()
})

test.afterAll(async ({ browser }) => {
  const partner = await signedIn(browser, platform, ENGLISH)
  await change(partner, platform, 'DELETE', `/operation-networks/${NETWORK}`)
  await partner.context().close()
})

test('a buyer sees what is late by the plan, and what that holds up', async ({ browser }) => {
  const { partner } = await people(browser)
  await partner.goto(at(platform, 'networks', NETWORK, LATE))
  const graph = partner.locator('[data-operation]')
  await expect(graph.filter({ hasText: LATE })).toContainText(/overdue/)
  await expect(graph.filter({ hasText: 'Next' })).toContainText('Held up')
  await expect(partner.getByText(/It should have ended .* ago by the plan/)).toBeVisible()
  await expect(partner.getByText('Holds up: Next.')).toBeVisible()
  await partner.context().close()
})

test('a comment of the factory is read on the partner’s page', async ({ browser }) => {
  const { partner, engineer } = await people(browser)
  const card = cardOf(engineer)
  await engineer.goto(at(connector, 'inbox'))
  await card.getByRole('button', { name: 'Comments' }).first().click()
  await engineer.getByRole('dialog').getByRole('textbox').fill('The spindle is being changed.')
  await engineer.getByRole('dialog').getByRole('button', { name: 'Send' }).click()
  await partner.goto(at(platform, 'networks', NETWORK, LATE))
  await partner.getByRole('button', { name: /^Comments: Asked/ }).click()
  await expect(partner.getByRole('dialog')).toContainText('The spindle is being changed.')
  for (const page of [partner, engineer]) await page.context().close()
})

test('times and states by hand are chosen, not typed as codes', async ({ browser }) => {
  const { engineer } = await people(browser)
  for (const [name, input] of [
    ['checkedAt', 'input[type="datetime-local"]'],
    ['state', 'select'],
  ] as const) {
    await engineer.goto(at(connector, 'fields', NETWORK, LATE, 'Asked', name))
    await engineer.getByRole('radio', { name: 'Manual entry' }).check({ force: true })
    const consent = engineer.getByRole('button', { name: 'Consent', exact: true })
    await consent.click()
    await expect(engineer.getByText('Consent recorded. Values flow.').last()).toBeVisible()
    await expect(engineer.locator(`main form ${input}`).first()).toBeEnabled()
  }
  await engineer.context().close()
})

test('more than was planned is said to be', async ({ browser }) => {
  const { partner, engineer } = await people(browser)
  await engineer.goto(at(connector, 'fields', NETWORK, LATE, 'Asked', 'made'))
  await engineer.getByRole('radio', { name: 'Manual entry' }).check({ force: true })
  await engineer.getByRole('button', { name: 'Consent', exact: true }).click()
  await engineer.locator('main form input').first().fill('13')
  await engineer.getByRole('button', { name: 'Enter value' }).click()
  await partner.goto(at(platform, 'networks', NETWORK, LATE))
  await expect(partner.getByText('13 of 12').last()).toBeVisible()
  await expect(partner.getByText('More than planned')).toBeVisible()
  for (const page of [partner, engineer]) await page.context().close()
})

test('a problem that an operator reports is an interruption for the partner', async ({
  browser,
}) => {
  const { partner, engineer } = await people(browser)
  await engineer.goto(at(connector, 'operator'))
  const card = engineer.locator(`[data-operation="${LATE}"]`)
  await card.getByRole('button', { name: 'Start' }).click()
  await card.getByRole('button', { name: 'Problem' }).click()
  await engineer.getByRole('dialog').getByRole('button', { name: 'Machine stopped' }).click()
  await partner.goto(at(platform, 'networks', NETWORK, LATE))
  await expect(partner.locator('[data-operation]').filter({ hasText: LATE })).toContainText(
    'Interrupted',
  )
  for (const page of [partner, engineer]) await page.context().close()
})

test('a consent that another one overtook says so', async ({ browser }) => {
  const first = await signedIn(browser, connector, ENGLISH)
  const second = await signedIn(browser, connector, ENGLISH)
  for (const page of [first, second]) {
    await page.goto(at(connector, 'fields', NETWORK, LATE, 'Asked', 'checkedAt'))
    await expect(page.getByLabel('Minimum interval').first()).toBeVisible()
  }
  await first.getByLabel('Minimum interval').first().fill('7')
  await second.getByLabel('Minimum interval').first().fill('9')
  const consent = { name: 'Consent to the change' }
  await second.getByRole('button', consent).click()
  await expect(second.getByText('Consent recorded. Values flow.')).toBeVisible()
  await expect(first.getByText('The field has changed since you began')).toBeVisible()
  await expect(first.getByRole('button', consent)).toBeDisabled()
  for (const page of [first, second]) {
    page.on('dialog', (dialog) => void dialog.accept())
    await page.context().close()
  }
})

test('a revocation has a receipt, and its reason reaches the partner', async ({ browser }) => {
  const { partner, engineer } = await people(browser)
  await engineer.goto(at(connector, 'inbox'))
  const card = cardOf(engineer)
  await card.getByRole('button', { name: 'Revoke' }).first().click()
  const dialog = engineer.getByRole('dialog')
  await dialog.getByLabel('Reason').fill('The order is closed.')
  await dialog.getByRole('button', { name: 'Revoke now' }).click()
  await expect(dialog.getByRole('heading', { name: 'Receipt' })).toBeVisible()
  await partner.goto(at(platform, 'networks', NETWORK, LATE))
  const shown = partner.locator('[data-field="state"]')
  await expect(shown).toContainText(/The factory took its consent back on .*The order is closed\./s)
  for (const page of [partner, engineer]) await page.context().close()
})

test('what is typed into a source outlasts what the source reports meanwhile', async ({
  browser,
}) => {
  const { engineer } = await people(browser)
  await engineer.goto(at(connector, 'sources', process.env['STORY_SOURCE'] ?? 'MillingCell1'))
  await engineer.getByRole('button', { name: 'Edit' }).click()
  const name = engineer.getByRole('dialog').getByLabel('Name', { exact: true })
  const before = await name.inputValue()
  await name.fill('Typed slowly')
  // The page asks for its sources every ten seconds.
  await engineer.waitForResponse((answer) => answer.url().endsWith('/api/v1/sources'), {
    timeout: 30_000,
  })
  await engineer.waitForResponse((answer) => answer.url().endsWith('/api/v1/sources'), {
    timeout: 30_000,
  })
  await expect(name).toHaveValue('Typed slowly')
  await engineer.getByRole('dialog').getByRole('button', { name: 'Cancel' }).click()
  expect(before).not.toBe('Typed slowly')
  await engineer.context().close()
})

test('a source is removed after a question that names what gets no values', async ({ browser }) => {
  const { engineer } = await people(browser)
  await engineer.goto(at(connector, 'sources', process.env['STORY_SOURCE'] ?? 'MillingCell1'))
  await engineer.getByRole('button', { name: 'Remove the source' }).click()
  const dialog = engineer.getByRole('dialog')
  await expect(dialog.getByRole('listitem').first()).toBeVisible()
  await dialog.getByRole('button', { name: 'Cancel' }).click()
  await expect(engineer.getByRole('button', { name: 'Remove the source' })).toBeVisible()
  await engineer.context().close()
})

test('a new person does not take the place of one of the same name, which is said in the language of the page', async ({
  browser,
}) => {
  const engineer = await signedIn(browser, connector, { locale: 'de-DE' })
  await engineer.goto(at(connector, 'users'))
  await engineer.getByRole('button', { name: 'Person hinzufügen' }).click()
  const dialog = engineer.getByRole('dialog')
  await dialog.getByLabel('Benutzername').fill(connector.userName)
  await dialog.getByLabel('Passwort').fill('another password')
  await dialog.getByRole('button', { name: 'Speichern' }).click()
  await expect(dialog.getByRole('alert')).toContainText(/gibt es schon|bereits|schon da/)
  await expect(dialog.getByLabel('Benutzername')).toHaveValue(connector.userName)
  await engineer.context().close()
})

test('a buyer asks by meaning, and type and unit follow', async ({ browser }) => {
  const { partner } = await people(browser)
  await partner.goto(at(platform, 'networks', NETWORK, 'Next'))
  await partner.getByRole('button', { name: 'Request data' }).click()
  const dialog = partner.getByRole('dialog')
  await dialog.getByRole('checkbox', { name: 'When will it be ready?' }).check()
  await dialog.getByText('Technical details').click()
  const types = dialog.getByLabel(/^Type \d/)
  await expect(types.last()).toHaveValue('DateTime')
  await expect(dialog.getByLabel(/^Unit \d/).last()).toHaveValue('')
  await dialog.getByRole('button', { name: 'Cancel' }).click()
  await partner.context().close()
})

test('a viewer is offered nothing that is refused', async ({ browser }) => {
  const { partner } = await people(browser)
  const { organisationId } = await api<{ organisationId: string }>(
    partner.request,
    platform,
    '/session',
  )
  const viewer = { ...platform, userName: `viewer${RUN}`, password: 'only looks at pages' }
  await change(partner, platform, 'PUT', `/users/${viewer.userName}`, {
    role: 'VIEWER',
    organisationId,
    password: viewer.password,
  })
  const context = await browser.newContext(ENGLISH)
  const page = await context.newPage()
  const refused: string[] = []
  page.on('response', (answer) => {
    if (answer.status() === 403 || answer.status() === 404) refused.push(answer.url())
  })
  await signIn(page, viewer)
  const { items } = await api<{ items: { factoryId: string }[] }>(
    page.request,
    platform,
    '/factories',
  )
  for (const parts of [
    [],
    ['networks', NETWORK, LATE],
    ['factories'],
    ['factories', items[0]?.factoryId ?? ''],
  ]) {
    await page.goto(at(platform, ...parts))
    await expect(page.locator('main h1')).toBeVisible()
    await expect(page.locator('main .loading')).toHaveCount(0)
    await expect(
      page.getByRole('button', { name: /^(Withdraw|Request data|Add|Create an|Revoke|Remove)/ }),
    ).toHaveCount(0)
  }
  expect(refused).toEqual([])
  await context.close()
  await change(partner, platform, 'DELETE', `/users/${viewer.userName}`)
  await partner.context().close()
})
