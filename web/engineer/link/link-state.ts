import type { Tone } from '@/design/tone'
import { texts } from '../language/texts'

/** The link's state in words; a state we have no words for as it is. */
export function linkText(state: string): string {
  return texts.link.state[state] ?? state
}

export function linkTone(state: string): Tone {
  if (state === 'up') return 'good'
  return state === 'connecting' ? 'warn' : state === 'notConfigured' ? 'idle' : 'bad'
}
