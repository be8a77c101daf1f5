/** What the API itself refuses. */
export const problemsCodes: Record<string, string> = {
  ALREADY_EXISTS: 'Diese Kennung gibt es schon. Wählen Sie eine andere.',
  BUSY: 'Es wird zu viel auf einmal verlangt. Versuchen Sie es gleich noch einmal.',
  CHANGED:
    'Eine andere Änderung kam dazwischen. Sehen Sie sie an und versuchen Sie es dann noch einmal.',
  DECIDED_SINCE:
    'Das Feld ist nicht mehr so, wie es gezeigt wurde: Es wurde anders entschieden, oder die Anfrage wurde geändert. Sehen Sie es an, bevor Sie entscheiden.',
  FORBIDDEN: 'Ihre Rolle erlaubt das nicht.',
  INCOMPLETE_ADDRESS: 'Ein Teil der Adresse fehlt. Nennen Sie auch das Netz und den Vorgang.',
  INTERNAL: 'Im Server ging etwas schief. Sein Protokoll sagt, was.',
  INVALID_CURSOR: 'Die Liste hat sich geändert. Laden Sie die Seite neu.',
  INVALID_IF_MATCH:
    'Die Version, die geändert werden soll, ist nicht richtig benannt. Laden Sie die Seite neu.',
  INVALID_NAME: 'Ein Name hat 1 bis 64 sichtbare Zeichen.',
  INVALID_PATH: 'Diese Adresse ist ungültig.',
  INVALID_QUERY: 'Der Filter ist ungültig. Prüfen Sie Ihre Eingabe.',
  INVALID_SEARCH: 'Eine Suche hat höchstens 200 Zeichen.',
  INVALID_TIME: 'Das Ende muss nach dem Beginn liegen.',
  INVALID_USER: 'Diese Person lässt sich so nicht hinzufügen. Prüfen Sie Name, Rolle und Passwort.',
  IN_FORCE: 'Das ist noch in Kraft und muss zuerst beendet werden.',
  LAST_ENGINEER:
    'Das ist der letzte Ingenieur. Machen Sie zuerst eine andere Person zum Ingenieur.',
  LIMIT_REACHED: 'Es gibt schon so viele, wie es geben darf. Entfernen Sie zuerst etwas davon.',
  METHOD_NOT_ALLOWED:
    'Das kann der Server hier nicht. Laden Sie die Seite neu: Sie ist vielleicht von einer älteren Version.',
  NAME_REFUSED: 'Geben Sie dem Passkey einen Namen mit 1 bis 64 Zeichen.',
  NOT_BEGUN: 'Beginnen Sie mit einem neuen Geheimnis und bestätigen Sie es dann.',
  NOT_FOUND: 'Das gibt es nicht, oder Sie sind nicht daran beteiligt.',
  NOT_SIGNED_IN: 'Melden Sie sich zuerst an.',
  NOT_WRITTEN:
    'Es ließ sich nicht auf die Platte schreiben, darum wurde nichts geändert. Lassen Sie die Platte des Datenverzeichnisses prüfen.',
  NAME_WAS_USED:
    'Eine Person, die gegangen ist, hatte diesen Namen. Wählen Sie einen anderen: Im Protokoll stehen Personen damit.',
  NO_DOCUMENT: 'Der Server nannte keinen Grund.',
  NO_PAGES: 'Dieses Programm wurde ohne seine Seiten gebaut.',
  NO_TEXT: 'Geben Sie 1 bis 256 Zeichen ein, nach denen gesucht wird.',
  OTHER_ID: 'Die Kennung im Dokument ist eine andere als in der Adresse.',
  PASSKEYS_UNAVAILABLE:
    'Browser legen für diese Seiten keine Passkeys an: Dafür braucht es HTTPS und einen Hostnamen.',
  PASSKEY_KNOWN:
    'Dieser Schlüssel, dieses Telefon oder Gerät hat schon einen Passkey für dieses Konto.',
  PASSKEY_REFUSED: 'Der Passkey wurde nicht angenommen. Versuchen Sie es noch einmal.',
  PASSWORD_REFUSED:
    'Dieses Passwort wird abgelehnt: Wählen Sie eines mit mindestens zehn Zeichen, das schwer zu erraten ist.',
  PASSWORD_NEEDED:
    'Das Passwort galt für einen anderen Benutzer oder eine andere Adresse. Geben Sie es noch einmal ein, damit es nirgends sonst hingeht.',
  QUOTA_EXCEEDED:
    'Das ist mehr, als Ihre Organisation hier haben darf. Entfernen Sie zuerst etwas, oder fragen Sie einen Administrator.',
  REVISION_CONFLICT:
    'Eine andere Änderung war schneller: Fassung {revision} gilt. Sehen Sie sie an und versuchen Sie es dann noch einmal.',
  SECOND_FACTOR_NEEDED: 'Zum Anmelden brauchen Sie auch Ihren zweiten Faktor.',
  SECOND_FACTOR_ON: 'Ein zweiter Faktor ist schon an. Schalten Sie ihn zuerst aus.',
  SECOND_FACTOR_SEALED:
    'Codes der App lassen sich jetzt nicht prüfen. Verwenden Sie einen Wiederherstellungscode, oder lassen Sie den zweiten Faktor entfernen.',
  SIGN_IN_AGAIN: 'Melden Sie sich neu an und tun Sie es dann.',
  STOPPING: 'Das Programm wird gerade beendet. Versuchen Sie es, wenn es wieder läuft.',
  TOO_EXPENSIVE:
    'Das zu lesen dauert zu lange. Fragen Sie nach weniger auf einmal oder versuchen Sie es später.',
  TOO_MANY_BODIES: 'Sie senden zu viel auf einmal. Versuchen Sie es in {seconds} s noch einmal.',
  TOO_MANY_CHANGES: 'Sie ändern zu viel auf einmal. Versuchen Sie es in {seconds} s noch einmal.',
  TOO_MANY_DOWNLOADS: 'Es laufen zu viele Downloads zugleich. Warten Sie, bis einer fertig ist.',
  TOO_MANY_PASSKEYS: 'Sie haben so viele Passkeys, wie man haben darf. Entfernen Sie zuerst einen.',
  TOO_MANY_READS: 'Sie lesen zu viel auf einmal. Versuchen Sie es in {seconds} s noch einmal.',
  TOO_MANY_REQUESTS:
    'In kurzer Zeit wurde zu viel verlangt. Versuchen Sie es in {seconds} s noch einmal.',
  TOO_MANY_STREAMS: 'Es sind zu viele Seiten offen. Schließen Sie eine.',
  TOO_MANY_VARIABLES:
    'Auf einmal lassen sich höchstens {most} Variablen lesen. Wählen Sie weniger aus.',
  TOO_SLOW: 'Das Senden dauerte zu lange. Versuchen Sie es noch einmal.',
  UNKNOWN_ROUTE:
    'Das gibt es auf dem Server nicht. Laden Sie die Seite neu: Sie ist vielleicht von einer anderen Version.',
  UNREADABLE_BODY: 'Das Gesendete lässt sich nicht lesen. Versuchen Sie es noch einmal.',
  WRONG_CODE: 'Der Code ist nicht richtig. Codes wechseln alle 30 Sekunden.',
  WRONG_CONTENT_TYPE: 'Diese Art von Datei wird hier nicht angenommen.',
  WRONG_CREDENTIALS: 'Benutzername oder Passwort ist nicht richtig.',
  WRONG_CSRF_TOKEN: 'Ihre Sitzung hat sich geändert. Laden Sie die Seite neu.',
  WRONG_PASSWORD: 'Das jetzige Passwort ist nicht richtig.',
}
