import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { session } from '@/transport/session.svelte'
import type { Resource } from '@/transport/resource.svelte'
import { serve, type Asked } from '../../vitest.server'
import type { ServerOffer, ServerProfile, SourceConfig, SourceTest } from '../api/types'
import type { ShownCertificate } from './certificates.svelte'
import SourceDialog from './SourceDialog.svelte'

const source: SourceConfig = {
  sourceId: 'press',
  name: 'Press',
  endpointUrl: 'opc.tcp://press:4840',
  security: { choice: 'none' },
  publishingIntervalMs: 20,
  silenceMsMax: 5000,
}
const ADDRESS = 'opc.tcp://10.0.0.7:4840'
const FINGERPRINT = 'fe98dc76'

function endpoint(
  securityPolicy: string,
  choice: ServerOffer['endpoints'][number]['choice'],
): ServerOffer['endpoints'][number] {
  const isProtected = securityPolicy !== 'None'
  return {
    endpointUrl: 'opc.tcp://plc-1:4840',
    usedUrl: ADDRESS,
    securityPolicy,
    messageSecurity: isProtected ? 'signAndEncrypt' : 'none',
    ...(choice === undefined ? {} : { choice }),
    allowsAnonymous: false,
    allowsUserName: true,
    allowsCertificate: false,
    serverName: 'S7-1500 of the press',
    applicationUri: 'urn:plc-1',
    certificateFingerprint: FINGERPRINT,
  }
}

const offer: ServerOffer = {
  endpoints: [
    endpoint('Basic256Sha256', {
      choice: 'exactly',
      policy: 'Basic256Sha256',
      mode: 'signAndEncrypt',
    }),
    endpoint('None', { choice: 'none' }),
    endpoint('Basic128Rsa15', undefined),
  ],
  certificates: [
    {
      thumbprint: 'ab12',
      fingerprint: FINGERPRINT,
      subject: 'CN=plc-1',
      hostNames: ['plc-1'],
      keyBits: 2048,
      isSignedWithSha1: false,
      isTrusted: false,
    },
  ],
  findings: [{ code: 'hostNameUnknown', host: 'plc-1', usedUrl: ADDRESS }],
}
const untrusted: SourceTest = {
  problem: {
    kind: 'serverCertificateUntrusted',
    message: `CN=plc-1, SHA-256 fingerprint ${FINGERPRINT}.`,
    remedy: '',
  },
}
const comesIn: SourceTest = {
  server: {
    endpoint: {
      endpointUrl: ADDRESS,
      securityPolicy: 'Basic256Sha256',
      messageSecurity: 'signAndEncrypt',
      serverName: 'S7-1500 of the press',
      applicationUri: 'urn:plc-1',
    },
    product: {
      productUri: 'urn:siemens',
      productName: 'SIMATIC S7-1500',
      manufacturerName: 'Siemens AG',
      softwareVersion: '3.1',
    },
    family: 's7-1500',
    limits: { nodesPerReadMax: 500 },
    publishingIntervalMs: 500,
    clockAheadMs: -7_200_000,
    findings: [{ code: 'clockDiffers', aheadMs: -7_200_000 }],
  },
}

const profile: ServerProfile = {
  family: 's7-1500',
  name: 'Siemens S7-1500',
  recognisedBy: [],
  advised: { publishingIntervalMs: 1000, samplingIntervalMs: 1000 },
  figures: [{ limit: 'sessionsMax', value: 32, kind: 'project', source: 'notes of a project' }],
  expected: [{ en: 'In STOP it goes on.', de: 'In STOP …', kind: 'manual', source: 'TIA Portal' }],
  settings: [],
}

const certificates = {
  value: [{ thumbprint: 'ab12', fingerprint: FINGERPRINT, subject: 'CN=plc-1', isTrusted: false }],
  refresh: () => Promise.resolve(),
  refreshSoon: () => undefined,
} as unknown as Resource<ShownCertificate[]>
const props = {
  open: true,
  onclose: () => undefined,
  onsaved: () => undefined,
  certificates,
}
const bodies = (log: Asked[], path: string): unknown[] =>
  log.filter((asked) => asked.path === path).map(({ body }) => body)

beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
})
afterEach(() => {
  vi.unstubAllGlobals()
})

async function typeAddress(): Promise<void> {
  const address = screen.getByLabelText('Address')
  await userEvent.clear(address)
  await userEvent.type(address, ADDRESS)
}

it('keeps what one types while the source goes on changing, and saves it', async () => {
  const log = serve({ 'PUT /sources/press': () => ({}) })
  const user = userEvent.setup()
  const { rerender } = render(SourceDialog, { ...props, source })
  const address = screen.getByLabelText('Address')
  await user.clear(address)
  await user.type(address, 'opc.tcp://press-2:4840')
  await user.selectOptions(
    screen.getByLabelText('Security'),
    'Signed, not encrypted (Basic256Sha256)',
  )
  await user.clear(screen.getByLabelText(/^Publishing interval/))
  await user.type(screen.getByLabelText(/^Publishing interval/), '500')

  await user.type(screen.getByLabelText(/^Sampling interval/), '500')

  // As each status of the source does.
  await rerender({ ...props, source: { ...source, name: 'Press, of the hall' } })
  expect(address).toHaveProperty('value', 'opc.tcp://press-2:4840')

  await user.click(screen.getByRole('button', { name: 'Save' }))
  expect(bodies(log, '/sources/press')[0]).toMatchObject({
    endpointUrl: 'opc.tcp://press-2:4840',
    security: { choice: 'exactly', policy: 'Basic256Sha256', mode: 'sign' },
    publishingIntervalMs: 500,
    samplingIntervalMs: 500,
    silenceMsMax: 5000,
  })
})

