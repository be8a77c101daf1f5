import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { clock } from '@/format/clock.svelte'
import { session, type SignedIn } from '@/transport/session.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import type {
  ClientAuthorityView,
  ClientCertificateView,
  ClientRevocationListView,
} from '../api/types'
import ClientCertificates from './ClientCertificates.svelte'

const THUMBPRINT = 'ab12cd34'
let known: ClientCertificateView[]
let authorities: ClientAuthorityView[]
let lists: ClientRevocationListView[]

/** Trust list of the twin. */
function twin(): Asked[] {
  const trust = ({ path, body }: Asked): unknown => {
    const state = (body as { isTrusted: boolean }).isTrusted
      ? ('TRUSTED' as const)
      : ('DENIED' as const)
    const approvedBy = state === 'TRUSTED' ? 'eva' : null
    known = known.map((each) =>
      path.endsWith(each.thumbprint) ? { ...each, state, approvedBy } : each,
    )
    return known[0]
  }
  return serve({
    'GET /client-certificates': () => ({ items: known }),
    'GET /client-authorities': () => ({ items: authorities }),
    'GET /client-revocation-lists': () => ({ items: lists }),
    'DELETE /client-authorities/ca01': () => {
      authorities = authorities.slice(1)
      return new Response(null, { status: 204 })
    },
    'DELETE /client-revocation-lists/crl01': () => {
      lists = []
      return new Response(null, { status: 204 })
    },
    [`PUT /client-certificates/${THUMBPRINT}`]: trust,
    'POST /client-certificates': () => new Response(null, { status: 204 }),
  })
}
const changes = (log: Asked[]): unknown[] =>
  log.filter(({ method }) => method !== 'GET').map(({ body }) => body)
const inDays = (days: number): string => new Date(clock.now + days * 86_400_000).toISOString()
const signIn = (role: SignedIn['role']): void => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role, csrfToken: 't' } }
}
const row = (subject: string): string =>
  screen.getByText(subject).closest('tr')?.textContent.replace(/\s+/g, ' ') ?? ''
async function openDialog(): Promise<ReturnType<typeof within>> {
  await userEvent.click(await screen.findByRole('button', { name: 'Add a certificate' }))
  return within(screen.getByRole('dialog'))
}

