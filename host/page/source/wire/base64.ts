// The bytes of a text in base64 (RFC 4648). Throws a DOMException for another text.
export function decodeBase64(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
}
