import { words } from '@/language/words'
import type { Rule } from '../api/types'
import { texts } from '../language/texts'

/** Text of a rule's conditions on one line. */
export function conditionText({ when }: Pick<Rule, 'when'>): string {
  const { partners = [], dataTypes = [], semantics = [], units = [], namePattern } = when
  const parts = [
    partners.length > 0 ? partners.join(', ') : texts.rules.anyPartner,
    ...dataTypes,
    ...semantics.map((semantic) => words.semantic[semantic] ?? semantic),
    ...units,
    ...(namePattern ? [namePattern] : []),
  ]
  return parts.join(' · ')
}

/** A rule to begin with: it means nothing yet and decides nothing. */
export function newRule(): Rule {
  return {
    name: '',
    isEnabled: false,
    when: { partners: [], dataTypes: [], semantics: [], units: [] },
    action: 'PREFILL',
    disclosure: {},
  }
}

/** An id from a name: `Round power to 5 kW` is `round-power-to-5-kw`. */
export function idOf(name: string, taken: readonly string[]): string {
  const base =
    name
      .toLowerCase()
      .normalize('NFKD')
      .replace(/[^a-z0-9]+/g, '-')
      .replace(/^-+|-+$/g, '')
      .slice(0, 50) || 'unnamed'
  let id = base
  for (let number = 2; taken.includes(id); number += 1) id = `${base}-${number}`
  return id
}

/** Splits a list at its commas and drops empty parts. */
export function listOf(written: string): string[] {
  return written
    .split(/[,;]/)
    .map((part) => part.trim())
    .filter((part) => part !== '')
}
