import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { sendMesh, type MeshFile } from '../../../../host/page/source/make/mesh_transfer.js';

function file(name: string, bytes: Uint8Array): MeshFile {
  return { name, size: bytes.length, slice: (from, to) => ({ arrayBuffer: async () => bytes.slice(from, to).buffer }) };
}

// A program that keeps what it gets.
class Program {
  readonly received: string[] = [];
  readonly names: string[] = [];
  longest = 0;
  waiting = 0;
  most = 0;
  refuses = '';

  async ask(name: string, words: unknown): Promise<unknown> {
    this.names.push(name);
    this.most = Math.max(this.most, ++this.waiting);
    await new Promise((resolve) => setImmediate(resolve));
    this.waiting -= 1;
    if (name === this.refuses) throw new Error('refused');
    const part = words as { file: number; data: string };
    if (name === 'mesh.part') {
      this.longest = Math.max(this.longest, JSON.stringify(words).length);
      this.received[part.file] = (this.received[part.file] ?? '') + Buffer.from(part.data, 'base64').toString('latin1');
    }
    return { mesh: 7 };
  }
}

const bytes = Uint8Array.from({ length: 200_001 }, (_, i) => (i * 7919) % 256);
const transfer = { isCancelled: () => false, progress: () => {} };

describe('the transfer of a mesh', () => {
  it('sends all bytes of all files in parts that fit into a message', async () => {
    const program = new Program();
    const shares: number[] = [];
    await sendMesh(program as never, [file('a.obj', bytes), file('a.mtl', bytes.slice(0, 10))], { ...transfer, progress: (share) => shares.push(share) });
    assert.equal(program.received[0], Buffer.from(bytes).toString('latin1'));
    assert.equal(program.received[1], Buffer.from(bytes.slice(0, 10)).toString('latin1'));
    assert.ok(program.longest < 64 * 1024 - 300, `${program.longest} characters`);
    assert.ok(program.most <= 9, `${program.most} operations at once`);
    assert.equal(shares.at(-1), 1);
    assert.equal(program.names.at(-1), 'mesh.look');
  });

  it('ends with the reason of a refusal', async () => {
    for (const refuses of ['mesh.begin', 'mesh.part', 'mesh.look']) {
      const program = new Program();
      program.refuses = refuses;
      await assert.rejects(sendMesh(program as never, [file('a.stl', bytes)], transfer), /refused/);
    }
  });

  it('that is cancelled is forgotten by the program', async () => {
    const program = new Program();
    assert.equal(await sendMesh(program as never, [file('a.stl', bytes)], { ...transfer, isCancelled: () => program.received.length > 0 }), null);
    assert.deepEqual(program.names.slice(-1), ['mesh.drop']);
    assert.ok(!program.names.includes('mesh.look'));
  });
});
