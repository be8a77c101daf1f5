import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, expect, it, vi } from 'vitest'
import { serve } from '../../vitest.server'
import ReceiptDialog from './ReceiptDialog.svelte'
import RevokeButton from './RevokeButton.svelte'
import { shownReceipt } from './shown-receipt.svelte'

afterEach(() => {
  vi.unstubAllGlobals()
  shownReceipt.value = undefined
})

it('the receipt of a revocation stays when the button is gone with the consents', async () => {
  serve({
    'POST /revocations': () => ({
      revocationId: 'r1',
      revokedAt: '2026-11-21T10:00:00Z',
      revokedBy: 'eva',
      open: 0,
      fields: [],
      writers: [],
      signature: 's',
    }),
  })
  const { unmount } = render(RevokeButton, { what: { recipientId: 'acme' }, fieldCount: 1 })
  await userEvent.click(screen.getByRole('button', { name: 'Revoke' }))
  await userEvent.click(screen.getByRole('button', { name: 'Revoke now' }))
  await vi.waitFor(() => {
    expect(shownReceipt.value?.revocationId).toBe('r1')
  })
  unmount()
  render(ReceiptDialog)
  expect(screen.getByRole('heading', { name: 'Receipt' })).toBeTruthy()
  await userEvent.click(screen.getAllByRole('button', { name: 'Close' }).at(-1) as HTMLElement)
  expect(screen.queryByRole('heading', { name: 'Receipt' })).toBeNull()
})
