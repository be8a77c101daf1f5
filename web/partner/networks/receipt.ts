import type { RevocationEntry } from '../api/types'

/** Receipt of a revocation as far as the page shows it. What is signed is the text alone. */
export interface ShownReceipt {
  revokedAt: string | undefined
  reason: string | undefined
  fieldNames: string[]
  /** Last sequence number that the platform had confirmed. */
  lastDelivered: number | undefined
}

interface SignedText {
  revokedAt?: string
  reason?: string
  fields?: { field?: { fieldName?: string } }[]
  writers?: { lastDeliveredSequence?: number | null }[]
}

/** Reads the signed text; what cannot be read is left out. */
export function receiptOf(signedText: string): ShownReceipt {
  let text: SignedText = {}
  try {
    text = JSON.parse(signedText) as SignedText
  } catch {
    // The saved receipt has the text; here it says nothing.
  }
  return {
    revokedAt: text.revokedAt,
    reason: text.reason,
    fieldNames: (text.fields ?? []).flatMap(({ field }) => field?.fieldName ?? []),
    lastDelivered: text.writers?.[0]?.lastDeliveredSequence ?? undefined,
  }
}

/** Link to a file that `asi ledger receipt` verifies. */
export function receiptFile({ signedText, signature, publicKey }: RevocationEntry): string {
  const text = JSON.stringify({ signedText, signature, publicKey }, undefined, 2)
  return `data:application/json;charset=utf-8,${encodeURIComponent(text)}`
}
