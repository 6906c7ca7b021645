// Which image the modules get.
import type { Signal } from '@preact/signals-core';
import type { ImageFile } from '../wire/messages.js';
import type { ModulesApp } from './modules_app.js';

// The chosen image, else the first one without a problem; null: there is none, or none is wanted.
export function imageOf(images: readonly ImageFile[], chosen: string | null): ImageFile | null {
  if (chosen === '') return null;
  return images.find(({ file }) => file === chosen) ?? images.find(({ problem }) => problem === null) ?? images[0] ?? null;
}

function imageText({ file, version, board, problem }: ImageFile): string {
  const name = file.startsWith('/') ? `${file.split('/').at(-1)}, built here` : file;
  return `${name}: ${problem === null ? `${version}, board ${board}` : 'cannot be flashed'}`;
}

// `none`: the text of the choice without an image; absent: an image is needed.
export function ImageChoice({ app, chosen, none }: { app: ModulesApp; chosen: Signal<string | null>; none?: string }) {
  const images = app.modules.value?.images ?? [];
  const image = imageOf(images, chosen.value);
  if (images.length === 0) {
    return <p class="hint">The project has no image (*.pimg). Make, Algorithm, “Into the image” builds one.</p>;
  }
  return (
    <>
      <label class="number-field">
        <span>image</span>
        <select value={image?.file ?? ''} onChange={(event) => (chosen.value = event.currentTarget.value)}>
          {none !== undefined && <option value="">{none}</option>}
          {images.map((candidate) => (
            <option key={candidate.file} value={candidate.file}>
              {imageText(candidate)}
            </option>
          ))}
        </select>
      </label>
      {image !== null && image.problem === null && (
        <span class="hint">
          {image.commit === null ? '' : `commit ${image.commit.slice(0, 8)}, `}SHA-256 {image.sha256.slice(0, 8)}
        </span>
      )}
      {image?.problem != null && (
        <span class="problem" role="alert">
          {image.problem}
        </span>
      )}
      <button type="button" title="Looks for images again" onClick={() => void app.tell('modules.look', {})}>
        Look again
      </button>
    </>
  );
}
