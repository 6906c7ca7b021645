// The proof of an algorithm in words.
import type { AlgorithmCheck, Proof, ProofBuild } from '../../wire/messages.js';

export function kernelsText(kernels: number): string {
  return kernels === 1 ? 'one kernel' : `${kernels} modules`;
}

export function resultText({ result, text }: ProofBuild): string {
  const about = text === null ? '' : `: ${text}`;
  switch (result) {
    case 'reference':
      return 'reference';
    case 'equal':
      return 'equal';
    case 'differs':
      return `differs${about}`;
    case 'failed':
      return `failed${about}`;
    case 'not run':
      return text === null ? 'not run' : `not run: ${text} is not installed`;
  }
}

// What speaks against an algorithm; nothing if it is verified.
export function objections(proof: Proof): string[] {
  const found: string[] = [];
  const count = (result: ProofBuild['result']) => proof.builds.filter((build) => build.result === result).length;
  const builds = (number: number) => (number === 1 ? '1 build' : `${number} builds`);
  if (count('differs') > 0) found.push(`${builds(count('differs'))} of ${proof.builds.length} computed other bits`);
  if (count('failed') > 0) found.push(`${builds(count('failed'))} of ${proof.builds.length} failed`);
  if (count('not run') > 0 && !proof.verified) found.push(`${proof.missing.join(', ')} ${proof.missing.length === 1 ? 'is' : 'are'} not installed`);
  if (proof.test?.passed === false) found.push('its test fails');
  if (proof.forbidden !== null && proof.forbidden.length > 0) found.push('its code uses what a module does not have');
  if (proof.instructions?.fits === false) found.push('a tick takes too long on the chip');
  if (proof.stack?.fits === false) found.push('it needs too much stack on the chip');
  return found;
}

export function verdictText({ state, error, done, of, step, proof }: AlgorithmCheck): string {
  switch (state) {
    case 'running':
      return of === 0 ? 'The proof begins …' : `Proving, step ${done} of ${of}: ${step} …`;
    case 'cancelled':
      return 'The proof was cancelled.';
    case 'passed':
      return 'Verified: the same bits everywhere.';
    case 'failed':
      return `Not verified: ${proof === null ? error : objections(proof).join('; ')}.`;
  }
}
