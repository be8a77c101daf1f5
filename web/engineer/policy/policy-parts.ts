const NUMERIC = [
  'SByte',
  'Byte',
  'Int16',
  'UInt16',
  'Int32',
  'UInt32',
  'Int64',
  'UInt64',
  'Float',
  'Double',
]

/** Whether values of this type can be rounded. */
export function isNumber(type: string): boolean {
  return NUMERIC.includes(type)
}

/** A number as it is typed; nothing where nothing is. */
export function numberOf(written: string): number | null {
  return written.trim() === '' ? null : Number(written)
}

/** Bounds of bands as they are typed, in order; what is no number is left out. */
export function bandsOf(written: string): number[] {
  return written
    .split(';')
    .map((part) => part.trim().replace(',', '.'))
    .filter((part) => part !== '' && Number.isFinite(Number(part)))
    .map(Number)
    .toSorted((a, b) => a - b)
}

/** How far this place's clock is ahead of UTC now, in minutes. */
export function utcOffsetMinutes(now = new Date()): number {
  // The platform's function counts the other way round; adding 0 makes of its -0 a 0.
  return -now.getTimezoneOffset() + 0
}
