import { numberText } from '@/format/value'
import type { MappingFault, MappingStatus } from '../api/types'
import { texts } from '../language/texts'

/** Where a mapping went wrong. */
export function placeOf(fault: MappingFault): string {
  const where =
    fault.step == null ? texts.work.atEnd : texts.work.atFunction(numberText(fault.step + 1))
  return fault.line == null
    ? where
    : `${where}, ${texts.work.atLine(fault.line, fault.column ?? 1)}`
}

/** What a value costs on average; nothing while none came. */
export function timeForEach({ spentUs, received }: MappingStatus): string | undefined {
  if (received === 0) return undefined
  const us = Number((spentUs / received).toPrecision(2))
  return us < 1_000
    ? texts.work.microseconds(numberText(us))
    : texts.work.milliseconds(numberText(us / 1_000))
}
