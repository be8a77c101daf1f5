import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { clock } from '@/format/clock.svelte'
import { session, type SignedIn } from '@/transport/session.svelte'
import { serve, type Asked } from '../../vitest.server'
import type { ApplicationCertificateView } from '../api/types'
import ApplicationCertificatePanel from './ApplicationCertificatePanel.svelte'

const REQUEST = '-----BEGIN CERTIFICATE REQUEST-----\nMAMCAQE=\n-----END CERTIFICATE REQUEST-----'
let own: ApplicationCertificateView

function twin(): Asked[] {
  return serve({
    'GET /application-certificate': () => own,
    'POST /application-certificate/request': () => ({ content: REQUEST }),
    'PUT /application-certificate': () =>
      (own = { ...own, isSelfSigned: false, issuer: 'CN=Plant CA' }),
  })
}
const changes = (log: Asked[]): unknown[] =>
  log.filter(({ method }) => method !== 'GET').map(({ body }) => body)
const signIn = (role: SignedIn['role']): void => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role, csrfToken: 't' } }
}

beforeEach(() => {
  signIn('ENGINEER')
  toasts.list = []
  own = {
    thumbprint: 'ab12cd34',
    fingerprint: 'fe98dc76',
    subject: 'CN=Verbund Twin press',
    issuer: 'CN=Verbund Twin press',
    isSelfSigned: true,
    applicationUri: 'urn:verbund:twin:FOR_MUC',
    hostNames: ['press.plant'],
    notBefore: new Date(clock.now - 86_400_000).toISOString(),
    notAfter: new Date(clock.now + 20 * 86_400_000).toISOString(),
    keyBits: 2048,
  }
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the certificate of the twin', () => {
  it('is shown with who issued it, for whom, and that it ends soon', async () => {
    twin()
    render(ApplicationCertificatePanel)
    await screen.findByText('The twin itself; it renews it in time.')
    const text = screen
      .getByRole('region', { name: 'Certificate of the twin' })
      .textContent.replace(/\s+/g, ' ')
    expect(text).toMatch(
      /CN=Verbund Twin press RSA 2048.*urn:verbund:twin:FOR_MUC, press\.plant.*Ends soon.*FE98 DC76/,
    )
  })

  it('is requested of an authority, and what that made of it is installed', async () => {
    const log = twin()
    render(ApplicationCertificatePanel)
    await userEvent.click(await screen.findByRole('button', { name: 'Request a certificate' }))
    let dialog = within(screen.getByRole('dialog'))
    await userEvent.type(dialog.getByLabelText('Organisation'), 'Plant Ltd')
    await userEvent.click(dialog.getByRole('checkbox'))
    await userEvent.click(dialog.getByRole('button', { name: 'Make the request' }))
    dialog = within(await screen.findByRole('dialog'))
    await vi.waitFor(() =>
      expect(dialog.getByLabelText('Content')).toHaveProperty('value', REQUEST),
    )
    expect(
      decodeURIComponent(
        dialog.getByRole('link', { name: 'As a file' }).getAttribute('href') ?? '',
      ),
    ).toContain(REQUEST)
    await userEvent.click(dialog.getAllByRole('button', { name: 'Close' }).at(-1) as HTMLElement)

    await userEvent.click(screen.getByRole('button', { name: 'Install an issued certificate' }))
    dialog = within(screen.getByRole('dialog'))
    await userEvent.type(dialog.getByLabelText('Content'), 'MAMCAQE=')
    await userEvent.click(dialog.getByRole('button', { name: 'Install' }))
    expect(await screen.findByText('CN=Plant CA')).toBeTruthy()
    expect(changes(log)).toEqual([
      { withNewKey: true, organization: 'Plant Ltd' },
      { content: 'MAMCAQE=' },
    ])
    expect(toasts.list.map(({ text }) => text)).toEqual([
      'Certificate installed. The twin shows it from the next connection on.',
    ])
  })

  it('is not for everybody to change', async () => {
    twin()
    signIn('VIEWER')
    render(ApplicationCertificatePanel)
    await screen.findByText('The twin itself; it renews it in time.')
    expect(screen.queryByRole('button')).toBeNull()
  })
})
