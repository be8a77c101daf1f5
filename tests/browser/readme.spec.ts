import { readFileSync } from 'node:fs'
import path from 'node:path'
import { expect, test, type Browser, type Page } from '@playwright/test'
import { Counted } from './counted.ts'
import { wayWithoutTheDemo, type Entrance } from './readme.ts'
import { Terminal } from './terminal.ts'

/** What the way may cost at most: with the time of the commands, without that of the build. */
const MINUTES_MAX = 15
const CLICKS_MAX = 50
const TEXTS_MAX = 18
/** Lines that are typed into a terminal: commands of the README, and what they ask for. */
const LINES_MAX = 6

const PARTNER = { id: 'acme', name: 'Acme' }
const MAKER = { id: 'munich', name: 'Munich' }
const FACTORY = { id: 'MUC_1', name: 'Munich works' }
const PLANNER = 'anna'
const QUESTION = 'How much has been made?'

/** Folder in which `target/release` has the programs, and nothing else is. */
const FOLDER = variable('README_FOLDER')
/** URL of the OPC UA server of the plant. */
const MACHINE = variable('MACHINE_URL')

const { blocks, entrances } = wayWithoutTheDemo()
/** Addresses of their own in place of those of the README, which other programs of this machine may have. */
const platformAt = { ...entrances[0], url: `http://127.0.0.1:${variable('PLATFORM_PORT')}` }
const connectorAt = { ...entrances[1], url: `http://127.0.0.1:${variable('CONNECTOR_PORT')}` }
const platformVariables = {
  VERBUND_WEB__LISTEN: new URL(platformAt.url).host,
  VERBUND_BROKER__LISTEN: `127.0.0.1:${variable('BROKER_PORT')}`,
}
const connectorVariables = {
  VERBUND_WEB__LISTEN: new URL(connectorAt.url).host,
  VERBUND_TWIN__LISTEN: `127.0.0.1:${variable('TWIN_PORT')}`,
}

const terminals: Terminal[] = []

function terminal(variables: Record<string, string>): Terminal {
  const opened = new Terminal(FOLDER, variables)
  terminals.push(opened)
  return opened
}

test.afterAll(async () => {
  for (const opened of terminals.toReversed()) await opened.close()
})

test('from the README to the first disclosed value', async ({ browser }) => {
  test.setTimeout(MINUTES_MAX * 60_000)
  const begin = Date.now()
  const person = new Counted()
  const cloud = terminal(platformVariables)
  const plant = terminal(connectorVariables)
  const partner = await pageOf(browser)
  const engineer = await pageOf(browser)

  await test.step('the platform starts, and says what to do first', async () => {
    await type(person, cloud, command('export '))
    person.lines.push(command('platform serve'))
    await cloud.serve(command('platform serve'), platformAt.url)
    await signIn(person, partner, platformAt, passwordOf(platformAt))
  })

  const { line, token } = await test.step('organisations and a factory', () =>
    addFactory(person, partner))
  const password = await test.step('a collaboration, and a planner', () =>
    addCollaboration(person, partner))

  await test.step('the line of the page and its token enrol the connector', async () => {
    expect(line, 'the page shows the line of the README').toBe(command('factory-connector enrol'))
    await type(person, plant, command('export '))
    await type(person, plant, line, token)
    person.lines.push(command('factory-connector run'))
    await plant.serve(command('factory-connector run'), connectorAt.url)
    await signIn(person, engineer, connectorAt, passwordOf(connectorAt))
  })

  await test.step('the machine is found, tested, trusted and connected', () =>
    addSource(person, engineer))
  await test.step('the planner draws a network and asks', () => ask(person, partner, password))
  await test.step('the engineer takes a suggestion and consents', () => decide(person, engineer))
  await test.step('the value is on the partner’s page', async () => {
    const figure = partner.locator('[data-field="producedQuantity"] .figure').first()
    await expect(figure).toHaveText(/^[\d,]+$/, { timeout: 10_000 })
  })

  const minutes = (Date.now() - begin) / 60_000
  console.info(
    `from the README to the first value: ${person.clicks.length} clicks, ${person.texts.length} texts, ` +
      `${person.lines.length} lines at terminals, ${minutes.toFixed(1)} min`,
  )
  console.info(`clicks: ${person.clicks.join(', ')}\ntexts: ${person.texts.join(', ')}`)
  expect(minutes).toBeLessThan(MINUTES_MAX)
  expect(person.clicks.length).toBeLessThanOrEqual(CLICKS_MAX)
  expect(person.texts.length).toBeLessThanOrEqual(TEXTS_MAX)
  expect(person.lines.length).toBeLessThanOrEqual(LINES_MAX)
})

