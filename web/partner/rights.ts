import type { SignedIn } from '@/transport/session.svelte'

/**
 * True for those who may change networks and requests at all. The platform decides; pages only
 * leave out what it would refuse.
 */
export function mayPlan(who: SignedIn | undefined): boolean {
  return who !== undefined && who.role !== 'VIEWER'
}

/** True where the person may change or end what belongs to the organisation. */
export function mayChange(who: SignedIn | undefined, owner: string | null | undefined): boolean {
  if (who === undefined || !mayPlan(who)) return false
  return who.role === 'ADMINISTRATOR' || (owner != null && owner === who.organisationId)
}

/** True for those who run the platform. */
export function mayAdminister(who: SignedIn | undefined): boolean {
  return who?.role === 'ADMINISTRATOR'
}

/** True where the person sees what concerns the organisation alone. */
export function isOwn(who: SignedIn | undefined, owner: string | null | undefined): boolean {
  return mayAdminister(who) || (owner != null && owner === who?.organisationId)
}
