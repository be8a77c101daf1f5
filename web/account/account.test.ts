import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { de } from '@/language/de'
import { language } from '@/language/language.svelte'
import { problem, serve, type Asked } from '../vitest.server'
import type { PasskeySummary, SessionSummary } from './account-api'
import AccountPanels from './AccountPanels.svelte'
import { browserOf } from './browser'

const FIREFOX = 'Mozilla/5.0 (X11; Linux x86_64; rv:140.0) Gecko/20100101 Firefox/140.0'
const session = (sessionId: string, isPresent: boolean): SessionSummary => ({
  sessionId,
  isPresent,
  address: isPresent ? '192.0.2.1' : '192.0.2.2',
  userAgent: FIREFOX,
  startedAt: '2026-01-01T08:00:00Z',
  lastUsedAt: '2026-01-01T09:00:00Z',
})
let isOn: boolean
let open: SessionSummary[]
let passkeys: PasskeySummary[]
let unavailable: string | undefined

/** Daemon with sessions and a second factor. */
function daemon(others: Parameters<typeof serve>[0] = {}): Asked[] {
  return serve({
    'GET /sessions': () => ({ items: open }),
    'GET /session/second-factor': () => ({
      isOn,
      recoveryCodesLeft: isOn || passkeys.length > 0 ? 9 : 0,
    }),
    'GET /session/passkeys': () => ({ items: passkeys, unavailable }),
    ...others,
  })
}
const changes = (log: Asked[]): Asked[] => log.filter(({ method }) => method !== 'GET')
const done = (): Response => new Response(null, { status: 204 })
const dialog = (): ReturnType<typeof within> => within(screen.getByRole('dialog'))