test('the commands of the README administer a platform that is stopped', async () => {
  const byCommand = terminal(platformVariables)
  await byCommand.run(command('export '))
  await byCommand.run('mkdir by-command && cd by-command')
  const block = blocks.find(([first]) => first?.startsWith('platform organisation'))
  let printed = ''
  for (const line of block ?? [])
    printed = await byCommand.run(
      line,
      line.startsWith('platform person set') ? ['correct horse battery staple'] : [],
    )
  expect(printed).toMatch(/frames.*acme.*munich.*MUC_1/)
})

function variable(name: string): string {
  const value = process.env[name]
  if (value === undefined)
    throw new Error(`Set ${name}: the README is followed in a world of its own.`)
  return value
}

/** Returns the command of the README that begins so. */
function command(beginning: string): string {
  const found = blocks.flat().find((line) => line.startsWith(beginning))
  if (found === undefined)
    throw new Error(`The README has no command that begins with ${beginning}.`)
  return found
}

/** Types a line and what it asks for. */
async function type(
  person: Counted,
  into: Terminal,
  line: string,
  ...answers: string[]
): Promise<void> {
  person.lines.push(line, ...answers)
  await into.run(line, answers)
}

function passwordOf({ passwordFile }: Entrance): string {
  return readFileSync(path.join(FOLDER, passwordFile), 'utf8').trim()
}

async function pageOf(browser: Browser): Promise<Page> {
  const context = await browser.newContext({
    locale: 'en-GB',
    permissions: ['clipboard-read', 'clipboard-write'],
  })
  return context.newPage()
}

async function signIn(
  person: Counted,
  page: Page,
  at: Pick<Entrance, 'url' | 'userName'>,
  password: string,
): Promise<void> {
  await page.goto(at.url)
  await person.type('user name', page.getByLabel('User name'), at.userName)
  await person.type('password', page.getByLabel('Password'), password)
  await person.click('sign in', page.getByRole('button', { name: 'Sign in' }))
  await expect(page.getByRole('heading', { name: 'First steps' })).toBeVisible()
}

/** Copies what a page shows under a label, and returns what the clipboard then has. */
async function copy(person: Counted, page: Page, label: string): Promise<string> {
  const shown = page.locator(`code[aria-label="${label}"]`)
  await person.click(`copy ${label}`, shown.locator('..').getByRole('button', { name: 'Copy' }))
  await expect(shown.locator('..').getByRole('button', { name: 'Copied' })).toBeVisible()
  return page.evaluate(() => navigator.clipboard.readText())
}

/** Goes on to another part of the administration. */
async function section(person: Counted, page: Page, name: string): Promise<void> {
  const parts = page.getByRole('navigation', { name: 'Parts of the administration' })
  await person.click(name, parts.getByRole('link', { name }))
}

/** Adds both organisations and the factory; returns what to type there. */
async function addFactory(person: Counted, page: Page): Promise<{ line: string; token: string }> {
  const dialog = page.getByRole('dialog')
  const add = dialog.getByRole('button', { name: 'Add', exact: true })
  await person.click('first step', page.getByRole('link', { name: 'Organisations', exact: true }))
  for (const { id, name } of [PARTNER, MAKER]) {
    await person.click('add', page.getByRole('button', { name: 'Add an organisation' }))
    await person.type('id', dialog.getByLabel('Id', { exact: true }), id)
    await person.type('name', dialog.getByLabel('Name', { exact: true }), name)
    await person.click('save', add)
    await expect(dialog).toBeHidden()
  }
  await section(person, page, 'Factories')
  await person.click('add', page.getByRole('button', { name: 'Add a factory' }))
  await person.type('id', dialog.getByLabel('Id', { exact: true }), FACTORY.id)
  await person.type('name', dialog.getByLabel('Name', { exact: true }), FACTORY.name)
  await person.choose('organisation', dialog.getByLabel('Organisation'), MAKER.id)
  await person.click('save', add)
  // Without its token a factory is of no use: the page goes on to it.
  await expect(dialog.getByRole('heading', { name: 'Enrolment token' })).toBeVisible()
  const line = await copy(person, page, 'At the factory; it asks for the token')
  const token = await copy(person, page, 'Enrolment token')
  await person.click('close', dialog.getByRole('button', { name: 'Close' }).last())
  return { line, token }
}

