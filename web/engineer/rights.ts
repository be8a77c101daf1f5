import { session } from '@/transport/session.svelte'

/**
 * True for those who decide on fields and set the connector up. The connector decides; pages only
 * leave out what it would refuse.
 */
export function mayDecide(): boolean {
  return session.who?.role === 'ENGINEER'
}

/** True for those who enter values and write comments. */
export function mayOperate(): boolean {
  return mayDecide() || session.who?.role === 'OPERATOR'
}
