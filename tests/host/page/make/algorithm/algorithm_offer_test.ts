import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { AlgorithmOffer } from '../../../../../host/page/source/make/algorithm/algorithm_offer.js';
import { PageState } from '../../../../../host/page/source/state/page_state.js';
import type { AlgorithmBuild, AlgorithmFolders, MissingAlgorithms } from '../../../../../host/page/source/wire/messages.js';

type Page = ConstructorParameters<typeof AlgorithmOffer>[0];

const missing: MissingAlgorithms = {
  file: 'mine/a.simulation.xml',
  action: 'open',
  error: "a.actuation.xml:3: found unknown algorithm 'my_wave', expected ...",
  algorithms: [
    { name: 'my_wave', folder: 'my_wave', library: '/p/my_wave/build/my_wave.so' },
    { name: 'my_reflex', folder: 'reflex', library: '/p/reflex/build/my_reflex.so' },
  ],
};

const built = (folder: string, state: AlgorithmBuild['state']): AlgorithmBuild => ({
  folder,
  name: folder,
  version: 'a',
  state,
  error: state === 'failed' ? 'stopped' : null,
  done: 0,
  of: 0,
  messages: state === 'failed' ? [{ file: `${folder}.cpp`, line: 3, column: 2, severity: 'error', text: 'bad' }] : [],
});

// A page whose program builds at once; results: of the builds, in their order.
function offerOf(results: AlgorithmBuild['state'][], refusal: string | null = null) {
  const state = new PageState();
  const { algorithmBuild, missingAlgorithms } = state;
  state.receiveStatus({ state: 'open', client: 1, program: 'proleg', nextNotice: 0 });
  missingAlgorithms.value = missing;
  state.algorithmFolders.value = { refusal, folders: [] } as unknown as AlgorithmFolders;
  const asked: string[] = [];
  const page = {
    state,
    operations: {
      ask: (name: string, { folder }: { folder: string }) => {
        asked.push(`${name} ${folder}`);
        const result = results.shift();
        // The documents come behind the answer.
        if (result !== undefined) setTimeout(() => (algorithmBuild.value = built(folder, result)));
        return Promise.resolve({});
      },
    },
  } as unknown as Page;
  const open = (file: string) => {
    asked.push(`open ${file}`);
    missingAlgorithms.value = null;
    return Promise.resolve();
  };
  return { offer: new AlgorithmOffer(page, { start: open, open, restore: open }), asked, state, algorithmBuild, missingAlgorithms };
}

describe('the offer to build what a scenario lacks', () => {
  it('builds all of it, then opens the scenario', async () => {
    const { offer, asked } = offerOf(['passed', 'passed']);
    await offer.accept();
    assert.deepEqual(asked, ['algorithm.build my_wave', 'algorithm.build reflex', 'open mine/a.simulation.xml']);
    assert.equal(offer.problem.value, null);
    assert.equal(offer.building.value, null);
  });

  it('stops at the first one that fails, with the place of the error', async () => {
    const { offer, asked, algorithmBuild } = offerOf(['failed']);
    algorithmBuild.value = built('my_wave', 'passed'); // a build before
    await offer.accept();
    assert.deepEqual(asked, ['algorithm.build my_wave']);
    assert.equal(offer.problem.value, 'The build of my_wave failed: my_wave.cpp, line 3: bad.');
    assert.equal(offer.failed.value?.folder, 'my_wave');
    assert.equal(offer.failed.value?.place?.line, 3);
  });

  it('ends when the connection is lost', async () => {
    const { offer, state } = offerOf([]);
    const accepted = offer.accept();
    await new Promise((resolve) => setTimeout(resolve));
    state.receiveStatus({ state: 'lost', attempts: 1 });
    await accepted;
    assert.match(offer.problem.value ?? '', /^The connection was lost/);
    assert.equal(offer.building.value, null);
  });

  it('is none where no code is taken, or where the source is not in the project', () => {
    assert.equal(offerOf([]).offer.obstacle(), null);
    assert.equal(
      offerOf([], 'other computers may open this page').offer.obstacle(),
      'It cannot be built here: other computers may open this page. Or start the program with --algorithms /p/my_wave/build/my_wave.so --algorithms /p/reflex/build/my_reflex.so.',
    );
    const { offer, missingAlgorithms } = offerOf([]);
    missingAlgorithms.value = { ...missing, algorithms: [{ name: 'my_wave', folder: null, library: null }] };
    assert.match(offer.obstacle() ?? '', /^The source of my_wave is not in this project; start the program with --algorithms/);
  });

  it('can be left for later, and comes again with the next try', () => {
    const { offer, missingAlgorithms } = offerOf([]);
    offer.dismiss();
    assert.equal(offer.missing.value, null);
    missingAlgorithms.value = { ...missing };
    assert.notEqual(offer.missing.value, null);
  });
});
