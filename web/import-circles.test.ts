// @vitest-environment node
import { readFileSync, readdirSync } from 'node:fs'
import path from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, it } from 'vitest'

const ROOT = fileURLToPath(new URL('.', import.meta.url)).replace(/\/$/, '')
const LEFT_OUT = new Set(['node_modules', 'dist', 'public'])

/** Paths of all sources below a folder. */
function sources(folder: string): string[] {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const at = path.join(folder, entry.name)
    if (entry.isDirectory()) return LEFT_OUT.has(entry.name) ? [] : sources(at)
    return /\.(ts|svelte)$/.test(entry.name) ? [at] : []
  })
}

/** Imported file of ours; `undefined` for packages. Types are left out: they are gone at run time. */
function imported(from: string, specifier: string, files: Set<string>): string | undefined {
  const base = specifier.startsWith('@/')
    ? path.join(ROOT, specifier.slice(2))
    : specifier.startsWith('.')
      ? path.resolve(path.dirname(from), specifier)
      : undefined
  if (base === undefined) return undefined
  return [base, `${base}.ts`, `${base}/index.ts`].find((file) => files.has(file))
}

/** Imports of each file by the files that they lead to. */
function importsOf(files: string[], read: (file: string) => string): Map<string, string[]> {
  const known = new Set(files)
  const edges = new Map<string, string[]>()
  for (const file of files) {
    const found = read(file).matchAll(
      /^\s*(?:import|export)\s(?!type\b)(?:[^'"]*?from\s*)?['"]([^'"]+)['"]/gm,
    )
    const targets = [...found].map(([, specifier = '']) => imported(file, specifier, known))
    edges.set(
      file,
      targets.filter((target) => target !== undefined),
    )
  }
  return edges
}

/** The files of one circle, its first one again at the end; empty where there is none. */
function circle(edges: Map<string, string[]>): string[] {
  const done = new Set<string>()
  const way: string[] = []
  const visit = (file: string): string[] => {
    const at = way.indexOf(file)
    if (at >= 0) return [...way.slice(at), file]
    if (done.has(file)) return []
    way.push(file)
    for (const next of edges.get(file) ?? []) {
      const found = visit(next)
      if (found.length > 0) return found
    }
    way.pop()
    done.add(file)
    return []
  }
  for (const file of edges.keys()) {
    const found = visit(file)
    if (found.length > 0) return found
  }
  return []
}

it('no files of the pages import each other in a circle', () => {
  const files = sources(ROOT)
  const edges = importsOf(files, (file) => readFileSync(file, 'utf8'))
  expect(files.length).toBeGreaterThan(100)
  expect([...edges.values()].flat().length).toBeGreaterThan(300)
  expect(circle(edges).map((file) => path.relative(ROOT, file))).toEqual([])
})

it('a circle over three files is found, through either kind of path', () => {
  const texts = new Map([
    ['a/a.ts', "import { b } from './b'\n"],
    ['a/b.ts', "import type { a } from './a'\nimport {\n  C,\n} from '@/c/C.svelte'\n"],
    ['c/C.svelte', "<script>\n  import '../a/a'\n</script>\n"],
  ])
  const read = (file: string): string => texts.get(path.relative(ROOT, file)) ?? ''
  const files = [...texts.keys()].map((file) => path.join(ROOT, file))
  const found = circle(importsOf(files, read)).map((file) => path.relative(ROOT, file))
  expect(found).toEqual(['a/a.ts', 'a/b.ts', 'c/C.svelte', 'a/a.ts'])
  texts.set('c/C.svelte', '')
  expect(circle(importsOf(files, read))).toEqual([])
})
