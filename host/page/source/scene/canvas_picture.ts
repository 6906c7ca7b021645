// Pictures of canvases on which a worker draws. The page itself sees of such a canvas what the browser has shown last:
// nothing, if the worker has only begun.
const sources = new WeakMap<HTMLCanvasElement, () => Promise<ImageBitmap>>();

export function setPictureSource(canvas: HTMLCanvasElement, source: () => Promise<ImageBitmap>): void {
  sources.set(canvas, source);
}

export async function pictureOf(canvas: HTMLCanvasElement): Promise<CanvasImageSource> {
  const source = sources.get(canvas);
  return source === undefined ? canvas : source();
}
