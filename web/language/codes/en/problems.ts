/** What the API itself refuses. */
export const problemsCodes: Record<string, string> = {
  ALREADY_EXISTS: 'There is one with this id already. Choose another id.',
  BUSY: 'Too much is asked at once. Try again in a moment.',
  CHANGED: 'Another change came in between. Look at it, then try again.',
  DECIDED_SINCE:
    'The field is no longer as it was shown: another decision was taken, or the request was changed. Look at it before you decide.',
  FORBIDDEN: 'Your role does not allow this.',
  INCOMPLETE_ADDRESS: 'A part of the address is missing. Name the network and the operation, too.',
  INTERNAL: 'Something went wrong in the server. Its log says what.',
  INVALID_CURSOR: 'The list has changed. Load the page again.',
  INVALID_IF_MATCH: 'The version to be changed is not named rightly. Load the page again.',
  INVALID_NAME: 'A name has 1 to 64 visible characters.',
  INVALID_PATH: 'This address is not valid.',
  INVALID_QUERY: 'The filter is not valid. Check what you entered.',
  INVALID_SEARCH: 'A search has at most 200 characters.',
  INVALID_TIME: 'The end has to be later than the beginning.',
  INVALID_USER: 'This person cannot be added like that. Check name, role and password.',
  IN_FORCE: 'This is still in force and has to be ended first.',
  LAST_ENGINEER: 'This is the last engineer. Make another person an engineer first.',
  LIMIT_REACHED: 'There are as many already as there may be. Remove one first.',
  METHOD_NOT_ALLOWED:
    'The server cannot do this here. Load the page again: it may be of an older version.',
  NAME_REFUSED: 'Give the passkey a name of 1 to 64 characters.',
  NOT_BEGUN: 'Begin with a new secret, then confirm it.',
  NOT_FOUND: 'This does not exist, or you have no part in it.',
  NOT_SIGNED_IN: 'Sign in first.',
  NOT_WRITTEN:
    'It could not be written to disk, so nothing was changed. Have the disk of the data directory checked.',
  NAME_WAS_USED:
    'A person who has left had this name. Choose another one: the record names people by it.',
  NO_DOCUMENT: 'The server gave no reason.',
  NO_PAGES: 'This program was built without its pages.',
  NO_TEXT: 'Enter 1 to 256 characters to look for.',
  OTHER_ID: 'The id in the document differs from that of the address.',
  PASSKEYS_UNAVAILABLE:
    'Browsers make no passkeys for these pages: they need HTTPS and a host name.',
  PASSKEY_KNOWN: 'This key, phone or device has a passkey for this account already.',
  PASSKEY_REFUSED: 'The passkey was not accepted. Try again.',
  PASSWORD_REFUSED:
    'This password is refused: choose one of at least ten characters that is hard to guess.',
  PASSWORD_NEEDED:
    'The password was given for another user or address. Enter it again, so that it goes nowhere else.',
  QUOTA_EXCEEDED:
    'This exceeds what your organisation may have here. Remove something first, or ask an administrator.',
  REVISION_CONFLICT:
    'Another change was faster: revision {revision} is in effect. Look at it, then try again.',
  SECOND_FACTOR_NEEDED: 'Signing in takes your second factor, too.',
  SECOND_FACTOR_ON: 'A second factor is on already. Turn it off first.',
  SECOND_FACTOR_SEALED:
    'Codes of the app cannot be checked now. Use a recovery code, or have the second factor removed.',
  SIGN_IN_AGAIN: 'Sign in again, then do this.',
  STOPPING: 'The program is stopping. Try again when it is back.',
  TOO_EXPENSIVE: 'This takes too long to read. Ask for less at once, or try again later.',
  TOO_MANY_BODIES: 'You send too much at once. Try again in {seconds} s.',
  TOO_MANY_CHANGES: 'You change too much at once. Try again in {seconds} s.',
  TOO_MANY_DOWNLOADS: 'Too many downloads run at once. Wait for one to end.',
  TOO_MANY_PASSKEYS: 'You have as many passkeys as one may have. Remove one first.',
  TOO_MANY_READS: 'You read too much at once. Try again in {seconds} s.',
  TOO_MANY_REQUESTS: 'Too much was asked for in a short time. Try again in {seconds} s.',
  TOO_MANY_STREAMS: 'Too many pages are open. Close one.',
  TOO_MANY_VARIABLES: 'At most {most} variables can be read at once. Choose fewer.',
  TOO_SLOW: 'Sending took too long. Try again.',
  UNKNOWN_ROUTE:
    'The server does not have this. Load the page again: it may be of another version.',
  UNREADABLE_BODY: 'What was sent cannot be read. Try again.',
  WRONG_CODE: 'The code is not right. Codes change every 30 seconds.',
  WRONG_CONTENT_TYPE: 'This kind of file is not accepted here.',
  WRONG_CREDENTIALS: 'User name or password is not right.',
  WRONG_CSRF_TOKEN: 'Your session has changed. Load the page again.',
  WRONG_PASSWORD: 'The present password is not right.',
}
