// Exceptions from advisories: each with a reason and the day until which it holds.

/** @typedef {{ registry: 'cargo' | 'npm', id: string, reason: string, until: string }} Exception */
/** @typedef {{ registry: 'cargo' | 'npm', id: string, where: string, text: string }} Finding */

/** Longest time for which an exception may hold, in days. */
const DAYS_MAX = 180
const DAY = 24 * 60 * 60 * 1000

/**
 * Returns what is wrong with the exceptions themselves on a day, `YYYY-MM-DD`.
 *
 * @param {Exception[]} exceptions
 * @param {string} today
 */
export function faultsOf(exceptions, today) {
  return exceptions.flatMap(({ registry, id, reason, until }) => {
    const faults = []
    if (!['cargo', 'npm'].includes(registry)) faults.push('its registry is cargo or npm')
    if (!/^(RUSTSEC|GHSA|YANKED)-/.test(id ?? '')) faults.push('it names no advisory')
    if (!reason || reason.length < 20) faults.push('it has no reason')
    if (!/^\d{4}-\d\d-\d\d$/.test(until ?? '')) faults.push('it says no day until which it holds')
    else if (until < today) faults.push(`it held until ${until}`)
    else if (Date.parse(until) - Date.parse(today) > DAYS_MAX * DAY)
      faults.push(`it holds for more than ${DAYS_MAX} days`)
    return faults.map((fault) => `exception ${id}: ${fault}`)
  })
}

/**
 * Returns findings that no exception covers, and exceptions that cover none: of a registry that could
 * not be asked, none is known to be unneeded.
 *
 * @param {Finding[]} findings
 * @param {Exception[]} exceptions
 * @param {Set<string>} asked
 */
export function compare(findings, exceptions, asked) {
  const covers = (/** @type {Exception} */ one, /** @type {Finding} */ finding) =>
    one.registry === finding.registry && one.id === finding.id
  const open = findings.filter((finding) => !exceptions.some((one) => covers(one, finding)))
  const unneeded = exceptions.filter(
    (one) => asked.has(one.registry) && !findings.some((finding) => covers(one, finding)),
  )
  return [
    ...open.map(({ id, where, text }) => `${id} in ${where}: ${text}`),
    ...unneeded.map(({ id }) => `exception ${id}: nothing needs it any more`),
  ]
}
