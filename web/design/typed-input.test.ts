import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { describe, expect, it, vi } from 'vitest'
import { toLocalInput } from '@/format/local-time'
import TypedInput from './TypedInput.svelte'

const attributes = { 'aria-label': 'Value' }

describe('the control of a value', () => {
  it('is a calendar for times, with the present moment at hand', async () => {
    const onchange = vi.fn()
    render(TypedInput, { type: 'DateTime', written: '', onchange, attributes })
    expect(screen.getByLabelText<HTMLInputElement>('Value').type).toBe('datetime-local')
    await userEvent.click(screen.getByRole('button', { name: 'Now' }))
    const [[now]] = onchange.mock.calls as [[string]]
    expect(now.slice(0, 10)).toBe(toLocalInput(Date.now()).slice(0, 10))
  })
  it('is a choice for the states of operations', async () => {
    const onchange = vi.fn()
    render(TypedInput, {
      type: 'String',
      semantic: 'OPERATION_STATE',
      written: 'OfOld',
      onchange,
      attributes,
    })
    const select = screen.getByLabelText<HTMLSelectElement>('Value')
    expect(select.value).toBe('OfOld')
    await userEvent.selectOptions(select, 'Ready to start')
    expect(onchange).toHaveBeenCalledWith('AllowedToStart')
  })
  it('is a choice of two for Boolean, and a field for numbers and text', () => {
    const onchange = vi.fn()
    const { unmount } = render(TypedInput, { type: 'Boolean', written: '', onchange, attributes })
    expect(screen.getAllByRole('option').map((option) => option.textContent)).toEqual([
      '–',
      'true',
      'false',
    ])
    unmount()
    render(TypedInput, { type: 'Double', written: '1,5', onchange, attributes })
    expect(screen.getByLabelText<HTMLInputElement>('Value').inputMode).toBe('decimal')
  })
})
