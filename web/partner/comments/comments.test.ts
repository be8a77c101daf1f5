import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { Resource } from '@/transport/resource.svelte'
import { session } from '@/transport/session.svelte'
import { serve } from '../../vitest.server'
import type { CommentEntry, DynamicDataRequest } from '../api/types'
import CommentButton from './CommentButton.svelte'
import { commentsOf } from './network-comments'

const request = {
  dynamicDataRequestId: 'r',
  requesterId: 'acme',
  recipientList: ['acme'],
  purpose: 'Plan',
  reportDataFormat: { reportName: 'Progress', reportFieldList: [{ name: 'made', type: 9 }] },
} as unknown as DynamicDataRequest
const comment = (more: Partial<CommentEntry>): CommentEntry => ({
  commentId: 'c1',
  authorId: 'eva@FOR_MUC',
  createdAt: '2027-01-01T08:00:00Z',
  dynamicDataRequestId: 'r',
  factoryId: 'FOR_MUC',
  isFromFactory: true,
  text: 'We measure it next week.',
  ...more,
})
const PATH = '/operation-networks/n/comments'

beforeEach(() => {
  sessionStorage.clear()
  session.state = {
    is: 'signedIn',
    who: { userName: 'bob', role: 'PLANNER', csrfToken: 't', organisationId: 'acme' },
  }
})
afterEach(() => {
  vi.unstubAllGlobals()
})

it('what a factory writes is read beside the request, and answered', async () => {
  const log = serve({
    [`GET ${PATH}`]: ({ path }) =>
      path.includes('cursor=c1')
        ? { items: [comment({ commentId: 'c2', text: 'Now we do.' })] }
        : {
            items: [
              comment({ commentId: 'c0', dynamicDataRequestId: 'other' }),
              comment({ commentId: 'c00', factoryId: 'INS_HAM' }),
              comment({}),
            ],
            nextCursor: 'c1',
          },
    [`POST ${PATH}`]: () => comment({ commentId: 'c3', isFromFactory: false }),
  })
  const comments = new Resource((signal) => commentsOf('n', signal))
  void comments.refresh()
  render(CommentButton, {
    networkId: 'n',
    comments,
    operationName: 'Mill',
    factoryId: 'FOR_MUC',
    request,
  })
  const button = await screen.findByRole('button', { name: 'Comments: r' })
  await vi.waitFor(() => {
    expect(button.textContent.trim()).toBe('2 comments')
  })
  await userEvent.click(button)
  await screen.findByText('We measure it next week.')
  expect(screen.getAllByText('eva@FOR_MUC')).toHaveLength(2)
  expect(screen.getAllByRole('listitem')).toHaveLength(2)
  await userEvent.selectOptions(screen.getByLabelText('About'), 'made')
  await userEvent.type(screen.getByLabelText(/^Your comment/), 'Thank you')
  await userEvent.click(screen.getByRole('button', { name: 'Send' }))
  expect(log.find(({ method }) => method === 'POST')?.body).toEqual({
    factoryId: 'FOR_MUC',
    dynamicDataRequestId: 'r',
    fieldName: 'made',
    text: 'Thank you',
  })
})
