// Makes a picture of a panel: its canvases in their places, and the names of its lines above them.
import { pictureOf } from '../scene/canvas_picture.js';

const titleHeight = 22; // CSS pixels

interface Label {
  text: string;
  colour: string;
}

function labelsOf(panel: Element): Label[] {
  return [...panel.querySelectorAll<HTMLElement>('.line-chips li')].map((chip) => ({
    text: (chip.textContent ?? '').trim().replace(/\s+/g, ' '),
    colour: getComputedStyle(chip.querySelector('.swatch') ?? chip).backgroundColor,
  }));
}

// Makes the picture. Throws an Error if there is nothing to draw.
export async function panelImage(panel: Element, title: string): Promise<Blob> {
  const box = panel.getBoundingClientRect();
  const ratio = window.devicePixelRatio;
  const canvas = document.createElement('canvas');
  canvas.width = Math.max(1, Math.round(box.width * ratio));
  canvas.height = Math.max(1, Math.round((box.height + titleHeight) * ratio));
  const context = canvas.getContext('2d');
  if (context === null || box.width === 0) {
    throw new Error('this panel is not shown');
  }
  context.scale(ratio, ratio);
  const style = getComputedStyle(panel);
  context.fillStyle = style.backgroundColor;
  context.fillRect(0, 0, box.width, box.height + titleHeight);
  context.font = '12px system-ui, sans-serif';
  context.textBaseline = 'middle';
  context.fillStyle = style.color;
  context.fillText(title, 8, titleHeight / 2);
  let x = 16 + context.measureText(title).width;
  for (const { text, colour } of labelsOf(panel)) {
    context.fillStyle = colour;
    context.fillRect(x, titleHeight / 2 - 2, 14, 4);
    context.fillStyle = style.color;
    context.fillText(text, x + 18, titleHeight / 2);
    x += 30 + context.measureText(text).width;
  }
  for (const part of panel.querySelectorAll('canvas')) {
    const place = part.getBoundingClientRect();
    if (place.width > 0) {
      const picture = await pictureOf(part);
      context.drawImage(picture, place.left - box.left, place.top - box.top + titleHeight, place.width, place.height);
    }
  }
  return new Promise((done, failed) => {
    canvas.toBlob((blob) => (blob === null ? failed(new Error('the browser makes no picture')) : done(blob)), 'image/png');
  });
}

export function save(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
