import {
  expect,
  type APIRequestContext,
  type Browser,
  type BrowserContext,
  type BrowserContextOptions,
  type Page,
} from '@playwright/test'

/** Daemon with its page and a user who can sign in. */
export interface Site {
  app: 'engineer' | 'partner'
  url: string
  userName: string
  password: string
}

function variable(name: string, otherwise?: string): string {
  const value = process.env[name] ?? otherwise
  if (value === undefined)
    throw new Error(`Set ${name}: the browser tests drive daemons that run already.`)
  return value
}

/** The factory connector. */
export const connector: Site = {
  app: 'engineer',
  url: variable('CONNECTOR_URL'),
  userName: variable('CONNECTOR_USER', 'engineer'),
  password: variable('CONNECTOR_PASSWORD'),
}

/** The platform. */
export const platform: Site = {
  app: 'partner',
  url: variable('PLATFORM_URL'),
  userName: variable('PLATFORM_USER', 'admin'),
  password: variable('PLATFORM_PASSWORD'),
}

/** Signs in through the form and waits for the page behind it. */
export async function signIn(page: Page, site: Site): Promise<void> {
  await page.goto(site.url)
  await page.getByLabel(/user name|benutzername/i).fill(site.userName)
  await page.getByLabel(/password|passwort/i).fill(site.password)
  await page.getByRole('button', { name: /sign in|anmelden/i }).click()
  await expect(page.getByRole('navigation')).toBeVisible()
}

const sessions = new Map<string, Awaited<ReturnType<BrowserContext['storageState']>>>()

/**
 * Opens a page that is signed in. Each site is signed in to once, as sign-in attempts are
 * throttled.
 */
export async function signedIn(
  browser: Browser,
  site: Site,
  options: BrowserContextOptions = {},
): Promise<Page> {
  const known = sessions.get(site.url)
  const context = await browser.newContext({
    ...options,
    ...(known === undefined ? {} : { storageState: known }),
  })
  const page = await context.newPage()
  if (known === undefined) {
    await signIn(page, site)
    sessions.set(site.url, await context.storageState())
  } else {
    await page.goto(site.url)
    await expect(page.getByRole('navigation')).toBeVisible()
  }
  return page
}

/** Answer of the API to the session of the page. */
export async function api<T>(request: APIRequestContext, site: Site, path: string): Promise<T> {
  const response = await request.get(`${site.url.replace(/\/$/, '')}/api/v1${path}`)
  expect(response.ok(), `GET ${path} gave ${response.status()}`).toBe(true)
  return (await response.json()) as T
}

/** Changes something through the API with the page's own session. */
export async function change(
  page: Page,
  site: Site,
  method: 'POST' | 'PUT' | 'DELETE',
  path: string,
  data?: unknown,
): Promise<void> {
  const { csrfToken } = await api<{ csrfToken: string }>(page.request, site, '/session')
  const response = await page.request.fetch(`${site.url.replace(/\/$/, '')}/api/v1${path}`, {
    method,
    headers: { 'x-csrf-token': csrfToken },
    ...(data === undefined ? {} : { data }),
  })
  expect(
    response.ok(),
    `${method} ${path} gave ${response.status()}: ${await response.text()}`,
  ).toBe(true)
}

interface Items<T> {
  items: T[]
}

/** Page of an app, with the steps that show all of it. */
export interface Place {
  name: string
  hash: string
  act?: (page: Page) => Promise<void>
}

