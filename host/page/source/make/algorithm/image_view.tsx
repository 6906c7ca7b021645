// Into the image: the program for the modules with algorithms of the user's own, and how it is flashed.
import type { AlgorithmFolders, BuiltImage } from '../../wire/messages.js';
import type { AlgorithmApp } from './algorithm_app.js';
import { imageStateText, roomText, versionText } from './image_text.js';

function Facts({ image }: { image: BuiltImage }) {
  const facts = [
    ['File', image.file],
    ['Flash', roomText(image.flash, image.flash_limit)],
    ['Memory', roomText(image.ram === null || image.stack_limit === null ? null : image.ram + image.stack_limit, image.ram_limit)],
    ['Stack', `${roomText(image.stack, image.stack_limit)}, at worst`],
    ['Version', versionText(image)],
    ['SHA-256', image.sha256],
    ['Contents', ['the algorithms of Proleg', ...image.algorithms.map(({ name, sources }) => `${name} (sources ${sources ?? 'not known'})`)].join(', ')],
  ];
  return (
    <div class="table-frame" tabIndex={0} role="group" aria-label="The image">
      <table data-testid="image-facts">
        <tbody>
          {facts.map(([what, found]) => (
            <tr key={what}>
              <th scope="row">{what}</th>
              <td class="text">{found}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

export function ImageView({ app, folders }: { app: AlgorithmApp; folders: AlgorithmFolders['folders'] }) {
  const work = app.make.page.state.algorithmImage.value;
  const chosen = app.inImage.value ?? new Set(app.chosen.value === null ? [] : [app.chosen.value]);
  const wanted = folders.map(({ folder }) => folder).filter((folder) => chosen.has(folder));
  const obstacle = app.obstacle();
  const busy = app.work.value === null ? null : `${app.work.value.name}: wait, or cancel what goes on.`;
  const none = wanted.length === 0 ? 'Choose at least one algorithm.' : null;
  const choose = (folder: string, isWanted: boolean) => {
    const next = new Set(chosen);
    if (isWanted) next.add(folder);
    else next.delete(folder);
    app.inImage.value = next;
  };
  return (
    <section class="proof" aria-label="Into the image">
      <h3>Into the image</h3>
      <p class="hint">The modules of a robot need a program that has the algorithm. The first build takes minutes.</p>
      <div class="fields" role="group" aria-label="Algorithms in the image">
        {folders.map(({ folder, name }) => (
          <label class="switch" key={folder}>
            <input
              type="checkbox"
              checked={chosen.has(folder)}
              onChange={(event) => choose(folder, event.currentTarget.checked)}
              onKeyDown={(event) => {
                if (event.key !== 'Enter') return; // Space is STOP
                event.preventDefault();
                choose(folder, !chosen.has(folder));
              }}
            />
            {name}
          </label>
        ))}
        <button
          type="button"
          disabled={obstacle !== null || busy !== null || none !== null}
          title={obstacle ?? busy ?? none ?? 'Saves, and builds the image for the modules'}
          onClick={() => void app.buildImage(wanted)}
        >
          Build the image
        </button>
        {work?.state === 'running' && (
          <button type="button" disabled={obstacle !== null} onClick={() => app.cancel()}>
            Cancel the image
          </button>
        )}
      </div>
      {app.imageProblem.value !== null && (
        <p class="problem" role="alert">
          {app.imageProblem.value}
        </p>
      )}
      {work !== null && (
        <p role="status" data-testid="image-state" class={work.state === 'passed' ? 'good verdict' : work.state === 'failed' ? 'bad verdict' : ''}>
          {imageStateText(work)}
        </p>
      )}
      {work?.state === 'running' && <progress aria-label="Steps of the image" max={Math.max(work.of, 1)} value={work.done} />}
      {work?.image != null && (
        <>
          <Facts image={work.image} />
          <p>
            The next command flashes it; <code>--dry-run</code> only shows what it would do.
          </p>
          <pre class="command" tabIndex={0} aria-label="Command that flashes the image" data-testid="flash-command">
            {work.image.command}
          </pre>
          <p class="hint">
            Put your bus in the place of can0. A module refuses an algorithm whose source has changed since: then build it and the image again.
          </p>
        </>
      )}
    </section>
  );
}
