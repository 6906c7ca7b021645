// Colours as a field of the browser has them: "#ff8000".

export function toHex(colour: readonly number[]): string {
  return `#${colour.map((part) => Math.round(255 * part).toString(16).padStart(2, '0')).join('')}`;
}

export function fromHex(text: string): [number, number, number] {
  const part = (start: number) => Math.round((parseInt(text.slice(start, start + 2), 16) / 255) * 1000) / 1000;
  return [part(1), part(3), part(5)];
}
