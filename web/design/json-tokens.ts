export interface Token {
  kind: 'name' | 'text' | 'number' | 'word' | 'mark'
  text: string
}

const PATTERN =
  /("(?:[^"\\]|\\.)*")(\s*:)?|(-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)|(true|false|null)|([^"\d-]+|-)/g

/** Splits JSON text into coloured tokens; joined they are the text again, also for invalid JSON. */
export function tokens(text: string): Token[] {
  const result: Token[] = []
  let end = 0
  for (const match of text.matchAll(PATTERN)) {
    if (match.index > end) result.push({ kind: 'mark', text: text.slice(end, match.index) })
    end = match.index + match[0].length
    if (match[1] !== undefined) {
      result.push({ kind: match[2] === undefined ? 'text' : 'name', text: match[1] })
      if (match[2] !== undefined) result.push({ kind: 'mark', text: match[2] })
    } else if (match[3] !== undefined) result.push({ kind: 'number', text: match[3] })
    else if (match[4] !== undefined) result.push({ kind: 'word', text: match[4] })
    else result.push({ kind: 'mark', text: match[0] })
  }
  if (end < text.length) result.push({ kind: 'mark', text: text.slice(end) })
  return result
}