/** Every place in an app that has a page of its own, with real ids in it. */
export async function places(page: Page, site: Site): Promise<Place[]> {
  const hash = (...parts: string[]): string => `#/${parts.map(encodeURIComponent).join('/')}`
  if (site.app === 'partner') {
    const networks = await api<Items<{ operationNetworkId: string }>>(
      page.request,
      site,
      '/operation-networks',
    )
    const factories = await api<Items<{ factoryId: string }>>(page.request, site, '/factories')
    const network = networks.items[0]?.operationNetworkId
    const factory = factories.items[0]?.factoryId
    const view =
      network === undefined
        ? undefined
        : await api<{ fields: { key: { operationId: string } }[] }>(
            page.request,
            site,
            `/operation-networks/${encodeURIComponent(network)}`,
          )
    const operation = view?.fields[0]?.key.operationId
    return [
      { name: 'networks', hash: '#/' },
      ...(network === undefined ? [] : [{ name: 'network', hash: hash('networks', network) }]),
      ...(network === undefined || operation === undefined
        ? []
        : [{ name: 'operation', hash: hash('networks', network, operation) }]),
      { name: 'factories', hash: '#/factories' },
      ...(factory === undefined
        ? []
        : [
            { name: 'factory', hash: hash('factories', factory) },
            {
              name: 'enrolment',
              hash: hash('factories', factory),
              act: (shown: Page) =>
                press(shown, /^(create an enrolment token|aufnahmeschlüssel erstellen)$/i),
            },
            {
              name: 'credential-revocation',
              hash: hash('factories', factory),
              act: (shown: Page) =>
                press(shown, /^(revoke the credentials|zugangsdaten widerrufen)$/i),
            },
          ]),
      { name: 'live', hash: '#/live' },
      ...['organisations', 'people', 'factories', 'collaborations', 'tools'].map((section) => ({
        name: `administration-${section}`,
        hash: hash('administration', section),
      })),
      {
        name: 'new-person',
        hash: hash('administration', 'people'),
        act: (shown: Page) => press(shown, /^(add a person|person hinzufügen)$/i),
      },
      { name: 'settings', hash: '#/settings' },
      { name: 'audit', hash: hash('settings', 'audit') },
      { name: 'dead-letters', hash: hash('settings', 'dead-letters') },
    ]
  }
  interface Field {
    key: {
      operationNetworkId: string
      operationId: string
      dynamicDataRequestId: string
      fieldName: string
    }
    mappingState: string
    valueSource?: string | null
  }
  const inbox = await api<Items<{ fields: Field[] }>>(page.request, site, '/inbox')
  const sources = await api<Items<{ sourceId: string }>>(page.request, site, '/sources')
  const fields = inbox.items.flatMap((request) => request.fields)
  const at = (name: string, field: Field | undefined): Place[] =>
    field === undefined
      ? []
      : [
          {
            name,
            hash: hash(
              'fields',
              field.key.operationNetworkId,
              field.key.operationId,
              field.key.dynamicDataRequestId,
              field.key.fieldName,
            ),
          },
        ]
  const source = sources.items[0]?.sourceId
  return [
    { name: 'overview', hash: '#/' },
    { name: 'inbox', hash: '#/inbox' },
    ...(inbox.items.some(
      (request) => request.fields.filter((field) => field.mappingState === 'PENDING').length > 1,
    )
      ? [
          {
            name: 'refusal',
            hash: '#/inbox',
            act: (shown: Page) => press(shown, /^(refuse open fields|offene felder ablehnen)$/i),
          },
        ]
      : []),
    {
      name: 'comments',
      hash: '#/inbox',
      act: (shown) => press(shown, /^(comments|kommentare|new comment|neuer kommentar)$/i),
    },
    { name: 'revocation', hash: '#/inbox', act: (shown) => press(shown, /^(revoke|widerrufen)$/i) },
    ...at(
      'field-mapped',
      fields.find((field) => field.mappingState === 'MAPPED' && field.valueSource === 'MAPPING'),
    ),
    ...at(
      'versions',
      fields.find((field) => field.mappingState === 'MAPPED' && field.valueSource === 'MAPPING'),
    ).map((place) => ({
      ...place,
      act: (shown: Page) => press(shown, /^(versions|versionen)$/i),
    })),
    ...at(
      'field-pending',
      fields.find((field) => field.mappingState === 'PENDING'),
    ),
    ...at(
      'field-manual',
      fields.find((field) => field.valueSource === 'MANUAL'),
    ),
    ...at(
      'field-external',
      fields.find((field) => field.valueSource === 'EXTERNAL'),
    ),
    { name: 'sources', hash: '#/sources' },
    { name: 'operator', hash: '#/operator' },
    {
      name: 'operator-quantity',
      hash: '#/operator',
      act: (shown) => press(shown, /^(more|mehrere)$/i),
    },
    {
      name: 'operator-problem',
      hash: '#/operator',
      act: (shown) => press(shown, /^(problem|störung)$/i),
    },
    { name: 'policies', hash: '#/policies' },
    {
      name: 'rule',
      hash: '#/policies',
      act: (shown) => press(shown, /^(add a rule|regel hinzufügen)$/i),
    },
    {
      name: 'policy',
      hash: '#/policies',
      act: (shown) => press(shown, /^(add a policy|freigabe hinzufügen)$/i),
    },
    { name: 'leaks', hash: '#/leaks' },
    {
      name: 'cap',
      hash: '#/leaks',
      act: (shown) => press(shown, /^(add a cap|obergrenze hinzufügen)$/i),
    },
    {
      name: 'alliance',
      hash: '#/leaks',
      act: (shown) => press(shown, /^(add an alliance|bündnis hinzufügen)$/i),
    },
    { name: 'mappings', hash: '#/mappings' },
    ...(source === undefined ? [] : [{ name: 'source', hash: hash('sources', source) }]),
    {
      name: 'certificate',
      hash: '#/sources',
      act: (shown) => press(shown, /^(add a certificate|zertifikat hinzufügen)$/i),
    },
    {
      name: 'certificate-request',
      hash: '#/sources',
      act: (shown) => press(shown, /^(request a certificate|zertifikat beantragen)$/i),
    },
    {
      name: 'certificate-installation',
      hash: '#/sources',
      act: (shown) =>
        press(shown, /^(install an issued certificate|ausgestelltes zertifikat installieren)$/i),
    },
    { name: 'ledger', hash: '#/ledger' },
    { name: 'ledger-filtered', hash: '#/ledger', act: filterAndVerify },
    { name: 'users', hash: '#/users' },
    {
      name: 'user',
      hash: '#/users',
      act: (shown) => press(shown, /^(add a person|person hinzufügen)$/i),
    },
    { name: 'link', hash: '#/link' },
    { name: 'settings', hash: '#/settings' },
  ]
}

