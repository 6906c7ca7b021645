// The build of an image for the modules, in words.
import type { AlgorithmImage, BuiltImage } from '../../wire/messages.js';

export function imageStateText({ state, error, done, of, messages }: AlgorithmImage): string {
  const first = messages.find(({ severity }) => severity === 'error');
  switch (state) {
    case 'running':
      return of === 0 ? 'The build of the image begins …' : `Building the image: ${done} of ${of} …`;
    case 'passed':
      return 'The image is built.';
    case 'cancelled':
      return 'The build of the image was cancelled.';
    case 'failed':
      return `The image was not built: ${first === undefined ? error : `${first.file}${first.line > 0 ? `, line ${first.line}` : ''}: ${first.text}`}.`;
  }
}

export function roomText(bytes: number | null, limit: number | null): string {
  if (bytes === null || limit === null) return 'not known';
  return `${bytes} of ${limit} bytes, ${limit - bytes} are left`;
}

export function versionText({ version, commit, changed_sources: isChanged }: BuiltImage): string {
  return commit === null ? version : `${version} (${commit.slice(0, 8)}${isChanged ? ' + changes' : ''})`;
}
