/** Schemas of the platform for the pages, under another name only where their own says too little here. */
import type { EventOf } from '@/transport/live.svelte'
import type { components } from '@/api/platform.generated'

type Schemas = components['schemas']

/** Entry of the record of who read a factory's values. */
export type AccessRetentionEntry = Schemas['AccessRetentionEntry']
export type AccessView = Schemas['AccessView']
export type AuditEntry = Schemas['AuditEntry']
export type AuditFact = Schemas['AuditFact']
export type Collaboration = Schemas['Collaboration']
export type CommentEntry = Schemas['CommentEntry']
/** What a removal ends, and what is in its way. */
export type Removal = Schemas['Removal']
export type DisclosureStatement = Schemas['DisclosureStatement']
export type DynamicDataRequest = Schemas['DynamicDataRequest']
export type EnrolmentToken = Schemas['TokenView']
export type Factory = Schemas['Factory']
export type FieldKey = Schemas['FieldKey']
/** Requested field with its decision and its newest value. */
export type FieldView = Schemas['FieldView']
export type LeaseParty = Schemas['Party']
export type LeaseView = Schemas['LeaseView']
/** Data of the live events with a name. */
export type LiveData<Name extends LiveEvent['event']> = EventOf<LiveEvent, Name>['data']
/** Live event with its name and its data. */
export type LiveEvent = Schemas['LiveEvent']
export type NetworkSummary = Schemas['NetworkSummary']
export type NetworkView = Schemas['NetworkView']
export type Operation = Schemas['Operation']
export type OperationNetwork = Schemas['OperationNetwork']
export type OperationProgress = Schemas['OperationProgress']
export type OperationRelation = Schemas['OperationRelation']
export type Organisation = Schemas['Organisation']
/** Part of a network that concerns one factory. */
export type PartView = Schemas['PartView']
/** Role of a person on the platform. */
export type Role = Schemas['Role']
export type RelationCondition = Schemas['RelationCondition']
export type ReportField = Schemas['ReportField']
/** Signed receipt of a revocation. */
export type RevocationEntry = Schemas['RevocationEntry']
export type Tool = Schemas['Tool']
export type ToolCredential = Schemas['ToolCredential']
export type UpdateFrequencyUnit = Schemas['UpdateFrequencyUnit']
export type UserView = Schemas['UserView']
export type WriterView = Schemas['WriterView']
