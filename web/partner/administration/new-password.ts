/** Random bytes of a password: more than anybody can guess, short enough to type. */
const BYTES = 15

/** A new password of 20 letters, digits, - and _, made in this browser. */
export function newPassword(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(BYTES))
  const text = btoa(String.fromCharCode(...bytes))
  return text.replaceAll('+', '-').replaceAll('/', '_')
}
