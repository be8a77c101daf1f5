import { readFileSync } from 'node:fs'
import path from 'node:path'
import { describe, expect, it } from 'vitest'
import { receiptOf } from './receipt'

/** The text that a connector signs for partners, as its own tests hold it. */
const snapshot = readFileSync(
  path.resolve(
    import.meta.dirname,
    '../../../factory-connector/ledger/src/snapshots/ledger__revocation__tests__statement_for_partners.snap',
  ),
  'utf8',
)
const signedText = snapshot.split('\n---\n')[1] ?? ''

describe('the receipt of a revocation', () => {
  it('shows what the connector signed', () => {
    expect(receiptOf(signedText)).toEqual({
      revokedAt: '2027-01-15T08:00:00Z',
      reason: 'Order closed',
      fieldNames: ['count', 'model'],
      lastDelivered: 7,
    })
  })

  it('shows nothing of a text that is none', () => {
    expect(receiptOf('no JSON')).toEqual({
      revokedAt: undefined,
      reason: undefined,
      fieldNames: [],
      lastDelivered: undefined,
    })
  })
})
