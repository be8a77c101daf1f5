import { existsSync, readFileSync, writeFileSync } from 'node:fs'
import { dirname, join, resolve } from 'node:path'
import { fileURLToPath } from 'node:url'
import type { Plugin } from 'vite'

const INSTALLED = fileURLToPath(new URL('./node_modules/', import.meta.url))

/** A package of which a part is in the pages. */
interface BundledPackage {
  name: string
  version: string
}

/** Folder of the package that a module lies in; undefined for our own modules. */
function folderOf(id: string): string | undefined {
  let folder = dirname(id.split('?')[0] ?? id)
  if (!folder.includes('/node_modules/')) return undefined
  for (; !folder.endsWith('/node_modules'); folder = dirname(folder)) {
    const manifest = join(folder, 'package.json')
    // Some packages have manifests without a name in inner folders.
    if (existsSync(manifest) && /"name"/.test(readFileSync(manifest, 'utf8'))) return folder
  }
  return undefined
}

/**
 * Writes which packages are part of the built pages to a file beside their folder: name and version of
 * each package that a module, a style sheet or a font comes from, and of the build tools whose own
 * code is in the output.
 */
export function bundledPackages(file: string): Plugin {
  const folders = new Set<string>()
  let root = ''
  const add = (id: string | null | undefined): void => {
    if (!id) return
    if (id.startsWith('\0vite/')) folders.add(`${INSTALLED}vite`)
    if (id.startsWith('\0rolldown/')) folders.add(`${INSTALLED}rolldown`)
    const folder = folderOf(id)
    if (folder) folders.add(folder)
  }
  return {
    name: 'bundled-packages',
    apply: 'build',
    configResolved(config) {
      root = config.root
    },
    generateBundle(_options, bundle) {
      // Style sheets leave the modules before the output is made, so all that were read are asked.
      for (const id of this.getModuleIds()) if (id.includes('.css')) add(id)
      for (const output of Object.values(bundle))
        if (output.type === 'chunk') output.moduleIds.forEach(add)
        else for (const original of output.originalFileNames) add(resolve(root, original))
    },
    closeBundle() {
      const packages = [...folders].map((folder): BundledPackage => {
        const manifest = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'))
        return { name: manifest.name, version: manifest.version }
      })
      packages.sort((a, b) => (a.name < b.name ? -1 : 1))
      writeFileSync(file, JSON.stringify(packages, null, 2) + '\n')
    },
  }
}
