// What the lists of advisories said when they were asked last, for machines that cannot ask: `asked.json`.
import { existsSync, readFileSync, writeFileSync } from 'node:fs'

/** Days after which the lists have to be asked again. */
export const DAYS_MAX = 45
const DAY = 24 * 60 * 60 * 1000
/** Most packages named in one line. */
const NAMED_MAX = 10

/** @typedef {import('./exceptions.js').Finding} Finding */
/** @typedef {{ asked: string, packages: string[], findings: Finding[] }} Snapshot */

/**
 * Returns the published packages of a lock file, as `cargo name@version` or `npm name@version`.
 *
 * @param {string} file
 * @param {string} text
 * @returns {string[]}
 */
export function packagesOf(file, text) {
  if (file.endsWith('package-lock.json')) {
    const entries = Object.entries(JSON.parse(text).packages)
    return entries.flatMap(([place, { version, name, link }]) => {
      const at = place.lastIndexOf('node_modules/')
      if (at < 0 || link) return []
      return [`npm ${name ?? place.slice(at + 'node_modules/'.length)}@${version}`]
    })
  }
  return text.split('[[package]]').flatMap((part) => {
    const of = (/** @type {string} */ key) => new RegExp(`^${key} = "(.*)"$`, 'm').exec(part)?.[1]
    return of('source') ? [`cargo ${of('name')}@${of('version')}`] : []
  })
}

/**
 * Returns why a snapshot does not stand for lists that cannot be had on a day, `YYYY-MM-DD`.
 *
 * @param {Snapshot} snapshot
 * @param {string[]} packages of the lock files as they are
 * @param {string} today
 * @returns {string[]}
 */
export function faultsOfSnapshot(snapshot, packages, today) {
  const { asked } = snapshot
  const remedy =
    'run `make advisories` on a machine that reaches the lists, and commit its asked.json'
  if (!/^\d{4}-\d\d-\d\d$/.test(asked ?? '')) return [`asked.json says no day: ${remedy}`]
  const faults = []
  const days = (Date.parse(today) - Date.parse(asked)) / DAY
  if (days < 0) faults.push(`asked.json is of a day to come, ${asked}: ${remedy}`)
  if (days > DAYS_MAX)
    faults.push(`the lists were asked ${days} days ago, more than ${DAYS_MAX}: ${remedy}`)
  const known = new Set(snapshot.packages)
  const unknown = [...new Set(packages)].filter((one) => !known.has(one)).sort()
  if (unknown.length) {
    const more = unknown.length > NAMED_MAX ? ` and ${unknown.length - NAMED_MAX} more` : ''
    const named = unknown.slice(0, NAMED_MAX).join(', ')
    faults.push(`the lists were never asked about ${named}${more}: ${remedy}`)
  }
  return faults
}

/**
 * Returns the findings of now, with those of the snapshot in place of lists that could not be had.
 *
 * @param {Finding[]} findings
 * @param {Set<string>} asked registries whose lists were had
 * @param {Snapshot | undefined} snapshot
 * @returns {Finding[]}
 */
export function completed(findings, asked, snapshot) {
  const kept = snapshot?.findings.filter(({ registry }) => !asked.has(registry)) ?? []
  const key = (/** @type {Finding} */ one) => `${one.registry} ${one.id} ${one.where}`
  return [...new Map([...kept, ...findings].map((one) => [key(one), one])).values()]
}

/**
 * Reads the snapshot; undefined where none was ever committed.
 *
 * @param {string | URL} file
 * @returns {Snapshot | undefined}
 */
export function readSnapshot(file) {
  return existsSync(file) ? JSON.parse(readFileSync(file, 'utf8')) : undefined
}

/**
 * Writes what the lists said, each package and finding once and in order.
 *
 * @param {string | URL} file
 * @param {Snapshot} snapshot
 */
export function writeSnapshot(file, { asked, packages, findings }) {
  const sorted = { asked, packages: [...new Set(packages)].sort(), findings }
  writeFileSync(file, `${JSON.stringify(sorted, undefined, 2)}\n`)
}
