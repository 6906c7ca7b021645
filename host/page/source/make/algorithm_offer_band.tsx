// One line: which algorithm a scenario lacks, and the button that builds it.
import { useEffect, useRef } from 'preact/hooks';
import type { MakeApp } from './make_app.js';
import { shortPath } from './short_path.js';

const verbs = { start: 'open it', open: 'open it', restore: 'restore' } as const;

export function AlgorithmOfferBand({ app }: { app: MakeApp }) {
  const { offer } = app;
  const band = useRef<HTMLDivElement>(null);
  const missing = offer.missing.value;
  useEffect(() => band.current?.scrollIntoView({ block: 'nearest' }), [missing]);
  if (missing === null) return null;
  const names = missing.algorithms.map(({ name }) => name);
  const building = offer.building.value;
  const build = app.page.state.algorithmBuild.value;
  const isWorking = building !== null && build?.state === 'running';
  const obstacle = offer.obstacle();
  const lease = app.obstacle();
  const failed = offer.failed.value;
  return (
    <div class="band info" role="alert" ref={band} data-testid="algorithm-offer">
      <p title={missing.file}>
        {missing.action === 'restore' ? 'The unsaved changes need' : `${shortPath(missing.file)} needs`}{' '}
        {names.length === 1 ? 'the algorithm' : 'the algorithms'} {names.join(', ')}, which {names.length === 1 ? 'is' : 'are'} not loaded.
        {obstacle !== null && ` ${obstacle}`}
      </p>
      {offer.problem.value !== null && <p class="problem">{offer.problem.value}</p>}
      <div class="fields">
        {obstacle === null && (
          <button type="button" class="primary" disabled={lease !== null || building !== null} title={lease ?? ''} onClick={() => void offer.accept()}>
            Build {names.join(', ')} and {verbs[missing.action]}
          </button>
        )}
        {building !== null && (
          <span role="status">
            {isWorking && build.of > 0 ? `Building ${building}: ${build.done} of ${build.of} …` : `Building ${building} …`}
          </span>
        )}
        {isWorking && (
          <button type="button" disabled={lease !== null} onClick={() => void app.page.operations.tell('algorithm.cancel', {})}>
            Cancel
          </button>
        )}
        {failed !== null && (
          <button type="button" onClick={() => void app.showAlgorithm(failed.folder, failed.place)}>
            Show the source
          </button>
        )}
        {building === null && (
          <button type="button" onClick={() => offer.dismiss()}>
            Not now
          </button>
        )}
        {obstacle === null && building === null && (
          <span class="hint">It is code of this project, which then runs with your rights: build it only if you know where it comes from.</span>
        )}
      </div>
    </div>
  );
}
