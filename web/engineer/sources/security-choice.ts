import type { SecurityChoice, SourceConfig } from '../api/types'

/** The choice of security as one text, for the options of a selection. */
export function keyOf(choice: SecurityChoice): string {
  return choice.choice === 'exactly' ? `${choice.policy} ${choice.mode}` : choice.choice
}

/** The part of a source that a test tries. */
export function tried({
  endpointUrl,
  security,
  identity,
  sendsPasswordUnprotected,
}: SourceConfig): string {
  return JSON.stringify([endpointUrl, security, identity, sendsPasswordUnprotected])
}