describe('the server of a new source', () => {
  it('is asked what it offers: only that can be chosen, the strongest first', async () => {
    const log = serve({ 'POST /source-discovery': () => ({ offer }) })
    render(SourceDialog, props)
    await typeAddress()
    await userEvent.click(screen.getByRole('button', { name: 'Ask the server' }))
    const shown = await screen.findByRole('region', { name: 'What the server offers' })
    expect(bodies(log, '/source-discovery')).toEqual([{ endpointUrl: ADDRESS }])
    const said = shown.textContent.replace(/\s+/g, ' ')
    expect(said).toContain('S7-1500 of the press')
    expect(said).toContain('FE98 DC76')
    expect(said).toContain('calls itself plc-1, which no name service here knows')
    expect(said).toContain('Basic128Rsa15')
    const options = (label: string): (string | null)[] =>
      within(screen.getByLabelText(label))
        .getAllByRole('option')
        .map(({ textContent }) => textContent)
    expect(options('Security')).toEqual([
      'The strongest encryption that the server offers',
      'Basic256Sha256, signed and encrypted',
      'None (only on a trusted network)',
    ])
    expect(screen.getByLabelText('Security')).toHaveProperty('value', 'strongest')
    expect(options('Sign in as'), 'anonymous is not offered').toEqual(['User name and password'])
    expect(screen.getByLabelText('User name')).toBeTruthy()

    // What another server offers is not known from this one.
    await userEvent.type(screen.getByLabelText('Address'), '1')
    expect(screen.queryByRole('region', { name: 'What the server offers' })).toBeNull()
    expect(options('Security')).toHaveLength(3)
  })

  it('is never used unprotected without a word', async () => {
    const bare = [{ ...endpoint('None', { choice: 'none' }), allowsAnonymous: true }]
    const findings = [{ code: 'nothingEncrypted' as const, offered: ['None None'] }]
    serve({
      'POST /source-discovery': () => ({ offer: { endpoints: bare, certificates: [], findings } }),
    })
    render(SourceDialog, props)
    await typeAddress()
    await userEvent.click(screen.getByRole('button', { name: 'Ask the server' }))
    expect(await screen.findByText(/Switch on Basic256Sha256/)).toBeTruthy()
    expect(screen.getByLabelText('Security')).toHaveProperty('value', 'none')
  })

  it('that is not there is said with what to do', async () => {
    const problem = { kind: 'hostNameUnknown', message: 'No name service here …', remedy: '' }
    serve({ 'POST /source-discovery': () => ({ problem }) })
    render(SourceDialog, props)
    await typeAddress()
    await userEvent.click(screen.getByRole('button', { name: 'Ask the server' }))
    expect(await screen.findByText('No name service knows this host name')).toBeTruthy()
    expect(screen.getByText(/use the IP address of the server/)).toBeTruthy()
  })

  it('is tested as it would be used, and its certificate trusted, before it is saved', async () => {
    const outcomes = [untrusted, comesIn]
    const log = serve({
      'POST /source-test': () => outcomes.shift(),
      'PUT /source-certificates/ab12': () => ({}),
      'GET /server-profiles': () => ({ items: [profile] }),
      'POST /sources': () => ({}),
    })
    render(SourceDialog, props)
    await typeAddress()
    await userEvent.selectOptions(screen.getByLabelText('Sign in as'), 'User name and password')
    await userEvent.type(screen.getByLabelText('User name'), 'connector')
    await userEvent.type(screen.getByLabelText('Password'), 's3cret')
    await userEvent.click(screen.getByRole('button', { name: 'Test' }))
    expect(await screen.findByText('The server’s certificate is not trusted yet')).toBeTruthy()
    await userEvent.click(screen.getByRole('button', { name: 'Trust' }))
    await userEvent.click(screen.getByRole('button', { name: 'Test' }))
    const status = (await screen.findByText('The connector comes in.')).closest('[role=status]')
    const said = status?.textContent.replace(/\s+/g, ' ')
    expect(said).toContain('Siemens AG · SIMATIC S7-1500 · 3.1')
    expect(said).toContain('500 nodes per read')
    expect(said).toContain('The server grants changes every 500 ms')
    expect(said).toContain('Its clock is 2 h behind ours.')
    expect(bodies(log, '/source-test')[0]).toMatchObject({
      endpointUrl: ADDRESS,
      identity: { kind: 'userName', userName: 'connector', password: 's3cret' },
    })
    expect(bodies(log, '/sources'), 'a test saves nothing').toEqual([])

    // What is known of such a server, and the intervals that fit it.
    expect(screen.getByText('What to know of Siemens S7-1500')).toBeTruthy()
    expect(screen.getByText(/In STOP it goes on/).textContent).toContain('manual: TIA Portal')
    await userEvent.click(screen.getByRole('button', { name: 'Use the advised intervals' }))
    expect(screen.getByLabelText(/^Publishing interval/)).toHaveProperty('value', '1000')
    expect(screen.getByLabelText(/^Sampling interval/)).toHaveProperty('value', '1000')

    expect(screen.getByText('The connector comes in.'), 'intervals are not tested').toBeTruthy()

    // What was tested is not what is typed any more.
    await userEvent.type(screen.getByLabelText('Password'), 'x')
    expect(screen.queryByText('The connector comes in.')).toBeNull()
  })
})
