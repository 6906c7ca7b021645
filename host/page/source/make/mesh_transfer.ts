// Sends mesh files to the program in parts: a message is at most 64 KiB.
import type { OperationQueue } from '../state/operations.js';
import type { SentMesh } from '../wire/messages.js';

const partBytes = 45_000; // 60,000 characters in base64
const partsOnTheWay = 8;

function base64(bytes: Uint8Array): string {
  let text = '';
  const step = 0x2000; // arguments of a call
  for (let at = 0; at < bytes.length; at += step) text += String.fromCharCode(...bytes.subarray(at, at + step));
  return btoa(text);
}

export interface Transfer {
  isCancelled(): boolean;
  progress(share: number): void; // 0 to 1
}

// What a person has dropped or chosen.
export interface MeshFile {
  name: string;
  size: number;
  slice(from: number, to: number): { arrayBuffer(): Promise<ArrayBuffer> };
}

// Returns what the program says about the mesh; null if it was cancelled. Throws the reason of a refusal.
export async function sendMesh(operations: Pick<OperationQueue, 'ask'>, files: readonly MeshFile[], transfer: Transfer): Promise<SentMesh | null> {
  const { mesh } = (await operations.ask('mesh.begin', { files: files.map(({ name, size }) => ({ name, bytes: size })) })) as { mesh: number };
  const total = files.reduce((sum, { size }) => sum + size, 0);
  let received = 0;
  const waiting: Promise<unknown>[] = [];
  for (const [number, file] of files.entries()) {
    for (let at = 0; at < file.size; at += partBytes) {
      if (waiting.length >= partsOnTheWay) await waiting.shift();
      const bytes = new Uint8Array(await file.slice(at, Math.min(file.size, at + partBytes)).arrayBuffer());
      if (transfer.isCancelled()) break;
      const sent = operations.ask('mesh.part', { mesh, file: number, at, data: base64(bytes) }).then(() => {
        received += bytes.length;
        transfer.progress(received / total);
      });
      sent.catch(() => {}); // it is awaited later
      waiting.push(sent);
    }
  }
  await Promise.all(waiting);
  const read = transfer.isCancelled() ? null : ((await operations.ask('mesh.look', { mesh })) as SentMesh);
  if (read !== null && !transfer.isCancelled()) return read;
  await operations.ask('mesh.drop', { mesh }).catch(() => {});
  return null;
}