beforeEach(() => {
  signIn('ENGINEER')
  toasts.list = []
  known = [
    {
      thumbprint: THUMBPRINT,
      fingerprint: 'fe98dc76',
      subject: 'CN=Planner',
      notBefore: inDays(-10),
      notAfter: inDays(300),
      state: 'REJECTED',
      rejectedAt: inDays(-1),
      rejectionReason: 'NOT_TRUSTED',
      rejectedAddress: '10.0.0.7',
      rejectedApplicationName: 'Line planner',
    },
    {
      thumbprint: 'ef56',
      fingerprint: 'ef56ef56',
      subject: 'CN=Old',
      notBefore: inDays(-300),
      notAfter: inDays(-1),
      state: 'TRUSTED',
      approvedBy: 'eva',
      rejectedAt: inDays(-0.5),
      rejectionReason: 'OUT_OF_TIME',
    },
    {
      thumbprint: '0789',
      fingerprint: '07890789',
      subject: 'CN=Early',
      notBefore: inDays(2),
      notAfter: inDays(300),
      state: 'TRUSTED',
      approvedBy: 'eva',
    },
    {
      thumbprint: '0abc',
      fingerprint: '0abc0abc',
      subject: 'CN=Ending',
      notBefore: inDays(-300),
      notAfter: inDays(10),
      state: 'TRUSTED',
      approvedBy: 'eva',
    },
  ]
  const authority = { issuer: 'CN=Root', notBefore: inDays(-300), notAfter: inDays(300) }
  authorities = [
    {
      ...authority,
      thumbprint: 'ca01',
      fingerprint: 'ca01ca01',
      subject: 'CN=Root',
      isTrusted: true,
      revocationList: 'OUTDATED',
      nextUpdate: inDays(-1),
    },
    {
      ...authority,
      thumbprint: 'ca02',
      fingerprint: 'ca02ca02',
      subject: 'CN=Between',
      isTrusted: false,
      revocationList: 'CURRENT',
      nextUpdate: inDays(1),
    },
  ]
  lists = [
    {
      revocationListId: 'crl01',
      issuer: 'CN=Between',
      thisUpdate: inDays(-6),
      nextUpdate: inDays(1),
      revokedCount: 3,
      isSignedByKnownAuthority: false,
    },
  ]
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('certificates of OPC UA clients', () => {
  it('show the rejected client, its fingerprint and the validity of its certificate', async () => {
    twin()
    render(ClientCertificates)
    await screen.findByText('CN=Planner')
    expect(row('CN=Planner')).toMatch(
      /FE98 DC76.* to .*24 h ago Line planner, from 10\.0\.0\.7.*Waits for you/,
    )
    expect(row('CN=Planner')).not.toMatch(/Expired|Not valid yet|Ends soon|not trusted/)
    expect(row('CN=Old')).toMatch(/Expired.*12 h ago.*It is not valid at this time\..*Trusted/)
    expect(row('CN=Early')).toMatch(/Not valid yet/)
    expect(row('CN=Ending')).toMatch(/Ends soon/)
  })

  it('have authorities, which need current revocation lists', async () => {
    twin()
    render(ClientCertificates)
    await screen.findByText('Trusted, with all its clients')
    const panel = (name: string): string =>
      screen.getByRole('region', { name }).textContent.replace(/\s+/g, ' ')
    expect(panel('Authorities of OPC UA clients')).toMatch(
      /CN=Root.*Outdated Its clients are rejected.*CN=Between Intermediate authority.*issued by CN=Root.*Current/,
    )
    expect(panel('Revocation lists')).toMatch(
      /CN=Between Signed by an unknown authority.*3.*Ends soon/,
    )
  })

  it('have authorities and lists that can be removed, after a question', async () => {
    const log = twin()
    render(ClientCertificates)
    for (const [button, message] of [
      ['Remove: CN=Root', 'Authority removed.'],
      ['Remove: CN=Between', 'Revocation list removed.'],
    ] as const) {
      await userEvent.click(
        (await screen.findAllByRole('button', { name: button })).at(-1) as HTMLElement,
      )
      await userEvent.click(
        within(screen.getByRole('dialog')).getByRole('button', { name: 'Remove' }),
      )
      await vi.waitFor(() => expect(toasts.list.at(-1)?.text).toBe(message))
    }
    expect(log.filter(({ method }) => method === 'DELETE').map(({ path }) => path)).toEqual([
      '/client-authorities/ca01',
      '/client-revocation-lists/crl01',
    ])
    expect(await screen.findByText('No revocation list.')).toBeTruthy()
  })

  it('are trusted at once, and taken back', async () => {
    const log = twin()
    render(ClientCertificates)
    await userEvent.click(await screen.findByRole('button', { name: 'Trust: CN=Planner' }))
    expect(await screen.findByRole('button', { name: 'Stop trusting: CN=Planner' })).toBeTruthy()
    toasts.list[0]?.action?.run()
    expect(await screen.findByRole('button', { name: 'Trust: CN=Planner' })).toBeTruthy()
    expect(changes(log)).toEqual([{ isTrusted: true }, { isTrusted: false }])
  })

  it('are marked where no person approved them, until one does', async () => {
    known = known.map((each) => ({ ...each, state: 'TRUSTED', approvedBy: null }))
    const log = twin()
    render(ClientCertificates)
    await screen.findByText('CN=Planner')
    expect(row('CN=Planner')).toMatch(/Trusted Not approved by a person A former version trusted/)
    await userEvent.click(screen.getByRole('button', { name: 'Approve: CN=Planner' }))
    await vi.waitFor(() => expect(row('CN=Planner')).not.toMatch(/Not approved/))
    expect(screen.queryByRole('button', { name: 'Approve: CN=Planner' })).toBeNull()
    expect(screen.getByRole('button', { name: 'Stop trusting: CN=Planner' })).toBeTruthy()
    expect(row('CN=Old')).toMatch(/Not approved by a person/)
    expect(changes(log)).toEqual([{ isTrusted: true }])
  })

  it('are denied before they were ever trusted, and trusted again', async () => {
    const log = twin()
    render(ClientCertificates)
    await userEvent.click(await screen.findByRole('button', { name: 'Deny: CN=Planner' }))
    await vi.waitFor(() => expect(row('CN=Planner')).toMatch(/Denied/))
    expect(screen.queryByRole('button', { name: 'Deny: CN=Planner' })).toBeNull()
    await userEvent.click(screen.getByRole('button', { name: 'Trust: CN=Planner' }))
    await screen.findByRole('button', { name: 'Stop trusting: CN=Planner' })
    expect(changes(log)).toEqual([{ isTrusted: false }, { isTrusted: true }])
  })

  it('are denied by themselves where an authority vouches for them', async () => {
    known = known.map((each) => ({ ...each, state: 'ISSUED', approvedBy: null }))
    const log = twin()
    render(ClientCertificates)
    await screen.findByText('CN=Planner')
    expect(row('CN=Planner')).toMatch(/Came in through its authority/)
    expect(row('CN=Planner')).not.toMatch(/Waits for you|Not approved/)
    await userEvent.click(screen.getByRole('button', { name: 'Deny: CN=Planner' }))
    await vi.waitFor(() => expect(row('CN=Planner')).toMatch(/Denied/))
    expect(changes(log)).toEqual([{ isTrusted: false }])
    expect(toasts.list[0]?.action).toBeUndefined()
  })

  it('are not for everybody to trust', async () => {
    twin()
    signIn('VIEWER')
    render(ClientCertificates)
    await screen.findByText('CN=Planner')
    expect(screen.queryByRole('button')).toBeNull()
  })

  it('can be given in advance, and revocation lists too, as files of either form', async () => {
    const log = twin()
    render(ClientCertificates)
    let dialog = await openDialog()
    await userEvent.selectOptions(dialog.getByLabelText('Kind'), 'REVOCATION_LIST')
    await userEvent.upload(
      dialog.getByLabelText('From a file'),
      new File([new Uint8Array([0x30, 3, 2, 1, 1])], 'plant.crl'),
    )
    await vi.waitFor(() =>
      expect(dialog.getByLabelText('Content')).toHaveProperty('value', 'MAMCAQE='),
    )
    await userEvent.click(dialog.getByRole('button', { name: 'Add' }))
    await vi.waitFor(() =>
      expect(toasts.list.map(({ text }) => text)).toEqual(['Certificate added.']),
    )

    dialog = await openDialog()
    const pem = '-----BEGIN CERTIFICATE-----\nMAMCAQE=\n-----END CERTIFICATE-----'
    await userEvent.selectOptions(dialog.getByLabelText('Kind'), 'ISSUER')
    await userEvent.upload(
      dialog.getByLabelText('From a file'),
      new File([`${pem}\n`], 'between.pem'),
    )
    await vi.waitFor(() =>
      expect(dialog.getByLabelText('Content')).toHaveProperty('value', `${pem}\n`),
    )
    await userEvent.click(dialog.getByRole('button', { name: 'Add' }))
    await vi.waitFor(() =>
      expect(changes(log)).toEqual([
        { kind: 'REVOCATION_LIST', content: 'MAMCAQE=' },
        { kind: 'ISSUER', content: pem },
      ]),
    )
  })

  it('are refused with a reason: too large a file here, what is no certificate by the connector', async () => {
    const log = twin()
    render(ClientCertificates)
    const dialog = await openDialog()
    await userEvent.upload(
      dialog.getByLabelText('From a file'),
      new File([new Uint8Array(300 * 1024)], 'film.pem'),
    )
    expect(
      await dialog.findByText('The file is larger than 256 KiB: it cannot be a certificate.'),
    ).toBeTruthy()
    expect(changes(log)).toEqual([])

    serve({
      'GET /client-certificates': () => ({ items: known }),
      'GET /client-authorities': () => ({ items: [] }),
      'GET /client-revocation-lists': () => ({ items: [] }),
      'POST /client-certificates': () => problem(422, 'It cannot be used: no certificate.'),
    })
    await userEvent.type(dialog.getByLabelText('Content'), 'MAMC')
    await userEvent.click(dialog.getByRole('button', { name: 'Add' }))
    expect((await dialog.findByRole('alert')).textContent).toContain(
      'It cannot be used: no certificate.',
    )
  })
})
