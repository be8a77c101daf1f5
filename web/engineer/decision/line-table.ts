import { parseLiteral, writeLiteral } from './step-catalogue'

/**
 * Parameters entered as lines of two columns: lookup entries and texts of an enumeration or of
 * bits.
 */
export type TableKind = 'table' | 'texts' | 'bits'

export interface Line {
  from: string
  to: string
}

/** The lines that a parameter's value amounts to. */
export function toLines(kind: TableKind, value: unknown): Line[] {
  if (!Array.isArray(value)) return []
  if (kind === 'texts')
    return (value as { value: number; text: string }[]).map((entry) => ({
      from: String(entry.value),
      to: entry.text,
    }))
  return kind === 'table'
    ? (value as { from: unknown; to: unknown }[]).map((entry) => ({
        from: writeLiteral(entry.from),
        to: writeLiteral(entry.to),
      }))
    : (value as { bit: number; text: string }[]).map((entry) => ({
        from: String(entry.bit),
        to: entry.text,
      }))
}

/** The value of the lines that are complete; others are still being typed. */
export function fromLines(kind: TableKind, lines: readonly Line[]): unknown {
  const complete = lines.filter((line) => line.from.trim() !== '')
  if (kind === 'table')
    return complete
      .filter((line) => line.to.trim() !== '')
      .map((line) => ({ from: parseLiteral(line.from), to: parseLiteral(line.to) }))
  const numbered = complete.filter((line) => /^-?\d+$/.test(line.from.trim()))
  return kind === 'texts'
    ? numbered.map((line) => ({ value: Number(line.from), text: line.to }))
    : numbered.map((line) => ({ bit: Number(line.from), text: line.to }))
}
