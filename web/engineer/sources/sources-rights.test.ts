import { render, screen } from '@testing-library/svelte'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { session, type SignedIn } from '@/transport/session.svelte'
import { serve } from '../../vitest.server'
import SourcePage from './SourcePage.svelte'
import SourcesPage from './SourcesPage.svelte'

const source = {
  sourceId: 'Press1',
  name: 'Press',
  endpointUrl: 'opc.tcp://press:4840',
  state: 'connected',
  live: 0,
  inputs: 0,
  findable: 0,
  notLive: [],
  changes: 0,
  sessions: 1,
  coarse: [],
  filled: [],
  since: '2026-11-21T10:00:00Z',
  publishingIntervalMs: 500,
  silenceMsMax: 5000,
  security: { kind: 'strongest' },
  authentication: { kind: 'anonymous' },
}
const certificate = {
  thumbprint: 'ab12',
  fingerprint: 'ab12',
  subject: 'CN=Press',
  trust: 'rejected',
}
const client = { ...certificate, state: 'REJECTED', subject: 'CN=Scada' }
/** What changes sources, certificates or trust, as each page names it. */
const CHANGES =
  /^(Add a source|Edit|Remove the source|Trust|Deny|Add a certificate|Request a certificate|Install an issued certificate|Renew|Remove)/

function signIn(role: SignedIn['role']): void {
  session.state = { is: 'signedIn', who: { userName: 'eva', role, csrfToken: 't' } }
  serve({
    'GET /sources': () => ({ items: [source] }),
    'GET /source-certificates': () => ({ items: [certificate] }),
    'GET /client-certificates': () => ({ items: [client] }),
    'GET /client-authorities': () => ({ items: [] }),
    'GET /client-revocation-lists': () => ({ items: [] }),
    'GET /server-profiles': () => ({ items: [] }),
  })
}
/** Names of the buttons and links of the page that change something. */
const changes = (): string[] =>
  [...screen.queryAllByRole('button'), ...screen.queryAllByRole('link')]
    .map((each) => each.getAttribute('aria-label') ?? each.textContent.trim())
    .filter((name) => CHANGES.test(name))

afterEach(() => {
  vi.unstubAllGlobals()
})

describe.each([
  ['list of sources', SourcesPage, { adding: true }, ['Add a source', 'Trust: CN=Press']],
  ['page of a source', SourcePage, { sourceId: 'Press1' }, ['Edit', 'Remove the source']],
] as const)('the %s', (_, page, props, expected) => {
  it('lets engineers change it', async () => {
    signIn('ENGINEER')
    render(page as typeof SourcesPage, props as { adding: boolean })
    expect(await screen.findAllByText('Press')).toBeTruthy()
    await vi.waitFor(() => {
      expect(changes()).toEqual(expect.arrayContaining([...expected]))
    })
  })
  it.each(['OPERATOR', 'VIEWER'] as const)('shows %sS nothing that is refused', async (role) => {
    signIn(role)
    render(page as typeof SourcesPage, props as { adding: boolean })
    expect(await screen.findAllByText('Press')).toBeTruthy()
    await new Promise((done) => setTimeout(done, 20))
    expect(changes()).toEqual([])
    expect(screen.queryByRole('dialog')).toBeNull()
  })
})
