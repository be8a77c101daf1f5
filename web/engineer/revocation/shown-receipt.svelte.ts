import type { StoredRevocation } from '../api/types'

/**
 * Receipt of the revocation that was just made, until its reader closes it. It belongs to no button: requests without
 * consents have none, and filters may hide the request as a whole.
 */
class ShownReceipt {
  value = $state.raw<StoredRevocation>()
}

export const shownReceipt = new ShownReceipt()