/** Opens a page and waits until its data is loaded. */
export async function visit(page: Page, site: Site, hash: string): Promise<void> {
  await page.goto(`${site.url.replace(/\/$/, '')}/${hash}`)
  await expect(page.locator('main h1')).toBeVisible()
  await expect(page.locator('main .loading')).toHaveCount(0)
}

/** Opens a page again, also at the same address as before, and performs its steps. */
export async function enter(page: Page, site: Site, { hash, act }: Place): Promise<void> {
  if (act !== undefined) await page.goto('about:blank')
  await visit(page, site, hash)
  await act?.(page)
}

async function press(page: Page, name: RegExp): Promise<void> {
  await page.getByRole('button', { name }).first().click()
  await expect(page.getByRole('dialog')).toBeVisible()
}

/** The ledger of the last days, verified. */
async function filterAndVerify(page: Page): Promise<void> {
  const lately = new Date(Date.now() - 7 * 24 * 3_600_000).toISOString().slice(0, 16)
  await page.getByLabel(/^(from|von)$/i).fill(lately)
  await page.getByRole('button', { name: /^(verify the chain|kette prüfen)$/i }).click()
  await expect(
    page.getByRole('region', { name: /^(result of the verification|ergebnis der prüfung)$/i }),
  ).toBeVisible({ timeout: 30_000 })
}
