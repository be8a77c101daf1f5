import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, expect, it, vi } from 'vitest'
import { session } from '@/transport/session.svelte'
import { serve } from '../../vitest.server'
import type { SourceView } from '../api/types'
import RemoveSourceDialog from './RemoveSourceDialog.svelte'

afterEach(() => {
  vi.unstubAllGlobals()
})

it('names the fields that get no values any more before a source is removed', async () => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  const request = { operationNetworkId: 'n', operationId: 'o', dynamicDataRequestId: 'r' }
  const fields = ['made', 'power'].map((fieldName) => ({ ...request, fieldName }))
  const log = serve({
    'GET /sources/mill/use': () => ({ fieldCount: 3, fields }),
    'DELETE /sources/mill': () => new Response(null, { status: 204 }),
  })
  const source = { sourceId: 'mill', name: 'Mill' } as SourceView
  render(RemoveSourceDialog, { source, onclose: vi.fn() })
  await screen.findByText(/^3 disclosed fields get their values from it/)
  expect(screen.getByRole('link', { name: 'power' })).toHaveProperty('hash', '#/fields/n/o/r/power')
  screen.getByText('and one more.')
  expect(log.some(({ method }) => method === 'DELETE')).toBe(false)
  await userEvent.click(screen.getByRole('button', { name: 'Remove the source' }))
  expect(log.filter(({ method }) => method === 'DELETE')).toHaveLength(1)
})
