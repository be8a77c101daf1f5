import type { Tone } from '@/design/tone'
import { texts } from '../language/texts'

/** The link's state in words; a state we have no words for as it is. */
export function linkText(state: string): string {
  return texts.link.state[state.toLowerCase()] ?? state
}

export function linkTone(state: string): Tone {
  const known = state.toLowerCase()
  if (known === 'connected' || known === 'online') return 'good'
  return known === 'connecting' ? 'warn' : 'bad'
}
