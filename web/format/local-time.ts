/** Text of a `datetime-local` input, in this machine's time zone, to the second. */
export function toLocalInput(at: string | number | Date): string {
  const date = new Date(at)
  if (Number.isNaN(date.getTime())) return ''
  const two = (number: number): string => String(number).padStart(2, '0')
  const day = [date.getFullYear(), two(date.getMonth() + 1), two(date.getDate())].join('-')
  return `${day}T${[date.getHours(), date.getMinutes(), date.getSeconds()].map(two).join(':')}`
}

/** ISO 8601 in UTC of the text of a `datetime-local` input; `undefined` if it is none. */
export function fromLocalInput(written: string): string | undefined {
  const isLocal = /^\d{4,}-\d{2}-\d{2}T\d{2}:\d{2}(:\d{2}(\.\d+)?)?$/.test(written)
  const at = new Date(isLocal ? written : Number.NaN)
  return Number.isNaN(at.getTime()) ? undefined : at.toISOString()
}
