import { fireEvent, render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { describe, expect, it, vi } from 'vitest'
import LiteralInput from './LiteralInput.svelte'

const attributes = { 'aria-label': 'Value' }
const state = { type: 'String', semantic: 'OPERATION_STATE' } as const

describe('a constant of a mapping', () => {
  it('for a time is a moment of its type, entered in local time', async () => {
    const onchange = vi.fn()
    render(LiteralInput, {
      value: { type: 'DateTime', value: '2026-11-23T15:00:00.000Z' },
      wanted: { type: 'DateTime' },
      isResult: true,
      attributes,
      onchange,
    })
    const input = screen.getByLabelText<HTMLInputElement>('Value')
    expect(new Date(input.value).toISOString()).toBe('2026-11-23T15:00:00.000Z')
    await fireEvent.input(input, { target: { value: '2026-11-24T06:30' } })
    expect(onchange).toHaveBeenCalledWith({
      type: 'DateTime',
      value: new Date(2026, 10, 24, 6, 30).toISOString(),
    })
  })
  it('for a state is chosen, and proposed where a later function may change it', async () => {
    const onchange = vi.fn()
    const shown = { value: 'Running', wanted: state, attributes, onchange }
    const { unmount } = render(LiteralInput, { ...shown, isResult: true })
    await userEvent.selectOptions(screen.getByLabelText('Value'), 'Interrupted')
    expect(onchange).toHaveBeenCalledWith('Interrupted')
    unmount()
    const { container } = render(LiteralInput, { ...shown, isResult: false })
    expect(container.querySelectorAll('datalist option').length).toBe(6)
  })
})
