/** Comment as both pages show it. */
export interface Comment {
  id: string
  /** Author as the reader knows them. */
  author: string
  isOwn: boolean
  writtenAt: string
  text: string
  /** Request that it is about; the whole network without one. */
  dynamicDataRequestId?: string | null | undefined
  fieldName?: string | null | undefined
}