beforeEach(() => {
  isOn = false
  open = [session('a', true), session('b', false)]
  passkeys = []
  unavailable = undefined
  language.code = 'en'
  toasts.list = []
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('one’s own account', () => {
  it('changes the password once it was typed twice alike', async () => {
    const log = daemon({ 'PUT /session/password': done })
    render(AccountPanels)
    await userEvent.click(screen.getByRole('button', { name: 'Change password' }))
    await userEvent.type(dialog().getByLabelText('Present password'), 'the old one')
    await userEvent.type(dialog().getByLabelText('New password'), 'quite another one')
    await userEvent.type(dialog().getByLabelText('New password again'), 'quite another')
    await userEvent.click(dialog().getByRole('button', { name: 'Save' }))
    expect(changes(log)).toEqual([])
    await userEvent.type(dialog().getByLabelText('New password again'), ' one')
    await userEvent.click(dialog().getByRole('button', { name: 'Save' }))
    await vi.waitFor(() => expect(toasts.list).toHaveLength(1))
    expect(changes(log)).toEqual([
      {
        method: 'PUT',
        path: '/session/password',
        body: { presentPassword: 'the old one', newPassword: 'quite another one' },
      },
    ])
  })

  it('says which password was wrong', async () => {
    const fault = { pointer: '/presentPassword', code: 'WRONG', message: 'The password is wrong.' }
    daemon({ 'PUT /session/password': () => problem(422, 'The password is wrong.', [fault]) })
    render(AccountPanels)
    await userEvent.click(screen.getByRole('button', { name: 'Change password' }))
    await userEvent.type(dialog().getByLabelText('Present password'), 'not it')
    await userEvent.type(dialog().getByLabelText('New password'), 'quite another one')
    await userEvent.type(dialog().getByLabelText('New password again'), 'quite another one')
    await userEvent.click(dialog().getByRole('button', { name: 'Save' }))
    expect((await screen.findByRole('alert')).textContent).toContain('The password is wrong.')
  })

  it('sets a second factor up, and shows the recovery codes once', async () => {
    const log = daemon({
      'POST /session/second-factor': () => ({
        secret: 'MZXW6YTBOI',
        uri: 'otpauth://totp/Verbund:eva?secret=MZXW6YTBOI',
        qrCode: '<svg xmlns="http://www.w3.org/2000/svg"/>',
      }),
      'PUT /session/second-factor': () => {
        isOn = true
        return { recoveryCodes: ['AAAA-BBBB-CCCC-DDDD'] }
      },
    })
    render(AccountPanels)
    await userEvent.click(await screen.findByRole('button', { name: 'Set up a second factor' }))
    await userEvent.type(dialog().getByLabelText('Present password'), 'correct horse')
    await userEvent.click(dialog().getByRole('button', { name: 'Next' }))
    expect((await dialog().findByRole('img')).getAttribute('src')).toContain('svg')
    expect(dialog().getByText('MZXW6YTBOI')).toBeTruthy()
    await userEvent.type(dialog().getByLabelText('Code'), '123456')
    await userEvent.click(dialog().getByRole('button', { name: 'Confirm' }))
    expect(await dialog().findByText('AAAA-BBBB-CCCC-DDDD')).toBeTruthy()
    await userEvent.click(dialog().getByRole('button', { name: 'I have kept them' }))
    expect(await screen.findByText(/9 recovery codes are left/)).toBeTruthy()
    expect(changes(log).map(({ method, body }) => [method, body])).toEqual([
      ['POST', { password: 'correct horse' }],
      ['PUT', { code: '123456' }],
    ])
  })

  it('turns the second factor off with password and code', async () => {
    isOn = true
    const log = daemon({
      'POST /session/second-factor/removal': () => {
        isOn = false
        return done()
      },
    })
    render(AccountPanels)
    await userEvent.click(await screen.findByRole('button', { name: 'Turn off' }))
    await userEvent.type(dialog().getByLabelText('Present password'), 'correct horse')
    await userEvent.type(dialog().getByLabelText('Code'), '123456')
    await userEvent.click(dialog().getByRole('button', { name: 'Turn off' }))
    expect(await screen.findByRole('button', { name: 'Set up a second factor' })).toBeTruthy()
    expect(changes(log)[0]?.body).toEqual({ password: 'correct horse', code: '123456' })
  })

  it('adds a passkey, shows the recovery codes once, and removes it with the password', async () => {
    const credential = { id: 'AA' }
    vi.stubGlobal(
      'PublicKeyCredential',
      Object.assign(() => undefined, { parseCreationOptionsFromJSON: (each: unknown) => each }),
    )
    const create = vi.fn(() => Promise.resolve({ toJSON: () => credential }))
    vi.stubGlobal('navigator', { ...navigator, credentials: { create } })
    const log = daemon({
      'POST /session/passkeys': () => ({ options: { challenge: 'c' } }),
      'PUT /session/passkeys': () => {
        passkeys = [{ passkeyId: 'p1', name: 'Blue key', createdAt: '2026-01-01T08:00:00Z' }]
        return { recoveryCodes: ['AAAA-BBBB-CCCC-DDDD'] }
      },
      'POST /session/passkeys/p1/removal': () => {
        passkeys = []
        return done()
      },
    })
    render(AccountPanels)
    await userEvent.click(await screen.findByRole('button', { name: 'Add a passkey' }))
    await userEvent.type(dialog().getByLabelText('Name'), 'Blue key')
    await userEvent.type(dialog().getByLabelText('Present password'), 'correct horse')
    await userEvent.click(dialog().getByRole('button', { name: 'Next' }))
    expect(await dialog().findByText('AAAA-BBBB-CCCC-DDDD')).toBeTruthy()
    expect(create).toHaveBeenCalledWith({ publicKey: { challenge: 'c' } })
    await userEvent.click(dialog().getByRole('button', { name: 'I have kept them' }))
    expect(await screen.findByText(/takes a passkey. 9 recovery codes are left/)).toBeTruthy()

    await userEvent.click(screen.getByRole('button', { name: 'Remove: Blue key' }))
    await userEvent.type(dialog().getByLabelText('Present password'), 'correct horse')
    await userEvent.click(dialog().getByRole('button', { name: 'Remove' }))
    expect(await screen.findByText('There are no passkeys.')).toBeTruthy()
    expect(changes(log).map(({ method, body }) => [method, body])).toEqual([
      ['POST', { password: 'correct horse' }],
      ['PUT', { name: 'Blue key', credential }],
      ['POST', { password: 'correct horse' }],
    ])
  })

  it('says why there can be no passkeys', async () => {
    unavailable = 'These pages have no domain name.'
    daemon()
    language.code = 'de'
    render(AccountPanels)
    // The server says it in English, the page in the language of its reader.
    expect(await screen.findByText(de.code['PASSKEYS_UNAVAILABLE'] ?? '')).toBeTruthy()
    expect(screen.queryByText('These pages have no domain name.')).toBeNull()
    const button = screen.getByRole<HTMLButtonElement>('button', { name: de.account.addPasskey })
    expect(button.disabled).toBe(true)
  })

  it('lists the sessions and ends another one, not this one', async () => {
    const log = daemon({
      'DELETE /sessions/b': () => {
        open = [session('a', true)]
        return done()
      },
    })
    render(AccountPanels)
    expect(await screen.findAllByText(/Firefox, Linux/)).toHaveLength(2)
    expect(screen.queryByRole('button', { name: 'End: 192.0.2.1' })).toBeNull()
    await userEvent.click(screen.getByRole('button', { name: 'End: 192.0.2.2' }))
    await vi.waitFor(() => expect(screen.getAllByText(/Firefox, Linux/)).toHaveLength(1))
    expect(changes(log)).toEqual([{ method: 'DELETE', path: '/sessions/b', body: undefined }])
  })
})

describe('sessions at the OPC UA server', () => {
  it('are named with program and certificate, and ended like others', async () => {
    const opcUa: SessionSummary = {
      ...session('opcua-7', false),
      kind: 'OPC_UA',
      userAgent: 'line planner',
      clientCertificate: 'CN=planner',
    }
    open = [{ ...session('a', true), kind: 'PAGE' }, opcUa]
    const log = daemon({
      'DELETE /sessions/opcua-7': () => {
        open = [session('a', true)]
        return done()
      },
    })
    render(AccountPanels)
    expect(await screen.findByText('OPC UA')).toBeTruthy()
    expect(screen.getByText(/line planner/)).toBeTruthy()
    expect(screen.getByText('Certificate: CN=planner')).toBeTruthy()
    expect(screen.getAllByText(/Firefox, Linux/)).toHaveLength(1)
    await userEvent.click(screen.getByRole('button', { name: 'End: 192.0.2.2' }))
    await vi.waitFor(() => expect(screen.queryByText('OPC UA')).toBeNull())
    expect(changes(log)).toEqual([{ method: 'DELETE', path: '/sessions/opcua-7', body: undefined }])
  })
})

it.each([
  [FIREFOX, 'Firefox, Linux'],
  [
    'Mozilla/5.0 (Windows NT 10.0) AppleWebKit/537.36 Chrome/140.0 Safari/537.36',
    'Chrome, Windows',
  ],
  ['Mozilla/5.0 (Windows NT 10.0) AppleWebKit/537.36 Chrome/140.0 Edg/140.0', 'Edge, Windows'],
  [
    'Mozilla/5.0 (iPhone; CPU iPhone OS 18_0 like Mac OS X) Version/18.0 Safari/604.1',
    'Safari, iOS',
  ],
  ['curl/8.14.1', undefined],
])('names the browser of %s', (userAgent, name) => {
  expect(browserOf(userAgent)).toBe(name)
})
