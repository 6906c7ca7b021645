// Pixels of an element, as the user sees them.
import type { Locator, Page } from 'playwright-core';
import { waitUntil } from './waiting.js';

export interface Pixels {
  width: number;
  height: number;
  data: Uint8Array; // red, green, blue, alpha
}

export async function pixelsOf(page: Page, element: Locator): Promise<Pixels> {
  return pixelsOfPicture(page, await element.screenshot());
}

// The browser decodes the PNG.
export async function pixelsOfPicture(page: Page, picture: Buffer): Promise<Pixels> {
  const { width, height, encoded } = await page.evaluate(async (image) => {
    const bytes = Uint8Array.from(atob(image), (character) => character.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = canvas.getContext('2d') as OffscreenCanvasRenderingContext2D;
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    // As base64: an array of a million numbers takes half a minute on its way here.
    const parts: string[] = [];
    for (let start = 0; start < data.length; start += 4096) {
      parts.push(String.fromCharCode(...data.subarray(start, start + 4096)));
    }
    return { width: bitmap.width, height: bitmap.height, encoded: btoa(parts.join('')) };
  }, picture.toString('base64'));
  return { width, height, data: new Uint8Array(Buffer.from(encoded, 'base64')) };
}

// Pixels whose red, green and blue fulfil the condition.
export function countPixels({ data }: Pixels, matches: (red: number, green: number, blue: number) => boolean): number {
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (matches(data[i] as number, data[i + 1] as number, data[i + 2] as number)) count += 1;
  }
  return count;
}

// Looks until the number of pixels of the element that match is as expected: a view may need a while for its next picture.
// Returns the last number, expected or not.
export async function countPixelsWhen(
  page: Page,
  element: Locator,
  matches: (red: number, green: number, blue: number) => boolean,
  isExpected: (count: number) => boolean,
): Promise<number> {
  let count = 0;
  await waitUntil(async () => isExpected((count = countPixels(await pixelsOf(page, element), matches))));
  return count;
}

// Pixels that fulfil the condition, and all others up to three pixels beside and above them.
export function pixelsInside(
  { width, height, data }: Pixels,
  matches: (red: number, green: number, blue: number) => boolean,
): { x: number; y: number }[] {
  const margin = 3;
  const fulfils = (x: number, y: number) => {
    const at = 4 * (y * width + x);
    return matches(data[at] as number, data[at + 1] as number, data[at + 2] as number);
  };
  const offsets = Array.from({ length: 2 * margin + 1 }, (_, i) => i - margin);
  const inside: { x: number; y: number }[] = [];
  for (let y = margin; y < height - margin; y += 1) {
    for (let x = margin; x < width - margin; x += 1) {
      if (offsets.every((down) => offsets.every((right) => fulfils(x + right, y + down)))) inside.push({ x, y });
    }
  }
  return inside;
}

export function countDifferences(a: Pixels, b: Pixels, least = 24): number {
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    const difference = [0, 1, 2].some((channel) => Math.abs((a.data[i + channel] as number) - (b.data[i + channel] as number)) > least);
    if (difference) count += 1;
  }
  return count;
}

// Links and head are blue in both themes.
export const isBlue = (red: number, green: number, blue: number) => blue > red + 25 && blue > 60 && blue >= green;
