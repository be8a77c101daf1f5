import { words } from '@/language/words'
import { UNIT_SYMBOLS } from './unit-symbols.generated'

const SYMBOLS = new Map(
  UNIT_SYMBOLS.flatMap(([code, alias, symbol]) => [
    [code, symbol],
    [alias, symbol],
  ]),
)

/** Numbers without a unit. */
const DIMENSIONLESS = new Set(['C62', 'ONE'])

/** Unit as people write it, by its common code or alias: `kW` for `KWT`. What has no symbol is left as it is. */
export function unitText(unit: string | null | undefined): string {
  if (unit == null || DIMENSIONLESS.has(unit)) return ''
  return words.unit[unit] ?? SYMBOLS.get(unit) ?? unit
}
