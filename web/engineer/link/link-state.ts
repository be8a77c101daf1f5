import type { Tone } from '@/design/tone'
import type { LinkStatus, Status } from '../api/types'
import { texts } from '../language/texts'

/** Status with a link: one that is not configured until the connector is enrolled. */
export type LinkedStatus = Omit<Status, 'link'> & {
  link: Partial<Omit<LinkStatus, 'state'>> & {
    state: LinkStatus['state'] | 'notConfigured'
    backlog: number
  }
}

export function withLink({ link, ...others }: Status): LinkedStatus {
  return { ...others, link: link ?? { state: 'notConfigured', backlog: others.spool.waiting } }
}

/** Text of a link state; an unknown state is shown as it is. */
export function linkText(state: string): string {
  return texts.link.state[state] ?? state
}

export function linkTone(state: string): Tone {
  if (state === 'up') return 'good'
  return state === 'connecting' ? 'warn' : state === 'notConfigured' ? 'idle' : 'bad'
}

/** Cause for which a link is not up, or sends and receives only in part. */
export function whyDown({ state, isPermanent }: { state: string; isPermanent?: boolean }): string {
  if (state === 'up') return texts.link.why.partly
  return isPermanent === true ? texts.link.why.permanent : texts.link.why.retrying
}