/** Adds a collaboration of all, and a planner of the partner; returns the password that was made. */
async function addCollaboration(person: Counted, page: Page): Promise<string> {
  const dialog = page.getByRole('dialog')
  await section(person, page, 'Collaborations')
  await person.click('add', page.getByRole('button', { name: 'Add a collaboration' }))
  await person.type('id', dialog.getByLabel('Id', { exact: true }), 'frames')
  for (const { id } of [PARTNER, MAKER, FACTORY])
    await person.click(id, dialog.locator(`input[type=checkbox][value="${id}"]`))
  await person.click('save', dialog.getByRole('button', { name: 'Add', exact: true }))
  await expect(dialog).toBeHidden()
  await section(person, page, 'People')
  await person.click('add', page.getByRole('button', { name: 'Add a person' }))
  await person.type('user name', dialog.getByLabel('User name'), PLANNER)
  await person.choose('organisation', dialog.getByLabel('Organisation'), PARTNER.id)
  await person.click('save', dialog.getByRole('button', { name: 'Save' }))
  const password = await copy(person, page, 'Password')
  await person.click('I have it', dialog.getByRole('button', { name: 'I have it' }))
  await person.click('sign out', page.getByRole('button', { name: 'Sign out' }))
  return password
}

/** Asks the server what it offers, tests, trusts and saves it, and waits for the connection. */
async function addSource(person: Counted, page: Page): Promise<void> {
  const dialog = page.getByRole('dialog')
  await person.click('second step', page.getByRole('link', { name: 'Add a source' }))
  await person.type('address', dialog.getByLabel('Address'), MACHINE)
  await person.click('ask', dialog.getByRole('button', { name: 'Ask the server' }))
  await expect(dialog.getByRole('region', { name: 'What the server offers' })).toBeVisible()
  await person.click('test', dialog.getByRole('button', { name: 'Test' }))
  await expect(
    dialog.locator('strong', { hasText: 'certificate is not trusted yet' }),
  ).toBeVisible()
  await person.click('trust', dialog.getByRole('button', { name: 'Trust' }))
  await person.click('test', dialog.getByRole('button', { name: 'Test' }))
  await expect(dialog.getByText('The connector comes in.')).toBeVisible()
  await person.click('save', dialog.getByRole('button', { name: 'Save' }))
  await expect(page.getByRole('row').filter({ hasText: MACHINE })).toContainText('Connected', {
    timeout: 30_000,
  })
}

/** Draws a network of the example in the form, and asks about its only operation. */
async function ask(person: Counted, page: Page, password: string): Promise<void> {
  const dialog = page.getByRole('dialog')
  await signIn(person, page, { url: platformAt.url, userName: PLANNER }, password)
  await person.click('first step', page.getByRole('link', { name: 'Add an operation network' }))
  await person.click('example', dialog.getByRole('button', { name: 'Begin with an example' }))
  await person.click('send', dialog.getByRole('button', { name: 'Add an operation network' }))
  await expect(dialog).toBeHidden()
  await person.click('next step', page.getByRole('link', { name: 'Open the network' }))
  await person.click('operation', page.locator('[data-operation]').first())
  await person.click('ask', page.getByRole('button', { name: 'Request data' }))
  const question = dialog.getByRole('checkbox', { name: QUESTION })
  if (!(await question.isChecked())) await person.click('question', question)
  await person.type('purpose', dialog.getByLabel('What for'), 'Plan the final assembly')
  await person.click('send', dialog.getByRole('button', { name: 'Send the request' }))
  await expect(dialog).toBeHidden()
}

/** Takes what is suggested for the field, and lets it leave. */
async function decide(person: Counted, page: Page): Promise<void> {
  await person.click('start', page.getByRole('navigation').getByRole('link', { name: 'Overview' }))
  await person.click('last step', page.getByRole('link', { name: 'Decide', exact: true }).first())
  const suggestion = page.locator('[data-suggestion]').first()
  await person.click('suggestion', suggestion.getByRole('button', { name: /^Take it/ }))
  await person.click('consent', page.getByRole('button', { name: 'Consent', exact: true }))
  await expect(page.getByText('Consent recorded. Values flow.')).toBeVisible()
}
