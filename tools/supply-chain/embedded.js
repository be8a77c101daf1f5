// Foreign libraries whose sources lie inside crates: no lock file names them, and their weaknesses are
// reported under their own names.
import { readFileSync } from 'node:fs'

/**
 * Crates with C sources that end in a program, each with what is inside and where its version stands.
 * A crate of the list without an entry that fits makes the bill of materials fail, and so does a crate
 * with C sources that is not in it.
 *
 * @type {Record<string, { name: string, licence: string, file: string, version: RegExp }[]>}
 */
const EMBEDDED = {
  'libsqlite3-sys': [
    {
      name: 'sqlite',
      licence: 'blessing',
      file: 'sqlite3/sqlite3.h',
      version: /#define SQLITE_VERSION\s+"([\d.]+)"/,
    },
  ],
  'libmimalloc-sys': [
    {
      name: 'mimalloc',
      licence: 'MIT',
      file: 'c_src/mimalloc/v3/include/mimalloc.h',
      version: /#define MI_MALLOC_VERSION (\d)(\d\d)(\d\d)/,
    },
  ],
  'rquickjs-sys': [
    {
      name: 'quickjs-ng',
      licence: 'MIT',
      file: 'quickjs/quickjs.h',
      version:
        /QJS_VERSION_MAJOR (\d+)\s+#define QJS_VERSION_MINOR (\d+)\s+#define QJS_VERSION_PATCH (\d+)/,
    },
  ],
}

/** Crates whose C sources have no name or version of their own, each with the reason. */
const WITHOUT_NAME = {
  ring: 'parts of BoringSSL without a version, changed by the crate',
  walkdir: 'a program for a comparison, which is not built',
}

/** Returns the libraries inside a crate whose sources lie in a folder. */
export function embeddedIn(/** @type {string} */ crate, /** @type {string} */ folder) {
  return (EMBEDDED[crate] ?? []).map(({ name, licence, file, version }) => {
    const found = version.exec(readFileSync(`${folder}/${file}`, 'utf8'))
    if (!found) throw new Error(`${crate} does not say which ${name} it has`)
    const parts = found.slice(1).map((part) => part.replace(/^0+(?=\d)/, ''))
    return { name, licence, version: parts.join('.') }
  })
}

/** True for a crate whose C sources are accounted for. */
export const isKnown = (/** @type {string} */ crate) => crate in EMBEDDED || crate in WITHOUT_NAME
