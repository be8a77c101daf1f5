import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { session, type SignedIn } from '@/transport/session.svelte'
import { serve, type Asked } from '../../vitest.server'
import type { SourceClientCertificate, SourceClientCertificates } from '../api/types'
import OwnCertificatePanel from './OwnCertificatePanel.svelte'

const PATH = '/source-client-certificate'

function certificate(fingerprint: string): SourceClientCertificate {
  return {
    thumbprint: fingerprint,
    fingerprint,
    subject: 'CN=Verbund factory connector',
    applicationUri: 'urn:verbund:connector:FOR_MUC',
    validFrom: '2026-01-01T00:00:00Z',
    validTo: '2036-01-01T00:00:00Z',
    content: '-----BEGIN CERTIFICATE-----\nMAMC\nAQE=\n-----END CERTIFICATE-----\n',
  }
}

let own: SourceClientCertificates
function connector(): Asked[] {
  return serve({
    [`GET ${PATH}`]: () => own,
    [`POST ${PATH}/next`]: () => (own = { ...own, next: certificate('cd34') }),
    [`DELETE ${PATH}/next`]: () => (own = { current: own.current }),
    [`POST ${PATH}/next/use`]: () => (own = { current: certificate('cd34') }),
  })
}
const signIn = (role: SignedIn['role']): void => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role, csrfToken: 't' } }
}
const changes = (log: Asked[]): string[] =>
  log.filter(({ method }) => method !== 'GET').map(({ method, path }) => `${method} ${path}`)

beforeEach(() => {
  signIn('ENGINEER')
  toasts.list = []
  own = { current: certificate('ab12') }
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the certificate that machines see', () => {
  it('is shown, and handed out as DER and as PEM', async () => {
    connector()
    render(OwnCertificatePanel)
    expect(await screen.findByText('AB12')).toBeTruthy()
    expect(screen.getByText('urn:verbund:connector:FOR_MUC')).toBeTruthy()
    const der = screen.getByRole('link', { name: 'Download (DER)' })
    expect(der.getAttribute('href')).toBe('data:application/pkix-cert;base64,MAMCAQE=')
    const pem = screen.getByRole('link', { name: 'Download (PEM)' })
    expect(decodeURIComponent(pem.getAttribute('href') ?? '')).toContain(own.current.content)
  })

  it('is renewed in two steps: machines learn to trust the next one before it is used', async () => {
    const log = connector()
    render(OwnCertificatePanel)
    await userEvent.click(await screen.findByRole('button', { name: 'Make a new one' }))
    const dialog = within(screen.getByRole('dialog'))
    expect(dialog.getByText(/until then nothing changes/)).toBeTruthy()
    await userEvent.click(dialog.getByRole('button', { name: 'Make a new one' }))
    const next = within(await screen.findByRole('region', { name: /^The next one/ }))
    expect(next.getByText('CD34')).toBeTruthy()
    expect(screen.getByText('AB12'), 'still in use').toBeTruthy()

    await userEvent.click(next.getByRole('button', { name: 'Use it now' }))
    expect(screen.getByText(/does not trust it yet refuses the connector/)).toBeTruthy()
    const asked = within(screen.getByRole('dialog'))
    await userEvent.click(asked.getByRole('button', { name: 'Use it now' }))
    await vi.waitFor(() => expect(screen.queryByText('AB12')).toBeNull())
    expect(screen.queryByRole('region', { name: /^The next one/ })).toBeNull()
    expect(changes(log)).toEqual([`POST ${PATH}/next`, `POST ${PATH}/next/use`])
  })

  it('can go without the next one, after a question', async () => {
    own.next = certificate('cd34')
    const log = connector()
    render(OwnCertificatePanel)
    await userEvent.click(await screen.findByRole('button', { name: 'Discard it' }))
    expect(changes(log)).toEqual([])
    const dialog = within(screen.getByRole('dialog'))
    await userEvent.click(dialog.getByRole('button', { name: 'Discard it' }))
    await vi.waitFor(() => expect(screen.queryByText('CD34')).toBeNull())
    expect(changes(log)).toEqual([`DELETE ${PATH}/next`])
  })

  it('is not for everybody to change', async () => {
    signIn('VIEWER')
    own.next = certificate('cd34')
    connector()
    render(OwnCertificatePanel)
    await screen.findByText('CD34')
    expect(screen.queryByRole('button')).toBeNull()
  })
})
