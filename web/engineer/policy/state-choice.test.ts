import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { describe, expect, it, vi } from 'vitest'
import WithholdList from './WithholdList.svelte'

describe('the condition that withholds', () => {
  const show = (own: string | null): ReturnType<typeof vi.fn> => {
    const onchange = vi.fn()
    render(WithholdList, {
      conditions: [{ states: ['Interrupted', 'OfOld'] }, { field: 'phase', states: [3] }],
      siblings: [{ name: 'phase' }, { name: 'state', semantic: 'OPERATION_STATE' }],
      semantic: own,
      onchange,
    })
    return onchange
  }

  it('is chosen among the states of operations, where the field is one', async () => {
    const onchange = show('OPERATION_STATE')
    expect(screen.getByLabelText<HTMLInputElement>('Interrupted').checked).toBe(true)
    expect(screen.getByLabelText<HTMLInputElement>('OfOld').checked).toBe(true)
    await userEvent.click(screen.getByLabelText('Running'))
    expect(onchange).toHaveBeenCalledWith([
      { states: ['Running', 'Interrupted', 'OfOld'] },
      { field: 'phase', states: [3] },
    ])
  })
  it('is written for any other value', () => {
    show(null)
    expect(screen.queryByRole('checkbox')).toBeNull()
    expect(screen.getByLabelText<HTMLInputElement>('States 1').value).toBe('Interrupted; OfOld')
  })
})
