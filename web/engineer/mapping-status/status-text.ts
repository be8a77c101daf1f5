import { numberText } from '@/format/value'
import type { MappingFault, MappingStatus } from '../api/types'
import { texts } from '../language/texts'

/** Position of a fault: its function, and its line in a script. */
export function placeOf(fault: MappingFault): string {
  const where =
    fault.step == null
      ? texts.mappingStatus.atEnd
      : texts.mappingStatus.atFunction(numberText(fault.step + 1))
  return fault.line == null
    ? where
    : `${where}, ${texts.mappingStatus.atLine(fault.line, fault.column ?? 1)}`
}

/** Mean computing time of a value; undefined while none was received. */
export function timeForEach({ spentUs, received }: MappingStatus): string | undefined {
  if (received === 0) return undefined
  const us = Number((spentUs / received).toPrecision(2))
  return us < 1_000
    ? texts.mappingStatus.microseconds(numberText(us))
    : texts.mappingStatus.milliseconds(numberText(us / 1_000))
}
