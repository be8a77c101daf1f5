import type { Tone } from '@/design/tone'

/** Connected with everything live is good; connected with something missing is not. */
export function sourceTone(source: { state: string; live: number; inputs: number }): Tone {
  if (source.state === 'connected') return source.live < source.inputs ? 'warn' : 'good'
  return source.state === 'waiting' ? 'bad' : 'warn'
}
