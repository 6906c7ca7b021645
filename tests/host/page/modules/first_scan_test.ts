import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { ModulesApp } from '../../../../host/page/source/modules/modules_app.js';
import { ActionList } from '../../../../host/page/source/state/actions.js';
import { PageState } from '../../../../host/page/source/state/page_state.js';
import type { BusDocument, ModulesDocument } from '../../../../host/page/source/wire/messages.js';
import { pageSignal } from '../support/page_signal.js';
import { jobOf } from './module_job.js';

// The page Modules of a program whose answers the test gives.
function page() {
  const state = new PageState();
  const scans: { answer: (job: number) => Promise<void>; refuse: () => Promise<void> }[] = [];
  const settled = () => new Promise<void>((done) => setImmediate(done));
  const ask = (name: string) =>
    new Promise((answer, refuse) => {
      if (name !== 'modules.scan') return;
      scans.push({ answer: (job) => (answer({ job }), settled()), refuse: () => (refuse(new Error('busy')), settled()) });
    });
  const operations = { ask, tell: ask };
  const app = new ModulesApp({
    actions: new ActionList(),
    modulesActions: pageSignal(null),
    operations,
    shownPage: pageSignal('modules'),
    startSceneWorker: () => assert.fail('no worker'),
    state,
  } as never);
  const connect = () => (state.connection.value = { state: 'open', client: 1, program: 'test', nextNotice: 0 });
  const open = (bus: string | null) => {
    state.bus.value = bus === null ? null : ({ address: bus, connected: true, modules: [] } as unknown as BusDocument);
    state.modules.value = { bus, found: null, robot: null, images: [], settings: [], offers: [] } as unknown as ModulesDocument;
  };
  connect();
  return { state, app, scans, connect, open };
}

describe('the first scan of a bus', { timeout: 60_000 }, () => {
  it('is begun once, and no other job before it', async () => {
    const { state, app, scans, open } = page();
    open('can0');
    assert.equal(scans.length, 1);
    assert.equal(app.obstacle(false), 'Wait until “Scan” has ended.');
    await scans[0]!.answer(3);
    assert.equal(app.obstacle(false), 'Wait until “Scan” has ended.', 'its document has not come');
    state.moduleJob.value = jobOf({ number: 3, kind: 'scan' });
    assert.match(app.obstacle(false) ?? '', /has ended, or cancel it/);
    state.moduleJob.value = jobOf({ number: 3, kind: 'scan', state: 'ended', status: 0 });
    assert.equal(app.obstacle(false), null);
    assert.equal(scans.length, 1);
  });

  it('blocks no other job if it is refused', async () => {
    const { app, scans, open } = page();
    open('can0');
    await scans[0]!.refuse();
    assert.equal(app.obstacle(false), null);
    assert.equal(scans.length, 1);
  });

  it('is forgotten when the bus is closed before its answer comes', async () => {
    const { app, scans, open } = page();
    open('can0');
    open(null);
    await scans[0]!.answer(3);
    open('can1');
    assert.equal(scans.length, 2);
    await scans[1]!.refuse();
    assert.equal(app.obstacle(false), null);
  });

  it('is made anew by another program, which counts its jobs from 1', async () => {
    const { state, app, scans, connect, open } = page();
    open('can0');
    await scans[0]!.answer(30);
    state.connection.value = { state: 'lost', attempts: 1 };
    connect();
    assert.equal(scans.length, 2);
    await scans[1]!.answer(1);
    state.moduleJob.value = jobOf({ number: 1, kind: 'scan', state: 'ended', status: 0 });
    assert.equal(app.obstacle(false), null);
  });
});
