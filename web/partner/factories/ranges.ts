/** Numbers with runs drawn together: "3, 5–9". At most eight runs, then an ellipsis. */
export function ranges(numbers: readonly number[]): string {
  const RUNS_MAX = 8
  const runs: [number, number][] = []
  for (const number of [...numbers].sort((a, b) => a - b)) {
    const last = runs.at(-1)
    if (last !== undefined && number <= last[1] + 1) last[1] = number
    else runs.push([number, number])
  }
  const texts = runs
    .slice(0, RUNS_MAX)
    .map(([first, last]) => (first === last ? `${first}` : `${first}–${last}`))
  return runs.length > RUNS_MAX ? `${texts.join(', ')} …` : texts.join(', ')
}
