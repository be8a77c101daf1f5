import type { MappingDiagnostic, MappingFault } from '../../api/types'

export const faults = {
  /** Faults of a mapping document. */
  diagnostics: {
    tooMany: 'The mapping has too many inputs or functions.',
    missing: 'Something that is needed is missing.',
    invalidName: 'This name is not allowed: use letters, digits and _.',
    unknownName: 'No input has this name.',
    invalidParameter: 'This setting of the function is not allowed.',
    typeMismatch: 'The type does not fit the function or the requested field.',
    lossyConversion: 'Digits or fractions may get lost.',
    unknownUnit: 'This unit is not known.',
    incompatibleUnits: 'These units measure different things: they cannot be converted.',
    unitMismatch: 'The unit at the end is not the one that was asked for. Add a conversion.',
    syntax: 'This cannot be read: check parentheses, commas and spelling.',
    workerUnavailable: 'The script cannot be tried at present.',
    scriptFault: 'The script failed when it was loaded.',
    closureState: 'State outside of ctx.state is lost with each restart. Keep it in ctx.state.',
    unusedInput: 'No function uses this input.',
  } satisfies Record<MappingDiagnostic['code'], string>,
  /** Faults at a value. */
  valueFaults: {
    typeMismatch: 'The value is of another type than the function needs.',
    outOfRange: 'The value does not fit the range of the type.',
    decoding: 'The value cannot be decoded.',
    scriptSyntax: 'The script has a mistake in writing.',
    scriptError: 'The script failed.',
    scriptTimeout: 'The script took longer than it may.',
    scriptOutOfMemory: 'The script used more memory than it may.',
    scriptResult: 'The script returned something that is no value of the field.',
    scriptCrash: 'The process of the script ended.',
    workerUnavailable: 'No process for scripts is running at present.',
    circuitOpen: 'It failed too often and rests for a while.',
  } satisfies Record<MappingFault['kind'], string>,
}
