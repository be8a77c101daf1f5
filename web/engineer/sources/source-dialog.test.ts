import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { expect, it } from 'vitest'
import { session } from '@/transport/session.svelte'
import { serve } from '../../vitest.server'
import type { SourceConfig } from '../api/types'
import SourceDialog from './SourceDialog.svelte'

const source: SourceConfig = {
  sourceId: 'press',
  name: 'Press',
  endpointUrl: 'opc.tcp://press:4840',
  security: { choice: 'none' },
  publishingIntervalMs: 20,
  silenceMsMax: 5000,
}

it('keeps what one types while the source goes on changing, and saves it', async () => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  const log = serve({ 'PUT /sources/press': () => ({}) })
  const user = userEvent.setup()
  const props = { open: true, onclose: () => undefined, onsaved: () => undefined, source }
  const { rerender } = render(SourceDialog, props)
  const address = screen.getByLabelText('Address')
  await user.clear(address)
  await user.type(address, 'opc.tcp://press-2:4840')
  await user.selectOptions(screen.getByLabelText('Security'), 'signed')
  await user.clear(screen.getByLabelText(/^Publishing interval/))
  await user.type(screen.getByLabelText(/^Publishing interval/), '500')

  // As each status of the source does.
  await rerender({ ...props, source: { ...source, name: 'Press, of the hall' } })
  expect(address).toHaveProperty('value', 'opc.tcp://press-2:4840')

  await user.click(screen.getByRole('button', { name: 'Save' }))
  const saved = log.find(({ method }) => method === 'PUT')?.body
  expect(saved).toMatchObject({
    endpointUrl: 'opc.tcp://press-2:4840',
    security: { choice: 'exactly', policy: 'Basic256Sha256', mode: 'sign' },
    publishingIntervalMs: 500,
    silenceMsMax: 5000,
  })
})
