// What the pages are built from: packages of which the build found a part in the output.
import { readFileSync } from 'node:fs'
import { ROOT } from './programs.js'

/** Folder that the packages of the pages are installed in. */
export const INSTALLED = `${ROOT}/web/node_modules`

/** @typedef {{ name: string, version: string, licence: string, sha512: string, needs: string[] }} PagesPackage */

/**
 * Returns the packages in the built pages of an app, `engineer` or `partner`, with what the lock file
 * says of them.
 *
 * @returns {PagesPackage[]}
 */
export function packagesOf(/** @type {string} */ app) {
  const file = `${ROOT}/web/dist/${app}.packages.json`
  /** @type {{ name: string, version: string }[]} */
  const found = JSON.parse(readFileSync(file, 'utf8'))
  const lock = JSON.parse(readFileSync(`${ROOT}/web/package-lock.json`, 'utf8'))
  const names = new Set(found.map(({ name }) => name))
  return found.map(({ name, version }) => {
    const locked = lock.packages[`node_modules/${name}`]
    if (locked?.version !== version) throw new Error(`the lock file has no ${name} ${version}`)
    return {
      name,
      version,
      licence: locked.license,
      sha512: Buffer.from(locked.integrity.replace(/^sha512-/, ''), 'base64').toString('hex'),
      needs: Object.keys(locked.dependencies ?? {}).filter((needed) => names.has(needed)),
    }
  })
}
