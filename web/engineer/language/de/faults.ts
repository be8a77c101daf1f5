import type { MappingDiagnostic, MappingFault } from '../../api/types'

export const faults = {
  /** Faults of a mapping document. */
  diagnostics: {
    tooMany: 'Die Zuordnung hat zu viele Eingänge oder Funktionen.',
    missing: 'Etwas, das gebraucht wird, fehlt.',
    invalidName: 'Dieser Name ist nicht erlaubt: Verwenden Sie Buchstaben, Ziffern und _.',
    unknownName: 'Kein Eingang heißt so.',
    invalidParameter: 'Diese Einstellung der Funktion ist nicht erlaubt.',
    typeMismatch: 'Der Typ passt nicht zur Funktion oder zum angefragten Feld.',
    lossyConversion: 'Stellen oder Nachkommastellen können verloren gehen.',
    unknownUnit: 'Diese Einheit ist nicht bekannt.',
    incompatibleUnits: 'Diese Einheiten messen Verschiedenes: Sie lassen sich nicht umrechnen.',
    unitMismatch: 'Die Einheit am Ende ist nicht die angefragte. Fügen Sie eine Umrechnung hinzu.',
    syntax: 'Das lässt sich nicht lesen: Prüfen Sie Klammern, Kommas und Schreibweise.',
    workerUnavailable: 'Das Skript lässt sich zurzeit nicht ausprobieren.',
    scriptFault: 'Das Skript ist beim Laden gescheitert.',
    closureState:
      'Zustand außerhalb von ctx.state geht bei jedem Neustart verloren. Halten Sie ihn in ctx.state.',
    unusedInput: 'Keine Funktion verwendet diesen Eingang.',
  } satisfies Record<MappingDiagnostic['code'], string>,
  /** Faults at a value. */
  valueFaults: {
    typeMismatch: 'Der Wert ist von anderem Typ, als die Funktion braucht.',
    outOfRange: 'Der Wert liegt außerhalb des Bereichs des Typs.',
    decoding: 'Der Wert lässt sich nicht lesen.',
    scriptSyntax: 'Das Skript hat einen Schreibfehler.',
    scriptError: 'Das Skript ist gescheitert.',
    scriptTimeout: 'Das Skript brauchte länger, als es darf.',
    scriptOutOfMemory: 'Das Skript brauchte mehr Speicher, als es darf.',
    scriptResult: 'Das Skript gab etwas zurück, das kein Wert des Feldes ist.',
    scriptCrash: 'Der Prozess des Skripts ist beendet.',
    workerUnavailable: 'Zurzeit läuft kein Prozess für Skripte.',
    circuitOpen: 'Es ist zu oft gescheitert und ruht eine Weile.',
  } satisfies Record<MappingFault['kind'], string>,
}
