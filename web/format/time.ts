import { language, type LanguageCode } from '@/language/language.svelte'
import { words } from '@/language/words'

const SECOND = 1000
const MINUTE = 60 * SECOND
const HOUR = 60 * MINUTE
const DAY = 24 * HOUR

/** Age as one rounded-down figure: "12 s ago". */
export function age(at: number, now: number): string {
  const past = now - at
  if (past < -SECOND) return words.age.future(span(-past))
  if (past < SECOND) return words.age.now
  if (past < MINUTE) return words.age.seconds(Math.floor(past / SECOND))
  if (past < HOUR) return words.age.minutes(Math.floor(past / MINUTE))
  if (past < 2 * DAY) return words.age.hours(Math.floor(past / HOUR))
  return words.age.days(Math.floor(past / DAY))
}

/** A length of time in its largest whole unit, two figures at most: "1 h 30 min". */
export function span(milliseconds: number): string {
  const units: [number, string][] = [
    [DAY, words.span.d],
    [HOUR, words.span.h],
    [MINUTE, words.span.min],
    [SECOND, words.span.s],
    [1, words.span.ms],
  ]
  const index = units.findIndex(([size]) => milliseconds >= size)
  const [size, name] = units[index] ?? [1, words.span.ms]
  const whole = Math.floor(milliseconds / size)
  const rest = units[index + 1]
  const remainder = rest === undefined ? 0 : Math.floor((milliseconds - whole * size) / rest[0])
  if (rest === undefined || remainder === 0 || size === SECOND)
    return `${decimal(Math.floor((milliseconds / size) * 10) / 10)} ${name}`
  return `${decimal(whole)} ${name} ${decimal(remainder)} ${rest[1]}`
}

/**
 * Parses an ISO 8601 duration without years and months to milliseconds; `undefined` if it is none.
 */
export function isoDuration(text: string): number | undefined {
  const match = /^P(?:(\d+)W)?(?:(\d+)D)?(?:T(?:(\d+)H)?(?:(\d+)M)?(?:(\d+(?:\.\d+)?)S)?)?$/.exec(
    text,
  )
  if (match === null || text === 'P' || text.endsWith('T')) return undefined
  const [weeks, days, hours, minutes, seconds] = match
    .slice(1)
    .map((part) => Number(part ?? 0)) as [number, number, number, number, number]
  return weeks * 7 * DAY + days * DAY + hours * HOUR + minutes * MINUTE + seconds * SECOND
}

/** A moment for reading, to the second, in this machine's time zone. */
export function moment(at: string | number | Date): string {
  return new Intl.DateTimeFormat(language.code === 'de' ? 'de-DE' : 'en-GB', {
    dateStyle: 'medium',
    timeStyle: 'medium',
  }).format(new Date(at))
}

/** A moment as short as a table takes it. */
export function shortMoment(at: string | number | Date): string {
  return new Intl.DateTimeFormat(language.code === 'de' ? 'de-DE' : 'en-GB', {
    day: '2-digit',
    month: 'short',
    hour: '2-digit',
    minute: '2-digit',
  }).format(new Date(at))
}

/** The name of a day of the week, 0 is Monday. */
export function weekday(
  number: number,
  width: 'short' | 'long',
  code: LanguageCode = language.code,
): string {
  // The first of January 2024 was a Monday.
  return new Intl.DateTimeFormat(code === 'de' ? 'de-DE' : 'en-GB', {
    weekday: width,
    timeZone: 'UTC',
  }).format(new Date(Date.UTC(2024, 0, 1 + number)))
}

/** A day for reading. */
export function day(at: string | number | Date): string {
  return new Intl.DateTimeFormat(language.code === 'de' ? 'de-DE' : 'en-GB', {
    dateStyle: 'medium',
  }).format(new Date(at))
}

function decimal(value: number): string {
  return new Intl.NumberFormat(language.code).format(value)
}
