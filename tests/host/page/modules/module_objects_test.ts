import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { pageSignal } from '../support/page_signal.js';
import { groupsOf, ModuleObjects } from '../../../../host/page/source/modules/module_objects.js';
import type { ObjectValue } from '../../../../host/page/source/wire/messages.js';

const valueOf = (node: number, name: string, group = 'joint'): ObjectValue => ({ node, object: '0x6080', name, group, value: '720 deg/s' });

function reader() {
  const node = pageSignal<number | null>(3);
  const asked: { name: string; words: object; resolve(value: unknown): void; reject(error: Error): void }[] = [];
  const operations = { ask: (name: string, words: object) => new Promise<unknown>((resolve, reject) => void asked.push({ name, words, resolve, reject })) };
  const objects = new ModuleObjects(operations as never, node as never);
  return { node, asked, objects };
}

describe('the objects of a module', () => {
  it('are forgotten with another module, and a late answer has no effect', async () => {
    const { node, asked, objects } = reader();
    const first = objects.readIfNew();
    node.value = 4;
    const second = objects.readIfNew();
    asked[0]?.resolve({ values: [valueOf(3, 'late')] });
    await first;
    assert.equal(objects.reading.value, null);
    assert.equal(objects.isReading.value, true);
    asked[1]?.resolve({ values: [valueOf(4, 'speed'), valueOf(5, 'of another')] });
    await second;
    assert.deepEqual(objects.groups.value.flatMap(({ values }) => values.map(({ name }) => name)), ['speed']);
    await objects.readIfNew();
    assert.equal(asked.length, 2);
  });

  it('say why they cannot be read, and are not asked for again by themselves', async () => {
    const { asked, objects } = reader();
    const reading = objects.readIfNew();
    asked[0]?.reject(new Error('node 3 does not answer'));
    await reading;
    assert.equal(objects.problem.value, 'node 3 does not answer');
    await objects.readIfNew();
    assert.equal(asked.length, 1);
  });

  it('are read again when one was written', async () => {
    const { asked, objects } = reader();
    const written = objects.write('0x6080', '300', true);
    assert.deepEqual([asked[0]?.name, asked[0]?.words], ['modules.set', { node: 3, object: '0x6080', value: '300', store: true }]);
    asked[0]?.resolve({ text: 'node 3: 300' });
    assert.equal(await written, 'node 3: 300');
    assert.equal(asked[1]?.name, 'modules.read');
  });

  it('are in the groups of the program, and are found by words', () => {
    const values = [valueOf(3, 'Max speed'), valueOf(3, 'Temperature', 'state'), { ...valueOf(3, 'Limit'), help: 'of the speed' }];
    assert.deepEqual(groupsOf(values, '').map(({ name, values: members }) => [name, members.length]), [['joint', 2], ['state', 1]]);
    assert.deepEqual(groupsOf(values, 'SPEED').map(({ name, values: members }) => [name, members.length]), [['joint', 2]]);
    assert.deepEqual(groupsOf(values, 'speed limit')[0]?.values.map(({ name }) => name), ['Limit']);
    assert.deepEqual(groupsOf(values, 'none'), []);
  });
});
