import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { serve, type Asked } from '../../vitest.server'
import WithdrawRequest from './WithdrawRequest.svelte'

const PATH = '/operation-networks/n/operations/o/requests'
const request = {
  dynamicDataRequestId: 'r',
  requesterId: 'acme',
  recipientList: ['acme'],
  purpose: 'Plan',
  reportDataFormat: { reportName: 'R', reportFieldList: [] },
}

function show(consented: number): Asked[] {
  const log = serve({ [`DELETE ${PATH}/r`]: () => ({}), [`POST ${PATH}`]: () => ({}) })
  const onchanged = vi.fn()
  render(WithdrawRequest, { networkId: 'n', operationId: 'o', request, consented, onchanged })
  return log
}
const button = (): HTMLElement => screen.getByRole('button', { name: 'Withdraw this request: r' })

beforeEach(() => {
  toasts.list = []
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('a request is withdrawn', () => {
  it('at once where nothing was consented to, with the way back', async () => {
    const log = show(0)
    await userEvent.click(button())
    await vi.waitFor(() => expect(toasts.list).toHaveLength(1))
    toasts.list[0]?.action?.run()
    await vi.waitFor(() => expect(log.map(({ method }) => method)).toEqual(['DELETE', 'POST']))
  })
  it('after a question with its consequences where consents end', async () => {
    const log = show(2)
    await userEvent.click(button())
    expect(log).toEqual([])
    const dialog = within(screen.getByRole('dialog'))
    expect(dialog.getByText(/consented to 2 fields\. Values stop at once/)).toBeTruthy()
    await userEvent.click(dialog.getByRole('button', { name: 'Withdraw this request' }))
    await vi.waitFor(() => expect(toasts.list).toHaveLength(1))
    expect(log.map(({ method }) => method)).toEqual(['DELETE'])
    expect(toasts.list[0]?.action).toBeUndefined()
  })
})
