// Writes the symbols of engineering units for the pages from the table of the model.
// `npm run generate` after the table changed; a test fails while they differ.
import { readFileSync, writeFileSync } from 'node:fs'

const HEADER = '// Generated from asi-model/units/units.tsv by `npm run generate`. Do not edit.\n\n'
const TABLE = new URL('../asi-model/units/units.tsv', import.meta.url)
/** The file of the symbols. */
export const SYMBOLS = new URL('./format/unit-symbols.generated.ts', import.meta.url)

/** Symbols by common code and by alias, as a source file. */
export function symbolsOf() {
  const rows = readFileSync(TABLE, 'utf8')
    .split('\n')
    .map((line) => line.split('\t'))
    .filter(([, , , symbol]) => symbol)
  const lines = rows.map(
    ([code, alias, , symbol]) =>
      `  ${JSON.stringify([code, alias, symbol]).replaceAll(',', ', ')},`,
  )
  return `${HEADER}/** Common code of UNECE Recommendation 20, alias and symbol. */\nexport const UNIT_SYMBOLS: readonly (readonly [string, string, string])[] = [\n${lines.join('\n')}\n]\n`
}

if (process.argv[1] === new URL(import.meta.url).pathname) writeFileSync(SYMBOLS, symbolsOf())
