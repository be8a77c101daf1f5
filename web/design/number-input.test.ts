import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { decimalOf, decimalText } from '@/format/decimal'
import { language } from '@/language/language.svelte'
import NumberInput from './NumberInput.svelte'

afterEach(() => {
  language.choose('en')
})

it.each([
  ['en', '0,5', 0.5],
  ['en', '0.5', 0.5],
  ['de', '0,5', 0.5],
  ['de', ' -12,25 ', -12.25],
  ['en', '1,000', undefined],
  ['de', '1.000', undefined],
  ['de', '1,000', 1],
  ['en', '1e3', 1000],
  ['en', '5 kg', undefined],
  ['en', '', undefined],
  ['en', '.', undefined],
] as const)('in %s, %j is %s', (code, written, number) => {
  language.choose(code)
  expect(decimalOf(written)).toBe(number)
})

describe('the input of a number', () => {
  const show = (value: number | null, min?: number): ReturnType<typeof vi.fn> => {
    const onchange = vi.fn()
    const attributes = { 'aria-label': 'Step' }
    render(NumberInput, { value, onchange, attributes, ...(min === undefined ? {} : { min }) })
    return onchange
  }
  const input = (): HTMLInputElement => screen.getByLabelText('Step')

  it('takes a decimal comma, whatever the language of the browser', async () => {
    const onchange = show(null)
    await userEvent.type(input(), '0,5')
    expect(onchange).toHaveBeenLastCalledWith(0.5)
    expect(input().value).toBe('0,5')
  })
  it('keeps the number where the text is none, and says so', async () => {
    const onchange = show(2.5)
    expect(input().value).toBe(decimalText(2.5))
    await userEvent.type(input(), 'x')
    expect(onchange).not.toHaveBeenCalled()
    expect(input().getAttribute('aria-invalid')).toBe('true')
    await userEvent.tab()
    expect(input().value).toBe('2.5')
    expect(input().getAttribute('aria-invalid')).toBeNull()
  })
  it('takes nothing below the least, and no number where it is emptied', async () => {
    const onchange = show(3, 0)
    await userEvent.clear(input())
    expect(onchange).toHaveBeenLastCalledWith(undefined)
    await userEvent.type(input(), '-1')
    expect(onchange).toHaveBeenLastCalledWith(undefined)
  })
  it('is sent by Enter as it is seen, and not at all where it is no number', async () => {
    let value: number | undefined = 5
    const sent: unknown[] = []
    const form = document.body.appendChild(document.createElement('form'))
    const send = form.appendChild(document.createElement('button'))
    send.type = 'submit'
    form.addEventListener('submit', (event) => {
      event.preventDefault()
      sent.push(value)
    })
    const onchange = (number: number | undefined): void => {
      value = number
      void view.rerender({ value })
    }
    const attributes = { 'aria-label': 'Step' }
    const view = render(NumberInput, { target: form, props: { value, onchange, attributes } })
    await userEvent.clear(input())
    await userEvent.type(input(), '0,70{Enter}')
    expect(sent).toEqual([0.7])
    expect(input().value).toBe(decimalText(0.7))
    await userEvent.clear(input())
    await userEvent.type(input(), '1,000{Enter}')
    expect(sent).toEqual([0.7])
    expect(input().value).toBe('1,000')
    expect(input().validationMessage).toContain('no number')
    form.remove()
  })
  it('takes no beginning of a number that is refused: 1.000 is not 1', async () => {
    const onchange = show(5)
    await userEvent.clear(input())
    await userEvent.type(input(), language.code === 'de' ? '1.000' : '1,000')
    expect(input().getAttribute('aria-invalid')).toBe('true')
    expect(onchange).toHaveBeenLastCalledWith(undefined)
  })
})
