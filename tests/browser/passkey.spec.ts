import { expect, test } from '@playwright/test'
import { change, connector, signedIn, signIn, type Site } from './world.ts'

/** A person with a passkey, created for this run. Passkeys need a domain, so no address. */
const person: Site = {
  app: 'engineer',
  url: connector.url.replace('127.0.0.1', 'localhost'),
  userName: `keyholder${Date.now()}`,
  password: 'a key on the ring',
}
const user = `/users/${person.userName}`

test.beforeAll(async ({ browser }) => {
  const page = await signedIn(browser, connector)
  const { password } = person
  await change(page, connector, 'PUT', user, { role: 'VIEWER', password })
})
test.afterAll(async ({ browser }) => {
  const page = await signedIn(browser, connector)
  await change(page, connector, 'DELETE', user)
})

test('a passkey is added, asked for when signing in, and removed', async ({ browser }) => {
  const context = await browser.newContext({ locale: 'en-GB' })
  const page = await context.newPage()
  const authenticator = await context.newCDPSession(page)
  await authenticator.send('WebAuthn.enable')
  await authenticator.send('WebAuthn.addVirtualAuthenticator', {
    options: {
      protocol: 'ctap2',
      transport: 'internal',
      hasResidentKey: true,
      hasUserVerification: true,
      isUserVerified: true,
    },
  })

  await signIn(page, person)
  await page.goto(`${person.url}/#/settings`)
  await page.getByRole('button', { name: 'Add a passkey' }).click()
  const adding = page.getByRole('dialog')
  await adding.getByLabel('Name').fill('This machine')
  await adding.getByLabel('Present password').fill(person.password)
  await adding.getByRole('button', { name: 'Next' }).click()
  await adding.getByRole('button', { name: 'I have kept them' }).click()
  await expect(page.getByText('10 recovery codes are left')).toBeVisible()

  await context.clearCookies()
  await page.goto(person.url)
  await page.getByLabel('User name').fill(person.userName)
  await page.getByLabel('Password').fill(person.password)
  await page.getByRole('button', { name: 'Sign in' }).click()
  await page.getByRole('button', { name: 'Use a passkey' }).click()
  await expect(page.getByRole('navigation')).toBeVisible()

  await page.goto(`${person.url}/#/settings`)
  await expect(page.getByRole('row', { name: /This machine/ })).not.toContainText('not yet')
  await page.getByRole('button', { name: 'Remove: This machine' }).click()
  const removing = page.getByRole('dialog')
  await removing.getByLabel('Present password').fill(person.password)
  await removing.getByRole('button', { name: 'Remove' }).click()
  await expect(page.getByText('There are no passkeys.')).toBeVisible()
  await context.close()
})
