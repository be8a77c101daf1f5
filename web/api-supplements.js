// Schemas of members that the descriptions of the APIs leave open.
const ref = (/** @type {string} */ name) => ({ $ref: `#/components/schemas/${name}` })
const optional = (/** @type {object} */ schema) => ({ oneOf: [schema, { type: 'null' }] })
const oneOf = (/** @type {string[]} */ ...values) => ({ type: 'string', enum: values })
const text = { type: 'string' }
const count = { type: 'integer' }
const optionalText = { type: ['string', 'null'] }
const optionalCount = { type: ['integer', 'null'] }

/** @param {Record<string, object>} required @param {Record<string, object>} [others] */
const object = (required, others = {}) => ({
  type: 'object',
  required: Object.keys(required),
  properties: { ...required, ...others },
})

export const platformSupplements = () => ({
  schemas: {
    ReportedValue: object({ value: {} }, { status: optionalText, sourceTimestamp: optionalText }),
  },
  members: {
    'FieldView.value': {},
    'Report.fields': { type: 'object', additionalProperties: ref('ReportedValue') },
  },
})

/**
 * The schema with members that may be left out instead of such with a default.
 *
 * @param {{ properties: Record<string, { default?: unknown }> }} known
 */
const withoutDefaults = ({ properties, ...others }) => ({
  ...others,
  properties: Object.fromEntries(
    Object.entries(properties).map(([name, { default: _, ...schema }]) => [name, schema]),
  ),
})

/** Members of a ledger entry that depend on its kind. */
const ledgerSubject = object(
  {},
  {
    operationNetworkId: optionalText,
    operationId: optionalText,
    dynamicDataRequestId: optionalText,
    fieldName: optionalText,
    policy: optional(ref('DisclosurePolicy')),
    mappingState: optional(ref('MappingState')),
    decidedBy: optionalText,
    dataSetWriterId: optionalCount,
    epoch: optionalCount,
    firstSequence: optionalCount,
    lastSequence: optionalCount,
    lastDeliveredSequence: optionalCount,
  },
)

export const connectorSupplements = () => ({
  schemas: {
    OperationSummary: object(
      { operationId: text, operationType: text },
      { name: optionalText, plannedStart: optionalText, plannedEnd: optionalText },
    ),
    LinkStatus: object(
      { state: text },
      {
        since: optionalText,
        lastAcceptedAt: optionalText,
        lastReceiptedAt: optionalText,
        backlog: count,
        reason: optionalText,
      },
    ),
    LeaseParty: object({ instanceId: text, host: text, since: text, lastHeardAt: text }),
    LeaseStatus: object(
      { state: oneOf('ASKING', 'HELD', 'REFUSED'), since: text, host: text },
      {
        leaseNumber: optionalCount,
        holder: optional(ref('LeaseParty')),
        contender: optional(ref('LeaseParty')),
      },
    ),
    SpoolStatus: object({ waiting: count, sent: count, bytes: count }, { oldestAt: optionalText }),
    TwinStatus: object({}, { endpointUrl: optionalText }),
    // Any part of a policy and of the monitoring options may be left out.
    DisclosurePolicy: withoutDefaults,
    MonitorOptions: withoutDefaults,
    Identity: (/** @type {{ oneOf: { properties: object }[] }} */ known) => ({
      ...known,
      oneOf: known.oneOf.map((variant) =>
        'userName' in variant.properties
          ? { ...variant, properties: { ...variant.properties, password: text } }
          : variant,
      ),
    }),
    Versioned_Rule: {
      allOf: [ref('DocumentVersion'), ref('Rule'), object({ changedBy: text, changedAt: text })],
    },
    SourceView: { allOf: [ref('SourceConfig'), ref('SourceStatus')] },
    EntryView: (/** @type {{ allOf: object[] }} */ known) => ({
      allOf: [ledgerSubject, ...known.allOf.slice(1)],
    }),
  },
  members: {
    'EntryView.value': { type: ['object', 'null'], additionalProperties: {} },
    'EntryResult.result': oneOf('TAKEN', 'REPEATED', 'REFUSED'),
    'RequestView.operation': ref('OperationSummary'),
    'RuleCondition.namePattern': optionalText,
    'Status.lease': ref('LeaseStatus'),
    'Status.link': optional(ref('LinkStatus')),
    'Status.spool': ref('SpoolStatus'),
    'Status.twin': ref('TwinStatus'),
  },
})
